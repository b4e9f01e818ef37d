#!/usr/bin/env python3
"""Outlines of random DXF drawings, against the outlines that were drawn.

Draws half and full profiles with `ezdxf`: lines, arcs, light and old polylines with bulges,
in random order and direction, in millimetres or inches, beside annotations and other layers.
For each drawing:

  outline --json   the pieces are those drawn, within 0.001 mm
  check --part     the half section that the program with G71 and G70 leaves (an insert with
                   a nose of 0) is that of the outline, by shapely, within 0.002 mm

    python3 tests/oracles/drawn_outlines.py --program target/debug/gsk980td --drawings 500
"""

import argparse
import collections
import csv
import json
import math
import os
import random
import subprocess
import tempfile

import ezdxf
from shapely.geometry import Point, Polygon, box

JOB = """(
    stock: (form: Bar(diameter: {stock}), face: 1, length: {length}, overhang: {overhang}),
    tools: {{ 1: (insert: Turning(letter: V, entering: 93, size: 40, nose: 0), tip: 3) }},
)
"""


def random_outline(rng):
    """Pieces (start, end, bulge) as (z, radius), X growing and Z falling."""
    at, pieces, last = (0.0, 0.0), [], None
    for index in range(rng.randint(3, 16)):
        forms = ["along", "cone", "quarter", "arc"] + (["face"] if last != "face" else [])
        form = "face" if index == 0 else rng.choice([it for it in forms if it != last])
        rise, run = rng.uniform(0.2, 5), rng.uniform(0.3, 15)
        if form == "face":
            step = (0, rise)
        elif form == "along":
            step = (-run, 0)
        elif form == "quarter":
            radius = rng.uniform(0.3, 5)
            step = (-radius, radius)
        else:
            step = (-run, rise)
        angle = math.atan2(step[1], -step[0])
        room = min(angle, math.pi / 2 - angle)
        share = {"quarter": 1, "arc": rng.uniform(0.05, 0.98)}.get(form, 0)
        bulge = math.tan(room * share / 2) * rng.choice([1, -1])
        end = (at[0] + step[0], at[1] + step[1])
        pieces.append((at, end, bulge if share else 0.0))
        at, last = end, form
    return pieces


def points_of(piece, count=64):
    (z0, x0), (z1, x1), bulge = piece
    if not bulge:
        return [(z0, x0), (z1, x1)]
    height = (1 - bulge * bulge) / (4 * bulge)
    cz = (z0 + z1) / 2 - (x1 - x0) * height
    cx = (x0 + x1) / 2 + (z1 - z0) * height
    radius = math.hypot(z0 - cz, x0 - cx)
    begin, sweep = math.atan2(x0 - cx, z0 - cz), 4 * math.atan(bulge)
    angles = [begin + sweep * i / count for i in range(count + 1)]
    return [(cz + radius * math.cos(a), cx + radius * math.sin(a)) for a in angles]


def mirrored(piece):
    (z0, x0), (z1, x1), bulge = piece
    return (z0, -x0), (z1, -x1), -bulge


def draw(rng, pieces, path):
    """Writes the drawing; returns the options of the command."""
    unit = rng.choice([(4, 1.0), (4, 1.0), (1, 25.4)])
    version = rng.choice(["R12", "R2000", "R2010", "R2018"])
    document = ezdxf.new(version)
    if version == "R12":
        unit = (0, 1.0)
    else:
        document.header["$INSUNITS"] = unit[0]
    space = document.modelspace()
    scale = 1 / unit[1]
    layer = rng.choice(["0", "OUTLINE", "轮廓"])
    if layer != "0":
        document.layers.add(layer)
    attributes = {"layer": layer}
    is_full = rng.random() < 0.4
    jobs = []
    rest = pieces
    while rest:
        take = rng.randint(1, len(rest))
        jobs.append(rest[:take])
        rest = rest[take:]
    if is_full:
        jobs += [[mirrored(piece) for piece in group] for group in jobs]
        (z, x) = pieces[-1][1]
        jobs.append([((z, x), (z, -x), 0.0)])
    elif rng.random() < 0.5:
        (z, x) = pieces[-1][1]
        jobs.append([((z, x), (z, 0), 0.0), ((z, 0), (0, 0), 0.0)])
    rng.shuffle(jobs)
    for group in jobs:
        scaled = [((a[0] * scale, a[1] * scale), (b[0] * scale, b[1] * scale), k) for a, b, k in group]
        kind = rng.choice(["single", "light", "old"])
        if kind == "single" or (kind == "light" and version == "R12"):
            for a, b, bulge in scaled:
                if not bulge:
                    ends = (a, b) if rng.random() < 0.5 else (b, a)
                    space.add_line(*ends, dxfattribs=attributes)
                else:
                    center, begin, end, radius = ezdxf.math.bulge_to_arc(a, b, bulge)
                    space.add_arc(center, radius, math.degrees(begin), math.degrees(end), dxfattribs=attributes)
            continue
        corners = [(*a, bulge) for a, _, bulge in scaled] + [(*scaled[-1][1], 0)]
        if kind == "light":
            space.add_lwpolyline(corners, format="xyb", dxfattribs=attributes)
        else:
            space.add_polyline2d(corners, format="xyb", dxfattribs=attributes)
    space.add_text("DIA", dxfattribs=attributes)
    options = []
    if rng.random() < 0.4:
        document.layers.add("FRAME")
        space.add_line((-500, 80), (100, 85), dxfattribs={"layer": "FRAME"})
        options = ["--layer", layer]
    document.saveas(path)
    return options


def compare_pieces(pieces, found):
    """The greatest distance of points of the drawn pieces from those found."""
    if len(found) != len(pieces):
        return math.inf
    worst = 0.0
    for drawn, got in zip(pieces, found):
        other = ((got["from"][1], got["from"][0] / 2), (got["to"][1], got["to"][0] / 2), got["bulge"])
        for a, b in zip(points_of(drawn), points_of(other)):
            worst = max(worst, math.dist(a, b))
    return worst


def section_of(path):
    polygons = collections.defaultdict(list)
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            polygons[row["polygon"]].append((float(row["z"]), float(row["x"]) / 2))
    return max((Polygon(points).buffer(0) for points in polygons.values()), key=lambda it: it.area)


def greatest_distance(wanted, left, least_z):
    """The greatest distance of corners of one boundary from the other one; not at the left end."""
    pairs = [(wanted.exterior, left.exterior), (left.exterior, wanted.exterior)]
    return max(other.distance(Point(at)) for one, other in pairs for at in one.coords if at[0] > least_z)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="target/debug/gsk980td")
    parser.add_argument("--drawings", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    faults, worst_piece, worst_cut, cut_count = 0, 0.0, 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(args.drawings):
            rng = random.Random(args.seed * 1_000_003 + number)
            pieces = random_outline(rng)
            file = os.path.join(folder, "part.dxf")
            options = draw(rng, pieces, file)
            stock = math.ceil(2 * max(b[1] for _, b, _ in pieces) + 2)
            command = [args.program, "outline", file, "--json", "--stock", str(stock), *options]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                print(f"{number}: exit {done.returncode}: {done.stderr.strip()} {done.stdout[:200]}")
                faults += 1
                continue
            report = json.loads(done.stdout)
            distance = compare_pieces(pieces, report["outline"])
            worst_piece = max(worst_piece, distance)
            program, job, section = (os.path.join(folder, it) for it in ["part.CNC", "part.job.ron", "part.csv"])
            with open(program, "w", encoding="utf-8") as out:
                out.write(report["text"])
            length = -pieces[-1][1][0]
            with open(job, "w", encoding="utf-8") as out:
                out.write(JOB.format(stock=stock, length=length + 80, overhang=length + 40))
            command = [args.program, "check", program, "--section", section, "--json"]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                print(f"{number}: check: exit {done.returncode}: {done.stdout[:600]} {done.stderr[:300]}")
                faults += 1
                continue
            points = [pieces[0][0]] + [p for piece in pieces for p in points_of(piece, 400)[1:]]
            wanted = Polygon(points + [(-length, 0)]).buffer(0)
            # Only what the outline reaches, without its left end, where the blank begins.
            reach = box(-length + 0.01, -1, 100, 1000)
            wanted, left = wanted.intersection(reach), section_of(section).intersection(reach)
            if left.geom_type != "Polygon":
                left = max(left.geoms, key=lambda it: it.area)
            cut = greatest_distance(wanted, left, -length + 0.05)
            worst_cut, cut_count = max(worst_cut, cut), cut_count + 1
            if distance > 0.001 or cut > 0.002:
                print(f"{number}: outline {distance:.6f} mm, cut part {cut:.6f} mm")
                faults += 1
    print(f"{args.drawings} drawings, {cut_count} parts cut, {faults} faults; "
          f"outline within {worst_piece:.6f} mm, cut part within {worst_cut:.6f} mm")
    return 1 if faults else 0


if __name__ == "__main__":
    raise SystemExit(main())
