"""Reads what encode_samples wrote with Python's msgpack, as Pupil's and PsychoPy's clients do.

usage: read_samples.py ENCODE_SAMPLES
"""
import math
import os
import subprocess
import sys
import tempfile

try:
    import msgpack
except ImportError:
    print("no msgpack module")
    sys.exit(77)


def read(folder, name):
    with open(os.path.join(folder, name), "rb") as file:
        return msgpack.unpackb(file.read(), raw=False)


def check(actual, expected, what):
    if actual != expected:
        sys.exit(f"{what} is {actual!r}, not {expected!r}")


def check_gaze(gaze, surface):
    check(gaze["topic"], "gaze.3d.01.", "topic")
    check(gaze["norm_pos"], [0.75, 0.75], "norm_pos")
    check(gaze["event_final"]["event"], "pursuit", "event_final")
    check(gaze["publish_ns"], 123456789112345, "publish_ns")
    check(list(gaze)[-1], "publish_ns", "last key")
    for eye, pupil in enumerate(gaze["base_data"]):
        check(pupil["id"], eye, "id")
        x, y, z = pupil["sphere"]["center"]
        check(all(map(math.isfinite, [x, y, z, pupil["phi"], pupil["theta"]])), True, "pupil")
    # How ioHub finds the gaze map that belongs to a place on a surface.
    topic, timestamp = surface["gaze_on_surfaces"][0]["base_data"]
    check((topic, timestamp), (gaze["topic"], gaze["timestamp"]), "base_data")


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        check_gaze(read(folder, "gaze"), read(folder, "surface"))
        right = read(folder, "gaze_right")
        check(right["topic"], "gaze.3d.0.", "topic")
        check(right["raw"], None, "raw")
        check(right["device_ns"], None, "device_ns")
        check([pupil["id"] for pupil in right["base_data"]], [0], "eyes")
        check(read(folder, "fixation")["id"], 4711, "fixation")
        check(read(folder, "blink")["type"], "onset", "blink")
        check(read(folder, "gaze")["landing"]["sigma_deg"], 1.5, "landing")
        check(read(folder, "saccade")["amplitude_deg"], 8.5, "saccade")
        check(read(folder, "status")["tracker"]["reason"], "unplugged", "status")


main()
