#!/bin/sh
# Compares and times scenes that move on a GPU: tests/gpu/moving.sh PROGRAM MOVING.fxs... Prints for each scene and back
# end the hash of the hashes of 40 frames, each of another camera at another time; with BUDGET=N, of frames with that
# budget. With STILL=FILE: also times of that still scene and of the last moving one, two eyes of 2064x2208: milliseconds
# of a frame, least and median, and of the device alone.
program=$1
shift
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
awk 'BEGIN { srand(60); for (i = 0; i < 40; i++) print 8 * rand() - 4, 3 * rand() - 2, 8 * rand() - 4, rand() - 0.5, \
    0.4 * rand(), rand() - 0.5, 0, -1, 0, 40 + 20 * rand(), i }' >"$work/path.txt"

frames() { "$program" render "$@" --path "$work/path.txt" --frames 40 --size 400x300 --hash; }
of_all() { md5sum | cut -c 1-16; }

for scene in "$@"; do
    seconds=$("$program" info "$scene" --json | sed -n 's/.*"duration": \([0-9.]*\).*/\1/p')
    fps=$(awk -v s="$seconds" 'BEGIN { print 40000 "/" int(1000 * s) }')
    for backend in ${BACKENDS:-cpu cuda vulkan gles-compute gles}; do
        hash=$(frames "$scene" --backend "$backend" --times "0..$seconds" --fps "$fps" ${BUDGET:+--budget "$BUDGET"} \
            2>"$work/why" | of_all)
        echo "$(basename "$scene") $backend $hash $(head -n 1 "$work/why")"
    done
done
[ -n "$STILL" ] || exit 0
eyes="--stereo 0.063 --tangents -1.38,1.19,1.0,-1.2 --size 2064x2208 --eye 0,-0.5,-3.5 --look 0,0,0 --frames 60"
for backend in ${BACKENDS:-cuda vulkan gles-compute}; do
    for turn in 1 2 3; do
        for file in "$STILL" "$scene"; do
            [ "$file" = "$STILL" ] && time= || time="--time 0.5"
            echo "$backend $(basename "$file") $("$program" bench "$file" $time $eyes --backend "$backend" 2>&1 |
                awk '$1 == "frame" || $1 == "device" { printf "%s %s %s ", $1, $2, $3 }')"
        done
    done
done
