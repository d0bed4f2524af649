#!/usr/bin/env python3
"""Other ways to make labels from the scores of a forest, on recordings that were kept out
(docs/gaze-pipeline.md). None of them is used: this shows what they would reach.

    nice /usr/bin/python3 bench/peers/gaze_decoders.py FOLDER TAG {at_once,certain,whole} {film,set,order}

FOLDER is that of gaze_features, with the TAG.scores that gaze_forest_fit left for these folds. Rates
and durations of labels are learned from the recordings of the other folds. `order` prints instead in
how many pairs of a pursuit and a fixation sample of one recording the pursuit has the greater odds.
Needs numpy.
"""
import argparse
import os
import sys

import numpy as np

from gaze_trees import (FILMS, FIXATION, NOISE, PURSUIT, RINGING, SACCADE, STIMULI, UNKNOWN,
                        print_figures)

CLASSES = 5
CHANGE_LEAD = np.log(1.5)  # of gz_forest_label()
USUAL_SHARE = 0.1
ADDED = {"at_once": (0, 0, 0.45, 0.2, 0), "certain": (0, 0, 0.3, 0.2, 0), "whole": (0, 0, 0, 0, 0)}


class Recording:
    """Scores and labels of one recording."""

    def __init__(self, track, fold, scores, labels, measured):
        self.kind, self.step_ms, self.fold = track[2], float(track[4]) / 1000, fold
        self.name = track[3]
        self.scores, self.labels, self.measured = scores, labels, measured
        self.found = None


def read(folder, tag, kind, folds):
    """The recordings that were kept out."""
    with open(os.path.join(folder, "tracks.tsv"), encoding="utf-8") as lines:
        tracks = [line.rstrip("\n").split("\t") for line in lines]
    numbers = np.fromfile(os.path.join(folder, "labels.i16"), np.int16).reshape(-1, 5)
    count = CLASSES - (kind == "at_once")
    rows = np.fromfile(os.path.join(folder, tag + ".scores"), np.float32).reshape(-1, 2 + count)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    people = list(dict.fromkeys(track[3].split("_")[1] for track in tracks if track[1] == "andersson"))
    classes = np.array([UNKNOWN, FIXATION, SACCADE, RINGING, PURSUIT, NOISE, NOISE])
    out = []
    for part in np.split(rows, np.flatnonzero(np.diff(rows[:, 1])) + 1):
        track = tracks[int(part[0, 1])]
        film = track[2] in FILMS
        fold = FILMS.index(track[2]) if film else people.index(track[3].split("_")[1])
        back = int(8000 / float(track[4]) + 0.1) if kind == "certain" else 0
        index = part[back:, 0].astype(int) - back
        scores = np.full((len(index), CLASSES), -1e4)
        scores[:, :count] = part[back:, 2:] + np.array(ADDED[kind][:count])
        labels = [classes[numbers[index, 1 + coder]] for coder in range(1 if film else 2)]
        out.append(Recording(track, int(not film) if folds == "set" else fold % 3, scores, labels,
                             numbers[index, 3] != 0))
    return out


def stacks(recordings):
    """Recordings of the same rate beside each other: time, recording, class. The shorter ones are
    followed by samples that were not measured."""
    for step_ms in sorted({one.step_ms for one in recordings}):
        mine = [one for one in recordings if one.step_ms == step_ms]
        longest = max(len(one.measured) for one in mine)
        scores, measured = np.zeros((longest, len(mine), CLASSES)), np.zeros((longest, len(mine)), bool)
        for i, one in enumerate(mine):
            scores[: len(one.measured), i] = one.scores
            measured[: len(one.measured), i] = one.measured
        yield step_ms, mine, scores, measured


def keep(mine, found):
    """Store what was found in a stack."""
    for i, one in enumerate(mine):
        one.found = found[: len(one.measured), i]


def odds_of(scores):
    """Logarithm of the odds of pursuit against fixation."""
    return scores[..., PURSUIT] - scores[..., FIXATION]


def with_odds(scores, odds, where):
    """Other odds, with the better one of fixation and pursuit as likely as before."""
    out, better = scores.copy(), np.maximum(scores[..., FIXATION], scores[..., PURSUIT])
    out[..., FIXATION] = np.where(where, better - np.maximum(odds, 0), scores[..., FIXATION])
    out[..., PURSUIT] = np.where(where, better + np.minimum(odds, 0), scores[..., PURSUIT])
    return out


def is_slow(scores, measured):
    """Whether a sample is likeliest to be a fixation or a pursuit."""
    best = scores.argmax(-1)
    return measured & ((best == FIXATION) | (best == PURSUIT))


def label(scores, measured):
    """As gz_forest_label()."""
    found = np.zeros(measured.shape, np.uint8)
    last = np.full(measured.shape[1], UNKNOWN)
    rows = np.arange(measured.shape[1])
    for t, now_scores in enumerate(scores):
        now_scores = now_scores.copy()
        now_scores[(last != SACCADE) & (last != RINGING), RINGING] = -1e9
        now = np.where(measured[t], now_scores.argmax(1), NOISE)
        slow = ((now == FIXATION) | (now == PURSUIT)) & ((last == FIXATION) | (last == PURSUIT))
        before = np.where(slow, last, FIXATION)
        stays = slow & (now_scores[rows, now] - now_scores[rows, before] < CHANGE_LEAD)
        last = np.where(stays, last, now)
        found[t] = last
    return found


def learned_from(recordings, fold):
    """Stretches of one label in the other folds: class, duration in ms, class before, weight."""
    rows = []
    for one in recordings:
        for labels in one.labels if one.fold != fold else []:
            first = np.flatnonzero(np.r_[True, labels[1:] != labels[:-1]])
            kinds = labels[first]
            long_ms = np.diff(np.r_[first, len(labels)]) * one.step_ms
            weight = np.full(len(kinds), 1.0 if one.kind in FILMS else 5.0)
            rows.append(np.stack([kinds, long_ms, np.r_[UNKNOWN, kinds[:-1]], weight], 1))
    return np.concatenate(rows)


def forward(recordings, fold, tau_ms):
    """A Bayesian filter: labels change at the rates of the other folds, and a sample's score counts
    once every tau_ms."""
    stretches = learned_from(recordings, fold)
    rates, share = np.zeros((CLASSES, CLASSES)), np.full(CLASSES, 1e-3)
    for k in range(CLASSES):
        mine = stretches[stretches[:, 0] == k]
        share[k] += (mine[:, 1] * mine[:, 3]).sum()
        for j in range(CLASSES):
            rates[j, k] = mine[mine[:, 2] == j, 3].sum()
    rates /= share[:, None] + 1
    share = np.maximum(share / share.sum(), 0.002)
    for step_ms, mine, scores, measured in stacks([one for one in recordings if one.fold == fold]):
        step = np.minimum(rates * step_ms, 0.2)
        np.fill_diagonal(step, 0)
        step[np.arange(CLASSES), np.arange(CLASSES)] = 1 - np.minimum(step.sum(1), 0.9)
        likely = np.tile(share, (len(mine), 1))
        lost = np.where(np.arange(CLASSES) == NOISE, 1.0, 1e-6)
        found = np.zeros(measured.shape, np.uint8)
        evidence = np.exp(min(step_ms / tau_ms, 1) * (scores - scores.max(-1, keepdims=True)))
        for t in range(len(scores)):
            likely = (likely @ step) * np.where(measured[t][:, None], evidence[t], lost)
            likely = np.maximum(likely / likely.sum(1, keepdims=True), 1e-9)
            found[t] = likely.argmax(1)
        keep(mine, found)


def causal_mean(recordings, tau_ms, part, lead):
    """Odds of pursuit are in part their mean over the last tau_ms."""
    for step_ms, mine, scores, measured in stacks(recordings):
        slow, gain = is_slow(scores, measured), step_ms / tau_ms
        odds = np.clip(odds_of(scores) + lead, -3, 3)
        total, weight = np.zeros(len(mine)), np.full(len(mine), 1e-6)
        for t, where in enumerate(slow):
            total += gain * (np.where(where, odds[t], 0) - total)
            weight += gain * (where - weight)
            odds[t] = part * total / np.maximum(weight, 1e-6) + (1 - part) * odds[t]
        keep(mine, label(with_odds(scores, odds, slow), measured))


def online_share(recordings, prior_s, memory_s):
    """The share of pursuit is learned while the eye is watched."""
    for step_ms, mine, scores, measured in stacks(recordings):
        slow, odds = is_slow(scores, measured), odds_of(scores)
        pursuit_s, slow_s = np.zeros(len(mine)), np.zeros(len(mine))
        usual = np.log(USUAL_SHARE / (1 - USUAL_SHARE))
        for t, where in enumerate(slow):
            share = (USUAL_SHARE * prior_s + pursuit_s) / (prior_s + slow_s)
            odds[t] += np.log(share / (1 - share)) - usual
            fade = np.where(where, np.exp(-step_ms / 1000 / memory_s), 1)
            now_s = where * step_ms / 1000
            pursuit_s = pursuit_s * fade + now_s / (1 + np.exp(-np.clip(odds[t], -50, 50)))
            slow_s = slow_s * fade + now_s
        keep(mine, label(with_odds(scores, odds, slow), measured))


def weigh(one):
    """As gz_whole_weigh() with the presets."""
    slow, odds, step_s = is_slow(one.scores, one.measured), odds_of(one.scores), one.step_ms / 1000
    usual, lead = np.log(USUAL_SHARE / (1 - USUAL_SHARE)), 0.0
    for _ in range(10):
        pursuit_s = 0.4 + step_s * (1 / (1 + np.exp(-np.clip(odds[slow] + lead, -50, 50)))).sum()
        share = pursuit_s / (4 + step_s * slow.sum())
        lead = np.log(share / (1 - share)) - usual
    reach = int(150 / one.step_ms)
    sums = np.cumsum(np.r_[0, np.where(slow, np.clip(odds + 0.5 * lead + 0.5, -3, 3), 0)])
    counts = np.cumsum(np.r_[0, slow])
    at = np.arange(len(slow))
    low, high = np.maximum(at - reach, 0), np.minimum(at + reach + 1, len(slow))
    odds = (sums[high] - sums[low]) / np.maximum(counts[high] - counts[low], 1)
    return with_odds(one.scores, odds, slow) + np.array((0, -0.2, 0, 0, 0.3))


def losses(measured, step_ms):
    """1 where a loss is short, 2 where it is long."""
    out = np.zeros(len(measured), int)
    edges = np.diff(np.r_[0, ~measured, 0])
    for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)):
        short = end - begin == 1 or (end - begin + 1) * step_ms < 14
        out[begin:end] = 1 if short and begin > 0 and end < len(measured) else 2
    return out


def durations(stretches, steps_ms, weight):
    """Weighted logarithms of how likely durations are: a kernel over their logarithms. The last one
    is for all that are longer."""
    out = np.zeros((CLASSES, len(steps_ms)))
    for k in range(CLASSES):
        mine = stretches[stretches[:, 0] == k]
        if not len(mine):
            mine = stretches[stretches[:, 0] == SACCADE]  # GazeCom's coders call ringing a saccade
        away = (np.log(steps_ms)[:, None] - np.log(mine[:, 1])) / 0.25
        density = (np.exp(-0.5 * away**2) * mine[:, 3]).sum(1) + 1e-3 * mine[:, 3].sum()
        density /= 0.25 * np.sqrt(2 * np.pi) * mine[:, 3].sum()
        out[k] = weight * np.log(density / steps_ms * steps_ms[0])
        out[k, -1] = weight * np.log(max((mine[mine[:, 1] >= steps_ms[-1], 3]).sum() / mine[:, 3].sum(), 1e-4))
    return out


def semi_markov(recordings, fold, weight, tau_ms=5, most_ms=1200):
    """The best sequence of stretches, each as likely as its duration and its scores say. A stretch of
    the greatest duration may go on."""
    stretches = learned_from(recordings, fold)
    stretches = stretches[stretches[:, 0] < UNKNOWN]
    change = np.full((CLASSES, CLASSES), 0.5)
    for k in range(CLASSES):
        for j in range(CLASSES):
            change[j, k] += stretches[(stretches[:, 0] == k) & (stretches[:, 2] == j), 3].sum()
    np.fill_diagonal(change, 0)
    change = weight * np.log(change / change.sum(1, keepdims=True) + 1e-9)
    change[[FIXATION, PURSUIT, NOISE], RINGING] = -1e6
    for one in recordings:
        if one.fold != fold:
            continue
        most = int(most_ms / one.step_ms)
        long = durations(stretches, one.step_ms * np.arange(1, most + 1), weight)
        says = weigh(one)
        says = (says - says.max(1, keepdims=True)) * one.step_ms / tau_ms
        lost = losses(one.measured, one.step_ms)
        says[lost == 1] = 0
        says[lost == 2] = np.where(np.arange(CLASSES) == NOISE, 0, -1e5)
        one.found = best_stretches(says, long, change)


def best_stretches(says, long, change):
    """Viterbi's algorithm over stretches."""
    count, most = len(says), long.shape[1]
    sums = np.concatenate([np.zeros((1, CLASSES)), np.cumsum(says, 0)]).T
    entry = np.zeros((CLASSES, count + 1))  # best way to where a stretch of the class begins, less sums
    length, before = np.zeros((count + 1, CLASSES), int), np.zeros((count + 1, CLASSES), int)
    for i in range(1, count + 1):
        reach = min(i, most)
        ways = entry[:, i - reach : i][:, ::-1] + long[:, :reach]
        length[i] = ways.argmax(1) + 1
        value = ways.max(1) + sums[:, i]
        options = value[:, None] + change
        options[np.arange(CLASSES), np.arange(CLASSES)] = np.where(length[i] == most, value, -1e9)
        before[i] = options.argmax(0)
        entry[:, i] = options.max(0) - sums[:, i]
    found, i, k = np.zeros(count, np.uint8), count, int(value.argmax())
    while i > 0:
        begin = i - length[i][k]
        found[begin:i] = k
        i, k = begin, before[begin][k]
    return found


def ways_of(kind, recordings):
    """Name and function of each way; the function stores what it finds."""
    folds = sorted({one.fold for one in recordings})

    def each_fold(function, *numbers):
        return lambda: [function(recordings, fold, *numbers) for fold in folds]

    if kind == "whole":
        for weight in (0.25, 0.5, 1):
            yield f"semi-Markov, durations count {weight}", each_fold(semi_markov, weight)
        return

    def as_it_is():
        for _, mine, scores, measured in stacks(recordings):
            keep(mine, label(scores, measured))

    yield "as it is", as_it_is
    for tau_ms in (4, 8, 16):
        yield f"Bayesian filter, {tau_ms} ms", each_fold(forward, tau_ms)
    for tau_ms, part in ((25, 0.5), (25, 1), (100, 0.5), (100, 1)):
        yield (f"mean of the odds over {tau_ms} ms, {part}",
               lambda tau_ms=tau_ms, part=part: causal_mean(recordings, tau_ms, part, 0.35))
    for prior_s, memory_s in ((4, 5), (4, 20), (2, 5), (1, 20)):
        yield (f"share learned, prior {prior_s} s, memory {memory_s} s",
               lambda prior_s=prior_s, memory_s=memory_s: online_share(recordings, prior_s, memory_s))


def print_order(recordings):
    """Print the share of pairs in order, of each recording of Andersson et al. and each coder."""
    for one in recordings:
        for labels in one.labels if one.kind in STIMULI else []:
            slow = one.measured & ((labels == FIXATION) | (labels == PURSUIT))
            pursuit = (labels == PURSUIT)[slow]
            many, few = pursuit.sum(), (~pursuit).sum()
            if many and few:
                rank = np.argsort(np.argsort(odds_of(one.scores[slow]))) + 1
                share = (rank[pursuit].sum() - many * (many + 1) / 2) / (many * few)
                print(f"{one.name}: {share:.2f}")


def main():
    """Print a row for each way."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("tag")
    parser.add_argument("kind", choices=sorted(ADDED))
    parser.add_argument("folds", choices=("film", "set", "order"))
    options = parser.parse_args()
    recordings = read(options.folder, options.tag, options.kind, options.folds)
    if options.folds == "order":
        print_order(recordings)
        return 0
    for name, run in ways_of(options.kind, recordings):
        run()
        for one in recordings:
            if one.kind in FILMS:  # the coders of GazeCom call ringing a saccade
                one.found = np.where(one.found == RINGING, SACCADE, one.found)
        print(f"| {name} ", end="", flush=True)
        print_figures(recordings)
    return 0


if __name__ == "__main__":
    sys.exit(main())
