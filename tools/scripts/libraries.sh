#!/bin/sh
# libraries.sh FOLDER MACHINE: builds the static libraries that `make dist` and `make windows` link, with the compiler
# MACHINE-gcc. Results go to FOLDER/include and FOLDER/lib. The sources are Debian's; Debian's own static libraries lack
# -fPIC or have more dependencies. apt checks the signatures, and its state is unchanged. A failed library is reported,
# and the others remain usable.
folder=${1:?folder} machine=${2:?machine}
# Clears variables that are meant for another target.
unset MAKEFLAGS MAKELEVEL MFLAGS CC CXX AR CFLAGS CPPFLAGS LDFLAGS LIBS
names='libdeflate libzstd cjson expat libpng1.6 libjpeg-turbo libwebp libexif libzip libmicrohttpd qrencode'
packages='libcjson-dev libexpat1-dev libpng-dev libjpeg62-turbo-dev libwebp-dev libexif-dev libzip-dev zlib1g-dev
          libdeflate-dev libzstd-dev libmicrohttpd-dev libqrencode-dev'
case $machine in
    *-mingw32) system=Windows flags='' libdeflate=libdeflatestatic.lib headers=stb
               # The window program needs these libraries; on Linux, it uses shared libraries instead.
               names="$names freetype libsdl2 libsdl2-ttf"
               packages="$packages libfreetype-dev libsdl2-dev libsdl2-ttf-dev" ;;
    *)         system=Linux flags='-fPIC -fvisibility=hidden' libdeflate=libdeflate.a
               names="zlib $names"
               own=$(cc -print-multiarch)
               headers="EGL GLES2 GLES3 KHR GL stb $own/libheif $own/curl" ;;
esac

wanted=$(dpkg-query -W -f='${Package} ${source:Version}\n' $packages 2>/dev/null; cksum <"$0")
printf '%s\n' "$wanted" | cmp -s - "$folder/versions" ||
    rm -rf "$folder/include" "$folder/lib" "$folder/licences"
missing=
for name in $names; do [ -e "$folder/licences/$name" ] || missing="$missing $name"; done
[ "$missing" ] || exit 0
command -v "$machine-gcc" >/dev/null || { echo "no libraries for $machine: no $machine-gcc" >&2; exit 1; }

apt() {
    program=$1
    shift
    LC_ALL=C $program -qq -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/none" \
        -o Dir::State::lists="$work/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache= \
        -o APT::Sandbox::User= -o Debug::NoLocking=1 "$@"
}

list_sources() {
    mkdir -p "$work/lists/partial" "$work/none" &&
        apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Origin: Debian' \
            'Created-By: Packages' | sort -ru >"$work/sources.list" && apt apt-get update
}

# fetch SOURCE: fetches the newest version of a Debian source package that is complete. For qrencode the original source
# is enough, because Debian does not patch the library.
fetch() {
    for version in $(apt apt-cache showsrc --only-source "$1" | sed -n 's/^Version: //p' | sort -ruV); do
        apt apt-get source --only-source "$1=$version" && return
    done
    [ "$1" = qrencode ] && apt apt-get source --tar-only --only-source qrencode && tar -xf qrencode_*.orig.tar.* &&
        original=$(echo qrencode-[0-9]*) && mkdir -p "$original/debian" &&
        cp /usr/share/doc/libqrencode-dev/copyright "$original/debian/"
}

made_by_cmake() {
    source=$1
    shift
    cmake -S "$source" -B "$source/made" -DCMAKE_SYSTEM_NAME=$system -DCMAKE_SYSTEM_PROCESSOR="${machine%%-*}" \
        -DCMAKE_C_COMPILER="$machine-gcc" -DCMAKE_RC_COMPILER="$machine-windres" \
        -DCMAKE_C_FLAGS="$flags" -DCMAKE_C_FLAGS_RELEASE='-O2 -DNDEBUG' \
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_ROOT_PATH="$there;/usr/$machine" \
        -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
        -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_INSTALL_PREFIX="$there" -DCMAKE_INSTALL_LIBDIR="$there/lib" \
        -DBUILD_SHARED_LIBS=OFF "$@" &&
        cmake --build "$source/made" -j "$(nproc)" && cmake --install "$source/made"
}
made_by_configure() {
    source=$1
    shift
    (cd "$source" && ./configure --host="$machine" --prefix="$there" --disable-shared --enable-static "$@" \
        CFLAGS="-O2 -DNDEBUG $flags" && make -j "$(nproc)" && make install)
}

build_zlib() {
    (cd "$1" && CC=$machine-gcc AR=$machine-ar RANLIB=$machine-ranlib CFLAGS="-O2 $flags" \
        ./configure --static --prefix="$there" && make -j "$(nproc)" libz.a && make install)
}
build_cjson() { made_by_cmake "$1" -DENABLE_CJSON_TEST=OFF -DENABLE_CUSTOM_COMPILER_FLAGS=OFF; }
# Debian's patch uses the value of XML_DTD, which the CMake template leaves undefined.
build_expat() {
    sed -i 's/^#cmakedefine XML_DTD$/& 1/' "$1/expat/expat_config.h.cmake" &&
        made_by_cmake "$1/expat" $(printf -- '-DEXPAT_%s=OFF ' SHARED_LIBS BUILD_TOOLS BUILD_EXAMPLES BUILD_TESTS)
}
build_libpng1_6() { made_by_cmake "$1" -DPNG_SHARED=OFF -DPNG_TESTS=OFF; }
build_libjpeg_turbo() {
    made_by_cmake "$1" -DENABLE_SHARED=OFF -DWITH_TURBOJPEG=OFF
}
build_libwebp() {
    made_by_cmake "$1" $(printf -- '-DWEBP_BUILD_%s=OFF ' ANIM_UTILS CWEBP DWEBP GIF2WEBP IMG2WEBP VWEBP WEBPINFO \
        LIBWEBPMUX WEBPMUX EXTRAS)
}
# The source of libexif has no configure script.
build_libexif() {
    (cd "$1" && : >config.h && echo '#include <stdint.h>' >libexif/_stdint.h &&
        $machine-gcc -O2 $flags -I. -DGETTEXT_PACKAGE='"libexif"' -c libexif/*.c libexif/*/*.c &&
        $machine-ar rcs "$there/lib/libexif.a" ./*.o && mkdir -p "$there/include/libexif" &&
        cp libexif/*.h "$there/include/libexif/")
}
build_libzip() {
    made_by_cmake "$1" $(printf -- '-DENABLE_%s=OFF ' COMMONCRYPTO GNUTLS MBEDTLS OPENSSL WINDOWS_CRYPTO BZIP2 LZMA) \
        $(printf -- '-DBUILD_%s=OFF ' TOOLS REGRESS EXAMPLES DOC)
}
build_libdeflate() {
    make -C "$1" -j "$(nproc)" CC="$machine-gcc" AR="$machine-ar" CFLAGS="-O2 $flags" $libdeflate &&
        cp "$1/libdeflate.h" "$there/include/" && cp "$1/$libdeflate" "$there/lib/libdeflate.a"
}
build_libzstd() {
    make -C "$1/lib" -j "$(nproc)" CC="$machine-gcc" AR="$machine-ar" CFLAGS="-O2 $flags" ZSTD_LEGACY_SUPPORT=0 \
        libzstd.a && cp "$1/lib/zstd.h" "$1/lib/zstd_errors.h" "$there/include/" && cp "$1/lib/libzstd.a" "$there/lib/"
}
build_libmicrohttpd() {
    made_by_configure "$1" --disable-doc --disable-examples --disable-tools --disable-https --disable-curl
}
build_qrencode() { made_by_cmake "$1" -DWITH_TOOLS=NO -DWITHOUT_PNG=ON; }

build_freetype() {
    made_by_cmake "$1" -DFT_REQUIRE_ZLIB=ON $(printf -- '-DFT_DISABLE_%s=ON ' BZIP2 PNG HARFBUZZ BROTLI)
}
# Builds SDL with windows, events and pixels only, without C++.
build_libsdl2() {
    sed -i 's/^project(SDL2 C CXX)/project(SDL2 C)/' "$1/CMakeLists.txt" &&
        made_by_cmake "$1" -DSDL_SHARED=OFF -DSDL_STATIC=ON -DSDL_TEST=OFF -DSDL2_DISABLE_SDL2MAIN=ON \
            $(printf -- '-DSDL_%s=OFF ' AUDIO RENDER JOYSTICK HAPTIC HIDAPI SENSOR POWER DIRECTX OPENGL OPENGLES VULKAN)
}
build_libsdl2_ttf() {
    (cd "$1" && $machine-gcc -O2 $flags -DTTF_USE_HARFBUZZ=0 -I"$there/include/SDL2" -I"$there/include/freetype2" \
        -c SDL_ttf.c && $machine-ar rcs "$there/lib/libSDL2_ttf.a" SDL_ttf.o && cp SDL_ttf.h "$there/include/SDL2/")
}

# Links folders of Debian's headers that do not depend on the processor.
link_headers() {
    for header in $headers; do
        [ ! -d "/usr/include/$header" ] || ln -sfn "/usr/include/$header" "$there/include/${header##*/}" || return
    done
}

build() {
    fetch "$1" && build_"$(echo "$1" | tr -- -. __)" "$(echo "$work/$1"-[0-9]*/)" &&
        cp "$work/$1"-[0-9]*/debian/copyright "$there/licences/$1"
}

mkdir -p "$folder" && work=$(mktemp -d "$folder/fetch.XXXXXX") && cd "$work" && work=$PWD && there=${work%/*} || exit
trap 'rm -rf "$work"' EXIT
mkdir -p "$there/include" "$there/lib" "$there/licences" && printf '%s\n' "$wanted" >"$there/versions" &&
    link_headers || exit
flags="$flags -ffile-prefix-map=$work=."
echo "libraries for $machine, from Debian's sources:$missing"
status=0
said=$(list_sources 2>&1) || { printf '%s\n' "no libraries for $machine: $said" >&2; exit 1; }
for name in $missing; do
    log=$there/$name.log
    build "$name" >"$log" 2>&1 && rm "$log" && continue
    echo "no $name for $machine ($log): $(grep -m 1 -iE 'error(:| at )' "$log" || tail -n 1 "$log")" >&2
    [ "$name" = qrencode ] && echo '#error its source could not be had' >"$there/include/qrencode.h" || status=1
done
exit $status
