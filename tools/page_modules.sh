#!/bin/sh
# tools/page_modules.sh FOLDER: what the tests of the viewer's page and of convert need of npm (tests/web/package.json).
# Where npm or the network is missing, they are skipped.
folder=$1
command -v npm >/dev/null || { echo "setup: no npm here, so tests of the page, and some of convert, are skipped"; exit 0; }
cmp -s tests/web/package.json "$folder/package.json" && [ -d "$folder/node_modules/puppeteer-core" ] && exit 0
echo "setup: installing what tests of the page and of convert need, by npm"
mkdir -p "$folder" && cp tests/web/package.json "$folder" || exit 1
npm install --prefix "$folder" --no-audit --no-fund --loglevel=error >/dev/null || {
    rm -f "$folder/package.json"
    echo "setup: npm did not install them, so tests of the page, and some of convert, are skipped"
}
