# Reads the drawing that test_stipple.c writes, and fails if it is not what was meant.
import sys
import xml.etree.ElementTree as tree

NAMES = {"svg": "http://www.w3.org/2000/svg"}
root = tree.parse(sys.argv[1]).getroot()
assert root.tag == "{http://www.w3.org/2000/svg}svg", root.tag
assert (root.get("width"), root.get("height")) == ("100.000mm", "75.000mm"), root.attrib
assert root.get("viewBox") == "0 0 100.000 75.000", root.attrib

circles = [tuple(float(c.get(key)) for key in ("cx", "cy", "r")) for c in root.findall(".//svg:circle", NAMES)]
assert circles == [(2.5, 5.0, 0.5), (0.188, 0.875, 0.375)], circles

paths = [p.get("d") for p in root.findall(".//svg:path", NAMES)]
assert len(paths) == 2, paths
corners = [[tuple(map(float, c.split())) for c in p.strip("MZ").split("L")] for p in paths]
assert [len(c) for c in corners] == [6, 4], corners
# the second line is a rectangle of 10 by 1 px
xs, ys = zip(*corners[1])
assert (min(xs), max(xs), min(ys), max(ys)) == (12.625, 15.125, 12.5, 12.75), corners[1]
# the first begins in a point
assert corners[0][0] == corners[0][5] == (2.625, 2.625), corners[0]
