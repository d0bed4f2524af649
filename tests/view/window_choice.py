"""The list of DICOM series in gazeview's window: one is chosen by mouse and by keyboard, or none.

window_choice.py GAZEVIEW GAZED SCENES-FOLDER [FOLDER-FOR-SCREENSHOTS], with DROP_FILES naming the
program that drops files
"""

import os
import sys
import unittest

from dicom_made import EDGE, ROOT, Series, write_medium
from picture import PATIENCE_S, read_png, run
from window_case import GAZEVIEW, LINE_HEIGHT, SIZE, WindowCase

DROP_FILES = os.environ["DROP_FILES"]
FIXED = ("--gaze", "0.5,0.5", "--method", "standard", "--backend", "cpu")


class Choice(WindowCase):
    def setUp(self):
        super().setUp()
        self.folder = os.path.join(self.place.name, self.id().rsplit("_test_", 1)[-1][-40:])
        first, second = Series(1, slices=24), Series(2, slices=9)
        mixed = Series(0)
        mixed.edges, mixed.description = [EDGE, EDGE // 2], "of several sizes"
        self.files = []
        for series in (first, second, mixed):
            self.files.append(series.write(self.folder))

    def below_line(self, picture, width=SIZE[0], height=SIZE[1]):
        """The part of a picture without captions and messages."""
        return picture.part(0, LINE_HEIGHT, width, height * 2 // 3)

    def drawn(self, number, path=None):
        """The picture of a series without a window."""
        out = self.folder + ".png"
        done = run(GAZEVIEW, "--headless", path or self.folder, "--volume.series",
                   f"{ROOT}.{number}", "--size", "%dx%d" % SIZE, "--out", out, *FIXED,
                   env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.below_line(read_png(out))

    def until_drawn(self, number, path=None):
        wanted = self.drawn(number, path)
        self.until(lambda p: self.below_line(p) == wanted, "series %d" % number)

    def title(self, picture):
        """The lowest row of the dialog's blue title bar; None: there is none."""
        for y in range(SIZE[1] // 2, 0, -1):
            blue = sum(abs(r - 41) + abs(g - 74) + abs(b - 122) < 12
                       for r, g, b in (picture.at(x, y) for x in range(0, SIZE[0], 2)))
            if blue > SIZE[0] // 4:
                return y
        return None

    def row_middle(self, picture, row):
        """Where a row of the list is: below the title and the path."""
        return SIZE[0] // 2, self.title(picture) + 55 + 60 * row

    def is_blue(self, r, g, b):
        return b > 60 and b > r + 30 and b > g + 15

    def has_pictures(self, picture):
        """Whether there are at least two bright areas at the left, larger than letters."""
        bright = [y for y in range(40, SIZE[1] - 20) if all(
            min(picture.at(x, y)) > 120 for x in range(65, 73))]
        return self.title(picture) is not None and bright and bright[-1] - bright[0] > 50

    def launch_list(self, path=None):
        self.launch(path or self.folder, *FIXED)
        self.until(self.has_pictures, "the list with pictures")
        self.until_idle()

    def drop(self, path):
        done = run(DROP_FILES, self.window, path, env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)

    def quit(self):
        self.move(SIZE[0] // 2, SIZE[1] // 2)
        self.tool("key", "q")
        status = self.viewer.wait(timeout=PATIENCE_S)
        return status, self.messages()

    def test_return_takes_the_first_that_can_be_shown(self):
        self.launch_list()
        self.press("Return")
        self.until_drawn(1)
        status, said = self.quit()
        self.assertEqual(status, 0)
        self.assertNotIn("error", said)

    def test_arrows_choose_another(self):
        self.launch_list()
        # The first row is passed over.
        for key in ("Down", "Down", "Up", "Down"):
            self.press(key)
        self.press("Return")
        self.until_drawn(2)

    def test_click_chooses_another(self):
        self.launch_list()
        self.move(*self.row_middle(self.grab(), 2))
        self.until_idle()
        self.tool("click", 1)
        self.until_drawn(2)

    def test_click_on_one_that_cannot_be_shown_does_nothing(self):
        self.launch_list()
        before = self.grab()
        self.move(*self.row_middle(before, 0))
        self.until_idle()
        self.tool("click", 1)
        self.until_idle()
        self.assertIsNotNone(self.title(self.grab()))
        self.move(5, 5)
        self.press("Escape")
        self.until(lambda p: self.title(p) is None, "no list")

    def test_escape_leaves_an_empty_window(self):
        self.launch_list()
        self.press("Escape")
        self.until(lambda p: self.title(p) is None, "no list")
        self.assertEqual(self.quit(), (0, ""))

    def test_escape_goes_back_to_what_was_shown(self):
        self.start(*FIXED)
        before = self.below_line(self.rest())
        self.drop(self.folder)
        self.until(self.has_pictures, "the list with pictures")
        self.press("Escape")
        self.until(lambda p: self.below_line(p) == before, "as before")

    def test_missing_slice_is_refused_and_resampled_by_a_key(self):
        for path in self.files[1] + self.files[2] + self.files[0][9:10]:
            os.remove(path)
        self.start(*FIXED)
        before = self.rest()
        self.drop(self.folder)
        refused = self.until(self.says_error, "the refusal")
        self.until(lambda p: self.below_line(p) == self.below_line(before), "as before")
        self.press("ctrl+shift+o")
        self.until(lambda p: self.below_line(p) != self.below_line(refused), "the series")
        status, said = self.quit()
        self.assertEqual(status, 0)
        self.assertIn("open it with --resample", said)
        self.assertIn("resampled (linear) from 23 slices to 24", said)

    def test_dropped_folder_is_shown_and_becomes_a_recent_file(self):
        # Volumes that are dropped keep the settings of the scene before.
        before = self.start(*FIXED)
        self.drop(self.files[0][0])
        self.until_changed(before, "series 1")
        first = self.rest()
        self.drop(self.files[1][0])
        self.until_changed(first, "series 2")
        self.drop(self.folder)
        self.until(self.has_pictures, "the list with pictures")
        self.press("Return")
        wanted = self.below_line(first)
        self.until(lambda p: self.below_line(p) == wanted, "series 1 again")
        recent = os.path.join(self.place.name, "gazecast", "recent")

        def names_folder():
            if not os.path.exists(recent):
                return False
            with open(recent, encoding="utf-8") as file:
                return file.readline().rstrip("\n") == self.folder

        self.wait_for(names_folder, "a recent file")

    def test_folder_is_opened_by_the_dialog(self):
        self.start(*FIXED)
        before = self.below_line(self.rest())
        self.move(SIZE[0] // 2, SIZE[1] // 2)
        self.tool("key", "ctrl+o")
        self.until(self.title, "the dialog")
        self.until_idle()
        self.tool("type", "--delay", "20", self.folder)
        self.until_idle()
        self.press("Return")  # goes into the folder
        dialog = self.rest()
        buttons = [y for y in range(SIZE[1]) if self.is_blue(*dialog.at(83, y))]
        self.move(100, buttons[-1] - 3)  # the second button of the lowest line
        self.until_idle()
        self.tool("click", 1)
        self.until(self.has_pictures, "the list with pictures")
        self.press("Return")
        self.until(lambda p: self.title(p) is None and self.below_line(p) != before, "a series")

    def test_directory_offers_its_own_series(self):
        path = write_medium(os.path.join(self.folder, "medium"), Series(3, slices=9),
                            Series(4, slices=12))
        self.launch_list(path)
        self.press("Return")
        self.until_drawn(3, path)

    def test_dropped_file_takes_the_place_of_the_list(self):
        self.launch_list()
        self.drop(self.files[1][0])
        self.until_drawn(2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
