#!/usr/bin/env bash
# Takes pictures of the window for somebody to look at, at the sizes of usual screens, in both
# languages, dark and light: the questions of the first start, the panel, the panel with each
# view beside it, the layouts of the menu, and what the window shows after keys and clicks.
# Needs Xvfb, xdotool and ImageMagick.
#
#     tools/screens.sh FOLDER [PROGRAM [SIZE…]]        e.g. out target/release/gsk980td 800x1280
#
# The environment selects what is taken and how:
#
#     LANGUAGES="zh en"  LIGHTS="dark light"
#     VIEWS="first panel Machine Scope …"       one start for each
#     LAYOUTS="learner programmer instructor machine panel"   one start for all; learner is first
#     STEPS="pos=F2 all=F2,F2 -=at:200:14 …"    one start: the panel, or the layout STEPS_LAYOUT,
#                                               or the panel with the views STEPS_VIEWS="Lathe, Bench"
#     MODEL=ncb08  MACHINE=FILE  SAMPLE=FILE    control model, simulated lathe, opened program
#     RUN=20       AUTO and cycle start, 20 s before the first picture
#     PARAMS="84=12 175.0=1"  ARGUMENTS="--ladder FILE"   parameters; more of the command line
#     LCD=1        the LCD in the language of the window, too (parameter 184.0)
#     WAIT=6       seconds before a picture after a change of size or layout (3)
#     NUMBER=70    display number; without it each run finds one, so several may run at a time
#
# A step is a name with actions: keys (names of xdotool), `at:X:Y` clicks, `wheel:X:Y:N` scrolls
# down, `wait:S` waits S seconds. It happens at the first size; then a picture is taken under the
# name, `-` takes none. Pictures are named SIZE-LANGUAGE-LIGHT-WHAT.png. A start is resized to all
# sizes to which the window gives the same zoom (window/src/chrome/zoom.rs). All views at all
# sizes take half an hour, four layouts at six sizes ten minutes.
set -euo pipefail
(($# >= 1)) || { sed -n '2,32s/^# \?//p' "$0" >&2; exit 2; }
folder=$1
program=${2:-target/release/gsk980td}
shift $(($# < 2 ? $# : 2))
sizes=("$@")
((${#sizes[@]})) || sizes=(1024x768 1280x800 1366x768 1920x1080 3840x2160 800x1280)
[[ -x $program ]] || { echo "$program is not there: cargo build --release" >&2; exit 1; }
for needed in Xvfb xdotool import; do
    command -v "$needed" >/dev/null || { echo "$needed is missing" >&2; exit 1; }
done
every=(first panel Machine Lathe Scope Bench Ladder Link Program Lesson Transfer Commission Data Project)
# Selected layouts or steps leave out the views, unless those are selected as well.
[[ ! ${LAYOUTS-}${STEPS-} ]] || every=()
read -ra languages <<<"${LANGUAGES:-zh en}"
read -ra lights <<<"${LIGHTS:-dark light}"
read -ra views <<<"${VIEWS:-${every[*]}}"
read -ra layouts <<<"${LAYOUTS-}"
read -ra steps <<<"${STEPS-}"
sample=${SAMPLE:-$(dirname "$0")/../assets/programs/01-stepped-shaft.CNC}
# The keys of window/src/layout/table.rs; the learner's layout has none and therefore is first.
declare -A layout_keys=([panel]=F6 [machine]=F7 [programmer]=F8 [instructor]=F9)

mkdir -p "$folder"
work=$(mktemp -d)
display=
window=
id=
trap 'kill $window $display 2>/dev/null || true; rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1

# find_zoom SIZE: the zoom of the window on a monitor of this size, per cent.
find_zoom() {
    local short=$((${1%x*} < ${1#*x} ? ${1%x*} : ${1#*x}))
    local halves=$((short * 2 / 1080))
    halves=$((halves < 2 ? 2 : halves > 6 ? 6 : halves))
    echo $((halves * 50))
}

# remember DATA LAYOUT [VIEWS]: the layout, and the views docked in it if not its own.
remember() {
    local changes="" front=None is_light=false
    [[ $light != light ]] || is_light=true
    # Where panel and views do not fit together, the view is in front.
    [[ ! ${3-} ]] || front="Some(${3%%,*})"
    [[ $2 != Panel && $2 != Machine ]] || changes="$2: (docked: Some([${3-}]))"
    [[ $2 != Learner ]] || front="Some(Lesson)"
    local settings=$1${MODEL:+/models/$MODEL}
    mkdir -p "$settings"
    local parameters=${PARAMS-}
    [[ ! ${LCD-} || $language != en ]] || parameters+=" 184.0=1"
    if [[ $parameters ]]; then
        # The tool is where the window has it at a first start.
        local where=(--start 0,0)
        [[ ! ${MACHINE-} ]] || where=(--machine "$MACHINE")
        echo "press RESET" >"$work/script"
        # shellcheck disable=SC2086
        "$program" operate --data "$1" ${MODEL:+--model "$MODEL"} "${where[@]}" \
            $(printf ' --param %s' $parameters) \
            "$work/script" >/dev/null 2>"$work/operate.log"
    fi
    echo "(light: $is_light, zoom: Some($zoom), layouts: (chosen: Some($2)," \
        "changes: {$changes}, front: $front))" >"$settings/window.ron"
}

# start DATA ARGUMENT…: the window in the corner of the screen, with the program run if RUN is set.
start() {
    "$program" --data "$@" --lang "$language" ${MODEL:+--model "$MODEL"} \
        ${MACHINE:+--machine "$MACHINE"} ${ARGUMENTS-} 2>"$work/window.log" &
    window=$!
    # A busy computer takes its time.
    for _ in {1..240}; do
        id=$(xdotool search --onlyvisible --name . 2>/dev/null | tail -1) && [[ $id ]] && break
        sleep 0.25
    done
    [[ $id ]] || { echo "no window after a minute: $*" >&2; cat "$work/window.log" >&2; exit 1; }
    sleep 3
    xdotool windowmove "$id" 0 0 windowfocus "$id"
    resize "${group[0]}"
    [[ ! ${RUN-} || $1 == *first ]] || { press ctrl+2; press F9; sleep "$RUN"; }
}

# resize SIZE: the window has this size, with the pointer in its corner.
resize() {
    xdotool windowsize "$id" "${1%x*}" "${1#*x}" mousemove $((${1%x*} - 1)) $((${1#*x} - 1))
    sleep "${WAIT:-3}"
}

press() {
    xdotool keydown "$1"
    sleep 0.15
    xdotool keyup "$1"
    sleep 0.5
}

stop() {
    kill "$window"
    wait "$window" 2>/dev/null || true
    window=
    id=
}

# pictures WHAT: one at each size. The sizes are restored to the first one.
pictures() {
    local size
    for size in "${group[@]}"; do
        ((${#group[@]} == 1)) || resize "$size"
        import -window root -crop "$size+0+0" +repage "$folder/$size-$language-$light-$1.png"
    done
    ((${#group[@]} == 1)) || resize "${group[0]}"
}

take_views() {
    local view data
    for view in "${views[@]}"; do
        # A data folder for each start: a file that is not as it was written is not read.
        data=$work/$zoom-$language-$light-$view
        case $view in
        first) remember "$data" Panel; start "$data" --first-start ;;
        panel) remember "$data" Panel; start "$data" --program "$sample" ;;
        *) remember "$data" Panel "$view"; start "$data" --program "$sample" ;;
        esac
        pictures "${view,,}"
        stop
    done
}

take_layouts() {
    local data=$work/$zoom-$language-$light-layouts layout
    remember "$data" "${layouts[0]^}"
    start "$data" --program "$sample"
    for layout in "${layouts[@]}"; do
        if [[ $layout != "${layouts[0]}" ]]; then
            press "shift+${layout_keys[$layout]}"
            # A busy computer draws the panes and the keys of the panel late.
            sleep "${WAIT:-3}"
        fi
        pictures "$layout"
    done
    stop
}

take_steps() {
    local data=$work/$zoom-$language-$light-steps step action actions
    remember "$data" "${STEPS_LAYOUT:-Panel}" "${STEPS_VIEWS-}"
    start "$data" --program "$sample"
    for step in "${steps[@]}"; do
        IFS=, read -ra actions <<<"${step#*=}"
        for action in "${actions[@]}"; do
            case $action in
            at:*)
                action=${action#at:}
                xdotool mousemove "${action%:*}" "${action#*:}"
                sleep 0.5
                xdotool click 1
                sleep 0.5
                ;;
            wheel:*)
                IFS=: read -r _ x y turns <<<"$action"
                xdotool mousemove "$x" "$y"
                sleep 0.3
                xdotool click --repeat "$turns" --delay 30 5
                sleep 0.5
                ;;
            wait:*) sleep "${action#wait:}" ;;
            *) press "$action" ;;
            esac
        done
        [[ ${step%%=*} == - ]] && continue
        sleep 1
        pictures "${step%%=*}"
    done
    stop
}

declare -A groups=()
for size in "${sizes[@]}"; do
    groups[$(find_zoom "$size")]+="$size "
done
for zoom in "${!groups[@]}"; do
    read -ra group <<<"${groups[$zoom]}"
    width=0 height=0
    for size in "${group[@]}"; do
        width=$((${size%x*} > width ? ${size%x*} : width))
        height=$((${size#*x} > height ? ${size#*x} : height))
    done
    # A server that starts over when a window closes may refuse the next one.
    mkfifo "$work/number"
    Xvfb ${NUMBER:+":$NUMBER"} -displayfd 3 -screen 0 "${width}x${height}x24" -noreset \
        3>"$work/number" >"$work/display.log" 2>&1 &
    display=$!
    read -r number <"$work/number"
    rm "$work/number"
    export DISPLAY=:$number
    for language in "${languages[@]}"; do
        for light in "${lights[@]}"; do
            ((!${#views[@]})) || take_views
            ((!${#layouts[@]})) || take_layouts
            ((!${#steps[@]})) || take_steps
        done
    done
    kill "$display"
    wait "$display" 2>/dev/null || true
    display=
done
