"""Reads the xAPI statements of `gsk980td exercise mark --format xapi` with another program's
reader (PyPI `tincan`) and checks what a learning record store would refuse.

    gsk980td exercise mark FOLDER --format xapi -o statements.json
    python tests/oracles/xapi_statements.py statements.json
"""

import json
import re
import sys

from tincan import Statement

UUID = re.compile(r"^[0-9a-f]{8}-[0-9a-f]{4}-[1-8][0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$")

statements = json.load(open(sys.argv[1], encoding="utf-8"))
assert statements, "no statement"
ids = []
for raw in statements:
    assert UUID.match(raw["id"]), raw["id"]
    ids.append(raw["id"])
    read = Statement(raw)
    score = read.result.score
    assert score.min <= score.raw <= score.max and -1 <= score.scaled <= 1, raw
    assert abs(score.scaled - score.raw / score.max) < 1e-9, raw
    assert read.actor.account.name and read.actor.account.home_page.startswith("https://")
    assert read.verb.id.startswith("http") and read.object.id.startswith("urn:")
    assert read.result.completion is True and read.result.duration.total_seconds() > 0
assert len(set(ids)) == len(ids), "two results are one statement"
print(f"{len(statements)} statements read")
