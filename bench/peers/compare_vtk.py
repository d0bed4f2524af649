#!/usr/bin/env python3
"""Frames of a scene by VTK's ray casters and by gazeview, `standard` and `acuity`, in turn.

    apt-get install python3-vtk9 python3-numpy zstd xvfb xauth
    xvfb-run -a /usr/bin/python3 bench/peers/compare_vtk.py etc/scenes/study/head.scene
    xvfb-run -a /usr/bin/python3 bench/peers/compare_vtk.py etc/scenes/study/head.scene --vtk gpu --backend gl
    xvfb-run -a /usr/bin/python3 bench/peers/compare_vtk.py etc/scenes/study/head.scene --simd avx2 --lit

VTK and `standard` cast one ray a pixel at the scene's sampling rate without shading or, with --lit, with the scene's
light, while the camera turns by 0.01 degrees a frame, so that nothing is reused; `acuity` does so with the gaze at
the object's centre and at four places around it. The scene's clip box, pre-integration, occlusion and shadows are
left out. Prints the median milliseconds of each whole frame, how many times as long VTK takes, and
the peak signal-to-noise ratio between the pictures of VTK and `standard` of the scene's own camera. VTK knows
no orientation and puts the box between the outer voxel centres, so pictures of oriented volumes differ by that.
"""
import argparse
import configparser
import math
import os
import statistics
import subprocess
import tempfile
import time

import numpy
import vtk
from vtk.util import numpy_support

from gazeview_frames import GAZES, Series, run_gazeview

NUMPY_TYPES = {"uint8": "u1", "int8": "i1", "uint16": "u2", "int16": "i2", "uint32": "u4", "int32": "i4",
               "float32": "f4", "float64": "f8"}


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--vtk", choices=["cpu", "gpu"], default="cpu", help="VTK's ray caster")
    parser.add_argument("--backend", choices=["cpu", "gl"], default="cpu", help="gazeview's")
    parser.add_argument("--simd", default="auto", help="instruction set of gazeview's cpu backend")
    parser.add_argument("--lit", action="store_true", help="with the light of the scene")
    parser.add_argument("--size", default="1024x1024")
    parser.add_argument("--pairs", type=int, default=3, help="rounds of three frames each")
    parser.add_argument("--gazeview", default="build/release/view/gazeview")
    return parser.parse_args()


class Scene:
    """The keys of a .scene that both programs understand."""

    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        self.keys = configparser.ConfigParser(inline_comment_prefixes=(";",))
        self.keys.read(path)

    def text(self, section, key, default=None):
        return self.keys.get(section, key, fallback=default)

    def numbers(self, section, key, default):
        return [float(word) for word in self.text(section, key, default).split()]

    def file(self, section):
        name = self.text(section, "file")
        for folder in (self.folder, os.environ.get("GAZECAST_DATA", "")):
            path = os.path.join(folder, name)
            if os.path.exists(path):
                return path
        raise SystemExit(f"{name}: neither beside the scene nor under GAZECAST_DATA")


def load_raw(scene, path):
    read = subprocess.run(["zstd", "-dcq", path], check=True, stdout=subprocess.PIPE).stdout \
        if path.endswith(".zst") else open(path, "rb").read()
    order = ">" if scene.text("volume", "endian", "little") == "big" else "<"
    kind = NUMPY_TYPES[scene.text("volume", "type")]
    voxels = numpy.frombuffer(read, dtype=order + kind).astype(kind)
    image = vtk.vtkImageData()
    image.SetDimensions(*[int(n) for n in scene.text("volume", "dims").split()])
    image.SetSpacing(*scene.numbers("volume", "spacing", "1 1 1"))
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(voxels, deep=1))
    return image


def load_volume(scene):
    path = scene.file("volume")
    if scene.text("volume", "dims"):
        return load_raw(scene, path)
    readers = {".nii": vtk.vtkNIFTIImageReader, ".nii.gz": vtk.vtkNIFTIImageReader, ".nrrd": vtk.vtkNrrdReader,
               ".mhd": vtk.vtkMetaImageReader, ".mha": vtk.vtkMetaImageReader}
    reader = next(make for ending, make in readers.items() if path.endswith(ending))()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def place_volume(image):
    """Our world: the longest edge is 1, the box is centred. Returns the voxel length."""
    dims, spacing = image.GetDimensions(), image.GetSpacing()
    longest = max(d * s for d, s in zip(dims, spacing))
    image.SetSpacing(*[s / longest for s in spacing])
    image.SetOrigin(*[-(d - 1) * s / longest / 2 for d, s in zip(dims, spacing)])
    return min(spacing) / longest


def light_look(scene, look):
    """The surfaces of gazeview's [light], by its presets where the scene says nothing."""
    look.ShadeOn()
    look.SetAmbient(float(scene.text("light", "ambient", "0.35")))
    look.SetDiffuse(float(scene.text("light", "diffuse", "0.65")))
    look.SetSpecular(float(scene.text("light", "specular", "0.25")))
    look.SetSpecularPower(float(scene.text("light", "shininess", "24")))


def scene_light(scene):
    """The distant light of the scene. A camera light's place is counted from the viewer's axes, as is ours."""
    light = vtk.vtkLight()
    if scene.text("light", "frame", "camera") == "camera":
        light.SetLightTypeToCameraLight()
    else:
        light.SetLightTypeToSceneLight()
    light.PositionalOff()
    light.SetPosition(*scene.numbers("light", "direction", "-0.3 0.5 1"))
    light.SetFocalPoint(0, 0, 0)
    return light


def load_transfer(scene, image, voxel, lit=False):
    low, high = image.GetScalarRange()
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for line in open(scene.file("transfer"), encoding="utf-8"):
        words = line.split("#")[0].split()
        if words and words[0] == "range":
            low, high = float(words[1]), float(words[2])
        elif words and words[0] != "interpolation":
            value, red, green, blue, alpha = [float(word) for word in words]
            colour.AddRGBPoint(low + value * (high - low), red, green, blue)
            opacity.AddPoint(low + value * (high - low), alpha)
    look = vtk.vtkVolumeProperty()
    look.SetColor(colour)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(voxel)
    look.SetInterpolationTypeToLinear()
    look.ShadeOff()
    if lit:
        light_look(scene, look)
    return look


def make_mapper(kind, image, step):
    if kind == "cpu":
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetNumberOfThreads(os.cpu_count())
    else:
        mapper = vtk.vtkGPUVolumeRayCastMapper()
        mapper.UseJitteringOff()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.SetSampleDistance(step)
    mapper.SetImageSampleDistance(1)
    return mapper


def make_volume(scene, kind, lit=False):
    image = load_volume(scene)
    voxel = place_volume(image)
    volume = vtk.vtkVolume()
    step = voxel / float(scene.text("render", "ray_sampling_rate", "1.5"))
    volume.SetMapper(make_mapper(kind, image, step))
    volume.SetProperty(load_transfer(scene, image, voxel, lit))
    return volume


class VtkWindow:
    """What is shown, in our world, seen by the scene's camera."""

    def __init__(self, scene, shown, width, height, lit=False):
        renderer = vtk.vtkRenderer()
        if lit:
            renderer.AutomaticLightCreationOff()
            renderer.AddLight(scene_light(scene))
        renderer.AddViewProp(shown)
        renderer.SetBackground(*scene.numbers("render", "background", "0 0 0"))
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(width, height)
        self.window.AddRenderer(renderer)
        self.camera = renderer.GetActiveCamera()
        self.camera.SetPosition(*scene.numbers("camera", "eye", "0 -2 0"))
        self.camera.SetFocalPoint(*scene.numbers("camera", "look_at", "0 0 0"))
        self.camera.SetViewUp(*scene.numbers("camera", "up", "0 0 1"))
        self.camera.SetViewAngle(float(scene.text("camera", "fov_deg", "40")))
        renderer.ResetCameraClippingRange()

    def picture(self):
        self.window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        return pixels_of(grab.GetOutput())

    def frame_ms(self):
        self.camera.Azimuth(0.01)
        probe = vtk.vtkUnsignedCharArray()
        start = time.perf_counter()
        self.window.Render()
        self.window.GetPixelData(0, 0, 1, 1, 1, probe, 0)
        return (time.perf_counter() - start) * 1e3


def pixels_of(image):
    width, height, _ = image.GetDimensions()
    flat = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars())
    return flat.reshape(height, width, -1)[::-1, :, :3].astype(float)


def read_picture(path):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return pixels_of(reader.GetOutput())


def volume_options(lit, simd):
    """gazeview's, so that it draws what VTK draws."""
    return ["--simd", simd, "--render.shading", "gradient" if lit else "none", "--render.integration", "sampled",
            "--light.occlusion", "0", "--light.shadow_steps", "0", "--clip.least", "0 0 0", "--clip.greatest", "1 1 1"]


def gazeview(arguments, method, gaze):
    """Times of three frames, and the picture of the scene's own camera. Arguments: gazeview, scene, size,
    backend and, for volumes, options."""
    with tempfile.TemporaryDirectory() as folder:
        times, path = run_gazeview(arguments.gazeview, arguments.scene, arguments.size, arguments.backend, method,
                                   gaze, 4, folder, getattr(arguments, "options", ()))
        return times, read_picture(path)


def measure(arguments, peer):
    """All sides in turn, as often as arguments.pairs says, and the last picture of `standard`."""
    series = Series()
    for _ in range(arguments.pairs):
        series.peer += [peer.frame_ms() for _ in range(3)]
        times, picture = gazeview(arguments, "standard", "centre")
        series.standard += times
        for gaze in GAZES:
            series.acuity[gaze] += gazeview(arguments, "acuity", gaze)[0]
    return series, picture


def psnr_db(ours, theirs):
    error = numpy.mean((ours - theirs) ** 2)
    return 10 * math.log10(255 ** 2 / error) if error else math.inf


def main():
    arguments = read_arguments()
    arguments.options = volume_options(arguments.lit, arguments.simd)
    width, height = [int(side) for side in arguments.size.split("x")]
    scene = Scene(arguments.scene)
    peer = VtkWindow(scene, make_volume(scene, arguments.vtk, arguments.lit), width, height, arguments.lit)
    their_picture = peer.picture()
    series, our_picture = measure(arguments, peer)
    print(f"VTK {vtk.vtkVersion.GetVTKVersion()} {arguments.vtk} {arguments.size}: "
          f"{statistics.median(series.peer):.1f} ms")
    print("\n".join(series.lines()))
    print(f"psnr_db {psnr_db(our_picture, their_picture):.2f}")


if __name__ == "__main__":
    main()
