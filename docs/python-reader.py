#!/usr/bin/env python3
"""Print where the eyes look, from the latest channel of gazed.

usage: python-reader.py [ENDPOINT [COUNT]]    (Debian: python3-zmq, python3-msgpack)
"""
import os
import sys

import msgpack
import zmq

session = os.environ.get("XDG_RUNTIME_DIR")
directory = os.environ.get("GAZECAST_RUNTIME_DIR") or (
    f"{session}/gazecast" if session
    else "/run/gazecast" if os.path.isdir("/run/gazecast")
    else f"/tmp/gazecast-{os.getuid()}")
endpoint = sys.argv[1] if len(sys.argv) > 1 else f"ipc://{directory}/latest"
count = int(sys.argv[2]) if len(sys.argv) > 2 else 0  # 0: until Ctrl-C

reader = zmq.Context().socket(zmq.SUB)
reader.setsockopt(zmq.CONFLATE, 1)  # hold the newest message only
reader.subscribe(b"")
reader.connect(endpoint)
while True:
    gaze = msgpack.unpackb(reader.recv())
    x, y = gaze["point"]  # of the screen: (0, 0) top left, (1, 1) bottom right
    print(f"{gaze['timestamp']:.3f} s  x {x:.3f}  y {y:.3f}  {gaze['event']}", flush=True)
    count -= 1
    if count == 0:
        break
