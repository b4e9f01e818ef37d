#!/usr/bin/env python3
"""How fast a file goes over a line that is as slow as a real one.

Two pseudo terminals are joined by a wire that carries ten bits a byte at the rate of the
line and not more, both ways at once. At one end is `gsk980td transfer control`, at the
other `gsk980td transfer send` and `receive`: what they print must be within 10 % of what the
wire carries; so must a text, by a clock beside the program. The computer must not be busy:
the wire waits for nobody.

    cargo build --release
    tests/oracles/paced_line.py [target/release/gsk980td]
"""

import os
import re
import select
import subprocess
import sys
import tempfile
import threading
import time
import tty
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
BAUDS = [19200, 115200]
SECONDS = 6
LEAST = 0.90


class Wire:
    """Two terminals, and what lies between them."""

    def __init__(self, baud):
        self.byte_s = 10 / baud
        self.ends = [os.openpty(), os.openpty()]
        for _, slave in self.ends:
            tty.setraw(slave)
        self.ports = [os.ttyname(slave) for _, slave in self.ends]
        self.going = True
        here, there = [master for master, _ in self.ends]
        self.threads = [threading.Thread(target=self.carry, args=way) for way in ((here, there), (there, here))]
        for thread in self.threads:
            thread.start()

    def carry(self, source, target):
        """A byte leaves when the one before it has, however the threads are woken."""
        free_at = 0.0
        while self.going:
            # What waits already came before the line was free, however late this is woken.
            waits = select.select([source], [], [], 0)[0]
            if not waits:
                if not select.select([source], [], [], 0.05)[0]:
                    continue
                free_at = max(free_at, time.monotonic())
            # As much as a wire carries in 2 ms.
            data = os.read(source, max(1, int(0.002 / self.byte_s)))
            free_at += len(data) * self.byte_s
            rest = free_at - time.monotonic()
            if rest > 0:
                time.sleep(rest)
            os.write(target, data)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.going = False
        for thread in self.threads:
            thread.join()
        for end in self.ends:
            for handle in end:
                os.close(handle)


def run(*words):
    begun = time.monotonic()
    done = subprocess.run([PROGRAM, "transfer", *map(str, words), "--lang", "en"], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout, time.monotonic() - begun


def said(out):
    """Bytes a second and per cent of the wire, as the program prints them."""
    found = re.search(r"(\d+) bytes a second, ([\d.]+) % of what", out)
    return float(found.group(1)), float(found.group(2))


def measure(baud, folder):
    wire_rate = baud / 10
    size = int(wire_rate * SECONDS)
    line = "N{:04} G01 X{}.5 Z-{}. F100;\n"
    text, number = "O0331;\n", 0
    while len(text) < size:
        number += 1
        text += line.format(number % 10000, number % 90, number % 300)
    text += "M30;\n"
    file = folder / f"O0331-{baud}.CNC"
    file.write_text(text)
    options = ["--param", f"44={baud}"]
    with Wire(baud) as wire:
        command = [PROGRAM, "transfer", "control", "--port", wire.ports[0], *options]
        control = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        control.stdout.readline()
        try:
            line = ["--port", wire.ports[1], "--baud", baud]
            sent, _ = run("send", f"{file}=O0331.CNC", *line)
            into = folder / str(baud)
            got, _ = run("receive", "O0331.CNC", "--into", into, *line)
        finally:
            control.terminate()
            control.wait()
        back = (into / "O0331.CNC").read_text()
        if back.strip().strip("%").strip() != text.strip():
            raise SystemExit(f"{baud}: what came back is another text")
        for way, out in (("to the control", sent), ("from it", got)):
            rate, percent = said(out)
            print(f"{baud} baud, {way}: {rate:.0f} of {wire_rate:.0f} bytes a second, {percent:.1f} %")
            if not LEAST * wire_rate <= rate <= 1.02 * wire_rate:
                raise SystemExit("not within 10 % of the wire")
    # As plain text, by a clock beside the program.
    with Wire(baud) as wire:
        receiver = subprocess.Popen(
            [PROGRAM, "transfer", "receive-text", str(folder / f"text-{baud}"), "--port", wire.ports[0], "--baud", str(baud)],
            stdout=subprocess.PIPE,
        )
        receiver.stdout.readline()
        _, seconds = run("send-text", file, "--port", wire.ports[1], "--baud", baud)
        receiver.wait()
        bytes_of_text = len(text) + text.count("\n")
        share = bytes_of_text / seconds / wire_rate
        print(f"{baud} baud, as text with CR LF: {share * 100:.1f} % by the clock, starting the program included")
        if share < LEAST:
            raise SystemExit("not within 10 % of the wire")


def main():
    with tempfile.TemporaryDirectory() as folder:
        for baud in BAUDS:
            measure(baud, Path(folder))


if __name__ == "__main__":
    main()
