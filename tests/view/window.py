"""gazeview's window, driven by keys and mouse under Xvfb with Mesa's software OpenGL.

window.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from picture import Picture, run, skip, write_scene
from xserver import start_server

GAZEVIEW, GAZED, SCENES = sys.argv[1:4]
SHOTS = sys.argv[4] if len(sys.argv) > 4 else None
GAZECTL = os.environ.get("GAZECTL", "gazectl")
PLACE = tempfile.TemporaryDirectory(prefix="gazecast-test-scene-")
SCENE = write_scene(PLACE.name, SCENES)
SCREEN = (900, 700)
SIZE = (480, 320)
CROSS = (255, 64, 64)
LINE_HEIGHT = 40  # the text line is above

for tool in ("Xvfb", "xdotool", "ffmpeg"):
    if not shutil.which(tool):
        skip(tool + " is not installed")


class Window(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server, display = start_server(SCREEN)
        cls.place = tempfile.TemporaryDirectory(prefix="gazecast-test-window-")
        cls.environment = dict(
            os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1",
            GAZECAST_RUNTIME_DIR=cls.place.name,
            # Mesa's drivers keep some bytes when they are unloaded, which leaves no name to excuse
            # them by; what is ours is looked at by the tests without a window.
            ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0",
        )
        cls.environment.pop("WAYLAND_DISPLAY", None)

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()
        cls.server.wait()
        cls.place.cleanup()

    def setUp(self):
        self.viewer = self.daemon = None
        self.addCleanup(self.stop)
        self.addCleanup(self.stop_daemon)

    def stop(self):
        if self.viewer and self.viewer.poll() is None:
            self.viewer.kill()
        if self.viewer:
            self.viewer.communicate()

    def start_daemon(self, *more):
        more = more or ("--driver=sim", "--sim.blinks_per_min=0")
        self.daemon = subprocess.Popen(
            [GAZED, "--tcp=off", *more], env=self.environment,
            stderr=subprocess.DEVNULL,
        )

    def stop_daemon(self):
        if self.daemon:
            self.daemon.terminate()
            self.daemon.wait()
        self.daemon = None

    def tool(self, *words):
        done = run("xdotool", *words, env=self.environment)
        self.assertEqual(done.returncode, 0, "xdotool %r: %s" % (words, done.stderr))
        return done.stdout

    def start(self, *more):
        self.tool("mousemove", *SCREEN)
        self.viewer = subprocess.Popen(
            [GAZEVIEW, SCENE, "--size", "%dx%d" % SIZE, *more], env=self.environment,
            stderr=subprocess.PIPE, text=True,
        )
        found = run("timeout", 20, "xdotool", "search", "--sync", "--onlyvisible", "--name",
                    "^gazeview$", env=self.environment)
        self.assertEqual(found.returncode, 0, "no window appears")
        self.window = found.stdout.split()[0]
        self.until(lambda p: len({p.at(x, y) for x in range(100, 380, 4)
                                  for y in range(60, 300, 4)}) > 20, "a first picture")

    def grab(self):
        done = subprocess.run(
            ["ffmpeg", "-loglevel", "error", "-f", "x11grab", "-draw_mouse", "0", "-video_size",
             "%dx%d" % SCREEN, "-i", self.environment["DISPLAY"], "-frames:v", "1", "-f",
             "rawvideo", "-pix_fmt", "rgb24", "-"],
            capture_output=True, timeout=20, env=self.environment,
        )
        width, height = SCREEN
        self.assertEqual(len(done.stdout), 3 * width * height, done.stderr)
        rows = [done.stdout[3 * width * y : 3 * width * (y + 1)] for y in range(height)]
        return Picture(width, height, rows)

    def until(self, good, what):
        """The first screenshot that @good accepts; whoever waits longer than 15 s has failed."""
        deadline = time.monotonic() + 15
        while True:
            self.assertIsNone(self.viewer.poll(), "gazeview has ended")
            picture = self.grab()
            if good(picture):
                break
            self.assertLess(time.monotonic(), deadline, "never came: " + what)
        if SHOTS:
            name = "%s-%s.png" % (self.id().rsplit("_test_", 1)[-1].split(".")[-1], what)
            subprocess.run(
                ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
                 "-video_size", "%dx%d" % SCREEN, "-i", "-",
                 os.path.join(SHOTS, name.replace(" ", "-"))],
                input=b"".join(bytes(row) for row in picture.rows), check=True,
            )
        return picture

    def below_line(self, picture, width=SIZE[0], height=SIZE[1]):
        return picture.part(0, LINE_HEIGHT, width, height)

    def until_changed(self, before, what):
        old = self.below_line(before)
        return self.until(lambda p: self.below_line(p) != old, what)

    def move(self, x, y):
        self.tool("mousemove", "--window", self.window, x, y)

    def cross_at(self, picture, x, y):
        """A red upright cross whose middle is there, to a pixel or two."""
        arms = ((0, 0), (8, 0), (-8, 0), (0, 8), (0, -8))
        return any(
            all(picture.at(x + a + i, y + b + j) == CROSS for a, b in arms)
            for i in (-1, 0, 1) for j in (-1, 0, 1)
        )

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
        self.move(20, 60)  # most of the window is far from there
        pictures = {}
        before = self.grab()
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

    def test_moved_gaze_makes_its_place_sharp(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(100, 100)
        sharp = self.grab()
        self.tool("key", "4")
        place = (320, 140, 380, 200)
        self.until(lambda p: p.part(*place) != sharp.part(*place), "blurred there")
        self.move(350, 170)
        self.until(lambda p: p.part(340, 160, 360, 180) == sharp.part(340, 160, 360, 180),
                   "sharp there")

    def test_drag_turns_wheel_zooms_and_r_brings_both_back(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(240, 160)
        first = self.grab()
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
        # By a method that no gaze changes: with the mouse outside, others widen after a while.
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.grab()
        self.tool("key", "h")
        self.until_changed(before, "keys shown")
        self.tool("key", "question")
        self.until(lambda p: self.below_line(p) == self.below_line(before), "keys hidden")

    def test_settings_are_changed_in_the_panel_while_the_gaze_stays(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.move(100, 300)
        small = self.grab()
        self.tool("windowsize", self.window, 700, 500)
        self.until_changed(small, "larger")
        self.move(101, 301)
        time.sleep(0.5)  # the last of several sizes
        before = self.grab()
        shown, panel = (100, 50, 310, 490), (330, 40, 680, 200)
        self.tool("key", "p")
        self.until(lambda p: p.part(*panel) != before.part(*panel), "settings")
        self.move(500, 142)  # the heading Clip
        time.sleep(0.3)
        folded = self.grab()
        self.tool("click", 1)
        self.until(lambda p: p.part(330, 155, 680, 200) != folded.part(330, 155, 680, 200),
                   "clip box")
        self.assertTrue(self.grab().part(*shown) == before.part(*shown), "the panel is the mouse's")
        self.move(515, 165)  # the first slider of least
        time.sleep(0.3)
        self.tool("click", 1)
        self.until(lambda p: p.part(*shown) != before.part(*shown), "clipped")
        self.tool("key", "p")
        self.move(101, 300)
        self.until(lambda p: p.part(600, 40, 690, 60) == before.part(600, 40, 690, 60), "no panel")

    def test_letters_come_and_go(self):
        self.start("--gaze", "mouse")
        self.move(20, 60)
        edge = (450, 140, 478, 180)
        before = self.grab()
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
        kept = self.environment
        self.addCleanup(setattr, self, "environment", kept)
        # The shared objects of a sanitizer must not insist on being first.
        self.environment = dict(kept, LD_PRELOAD=library, LOSE_CONTEXT=self.lost, GZ_LOG="info")
        self.environment["ASAN_OPTIONS"] += ":verify_asan_link_order=0"
        self.start(*more)

    def lose(self):
        """The context is lost, and its window gone; the next one shows a picture."""
        open(self.lost, "w", encoding="utf-8").close()
        self.move(200 + len(self.window) % 2, 100)
        deadline = time.monotonic() + 15
        while os.path.exists(self.lost):
            self.assertIsNone(self.viewer.poll(), "gazeview has ended")
            self.assertLess(time.monotonic(), deadline, "nobody asks whether it is lost")
            time.sleep(0.02)

    def found_anew(self):
        deadline = time.monotonic() + 20
        while True:
            # A search fails also where a window goes while it looks.
            found = run("xdotool", "search", "--onlyvisible", "--name", "^gazeview$",
                        env=self.environment)
            if found.returncode == 0 and found.stdout.split():
                self.window = found.stdout.split()[-1]
                return
            self.assertLess(time.monotonic(), deadline, "no window appears")
            time.sleep(0.05)

    def messages(self):
        """What the viewer has said, once it has ended."""
        said = self.viewer.communicate(timeout=20)[1]
        self.viewer = None
        return said

    def test_lost_context_is_replaced_and_the_picture_is_there_again(self):
        for backend in ("cpu", "gl"):
            self.start_to_lose("--gaze", "0.5,0.5", "--method", "standard", "--backend", backend,
                               "--render.background", "0.2 0.4 0.6")
            # The settings and the place stay, too.
            self.tool("windowsize", self.window, 500, 400)
            self.until(lambda p: p.at(497, 397) == (51, 102, 153), "a place")
            self.tool("key", "4")
            time.sleep(0.5)
            before = self.grab()
            self.lose()
            self.found_anew()
            self.until(lambda p: self.below_line(p, 500, 400) == self.below_line(before, 500, 400),
                       "the same picture with " + backend)
            self.viewer.terminate()
            said = self.messages()
            self.assertEqual(said.count("has lost the window's context"), 1, said)
            self.assertNotIn("the cpu backend casts", said)

    def test_context_lost_again_leaves_the_rays_to_the_cpu_and_a_third_time_ends(self):
        self.start_to_lose("--gaze", "0.5,0.5", "--method", "standard", "--backend", "gl")
        before = self.grab()
        for _ in range(2):
            self.lose()
            self.found_anew()
            self.until(lambda p: self.below_line(p) == self.below_line(before) or
                       self.close(p, before), "the picture")
        open(self.lost, "w", encoding="utf-8").close()
        self.assertEqual(self.viewer.wait(timeout=20), 1)
        said = self.messages()
        self.assertEqual(said.count("the cpu backend casts the rays from now on"), 1, said)
        self.assertIn("--headless", said.splitlines()[-1])

    def close(self, one, other):
        """Within a grey level: another backend."""
        return all(abs(a - b) <= 1 for x in range(100, 380, 7) for y in range(60, 300, 7)
                   for a, b in zip(one.at(x, y), other.at(x, y)))

    def test_without_a_daemon_it_says_so_and_takes_the_mouse(self):
        self.start("--cross")
        self.move(200, 150)
        picture = self.until(lambda p: self.cross_at(p, 200, 150), "cross at the mouse")
        self.assertTrue(self.amber(picture), "the line is not amber")

    def amber(self, picture):
        return 100 < sum(
            r > 180 and 100 < g < 220 and b < 120
            for r, g, b in (picture.at(x, y) for x in range(8, 470) for y in range(8, 30))
        )

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

    def log_lines(self, kind):
        """The fields of all records of that kind, once the recording is whole."""
        names = os.listdir(self.recordings.name)
        self.assertEqual(len(names), 1, names)
        with open(os.path.join(self.recordings.name, names[0]), encoding="utf-8") as log:
            lines = log.read().splitlines()
        self.assertTrue(lines[-1].startswith("#end "), lines[-1])
        return [line.split("\t") for line in lines if line.startswith(kind + "\t")]

    def test_pointer_goes_through_the_daemon_and_leads_the_gaze(self):
        self.start_daemon("--driver=pointer")
        self.start("--gaze", "pointer", "--cross")
        for x, y in ((150, 200), (330, 120)):
            self.move(x, y)
            picture = self.until(
                lambda p: not self.amber(p) and self.near(self.red_middle(p), (x, y)),
                "cross at the pointer %d" % x)
        # Out of the window: the last place holds.
        self.tool("mousemove", *SCREEN)
        self.until(lambda p: self.near(self.red_middle(p), (330, 120)), "cross stays")
        # A daemon with another tracker is no pointer, and one that is gone leaves the mouse.
        self.stop_daemon()
        self.move(150, 200)
        self.until(lambda p: self.amber(p) and self.cross_at(p, 150, 200), "mouse stands in")

    def near(self, place, wanted):
        return place and all(abs(a - b) <= 3 for a, b in zip(place, wanted))

    def test_window_is_told_to_the_log_at_start_when_moved_and_when_resized(self):
        self.recordings = tempfile.TemporaryDirectory(prefix="gazecast-test-recordings-")
        self.addCleanup(self.recordings.cleanup)
        self.start_daemon("--driver=sim", "--recording.directory=" + self.recordings.name)
        self.start("--gaze", "daemon")
        self.until(lambda p: not self.amber(p), "a daemon")
        time.sleep(1.2)  # the window is told each second, so the daemon knows it by now
        done = run(GAZECTL, "record", "later", env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.tool("windowmove", self.window, 100, 50)
        self.until(lambda p: p.at(50, 25) == (0, 0, 0), "moved")
        self.tool("windowsize", self.window, 500, 400)
        self.until(lambda p: p.at(590, 440) != (0, 0, 0), "resized")
        time.sleep(0.5)
        self.stop_daemon()
        rects = [line[2:] for line in self.log_lines("!window")]
        self.assertEqual(rects[0], ["0", "0", "480", "320"])
        self.assertEqual(rects[-1], ["100", "50", "500", "400"])
        self.assertIn(["100", "50", "480", "320"], rects)
        self.assertLess(len(rects), 12)

    def red_middle(self, picture):
        """The middle of all that has the cross's colour, or None."""
        places = [
            (x, y) for y in range(LINE_HEIGHT, SIZE[1], 2) for x in range(SIZE[0])
            if picture.at(x, y) == CROSS
        ]
        if not places:
            return None
        return tuple(sum(place[i] for place in places) // len(places) for i in (0, 1))

    def test_still_window_takes_no_processor_time(self):
        self.start("--gaze", "mouse")
        self.move(200, 150)
        self.tool("key", "c")
        self.until(lambda p: self.cross_at(p, 200, 150), "cross at the mouse")

        def ticks():
            with open("/proc/%d/stat" % self.viewer.pid, encoding="ascii") as stat:
                fields = stat.read().rsplit(")", 1)[1].split()
            return int(fields[11]) + int(fields[12])

        before, start = ticks(), time.monotonic()
        time.sleep(2)  # what is measured is a rest
        used = (ticks() - before) / os.sysconf("SC_CLK_TCK") / (time.monotonic() - start)
        self.assertLess(used, 0.03)

    def test_escape_and_q_end_it(self):
        for key in ("Escape", "q"):
            self.start("--gaze", "mouse")
            self.move(200, 150)
            self.tool("key", key)
            self.assertEqual(self.viewer.wait(timeout=15), 0)
            self.assertEqual(self.viewer.communicate()[1], "")
            self.viewer = None

    def test_no_display_is_one_line_with_the_way_without_one(self):
        environment = dict(self.environment)
        del environment["DISPLAY"]
        done = run(GAZEVIEW, SCENE, env=environment)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("--headless", done.stderr)

    def test_old_opengl_is_one_line_with_the_way_without_it(self):
        environment = dict(self.environment, MESA_GL_VERSION_OVERRIDE="2.1")
        done = run(GAZEVIEW, SCENE, env=environment)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("OpenGL 3.3", done.stderr)
        self.assertIn("--headless", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
