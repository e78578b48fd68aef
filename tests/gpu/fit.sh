#!/bin/sh
# Tests `fixsplat fit` on a machine with GPUs: fitted scenes must have the same bytes as on the processor. Prints times,
# memory and quality.
#   sh tests/gpu/fit.sh PHOTOS...
# PHOTOS: folders of photographs. B: build folder. PREBUILT=1: skips the build. STEPS: steps of the long fits (default
# 30000).
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
STEPS=${STEPS:-30000}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=
start=$(date +%s)

say() {
    echo "== $* ($(($(date +%s) - start)) s)"
}

fit() {
    photos=$1 out=$2
    shift 2
    case $photos in *lego*) set -- "$@" --background ffffff ;; esac
    "$B/fixsplat" fit "$photos" -o "$work/$out" "$@" 2>"$work/$out.log" && return
    cat "$work/$out.log"
    failed="$failed $out"
}

same() {
    if cmp "$work/$1" "$work/$2"; then
        sha256sum <"$work/$1" | cut -c1-16
    else
        failed="$failed $1"
    fi
}

[ "$PREBUILT" = 1 ] || make -j8 B="$B" all cuda-tests >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

say "every buffer of a step against the processor"
"$B/tests/gpu/test_fit" || failed="$failed test_fit"

say "whole fits by each recipe and profile"
for gpu in cuda vulkan; do
    "$B/tests/test_fit_steps" --$gpu || failed="$failed test_fit_steps-$gpu"
done

say "compute-sanitizer"
for tool in memcheck racecheck; do
    if command -v compute-sanitizer >/dev/null 2>&1; then
        compute-sanitizer --error-exitcode 1 --tool $tool "$B/tests/gpu/test_fit" --quick || failed="$failed $tool"
    else
        echo "skipped: no compute-sanitizer"
    fi
done

for photos in "$@"; do
    name=$(basename "$photos")
    say "$name at a quarter of its size, 200 steps: processor and CUDA"
    fit "$photos" "$name-cpu.ply" --resolution 300 --steps 200 >/dev/null
    fit "$photos" "$name-cuda.ply" --resolution 300 --steps 200 --backend cuda >/dev/null
    same "$name-cpu.ply" "$name-cuda.ply"
    say "the same antialiased, packed"
    fit "$photos" "$name-cpu.fxs" --resolution 300 --steps 200 --antialiased >/dev/null
    fit "$photos" "$name-cuda.fxs" --resolution 300 --steps 200 --antialiased --backend cuda >/dev/null
    same "$name-cpu.fxs" "$name-cuda.fxs"
    say "the same for surfaces, 700 steps, packed"
    fit "$photos" "$name-cpu.fxs" --resolution 300 --steps 700 --surfaces >/dev/null
    fit "$photos" "$name-cuda.fxs" --resolution 300 --steps 700 --surfaces --backend cuda >/dev/null
    same "$name-cpu.fxs" "$name-cuda.fxs"
    for how in gain affine; do
        options="--resolution 300 --steps 700 --exposure $how --refine-poses"
        say "the same with exposures, $how, and poses, 700 steps"
        fit "$photos" "$name-cpu.ply" $options >/dev/null
        fit "$photos" "$name-cuda.ply" $options --backend cuda >/dev/null
        same "$name-cpu.ply" "$name-cuda.ply"
    done
done

if [ "$("$B/fixsplat" info --backends 2>/dev/null | grep -c 'device [1-9]')" -gt 0 ]; then
    say "two devices, and a batch of two on one"
    for option in "" --refine-poses --surfaces; do
        fit "$1" two.ply --resolution 600 --steps 700 --backend cuda --device 0,1 $option
        fit "$1" one.ply --resolution 600 --steps 700 --backend cuda --batch 2 $option
        same two.ply one.ply
    done
else
    echo "skipped: two devices"
fi

for photos in "$@"; do
    name=$(basename "$photos")
    say "$name, reference, $STEPS steps, twice"
    fit "$photos" "$name-1.fxs" --steps "$STEPS" --backend cuda | tail -12
    fit "$photos" "$name-2.fxs" --steps "$STEPS" --backend cuda | tail -1
    same "$name-1.fxs" "$name-2.fxs"
done

if [ -n "$failed" ]; then
    echo "failed:$failed"
    exit 1
fi
echo "all as it should be"
