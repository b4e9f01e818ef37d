#!/usr/bin/env python3
"""The curve and the backlash of `pitch import` against numpy's least squares.

Random screws, targets, runs and gaps in them are written as CSV; the matrix of the model
(straight from knot to knot, the play where a target was approached towards minus) is made
here anew and solved by `numpy.linalg.lstsq`. Curve, backlash, residual and slope must be the
same, and the deviation left by the proposed table, worked out here from its points by the
rule of the manual (III-10), must be no more than the program says.

    tests/oracles/pitch_fit.py target/release/gsk980td --screws 100
"""
import argparse
import json
import pathlib
import random
import subprocess
import tempfile

import numpy as np


def screw(dice):
    """Readings of a random screw: run, direction, target, deviation."""
    step = dice.choice([5.0, 10.0, 12.5, 20.0])
    low, high = dice.choice([(-480, 0), (-300, 50), (0, 250), (-120, -20)])
    slope = dice.uniform(-0.03, 0.03)
    wave, period = dice.uniform(0, 6), dice.uniform(120, 300)
    play = dice.uniform(0, 60)
    targets = np.arange(low, high + 1e-9, step)
    readings = []
    for run in range(1, dice.randint(1, 4) + 1):
        for direction in "+-":
            order = targets if direction == "+" else targets[::-1]
            for at in order:
                # A laser beam is interrupted now and then; the first run is whole.
                if run > 1 and dice.random() < 0.1:
                    continue
                error = slope * at + wave * np.sin(at / period * 2 * np.pi)
                error += play * (direction == "-") + dice.gauss(0, 0.4)
                readings.append((run, direction, float(at), round(error, 4)))
    return readings


def solve(readings):
    """Knots, deviations, play, root mean square, largest residual, slope."""
    knots = np.unique([target for _, _, target, _ in readings])
    matrix = np.zeros((len(readings), len(knots) + 1))
    for row, (_, direction, target, _) in enumerate(readings):
        matrix[row, : len(knots)] = [
            np.interp(target, knots, unit) for unit in np.eye(len(knots))
        ]
        matrix[row, -1] = direction == "-"
    right = np.array([deviation for *_, deviation in readings])
    found, *_ = np.linalg.lstsq(matrix, right, rcond=None)
    left = right - matrix @ found
    slope = np.polyfit(knots, found[:-1], 1)[0] * 1000
    return knots, found[:-1], found[-1], np.sqrt(np.mean(left**2)), np.max(np.abs(left)), slope


def table(changes):
    """Origin, interval (mm) and values of the points."""
    values = np.zeros(256)
    origin, interval = 0, 10.0
    for change in changes:
        if "point" in change:
            values[change["point"]] = change["value"]
        elif change["parameter"] == 99:
            origin = change["value"]
        elif change["parameter"] == 103:
            interval = change["value"] / 1000
    return origin, interval, values


def correction(origin, interval, values, at):
    """The sum of the points passed on the way from the machine zero."""
    passed = int(abs(at) / interval + 1e-9)
    if at >= 0:
        return values[origin + 1 : origin + passed + 1].sum()
    return -values[max(origin - passed + 1, 0) : origin + 1].sum()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--screws", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = options.program.resolve()
    dice = random.Random(options.seed)
    largest = 0.0
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "laser.csv")
        data = pathlib.Path(folder, "data")
        # Any import makes the memory of a control there.
        file.write_text("target,deviation\n0,0\n10,0\n")
        first = [program, "pitch", "import", file, "--axis", "x", "--into", data]
        subprocess.run(first, check=True, stdout=subprocess.DEVNULL)
        for number in range(options.screws):
            readings = screw(dice)
            rows = "".join(f"{r},{d},{t},{e}\n" for r, d, t, e in readings)
            file.write_text("run,direction,target,deviation\n" + rows)
            call = [program, "pitch", "import", file, "--axis", "z", "--into", data]
            out = subprocess.run(
                [*call, "--dry-run", "--json"], check=True, capture_output=True
            )
            said = json.loads(out.stdout)
            fit = said["fit"]
            knots, curve, play, rms, worst, slope = solve(readings)
            ours = np.array([row["deviation_um"] for row in fit["curve"]])
            at = np.array([row["position_mm"] for row in fit["curve"]])
            assert np.allclose(at, knots, atol=1e-9), number
            for one, other in [
                (ours, curve),
                (fit["backlash_um"], play),
                (fit["rms_um"], rms),
                (fit["largest_um"], worst),
                (fit["slope_um_per_m"], slope),
            ]:
                off = float(np.max(np.abs(np.asarray(one) - other)))
                largest = max(largest, off)
                assert off < 1e-6, (number, off)
            columns = table(said["changes"])
            zero = np.interp(0.0, knots, curve)
            for place in np.arange(knots[0], knots[-1], 0.25):
                left = np.interp(place, knots, curve) - zero + correction(*columns, place)
                assert abs(left) <= fit["after_um"] + 0.02, (number, place, left)
    print(f"{options.screws} screws, largest difference {largest:.1e} µm")


if __name__ == "__main__":
    main()
