#!/bin/sh
# Tests the npm package with WebGPU in headless Chromium: pixels equal to the command's, offscreen targets, lost devices
# and errors. FXS_PROCESSORS=all adds captured scenes and other engines.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs webgpu chromium -- puppeteer-core

make_scene() {
    name=$1
    "$B/fixsplat" make-scene "$2" --count "$3" -o "$work/$name.ply" >/dev/null
    shift 3
    "$B/fixsplat" convert "$work/$name.ply" "$work/$name.fxs" "$@" >/dev/null 2>&1
}

pack() { "$B/fixsplat" convert "$scenes/$1" "$work/shared-$(basename "$1" | sed 's/\..*//').fxs" >/dev/null; }

check "builds" builds
check "makes a scene" make_scene knot knot 20000
check "makes another" make_scene fog fog 40000
check "makes a small one" make_scene few knot 3000
check "with levels" make_scene levels knot 20000 --levels
check "one to stream" make_scene parts knot 60000 --levels
for scene in knot:6000 landscape:8000 needles:4000 fog:1500 layers:3000 cubes:4096; do
    for profile in default compact small; do
        check "${scene%:*}, $profile" make_scene "${scene%:*}-$profile" "${scene%:*}" "${scene#*:}" --profile $profile
    done
done
if [ "$FXS_PROCESSORS" = all ] && [ -d "$scenes" ]; then
    for scene in guitar/guitar.compressed.ply train-1000/train-1000.ply snowmiku/snowmiku.ply; do
        check "packs $scene" pack "$scene"
    done
    cp "$scenes/snowmiku/cameras.json" "$work"
fi
asks webgpu.mjs "$B/fixsplat"

# Tests WebGPU in Node with the npm package webgpu (Dawn), on the software driver SwiftShader of Chromium.
driver=/usr/lib/chromium/vk_swiftshader_icd.json
in_node() {
    mkdir "$work/few" && ln -s ../few.ply "$work/few" &&
        VK_DRIVER_FILES=$driver VK_ICD_FILENAMES=$driver \
            node tests/web/dawn.mjs "$package" "$work" "$modules" "$B/fixsplat" 96x64 0 few
}
if [ -f $driver ] && [ -d "$modules/webgpu" ]; then
    check "in Node, by Dawn" in_node
else
    skip "in Node, by Dawn" "not here: $driver or npm's webgpu"
fi
if [ "$FXS_PROCESSORS" = all ]; then
    export WEBGPU=1
    asks gpu_page.mjs "$work" "$B/fixsplat"
    export ONLY='plays by itself'
    asks moving.mjs "$work" "$B/fixsplat"
fi
finish
