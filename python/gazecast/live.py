"""The gaze of a running daemon: the newest one, and every message of the stream."""

from __future__ import annotations

import ctypes
import enum
import math
from collections.abc import Iterator
from ctypes import byref, c_char_p, c_int64, c_void_p
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Union

from . import _libraries as lib

Point = tuple[float, float]

#: How long a read of the stream waits before it lets Python see signals such as Ctrl-C, ms.
_POLL_MS = 100


class Event(enum.Enum):
    """What the eyes do."""

    FIXATION = 0
    SACCADE = 1
    PURSUIT = 2
    BLINK = 3
    LOST = 4
    OSCILLATION = 5


@dataclass(frozen=True)
class Eye:
    """One eye of a gaze. What was not measured is NaN."""

    point: Point
    pupil_mm: float
    valid: bool  #: according to the tracker
    confidence: float  #: 0 to 1
    origin_mm: tuple[float, float, float]  #: centre of the eye in the tracker's coordinates
    direction: tuple[float, float, float]  #: unit vector from the eye to the gaze point


@dataclass(frozen=True)
class Gaze:
    """One gaze. Times are seconds of this machine's monotonic clock: time.clock_gettime(CLOCK_MONOTONIC)."""

    seq: int
    time_s: float  #: of the exposure
    age_s: float  #: when it was read; NaN in the stream
    point: Point  #: smoothed; during a blink the last one
    raw: Point  #: before smoothing; NaN if the sample was rejected
    confidence: float  #: 0 to 1; 0 during a blink and while the gaze is lost
    event: Event  #: as known at once
    certain: tuple[int, int, Event] | None  #: first seq, last seq and the event that is certain for them now
    velocity_deg_s: float
    landing: tuple[Point, float, float] | None  #: of a saccade: point, time_s, 68 % of landings within degrees
    combined: bool  #: the tracker gives one point for both eyes
    right: Eye
    left: Eye
    lost: int = 0  #: of the stream: gaze messages missed just before this one


@dataclass(frozen=True)
class Fixation:
    """A fixation: sent at its onset, while it lasts, and once at its end."""

    id: int
    onset_s: float
    duration_s: float  #: so far
    dispersion_deg: float
    point: Point  #: the centre of its samples
    confidence: float
    final: bool  #: the last message about it


@dataclass(frozen=True)
class Blink:
    """The beginning or the end of a blink."""

    onset: bool
    time_s: float
    confidence: float


@dataclass(frozen=True)
class Saccade:
    """A finished saccade."""

    start_s: float
    duration_s: float
    amplitude_deg: float
    peak_velocity_deg_s: float
    start: Point
    end: Point


@dataclass(frozen=True)
class Status:
    """The daemon's state: sent once a second and when it changes."""

    tracker: str
    serial: str
    state: str  #: "absent", "starting", "running", "lost" or "ended"
    reason: str  #: why it does not run
    rate_hz: float  #: measured
    samples: int
    lost: int
    noise_deg: float
    display_px: tuple[int, int]
    display_mm: Point
    distance_mm: float
    recording: str  #: "off", "on" or "failed"
    recording_file: str
    version: str


@dataclass(frozen=True)
class Other:
    """A message of another topic, such as "surfaces.screen": a MessagePack map (docs/protocol.md)."""

    topic: str
    data: bytes


Message = Union[Gaze, Fixation, Blink, Saccade, Status, Other]


def _seconds(ns: int) -> float:
    return ns * 1e-9


def _point(point: lib.CPoint) -> Point:
    return (point.x, point.y)


def _direction(numbers: Any) -> tuple[float, float, float]:
    return (numbers[0], numbers[1], numbers[2])


def _eye(eye: lib.CGazeEye) -> Eye:
    return Eye(
        _point(eye.point), eye.pupil_mm, eye.valid, eye.confidence, _direction(eye.origin_mm), _direction(eye.direction)
    )


def _gaze(gaze: lib.CGaze, age_s: float, lost: int) -> Gaze:
    certain = None
    if gaze.final_known:
        certain = (gaze.final_seq - gaze.final_span, gaze.final_seq, Event(gaze.final_event))
    landing = None
    if gaze.landing.known:
        landing = (_point(gaze.landing.point), _seconds(gaze.landing.time_ns), gaze.landing.sigma_deg)
    return Gaze(
        seq=gaze.seq,
        time_s=_seconds(gaze.host_ns),
        age_s=age_s,
        point=_point(gaze.point),
        raw=_point(gaze.raw),
        confidence=gaze.confidence,
        event=Event(gaze.event),
        certain=certain,
        velocity_deg_s=gaze.velocity_deg_s,
        landing=landing,
        combined=gaze.combined,
        right=_eye(gaze.eye[0]),
        left=_eye(gaze.eye[1]),
        lost=lost,
    )


def _fixation(fixation: lib.CFixation) -> Fixation:
    return Fixation(
        fixation.id,
        _seconds(fixation.onset_ns),
        _seconds(fixation.duration_ns),
        fixation.dispersion_deg,
        _point(fixation.point),
        fixation.confidence,
        fixation.final,
    )


def _saccade(saccade: lib.CSaccade) -> Saccade:
    return Saccade(
        _seconds(saccade.start_ns),
        _seconds(saccade.duration_ns),
        saccade.amplitude_deg,
        saccade.peak_velocity_deg_s,
        _point(saccade.start),
        _point(saccade.end),
    )


def _status(status: lib.CStatus) -> Status:
    library = lib.client()
    return Status(
        tracker=status.tracker.name.decode(),
        serial=status.tracker.serial.decode(),
        state=library.gz_tracker_state_name(status.tracker.state).decode(),
        reason=status.tracker.reason.decode(),
        rate_hz=status.rate_hz_measured,
        samples=status.samples,
        lost=status.lost,
        noise_deg=status.noise_deg,
        display_px=(status.display.px[0], status.display.px[1]),
        display_mm=(status.display.mm[0], status.display.mm[1]),
        distance_mm=status.display.distance_mm,
        recording=library.gz_recording_state_name(status.recording.state).decode(),
        recording_file=status.recording.file.decode(),
        version=status.version.decode(),
    )


def _message(message: lib.CMessage) -> Message:
    makers = (
        lambda: _gaze(message.gaze, math.nan, message.lost),
        lambda: _fixation(message.fixation),
        lambda: Blink(message.blink.onset, _seconds(message.blink.time_ns), message.blink.confidence),
        lambda: _saccade(message.saccade),
        lambda: _status(message.status),
    )
    if message.kind < len(makers):
        return makers[message.kind]()
    return Other(message.topic.decode(), ctypes.string_at(message.bytes, message.size))


class _Connection:
    """What the newest gaze and the stream have in common: a handle that is closed once."""

    _close_name: str

    def __init__(self) -> None:
        self._errors = lib.ErrorLog()
        self._handle = c_void_p()

    def close(self) -> None:
        """End the connection. May be called several times."""
        getattr(lib.client(), self._close_name)(byref(self._handle))

    def _open(self) -> c_void_p:
        if not self._handle:
            raise GazecastClosed("the connection is closed")
        return self._handle

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


class GazecastClosed(lib.GazecastError):
    """A call on something that is closed."""


class Latest(_Connection):
    """The newest gaze of a daemon. It can never lag, and a daemon may start later, end and return.

    endpoint: a ZeroMQ endpoint of a channel `latest`; None: that of the daemon on this machine. One thread
    at a time.
    """

    _close_name = "gz_client_close"

    def __init__(self, endpoint: str | None = None) -> None:
        super().__init__()
        code = lib.client().gz_client_open(
            endpoint.encode() if endpoint else None, byref(self._errors.log), byref(self._handle)
        )
        self._errors.check("the newest gaze", code)

    def __enter__(self) -> Latest:
        return self

    def read(self) -> Gaze | None:
        """The newest gaze; None before the first. Never waits. Check its age: nothing newer may have come."""
        gaze = lib.CGaze()
        age = c_int64()
        code = lib.client().gz_client_latest(self._open(), byref(gaze), byref(age))
        if code == lib.ERR_TIMEOUT:
            return None
        self._errors.check("the newest gaze", code)
        return _gaze(gaze, _seconds(age.value), 0)


class Stream(_Connection):
    """Every message of a daemon's stream, in order: an iterator. It ends with close() only.

    topics: prefixes such as "gaze" or "fixations" (docs/protocol.md); none: everything. endpoint: as for Latest.
    timeout_s: how long iterating waits for a message before it ends; None: for ever. One thread at a time.
    """

    _close_name = "gz_stream_close"

    def __init__(self, *topics: str, endpoint: str | None = None, timeout_s: float | None = None) -> None:
        super().__init__()
        self.timeout_s = timeout_s
        names = (c_char_p * (len(topics) + 1))(*[topic.encode() for topic in topics], None)
        code = lib.client().gz_stream_open(
            endpoint.encode() if endpoint else None, names, byref(self._errors.log), byref(self._handle)
        )
        self._errors.check("the stream", code)

    def __enter__(self) -> Stream:
        return self

    def read(self, timeout_s: float | None = None) -> Message | None:
        """The next message; None if none comes for so long. None waits for ever; Ctrl-C ends the wait."""
        message = lib.CMessage()
        left_ms = math.inf if timeout_s is None else timeout_s * 1000
        while True:
            wait_ms = int(max(0, min(left_ms, _POLL_MS)))
            code = lib.client().gz_stream_read(self._open(), wait_ms, byref(message))
            if code != lib.ERR_TIMEOUT:
                self._errors.check("the stream", code)
                return _message(message)
            left_ms -= wait_ms
            if left_ms <= 0:
                return None

    def __iter__(self) -> Iterator[Message]:
        return self

    def __next__(self) -> Message:
        message = self.read(self.timeout_s)
        if message is None:
            raise StopIteration
        return message


def stream(*topics: str, endpoint: str | None = None, timeout_s: float | None = None) -> Stream:
    """Iterate over the messages of a daemon's stream: Stream(...)."""
    return Stream(*topics, endpoint=endpoint, timeout_s=timeout_s)
