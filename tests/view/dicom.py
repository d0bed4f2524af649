"""DICOM series as gazeview reads them, compared with independent readers: pydicom and DCMTK.

dicom.py GAZEVIEW

pydicom writes series and turns them to RAS+ by itself. DCMTK's programs and GDCM's compress them;
what DCMTK decompresses again is what gazeview must read of the compressed ones. Exits 77 if pydicom
is not installed; a compression whose program is missing is left out with its name.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
except ImportError as missing:
    print(f"skipped: {missing}; it is in the package python3-pydicom")
    sys.exit(77)

from picture import run
from raw_nrrd import read_nrrd

GAZEVIEW = sys.argv[1]
CT = "1.2.840.10008.5.1.4.1.1.2"
SERIES = "1.2.826.0.1.3680043.2.1125.7"
ROWS, COLUMNS, SLICES = 40, 48, 4

# Compressed by the first program; decompressed by the second, which is not the decoder under test.
CODINGS = {
    "implicit": (["dcmconv", "+ti"], None),
    "big-endian": (["dcmconv", "+tb"], None),
    "deflated": (["dcmconv", "+td"], None),
    "without-preamble": (["dcmconv", "-F", "+ti"], None),
    "rle": (["dcmcrle"], ["dcmdrle"]),
    "jpeg-lossless": (["dcmcjpeg"], ["dcmdjpeg"]),
    "jpeg-lossy": (["dcmcjpeg", "+ee"], ["dcmdjpeg"]),
    "jpeg-ls": (["dcmcjpls"], ["dcmdjpls"]),
    "jpeg-2000": (["gdcmconv", "--j2k"], None),
}

KINDS = {  # type of numpy, bits stored
    "signed": ("<i2", 16),
    "twelve": ("<u2", 12),
    "signed-twelve": ("<i2", 12),
    "bytes": ("u1", 8),
    "wide-bytes": ("<u2", 8),
}

ORIENTATIONS = (
    (1, 0, 0, 0, 1, 0),
    (-1, 0, 0, 0, 1, 0),
    (0, 1, 0, 0, 0, -1),
    (1, 0, 0, 0, 0, -1),
    (0, 0, 1, 0, -1, 0),
)


def pixels_of(kind, number):
    dtype, stored = KINDS[kind]
    signed = numpy.dtype(dtype).kind == "i"
    most = 2 ** (stored - 1) - 1
    y, x = numpy.mgrid[0:ROWS, 0:COLUMNS]
    wave = most * 0.9 * numpy.sin(x / 7 + number) * numpy.cos(y / 5)
    return (wave if signed else wave + most).astype(dtype)


def new_image(sop_class, series, instance, shape):
    """An image of `shape` rows and columns without a place and without pixels."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = sop_class
    meta.MediaStorageSOPInstanceUID = f"{series}.{instance}"
    meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    meta.ImplementationClassUID = "1.2.3.4"
    image = FileDataset("", {}, file_meta=meta, preamble=bytes(128))
    image.is_little_endian, image.is_implicit_VR = True, False
    image.SOPClassUID, image.SOPInstanceUID = sop_class, f"{series}.{instance}"
    image.StudyInstanceUID, image.SeriesInstanceUID = f"{series}.1.1", series
    image.InstanceNumber = instance
    image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
    image.Rows, image.Columns = shape
    return image


def write_series(folder, kind, orientation):
    dtype, stored = KINDS[kind]
    signed = numpy.dtype(dtype).kind == "i"
    normal = numpy.cross(orientation[:3], orientation[3:])
    for number in range(SLICES):
        image = new_image(CT, SERIES, number, (ROWS, COLUMNS))
        image.Modality, image.InstanceNumber = "CT", SLICES - number
        image.ImageOrientationPatient = list(orientation)
        image.ImagePositionPatient = [float(x) for x in normal * 2.5 * number - 30]
        image.PixelSpacing, image.SliceThickness = [0.75, 0.5], 9
        image.RescaleSlope, image.RescaleIntercept = 1, -24
        image.BitsAllocated, image.BitsStored = numpy.dtype(dtype).itemsize * 8, stored
        image.HighBit, image.PixelRepresentation = stored - 1, int(signed)
        pixels = pixels_of(kind, number)
        if signed and stored < 16:
            pixels = pixels.astype("<u2") & (2**stored - 1)
        image.PixelData = pixels.tobytes()
        image.save_as(os.path.join(folder, f"{number:02}.ima"), write_like_original=False)


def convert(program, source, target):
    """All files of a folder by one program; False if it is not there."""
    if not shutil.which(program[0]):
        return False
    os.mkdir(target)
    for name in sorted(os.listdir(source)):
        files = [os.path.join(source, name), os.path.join(target, name)]
        subprocess.run([*program, *files], check=True, capture_output=True)
    return True


def stored_values(image):
    """pydicom leaves the bits above the stored ones to its users."""
    sign = 1 << image.BitsStored - 1 if image.PixelRepresentation else 0
    bits = image.pixel_array.astype("i8") & (1 << image.BitsStored) - 1
    return (bits ^ sign) - sign


def turn_to_ras(values, orientation, spacing):
    """Values [slice, row, column] of a stack, and its spacing along columns, rows and slices, as
    [x, y, z] in RAS+."""
    directions = numpy.array(orientation, "f8").reshape(2, 3)
    values = values.transpose(2, 1, 0)  # column, row, slice
    axes = numpy.array([*directions, numpy.cross(*directions)]) * (-1, -1, 1)  # LPS to RAS
    order = [int(numpy.argmax(abs(axes[:, world]))) for world in range(3)]
    values = values.transpose(order)
    for world, axis in enumerate(order):
        if axes[axis, world] < 0:
            values = numpy.flip(values, world)
    return values, [float(spacing[axis]) for axis in order]


def volume_of(folder):
    """The values [x, y, z] in RAS+ and the spacing, from what pydicom reads."""
    images = [pydicom.dcmread(os.path.join(folder, name), force=True) for name in os.listdir(folder)]
    directions = numpy.array(images[0].ImageOrientationPatient, "f8").reshape(2, 3)
    normal = numpy.cross(*directions)
    images.sort(key=lambda image: numpy.dot(normal, numpy.array(image.ImagePositionPatient, "f8")))
    values = numpy.stack([stored_values(image) * float(image.RescaleSlope) + float(image.RescaleIntercept)
                          for image in images])
    spacing = [images[0].PixelSpacing[1], images[0].PixelSpacing[0], 2.5]
    return turn_to_ras(values, images[0].ImageOrientationPatient, spacing)


class Dicom(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-dicom-")
        self.addCleanup(self.place.cleanup)

    def folder(self, name):
        path = os.path.join(self.place.name, name)
        os.mkdir(path)
        return path

    def check(self, folder, expected):
        values, spacing = expected
        written = os.path.join(self.place.name, "read.nrrd")
        done = run(GAZEVIEW, folder, "--write-volume", written)
        self.assertEqual(done.returncode, 0, done.stderr)
        voxels, read_spacing, space = read_nrrd(written)
        self.assertEqual(voxels.shape, values.shape)
        # Scales other than 1 make floats of single precision.
        self.assertLessEqual(abs(voxels - values).max(), 1e-7 * abs(values).max())
        self.assertLess(abs(numpy.array(read_spacing) - spacing).max(), 1e-9)
        self.assertEqual(space, "right-anterior-superior")

    def test_every_orientation(self):
        for number, orientation in enumerate(ORIENTATIONS):
            with self.subTest(orientation=orientation):
                folder = self.folder(f"turned{number}")
                write_series(folder, "signed", orientation)
                self.check(folder, volume_of(folder))

    def test_every_coding(self):
        for kind in KINDS:
            plain = self.folder(kind)
            write_series(plain, kind, ORIENTATIONS[0])
            for name, (compress, decompress) in CODINGS.items():
                with self.subTest(kind=kind, coding=name):
                    packed, unpacked = f"{plain}-{name}", f"{plain}-{name}-again"
                    if not convert(compress, plain, packed):
                        print(f"left out: {name}, {compress[0]} is not installed")
                        continue
                    if decompress:
                        convert(decompress, packed, unpacked)
                    self.check(packed, volume_of(unpacked if decompress else plain))

    def test_frames_of_one_file(self):
        folder = self.folder("frames")
        write_series(folder, "signed", ORIENTATIONS[0])
        path = os.path.join(folder, "00.ima")
        image = pydicom.dcmread(path)
        pixels = numpy.stack([pixels_of("signed", number) for number in range(SLICES)])
        image.NumberOfFrames, image.PixelData = SLICES, pixels.tobytes()
        image.SpacingBetweenSlices = 4
        del image.ImagePositionPatient, image.ImageOrientationPatient
        image.save_as(path)
        for program in (None, ["dcmcrle"], ["gdcmconv", "--j2k"], ["dcmcjpls"]):
            with self.subTest(program=program):
                read, written = path, os.path.join(self.place.name, "frames.nrrd")
                if program:
                    if not shutil.which(program[0]):
                        continue
                    read = os.path.join(self.place.name, "packed.dcm")
                    subprocess.run([*program, path, read], check=True, capture_output=True)
                done = run(GAZEVIEW, read, "--write-volume", written)
                self.assertEqual(done.returncode, 0, done.stderr)
                voxels, spacing, space = read_nrrd(written)
                self.assertEqual(abs(voxels - (pixels.transpose(2, 1, 0) - 24.0)).max(), 0)
                self.assertEqual(spacing, [0.5, 0.75, 4.0])
                self.assertIsNone(space)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
