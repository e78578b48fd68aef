#!/bin/sh
# Tests the npm packages as programs use them (docs/web.md). They are packed, installed, built by the bundlers of
# tests/web/bundlers and without a bundler, opened in Chromium, and checked by TypeScript. FXS_PROCESSORS=all: tests
# every bundler; default: some. ONLY=PATTERN: tests only cases whose names match. PICTURES=FOLDER keeps pictures of
# failures.
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

# ready TARBALL NAME FILE...: checks the tarball of an npm package. It must have the FILEs, the files that the registry
# shows, the library's version, and no file without use for programs.
ready() {
    at=$work/entries/node_modules/$2
    mkdir -p "$at" && tar xzf "$1" -C "$at" --strip-components=1 || return 1
    shift 2
    for file in README.md LICENSE CHANGELOG.md "$@"; do
        [ -s "$at/$file" ] || { echo "no $file"; return 1; }
    done
    grep -q '^## ' "$at/CHANGELOG.md" && ! grep -rl '@VERSION@\|@FORMATS@' "$at" &&
        ! find "$at" -name '*.c' -o -name '*.h' | grep . &&
        equal "$(node -p 'require(process.argv[1]).version' "$at/package.json")" "$version"
}

# Package files for browsers must not import from Node, nor use top-level await.
entries() {
    cd "$work/entries/node_modules" && node -e '
        const files = (entry) => typeof entry === "string" ? [entry] : Object.values(entry).flatMap(files)
        for (const name of ["fixsplat", "fixsplat-viewer"])
            for (const file of files(require(`./${name}/package.json`).exports))
                if (!file.includes("*")) require("fs").accessSync(`${name}/${file}`)' &&
        esbuild fixsplat/fixsplat.js fixsplat/thread.js fixsplat-viewer/react.js fixsplat-viewer/inline.js \
            fixsplat-viewer/worker_whole.js --bundle --format=iife --outdir="$work/entries/out" --log-level=error
}

minified() {
    for entry in fixsplat-viewer/element.js fixsplat-viewer/worker_whole.js fixsplat-viewer/worker.js fixsplat/thread.js; do
        set -- --external:./xr.js --external:./ar.js --external:./drop.js --external:./words.js --external:./tour.js --external:./film.js '--external:./language_*.js' \
            --external:./look.js --external:./edit.js --external:./moving.js --external:./walk.js --external:./gamepad.js --external:./joystick.js
        [ $entry != fixsplat-viewer/worker.js ] || set -- "$@" --external:./webgpu.js --external:./paged.js --external:./editor.js --external:./sky.js
        esbuild "$work/entries/node_modules/$entry" --bundle --minify --format=esm --outfile="$work/minified/$entry" "$@" --log-level=error ||
            return 1
    done
}

check "builds" builds web-package
version=$("$B/fixsplat" --version | sed 's/[^ ]* //')
tarball=$B/web/fixsplat-$version.tgz viewer=$B/web/fixsplat-viewer-$version.tgz
check "fixsplat is ready to publish" ready "$tarball" fixsplat fixsplat.d.ts inline/files.js
check "fixsplat has no page" sh -c '! tar tzf "$0" | grep -i viewer' "$tarball"
check "fixsplat-viewer is ready to publish" ready "$viewer" fixsplat-viewer viewer.d.ts playcanvas.d.ts react.d.ts three.d.ts \
    inline_worker.js page/index.html page/viewer.js
check "its entries" eval "(entries)"
check "is minified" minified
check "size of the element" at_most 45800 "$work/minified/fixsplat-viewer/element.js" \
    "$work/minified/fixsplat-viewer/worker.js" "$work/minified/fixsplat/thread.js"
# Includes the code for WebGPU (page.sh has its size) and 1 KB for editing by hand.
check "size of the element in a bundle" at_most 86600 "$work/minified/fixsplat-viewer/element.js" \
    "$work/minified/fixsplat-viewer/worker_whole.js" "$work/minified/fixsplat/thread.js"
"$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply" >/dev/null
if node tests/web/types.mjs "$tarball" "$viewer" "$tools" "$modules" $all >"$work/asked" 2>&1; then TYPES=yes; else TYPES=no; fi
export TYPES
[ "$TYPES" = yes ] || grep -q '^FAIL' "$work/asked" || echo "FAIL types.mjs: ended early" >>"$work/asked"
counts
node tests/web/bundlers.mjs "$tarball" "$viewer" "$work" "$tools" "$modules" "$B/fixsplat" $all >"$work/asked" 2>&1 ||
    echo "FAIL bundlers.mjs: a check above, or it ended early" >>"$work/asked"
counts
cat "$work/sizes"
finish
