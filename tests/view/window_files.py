"""Opening and saving in gazeview's window: dialogs by keys, files dropped on it.

window_files.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS], with DROP_FILES naming the program
that drops files
"""

import glob
import os
import shutil
import unittest

from picture import read_png, run
from window_case import GAZEVIEW, LINE_HEIGHT, SCENE, SCENES, SIZE, WindowCase

DROP_FILES = os.environ["DROP_FILES"]
EDGE = 40


def ball(x, y, z):
    """A voxel of a ball, brighter inside."""
    middle = (EDGE - 1) / 2
    distance = ((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2) ** 0.5
    return max(0, min(255, int(255 * (1 - distance / (0.45 * EDGE)))))


BALL = bytes(ball(x, y, z) for z in range(EDGE) for y in range(EDGE) for x in range(EDGE))


class Files(WindowCase):
    def setUp(self):
        super().setUp()
        self.folder = os.path.join(self.place.name, self.id().rsplit("_test_", 1)[-1][-40:])
        os.makedirs(self.folder)

    def write(self, name, content):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as out:
            out.write(content if isinstance(content, bytes) else content.encode())
        return path

    def write_nrrd(self, name):
        return self.write(name, b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\n"
                          b"spacings: 1 1 1\nencoding: raw\n\n" % (EDGE, EDGE, EDGE) + BALL)

    def drop(self, *paths):
        done = run(DROP_FILES, self.window, *paths, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)

    def keys(self, key):
        """Press a key with the mouse on the window, which then has the keyboard."""
        self.move(SIZE[0] // 2, SIZE[1] // 2)
        self.tool("key", key)

    def until_there(self, path, is_good=lambda text: True):
        """The text of a file, once it is there and @is_good."""
        def good_text():
            if not os.path.exists(path):
                return None
            with open(path, encoding="utf-8") as file:
                text = file.read()
            return (text,) if is_good(text) else None

        return self.wait_for(good_text, path)[0]

    def below_line(self, picture, width=SIZE[0], height=SIZE[1]):
        """The part of a picture without captions and messages."""
        return picture.part(0, LINE_HEIGHT, width, height * 2 // 3)

    def headless(self, path, *more):
        """The same picture without a window."""
        out = os.path.join(self.folder, "headless.png")
        done = run(GAZEVIEW, "--headless", path, "--size", "%dx%d" % SIZE, "--out", out, *more,
                   env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.below_line(read_png(out))

    def dialog_there(self, picture):
        """Whether a blue title bar is in the upper half."""
        return 200 < sum(
            abs(r - 41) + abs(g - 74) + abs(b - 122) < 12
            for y in range(0, SIZE[1] // 2) for x in range(0, SIZE[0], 2)
            for r, g, b in [picture.at(x, y)]
        )

    def amber_letters(self, picture):
        pixels = (picture.at(x, y) for x in range(10, SIZE[0] - 10) for y in range(20, SIZE[1] - 20))
        return 100 < sum(r > 160 and 0.6 * r < g < 0.85 * r and b < 0.5 * r for r, g, b in pixels)

    def bright_in_the_middle(self, picture):
        width, height = SIZE
        middle = picture.at(width // 2, height // 2)
        edges = [picture.at(x, height // 2) for x in (8, width - 9)]
        return max(middle) > 120 and all(max(edge) < 60 for edge in edges)

    def enter_text(self, text):
        """Replace the text of a field."""
        self.tool("key", "ctrl+a")
        self.tool("type", "--delay", "20", text)
        self.until_idle()  # the field takes it before Enter counts

    def pressed_until(self, done):
        """Press Return unless @done. -> @done"""
        if not done:
            self.press("Return")
        return done

    def test_surface_shown_is_written_as_a_mesh_by_write_mesh(self):
        wanted, path = os.path.join(self.folder, "wanted.ply"), os.path.join(self.folder, "a.ply")
        done = run(GAZEVIEW, "--write-mesh", wanted, "--isovalue", "90", SCENE,
                   env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.start("--gaze", "0.5,0.5", "--method", "uniform", "--technique", "isosurface",
                   "--isovalue", "90")
        self.keys("ctrl+e")
        self.until(self.dialog_there, "the dialog")
        self.enter_text(path)
        self.until(lambda p: self.pressed_until(not self.dialog_there(p)), "no dialog")
        self.wait_for(lambda: os.path.exists(path), path)
        with open(path, "rb") as one, open(wanted, "rb") as other:
            self.assertTrue(one.read() == other.read(), "another mesh")
        self.viewer.terminate()
        self.assertRegex(self.messages(), r"a\.ply written, [1-9]\d* triangles")

    def test_dropped_volume_is_shown(self):
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.rest()
        self.drop(self.write_nrrd("a ball, 100%.nrrd"))
        self.until_changed(before, "the ball")
        self.until(self.bright_in_the_middle, "the ball in the middle")

    def test_of_several_dropped_files_one_is_opened_with_a_message(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.drop(self.write_nrrd("one.nrrd"), self.write_nrrd("two.nrrd"))
        self.until(self.bright_in_the_middle, "the ball in the middle")
        self.tool("key", "q")
        self.assertIn("2 files were dropped: opening %s only"
                      % os.path.join(self.folder, "one.nrrd"), self.messages())

    def test_dropped_transfer_function_colours_the_volume(self):
        self.start("--gaze", "mouse", "--method", "standard")
        self.drop(self.write("green.tf", "0 0 1 0 0\n0.2 0 1 0 0.2\n1 0 1 0 0.9\n"))

        def green(picture):
            r, g, b = picture.at(SIZE[0] // 2, SIZE[1] // 2)
            return g > 60 and g > 4 * r and g > 4 * b

        self.until(green, "green")

    def test_dropped_picture_brings_back_what_it_shows(self):
        self.start("--gaze", "mouse", "--method", "standard", "--pictures", self.folder)
        first = self.rest()
        self.move(240, 160)
        self.tool("mousedown", 1)
        self.move(320, 190)
        self.until_changed(first, "turned")
        self.tool("mouseup", 1)
        shown = self.below_line(self.rest())
        self.tool("key", "F12")
        self.wait_for(lambda: glob.glob(os.path.join(self.folder, "*.png")), "a picture's file")
        self.tool("key", "r")
        self.until(lambda p: self.below_line(p) == self.below_line(first), "as at first")
        (picture,) = glob.glob(os.path.join(self.folder, "*.png"))
        self.drop(picture)
        self.until(lambda p: self.below_line(p) == shown, "as in the picture")
        self.assertTrue(self.headless(picture) == shown, "another picture")

    def test_dropped_file_that_cannot_be_shown_is_a_message_and_the_picture_stays(self):
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.below_line(self.rest())
        self.drop(self.write("notes.txt", "milk, bread\n"))
        self.drop(self.write("half.nrrd", b"NRRD0004\ntype: uint8\ndimension: 3\n"
                             b"sizes: 9 9 9\nencoding: raw\n\nabc"))
        self.until_idle()  # both have been tried, the last one on a thread
        self.until(lambda p: True, "still there")
        self.tool("key", "q")
        said = self.messages()
        self.assertIn("notes.txt: neither a scene nor a volume", said)
        self.assertIn("half.nrrd: ", said)
        self.assertTrue(before)

    def test_volume_is_opened_by_the_beginning_of_its_name(self):
        shutil.copy(SCENE, os.path.join(self.folder, "a.scene"))
        self.write_nrrd("ball.nrrd")
        self.start("--gaze", "mouse", "--method", "standard",
                   scene=os.path.join(self.folder, "a.scene"))
        self.keys("ctrl+o")
        self.until(self.dialog_there, "the dialog")
        self.enter_text("bal")
        self.press("Return")
        self.until(self.bright_in_the_middle, "the ball in the middle")
        recent = os.path.join(self.place.name, "gazecast", "recent")
        self.until_there(recent, lambda text: text.splitlines()[0].endswith("/ball.nrrd"))

    def test_escape_closes_the_dialog_but_not_the_window(self):
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.below_line(self.rest())
        self.keys("ctrl+o")
        self.until(self.dialog_there, "the dialog")
        self.press("Escape")
        self.until(lambda p: self.below_line(p) == before, "as before")

    def test_saved_scene_gives_the_same_picture_without_a_window(self):
        self.start("--gaze", "mouse", "--method", "standard")
        before = self.rest()
        self.move(240, 160)
        self.tool("mousedown", 1)
        self.move(300, 190)
        self.until_changed(before, "turned")
        self.tool("mouseup", 1)
        shown = self.below_line(self.rest())
        path = os.path.join(self.folder, "deep", "saved.scene")
        os.makedirs(os.path.dirname(path))
        self.keys("ctrl+shift+s")
        self.until(self.dialog_there, "the dialog")
        self.enter_text(path)
        self.press("Return")
        text = self.until_there(path)
        self.assertIn("eye = ", text)
        self.assertTrue(self.headless(path) == shown, "another picture")

    def test_saving_over_another_scene_is_asked_and_keeps_its_comments(self):
        other = "; mine\n[volume]\nprocedural = supernova ; big\n[camera]\nfov_deg = 33 ; narrow\n"
        path = self.write("other.scene", other)
        self.start("--gaze", "mouse", "--method", "standard")
        self.keys("ctrl+shift+s")
        self.until(self.dialog_there, "the dialog")
        self.enter_text(path)
        dialog = self.below_line(self.rest())
        self.until(lambda p: self.pressed_until(self.below_line(p) != dialog), "a question")
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), other)
        self.until(lambda p: self.pressed_until(not self.dialog_there(p)), "saved")
        text = self.until_there(path, lambda text: text != other)
        self.assertTrue(text.startswith("; mine\n"), text)
        self.assertIn("procedural = shells ; big", text)
        self.assertIn(" ; narrow", text)

    def test_scene_is_saved_in_its_place_by_one_key(self):
        path = os.path.join(self.folder, "own.scene")
        shutil.copy(SCENE, path)
        self.start("--gaze", "mouse", "--method", "mdc", scene=path)
        self.keys("ctrl+s")
        self.until_there(path, lambda text: "method = mdc" in text)

    def test_options_for_one_run_are_saved_only_if_the_window_changes_them(self):
        path = os.path.join(self.folder, "own.scene")
        shutil.copy(SCENE, path)
        with open(path, "a", encoding="utf-8") as scene:
            scene.write("[view]\ngaze = 0.25,0.5\n")
        self.start("--gaze", "mouse", "--cross", "--letters", "--method", "mdc",
                   "--pictures", self.folder, scene=path)
        self.move(150, 200)
        self.until(lambda p: self.cross_at(p, 150, 200), "the cross at the mouse")
        self.tool("key", "ctrl+F12")
        picture = self.wait_for(lambda: glob.glob(os.path.join(self.folder, "gazeview-*.png")),
                                "a picture")[0]
        self.keys("ctrl+s")
        text = self.until_there(path, lambda text: "method = mdc" in text)
        self.assertIn("gaze = 0.25,0.5", text)
        self.assertNotIn("gaze_cursor", text)
        self.assertNotIn("letters", text)
        # The run goes on as it was asked for.
        self.move(330, 120)
        self.until(lambda p: self.cross_at(p, 330, 120), "the cross at the mouse")
        for key in ("m", "c", "ctrl+s"):
            self.keys(key)
        text = self.until_there(path, lambda text: "gaze = 0.25,0.5" not in text)
        self.assertIn("gaze = ", text)
        self.assertNotIn("gaze = mouse", text)
        self.assertNotIn("gaze_cursor", text)
        self.stop()
        # The scene in a picture does not have them either.
        self.start("--method", "ddc", scene=picture)
        self.keys("ctrl+s")
        self.until(self.dialog_there, "the dialog")
        self.press("Return")
        text = self.until_there(os.path.splitext(picture)[0] + ".scene",
                                lambda text: "method = ddc" in text)
        self.assertIn("gaze = 0.25,0.5", text)
        self.assertNotIn("gaze_cursor", text)

    def test_layout_of_a_raw_volume_is_asked_for_and_confirmed(self):
        path = self.write("mystery.raw", BALL)
        self.launch(path, "--gaze", "mouse", "--method", "standard")
        self.until(self.dialog_there, "the dialog")
        self.press("Return")
        self.until(self.bright_in_the_middle, "the ball in the middle")

    def test_raw_volume_that_is_cut_short_is_said_to_be(self):
        path = self.write("cut_2048x2048x2048_uint8.raw", bytes(1000))
        self.launch(path, "--gaze", "mouse", "--method", "standard")
        self.until(lambda p: self.dialog_there(p) and self.amber_letters(p), "a warning in the dialog")

    def test_another_guess_is_chosen_by_arrows_and_short_presses(self):
        path = self.write("mystery.raw", BALL)
        self.launch(path, "--gaze", "mouse", "--method", "standard")
        self.until(self.dialog_there, "the dialog")
        for key in ("Down", "Up", "Down", "Up"):
            self.tool("key", key)
            self.until_idle()
        self.tool("key", "Return")
        self.until(lambda p: not self.dialog_there(p), "a picture")

    def test_raw_volume_with_its_layout_in_the_name_needs_no_question(self):
        path = self.write("ball_%dx%dx%d_1.0x1.0x1.0_uint8.raw" % (EDGE, EDGE, EDGE), BALL)
        self.launch(path, "--gaze", "mouse", "--method", "standard")
        self.until(self.bright_in_the_middle, "the ball in the middle")
        shown = self.below_line(self.rest())
        self.assertTrue(self.headless(path, "--method", "standard") == shown, "another picture")


if __name__ == "__main__":
    unittest.main(argv=["window_files"])
