"""FreeCAD post processor for GSK980TD lathes.

Copy this file into FreeCAD's macro folder and choose `gsk980td` as the post processor of the
job. Paths lie in the plane XZ: X is a radius, Z the spindle axis, as the turning tools of
FreeCAD and G18 have it. X is written as a diameter, distances as positions, feeds as mm/min
(G98) or, with --per-revolution, as mm/r (G99).

Licence: MIT or Apache-2.0, at your choice.
"""

import argparse
import math
import shlex

TOOLTIP = "Writes programs of the GSK980TD lathe control."
MACHINE_NAME = "GSK980TD"
UNITS = "G21"
CORNER_MIN = {"x": -500, "y": 0, "z": -2000}
CORNER_MAX = {"x": 500, "y": 0, "z": 2000}

parser = argparse.ArgumentParser(prog="gsk980td", add_help=False)
parser.add_argument("--number", type=int, default=1, help="program number, 1 to 9999")
parser.add_argument("--no-comments", action="store_true", help="write no comments")
parser.add_argument("--no-sequence-numbers", action="store_true", help="write no N words")
parser.add_argument("--per-revolution", action="store_true", help="feeds in mm/r (G99)")
parser.add_argument("--arcs", choices=("ik", "r"), default="ik", help="arcs by I and K or by R")
parser.add_argument("--diameter", action="store_true", help="X of the paths is a diameter")
parser.add_argument("--max-speed", type=int, default=0, help="limit of the speed under G96, r/min")
parser.add_argument("--change-x", type=float, default=100.0, help="X of the tool change, diameter")
parser.add_argument("--change-z", type=float, default=100.0, help="Z of the tool change")
parser.add_argument("--no-show-editor", action="store_true", help="accepted, has no effect")
TOOLTIP_ARGS = parser.format_help()

RAPIDS = ("G0", "G00")
ARCS = ("G2", "G02", "G3", "G03")
# Codes that this control does not need: plane, unit, compensation off, zero, exact stop.
SKIPPED = {
    "G17", "G18", "G19", "G21", "G40", "G43", "G49", "G54", "G61", "G64", "G80", "G90", "G94",
    "G98", "G99",
}
M_CODES = {
    "M0": "M00", "M00": "M00", "M1": "M00", "M01": "M00", "M3": "M03", "M03": "M03",
    "M4": "M04", "M04": "M04", "M5": "M05", "M05": "M05", "M7": "M08", "M07": "M08",
    "M8": "M08", "M08": "M08", "M9": "M09", "M09": "M09",
}


class PostError(Exception):
    """A path that this control cannot follow."""


def number(value):
    """A number with at most three decimals and a point."""
    text = f"{round(value, 3):.3f}".rstrip("0")
    return "0." if text in ("-0.", "0.") else text


def comment_text(text):
    """Characters that a comment of the control can hold."""
    plain = text.upper().replace("(", " ").replace(")", " ").replace("%", " ").replace(";", " ")
    return " ".join("".join(c if " " <= c <= "~" else " " for c in plain).split())


class Writer:
    """The blocks of a program, with the modal words in force."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.lines = []
        self.sequence = 0
        # Position in the coordinates of the paths; None is unknown.
        self.x = self.z = None
        # Position as it was written: diameter and Z.
        self.written = [None, None]
        self.motion = self.feed_word = None
        self.feed = None
        self.speed = 0.0
        self.incremental = False

    def block(self, words):
        """Adds a block."""
        if not words:
            return
        if not self.arguments.no_sequence_numbers:
            self.sequence = self.sequence + 10 if self.sequence < 9990 else 10
            words = [f"N{self.sequence}", *words]
        self.lines.append(" ".join(words))

    def comment(self, text):
        """Adds a comment."""
        plain = comment_text(text)
        if plain and not self.arguments.no_comments:
            self.lines.append(f"({plain})")

    def diameter(self, x):
        """X of the paths as a diameter."""
        return x if self.arguments.diameter else 2.0 * x

    def coordinate_words(self, x, z):
        """The words of a position whose coordinates change."""
        target = [number(self.diameter(x)), number(z)]
        words = []
        for axis, (letter, text) in enumerate(zip("XZ", target)):
            if self.written[axis] != text:
                words.append(letter + text)
                self.written[axis] = text
        return words

    def feed_words(self):
        """F, if it changed. Feeds of the paths are in mm/s."""
        if self.feed is None or self.feed <= 0.0:
            raise PostError("a cut has no feed")
        value = self.feed * 60.0
        if self.arguments.per_revolution:
            if self.speed <= 0.0:
                raise PostError("feeds per revolution need a spindle speed")
            text = f"{value / self.speed:.4f}".rstrip("0")
        else:
            text = number(max(value, 0.001))
        if text == self.feed_word:
            return []
        self.feed_word = text
        return [f"F{text}"]

    def move_to(self, code, x, z, words=()):
        """A move of group 01 to a position."""
        coordinates = self.coordinate_words(x, z)
        self.x, self.z = x, z
        if not coordinates and not words:
            return
        feeds = [] if code == "G00" else self.feed_words()
        codes = [] if code == self.motion else [code]
        self.motion = code
        self.block(codes + coordinates + list(words) + feeds)

    def target(self, parameters):
        """The end of a move, absolute."""
        if abs(parameters.get("Y", 0.0)) > 1e-6:
            raise PostError("a path leaves the plane XZ")
        x, z = parameters.get("X"), parameters.get("Z")
        if self.incremental:
            x = None if x is None else (self.x or 0.0) + x
            z = None if z is None else (self.z or 0.0) + z
        x = self.x if x is None else x
        z = self.z if z is None else z
        # The first move may give one axis alone.
        return (0.0 if x is None else x), (0.0 if z is None else z)

    def arc(self, code, parameters):
        """An arc; X of the control is a diameter, I a radius."""
        if self.x is None or self.z is None:
            raise PostError("an arc has no start")
        x, z = self.target(parameters)
        i, k = parameters.get("I", 0.0), parameters.get("K", 0.0)
        if abs(parameters.get("J", 0.0)) > 1e-6:
            raise PostError("an arc leaves the plane XZ")
        radius_per_unit = 0.5 if self.arguments.diameter else 1.0
        start_x, end_x = self.x * radius_per_unit, x * radius_per_unit
        i *= radius_per_unit
        code = "G02" if code in ("G2", "G02") else "G03"
        # The centre counts from the start as it is written, not as it was computed.
        written_x = float(self.written[0]) / 2.0
        written_z = float(self.written[1])
        centre = (start_x + i, self.z + k)
        if self.arguments.arcs == "r":
            radius = math.hypot(i, k)
            before = math.atan2(start_x - centre[0], self.z - centre[1])
            after = math.atan2(end_x - centre[0], z - centre[1])
            sweep = (after - before) % (2 * math.pi)
            # With X upwards and Z to the right, G03 turns from Z towards X.
            sweep = sweep if code == "G03" else (2 * math.pi - sweep) % (2 * math.pi)
            if math.pi - 1e-6 < sweep or sweep == 0.0:
                turn = math.pi / 2 if sweep == 0.0 else sweep / 2
                turn = turn if code == "G03" else -turn
                middle = before + turn
                half = (
                    centre[0] + radius * math.sin(middle),
                    centre[1] + radius * math.cos(middle),
                )
                self.radius_arc(code, half, radius)
            self.radius_arc(code, (end_x, z), radius)
            self.x, self.z = x, z
            return
        words = [f"I{number(centre[0] - written_x)}", f"K{number(centre[1] - written_z)}"]
        self.move_to(code, x, z, words)

    def radius_arc(self, code, end, radius):
        """An arc of at most half a turn to a position with X as a radius."""
        x = end[0] * 2.0 if self.arguments.diameter else end[0]
        self.move_to(code, x, end[1], [f"R{number(radius)}"])

    def thread(self, parameters):
        """A thread in one pass: G33 of the paths has the lead in K."""
        lead = parameters.get("K", 0.0)
        if lead <= 0.0:
            raise PostError("a thread has no lead")
        x, z = self.target(parameters)
        words = self.coordinate_words(x, z)
        self.x, self.z, self.motion, self.feed_word = x, z, "G32", None
        self.block(["G32", *words, f"F{number(lead)}"])

    def drill(self, code, parameters):
        """A hole on the axis, in single moves."""
        x, bottom = self.target({key: parameters[key] for key in ("X", "Z") if key in parameters})
        start = self.z if self.z is not None else 0.0
        level = parameters.get("R", start)
        peck = parameters.get("Q", 0.0) if code in ("G73", "G83") else 0.0
        self.move_to("G00", x, start)
        self.move_to("G00", x, level)
        depth = level
        while peck > 0.0 and depth - peck > bottom + 1e-6:
            depth -= peck
            self.move_to("G01", x, depth)
            if code == "G83":
                self.move_to("G00", x, level)
                self.move_to("G00", x, depth + min(0.5, peck / 2))
            else:
                self.move_to("G00", x, depth + min(0.2, peck / 2))
        self.move_to("G01", x, bottom)
        if code == "G82" and parameters.get("P", 0.0) > 0.0:
            self.block([f"G04 X{number(parameters['P'])}"])
        self.move_to("G00", x, level)
        self.move_to("G00", x, start)

    def tool_change(self, parameters):
        """T with the offset of the same number, at the position of the tool change."""
        tool = int(parameters.get("T", 0))
        if not 1 <= tool <= 32:
            raise PostError(f"tool {tool} is outside 1 to 32")
        scale = 1.0 if self.arguments.diameter else 0.5
        x, z = self.arguments.change_x * scale, self.arguments.change_z
        self.move_to("G00", x, z)
        self.block([f"T{tool:02}{tool:02}"])

    def spindle(self, code, parameters):
        """M03, M04 with the speed under G97."""
        if "S" in parameters:
            self.speed = abs(parameters["S"])
            self.block([f"G97 S{round(self.speed)}", M_CODES[code]])
        else:
            self.block([M_CODES[code]])

    def surface_speed(self, parameters):
        """G96 with its limit: D of the paths, else the option."""
        limit = round(parameters.get("D", 0.0)) or self.arguments.max_speed
        if limit:
            self.block([f"G50 S{limit}"])
        self.block([f"G96 S{round(parameters.get('S', 0.0))}"])

    def command(self, name, parameters):
        """One command of a path."""
        if "F" in parameters:
            self.feed = parameters["F"]
        if name.startswith("("):
            self.comment(name.strip("()"))
        elif name in RAPIDS:
            self.move_to("G00", *self.target(parameters))
        elif name in ("G1", "G01"):
            self.move_to("G01", *self.target(parameters))
        elif name in ARCS:
            self.arc(name, parameters)
        elif name == "G33":
            self.thread(parameters)
        elif name in ("G73", "G81", "G82", "G83"):
            self.drill(name, parameters)
        elif name in ("G4", "G04"):
            self.block([f"G04 X{number(parameters.get('P', 0.0))}"])
        elif name in ("M6", "M06"):
            self.tool_change(parameters)
        elif name in ("M3", "M03", "M4", "M04"):
            self.spindle(name, parameters)
        elif name == "G96":
            self.surface_speed(parameters)
        elif name == "G97":
            self.speed = abs(parameters.get("S", self.speed))
            self.block([f"G97 S{round(self.speed)}"])
        elif name in M_CODES:
            self.block([M_CODES[name]])
        elif name == "G91":
            self.incremental = True
        elif name in ("M2", "M02", "M30", "T", "S", "F", "") or name in SKIPPED:
            if name == "G90":
                self.incremental = False
        else:
            raise PostError(f"{name} has no equivalent on this control")


def export(objectslist, filename, argstring):
    """Writes the paths of the objects into a file (`-`: none) and returns the program."""
    arguments = parser.parse_args(shlex.split(argstring))
    if not 1 <= arguments.number <= 9999:
        raise PostError("the program number is outside 1 to 9999")
    writer = Writer(arguments)
    head = f"O{arguments.number:04}"
    writer.block([("G99" if arguments.per_revolution else "G98")])
    start = [f"G50 X{number(arguments.change_x)}", f"Z{number(arguments.change_z)}"]
    writer.block(start)
    scale = 1.0 if arguments.diameter else 0.5
    writer.x, writer.z = arguments.change_x * scale, arguments.change_z
    writer.written = [number(arguments.change_x), number(arguments.change_z)]
    for item in objectslist:
        path = getattr(item, "Path", None)
        if path is None or not getattr(item, "Active", True):
            continue
        writer.comment(getattr(item, "Label", ""))
        for command in path.Commands:
            writer.command(command.Name, dict(command.Parameters))
    writer.move_to("G00", arguments.change_x * scale, arguments.change_z)
    writer.block(["M05"])
    writer.block(["M09"])
    writer.block(["M30"])
    text = "\n".join(["%", head, *writer.lines, "%"]) + "\n"
    if filename != "-":
        with open(filename, "w", encoding="ascii", newline="\n") as file:
            file.write(text)
    return text
