#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""floor.pgm and floor.yaml as ROS's map_server reads them, with Pillow and PyYAML."""
import math
import pathlib
import sys

try:
    import yaml
    from PIL import Image
except ImportError as missing:
    print(f"SKIPPED: python3-{'yaml' if missing.name == 'yaml' else 'pil'} is not here; tools/setup.sh --tests gets it")
    sys.exit(77)

FREE, OCCUPIED, UNKNOWN = 0, 100, -1


def load(directory):
    """What map_server's loadMapFromYaml does in mode trinary: a function of a point of the map frame."""
    meta = yaml.safe_load((directory / "floor.yaml").read_text())
    assert meta["mode"] == "trinary" and meta["negate"] == 0 and meta["origin"][2] == 0.0, meta
    picture = Image.open(directory / meta["image"])
    assert (picture.format, picture.mode) == ("PPM", "L"), picture
    pixels = picture.load()

    def at(x, y):
        column = math.floor((x - meta["origin"][0]) / meta["resolution"])
        row = picture.height - 1 - math.floor((y - meta["origin"][1]) / meta["resolution"])
        occupancy = (255 - pixels[column, row]) / 255
        return OCCUPIED if occupancy > meta["occupied_thresh"] else FREE if occupancy < meta["free_thresh"] else UNKNOWN

    return picture, at


root = pathlib.Path(sys.argv[1])
picture, at = load(root / "sample")
wanted = {(0.52, 1.02): FREE, (4.02, 0.52): OCCUPIED, (4.02, 1.22): FREE, (1.23, 1.02): OCCUPIED, (0.02, 2.52): UNKNOWN}
for point, value in wanted.items():
    assert at(*point) == value, f"{point} is {at(*point)}, not {value}"
assert set(picture.getdata()) == {0, 205, 254}, set(picture.getdata())

empty, at = load(root / "empty")
assert set(empty.getdata()) == {205} and at(0.3, 0.3) == UNKNOWN
print(f"floor.pgm: {picture.width} × {picture.height}")
