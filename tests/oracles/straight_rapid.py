#!/usr/bin/env python3
"""Straight rapids of the NC-B08, millisecond by millisecond, against their definition.

A rapid is a straight line; its speed goes from 0 to the rate and back by a smooth step
v = r (3u² - 2u³), each in the time r / a, where r is what the slower axis allows along
the line and a two thirds of what the weaker axis allows. The positions that `run
--positions` writes are held against that, worked out here by numpy.

    tests/oracles/straight_rapid.py target/release/gsk980td --moves 200
"""
import argparse
import pathlib
import random
import subprocess
import tempfile

import numpy as np

RATE = {"x": 3800 / 60, "z": 7600 / 60}  # 022, 023: mm/s of the slides
TIME = 0.3  # 024, 025: s to that rate
LIMIT = 15000 / 60  # P17
TICK = 0.001


def way(length, rate, mean, t):
    """Millimetres along the line after t seconds."""
    peak = min(rate, np.sqrt(mean * length))
    span = peak / mean
    cruise = (length - peak * span) / peak
    t = np.clip(t, 0, 2 * span + cruise)
    step = lambda u: u**3 - u**4 / 2
    up = peak * span * step(np.clip(t / span, 0, 1))
    flat = peak * np.clip(t - span, 0, cruise)
    u = np.clip((t - span - cruise) / span, 0, 1)
    down = peak * span * (u - step(u))
    return up + flat + down


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--moves", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    rng = random.Random(args.seed)
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for number in range(args.moves):
            size = 10 ** rng.uniform(-2, 2)
            x = round(rng.uniform(-1, 1) * size, 3)
            z = round(rng.uniform(-1, 1) * size, 3)
            if rng.random() < 0.1:
                x = 0.0
            if (x, z) == (0.0, 0.0):
                continue
            part, table = folder / "a.nc", folder / "a.csv"
            part.write_text(f"O0001;\nG04 X0.1;\nG00 U{x:.3f} W{z:.3f};\nG04 X0.1;\nM2;\n")
            command = [args.program, "run", part, "--model", "ncb08", "--positions", table]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            rows = np.genfromtxt(table, delimiter=",", skip_header=1)
            dx, dz = (rows[:, 1] - rows[0, 1]) / 2, rows[:, 2] - rows[0, 2]
            target = np.array([x / 2, z])
            length = np.hypot(*target)
            share = np.abs(target) / length
            allowed = lambda per: min(v / s for v, s in zip(per, share) if s > 0)
            rate = min(allowed((RATE["x"], RATE["z"])), LIMIT)
            mean = allowed((RATE["x"] / TIME, RATE["z"] / TIME)) / 1.5
            along = (dx * target[0] + dz * target[1]) / length
            across = np.abs(dx * target[1] - dz * target[0]) / length
            first = int(np.argmax(np.hypot(dx, dz) > 0))
            # Within which part of its first tick the move began is not in the table.
            times = (np.arange(len(along)) - first + 1) * TICK
            offs = np.linspace(0, TICK, 101)
            gaps = [np.max(np.abs(along - way(length, rate, mean, times - off))) for off in offs]
            gap = max(min(gaps), float(np.max(across)))
            worst = max(worst, gap)
            if gap > 0.002:
                raise SystemExit(f"U{x} W{z}: {gap * 1000:.2f} µm off")
    print(f"{args.moves} rapids, {worst * 1000:.2f} µm off at most")


if __name__ == "__main__":
    main()
