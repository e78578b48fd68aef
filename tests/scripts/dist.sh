#!/bin/sh
# Installs each result of `make dist` on a bare system and uses it once. FXS_DIST: folder of a finished `make dist`.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
version=$(sed -n 's/^#define FXS_VERSION "\(.*\)"/\1/p' src/include/fixsplat/fixsplat.h)
dist=$FXS_DIST

# The page of the packages, here of files with their names.
mkdir "$work/made"
for file in "fixsplat-$version.tar.gz" fixsplat-1-linux-x86_64.tar.gz fixsplat-1-linux-aarch64.tar.gz \
    fixsplat-1-windows-x86_64.zip fixsplat_1_amd64.deb libfixsplat1_1_amd64.deb libfixsplat-dev_1_amd64.deb \
    python3-fixsplat_1_all.deb fixsplat-1-py3-none-manylinux_2_36_x86_64.whl fixsplat-1-py3-none-win_amd64.whl \
    fixsplat-1-py3-none-manylinux_2_36_aarch64.whl fixsplat-1-npm.tgz fixsplat-viewer-1-npm.tgz; do
    echo "$file" >"$work/made/$file"
done
sh tools/scripts/downloads.sh "$work/made" "$version" >"$work/index.html"
check "the page of the packages: every file, once, with its sum" equal \
    "$(sed -n 's/.*href="\([^"]*\)".*<code>\(.*\)<.code>/\2  \1/p' "$work/index.html" | sort)" \
    "$(cd "$work/made" && sha256sum -- * | sort)"
echo >"$work/made/other.rpm"
check "the page of the packages: a file without a row" equal \
    "$(sh tools/scripts/downloads.sh "$work/made" 1 2>&1 >"$work/log")" \
    "downloads: 12 rows for the 14 files in $work/made"

if [ "$dist" ]; then
    dist=$(cd "$dist" && pwd)
elif [ "$FXS_PROCESSORS" != all ]; then
    skip "what make dist makes" "only by make test-all"
    finish
    exit
else
    for tool in dpkg-buildpackage dh_python3 cmake nasm esbuild; do
        have $tool || { skip "what make dist makes" "no $tool here: make setup dist"; finish; exit; }
    done
    dist=$PWD/$B/dist-tested
    if make -s B="$B" DIST="$dist" dist-check >"$work/log" 2>&1; then
        ok "built twice, in two folders: the same bytes"
    else
        fail "built twice, in two folders: the same bytes" "$(tail -n 20 "$work/log")"
    fi
fi
check "SHA256SUMS has every file" equal "$(cut -c 67- "$dist/SHA256SUMS" | sort)" "$(ls "$dist" | grep -v SHA256SUMS)"
check "and their sums" sh -c 'cd "$0" && sha256sum --quiet -c SHA256SUMS' "$dist"
[ -e "$B/fixsplat" ] && "$B/fixsplat" make-scene knot --count 5000 -o "$work/knot.ply" || { finish; exit 1; }
hash=$("$B/fixsplat" render "$work/knot.ply" --size 320x180 --hash)
cp -r tests/outside tests/python tests/windows "$work"
cd "$work" || exit 1

now() { date +%s.%N; }
begin() { begun=$(now); }
report() {
    name=$1
    shift
    size=$(du -csk --apparent-size "$@" | tail -n 1 | cut -f 1)
    echo "$name: $size KB installed, $(awk "BEGIN { printf \"%.1f\", $(now) - $begun }") seconds"
}

small() {
    check "$1: the command and the library are small" equal "$(find "$2" "$3" -size +12000000c)" ""
    wc -c "$2" "$3" | sed -n '$d; s|^\( *[0-9]*\) .*/|    \1 bytes: |p'
}

bare() { env -i PATH=/usr/bin:/bin HOME="$work" LANG=C.UTF-8 "$@"; }

# ---- Tarballs --------------------------------------------------------------------------------------------------------

needs() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -Ev '^(lib(c|m)\.so\.6|ld-linux-.*)$'; }

dead() {
    find "$1/share/doc" -name '*.md' | while read -r page; do
        sed '/^ *```/,/^ *```/d' "$page" | grep -o '\]([^) ]*)' | sed 's/^](//; s/[#)].*//' | while read -r to; do
            case $to in '' | *:*) ;; *) [ -e "${page%/*}/$to" ] || echo "${page#"$1/"}: $to" ;; esac
        done
    done
}

tarball() {
    begin
    arch=$1 folder=$work/fixsplat-$version-linux-$1
    shift
    tar -xzf "$dist/fixsplat-$version-linux-$arch.tar.gz" || { fail "tarball, $arch" "tar"; return; }
    for file in bin/fixsplat bin/fixsplat-web "lib/libfixsplat.so.$version"; do
        check "$arch: $file needs glibc alone" equal "$(needs "$folder/$file")" ""
    done
    check "$arch: render" equal "$(bare "$@" "$folder/bin/fixsplat" render knot.ply --size 320x180 --hash 2>&1)" "$hash"
    check "$arch: doctor" bare "$@" "$folder/bin/fixsplat" doctor
    for file in bin/fixsplat-view share/man/man1/fixsplat-render.1 share/fixsplat/web/viewer/index.html \
        share/doc/fixsplat/LICENSE share/doc/fixsplat/licences/zlib share/doc/fixsplat/licences/qrencode \
        share/doc/fixsplat/docs/install.md; do
        check "$arch: $file" test -s "$folder/$file"
    done
    check "$arch: no word of where it was built" equal "$(grep -rlE "$PWD|/tmp/|/build/dist" "$folder" | head -n 3)" ""
    check "$arch: no dead link in its pages" equal "$(dead "$folder")" ""
    report "tarball, $arch" "$folder"
    [ -e "$folder/share/doc/fixsplat/licences/libstdc++" ] ||
        small "tarball, $arch" "$folder/bin/fixsplat" "$folder/lib/libfixsplat.so.$version"
}

window() {
    rm -f display
    Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp -noreset 3>display >server 2>&1 &
    screen=$!
    for second in 1 2 3 4 5; do [ -s display ] || sleep 1; done
    DISPLAY=:$(cat display)
    export DISPLAY
    timeout 60 "$@" >log 2>&1 &
    viewer=$!
    found=$(timeout 50 xdotool search --sync --onlyvisible --name '^knot.ply - ') &&
        xdotool windowfocus --sync "$found" key Escape
    wait $viewer
    ended=$?
    kill $screen
    wait $screen 2>/dev/null
    unset DISPLAY
    [ "$found" ] && [ $ended = 0 ] || { cat log; return 1; }
}
here=$(uname -m)
tarball "$here"
export PKG_CONFIG_PATH="$work/fixsplat-$version-linux-$here/lib/pkgconfig"
library=$work/fixsplat-$version-linux-$here/lib
check "$here: a program, shared" sh -c '${CC:-cc} -x c -std=c99 outside/all.c -x none -o shared \
    $(pkg-config --cflags --libs fixsplat) && LD_LIBRARY_PATH=$0 ./shared knot.ply a.packed' "$library"
mkdir static && cp "$library"/*.a static
check "$here: a program, static" sh -c '${CC:-cc} -x c -std=c99 outside/all.c -x none -o static/program \
    $(pkg-config --cflags --libs --static --define-variable=libdir=static fixsplat) &&
    ./static/program knot.ply a.packed'
if [ "$here" != aarch64 ] && have qemu-aarch64; then
    tarball aarch64 qemu-aarch64 -L /usr/aarch64-linux-gnu
    if have Xvfb && have xdotool && have mmdebstrap && mmdebstrap --quiet --arch=arm64 --variant=extract \
        --include=libsdl2-2.0-0,libsdl2-ttf-2.0-0 bookworm arm64 >log 2>&1; then
        check "aarch64: a window with the scene, which Escape closes" window env SDL_VIDEODRIVER=x11 \
            qemu-aarch64 -L arm64 "$folder/bin/fixsplat-view" knot.ply
    else
        skip "aarch64: a window" "no Xvfb, xdotool or mmdebstrap here, or no packages of Debian's"
    fi
elif [ "$here" != aarch64 ]; then
    skip "tarball, aarch64" "no qemu-aarch64 here"
fi

# ---- Wheels ----------------------------------------------------------------------------------------------------------

python=${PYTHON:-python3}
"$python" -c 'import numpy, cffi' 2>/dev/null || python=/usr/bin/python3
begin
if "$python" -m venv venv 2>/dev/null; then
    wheel=$(ls "$dist"/*_"$here".whl)
    venv/bin/pip install -q --disable-pip-version-check --retries 0 --timeout 5 "$wheel" >log 2>&1 ||
        { "$python" -m venv --system-site-packages venv &&
            venv/bin/pip install -q --disable-pip-version-check --no-index --no-deps "$wheel" >log 2>&1; }
    check "wheel: renders" bare venv/bin/python -c 'import fixsplat
s = fixsplat.load("knot.ply")
s.render(s.frame(320, 180)).save("wheel.png")'
    check "wheel: its library" sh -c 'find venv -path "*site-packages/fixsplat/libfixsplat.so.1" | grep -q .'
    check "wheel: its types" sh -c 'find venv -path "*site-packages/fixsplat/py.typed" | grep -q .'
    check "wheel: a picture" sh -c 'file -b wheel.png 2>/dev/null | grep -q "320 x 180" || test -s wheel.png'
    report wheel venv/lib/python3*/site-packages/fixsplat
else
    skip wheel "no venv here"
fi
for file in "$dist"/*linux*.whl; do
    check "${file##*/}: for glibc of Debian 12" sh -c 'case $0 in *-py3-none-manylinux_2_36_*) ;; *) false ;; esac' \
        "$file"
done

# ---- The zip for Windows ---------------------------------------------------------------------------------------------

begin
zip=$dist/fixsplat-$version-windows-x86_64.zip
folder=$work/$(basename "$zip" .zip)
wine=$(command -v wine64 || ls /usr/lib/wine/wine64 2>/dev/null)
end_wine() { WINEPREFIX=$work/wine "$(dirname "$(readlink -f "$wine")")/wineserver" -k 2>/dev/null; }
w() { bare WINEPREFIX="$work/wine" WINEDEBUG=-all "$wine" "$folder/bin/$@"; }
if [ ! -e "$zip" ] && ! have x86_64-w64-mingw32-gcc; then
    skip "zip for Windows" "no x86_64-w64-mingw32-gcc here: make setup dist"
elif [ -z "$wine" ]; then
    skip "zip for Windows" "no wine64 here: make setup test-all"
else
    trap 'end_wine; rm -rf "$work"' EXIT
    check "zip for Windows: unpacked" "$python" -m zipfile -e "$zip" .
    w fixsplat.exe --version >log 2>&1
    check "Windows: render" equal "$(w fixsplat.exe render knot.ply --size 320x180 --hash)" "$hash"
    check "Windows: demo" w fixsplat.exe demo -o windows.png
    check "Windows: its picture and scene" test -s windows.png -a -s windows.ply
    w fixsplat.exe doctor >doctor
    check "Windows: doctor finds the page" grep -q "page.*$(basename "$folder")" doctor
    check "Windows: doctor, without what is for Linux" equal "$(grep -E 'apt |xdg|libegl|nvcc' doctor)" ""
    check "Windows: publish" w fixsplat.exe publish knot.ply site.html --single
    w fixsplat.exe view --web --port 0 knot.ply >served 2>log &
    server=$!
    until [ -s served ] || ! kill -0 $server 2>/dev/null; do sleep 0.1; done
    at=$(tr -d '\r' <served | sed -n 's|/$||p')
    check "Windows: view --web: the page" sh -c 'curl -sL "$0/" | cmp - "$1"' "$at" \
        "$folder/share/fixsplat/web/viewer/served.html"
    check "Windows: view --web: the element" sh -c 'curl -s "$0/viewer/viewer.js" | cmp - "$1"' "$at" \
        "$folder/share/fixsplat/web/viewer/viewer.js"
    end_wine                                                             # ends wine, which then restarts with a screen
    if have Xvfb && have xdotool; then
        check "Windows: a window with a scene dropped on its program, which Escape closes" window \
            env -u SDL_VIDEODRIVER WINEPREFIX="$work/wine" WINEDEBUG=-all "$wine" "$folder/bin/fixsplat-view.exe" \
            "Z:$(pwd -P | tr / '\\')\\knot.ply"
    else
        skip "Windows: a window" "no Xvfb and xdotool here"
    fi
    for file in lib/libfixsplat-core.a share/doc/fixsplat/LICENSE share/doc/fixsplat/licences/libexif \
        share/doc/fixsplat/licences/libsdl2 share/doc/fixsplat/docs/install.md share/fixsplat/web/viewer/index.html; do
        check "Windows: $file" test -s "$folder/$file"
    done
    check "Windows: no word of where it was built" equal \
        "$(grep -rlE "$PWD|/tmp/|/build/dist" "$folder" | head -n 3)" ""
    check "Windows: no dead link in its pages" equal "$(dead "$folder")" ""
    report "zip for Windows" "$folder"
    small "zip for Windows" "$folder/bin/fixsplat.exe" "$folder/bin/libfixsplat-${version%%.*}.dll"
    for kind in shared static; do
        have x86_64-w64-mingw32-gcc || { skip "Windows: a program, $kind" "no x86_64-w64-mingw32-gcc here"; continue; }
        check "Windows: a program, $kind" x86_64-w64-mingw32-gcc -std=c99 outside/all.c -o "$folder/bin/$kind.exe" \
            -I"$folder/include" -L"$folder/lib" $([ $kind = shared ] || echo -static) -lfixsplat -lpthread
        check "Windows: it runs, $kind" w $kind.exe knot.ply $kind.packed
        check "Windows: it packs the same, $kind" cmp $kind.packed a.packed
    done
fi

# Debian has no Python for Windows, so the program tests/windows/wheel.c makes the calls of the Python package.
installed=$(ls -d venv/lib/python3*/site-packages/fixsplat 2>/dev/null)
wheel=$(ls "$dist"/*-py3-none-win_amd64.whl 2>/dev/null)
if [ ! -e "$zip" ]; then
    skip "wheel for Windows" "no zip for Windows"
elif [ -z "$installed" ] || [ -z "$wine" ] || ! have x86_64-w64-mingw32-gcc; then
    skip "wheel for Windows" "no venv, wine64 or x86_64-w64-mingw32-gcc here"
else
    begin
    dll=libfixsplat-${version%%.*}.dll
    check "wheel for Windows: unpacked" "$python" -m zipfile -e "$wheel" wheel
    files() { (cd "$1" && find . -type f ! -path '*/__pycache__/*' | LC_ALL=C sort | grep -v libfixsplat); }
    check "wheel for Windows: the files of the one for Linux" equal "$(files wheel/fixsplat)" "$(files "$installed")"
    check "wheel for Windows: its library is that of the zip" cmp "wheel/fixsplat/$dll" "$folder/bin/$dll"
    check "wheel for Windows: its tag" grep -qx 'Tag: py3-none-win_amd64' wheel/fixsplat-*.dist-info/WHEEL
    check "wheel for Windows: the package looks for that name" equal "$(bare venv/bin/python -c \
        'from fixsplat._library import _names; print(*_names("win32"))')" "$dll"
    check "wheel for Windows: licences of what is linked in" sh -c 'grep -q "libjpeg-turbo" "$0" && grep -qi mingw "$0"' \
        "$(find wheel -name LICENSE.libraries)"
    nm -D --defined-only "$installed/libfixsplat.so.${version%%.*}" | sed 's/.* //; s/@.*//' | sort >functions
    grep -ohE '(lib\.|")fxs_[a-z0-9_]+' wheel/fixsplat/*.py | sed 's/.*fxs_/fxs_/' | sort -u | comm -12 - functions >called
    x86_64-w64-mingw32-objdump -p "wheel/fixsplat/$dll" | awk '$1 ~ /^\[/ { print $NF }' | sort >exported
    check "wheel for Windows: its library has the $(wc -l <called) functions that the package calls" \
        equal "$(comm -23 called exported) $(awk 'END { print (NR > 60) }' called)" " 1"
    cat >camera.json <<-'END'
	{"fl_x": 300, "fl_y": 300, "cx": 160, "cy": 90, "w": 320, "h": 180, "frames": [{"file_path": "a.png",
	    "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 12], [0, 0, 0, 1]]}]}
	END
    bare venv/bin/python python/calls.py knot.ply camera.json >linux.calls
    check "wheel for Windows: a program that calls as the package does" x86_64-w64-mingw32-gcc -std=c99 \
        windows/wheel.c -o wheel.exe -I"$folder/include"
    bare WINEPREFIX="$work/wine" WINEDEBUG=-all "$wine" wheel.exe "wheel/fixsplat/$dll" knot.ply camera.json declared |
        tr -d '\r' >windows.calls
    check "wheel for Windows: its library draws what the package draws here, by the same calls" \
        cmp windows.calls linux.calls
    layout() { venv/bin/python outside/layout.py "$installed/libfixsplat.so.${version%%.*}" "$@"; }
    check "wheel for Windows: cffi reads of it the structs, constants and functions that it reads here" \
        equal "$(layout declared)" "$(layout)"
    check "wheel for Windows: a picture" grep -Eqx '[0-9a-f]{16}' linux.calls
    report "wheel for Windows" wheel/fixsplat
    end_wine
fi

# ---- npm -------------------------------------------------------------------------------------------------------------

if have npm; then
    begin
    mkdir npm
    (cd npm && npm install --silent --offline --no-audit --no-fund "$dist/fixsplat-$version-npm.tgz" \
        "$dist/fixsplat-viewer-$version-npm.tgz") >log 2>&1
    cat >npm/program.mjs <<'END'
import { load, png } from 'fixsplat'
import { writeFile } from 'node:fs/promises'
const scene = await load('../knot.ply')
await writeFile('scene.png', await png(scene.render({}, { width: 320, height: 180 }), 320, 180))
process.exit(0)
END
    check "npm: renders" sh -c 'cd npm && node program.mjs && test -s scene.png'
    check "npm: the element's package" test -s npm/node_modules/fixsplat-viewer/element.js
    report npm npm/node_modules/fixsplat npm/node_modules/fixsplat-viewer
else
    skip npm "no npm here"
fi

# ---- Debian packages -------------------------------------------------------------------------------------------------

if have lintian; then
    check "lintian" sh -c 'said=$(lintian --allow-root --fail-on error,warning --suppress-tags \
        initial-upload-closes-no-bugs "$0"/*.deb 2>&1) || { echo "$said"; exit 1; }' "$dist"
else
    skip lintian "no lintian here"
fi
root=$work/root
begin
if [ "$(id -u)" = 0 ] && have mmdebstrap && mmdebstrap --quiet --variant=apt bookworm "$root" >log 2>&1; then
    report "a clean Debian 12" "$root"
    begin
    before=$(du -sk --apparent-size "$root" | cut -f 1)
    cp "$dist"/*.deb knot.ply "$root/tmp"
    # apt installs no recommended packages, because COLMAP, one of them, is large.
    cp /etc/resolv.conf "$root/etc"
    if chroot "$root" sh -c 'apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y \
        --no-install-recommends /tmp/*.deb' >log 2>&1; then
        ok "Debian: installed"
    else
        fail "Debian: installed" "$(tail -n 5 log)"
    fi
    check "Debian: render" equal "$(chroot "$root" fixsplat render /tmp/knot.ply --size 320x180 --hash 2>&1)" "$hash"
    check "Debian: doctor" chroot "$root" fixsplat doctor
    check "Debian: Python" chroot "$root" python3 -c 'import fixsplat
s = fixsplat.load("/tmp/knot.ply")
s.render(s.frame(320, 180)).save("/tmp/python.png")'
    check "Debian: headers" test -e "$root/usr/include/fixsplat/renderer.h"
    echo "Debian packages with what they need: $(($(du -sk --apparent-size "$root" | cut -f 1) - before)) KB"
    report "Debian packages" "$root/usr/include/fixsplat" "$root"/usr/lib/*/libfixsplat* "$root"/usr/bin/fixsplat* \
        "$root/usr/share/fixsplat"
    small "Debian packages" "$root/usr/bin/fixsplat" "$(ls "$root"/usr/lib/*/libfixsplat.so."$version")"
    check "Debian: removed" chroot "$root" apt-get -qq purge -y fixsplat libfixsplat1 libfixsplat-dev python3-fixsplat
    check "Debian: nothing is left" equal "$(find "$root/usr" -name '*fixsplat*' | head -n 3)" ""
else
    for package in "$dist"/*.deb; do dpkg-deb -x "$package" "$root" || fail "Debian: ${package##*/}" dpkg-deb; done
    check "Debian: render" equal "$(LD_LIBRARY_PATH=$(echo "$root"/usr/lib/*-linux-gnu) \
        "$root/usr/bin/fixsplat" render knot.ply --size 320x180 --hash 2>&1)" "$hash"
    report "Debian packages, unpacked" "$root"
    small "Debian packages" "$root/usr/bin/fixsplat" "$(ls "$root"/usr/lib/*/libfixsplat.so."$version")"
fi
finish
