#!/bin/sh
# Lines of C, CUDA and shader sources have at most 120 columns, except tables of bytes in tests.
cd "$(dirname "$0")/../.." || exit 1
long=$(find src kernels port tools tests docs -type f \( -name '*.[ch]' -o -name '*.cu' -o -name '*.cuh' -o -name '*.wgsl' \) \
    ! -name '*_bytes.h' ! -path '*/shaders.h' -print0 | xargs -0 awk 'length > 120 { printf "%s:%d ", FILENAME, FNR }')
[ -z "$long" ] && echo "ok   columns" || { echo "FAIL columns: $long"; exit 1; }
