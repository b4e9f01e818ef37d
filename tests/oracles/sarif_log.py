#!/usr/bin/env python3
"""`check --format sarif` read by a program nobody here wrote.

Every case and sample is checked once as JSON and once as SARIF; what `sarif-tools`
(PyPI) reads out of the log must be the alarms and warnings of the JSON, at their lines.

    pip install sarif-tools
    cargo build --release
    tests/oracles/sarif_log.py [target/release/gsk980td]
"""

import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from sarif import loader

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDERS = ["tests/cases", "assets/programs"]
# A warning says its place where the log has none for it.
PLACE = re.compile(r"^(O\d+, )?line \d+: ")


def said(program, form):
    command = [program, "check", *FOLDERS, "--lang", "en", "--format", form]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode not in (0, 1, 2, 3):
        raise SystemExit(f"{command}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def main():
    program = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
    wanted = Counter()
    for line in said(program, "json").splitlines():
        report = json.loads(line)
        alarms = [report["alarm"]] if report["alarm"] else []
        for alarm in alarms + report["more_alarms"]:
            wanted[report["file"], f"{alarm['class']}{alarm['number']:03}"] += 1
        for warning in report.get("warnings", []):
            wanted[report["file"], PLACE.sub("", warning)[:20]] += 1
        if report["end"] == "limit" and not alarms:
            wanted[report["file"], "limit"] += 1
    with tempfile.NamedTemporaryFile("w", suffix=".sarif") as log:
        log.write(said(program, "sarif"))
        log.flush()
        records = loader.load_sarif_file(log.name).get_records()
    found = Counter()
    for record in records:
        # Of a warning its words: it has no number.
        rule, words = record["Code"], PLACE.sub("", record["Description"])
        found[record["Location"], rule if record["Severity"] == "error" else words[:20]] += 1
    for which, count in (wanted - found).items():
        print("not in the log:", which, count)
    for which, count in (found - wanted).items():
        print("only in the log:", which, count)
    print(f"{sum(wanted.values())} wanted, {sum(found.values())} found")
    sys.exit(wanted != found)


if __name__ == "__main__":
    main()
