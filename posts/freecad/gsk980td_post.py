"""FreeCAD post processor for GSK980TD lathes.

Copy this file into FreeCAD's macro folder and choose `gsk980td` as the post processor of the
job. Paths lie in the plane XZ: X is a radius, Z the spindle axis, as the turning tools of
FreeCAD and G18 have it. X is written as a diameter, distances as positions, feeds as mm/min
(G98) or, with --per-revolution and after G95, as mm/r (G99). Lengths are in mm.

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



class PostError(Exception):
    """A path that this control cannot follow, or a wrong argument."""


class ArgumentParser(argparse.ArgumentParser):
    """Reports a wrong argument as an error; argparse would end FreeCAD."""

    def error(self, message):
        raise PostError(f"arguments of the post: {message}")


parser = ArgumentParser(prog="gsk980td", add_help=False)
parser.add_argument("--number", type=int, default=1, help="program number, 1 to 9999")
parser.add_argument("--no-comments", action="store_true", help="write no comments")
parser.add_argument("--no-sequence-numbers", action="store_true", help="write no N words")
parser.add_argument("--per-revolution", action="store_true", help="feeds in mm/r (G99)")
parser.add_argument("--arcs", choices=("ik", "r"), default="ik", help="arcs by I and K or by R")
parser.add_argument("--diameter", action="store_true", help="X of the paths is a diameter, I not")
parser.add_argument("--max-speed", type=int, default=0, help="limit of the speed under G96, r/min")
parser.add_argument("--change-x", type=float, default=100.0, help="X of the tool change, diameter")
parser.add_argument("--change-z", type=float, default=100.0, help="Z of the tool change")
parser.add_argument("--no-show-editor", action="store_true", help="accepted, has no effect")
TOOLTIP_ARGS = parser.format_help()

RAPIDS = ("G0", "G00")
ARCS = ("G2", "G02", "G3", "G03")
LINES = ("G1", "G01")
HOLES = ("G73", "G81", "G82", "G83")
PLANES = ("G17", "G18", "G19")
# Codes that this control does not need: unit, compensation off, zero, exact stop.
SKIPPED = {"G21", "G40", "G43", "G49", "G54", "G61", "G64", "G80", "M2", "M02", "M30", ""}
ZEROS = {"G55", "G56", "G57", "G58", "G59"}
M_CODES = {
    "M0": "M00", "M00": "M00", "M1": "M00", "M01": "M00", "M3": "M03", "M03": "M03",
    "M4": "M04", "M04": "M04", "M5": "M05", "M05": "M05", "M7": "M08", "M07": "M08",
    "M8": "M08", "M08": "M08", "M9": "M09", "M09": "M09",
}

# A longer arc is divided: the shorter an arc, the less the rounding of R moves its centre.
LONGEST_RADIUS_ARC = math.radians(120.0)
# Rounding can turn the direction of an arc with a chord this short, in mm; it becomes a line.
SHORTEST_CHORD = 0.003
# Greatest difference of the distances from the centre to both ends of an arc, in mm.
CIRCLE_TOLERANCE = 0.01


def number(value):
    """A number with at most three decimals and a point."""
    text = f"{round(value, 3):.3f}".rstrip("0")
    return "0." if text in ("-0.", "0.") else text


def comment_text(text):
    """Characters that a comment of the control can hold."""
    plain = text.upper().replace("(", " ").replace(")", " ").replace("%", " ").replace(";", " ")
    return " ".join("".join(c if " " <= c <= "~" else " " for c in plain).split())


def operation_property(item, name, default):
    """A property of an operation, or of the operation that a dressup changes."""
    for _ in range(20):
        if hasattr(item, name):
            return getattr(item, name)
        item = getattr(item, "Base", None)
    return default


def command_text(name, parameters):
    """A command as FreeCAD shows it, for messages."""
    return " ".join([name, *(f"{letter}{value:.6g}" for letter, value in parameters.items())])


class Writer:
    """The blocks of a program, with the modal words in force."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.lines = []
        self.sequence = 0
        # Position in the coordinates of the paths.
        scale = 1.0 if arguments.diameter else 0.5
        self.x, self.z = arguments.change_x * scale, arguments.change_z
        # Position as it was written: diameter and Z.
        self.written = [number(arguments.change_x), number(arguments.change_z)]
        self.motion = self.feed_word = None
        self.feed_code = "G99" if arguments.per_revolution else "G98"
        self.feed = None
        self.is_feed_per_revolution = False
        self.speed = 0.0
        self.is_surface_speed = False
        # M03 or M04 while the spindle turns.
        self.direction = None
        # A tool was called, and neither M03 nor M04 has followed yet.
        self.needs_direction = False
        self.has_tool = False
        self.ends_coolant = False
        self.last_comment = None
        self.begin_item()

    def begin_item(self):
        """Resets the modal codes that each operation sets for itself."""
        self.plane = "G17"
        self.incremental = False
        self.returns_to_level = False

    def block(self, words):
        """Adds a block."""
        if self.ends_coolant:
            self.ends_coolant = False
            self.block(["M09"])
        if not self.arguments.no_sequence_numbers:
            self.sequence = self.sequence + 10 if self.sequence < 9990 else 10
            words = [f"N{self.sequence}", *words]
        self.lines.append(" ".join(words))
        self.last_comment = None

    def comment(self, text):
        """Adds a comment, once."""
        plain = comment_text(text)
        if plain and plain != self.last_comment and not self.arguments.no_comments:
            self.lines.append(f"({plain})")
            self.last_comment = plain

    def begin_coolant(self, mode):
        """M08 for an operation with coolant; it stays on between two such operations."""
        if mode not in ("Flood", "Mist"):
            return
        if self.ends_coolant:
            self.ends_coolant = False
        else:
            self.block(["M08"])

    def end_coolant(self, mode):
        """M09 after an operation with coolant."""
        self.ends_coolant = mode in ("Flood", "Mist")

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
        """G98, G99 and F, if they changed. Feeds of the paths are a 60th of F."""
        if self.feed is None or self.feed <= 0.0:
            raise PostError("the feed is 0; set it in the tool controller")
        code, value = "G98", self.feed * 60.0
        if self.is_feed_per_revolution:
            code = "G99"
        elif self.arguments.per_revolution:
            if self.speed <= 0.0:
                raise PostError("a feed per revolution needs a spindle speed")
            code, value = "G99", value / self.speed
        if code == "G99":
            text = f"{max(value, 0.0001):.4f}".rstrip("0")
        else:
            text = number(max(value, 0.001))
        codes = [] if code == self.feed_code else [code]
        if not codes and text == self.feed_word:
            return []
        self.feed_code, self.feed_word = code, text
        return [*codes, f"F{text}"]

    def confirm_spindle(self):
        """Stops the spindle if the tool was called without a direction of rotation."""
        if self.needs_direction and self.direction:
            self.block(["M05"])
            self.direction = None
        self.needs_direction = False

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
        for axis in "YABCUVW":
            if abs(parameters.get(axis, 0.0)) > 1e-6:
                raise PostError(f"axis {axis} leaves the plane XZ")
        x, z = parameters.get("X"), parameters.get("Z")
        if self.incremental:
            return self.x + (x or 0.0), self.z + (z or 0.0)
        return (self.x if x is None else x), (self.z if z is None else z)

    def arc(self, code, parameters):
        """An arc; X of the control is a diameter, I a radius."""
        if self.plane != "G18":
            raise PostError("an arc needs G18 before it in the same operation")
        x, z = self.target(parameters)
        i, k = parameters.get("I", 0.0), parameters.get("K", 0.0)
        if abs(parameters.get("J", 0.0)) > 1e-6:
            raise PostError("J leaves the plane XZ")
        start = (self.diameter(self.x) / 2.0, self.z)
        end = (self.diameter(x) / 2.0, z)
        centre = (start[0] + i, start[1] + k)
        radius = math.hypot(i, k)
        if abs(math.dist(centre, end) - radius) > CIRCLE_TOLERANCE or radius < 0.001:
            raise PostError("an arc does not end on its circle")
        code = "G02" if code in ("G2", "G02") else "G03"
        before = math.atan2(start[0] - centre[0], start[1] - centre[1])
        after = math.atan2(end[0] - centre[0], end[1] - centre[1])
        # With X upwards and Z to the right, G03 turns from Z towards X.
        turn = 1.0 if code == "G03" else -1.0
        sweep = turn * (after - before) % (2.0 * math.pi)
        chord = math.dist(start, end)
        if chord < 1e-6:
            sweep = 2.0 * math.pi
        elif chord < SHORTEST_CHORD and sweep < math.pi:
            self.move_to("G01", x, z)
            return
        if self.arguments.arcs == "r":
            count = math.ceil((sweep - 1e-6) / LONGEST_RADIUS_ARC)
            for part in range(1, count):
                angle = before + turn * sweep * part / count
                point_x = centre[0] + radius * math.sin(angle)
                point_x *= 2.0 if self.arguments.diameter else 1.0
                point_z = centre[1] + radius * math.cos(angle)
                self.move_to(code, point_x, point_z, [f"R{number(radius)}"])
            self.move_to(code, x, z, [f"R{number(radius)}"])
            return
        # The centre counts from the start as it is written, not as it was computed.
        from_x = centre[0] - float(self.written[0]) / 2.0
        from_z = centre[1] - float(self.written[1])
        self.move_to(code, x, z, [f"I{number(from_x)}", f"K{number(from_z)}"])

    def thread(self, parameters):
        """A thread in one pass: G33 of the paths has the lead in K."""
        lead = parameters.get("K", 0.0)
        if lead <= 0.0:
            raise PostError("a thread has no lead K")
        x, z = self.target(parameters)
        # The control counts the lead along the axis with the longer travel.
        if abs(self.diameter(x) - self.diameter(self.x)) / 2.0 > abs(z - self.z):
            raise PostError("the lead of a thread counts along Z, but X has the longer travel")
        words = self.coordinate_words(x, z)
        self.x, self.z, self.motion, self.feed_word = x, z, "G32", None
        self.block(["G32", *words, f"F{number(lead)}"])

    def drill(self, code, parameters):
        """A hole on the axis, in single moves."""
        if self.incremental:
            raise PostError("a drilling cycle needs G90")
        x, bottom = self.target(parameters)
        if abs(x) > 1e-6:
            raise PostError("the hole is not on the spindle axis")
        start = self.z
        level = parameters.get("R", start)
        peck = parameters.get("Q", 0.0) if code in ("G73", "G83") else 0.0
        if bottom > level:
            raise PostError("the bottom of the hole is above its level R")
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
        if not self.returns_to_level and start > level:
            self.move_to("G00", x, start)

    def tool_change(self, parameters):
        """T with the offset of the same number, at the position of the tool change."""
        tool = int(parameters.get("T", 0))
        if not 1 <= tool <= 32:
            raise PostError(f"tool {tool} is outside 1 to 32")
        scale = 1.0 if self.arguments.diameter else 0.5
        self.move_to("G00", self.arguments.change_x * scale, self.arguments.change_z)
        self.block([f"T{tool:02}{tool:02}"])
        self.has_tool = self.needs_direction = True
        self.is_surface_speed = False

    def speed_word(self, speed):
        """S of at most four digits."""
        if not 0 <= round(speed) <= 9999:
            raise PostError(f"spindle speed {speed:.0f} is outside 0 to 9999")
        return f"S{round(speed)}"

    def spindle(self, code, parameters):
        """M03, M04 with the speed."""
        code = M_CODES[code]
        if self.direction not in (None, code):
            self.block(["M05"])
        words = []
        if "S" in parameters:
            word = self.speed_word(parameters["S"])
            words = [f"G96 {word}"] if self.is_surface_speed else [f"G97 {word}"]
            if not self.is_surface_speed:
                self.speed = parameters["S"]
        self.block([*words, code])
        self.direction, self.needs_direction = code, False

    def surface_speed(self, parameters):
        """G96 with its limit: D of the paths, else the option."""
        if parameters.get("S", 0.0) <= 0.0:
            raise PostError("G96 has no surface speed S")
        limit = parameters.get("D", 0.0) or self.arguments.max_speed
        if limit:
            self.block([f"G50 {self.speed_word(limit)}"])
        self.block([f"G96 {self.speed_word(parameters['S'])}"])
        self.is_surface_speed = True

    def constant_speed(self, parameters):
        """G97 with its speed."""
        self.speed = parameters.get("S", self.speed)
        self.block([f"G97 {self.speed_word(self.speed)}"])
        self.is_surface_speed = False

    def modal_code(self, name):
        """A code that changes how later commands are read; false for another code."""
        if name in PLANES:
            self.plane = name
        elif name in ("G90", "G91"):
            self.incremental = name == "G91"
        elif name in ("G94", "G95"):
            self.is_feed_per_revolution = name == "G95"
        elif name in ("G98", "G99"):
            self.returns_to_level = name == "G99"
        else:
            return False
        return True

    def command(self, name, parameters):
        """One command of a path."""
        is_cut = name in LINES or name in ARCS or name in HOLES
        if is_cut and "F" in parameters:
            self.feed = parameters["F"]
        if is_cut or name in RAPIDS or name == "G33":
            self.confirm_spindle()
        if name.startswith("("):
            self.comment(name.strip("()"))
        elif name in RAPIDS:
            self.move_to("G00", *self.target(parameters))
        elif name in LINES:
            self.move_to("G01", *self.target(parameters))
        elif name in ARCS:
            self.arc(name, parameters)
        elif name == "G33":
            self.thread(parameters)
        elif name in HOLES:
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
            self.constant_speed(parameters)
        elif name in M_CODES:
            self.block([M_CODES[name]])
            if M_CODES[name] == "M05":
                self.direction = None
        elif name in ZEROS:
            raise PostError(f"{name}: this control has one work zero, G54 of the job")
        elif not self.modal_code(name) and name not in SKIPPED:
            raise PostError(f"{name} has no equivalent on this control")

    def item(self, item, path):
        """The path of an operation, a tool controller or a work zero."""
        label = getattr(item, "Label", "")
        is_zero = getattr(item, "Name", "") == "Fixture"
        coolant = operation_property(item, "CoolantMode", "None")
        self.begin_item()
        self.begin_coolant(coolant)
        if not is_zero:
            self.comment(label)
        for index, command in enumerate(path.Commands, 1):
            name, parameters = command.Name, dict(command.Parameters)
            # Before the first tool, the retraction of a work zero has no purpose.
            if is_zero and not self.has_tool and name in RAPIDS:
                continue
            try:
                self.command(name, parameters)
            except PostError as why:
                text = command_text(name, parameters)
                raise PostError(f"{label}, line {index} ({text}): {why}") from None
        self.end_coolant(coolant)


def export(objectslist, filename, argstring):
    """Writes the paths of the objects into a file (`-`: none) and returns the program."""
    arguments = parser.parse_args(shlex.split(argstring or ""))
    if not 1 <= arguments.number <= 9999:
        raise PostError("arguments of the post: --number is outside 1 to 9999")
    writer = Writer(arguments)
    writer.block([writer.feed_code])
    writer.block([f"G50 X{writer.written[0]}", f"Z{writer.written[1]}"])
    for item in objectslist:
        path = getattr(item, "Path", None)
        if path is not None and operation_property(item, "Active", True):
            writer.item(item, path)
    scale = 1.0 if arguments.diameter else 0.5
    writer.move_to("G00", arguments.change_x * scale, arguments.change_z)
    writer.ends_coolant = False
    writer.block(["M05"])
    writer.block(["M09"])
    writer.block(["M30"])
    text = "\n".join(["%", f"O{arguments.number:04}", *writer.lines, "%"]) + "\n"
    if filename != "-":
        with open(filename, "w", encoding="ascii", newline="\n") as file:
            file.write(text)
    return text
