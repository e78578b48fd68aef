#!/bin/sh
# Tests the Makefile: rebuilds after changes of compiler, flags or libraries, chosen kernels, and `make setup`.
. tests/scripts/lib/check.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir "$work/include"

# Writes a compiler script that finds neither the header nor the library named in the file `hidden`.
cat >"$work/cc" <<'END'
#!/bin/sh
if word=$(cat "${0%/*}/include/hidden" 2>/dev/null); then
    for argument in "$@"; do
        case $argument in
        "$word") exit 1 ;;
        */probe.c) grep -q -e "$word" "$argument" && exit 1 ;;
        esac
    done
fi
exec cc "$@"
END
chmod +x "$work/cc"

hide() {
    rm -f "$work/include/hidden"
    [ -z "$1" ] || echo "$1" >"$work/include/hidden"
}

make_() { env -u MAKEFLAGS -u MAKELEVEL make --no-print-directory NVCC=none "$@" 2>&1; }

build() {
    make_ -j1 B="$work/build" CC="$work/cc" CPPFLAGS="-I$work/include" "$@" "$work/build/port/backend/backend_gles.o" \
        "$work/build/src/scene/read/spz.o" "$work/build/src/core/frame.o" >"$work/log" || cat "$work/log"
    sed -n 's/^  CC *//p' "$work/log" | tr '\n' ' '
}
every='port/backend/backend_gles.c src/scene/read/spz.c src/core/frame.c '

is() { if [ "$2" = "$3" ]; then ok "$1"; else fail "$1" "$3"; fi; }
uses() { grep -q "$2" "$work/build/$1"; }
lacks() { ! uses "$@"; }

hide osmesa
is "first: built" "$every" "$(build)"
is "the same again: kept" "" "$(build)"
if echo '#include <GL/osmesa.h>' | cc -E -x c - >/dev/null 2>&1; then
    hide
    is "a library found: what asks for it is built anew" "port/backend/backend_gles.c " "$(build)"
    check "a library found: used" uses port/backend/backend_gles.o fxs_osmesa_open
    hide osmesa
    is "a library gone: what asks for it is built anew" "port/backend/backend_gles.c " "$(build)"
    check "a library gone: not used" lacks port/backend/backend_gles.o fxs_osmesa_open
else
    skip "a library found" "no GL/osmesa.h here"
fi
if echo '#include <zstd.h>' | cc -E -x c - >/dev/null 2>&1; then
    hide
    build >/dev/null
    hide -lzstd
    is "headers without their library" "src/scene/read/spz.c " "$(build)"
    check "headers without their library: not used" lacks src/scene/read/spz.o ZSTD_decompress
    echo '#define OTHER' | cat - $(echo '#include <zstd.h>' | cc -M -x c - | tr -d ':\\' | tr ' ' '\n' | grep /zstd.h) \
        >"$work/include/zstd.h"
    hide
    build >/dev/null
    check "headers with their library: used" uses src/scene/read/spz.o ZSTD_decompress
    echo '#define MORE' >>"$work/include/zstd.h"
    touch "$work/include/other.h"
    is "other headers of a library: what asks for it is built anew" "src/scene/read/spz.c " "$(build)"
else
    skip "headers without their library" "no zstd.h here"
fi
is "other flags: built anew" "$every" "$(build CFLAGS=-O1)"
is "other flags again: kept" "" "$(build CFLAGS=-O1)"
is "flags with quotes: built anew" "$every" "$(build CFLAGS="-DWORDS='\"it is\"'")"
is "flags with quotes again: kept" "" "$(build CFLAGS="-DWORDS='\"it is\"'")"
check "flags with quotes: libraries are found" grep -q KERNELS "$work/build/probe.mk"
sed -i 's/^exec cc "$@"$/case $1 in --version) echo other ;; *) exec cc "$@" ;; esac/' "$work/cc"
is "another version of the compiler: built anew" "$every" "$(build CFLAGS="-DWORDS='\"it is\"'")"
is "another version of the compiler again: kept" "" "$(build CFLAGS="-DWORDS='\"it is\"'")"
check "one line a file" equal "$(rm "$work/build/src/core/frame.o"; build CFLAGS=-O1 V= | grep -c frame)" 1
rm "$work/build/src/core/frame.o"
build CFLAGS=-O1 V=1 >/dev/null
check "V=1: whole commands" grep -q -- "-c -o $work/build/src/core/frame.o src/core/frame.c" "$work/log"

# ---- Chosen kernels and tests ----------------------------------------------------------------------------------------

chosen() {
    make_ -n V=1 B="$work/chosen" CC="$1" $2 "$work/chosen/libfixsplat-core.a" >"$work/log"
    folders=$(sed -n 's|.* kernels/simd/\([a-z0-9]*\)/[a-z_0-9]*\.c$|\1|p' "$work/log" | sort -u | tr '\n' ' ')
    echo "$folders:$(sed -n 's/.*&& \(.*\) rcs .*/\1/p' "$work/log")"
}
if have aarch64-linux-gnu-gcc; then
    is "aarch64-linux-gnu-gcc" "arm :aarch64" "$(chosen aarch64-linux-gnu-gcc | sed 's/:.*aarch64.*ar$/:aarch64/')"
    is "AR of the user's" "arm :some-ar" "$(chosen aarch64-linux-gnu-gcc AR=some-ar)"
else
    skip "aarch64-linux-gnu-gcc" "not here"
fi
for target in i586-linux-gnu:x86 arm64-apple-macos:arm aarch64_be-linux-gnu: wasm32:; do
    if clang --target=${target%:*} -E -x c /dev/null >/dev/null 2>&1; then
        said=$(chosen "clang --target=${target%:*}")
        is "kernels for ${target%:*}" "${target#*:}" "$(echo ${said%%:*})"
    else
        skip "kernels for ${target%:*}" "no clang here that knows it"
    fi
done

tests() { make_ -n B="$work/chosen" test T="$1" | sed -n 's/.* tests\/run\.sh *//p'; }
is "T: a test by its name" test_scene "$(tests test_scene)"
is "T: without test_" test_scene "$(tests scene)"
is "T: a script" build.sh "$(tests build)"
is "T: a gate and a test, by a part" "include_rules.sh test_fxs_bytes" "$(tests 'fxs_by include')"
is "T: no such test" 1 "$(make_ -n B="$work/chosen" test T=nothing | grep -c 'no test is called nothing')"

mkdir -p "$work/half/web/package"
touch "$work/half/web/package/package.json"
is "install: no page of which there is a part" "" "$(make_ -n B="$work/half" install | grep share/fixsplat)"
is "setup: no sources for the web where none are wanted" "" "$(make_ -n B="$work/half" setup web WEB_SOURCES= | grep web_sources)"

mkdir "$work/few"
for program in env make sh sed nproc awk uname cat printf git; do ln -s "$(command -v $program)" "$work/few"; done
for goal in 'dist dh' 'dist-check dh' 'web wasm-opt' 'web-package npm' 'windows x86_64-w64-mingw32-gcc'; do
    said=$(PATH="$work/few" make_ B="$work/none" DIST="$work/none" "${goal% *}" | tail -n 1)
    is "${goal% *}: programs that are missing are said at once" "1 0" "$(echo "$said" |
        grep -Ec "[*]{3} ${goal% *}: not here: .*${goal#* }.*: make setup ${goal% *}\.") $(ls "$work/none" 2>/dev/null | wc -l)"
done

# ---- Setup while another apt-get runs --------------------------------------------------------------------------------

mkdir "$work/bin"
cat >"$work/bin/apt-get" <<'END'
#!/bin/sh
echo "$@" >>"$APT_LOG"
case $* in
*update*) [ "$(grep -c update "$APT_LOG")" -gt 2 ] || { echo "E: Could not get lock lists/lock." >&2; exit 100; } ;;
esac
END
echo 'exit 1' >"$work/bin/dpkg-query"
echo 'exit 0' >"$work/bin/sleep"
echo 'exec "$@"' >"$work/bin/sudo"
chmod +x "$work/bin"/*
check "setup: ends well" env PATH="$work/bin:$PATH" APT_LOG="$work/apt" sh tools/scripts/setup.sh one two
check "setup: waits for the lock of update" [ "$(grep -c update "$work/apt")" = 3 ]
check "setup: installs, waiting for the lock of dpkg" grep -q 'Lock::Timeout=300 install .*one two$' "$work/apt"

# ---- Setup from npm --------------------------------------------------------------------------------------------------

cat >"$work/bin/npm" <<'END'
#!/bin/sh
echo "$@" >>"$NPM_LOG"
mkdir -p "$3/node_modules/puppeteer-core"
END
chmod +x "$work/bin/npm"
for time in 1 2; do
    check "setup: npm, time $time" env PATH="$work/bin:$PATH" NPM_LOG="$work/npm" sh tools/scripts/page_modules.sh "$work/page"
done
check "setup: npm runs once, no script of a module" equal "$(cut -d ' ' -f 1-4 "$work/npm")" \
    "ci --prefix $work/page --ignore-scripts"
lock=tests/web/package-lock.json
check "setup: npm has the lock" cmp $lock "$work/page/package-lock.json"
for lock in tests/web/package-lock.json tests/web/bundlers/package-lock.json; do
    check "$lock: a sum for each module" equal "$(grep -c '"integrity": "sha512-' $lock)" \
        "$(($(grep -c '^    "node_modules/' $lock)))"
    check "$lock: no address but the registry's" equal "$(grep '"resolved"' $lock |
        grep -v '"https://registry.npmjs.org/')" ""
done
lock=tests/web/package-lock.json
check "the lock: of package.json" equal "$(sed -n '/"": {/,/}/s/^ *\("[^"]*": "[0-9][^"]*"\).*/\1/p' $lock)" \
    "$(sed -n 's/^ *\("[^"]*": "[0-9][^"]*"\).*/\1/p' tests/web/package.json)"
finish
