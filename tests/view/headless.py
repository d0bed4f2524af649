"""gazeview --headless, run as its users run it.

headless.py GAZEVIEW SCENES-FOLDER
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from picture import PATIENCE_S, read_png, run, write_labels, write_scene

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]
PLACE = tempfile.TemporaryDirectory(prefix="gazecast-test-scene-")
SCENE = write_scene(PLACE.name, SCENES)
SURFACE = ("--technique", "isosurface", "--isovalue", "0.5")
METHODS = ("standard", "mdc", "ddc", "acuity")
KEYS = (
    "method backend width height rays kept_rays samples plan_ms cast_ms reconstruct_ms total_ms gaze "
    "gaze_age_ms attention focus scale widen budget_ms budget"
).split()
LINE = re.compile(
    r"(\w+) (\d+)x(\d+) rays (\d+) kept (\d+) samples (\d+) plan ([\d.]+) cast ([\d.]+) reconstruct ([\d.]+) "
    r"total ([\d.]+) ms gaze age (-|[\d.]+ ms)$"
)

# For tests of pictures, options and files, made by the same threads as in the other tests: a thread
# sanitizer would see nothing else there.
no_other_threads = unittest.skipIf(
    os.environ.get("SANITIZED") == "thread", "only what several threads do is of interest")


def darkness(path):
    """The mean ink of a picture, 0 to 1."""
    picture = read_png(path)
    return 1 - sum(map(sum, picture.rows)) / (3 * 255 * picture.width * picture.height)


class Headless(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-headless-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def render(self, *more, size="96x64", scene=None):
        return run(GAZEVIEW, "--headless", "--scene", scene or SCENE, "--size", size, *more)

    def good(self, *more, **options):
        done = self.render(*more, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def frames(self, name="stats.json"):
        with open(self.path(name), encoding="utf-8") as source:
            whole = json.load(source)
        self.assertEqual(list(whole), ["frames"])
        return whole["frames"]

    def refused(self, done, word):
        self.assertGreater(done.returncode, 0)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(word, done.stderr)

    def test_camera_at_rest_casts_no_ray_twice(self):
        for keep in ("yes", "no"):
            self.good("--frames", 3, "--method", "acuity", "--temporal.keep_rays=" + keep, "--stats",
                      self.path(keep), "--out", self.path(keep + "-%d.png"))
        kept, bare = self.frames("yes"), self.frames("no")
        self.assertEqual([frame["kept_rays"] for frame in kept], [0, 0, kept[2]["rays"]])
        self.assertEqual([frame["kept_rays"] for frame in bare], [0, 0, 0])
        self.assertEqual((kept[2]["samples"], bare[2]["samples"]), (0, bare[0]["samples"]))
        for i in range(3):
            self.assertEqual(read_png(self.path("yes-%d.png" % i)), read_png(self.path("no-%d.png" % i)))

    def test_picture_at_rest_gets_a_ray_for_every_pixel(self):
        wide = ("--foveation.acuity_slope", 1, "--foveation.acuity_far_share", 1, "--method", "acuity")
        self.good(*wide, "--frames", 24, "--foveation.still_growth", 1, "--stats", self.path("grown"), "--out",
                  self.path("grown-%02d.png"))
        self.good("--method", "standard", "--out", self.path("standard.png"))
        frames, last = self.frames("grown"), read_png(self.path("grown-23.png"))
        self.assertFalse(read_png(self.path("grown-00.png")) == last)
        self.assertEqual(last, read_png(self.path("standard.png")))
        rays = [frame["rays"] for frame in frames]
        self.assertEqual(rays, sorted(rays))
        self.assertEqual(frames[-1]["kept_rays"], rays[-1])

    def test_each_method_writes_pictures_lines_and_statistics(self):
        pictures = {}
        for method in METHODS:
            name = method + ".json"
            done = self.good(
                "--method", method, "--frames", 2, "--turn", 20, "--out",
                self.path(method + "-%03d.png"), "--stats", self.path(name),
            )
            lines, frames = done.stdout.splitlines(), self.frames(name)
            self.assertEqual((len(lines), len(frames)), (2, 2))
            for line, frame in zip(lines, frames):
                self.assertEqual(list(frame), KEYS)
                said = LINE.match(line)
                self.assertIsNotNone(said, line)
                self.assertEqual(said[1], method)
                self.assertEqual(frame["method"], method)
                self.assertEqual((frame["width"], frame["height"]), (96, 64))
                self.assertEqual((int(said[4]), int(said[6])), (frame["rays"], frame["samples"]))
                self.assertEqual((int(said[5]), frame["kept_rays"]), (0, 0), "the camera turned")
                self.assertGreater(frame["samples"], 0)
                parts = frame["plan_ms"] + frame["cast_ms"] + frame["reconstruct_ms"]
                self.assertLessEqual(parts, frame["total_ms"] + 0.01)
                self.assertEqual(frame["gaze"], [0.5, 0.5])
                self.assertIsNone(frame["gaze_age_ms"])
            both = [read_png(self.path("%s-%03d.png" % (method, i))) for i in (0, 1)]
            self.assertEqual((both[0].width, both[0].height), (96, 64))
            self.assertFalse(both[0] == both[1], "the camera did not turn")
            pictures[method] = both[0]
        colours = {pictures["standard"].at(x, y) for x in range(96) for y in range(64)}
        self.assertGreater(len(colours), 50, "nothing is to be seen")

    def test_standard_casts_all_rays_and_foveation_fewer(self):
        for method in METHODS:
            self.good("--method", method, "--stats", self.path(method), size="640x360")
        rays = {method: self.frames(method)[0]["rays"] for method in METHODS}
        self.assertEqual(rays["standard"], 640 * 360)
        for method in METHODS[1:]:
            self.assertLess(rays[method], rays["standard"])

    @no_other_threads
    def test_picture_equals_the_standard_one_only_at_the_gaze(self):
        for method in ("standard", "acuity"):
            self.good(
                "--method", method, "--gaze", "0.3,0.5", "--out", self.path(method + ".png"),
                size="640x360",
            )
        sharp, foveated = (read_png(self.path(m + ".png")) for m in ("standard", "acuity"))
        x, y, r = 192, 180, 24  # 1.9 degrees of the default display
        fovea = (x - r, y - r, x + r, y + r)
        beside = (400, 60, 520, 300)
        self.assertTrue(sharp.part(*fovea) == foveated.part(*fovea), "not sharp at the gaze")
        self.assertFalse(sharp.part(*beside) == foveated.part(*beside), "sharp beside it")

    def test_comparison_shows_the_standard_picture_or_the_difference_from_it(self):
        self.compare("--technique", "raycast", "--backend", "cpu")

    def test_surfaces_are_compared_too(self):
        if "Embree" in self.render(*SURFACE, "--backend", "cpu").stderr:
            self.skipTest("built without Embree")
        self.compare(*SURFACE, "--backend", "cpu")

    def test_plain_surfaces_are_put_beside_an_illustration(self):
        scene = write_labels(self.place.name, "[camera]", "eye = 0 -2.5 0.8", "[illustration]",
                             "drawing = stipples")
        if "Embree" in self.render(scene=scene).stderr:
            self.skipTest("built without Embree")
        shown = ("--technique", "illustrate", "--backend", "cpu", "--method", "standard")
        for name, more in (("drawn", ()), ("plain", ("--illustration.show", "plain")),
                           ("both", ("--view.compare", "split", "--view.compare_with", "plain"))):
            self.good(*shown, *more, "--out", self.path(name + ".png"), scene=scene)
        drawn, plain, both = (read_png(self.path(name + ".png"))
                              for name in ("drawn", "plain", "both"))
        middle, width, height = both.width // 2, both.width, both.height
        self.assertTrue(both.part(0, 0, middle, height) == drawn.part(0, 0, middle, height))
        self.assertTrue(both.part(middle, 0, width, height) ==
                        plain.part(middle, 0, width, height))
        self.assertFalse(plain == drawn)

    def test_atlas_of_many_regions_is_illustrated(self):
        """300 labels: numbers of objects beyond 16 bits."""
        edge = 29
        voxels = bytearray(2 * edge**3)
        for label in range(300):
            x, y, z = (4 * (label // n % 7) + 1 for n in (1, 7, 49))
            for k in range(27):
                at = 2 * (((z + k // 9) * edge + y + k // 3 % 3) * edge + x + k % 3)
                voxels[at : at + 2] = (label + 1).to_bytes(2, "little")
        with open(self.path("many.nrrd"), "wb") as out:
            out.write(b"NRRD0004\ntype: uint16\ndimension: 3\nsizes: 29 29 29\nendian: little\n"
                      b"spacings: 1 1 1\nencoding: raw\n\n" + bytes(voxels))
        with open(self.path("many.scene"), "w", encoding="utf-8") as out:
            out.write("[object parts]\nlabels = many.nrrd\ntechnique = illustrate\n")
        if "Embree" in self.render(scene=self.path("many.scene")).stderr:
            self.skipTest("built without Embree")
        self.good("--backend", "cpu", "--out", self.path("many.png"), scene=self.path("many.scene"))
        picture = read_png(self.path("many.png"))
        self.assertGreater(len({picture.at(x, y) for x in range(picture.width)
                                for y in range(picture.height)}), 20)

    def compare(self, *how):
        coarse = (*how, "--gaze", "0.3,0.5", "--foveation.acuity_slope", "0.1")
        for name, more in (("sharp", ("--method", "standard")), ("foveated", ()),
                           ("split", ("--view.compare", "split", "--view.split", "0.25")),
                           ("difference", ("--view.compare", "difference",
                                           "--view.difference_gain", "3"))):
            self.good(*coarse, *more, "--out", self.path(name + ".png"), size="192x128")
        sharp, foveated, split, difference = (
            read_png(self.path(name + ".png"))
            for name in ("sharp", "foveated", "split", "difference"))
        self.assertTrue(split.part(0, 0, 48, 128) == foveated.part(0, 0, 48, 128), "left")
        self.assertTrue(split.part(48, 0, 192, 128) == sharp.part(48, 0, 192, 128), "right")
        wanted = bytes(min(255, 3 * abs(a - b)) for a, b in
                       zip(sharp.part(0, 0, 192, 128), foveated.part(0, 0, 192, 128)))
        self.assertTrue(any(wanted), "nothing differs")
        self.assertTrue(difference.part(0, 0, 192, 128) == wanted, "difference")

    def test_comparison_of_several_frames_follows_the_camera(self):
        turning = ("--backend", "cpu", "--frames", 2, "--turn", 40, "--view.compare", "split",
                   "--view.split", "0")
        self.good(*turning, "--out", self.path("split-%d.png"))
        self.good(*turning[:-4], "--method", "standard", "--out", self.path("sharp-%d.png"))
        for frame in range(2):
            split, sharp = (read_png(self.path("%s-%d.png" % (name, frame)))
                            for name in ("split", "sharp"))
            self.assertTrue(split == sharp, "frame %d" % frame)

    def test_same_command_gives_the_same_picture(self):
        for name, threads in (("a.png", 1), ("b.png", 2)):
            self.good("--threads", threads, "--gaze", "0.9,0.1", "--out", self.path(name))
        with open(self.path("a.png"), "rb") as a, open(self.path("b.png"), "rb") as b:
            self.assertTrue(a.read() == b.read())

    @no_other_threads
    def test_image_sampling_rate_changes_the_rays_and_not_the_size(self):
        for rate in (0.5, 1, 2):
            name = "%g" % rate
            self.good(
                "--render.image_sampling_rate", rate, "--method", "standard", "--stats",
                self.path(name), "--out", self.path(name + ".png"),
            )
            frame, picture = self.frames(name)[0], read_png(self.path(name + ".png"))
            self.assertEqual(frame["rays"], round(96 * rate) * round(64 * rate))
            self.assertEqual((frame["width"], frame["height"]), (96, 64))
            self.assertEqual((picture.width, picture.height), (96, 64))

    @no_other_threads
    def test_cross_is_drawn_at_the_gaze(self):
        self.good("--gaze", "0.25,0.75", "--cross", "--out", self.path("cross.png"))
        self.assertEqual(read_png(self.path("cross.png")).at(24, 48), (255, 64, 64))
        for gaze in ("0,0", "1,1", "-5,0.5", "10,-10"):
            self.good("--gaze", gaze, "--cross", "--out", self.path("edge.png"))

    @no_other_threads
    def test_gaze_outside_the_picture_is_not_clamped(self):
        for method in METHODS:
            self.good("--gaze", "-0.5,1.75", "--method", method, "--stats", self.path("stats.json"))
            self.assertEqual(self.frames()[0]["gaze"], [-0.5, 1.75])

    @no_other_threads
    def test_distance_to_the_display_changes_the_plan(self):
        for name, distance in (("near", 300), ("far", 3000)):
            self.good(
                "--method", "acuity", "--display-mm", "565 318", "--distance-mm", distance,
                "--foveation.acuity_full_deg", 0, "--stats", self.path(name), size="640x360",
            )
        # From afar the same pixels are finer than the eye.
        self.assertLess(self.frames("far")[0]["rays"], self.frames("near")[0]["rays"])

    def write_log(self, name, samples):
        """A gaze log without an end; a sample (host_ns, x) is one point for both eyes, (x, 0.5), or
        none."""
        no_eye = "\t\t\t0" + "\t" * 8
        with open(self.path(name), "w", encoding="utf-8") as out:
            out.write("#gazecast-log 1\n#tracker synthetic\n#rate_hz 100\n")
            for seq, (host_ns, x) in enumerate(samples):
                point = "\t\t0" if x is None else "%g\t0.5\t1" % x
                out.write("%d\t\t%d\t%s%s\n" % (seq, host_ns, point, 2 * no_eye))

    def test_frame_k_uses_the_last_sample_of_a_log_until_k_over_fps(self):
        # Ten ms apart: every third frame has exactly the time of a sample, except frame 3, which is
        # one ns earlier; the eye jumps at 45 ms.
        times = [10**9 + 10**7 * i + (i == 5) for i in range(90)]
        self.write_log("short.gzl", [(t, 0.25 if t < 1045000000 else 0.75) for t in times])
        self.good(
            "--gaze", self.path("short.gzl"), "--fps", 60, "--frames", 60, "--stats",
            self.path("stats.json"), size="16x16",
        )
        frames = self.frames()
        for k, frame in enumerate(frames):
            now = 10**9 + k * 10**9 // 60
            last = max(t for t in times if t <= now)
            self.assertAlmostEqual(frame["gaze_age_ms"], (now - last) * 1e-6, places=3)
        for frame in frames[:4]:
            self.assertLess(abs(frame["gaze"][0] - 0.25), 0.01)

    def attention_frames(self, *more, fps=60, frames=240):
        """Looks left for 1 s, leaps, looks right for 1 s, blinks for .2 s, looks on for .3 s, is
        not seen any more."""
        times = [10**9 + 4 * 10**6 * i for i in range(700)]
        self.write_log("eye.gzl", [
            (t, None if i >= 625 or 500 <= i < 550 else
             0.3 + 0.4 * min(max((i - 250) / 12, 0), 1) + 0.0004 * (i * 7 % 5))
            for i, t in enumerate(times)
        ])
        self.good("--gaze", self.path("eye.gzl"), "--fps", fps, "--frames", frames, "--stats",
                  self.path("stats.json"), *more, size="320x180")
        return self.frames()

    def test_plan_follows_the_eye_movements_of_a_log(self):
        frames = self.attention_frames()
        by_state = {}
        for frame in frames:
            by_state.setdefault(frame["attention"], []).append(frame)
        still = frames[30:59]
        self.assertEqual({str(f["focus"]) for f in still}, {str(still[0]["focus"])})
        self.assertEqual({f["rays"] for f in still}, {still[0]["rays"]})
        self.assertGreater(len({str(f["gaze"]) for f in still}), 1, "the gaze itself trembles")
        way = by_state["saccade"]
        self.assertTrue(any(f["scale"] == 2 for f in way))
        self.assertLess(min(f["rays"] for f in way), still[0]["rays"])
        landed = frames[75]
        self.assertEqual((landed["scale"], landed["widen"]), (1, 0))
        self.assertLess(abs(landed["focus"][0] - 0.7), 0.02)
        for held in by_state["blink"] + by_state["hold"]:
            self.assertLess(abs(held["focus"][0] - 0.7), 0.02)
            self.assertEqual((held["scale"], held["widen"]), (1, 0))
        self.assertEqual(frames[-1]["attention"], "widen")
        self.assertEqual(frames[-1]["widen"], 1)
        self.assertLess(frames[-1]["rays"], 1.1 * still[0]["rays"])
        self.assertEqual({f["budget"] for f in frames}, {"off"})
        self.assertEqual({f["budget_ms"] for f in frames}, {None})

    def test_replay_makes_the_same_plans_each_time(self):
        keys = ("gaze", "focus", "scale", "widen", "attention", "rays", "samples")
        first, second = (
            [[frame[key] for key in keys] for frame in self.attention_frames(frames=120)]
            for _ in range(2)
        )
        self.assertEqual(first, second)

    def test_budget_that_cannot_be_kept_gives_the_coarsest_plan_and_one_warning(self):
        done = self.good(
            "--attention.budget_ms", 0.001, "--frames", 60, "--stats", self.path("stats.json")
        )
        self.assertEqual(done.stderr.count("cannot be kept"), 1, done.stderr)
        frames = self.frames()
        self.assertEqual(frames[0]["scale"], 1)
        self.assertEqual((frames[-1]["scale"], frames[-1]["budget"]), (64, "limit"))
        self.assertEqual(frames[-1]["budget_ms"], 0.001)
        self.assertLess(frames[-1]["rays"], frames[0]["rays"] / 4)

    def test_budget_with_standard_gives_one_warning_and_no_change(self):
        done = self.good(
            "--method", "standard", "--attention.budget_ms", 0.001, "--frames", 45, "--stats",
            self.path("stats.json"),
        )
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("acuity", done.stderr)
        for frame in self.frames():
            self.assertEqual((frame["scale"], frame["budget"]), (1, "over"))
        done = self.good("--method", "standard", "--attention.budget_ms", 10000, "--stats",
                         self.path("stats.json"))
        self.assertEqual(self.frames()[0]["budget"], "within")
        done = self.good("--method", "standard", "--out", self.path("one.png"))
        self.assertEqual(done.stderr, "")

    @no_other_threads
    def test_picture_without_a_file_is_told(self):
        done = self.good()
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("--out FILE.png", done.stderr)
        self.assertEqual(self.good("--frames", 2).stderr, "")

    @no_other_threads
    def test_budget_that_is_kept_changes_nothing(self):
        self.good(
            "--attention.budget_ms", 10000, "--frames", 50, "--stats", self.path("stats.json")
        )
        for frame in self.frames():
            self.assertEqual((frame["scale"], frame["budget"]), (1, "within"))

    @no_other_threads
    def test_camera_inside_the_volume_and_parallel_to_up_works(self):
        for words in (
            ("--camera.eye", "0.01 0.02 0.03"),
            ("--camera.eye", "0 0 2", "--camera.up", "0 0 1"),
            ("--camera.eye", "0 0 -0.2", "--camera.up", "0 0 0"),
            ("--camera.eye", "0 -0.5 0"),
            ("--camera.eye", "0.5 0.5 0.5", "--camera.projection", "orthographic"),
        ):
            for method in ("standard", "acuity"):
                self.good("--method", method, *words, "--out", self.path("in.png"))
                picture = read_png(self.path("in.png"))
                colours = {picture.at(x, y) for x in range(96) for y in range(64)}
                self.assertGreater(len(colours), 20, "%r shows nothing" % (words,))

    @no_other_threads
    def test_oriented_volume_gets_letters(self):
        for name, more in (("plain.png", ()), ("letters.png", ("--letters",))):
            done = self.good("--out", self.path(name), "--method", "standard", *more,
                             size="320x180")
            self.assertEqual(done.stderr, "")
        plain, letters = (read_png(self.path(n)) for n in ("plain.png", "letters.png"))
        edges = ((0, 80, 40, 100), (280, 80, 320, 100), (140, 0, 180, 40), (140, 140, 180, 180))
        for edge in edges:
            self.assertFalse(plain.part(*edge) == letters.part(*edge), "no letter there")
        self.assertTrue(plain.part(60, 50, 260, 130) == letters.part(60, 50, 260, 130))

    def test_endpoint_without_a_daemon_gives_one_warning_and_no_gaze(self):
        endpoint = "ipc://" + self.path("latest")
        done = self.good(
            "--gaze", endpoint, "--frames", 4, "--fps", 200, "--stats", self.path("stats.json")
        )
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(endpoint, done.stderr)
        frames = self.frames()
        self.assertEqual(len(frames), 4)
        for frame in frames:
            self.assertIsNone(frame["gaze"])
            self.assertIsNone(frame["gaze_age_ms"])

    @no_other_threads
    def test_invalid_command_lines_are_refused_in_one_line(self):
        for words, said in (
            (("--gaze", "nan,0.5"), "--gaze"),
            (("--gaze", "0.5,inf"), "--gaze"),
            (("--gaze", "tcp://"), "tcp://"),
            (("--gaze", self.path("none.gzl")), "none.gzl"),
            (("--backend", "vulkan"), "vulkan"),
            (("--simd", "mmx"), "mmx"),
            (("--frames", "2", "--out", "same.png"), "same.png"),
            (("--out", "%s.png"), "%s.png"),
            (("--stats", "/no/such/folder/s.json"), "/no/such/folder/s.json"),
            (("--method", "blur"), "acuity"),
            (("--camera.eye", "1 2 3", "--camera.look_at", "1 2 3"), "camera.eye"),
            (("--clip.least", "0 0.5 0", "--clip.greatest", "1 0.5 1"), "clip.least"),
            (("--attention.saccade_scale", "0.5"), "saccade_scale"),
            (("--attention.budget_ms", "-1"), "budget_ms"),
            (("--out", "/no/such/folder/f.png"), "--out /no/such/folder/f.png"),
            (("--out", self.path("f%d/%%.png")), "--out " + self.path("f0/%.png")),
            (("--foveation.method", "table"), "foveation.table"),
        ):
            # Checked before the volume is read: otherwise the missing volume would be reported.
            for scene in (SCENE, self.scene_of("none.nii")):
                with self.subTest(words=words, scene=scene):
                    self.refused(self.render(*words, scene=scene), said)
        for size in ("0x5", "5", "16384x16385"):
            self.refused(self.render(size=size), "size")
        for scene in (SCENE, self.scene_of("none.nii")):
            done = self.render("--render.image_sampling_rate", 4, size="16384x64", scene=scene)
            self.refused(done, "image_sampling_rate")
        self.refused(run(GAZEVIEW, "--headless", "--scene", self.path("no.scene")), "no.scene")
        self.refused(run(GAZEVIEW, "--headless"), "--scene")

    def write_volume(self, name, *more):
        return run(GAZEVIEW, "--scene", SCENE, "--write-volume", self.path(name), *more)

    def scene_of(self, name, *lines):
        """The scene with another volume."""
        with open(SCENE, encoding="utf-8") as source:
            sections = re.split(r"^(?=\[)", source.read(), flags=re.M)
        rest = [section for section in sections if not section.startswith("[volume]")]
        path = os.path.join(PLACE.name, os.path.basename(self.place.name) + ".scene")
        with open(path, "w", encoding="utf-8") as scene:
            scene.write("\n".join(["[volume]", f"file = {self.path(name)}", *lines, *rest]))
        return path

    @no_other_threads
    def test_volume_written_as_bricks_or_nrrd_looks_the_same(self):
        self.good("--out", self.path("scene.png"))
        wanted = read_png(self.path("scene.png"))
        for name in ("volume.gzb", "volume.nrrd"):
            done = self.write_volume(name)
            self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
            done = run(GAZEVIEW, "--headless", "--size", "96x64", "--out", self.path("a.png"),
                       self.scene_of(name))
            self.assertEqual(done.returncode, 0, done.stderr)
            got = read_png(self.path("a.png"))
            pairs = zip(b"".join(map(bytes, got.rows)), b"".join(map(bytes, wanted.rows)))
            worst = max(abs(a - b) for a, b in pairs)
            self.assertLessEqual(worst, 1, name)

    @no_other_threads
    def test_volume_that_cannot_be_written_is_refused_in_one_line(self):
        self.refused(self.write_volume("volume.raw"), ".gzb")
        self.refused(self.write_volume("no/volume.gzb"), "no/volume.gzb")
        nowhere = self.path("no/volume.gzb")
        before = run(GAZEVIEW, "--write-volume", nowhere, self.scene_of("none.nii"))
        self.refused(before, nowhere)
        self.assertEqual(os.listdir(self.place.name), [])
        self.write_volume("volume.gzb")
        again = run(GAZEVIEW, "--write-volume", self.path("b.gzb"), self.scene_of("volume.gzb"))
        self.refused(again, "already")

    def test_unwritable_picture_ends_the_run_and_the_statistics_parse(self):
        os.mkdir(self.path("f-1.png"))
        done = self.render(
            "--out", self.path("f-%d.png"), "--frames", 5, "--stats", self.path("stats.json")
        )
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(self.path("f-1.png"), done.stderr)
        self.assertLessEqual(len(self.frames()), 2)

    def test_picture_is_written_to_a_device_in_an_unwritable_folder(self):
        nobody = 65534 if os.geteuid() == 0 else None
        scene = os.path.join(SCENES, "shells.scene")
        words = [GAZEVIEW, "--headless", "--scene", scene, "--size", "16x16", "--out", "/dev/null"]
        try:
            done = subprocess.run(words, user=nobody, capture_output=True, text=True, timeout=2 * PATIENCE_S)
        except PermissionError:
            self.skipTest("nobody may run it")
        self.assertEqual(done.returncode, 0, done.stderr)

    @no_other_threads
    def test_camera_inside_the_volume_does_not_lengthen_steps(self):
        where = ("--camera.eye", "0.05 -0.15 0.02", "--camera.look_at", "0.3 0.5 0.1")
        pictures = []
        for rule in ("method", "none"):
            self.good("--method", "acuity", *where, "--foveation.step_rule", rule, "--out",
                      self.path("in.png"), size="320x180")
            pictures.append(read_png(self.path("in.png")))
        self.assertTrue(pictures[0] == pictures[1])

    @no_other_threads
    def test_up_parallel_to_the_view_is_replaced_with_one_warning(self):
        pictures = []
        for up in ("0 0 2", "0 0 0", "1 0 0"):
            done = self.good("--camera.eye", "0 0 2", "--camera.look_at", "0 0 0",
                             "--camera.up", up, "--out", self.path("up.png"))
            counts = up == "1 0 0"
            self.assertEqual(done.stderr.count("\n"), 0 if counts else 1, done.stderr)
            self.assertEqual("camera.up" in done.stderr, not counts)
            pictures.append(read_png(self.path("up.png")))
        self.assertTrue(pictures[0] == pictures[1] == pictures[2])

    def test_objects_are_listed_with_their_names(self):
        done = run(GAZEVIEW, "--list-objects", write_labels(self.place.name))
        self.assertEqual(done.stdout.splitlines()[0],
                         "label 5 voxels 48 technique isosurface colour #ff0033 left lobe")
        self.assertRegex(done.stdout.splitlines()[1],
                         "^label 9 voxels 48 technique isosurface colour #[0-9a-f]{6}$")
        done = run(GAZEVIEW, "--list-objects", SCENE)
        self.assertEqual(done.stdout, "volume 64 x 64 x 64 technique raycast\n")

    def test_signal_ends_the_run_between_frames_and_the_statistics_parse(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            process = subprocess.Popen(
                [GAZEVIEW, "--headless", "--scene", SCENE, "--size", "96x64", "--frames",
                 "1000000", "--stats", self.path("stats.json")],
                stdout=subprocess.PIPE, text=True,
            )
            for _ in range(3):
                self.assertRegex(process.stdout.readline(), LINE)
            process.send_signal(number)
            process.communicate(timeout=PATIENCE_S)
            kill = number == signal.SIGKILL
            self.assertEqual(process.returncode, -number if kill else 128 + number)
            self.assertGreaterEqual(len(self.frames()), 2)

    def test_second_signal_ends_a_slow_frame(self):
        process = subprocess.Popen(
            [GAZEVIEW, "--headless", "--scene", SCENE, "--size", "8192x8192", "--method",
             "standard", "--render.ray_sampling_rate", "32", "--stats", self.path("stats.json")],
            stdout=subprocess.PIPE, text=True,
        )
        deadline = time.monotonic() + PATIENCE_S
        while not os.path.exists(self.path("stats.json")) and time.monotonic() < deadline:
            time.sleep(0.01)  # polled: the frame has no other sign of having begun
        while process.poll() is None and time.monotonic() < deadline:
            process.send_signal(signal.SIGTERM)
            time.sleep(0.01)
        ended = process.poll()
        process.kill()
        process.communicate()
        self.assertEqual(ended, -signal.SIGTERM)
        self.assertEqual(self.frames(), [])

    @no_other_threads
    def test_drawing_is_printed_at_any_size(self):
        drawn = ("--technique", "illustrate", "--isovalue", "0.5", "--illustration.drawing",
                 "stipples", "--illustration.pen_width", "1", "--print-mm", "50.8")
        svg, png = self.path("a.svg"), self.path("a.png")
        if "Embree" in self.render(*drawn, "--backend", "cpu").stderr:
            self.skipTest("needs Embree")
        self.good(*drawn, "--print", svg)
        with open(svg, encoding="utf-8") as source:
            text = source.read()
        self.assertRegex(text, r'<svg [^>]*width="50\.8\d*mm"')
        self.assertGreater(text.count("<circle"), 50)
        self.assertIn("<path", text)  # its outline
        self.good(*drawn, "--print", png, "--print-dpi", 150, "--method", "standard", "--out",
                  self.path("screen.png"))
        printed = read_png(png)
        self.assertEqual((printed.width, printed.height), (300, 200))
        dark = [darkness(png), darkness(self.path("screen.png"))]
        self.assertAlmostEqual(dark[0], dark[1], delta=0.02)

    @no_other_threads
    def test_what_cannot_be_printed_is_refused(self):
        grey = ("--technique", "illustrate", "--isovalue", "0.5", "--print", self.path("a.svg"))
        if "Embree" in self.render(*grey, "--backend", "cpu").stderr:
            self.skipTest("needs Embree")
        inked = (*grey[:-1], self.path("a.pdf"), "--illustration.drawing", "hatches")
        for options, word in (
            (grey, "illustration.drawing"),
            (inked, ".pdf: unknown ending"),
            ((*SURFACE, "--print", self.path("a.svg")), "--technique illustrate"),
            ((*inked[:-3], self.path("no/a.svg"), *inked[-2:]), "create that folder"),
            ((*inked[:-3], self.path("a.png"), *inked[-2:], "--print-mm", 9000, "--print-dpi",
              20000), "131072"),
        ):
            done = self.render(*options)
            self.assertGreater(done.returncode, 0)
            self.assertIn(word, done.stderr)
        self.assertEqual(os.listdir(self.place.name), [])

    @no_other_threads
    def test_help_version_and_formats_go_to_stdout(self):
        for word, said in (("--help", "--gaze"), ("--version", "gazeview "), ("--formats", "NRRD .nrrd")):
            done = run(GAZEVIEW, word)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn(said, done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
