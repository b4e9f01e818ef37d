#!/usr/bin/env python3
"""Contours whose ends follow from two conditions, against a numerical solution.

Makes random contours of lines and arcs, most of them tangent, and writes each point of the
contour form with as few words as determine it: an angle and one coordinate, two lines that
meet, a line or an arc that ends where the next arc or line touches it. Here the lengths and
angles of these pieces are found by Newton's method on the coordinates that are given; the
program finds them in closed form. `form contour` writes the program, `check --section` cuts
its part, and the section is compared with the contour (shapely).

Needs numpy and shapely.

    python3 tests/oracles/contour_points.py --program target/debug/gsk980td --contours 200
"""

import argparse
import os
import random
import subprocess
import tempfile

import numpy as np
from shapely.geometry import LineString, Point, Polygon, box
from shapely.ops import unary_union

from form_parts import closed, lines, polygons, section_of

TOLERANCE = 0.002  # mm
STEPS = 200  # points of an arc


def heading(angle):
    """The direction with an angle to the axis, towards the chuck, as (z, radius)."""
    return np.array([-np.cos(angle), np.sin(angle)])


def arc_end(at, angle, radius, sweep, sign):
    """The end of an arc that turns by `sweep`; `sign` 1 turns towards larger angles (G02)."""
    normal = heading(angle + sign * np.pi / 2)
    center = at + radius * normal
    return center - radius * heading(angle + sign * (sweep + np.pi / 2))


def arc_points(at, angle, radius, sweep, sign):
    return [arc_end(at, angle, radius, part, sign) for part in np.linspace(0, sweep, STEPS)]


def newton(residual, guess):
    """The parameters at which two coordinates have the values given."""
    at = np.array(guess, dtype=float)
    for _ in range(50):
        value = residual(at)
        if np.abs(value).max() < 1e-12:
            break
        columns = []
        for index in range(len(at)):
            step = np.zeros(len(at))
            step[index] = 1e-7
            columns.append((residual(at + step) - residual(at - step)) / 2e-7)
        at = at - np.linalg.solve(np.array(columns).T, value)
    assert np.abs(residual(at)).max() < 1e-9, "no solution"
    return at


class Contour:
    def __init__(self, rng):
        self.rng = rng
        self.at = np.array([0.0, round(rng.uniform(5, 9), 3)])
        self.angle = None
        self.line = [self.at]
        self.words = [f"X{2 * self.at[1]:.3f}Z0"]

    def rounded(self, point):
        """Z and X as they are written: X as a diameter."""
        return np.array([round(point[0], 3), round(2 * point[1], 3) / 2])

    def degrees(self, low=2.0, high=80.0):
        return round(self.rng.uniform(low, high), 3)

    def size(self):
        return round(self.rng.uniform(1.5, 6), 3)

    def turn(self):
        """The sense and the angle of an arc that keeps the heading within 1 and 85 degrees."""
        low, high = np.radians(1), np.radians(85)
        signs = [sign for sign, room in ((1, high - self.angle), (-1, self.angle - low)) if room > 0.2]
        sign = self.rng.choice(signs)
        room = high - self.angle if sign > 0 else self.angle - low
        return sign, self.rng.uniform(0.15, room)

    def add(self, words, points, angle):
        self.words.append(words)
        self.line += list(points)
        self.at, self.angle = self.line[-1], angle

    def write(self, point):
        z, x = point
        return f"X{2 * x:.3f}Z{z:.3f}"

    def sense(self, sign):
        return "CW" if sign > 0 else "CCW"

    def line_to_coordinate(self):
        angle = self.degrees()
        end = self.rounded(self.at + self.rng.uniform(1, 4) * heading(np.radians(angle)))
        along = heading(np.radians(angle))
        which = self.rng.randint(0, 1)
        length = (end[which] - self.at[which]) / along[which]
        word = f"Z{end[0]:.3f}" if which == 0 else f"X{2 * end[1]:.3f}"
        self.add(f"{word}A{angle}", [self.at + length * along], np.radians(angle))

    def two_lines(self):
        one, two = self.degrees(), self.degrees()
        if abs(one - two) < 10:
            return
        first, second = heading(np.radians(one)), heading(np.radians(two))
        lengths = [self.rng.uniform(1, 4), self.rng.uniform(1, 4)]
        end = self.rounded(self.at + lengths[0] * first + lengths[1] * second)
        found = newton(lambda it: self.at + it[0] * first + it[1] * second - end, lengths)
        self.words.append(f"A{one}")
        self.add(f"{self.write(end)}A{two}", [self.at + found[0] * first, end], np.radians(two))

    def line_into_arc(self):
        self.angle = np.radians(degrees := self.degrees(10, 75))
        radius, (sign, sweep) = self.size(), self.turn()
        along, at, angle = heading(self.angle), self.at, self.angle

        def ends(it):
            return arc_end(at + it[0] * along, angle, radius, it[1], sign)

        guess = [self.rng.uniform(1, 4), sweep]
        end = self.rounded(ends(guess))
        length, sweep = newton(lambda it: ends(it) - end, guess)
        self.words.append(f"A{degrees}")
        points = arc_points(at + length * along, angle, radius, sweep, sign)
        words = f"{self.write(end)}{self.sense(sign)}{radius}T"
        self.add(words, points, angle + sign * sweep)

    def tangent_arc(self):
        radius, (sign, sweep) = self.size(), self.turn()
        at, angle = self.at, self.angle
        kind = self.rng.choice("XZAE")
        end = self.rounded(arc_end(at, angle, radius, sweep, sign))
        words = f"{self.sense(sign)}{radius}T"
        if kind == "A":
            degrees = round(np.degrees(angle + sign * sweep), 3)
            sweep = sign * (np.radians(degrees) - angle)
            words = f"A{degrees}{words}"
        elif kind == "E":
            def ends(it):
                return arc_end(at, angle, it[0], it[1], sign)
            radius, sweep = newton(lambda it: ends(it) - end, [radius, sweep])
            words = f"{self.write(end)}{self.sense(sign)}T"
        else:
            which = "ZX".index(kind)
            [sweep] = newton(
                lambda it: (arc_end(at, angle, radius, it[0], sign) - end)[[which]], [sweep])
            words = (f"Z{end[0]:.3f}" if which == 0 else f"X{2 * end[1]:.3f}") + words
        self.add(words, arc_points(at, angle, radius, sweep, sign), angle + sign * sweep)

    def arc_into_line(self):
        radius, (sign, sweep) = self.size(), self.turn()
        at, angle = self.at, self.angle
        self.words.append(f"{self.sense(sign)}{radius}T")
        guess = [sweep, self.rng.uniform(1, 4)]

        def ends(it):
            return arc_end(at, angle, radius, it[0], sign) + it[1] * heading(angle + sign * it[0])

        if self.rng.random() < 0.5:
            end = self.rounded(ends(guess))
            sweep, _ = newton(lambda it: ends(it) - end, guess)
            words = f"{self.write(end)}T"
        else:
            degrees = round(np.degrees(angle + sign * sweep), 3)
            sweep = sign * (np.radians(degrees) - angle)
            middle = arc_end(at, angle, radius, sweep, sign)
            along = heading(angle + sign * sweep)
            x = self.rounded(middle + guess[1] * along)[1]
            end = middle + (x - middle[1]) / along[1] * along
            words = f"X{2 * x:.3f}A{degrees}"
        points = arc_points(at, angle, radius, sweep, sign) + [end]
        self.add(words, points, angle + sign * sweep)

    def arc_into_arc(self):
        at, angle = self.at, self.angle
        one, (sign, sweep) = self.size(), self.turn()
        middle = angle + sign * sweep
        self.angle = middle
        two, (other, second) = self.size(), self.turn()
        self.angle = angle
        if sign == other and abs(one - two) < 0.3:
            return

        def ends(it):
            return arc_end(arc_end(at, angle, one, it[0], sign), angle + sign * it[0], two, it[1], other)

        end = self.rounded(ends([sweep, second]))
        sweep, second = newton(lambda it: ends(it) - end, [sweep, second])
        middle = angle + sign * sweep
        points = arc_points(at, angle, one, sweep, sign)
        points += arc_points(points[-1], middle, two, second, other)
        self.words.append(f"{self.sense(sign)}{one}T")
        self.add(f"{self.write(end)}{self.sense(other)}{two}T", points, middle + other * second)


def random_contour(rng):
    contour = Contour(rng)
    contour.line_to_coordinate()
    kinds = [Contour.line_to_coordinate, Contour.two_lines, Contour.line_into_arc,
             Contour.tangent_arc, Contour.arc_into_line, Contour.arc_into_arc]
    for _ in range(rng.randint(2, 4)):
        rng.choice(kinds)(contour)
    # A cylinder, so that the nose reaches the piece before the shoulder.
    end = contour.rounded(contour.at + np.array([-6.0, 0.0]))
    end[1] = contour.at[1]
    contour.add(f"Z{end[0]:.3f}", [end], 0.0)
    return contour


def compare(program, folder, rng):
    contour = random_contour(rng)
    nose = rng.choice([0, 0.4, 0.8])
    stock = np.ceil(2 * contour.at[1] + 3)
    file, section = os.path.join(folder, "form.CNC"), os.path.join(folder, "section.csv")
    for path in (file, file.replace(".CNC", ".job.ron")):
        if os.path.exists(path):
            os.remove(path)
    points = ";".join(contour.words)
    values = [f"POINTS={points}", f"NOSE={nose}", f"STOCK={stock}"]
    words = [word for value in values for word in ("--set", value)]
    made = subprocess.run([program, "form", "contour", *words, "-o", file],
                          capture_output=True, text=True)
    if "nose radius" in made.stderr or "刀尖半径" in made.stderr:
        # A piece between two inner corners is shorter than the nose.
        return None
    made.check_returncode()
    subprocess.run([program, "check", "--part", "--section", section, file],
                   check=True, capture_output=True)
    found = section_of(section)
    low = found.bounds[0]
    (z, _), first = contour.line[-1], contour.line[0]
    around = [(z, stock / 2), (low, stock / 2), (low, -90), (0, -90)]
    wanted = Polygon([(first[0], -90), *map(tuple, contour.line), *around]).buffer(0)
    wanted = closed(wanted.intersection(box(low, -90, 0, 200)), nose)
    window = box(z - 1, 0.5, -0.001, 200)
    edges = unary_union([LineString(part.exterior.coords) for part in polygons(wanted)])
    own = unary_union([part.exterior for part in polygons(found)])
    checked = [point for line in lines(edges.intersection(window)) for point in line.coords]
    if len(checked) < 4:
        raise SystemExit(f"nothing to compare: {points}")
    return max(own.distance(Point(point)) for point in checked), points, nose


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--program", default="target/debug/gsk980td")
    arguments.add_argument("--contours", type=int, default=200)
    arguments.add_argument("--seed", type=int, default=1)
    given = arguments.parse_args()
    rng = random.Random(given.seed)
    worst, faults, refused, compared = 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        while compared < given.contours:
            result = compare(given.program, folder, rng)
            if result is None:
                refused += 1
                continue
            compared += 1
            off, points, nose = result
            worst = max(worst, off)
            if off > TOLERANCE:
                faults += 1
                print(f"{off:.4f} mm off, nose {nose}: {points}")
    print(f"{given.contours} contours, greatest difference {worst:.4f} mm, "
          f"{faults} above {TOLERANCE} mm; {refused} more refused as narrower than the nose")
    raise SystemExit(faults > 0)


if __name__ == "__main__":
    main()
