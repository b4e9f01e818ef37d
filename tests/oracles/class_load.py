#!/usr/bin/env python3
"""A class of many seats against Mosquitto: what a seat costs, and how soon an alarm is seen.

    tests/oracles/class_load.py SEATS PROGRAM [--kernels 60] [--replayed 900] [--seconds 40]

SEATS is the built example `class_seats` of the package `gsk980td-host`, PROGRAM the built `gsk980td`;
`mosquitto` and the package `paho-mqtt` are installed. Running kernels and replayed states report to one
broker; `gsk980td class --text` shows them, and a client of paho-mqtt counts their bytes. It prints
- machine time per wall time of the kernels, and the processor's time of a seat, the broker and the view;
- messages and bytes a second of a seat;
- the delay from the cause of an alarm to the view: median and worst;
- the time until all seats are back after the broker was killed;
- what 10 000 malformed packets and requests do to the seats: memory before and after.
"""

import argparse
import json
import os
import pathlib
import random
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from mqtt_lathe import Broker, Reader, check, ERRORS  # noqa: E402

CODE = "LOAD1"
STATES = f"gsk980td/class/{CODE}/seats/+/state"


def processor_s(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(process):
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def start_seats(example, port, kernels, replayed, seconds):
    address = f"{CODE}@127.0.0.1:{port}"
    return subprocess.Popen(
        [example, address, str(kernels), str(replayed), str(seconds)], stdout=subprocess.PIPE
    )


def online(reader):
    with reader.lock:
        latest = {topic: payload for _, topic, payload, _ in reader.messages}
    return [it for it in latest.values() if b'"is_online":true' in it]


def wait_for_seats(reader, count, seconds):
    begin = time.monotonic()
    while time.monotonic() < begin + seconds:
        if len(online(reader)) >= count:
            return time.monotonic() - begin
        time.sleep(0.05)
    return None


def measure(options, folder):
    broker = Broker(folder)
    seats = options.kernels + options.replayed
    everything = f"gsk980td/class/{CODE}/#"
    reader = Reader(broker.port, (everything,))
    process = start_seats(options.seats, broker.port, options.kernels, options.replayed, options.seconds + 15)
    view = subprocess.Popen(
        [options.program, "class", "--broker", f"mqtt://127.0.0.1:{broker.port}", "--code", CODE, "--text"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    check(wait_for_seats(reader, seats, 30) is not None, f"{len(online(reader))} of {seats} seats")
    time.sleep(5)
    with reader.lock:
        reader.messages.clear()
    watched = {"seats": process, "broker": broker.process, "view": view}
    before, begin = {name: processor_s(it) for name, it in watched.items()}, time.monotonic()
    time.sleep(options.seconds)
    wall = time.monotonic() - begin
    used = {name: (processor_s(it) - before[name]) / wall for name, it in watched.items()}
    with reader.lock:
        count = len(reader.messages)
        size = sum(len(topic) + len(payload) for _, topic, payload, _ in reader.messages)
    result = json.loads(process.communicate()[0])
    view.kill()
    view.wait()
    reader.close()
    broker.kill()
    print(f"{options.kernels} running kernels, {options.replayed} replayed seats")
    print(f"  machine time {result['machine_s'] / result['wall_s']:.3f} of wall time, "
          f"ticking thread busy {result['busy']:.0%}")
    print(f"  processor: a seat {used['seats'] / seats:.2%} of a core, broker {used['broker']:.1%}, "
          f"view {used['view']:.1%}")
    print(f"  a seat: {count / wall / seats:.2f} messages, {size / wall / seats:.0f} bytes a second")
    print(f"  alarm to view: median {result['median_ms']} ms, worst {result['worst_ms']} ms, "
          f"{result['alarms']} alarms, {result['lost']} lost")
    check(result["lost"] == 0 and result["alarms"] > 5, "alarms are lost")
    check(result["machine_s"] / result["wall_s"] > 0.97, "the machines are slow")


def kill_broker(options, folder):
    broker = Broker(folder)
    seats = min(options.kernels + options.replayed, 200)
    process = start_seats(options.seats, broker.port, 10, seats - 10, 40)
    reader = Reader(broker.port, (STATES,))
    check(wait_for_seats(reader, seats, 20) is not None, "seats before the kill")
    reader.close()
    broker.kill()
    time.sleep(5)
    broker.start()
    reader = Reader(broker.port, (STATES,))
    back = wait_for_seats(reader, seats, 15)
    print(f"broker killed and back: {seats} seats after {back} s")
    check(back is not None and back < 5, "seats are not back within 5 s")
    process.kill()
    process.wait()
    reader.close()
    broker.kill()


def malformed(generator, topic):
    """A packet that no broker sends, or a request that no view sends."""
    if generator.random() < 0.5:
        packet = bytes([generator.choice([0x30, 0x20, 0x40, 0x90, 0xD0, 0xF0])])
        return packet + generator.randbytes(generator.randint(0, 60))
    payload = bytearray(b'{"request":"task","exercise":"shaft"}')
    payload[generator.randrange(len(payload))] = generator.randrange(256)
    if generator.random() < 0.2:
        payload = generator.randbytes(generator.randint(0, 5000))
    body = len(topic).to_bytes(2, "big") + topic + bytes(payload)
    size, length = len(body), b""
    while True:
        size, digit = divmod(size, 128)
        length += bytes([digit | (0x80 if size else 0)])
        if not size:
            return b"\x30" + length + body


def play_broker(options):
    """A broker of the script's own, which answers a seat with nonsense."""
    listener = socket.create_server(("127.0.0.1", 0))
    process = start_seats(options.seats, listener.getsockname()[1], 1, 0, 300)
    generator, sent, connections, before = random.Random(7), 0, 0, None
    begin = time.monotonic()
    while sent < 10_000 and time.monotonic() < begin + 200:
        listener.settimeout(10)
        link, _ = listener.accept()
        link.settimeout(5)
        try:
            connect = link.recv(4096)
            topic = re.search(rb"gsk980td/class/\w+/seats/\w+/", connect)
            link.sendall(b"\x20\x02\x00\x00")
            connections += 1
            if topic is None:
                continue  # The view of the example itself.
            request = topic[0] + b"request"
            for _ in range(400):
                link.sendall(malformed(generator, request))
                sent += 1
        except OSError:
            pass
        link.close()
        if before is None and sent > 1000:
            before = memory_mb(process)
        check(process.poll() is None, "the seat has ended")
    after = memory_mb(process)
    process.kill()
    process.wait()
    print(f"{sent} malformed packets in {connections} connections: {before:.1f} MB, then {after:.1f} MB")
    check(sent >= 10_000 and after < before + 8, "memory grows")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("seats")
    parser.add_argument("program")
    parser.add_argument("--kernels", type=int, default=60)
    parser.add_argument("--replayed", type=int, default=900)
    parser.add_argument("--seconds", type=int, default=40)
    options = parser.parse_args()
    if not shutil.which("mosquitto"):
        print("mosquitto is not installed: nothing is checked")
        return
    with tempfile.TemporaryDirectory() as folder:
        measure(options, folder)
        kill_broker(options, folder)
    play_broker(options)
    print("FAILED" if ERRORS else "ok")
    sys.exit(bool(ERRORS))


if __name__ == "__main__":
    main()
