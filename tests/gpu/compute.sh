#!/bin/sh
# Tests and times the compute shaders on a machine with a GPU, and times CUDA for comparison.
#   sh tests/gpu/compute.sh [FILE.fxs | FILE.fxs:CAMERAS.json:N,N,...]...
# SIZES: sizes of the procedural scene in millions of Gaussians (default 1). B: build folder. PREBUILT=1: skips the
# build.
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
SIZES=${SIZES:-1}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=

[ "$PREBUILT" = 1 ] ||
    make -s B="$B" all "$B/tests/test_compute" "$B/tests/test_gles" "$B/tests/gpu/bench_cuda" \
        "$B/tests/gpu/bench_compute" || exit 1
"$B/fixsplat" info --backends | grep '^gles-compute  *here' || { "$B/fixsplat" info --backends; exit 1; }
for test in compute gles; do
    "$B/tests/test_$test" || failed="$failed test_$test"
done

hash_of() { "$B/fixsplat" render "$work/scene.fxs" --hash --quiet "$@"; }

same() {
    what=$1
    shift
    [ "$(hash_of --backend gles-compute "$@")" = "$(hash_of "$@")" ] ||
        { echo "FAIL $what $*"; failed="$failed $what"; }
}

for name in knot:200000 fog:20000 needles:50000 haze:60000 meadow:120000 landscape:1000000; do
    "$B/fixsplat" make-scene "${name%:*}" --count "${name#*:}" -o "$work/scene.ply" --quiet || exit 1
    for profile in default compact small; do
        "$B/fixsplat" convert "$work/scene.ply" "$work/scene.fxs" --profile $profile --quiet || exit 1
        for size in 1920x1080 640x360 15x17; do
            same "${name%:*} $profile" --size $size
        done
        same "${name%:*} $profile" --size 1279x719 --alpha
        same "${name%:*} $profile" --size 640x360 --cutoff square
        rm "$work/scene.fxs"
    done
done
echo "pictures compared"

for millions in $SIZES; do
    "$B/fixsplat" make-scene landscape --count "${millions}000000" -o "$work/l.ply" --quiet &&
        "$B/fixsplat" convert "$work/l.ply" "$work/landscape-${millions}M.fxs" --quiet || exit 1
    set -- "$@" "$work/landscape-${millions}M.fxs"
done
for round in 1 2; do
    "$B/tests/gpu/bench_cuda" "$@" | grep -e '^| scene' -e '1080 |'
    "$B/tests/gpu/bench_compute" "$@"
done
for name in landscape knot; do
    "$B/fixsplat" make-scene $name --count 1000000 -o "$work/l.ply" --quiet &&
        "$B/fixsplat" convert "$work/l.ply" "$work/$name-small.fxs" --profile small --quiet || exit 1
done
"$B/tests/gpu/bench_compute" 1280x720 "$work/landscape-small.fxs" "$work/knot-small.fxs" \
    2064x2208 "$work/landscape-small.fxs" "$work/knot-small.fxs"
[ -z "$failed" ] || { echo "failed:$failed"; exit 1; }
