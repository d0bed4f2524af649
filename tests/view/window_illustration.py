"""Illustrations in gazeview's window: the object at the gaze, the curve of the haze, the plain view.

window_illustration.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import sys
import unittest

from picture import PATIENCE_S, write_labels
from window_case import WindowCase

# The panel with only the haze unfolded: depth 0 and 1 of its curve, and heights of haze 0 and 1.
NEAREST, FARTHEST, CLEAR, HAZY = 95, 443, 288, 172


def at_depth(depth):
    return round(NEAREST + depth * (FARTHEST - NEAREST))


class Illustrations(WindowCase):
    def write(self, *lines):
        self.own = write_labels(self.place.name, "[render]", "technique = illustrate", "[camera]",
                                "eye = 0 -2.5 0.8", *lines)
        return self.own

    def unfold_haze(self):
        self.press("shift+i")
        for heading in (71, 92, 122):  # Look and Parameters are folded, then the haze unfolded
            self.click(280, heading)

    def value(self, lines, key):
        found = [line.split(" = ")[1] for line in lines if line.startswith(key + " = ")]
        return float(found[0]) if found else None

    def test_haze_is_dragged_by_its_handles(self):
        self.start("--gaze", "0.5,0.5", "--backend", "cpu", scene=self.write())
        self.unfold_haze()
        # Where it begins, which is 0.6 times the foreground, and where it ends.
        self.drag((at_depth(0.3), CLEAR), (at_depth(0.5), CLEAR - 40))
        self.until(lambda p: p.at(at_depth(0.5), CLEAR) > (200, 200, 200), "the moved handle")
        self.drag((at_depth(0.8), HAZY), (at_depth(0.9), HAZY))
        lines = self.saved()
        self.assertAlmostEqual(self.value(lines, "foreground"), 0.5 / 0.6, delta=0.01)
        self.assertAlmostEqual(self.value(lines, "haze_far"), 0.9, delta=0.005)
        # Combined settings tie the growth to the beginning: its handle is a mark only.
        self.drag((at_depth(0.7), 230), (at_depth(0.7), 260))
        self.assertNotEqual(self.title()[0], "*")
        # What was dragged is undone step by step.
        self.press("ctrl+z")
        lines = self.saved()
        self.assertAlmostEqual(self.value(lines, "foreground"), 0.5 / 0.6, delta=0.01)
        self.assertAlmostEqual(self.value(lines, "haze_far"), 0.8, delta=1e-9)

    def test_growth_of_the_haze_is_dragged_with_single_settings(self):
        self.start("--gaze", "0.5,0.5", "--backend", "cpu", scene=self.write(
            "[illustration]", "settings = single"))
        self.unfold_haze()
        middle = at_depth((0.3 + 0.8) / 2)
        height = round(CLEAR + 0.25 * (HAZY - CLEAR))
        self.drag((middle, (CLEAR + HAZY) // 2), (middle, height))
        # A quarter of the haze half way: the exponent is 2.
        self.assertAlmostEqual(self.value(self.saved(), "haze_exponent"), 2, delta=0.1)

    def pick(self, gaze):
        """Press Shift+A with a gaze that rests. -> gazeview's messages"""
        self.start("--gaze", gaze, "--backend", "cpu", scene=self.write())
        self.press("shift+a")
        self.tool("key", "q")
        self.viewer.wait(timeout=PATIENCE_S)
        return self.messages()

    def test_object_at_the_gaze_is_chosen(self):
        self.assertIn("left lobe; A lists all objects", self.pick("0.4,0.5"))
        other = self.pick("0.6,0.5")
        self.assertTrue("; A lists all objects" in other and "left lobe" not in other, other)
        self.assertIn("no object with a surface is at the gaze", self.pick("0.05,0.5"))
        # With the list open, its row is marked, wherever the mouse is.
        self.start("--gaze", "0.4,0.5", "--backend", "cpu", scene=self.write())
        self.press("a")
        before = self.amber_letters_left(self.rest())
        self.press("shift+a")
        self.until(lambda p: self.amber_letters_left(p) > before + 20, "the row at the gaze")

    def test_plain_surfaces_are_beside_the_illustration(self):
        first = self.start("--gaze", "0.5,0.5", "--method", "standard", "--backend", "cpu",
                           scene=self.write("[shading_map]", "lines = 1"))
        self.find("plain surfaces")
        self.press("Return")
        left, right = (100, 90, 230, 230), (250, 90, 380, 230)
        self.until(lambda p: p.part(*right) != first.part(*right) and
                   p.part(*left) == first.part(*left), "plain surfaces on the right")
        lines = self.saved()
        self.assertIn("compare = split", lines)
        self.assertIn("compare_with = plain", lines)
        self.find("plain surfaces")
        self.press("Return")
        self.until(lambda p: p.part(*right) == first.part(*right), "the illustration alone")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
