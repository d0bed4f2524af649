"""The time points of a series in gazeview: chosen by option, scene, keys and the panel, and played, in
the window and without one.

window_series.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import math
import os
import struct
import subprocess
import sys
import unittest

from picture import read_png, run
from window_case import CORNER_HEIGHT, GAZEVIEW, LINE_HEIGHT, SIZE, WindowCase

EDGE, POINTS = 32, 4
# Left of the panel, between the texts at the top and at the bottom.
SHOWN = (90, LINE_HEIGHT + 30, 300, SIZE[1] - CORNER_HEIGHT - 30)


def write_series(folder, name="ball.nrrd"):
    """A ball that moves to the right from one time point to the next, and a scene that shows it."""
    data = bytearray()
    for point in range(POINTS):
        for z in range(EDGE):
            for y in range(EDGE):
                for x in range(EDGE):
                    away = math.dist((x, y, z), (8 + 5 * point, 16, 16))
                    data += struct.pack("<h", int(max(0, 1000 - 100 * away)))
    with open(os.path.join(folder, name), "wb") as out:
        out.write(b"NRRD0005\ntype: short\ndimension: 4\nsizes: 32 32 32 %d\nendian: little\n"
                  b"encoding: raw\nspacings: 1 1 1 0.1\n\n" % POINTS)
        out.write(data)
    with open(os.path.join(folder, "ball.tf"), "w", encoding="ascii") as out:
        out.write("0 0 0 0 0\n0.3 0.2 0.5 0.9 0\n1 1 0.8 0.4 0.6\n")
    scene = os.path.join(folder, "ball.scene")
    with open(scene, "w", encoding="ascii") as out:
        out.write("[volume]\nfile = %s\n[transfer]\nfile = ball.tf\n" % name)
    return scene


class SeriesWindow(WindowCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = write_series(cls.place.name)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def render(self, *more):
        done = run(GAZEVIEW, "--headless", "--scene", self.scene, "--size", "96x64", "--backend",
                   "cpu", *more)
        return done

    def pictures(self, count, *more):
        done = self.render("--frames", count, "--out", self.path("p%03d.png"), *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [read_png(self.path("p%03d.png" % i)) for i in range(count)]

    def each_point(self):
        return [self.pictures(1, "--time-point", point + 1)[0] for point in range(POINTS)]

    def test_option_and_scene_choose_a_time_point(self):
        points = self.each_point()
        for i in range(POINTS):
            for k in range(i):
                self.assertFalse(points[i] == points[k], "%d looks as %d" % (i, k))
        self.assertTrue(self.pictures(1)[0] == points[0])
        with open(self.scene, encoding="ascii") as source:
            text = source.read()
        third = self.path("third.scene")
        with open(third, "w", encoding="ascii") as out:
            out.write(text.replace("[transfer]", "time_point = 3\n[transfer]"))
        run(GAZEVIEW, "--headless", "--scene", third, "--size", "96x64", "--backend", "cpu",
            "--out", self.path("third.png"))
        self.assertTrue(read_png(self.path("third.png")) == points[2])

    def test_playing_without_a_window_shows_each_at_its_time(self):
        points = self.each_point()
        played = self.pictures(11, "--play", "30", "--fps", "60", "--time-point", "2")
        for frame, picture in enumerate(played):
            point = (1 + frame // 2) % POINTS
            self.assertTrue(picture == points[point], "picture %d is not point %d" % (frame, point))

    def test_time_point_beyond_the_series_and_playing_a_session_are_refused(self):
        done = self.render("--time-point", "5")
        self.assertGreater(done.returncode, 0)
        self.assertIn("no time point 5: it has 4", done.stderr)
        done = self.render("--play", "5", "--record", self.path("no.session"))
        self.assertGreater(done.returncode, 0)
        self.assertIn("remove --play", done.stderr)

    def open_series(self, *more):
        self.start("--gaze", "0.5,0.5", "--backend", "cpu", "--method", "standard", *more,
                   scene=self.scene)
        self.move(20, LINE_HEIGHT + 20)  # the window with the mouse has the keyboard
        return self.rest()

    def shown(self, picture):
        return picture.part(*SHOWN)

    def until_other(self, before, what):
        return self.until(lambda p: self.shown(p) != self.shown(before), what)

    def until_same(self, before, what):
        return self.until(lambda p: self.shown(p) == self.shown(before), what)

    def test_keys_step_through_the_series_and_round(self):
        first = self.open_series()
        seen = [first]
        for i in range(1, POINTS):
            self.tool("key", "period")
            self.until_other(seen[-1], "point %d" % (i + 1))
            seen.append(self.rest())  # the other picture may be half presented
        for i in range(POINTS):
            for k in range(i):
                self.assertNotEqual(self.shown(seen[i]), self.shown(seen[k]))
        self.tool("key", "period")
        self.until_same(first, "round")
        self.tool("key", "comma")
        self.until_same(seen[-1], "back")

    def test_playing_shows_one_after_the_other_until_paused(self):
        first = self.open_series()
        self.tool("key", "k")
        second = self.until_other(first, "played")
        self.until_other(second, "played on")
        self.tool("key", "k")
        paused = self.rest()
        self.until_same(paused, "paused")
        self.assertLess(self.processor_share(1), 0.2)

    def test_playing_begins_with_the_option_beside_the_standard_picture(self):
        # The standard picture and the histogram are made on threads that read the volume.
        self.start("--gaze", "0.5,0.5", "--backend", "cpu", "--play", "50", "--view.compare",
                   "split", scene=self.scene)
        self.move(20, LINE_HEIGHT + 20)
        for key in (None, "e", "e"):
            if key:
                self.tool("key", key)
            seen = set()
            self.until(lambda p: seen.add(p.part(0, LINE_HEIGHT, *SIZE)) or len(seen) > 3, "it plays")
        self.assertIsNone(self.viewer.poll(), "gazeview has ended")

    def test_saved_picture_keeps_the_time_point(self):
        self.open_series("--pictures", self.place.name, "--time-point", "3")
        self.tool("key", "F12")
        names = []
        self.until(lambda p: names.extend(
            n for n in os.listdir(self.place.name) if n.startswith("gazeview")) or names, "a picture")
        self.until_idle()
        self.tool("key", "q")
        self.messages()
        with open(self.path(sorted(names)[0]), "rb") as picture:
            self.assertIn(b"time_point = 3", picture.read())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
