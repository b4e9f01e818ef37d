#!/usr/bin/env bash
# Makes the icons of the program from assets/icon/gsk980td.svg: pictures for Linux and
# the window, a set of sizes for Windows. Needs rsvg-convert and ImageMagick.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source=assets/icon/gsk980td.svg
for size in 16 24 32 48 64 128 256; do
    rsvg-convert -w "$size" -h "$size" "$source" -o "$work/$size.png"
done
cp "$work/256.png" assets/icon/gsk980td.png
for size in 16 24 32 48 64 128; do
    cp "$work/$size.png" "assets/icon/gsk980td-$size.png"
done
convert "$work"/{16,24,32,48,64,256}.png app/windows/gsk980td.ico
