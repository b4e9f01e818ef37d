#!/usr/bin/env python3
"""Formulas of macro B against exact fractions and Python's own functions.

    tests/oracles/macro_formulas.py target/release/gsk980td [--count 100000] [--seed 1]

Random formulas are written as `Z[formula]`, and the end of each move is held against the
value worked out here. + - * and MOD are worked out in fractions, the rest in floating
point; a value may be off by one increment only where it lies beside a half.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

LONGEST = 9000


class Refused(Exception):
    """A value that a formula cannot have."""


def nearest(value):
    """A whole number, halves away from zero."""
    size = abs(value)
    whole = math.floor(size + Fraction(1, 2))
    return -whole if value < 0 else whole


def beside_half(value):
    """Whether a value is a half but for the last digits of floating point."""
    off = abs(abs(value) % 1 - Fraction(1, 2))
    return off < Fraction(1, 10**9) * max(1, abs(value))


def number(draw):
    kind = draw.random()
    if kind < 0.4:
        text = str(draw.randrange(0, 100))
    elif kind < 0.8:
        text = f"{draw.uniform(0, 50):.{draw.randrange(1, 4)}f}"
    else:
        text = f".{draw.randrange(1, 1000):03}"
    return text, Fraction(text if text[0] != "." else "0" + text)


def of_two(name, a, b):
    if name == "+":
        return a + b
    if name == "-":
        return a - b
    if name == "*":
        return a * b
    if name == "/":
        if b == 0:
            raise Refused
        return a / b
    if beside_half(a) or beside_half(b):
        # The last digits of floating point decide.
        raise Refused
    x, y = nearest(a), nearest(b)
    if name == "MOD":
        if y == 0:
            raise Refused
        rest = abs(x) % abs(y)
        return Fraction(-rest if x < 0 else rest)
    if x < 0 or y < 0 or max(x, y) >= 2**31:
        raise Refused
    return Fraction({"AND": x & y, "OR": x | y, "XOR": x ^ y}[name])


def turned(degrees):
    return degrees + 360 if degrees < 0 else degrees


def sine(degrees):
    """Exact where the sine is."""
    turn = degrees % 360
    exact = {0: 0, 30: Fraction(1, 2), 90: 1, 150: Fraction(1, 2), 180: 0, 210: Fraction(-1, 2), 270: -1, 330: Fraction(-1, 2)}
    near = nearest(turn)
    if abs(turn - near) < Fraction(1, 10**12) and near in exact:
        return Fraction(exact[near])
    return Fraction(math.sin(math.radians(turn)))


def of_one(name, a):
    value = float(a)
    if name == "ABS":
        return abs(a)
    # A whole number but for the last digits of floating point is meant.
    if name in ("FIX", "FUP") and abs(a - nearest(a)) < Fraction(1, 10**10) * max(1, abs(a)):
        return Fraction(nearest(a))
    # Beyond a thousand turns the last digits of the angle decide.
    if name in ("SIN", "COS") and abs(a) > 360_000:
        raise Refused
    if name == "FIX":
        return Fraction(math.trunc(a))
    if name == "FUP":
        up = math.ceil(abs(a))
        return Fraction(-up if a < 0 else up)
    if name == "SIN":
        return sine(a)
    if name == "COS":
        return sine(a + 90)
    if name == "SQRT":
        if a < 0:
            raise Refused
        return Fraction(math.sqrt(value))
    if name == "LN":
        if a <= 0:
            raise Refused
        return Fraction(math.log(value))
    if name == "EXP":
        if value > 20:
            raise Refused
        return Fraction(math.exp(value))
    if name == "ASIN":
        if abs(a) > 1:
            raise Refused
        return Fraction(turned(math.degrees(math.asin(value))))
    if name == "ACOS":
        if abs(a) > 1:
            raise Refused
        return Fraction(math.degrees(math.acos(value)))
    raise AssertionError(name)


SUMS = ["+", "-", "OR", "XOR"]
PRODUCTS = ["*", "/", "MOD", "AND"]
ONES = ["SIN", "COS", "SQRT", "ABS", "FIX", "FUP", "LN", "EXP", "ASIN", "ACOS"]
SHORT = {name: name[:2] for name in ONES + ["MOD", "AND", "XOR", "ATAN"]}


class Formulas:
    """Formulas with their values; a tree is drawn first, its brackets follow from it."""

    def __init__(self, draw):
        self.draw = draw

    def name(self, full):
        return SHORT[full] if full in SHORT and self.draw.random() < 0.3 else full

    def sum(self, depth):
        text, value = self.product(depth)
        while self.draw.random() < 0.4:
            operator = self.draw.choice(SUMS if self.draw.random() < 0.2 else SUMS[:2])
            right, other = self.product(depth)
            text += self.name(operator) + right
            value = self.checked(of_two(operator, value, other))
        return text, value

    def product(self, depth):
        text, value = self.factor(depth)
        while self.draw.random() < 0.35:
            operator = self.draw.choice(PRODUCTS if self.draw.random() < 0.4 else PRODUCTS[:2])
            right, other = self.factor(depth)
            text += self.name(operator) + right
            value = self.checked(of_two(operator, value, other))
        return text, value

    def factor(self, depth):
        if self.draw.random() < 0.15:
            text, value = self.primary(depth)
            return "-" + text, -value
        return self.primary(depth)

    def primary(self, depth):
        kind = self.draw.random()
        if depth == 0 or kind < 0.5:
            return number(self.draw)
        if kind < 0.75:
            text, value = self.sum(depth - 1)
            return f"[{text}]", value
        if kind < 0.8:
            up, y = self.sum(depth - 1)
            across, x = self.sum(depth - 1)
            if x == 0 and y == 0:
                raise Refused
            value = turned(math.degrees(math.atan2(float(y), float(x))))
            return f"{self.name('ATAN')}[{up}]/[{across}]", Fraction(value)
        name = self.draw.choice(ONES)
        text, value = self.sum(depth - 1)
        return f"{self.name(name)}[{text}]", self.checked(of_one(name, value))

    @staticmethod
    def checked(value):
        if abs(value) > 10**9 or 0 < abs(value) < Fraction(1, 10**9):
            raise Refused
        return value


def main():
    words = argparse.ArgumentParser()
    words.add_argument("program")
    words.add_argument("--count", type=int, default=100_000)
    words.add_argument("--seed", type=int, default=1)
    words = words.parse_args()
    draw = random.Random(words.seed)
    formulas = Formulas(draw)
    lines, expected = ["O0001;"], []
    while len(expected) < words.count:
        try:
            text, value = formulas.sum(4)
        except Refused:
            continue
        if abs(value) > LONGEST:
            continue
        # Every move goes somewhere: a second axis changes with each.
        lines.append(f"G00 X{len(expected) % 2} Z[{text}];")
        expected.append((text, value))
    lines.append("M30;")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "formulas.CNC"
        path.write_text("\n".join(lines) + "\n")
        moves = Path(folder) / "moves.ndjson"
        command = [words.program, "check", str(path), "--macro-b", "on", "--moves", str(moves)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
        ends = {}
        for line in moves.open():
            move = json.loads(line)
            ends[move["line"]] = move["z"]
    beside = wrong = 0
    for index, (text, value) in enumerate(expected):
        seen = Fraction(str(ends[index + 2])) * 1000
        exact = value * 1000
        if seen == nearest(exact):
            continue
        # Within the digits of floating point of a half either way is right.
        from_half = abs(abs(exact) % 1 - Fraction(1, 2))
        if abs(seen - exact) < 1 and from_half < Fraction(1, 10**5):
            beside += 1
            continue
        wrong += 1
        if wrong <= 10:
            print(f"{text}: {float(value)} expected, {float(seen) / 1000} seen")
    print(f"{words.count} formulas, {beside} beside a half, {wrong} wrong")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
