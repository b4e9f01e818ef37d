#!/usr/bin/env bash
# The window of the program for Windows, under Wine on the display that is there: it
# opens with a sample, is killed, and has kept everything when it is opened again.
#
#   tools/windows_window.sh WINDOWS_PROGRAM FOLDER
#
# FOLDER has what tools/windows_check.py --beside-random puts there. Pictures of the
# display are left in it where ImageMagick is installed.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$2/gsk980td.exe data=$2/data
cp "$1" "$program"
rm -rf "$data"

# Opens the window until its first frame, 60 s at most, looks at it, and kills it.
opened() {
    local name=$1
    shift
    wine "$program" --data "$data" --lang en --figures "$@" 2>"$data.$name.txt" &
    local window=$!
    for _ in {1..300}; do
        grep -q "first frame" "$data.$name.txt" && break
        sleep 0.2
    done
    # What is typed or loaded is kept within a second; a state is recorded every 10 s.
    sleep 13
    if command -v import >/dev/null; then
        import -window root "$data.$name.png"
    fi
    kill -0 "$window"
    kill -9 "$window"
    wait "$window" 2>/dev/null || true
    grep "first frame" "$data.$name.txt"
}

opened first --program assets/programs/01-stepped-shaft.CNC
opened again
# By the program itself, as the memory was left: O0001 is selected, nothing is damaged.
printf 'expect alarm none\npress PRG\nshow\n' >"$data.operate.txt"
wine "$program" operate "$data.operate.txt" --data "$data" | tee "$data.said.txt"
grep -q "O0001" "$data.said.txt"
cmp "$data/programs/O0001.CNC" "$data/copies/programs/O0001.CNC"
