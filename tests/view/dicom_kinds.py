"""DICOM that is no plain stack of slices, as gazeview reads it: dose, segmentations, series over
time, and what each modality is shown by.

dicom_kinds.py GAZEVIEW

pydicom writes the files, numpy makes what gazeview must read of them. Exits 77 if pydicom is not
installed.
"""

import itertools
import os
import random
import shutil
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

from dicom import GAZEVIEW, ORIENTATIONS, new_image, turn_to_ras
from picture import read_png, run, shows_between
from raw_nrrd import read_nrrd

SERIES = "1.2.826.0.1.3680043.2.1125.8"
CLASSES = {
    "RTDOSE": "1.2.840.10008.5.1.4.1.1.481.2",
    "SEG": "1.2.840.10008.5.1.4.1.1.66.4",
    "MR": "1.2.840.10008.5.1.4.1.1.4",
    "CT": "1.2.840.10008.5.1.4.1.1.2",
    "PT": "1.2.840.10008.5.1.4.1.1.128",
}
ROWS, COLUMNS, SLICES = 11, 13, 9  # no multiple of 8: frames of bits begin within bytes
SPACING = (0.5, 0.75, 2.5)  # of columns, rows, slices
ORIGIN = numpy.array((-30.25, 12.5, 100.0))


def normal_of(orientation):
    return numpy.cross(orientation[:3], orientation[3:])


def new_image_of(modality, instance, orientation):
    image = new_image(CLASSES[modality], SERIES, instance, (ROWS, COLUMNS))
    image.Modality = modality
    if modality != "SEG":
        image.ImageOrientationPatient = list(orientation)
        image.ImagePositionPatient = list(ORIGIN)
        image.PixelSpacing = [SPACING[1], SPACING[0]]
    return image


def set_pixels(image, pixels, bits=None):
    bits = bits or pixels.dtype.itemsize * 8
    image.BitsAllocated, image.BitsStored, image.HighBit = bits, bits, bits - 1
    image.PixelRepresentation = int(pixels.dtype.kind == "i")
    data = numpy.packbits(pixels.reshape(-1), bitorder="little") if bits == 1 else pixels
    image.PixelData = data.tobytes() + bytes(data.nbytes % 2)


def write_dose(path, numbers, orientation, scaling, places):
    """places: the offsets are z coordinates instead of distances."""
    image = new_image_of("RTDOSE", 1, orientation)
    offsets = SPACING[2] * numpy.arange(len(numbers))
    if places:
        offsets = ORIGIN[2] + offsets * normal_of(orientation)[2]
    image.NumberOfFrames, image.GridFrameOffsetVector = len(numbers), [float(x) for x in offsets]
    image.FrameIncrementPointer = pydicom.tag.Tag(0x3004, 0x000C)
    image.DoseUnits, image.DoseType, image.DoseGridScaling = "GY", "PHYSICAL", str(scaling)
    set_pixels(image, numbers)
    image.save_as(path, write_like_original=False)


def write_segmentation(path, frames, orientation, **more):
    """frames: (segment number, slice number, pixels); between: told distance of slices; thickness."""
    fractional = more.get("fractional", 0)
    image = new_image_of("SEG", 1, orientation)
    image.SegmentationType = "FRACTIONAL" if fractional else "BINARY"
    if fractional:
        image.MaximumFractionalValue = fractional
    image.SegmentSequence = Sequence()
    for number in sorted({number for number, _, _ in frames}):
        segment = Dataset()
        segment.SegmentNumber, segment.SegmentLabel = number, f"Organ {number}"
        segment.RecommendedDisplayCIELabValue = [0xFFFF // 2, 0x8080, 0x8080]
        image.SegmentSequence.append(segment)
    shared, orient, measures = Dataset(), Dataset(), Dataset()
    orient.ImageOrientationPatient = list(orientation)
    measures.PixelSpacing, measures.SliceThickness = [SPACING[1], SPACING[0]], more.get("thickness", 7)
    if more.get("between"):
        measures.SpacingBetweenSlices = more["between"]
    shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = Sequence([orient]), Sequence([measures])
    image.SharedFunctionalGroupsSequence = Sequence([shared])
    image.PerFrameFunctionalGroupsSequence = Sequence()
    for number, k, _ in frames:
        group, place, which = Dataset(), Dataset(), Dataset()
        position = ORIGIN + SPACING[2] * k * normal_of(orientation)
        place.ImagePositionPatient = [float(x) for x in position]
        which.ReferencedSegmentNumber = number
        group.PlanePositionSequence, group.SegmentIdentificationSequence = Sequence([place]), Sequence([which])
        image.PerFrameFunctionalGroupsSequence.append(group)
    image.NumberOfFrames = len(frames)
    set_pixels(image, numpy.stack([pixels for _, _, pixels in frames]), None if fractional else 1)
    image.save_as(path, write_like_original=False)


def ball(centre, radius):
    z, y, x = numpy.mgrid[0:SLICES, 0:ROWS, 0:COLUMNS]
    return (z - centre[0]) ** 2 + (y - centre[1]) ** 2 + (x - centre[2]) ** 2 <= radius**2


def frames_of(masks):
    """Frames of all segments, without the empty ones, in an order of no meaning."""
    frames = [(number, k, mask[k].astype("u1")) for number, mask in masks.items()
              for k in range(SLICES) if mask[k].any()]
    random.Random(4).shuffle(frames)
    return frames


class AgainstNumpy(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-kinds-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def check(self, path, values, orientation, *more):
        values, spacing = turn_to_ras(values.astype("f8"), orientation, SPACING)
        done = run(GAZEVIEW, path, "--write-volume", self.path("read.nrrd"), *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        voxels, read_spacing, space = read_nrrd(self.path("read.nrrd"))
        self.assertEqual(voxels.shape, values.shape)
        self.assertLessEqual(abs(voxels - values).max(), 1.3e-7 * abs(values).max())
        self.assertLess(abs(numpy.array(read_spacing) - spacing).max(), 1e-6)
        self.assertEqual(space, "right-anterior-superior")
        return done.stderr


class Kinds(AgainstNumpy):
    def test_dose_of_every_orientation_and_width(self):
        random_numbers = numpy.random.default_rng(1)
        kinds = ("<u2", "<u4", "<i2", "<i4")
        for orientation, kind in itertools.product(ORIENTATIONS, kinds):
            for places in (False, True):
                if places and abs(normal_of(orientation)[2]) != 1:
                    continue
                with self.subTest(orientation=orientation, kind=kind, places=places):
                    info = numpy.iinfo(kind)
                    numbers = random_numbers.integers(info.min, info.max, (SLICES, ROWS, COLUMNS),
                                                      endpoint=True).astype(kind)
                    write_dose(self.path("dose.dcm"), numbers, orientation, 1.7e-5, places)
                    self.check(self.path("dose.dcm"), numbers * 1.7e-5, orientation)

    def test_segments_of_every_orientation(self):
        masks = {1: ball((2, 4, 4), 2.5), 3: ball((6, 7, 8), 2.9)}
        labels = numpy.select(list(masks.values()), list(masks))
        occupied = [k for k in range(SLICES) if labels[k].any()]
        for orientation in ORIENTATIONS:
            with self.subTest(orientation=orientation):
                write_segmentation(self.path("seg.dcm"), frames_of(masks), orientation)
                told = self.check(self.path("seg.dcm"), labels[occupied[0] : occupied[-1] + 1], orientation)
                self.assertIn("segment 1 is Organ 1, #", told)
                self.assertIn("segment 3 is Organ 3, #", told)
                self.assertNotIn("overlap", told)

    def test_nothing_lies_between_segments(self):
        masks = {1: ball((4, 5, 4), 2.5), 3: ball((4, 5, 9), 2.5)}
        write_segmentation(self.path("seg.dcm"), frames_of(masks), ORIENTATIONS[0])
        self.assertFalse(shows_between(GAZEVIEW, self.path("seg.dcm"), 2))
        self.assertTrue(shows_between(GAZEVIEW, self.path("seg.dcm"), 3))
        self.assertTrue(shows_between(GAZEVIEW, self.path("seg.dcm"), 2, "--render.interpolation", "trilinear"))

    def test_grey_of_the_recommended_colour_is_grey(self):
        write_segmentation(self.path("seg.dcm"), frames_of({1: ball((4, 5, 6), 3)}), ORIENTATIONS[0])
        done = run(GAZEVIEW, self.path("seg.dcm"), "--write-volume", self.path("read.nrrd"))
        # L* = 50, a* = b* = 0: sRGB 119 (IEC 61966-2-1).
        self.assertIn("#777777", done.stderr)

    def test_numbers_of_segments_above_a_byte(self):
        masks = {2: ball((2, 4, 4), 2.5), 300: ball((6, 7, 8), 2.5)}
        labels = numpy.select(list(masks.values()), list(masks))
        occupied = [k for k in range(SLICES) if labels[k].any()]
        write_segmentation(self.path("seg.dcm"), frames_of(masks), ORIENTATIONS[0])
        self.check(self.path("seg.dcm"), labels[occupied[0] : occupied[-1] + 1], ORIENTATIONS[0])

    def test_slices_left_out_between_all_frames(self):
        mask = numpy.zeros((SLICES, ROWS, COLUMNS), "u1")
        mask[::4] = 1
        frames = [(1, k, mask[k]) for k in range(0, SLICES, 4)]
        write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0], between=SPACING[2])
        self.check(self.path("seg.dcm"), mask, ORIENTATIONS[0])

    def test_frames_are_as_thick_as_they_say_where_nothing_else_tells(self):
        for kept in ((0, 3), (0, 2, 4, 6), (0, 3, 5)):
            mask = numpy.zeros((SLICES, ROWS, COLUMNS), "u1")
            mask[list(kept)] = ball((4, 5, 5), 9)[list(kept)]
            frames = [(1, k, mask[k]) for k in kept]
            write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0], thickness=SPACING[2])
            said = self.check(self.path("seg.dcm"), mask[: kept[-1] + 1], ORIENTATIONS[0])
            self.assertIn(f"{kept[-1] + 1 - len(kept)} between its frames are empty", said)

    def test_overlapping_segments_are_said_and_the_later_frame_wins(self):
        first, second = ball((4, 5, 5), 3), ball((4, 5, 8), 3)
        frames = [(5, k, first[k].astype("u1")) for k in range(SLICES) if first[k].any()]
        frames += [(2, k, second[k].astype("u1")) for k in range(SLICES) if second[k].any()]
        labels = numpy.where(second, 2, numpy.where(first, 5, 0))
        occupied = [k for k in range(SLICES) if labels[k].any()]
        write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0])
        told = self.check(self.path("seg.dcm"), labels[occupied[0] : occupied[-1] + 1], ORIENTATIONS[0])
        self.assertIn("segments overlap; where they do, the one whose frame comes later is shown", told)

    def test_fractions_of_a_half_count_and_the_greatest_wins(self):
        numbers = numpy.random.default_rng(2)
        fractions = {n: numbers.integers(0, 201, (SLICES, ROWS, COLUMNS)).astype("u1") for n in (1, 2, 4)}
        stack = numpy.stack([fractions[2], fractions[4], fractions[1]])  # as the frames follow
        last = len(stack) - 1 - numpy.argmax(stack[::-1], axis=0)  # of equal ones the last
        labels = numpy.where(stack.max(axis=0) >= 100, numpy.array((2, 4, 1))[last], 0)
        frames = [(n, k, fractions[n][k]) for n in (2, 4, 1) for k in range(SLICES)]
        for coding in (None, "rle"):
            with self.subTest(coding=coding):
                write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0], fractional=200)
                if coding:
                    image = pydicom.dcmread(self.path("seg.dcm"))
                    image.compress(pydicom.uid.RLELossless, encoding_plugin="pydicom")
                    image.save_as(self.path("seg.dcm"))
                told = self.check(self.path("seg.dcm"), labels, ORIENTATIONS[0])
                self.assertIn("the one with the greatest fraction", told)

    def refused(self, words):
        done = run(GAZEVIEW, self.path("seg.dcm"), "--write-volume", self.path("none.nrrd"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(words, done.stderr)

    def test_segmentations_that_are_no_stack_are_refused(self):
        frames = frames_of({1: ball((4, 5, 6), 3)})
        for change, words in (
            (lambda group: group.PlanePositionSequence[0].ImagePositionPatient.__setitem__(0, 17), "one above"),
            (lambda group: group.PlanePositionSequence[0].ImagePositionPatient.__setitem__(2, 91.1), "uneven"),
            (lambda group: group.__delattr__("SegmentIdentificationSequence"), "which segment"),
        ):
            with self.subTest(words=words):
                write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0])
                image = pydicom.dcmread(self.path("seg.dcm"))
                change(image.PerFrameFunctionalGroupsSequence[2])
                image.save_as(self.path("seg.dcm"))
                self.refused(words)
        write_segmentation(self.path("seg.dcm"), frames, ORIENTATIONS[0])
        image = pydicom.dcmread(self.path("seg.dcm"))
        image.PixelData = image.PixelData[:-4]
        image.save_as(self.path("seg.dcm"))
        self.refused("truncated")


TIMES = {  # of time point t at slice k
    "TemporalPositionIdentifier": lambda t, k: t + 1,
    "AcquisitionNumber": lambda t, k: 1 + t + 10 * k,
    "TriggerTime": lambda t, k: 40.5 * t + k,
    "ContentTime": lambda t, k: f"{95910 + 10 * t:06d}.{k:06d}",
}


class OverTime(AgainstNumpy):
    points = 4

    def volume(self, t):
        z, y, x = numpy.mgrid[0:SLICES, 0:ROWS, 0:COLUMNS]
        return (1000 * t + 100 * z + 10 * y + x).astype("<i2")

    def write(self, keys, skip=()):
        numbers = list(range(self.points * SLICES))
        random.Random(6).shuffle(numbers)
        folder = self.path("series")
        os.mkdir(folder)
        for number, (t, k) in zip(numbers, itertools.product(range(self.points), range(SLICES))):
            if (t, k) in skip:
                continue
            image = new_image_of("MR", number, ORIENTATIONS[0])
            image.ImagePositionPatient = [float(x) for x in ORIGIN + (0, 0, SPACING[2] * k)]
            for key, value in keys.items():
                setattr(image, key, value(t, k))
            set_pixels(image, self.volume(t)[k])
            image.save_as(os.path.join(folder, f"{number:03}.dcm"), write_like_original=False)
        return folder

    def test_time_points_are_ordered_by_each_key(self):
        for key in TIMES:
            folder = self.write({key: TIMES[key]})
            with self.subTest(key=key):
                for t in range(self.points):
                    told = self.check(folder, self.volume(t), ORIENTATIONS[0], "--time-point", t + 1)
                    self.assertIn("4 images at each place", told)
            shutil.rmtree(folder)

    def test_key_that_all_images_share_is_passed_over(self):
        folder = self.write({"AcquisitionNumber": lambda t, k: 7, "TriggerTime": TIMES["TriggerTime"]})
        for t in (0, 3):
            self.check(folder, self.volume(t), ORIENTATIONS[0], "--time-point", t + 1)

    def test_missing_images_take_their_time_point_with_them(self):
        folder = self.write({"TemporalPositionIdentifier": lambda t, k: t + 1}, skip=[(1, 5)])
        for point, t in enumerate((0, 2, 3)):
            told = self.check(folder, self.volume(t), ORIENTATIONS[0], "--time-point", point + 1)
            self.assertIn("temporal position 2 lacks images at some places", told)
            self.assertIn("left out (8)", told)
        done = run(GAZEVIEW, folder, "--write-volume", self.path("none.nrrd"), "--time-point", 4)
        self.assertIn("no time point 4: it has 3", done.stderr)

    def test_frames_of_one_enhanced_image(self):
        image = new_image_of("MR", 1, ORIENTATIONS[0])
        image.PerFrameFunctionalGroupsSequence = Sequence()
        order = list(itertools.product(range(SLICES), range(self.points)))
        random.Random(8).shuffle(order)
        for k, t in order:
            group, place, content = Dataset(), Dataset(), Dataset()
            place.ImagePositionPatient = [float(x) for x in ORIGIN + (0, 0, SPACING[2] * k)]
            content.TemporalPositionIndex = t + 1
            group.PlanePositionSequence, group.FrameContentSequence = Sequence([place]), Sequence([content])
            image.PerFrameFunctionalGroupsSequence.append(group)
        image.NumberOfFrames = len(order)
        set_pixels(image, numpy.stack([self.volume(t)[k] for k, t in order]))
        image.save_as(self.path("enhanced.dcm"), write_like_original=False)
        for t in range(self.points):
            self.check(self.path("enhanced.dcm"), self.volume(t), ORIENTATIONS[0], "--time-point", t + 1)


class Looks(AgainstNumpy):
    """A series without a scene opens with a transfer function for what it shows."""

    def write(self, modality, least):
        """A ball in a ball of the same numbers for every modality, none below least."""
        numbers = numpy.where(ball((4, 5, 6), 2), 400, numpy.where(ball((4, 5, 6), 4), 40, -1000))
        numbers = numpy.maximum(numbers, least).astype("<i2")
        folder = self.path(f"{modality or 'none'}{-least}")
        os.mkdir(folder)
        for k in range(SLICES):
            image = new_image_of(modality if modality in CLASSES else "CT", k + 1, ORIENTATIONS[0])
            image.Modality = modality
            image.ImagePositionPatient = [float(x) for x in ORIGIN + (0, 0, SPACING[2] * k)]
            set_pixels(image, numbers[k])
            image.save_as(os.path.join(folder, f"{k}.dcm"), write_like_original=False)
        return folder

    def pixels(self, path, *more):
        picture = self.path("picture.png")
        done = run(GAZEVIEW, "--headless", path, "--size", "48x32", "--backend", "cpu", "--out", picture, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return read_png(picture).rows

    def assert_shown_by(self, path, preset):
        shown = self.pixels(path)
        same = [name for name in ("tissue", "ct_tissue", "mri") if shown == self.pixels(path, "--transfer.preset", name)]
        self.assertEqual(same, [preset], path)

    def test_each_modality_has_a_look_of_its_own(self):
        for modality, least, preset in (("MR", -1000, "mri"), ("CT", -1000, "ct_tissue"), ("CT", -100, "ct_tissue"),
                                        ("PT", -1000, "tissue"), ("", -1000, "ct_tissue"), ("", -100, "tissue"),
                                        ("OT", -1000, "ct_tissue")):
            with self.subTest(modality=modality, least=least):
                self.assert_shown_by(self.write(modality, least), preset)

    def test_bricks_keep_the_modality(self):
        folder = self.write("MR", -1000)
        done = run(GAZEVIEW, folder, "--write-volume", self.path("mr.gzb"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_shown_by(self.path("mr.gzb"), "mri")
        done = run(GAZEVIEW, folder, "--write-volume", self.path("mr.nrrd"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_shown_by(self.path("mr.nrrd"), "ct_tissue")  # NRRD does not say it


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
