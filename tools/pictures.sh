#!/usr/bin/env bash
# Makes the pictures of the machine view and of `plot` in docs/: the window on a display of
# its own, and what the command draws. Needs Xvfb, xdotool and ImageMagick.
#
#     cargo build --release && tools/pictures.sh [target/release/gsk980td]
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-target/release/gsk980td}
[[ -x $program ]] || { echo "$program is not there: cargo build --release" >&2; exit 1; }
for needed in Xvfb xdotool import convert; do
    command -v "$needed" >/dev/null || { echo "$needed is missing" >&2; exit 1; }
done

sample=assets/programs/01-stepped-shaft.CNC
work=$(mktemp -d)
export DISPLAY=:93 LIBGL_ALWAYS_SOFTWARE=1
Xvfb "$DISPLAY" -screen 0 1440x900x24 >"$work/display.log" 2>&1 &
display=$!
trap 'kill "$display" 2>/dev/null || true; rm -rf "$work"' EXIT
for _ in {1..50}; do
    xdotool getdisplaygeometry >"$work/display.log" 2>&1 && break
    sleep 0.2
done

click() {
    xdotool mousemove "$1" "$2" sleep 0.2 click 1 sleep 0.5
}

# wait_for_window: the id of the window, after its first pictures.
wait_for_window() {
    local id
    for _ in {1..240}; do
        id=$(xdotool search --onlyvisible --name GSK980TD 2>/dev/null | tail -1) && [[ $id ]] && break
        sleep 0.25
    done
    sleep 4
    echo "$id"
}

# picture FILE LANGUAGE KEY…: the window as it opens, with these keys pressed.
picture() {
    local file=$1 language=$2 window
    shift 2
    "$program" --data "$work/data" --lang "$language" --program "$sample" 2>"$work/window.log" &
    local started=$!
    window=$(wait_for_window)
    xdotool windowmove "$window" 0 0 windowsize "$window" 1440 900 windowfocus "$window" sleep 1
    click 1000 15
    for key in "$@"; do
        xdotool key "$key" sleep 2
    done
    # The icon *Solid* in the bar of the machine view; what stands still is smoothed.
    click 841 65
    xdotool mousemove 1000 12 sleep 4
    import -window root "$work/shot.png"
    convert "$work/shot.png" +dither -colors 128 -strip "$file"
    kill "$started"
    wait "$started" 2>/dev/null || true
    rm -rf "$work/data"
}

# hour NUMBER LANGUAGE PRESSES ARGUMENT…: a picture of docs/first-hour. What is pressed first:
# keys as xdotool names them, X,Y of a click, and seconds of waiting as 40s.
hour() {
    local file=docs/first-hour-$1.png language=$2 presses=$3 window press
    [[ $language == en ]] || file=docs/first-hour-$1.zh-CN.png
    shift 3
    "$program" --data "$work/data" --lang "$language" "$@" 2>"$work/window.log" &
    local started=$!
    window=$(wait_for_window)
    xdotool windowmove "$window" 0 0 windowsize "$window" 1366 768 windowfocus "$window" sleep 1
    for press in $presses; do
        case $press in
            *,*) click "${press%,*}" "${press#*,}" ;;
            [0-9]*s) sleep "$press" ;;
            *) xdotool key "$press" sleep 1 ;;
        esac
    done
    xdotool mousemove 900 12 sleep 1
    import -window root -crop 1366x768+0+0 +repage "$work/shot.png"
    convert "$work/shot.png" +dither -colors 64 -strip "$file"
    kill "$started"
    wait "$started" 2>/dev/null || true
    rm -rf "$work/data"
}

for language in en zh; do
    hour 1 "$language" "" --first-start
    # *I am learning*, *Begin*, the first card under *The first hour*.
    hour 2 "$language" "683,174 398,615 5s 802,680 3s" --first-start
    hour 3 "$language" "shift+F7 ctrl+2 F9 150s" --program "$sample"
done

picture docs/machine.png en shift+F7
picture docs/machine.zh-CN.png zh shift+F7
"$program" plot --dimensions "$sample" --size 1200x700 -o "$work/plot.png"
"$program" plot --solid "$sample" --size 1000x640 -o "$work/solid.png"
convert "$work/plot.png" +dither -colors 128 -strip docs/plot.png
convert "$work/solid.png" +dither -colors 128 -strip docs/solid.png
ls -l docs/*.png
