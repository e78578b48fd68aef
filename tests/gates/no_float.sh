#!/bin/sh
# Checks that the rendering code uses no floating point: no float type in the source, no soft-float call, and no float
# register on AArch64. GPU code and fitting are exempt.
cd "$(dirname "$0")/../.." || exit 1
objects=$(mktemp -d) || exit 1
trap 'rm -rf "$objects"' EXIT
missing=

fail() {
    echo "FAIL no_float: $1"
    exit 1
}

build() {
    name=$1 compiler=$2
    shift 2
    echo '#include <string.h>' | "$compiler" "$@" -E - >"$objects/log" 2>&1 || {
        missing="$missing $compiler"
        return 1
    }
    for source in src/core/*.c; do
        "$compiler" -std=c99 -O2 -Isrc/include -I. "$@" -c "$source" -o "$objects/${name}_$(basename "$source" .c).o" 2>"$objects/log" ||
            fail "$source does not build with $compiler $*: $(head -n 1 "$objects/log")"
    done
}

type='(float|double|long double|_Float[0-9]*|__fp16|float(16|32|64)(x[0-9]+)?(x[0-9]+)?_t)'
number='([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+[eE][-+]?[0-9]+)'
text=$({ MAKEFLAGS='' make -s core-headers; find src/core kernels \( -path kernels/cuda -o -path kernels/gles -o -path kernels/vulkan -o -path kernels/fit -o -path kernels/pack \) -prune -o -type f \
    \( -name '*.[ch]' -o -name '*.inc' \) -print; } | xargs awk -f tests/gates/strip_comments.awk |
    grep -v '^[^:]*:[0-9]*:[ \t]*#[ \t]*include' |
    grep -E "^[^:]*:[0-9]*:(.*[^A-Za-z0-9_.])?($type|$number)([^A-Za-z0-9_]|\$)" | cut -d: -f1,2 | tr '\n' ' ')
[ -z "$text" ] || fail "in $text"

# Name patterns of soft-float functions in ARM's ABI (such as __aeabi_fadd) and in libgcc (such as __addsf3).
soft_float='__aeabi_(f|d|h|cf|cd|i2|ui2|l2|ul2)[a-z0-9_]*|__[a-z]+[hsdt]f[a-z0-9]*|__(float|fix)[a-z]+'
hosted='malloc|calloc|realloc|free|[a-z]*printf|puts|abort|exit'
if build cortexm3 arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -ffreestanding; then
    bad=$(arm-none-eabi-nm -A -u "$objects"/cortexm3_*.o | awk '{ print $NF }' | grep -Ex "$soft_float|$hosted" |
        sort -u | tr '\n' ' ')
    [ -z "$bad" ] || fail "src calls $bad"
fi
build aarch64 aarch64-linux-gnu-gcc -mgeneral-regs-only

if [ -n "$missing" ]; then
    echo "skip no_float: not here:$missing"
    exit 77
fi
echo "ok   no_float"
