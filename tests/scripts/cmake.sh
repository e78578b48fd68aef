#!/bin/sh
# Tests CMakeLists.txt: it must build the same files with the same flags as make, and programs outside the source tree
# must draw the same picture. FXS_PROCESSORS=all adds AArch64 and WebAssembly.
. tests/scripts/lib/check.sh
B=${B:-build}
case $B in /*) ;; *) B=$PWD/$B ;; esac
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
root=$PWD
if ! have cmake || ! cmake --version | awk 'NR == 1 { split($3, v, "."); exit v[1] * 100 + v[2] < 321 }'; then
    skip cmake "no cmake here, or an older one than 3.21"
    finish
    exit
fi

silent() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; return 1; }; }
configure() { folder=$1; shift; silent cmake -B "$work/$folder" -DCMAKE_C_COMPILER="${CC:-cc}" "$@"; }
build() { silent cmake --build "$work/$1" --parallel "${FXS_JOBS:-2}"; }

picture() { "$@" render "$work/knot.ply" --size 320x240 --hash; }
"$B/fixsplat" make-scene knot --count 20000 -o "$work/knot.ply" || exit 1
workflow=.github/workflows/cmake.yml
check "the picture of $workflow" grep -q "PICTURE: $(picture "$B/fixsplat")$" $workflow

# ---- Files and flags -------------------------------------------------------------------------------------------------

flags() {
    sed -e "s|$root/||g" -e "s|$work/[a-z]*/||g" -e 's/",$//' | awk '/\.c$/ {
        line = $NF
        for (i = 1; i < NF; i++)
            if ($i ~ /^-(m|f|O3|D_)/ && $i !~ /^-f(PIC|visibility|no-semantic)/)
                line = line " " $i
        print line
    }' | sort -u
}
libraries() { grep -e '-c.*tools/main\.c' | tr ' ' '\n' | grep FXS_WITH_ | sort; }

check "configures" configure whole -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
grep '"command"' "$work/whole/compile_commands.json" >"$work/cmake"
env -u MAKEFLAGS make -n B="$work/made" CC="${CC:-cc}" CFLAGS=-O2 NVCC=none V=1 all 2>&1 |
    grep -e ' -c -o ' >"$work/make"
flags <"$work/cmake" >"$work/cmake.flags"
flags <"$work/make" >"$work/make.flags"
check "there are files" grep -q '^kernels/kernels.c ' "$work/make.flags"
check "make's files, with make's flags" diff "$work/make.flags" "$work/cmake.flags"
libraries <"$work/cmake" >"$work/cmake.libraries"
libraries <"$work/make" >"$work/make.libraries"
check "make's optional libraries" diff "$work/make.libraries" "$work/cmake.libraries"

# ---- Outside programs ------------------------------------------------------------------------------------------------

"$B/fixsplat" make-scene cubes -o "$work/cubes.ply" && "$B/fixsplat" convert "$work/cubes.ply" "$work/cubes.fxs" &&
    ${CC:-cc} -Isrc/include tests/outside/core.c "$B/libfixsplat-core.a" -o "$work/by_make" || exit 1
sum=$("$work/by_make" "$work/cubes.fxs")
check "make's library draws" [ "$sum" ]

project() {
    mkdir "$work/$1"
    cp tests/outside/*.[ch] "$work/$1"
    sed "s|^find_package.*|$2|" tests/outside/CMakeLists.txt >"$work/$1/CMakeLists.txt"
}
project added "add_subdirectory($root fixsplat)"
check "add_subdirectory: configures" configure added/build -S "$work/added"
check "add_subdirectory: the core builds" silent cmake --build "$work/added/build" --target with-core --parallel 2
check "add_subdirectory: draws" equal "$("$work/added/build/with-core" "$work/cubes.fxs")" "$sum"
check "add_subdirectory: builds only what is linked" [ ! -e "$work/added/build/fixsplat/libfixsplat.a" ]

check "the core alone: configures" configure core -DFIXSPLAT_CORE_ONLY=ON
check "the core alone: builds" build core
check "the core alone: installs" silent cmake --install "$work/core" --prefix "$work/prefix"
project found 'find_package(fixsplat 1.0 REQUIRED)'
sed -i 's/foreach(library core fixsplat static)/foreach(library core)/' "$work/found/CMakeLists.txt"
check "find_package: configures" configure found/build -S "$work/found" -DCMAKE_PREFIX_PATH="$work/prefix"
check "find_package: builds" build found/build
check "find_package: draws" equal "$("$work/found/build/with-core" "$work/cubes.fxs")" "$sum"

# ---- The whole library and other processors --------------------------------------------------------------------------

if [ "$FXS_PROCESSORS" != all ]; then
    skip "the whole library, AArch64, WebAssembly" "only with FXS_PROCESSORS=all (make test-all)"
    finish
    exit
fi
check "the whole library: builds" build whole
check "the whole library: installs" silent cmake --install "$work/whole" --prefix "$work/all"
project each 'find_package(fixsplat 1.0 REQUIRED)'
check "find_package, all targets: configures" configure each/build -S "$work/each" -DCMAKE_PREFIX_PATH="$work/all"
check "find_package, all targets: builds" build each/build
for target in fixsplat static; do
    check "find_package, $target: draws" equal \
        "$("$work/each/build/with-$target" "$work/cubes.ply" "$work/packed.fxs")" "$sum"
done
check "the command: draws" equal "$(picture "$work/all/bin/fixsplat")" "$(picture "$B/fixsplat")"

if have aarch64-linux-gnu-gcc && have qemu-aarch64; then
    check "AArch64: configures" configure arm -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
        -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_EXE_LINKER_FLAGS=-static -DFIXSPLAT_SHARED=OFF \
        $(sed -n 's/^LIBRARY_\([A-Z]*\) .*/-DFIXSPLAT_WITH_\1=OFF/p' make/sources.mk)
    check "AArch64: builds" build arm
    check "AArch64: draws" equal "$(picture qemu-aarch64 "$work/arm/fixsplat")" "$(picture "$B/fixsplat")"
else
    skip AArch64 "no aarch64-linux-gnu-gcc or no qemu-aarch64 here"
fi
if echo '#include <string.h>' | clang --target=wasm32-wasi -E - >/dev/null 2>&1; then
    for flags in "" -msimd128; do
        check "WebAssembly $flags: configures" configure "wasm$flags" -DFIXSPLAT_CORE_ONLY=ON -DCMAKE_SYSTEM_NAME=WASI \
            -DCMAKE_C_COMPILER=clang -DCMAKE_C_COMPILER_TARGET=wasm32-wasi -DCMAKE_C_FLAGS=$flags
        check "WebAssembly $flags: builds" build "wasm$flags"
    done
else
    skip WebAssembly "no clang with wasi-libc here"
fi
finish
