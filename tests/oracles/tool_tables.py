#!/usr/bin/env python3
"""Tool tables of `tools export` and `tools import` against the programs that own the formats.

    tests/oracles/tool_tables.py target/debug/gsk980td --linuxcnc DIR [--freecad DIR]

DIR of LinuxCNC is a checkout of its source: its reader and writer of tool tables
(`src/emc/tooldata/tooldata_common.cc`) are compiled with a storage in memory, read what is
exported here and write it again, which is imported here. Its sample tables are imported as well.
DIR of FreeCAD is its folder of tools (`Mod/Path/Tools` or `Mod/CAM/Tools`): its library is
imported, and the exported files have the fields of its own.
"""

import argparse
import json
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

STUBS = {
    "nml_intf/canon.hh": '#include "emctool.h"\n',
    "nml_intf/emc_nml.hh": "struct EMC_TOOL_STAT;\n",
    "emcpos.h": "#pragma once\n#include <ctype.h>\n#include <errno.h>\nstruct PmCartesian { double x, y, z; };\n"
    "struct EmcPose { PmCartesian tran; double a, b, c, u, v, w; };\n",
    "main.cc": """#include "tooldata.hh"
static CANON_TOOL_TABLE table[CANON_POCKETS_MAX];
extern "C" {
toolidx_t tooldata_put(struct CANON_TOOL_TABLE t, int i) { table[i] = t; return IDX_OK; }
toolidx_t tooldata_get(CANON_TOOL_TABLE *t, int i) { *t = table[i]; return IDX_OK; }
void tooldata_reset(void) { for (auto &t : table) t = tooldata_entry_init(); }
void tooldata_last_index_set(int) {}
int tooldata_db_getall(void) { return 0; }
int tooldata_db_notify(tool_notify_t, int, int, CANON_TOOL_TABLE) { return 0; }
}
int main(int, char **words) {
    tooldata_init(false);
    return tooldata_load(words[1]) || tooldata_save(words[2]);
}
""",
}
DESCRIPTIONS = (
    "CNMG 120408 PCLNR 2020K12", "DNMG 150608 PDJNL 2525M15", "VBMT 160404 SVVBN 2020K16",
    "CCMT 09T304 S16R-SCLCR 09", "TNMG 160408 PTGNR 2020K16", "WNMG 080412 MWLNR 2525M08",
    "drill 8.5", "drill 12 point=140", "groove 3", "groove 4 tip=8", "thread 60", "thread 55 tip=6",
)


def run(*words):
    """Runs a command, which must succeed."""
    done = subprocess.run([str(it) for it in words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def build_reader(source, folder):
    """LinuxCNC's reader and writer of tool tables as a program."""
    build = folder / "reader"
    for name, text in STUBS.items():
        path = build / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name in ("tooldata/tooldata_common.cc", "tooldata/tooldata.hh", "nml_intf/emctool.h"):
        shutil.copy(source / "src/emc" / name, build)
    program = build / "reader"
    run("g++", "-w", "-I", build, build / "main.cc", build / "tooldata_common.cc", "-o", program)
    return program


def dimensions(program, data):
    """The tools of a data folder: id, T number and all dimensions, by the CSV table."""
    rows = [line.split(",") for line in run(program, "tools", "export", "-", "--format", "csv",
                                             "--data", data).splitlines()[1:]]
    return sorted((row[4], row[3]) for row in rows)


def check_linuxcnc(program, source, folder):
    """Random libraries through LinuxCNC; its sample tables into this program."""
    reader = build_reader(source, folder)
    for index in range(20):
        pick = random.Random(index)
        data = folder / f"data{index}"
        for station, text in enumerate(pick.sample(DESCRIPTIONS, 6), 1):
            run(program, "tools", "add", *text.split(), "--id", f"t{station}", "--station",
                station, "--data", data)
        table, again = folder / "out.tbl", folder / "again.tbl"
        run(program, "tools", "export", table, "--data", data)
        message = run(reader, table, again)
        if "skipped" in message or len(again.read_text().splitlines()) != 6:
            raise AssertionError(f"{message}\n{table.read_text()}\n{again.read_text()}")
        other = folder / f"other{index}"
        run(program, "tools", "import", again, "--data", other)
        before, after = dimensions(program, data), dimensions(program, other)
        if before != after:
            raise AssertionError(f"{before}\n{after}\n{again.read_text()}")
    count = 0
    for table in sorted((source / "configs/sim").rglob("*lathe*.tbl")):
        own = [it for it in table.read_text().splitlines() if it.startswith("T")]
        done = subprocess.run(
            [program, "tools", "import", str(table), "--data", str(folder / f"sample{count}")],
            capture_output=True, text=True, check=False)
        refused = [it for it in done.stderr.splitlines() if "outside" in it]
        found = int(done.stdout.split()[0])
        if found + len(refused) != len(own):
            raise AssertionError(f"{table}: {found} of {len(own)}\n{done.stderr}")
        count += 1
    print(f"LinuxCNC: 20 libraries of 6 tools read and written, {count} sample tables imported")


def check_freecad(program, tools, folder):
    """FreeCAD's library into this program; exported files beside FreeCAD's own."""
    data = folder / "freecad"
    done = subprocess.run(
        [program, "tools", "import", str(tools / "Library/Default.fctl"), "--data", str(data)],
        capture_output=True, text=True, check=False)
    if done.stdout.split()[0] != "1":
        raise AssertionError(f"{done.stdout}{done.stderr}")
    out = folder / "Library"
    out.mkdir()
    run(program, "tools", "export", out / "shop.fctl", "--data", data)
    own = json.loads((tools / "Bit/5mm_Drill.fctb").read_text())
    written = json.loads((folder / "Bit/5mm_Drill.fctb").read_text())
    if set(own) != set(written) or own["parameter"] != written["parameter"]:
        raise AssertionError(f"{own}\n{written}")
    lists = [json.loads((it / "Library").glob("*.fctl").__next__().read_text())
             for it in (tools, folder)]
    keys = [set(it["tools"][0]) for it in lists]
    if keys[0] != keys[1] or not set(lists[0]) <= set(lists[1]):
        raise AssertionError(lists)
    print("FreeCAD: the drill of its library read and written, mills left out")


def main():
    """Runs both comparisons."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--linuxcnc", type=Path)
    parser.add_argument("--freecad", type=Path)
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp())
    if arguments.linuxcnc:
        check_linuxcnc(arguments.program, arguments.linuxcnc, folder)
    if arguments.freecad:
        check_freecad(arguments.program, arguments.freecad, folder)
    shutil.rmtree(folder)


if __name__ == "__main__":
    sys.exit(main())
