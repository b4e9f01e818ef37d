#!/usr/bin/env python3
"""The part that G42 leaves, against a closing of the programmed contour by Clipper.

A nose of radius r that follows a contour without touching it removes every point that
a disc of that radius reaches from outside; what is left is the contour closed by the
disc: grown by r and shrunk by r. Without compensation the imaginary tip follows the
contour, and what is left is the area no position of the nose covers.

This makes random contours of cylinders, tapers, faces and arcs, rounded to 0.001 mm,
runs `check --part --section` on each with and without G42, and measures

  with G42     how far the part is cut too deep, and how far it is left standing, mm,
               against the closed contour
  without      the same against the nose swept along the uncompensated path

A step that is lower than the nose radius may be left standing farther: the control
does not bring the nose over such a corner as far as it would go.

Contours that the control refuses (interference) count apart. Needs pyclipper, which
grows and shrinks, and shapely, which measures distances.

    python3 tests/oracles/nose_parts.py --program target/release/gsk980td --parts 300
"""

import argparse
import concurrent.futures
import csv
import math
import os
import random
import subprocess
import tempfile

import pyclipper
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

STEP = 0.001  # least increment, mm
FINE = 512  # segments in a quarter of a circle
SCALE = 1e6  # Clipper counts in whole nanometres
ARC = 20  # how far its arcs may be off, nm


def grown(polygons, by, end=pyclipper.ET_CLOSEDPOLYGON):
    """Polygons (or an open line) grown by a distance, mm; shrunk by one below 0."""
    offset = pyclipper.PyclipperOffset(2.0, ARC)
    for polygon in polygons:
        path = [(round(z * SCALE), round(x * SCALE)) for z, x in polygon]
        offset.AddPath(path, pyclipper.JT_ROUND, end)
    return [[(z / SCALE, x / SCALE) for z, x in path] for path in offset.Execute(by * SCALE)]


def as_region(polygons):
    return unary_union([Polygon(points).buffer(0) for points in polygons])


def rounded(value):
    return round(value / STEP) * STEP


def contour(rng, nose):
    """Points (z, x) of a random contour, and the blocks that cut it."""
    z, x = 0.0, rounded(rng.uniform(8.0, 14.0))
    points, blocks = [(1.0, x), (z, x)], [f"G01 Z{z:.3f} F100"]
    while z > -40.0 and x < 22.0:
        kind = rng.choice(["cylinder", "cylinder", "up", "down", "face", "convex", "concave"])
        if kind == "cylinder":
            z = rounded(z - rng.uniform(2.0, 7.0))
        elif kind == "up":
            angle, length = math.radians(rng.uniform(5.0, 70.0)), rng.uniform(1.5, 5.0)
            z, x = rounded(z - length * math.cos(angle)), rounded(x + length * math.sin(angle))
        elif kind == "down":
            angle, length = math.radians(rng.uniform(3.0, 22.0)), rng.uniform(2.0, 5.0)
            if x - length * math.sin(angle) < 6.0:
                continue
            z, x = rounded(z - length * math.cos(angle)), rounded(x - length * math.sin(angle))
        elif kind == "face":
            x = rounded(x + rng.uniform(1.0, 3.0))
        else:
            radius = rounded(rng.uniform(max(1.0, 1.3 * nose), 5.0))
            start = (z, x)
            z, x = rounded(z - radius), rounded(x + radius)
            if kind == "convex":
                center, code, begin = (start[0] - radius, start[1]), "G03", 0.0
                turn = math.pi / 2
                center = (z, start[1])
                begin = 0.0
            else:
                center, code, begin, turn = (start[0], x), "G02", -math.pi / 2, -math.pi / 2
            for part in range(1, FINE):
                angle = begin + turn * part / FINE
                points.append(
                    (center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle))
                )
            points.append((z, x))
            blocks.append(f"{code} X{2 * x:.3f} Z{z:.3f} R{radius:.3f}")
            continue
        points.append((z, x))
        blocks.append(f"G01 X{2 * x:.3f} Z{z:.3f}")
    z = rounded(z - 3.0)
    points.append((z, x))
    blocks.append(f"G01 Z{z:.3f}")
    return points, blocks


def job(nose, radius, length):
    return f"""(
    stock: (form: Bar(diameter: {2 * radius:.3f}), face: 0, length: {length + 60:.3f},
        overhang: {length + 20:.3f}),
    tools: {{ 1: (insert: Turning(letter: D, entering: 93, size: 25.4, nose: {nose}), tip: 3) }},
)"""


def section(program, folder, name, text, description):
    path = os.path.join(folder, name + ".CNC")
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    with open(os.path.join(folder, name + ".job.ron"), "w", encoding="ascii") as file:
        file.write(description)
    out = os.path.join(folder, name + ".csv")
    call = [program, "check", path, "--section", out, "--param", "002.1=1"]
    call += ["--offset", description_offset(description)]
    result = subprocess.run(call, capture_output=True, text=True)
    if result.returncode == 1:
        return None
    if result.returncode not in (0, 3):
        raise RuntimeError(result.stdout + result.stderr)
    polygons = {}
    with open(out, encoding="ascii") as file:
        for row in csv.DictReader(file):
            point = (float(row["z"]), float(row["x"]) / 2)
            polygons.setdefault(row["polygon"], []).append(point)
    return as_region(polygons.values())


def description_offset(description):
    nose = description.split("nose: ")[1].split(")")[0]
    return f"01=0,0,{nose},3"


def largest(region):
    pieces = getattr(region, "geoms", [region])
    return max(pieces, key=lambda piece: piece.area)


def off(part, wanted, window):
    """How far the part is cut too deep, and how far it is left standing, within a window
    of Z: the farthest point of either outline from the other."""
    low, high = window
    part, wanted = largest(part), largest(wanted)
    worst = [0.0, 0.0]
    for one, other, inside in ((part, wanted, 0), (wanted, part, 1)):
        edge = other.exterior
        for z, x in one.exterior.coords:
            if low < z < high and x > 1.0:
                point = Point(z, x)
                side = inside if other.contains(point) else 1 - inside
                worst[side] = max(worst[side], edge.distance(point))
    return worst


def one(arguments):
    program, seed = arguments
    rng = random.Random(seed)
    nose = rng.choice([0.2, 0.4, 0.8, 1.2])
    points, blocks = contour(rng, nose)
    greatest = max(x for _, x in points) + rng.uniform(0.5, 2.0)
    back = points[-1][0]
    head = f"O0001\nG50 X100 Z50\nG98 M03 S500\nT0101\nG00 X{2 * points[0][1] - 8:.3f} Z4\n"
    start = f"G01 X{2 * points[0][1]:.3f} Z1 F100\n"
    tail = f"\nG40 G00 X{2 * greatest + 10:.3f} Z{back + 1:.3f}\nM30\n"
    body = "\n".join(blocks)
    description = job(nose, greatest, -back)
    region = [(0.0, 0.0), (0.0, points[0][1])] + points[1:]
    region += [(back, greatest + 50), (back - 50, greatest + 50), (back - 50, 0.0)]
    stock = Polygon([(0, 0), (0, greatest), (back - 80, greatest), (back - 80, 0)])
    window = (back + 2 * nose + 0.1, -2 * nose - 0.1)
    with tempfile.TemporaryDirectory() as folder:
        with_g42 = section(program, folder, "a", head + "G42 " + start + body + tail, description)
        without = section(program, folder, "b", head + start + body + tail, description)
    closed = as_region(grown(grown([region], nose), -nose))
    result = [None, None]
    if with_g42 is not None:
        result[0] = off(with_g42, closed.intersection(stock), window)
    if without is not None:
        # The nose's centre lies (r, r) beside the imaginary tip.
        centers = [(z + nose, x + nose) for z, x in points]
        swept = as_region(grown([centers], nose, pyclipper.ET_OPENROUND))
        above = Polygon(
            [(z + nose, x + nose) for z, x in points]
            + [(back + nose, greatest + 60), (60, greatest + 60), (60, points[0][1] + nose)]
        ).buffer(0)
        left = stock.difference(unary_union([swept, above]))
        result[1] = off(without, left, window)
    return seed, result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/gsk980td")
    parser.add_argument("--parts", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    seeds = range(arguments.seed, arguments.seed + arguments.parts)
    names = ("with G42, too deep", "with G42, left", "without, too deep", "without, left")
    columns = ([], [], [], [])
    refused = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for seed, result in pool.map(one, [(program, seed) for seed in seeds]):
            refused += result[0] is None
            for index, values in enumerate(result):
                for side, value in enumerate(values or []):
                    columns[2 * index + side].append((value, seed))
    for name, column in zip(names, columns):
        column.sort()
        median = column[len(column) // 2][0]
        print(f"{name}: {len(column)} parts, median {median:.6f} mm, worst", end=" ")
        print(", ".join(f"{value:.6f} (seed {seed})" for value, seed in column[-3:]))
    print(f"refused with G42: {refused}")


if __name__ == "__main__":
    main()
