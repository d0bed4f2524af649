"""A screen without a monitor."""

import os
import subprocess

from picture import skip


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
