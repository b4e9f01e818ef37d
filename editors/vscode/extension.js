// Starts `gsk980td lsp` and hands VS Code's questions about part programs to it; starts
// `gsk980td dap` to debug one.

const { DebugAdapterExecutable, debug, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const SECTION = "gsk980td";

let client;

/** The program with a command and the options of control and lathe. */
function adapterExecutable() {
  const settings = workspace.getConfiguration(SECTION);
  return new DebugAdapterExecutable(settings.get("path") || "gsk980td", ["dap", ...settings.get("arguments", [])]);
}

/** `F5` without `launch.json` debugs the open program. */
function completeConfiguration(_folder, configuration) {
  if (configuration.type) {
    return configuration;
  }
  return { type: SECTION, request: "launch", name: "Part program", program: "${file}", stopOnEntry: true };
}

exports.activate = async function activate(context) {
  context.subscriptions.push(
    debug.registerDebugAdapterDescriptorFactory(SECTION, { createDebugAdapterDescriptor: adapterExecutable }),
    debug.registerDebugConfigurationProvider(SECTION, { resolveDebugConfiguration: completeConfiguration }),
  );
  const settings = workspace.getConfiguration(SECTION);
  const server = {
    command: settings.get("path") || "gsk980td",
    args: ["lsp", ...settings.get("arguments", [])],
  };
  const options = {
    documentSelector: [
      { scheme: "file", language: SECTION },
      { scheme: "untitled", language: SECTION },
    ],
    initializationOptions: { format: settings.get("format") },
    synchronize: {
      configurationSection: SECTION,
      fileEvents: workspace.createFileSystemWatcher("**/*.{cnc,CNC,nc,NC,tap,TAP}"),
    },
  };
  client = new LanguageClient(SECTION, "GSK980TD", server, options);
  await client.start();
};

exports.deactivate = function deactivate() {
  return client?.stop();
};
