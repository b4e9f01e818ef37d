/**
 * Post processor for GSK980TD lathes, for Fusion and other programs with Autodesk's post engine.
 *
 * X is a diameter, positions are absolute, arcs have I and K or R, feeds follow the operation
 * (G98 or G99), speeds G97 or G96 with G50 S. Threads are written as G92 passes.
 *
 * Licence: MIT or Apache-2.0, at your choice.
 */

description = "GSK980TD";
vendor = "GSK CNC";
vendorUrl = "https://www.gsk.com.cn";
legal = "MIT or Apache-2.0";
certificationLevel = 2;
minimumRevision = 45702;
longDescription = "Programs of the GSK980TD lathe control.";
extension = "CNC";
programNameIsInteger = true;
setCodePage("ascii");
capabilities = CAPABILITY_TURNING;
tolerance = spatial(0.002, MM);
minimumChordLength = spatial(0.05, MM);
minimumCircularRadius = spatial(0.05, MM);
maximumCircularRadius = spatial(1000, MM);
minimumCircularSweep = toRad(0.1);
// A radius of three decimals leaves the centre uncertain near 180 degrees.
maximumCircularSweep = toRad(120);
allowHelicalMoves = false;
allowedCircularPlanes = 1 << PLANE_ZX;

properties = {
  arcsByRadius: {
    title: "Arcs by R", description: "Arcs have R instead of I and K.", type: "boolean",
    value: false
  },
  maximumSpeed: {
    title: "Greatest speed", description: "Limit under G96 if the operation has none, r/min.",
    type: "integer", value: 2000
  },
  changeX: {
    title: "X of the tool change", description: "A diameter, mm.", type: "number", value: 100
  },
  changeZ: {
    title: "Z of the tool change", description: "mm.", type: "number", value: 100
  },
  sequenceNumbers: {
    title: "Sequence numbers", description: "Blocks have N words.", type: "boolean", value: true
  }
};

var xFormat = createFormat({decimals: 3, forceDecimal: true, scale: 2}); // diameter
var zFormat = createFormat({decimals: 3, forceDecimal: true});
var leadFormat = createFormat({decimals: 4, forceDecimal: true});
var speedFormat = createFormat({decimals: 0});
var secondsFormat = createFormat({decimals: 3, forceDecimal: true});

var sequenceNumber = 0;
var feedMode; // G98 or G99 in force
var motionCode; // code of group 01 in force
var feedWord; // F in force
var writtenX; // X in force, a diameter
var writtenZ;

function property(name) {
  var item = properties[name];
  return (typeof getProperty === "function") ? getProperty(name) :
    (item !== null && typeof item === "object") ? item.value : item;
}

function writeBlock(words) {
  var list = words.filter(function (word) { return word; });
  if (list.length === 0) {
    return;
  }
  if (property("sequenceNumbers")) {
    sequenceNumber = sequenceNumber < 9990 ? sequenceNumber + 10 : 10;
    list.unshift("N" + sequenceNumber);
  }
  writeln(list.join(" "));
}

function commentText(text) {
  return String(text).toUpperCase().replace(/[^ -~]|[();%]/g, " ").replace(/ +/g, " ").trim();
}

function onComment(text) {
  var plain = commentText(text);
  if (plain) {
    writeln("(" + plain + ")");
  }
}

function xWord(x) {
  var text = xFormat.format(x);
  if (text === writtenX) {
    return "";
  }
  writtenX = text;
  return "X" + text;
}

function zWord(z) {
  var text = zFormat.format(z);
  if (text === writtenZ) {
    return "";
  }
  writtenZ = text;
  return "Z" + text;
}

function feedWordOf(feed) {
  var text = feedMode === "G99" ? leadFormat.format(feed) : zFormat.format(feed);
  if (text === feedWord) {
    return "";
  }
  feedWord = text;
  return "F" + text;
}

function motionWord(code) {
  if (code === motionCode) {
    return "";
  }
  motionCode = code;
  return code;
}

function onOpen() {
  var name = parseInt(programName, 10);
  if (!(name >= 1 && name <= 9999)) {
    error("The program name must be a number from 1 to 9999.");
    return;
  }
  if (unit !== MM) {
    error("The control reads millimetres: choose millimetres in the post dialog.");
    return;
  }
  writeln("%");
  writeln("O" + ("0000" + name).slice(-4));
  if (programComment) {
    onComment(programComment);
  }
  writtenX = createFormat({decimals: 3, forceDecimal: true}).format(property("changeX"));
  writtenZ = zFormat.format(property("changeZ"));
  writeBlock(["G50", "X" + writtenX, "Z" + writtenZ]);
}

/** Moves to the position of the tool change. */
function returnToChange() {
  // X of the property is a diameter, of the functions a radius.
  var words = [xWord(property("changeX") / 2), zWord(property("changeZ"))];
  if (words[0] || words[1]) {
    writeBlock([motionWord("G00")].concat(words));
  }
}

function onSection() {
  if (currentSection.getType() !== TYPE_TURNING) {
    error("This control turns only; the operation is a milling one.");
    return;
  }
  var comment = hasParameter("operation-comment") ? getParameter("operation-comment") : "";
  var number = tool.number;
  if (!(number >= 1 && number <= 32)) {
    error("Tool " + number + " is outside 1 to 32.");
    return;
  }
  returnToChange();
  onComment(comment);
  var offset = tool.compensationOffset || number;
  writeBlock(["T" + ("0" + number).slice(-2) + ("0" + offset).slice(-2)]);
  var mode = currentSection.feedMode === FEED_PER_REVOLUTION ? "G99" : "G98";
  if (mode !== feedMode) {
    feedMode = mode;
    feedWord = undefined;
    writeBlock([mode]);
  }
  startSpindle();
  if (tool.coolant !== undefined && tool.coolant !== COOLANT_OFF) {
    writeBlock(["M08"]);
  }
  var initial = getFramePosition(currentSection.getInitialPosition());
  onRapid(initial.x, initial.y, initial.z);
}

function startSpindle() {
  var direction = tool.clockwise === false ? "M04" : "M03";
  if (currentSection.getTool().getSpindleMode() === SPINDLE_CONSTANT_SURFACE_SPEED) {
    var limit = tool.maximumSpindleSpeed > 0 ? tool.maximumSpindleSpeed : property("maximumSpeed");
    writeBlock(["G50", "S" + speedFormat.format(limit)]);
    writeBlock(["G96", "S" + speedFormat.format(tool.surfaceSpeed / 1000), direction]);
  } else {
    writeBlock(["G97", "S" + speedFormat.format(spindleSpeed), direction]);
  }
}

function onSpindleSpeed(speed) {
  writeBlock(["G97", "S" + speedFormat.format(speed)]);
}

function onRapid(x, y, z) {
  var words = [xWord(x), zWord(z)];
  if (words[0] || words[1]) {
    writeBlock([motionWord("G00")].concat(words));
  }
}

function onLinear(x, y, z, feed) {
  var words = [xWord(x), zWord(z)];
  if (words[0] || words[1]) {
    writeBlock([motionWord("G01")].concat(words, [feedWordOf(feed)]));
  }
}

function onCircular(clockwise, cx, cy, cz, x, y, z, feed) {
  if (isHelical() || getCircularPlane() !== PLANE_ZX) {
    linearize(tolerance);
    return;
  }
  // The plane of the engine is seen from the other side: its clockwise is that of X upwards and
  // Z to the right.
  var code = clockwise ? "G02" : "G03";
  var startX = parseFloat(writtenX) / 2;
  var startZ = parseFloat(writtenZ);
  var center;
  if (property("arcsByRadius")) {
    center = ["R" + zFormat.format(getCircularRadius())];
  } else {
    center = ["I" + zFormat.format(cx - startX), "K" + zFormat.format(cz - startZ)];
  }
  var words = [motionWord(code), xWord(x), zWord(z)];
  writeBlock(words.concat(center, [feedWordOf(feed)]));
}

function onDwell(seconds) {
  writeBlock(["G04", "X" + secondsFormat.format(seconds)]);
}

function onCycle() {
}

function onCyclePoint(x, y, z) {
  if (cycleType !== "thread-turning") {
    expandCyclePoint(x, y, z);
    return;
  }
  // A pass goes to the end of the thread and returns to the start of the cycle. R is the
  // difference of the radii, start minus end.
  var rise = -cycle.incrementalX;
  var words = ["G92", "X" + xFormat.format(x - cycle.incrementalX), "Z" + zFormat.format(z)];
  if (Math.abs(rise) > 0.0005) {
    words.push("R" + zFormat.format(rise));
  }
  words.push("F" + leadFormat.format(cycle.pitch));
  writeBlock(words);
  motionCode = "G92";
  // A lead is no feed.
  feedWord = undefined;
}

function onCycleEnd() {
  if (motionCode === "G92") {
    motionCode = undefined;
  }
}

function onCommand(command) {
  switch (command) {
  case COMMAND_STOP:
  case COMMAND_OPTIONAL_STOP:
    writeBlock(["M00"]);
    break;
  case COMMAND_COOLANT_ON:
    writeBlock(["M08"]);
    break;
  case COMMAND_COOLANT_OFF:
    writeBlock(["M09"]);
    break;
  case COMMAND_STOP_SPINDLE:
    writeBlock(["M05"]);
    break;
  }
}

function onPassThrough(text) {
  writeBlock([text]);
}

function onSectionEnd() {
}

function onClose() {
  returnToChange();
  writeBlock(["M05"]);
  writeBlock(["M09"]);
  writeBlock(["M30"]);
  writeln("%");
}
