"""Memory that gazeview and its decoder take while they load a volume.

volume_memory.py GAZEVIEW

The kernel tells the most memory that a process had at a time. Exits 77 in a build with sanitizers,
which take memory of their own.
"""

import gzip
import os
import struct
import subprocess
import sys
import tempfile
import unittest

from picture import skip

try:
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
except ImportError:
    pydicom = None

GAZEVIEW = sys.argv[1]
if os.environ.get("SANITIZED"):
    skip("a sanitizer takes memory of its own")

SIZES = (384, 384, 300)  # of 16 bits
SLICE_BYTES = 2 * SIZES[0] * SIZES[1]
VOXELS_MIB = SLICE_BYTES * SIZES[2] / 2**20
# The program with its libraries, and some MiB that are read and turned at a time.
PROGRAM_MIB = 24
# GDCM with its codecs, the heads of all files, and the slices that threads decode ahead.
DECODER_MIB = 48


def slices():
    for number in range(SIZES[2]):
        yield struct.pack("<H", number) * (SLICE_BYTES // 2)


class Memory(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-memory-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def peak_mib(self, path):
        """Of the program or of its decoder, whichever had more."""
        with subprocess.Popen([GAZEVIEW, path, "--write-volume", self.path("read.nrrd")],
                              stderr=subprocess.PIPE, text=True) as process:
            told = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0, told)
        size = os.path.getsize(self.path("read.nrrd"))
        self.assertGreater(size, SLICE_BYTES * SIZES[2])
        return usage.ru_maxrss / 1024

    def check(self, path, beside_mib):
        peak = self.peak_mib(path)
        print(f"{os.path.basename(path)}: {peak:.1f} MiB for {VOXELS_MIB:.1f} MiB of voxels")
        self.assertLessEqual(peak, 1.02 * VOXELS_MIB + beside_mib)

    def test_nrrd(self):
        head = (f"NRRD0004\ntype: uint16\ndimension: 3\nsizes: {SIZES[0]} {SIZES[1]} {SIZES[2]}\n"
                "spacings: 1 1 1\nendian: little\nencoding: raw\n\n")
        with open(self.path("a.nrrd"), "wb") as out:
            out.write(head.encode())
            out.writelines(slices())
        self.check(self.path("a.nrrd"), PROGRAM_MIB)

    def test_nifti_plain_and_compressed(self):
        head = bytearray(352)
        struct.pack_into("<i", head, 0, 348)
        struct.pack_into("<8h", head, 40, 3, *SIZES, 1, 1, 1, 1)
        struct.pack_into("<2h", head, 70, 512, 16)  # unsigned, 16 bits
        struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 0, 0, 0, 0)
        struct.pack_into("<2f", head, 108, 352, 1)
        struct.pack_into("<h", head, 254, 1)  # the sform holds
        for row in range(3):
            struct.pack_into("<f", head, 280 + 20 * row, 1)
        head[344:348] = b"n+1\0"
        for name, opened in (("a.nii", open), ("a.nii.gz", gzip.open)):
            with self.subTest(name=name):
                with opened(self.path(name), "wb") as out:
                    out.write(head)
                    out.writelines(slices())
                self.check(self.path(name), PROGRAM_MIB)

    @unittest.skipUnless(pydicom, "no pydicom; it is in the package python3-pydicom")
    def test_dicom(self):
        os.mkdir(self.path("series"))
        for number, pixels in enumerate(slices()):
            meta = FileMetaDataset()
            meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
            meta.MediaStorageSOPInstanceUID = f"1.2.3.{number + 1}"
            meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
            image = FileDataset("", {}, file_meta=meta, preamble=bytes(128))
            image.is_little_endian, image.is_implicit_VR = True, False
            image.SOPClassUID = meta.MediaStorageSOPClassUID
            image.SOPInstanceUID, image.SeriesInstanceUID = f"1.2.3.{number + 1}", "1.2.3"
            image.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
            image.ImagePositionPatient, image.PixelSpacing = [0, 0, number], [1, 1]
            image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
            image.Columns, image.Rows = SIZES[0], SIZES[1]
            image.BitsAllocated, image.BitsStored, image.HighBit = 16, 16, 15
            image.PixelRepresentation, image.PixelData = 0, pixels
            image.save_as(self.path(f"series/{number:03}.dcm"), write_like_original=False)
        self.check(self.path("series"), DECODER_MIB)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
