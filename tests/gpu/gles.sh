#!/bin/sh
# tests/gpu/gles.sh [FOLDER [SIZE]]: compares pictures of the OpenGL ES back end with the processor's, for each .fxs
# scene in FOLDER. Prints milliseconds:
#   frame         a whole frame, including upload and reading back
#   blend         blend and resolve, by the processor's clock
#   device        blend and resolve, by the GPU's timer; 0: no timer
cd "$(dirname "$0")/../.." || exit 1
folder=$1 size=${2:-1280x720} B=${B:-build}
fixsplat=$B/fixsplat
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
make -s B="$B" || exit 1
"$fixsplat" info --backends | grep -q '^gles  *here' || { "$fixsplat" info --backends; exit 1; }
if [ -z "$folder" ]; then
    folder=$work
    for scene in knot:200000 fog:20000 needles:50000 landscape:1000000; do
        "$fixsplat" make-scene ${scene%:*} --count ${scene#*:} -o "$work/scene.ply" &&
            "$fixsplat" convert "$work/scene.ply" "$work/${scene%:*}.fxs" >"$work/log" || exit 1
    done
fi

field() { sed -n "s/.*\"$1\": \([0-9.]*\).*/\1/p"; }

hash_of() {
    shown=$1 at=$2 backend=$3
    shift 3
    "$fixsplat" render "$shown" --size "$at" --backend "$backend" --hash "$@"
}

differing=0
ways=$("$fixsplat" info --backends | sed -n 's/^\(gles\|gles-fetch\)  *here.*/\1/p')
compare() {
    pictures=0 same=0
    for case in "$size --bg 336699" "$size --alpha" "$size --cutoff square" 1x1 15x17 1279x719 4096x64; do
        hash=$(hash_of "$1" ${case%% *} cpu ${case#"${case%% *}"} $view) || exit 1
        for backend in $ways; do
            pictures=$((pictures + 1))
            [ "$hash" = "$(hash_of "$1" ${case%% *} $backend ${case#"${case%% *}"} $view)" ] && same=$((same + 1))
        done
    done
    differing=$((differing + pictures - same))
}

measure() { "$fixsplat" bench "$1" --size "$size" --backend "$2" --json --frames 20 $view; }

"$fixsplat" info --backends | sed -n 's/^gles  *here: //p'
grep -m 1 'model name' /proc/cpuinfo
printf '%s, medians of 20 frames, milliseconds\n\n' "$size"
printf '| scene | Gaussians | cpu frame | cpu blend | gles frame | gles blend | gles device | same bytes |\n'
printf '|---|---|---|---|---|---|---|---|\n'
for scene in "$folder"/*.fxs; do
    view=
    [ ! -f "${scene%.fxs}.json" ] || view="--cameras ${scene%.fxs}.json --view 8"
    compare "$scene"
    cpu=$(measure "$scene" cpu) gles=$(measure "$scene" gles)
    printf '| %s | %s | %s | %s | %s | %s | %s | %s |\n' "$(basename "$scene" .fxs)" \
        "$(echo "$cpu" | field gaussians)" "$(echo "$cpu" | field frame_ms)" "$(echo "$cpu" | field blend)" \
        "$(echo "$gles" | field frame_ms)" "$(echo "$gles" | field blend)" "$(echo "$gles" | field device_ms)" \
        "$same of $pictures"
done
[ $differing = 0 ] || { echo "$differing pictures differ"; exit 1; }
