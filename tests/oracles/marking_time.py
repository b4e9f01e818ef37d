#!/usr/bin/env python3
"""How long `exercise mark` takes for the submissions of a class.

Thirty learners solve an exercise in twenty machine minutes each: the program of
`22-roughing-cycle` is typed and then cuts new stock again and again. No two recordings are
equal. The table must be there in less than a minute on two processors, without a flag. The
processor time decides, so that a busy computer does not matter.

    cargo build --release
    tests/oracles/marking_time.py [target/release/gsk980td] [learners] [minutes]
"""

import csv
import io
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = str(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/gsk980td").resolve())
LEARNERS = int(sys.argv[2]) if len(sys.argv) > 2 else 30
MINUTES = float(sys.argv[3]) if len(sys.argv) > 3 else 20
EXERCISE = ROOT / "assets/exercises/22-roughing-cycle"
PROCESSORS = 2
MOST_S = 60


def run(*arguments):
    made = subprocess.run([PROGRAM, *map(str, arguments)],
                          capture_output=True, text=True, check=False)
    return made.returncode, made.stdout, made.stderr


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def solve(data, results, script, number):
    file = data / f"learner-{number:02}.txt"
    # Another time before the first key: another recording.
    file.write_text(f"wait {100 + 10 * number}ms\n{script}", encoding="utf-8")
    code, out, err = run("exercise", "solve", "long", "--data", data, "--script", file,
                         "-o", results / f"learner-{number:02}.gskresult")
    assert code == 0, (out, err)


def main():
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        task = data / "exercises/long"
        task.mkdir(parents=True)
        text = (EXERCISE / "task.ron").read_text(encoding="utf-8")
        text = re.sub(r"time_limit: \d+", f"time_limit: {int(MINUTES * 60)}", text)
        (task / "task.ron").write_text(text, encoding="utf-8")
        reference = (EXERCISE / "reference.txt").read_text(encoding="utf-8")
        # The time limit ends the solution.
        again = "press CS\nwait 1s\nwait idle 600s\nwait 1s\n" * 200
        results = data / "results"
        results.mkdir()
        solve(data, results, reference + again, 0)
        with ThreadPoolExecutor(PROCESSORS) as pool:
            list(pool.map(lambda number: solve(data, results, reference + again, number),
                          range(1, LEARNERS)))
        load = os.getloadavg()[0]
        begun, used = time.monotonic(), processor_s()
        code, out, err = run("exercise", "mark", results, "--data", data, "--format", "csv")
        taken, used = time.monotonic() - begun, processor_s() - used
        rows = list(csv.reader(io.StringIO(out)))[1:]
        minutes = sum(float(row[5]) for row in rows) / 60
        assert code == 0 and len(rows) == LEARNERS, (code, err, out)
        print(f"{len(rows)} results of {minutes / len(rows):.1f} machine minutes: {taken:.1f} s "
              f"on {os.cpu_count()} processors (load before: {load:.1f}), "
              f"{minutes * 60 / taken:.0f} times as fast as the machine")
        print(f"{used:.1f} s of processor time: {used / PROCESSORS:.1f} s on {PROCESSORS} idle processors")
        if used / PROCESSORS > MOST_S:
            sys.exit(f"more than {MOST_S} s")


main()
