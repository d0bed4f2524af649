#!/usr/bin/env python3
"""The bonsai of Bauer 2018 with his own cameras, transfer functions and gaze path.

    GAZECAST_DATA=... /usr/bin/python3 bench/peers/bauer2018.py [--methods acuity] [--every 1] [--write FOLDER]

Reads $GAZECAST_DATA/bauer2018 (path.csv, cameras.csv, summary.csv, transfer/), which stays out of this repository
because its authors state no licence. Writes the scenes of his four measurements of the bonsai, runs gazebench
along his path at his 2263x1306 and prints, for each, the median times of whole frames of `standard` and of each
method, their ratio, and beside them what he measured on an R9 390: kernel and whole frame, with and without
foveation. --write keeps the scenes and the studies.
"""
import argparse
import csv
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 2263, 1306

# His measurement, and its transfer function.
SETS = {"first/bonsai/tf0": "bonsai-standard", "first/bonsai/tf1": "bonsai-bonsai_1",
        "first/bonsai/tf2": "bonsai-bonsai_2", "second/Bonsai": "Bonsai-bonsai"}


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--methods", default="acuity", help="of gazebench run, beside standard")
    parser.add_argument("--every", type=int, default=1, help="take one of so many places")
    parser.add_argument("--write", help="folder for scenes and studies; made if missing")
    parser.add_argument("--size", default=f"{WIDTH}x{HEIGHT}")
    parser.add_argument("--build", default="build/release", help="folder of the build")
    return parser.parse_args()


def read_rows(data, name):
    with open(os.path.join(data, name), encoding="utf-8") as source:
        return list(csv.DictReader(source))


def rotate(quaternion, vector):
    """v + 2 w (q x v) + 2 q x (q x v) for the unit quaternion (q, w)."""
    *q, w = quaternion
    length = math.sqrt(sum(part * part for part in quaternion))
    q, w = [part / length for part in q], w / length
    once = cross(q, vector)
    twice = cross(q, once)
    return [v + 2 * (w * a + b) for v, a, b in zip(vector, once, twice)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def camera_lines(row):
    """His box goes from -1 to 1 along the longest edge, ours from -1/2 to 1/2; his picture is 90 degrees wide."""
    quaternion = [float(row[key]) for key in ("qx", "qy", "qz", "qw")]
    eye = [part / 2 for part in rotate(quaternion, [float(row[key]) for key in ("tx", "ty", "tz")])]
    ahead, up = rotate(quaternion, [0, 0, -1]), rotate(quaternion, [0, 1, 0])
    vectors = {"eye": eye, "look_at": [e + a for e, a in zip(eye, ahead)], "up": up}
    lines = [f"{name} = " + " ".join(f"{part:.9g}" for part in vector) for name, vector in vectors.items()]
    return lines + [f"fov_deg = {math.degrees(2 * math.atan(HEIGHT / WIDTH)):.9g}"]


def write_transfer(data, name, path):
    rows = read_rows(data, f"transfer/{name}.csv")
    with open(path, "w", encoding="utf-8") as out:
        out.write("range 0 255\n")
        for row in rows:
            numbers = [int(row[key]) / 255 for key in ("value", "r", "g", "b", "a")]
            out.write(" ".join(f"{number:.9g}" for number in numbers) + "\n")


def write_scene(data, cameras, name, folder):
    """The scene of a measurement. Returns its path."""
    label = name.replace("/", "-").lower()
    row = next(camera for camera in cameras if camera["set"] == name)
    write_transfer(data, SETS[name], os.path.join(folder, label + ".tf"))
    path = os.path.join(folder, label + ".scene")
    with open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(
            [f"; Bauer 2018, {name}", "[volume]", "file = volumes/bonsai_256x256x256_uint8.raw.zst",
             "dims = 256 256 256", "type = uint8", "endian = little", "spacing = 1 1 1", "[transfer]",
             f"file = {label}.tf", "[camera]", *camera_lines(row), "[render]", "ray_sampling_rate = 1.5", ""]))
    return path


def write_path(data, every, folder):
    """Some of his places. Returns what gazebench calls them."""
    with open(os.path.join(data, "path.csv"), encoding="utf-8") as source:
        heading, *places = source.readlines()
    path = os.path.join(folder, "path.csv")
    with open(path, "w", encoding="utf-8") as out:
        out.writelines([heading] + places[::every])
    return f"{path}:{WIDTH}x{HEIGHT}"


def run_study(arguments, scene, path, folder):
    """Medians of whole frames by variant, ms."""
    out = os.path.join(folder, os.path.basename(scene).removesuffix(".scene"))
    subprocess.run([os.path.join(arguments.build, "bench/gazebench"), "run", scene, "--path", path, "--frames", "1",
                    "--size", arguments.size, "--errors", "none", "--methods", arguments.methods, "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    times = {}
    for row in read_rows(out, "frames.csv"):
        times.setdefault(row["variant"], []).append(float(row["frame_ms"]))
    return {variant: statistics.median(values) for variant, values in times.items()}


def print_set(name, ours, summary):
    standard = ours["standard"]
    for variant, ms in ours.items():
        ratio = "" if variant == "standard" else f", ratio {standard / ms:.2f}"
        print(f"{name}: gazecast {variant} {ms:.2f} ms{ratio}")
    theirs = {row["method"]: row for row in summary if row["set"] == name}
    plain = next(row for method, row in theirs.items() if method.split("_")[0] == "st")
    for method, row in theirs.items():
        kernel, frame = float(row["kernel_ms_median"]), float(row["frame_ms_median"])
        print(f"{name}: Bauer {method} kernel {kernel:.2f} ms, ratio {float(plain['kernel_ms_median']) / kernel:.2f}; "
              f"frame {frame:.0f} ms, ratio {float(plain['frame_ms_median']) / frame:.2f}")


def main():
    arguments = read_arguments()
    data = os.path.join(os.environ.get("GAZECAST_DATA", ""), "bauer2018")
    if not os.path.exists(os.path.join(data, "path.csv")):
        print(f"skipped: {data}/path.csv is not there; set GAZECAST_DATA")
        return 77
    folder = arguments.write or tempfile.mkdtemp(prefix="gazecast-bauer-")
    os.makedirs(folder, exist_ok=True)
    cameras, summary = read_rows(data, "cameras.csv"), read_rows(data, "summary.csv")
    path = write_path(data, arguments.every, folder)
    for name in SETS:
        print_set(name, run_study(arguments, write_scene(data, cameras, name, folder), path, folder), summary)
    if not arguments.write:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
