#!/bin/sh
# One picture everywhere: the random frames of tests/test_random.c by every compiler, optimisation level, sanitizer and
# processor at hand; the golden images and the kernels under AArch64.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

flags='-std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off -g0'
arm=aarch64-linux-gnu-gcc
random='src/*.c tests/test_random.c'
golden="src/*.c tests/test_golden.c tools/backend.c tools/metrics.c tools/procedural.c port/formats/*.c"

links() { echo 'int main(void) { return 0; }' | "$@" -x c - -o "$work/links" >/dev/null 2>&1; }

# variant NAME COMMAND: one more program to build, as $work/NAME; %: that name.
variants=
variant() {
    echo "$2" | sed "s|%|$work/$1|g" >"$work/$1.build"
    variants="$variants $1"
}

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
i686=i686-linux-gnu-gcc
if links $i686 -static && "$work/links"; then
    variant i686 "$i686 $flags -O2 -static $random -o %"
    # By the Makefile, with the kernels of x86: without /usr/include, whose libraries are the host's.
    alone="$i686 -nostdinc -isystem $($i686 -print-file-name=include) -isystem /usr/i686-linux-gnu/include"
    variant i686-kernels "env -u MAKEFLAGS make -s B=%.made CC='$alone' CFLAGS=-O1 LDFLAGS=-static NVCC=none \
        %.made/tests/test_kernels && cp %.made/tests/test_kernels %"
else
    skip i686 "no $i686 here, or nothing that runs its programs"
fi
if links $arm -static && have qemu-aarch64; then
    variant aarch64 "$arm $flags -O2 -static $random -o %"
    variant aarch64-integers "mkdir %.objects && cd %.objects &&
        $arm $flags -O2 -c $PWD/tests/test_random.c && $arm $flags -O2 -mgeneral-regs-only -c $PWD/src/*.c &&
        $arm -static *.o -o %"
    if [ -d kernels/arm ]; then
        variant aarch64-kernels "$arm $flags -O2 -static -DFXS_WITH_KERNELS src/*.c kernels/*.c kernels/arm/*.c \
            tests/test_kernels.c -lm -o %"
    fi
    # The folder of stb alone: beside it lie the host's headers.
    stb=$(echo '#include <stb/stb_image.h>' | gcc -E -x c - 2>/dev/null |
        sed -n 's|^# 1 "\(.*/stb\)/stb_image.h".*|\1|p')
    if [ "$stb" ]; then
        mkdir "$work/include"
        ln -s "$stb" "$work/include/stb"
        variant aarch64-golden "$arm $flags -O2 -static -DFXS_WITH_STB -I$work/include $golden -lm -o %"
    else
        skip aarch64-golden "no stb here"
    fi
else
    skip aarch64 "no $arm with qemu-aarch64 here"
fi

printf '%s\n' $variants | xargs -P 2 -I NAME sh -c "sh '$work/NAME.build' >'$work/NAME.log' 2>&1"

first=
for name in $variants; do
    log=$work/$name.log
    case $name in aarch64*) run=qemu-aarch64 ;; *) run= ;; esac
    if ! [ -x "$work/$name" ]; then
        cat "$log"
        fail "$name" "does not build"
        continue
    fi
    $run "$work/$name" >"$log" 2>&1
    status=$?
    sum=$(sed -n 's/.*random frames: //p' "$log" | tr '\n' ' ')
    first=${first:-$sum}
    said="$name (${sum:+sum }${sum:-$(tail -n 1 "$log")})"
    if [ $status = 0 ] && [ "${sum:-$first}" = "$first" ]; then
        ok "$said"
    else
        cat "$log"
        fail "$said" "status $status, the first sum is $first"
    fi
done
finish
