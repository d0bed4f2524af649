"""Several DICOM series in one place: gazeview --list-series, and the choice of one by its UID.

dicom_series.py GAZEVIEW

pydicom makes the series. Exits 77 if it is not installed.
"""

import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

from dicom_made import AXIAL, CORONAL, EDGE, ROOT, Series, pydicom, write_medium
from picture import run
from raw_nrrd import read_nrrd

GAZEVIEW = sys.argv[1]


class SeveralSeries(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="gazecast-test-series-")
        self.addCleanup(place.cleanup)
        self.folder = place.name

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def list(self, path, *more):
        """The lines of a list without its head, and what was said."""
        done = subprocess.run([GAZEVIEW, "--list-series", path, *more], capture_output=True,
                              encoding="utf-8", timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        head, *lines = done.stdout.splitlines()
        self.assertEqual(head.split()[:5], ["#", "UID", "slices", "modality", "date"])
        return lines, done.stderr

    def refused(self, words, *arguments):
        done = run(GAZEVIEW, *arguments)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(words, done.stderr)
        self.assertEqual(done.stdout, "")

    def load(self, path, *more):
        """Voxels of the volume that is read."""
        out = self.path("out.nrrd")
        done = run(GAZEVIEW, path, "--write-volume", out, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return read_nrrd(out)[0]

    def test_series_are_listed_with_what_people_know_them_by(self):
        first, second = Series(1), Series(2, slices=7)
        second.patient, second.description, second.modality = "Roe^Richard", "head", "MR"
        second.write(self.path("b"))
        first.write(self.path("a"))
        lines, said = self.list(self.folder)
        self.assertEqual(said, "")
        self.assertEqual([line.split()[:5] for line in lines],
                         [["1", first.uid, "4", "CT", "2024-03-31"],
                          ["2", second.uid, "7", "MR", "2024-03-31"]])
        self.assertTrue(lines[0].endswith("  Doe Jane, series 1"), lines[0])
        self.assertTrue(lines[1].endswith("  Roe Richard, head"), lines[1])

    def test_single_series_is_listed_too(self):
        Series(3).write(self.folder)
        lines, _ = self.list(self.folder)
        self.assertEqual(len(lines), 1)
        self.assertIn(f"{ROOT}.3", lines[0])

    def test_series_that_cannot_be_shown_have_the_reason(self):
        sizes, crossed, fine = Series(1), Series(2), Series(3)
        sizes.edges = [EDGE, EDGE // 2]
        crossed.orientations = [AXIAL, CORONAL]
        crossed.slices = 2
        gap = Series(4, slices=6)
        for series in (sizes, crossed, fine):
            series.write(self.folder)
        os.remove(gap.write(self.folder)[1])
        lines, _ = self.list(self.folder)
        reasons = [line.partition(" -- cannot be shown: ")[2] for line in lines]
        self.assertEqual(reasons[2], "")
        # Without the path of the file.
        for reason in (reasons[0], reasons[1], reasons[3]):
            self.assertTrue(reason and not reason.startswith("/"), reasons)

    def test_series_that_cannot_be_decoded_has_the_reason(self):
        fine, broken = Series(1), Series(2)
        fine.write(self.folder)
        for path in broken.write(self.folder):
            done = run("dcmcrle", path, path)
            if done.returncode != 0:
                self.skipTest("dcmcrle is not installed")
            with open(path, "r+b") as file:
                data = file.read()
                start = data.index(b"\xe0\x7f\x10\x00OB") + 12
                (table,) = struct.unpack("<I", data[start + 4 : start + 8])
                file.seek(start + 8 + table + 8)  # the head of the frame in its fragment
                file.write(bytes(64))
        lines, _ = self.list(self.folder)
        self.assertNotIn("cannot be shown", lines[0])
        self.assertIn("cannot be shown: its pixels", lines[1])

    def test_names_are_read_in_their_character_sets(self):
        cases = [
            (None, "Plain^Name", "Plain Name"),
            ("ISO_IR 100", "Buc^Jérôme", "Buc Jérôme"),
            ("ISO_IR 101", "Wałęsa^Lech", "Wałęsa Lech"),
            ("ISO_IR 144", "Люкceмбypг", "Люкceмбypг"),
            ("ISO_IR 126", "Διονυσιος", "Διονυσιος"),
            ("ISO_IR 192", "王^小东", "王 小东"),
            ("GB18030", "王^小东", "王 小东"),
            (["", "ISO 2022 IR 87"], "Yamada^Tarou=山田^太郎", "Yamada Tarou"),
            (["", "ISO 2022 IR 149"], "Hong^Gildong=洪^吉洞", "Hong Gildong"),
        ]
        for number, (charset, name, _) in enumerate(cases, 1):
            series = Series(number, slices=1)
            series.charset, series.patient = charset, name
            series.description = name
            series.write(self.folder)
        lines, _ = self.list(self.folder)
        self.assertEqual(len(lines), len(cases))
        for number, (charset, name, shown) in enumerate(cases, 1):
            (line,) = [line for line in lines if line.split()[1] == f"{ROOT}.{number}"]
            self.assertTrue(line.endswith(f"  {shown}, {name}"), f"{charset}: {line}")

    def test_bytes_that_are_no_text_do_no_harm(self):
        series = Series(1, slices=1)
        series.description = "bell \x07 and \x1b[31m red"
        (path,) = series.write(self.folder)
        with open(path, "rb") as file:
            data = file.read()
        with open(path, "wb") as file:
            file.write(data.replace(b"Doe^Jane", b"Do\xe2\x82\xff\xfene"))
        lines, _ = self.list(self.folder)
        self.assertTrue(lines[0].endswith("  Do????ne, bell ? and ?[31m red"), lines[0])

    def test_uid_of_the_list_chooses_a_series(self):
        for number in (1, 2):
            Series(number, slices=number + 2).write(self.folder)
        for line in self.list(self.folder)[0]:
            _, uid, slices = line.split()[:3]
            voxels = self.load(self.folder, "--volume.series", uid)
            self.assertEqual(voxels.shape[2], int(slices))
        self.refused("gazeview --list-series lists them", "--headless", self.folder)

    def test_directory_means_the_files_of_its_records(self):
        path = write_medium(self.path("medium"), Series(1), Series(2, slices=6))
        Series(5).write(self.path("medium", "OTHER"))
        lines, said = self.list(path)
        self.assertEqual([line.split()[1] for line in lines], [f"{ROOT}.1", f"{ROOT}.2"])
        self.assertEqual(said, "")
        voxels = self.load(path, "--volume.series", f"{ROOT}.2")
        self.assertEqual(voxels.shape[2], 6)
        self.refused("no series", "--headless", path, "--volume.series", f"{ROOT}.5")

    def test_directory_with_missing_files_names_one(self):
        path = write_medium(self.path("medium"), Series(1), Series(2))
        (gone,) = [os.path.join(at, names[0]) for at, _, names in os.walk(self.path("medium"))
                   if names and at.endswith("SE000001")]
        os.remove(gone)
        lines, said = self.list(path)
        self.assertEqual(len(lines), 2)
        self.assertIn("missing: 1, such as " + gone, said)

    def test_names_of_a_directory_may_have_small_letters(self):
        path = write_medium(self.path("medium"), Series(1))
        for at, folders, names in os.walk(self.path("medium"), topdown=False):
            for name in folders + [name for name in names if name != "DICOMDIR"]:
                os.rename(os.path.join(at, name), os.path.join(at, name.lower()))
        lines, said = self.list(path)
        self.assertEqual((len(lines), said), (1, ""))

    def test_damaged_directory_stands_for_its_folder(self):
        path = write_medium(self.path("medium"), Series(1))
        Series(5).write(self.path("medium", "OTHER"))
        with open(path, "rb") as file:
            data = file.read()
        for damage in (data[: len(data) // 3], b"", b"no DICOM\n", data[:132]):
            with open(path, "wb") as file:
                file.write(damage)
            lines, said = self.list(path)
            self.assertEqual([line.split()[1] for line in lines], [f"{ROOT}.1", f"{ROOT}.5"])
            self.assertIn("its records cannot be read", said)

    def test_directory_cannot_lead_out_of_its_folder(self):
        Series(7).write(self.path("secret"))
        path = write_medium(self.path("medium"), Series(1))
        with open(path, "rb") as file:
            data = file.read()
        name = rb"PT000000\ST000000\SE000000\IM000000"
        for other in (rb"..\secret\7-00.dcm", b"../secret/7-00.dcm", rb"PT000000\..\..\secret"):
            with open(path, "wb") as file:
                file.write(data.replace(name, other.ljust(len(name))))
            lines, said = self.list(path)
            self.assertEqual([line.split()[1] for line in lines], [f"{ROOT}.1"])
            self.assertIn("missing: 1", said)

    def test_copies_are_no_time_points(self):
        folder = self.path("twice")
        files = Series(1).write(folder)
        wanted = self.load(folder)
        for path in files:
            shutil.copy(path, path + " (copy).dcm")
        done = run(GAZEVIEW, folder, "--write-volume", self.path("out.nrrd"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"{len(files)} files are copies of others", done.stderr)
        self.assertNotIn("time points", done.stderr)
        self.assertTrue((read_nrrd(self.path("out.nrrd"))[0] == wanted).all())

    def test_links_to_folders_are_followed_once(self):
        Series(1).write(self.path("folder", "real", "deep"))
        os.symlink("real", self.path("folder", "link"))
        os.symlink("..", self.path("folder", "real", "back"))
        lines, said = self.list(self.path("folder"))
        self.assertEqual((len(lines), lines[0].split()[2], said), (1, "4", ""))

    def test_meta_header_without_a_preamble_is_recognised(self):
        path = Series(1, slices=1).write(self.path("one"))[0]
        with open(path, "rb") as file:
            data = file.read()
        os.remove(path)
        with open(self.path("one", "slice"), "wb") as file:
            file.write(data[132:])
        for at in (self.path("one"), self.path("one", "slice")):
            self.assertEqual(self.load(at).shape, (EDGE, EDGE, 1))

    def test_named_file_has_the_reason(self):
        path = Series(1, slices=1).write(self.path("one"))[0]
        with open(path, "rb") as file:
            data = file.read()
        cut = self.path("one", "cut.dcm")
        with open(cut, "wb") as file:
            file.write(data[:-1])
        self.refused("damaged or cut off; fetch it again", cut, "--write-volume",
                     self.path("none.nrrd"))
        image = pydicom.dcmread(path)
        pixels = image.pixel_array.astype("<f4").tobytes()
        del image.PixelData
        image.FloatPixelData, image.BitsAllocated = pixels, 32
        image.save_as(path)
        self.refused("its pixels are floating-point numbers", path, "--write-volume",
                     self.path("none.nrrd"))

    @unittest.skipIf(os.geteuid() == 0 and not shutil.which("setpriv"), "nobody else can be asked")
    def test_file_that_cannot_be_read_has_the_reason(self):
        os.chmod(self.folder, 0o777)
        folder = self.path("closed")
        files = Series(1, slices=5).write(folder)
        os.chmod(files[2], 0)
        as_nobody = ["setpriv", "--reuid=65534", "--clear-groups"] if os.geteuid() == 0 else []
        # As under /root: setpriv may start the program there, but it does not find its decoder.
        if subprocess.run([*as_nobody, "test", "-x", GAZEVIEW], check=False).returncode != 0:
            self.skipTest("nobody else may run it here")
        for path in (files[2], folder):
            done = subprocess.run([*as_nobody, GAZEVIEW, path, "--write-volume",
                                   self.path("none.nrrd")], capture_output=True, encoding="utf-8",
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(f"{files[2]}: cannot be read: Permission denied", done.stderr)

    def test_what_holds_no_series_is_refused(self):
        text = self.path("text.txt")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no volume\n")
        os.mkdir(self.path("empty"))
        self.refused("not DICOM", "--list-series", text)
        self.refused("no DICOM image", "--list-series", self.path("empty"))
        self.refused("cannot open it", "--list-series", self.path("nowhere"))
        self.refused("no scene", "--list-series")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
