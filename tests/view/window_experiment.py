"""gazeview --experiment in the real window: answered by keys, left by Escape, resumed."""

import csv
import ctypes
import os
import subprocess
import sys
import tempfile
import time
import unittest

from picture import PATIENCE_S, run
from window_case import GAZECTL, GAZEVIEW, SCENE, SCREEN, WindowCase

GROUND = (51, 102, 153)
BACKGROUND = (5, 5, 10)  # of the scene, rounded
SETTINGS = {
    "name": "short", "seed": "4", "instructions": "Hello.", "goodbye": "Bye.",
    "ground": "0.2 0.4 0.6", "scene": SCENE, "fixation_s": "0.1", "duration_s": "0.2",
    "blank_s": "0.1", "pause_s": "0.1", "correct": "a", "a.foveation.method": "standard",
    "b.foveation.method": "acuity",
}
TRIALS = """[trial fine]
[trial coarse]
b.foveation.acuity_slope = 0.2
[block main]
repeats = %d
order = listed
"""


class CursorImage(ctypes.Structure):
    """XFixesCursorImage of X11/extensions/Xfixes.h, as far as it is read."""
    _fields_ = [("x", ctypes.c_short), ("y", ctypes.c_short), ("width", ctypes.c_ushort),
                ("height", ctypes.c_ushort), ("xhot", ctypes.c_ushort), ("yhot", ctypes.c_ushort),
                ("serial", ctypes.c_ulong), ("pixels", ctypes.POINTER(ctypes.c_ulong))]


def cursor_is_seen(display):
    """Whether any pixel of the mouse cursor on the screen is not transparent."""
    x11, fixes = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXfixes.so.3")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    fixes.XFixesGetCursorImage.restype = ctypes.POINTER(CursorImage)
    screen = ctypes.c_void_p(x11.XOpenDisplay(display.encode()))
    base, error = ctypes.c_int(), ctypes.c_int()
    fixes.XFixesQueryExtension(screen, ctypes.byref(base), ctypes.byref(error))
    image = fixes.XFixesGetCursorImage(screen).contents
    seen = any(image.pixels[i] & 0xff000000 for i in range(image.width * image.height))
    x11.XCloseDisplay(screen)
    return seen


class Experiment(WindowCase):
    def setUp(self):
        super().setUp()
        place = tempfile.TemporaryDirectory(prefix="gazecast-test-experiment-")
        self.addCleanup(place.cleanup)
        self.folder = place.name
        self.file = os.path.join(self.folder, "short.experiment")
        self.answers = os.path.join(self.folder, "sub-07_ses-2_task-short_events.tsv")
        self.write()

    def write(self, repeats=1, **changes):
        lines = ["%s = %s\n" % item for item in dict(SETTINGS, **changes).items()]
        with open(self.file, "w", encoding="utf-8") as out:
            out.write("[experiment]\n" + "".join(lines) + TRIALS % repeats)

    def words(self, *more):
        return ["--experiment", self.file, "--participant", "07", "--session", "2", "--answers",
                self.folder, *more]

    def begin(self, *more):
        self.viewer = subprocess.Popen(
            [GAZEVIEW, *self.words(*more)], env=self.environment, stderr=subprocess.PIPE,
            text=True,
        )
        self.found()

    def rows(self):
        try:
            with open(self.answers, encoding="utf-8") as table:
                return list(csv.DictReader(table, delimiter="\t"))
        except FileNotFoundError:
            return []

    def ended(self):
        return self.viewer.poll() is not None

    def press(self, key):
        """xdotool fails if the window closes meanwhile."""
        run("xdotool", "key", key, env=self.environment)

    def answer(self, done, *keys):
        """Press keys in turn, each of which counts in its own phase, until @done."""
        deadline = time.monotonic() + 2 * PATIENCE_S
        turn = 0
        while not done():
            self.assertLess(time.monotonic(), deadline, "never came: %r" % self.rows())
            self.press(keys[turn % len(keys)])
            turn += 1
            time.sleep(0.05)

    def finish(self, status):
        said = self.viewer.communicate(timeout=PATIENCE_S)[1]
        self.assertEqual(self.viewer.returncode, status, said)
        self.viewer = None
        return said

    def whole(self, picture, colour):
        """Whether the corners of the screen have only that colour."""
        return all(picture.at(x, y) == colour for x in (2, SCREEN[0] - 3)
                   for y in (2, SCREEN[1] - 3))

    def test_answered_experiment_writes_a_row_for_each_trial(self):
        self.write(repeats=2)
        self.begin("--gaze", "0.5,0.5")
        self.answer(self.ended, "space", "2")
        said = self.finish(0)
        self.assertIn("all 4 trials are answered", said)
        rows = self.rows()
        self.assertEqual([row["trial_type"] for row in rows], ["fine", "coarse"] * 2)
        self.assertEqual([row["trial"] for row in rows], ["1", "2", "3", "4"])
        for row in rows:
            self.assertEqual(row["response"], "second")
            self.assertEqual(row["chosen"], row["order"][1])
            self.assertEqual(row["chosen_method"],
                             "standard" if row["chosen"] == "a" else "acuity")
            self.assertEqual(row["correct"], "1" if row["chosen"] == "a" else "0")
            self.assertGreater(float(row["response_time"]), 0)
            # A machine may be slow, but never too fast.
            for interval in ("1", "2"):
                self.assertGreater(float(row["interval_%s_duration" % interval]), 0.15)
            self.assertGreater(int(row["frames"]), 0)
            self.assertEqual(row["gaze_loss"], "n/a")
            self.assertEqual((row["gaze_source"], row["tracker"]), ("fixed", "n/a"))
            self.assertEqual(row["display_px"], "%dx%d" % SCREEN)
            self.assertIn(row["backend"], ("cpu", "gl"))
        for label in ("fine", "coarse"):
            orders = [row["order"] for row in rows if row["trial_type"] == label]
            self.assertEqual(sorted(orders), ["ab", "ba"])
        self.assertTrue(os.path.exists(self.answers.replace(".tsv", ".json")))

    def test_pictures_fill_the_screen_with_nothing_over_them(self):
        self.write(duration_s="3", fixation_s="3", blank_s="3")
        self.begin("--gaze", "0.5,0.5")
        text = self.until(lambda p: self.whole(p, GROUND) and
                          len({p.at(x, y) for x in range(300, 600) for y in range(300, 400)}) > 1,
                          "instructions")
        self.assertTrue(cursor_is_seen(self.environment["DISPLAY"]))
        self.press("space")
        middle = (SCREEN[0] // 2, SCREEN[1] // 2)
        cross = self.until(lambda p: self.whole(p, GROUND) and p.at(*middle) != GROUND and
                           p.at(middle[0] + 40, middle[1]) == GROUND, "cross")
        self.assertFalse(cross == text)
        picture = self.until(lambda p: self.whole(p, BACKGROUND), "picture")
        line = {picture.at(x, y) for x in range(0, 400, 2) for y in range(0, 30, 2)}
        self.assertEqual(line, {BACKGROUND}, "no line of text")
        self.assertFalse(cursor_is_seen(self.environment["DISPLAY"]))
        self.until(lambda p: self.whole(p, GROUND) and p.at(*middle) == GROUND, "blank")

    def click(self, *share):
        """A click at a share of the window; xdotool fails if it closes meanwhile."""
        x, y = (int(share[i] * SCREEN[i]) for i in (0, 1))
        run("xdotool", "mousemove", str(x), str(y), "click", "1", env=self.environment)

    def answer_by_clicks(self, done, *places):
        deadline = time.monotonic() + 2 * PATIENCE_S
        while not done():
            self.assertLess(time.monotonic(), deadline, "never came: %r" % self.rows())
            for place in places:
                self.click(*place)

    def test_mouse_alone_answers_a_staircase_that_ends_early_and_goes_on(self):
        self.write(repeats=30, staircase="b.foveation.acuity_slope",
                   staircase_range="0.01 0.5", staircase_sd="0.3", staircase_stop_sd="0.29",
                   interval_order="ab", fixation_s="0", duration_s="0.02", blank_s="0",
                   pause_s="0")
        self.begin("--gaze", "0.5,0.5")
        # Continue and Finish are in the middle, the first of two answers left of it.
        self.answer_by_clicks(lambda: self.rows(), (0.5, 0.78), (0.43, 0.78))
        self.viewer.terminate()
        self.viewer.communicate(timeout=PATIENCE_S)
        kept = self.rows()
        self.begin("--gaze", "0.5,0.5", "--resume")
        self.answer_by_clicks(self.ended, (0.5, 0.78), (0.43, 0.78))
        self.assertRegex(self.finish(0), "main, fine: threshold of foveation.acuity_slope 0")
        rows = self.rows()
        self.assertEqual(rows[:len(kept)], kept)
        self.assertLess(len(rows), 60)
        for label in ("fine", "coarse"):
            those = [row for row in rows if row["trial_type"] == label]
            self.assertEqual(those[0]["staircase"], "foveation.acuity_slope")
            self.assertAlmostEqual(float(those[0]["staircase_value"]), 0.0707, delta=0.001)
            for row in those:
                self.assertEqual((row["response"], row["response_by"], row["correct"]),
                                 ("first", "mouse", "1"))
                self.assertIn("foveation.acuity_slope=" + row["staircase_value"],
                              row["settings_2"])
                self.assertGreaterEqual(float(row["response_time"]), 0)
            values = [float(row["staircase_value"]) for row in those]
            self.assertEqual(values, sorted(values, reverse=True), "right answers: harder")

    def begin_dialog(self, *more):
        self.viewer = subprocess.Popen(
            [GAZEVIEW, "--experiment", self.file, "--answers", self.folder, "--gaze", "0.5,0.5",
             *more], env=self.environment, stderr=subprocess.PIPE, text=True)
        self.found()

    def type_until(self, seen, *steps):
        """Give the dialog keys in turn; a key too early is typed again from the start."""
        deadline = time.monotonic() + 2 * PATIENCE_S
        while not seen():
            self.assertLess(time.monotonic(), deadline, "never came")
            for step in steps:
                run("xdotool", *step, env=self.environment)
                time.sleep(0.1)

    def test_dialog_asks_who_takes_part_and_continues_a_session(self):
        listed = os.path.join(self.folder, "participants.tsv")
        answers = self.answers.replace("sub-07_ses-2", "sub-07_ses-3")
        self.begin_dialog("--notes", "calm")
        field = [("key", "ctrl+a"), ("type", "07"), ("key", "Tab"), ("key", "ctrl+a"),
                 ("type", "3"), ("key", "Tab"), ("key", "Return")]
        self.type_until(lambda: os.path.exists(answers), *field)
        self.answers = answers
        self.answer(lambda: len(self.rows()) == 1, "space", "1")
        self.answer(self.ended, "Escape")
        self.finish(1)
        with open(listed, encoding="utf-8") as table:
            self.assertEqual(table.read(), "participant_id\tnotes\nsub-07\tses-3: calm\n")

    def recorded_marks(self):
        names = [name for name in os.listdir(self.folder) if name.endswith(".gzl")]
        self.assertEqual(len(names), 1)
        with open(os.path.join(self.folder, names[0]), encoding="utf-8") as log:
            lines = [line.rstrip("\n").split("\t") for line in log]
        return [(int(fields[1]), fields[2]) for fields in lines if fields[0] == "!mark"]

    def test_recording_has_the_marks_of_trials_and_answers_in_order(self):
        self.start_daemon("--driver=sim", "--sim.blinks_per_min=0",
                          "--recording.directory=" + self.folder)
        self.wait_for(lambda: run(GAZECTL, "record", "e", env=self.environment).returncode == 0,
                      "a recording")
        self.write(gaze="required")
        self.begin()
        self.answer(self.ended, "space", "1")
        self.finish(0)
        self.stop_daemon()
        rows, marks = self.rows(), self.recorded_marks()
        self.assertEqual(len(rows), 2)
        expected = ["experiment short begins participant 07 session 2 seed 4"]
        for row in rows:
            number, order = row["trial"], row["order"]
            expected.append("trial %s begins block main trial %s order %s"
                            % (number, row["trial_type"], order))
            for interval in (0, 1):
                method = "standard" if order[interval] == "a" else "acuity"
                expected.append("trial %s interval %d on %s %s"
                                % (number, interval + 1, order[interval], method))
                expected.append("trial %s interval %d off" % (number, interval + 1))
            expected.append("trial %s question" % number)
            expected.append("trial %s answer first chosen %s" % (number, order[0]))
        expected.append("experiment short ends")
        self.assertEqual([label for _, label in marks], expected)
        times = [time_ns for time_ns, _ in marks]
        self.assertEqual(times, sorted(times))
        begun = dict((label, time_ns) for time_ns, label in marks)
        for row in rows:
            label = "trial %s begins block main trial %s order %s" % (
                row["trial"], row["trial_type"], row["order"])
            self.assertEqual(begun[label], int(row["host_ns"]))
            self.assertTrue(0 <= float(row["gaze_loss"]) <= 1, row["gaze_loss"])

    def test_escape_keeps_the_answers_and_resume_continues(self):
        self.begin("--gaze", "0.5,0.5")
        self.answer(lambda: len(self.rows()) == 1, "space", "1")
        self.answer(self.ended, "Escape")
        said = self.finish(1)
        self.assertIn("1 of 2 trials are answered; --resume continues", said)
        kept = self.rows()
        self.assertEqual(len(kept), 1)
        refused = run(GAZEVIEW, *self.words(), env=self.environment)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("already exists, with 1 of 2 trials", refused.stderr)
        self.assertEqual(self.rows(), kept)
        self.begin("--gaze", "0.5,0.5", "--resume")
        self.answer(self.ended, "space", "1")
        self.finish(0)
        rows = self.rows()
        self.assertEqual(rows[:1], kept)
        self.assertEqual([row["trial"] for row in rows], ["1", "2"])
        self.assertEqual([row["run"] for row in rows], ["1", "2"])

    def test_escape_once_and_space_shows_the_trial_again(self):
        self.begin("--gaze", "0.5,0.5")
        self.answer(lambda: len(self.rows()) == 1, "space", "1")
        self.press("Escape")
        self.until(lambda p: self.whole(p, GROUND) and
                   len({p.at(x, y) for x in range(300, 600) for y in range(300, 400)}) > 1,
                   "question whether to leave")
        self.answer(lambda: len(self.rows()) == 2, "space", "1")
        self.answer(self.ended, "space")
        self.finish(0)

    def test_lost_context_interrupts_nothing_but_the_picture(self):
        library = os.environ.get("LOSE_CONTEXT_LIBRARY")
        if not library:
            self.skipTest("LOSE_CONTEXT_LIBRARY names nothing to preload")
        lost, kept = os.path.join(self.folder, "lost"), self.environment
        # The runtime of a sanitizer must accept not to be loaded first.
        losing = dict(kept, LD_PRELOAD=library, LOSE_CONTEXT=lost,
                      ASAN_OPTIONS=kept["ASAN_OPTIONS"] + ":verify_asan_link_order=0")
        for backend in ("cpu", "gl"):
            self.environment = losing
            self.begin("--gaze", "0.5,0.5", "--backend", backend)
            self.environment = kept
            self.answer(lambda: len(self.rows()) == 1, "space", "1")
            open(lost, "w", encoding="utf-8").close()
            self.answer(self.ended, "space", "1")
            self.assertIn("lost the window's context", self.finish(0))
            self.assertEqual(len(self.rows()), 2)
            self.assertFalse(os.path.exists(lost))
            os.remove(self.answers)

    def test_closed_window_keeps_what_was_answered(self):
        self.write(repeats=2)
        self.begin("--gaze", "0.5,0.5")
        self.answer(lambda: len(self.rows()) == 2, "space", "1")
        self.viewer.terminate()
        self.viewer.communicate(timeout=PATIENCE_S)
        self.viewer = None
        self.assertEqual([row["response"] for row in self.rows()], ["first", "first"])

    def refused(self, *words, **changes):
        self.write(**changes)
        done = run(GAZEVIEW, *self.words(*words), env=self.environment)
        self.assertEqual(done.returncode, 1)
        self.assertEqual([name for name in os.listdir(self.folder) if "events" in name], [])
        return done.stderr

    def test_what_cannot_be_shown_is_refused_at_the_start(self):
        self.assertIn("short.experiment:15: [trial fine] a: no scene ",
                      self.refused(scene="nowhere.scene"))
        self.assertIn("--gaze 0.5,0.5: ", self.refused("--gaze", "0.5,0.5", gaze="required"))
        self.assertIn("--experiment: --method cannot be combined with it", self.refused("--method", "mdc"))
        self.assertIn("short.experiment:15: [experiment] questions: unknown key; did you mean "
                      "question?", self.refused(questions="x"))

    def test_picture_that_cannot_be_made_ends_it_and_no_other_is_shown_for_it(self):
        self.write(**{"b.render.image_sampling_rate": "4"})
        self.begin("--gaze", "0.5,0.5", "--window", "--size", "4200x100")
        self.answer(self.ended, "space")
        said = self.finish(1)
        self.assertIn("4200x100 at image_sampling_rate 4 is not 1 to 16384 rays a side", said)
        self.assertIn("its picture cannot be made; the experiment ends", said)
        self.assertEqual(said.count("image_sampling_rate 4"), 1, said)
        self.assertEqual(self.rows(), [])

    def test_without_a_window_the_trials_are_listed(self):
        self.write(repeats=2)
        done = run(GAZEVIEW, *self.words("--headless"), env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 5)
        self.assertRegex(lines[0], "^1 main fine 1 [ab]:[a-z]+ [ab]:[a-z]+$")
        self.assertRegex(lines[4], "^4 trials, ")


if __name__ == "__main__":
    unittest.main(argv=["window_experiment"] + sys.argv[5:], verbosity=2)
