#!/usr/bin/env python3
"""What boosted trees of scikit-learn reach on recordings that were kept out, as a reference for the
forests of filter/classifier (docs/gaze-pipeline.md).

    GAZECAST_DATA=... nice /usr/bin/python3 bench/peers/gaze_trees.py FOLDS [--ahead SAMPLES] [--every 3]

    GAZECAST_DATA=... /usr/bin/python3 bench/peers/gaze_trees.py speeds

FOLDS is `film` (two films and a third of the people at a time), `set` or `recording`, as folds=3,
folds=2 and `folds=3 recordings=1` of gaze_forest_fit. 64 features at 250 Hz, of the samples before a
sample and, with --ahead, of so many after it: noise, and over eight windows of 4 to 448 ms the
distance, the way, both against noise and each other, the spread and what was lost; turns; what was
fast, and when. 120 rounds of 24 leaves learn from every third sample, and from each of both coders. `speeds` prints how fast the
eye moves in what people call fixation and pursuit: medians over 100 ms, of each recording.
Needs numpy and scikit-learn (python3-sklearn).
"""
import argparse
import gzip
import os
import sys

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier

FIXATION, SACCADE, PURSUIT, NOISE, RINGING, UNKNOWN = range(6)
WINDOWS = (1, 2, 4, 8, 16, 32, 64, 112)
FILMS = ("beach", "bridge_2", "ducks_boat", "holsten_gate", "puppies", "st_petri_mcdonalds")
STIMULI = ("img", "dots", "video")
CODERS = ("MN", "RA")


class Recording:
    """Points in degrees at 250 Hz, and the labels of one or two people."""

    def __init__(self, name, kind, person, points_deg, measured, labels):
        self.name, self.kind, self.person = name, kind, person
        self.points_deg, self.measured, self.labels = points_deg, measured, labels
        self.fold, self.found = 0, None


def shifted(values, back):
    """The value `back` samples before each sample, or that of the first or last one."""
    return values[np.clip(np.arange(len(values)) - back, 0, len(values) - 1)]


def last_where(flags):
    """The index of the last sample up to each one where the flag is set, or -1000."""
    return np.maximum.accumulate(np.where(flags, np.arange(len(flags)), -1000))


def log_noise(steps):
    """A slow mean of the logarithm of small steps."""
    logs, out = np.log(np.clip(steps, 1e-3, 5)), np.empty(len(steps))
    mean = logs[0]
    for i, value in enumerate(logs):
        mean += 0.01 * (value - mean) if value < mean + 1.5 else 0.001
        out[i] = mean
    return out


def since_fast(points, fast):
    """Distance from the mean since the last fast step, and mean speed since then."""
    away, speed = np.empty(len(points)), np.empty(len(points))
    total, count, first = np.zeros(2), 0, points[0]
    for i, point in enumerate(points):
        if fast[i]:
            total, count, first = np.zeros(2), 0, point
        total, count = total + point, count + 1
        away[i] = np.hypot(*(point - total / count))
        speed[i] = np.hypot(*(point - first)) / max(count, 3)
    return away, speed


def features_of(recording, ahead):
    """One row a sample, from earlier samples and `ahead` later ones."""
    measured, count = recording.measured, len(recording.measured)
    held = np.maximum.accumulate(np.where(measured, np.arange(count), 0))
    points = np.nan_to_num(recording.points_deg[held])
    change = np.diff(points, axis=0, prepend=points[:1])
    steps = np.hypot(*change.T)
    noise_log = log_noise(steps)
    noise = np.exp(noise_log)
    columns = [noise_log]
    way_sum, lost_sum = np.cumsum(steps), np.cumsum(~measured)
    sums, squares = np.cumsum(points, axis=0), np.cumsum(points**2, axis=0)
    for window in WINDOWS:
        later = min(ahead, window)

        def over(values):
            return shifted(values, -later) - shifted(values, window - later)

        moved = over(points)
        distance, way = np.hypot(*moved.T), over(way_sum)
        variance = over(squares) / window - (over(sums) / window) ** 2
        spread = np.sqrt(np.clip(variance, 0, None).sum(1))
        columns += [np.log(distance + 0.01), np.log(way + 0.01), distance / (way + 0.02),
                    np.log(distance + 0.01) - np.log(noise * np.sqrt(window)),
                    np.log(spread + 0.01), over(lost_sum) / window]
        if window in (4, 16, 64):
            columns += [moved[:, 0], moved[:, 1]]
    for window in (2, 4, 8, 16):
        later = min(ahead, window)
        new = shifted(points, -later) - shifted(points, window - later)
        old = shifted(points, window - later) - shifted(points, 2 * window - later)
        lengths = np.hypot(*new.T) * np.hypot(*old.T)
        columns.append((new * old).sum(1) / (lengths + 0.01))
    fast = steps > np.maximum(0.12, 4 * noise)
    for flags in (fast, ~measured):
        columns.append(np.minimum(np.arange(count) - last_where(flags), 200))
        if ahead:
            columns.append(np.minimum(np.arange(count) - last_where(flags[::-1]), ahead + 1)[::-1])
    away, speed = since_fast(points, fast)
    columns += [np.log(away + 0.01), np.log(speed + 0.001), measured]
    return np.stack(columns, 1).astype(np.float32)


def read_films(folder):
    """GazeCom: a film of 1280 x 720 pixels over 400 x 225 mm, seen from 450 mm."""
    names = dict(F=FIXATION, S=SACCADE, P=PURSUIT, B=NOISE, N=NOISE)
    for film in FILMS:
        people = {}
        with gzip.open(os.path.join(folder, film + ".tsv.gz"), "rt") as lines:
            next(lines)
            for line in lines:
                row = line.rstrip("\n").split("\t")
                people.setdefault(row[0], []).append(row)
        for person, rows in people.items():
            numbers = np.array([[float(x) for x in row[1:4]] for row in rows])
            labels = np.array([names.get(row[4], NOISE) for row in rows])
            measured = (numbers[:, 2] >= 0.5) & numbers[:, :2].any(1)
            yield Recording(film + person, film, person, numbers[:, :2] * (47.9, 28.1), measured, [labels])


def read_labelled(path):
    """Points of 1024 x 768 pixels over 31.7 x 25.2 degrees, and labels, at 500 Hz."""
    with gzip.open(path, "rt") as lines:
        rows = [line.split("\t") for line in lines if not line.startswith("#")]
    numbers = np.array([[float(x) for x in row[3:6]] for row in rows if len(row) >= 6])
    classes = {1: FIXATION, 2: SACCADE, 3: RINGING, 4: PURSUIT, 5: NOISE, 6: NOISE}
    return numbers[:, :2], np.array([classes.get(int(x), UNKNOWN) for x in numbers[:, 2]])


def read_stimuli(folder):
    """Andersson et al.; of each recording every second sample, twice."""
    files = sorted(name for name in os.listdir(folder) if name.endswith("_MN.tsv.gz"))
    for stimulus in STIMULI:
        for name in files:
            if not name.startswith(stimulus):
                continue
            first = name.replace("img_UH29_img_Europe_labelled_MN", "fix_UH29_img_Europe_labelled_FIX_MN")
            points, mine = read_labelled(os.path.join(folder, first))
            _, theirs = read_labelled(os.path.join(folder, name.replace("_MN", "_RA")))
            count = min(len(mine), len(theirs))
            points = points[:count]
            measured = np.isfinite(points).all(1) & points.any(1)
            for phase in (0, 1):
                part = slice(phase, count, 2)
                yield Recording(name, stimulus, name.split("_")[1],
                                points[part] / (1024, 768) * (31.7, 25.2), measured[part],
                                [mine[part], theirs[part]])


def set_folds(recordings, kind):
    """Number the folds as gaze_forest_fit does. Both halves of a recording are in one."""
    people = list(dict.fromkeys(one.person for one in recordings if one.kind in STIMULI))
    names = list(dict.fromkeys(one.name for one in recordings))
    for one in recordings:
        stimulus = one.kind in STIMULI
        one.fold = {
            "set": int(stimulus),
            "recording": names.index(one.name) % 3,
            "film": (people if stimulus else FILMS).index(one.person if stimulus else one.kind) % 3,
        }[kind]
    return 2 if kind == "set" else 3


def train(recordings, rows, every):
    """A model of what people say about every so many samples."""
    inputs, classes, weights = [], [], []
    for one, features in zip(recordings, rows):
        for labels in one.labels:
            use = np.flatnonzero(labels < RINGING)[::every]
            inputs.append(features[use])
            classes.append(labels[use])
            weights.append(np.full(len(use), 1.0 if one.kind in FILMS else 5.0))
    model = HistGradientBoostingClassifier(max_iter=120, max_leaf_nodes=24, learning_rate=0.12,
                                           min_samples_leaf=200, early_stopping=False, random_state=1)
    return model.fit(np.concatenate(inputs), np.concatenate(classes),
                     sample_weight=np.concatenate(weights))


def kappa(ours, theirs):
    """Cohen's kappa of two labels that are there or not."""
    chance = ours.mean() * theirs.mean() + (1 - ours.mean()) * (1 - theirs.mean())
    return ((ours == theirs).mean() - chance) / (1 - chance)


def print_figures(recordings):
    """Print a row for the tables of docs/gaze-pipeline.md."""
    found = np.concatenate([one.found for one in recordings if one.kind in FILMS])
    people = np.concatenate([one.labels[0] for one in recordings if one.kind in FILMS])
    scores = [2 * ((found == k) & (people == k)).sum() / ((found == k).sum() + (people == k).sum())
              for k in (FIXATION, SACCADE, PURSUIT, NOISE)]
    cells = [", ".join("%.3f" % score for score in scores)]
    for stimulus in STIMULI:
        mine = [one for one in recordings if one.kind == stimulus]
        found = np.concatenate([one.found for one in mine])
        values = []
        for label in (SACCADE, FIXATION):
            both = []
            for coder in range(len(CODERS)):
                people = np.concatenate([one.labels[coder] for one in mine])
                known = people != UNKNOWN
                both.append(kappa(found[known] == label, people[known] == label))
            values.append("%.2f" % np.mean(both))
        cells.append(", ".join(values))
    print("| " + " | ".join(cells) + " |")


def print_speeds(recordings):
    """Print the median speeds of each recording's first half of the samples, by its first coder."""
    for name in dict.fromkeys(one.name for one in recordings):
        one = next(one for one in recordings if one.name == name)
        speeds = np.hypot(*(one.points_deg[25:] - one.points_deg[:-25]).T) / 0.1
        labels = one.labels[0]
        same = np.lib.stride_tricks.sliding_window_view(labels, 26)
        same = (same == same[:, :1]).all(1)
        medians = [np.nanmedian(speeds[same & (labels[:-25] == k)])
                   if (same & (labels[:-25] == k)).any() else np.nan for k in (FIXATION, PURSUIT)]
        print(f"{name[:30]:30} fixation {medians[0]:.1f}, pursuit {medians[1]:.1f} degrees per second")


def main():
    """Keep out each fold once."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folds", choices=("film", "set", "recording", "speeds"))
    parser.add_argument("--ahead", type=int, default=0)
    parser.add_argument("--every", type=int, default=3)
    options = parser.parse_args()
    if "GAZECAST_DATA" not in os.environ:
        print("GAZECAST_DATA is not set")
        return 77
    data = os.path.join(os.environ["GAZECAST_DATA"], "gaze")
    recordings = list(read_stimuli(os.path.join(data, "andersson2017")))
    if options.folds == "speeds":
        print_speeds(recordings)
        return 0
    recordings += read_films(os.path.join(data, "gazecom"))
    rows = [features_of(one, options.ahead) for one in recordings]
    for fold in range(set_folds(recordings, options.folds)):
        learned = [i for i, one in enumerate(recordings) if one.fold != fold]
        model = train([recordings[i] for i in learned], [rows[i] for i in learned], options.every)
        for one, features in zip(recordings, rows):
            if one.fold == fold:
                one.found = model.predict(features)
    print_figures(recordings)
    return 0


if __name__ == "__main__":
    sys.exit(main())
