"""gazeview's sessions without a window: recorded, and replayed to the bit.

session_command.py GAZEVIEW SCENES-FOLDER
"""

import json
import math
import os
import re
import shutil
import sys
import tempfile
import unittest

from picture import read_png, run, write_labels, write_scene

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]
PLACE = tempfile.TemporaryDirectory(prefix="gazecast-test-scene-")
SCENE = write_scene(PLACE.name, SCENES)


class Session(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-session-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def view(self, *more, **options):
        return run(GAZEVIEW, "--headless", "--backend", "cpu", *more, **options)

    def good(self, *more):
        done = self.view(*more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def record(self, *more, frames=5, turn=7):
        self.good(SCENE, "--size", "120x90", "--gaze", "0.3,0.4", "--turn", turn, "--frames", frames,
                  "--record", self.path("a.session"), "--out", self.path("was-%d.png"), *more)

    def read(self, name):
        with open(self.path(name), "rb") as source:
            return source.read()

    def replay_is_the_same(self, frames=5):
        done = self.good("--replay", self.path("a.session"), "--out", self.path("is-%d.png"))
        self.assertEqual(done.stderr, "")
        self.assertEqual(len(done.stdout.splitlines()), frames)
        for k in range(frames):
            self.assertTrue(self.read("was-%d.png" % k) == self.read("is-%d.png" % k),
                            "picture %d is another" % k)
        self.assertFalse(os.path.exists(self.path("is-%d.png" % frames)))

    def test_replay_gives_the_same_pictures(self):
        self.record()
        self.assertTrue(self.read("was-0.png") != self.read("was-4.png"), "nothing turned")
        self.replay_is_the_same()

    def test_replay_of_plans_that_grow_gives_the_same_pictures(self):
        self.record("--method", "acuity", "--foveation.acuity_slope", ".2", "--foveation.still_growth", ".5",
                    "--stats", self.path("was.json"), frames=9, turn=0)
        with open(self.path("was.json"), encoding="utf-8") as source:
            rays = [frame["rays"] for frame in json.load(source)["frames"]]
        self.assertLess(rays[0], 120 * 90 / 2)
        self.assertGreaterEqual(rays[8], 120 * 90)
        self.assertTrue(self.read("was-0.png") != self.read("was-8.png"), "nothing grew")
        self.replay_is_the_same(frames=9)

    def test_replay_of_accumulated_frames_gives_the_same_pictures(self):
        self.record("--temporal.accumulate", "--method", "uniform", turn=0.02)
        self.assertTrue(self.read("was-0.png") != self.read("was-4.png"), "nothing was kept")
        with open(self.path("a.session/frames.tsv"), encoding="utf-8") as source:
            frames = [line.split("\t") for line in source if line[0] not in "#!"]
        self.assertEqual([frame[-2] for frame in frames], ["0", "1", "1", "1", "1"])
        self.replay_is_the_same()

    def look_at(self, name, place, count=120):
        """A log of a gaze that rests: on place(i) at the sample i, of 100 a second."""
        with open(self.path(name), "w", encoding="utf-8") as out:
            out.write("#gazecast-log 1\n#tracker synthetic\n#rate_hz 100\n")
            for i in range(count):
                out.write("%d\t\t%d\t%s%s\n" % (
                    i, 10**9 + i * 10**7, ("%g\t%g\t1" % place(i)),
                    2 * ("\t\t\t0" + "\t" * 8)))

    def write_two_materials(self, *lines):
        """Two halves of a volume, of values 60 and 200, and another colour for each."""
        with open(self.path("halves.raw"), "wb") as out:
            for i in range(12 ** 3):
                inside = all(1 <= k <= 10 for k in (i % 12, i // 12 % 12, i // 144))
                out.write(bytes([(60 if i % 12 < 6 else 200) if inside else 0]))
        with open(self.path("halves.tf"), "w", encoding="utf-8") as out:
            out.write("range 0 255\n0.1 1 0 0 0\n0.2 1 0 0 0.3\n0.3 1 0 0 0.3\n"
                      "0.4 1 0 0 0\n0.6 0 1 0 0\n0.7 0 1 0 0.3\n1 0 1 0 0.3\n")
        path = self.path("halves.scene")
        with open(path, "w", encoding="utf-8") as out:
            out.write("\n".join(("[volume]", "file = halves.raw", "dims = 12 12 12",
                                 "type = uint8", "spacing = 1 1 1", "[transfer]",
                                 "file = halves.tf", "[camera]", "eye = 0 -2.5 0") + lines))
            out.write("\n")
        return path

    def test_values_looked_at_stand_out_and_replay_bit_for_bit(self):
        scene = self.write_two_materials()
        self.look_at("halves.gzl", lambda i: (0.4 if i < 50 else 0.6, 0.5))
        for importance in (0, 1):
            self.good(scene, "--size", "64x48", "--gaze", self.path("halves.gzl"), "--fps", 20,
                      "--frames", 26, "--attention.importance", importance, "--record",
                      self.path("v%d.session" % importance), "--out",
                      self.path("v%d-%%d.png" % importance))
        with open(self.path("v1.session/frames.tsv"), encoding="utf-8") as source:
            raised = [line.split("\t") for line in source if line.startswith("!raise")]
        shares = [float(line[2]) for line in raised]
        ranges = [(float(line[3]), float(line[4])) for line in raised if len(line) > 3]
        # One after the other: the red half, nothing, the green half.
        self.assertEqual(len(set(ranges)), 2, raised)
        self.assertTrue(ranges[0][0] < 60 / 255 < ranges[0][1] < 0.6, ranges)
        self.assertTrue(0.4 < ranges[-1][0] < 200 / 255 < ranges[-1][1], ranges)
        first = shares.index(max(shares))
        self.assertEqual(shares[:first + 1], sorted(shares[:first + 1]), shares)
        self.assertIn(0, shares[first:], "the second comes before the first has gone")
        self.good("--replay", self.path("v1.session"), "--out", self.path("is-%d.png"))
        for k in range(26):
            self.assertTrue(self.read("v1-%d.png" % k) == self.read("is-%d.png" % k),
                            "picture %d is another" % k)
        self.assertTrue(self.read("v1-3.png") == self.read("v0-3.png"))
        # The half that is looked at becomes denser, the other one fades.
        for k, more, less in ((9, (20, 24), (42, 24)), (25, (42, 24), (20, 24))):
            plain, shown = (read_png(self.path("v%d-%d.png" % (i, k))) for i in (0, 1))
            self.assertGreater(sum(shown.at(*more)), sum(plain.at(*more)))
            self.assertLess(sum(shown.at(*less)), 0.9 * sum(plain.at(*less)))

    def write_plate(self):
        """A plate with bumps that are a hundredth as high as it is wide, seen from above."""
        side = 60
        with open(self.path("plate.obj"), "w", encoding="utf-8") as out:
            for i in range(side * side):
                x, y = i % side, i // side
                out.write("v %g %g %g\n" % (x, y, 0.6 * math.sin(x / 2) * math.sin(y / 3)))
            for i in range((side - 1) * (side - 1)):
                at = i // (side - 1) * side + i % (side - 1) + 1
                out.write("f %d %d %d\nf %d %d %d\n" % (
                    at, at + 1, at + side + 1, at, at + side + 1, at + side))
        path = self.path("plate.scene")
        with open(path, "w", encoding="utf-8") as out:
            out.write("[object plate]\nmesh = plate.obj\ntechnique = illustrate\n"
                      "[camera]\neye = 0 0 2\nlook_at = 0 0 0\nup = 0 1 0\nfov_deg = 40\n")
        return path

    def contrast(self, picture):
        """Standard deviation of the plate's middle, in shares of white."""
        values = picture.part(40, 30, 120, 90)[::3]
        mean = sum(values) / len(values)
        return math.sqrt(sum((value - mean) ** 2 for value in values) / len(values)) / 255

    def test_automatic_settings_move_slowly_settle_and_replay_bit_for_bit(self):
        scene = self.write_plate()
        for name in ("first", "second"):
            self.good(scene, "--size", "160x120", "--frames", 60, "--fps", 20,
                      "--illustration.automatic", "--record", self.path(name + ".session"),
                      "--out", self.path(name + "-%d.png"))
        with open(self.path("first.session/frames.tsv"), encoding="utf-8") as source:
            changes = [[float(part) for part in line.split("\t")[1:]] for line in source
                       if line.startswith("!adapt")]
        self.assertTrue(10 < len(changes) < 59, "it does not settle: %d changes" % len(changes))
        before = [0] * 5
        for now in changes:  # half of a setting's range a second, of which a frame is 1/20
            self.assertTrue(all(abs(a - b) <= 0.5 / 20 + 1e-9 for a, b in zip(now, before)), now)
            before = now
        pictures = [read_png(self.path("first-%d.png" % k)) for k in range(60)]
        self.assertEqual(pictures[59], pictures[58])
        for one, other in zip(pictures, pictures[1:]):
            step = [abs(a - b) for a, b in zip(one.part(40, 30, 120, 90)[::3],
                                               other.part(40, 30, 120, 90)[::3])]
            self.assertTrue(sum(step) / len(step) < 12, "a jump of %g" % (sum(step) / len(step)))
        self.assertGreater(self.contrast(pictures[59]), 1.15 * self.contrast(pictures[0]))
        self.good("--replay", self.path("first.session"), "--out", self.path("is-%d.png"))
        for k in range(60):
            was = self.read("first-%d.png" % k)
            self.assertTrue(was == self.read("second-%d.png" % k), "run %d is another" % k)
            self.assertTrue(was == self.read("is-%d.png" % k), "picture %d is another" % k)

    def record_looks(self, importance):
        """Two regions side by side, in which the gaze rests on one, then on the other."""
        scene = write_labels(self.place.name, "[render]", "technique = illustrate", "[camera]",
                             "eye = 0 -2.5 0", "[illustration]", "scene_information = importance")
        self.look_at("looks.gzl", lambda i: (0.45 if i < 50 else 0.55, 0.5))
        self.good(scene, "--size", "64x48", "--gaze", self.path("looks.gzl"), "--fps", 20,
                  "--frames", 22, "--attention.importance", importance, "--record",
                  self.path("%s.session" % importance), "--out",
                  self.path("%s-%%d.png" % importance))

    def test_importance_by_gaze_replays_bit_for_bit(self):
        self.record_looks(0)
        self.record_looks(1)
        with open(self.path("1.session/frames.tsv"), encoding="utf-8") as source:
            raised = [line.split("\t") for line in source if line.startswith("!raise")]
        self.assertEqual(len({line[1] for line in raised if line[1] != "0"}), 2, raised)
        self.good("--replay", self.path("1.session"), "--out", self.path("is-%d.png"))
        for k in range(22):
            self.assertTrue(self.read("1-%d.png" % k) == self.read("is-%d.png" % k),
                            "picture %d is another" % k)
        # Nothing is raised before the first look has lasted, and then one after the other.
        self.assertTrue(self.read("1-3.png") == self.read("0-3.png"))
        self.assertTrue(self.read("1-9.png") != self.read("0-9.png"))
        self.assertTrue(self.read("1-21.png") != self.read("1-9.png"))
        # What is raised is what was recorded, not what the replay makes of the gaze.
        self.good("--replay", self.path("1.session"), "--attention.importance", 0, "--out",
                  self.path("again-%d.png"))
        self.assertTrue(self.read("1-21.png") == self.read("again-21.png"))

    def test_replay_does_not_depend_on_frame_times(self):
        self.record("--attention.budget_ms", 0.001, frames=12)
        with open(self.path("a.session/frames.tsv"), encoding="utf-8") as source:
            text = source.read()
        (columns,) = re.findall("#columns (.*)", text)
        at = columns.split("\t").index("scale")
        scales = {line.split("\t")[at] for line in text.splitlines() if line[0] not in "#!"}
        self.assertGreater(len(scales), 1, "no plan was made coarser")
        self.replay_is_the_same(frames=12)

    def test_command_line_overrides_recorded_settings(self):
        self.record("--method", "ddc", frames=2)
        stats = self.path("stats.json")
        self.good("--replay", self.path("a.session"), "--method", "standard", "--stats", stats)
        with open(stats, encoding="utf-8") as source:
            frames = json.load(source)["frames"]
        self.assertEqual([f["method"] for f in frames], ["standard"] * 2)
        self.assertEqual([f["rays"] for f in frames], [120 * 90] * 2)

    def test_transfer_function_changes_at_the_recorded_frame(self):
        self.record(frames=3, turn=0)
        function = ["0 0 0 0 0", "0.5 1 0 0 0.1", "1 0 1 0 0.5"]
        with open(self.path("other.tf"), "w", encoding="utf-8") as out:
            out.write("\n".join(function) + "\n")
        self.good(SCENE, "--size", "120x90", "--gaze", "0.3,0.4", "--transfer.file",
                  self.path("other.tf"), "--out", self.path("other.png"))
        frames = self.path("a.session/frames.tsv")
        with open(frames, encoding="utf-8") as source:
            lines = source.readlines()
        lines.insert(-3, "!transfer\t" + "\t".join(function) + "\n")
        with open(frames, "w", encoding="utf-8") as out:
            out.writelines(lines)
        done = self.good("--replay", self.path("a.session"), "--out", self.path("is-%d.png"))
        self.assertIn("the file was changed", done.stderr)
        self.assertTrue(self.read("is-0.png") == self.read("was-0.png"))
        self.assertTrue(self.read("is-1.png") == self.read("other.png"))
        self.assertTrue(self.read("is-2.png") == self.read("other.png"))
        self.assertTrue(self.read("is-0.png") != self.read("is-1.png"))

    def test_session_may_be_moved(self):
        self.record(frames=2)
        shutil.move(self.path("a.session"), self.path("elsewhere"))
        self.good("--replay", self.path("elsewhere"), "--out", self.path("is-%d.png"))
        self.assertTrue(self.read("is-1.png") == self.read("was-1.png"))

    def test_killed_recording_is_replayed_up_to_its_last_complete_line(self):
        self.record(frames=3)
        frames = self.path("a.session/frames.tsv")
        with open(frames, encoding="utf-8") as source:
            lines = source.readlines()
        with open(frames, "w", encoding="utf-8") as out:
            out.writelines(lines[:-2] + [lines[-2][:20]])
        done = self.good("--replay", self.path("a.session"))
        self.assertEqual(len(done.stdout.splitlines()), 2)
        self.assertIn("2 frames are complete", done.stderr)

    @unittest.skipUnless(shutil.which("ffprobe"), "ffmpeg is not installed")
    def test_video_of_a_replay_shows_each_picture_for_its_time(self):
        self.record("--fps", 10, frames=6)
        video = self.path("a.mp4")
        self.good("--replay", self.path("a.session"), "--fps", 20, "--video", video)
        done = run("ffprobe", "-v", "error", "-count_frames", "-show_entries",
                   "stream=nb_read_frames,avg_frame_rate", "-of", "csv=p=0", video)
        self.assertEqual(done.stdout.strip(), "20/1,11")

    def refused(self, done, *words):
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_another_volume_is_refused(self):
        self.record(frames=1)
        scene = self.path("a.session/scene.scene")
        with open(scene, encoding="utf-8") as source:
            text = source.read()
        with open(scene, "w", encoding="utf-8") as out:
            out.write(text.replace("dims = 64 64 64", "dims = 60 64 64"))
        self.refused(self.view("--replay", self.path("a.session")), "60x64x64",
                     "differs from the recorded one")

    def test_damaged_line_is_refused_with_its_number(self):
        self.record(frames=2)
        frames = self.path("a.session/frames.tsv")
        with open(frames, encoding="utf-8") as source:
            text = source.read()
        number = text[: text.index("!set")].count("\n") + 1
        with open(frames, "w", encoding="utf-8") as out:
            out.write(text.replace("!set\tcamera.eye\t", "!set\tcamera.eye\tx"))
        self.refused(self.view("--replay", self.path("a.session")), ":%d: camera.eye" % number)

    def test_contradictory_options_are_refused(self):
        self.record(frames=1)
        session = self.path("a.session")
        for more in (("--size", "9x9"), (SCENE,), ("--gaze", "0,0"), ("--frames", 3),
                     ("--record", "b"), ("--display-px", "9x9")):
            self.refused(self.view("--replay", session, *more), "cannot be combined with it")
        self.refused(self.view("--replay", self.path("none")), "not a session")
        self.refused(self.view("--replay", session, "--out", "a.png"), "need a number")
        self.refused(self.view(SCENE, "--record", session), "choose another name")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
