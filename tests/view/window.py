"""gazeview's window, driven by keys and mouse under Xvfb with Mesa's software OpenGL.

window.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import os
import sys
import tempfile
import unittest

from picture import PATIENCE_S, run
from window_case import GAZECTL, GAZEVIEW, LINE_HEIGHT, SCENE, SCREEN, SIZE, WindowCase


class Window(WindowCase):
    def test_cross_comes_by_key_follows_the_mouse_and_goes(self):
        self.start("--gaze", "mouse")
        self.move(150, 200)
        self.tool("key", "c")
        self.until(lambda p: self.cross_at(p, 150, 200), "cross at the mouse")
        self.move(330, 120)
        picture = self.until(lambda p: self.cross_at(p, 330, 120), "cross moved")
        self.assertFalse(self.cross_at(picture, 150, 200))
        self.tool("key", "c")
        self.until(lambda p: not self.cross_at(p, 330, 120), "no cross")

    def test_keys_choose_the_methods_and_each_has_its_own_picture(self):
        self.start("--gaze", "mouse")
        self.move(20, 60)  # far from most of the window
        pictures = {}
        before = self.rest()
        for key in ("1", "3", "2", "4", "1"):
            self.tool("key", key)
            # The line names the method, so it always changes; the picture follows with it.
            old = before.part(0, 0, SIZE[0], LINE_HEIGHT)
            before = self.until(
                lambda p: p.part(0, 0, SIZE[0], LINE_HEIGHT) != old, "method " + key
            )
            if key == "1" and key in pictures:
                self.assertTrue(pictures[key] == self.below_line(before), "1 is not 1")
            pictures[key] = self.below_line(before)
        self.assertEqual(len(set(pictures.values())), 4)

    def test_method_that_the_scene_lacks_a_table_for_says_so(self):
        self.start("--gaze", "mouse")
        before = self.rest().part(0, 0, *SIZE)
        self.tool("key", "7")
        self.until(lambda p: p.part(0, 0, *SIZE) != before, "a notice")
        self.tool("key", "q")
        self.assertIn("names no table of spacings", self.messages())

    def test_moved_gaze_makes_its_place_sharp(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(100, 100)
        sharp = self.rest()
        self.tool("key", "4")
        place = (320, 140, 380, 200)
        self.until(lambda p: p.part(*place) != sharp.part(*place), "blurred there")
        self.move(350, 170)
        self.until(lambda p: p.part(340, 160, 360, 180) == sharp.part(340, 160, 360, 180),
                   "sharp there")

    def test_drag_turns_wheel_zooms_and_r_brings_both_back(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(240, 160)
        first = self.rest()
        self.tool("mousedown", 1)
        self.move(320, 180)
        turned = self.until_changed(first, "turned")
        self.tool("mouseup", 1)
        self.move(240, 160)
        self.tool("click", 4)
        self.until_changed(turned, "zoomed")
        self.tool("key", "r")
        self.until(lambda p: self.below_line(p) == self.below_line(first), "as at first")

    def test_h_shows_the_keys_and_hides_them(self):
        # Use a method that ignores the gaze: others widen while the mouse is outside.
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.rest()
        self.tool("key", "h")
        self.until_changed(before, "keys shown")
        self.tool("key", "question")
        self.until(lambda p: self.below_line(p) == self.below_line(before), "keys hidden")

    def test_key_that_does_nothing_says_so_once(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(240, 160)
        quiet = self.rest()
        corner = (240, 200, *SIZE)
        # Modifiers alone, typed text and bound keys are no reason.
        for key in ("shift", "ctrl", "alt+shift", "Caps_Lock", "Caps_Lock", "question"):
            self.press(key)
        self.press("question")
        self.find("yj9")
        self.press("Escape")
        self.assertTrue(self.rest().part(*corner) == quiet.part(*corner), "something is said")
        self.press("shift+k")
        self.until(lambda p: p.part(*corner) != quiet.part(*corner), "a message")
        self.tool("key", "shift+k", "k", "9", "Home")
        self.until(lambda p: p.part(*corner) == quiet.part(*corner), "the message goes")
        self.press("k")
        self.leave()
        told = [line for line in self.messages().splitlines() if "H lists the keys" in line]
        self.assertEqual(len(told), 2, told)
        self.assertIn("Shift+K does nothing here", told[0])
        self.assertIn("K, Play time points: not possible at present", told[1])

    def test_settings_are_changed_in_the_panel_while_the_gaze_stays(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(100, 300)
        small = self.rest()
        self.tool("windowsize", self.window, 700, 500)
        self.until_changed(small, "larger")
        self.move(101, 301)
        before = self.rest()  # the last of several sizes
        shown, panel = (100, 50, 310, 440), (330, 40, 680, 200)
        self.tool("key", "p")
        self.until(lambda p: p.part(*panel) != before.part(*panel), "settings")
        self.move(500, 142)  # the heading Clip
        folded = self.rest()
        self.tool("click", 1)
        self.until(lambda p: p.part(330, 155, 680, 200) != folded.part(330, 155, 680, 200),
                   "clip box")
        self.assertTrue(self.grab().part(*shown) == before.part(*shown), "the panel is the mouse's")
        self.move(515, 165)  # the first slider of least
        self.rest()
        self.tool("click", 1)
        self.until(lambda p: p.part(*shown) != before.part(*shown), "clipped")
        self.tool("key", "p")
        self.move(101, 300)
        self.until(lambda p: p.part(600, 40, 690, 60) == before.part(600, 40, 690, 60), "no panel")

    def test_letters_come_and_go(self):
        self.start("--gaze", "mouse")
        self.move(20, 60)
        edge = (450, 140, 478, 180)
        before = self.rest()
        self.tool("key", "l")
        self.until(lambda p: p.part(*edge) != before.part(*edge), "letters")
        self.tool("key", "l")
        self.until(lambda p: p.part(*edge) == before.part(*edge), "no letters")

    def test_resized_window_is_filled(self):
        self.start("--gaze", "0.5,0.5", "--render.background", "0.2 0.4 0.6")
        self.tool("windowsize", self.window, 700, 500)
        self.until(lambda p: p.at(697, 497) == (51, 102, 153) and p.at(697, 45) == (51, 102, 153),
                   "larger picture")
        self.tool("windowsize", self.window, 1, 1)
        self.tool("windowsize", self.window, 300, 200)
        self.until(lambda p: p.at(297, 197) == (51, 102, 153) and p.at(310, 100) == (0, 0, 0),
                   "smaller picture")

    def test_full_screen_by_key_and_back(self):
        self.start("--gaze", "0.5,0.5", "--render.background", "0.2 0.4 0.6")
        self.move(100, 100)
        self.tool("key", "f")
        self.until(lambda p: p.at(897, 697) == (51, 102, 153), "full screen")
        self.tool("key", "f")
        self.until(lambda p: p.at(897, 697) == (0, 0, 0), "a window again")

    def start_to_lose(self, *more):
        library = os.environ.get("LOSE_CONTEXT_LIBRARY")
        if not library:
            self.skipTest("LOSE_CONTEXT_LIBRARY names nothing to preload")
        self.lost = os.path.join(self.place.name, "lost")
        self.addCleanup(lambda: os.path.exists(self.lost) and os.unlink(self.lost))
        kept = self.environment
        self.addCleanup(setattr, self, "environment", kept)
        # The runtime of a sanitizer must accept not to be loaded first.
        self.environment = dict(kept, LD_PRELOAD=library, LOSE_CONTEXT=self.lost, GZ_LOG="info")
        self.environment["ASAN_OPTIONS"] += ":verify_asan_link_order=0"
        self.start(*more)

    def lose(self):
        """Lose the context and wait for the next window's picture."""
        open(self.lost, "w", encoding="utf-8").close()
        # Wakes a viewer that waits; another one may have no window by now.
        self.tool("mousemove", 200 + int(self.window) % 2, 100)
        self.wait_for(lambda: not os.path.exists(self.lost), "the question whether it is lost")

    def test_lost_context_is_replaced_and_the_picture_is_there_again(self):
        for backend in ("cpu", "gl"):
            self.start_to_lose("--gaze", "0.5,0.5", "--method", "standard", "--backend", backend,
                               "--render.background", "0.2 0.4 0.6")
            # Settings and place are kept.
            self.tool("windowsize", self.window, 500, 400)
            self.until(lambda p: p.at(497, 397) == (51, 102, 153), "a place")
            self.tool("key", "4")
            before = self.rest()
            self.lose()
            self.found(than=self.window)
            self.until(lambda p: self.below_line(p, 500, 400) == self.below_line(before, 500, 400),
                       "the same picture with " + backend)
            self.viewer.terminate()
            said = self.messages()
            self.assertEqual(said.count("has lost the window's context"), 1, said)
            self.assertNotIn("the cpu backend casts", said)

    def test_second_lost_context_switches_to_cpu_and_third_ends(self):
        self.start_to_lose("--gaze", "0.5,0.5", "--method", "standard", "--backend", "gl")
        before = self.rest()
        for _ in range(2):
            self.lose()
            self.found(than=self.window)
            self.until(lambda p: self.below_line(p) == self.below_line(before) or
                       self.close(p, before), "the picture")
        open(self.lost, "w", encoding="utf-8").close()
        self.assertEqual(self.viewer.wait(timeout=PATIENCE_S), 1)
        said = self.messages()
        self.assertEqual(said.count("the cpu backend casts the rays from now on"), 1, said)
        self.assertIn("--headless", said.splitlines()[-1])

    def close(self, one, other):
        """Whether pictures of different backends are equal, within a grey level."""
        return all(abs(a - b) <= 1 for x in range(100, 380, 7) for y in range(60, 250, 7)
                   for a, b in zip(one.at(x, y), other.at(x, y)))

    def test_without_a_daemon_it_says_so_and_takes_the_mouse(self):
        self.start("--cross")
        self.move(200, 150)
        picture = self.until(lambda p: self.cross_at(p, 200, 150), "cross at the mouse")
        self.assertTrue(self.amber(picture), "the line is not amber")

    def test_daemon_leads_the_gaze_and_may_die_and_return(self):
        self.start_daemon()
        self.start("--cross", "--gaze-fills-window")
        self.move(60, 280)
        place = (60, 280)
        for what in ("cross led by the daemon", "cross led elsewhere"):
            old = place
            picture = self.until(
                lambda p: not self.amber(p) and self.red_middle(p) not in (None, old), what
            )
            place = self.red_middle(picture)
        self.stop_daemon()
        self.until(lambda p: self.amber(p) and self.cross_at(p, 60, 280), "mouse stands in")
        self.start_daemon()
        self.until(lambda p: not self.amber(p) and not self.cross_at(p, 60, 280), "daemon again")
        self.tool("key", "m")
        self.until(lambda p: not self.amber(p) and self.cross_at(p, 60, 280), "mouse by choice")

    def record(self, name):
        """Begin a recording and end the one before. -> its file"""
        run(GAZECTL, "stop", env=self.environment)
        done = run(GAZECTL, "record", name, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def log_lines(self, path, kind):
        """The fields of all records of a kind that have been written so far."""
        with open(path, encoding="utf-8") as log:
            lines = log.read().splitlines()
        return [line.split("\t") for line in lines if line.startswith(kind + "\t")]

    def rects(self, path):
        return [line[2:] for line in self.log_lines(path, "!window")]

    def until_logged(self, path, rect):
        self.wait_for(lambda: rect in self.rects(path), "a record of %r" % rect)

    def test_pointer_goes_through_the_daemon_and_leads_the_gaze(self):
        self.start_daemon("--driver=pointer")
        self.start("--gaze", "pointer", "--cross")
        for x, y in ((150, 200), (330, 120)):
            self.move(x, y)
            picture = self.until(
                lambda p: not self.amber(p) and self.near(self.red_middle(p), (x, y)),
                "cross at the pointer %d" % x)
        # Outside the window the last place holds.
        self.tool("mousemove", *SCREEN)
        self.until(lambda p: self.near(self.red_middle(p), (330, 120)), "cross stays")
        # A daemon with another tracker gives no pointer; without a daemon the mouse stands in.
        self.stop_daemon()
        self.move(150, 200)
        self.until(lambda p: self.amber(p) and self.cross_at(p, 150, 200), "mouse stands in")

    def test_window_is_told_to_the_log_at_start_when_moved_and_when_resized(self):
        self.recordings = tempfile.TemporaryDirectory(prefix="gazecast-test-recordings-")
        self.addCleanup(self.recordings.cleanup)
        self.start_daemon("--driver=sim", "--recording.directory=" + self.recordings.name)
        self.start("--gaze", "daemon")
        self.until(lambda p: not self.amber(p), "a daemon")
        self.until_logged(self.record("first"), ["0", "0", "480", "320"])
        path = self.record("later")
        self.tool("windowmove", self.window, 100, 50)
        self.until_logged(path, ["100", "50", "480", "320"])
        self.tool("windowsize", self.window, 500, 400)
        self.until_logged(path, ["100", "50", "500", "400"])
        self.stop_daemon()
        rects = self.rects(path)
        self.assertEqual(rects[0], ["0", "0", "480", "320"])
        self.assertEqual(rects[-1], ["100", "50", "500", "400"])
        self.assertIn(["100", "50", "480", "320"], rects)
        self.assertLess(len(rects), 12)

    def test_still_window_takes_no_processor_time(self):
        self.start("--gaze", "mouse")
        self.move(200, 150)
        self.tool("key", "c")
        self.until(lambda p: self.cross_at(p, 200, 150), "cross at the mouse")
        self.assertLess(self.processor_share(), 0.03)

    def test_escape_closes_panels_before_it_quits(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(200, 150)
        before = self.rest()
        # The curve has the keyboard first, and gives it back.
        for key, times in (("p", 1), ("e", 2)):
            self.tool("key", key)
            self.until_changed(before, "panel of " + key)
            for _ in range(times):
                self.rest()
                self.tool("key", "Escape")
            place = (100, 60, 470, 240)
            self.until(lambda p: p.part(*place) == before.part(*place), "the picture")
            self.assertIsNone(self.viewer.poll())
        self.tool("key", "Escape")
        self.assertEqual(self.viewer.wait(timeout=PATIENCE_S), 0)
        self.viewer = None

    def test_escape_and_q_end_it(self):
        for key in ("Escape", "q"):
            self.start("--gaze", "mouse")
            self.move(200, 150)
            self.tool("key", key)
            self.assertEqual(self.viewer.wait(timeout=PATIENCE_S), 0)
            self.assertEqual(self.viewer.communicate()[1], "")
            self.viewer = None

    def test_no_display_is_one_line_that_suggests_headless(self):
        environment = dict(self.environment)
        del environment["DISPLAY"]
        done = run(GAZEVIEW, SCENE, env=environment)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("--headless", done.stderr)

    def test_old_opengl_is_one_line_that_suggests_headless(self):
        environment = dict(self.environment, MESA_GL_VERSION_OVERRIDE="2.1")
        done = run(GAZEVIEW, SCENE, env=environment)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("OpenGL 3.3", done.stderr)
        self.assertIn("--headless", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
