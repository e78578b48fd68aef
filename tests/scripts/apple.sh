#!/bin/sh
# Tests Package.swift and the module map with clang, because Debian lacks Swift and Apple's SDK. The package must have the
# library's files. With the package's flags, clang must not fuse multiplications with additions, and must let vectors of
# integers wrap. FXS_PROCESSORS=all also draws.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
have clang || { skip apple "no clang here"; finish; exit; }

listed() { sed -n '/ sources: \[/,/\],/p' Package.swift | grep -o '"[^"]*"' | tr -d '"'; }
excluded=$(sed -n 's/.*"\(port[^"]*\)", "tests".*/\1/p' Package.swift)
listed | while read -r name; do find "$name" -path "${excluded:-none}" -prune -o -name '*.c' -print; done | sort >"$work/package"
words() { sed -e ':a' -e '/\\$/N; s/\\\n//; ta' make/sources.mk | sed -n "s/^$1 := //p"; }
for name in SOURCES_CORE KERNELS_arm SOURCES_LIBRARY SOURCES_posix SOURCES_PORT STAGES_arm; do
    ls $(words $name)
done | sort >"$work/make"
check "the package has the library's files" diff "$work/make" "$work/package"

ls src/include/fixsplat/*.h | sed 's|.*/||' | grep -v '^\(cuda\|vulkan\)\.h$' >"$work/headers"
sed -n 's|^ *header "fixsplat/\(.*\)"|\1|p' src/include/module.modulemap >"$work/map"
check "the module has the public headers" diff "$work/headers" "$work/map"
modules="-fmodules -fmodules-cache-path=$work/cache -Isrc/include -Wall -Werror -fsyntax-only"
echo '#include <stddef.h>
#pragma clang module import fixsplat
_Static_assert(offsetof(fxs_gaussian, scale) == 12 && offsetof(fxs_gaussian, rotation) == 24, "");
_Static_assert(offsetof(fxs_gaussian, opacity) == 40 && offsetof(fxs_gaussian, dc) == 44, "");
_Static_assert(offsetof(fxs_gaussian, sh) == 56 && sizeof(fxs_gaussian) == 236, "the layout in docs/porting.md");
int main(void) { fxs_object object; fxs_object_init(&object, 0); return fxs_version() != FXS_VERSION_NUMBER; }' >"$work/in.c"
check "the module is imported in C" clang $modules "$work/in.c"
echo '@import fixsplat;
int main(void) { fxs_message why; fxs_opened *scene; return fxs_open("scene", 0, &scene, &why); }' >"$work/in.m"
check "the module is imported in Objective-C" clang $modules "$work/in.m"

# Linux lacks Darwin's macros and, for AArch64, zlib.
defines=$(sed -n 's/.*\.define("\([A-Z_]*\)"\(, to: "\([0-9L]*\)"\)*).*/-D\1=\3/p' Package.swift | grep -v 'DARWIN\|ZLIB')
flags="-std=c99 $(echo $defines) -Isrc/include -I."
if ! echo '#include <string.h>' | clang --target=aarch64-linux-gnu -fsyntax-only -x c - 2>"$work/log"; then
    skip "the package's files" "$(head -n 1 "$work/log")"
    finish
    exit
fi
each() { grep "$1" "$work/package" | xargs -P "${FXS_JOBS:-2}" -I FILE sh -c "$2" >"$work/log" 2>&1; equal "$(cat "$work/log")" ""; }
check "AArch64: nothing is fused, vectors wrap" each . "clang --target=aarch64-linux-gnu $flags -Wall -Werror -O1 \
    -Xclang -disable-llvm-passes -S -emit-llvm -o - FILE >$work/\$\$ && ! grep -H --label=FILE 'fmuladd\|nsw <' $work/\$\$; rm $work/\$\$"
check "x86-64: the files compile without kernels" each '^kernels\|^port/backend' "clang --target=x86_64-linux-gnu $flags -Wall -Werror -fsyntax-only FILE"

if [ "$FXS_PROCESSORS" != all ] || ! have qemu-aarch64; then
    skip "the package draws on AArch64" "only with FXS_PROCESSORS=all (make test-all) and qemu-aarch64"
    finish
    exit
fi
check "AArch64: the files compile" each . "clang --target=aarch64-linux-gnu $flags -O2 -c FILE -o $work/\$(echo FILE | tr / _).o"
check "AArch64: they are all that a program needs" clang --target=aarch64-linux-gnu -static $flags tests/outside/all.c \
    "$work"/*.o -o "$work/arm" -lm -lpthread
"$B/fixsplat" make-scene cubes -o "$work/cubes.ply"
"$B/fixsplat" convert "$work/cubes.ply" "$work/here.fxs" --quiet
${CC:-cc} -Isrc/include tests/outside/core.c "$B/libfixsplat-core.a" -o "$work/core"
check "AArch64: the picture" equal "$(qemu-aarch64 "$work/arm" "$work/cubes.ply" "$work/arm.fxs")" "$("$work/core" "$work/here.fxs")"
check "AArch64: the packed scene" cmp "$work/arm.fxs" "$work/here.fxs"
finish
