"""A page in a real browser, controlled by WebDriver BiDi: Chromium through `chromedriver`,
Firefox directly. Used by `page_check.py` and `tests/oracles/scorm_package.py`.
"""

import asyncio
import base64
import http.server
import json
import os
import shutil
import socket
import subprocess
import tempfile
import urllib.request
from pathlib import Path

import websockets

SIZE = {"width": 1280, "height": 800}


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
    """One page in a browser. Files that it offers are stored in the folder `downloads`."""

    def __init__(self, name, size=SIZE, downloads=None):
        self.name = name
        self.size = size
        self.downloads = downloads
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
        await self.ask("browsingContext.setViewport", context=self.tab, viewport=self.size)

    async def start_chromium(self):
        port = free_port()
        self.process = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL)
        arguments = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader"]
        arguments += ["--enable-unsafe-swiftshader", f"--user-data-dir={self.home}"]
        options = {"args": arguments}
        if self.downloads:
            options["prefs"] = {"download.default_directory": str(self.downloads)}
        capabilities = {"webSocketUrl": True, "goog:chromeOptions": options}
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
        if self.downloads:
            # 2: the folder of the next setting.
            settings |= {"browser.download.folderList": 2, "browser.download.dir": str(self.downloads)}
            settings["browser.download.useDownloadDir"] = True
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
        await self.wire.close()
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
        pause = {"type": "pause", "duration": 80}
        # A page that draws slowly sees the pointer arrive before it goes down.
        actions = [moves, pause, down, pause, up]
        await self.act(
            {"type": "pointer", "id": by, "parameters": {"pointerType": by}, "actions": actions}
        )
        await asyncio.sleep(0.5)

    async def key(self, key):
        down, up = {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}
        actions = [down, {"type": "pause", "duration": 80}, up]
        await self.act({"type": "key", "id": "keys", "actions": actions})

    def memory_mb(self):
        """Memory of all processes of the browser, MB."""
        parents, sizes = {}, {}
        for status in Path("/proc").glob("[0-9]*/status"):
            try:
                rows = dict(line.split(":", 1) for line in status.read_text().splitlines())
            except OSError:
                continue  # The process has ended.
            number = int(status.parent.name)
            parents[number] = int(rows["PPid"])
            sizes[number] = int(rows.get("VmRSS", "0 kB").split()[0])

        def is_ours(number):
            while number > 1 and number != self.process.pid:
                number = parents.get(number, 0)
            return number == self.process.pid

        return sum(size for number, size in sizes.items() if is_ours(number)) // 1000

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
