#!/usr/bin/env python3
"""Reads what the simulated lathe publishes through Mosquitto with paho-mqtt, and disturbs the broker.

    tests/oracles/mqtt_lathe.py PROGRAM [--seconds 40] [--node DIR]

PROGRAM is the built `gsk980td`; `mosquitto` and the package `paho-mqtt` are installed. `--node` names
a folder in which `npm install mqtt` was called: the same topics are read with it. It checks that
- each topic of docs/network.md arrives retained, as JSON, at most `--mqtt-rate` times a second;
- positions, mode, execution and program are those that `/current` of the MTConnect agent has;
- a killed broker that returns has the whole state within five seconds, and a killed program is
  `offline` there;
- a broker that is stopped for ten seconds does not slow the machine down;
- a wrong password is reported, the right one of a file works;
- without the option `strace` sees no call of the network.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

import paho.mqtt.client as paho

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "assets/programs/01-stepped-shaft.CNC"
PREFIX = "hall/lathe-7"
LEVELS = {
    "online", "device", "lathe", "x", "z", "c", "chuck", "control", "path", "alarms", "program", "tools",
}
RATE = 4
ERRORS = []


def check(condition, text):
    if not condition:
        ERRORS.append(text)
        print("FAILED:", text)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Broker:
    """Mosquitto on a port of this computer, without a memory on the disk."""

    def __init__(self, folder, password=None):
        self.port, self.process = free_port(), None
        self.config = pathlib.Path(folder) / f"mosquitto-{self.port}.conf"
        lines = [f"listener {self.port} 127.0.0.1", "persistence false"]
        if password:
            users = pathlib.Path(folder) / "users"
            users.write_text("")
            users.chmod(0o600)
            subprocess.run(["mosquitto_passwd", "-b", users, *password], check=True)
            shutil.chown(users, "mosquitto") if os.getuid() == 0 else None
            pathlib.Path(folder).chmod(0o755)
            lines += ["allow_anonymous false", f"password_file {users}"]
        else:
            lines.append("allow_anonymous true")
        self.config.write_text("\n".join(lines) + "\n")
        self.start()

    def start(self):
        self.process = subprocess.Popen(
            ["mosquitto", "-c", self.config], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        for _ in range(200):
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
                return
            except OSError:
                time.sleep(0.02)
        sys.exit("mosquitto does not start")

    def kill(self):
        self.process.kill()
        self.process.wait()


class Reader:
    """A client of paho-mqtt that records every message."""

    def __init__(self, port, topics=("#",)):
        self.messages, self.lock = [], threading.Lock()
        self.client = paho.Client(paho.CallbackAPIVersion.VERSION2)
        self.client.on_connect = lambda client, *_: [client.subscribe(topic) for topic in topics]
        self.client.on_message = self.take
        self.client.reconnect_delay_set(1, 1)
        self.client.connect("127.0.0.1", port)
        self.client.loop_start()

    def take(self, _client, _data, message):
        with self.lock:
            self.messages.append((time.monotonic(), message.topic, message.payload, message.retain))

    def latest(self):
        with self.lock:
            return {topic: payload for _, topic, payload, _ in self.messages}

    def wait_for(self, topic, text, seconds=10):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if text in self.latest().get(topic, b"").decode():
                return True
            time.sleep(0.02)
        return False

    def close(self):
        self.client.loop_stop()
        self.client.disconnect()


def start(program, *options, stderr=subprocess.DEVNULL, environment=None):
    command = [program, "run", SAMPLE, "--spindle", "800", "--parts", "50", "--lang", "en"]
    return subprocess.Popen(
        [*command, *options], stdout=subprocess.DEVNULL, stderr=stderr,
        env={**os.environ, **(environment or {})},
    )


def current(port):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/current", timeout=5) as response:
        text = response.read().decode()
    values = re.findall(r'dataItemId="([^"]+)"[^>]*>([^<]*)</', text)
    return dict(values)


def document(reader, level):
    return json.loads(reader.latest()[f"{PREFIX}/{level}"])


def compare_with_agent(reader, port):
    """Compares values that MQTT and MTConnect have at one moment, if the machine stands still."""
    agent = current(port)
    for level in ("path", "control"):
        for name, value in document(reader, level).items():
            if name in ("mode", "execution", "program", "estop", "tool", "parts") and name in agent:
                expected = agent[name]
                found = str(int(value) if isinstance(value, float) and value == int(value) else value)
                check(found == expected, f"{name}: MQTT {found}, MTConnect {expected}")


def check_rates(reader, begin):
    times = collections.defaultdict(list)
    with reader.lock:
        for moment, topic, _, retained in reader.messages:
            if moment > begin and not retained:
                times[topic].append(moment)
    for topic, moments in times.items():
        worst = max(sum(at <= other < at + 1 for other in moments) for at in moments)
        check(worst <= RATE + 1, f"{topic}: {worst} messages in a second")
    return {topic: len(moments) for topic, moments in times.items()}


def machine_seconds(port):
    return float(current(port)["time_on"])


def observe(program, folder, seconds, node):
    broker, agent = Broker(folder), free_port()
    url = f"mqtt://127.0.0.1:{broker.port}/{PREFIX}"
    process = start(
        program, "--mqtt", url, "--mqtt-discovery", "--mqtt-rate", str(RATE),
        "--mtconnect", f"127.0.0.1:{agent}",
    )
    reader = Reader(broker.port)
    try:
        check(reader.wait_for(f"{PREFIX}/online", "online"), "no `online`")
        check(reader.wait_for(f"{PREFIX}/path", "ACTIVE"), "no running program")
        time.sleep(1)
        levels = {it.removeprefix(PREFIX + "/") for it in reader.latest() if it.startswith(PREFIX)}
        check(levels == LEVELS, f"topics: {sorted(levels ^ LEVELS)}")
        configs = [it for it in reader.latest() if it.startswith("homeassistant/")]
        check(len(configs) == 14, f"{len(configs)} discovery topics")
        late = Reader(broker.port)
        time.sleep(1)
        retained = {topic for _, topic, _, is_retained in late.messages if is_retained}
        check(len(retained) == len(LEVELS) + 14, f"{len(retained)} retained topics")
        late.close()
        begin = time.monotonic()
        time.sleep(seconds)
        counts = check_rates(reader, begin)
        payload = sum(len(it[1]) + len(it[2]) for it in reader.messages if it[0] > begin)
        print(f"{seconds} s: {sum(counts.values())} messages, {payload / seconds:.0f} bytes a second")
        check(sum(counts.values()) > seconds, "hardly any messages")
        compare_with_agent(reader, agent)

        if node:
            script = (
                "const c=require('mqtt').connect('mqtt://127.0.0.1:%d');const s=new Set();"
                "c.on('connect',()=>c.subscribe('%s/#'));"
                "c.on('message',(t,p)=>{if(!t.endsWith('online'))JSON.parse(p);s.add(t)});"
                "setTimeout(()=>{console.log(s.size);process.exit()},1500)" % (broker.port, PREFIX)
            )
            out = subprocess.run(["node", "-e", script], cwd=node, capture_output=True, text=True)
            check(out.stdout.strip() == str(len(LEVELS)), f"npm mqtt: {out.stdout} {out.stderr}")
            print("npm mqtt:", out.stdout.strip(), "topics")

        # The same machine time passes while the broker takes no bytes.
        before, wall = machine_seconds(agent), time.monotonic()
        broker.process.send_signal(signal.SIGSTOP)
        time.sleep(10)
        passed, wall = machine_seconds(agent) - before, time.monotonic() - wall
        broker.process.send_signal(signal.SIGCONT)
        print(f"broker stopped: {passed:.0f} s of machine time in {wall:.1f} s")
        check(abs(passed - wall) < 1.6, f"{passed} s of machine time in {wall} s")

        broker.kill()
        time.sleep(6)
        begin = time.monotonic()
        broker.start()
        back = Reader(broker.port)
        whole = 0
        while time.monotonic() < begin + 10 and not whole:
            if {f"{PREFIX}/{level}" for level in LEVELS} <= back.latest().keys():
                whole = time.monotonic() - begin
            time.sleep(0.02)
        print(f"broker back: whole state after {whole:.2f} s")
        check(0 < whole < 5, f"whole state after {whole} s")
        process.kill()
        process.wait()
        check(back.wait_for(f"{PREFIX}/online", "offline", 5), "no last will after a kill")
        back.close()
        print("killed program: offline")

        process = start(program, "--mqtt", url)
        ending = Reader(broker.port)
        check(ending.wait_for(f"{PREFIX}/online", "online"), "not online again")
    finally:
        process.kill()
        process.wait()
        reader.close()
        broker.kill()


def check_passwords(program, folder):
    broker = Broker(folder, ("ann", "secret"))
    url = f"mqtt://ann@127.0.0.1:{broker.port}/{PREFIX}"
    right = pathlib.Path(folder) / "right"
    right.write_text("secret\n")
    for options, environment, expected in [
        ((), {}, "refuses user or password"),
        ((), {"GSK980TD_MQTT_PASSWORD": "wrong"}, "refuses user or password"),
        ((), {"GSK980TD_MQTT_PASSWORD": "secret"}, "connected to"),
        (("--mqtt-password-file", right), {}, "connected to"),
    ]:
        process = start(
            program, "--mqtt", url, *options, stderr=subprocess.PIPE, environment=environment
        )
        time.sleep(2)
        process.kill()
        text = process.stderr.read().decode()
        check(expected in text, f"password {options} {environment}: {text}")
        check("secret" not in text, "the password is printed")
    broker.kill()
    print("passwords: four cases")


def check_silence(program):
    if not shutil.which("strace"):
        print("strace is not installed: not checked that nothing is opened")
        return
    out = subprocess.run(
        ["strace", "-f", "-e", "trace=socket,connect,bind,listen", program, "check", SAMPLE],
        capture_output=True, text=True,
    )
    calls = [line for line in out.stderr.splitlines() if "AF_INET" in line]
    run = subprocess.run(
        ["strace", "-f", "-e", "trace=socket,connect,bind,listen", program, "run", SAMPLE],
        capture_output=True, text=True,
    )
    calls += [line for line in run.stderr.splitlines() if "AF_INET" in line]
    check(not calls, f"network without the option: {calls[:3]}")
    print("strace: no call of the network without the option")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program")
    parser.add_argument("--seconds", type=int, default=40)
    parser.add_argument("--node")
    options = parser.parse_args()
    if not shutil.which("mosquitto"):
        print("mosquitto is not installed: nothing is checked")
        return
    with tempfile.TemporaryDirectory() as folder:
        observe(options.program, folder, options.seconds, options.node)
        check_passwords(options.program, folder)
    check_silence(options.program)
    print("FAILED" if ERRORS else "ok")
    sys.exit(bool(ERRORS))


if __name__ == "__main__":
    main()
