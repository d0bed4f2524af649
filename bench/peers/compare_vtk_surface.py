#!/usr/bin/env python3
"""Frames of a scene's isosurface by VTK's rasteriser and by gazeview, `standard` and `acuity`, in turn.

    apt-get install python3-vtk9 python3-numpy zstd xvfb xauth
    xvfb-run -a /usr/bin/python3 bench/peers/compare_vtk_surface.py SCENE

The scene has a volume, `render.technique = isosurface`, an isovalue and no clip box. VTK draws the mesh that
gazeview exports, with its vertices' normals and one light at the camera, by the OpenGL that the machine has:
without a graphics card that is Mesa's rasteriser on the processor. The camera turns by 0.01 degrees a frame.
Prints the median milliseconds of each whole frame, how many times as long VTK takes, and the share of pixels
that one side covers and the other does not. F3D draws by the same rasteriser of VTK and prints no times.
"""
import argparse
import os
import statistics
import subprocess
import tempfile

import numpy
import vtk

from compare_vtk import Scene, VtkWindow, load_volume, measure


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--backend", choices=["cpu", "gl"], default="cpu", help="gazeview's")
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--pairs", type=int, default=3, help="rounds of three frames each")
    parser.add_argument("--gazeview", default="build/release/view/gazeview")
    return parser.parse_args()


def export_mesh(arguments):
    """The surface's triangles, in mm from the centre of the volume's box."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "surface.ply")
        subprocess.run([arguments.gazeview, "--write-mesh", path, arguments.scene], check=True,
                       stdout=subprocess.DEVNULL)
        reader = vtk.vtkPLYReader()
        reader.SetFileName(path)
        reader.Update()
        return reader.GetOutput()


def make_actor(mesh, scene):
    """In our world, where the longest edge of the volume's box is 1."""
    image = load_volume(scene)
    longest = max(d * s for d, s in zip(image.GetDimensions(), image.GetSpacing()))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetScale(1 / longest)
    actor.GetProperty().SetAmbient(0.2)  # no surface is as black as the background
    return actor


def main():
    arguments = read_arguments()
    width, height = [int(side) for side in arguments.size.split("x")]
    scene, mesh = Scene(arguments.scene), export_mesh(arguments)
    peer = VtkWindow(scene, make_actor(mesh, scene), width, height)
    covered = peer.picture().any(axis=2)
    series, our_picture = measure(arguments, peer)
    print(f"{mesh.GetNumberOfPolys()} triangles, VTK {vtk.vtkVersion.GetVTKVersion()} {arguments.size}: "
          f"{statistics.median(series.peer):.1f} ms")
    print("\n".join(series.lines()))
    print(f"covered by one side only: {100 * numpy.mean(covered != our_picture.any(axis=2)):.3f} % of pixels")


if __name__ == "__main__":
    main()
