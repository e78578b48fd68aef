#!/bin/sh
# Renders with --backend vulkan and the layers of failing_layer.c and of validation, where one call of Vulkan fails, or
# all calls from one on. The command must draw the right picture, or print one line, exit with status 1 and leave no
# file. Tests 12 calls for each error, 24 with FXS_PROCESSORS=all, all with EVERY=1.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/failing_calls.sh"

[ "$FXS_PROCESSORS" = all ] && spread=24 || spread=12
export VK_INSTANCE_LAYERS=VK_LAYER_FIXSPLAT_failing:VK_LAYER_KHRONOS_validation
"$fixsplat" make-scene knot --count 300 -o knot.ply || exit 1
"$fixsplat" render knot.ply --size 64x48 -o right.png || exit 1
reason=$("$fixsplat" info --backends | sed -n "s/^vulkan  *not here: //p")
if [ "$reason" ]; then
    skip "calls of Vulkan that fail" "$reason"
    finish
    exit
fi

attempt() {
    rm -f o.png
    run render knot.ply --size 64x48 --backend vulkan -o o.png
}

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

FXS_FAIL_LOG=logs/calls attempt
check "without a failure" equal "$status $(wrong)" "0 "
count=$(cat logs/calls)
check "the layer counts calls" [ "${count:-0}" -gt 50 ]
fail_calls 0 "${EVERY:-$((count / spread + 1))}" -1 -2 -4 '-4 and on'
attempt
check "after the failures" equal "$status $(wrong)" "0 "
finish
