#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""objects.csv, the trajectories and graph.g2o read with Python's own means and held against map.json."""
import csv
import json
import math
import pathlib
import sys

root = pathlib.Path(sys.argv[1])


def close(a, b, tolerance=1e-5):
    assert len(a) == len(b) and all(abs(x - y) <= tolerance for x, y in zip(a, b)), f"{a} is not {b}"


def multiply(a, b):
    """Quaternions x y z w."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def rotate(q, p):
    conjugate = [-q[0], -q[1], -q[2], q[3]]
    return multiply(multiply(q, [*p, 0.0]), conjugate)[:3]


def tum(path):
    return [[float(word) for word in line.split()] for line in path.read_text().splitlines() if not line.startswith("#")]


def check_csv(directory):
    objects = json.loads((directory / "map.json").read_text())["objects"]
    text = (directory / "objects.csv").read_bytes().decode("utf-8")
    assert text.count("\r\n") == text.count("\n") == len(objects) + 1
    rows = list(csv.DictReader(text.splitlines(), strict=True))
    assert len(rows) == len(objects)
    for row, thing in zip(rows, objects):
        assert None not in row and None not in row.values(), f"a row of another length: {row}"
        assert (int(row["id"]), row["type"], row["functions"].split("; ")) == (thing["id"], thing["type"], thing["functions"])
        close([float(row[key]) for key in ("x_m", "y_m", "z_m")], thing["pose"]["position"], 6e-4)
        sizes = [float(row[key]) for key in ("length_m", "width_or_height_m") if row[key]]
        close(sizes, thing.get("size", []), 6e-4)


def check_graph(directory):
    """Vertices are the trajectory; edges, one after the other, are the odometry; the information is that of the steps."""
    vertices, edges = {}, []
    for line in (directory / "graph.g2o").read_text().splitlines():
        tag, *words = line.split()
        if tag == "VERTEX_SE3:QUAT":
            vertices[int(words[0])] = [float(word) for word in words[1:]]
        elif tag == "EDGE_SE3:QUAT":
            edges.append((int(words[0]), int(words[1]), [float(word) for word in words[2:]]))
        else:
            assert tag in ("#", "FIX"), line
    trajectory, odometry = tum(directory / "trajectory.tum"), tum(directory / "odometry.tum")
    assert len(vertices) == len(trajectory) == len(odometry) and len(edges) == max(0, len(vertices) - 1)
    for (i, vertex), row in zip(sorted(vertices.items()), trajectory):
        close(vertex, row[1:])
    if not odometry:
        return
    position, turn = odometry[0][1:4], odometry[0][4:]
    for (i, j, numbers), row in zip(edges, odometry[1:]):
        assert j == i + 1 and len(numbers) == 7 + 21
        position = [a + b for a, b in zip(position, rotate(turn, numbers[:3]))]
        turn = multiply(turn, numbers[3:7])
        close(position, row[1:4])
        close(turn, row[4:])
        diagonal = [numbers[7 + k] for k in (0, 6, 11, 15, 18, 20)]
        close([1 / math.sqrt(value) for value in diagonal], [0.01, 0.01, 0.005, 0.0045, 0.0045, 0.01])


for name in ("sample", "empty"):
    check_csv(root / name)
    check_graph(root / name)
print("objects.csv, trajectory.tum, odometry.tum, graph.g2o agree with map.json")
