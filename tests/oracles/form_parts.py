#!/usr/bin/env python3
"""The part that the program of a form leaves, against its outline built by shapely.

This makes random values for the forms turn, bore, contour and groove, writes each program
with `form -o`, cuts its part with `check --section`, and measures the distance between the
section and the outline that the values describe. Corners of an outline are rounded here by
tangent circles, chamfers by points on both lines. Where the outline has a sharp inner corner
the nose of the insert stays: the expected part is closed by a disc of the nose radius
(shapely's buffer, outwards and back).

Needs numpy and shapely.

    python3 tests/oracles/form_parts.py --program target/debug/gsk980td --parts 100
"""

import argparse
import csv
import os
import random
import subprocess
import tempfile

import numpy as np
from shapely.geometry import LineString, Point, Polygon, box
from shapely.ops import unary_union

TOLERANCE = 0.002  # mm
FINE = 256  # segments in a quarter of a circle
BLADE_NOSE = 0.1  # corner radius of the grooving tool of the job, mm


def unit(vector):
    return vector / np.hypot(*vector)


def rounded(points):
    """A line through corners (x, z, kind, size) with arcs and chamfers; x as a radius."""
    line = [np.array(points[0][:2])]
    for before, corner, after in zip(points, points[1:], points[2:]):
        at = np.array(corner[:2])
        one, two = unit(np.array(before[:2]) - at), unit(np.array(after[:2]) - at)
        kind, size = corner[2:]
        half = np.arccos(np.clip(one @ two, -1, 1)) / 2
        if kind == "C":
            line += [at + one * size, at + two * size]
        elif kind == "R" and half < np.pi / 2 - 1e-9:
            center = at + unit(one + two) * size / np.sin(half)
            begin, end = at + one * size / np.tan(half), at + two * size / np.tan(half)
            angles = [np.arctan2(*(point - center)[::-1]) for point in (begin, end)]
            turn = (angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi
            steps = angles[0] + turn * np.linspace(0, 1, FINE)
            line += [center + size * np.array([np.cos(step), np.sin(step)]) for step in steps]
        else:
            line.append(at)
    line.append(np.array(points[-1][:2]))
    return [(point[1], point[0]) for point in line]


def closed(part, radius):
    """The part with its inner corners filled by a disc."""
    if radius == 0:
        return part
    return part.buffer(radius, quad_segs=FINE).buffer(-radius, quad_segs=FINE)


def outline_part(points, sign, limit, nose, low):
    """The material beside an outline. `limit`: radius of the stock or hole; `low`: its end."""
    first, last = points[0], points[-1]
    entry = (first[0] - sign * 5, first[1], "", 0)
    line = rounded([entry, *points, (limit, last[1], "", 0)])
    if sign > 0:
        around = [(low, limit), (low, -90), (0, -90)]
    else:
        around = [(low, limit), (low, 200), (0, 200)]
    part = Polygon([*line, *around]).buffer(0)
    part = part.intersection(box(low, -90, 0, 200))
    return closed(part, nose)


def turn(rng, inside):
    nose = rng.choice([0, 0.4, 0.8])
    step = rng.uniform(1.2, 6)
    sign = -1 if inside else 1
    diameter = round(rng.uniform(26, 60), 3)
    other = round(diameter + 2 * sign * step, 3)
    front = diameter if rng.random() < 0.5 else round(diameter - 2 * sign * rng.uniform(0, 3), 3)
    length = round(rng.uniform(8, 50), 3)
    size = round(rng.uniform(0.3, 2), 3)
    edge = rng.choice(["SHARP", "CHAMFER", "RADIUS"])
    foot = round(rng.uniform(max(nose, 0.1), 1.0), 3) if step > 2 and rng.random() < 0.5 else 0
    values = {"HOLE" if inside else "STOCK": other, "D": diameter, "DF": front, "L": length,
              "EDGE": edge, "R": foot, "NOSE": nose}
    if edge != "SHARP":
        values["C"] = size
    kind = {"SHARP": "", "CHAMFER": "C", "RADIUS": "R"}[edge]
    points = [(front / 2, 0, kind, size), (diameter / 2, -length, "R" if foot else "", foot)]
    return "bore" if inside else "turn", values, points, sign, other / 2, nose


def contour(rng, inside):
    nose = rng.choice([0, 0.4, 0.8])
    sign = -1 if inside else 1
    x, z = (round(rng.uniform(35, 40), 3), 0.0) if inside else (round(rng.uniform(5, 9), 3), 0.0)
    points, words = [], []
    for index in range(rng.randint(3, 6)):
        along, across = round(rng.uniform(5, 12), 3), round(rng.uniform(2.5, 4), 3)
        if index:
            if rng.random() < 0.5:
                x = x + sign * across
            z = z - along
        kind = rng.choice(["", "R", "C"])
        size = round(rng.uniform(max(nose, 0.5), 1.9), 3) if kind == "R" else round(rng.uniform(0.3, 1.2), 3)
        points.append((x, z, kind, size))
        words.append(f"X{2 * x:.3f}Z{z:.3f}" + (f"{kind}{size}" if kind else ""))
    points[-1] = (*points[-1][:2], "", 0)
    words[-1] = f"X{2 * x:.3f}Z{z:.3f}"
    limit = x + sign * 2
    values = {"SIDE": "IN" if inside else "OUT", "POINTS": ";".join(words), "NOSE": nose,
              "HOLE" if inside else "STOCK": f"{2 * limit:.3f}"}
    return "contour", values, points, sign, limit, nose


def groove(rng, inside):
    diameter = round(rng.uniform(26, 60), 3)
    depth, blade = round(rng.uniform(1, 5), 3), round(rng.uniform(1.5, 4), 3)
    width, position = round(blade + rng.uniform(0, 8), 3), round(rng.uniform(2, 20), 3)
    bottom = diameter + 2 * depth if inside else diameter - 2 * depth
    values = {"SIDE": "IN" if inside else "OUT", "D": diameter, "DB": f"{bottom:.3f}",
              "TW": blade, "W": width, "POS": position}
    near, far = -position, -position - width
    low, high = sorted((diameter / 2, bottom / 2))
    cut = box(far, low - (1 if inside else 0), near, high + (0 if inside else 1))
    return "groove", values, (cut, diameter / 2), -1 if inside else 1, None, BLADE_NOSE


def section_of(path):
    polygons = {}
    with open(path, newline="") as rows:
        for row in csv.DictReader(rows):
            point = (float(row["z"]), float(row["x"]) / 2)
            polygons.setdefault(row["polygon"], []).append(point)
    return unary_union([Polygon(points).buffer(0) for points in polygons.values()])


def compare(program, folder, rng):
    make = rng.choice([turn, contour, groove])
    name, values, shape, sign, limit, nose = make(rng, rng.random() < 0.5)
    file, section = os.path.join(folder, "form.CNC"), os.path.join(folder, "section.csv")
    for path in (file, file.replace(".CNC", ".job.ron")):
        if os.path.exists(path):
            os.remove(path)
    words = [word for id, value in values.items() for word in ("--set", f"{id}={value}")]
    subprocess.run([program, "form", name, *words, "-o", file], check=True)
    subprocess.run([program, "check", "--part", "--section", section, file],
                   check=True, capture_output=True)
    found = section_of(section)
    low = found.bounds[0]
    if make is groove:
        cut, surface = shape
        whole = box(low, -90, 0, surface) if sign > 0 else box(low, surface, 0, 200)
        wanted = closed(whole.difference(cut), nose)
    else:
        wanted = outline_part(shape, sign, limit, nose, low)
    deepest = wanted.bounds[0] + 1
    # Ends of the stock and the side that is not cut are not compared.
    window = box(deepest, 0.5, -0.001, found.bounds[3] - 0.5 if sign < 0 else 200)
    edges = [LineString(part.exterior.coords) for part in polygons(wanted)]
    edges = unary_union(edges).intersection(window)
    own = unary_union([part.exterior for part in polygons(found)])
    points = [point for line in lines(edges) for point in line.coords]
    if len(points) < 4:
        raise SystemExit(f"nothing to compare: {name} {values}")
    off = max(own.distance(Point(point)) for point in points)
    return off, name, values


def polygons(shape):
    return getattr(shape, "geoms", [shape])


def lines(shape):
    return [line for line in getattr(shape, "geoms", [shape]) if line.geom_type == "LineString"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--program", default="target/debug/gsk980td")
    arguments.add_argument("--parts", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=1)
    given = arguments.parse_args()
    rng = random.Random(given.seed)
    worst, faults = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(given.parts):
            off, name, values = compare(given.program, folder, rng)
            worst = max(worst, off)
            if off > TOLERANCE:
                faults += 1
                print(f"{off:.4f} mm off: {name} {values}")
    print(f"{given.parts} parts, greatest difference {worst:.4f} mm, {faults} above {TOLERANCE} mm")
    raise SystemExit(faults > 0)


if __name__ == "__main__":
    main()
