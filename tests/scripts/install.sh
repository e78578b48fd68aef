#!/bin/sh
# Checks the files that `make install` installs, and programs in C99, C++17 and CMake that use only these files.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
library=$prefix/lib
include=$prefix/include/fixsplat
version=$(sed -n 's/^#define FXS_VERSION "\(.*\)"/\1/p' src/include/fixsplat/fixsplat.h)
CC=${CC:-cc}
strict='-Wall -Wextra -Wpedantic -Werror'

make_() { make -s --no-print-directory B="$B" PREFIX="$prefix" "$@" >"$work/log" 2>&1; }
files() { (cd "$1" && find . ! -type d | sort | tr '\n' ' '); }

check "make install" make_ install
[ -d "$include" ] || { cat "$work/log"; finish; exit 1; }
headers=$(make -s --no-print-directory headers | sed 's|^src/include/fixsplat/||' | sort)
shared=$(ls "$library" | grep 'so\.')

# ---- Installed files -------------------------------------------------------------------------------------------------

check "under include, one folder" equal "$(ls "$prefix/include")" fixsplat
check "in it, the public headers" equal "$(cd "$include" && find * -type f | sort)" "$headers"
check "no two of one name" equal "$(echo "$headers" | sed 's|.*/||' | sort | uniq -d)" ""
check "none says where it was" equal "$(grep -rl '^ *# *include *"[^"]*/' "$include")" ""
check "the command runs" "$prefix/bin/fixsplat" --version
if have help2man; then
    check "pages for man" test -s "$prefix/share/man/man1/fixsplat-render.1"
else
    skip "pages for man" "no help2man here"
fi
for file in bash-completion/completions/fixsplat zsh/site-functions/_fixsplat fish/vendor_completions.d/fixsplat.fish; do
    check "completions: $file" test -s "$prefix/share/$file"
done
if [ -e "$B/fixsplat-view" ]; then
    entry=$prefix/share/applications/fixsplat-view.desktop
    icon=$(sed -n 's/^Icon=//p' "$entry")
    check "its window: an entry for the desktop" test -x "$prefix/bin/$(sed -n 's/^TryExec=//p' "$entry")"
    check "and the icon that it names" grep -q '<svg' "$prefix/share/icons/hicolor/scalable/apps/$icon.svg"
    ! have desktop-file-validate || check "as the desktop wants it" desktop-file-validate "$entry"
    check "file types: those of the entry" equal "$(grep -o 'model/[a-z-]*' "$prefix/share/mime/packages/fixsplat.xml")" \
        "$(grep '^MimeType=' "$entry" | grep -o 'model/[a-z-]*')"
    mkdir -p "$work/home" "$work/bin"
    printf '#!/bin/sh\necho "$*" >>"$HOME/said"\n' >"$work/bin/xdg-mime" && chmod +x "$work/bin/xdg-mime"
    associate() {
        env -u XDG_DATA_HOME HOME="$work/home" PATH="$1:$PATH" "$prefix/bin/fixsplat" --quiet associate $2
    }
    own=$work/home/.local/share/applications/fixsplat-view.desktop
    check "associate" associate "$work/bin"
    check "associate: an entry with whole paths" equal "$(grep -E '^(TryExec|Exec|Icon|MimeType)=' "$own")" \
        "$(printf '%s\n' "TryExec=$prefix/bin/fixsplat-view" "Exec=\"$prefix/bin/fixsplat\" view %F" \
            "Icon=$prefix/share/icons/hicolor/scalable/apps/fixsplat.svg" "$(grep ^MimeType= "$entry")")"
    check "associate: the icon is there" test -s "$(sed -n 's/^Icon=//p' "$own")"
    check "associate --remove" associate "$work/bin" --remove
    check "associate --remove: no entry" [ ! -e "$own" ]
    check "associate --remove again" associate "$work/bin" --remove
    types=$prefix/share/mime/packages/fixsplat.xml
    check "associate: calls of xdg-mime" equal "$(cat "$work/home/said")" \
        "$(printf '%s\n' "install --mode user --novendor $types" \
            "default fixsplat-view.desktop model/x-fixsplat model/x-ply" \
            "uninstall --mode user --novendor $types" "uninstall --mode user --novendor $types")"
    printf '#!/bin/sh\nexit 3\n' >"$work/bin/xdg-mime"
    check "associate: xdg-mime fails" equal "$(associate "$work/bin" 2>&1; ls "$own" 2>/dev/null)" \
        "fixsplat: associate: xdg-mime install failed"
    if have xdg-mime && have update-mime-database; then
        check "associate: with the real xdg-mime" associate "$work/home"
        check "associate: the type of an .fxs, and its program" equal "$(grep -h 'fxs' "$work/home/.local/share/mime/globs"
            env -u XDG_DATA_HOME HOME="$work/home" xdg-mime query default model/x-fixsplat)" \
            "$(printf 'model/x-fixsplat:*.fxs\nfixsplat-view.desktop')"
    else
        skip "associate: with the real xdg-mime" "no xdg-utils or shared-mime-info here"
    fi
else
    skip "an entry for the desktop" "built without SDL2"
fi
check "modes" equal "$(find "$prefix" -type f ! -perm 644 | sort | tr '\n' ' ')" \
    "$(find "$prefix/bin" -type f -perm 755 | sort | tr '\n' ' ')"

mkdir "$work/alone"
for header in $headers; do
    echo "#include <fixsplat/$header>" >"$work/alone/$(basename "$header" .h).c"
done
each() {
    if echo 'int main(void) { return 0; }' | "$1" -x "$2" -std="$3" -fsyntax-only - 2>/dev/null; then
        check "each header alone: $1 -std=$3" "$1" -x "$2" -std="$3" -fsyntax-only $strict -I"$prefix/include" \
            "$work/alone"/*.c
    else
        skip "each header alone: $1 -std=$3" "no $1 here"
    fi
}
each gcc c c99
each gcc c c11
each g++ c++ c++17
each clang c c99
each clang c c11
each clang++ c++ c++17

# The core library (the renderer alone) may need only memcpy, memset, memmove and memcmp, and functions that compilers
# call.
needs() {
    nm "$1" | awk 'NF == 2 && $1 == "U" { need[$2] } NF == 3 { has[$3] }
        END { for (name in need) if (!(name in has)) print name }' |
        grep -Evx 'mem(cpy|set|move|cmp)|_GLOBAL_OFFSET_TABLE_|__[a-z]*[dst]i[34]|__cpu_(model|indicator_init)' |
        grep -vx __stack_chk_fail
}
check "the core depends on nothing" equal "$(needs "$library/libfixsplat-core.a")" ""
if [ "$shared" ]; then
    check "the shared library's names" equal "$(ls "$library" | grep '\.so' | tr '\n' ' ')" \
        "libfixsplat.so libfixsplat.so.${version%%.*} libfixsplat.so.$version "
    check "its SONAME" equal "$(readelf -d "$library/libfixsplat.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" \
        "libfixsplat.so.${version%%.*}"
    nm -D --defined-only "$library/libfixsplat.so" | awk '$2 != "A" { print $3 }' | sort >"$work/versions"
    check "it shows names with fxs_ alone" equal "$(grep -v '^fxs_' "$work/versions")" ""
    check "each has the version that brought it" equal "$(grep -Ev '@@FIXSPLAT_1\.[0-9]+$' "$work/versions")" ""
    # Stable functions must remain, because programs built with version 1.0 need these symbols. Experimental functions
    # may come and go.
    sed 's/$/@@FIXSPLAT_1.0/' tests/outside/names-1.0 >"$work/names-1.0"
    check "a program that was built with 1.0 finds its names" equal "$(comm -23 "$work/names-1.0" "$work/versions")" ""
    cat "$include"/*.h "$include"/internal/* | tr '\n' ' ' | grep -o 'FXS_EXPERIMENTAL [^;]*;' | grep -o 'fxs_[a-z0-9_]*' |
        sort -u | sed 's/$/@@FIXSPLAT_1.0/' >"$work/experimental"
    check "and no later stable name is said to be of 1.0" equal "$(grep '@@FIXSPLAT_1\.0$' "$work/versions" |
        comm -13 "$work/names-1.0" - | comm -23 - "$work/experimental")" ""
    # Structs, constants and functions of the stable headers must remain, because programs built with version 1.0 need
    # them. Only a struct whose first field is its size may grow. To update the list before a release:
    # sh tests/outside/layout.sh >tests/outside/layout-1.0
    if [ "$(getconf LONG_BIT)" != 64 ]; then
        skip "structs of 1.0" "they are noted for machines of 64 bits"
    elif ! /usr/bin/python3 -c 'import cffi' 2>/dev/null; then
        skip "structs of 1.0" "no python3-cffi here"
    else
        /usr/bin/python3 tests/outside/layout.py "$library/libfixsplat.so" | LC_ALL=C sort >"$work/layout"
        check "a program of 1.0: structs, constants and functions are as it was built with" equal \
            "$(LC_ALL=C comm -23 tests/outside/layout-1.0 "$work/layout" | head -n 5)" ""
    fi
    sed 's/@@.*//' "$work/versions" | sort >"$work/shown"
    nm -g "$library/libfixsplat.a" 2>/dev/null | awk 'NF == 3 && $2 ~ /[TRDB]/ { print $3 }' | sort -u >"$work/defined"
    cat "$include"/*.h "$include"/internal/* | grep -o 'fxs_[a-z0-9_]*[(;,]' | tr -d '(;,' | sort -u |
        comm -12 - "$work/defined" >"$work/declared"
    check "all that headers declare, and no more" cmp "$work/declared" "$work/shown"
else
    skip "the shared library" "not built with this compiler"
fi

# ---- Programs --------------------------------------------------------------------------------------------------------

outside=$work/outside
cp -r tests/outside "$outside" && chmod -R u+w "$outside"
"$prefix/bin/fixsplat" make-scene cubes -o "$work/cubes.ply" || exit 1

mkdir "$work/static"
cp "$library"/*.a "$work/static"

if [ "$shared" ]; then
    sed 's/.*/void &(void);\nvoid &(void) {}/' tests/outside/names-1.0 >"$work/stub.c"
    mkdir "$work/1.0" && $CC -w -shared -fPIC -Wl,-soname,libfixsplat.so.1 -o "$work/1.0/libfixsplat.so" "$work/stub.c" \
        -Wl,--version-script=tools/package/libfixsplat.map
    { sed 's/.*/extern char &;/' tests/outside/names-1.0; echo 'int fxs_version(void);'
        echo '#include <stdio.h>'; echo 'static void *volatile const names[] = {'
        grep -v '^fxs_version$' tests/outside/names-1.0 | sed 's/.*/\&&,/'
        echo '}; int main(void) { return !(printf("%d", fxs_version()) && names[0]); }'; } |
        grep -v '^extern char fxs_version;' >"$work/of_1.0.c"
    check "a program of 1.0: built" $CC -w -fno-builtin -o "$work/of_1.0" "$work/of_1.0.c" -L"$work/1.0" -lfixsplat
    said=$(LD_BIND_NOW=1 LD_LIBRARY_PATH=$library "$work/of_1.0" 2>&1)
    check "a program of 1.0 runs with this library" equal "$said" "$(printf '%s\n' "$version" |
        awk -F '[.-]' '{ print $1 * 10000 + $2 * 100 + $3 }')"
fi

sum=
draws() {
    name=$1
    shift
    said=$(LD_LIBRARY_PATH=$library "$@" 2>&1) || { fail "$name" "status $?: $said"; return; }
    sum=${sum:-$said}
    if [ "$said" = "$sum" ]; then ok "$name"; else fail "$name" "$said, the first is $sum"; fi
}

mkdir -p "$work/core/fixsplat/internal"
for header in $(make -s --no-print-directory core-headers); do
    cp "$include/${header#src/include/fixsplat/}" "$work/core/${header#src/include/}"
done

flags() { PKG_CONFIG_PATH=$library/pkgconfig pkg-config "$@"; }

program() {
    case $3 in c99) set -- "$@" "$CC -x c -std=c99" ;; *) set -- "$@" "${CXX:-c++} -x c++ -std=c++17" ;; esac
    check "$1: built" $5 $strict "$outside/$2.c" -x none -o "$work/program" $4
}

if have pkg-config; then
    for language in c99 c++17; do
        if [ $language != c99 ] && ! have "${CXX:-c++}"; then
            skip $language "no ${CXX:-c++} here"
            continue
        fi
        static=$(flags --cflags --libs --define-variable=libdir="$work/static" --static fixsplat)
        program "$language, everything, static" all $language "$static" &&
            draws "$language, everything, static: draws" "$work/program" "$work/cubes.ply" "$work/cubes.packed"
        if [ "$shared" ]; then
            program "$language, everything, shared" all $language "$(flags --cflags --libs fixsplat)" &&
                draws "$language, everything, shared: draws" "$work/program" "$work/cubes.ply" "$work/cubes.packed"
        fi
        program "$language, core" core $language "-I$work/core $(flags --libs fixsplat-core)" &&
            draws "$language, core: draws" "$work/program" "$work/cubes.packed"
    done
    check "pkg-config: the version" equal "$(flags --modversion fixsplat)" "$version"
    check "pkg-config: the core's headers" equal "$(flags --cflags fixsplat-core | tr -d ' ')" "-I$prefix/include"
else
    skip "programs by pkg-config" "no pkg-config here"
fi

if have cmake; then
    mkdir "$work/older" && sed 's/fixsplat 1.0/fixsplat 0.8/' "$work/outside/CMakeLists.txt" >"$work/older/CMakeLists.txt"
    check "CMake: a program for 0.8 is told so" sh -c '! cmake -S "$0" -B "$0/build" -DCMAKE_PREFIX_PATH="$1" \
        -DCMAKE_C_COMPILER="$2" 2>&1 | tr "\n" " " | grep -q "Configuring done" &&
        cmake -S "$0" -B "$0/build" -DCMAKE_PREFIX_PATH="$1" 2>&1 | grep -q "compatible with requested version .0.8"' \
        "$work/older" "$prefix" "$CC"
    check "CMake: built" sh -c 'cmake -S "$0" -B "$0/build" -DCMAKE_PREFIX_PATH="$1" -DCMAKE_C_COMPILER="$2" &&
        cmake --build "$0/build"' "$outside" "$prefix" "${CC%% *}"
    for target in fixsplat static; do
        draws "CMake, $target: draws" "$outside/build/with-$target" "$work/cubes.ply" "$work/cubes.packed"
    done
    draws "CMake, core: draws" "$outside/build/with-core" "$work/cubes.packed"
else
    skip "a CMake program" "no cmake here"
fi

# ---- Uninstall -------------------------------------------------------------------------------------------------------

check "DESTDIR: installed" make_ install PREFIX=/opt/fixsplat DESTDIR="$work/root"
check "DESTDIR: the same files" equal "$(files "$work/root/opt/fixsplat")" "$(files "$prefix")"
check "DESTDIR: nothing beside" equal "$(ls "$work/root") $(ls "$work/root/opt")" "opt fixsplat"
check "DESTDIR: no word of it in the files" equal \
    "$(grep -rl "$work" "$work/root/opt/fixsplat/lib/pkgconfig" "$work/root/opt/fixsplat/lib/cmake")" ""
check "DESTDIR: uninstalled" make_ uninstall PREFIX=/opt/fixsplat DESTDIR="$work/root"
check "DESTDIR: nothing is left" equal "$(files "$work/root")" ""

touch "$prefix/lib/other" "$prefix/include/other.h"
check "make uninstall" make_ uninstall
check "what others put there is left, and nothing else" equal "$(files "$prefix")" "./include/other.h ./lib/other "
check "nor a folder of its own" equal "$(find "$prefix" -name 'fixsplat*')" ""
check "make uninstall, where nothing is installed" make_ uninstall
finish
