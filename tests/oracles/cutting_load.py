#!/usr/bin/env python3
"""Chip area and edge length of `check --load-csv`, against shapely.

This makes random parts: a bar or tube, a turning or a grooving insert or a boring bar, and passes
(cylinders, tapers, arcs, faces, grooves, bores, parting off). Each program is checked with --moves and --load-csv. The script
builds the insert from its catalogue dimensions, follows the moves through the bar, and computes
at each row of the file

  area    feed times the area that a short piece of the path around the row removes, by its length
  edge    length of the edge of the insert that faces the feed and is in the material
  push    the shares of the cutting force against the feed and across the axis: half of it, at
          right angles to each piece of that edge
  size    the change of the diameter, from the sections of the bar between jaws and tip, and from
          the boring bar

Needs numpy and shapely.

    python3 tests/oracles/cutting_load.py --program target/debug/gsk980td --parts 50
"""

import argparse
import csv
import json
import math
import os
import random
import subprocess
import tempfile

import numpy as np
from shapely.affinity import scale, translate
from shapely.geometry import LineString, MultiPoint, Point, box

AREA_TOLERANCE = 0.01  # of the area, with at least AREA_LEAST
AREA_LEAST = 0.002  # mm²
EDGE_TOLERANCE = 0.01
EDGE_LEAST = 0.04  # mm: a chord of the nose in the program
PUSH_TOLERANCE = 0.01  # of the cutting force, with at least PUSH_LEAST
PUSH_LEAST = 0.05  # N: the file has two decimals
SIZE_TOLERANCE = 0.02  # of the change, with at least SIZE_LEAST
SIZE_LEAST = 0.000_02  # mm
PRESSING = 0.5  # share of the cutting force at right angles to the edge
MODULUS = 210_000.0  # N/mm²
BORE = 30.0  # diameter of the tubes, mm
KINDS = ("turn", "turn", "turn", "groove", "part", "bore", "bore")
JAWS = -80.0
SECTIONS = 100
PIECE = 0.002  # half length of a piece of path, mm
NAMES = ("area", "edge", "feed force", "radial force", "size")
CORNERS = {"C": 80.0, "D": 55.0, "V": 35.0, "W": 80.0, "T": 60.0, "S": 90.0}


def edge_length(letter, size):
    if letter == "T":
        return size * math.sqrt(3.0)
    if letter == "W":
        return size * 0.684
    if letter == "S":
        return size
    return size / math.sin(math.radians(CORNERS[letter]))


def turning_insert(letter, entering, size, nose):
    """Points of the cutting part, tip 3, relative to the imaginary tip: (z, x)."""
    corner = CORNERS[letter]
    main, second = 180.0 - entering, 180.0 - entering - corner
    direction = lambda degrees: np.array(
        [math.cos(math.radians(degrees)), math.sin(math.radians(degrees))]
    )
    center = np.array([nose, nose])
    tip = center - direction((main + second) / 2) * nose / math.sin(math.radians(corner / 2))
    length = edge_length(letter, size) * 0.95
    angles = np.radians(np.linspace(main + 90.0, second + 270.0, 400))
    arc = center + nose * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ends = [tip + direction(main) * length, tip + direction(second) * length]
    return MultiPoint([*arc, *ends]).convex_hull


def grooving_insert(width, nose):
    points = []
    for z, begin in ((nose, 180.0), (width - nose, 270.0)):
        angles = np.radians(np.linspace(begin, begin + 90.0, 100))
        points += [(z + nose * math.cos(a), nose + nose * math.sin(a)) for a in angles]
    top = max(width, 2.0) * 1.5
    return MultiPoint([*points, (0.0, top), (width, top)]).convex_hull


def random_job(rng, kind):
    """Text of the insert in the job file, and its polygon."""
    if kind in ("groove", "part"):
        width = rng.choice([2.0, 3.0, 4.0])
        text = f"Grooving(width: {width}, nose: 0.2, reach: 40)"
        return text, grooving_insert(width, 0.2)
    letter = rng.choice("CDVWTS")
    nose = rng.choice([0.4, 0.8, 1.2])
    entering = {"C": 95.0, "D": 93.0, "V": 93.0, "W": 95.0, "T": 91.0, "S": 75.0}[letter]
    size = {"C": 12.7, "D": 12.7, "V": 9.525, "W": 12.7, "T": 12.7, "S": 12.7}[letter]
    text = f"Turning(letter: {letter}, entering: {entering}, size: {size}, nose: {nose})"
    insert = turning_insert(letter, entering, size, nose)
    # The body of a boring bar is towards the axis.
    return text, scale(insert, 1.0, -1.0, origin=(0, 0)) if kind == "bore" else insert


def random_program(rng, kind):
    diameter = rng.choice([40.0, 50.0, 60.0])
    feed = rng.choice([0.1, 0.15, 0.2, 0.3])
    lines = ["G50 X150 Z100", "G99 G97 S600 M03", "T0101"]
    x = diameter
    if kind == "bore":
        x = BORE
        for _ in range(3):
            x += 2 * rng.uniform(0.3, 1.5)
            end = -rng.uniform(15, 45)
            lines += [f"G00 X{x:.3f} Z2", f"G01 Z{end:.3f} F{feed}"]
            last = rng.choice(["taper", "arc", "face"])
            radius = rng.uniform(2.0, 5.0)
            if last == "taper":
                lines += [f"X{x - 3:.3f} Z{end - rng.uniform(1, 4):.3f}"]
            elif last == "arc":
                lines += [f"G03 X{x - 2 * radius:.3f} Z{end - radius:.3f} R{radius:.3f}"]
            lines += [f"G01 X{BORE - 2:.3f}", "G00 Z2"]
    elif kind == "part":
        z = -rng.uniform(8, 40)
        lines += [f"G00 X{diameter + 2:.3f} Z{z:.3f}", f"G01 X0 F{feed}"]
        lines += [f"G00 X{diameter + 2:.3f}"]
    elif kind == "groove":
        for _ in range(3):
            z = -rng.uniform(8, 40)
            depth = rng.uniform(2, 12)
            lines += [f"G00 X{diameter + 2:.3f} Z{z:.3f}", f"G01 X{diameter - depth:.3f} F{feed}"]
            lines += [f"G00 X{diameter + 2:.3f}"]
    else:
        for _ in range(4):
            x -= 2 * rng.uniform(0.3, 2.0)
            end = -rng.uniform(15, 45)
            lines += [f"G00 X{x:.3f} Z2", f"G01 Z{end:.3f} F{feed}"]
            kind = rng.choice(["taper", "arc", "face"])
            radius = rng.uniform(2.0, 5.0)
            if kind == "taper":
                lines += [f"X{x + 3:.3f} Z{end - rng.uniform(1, 4):.3f}"]
            elif kind == "arc":
                lines += [f"G02 X{x + 2 * radius:.3f} Z{end - radius:.3f} R{radius:.3f}"]
            lines += [f"G01 X{diameter + 2:.3f}", "G00 Z2"]
        lines += ["Z-1", "G01 X0 F0.1"]
    lines += ["G00 X150 Z100", "T0100", "M30"]
    return diameter, "\n".join(lines) + "\n"


def path_of(move):
    """Points (z, x) of a move, x as a radius, finely divided."""
    a = np.array([move["z0"], move["x0"] / 2])
    b = np.array([move["z"], move["x"] / 2])
    if move["kind"] in ("cw", "ccw"):
        center = np.array([move["cz"], move["cx"] / 2])
        begin, end = (math.atan2(*(p - center)[::-1]) for p in (a, b))
        if move["kind"] == "cw" and end > begin:
            end -= 2 * math.pi
        if move["kind"] == "ccw" and end < begin:
            end += 2 * math.pi
        angles = np.linspace(begin, end, 400)
        radius = np.hypot(*(a - center))
        return center + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.array([a, b])


def along(path, distance):
    lengths = np.hypot(*np.diff(path, axis=0).T)
    total = np.concatenate([[0.0], np.cumsum(lengths)])
    distance = min(max(distance, 0.0), total[-1])
    return np.array([np.interp(distance, total, path[:, k]) for k in (0, 1)])


def swept(insert, path):
    positions = [translate(insert, *point) for point in path]
    area = positions[0]
    for one, two in zip(positions, positions[1:]):
        area = area.union(one.union(two).convex_hull)
    return area


def facing_edge(insert, feed):
    """The edges whose outside faces the feed, as lines with their outward directions."""
    ring = list(insert.exterior.coords)
    if not insert.exterior.is_ccw:
        ring.reverse()
    lines = []
    for (za, xa), (zb, xb) in zip(ring, ring[1:]):
        edge = np.array([zb - za, xb - xa])
        outside = np.array([edge[1], -edge[0]])
        if outside @ feed > 1e-9 * np.hypot(*edge):
            outward = outside / np.hypot(*edge)
            lines.append((LineString([(za, xa), (zb, xb)]), outward))
    return lines


def flexibility(part, z):
    """How far the bar gives way at z for each newton, mm."""
    length = min(z, 0.0) - JAWS
    step = length / SECTIONS
    total = 0.0
    for at in (np.arange(SECTIONS) + 0.5) * step:
        line = LineString([(JAWS + at, 0.0), (JAWS + at, 100.0)]).intersection(part)
        pieces = getattr(line, "geoms", [line])
        rings = [piece.bounds for piece in pieces if piece.length > 0]
        inertia = math.pi / 4 * sum(top**4 - low**4 for _, low, _, top in rings)
        total += (length - at) ** 2 * step / (MODULUS * inertia) if inertia > 0 else 0.0
    return total


def compare(program, rng, folder, kind, worst):
    insert_text, insert = random_job(rng, kind)
    diameter, text = random_program(rng, kind)
    form, tip, holder, bar = f"Bar(diameter: {diameter})", 3, "None", 0.0
    bore = 0.0
    if kind == "bore":
        bar, length = rng.choice([10.0, 12.0, 16.0]), rng.uniform(50.0, 80.0)
        form, tip, bore = f"Tube(diameter: {diameter}, bore: {BORE})", 2, BORE / 2
        holder = f"Bar(diameter: {bar}, length: {length:.3f})"
        bar = length**3 / (3.0 * MODULUS * math.pi * bar**4 / 64.0)
    name = os.path.join(folder, "part.CNC")
    with open(name, "w", encoding="utf-8") as file:
        file.write(text)
    job = (
        f"(stock: (form: {form}, length: 120, overhang: 80),\n"
        f" tools: {{ 1: (insert: {insert_text}, tip: {tip}, holder: {holder}) }})\n"
    )
    with open(os.path.join(folder, "part.job.ron"), "w", encoding="utf-8") as file:
        file.write(job)
    moves, loads = os.path.join(folder, "moves"), os.path.join(folder, "loads")
    command = [program, "check", name, "--moves", moves, "--load-csv", loads, "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert os.path.exists(loads), done.stderr
    with open(loads, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    part = box(-80.0, bore, 0.0, diameter / 2)
    compared = 0
    with open(moves, encoding="utf-8") as file:
        for move in map(json.loads, file):
            path = path_of(move)
            if move["kind"] == "rapid":
                continue
            end = move["t"] + move["dt"]
            length = np.hypot(*np.diff(path, axis=0).T).sum()
            for row in rows:
                t = float(row["t"])
                if int(row["line"]) != move["line"] or not move["t"] <= t <= end or length == 0:
                    continue
                at = (t - move["t"]) / move["dt"] * length
                around = [along(path, at + k * PIECE) for k in (-1, 0, 1)]
                # The part without what the move has removed until the piece.
                done_path = [path[0], *(along(path, (at - PIECE) * k / 40) for k in range(1, 40)), around[0]]
                rest = part.difference(swept(insert, done_path)) if len(path) > 2 else part
                piece = rest.intersection(swept(insert, around[::2]))
                if len(path) <= 2:
                    piece = piece.difference(swept(insert, [path[0], around[0]]))
                span = np.hypot(*(around[2] - around[0]))
                area = piece.area / span * move["feed"]
                feed = (around[2] - around[0]) / span
                contacts = [
                    (translate(line, *around[1]).intersection(rest).length, outward)
                    for line, outward in facing_edge(insert, feed)
                ]
                edge = sum(length for length, _ in contacts)
                across = sum(length * (outward @ feed) for length, outward in contacts)
                push = sum(length * (outward @ feed) * outward for length, outward in contacts)
                push = PRESSING * push / across if across > 0 else np.zeros(2)
                force, radial = float(row["force_n"]), float(row["radial_force_n"])
                least = max(PUSH_TOLERANCE * force, PUSH_LEAST)
                size = 2 * radial * (flexibility(part, around[1][0]) + bar)
                size_error = abs(float(row["size_error_mm"]) - size)
                errors = (
                    abs(float(row["area_mm2"]) - area) / max(AREA_TOLERANCE * area, AREA_LEAST),
                    abs(float(row["edge_mm"]) - edge) / max(EDGE_TOLERANCE * edge, EDGE_LEAST),
                    abs(float(row["feed_force_n"]) - push @ feed * force) / least,
                    abs(radial + push[1] * force) / least,
                    size_error / max(SIZE_TOLERANCE * abs(size), SIZE_LEAST),
                )
                for index, error in enumerate(errors):
                    if error > worst[index][0]:
                        worst[index] = (error, row, area, edge, text, insert_text)
                compared += 1
            part = part.difference(swept(insert, path))
    return compared


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="target/debug/gsk980td")
    parser.add_argument("--parts", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    worst = [(0.0,)] * len(NAMES)
    chips = dict.fromkeys(KINDS, 0)
    for index in range(arguments.parts):
        kind = KINDS[index % len(KINDS)]
        with tempfile.TemporaryDirectory() as folder:
            chips[kind] += compare(arguments.program, rng, folder, kind, worst)
    print(f"{arguments.parts} parts, {sum(chips.values())} chips:", chips)
    for name, value in zip(NAMES, worst):
        print(f"{name}: worst {value[0]:.3f} of the tolerance", *value[1:4])
    if 0 in chips.values() or any(value[0] > 1.0 for value in worst):
        for value in worst:
            print(*value[4:], sep="\n")
        raise SystemExit("differs")


if __name__ == "__main__":
    main()
