#!/bin/sh
# arm_libraries.sh FOLDER [PACKAGE...]: unpacks Debian's AArch64 packages into FOLDER/usr, without dependencies.
# Default: libpng, zlib and libjpeg-turbo. apt checks the signatures, with separate lists of packages, so the system's
# state is unchanged.
folder=${1:?folder}
shift
packages=${*:-libpng-dev zlib1g-dev libjpeg62-turbo-dev}
here=$(dpkg-query -W -f='${Package} ${Version}\n' $packages 2>/dev/null)
echo "$here" | cmp -s - "$folder/here" && exit

apt() {
    LC_ALL=C apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 \
        -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/none" \
        -o Dir::State::lists="$work/lists" -o Dir::State::status="$work/status" -o Dir::Cache::srcpkgcache= \
        -o Dir::Cache::pkgcache= -o APT::Sandbox::User= -o Debug::NoLocking=1 "$@"
}

fetch() {
    mkdir -p "$work/lists/partial" "$work/none" && : >"$work/status" &&
        apt-get indextargets --format 'deb [arch=arm64] $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Origin: Debian' \
            'Created-By: Packages' | sort -ru >"$work/sources.list" &&
        apt update && apt download $packages &&
        for package in ./*.deb; do dpkg -x "$package" .. || return; done && echo "$here" >../here
}

echo "setup: fetching for AArch64: $packages"
mkdir -p "$folder" && work=$(mktemp -d "$folder/fetch.XXXXXX") && cd "$work" && work=$PWD || exit
trap 'rm -rf "$work"' EXIT
said=$(fetch 2>&1) || printf '%s\n' "setup: no libraries for AArch64: $said" >&2
exit 0
