#!/bin/sh
# tools/web_sources.sh FOLDER: the sources of the libraries that the web port compiles in, from the Debian repositories of
# this system, with Debian's patches: FOLDER/cjson and so on. apt checks signatures; its configuration stays as it is.
folder=${1:?folder}
names='cjson libwebp libzip libzstd zlib'

# Source package and version of what is installed there; which are those of the native build.
wanted=$(dpkg-query -W -f='${source:Package}=${source:Version}\n' \
    libcjson-dev libwebp-dev libzip-dev libzstd-dev zlib1g-dev 2>/dev/null | sort -u)
[ "$wanted" ] || { echo "setup: no Debian packages here, so no sources for the web port" >&2; exit 1; }
printf '%s\n' "$wanted" | cmp -s - "$folder/versions" && exit
command -v dpkg-source >/dev/null || { echo "setup: no dpkg-source" >&2; exit 1; }

mkdir -p "$folder" && work=$(mktemp -d "$folder/fetch.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/lists/partial" "$work/parts"
apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Origin: Debian' 'Created-By: Packages' |
    sort -ru >"$work/sources.list"
apt() {
    LC_ALL=C apt-get -qq -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/parts" \
        -o Dir::State::lists="$work/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache= \
        -o APT::Sandbox::User= -o Debug::NoLocking=1 "$@"
}
echo "setup: fetching sources for the web port:" $wanted
cd "$work" && apt update && apt source --only-source $wanted >/dev/null || exit 1
for name in $names; do
    rm -rf "../$name" && mv "$name"-*/ "../$name" || exit 1
done
printf '%s\n' "$wanted" >../versions
