#!/bin/sh
# Tests and times the CUDA back end on a machine with a GPU.
#   sh tests/gpu/cuda.sh [FILE.fxs | FILE.fxs:CAMERAS.json:N,N,...]...
# SIZES: sizes of the procedural scenes in millions of Gaussians (default "1 4"). B: build folder. PREBUILT=1: skips the
# build.
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
SIZES=${SIZES:-1 4}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=
start=$(date +%s)

say() {
    echo "== $* ($(($(date +%s) - start)) s)"
}

scene() {
    { "$B/fixsplat" make-scene "$1" --count "$2" -o "$work/$3.ply" &&
        "$B/fixsplat" convert "$work/$3.ply" "$work/$3.fxs" >/dev/null || echo "no $3"
      rm -f "$work/$3.ply"; } &
}

[ "$PREBUILT" = 1 ] || make -j8 B="$B" all cuda-tests "$B/tests/test_golden" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

say "scenes"
scene knot 10000 knot-10k
for millions in $SIZES; do
    for name in knot landscape; do
        scene $name "${millions}000000" "$name-${millions}M"
        made="$made $work/$name-${millions}M.fxs"
    done
done
wait

for view in "$@"; do
    files="$files ${view%%:*}"
done
say "stages and targets against the processor"
"$B/tests/gpu/test_cuda" $files "$work/knot-1M.fxs" "$work/landscape-1M.fxs" || failed="$failed test_cuda"

say "golden images"
"$B/tests/test_golden" --cuda | tail -1 | grep " 0 failed, 0 skipped" || failed="$failed test_golden"

for tool in memcheck racecheck; do
    say "compute-sanitizer $tool"
    if command -v compute-sanitizer >/dev/null 2>&1; then
        compute-sanitizer --error-exitcode 1 --tool $tool "$B/tests/gpu/test_cuda" --quick || failed="$failed $tool"
    else
        echo "skipped: no compute-sanitizer"
    fi
done

say "hashes at 1920x1080, processor and CUDA"
for file in $(printf '%s\n' $files | sort -u) $made; do
    for cutoff in mahalanobis square; do
        options="--size 1920x1080 --cutoff $cutoff --hash"
        cpu=$("$B/fixsplat" render "$file" $options) cuda=$("$B/fixsplat" render "$file" $options --backend cuda)
        echo "$(basename "$file") $cutoff: $cpu $cuda"
        [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || failed="$failed hash"
    done
done

say "levels of detail: hashes by budget, processor and CUDA"
"$B/fixsplat" convert --levels --quiet "$work/knot-1M.fxs" "$work/tree.fxs" || failed="$failed levels"
for options in "--budget 1" "--budget 30000" "--budget 400000" "--detail 3" "--budget 99999 --cutoff square" \
               "--budget 1000000" "--budget 50000 $work/knot-10k.fxs" "--budget 400000 --max-memory 100M" \
               "--budget 100000 --pool 32M" "--budget 100000 --pool 32M --stereo 0.063"; do
    options="$options --size 1280x720 --hash"
    cpu=$("$B/fixsplat" render "$work/tree.fxs" $options) cuda=$("$B/fixsplat" render "$work/tree.fxs" $options --backend cuda)
    echo "$options: $cpu $cuda"
    [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || failed="$failed levels"
done

say "two eyes: hashes, processor and CUDA, and what a frame takes"
for options in "--stereo 0.063" "--stereo 0.063 --tangents -1.38,1.19,1.0,-1.2" "--stereo 0.063 --budget 30000" \
               "--stereo 0.063 --cutoff square" "--stereo 0.063 $work/knot-10k.fxs"; do
    options="$options --size 960x1024 --hash"
    cpu=$("$B/fixsplat" render "$work/tree.fxs" $options)
    for limit in "" "--max-memory 240M"; do    # within 240 MB, only part of the scene is on the device
        cuda=$("$B/fixsplat" render "$work/tree.fxs" $options --backend cuda $limit 2>&1)
        echo "$options $limit: $cpu $cuda"
        [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || failed="$failed eyes"
    done
done
for options in "" "--stereo 0.063"; do
    "$B/fixsplat" bench "$work/knot-1M.fxs" --size 2064x2208 $options --backend cuda || failed="$failed bench"
done

say "every view of a camera file, on every device"
for view in "$@"; do
    case $view in *:*)
        file=${view%%:*} cameras=${view#*:} cameras=${cameras%:*}
        options="--cameras $cameras --view all --size 960x540 --hash"
        for devices in 0 all; do
            "$B/fixsplat" render "$file" $options --backend cuda --device $devices >"$work/views-$devices" 2>"$work/log"
        done
        "$B/fixsplat" render "$file" $options >"$work/views-cpu" 2>"$work/log"
        wc -l <"$work/views-cpu"
        [ -s "$work/views-cpu" ] && cmp "$work/views-cpu" "$work/views-0" && cmp "$work/views-cpu" "$work/views-all" || failed="$failed views" ;;
    esac
done

say "out of memory"
"$B/fixsplat" render "$work/knot-1M.fxs" --hash --backend cuda --max-memory 32M 2>&1 | grep "needs at least" ||
    failed="$failed max-memory"

say "times"
"$B/tests/gpu/bench_cuda" "$@" $made "$work/knot-10k.fxs@100" "$work/tree.fxs%400000" || failed="$failed bench_cuda"
say "done"
[ -z "$failed" ] || { echo "FAIL cuda:$failed"; exit 1; }
echo "ok   cuda"
