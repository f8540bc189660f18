"""A mission in a folder of its own, with a program that stands in for ours."""
import os
import tempfile
import unittest


class MissionCase(unittest.TestCase):
    program = ""  # its text

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.mission = folder.name
        os.makedirs(os.path.join(self.mission, "results"))
        os.environ["XDG_CACHE_HOME"] = os.path.join(self.mission, "results", "cache")
        self.binary = os.path.join(self.mission, "results", "program")
        with open(self.binary, "w", encoding="utf-8") as file:
            file.write(self.program)
        os.chmod(self.binary, 0o755)
