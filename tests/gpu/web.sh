#!/bin/sh
# tests/gpu/web.sh PACKAGE SCENES MODULES: tests the npm packages with WebGPU in headless Chromium, on this machine's
# graphics card. Compares pixels with those of the command fixsplat, for procedural scenes in each profile and for
# SCENES. Then prints milliseconds a frame next to other engines. Takes 3 to 6 minutes.
# PACKAGE: build/web/package, beside build/web/viewer. SCENES: a folder with NAME/NAME.ply for guitar and snowmiku.
# MODULES: a folder node_modules with playcanvas, three and puppeteer-core. CHROMIUM: the browser (default
# /usr/bin/chromium). FXS_WEBGPU_FLAGS: the browser's flags (default: flags that find a graphics card). B: the build
# folder (default build). SIZE: picture size of the pixel comparison (default 1280x720). SIZES, ROUNDS, FRAMES: picture
# sizes, rounds and frames of the measurement of each engine.
cd "$(dirname "$0")/../.." || exit 1
B=${B:-build}
package=$(realpath "$1") scenes=$(realpath "$2") modules=$(realpath "$3")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=
start=$(date +%s)

say() {
    echo "== $* ($(($(date +%s) - start)) s)"
}

say "adapters"
FXS_WEBGPU_FLAGS=$(timeout -k 5 80 node tests/web/adapters.mjs "$modules") || { echo "no adapter of a card"; exit 1; }
export FXS_WEBGPU_FLAGS
echo "flags: $FXS_WEBGPU_FLAGS"

say "scenes"

made() {
    name=$1
    "$B/fixsplat" make-scene "$2" --count "$3" -o "$work/$name.ply" --quiet || failed="$failed $name"
    shift 3
    "$B/fixsplat" convert "$work/$name.ply" "$work/$name.fxs" --quiet "$@" || failed="$failed $name"
}
made knot knot 20000
made fog fog 40000
made few knot 3000
made levels knot 20000 --levels
for scene in knot:6000 landscape:8000 needles:4000 fog:1500 layers:3000 cubes:4096; do
    for profile in default compact small; do
        made "${scene%:*}-$profile" "${scene%:*}" "${scene#*:}" --profile $profile
        ln -s "${scene%:*}-$profile.fxs" "$work/shared-${scene%:*}-$profile.fxs"
    done
done
for name in guitar snowmiku; do
    "$B/fixsplat" convert "$scenes/$name/$name.ply" "$work/shared-$name.fxs" --quiet || failed="$failed $name"
done

say "the pixels of the command"
FXS_PROCESSORS=all SIZE=${SIZE:-1280x720} timeout -k 5 90 \
    node tests/web/webgpu.mjs "$package" "$work" "$modules" "$B/fixsplat" || failed="$failed webgpu.mjs"

for size in ${SIZES:-1920x1080 1280x720}; do
    for name in guitar snowmiku; do
        say "$name at $size"
        FRAMES=${FRAMES:-60} timeout -k 5 45 \
            node tests/web/webgpu_peers.mjs "$package" "$scenes" "$modules" "${ROUNDS:-2}" $name $size ||
            failed="$failed peers"
    done
done
say "done"
[ -z "$failed" ] || { echo "FAIL web:$failed"; exit 1; }
echo "ok   web"
