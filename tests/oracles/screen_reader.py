#!/usr/bin/python3
"""Walks through 'open, run, stop, read the alarm' as a screen reader does, and then as
somebody does who has a keyboard and no mouse.

The first walk knows nothing of the window but what AT-SPI, the interface of the screen
readers of Linux, reports of it: names, roles, states, texts, actions. The second one only
presses keys and reads the LCD. Both fail with a sentence that says what was not found.

Needs Debian's at-spi2-core, gir1.2-atspi-2.0, python3-gi, dbus, xvfb, xdotool and is run
on a display and a session bus of its own:

    xvfb-run -a -s "-screen 0 1366x768x24" dbus-run-session -- \
        tests/oracles/screen_reader.py target/release/gsk980td [--lang zh]
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import warnings

import gi

gi.require_version("Atspi", "2.0")
from gi.repository import Atspi, Gio, GLib  # noqa: E402

warnings.simplefilter("ignore", DeprecationWarning)

# What the walks look for, in both languages of the window.
WORDS = {
    "en": {
        "purpose": "I own a lathe", "begin": "Begin", "samples": "Samples", "lcd": "LCD", "auto": "Automatic mode", "start": "Cycle start",
        "hold": "Feed hold", "stop": "Emergency stop", "reset": "Reset",
        "single": "Single block", "lamp": "Single block lamp", "on": "on", "off": "off",
    },
    "zh": {
        "purpose": "我有一台车床", "begin": "开始", "samples": "示例", "lcd": "显示屏", "auto": "自动方式", "start": "运行（循环启动）",
        "hold": "暂停（进给保持）", "stop": "急停", "reset": "复位",
        "single": "单段", "lamp": "单段灯", "on": "亮", "off": "灭",
    },
}
# The alarm of the emergency stop, as the LCD shows it.
ALARM = "207:"
# Blocks of the first sample that move: after a hold in a block of M, S or T alone the
# program only stops, and no lamp stays lit.
MOVES = re.compile("N0[0-9][4-9]0")
NOT_READY = "准备未绪"
NAMED = {"push button", "toggle button", "check box", "radio button", "slider", "entry",
         "combo box", "status bar", "menu item"}


def fail(sentence):
    sys.exit(f"screen_reader.py: {sentence}")


def wait(what, test, seconds=20.0):
    """What `test` returns, as soon as it is something."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = test()
        if found:
            return found
        # What AT-SPI remembers of the tree changes by the events it is given here.
        while GLib.MainContext.default().iteration(False):
            pass
        time.sleep(0.05)
    fail(f"waited {seconds:.0f} s for {what}")


def parts(root):
    """Everything below a part, in reading order."""
    try:
        children = [root.get_child_at_index(i) for i in range(root.get_child_count())]
    except GLib.Error:
        return
    for child in children:
        if child is not None:
            yield child
            yield from parts(child)


class Reader:
    """The window as AT-SPI reports it."""

    def __init__(self, words):
        self.words = words
        self.app = wait("the window in the tree", self.application)

    def application(self):
        desktop = Atspi.get_desktop(0)
        for i in range(desktop.get_child_count()):
            app = desktop.get_child_at_index(i)
            if app and "gsk980td" in (app.get_name() or ""):
                return app
        return None

    def find(self, name, start=False):
        for part in parts(self.app):
            try:
                called = part.get_name() or ""
            except GLib.Error:
                continue
            if called == name or (start and called.startswith(name)):
                return part
        return None

    def press(self, name, start=False):
        part = wait(f"a part named '{name}'", lambda: self.find(name, start))
        action = part.get_action_iface()
        if action is None or action.get_n_actions() == 0:
            fail(f"'{name}' has no action")
        action.do_action(0)
        return part

    def lcd(self):
        part = wait("the LCD", lambda: self.find(self.words["lcd"]))
        return Atspi.Text.get_text(part, 0, -1)

    def description(self, name):
        part = wait(f"a part named '{name}'", lambda: self.find(name))
        return part.get_description()

    def lit(self, name):
        states = self.find(name).get_state_set()
        return states.contains(Atspi.StateType.PRESSED) or states.contains(
            Atspi.StateType.CHECKED
        )


def names(reader):
    """Every part that does something has a name."""
    count = 0
    for part in parts(reader.app):
        if part.get_role_name() in NAMED:
            count += 1
            if not (part.get_name() or "").strip():
                fail(f"a {part.get_role_name()} has no name")
    return count


def by_screen_reader(reader):
    words = reader.words
    # The questions of the first start.
    reader.press(words["purpose"])
    reader.press(words["begin"])
    reader.lcd()
    count = names(reader)
    print(f"{count} parts have names")
    before = {part.get_name() for part in parts(reader.app)}
    reader.press(words["samples"])

    def listed():
        now = [part.get_name() for part in parts(reader.app)
               if part.get_role_name() == "push button"]
        return [name for name in now if name not in before]

    opened = wait("the list of samples", listed)
    print("samples:", ", ".join(opened[:4]))
    reader.press(opened[0])
    if reader.description(words["lamp"]) != words["off"]:
        fail("the lamp of single block is not off at first")
    reader.press(words["auto"])
    reader.press(words["single"])
    wait("the lamp of single block", lambda: reader.description(words["lamp"]) == words["on"])
    reader.press(words["single"])
    wait("the lamp to go out", lambda: reader.description(words["lamp"]) == words["off"])
    reader.press(words["start"])
    wait("the lamp of cycle start", lambda: reader.lit(words["start"]))
    wait("the first move", lambda: MOVES.search(reader.lcd()))
    reader.press(words["hold"])
    wait("the lamp of feed hold", lambda: reader.lit(words["hold"]))
    reader.press(words["start"])
    wait("the lamp of cycle start again", lambda: reader.lit(words["start"]))
    reader.press(words["stop"])
    text = wait("the alarm on the LCD",
                lambda: ALARM in reader.lcd() and reader.lcd())
    print("read:", next(line.strip() for line in text.splitlines() if ALARM in line))
    reader.press(words["stop"])
    reader.press(words["reset"])
    wait("the alarm to go", lambda: ALARM not in reader.lcd())

    def ready():
        """The words blink."""
        looks = []
        for _ in range(15):
            looks.append(NOT_READY in reader.lcd())
            time.sleep(0.1)
        return not any(looks)

    wait("the control to be ready", ready)


def key(name):
    subprocess.run(["xdotool", "key", name], check=True)
    time.sleep(0.3)


def by_keyboard(reader):
    """The program lies in the control already: search, run, stop, read the alarm."""
    words = reader.words
    # There is no window manager on this display that would do it.
    subprocess.run("xdotool search --sync --name GSK980TD windowfocus", shell=True, check=True)
    key("F9")
    wait("the lamp of cycle start by its key", lambda: reader.lit(words["start"]))
    wait("the first move", lambda: MOVES.search(reader.lcd()))
    key("F10")
    wait("the lamp of feed hold", lambda: reader.lit(words["hold"]))
    key("F12")
    wait("the alarm on the LCD", lambda: ALARM in reader.lcd())
    key("F12")
    key("Escape")
    wait("the alarm to go", lambda: ALARM not in reader.lcd())


def switch_on():
    """Says that a screen reader is there, before the window asks."""
    bus = Gio.bus_get_sync(Gio.BusType.SESSION)
    # Whoever asks for the address starts the bus of the screen readers.
    bus.call_sync("org.a11y.Bus", "/org/a11y/bus", "org.a11y.Bus", "GetAddress", None, None,
                  Gio.DBusCallFlags.NONE, -1, None)
    for name in ("IsEnabled", "ScreenReaderEnabled"):
        bus.call_sync(
            "org.a11y.Bus", "/org/a11y/bus", "org.freedesktop.DBus.Properties", "Set",
            GLib.Variant("(ssv)", ("org.a11y.Status", name, GLib.Variant("b", True))),
            None, Gio.DBusCallFlags.NONE, -1, None)


def main():
    program, *options = sys.argv[1:]
    language = options[options.index("--lang") + 1] if "--lang" in options else "en"
    switch_on()
    data = tempfile.mkdtemp(prefix="gsk980td-reader-")
    environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1")
    window = subprocess.Popen(
        [program, "--data", data, "--lang", language], env=environment,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        # Asked before there is an application, AT-SPI sometimes never sees one.
        subprocess.run("xdotool search --sync --name GSK980TD", shell=True, check=True,
                       stdout=subprocess.DEVNULL)
        time.sleep(1)
        reader = Reader(WORDS[language])
        by_screen_reader(reader)
        by_keyboard(reader)
    finally:
        window.terminate()
        window.wait()
        shutil.rmtree(data, ignore_errors=True)
    print("open, run, stop, read the alarm: by screen reader and by keyboard")


main()
