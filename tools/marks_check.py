#!/usr/bin/env python3
"""Compares marks and replays of the program for Windows, under Wine, with those of Linux.

    tools/marks_check.py LINUX_PROGRAM WINDOWS_PROGRAM [EXERCISE ...]

Linux solves every exercise that comes with the program with all scripts of its folder. Both
programs mark the results and replay their recordings; tables and outputs must be the same,
byte for byte. Windows solves each reference again: its result must have the same bytes. The
script prints a hash for each file. `tools/page_check.py` compares browsers in the same way.
An EXERCISE is a part of a name, for instance `f0`.
"""

import hashlib
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import windows_check

ROOT = Path(__file__).resolve().parent.parent
EXERCISES = ROOT / "assets/exercises"
MAGIC = b"GSK980TD exercise result 1\n"


def scripts(wanted):
    """The scripts of the exercises whose names contain a word of `wanted`, or of all."""
    found = sorted(EXERCISES.glob("*/*.txt"))
    return [path for path in found if not wanted or any(word in path.parent.name for word in wanted)]


def solve(program, script, data, folder):
    """Solves an exercise with a script; returns the path of the result."""
    exercise = script.parent.name
    result = folder / f"{exercise}.{script.stem}.gskresult"
    command = [*program, "exercise", "solve", exercise, "--script", script, "-o", result]
    # The name is in the file and part of its seal.
    command += ["--learner", script.stem, "--data", data]
    environment = os.environ | windows_check.WINE
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    return result


def recording(result):
    """The recording in a result: head with the length of the recording, recording, seal."""
    rest = result.removeprefix(MAGIC)
    length = struct.unpack_from("<I", rest)[0]
    packed = rest[4 + length :][: json.loads(rest[4 : 4 + length])["recording_bytes"]]
    return zlib.decompress(packed, -zlib.MAX_WBITS)


def solve_all(program, folder, wanted, pool):
    """Solves exercises; returns the results with a recording beside each."""
    folder.mkdir()
    data = folder / "data"
    chosen = scripts(wanted)
    if not chosen:
        sys.exit(f"no exercise is named {' '.join(wanted)}")
    # The first one makes the key that seals all.
    results = [solve(program, chosen[0], data, folder)]
    results += pool.map(lambda script: solve(program, script, data, folder), chosen[1:])
    for result in results:
        result.with_suffix(".gskrec").write_bytes(recording(result.read_bytes()))
    return results


def hash_text(value):
    text = value if isinstance(value, str) else json.dumps(value, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def hash_mark(mark):
    """The hash of a mark without the number of the key, which is made for each run."""
    return hash_text({name: value for name, value in mark.items() if name != "key"})


def run(program, arguments, folder):
    """Runs a command; returns exit code and standard output."""
    output = folder / f"output-{hash_text(str(arguments))}"
    # Into a file: background processes of Wine would keep a pipe open.
    with output.open("wb") as stream:
        environment = os.environ | windows_check.WINE
        done = subprocess.run([*program, *arguments], stdout=stream, stderr=subprocess.DEVNULL, env=environment)
    text = output.read_bytes()
    output.unlink()
    return done.returncode, text


def compare(what, linux, windows):
    if linux != windows:
        raise SystemExit(f"{what} differs\n  Linux:   {linux!r:.2000}\n  Windows: {windows!r:.2000}")


def main():
    linux, windows, *wanted = sys.argv[1:]
    wine = shutil.which("wine") or sys.exit("wine is missing: apt-get install wine wine64")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        folder = Path(folder)
        windows_check.lay_random(folder)
        programs = [[Path(linux).resolve()], [wine, shutil.copy(windows, folder)]]
        results = solve_all(programs[0], folder / "linux", wanted, pool)
        table = ["exercise", "mark", folder / "linux", "--format", "json", "--lang", "en"]
        marks = [run(program, table, folder) for program in programs]
        compare("the table of marks", *marks)
        code, text = marks[0]
        if code != 0:
            raise SystemExit(f"a mark is flagged:\n{text.decode()}")
        marks = {mark["file"]: mark for mark in json.loads(text)}
        for result in results:
            name = result.with_suffix(".gskrec")
            replays = [run(program, ["replay", name, "--lang", "en"], folder) for program in programs]
            compare(f"the replay of {name.name}", *replays)
            if replays[0][0] != 0:
                raise SystemExit(f"{name.name}: {replays[0][1].decode()}")
            mark = marks[result.name]
            print(
                f"{result.stem}: {mark['points']}/{mark['max']} points, mark {hash_mark(mark)},"
                f" replay {hash_text(replays[0][1].decode())}"
            )
        (folder / "windows").mkdir()
        again = [path for path in scripts(wanted) if path.stem == "reference"]
        data = folder / "linux/data"
        for script in again:
            made = solve(programs[1], script, data, folder / "windows")
            same = (folder / "linux" / made.name).read_bytes() == made.read_bytes()
            compare(f"the result {made.name} made by Windows", same, True)
    print(f"{len(results)} marks and replays are those of Linux; {len(again)} results made by Windows are equal")


if __name__ == "__main__":
    main()
