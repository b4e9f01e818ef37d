#!/usr/bin/env bash
# Installs a .deb on a bare Debian and uses it there: commands, manual, completions,
# desktop files, the window. Needs root and debootstrap; where there is no mirror, the
# package is unpacked only and its libraries are looked up here.
#   tools/deb_check.sh PACKAGE.deb [SUITE]
set -euo pipefail
package=$(realpath "$1")
suite=${2:-bookworm}
cd "$(dirname "$0")/.."
work=$(mktemp -d -p /var/tmp)
bare="$work/bare"

fail() {
    printf 'FAILED: %s\n' "$*" >&2
    exit 1
}
leave() {
    umount "$bare/proc" 2>/dev/null || true
    mountpoint -q "$bare/proc" || rm -rf --one-file-system "$work"
}
trap leave EXIT

if command -v lintian >/dev/null; then
    echo "== lintian"
    lintian --allow-root --fail-on error "$package" || fail "lintian finds errors"
else
    echo "skipped: lintian is not installed"
fi

unpacked() {
    echo "== unpacked only: $*"
    dpkg -x "$package" "$work/unpacked"
    binary="$work/unpacked/usr/bin/gsk980td"
    ldd "$binary"
    ! ldd "$binary" | grep -q 'not found' || fail "a library is missing"
    "$binary" --version
    "$binary" check "$work/unpacked/usr/share/doc/gsk980td/examples/01-stepped-shaft.CNC"
    exit 0
}
((EUID == 0)) || unpacked "this is not root"
command -v debootstrap >/dev/null || unpacked "debootstrap is not installed"
mirror=$(apt-get indextargets --format '$(REPO_URI) $(CODENAME)' | awk -v suite="$suite" '$2 == suite { print $1; exit }')
mirror=${MIRROR:-${mirror:-http://deb.debian.org/debian}}

echo "== a bare $suite"
debootstrap --variant=minbase "$suite" "$bare" "$mirror" >"$work/log" 2>&1 || {
    tail -5 "$work/log"
    unpacked "debootstrap gets no $suite from $mirror"
}
mount -t proc proc "$bare/proc"
cp /etc/resolv.conf "$bare/etc/resolv.conf"
cp "$package" "$bare/root/gsk980td.deb"
inside() {
    chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive LIBGL_ALWAYS_SOFTWARE=1 "$@"
}
# A bare system of containers leaves manuals out; here they are looked at.
rm -f "$bare"/etc/dpkg/dpkg.cfg.d/docker*
inside apt-get update -qq

echo "== installed with what it needs, and nothing else"
inside apt-get install -y -qq --no-install-recommends /root/gsk980td.deb >"$work/log" 2>&1 || {
    cat "$work/log"
    fail "the package is not installed"
}
inside gsk980td --version
inside gsk980td check /usr/share/doc/gsk980td/examples/01-stepped-shaft.CNC
inside gsk980td run /usr/share/doc/gsk980td/examples/01-stepped-shaft.CNC --json | grep -q '"end":"M30"' ||
    fail "the sample does not run to its M30"
code=0
inside gsk980td --data /root/memory >"$work/out" 2>&1 || code=$?
cat "$work/out"
((code == 2)) || fail "without libraries for a window it must end with exit code 2, not $code"
inside dpkg --verify gsk980td | grep . && fail "files are not those of md5sums"

echo "== installed with what it recommends"
inside apt-get install -y -qq --no-install-recommends man-db bash-completion zsh fish desktop-file-utils \
    shared-mime-info hicolor-icon-theme xvfb xauth xdotool >"$work/log" 2>&1 || {
    cat "$work/log"
    fail "tools of the check are not installed"
}
recommended=$(dpkg-deb -f "$package" Recommends | tr -d ',')
# Words, not one word.
# shellcheck disable=SC2086
inside apt-get install -y -qq --no-install-recommends $recommended >"$work/log" 2>&1 || {
    cat "$work/log"
    fail "what is recommended is not installed"
}

echo "== manual"
inside man -l /usr/share/man/man1/gsk980td.1.gz | head -20
for page in gsk980td gsk980td-check gsk980td-link-twin; do
    inside man --warnings "$page" >"$work/out" 2>"$work/warnings" || fail "no manual page $page"
    [[ ! -s "$work/warnings" ]] || { cat "$work/warnings"; fail "the page $page is not clean"; }
    grep -q SYNOPSIS "$work/out" || fail "the page $page says nothing"
done

echo "== completions"
found=$(inside bash -c '
    . /usr/share/bash-completion/bash_completion
    _completion_loader gsk980td || [ $? = 124 ]
    COMP_WORDS=(gsk980td ch) COMP_CWORD=1 COMP_LINE="gsk980td ch" COMP_POINT=11
    function=$(complete -p gsk980td | sed "s/.*-F \([^ ]*\).*/\1/")
    "$function" gsk980td ch gsk980td
    echo "${COMPREPLY[*]}"')
[[ $found == check ]] || fail "bash completes ch to: $found"
inside fish -c 'complete -C "gsk980td ch"' | grep -q '^check' || fail "fish does not know check"
inside zsh -c 'autoload -U compinit && compinit -u && [[ $_comps[gsk980td] == _gsk980td ]]' ||
    fail "zsh does not know the command"

echo "== desktop"
for entry in gsk980td gsk980td-open; do
    inside desktop-file-validate "/usr/share/applications/$entry.desktop"
done
grep -q '^text/x-gsk980td-program=gsk980td-open.desktop' "$bare/usr/share/applications/mimeinfo.cache" ||
    fail "no program opens part programs"
for pattern in '*.cnc' '*.nc' '*.tap'; do
    grep -qF "text/x-gsk980td-program:$pattern" "$bare/usr/share/mime/globs2" || fail "$pattern is not known"
done

echo "== window"
# Shown when its title is found; the program then ends by itself, told to.
inside xvfb-run -a -s "-screen 0 1280x1024x24" bash -c '
    gsk980td --data /root/memory --program /usr/share/doc/gsk980td/examples/01-stepped-shaft.CNC &
    for _ in $(seq 120); do
        if xdotool search --onlyvisible --class gsk980td >/dev/null 2>&1; then
            sleep 2
            kill -0 $! || exit 1
            kill $!
            wait $!
            exit 0
        fi
        sleep 0.5
    done
    kill $!
    exit 1' || fail "the window does not open"
echo "the window opened"

echo "== removed"
inside apt-get purge -y -qq gsk980td >"$work/log" 2>&1 || fail "the package is not removed"
left=$(find "$bare/usr" -name '*gsk980td*' -not -path '*/mime/*')
[[ -z $left ]] || fail "left behind: $left"
echo "all passed"
