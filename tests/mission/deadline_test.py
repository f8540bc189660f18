"""deadline_test.py SOURCE_DIR: the parts of a mission that plan and judge, without any program."""
import importlib
import json
import os
import sys
import tempfile
import time
import unittest
import unittest.mock

sys.dont_write_bytecode = True
mission_case = importlib.import_module("mission_case")
sys.path.insert(0, os.path.join(sys.argv.pop(1), "scripts", "mission"))
deadline, dives, load, plan, reduced, run_step = (
    importlib.import_module(name)
    for name in ("deadline", "dives", "load", "plan", "reduced_pictures", "run_step"))

# Takes as many seconds as the dive has pictures; in full it does not end by itself.
PROGRAM = """#!/bin/sh
case "$*" in
  *estimate_only*) n=$(ls "$3" | wc -l)
    echo '{"seconds": '$n', "intake_seconds": 0, "pictures": '$n', "disk_bytes": 1}' ;;
  *coarse/workspace*) mkdir -p "$5/report"; echo '3 of 3 pictures used' >"$5/report/summary.txt"
    echo '{"stages": [{"wall_seconds": 40}, {"wall_seconds": 12}]}' >"$5/report/run.json" ;;
  *) exec sleep 60 ;;
esac
"""


class Deadline(unittest.TestCase):
    def test_hours_count_from_now(self):
        left = deadline.seconds_left(deadline.after_hours(".5"))
        self.assertTrue(1790 < left < 1800.01)  # milliseconds are written

    def test_a_time_is_the_next_one(self):
        now = time.mktime((2026, 7, 1, 22, 30, 0, 0, 0, -1))
        def at(text):
            return float(deadline.at_time(text, now).split()[1]) - now
        self.assertEqual(at("23:15"), 45 * 60)
        self.assertEqual(at("06:00"), 7.5 * 3600)
        self.assertEqual(at("22:30"), 24 * 3600)
        for bad in ("6", "24:00", "12:60", "noon", "-1:00"):
            self.assertRaises(ValueError, deadline.at_time, bad, now)

    def test_never(self):
        self.assertEqual(deadline.seconds_left("never"), float("inf"))


class Mission(mission_case.MissionCase):
    program = PROGRAM

    def told(self, share):
        with unittest.mock.patch.object(load, "share_to_be_had", return_value=share):
            plan.tell(self.mission, self.binary, "field", deadline.after_hours("1"))
        told = dives.read_json(os.path.join(self.mission, "results", "estimate.json"))
        return {"coarse": told["coarse_seconds"], "full": told["full_seconds"]}

    def test_others_work_makes_all_steps_slower(self):
        self.assertTrue(0.02 <= load.share_to_be_had() <= 1)
        self.add("dive", 20)
        alone, loaded = self.told(1.0), self.told(0.25)
        for step in ("coarse", "full"):
            self.assertAlmostEqual(loaded[step], 4 * alone[step], delta=0.2)

    def test_what_a_step_took_is_remembered_as_of_a_whole_machine(self):
        self.add("dive", 20)
        expected = self.told(1.0)
        estimated = plan.estimate(self.mission, "dive", self.binary, "field")
        for step in ("coarse", "full"):
            for _ in range(3):
                plan.remember(step, 8 * expected[step], 0.25, estimated)
            self.assertAlmostEqual(self.told(1.0)[step], 2 * expected[step], delta=0.2)

    def test_a_card_tells_what_all_stages_took_not_the_last_run_alone(self):
        self.add("a", 3)
        self.run_step("coarse", "a", "never")
        with open(os.path.join(self.mission, "results/mission.html"), encoding="utf-8") as page:
            self.assertIn("Quality: coarse; it took 52 s.", page.read())

    def test_a_step_that_goes_on_tells_nothing_of_how_long_one_takes(self):
        self.add("a", 3)
        self.run_step("coarse", "a", "never")
        self.assertEqual(len(plan.read_history("coarse")), 1)
        self.run_step("coarse", "a", "never")
        self.assertEqual(len(plan.read_history("coarse")), 1)

    def add(self, dive, count):
        os.makedirs(os.path.join(self.mission, dive))
        for i in range(count):
            with open(os.path.join(self.mission, dive, f"{i}.jpg"), "w", encoding="utf-8") as file:
                file.write(str(i))

    def run_step(self, step, dive, when):
        run_step.run(step, self.mission, dive, self.binary, "field",
                     dives.digest(self.mission, dive), when)

    def test_the_shortest_dive_is_first_and_what_is_done_needs_no_coarse_answer(self):
        for dive, count in (("a", 3), ("b", 1), ("c", 2)):
            self.add(dive, count)
        self.assertEqual(plan.order(self.mission, "full", self.binary, "field"), ["b", "c", "a"])
        record = {"digest": dives.digest(self.mission, "c"), "quality": "field", "exit_code": 3,
                  "program": dives.checksum(self.binary)}
        dives.write_whole(dives.result_path(self.mission, "c", "outcome.json"), json.dumps(record))
        self.assertEqual(plan.order(self.mission, "coarse", self.binary, "field"), ["b", "a"])
        self.assertEqual(plan.order(self.mission, "coarse", self.binary, "survey"), ["b", "c", "a"])

    def test_a_program_is_stopped_at_the_deadline_and_the_coarse_answer_stands(self):
        self.add("a", 3)
        self.run_step("coarse", "a", deadline.after_hours(1))
        self.assertEqual(dives.state(self.mission, "a"), ("coarse", "not begun"))
        began = time.time()
        self.run_step("full", "a", deadline.after_hours(1 / 3600))
        self.assertTrue(0.9 < time.time() - began < 10)
        what, reason = dives.state(self.mission, "a")
        self.assertEqual(what, "coarse")
        self.assertRegex(reason, "^stopped at ..:.., goes on with the same command$")
        with open(os.path.join(self.mission, "results/mission.html"), encoding="utf-8") as page:
            self.assertIn("Coarse answer.</span> 3 of 3 pictures used. In full: stopped at", page.read())
        self.assertEqual(dives.summary(self.mission), 3)
        # It is no failure, but will be tried again.
        dives.forget_failed(self.mission)
        self.assertIsNone(dives.outcome(self.mission, "a"))
        self.assertEqual(dives.state(self.mission, "a"), ("coarse", "not begun"))

    def test_a_low_battery_pauses_coarse_and_full_where_it_is_asked_for(self):
        self.add("a", 1)
        with open(self.binary, "w", encoding="utf-8") as file:
            file.write('#!/bin/sh\necho "$*"\n')
        for step, pause, expected in (("coarse", "20", 1), ("full", "35", 1), ("full", "", 0)):
            run_step.run(step, self.mission, "a", self.binary, "field", "digest", "never", pause)
            with open(dives.result_path(self.mission, "a", dives.LOGS[step]), encoding="utf-8") as log:
                self.assertEqual(log.read().count(f"--pause_on_battery {pause}"), expected)

    def test_a_failed_dive_says_why_and_what_to_do(self):
        self.add("a", 1)
        with open(self.binary, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\necho 'warning: 0.jpg is left out: is <empty>'\n"
                       "echo 'error: none can be used; copy them once more'\nexit 1\n")
        self.run_step("full", "a", "never")
        with open(os.path.join(self.mission, "results/mission.html"), encoding="utf-8") as file:
            page = file.read()
        for text in ("none can be used; copy them once more", "0.jpg is left out: is &lt;empty&gt;",
                     "the same command tries it again", '<p>Failed: <a href="#dive-a">a</a>.</p>'):
            self.assertIn(text, page)
        self.assertNotIn("Not begun:", page)

    def test_what_the_deadline_stops_before_any_answer_has_not_failed(self):
        self.add("a", 1)
        with open(self.binary, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\nexec sleep 60\n")
        self.run_step("coarse", "a", deadline.after_hours(0.5 / 3600))
        what, reason = dives.state(self.mission, "a")
        self.assertEqual(what, "stopped")
        self.assertRegex(reason, "^at ..:.., goes on")
        with open(os.path.join(self.mission, "results/mission.html"), encoding="utf-8") as page:
            self.assertIn('<p>Stopped: <a href="#dive-a">a</a>.</p>', page.read())
        self.assertEqual(dives.summary(self.mission), 1)

    def test_what_the_deadline_leaves_is_not_begun(self):
        self.add("a", 1)
        self.run_step("full", "a", "after 0")
        self.assertEqual(dives.state(self.mission, "a"), ("not begun", "not begun by the deadline"))
        self.assertEqual(dives.summary(self.mission), 1)


class ReducedPictures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.mission = folder.name
        self.images = os.path.join(self.mission, "a", "images")
        os.makedirs(self.images)

    def write(self, name, size):
        from PIL import Image
        exif = Image.Exif()
        exif[0x010F] = "a maker"
        Image.new("RGB", size, (9, 99, 49)).save(os.path.join(self.images, name), exif=exif)

    def folder(self):
        return reduced.folder_of(self.mission, "a", "digest")

    def test_large_ones_become_smaller_and_keep_what_they_say(self):
        from PIL import Image
        self.write("large.jpg", (2000, 1500))
        self.write("large.png", (1120, 560))
        self.write("small.jpg", (500, 300))
        with open(os.path.join(self.images, "bad.jpg"), "w", encoding="utf-8") as file:
            file.write("x")
        folder = self.folder()
        self.assertNotEqual(folder, self.images)
        with Image.open(os.path.join(folder, "large.jpg")) as picture:
            self.assertEqual((picture.size, picture.format), ((560, 420), "JPEG"))
            self.assertEqual(picture.getexif()[0x010F], "a maker")
        with Image.open(os.path.join(folder, "large.png")) as picture:
            self.assertEqual((picture.size, picture.format), ((560, 280), "PNG"))
        for name in ("small.jpg", "bad.jpg"):
            self.assertEqual(os.readlink(os.path.join(folder, name)), os.path.join(self.images, name))
        before = os.stat(os.path.join(folder, "large.jpg")).st_mtime_ns
        self.assertEqual(self.folder(), folder)
        self.assertEqual(os.stat(os.path.join(folder, "large.jpg")).st_mtime_ns, before)

    def test_pictures_stay_where_none_is_large_or_their_pixels_count(self):
        self.write("small.jpg", (500, 300))
        self.assertEqual(self.folder(), self.images)
        self.write("large.jpg", (2000, 1500))
        with open(os.path.join(self.mission, "a", "project.ini"), "w", encoding="utf-8") as file:
            file.write("[ImageReader]\ncamera_params=1,2,3,4\n")
        self.assertEqual(self.folder(), self.images)


unittest.main()
