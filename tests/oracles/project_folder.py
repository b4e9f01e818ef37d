#!/usr/bin/env python3
"""A project read by its description, `docs/project.md`, without our code.

A new project is changed line by line at random, as somebody with an editor would, taken
over into a data folder and exported again. This script reads all folders by itself; what
it finds must be what it wrote, the factory values those of `parameters --json`, and the
differences it works out those of `project diff --format json`, bit for bit.

    cargo build --release
    tests/oracles/project_folder.py [target/release/gsk980td] [rounds]
"""

import json
import random
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
TABLES = ["project.gpr", "parameters.txt", "offsets.txt", "pitch.txt", "variables.txt",
          "counters.txt", "ladder/data.txt"]
TEXTS = ["ladder/main.il"]


def run(program, *arguments, codes=(0,)):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True)
    if done.returncode not in codes:
        raise SystemExit(f"{arguments}: exit code {done.returncode}\n{done.stderr.decode()}")
    return done.stdout.decode()


def bits(text):
    """A value as it is compared: on, off, none, O0001, a whole number, or 64 bits."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return struct.pack("<d", float(text))
    except ValueError:
        return text


def table(path):
    values = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        line = line.split(";")[0].strip()
        if line:
            name, value = (part.strip() for part in line.split("=", 1))
            assert name not in values, f"{path}: {name} twice"
            values[name] = value
    return values


def read(folder):
    """(file, name) -> the text of a value; of a text file its bytes."""
    everything = {}
    for name in TABLES + ["panel.txt"]:
        if (folder / name).exists():
            everything.update({(name, key): value for key, value in table(folder / name).items()})
    for path in [*sorted((folder / "programs").glob("*.CNC")), *(folder / name for name in TEXTS)]:
        name = path.relative_to(folder).as_posix()
        everything[name, name] = path.read_bytes()
    return everything


def change(folder, ranges, numbers):
    """Changes some lines, as an editor does: the lines stay where they are."""
    for name in ["parameters.txt", "offsets.txt", "pitch.txt", "variables.txt", "ladder/data.txt", "counters.txt"]:
        lines = (folder / name).read_text(encoding="utf-8").splitlines()
        for at in numbers.sample(range(1, len(lines)), min(15, len(lines) - 1)):
            key = lines[at].split("=")[0].strip()
            if name == "parameters.txt":
                value = numbers.randint(0, 1) if "." in key else numbers.choice(ranges[int(key)])
            elif name == "offsets.txt":
                value = numbers.randint(0, 9) if key.endswith("T") else numbers.randint(-9999999, 9999999) / 1000
                value = 0 if key.startswith("000") else value
            elif name == "pitch.txt":
                value = numbers.randint(-255, 255)
            elif name == "variables.txt":
                value = numbers.choice([numbers.randint(-2**32, 2**32 - 1), numbers.uniform(-9e8, 9e8)])
            elif name == "counters.txt":
                value = numbers.randint(0, 9999)
            else:
                value = numbers.randint(0, 255) if key[0] in "K" or (key[0] == "D" and key[1].isdigit()) else numbers.randint(-2**31, 2**31 - 1)
            lines[at] = f"{key} = {value!r} ; by hand"
        if name == "variables.txt":
            there = {line.split("=")[0].strip() for line in lines}
            for number in numbers.sample([it for it in range(516, 1000) if f"#{it}" not in there], 8):
                real = struct.unpack("<d", numbers.randbytes(8))[0]
                if real == real and abs(real) != float("inf"):
                    lines.append(f"#{number} = {real!r}")
        (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "programs").mkdir(exist_ok=True)
    number = numbers.randint(1, 8999)
    text = f"O{number:04} (车削 {numbers.random()})\r\nG00 X{numbers.randint(1, 99)}\r\nM30\r\n"
    (folder / f"programs/O{number:04}.CNC").write_bytes(text.encode("gb18030"))
    head = (folder / "project.gpr").read_text(encoding="utf-8")
    (folder / "project.gpr").write_text(head.replace("selected = none", f"selected = O{number:04}"), encoding="utf-8")


def spread(text):
    """Values of a range as the table prints it."""
    if "|" in text:
        return [int(value) for value in text.split("|")]
    low, high = (int(value) for value in text.split(".."))
    return [low, high, (low + high) // 2, low + (high - low) // 3]


def compared(before, after):
    """What differs, as `diff` has to list it."""
    found = {}
    for key in before.keys() | after.keys():
        # A folder without panel.txt says nothing of the panel.
        if key[0] == "panel.txt" and not any(file == "panel.txt" for file, _ in after):
            continue
        old, new = (bits(side[key]) if isinstance(side.get(key), str) else side.get(key) for side in (before, after))
        if old != new:
            found[key] = (old, new)
    return found


def listed(rows):
    def value(of):
        if isinstance(of, bool):
            return "on" if of else "off"
        if isinstance(of, float):
            return int(of) if of == int(of) and abs(of) < 1e15 else struct.pack("<d", of)
        return of

    return {(row["file"], row["name"]): (value(row["old"]), value(row["new"])) for row in rows}


def normal(pair, is_text):
    """Whole numbers as they are, others by their bits; of a text only whether it is there."""
    if is_text:
        return tuple(side is not None for side in pair)
    whole = []
    for side in pair:
        if isinstance(side, bytes):
            real = struct.unpack("<d", side)[0]
            side = int(real) if real == int(real) and abs(real) < 2**53 else side
        whole.append(side)
    return tuple(whole)


def main():
    program = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    rows = json.loads(run(program, "parameters", "--json"))
    wrong, values, differing = 0, 0, 0
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        run(program, "project", "new", scratch / "new", "--lang", "zh")
        found = table(scratch / "new/parameters.txt")
        state = {int(name.split(".")[0]) for name in found if "." in name}
        # The training lathe differs from the factory's values in what is fitted to it.
        fitted = {name for name in found if int(name.split(".")[0]) in (1, 164)}
        for row in rows:
            number, bit = row["number"], row["bit"]
            if number in state and bit is None:
                continue
            name = f"{number:03}" if bit is None else f"{number:03}.{bit}"
            if name not in fitted and int(found[name]) != row["factory"]:
                print("not the factory value:", name, found[name], row["factory"])
                wrong += 1
        ranges = {row["number"]: spread(row["range"]) for row in rows if row["bit"] is None and row["number"] not in state}
        for seed in range(rounds):
            numbers = random.Random(seed)
            base, hand, data, back = (scratch / f"{seed}{name}" for name in ("base", "hand", "data", "back"))
            shutil.copytree(scratch / "new", base)
            change(base, ranges, numbers)
            shutil.copytree(base, hand)
            shutil.rmtree(hand / "programs")
            (hand / "project.gpr").write_bytes((scratch / "new/project.gpr").read_bytes())
            change(hand, ranges, numbers)
            # What is exported is what was written by hand.
            run(program, "project", "import", hand, "--data", data)
            run(program, "project", "export", back, "--data", data)
            for key, pair in compared(read(hand), read(back)).items():
                pair = normal(pair, False)
                if pair[0] != pair[1]:
                    print(f"round {seed}:", key, pair)
                    wrong += 1
            said = json.loads(run(program, "project", "diff", base, data, "--format", "json", codes=(0, 1)))
            own, theirs = compared(read(base), read(hand)), listed(said)
            texts = {key for key in own.keys() | theirs.keys() if key[0] == key[1]}
            own = {key: normal(pair, key in texts) for key, pair in own.items()}
            own = {key: pair for key, pair in own.items() if key in texts or pair[0] != pair[1]}
            theirs = {key: normal(pair, key in texts) for key, pair in theirs.items()}
            values, differing = values + len(read(back)), differing + len(own)
            for key in sorted(own.keys() | theirs.keys()):
                if own.get(key) != theirs.get(key):
                    print(f"round {seed}:", key, own.get(key), theirs.get(key))
                    wrong += 1
    print(f"{rounds} rounds, {values} values read, {differing} differ as they must; wrong: {wrong}")
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main())
