#!/bin/sh
# Tests the npm package with WebGL 2 in headless Chromium: pixels equal to the command's, lost contexts, errors, and
# Gaussians in three.js and PlayCanvas. FXS_PROCESSORS=all adds every captured scene. SPEED=1 also measures speed.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs webgl chromium -- playcanvas puppeteer-core three

make_scene() {
    "$B/fixsplat" make-scene "$1" --count "$2" -o "$work/$1.ply" >/dev/null &&
        "$B/fixsplat" convert "$work/$1.ply" "$work/$1.fxs" >/dev/null
}

pack() { "$B/fixsplat" convert "$scenes/$1" "$work/shared-$(basename "$1" | sed 's/\..*//').fxs" >/dev/null; }

check "builds" builds
check "makes a scene" make_scene knot 20000
check "makes another" make_scene fog 40000
check "with levels" "$B/fixsplat" convert "$work/knot.ply" "$work/levels.fxs" --levels
if [ -d "$scenes" ]; then
    some='guitar/guitar.compressed.ply train-1000/train-1000.ply skull/skull.sog'
    more='boatyard-tile3/boatyard-tile3.glb donut/donut.ply fruit-drops/fruit_drops_minimal.ply
          kitchen-marble/kitchen-marble.spz luma-seal/luma-seal.splat snowmiku/snowmiku.ply
          statue-st-peter/st-peter.sog'
    [ "$FXS_PROCESSORS" = all ] && some="$some $more"
    [ -z "$SPEED" ] || some="$some snowmiku/snowmiku.ply"
    for scene in $some; do check "packs $scene" pack "$scene"; done
    cp "$scenes/snowmiku/cameras.json" "$work"
else
    skip scenes "no $scenes"
fi
asks webgl.mjs "$B/fixsplat" $SPEED
finish
