#!/usr/bin/env node
// `dap` driven by the test client of VS Code (npm), which nobody here wrote: each scene is a
// debug session of its own.
//
//   npm install --prefix /tmp/debug-client @vscode/debugadapter-testsupport
//   cargo build --release
//   NODE_PATH=/tmp/debug-client/node_modules tests/oracles/debug_client.js [target/release/gsk980td]

const assert = require("node:assert");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { DebugClient } = require("@vscode/debugadapter-testsupport");

const ROOT = path.resolve(__dirname, "..", "..");
const PROGRAM = path.resolve(process.argv[2] || path.join(ROOT, "target/release/gsk980td"));
const ONLY = process.argv[3];
const FOLDER = fs.mkdtempSync(path.join(os.tmpdir(), "debug-client-"));
const THREAD = { threadId: 1 };

function write(name, lines) {
  const file = path.join(FOLDER, name);
  fs.writeFileSync(file, lines.join("\n") + "\n");
  return file;
}

// Lines from 1, as the client counts them.
const MAIN = write("main.CNC", [
  "O0001",
  "G00 X50 Z5",
  "G65 H01 P#200 Q3",
  "G01 X40 F500",
  "M98 P0012",
  "G01 X45",
  "(a comment)",
  "G65 H01 P#200 Q7",
  "G04 X0.2",
  "M30",
]);
const SUB = write("O0012.CNC", ["O0012", "G01 Z4", "M08", "G01 Z3", "M09", "M99"]);
const STOP = write("stop.CNC", ["O0002", "G00 X50 Z5", "M00", "G00 X40", "M30"]);
const FAULT = write("fault.CNC", ["O0003", "G00 X50 Z5", "G01 X40", "G77", "M30"]);
const PLAIN = write("plain.CNC", ["G00 X50 Z5", "G01 X40 F500", "M30"]);
const LOOP = write("loop.CNC", ["O0004", "G00 X50 Z5", "G01 X40 F500", "G01 X50", "M99"]);

const scenes = [];
function scene(name, act, args = []) {
  scenes.push([name, act, args]);
}

async function begin(client, program, prepare = async () => {}, more = {}) {
  await client.initializeRequest();
  const initialized = client.waitForEvent("initialized");
  await client.launchRequest({ program, ...more });
  await initialized;
  await prepare();
  await client.configurationDoneRequest();
}

const stopped = (client) => client.waitForEvent("stopped");

async function place(client) {
  const { body } = await client.stackTraceRequest(THREAD);
  return body.stackFrames.map((frame) => `${path.basename(frame.source.path)}:${frame.line}`);
}

async function value(client, expression) {
  return (await client.evaluateRequest({ expression })).body.result;
}

function lines(client, file, ...wanted) {
  const breakpoints = wanted.map((line) => (typeof line === "number" ? { line } : line));
  return client.setBreakpointsRequest({ source: { path: file }, breakpoints });
}

async function stopAt(client, program, file, ...wanted) {
  const stop = stopped(client);
  await begin(client, program, () => lines(client, file, ...wanted));
  return (await stop).body;
}

async function go(client, request, more = {}) {
  const stop = stopped(client);
  await client[request + "Request"]({ ...THREAD, ...more });
  return (await stop).body;
}

scene("capabilities name what the adapter can do", async (client) => {
  const { body } = await client.initializeRequest();
  for (const name of ["StepBack", "DataBreakpoints", "FunctionBreakpoints", "ConditionalBreakpoints", "GotoTargetsRequest"]) {
    assert.strictEqual(body["supports" + name], true, name);
  }
  assert.deepStrictEqual(body.exceptionBreakpointFilters.map((it) => it.filter), ["alarms", "messages", "collisions"]);
});
scene("a program runs to its end", async (client) => {
  const end = client.waitForEvent("terminated");
  await begin(client, MAIN);
  await end;
});
scene("the exit code is reported", async (client) => {
  const exited = client.waitForEvent("exited");
  await begin(client, MAIN);
  assert.strictEqual((await exited).body.exitCode, 0);
});
scene("a missing program is refused by its name", async (client) => {
  await client.initializeRequest();
  await assert.rejects(client.launchRequest({ program: "/nowhere/a.CNC" }), /a\.CNC/);
});
scene("launch without a program is refused", async (client) => {
  await client.initializeRequest();
  await assert.rejects(client.launchRequest({}), /program/);
});
scene("an unknown request is refused by its name", async (client) => {
  await client.initializeRequest();
  await assert.rejects(client.customRequest("juggle"), /juggle/);
});
scene("stop on entry is before the first block", async (client) => {
  const stop = stopped(client);
  await begin(client, MAIN, undefined, { stopOnEntry: true });
  assert.strictEqual((await stop).body.reason, "entry");
  assert.deepStrictEqual(await place(client), ["main.CNC:1"]);
  assert.strictEqual(await value(client, "tick"), "0");
});
scene("the first step after the entry leads to the second block", async (client) => {
  const stop = stopped(client);
  await begin(client, PLAIN, undefined, { stopOnEntry: true });
  await stop;
  assert.deepStrictEqual(await place(client), ["plain.CNC:1"]);
  await go(client, "next");
  assert.deepStrictEqual(await place(client), ["plain.CNC:2"]);
  const body = await go(client, "stepBack");
  assert.strictEqual(body.reason, "entry");
  assert.deepStrictEqual(await place(client), ["plain.CNC:1"]);
});
scene("before the first block the frame stays at it", async (client) => {
  const stop = stopped(client);
  await begin(client, PLAIN, undefined, { stopOnEntry: true });
  await stop;
  await go(client, "next", { granularity: "instruction" });
  assert.strictEqual(await value(client, "tick"), "1");
  assert.deepStrictEqual(await place(client), ["plain.CNC:1"]);
});
scene("a slot of the ladder forwards and back is the same state", async (client) => {
  const stop = stopped(client);
  await begin(client, MAIN, () => lines(client, MAIN, 4), { instruction: "slot" });
  await stop;
  const state = async () => [await value(client, "tick"), await value(client, "XM"), await value(client, "Y5")];
  const slot = { granularity: "instruction" };
  await go(client, "next", slot);
  const first = await state();
  await go(client, "next", slot);
  const second = await state();
  assert.strictEqual(Number(second[0]), Number(first[0]) + 8);
  await go(client, "stepBack", slot);
  assert.deepStrictEqual(await state(), first);
  await go(client, "next", slot);
  assert.deepStrictEqual(await state(), second);
});
scene("a line breakpoint stops at its line", async (client) => {
  const body = await stopAt(client, MAIN, MAIN, 4);
  assert.strictEqual(body.reason, "breakpoint");
  assert.deepStrictEqual(await place(client), ["main.CNC:4"]);
});
scene("a breakpoint at a comment moves to the next block", async (client) => {
  await begin(client, MAIN, async () => {
    const { body } = await lines(client, MAIN, 7);
    assert.deepStrictEqual(body.breakpoints.map((it) => [it.verified, it.line]), [[true, 8]]);
  });
});
scene("a breakpoint after the last block is not verified", async (client) => {
  await begin(client, MAIN, async () => {
    const { body } = await lines(client, MAIN, 99);
    assert.strictEqual(body.breakpoints[0].verified, false);
    assert.match(body.breakpoints[0].message, /no block/);
  });
});
scene("a breakpoint in a foreign file is not verified", async (client) => {
  await begin(client, MAIN, async () => {
    const { body } = await lines(client, FAULT, 2);
    assert.match(body.breakpoints[0].message, /none of the program files/);
  });
});
scene("a breakpoint in a subprogram has two frames", async (client) => {
  await stopAt(client, MAIN, SUB, 3);
  assert.deepStrictEqual(await place(client), ["O0012.CNC:3", "main.CNC:5"]);
});
scene("the frames can be fetched one at a time", async (client) => {
  await stopAt(client, MAIN, SUB, 3);
  const { body } = await client.stackTraceRequest({ ...THREAD, startFrame: 1, levels: 1 });
  assert.deepStrictEqual(body.stackFrames.map((it) => it.line), [5]);
  assert.strictEqual(body.totalFrames, 2);
});
scene("a condition that holds stops", async (client) => {
  await stopAt(client, MAIN, MAIN, { line: 4, condition: "#200 EQ 3" });
  assert.deepStrictEqual(await place(client), ["main.CNC:4"]);
});
scene("a condition that does not hold does not stop", async (client) => {
  const end = client.waitForEvent("terminated");
  await begin(client, MAIN, () => lines(client, MAIN, { line: 4, condition: "#200 GT 5" }));
  await end;
});
scene("a wrong condition names its column", async (client) => {
  await begin(client, MAIN, async () => {
    const { body } = await lines(client, MAIN, { line: 4, condition: "#200 > 5" });
    assert.match(body.breakpoints[0].message, /column 6/);
  });
});
scene("breakpoints of a file are replaced", async (client) => {
  const stop = stopped(client);
  await begin(client, MAIN, async () => {
    await lines(client, MAIN, 4);
    await lines(client, MAIN, 6);
  });
  await stop;
  assert.deepStrictEqual(await place(client), ["main.CNC:6"]);
});
scene("continue goes to the next breakpoint", async (client) => {
  await stopAt(client, MAIN, MAIN, 4, 6);
  await go(client, "continue");
  assert.deepStrictEqual(await place(client), ["main.CNC:6"]);
});
scene("next steps over a subprogram", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  await go(client, "next");
  assert.deepStrictEqual(await place(client), ["main.CNC:6"]);
});
scene("a breakpoint at a call stops at the first block of its program", async (client) => {
  await stopAt(client, MAIN, MAIN, 5);
  assert.deepStrictEqual(await place(client), ["O0012.CNC:2", "main.CNC:5"]);
});
scene("step in enters a subprogram", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  await go(client, "stepIn");
  assert.deepStrictEqual(await place(client), ["O0012.CNC:2", "main.CNC:5"]);
});
scene("step out leaves a subprogram", async (client) => {
  await stopAt(client, MAIN, SUB, 3);
  await go(client, "stepOut");
  assert.deepStrictEqual(await place(client), ["main.CNC:6"]);
});
scene("the last block of a subprogram still has its caller", async (client) => {
  await stopAt(client, MAIN, SUB, 5);
  assert.deepStrictEqual(await place(client), ["O0012.CNC:5", "main.CNC:5"]);
});
scene("a step of one tick advances the clock by one", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const before = Number(await value(client, "tick"));
  await go(client, "next", { granularity: "instruction" });
  assert.strictEqual(Number(await value(client, "tick")), before + 1);
});
scene("step back goes to the block before", async (client) => {
  await stopAt(client, MAIN, MAIN, 6);
  await go(client, "stepBack");
  assert.deepStrictEqual(await place(client), ["main.CNC:4"]);
});
scene("a step back and a step forwards give the same state", async (client) => {
  await stopAt(client, MAIN, MAIN, 6);
  const before = [await value(client, "tick"), await value(client, "XM"), await value(client, "ZM")];
  await go(client, "stepBack");
  await go(client, "next");
  assert.deepStrictEqual([await value(client, "tick"), await value(client, "XM"), await value(client, "ZM")], before);
});
scene("a tick back and a tick forwards give the same position", async (client) => {
  await stopAt(client, MAIN, MAIN, 6);
  const before = await value(client, "XM");
  await go(client, "stepBack", { granularity: "instruction" });
  await go(client, "stepIn", { granularity: "instruction" });
  assert.strictEqual(await value(client, "XM"), before);
});
scene("reverse continue goes to the breakpoint before", async (client) => {
  await stopAt(client, MAIN, MAIN, 4, 6);
  await go(client, "continue");
  const body = await go(client, "reverseContinue");
  assert.strictEqual(body.reason, "breakpoint");
  assert.deepStrictEqual(await place(client), ["main.CNC:4"]);
});
scene("reverse continue without a breakpoint goes to the beginning", async (client) => {
  await stopAt(client, MAIN, MAIN, 6);
  const body = await go(client, "reverseContinue");
  assert.strictEqual(body.reason, "entry");
  assert.strictEqual(await value(client, "tick"), "0");
  assert.deepStrictEqual(await place(client), ["main.CNC:1"]);
});
scene("a breakpoint stays armed after going back", async (client) => {
  await stopAt(client, MAIN, MAIN, 6);
  await go(client, "reverseContinue");
  await go(client, "continue");
  assert.deepStrictEqual(await place(client), ["main.CNC:6"]);
});
scene("scopes and their values", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const { body } = await client.scopesRequest({ frameId: 1 });
  assert.deepStrictEqual(body.scopes.map((it) => it.name), ["Modal", "Positions", "Variables", "Offsets", "PLC"]);
  const modal = await client.variablesRequest({ variablesReference: body.scopes[0].variablesReference });
  assert.strictEqual(modal.body.variables.find((it) => it.name === "F").value, "500");
});
scene("the variables scope lists #200", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const { body } = await client.variablesRequest({ variablesReference: 4 });
  assert.strictEqual(body.variables.find((it) => it.name === "#200").value, "3");
});
scene("an offset opens to its columns", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const offsets = await client.variablesRequest({ variablesReference: 3 });
  const second = offsets.body.variables.find((it) => it.name === "T2");
  const { body } = await client.variablesRequest({ variablesReference: second.variablesReference });
  assert.deepStrictEqual(body.variables.map((it) => [it.name, it.value])[0], ["T2.X", "1.5"]);
}, ["--offset", "2=1.5,0,0,0"]);
scene("a PLC byte opens to its bits", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const areas = await client.variablesRequest({ variablesReference: 5 });
  const y = areas.body.variables.find((it) => it.name === "Y");
  const bytes = await client.variablesRequest({ variablesReference: y.variablesReference });
  const bits = await client.variablesRequest({ variablesReference: bytes.body.variables[5].variablesReference });
  assert.deepStrictEqual(bits.body.variables.map((it) => it.name).slice(0, 2), ["Y5.0", "Y5.1"]);
});
scene("formulas are evaluated as macro B does", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  assert.strictEqual(await value(client, "#200*2+1"), "7");
  assert.strictEqual(await value(client, "#200 GT 2"), "1");
});
scene("a wrong expression names the rule", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  await assert.rejects(client.evaluateRequest({ expression: "hello" }), /hello is no value/);
});
scene("a function breakpoint stops at a program", async (client) => {
  const stop = stopped(client);
  await begin(client, MAIN, async () => {
    const { body } = await client.setFunctionBreakpointsRequest({ breakpoints: [{ name: "O12" }] });
    assert.strictEqual(body.breakpoints[0].verified, true);
  });
  await stop;
  assert.match((await place(client))[0], /^O0012\.CNC:[12]$/);
});
scene("a function breakpoint may be a position", async (client) => {
  const stop = stopped(client);
  await begin(client, MAIN, () => client.setFunctionBreakpointsRequest({ breakpoints: [{ name: "X<42" }] }));
  await stop;
  const x = Number(await value(client, "X"));
  assert.ok(x < 42 && x > 41.9, String(x));
});
scene("a wrong function breakpoint names the rule", async (client) => {
  await begin(client, MAIN, async () => {
    const { body } = await client.setFunctionBreakpointsRequest({ breakpoints: [{ name: "whenever" }] });
    assert.match(body.breakpoints[0].message, /whenever is no location/);
  });
});
scene("a data breakpoint stops where a variable changes", async (client) => {
  await stopAt(client, MAIN, MAIN, 5);
  const info = await client.dataBreakpointInfoRequest({ name: "#200" });
  assert.strictEqual(info.body.dataId, "#200");
  await client.setDataBreakpointsRequest({ breakpoints: [{ dataId: "#200" }] });
  await go(client, "continue");
  assert.strictEqual(await value(client, "#200"), "7");
});
scene("a data breakpoint finds the last writer backwards", async (client) => {
  await stopAt(client, MAIN, MAIN, 9);
  await client.setDataBreakpointsRequest({ breakpoints: [{ dataId: "#200" }] });
  await lines(client, MAIN);
  await go(client, "reverseContinue");
  assert.strictEqual(await value(client, "#200"), "7");
  const now = Number(await value(client, "tick"));
  await go(client, "stepBack", { granularity: "instruction" });
  assert.strictEqual(await value(client, "#200"), "3");
  assert.strictEqual(Number(await value(client, "tick")), now - 1);
});
scene("an alarm stops if its filter is on", async (client) => {
  const stop = stopped(client);
  await begin(client, FAULT, () => client.setExceptionBreakpointsRequest({ filters: ["alarms"] }));
  const { body } = await stop;
  assert.strictEqual(body.reason, "exception");
  const info = await client.customRequest("exceptionInfo", THREAD);
  assert.match(info.body.exceptionId, /^0\d\d$/);
  assert.match(info.body.description, /\d{3}/);
});
scene("an alarm ends the session if its filter is off", async (client) => {
  const end = client.waitForEvent("terminated");
  await begin(client, FAULT, () => client.setExceptionBreakpointsRequest({ filters: [] }));
  await end;
});
scene("M00 stops, and continue presses cycle start", async (client) => {
  const stop = stopped(client);
  await begin(client, STOP);
  assert.strictEqual((await stop).body.text, "M00");
  const end = client.waitForEvent("terminated");
  await client.continueRequest(THREAD);
  await end;
});
scene("goto runs forwards to a line", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const { body } = await client.customRequest("gotoTargets", { source: { path: MAIN }, line: 9 });
  assert.deepStrictEqual([body.targets[0].line, body.targets[0].label], [9, "G04 X0.2"]);
  const reached = await go(client, "goto", { targetId: body.targets[0].id });
  assert.strictEqual(reached.reason, "goto");
  assert.deepStrictEqual(await place(client), ["main.CNC:9"]);
});
scene("goto backwards has the state of a full run", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const before = [await value(client, "tick"), await value(client, "XM")];
  await lines(client, MAIN);
  const far = await client.customRequest("gotoTargets", { source: { path: MAIN }, line: 9 });
  await go(client, "goto", { targetId: far.body.targets[0].id });
  const near = await client.customRequest("gotoTargets", { source: { path: MAIN }, line: 4 });
  await go(client, "goto", { targetId: near.body.targets[0].id });
  assert.deepStrictEqual([await value(client, "tick"), await value(client, "XM")], before);
});
scene("pause stops an endless program", async (client) => {
  await begin(client, LOOP);
  await new Promise((done) => setTimeout(done, 300));
  const stop = stopped(client);
  await client.pauseRequest(THREAD);
  assert.strictEqual((await stop).body.reason, "pause");
  assert.match((await place(client))[0], /^loop\.CNC:/);
});
scene("terminate ends an endless program", async (client) => {
  await begin(client, LOOP);
  const end = client.waitForEvent("terminated");
  await client.terminateRequest();
  await end;
});
scene("there is one thread", async (client) => {
  await stopAt(client, MAIN, MAIN, 4);
  const { body } = await client.threadsRequest();
  assert.deepStrictEqual(body.threads, [{ id: 1, name: "lathe" }]);
});
scene("the editor's language is used", async (client) => {
  const { body } = await client.initializeRequest({ adapterID: "gsk980td", linesStartAt1: true, columnsStartAt1: true, pathFormat: "path", locale: "zh-cn" });
  assert.strictEqual(body.exceptionBreakpointFilters[0].label, "报警");
});
scene("lines may count from 0", async (client) => {
  await client.initializeRequest({ adapterID: "gsk980td", linesStartAt1: false, pathFormat: "path" });
  const initialized = client.waitForEvent("initialized");
  await client.launchRequest({ program: MAIN });
  await initialized;
  await lines(client, MAIN, 3);
  const stop = stopped(client);
  await client.configurationDoneRequest();
  await stop;
  assert.deepStrictEqual(await place(client), ["main.CNC:3"]);
});

async function main() {
  let failed = 0;
  const chosen = scenes.filter(([name]) => !ONLY || name.includes(ONLY));
  for (const [name, act, args] of chosen) {
    const spawn = { env: { ...process.env, LC_ALL: "C" } };
    // The client starts one word as the runtime and one as the adapter.
    const runtime = path.join(FOLDER, "adapter.sh");
    fs.writeFileSync(runtime, `#!/bin/sh\nexec "${PROGRAM}" "$@" ${args.join(" ")}\n`, { mode: 0o755 });
    const client = new DebugClient(runtime, "dap", "gsk980td", spawn);
    client.defaultTimeout = 20000;
    try {
      await client.start();
      await act(client);
      console.log("ok     ", name);
    } catch (error) {
      failed += 1;
      console.log("FAILED ", name, "\n        ", String(error && error.message || error).split("\n").slice(0, 6).join("\n         "));
    }
    await client.stop().catch(() => {});
  }
  fs.rmSync(FOLDER, { recursive: true });
  console.log(`${chosen.length - failed} of ${chosen.length} scenes`);
  process.exit(failed || chosen.length === 0 ? 1 : 0);
}

main();
