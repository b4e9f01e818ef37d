#!/usr/bin/env python3
"""Lets Home Assistant discover the simulated lathe through Mosquitto, and reads its entities.

    tests/oracles/home_assistant.py PROGRAM HASS

PROGRAM is the built `gsk980td`, HASS the command of an environment in which `pip install
homeassistant` was called; `mosquitto` and the package `paho-mqtt` are installed. Home Assistant installs what its integrations
need at its first start. It checks that
- every discovery topic becomes an entity, and Home Assistant logs no error about MQTT;
- state, mode, program, alarm and positions have values during the run;
- all entities are unavailable after the program has ended.
"""

import json
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time

import paho.mqtt.subscribe as subscribe

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "assets/programs/01-stepped-shaft.CNC"
DUMP = '''
import datetime
import json
import os

from homeassistant.helpers.event import async_track_time_interval


async def async_setup(hass, config):
    def dump(_now):
        states = {it.entity_id: [it.state, dict(it.attributes)] for it in hass.states.async_all()}
        path = hass.config.path("states.json")
        with open(path + ".new", "w") as file:
            json.dump(states, file, default=str)
        os.replace(path + ".new", path)

    async_track_time_interval(hass, dump, datetime.timedelta(seconds=1))
    return True
'''
ERRORS = []


def check(condition, text):
    print("ok    " if condition else "FAILED", text)
    if not condition:
        ERRORS.append(text)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def write_configuration(folder, port):
    (folder / "configuration.yaml").write_text("state_dump:\n")
    component = folder / "custom_components/state_dump"
    component.mkdir(parents=True)
    (component / "__init__.py").write_text(DUMP)
    manifest = {"domain": "state_dump", "name": "States", "version": "1.0.0", "codeowners": [],
                "documentation": "", "requirements": []}
    (component / "manifest.json").write_text(json.dumps(manifest))
    entry = {"entry_id": "0" * 32, "version": 1, "minor_version": 1, "domain": "mqtt", "title": "broker",
             "data": {"broker": "127.0.0.1", "port": port, "discovery": True,
                      "discovery_prefix": "homeassistant"},
             "options": {}, "pref_disable_new_entities": False, "pref_disable_polling": False,
             "source": "user", "unique_id": None, "disabled_by": None}
    (folder / ".storage").mkdir()
    (folder / ".storage/core.config_entries").write_text(json.dumps(
        {"version": 1, "minor_version": 1, "key": "core.config_entries", "data": {"entries": [entry]}}))


def lathe_states(folder):
    try:
        states = json.loads((folder / "states.json").read_text())
    except (OSError, ValueError):
        return {}
    return {name: value for name, value in states.items() if "gsk980td" in name or "lathe" in name}


def wait_for(folder, condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        states = lathe_states(folder)
        if condition(states):
            return states
        time.sleep(1)
    return lathe_states(folder)


def main():
    program, hass = (pathlib.Path(word).absolute() for word in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        port = free_port()
        (folder / "mosquitto.conf").write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
        broker = subprocess.Popen(["mosquitto", "-c", folder / "mosquitto.conf"], stderr=subprocess.DEVNULL)
        configuration = folder / "configuration"
        configuration.mkdir()
        write_configuration(configuration, port)
        assistant = subprocess.Popen([hass, "-c", configuration], stdout=subprocess.DEVNULL,
                                     stderr=subprocess.DEVNULL)
        url = f"mqtt://127.0.0.1:{port}"
        lathe = subprocess.Popen(
            [program, "run", SAMPLE, "--spindle", "800", "--lang", "en", "--mqtt", url, "--mqtt-discovery"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            topics = set()
            threading.Thread(
                target=subscribe.callback, daemon=True, args=(
                    lambda _client, _data, message: topics.add(message.topic), "homeassistant/#"),
                kwargs={"port": port}).start()
            time.sleep(8)
            count = len(topics)
            print(f"{count} discovery topics")
            states = wait_for(configuration, lambda it: len(it) >= count > 0, 400)
            check(len(states) == count > 0, f"{len(states)} entities of {count} topics")
            states = wait_for(configuration, lambda it: it and all(
                value[0] not in ("unavailable", "unknown") for name, value in it.items()
                if re.search("position|mode|program|state", name)), 30)
            for entity, (state, attributes) in sorted(states.items()):
                print(f"  {entity}: {state} {attributes.get('unit_of_measurement', '')}")
            known = [name for name, value in states.items() if value[0] not in ("unavailable", "unknown")]
            check(len(known) >= count - 2, f"{len(known)} entities with a value")
            lathe.terminate()
            lathe.wait()
            states = wait_for(configuration, lambda it: all(v[0] == "unavailable" for v in it.values()), 20)
            gone = [name for name, value in states.items() if value[0] == "unavailable"]
            check(len(gone) == len(states) > 0, f"{len(gone)} entities unavailable after the end")
            log = (configuration / "home-assistant.log").read_text()
            wrong = [line for line in log.splitlines() if "mqtt" in line.lower() and "ERROR" in line]
            check(not wrong, f"errors about MQTT: {wrong[:3]}")
        finally:
            for process in (lathe, assistant, broker):
                process.terminate()
                process.wait()
    if ERRORS:
        sys.exit(f"{len(ERRORS)} failed")


if __name__ == "__main__":
    main()
