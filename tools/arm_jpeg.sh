#!/bin/sh
# tools/arm_jpeg.sh FOLDER: Debian's libjpeg-turbo for AArch64, in the version that is installed, as FOLDER/usr: for the
# photographs of tests/scripts/processors.sh. By apt, which checks signatures, with lists of its own that know of no
# other processor; the system's own state stays as it is. Where that fails, the test is skipped.
folder=${1:?folder}
wanted=libjpeg62-turbo-dev=$(dpkg-query -W -f='${Version}' libjpeg62-turbo-dev 2>/dev/null)
echo "$wanted" | cmp -s - "$folder/version" && exit

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
        apt update && apt download "$wanted" && dpkg -x ./*.deb .. && echo "$wanted" >../version
}

echo "setup: fetching libjpeg-turbo for AArch64"
mkdir -p "$folder" && work=$(mktemp -d "$folder/fetch.XXXXXX") && cd "$work" && work=$PWD || exit
trap 'rm -rf "$work"' EXIT
said=$(fetch 2>&1) || printf '%s\n' "setup: no libjpeg-turbo for AArch64: $said" >&2
exit 0
