"""A model of Fanuc lathe programs (0T, 16/18T, 0i-T A and B system, 10T one-block cycles).

Written from the operator's manuals B-61394E (0T), B-62444E (16/18T), B-63604EN (0i-T) and
B-54810E (10T), without the porter and without the interpreter of `ported_programs.py`. X is a
diameter. `Fanuc(text).run()` returns Moves; moves whose kind or count the manuals leave open are
marked `loose` and compared by their geometry only.
"""

import math

from fanuc_blocks import Move, Unknown, parse


class Fanuc:
    def __init__(self, text, is_b, start, zero, retract=0.5):
        self.programs = parse(text)
        self.is_b, self.retract = is_b, retract
        self.x, self.z = start
        # The reference point in program coordinates; G50 moves it.
        self.home = [zero[0], zero[1]]
        self.inch, self.per_rev, self.relative = False, True, False
        self.feed, self.lead = None, None
        self.code, self.cycle, self.moves = 0, {}, []
        self.depth, self.fine, self.pattern = {}, {}, {}
        self.rest = None
        self.line = 0

    # Numbers: B-61394E part II 5.3. A length without a point counts least increments.
    def length(self, text):
        value = float(text) if "." in text else float(text) * (1e-4 if self.inch else 1e-3)
        return value * 25.4 if self.inch else value

    def rate(self, text):
        return float(text) * (25.4 if self.inch else 1)

    def get(self, words, letter, default=0.0):
        return self.length(words[letter]) if letter in words else default

    def goal(self, words):
        x, z = self.x, self.z
        if "X" in words:
            x = self.length(words["X"]) + (self.x if self.relative else 0)
        if "U" in words:
            x = self.x + self.length(words["U"])
        if "Z" in words:
            z = self.length(words["Z"]) + (self.z if self.relative else 0)
        if "W" in words:
            z = self.z + self.length(words["W"])
        return x, z

    def go(self, kind, x, z, center=None, rate=None, rule=""):
        if math.hypot(x - self.x, z - self.z) > 1e-9 or center:
            if kind in ("feed", "cw", "ccw"):
                rate = self.feed
            self.moves.append(Move(kind, x, z, center, rate, self.line, rule, (self.x, self.z)))
        self.x, self.z = x, z

    def run(self):
        self.call(next(iter(self.programs)), 0)
        return self.moves

    def call(self, number, level):
        if number not in self.programs or level > 4:
            raise Unknown("call")
        blocks, at = self.programs[number], 0
        while at < len(blocks):
            block = blocks[at]
            self.line = block.line
            if 98 in block.m:
                self.state(block)
                digits, count = block.words["P"], int(block.words.get("L", 1))
                if len(digits) > 4:
                    digits, count = digits[-4:], int(digits[:-4])
                begin = len(self.moves)
                for _ in range(count):
                    self.call(int(digits), level + 1)
                for move in self.moves[begin:]:
                    move.rule = move.rule or ("repeated" if self.inch else "")
            else:
                at = self.block(blocks, at)
                if {2, 30} & set(block.m):
                    return
                if 99 in block.m:
                    return
            at += 1

    # Modal codes -----------------------------------------------------------------------------
    def state(self, block):
        b = self.is_b
        cycles = {77: 90, 78: 92, 79: 94} if b else {90: 90, 92: 92, 94: 94}
        for code in block.g:
            if code in (20, 21):
                self.inch = code == 20
            elif code in ((94, 95) if b else (98, 99)):
                self.per_rev = code in (95, 99)
            elif b and code in (90, 91):
                self.relative = code == 91
            elif code in (0, 1, 2, 3, 32, 34) or (b and code == 33):
                self.code, self.cycle = 32 if code == 33 else int(code), {}
            elif code in cycles and not (b and code == 92):
                self.code, self.cycle = cycles[code], {}

    def block(self, blocks, at):
        block = blocks[at]
        words = block.words
        self.state(block)
        codes = set(block.g)
        setting = 92 if self.is_b else 50
        threads = self.code in (92, 32, 34) or 76 in codes
        if "F" in words and not codes & {4, 50} and not threads:
            self.feed = (self.rate(words["F"]), "rev" if self.per_rev else "min")
        if threads and ("F" in words or "E" in words):
            self.lead = self.rate(words.get("F", words.get("E")))
        if 4 in codes:
            self.dwell(words)
        elif 28 in codes:
            self.home_return(words)
        elif setting in codes:
            self.set_position(words)
        elif codes & {70, 71, 72, 73, 74, 75, 76}:
            return self.multiple(blocks, at, int((codes & {70, 71, 72, 73, 74, 75, 76}).pop()))
        elif block.has_axis():
            self.motion(blocks, at)
        elif self.code == 1 and "A" in words:
            self.straight(blocks, at, *self.crossing(blocks, at, words))
        return at

    def dwell(self, words):
        letter = next(l for l in "PXU" if l in words)
        seconds = float(words[letter])
        if letter == "P" or "." not in words[letter]:
            seconds /= 1000
        self.moves.append(Move("dwell", self.x, self.z, None, seconds, self.line))

    def home_return(self, words):
        x, z = self.goal(words)
        self.go("rapid", x, z, rule="G28")
        x = self.home[0] if {"X", "U"} & set(words) else self.x
        z = self.home[1] if {"Z", "W"} & set(words) else self.z
        self.go("rapid", x, z, rule="G28")

    def set_position(self, words):
        x, z = self.x, self.z
        relative, self.relative = self.relative, False
        new_x, new_z = self.goal(words)
        self.relative = relative
        self.home = [self.home[0] + new_x - x, self.home[1] + new_z - z]
        self.x, self.z = new_x, new_z

    # Single moves ----------------------------------------------------------------------------
    def motion(self, blocks, at):
        words = blocks[at].words
        if self.code in (90, 92, 94):
            return self.single_cycle(words)
        if self.rest is not None:
            # Words count from the programmed corner, not from the end of its chamfer.
            here = (self.x, self.z)
            self.x, self.z = self.rest
            x, z = self.goal(words)
            self.x, self.z = here
            self.rest = None
        else:
            x, z = self.goal(words)
        if self.code == 0:
            self.go("rapid", x, z)
        elif self.code == 32:
            self.go("thread", x, z, None, self.lead)
        elif self.code == 34:
            self.go("thread", x, z, None, self.lead, "G34")
        elif self.code == 1:
            self.straight(blocks, at, x, z)
        else:
            self.arc(words, x, z)

    def arc(self, words, x, z):
        clockwise = self.code == 2
        sx, ex = self.x / 2, x / 2
        if "R" in words:
            radius = self.length(words["R"])
            dx, dz = ex - sx, z - self.z
            chord = math.hypot(dx, dz)
            if chord == 0 or radius < chord / 2 - 1e-4:
                raise Unknown("radius")
            height = math.sqrt(max(radius**2 - chord**2 / 4, 0))
            # With Z to the right and X up, the centre of G02 is on the right of the chord.
            nx, nz = (-dz / chord, dx / chord) if clockwise else (dz / chord, -dx / chord)
            center = (sx + dx / 2 + nx * height, self.z + dz / 2 + nz * height)
        else:
            center = (sx + self.get(words, "I"), self.z + self.get(words, "K"))
        self.go("cw" if clockwise else "ccw", x, z, (2 * center[0], center[1]))

    def next_goal(self, blocks, at, x, z):
        """The end of the next block that moves, counted from the corner."""
        here, self.x, self.z = (self.x, self.z), x, z
        code = self.code
        try:
            for block in blocks[at + 1:]:
                if block.has_axis():
                    if set(block.g) & {0, 2, 3, 28, 50}:
                        raise Unknown("corner before another code")
                    nx, nz = self.goal(block.words)
                    if "A" in block.words and not block_has_both(block.words):
                        nx, nz = self.by_angle(block.words, nx, nz)
                    return nx, nz
            raise Unknown("corner without a next block")
        finally:
            (self.x, self.z), self.code = here, code

    def by_angle(self, words, x, z):
        """Direct drawing input, B-63604EN 13.6: the angle counts from +Z towards +X."""
        slope = math.tan(math.radians(float(words["A"])))
        if {"X", "U"} & set(words):
            return x, self.z + (x - self.x) / 2 / slope
        return self.x + 2 * (z - self.z) * slope, z

    def crossing(self, blocks, at, words):
        """The end of a line with an angle only: where the next line, with angle and end, begins."""
        following = next((b for b in blocks[at + 1:] if b.has_axis()), None)
        if following is None or "A" not in following.words or not block_has_both(following.words):
            raise Unknown("angle")
        x, z = self.goal(following.words)
        one, two = math.radians(float(words["A"])), math.radians(float(following.words["A"]))
        dx, dz = (x - self.x) / 2, z - self.z
        along = (dx * math.cos(two) - dz * math.sin(two)) / math.sin(one - two)
        return self.x + 2 * along * math.sin(one), self.z + along * math.cos(one)

    def straight(self, blocks, at, x, z):
        """G01 with a chamfer or a corner arc: B-61394E 14.7, `,C` `,R` 14.8."""
        words = blocks[at].words
        if "A" in words and blocks[at].has_axis() and not block_has_both(words):
            x, z = self.by_angle(words, x, z)
        size = next((words[l] for l in (",C", ",R", "C", "R") if l in words), None)
        is_arc = size is not None and (",R" in words or "R" in words)
        along = {"X", "U"} & set(words), {"Z", "W"} & set(words)
        if size is None:
            # I follows a move along Z, K one along X.
            size = words.get("I") if along[1] and not along[0] else words.get("K") if along[0] and not along[1] else None
        if size is None:
            return self.go("feed", x, z)
        size = abs(self.length(size))
        nx, nz = self.next_goal(blocks, at, x, z)
        before = ((self.x - x) / 2, self.z - z)
        after = ((nx - x) / 2, nz - z)
        one, two = math.hypot(*before), math.hypot(*after)
        if min(one, two) < 1e-6:
            raise Unknown("corner without length")
        b, a = (before[0] / one, before[1] / one), (after[0] / two, after[1] / two)
        cosine = max(-1.0, min(1.0, b[0] * a[0] + b[1] * a[1]))
        reach = size / math.tan(math.acos(cosine) / 2) if is_arc else size
        if reach > one + 1e-6 or reach > two + 1e-6:
            raise Unknown("corner too large")
        self.go("feed", x + 2 * b[0] * reach, z + b[1] * reach, rule="corner")
        ex, ez = x + 2 * a[0] * reach, z + a[1] * reach
        if is_arc:
            mid = (b[0] + a[0], b[1] + a[1])
            norm = math.hypot(*mid)
            far = math.hypot(reach, size)
            center = (2 * (x / 2 + mid[0] / norm * far), z + mid[1] / norm * far)
            # The travel before is -b; a turn to the left, seen with Z right and X up, is G03.
            left = (-b[1]) * a[0] - (-b[0]) * a[1] > 0
            self.go("ccw" if left else "cw", ex, ez, center, rule="corner")
        else:
            self.go("feed", ex, ez, rule="corner")
        self.rest = (x, z)

    def single_cycle(self, words):
        """G90, G92, G94: B-63604EN 13.1. X, Z and the taper are kept from block to block."""
        self.cycle.update({l: w for l, w in words.items() if l in "XZUWRIK"})
        for one, other in ("XU", "ZW"):
            if one in words:
                self.cycle.pop(other, None)
            elif other in words:
                self.cycle.pop(one, None)
        ax, az = self.x, self.z
        x, z = self.goal(self.cycle)
        taper = next((self.length(self.cycle[l]) for l in "RIK" if l in self.cycle), 0.0)
        if self.code == 94:
            steps = [("rapid", ax, z + taper), ("feed", x, z), ("feed", x, az), ("rapid", ax, az)]
        else:
            cut = "thread" if self.code == 92 else "feed"
            back = "rapid" if self.code == 92 else "feed"
            steps = [("rapid", x + 2 * taper, az), (cut, x, z), (back, ax, z), ("rapid", ax, az)]
        for kind, to_x, to_z in steps:
            self.go(kind, to_x, to_z, None, self.lead if kind == "thread" else None, "cycle")

    # Multiple repetitive cycles --------------------------------------------------------------
    def multiple(self, blocks, at, code):
        words = blocks[at].words
        if code == 70:
            self.finish(blocks, words)
            return at
        if code == 76:
            self.threads(words)
            return at
        if code in (74, 75):
            if "R" in words and not set(words) & set("XZUWPQIK"):
                self.pattern["peck"] = self.length(words["R"])
            else:
                self.peck(words, code)
            return at
        if "P" not in words:
            self.pattern[code] = {l: w for l, w in words.items()}
            return at
        return self.rough(blocks, words, code)

    def profile(self, blocks, words):
        """Segments of ns to nf: kind, start, end, centre; lengths in program coordinates."""
        first = next(i for i, b in enumerate(blocks) if b.n == int(words["P"]))
        last = next(i for i, b in enumerate(blocks) if b.n == int(words["Q"]))
        keep = (self.x, self.z, self.moves, self.code, self.feed, self.line, self.relative, self.per_rev)
        self.moves = []
        for at in range(first, last + 1):
            self.line = blocks[at].line
            self.block(blocks, at)
        moves = self.moves
        self.x, self.z, self.moves, self.code, self.feed, self.line, self.relative, self.per_rev = keep
        return moves, last

    def finish(self, blocks, words):
        start, line = (self.x, self.z), self.line
        moves, _ = self.profile(blocks, words)
        self.moves += moves
        if moves:
            self.x, self.z = moves[-1].x, moves[-1].z
            fed = [m.rate for m in moves if m.kind != "rapid"]
            self.feed = fed[-1] if fed else self.feed
        self.line = line
        self.go("rapid", *start, rule="cycle")

    def rough(self, blocks, words, code):
        start = (self.x, self.z)
        moves, last = self.profile(blocks, words)
        rough_feed = self.feed
        u, w = self.get(words, "U"), self.get(words, "W")
        if code == 73:
            self.pattern_passes(words, moves, start, (u, w))
        else:
            self.strip_passes(words, moves, start, (u, w), code)
        self.feed = rough_feed
        self.x, self.z = self.moves[-1].x, self.moves[-1].z
        self.go("rapid", *start, rule="cycle")
        # The program continues after nf.
        return last

    def shifted(self, moves, dx, dz, rule):
        for move in moves:
            center = (move.center[0] + dx, move.center[1] + dz) if move.center else None
            self.go(move.kind, move.x + dx, move.z + dz, center, None, rule)

    def pattern_passes(self, words, moves, start, allowance):
        data = self.pattern.get(73)
        if "D" in words:
            i, k, count = self.get(words, "I"), self.get(words, "K"), int(float(words["D"]))
        else:
            i, k, count = self.get(data, "U"), self.get(data, "W"), float(data["R"])
            # Without a point R counts passes; with one as well.
            count = int(round(count))
        for number in range(count):
            share = 1 - number / (count - 1) if count > 1 else 0
            dx, dz = allowance[0] + 2 * i * share, allowance[1] + k * share
            self.go("rapid", start[0] + dx, start[1] + dz, rule="loose")
            self.shifted(moves, dx, dz, "pass")

    def strip_passes(self, words, moves, start, allowance, code):
        if "D" in words:
            depth = self.length(words["D"])
        else:
            depth = self.get(self.pattern[code], "U" if code == 71 else "W")
        u, w = allowance
        points, at = [], (start[0] + u, start[1] + w)
        for move in moves:
            center = (move.center[0] + u, move.center[1] + w) if move.center else None
            points.append((move.kind, at, (move.x + u, move.z + w), center))
            at = (move.x + u, move.z + w)
        across = 0 if code == 71 else 1
        step = depth * 2 if code == 71 else depth
        begin = (start[0] + u, start[1] + w)[across]
        bottom = points[0][2][across]
        sense = math.copysign(1, bottom - begin)
        level = begin + sense * step
        # A remainder within the rounding of the depths is no pass.
        while (bottom - level) * sense > 0.02:
            end = meeting(points[1:], level, across)
            if end is None:
                raise Unknown("profile")
            begin_along = start[1 - across] + (w if code == 71 else u)
            row = (level, begin_along, end) if code == 71 else (begin_along, level, end)
            self.moves.append(Move("row", row[0] if code == 71 else end, end if code == 71 else level, None, None, self.line, "row"))
            level += sense * step
        self.x, self.z = math.inf, math.inf
        self.shifted(moves, u, w, "contour")

    def peck(self, words, code):
        """G74 along Z, G75 along X: 13.2.5 and 13.2.6; the retract at the bottom is R(d) = 0."""
        ax, az = self.x, self.z
        x, z = self.goal({l: w for l, w in words.items() if l in "XZUW"})
        back = self.pattern.get("peck", self.retract)
        one_block = {"I", "K"} & set(words)
        across = self.get(words, "I" if one_block else "P")
        deep = self.get(words, "K" if one_block else "Q")
        if code == 75:
            across, deep = deep, across
            (from_deep, to_deep), (from_side, to_side) = (ax / 2, x / 2), (az, z)
        else:
            (from_deep, to_deep), (from_side, to_side) = (az, z), (ax / 2, x / 2)
        place = (lambda d, s: (2 * d, s)) if code == 75 else (lambda d, s: (2 * s, d))
        down, aside = math.copysign(1, to_deep - from_deep), math.copysign(1, to_side - from_side)
        side = from_side
        while True:
            deepest = from_deep
            while abs(to_deep - deepest) > 1e-6:
                step = deep if deep else abs(to_deep - deepest)
                deepest = deepest + down * min(step, abs(to_deep - deepest))
                self.go("feed", *place(deepest, side), rule="peck")
                if abs(to_deep - deepest) > 1e-6:
                    self.go("rapid", *place(deepest - down * back, side), rule="peck")
            self.go("rapid", *place(from_deep, side), rule="peck")
            if abs(to_side - side) < 1e-6 or not across:
                break
            side = side + aside * min(across, abs(to_side - side))
            self.go("rapid", *place(from_deep, side), rule="peck")
        self.go("rapid", ax, az, rule="peck")

    def threads(self, words):
        """G76, 13.2.7: the n-th depth is d times the root of n, along the flank of the angle."""
        if "P" in words and not set(words) & set("XZUWFEK"):
            digits = words["P"].zfill(6)
            self.fine = {"m": int(digits[:2]), "r": int(digits[2:4]), "a": int(digits[4:]),
                         "q": self.get(words, "Q"), "d": self.get(words, "R")}
            return
        one_block = "K" in words
        x, z = self.goal({l: w for l, w in words.items() if l in "XZUW"})
        ax, az = self.x, self.z
        if one_block:
            high, first, taper = self.get(words, "K"), self.get(words, "D"), self.get(words, "I")
            fine = {"m": 1, "a": int(float(words.get("A", 0))), "q": 0.0, "d": 0.0}
        else:
            high, first, taper = self.get(words, "P"), self.get(words, "Q"), self.get(words, "R")
            fine = self.fine
        out = math.copysign(1, ax - x)
        slope = math.tan(math.radians(fine["a"] / 2))
        depths, depth, number = [], 0.0, 0
        limit = high - fine["d"]
        while depth < limit - 1e-9:
            number += 1
            depth = min(limit, max(first * math.sqrt(number), depth + fine["q"]))
            depths.append(depth)
        roughing = len(depths)
        depths += [high] * fine["m"]
        # Between two passes the manual moves to the start; the approach is along the flank.
        for number, deep in enumerate(depths):
            level = x + 2 * out * (high - deep)
            self.moves.append(Move("pass", level, z, None, self.lead, self.line, "G76" if number < roughing else "G76 end"))
            self.moves[-1].center = (taper, az - z, -deep * slope)
        self.x, self.z = math.inf, math.inf
        self.go("rapid", ax, az, rule="cycle")


def block_has_both(words):
    return bool({"X", "U"} & set(words)) and bool({"Z", "W"} & set(words))


def meeting(points, level, across):
    """Where a line at a level meets the profile, first along the profile."""
    for kind, one, two, center in points:
        low, high = sorted((one[across], two[across]))
        if not low - 1e-9 <= level <= high + 1e-9 or high - low < 1e-9:
            continue
        if center is None:
            share = (level - one[across]) / (two[across] - one[across])
            return one[1 - across] + share * (two[1 - across] - one[1 - across])
        scale = (0.5, 1.0)
        radius = math.hypot((one[0] - center[0]) / 2, one[1] - center[1])
        off = (level - center[across]) * scale[across]
        along = math.sqrt(max(radius**2 - off**2, 0)) / scale[1 - across]
        choices = [center[1 - across] + along, center[1 - across] - along]
        low, high = sorted((one[1 - across], two[1 - across]))
        return next((c for c in choices if low - 1e-6 <= c <= high + 1e-6), choices[0])
    return None
