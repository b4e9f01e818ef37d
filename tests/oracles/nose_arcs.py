#!/usr/bin/env python3
"""Nose compensation along tangent contours whose arcs are written with I, K.

A CAM system writes end points and centres rounded: to 0.001 mm, or coarser. This
makes random tangent contours of lines and arcs, runs the program's `check --moves`
on each, once with I, K and once with R, and measures with shapely

  refused  what runs with R and raises an alarm with I, K (048, the end beside the
           circle by more than 0.010 mm, and 013, the ends farther apart than twice
           the radius, are the arc's own limits and count apart)
  gouge    how far the nose circle comes into the programmed contour, mm
  left     how far it stays away from a point of the contour, mm

The contour of an arc is what the control makes of I, K: within 0.002 mm the radius
about the rounded centre changes evenly to that of the end, beyond that the radius is
kept and the centre moves. Needs numpy and shapely.

    python3 tests/oracles/nose_arcs.py --program target/release/gsk980td
"""

import argparse
import concurrent.futures
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import numpy as np
import shapely

FIT = 0.002  # mm, the greatest change of radius on an arc
LEAST_TURN = 0.002  # rad between two points of an arc that is looked at


def rounded(value, step):
    return round(value / step) * step


class Contour:
    """A tangent contour toward the chuck: pieces (end, centre or None, clockwise)."""

    def __init__(self, rng, grid):
        self.nose = rng.choice([0.2, 0.4, 0.8, 1.2])
        self.bore = rng.random() < 0.3
        z, x, heading = 2.0, 15.0, 0.0
        self.start = self.place(z, x)
        self.pieces = []
        for index in range(rng.randint(3, 9)):
            if index % 2 == 0 or rng.random() < 0.15:
                length = rng.uniform(0.1, 8.0)
                z -= length * math.cos(heading)
                x += length * math.sin(heading)
                self.pieces.append((self.place(z, x), None, None))
                continue
            to = rng.uniform(-1.3, 1.3)
            turn = to - heading
            if abs(turn) < 0.02:
                continue
            clockwise = turn > 0  # toward the nose: an inner arc
            radius = math.exp(rng.uniform(math.log(0.2), math.log(40.0)))
            if clockwise:
                # As large as the nose, too, unless rounding takes more than that.
                fillet = self.nose if grid <= 0.001 else self.nose + 0.1
                radius = rng.choice([fillet, self.nose + radius])
            # Rounded more, a short arc is another contour.
            if grid > 0.001 and radius * abs(turn) < 100 * grid:
                continue
            side = 1.0 if clockwise else -1.0
            centre = (
                z + side * radius * math.sin(heading),
                x + side * radius * math.cos(heading),
            )
            before = self.pieces[-1][0] if self.pieces else self.start
            z = centre[0] - side * radius * math.sin(to)
            x = centre[1] - side * radius * math.cos(to)
            heading = to
            about = self.place(*centre)
            about = tuple(
                rounded(before[axis] + rounded(about[axis] - before[axis], grid), 0.0005)
                for axis in (0, 1)
            )
            self.pieces.append(
                (self.place(z, x), about, clockwise != self.bore, rounded(radius, 0.001))
            )

        z, x = z - 6.0 * math.cos(heading), x + 6.0 * math.sin(heading)
        self.pieces.append((self.place(z, x), None, None))

    def place(self, z, x):
        """A point (z, x) on the grid of the axes; a bore is mirrored."""
        return rounded(z, 0.001), rounded(60.0 - x if self.bore else x, 0.0005)

    def text(self, with_r):
        away = -1.0 if self.bore else 1.0
        z, x = self.start
        lines = [
            "O0001",
            "T0101",
            f"G00 X{2 * (x + away * 8.0):.3f} Z{z + 8.0:.3f}",
            f"{'G41' if self.bore else 'G42'} G01 X{2 * x:.3f} Z{z + 5.0:.3f} F200",
            f"Z{z:.3f}",
        ]
        for end, centre, clockwise, *radius in self.pieces:
            if centre is None:
                lines.append(f"G01 X{2 * end[1]:.3f} Z{end[0]:.3f}")
            else:
                code = "G02" if clockwise else "G03"
                about = (
                    f"R{radius[0]:.3f}"
                    if with_r
                    else f"I{centre[1] - x:.3f} K{centre[0] - z:.3f}"
                )
                lines.append(f"{code} X{2 * end[1]:.3f} Z{end[0]:.3f} {about}")
            z, x = end
        lines.append(f"G40 G00 X{2 * (x + away * 30.0):.3f} Z{z - 2 * self.nose:.3f}")
        lines.append("M30")
        return "\n".join(lines) + "\n"

    def surface(self):
        """Points (z, x) along the programmed contour, with the line that leads to it."""
        z, x = self.start
        points = [(z + 5.0, x), (z, x)]
        for end, centre, clockwise, *_ in self.pieces:
            if centre is not None:
                centre = kept(points[-1], end, centre)
                points.extend(arc(points[-1], end, centre, clockwise))
            points.append(end)
        return np.array(points)

    def to_centre(self):
        """From the imaginary tip to the centre of the nose."""
        return self.nose, -self.nose if self.bore else self.nose


def kept(start, end, centre):
    """The centre that the control takes for the programmed one."""
    radius = math.dist(start, centre)
    if abs(math.dist(end, centre) - radius) <= FIT:
        return centre
    chord = math.dist(start, end)
    square = radius * radius - chord * chord / 4
    if square < 0:
        return centre
    height = math.sqrt(square) / chord
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    across = (start[1] - end[1]) * height, (end[0] - start[0]) * height
    sides = [(middle[0] + side * across[0], middle[1] + side * across[1]) for side in (1, -1)]
    return min(sides, key=lambda side: math.dist(side, centre))


def arc(start, end, centre, clockwise):
    """Points on the way from start to end, the radius changing evenly."""
    first = np.subtract(start, centre)
    last = np.subtract(end, centre)
    angle = math.atan2(first[1], first[0])
    turn = math.atan2(last[1], last[0]) - angle
    turn = turn % math.tau
    if clockwise:
        turn -= math.tau if turn > 0 else 0
    radii = np.hypot(*first), np.hypot(*last)
    count = max(2, math.ceil(abs(turn) / LEAST_TURN))
    part = np.arange(1, count) / count
    radius = radii[0] + (radii[1] - radii[0]) * part
    at = angle + turn * part
    return np.column_stack((centre[0] + radius * np.cos(at), centre[1] + radius * np.sin(at)))


def check(program, contour, text, folder, name):
    """The moves of a program, or the number and line of its alarm."""
    path = os.path.join(folder, name + ".CNC")
    moves = os.path.join(folder, name + ".ndjson")
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    nose = f"01=0,0,{contour.nose},{2 if contour.bore else 3}"
    done = subprocess.run(
        [program, "check", path, "--json", "--param", "2.1=1", "--offset", nose]
        + ["--moves", moves],
        capture_output=True,
        text=True,
        check=False,
    )
    report = json.loads(done.stdout)
    if report["alarm"]:
        return None, (report["alarm"]["number"], report["alarm"]["line"])
    with open(moves, encoding="ascii") as file:
        return [json.loads(line) for line in file], None


def centre_path(contour, moves):
    """Points of the nose centre, from the first compensated line to the last."""
    dz, dx = contour.to_centre()
    last = 5 + len(contour.pieces)
    points = []
    for move in moves:
        if not 5 <= move["line"] <= last:
            continue
        start, end = (move["z0"], move["x0"] / 2), (move["z"], move["x"] / 2)
        points.append(start)
        if move["cx"] is not None:
            centre = (move["cz"], move["cx"] / 2)
            points.extend(arc(start, end, centre, move["kind"] == "cw"))
        points.append(end)
    return np.array(points) + (dz, dx)


def measure(contour, moves):
    """How deep the nose cuts in, and how far it stays away."""
    surface = contour.surface()
    path = shapely.LineString(centre_path(contour, moves))
    beyond = 500.0 if contour.bore else -500.0
    ends = [(surface[-1][0], beyond), (surface[0][0], beyond)]
    part = shapely.Polygon(np.vstack((surface, ends)))
    if not part.is_valid:
        return None
    gouge = contour.nose - part.distance(path)
    # The first and last line belong to approach and retreat.
    inner = surface[1:-1]
    left = shapely.distance(shapely.points(inner), path).max() - contour.nose
    return gouge, left


def one(job):
    program, seed, grid, folder = job
    contour = Contour(random.Random(seed), grid)
    with_r, _ = check(program, contour, contour.text(True), folder, f"r{seed}")
    text = contour.text(False)
    moves, alarm = check(program, contour, text, folder, f"i{seed}")
    measured = measure(contour, moves) if moves is not None else None
    for kind in "ri":
        for ending in (".CNC", ".ndjson"):
            os.remove(os.path.join(folder, f"{kind}{seed}{ending}"))
    return seed, with_r is not None, alarm, measured, contour.nose, text


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--program", default="target/release/gsk980td")
    options.add_argument("--contours", type=int, default=5000)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--grid", type=float, default=0.001, help="I and K are multiples, mm")
    options.add_argument("--gouge", type=float, default=0.001, help="the most allowed, mm")
    options.add_argument("--show", type=int, default=3, help="print so many failures")
    given = options.parse_args()
    failures, fits, own_limit, measured_count = [], 0, 0, 0
    worst = [-math.inf, -math.inf]
    with tempfile.TemporaryDirectory() as folder:
        jobs = [
            (given.program, given.seed + index, given.grid, folder)
            for index in range(given.contours)
        ]
        with concurrent.futures.ProcessPoolExecutor() as pool:
            for seed, fitted, alarm, measured, nose, text in pool.map(one, jobs, chunksize=20):
                fits += fitted
                if alarm is not None and alarm[0] in (13, 48):
                    own_limit += 1
                elif alarm is not None and fitted:
                    failures.append(f"seed {seed}, nose {nose}: {alarm} with I, K\n{text}")
                if measured is None:
                    continue
                measured_count += 1
                worst = [max(pair) for pair in zip(worst, measured)]
                if measured[0] > given.gouge:
                    failures.append(f"seed {seed}, nose {nose}: gouge {measured[0]:.5f}\n{text}")
    print(
        f"{given.contours} contours, I and K on {given.grid}: {fits} fit with R, "
        f"{own_limit} beyond the arc's own limits (013, 048), {measured_count} measured, "
        f"worst gouge {worst[0]:.5f} mm, most left {worst[1]:.5f} mm, {len(failures)} failures"
    )
    for failure in failures[: given.show]:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
