"""Menus, the search and the settings of gazeview's window, as a person with a mouse uses them.

window_menus.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import glob
import math
import os
import sys
import unittest

from picture import PATIENCE_S, read_png, run, write_labels
from window_case import GAZEVIEW, SCENE, SIZE, WindowCase

BAR = (36, 36, 36)  # the menu bar's ground


class Menus(WindowCase):
    menu = "yes"

    def start_own_scene(self, *more):
        """Start with a copy of the small scene, which may be saved."""
        self.own = os.path.join(os.path.dirname(SCENE), "own-%s.scene" % self.id()[-20:])
        with open(SCENE, encoding="utf-8") as scene, open(self.own, "w", encoding="utf-8") as own:
            own.write(scene.read())
        self.addCleanup(lambda: os.path.exists(self.own) and os.unlink(self.own))
        return self.start("--gaze", "mouse", "--method", "acuity", *more, scene=self.own)

    def amber_letters(self, picture):
        pixels = (picture.at(x, y) for x in range(100, SIZE[0] - 10) for y in range(20, 250))
        return sum(r > 160 and 0.6 * r < g < 0.85 * r and b < 0.5 * r for r, g, b in pixels)

    def bar_is_shown(self, picture):
        return picture.at(SIZE[0] // 2, 2) == BAR

    def test_menus_and_search_do_what_they_say(self):
        first = self.start_own_scene()
        self.assertTrue(self.bar_is_shown(first))
        self.move(240, 160)
        self.until_idle()
        # Gaze, Cross at the gaze. While the mouse is in the bar, its gaze stays.
        self.click(149, 9)
        self.click(180, 123)
        self.until(lambda p: self.near(self.red_middle(p), (180, 123)), "a cross")
        self.move(260, 9)
        self.assertTrue(self.near(self.red_middle(self.rest()), (180, 123)))
        # A right click on the picture, and its last row: the list of keys.
        self.click(60, 60, button=3)
        shown = self.rest()
        self.assertEqual(self.viewer.poll(), None)
        self.assertNotEqual(shown.part(62, 62, 200, 300), first.part(62, 62, 200, 300))
        self.click(420, 200)
        # The search finds nothing, a setting, an action by another word.
        self.find("zzzz")
        self.until(lambda p: self.amber_letters(p) > 60, "nothing found")
        self.press("Escape")
        self.find("background")
        before = self.rest()
        self.press("Return")
        self.until(lambda p: p.part(100, 60, 470, 300) != before.part(100, 60, 470, 300) and
                   self.amber_letters(p) > 60, "the setting, marked")
        self.press("p")
        self.find("split")
        self.press("Return")
        self.assertIn("compare = split", self.saved())
        self.assertIn("gaze_cursor = true", self.saved())
        self.assertEqual(self.title(), os.path.basename(self.own) + " - gazeview")
        # A change marks the title, and quitting asks; undo takes both back.
        self.press("1")
        self.assertEqual(self.title()[0], "*")
        self.press("q")
        asked = self.rest()
        self.assertEqual(self.viewer.poll(), None)
        self.press("Escape")
        self.assertNotEqual(self.rest().part(140, 100, 340, 200), asked.part(140, 100, 340, 200))
        self.press("ctrl+z")
        self.assertNotEqual(self.title()[0], "*")
        # One key hides the bar.
        self.press("u")
        self.until(lambda p: not self.bar_is_shown(p), "no bar")
        self.find("exit")
        self.press_last("Return")

    def test_stored_views_are_grey_while_they_are_empty(self):
        self.start_own_scene()
        self.tool("windowsize", self.window, 700, 400)
        self.move(600, 350)
        self.press("shift+F2")
        self.click(100, 9)
        self.move(130, 122)  # Stored views
        self.until_idle()
        self.move(375, 122 + 17 * 5)

        def brightest(picture, row):
            return max(min(picture.at(x, y)) for x in range(366, 452)
                       for y in range(115 + 17 * row, 129 + 17 * row))

        self.until(lambda p: [brightest(p, row) > 200 for row in range(8)] ==
                   [False, True] + 6 * [False], "one view")
        self.click(375, 122 + 17 * 5)  # does nothing
        self.viewer.terminate()
        self.assertNotIn("no view stored", self.messages())

    def test_everyday_words_find_something(self):
        self.start()
        for word in ("screenshot", "undo", "light", "colour", "shading", "clip", "background", "reset",
                     "help", "exit", "fullscreen", "movie", "slice"):
            with self.subTest(word=word):
                self.find(word)
                self.assertLess(self.amber_letters(self.rest()), 60, "nothing found")
                self.press("Escape")
        self.find("qqqq")
        self.assertGreater(self.amber_letters(self.rest()), 60)

    def choose_technique(self, row):
        """Choose from the list of render.technique: 3 is slices, 1 raycast. The panel closes."""
        self.find("technique")
        self.press("Return")
        self.click(410, 122)  # the list opens
        self.click(300, 146 + 17 * row)
        self.press("p")
        self.move(SIZE[0] - 5, 40)

    def test_window_on_cpu_shows_slices_and_then_rays_again(self):
        keys = ("--gaze", "0.5,0.5", "--method", "standard", "--slices.count", "16")
        wanted = {}
        for technique in ("slices", "raycast"):
            out = os.path.join(self.place.name, technique + ".png")
            done = run(GAZEVIEW, SCENE, "--headless", "--size", "%dx%d" % SIZE, *keys,
                       "--technique", technique, "--out", out, env=self.environment)
            if technique == "slices" and "OpenGL" in done.stderr:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            wanted[technique] = read_png(out)
        middle = (60, 55, 420, 250)
        self.assertNotEqual(wanted["slices"].part(*middle), wanted["raycast"].part(*middle))
        self.menu = "no"
        self.start(*keys)
        self.move(SIZE[0] - 5, 40)
        for technique, row in (("slices", 3), ("raycast", 1)):
            self.choose_technique(row)
            self.until(lambda p: p.part(*middle) == wanted[technique].part(*middle), technique)
        self.viewer.terminate()
        self.assertNotIn("refused", self.messages())

    def test_picture_at_rest_and_saved_is_of_full_quality(self):
        self.refine = "yes"
        self.start_own_scene("--pictures", self.place.name, "--backend", "cpu")
        out = os.path.join(self.place.name, "standard.png")
        done = run(GAZEVIEW, "--headless", self.own, "--method", "standard", "--size",
                   "%dx%d" % SIZE, "--backend", "cpu", "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        standard = read_png(out)
        part = (60, 55, 420, 250)
        self.move(240, 160)
        self.until(lambda p: p.part(*part) == standard.part(*part), "full quality at rest")
        self.move(60, 60)
        self.until(lambda p: p.part(*part) != standard.part(*part), "coarse beside the gaze")
        self.tool("key", "F12")
        saved = self.wait_for(lambda: glob.glob(os.path.join(self.place.name, "gazeview-*.png")),
                              "a saved picture")
        self.tool("key", "q")
        self.viewer.wait(timeout=PATIENCE_S)
        self.assertIn("written", self.messages())
        self.assertTrue(read_png(saved[0]) == standard, "another picture is saved")

    def test_region_is_chosen_by_a_click_shown_alone_and_saved(self):
        self.own = write_labels(self.place.name, "[camera]", "eye = 0 -2.5 0")
        first = self.start("--gaze", "mouse", "--backend", "cpu", scene=self.own)
        self.assertTrue(self.is_blue(first.at(300, 195)))
        self.press("a")
        self.click(170, 200)  # on label 5, below the panel
        self.until(lambda p: self.amber_letters_left(p) > 20, "the name of the chosen region")
        self.click(57, 163)  # Show it alone
        self.press("a")
        self.until(lambda p: not self.is_blue(p.at(300, 195)), "only one region")
        lines = self.saved()
        self.assertEqual(lines[lines.index("[region 1]"):][:4],
                         ["[region 1]", "object = lobes", "label = 9", "visible = false"])
        self.press("ctrl+z")
        self.until(lambda p: self.is_blue(p.at(300, 195)), "both regions")
        self.assertEqual(self.title()[0], "*")
        # The search finds regions by their names.
        self.find("left lobe")
        self.press("Return")
        self.until(lambda p: self.amber_letters_left(p) > 20, "the region that was found")

    def test_illustration_is_looked_at_by_parameters_and_printed(self):
        self.own = write_labels(self.place.name, "[render]", "technique = illustrate", "[camera]",
                                "eye = 0 -2.5 0.8", "[illustration]", "drawing = stipples")
        self.start("--gaze", "mouse", "--backend", "cpu", scene=self.own)
        self.press("shift+i")
        self.click(280, 91)  # Look is folded
        part = (180, 128, 266, 182)  # of the gallery, "plain"
        self.until(lambda p: len(self.greys(p, part)) > 20, "a small picture")
        self.click(223, 155)
        self.press("shift+i")
        self.assertIn("show = plain", self.saved())
        self.press("ctrl+z")
        self.assertEqual(self.title()[0], "*")
        # Points are written for print.
        out = os.path.join(self.place.name, "two.svg")
        self.press("ctrl+shift+e")
        self.click(185, 140)
        self.press("Return")
        self.wait_for(lambda: os.path.exists(out), "a drawing for print")
        with open(out, encoding="utf-8") as drawing:
            self.assertGreater(drawing.read().count("<circle"), 100)

    def greys(self, picture, part):
        left, top, right, bottom = part
        return {picture.at(x, y) for x in range(left, right) for y in range(top, bottom)}

    def is_blue(self, pixel):
        return pixel[2] > pixel[0] + 60

    def crosses(self, picture):
        """Columns of the axial slice's and of the coronal slice's crosshair."""
        def columns(left, right, top, bottom):
            return [x for x in range(left, right) if 20 < sum(
                r > 150 and g > 110 and b < 110
                for r, g, b in (picture.at(x, y) for y in range(top, bottom)))]

        return columns(0, 240, 50, 135), columns(240, 480, 170, 275)

    def test_slices_have_the_line_of_the_clip_plane(self):
        self.start_own_scene("--view.layout", "slices", "--clip.plane=yes", "--clip.normal",
                             "1 0.6 0.3")

        def lines(picture):
            """Rows of each slice in which there is something of the line."""
            return [sum(any(b > 170 and g > 150 and r < 150 for r, g, b in
                            (picture.at(x, y) for x in range(left, left + 240)))
                        for y in range(top, top + 60))
                    for left, top in ((0, 65), (240, 65), (240, 200))]

        self.until(lambda p: min(lines(p)) > 20, "three lines")
        self.find("remove the clip plane")
        self.press("Return")
        self.until(lambda p: max(lines(p)) == 0, "no line")

    def test_slices_are_moved_measured_and_saved(self):
        self.start_own_scene()
        self.find("sagittal")
        self.press("Return")
        shown = self.until(lambda p: all(self.crosses(p)), "slices")
        middle = self.crosses(shown)
        # A click in the axial slice moves the coronal slice's crosshair as well.
        self.click(135, 96)
        moved = self.until(lambda p: self.crosses(p) != middle, "a moved crosshair")
        self.assertTrue(self.near(self.crosses(moved)[0][-1:], (135,)), self.crosses(moved))
        self.assertNotEqual(self.crosses(moved)[1], middle[1])
        # The wheel leafs through slices, a line is measured, and a right drag sets the window.
        self.tool("click", 4)
        self.until(lambda p: p.part(100, 60, 130, 90) != moved.part(100, 60, 130, 90), "next slice")
        self.drag((105, 96), (135, 96), key="shift")
        name = self.wait_for(lambda: self.tool("getwindowname", self.window), "a title")
        self.assertTrue(name.startswith("*"), "a distance is lost without a question")
        self.drag((120, 90), (160, 90), button=3)
        keys = dict(line.split(" = ", 1) for line in self.saved() if " = " in line)
        ends = [float(share) for share in keys["distances"].split()]
        self.assertEqual(len(ends), 6)
        self.assertEqual(ends[1:3], ends[4:6])
        self.assertLess(ends[3], ends[0])  # the right side is on the left
        self.assertGreater(float(keys["slice_width"]), 0)
        self.assertEqual(keys["layout"], "slices")
        crosshair = [float(share) for share in keys["crosshair"].split()]
        self.assertAlmostEqual(crosshair[0], ends[3], delta=0.02)
        self.assertAlmostEqual(crosshair[2], ends[2], delta=1e-5)
        # Undone: the grey window, then the line.
        self.press("ctrl+z")
        self.press("ctrl+z")
        keys = dict(line.split(" = ", 1) for line in self.saved() if " = " in line)
        self.assertEqual(keys["distances"], "")
        self.assertEqual(float(keys["slice_width"]), 0)
        self.press("shift+s")
        self.until(lambda p: not any(self.crosses(p)) and self.shows_something(p),
                   "the picture alone")

    def own_camera(self):
        """The scene's own camera: the place of the eye, the field of view in degrees, and the
        directions to the right, up and ahead."""
        with open(SCENE, encoding="utf-8") as text:
            keys = dict(line.split(" = ", 1) for line in text.read().splitlines() if " = " in line)
        eye, middle, up = ([float(n) for n in keys[key].split()] for key in ("eye", "look_at", "up"))

        def cross(a, b):
            return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

        def unit(a):
            return [n / math.hypot(*a) for n in a]

        ahead = unit([m - e for m, e in zip(middle, eye)])
        right = unit(cross(ahead, up))
        return eye, float(keys["fov_deg"]), (right, cross(right, ahead), ahead)

    def place_of(self, world):
        """Where a point of the world is in the window, by the scene's own camera."""
        eye, fov_deg, axes = self.own_camera()
        x, y, depth = (sum(a * (w - e) for a, w, e in zip(axis, world, eye)) for axis in axes)
        scale = SIZE[1] / 2 / math.tan(math.radians(fov_deg) / 2) / depth
        return SIZE[0] / 2 + x * scale, SIZE[1] / 2 - y * scale

    def test_clip_box_is_dragged_by_a_handle_undone_and_removed(self):
        self.start_own_scene()
        at, end = ([round(n) for n in self.place_of((x, 0, 0))] for x in (0.5, 0.1))
        self.move(*end)  # the gaze, as after the drag
        whole = self.rest()
        self.find("crop")
        self.press("Return")
        self.until(lambda p: any(p.at(at[0] + a, at[1] + b) == (255, 214, 64)
                                 for a in range(-8, 9) for b in range(-8, 9)), "a handle")
        self.drag(at, end)
        keys = dict(line.split(" = ", 1) for line in self.saved() if " = " in line)
        greatest = [float(share) for share in keys["greatest"].split()]
        self.assertEqual(greatest[1:], [1, 1])
        self.assertAlmostEqual(greatest[0], 0.6, delta=0.04)
        self.press("ctrl+z")
        self.assertIn("greatest = 1 1 1", self.saved())
        self.press("ctrl+shift+z")
        self.find("remove the clip box")
        self.press("Return")
        self.press("shift+c")  # the handles go
        part = (0, 60, SIZE[0], SIZE[1] - 64)  # between the captions
        self.until(lambda p: p.part(*part) == whole.part(*part), "the whole volume")

    def saved_clip(self):
        """The clip plane of the saved scene: whether it is on, its normal, its offset."""
        keys = {"plane": "false", "normal": "1 0 0", "offset": "0.5"}  # not saved until changed
        keys.update(line.split(" = ", 1) for line in self.saved() if " = " in line)
        return (keys["plane"] == "true", [float(n) for n in keys["normal"].split()], float(keys["offset"]))

    def has_handle(self, picture, at):
        """Whether something of a clip plane's handles is near a place."""
        return any(picture.at(round(at[0]) + a, round(at[1]) + b) == (96, 220, 255)
                   for a in range(-4, 5) for b in range(-4, 5))

    def test_clip_plane_is_moved_tilted_turned_to_the_camera_and_removed(self):
        self.start_own_scene()
        _, _, (right, up, ahead) = self.own_camera()
        axis = max(range(3), key=lambda i: abs(ahead[i]))
        first = [0, 0, 0]
        first[axis] = -1 if ahead[axis] > 0 else 1  # towards the viewer
        middle = self.place_of((0, 0, 0))
        away = self.place_of([0.2 * n for n in first])
        at, end = [round(n) for n in middle], [round(n) for n in away]
        self.move(*end)  # the gaze, as after the drag
        whole = self.rest()
        self.assertFalse(self.has_handle(whole, middle))
        self.find("oblique")
        self.press("Return")
        shown = self.until(lambda p: self.has_handle(p, middle), "a handle")
        self.assertTrue(self.has_handle(shown, (middle[0], middle[1] - 46)))  # the ring
        self.assertEqual(self.saved_clip(), (True, first, 0.5))
        # Along its normal, by as much as the mouse goes.
        self.drag(at, end)
        on, normal, offset = self.saved_clip()
        self.assertAlmostEqual(offset, 0.7, delta=0.03)
        self.assertEqual(normal, first)
        self.assertTrue(self.has_handle(self.rest(), away))
        self.press("ctrl+z")
        self.assertEqual(self.saved_clip()[2], 0.5)
        self.press("ctrl+shift+z")
        self.assertAlmostEqual(self.saved_clip()[2], offset, delta=1e-9)
        self.press("ctrl+z")
        # By half of the ring's radius to the right: half a radian about the view's upward axis.
        self.drag((at[0], at[1] - 46), (at[0] + 23, at[1] - 46))
        on, normal, offset = self.saved_clip()
        turned = ([math.cos(0.5) * r + math.sin(0.5) * a for r, a in zip(right, ahead)], up,
                  [math.cos(0.5) * a - math.sin(0.5) * r for r, a in zip(right, ahead)])
        for i, found in enumerate(normal):
            wanted = sum(first[axis] * before[axis] * after[i]
                         for before, after in zip((right, up, ahead), turned))
            self.assertAlmostEqual(found, wanted, delta=0.03)
        self.assertAlmostEqual(offset, 0.5, delta=0.02)  # about the handle
        self.press("ctrl+z")
        self.assertEqual(self.saved_clip(), (True, first, 0.5))
        # Facing the camera, a drag upwards pushes it away.
        self.find("faces the camera")
        self.press("Return")
        on, normal, offset = self.saved_clip()
        for found, wanted in zip(normal, ahead):
            self.assertAlmostEqual(found, -wanted, delta=1e-3)
        self.assertAlmostEqual(offset, 0.5, delta=0.02)
        self.drag(at, (at[0], at[1] - SIZE[1] // 8))
        self.assertAlmostEqual(self.saved_clip()[2], offset - 1 / 8, delta=0.02)
        self.find("turn the clip plane round")
        self.press("Return")
        on, normal, offset = self.saved_clip()
        self.assertAlmostEqual(normal[0], ahead[0], delta=1e-3)
        self.assertAlmostEqual(offset, 0.5 + 1 / 8, delta=0.02)
        # The handles go and come by the key; the cut stays.
        self.press("shift+p")
        self.until(lambda p: not self.has_handle(p, (middle[0], middle[1] - 46)), "no handles")
        self.assertEqual(self.saved_clip(), (True, normal, offset))
        self.find("remove the clip plane")
        self.press("Return")
        self.move(*end)
        part = (0, 60, SIZE[0], SIZE[1] - 64)  # between the captions
        self.until(lambda p: p.part(*part) == whole.part(*part), "the whole volume")
        self.assertFalse(self.saved_clip()[0])

    def test_start_window_opens_a_recent_scene_by_its_picture(self):
        self.start_own_scene()
        self.until_idle()
        self.leave()
        self.assertEqual(self.viewer.returncode, 0)
        self.viewer.communicate()
        pictures = os.path.join(self.place.name, "gazecast", "pictures")
        self.assertTrue(os.listdir(pictures))
        self.launch("--gaze", "mouse")
        self.move(SIZE[0] // 2, 5)
        empty = self.rest()
        top = next(y for y in range(30, 200) if self.is_picture(empty, y))
        self.click(60, top + 5)
        self.until(self.shows_something, "the recent scene")
        self.leave()
        self.assertEqual(self.viewer.returncode, 0)
        self.viewer.communicate()
        self.viewer = None

    def is_picture(self, picture, y):
        """Whether the small picture of the first recent file has blue shells in this row."""
        return any(b > r + 30 and b > 60 for r, g, b in (picture.at(x, y) for x in range(20, 90)))

    def press_last(self, key):
        """Press the key that ends the program."""
        self.tool("key", key)
        self.assertEqual(self.viewer.wait(timeout=PATIENCE_S), 0)
        self.viewer = None


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
