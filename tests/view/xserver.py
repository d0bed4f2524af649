"""A screen without a monitor, and what it shows."""

import os
import subprocess

from picture import skip

try:
    from Xlib import X
    from Xlib.display import Display
except ImportError:
    skip("python3-xlib is not installed")


def start_server(size):
    """An X server on a display that is free; it says which. -> process, name"""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % size, "-nolisten", "tcp",
         "-noreset", "-r"],  # no key repeats itself while a slow program is waited for
        pass_fds=(write,), stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read) as number:
        display = number.readline().strip()
    if not display:
        skip("Xvfb does not start")
    return server, ":" + display


class Screen:
    """Screenshots of a server without the mouse pointer, over one connection."""

    def __init__(self, name, size):
        self.size = size
        self.connection = Display(name)
        self.root = self.connection.screen().root

    def close(self):
        self.connection.close()

    def grab(self):
        """-> a bytes object for each of red, green and blue, row after row"""
        data = self.root.get_image(0, 0, *self.size, X.ZPixmap, 0xffffffff).data
        assert len(data) == 4 * self.size[0] * self.size[1], len(data)
        return data[2::4], data[1::4], data[0::4]  # 24 bits of 32, little-endian
