"""MINC 2 files as gazeview reads them, compared with an independent reader: nibabel with h5py.

minc.py GAZEVIEW

h5py writes the files. Exits 77 if nibabel or h5py is not installed, or gazeview was built without
HDF5.
"""

import itertools
import os
import sys
import unittest

try:
    import h5py
    import nibabel
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}; it is in the packages python3-nibabel and python3-h5py")
    sys.exit(77)

from picture import run, shows_between
from raw_nrrd import read_nrrd
from volumes import GAZEVIEW, SHAPE, SPACING, AgainstNibabel, data_of

SPACE = ("xspace", "yspace", "zspace")
TURN = numpy.radians(20)
COSINES = {
    "xspace": (numpy.cos(TURN), numpy.sin(TURN), 0),
    "yspace": (-numpy.sin(TURN), numpy.cos(TURN), 0),
    "zspace": (0, 0, 1),
}


def write_minc(path, values, names, steps=None, cosines=None, valid=None, scales=(0, 1), units=None, **storage):
    """A file whose image has `values`, axes of these names, the slowest first."""
    if os.path.exists(path):  # nibabel may have it open
        os.unlink(path)
    with h5py.File(path, "w") as out:
        for name, size in zip(names, values.shape):
            axis = out.require_dataset("minc-2.0/dimensions/" + name, (), "i4")
            axis.attrs["length"] = numpy.uint32(size)
            axis.attrs["spacing"] = numpy.bytes_("regular__")
            axis.attrs["start"] = -17.5
            if units:
                axis.attrs["units"] = numpy.bytes_(units)
            if steps and name in steps:
                axis.attrs["step"] = float(steps[name])
            if cosines and name in cosines:
                axis.attrs["direction_cosines"] = numpy.array(cosines[name], "f8")
        image = out.create_dataset("minc-2.0/image/0/image", data=values, **storage)
        image.attrs["dimorder"] = numpy.bytes_(",".join(names))
        if valid:
            image.attrs["valid_range"] = numpy.array(valid, "f8")
        for name, numbers in zip(("image-min", "image-max"), scales or ()):
            scale = out.create_dataset("minc-2.0/image/0/" + name, data=numpy.asarray(numbers, "f8"))
            if scale.ndim:
                scale.attrs["dimorder"] = numpy.bytes_(",".join(names[: scale.ndim]))


class Minc(AgainstNibabel):
    def test_every_order_and_sign_of_axes(self):
        steps = dict(zip(SPACE, SPACING))
        for names in itertools.permutations(SPACE):
            for signs in itertools.product((1, -1), repeat=3):
                with self.subTest(names=names, signs=signs):
                    turned = {name: sign * steps[name] for name, sign in zip(SPACE, signs)}
                    write_minc(self.path("o.mnc"), data_of("int16"), names, turned, scales=(-32768, 32767))
                    self.check("o.mnc")

    def test_direction_cosines(self):
        for number, signs in enumerate(itertools.product((1, -1), repeat=3)):
            with self.subTest(signs=signs):
                steps = {name: sign * 1.25 for name, sign in zip(SPACE, signs)}
                names = list(itertools.permutations(SPACE))[number % 6]
                write_minc(self.path("c.mnc"), data_of("uint8"), names, steps, COSINES)
                self.check("c.mnc")

    def test_what_is_left_out_is_one(self):
        write_minc(self.path("d.mnc"), data_of("uint8"), SPACE[::-1])
        self.check("d.mnc")

    def test_units_of_length(self):
        steps = dict(zip(SPACE, SPACING))
        for units, factor, told in (("mm", 1, ""), ("um", 1e-3, "are in um; converted"), ("m", 1000, "are in m;"),
                                    ("ell", 1, '"ell" is unknown; taken as mm')):
            with self.subTest(units=units):
                write_minc(self.path("u.mnc"), data_of("int16"), SPACE[::-1], steps, units=units)
                done = run(GAZEVIEW, self.path("u.mnc"), "--write-volume", self.path("read.nrrd"))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(told, done.stderr)
                spacing = read_nrrd(self.path("read.nrrd"))[1]
                self.assertLess(abs(numpy.array(spacing) / factor - SPACING).max(), 1e-9)

    def test_types(self):
        names = SPACE[::-1]
        for kind in ("u1", "i1", "<u2", ">u2", "<i2", ">i2", "<u4", "<i4", ">i4", "<f4", ">f4", "<f8"):
            for scales in ((0, 1), (-5.5, 1000.25)):
                with self.subTest(kind=kind, scales=scales):
                    values = data_of(kind)
                    write_minc(self.path("t.mnc"), values, names, scales=scales)
                    self.check("t.mnc")

    def test_real_ranges_of_slices_and_rows(self):
        names = SPACE[::-1]
        random = numpy.random.default_rng(3)
        for kind, valid in (("uint8", None), ("int16", (-2048, 2047)), ("uint16", (0, 4095)), ("int32", None)):
            values = data_of(kind)
            for rank in (1, 2):
                with self.subTest(kind=kind, rank=rank):
                    least = random.uniform(-100, 0, SHAPE[:rank])
                    scales = (least, least + random.uniform(1, 500, SHAPE[:rank]))
                    write_minc(self.path("s.mnc"), values, names, valid=valid, scales=scales)
                    self.check("s.mnc")

    def test_numbers_outside_the_valid_range_are_at_its_ends(self):
        for kind in ("uint8", "int8", "uint16", "int16"):
            with self.subTest(kind=kind):
                write_minc(self.path("v.mnc"), data_of(kind), SPACE, valid=(10, 101), scales=(0, 7))
                self.check("v.mnc")

    def test_slice_of_one_value(self):
        least = numpy.array([1.0, 5.0, -3.0, 4.0, 2.0])
        write_minc(self.path("f.mnc"), data_of("uint8"), SPACE, scales=(least, least + (0, 1, 0, 2, 3)))
        self.check("f.mnc")

    def test_chunks_and_compression(self):
        for number, storage in enumerate((
            {"chunks": (2, 3, 2)},
            {"chunks": (5, 4, 3), "compression": "gzip"},
            {"chunks": (1, 4, 3), "compression": "gzip", "shuffle": True, "fletcher32": True},
        )):
            with self.subTest(storage=storage):
                write_minc(self.path("z.mnc"), data_of("int16"), SPACE[::-1], {"xspace": -2}, **storage)
                self.check("z.mnc")

    def test_time_points_wherever_the_axis_is(self):
        space = list(SPACE[::-1])
        for at in range(4):
            names = space[:at] + ["time"] + space[at:]
            series = numpy.stack([data_of("int16") // (point + 1) for point in range(3)], axis=at)
            scales = [numpy.linspace(a, b, series.shape[0]) for a, b in ((-9, 0), (50, 900))]
            for scale in ((-32768, 32767), scales):
                write_minc(self.path("time.mnc"), series, names, {"yspace": -3}, scales=scale)
                read = nibabel.load(self.path("time.mnc"))
                for point in range(3):
                    with self.subTest(at=at, point=point):
                        values = numpy.take(numpy.asarray(read.dataobj, "f8"), point, axis=at)
                        self.check("time.mnc", point=point, image=nibabel.Nifti1Image(values, read.affine))

    def test_axis_of_one_number_a_voxel_is_passed_over(self):
        write_minc(self.path("one.mnc"), data_of("uint8")[..., None], (*SPACE[::-1], "vector_dimension"))
        plain = self.path("plain.mnc")
        write_minc(plain, data_of("uint8"), SPACE[::-1])
        self.check("one.mnc", image=nibabel.load(plain))

    def check_values(self, name, values):
        affine = numpy.eye(4)[[2, 1, 0, 3]]  # axes z, y, x
        self.check(name, image=nibabel.Nifti1Image(values.astype("f8"), affine))

    def test_labels_are_their_numbers(self):
        labels = (data_of("uint8") % 7).astype("uint8")
        kind = h5py.enum_dtype({f"region{i}": i for i in range(7)}, basetype="u1")
        write_minc(self.path("e.mnc"), labels, SPACE[::-1], dtype=kind)
        self.check_values("e.mnc", labels)
        write_minc(self.path("l.mnc"), labels, SPACE[::-1])
        with h5py.File(self.path("l.mnc"), "a") as out:
            out["minc-2.0"].attrs["class"] = "label__"  # of variable length
        self.check_values("l.mnc", labels)

    def test_nothing_lies_between_labels(self):
        labels = numpy.zeros((12, 10, 8), "uint8")
        labels[2:6, 2:8, 2:6], labels[6:10, 2:8, 2:6] = 1, 3
        write_minc(self.path("n.mnc"), labels, SPACE[::-1], scales=None)
        self.assertTrue(shows_between(GAZEVIEW, self.path("n.mnc"), 2))
        with h5py.File(self.path("n.mnc"), "a") as out:
            out["minc-2.0"].attrs["class"] = "label__"
        self.assertFalse(shows_between(GAZEVIEW, self.path("n.mnc"), 2))
        self.assertTrue(shows_between(GAZEVIEW, self.path("n.mnc"), 3))

    def test_numbers_without_a_real_range_are_values(self):
        write_minc(self.path("n.mnc"), data_of("int16"), SPACE[::-1], scales=None)
        self.check_values("n.mnc", data_of("int16"))

    def refused(self, name, words):
        done = run(GAZEVIEW, self.path(name), "--write-volume", self.path("none.nrrd"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(words, done.stderr)
        self.assertFalse(os.path.exists(self.path("none.nrrd")))

    def test_what_is_not_read_is_said(self):
        names = SPACE[::-1]
        write_minc(self.path("r.mnc"), data_of("int16"), names)
        with h5py.File(self.path("r.mnc"), "a") as out:
            out["minc-2.0/dimensions/yspace"].attrs["spacing"] = numpy.bytes_("irregular")
        self.refused("r.mnc", "yspace is sampled at irregular places")
        write_minc(self.path("v.mnc"), numpy.zeros((3, 3, 3, 3), "u1"), (*names, "vector_dimension"))
        self.refused("v.mnc", "3 numbers along vector_dimension")
        write_minc(self.path("w.mnc"), numpy.zeros((3, 3, 3), "i8"), names)
        self.refused("w.mnc", "voxels of this type")
        write_minc(self.path("d.mnc"), numpy.zeros((3, 3, 3), "u1"), ("xspace", "yspace", "yspace"))
        self.refused("d.mnc", "3 numbers along yspace")
        write_minc(self.path("f.mnc"), data_of("int16"), names, valid=(7, 7))
        self.refused("f.mnc", "valid range, 7 to 7")
        write_minc(self.path("s.mnc"), data_of("int16"), names, scales=(numpy.zeros(9), numpy.ones(9)))
        self.refused("s.mnc", "do not run along the first axes")
        with h5py.File(self.path("h.h5"), "w") as out:
            out["other"] = [1, 2, 3]
        self.refused("h.h5", "no MINC 2")

    def test_other_files_are_not_opened(self):
        names = SPACE[::-1]
        write_minc(self.path("whole.mnc"), data_of("uint8"), names)
        data_of("uint8").tofile(self.path("raw"))
        for kind in ("link", "external", "virtual"):
            with self.subTest(kind=kind), h5py.File(self.path(kind + ".mnc"), "w") as out:
                place = "minc-2.0/image/0/image"
                if kind == "link":
                    out[place] = h5py.ExternalLink("whole.mnc", place)
                elif kind == "external":
                    out.create_dataset(place, SHAPE, "u1", external=[(self.path("raw"), 0, 60)])
                else:
                    layout = h5py.VirtualLayout(SHAPE, "u1")
                    layout[...] = h5py.VirtualSource(self.path("whole.mnc"), place, SHAPE)
                    out.create_virtual_dataset(place, layout)
                if kind != "link":
                    out[place].attrs["dimorder"] = numpy.bytes_(",".join(names))
            self.refused(kind + ".mnc", "no MINC 2" if kind == "link" else "other files, which are not opened")

    def test_damaged_files_are_read_or_refused_with_a_line(self):
        write_minc(self.path("whole.mnc"), data_of("int16"), SPACE[::-1], chunks=(2, 2, 3), compression="gzip")
        with open(self.path("whole.mnc"), "rb") as source:
            whole = source.read()
        random = numpy.random.default_rng(5)
        for number in range(40):
            changed = bytearray(whole)
            if number % 4 == 0:
                del changed[int(random.integers(9, len(whole))) :]
            else:
                changed[int(random.integers(8, len(whole)))] ^= int(random.integers(1, 256))
            with self.subTest(number=number):
                with open(self.path("changed.mnc"), "wb") as out:
                    out.write(changed)
                done = run(GAZEVIEW, self.path("changed.mnc"), "--write-volume", self.path("none.nrrd"))
                self.assertIn(done.returncode, (0, 1))
                self.assertIn("changed.mnc", done.stderr + self.path("changed.mnc") * (done.returncode == 0))


def skip_without_hdf5():
    case = Minc()
    case.setUp()
    write_minc(case.path("any.mnc"), data_of("uint8"), SPACE)
    done = run(GAZEVIEW, case.path("any.mnc"), "--write-volume", case.path("any.nrrd"))
    case.doCleanups()
    if "made without HDF5" in done.stderr:
        print("skipped: gazeview was built without HDF5, which is in the package libhdf5-dev")
        sys.exit(77)


if __name__ == "__main__":
    skip_without_hdf5()
    del AgainstNibabel
    unittest.main(argv=sys.argv[:1], verbosity=1, warnings="ignore")
