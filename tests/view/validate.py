"""gazectl validate with the real window under Xvfb: a simulated viewer looks at the targets through a
tracker whose error is known.

validate.py GAZECTL GAZEVIEW GAZED
"""

import glob
import json
import math
import os
import pty
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from picture import PATIENCE_S, run, skip
from xserver import Screen, start_server

GAZECTL, GAZEVIEW, GAZED = sys.argv[1:4]
SCREEN = (960, 540)

# What the simulated tracker tells instead of x and y: a b c of a + b x + c y.
ERROR_X = (0.03, 1.04, 0.01)
ERROR_Y = (-0.02, 0.0, 0.96)
MM = (564.677, 317.631)
DISTANCE_MM = 600

for tool in ("Xvfb", "xdotool"):
    if not shutil.which(tool):
        skip(tool + " is not installed")


def through(line, point):
    return line[0] + line[1] * point[0] + line[2] * point[1]


def direction(point):
    return [(point[i] - 0.5) * MM[i] for i in (0, 1)] + [DISTANCE_MM]


def angle_deg(a, b):
    a, b = direction(a), direction(b)
    dot = sum(p * q for p, q in zip(a, b))
    return math.degrees(math.acos(dot / math.hypot(*a) / math.hypot(*b)))


class Validate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server, cls.display = start_server(SCREEN)
        cls.screen = Screen(cls.server, cls.display, SCREEN)

    @classmethod
    def tearDownClass(cls):
        cls.screen.close()
        cls.server.terminate()
        cls.server.wait()

    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="gazecast-test-validate-")
        self.addCleanup(place.cleanup)
        self.place = place.name
        self.environment = dict(
            os.environ, DISPLAY=self.display, LIBGL_ALWAYS_SOFTWARE="1",
            GAZECAST_RUNTIME_DIR=self.place, XDG_CONFIG_HOME=os.path.join(self.place, "config"),
            ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0",
        )
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.daemon = None
        self.addCleanup(self.stop_daemon)

    def start_daemon(self, *more):
        self.daemon = subprocess.Popen(
            [GAZED, "--config", "/dev/null", "--tcp=off", "--recording.directory", self.place,
             *more],
            env=self.environment, stderr=subprocess.PIPE, text=True,
        )
        self.said = []
        for line in self.daemon.stderr:
            self.said.append(line)
            if "delivers samples" in line:
                break

    def start_simulator(self, *more):
        """Nothing is wrong with it but its calibration. Without a target to follow it rests in the
        middle: where a busy machine shows it a target late, it does not look elsewhere before."""
        places = os.path.join(self.place, "places")
        with open(places, "w", encoding="ascii") as out:
            out.write("0.5 0.5\n")
        self.start_daemon(
            "--driver=sim", "--sim.targets=" + places, "--sim.rate_hz=200", "--sim.offset_deg=0", "--sim.spikes=0",
            "--sim.loss=0", "--sim.eye_loss=0", "--sim.blinks_per_min=0",
            "--sim.microsaccades_per_s=0", "--sim.drift_deg_s=0.1",
            "--sim.calibration_x=%g %g %g" % ERROR_X, "--sim.calibration_y=%g %g %g" % ERROR_Y,
            *more,
        )

    def stop_daemon(self, signal_number=signal.SIGTERM):
        if self.daemon:
            self.daemon.send_signal(signal_number)
            self.daemon.communicate()
        self.daemon = None

    def words(self, *more):
        """A short check, but for what @more says."""
        usual = ["--gazeview=" + GAZEVIEW, "--targets=5", "--duration=1.6"]
        given = [word.split("=")[0] for word in more]
        usual = [word for word in usual if word.split("=")[0] not in given]
        return [GAZECTL, "validate", *usual, *more]

    def validate(self, *more, **changes):
        return subprocess.run(
            self.words(*more), env=dict(self.environment, **changes), capture_output=True,
            text=True, timeout=2 * PATIENCE_S, stdin=subprocess.DEVNULL, check=False,
        )

    def measure(self, *more):
        done = self.validate("--instructions=no", "--json", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def start_validate(self, *more):
        """In the background, its window open."""
        gazectl = subprocess.Popen(
            self.words(*more), env=self.environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )
        self.addCleanup(lambda: gazectl.poll() is None and gazectl.kill())
        found = run("timeout", PATIENCE_S, "xdotool", "search", "--sync", "--onlyvisible", "--name",
                    "^gazeview targets$", env=self.environment)
        self.assertEqual(found.returncode, 0, "no window appears")
        self.window = found.stdout.split()[0]
        return gazectl

    def key(self, name):
        run("xdotool", "windowfocus", self.window, env=self.environment)
        self.assertEqual(run("xdotool", "key", name, env=self.environment).returncode, 0)

    def finish(self, gazectl):
        out, err = gazectl.communicate(timeout=2 * PATIENCE_S)
        return gazectl.returncode, out, err

    def grab(self):
        """The green of the screen, which is grey."""
        return self.screen.grab()[1::4]

    def until(self, good, what):
        deadline = time.monotonic() + PATIENCE_S
        while not good():
            self.assertLess(time.monotonic(), deadline, "never came: " + what)
            time.sleep(0.05)

    def test_known_error_is_measured_stored_and_gone_afterwards(self):
        self.start_simulator()
        self.assertEqual(run(GAZECTL, "record", "check", env=self.environment).returncode, 0)
        marked = self.measure()
        self.assertEqual(run(GAZECTL, "stop", env=self.environment).returncode, 0)
        self.check_marks(marked["targets"])
        before = self.measure("--correct")
        self.assertEqual(len(before["targets"]), 5)
        for target in before["targets"]:
            point = target["point"]
            wrong = (through(ERROR_X, point), through(ERROR_Y, point))
            for eye in ("both", "left", "right"):
                mean = target[eye]["mean"]
                self.assertLess(angle_deg(mean, wrong), 0.25, (eye, point, mean, wrong))
            self.assertAlmostEqual(
                math.hypot(*target["both"]["offset_deg"]), angle_deg(point, wrong), delta=0.25)
            self.assertGreater(target["both"]["used"], 50)
            self.assertLess(target["both"]["loss"], 0.05)
        both, right = before["summary"]["both"], before["summary"]["right"]
        # Noise of 0.1 degrees on each axis of each eye; steps are the difference of two samples.
        self.assertAlmostEqual(right["rms_s2s_deg"], 0.2, delta=0.03)
        self.assertAlmostEqual(both["rms_s2s_deg"], 0.2 / math.sqrt(2), delta=0.03)
        self.assertGreater(right["sd_deg"], 0.12)
        self.assertLess(right["sd_deg"], 0.25)
        fit = before["correction"]
        self.assertEqual((fit["model"], fit["helps"]), ("affine", True))
        self.assertGreater(fit["before_deg"], 1.5)
        self.assertLess(fit["cross_validated_deg"], 0.4)

        after = self.measure("--order=fixed")
        self.assertEqual(after["targets"][0]["point"], [0.5, 0.5])
        for target in after["targets"]:
            self.assertLess(math.hypot(*target["both"]["offset_deg"]), 0.35, target)
        self.assertLess(after["summary"]["both"]["accuracy_deg"],
                        before["summary"]["both"]["accuracy_deg"] / 4)

        self.check_stored()
        self.check_recorded()
        self.check_forgotten()

    def log(self, name):
        """The lines of a recording, which may still be on its way to the disk."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            with open(os.path.join(self.place, name + ".gzl"), encoding="utf-8") as log:
                lines = log.readlines()
            if lines and lines[-1].startswith("#end"):
                return lines
            self.assertLess(time.monotonic(), deadline, "the recording has no end")

    def check_marks(self, targets):
        """A recording knows what was shown when."""
        marks = [line.split("\t") for line in self.log("check") if line.startswith("!mark")]
        self.assertEqual(len(marks), len(targets), marks)
        for i, (mark, target) in enumerate(zip(marks, targets)):
            self.assertLess(abs(int(mark[1]) - target["shown_ns"]), 1000)
            x, y = target["point"]
            self.assertEqual(mark[2].strip(), "validate: target %d of 5 at %.4g %.4g" % (i + 1, x, y))

    def status(self):
        done = run(GAZECTL, "status", "--json", env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def stored(self):
        return glob.glob(os.path.join(self.place, "config/gazecast/corrections/sim-*"))

    def check_noted(self):
        """The daemon knows what the tracker was validated on, and that nothing has changed."""
        validation = self.status()["validation"]
        self.assertRegex(validation["measured"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertGreater(validation["accuracy_deg"], 0)
        self.assertEqual(validation["changed"], "")
        noted = os.path.join(self.place, "config/gazecast/corrections/validated-sim.ini")
        with open(noted, encoding="utf-8") as text:
            self.assertIn("monitor_px = %d %d\n" % tuple(SCREEN), text.read())

    def check_stored(self):
        """A daemon that starts anew applies it; one with another display does not."""
        self.assertEqual(len(self.stored()), 1)
        self.check_noted()
        in_force = self.status()["correction"]
        self.stop_daemon()
        self.start_simulator()
        self.assertEqual(self.status()["correction"], in_force)
        self.assertNotEqual(in_force["x"], [0, 1, 0])
        self.stop_daemon()
        self.start_simulator("--display.distance_mm=700")
        self.assertEqual(self.status()["correction"]["x"], [0, 1, 0])
        self.assertEqual(self.status()["validation"]["changed"], "700 mm away, was 600 mm")
        self.assertTrue(any("the display has changed since sim was validated" in line
                            for line in self.said), self.said)
        self.stop_daemon()
        self.start_simulator("--tracker.corrections=none")
        self.assertEqual(self.status()["correction"]["x"], [0, 1, 0])
        self.stop_daemon()
        self.start_simulator("--pipeline.correction.x=0.5 1 0")
        self.assertEqual(self.status()["correction"]["x"], [0.5, 1, 0])
        self.stop_daemon()

    def check_recorded(self):
        """Among the settings of a log."""
        self.start_simulator()
        correction = self.status()["correction"]
        self.assertEqual(run(GAZECTL, "record", "r", env=self.environment).returncode, 0)
        refused = self.validate("--correct", "--instructions=no")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("recording", refused.stderr)
        self.assertEqual(run(GAZECTL, "stop", env=self.environment).returncode, 0)
        for axis in "xy":
            line = next(l for l in self.log("r") if l.startswith("#pipeline.correction." + axis))
            written = [float(word) for word in line.split()[1:]]
            for a, b in zip(written, correction[axis]):
                self.assertAlmostEqual(a, b, delta=1e-9)

    def check_forgotten(self):
        done = self.validate("--forget")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.stored(), [])
        self.assertEqual(self.status()["correction"]["x"], [0, 1, 0])
        done = self.validate("--forget")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no correction is stored", done.stderr)

    def test_file_of_another_display_under_this_ones_name_is_refused(self):
        folder = os.path.join(self.place, "config/gazecast/corrections")
        os.makedirs(folder)
        path = os.path.join(folder, "sim-1920x1080-565x318mm-600mm.ini")
        with open(path, "w", encoding="utf-8") as out:
            out.write("[correction]\ntracker = sim\nserial =\ndisplay_px = 1920x1080\n"
                      "display_mm = 565 318\ndistance_mm = 600\nx = 0.1 1 0\ny = 0 0 1\n"
                      "measured = then\nbefore_deg = 1\nafter_deg = 0.5\n")
        self.start_simulator()
        self.assertEqual(self.status()["correction"]["x"], [0, 1, 0])
        said = [line for line in self.said if path in line]
        self.assertEqual(len(said), 1, self.said)
        self.assertIn("another tracker or display", said[0])

    def test_target_is_drawn_where_it_is_said_to_be_in_its_final_size(self):
        self.start_simulator()
        viewer = subprocess.Popen(
            [GAZEVIEW, "--targets=5", "--order=fixed", "--duration=60", "--instructions=no",
             "--display-mm=%g %g" % MM, "--distance-mm=%g" % DISTANCE_MM],
            env=self.environment, stdout=subprocess.PIPE, text=True,
        )
        self.addCleanup(viewer.communicate)
        self.addCleanup(viewer.kill)
        screen = viewer.stdout.readline().split()
        self.assertEqual(screen[:5], ["screen", *map(str, SCREEN), "0", "0"])
        self.assertGreater(float(screen[5]), 0)
        shown = viewer.stdout.readline().split()
        self.assertEqual(shown[:5], ["shown", "0", "5", "0.5", "0.5"])
        self.assertLess(abs(int(shown[5]) - time.monotonic_ns()), 10e9)
        px_per_deg = SCREEN[0] / MM[0] * DISTANCE_MM * math.radians(1)
        middle = SCREEN[0] // 2 + SCREEN[1] // 2 * SCREEN[0]

        def width():
            """Of what is darker than the ground, through the disc's quarter above the middle."""
            row = self.grab()
            self.assertEqual(row[0], 128)
            self.dot = row[middle]
            dark = [i for i, value in enumerate(row) if value < 100]
            return max(i % SCREEN[0] for i in dark) - min(i % SCREEN[0] for i in dark) + 1

        self.until(lambda: abs(width() - 0.6 * px_per_deg) <= 2.5, "a disc of 0.6 degrees")
        self.assertLess(self.dot, 20)
        # It has its final size: nothing more is drawn.
        self.until(lambda: self.processor_s(viewer, 0.5) < 0.03, "a window at rest")

    def processor_s(self, process, seconds):
        """Processor time that a process takes in so many seconds."""
        def ticks():
            with open("/proc/%d/stat" % process.pid, encoding="ascii") as stat:
                fields = stat.read().rsplit(")", 1)[1].split()
            return int(fields[11]) + int(fields[12])

        before = ticks()
        time.sleep(seconds)  # the time that is measured
        return (ticks() - before) / os.sysconf("SC_CLK_TCK")

    def answer(self, text):
        """A check on a terminal, its question answered with @text. -> what the terminal showed"""
        ours, theirs = pty.openpty()
        gazectl = subprocess.Popen(
            self.words("--instructions=no"), env=self.environment, stdin=theirs, stdout=theirs,
            stderr=theirs,
        )
        os.close(theirs)
        shown = b""
        while b"[y/N]" not in shown:
            shown += os.read(ours, 4096)
        os.write(ours, text.encode())
        try:
            while True:
                shown += os.read(ours, 4096)
        except OSError:  # the other end is closed
            pass
        os.close(ours)
        self.assertEqual(gazectl.wait(timeout=PATIENCE_S), 0, shown)
        return shown.decode()

    def test_terminal_is_asked_whether_to_store(self):
        self.start_simulator()
        self.answer("\n")
        self.assertEqual(self.stored(), [])
        self.assertIn("and in force", self.answer("y\n"))
        self.assertEqual(len(self.stored()), 1)

    def test_space_begins_and_escape_cancels(self):
        self.begin_and_cancel("key", "space")

    def test_click_begins(self):
        self.begin_and_cancel("click", "1")

    def begin_and_cancel(self, *words):
        self.start_simulator()
        gazectl = self.start_validate()
        self.until(lambda: len(set(self.grab())) > 2, "instructions")
        run("xdotool", "windowfocus", self.window, env=self.environment)
        self.assertEqual(run("xdotool", *words, env=self.environment).returncode, 0)
        # A target's dot in the middle of one of the five places.
        places = [(x, y) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)]

        def target_there():
            picture = self.grab()
            return any(picture[int(y * SCREEN[1]) * SCREEN[0] + int(x * SCREEN[0])] < 20
                       for x, y in places)

        self.until(target_there, "a target")
        self.key("Escape")
        status, out, err = self.finish(gazectl)
        self.assertEqual((status, out), (5, ""), err)
        self.assertIn("cancelled", err)
        self.assertEqual(self.stored(), [])

    def test_space_bar_brings_the_next_target(self):
        self.start_simulator()
        gazectl = self.start_validate("--advance=space", "--json")
        deadline = time.monotonic() + 2 * PATIENCE_S
        while gazectl.poll() is None:
            self.assertLess(time.monotonic(), deadline, "it does not end")
            if run("xdotool", "key", "space", env=self.environment).returncode != 0:
                break
            time.sleep(0.2)  # a person who presses the key again and again
        status, out, err = self.finish(gazectl)
        self.assertEqual(status, 0, err)
        for target in json.loads(out)["targets"]:
            self.assertGreaterEqual(target["hidden_ns"] - target["shown_ns"], 1.6e9)

    def test_signal_cancels_and_leaves_no_window(self):
        self.start_simulator()
        gazectl = self.start_validate("--instructions=no")
        gazectl.send_signal(signal.SIGINT)
        status, _, err = self.finish(gazectl)
        self.assertEqual(status, 5, err)
        self.assertIn("cancelled", err)
        found = run("xdotool", "search", "--name", "^gazeview targets$", env=self.environment)
        self.assertEqual(found.stdout.strip(), "")

    def test_no_daemon_is_told_before_anything_is_shown(self):
        done = self.validate()
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("start gazed", done.stderr)

    def test_daemon_that_dies_on_the_way_is_told(self):
        self.start_simulator()
        gazectl = self.start_validate("--instructions=no", "--duration=30")
        self.stop_daemon(signal.SIGKILL)
        status, out, err = self.finish(gazectl)
        self.assertEqual((status, out), (3, ""), err)
        self.assertIn("is gazed still running?", err)

    def test_tracker_that_is_lost_on_the_way_is_told(self):
        self.start_simulator()
        self.assertEqual(run(GAZECTL, "record", "r", env=self.environment).returncode, 0)
        done = run(GAZECTL, "watch", "gaze", "--count", "800", env=self.environment)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(run(GAZECTL, "stop", env=self.environment).returncode, 0)
        self.log("r")
        self.stop_daemon()
        log = os.path.join(self.place, "r.gzl")
        self.start_daemon("--driver=replay", "--replay.file", log)
        done = self.validate("--instructions=no", "--duration=30")
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        self.assertIn("the tracker is ended", done.stderr)
        done = self.validate("--instructions=no")  # and now there is none to begin with
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("cannot be checked", done.stderr)

    def test_missing_gazeview_is_one_line(self):
        self.start_simulator()
        done = self.validate("--gazeview=/nowhere/gazeview")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("/nowhere/gazeview", done.stderr)

    def test_no_display_is_told_by_gazeview_and_by_gazectl(self):
        self.start_simulator()
        done = self.validate(DISPLAY="")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 2, done.stderr)
        self.assertIn("no window", done.stderr)
        self.assertIn("before all targets were shown", done.stderr)

    def test_targets_that_are_no_list_are_refused(self):
        self.start_simulator()
        path = os.path.join(self.place, "targets")
        with open(path, "w", encoding="utf-8") as out:
            out.write("0.5 0.5\n0.5\n")
        done = self.validate("--targets=" + path)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn(path + ":2:", done.stderr)

    def test_picture_and_file_are_written_with_the_table(self):
        self.start_simulator()
        targets = os.path.join(self.place, "targets")
        with open(targets, "w", encoding="utf-8") as out:
            out.write("0.5 0.5\n0.75 0.25\n")
        svg, out = os.path.join(self.place, "p.svg"), os.path.join(self.place, "o.json")
        done = self.validate("--targets=" + targets, "--instructions=no", "--order=fixed",
                             "--picture", svg, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("  0.75 0.25 ", done.stdout)
        self.assertIn("both eyes ", done.stdout)
        with open(out, encoding="utf-8") as file:
            read = json.load(file)
        self.assertEqual([t["point"] for t in read["targets"]], [[0.5, 0.5], [0.75, 0.25]])
        self.assertEqual(read["correction"]["model"], "none")
        with open(svg, encoding="utf-8") as file:
            text = file.read()
        self.assertTrue(text.startswith("<?xml") and text.endswith("</svg>\n"))
        self.assertGreater(text.count('class="sample"'), 100)
        done = self.validate("--targets=" + targets, "--instructions=no", "--out",
                             "/nowhere/o.json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("/nowhere/o.json", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
