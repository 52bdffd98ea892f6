#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""plan.svg drawn by librsvg, and its texts read by ElementTree."""
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

if not shutil.which("rsvg-convert"):
    print("SKIPPED: rsvg-convert (librsvg2-bin) is not here; tools/setup.sh --tests gets it")
    sys.exit(77)
try:
    from PIL import Image
except ImportError:
    print("SKIPPED: python3-pil is not here; tools/setup.sh --tests gets it")
    sys.exit(77)

SVG = "{http://www.w3.org/2000/svg}"
root = pathlib.Path(sys.argv[1])


def draw(directory):
    picture = directory / "plan.png"
    subprocess.run(["rsvg-convert", "--output", picture, directory / "plan.svg"], check=True)
    return Image.open(picture).convert("RGB")


tree = ElementTree.parse(root / "sample/plan.svg").getroot()
texts = [text.text for text in tree.iter(SVG + "text")]
for wanted in ("W1 · ≥ 3.00 m", "1.60 × 0.80 m", "S5 · 1.00 × 0.60 m", "C7", "Room 1", "10.0 m²", "x", "y"):
    assert wanted in texts, f"{wanted} is not among {texts}"
titles = [title.text for title in tree.iter(SVG + "title")]
assert "table 2, 1.60 × 0.80 m, 0.74 m high, ± 0.02 m, seen 1 time, for place" in titles, titles

picture = draw(root / "sample")
colours = {colour: count for count, colour in picture.getcolors(1 << 24)}
for name, colour in {"wall": (0x2C, 0x34, 0x40), "table": (0xE3, 0xC9, 0xA4), "room": (0xF4, 0xF1, 0xEA),
                     "chair": (0xB4, 0xD8, 0xB9), "screen": (0x1D, 0x6F, 0xA5)}.items():
    assert colours.get(colour, 0) > 100, f"no {name} in the picture"

# To scale: as many millimetres of paper for 1.60 m of table as the plan says.
width_mm, pixels_of_page = float(tree.get("width").removesuffix("mm")), float(tree.get("viewBox").split()[2])
scale = next(float(text.split("1 : ")[1].split(",")[0]) for text in texts if "1 : " in text)
assert abs(width_mm / pixels_of_page * 90.0 - 1000.0 / scale) < 0.1, (width_mm, pixels_of_page, scale)

blank = draw(root / "empty")
assert {colour for _, colour in blank.getcolors(1 << 24)} >= {(255, 255, 255)}
print(f"plan.svg: {picture.width} × {picture.height}, 1 : {scale:.0f}")
