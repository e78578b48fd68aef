#!/bin/sh
# tools/page_modules.sh FOLDER: what the tests of the viewer's page and of convert need of npm: the very files of
# tests/web/package-lock.json, of which none is run to install it. Where npm or the network is missing, they are skipped.
folder=$1
command -v npm >/dev/null || { echo "setup: no npm here, so tests of the page, and some of convert, are skipped"; exit 0; }
cmp -s tests/web/package-lock.json "$folder/package-lock.json" && [ -d "$folder/node_modules/puppeteer-core" ] && exit 0
echo "setup: installing what tests of the page and of convert need, by npm"
mkdir -p "$folder" && cp -f tests/web/package.json tests/web/package-lock.json "$folder" || exit 1
npm ci --prefix "$folder" --ignore-scripts --no-audit --no-fund --loglevel=error >/dev/null || {
    rm -f "$folder/package-lock.json"
    echo "setup: npm did not install them, so tests of the page, and some of convert, are skipped"
}
