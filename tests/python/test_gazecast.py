"""The Python module over the libraries and programs of this build, or over the installed ones.

usage: test_gazecast.py LAYOUT SCENES [unittest options]      (GAZED, GAZECTL: programs, else those of PATH)
LAYOUT prints the layouts of the structs; "-" leaves that test out.
"""

import ctypes
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

try:
    import numpy as np
except ImportError:
    print("no numpy")
    sys.exit(77)

import gazecast
from gazecast import _libraries

PATIENCE_S = float(os.environ.get("GZ_TEST_PATIENCE_S", "60"))
LAYOUT, SCENES = sys.argv[1], pathlib.Path(sys.argv[2])
GAZED = os.environ.get("GAZED") or shutil.which("gazed")


def find_library_address(struct, path):
    """Offset and size of a field of a mirror; "-" is the whole."""
    if path == "-":
        return 0, ctypes.sizeof(struct)
    field = getattr(struct, path)
    return field.offset, field.size


class Layouts(unittest.TestCase):
    @unittest.skipIf(LAYOUT == "-", "no program that prints layouts")
    def test_mirrors_are_laid_out_as_the_compiler_does(self):
        lines = subprocess.run([LAYOUT], check=True, capture_output=True, text=True).stdout.splitlines()
        self.assertGreater(len(lines), 80)
        for line in lines:
            name, field, offset, size = line.split()
            with self.subTest(struct=name, field=field):
                found = find_library_address(_libraries.MIRRORS[name], field)
                self.assertEqual(found, (int(offset), int(size)))


class Daemon(unittest.TestCase):
    """A daemon with a simulated viewer, that records."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="gz-py-", dir="/tmp")
        os.environ["GAZECAST_RUNTIME_DIR"] = cls.folder + "/run"
        cls.gazed = subprocess.Popen(
            [GAZED, "--config", "/dev/null", "--driver", "sim", "--sim.rate_hz", "250", "--tcp=off",
             "--record", "one", "--recording.directory", cls.folder],
            stderr=subprocess.DEVNULL,
        )
        cls.latest = gazecast.Latest()
        end = time.monotonic() + PATIENCE_S
        while cls.latest.read() is None:
            if time.monotonic() > end or cls.gazed.poll() is not None:
                raise RuntimeError("no gaze")
            time.sleep(0.01)

    @classmethod
    def tearDownClass(cls):
        cls.latest.close()
        cls.gazed.terminate()
        cls.gazed.wait(PATIENCE_S)
        shutil.rmtree(cls.folder)

    def test_latest_gaze_is_new_and_has_an_age(self):
        gaze = first = self.latest.read()
        end = time.monotonic() + PATIENCE_S
        while gaze.seq == first.seq and time.monotonic() < end:
            time.sleep(0.01)
            gaze = self.latest.read()
        self.assertGreater(gaze.seq, first.seq)
        self.assertTrue(0 <= gaze.age_s < PATIENCE_S)
        self.assertAlmostEqual(gaze.time_s + gaze.age_s, time.clock_gettime(time.CLOCK_MONOTONIC), delta=PATIENCE_S)
        self.assertTrue(all(map(math.isfinite, gaze.point)))
        self.assertIsInstance(gaze.event, gazecast.Event)
        self.assertGreater(gaze.left.pupil_mm, 1)

    def test_stream_has_each_gaze_once_and_the_status(self):
        seqs, status = [], None
        with gazecast.stream("gaze", "status", timeout_s=PATIENCE_S) as stream:
            for message in stream:
                if isinstance(message, gazecast.Gaze):
                    seqs.append(message.seq)
                elif isinstance(message, gazecast.Status):
                    status = message
                if status and len(seqs) >= 100:
                    break
        self.assertEqual(seqs, list(range(seqs[0], seqs[0] + len(seqs))))
        self.assertEqual((status.state, status.recording), ("running", "on"))
        self.assertTrue(status.recording_file.endswith("one.gzl"))
        self.assertGreater(status.distance_mm, 100)

    def test_stream_tells_fixations_and_saccades(self):
        kinds = set()
        with gazecast.stream("fixations", "saccades", timeout_s=PATIENCE_S) as stream:
            for message in stream:
                kinds.add(type(message))
                if kinds == {gazecast.Fixation, gazecast.Saccade}:
                    break
        self.assertEqual(kinds, {gazecast.Fixation, gazecast.Saccade})

    def test_waiting_for_the_stream_ends_in_time(self):
        with gazecast.stream("no-such-topic") as stream:
            begin = time.monotonic()
            self.assertIsNone(stream.read(timeout_s=0.15))
            self.assertGreater(time.monotonic() - begin, 0.1)
        with self.assertRaises(gazecast.GazecastError):
            stream.read(0)

    def test_endpoint_that_is_none_is_refused_with_its_name(self):
        with self.assertRaisesRegex(gazecast.GazecastError, "nonsense"):
            gazecast.Latest("nonsense")


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="gz-py-")
        cls.log = pathlib.Path(cls.folder.name, "short.csv")
        rows = ["t,gx,gy"]
        for i in range(600):  # rests, jumps by 11 degrees in 40 ms, rests; a tenth of a second is missing
            done = min(max((i - 300) / 10, 0), 1)
            x = 700 + round(400 * (3 - 2 * done) * done**2)
            rows.append(f"{i * 4},{'' if 400 <= i < 425 else x + i % 2},{'' if 400 <= i < 425 else 540}")
        cls.log.write_text("\n".join(rows) + "\n")
        cls.recording = gazecast.read_recording(
            cls.log, from_="table", table_columns="time=t;x=gx;y=gy", table_time_unit="ms",
            display_px="1920x1080", display_mm=(565, 318), display_distance_mm=600, rate_hz=250,
        )

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_samples_are_records_of_numbers(self):
        samples = self.recording.samples
        self.assertIsInstance(samples, np.recarray)
        self.assertEqual(len(samples), 600)
        self.assertEqual(samples.gaze_valid.sum(), 575)
        self.assertTrue(np.isnan(samples.gaze_x[410]))
        self.assertAlmostEqual(samples.gaze_x[0], 700 / 1920, delta=1 / 1920)
        self.assertAlmostEqual(np.median(np.diff(samples.host_s)), 0.004)

    def test_labels_tell_what_the_eye_did(self):
        labels = self.recording.samples.label
        self.assertEqual(labels[100], "fixation")
        self.assertEqual(labels[410], "blink")
        self.assertEqual(list(self.recording.events.label[:2]), ["fixation", "saccade"])
        self.assertAlmostEqual(self.recording.events.host_s[1], self.recording.samples.host_s[300], delta=0.02)
        self.assertEqual(self.recording.events.samples.sum(), 600)

    def test_recording_that_was_cut_off_is_read_up_to_there(self):
        whole = pathlib.Path(self.folder.name, "whole.gzl")
        cut = pathlib.Path(self.folder.name, "cut.gzl")
        subprocess.run(
            [os.environ.get("GAZECTL", "gazectl"), "convert", "--from=table", "--table.columns=time=t;x=gx;y=gy",
             "--table.time-unit=ms", "--display.px=1920x1080", "--display.mm=565 318", "--display.distance_mm=600",
             "--rate-hz=250", self.log, whole], check=True, capture_output=True,
        )
        cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
        for settings in {}, {"display_distance_mm": 700}:
            with self.assertWarnsRegex(RuntimeWarning, "cut off"):
                recording = gazecast.read_recording(cut, **settings)
            self.assertGreater(len(recording.samples), 250)
            self.assertLess(len(recording.samples), 350)
        self.assertEqual(gazecast.read_recording(whole).summary["ending"], "whole")

    def test_gazectl_that_cannot_be_run_is_named(self):
        with unittest.mock.patch.dict(os.environ, GAZECTL="/nonexistent/gazectl"):
            with self.assertRaisesRegex(gazecast.GazecastError, "/nonexistent/gazectl cannot be run"):
                gazecast.read_recording(self.log)

    def test_file_that_is_no_recording_is_refused_in_words(self):
        with self.assertRaisesRegex(gazecast.GazecastError, "passwd"):
            gazecast.read_recording("/etc/passwd")


def make_ball(size=48, kind=np.uint8):
    axis = np.linspace(-1, 1, size)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    ball = np.clip(1.2 - np.sqrt((x - 0.2) ** 2 + y**2 + z**2), 0, 1)
    return (ball * 255).astype(kind)


class Rendering(unittest.TestCase):
    def test_foveated_picture_is_the_full_one_at_the_gaze_for_fewer_rays(self):
        ball, size, gaze = make_ball(), (1280, 960), (0.3, 0.6)
        settings = {"display.mm": (400, 300), "display.distance_mm": 300}
        full = gazecast.render(ball, gaze=gaze, method="standard", size=size, settings=settings, backend="cpu")
        foveated = gazecast.render(ball, gaze=gaze, size=size, settings=settings, backend="cpu")
        self.assertEqual(full.rgba.shape, (960, 1280, 4))
        self.assertEqual(full.cost["rays"], 1280 * 960)
        self.assertLess(foveated.cost["rays"], full.cost["rays"] / 2)
        self.assertGreater(full.cost["total_ms"], 0)
        self.assertTrue((full.rgba[..., 3] == 255).all())
        self.assertGreater(full.rgba[..., :3].max(), 50)
        at = np.s_[int(0.6 * 960) - 8 : int(0.6 * 960) + 8, int(0.3 * 1280) - 8 : int(0.3 * 1280) + 8]
        np.testing.assert_array_equal(full.rgba[at], foveated.rgba[at])
        self.assertTrue((full.rgba != foveated.rgba).any())

    def test_axes_are_x_y_z_and_z_is_up(self):
        volume = np.zeros((20, 30, 40), np.float32)
        volume[2:8, :, 30:38] = 1  # left, high
        with gazecast.Renderer("cpu") as renderer:
            renderer.set_transfer([(0, 0, 0, 0, 0), (1, 1, 1, 1, 1)])
            renderer.set("foveation.method", "standard")
            renderer.set_volume(volume, spacing=(1, 1, 1))
            light = renderer.draw((160, 160)).rgba[..., 0].astype(int)
        rows, columns = np.nonzero(light > 128)
        self.assertLess(rows.mean(), 70)
        self.assertLess(columns.mean(), 75)

    def test_value_of_the_data_decides_the_colour_for_every_type(self):
        for kind in (np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.float32, np.float64, np.float16, bool):
            with self.subTest(kind=kind):
                volume = np.zeros((12, 12, 12), kind)
                volume[4:8, 4:8, 4:8] = 1
                picture = gazecast.render(
                    volume, [(0, 0, 0, 0, 0), (0.5, 0, 0, 0, 0), (1, 1, 0, 0, 1)], {"eye": (0, -2, 0)},
                    method="standard", size=(32, 32), backend="cpu",
                )
                self.assertGreater(picture.rgba[16, 16, 0], 200)
                self.assertEqual(tuple(picture.rgba[0, 0]), (0, 0, 0, 255))

    def test_one_renderer_shows_volumes_scenes_and_keys_in_turn(self):
        with gazecast.Renderer("cpu", threads=1) as renderer:
            renderer.load(SCENES / "shells.scene")
            shells = renderer.draw((96, 64)).rgba.copy()
            self.assertIn("cpu", renderer.describe())
            eye = renderer.get("camera.eye")
            renderer.set("camera.eye", (0.5, -1.5, 0.2))
            self.assertTrue((renderer.draw((96, 64)).rgba != shells).any())
            renderer.set("camera.eye", eye)
            np.testing.assert_array_equal(renderer.draw((96, 64)).rgba, shells)
            renderer.set_volume(make_ball(16))
            self.assertTrue((renderer.draw((96, 64)).rgba != shells).any())
            renderer.load(SCENES / "shells.scene")
            np.testing.assert_array_equal(renderer.draw((96, 64)).rgba, shells)

    def test_technique_is_a_key(self):
        with gazecast.Renderer("cpu") as renderer:
            renderer.set_volume(make_ball(24))
            cast = renderer.draw((64, 64)).rgba.copy()
            renderer.set("render.technique", "isosurface")
            renderer.set("isosurface.isovalue", 100)
            try:
                surface = renderer.draw((64, 64)).rgba
            except gazecast.GazecastError as error:
                self.skipTest(str(error))  # built without Embree
            self.assertTrue((surface != cast).any())

    def test_what_is_wrong_is_said(self):
        with gazecast.Renderer("cpu") as renderer:
            for wrong, words in (
                (lambda: renderer.draw((10, 10)), "nothing is shown"),
                (lambda: renderer.set("camera.eyes", "0 0 0"), "did you mean camera.eye"),
                (lambda: renderer.set("volume.file", "x.nrrd"), "no key volume.file"),
                (lambda: renderer.set("camera.fov_deg", 1000), "outside 0.01 to 179"),
                (lambda: renderer.set_transfer("0 0 0 0 2"), "transfer function"),
                (lambda: renderer.load("/nonexistent.scene"), "no such file"),
                (lambda: renderer.set_volume(make_ball(8), spacing=(0, 1, 1)), "spacing"),
            ):
                with self.assertRaisesRegex(gazecast.GazecastError, words):
                    wrong()
            renderer.set_volume(make_ball(8))
            with self.assertRaisesRegex(ValueError, "two numbers"):
                renderer.draw((10, 10), (0.5, 0.5, 1))
            for size, gaze in (((0, 10), None), ((10, 10), (math.nan, 0)), ((20000, 1), None)):
                with self.assertRaises(gazecast.GazecastError):
                    renderer.draw(size, gaze)
        with self.assertRaises(gazecast.GazecastError):
            renderer.draw((10, 10))
        with self.assertRaises(gazecast.GazecastError):
            gazecast.Renderer("abacus")
        with self.assertRaises(TypeError):
            gazecast.render(np.zeros((4, 4, 4), complex))
        with self.assertRaises(ValueError):
            gazecast.render(np.zeros((4, 4)))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
