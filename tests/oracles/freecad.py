#!/usr/bin/env python3
"""The FreeCAD post in the real FreeCAD: programs against the commands of the exported objects.

    tests/oracles/freecad.py target/debug/gsk980td [--liblathe DIR] [--count 40] [--keep DIR]

Needs FreeCAD 0.20 (`freecadcmd`) and numpy. `freecad_jobs.py` makes jobs in FreeCAD's console
program: turning, boring, grooving, arcs, FreeCAD's own drilling, several tools in the three
orders, a job in inches, an empty job, random jobs, and what the control cannot do. DIR of
`--liblathe` has the package `liblathe` (`pip install --target DIR liblathe`), the planner of
FreeCAD's turning add-on; without it three jobs are left out. FreeCAD finds the post in its macro
folder and exports as *Post Process* does. This script reads the commands on its own: X a radius,
F in mm/s. The moves of `check --moves` must be the same within 0.001 mm, arcs along their whole
length; feed, tool, spindle and coolant must be those of each cut. Refused jobs must name the
operation and the reason, and leave no file. FreeCAD reads exported drills and saves
them, and the library reads them back; its own shapes have no inserts.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NEAR = 0.001
CUTS = {"G1": "feed", "G01": "feed", "G2": "cw", "G02": "cw", "G3": "ccw", "G03": "ccw"}
# The post writes an arc with a shorter chord as a line.
SHORT_CHORD = 0.003
DRILLS = ("drill 8.5", "drill 12 point=140", "drill 6.35 point=118")
INSERTS = ("CNMG 120408 PCLNR 2020K12", "groove 3", "thread 60")


def expected_moves(record):
    """The moves of the commands: kind, start, end and centre as radii, state of the machine."""
    words = record["arguments"].split()
    scale = 0.5 if "--diameter" in words else 1.0
    change = [float(words[words.index(it) + 1]) if it in words else 100.0
              for it in ("--change-x", "--change-z")]
    change = np.array([change[0] / 2.0, change[1]])
    position, moves = change.copy(), []
    state = {"tool": None, "direction": None, "speed": None, "coolant": False}
    feed, rpm, mode = None, 0.0, "G97"
    for item in record["items"]:
        if not item["active"]:
            continue
        incremental, by_turn, to_level = False, False, False
        flood = item["coolant"] in ("Flood", "Mist")
        state["coolant"] = flood or state["coolant"]
        for name, words_of in item["commands"]:
            is_cut = name in CUTS or name in ("G73", "G81", "G82", "G83")
            if is_cut and "F" in words_of:
                feed = words_of["F"] * 60.0
            end = position.copy()
            for axis, (letter, factor) in enumerate((("X", scale), ("Z", 1.0))):
                if letter in words_of:
                    value = words_of[letter] * factor
                    end[axis] = position[axis] + value if incremental else value
            move = {"start": position, "end": end, "state": dict(state), "feed": feed,
                    "per": "rev" if by_turn else "min", "centre": None, "name": name}
            if "--per-revolution" in words and feed and not by_turn:
                move["per"], move["feed"] = "rev", feed / rpm if rpm else None
            if name in ("G0", "G00"):
                if item["is_zero"] and state["tool"] is None:
                    continue
                moves.append({**move, "kind": "rapid"})
                position = end
            elif name in CUTS:
                if CUTS[name] != "feed":
                    move["centre"] = position + [words_of.get("I", 0.0), words_of.get("K", 0.0)]
                moves.append({**move, "kind": CUTS[name]})
                position = end
            elif name == "G33":
                moves.append({**move, "kind": "thread", "feed": words_of["K"], "per": None})
                position = end
            elif is_cut:
                level = words_of["R"]
                move["hole"] = (words_of["Z"], level, words_of.get("Q", 0.0))
                move["end"] = np.array([end[0], level if to_level else max(level, position[1])])
                moves.append({**move, "kind": "hole"})
                position = move["end"]
            elif name == "M6":
                moves.append({**move, "kind": "rapid", "end": change})
                state.update(tool=int(words_of["T"]), direction=None)
                mode = "G97"
                position = change.copy()
            elif name in ("M3", "M4"):
                state["direction"] = name
                if "S" in words_of:
                    # After G96, S is a surface speed, until the next tool.
                    state["speed"] = (mode, words_of["S"])
                    rpm = words_of["S"] if mode == "G97" else rpm
            elif name == "M5":
                state["direction"] = None
            elif name in ("G96", "G97"):
                mode, state["speed"] = name, (name, words_of["S"])
                rpm = words_of["S"] if name == "G97" else rpm
            elif name in ("M7", "M8"):
                state["coolant"] = True
            elif name == "M9":
                state["coolant"] = False
            elif name in ("G90", "G91"):
                incremental = name == "G91"
            elif name in ("G94", "G95"):
                by_turn = name == "G95"
            elif name in ("G98", "G99"):
                to_level = name == "G99"
        state["coolant"] = state["coolant"] and not flood
    moves.append({"kind": "rapid", "start": position, "end": change, "centre": None,
                  "name": "end"})
    return moves


def machine_states(text):
    """The state at each line of a program: tool, direction, speed, coolant."""
    states, state = [None], {"tool": None, "direction": None, "speed": None, "coolant": False}
    code = "G97"
    for line in text.splitlines():
        words = re.findall(r"([A-Z])(-?[\d.]+)", re.sub(r"\(.*?\)", "", line))
        for letter, value in words:
            if letter == "G" and value in ("96", "97", "50"):
                code = "G" + value
            elif letter == "S" and code != "G50":
                state["speed"] = (code, float(value))
            elif letter == "T":
                state["tool"] = int(value[:2])
            elif letter == "M" and value in ("03", "04", "05"):
                state["direction"] = {"03": "M3", "04": "M4", "05": None}[value]
            elif letter == "M" and value in ("08", "09"):
                state["coolant"] = value == "08"
        states.append(dict(state))
    return states


def fail(record, what):
    """Stops with the name of the job."""
    raise AssertionError(f"{record['name']}: {what}")


def arc_points(move):
    """Points along an arc of the control, as radii."""
    centre = np.array([move["cx"] / 2.0, move["cz"]])
    ends = [np.array([move["x0"] / 2.0, move["z0"]]), np.array([move["x"] / 2.0, move["z"]])]
    angles = [np.arctan2(*(it - centre)) for it in ends]
    radii = [np.hypot(*(it - centre)) for it in ends]
    turn = 1.0 if move["kind"] == "ccw" else -1.0
    sweep = (turn * (angles[1] - angles[0])) % (2.0 * np.pi) or 2.0 * np.pi
    part = np.linspace(0.0, 1.0, 91)
    angle, radius = angles[0] + turn * sweep * part, radii[0] + (radii[1] - radii[0]) * part
    return centre + np.stack([radius * np.sin(angle), radius * np.cos(angle)], axis=1), sweep


def check_hole(record, move, found):
    """Moves of a hole: never a rapid into material, pecks of at most Q, the bottom is reached."""
    bottom, level, peck = move["hole"]
    deepest = level
    for piece in found:
        if abs(piece["x"]) > NEAR:
            fail(record, f"hole off the axis: {piece}")
        if piece["kind"] == "rapid" and piece["z"] < deepest - NEAR:
            fail(record, f"rapid into material: {piece}")
        if piece["kind"] == "feed":
            if peck and deepest - piece["z"] > peck + NEAR:
                fail(record, f"peck too deep: {piece}")
            deepest = min(deepest, piece["z"])
            check_feed(record, move, piece)
    if abs(deepest - bottom) > NEAR:
        fail(record, f"the hole ends at {deepest}, not at {bottom}")


def check_feed(record, move, piece):
    """The feed of a move."""
    if move["kind"] == "thread":
        near = abs(piece["lead"] - move["feed"]) < 0.0006
    else:
        step = 0.00006 if move["per"] == "rev" else 0.0006
        near = piece["per"] == move["per"] and abs(piece["feed"] - move["feed"]) < step
    if not near:
        fail(record, f"{piece} instead of F{move['feed']} per {move['per']}")


def compare(record, found, text):
    """Compares the moves; returns their number and the greatest distance of their paths."""
    states, found = machine_states(text), [it for it in found if it["kind"] != "dwell"]
    greatest, count, place = 0.0, 0, 0
    written = None
    for move in expected_moves(record):
        end = np.round([2.0 * move["end"][0], move["end"][1]], 3)
        start = written if written is not None else np.round(
            [2.0 * move["start"][0], move["start"][1]], 3)
        chord = np.hypot(*(move["end"] - move["start"]))
        written = end
        if move["kind"] == "hole":
            last = place
            while last < len(found) and abs(found[last]["x"]) < NEAR and (
                    last == place or abs(found[last - 1]["z"] - move["end"][1]) > NEAR
                    or not any(abs(it["z"] - move["hole"][0]) < NEAR
                               for it in found[place:last])):
                last += 1
            check_hole(record, move, found[place:last])
            for piece in found[place:last]:
                if piece["kind"] == "feed":
                    check_state(record, move, states[piece["line"]])
            place, count = last, count + 1
            continue
        is_arc = move["centre"] is not None and chord >= SHORT_CHORD
        if not is_arc and np.allclose(start, end, atol=1e-9):
            continue
        kind = move["kind"] if is_arc or move["centre"] is None else "feed"
        swept = 0.0
        while True:
            if place >= len(found):
                fail(record, f"move {move['name']} to {end} is missing")
            piece = found[place]
            place += 1
            if piece["kind"] != kind:
                fail(record, f"{piece} instead of {kind} to {end}")
            if is_arc:
                points, sweep = arc_points(piece)
                swept += sweep
                radius = np.hypot(*(move["start"] - move["centre"]))
                offsets = np.hypot(*(points - move["centre"]).T) - radius
                greatest = max(greatest, np.abs(offsets).max())
            if kind not in ("rapid",):
                check_feed(record, move, piece)
                check_state(record, move, states[piece["line"]])
            distance = np.hypot((piece["x"] - 2.0 * move["end"][0]) / 2.0,
                                piece["z"] - move["end"][1])
            if not is_arc or distance < NEAR or swept > 2.0 * np.pi + 0.1:
                break
        greatest = max(greatest, distance)
        if is_arc:
            turn = 1.0 if kind == "ccw" else -1.0
            angles = [np.arctan2(*(it - move["centre"])) for it in (move["start"], move["end"])]
            wanted = (turn * (angles[1] - angles[0])) % (2.0 * np.pi)
            if abs(swept - wanted) * radius > 0.01:
                fail(record, f"an arc of {np.degrees(swept)}° instead of {np.degrees(wanted)}°")
        count += 1
    if place != len(found):
        fail(record, f"{len(found) - place} moves too many, {found[place]}")
    return count, greatest


def check_state(record, move, state):
    """Tool, spindle and coolant of a cut."""
    expected = dict(move["state"])
    if expected["direction"] is None:
        expected["speed"] = state["speed"]
    elif expected["speed"]:
        expected["speed"] = (expected["speed"][0], float(round(expected["speed"][1])))
    if expected != state:
        fail(record, f"{state} instead of {expected} in {move['name']} to {move['end']}")


def check_program(program, record, out):
    """A program through `check`; returns the number of moves and the greatest distance."""
    file = out / f"{record['name']}.CNC"
    moves = out / f"{record['name']}.ndjson"
    done = subprocess.run([program, "check", str(file), "--json", "--moves", str(moves),
                           "--param", "84=32"],
                          capture_output=True, text=True, check=False)
    if done.returncode:
        fail(record, f"check: {done.returncode}\n{done.stdout}{done.stderr}")
    found = [json.loads(line) for line in moves.read_text().splitlines()]
    return compare(record, found, file.read_text(encoding="ascii"))


def check_refusal(record, out):
    """An error of the post with all words, and no file."""
    kind, message = record["error"] or (None, "")
    if kind != "PostError" or not all(it in message for it in record["refused"]):
        fail(record, f"refused with {kind}: {message}, without {record['refused']}")
    if (out / f"{record['name']}.CNC").exists():
        fail(record, "a refused job leaves a file")


def run(*words):
    """Runs a command, which must succeed."""
    done = subprocess.run([str(it) for it in words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def export_tools(program, out, data):
    """Exports drills and inserts for FreeCAD."""
    for index, text in enumerate((*DRILLS, *INSERTS), 1):
        run(program, "tools", "add", *text.split(), "--id", f"t{index}", "--station", index,
            "--data", data)
    (out / "tools/Library").mkdir(parents=True)
    run(program, "tools", "export", out / "tools/Library/shop.fctl", "--data", data)


def check_tools(program, out, data, again):
    """The drills that FreeCAD has saved, against those that were exported."""
    inserts = [f"t{len(DRILLS) + it}" for it in range(1, len(INSERTS) + 1)]
    if (out / "tools/refused").read_text().split():
        raise AssertionError(f"FreeCAD refuses {(out / 'tools/refused').read_text()}")
    # FreeCAD drops the attributes of inserts when it saves them.
    library = json.loads((out / "tools/Library/shop.fctl").read_text())
    library["tools"] = [it for it in library["tools"] if it["path"][:-5] not in inserts]
    (out / "saved/Library").mkdir()
    (out / "saved/Library/shop.fctl").write_text(json.dumps(library))
    run(program, "tools", "import", out / "saved/Library/shop.fctl", "--data", again)
    tables = [run(program, "tools", "export", "-", "--format", "csv", "--data", it).splitlines()
              for it in (data, again)]
    # FreeCAD keeps dimensions and drops the attribute with the code.
    rows = [[row.split(",") for row in table[1:]] for table in tables]
    drills = [[(row[0], *row[3:5]) for row in it if row[0] not in inserts] for it in rows]
    if len(drills[0]) != len(DRILLS) or drills[0] != drills[1]:
        raise AssertionError(f"{drills[0]}\n{drills[1]}")


def main():
    """Lets FreeCAD export the jobs, and compares them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--freecadcmd", default="freecadcmd")
    parser.add_argument("--liblathe", type=Path)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    out = arguments.keep or Path(tempfile.mkdtemp())
    out.mkdir(parents=True, exist_ok=True)
    if any(out.iterdir()):
        parser.error(f"{out} is not empty")
    with tempfile.TemporaryDirectory() as home:
        settings = Path(home) / "jobs.json"
        export_tools(arguments.program, out, Path(home) / "tools")
        settings.write_text(json.dumps({
            "out": str(out.resolve()), "post": str(ROOT / "posts/freecad/gsk980td_post.py"),
            "count": arguments.count, "seed": arguments.seed,
            "liblathe": str(arguments.liblathe.resolve()) if arguments.liblathe else None}))
        # FreeCAD 0.20 takes its macro folder and its preferences from HOME alone.
        environment = {it: value for it, value in os.environ.items() if not it.startswith("XDG_")}
        environment |= {"FREECAD_JOBS": str(settings), "FREECAD_USER_HOME": home, "HOME": home}
        subprocess.run([arguments.freecadcmd, str(ROOT / "tests/oracles/freecad_jobs.py")],
                       env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, check=False)
        if not (out / "done").exists():
            failure = out / "failure"
            raise AssertionError(failure.read_text() if failure.exists() else "FreeCAD has ended")
        check_tools(arguments.program, out, Path(home) / "tools", Path(home) / "again")
    programs, refused, moves, greatest = 0, 0, 0, 0.0
    for file in sorted(out.glob("*.json")):
        record = json.loads(file.read_text())
        if record.get("refused"):
            check_refusal(record, out)
            refused += 1
            continue
        if record["error"] or not record.get("same", True):
            fail(record, record["error"] or "file and result of the export differ")
        count, distance = check_program(arguments.program, record, out)
        text = (out / f"{record['name']}.CNC").read_text()
        for line in record.get("lines", []):
            if not any(it.endswith(line) for it in text.splitlines()):
                fail(record, f"without {line}")
        programs, moves, greatest = programs + 1, moves + count, max(greatest, distance)
        if greatest > NEAR:
            fail(record, f"the path is {distance} mm away")
        if (record.get("note") or "").startswith("equals"):
            other = out / f"{record['note'].split()[1]}.CNC"
            if other.read_text() != text:
                fail(record, f"differs from {other.name}")
    version = ".".join((out / "done").read_text().split())
    print(f"FreeCAD {version}: {programs} programs, {moves} moves, at most {greatest:.5f} mm "
          f"away; {refused} jobs refused; {len(DRILLS)} drills read and saved")


if __name__ == "__main__":
    sys.exit(main())
