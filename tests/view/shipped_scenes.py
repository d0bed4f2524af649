"""Every scene that is shipped opens, or says where its data are to be had.

shipped_scenes.py GAZEVIEW SCENES-FOLDER

Those of the folder itself must open without $GAZECAST_DATA: they are made by a formula, or their data
are in packages of the distribution. Those of its folder fetched/ must say where to fetch their data,
and open where $GAZECAST_DATA has them. Those of study/ are measured elsewhere.
"""

import glob
import os
import re
import sys
import tempfile
import unittest

from picture import read_png, run

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]
DATA = os.environ.get("GAZECAST_DATA")
WIDTH, HEIGHT = 160, 100


def scenes_of(folder):
    found = sorted(glob.glob(os.path.join(folder, "*.scene")))
    assert found, "no scenes in " + folder
    return found


def text_of(scene):
    with open(scene, encoding="utf-8") as source:
        return source.read()


def package_files(scene):
    """The files of packages that a scene shows."""
    return re.findall(r"(?m)^(?:file|volume|labels) = (/usr/share/\S+)", text_of(scene))


class ShippedScenes(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="gazecast-test-scenes-")
        self.addCleanup(place.cleanup)
        self.picture = os.path.join(place.name, "scene.png")

    def open(self, scene, data):
        environment = {name: value for name, value in os.environ.items() if name != "GAZECAST_DATA"}
        if data:
            environment["GAZECAST_DATA"] = data
        backend = "gl" if "technique = slices" in text_of(scene) else "cpu"
        return run(GAZEVIEW, "--headless", "--backend", backend, "--scene", scene, "--method", "standard",
                   "--size", f"{WIDTH}x{HEIGHT}", "--out", self.picture, env=environment)

    def check_shown(self, scene, done):
        """The object is not small, and none of it is cut off."""
        if "OpenGL" in done.stderr:
            self.skipTest("no OpenGL for " + os.path.basename(scene))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("warning", done.stderr)
        picture = read_png(self.picture)
        ground = picture.at(0, 0)
        shown = sum(picture.at(x, y) != ground for x in range(WIDTH) for y in range(HEIGHT))
        self.assertGreater(shown, 0.05 * WIDTH * HEIGHT, "it is small or absent")
        if "[environment]" in text_of(scene):
            return
        border = [picture.at(x, y) for x in range(WIDTH) for y in (0, HEIGHT - 1)]
        border += [picture.at(x, y) for y in range(HEIGHT) for x in (0, WIDTH - 1)]
        self.assertEqual(set(border), {ground}, "the picture's border cuts it off")

    def test_scenes_open_without_fetched_data(self):
        techniques = set()
        for scene in scenes_of(SCENES):
            with self.subTest(scene=os.path.basename(scene)):
                techniques.update(re.findall(r"(?m)^technique = (\w+)", text_of(scene)) or ["raycast"])
                done = self.open(scene, None)
                if all(map(os.path.exists, package_files(scene))):
                    self.check_shown(scene, done)
                else:
                    self.assertEqual(done.returncode, 1)
                    self.assertRegex(done.stderr, "get its data here: .*package [a-z]+")
        self.assertEqual(techniques, {"raycast", "slices", "isosurface", "illustrate"})

    def test_fetched_scenes_say_where_their_data_are(self):
        for scene in scenes_of(os.path.join(SCENES, "fetched")):
            with self.subTest(scene=os.path.basename(scene)):
                done = self.open(scene, None)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, "get its data here: .*https://")

    @unittest.skipUnless(DATA, "GAZECAST_DATA is not set")
    def test_fetched_scenes_open_with_their_data(self):
        for scene in scenes_of(os.path.join(SCENES, "fetched")):
            with self.subTest(scene=os.path.basename(scene)):
                self.check_shown(scene, self.open(scene, DATA))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
