#!/usr/bin/env python3
"""Judge the sequences of a clip (gazebench clip) by FovVideoVDP, the metric of its authors.

    apt-get install python3-torch python3-pil
    git clone https://github.com/gfxdisp/FovVideoVDP
    /usr/bin/python3 bench/peers/fovvideovdp.py --metric FovVideoVDP CLIP...

Mantiuk et al., "FovVideoVDP: A visible difference predictor for wide field-of-view video", ACM Transactions on
Graphics 40(4), 2021. Their program has a licence of its own, CC BY-NC 4.0, and is not part of this project. It
compares each sequence with the clip's reference, foveated, with the gaze of each frame and the display's geometry.

Prints, for each sequence, the quality in JOD: 10 is no visible difference; of two sequences that are 1 JOD apart,
three of four people prefer the better one. Beside it stands the median time of a frame. 24 frames of 1920x1080 take
half a minute on two idle cores, and 4 GiB of memory for 4K.
"""
import argparse
import csv
import importlib
import json
import os
import sys
import types


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clips", nargs="+", metavar="CLIP", help="folder that gazebench clip has written")
    parser.add_argument("--metric", required=True, help="folder of the metric: a clone of gfxdisp/FovVideoVDP")
    parser.add_argument("--photometry", default="standard_fhd",
                        help="brightness of the display: a name of the metric's display_models.json")
    parser.add_argument("--frames", type=int, default=0, help="judge the first so many frames alone")
    parser.add_argument("--table", metavar="FILE",
                        help="write a table for gazebench report --jod: scene,method,jod,how")
    parser.add_argument("--json", action="store_true", help="a list of rows: scene size frames fps variant jod frame_ms")
    return parser.parse_args()


def read_clip(folder):
    """What clip.json says, checked as far as judging needs it."""
    with open(os.path.join(folder, "clip.json"), encoding="utf-8") as source:
        clip = json.load(source)
    if clip.get("format") != "gazecast clip" or clip.get("version") != 1:
        raise SystemExit(f"{folder}: not a clip of this version")
    if len(clip["gaze_px"]) != clip["frames"]:
        raise SystemExit(f"{folder}: {clip['frames']} frames and {len(clip['gaze_px'])} places of the gaze")
    return clip


def picture_paths(folder, clip, sequence, frames):
    return [os.path.join(folder, sequence["folder"], clip["pictures"] % i) for i in range(frames)]


def load_metric(folder):
    """The metric's modules, without those that read video files, whose libraries are not needed."""
    package = types.ModuleType("pyfvvdp")
    package.__path__ = [os.path.join(folder, "pyfvvdp")]
    sys.modules["pyfvvdp"] = package
    sys.path[:0] = [folder, package.__path__[0]]
    return importlib.import_module("pyfvvdp.fvvdp"), importlib.import_module("pyfvvdp.fvvdp_display_model")


class Judge:
    """The metric for the display of one clip."""

    def __init__(self, arguments, clip):
        import numpy
        import torch
        from PIL import Image
        self.numpy, self.torch, self.image = numpy, torch, Image
        torch.set_num_threads(os.cpu_count())
        metric, display = load_metric(arguments.metric)
        geometry = display.fvvdp_display_geometry(tuple(clip["size"]), distance_m=clip["display"]["distance_mm"] / 1000,
                                                  diagonal_size_inches=self.diagonal_inches(clip))
        self.metric = metric.fvvdp(display_name=arguments.photometry, display_geometry=geometry, foveated=True,
                                   quiet=True, device=torch.device("cpu"))

    @staticmethod
    def diagonal_inches(clip):
        """The metric assumes square pixels: of a display as wide as the clip's."""
        width, height = clip["size"]
        width_mm = clip["display"]["mm"][0]
        return (width_mm ** 2 + (width_mm * height / width) ** 2) ** .5 / 25.4

    def read(self, paths):
        return self.numpy.stack([self.numpy.asarray(self.image.open(path).convert("RGB")) for path in paths])

    def jod(self, test, reference, clip):
        # The metric counts pixels' centres from 0.
        gaze = self.numpy.array(clip["gaze_px"][:len(test)], dtype="float32") - 0.5
        with self.torch.no_grad():
            quality, _ = self.metric.predict(test, reference, dim_order="FHWC", frames_per_second=clip["fps"],
                                             fixation_point=gaze)
        return float(quality)


def judge_clip(arguments, folder):
    clip = read_clip(folder)
    judge = Judge(arguments, clip)
    frames = min(arguments.frames or clip["frames"], clip["frames"])
    reference = judge.read(picture_paths(folder, clip, clip["reference"], frames))
    for sequence in clip["tests"]:
        test = judge.read(picture_paths(folder, clip, sequence, frames))
        yield {"scene": clip["scene"], "size": clip["size"], "frames": frames, "fps": clip["fps"],
               "variant": sequence["variant"], "reference": clip["reference"]["variant"],
               "jod": judge.jod(test, reference, clip), "frame_ms": sequence["frame_ms"],
               "reference_ms": clip["reference"]["frame_ms"]}


def write_table(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["scene", "method", "jod", "how"])
        for row in rows:
            how = (f"FovVideoVDP, {row['frames']} frames of {row['size'][0]}x{row['size'][1]} at {row['fps']:g} a second "
                   f"against {row['reference']}")
            writer.writerow([row["scene"], row["variant"], f"{row['jod']:.3f}", how])


def main():
    arguments = read_arguments()
    rows = []
    for folder in arguments.clips:
        for row in judge_clip(arguments, folder):
            rows.append(row)
            if not arguments.json:
                print("{scene} {size[0]}x{size[1]}, {frames} frames, {variant}: JOD {jod:.3f} against {reference}, "
                      "{frame_ms:.1f} ms a frame ({reference_ms:.1f} ms)".format(**row), flush=True)
    if arguments.table:
        write_table(arguments.table, rows)
    if arguments.json:
        json.dump(rows, sys.stdout, indent=1)
        print()


if __name__ == "__main__":
    main()
