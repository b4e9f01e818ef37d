#!/usr/bin/env python3
"""Validates the documents of the MTConnect agent with the official schemas.

    MTCONNECT_FOLDER=/tmp/documents cargo test -p gsk980td-mtconnect --test situations
    tests/oracles/mtconnect_schemas.py SCHEMAS /tmp/documents

SCHEMAS is the folder `schemas` of github.com/mtconnect/cppagent. The files for XSD 1.0 are used
(`..._1.0.xsd`), which `xmllint` reads. The situations are those of
`mtconnect/tests/situations.rs`; each is written in every version of the schemas.
"""

import collections
import pathlib
import re
import subprocess
import sys


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    schemas, folder = map(pathlib.Path, sys.argv[1:])
    groups = collections.defaultdict(list)
    situations = set()
    for path in sorted(folder.glob("*.xml")):
        name = re.fullmatch(r"(.+)-(\d)\.(\w+)_([\d.]+)\.xml", path.name)
        situations.add(name[1])
        groups[name[3], name[4]].append(path)
    failed = 0
    for (kind, version), paths in sorted(groups.items()):
        schema = schemas / f"MTConnect{kind}_{version}_1.0.xsd"
        command = ["xmllint", "--nonet", "--noout", "--schema", schema, *paths]
        result = subprocess.run(command, capture_output=True, text=True)
        valid = result.stderr.count(" validates")
        print(f"{kind} {version}: {valid} of {len(paths)} valid")
        if valid != len(paths):
            failed += len(paths) - valid
            print(result.stderr[:2000])
    count = sum(map(len, groups.values()))
    print(f"{count} documents of {len(situations)} situations, {failed} invalid")
    sys.exit(bool(failed) or len(situations) < 12)


main()
