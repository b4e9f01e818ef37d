#!/usr/bin/env python3
"""The threads of the pulse board's tests, from their geometry in exact fractions.

Each thread is a path of Z and X over the angle of the spindle: lead (metric or inch), taper,
start angle, growth of the lead (G34), lead-in and run-out. This script works out the path as a
closed formula, the entries that a host sends for it, and the encoder count of every step. The
table has the CRC-32 of these counts. The test runs the engine of the firmware on the entries
with a spindle that varies, and compares.

    tests/oracles/pulse_board_threads.py            writes the table
    tests/oracles/pulse_board_threads.py --check    compares it
"""
import argparse
import pathlib
import zlib
from fractions import Fraction as F
from math import lcm

TABLE = pathlib.Path(__file__).parents[2] / "firmware/motion/tests/threads.tsv"
COUNTS = 4096
STEPS_PER_MM = {"Z": 400, "X": 800}
INCH = F(254, 10)


def parts(turns_in, turns, turns_out, slope, growth=F(0)):
    """Parts of a path: length in counts, slope at the start, slope at the end, steps a count."""
    out = []
    if turns_in:
        out.append((int(turns_in * COUNTS), F(0), slope))
    end = slope + growth * turns
    out.append((int(turns * COUNTS), slope, end))
    if turns_out:
        out.append((int(turns_out * COUNTS), end, F(0)))
    return out


def straight(lead, turns, axis="Z", turns_in=F(1, 8), turns_out=F(1, 8), growth=F(0)):
    scale = F(STEPS_PER_MM[axis], COUNTS)
    return parts(turns_in, turns, turns_out, lead * scale, growth * scale)


def pull_out(lead, turns, turns_out=F(1, 2)):
    """X stands, then leaves the thread at 45 degrees in the run-out while Z continues."""
    slope = lead * F(STEPS_PER_MM["X"], COUNTS)
    length = int(F(1, 16) * COUNTS)
    rest = int(turns_out * COUNTS) - length
    return [(int(turns * COUNTS), F(0), F(0)), (length, F(0), slope), (rest, slope, slope)]


def threads():
    """Name, start angle in turns, spindle reversed, parts of Z, parts of X, passes."""
    yield "G33-M6-coarse", F(0), 0, straight(F(-1), F(6)), [], 1
    yield "G33-M8", F(0), 0, straight(F(-5, 4), F(6)), [], 1
    yield "G33-M10", F(0), 0, straight(F(-3, 2), F(6)), [], 1
    yield "G33-M20", F(0), 0, straight(F(-5, 2), F(4)), [], 1
    yield "G33-fine-0.2", F(0), 0, straight(F(-1, 5), F(12)), [], 1
    yield "G33-fine-0.35", F(0), 0, straight(F(-7, 20), F(8)), [], 1
    yield "G33-left-hand", F(0), 0, straight(F(3, 2), F(6)), [], 1
    yield "G33-spindle-reverse", F(0), 1, straight(F(-3, 2), F(6)), [], 1
    yield "G33-inch-20", F(0), 0, straight(-INCH / 20, F(6)), [], 1
    yield "G33-inch-13", F(0), 0, straight(-INCH / 13, F(5)), [], 1
    yield "G33-inch-11.5", F(0), 0, straight(-INCH * 2 / 23, F(5)), [], 1
    yield "G33-inch-27-left", F(0), 0, straight(INCH / 27, F(8)), [], 1
    yield "G33-taper-npt", F(0), 0, straight(-INCH / 14, F(5)), straight(INCH / 14 / 32, F(5), "X"), 1
    yield "G33-taper-metric", F(0), 0, straight(F(-2), F(5)), straight(F(1, 8), F(5), "X"), 1
    yield "G33-taper-steep", F(0), 0, straight(F(-1), F(5)), straight(F(-1), F(5), "X"), 1
    yield "G33-face-scroll", F(0), 0, [], straight(F(-1), F(6), "X"), 1
    for start in range(2):
        yield f"G33-two-start-{start}", F(start, 2), 0, straight(F(-3), F(4)), [], 1
    for start in range(3):
        yield f"G33-three-start-{start}", F(start, 3), 0, straight(F(-9, 2), F(3)), [], 1
    yield "G34-growing", F(0), 0, straight(F(-1), F(6), growth=F(-1, 10)), [], 1
    yield "G34-shrinking", F(0), 0, straight(F(-2), F(6), growth=F(1, 8)), [], 1
    yield "G34-taper", F(0), 0, straight(F(-1), F(5), growth=F(-1, 4)), straight(F(1, 16), F(5), "X", growth=F(1, 64)), 1
    for name, lead, passes in (("G92-M12", F(-7, 4), 4), ("G92-inch-16", -INCH / 16, 4)):
        yield name, F(0), 0, straight(lead, F(5)), [], passes
    yield "G92-run-out", F(0), 0, straight(F(-3, 2), F(9, 2), turns_out=F(0)), pull_out(F(3, 2), F(33, 8)), 3
    yield "G92-taper", F(0), 0, straight(F(-3, 2), F(5)), straight(F(3, 64), F(5), "X"), 3
    yield "G76-M16", F(0), 0, straight(F(-2), F(9, 2), turns_out=F(0)), pull_out(F(2), F(33, 8)), 6
    yield "G76-two-start", F(1, 2), 0, straight(F(-3), F(7, 2), turns_out=F(0)), pull_out(F(3), F(25, 8)), 4


def entries(path):
    """Denominator and entries: length, numerator, add. A slope that changes evenly has half of
    its growth in the numerator, so that the sum of the entry is the integral of the slope."""
    rows = [(length, begin, (end - begin) / length) for length, begin, end in path]
    rows = [(length, begin + add / 2, add) for length, begin, add in rows]
    # An even denominator: half a step is due at the start.
    denominator = lcm(2, *(value.denominator for _, *values in rows for value in values))
    return denominator, [(length, *(int(value * denominator) for value in values)) for length, *values in rows]


def step_counts(path):
    """The counts of all steps, negative for a negative step, from the closed formula."""
    steps, position, base, begun = [], 0, F(0), 0
    for index, (length, begin, end) in enumerate(path):
        growth = (end - begin) / length
        following = None
        if index + 1 < len(path):
            rest, first, last = path[index + 1]
            following = first + (last - first) / rest / 2
        values = [base, begin, growth / 2, following or F(0)]
        scale = lcm(2, *(value.denominator for value in values))
        wide = [int(value * scale) for value in values]

        def at(count):
            return wide[0] + wide[1] * count + wide[2] * count * count

        def slope(count):
            if count == length and following is not None:
                return abs(wide[3])
            return abs(at(count + 1) - at(count))

        for count in range(1, length + 1):
            due = at(count) + scale // 2
            while due - position * scale >= scale:
                position += 1
                steps.append(begun + count)
            while due - position * scale < -min(slope(count), scale):
                position -= 1
                steps.append(-begun - count)
        begun += length
        base = F(at(length), scale)
    return steps


def table():
    lines = ["name\tstart\treverse\tpasses\taxis\tdenominator\tentries\tsteps\tcrc32"]
    for name, start, reverse, along, across, passes in threads():
        for axis, path in (("Z", along), ("X", across)):
            if not path:
                continue
            denominator, rows = entries(path)
            assert denominator < 1 << 32, name
            assert all(abs(value) < 1 << 31 for row in rows for value in row), name
            steps = step_counts(path)
            crc = zlib.crc32(b"".join(step.to_bytes(4, "little", signed=True) for step in steps))
            text = ";".join(",".join(map(str, row)) for row in rows)
            angle = int(start * COUNTS)
            lines.append(f"{name}\t{angle}\t{reverse}\t{passes}\t{axis}\t{denominator}\t{text}\t{len(steps)}\t{crc:08x}")
    return "\n".join(lines) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--check", action="store_true", help="compare the table instead of writing it")
    text = table()
    if not arguments.parse_args().check:
        TABLE.write_text(text)
    elif TABLE.read_text() != text:
        raise SystemExit(f"{TABLE} differs")
    print(f"{text.count(chr(10)) - 1} axes of {len({row.split(chr(9))[0] for row in text.splitlines()}) - 1} threads")


if __name__ == "__main__":
    main()
