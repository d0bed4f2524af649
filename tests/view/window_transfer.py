"""The editor of the transfer function in gazeview's window, by mouse and by keyboard.

window_transfer.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import math
import os
import shutil
import sys
import unittest

from picture import read_png, run, write_scene
from window_case import GAZEVIEW, PLACE, SCENE, SCENES, SCREEN, WindowCase

# Width and height of the plot at scale 1.
PLOT = (508, 171)
SHOWN = (560, 60, 890, 640)  # the picture beside the panel
FIXED = ("--gaze", "0.5,0.5", "--method", "standard", "--backend", "cpu")
FUNCTION = os.path.join(PLACE.name, "edited.tf")


def own_function():
    """Give the scene a transfer function that may be overwritten."""
    shutil.copy(os.path.join(SCENES, "shells.tf"), FUNCTION)
    write_scene(PLACE.name, SCENES)
    with open(SCENE, encoding="utf-8") as source:
        text = source.read()
    text = text.replace(os.path.join(SCENES, "shells.tf"), FUNCTION)
    with open(SCENE, "w", encoding="utf-8") as out:
        out.write(text)


def read_function():
    with open(FUNCTION, encoding="utf-8") as file:
        return file.read()


class TransferWindow(WindowCase):
    def open_editor(self):
        own_function()
        self.start(*FIXED)
        self.tool("windowsize", self.window, *SCREEN)
        self.tool("mousemove", SCREEN[0] - 3, SCREEN[1] // 2)
        # The screen outside the window is black, unlike the scene's background.
        self.until(lambda p: p.at(SCREEN[0] - 3, SCREEN[1] - 3) != (0, 0, 0), "large window")
        before = self.rest()
        self.tool("key", "e")
        # The first point, which is selected, has a white ring: at value 0 and opacity 0.
        picture = self.until(self.find_plot, "editor")
        self.assertTrue(self.same(picture, before), "nothing is changed yet")
        return picture

    def find_plot(self, picture):
        white = (255, 255, 255)
        for y in range(SCREEN[1] // 2, SCREEN[1] - 20):
            for x in range(16, 40):
                ring = ((6, 0), (-6, 0), (0, 6), (0, -6))
                if all(picture.at(x + a, y + b) == white for a, b in ring):
                    self.corner = (x, y)
                    return True
        return False

    def point_at(self, value, opacity):
        """Place of a point, on a logarithmic axis of opacity."""
        height = math.log1p(1e4 * opacity) / math.log1p(1e4)
        return (round(self.corner[0] + value * PLOT[0]),
                round(self.corner[1] - height * PLOT[1]))

    def shown(self, picture):
        return picture.part(*SHOWN)

    def same(self, a, b):
        return self.shown(a) == self.shown(b)

    def until_other(self, before, what):
        return self.until(lambda p: not self.same(p, before), what)

    def until_same(self, before, what):
        return self.until(lambda p: self.same(p, before), what)

    def drag(self, start, end):
        self.move(*start)
        self.tool("mousedown", 1)
        self.until_idle()
        for i in range(1, 6):
            self.move(*(round(a + (b - a) * i / 5) for a, b in zip(start, end)))
            self.until_idle()
        self.tool("mouseup", 1)
        self.until_idle()

    def test_dragged_point_changes_the_picture_and_undo_restores_it(self):
        first = self.open_editor()
        self.drag(self.point_at(0.65, 0.2), self.point_at(0.62, 0.0))
        self.until_other(first, "dragged")
        changed = self.rest()
        self.tool("key", "ctrl+z")
        self.until_same(first, "taken back")
        self.tool("key", "ctrl+shift+z")
        self.until_same(changed, "done again")
        self.tool("key", "ctrl+z")
        self.until_same(first, "taken back again")
        self.viewer.terminate()
        said = self.messages()
        self.assertEqual(said.count("undone: Transfer function, point moved"), 2, said)
        self.assertEqual(said.count("redone: Transfer function, point moved"), 1, said)

    def test_point_is_added_and_removed_by_the_mouse(self):
        first = self.open_editor()
        place = self.point_at(0.28, 0.9)
        self.move(*place)
        self.tool("click", 1)
        added = self.until_other(first, "added")
        self.assertFalse(self.same(added, first))
        self.tool("click", 3)
        self.until_same(first, "removed")

    def test_point_is_added_moved_and_removed_by_the_keyboard(self):
        first = self.open_editor()
        # Ninth point, at 0.58; the next is the peak of the yellow shell.
        self.press("Tab", 8)
        self.press("Insert")
        self.assertTrue(self.same(self.rest(), first), "it lies on the curve")
        self.press("Up", 12)
        self.until_other(first, "moved")
        self.press("Delete")
        self.until_same(first, "removed")

    def test_arrows_turn_the_camera_while_the_mouse_is_over_the_picture(self):
        first = self.open_editor()
        self.click(*self.point_at(0.28, 0))
        self.move(SCREEN[0] // 2, 60)
        self.press("Right")
        turned = self.until_other(first, "turned")
        self.press("Left")
        back = self.until_other(turned, "turned back")
        # Over the editor they move the point that was clicked.
        self.move(*self.point_at(0.5, 0.5))
        self.press("Up", 12)
        self.until_other(back, "another function")

    def test_drag_with_shift_keeps_the_value(self):
        first = self.open_editor()
        start = self.point_at(0.65, 0.2)
        self.tool("keydown", "shift")
        self.drag(start, (start[0] + 12, start[1] + 60))
        self.tool("keyup", "shift")
        sideways = self.until_other(first, "lower")
        self.tool("key", "ctrl+z")
        self.until_same(first, "taken back")
        self.drag(start, (start[0], start[1] + 60))
        self.until_same(sideways, "straight down")

    def test_open_editor_takes_no_processor_time(self):
        self.open_editor()
        self.rest()
        self.assertLess(self.processor_share(), 0.03)

    def test_double_click_colours_a_point(self):
        first = self.open_editor()
        self.move(*self.point_at(0.65, 0.2))
        self.tool("click", "--repeat", 2, "--delay", 80, 1)
        self.until_idle()
        # The colour square, right below the mouse: grey.
        x, y = self.point_at(0.65, 0.2)
        self.move(x + 20, y + 100)
        self.tool("click", 1)
        self.press("Escape")
        self.move(SCREEN[0] - 3, SCREEN[1] // 2)
        self.until_other(first, "coloured")

    def test_scene_saved_has_what_was_edited(self):
        first = self.open_editor()
        self.drag(self.point_at(0.65, 0.2), self.point_at(0.62, 0.0))
        self.until_other(first, "dragged")
        changed = self.rest()
        self.tool("key", "ctrl+s")
        written = os.path.splitext(SCENE)[0] + ".tf"
        self.wait_for(lambda: os.path.exists(written), written)
        self.addCleanup(os.remove, written)
        self.until_idle()
        with open(SCENE, encoding="utf-8") as file:
            saved = file.read()
        out = os.path.join(PLACE.name, "scene.png")
        done = run(GAZEVIEW, SCENE, "--headless", "--size", "%dx%d" % SCREEN, *FIXED, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr + saved)
        self.assertTrue(read_png(out).part(*SHOWN) == self.shown(changed), saved)

    def test_escape_gives_the_keyboard_back_to_the_window(self):
        self.open_editor()
        self.press("Escape")
        self.press("e")
        self.until(lambda p: not self.find_plot(p), "closed")

    def test_colours_of_a_map_keep_the_opacity(self):
        first = self.open_editor()
        opacities = [line.split()[4] for line in read_function().splitlines()
                     if line and line[0].isdigit()]
        left, bottom = self.corner
        self.move(left + 141, bottom - PLOT[1] - 22)
        self.tool("click", 1)
        self.until_idle()
        self.move(left + 141, bottom - PLOT[1] - 22 + 41)
        self.tool("click", 1)
        self.until_other(first, "colours")
        before = read_function()
        self.move(left + 380, bottom + 105)
        self.tool("click", 1)
        self.wait_for(lambda: read_function() != before, "the coloured file")
        points = [[float(word) for word in line.split()] for line in read_function().splitlines()
                  if line and line[0].isdigit()]
        for at, colour in ((0, (68, 1, 84)), (-1, (253, 231, 37))):
            for part, known in zip(points[at][1:4], colour):
                self.assertAlmostEqual(255 * part, known, delta=0.01)
        self.assertTrue({float(o) for o in opacities} <= {point[4] for point in points})

    def test_saved_preset_gives_the_same_picture_without_a_window(self):
        first = self.open_editor()
        left, bottom = self.corner
        self.move(left + 40, bottom - PLOT[1] - 22)
        self.tool("click", 1)
        self.until_idle()
        self.move(left + 40, bottom - PLOT[1] - 22 + 37 + 17)
        self.tool("click", 1)
        self.until_other(first, "preset")
        chosen = self.rest()
        before = read_function()
        self.move(left + 380, bottom + 105)
        self.tool("click", 1)
        self.wait_for(lambda: read_function() != before, "the preset's file")
        out = os.path.join(PLACE.name, "saved.png")
        done = run(GAZEVIEW, SCENE, "--headless", "--size", "%dx%d" % SCREEN, *FIXED,
                   "--render.shading", "gradient", "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(read_png(out).part(*SHOWN) == self.shown(chosen), "another picture")
        # Light is one step, and the curve another.
        lit = self.shown(self.grab())
        self.tool("key", "ctrl+z")
        self.until(lambda p: self.shown(p) != lit, "without light")
        self.assertFalse(self.same(self.rest(), first), "the curve is still the preset's")
        self.tool("key", "ctrl+z")
        self.until_same(first, "without preset")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[5:], verbosity=1)
