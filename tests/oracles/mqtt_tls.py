#!/usr/bin/env python3
"""Connects `gsk980td` to Mosquitto with TLS, and to brokers whose certificate it must refuse.

    tests/oracles/mqtt_tls.py PROGRAM

PROGRAM is the built `gsk980td`; `mosquitto` and `openssl` are installed. It checks that
- `run --mqtt mqtts://` and `class --broker mqtts://` connect with the named authority, with keys of
  RSA and of elliptic curves, with TLS 1.2 and 1.3, by name and by address;
- an unknown authority, another name, an expired certificate and a broker without TLS are refused,
  each with its own sentence, and Mosquitto sees no client.
"""

import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "assets/programs/01-stepped-shaft.CNC"
ERRORS = []
CONFIG = """
[ca]
default_ca = d
[d]
database = index
serial = serial
new_certs_dir = .
default_md = sha256
policy = p
unique_subject = no
copy_extensions = copy
[p]
commonName = supplied
[authority]
basicConstraints = critical, CA:true
keyUsage = keyCertSign
[leaf]
basicConstraints = CA:false
"""


def check(condition, text):
    print("ok    " if condition else "FAILED", text)
    if not condition:
        ERRORS.append(text)


def openssl(folder, *words):
    subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)


def make_key(folder, name, kind):
    options = {"rsa": ["RSA"], "ec": ["EC", "-pkeyopt", "ec_paramgen_curve:P-384"]}[kind]
    openssl(folder, "genpkey", "-algorithm", *options, "-out", f"{name}.key")


def make_authority(folder, name):
    make_key(folder, name, "rsa")
    openssl(folder, "req", "-x509", "-new", "-key", f"{name}.key", "-subj", f"/CN={name}",
            "-days", "30", "-out", f"{name}.crt")


def make_certificate(folder, name, authority, names, kind="ec", end="20991231000000Z"):
    make_key(folder, name, kind)
    openssl(folder, "req", "-new", "-key", f"{name}.key", "-subj", f"/CN={name}",
            "-addext", f"subjectAltName={names}", "-out", f"{name}.csr")
    openssl(folder, "ca", "-batch", "-config", "ca.conf", "-keyfile", f"{authority}.key",
            "-cert", f"{authority}.crt", "-in", f"{name}.csr", "-extensions", "leaf", "-notext",
            "-startdate", "20200101000000Z", "-enddate", end, "-out", f"{name}.crt")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Broker:
    """Mosquitto with a certificate; without one it does not encrypt."""

    def __init__(self, folder, certificate=None, version=None):
        self.port = free_port()
        lines = [f"listener {self.port}", "allow_anonymous true", "persistence false", "user root",
                 "log_dest stderr", "log_type all"]
        if certificate:
            lines += [f"certfile {folder}/{certificate}.crt", f"keyfile {folder}/{certificate}.key"]
        if version:
            lines.append(f"tls_version {version}")
        config = folder / f"{self.port}.conf"
        config.write_text("\n".join(lines) + "\n")
        self.log = folder / f"{self.port}.log"
        with open(self.log, "w") as log:
            self.process = subprocess.Popen(["mosquitto", "-c", config], stderr=log)
        for _ in range(100):
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.05)
        sys.exit("mosquitto does not start")

    def clients(self):
        return len(re.findall(r"New client connected", self.log.read_text()))

    def stop(self):
        self.process.terminate()
        self.process.wait()


def run_program(program, url, *options):
    """Runs the sample for some seconds; returns what it reports."""
    command = [program, "run", SAMPLE, "--spindle", "800", "--lang", "en", "--mqtt", url, *options]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        _, errors = process.communicate(timeout=6)
    except subprocess.TimeoutExpired:
        process.terminate()
        _, errors = process.communicate()
    return errors


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        (folder / "ca.conf").write_text(CONFIG)
        (folder / "index").write_text("")
        (folder / "serial").write_text("01\n")
        make_authority(folder, "workshop")
        make_authority(folder, "stranger")
        local = "DNS:localhost,IP:127.0.0.1"
        make_certificate(folder, "curve", "workshop", local)
        make_certificate(folder, "rsa", "workshop", local, kind="rsa")
        make_certificate(folder, "other", "workshop", "DNS:other.example")
        make_certificate(folder, "expired", "workshop", local, end="20210101000000Z")
        trusted = ["--mqtt-ca", folder / "workshop.crt"]
        for certificate, version in [("curve", None), ("rsa", None), ("curve", "tlsv1.2"), ("rsa", "tlsv1.2")]:
            broker = Broker(folder, certificate, version)
            for host in ["localhost", "127.0.0.1"]:
                errors = run_program(program, f"mqtts://{host}:{broker.port}", *trusted)
                connected = f"MQTT: connected to mqtts://{host}:{broker.port}" in errors
                check(connected, f"{certificate} {version or 'tlsv1.3'} {host} {errors if not connected else ''}")
            shown = subprocess.run(
                [program, "class", "--broker", f"mqtts://localhost:{broker.port}", "--code", "K7M2", "--text",
                 "--seconds", "4", "--lang", "en", *trusted], capture_output=True, text=True)
            check("0 of 0 seats connected" in shown.stdout, f"class, {certificate} {shown.stderr}")
            check(broker.clients() == 3, f"{certificate}: three clients, not {broker.clients()}")
            broker.stop()
        for certificate, options, sentence in [
            ("curve", ["--mqtt-ca", folder / "stranger.crt"], "not signed by an authority"),
            ("curve", [], "authorit"),
            ("other", trusted, "is not for localhost"),
            ("expired", trusted, "has expired"),
            (None, trusted, "does not speak TLS"),
            ("curve", ["--mqtt-ca", folder / "ca.conf"], "no certificate in PEM"),
        ]:
            broker = Broker(folder, certificate)
            before = broker.clients()
            errors = run_program(program, f"mqtts://localhost:{broker.port}", *options)
            lines = [line for line in errors.splitlines() if "MQTT" in line]
            check(len(lines) == 1 and sentence in lines[0], f"refused: {errors.strip()}")
            check(broker.clients() == before, "no client was connected")
            broker.stop()
    if ERRORS:
        sys.exit(f"{len(ERRORS)} failed")


if __name__ == "__main__":
    main()
