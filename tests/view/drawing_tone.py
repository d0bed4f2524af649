"""Drawings of a real scene are as dark as its shading map in every square, and so is its print.

drawing_tone.py GAZEVIEW SCENES-FOLDER [SCENE [OPTION...]]

The scene is a skull from a CT. Without its data the test is skipped. With another SCENE, and further
options of gazeview, differences are only printed.
"""

import os
import re
import sys
import tempfile
import unittest
import xml.etree.ElementTree as tree

from picture import read_png, run

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]
OTHER, OPTIONS = sys.argv[3:4], sys.argv[4:]
WIDTH, HEIGHT, SQUARE = 960, 768, 32
PEN = 2  # px
FINER = 4  # scan lines of a print for each row of pixels

# How far the ink of a square may be from the map's: what docs/illustration.md states. A line along
# the side of a square makes a difference of its width for the side.
BOUNDS = {"stipples": 0.035, "hatches": PEN / SQUARE}

SCENE = OTHER[0] if OTHER else os.path.join(SCENES, "fetched", "bone.scene")


def has_data():
    with open(SCENE, encoding="utf-8") as source:
        name = re.search(r"(?m)^file = (volumes/\S+)", source.read()).group(1)
    return os.path.exists(os.path.join(os.environ.get("GAZECAST_DATA", "-"), name))


def brightness_rows(path):
    """The brightness of each pixel, 0 to 1, row by row."""
    return [[value / 255 for value in row[::3]] for row in read_png(path).rows]


def crossings_of(corners, rows):
    """Where the outline of a polygon crosses scan lines. -> {row: [(x, way)]}"""
    found = {}
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1]):
        way = 1 if y1 > y0 else -1
        low, high = (y0, y1) if way > 0 else (y1, y0)
        first = max(0, int(low * FINER + 0.5))
        for row in range(first, min(rows, int(high * FINER + 0.5))):
            x = x0 + (x1 - x0) * ((row + 0.5) / FINER - y0) / (y1 - y0)
            found.setdefault(row, []).append((x * FINER, way))
    return found


def fill(sheet, corners):
    """Fill a polygon by its winding number, as viewers do."""
    for row, crossed in crossings_of(corners, len(sheet)).items():
        winding = 0
        crossed.sort()
        for (x, way), (end, _) in zip(crossed, crossed[1:]):
            winding += way
            left, right = max(0, int(x + 0.5)), min(len(sheet[row]), int(end + 0.5))
            if winding and right > left:
                sheet[row][left:right] = b"\1" * (right - left)


def svg_rows(path):
    """A print of strokes whose millimetres are pixels, drawn. -> brightness of each pixel"""
    sheet = [bytearray(FINER * WIDTH) for _ in range(FINER * HEIGHT)]
    paths = tree.parse(path).getroot().findall(".//{http://www.w3.org/2000/svg}path")
    assert len(paths) > 100, len(paths)
    for shape in paths:
        corners = [tuple(map(float, c.split())) for c in shape.get("d").strip("MZ").split("L")]
        fill(sheet, corners)
    return [
        [1 - sum(sum(sheet[FINER * y + k][FINER * x : FINER * x + FINER]) for k in range(FINER)) / FINER**2
         for x in range(WIDTH)]
        for y in range(HEIGHT)
    ]


def mean_of_square(rows, left, top):
    return sum(sum(rows[y][left : left + SQUARE]) for y in range(top, top + SQUARE)) / SQUARE**2


def squares_of(rows):
    """Squares of the shading map that lie on objects: the paper beside them is white."""
    for top in range(0, HEIGHT - SQUARE + 1, SQUARE):
        for left in range(0, WIDTH - SQUARE + 1, SQUARE):
            if all(max(rows[y][left : left + SQUARE]) < 1 for y in range(top, top + SQUARE)):
                yield left, top


class DrawingTone(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-tone-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def draw(self, drawing, *more):
        # without lines, whose ink is not that of the map
        done = run(GAZEVIEW, "--headless", SCENE, "--technique", "illustrate", "--backend", "cpu",
                   "--method", "standard", "--size", f"{WIDTH}x{HEIGHT}", "--shading_map.lines", "0",
                   "--illustration.pen_width", PEN, "--illustration.drawing", drawing, *OPTIONS, *more)
        self.assertEqual(done.returncode, 0, done.stderr)

    def compare(self, drawing, drawn, wanted):
        squares = list(squares_of(wanted))
        self.assertGreater(len(squares), 0 if OTHER else 50)
        differences = [mean_of_square(drawn, *at) - mean_of_square(wanted, *at) for at in squares]
        worst = max(map(abs, differences))
        spread = (sum(d * d for d in differences) / len(squares)) ** 0.5
        over = sum(abs(d) > 0.05 for d in differences)
        print(f"{drawing}: {len(squares)} squares, rms {spread:.4f}, worst {worst:.4f}, {over} over 0.05")
        if not OTHER:
            self.assertLessEqual(worst, BOUNDS[drawing], drawing)

    def test_drawings_and_a_print_of_a_skull(self):
        self.draw("grey", "--out", self.path("grey.png"))
        wanted = brightness_rows(self.path("grey.png"))
        for drawing in ("stipples", "hatches"):
            self.draw(drawing, "--out", self.path("drawn.png"))
            self.compare(drawing, brightness_rows(self.path("drawn.png")), wanted)
        self.draw("hatches", "--print", self.path("drawn.svg"), "--print-mm", str(WIDTH))
        self.compare("hatches", svg_rows(self.path("drawn.svg")), wanted)


if __name__ == "__main__":
    if not OTHER and not has_data():
        print("needs the data of " + SCENE)
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
