"""The window without a scene, the simulated viewer and the example study, as a person with a mouse uses
them.

window_start.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import collections
import contextlib
import os
import sys
import time
import unittest

from picture import PATIENCE_S
from window_case import SCENE, SIZE, WindowCase

BUTTON = (36, 69, 109)  # ground of a button, about
BAR = (36, 36, 36)  # the menu bar's ground
SAMPLES = 25
# A program that the window has started: its process and its command line.
Child = collections.namedtuple("Child", "pid words")
# Camera of the small scene, moved to its right by this: the object is on the left, or on the right.
ASIDE = 0.65


def view_aside(right):
    """Eye and point looked at, moved along the right side of the camera."""
    away = [0.8 * right, 0.6 * right, 0]
    eye = [a + b for a, b in zip((0.9, -1.2, 1.1), away)]
    return tuple(" ".join("%g" % x for x in place) for place in (eye, away))


class Start(WindowCase):
    menu = "yes"

    def first_button(self, picture):
        """The middle of the button at the upper left, or None."""
        for y in range(24, SIZE[1]):
            for x in range(SIZE[0]):
                if all(abs(a - b) < 12 for a, b in zip(picture.at(x, y), BUTTON)):
                    return x + 30, y + 6
        return None

    def amber_line(self, picture):
        """The lowest row of amber letters, or None."""
        rows = [y for y in range(24, SIZE[1]) if 4 < sum(
            r > 180 and 0.55 * r < g < 0.85 * r and b < 0.5 * r
            for r, g, b in (picture.at(x, y) for x in range(SIZE[0] // 2)))]
        return rows[-1] if rows else None

    def click(self, x, y):
        """A click that lasts until a frame has seen it."""
        self.move(x, y)
        self.until_idle()
        for what in ("mousedown", "mouseup"):
            self.tool(what, 1)
            self.until_idle()

    def find(self, words):
        """Run what a search for words finds first."""
        self.press("ctrl+p")
        self.tool("type", "--delay", "30", words)
        self.until_idle()
        self.tool("key", "Return")

    def end(self):
        self.leave()
        self.assertEqual(self.viewer.returncode, 0)
        return self.messages()

    def test_one_click_shows_what_foveation_does(self):
        self.launch()
        empty = self.rest()
        self.click(*self.first_button(empty))
        shown = self.until(self.shows_something, "a scene")
        middle = SIZE[0] // 2
        self.move(middle - 60, SIZE[1] // 2)
        divided = self.until(lambda p: all(min(p.at(middle, y)) > 200 for y in range(60, 240, 20)),
                             "a divider")
        # The mouse is the gaze: its way to a corner changes the left, and not the right.
        self.until_idle()
        sharp = self.rest()
        self.move(20, SIZE[1] - 90)
        left, right = (60, 60, middle - 12, 240), (middle + 12, 60, SIZE[0] - 10, 240)
        blurred = self.until(lambda p: p.part(*left) != sharp.part(*left), "another left half")
        self.until_idle()
        self.assertEqual(self.grab().part(*right), sharp.part(*right))
        self.assertNotEqual(shown.part(*left), blurred.part(*left))
        self.assertTrue(divided)
        self.assertIn("move the mouse", self.end())

    def test_first_window_leaves_the_menu_bar_free_and_lies_below_messages(self):
        self.launch()
        left, top = self.first_button(self.rest())
        self.assertEqual(self.grab().at(SIZE[0] - 100, 12), BAR)

        def has_message(picture, quiet):
            """Whether there are bright letters, which no panel dims, on dark places."""
            return 20 < sum(
                min(picture.at(x, y)) > 150 > 100 > max(quiet.at(x, y))
                for x in range(80, SIZE[0] - 60) for y in range(SIZE[1] - 45, SIZE[1] - 10))

        for _ in range(2):
            self.click(left - 34, top)  # beside the buttons: it gets the focus
            quiet = self.rest()
            self.tool("key", "k")
            self.until(lambda p: has_message(p, quiet), "a message")
            self.until(lambda p: not has_message(p, quiet), "no message")

    def test_shipped_scene_is_opened_by_its_picture(self):
        self.launch()
        empty = self.rest()
        self.click(40, self.amber_line(empty) + 30)
        self.until(self.shows_something, "a shipped scene")
        self.assertNotIn("error", self.end())

    def own_scene(self):
        """The small scene, its object on the left; its first view has it on the right."""
        path = os.path.join(os.path.dirname(SCENE), "aside.scene")
        eye, place = view_aside(ASIDE)
        other = view_aside(-ASIDE)
        with open(SCENE, encoding="utf-8") as scene, open(path, "w", encoding="utf-8") as own:
            own.write(scene.read().replace("eye = 0.9 -1.2 1.1", "eye = " + eye)
                      .replace("look_at = 0 0 0", "look_at = " + place)
                      .replace("fov_deg = 32", "fov_deg = 50"))
            own.write("[views]\n1 = eye %s look_at %s up 0 0 1 fov_deg 50\n" % other)
        return path

    def gaze_places(self):
        """Columns at which the cross is seen, over some seconds."""
        places = []
        deadline = time.monotonic() + PATIENCE_S
        while len(places) < SAMPLES and time.monotonic() < deadline:
            middle = self.red_middle(self.grab())
            if middle:
                places.append(middle[0])
            time.sleep(0.2)
        self.assertEqual(len(places), SAMPLES, "the cross is seldom seen")
        return places

    def until_looked(self, there, what):
        """Wait until the gaze is there most of the time."""
        self.wait_for(lambda: sum(map(there, self.gaze_places())) > 0.8 * SAMPLES, what)

    def test_simulated_viewer_looks_at_the_object_and_follows_it(self):
        self.start("--cross", "--backend", "cpu", scene=self.own_scene())
        self.find("simulated viewer")
        picture = self.wait_for(self.told_picture, "a picture for the viewer")
        self.until_looked(lambda x: x < SIZE[0] // 2, "a viewer who looks left")
        before = os.stat(picture).st_mtime_ns
        self.tool("key", "F1")
        self.wait_for(lambda: os.stat(picture).st_mtime_ns != before, "another picture")
        self.until_looked(lambda x: x > SIZE[0] // 2, "a viewer who looks right")
        said = self.end()
        self.assertNotIn("has ended", said)
        self.assertFalse(os.path.exists(picture), "its picture is left behind")

    def children(self):
        """The programs that the window has started."""
        children = []
        for task in os.listdir("/proc/%d/task" % self.viewer.pid):
            # Threads and children may end meanwhile.
            with contextlib.suppress(FileNotFoundError, ProcessLookupError):
                with open("/proc/%d/task/%s/children" % (self.viewer.pid, task),
                          encoding="ascii") as pids:
                    for pid in pids.read().split():
                        with open("/proc/%s/cmdline" % pid, encoding="utf-8") as line:
                            children.append(Child(int(pid), line.read().split("\0")[:-1]))
        return children

    def told_picture(self):
        """The picture that a started gazed was told to look at."""
        for child in self.children():
            for word in child.words:
                if word.startswith("--sim.picture="):
                    return word.split("=", 1)[1]
        return None

    def test_example_study_asks_who_takes_part(self):
        self.launch("--pictures", self.place.name)
        self.rest()
        own = self.window
        self.find("run the example study")
        self.found(than=own)
        study = self.wait_for(self.study, "a study")
        self.assertNotIn("--participant", study.words)
        self.assertTrue(os.path.exists(study.words[study.words.index("--experiment") + 1]))
        # It is left before and after its first question; the first window says where answers are.
        self.until_idle(study)
        self.press("Escape")
        self.wait_for(lambda: not self.study(), "an end")
        self.window = own
        self.tool("windowfocus", "--sync", own)
        self.find("run the example study")
        self.found(than=own)
        answers = os.path.join(self.place.name, "sub-07_task-whichwassharper_events.tsv")
        self.wait_for(lambda: self.begin_study(answers), "a file of answers")
        self.wait_for(lambda: self.answer_study(answers), "an answer")
        self.wait_for(self.leave_study, "an end")
        self.wait_for(lambda: not self.children(), "the first window to see the end")
        self.window = own
        self.viewer.terminate()
        self.viewer.wait(timeout=PATIENCE_S)
        said = self.messages()
        self.assertEqual(said.count("its answers go to a file in " + self.place.name), 2, said)
        self.assertEqual(said.count("the example study has ended without answers"), 1, said)
        self.assertIn("the example study has ended; its answers are in " + answers, said)

    def study(self):
        """The study that runs, or None."""
        return next((child for child in self.children() if "--experiment" in child.words), None)

    def begin_study(self, answers):
        """Fill in the dialog, once it is there. -> whether the study has begun"""
        for words in (("key", "ctrl+a"), ("type", "07"), ("key", "Return")):
            self.tool(*words)
            time.sleep(0.3)  # a frame of the other program
        return os.path.exists(answers)

    def answer_study(self, answers):
        """Go on, and answer if there is a question. -> whether there is an answer"""
        self.tool("key", "space", "1")
        time.sleep(0.2)
        with open(answers, encoding="utf-8") as table:
            return len(table.readlines()) > 1

    def leave_study(self):
        """Press Escape until the study has ended."""
        self.tool("key", "Escape")
        time.sleep(0.2)
        return not self.study()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
