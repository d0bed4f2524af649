"""Pictures of volumes, sharp where somebody looks: numpy array in, RGBA array out."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterable, Mapping, Sequence
from ctypes import byref, c_double, c_int, c_void_p
from types import TracebackType
from typing import NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _libraries as lib

#: Rows (value, r, g, b, a) with values of the data and the rest 0 to 1, the text of a .tf file, or None.
Transfer = Union[str, Sequence[Sequence[float]], npt.NDArray[np.floating], None]

Value = Union[str, float, bool, Iterable[float]]

_VALUE_SIZE = 4096
_TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


class Picture(NamedTuple):
    """A picture and what it cost."""

    rgba: npt.NDArray[np.uint8]  #: height x width x 4, row 0 on top, A = 255
    cost: dict[str, float]  #: total_ms, plan_ms, prepare_ms, cast_ms, reconstruct_ms, rays, samples


def _text(value: Value) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return " ".join(_text(part) for part in value)


def _transfer_text(transfer: Transfer) -> str | None:
    if transfer is None or isinstance(transfer, str):
        return transfer
    rows = np.asarray(transfer, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 5 or rows.shape[0] == 0:
        raise ValueError("a transfer function has rows of five numbers: value, r, g, b, a")
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    least, greatest = rows[0, 0], rows[-1, 0]
    lines = []
    if greatest > least:
        lines.append(f"range {float(least)!r} {float(greatest)!r}")
        rows[:, 0] = (rows[:, 0] - least) / (greatest - least)
    else:
        rows = rows[:1].copy()
        rows[0, 0] = 0
    lines += [" ".join(repr(float(number)) for number in row) for row in rows]
    return "\n".join(lines) + "\n"


class Renderer:
    """Draws one volume or scene, again and again. One thread at a time.

    backend: "cpu", "gl" or "auto". threads: of cpu; 0: one for each processor.
    """

    def __init__(self, backend: str = "auto", threads: int = 0) -> None:
        self._library = lib.renderer()
        self._handle = c_void_p()
        code = self._library.gz_renderer_open(backend.encode(), threads, byref(self._handle))
        if code != lib.OK:
            raise lib.GazecastError(f"renderer: {self._library.gz_result_text(code).decode()}", code)

    def _check(self, code: int) -> None:
        if code != lib.OK:
            text = self._library.gz_renderer_message(self._handle) or self._library.gz_result_text(code)
            raise lib.GazecastError(text.decode(errors="replace"), code)

    def _open(self) -> c_void_p:
        if not self._handle:
            raise lib.GazecastError("the renderer is closed")
        return self._handle

    def load(self, path: str | os.PathLike[str]) -> None:
        """Show a scene file, or a volume that gazeview opens. Every key takes the file's value or its preset."""
        self._check(self._library.gz_renderer_load(self._open(), os.fsencode(path)))

    def set_volume(self, volume: npt.ArrayLike, spacing: Sequence[float] | None = None) -> None:
        """Show an array with axes x, y, z, as nibabel has it; an array with axes z, y, x is given as array.T.

        Types: int8 to int32, uint8 to uint32, float32 and float64. spacing: of voxel centres along x, y, z, mm;
        None: 1. The voxels are copied.
        """
        array = np.asarray(volume)
        if array.ndim != 3:
            raise ValueError(f"a volume has three axes, not {array.ndim}")
        if array.dtype == np.bool_:
            array = array.astype(np.uint8)
        elif array.dtype == np.float16:
            array = array.astype(np.float32)
        if array.dtype.name not in _TYPES:
            raise TypeError(f"voxels cannot be {array.dtype}; convert them to one of {', '.join(_TYPES)}")
        array = np.asfortranarray(array, dtype=array.dtype.newbyteorder("="))
        steps = None if spacing is None else (c_double * 3)(*spacing)
        self._check(
            self._library.gz_renderer_set_volume(
                self._open(),
                array.dtype.name.encode(),
                (c_int * 3)(*array.shape),
                steps,
                array.ctypes.data_as(c_void_p),
                array.nbytes,
            )
        )

    def set_transfer(self, transfer: Transfer) -> None:
        """Set the transfer function: rows (value, r, g, b, a), where value is a value of the data and opacity a is
        for one voxel length; the text of a .tf file; or None: one by the histogram of each volume."""
        text = _transfer_text(transfer)
        self._check(
            self._library.gz_renderer_set_transfer(self._open(), None if text is None else text.encode())
        )

    def set(self, key: str, value: Value) -> None:
        """Set a key of a scene (docs/scenes.md): set("camera.eye", (0, -2, 0)), set("render.shading", "gradient")."""
        self._check(self._library.gz_renderer_set(self._open(), key.encode(), _text(value).encode()))

    def get(self, key: str) -> str:
        """The value of a key as text."""
        text = ctypes.create_string_buffer(_VALUE_SIZE)
        self._check(self._library.gz_renderer_get(self._open(), key.encode(), text, _VALUE_SIZE))
        return text.value.decode()

    def draw(
        self,
        size: tuple[int, int] = (1280, 720),
        gaze: Sequence[float] | None = None,
        out: npt.NDArray[np.uint8] | None = None,
    ) -> Picture:
        """Draw a picture of size (width, height). gaze: where it is sharp; None: in the centre.

        out: a contiguous array of uint8, height x width x 4, to be filled; None: a new one.
        """
        width, height = size
        if out is None:
            out = np.empty((max(height, 0), max(width, 0), 4), dtype=np.uint8)
        if out.shape != (height, width, 4) or out.dtype != np.uint8 or not out.flags.c_contiguous:
            raise ValueError("out is no contiguous array of uint8, height x width x 4")
        if gaze is not None and len(gaze) != 2:
            raise ValueError(f"a gaze has two numbers, x and y, not {len(gaze)}")
        point = None if gaze is None else (c_double * 2)(*gaze)
        self._check(
            self._library.gz_renderer_draw(
                self._open(), width, height, point, out.ctypes.data_as(c_void_p), out.nbytes
            )
        )
        return Picture(out, self._cost())

    def _cost(self) -> dict[str, float]:
        cost: dict[str, float] = {}
        while name := self._library.gz_renderer_cost_name(len(cost)):
            cost[name.decode()] = self._library.gz_renderer_cost(self._handle, len(cost))
        return cost

    def describe(self) -> str:
        """What draws, such as "cpu: avx2, 2 threads"; "" before the first picture."""
        return self._library.gz_renderer_describe(self._open()).decode()

    def close(self) -> None:
        """Free everything. May be called several times."""
        self._library.gz_renderer_close(byref(self._handle))

    def __enter__(self) -> Renderer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self.close()


def render(
    volume: npt.ArrayLike,
    transfer: Transfer = None,
    camera: Mapping[str, Value] | None = None,
    gaze: Sequence[float] | None = None,
    method: str = "acuity",
    *,
    size: tuple[int, int] = (1280, 720),
    spacing: Sequence[float] | None = None,
    settings: Mapping[str, Value] | None = None,
    backend: str = "auto",
    threads: int = 0,
) -> Picture:
    """Draw one picture of an array with axes x, y, z. For several pictures of one volume use Renderer.

    transfer: as Renderer.set_transfer(). camera: keys of section [camera], such as {"eye": (0, -2, 0), "up":
    (0, 0, 1), "fov_deg": 40}, in units of the volume's longest edge with the centre at 0 0 0; None: one that sees
    all of it. gaze: fractions of the picture; None: its centre. method: "standard" (a ray for every pixel),
    "acuity", "contrast", "mdc", "ddc", "mdc3" or "uniform". settings: further keys of a scene.
    """
    with Renderer(backend, threads) as renderer:
        for key, value in (settings or {}).items():
            renderer.set(key, value)
        for key, value in (camera or {}).items():
            renderer.set(f"camera.{key}", value)
        renderer.set("foveation.method", method)
        renderer.set_transfer(transfer)
        renderer.set_volume(volume, spacing)
        return renderer.draw(size, gaze)
