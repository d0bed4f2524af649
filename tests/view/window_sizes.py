"""gazeview's window at the sizes of usual displays: panels beside each other, menus within reach.

window_sizes.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import sys
import unittest

import window_case
from window_case import GROUND, WindowCase

PANEL_GROUND = bytes((15, 15, 15))
STILL = ("--gaze", "0.5,0.5", "--method", "acuity", "--backend", "cpu")
KEYS = {"settings": "p", "frame times": "b", "gaze": "g", "transfer function": "e"}


def box_of(places):
    """Left, top, right and bottom of some places."""
    across, down = zip(*places)
    return min(across), min(down), max(across), max(down)


def overlap(a, b):
    return max(a[0], b[0]) < min(a[2], b[2]) and max(a[1], b[1]) < min(a[3], b[3])


class SizesCase:
    menu = "yes"
    size, scale = (1280, 720), 1
    together = (KEYS,)  # panels that the window has room for

    @classmethod
    def setUpClass(cls):
        window_case.SCREEN = window_case.SIZE = cls.size
        super().setUpClass()

    def launch(self, *words):
        super().launch("--interface-scale", str(self.scale), *words)

    def shows_something(self, picture):
        middle = picture.rows[self.size[1] // 2]
        return picture.at(5, 5) != GROUND and len({middle[x : x + 3] for x in range(0, len(middle), 12)}) > 20

    def places(self, picture, is_in):
        """The places, some pixels apart, whose pixels is_in() accepts. It is given a row of bytes,
        where the pixel is in it, and the row's number."""
        step = 3 * self.scale
        return [(x, y) for y in range(0, picture.height, step) for x in range(0, picture.width, step)
                if is_in(picture.rows[y], 3 * x, y)]

    def opened(self, before, now):
        """The box of what became the ground of a panel."""
        return box_of(self.places(now, lambda row, at, y: row[at : at + 3] == PANEL_GROUND and
                                  before.rows[y][at : at + 3] != PANEL_GROUND))

    def test_panels_stand_beside_each_other(self):
        self.start(*STILL)
        for names in self.together:
            self.open_panels(names)
            for name in names:
                self.press(KEYS[name])  # closes it

    def open_panels(self, names):
        """Open panels one after another; none covers another, nor the window's edge."""
        self.move(self.size[0] // 2, self.size[1] - 3)
        shown, boxes = self.rest(), {}
        for name in names:
            self.press(KEYS[name])
            before, shown = shown, self.until(lambda p: p != shown, name)
            self.until_idle()
            shown = self.rest()
            box = self.opened(before, shown)
            for other, its in boxes.items():
                self.assertFalse(overlap(box, its), f"{name} {box} lies over {other} {its}")
                self.assertEqual(shown.part(*its), before.part(*its), f"{name} changes {other}")
            boxes[name] = box
            self.assertLess(box[2], self.size[0])
            self.assertLess(box[3], self.size[1])

    def test_everything_of_the_start_window_is_within_reach(self):
        self.launch()
        self.move(3, self.size[1] - 3)
        self.until_idle()
        shown = self.until(lambda p: p.at(self.size[0] // 2, self.size[1] // 2) != GROUND, "start window")
        # A panel that is too high is cut 8 away from the window's edge, and must be scrolled.
        margin, bar = 9 * self.scale, 24 * self.scale
        box = box_of(self.places(shown, lambda row, at, y: y > bar and row[at : at + 3] != bytes(GROUND)))
        self.assertGreater(box[0], margin)
        self.assertGreater(box[1], bar)
        self.assertLess(box[2], self.size[0] - margin)
        self.assertLess(box[3], self.size[1] - margin)

    def test_menus_open_within_the_window(self):
        self.start(*STILL)
        self.move(self.size[0] // 2, self.size[1] - 3)
        bare, seen = self.rest(), []
        self.click(20 * self.scale, 9 * self.scale)
        for x in range(20, 420, 14):
            self.move(x * self.scale, 9 * self.scale)
            shown = self.rest()
            below = 24 * self.scale
            changed = self.places(shown, lambda row, at, y: y > below and
                                  row[at : at + 3] != bare.rows[y][at : at + 3])
            if not changed:
                continue
            box = box_of(changed)
            if box not in seen:
                seen.append(box)
                self.until(lambda p: True, "menu %d" % len(seen))
            self.assertLess(box[2], self.size[0] - self.scale)
            self.assertLess(box[3], self.size[1] - self.scale)
        self.assertGreaterEqual(len(seen), 7)  # File, Edit, View, Gaze, Picture, Study, Help


class Laptop(SizesCase, WindowCase):
    together = (("settings", "frame times", "gaze"), ("settings", "transfer function"),
                ("transfer function", "frame times"))


class Desktop(SizesCase, WindowCase):
    size = (1920, 1080)


class FineDisplay(SizesCase, WindowCase):
    size, scale = (3840, 2160), 2


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
