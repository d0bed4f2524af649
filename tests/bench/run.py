"""gazebench run, merge and --list, as somebody at a command line sees them.

run.py GAZEBENCH
"""

import csv
import json
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

GAZEBENCH = sys.argv[1]

SCENE = """[volume]
procedural = shells
dims = 24 24 24
[transfer]
file = a.tf
"""
TIMES = {"plan_ms", "cast_ms", "reconstruct_ms", "frame_ms", "gpu_ms", "prepare_ms"}


class Run(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.write("a.tf", "0 0 0 0 0\n0.3 1 0 0 0.1\n1 1 1 1 0.9\n")
        self.write("a.scene", SCENE)

    def write(self, name, text):
        with open(os.path.join(self.place.name, name), "w") as file:
            file.write(text)

    def command(self, *arguments):
        return [GAZEBENCH, *arguments]

    def measure(self, out, *more):
        return self.command(
            "run", "a.scene", "--size", "32x24", "--methods", "acuity", "--frames", "2",
            "--cache", "cache", "--out", out, *more
        )

    def gazebench(self, command, **more):
        return subprocess.run(
            command, cwd=self.place.name, capture_output=True, text=True, timeout=50, **more
        )

    def rows(self, out):
        """Rows without times."""
        with open(os.path.join(self.place.name, out, "frames.csv"), newline="") as file:
            return [
                {name: value for name, value in row.items() if name not in TIMES}
                for row in csv.DictReader(file)
            ]

    def complete(self, out):
        with open(os.path.join(self.place.name, out, "study.json")) as file:
            return json.load(file)["complete"]

    def test_run_says_what_came_of_it_as_json(self):
        done = self.gazebench(self.measure("s", "--path", "grid:2x1", "--json"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(
            json.loads(done.stdout),
            {"out": "s", "complete": True, "units": 2, "done": 2, "resumed": 0, "rows": 8},
        )
        self.assertEqual(done.stderr, "")
        again = self.gazebench(self.measure("s", "--path", "grid:2x1", "--json"))
        self.assertEqual(json.loads(again.stdout)["resumed"], 2)
        self.assertEqual(len(self.rows("s")), 8)

    def test_command_lines_that_are_not_understood_exit_with_2(self):
        for arguments, part in (
            (["run"], "no scene"),
            (["run", "a.scene"], "--out"),
            (["run", "a.scene", "--out", "s", "--shard", "0/2"], "I from 1 to N"),
            (["run", "a.scene", "--out", "s", "--shard", "3/2"], "I from 1 to N"),
            (["run", "a.scene", "--out", "s", "--frames", "0"], "frames"),
            (["run", "a.scene", "--out", "s", "--methods", "fast"], "standard, mdc"),
            (["run", "a.scene", "--out", "s", "--methods", "mdc,,ddc"], "name is missing"),
            (["run", "a.scene", "--out", "s", "--methods", ""], "name is missing"),
            (["run", "a.scene", "--out", "s", "--size", "big"], "WIDTHxHEIGHT"),
            (["run", "a.scene", "--out", "s", "--backend", "quantum"], "cpu, gl"),
            (["run", "a.scene", "--out", "s", "--path", "spiral"], "no such path"),
            (["suggest", "s", "--metric", "ssim"], "give --bound"),
            (["merge", "s"], "merge OUT DIR"),
        ):
            done = self.gazebench(self.command(*arguments))
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(part, done.stderr)

    def test_files_that_are_not_there_exit_with_1(self):
        for arguments in (
            ["run", "b.scene", "--out", "s"],
            ["run", "a.scene", "--out", "s", "--path", "b.gzl"],
            ["report", "s"],
        ):
            done = self.gazebench(self.command(*arguments))
            self.assertEqual(done.returncode, 1, arguments)
            self.assertFalse(os.path.exists(os.path.join(self.place.name, "s")))

    def test_help_names_commands_and_what_they_do_in_straight_columns(self):
        text = self.gazebench(self.command("--help")).stdout
        lines = text.split("commands:\n")[1].split("\n\n")[0].splitlines()
        self.assertEqual(len(lines), 11)
        starts = {re.match(r"  [a-z]+ +[A-Z.a-z]+(?: [A-Z][A-Za-z.]+)* {2,}(?=[a-z])", line).end()
                  for line in lines}
        self.assertEqual(len(starts), 1, text)

    def test_folder_of_something_else_is_refused_and_left_alone(self):
        os.mkdir(os.path.join(self.place.name, "s"))
        self.write("s/letter", "dear")
        done = self.gazebench(self.measure("s"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("is not a study", done.stderr)
        self.assertEqual(os.listdir(os.path.join(self.place.name, "s")), ["letter"])

    def test_full_disk_exits_with_3_and_goes_on_once_there_is_room(self):
        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (9000, resource.RLIM_INFINITY))

        path = "random:40"
        full = self.gazebench(self.measure("s", "--path", path), preexec_fn=small_files)
        self.assertEqual(full.returncode, 3, full.stderr)
        self.assertIn("no room left", full.stderr)
        self.assertIn("run the same command again", full.stderr)
        self.assertFalse(self.complete("s"))
        part = self.rows("s")
        self.assertGreater(len(part), 0)
        self.assertLess(len(part), 160)
        self.assertEqual(len(part) % 4, 0)
        whole = self.gazebench(self.measure("s", "--path", path))
        self.assertEqual(whole.returncode, 0, whole.stderr)
        self.assertTrue(self.complete("s"))
        self.assertEqual(len(self.rows("s")), 160)
        self.assertEqual(self.rows("s")[: len(part)], part)

    def test_interrupted_run_exits_with_3_and_goes_on_to_the_same(self):
        command = self.measure("s", "--path", "random:150", "--errors", "standard")
        child = subprocess.Popen(
            command, cwd=self.place.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        table = os.path.join(self.place.name, "s", "frames.csv")
        while child.poll() is None:  # until something is there
            if os.path.exists(table) and os.path.getsize(table) > 4000:
                child.send_signal(signal.SIGINT)
                break
            time.sleep(0.002)
        _, messages = child.communicate(timeout=50)
        self.assertEqual(child.returncode, 3, messages)
        self.assertRegex(messages, "s holds [0-9]+ of 150 units: run the same command again")
        part = self.rows("s")
        self.assertEqual(len(part) % 4, 0)
        done = self.gazebench(command)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.rows("s")), 600)
        self.assertEqual(self.rows("s")[: len(part)], part)

    def test_report_shows_the_error_where_it_is(self):
        done = self.gazebench(
            self.command(
                "run", "a.scene", "--size", "160x120", "--methods", "uniform:uniform_spacing=8",
                "--frames", "1", "--path", "grid:2x1", "--errors", "standard", "--out", "s"
            )
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.gazebench(self.command("report", "s"))
        self.assertEqual(done.returncode, 0, done.stderr)
        for which in ("worst", "median"):
            with open(os.path.join(self.place.name, "s", "crop-%s-2.png" % which), "rb") as file:
                header = file.read(24)
            self.assertEqual(struct.unpack(">II", header[16:]), (3 * 64 + 2 * 2, 64))
        with open(os.path.join(self.place.name, "s", "report.html")) as file:
            page = file.read()
        self.assertEqual(len(re.findall("data:image/png;base64,[A-Za-z0-9+/=]{900}", page)), 2)
        self.assertRegex(page, "worst gaze .*: perceived FLIP against standard 0\\.")

    def test_shards_merge_to_the_rows_of_one_run(self):
        path = ("--path", "sweep:s:5")
        self.assertEqual(self.gazebench(self.measure("whole", *path)).returncode, 0)
        for shard in "213":
            done = self.gazebench(self.measure("part-" + shard, *path, "--shard", shard + "/3"))
            self.assertEqual(done.returncode, 0, done.stderr)
        done = self.gazebench(
            self.command("merge", "--json", "merged", "part-1", "part-2", "part-3")
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout), {"out": "merged", "shards": 3, "rows": 20})
        self.assertEqual(self.rows("merged"), self.rows("whole"))
        again = self.gazebench(self.command("merge", "merged", "part-1", "part-2", "part-3"))
        self.assertEqual(again.returncode, 1)
        missing = self.gazebench(self.command("merge", "other", "part-1", "part-3"))
        self.assertEqual(missing.returncode, 1)
        self.assertIn("shard 2 of 3 is missing", missing.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.place.name, "other")))

    def test_terminal_shows_how_far_it_is_in_one_line(self):
        terminal, end = pty.openpty()
        command = self.measure("s", "--path", "grid:3x1")
        child = subprocess.Popen(
            command, cwd=self.place.name, stdout=subprocess.DEVNULL, stderr=end
        )
        os.close(end)
        shown = b""
        try:
            while True:
                shown += os.read(terminal, 4096)
        except OSError:
            pass  # closed by the child's end
        self.assertEqual(child.wait(timeout=50), 0)
        os.close(terminal)
        lines = re.findall(r"\r\x1b\[K([^\r]*)", shown.decode())
        self.assertRegex(lines[0], r"^0 of 3, 0 %, \? left: a$")
        self.assertRegex(lines[2], r"^2 of 3, 67 %, [0-9]+:[0-9]{2} left: a$")
        self.assertEqual(lines[3], "")
        self.assertNotIn("\n", shown.decode())

    def test_accumulate_tells_what_more_frames_gain(self):
        command = self.command("accumulate", "a.scene", "--size", "64x48", "--methods",
                               "uniform:uniform_spacing=4", "--cache", "cache", "--json")
        done = self.gazebench(command)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [row for row in json.loads(done.stdout) if row["variant"] != "standard"]
        self.assertEqual([(row["turn_deg"], row["frames"]) for row in rows],
                         [(0, 0), (0, 1), (0, 4), (0, 16), (0, 64), (0.1, 0), (0.1, 16)])
        errors = [row["flip"] for row in rows]
        # A lattice of 4 px is whole after 16 frames: nothing is left to gain.
        self.assertGreater(errors[1], errors[2])
        self.assertGreater(errors[2], errors[3])
        self.assertEqual(errors[3], errors[4])
        standard = [row for row in json.loads(done.stdout) if row["variant"] == "standard"]
        self.assertEqual(len({row["flip"] for row in standard[:5]}), 1)
        self.assertTrue(all(row["frame_ms"] > 0 for row in rows))

    def test_accumulate_refuses_what_it_cannot_measure(self):
        for arguments, status, part in (
            (["accumulate"], 2, "no scene"),
            (["accumulate", "a.scene", "--gaze", "grid:2x2"], 2, "one place"),
            (["accumulate", "a.scene", "--methods", "fast"], 2, "standard, mdc"),
            (["accumulate", "b.scene"], 1, "b.scene"),
        ):
            done = self.gazebench(self.command(*arguments))
            self.assertEqual(done.returncode, status, arguments)
            self.assertIn(part, done.stderr)

    def test_list_names_what_can_be_measured(self):
        done = self.gazebench(self.command("--list"))
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"(?m)^method +acuity")
        self.assertRegex(done.stdout, r"(?m)^backend +cpu +.*thread")
        self.assertNotRegex(done.stdout, r"(?m) $")
        self.assertRegex(done.stdout, r"(?m)^option +uniform_spacing .*; preset 2\)$")
        items = json.loads(self.gazebench(self.command("--list", "--json")).stdout)
        self.assertEqual(len(items), len(done.stdout.splitlines()))
        options = {i["name"]: i for i in items if i["kind"] == "option"}
        self.assertEqual(options["levels"]["allowed"], "true or false")
        self.assertEqual(options["uniform_spacing"]["preset"], "2")
        self.assertTrue(all(i["text"] for i in items))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
