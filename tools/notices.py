#!/usr/bin/env python3
"""Writes THIRD-PARTY.md: the packages linked into `gsk980td` and their licences.

Queries cargo for the packages linked on the released platforms, and reads the licence
files in their sources. Run it in the repository after each change of Cargo.lock; it
downloads the sources of packages for other platforms once:

    tools/notices.py
    tools/notices.py --firmware     # firmware/THIRD-PARTY.md, for the pulse board

`cargo test -p gsk980td --test program notices` fails if it must be run again.
"""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PLATFORMS = [
    "x86_64-unknown-linux-gnu",
    "x86_64-pc-windows-gnu",
    "x86_64-pc-windows-msvc",
    "wasm32-unknown-unknown",
]
FOLDER, PACKAGES, FONT_SECTIONS = ROOT, ["gsk980td", "gsk980td-web"], True
if sys.argv[1:] == ["--firmware"]:
    FOLDER, PACKAGES, FONT_SECTIONS = ROOT / "firmware", ["gsk980td-firmware"], False
    PLATFORMS = ["thumbv6m-none-eabi"]
# Order of preference among alternative licences.
CHOICE = ["MIT", "Apache-2.0", "BSD-3-Clause", "BSD-2-Clause", "Zlib", "ISC", "0BSD"]
LICENCE_FILE = re.compile(
    r"licen[cs]e|copying|copyright|unlicense|notice|^fonts/.*\.txt$", re.I
)
# Each licence is recognized by words that no other one contains.
KINDS = [
    ("Apache-2.0", "apache license version 2.0"),
    ("MPL-2.0", "mozilla public license version 2.0"),
    # A reference to the text, which another package contains.
    ("MPL-2.0", "mozilla public license, v. 2.0"),
    ("OFL-1.1", "sil open font license"),
    ("Unicode-3.0", "unicode license v3"),
    ("MIT", "to any person obtaining a copy of this software and associated documentation"),
    ("Zlib", "this software is provided 'as-is', without any express or implied"),
    ("BSD", "redistribution and use in source and binary forms"),
    ("ISC", "permission to use, copy, modify, and/or distribute this software for any"),
    ("ISC", "permission to use, copy, modify, and distribute this software for any"),
]
NAMES = {
    "MIT": "MIT License",
    "Apache-2.0": "Apache License, Version 2.0",
    "BSD-3-Clause": "BSD 3-Clause License",
    "BSD-2-Clause": "BSD 2-Clause License",
    "MPL-2.0": "Mozilla Public License, Version 2.0",
    "OFL-1.1": "SIL Open Font License, Version 1.1",
    "Unicode-3.0": "Unicode License V3",
    "Zlib": "zlib License",
    "ISC": "ISC License",
}


def plain(text):
    """Reduces a text to its words, for comparison."""
    return re.sub(r"[\s*#>]+", " ", text).replace('"', "").strip().lower()


def comparable(text):
    return plain(text).replace("license, version", "license version").replace("“", "").replace("”", "")


def linked(platform):
    """Returns the packages of a platform: (name, version) to (expression, repository)."""
    command = ["cargo", "tree", "--locked", "-e", "normal,no-proc-macro"]
    command += ["--prefix", "none", "--target", platform, "--format", "{p}\t{l}\t{r}"]
    command += [word for package in PACKAGES for word in ("-p", package)]
    said = subprocess.run(command, cwd=FOLDER, check=True, capture_output=True, text=True)
    packages = {}
    for line in filter(None, said.stdout.splitlines()):
        package, expression, repository = line.removesuffix(" (*)").split("\t")
        name, version, *rest = package.split()
        if not any(part.startswith("(/") for part in rest):
            packages[name, version.removeprefix("v")] = (expression, repository)
    return packages


def locked():
    """Returns the packages of Cargo.lock that come from a registry."""
    lock = tomllib.loads((FOLDER / "Cargo.lock").read_text())
    return {(p["name"], p["version"]) for p in lock["package"] if "source" in p}


def source(name, version):
    home = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo"))
    for folder in sorted(home.glob(f"registry/src/*/{name}-{version}")):
        return folder
    sys.exit(f"the source of {name} {version} is not there")


def taken(expression):
    """Returns the licences selected from an SPDX expression."""
    expression = expression.replace("/", " OR ")
    chosen = []
    for all_of in re.split(r"\s+AND\s+", expression):
        choices = re.split(r"\s+OR\s+", all_of.strip("() "))
        known = [licence for licence in CHOICE if licence in choices]
        chosen.append(known[0] if known else choices[0])
    return sorted(set(chosen))


def kinds(text):
    words = comparable(text)
    found = {kind for kind, mark in KINDS if mark in words}
    if "BSD" in found:
        found.remove("BSD")
        found.add("BSD-3-Clause" if "endorse or promote" in words else "BSD-2-Clause")
    return found


def licence_files(folder):
    """Returns the licence texts of a package: file name to text."""
    texts = {}
    for path in sorted(folder.rglob("*")):
        inside = path.relative_to(folder)
        deep = len(inside.parts) > 2
        code = path.suffix in {".rs", ".toml", ".json", ".py", ".sh", ".ttf", ".h", ".c"}
        if path.is_file() and not deep and not code and LICENCE_FILE.search(str(inside)):
            texts[str(inside)] = path.read_text(errors="replace").replace("\r\n", "\n")
    return texts


def copyright_lines(text):
    """Returns the consecutive lines that name copyright holders."""
    lines = []
    for line in text.splitlines():
        line = line.lstrip(" \t*#>/").rstrip()
        holder = re.match(r"(copyright|\(c\)|©|portions)\b|©", line, re.I)
        named = re.search(r"\d{4}|authors|developers|contributors|by ", line)
        form = re.search(r"\[yyyy\]|\{yyyy\}|copyright (notice|owner|holder|license)", line, re.I)
        if holder and named and not form and line not in lines:
            lines.append(line)
    return lines


def authors(folder):
    manifest = tomllib.loads((folder / "Cargo.toml").read_text())
    names = [re.sub(r"\s*<.*>", "", name) for name in manifest["package"].get("authors", [])]
    return ", ".join(names)


MIT_BODY = re.compile(r"Permission is hereby granted.*?DEALINGS\s+IN\s+THE\s+SOFTWARE\.", re.S)
# Most characters of a title with its copyright holders.
MOST_HOLDERS = 1000
FONTS = {"OFL-1.1"}


def is_usual(licence, text, mit):
    """Returns whether a text is the usual one, except for its copyright holders."""
    if licence == "Apache-2.0":
        return True
    body = MIT_BODY.search(text)
    if licence != "MIT" or body is None or plain(body[0]) != plain(mit):
        return False
    # The rest names the copyright holders or the alternative licence.
    rest = text.replace(body[0], "")
    return len(rest) < MOST_HOLDERS or "Apache-2.0" in kinds(rest)


def main():
    packages = {}
    for platform in PLATFORMS:
        packages.update(linked(platform))
    lock = locked()
    mit = MIT_BODY.search((ROOT / "LICENSE-MIT").read_text())[0]

    holders = {"MIT": [], "Apache-2.0": []}
    bodies = {}  # (licence, words) -> (text, users)

    def add(licence, text, user):
        users = bodies.setdefault((licence, plain(text)), (text, []))[1]
        if user not in users:
            users.append(user)

    rows = []
    for (name, version), (expression, repository) in sorted(packages.items()):
        folder = source(name, version)
        texts = licence_files(folder)
        # Made from the SDK of the Pico, without its licence text.
        if name in {"rp-pac", "rp2040-boot2"}:
            texts["pico-sdk"] = (ROOT / "firmware/PICO-SDK-LICENSE.txt").read_text()
        chosen = taken(expression)
        rows.append((name, version, expression, " and ".join(chosen), repository))
        for licence in chosen:
            fitting = [text for text in texts.values() if licence in kinds(text)]
            own = []
            for text in fitting:
                own += [line for line in copyright_lines(text) if line not in own]
            if licence in holders:
                if not own:
                    by = authors(folder)
                    own = [f"Copyright (c) {by}" if by else f"Copyright (c) the authors of {name}"]
                holders[licence].append((name, version, own))
            elif not fitting:
                sys.exit(f"{name} {version}: no text of {licence} among {sorted(texts)}")
            for text in fitting:
                if not is_usual(licence, text, mit):
                    add(licence, text, f"{name} {version}")
        # NOTICE files that the Apache licence requires, and licences of fonts in the package.
        for file, text in texts.items():
            handed_on = re.fullmatch(r"notice(\..*)?", file, re.I) and "Apache-2.0" in chosen
            font = FONTS & set(chosen) and not kinds(text) & set(chosen)
            if handed_on or font:
                add("NOTICE", text, f"{name} {version}")

    apache = (ROOT / "LICENSE-APACHE").read_text()
    out = [
        "# Third-party notices",
        "",
        f"The binary `{PACKAGES[0]}` contains the packages below, on one platform or another, each "
        "under the licence that is taken of those it is offered under. The source of each is at "
        "`https://crates.io/crates/NAME/VERSION`, unchanged. Written by `tools/notices.py`.",
        "",
        "It contains the standard library of Rust, too (https://github.com/rust-lang/rust): "
        "Copyright (c) The Rust Project Contributors, MIT or Apache-2.0.",
        "",
        "| Package | Version | Licence | Taken | Repository |",
        "|---|---|---|---|---|",
    ]
    out += [f"| {' | '.join(row)} |" for row in rows]
    if FONT_SECTIONS:
        out += ["", "## Glyphs of GNU Unifont", ""]
        out += ["The crate `unifont` contains glyphs of GNU Unifont 15.1.05, under this licence:", ""]
        out += quoted((ROOT / "assets/fonts/OFL.txt").read_text())
        out += ["", "## Characters of Noto Sans", ""]
        out += quoted((ROOT / "assets/fonts/NOTO.txt").read_text())
        out += ["", "## Phosphor Icons", ""]
        out += quoted((ROOT / "assets/fonts/PHOSPHOR.txt").read_text())
    for licence, text in [("MIT", mit), ("Apache-2.0", apache)]:
        out += ["", f"## {NAMES[licence]}", ""]
        for name, version, own in holders[licence]:
            out += [f"- {name} {version}: {'; '.join(own)}"]
        out += [""]
        out += quoted(text)
    for (licence, _), (text, users) in sorted(bodies.items(), key=lambda body: body[0]):
        title = "Notice" if licence == "NOTICE" else NAMES[licence]
        out += ["", f"## {title}: {', '.join(users)}", ""]
        out += quoted(text)
    out += ["", "## Not in the binaries", ""]
    out += ["These packages stand in Cargo.lock for other platforms, for the build and for tests."]
    out += [""]
    out += [f"- {name} {version}" for name, version in sorted(lock - packages.keys())]
    (FOLDER / "THIRD-PARTY.md").write_text("\n".join(out) + "\n")


def quoted(text):
    lines = [line.rstrip() for line in text.strip("\n").splitlines()]
    return ["```text", *(line.replace("```", "'''") for line in lines), "```"]


main()
