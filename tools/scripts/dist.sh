#!/bin/sh
# dist.sh OUT BUILD: builds a release of the last commit in the folder OUT. A release has sources, a tarball and a wheel
# per processor, a zip and a wheel for Windows, Debian packages, the npm packages, the page index.html, and SHA256SUMS. The build is
# reproducible. Environment variables: NVCC, PYTHON, WEB_SOURCES.
set -e
final=${1:?folder} build=${2:?build folder}
unset MAKEFLAGS MAKELEVEL MFLAGS
umask 022
mkdir -p "$build" "$(dirname "$final")"
build=$(cd "$build" && pwd)
final=$(cd "$(dirname "$final")" && pwd)/$(basename "$final")
version=$(sed -n 's/^#define FXS_VERSION "\(.*\)"/\1/p' src/include/fixsplat/fixsplat.h)
name=fixsplat-$version
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH LC_ALL=C TZ=UTC
"$PYTHON" -c 'import setuptools, wheel, pip' 2>/dev/null || PYTHON=/usr/bin/python3
out=$build/out source=$build/$name
rm -rf "$out"
mkdir "$out"
here=$(uname -m)
git diff --quiet HEAD || echo "dist: of the last commit, without what changed since" >&2

pack() {
    tar -C "${1%/*}" --sort=name --owner=0 --group=0 --numeric-owner --mtime=@"$SOURCE_DATE_EPOCH" --format=gnu \
        -c "${1##*/}" | gzip -9n >"$2"
}

sources() {
    git -c tar.umask=0022 archive --format=tar --prefix="$name/" HEAD | gzip -9n >"$out/$name.tar.gz"
    [ "$(cat "$build/commit" 2>/dev/null)" = "$(git rev-parse HEAD)" ] || rm -rf "$source"
    [ -d "$source" ] || tar -C "$build" -xzf "$out/$name.tar.gz"
    git rev-parse HEAD >"$build/commit"
}

npm_packages() {
    make -s WEB_SOURCES="$WEB_SOURCES" web-package
    cp "build/web/$name.tgz" "$out/$name-npm.tgz"
    cp "build/web/fixsplat-viewer-$version.tgz" "$out/fixsplat-viewer-$version-npm.tgz"
}

# needs FILE: prints the shared libraries of a program, except glibc's.
needs() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -Ev '^(lib(c|m)\.so\.6|ld-linux-.*)$' || :; }

# complete ARCHIVE LIBRARY...: adds the object files of other static libraries to the static library ARCHIVE.
complete() {
    archive=$1
    {
        echo "create $archive.new"
        for library; do
            case $library in
            */libSDL2*.a | */libfreetype.a | */libmicrohttpd.a | */libqrencode.a) ;;
            */libstdc++.a | */libpng.a | */libwebpde*.a) ;;
            *) echo "addlib $library" ;;
            esac
        done
        echo save
        echo end
    } | "$machine-ar" -M
    "$machine-strip" --strip-unneeded "$archive.new"
    mv "$archive.new" "$archive"
}

# relocate FOLDER LIBS: makes paths in the pkg-config and CMake files relative to their own folder.
relocate() {
    sed -i -e 's|^prefix=.*|prefix=${pcfiledir}/../..|' -e 's|^libdir=.*|libdir=${prefix}/lib|' \
        -e "s|^Libs.private:.*|Libs.private: $2|" "$1"/lib/pkgconfig/*.pc
    sed -i -e 's|/usr/local/|${CMAKE_CURRENT_LIST_DIR}/../../../|g' \
        -e "s|\(INTERFACE_LINK_LIBRARIES \"\)[^\"]*-lm.*\"|\1$2\"|" "$1"/lib/cmake/fixsplat/fixsplat-config.cmake
}

documents() {
    documents=$folder/share/doc/fixsplat
    mkdir -p "$documents/licences"
    cp -r LICENSE NEWS.md README.md CONTRIBUTING.md SECURITY.md docs "$documents"
    # Adapts links in the documentation. Links to headers and to the viewer's page get their installed paths. Links to
    # source files become plain text.
    find "$documents" -name '*.md' -exec sed -i -E \
        -e 's#\]\(((\.\./)*)src/include/#](\1../../../include/#g' \
        -e 's#\]\(((\.\./)*)port/web/#](\1../../fixsplat/web/#g' \
        -e 's#\[([^]]*)\]\((\.\./)*(src|port)(/[^)]*)?\)#\1#g' {} +
    cp "$libraries"/licences/* "$documents/licences"
    cp tools/package/licences.md "$documents/licences/README.md"
}

linux() {
    machine=$1 arch=$2 libraries=$build/libraries/$1
    sh tools/scripts/libraries.sh "$libraries" "$machine"
    cxx=$($machine-gcc -print-file-name=libstdc++.a)
    [ ! -e "$cxx" ] || ln -sf "$cxx" "$libraries/lib/"
    folder=$build/tarball/$name-linux-$arch
    rm -rf "$folder"
    nvcc=$NVCC headers="-isystem $libraries/include" linked="-L$libraries/lib"
    # The program of the viewer's window links Debian's shared libraries.
    [ $arch = "$here" ] || {
        nvcc=none window=$libraries/window/usr
        sh tools/scripts/arm_libraries.sh "$libraries/window" libsdl2-dev libsdl2-2.0-0 libsdl2-ttf-dev libsdl2-ttf-2.0-0
        headers="$headers -isystem $window/include -isystem $window/include/$machine"
        linked="$linked -L$window/lib/$machine -Wl,--allow-shlib-undefined"
    }
    make -s install B=build-$arch CC=$machine-gcc NVCC="$nvcc" CFLAGS=-O2 DESTDIR="$folder" CPPFLAGS="$headers" \
        LDFLAGS="-s -static-libgcc $linked"
    mv "$folder"/usr/local/* "$folder"
    rmdir "$folder/usr/local" "$folder/usr"
    # Programs for another processor cannot run here, so their manuals and completions are copied.
    mkdir -p "$folder/share/fixsplat"
    [ $arch = "$here" ] || for part in man bash-completion fish zsh; do
        cp -r "$build/tarball/$name-linux-$here/share/$part" "$folder/share"
    done
    cp -r build/web/package "$folder/share/fixsplat/web"
    private='-lm -lpthread -ldl'
    cudart=$(sed -n 's/^LIBS_CUDA := .*-L\([^ ]*\) -lcudart_static.*/\1/p' "build-$arch/probe.mk")
    [ -z "$cudart" ] || private="-lstdc++ $private -lrt"
    complete "$folder/lib/libfixsplat.a" "$libraries"/lib/*.a ${cudart:+"$cudart/libcudart_static.a"}
    relocate "$folder" "$private"
    documents
    [ -z "$cudart" ] || cat /usr/share/doc/libstdc++-*-dev/copyright >"$documents/licences/libstdc++"
    for file in "$folder/bin/fixsplat" "$folder/bin/fixsplat-web" "$folder/lib/libfixsplat.so.$version"; do
        [ -z "$(needs "$file")" ] || { echo "dist: $file is linked with $(needs "$file")" >&2; exit 1; }
    done
    pack "$folder" "$out/$name-linux-$arch.tar.gz"
    # The tag of the wheel requires glibc 2.36, as in Debian 12, or later.
    wheel "$folder/lib/libfixsplat.so.$version" manylinux_2_36_$arch
}

wheel() {
    rm -rf "$build/wheel"
    mkdir "$build/wheel"
    cp -r port/python/pyproject.toml port/python/setup.py port/python/fixsplat LICENSE "$build/wheel"
    cat "$documents"/licences/* >"$build/wheel/LICENSE.libraries"
    find "$build/wheel" -name __pycache__ -prune -exec rm -r {} +
    FIXSPLAT_LIBRARY=$1 FIXSPLAT_PLATFORM=$2 \
        "$PYTHON" -m pip wheel --quiet --no-deps --no-build-isolation --disable-pip-version-check \
        --wheel-dir "$out" "$build/wheel"
}

# needs_on_windows FILE: prints the shared libraries of mingw-w64 that a Windows program needs.
needs_on_windows() { "$machine-objdump" -p "$1" | sed -n 's/.*DLL Name: //p' | grep -iE '^lib|^zlib' || :; }

windows() {
    machine=x86_64-w64-mingw32 libraries=$build/libraries/x86_64-w64-mingw32
    command -v $machine-gcc >/dev/null || { echo "dist: no zip for Windows: no $machine-gcc" >&2; return; }
    sh tools/scripts/libraries.sh "$libraries" $machine
    folder=$build/zip/$name-windows-x86_64
    make -s windows B=build CFLAGS=-O2 WINDOWS_LIBRARIES="$libraries"
    rm -rf "$folder"
    mkdir -p "$folder/bin" "$folder/lib" "$folder/include" "$folder/share/fixsplat"
    cp build/windows/fixsplat.exe build/windows/fixsplat-view.exe build/windows/fixsplat-web.exe \
        build/windows/libfixsplat-*.dll "$folder/bin"
    cp build/windows/libfixsplat*.a "$folder/lib"
    cp -r src/include/fixsplat "$folder/include"
    cp -r build/web/package "$folder/share/fixsplat/web"
    complete "$folder/lib/libfixsplat.a" /usr/$machine/lib/libz.a "$libraries"/lib/*.a
    documents
    for package in libz-mingw-w64 mingw-w64-common gcc-mingw-w64-base; do
        cp /usr/share/doc/$package/copyright "$documents/licences/$package"
    done
    for file in "$folder"/bin/*; do
        [ -z "$(needs_on_windows "$file")" ] ||
            { echo "dist: $file is linked with $(needs_on_windows "$file")" >&2; exit 1; }
    done
    find "$folder" -exec touch -d @"$SOURCE_DATE_EPOCH" {} +
    (cd "${folder%/*}" && find "${folder##*/}" -type f | sort | zip -qX9@ "$out/${folder##*/}.zip")
    wheel "$folder/bin/libfixsplat-${version%%.*}.dll" win_amd64
}

# Builds Debian packages. Version 1.0.0-rc1 becomes 1.0.0~rc1, which sorts before 1.0.0.
debian() {
    rm -rf "$build/deb"
    mkdir "$build/deb"
    tar -C "$build/deb" -xzf "$out/$name.tar.gz"
    cp -r tools/package/debian "$build/deb/$name/debian"
    sed '1,/^$/d; s/^$/ ./; s/^\([^ ]\)/ \1/' LICENSE | sed '1,/^ \.$/d' >>"$build/deb/$name/debian/copyright"
    cat >"$build/deb/$name/debian/changelog" <<-END
	fixsplat ($(echo "$version" | sed 's/-/~/')) unstable; urgency=medium

	  * Version $version: see NEWS.md.

	 -- fixsplat maintainers <maintainers@fixsplat.invalid>  $(date -R -d @"$SOURCE_DATE_EPOCH")
	END
    (cd "$build/deb/$name" && NVCC=none DEB_BUILD_OPTIONS="nocheck noautodbgsym parallel=$(nproc)" \
        FXS_PAGE=$source/build/web/package dpkg-buildpackage -b -us -uc -nc --no-check-builddeps) \
        >"$build/deb.log" 2>&1 || { tail -n 30 "$build/deb.log" >&2; exit 1; }
    cp "$build"/deb/*.deb "$out"
}

sources
cd "$source"
npm_packages
linux "$here-linux-gnu" "$here"
[ "$here" = aarch64 ] || linux aarch64-linux-gnu aarch64
windows
debian
sh tools/scripts/downloads.sh "$out" "$version" >"$build/index.html"
mv "$build/index.html" "$out"
(cd "$out" && sha256sum -- * >../SHA256SUMS && mv ../SHA256SUMS .)
rm -rf "$final"
mv "$out" "$final"
ls -l "$final"
