#!/usr/bin/env python3
"""How long gazeview takes for a series of DICOM slices in JPEG 2000, and OpenJPEG alone for the same.

    apt-get install python3-pydicom python3-numpy libgdcm-tools libopenjp2-tools
    cmake --build build/release --target gazeview gazedecode
    bench/peers/load_jpeg2000.py abdomen.nrrd cranium.nrrd

Each argument is a volume of 16 bits that gazeview opens. 300 slices of 512 x 512 are made of it: where its
slices are smaller, several lie beside each other. gdcmconv compresses them without loss. Prints the bits a
pixel, the median seconds of gazeview until its first picture (64 x 64 pixels), those of its processors, and,
if opj_decompress is installed, the processor's seconds of OpenJPEG for as many slices.
"""
import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

try:
    import numpy
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
except ImportError as missing:
    print(f"skipped: {missing}; it is in the packages python3-pydicom and python3-numpy")
    sys.exit(77)

SLICES, EDGE, CT = 300, 512, "1.2.840.10008.5.1.4.1.1.2"
ROOT = "1.2.826.0.1.3680043.2.1125.20"


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volumes", nargs="+", metavar="VOLUME")
    parser.add_argument("--build", default="build/release", help="folder of the build")
    parser.add_argument("--runs", type=int, default=5, help="of gazeview; the median counts")
    return parser.parse_args()


def read_voxels(gazeview, path, folder):
    """The voxels of a volume, slices first."""
    copy = os.path.join(folder, "copy.nrrd")
    subprocess.run([gazeview, "--write-volume", copy, path], check=True, capture_output=True)
    with open(copy, "rb") as file:
        head, data = file.read().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    if fields["type"] not in ("int16", "uint16", "short", "ushort"):
        sys.exit(f"{path}: not a volume of 16 bits")
    x, y, z = (int(n) for n in fields["sizes"].split())
    return numpy.frombuffer(data, "<i2").reshape(z, y, x)


def make_slice(voxels, number):
    """Slices of the volume beside each other, cut to EDGE x EDGE."""
    across = [-(-EDGE // size) for size in voxels.shape[:0:-1]]
    rows = []
    for row in range(across[1]):
        first = number + row * across[0]
        rows.append(numpy.hstack([voxels[(first + i) % len(voxels)] for i in range(across[0])]))
    return numpy.vstack(rows)[:EDGE, :EDGE]


def write_slice(path, pixels, number):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CT
    meta.MediaStorageSOPInstanceUID = f"{ROOT}.1.{number + 1}"
    meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    meta.ImplementationClassUID = f"{ROOT}.2"
    image = FileDataset("", {}, file_meta=meta, preamble=bytes(128))
    image.is_little_endian, image.is_implicit_VR = True, False
    image.SOPClassUID, image.SOPInstanceUID = CT, meta.MediaStorageSOPInstanceUID
    image.StudyInstanceUID, image.SeriesInstanceUID = f"{ROOT}.3", f"{ROOT}.4"
    image.Modality, image.InstanceNumber = "CT", number + 1
    image.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    image.ImagePositionPatient, image.PixelSpacing = [0, 0, float(number)], [1, 1]
    image.Rows = image.Columns = EDGE
    image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
    image.BitsAllocated = image.BitsStored = 16
    image.HighBit, image.PixelRepresentation = 15, 1
    image.RescaleSlope, image.RescaleIntercept = 1, 0
    image.PixelData = pixels.tobytes()
    image.save_as(path, write_like_original=False)


def make_series(voxels, folder):
    """@return bytes of all files"""
    plain = os.path.join(folder, "plain.dcm")
    series = os.path.join(folder, "series")
    os.makedirs(series)
    for number in range(SLICES):
        write_slice(plain, make_slice(voxels, number), number)
        subprocess.run(["gdcmconv", "--j2k", plain, f"{series}/{number:03}.dcm"], check=True)
    return series, sum(entry.stat().st_size for entry in os.scandir(series))


def run_timed(command):
    """@return seconds by the clock, and of the processors"""
    before, begin_s = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (time.monotonic() - begin_s,
            after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def time_openjpeg(series, folder):
    """The processor's seconds of OpenJPEG for the series; None: it is not installed."""
    if not shutil.which("opj_decompress"):
        return None
    streams = os.path.join(folder, "streams")
    os.makedirs(streams)
    for entry in os.scandir(series):
        with open(entry.path, "rb") as file:
            data = file.read()
        with open(f"{streams}/{entry.name}.j2k", "wb") as out:
            out.write(data[data.index(b"\xff\x4f\xff\x51"):])
    return run_timed(["opj_decompress", "-ImgDir", streams, "-OutFor", "PGM"])[1]


def measure(arguments, path):
    gazeview = os.path.join(arguments.build, "view", "gazeview")
    with tempfile.TemporaryDirectory() as folder:
        series, size = make_series(read_voxels(gazeview, path, folder), folder)
        command = [gazeview, "--headless", "--backend", "cpu", "--size", "64x64", "--frames", "1",
                   "--out", f"{folder}/x.png", series]
        run_timed(command)
        times = [run_timed(command) for _ in range(arguments.runs)]
        wall_s, processors_s = (statistics.median(column) for column in zip(*times))
        print(f"{os.path.basename(path)}: {8 * size / SLICES / EDGE ** 2:.1f} bits a pixel, "
              f"{wall_s:.2f} s, {processors_s:.2f} s of the processors", end="")
        openjpeg_s = time_openjpeg(series, folder)
        print("" if openjpeg_s is None else f", OpenJPEG alone {openjpeg_s:.2f} s")


if __name__ == "__main__":
    given = read_arguments()
    for volume in given.volumes:
        measure(given, volume)
