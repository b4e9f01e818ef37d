#!/usr/bin/env python3
"""Traces read by programs nobody here wrote: MCAP by `mcap`, VCD by `vcdvcd`.

Each sample runs once for each format. The values of MCAP and VCD must be those of the CSV, tick by
tick, and those of XM, ZM and the angle must be the ones that `--positions` gives.

    pip install mcap vcdvcd
    cargo build --release
    tests/oracles/traces.py [target/release/gsk980td]
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from mcap.reader import make_reader
from vcdvcd import VCDVCD

ROOT = Path(__file__).resolve().parent.parent.parent
SIGNALS = ["XM", "ZM", "X", "Z", "feed", "spindle", "angle", "line", "Y1.2", "Y5.0", "F0.5", "R100"]
SAMPLES = sorted((ROOT / "assets/programs").glob("*.CNC"))[:3]


def run(program, sample, *options):
    command = [program, "run", str(sample), "--spindle", "800", "--limit", "20s", "--lang", "en", *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{command}: exit code {done.returncode}\n{done.stderr}")


def read_csv(path):
    with open(path, newline="") as file:
        return [[float(value) if value else None for value in row] for row in list(csv.reader(file))[1:]]


def read_mcap(path):
    """The rows of a trace: time, then the values in the order of SIGNALS."""
    rows = {}
    with open(path, "rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            value = json.loads(message.data)["value"]
            rows.setdefault(message.log_time, {})[channel.topic[1:]] = value
    return [[time / 1e9, *(row[name] for name in SIGNALS)] for time, row in sorted(rows.items())]


def read_vcd(path, times_ms):
    vcd = VCDVCD(str(path))
    signals = [vcd[f"gsk980td.{name}"] for name in SIGNALS]
    columns = []
    for signal in signals:
        changes, values, last = dict(signal.tv), [], None
        for time in times_ms:
            last = changes.get(time, last)
            values.append(float(last))
        columns.append(values)
    return [list(row) for row in zip(*columns)]


def main():
    program = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
    faults = compared = 0
    for sample in SAMPLES:
        with tempfile.TemporaryDirectory() as folder:
            file = lambda ending: Path(folder) / f"trace.{ending}"
            names = ",".join(SIGNALS)
            positions = Path(folder) / "positions.txt"
            run(program, sample, "--trace", str(file("csv")), "--signals", names, "--positions", str(positions))
            run(program, sample, "--trace", str(file("mcap")), "--signals", names)
            run(program, sample, "--trace", str(file("vcd")), "--signals", names)
            rows = read_csv(file("csv"))
            times_ms = [round(row[0] * 1000) for row in rows]
            others = {"mcap": read_mcap(file("mcap")), "vcd": read_vcd(file("vcd"), times_ms)}
            faults += [round(row[0] * 1000) for row in others["mcap"]] != times_ms
            for row, mcap, vcd in zip(rows, *others.values()):
                compared += len(SIGNALS)
                faults += row[1:] != mcap[1:]
                faults += row[1:] != vcd
            for row, place in zip(rows, read_csv(positions)):
                near = [abs(a - b) for a, b in zip((row[0], row[1], row[2], row[7]), place)]
                faults += max(near) > 0.0006
                compared += 4
            print(f"{sample.name}: {len(rows)} ticks")
    print(f"{compared} values compared, {faults} faults")
    sys.exit(faults > 0 or compared == 0)


if __name__ == "__main__":
    main()
