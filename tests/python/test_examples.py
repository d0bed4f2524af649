"""The examples of docs/python.md, each run as it stands there by a Python of its own, and the types of the module.

usage: test_examples.py PAGE SCENES [unittest options]      (GAZED, GAZECTL: programs, else those of PATH)
What an example needs and is not installed is said, and the example left out; of PsychoPy, a stand-in is used.
"""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

try:
    import numpy as _numpy
except ImportError:
    print("no numpy")
    sys.exit(77)

PATIENCE_S = float(os.environ.get("GZ_TEST_PATIENCE_S", "60"))
PAGE, SCENES = pathlib.Path(sys.argv[1]), sys.argv[2]
GAZED = os.environ.get("GAZED") or shutil.which("gazed")
MODULE = pathlib.Path(os.environ.get("PYTHONPATH", "").split(":")[0])

ASC = """** CONVERTED FROM e.edf
MSG\t99 GAZE_COORDS 0.00 0.00 1023.00 767.00
START\t100 \tRIGHT\tSAMPLES\tEVENTS
PUPIL\tAREA
SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR
""" + "".join(f"{100 + 2 * i}\t  512.0\t  384.0\t 1037.0\t...\n" for i in range(50))
TABLE = "t,gx,gy\n" + "".join(f"{4 * i},{960 + i},540\n" for i in range(50))

# What the example uses of PsychoPy; it presses Escape in the fifth frame, and checks what it is given.
PSYCHOPY = '''
class core:
    class Clock:
        def getTime(self):
            return 0.0


class event:
    asked = 0

    @staticmethod
    def getKeys(keys):
        event.asked += 1
        return ["escape"] if event.asked > 5 else []


class visual:
    class Window:
        def __init__(self, size, units, fullscr):
            import numpy
            self.size, self.flips = numpy.array(size), 0

        def flip(self):
            self.flips += 1

        def close(self):
            print("flips", self.flips)

    class ImageStim:
        def __init__(self, window, size):
            self.size = size

        def draw(self):
            width, height = (int(side) for side in self.size)
            assert self.image.shape == (height, width, 3), self.image.shape
            print("range", self.image.min() >= -1, self.image.max() <= 1, self.image.max() > self.image.min())
'''


def examples():
    """-> {heading: [the code below it]}"""
    found, heading = {}, None
    for part in re.split(r"(?m)^(#+ .*)$", PAGE.read_text(encoding="utf-8")):
        if part.startswith("#"):
            heading = part.lstrip("# ")
        else:
            found.setdefault(heading, []).extend(re.findall(r"(?s)```python\n(.*?)```", part))
    return {heading: code for heading, code in found.items() if code}


def has(*modules):
    return all(importlib.util.find_spec(name) for name in modules)


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="gz-py-", dir="/tmp")
        os.environ["GAZECAST_RUNTIME_DIR"] = cls.folder + "/run"
        cls.recording = pathlib.Path(cls.folder, "session.gzl")
        cls.gazed = subprocess.Popen(
            [GAZED, "--config", "/dev/null", "--driver", "sim", "--sim.rate_hz", "250", "--tcp=off",
             "--record", "session", "--recording.directory", cls.folder], stderr=subprocess.DEVNULL)
        end = time.monotonic() + PATIENCE_S
        while not (cls.recording.exists() and cls.recording.stat().st_size > 300000):
            if time.monotonic() > end or cls.gazed.poll() is not None:
                raise RuntimeError("no recording")
            time.sleep(0.05)
        subprocess.run([os.environ.get("GAZECTL", "gazectl"), "stop"], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.gazed.terminate()
        cls.gazed.wait()
        shutil.rmtree(cls.folder)

    def start(self, heading, number=0, arguments=()):
        code = examples()[heading][number].replace("/usr/share/gazecast/scenes/", SCENES + "/")
        path = pathlib.Path(self.folder, f"example{number}.py")
        if "import gazecast" not in code:  # it goes on where the one before it ends
            code = "import gazecast\nimport numpy as np\n" + code
        path.write_text(code, encoding="utf-8")
        environment = dict(os.environ, MPLBACKEND="Agg")
        environment["PYTHONPATH"] = f"{self.folder}:{environment.get('PYTHONPATH', '')}"
        return subprocess.Popen([sys.executable, "-B", str(path), *arguments], cwd=self.folder, env=environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_example(self, heading, number=0, arguments=()):
        process = self.start(heading, number, arguments)
        said, errors = process.communicate(timeout=10 * PATIENCE_S)
        self.assertEqual(process.returncode, 0, errors)
        return said

    def test_latest_gaze(self):
        end = time.monotonic() + PATIENCE_S  # the first reading may come before the first gaze
        while not re.search(r"\(0\.\d+, 0\.\d+\) Event\.\w+ 0\.0\d+", said := self.run_example("The latest gaze")):
            self.assertLess(time.monotonic(), end, said)

    def test_recordings(self):
        said = self.run_example("Recordings")
        share, *durations, rate = (float(number) for number in re.findall(r"-?\d+\.\d+", said))
        self.assertTrue(0 < share < 1 and len(durations) > 3, said)
        self.assertAlmostEqual(rate, 250, delta=5)
        pathlib.Path(self.folder, "subject7.asc").write_text(ASC, encoding="ascii")
        pathlib.Path(self.folder, "session.csv").write_text(TABLE, encoding="ascii")
        self.run_example("Recordings", 1)

    def test_recording_is_plotted(self):
        if not has("matplotlib"):
            self.skipTest("no matplotlib: the example that plots is not run")
        picture = pathlib.Path(self.folder, "recording.png")
        self.run_example("A recording plotted with matplotlib", 0, [str(self.recording)])
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        self.assertGreater(picture.stat().st_size, 20000)

    def test_picture_of_an_array(self):
        head = "/usr/share/mricron/templates/ch2.nii.gz"
        if not has("nibabel") or not os.path.exists(head):
            self.skipTest("no nibabel or no mricron-data: the example that shows a head is not run")
        said = self.run_example("Pictures that are sharp where somebody looks")
        self.assertRegex(said, r"^\(720, 1280, 4\) \d+\.\d+ \d{5,6}\.0\n$")

    def test_renderer_that_is_kept(self):
        self.run_example("Pictures that are sharp where somebody looks", 1)

    def test_volume_that_follows_the_gaze(self):
        if not os.path.exists("/usr/share/mricron/templates/ch2.nii.gz"):
            self.skipTest("no mricron-data: the example for PsychoPy is not run")
        pathlib.Path(self.folder, "psychopy.py").write_text(PSYCHOPY, encoding="utf-8")
        said = self.run_example("PsychoPy: a volume that follows the gaze").splitlines()
        self.assertEqual(said, 5 * ["range True True True"] + ["flips 5"])

    def test_zz_stream(self):
        """Last, since the stream ends with the daemon."""
        process = self.start("The stream")
        time.sleep(3)
        self.gazed.terminate()
        said, errors = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 0, errors)
        self.assertRegex(said, r"(?m)^\d+\.\d{3} s: \d+ ms at \(0\.\d+, 0\.\d+\)$")

    def test_every_example_is_run(self):
        self.assertEqual({heading: len(code) for heading, code in examples().items()}, {
            "The latest gaze": 1, "The stream": 1, "Recordings": 2, "A recording plotted with matplotlib": 1,
            "Pictures that are sharp where somebody looks": 2, "PsychoPy: a volume that follows the gaze": 1})


class Types(unittest.TestCase):
    def test_module_is_typed(self):
        if not shutil.which("mypy"):
            self.skipTest("no mypy: types are not checked")
        done = subprocess.run(["mypy", "--cache-dir", os.devnull, str(MODULE / "gazecast")], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    # The stream's example ends the daemon: it comes last by its name.
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=1)
