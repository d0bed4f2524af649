"""Files of particles, shown and written as their users do it: by gazeview.

particles.py GAZEVIEW

A cube of liquid at rest is written in several formats. Its volume is 1 inside, and its surface encloses what
the particles fill, whatever the format. Nothing but Python is needed.
"""

import array
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest

from picture import PATIENCE_S

GAZEVIEW = sys.argv[1]
EDGE, DISTANCE = 14, 0.05
LINE = re.compile(r".+ vertices (\d+) triangles (\d+) area \S+ mm2 volume (\S+) mm3 euler (-?\d+) border 0\n$")


def cube(shift=0.0, distance=DISTANCE):
    cells = range(EDGE)
    return [(shift + distance * x, distance * y, distance * z) for z in cells for y in cells for x in cells]


def xyz(points):
    return "".join("{:.9g} {:.9g} {:.9g}\n".format(*point) for point in points).encode()


def vtk(points):
    head = "# vtk DataFile Version 3.0\ncube\nBINARY\nDATASET POLYDATA\nPOINTS {} double\n".format(len(points))
    return head.encode() + b"".join(struct.pack(">3d", *point) for point in points) + b"\n"


def liquid(steps):
    body = b"".join(struct.pack("<11f", *point, *8 * (0,)) for points in steps for point in points)
    return struct.pack("<II", len(steps), len(steps[0])) + body


class Particles(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as out:
            out.write(data)
        return self.path(name)

    def run_gazeview(self, *arguments, status=0):
        done = subprocess.run([GAZEVIEW, *arguments], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def voxels(self, *arguments):
        """The data of a volume that gazeview writes, and its sizes."""
        out = self.path("out.nrrd")
        self.run_gazeview(*arguments, "--write-volume", out)
        with open(out, "rb") as source:
            head, data = source.read().split(b"\n\n", 1)
        fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
        self.assertEqual(fields["type"], "float")
        values = array.array("f", data)
        if (fields["endian"] == "big") != (sys.byteorder == "big"):
            values.byteswap()
        return values, [int(size) for size in fields["sizes"].split()]

    def test_a_surface_encloses_the_liquid(self):
        for name, data in (("a.xyz", xyz(cube())), ("a.vtk", vtk(cube(1000.0))), ("unnamed", vtk(cube()))):
            path = self.write(name, data)
            mesh = ("--write-mesh", self.path("a.ply"), "--isovalue", "0.5")
            done = self.run_gazeview(path, "--particles.cells", "64", *mesh)
            vertices, triangles, volume, euler = LINE.match(done.stdout).groups()
            self.assertEqual(int(euler), 2, done.stdout)
            self.assertEqual(int(triangles), 2 * int(vertices) - 4)
            self.assertAlmostEqual(float(volume), (DISTANCE * EDGE) ** 3, delta=0.12 * (DISTANCE * EDGE) ** 3)

    def test_a_liquid_at_rest_is_1_inside(self):
        path = self.write("a.xyz", xyz(cube()))
        for grid in ("sph", "nearest"):
            values, sizes = self.voxels(path, "--particles.cells", "48", "--particles.grid", grid)
            self.assertEqual(sizes, [48, 48, 48])
            middle = values[48 * (48 * 24 + 24) + 24]
            self.assertAlmostEqual(middle, 1, delta=0.01)
            self.assertEqual(values[0], 0)

    def test_time_steps_differ_on_one_grid(self):
        path = self.write("a.particles", liquid([cube(), cube(distance=DISTANCE / 2)]))
        first, sizes = self.voxels(path, "--particles.cells", "48")
        second, same = self.voxels(path, "--particles.cells", "48", "--time-point", "2")
        self.assertEqual(sizes, same)
        self.assertGreater(sum(first), 4 * sum(second))
        done = self.run_gazeview(path, "--time-point", "3", "--write-volume", self.path("b.nrrd"), status=1)
        self.assertIn("has no time point 3; it has 2", done.stderr)

    def test_numbered_files_are_one_series(self):
        self.write("b_09.xyz", xyz(cube()))
        self.write("b_10.xyz", xyz(cube(shift=0.3)))
        first, sizes = self.voxels(self.path("b_09.xyz"), "--particles.cells", "48")
        second, same = self.voxels(self.path("b_%02d.xyz"), "--particles.cells", "48", "--time-point", "2")
        alone, _ = self.voxels(self.path("b_10.xyz"), "--particles.cells", "48")
        self.assertEqual(sizes, same)
        self.assertNotEqual(first, second)
        self.assertGreater(sum(alone), 1.2 * sum(second))  # its box is smaller, its voxels are more
        scene = self.write("b.scene", b"[volume]\nfile = b_%d.xyz\ntime_point = 2\n[particles]\ncells = 48\n")
        self.assertEqual(self.voxels("--scene", scene)[0], second)
        done = self.run_gazeview(self.path("b_09.xyz"), "--time-point", "3", "--write-volume", self.path("c.nrrd"),
                                 status=1)
        self.assertIn("has no time point 3; the series has 2", done.stderr)
        pictures = self.path("p%d.png")
        self.run_gazeview("--headless", self.path("b_%d.xyz"), "--play", "10", "--frames", "2", "--fps", "10",
                          "--size", "32x32", "--out", pictures)
        with open(pictures % 0, "rb") as one, open(pictures % 1, "rb") as other:
            self.assertNotEqual(one.read(), other.read())

    def test_one_line_refuses_a_lie(self):
        data = bytearray(liquid([cube()]))
        data[4:8] = b"\xff" * 4
        path = self.write("a.particles", data)
        done = self.run_gazeview("--headless", "--scene", path, "--out", self.path("a.png"), status=1)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("announces 4294967295 particles", done.stderr)

    def test_formats_and_keys_are_told(self):
        formats = self.run_gazeview("--formats").stdout
        for ending in (".particles", ".bgeo", ".vtk", ".ply", ".xyz"):
            self.assertIn(ending, formats)
        self.assertIn("--particles.grid", self.run_gazeview("--help").stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
