#!/bin/sh
# web_sources.sh FOLDER: fetches Debian's sources of the libraries for the web port, in the installed versions if the
# mirror has them, else the mirror's. apt checks the signatures, and its state is unchanged. Without these libraries, the
# web port lacks some features.
folder=${1:?folder}
names='cjson libwebp libzip libzstd zlib'
packages='libcjson-dev libwebp-dev libzip-dev libzstd-dev zlib1g-dev'

wanted=$(dpkg-query -W -f='${source:Package}=${source:Version}\n' $packages 2>/dev/null | sort -u)
printf '%s\n' "$wanted" | cmp -s - "$folder/versions" && exit

apt() {
    LC_ALL=C apt-get -qq -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/none" \
        -o Dir::State::lists="$work/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache= \
        -o APT::Sandbox::User= -o Debug::NoLocking=1 "$@"
}

# Sources are listed in reverse order, so that a Debian suite precedes its security updates if both have the same
# version.
fetch() {
    mkdir -p "$work/lists/partial" "$work/none" &&
        apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Origin: Debian' \
            'Created-By: Packages' | sort -ru >"$work/sources.list" &&
        apt update && { apt source --only-source $wanted || without_updates; }
}

# Fetches the sources of the Debian suite alone: a mirror may lack those of a security update. The next setup tries
# again to fetch the installed versions.
without_updates() {
    sed -i '/-security /d; /-updates /d' "$work/sources.list"
    apt update && apt source --only-source $names && wanted=$(ls ./*.dsc | sed 's|^\./||; s/_/=/; s/\.dsc$//')
}

# Generates the error messages of libzip from its header.
name_errors() {
    echo '#include "zipint.h"'
    echo 'const char *const _zip_err_str[] = {'
    sed -n 's|^#define ZIP_ER_.*/\* [NSZ] \(.*\) \*/|    "\1",|p' "$1"
    printf '%s\n' '};' 'const int _zip_nerr_str = sizeof _zip_err_str / sizeof *_zip_err_str;' 'enum { N, S, Z };' \
        'const int _zip_err_type[] = {'
    sed -n 's|^#define ZIP_ER_.*/\* \([NSZ]\) .*|    \1,|p' "$1"
    echo '};'
}

# Replaces the sources in FOLDER. A missing file FOLDER/versions marks an interrupted replacement.
take() {
    rm -f ../versions
    for name in $names; do
        rm -rf "../$name" && mv "$name"-*/ "../$name" || return
    done
    name_errors ../libzip/lib/zip.h >../libzip/lib/zip_err_str.c && printf '%s\n' "$wanted" >../versions
}

echo "setup: fetching sources for the web port"
mkdir -p "$folder" && work=$(mktemp -d "$folder/fetch.XXXXXX") && cd "$work" || exit
trap 'rm -rf "$work"' EXIT
said=$( { fetch && take; } 2>&1) || printf '%s\n' "setup: no sources for the web port: $said" >&2
exit 0
