#!/bin/sh
# Checks stack usage on a Cortex-M3, compiled with FXS_SMALL_STACK. Each function of src may use at most 1.5 KB of
# stack. Functions that are not needed to render colour pictures are exempt.
cd "$(dirname "$0")/../.." || exit 1
objects=$(mktemp -d) || exit 1
trap 'rm -rf "$objects"' EXIT
most=1536
larger='fxs_trace_tile|pick_tile|weigh_tile|count_tile|fxs_count_pairs|fxs_draw_tile|draw_samples|fxs_rate_resolve'

if ! command -v arm-none-eabi-gcc >/dev/null 2>&1; then
    echo "skip stack: not here: arm-none-eabi-gcc"
    exit 77
fi
for level in -Os -O2; do
    for source in src/core/*.c port/board/*.c; do
        arm-none-eabi-gcc -std=c99 -Isrc/include -I. $level -mcpu=cortex-m3 -mthumb -ffreestanding -DFXS_SMALL_STACK -fstack-usage \
            -c "$source" -o "$objects/$(basename "$source" .c)$level.o" || { echo "FAIL stack: $source"; exit 1; }
    done
done
faults=$(cat "$objects"/*.su | awk -F '\t' -v most=$most -v larger="^($larger)([.]|\$)" '
    { split($1, at, ":"); name = at[4] }
    $3 !~ /static/ || ($2 > most && name !~ larger) { print name, $2, $3 }' | sort -u | tr '\n' ';')
[ -z "$faults" ] || { echo "FAIL stack: $faults"; exit 1; }
echo "ok   stack"
