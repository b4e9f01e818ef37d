#!/usr/bin/env python3
"""Programs as plain text, with programs at the other end that nobody here wrote.

`ascii-xfr` (Debian package minicom) sends a program into the control and to the PC's
side, `pyserial` (PyPI) takes one from both, with XON/XOFF; the terminal program `picocom`
(Debian) does both, and keeps what it takes in its log. What arrives must be what was sent,
for every kind of line end.

    sudo apt-get install minicom picocom && pip install pyserial
    cargo build --release
    tests/oracles/dnc_text.py [target/release/gsk980td]
"""

import os
import subprocess
import sys
import tempfile
import time
import tty
from pathlib import Path

import serial

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
BAUD = 19200
BLOCKS = "".join(f"N{n} G01 X{n % 90}.5 Z-{n}. F100;\n" for n in range(1, 400))
TEXT = f"O0331 (SHAFT);\n{BLOCKS}M30;\n%\n"
LINE_ENDS = {"crlf": "\r\n", "lf": "\n", "cr": "\r", "lfcrcr": "\n\r\r"}


def transfer(*words):
    done = subprocess.run([PROGRAM, "transfer", *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{words}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


class Control:
    """A control behind a pseudo terminal."""

    def __init__(self, *options):
        command = [PROGRAM, "transfer", "control", "--port", "pty", "--param", f"44={BAUD}", *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.port = self.process.stdout.readline().strip()

    def says(self, what):
        for line in self.process.stdout:
            if what in line:
                return
        raise SystemExit(f"the control never says: {what}")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


def ascii_xfr(file, line):
    """minicom's sender, -n: bytes as they stand in the file."""
    subprocess.run(["ascii-xfr", "-s", "-n", str(file)], stdin=line, stdout=line, stderr=subprocess.DEVNULL, check=True)


def picocom(port, *, source=None, log=None):
    """A terminal program on the line: types a file, or keeps what comes in, until it is quiet."""
    options = ["--quiet", "--baud", str(BAUD), "--flow", "x", "--noreset", "--nolock", "--exit-after", "3000"]
    if log:
        options += ["--logfile", str(log)]
    with open(source or os.devnull, "rb") as typed:
        subprocess.run(["picocom", *options, port], stdin=typed, stdout=subprocess.DEVNULL, check=True)


def taken(port):
    """What pyserial takes between the first % and the second one."""
    with serial.Serial(port, BAUD, xonxoff=True, timeout=60) as line:
        line.read_until(b"%")
        text = line.read_until(b"%")
    return text.decode("ascii")


def compare(what, found, wanted=TEXT):
    if found != wanted:
        raise SystemExit(f"{what}: {found[:200]!r}… for {wanted[:200]!r}…")
    print(f"{what}: {len(found)} characters, the same")


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        file = folder / "O0331.CNC"
        for name, end in LINE_ENDS.items():
            file.write_bytes(("%\n" + TEXT).replace("\n", end).encode("ascii"))
            # Into the control, and out of it by frames to be looked at.
            with Control() as control:
                with open(control.port, "r+b", buffering=0) as line:
                    ascii_xfr(file, line)
                    control.says("was received")
                transfer("receive", "O0331.CNC", "--into", folder / name, "--port", control.port, "--baud", BAUD)
            compare(f"ascii-xfr to the control, {name}", (folder / name / "O0331.CNC").read_text())
            with Control() as control:
                picocom(control.port, source=file)
                control.says("was received")
                transfer("receive", "O0331.CNC", "--into", folder / f"{name}-picocom", "--port", control.port, "--baud", BAUD)
            compare(f"picocom to the control, {name}", (folder / f"{name}-picocom" / "O0331.CNC").read_text())
            # To the PC's side.
            near, far = os.openpty()
            tty.setraw(far)
            into = folder / f"{name}-pc"
            words = ["transfer", "receive-text", into, "--port", os.ttyname(far), "--baud", str(BAUD)]
            receiver = subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.PIPE, text=True)
            receiver.stdout.readline()
            ascii_xfr(file, near)
            receiver.wait()
            compare(f"ascii-xfr to receive-text, {name}", (into / "O0331.CNC").read_text())

            # The other way: what pyserial takes has the line end that was asked for.
            wanted = (TEXT[:-2]).replace("\n", end)
            file.write_text(TEXT)
            with Control("--text", name, "--out", str(file), "--out-after", "2") as control:
                text = taken(control.port)
            compare(f"the control to pyserial, {name}", text, end + wanted + "%")
            log = folder / f"{name}.log"
            with Control("--text", name, "--out", str(file), "--out-after", "2") as control:
                picocom(control.port, log=log)
            compare(f"the control to picocom, {name}", log.read_bytes().decode("ascii").rstrip(end), "%" + end + wanted + "%")
            words = ["transfer", "send-text", file, "--port", os.ttyname(far), "--baud", str(BAUD), "--line-end", name]
            sender = subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.DEVNULL)
            found = b""
            while found.count(b"%") < 2:
                found += os.read(near, 4096)
                if len(found) == 4096:
                    # XOFF and XON of a slow reader.
                    os.write(near, b"\x13")
                    time.sleep(0.3)
                    os.write(near, b"\x11")
            sender.wait()
            # XOFF and XON of receive-text, which this end has not read.
            found = found.lstrip(b"\x11\x13").decode("ascii")
            compare(f"send-text to a slow reader, {name}", found, "%" + end + wanted + "%" + end[: len(found) - found.rindex("%") - 1])
            os.close(near)
            os.close(far)


if __name__ == "__main__":
    main()
