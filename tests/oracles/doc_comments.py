#!/usr/bin/env python3
"""Draws doc comments of packages at random, each with the signature beside it, for a reader who
judges whether the comment says what the item does.

usage: doc_comments.py [--seed N] [--count N] PACKAGE...
"""
import argparse
import pathlib
import random
import re

parser = argparse.ArgumentParser()
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--count", type=int, default=20)
parser.add_argument("packages", nargs="+")
options = parser.parse_args()

ITEM = re.compile(r"\s*(pub(\([a-z ]+\))? )?((const|async|unsafe) )*(fn|struct|enum|trait|type|static|const|mod)\b|\s*(pub(\([a-z ]+\))? )?\w+:|\s*[A-Z]\w*[ ,({]")


def comments(path):
    """Yields (line, comment, signature) of every doc comment of an item in a file."""
    lines = path.read_text().split("\n")
    at = 0
    while at < len(lines):
        if not lines[at].lstrip().startswith("///"):
            at += 1
            continue
        begin = at
        while lines[at].lstrip().startswith("///"):
            at += 1
        signature = at
        while lines[signature].lstrip().startswith("#["):
            signature += 1
        text = " ".join(line.lstrip()[3:].strip() for line in lines[begin:at])
        end = signature
        while end < min(signature + 8, len(lines) - 1) and not re.search(r"[{;,]\s*$", lines[end]):
            end += 1
        if ITEM.match(lines[signature]):
            yield begin + 1, text, " ".join(line.strip() for line in lines[signature : end + 1])


for package in options.packages:
    files = sorted(pathlib.Path(package, "src").rglob("*.rs"))
    found = [(path, *it) for path in files for it in comments(path)]
    chosen = random.Random(options.seed).sample(found, min(options.count, len(found)))
    print(f"# {package}: {len(chosen)} of {len(found)}")
    for path, line, text, signature in chosen:
        print(f"\n{path}:{line}\n  /// {text}\n  {signature}")
