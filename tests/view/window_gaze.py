"""The gaze in gazeview's window: sources, corner, trail, freeze, displays.

window_gaze.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import json
import os
import signal
import sys
import tempfile
import time
import unittest

from picture import PATIENCE_S, run
from window_case import GAZECTL, LINE_HEIGHT, WindowCase


class Gaze(WindowCase):
    def red(self, picture):
        return self.corner_has(picture, lambda r, g, b: r > 200 and 60 < g < 120 and b < 110)

    def plain(self, picture):
        return self.corner_has(picture, lambda r, g, b: min(r, g, b) > 180)

    def rows(self, said, what):
        return [line for line in said.splitlines() if what in line]

    def record(self):
        """Record a gaze log of about a second. -> path"""
        folder = tempfile.TemporaryDirectory(prefix="gazecast-test-recordings-")
        self.addCleanup(folder.cleanup)
        self.start_daemon("--driver=sim", "--sim.blinks_per_min=0",
                          "--recording.directory=" + folder.name)
        self.wait_for(
            lambda: run(GAZECTL, "record", "short", env=self.environment).returncode == 0,
            "a recording")
        time.sleep(1)  # the time that is recorded
        self.stop_daemon()
        names = os.listdir(folder.name)
        self.assertEqual(len(names), 1, names)
        return os.path.join(folder.name, names[0])

    def test_log_gives_the_gaze_until_its_end_and_m_reaches_it_again(self):
        path = self.record()
        self.start("--gaze", path, "--cross", "--method", "standard")
        self.until(self.amber, "its end")
        self.move(60, 200)
        self.tool("key", "m")
        self.until(lambda p: self.cross_at(p, 240, 160), "led by a fixed point")
        self.tool("key", "m", "m")
        self.until(lambda p: self.cross_at(p, 60, 200), "led by the mouse")
        # Over the pointer to the log again, from its start.
        self.tool("key", "m", "m")
        self.until(lambda p: not self.cross_at(p, 60, 200), "led by the log")
        self.until(self.amber, "its end again")

    def test_m_goes_from_the_daemon_to_the_mouse_to_a_fixed_point_and_back(self):
        self.start_daemon("--driver=sim", "--sim.blinks_per_min=0")
        self.start("--cross", "--gaze-fills-window")
        self.move(60, 200)
        self.until(lambda p: self.plain(p) and self.red_middle(p) and
                   not self.cross_at(p, 60, 200), "led by the daemon")
        self.tool("key", "m")
        self.until(lambda p: self.cross_at(p, 60, 200), "led by the mouse")
        # The daemon reads no pointer, and no endpoint or log was named.
        self.tool("key", "m")
        self.until(lambda p: self.cross_at(p, 240, 160), "led by a fixed point")
        self.move(70, 210)
        self.tool("key", "m")
        self.until(lambda p: self.plain(p) and not self.cross_at(p, 240, 160) and
                   not self.cross_at(p, 70, 210), "led by the daemon again")

    def test_m_reaches_the_pointer_where_the_daemon_reads_it(self):
        self.start_daemon("--driver=pointer")
        self.start("--cross", "--gaze", "pointer")
        self.move(150, 200)
        self.until(lambda p: self.plain(p) and self.near(self.red_middle(p), (150, 200)),
                   "led by the pointer")
        self.tool("key", "m")  # no endpoint, no log
        self.until(lambda p: self.cross_at(p, 240, 160), "led by a fixed point")
        self.tool("key", "m")
        self.tool("key", "m")
        self.until(lambda p: self.cross_at(p, 150, 200), "led by the mouse")

    def test_corner_turns_amber_and_red_when_the_daemon_is_stopped_and_plain_when_it_goes_on(self):
        self.start_daemon("--driver=sim", "--sim.blinks_per_min=0")
        self.start("--gaze-fills-window", "--method", "standard")
        self.until(self.plain, "plain")
        os.kill(self.daemon.pid, signal.SIGSTOP)
        try:
            self.until(self.red, "red")
        finally:
            os.kill(self.daemon.pid, signal.SIGCONT)
        self.until(lambda p: self.plain(p) and not self.red(p) and not self.amber(p),
                   "plain again")
        self.stop_daemon()
        self.until(self.amber, "amber without a daemon")

    def test_frozen_picture_stays_while_the_cross_moves_on(self):
        self.start("--gaze", "mouse", "--cross", "--method", "acuity")
        self.move(120, 120)
        self.until(lambda p: self.cross_at(p, 120, 120), "cross")
        place = (300, 60, 380, 160)
        before = self.rest().part(*place)
        self.tool("key", "space")
        self.move(240, 200)
        self.move(340, 230)
        after = self.until(lambda p: self.cross_at(p, 340, 230), "cross moved")
        self.assertTrue(after.part(*place) == before, "the plan went with the gaze")
        self.tool("key", "space")
        self.until(lambda p: p.part(*place) != before, "the plan follows")

    def scene_is_still(self):
        done = run(GAZECTL, "status", "--json", env=self.environment)
        return done.returncode == 0 and json.loads(done.stdout)["still_scene"]

    def test_daemon_is_told_whether_anything_moves_in_the_scene(self):
        self.start_daemon("--driver=pointer")
        self.start("--gaze", "pointer")
        self.move(200, 150)
        self.wait_for(self.scene_is_still, "still")
        self.tool("key", "Left")  # turns the camera
        self.wait_for(lambda: not self.scene_is_still(), "moving")

    def test_trail_comes_by_key_and_fades(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(20, 70)
        self.until(self.plain, "corner")
        place = (60, LINE_HEIGHT, 200, 200)
        before = self.rest().part(*place)
        self.tool("key", "t")
        for x in range(40, 240, 10):
            self.move(x, 80 + x // 4)
        self.until(lambda p: p.part(*place) != before, "trail")
        self.until(lambda p: p.part(*place) == before, "faded")
        self.tool("key", "t")

    def test_d_fills_the_trackers_display_and_goes_back(self):
        self.start("--gaze", "0.5,0.5", "--render.background", "0.2 0.4 0.6")
        self.move(100, 100)
        self.tool("key", "d")
        self.until(lambda p: p.at(897, 697) == (51, 102, 153), "full screen")
        self.tool("key", "d")
        self.until(lambda p: p.at(897, 697) == (0, 0, 0), "a window again")

    def start_on_two(self, *more):
        """Make each half of the screen a monitor."""
        library = os.environ.get("TWO_MONITORS_LIBRARY")
        if not library:
            self.skipTest("TWO_MONITORS_LIBRARY names nothing to preload")
        self.unplug = os.path.join(self.place.name, "unplug")
        kept = self.environment
        self.addCleanup(setattr, self, "environment", kept)
        self.environment = dict(kept, LD_PRELOAD=library, UNPLUG_MONITOR=self.unplug)
        self.environment["ASAN_OPTIONS"] += ":verify_asan_link_order=0"
        self.start("--render.background", "0.2 0.4 0.6", *more)
        self.tool("windowsize", self.window, 440, 300)
        self.tool("windowmove", self.window, 0, 0)

    def test_window_beside_the_trackers_display_says_so_and_d_goes_there_and_back(self):
        self.start_daemon("--driver=sim", "--sim.blinks_per_min=0")
        self.start_on_two("--tracker-display", "RIGHT")
        blue, black = (51, 102, 153), (0, 0, 0)
        self.until(lambda p: p.at(430, 100) == blue and self.amber(p), "on the other display")
        self.tool("key", "d")
        picture = self.until(lambda p: p.at(890, 600) == blue and p.at(455, 600) == blue,
                             "on the tracker's display")
        self.assertEqual((picture.at(100, 600), picture.at(440, 200)), (black, black))
        self.tool("key", "d")
        self.until(lambda p: p.at(890, 600) == black and p.at(430, 100) == blue, "back")

    def test_window_on_an_unplugged_monitor_moves_to_another_with_a_message(self):
        self.start_on_two("--tracker-display", "2", "--gaze", "0.5,0.5")
        blue = (51, 102, 153)
        self.tool("key", "d")
        self.until(lambda p: p.at(890, 600) == blue and p.at(100, 600) != blue, "on the right")
        open(self.unplug, "w", encoding="utf-8").close()
        self.tool("key", "c")  # an event
        self.until(lambda p: p.at(5, 600) == blue, "on the left")
        self.viewer.terminate()
        said = self.viewer.communicate(timeout=PATIENCE_S)[1]
        self.viewer = None
        self.assertEqual(len(self.rows(said, "monitor RIGHT has gone")), 1, said)

    def test_panel_shows_the_sources_and_takes_another(self):
        self.start("--gaze", "0.5,0.5", "--cross", "--method", "standard")
        self.tool("windowsize", self.window, 700, 500)
        self.until(lambda p: self.cross_at(p, 350, 250), "larger")
        before = self.rest()
        self.tool("key", "g")
        self.until(lambda p: p.part(20, 50, 340, 300) != before.part(20, 50, 340, 300), "panel")
        self.move(600, 250)
        # The second row is the mouse.
        self.tool("mousemove", "--window", self.window, 60, 90)
        self.tool("click", 1)
        self.until(lambda p: not self.cross_at(p, 350, 250), "no fixed point any more")
        for y in (290, 300):  # the first is still in the panel
            self.move(600, y)
            self.grab()
        self.until(lambda p: self.cross_at(p, 600, 300), "led by the mouse")
        self.tool("key", "g")
        self.until(lambda p: p.part(20, 50, 300, 200) == before.part(20, 50, 300, 200), "no panel")

    def test_unknown_monitor_is_a_warning(self):
        self.start("--gaze", "mouse", "--tracker-display", "DP-9")
        self.viewer.terminate()
        said = self.viewer.communicate(timeout=PATIENCE_S)[1]
        self.viewer = None
        self.assertEqual(len(self.rows(said, "DP-9")), 1, said)
        self.assertIn("no such monitor", said)

    def test_resting_gaze_of_a_daemon_takes_hardly_any_processor_time(self):
        if os.environ.get("SANITIZED"):
            self.skipTest("a sanitizer takes time of its own")
        for rate in (60, 1000):
            self.start_daemon("--driver=pointer", "--pointer.rate_hz=%d" % rate)
            self.start("--gaze", "pointer")
            self.move(200, 150)
            self.until(lambda p: self.plain(p) and not self.amber(p), "a gaze")
            self.until(lambda p: self.processor_share(1) < 0.1, "it has come to rest")
            # The least of several: others use the machine too.
            self.assertLess(min(self.processor_share() for _ in range(3)), 0.03,
                            "at %d Hz" % rate)
            self.stop()
            self.stop_daemon()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
