#!/usr/bin/env python3
"""Reads a run of the simulated lathe through the MTConnect agent, and disturbs the agent.

    tests/oracles/mtconnect_client.py PROGRAM [--seconds 60] [--requests 10000]

PROGRAM is the built `gsk980td`. A run of a sample with `--mtconnect` is followed by
- a client that streams `/sample`, breaks its connection at random and continues at `nextSequence`:
  each sequence number must arrive exactly once, in order;
- a client that polls `/sample` with `count` and a path;
meanwhile random and malformed requests, 500 connections at once and readers that do not read
disturb the agent. The process must survive, answer afterwards, and not grow. The same run without
disturbance gives the figures to compare: machine time per wall time, memory. Without the option
`strace` must see no call of the network.
"""

import argparse
import os
import pathlib
import random
import re
import socket
import subprocess
import sys
import threading
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "assets/programs/01-stepped-shaft.CNC"
ERRORS = []


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def get(port, target, timeout=10):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}{target}", timeout=timeout) as response:
        return response.read().decode()


def sequences(document):
    return sorted(map(int, re.findall(r' sequence="(\d+)"', document)))


def next_sequence(document):
    return int(re.search(r'nextSequence="(\d+)"', document)[1])


class Stream(threading.Thread):
    """Streams all observations, with broken connections in between."""

    def __init__(self, port, end):
        super().__init__()
        self.port, self.end = port, end
        self.received, self.connections, self.documents = [], 0, 0

    def run(self):
        following = 1
        while time.monotonic() < self.end:
            try:
                following = self.follow(following)
            except (OSError, ValueError):
                time.sleep(0.05)

    def follow(self, following):
        self.connections += 1
        breaks = time.monotonic() + random.uniform(0.2, 5)
        with socket.create_connection(("127.0.0.1", self.port), timeout=5) as link:
            target = f"/sample?from={following}&interval=100&heartbeat=1000&count=500"
            link.sendall(f"GET {target} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            stream = link.makefile("rb")
            if b" 200 " not in stream.readline():
                raise ValueError("refused")
            while stream.readline().strip():
                pass
            while time.monotonic() < min(breaks, self.end):
                headers = [stream.readline() for _ in range(4)]
                if not headers[0].startswith(b"--"):
                    raise ValueError(f"no boundary: {headers}")
                size = int(headers[2].split(b":")[1])
                document = stream.read(size).decode()
                if len(document.encode()) != size:
                    raise ValueError("broken within a document")
                stream.readline()
                self.received += sequences(document)
                self.documents += 1
                following = next_sequence(document)
        return following


class Poll(threading.Thread):
    """Polls the positions of the axes; each must be newer than the one before."""

    def __init__(self, port, end):
        super().__init__()
        self.port, self.end, self.received = port, end, []

    def run(self):
        following = 1
        path = "path=//Axes//DataItem[@type=%22POSITION%22%20and%20@category=%22SAMPLE%22]"
        while time.monotonic() < self.end:
            try:
                document = get(self.port, f"/sample?from={following}&count=50&{path}")
            except OSError:
                time.sleep(0.1)
                continue
            self.received += sequences(document)
            following = next_sequence(document)
            time.sleep(0.2)


def malformed(generator):
    """A request that no client sends."""
    pieces = [
        b"GET ", b"POST ", b"PUT ", b"/", b"/sample", b"/current", b"/assets/", b"?from=", b"&count=",
        b"path=//", b"[@type='", b"%", b"%zz", b"18446744073709551616", b"-1", b" HTTP/1.1\r\n",
        b"Host: localhost\r\n", b"Host: evil.example\r\n", b"Content-Length: 99999999\r\n", b"\r\n\r\n",
        b"Transfer-Encoding: chunked\r\n", b"A" * 200, b"\x00\xff", b"&interval=1", b"&heartbeat=0",
    ]
    request = b"".join(generator.choice(pieces) for _ in range(generator.randint(1, 12)))
    if generator.random() < 0.2:
        request = generator.randbytes(generator.randint(1, 3000))
    if generator.random() < 0.05:
        request += b"X-Long: " + b"y" * 9000
    return request


def disturb(port, count, seed):
    generator = random.Random(seed)
    for _ in range(count):
        try:
            with socket.create_connection(("127.0.0.1", port), timeout=2) as link:
                link.sendall(malformed(generator))
                if generator.random() < 0.3:
                    link.shutdown(socket.SHUT_WR)
                    link.settimeout(0.05)
                    link.recv(2000)
        except OSError:
            pass


def slow_readers(port, count):
    """Clients that request much and read nothing."""
    links = []
    for _ in range(count):
        link = socket.create_connection(("127.0.0.1", port), timeout=5)
        link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        link.sendall(b"GET /sample?count=4096 HTTP/1.1\r\nHost: localhost\r\n\r\n" * 20)
        links.append(link)
    return links


def many_connections(port, count):
    links, answered = [], 0
    for _ in range(count):
        try:
            links.append(socket.create_connection(("127.0.0.1", port), timeout=5))
        except OSError:
            pass
    for link in links:
        try:
            link.settimeout(0.5)
            link.sendall(b"GET /current HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            answered += bool(link.recv(100))
        except OSError:
            pass
        link.close()
    return len(links), answered


def memory_kb(process):
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    return {name: int(re.search(rf"{name}:\s+(\d+)", status)[1]) for name in ("VmRSS", "Threads")}


def machine_seconds(port):
    return int(re.search(r'name="time_on"[^>]*>(\d+)<', get(port, "/current"))[1])


def observe(program, seconds, requests):
    port = free_port()
    command = [program, "run", SAMPLE, "--spindle", "800", "--parts", "50"]
    process = subprocess.Popen(
        [*command, "--mtconnect", f"127.0.0.1:{port}"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    try:
        for _ in range(200):
            try:
                get(port, "/probe")
                break
            except OSError:
                time.sleep(0.05)
        time.sleep(2)
        before, begin, machine = memory_kb(process), time.monotonic(), machine_seconds(port)
        end = begin + seconds
        stream, poll = Stream(port, end), Poll(port, end)
        stream.start()
        poll.start()
        if requests:
            workers = [
                threading.Thread(target=disturb, args=(port, requests // 4, seed)) for seed in range(4)
            ]
            for worker in workers:
                worker.start()
            for worker in workers:
                worker.join()
            print(f"  {requests} malformed requests in {time.monotonic() - begin:.1f} s")
            opened, answered = many_connections(port, 500)
            print(f"  500 connections: {opened} accepted by the system, {answered} answered")
            links = slow_readers(port, 40)
            time.sleep(8)
            for link in links:
                link.close()
        stream.join()
        poll.join()
        time.sleep(1)
        wall, passed = time.monotonic() - begin, machine_seconds(port) - machine
        after = memory_kb(process)
        if process.poll() is not None:
            ERRORS.append("the process has ended")
    finally:
        process.kill()
        process.wait()
    wanted = list(range(stream.received[0], stream.received[-1] + 1))
    if stream.received != wanted or stream.received[0] != 1:
        ERRORS.append("the stream has gaps or repetitions")
    if poll.received != sorted(set(poll.received)):
        ERRORS.append("the polled observations are repeated or out of order")
    print(
        f"  {len(stream.received)} observations in {stream.documents} documents over "
        f"{stream.connections} connections; {len(poll.received)} polled"
    )
    print(f"  machine time {passed} s in {wall:.1f} s of wall time")
    print(f"  memory {before['VmRSS']} -> {after['VmRSS']} kB, threads {before['Threads']} -> {after['Threads']}")
    if requests and after["VmRSS"] > before["VmRSS"] + 40_000:
        ERRORS.append("the process has grown")
    if passed < wall * 0.9 - 2:
        ERRORS.append("the machine was slowed down")


def check_silence(program):
    """Without `--mtconnect` nothing listens and nothing is sent."""
    command = ["strace", "-f", "-e", "trace=network", program, "run", SAMPLE, "--spindle", "800"]
    traced = subprocess.run(command, capture_output=True, text=True)
    calls = [line for line in traced.stderr.splitlines() if re.search(r"\b(socket|bind|listen|connect)\(", line)]
    print(f"without the option: {len(calls)} calls of the network")
    if calls:
        ERRORS.append("the network is used without the option")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--requests", type=int, default=10_000)
    options = parser.parse_args()
    check_silence(options.program)
    print("undisturbed:")
    observe(options.program, options.seconds, 0)
    print("disturbed:")
    observe(options.program, options.seconds, options.requests)
    print("\n".join(ERRORS) or "no gap, no growth, no end")
    sys.exit(bool(ERRORS))


if __name__ == "__main__":
    os.environ.pop("http_proxy", None)
    main()
