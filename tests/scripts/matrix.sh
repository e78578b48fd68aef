#!/bin/sh
# Checks that the random frames of tests/test_random.c are equal with each compiler and under sanitizers.
# FXS_PROCESSORS=all adds every optimisation level.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
. tests/scripts/lib/variants.sh
random='src/core/*.c tests/test_random.c'

few='gcc-O3 clang-O2' every='gcc-O0 gcc-O2 gcc-O3 clang-O0 clang-O2 clang-O3'
for name in $([ "$FXS_PROCESSORS" = all ] && echo "$every" || echo "$few"); do
    if links ${name%-*}; then
        variant $name "${name%-*} $flags -${name#*-} $random -o %"
    else
        skip $name "not here"
    fi
done
if links clang -fsanitize=address,undefined; then
    variant clang-sanitized "clang $flags -O1 -fsanitize=address,undefined -fno-sanitize-recover=all $random -o %"
else
    skip clang-sanitized "no clang with its sanitizers here"
fi
run_variants
finish
