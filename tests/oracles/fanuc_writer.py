"""Writes random Fanuc lathe programs for `ported_random.py`."""

import collections
import math
import re


class Writer:
    """Writes a program; `x`, `z` is the position in the unit of the program."""

    def __init__(self, draw, one_block):
        self.draw, self.one_block = draw, one_block
        self.is_b = draw.random() < 0.15
        self.inch = draw.random() < 0.25
        self.points = draw.random() < 0.8
        self.dense = draw.random() < 0.2
        self.per_rev = True
        self.n, self.rows, self.subs, self.used = 10, [], [], collections.Counter()
        self.numbered = draw.random() < 0.4
        self.x = self.z = None
        self.relative = False

    # Text ------------------------------------------------------------------------------------
    def places(self):
        return 4 if self.inch else 3

    def unit(self, mm):
        return round(mm / 25.4 if self.inch else mm, self.places())

    def num(self, value, point=None):
        value = round(value, self.places()) + 0.0
        point = (self.points or self.draw.random() < 0.2) if point is None else point
        if not point:
            return str(int(round(value * 10 ** self.places())))
        text = f"{value:.{self.places()}f}".rstrip("0")
        if self.draw.random() < 0.2:
            text = text.replace("0.", ".", 1) if text.lstrip("-").startswith("0.") and len(text.lstrip("-")) > 2 else text
        return text

    def whole(self, value):
        return str(int(round(round(value, self.places()) * 10 ** self.places())))

    def add(self, text, n=None):
        if n is not None:
            text = f"N{n} {text}"
        elif self.numbered:
            self.n += 10
            text = f"N{self.n} {text}"
        if self.dense:
            text = text.replace(" ", "")
        if self.draw.random() < 0.05:
            text += " (CUT)"
        self.rows.append(text)

    def feed(self):
        if not self.per_rev:
            return f"F{self.num(self.unit(self.draw.uniform(20, 300)), True)}"
        return f"F{self.num(self.unit(self.draw.uniform(0.05, 0.4)), True)}"

    def lead(self):
        return f"{self.draw.choice('FFFE')}{self.num(self.unit(self.draw.uniform(0.8, 3)), True)}"

    def axis(self, letter, value):
        """X or Z to a position: absolute or incremental."""
        at = self.x if letter == "X" else self.z
        if self.is_b:
            return f"{letter}{self.num(value - at if self.relative else value)}"
        if self.draw.random() < 0.3:
            return f"{'U' if letter == 'X' else 'W'}{self.num(value - at)}"
        return f"{letter}{self.num(value)}"

    def to(self, x=None, z=None):
        words = []
        if x is not None:
            words.append(self.axis("X", x))
        if z is not None:
            words.append(self.axis("Z", z))
        self.x = round(x, self.places()) if x is not None else self.x
        self.z = round(z, self.places()) if z is not None else self.z
        return " ".join(words)

    def u(self, mm):
        return self.unit(mm)

    def between(self, low, high):
        return self.u(self.draw.uniform(low, high))

    # Program ---------------------------------------------------------------------------------
    def program(self):
        draw = self.draw
        head = ["%"] if draw.random() < 0.5 else []
        head.append(f"{draw.choice(['O', 'O', ':'])}{draw.randint(1, 6999):04d}")
        units = ["G20" if self.inch else "G21"] if self.inch or draw.random() < 0.6 else []
        if units:
            self.add(" ".join(units + draw.choice([[], ["G40"], ["G40", "G99" if not self.is_b else "G95"]])))
        if draw.random() < 0.4:
            self.add(f"{'G92' if self.is_b else 'G50'} X{self.num(self.u(180), True)} Z{self.num(self.u(90), True)}")
            self.x, self.z = self.u(180), self.u(90)
        self.add(draw.choice(["T0101", "T0100", "G54 T0101"]))
        self.add(draw.choice(["G97 S300 M03", "G97 S250 M03"]))
        relative, self.relative = self.relative, False
        self.x, self.z = self.x or 0, self.z or 0
        self.add(f"G00 X{self.num(self.u(60))} Z{self.num(self.u(3))} M08")
        self.x, self.z = self.u(60), self.u(3)
        kinds = ["lines", "lines", "arc", "arc", "corner", "turn", "face", "thread", "g32", "rough71", "rough72", "pattern",
                 "peck74", "peck75", "many", "call", "dwell", "home", "shift", "angle", "per", "speed"]
        if self.is_b:
            kinds = [k for k in kinds if k not in ("shift", "angle")] + ["mode", "mode"]
        for _ in range(draw.randint(3, 12)):
            kind = draw.choice(kinds)
            self.used[kind] += 1
            getattr(self, kind)()
        self.absolute()
        self.add(draw.choice(["G28 U0 W0", "G00 X100. Z100."]) if not self.is_b else "G00 X100. Z100.")
        self.add(draw.choice(["M30", "M02", "M05 M09", "M30"]))
        if not {"M30", "M02"} & set(re.findall(r"M\d\d", self.rows[-1])):
            self.add("M30")
        body = "\n".join(head + self.rows + [row for sub in self.subs for row in sub] + (["%"] if head[0] == "%" else []))
        return body + "\n"

    def absolute(self):
        if self.relative:
            self.add("G90")
            self.relative = False

    def start(self, x, z):
        self.absolute()
        self.add(f"G00 X{self.num(self.u(x))} Z{self.num(self.u(z))}")
        self.x, self.z = self.u(x), self.u(z)

    def mode(self):
        self.relative = not self.relative
        self.add("G91" if self.relative else "G90")

    def per(self):
        self.per_rev = not self.per_rev
        self.absolute()
        if self.is_b:
            self.add("G95" if self.per_rev else "G94")
        else:
            self.add("G99" if self.per_rev else "G98")
        self.add(f"G01 {self.to(self.x, self.z - self.u(1))} {self.feed()}")

    def speed(self):
        self.add(self.draw.choice(["G97 S280", "G50 S1500" if not self.is_b else "G92 S1500", "M03", "M04 S300", "M09", "M00"]))

    def lines(self):
        draw = self.draw
        first = draw.choice(["G00", "G01", "G1", "G0"])
        for index in range(draw.randint(1, 5)):
            x = self.between(20, 80) if draw.random() < 0.8 else None
            z = self.between(-60, 4) if x is None or draw.random() < 0.7 else None
            text = self.to(x, z)
            if index == 0:
                text = f"{first} {text}" + (f" {self.feed()}" if first[-1] == "1" else "")
            self.add(text)

    def arc(self):
        draw = self.draw
        radius = self.between(3, 20)
        begin = draw.uniform(0, 2 * math.pi)
        x0 = self.u(30) * 2
        self.start(60, -20)
        cx, cz = round(-radius * math.cos(begin), self.places()), round(-radius * math.sin(begin), self.places())
        radius = math.hypot(cx, cz)
        begin = math.atan2(-cz, -cx)
        sweep = draw.uniform(0.2, 2.9) * draw.choice([1, -1])
        by_radius = draw.random() < 0.5
        if not by_radius and draw.random() < 0.2:
            sweep *= 1.8
        code = "G02" if sweep > 0 else "G03"
        end = begin + sweep
        ex = x0 + 2 * (cx + radius * math.cos(end))
        ez = self.z + cz + radius * math.sin(end)
        chord = math.hypot(ex - self.x, 2 * (ez - self.z)) / 2
        text = self.to(round(ex, self.places()), round(ez, self.places()))
        if by_radius:
            self.add(f"{code} {text} R{self.num(max(radius, chord / 2 + self.u(0.003)))} {self.feed()}")
        else:
            self.add(f"{code} {text} I{self.num(cx)} K{self.num(cz)} {self.feed()}")
        self.add(f"G01 {self.to(self.x, self.z - self.u(2))}")

    def corner(self):
        draw = self.draw
        self.start(24, -2)
        self.add(f"G01 {self.to(None, self.z - self.u(1))} {self.feed()}")
        along_z, count, square = draw.random() < 0.5, draw.randint(2, 5), draw.random() < 0.6
        for index in range(count):
            dx, dz = self.between(8, 16) * draw.choice([1, 1, -1]) if self.x > self.u(60) else self.between(8, 16), -self.between(5, 12)
            last = index + 1 == count
            corner = "" if last else draw.choice(["", "C", "R", "C", "R"])
            if not square and draw.random() < 0.5:
                text = self.to(self.x + dx, self.z + dz)
                corner = corner and "," + corner
            elif along_z:
                text = self.to(None, self.z + dz)
            else:
                text = self.to(self.x + dx, None)
            sized = ""
            if corner:
                size = self.between(0.3, 1.8)
                sign = 1
                if square and not self.is_b:
                    # The sign is the direction of the next move; set when the next is known.
                    form = draw.choice([f",{corner}", corner, "IK" if corner == "C" else corner])
                    if form[0] != ",":
                        sign = None
                    sized = (form, size, sign, along_z)
                else:
                    sized = ("," + corner[-1], size, 1, along_z)
            along_z = not along_z
            self.add(text)
            if sized:
                self.pending = (len(self.rows) - 1, sized, self.x, self.z)
            elif hasattr(self, "pending"):
                pass
            self.resolve(sized)
        self.absolute()
        self.add(f"G00 X{self.num(self.u(90))}")
        self.x = self.u(90)

    def resolve(self, sized):
        """Writes a corner once the direction of the block after it is known."""
        held = getattr(self, "held", None)
        if held:
            at, (form, size, sign, was_z), x, z = held
            if sign is None:
                move = self.x - x if was_z else self.z - z
                sign = 1 if move > 0 else -1
            letter = ("I" if was_z else "K") if form == "IK" else form
            word = f" {letter}{self.num(sign * size)}"
            row = self.rows[at]
            comment = " (CUT)" if row.endswith("(CUT)") else ""
            row = row.removesuffix("(CUT)").rstrip()
            self.rows[at] = row + (word if not self.dense else word.strip()) + comment
        self.held = self.pending if sized else None

    def angle(self):
        """Lines by their angle, some with a corner, or two that meet by their angles."""
        draw = self.draw
        self.start(30, -2)
        degrees = draw.choice([135, 150, 165, 170, 120])
        slope = math.tan(math.radians(degrees))
        corner = draw.choice(["", "", ",C", ",R"])
        size = f" {corner}{self.num(self.between(0.3, 1))}" if corner else ""
        shape = draw.choice("xzm")
        if shape == "x":
            self.add(f"G01 X{self.num(self.between(40, 60))} A{degrees}.{size} {self.feed()}")
        elif shape == "z":
            self.add(f"G01 Z{self.num(self.between(-20, -8))} A{degrees}.{size} {self.feed()}")
        else:
            along, end = self.between(5, 9), self.between(8, 12)
            x, z = self.x + along * math.tan(math.radians(5)) * 2, self.z - along
            self.add(f"G01 A175.{size} {self.feed()}")
            self.add(f"X{self.num(round(x + 2 * end, self.places()))} Z{self.num(round(z + end / slope, self.places()))} A{degrees}.")
        if shape != "m" and corner:
            self.add(draw.choice([f"Z{self.num(self.u(-60))}", f"W{self.num(self.u(-9))}", f"U{self.num(self.u(12))}"]))
        self.start(70, 2)

    def g32(self):
        draw = self.draw
        self.start(30, 5)
        code = "G33" if self.is_b else "G32"
        shape = draw.choice(["z", "cone", "face", "run"])
        if shape == "face":
            self.add(f"{code} {self.to(self.u(10), None)} {self.lead()}")
        else:
            self.add(f"{code} {self.to(self.u(34) if shape == 'cone' else None, self.between(-30, -15))} {self.lead()}")
            if shape == "run":
                self.add(self.to(self.x + self.u(4), self.z - self.u(1)))
        self.add(f"G00 X{self.num(self.u(60))}" if not self.relative else f"G00 X{self.num(self.u(20))}")
        self.x = self.u(60) if not self.relative else self.x + self.u(20)

    def single(self, a, b):
        return b if self.is_b else a

    def cycle(self, code, x, z, x0, z0, rate, taper, repeat):
        """G90, G92, G94 with the words kept; U, W count from the start of the cycle."""
        draw = self.draw
        self.start(x0, z0)
        use_u, use_w = not self.is_b and draw.random() < 0.3, not self.is_b and draw.random() < 0.3
        x_word = lambda v: f"U{self.num(self.u(v) - self.x)}" if use_u else f"X{self.num(self.u(v))}"
        z_word = lambda v: f"W{self.num(self.u(v) - self.z)}" if use_w else f"Z{self.num(self.u(v))}"
        self.add(f"{code} {x_word(x)} {z_word(z)}{taper} {rate}")
        for index in range(draw.randint(0, 3)):
            row = x_word(x - index - 1) if repeat == "X" else z_word(z - index - 1)
            self.add(row + (taper if draw.random() < 0.3 else ""))

    def taper(self, letter, low, high):
        if self.draw.random() < 0.5:
            return ""
        letter = letter if self.one_block else "R"
        return f" {letter}{self.num(self.between(low, high))}"

    def turn(self):
        self.cycle(self.single("G90", "G77"), 50, -30, 60, 2, self.feed(), self.taper("I", -6, -1), "X")

    def face(self):
        self.cycle(self.single("G94", "G79"), 20, -2, 60, 3, self.feed(), self.taper("K", -3, -1), "Z")

    def thread(self):
        self.cycle(self.single("G92", "G78"), 28, -20, 40, 5, self.lead(), self.taper("I", -2, -0.3), "X")

    # Multiple cycles -------------------------------------------------------------------------
    def contour(self, rows, ends):
        numbers = list(range(ends, ends + len(rows)))
        return [(n, row) for n, row in zip(numbers, rows)]

    def two(self, code, ends, first, one, rows, after):
        """Writes a G71, G72 or G73 with its profile and perhaps G70."""
        draw = self.draw
        ns, nf = self.n + 100, self.n + 100 + len(rows) - 1
        allowance = f"U{self.num(self.u(draw.choice([0, 0.4, 0.5])))} W{self.num(self.u(draw.choice([0, 0.1, 0.2])))}"
        if self.one_block:
            self.add(f"{code} P{ns} Q{nf} {allowance} {one} {self.feed()}")
        else:
            self.add(f"{code} {first}")
            self.add(f"{code} P{ns} Q{nf} {allowance} {self.feed()}")
        for n, row in zip(range(ns, nf + 1), rows):
            self.add(row, n)
        self.n = nf + 10
        if draw.random() < 0.6:
            self.add(f"G70 P{ns} Q{nf}")

    def rising(self, bore):
        """A profile for G71, monotonous in X and Z."""
        draw, rows = self.draw, []
        sense = -1 if bore else 1
        x0, z0 = self.x, self.z
        x = self.u(50) if bore else self.u(20)
        self.x = x
        rows.append(f"{draw.choice(['G00', 'G01'])} X{self.num(x)}")
        feed = self.feed() if draw.random() < 0.6 else ""
        count = draw.randint(2, 5)
        for index in range(count):
            shape = draw.choice(["z", "cone", "arc", "x"]) if index else "z"
            if shape == "z":
                text = f"G01 {self.to(None, self.z - self.between(3, 10))}"
            elif shape == "x":
                text = f"G01 {self.to(self.x + sense * self.between(3, 8), None)}"
            elif shape == "cone":
                text = f"G01 {self.to(self.x + sense * self.between(3, 8), self.z - self.between(2, 8))}"
            else:
                radius = self.between(1, 4)
                code, i, k = draw.choice([("G03", 0, -radius), ("G02", radius, 0)] if not bore else [("G02", 0, -radius), ("G03", -radius, 0)])
                text = f"{code} {self.to(self.x + sense * 2 * radius, self.z - radius)} "
                text += f"R{self.num(radius)}" if draw.random() < 0.5 else f"I{self.num(i)} K{self.num(k)}"
            rows.append(text + (f" {feed}" if index == 0 and feed else ""))
        rows.append(f"G01 {self.to(self.u(13) if bore else self.u(66), None)}")
        self.x, self.z = x0, z0
        return rows

    def rough71(self):
        bore = self.draw.random() < 0.3
        self.start(14 if bore else 64, 2)
        depth = self.between(1, 3)
        rows = self.rising(bore)
        self.two("G71", None, f"U{self.num(depth)} R{self.num(self.u(0.5))}", f"D{self.whole(depth)}", rows, None)
        if bore and rows:
            # The finishing allowance of a bore is negative.
            self.rows = [re.sub(r"(G71 ?N?P\d+ ?Q\d+ ?U)(\d|\.)", r"\1-\2", row) for row in self.rows]

    def rough72(self):
        draw = self.draw
        self.start(64, 2)
        x0, z0 = self.x, self.z
        self.z = self.u(-25)
        rows = [f"{draw.choice(['G00', 'G01'])} Z{self.num(self.z)}"]
        self.x = self.u(60)
        rows.append(f"G01 X{self.num(self.x)} {self.feed()}")
        for _ in range(draw.randint(1, 4)):
            dx, dz = self.between(3, 9), self.between(1.5, 4)
            rows.append(f"G01 {self.to(self.x - dx, self.z + dz if draw.random() < 0.6 else None)}")
            if draw.random() < 0.4:
                rows.append(self.to(None, self.z + dz))
        rows.append(f"G01 {self.to(None, self.u(3))}")
        self.x, self.z = x0, z0
        depth = self.between(1, 3)
        self.two("G72", None, f"W{self.num(depth)} R{self.num(self.u(0.5))}", f"D{self.whole(depth)}", rows, None)

    def pattern(self):
        draw = self.draw
        self.start(64, 2)
        i, k, count = self.between(2, 8), self.between(0.5, 3), draw.choice([2, 3, 4])
        rows = self.rising(False)
        self.two("G73", None, f"U{self.num(i)} W{self.num(k)} R{count}{draw.choice(['', '.'])}", f"I{self.num(i)} K{self.num(k)} D{count}", rows, None)

    def peck74(self):
        draw = self.draw
        columns = draw.random() < 0.5
        self.start(40 if columns else 0, 3)
        end = self.to(self.u(20) if columns else None, self.between(-40, -10))
        self.x, self.z = (self.u(40) if columns else 0), self.u(3)
        step, peck = self.between(1, 3), self.between(2, 6)
        if self.one_block:
            self.add(f"G74 {end} {f'I{self.num(step)} ' if columns else ''}K{self.num(peck)} {self.feed()}")
        else:
            self.add(f"G74 R{self.num(self.u(0.5))}")
            self.add(f"G74 {end} {f'P{self.whole(step)} ' if columns else ''}Q{self.whole(peck)} {self.feed()}")

    def peck75(self):
        draw = self.draw
        columns = draw.random() < 0.6
        self.start(60, -10)
        end = self.to(self.between(30, 50), self.u(-20) if columns else None)
        self.x, self.z = self.u(60), self.u(-10)
        side, peck = self.between(1, 3), self.between(1, 4)
        if self.one_block:
            self.add(f"G75 {end} I{self.num(peck)} {f'K{self.num(side)} ' if columns else ''}{self.feed()}")
        else:
            self.add(f"G75 R{self.num(self.u(0.5))}")
            self.add(f"G75 {end} P{self.whole(peck)} {f'Q{self.whole(side)} ' if columns else ''}{self.feed()}")

    def many(self):
        draw = self.draw
        inner = draw.random() < 0.3
        self.start(20 if inner else 40, 5)
        x0, z0 = self.x, self.z
        high, first = self.between(0.8, 2), self.between(0.2, 0.5)
        end = self.to(self.u(26 if inner else 30), self.between(-30, -15))
        self.x, self.z = x0, z0
        taper = self.between(-1, -0.2) * (-1 if inner else 1) if draw.random() < 0.3 else None
        if self.one_block:
            self.add(f"G76 {end}{f' I{self.num(taper)}' if taper else ''} K{self.num(high)} D{self.whole(first)} "
                     f"{self.lead()}{draw.choice([' A60', ' A55', '', ' A0'])}")
        else:
            fine = self.u(draw.choice([0, 0.05, 0.1]))
            self.add(f"G76 P{draw.randint(1, 3):02d}00{draw.choice(['60', '55', '00', '29'])} Q{self.whole(self.u(draw.choice([0.05, 0.1])))} R{self.num(fine)}")
            self.add(f"G76 {end}{f' R{self.num(taper)}' if taper else ''} P{self.whole(high)} Q{self.whole(first)} {self.lead()}")

    def call(self):
        draw = self.draw
        number, count = 7000 + len(self.subs), draw.randint(1, 4)
        self.start(60, -5)
        self.add(draw.choice([f"M98 P{number} L{count}", f"M98 P{count}{number}", f"M98 P{count:04d}{number}"]) if count > 1 else f"M98 P{number}")
        kept, self.rows = self.rows, []
        z, x, back = self.between(1, 3), self.between(2, 8), "G90" if self.is_b else None
        if self.is_b:
            self.rows += ["G91", f"G00 Z{self.num(-z)}", f"G01 X{self.num(-x)} {self.feed()}", f"G00 X{self.num(x)}", back]
        else:
            self.rows += [f"G00 W{self.num(-z)}", f"G01 U{self.num(-x)} {self.feed()}", f"G00 U{self.num(x)}"]
        self.subs.append([f"O{number}"] + self.rows + ["M99"])
        self.rows = kept
        self.z -= z * count
        self.start(60, 3)

    def dwell(self):
        self.add(self.draw.choice(["G04 P500", "G04 X1.5", "G04 U.25", "G04 X1000", "G04 P1200", "G4 U2."]))

    def home(self):
        words = self.draw.choice(["U0 W0", "U0. W0.", "U0", "W0", "W5.", "X70. Z5.", "U2. W2."])
        self.absolute()
        if self.is_b:
            words = self.draw.choice(["X70. Z5.", "Z5.", "X70."])
        self.add(f"G28 {words}")
        self.start(60, 3)

    def shift(self):
        draw = self.draw
        if draw.random() < 0.5:
            self.add(f"G50 U{self.num(self.u(1.5))} W{self.num(self.u(-2))}")
            self.add(f"G00 W{self.num(self.u(1))}")
        else:
            self.add(f"G50 X{self.num(self.x + self.u(1))} Z{self.num(self.z)}")
        self.start(60, 3)
