#!/usr/bin/env python3
"""Corners (`,C` `,R`) beside arcs of Fanuc programs, against shapely.

    tests/oracles/ported_corners.py target/debug/gsk980td [--programs 200] [--seed 1]

This writes random chains of lines and arcs with a chamfer or a corner arc at their joints: arcs by
R or by I and K, ends absolute or as distances, codes written or modal. Each program is ported,
checked with --moves, and the path compared with a chain that is computed here from dense points:

  corner arc  its centre is where the curves at its radius beside both moves cross
  chamfer     the points of both moves at its length from the corner, straight

A corner that the porter refuses must not fit here either, or more than one arc must. Joints whose
corner ends within NARROW of the end of a move are not judged. Needs numpy and shapely.
"""

import argparse
import collections
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from shapely.geometry import LineString, Point
from shapely.ops import substring

TOLERANCE = 0.002  # mm, as for other ported programs
NARROW = 0.02  # mm
POINTS = 1500  # points of an arc


def arc_points(start, end, center, is_left):
    """Points (z, x) of an arc; x as a radius."""
    a, b = (math.atan2(*(p - center)[::-1]) for p in (start, end))
    if is_left and b <= a:
        b += 2 * math.pi
    if not is_left and b >= a:
        b -= 2 * math.pi
    angles = np.linspace(a, b, POINTS)
    radius = np.hypot(*(start - center))
    points = center + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points[0], points[-1] = start, end
    return points


def center_of(start, end, radius, is_left):
    chord = end - start
    half = np.hypot(*chord) / 2
    left = np.array([-chord[1], chord[0]]) / (2 * half)
    height = math.sqrt(max(radius**2 - half**2, 0.0))
    return (start + end) / 2 + left * (height if is_left else -height)


class Move:
    def __init__(self, start, end, code, radius=None):
        self.start, self.end, self.code, self.radius = start, end, code, radius
        if code == 1:
            self.center, points = None, [start, end]
        else:
            self.center = center_of(start, end, radius, code == 3)
            points = arc_points(start, end, self.center, code == 3)
        self.curve = LineString(points)


def random_chain(rng):
    place = np.array([0.0, rng.uniform(40.0, 60.0)])
    moves, corners = [], []
    for _ in range(rng.randint(3, 5)):
        angle = rng.uniform(-math.pi, math.pi)
        if rng.random() < 0.3:
            angle = rng.choice([math.pi, math.pi / 2, -math.pi / 2])
        end = place + rng.uniform(4.0, 15.0) * np.array([math.cos(angle), math.sin(angle)])
        end = np.round(end, 3)
        end[1] = round(float(end[1]) * 2, 3) / 2
        code = rng.choice([1, 2, 3, 3])
        radius = None
        if code > 1:
            radius = round(np.hypot(*(end - place)) / 2 * rng.uniform(1.02, 2.5), 3)
        moves.append(Move(place, end, code, radius))
        corners.append((rng.choice(["C", "R", "R", None]), round(rng.uniform(0.2, 2.5), 3)))
        place = end
    corners[-1] = (None, 0.0)
    # The corner between two lines has its own comparison.
    for index, (one, two) in enumerate(zip(moves, moves[1:])):
        if one.code == two.code == 1:
            corners[index] = (None, 0.0)
    return moves, corners


def program_text(rng, moves, corners):
    z, x = moves[0].start
    lines = ["O0001", "G50 X200. Z100.", "M03 S500", f"G98 G00 X{2 * x:.3f} Z{z:.3f}"]
    modal = None
    for move, (kind, size) in zip(moves, corners):
        words = [f"G0{move.code}"]
        if move.code == modal and rng.random() < 0.5:
            words = []
        modal = move.code
        (z0, x0), (z1, x1) = move.start, move.end
        for letter, other, value, step in (("X", "U", 2 * x1, 2 * (x1 - x0)), ("Z", "W", z1, z1 - z0)):
            if rng.random() < 0.3:
                words.append(f"{other}{step:.3f}")
            elif abs(step) > 1e-9 or rng.random() < 0.5:
                words.append(f"{letter}{value:.3f}")
        if move.code > 1:
            if rng.random() < 0.5:
                words.append(f"R{move.radius:.3f}")
            else:
                k, i = move.center - move.start
                words += [f"I{i:.6f}", f"K{k:.6f}"]
        if kind:
            words.append(f",{kind}{size:.3f}")
        if move is moves[0]:
            words.append("F100.")
        lines.append(" ".join(words))
    return "\n".join([*lines, "M30", ""])


def points_of(geometry):
    parts = getattr(geometry, "geoms", [geometry])
    return [part for part in parts if part.geom_type == "Point"]


def corner_points(one, taken, two, kind, size):
    """Distances on both moves and the piece between them; a text if that is not certain."""
    joint = one.end
    a = np.diff(one.curve.coords[-2:], axis=0)[0]
    b = np.diff(two.curve.coords[:2], axis=0)[0]
    turn = (a[0] * b[1] - a[1] * b[0]) / np.hypot(*a) / np.hypot(*b)
    if abs(turn) < 0.02:
        return "narrow"
    if kind == "C":
        circle = LineString(arc_points(joint + [size, 0.0], joint + [size, -1e-9], joint, True))
        before = [one.curve.project(p) for p in points_of(one.curve.intersection(circle))]
        after = [two.curve.project(p) for p in points_of(two.curve.intersection(circle))]
        if not before or not after:
            return "does not fit"
        found = [(max(before), min(after), None)]
    else:
        side = size if turn > 0 else -size
        curves = [move.curve.offset_curve(side, join_style="round") for move in (one, two)]
        found = []
        for center in points_of(curves[0].intersection(curves[1])):
            before, after = one.curve.project(center), two.curve.project(center)
            touches = [
                abs(curve.interpolate(at).distance(center) - size) < 1e-3
                for curve, at in ((one.curve, before), (two.curve, after))
            ]
            center = np.array(center.coords[0])
            ends = (np.array(c.interpolate(at).coords[0]) - center
                    for c, at in ((one.curve, before), (two.curve, after)))
            first, last = (math.atan2(*end[::-1]) for end in ends)
            swept = (last - first if turn > 0 else first - last) % (2 * math.pi)
            # A corner arc is less than half a turn.
            if all(touches) and swept < math.pi:
                found.append((before, after, center))
    ends = [
        min(before - taken, one.curve.length - before, after, two.curve.length - after)
        for before, after, _ in found
    ]
    if any(abs(end) < NARROW for end in ends):
        return "narrow"
    fitting = [it for it, end in zip(found, ends) if end > 0]
    if len(fitting) != 1:
        return "does not fit" if not fitting else "more than one"
    before, after, center = fitting[0]
    from_point = np.array(one.curve.interpolate(before).coords[0])
    to_point = np.array(two.curve.interpolate(after).coords[0])
    piece = [from_point, to_point]
    if center is not None:
        piece = arc_points(from_point, to_point, center, turn > 0)
    return before, after, piece


def expected_path(moves, corners):
    """The path as points, or the index of the first corner without one and why."""
    path, taken = [], 0.0
    for index, move in enumerate(moves):
        kind, size = corners[index]
        if kind is None:
            path += substring(move.curve, taken, move.curve.length).coords
            taken = 0.0
            continue
        found = corner_points(move, taken, moves[index + 1], kind, size)
        if isinstance(found, str):
            return index, found
        path += substring(move.curve, taken, found[0]).coords
        path += [tuple(point) for point in found[2]]
        taken = found[1]
    return path


def made_path(program, path):
    call = [program, "check", str(path), "--moves", "-"]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    rows = [json.loads(row) for row in done.stdout.splitlines() if row.startswith("{")]
    points = []
    for row in rows:
        if row["kind"] not in ("feed", "cw", "ccw"):
            continue
        start = np.array([row["z0"], row["x0"] / 2])
        end = np.array([row["z"], row["x"] / 2])
        if row["kind"] == "feed":
            points += [start, end]
        else:
            center = np.array([row["cz"], row["cx"] / 2])
            points += list(arc_points(start, end, center, row["kind"] == "ccw"))
    return points, done.stdout + done.stderr


def examine(program, rng, folder):
    moves, corners = random_chain(rng)
    text = program_text(rng, moves, corners)
    foreign, ported = Path(folder) / "foreign.nc", Path(folder) / "ported.nc"
    foreign.write_text(text)
    ported.unlink(missing_ok=True)
    call = [program, "dialect", "--from", "fanuc0t", str(foreign), "-o", str(ported)]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    made = ported.read_text() if ported.exists() else ""
    expected = expected_path(moves, corners)
    if isinstance(expected, tuple):
        index, why = expected
        if why == "narrow":
            return "narrow", 0.0
        assert "H99" in made, f"{why} at move {index + 1}\n{text}\n{made}\n{done.stdout}"
        return "refused: " + why, 0.0
    assert made and "H99" not in made, f"refused\n{text}\n{made}\n{done.stdout}"
    points, answer = made_path(program, ported)
    assert len(points) > 1, f"{text}\n{made}\n{answer}"
    far = LineString(points).hausdorff_distance(LineString(expected))
    assert far < TOLERANCE, f"{far:.4f} mm\n{text}\n{made}\n{answer}"
    corner_count = sum(kind is not None for kind, _ in corners)
    return f"{corner_count} corners", far


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--programs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    counts, worst = collections.Counter(), 0.0
    with tempfile.TemporaryDirectory() as folder:
        for index in range(arguments.programs):
            rng = random.Random(arguments.seed * 1_000_003 + index)
            kind, far = examine(arguments.program, rng, folder)
            counts[kind] += 1
            worst = max(worst, far)
    print(f"{arguments.programs} programs, farthest {worst:.5f} mm:", dict(counts))


if __name__ == "__main__":
    main()
