#!/bin/sh
# tools/page_modules.sh FOLDER [SOURCE [part]]: what the tests of the viewer's page and of convert need of npm: the very
# files of tests/web/package-lock.json, or of another folder's, of which none is run to install it; with `part` but its
# devDependencies. Where npm or the network is missing, they are skipped.
folder=$1 source=${2:-tests/web} part=${3:+--omit=dev}
stamp=$folder/package-lock.json${part:+.part}
command -v npm >/dev/null || { echo "setup: no npm here, so tests of the page, and some of convert, are skipped"; exit 0; }
for one in "$folder/package-lock.json" "$stamp"; do
    cmp -s "$source/package-lock.json" "$one" && [ -d "$folder/node_modules" ] && exit 0
done
echo "setup: installing what tests of $source need, by npm"
rm -f "$folder"/package-lock.json*
mkdir -p "$folder" && cp -f "$source/package.json" "$source/package-lock.json" "$folder" || exit 1
npm ci --prefix "$folder" --ignore-scripts --no-audit --no-fund --loglevel=error $part >/dev/null || {
    rm -f "$folder/package-lock.json"
    echo "setup: npm did not install them, so tests of the page, and some of convert, are skipped"
    exit 0
}
[ -z "$part" ] || mv -f "$folder/package-lock.json" "$stamp"
