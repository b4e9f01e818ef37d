#!/usr/bin/env python3
"""What the window costs: processor time at rest and while a program runs, frames a second,
and the time from a key to the changed LCD.

    window_load.py PROGRAM [SAMPLE] [LAYOUT…]

PROGRAM is a release build, SAMPLE a part program that runs for a minute or more. It starts an
X server of its own of 1366x768 and draws in software, like a computer without a graphics card.
Processor time is that of the program, drawing included, in per cent of one processor; the
X server's copy of each picture is not in it. A key is sent with XTest; the LCD is read back
from the server until a pixel differs. Needs Xvfb, libX11 and libXtst. The machine must be
quiet: other work makes every figure larger.
"""

import ctypes
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

SIZE = (1366, 768)
SAMPLES = pathlib.Path(__file__).parents[2] / "assets" / "programs"
LAYOUTS = ["Panel", "Machine", "Learner", "Programmer", "Instructor"]
TICKS = os.sysconf("SC_CLK_TCK")

x11 = ctypes.CDLL("libX11.so.6")
xtst = ctypes.CDLL("libXtst.so.6")
for name in ["XOpenDisplay", "XDefaultRootWindow", "XGetImage", "XStringToKeysym"]:
    getattr(x11, name).restype = ctypes.c_void_p
x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
x11.XGetImage.argtypes = [ctypes.c_void_p, ctypes.c_ulong] + [ctypes.c_int] * 2 + [
    ctypes.c_uint] * 2 + [ctypes.c_ulong, ctypes.c_int]
for name in ["XSync", "XDestroyImage", "XDefaultRootWindow"]:
    getattr(x11, name).argtypes = [ctypes.c_void_p] + ([ctypes.c_int] if name == "XSync" else [])
xtst.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]


class Image(ctypes.Structure):
    """The beginning of an XImage."""

    _fields_ = [(name, ctypes.c_int) for name in ["width", "height", "xoffset", "format"]] + [
        ("data", ctypes.POINTER(ctypes.c_char))] + [(name, ctypes.c_int) for name in [
            "byte_order", "unit", "bit_order", "pad", "depth", "bytes_per_line"]]


class Screen:
    """A connection to the server: keys in, pixels out."""

    def __init__(self, number):
        self.display = x11.XOpenDisplay(f":{number}".encode())
        self.root = x11.XDefaultRootWindow(self.display)

    def key(self, name, is_down):
        code = x11.XKeysymToKeycode(self.display, x11.XStringToKeysym(name.encode()))
        xtst.XTestFakeKeyEvent(self.display, code, int(is_down), 0)
        x11.XSync(self.display, 0)

    def press(self, *names):
        for name in names:
            self.key(name, True)
            time.sleep(0.1)
        for name in reversed(names):
            self.key(name, False)
        time.sleep(0.4)

    def pixels(self, x, y, width, height):
        pointer = x11.XGetImage(self.display, self.root, x, y, width, height, 0xFFFFFFFF, 2)
        image = ctypes.cast(pointer, ctypes.POINTER(Image)).contents
        data = ctypes.string_at(image.data, image.bytes_per_line * image.height)
        x11.XDestroyImage(pointer)
        return data


def processor_s(process):
    """Processor time of the process and its children, s."""
    total = 0
    for pid in [process.pid] + [int(p) for p in subprocess.run(
            ["pgrep", "-P", str(process.pid)], capture_output=True, text=True).stdout.split()]:
        fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
        total += int(fields[11]) + int(fields[12])
    return total / TICKS


def share(process, seconds):
    """Processor time over the next seconds, per cent of one processor."""
    before, begin = processor_s(process), time.monotonic()
    time.sleep(seconds)
    return 100 * (processor_s(process) - before) / (time.monotonic() - begin)


def frames(log, after):
    """The frames a second in the lines of --figures behind a place of the log."""
    text = open(log, errors="replace").read()[after:]
    rates = [(float(rate), float(ms)) for rate, ms in
             re.findall(r"(\d+(?:\.\d+)?) \D*frames\D*?(\d+(?:\.\d+)?) ms", text)]
    return rates or text.strip().splitlines()[-2:]


def key_to_lcd(screen):
    """Milliseconds from a key to the first changed pixel of the LCD, 30 keys."""
    whole = (0, 0) + SIZE
    screen.press("F2")
    time.sleep(1)
    before = screen.pixels(*whole)
    screen.press("F3")
    time.sleep(1)
    after = screen.pixels(*whole)
    changed = [(i // 4 % SIZE[0], i // 4 // SIZE[0]) for i in range(0, len(before), 4)
               if before[i:i + 4] != after[i:i + 4]]
    # The LCD is the larger part of what stays changed after the key is up.
    xs = sorted(x for x, _ in changed)
    ys = sorted(y for _, y in changed)
    low, high = len(xs) // 20, len(xs) - 1 - len(xs) // 20
    area = (xs[low], ys[low], xs[high] - xs[low] + 1, ys[high] - ys[low] + 1)
    times = []
    for turn in range(30):
        # Keys come at any moment of a frame.
        time.sleep(0.5 + 0.013 * turn)
        old = screen.pixels(*area)
        begin = time.monotonic()
        key = "F2" if turn % 2 == 0 else "F3"
        screen.key(key, True)
        while screen.pixels(*area) == old and time.monotonic() < begin + 2:
            pass
        times.append(1000 * (time.monotonic() - begin))
        screen.key(key, False)
    return area, times


def measure(program, sample, layout):
    with tempfile.TemporaryDirectory() as work:
        with open(f"{work}/number", "w+") as number:
            server = subprocess.Popen(
                ["Xvfb", "-displayfd", str(number.fileno()), "-screen", "0",
                 f"{SIZE[0]}x{SIZE[1]}x24", "-noreset"],
                pass_fds=[number.fileno()], stderr=subprocess.DEVNULL)
            while not (found := open(f"{work}/number").read().strip()):
                time.sleep(0.1)
        os.mkdir(f"{work}/data")
        open(f"{work}/data/window.ron", "w").write(
            f"(light: false, zoom: Some(100), layouts: (chosen: Some({layout}), changes: {{}}, "
            f"front: {'Some(Lesson)' if layout == 'Learner' else 'None'}))")
        log = f"{work}/log"
        environment = dict(os.environ, DISPLAY=f":{found}", LIBGL_ALWAYS_SOFTWARE="1")
        process = subprocess.Popen(
            [program, "--data", f"{work}/data", "--program", sample, "--lang", "en", "--figures"],
            env=environment, stderr=open(log, "w"))
        try:
            screen = Screen(found)
            time.sleep(6)
            window = subprocess.run(["xdotool", "search", "--onlyvisible", "--name", "."],
                                    env=environment, capture_output=True, text=True)
            window = window.stdout.split()[-1]
            subprocess.run(["xdotool", "windowmove", window, "0", "0", "windowsize", window,
                            str(SIZE[0]), str(SIZE[1]), "windowfocus", window,
                            "mousemove", str(SIZE[0] - 1), str(SIZE[1] - 1)], env=environment)
            time.sleep(float(os.environ.get("WAIT", "8")))
            at = os.path.getsize(log)
            idle = share(process, 20)
            idle_frames = frames(log, at)
            area, times = key_to_lcd(screen)
            screen.press("Control_L", "2")
            screen.press("F9")
            screen.press("F2")
            time.sleep(6)
            at = os.path.getsize(log)
            running = share(process, 20)
            running_frames = frames(log, at)
            if os.environ.get("PICTURES"):
                subprocess.run(["import", "-window", "root",
                                f"{os.environ['PICTURES']}/{layout}.png"], env=environment)
            times_running = key_to_lcd(screen)[1]
            print(f"{layout}: idle {idle:.1f} % {idle_frames}; running {running:.1f} % "
                  f"{running_frames}; key to LCD idle {statistics.median(times):.0f} ms (most "
                  f"{max(times):.0f}), running {statistics.median(times_running):.0f} ms (most "
                  f"{max(times_running):.0f}); LCD {area}", flush=True)
        finally:
            process.kill()
            process.wait()
            server.kill()
            server.wait()


def main():
    program = sys.argv[1]
    rest = sys.argv[2:]
    sample = rest.pop(0) if rest and rest[0] not in LAYOUTS else str(
        SAMPLES / "04-thread-cycles.CNC")
    for layout in rest or LAYOUTS:
        measure(program, sample, layout)


if __name__ == "__main__":
    main()
