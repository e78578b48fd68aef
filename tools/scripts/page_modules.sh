#!/bin/sh
# page_modules.sh FOLDER [SOURCE [part]]: installs the npm modules that SOURCE/package-lock.json lists (default SOURCE:
# tests/web), without their install scripts. With `part`, leaves out devDependencies.
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
