"""What the tests of gazeview share: reading its PNGs without a library, and running it."""

import os
import re
import struct
import subprocess
import sys
import zlib

SKIPPED = 77

# The longest wait for a condition, s: longer under sanitizers (cmake/GzTargets.cmake).
PATIENCE_S = int(os.environ.get("GZ_TEST_PATIENCE_S", "60"))


def skip(reason):
    print("skipped:", reason)
    sys.exit(SKIPPED)


def write_scene(folder, scenes):
    """The procedural scene of studies with a small volume, which is made in a blink."""
    with open(os.path.join(scenes, "study", "shells.scene"), encoding="utf-8") as source:
        text = source.read()
    assert "dims = 192 192 192" in text and "file = ../shells.tf" in text
    text = text.replace("dims = 192 192 192", "dims = 64 64 64")
    text = text.replace("file = ../shells.tf", "file = " + os.path.join(scenes, "shells.tf"))
    path = os.path.join(folder, "small.scene")
    with open(path, "w", encoding="utf-8") as out:
        out.write(text)
    return path


def write_labels(folder, *lines):
    """A scene of two labels side by side, 5 with a name and a colour and 9 without. -> its path"""
    voxels = bytearray(8 * 6 * 6)
    for z in range(1, 5):
        for y in range(1, 5):
            for x in range(1, 7):
                voxels[(z * 6 + y) * 8 + x] = 5 if x < 4 else 9
    with open(os.path.join(folder, "two.nrrd"), "wb") as out:
        out.write(b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 6 6\nencoding: raw\n"
                  b"spacings: 2 2 2\n\n" + bytes(voxels))
    with open(os.path.join(folder, "two.txt"), "w", encoding="utf-8") as out:
        out.write("5 left lobe 255 0 51 0\n")
    path = os.path.join(folder, "two.scene")
    with open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(("[object lobes]", "labels = two.nrrd", "technique = isosurface",
                             *lines, "")))
    return path


class Picture:
    """An 8-bit RGB picture, rows of bytes."""

    def __init__(self, width, height, rows):
        self.width, self.height, self.rows = width, height, rows

    def at(self, x, y):
        return tuple(self.rows[y][3 * x : 3 * x + 3])

    def part(self, left, top, right, bottom):
        """All bytes of a rectangle, right and bottom not included."""
        return b"".join(bytes(self.rows[y][3 * left : 3 * right]) for y in range(top, bottom))

    def __eq__(self, other):
        return (self.width, self.height) == (other.width, other.height) and all(
            bytes(a) == bytes(b) for a, b in zip(self.rows, other.rows)
        )


def paeth(a, b, c):
    p = a + b - c
    return min((a, b, c), key=lambda v: abs(p - v))


def unfilter(kind, row, above, channels):
    for i in range(len(row)):
        left = row[i - channels] if i >= channels else 0
        corner = above[i - channels] if i >= channels else 0
        if kind == 1:
            row[i] = (row[i] + left) & 255
        elif kind == 2:
            row[i] = (row[i] + above[i]) & 255
        elif kind == 3:
            row[i] = (row[i] + (left + above[i]) // 2) & 255
        elif kind == 4:
            row[i] = (row[i] + paeth(left, above[i], corner)) & 255


def read_png(path):
    """An 8-bit PNG, RGB or grey. -> a Picture, whose channels are alike if the file is grey"""
    with open(path, "rb") as source:
        data = source.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path + " is no PNG"
    at, packed, size = 8, b"", None
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height = size[:2]
    assert size[2] == 8 and size[3] in (0, 2) and size[4:] == (0, 0, 0), "not 8-bit: %r" % (size,)
    channels = 3 if size[3] == 2 else 1
    raw, rows, above = zlib.decompress(packed), [], bytearray(channels * width)
    for y in range(height):
        start = y * (channels * width + 1)
        row = bytearray(raw[start + 1 : start + 1 + channels * width])
        unfilter(raw[start], row, above, channels)
        rows.append(row if channels == 3 else bytes(value for value in row for _ in range(3)))
        above = row
    return Picture(width, height, rows)


def run(*command, **options):
    """Run a command. Its messages are without the progress that gazeview reports when it is slow."""
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=2 * PATIENCE_S, **options
    )
    done.stderr = re.sub(r"(?m)^gazecast: info: gazeview: loading .*\n", "", done.stderr)
    return done


def shows_between(gazeview, volume, value, *more):
    """Whether a picture of a volume of labels 0 to 4 has anything of the values around @value."""
    function = str(volume) + ".tf"
    with open(function, "w", encoding="ascii") as out:
        out.write("range 0 4\n")
        for at, opacity in ((-0.3, 0), (-0.3, 0.9), (0.3, 0.9), (0.3, 0)):
            out.write(f"{(value + at) / 4} 1 1 1 {opacity}\n")
    picture = str(volume) + ".png"
    done = run(gazeview, volume, "--headless", "--size", "160x120", "--method", "standard", "--out", picture,
               "--transfer.file", function, *more)
    assert done.returncode == 0, done.stderr
    return any(any(row) for row in read_png(picture).rows)
