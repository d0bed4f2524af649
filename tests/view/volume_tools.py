"""NRRD and MetaImage as gazeview reads them, compared with the programs that define them.

volume_tools.py GAZEVIEW

Teem's unu converts NRRD of every encoding, and of several files, to raw. plastimatch reads MetaImage
with ITK and writes NRRD with ITK's directions. gazeview must read the same volume from both. Exits
77 if one of the two programs is not installed.
"""

import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

from picture import run, skip

GAZEVIEW = sys.argv[1]
UNU = shutil.which("teem-unu") or shutil.which("unu")
PLASTIMATCH = shutil.which("plastimatch")
if not UNU:
    skip("no unu; it is in the package teem-apps")
if not PLASTIMATCH:
    skip("no plastimatch; it is in the package of that name")

SIZES = (5, 4, 3)
COUNT = SIZES[0] * SIZES[1] * SIZES[2]
BYTES = bytes((37 * i) % 251 for i in range(COUNT))
WORDS = struct.pack(f"<{COUNT}h", *((911 * i) % 5000 - 2500 for i in range(COUNT)))
FLOATS = struct.pack(f"<{COUNT}f", *(0.37 * i - 5 for i in range(COUNT)))
TYPES = {"uchar": BYTES, "short": WORDS, "float": FLOATS}
HEAD = (
    "NRRD0005\ntype: {type}\ndimension: 3\nspace: LPS\nsizes: 5 4 3\n"
    "space directions: (0,2,0) (0,0,-3) (1.5,0,0)\nendian: little\n"
)


class VolumeTools(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-tools-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def write(self, name, text, data=b""):
        with open(self.path(name), "wb") as out:
            out.write(text.encode() + data)

    def call(self, *words):
        done = subprocess.run(words, cwd=self.place.name, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def read(self, name, *more):
        """The whole volume as gazeview writes it: header and voxels."""
        done = run(GAZEVIEW, self.path(name), "--write-volume", self.path("read.nrrd"), *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("read.nrrd"), "rb") as source:
            return source.read()

    def test_nrrd_of_every_encoding_of_teem(self):
        for kind, data in TYPES.items():
            self.write("own.nrrd", HEAD.format(type=kind) + "encoding: raw\n\n", data)
            wanted = self.read("own.nrrd")
            for encoding in ("raw", "ascii", "hex", "gzip", "bzip2"):
                for name in ("teem.nrrd", "teem.nhdr"):
                    with self.subTest(kind=kind, encoding=encoding, name=name):
                        self.call(UNU, "save", "-f", "nrrd", "-e", encoding, "-i", "own.nrrd", "-o", name)
                        self.assertEqual(self.read(name), wanted)

    def test_nrrd_of_colours_is_what_teem_makes_of_it(self):
        for count, kind in ((3, "RGB-color"), (4, "RGBA-color")):
            head = f"NRRD0005\ntype: uchar\ndimension: 4\nsizes: {count} 5 4 3\nspacings: nan 2 3 1.5\n"
            data = bytes((41 * i) % 253 for i in range(COUNT * count))
            self.write("own.nrrd", head + f"kinds: {kind} domain domain domain\nencoding: raw\n\n", data)
            wanted = self.read("own.nrrd")
            self.assertIn(f"kinds: {kind} domain".encode(), wanted)
            # Teem splits them into channels and joins these again.
            for channel in range(count):
                self.call(UNU, "slice", "-a", "0", "-p", str(channel), "-i", "own.nrrd", "-o", f"{channel}.nrrd")
            parts = [f"{channel}.nrrd" for channel in range(count)]
            self.call(UNU, "join", "-a", "0", "-incr", "-i", *parts, "-o", "joined.nrrd")
            self.call(UNU, "axinfo", "-a", "0", "-k", kind, "-i", "joined.nrrd", "-o", "teem.nrrd")
            for encoding in ("raw", "ascii", "hex", "gzip"):
                with self.subTest(count=count, encoding=encoding):
                    self.call(UNU, "save", "-f", "nrrd", "-e", encoding, "-i", "teem.nrrd", "-o", "saved.nrrd")
                    self.assertEqual(self.read("saved.nrrd"), wanted)

    def test_nrrd_of_several_files_is_what_teem_reads(self):
        for slab in range(3):
            self.write(f"s{slab:02d}.raw", "head\n??", WORDS[slab * 40 : (slab + 1) * 40])
        for field in (
            "data file: s%02d.raw 0 2 1\n",
            "data file: s%02d.raw 2 0 -1\n",
            "data file: s%02d.raw 0 2 1 2\n",
            "data file: LIST\ns01.raw\ns00.raw\ns02.raw\n",
            "data file: LIST 3\ns00.raw\ns01.raw\ns02.raw\n",
        ):
            for skips in ("line skip: 1\nbyte skip: 2\n", "byte skip: -1\n"):
                with self.subTest(field=field, skips=skips):
                    self.write("many.nhdr", HEAD.format(type="short") + "encoding: raw\n" + skips + field)
                    self.call(UNU, "save", "-f", "nrrd", "-e", "raw", "-i", "many.nhdr", "-o", "one.nrrd")
                    self.assertEqual(self.read("many.nhdr"), self.read("one.nrrd"))

    def test_time_points_of_nrrd_are_what_teem_slices(self):
        head = HEAD.replace("dimension: 3", "dimension: 4").replace("sizes: 5 4 3", "sizes: 5 4 3 3")
        head = head.replace("(1.5,0,0)", "(1.5,0,0) none").format(type="short")
        other, third = (WORDS[2 * shift :] + WORDS[: 2 * shift] for shift in (7, 31))
        self.write("series.nrrd", head + "encoding: raw\n\n", WORDS + other + third)
        for point in range(3):
            with self.subTest(point=point):
                self.call(UNU, "slice", "-a", "3", "-p", str(point), "-i", "series.nrrd", "-o", "one.nrrd")
                self.assertEqual(self.read("series.nrrd", "--time-point", point + 1), self.read("one.nrrd"))

    def test_metaimage_is_where_itk_puts_it(self):
        for number, tags in enumerate(
            (
                "",
                "AnatomicalOrientation = ???\n",
                "AnatomicalOrientation = RAI\n",
                "TransformMatrix = 1 0 0 0 1 0 0 0 1\n",
                "TransformMatrix = 1 0 0 0 1 0 0 0 1\nAnatomicalOrientation = LPI\n",
                "TransformMatrix = 0 1 0 0 0 -1 1 0 0\n",
                "TransformMatrix = 0 0 1 1 0 0 0 1 0\n",
                "TransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\n",
                "CompressedData = False\nOffset = 7 8 9\nElementSize = 9 9 9\n",
            )
        ):
            head = f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n{tags}"
            head += "ElementSpacing = 1 2 3\nDimSize = 5 4 3\nElementType = MET_SHORT\n"
            with self.subTest(tags=tags):
                name = f"{number}.mha"
                self.write(name, head + "ElementDataFile = LOCAL\n", WORDS)
                self.call(PLASTIMATCH, "convert", "--input", name, "--output-img", "itk.nrrd")
                self.assertEqual(self.read(name), self.read("itk.nrrd"))

    def test_metaimage_of_several_files_is_what_itk_reads(self):
        for slab in range(3):
            self.write(f"m{slab}.raw", "", WORDS[slab * 40 : (slab + 1) * 40])
        head = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
        head += "ElementSpacing = 1 2 3\nDimSize = 5 4 3\nElementType = MET_SHORT\nElementDataFile = "
        for files in ("LIST\nm2.raw\nm0.raw\nm1.raw\n", "LIST 2D\nm0.raw\nm1.raw\nm2.raw\n", "m%d.raw 0 2 1\n"):
            with self.subTest(files=files):
                self.write("many.mhd", head + files)
                self.call(PLASTIMATCH, "convert", "--input", "many.mhd", "--output-img", "itk.nrrd")
                self.assertEqual(self.read("many.mhd"), self.read("itk.nrrd"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
