// Starts `gsk980td lsp` and hands VS Code's questions about part programs to it; starts
// `gsk980td dap` to debug one.

const { execFile } = require("child_process");
const {
  DebugAdapterExecutable,
  DebugConfigurationProviderTriggerKind,
  EvaluatableExpression,
  commands,
  debug,
  languages,
  window,
  workspace,
} = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const SECTION = "gsk980td";
/** Exit code of `lsp` if its input ends without a session. */
const NO_SESSION = 1;
const OPEN_SETTINGS = "Open Settings";
const LAUNCH = { type: SECTION, request: "launch", name: "Part program", program: "${file}", stopOnEntry: true };

let client;
let watcher;
/** Ends when the server of the last change of settings has started or failed. */
let starting = Promise.resolve();

/** Path of the program, and its arguments: a command with the options of control and lathe. */
function commandLine(command) {
  const settings = workspace.getConfiguration(SECTION);
  return [settings.get("path") || "gsk980td", [command, ...settings.get("arguments", [])]];
}

/**
 * Whether the program accepts a command with the options of the settings. Shows the reason if it
 * does not, because VS Code itself shows nothing or only that there is no connection.
 */
async function checkCommand(command) {
  const [program, args] = commandLine(command);
  const reason = await new Promise((resolve) => {
    const trial = execFile(program, args, (error, _output, errors) => {
      if (!error || error.code === NO_SESSION) {
        resolve("");
      } else if (error.code === "ENOENT") {
        resolve("there is no such program");
      } else {
        // After the first paragraph come hints for a terminal.
        resolve(errors.trim().split(/\r?\n\r?\n/)[0].replace(/^\w+: /, "") || error.message);
      }
    });
    // Without input the command reads its options and ends.
    trial.stdin?.on("error", () => {}).end();
  });
  if (!reason) {
    return true;
  }
  const text = `${program} ${args.join(" ")} does not start: ${reason}. Check gsk980td.path and gsk980td.arguments.`;
  window.showErrorMessage(text, OPEN_SETTINGS).then((choice) => {
    if (choice) {
      commands.executeCommand("workbench.action.openSettings", SECTION);
    }
  });
  return false;
}

async function startServer() {
  if (client?.isRunning()) {
    await client.stop();
  }
  client = undefined;
  if (!(await checkCommand("lsp"))) {
    return;
  }
  const [command, args] = commandLine("lsp");
  const options = {
    documentSelector: [
      { scheme: "file", language: SECTION },
      { scheme: "untitled", language: SECTION },
    ],
    initializationOptions: { format: workspace.getConfiguration(SECTION).get("format") },
    synchronize: { configurationSection: SECTION, fileEvents: watcher },
  };
  client = new LanguageClient(SECTION, "GSK980TD", { command, args }, options);
  // The client shows its own errors.
  await client.start().catch(() => {});
}

/** Starts the server again: a running one does not read `path` and `arguments`. */
function restartServer(change) {
  if (change.affectsConfiguration("gsk980td.path") || change.affectsConfiguration("gsk980td.arguments")) {
    starting = starting.then(startServer);
  }
}

function createAdapter() {
  return new DebugAdapterExecutable(...commandLine("dap"));
}

/** `F5` without `launch.json` debugs the open program. */
async function resolveConfiguration(_folder, configuration) {
  if (!(await checkCommand("dap"))) {
    return undefined;
  }
  return configuration.type ? configuration : { ...LAUNCH, ...configuration };
}

/**
 * The variable at the pointer, `#200`. Of other words VS Code would request the value as well,
 * and `X38` has none.
 */
function findVariable(document, position) {
  const range = document.getWordRangeAtPosition(position, /#[0-9]+/);
  return range && new EvaluatableExpression(range);
}

/** Steps by a tick or a ladder slot; VS Code has such a step for disassembled programs only. */
function stepInstruction(request) {
  return debug.activeDebugSession?.customRequest(request, { threadId: 1, granularity: "instruction" });
}

exports.activate = async function activate(context) {
  watcher = workspace.createFileSystemWatcher("**/*.{cnc,CNC,nc,NC,tap,TAP}");
  const list = { provideDebugConfigurations: () => [LAUNCH] };
  context.subscriptions.push(
    watcher,
    workspace.onDidChangeConfiguration(restartServer),
    debug.registerDebugAdapterDescriptorFactory(SECTION, { createDebugAdapterDescriptor: createAdapter }),
    debug.registerDebugConfigurationProvider(SECTION, { resolveDebugConfiguration: resolveConfiguration }),
    debug.registerDebugConfigurationProvider(SECTION, list, DebugConfigurationProviderTriggerKind.Dynamic),
    languages.registerEvaluatableExpressionProvider(SECTION, { provideEvaluatableExpression: findVariable }),
    commands.registerCommand("gsk980td.stepInstruction", () => stepInstruction("next")),
    commands.registerCommand("gsk980td.stepInstructionBack", () => stepInstruction("stepBack")),
  );
  starting = starting.then(startServer);
  await starting;
};

exports.deactivate = function deactivate() {
  return client?.isRunning() ? client.stop() : undefined;
};
