#!/bin/sh
# Checks that pixel.h compiles as three languages: C99, GLSL ES 3.00 and CUDA C (nvcc, if installed).
cd "$(dirname "$0")/../.." || exit 1
header=src/include/fixsplat/internal/pixel.h
use=tests/gates/pixel_use.inc
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
missing= note=

fail() {
    echo "FAIL pixel_header: $1"
    exit 1
}

have() {
    command -v "$1" >/dev/null 2>&1
}

put() {
    file=$work/$1 fn=$2
    shift 2
    {
        printf '%s\n' "$@" "#define FXS_FN $fn"
        cat "$header" "$use"
    } >"$file"
}

try() {
    name=$1
    shift
    "$@" >"$work/log" 2>&1 || fail "not $name: $(grep -i -m 1 error "$work/log")"
}

lines=$(wc -l <"$header")
[ "$lines" -le 120 ] || fail "$lines lines: at most 120"
for function in $(sed -n 's/^FXS_FN int \([a-z0-9_]*\)(.*/\1/p' "$header"); do
    grep -q "$function(" "$use" || fail "$use does not use $function"
done

put pixel.c 'static inline' ''
echo 'int pixel(int u, int v); int pixel(int u, int v) { return use_all(u, v); }' >>"$work/pixel.c"
for compiler in gcc clang; do
    if have "$compiler"; then
        try "C99 to $compiler" "$compiler" -std=c99 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror \
            -c "$work/pixel.c" -o "$work/pixel.o"
    else
        missing="$missing $compiler"
    fi
done

put pixel.frag '' '#version 300 es' 'precision highp int;' 'flat in ivec2 place;' 'out ivec4 result;'
echo 'void main() { result = ivec4(use_all(place.x, place.y)); }' >>"$work/pixel.frag"
if have glslangValidator; then
    try "GLSL ES 3.00" glslangValidator "$work/pixel.frag"
else
    missing="$missing glslangValidator"
fi

put pixel.cu '__host__ __device__ static inline' ''
echo '__global__ void pixel(int *p) { p[threadIdx.x] = use_all(p[threadIdx.x], p[0]); }' >>"$work/pixel.cu"
nvcc=$(command -v nvcc || ls /usr/local/cuda/bin/nvcc 2>/dev/null)
if [ -n "$nvcc" ]; then
    try "CUDA C" "$nvcc" -arch=sm_90 -c "$work/pixel.cu" -o "$work/pixel.o"
else
    note=" (CUDA skipped: no nvcc)"
fi

if [ -n "$missing" ]; then
    echo "skip pixel_header: not here:$missing$note"
    exit 77
fi
echo "ok   pixel_header$note"
