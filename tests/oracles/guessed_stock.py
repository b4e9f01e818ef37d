#!/usr/bin/env python3
"""Guessed stock and tools, against known good parts.

This makes programs of parts that are right, each with the job that it was written for:
outside and inside turning, facing, grooves, parting off, threads, drilling, left-hand
tools, profiles with undercuts. Each is checked twice, with `check --part --section`:

  with its job      no collision; the part has the programmed outline (the witness,
                    put together here with shapely)
  without a job     no collision; over the machined length the part is that of the job

Differences count where a disc of 0.2 mm fits in: corners keep the round of a nose, and
of a guessed tool the nose is not known.

    python3 tests/oracles/guessed_stock.py --program target/release/gsk980td --parts 300
"""

import argparse
import collections
import concurrent.futures
import csv
import json
import os
import random
import subprocess
import tempfile

from shapely.geometry import Polygon, box
from shapely.ops import unary_union

THICK = 0.2  # radius of a disc that fits into a difference that counts, mm
LEFT = 0.05  # area of such differences that is none, mm²

TURN = "(insert: Turning(letter: C, entering: 95, size: 15.875, nose: 0.8), tip: 3, holder: Shank(width: 20, length: 60))"
COPY = "(insert: Turning(letter: V, entering: 93, size: 12.7, nose: 0.4), tip: 3, holder: Shank(width: 20, length: 60))"
LEFT_HAND = COPY.replace("tip: 3", "tip: 4")
GROOVE = "(insert: Grooving(width: 3, nose: 0.1, reach: {reach}), tip: {tip}, holder: Shank(width: 20, length: 60))"
FACE_GROOVE = "(insert: Grooving(width: 3, nose: 0.1, reach: 20), tip: 7)"
THREAD = "(insert: Threading(angle: 60, nose: 0.05, height: 4), tip: 8, holder: Shank(width: 20, length: 60))"
BAR_THREAD = "(insert: Threading(angle: 60, nose: 0.05, height: 3), tip: 6, holder: Bar(diameter: 8, length: 80))"
BORE = "(insert: Turning(letter: D, entering: 93, size: 6.35, nose: 0.4), tip: 2, holder: Bar(diameter: 10, length: 80))"
BAR_GROOVE = "(insert: Grooving(width: 3, nose: 0.1, reach: 4), tip: 2, holder: Bar(diameter: 8, length: 80))"


def drill(diameter):
    return f"(insert: Drill(diameter: {diameter}, point: 118, reach: 90), tip: 7)"


class Part:
    """A program, its job, and the region of it that is compared."""

    def __init__(self, kind, pick):
        self.kind = kind
        self.pick = pick
        self.lines = []
        self.tools = {}
        self.bar = pick.choice([40, 46, 50, 60, 70])
        self.bore = 0
        self.face = 0.0
        self.beyond = False  # all of its X are negative
        self.outline = None  # what the witness says is left, over the compared box
        self.compared = None

    def tool(self, number, text, speed=600):
        self.tools[number] = text
        self.lines += [f"T{number:02}{number:02}", f"M03 S{speed}"]

    def add(self, *lines):
        self.lines += lines

    def away(self):
        self.add("G00 X120 Z80")

    def text(self):
        side = -1 if self.beyond else 1
        return "\n".join(["O0007", f"G50 X{side * 120} Z80", *self.lines, "M30", ""])

    def job(self):
        form = f"Bar(diameter: {self.bar})"
        if self.bore:
            form = f"Tube(diameter: {self.bar}, bore: {self.bore})"
        tools = ", ".join(f"{number}: {text}" for number, text in self.tools.items())
        return (
            f"(stock: (form: {form}, face: {self.face}, length: 160, overhang: 110, "
            f"chuck: (diameter: 250, length: 70, jaws: 30, jaw_height: 25)), tools: {{{tools}}})"
        )


def facing_z(part, depth=0.0):
    """Faces the bar at Z0 from a front of `depth`."""
    part.face = depth
    if depth:
        part.add(f"G00 X{part.bar + 2} Z0", "G01 X-1.6 F100", "G00 Z2")


def outline_of_steps(steps, inner=0.0):
    """Cylinders from the front, (diameter, to z), as a polygon of (z, x)."""
    pieces, front = [], 0.0
    for diameter, z in steps:
        pieces.append(box(z, inner, front, diameter / 2))
        front = z
    return unary_union(pieces)


def turned_steps(part):
    pick = part.pick
    count = pick.randint(1, 3)
    diameters = sorted(pick.sample(range(12, part.bar - 3, 2), count))
    steps, z = [], 0.0
    for diameter in diameters:
        z -= pick.choice([8, 10, 12.5, 15])
        steps.append((diameter, z))
    return steps


def outside_passes(part, manner):
    """Steps of a shaft, roughed and finished in one of several manners."""
    pick = part.pick
    steps = turned_steps(part)
    part.tool(1, TURN.replace("entering: 95", "entering: 90") if manner == "rapid" else TURN)
    facing_z(part, pick.choice([0.0, 0.5]))
    start = part.bar + 2
    if manner == "g90":
        part.add(f"G00 X{start} Z2")
        for diameter, z in reversed(steps):
            cut = part.bar if diameter == steps[-1][0] else upper
            first = True
            while cut > diameter:
                cut = max(cut - 4, diameter)
                words = f"X{cut} Z{z}"
                part.add(f"G90 {words} F100" if first else words)
                first = False
            upper = diameter
        part.away()
    elif manner == "g71":
        part.add(f"G00 X{start} Z2", "G71 U2 R1", "G71 P10 Q20 U0.5 W0.1 F100")
        words = [f"N10 G00 X{steps[0][0]}", f"G01 Z{steps[0][1]} F60"]
        for diameter, z in steps[1:]:
            words += [f"X{diameter}", f"Z{z}"]
        part.add(*words, f"N20 X{start}", "G70 P10 Q20")
        part.away()
    else:
        upper = part.bar
        for diameter, z in reversed(steps):
            cut = upper
            back = f"G00 X{upper + 2}" if manner == "rapid" else f"X{upper + 2}"
            while cut > diameter:
                cut = max(cut - 5, diameter)
                part.add(f"G00 X{cut} Z2", f"G01 Z{z} F100", back, "G00 Z2")
            upper = diameter
        part.away()
    part.outline = outline_of_steps(steps)
    part.compared = box(steps[-1][1], 0, 0, steps[-1][0] / 2 + 0.5)
    return steps


def make_facing(part, manner):
    pick = part.pick
    part.tool(1, TURN)
    diameter = pick.randrange(16, part.bar - 14, 2)
    depth = pick.choice([4, 6, 8, 10])
    start = part.bar + 2
    part.add(f"G00 X{start} Z2")
    if manner == "g94":
        z = 0
        while z > -depth:
            z = max(z - 2, -depth)
            part.add(f"G94 X{diameter} Z{z} F100" if z == -2 else f"Z{z}")
    elif manner == "g72":
        middle = (diameter + part.bar) // 2
        part.add(
            "G72 W2 R1", "G72 P10 Q20 U0.2 W0.1 F100", f"N10 G00 Z{-depth - 3}",
            f"G01 X{middle} F60", f"Z{-depth}", f"X{diameter}", "Z0", "N20 Z2", "G70 P10 Q20",
        )
        part.away()
        part.outline = unary_union(
            [box(-depth, 0, 0, diameter / 2), box(-depth - 3, 0, -depth, middle / 2)]
        )
        part.compared = box(-depth - 3, 0, 0, part.bar / 2)
        return
    else:
        z = 0
        while z > -depth:
            z = max(z - 2, -depth)
            part.add(f"G00 X{start} Z{z}", f"G01 X{diameter} F80", f"G00 X{diameter + 4} Z2", f"X{start}")
    part.away()
    part.outline = box(-depth, 0, 0, diameter / 2)
    part.compared = box(-depth, 0, 0, part.bar / 2)


def make_face_groove(part, manner):
    pick = part.pick
    part.tool(2, FACE_GROOVE)
    x = pick.randrange(16, part.bar - 12, 2)
    depth = pick.choice([3, 5, 8])
    part.add(f"G00 X{x} Z3")
    ends = [x]
    if manner == "g74":
        part.add("G74 R0.5", f"G74 Z{-depth} Q2000 F50")
    elif manner == "g74wide":
        x_end = x - 8
        part.add("G74 R0.5", f"G74 X{x_end} Z{-depth} P5000 Q2000 F50")
        ends = [x, x_end]
    else:
        part.add(f"G01 Z{-depth} F30", "G04 X1", "G00 Z3")
    part.away()
    groove = box(-depth, min(ends) / 2 - 1.5, 1, max(ends) / 2 + 1.5)
    part.outline = box(-depth - 2, 0, 0, part.bar / 2).difference(groove)
    # The outside of the bar is not machined.
    part.compared = box(-depth - 2, 0, 0, max(ends) / 2 + 2)


def make_groove(part, manner):
    pick = part.pick
    steps = outside_passes(part, "g90")
    diameter, end = steps[-1]
    front = steps[-2][1] if len(steps) > 1 else 0
    bottom = diameter - pick.choice([4, 6, 8])
    tip = pick.choice([3, 3, 4, 8])
    part.tool(3, GROOVE.format(reach=16, tip=3), 400)
    z = pick.choice([(front + end) / 2, end + 1])
    part.add(f"G00 X{diameter + 2} Z{z}")
    last = z
    if manner == "g75":
        part.add("G75 R0.5", f"G75 X{bottom} P2000 F40")
    elif manner == "g75wide":
        last = z + 5
        part.add("G75 R0.5", f"G75 X{bottom} Z{last} P2000 Q2500 F40")
        if last + 3 > front:
            part.kind += " open"
    else:
        part.add(f"G01 X{bottom} F40", "G04 X0.5", f"G01 X{diameter + 2} F200")
    if diameter < part.bar:
        part.add(f"G00 X{part.bar + 4}")
    part.away()
    groove = box(z, bottom / 2, last + 3, part.bar)
    part.outline = part.outline.difference(groove)


def make_parting(part, _manner):
    steps = outside_passes(part, "g71")
    end = steps[-1][1]
    part.tool(3, GROOVE.format(reach=part.bar / 2 + 4, tip=3), 400)
    part.add(f"G00 X{part.bar + 4} Z{end - 5}", "G01 X-0.4 F30", f"G00 X{part.bar + 4}")
    part.away()
    part.outline = Polygon()
    part.compared = box(end - 4, 0, 0, part.bar / 2)


def make_drill(part, manner):
    pick = part.pick
    part.tool(1, drill(10))
    depth = pick.choice([12, 20, 35])
    part.add("G00 X0 Z4")
    if manner == "g74":
        part.add("G74 R1", f"G74 Z{-depth} Q5000 F60", "G00 Z50")
    else:
        part.add(f"G01 Z{-depth} F60", "G00 Z50")
    part.away()
    part.outline = box(-depth + 4, 5, 0, part.bar / 2)
    part.compared = box(-depth + 4, 0, 0, 10)


def bored(part, manner, drilled):
    """A bore from a hole: diameter, depth."""
    pick = part.pick
    hole = pick.choice([16, 18, 20])
    depth = pick.choice([20, 25, 30])
    if drilled:
        part.tool(1, drill(hole), 400)
        part.add("G00 X0 Z5", f"G01 Z{-depth - 10} F60", "G00 Z60")
        part.away()
    else:
        part.bore = hole
    diameter = hole + pick.choice([4, 6, 8])
    square = manner in ("rapid", "steps")
    part.tool(2, BORE.replace("entering: 93", "entering: 90") if square else BORE)
    part.add(f"G00 X{hole} Z3")
    if manner == "g90":
        part.add(f"G90 X{hole + 2} Z{-depth} F80")
        cut = hole + 2
        while cut < diameter:
            cut = min(cut + 2, diameter)
            part.add(f"X{cut}")
    elif manner == "g71":
        part.add(
            "G71 U1 R0.5", "G71 P30 Q40 U-0.4 W0.1 F80", f"N30 G00 X{diameter}",
            f"G01 Z{-depth} F60", f"N40 X{hole}", "G70 P30 Q40",
        )
    elif square:
        # A rapid towards the axis leaves each shoulder, as textbooks have it.
        cut = hole
        while cut < diameter:
            cut = min(cut + 3, diameter)
            part.add(f"G00 X{cut}", f"G01 Z{-depth} F80", f"G00 X{hole}", "Z3")
        if manner == "steps":
            part.add(f"G00 X{diameter + 4}", f"G01 Z{-depth / 2:g} F80", f"G00 X{hole + 1}", "Z3")
    else:
        cut = hole
        while cut < diameter:
            cut = min(cut + 3, diameter)
            part.add(f"G00 X{cut}", f"G01 Z{-depth} F80", f"X{hole}", "G00 Z3")
    part.add("G00 Z60")
    part.away()
    part.outline = box(-depth, diameter / 2, 0, part.bar / 2)
    part.compared = box(-depth, 0, 0, diameter / 2 + 2)
    if manner == "steps":
        part.outline = part.outline.difference(box(-depth / 2, 0, 0, diameter / 2 + 2))
        part.compared = box(-depth, 0, 0, diameter / 2 + 3)
    return hole, diameter, depth


def make_bore(part, manner):
    drilled, manner = manner.split()
    bored(part, manner, drilled == "drilled")


def make_inside_groove(part, manner):
    hole, diameter, depth = bored(part, "g90", manner == "drilled")
    z = -depth + part.pick.choice([0, 5])
    part.tool(3, BAR_GROOVE, 300)
    part.add(
        f"G00 X{diameter - 2} Z3", f"G00 Z{z}", f"G01 X{diameter + 5} F30",
        f"X{diameter - 2} F100", "G00 Z60",
    )
    part.away()
    part.outline = part.outline.difference(box(z, 0, z + 3, diameter / 2 + 2.5))
    part.compared = box(-depth, 0, 0, diameter / 2 + 4)


def make_inside_thread(part, manner):
    drilled, cycle = manner.split()
    hole, diameter, depth = bored(part, "g90", drilled == "drilled")
    lead = part.pick.choice([1, 1.5, 2])
    end = diameter + round(1.0825 * lead, 3)
    part.tool(4, BAR_THREAD, 400)
    part.add(f"G00 X{diameter - 2} Z{3 * lead}")
    if cycle == "g92":
        cut = diameter + 0.3
        part.add(f"G92 X{cut:g} Z{-depth + 6} F{lead}")
        while cut < end:
            cut = min(cut + 0.4, end)
            part.add(f"X{cut:.3f}")
    else:
        height = round((end - diameter) / 2 * 1000)
        part.add("G76 P010060 Q100 R0.05", f"G76 X{end:.3f} Z{-depth + 6} P{height} Q300 F{lead}")
    part.add("G00 Z60")
    part.away()
    part.outline = None
    part.compared = box(-depth, 0, 0, end / 2 + 1)


def make_thread(part, manner):
    steps = outside_passes(part, "g90")
    diameter, end = steps[0]
    lead = part.pick.choice([1, 1.5, 2])
    root = diameter - 1.2268 * lead
    part.tool(4, THREAD, 400)
    start = part.bar + 4 if manner == "high" else diameter + 4
    part.add(f"G00 X{start} Z6")
    taper = "R-0.5 " if manner == "taper" else ""
    cut = diameter - 0.4
    part.add(f"G92 X{cut:g} Z{end + 4} {taper}F{lead}")
    while cut > root:
        cut = max(cut - 0.4, root)
        part.add(f"X{cut:.3f}" + (" R-0.5" if taper else ""))
    part.away()
    part.outline = None


def make_left_hand(part, _manner):
    pick = part.pick
    # A groove of two plunges is cut first, in which the left-hand tool begins: its second
    # edge, 52 degrees from the axis, needs its room.
    z_end, z_begin = -pick.choice([10, 15]), -pick.choice([35, 40, 45])
    diameter = part.bar - pick.choice([4, 6, 8])
    part.tool(3, GROOVE.format(reach=16, tip=3), 400)
    for z in (z_begin - 3, z_begin - 5.5):
        part.add(f"G00 X{part.bar + 4} Z{z}", f"G01 X{diameter} F40", f"G00 X{part.bar + 4}")
    part.away()
    part.tool(2, LEFT_HAND)
    part.add(f"G00 X{part.bar + 4} Z{z_begin}")
    cut = part.bar
    while cut > diameter:
        cut = max(cut - 2, diameter)
        part.add(f"G00 X{cut}", f"G01 Z{z_end} F80", f"X{part.bar + 4}", f"G00 Z{z_begin}")
    part.away()
    part.outline = None
    part.compared = box(z_begin, 0, z_end, diameter / 2 + 0.5)


def make_undercut(part, _manner):
    pick = part.pick
    part.tool(1, COPY)
    top = part.bar - 4
    low = top - pick.choice([6, 8, 10])
    slope = pick.choice([8, 10, 12])
    part.add(
        f"G00 X{top} Z2", f"G01 Z-45 F100", f"X{part.bar + 4}", "G00 Z2",
        f"G00 X{top} Z2", "G01 Z-8 F80", f"X{low} Z{-8 - slope}", "Z-35",
        f"X{top} Z-38", "Z-45", f"X{part.bar + 4}", "G00 Z2",
    )
    part.away()
    part.outline = Polygon(
        [(0, 0), (0, top / 2), (-8, top / 2), (-8 - slope, low / 2), (-35, low / 2),
         (-38, top / 2), (-45, top / 2), (-45, 0)]
    )
    part.compared = box(-45, 0, 0, top / 2)


def make_outside(part, manner):
    outside_passes(part, manner)


def make_no_tool(part, manner):
    outside_passes(part, manner)
    part.lines = [line for line in part.lines if not line.startswith("T")]
    part.tools = {1: TURN}


def make_beyond(part, _manner):
    """A tool on the far side: X is negative."""
    pick = part.pick
    part.beyond = True
    part.tool(1, TURN.replace("tip: 3", "tip: 2"))
    diameter = part.bar - pick.choice([6, 10])
    length = pick.choice([15, 25])
    part.add(f"G00 X{-part.bar - 2} Z2")
    cut = part.bar
    while cut > diameter:
        cut = max(cut - 4, diameter)
        part.add(f"G00 X{-cut}", f"G01 Z{-length} F100", f"X{-part.bar - 2}", "G00 Z2")
    part.add("G00 X-120 Z80")
    part.outline = box(-length, 0, 0, diameter / 2)
    part.compared = box(-length, 0, 0, diameter / 2 + 0.5)


def make_tube_face(part, _manner):
    part.bore = part.pick.choice([20, 24])
    part.tool(1, TURN)
    part.face = 0.5
    part.add(
        f"G00 X{part.bar + 4} Z0", f"G01 X{part.bore - 2} F80", "G00 Z2", f"X{part.bar - 4}",
        "G01 Z-20 F100", f"X{part.bar + 2}", "G00 Z2",
    )
    part.away()
    part.outline = None
    part.compared = box(-20, part.bore / 2 + 1, 0, part.bar / 2 - 1.5)


KINDS = [
    (make_outside, ["g90", "g71", "g01", "rapid"]),
    (make_facing, ["g94", "g72", "g01"]),
    (make_face_groove, ["g74", "g74wide", "g01"]),
    (make_groove, ["g75", "g75wide", "g01"]),
    (make_parting, [""]),
    (make_drill, ["g74", "g01"]),
    (make_bore, [f"{hole} {cycle}" for hole in ("drilled", "tube") for cycle in ("g90", "g71", "g01", "rapid", "steps")]),
    (make_inside_groove, ["drilled", "tube"]),
    (make_inside_thread, ["drilled g92", "drilled g76", "tube g92", "tube g76"]),
    (make_thread, ["straight", "taper", "high"]),
    (make_left_hand, [""]),
    (make_undercut, [""]),
    (make_no_tool, ["g90", "g71"]),
    (make_beyond, [""]),
    (make_tube_face, [""]),
]


def make(seed):
    pick = random.Random(seed)
    maker, manners = KINDS[seed % len(KINDS)]
    manner = pick.choice(manners)
    part = Part(f"{maker.__name__[5:]} {manner}".strip(), pick)
    maker(part, manner)
    return part


def section(path):
    polygons = collections.defaultdict(list)
    with open(path, newline="") as lines:
        for row in csv.DictReader(lines):
            polygons[row["polygon"]].append((float(row["z"]), float(row["x"]) / 2))
    region = Polygon()
    for points in polygons.values():
        if len(points) > 2:
            region = region.symmetric_difference(Polygon(points).buffer(0))
    return region


def check(program, folder, text, job):
    name = os.path.join(folder, "part.CNC")
    with open(name, "w") as file:
        file.write(text)
    out = os.path.join(folder, "part.csv")
    call = [program, "check", "--json", "--section", out, name]
    if job:
        path = os.path.join(folder, "with.ron")
        with open(path, "w") as file:
            file.write(job)
        call[2:2] = ["--job", path]
    done = subprocess.run(call, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        return done.returncode, done.stdout[-300:] + done.stderr[-300:], None
    report = json.loads(done.stdout.strip().splitlines()[-1])
    return done.returncode, report["part"]["collisions"], section(out)


def differs(one, other, compared):
    off = one.symmetric_difference(other).intersection(compared)
    return off.buffer(-THICK).area > 0 and off.buffer(-THICK).buffer(THICK).area > LEFT, off


def tried(program, seed, keep):
    part = make(seed)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        code, said, with_job = check(program, folder, part.text(), part.job())
        if code:
            found.append(f"with its job: {said}")
        code, said, guessed = check(program, folder, part.text(), None)
        if code:
            found.append(f"guessed: exit {code}: {str(said)[:600]}")
    if with_job is not None and part.outline is not None:
        off, region = differs(with_job, part.outline, part.compared)
        if off and "parting" not in part.kind:
            found.append(f"with its job the part is not the programmed one: {region.bounds}")
    if with_job is not None and guessed is not None:
        off, region = differs(with_job, guessed, part.compared)
        if off:
            found.append(f"the guessed part differs: {region.area:.3f} mm² in {region.bounds}")
    if found and keep:
        with open(os.path.join(keep, f"{seed}.CNC"), "w") as file:
            file.write(part.text())
        with open(os.path.join(keep, f"{seed}.ron"), "w") as file:
            file.write(part.job())
    return seed, part.kind, found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/gsk980td")
    parser.add_argument("--parts", type=int, default=300)
    parser.add_argument("--from", dest="first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--keep", help="a folder for the programs that are wrong")
    options = parser.parse_args()
    if options.keep:
        os.makedirs(options.keep, exist_ok=True)
    wrong = 0
    kinds = collections.Counter()
    seeds = range(options.first, options.first + options.parts)
    with concurrent.futures.ThreadPoolExecutor(options.workers) as pool:
        for seed, kind, found in pool.map(
            lambda seed: tried(options.program, seed, options.keep), seeds
        ):
            kinds[kind.split()[0]] += 1
            for line in found:
                wrong += 1
                print(f"{seed} ({kind}): {line}")
    print(f"{options.parts} parts, {wrong} findings; {dict(kinds)}")
    raise SystemExit(1 if wrong else 0)


if __name__ == "__main__":
    main()
