#!/bin/sh
# The viewer in a headset (docs/web.md), which iwer plays in headless Chromium: the pixels of the command in both eyes,
# controllers, sizes that follow the time, and the page before, after and when something goes wrong. With
# FXS_PROCESSORS=all by WebGPU too.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs xr chromium -- puppeteer-core iwer

check "builds" builds
check "makes a scene" "$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply"
asks xr.mjs "$work" "$B/fixsplat"
if [ "$FXS_PROCESSORS" = all ]; then
    export WEBGPU=1 ONLY=WebGPU
    asks xr.mjs "$work" "$B/fixsplat"
fi
finish
