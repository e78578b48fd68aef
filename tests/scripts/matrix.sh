#!/bin/sh
# One picture everywhere: the random frames of tests/test_random.c by every compiler, optimisation level and sanitizer
# at hand. processors.sh has the processors.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
. tests/scripts/lib/variants.sh
random='src/core/*.c tests/test_random.c'

for compiler in gcc clang; do
    if links $compiler; then
        for level in O0 O2 O3; do
            variant $compiler-$level "$compiler $flags -$level $random -o %"
        done
    else
        skip $compiler "not here"
    fi
done
if links clang -fsanitize=address,undefined; then
    variant clang-sanitized "clang $flags -O1 -fsanitize=address,undefined -fno-sanitize-recover=all $random -o %"
else
    skip clang-sanitized "no clang with its sanitizers here"
fi
run_variants
finish
