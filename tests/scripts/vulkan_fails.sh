#!/bin/sh
# Renders with --backend vulkan and the layers of failing_layer.c and of validation, where one call of Vulkan fails, or
# all calls from one on. The command must draw the right picture, or print one line, exit with status 1 and leave no
# file. Tests 12 calls for each error, 24 with FXS_PROCESSORS=all, all with EVERY=1.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

[ "$FXS_PROCESSORS" = all ] && spread=24 || spread=12
export VK_LAYER_PATH="${fixsplat%/*}/tests/layer:/usr/share/vulkan/explicit_layer.d"
export VK_INSTANCE_LAYERS=VK_LAYER_FIXSPLAT_failing:VK_LAYER_KHRONOS_validation
"$fixsplat" make-scene knot --count 300 -o knot.ply || exit 1
"$fixsplat" render knot.ply --size 64x48 -o right.png || exit 1
reason=$("$fixsplat" info --backends | sed -n "s/^vulkan  *not here: //p")
if [ "$reason" ]; then
    skip "calls of Vulkan that fail" "$reason"
    finish
    exit
fi

draw() { run render knot.ply --size 64x48 --backend vulkan -o o.png; }

# wrong: prints what the command did wrong; nothing if all was right.
wrong() {
    case $status in
    0) cmp o.png right.png; cat logs/err ;;
    1) [ "$(wc -l <logs/err)" = 1 ] && grep -q '^fixsplat: ' logs/err || cat logs/err
        ls o.png 2>/dev/null ;;
    *) echo "status $status: $(cat logs/err)" ;;
    esac
    ls .fixsplat-* 2>/dev/null
}

FXS_FAIL_LOG=logs/calls draw
check "without a failure" equal "$status $(wrong)" "0 "
count=$(cat logs/calls)
check "the layer counts calls" [ "${count:-0}" -gt 50 ]
step=${EVERY:-$((count / spread + 1))}
for result in -1 -2 -4 '-4 and on'; do
    n=0 failures=0 faults=
    export FXS_FAIL_WITH=${result% and on}
    [ "$FXS_FAIL_WITH" = "$result" ] || export FXS_FAIL_EVER=1
    while [ $n -lt "$count" ]; do
        rm -f o.png
        FXS_FAIL_AT=$n draw
        failures=$((failures + status))
        why=$(wrong 2>&1)
        faults=$faults${why:+call $n: $why }
        n=$((n + step))
    done
    check "result $result" equal "$faults" ''
    check "result $result is an error" [ $failures -ge $((count / step / 2)) ]
done
unset FXS_FAIL_WITH FXS_FAIL_EVER
draw
check "after the failures" equal "$status $(wrong)" "0 "
finish
