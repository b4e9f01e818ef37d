#!/usr/bin/env python3
"""The posts for FreeCAD and Fusion: the moves of their programs are those that went in.

    tests/oracles/posts.py target/debug/gsk980td [--count 200] [--seed 1] [--keep DIR]

Random jobs of rapids, lines, arcs and threads go through `posts/freecad/gsk980td_post.py`, with
objects that have FreeCAD's attributes, and through `posts/fusion/gsk980td.cps` in node, with the
engine's functions of `post_engine.js`. `check --part` must find the programs clean, and its
moves must be those of the job within 0.002 mm.
"""

import argparse
import importlib.util
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NEAR = 0.002
CHANGE = (100.0, 100.0)


class Command:
    """FreeCAD's Path.Command."""

    def __init__(self, name, parameters=None):
        self.Name, self.Parameters = name, parameters or {}


class Item:
    """An object with a path."""

    def __init__(self, label, commands):
        self.Label = label
        self.Path = type("Path", (), {"Commands": commands})()


def random_arc(pick, x, z):
    """An arc from a position: clockwise, centre and end; X is a radius."""
    for _ in range(100):
        radius = pick.uniform(1.0, 12.0)
        begin = pick.uniform(0.0, 2 * math.pi)
        # G03 turns from Z towards X.
        sweep = pick.choice((-1, 1)) * pick.uniform(0.1, 3.0)
        cx, cz = x - radius * math.sin(begin), z - radius * math.cos(begin)
        end_x, end_z = cx + radius * math.sin(begin + sweep), cz + radius * math.cos(begin + sweep)
        if end_x > 3.0:
            return sweep < 0, cx, cz, end_x, end_z
    return None


def random_job(pick):
    """A job, and the moves it stands for: kind, diameter, Z, centre."""
    operations, moves = [], []
    for tool in pick.sample(range(1, 5), pick.randint(1, 2)):
        feed_mode = pick.choice(("rev", "min"))
        operation = {"tool": tool, "feedMode": feed_mode, "moves": []}
        operation["comment"] = pick.choice(("ROUGH (1)", "Nut äöü; 50%", ""))
        operation["speed"] = pick.randint(200, 2000)
        if pick.random() < 0.3:
            operation["surfaceSpeed"], operation["limit"] = pick.randint(60, 200), 2000
        feed = pick.uniform(0.05, 0.4) if feed_mode == "rev" else pick.uniform(20, 300)
        moves.append(("rapid", *CHANGE, None))
        x, z = pick.uniform(5, 40), pick.uniform(1, 5)
        operation["moves"].append(("rapid", x, z))
        moves.append(("rapid", 2 * x, z, None))
        for _ in range(pick.randint(2, 12)):
            arc = random_arc(pick, x, z) if pick.random() < 0.4 else None
            if arc:
                clockwise, cx, cz, x, z = arc
                operation["moves"].append(("arc", clockwise, cx, cz, x, z, feed))
                moves.append(("cw" if clockwise else "ccw", 2 * x, z, (2 * cx, cz)))
            else:
                x = pick.choice((x, pick.uniform(2, 40)))
                z = z - pick.uniform(0.5, 10)
                kind = pick.choice(("line", "line", "rapid"))
                last = (feed,) if kind == "line" else ()
                operation["moves"].append((kind, x, z, *last))
                moves.append(("feed" if kind == "line" else "rapid", 2 * x, z, None))
        operations.append(operation)
    moves.append(("rapid", *CHANGE, None))
    return {"number": pick.randint(1, 9999), "operations": operations}, moves


def freecad_objects(job):
    """The job as objects of FreeCAD: X a radius, feeds in mm/s, centres as distances."""
    items = []
    for operation in job["operations"]:
        commands = [Command("M6", {"T": operation["tool"]}), Command("M3", {"S": operation["speed"]})]
        if "surfaceSpeed" in operation:
            words = {"S": operation["surfaceSpeed"], "D": operation["limit"]}
            commands.append(Command("G96", words))
        items.append(Item(f"TC {operation['tool']}", commands))
        commands, x, z = [Command("(OPERATION)"), Command("G18"), Command("G90")], None, None
        scale = operation["speed"] if operation["feedMode"] == "rev" else 1.0
        for kind, *values in operation["moves"]:
            if kind == "arc":
                clockwise, cx, cz, end_x, end_z, feed = values
                words = {"X": end_x, "Z": end_z, "I": cx - x, "K": cz - z, "F": feed * scale / 60}
                commands.append(Command("G2" if clockwise else "G3", words))
            else:
                end_x, end_z = values[0], values[1]
                words = {"X": end_x, "Z": end_z}
                if kind == "line":
                    words["F"] = values[2] * scale / 60
                commands.append(Command("G1" if kind == "line" else "G0", words))
            x, z = end_x, end_z
        items.append(Item(operation["comment"], commands))
    return items


def check(program, text, folder, name):
    """Checks a program; returns its moves."""
    path = folder / f"{name}.CNC"
    path.write_text(text, encoding="ascii")
    moves = folder / f"{name}.ndjson"
    words = [program, "check", str(path), "--part", "--json", "--moves", str(moves)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if "cannot be guessed" in done.stderr:
        # Nothing lies between the path and the axis.
        words.remove("--part")
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    # 3: a random path collides with its guessed stock.
    if done.returncode not in (0, 3):
        raise AssertionError(f"{name}: exit {done.returncode}\n{done.stdout}{done.stderr}\n{text}")
    return [json.loads(line) for line in moves.read_text().splitlines()]


def merged(moves):
    """Moves without those of no length."""
    out, x, z = [], *CHANGE
    for kind, to_x, to_z, centre in moves:
        far = math.hypot(to_x - x, to_z - z)
        if far > 0.0011 or centre:
            out.append((kind, to_x, to_z, centre))
        x, z = to_x, to_z
    return out


def joined(found, expected):
    """Moves in which a divided arc is its last piece."""
    out, rest = [], list(found)
    for kind, x, z, centre in expected:
        move = rest.pop(0) if rest else None
        while centre and rest and move["kind"] == kind and math.hypot(
                move["x"] - x, move["z"] - z) > NEAR:
            move = rest.pop(0)
        out += [move] if move else []
    return out + rest


def compare(expected, found, name, text):
    """Compares moves: kind, end and, of an arc by I and K, the centre."""
    found = [m for m in found if m["kind"] != "dwell"]
    expected = merged(expected)
    found = joined(found, expected)
    if len(found) != len(expected):
        raise AssertionError(f"{name}: {len(found)} moves instead of {len(expected)}\n{text}")
    for (kind, x, z, centre), move in zip(expected, found):
        values = [(move["x"], x), (move["z"], z)]
        if centre and not name.endswith("-r"):
            # I is rounded to a radius of 0.001 mm.
            values += [(move["cx"], centre[0]), (move["cz"], centre[1])]
        if move["kind"] != kind or any(abs(a - b) > NEAR for a, b in values):
            raise AssertionError(f"{name}: {move} instead of {kind} X{x} Z{z} {centre}\n{text}")


def main():
    """Runs random jobs through both posts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    spec = importlib.util.spec_from_file_location(
        "gsk980td_post", ROOT / "posts/freecad/gsk980td_post.py")
    post = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(post)
    folder = arguments.keep or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    count = 0
    for index in range(arguments.count):
        pick = random.Random(f"{arguments.seed} {index}")
        job, moves = random_job(pick)
        by_radius = pick.random() < 0.4
        end = "-r" if by_radius else ""
        is_rev = all(it["feedMode"] == "rev" for it in job["operations"])
        words = f"--number {job['number']}" + (" --arcs r" if by_radius else "")
        words += " --per-revolution" if is_rev else ""
        name = f"freecad{index}{end}"
        text = post.export(freecad_objects(job), str(folder / f"{name}.CNC"), words)
        compare(moves, check(arguments.program, text, folder, name), name, text)
        file = folder / "job.json"
        file.write_text(json.dumps(job))
        command = ["node", str(ROOT / "tests/oracles/post_engine.js")]
        command += [str(ROOT / "posts/fusion/gsk980td.cps"), str(file)]
        command += ["arcsByRadius=true"] if by_radius else []
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(done.stderr)
        name = f"fusion{index}{end}"
        compare(moves, check(arguments.program, done.stdout, folder, name), name, done.stdout)
        count += len(moves)
    print(f"{arguments.count} jobs, {count} moves through each post: equal")


if __name__ == "__main__":
    sys.exit(main())
