#!/bin/sh
# Checks that random frames (tests/test_random.c) and scene files (tests/test_fxs_bytes.c) are equal on 32-bit and
# big-endian processors. FXS_PROCESSORS=all tests 18 processors, and the compiler clang and the C library musl.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
. tests/scripts/lib/variants.sh
arm=aarch64-linux-gnu-gcc
i686=i686-linux-gnu-gcc
library="$(echo src/core src/base src/gaussian src/scene src/scene/read src/scene/write src/pack |
    sed 's|[^ ]*|&/*.c|g') port/posix/output.c port/posix/files.c"
golden="$library $(echo src/scene/edit src/scene/make src/select src/camera src/image | sed 's|[^ ]*|&/*.c|g') tests/test_golden.c \
    tools/command/metrics.c $(ls port/backend/*.c port/posix/*.c | grep -v 'backend/fit_engines\|posix/\(files\|output\|pager\)\.c')"
cameras=$(for name in camera camera_bundler camera_colmap camera_csv camera_file camera_json camera_metashape camera_write \
    colmap_text lens lens_warp path view_list; do echo "src/camera/$name.c"; done)
photos="tests/test_photo_bytes.c src/base/*.c $(echo $cameras) src/image/image_file.c src/image/photograph.c \
    src/core/sized.c src/core/view.c src/scene/read/ply_*.c src/fit/photos/*.c port/posix/files.c port/posix/output.c port/posix/pool.c"
files="$library port/backend/pack_stages.c port/posix/pages.c tests/test_fxs_bytes.c"

# Prints the compiler flags for float arithmetic without excess precision.
singles() {
    for found in '' '-msse2 -mfpmath=sse' -msse2 -fexcess-precision=fast; do
        printf '#include <float.h>\n#if FLT_EVAL_METHOD != 0\n#error\n#endif\n' |
            $1 -std=c99 $found -E -x c - >/dev/null 2>&1 && echo "$found" && return
    done
}

processor() {
    if ! links $2 -static; then
        skip "$1" "no $2 with its C library here"
    elif ! "$work/links" 2>/dev/null && ! have "${3:-none}"; then
        skip "$1" "no $3 here"
    else
        if "$work/links" 2>/dev/null; then set -- "$1" "$2"; fi
        variant $1 "$2 $flags -O1 -static src/core/*.c tests/test_random.c -o %" $3
        [ "$FXS_PROCESSORS" != all ] && [ $1 != i686 ] ||
            variant $1-files "$2 $flags -O1 -static $files -lm -o %" $3
        [ -z "$(singles $2)" ] || variant $1-trees "$2 $flags $(singles $2) -O1 -static $files -lm -o %" $3
    fi
}

aarch64() {
    variant aarch64-integers "mkdir %.objects && cd %.objects &&
        $arm $flags -O2 -c $PWD/tests/test_random.c && $arm $flags -O2 -mgeneral-regs-only -c $PWD/src/core/*.c &&
        $arm -static *.o -o %" qemu-aarch64
    variant aarch64-kernels "$arm $flags -O2 -static -DFXS_WITH_KERNELS src/core/*.c kernels/*.c kernels/simd/arm/*.c \
        tests/test_kernels.c -lm -o %" qemu-aarch64
    usr=${B:-build}/aarch64/usr
    libraries="-I$usr/include -I$usr/include/aarch64-linux-gnu -L$usr/lib/aarch64-linux-gnu -lpng -ljpeg -lz -lm"
    if [ ! -e "$usr/../here" ]; then
        skip "aarch64-photos aarch64-golden" "no libraries for AArch64 here (make setup test)"
        return
    fi
    variant aarch64-photos "$arm $flags -O1 -static -DFXS_WITH_JPEG $photos $libraries -o %" qemu-aarch64
    [ "$FXS_PROCESSORS" != all ] ||
        variant aarch64-golden "$arm $flags -O2 -static -DFXS_WITH_PNG $golden $libraries -o %" qemu-aarch64
}

i686() {
    alone="$i686 -nostdinc -isystem $($i686 -print-file-name=include) -isystem /usr/i686-linux-gnu/include"
    variant i686-kernels "env -u MAKEFLAGS make -s B=%.made CC='$alone' CFLAGS='-O1 -Werror' LDFLAGS=-static NVCC=none \
        %.made/fixsplat %.made/tests/test_kernels && cp %.made/tests/test_kernels %" $(sed 's/ .*//' "$work/i686.run")
}

processor i686 $i686 qemu-i386
processor s390x s390x-linux-gnu-gcc qemu-s390x
if [ "$FXS_PROCESSORS" = all ]; then
    processor x86-64 x86_64-linux-gnu-gcc qemu-x86_64
    processor armv7 arm-linux-gnueabihf-gcc qemu-arm
    processor aarch64 $arm qemu-aarch64
    processor riscv64 riscv64-linux-gnu-gcc qemu-riscv64
    processor powerpc powerpc-linux-gnu-gcc qemu-ppc
    processor x86-64-musl musl-gcc qemu-x86_64
    processor armv5 arm-linux-gnueabi-gcc qemu-arm
    processor armv7-neon 'arm-linux-gnueabihf-gcc -mfpu=neon-vfpv4 -ftree-vectorize' qemu-arm
    processor aarch64-clang 'clang --target=aarch64-linux-gnu' qemu-aarch64
    processor mips mips-linux-gnu-gcc qemu-mips
    processor mips64el mips64el-linux-gnuabi64-gcc qemu-mips64el
    processor powerpc64 powerpc64-linux-gnu-gcc qemu-ppc64
    processor powerpc64le powerpc64le-linux-gnu-gcc qemu-ppc64le
    processor m68k m68k-linux-gnu-gcc qemu-m68k
    processor sparc64 sparc64-linux-gnu-gcc qemu-sparc64
    processor hppa hppa-linux-gnu-gcc qemu-hppa
    case $variants in *i686*) i686 ;; esac
fi
if links $arm -static && { "$work/links" 2>/dev/null || have qemu-aarch64; }; then
    aarch64
else
    skip aarch64 "no $arm with its C library, or no qemu-aarch64 here"
fi
run_variants
finish
