#!/usr/bin/env python3
"""Ported programs of LinuxCNC lathes against LinuxCNC's interpreter (Debian: linuxcnc-uspace).

    tests/oracles/ported_linuxcnc.py target/debug/gsk980td [--count 300] [--rs274 rs274]

Random programs with lines, arcs by R and by I, K, relative and absolute centres, diameter and
radius mode, inches, increments, G92, G33 and dwells. `dialect --from linuxcnc` ports them; the
end, the centre and the sense of every move must be the same within 0.002 mm.
"""

import argparse
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

NEAR = 0.002
CALL = re.compile(r"(\w+)\(([^)]*)\)")


class Writer:
    """Writes random programs; positions are radii and millimetres."""

    def __init__(self, draw):
        self.draw = draw
        self.inch, self.diameter = draw.random() < 0.3, draw.random() < 0.6
        self.x, self.z, self.incremental, self.absolute_centers = 20.0, 5.0, False, False
        self.lines = ["%" if draw.random() < 0.3 else "; random", f"{'G20' if self.inch else 'G21'} G18 G90 G94 G40 G64 P0.01",
                      "G7" if self.diameter else "G8", "S500 M3"]
        self.lines.append(f"G0 {self.word('X', 20.0)} {self.word('Z', 5.0)}")

    def text(self, value):
        text = f"{value / (25.4 if self.inch else 1):.5f}".rstrip("0")
        return text if self.draw.random() < 0.5 else text.rstrip(".")

    def word(self, letter, value):
        return letter + self.text(value * (2 if letter == "X" and self.diameter else 1))

    def target(self, x, z):
        words = [self.word("X", x - self.x if self.incremental else x), self.word("Z", z - self.z if self.incremental else z)]
        self.x, self.z = x, z
        return " ".join(words)

    def operation(self):
        draw = self.draw
        kind = draw.choice(["line", "line", "rapid", "arc", "arc", "mode", "dwell", "thread", "shift"])
        x, z = draw.uniform(5, 40), draw.uniform(-50, 5)
        if kind == "line":
            self.lines.append(f"G1 {self.target(x, z)} F{draw.randint(20, 300)}")
        elif kind == "rapid":
            self.lines.append(f"G0 {self.target(x, z)}")
        elif kind == "mode":
            self.incremental = not self.incremental
            self.lines.append("G91" if self.incremental else "G90")
        elif kind == "dwell":
            self.lines.append(f"G4 P{draw.choice(['0.5', '2', '1.25'])}")
        elif kind == "thread":
            self.lines.append(f"G33 {self.target(self.x, z)} K{self.text(draw.uniform(1, 3))}")
        elif kind == "shift":
            self.lines.append(f"G92 {self.word('X', self.x)} {self.word('Z', self.z)}")
        else:
            self.arc()

    def arc(self):
        draw = self.draw
        radius, begin = draw.uniform(2, 15), draw.uniform(0, 2 * math.pi)
        center = (self.x - radius * math.cos(begin), self.z - radius * math.sin(begin))
        end = begin + draw.uniform(0.2, 2.8) * draw.choice([1, -1])
        # The angle runs from X to Z: against the sense of G3 in the plane Z to the right.
        code = "G2" if end > begin else "G3"
        x, z = center[0] + radius * math.cos(end), center[1] + radius * math.sin(end)
        from_x, from_z = self.x, self.z
        target = self.target(x, z)
        if draw.random() < 0.4:
            chord = math.hypot(x - from_x, z - from_z)
            self.lines.append(f"{code} {target} R{self.text(max(radius, chord / 2 + 0.001))} F100")
            return
        self.lines.append(f"{code} {target} I{self.text(center[0] - from_x)} K{self.text(center[1] - from_z)} F100")

    def program(self):
        for _ in range(self.draw.randint(4, 25)):
            self.operation()
        return "\n".join([*self.lines, "G0", "M2"]) + "\n"


def theirs(rs274, folder, path):
    (folder / "tools.tbl").write_text("T1 P1\n")
    (folder / "their.var").write_text("")
    done = subprocess.run([rs274, "-g", "-t", "tools.tbl", path.name], cwd=folder, capture_output=True, text=True, input="")
    moves, unit, shift = [], 1.0, (0.0, 0.0)
    for row in done.stdout.splitlines():
        found = CALL.search(row)
        if not found:
            continue
        name, values = found[1], re.split(r"[ ,]+", found[2].strip())
        if name == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in values[0] else 1.0
        elif name == "SET_G92_OFFSET":
            shift = (float(values[0]) * unit, float(values[2]) * unit)
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            x, z = float(values[0]) * unit, float(values[2]) * unit
            moves.append(("rapid" if name == "STRAIGHT_TRAVERSE" else "feed", 2 * x, z, None))
        elif name == "ARC_FEED":
            z, x, cz, cx = (float(value) * unit for value in values[:4])
            moves.append(("cw" if int(values[4]) < 0 else "ccw", 2 * x, z, (2 * cx, cz)))
    return moves


def ours(program, folder, path):
    ported = folder / "ported.nc"
    done = subprocess.run([program, "dialect", "--from", "linuxcnc", str(path), "-o", str(ported), "--json"], capture_output=True, text=True)
    result = json.loads(done.stdout)
    if not result["complete"] or result["check"]["alarm"]:
        return f"{result['findings']} {result['check']['alarm']}"
    rows = subprocess.run([program, "check", "--moves", "-", str(ported)], capture_output=True, text=True).stdout
    moves = []
    for move in map(json.loads, rows.splitlines()):
        if move["kind"] == "dwell":
            continue
        kind = "feed" if move["kind"] == "thread" else move["kind"]
        center = (move["cx"], move["cz"]) if kind in ("cw", "ccw") else None
        moves.append((kind, move["x"], move["z"], center))
    return moves


def differs(want, got):
    if isinstance(got, str):
        return got
    if len(want) != len(got):
        return f"{len(want)} moves expected, {len(got)} made"
    for index, (one, two) in enumerate(zip(want, got)):
        near = one[0] == two[0] and abs(one[1] - two[1]) <= NEAR and abs(one[2] - two[2]) <= NEAR
        if near and one[3]:
            # A centre that follows from R and two rounded ends is less exact than they are.
            near = max(abs(a - b) for a, b in zip(one[3], two[3])) <= 50 * NEAR
        if not near:
            return f"move {index}: {one} {two}"
    return None


def without_rests(moves):
    """Leaves out moves without length, which the control does not report."""
    kept, at = [], None
    for move in moves:
        if at is None or move[3] or max(abs(move[1] - at[0]), abs(move[2] - at[1])) > 0.0006:
            kept.append(move)
        at = move[1:3]
    return kept


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rs274", default="rs274")
    args = parser.parse_args()
    failed, total = 0, 0
    for seed in range(args.seed, args.seed + args.count):
        text = Writer(random.Random(seed)).program()
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            path = folder / "foreign.ngc"
            path.write_text(text)
            want = without_rests(theirs(args.rs274, folder, path))
            reason = differs(want, ours(args.program, folder, path))
        total += len(want)
        if reason:
            failed += 1
            print(f"seed {seed}: {reason}")
    print(f"{args.count - failed} of {args.count} programs equal, {total} moves")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
