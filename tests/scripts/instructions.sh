#!/bin/sh
# Counts the instructions of rendering stages with NEON and in plain C, with a qemu plugin. Blending with NEON must take
# at most a sixth.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
arm=aarch64-linux-gnu-gcc
if ! have $arm || ! have qemu-aarch64; then
    skip instructions "no $arm or no qemu-aarch64 here"
    finish
    exit
fi
for source in src/core/*.c kernels/*.c kernels/simd/arm/*.c tests/test_kernels.c; do
    echo "$arm -std=gnu99 -Isrc/include -I. -fwrapv -O2 -DFXS_WITH_KERNELS -c $source -o $work/$(basename "$source" .c).o"
done | xargs -P 2 -I COMMAND sh -c COMMAND
check "builds" $arm -static -Wl,-Map="$work/map" "$work"/*.o -lm -o "$work/kernels"
check "the plugin builds" "${CC:-cc}" -O2 -shared -fPIC tests/count_instructions.c -o "$work/count.so"

# Prints the address range of the code of each version of a stage: "blend_c=START-END", "blend_neon=START-END", ...
ranges=$(sed -n 's/^ \.text  *0x0*\([0-9a-f]*\)  *0x\([0-9a-f]*\) .*\/\([a-z_]*\)\.o$/\1 \2 \3/p' "$work/map" |
    while read -r start size name; do
        case $name in
        project | shade | blend | resolve) name=${name}_c ;;
        *_neon) ;;
        *) continue ;;
        esac
        printf ',%s=%s-%x' "$name" "$start" $((0x$start + 0x$size))
    done)
qemu-aarch64 -plugin "file=$work/count.so$ranges" -d plugin "$work/kernels" --bench >"$work/bench" 2>"$work/counts"

count() { awk -v name="$1" '$1 == name { print $2 }' "$work/counts"; }
ratio() { echo "$(count "$1_c") $(count "$1_neon")" | awk '$2 > 0 { printf "%.2f\n", $1 / $2 }'; }
for stage in project shade blend resolve; do
    echo "$stage: plain C takes $(ratio $stage) times the instructions of NEON"
done
at_least() { awk "BEGIN { exit !($1 >= $2) }" || { echo "$1 times, not $2"; return 1; }; }
check "blend takes at most a sixth" at_least "$(ratio blend)" 6
check "project and shade take fewer" at_least "$(ratio project)" 1.5
finish
