#!/usr/bin/env python3
"""Opens the page in real browsers and uses it: mouse, finger, keys, files, a second tab.

    tools/page_check.py PAGE CHECK LINUX_PROGRAM GOLDEN_PROGRAM [chromium] [firefox]

PAGE is the folder that `cargo xtask dist web` builds, CHECK the folder with the session
in which every tick is hashed. The two programs print the expected results on this system.
The script controls both browsers by WebDriver BiDi: Chromium through `chromedriver`,
Firefox directly. It saves pictures of the page in CHECK.
"""

import asyncio
import base64
import functools
import http.server
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path

import websockets

ROOT = Path(__file__).resolve().parent.parent
SIZE = {"width": 1280, "height": 800}
# Positions of controls on a page of this size in English, pixels.
SAMPLES, FIRST_SAMPLE = (232, 14), (280, 44)
SPEED, FASTEST = (1063, 14), (1094, 272)
OPEN = (55, 14)
AUTO, START, POSITION, PROGRAM = (48, 513), (448, 569), (370, 466), (409, 466)
PAGE_DOWN = "\ue00f"
# The native program runs the same sample with the same keys.
SCRIPT = "load 01-stepped-shaft.CNC\npress AUTO\npress CS\nwait idle 600s\nshow\n"
PROGRAM_42 = "O0042\nG50 X100 Z100\nG00 X50 Z50\nM30\n"


def free_port():
    with socket.socket() as asked:
        asked.bind(("127.0.0.1", 0))
        return asked.getsockname()[1]


class Quiet(http.server.SimpleHTTPRequestHandler):
    extensions_map = {
        **http.server.SimpleHTTPRequestHandler.extensions_map,
        ".wasm": "application/wasm",
        ".js": "text/javascript",
    }

    def log_message(self, *_):
        pass


class Browser:
    """One page in a browser."""

    def __init__(self, name):
        self.name = name
        self.count = 0
        self.answers = {}
        self.dialogs = asyncio.Queue()
        self.said = []
        self.home = tempfile.mkdtemp(prefix="page-check-")
        self.process = None
        self.session = None

    async def start(self):
        address = await getattr(self, f"start_{self.name}")()
        for _ in range(120):
            try:
                self.wire = await websockets.connect(address, max_size=None)
                break
            except OSError:
                await asyncio.sleep(0.5)
        self.reader = asyncio.create_task(self.read())
        if self.name == "firefox":
            await self.ask("session.new", capabilities={})
        events = ["log.entryAdded", "input.fileDialogOpened"]
        await self.ask("session.subscribe", events=events)
        tree = await self.ask("browsingContext.getTree")
        self.tab = tree["contexts"][0]["context"]
        await self.ask("browsingContext.setViewport", context=self.tab, viewport=SIZE)

    async def start_chromium(self):
        port = free_port()
        self.process = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL)
        arguments = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader"]
        arguments += ["--enable-unsafe-swiftshader", f"--user-data-dir={self.home}"]
        capabilities = {"webSocketUrl": True, "goog:chromeOptions": {"args": arguments}}
        body = json.dumps({"capabilities": {"alwaysMatch": capabilities}}).encode()
        self.driver = f"http://127.0.0.1:{port}/session"
        for _ in range(60):
            try:
                answer = urllib.request.urlopen(urllib.request.Request(self.driver, body))
                break
            except OSError:
                await asyncio.sleep(0.5)
        answer = json.load(answer)["value"]
        self.session = answer["sessionId"]
        return answer["capabilities"]["webSocketUrl"]

    async def start_firefox(self):
        port = free_port()
        # Without a display Firefox disables WebGL by default.
        settings = {"webgl.force-enabled": True, "browser.shell.checkDefaultBrowser": False}
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});\n" for k, v in settings.items()]
        Path(self.home, "user.js").write_text("".join(lines))
        arguments = ["firefox-esr", "--no-remote", "--profile", self.home]
        arguments += [f"--remote-debugging-port={port}", "about:blank"]
        environment = {**os.environ, "HOME": self.home, "LIBGL_ALWAYS_SOFTWARE": "1"}
        nothing = subprocess.DEVNULL
        self.process = subprocess.Popen(arguments, env=environment, stdout=nothing, stderr=nothing)
        return f"ws://127.0.0.1:{port}/session"

    async def end(self):
        if self.session:
            request = urllib.request.Request(f"{self.driver}/{self.session}", method="DELETE")
            urllib.request.urlopen(request).read()
        self.reader.cancel()
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.home, ignore_errors=True)

    async def read(self):
        async for message in self.wire:
            message = json.loads(message)
            if message.get("id") in self.answers:
                self.answers.pop(message["id"]).set_result(message)
            elif message.get("method") == "input.fileDialogOpened":
                self.dialogs.put_nowait(message["params"])
            elif message.get("method") == "log.entryAdded":
                if message["params"].get("level") == "error":
                    self.said.append(str(message["params"].get("text")))

    async def ask(self, method, **parameters):
        self.count += 1
        answer = self.answers[self.count] = asyncio.get_running_loop().create_future()
        request = {"id": self.count, "method": method, "params": parameters}
        await self.wire.send(json.dumps(request))
        answer = await asyncio.wait_for(answer, 120)
        if answer.get("type") == "error":
            raise RuntimeError(f"{method}: {answer}")
        return answer["result"]

    async def go(self, address, tab=None):
        await self.ask("browsingContext.navigate", context=tab or self.tab, url=address, wait="complete")

    async def js(self, text, tab=None):
        target = {"context": tab or self.tab}
        answer = await self.ask("script.evaluate", expression=text, target=target, awaitPromise=True)
        if answer["type"] != "success":
            raise RuntimeError(f"{text}: {answer}")
        return answer["result"].get("value")

    async def picture(self, path):
        answer = await self.ask("browsingContext.captureScreenshot", context=self.tab)
        Path(path).write_bytes(base64.b64decode(answer["data"]))

    async def act(self, source):
        await self.ask("input.performActions", context=self.tab, actions=[source])

    async def press(self, place, by="mouse"):
        moves = {"type": "pointerMove", "x": place[0], "y": place[1]}
        down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        actions = [moves, down, {"type": "pause", "duration": 80}, up]
        await self.act(
            {"type": "pointer", "id": by, "parameters": {"pointerType": by}, "actions": actions}
        )
        await asyncio.sleep(0.5)

    async def key(self, key):
        down, up = {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}
        actions = [down, {"type": "pause", "duration": 80}, up]
        await self.act({"type": "key", "id": "keys", "actions": actions})

    async def lcd(self, tab=None):
        return await self.js("document.getElementById('lcd').textContent", tab)

    async def until(self, what, holds, seconds=60):
        for _ in range(seconds * 5):
            text = await self.lcd()
            if holds(text):
                return text
            await asyncio.sleep(0.2)
        await self.picture(f"failed-{self.name}.png")
        raise SystemExit(f"{self.name}: {what} does not come; the LCD is\n{text}\n{self.said}")


def lines(text):
    return [line.rstrip() for line in text.rstrip().splitlines()]


async def use(browser, base, check, expected_lcd, golden):
    name = browser.name
    await browser.go(f"{base}/check/golden.html")
    for _ in range(100):
        hashes = await browser.js("document.getElementById('golden').textContent")
        if hashes:
            break
        await asyncio.sleep(0.2)
    if hashes != golden:
        raise SystemExit(f"{name}: the session hashes to\n{hashes}\ninstead of\n{golden}")
    print(f"{name}: {hashes.split('ticks: ')[1].rstrip(' }')} ticks hash as on this system")

    page = f"{base}/page/index.html?lang=en&first-start=off"
    await browser.go(page)
    await browser.until("power-on", lambda text: "现在位置" in text)
    await browser.press(SAMPLES)
    await browser.press(FIRST_SAMPLE)
    await browser.until("the sample", lambda text: "O0001" in text)
    await browser.press(AUTO)
    await browser.until("automatic operation", lambda text: "自动方式" in text)
    await browser.press(START, "touch")
    await browser.until("a feed", lambda text: "S0800" in text and "编程速率:     120" in text)
    rate = await browser.js(
        "new Promise(done => { let count = 0; const begun = performance.now();"
        " function frame() { count += 1; const now = performance.now();"
        " if (now - begun > 4000) done(count / (now - begun) * 1000);"
        " else requestAnimationFrame(frame); } requestAnimationFrame(frame); })"
    )
    await browser.picture(check / f"{name}-cutting.png")
    print(f"{name}: {rate:.0f} frames/s while it cuts")

    # The machine continues while another tab is active.
    def cut(text):
        hours, minutes, seconds = text.split("切削时间:")[1].split()[0].split(":")
        return int(hours) * 3600 + int(minutes) * 60 + int(seconds)

    before, begun = cut(await browser.lcd()), time.monotonic()
    other = (await browser.ask("browsingContext.create", type="tab"))["context"]
    await asyncio.sleep(6)
    if not await browser.js("document.hidden"):
        raise SystemExit(f"{name}: the page is not hidden by another tab")
    # A second page on the same memory is refused.
    await browser.go(page, other)
    said = "document.getElementById('said').textContent"
    for _ in range(100):
        if not await browser.js(said, other):
            break
        await asyncio.sleep(0.2)
    else:
        raise SystemExit(f"{name}: in a second tab no window opens: {await browser.js(said, other)}")
    await asyncio.sleep(2)
    if await browser.lcd(other):
        raise SystemExit(f"{name}: two pages work on one memory")
    await browser.ask("browsingContext.close", context=other)
    await browser.ask("browsingContext.activate", context=browser.tab)
    await asyncio.sleep(1)
    went, passed = cut(await browser.lcd()) - before, time.monotonic() - begun
    print(f"{name}: hidden the machine went on by {went} s in {passed:.0f} s")
    if went < 0.6 * passed:
        raise SystemExit(f"{name}: behind another tab the machine stands still")

    await browser.press(SPEED)
    await browser.press(FASTEST)
    done = lambda text: "加工件数:      1" in text
    text = await browser.until("the end of the program", done, 120)
    await asyncio.sleep(2)
    text = await browser.lcd()
    if lines(text) != lines(expected_lcd):
        raise SystemExit(f"{name}: the LCD is\n{text}\ninstead of\n{expected_lcd}")
    await browser.picture(check / f"{name}-cut.png")
    print(f"{name}: the LCD is that of the same keys on this system")

    await browser.key(PAGE_DOWN)
    await browser.until("the next page", lambda text: "绝对坐标" in text)
    await browser.press(PROGRAM, "touch")
    await browser.until("the program page", lambda text: "程序" in text.splitlines()[0])
    await browser.press(POSITION)

    # Files by drop, dialog and link; the memory is kept after the page is closed.
    dropped = json.dumps(PROGRAM_42)
    await browser.js(
        f"(() => {{ const data = new DataTransfer(); data.items.add(new File([{dropped}], 'a.CNC'));"
        " document.getElementById('panel').dispatchEvent(new DragEvent('drop',"
        " { dataTransfer: data, bubbles: true, cancelable: true })); })()"
    )
    await browser.until("the dropped file", lambda text: "O0042" in text)
    chosen = check / "b.CNC"
    chosen.write_text(PROGRAM_42.replace("0042", "0043"))
    await browser.press(OPEN)
    try:
        dialog = await asyncio.wait_for(browser.dialogs.get(), 10)
    except asyncio.TimeoutError:
        raise SystemExit(f"{name}: no dialog for files comes")
    if "element" in dialog:
        await browser.ask(
            "input.setFiles", context=browser.tab, element=dialog["element"], files=[str(chosen)]
        )
        await browser.until("the chosen file", lambda text: "O0043" in text)
        kept = 3
    else:
        kept = 2
        print(f"{name}: a dialog for files comes; this browser does not let it be answered")
    await asyncio.sleep(1)
    await browser.go(f"{base}/page/index.html")
    await browser.until("power-on again", lambda text: "O004" in text)
    names = await browser.js(
        "Object.keys(localStorage).filter(it => it.endsWith('CNC')).sort().join(' ')"
    )
    await browser.go(f"{base}/page/index.html?open=../check/c.CNC")
    await browser.until("the file of the link", lambda text: "O0044" in text)
    numbers = {word.rsplit("/", 1)[-1] for word in names.split()}
    if len(numbers) < kept:
        raise SystemExit(f"{name}: of {kept} programs the browser keeps {numbers}")
    print(f"{name}: files come by drop, dialog and link; {len(numbers)} programs are kept")
    if browser.said:
        raise SystemExit(f"{name}: the page says {browser.said}")


async def main():
    page, check, linux, golden = (Path(word).resolve() for word in sys.argv[1:5])
    served = Path(tempfile.mkdtemp(prefix="page-served-"))
    (served / "page").symlink_to(page)
    (served / "check").symlink_to(check)
    (check / "golden.html").write_text(
        '<!DOCTYPE html><pre id="golden"></pre>'
        '<script type="module">import start from "./golden.js"; await start();</script>\n'
    )
    (check / "c.CNC").write_text(PROGRAM_42.replace("0042", "0044"))
    handler = functools.partial(Quiet, directory=str(served))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    base = f"http://127.0.0.1:{server.server_port}"

    said = subprocess.run([golden], check=True, capture_output=True, text=True).stdout.strip()
    script = check / "page.operate"
    script.write_text(SCRIPT)
    sample = "01-stepped-shaft.CNC"
    shutil.copy(ROOT / "assets/programs" / sample, check / sample)
    shown = subprocess.run([linux, "operate", script], check=True, capture_output=True, text=True)
    sizes = ", ".join(f"{it.name} {it.stat().st_size // 1000} kB" for it in sorted(page.iterdir()))
    print(f"the page: {sizes}")
    for name in sys.argv[5:] or ["chromium", "firefox"]:
        browser = Browser(name)
        await browser.start()
        try:
            await use(browser, base, check, shown.stdout, said)
        finally:
            await browser.end()
    shutil.rmtree(served)


asyncio.run(main())
