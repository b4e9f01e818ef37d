#!/usr/bin/env python3
"""Reads a long run through the MTConnect agent with a collector that others wrote and use.

    tests/oracles/mtconnect_forwarder.py PROGRAM FORWARDER [--minutes 60] [--python python3]

PROGRAM is the built `gsk980td`, FORWARDER the folder `edge/forwarder` of the repository
`ffmfg-tal/mtconnect-monitoring`; the Python of `--python` has its packages `httpx`, `lxml` and
`aiosqlite`. The forwarder polls `/sample` from `nextSequence` and stores each observation in SQLite.
It reaches the agent through a proxy that breaks every connection after a random time, within a
document too, and refuses some. Each sequence number must be stored, in the order of the moments.
"""

import argparse
import http.server
import json
import os
import pathlib
import random
import select
import socket
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

from mtconnect_client import free_port, get, machine_seconds, memory_kb

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "assets/programs/01-stepped-shaft.CNC"
# Share of the connections that the proxy refuses, and longest life of the others, s.
REFUSED, LONGEST_S = 0.05, 4


class Proxy(threading.Thread):
    """Passes bytes on, and breaks every connection."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.agent = port
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.connections = self.refused = self.broken = 0

    def run(self):
        while True:
            client, _ = self.listener.accept()
            self.connections += 1
            if random.random() < REFUSED:
                self.refused += 1
                client.close()
                continue
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        end = time.monotonic() + random.uniform(0.01, LONGEST_S)
        try:
            with client, socket.create_connection(("127.0.0.1", self.agent)) as agent:
                while (left := end - time.monotonic()) > 0:
                    ready, _, _ = select.select([client, agent], [], [], left)
                    for source, drain in ((client, agent), (agent, client)):
                        if source in ready:
                            block = source.recv(4096)
                            if not block:
                                return
                            drain.sendall(block)
                self.broken += 1
        except OSError:
            pass


class Cloud(http.server.BaseHTTPRequestHandler):
    """Takes what the forwarder passes on."""

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        newest = max((it["sequence"] for it in body.get("batch", [])), default=0)
        answer = json.dumps({"high_water_sequence": newest}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(answer)))
        self.end_headers()
        self.wfile.write(answer)

    def log_message(self, *_):
        pass


def serve_cloud():
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Cloud)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server.server_address[1]


def judge(path):
    """The sequence numbers that are missing, and the moments that are out of order."""
    rows = sqlite3.connect(path).execute(
        "SELECT sequence, timestamp_utc FROM observations ORDER BY sequence"
    )
    rows = list(rows)
    numbers = [row[0] for row in rows]
    missing = sorted(set(range(numbers[0], numbers[-1] + 1)) - set(numbers)) if numbers else []
    backwards = sum(before[1] > after[1] for before, after in zip(rows, rows[1:]))
    return numbers, missing, backwards


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("forwarder", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--python", default=sys.executable)
    options = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="mtconnect-forwarder-"))
    port, store = free_port(), folder / "observations.sqlite"
    command = [options.program, "run", SAMPLE, "--spindle", "800", "--parts", "9000"]
    machine = subprocess.Popen(
        [*command, "--mtconnect", f"127.0.0.1:{port}"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    forwarder = None
    try:
        for _ in range(200):
            try:
                get(port, "/probe")
                break
            except OSError:
                time.sleep(0.05)
        time.sleep(2)  # The first state of the machine has arrived.
        proxy = Proxy(port)
        proxy.start()
        environment = {
            **os.environ,
            "PYTHONPATH": str(options.forwarder / "src"),
            "MTC_AGENT_URL": f"http://127.0.0.1:{proxy.port}",
            "MTC_CLOUD_URL": f"http://127.0.0.1:{serve_cloud()}",
            "MTC_BUFFER_PATH": str(store),
        }
        begin, machine_begin, before = time.monotonic(), machine_seconds(port), memory_kb(machine)
        while (left := begin + options.minutes * 60 - time.monotonic()) > 0:
            # A start whose first request the proxy breaks ends the forwarder.
            with (folder / "log").open("ab") as log:
                forwarder = subprocess.Popen(
                    [options.python, "-c", "from forwarder.main import cli; cli()"],
                    env=environment, stdout=log, stderr=log,
                )
                try:
                    forwarder.wait(left)
                except subprocess.TimeoutExpired:
                    forwarder.terminate()
                    forwarder.wait()
        wall, passed = time.monotonic() - begin, machine_seconds(port) - machine_begin
        after, is_alive = memory_kb(machine), machine.poll() is None
    finally:
        for process in (forwarder, machine):
            if process and process.poll() is None:
                process.kill()
                process.wait()
    numbers, missing, backwards = judge(store)
    text = (folder / "log").read_text(errors="replace")
    print(f"{len(numbers)} observations, {numbers[0]} to {numbers[-1]}, in {wall / 60:.1f} min")
    print(
        f"{proxy.connections} connections: {proxy.refused} refused, {proxy.broken} broken; "
        f"{text.count('fetch_sample failed')} polls failed, {text.count('gap detected')} gaps reported"
    )
    print(f"machine time {passed} s in {wall:.1f} s; memory {before['VmRSS']} -> {after['VmRSS']} kB")
    print(f"missing {len(missing)} {missing[:10]}, out of order {backwards}, in {store}")
    sys.exit(bool(missing or backwards or not is_alive or "gap detected" in text))


if __name__ == "__main__":
    main()
