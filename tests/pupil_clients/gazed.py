"""A gazed under test, with the simulator unless told otherwise, and what all Pupil clients do."""
import bisect
import ctypes
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

try:
    import msgpack
    import zmq
except ImportError:
    print("no python3-zmq, python3-msgpack")
    sys.exit(77)

# Longest wait for a condition; as PATIENCE_S in tests/suite.h.
PATIENCE_S = int(os.environ.get("GZ_TEST_PATIENCE_S", "60"))


def die_with_parent():
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def prepare_child(files):
    die_with_parent()
    if files:
        resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))


class Gazed:
    """Runs until close(); its recordings are in .place.

    files: its limit of open files."""

    def __init__(self, program, *arguments, awaited="delivers samples", files=None, **variables):
        self.place = tempfile.mkdtemp(prefix="gz_pupil_")
        self.log_path = os.path.join(self.place, "stderr")
        environment = dict(os.environ, GAZECAST_RUNTIME_DIR=self.place, **variables)
        with open(self.log_path, "w") as log:
            self.process = subprocess.Popen(
                [program, "--control", "tcp://127.0.0.1:0",
                 "--recording.directory", self.place, *arguments],
                env=environment, stderr=log, preexec_fn=lambda: prepare_child(files))
        try:
            # Two threads write these lines, in either order.
            wait_for(lambda: (awaited in self.log() and self.told_port()) or
                     self.process.poll() is not None, "gazed does not begin")
            assert self.process.poll() is None, self.log()
            self.port = int(self.told_port()[1])
        except BaseException:
            self.close()
            raise

    def told_port(self):
        return re.search(r"control at tcp://127\.0\.0\.1:([1-9]\d*),", self.log())

    def log(self):
        with open(self.log_path) as file:
            return file.read()

    def memory_mib(self):
        """What it has in memory."""
        with open(f"/proc/{self.process.pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    def recordings(self):
        return sorted(name for name in os.listdir(self.place) if name.endswith(".gzl"))

    def mark_fields(self, name):
        """The fields of every mark of a recording."""
        with open(os.path.join(self.place, name)) as file:
            return [line.rstrip("\n").split("\t") for line in file if line.startswith("!mark")]

    def marks(self, name):
        """(time in s, text) of every mark of a recording."""
        return [(int(fields[1]) * 1e-9, fields[2]) for fields in self.mark_fields(name)]

    def close(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            status = self.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        if not os.path.exists(self.place):
            return
        text = self.log()
        shutil.rmtree(self.place)
        assert status == 0, f"gazed left with {status}: {text}"


def wait_for(condition, otherwise):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, otherwise
        time.sleep(0.005)


class Client:
    """Sockets as Pupil's example scripts open them. Every receive has a limit."""

    def __init__(self, gazed):
        self.context = zmq.Context()
        self.address = f"tcp://127.0.0.1:{gazed.port}"
        self.remote = self.socket(zmq.REQ)
        self.remote.connect(self.address)

    def socket(self, kind):
        socket_ = self.context.socket(kind)
        socket_.setsockopt(zmq.LINGER, 0)
        socket_.setsockopt(zmq.RCVTIMEO, PATIENCE_S * 1000)
        return socket_

    def ask(self, text):
        self.remote.send_string(text)
        return self.remote.recv_string()

    def notify(self, notification):
        """As the scripts' notify(): topic, then the map."""
        self.remote.send_string("notify." + notification["subject"], flags=zmq.SNDMORE)
        self.remote.send(msgpack.dumps(notification, use_bin_type=True))
        return self.remote.recv_string()

    def subscribe(self, *topics):
        subscriber = self.socket(zmq.SUB)
        subscriber.connect("tcp://127.0.0.1:" + self.ask("SUB_PORT"))
        for topic in topics:
            subscriber.setsockopt_string(zmq.SUBSCRIBE, topic)
        return subscriber

    def publisher(self):
        """A PUB socket that the daemon reads: its messages come back on the stream."""
        publisher = self.socket(zmq.PUB)
        publisher.connect("tcp://127.0.0.1:" + self.ask("PUB_PORT"))
        echo = self.subscribe("notify.are_you_there")
        deadline = time.monotonic() + PATIENCE_S
        while True:
            publisher.send_string("notify.are_you_there", flags=zmq.SNDMORE)
            publisher.send(msgpack.dumps({"subject": "are_you_there"}, use_bin_type=True))
            if echo.poll(20):
                return publisher
            assert time.monotonic() < deadline, "nothing that is published comes back"

    def close(self):
        self.context.destroy(linger=0)


def receive(subscriber):
    """A topic and a map, received like every script does."""
    topic = subscriber.recv_string()
    assert subscriber.get(zmq.RCVMORE), "a message of one frame"
    payload = msgpack.loads(subscriber.recv(), raw=False)
    assert not subscriber.get(zmq.RCVMORE), "a message of more than two frames"
    return topic, payload


def receive_topic(subscriber, wanted):
    deadline = time.monotonic() + PATIENCE_S
    while True:
        topic, payload = receive(subscriber)
        if topic == wanted:
            return payload
        assert time.monotonic() < deadline, f"{wanted} does not come"


class Bisector:
    """Data by their time, found by exactly that time, like PsychoPy's MutableBisector."""

    def __init__(self):
        self.times, self.data = [], []

    def insert(self, datum, timestamp):
        index = bisect.bisect_left(self.times, timestamp)
        self.times.insert(index, timestamp)
        self.data.insert(index, datum)

    def find(self, timestamp):
        index = bisect.bisect_left(self.times, timestamp)
        if index < len(self.times) and self.times[index] == timestamp:
            return self.data[index]
        return None
