#!/usr/bin/env python3
"""Surfaces of volumes by VTK's vtkFlyingEdges3D and by Gazecast, in turn, with the same threads.

    apt-get install python3-vtk9 python3-numpy
    cmake --build build/release --target gazeview isosurface
    /usr/bin/python3 bench/peers/compare_flying_edges.py head.scene=60 cranium.nrrd=500 shells:512=90

Each argument is a volume or scene that gazeview opens, or a procedural volume and its edge in voxels, and the
isovalue. gazeview writes the volume as NRRD, which both sides read. Prints for each the median milliseconds of
both, how many times as long VTK takes, both numbers of triangles and, unless --no-distance is given, the
Hausdorff distance of the surfaces in voxels. VTK computes normals and no scalars, as Gazecast does. Exits with
1 if the surfaces differ: by more than 2 % of the triangles or .1 voxel.
"""
import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

try:
    import numpy
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
    from vtkmodules.vtkFiltersModeling import vtkHausdorffDistancePointSetFilter
    from vtkmodules.vtkIOPLY import vtkPLYReader
except ImportError as missing:
    print(f"skipped: {missing}; it is in the package python3-vtk9")
    sys.exit(77)

NRRD_TYPES = {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "float": "f4"}


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surfaces", nargs="+", metavar="VOLUME=ISOVALUE")
    parser.add_argument("--build", default="build/release", help="folder of the build")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--rounds", type=int, default=5, help="of both sides in turn; 0: compare meshes only")
    parser.add_argument("--no-distance", action="store_true")
    return parser.parse_args()


def write_nrrd(arguments, name, path):
    """The volume of a file, or a procedural one such as shells:512, as a NRRD file."""
    if ":" in name:
        kind, edge = name.split(":")
        name = path + ".scene"
        with open(name, "w", encoding="utf-8") as scene:
            scene.write(f"[volume]\nprocedural = {kind}\ndims = {edge} {edge} {edge}\n")
    gazeview = os.path.join(arguments.build, "view/gazeview")
    subprocess.run([gazeview, name, "--write-volume", path], check=True)


def read_image(path):
    """A raw NRRD as gazeview writes it, in Gazecast's frame of meshes: mm, centred."""
    with open(path, "rb") as source:
        data = source.read()
    end = data.index(b"\n\n") + 2
    fields = dict(line.split(": ", 1) for line in data[:end].decode().splitlines()[1:] if ": " in line)
    sizes = [int(size) for size in fields["sizes"].split()]
    kind = ("<" if fields.get("endian", "little") == "little" else ">") + NRRD_TYPES[fields["type"]]
    # a spacing that is not known is not stated, and taken as 1
    directions = fields.get("space directions", "(1,0,0) (0,1,0) (0,0,1)")
    vectors = [vector.strip("()").split(",") for vector in directions.split()]
    spacing = [max(abs(float(number)) for number in vector) for vector in vectors]
    image = vtkImageData()
    image.SetDimensions(*sizes)
    image.SetSpacing(*spacing)
    image.SetOrigin(*[-(size - 1) * step / 2 for size, step in zip(sizes, spacing)])
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(numpy.frombuffer(data, kind, offset=end), deep=1))
    return image


def peer_filter(image, isovalue):
    peer = vtkFlyingEdges3D()
    peer.SetInputData(image)
    peer.SetValue(0, isovalue)
    peer.ComputeNormalsOn()
    peer.ComputeScalarsOff()
    peer.ComputeGradientsOff()
    return peer


def peer_ms(peer):
    peer.Modified()
    start = time.perf_counter()
    peer.Update()
    return (time.perf_counter() - start) * 1e3


def our_lines(arguments, path, isovalue, runs):
    """What the probe says of each way: plain, and with the ranges of macrocells."""
    probe = os.path.join(arguments.build, "bench/probes/isosurface")
    done = subprocess.run([probe, path, isovalue, str(arguments.threads), str(runs)], check=True,
                          stdout=subprocess.PIPE, text=True)
    lines = {}
    for line in done.stdout.splitlines():
        words = line.split()
        lines[words[0]] = dict(zip(words[1::2], words[2::2]))
    return lines


def measure(arguments, path, isovalue, peer):
    theirs, ours = [], {"plain": [], "blocks": []}
    peer_ms(peer)
    for _ in range(arguments.rounds):
        theirs += [peer_ms(peer) for _ in range(5)]
        for way, said in our_lines(arguments, path, isovalue, 5).items():
            ours[way].append(float(said["median_ms"]))
    theirs = statistics.median(theirs)
    for way, times in ours.items():
        mine = statistics.median(times)
        print(f"  vtk {theirs:.1f} ms, gazecast {way} {mine:.1f} ms, ratio {theirs / mine:.2f}")


def our_mesh(arguments, volume, isovalue, path):
    subprocess.run([os.path.join(arguments.build, "view/gazeview"), volume, "--write-mesh", path, "--isovalue",
                    isovalue, "--threads", str(arguments.threads)], check=True, stdout=subprocess.DEVNULL)
    reader = vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def distance(ours, theirs):
    """Hausdorff distance of the vertices, mm. Triangles are not nearer: VTK 9.1's distance to them is wrong."""
    between = vtkHausdorffDistancePointSetFilter()
    between.SetInputData(0, ours)
    between.SetInputData(1, theirs)
    between.SetTargetDistanceMethodToPointToPoint()
    between.Update()
    return between.GetHausdorffDistance()


def compare(arguments, name, isovalue, folder):
    """Whether both surfaces are the same."""
    path = os.path.join(folder, "volume.nrrd")
    write_nrrd(arguments, name, path)
    image = read_image(path)
    peer = peer_filter(image, float(isovalue))
    peer.Update()
    print(f"{name} at {isovalue}")
    if arguments.rounds:
        measure(arguments, path, isovalue, peer)
    theirs = peer.GetOutput()
    ours = our_mesh(arguments, path, isovalue, os.path.join(folder, "ours.ply"))
    more = ours.GetNumberOfCells() / max(1, theirs.GetNumberOfCells()) - 1
    print(f"  triangles: vtk {theirs.GetNumberOfCells()}, gazecast {ours.GetNumberOfCells()} ({100 * more:+.3f} %)")
    same = abs(more) <= 0.02
    if not arguments.no_distance:
        voxels = distance(ours, theirs) / min(image.GetSpacing())
        print(f"  hausdorff distance {voxels:.2g} voxels")
        same = same and voxels < 0.1
    return same


def main():
    arguments = read_arguments()
    vtkSMPTools.Initialize(arguments.threads)
    print(f"VTK {vtkVersion.GetVTKVersion()}, {vtkSMPTools.GetBackend()}, {arguments.threads} threads")
    same = True
    for surface in arguments.surfaces:
        name, isovalue = surface.rsplit("=", 1)
        with tempfile.TemporaryDirectory(prefix="gazecast-surfaces-") as folder:
            same = compare(arguments, name, isovalue, folder) and same
    sys.exit(0 if same else 1)


if __name__ == "__main__":
    main()
