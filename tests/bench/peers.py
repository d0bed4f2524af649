"""What bench/peers prints beside another program's times, without that program.

peers.py GAZEVIEW SCENES-FOLDER PEERS-FOLDER HELPERS-FOLDER
"""

import json
import os
import sys
import tempfile
import unittest

sys.path[:0] = sys.argv[3:5]
from bauer2018 import camera_lines
from fovvideovdp import Judge, picture_paths, read_clip, write_table
from gazeview_frames import GAZES, Series, run_gazeview
from picture import read_png, write_scene

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]


class Peers(unittest.TestCase):
    def test_acuity_and_standard_are_each_quoted_against_the_peer_of_the_same_run(self):
        series = Series()
        series.peer, series.standard = [900, 1000, 5000], [100, 101, 20]
        for i, gaze in enumerate(GAZES):
            series.acuity[gaze] = [10 * (i + 1)]
        lines = series.lines()
        self.assertEqual(lines[0], "gazeview standard: 100.0 ms, ratio 10.00")
        self.assertEqual(lines[1], "gazeview acuity, gaze centre: 10.0 ms, ratio 100.00")
        self.assertEqual(lines[5], "gazeview acuity, gaze 0.5,0.95: 50.0 ms, ratio 20.00")
        self.assertEqual(lines[6], "gazeview acuity, mean of 5 gazes: 30.0 ms, ratio 33.33")
        self.assertEqual(len(lines), 7)

    def test_gazeview_runs_each_method_at_each_gaze_and_leaves_the_first_frame_out(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = write_scene(folder, SCENES)
            pictures = []
            for method, gaze in ("standard", GAZES[0]), ("acuity", GAZES[0]), ("acuity", GAZES[2]):
                times, path = run_gazeview(
                    GAZEVIEW, scene, "1280x720", "cpu", method, gaze, 3, folder
                )
                self.assertEqual(len(times), 2)
                self.assertTrue(all(ms > 0 for ms in times), times)
                pictures.append(read_png(path))
            for i, one in enumerate(pictures):
                for other in pictures[:i]:
                    self.assertFalse(one == other, "two gazes made one picture")


    def test_bauers_cameras_look_from_where_his_box_says(self):
        half = "0.707106781"
        row = {"qx": "0", "qy": half, "qz": "0", "qw": half, "tx": "0", "ty": "0.5", "tz": "2"}
        named = dict(line.split(" = ") for line in camera_lines(row))
        numbers = {name: [round(float(word), 6) + 0.0 for word in text.split()] for name, text in named.items()}
        # A quarter turn about y takes z to x: the eye is at (2, .5, 0) of a box twice as large as ours.
        self.assertEqual(numbers["eye"], [1, 0.25, 0])
        self.assertEqual(numbers["look_at"], [0, 0.25, 0])
        self.assertEqual(numbers["up"], [0, 1, 0])
        self.assertAlmostEqual(numbers["fov_deg"][0], 59.979351, places=5)

    def test_table_has_what_gazebench_reads_of_a_metric(self):
        row = {"scene": "head", "variant": "mdc:blend_px=2", "jod": 9.8765, "frames": 24, "size": [40, 30], "fps": 60,
               "reference": "standard"}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "jod.csv")
            write_table(path, [row])
            with open(path, encoding="utf-8") as file:
                self.assertEqual(file.read(), "scene,method,jod,how\nhead,mdc:blend_px=2,9.877,"
                                 '"FovVideoVDP, 24 frames of 40x30 at 60 a second against standard"\n')

    def test_clip_is_read_as_the_metric_needs_it(self):
        clip = {"format": "gazecast clip", "version": 1, "frames": 2, "pictures": "frame-%04d.png", "size": [40, 30],
                "display": {"mm": [400, 300], "distance_mm": 600}, "gaze_px": [[20, 15], [21, 15]]}
        with tempfile.TemporaryDirectory() as folder:
            def write(changed):
                with open(os.path.join(folder, "clip.json"), "w", encoding="utf-8") as file:
                    json.dump(dict(clip, **changed), file)

            write({})
            read = read_clip(folder)
            self.assertEqual(read, clip)
            self.assertAlmostEqual(Judge.diagonal_inches(read), 500 / 25.4)
            self.assertEqual(picture_paths(folder, read, {"folder": "1-acuity"}, 2)[1],
                             os.path.join(folder, "1-acuity", "frame-0001.png"))
            for changed in {"version": 2}, {"format": "other"}, {"gaze_px": [[20, 15]]}:
                write(changed)
                self.assertRaises(SystemExit, read_clip, folder)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
