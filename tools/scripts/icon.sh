#!/bin/sh
# icon.sh PICTURE.svg ICON.ico: makes a Windows icon with a .png for each size.
svg=${1:?picture} ico=${2:?icon}
sizes='16 24 32 48 64 256'
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

bytes() {
    number=$2
    for i in $(seq "$1"); do
        printf "\\$(printf %03o $((number & 255)))"
        number=$((number >> 8))
    done
}

# Prints the directory of an icon file. An entry has width, height (0: 256), colours, planes, bits per pixel, and length
# and offset of the picture.
rows() {
    at=$((6 + 16 * $#))
    for size; do
        length=$(wc -c <"$work/$size.png")
        bytes 1 "$size" && bytes 1 "$size" && bytes 2 0 && bytes 2 1 && bytes 2 32 && bytes 4 "$length" && bytes 4 $at
        at=$((at + length))
    done
}

count=0
for size in $sizes; do
    rsvg-convert -w "$size" -h "$size" -o "$work/$size.png" "$svg" || exit
    count=$((count + 1))
done
{ bytes 2 0 && bytes 2 1 && bytes 2 $count && rows $sizes && (cd "$work" && cat $(printf '%s.png ' $sizes)); } >"$ico"
