#!/usr/bin/env python3
"""A seat in a browser: the page joins a class through the WebSocket listener of a real Mosquitto.

    tests/oracles/browser_seat.py PROGRAM PAGE PICTURES [chromium|firefox]

PROGRAM is the built `gsk980td`, PAGE the folder that `cargo xtask dist web` builds. Needs mosquitto,
chromium with its driver or firefox-esr, python3-websockets and paho-mqtt 2. The link of the class opens
the page, the learner enters his name, and `gsk980td class --text` must show him. Then the broker is
killed and comes back, the instructor sends an exercise of his own, and offers an exam, which page and
view must refuse with the same sentence.
"""

import asyncio
import functools
import http.server
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from browser import Browser, Quiet  # noqa: E402
from mqtt_lathe import Broker, Reader, free_port  # noqa: E402

CODE, NAME = "K7M2", "Li Ming"
SEATS = f"gsk980td/class/{CODE}/seats"
REFUSAL = "a seat in a browser holds no exam, because it cannot store the recordings"
# Positions on a page of the size of `browser.py` in English, pixels.
NAME_FIELD, BEGIN = (975, 232), (775, 401)
ENTER = "\ue007"


class WebBroker(Broker):
    """Mosquitto with a second listener for pages."""

    def start(self):
        if not hasattr(self, "web_port"):
            self.web_port = free_port()
            with self.config.open("a") as config:
                config.write(f"listener {self.web_port} 127.0.0.1\nprotocol websockets\n")
        super().start()


class View:
    """`class --text`; keeps what it prints."""

    def __init__(self, program, port):
        command = [program, "class", "--broker", f"mqtt://127.0.0.1:{port}", "--code", CODE]
        self.process = subprocess.Popen(
            [*command, "--text", "--lang", "en"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )
        self.lines = []
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    async def wait_for(self, *words, seconds=30):
        """Waits for a new line that contains all words; returns the seconds."""
        begin, first = time.monotonic(), len(self.lines)
        while time.monotonic() < begin + seconds:
            found = [line for line in self.lines[first:] if all(word in line for word in words)]
            if found:
                print("  view:", found[0])
                return time.monotonic() - begin
            await asyncio.sleep(0.05)
        raise SystemExit(f"the view does not show {words}:\n" + "\n".join(self.lines[-12:]))


async def join(browser, view, address, pictures):
    await browser.go(address)
    await browser.until("power-on", lambda text: "现在位置" in text)
    await asyncio.sleep(1)
    await browser.press(NAME_FIELD)
    for letter in NAME:
        await browser.key(letter)
    await browser.picture(pictures / f"{browser.name}-joining.png")
    shown = asyncio.create_task(view.wait_for(NAME))
    await browser.key(ENTER)
    print(f"{browser.name}: the seat is in the view after {await shown:.1f} s")
    await browser.picture(pictures / f"{browser.name}-joined.png")


async def lose_broker(browser, view, reader, broker):
    broker.kill()
    await asyncio.sleep(3)
    begin = time.monotonic()
    broker.start()
    while not any(b'"is_online":true' in it for it in states(reader, begin)):
        if time.monotonic() > begin + 30:
            raise SystemExit(f"{browser.name}: the seat does not return")
        await asyncio.sleep(0.05)
    print(f"{browser.name}: the seat is back {time.monotonic() - begin:.1f} s after the broker")


def states(reader, since=0):
    with reader.lock:
        messages = list(reader.messages)
    return [it[2] for it in messages if it[0] >= since and it[1].endswith("/state") and it[2]]


def send(reader, **request):
    seat = [topic for topic in reader.latest() if topic.endswith("/state")][-1]
    topic = seat.replace("/state", "/request")
    reader.client.publish(topic, json.dumps(request)).wait_for_publish()


async def offer(browser, view, reader, pictures):
    text = (ROOT / "assets/exercises/02-jog/task.ron").read_text()
    accepted = asyncio.create_task(view.wait_for(NAME, "accepted", "own-jog"))
    send(reader, request="task_file", exercise="own-jog", text=text)
    await asyncio.sleep(2)
    await browser.picture(pictures / f"{browser.name}-offer.png")
    await browser.press(BEGIN)
    await accepted
    refused = asyncio.create_task(view.wait_for(NAME, REFUSAL))
    pin = {"salt": 1, "hash": "0f" * 32}
    send(reader, request="begin_exam", exercises=["02-jog"], pin=pin)
    await refused
    await asyncio.sleep(1)
    await browser.picture(pictures / f"{browser.name}-exam.png")


async def check(name, program, page, pictures):
    folder = tempfile.mkdtemp(prefix="browser-seat-")
    broker = WebBroker(folder)
    reader, view = Reader(broker.port, (f"{SEATS}/#",)), View(program, broker.port)
    handler = functools.partial(Quiet, directory=page)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    browser = Browser(name)
    await browser.start()
    try:
        link = f"http://127.0.0.1:{server.server_address[1]}/?lang=en&first-start=off"
        link += f"&class={CODE}@ws://127.0.0.1:{broker.web_port}"
        await join(browser, view, link, pictures)
        await lose_broker(browser, view, reader, broker)
        await offer(browser, view, reader, pictures)
    finally:
        await browser.end()
        reader.close()
        view.process.terminate()
        view.process.wait()
        broker.kill()


def main():
    program, page, pictures = (pathlib.Path(it).resolve() for it in sys.argv[1:4])
    pictures.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[4:] or ["chromium"]:
        asyncio.run(check(name, program, page, pictures))


if __name__ == "__main__":
    main()
