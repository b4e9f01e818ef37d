#!/usr/bin/env python3
"""Programs of the mill against LinuxCNC's interpreter (Debian: linuxcnc-uspace).

    tests/oracles/mill_paths.py target/release/gsk980td [--count 1000] [--seed 1]

Random programs of the codes that both have: lines, arcs by R and by I, J, K in three
planes, helices, G43, G49, G52, G54 to G59, G92, G81, G82, G85, G89 with G98, G99 and
repetitions. The end of every move must be the same to 1 um, of every arc its centre and
sense, too. A fourth axis A, rotary, takes part in lines, arcs and zeros. Of G73 and G83,
which go back by other amounts, the depth is compared.
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

NEAR = 0.0011
# What it keeps in its files is in inches.
INCH = 25.4
PLANES = {"G17": ("X", "Y", "Z"), "G18": ("Z", "X", "Y"), "G19": ("Y", "Z", "X")}
CENTERS = {"X": "I", "Y": "J", "Z": "K"}
ZEROS = {54: (0, 0, 0, 0), 55: (10, -20, 5, 90), 56: (-3.5, 7.25, 0, -400), 57: (100, 50, -10, 0),
         58: (0.001, 0.002, 0.003, 0.004), 59: (-40, 0, 12, 1.5)}
LENGTHS = {1: 50.0, 2: 73.125, 3: -4.5}


def number(value):
    text = f"{value:.3f}"
    return "0." if text in ("0.000", "-0.000") else text


def words(**axes):
    return " ".join(f"{axis}{number(value)}" for axis, value in axes.items())


def line(draw):
    code = draw.choice(["G0", "G1"])
    axes = draw.sample("XYZ", draw.randrange(1, 4))
    mode = draw.choice(["G90", "G91"])
    reach = 60 if mode == "G90" else 15
    if draw.random() < 0.3:
        axes.append("A")
    return [f"{mode} {code} " + words(**{axis: draw.uniform(-reach, reach) for axis in axes})]


def arc(draw):
    plane = draw.choice(list(PLANES))
    first, second, across = PLANES[plane]
    code = draw.choice(["G2", "G3"])
    helix = {across: draw.uniform(-5, 5)} if draw.random() < 0.4 else {}
    if draw.random() < 0.2:
        helix["A"] = draw.uniform(-400, 400)
    if draw.random() < 0.4:
        ends = {first: draw.uniform(-20, 20), second: draw.uniform(-20, 20)}
        chord = math.hypot(*ends.values())
        if chord < 0.5:
            return []
        radius = chord / 2 * draw.uniform(1.02, 3) * draw.choice([1, -1])
        text = words(**ends, **helix) + f" R{number(radius)}"
    else:
        radius, begin = draw.uniform(1, 25), draw.uniform(0, 2 * math.pi)
        center = (-radius * math.cos(begin), -radius * math.sin(begin))
        turn = draw.uniform(0.1, 2 * math.pi - 0.1)
        end = (center[0] + radius * math.cos(begin + turn), center[1] + radius * math.sin(begin + turn))
        ends = {first: end[0], second: end[1]}
        if draw.random() < 0.15:
            ends = {}
        text = words(**ends, **helix, **{CENTERS[first]: center[0], CENTERS[second]: center[1]})
    return [f"{plane} G91 {code} {text} F300", "G90 G17 G1"]


def length(draw):
    if draw.random() < 0.3:
        return [f"G90 G0 G49 Z{number(draw.uniform(20, 60))}"]
    return [f"G90 G0 G43 H{draw.choice(list(LENGTHS))} Z{number(draw.uniform(20, 60))}"]


def zero(draw):
    if draw.random() < 0.6:
        return [f"G{draw.choice(list(ZEROS))}"]
    axes = {axis: draw.uniform(-30, 30) for axis in draw.sample("XYZA", 2)}
    return [f"G90 {draw.shift} " + words(**axes), "G1"]


def holes(draw):
    code = draw.choice(["G81", "G82", "G85", "G89", "G73", "G83"])
    # Under G98 the other side feeds as far as the initial level; here only to R.
    back = "G99" if code in ("G85", "G89") else draw.choice(["G98", "G99"])
    top, r, bottom = draw.uniform(20, 40), draw.uniform(1, 15), draw.uniform(-30, -1)
    extra = {"G82": " P{dwell}", "G89": " P{dwell}", "G73": " Q2.", "G83": " Q2."}.get(code, "")
    out = [f"G90 G0 Z{number(top)}"]
    if draw.random() < 0.4:
        out.append(f"G91 {back} {code} X5. Y{number(draw.uniform(-9, 9))} R{number(r - top)} "
                   f"Z{number(bottom - r)}{extra} L{draw.randrange(1, 5)} F100")
    else:
        out.append(f"{back} {code} X{number(draw.uniform(-50, 50))} Y{number(draw.uniform(-50, 50))} "
                   f"R{number(r)} Z{number(bottom)}{extra} F100")
        out += [words(X=draw.uniform(-50, 50), Y=draw.uniform(-50, 50)) for _ in range(draw.randrange(3))]
    return [*out, "G80 G90 G1"]


def program(draw):
    # There both share one offset.
    draw.shift = draw.choice(["G52", "G92"])
    lines = ["G21 G17 G90 G94 G54 G40 G49", "G0 X0. Y0. Z50. A0.", "G1 F200"]
    for _ in range(draw.randrange(5, 40)):
        lines += draw.choices([line, arc, length, zero, holes], [5, 5, 1, 1, 2])[0](draw)
    return [*lines, "G92.1", "M2"]


def ours(binary, folder, lines):
    text = "\n".join(text for text in lines if text != "G92.1").replace("{dwell}", "500")
    path = folder / "mill.nc"
    path.write_text(text + "\n")
    zeros = [f"--mill-zero={code}=" + ",".join(map(str, point)) for code, point in ZEROS.items()]
    lengths = [f"--mill-offset={number}={value}" for number, value in LENGTHS.items()]
    done = subprocess.run([binary, "check", "--model", "gsk980mdi", "--mill-start=0,0,0", "--model-param=1010=4", *zeros, *lengths,
                           "--moves", "-", "--json", path], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{text}\n{done.stdout}{done.stderr}")
    moves = [json.loads(row) for row in done.stdout.splitlines()]
    made = []
    for move in moves:
        if move["kind"] == "dwell":
            continue
        center = tuple(move[name] for name in ("cx", "cy", "cz")) if move["kind"] in ("cw", "ccw") else None
        made.append((move["kind"], (move["x"], move["y"], move["z"], move["a"]), center, move["line"]))
    return made


CALL = re.compile(r"(\w+)\(([^)]*)\)")


def theirs(folder, lines):
    (folder / "their.ngc").write_text("\n".join(lines).replace("{dwell}", "0.5") + "\n")
    rows = [f"{5201 + 20 * (code - 53) + axis} {point[axis] / (1 if axis == 3 else INCH):.12f}" for code, point in ZEROS.items() for axis in range(4)]
    needed = [5161, 5181, 5210, 5211, 5212, 5213, 5214, 5215, 5216, 5217, 5218, 5219, 5220]
    numbers = {int(row.split()[0]): row.split()[1] for row in rows}
    for base in needed:
        numbers.setdefault(base, "1" if base == 5220 else "0")
    for base in range(5161, 5170):
        numbers.setdefault(base, "0")
    for base in range(5181, 5190):
        numbers.setdefault(base, "0")
    for start in range(5221, 5390, 20):
        for index in range(10):
            numbers.setdefault(start + index, "0")
    (folder / "their.var").write_text("".join(f"{key} {numbers[key]}\n" for key in sorted(numbers)))
    (folder / "their.tbl").write_text("".join(f"T{key} P{key} Z{value / INCH:.12f}\n" for key, value in LENGTHS.items()))
    done = subprocess.run(["rs274", "-g", "-v", "their.var", "-t", "their.tbl", "their.ngc"], cwd=folder,
                          capture_output=True, text=True, input="")
    made, at, plane = [], None, "XY"
    offsets = {"SET_G5X_OFFSET": (0,) * 4, "SET_G92_OFFSET": (0,) * 4, "USE_TOOL_LENGTH_OFFSET": (0,) * 4}
    for row in done.stdout.splitlines():
        found = CALL.search(row)
        if not found:
            continue
        name, arguments = found[1], re.split(r"[ ,]+", found[2].strip())
        if name in offsets:
            values = [float(part) for part in arguments]
            offsets[name] = tuple(values[1:5] if name == "SET_G5X_OFFSET" else values[:4])
        elif name == "SELECT_PLANE":
            plane = arguments[0][-2:]
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "ARC_FEED"):
            values = [float(part) for part in arguments]
            center, kind = None, "rapid" if name == "STRAIGHT_TRAVERSE" else "feed"
            if name == "ARC_FEED":
                code = {"XY": "G17", "XZ": "G18", "ZX": "G18", "YZ": "G19"}[plane]
                first, second, across = ("XYZ".index(axis) for axis in PLANES[code])
                point, middle = [0.0] * 3, [None] * 3
                point[first], point[second], point[across] = values[0], values[1], values[5]
                middle[first], middle[second] = values[2], values[3]
                center, kind = tuple(middle), "ccw" if values[4] > 0 else "cw"
                point.append(values[6])
            else:
                point = values[:4]
            machine = tuple(sum(parts) for parts in zip(point, *offsets.values()))
            if center is None and at and max(abs(a - b) for a, b in zip(at, machine)) < 0.0002:
                continue
            at = machine
            made.append((kind, tuple(point), center))
    if "PROGRAM_END" not in done.stdout:
        return None, done.stdout[-400:] + done.stderr[-400:]
    return made, None


def differs(one, other):
    if one[0] != other[0] or max(abs(a - b) for a, b in zip(one[1], other[1])) > NEAR:
        return True
    if one[2] is None:
        return False
    # By R the centre of a flat arc is as far off as its ends are rounded.
    return any((a is None) != (b is None) or (a is not None and abs(a - b) > 0.004) for a, b in zip(one[2], other[2]))




def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binary")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    draw = random.Random(args.seed)
    moves = programs = refused = arcs = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for index in range(args.count):
            lines = program(draw)
            other, said = theirs(folder, lines)
            if other is None:
                refused += 1
                continue
            own = ours(Path(args.binary).resolve(), folder, lines)
            pecks = any("G73" in text or "G83" in text for text in lines)
            if pecks:
                # How far they go back is a parameter here and fixed there.
                own, other = ([move for move in made if move[0] != "rapid"] for made in (own, other))
            for at, (one, two) in enumerate(zip(own, other)):
                if differs(one, two):
                    sys.exit("\n".join(lines) + f"\nprogram {index}, move {at}: {one} here, {two} there")
            if len(own) != len(other):
                sys.exit("\n".join(lines) + f"\nprogram {index}: {len(own)} moves here, {len(other)} there")
            programs, moves = programs + 1, moves + len(own)
            arcs += sum(move[2] is not None for move in own)
    print(f"{programs} programs, {moves} moves, {arcs} of them arcs: the same; {refused} refused by the other side")


if __name__ == "__main__":
    main()
