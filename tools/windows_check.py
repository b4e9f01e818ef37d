#!/usr/bin/env python3
"""Compares the program for Windows, under Wine, with the one for Linux.

    tools/windows_check.py LINUX_PROGRAM WINDOWS_PROGRAM [CASE ...]
    tools/windows_check.py --beside-random FOLDER

Every part program of the cases goes through `check`, `run` and `plot`, every script
through `operate`: exit code, standard output, standard error, moves and pictures must
be the same, byte for byte. A CASE is a part of a path, for instance `cycles/G71`.

Wine of Debian 12 lacks the library that Rust's random numbers come from; Windows has it.
The script builds a replacement with mingw and puts it beside a copy of the program;
`--beside-random` puts it into a folder for other programs.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT / "tests/cases"
MINGW = "x86_64-w64-mingw32-gcc"
RANDOM = """
#include <windows.h>
BOOLEAN NTAPI SystemFunction036(PVOID, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count) {
    return SystemFunction036(bytes, (ULONG)count);
}
"""
# Wine opens no dialog and prints no messages.
WINE = {"WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
# Limit of the machine time, for programs without an end.
LIMIT = "20m"
# Limits of `check` and `plot`: moves are the same on every computer, times are not.
ENDLESS = ["--most-moves", "100000", "--give-up", "1h"]
# Time limit of one command, s.
LONGEST = 60


def lay_random(folder):
    """Builds the replacement library in a folder."""
    source = folder / "random.c"
    source.write_text(RANDOM)
    library = folder / "bcryptprimitives.dll"
    subprocess.run([MINGW, "-shared", "-O1", "-o", library, source, "-ladvapi32"], check=True)


def commands(case):
    """Yields the command lines of a case with their output files; `OUT` is the output folder."""
    for program in sorted(case.glob("*.nc")):
        name = program.name
        yield ["check", *ENDLESS, "--json", "--moves", "OUT/moves", name], ["moves"]
        yield ["check", *ENDLESS, name], []
        yield ["run", "--json", "--limit", LIMIT, "--moves", "OUT/moves", name], ["moves"]
        yield ["plot", *ENDLESS, "--labels", name, "-o", "OUT/path.svg"], ["path.svg"]
        yield ["plot", *ENDLESS, name, "-o", "OUT/path.png"], ["path.png"]
    for script in sorted(case.glob("*.txt")):
        if script.name not in ("screen.txt", "sent.txt"):
            yield ["operate", script.name], []


def carried_out(program, arguments, files, folder):
    """Runs a command; returns exit code, output and files."""
    with tempfile.TemporaryDirectory() as out:
        line = [*program, *(word.replace("OUT", out) for word in arguments)]
        # Into files: background processes of Wine would keep a pipe open.
        said = {name: Path(out, name) for name in ("standard output", "standard error")}
        with said["standard output"].open("wb") as output, said["standard error"].open("wb") as error:
            try:
                done = subprocess.run(
                    line,
                    cwd=folder,
                    env=os.environ | WINE,
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=error,
                    timeout=LONGEST,
                )
            except subprocess.TimeoutExpired:
                return {"end": f"it did not end within {LONGEST} s"}
        left = {"exit code": done.returncode}
        left |= {name: path.read_bytes() for name, path in said.items()}
        for name in files:
            path = Path(out, name)
            left[name] = path.read_bytes() if path.exists() else None
        # Each system writes into a separate folder.
        return {
            key: value.replace(out.encode(), b"OUT") if isinstance(value, bytes) else value
            for key, value in left.items()
        }


def compared(programs, arguments, files, folder):
    """Lists the differences between the two systems, one per line."""
    linux = carried_out(programs[0], arguments, files, folder)
    # A command that waits forever does so on both systems.
    if "end" in linux:
        return []
    windows = carried_out(programs[1], arguments, files, folder)
    if windows != linux:
        # On a busy computer Wine loses one of thousands of processes now and then.
        print(f"again: {folder.relative_to(CASES)}: {' '.join(arguments)}", flush=True)
        windows = carried_out(programs[1], arguments, files, folder)
    place = f"{folder.relative_to(CASES)}: {' '.join(arguments)}"
    late = [f"{place}: {windows['end']}"] if "end" in windows else []
    return late or [
        f"{place}: {key}\n  Linux:   {linux[key]!r:.600}\n  Windows: {windows[key]!r:.600}"
        for key in linux
        if linux[key] != windows[key]
    ]


def main():
    linux, windows, *wanted = sys.argv[1:]
    if linux == "--beside-random":
        return lay_random(Path(windows))
    folders = sorted(path.parent for path in CASES.rglob("case.ron"))
    folders = [path for path in folders if not wanted or any(word in str(path) for word in wanted)]
    with tempfile.TemporaryDirectory() as folder:
        wine = shutil.which("wine") or sys.exit("wine is missing: apt-get install wine wine64")
        lay_random(Path(folder))
        programs = [[Path(linux).resolve()], [wine, shutil.copy(windows, folder)]]
        # A first run alone: Wine creates its folder.
        carried_out(programs[1], ["--version"], [], ROOT)
        jobs = [(programs, *command, folder) for folder in folders for command in commands(folder)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            faults = []
            for found in pool.map(lambda job: compared(*job), jobs):
                faults += found
                # Print each one at once: the run takes minutes.
                print("\n".join(found), end="\n" if found else "", flush=True)
    print(f"{len(folders)} cases, {len(jobs)} commands, {len(faults)} differences")
    sys.exit(bool(faults) or not jobs)


if __name__ == "__main__":
    main()
