#!/bin/sh
# Builds and tests the CUDA back end on a machine with a GPU, then prints one table of times.
#   sh tests/gpu/cuda.sh [FILE.fxs | FILE.fxs:CAMERAS.json:N,N,...]...
# Procedural scenes of 1 and 10 million Gaussians are made in a temporary folder. B: the build folder (default build);
# with PREBUILT=1 nothing is built.
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=

[ "$PREBUILT" = 1 ] || make -j8 B="$B" all cuda-tests >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

for scene in knot:1 knot:10 landscape:1 landscape:10; do
    name=${scene%:*} millions=${scene#*:}
    { "$B/fixsplat" make-scene "$name" --count "${millions}000000" -o "$work/$name$millions.ply" &&
        "$B/fixsplat" convert "$work/$name$millions.ply" "$work/$name-${millions}M.fxs" >/dev/null || echo "no $scene"
      rm -f "$work/$name$millions.ply"; } &
done
wait

for view in "$@"; do
    files="$files ${view%%:*}"
done
echo "== stages and pixels against the C stages"
"$B/tests/gpu/test_cuda" $files "$work/knot-1M.fxs" "$work/landscape-1M.fxs" || failed="$failed test_cuda"

for tool in memcheck racecheck; do
    echo "== compute-sanitizer $tool"
    if command -v compute-sanitizer >/dev/null 2>&1; then
        compute-sanitizer --error-exitcode 1 --tool $tool "$B/tests/gpu/test_cuda" --quick || failed="$failed $tool"
    else
        echo "skipped: no compute-sanitizer"
    fi
done

echo "== the command"
for cutoff in mahalanobis square; do
    cpu=$("$B/fixsplat" render "$work/knot-1M.fxs" --cutoff $cutoff --hash)
    cuda=$("$B/fixsplat" render "$work/knot-1M.fxs" --cutoff $cutoff --hash --backend cuda)
    echo "$cutoff: cpu $cpu, cuda $cuda"
    [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || failed="$failed command"
done
"$B/fixsplat" render "$work/knot-1M.fxs" --hash --backend cuda --max-memory 64M 2>&1 | grep "bytes needed" ||
    failed="$failed max-memory"

echo "== times"
"$B/tests/gpu/bench_cuda" "$@" "$work/knot-1M.fxs" "$work/knot-10M.fxs" "$work/landscape-1M.fxs" \
    "$work/landscape-10M.fxs"
[ -z "$failed" ] || { echo "FAIL cuda:$failed"; exit 1; }
echo "ok   cuda"
