"""What gazeview's window shows of its picture and how the camera is moved: the tint by the plan, the
standard picture beside it, the difference, frame times, axis views, saved views.

window_picture.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS]
"""

import re
import sys
import unittest

from picture import PATIENCE_S, run, write_labels
from window_case import CORNER_HEIGHT, GAZEVIEW, LINE_HEIGHT, PLACE, SCENE, SIZE, WindowCase

WIDTH, HEIGHT = SIZE
MIDDLE = WIDTH // 2
# Between the texts at the top and at the bottom, the divider's labels included.
TOP, BOTTOM = LINE_HEIGHT, HEIGHT - CORNER_HEIGHT - 40
STILL = ("--gaze", "0.5,0.5", "--backend", "cpu")
# Coarse enough outside the fovea to be seen in a small window.
COARSE = (*STILL, "--method", "acuity", "--foveation.acuity_slope", "0.1")


class PictureWindow(WindowCase):
    def start(self, *more, **options):
        super().start(*more, **options)
        self.move(WIDTH - 5, LINE_HEIGHT + 20)  # the window with the mouse has the keyboard

    def part(self, picture, left, right, top=TOP, bottom=BOTTOM):
        return picture.part(left, top, right, bottom)

    def tint(self, before, after, x, y):
        """The tint's colour: what is left when the picture's share is removed."""
        share = 0.36
        return tuple((b - (1 - share) * a) / share
                     for a, b in zip(before.at(x, y), after.at(x, y)))

    def test_overlay_is_dark_at_the_gaze_and_lighter_away_and_has_a_scale(self):
        self.start("--gaze", "0.25,0.5", "--method", "acuity", "--backend", "cpu")
        before = self.rest()
        self.tool("key", "i")
        after = self.until(lambda p: self.part(p, 300, WIDTH) != self.part(before, 300, WIDTH),
                           "spacing")
        at_gaze = self.tint(before, after, WIDTH // 4, HEIGHT // 2)
        for got, wanted in zip(at_gaze, (68, 1, 84)):
            self.assertLess(abs(got - wanted), 8, "at the gaze: %r" % (at_gaze,))
        away = self.tint(before, after, WIDTH - 10, HEIGHT // 2)
        self.assertGreater(away[1], at_gaze[1] + 30, "away: %r" % (away,))
        legend = (8, LINE_HEIGHT, 250, LINE_HEIGHT + 45)
        colours = {after.at(x, LINE_HEIGHT + 30) for x in range(16, 240)}
        self.assertGreater(len(colours), 50, "no scale of colours")
        self.tool("key", "i")
        step = self.until(lambda p: p.part(*legend) != after.part(*legend), "step")
        self.assertNotEqual(self.part(step, 300, WIDTH), self.part(before, 300, WIDTH))
        self.tool("key", "i")
        self.until(lambda p: self.part(p, 4, WIDTH) == self.part(before, 4, WIDTH), "no tint")

    def test_regions_are_tinted_too(self):
        self.start("--gaze", "0.25,0.5", "--method", "mdc", "--foveation.mdc_square_px", "80",
                   "--backend", "cpu")
        before = self.rest()
        self.tool("key", "i")
        after = self.until(lambda p: self.part(p, 300, WIDTH) != self.part(before, 300, WIDTH),
                           "spacing")
        inside = self.tint(before, after, WIDTH // 4, HEIGHT // 2)
        outside = self.tint(before, after, WIDTH // 4 + 60, HEIGHT // 2)
        self.assertGreater(outside[1], inside[1] + 30, "%r %r" % (inside, outside))

    def test_split_halves_agree_in_the_fovea_and_the_divider_is_dragged(self):
        self.start(*COARSE)
        foveated = self.rest()
        self.tool("key", "1")
        standard = self.until(
            lambda p: self.part(p, 4, WIDTH) != self.part(foveated, 4, WIDTH), "standard")
        self.tool("key", "4")
        self.until(lambda p: self.part(p, 4, WIDTH) == self.part(foveated, 4, WIDTH), "acuity")
        self.tool("key", "v")
        left, right = (4, MIDDLE - 3), (MIDDLE + 3, WIDTH)
        split = self.until(
            lambda p: self.part(p, *right) == self.part(standard, *right) and
            self.part(p, *left) == self.part(foveated, *left), "split")
        self.assertNotEqual(self.part(standard, *right), self.part(foveated, *right))
        fovea = (MIDDLE - 12, MIDDLE - 3, HEIGHT // 2 - 12, HEIGHT // 2 + 12)
        self.assertEqual(self.part(split, *fovea), self.part(standard, *fovea))
        # The mouse does not turn the camera there; the gaze stays.
        self.move(MIDDLE, 100)
        self.tool("mousedown", 1)
        self.move(MIDDLE + 40, 110)
        self.move(MIDDLE + 120, 100)
        self.tool("mouseup", 1)
        self.until(lambda p: self.part(p, 4, MIDDLE + 117) == self.part(foveated, 4, MIDDLE + 117)
                   and self.part(p, MIDDLE + 123, WIDTH) == self.part(standard, MIDDLE + 123, WIDTH),
                   "divider dragged")
        for _ in range(40):
            self.tool("key", "ctrl+Left")
        self.until(lambda p: self.part(p, 8, WIDTH) == self.part(standard, 8, WIDTH),
                   "divider at the left")
        self.tool("key", "v")
        self.tool("key", "v")
        self.until(lambda p: self.part(p, 4, WIDTH) == self.part(foveated, 4, WIDTH), "alone again")

    def test_standard_picture_follows_the_camera(self):
        self.start(*STILL, "--method", "standard", "--view.compare", "split")
        first = self.rest()
        self.tool("key", "Left")
        self.tool("key", "Up")
        both = self.until(lambda p: self.part(p, 4, 230) != self.part(first, 4, 230), "turned")
        # With method standard both halves are the same picture.
        self.tool("key", "v")
        self.tool("key", "v")
        alone = self.until(lambda p: self.part(p, 230, 250) != self.part(both, 230, 250), "alone")
        self.tool("key", "v")
        self.until(lambda p: self.part(p, MIDDLE + 3, WIDTH) == self.part(alone, MIDDLE + 3, WIDTH)
                   and self.part(p, 230, 250) != self.part(alone, 230, 250), "split again")

    def test_difference_is_black_in_the_fovea_and_grows_by_key(self):
        self.start(*COARSE)
        self.tool("key", "v", "v")
        fovea = (MIDDLE - 12, MIDDLE + 12, HEIGHT // 2 - 12, HEIGHT // 2 + 12)

        def shown(picture):
            fine = self.part(picture, *fovea)
            return fine == bytes(len(fine)) and any(self.part(picture, 4, WIDTH))

        before = self.until(shown, "difference")
        darker = sum(self.part(before, 4, WIDTH))
        self.tool("key", "ctrl+Up")
        self.until(lambda p: shown(p) and sum(self.part(p, 4, WIDTH)) > 1.3 * darker, "brighter")
        self.tool("key", "ctrl+Down")
        self.until(lambda p: sum(self.part(p, 4, WIDTH)) == darker, "as before")

    def test_every_technique_is_compared_by_what_draws_it(self):
        surface = ("--technique", "isosurface", "--isovalue", "0.5", "--isosurface.shadows")
        for how in (("--technique", "slices", "--slices.count", "24", "--backend", "gl"),
                    (*surface, "--backend", "gl"), (*surface, "--backend", "cpu")):
            self.start("--gaze", "0.5,0.5", "--foveation.acuity_slope", "0.1", *how,
                       "--view.compare", "difference")
            fovea = (MIDDLE - 12, MIDDLE + 12, HEIGHT // 2 - 12, HEIGHT // 2 + 12)

            def is_difference(picture):
                fine = self.part(picture, *fovea)
                return fine == bytes(len(fine)) and any(self.part(picture, 100, WIDTH - 100))

            self.until(is_difference, "difference " + " ".join(how))
            self.tool("key", "v", "v")
            self.until(lambda p: any(self.part(p, *fovea)), "split")
            self.stop()

    def test_labels_are_listed_with_their_colours(self):
        scene = write_labels(PLACE.name, "[light]", "ambient = 0.3", "diffuse = 0.5",
                             "specular = 0")
        self.start("--gaze", "0.5,0.5", scene=scene)
        colour = (255, 0, 51)

        def listed(picture):
            return sum(picture.at(x, y) == colour for x in range(8, 90)
                       for y in range(LINE_HEIGHT, 160))

        self.assertEqual(listed(self.rest()), 0)
        self.tool("key", "a")
        self.until(lambda p: listed(p) > 80, "the list")
        self.tool("key", "Escape")
        self.until(lambda p: listed(p) == 0, "no list")

    def test_still_split_takes_no_processor_time(self):
        self.start(*STILL, "--method", "acuity", "--view.compare", "split")
        self.until_idle()
        self.assertLess(self.processor_share(), 0.03)

    def test_still_picture_gets_all_of_its_rays_and_then_rests(self):
        self.start(*STILL, "--method", "standard")
        standard = self.below_line(self.rest())
        self.stop()
        self.start(*COARSE, "--foveation.still_growth", "0.5")
        self.until(lambda p: self.below_line(p) == standard, "all rays")
        self.until_idle()
        self.assertLess(self.processor_share(), 0.03)
        self.tool("key", "x")
        self.until(lambda p: self.below_line(p) != standard, "another view")
        self.tool("key", "r")
        self.until(lambda p: self.below_line(p) == standard, "all rays of the first view")

    def test_axis_views_and_projection_change_the_picture_and_r_brings_it_back(self):
        self.start(*STILL, "--method", "standard")
        first = last = self.rest()
        pictures = [self.below_line(first)]
        for key in ("x", "shift+x", "y", "z", "shift+z", "o"):
            self.tool("key", key)
            last = self.until_changed(last, key)
            self.assertNotIn(self.below_line(last), pictures, key + " was seen before")
            pictures.append(self.below_line(last))
        self.tool("key", "r")
        self.until(lambda p: self.below_line(p) == pictures[0], "as at first")

    def test_keys_and_buttons_turn_move_roll_and_zoom(self):
        self.start(*STILL, "--method", "standard")
        self.move(MIDDLE, HEIGHT // 2)
        first = self.rest()
        for keys, back in ((("Left",), ("Right",)), (("shift+Up",), ("shift+Down",)),
                           (("plus",), ("minus",))):
            self.tool("key", *keys)
            self.until_changed(first, keys[0].replace("+", " "))
            self.tool("key", *back)
            self.tool("key", "r")
            self.until(lambda p: self.below_line(p) == self.below_line(first), "back by r")
        for button, key in ((2, None), (3, None), (1, "shift")):
            if key:
                self.tool("keydown", key)
            self.tool("mousedown", button)
            self.move(MIDDLE + 60, HEIGHT // 2 + 10)
            self.until_changed(first, "dragged by %d" % button)
            self.tool("mouseup", button)
            if key:
                self.tool("keyup", key)
            self.tool("key", "r")
            self.until(lambda p: self.below_line(p) == self.below_line(first), "back")
            self.move(MIDDLE, HEIGHT // 2)

    def test_ctrl_drag_moves_the_light_and_w_brings_it_back(self):
        self.start(*STILL, "--method", "standard", "--render.shading", "gradient")
        self.move(MIDDLE, HEIGHT // 2)
        first = self.rest()
        self.tool("keydown", "ctrl")
        self.tool("mousedown", 1)
        self.move(MIDDLE + 60, HEIGHT // 2 + 30)
        self.until(lambda p: self.lamps(p) > 40, "the lamp")
        self.tool("mouseup", 1)
        self.tool("keyup", "ctrl")
        moved = self.until(lambda p: self.lamps(p) == 0, "no lamp")
        self.assertNotEqual(self.below_line(moved), self.below_line(first))
        self.tool("key", "w")
        self.until(lambda p: self.below_line(p) == self.below_line(first), "back")

    def lamps(self, picture):
        """Pixels of the lamp that shows where the light is."""
        return sum(picture.at(x, y) == (255, 220, 90)
                   for x in range(MIDDLE - 80, MIDDLE + 80)
                   for y in range(HEIGHT // 2 - 80, HEIGHT // 2 + 80))

    def test_slices_are_drawn_by_opengl_unless_the_backend_is_named(self):
        self.start("--gaze", "0.5,0.5", "--method", "standard", "--technique", "slices",
                   "--slices.count", "16")
        self.viewer.terminate()
        self.assertNotIn("slices has no backend", self.viewer.communicate(timeout=PATIENCE_S)[1])
        self.viewer = None

    def test_saved_view_shows_the_same_picture_again(self):
        self.start(*STILL, "--method", "standard")
        first = self.rest()
        self.tool("key", "Left", "Left", "Up", "shift+Right", "plus")
        self.until_changed(first, "moved")
        moved = self.rest()
        self.tool("key", "shift+F3")
        self.tool("key", "y", "o")
        self.until_changed(moved, "elsewhere")
        self.tool("key", "F3")
        self.until(lambda p: self.part(p, 4, 230) == self.part(moved, 4, 230), "the saved view")

    def test_view_of_the_scene_is_shown_by_its_key(self):
        view = "eye 0 0 -2.5 look_at 0 0 0 up 0 1 0 height 1.25"
        self.start(*STILL, "--method", "standard", "--views.8", view)
        first = self.rest()
        self.tool("key", "F8")
        shown = self.until_changed(first, "view 8")
        self.stop()
        self.start(*STILL, "--method", "standard", "--camera.eye", "0 0 -2.5", "--camera.up",
                   "0 1 0", "--camera.projection", "orthographic", "--camera.height", "1.25")
        self.until(lambda p: self.below_line(p) == self.below_line(shown), "the same by keys")

    def test_malformed_view_is_refused_with_its_format(self):
        done = run(GAZEVIEW, SCENE, "--headless", "--size", "8x8", "--views.2", "from the left",
                   env=self.environment)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("views.2", done.stderr)
        self.assertIn("eye X Y Z", done.stderr)

    def test_frame_times_come_and_go(self):
        self.start(*STILL, "--method", "acuity")
        self.tool("windowsize", self.window, 800, 650)
        self.until(lambda p: p.at(795, 645) == p.at(795, 45), "larger")
        self.move(790, 640)
        before = self.rest()
        self.tool("key", "b")
        panel, beside = (10, 60, 380, 200), (420, 60, 790, 560)

        def has_column(picture):
            """The newest frame's column is at the plot's right edge, blue for casting."""
            return any(b > r + 60 and b > 150 for r, g, b in (
                picture.at(x, y) for x in range(360, 384) for y in range(60, 200)))

        shown = self.until(has_column, "frame times")
        self.assertEqual(shown.part(*beside), before.part(*beside))
        self.tool("key", "b")
        self.until(lambda p: p.part(*panel) == before.part(*panel), "none")

    def test_dragged_panel_leaves_the_whole_picture_behind(self):
        self.start(*STILL, "--method", "acuity")
        self.tool("windowsize", self.window, 800, 650)
        self.until(lambda p: p.at(795, 645) == p.at(795, 45), "larger")
        self.move(790, 640)
        before = self.rest()
        self.tool("key", "b")
        old, new = (10, 60, 360, 200), (400, 110, 700, 240)
        self.until(lambda p: p.part(*old) != before.part(*old), "frame times")
        self.until_idle()
        self.drag((150, 50), (550, 100))
        self.move(790, 640)
        moved = self.rest()
        self.assertEqual(moved.part(10, 110, 360, 600), before.part(10, 110, 360, 600))
        self.assertNotEqual(moved.part(*new), before.part(*new))
        self.tool("key", "b")
        self.until(lambda p: p.part(10, 60, 790, 560) == before.part(10, 60, 790, 560), "the picture")

    def extent(self, picture, width, height):
        """Width and height of the object in the middle, px."""
        ground = picture.at(width - 3, height // 2)
        across = [x for x in range(width) if picture.at(x, height // 2) != ground]
        down = [y for y in range(LINE_HEIGHT, height - CORNER_HEIGHT)
                if picture.at(width // 2, y) != ground]
        return (across[-1] - across[0] + 1, down[-1] - down[0] + 1) if across and down else (0, 0)

    def test_resized_window_keeps_the_shape_of_what_it_shows(self):
        self.start(*STILL, "--method", "standard", "--camera.eye", "0 -3.5 0", "--camera.look_at",
                   "0 0 0")
        wide, high = self.extent(self.grab(), WIDTH, HEIGHT)
        self.assertGreater(high, 50)
        for width, height in ((400, 600), (700, 400)):
            self.tool("windowsize", self.window, width, height)
            # Its height follows the window's, and its width its own height.
            scale = height / HEIGHT
            self.until(lambda p: all(abs(got - wanted * scale) <= 4 for got, wanted in zip(
                self.extent(p, width, height), (wide, high))), "%d x %d" % (width, height))

    def test_measure_window_prints_the_cost_of_the_window(self):
        done = run(GAZEVIEW, SCENE, "--size", "320x200", "--gaze", "0.5,0.5", "--measure-window",
                   "5", env=self.environment)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        number = r"(\d+\.\d\d)"
        told = re.fullmatch(r"320x200 bare %s ms window %s ms %s times with panels %s ms %s times "
                            r"frames 5\n" % ((number,) * 5), done.stdout)
        self.assertTrue(told, done.stdout)
        bare, window, times = (float(told.group(i)) for i in (1, 2, 3))
        self.assertGreater(bare, 0)
        # Each number is right to .005.
        self.assertAlmostEqual(window / bare, times, delta=0.006 * (1 + (1 + times) / bare))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
