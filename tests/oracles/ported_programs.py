#!/usr/bin/env python3
"""Ported programs against an interpreter of the Fanuc dialect that knows nothing of the porter.

    tests/oracles/ported_programs.py target/debug/gsk980td [--count 2000] [--seed 1] [--keep DIR]

Random programs in the codes of Fanuc lathes: two-block and one-block cycles, G code systems A
and B, inch and metric, numbers with and without a point, corners, calls, threads. Each is
interpreted here by the rules of Fanuc's manuals, ported by `dialect --from`, and the moves of
the ported text (`check --moves`) are compared: kind, end, centre, feed and lead of every move,
lengths within 0.002 mm. Returns to the reference point are left out, because the interpreter
does not know where it is.
"""

import argparse
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

NEAR = 0.002
# The one-block cycles of Fanuc take their retract from a parameter; the porter writes 0.5.
RETRACT = 0.5
WORD = re.compile(r"(,?)([A-Z])([-+]?[0-9.]+)")


class Interpreter:
    """Moves of a program: tuples of kind, X as a diameter, Z, centre, feed or lead."""

    def __init__(self, text):
        self.programs, self.blocks = {}, []
        name = None
        for line in text.splitlines():
            line = re.sub(r"\([^)]*\)", "", line).replace("%", "").strip().rstrip(";")
            words = [(comma + letter, value) for comma, letter, value in WORD.findall(line)]
            for letter, value in words:
                if letter == "O":
                    name = int(value)
                    self.programs[name] = []
            if words:
                self.programs.setdefault(name, []).append(words)
        codes = {float(v) for blocks in self.programs.values() for b in blocks for l, v in b if l == "G"}
        self.is_b = bool(codes & {77, 78, 79, 91, 95})
        self.inch, self.incremental = False, False
        self.motion, self.x, self.z = "G0", 0.0, 0.0
        self.per_rev, self.feed, self.lead = True, None, None
        self.cycle, self.moves = {}, []
        self.depth, self.least_retract, self.passes = {}, RETRACT, None
        self.thread_data = {}

    # Words ---------------------------------------------------------------------------------

    def length(self, text, always_increments=False):
        value = float(text)
        if "." not in text:
            value *= 0.0001 if self.inch else 0.001
        return value * (25.4 if self.inch else 1)

    def rate(self, text):
        value = float(text)
        return value * (25.4 if self.inch else 1)

    # Moves ---------------------------------------------------------------------------------

    def to(self, kind, x, z, center=None, rate=None):
        if kind not in ("dwell",) and (x, z) == (self.x, self.z) and center is None:
            return
        self.moves.append((kind, x, z, center, rate))
        self.x, self.z = x, z

    def cut(self, x, z):
        self.to("feed", x, z, None, self.feed)

    def rapid(self, x, z):
        self.to("rapid", x, z)

    def arc(self, clockwise, x, z, words):
        if "R" in words:
            radius = self.length(words["R"])
            dx, dz = (x - self.x) / 2, z - self.z
            half = math.hypot(dx, dz) / 2
            height = math.sqrt(max(radius * radius - half * half, 0))
            # Right of the travel for clockwise, in the plane with Z to the right and X up.
            unit = (dx / (2 * half), dz / (2 * half))
            right = (-unit[1], unit[0]) if clockwise else (unit[1], -unit[0])
            center = (self.x / 2 + dx / 2 + right[0] * height, self.z + dz / 2 + right[1] * height)
        else:
            center = (self.x / 2 + self.length(words.get("I", "0.")), self.z + self.length(words.get("K", "0.")))
        self.to("cw" if clockwise else "ccw", x, z, (2 * center[0], center[1]), self.feed)

    # Program -------------------------------------------------------------------------------

    def run(self):
        self.run_program(next(iter(self.programs)))
        return self.moves

    def run_program(self, name):
        blocks, at = self.programs[name], 0
        while at < len(blocks):
            words = {letter: value for letter, value in blocks[at] if letter not in ("G", "M")}
            codes = [float(value) for letter, value in blocks[at] if letter == "G"]
            ms = [int(value) for letter, value in blocks[at] if letter == "M"]
            if 98 in ms:
                number = int(words["P"])
                count = int(words.get("L", 1))
                if number > 9999:
                    number, count = number % 10000, number // 10000
                for _ in range(count):
                    self.run_program(number)
            elif {30, 2, 99} & set(ms):
                return
            else:
                at = self.execute(codes, words, blocks, at)
            at += 1

    def execute(self, codes, words, blocks, at):
        b = self.is_b
        for code in codes:
            if code == 20:
                self.inch = True
            elif code == 21:
                self.inch = False
            elif code in ((94, 95) if b else (98, 99)):
                self.per_rev = code in (95, 99)
            elif b and code in (90, 91):
                self.incremental = code == 91
            elif code in (0, 1, 2, 3, 32):
                self.motion = f"G{int(code)}"
            elif code in ((77, 78, 79) if b else (90, 92, 94)):
                self.motion, self.cycle = {0: "turn", 1: "thread", 2: "face"}[
                    (77, 78, 79).index(code) if b else (90, 92, 94).index(code)
                ], {}
        special = next((c for c in codes if c in (4, 28, 50, 70, 71, 72, 73, 74, 75, 76)), None)
        if special is None and b and 92 in codes:
            special = 50
        if special not in (4, 50) and "F" in words and self.motion not in ("thread", "G32") and special != 76:
            self.feed = (self.rate(words["F"]), "rev" if self.per_rev else "min")
        if special == 4:
            seconds = float(words["P"]) / 1000 if "P" in words else None
            for letter in "XU":
                if letter in words and seconds is None:
                    seconds = float(words[letter]) / (1 if "." in words[letter] else 1000)
            self.moves.append(("dwell", self.x, self.z, None, seconds))
        elif special == 50:
            self.x = self.length(words["X"]) if "X" in words else self.x
            self.z = self.length(words["Z"]) if "Z" in words else self.z
        elif special == 28:
            pass
        elif special in (71, 72, 73):
            return self.rough(int(special), words, blocks, at)
        elif special == 70:
            self.finish(words, blocks)
        elif special in (74, 75):
            self.peck(int(special), words)
        elif special == 76:
            self.many_threads(words)
        elif set(words) & set("XZUW"):
            self.axes(words, blocks, at)
        return at

    def end(self, words):
        x, z = self.x, self.z
        if "X" in words:
            x = self.x + self.length(words["X"]) if self.incremental else self.length(words["X"])
        elif "U" in words:
            x = self.x + self.length(words["U"])
        if "Z" in words:
            z = self.z + self.length(words["Z"]) if self.incremental else self.length(words["Z"])
        elif "W" in words:
            z = self.z + self.length(words["W"])
        return x, z

    def axes(self, words, blocks, at):
        x, z = self.end(words)
        if self.motion == "G0":
            self.rapid(x, z)
        elif self.motion == "G1":
            self.line(words, blocks, at, x, z)
        elif self.motion in ("G2", "G3"):
            self.arc(self.motion == "G2", x, z, words)
        elif self.motion == "G32":
            self.lead = self.rate(words.get("E", words.get("F", "0"))) or self.lead
            self.to("thread", x, z, None, self.lead)
        else:
            self.single_cycle(words, x, z)

    def line(self, words, blocks, at, x, z):
        corner = words.get(",C") or words.get(",R")
        if not corner:
            self.cut(x, z)
            return
        size = self.length(corner)
        next_words = {letter: value for letter, value in blocks[at + 1] if letter != "G"}
        start = (self.x, self.z)
        self.x, self.z = x, z
        nx, nz = self.end(next_words)
        self.x, self.z = start
        one = ((x - start[0]) / 2, z - start[1])
        two = ((nx - x) / 2, nz - z)
        one_len, two_len = math.hypot(*one), math.hypot(*two)
        one, two = (one[0] / one_len, one[1] / one_len), (two[0] / two_len, two[1] / two_len)
        turn = math.acos(max(-1, min(1, one[0] * two[0] + one[1] * two[1])))
        reach = size if ",C" in words else size * math.tan(turn / 2)
        before = (x - 2 * one[0] * reach, z - one[1] * reach)
        after = (x + 2 * two[0] * reach, z + two[1] * reach)
        self.cut(*before)
        if ",C" in words:
            self.cut(*after)
        else:
            left = one[1] * two[0] - one[0] * two[1] > 0
            normal = (one[1], -one[0]) if left else (-one[1], one[0])
            center = (before[0] / 2 + normal[0] * size, before[1] + normal[1] * size)
            self.to("ccw" if left else "cw", *after, (2 * center[0], center[1]), self.feed)

    def single_cycle(self, words, x, z):
        taper = words.get("R") or words.get("I" if self.motion != "face" else "K")
        if "F" in words or "E" in words:
            if self.motion == "thread":
                self.lead = self.rate(words.get("E", words.get("F")))
        # Axis words that a block leaves out are those of the block before.
        cycle = self.cycle
        cycle["x"] = x if {"X", "U"} & set(words) else cycle.get("x", x)
        cycle["z"] = z if {"Z", "W"} & set(words) else cycle.get("z", z)
        if taper is not None:
            cycle["taper"] = self.length(taper)
        taper = cycle.get("taper", 0.0)
        ax, az, x, z = self.x, self.z, cycle["x"], cycle["z"]
        if self.motion == "face":
            self.rapid(ax, z + taper)
            self.cut(x, z)
            self.cut(x, az)
        else:
            self.rapid(x + 2 * taper, az)
            if self.motion == "thread":
                self.to("thread", x, z, None, self.lead)
                self.rapid(ax, z)
            else:
                self.cut(x, z)
                self.cut(ax, z)
        self.rapid(ax, az)

    # Cycles along a profile ----------------------------------------------------------------

    def profile(self, words, blocks):
        """The moves of ns to nf, without shift."""
        first = next(i for i, b in enumerate(blocks) if ("N", words["P"]) in b)
        last = next(i for i, b in enumerate(blocks) if ("N", words["Q"]) in b)
        saved = (self.x, self.z, self.moves, self.motion, self.feed)
        self.moves = []
        for index in range(first, last + 1):
            block = blocks[index]
            inner = {letter: value for letter, value in block if letter not in ("G", "M")}
            self.execute([float(v) for l, v in block if l == "G"], inner, blocks, index)
        moves = self.moves
        self.x, self.z, self.moves, self.motion, self.feed = saved
        return moves, last

    def rough(self, code, words, blocks, at):
        depth = self.depth
        if "P" not in words:
            depth["e"] = self.length(words["R"]) if code != 73 else int(float(words["R"]))
            depth["u"] = self.length(words.get("U", "0."))
            depth["w"] = self.length(words.get("W", "0."))
            return at
        if "D" in words:
            if code == 73:
                depth = {"u": self.length(words.get("I", "0.")), "w": self.length(words.get("K", "0.")), "e": int(words["D"])}
            else:
                step = self.length(words["D"])
                depth = {"u": step, "w": step, "e": RETRACT}
        moves, last = self.profile(words, blocks)
        shift = (self.length(words.get("U", "0.")), self.length(words.get("W", "0.")))
        if code == 73:
            self.pattern(moves, shift, depth)
        else:
            self.levels(code, moves, shift, depth["u"] if code == 71 else depth["w"], depth["e"])
        return last

    def follow(self, moves, shift):
        for kind, x, z, center, _ in moves:
            if center:
                center = (center[0] + shift[0], center[1] + shift[1])
            self.to(kind, x + shift[0], z + shift[1], center, None if kind == "rapid" else self.feed)

    def pattern(self, moves, shift, depth):
        start, count = (self.x, self.z), max(depth["e"], 2)
        for index in range(count):
            part = (count - 1 - index) / (count - 1)
            by = (shift[0] + 2 * depth["u"] * part, shift[1] + depth["w"] * part)
            self.rapid(start[0] + by[0], start[1] + by[1])
            self.follow(moves, by)
        self.rapid(*start)

    def levels(self, code, moves, shift, step, retract):
        """Type I of G71 and G72; profiles here consist of lines."""
        start = (self.x, self.z)
        head = (start[0] + shift[0], start[1] + shift[1])
        points = [(x + shift[0], z + shift[1]) for _, x, z, _, _ in moves]
        first, rest = points[0], points[1:]
        kind = moves[0][0]
        infeed = self.rapid if kind == "rapid" else self.cut
        self.rapid(*head)
        # Depth axis a, cutting axis c; radius along both.
        pick = (lambda p: (p[0] / 2, p[1])) if code == 71 else (lambda p: (p[1], p[0] / 2))
        back = (lambda a, c: (2 * a, c)) if code == 71 else (lambda a, c: (2 * c, a))
        (a0, c0), (ab, cb), (ac, cc) = pick(head), pick(first), pick(points[-1])
        sa, sc = math.copysign(1, ab - a0), math.copysign(1, cc - cb)
        number = math.ceil(round(abs(ab - a0) / step, 6))
        for n in range(1, number):
            level = a0 + sa * step * n
            infeed(*back(level, c0))
            end, previous = cc, first
            for point in rest:
                (p, q), (p2, q2) = pick(previous), pick(point)
                if (p2 - level) * sa <= 1e-9 and abs(p2 - p) > 1e-9:
                    end = q + (q2 - q) * (level - p) / (p2 - p)
                    break
                previous = point
            self.cut(*back(level, end))
            self.cut(*back(level - sa * retract, end - sc * min(retract, abs(end - c0))))
            self.rapid(*back(level - sa * retract, c0))
        infeed(*first)
        self.follow(moves[1:], shift)
        self.rapid(*start)

    def finish(self, words, blocks):
        start = (self.x, self.z)
        moves, _ = self.profile(words, blocks)
        for kind, x, z, center, rate in moves:
            self.to(kind, x, z, center, rate)
            self.feed = rate or self.feed
        self.rapid(*start)

    # Pecks ---------------------------------------------------------------------------------

    def peck(self, code, words):
        if not set(words) & set("XZUW"):
            self.least_retract = self.length(words["R"])
            return
        x, z = self.end(words)
        one_block = set(words) & set("IKD")
        retract = RETRACT if one_block else self.least_retract
        across = self.length(words.get("I" if one_block else "P", "0"))
        along = self.length(words.get("K" if one_block else "Q", "0"))
        relief = self.length(words.get("D" if one_block else "R", "0"))
        pick = (lambda x, z: (z, x / 2)) if code == 74 else (lambda x, z: (x / 2, z))
        back = (lambda a, c: (2 * c, a)) if code == 74 else (lambda a, c: (2 * a, c))
        step, column = (along, across) if code == 74 else (across, along)
        (a0, c0), (a1, c1) = pick(self.x, self.z), pick(x, z)
        sa, sc = math.copysign(1, a1 - a0), math.copysign(1, c1 - c0)
        columns = [c0]
        while abs(columns[-1] - c1) > 1e-6:
            reached = columns[-1] + sc * column
            columns.append(c1 if (reached - c1) * sc > -1e-6 else reached)
        for index, c in enumerate(columns):
            depth = a0
            while True:
                depth += sa * step
                if (depth - a1) * sa > -1e-6:
                    break
                self.cut(*back(depth, c))
                self.rapid(*back(depth - sa * retract, c))
            self.cut(*back(a1, c))
            aside = c - sc * relief if len(columns) > 1 else c
            self.rapid(*back(a1, aside))
            self.rapid(*back(a0, aside))
            if index + 1 < len(columns):
                self.rapid(*back(a0, columns[index + 1]))
        self.rapid(*back(a0, c0))

    # Threads -------------------------------------------------------------------------------

    def many_threads(self, words):
        if "K" not in words and not set(words) & set("XZUW"):
            digits = words["P"].zfill(6)
            self.thread_data = {
                "m": int(digits[:2]), "r": int(digits[2:4]), "a": int(digits[4:]),
                "least": self.length(words.get("Q", "0")), "rest": self.length(words.get("R", "0")),
            }
            return
        x, z = self.end(words)
        if "K" in words:
            data = {"m": 1, "r": 0, "a": int(words.get("A", 0)), "least": 0.0, "rest": 0.0}
            height, first = self.length(words["K"]), self.length(words["D"])
            taper = self.length(words.get("I", "0."))
        else:
            data = self.thread_data
            height, first = self.length(words["P"]), self.length(words["Q"])
            taper = self.length(words.get("R", "0."))
        lead = self.rate(words.get("E", words.get("F")))
        start = (self.x, self.z)
        side = math.copysign(1, start[0] - (x + 2 * taper))
        way = math.copysign(1, z - start[1])
        slant = math.tan(math.radians(data["a"] / 2))
        crest = x / 2 + taper + side * height
        depths, n = [], 1
        while True:
            depth = first * math.sqrt(n)
            if depths:
                depth = max(depth, depths[-1] + data["least"])
            if depth >= height - data["rest"] - 1e-9:
                depths.append(height - data["rest"])
                break
            depths.append(depth)
            n += 1
        last = depths[-1]
        for depth in depths + [height] * max(data["m"], 1):
            aside = min(depth, last) * slant
            xb, zb = crest - side * depth, start[1] + way * aside
            self.rapid(2 * xb, zb)
            self.to("thread", 2 * (x / 2 + side * (height - depth)), z, None, lead)
            self.rapid(start[0], z)
            self.rapid(*start)


class Writer:
    """Writes random programs."""

    def __init__(self, draw, dialect):
        self.draw, self.dialect = draw, dialect
        self.is_b = dialect != "haas" and draw.random() < 0.25
        self.inch = draw.random() < 0.3
        self.points = draw.random() < 0.75
        self.lines, self.subs, self.sequence = [], [], 10
        self.x, self.z = 0, 0

    def number(self, steps):
        """A length in multiples of 0.127 mm or 0.01 mm, as inches or millimetres."""
        value = round(steps * (0.005 if self.inch else 0.01), 4)
        if not self.points:
            return str(round(value * (10000 if self.inch else 1000)))
        text = f"{value:.4f}".rstrip("0")
        return self.draw.choice([text, text.replace("0.", ".", 1) if text.startswith("0.") and text != "0." else text])

    def plain(self, steps):
        return str(round(steps * (50 if self.inch else 10)))

    def free(self, low, high):
        """A length of any least increment."""
        scale = 10000 if self.inch else 1000
        value = self.draw.randint(round(low * scale / (25.4 if self.inch else 1)), round(high * scale / (25.4 if self.inch else 1)))
        if not self.points:
            return value / scale, str(value)
        return value / scale, f"{value / scale:.4f}".rstrip("0")

    def rate(self, low, high):
        value = self.draw.uniform(low, high) / (25.4 if self.inch else 1)
        return f"{value:.4f}".rstrip("0")

    def add(self, text):
        self.lines.append(text)

    def next_n(self, count):
        first = self.sequence
        self.sequence += 10 * count
        return [first + 10 * index for index in range(count)]

    def program(self):
        draw, number = self.draw, draw_number(self.draw)
        self.add(draw.choice(["%", "(RANDOM)"]))
        self.add(f"O{number:04d}{draw.choice(['', ' (PART)', ';'])}".replace(";", ""))
        self.add("G20" if self.inch else draw.choice(["G21", "G21 G40"]))
        self.add(draw.choice(["G95" if self.is_b else "G99", "G28 U0 W0", "G18 G80 G40", "G54"]))
        self.add("G97 S400 M3")
        start = f"X{self.number(9000 if not self.inch else 720)} Z{self.number(4500 if not self.inch else 360)}"
        self.add(f"{'G92' if self.is_b else 'G50'} {start}")
        self.add(f"G0 X{self.number(8000 if not self.inch else 640)} Z{self.number(500 if not self.inch else 40)} T0101")
        for _ in range(draw.randint(3, 8)):
            self.operation(draw.choice(self.operations()))
        self.add("M30")
        for sub in self.subs:
            self.lines += sub
        return "\n".join(self.lines) + "\n"

    def operations(self):
        return ["path", "path", "arc", "corner", "turn", "face", "thread", "rough71", "rough72",
                "pattern", "peck74", "peck75", "many", "call", "dwell", "g32"]

    def home(self):
        self.add(f"G0 X{self.number(8000 if not self.inch else 640)} Z{self.number(500 if not self.inch else 40)}")

    def scale(self, millimetres):
        """Steps of the number format for about this length."""
        return round(millimetres * 100 if not self.inch else millimetres / 0.127)

    def operation(self, kind):
        self.home()
        getattr(self, kind)()

    def one_block(self):
        return self.dialect == "fanuc-10t"

    def path(self):
        draw = self.draw
        self.add(f"G1 X{self.free(20, 70)[1]} F{self.rate(0.05, 0.4)}")
        if self.is_b:
            self.add("G91")
        for _ in range(draw.randint(1, 6)):
            words = []
            if draw.random() < 0.7:
                words.append(("X" if self.is_b else draw.choice("UX")))
            if draw.random() < 0.7 or not words:
                words.append(("Z" if self.is_b else draw.choice("WZ")))
            texts = []
            for letter in words:
                low, high = (-5, 5) if letter in "UW" or self.is_b else ((20, 70) if letter == "X" else (-60, 0))
                texts.append(letter + self.free(low, high)[1])
            self.add(" ".join(texts))
        if self.is_b:
            self.add("G90")

    def arc(self):
        draw = self.draw
        radius = self.scale(draw.uniform(2, 10))
        self.add(f"G1 X{self.number(self.scale(30))} Z{self.number(-self.scale(10))} F{self.rate(0.05, 0.3)}")
        code, outwards = draw.choice([("G3", True), ("G2", False)])
        end = f"X{self.number(self.scale(30) + 2 * radius)} Z{self.number(-self.scale(10) - radius)}"
        if draw.random() < 0.5:
            self.add(f"{code} {end} R{self.number(radius)}")
        elif outwards:
            self.add(f"{code} {end} K{self.number(-radius)}")
        else:
            self.add(f"{code} {end} I{self.number(radius)}")
        self.add(f"G1 X{self.number(self.scale(30) + 2 * radius + self.scale(4))}")

    def corner(self):
        draw = self.draw
        x, z = self.scale(20), -self.scale(2)
        self.add(f"G1 X{self.number(x)} Z{self.number(z)} F{self.rate(0.05, 0.3)}")
        along_z = True
        count = draw.randint(2, 5)
        for index in range(count):
            if draw.random() < 0.35:
                x += self.scale(draw.uniform(6, 12))
                z -= self.scale(draw.uniform(6, 12))
                text = f"X{self.number(x)} Z{self.number(z)}"
            elif along_z:
                z -= self.scale(draw.uniform(6, 12))
                text = f"Z{self.number(z)}"
            else:
                x += self.scale(draw.uniform(12, 20))
                text = f"X{self.number(x)}"
            along_z = not along_z
            if index + 1 < count:
                text += draw.choice(["", f",C{self.number(self.scale(1))}", f",R{self.number(self.scale(1.5))}"])
            self.add(text)

    def single(self, code, b_code):
        return b_code if self.is_b else code

    def turn(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(60))} Z{self.number(self.scale(2))}")
        taper = ""
        if draw.random() < 0.4:
            taper = f" {'I' if self.one_block() or self.dialect == 'haas' else 'R'}{self.number(-self.scale(3))}"
        self.add(f"{self.single('G90', 'G77')} X{self.number(self.scale(56))} Z{self.number(-self.scale(30))}{taper} F{self.rate(0.1, 0.4)}")
        for index in range(draw.randint(0, 3)):
            self.add(f"X{self.number(self.scale(54 - 2 * index))}{taper if draw.random() < 0.5 else ''}")

    def face(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(60))} Z{self.number(self.scale(3))}")
        taper = ""
        if draw.random() < 0.4:
            taper = f" {'K' if self.one_block() or self.dialect == 'haas' else 'R'}{self.number(-self.scale(1))}"
        self.add(f"{self.single('G94', 'G79')} X{self.number(self.scale(20))} Z{self.number(-self.scale(1))}{taper} F{self.rate(0.1, 0.4)}")
        for index in range(draw.randint(0, 3)):
            self.add(f"Z{self.number(-self.scale(2 + index))}{taper if draw.random() < 0.5 else ''}")

    def thread(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(40))} Z{self.number(self.scale(5))}")
        taper = ""
        if draw.random() < 0.4:
            taper = f" {'I' if self.one_block() or self.dialect == 'haas' else 'R'}{self.number(-self.scale(1))}"
        lead = "E" if draw.random() < 0.3 else "F"
        self.add(f"{self.single('G92', 'G78')} X{self.number(self.scale(36))} Z{self.number(-self.scale(20))}{taper} {lead}{self.rate(1, 3)}")
        for index in range(draw.randint(0, 3)):
            self.add(f"X{self.number(self.scale(35.5 - 0.5 * index))}{taper if draw.random() < 0.5 else ''}")

    def g32(self):
        self.add(f"G0 X{self.number(self.scale(30))} Z{self.number(self.scale(5))}")
        self.add(f"G32 Z{self.free(-30, -10)[1]} {self.draw.choice('EF')}{self.rate(1, 3)}")
        self.add(f"G0 X{self.number(self.scale(40))}")

    def steps_down(self):
        """A profile of lines: X rises, Z falls."""
        draw = self.draw
        x, z, points = self.scale(draw.uniform(15, 25)), self.scale(2), []
        begin = x
        for _ in range(draw.randint(2, 5)):
            if draw.random() < 0.5:
                z -= self.scale(draw.uniform(3, 9))
                points.append(f"Z{self.number(z)}")
            x += self.scale(draw.uniform(2, 8))
            z -= self.scale(draw.uniform(2, 8))
            points.append(f"X{self.number(x)} Z{self.number(z)}")
        points.append(f"Z{self.number(z - self.scale(4))}")
        return begin, points

    def rough71(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(75))} Z{self.number(self.scale(2))}")
        begin, points = self.steps_down()
        numbers = self.next_n(len(points) + 1)
        ends = f"P{numbers[0]} Q{numbers[-1]}"
        allowance = f"U{self.number(2 * self.scale(0.25))} W{self.number(self.scale(0.13))}"
        depth = self.scale(draw.uniform(1, 3))
        if self.one_block():
            self.add(f"G71 {ends} {allowance} D{self.plain(depth)} F{self.rate(0.1, 0.4)}")
        else:
            self.add(f"G71 U{self.number(depth)} R{self.number(self.scale(0.51))}")
            self.add(f"G71 {ends} {allowance} F{self.rate(0.1, 0.4)}")
        self.profile_lines(numbers, [f"{draw.choice(['G0', 'G1'])} X{self.number(begin)}"] + points)
        if draw.random() < 0.5:
            self.add(f"G70 {ends}")

    def profile_lines(self, numbers, lines):
        feed = f" F{self.rate(0.05, 0.2)}"
        for index, (n, line) in enumerate(zip(numbers, lines)):
            code = "G1 " if index == 1 else ""
            self.add(f"N{n} {code}{line}{feed if index == 1 else ''}")

    def rough72(self):
        draw = self.draw
        x, z = self.scale(75), self.scale(2)
        self.add(f"G0 X{self.number(x)} Z{self.number(z)}")
        z = -self.scale(draw.uniform(20, 30))
        points, begin, x = [], z, self.scale(70)
        for _ in range(draw.randint(2, 4)):
            if draw.random() < 0.5:
                x -= self.scale(draw.uniform(3, 9))
                points.append(f"X{self.number(x)}")
            x -= self.scale(draw.uniform(2, 8))
            z += self.scale(draw.uniform(1, 4))
            points.append(f"X{self.number(x)} Z{self.number(z)}")
        points.append(f"X{self.number(x - self.scale(4))}")
        numbers = self.next_n(len(points) + 1)
        ends = f"P{numbers[0]} Q{numbers[-1]}"
        allowance = f"U{self.number(2 * self.scale(0.25))} W{self.number(self.scale(0.13))}"
        depth = self.scale(draw.uniform(1, 3))
        if self.one_block():
            self.add(f"G72 {ends} {allowance} D{self.plain(depth)} F{self.rate(0.1, 0.4)}")
        else:
            self.add(f"G72 W{self.number(depth)} R{self.number(self.scale(0.51))}")
            self.add(f"G72 {ends} {allowance} F{self.rate(0.1, 0.4)}")
        self.profile_lines(numbers, [f"{draw.choice(['G0', 'G1'])} Z{self.number(begin)}"] + points)
        if draw.random() < 0.5:
            self.add(f"G70 {ends}")

    def pattern(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(75))} Z{self.number(self.scale(2))}")
        begin, points = self.steps_down()
        numbers = self.next_n(len(points) + 1)
        ends = f"P{numbers[0]} Q{numbers[-1]}"
        allowance = f"U{self.number(2 * self.scale(0.25))} W{self.number(self.scale(0.13))}"
        relief = (self.number(self.scale(draw.uniform(2, 6))), self.number(self.scale(draw.uniform(0, 2))))
        count = draw.choice([2, 3, 5])
        if self.one_block():
            self.add(f"G73 {ends} I{relief[0]} K{relief[1]} {allowance} D{count} F{self.rate(0.1, 0.4)}")
        else:
            self.add(f"G73 U{relief[0]} W{relief[1]} R{count}")
            self.add(f"G73 {ends} {allowance} F{self.rate(0.1, 0.4)}")
        self.profile_lines(numbers, [f"G0 X{self.number(begin)}"] + points)
        if draw.random() < 0.5:
            self.add(f"G70 {ends}")

    def peck74(self):
        draw = self.draw
        columns = draw.random() < 0.4
        x = self.scale(30) if columns else 0
        self.add(f"G0 X{self.number(x)} Z{self.number(self.scale(3))}")
        step, peck = self.scale(draw.uniform(1.5, 3)), self.scale(draw.uniform(3, 9))
        end = (f"X{self.number(self.scale(20))} " if columns else "") + f"Z{self.number(-self.scale(draw.uniform(10, 40)))}"
        if self.one_block():
            across = f"I{self.number(step)} " if columns else ""
            self.add(f"G74 {end} {across}K{self.number(peck)} F{self.rate(0.05, 0.2)}")
        else:
            self.add(f"G74 R{self.number(self.scale(1))}")
            across = f"P{self.plain(step)} " if columns else ""
            self.add(f"G74 {end} {across}Q{self.plain(peck)} F{self.rate(0.05, 0.2)}")

    def peck75(self):
        draw = self.draw
        columns = draw.random() < 0.5
        self.add(f"G0 X{self.number(self.scale(50))} Z{self.number(-self.scale(10))}")
        step, column = self.scale(draw.uniform(1, 3)), self.scale(draw.uniform(1, 3))
        end = f"X{self.number(self.scale(38))}" + (f" Z{self.number(-self.scale(20))}" if columns else "")
        if self.one_block():
            aside = f" K{self.number(column)}" if columns else ""
            self.add(f"G75 {end} I{self.number(step)}{aside} F{self.rate(0.05, 0.2)}")
        else:
            self.add(f"G75 R{self.number(self.scale(0.5))}")
            aside = f" Q{self.plain(column)}" if columns else ""
            self.add(f"G75 {end} P{self.plain(step)}{aside} F{self.rate(0.05, 0.2)}")

    def many(self):
        draw = self.draw
        self.add(f"G0 X{self.number(self.scale(44))} Z{self.number(self.scale(6))}")
        height, first = self.scale(draw.uniform(1.2, 2.5)), self.scale(draw.uniform(0.3, 0.6))
        taper = self.number(-self.scale(1)) if draw.random() < 0.3 else None
        end = f"X{self.number(self.scale(36))} Z{self.number(-self.scale(25))}"
        angle = draw.choice([0, 55, 60])
        if self.one_block():
            text = f"G76 {end} {f'I{taper} ' if taper else ''}K{self.number(height)} D{self.plain(first)} F{self.rate(1, 3)}"
            self.add(text + (f" A{angle}" if angle else ""))
        else:
            rest = self.scale(draw.choice([0, 0.13]))
            self.add(f"G76 P{draw.randint(1, 3):02d}00{angle:02d} Q{self.plain(self.scale(draw.choice([0, 0.13])))} R{self.number(rest)}")
            self.add(f"G76 {end} {f'R{taper} ' if taper else ''}P{self.plain(height)} Q{self.plain(first)} F{self.rate(1, 3)}")

    def call(self):
        number = 7000 + len(self.subs)
        count = self.draw.randint(1, 4)
        self.add(f"G0 X{self.number(self.scale(50))} Z{self.number(-self.scale(5))}")
        self.add(self.draw.choice([f"M98 P{number} L{count}", f"M98 P{count}{number}"]))
        letter = "Z" if self.is_b else "W"
        up, down = ("X", "X") if self.is_b else ("U", "U")
        lines = [f"O{number}"] + (["G91"] if self.is_b else [])
        lines += [f"G0 {letter}{self.number(-self.scale(4))}", f"G1 {down}{self.number(-self.scale(6))} F{self.rate(0.05, 0.2)}",
                  f"G0 {up}{self.number(self.scale(6))}"] + (["G90"] if self.is_b else []) + ["M99"]
        self.subs.append(lines)

    def dwell(self):
        self.add(self.draw.choice(["G4 P500", "G4 X1.5", "G4 U0.25"]))


def draw_number(draw):
    return draw.randint(1, 6999)


def differs(expected, actual):
    if len(expected) != len(actual):
        return f"{len(expected)} moves expected, {len(actual)} made"
    for index, (want, got) in enumerate(zip(expected, actual)):
        kind, x, z, center, rate = want
        if got["kind"] != kind:
            return f"move {index}: {want} {got}"
        if kind == "dwell":
            if abs(got["dt"] - rate) > 1e-6:
                return f"move {index}: {want} {got}"
            continue
        near = abs(got["x"] - x) <= NEAR and abs(got["z"] - z) <= NEAR
        if center and near:
            near = abs(got["cx"] - center[0]) <= 10 * NEAR and abs(got["cz"] - center[1]) <= 10 * NEAR
        if kind == "thread":
            near = near and abs(got["lead"] - rate) < 1e-4
        elif rate and near:
            near = abs(got["feed"] - rate[0]) < 1e-4 and got["per"] == rate[1]
        if not near:
            return f"move {index}: {want} {got}"
    return None


def examine(program, seed, dialects, keep):
    draw = random.Random(seed)
    dialect = draw.choice(dialects)
    text = Writer(draw, dialect).program()
    expected = Interpreter(text).run()
    with tempfile.TemporaryDirectory() as folder:
        foreign, ported = Path(folder) / "foreign.nc", Path(folder) / "ported.nc"
        foreign.write_text(text)
        call = [program, "dialect", "--from", dialect, str(foreign), "-o", str(ported), "--json"]
        result = json.loads(subprocess.run(call, capture_output=True, text=True).stdout)
        refused = [f for f in result["findings"] if f["refused"]]
        reason = f"refused: {refused}" if refused else None
        if reason is None and result["check"]["alarm"]:
            reason = f"alarm: {result['check']['alarm']}"
        made = ported.read_text()
        if reason is None:
            call = [program, "check", "--param", "19=0", "--moves", "-", str(ported)]
            lines = subprocess.run(call, capture_output=True, text=True).stdout.splitlines()
            sources = made.splitlines()
            returns = {n for n, line in enumerate(sources, 1) if "G28" in line}
            moves = [json.loads(line) for line in lines]
            reason = differs(expected, [move for move in moves if move["line"] not in returns])
    if reason and keep:
        Path(keep).mkdir(parents=True, exist_ok=True)
        (Path(keep) / f"{seed}.{dialect}.nc").write_text(text)
        (Path(keep) / f"{seed}.ported.nc").write_text(made)
    return dialect, reason, len(expected)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", help="folder for programs that differ")
    parser.add_argument("--dialect", action="append", choices=["fanuc0t", "fanuc-10t"])
    args = parser.parse_args()
    dialects = args.dialect or ["fanuc0t", "fanuc-10t"]
    seeds = range(args.seed, args.seed + args.count)
    failed, total = 0, 0
    with ThreadPoolExecutor(2) as pool:
        jobs = pool.map(lambda seed: (seed, examine(args.program, seed, dialects, args.keep)), seeds)
        for seed, (dialect, reason, moves) in jobs:
            total += moves
            if reason:
                failed += 1
                print(f"seed {seed} ({dialect}): {reason}")
    print(f"{args.count - failed} of {args.count} programs equal, {total} moves")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
