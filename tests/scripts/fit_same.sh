#!/bin/sh
# Checks that `fixsplat fit` writes the same bytes with each compiler, under sanitizers and by qemu-user. Builds that
# compute floats with more precision must refuse to fit. FXS_PROCESSORS=all adds compilers and processors.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
. tests/scripts/lib/variants.sh
sources="tests/test_fit_steps.c $(ls src/fit/*.c src/fit/*/*.c src/pack/*.c src/core/*.c | grep -v '/photo\|/checkpoint' | tr '\n' ' ')
    src/camera/camera.c src/gaussian/transform.c src/base/message.c src/base/allocator.c src/base/crc32.c
    src/base/options.c src/gaussian/scene_start.c src/gaussian/nearest.c
    port/posix/pool.c port/posix/pages.c port/backend/fit_engines.c port/backend/pack_stages.c"
few="$flags -w -DFXS_FIT_FEW -ffunction-sections -Wl,--gc-sections"
one="$(echo $sources) -o % -lm -lpthread"

fit() {
    if ! links $2 ${3%% [a-z]*}; then
        skip "$1" "no $2 $3 with its C library here"
    elif "$work/links" 2>/dev/null; then
        variant "$1" "$2 $few $3 $one"
    elif have "${4:-none}"; then
        variant "$1" "$2 $few $3 $one" $4
    else
        skip "$1" "no ${4:-processor for it} here"
    fi
}

fit clang-sanitized clang '-O1 -fsanitize=address,undefined -fno-sanitize-recover=all'
fit aarch64-neon aarch64-linux-gnu-gcc '-O2 -static -fwrapv -DFXS_WITH_KERNELS kernels/kernels.c kernels/simd/arm/*.c kernels/fit/fit_neon.c' qemu-aarch64
if [ "$FXS_PROCESSORS" = all ]; then
    fit gcc-native gcc '-O3 -march=native'
    fit i686 i686-linux-gnu-gcc '-O2 -static -msse2 -mfpmath=sse' qemu-i386
    fit s390x s390x-linux-gnu-gcc '-O2 -static -fexcess-precision=fast' qemu-s390x
    fit gcc-O0 gcc -O0
    fit gcc-O3 gcc -O3
    fit clang-O0 clang -O0
    fit clang-native clang '-O3 -march=native'
    fit aarch64 aarch64-linux-gnu-gcc '-O2 -static' qemu-aarch64
    fit armv7 arm-linux-gnueabihf-gcc '-O2 -static' qemu-arm
    fit riscv64 riscv64-linux-gnu-gcc '-O2 -static' qemu-riscv64
    fit powerpc powerpc-linux-gnu-gcc '-O2 -static' qemu-ppc
    fit powerpc64le powerpc64le-linux-gnu-gcc '-O2 -static' qemu-ppc64le
    fit armv7-neon arm-linux-gnueabihf-gcc '-O3 -static -mfpu=neon-vfpv4' qemu-arm
    fit mips mips-linux-gnu-gcc '-O2 -static' qemu-mips
    fit mips64el mips64el-linux-gnuabi64-gcc '-O2 -static' qemu-mips64el
    fit sparc64 sparc64-linux-gnu-gcc '-O2 -static' qemu-sparc64
    fit hppa hppa-linux-gnu-gcc '-O2 -static' qemu-hppa
fi
run_variants

refuses() {
    if ! links $2 $3; then
        skip "$1" "no $2 with its C library here"
    elif ! "$work/links" 2>/dev/null && ! have $4; then
        skip "$1" "no $4 here"
    else
        run=$("$work/links" 2>/dev/null || echo $4)
        sh -c "$(echo "$2 $few $3 $one" | sed "s|%|$work/refuses|")" >"$work/log" 2>&1 || cat "$work/log"
        check "$1" equal "$($run "$work/refuses" | sed -n 's/.*threads: //p' | sort -u)" 0x0000000000000000
    fi
}
refuses "i686 with x87" i686-linux-gnu-gcc '-O0 -static' qemu-i386
[ "$FXS_PROCESSORS" != all ] || refuses m68k m68k-linux-gnu-gcc '-O1 -static' qemu-m68k

for compiler in i686-linux-gnu-gcc s390x-linux-gnu-gcc; do
    if have $compiler; then
        env -u MAKEFLAGS make -n V=1 B="$work/made" CC=$compiler NVCC=none "$work/made/src/fit/fit.o" >"$work/log" 2>&1
        check "make CC=$compiler" grep -q -e '-mfpmath=sse' -e '-fexcess-precision=fast' "$work/log"
    else
        skip "make CC=$compiler" "not here"
    fi
done
finish
