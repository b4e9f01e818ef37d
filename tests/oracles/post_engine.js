// The functions of Autodesk's post engine that a turning post uses, as its documentation has
// them, and a player of jobs.
//
//   node tests/oracles/post_engine.js posts/fusion/gsk980td.cps JOB.json [name=value …]
//
// A job is a list of operations: {tool, speed | surfaceSpeed, feedMode, moves}. Moves have the
// radius x and z: ["rapid", x, z], ["line", x, z, feed], ["arc", clockwise, cx, cz, x, z, feed],
// ["thread", x, z, pitch, incrementalX].
"use strict";
const fs = require("fs");
const vm = require("vm");

const [, , postFile, jobFile, ...settings] = process.argv;
const job = JSON.parse(fs.readFileSync(jobFile, "utf8"));
let output = "";

function createFormat({ decimals = 6, forceDecimal = false, scale = 1 }) {
  return {
    format(value) {
      let text = (Math.round(value * scale * 10 ** decimals) / 10 ** decimals).toFixed(decimals);
      if (decimals > 0) text = text.replace(/0+$/, "");
      if (!forceDecimal) text = text.replace(/\.$/, "");
      return text === "-0." ? "0." : text === "-0" ? "0" : text;
    },
  };
}

const engine = {
  CAPABILITY_TURNING: 2, MM: 1, IN: 2, PLANE_ZX: 1, PLANE_XY: 0, TYPE_TURNING: 1,
  FEED_PER_MINUTE: 0, FEED_PER_REVOLUTION: 1, COOLANT_OFF: 0, COOLANT_FLOOD: 1,
  SPINDLE_CONSTANT_SPINDLE_SPEED: 0, SPINDLE_CONSTANT_SURFACE_SPEED: 1,
  COMMAND_STOP: 1, COMMAND_OPTIONAL_STOP: 2, COMMAND_COOLANT_ON: 3, COMMAND_COOLANT_OFF: 4,
  COMMAND_STOP_SPINDLE: 5,
  setCodePage() {}, spatial: (value) => value, toRad: (degrees) => (degrees * Math.PI) / 180,
  createFormat,
  writeln(text) { output += text + "\n"; },
  error(text) { throw new Error(text); },
  unit: 1, programName: String(job.number || 1), programComment: job.comment || "",
  hasParameter: (name) => name === "operation-comment",
  getFramePosition: (position) => position,
  isHelical: () => false,
  expandCyclePoint() { throw new Error("cycle is not played"); },
};
const context = vm.createContext({ ...engine, Math, parseFloat, parseInt, String, console });
vm.runInContext(fs.readFileSync(postFile, "utf8"), context, { filename: postFile });
for (const setting of settings) {
  const [name, value] = setting.split("=");
  context.properties[name].value = JSON.parse(value);
}

context.onOpen();
for (const operation of job.operations) {
  const isSurface = operation.surfaceSpeed !== undefined;
  const start = operation.moves[0];
  context.tool = {
    number: operation.tool, clockwise: true, coolant: engine.COOLANT_FLOOD,
    surfaceSpeed: (operation.surfaceSpeed || 0) * 1000, maximumSpindleSpeed: operation.limit || 0,
  };
  context.spindleSpeed = operation.speed;
  context.getParameter = () => operation.comment || "";
  context.currentSection = {
    getType: () => engine.TYPE_TURNING,
    feedMode: operation.feedMode === "rev" ? engine.FEED_PER_REVOLUTION : engine.FEED_PER_MINUTE,
    getTool: () => ({
      getSpindleMode: () => isSurface
        ? engine.SPINDLE_CONSTANT_SURFACE_SPEED : engine.SPINDLE_CONSTANT_SPINDLE_SPEED,
    }),
    getInitialPosition: () => ({ x: start[1], y: 0, z: start[2] }),
  };
  context.onSection();
  for (const [kind, ...values] of operation.moves) {
    if (kind === "rapid") context.onRapid(values[0], 0, values[1]);
    if (kind === "line") context.onLinear(values[0], 0, values[1], values[2]);
    if (kind === "arc") {
      const [clockwise, cx, cz, x, z, feed] = values;
      context.getCircularPlane = () => engine.PLANE_ZX;
      context.getCircularRadius = () => Math.hypot(x - cx, z - cz);
      context.onCircular(clockwise, cx, 0, cz, x, 0, z, feed);
    }
    if (kind === "thread") {
      const [x, z, pitch, incrementalX] = values;
      context.cycleType = "thread-turning";
      context.cycle = { pitch, incrementalX };
      context.onCyclePoint(x, 0, z);
    }
  }
  context.onCycleEnd();
  context.onSectionEnd();
}
context.onClose();
process.stdout.write(output);
