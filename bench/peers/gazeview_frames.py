"""Frames of gazeview to be timed beside another program's: whole frames, several gaze positions."""
import json
import os
import statistics
import subprocess

# The object's centre first, then places along the S of gazebench (sweep:s): above, right, left, below.
GAZES = ("centre", "0.5,0.05", "0.9,0.275", "0.1,0.725", "0.5,0.95")


def run_gazeview(gazeview, scene, size, backend, method, gaze, frames, folder, options=()):
    """Milliseconds of each frame but the first, which reads the volume, and the first frame's picture. `options`
    are more arguments of gazeview."""
    pattern, stats = os.path.join(folder, method + "-%d.png"), os.path.join(folder, "stats.json")
    subprocess.run([gazeview, "--headless", "--scene", scene, "--size", size, "--gaze", gaze, "--method", method,
                    "--backend", backend, "--turn", "0.01", "--frames", str(frames), "--out", pattern,
                    "--stats", stats, *options], check=True, stdout=subprocess.DEVNULL)
    with open(stats, encoding="utf-8") as source:
        made = json.load(source)["frames"]
    if any(frame["method"] != method or frame["backend"] != backend for frame in made):
        raise SystemExit(f"gazeview did not make {method} by {backend}, see its messages")
    return [frame["total_ms"] for frame in made[1:]], pattern % 0


class Series:
    """Times of what is compared: the peer, `standard`, and `acuity` at each gaze."""

    def __init__(self):
        self.peer, self.standard = [], []
        self.acuity = {gaze: [] for gaze in GAZES}

    def lines(self):
        """How many times as long the peer takes: medians; the mean over gazes is that of their medians."""
        peer = statistics.median(self.peer)
        named = {"standard": statistics.median(self.standard)}
        medians = {gaze: statistics.median(times) for gaze, times in self.acuity.items()}
        named.update({f"acuity, gaze {gaze}": ms for gaze, ms in medians.items()})
        named[f"acuity, mean of {len(medians)} gazes"] = statistics.mean(medians.values())
        return [f"gazeview {name}: {ms:.1f} ms, ratio {peer / ms:.2f}" for name, ms in named.items()]
