"""gazeview --headless --video, checked with ffprobe and ffmpeg.

video_command.py GAZEVIEW SCENES-FOLDER
"""

import json
import os
import shutil
import sys
import tempfile
import unittest

from picture import read_png, run, skip, write_scene

GAZEVIEW, SCENES = sys.argv[1], sys.argv[2]

for tool in ("ffmpeg", "ffprobe"):
    if not shutil.which(tool):
        skip(tool + " is not installed")

PLACE = tempfile.TemporaryDirectory(prefix="gazecast-test-scene-")
SCENE = write_scene(PLACE.name, SCENES)


def probe(path):
    done = run(
        "ffprobe", "-v", "error", "-count_frames", "-show_entries",
        "stream=codec_name,width,height,pix_fmt,avg_frame_rate,nb_read_frames,color_space", "-of",
        "json", path,
    )
    assert done.returncode == 0, done.stderr
    (stream,) = json.loads(done.stdout)["streams"]
    return stream


def read_frame(path, number):
    """A picture of a video, as the PNG that ffmpeg makes of it."""
    still = path + ".%d.png" % number
    done = run(
        "ffmpeg", "-v", "error", "-y", "-i", path, "-vf", "select=eq(n\\,%d)" % number, "-frames:v",
        "1", "-pix_fmt", "rgb24", still,
    )
    assert done.returncode == 0, done.stderr
    return read_png(still)


def distance(a, b):
    """Mean difference of a channel in the part that both have."""
    width, height = min(a.width, b.width), min(a.height, b.height)
    one, other = a.part(0, 0, width, height), b.part(0, 0, width, height)
    return sum(abs(x - y) for x, y in zip(one, other)) / len(one)


class Video(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory(prefix="gazecast-test-video-")
        self.addCleanup(self.place.cleanup)

    def path(self, name):
        return os.path.join(self.place.name, name)

    def render(self, *more, **options):
        return run(GAZEVIEW, "--headless", SCENE, *more, **options)

    def good(self, *more):
        done = self.render(*more)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_ten_frames_become_a_video_of_their_pictures(self):
        video = self.path("turn.mp4")
        self.good("--size", "160x120", "--frames", 10, "--fps", 25, "--turn", 12, "--video", video,
                  "--out", self.path("%d.png"))
        self.assertEqual(
            probe(video),
            {"codec_name": "h264", "width": 160, "height": 120, "pix_fmt": "yuv420p",
             "color_space": "bt709", "avg_frame_rate": "25/1", "nb_read_frames": "10"},
        )
        pictures = [read_png(self.path("%d.png" % k)) for k in (0, 9)]
        apart = distance(*pictures)
        for number, picture in zip((0, 9), pictures):
            near = distance(read_frame(video, number), picture)
            self.assertLess(near, 4, "picture %d of the video is another" % number)
            self.assertLess(2 * near, apart, "the pictures are too alike to tell")

    def test_odd_sides_get_a_black_row_and_column(self):
        video = self.path("odd.mp4")
        self.good("--size", "63x41", "--render.background", "1 1 1", "--video", video)
        picture = read_frame(video, 0)
        self.assertEqual((picture.width, picture.height), (64, 42))
        self.assertGreater(min(picture.at(20, 2)), 200)
        self.assertLess(max(picture.at(63, 20) + picture.at(20, 41)), 90)

    def test_ending_chooses_the_format(self):
        for ending, codec in (("webm", "vp9"), ("mkv", "h264"), ("gif", "gif")):
            video = self.path("a." + ending)
            self.good("--size", "32x32", "--video", video)
            self.assertEqual(probe(video)["codec_name"], codec)

    def test_name_like_an_option_or_a_protocol_is_a_file(self):
        for name in ("-y.mp4", "http:a.mp4"):
            done = self.render("--size", "32x32", "--video=" + name, cwd=self.place.name)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertTrue(os.path.exists(self.path(name)))

    def refused(self, done, *words):
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_missing_ffmpeg_is_refused_with_the_remedy(self):
        environment = dict(os.environ, PATH=self.place.name)
        video = self.path("none.mp4")
        done = self.render("--size", "32x32", "--video", video, env=environment)
        self.refused(done, video, "install the package ffmpeg")
        self.assertFalse(os.path.exists(video))

    def test_full_disk_ends_the_run_with_the_message_of_ffmpeg(self):
        video = self.path("full.mp4")
        os.symlink("/dev/full", video)
        done = self.render("--size", "320x240", "--frames", 5, "--turn", 9, "--video", video)
        self.refused(done, video, "No space left on device")

    def test_missing_folder_is_refused_before_anything_is_loaded(self):
        done = self.render("--video", self.path("no/a.mp4"))
        self.refused(done, "--video", "No such file")
        self.assertEqual(done.stdout, "")

    def test_video_of_a_window_is_refused_with_the_remedy(self):
        self.refused(run(GAZEVIEW, SCENE, "--video", "a.mp4"), "--video", "--headless")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
