#!/usr/bin/env bash
# Takes pictures of the window for somebody to look at: the questions of the first start, the
# panel, and the panel with each view beside it, at the sizes of usual screens, in both
# languages, dark and light. Needs Xvfb, xdotool and ImageMagick.
#
#     tools/screens.sh FOLDER [PROGRAM [SIZE…]]        e.g. out target/release/gsk980td 800x1280
#
# The environment takes a part of them:
#
#     LANGUAGES="zh en"  LIGHTS="dark light"  VIEWS="first panel Machine Scope …"
#
# Pictures are named SIZE-LANGUAGE-LIGHT-WHAT.png; all of them take half an hour. Each run finds
# a display number of its own, so several may run at a time.
set -euo pipefail
(($# >= 1)) || { sed -n '2,14s/^# \?//p' "$0" >&2; exit 2; }
folder=$1
program=${2:-target/release/gsk980td}
shift $(($# < 2 ? $# : 2))
sizes=("$@")
((${#sizes[@]})) || sizes=(1024x768 1280x800 1366x768 1920x1080 3840x2160 800x1280)
[[ -x $program ]] || { echo "$program is not there: cargo build --release" >&2; exit 1; }
for needed in Xvfb xdotool import; do
    command -v "$needed" >/dev/null || { echo "$needed is missing" >&2; exit 1; }
done
read -ra languages <<<"${LANGUAGES:-zh en}"
read -ra lights <<<"${LIGHTS:-dark light}"
every=(first panel Machine Lathe Scope Bench Ladder Link Program Lesson Transfer Commission Data Project)
read -ra views <<<"${VIEWS:-${every[*]}}"
sample=$(dirname "$0")/../assets/programs/01-stepped-shaft.CNC

mkdir -p "$folder"
work=$(mktemp -d)
display=
window=
trap 'kill $window $display 2>/dev/null || true; rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1

# remember DATA [VIEW]: what the window shows beside the panel, or in its place.
remember() {
    local panel="docked: Some([${2:-}])" is_light=false
    [[ $light != light ]] || is_light=true
    mkdir -p "$1"
    echo "(light: $is_light, layouts: (chosen: Some(Panel), changes: {Panel: ($panel)}," \
        "front: ${2:+Some(}${2:-None}${2:+)}))" >"$1/window.ron"
}

# start DATA ARGUMENT…: the window in the middle of the screen, as large as the screen.
start() {
    "$program" --data "$@" 2>"$work/window.log" &
    window=$!
    local id=
    # A busy computer takes its time.
    for _ in {1..240}; do
        id=$(xdotool search --onlyvisible --name GSK980TD 2>/dev/null | tail -1) && [[ $id ]] && break
        sleep 0.25
    done
    [[ $id ]] || { echo "no window after a minute: $*" >&2; cat "$work/window.log" >&2; exit 1; }
    sleep 3
    xdotool windowmove "$id" 0 0 windowsize "$id" "${size%x*}" "${size#*x}" windowfocus "$id"
    sleep 2
}

stop() {
    kill "$window"
    wait "$window" 2>/dev/null || true
    window=
}

picture() {
    import -window root "$folder/$size-$language-$light-$1.png"
}

for size in "${sizes[@]}"; do
    # A server that starts over when a window closes may refuse the next one.
    mkfifo "$work/number"
    Xvfb -displayfd 3 -screen 0 "${size}x24" -noreset 3>"$work/number" >"$work/display.log" 2>&1 &
    display=$!
    read -r number <"$work/number"
    rm "$work/number"
    export DISPLAY=:$number
    for language in "${languages[@]}"; do
        for light in "${lights[@]}"; do
            for view in "${views[@]}"; do
                # A data folder for each start: a file that is not as it was written is not read.
                data=$work/$size-$language-$light-$view
                case $view in
                first) remember "$data"; start "$data" --lang "$language" --first-start ;;
                panel) remember "$data"; start "$data" --lang "$language" --program "$sample" ;;
                *) remember "$data" "$view"; start "$data" --lang "$language" --program "$sample" ;;
                esac
                picture "$(tr '[:upper:]' '[:lower:]' <<<"$view")"
                stop
            done
        done
    done
    kill "$display"
    wait "$display" 2>/dev/null || true
    display=
done
