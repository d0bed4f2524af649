"""gazeview's window while it loads, without a scene, and with what cannot be loaded; driven by keys
under Xvfb with Mesa's software OpenGL.

window_loading.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import ctypes
import os
import signal
import subprocess
import sys
import time
import unittest

from picture import PATIENCE_S, run
from window_case import (
    CORNER, CORNER_HEIGHT, GAZEVIEW, GROUND, LINE_HEIGHT, PLACE, SCENE, SCENES, SCREEN, SIZE, WindowCase,
)
from xserver import Screen, start_server

MIDDLE = (60, 80, 420, 260)


def write(name, text):
    path = os.path.join(PLACE.name, name)
    mode = "wb" if isinstance(text, bytes) else "w"
    with open(path, mode) as out:
        out.write(text)
    return path


def scene_of(name, volume):
    return write(name, "[volume]\n%s\n[transfer]\nfile = %s\n" % (
        volume, os.path.join(SCENES, "shells.tf")))


# Loads for half a minute, unless cancelled.
SLOW = scene_of("slow.scene", "procedural = supernova\ndims = 640 640 640\ntype = uint8")

NRRD = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n"

# ICCCM 4.1.3.1
NORMAL, ICONIC = 1, 3


def set_property(display, window, name, kind, bits, value, count):
    """Set a property of a window; 0: the root."""
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = x11.XDefaultRootWindow.restype = ctypes.c_ulong
    connection = ctypes.c_void_p(x11.XOpenDisplay(display.encode()))
    window = window or x11.XDefaultRootWindow(connection)
    atoms = [ctypes.c_ulong(x11.XInternAtom(connection, text, 0)) for text in (name, kind)]
    x11.XChangeProperty(connection, ctypes.c_ulong(window), *atoms, bits, 0, value, count)
    x11.XCloseDisplay(connection)


def set_state(display, window, state):
    """Set the state of a window as a window manager does."""
    value = (ctypes.c_long * 2)(state, 0)
    set_property(display, window, b"WM_STATE", b"WM_STATE", 32, value, 2)


def set_resources(display, text):
    """Set X resources as xrdb does."""
    set_property(display, 0, b"RESOURCE_MANAGER", b"STRING", 8, text, len(text))


# Files that cannot be shown, and part of the message.
BAD = {
    "no such file": (os.path.join(PLACE.name, "nowhere.scene"), "no such file"),
    "an error in a line": (write("wrong.scene", "[volume]\nprocedural = shells\nsize = 3\n"),
                           "wrong.scene:3:"),
    "a volume that has moved": (scene_of("moved.scene", "file = elsewhere/head.nrrd"),
                                "elsewhere/head.nrrd is neither beside the scene nor under"),
    "no volume": (scene_of("text.scene", "file = " + write("text.nrrd", "Dear diary,\n")),
                  "text.nrrd"),
    "half a volume": (scene_of("half.scene", "file = " + write("half.nrrd", NRRD + bytes(2048))),
                      "half.nrrd"),
}

# The dialog itself refuses the other one.
READABLE = [what for what in BAD if what != "no such file"]


class WindowLoading(WindowCase):
    def welcomes(self, picture):
        """Whether there is text on a dark ground in the middle."""
        letters = sum(picture.at(x, y)[0] > 120 for x in range(MIDDLE[0], MIDDLE[2])
                      for y in range(MIDDLE[1], MIDDLE[3]))
        return picture.at(5, 5) == GROUND and letters > 100

    def quit(self):
        """Quit. -> exit status, messages"""
        self.leave()
        status = self.viewer.wait(timeout=PATIENCE_S)
        return status, self.messages()

    def open(self, path):
        """Open a file by the dialog."""
        # The dialog's own text: above it stands the time of a frame, behind it a bar may move.
        place = (30, 28, 440, 92)
        margin = (30, 28, 36, 92)  # the same whatever is typed
        before = self.grab()
        self.tool("key", "ctrl+o")
        empty = self.until(lambda p: p.part(*place) != before.part(*place), "a dialog")
        self.tool("type", "--delay", "4", path)
        seen = [empty]

        def typed(picture):
            seen.append(picture)
            return (picture.part(*place) != empty.part(*place) and
                    picture.part(*place) == seen[-2].part(*place))

        self.until(typed, "typed")
        # Held until the dialog is gone: Dear ImGui asks once a frame which keys are down.
        self.tool("keydown", "Return")
        self.until(lambda p: p.part(*margin) != empty.part(*margin), "accepted")
        self.tool("keyup", "Return")

    def test_window_without_a_scene_shows_a_welcome_and_exits_with_0(self):
        self.launch()
        self.until(self.welcomes, "welcome")
        for key in ("1", "r", "p", "l", "c", "i", "Left", "space", "F5", "f", "f", "p"):
            self.tool("key", key)
        self.move(4, SIZE[1] - 8)  # beside the panel, which offers scenes
        self.tool("mousedown", 1)
        self.move(6, SIZE[1] - 20)
        self.tool("mouseup", 1)
        self.tool("click", 4)
        self.rest()
        self.assertTrue(self.shows_ground(self.grab()))
        status, said = self.quit()
        self.assertEqual(status, 0)
        for line in said.splitlines():  # of keys that need a scene
            self.assertIn("not possible at present", line)

    def shows_ground(self, picture):
        return picture.at(5, SIZE[1] - 5) == GROUND

    def test_what_cannot_be_shown_is_an_error_in_the_window(self):
        for what, (path, message) in BAD.items():
            with self.subTest(what):
                self.launch(path)
                self.until(lambda p: self.says_error(p) and self.shows_ground(p), what)
                status, said = self.quit()
                self.assertEqual(status, 1, said)
                self.assertIn(message, said)
                self.assertEqual(said.count("gazecast: error"), 1, said)

    def test_what_cannot_be_shown_leaves_the_scene_that_is_shown(self):
        self.start("--gaze", "0.5,0.5", "--method", "standard")
        before = self.rest()
        place = (100, LINE_HEIGHT, 380, CORNER[1])
        for what in READABLE:
            with self.subTest(what):
                self.open(BAD[what][0])
                self.until(self.says_error, what)
                self.until(lambda p: p.part(*place) == before.part(*place), "the scene")
                self.until(self.read_by_a_key, "read")
        status, said = self.quit()
        self.assertEqual(status, 0, said)
        for what in READABLE:
            self.assertIn(BAD[what][1], said)

    def read_by_a_key(self, picture):
        """Whether a key has removed the error, which it does once that was shown for a second."""
        if self.says_error(picture):
            self.tool("key", "shift")
            return False
        return True

    def test_error_is_listed_after_it_was_clicked_away(self):
        self.launch(BAD["no such file"][0])
        self.until(self.says_error, "an error")
        self.move(SIZE[0] - 100, SIZE[1] - 20)
        self.tool("click", 1)
        self.until(lambda p: not self.says_error(p), "clicked away")
        self.tool("key", "n")
        self.until(lambda p: self.says_error(p, (20, 40, 460, 120)), "a list")
        self.assertEqual(self.quit()[0], 1)

    def test_another_scene_takes_the_place_of_one_that_failed(self):
        self.launch(BAD["a volume that has moved"][0])
        self.until(self.says_error, "an error")
        self.open(SCENE)
        self.until(self.shows_something, "a picture")
        self.assertEqual(self.quit()[0], 0)

    def bar(self, picture):
        """Whether the progress panel is shown: a button in the middle."""
        return picture.part(*MIDDLE) != bytes(GROUND) * (len(picture.part(*MIDDLE)) // 3)

    def test_window_answers_while_a_scene_loads_and_escape_cancels(self):
        self.launch(SLOW)
        first = self.until(self.bar, "a bar")
        self.until(lambda p: p.part(*MIDDLE) != first.part(*MIDDLE), "it moves")
        self.tool("windowsize", self.window, 600, 400)
        self.until(lambda p: p.at(595, 395) == GROUND, "larger")
        self.tool("windowsize", self.window, *SIZE)
        self.until(lambda p: p.at(595, 395) == (0, 0, 0), "as before")
        self.tool("key", "Escape")
        self.until(self.welcomes, "welcome")
        status, said = self.quit()
        self.assertEqual(status, 0)
        self.assertIn("loading was cancelled", said)

    def test_scene_stays_while_another_is_loaded_until_that_is_cancelled(self):
        self.start("--gaze", "0.5,0.5")
        before = self.rest()
        self.open(SLOW)
        self.until(lambda p: p.part(*MIDDLE) != before.part(*MIDDLE), "a bar")
        place = (100, LINE_HEIGHT, 380, 80)
        self.assertEqual(self.grab().part(*place), before.part(*place))
        # The scene shown is still drawn.
        self.tool("key", "1")
        self.until(lambda p: p.part(0, 0, 200, 30) != before.part(0, 0, 200, 30), "standard")
        self.tool("key", "4")
        self.until(lambda p: p.part(*place) == before.part(*place), "acuity")
        self.tool("key", "Escape")
        self.until(lambda p: p.part(*MIDDLE) == before.part(*MIDDLE), "no bar")
        # A second loading replaces the first.
        self.open(SLOW)
        self.open(SCENE)
        self.until(lambda p: p.part(*MIDDLE) == before.part(*MIDDLE), "the same scene anew")
        self.assertEqual(self.quit()[0], 0)

    def test_signals_and_q_end_the_program_while_it_loads(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            self.launch(SLOW)
            self.until(self.bar, "a bar")
            self.viewer.send_signal(number)
            self.assertEqual(self.viewer.wait(timeout=PATIENCE_S), -number)
            self.assertEqual(self.messages(), "")
        self.launch(SLOW)
        self.until(self.bar, "a bar")
        self.assertEqual(self.quit()[0], 0)

    def test_lost_display_is_a_message_and_an_exit_status(self):
        kept = self.environment
        self.addCleanup(setattr, self, "environment", kept)
        self.addCleanup(setattr, self, "screen", self.screen)
        for words in ([SCENE, "--turn", "1"], [SCENE, "--gaze", "0.5,0.5"], [SLOW], []):
            server, display = start_server(SCREEN)
            self.addCleanup(server.kill)
            self.environment = dict(kept, DISPLAY=display)
            self.screen = Screen(server, display, SCREEN)
            self.launch(*words)
            self.until(self.shows_something if words and words[0] == SCENE else self.bar, "a window")
            self.screen.close()
            server.kill()
            server.wait()
            status = self.viewer.wait(timeout=PATIENCE_S)
            said = self.messages()
            self.assertEqual(status, 1, said)
            self.assertEqual(said.count("\n"), 1, said)
            self.assertIn("the display is gone", said)

    def test_lost_display_ends_the_targets_with_a_message(self):
        server, display = start_server(SCREEN)
        self.viewer = subprocess.Popen(
            [GAZEVIEW, "--targets", "9"], env=dict(self.environment, DISPLAY=display),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )
        self.assertIn("screen", self.viewer.stdout.readline())
        server.kill()
        server.wait()
        out, said = self.viewer.communicate(timeout=PATIENCE_S)
        self.assertEqual(self.viewer.returncode, 1)
        self.assertIn("cancelled", out)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("the display is gone", said)

    def test_minimised_window_makes_no_pictures(self):
        self.start("--gaze", "0.5,0.5", "--turn", "1")
        self.assertGreater(self.ticks_in(0.5), 2)
        # As a window manager does.
        for state, rests in ((ICONIC, True), (NORMAL, False)):
            set_state(self.environment["DISPLAY"], int(self.window), state)
            self.wait_for(lambda wanted=rests: (self.ticks_in(0.5) <= 1) == wanted,
                          "at rest: %s" % rests, pause_s=0)

    def ticks_in(self, seconds):
        before = self.ticks()
        time.sleep(seconds)
        return self.ticks() - before

    def test_window_of_one_pixel_keeps_working(self):
        self.start("--gaze", "0.5,0.5", "--interface-scale", "2")
        self.tool("windowsize", self.window, 1, 1)
        self.rest()
        for key in ("p", "h", "n"):
            self.tool("key", key)
            self.rest()
        self.tool("key", "n")
        self.tool("key", "h")
        self.tool("key", "p")
        self.tool("windowsize", self.window, *SIZE)
        self.until(self.shows_something, "a picture again")
        self.assertEqual(self.quit(), (0, ""))

    def test_without_a_window_a_bad_scene_ends_with_a_line(self):
        for what, (path, message) in BAD.items():
            with self.subTest(what):
                done = run(GAZEVIEW, "--headless", path, env=self.environment)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(message, done.stderr)

    def test_action_is_found_by_name_and_run(self):
        before = self.start("--gaze", "0.5,0.5", "--method", "standard")
        self.tool("key", "ctrl+p")
        self.until(lambda p: p.part(*MIDDLE) != before.part(*MIDDLE), "a list")
        self.tool("type", "--delay", "4", "mdc square")
        self.rest()
        self.tool("key", "Return")
        line = (0, 0, SIZE[0], 30)
        self.until(lambda p: p.part(*line) != before.part(*line) and
                   p.part(200, 100, 240, 140) != bytes(GROUND) * 1600, "mdc")
        self.tool("key", "1")
        self.tool("key", "ctrl+p")
        self.rest()
        self.tool("key", "Escape")
        self.until(lambda p: p.part(*MIDDLE) == before.part(*MIDDLE), "as before")
        self.assertEqual(self.quit()[0], 0)

    def test_interface_follows_the_scale_of_the_display(self):
        small = self.row_height()
        self.assertAlmostEqual(self.row_height("--interface-scale", "2"), 2 * small, delta=2)
        set_resources(self.environment["DISPLAY"], b"Xft.dpi: 192\n")
        self.addCleanup(set_resources, self.environment["DISPLAY"], b"")
        self.assertAlmostEqual(self.row_height(), 2 * small, delta=2)

    def row_height(self, *words):
        """-> how high the bar of menus is, pixels"""
        self.menu = "yes"
        self.launch(*words)
        picture = self.until(
            lambda p: p.at(3, SIZE[1] - 5) == GROUND and p.at(3, 5) != GROUND, "a bar")
        self.assertEqual(self.quit()[0], 0)
        return next(y for y in range(5, SIZE[1]) if picture.at(3, y) != picture.at(3, 5))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
