"""Sessions, videos and screenshots, made by keys in gazeview's window and checked.

window_session.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import glob
import json
import os
import re
import subprocess
import tempfile
import time
import unittest

from picture import PATIENCE_S, read_png, run
from window_case import GAZECTL, GAZEVIEW, SCENE, SIZE, WindowCase


class Leaves(WindowCase):
    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory(prefix="gazecast-test-pictures-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def begin(self, *more, gaze="mouse"):
        self.start("--gaze", gaze, "--backend", "cpu", "--pictures", self.folder, *more)

    def key(self, *keys):
        self.tool("key", *keys)

    def drag(self, x, y, by_x, by_y):
        self.move(x, y)
        self.tool("mousedown", 1)
        self.move(x + by_x // 2, y + by_y // 2)
        self.move(x + by_x, y + by_y)
        self.tool("mouseup", 1)

    def quit(self):
        self.leave()
        _, said = self.viewer.communicate(timeout=PATIENCE_S)
        self.assertEqual(self.viewer.returncode, 0, said)
        return said

    def appears(self, pattern, count=1):
        """The files with a name, once all are there and no longer grow."""
        before = None

        def whole():
            nonlocal before
            found = sorted(glob.glob(self.path(pattern)))
            sizes = [os.path.getsize(name) for name in found]
            grows, before = sizes != before, sizes
            return len(found) == count and not grows and 0 not in sizes and found

        return self.wait_for(whole, pattern, pause_s=0.1)

    def red_dot(self, picture):
        width, height = SIZE
        return any(
            r > 200 and g < 90 and b < 90
            for y in range(height - 70, height)
            for r, g, b in (picture.at(x, y) for x in range(width - 160, width))
        )

    def test_session_replays_to_the_pictures_that_were_on_the_screen(self):
        self.begin()
        self.move(100, 200)
        self.key("F9")
        self.until(self.red_dot, "a red dot")
        self.move(300, 150)
        self.key("ctrl+F12")
        self.appears("*.png", 1)
        self.drag(200, 200, 90, 40)
        self.key("2")
        self.move(120, 120)
        self.key("ctrl+F12")
        self.appears("*.png", 2)
        self.key("F9")
        self.until(lambda p: not self.red_dot(p), "no red dot")
        self.assertIn("recorded", self.quit())
        (session,) = glob.glob(self.path("*.session"))
        done = run(GAZEVIEW, "--headless", "--replay", session, "--out", self.path("f%04d.png"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        frames = [read_png(name) for name in sorted(glob.glob(self.path("f*.png")))]
        shots = [read_png(name) for name in sorted(glob.glob(self.path("gazeview-*.png")))]
        self.assertEqual(len(done.stdout.splitlines()), len(frames))
        self.assertGreater(len(frames), 2)
        self.assertFalse(shots[0] == shots[1], "nothing has changed")
        self.assertEqual((shots[0].width, shots[0].height), SIZE)
        self.assertIn(True, [frame == shots[0] for frame in frames], "the first is not among them")
        self.assertTrue(frames[-1] == shots[1], "the second is not the last")
        gaze = glob.glob(os.path.join(session, "*.gzl"))
        done = run(GAZECTL, "inspect", *gaze)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_session_from_the_start_is_shown_again_in_a_window(self):
        session = self.path("a.session")
        self.begin("--record", session)
        self.drag(200, 200, 60, 0)
        self.key("1")
        self.move(120, 120)
        self.until(self.red_dot, "a red dot")
        self.quit()
        self.viewer = subprocess.Popen(
            [GAZEVIEW, "--replay", session, "--pictures", self.folder], env=self.environment,
            stderr=subprocess.PIPE, text=True,
        )
        self.found()
        said = ""
        while "all" not in said:
            said = self.viewer.stderr.readline()
            self.assertTrue(said, "gazeview has ended")
        frames = int(re.search(r"all (\d+) frames have been shown; the last one stays", said)[1])
        self.key("ctrl+F12")
        (shot,) = self.appears("gazeview-*.png")
        self.quit()
        done = run(GAZEVIEW, "--headless", "--replay", session, "--out", self.path("f%04d.png"))
        self.assertEqual(len(done.stdout.splitlines()), frames)
        last = read_png(self.path("f%04d.png" % (frames - 1)))
        self.assertTrue(read_png(shot) == last, "the last picture is another")

    def test_isovalue_that_is_dragged_is_found_in_voxels_until_it_rests(self):
        session = self.path("a.session")
        done = run(GAZEVIEW, SCENE, "--headless", "--size", "8x8", "--technique", "isosurface",
                   "--backend", "cpu", env=self.environment)
        if "Embree" in done.stderr:
            self.skipTest(done.stderr)
        self.begin("--technique", "isosurface", "--isovalue", "90", "--method", "uniform",
                   "--record", session, gaze="0.5,0.5")
        self.key("p")
        self.until_idle()
        self.move(300, 236)  # the section isosurface, whose first row is the isovalue
        self.tool("click", 1)
        self.until_idle()
        self.move(350, 263)
        self.tool("mousedown", 1)
        self.until_idle()
        self.move(390, 263)
        self.until_idle()
        self.tool("mouseup", 1)
        time.sleep(0.4)  # the rest that is tested
        self.until_idle()
        self.key("ctrl+F12")
        (shot,) = self.appears("gazeview-*.png")
        self.quit()
        with open(os.path.join(session, "frames.tsv"), encoding="ascii") as table:
            lines = [line.split("\t") for line in table.read().splitlines()]
        changes = [line[1:] for line in lines if line[0] == "!set"]
        sources = [value for key, value in changes if key == "isosurface.source"]
        values = [float(value) for key, value in changes if key == "isosurface.isovalue"]
        self.assertEqual(sources, ["voxels", "triangles"])
        self.assertEqual(changes[-1][0], "isosurface.source", "the isovalue had triangles")
        self.assertTrue(values and values[-1] > 90, values)
        done = run(GAZEVIEW, "--headless", "--replay", session, "--out", self.path("f%04d.png"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        last = sorted(glob.glob(self.path("f*.png")))[-1]
        self.assertTrue(read_png(shot) == read_png(last), "another picture is replayed")

    def test_video_of_the_window_has_its_pictures_and_continues_while_nothing_changes(self):
        self.begin("--fps", "20")
        self.key("F10")
        self.until(self.red_dot, "a red dot")
        self.drag(200, 200, 90, 40)
        time.sleep(1)  # the time that is filmed
        self.key("F10")
        self.until(lambda p: not self.red_dot(p), "no red dot")
        (video,) = self.appears("*.mp4")
        self.assertIn("written", self.quit())
        done = run("ffprobe", "-v", "error", "-count_frames", "-show_entries",
                   "stream=width,height,avg_frame_rate,nb_read_frames", "-of", "json", video)
        (stream,) = json.loads(done.stdout)["streams"]
        self.assertEqual((stream["width"], stream["height"]), SIZE)
        self.assertEqual(stream["avg_frame_rate"], "20/1")
        self.assertGreater(int(stream["nb_read_frames"]), 20)

    def test_screenshot_has_its_scene_and_no_panels_unless_asked_for(self):
        self.begin("--method", "ddc", gaze="0.3,0.6")
        self.key("ctrl+F12")
        (plain,) = self.appears("*.png")
        self.key("shift+F12")
        both = self.appears("*.png", 2)
        (other,) = set(both) - {plain}
        self.quit()
        plain_picture, other_picture = read_png(plain), read_png(other)
        self.assertFalse(plain_picture == other_picture, "no panel is seen")
        done = run(GAZEVIEW, "--headless", plain, "--size", "%dx%d" % SIZE, "--gaze", "0.3,0.6",
                   "--backend", "cpu", "--out", self.path("again.png"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(read_png(self.path("again.png")) == plain_picture, "another scene")


if __name__ == "__main__":
    unittest.main(argv=["window_session"], verbosity=2)
