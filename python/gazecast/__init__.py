"""Gazecast in Python: where somebody looks, recordings of it, and pictures that are sharp there.

    import gazecast

    with gazecast.Latest() as latest:           # the newest gaze and its age
        gaze = latest.read()
    for message in gazecast.stream("gaze"):     # every message, in order
        ...
    recording = gazecast.read_recording("session.gzl")
    picture = gazecast.render(volume, gaze=(0.4, 0.6))

The module has no compiled code: it calls the installed libraries libgazecast and libgazecast-render, and
the program gazectl for recordings. docs/python.md has examples.

Gaze is in fractions of the display or picture: origin top left, (1, 1) bottom right.
"""

from ._libraries import GazecastError
from .live import Blink, Event, Eye, Fixation, Gaze, Latest, Other, Saccade, Status, Stream, stream
from .recordings import Recording, read_recording
from .renderer import Picture, Renderer, render

__all__ = [
    "Blink",
    "Event",
    "Eye",
    "Fixation",
    "Gaze",
    "GazecastError",
    "Latest",
    "Other",
    "Picture",
    "Recording",
    "Renderer",
    "Saccade",
    "Status",
    "Stream",
    "read_recording",
    "render",
    "stream",
]
