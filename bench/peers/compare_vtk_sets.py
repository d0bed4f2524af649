#!/usr/bin/env python3
"""The table of VTK's CPU ray caster against gazeview's `standard` by every instruction set, unlit and lit.

    apt-get install python3-vtk9 python3-numpy zstd xvfb xauth
    GAZECAST_DATA=... xvfb-run -a /usr/bin/python3 bench/peers/compare_vtk_sets.py SCENE...

Each volume is drawn as compare_vtk.py says. VTK and gazeview with each instruction set draw three frames each in
turn, --pairs times; a cell is the median of whole frames and how many times as long VTK takes. With --processor-time
they are processor times of all threads, which other programs disturb less. The picture's PSNR is that of the first
set.
"""
import argparse
import os
import resource
import statistics
import subprocess
import time

from compare_vtk import Scene, VtkWindow, gazeview, load_volume, make_volume, psnr_db, volume_options

SETS = "avx512,avx2,portable"


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+", metavar="scene")
    parser.add_argument("--simd", default=SETS, help="instruction sets, with commas between")
    parser.add_argument("--only", choices=["lit", "unlit"], help="one of the two tables")
    parser.add_argument("--processor-time", action="store_true", help="of all threads, instead of the time that passes")
    parser.add_argument("--size", default="1024x1024")
    parser.add_argument("--pairs", type=int, default=3, help="rounds of three frames each")
    parser.add_argument("--gazeview", default="build/release/view/gazeview")
    arguments = parser.parse_args()
    arguments.sets = arguments.simd.split(",")
    arguments.backend = "cpu"
    return arguments


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as source:
        return next((line.split(":")[1].strip() for line in source if line.startswith("model name")), "unknown")


def children_ms():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (used.ru_utime + used.ru_stime)


def run_ms(arguments, frames):
    """Processor time of gazeview for so many frames that are not written."""
    started = children_ms()
    subprocess.run([arguments.gazeview, "--headless", "--scene", arguments.scene, "--size", arguments.size, "--gaze",
                    "centre", "--method", "standard", "--turn", "0.01", "--frames", str(frames), *arguments.options],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return children_ms() - started


def frames_of(arguments, simd, lit):
    """Times of frames, and the picture of the scene's own camera."""
    arguments.options = volume_options(lit, simd)
    times, picture = gazeview(arguments, "standard", "centre")
    if arguments.processor_time:
        times = [(run_ms(arguments, 6) - run_ms(arguments, 1)) / 5]
    return times, picture


def peer_ms(arguments, peer):
    """The time of a frame of VTK."""
    started = time.process_time()
    passed = peer.frame_ms()
    return 1e3 * (time.process_time() - started) if arguments.processor_time else passed


def measure_row(arguments, scene_path, lit):
    """Medians of VTK and of each set, and the PSNR."""
    arguments.scene = scene_path
    scene = Scene(scene_path)
    width, height = [int(side) for side in arguments.size.split("x")]
    peer = VtkWindow(scene, make_volume(scene, "cpu", lit), width, height, lit)
    theirs, ours = [], {simd: [] for simd in arguments.sets}
    their_picture, our_picture = peer.picture(), None
    for _ in range(arguments.pairs):
        theirs += [peer_ms(arguments, peer) for _ in range(3)]
        for simd in arguments.sets:
            times, picture = frames_of(arguments, simd, lit)
            ours[simd] += times
            our_picture = picture if our_picture is None else our_picture
    medians = {simd: statistics.median(times) for simd, times in ours.items()}
    return statistics.median(theirs), medians, psnr_db(our_picture, their_picture)


def print_table(arguments, lit):
    print(f"\n| {'lit' if lit else 'unlit'} | bits | VTK | {' | '.join(arguments.sets)} | PSNR |")
    print("|---" * (4 + len(arguments.sets)) + "|")
    for path in arguments.scenes:
        bits = 8 * load_volume(Scene(path)).GetScalarSize()
        vtk_ms, ours, psnr = measure_row(arguments, path, lit)
        cells = " | ".join(f"{ours[simd]:.1f} ms, {vtk_ms / ours[simd]:.1f}" for simd in arguments.sets)
        name = os.path.splitext(os.path.basename(path))[0]
        print(f"| {name} | {bits} | {vtk_ms:.0f} ms | {cells} | {psnr:.1f} dB |", flush=True)


def main():
    arguments = read_arguments()
    print(f"{processor()}, {os.cpu_count()} processors, {arguments.size}")
    for lit in (False, True):
        if arguments.only != ("unlit" if lit else "lit"):
            print_table(arguments, lit)


if __name__ == "__main__":
    main()
