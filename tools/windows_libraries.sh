#!/bin/sh
# tools/windows_libraries.sh FOLDER: the libraries that `make windows` links in, as FOLDER/include and FOLDER/lib: from
# Debian's sources with its patches, each by its own build, and anew when those installed here change. They come from
# this system's Debian repositories, by apt, which checks signatures, and whose own state stays as it is. What fails is
# named, and the program is built without it. zlib is Debian's package libz-mingw-w64-dev.
folder=${1:?folder}
machine=x86_64-w64-mingw32
packages='libcjson-dev libexpat1-dev libpng-dev libjpeg62-turbo-dev libwebp-dev libexif-dev libzip-dev libdeflate-dev
          libzstd-dev'

wanted=$(dpkg-query -W -f='${Package} ${source:Version}\n' $packages 2>/dev/null; cksum <"$0")
printf '%s\n' "$wanted" | cmp -s - "$folder/versions" && exit
command -v $machine-gcc >/dev/null || { echo "setup: no libraries for Windows: no $machine-gcc" >&2; exit 0; }

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

# The newest version that the repositories still have all files of.
fetch() {
    for version in $(apt apt-cache showsrc --only-source "$1" | sed -n 's/^Version: //p' | sort -ruV); do
        apt apt-get source --only-source "$1=$version" && return
    done
    return 1
}

# made_by_cmake SOURCE OPTION...: builds and installs.
made_by_cmake() {
    source=$1
    shift
    cmake -S "$source" -B "$source/made" -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_SYSTEM_PROCESSOR=x86_64 \
        -DCMAKE_C_COMPILER=$machine-gcc -DCMAKE_RC_COMPILER=$machine-windres -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_FIND_ROOT_PATH="$there;/usr/$machine" -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER \
        -DCMAKE_INSTALL_PREFIX="$there" -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF "$@" &&
        cmake --build "$source/made" -j "$(nproc)" && cmake --install "$source/made"
}

build_cjson() { made_by_cmake "$1" -DENABLE_CJSON_TEST=OFF -DENABLE_CUSTOM_COMPILER_FLAGS=OFF; }
# A patch of Debian's asks for the value of XML_DTD, which the CMake file gives it none of.
build_expat() {
    sed -i 's/^#cmakedefine XML_DTD$/& 1/' "$1/expat/expat_config.h.cmake" &&
        made_by_cmake "$1/expat" $(printf -- '-DEXPAT_%s=OFF ' SHARED_LIBS BUILD_TOOLS BUILD_EXAMPLES BUILD_TESTS)
}
build_libpng1_6() { made_by_cmake "$1" -DPNG_SHARED=OFF -DPNG_TESTS=OFF; }
build_libjpeg_turbo() {
    made_by_cmake "$1" -DENABLE_SHARED=OFF -DWITH_TURBOJPEG=OFF -DCMAKE_INSTALL_LIBDIR="$there/lib"
}
build_libwebp() {
    made_by_cmake "$1" $(printf -- '-DWEBP_BUILD_%s=OFF ' ANIM_UTILS CWEBP DWEBP GIF2WEBP IMG2WEBP VWEBP WEBPINFO \
        LIBWEBPMUX WEBPMUX EXTRAS)
}
# Its configure is not in the source.
build_libexif() {
    (cd "$1" && : >config.h && echo '#include <stdint.h>' >libexif/_stdint.h &&
        $machine-gcc -O2 -I. -DGETTEXT_PACKAGE='"libexif"' -c libexif/*.c libexif/*/*.c &&
        $machine-ar rcs "$there/lib/libexif.a" ./*.o && mkdir -p "$there/include/libexif" &&
        cp libexif/*.h "$there/include/libexif/")
}
build_libzip() {
    made_by_cmake "$1" $(printf -- '-DENABLE_%s=OFF ' COMMONCRYPTO GNUTLS MBEDTLS OPENSSL WINDOWS_CRYPTO BZIP2 LZMA) \
        $(printf -- '-DBUILD_%s=OFF ' TOOLS REGRESS EXAMPLES DOC)
}
build_libdeflate() {
    make -C "$1" -j "$(nproc)" CC=$machine-gcc libdeflatestatic.lib &&
        cp "$1/libdeflate.h" "$there/include/" && cp "$1/libdeflatestatic.lib" "$there/lib/libdeflate.a"
}
build_libzstd() {
    make -C "$1/lib" -j "$(nproc)" CC=$machine-gcc AR=$machine-ar ZSTD_LEGACY_SUPPORT=0 libzstd.a &&
        cp "$1/lib/zstd.h" "$1/lib/zstd_errors.h" "$there/include/" && cp "$1/lib/libzstd.a" "$there/lib/"
}

# Each takes nothing but zlib.
build_all() {
    for name in cjson expat libpng1.6 libjpeg-turbo libwebp libexif libzip libdeflate libzstd; do
        log=$folder/$name.log
        { fetch $name && build_$(echo $name | tr -- -. __) "$(echo "$work/$name"-[0-9]*/)"; } >"$log" 2>&1 &&
            rm "$log" || echo "setup: no $name for Windows: see $log" >&2
    done
}

echo "setup: building libraries for Windows"
mkdir -p "$folder" && folder=$(cd "$folder" && pwd) && work=$(mktemp -d "$folder/fetch.XXXXXX") && cd "$work" || exit
trap 'rm -rf "$work"' EXIT
there=$folder
rm -f "$folder"/*.log
mkdir -p "$there/include" "$there/lib"
said=$(list_sources 2>&1) || { printf '%s\n' "setup: no libraries for Windows: $said" >&2; exit 0; }
cp -r /usr/include/stb "$there/include/"        # of libstb-dev: headers alone
build_all
[ -n "$(ls "$folder"/*.log 2>/dev/null)" ] || printf '%s\n' "$wanted" >"$folder/versions"
exit 0
