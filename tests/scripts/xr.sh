#!/bin/sh
# The viewer in a headset (docs/web.md), which iwer plays in headless Chromium: the pixels of the command in both eyes,
# controllers, sizes that follow the time, and the page before, after and when something goes wrong.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
package=$B/web/package
modules=${NODE_MODULES:-$B/page/node_modules}

missing=
for program in clang wasm-ld wasm-opt node chromium; do have $program || missing="$missing $program"; done
for module in puppeteer-core iwer; do
    [ -d "$modules/$module" ] || missing="$missing $module (make setup test)"
done
if [ -n "$missing" ]; then
    skip xr "not here:$missing"
    finish
    exit
fi

builds() {
    said=$(env -u MAKEFLAGS make -s B="$B" NVCC=none web 2>&1 | grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

check "builds" builds
check "makes a scene" "$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply"
node tests/web/xr.mjs "$package" "$work" "$modules" "$work" "$B/fixsplat" >"$work/xr" 2>&1 ||
    echo "FAIL xr: a check above, or it ended early" >>"$work/xr"
cat "$work/xr"
passed=$((passed + $(grep -c '^ok ' "$work/xr"))) failed=$((failed + $(grep -c '^FAIL ' "$work/xr")))
finish
