"""gazebench run as a Slurm array job: the shards merge to what one run measures.

slurm.py GAZEBENCH

Starts munge and a Slurm of one node on loopback with a configuration, keys, sockets, ports and
folders of their own, as whoever runs the test, and ends and removes all of it. Exits 77 where
their packages are missing.
"""

import contextlib
import csv
import ctypes
import getpass
import itertools
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

GAZEBENCH = os.path.abspath(sys.argv[1])
SKIPPED = 77
SHARDS = 4
PATH = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo"]
TIMES = {"plan_ms", "cast_ms", "reconstruct_ms", "frame_ms", "gpu_ms", "prepare_ms"}
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36

SCENE = """[volume]
procedural = shells
dims = 24 24 24
[transfer]
file = a.tf
"""

CONFIGURATION = """ClusterName=gazecast
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={place}/munge.socket
CredType=cred/munge
SlurmctldPort={controller_port}
SlurmdPort={node_port}
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
SlurmctldLogFile={place}/slurmctld.log
SlurmdLogFile={place}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={shards} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=5 State=UP
"""

JOB = """#!/bin/sh
#SBATCH --array=1-{shards}
exec {measure} --out part-$SLURM_ARRAY_TASK_ID \\
    --shard $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT
"""

prctl = ctypes.CDLL(None, use_errno=True).prctl


def die_with_parent():
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def children():
    """Of this process, and orphans that its own have left behind, which it inherits."""
    found = []
    for thread in os.listdir("/proc/self/task"):
        with open(f"/proc/self/task/{thread}/children") as file:
            found += [int(pid) for pid in file.read().split()]
    return found


def end_children():
    """Until none is left: what one of them leaves behind is a child next time."""
    until = time.monotonic() + 10
    while time.monotonic() < until:
        pids = children()
        if not pids:
            return
        for pid in pids:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            with contextlib.suppress(ChildProcessError):
                os.waitpid(pid, 0)
    raise RuntimeError(f"still there: {children()}")


def is_free(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) != 0


def free_ports(count):
    """Below those that the system gives to whoever asks for any (ip(7), ip_local_port_range)."""
    return list(itertools.islice(filter(is_free, random.sample(range(10240, 30240), 1000)), count))


class Cluster:
    """A Slurm of one node in a folder."""

    def __init__(self, place):
        self.place = place
        self.environment = dict(
            os.environ, PATH=PATH, SLURM_CONF=os.path.join(place, "slurm.conf"),
            XDG_CACHE_HOME=os.path.join(place, "cache")
        )
        for name in list(self.environment):
            if name.startswith(("SLURM_", "SBATCH_", "SQUEUE_")) and name != "SLURM_CONF":
                del self.environment[name]

    def write(self, name, text, mode=0o600):
        path = os.path.join(self.place, name)
        with open(path, "wb") as file:
            os.chmod(path, mode)
            file.write(text if isinstance(text, bytes) else text.encode())

    def run(self, *command):
        return subprocess.run(
            command, cwd=self.place, env=self.environment, capture_output=True, text=True,
            timeout=60
        )

    def start(self, *command):
        with open(os.path.join(self.place, command[0] + ".said"), "wb") as said:
            subprocess.Popen(
                command, cwd=self.place, env=self.environment, stdin=subprocess.DEVNULL,
                stdout=said, stderr=said, start_new_session=True, preexec_fn=die_with_parent
            )

    def wait(self, what, condition, seconds):
        until = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > until:
                raise RuntimeError(f"{what}: not within {seconds} s")
            time.sleep(0.1)

    def start_munge(self):
        self.write("munge.key", os.urandom(1024), 0o400)
        sock = os.path.join(self.place, "munge.socket")
        kinds = ("key", "log", "pid", "seed")
        files = [f"--{kind}-file={self.place}/munge.{kind}" for kind in kinds]
        self.start("munged", "--foreground", "--force", f"--socket={sock}", *files)
        self.wait("munge", lambda: os.path.exists(sock), 20)

    def node_is_idle(self):
        return self.run("sinfo", "--noheader", "--format=%t").stdout.split() == ["idle"]

    def start_slurm(self):
        controller_port, node_port = free_ports(2)
        self.write("slurm.conf", CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user=getpass.getuser(), place=self.place,
            controller_port=controller_port, node_port=node_port, shards=SHARDS), 0o644)
        for folder in ("state", "spool"):
            os.mkdir(os.path.join(self.place, folder), 0o755)
        self.start("slurmctld", "-D", "-c")
        self.start("slurmd", "-D", "-c")
        self.wait("the node", self.node_is_idle, 40)

    def tell_all(self):
        for name in sorted(os.listdir(self.place)):
            if name.endswith((".log", ".said", ".out")):
                with open(os.path.join(self.place, name), errors="replace") as file:
                    print(f"--- {name}", file.read()[-4000:], sep="\n", file=sys.stderr)


def check(done):
    if done.returncode != 0:
        raise RuntimeError(f"{done.args}: {done.returncode}: {done.stderr}")
    return done.stdout


def measured(place, folder):
    """Rows without times: what must be the same."""
    with open(os.path.join(place, folder, "frames.csv"), newline="") as file:
        return [
            {name: value for name, value in row.items() if name not in TIMES}
            for row in csv.DictReader(file)
        ]


def run_array(cluster, measure):
    cluster.write("study.sh", JOB.format(shards=SHARDS, measure=" ".join(measure)), 0o700)
    job = check(cluster.run("sbatch", "--parsable", "--output=job-%a.out", "study.sh")).strip()
    cluster.wait(
        "the job", lambda: not check(cluster.run("squeue", "--noheader", "--jobs", job)).split(), 60
    )
    parts = [f"part-{i + 1}" for i in range(SHARDS)]
    check(cluster.run(GAZEBENCH, "merge", "merged", *parts))
    return parts


def shards_of_an_array_job_merge_to_what_one_run_measures(cluster):
    cluster.write("a.tf", "0 0 0 0 0\n0.3 1 0 0 0.1\n1 1 1 1 0.9\n")
    cluster.write("a.scene", SCENE)
    measure = [
        GAZEBENCH, "run", "a.scene", "--size", "32x24", "--methods", "acuity,mdc", "--frames", "2",
        "--path", "grid:3x2", "--backend", "cpu:threads=1"
    ]
    check(cluster.run(*measure, "--out", "alone"))
    parts = run_array(cluster, measure)
    alone, merged = measured(cluster.place, "alone"), measured(cluster.place, "merged")
    counts = [len(measured(cluster.place, part)) for part in parts]
    if len(alone) != 6 * 3 * 2 or sum(counts) != len(alone) or min(counts) == 0:
        raise AssertionError(f"{len(alone)} rows alone, in shards {counts}")
    for i, (one, other) in enumerate(zip(alone, merged)):
        if one != other:
            raise AssertionError(f"row {i} alone {one}, merged {other}")
    if len(merged) != len(alone):
        raise AssertionError(f"{len(merged)} rows merged, {len(alone)} alone")
    print(f"{len(merged)} rows, shards of {counts}: the same as one run's")


def main():
    missing = [name for name in PROGRAMS if not shutil.which(name, path=PATH)]
    if missing:
        print("not installed:", *missing)
        return SKIPPED
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    place = tempfile.mkdtemp(prefix="gz-slurm-")
    os.chmod(place, 0o755)
    cluster = Cluster(place)
    try:
        cluster.start_munge()
        cluster.start_slurm()
        shards_of_an_array_job_merge_to_what_one_run_measures(cluster)
    except BaseException:
        cluster.tell_all()
        raise
    finally:
        end_children()
        shutil.rmtree(place)
    return 0


sys.exit(main())
