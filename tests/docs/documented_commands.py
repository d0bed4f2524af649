"""The commands of README.md and docs/*.md, run one by one, as a reader runs them.

documented_commands.py SOURCE-FOLDER BUILD-FOLDER PAGES [WORDS]

Each page has a folder of its own, in which its commands run in order: what one writes, the next one
reads. The folder has the repository's own folders (etc, docs, scripts, ...) and the files that the
page takes for granted. So that this takes a minute, a picture is small and a path of the gaze short;
a window becomes a picture, and the daemon reads its options and prints its configuration. Nothing is
installed, fetched or sent to another machine. PAGES are the first letters of the pages' names, as in
"a-g". With WORDS, only commands that contain them run.
"""

import glob
import gzip
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile

SOURCE, BUILD = (os.path.abspath(folder) for folder in sys.argv[1:3])
PAGES = sys.argv[3]
WORDS = sys.argv[4] if len(sys.argv) > 4 else ""
DATA = os.environ.get("GAZECAST_DATA", "")
PROGRAMS = {"gazed": "daemon", "gazectl": "client", "gazeview": "view", "gazebench": "bench"}
PATIENCE_S = 120
SMALL = "64x48"

# Commands that need more than one machine, or what a loop of the shell has made.
ELSEWHERE = ("gazebench merge", "supernova_*.scene", "parallel ")

# Commands of gazebench that take long however small the picture is; they have tests of their own.
LONG = {"techniques", "stability"}

# Commands of gazectl that ask a daemon or make keys.
ASKING = {"status", "validate", "watch", "record", "stop", "devices", "keygen", "annotate", "note",
          "calibrate", "mark", "pupil"}


def blocks(path):
    """The code of a page: (line number, text), from fences of sh and from indented text."""
    fence, before = None, ""
    with open(path, encoding="utf-8") as page:
        for number, line in enumerate(page, 1):
            line = line.rstrip("\n")
            if line.startswith("```"):
                fence = None if fence is not None else line[3:]
                continue
            if fence == "sh":
                yield number, line
            elif fence is None and line.startswith("    ") and before != "list":
                yield number, line[4:]
            if not line.startswith(" ") and line:
                before = "list" if re.match(r"[-*] |\d+\. ", line) else ""


def commands(path):
    """The commands of a page, joined where a line goes on: (line number, text)."""
    begun, first = "", 0
    for number, line in blocks(path):
        if not begun:
            first = number
        begun += line.strip()
        if begun.endswith("\\"):
            begun = begun[:-1]
            continue
        text, begun = re.sub(r"(^|\s+)#\s.*$", "", begun), ""
        for part in re.split(r"\s&&\s|\s\|\s", text):
            if part.strip():
                yield first, part.strip().removesuffix("&").strip()


def write_volume(path, labels=False):
    """A ball in a small volume, or the eight corners' labels."""
    edge = 12
    voxels = bytearray()
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                away = ((x - 5.5) ** 2 + (y - 5.5) ** 2 + (z - 5.5) ** 2) ** 0.5
                voxels.append(max(0, round(250 - 40 * away)) if not labels else 1 + (x > 5))
    if path.endswith(".nii.gz"):
        head = bytearray(352)
        struct.pack_into("<i", head, 0, 348)
        struct.pack_into("<8h", head, 40, 3, edge, edge, edge, 1, 1, 1, 1)
        struct.pack_into("<hh", head, 70, 2, 8)
        struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
        struct.pack_into("<f", head, 108, 352)
        head[344:348] = b"n+1\0"
        with gzip.open(path, "wb") as out:
            out.write(head + voxels)
        return
    with open(path, "wb") as out:
        out.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 12 12 12\n"
                  b"spacings: 1 1 1\nencoding: raw\n\n" + voxels)


def write_series(path):
    """Four time points of a small volume."""
    write_volume(path)
    with gzip.open(path) as one:
        content = bytearray(one.read())
    struct.pack_into("<8h", content, 40, 4, 12, 12, 12, 4, 1, 1, 1)
    with gzip.open(path, "wb") as out:
        out.write(content[:352] + content[352:] * 4)


def write_text(text):
    def write(path):
        with open(path, "w", encoding="utf-8") as out:
            out.write(text)
    return write


def own_scene(volume):
    return write_text("[volume]\nfile = %s\n[camera]\neye = 0.8 1.3 0.5\n" % volume)


def link_data(name):
    """A file of the data, which may not be at hand."""
    def link(path):
        if DATA:
            os.symlink(os.path.join(DATA, name), path)
    return link


def copy_series(path):
    """Two files of particles, of which the page names the first."""
    for frame, name in (("9_6859", path), ("23_24389", path.replace("0001", "0002"))):
        if DATA:
            shutil.copyfile(os.path.join(DATA, "particles/dam_break_frame_%s_particles.bgeo" % frame), name)


def write_eyelink(path):
    """Half a second of one eye, as edf2asc writes it."""
    with open(path, "w", encoding="ascii") as out:
        out.write("** CONVERTED FROM pilot.edf\n"
                  "MSG\t1000 DISPLAY_COORDS 0 0 1023 767\n"
                  "START\t1000 \tRIGHT\tSAMPLES\tEVENTS\n"
                  "SAMPLES\tGAZE\tRIGHT\tRATE\t500.00\tTRACKING\tCR\n")
        for i in range(250):
            out.write("%d\t%.1f\t%.1f\t800.0\t...\n" % (1000 + 2 * i, 500 + i % 3, 380 - i % 2))
        out.write("END\t1500 \tSAMPLES\tEVENTS\n")


def write_table(path):
    """Half a second as a program of somebody's own writes it."""
    with open(path, "w", encoding="ascii") as out:
        out.write("t,gx,gy,c\n")
        for i in range(100):
            out.write("%d,%.1f,%.1f,0.9\n" % (5 * i, 960 + i % 3, 540 - i % 2))


def write_session(path):
    """Two frames of a session."""
    folder = os.path.dirname(path)
    if not os.path.exists(os.path.join(folder, "head.nrrd")):
        write_volume(os.path.join(folder, "head.nrrd"))
    subprocess.run([program("gazeview"), "head.nrrd", "--headless", "--size", SMALL, "--frames",
                    "2", "--record", path, "--out", path + "-%d.png"], check=True, cwd=folder,
                   capture_output=True, timeout=PATIENCE_S)


def write_recording(path):
    """Half a second of a gaze log."""
    write_eyelink(path + ".asc")
    subprocess.run([program("gazectl"), "convert", path + ".asc", path], check=True,
                   capture_output=True, timeout=PATIENCE_S)


# What pages take for granted that a reader has.
SAMPLES = {
    "head.nrrd": write_volume, "ch2.nii.gz": write_volume, "heart.nii.gz": write_series,
    "head.scene": own_scene("head.nrrd"), "my.scene": own_scene("head.nrrd"),
    "big.scene": own_scene("head.nrrd"), "nova.scene": own_scene("head.nrrd"),
    "bricks.scene": own_scene("nova.gzb"),
    "dam_break.bgeo": link_data("particles/dam_break_frame_9_6859_particles.bgeo"),
    "water_0001.bgeo": copy_series,
    "bonsai_256x256x256_uint8.raw.zst": link_data("volumes/bonsai_256x256x256_uint8.raw.zst"),
    "session.gzl": write_recording, "day.gzl": write_recording,
    "pilot.csv": write_table, "subject7.asc": write_eyelink, "walk.session": write_session,
    "sub-07_task-sharpness_events.tsv": write_text(
        "trial_type\tpractice\tcorrect\tresponse\tresponse_time\tscene_1\tsettings_1\tsettings_2\t"
        "staircase\tstaircase_value\nfine\t0\t1\tfirst\t0.7\ts\tn/a\tk=1\tk\t1\n"),
    "bone.tf": write_text("0.4 1 1 1 0\n0.5 1 1 1 0.5\n"),
}


def program(name):
    return os.path.join(BUILD, PROGRAMS[name], name)


def option_after(words, name):
    return words[words.index(name) + 1] if name in words[:-1] else None


def replace_option(words, name, value):
    """Give an option another value, or give it."""
    if name in words:
        words[words.index(name) + 1] = value
    else:
        words += [name, value]


def drop_option(words, name, values=1):
    if name in words:
        at = words.index(name)
        del words[at:at + 1 + values]


def small_picture(words):
    """gazeview: a small picture, and no window."""
    prints = {"--list-objects", "--list-series", "--formats", "--write-mesh", "--write-volume",
              "--help"}
    if prints & set(words):
        return words
    if "--headless" not in words:
        words.append("--headless")
        if option_after(words, "--gaze") in ("mouse", "pointer") or \
           (option_after(words, "--gaze") or "").startswith("tcp:"):
            drop_option(words, "--gaze")
        if "--replay" in words:
            replace_option(words, "--stats", "counts.json")
        else:
            replace_option(words, "--out", "window-%d.png")
    if "--replay" not in words:
        replace_option(words, "--size", SMALL)
    if "--frames" in words:
        replace_option(words, "--frames", "2")
    return words


def short_study(words):
    """gazebench: a small picture, few frames and few gaze points."""
    if words[0] in ("run", "accumulate", "clip"):
        sizes = (option_after(words, "--size") or SMALL).count(",")
        replace_option(words, "--size", ",".join("%dx48" % (64 + i) for i in range(sizes + 1)))
    if words[0] == "run":
        path = option_after(words, "--path") or "sweep:s:2"
        path = re.sub(r"random:\d+", "random:2", re.sub(r"grid:\dx\d", "grid:1x2", path))
        replace_option(words, "--path", re.sub(r":s:\d+", ":s:2", path))
        replace_option(words, "--frames", "2")
        if "--cameras" in words:
            replace_option(words, "--cameras", "2")
    elif words[0] == "clip":
        replace_option(words, "--frames", "2")
    return words


class Page:
    """A page's commands, run in a folder of its own."""

    def __init__(self, name, place):
        self.name = name
        self.folder = os.path.join(place, name.replace("/", "-"))
        os.mkdir(self.folder)
        for entry in ("etc", "docs", "scripts", "bench", "tests"):
            os.symlink(os.path.join(SOURCE, entry), os.path.join(self.folder, entry))
        os.makedirs(os.path.join(self.folder, "build"))
        os.symlink(BUILD, os.path.join(self.folder, "build", "release"))
        self.outcomes = []

    def provide(self, words):
        """Write what the command takes for granted, and nothing that it makes.

        @return whether all of it is at hand
        """
        made = words[-1] if words[1:2] == ["convert"] else option_after(words, "--out")
        names = (word.split("/")[0].replace("%04d", "0001") for word in words if word != made)
        for name in names:
            path = os.path.join(self.folder, name)
            if name in SAMPLES and not os.path.exists(path):
                if name.endswith(".scene"):
                    self.provide(["head.nrrd"])
                SAMPLES[name](path)
                if not os.path.exists(path):
                    return False
        return True

    def run(self, words):
        environment = dict(os.environ, HOME=self.folder, XDG_CACHE_HOME=self.folder,
                           XDG_CONFIG_HOME=self.folder, GZ_LOG="warn")
        if DATA:
            environment["GAZECAST_DATA"] = data_folder(os.path.dirname(self.folder))
        return subprocess.run(words, cwd=self.folder, env=environment, capture_output=True,
                              text=True, timeout=PATIENCE_S)

    def try_command(self, number, text):
        """@return why it cannot be as it stands; "" if it works; None if it is not for a test"""
        words = shlex.split(os.path.expandvars(text) if DATA else text)
        while words and re.match(r"[A-Z_]+=", words[0]):
            del words[0]
        if not words or any(part in text for part in ELSEWHERE) or "…" in text or "$" in text or re.search(r"\b[A-Z]{3,}\b(?!_)", text):
            return None
        name = words[0].removeprefix("build/release/")
        if not self.provide(words):
            return None
        if os.path.basename(name) in PROGRAMS and name != words[0]:
            name = os.path.basename(name)
        if name == "gazed":
            return self.failure([program(name)] + words[1:] + ["--print-config"])
        if name == "gazectl" and len(words) > 1:
            if words[1] in ASKING:
                return self.unknown_options(name, words[1:2], words[2:])
            return self.failure([program(name)] + words[1:])
        if words == ["gazeview"]:
            return None  # a window that offers scenes: tests/view/window_start.py
        if name == "gazeview":
            if "--experiment" in words:
                return self.unknown_options(name, [], words[1:])
            return self.failure([program(name)] + small_picture(words[1:]))
        if name == "gazebench" and words[1] in LONG:
            return self.unknown_options(name, words[1:2], words[2:])
        if name == "gazebench":
            return self.failure([program(name)] + short_study(self.with_files(words[1:])))
        return self.try_other(words)

    def with_files(self, words):
        """As a shell gives them."""
        out = []
        for word in words:
            found = glob.glob(word, root_dir=self.folder) if "*" in word else []
            out += sorted(found) or [word]
        return out

    def try_other(self, words):
        """Programs that take long: whether they are there."""
        if words[0] == "ctest":
            if "--preset" in words:
                return ""
            done = self.run(["ctest", "--test-dir", BUILD, "-N"] + words[1:])
            return "" if "Total Tests: 0" not in done.stdout else "there is no such test"
        if "/" in words[0]:
            path = os.path.join(self.folder, words[0])
            return "" if os.access(path, os.X_OK) else "there is no such program"
        return None

    def failure(self, command):
        done = self.run(command)
        if done.returncode == 0:
            return ""
        if not DATA and "is neither beside the scene nor under GAZECAST_DATA" in done.stderr:
            return None
        if "OpenGL" in done.stderr:
            return None
        return "%s\n%s" % (shlex.join(command), done.stderr.strip())

    def unknown_options(self, name, command, words):
        """Which options the program does not have."""
        known = self.run([program(name)] + command + ["--help"]).stdout
        for word in words:
            if word.startswith("--") and word.split("=")[0] not in known:
                return "%s has no %s" % (name, word)
            if word.startswith("etc/") and not os.path.exists(os.path.join(SOURCE, word)):
                return "there is no %s" % word
        return ""


def data_folder(place):
    """The data by links: what is kept beside them stays here."""
    folder = os.path.join(place, "data")
    if not os.path.isdir(folder):
        for at, _, names in os.walk(DATA):
            here = os.path.join(folder, os.path.relpath(at, DATA))
            os.makedirs(here)
            for name in names:
                os.symlink(os.path.join(at, name), os.path.join(here, name))
    return folder


def main():
    pages = ["README.md"] + sorted("docs/" + name for name in os.listdir(SOURCE + "/docs")
                                   if name.endswith(".md"))
    pages = [page for page in pages if re.match("[%s]" % PAGES, os.path.basename(page))]
    ran, left_out, failed = 0, [], []
    with tempfile.TemporaryDirectory(prefix="gazecast-docs-") as place:
        for name in pages:
            page = Page(name, place)
            for number, text in commands(os.path.join(SOURCE, name)):
                if WORDS not in text or not is_command(text):
                    continue
                where = "%s:%d: %s" % (name, number, text)
                why = page.try_command(number, text)
                if why is None:
                    left_out.append(where)
                elif why:
                    failed.append("%s\n  %s" % (where, why.replace("\n", "\n  ")))
                else:
                    ran += 1
    print("left out:\n  " + "\n  ".join(left_out))
    print("\n".join(failed))
    print("%d commands work, %d fail, %d are left out" % (ran, len(failed), len(left_out)))
    return 1 if failed or ran < 1 else 0


def is_command(text):
    """Whether a line of code is one of ours."""
    words = text.split()
    while words and re.match(r"[A-Z_]+=", words[0]):
        del words[0]
    return bool(words) and (words[0] in PROGRAMS or words[0] == "ctest" or
                            re.match(r"(build|bench|scripts|tests)/", words[0]) is not None)


if __name__ == "__main__":
    sys.exit(main())
