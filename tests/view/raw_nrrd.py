"""Raw NRRD files, as gazeview writes volumes, read with numpy."""

import numpy

TYPES = {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "float": "f4"}


def read_nrrd(path):
    """Voxels [x, y, z] and spacing of an attached raw NRRD; [channel, x, y, z] of one of colours."""
    with open(path, "rb") as source:
        head, data = source.read().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
    sizes = [int(size) for size in fields["sizes"].split()]
    kind = numpy.dtype(("<" if fields["endian"] == "little" else ">") + TYPES[fields["type"]])
    vectors = [vector.strip("()").split(",") for vector in fields["space directions"].split() if vector != "none"]
    spacing = [max(abs(float(number)) for number in vector) for vector in vectors]
    voxels = numpy.frombuffer(data, kind).reshape(sizes, order="F")
    return voxels.astype("f8"), spacing, fields.get("space")
