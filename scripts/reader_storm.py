#!/usr/bin/env python3
"""Attack the TCP ports as any local user can, or the local sockets, and say what that does to other
readers and to the daemon's memory (docs/security.md):

    gazed --driver sim              # prints the port of the control socket
    scripts/reader_storm.py PORT PID [KIND...]
    scripts/reader_storm.py DIRECTORY PID [KIND...]     # the runtime directory

Only for a daemon of your own. Speaks ZMTP 3.0 without libzmq, which would be too slow.
"""
import multiprocessing
import os
import random
import resource
import socket
import struct
import sys
import time

GREETING = b"\xff" + bytes(8) + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + bytes(32)
READY = b"\x04\x19\x05READY\x0bSocket-Type\0\0\0\3SUB"
MIB = 1 << 20
ANSWER_SIZE = len(GREETING) + 28  # READY of an XPUB
SECONDS = 5
TOGETHER = 32  # connections that a process opens at a time


def frame(body):
    if len(body) < 256:
        return bytes([0, len(body)]) + body
    return b"\2" + struct.pack(">Q", len(body)) + body


def connect(port):
    """To a TCP port, or to the local socket with that path."""
    if isinstance(port, int):
        connection = socket.create_connection(("127.0.0.1", port), 2)
    else:
        connection = socket.socket(socket.AF_UNIX)
        connection.settimeout(2)
        connection.connect(port)
    connection.settimeout(2)
    return connection


def receive(connection, size):
    got = b""
    while len(got) < size:
        part = connection.recv(size - len(got))
        if not part:
            raise ConnectionError("closed")
        got += part
    return got


def topics(number, count, size):
    """Subscriptions to topics that nobody else has."""
    return b"".join(frame(b"\1" + b"%08d.%05d" % (number, i) + b"x" * (size - 14))
                    for i in range(count))


def open_readers(port, count, sent):
    """Connections with finished handshakes that have sent what sent(i) returns."""
    begun, readers = [], []
    for _ in range(count):
        try:
            connection = connect(port)
            connection.sendall(GREETING + READY)
            begun.append(connection)
        except OSError:
            pass
    for i, connection in enumerate(begun):
        try:
            receive(connection, ANSWER_SIZE)
            connection.sendall(sent(i))
            readers.append(connection)
        except OSError:
            connection.close()
    return readers


def close_all(connections):
    for connection in connections:
        connection.close()


def open_sender(port, kind):
    """A connection of a socket of @kind with a finished handshake."""
    ready = b"\5READY\x0bSocket-Type" + struct.pack(">I", len(kind)) + kind
    connection = connect(port)
    try:
        connection.sendall(GREETING + bytes([4, len(ready)]) + ready)
        receive(connection, len(GREETING))
        take_frame(connection)
    except OSError:
        connection.close()
        raise
    return connection


def ask(port, request):
    connection = open_sender(port, b"REQ")
    connection.sendall(b"\1\0" + frame(request))
    take_frame(connection)
    answer = take_frame(connection)
    connection.close()
    return int(answer)


def flood(port, end, kind, message):
    """Many connections that send all the time and do not read."""
    block, sent_of = message * 64, {}
    while time.monotonic() < end:
        for _ in range(TOGETHER if len(sent_of) < 500 else 0):
            try:
                connection = open_sender(port, kind)
                connection.setblocking(False)
                sent_of[connection] = 0
            except OSError:
                pass
        for connection, sent in list(sent_of.items()):
            try:
                sent_of[connection] = (sent + connection.send(block[sent:])) % len(block)
            except BlockingIOError:
                pass
            except OSError:
                connection.close()
                del sent_of[connection]
    close_all(sent_of)


def come_and_go(port, end, base, sent):
    number = base
    while time.monotonic() < end:
        close_all(open_readers(port, TOGETHER, lambda i, n=number: sent(n + i)))
        number += TOGETHER


def stay(port, end, sent):
    held = []
    while time.monotonic() < end:
        if len(held) < 1500:
            held += open_readers(port, TOGETHER, sent)
        else:
            time.sleep(0.1)
    close_all(held)


def burst(port, end, base):
    readers = open_readers(port, 300, lambda i: topics(base + i, 250, 200))
    time.sleep(0.2)
    close_all(readers)
    time.sleep(max(0, end - time.monotonic()))


def one(port, end, base):
    for reader in open_readers(port, 1, lambda i: b""):
        try:
            for k in range(300):
                reader.sendall(topics(base + k, 1000, 200))
        except OSError:
            pass
    time.sleep(max(0, end - time.monotonic()))


def half(port, end):
    held = []
    while time.monotonic() < end:
        try:
            held.append(connect(port))
            held[-1].sendall(GREETING[:11])
        except OSError:
            pass
        if len(held) > 4000:
            held.pop(0).close()
    close_all(held)


def mixture(number):
    return random.choice([frame(b"\1gaze"), topics(number, 250, 200), topics(number, 4, 200),
                          topics(number, 100, 15), os.urandom(200), b""])


KINDS = {
    "none": lambda port, end, base: time.sleep(2),
    "burst": burst,
    "one": one,
    "known": lambda port, end, base: come_and_go(port, end, base, lambda n: frame(b"\1gaze")),
    "strange": lambda port, end, base: come_and_go(port, end, base, lambda n: topics(n, 4, 200)),
    "ends": lambda port, end, base: come_and_go(
        port, end, base, lambda n: 1000 * (frame(b"\1ga") + frame(b"\0ga"))),
    "half": lambda port, end, base: half(port, end),
    "deaf": lambda port, end, base: stay(port, end, lambda i: frame(b"\1")),
    "mixture": lambda port, end, base: come_and_go(port, end, base, mixture),
}
LARGE = b"\x81\xa1x\xc5" + struct.pack(">H", 3000) + bytes(3000)  # {"x": bytes}
AT_OTHER_PORTS = {
    "inlet": (b"PUB_PORT", lambda port, end, base: flood(
        port, end, b"PUB", b"\1\5flood" + frame(LARGE))),
    "endless": (b"PUB_PORT", lambda port, end, base: flood(
        port, end, b"PUB", (b"\3" + frame(LARGE)[1:]))),
    "requests": (None, lambda port, end, base: flood(
        port, end, b"DEALER", b"\1\0" + frame(b"t"))),
}
IN_ONE_PROCESS = ("none", "burst", "one")


def take_frame(connection):
    flags, = receive(connection, 1)
    size, = struct.unpack(">Q", receive(connection, 8)) if flags & 2 else receive(connection, 1)
    return receive(connection, size)


def watch(port, ready, stop, gap):
    """The longest time between two messages of one reader."""
    reader, = open_readers(port, 1, lambda i: frame(b"\1gaze."))
    take_frame(reader)
    time.sleep(2)
    reader.setblocking(False)
    last = None
    ready.set()
    while not stop.is_set():
        now = time.monotonic()
        try:
            if not reader.recv(1 << 20):
                gap.value = float("inf")
                return
            if last is not None:
                gap.value = max(gap.value, now - last)
            last = now
        except BlockingIOError:
            time.sleep(0.001)
    gap.value = max(gap.value, time.monotonic() - last)


def arrive(port, stop, longest):
    """The longest time until a new reader has its first message."""
    while not stop.is_set():
        begin, served = time.monotonic(), False
        while not served and not stop.is_set():
            for reader in open_readers(port, 1, lambda i: frame(b"\1gaze.")):
                try:
                    served = bool(take_frame(reader))
                except OSError:
                    pass
                reader.close()
            longest.value = max(longest.value, time.monotonic() - begin)
            if not served:
                time.sleep(0.1)  # as libzmq
        time.sleep(0.2)


def memory(pid):
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / MIB


def port_of(control, request):
    """The port that the daemon names, or the local socket beside that for control."""
    if isinstance(control, int):
        return ask(control, request)
    name = {b"SUB_PORT": "stream", b"PUB_PORT": "inlet"}[request]
    return os.path.join(os.path.dirname(control), name)


def attack_of(kind, control, stream):
    """The port and the function."""
    if kind in KINDS:
        return stream, KINDS[kind]
    request, function = AT_OTHER_PORTS[kind]
    return port_of(control, request) if request else control, function


def run(control, pid, kind):
    port = port_of(control, b"SUB_PORT")
    attacked, function = attack_of(kind, control, port)
    before = peak = memory(pid)
    ready, stop = multiprocessing.Event(), multiprocessing.Event()
    gap, longest = multiprocessing.Value("d", 0), multiprocessing.Value("d", 0)
    others = [multiprocessing.Process(target=watch, args=(port, ready, stop, gap)),
              multiprocessing.Process(target=arrive, args=(port, stop, longest))]
    others[0].start()
    ready.wait(10)
    others[1].start()
    end = time.monotonic() + SECONDS
    attackers = [multiprocessing.Process(target=function, args=(attacked, end, 40000000 * k))
                 for k in range(1 if kind in IN_ONE_PROCESS else 2)]
    for attacker in attackers:
        attacker.start()
    while any(attacker.is_alive() for attacker in attackers):
        peak = max(peak, memory(pid))
        time.sleep(0.02)
    time.sleep(7)  # until the daemon takes what follows for another flood (daemon/door.h)
    stop.set()
    for other in others:
        other.join()
    print(f"{kind:8} longest gap {gap.value:.2f} s, a new reader waits {longest.value:.2f} s, memory "
          f"+{peak - before:.0f} MiB, then +{memory(pid) - before:.0f} MiB", flush=True)


def main():
    limit = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(limit, 8192), limit))
    kinds = [*KINDS, *AT_OTHER_PORTS]
    if (len(sys.argv) < 3 or not sys.argv[2].isdigit() or
            not set(sys.argv[3:]) <= set(kinds)):
        sys.exit(f"{__doc__}\nkinds: {' '.join(kinds)}")
    place = sys.argv[1]
    control = int(place) if place.isdigit() else os.path.join(place, "control")
    for kind in sys.argv[3:] or kinds:
        run(control, sys.argv[2], kind)


if __name__ == "__main__":
    main()
