"""mishaps_test.py SOURCE_DIR: what a mission says and records when the machine does not play along."""
import importlib
import os
import sys
import time
import unittest
import unittest.mock

sys.dont_write_bytecode = True
mission_case = importlib.import_module("mission_case")
sys.path.insert(0, os.path.join(sys.argv.pop(1), "scripts", "mission"))
dives, run_step = (importlib.import_module(name) for name in ("dives", "run_step"))

# Ends as its second argument's folder tells: killed by the system, or well.
PROGRAM = """#!/bin/sh
case "$*" in *estimate_only*) echo '{"seconds": 1, "intake_seconds": 0, "pictures": 1}'; exit 0 ;; esac
echo 'Mapper, round 1'
echo '34 % of the whole job, about 12 s left (matches of pairs: 12 of 30)'
case "$3" in */killed*) kill -KILL $$ ;; esac
sleep 0.3
"""


class Mishaps(mission_case.MissionCase):
    program = PROGRAM

    def run_dive(self, dive):
        os.makedirs(os.path.join(self.mission, dive))
        with open(os.path.join(self.mission, dive, "a.jpg"), "w", encoding="utf-8") as file:
            file.write(dive)
        run_step.run("full", self.mission, dive, self.binary, "field",
                     dives.digest(self.mission, dive), "never")
        return dives.outcome(self.mission, dive)

    def test_a_killed_program_is_told_with_stage_signal_and_remedy(self):
        error = self.run_dive("killed")["error"]
        self.assertRegex(error, r"^was killed by signal 9 \(Killed\), by the system for want of memory")
        self.assertIn("close other programs", error)
        self.assertIn("the same command goes on from there", error)
        self.assertIn("matches of pairs: 12 of 30", error)

    def test_a_clock_that_is_set_back_makes_no_negative_seconds(self):
        began, clock = time.monotonic(), time.time
        with unittest.mock.patch("time.time",
                                 lambda: clock() - 3600 * 1000 * (time.monotonic() - began)):
            seconds = self.run_dive("well")["seconds"]
        self.assertTrue(0.3 <= seconds < 60, seconds)


unittest.main()
