#!/bin/sh
# Truncates or overwrites a memory-mapped .fxs file while `fixsplat bench` renders it. The command must end with one
# line and exit status 1.
. tests/scripts/lib/check.sh
fixsplat=${B:-build}/fixsplat
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$fixsplat" make-scene knot --count 60000 -o "$work/knot.ply" || exit 1
if ! "$fixsplat" convert "$work/knot.ply" "$work/whole.fxs" 2>"$work/err"; then
    skip "a changed .fxs" "$(cat "$work/err")"
    finish
    exit
fi

ends() {
    name=$1 words=$2 change=$3 fxs=$work/scene.fxs
    shift 3
    cp "$work/whole.fxs" "$fxs"
    "$fixsplat" bench "$fxs" --size 200x120 --frames 10000 "$@" >"$work/out" 2>"$work/err" &
    process=$!
    until grep -q scene.fxs /proc/$process/maps 2>/dev/null || ! kill -0 $process 2>/dev/null; do
        sleep 0.1
    done
    sleep 0.3
    eval "$change"
    wait $process
    status=$?
    if [ $status = 1 ] && [ ! -s "$work/out" ] && [ "$(wc -l <"$work/err")" = 1 ] &&
        grep -Eq "^fixsplat: .*($words)" "$work/err"; then
        ok "$name"
    else
        fail "$name" "status $status: $(head -n 3 "$work/err")"
    fi
}

short='truncate -s 200000 "$fxs"'
noise='dd if=/dev/urandom of="$fxs" bs=65536 seek=3 count=40 conv=notrunc 2>/dev/null'
for threads in 1 2; do
    ends "cut short, threads $threads" "cut short while it was read|changed while|damaged" "$short" --threads $threads
    ends "cut short in bands, threads $threads" "cut short while it was read|changed while|damaged" "$short" \
        --threads $threads --max-memory 3M
    ends "written to, threads $threads" "written to while it was read|changed while|damaged" "$noise" --threads $threads
    ends "written to in bands, threads $threads" "written to while it was read|changed while|damaged" "$noise" \
        --threads $threads --max-memory 3M
done
"$fixsplat" bench "$work/whole.fxs" --size 200x120 --frames 10000 >"$work/out" 2>"$work/err" &
process=$!
sleep 0.5
kill -BUS $process
wait $process 2>/dev/null
status=$?
if [ $status = 135 ]; then ok "a SIGBUS from outside"; else fail "a SIGBUS from outside" "status $status"; fi
finish
