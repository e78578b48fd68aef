#!/bin/sh
# Tests the npm package in programs: installed, bundled, opened in Chromium, and checked by TypeScript.
# FXS_PROCESSORS=all tests every bundler. ONLY=PATTERN selects cases. PICTURES=FOLDER keeps pictures of failures.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs bundlers chromium esbuild npm -- puppeteer-core playcanvas
tools=$B/bundlers/node_modules
all=
[ "$FXS_PROCESSORS" = all ] && all=all
missing=vite
[ "$all" ] && missing=next
if [ ! -d "$tools/$missing" ]; then
    skip bundlers "no $missing: make setup test${all:+-all}"
    finish
    exit
fi

ready() {
    tar xzf "$tarball" -C "$work" || return 1
    for file in README.md LICENSE CHANGELOG.md fixsplat.d.ts playcanvas.d.ts react.d.ts three.d.ts viewer/viewer.d.ts inline/worker.js; do
        [ -s "$work/package/$file" ] || { echo "no $file"; return 1; }
    done
    grep -q '^## ' "$work/package/CHANGELOG.md" && ! grep -rl '@VERSION@\|@FORMATS@' "$work/package" &&
        ! find "$work/package" -name '*.c' -o -name '*.h' | grep . &&
        equal "$(node -p 'require(process.argv[1]).version' "$work/package/package.json")" "$("$B/fixsplat" --version | sed 's/[^ ]* //')"
}

# Files for browsers must not import from Node, nor use top-level await.
entries() {
    cd "$work/package" && node -e '
        const files = (entry) => typeof entry === "string" ? [entry] : Object.values(entry).flatMap(files)
        const { exports } = require("./package.json")
        for (const file of files(exports)) if (!file.includes("*")) require("fs").accessSync(file)' &&
        esbuild fixsplat.js thread.js react.js inline/viewer_with_files.js viewer/worker_whole.js --bundle --format=iife \
            --outdir="$work/entries" --log-level=error
}

minified() {
    for entry in viewer/element.js viewer/worker_whole.js viewer/worker.js thread.js; do
        set -- --external:./xr.js --external:./ar.js --external:./drop.js --external:./words.js --external:./tour.js --external:./film.js '--external:./language_*.js' \
            --external:./walk.js --external:./gamepad.js --external:./joystick.js
        [ $entry != viewer/worker.js ] || set -- "$@" --external:./webgpu.js --external:./paged.js --external:./sky.js
        esbuild "$package/$entry" --bundle --minify --format=esm --outfile="$work/minified/$entry" "$@" --log-level=error ||
            return 1
    done
}

check "builds" builds web-package
tarball=$(ls "$B"/web/fixsplat-*.tgz)
check "is ready to publish" ready
check "its entries" eval "(entries)"
check "is minified" minified
check "size of the element" at_most 43000 "$work/minified/viewer/element.js" "$work/minified/viewer/worker.js" \
    "$work/minified/thread.js"
check "size of the element in a bundle" at_most 76500 "$work/minified/viewer/element.js" \
    "$work/minified/viewer/worker_whole.js" "$work/minified/thread.js"
"$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply" >/dev/null
if node tests/web/types.mjs "$tarball" "$tools" "$modules" $all >"$work/asked" 2>&1; then TYPES=yes; else TYPES=no; fi
export TYPES
[ "$TYPES" = yes ] || grep -q '^FAIL' "$work/asked" || echo "FAIL types.mjs: ended early" >>"$work/asked"
counts
node tests/web/bundlers.mjs "$tarball" "$work" "$tools" "$modules" "$B/fixsplat" $all >"$work/asked" 2>&1 ||
    echo "FAIL bundlers.mjs: a check above, or it ended early" >>"$work/asked"
counts
cat "$work/sizes"
finish
