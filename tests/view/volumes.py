"""Volume files as gazeview reads them, compared with an independent reader: nibabel.

volumes.py GAZEVIEW

nibabel writes the files and reads them again. gazeview turns each to RAS+ and writes it as a raw
NRRD, which is read here with numpy. Exits 77 if nibabel is not installed.
"""

import itertools
import os
import sys
import tempfile
import unittest

try:
    import nibabel
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}; it is in the package python3-nibabel")
    sys.exit(77)

from picture import run, shows_between
from raw_nrrd import read_nrrd

GAZEVIEW = sys.argv[1]
SHAPE = (5, 4, 3)
SPACING = (1.5, 2.0, 3.25)


def affines():
    """All turns of the axes, and an oblique one."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            affine = numpy.zeros((4, 4))
            affine[3, 3] = 1
            for axis in range(3):
                affine[order[axis], axis] = signs[axis] * SPACING[axis]
            yield affine
    turn = numpy.diag((*SPACING, 1.0))
    angle = numpy.radians(20)
    rotation = numpy.array([[numpy.cos(angle), -numpy.sin(angle)], [numpy.sin(angle), numpy.cos(angle)]])
    turn[:2, :2] = rotation @ turn[:2, :2]
    yield turn


def data_of(kind):
    """Numbers of all magnitudes that fit."""
    count = int(numpy.prod(SHAPE))
    if numpy.dtype(kind).kind == "f":
        return (numpy.linspace(-3, 7, count) ** 3).astype(kind).reshape(SHAPE)
    info = numpy.iinfo(kind)
    return numpy.linspace(max(info.min, -2**24), min(info.max, 2**24), count).astype(kind).reshape(SHAPE)


class AgainstNibabel(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-volumes-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def check(self, name, sided=True, point=None, image=None):
        """What gazeview reads of a file is what nibabel reads, along the nearest axes of RAS+; of a
        series the time point, from 0."""
        wanted = nibabel.as_closest_canonical(image or nibabel.load(self.path(name), mmap=False))
        chosen = [] if point is None else ["--time-point", point + 1]
        done = run(GAZEVIEW, self.path(name), "--write-volume", self.path("read.nrrd"), *chosen)
        self.assertEqual(done.returncode, 0, done.stderr)
        voxels, spacing, space = read_nrrd(self.path("read.nrrd"))
        values = numpy.asarray(wanted.dataobj, "f8")
        values = values[..., point] if values.ndim > 3 and point is not None else values
        self.assertEqual(voxels.shape, values.shape[:3], name)
        scale = max(1, abs(values).max())
        self.assertLess(abs(voxels - values.reshape(voxels.shape)).max(), 2e-7 * scale, name)
        zooms = nibabel.affines.voxel_sizes(wanted.affine)
        self.assertLess(abs(numpy.array(spacing) - zooms).max(), 1e-5, name)
        self.assertEqual(space, "right-anterior-superior" if sided else None, name)
        return done.stderr


class Volumes(AgainstNibabel):
    def test_nifti_of_every_orientation(self):
        for number, affine in enumerate(affines()):
            for name, kind in (("one.nii", nibabel.Nifti1Image), ("two.nii", nibabel.Nifti2Image)):
                with self.subTest(number=number, name=name):
                    nibabel.save(kind(data_of("int16"), affine), self.path(name))
                    self.check(name)

    def test_nothing_lies_between_labels(self):
        labels = numpy.zeros((12, 10, 8), "uint8")
        labels[2:6, 2:8, 2:6], labels[6:10, 2:8, 2:6] = 1, 3
        for name, kind in (("one.nii", nibabel.Nifti1Image), ("two.nii", nibabel.Nifti2Image)):
            image = kind(labels, numpy.diag((1, 1, 1, 1)))
            nibabel.save(image, self.path(name))
            self.assertTrue(shows_between(GAZEVIEW, self.path(name), 2), "values are interpolated")
            image.header.set_intent("label")
            nibabel.save(image, self.path(name))
            for backend in ("cpu", "gl"):
                with self.subTest(name=name, backend=backend):
                    use = ("--backend", backend)
                    self.assertFalse(shows_between(GAZEVIEW, self.path(name), 2, *use))
                    self.assertTrue(shows_between(GAZEVIEW, self.path(name), 3, *use))
                    self.assertTrue(shows_between(GAZEVIEW, self.path(name), 2, *use,
                                                  "--render.interpolation", "trilinear"))

    def test_nifti_qform_alone(self):
        for number, affine in enumerate(affines()):
            with self.subTest(number=number):
                image = nibabel.Nifti1Image(data_of("uint8"), affine)
                image.set_qform(affine, 1)
                image.set_sform(None, 0)
                nibabel.save(image, self.path("q.nii"))
                self.check("q.nii")

    def test_nifti_types_and_scaling(self):
        kinds = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
        for kind, slope in itertools.product(kinds, (None, 0.5, -3)):
            for order in "<>":
                with self.subTest(kind=kind, slope=slope, order=order):
                    header = nibabel.Nifti1Header(endianness=order)
                    header.set_data_dtype(kind)
                    image = nibabel.Nifti1Image(data_of(kind), numpy.diag((-1, 1, 2, 1)), header)
                    if slope:
                        image.header.set_slope_inter(slope, 7)
                    nibabel.save(image, self.path("t.nii"))
                    self.check("t.nii")

    def test_nifti_of_colours_in_every_orientation(self):
        for channels, names in ((3, "RGB"), (4, "RGBA")):
            kind = numpy.dtype([(name, "u1") for name in names])
            count = int(numpy.prod(SHAPE))
            numbers = (numpy.arange(count * channels) * 37 % 251).astype("u1").reshape((*SHAPE, channels))
            for number, affine in enumerate(affines()):
                with self.subTest(channels=channels, number=number):
                    data = numpy.ascontiguousarray(numbers).view(kind).reshape(SHAPE)
                    nibabel.save(nibabel.Nifti1Image(data, affine), self.path("c.nii"))
                    wanted = nibabel.as_closest_canonical(nibabel.load(self.path("c.nii")))
                    done = run(GAZEVIEW, self.path("c.nii"), "--write-volume", self.path("read.nrrd"))
                    self.assertEqual(done.returncode, 0, done.stderr)
                    voxels, spacing, _ = read_nrrd(self.path("read.nrrd"))
                    read = numpy.asarray(wanted.dataobj)
                    self.assertEqual(voxels.shape, (channels, *read.shape))
                    for channel, name in enumerate(names):
                        self.assertTrue((voxels[channel] == read[name]).all(), name)
                    zooms = nibabel.affines.voxel_sizes(wanted.affine)
                    self.assertLess(abs(numpy.array(spacing) - zooms).max(), 1e-5)

    def test_nifti_pairs_and_compressed(self):
        affine = next(itertools.islice(affines(), 13, 14))
        pairs = (nibabel.Nifti1Pair, nibabel.Nifti2Pair)
        for kind, ending in itertools.product(pairs, ("", ".gz")):
            with self.subTest(kind=kind, ending=ending):
                nibabel.save(kind(data_of("int16"), affine), self.path("p.img" + ending))
                self.check("p.img" + ending)
                self.check("p.hdr" + ending)
        for name in ("g.nii.gz", "b.nii.bz2"):
            nibabel.save(nibabel.Nifti1Image(data_of("int16"), affine), self.path(name))
            self.check(name)

    def test_mgh_of_every_orientation(self):
        for number, affine in enumerate(affines()):
            name = ("m.mgh", "m.mgz")[number % 2]
            with self.subTest(number=number):
                nibabel.save(nibabel.MGHImage(data_of("int16"), affine), self.path(name))
                self.check(name)

    def test_mgh_types(self):
        for kind in ("uint8", "int16", "int32", "float32"):
            with self.subTest(kind=kind):
                nibabel.save(nibabel.MGHImage(data_of(kind), numpy.diag((2, 3, 4, 1))), self.path("t.mgh"))
                self.check("t.mgh")

    def test_series(self):
        affine = next(itertools.islice(affines(), 21, 22))
        data = numpy.stack([data_of("int16") // (point + 1) for point in range(3)], axis=-1)
        for name, kind in (("s.nii.gz", nibabel.Nifti1Image), ("s.mgz", nibabel.MGHImage)):
            nibabel.save(kind(data, affine), self.path(name))
            for point in range(3):
                with self.subTest(name=name, point=point):
                    self.check(name, point=point)

    def test_analyze_is_left_last(self):
        for kind in (nibabel.AnalyzeImage, nibabel.Spm99AnalyzeImage, nibabel.Spm2AnalyzeImage):
            with self.subTest(kind=kind):
                affine = numpy.diag((-2.0, 2.0, 3.0, 1.0))
                nibabel.save(kind(data_of("int16"), affine), self.path("a.img"))
                if os.path.exists(self.path("a.mat")):  # of SPM, which would say more
                    os.unlink(self.path("a.mat"))
                told = self.check("a.img", sided=False)
                self.assertIn("does not say where left is", told)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
