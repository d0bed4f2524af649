"""DICOM slices that do not lie evenly and the frames of enhanced files, as gazeview reads them.

dicom_geometry.py GAZEVIEW

pydicom writes the files; numpy samples what pydicom reads of them at the points of an even grid, by
another way than gazeview does. Exits 77 if pydicom is not installed.
"""

import os
import sys
import tempfile
import unittest

try:
    import numpy
    import pydicom
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence
except ImportError as missing:
    print(f"skipped: {missing}; it is in the package python3-pydicom")
    sys.exit(77)

from dicom import CT, GAZEVIEW, new_image
from picture import run
from raw_nrrd import read_nrrd

ENHANCED_CT = "1.2.840.10008.5.1.4.1.1.2.1"
ENHANCED_MR = "1.2.840.10008.5.1.4.1.1.4.1"
SERIES = "1.2.826.0.1.3680043.2.1125.8"
ROWS, COLUMNS = 24, 20
SPACING = (0.75, 0.5)  # between rows, between columns
HINT = "--resample (scene key volume.resample)"

AXIAL = (1, 0, 0, 0, 1, 0)
ORIENTATIONS = (AXIAL, (0, 1, 0, 0, 0, -1), (-1, 0, 0, 0, 0, 1))


def pixels_of(number):
    y, x = numpy.mgrid[0:ROWS, 0:COLUMNS]
    return (900 * numpy.sin(x / 5 + number) * numpy.cos(y / 4 - number / 3)).astype("<i2")


class Slices:
    """Where slices lie: along the normal, and shifted along rows and columns, mm."""

    def __init__(self, along, tilt=(0, 0), orientation=AXIAL):
        self.directions = numpy.array(orientation, "f8").reshape(2, 3)
        self.normal = numpy.cross(*self.directions)
        self.along = numpy.array(along, "f8")
        shift = numpy.outer(self.along, tilt)
        self.positions = numpy.outer(self.along, self.normal) + shift @ self.directions - 30
        self.pixels = [pixels_of(number) for number in range(len(along))]


def new_wide_image(kind, number):
    image = new_image(kind, SERIES, number, (ROWS, COLUMNS))
    image.BitsAllocated = image.BitsStored = 16
    image.HighBit, image.PixelRepresentation = 15, 1
    return image


def numbers(values):
    return [float(f"{value:.9g}") for value in values]


def write_series(folder, slices, series=SERIES):
    for number, position in enumerate(slices.positions):
        image = new_wide_image(CT, number + 1)
        image.Modality, image.SeriesInstanceUID = "CT", series
        image.ImageOrientationPatient = numbers(slices.directions.flat)
        image.ImagePositionPatient = numbers(position)
        image.PixelSpacing, image.SliceThickness = list(SPACING), 9
        image.RescaleSlope, image.RescaleIntercept = 1, -24
        image.PixelData = slices.pixels[number].tobytes()
        name = f"{series[-1]}-{number * 7 % len(slices.positions):02}-{number}.dcm"
        image.save_as(os.path.join(folder, name), write_like_original=False)


def group(**elements):
    item = Dataset()
    for name, value in elements.items():
        setattr(item, name, value)
    return Sequence([item])


def write_enhanced(path, slices, kind=ENHANCED_CT, order=None, scales=None):
    """One file of several frames, in any order, each with its place and, if given, its scale."""
    order = range(len(slices.positions)) if order is None else order
    image = new_wide_image(kind, 1)
    image.Modality, image.NumberOfFrames = "CT" if kind == ENHANCED_CT else "MR", len(slices.positions)
    shared = Dataset()
    shared.PlaneOrientationSequence = group(ImageOrientationPatient=numbers(slices.directions.flat))
    shared.PixelMeasuresSequence = group(PixelSpacing=list(SPACING), SliceThickness=9)
    if not scales:
        shared.PixelValueTransformationSequence = group(
            RescaleSlope=1, RescaleIntercept=-24, RescaleType="HU")
    image.SharedFunctionalGroupsSequence = Sequence([shared])
    frames = []
    for number in order:
        frame = Dataset()
        frame.PlanePositionSequence = group(ImagePositionPatient=numbers(slices.positions[number]))
        if scales:
            frame.PixelValueTransformationSequence = group(
                RescaleSlope=scales[number][0], RescaleIntercept=scales[number][1], RescaleType="US")
        frames.append(frame)
    image.PerFrameFunctionalGroupsSequence = Sequence(frames)
    image.PixelData = b"".join(slices.pixels[number].tobytes() for number in order)
    image.save_as(path, write_like_original=False)


def frames_of(path):
    """Position, directions and values of each frame or file, as pydicom reads them."""
    paths = [path] if os.path.isfile(path) else [os.path.join(path, name) for name in os.listdir(path)]
    for image in (pydicom.dcmread(name) for name in paths):
        if "PerFrameFunctionalGroupsSequence" not in image:
            place, plane, scale = image, image, image
            yield place.ImagePositionPatient, plane.ImageOrientationPatient, (
                image.pixel_array * float(scale.RescaleSlope) + float(scale.RescaleIntercept))
            continue
        shared = image.SharedFunctionalGroupsSequence[0]
        for frame, pixels in zip(image.PerFrameFunctionalGroupsSequence, image.pixel_array):
            scale = (frame if "PixelValueTransformationSequence" in frame else shared)
            scale = scale.PixelValueTransformationSequence[0]
            yield (frame.PlanePositionSequence[0].ImagePositionPatient,
                   shared.PlaneOrientationSequence[0].ImageOrientationPatient,
                   pixels * float(scale.RescaleSlope) + float(scale.RescaleIntercept))


def interpolated(values, places, axis):
    """Values along an axis at fractional places; NaN outside."""
    count = values.shape[axis]
    places = numpy.round(places, 6)
    inside = (places >= 0) & (places <= count - 1)
    low = numpy.clip(numpy.floor(places).astype(int), 0, count - 1)
    share = numpy.where(inside, places - low, numpy.nan)
    share = share.reshape([-1 if i == axis else 1 for i in range(values.ndim)])
    high = numpy.clip(low + 1, 0, count - 1)
    return values.take(low, axis) * (1 - share) + values.take(high, axis) * share


def expected_volume(path, targets, fill=None):
    """The values [x, y, z] in RAS+ at the places along the normal, and the spacing in the plane.
    Where no slice lies: fill, or the least value."""
    frames = list(frames_of(path))
    directions = numpy.array(frames[0][1], "f8").reshape(2, 3)
    normal = numpy.cross(*directions)
    frames.sort(key=lambda frame: numpy.dot(normal, numpy.array(frame[0], "f8")))
    positions = numpy.array([frame[0] for frame in frames], "f8")
    along = positions @ normal
    within = (positions - positions[0]) @ directions.T
    within -= within.min(axis=0)
    pixels = within / (SPACING[1], SPACING[0])
    sizes = [COLUMNS, ROWS] + numpy.ceil(pixels.max(axis=0) - 1e-4).astype(int)
    laid = []
    for (_, _, values), shift in zip(frames, pixels):
        rows = interpolated(values, numpy.arange(sizes[1]) - shift[1], 0)
        laid.append(interpolated(rows, numpy.arange(sizes[0]) - shift[0], 1))
    laid = numpy.stack(laid)
    places = numpy.interp(targets, along - along[0], numpy.arange(len(along)))
    low = numpy.minimum(numpy.floor(numpy.round(places, 6)).astype(int), len(along) - 1)
    share = numpy.round(places - low, 6).reshape(-1, 1, 1)
    high = numpy.minimum(low + 1, len(along) - 1)
    values = numpy.where(share == 0, laid[low], laid[low] * (1 - share) + laid[high] * share)
    fill = min(frame[2].min() for frame in frames) if fill is None else fill
    values = numpy.where(numpy.isnan(values), fill, values)
    values = values.transpose(2, 1, 0)  # column, row, slice
    axes = numpy.array([directions[0], directions[1], normal]) * (-1, -1, 1)  # LPS to RAS
    spacing = [SPACING[1], SPACING[0], targets[1] - targets[0]]
    order = [int(numpy.argmax(abs(axes[:, world]))) for world in range(3)]
    values = values.transpose(order)
    for world, axis in enumerate(order):
        if axes[axis, world] < 0:
            values = numpy.flip(values, world)
    return values, [float(spacing[axis]) for axis in order]


class Geometry(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-geometry-")
        self.addCleanup(self.place.cleanup)

    def folder(self, slices):
        path = tempfile.mkdtemp(dir=self.place.name)
        write_series(path, slices)
        return path

    def read(self, *arguments):
        written = os.path.join(self.place.name, "read.nrrd")
        done = run(GAZEVIEW, *arguments, "--write-volume", written)
        self.assertEqual(done.returncode, 0, done.stderr)
        return read_nrrd(written), done.stderr

    def check(self, path, targets, *arguments, tolerance=0.502):
        """Integers are rounded, so that a value may differ by half a unit of the file."""
        (voxels, spacing, space), log = self.read(path, *arguments)
        values, expected_spacing = expected_volume(path, numpy.array(targets, "f8"))
        self.assertEqual(voxels.shape, values.shape)
        self.assertLessEqual(abs(voxels - values).max(), tolerance)
        self.assertLess(abs(numpy.array(spacing) - expected_spacing).max(), 1e-6)
        self.assertEqual(space, "right-anterior-superior")
        return log

    def refused(self, path, *words):
        written = os.path.join(self.place.name, "refused.nrrd")
        done = run(GAZEVIEW, path, "--write-volume", written)
        self.assertNotEqual(done.returncode, 0)
        for word in (*words, HINT):
            self.assertIn(word, done.stderr)
        self.assertFalse(os.path.exists(written))

    def test_missing_slices(self):
        along = [0, 2.5, 5, 10, 12.5, 20, 22.5]
        for orientation in ORIENTATIONS:
            with self.subTest(orientation=orientation):
                folder = self.folder(Slices(along, orientation=orientation))
                self.refused(folder, "3 of 10 slices, 2.5 mm apart, are missing")
                log = self.check(folder, numpy.arange(10) * 2.5, "--resample")
                self.assertIn("from 7 slices to 10, 2.5 mm apart", log)

    def test_slices_that_are_there_stay_as_they_are(self):
        folder = self.folder(Slices([0, 2.5, 7.5, 10]))
        (voxels, _, _), _ = self.read(folder, "--resample")
        for index, number in ((0, 0), (1, 1), (3, 2), (4, 3)):
            expected = pixels_of(number).T[::-1, ::-1] - 24.0
            self.assertEqual(abs(voxels[:, :, index] - expected).max(), 0)

    def test_uneven_slices(self):
        along = [0, 1.2, 2, 5, 7.1, 9]
        for orientation in ORIENTATIONS:
            with self.subTest(orientation=orientation):
                folder = self.folder(Slices(along, orientation=orientation))
                self.refused(folder, "its slices lie 0.8 to 3 mm apart, most 1.9")
                # 9 mm in gaps of 0.8 mm at most: twelve of 0.75 mm.
                self.check(folder, numpy.arange(13) * 0.75, "--resample")

    def test_tilted_gantry(self):
        for tilt in ((0, 0.25), (0, -0.31), (0.13, 0.2), (-0.4, 0)):
            for orientation in ORIENTATIONS:
                with self.subTest(tilt=tilt, orientation=orientation):
                    along = numpy.arange(6) * 2.0
                    folder = self.folder(Slices(along, tilt, orientation))
                    degrees = numpy.degrees(numpy.arctan(numpy.hypot(*tilt)))
                    words = f"the gantry was tilted by {degrees:.1f} degrees"
                    _, log = self.read(folder)
                    self.assertIn(words, log)
                    self.assertIn(HINT, log)
                    self.assertIn(words, self.check(folder, along, "--resample"))

    def test_tilted_gantry_with_missing_and_uneven_slices(self):
        folder = self.folder(Slices([0, 2, 4, 8, 10], (0.1, 0.3)))
        log = self.check(folder, numpy.arange(6) * 2.0, "--resample")
        self.assertIn("1 of 6 slices, ", log)
        self.assertIn("the gantry was tilted by", log)
        folder = self.folder(Slices([0, 2, 3, 5.5, 7], (-0.2, 0.15)))
        self.check(folder, numpy.arange(8.0), "--resample")

    def test_nearest_makes_no_new_numbers(self):
        slices = Slices([0, 2, 3, 7, 9], (0.1, 0.2))
        slices.pixels = [(pixels_of(number) // 300 * 10).astype("<i2") for number in range(5)]
        folder = self.folder(slices)
        (voxels, _, _), log = self.read(folder, "--volume.resample", "nearest")
        self.assertIn("resampled (nearest)", log)
        there = numpy.unique(slices.pixels) - 24.0
        self.assertTrue(numpy.isin(voxels, there).all())
        self.assertEqual(voxels.shape[2], 10)
        (voxels, _, _), _ = self.read(folder, "--resample")
        self.assertFalse(numpy.isin(voxels, there).all())

    def test_scene_key(self):
        folder = self.folder(Slices([0, 2.5, 7.5, 10]))
        scene = os.path.join(self.place.name, "resampled.scene")
        for how, slices in (("linear", 5), ("nearest", 5), ("off", None)):
            with open(scene, "w", encoding="utf-8") as out:
                out.write(f"[volume]\nfile = {folder}\nresample = {how}\n")
            if slices is None:
                self.refused(scene, "1 of 5 slices, ")
            else:
                self.assertEqual(self.read(scene)[0][0].shape[2], slices)

    def test_series_is_chosen_by_option(self):
        folder = self.folder(Slices([0, 1, 2]))
        write_series(folder, Slices([0, 1, 3, 4]), SERIES[:-1] + "9")
        self.assertEqual(self.read(folder, "--volume.series", SERIES)[0][0].shape[2], 3)
        (voxels, _, _), _ = self.read(folder, "--volume.series", SERIES[:-1] + "9", "--resample")
        self.assertEqual(voxels.shape[2], 5)

    def enhanced(self, slices, **options):
        path = os.path.join(self.place.name, "enhanced.dcm")
        write_enhanced(path, slices, **options)
        return path

    def test_enhanced_frames_in_any_order(self):
        along = numpy.arange(5) * 1.5
        for kind in (ENHANCED_CT, ENHANCED_MR):
            for orientation in ORIENTATIONS:
                for order in (range(5), [3, 0, 4, 1, 2], [4, 3, 2, 1, 0]):
                    with self.subTest(kind=kind, orientation=orientation, order=order):
                        slices = Slices(along, orientation=orientation)
                        path = self.enhanced(slices, kind=kind, order=order)
                        self.check(path, along, tolerance=0)

    def test_enhanced_frames_with_scales_of_their_own(self):
        along = numpy.arange(5) * 1.5
        scales = [(0.5, 10), (2, -5), (1, 0), (0.125, 100), (3, 7)]
        for order in (range(5), [3, 0, 4, 1, 2]):
            path = self.enhanced(Slices(along), order=order, scales=scales)
            self.check(path, along, tolerance=0)

    def test_enhanced_frames_that_lie_unevenly(self):
        slices = Slices([0, 1, 2.5, 3.25, 6])
        path = self.enhanced(slices, order=[2, 4, 0, 3, 1])
        self.refused(path, "its slices lie 0.75 to 2.75 mm apart")
        self.check(path, numpy.arange(9) * 0.75, "--resample")
        scales = [(0.5, 10), (2, -5), (1, 0), (0.125, 100), (3, 7)]
        path = self.enhanced(slices, order=[2, 4, 0, 3, 1], scales=scales)
        # Weights are rounded in the sixth digit here, and values differ by some thousand.
        self.check(path, numpy.arange(9) * 0.75, "--resample", tolerance=5e-3)

    def test_enhanced_frames_that_are_missing_and_tilted(self):
        path = self.enhanced(Slices([0, 2, 6, 8], (0.05, 0.2)), order=[3, 1, 0, 2])
        self.refused(path, "1 of 5 slices, ")
        self.check(path, numpy.arange(5) * 2.0, "--resample")

    def test_enhanced_frames_of_several_pixel_sizes_are_refused(self):
        path = self.enhanced(Slices([0, 2, 4]))
        image = pydicom.dcmread(path)
        del image.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence
        for number, frame in enumerate(image.PerFrameFunctionalGroupsSequence):
            size = [0.75, 0.5 if number < 2 else 0.6]
            frame.PixelMeasuresSequence = group(PixelSpacing=size, SliceThickness=2)
        image.save_as(path)
        written = os.path.join(self.place.name, "refused.nrrd")
        done = run(GAZEVIEW, path, "--write-volume", written)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("its frames have pixels of several sizes", done.stderr)

    def test_enhanced_frames_at_one_place_are_time_points(self):
        slices = Slices([0, 2, 4])
        path = os.path.join(self.place.name, "phases.dcm")
        write_enhanced(path, slices)
        image = pydicom.dcmread(path)
        image.NumberOfFrames = 6
        frames = image.PerFrameFunctionalGroupsSequence
        image.PerFrameFunctionalGroupsSequence = Sequence(list(frames) + list(frames))
        later = b"".join(pixels_of(number + 7).tobytes() for number in range(3))
        image.PixelData = image.PixelData + later
        image.save_as(path)
        for point in (1, 2):
            (voxels, _, _), log = self.read(path, "--time-point", str(point))
            self.assertIn("2 images at each place: time points", log)
            for number in range(3):
                expected = pixels_of(number + 7 * (point - 1)).T[::-1, ::-1] - 24.0
                self.assertEqual(abs(voxels[:, :, number] - expected).max(), 0)

    def write_time_points(self, stacks):
        """A folder for each time point, for numpy, and one of all of them. The least number is in
        the first time point alone."""
        together = tempfile.mkdtemp(dir=self.place.name)
        alone = []
        for point, slices in enumerate(stacks):
            slices.pixels = [numpy.maximum(pixels_of(number + 11 * point), -800)
                             for number in range(len(slices.along))]
            if point == 0:
                slices.pixels[0][0, 0] = -900
            alone.append(self.folder(slices))
            for name in os.listdir(alone[-1]):
                image = pydicom.dcmread(os.path.join(alone[-1], name))
                image.TemporalPositionIdentifier = point + 1
                image.save_as(os.path.join(together, f"{point}-{name}"))
        return together, alone

    def check_time_points(self, stacks, targets, words):
        together, alone = self.write_time_points(stacks)
        self.refused_or_said(together, words)
        for point in (2, 1, 3):
            (voxels, spacing, _), log = self.read(
                together, "--resample", "--time-point", str(point))
            self.assertIn(words, log)
            values, expected_spacing = expected_volume(
                alone[point - 1], numpy.array(targets, "f8"), fill=-924)
            self.assertEqual(voxels.shape, values.shape)
            self.assertLessEqual(abs(voxels - values).max(), 0.502)
            self.assertLess(abs(numpy.array(spacing) - expected_spacing).max(), 1e-6)

    def refused_or_said(self, path, words):
        done = run(GAZEVIEW, path, "--write-volume", os.path.join(self.place.name, "none.nrrd"))
        self.assertIn(words, done.stderr)
        self.assertIn(HINT, done.stderr)

    def test_time_points_are_resampled_alike(self):
        for along, tilt, targets, words in (
                ([0, 2, 6, 8], (0, 0), numpy.arange(5) * 2.0, "1 of 5 slices, "),
                ([0, 1.5, 2.5, 5], (0, 0), numpy.arange(6.0), "its slices lie 1 to 2.5 mm apart"),
                ([0, 2, 4, 6], (0.1, 0.3), numpy.arange(4) * 2.0, "the gantry was tilted by"),
                ([0, 2, 6, 8], (0.1, 0.3), numpy.arange(5) * 2.0, "1 of 5 slices, ")):
            with self.subTest(along=along, tilt=tilt):
                self.check_time_points([Slices(along, tilt) for _ in range(3)], targets, words)

    def test_time_point_that_is_shifted_is_moved_back(self):
        stacks = [Slices([0, 2, 4]) for _ in range(2)]
        stacks[1].positions = stacks[1].positions + (1.0, 0, 0)  # two columns
        together, _ = self.write_time_points(stacks)
        _, log = self.read(together)
        self.assertIn("slices are shifted by up to 1.0 mm off one line", log)
        first, second = [self.read(together, "--resample", "--time-point", point)[0][0]
                         for point in ("1", "2")]
        self.assertEqual(first.shape, (COLUMNS + 2, ROWS, 3))
        # Columns run to the left: the last of the file is the first of RAS+.
        self.assertEqual(abs(first[:2] - (-924)).max(), 0)
        self.assertEqual(abs(second[-2:] - (-924)).max(), 0)
        expected = stacks[1].pixels[2].T[::-1, ::-1] - 24.0
        self.assertEqual(abs(second[:-2, :, 2] - expected).max(), 0)

    def test_colours_are_mixed_in_each_channel(self):
        slices = Slices([0, 2, 4, 8], (0, 0.375))
        colours = [numpy.stack([(abs(pixels_of(number + 5 * channel)) // 4 + 20).astype("u1")
                                for channel in range(3)], -1) for number in range(4)]
        folder = self.folder(slices)
        for name in os.listdir(folder):
            path = os.path.join(folder, name)
            image = pydicom.dcmread(path)
            image.SamplesPerPixel, image.PhotometricInterpretation = 3, "RGB"
            image.PlanarConfiguration = 0
            image.BitsAllocated, image.BitsStored, image.HighBit = 8, 8, 7
            image.PixelRepresentation = 0
            image.PixelData = colours[image.InstanceNumber - 1].tobytes()
            image.save_as(path)
        written = os.path.join(self.place.name, "colours.nrrd")
        done = run(GAZEVIEW, folder, "--resample", "--write-volume", written)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 of 5 slices, ", done.stderr)
        with open(written, "rb") as file:
            head, data = file.read().split(b"\n\n", 1)
        # A slice at 2 mm is shifted by a row. The first of the file lies at the back.
        self.assertIn(f"sizes: 3 {COLUMNS} {ROWS + 4} 5".encode(), head)
        voxels = numpy.frombuffer(data, "u1").reshape(5, ROWS + 4, COLUMNS, 3)[:, ::-1, ::-1]
        laid = numpy.full((4, ROWS + 4, COLUMNS, 3), numpy.nan)
        for number, first in enumerate((0, 1, 2, 4)):
            laid[number, first:first + ROWS] = colours[number]
        expected = numpy.stack([laid[0], laid[1], laid[2], (laid[2] + laid[3]) / 2, laid[3]])
        expected = numpy.nan_to_num(expected)
        self.assertLessEqual(abs(voxels - expected).max(), 0.5)

    def test_numbers_of_32_bits_keep_all_digits(self):
        slices = Slices([0, 2, 6])
        folder = self.folder(slices)
        wide = [numpy.arange(ROWS * COLUMNS, dtype="<u4").reshape(ROWS, COLUMNS) * 8_900_001 + number
                for number in (5, 7, 12)]
        for name in os.listdir(folder):
            path = os.path.join(folder, name)
            image = pydicom.dcmread(path)
            image.BitsAllocated, image.BitsStored, image.HighBit = 32, 32, 31
            image.PixelRepresentation, image.RescaleIntercept = 0, 0
            image.PixelData = wide[image.InstanceNumber - 1].tobytes()
            image.save_as(path)
        (voxels, _, _), _ = self.read(folder, "--resample")
        for index, number in ((0, 0), (1, 1), (3, 2)):
            expected = wide[number].T[::-1, ::-1].astype("f8")
            self.assertLessEqual((abs(voxels[:, :, index] - expected) / (expected + 1)).max(), 1e-7)

    def test_list_of_series_knows_what_can_be_resampled(self):
        folder = self.folder(Slices([0, 2.5, 7.5, 10], (0, 0.4)))
        for more, words in ((), HINT), (("--resample",), None):
            done = run(GAZEVIEW, "--list-series", folder, *more)
            self.assertEqual(done.returncode, 0, done.stderr)
            row = done.stdout.splitlines()[1]
            self.assertEqual(row.split()[:3], ["1", SERIES, "4"])
            self.assertEqual(words is not None and words in row, words is not None, row)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
