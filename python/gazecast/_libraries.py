"""The installed libraries, and their structs as ctypes has them.

The structs are those of protocol/gaze.h, client/client.h and client/stream.h; a test compares their layouts with
what the compiler makes of these headers. A library of another soname may have other layouts and is not loaded.
"""

from __future__ import annotations

import ctypes
import functools
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    Union,
    c_bool,
    c_char,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int64,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)

CLIENT_LIBRARY = "libgazecast.so.0"
RENDER_LIBRARY = "libgazecast-render.so.0"

OK = 0
ERR_TIMEOUT = -4

NAME_SIZE = 64
PATH_SIZE = 1024
REASON_SIZE = 160
LOG_RULES_SIZE = 256
EYES = 2


class GazecastError(RuntimeError):
    """A call of a library or program that failed. `code` is its enum gz_result (base/result.h), or 0."""

    def __init__(self, message: str, code: int = 0) -> None:
        super().__init__(message)
        self.code = code


class CPoint(Structure):
    """struct gz_point"""

    _fields_ = [("x", c_float), ("y", c_float)]


class CGazeEye(Structure):
    """struct gz_gaze_eye"""

    _fields_ = [
        ("point", CPoint),
        ("pupil_mm", c_float),
        ("valid", c_bool),
        ("confidence", c_float),
        ("origin_mm", c_float * 3),
        ("direction", c_float * 3),
    ]


class CLanding(Structure):
    """struct gz_landing"""

    _fields_ = [("known", c_bool), ("point", CPoint), ("time_ns", c_int64), ("sigma_deg", c_float)]


class CGaze(Structure):
    """struct gz_gaze"""

    _fields_ = [
        ("seq", c_uint64),
        ("device_ns", c_int64),
        ("host_ns", c_int64),
        ("publish_ns", c_int64),
        ("point", CPoint),
        ("raw", CPoint),
        ("confidence", c_float),
        ("event", c_int),
        ("final_known", c_bool),
        ("final_seq", c_uint64),
        ("final_span", c_uint64),
        ("final_event", c_int),
        ("velocity_deg_s", c_float),
        ("landing", CLanding),
        ("combined", c_bool),
        ("eye", CGazeEye * EYES),
    ]


class CFixation(Structure):
    """struct gz_fixation"""

    _fields_ = [
        ("id", c_uint64),
        ("onset_ns", c_int64),
        ("duration_ns", c_int64),
        ("dispersion_deg", c_float),
        ("point", CPoint),
        ("confidence", c_float),
        ("final", c_bool),
    ]


class CBlink(Structure):
    """struct gz_blink"""

    _fields_ = [("onset", c_bool), ("time_ns", c_int64), ("confidence", c_float)]


class CSaccade(Structure):
    """struct gz_saccade"""

    _fields_ = [
        ("start_ns", c_int64),
        ("duration_ns", c_int64),
        ("amplitude_deg", c_float),
        ("peak_velocity_deg_s", c_float),
        ("start", CPoint),
        ("end", CPoint),
    ]


class CTracker(Structure):
    """struct gz_status, member tracker"""

    _fields_ = [
        ("name", c_char * NAME_SIZE),
        ("serial", c_char * NAME_SIZE),
        ("state", c_int),
        ("reason", c_char * REASON_SIZE),
    ]


class CClock(Structure):
    """struct gz_clock_status"""

    _fields_ = [("offset_ns", c_int64), ("skew_ppm", c_double), ("sigma_ns", c_double), ("tick", c_int)]


class CDisplay(Structure):
    """struct gz_display"""

    _fields_ = [("px", c_int * 2), ("mm", c_double * 2), ("distance_mm", c_double)]


class CCorrection(Structure):
    """struct gz_status, member correction"""

    _fields_ = [("x", c_double * 3), ("y", c_double * 3)]


class CValidation(Structure):
    """struct gz_status, member validation"""

    _fields_ = [
        ("measured", c_char * NAME_SIZE),
        ("accuracy_deg", c_double),
        ("changed", c_char * REASON_SIZE),
    ]


class CRecording(Structure):
    """struct gz_status, member recording"""

    _fields_ = [
        ("state", c_int),
        ("file", c_char * PATH_SIZE),
        ("samples", c_uint64),
        ("error", c_char * REASON_SIZE),
    ]


class CStatus(Structure):
    """struct gz_status"""

    _fields_ = [
        ("tracker", CTracker),
        ("rate_hz_nominal", c_double),
        ("rate_hz_measured", c_double),
        ("samples", c_uint64),
        ("lost", c_uint64),
        ("rejected", c_uint64 * 8),
        ("malformed", c_uint64 * 5),
        ("refused", c_uint64 * 5),
        ("clock", CClock),
        ("noise_deg", c_double),
        ("still_scene", c_bool),
        ("display", CDisplay),
        ("correction", CCorrection),
        ("validation", CValidation),
        ("recording", CRecording),
        ("subscribers", c_uint32),
        ("version", c_char * NAME_SIZE),
    ]


class CMessageBody(Union):
    """struct gz_message, its union"""

    _fields_ = [
        ("gaze", CGaze),
        ("fixation", CFixation),
        ("blink", CBlink),
        ("saccade", CSaccade),
        ("status", CStatus),
    ]


class CMessage(Structure):
    """struct gz_message"""

    _anonymous_ = ("body",)
    _fields_ = [
        ("kind", c_int),
        ("topic", c_char * NAME_SIZE),
        ("received_ns", c_int64),
        ("lost", c_uint64),
        ("body", CMessageBody),
        ("bytes", c_void_p),
        ("size", c_size_t),
    ]


LogSink = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)


class CLog(Structure):
    """struct gz_log"""

    _fields_ = [("sink", LogSink), ("user", c_void_p), ("rules", c_char * LOG_RULES_SIZE)]


#: What the layout test compares: the name of the struct in C, and its mirror.
MIRRORS: dict[str, type[Structure]] = {
    "gz_gaze_eye": CGazeEye,
    "gz_landing": CLanding,
    "gz_gaze": CGaze,
    "gz_fixation": CFixation,
    "gz_blink": CBlink,
    "gz_saccade": CSaccade,
    "gz_clock_status": CClock,
    "gz_display": CDisplay,
    "gz_status": CStatus,
    "gz_message": CMessage,
    "gz_log": CLog,
}


def _load(name: str, package: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise GazecastError(f"{name} is not installed (Debian: {package}): {error}") from error


@functools.lru_cache(maxsize=None)
def client() -> ctypes.CDLL:
    """libgazecast with the types of the functions that this module calls."""
    library = _load(CLIENT_LIBRARY, "libgazecast0")
    prototypes = {
        "gz_log_init": (None, [POINTER(CLog), LogSink, c_void_p, c_char_p]),
        "gz_result_text": (c_char_p, [c_int]),
        "gz_event_name": (c_char_p, [c_int]),
        "gz_tracker_state_name": (c_char_p, [c_int]),
        "gz_recording_state_name": (c_char_p, [c_int]),
        "gz_client_open": (c_int, [c_char_p, POINTER(CLog), POINTER(c_void_p)]),
        "gz_client_latest": (c_int, [c_void_p, POINTER(CGaze), POINTER(c_int64)]),
        "gz_client_endpoint": (c_char_p, [c_void_p]),
        "gz_client_close": (None, [POINTER(c_void_p)]),
        "gz_stream_open": (c_int, [c_char_p, POINTER(c_char_p), POINTER(CLog), POINTER(c_void_p)]),
        "gz_stream_read": (c_int, [c_void_p, c_int, POINTER(CMessage)]),
        "gz_stream_endpoint": (c_char_p, [c_void_p]),
        "gz_stream_close": (None, [POINTER(c_void_p)]),
    }
    for name, (result, arguments) in prototypes.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library


@functools.lru_cache(maxsize=None)
def renderer() -> ctypes.CDLL:
    """libgazecast-render with the types of its functions."""
    library = _load(RENDER_LIBRARY, "libgazecast-render0")
    prototypes = {
        "gz_result_text": (c_char_p, [c_int]),
        "gz_renderer_open": (c_int, [c_char_p, c_int, POINTER(c_void_p)]),
        "gz_renderer_load": (c_int, [c_void_p, c_char_p]),
        "gz_renderer_set_volume": (
            c_int,
            [c_void_p, c_char_p, c_int * 3, POINTER(c_double), c_void_p, c_size_t],
        ),
        "gz_renderer_set_transfer": (c_int, [c_void_p, c_char_p]),
        "gz_renderer_set": (c_int, [c_void_p, c_char_p, c_char_p]),
        "gz_renderer_get": (c_int, [c_void_p, c_char_p, c_char_p, c_size_t]),
        "gz_renderer_draw": (
            c_int,
            [c_void_p, c_int, c_int, POINTER(c_double), c_void_p, c_size_t],
        ),
        "gz_renderer_cost_name": (c_char_p, [c_size_t]),
        "gz_renderer_cost": (c_double, [c_void_p, c_size_t]),
        "gz_renderer_describe": (c_char_p, [c_void_p]),
        "gz_renderer_message": (c_char_p, [c_void_p]),
        "gz_renderer_close": (None, [POINTER(c_void_p)]),
    }
    for name, (result, arguments) in prototypes.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library


class ErrorLog:
    """A log that keeps the last error, for the exception that follows. It must outlive what logs to it."""

    def __init__(self) -> None:
        self.last = ""
        self._sink = LogSink(self._take)
        self.log = CLog()
        client().gz_log_init(ctypes.byref(self.log), self._sink, None, b"*:warn")

    def _take(self, _user: int | None, _level: int, _module: bytes, message: bytes) -> None:
        self.last = message.decode(errors="replace")

    def check(self, what: str, code: int) -> None:
        """Raise what went wrong, unless nothing did."""
        if code != OK:
            text = self.last or client().gz_result_text(code).decode()
            raise GazecastError(f"{what}: {text}", code)
