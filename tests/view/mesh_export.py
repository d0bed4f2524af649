"""gazeview --write-mesh, run as its users run it, and its files read by other programs.

mesh_export.py GAZEVIEW COMPARE-FLYING-EDGES

Files are read here, and by VTK if python3-vtk9 is installed; then surfaces of $GAZECAST_DATA are also compared
with those of vtkFlyingEdges3D.
"""

import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest

from picture import run

GAZEVIEW, COMPARE = sys.argv[1], sys.argv[2]
LINE = re.compile(
    r"(.+) vertices (\d+) triangles (\d+) area ([\d.e+]+) mm2 volume ([\d.e+]+|-)( mm3)? euler (-?\d+) border (\d+)\n$"
)
RADIUS = 9.0
SIZES, SPACING = (14, 26, 50), (2.0, 1.0, 0.5)
HEAD = (
    "NRRD0005\ntype: short\ndimension: 3\nspace: right-anterior-superior\nsizes: {} {} {}\n"
    "space directions: ({},0,0) (0,{},0) (0,0,{})\nendian: little\nencoding: raw\n\n"
)
PEERS = (("cranium_256x256x108_int16le.raw.zst", 500), ("bonsai_256x256x256_uint8.raw.zst", 40), ("ch2.nii.gz", 60))
try:
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
except ImportError:
    vtkPLYReader = None


def ball(shift=(0, 0, 0)):
    """Tenths of mm into a ball at the centre of a volume, and its NRRD file."""
    voxels = []
    for z in range(SIZES[2]):
        for y in range(SIZES[1]):
            for x in range(SIZES[0]):
                at = [(i - (n - 1) / 2) * s for i, n, s in zip((x, y, z), SIZES, SPACING)]
                voxels.append(round(10 * (RADIUS - math.dist(at, shift))))
    return HEAD.format(*SIZES, *SPACING).encode() + struct.pack(f"<{len(voxels)}h", *voxels)


def read_ply(data):
    head, body = data.split(b"end_header\n", 1)
    assert head.startswith(b"ply\nformat binary_little_endian 1.0\n"), head
    vertices, triangles = (int(re.search(rb"element %s (\d+)" % kind, head)[1]) for kind in (b"vertex", b"face"))
    points = [struct.unpack_from("<3f", body, 24 * i) for i in range(vertices)]
    faces = [struct.unpack_from("<3i", body, 24 * vertices + 13 * i + 1) for i in range(triangles)]
    assert len(body) == 24 * vertices + 13 * triangles
    return points, faces


def read_obj(data):
    points, faces = [], []
    for line in data.decode().splitlines():
        words = line.split()
        if words[0] == "v":
            points.append(tuple(float(word) for word in words[1:]))
        elif words[0] == "f":
            faces.append(tuple(int(word.split("//")[0]) - 1 for word in words[1:]))
    return points, faces


def read_stl(data):
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count
    points = [struct.unpack_from("<3f", data, 84 + 50 * (i // 3) + 12 + 12 * (i % 3)) for i in range(3 * count)]
    return points, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)]


READERS = {"ply": read_ply, "obj": read_obj, "stl": read_stl}


def volume_of(points, faces):
    total = 0
    for a, b, c in ([points[i] for i in face] for face in faces):
        total += (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        ) / 6
    return total


class MeshExport(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-mesh-")
        self.addCleanup(self.place.cleanup)
        with open(self.path("ball.nrrd"), "wb") as out:
            out.write(ball())

    def path(self, name):
        return os.path.join(self.place.name, name)

    def export(self, name, isovalue, *more, volume="ball.nrrd"):
        return run(GAZEVIEW, self.path(volume), "--write-mesh", self.path(name), "--isovalue", isovalue, *more)

    def good(self, name, isovalue, *more):
        done = self.export(name, isovalue, *more)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(self.path(name), "rb") as source:
            return done, source.read()

    def test_scene_that_shows_an_isosurface_says_which(self):
        with open(self.path("a.scene"), "w", encoding="utf-8") as out:
            out.write("[volume]\nfile = ball.nrrd\n[transfer]\nfile = a.tf\n[render]\ntechnique = isosurface\n"
                      "[isosurface]\nisovalue = 4.5\n")
        with open(self.path("a.tf"), "w", encoding="utf-8") as out:
            out.write("0 0 0 0 0\n1 1 1 1 1\n")
        by_scene = run(GAZEVIEW, self.path("a.scene"), "--write-mesh", self.path("a.ply"))
        self.assertEqual((by_scene.returncode, by_scene.stderr), (0, ""))
        self.good("b.ply", 4.5)
        with open(self.path("a.ply"), "rb") as a, open(self.path("b.ply"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def refused(self, done, *words):
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_every_format_keeps_millimetres_and_closes_the_ball(self):
        radius = RADIUS - 0.45
        volume = 4 / 3 * math.pi * radius**3
        for ending, read in READERS.items():
            with self.subTest(ending=ending):
                done, data = self.good("ball." + ending, 4.5)
                line = LINE.match(done.stdout)
                self.assertTrue(line, done.stdout)
                self.assertEqual(line[1], self.path("ball." + ending))
                points, faces = read(data)
                self.assertEqual(len(faces), int(line[3]))
                self.assertEqual(sum(len(set(face)) == 3 for face in faces), len(faces))
                for axis in range(3):
                    values = [point[axis] for point in points]
                    self.assertAlmostEqual(max(values), radius, delta=0.15)
                    self.assertAlmostEqual(min(values), -radius, delta=0.15)
                self.assertAlmostEqual(volume_of(points, faces) / volume, 1, delta=0.02)
                self.assertAlmostEqual(float(line[5]) / volume_of(points, faces), 1, delta=1e-4)
                self.assertAlmostEqual(float(line[4]) / (4 * math.pi * radius**2), 1, delta=0.02)
                self.assertEqual((line[7], line[8]), ("2", "0"))

    def test_file_is_the_same_for_any_number_of_threads(self):
        wanted = self.good("one.ply", 4.5, "--threads", 1)[1]
        for threads in (2, 3, 7):
            self.assertEqual(self.good("more.ply", 4.5, "--threads", threads)[1], wanted)

    def test_open_surface_encloses_no_volume(self):
        done = self.good("open.ply", -40)[0]
        line = LINE.match(done.stdout)
        self.assertEqual(line[5], "-")
        self.assertGreater(int(line[8]), 0)

    def test_isovalue_outside_the_data_gives_an_empty_file_and_a_sentence(self):
        for ending, read in READERS.items():
            done = self.export("none." + ending, 1000)
            self.assertEqual(done.returncode, 0)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn("1000", done.stderr)
            self.assertIn("triangles 0", done.stdout)
            with open(self.path("none." + ending), "rb") as source:
                self.assertEqual(read(source.read()), ([], []))

    def test_mesh_that_cannot_be_written_is_refused_in_one_line(self):
        self.refused(self.export("ball.mesh", 4.5), ".ply, .obj or .stl")
        self.refused(self.export("no/ball.ply", 4.5), "no/ball.ply")
        self.refused(self.export("ball.ply", 4.5, volume="none.nrrd"), "none.nrrd")
        self.assertEqual(os.listdir(self.place.name), ["ball.nrrd"])
        run(GAZEVIEW, self.path("ball.nrrd"), "--write-volume", self.path("ball.gzb"))
        self.refused(self.export("ball.ply", 4.5, volume="ball.gzb"), "bricks")

    def test_full_disk_leaves_nothing(self):
        os.symlink("/dev/full", self.path("full.ply"))
        self.refused(self.export("full.ply", 4.5), "full.ply", "No space left")
        limited = f'trap "" XFSZ; ulimit -f 20; exec "{GAZEVIEW}" ball.nrrd --write-mesh big.obj --isovalue 4.5'
        done = subprocess.run(["sh", "-c", limited], cwd=self.place.name, capture_output=True, text=True, check=False)
        self.refused(done, "big.obj")
        self.assertEqual(sorted(os.listdir(self.place.name)), ["ball.nrrd", "full.ply"])

    def test_vtk_reads_what_was_written(self):
        if not vtkPLYReader:
            self.skipTest("no VTK; it is in the package python3-vtk9")
        for ending, reader in (("ply", vtkPLYReader()), ("obj", vtkOBJReader()), ("stl", vtkSTLReader())):
            with self.subTest(ending=ending):
                points, faces = READERS[ending](self.good("ball." + ending, 4.5)[1])
                reader.SetFileName(self.path("ball." + ending))
                reader.Update()
                read = reader.GetOutput()
                # VTK joins the equal corners of STL.
                self.assertEqual(read.GetNumberOfCells(), len(faces))
                if ending != "stl":
                    self.assertEqual(read.GetNumberOfPoints(), len(points))
                for i in range(0, len(faces), 97):
                    cell = read.GetCell(i)
                    for c in range(3):
                        at = cell.GetPoints().GetPoint(c)
                        self.assertLess(math.dist(at, points[faces[i][c]]), 1e-5)

    def test_surfaces_are_those_of_flying_edges(self):
        folder = os.path.join(os.environ.get("GAZECAST_DATA", "-"), "volumes")
        found = [(os.path.join(folder, name), value) for name, value in PEERS]
        found = [f"{path}={value}" for path, value in found if os.path.exists(path)]
        if not vtkPLYReader or not found:
            self.skipTest("needs python3-vtk9 and the volumes of GAZECAST_DATA")
        build = os.path.dirname(os.path.dirname(GAZEVIEW))
        done = run(sys.executable, "-B", COMPARE, "--build", build, "--rounds", 0, *found)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
