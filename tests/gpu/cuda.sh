#!/bin/sh
# Builds and tests the CUDA back end on a machine with a GPU, then prints one table of times.
#   sh tests/gpu/cuda.sh [FILE.fxs | FILE.fxs:CAMERAS.json:N,N,...]...
# Procedural scenes of 1, 4 and 10 million Gaussians are made in a temporary folder. B: the build folder (default build);
# with PREBUILT=1 nothing is built.
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=

[ "$PREBUILT" = 1 ] || make -j8 B="$B" all cuda-tests "$B/tests/test_golden" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

for scene in knot:1 knot:4 knot:10 landscape:1 landscape:4 landscape:10; do
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

echo "== golden images"
"$B/tests/test_golden" --cuda | tail -1 | grep " 0 failed, 0 skipped" || failed="$failed test_golden"

for tool in memcheck racecheck; do
    echo "== compute-sanitizer $tool"
    if command -v compute-sanitizer >/dev/null 2>&1; then
        compute-sanitizer --error-exitcode 1 --tool $tool "$B/tests/gpu/test_cuda" --quick || failed="$failed $tool"
    else
        echo "skipped: no compute-sanitizer"
    fi
done

echo "== hashes at 1920x1080, processor and CUDA"
for scene in $(printf '%s\n' $files | sort -u) "$work"/*.fxs; do
    for cutoff in mahalanobis square; do
        options="--size 1920x1080 --cutoff $cutoff --hash"
        cpu=$("$B/fixsplat" render "$scene" $options) cuda=$("$B/fixsplat" render "$scene" $options --backend cuda)
        echo "$(basename "$scene") $cutoff: $cpu $cuda"
        [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || failed="$failed hash"
    done
done

echo "== every view of a camera file, on every device"
for view in "$@"; do
    case $view in *:*)
        scene=${view%%:*} cameras=${view#*:} cameras=${cameras%:*}
        options="--cameras $cameras --view all --size 960x540 --hash"
        for devices in 0 all; do
            "$B/fixsplat" render "$scene" $options --backend cuda --device $devices >"$work/views-$devices" 2>"$work/log"
        done
        "$B/fixsplat" render "$scene" $options >"$work/views-cpu" 2>"$work/log"
        wc -l <"$work/views-cpu"
        [ -s "$work/views-cpu" ] && cmp "$work/views-cpu" "$work/views-0" && cmp "$work/views-cpu" "$work/views-all" || failed="$failed views" ;;
    esac
done

echo "== out of memory"
"$B/fixsplat" render "$work/knot-1M.fxs" --hash --backend cuda --max-memory 64M 2>&1 | grep "bytes needed" ||
    failed="$failed max-memory"

echo "== times"
"$B/tests/gpu/bench_cuda" "$@" "$work/knot-1M.fxs" "$work/knot-4M.fxs" "$work/knot-10M.fxs" \
    "$work/landscape-1M.fxs" "$work/landscape-4M.fxs" "$work/landscape-10M.fxs"
[ -z "$failed" ] || { echo "FAIL cuda:$failed"; exit 1; }
echo "ok   cuda"
