"""Makes jobs in FreeCAD and exports them through the post, for `freecad.py`.

FreeCAD's console program runs this file. `FREECAD_JOBS` names a JSON file with the folder of the
output, the post, the number of random jobs and, optionally, the folder of the package `liblathe`.
Each job leaves NAME.json: the commands of the exported objects, the arguments and the error.
"""

import json
import math
import os
import random
import shutil
import sys
import traceback
from pathlib import Path as FilePath

import FreeCAD
import Part
import Path
import PathScripts.PathComment as PathComment
import PathScripts.PathCustom as PathCustom
import PathScripts.PathDressupAxisMap as PathDressupAxisMap
import PathScripts.PathDrilling as PathDrilling
import PathScripts.PathHelix as PathHelix
import PathScripts.PathJob as PathJob
import PathScripts.PathOp as PathOp
import PathScripts.PathPost as PathPost
import PathScripts.PathPreferences as PathPreferences
import PathScripts.PathProfile as PathProfile
import PathScripts.PathStop as PathStop
import PathScripts.PathToolBit as PathToolBit
import PathScripts.PathToolController as PathToolController
import PathScripts.PathUtils as PathUtils
from FreeCAD import Vector
from PathScripts.PathPostProcessor import PostProcessor

SETTINGS = json.loads(FilePath(os.environ["FREECAD_JOBS"]).read_text())
OUT = FilePath(SETTINGS["out"])
TOOLS = FilePath(PathPreferences.pathDefaultToolsPath())
POST = "gsk980td"


def shaft():
    """A shaft with a shoulder, a cone, arcs of both senses and a bore; X is a radius."""
    points = [Vector(x, 0, z) for x, z in (
        (0, 0), (8, 0), (10, -2), (10, -15), (13, -25), (13, -35), (16, -38), (16, -44),
        (19, -47), (19, -60), (0, -60), (0, 0))]
    edges = [Part.makeLine(a, b) for a, b in zip(points, points[1:])]
    # The first arc is concave, the second convex.
    half = 3 * math.sqrt(0.5)
    arcs = {5: (16 - half, -35 - half), 7: (16 + half, -47 + half)}
    for index, (x, z) in arcs.items():
        edges[index] = Part.Arc(points[index], Vector(x, 0, z), points[index + 1]).toShape()
    solid = Part.Face(Part.Wire(edges)).revolve(Vector(0, 0, 0), Vector(0, 0, 1), 360)
    return solid.cut(Part.makeCylinder(2.5, 20, Vector(0, 0, -20)))


def block_with_hole():
    """A disc with a hole beside the axis."""
    return Part.makeCylinder(20, 10, Vector(0, 0, -10)).cut(
        Part.makeCylinder(2.5, 10, Vector(12, 0, -10)))


class Turning(PathOp.ObjectOp):
    """An operation as a turning add-on has it: a planner makes the commands."""

    def __init__(self, obj, name, job, plan):
        self.plan = plan
        super().__init__(obj, name, job)

    def opFeatures(self, obj):
        return (PathOp.FeatureTool | PathOp.FeatureCoolant | PathOp.FeatureDiameters
                | PathOp.FeatureDepths)

    def opSetDefaultValues(self, obj, job):
        box = job.Stock.Shape.BoundBox
        obj.OpStartDepth, obj.OpFinalDepth = box.ZMax, box.ZMin

    def opExecute(self, obj):
        for name, parameters in self.plan(obj):
            self.commandlist.append(Path.Command(name, parameters))


class Shop:
    """A document with one job."""

    def __init__(self, name, shape=None, arguments="", units=0):
        self.name, self.arguments = name, arguments
        FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Units").SetInt("UserSchema", units)
        self.document = FreeCAD.newDocument(name)
        self.model = self.document.addObject("Part::Feature", "Shaft")
        self.model.Shape = shape or shaft()
        self.job = PathJob.Create("Job", [self.model], None)
        # In the window, the user chooses the tool controller.
        PathUtils.findToolController = lambda obj, proxy, name=None: self.job.Tools.Group[0]
        self.job.PostProcessor = POST
        self.controllers = {}

    def controller(self, number, label, bit="5mm_Endmill", speed=800, direction="Forward",
                   feed="120 mm/min"):
        """A tool controller."""
        if not self.controllers:
            controller = self.job.Tools.Group[0]
            controller.ToolNumber, controller.Label = number, label
        else:
            tool = PathToolBit.Factory.CreateFrom(str(TOOLS / f"Bit/{bit}.fctb"), label)
            controller = PathToolController.Create(label, tool=tool, toolNumber=number)
            self.job.Proxy.addToolController(controller)
        controller.SpindleSpeed, controller.SpindleDir = speed, direction
        controller.HorizFeed = controller.VertFeed = feed
        controller.HorizRapid = controller.VertRapid = "3000 mm/min"
        self.controllers[number] = controller
        return controller

    def prepared(self, operation, number, coolant):
        """An operation with its tool and coolant."""
        operation.ToolController = self.controllers[number]
        operation.CoolantMode = coolant
        return operation

    def custom(self, label, number, lines, coolant="None"):
        """FreeCAD's operation of typed commands; F is in mm/s."""
        operation = PathCustom.Create(label, parentJob=self.job)
        operation.Gcode = lines
        return self.prepared(operation, number, coolant)

    def turning(self, label, number, plan, coolant="None"):
        """An operation of an add-on."""
        obj = self.document.addObject("Path::FeaturePython", label)
        obj.Proxy = Turning(obj, label, self.job, plan)
        return self.prepared(obj, number, coolant)

    def drilling(self, label, number, peck=0.0, dwell=0.0, level="G98", coolant="None"):
        """FreeCAD's drilling of all holes of the model."""
        obj = self.milling(PathDrilling.ObjectDrilling, label, number)
        obj.PeckEnabled, obj.PeckDepth = peck > 0.0, peck
        obj.DwellEnabled, obj.DwellTime = dwell > 0.0, dwell
        obj.ReturnLevel = level
        return self.prepared(obj, number, coolant)

    def milling(self, kind, label, number):
        """An operation of milling, of all holes of the model if it takes holes."""
        obj = self.document.addObject("Path::FeaturePython", label)
        obj.Proxy = kind(obj, label, self.job)
        if hasattr(obj.Proxy, "findAllHoles"):
            obj.Proxy._setBaseAndStock(obj)
            obj.Proxy.findAllHoles(obj)
        return self.prepared(obj, number, "None")

    def export(self, refused=None, note=None, name=None):
        """Exports as the command *Post Process* does, and stores what went in."""
        name = name or self.name
        self.document.recompute()
        self.job.PostProcessorArgs = self.arguments
        self.job.PostProcessorOutputFile = str(OUT / f"{name}%s.CNC")
        command = PathPost.CommandPathPost()
        # With one program, FreeCAD leaves out the number of the part.
        lists = command.buildPostList(self.job)
        for index, objects in enumerate(lists, 1):
            part = f"{name}_{index}" if self.job.SplitOutput else name
            record = record_of(objects, part, self.arguments)
            record.update(refused=refused, note=note)
            try:
                failed, text, written = command.exportObjectsWith(objects, self.job)
                record["written"] = written
                record["same"] = not failed and FilePath(written).read_text() == text
            except BaseException as why:
                record["error"] = [type(why).__name__, str(why)]
            (OUT / f"{part}.json").write_text(json.dumps(record))

    def close(self):
        """Closes the document."""
        FreeCAD.closeDocument(self.document.Name)


def record_of(objects, name, arguments):
    """The exported objects, for the comparison."""
    items = []
    for item in objects:
        base = item
        while not hasattr(base, "CoolantMode") and hasattr(base, "Base") \
                and hasattr(base.Base, "Path"):
            base = base.Base
        items.append({
            "label": item.Label, "is_zero": item.Name == "Fixture",
            "coolant": getattr(base, "CoolantMode", "None"),
            "active": getattr(base, "Active", True),
            "commands": [[it.Name, dict(it.Parameters)] for it in item.Path.Commands],
        })
    return {"name": name, "arguments": arguments, "items": items, "error": None}


def planned(kind, outline, stock, **parameters):
    """A plan of the package `liblathe`: its commands for an outline of points and bulges."""
    def plan(obj):
        sys.path.insert(0, SETTINGS["liblathe"])
        import importlib
        from liblathe.base.point import Point
        from liblathe.base.segment import Segment
        from liblathe.tool.tool import Tool
        names = {"face": "FaceOP", "rough": "RoughOP", "profile": "ProfileOP",
                 "partoff": "PartoffOP"}
        operation = getattr(importlib.import_module(f"liblathe.op.{kind}"), names[kind])()
        controller = obj.ToolController
        operation.setParams({
            "step_over": 1.0, "finish_passes": 1, "stock_to_leave": 0.0, "clearance": 2.0,
            "hfeed": controller.HorizFeed.Value, "vfeed": controller.VertFeed.Value, **parameters})
        operation.add_stock_from_limits(*stock)
        segments = [Segment(Point(*a[:2]), Point(*b[:2]), b[2])
                    for a, b in zip(outline, outline[1:])]
        operation.addPartSegments(segments)
        operation.add_tool(Tool("DCMT070204R"))
        sys.path.pop(0)
        return [(it.get_movement(), it.getParams()) for it in operation.getGCode()]
    return plan


# The outline of the shaft for the planner: X, Z and the bulge of the piece that ends there.
QUARTER = math.tan(math.pi / 8.0)
OUTLINE = [(0, 0, 0), (8, 0, 0), (10, -2, 0), (10, -15, 0), (13, -25, 0), (13, -35, 0),
           (16, -38, -QUARTER), (16, -44, 0), (19, -47, QUARTER), (19, -60, 0)]
STOCK = (0.0, 21.0, -60.0, 1.0)


def od_turning():
    """Roughing and finishing of the shaft by the planner, with coolant."""
    for by_radius in (False, True):
        shop = Shop("od_turning_r" if by_radius else "od_turning",
                    arguments="--no-show-editor" + (" --arcs r --number 7" if by_radius else ""))
        shop.controller(1, "TC: rough", speed=900, feed="150 mm/min")
        shop.controller(2, "TC: finish", speed=1500, feed="90 mm/min")
        shop.turning("Rough", 1, planned("rough", OUTLINE, STOCK, stock_to_leave=0.3), "Flood")
        shop.turning("Finish", 2, planned("profile", OUTLINE, STOCK), "Flood")
        shop.export()
        shop.close()


def facing():
    """Facing by the planner, feeds per revolution."""
    shop = Shop("facing", arguments="--per-revolution --no-comments")
    shop.controller(3, "TC: face", speed=1000, feed="200 mm/min")
    shop.turning("Face", 3, planned("face", OUTLINE, (0.0, 21.0, -60.0, 2.0)), "Mist")
    shop.export()
    shop.close()


def boring():
    """A bore with a cone and arcs of both senses, from typed commands."""
    shop = Shop("boring")
    shop.controller(4, "TC: bore", speed=700)
    shop.custom("Bore", 4, [
        "G18", "G90", "G0 X9 Z2", "G1 Z-10 F1.5", "G3 X7 Z-12 I-2 K0", "G1 X6 Z-14 F1.2",
        "G2 X4 Z-16 I0 K-2", "G1 Z-20", "G1 X3.5", "G0 Z2"], "Flood")
    shop.export()
    shop.close()


def grooving():
    """A groove with a dwell, then parting off by the planner."""
    shop = Shop("grooving")
    shop.controller(5, "TC: groove", speed=500, feed="30 mm/min")
    shop.controller(6, "TC: part off", speed=400, feed="20 mm/min")
    shop.custom("Groove", 5, ["G0 X22 Z-50", "G1 X16 F0.5", "G4 P0.8", "G0 X22", "G0 Z-49",
                              "G1 X16.2 F0.5", "G1 Z-50", "G0 X22"])
    shop.turning("Part off", 6, planned("partoff", OUTLINE, STOCK), "Flood")
    shop.export()
    shop.close()


def arc_lines(seed, count):
    """Arcs of both senses of 0.001 to 359 degrees, with the plane before them."""
    pick = random.Random(seed)
    x, z, lines = 20.0, 0.0, [("G18", {}), ("G0", {"X": 20.0, "Z": 0.0})]
    for _ in range(count):
        sweep = pick.choice((1, -1)) * pick.choice(
            (pick.uniform(0.001, 0.1), pick.uniform(1, 170), pick.uniform(170, 190),
             pick.uniform(190, 359), 90.0, 180.0))
        radius, angle = pick.uniform(0.5, 9.0), pick.uniform(0, 2 * math.pi)
        i, k = -radius * math.sin(angle), -radius * math.cos(angle)
        end = angle + math.radians(sweep)
        x, z = x + i + radius * math.sin(end), z + k + radius * math.cos(end)
        lines.append(("G3" if sweep > 0 else "G2", {"X": x, "Z": z, "I": i, "K": k, "F": 2.0}))
        x, z = pick.uniform(20, 40), pick.uniform(-30, 0)
        lines.append(("G0", {"X": x, "Z": z}))
    return lines


def arcs():
    """Arcs of both senses, by I and K and by R, and in both conventions of X."""
    for name, words in (("arcs", ""), ("arcs_r", "--arcs r"), ("arcs_diameter", "--diameter"),
                        ("arcs_diameter_r", "--diameter --arcs r")):
        shop = Shop(name, arguments=words)
        shop.controller(1, "TC: arcs")
        lines = arc_lines(name, 60)
        if "diameter" in name:
            lines = [(it, {**p, **({"X": 2.0 * p["X"]} if "X" in p else {})}) for it, p in lines]
        shop.turning("Arcs", 1, lambda obj, lines=lines: lines)
        shop.export()
        shop.close()


def drilling():
    """FreeCAD's drilling: plain, dwell, pecks, both return levels."""
    shop = Shop("drilling")
    shop.controller(1, "TC: unused")
    shop.controller(8, "TC: drill", "5mm_Drill", speed=1200, feed="60 mm/min")
    shop.drilling("Drill", 8, coolant="Flood")
    shop.drilling("Drill with dwell", 8, dwell=0.5, level="G99")
    shop.drilling("Drill in pecks", 8, peck=3.0, level="G99")
    shop.drilling("Drill in pecks again", 8, peck=2.5, coolant="Flood")
    shop.export()
    shop.close()


def several_tools():
    """Four tools, both directions and none, in the three orders, as one program and in parts."""
    for order, split in (("Fixture", False), ("Tool", False), ("Operation", False),
                         ("Tool", True)):
        shop = Shop(f"tools_{order.lower()}{'_split' if split else ''}")
        shop.controller(1, "TC: rough (äöü)", speed=900)
        shop.controller(2, "TC: left-hand thread", speed=300, direction="Reverse")
        shop.controller(3, "TC: still", direction="None")
        shop.controller(4, "TC: drill", "5mm_Drill", speed=1000, feed="60 mm/min")
        shop.custom("Turn", 1, ["G0 X18 Z2", "G1 Z-20 F2", "G0 X22", "G0 Z2"], "Flood")
        shop.custom("Thread", 2, ["G0 X11 Z5", "G0 X9.5", "G33 Z-12 K1.5", "G0 X11", "G0 Z5"])
        shop.custom("Turn again", 1, ["G0 X17 Z2", "G1 Z-20 F2", "G1 X18 F1", "G0 X22 Z2"],
                    "Flood")
        shop.custom("Scribe", 3, ["G0 X20 Z2", "G0 X16.9", "G1 Z-5 F1", "G0 X20 Z2"])
        shop.drilling("Drill", 4, peck=4.0, coolant="Mist")
        shop.job.OrderOutputBy, shop.job.SplitOutput = order, split
        shop.export()
        if order == "Fixture":
            saved_and_opened(shop)
        shop.close()


def saved_and_opened(shop):
    """The same job after FreeCAD has saved and opened it."""
    file = OUT / "saved.FCStd"
    shop.document.saveAs(str(file))
    shop.close()
    shop.document = FreeCAD.openDocument(str(file))
    shop.job = shop.document.getObject("Job")
    shop.export(name="tools_saved", note="equals tools_fixture")


def inch_job():
    """A document in inches: FreeCAD converts, the program is in mm."""
    shop = Shop("inch_job", units=3)
    shop.controller(1, "TC: rough", speed=600, feed="6 in/min")
    inch = FreeCAD.Units.Quantity("0.75 in").Value
    shop.turning("Turn", 1, lambda obj: [
        ("G18", {}), ("G0", {"X": inch, "Z": 2.54}),
        ("G1", {"Z": -FreeCAD.Units.Quantity("1.25 in").Value,
                "F": obj.ToolController.HorizFeed.Value}),
        ("G2", {"X": inch + 3.175, "Z": -34.925, "I": 3.175, "K": 0.0,
                "F": obj.ToolController.HorizFeed.Value}),
        ("G0", {"X": inch + 6.35, "Z": 2.54})])
    shop.export()
    shop.close()


def empty_job():
    """A job without operations."""
    shop = Shop("empty_job")
    shop.export()
    shop.close()


def inactive_and_stops():
    """Inactive operations, distances of G91, a stop, a comment, a compound."""
    shop = Shop("inactive")
    shop.controller(1, "TC: rough")
    first = shop.custom("Turn", 1, ["G0 X18 Z2", "G1 Z-20 F2", "G0 X22", "G0 Z2"])
    second = shop.custom("Off", 1, ["G0 X1 Z-50"])
    second.Active = False
    third = shop.custom("Turn on", 1, ["G0 X17 Z2", "G1 Z-20 F2", "G0 X22", "G0 Z2"], "Flood")
    fourth = shop.custom("Distances", 1, [
        "G0 X22 Z2", "G91", "G0 X-6", "G1 Z-12 F1.5", "G1 X2 Z-3", "G0 X4", "G0 Z15", "G90",
        "G0 X23"])
    stop = shop.document.addObject("Path::FeaturePython", "Stop")
    PathStop.Stop(stop)
    stop.Stop = "Mandatory"
    PathUtils.addToJob(stop)
    comment = shop.document.addObject("Path::FeaturePython", "Comment")
    PathComment.Comment(comment)
    comment.Comment = "Measure the diameter: 36 ±0.02 %;"
    PathUtils.addToJob(comment)
    shop.job.Operations.Group = [first, second, stop, comment, third, fourth]
    shop.document.recompute()
    shop.export()
    # A selection with the inactive operation; FreeCAD 0.20 leaves stop and comment out of jobs.
    selection = [first, second, stop, comment]
    record = record_of(selection, "selection", "--no-show-editor")
    record["lines"] = ["M00", "(MEASURE THE DIAMETER: 36 0.02)"]
    PostProcessor.load(POST).export(selection, str(OUT / "selection.CNC"), "--no-show-editor")
    (OUT / "selection.json").write_text(json.dumps(record))
    # A compound of paths, as its commands.
    compound = shop.document.addObject("Path::FeatureCompound", "Compound")
    compound.Group = [shop.controllers[1], first]
    shop.document.recompute()
    record = record_of([compound], "compound", "")
    PostProcessor.load(POST).export([compound], str(OUT / "compound.CNC"), "")
    (OUT / "compound.json").write_text(json.dumps(record))
    shop.close()


def spindle_modes():
    """G95, G96 and G97 in typed commands, coolant by M codes."""
    shop = Shop("spindle_modes", arguments="--max-speed 2500")
    shop.controller(1, "TC: finish", speed=800)
    # F is a 60th of the word: 0.2 mm/r.
    feed = 0.2 / 60.0
    shop.custom("Surface speed", 1, [
        "G96 S150 D1800", "M8", "G95", "G0 X20 Z2", f"G1 Z-10 F{feed:.9f}", "G1 X22",
        "G94", "G1 Z-12 F1.5", "G97 S600", "G1 X24", "M9", "G0 Z2"])
    shop.custom("Limit of the post", 1, ["G96 S120", "G0 X20 Z2", "G1 Z-4 F1", "M5", "M4 S90",
                                         "G1 X22", "G0 Z2"])
    shop.export()
    shop.close()


def random_jobs():
    """Random lines, arcs, rapids, tools, feeds and coolant."""
    for index in range(SETTINGS["count"]):
        pick = random.Random(f"{SETTINGS['seed']} {index}")
        words = pick.choice(("", "--arcs r", "--per-revolution", "--no-comments",
                             "--no-sequence-numbers --change-x 120 --change-z 60.5"))
        shop = Shop(f"random{index}", Part.makeCylinder(20, 50, Vector(0, 0, -50)), words)
        numbers = pick.sample(range(1, 33), pick.randint(1, 3))
        for number in numbers:
            shop.controller(number, f"TC {number}", speed=pick.randint(50, 3000),
                            direction=pick.choice(("Forward", "Reverse")))
        for place in range(pick.randint(1, 4)):
            lines, x, z = [("G18", {})], pick.uniform(2, 30), pick.uniform(1, 5)
            lines.append(("G0", {"X": x, "Z": z, "F": 50.0}))
            for _ in range(pick.randint(1, 15)):
                kind = pick.choice(("G0", "G1", "G1", "arc", "arc"))
                if kind == "arc":
                    radius, angle = pick.uniform(0.2, 12), pick.uniform(0, 2 * math.pi)
                    i, k = -radius * math.sin(angle), -radius * math.cos(angle)
                    sweep = pick.choice((1, -1)) * pick.uniform(0.01, 3.1)
                    end_x = x + i + radius * math.sin(angle + sweep)
                    if end_x > 0.5:
                        z += k + radius * math.cos(angle + sweep)
                        x = end_x
                        words_of_arc = {"X": x, "Z": z, "I": i, "K": k,
                                        "F": pick.uniform(0.1, 5)}
                        lines.append(("G3" if sweep > 0 else "G2", words_of_arc))
                        continue
                    kind = "G1"
                axis = pick.choice(("X", "Z", "XZ"))
                x = pick.uniform(1, 30) if "X" in axis else x
                z = pick.uniform(-50, 3) if "Z" in axis else z
                words_of_line = {it: {"X": x, "Z": z}[it] for it in axis}
                if kind == "G1" or pick.random() < 0.5:
                    words_of_line["F"] = pick.uniform(0.1, 5)
                lines.append((kind, words_of_line))
            shop.turning(f"Operation {place}", pick.choice(numbers),
                         lambda obj, lines=lines: lines,
                         pick.choice(("None", "Flood", "Mist")))
        shop.export()
        shop.close()


def refusals():
    """What the control cannot do: the message names operation and reason, no file appears."""
    for name, lines, words in (
            ("cycle", ["G0 X12 Z2", "G76 P1 Z-10"], ["Bad", "line 4", "G76"]),
            ("no_plane", ["G0 X12 Z2", "G2 X14 Z0 I2 K0 F1"], ["Bad", "G18"]),
            ("off_plane", ["G0 X12 Y3"], ["Bad", "axis Y"]),
            ("rotary", ["G0 X12 A90"], ["Bad", "axis A"]),
            ("no_feed", ["G0 X12 Z2", "G1 Z-5"], ["Bad", "feed is 0"]),
            ("rapid_feed", ["G0 X12 Z2 F50", "G1 Z-5"], ["Bad", "feed is 0"]),
            ("inches", ["G20", "G0 X1"], ["Bad", "G20"]),
            ("broken_arc", ["G18", "G0 X12 Z2", "G2 X14 Z0 I5 K0 F1"], ["Bad", "circle"]),
            ("hole", ["G0 X0 Z5", "G81 X0 Y4 Z-5 R2 F1"], ["Bad", "axis Y"]),
            ("speed", ["M3 S24000"], ["Bad", "24000"]),
            ("compensation", ["G41 D1"], ["Bad", "G41"]),
            ("lead", ["G0 X12 Z2", "G33 Z-10"], ["Bad", "lead"])):
        shop = Shop(f"refused_{name}")
        shop.controller(1, "TC: bad", feed="0 mm/min")
        shop.custom("Bad", 1, lines)
        shop.export(refused=words)
        shop.close()
    shop = Shop("refused_off_axis")
    shop.controller(1, "TC: drill", "5mm_Drill")
    hole = shop.drilling("Hole", 1)
    hole.Base, hole.Locations = [], [Vector(12, 0, 0)]
    shop.export(refused=["Hole", "G81", "not on the spindle axis"])
    shop.close()
    for kind, label, shape in ((PathHelix.ObjectHelix, "Helix", block_with_hole()),
                               (PathProfile.ObjectProfile, "Profile", None)):
        shop = Shop(f"refused_{label.lower()}", shape)
        shop.controller(1, "TC: mill")
        shop.milling(kind, label, 1)
        shop.export(refused=[label])
        shop.close()
    shop = Shop("refused_map")
    shop.controller(1, "TC: map")
    operation = shop.custom("Engrave", 1, ["G0 X1 Y0 Z5", "G1 X9 Y2 Z5 F1"])
    shop.document.recompute()
    dressup = shop.document.addObject("Path::FeaturePython", "Map")
    PathDressupAxisMap.ObjectDressup(dressup)
    dressup.Base, dressup.Radius, dressup.AxisMap = operation, 10.0, "Y->A"
    shop.job.Proxy.addOperation(dressup, operation, True)
    shop.export(refused=["Map", "axis A"])
    shop.close()
    shop = Shop("refused_zero")
    shop.controller(1, "TC: zero")
    shop.custom("Turn", 1, ["G0 X12 Z2"])
    shop.job.Fixtures = ["G54", "G55"]
    shop.export(refused=["G55", "work zero"])
    shop.close()
    for name, arguments, words in (
            ("unknown", "--inches --precision 4", ["arguments of the post", "--inches"]),
            ("number", "--number 10000", ["--number"]),
            ("word", "--number five", ["--number", "five"])):
        shop = Shop(f"refused_argument_{name}", arguments=arguments)
        shop.controller(1, "TC: turn")
        shop.export(refused=words)
        shop.close()
    shop = Shop("refused_tool")
    shop.controller(33, "TC: 33")
    shop.custom("Turn", 33, ["G0 X12 Z2"])
    shop.export(refused=["TC: 33", "tool 33"])
    shop.close()
    shop = Shop("refused_revolution", arguments="--per-revolution")
    shop.controller(1, "TC: still", direction="None")
    shop.custom("Turn", 1, ["G0 X12 Z2", "G1 Z-5 F1"])
    shop.export(refused=["Turn", "spindle speed"])
    shop.close()


def tool_files():
    """Reads the exported tool files and saves them again; FreeCAD lacks the shapes of inserts."""
    document, refused = FreeCAD.newDocument("tools"), []
    saved = OUT / "saved/Bit"
    saved.mkdir(parents=True)
    for file in sorted((OUT / "tools/Bit").glob("*.fctb")):
        try:
            tool = PathToolBit.Factory.CreateFrom(str(file), file.stem)
        except TypeError:
            refused.append(file.stem)
            continue
        tool.Proxy.saveToFile(tool, str(saved / file.name))
    (OUT / "tools/refused").write_text(" ".join(refused))
    FreeCAD.closeDocument(document.Name)


def main():
    """All jobs."""
    macros = FilePath(PathPreferences.macroFilePath())
    macros.mkdir(parents=True, exist_ok=True)
    shutil.copy(SETTINGS["post"], macros / f"{POST}_post.py")
    if POST not in PathPreferences.allEnabledPostProcessors():
        raise AssertionError("FreeCAD does not find the post in its macro folder")
    post = PostProcessor.load(POST)
    if (post.units, post.machineName) != ("Metric", "GSK980TD") or not post.tooltipArgs:
        raise AssertionError("FreeCAD does not read the description of the post")
    PathPreferences.setOutputFileDefaults("", "Overwrite existing file")
    jobs = [boring, arcs, drilling, several_tools, inch_job, empty_job, inactive_and_stops,
            spindle_modes, refusals, random_jobs, tool_files]
    if SETTINGS["liblathe"]:
        jobs += [od_turning, facing, grooving]
    for job in jobs:
        job()
    (OUT / "done").write_text(" ".join(FreeCAD.Version()[:3]))


try:
    main()
except BaseException:
    (OUT / "failure").write_text(traceback.format_exc())
