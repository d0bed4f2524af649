"""Shared by the tests of gazeview's window: an X server without a monitor, the window on it, keys and
mouse by xdotool, and screenshots. Each test is called as

    NAME.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from picture import PATIENCE_S, Picture, run, skip, write_scene
from xserver import Screen, start_server

GAZEVIEW, GAZED, SCENES = sys.argv[1:4]
SHOTS = sys.argv[4] if len(sys.argv) > 4 else None
GAZECTL = os.environ.get("GAZECTL", "gazectl")
PLACE = tempfile.TemporaryDirectory(prefix="gazecast-test-scene-")
SCENE = write_scene(PLACE.name, SCENES)
SCREEN = (900, 700)
SIZE = (480, 320)
CROSS = (255, 64, 64)
GROUND = (23, 26, 31)  # of a window without a scene
LINE_HEIGHT = 40  # the caption at the top
CORNER = (60, 200, SIZE[0], SIZE[1])  # where messages are
CORNER_HEIGHT = 64  # the caption of the gaze at the bottom

for tool in ("Xvfb", "xdotool"):
    if not shutil.which(tool):
        skip(tool + " is not installed")


class WindowCase(unittest.TestCase):
    menu = "no"  # most tests look at the picture, which the bar covers …
    refine = "no"  # … and which is another one at rest

    @classmethod
    def setUpClass(cls):
        cls.server, display = start_server(SCREEN)
        cls.screen = Screen(cls.server, display, SCREEN)
        cls.place = tempfile.TemporaryDirectory(prefix="gazecast-test-window-")
        cls.environment = dict(
            os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1",
            GAZECAST_RUNTIME_DIR=cls.place.name, XDG_STATE_HOME=cls.place.name,
            # Mesa's drivers leak some bytes and are unloaded before the report, so that no
            # suppression can name them. Tests without a window look for our leaks.
            ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0",
        )
        cls.environment.pop("WAYLAND_DISPLAY", None)

    @classmethod
    def tearDownClass(cls):
        cls.screen.close()
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
        self.viewer = None

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

    def launch(self, *words):
        """Start gazeview with exactly these arguments, and wait for its window."""
        self.tool("mousemove", *SCREEN)
        self.viewer = subprocess.Popen(
            [GAZEVIEW, "--size", "%dx%d" % SIZE, "--menu=%s" % self.menu,
             *self.scene_keys(words), *words], env=self.environment,
            stderr=subprocess.PIPE, text=True,
        )
        found = run("timeout", PATIENCE_S, "xdotool", "search", "--sync", "--onlyvisible", "--name",
                    "gazeview$", env=self.environment)
        self.assertEqual(found.returncode, 0, "no window appears")
        self.window = found.stdout.split()[0]

    def scene_keys(self, words):
        """An experiment has settings of its own."""
        return () if "--experiment" in words else (
            "--view.refine=%s" % self.refine, "--view.gaze_mark=no")

    def start(self, *more, scene=SCENE):
        """Start gazeview with a scene, by default the small one. -> its first picture"""
        self.launch(scene, *more)
        return self.until(self.shows_something, "a first picture")

    def shows_something(self, picture):
        """Whether a scene is shown, not the progress of its loading."""
        return picture.at(5, 5) != GROUND and len({picture.at(x, y) for x in range(100, 380, 4) for y in range(60, 300, 4)}) > 20

    def grab(self):
        """A screenshot: one that stays for a moment, unless the window never rests."""
        shown = self.screen.grab()
        for _ in range(5):
            time.sleep(0.02)
            before, shown = shown, self.screen.grab()
            if shown == before:
                break
        width, height = SCREEN
        pixels = bytearray(3 * width * height)
        pixels[0::3], pixels[1::3], pixels[2::3] = shown[2::4], shown[1::4], shown[0::4]
        rows = [bytes(pixels[3 * width * y : 3 * width * (y + 1)]) for y in range(height)]
        return Picture(width, height, rows)

    def ticks(self):
        """Processor time of the viewer so far, clock ticks."""
        return self.ticks_of(self.viewer)

    def ticks_of(self, process):
        with open("/proc/%d/stat" % process.pid, encoding="ascii") as stat:
            fields = stat.read().rsplit(")", 1)[1].split()
        return int(fields[11]) + int(fields[12])

    def waits(self, process):
        """Whether all threads of a process wait, however busy the machine is."""
        threads = "/proc/%d/task" % process.pid
        for thread in os.listdir(threads):
            try:
                with open("%s/%s/stat" % (threads, thread), encoding="ascii") as stat:
                    if stat.read().rsplit(")", 1)[1].split()[0] in "RD":
                        return False
            except FileNotFoundError:
                pass  # the thread has ended
        return True

    def until_idle(self, *others):
        """Wait until the server has passed everything on and the viewer, and other processes, have
        nothing more to do."""
        all_of_them = (self.server, self.viewer, *others)
        still, before = 0, None

        def rests():
            nonlocal still, before
            now = [self.ticks_of(process) for process in all_of_them]
            still = still + 1 if now == before and all(map(self.waits, all_of_them)) else 0
            before = now
            return still == 6

        self.wait_for(rests, "a viewer at rest", pause_s=0.02)

    def rest(self):
        """A screenshot once the viewer has nothing more to do."""
        self.until_idle()
        return self.grab()

    def press(self, key, times=1):
        """Press a key until a frame has seen it: Dear ImGui asks once a frame which keys are down."""
        for _ in range(times):
            self.tool("keydown", *key.split("+"))
            self.until_idle()
            self.tool("keyup", *reversed(key.split("+")))
            self.until_idle()

    def wait_for(self, condition, what, pause_s=0.05):
        """The first true value of @condition; fails if it does not come, or if gazeview ends."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            value = condition()
            if value:
                return value
            if self.viewer:
                self.assertIsNone(self.viewer.poll(), "gazeview has ended")
            self.assertLess(time.monotonic(), deadline, "never came: " + what)
            time.sleep(pause_s)

    def until(self, good, what):
        """The first screenshot that @good accepts."""
        def accepted():
            picture = self.grab()
            return good(picture) and picture

        picture = self.wait_for(accepted, what, pause_s=0.02)
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
        """The part of a picture that is not covered by captions."""
        return picture.part(0, LINE_HEIGHT, width, height - CORNER_HEIGHT)

    def until_changed(self, before, what):
        old = self.below_line(before)
        return self.until(lambda p: self.below_line(p) != old, what)

    def move(self, x, y):
        self.tool("mousemove", "--window", self.window, x, y)

    def click(self, x, y, button=1):
        """A click that lasts until a frame has seen it."""
        self.move(x, y)
        self.until_idle()
        self.tool("mousedown", button)
        self.until_idle()
        self.tool("mouseup", button)
        self.until_idle()

    def drag(self, start, end, button=1, key=None):
        """A drag from one place to another, in two moves."""
        self.move(*start)
        self.until_idle()
        if key:
            self.tool("keydown", key)
        self.tool("mousedown", button)
        self.until_idle()
        for share in (0.5, 1):
            self.move(*(round(a + share * (b - a)) for a, b in zip(start, end)))
            self.until_idle()
        self.tool("mouseup", button)
        if key:
            self.tool("keyup", key)
        self.until_idle()

    def find(self, words):
        """Search for words, by the keyboard."""
        self.press("ctrl+p")
        self.tool("type", "--delay", "30", words)
        self.until_idle()

    def saved(self):
        """The lines of the scene self.own, after the window has saved it."""
        before = os.stat(self.own).st_mtime_ns
        self.press("ctrl+s")
        self.wait_for(lambda: os.stat(self.own).st_mtime_ns != before, "a saved scene")
        with open(self.own, encoding="utf-8") as own:
            return own.read().splitlines()

    def amber_letters_left(self, picture):
        pixels = (picture.at(x, y) for x in range(10, 100) for y in range(60, 250))
        return sum(r > 160 and 0.6 * r < g < 0.85 * r and b < 0.5 * r for r, g, b in pixels)

    def title(self):
        self.until_idle()
        return self.tool("getwindowname", self.window).strip()

    def cross_at(self, picture, x, y):
        """Whether a red upright cross has its middle there, to a pixel or two."""
        arms = ((0, 0), (8, 0), (-8, 0), (0, 8), (0, -8))
        return any(
            all(picture.at(x + a + i, y + b + j) == CROSS for a, b in arms)
            for i in (-1, 0, 1) for j in (-1, 0, 1)
        )

    def found(self, than=None):
        """Wait for a window of the viewer, other than @than."""
        def others():
            # A search also fails if a window is closed meanwhile.
            found = run("xdotool", "search", "--onlyvisible", "--name", "gazeview$",
                        env=self.environment)
            return found.returncode == 0 and [n for n in found.stdout.split() if n != than]

        self.window = self.wait_for(others, "a window")[-1]

    def leave(self):
        """Press Q, and discard changes if that is asked."""
        self.tool("key", "q")
        deadline = time.monotonic() + PATIENCE_S
        while self.viewer.poll() is None and time.monotonic() < deadline:
            name = run("xdotool", "getwindowname", self.window, env=self.environment).stdout
            if name.startswith("*"):
                self.move(SIZE[0] // 2 - 134, SIZE[1] // 2 + 17)  # the button Discard
                for what in ("mousedown", "mouseup"):
                    time.sleep(0.2)  # a frame must see it
                    run("xdotool", what, "1", env=self.environment)
            time.sleep(0.1)

    def messages(self):
        """The viewer's messages, once it has ended."""
        said = self.viewer.communicate(timeout=PATIENCE_S)[1]
        self.viewer = None
        return said

    def corner_has(self, picture, is_it):
        """Whether the caption of the gaze has text of a colour."""
        width, height = SIZE
        return 100 < sum(
            is_it(*picture.at(x, y)) for x in range(8, width - 10)
            for y in range(height - CORNER_HEIGHT, height - 8)
        )

    def says_error(self, picture, place=CORNER):
        """Whether there are red letters."""
        left, top, right, bottom = place
        pixels = (picture.at(x, y) for x in range(left, right) for y in range(top, bottom))
        return sum(r > 200 and 60 < g < 130 and b < 110 for r, g, b in pixels) > 40

    def amber(self, picture):
        return self.corner_has(picture, lambda r, g, b: r > 180 and 100 < g < 220 and b < 120)

    def near(self, place, wanted):
        return place and all(abs(a - b) <= 3 for a, b in zip(place, wanted))

    def red_middle(self, picture):
        """The middle of all pixels with the cross's colour, or None."""
        places = [
            (x, y) for y in range(LINE_HEIGHT, SIZE[1], 2) for x in range(SIZE[0])
            if picture.at(x, y) == CROSS
        ]
        if not places:
            return None
        return tuple(sum(place[i] for place in places) // len(places) for i in (0, 1))

    def processor_share(self, rest_s=2):
        """Share of one core used while nothing happens for @rest_s."""
        before, start = self.ticks(), time.monotonic()
        time.sleep(rest_s)  # the time that is measured
        return (self.ticks() - before) / os.sysconf("SC_CLK_TCK") / (time.monotonic() - start)
