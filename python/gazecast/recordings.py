"""Recordings as numpy record arrays: gaze logs, and every recording that gazectl converts."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Union

import numpy as np

from ._libraries import GazecastError

Path = Union[str, "os.PathLike[str]"]

#: Columns that are texts or whole numbers; every other one is a float, NaN where nothing was measured.
_TEXTS = {"label": "U11", "kind": "U16", "text": object, "keys": object}
_WHOLE = {"seq": np.int64, "samples": np.int64}
_FLAGS = {"gaze_valid", "eye0_valid", "eye1_valid"}


@dataclass(frozen=True)
class Recording:
    """A recording. Points are fractions of the display; times are seconds of the recording's host clock."""

    #: One record a sample: seq, host_s, device_s, gaze_x, gaze_y, gaze_valid, then for eye0 (right) and eye1 (left)
    #: _x, _y, _valid, _confidence, _pupil_mm, _origin_*_mm, _dir_*, and label, what the eye did.
    samples: np.recarray
    #: One record a stretch of what the eye did: host_s, duration_s, label, samples, x, y, start_x, start_y, end_x,
    #: end_y, amplitude_deg, peak_deg_s.
    events: np.recarray
    #: Marks, gaps and the like: host_s, kind, text, duration_s, keys (a text in JSON).
    marks: np.recarray
    #: What `gazectl inspect --json` says: display, rate, noise, losses.
    summary: dict[str, Any]


def _find_gazectl() -> str:
    program = os.environ.get("GAZECTL") or shutil.which("gazectl")
    if not program:
        raise GazecastError("gazectl is not installed (Debian: gazecast); it reads recordings")
    return program


#: Exit status of gazectl after it has done its work with a log that is cut off or was changed.
_DAMAGED = 4


def _run(*arguments: Path) -> subprocess.CompletedProcess[str]:
    program = _find_gazectl()
    try:
        done = subprocess.run(
            [program, *(os.fspath(each) for each in arguments)], capture_output=True, text=True, check=False
        )
    except OSError as error:
        raise GazecastError(f"{program} cannot be run: {error.strerror}; GAZECTL may name another gazectl") from error
    if done.returncode not in (0, _DAMAGED):
        raise GazecastError(done.stderr.strip() or f"gazectl ends with status {done.returncode}", done.returncode)
    return done


def _type_of(name: str) -> Any:
    if name in _FLAGS:
        return np.bool_
    return _TEXTS.get(name) or _WHOLE.get(name) or np.float64


def _convert(name: str, column: list[str]) -> np.ndarray:
    kind = _type_of(name)
    if kind is np.bool_:
        return np.array([text == "1" for text in column], dtype=np.bool_)
    if name in _TEXTS:
        return np.array(column, dtype=kind)
    if kind is np.int64:
        return np.array([int(text) if text else 0 for text in column], dtype=kind)
    return np.array([text or "nan" for text in column], dtype="U32").astype(np.float64)


def _read_quoted(path: pathlib.Path) -> tuple[list[str], list[list[str]]]:
    import csv

    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = next(rows)
        return names, list(rows)


def _read_table(path: pathlib.Path) -> np.recarray:
    """A table of gazectl as a record array."""
    names, rows = _read_quoted(path)
    columns = list(zip(*rows)) if rows else [()] * len(names)
    arrays = [_convert(name, list(column)) for name, column in zip(names, columns)]
    table = np.empty(len(rows), dtype=[(name, array.dtype) for name, array in zip(names, arrays)])
    for name, array in zip(names, arrays):
        table[name] = array
    return table.view(np.recarray)


_NO_MARKS = np.dtype(
    [("host_s", np.float64), ("kind", "U16"), ("text", object), ("duration_s", np.float64), ("keys", object)]
)


def _options(settings: Mapping[str, object]) -> list[str]:
    """Keyword arguments as options of gazectl: display_mm=(380, 300) is --display.mm "380 300"."""
    options = []
    for name, value in settings.items():
        for section in ("display", "table"):
            if name.startswith(section + "_"):
                name = section + "." + name[len(section) + 1 :]
        text = " ".join(map(str, value)) if isinstance(value, (tuple, list)) else str(value)
        options.append(f"--{name.replace('_', '-') if '.' not in name else name}={text}")
    return options


def read_recording(path: Path, **settings: object) -> Recording:
    """Read a gaze log, or a recording of another program that `gazectl convert` reads (docs/recordings.md).

    settings are options of `gazectl convert` with "_" for "." and "-": display_px="1920x1080",
    display_mm=(380, 300), display_distance_mm=670, rate_hz=250, table_columns="time=t;x=gx;y=gy", format is from_.

    A log that is cut off or was changed is read as far as it is valid, with a RuntimeWarning; summary["ending"] is then
    "cut" or "corrupted". Raises GazecastError with gazectl's own words if the file is not one of these.
    """
    source = pathlib.Path(path)
    if "from_" in settings:
        settings["from"] = settings.pop("from_")
    with tempfile.TemporaryDirectory(prefix="gazecast-") as folder:
        log = pathlib.Path(folder, "recording.gzl")
        done = None
        if source.suffix == ".gzl" and not settings:
            log = source
        else:
            done = _run("convert", *_options(settings), "--", source, log)
        samples, events = pathlib.Path(folder, "samples.csv"), pathlib.Path(folder, "events.csv")
        marks = pathlib.Path(folder, "samples_events.csv")
        _run("convert", "--labels", "--", log, samples)
        _run("label", "--out", events, "--", log)
        inspected = _run("inspect", "--json", "--", log)
        summary = json.loads(inspected.stdout)
        for each in (done, inspected):
            if each and each.returncode == _DAMAGED:
                warnings.warn(each.stderr.strip(), RuntimeWarning, stacklevel=2)
        return Recording(
            samples=_read_table(samples),
            events=_read_table(events),
            marks=_read_table(marks) if marks.exists() else np.empty(0, _NO_MARKS).view(np.recarray),
            summary=summary,
        )
