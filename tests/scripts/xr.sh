#!/bin/sh
# Tests the viewer in a simulated headset (iwer) in headless Chromium: pixels of both eyes, controllers, errors.
# FXS_PROCESSORS=all adds WebGPU.
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
