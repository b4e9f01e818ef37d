#!/usr/bin/env python3
"""Random Fanuc 0T and 10T programs: the ported program moves as the model in `fanuc_lathe.py` says.

    tests/oracles/ported_random.py target/release/gsk980td [--count 2000] [--seed 1] [--keep DIR]
        [--rs274 rs274]

Absolute and incremental words, numbers with and without a point, inches, G28 through a middle
point, corners of every form, tapers, G70 to G76 in two blocks and in one, calls, G50 with U and W,
G code system B, angles. Macro programs must be refused. Differences are sorted by class. With
--rs274 the model itself is compared with LinuxCNC on those programs of system B whose codes
LinuxCNC knows.
"""

import argparse
import collections
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fanuc_lathe import Fanuc, Unknown
from fanuc_writer import Writer
from ported_compare import NEAR, differs

WORK_ZERO, START = (-200.0, -300.0), (150.0, 120.0)
CALL = re.compile(r"(\w+)\(([^)]*)\)")


def made_moves(program, path):
    call = [program, "check", "--param", "19=0", f"--work-zero={WORK_ZERO[0]},{WORK_ZERO[1]}",
            f"--start={START[0]},{START[1]}", "--moves", "-", str(path)]
    rows = subprocess.run(call, capture_output=True, text=True).stdout.splitlines()
    return [json.loads(row) for row in rows if row.startswith("{")]


def examine(program, seed, keep):
    draw = random.Random(seed)
    dialect = draw.choice(["fanuc0t", "fanuc0t", "fanuc-10t"])
    writer = Writer(draw, dialect == "fanuc-10t")
    text = writer.program()
    has_macro = draw.random() < 0.03
    if has_macro:
        text = text.replace("M08", "M08\n#100=#101+1.5\nG00 X#100", 1)
    with tempfile.TemporaryDirectory() as folder:
        foreign, ported = Path(folder) / "foreign.nc", Path(folder) / "ported.nc"
        foreign.write_text(text)
        done = subprocess.run([program, "dialect", "--from", dialect, str(foreign), "-o", str(ported), "--json"],
                              capture_output=True, text=True)
        result, made = json.loads(done.stdout), ported.read_text()
        found = judge(program, writer, text, result, ported, has_macro)
    if found and keep:
        keep = Path(keep)
        keep.mkdir(parents=True, exist_ok=True)
        (keep / f"{seed}.{dialect}.nc").write_text(text)
        (keep / f"{seed}.ported.nc").write_text(made)
    return dialect, found, text, writer


def judge(program, writer, text, result, ported, has_macro):
    if has_macro:
        return None if not result["complete"] else ("macro", "ported without a word", 0)
    try:
        model = Fanuc(text, writer.is_b, START, (-WORK_ZERO[0], -WORK_ZERO[1])).run()
    except Unknown as reason:
        return f"model: {reason}", "", 0
    refused = [f for f in result["findings"] if f["refused"]]
    if refused:
        return "refused", f"{refused[0]}", refused[0]["line"]
    if result["check"]["alarm"]:
        alarm = result["check"]["alarm"]
        return f"alarm {alarm['number']}", f"{alarm.get('block')}: {alarm.get('detail')}", 0
    return differs(model, made_moves(program, ported))


# LinuxCNC ------------------------------------------------------------------------------------

KNOWN = {0, 1, 2, 3, 4, 20, 21, 33, 40, 90, 91, 92, 94, 95, 96, 97}


def linuxcnc_text(text):
    """The program as LinuxCNC reads it, or None if it has other codes than KNOWN."""
    if {float(c) for c in re.findall(r"G(\d+)", text)} - KNOWN or re.search(r"M98|,[CR]|[A]\d", text):
        return None
    rows = []
    for row in text.splitlines():
        row = re.sub(r"^[O:]\d+", "", re.sub(r"T\d+|\([^)]*\)", "", row)).replace("%", "")
        row = re.sub(r"([XZIKR])(-?\d+)(?![\d.])", lambda f: f[1] + f"{int(f[2]) / (10000 if 'G20' in text else 1000):.4f}", row)
        if re.search(r"G0?4(?!\d)", row):
            continue
        if "G33" in row.replace("G033", "G33"):
            row = re.sub(r"[FE]([\d.]+)", r"K\1", row)
        if re.search(r"G92.*S|G9[67]", row):
            continue
        row = re.sub(r"G9[45]|S\d+|M\d+|F[\d.]+|E[\d.]+", "", row) if "G33" not in row else re.sub(r"S\d+|M\d+", "", row)
        rows.append(row)
    head = "G7 G18 G90 G94 G21 G40 G64 F100 S500 M3\nG91.1\n"
    return head + "\n".join(rows) + "\nM2\n"


def linuxcnc_moves(rs274, folder, text):
    (folder / "tools.tbl").write_text("T1 P1\n")
    (folder / "their.var").write_text("")
    (folder / "their.ngc").write_text(text)
    done = subprocess.run([rs274, "-g", "-t", "tools.tbl", "their.ngc"], cwd=folder, capture_output=True, text=True, input="")
    unit, moves = 1.0, []
    for row in done.stdout.splitlines():
        found = CALL.search(row)
        if not found:
            continue
        name, values = found[1], re.split(r"[ ,]+", found[2].strip())
        if name == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in values[0] else 1.0
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "SPINDLE_SYNC_MOTION"):
            moves.append(("line", 2 * float(values[0]) * unit, float(values[2]) * unit))
        elif name == "ARC_FEED":
            z, x = float(values[0]) * unit, float(values[1]) * unit
            moves.append(("cw" if int(values[4]) < 0 else "ccw", 2 * x, z))
    return moves, done.stderr


def linuxcnc(rs274, seed):
    """None if LinuxCNC cannot read the program, else whether the model moves as LinuxCNC does."""
    draw = random.Random(seed)
    draw.choice([0, 0, 1])
    writer = Writer(draw, False)
    writer.is_b = True
    simple = ["lines", "lines", "arc", "arc", "dwell", "mode", "g32"]
    for name in ("corner", "turn", "face", "thread", "rough71", "rough72", "pattern", "peck74", "peck75", "many", "call", "home", "per", "speed"):
        setattr(writer, name, getattr(writer, draw.choice(simple)))
    text = writer.program()
    theirs = linuxcnc_text(text)
    if theirs is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        moves, error = linuxcnc_moves(rs274, Path(folder), theirs)
    if "missing" in error:
        return None
    model = [m for m in Fanuc(text, True, START, (200.0, 300.0)).run() if m.kind != "dwell"]
    kept, at = [], None
    for move in moves:
        if at is None or move[0] != "line" or math.hypot(move[1] - at[1], move[2] - at[2]) > 1e-4:
            kept.append(move)
        at = move
    # It prints four decimals of inches and of radii.
    near = NEAR + (0.003 if writer.inch else 0)
    return len(kept) == len(model) and all(
        abs(a[1] - b.x) < near and abs(a[2] - b.z) < near and a[0] == (b.kind if b.kind in ("cw", "ccw") else "line")
        for a, b in zip(kept, model))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", help="folder for programs that differ")
    parser.add_argument("--rs274", help="LinuxCNC's interpreter (Debian: linuxcnc-uspace)")
    args = parser.parse_args()
    classes, shown, equal, total, kinds = collections.Counter(), {}, 0, 0, collections.Counter()
    with ThreadPoolExecutor(2) as pool:
        for seed, (dialect, found, text, writer) in zip(
                range(args.seed, args.seed + args.count),
                pool.map(lambda s: examine(args.program, s, args.keep), range(args.seed, args.seed + args.count))):
            kinds.update(writer.used)
            total += 1
            if not found:
                equal += 1
                continue
            classes[found[0]] += 1
            row = text.splitlines()[found[2] - 1] if found[2] else ""
            shown.setdefault(found[0], []).append(f"seed {seed} ({dialect}): {row}: {found[1]}")
    for name, count in classes.most_common():
        print(f"{count} {name}")
        for line in shown[name][:3]:
            print("   ", line)
    print("operations:", dict(kinds))
    print(f"{equal} of {total} programs equal")
    if args.rs274:
        answers = [linuxcnc(args.rs274, seed) for seed in range(args.seed, args.seed + args.count // 10)]
        print(f"model and LinuxCNC: {answers.count(True)} of {len(answers) - answers.count(None)} equal")
    return 1 if classes else 0


if __name__ == "__main__":
    sys.exit(main())
