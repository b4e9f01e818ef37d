#!/usr/bin/env python3
"""Where every pass of a G76 begins and ends, from the manual's formulas alone.

    python3 tests/oracles/g76_infeed.py [CASE ...]

Reads the programs `main.nc` of tests/cases/thread-compound* (or of the cases
named) and holds their `moves.ndjson` against (manual I-3.2.4.5):

    depth of pass n     d_n = max(sqrt(n) D, d_(n-1) + Dmin), the last one k - d
    finishing passes    m times k
    begin B_n           tan(a/2) = |dZ| / |dX| from B, on the line through the
                        depth parallel to C-D; B_e, the begin of the finishing
                        passes, obeys the same formula
    end                 on the line through the depth, at Z of D less the run-out

It shares no code and no numbers with the control. Exit code 1 when one differs.
"""

import json
import math
import pathlib
import re
import sys

CASES = pathlib.Path(__file__).resolve().parent.parent / "cases"
NEAR = 5e-5


def words(block):
    return {letter: text for letter, text in re.findall(r"([A-Z])(-?[0-9.]+)", block)}


def passes(first, least, rough, height, finishing):
    """Depths of all passes, mm as a radius."""
    depths, depth, number = [], 0.0, 0
    while depth < rough - 1e-9:
        number += 1
        depth = max(math.sqrt(number) * first, depth + least if number > 1 else 0.0)
        depth = min(depth, rough)
        depths.append(depth)
    return depths + [height] * finishing


def begins(at, data, thread):
    """B_n of every pass and the slope of the thread: (X diameter, Z)."""
    parameters = words(data)
    digits = parameters["P"].lstrip("-").zfill(6)
    finishing, angle = max(int(digits[:2]), 1), int(digits[4:])
    allowance = parameters.get("R", "0")
    allowance = float(allowance) if "." in allowance else float(allowance) / 1000
    word = words(thread)
    end_x = float(word["X"]) if "X" in word else at[0] + float(word.get("U", 0))
    end_z = float(word["Z"]) if "Z" in word else at[1] + float(word.get("W", 0))
    height, first = float(word["P"]) / 1000, float(word["Q"]) / 1000
    least = float(parameters.get("Q", 0)) / 1000
    taper = float(word.get("R", 0))
    c_x = end_x + 2 * taper
    side = 1 if at[0] > c_x else -1
    heading = 1 if end_z > at[1] else -1
    b_x = c_x + 2 * side * height
    slope = (end_x - c_x) / 2 / (end_z - at[1])
    tangent = math.tan(math.radians(angle) / 2)
    found = []
    for depth in passes(first, least, height - allowance, height, finishing):
        # The line parallel to C-D at the depth d: x = b - side*d + slope*(z - z_a).
        # The way in: z = z_a + heading*s*tangent, x = b - side*s. Both meet at s.
        s = depth / (1 + side * slope * heading * tangent)
        found.append((b_x - 2 * side * s, at[1] + heading * s * tangent))
    return found, slope


def case(folder):
    text = (folder / "main.nc").read_text()
    blocks = [line.split("(")[0] for line in text.splitlines()]
    moves = [json.loads(line) for line in (folder / "moves.ndjson").read_text().splitlines()]
    faults, checked, data = [], 0, None
    for number, block in enumerate(blocks, 1):
        if "G76" not in block:
            continue
        if not re.search(r"[XZUW]", block):
            data = block
            continue
        mine = [move for move in moves if move.get("line") == number]
        threads = [index for index, move in enumerate(mine) if move["kind"] == "thread"]
        if data is None or not threads or "P" not in words(data):
            continue
        first = mine[0]
        expected, slope = begins((first["x0"], first["z0"]), data, block)
        if len(expected) != len(threads):
            faults.append(f"line {number}: {len(threads)} passes, {len(expected)} expected")
            continue
        for index, (x, z) in zip(threads, expected):
            cut = mine[index]
            checked += 1
            if abs(cut["x0"] - x) > NEAR or abs(cut["z0"] - z) > NEAR:
                faults.append(
                    f"line {number}: begins at X{cut['x0']} Z{cut['z0']}, X{x:.6f} Z{z:.6f} expected"
                )
            on_line = x + 2 * slope * (cut["z"] - z)
            if abs(cut["x"] - on_line) > NEAR:
                faults.append(f"line {number}: ends at X{cut['x']}, X{on_line:.6f} expected")
    return checked, faults


def main():
    names = sys.argv[1:] or sorted(path.name for path in CASES.glob("thread-compound*"))
    checked, wrong = 0, 0
    for name in names:
        folder = CASES / name
        if not (folder / "moves.ndjson").exists() or not (folder / "main.nc").exists():
            continue
        done, faults = case(folder)
        checked += done
        wrong += len(faults)
        for fault in faults:
            print(f"{name}: {fault}")
    print(f"{checked} passes checked, {wrong} differ")
    return 1 if wrong or not checked else 0


if __name__ == "__main__":
    sys.exit(main())
