"""A screen without a monitor, and what it shows."""

import mmap
import os
import struct
import subprocess
import tempfile

from picture import skip

try:
    from Xlib.display import Display
except ImportError:
    skip("python3-xlib is not installed")


def start_server(size):
    """An X server on a display that is free; it says which. -> process, name

    The process has its framebuffer in the file framebuffer_of() names."""
    shared = "/dev/shm"
    folder = tempfile.TemporaryDirectory(
        prefix="gazecast-test-screen-", dir=shared if os.access(shared, os.W_OK) else None)
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % size, "-nolisten", "tcp",
         "-noreset", "-r",  # no key repeats itself while a slow program is waited for
         "-nocursor", "-fbdir", folder.name],
        pass_fds=(write,), stderr=subprocess.DEVNULL,
    )
    server.framebuffer = folder  # removed with the process object
    os.close(write)
    with os.fdopen(read) as number:
        display = number.readline().strip()
    if not display:
        skip("Xvfb does not start")
    return server, ":" + display


class Screen:
    """Screenshots of a server. They are read from its framebuffer: a picture of a megabyte that
    comes through its socket costs a hundred times as much."""

    def __init__(self, server, name, size):
        self.size = size
        self.connection = Display(name)
        path = os.path.join(server.framebuffer.name, "Xvfb_screen0")
        with open(path, "rb") as file:
            self.memory = mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ)
        # The header of X11/XWDFile.h: 25 numbers, a name, 12 bytes for each colour of a table.
        header = struct.unpack(">25I", self.memory[:100])
        assert header[4:6] == size and header[11] == 32 and header[12] == 4 * size[0], header
        self.begin = header[0] + 12 * header[19]

    def close(self):
        self.connection.close()
        self.memory.close()

    def grab(self):
        """-> the pixels, four bytes each: blue, green, red, nothing"""
        # Nobody draws while the server listens to this connection alone; the answer to the second
        # request says that it does.
        self.connection.grab_server()
        self.connection.get_input_focus()
        pixels = self.memory[self.begin : self.begin + 4 * self.size[0] * self.size[1]]
        self.connection.ungrab_server()
        self.connection.flush()
        return pixels
