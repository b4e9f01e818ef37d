// Starts `gsk980td lsp` and hands VS Code's questions about part programs to it.

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const SECTION = "gsk980td";

let client;

exports.activate = async function activate() {
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
