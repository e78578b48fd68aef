#!/bin/sh
# Builds docs/examples/engine.c and vulkan.c against the installed library. Their pictures and picked Gaussians must
# equal what the command fixsplat gives.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
SDL_VIDEODRIVER=offscreen                           # SDL's driver that draws without a screen, over EGL
PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig:$PKG_CONFIG_PATH LD_LIBRARY_PATH=$work/prefix/lib
export SDL_VIDEODRIVER PKG_CONFIG_PATH LD_LIBRARY_PATH
if ! have pkg-config || ! pkg-config --exists sdl2 glesv2; then
    skip engine "no pkg-config, SDL2 or OpenGL ES here"
    finish
    exit
fi
check "make install" make -s B="$B" PREFIX="$work/prefix" install
cp docs/examples/engine.c "$work"
strict='-std=c99 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror'
sed -n 's/^ \*     cc engine/${CC:-cc} $strict engine/p' docs/examples/engine.c >"$work/compile"
check "the engine compiles" eval "(cd '$work' && . ./compile)"
"$B/fixsplat" make-scene knot --count 20000 -o "$work/knot.ply"
echo '[{"id": 0, "img_name": "a", "width": 640, "height": 360, "position": [0, 0, -12],
    "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 512, "fy": 512}]' >"$work/cameras.json"
render() { "$B/fixsplat" render "$work/knot.ply" --cameras "$work/cameras.json" "$@"; }

shown() { timeout 60 "$work/engine" "$work/knot.ply" "$work/shown.ppm" "$1" "$2" 2>&1 | sed '/^by /w'"$work/way"'
    //d'; }

rows() { od -An -v -tx1 -j15 -w1920 "$work/$1.ppm"; }
right() { rows "$1" | cut -c 2890-; }               # prints columns from 321 on, which are right of the mesh
pixel() { rows "$1" | sed -n "$(($3 + 1))p" | cut -c $((9 * $2 + 1))-$((9 * $2 + 9)); }
cards() { od -An -v -tx1 -j15 -w3 "$work/$1.ppm" | grep -c ' cc 66 33'; }

picks() {
    want=$(render --pick "$1,$2" | sed -n 's/.*, \(Gaussian [0-9]*\), .*/object 7, \1/p')
    got=$(shown "$1" "$2")
    [ "$want" ] && equal "${got%, depth*}" "$want"
}

before_the_card() { shown 190 250 | awk '{ exit !($NF > 9 && $NF < 12) }'; }

checks() {
    check "$1: the engine runs" test -s "$work/shown.ppm"
    check "$1: beside the card, the processor's picture" equal "$(right shown | cksum)" "$(right plain | cksum)"
    check "$1: the card is seen" [ "$(cards shown)" -gt 20000 ]
    check "$1: not before the ball" equal "$(pixel shown 190 250)" "$(pixel plain 190 250)"
    check "$1: the ball's Gaussian, before the card" picks 190 250
    check "$1: its depth" before_the_card
    check "$1: the knot's Gaussian beside the card" picks 400 160
    check "$1: the card is before the knot" equal "$(pixel shown 235 183)" ' cc 66 33'
    check "$1: no pick through the card" equal "$(shown 235 183)" nothing
}

render -o "$work/plain.ppm"
check "a Gaussian is there without the card" [ "$(render --pick 235,183)" != nothing ]
for without in "" -GL_ARB_stencil_texturing; do
    rm -f "$work/shown.ppm"
    MESA_EXTENSION_OVERRIDE=$without
    export MESA_EXTENSION_OVERRIDE
    said=$(shown 190 250)
    case $said in *'not available'* | *EGL*) skip "the engine's picture" "$said"; finish; exit ;; esac
    case $without,$(cat "$work/way") in
    ,by\ compute* | -*,by\ fragment*) checks "$(cat "$work/way")" ;;
    *) skip "the engine without ${without:-anything}" "it is drawn $(cat "$work/way")" ;;
    esac
done
cp docs/examples/vulkan.c "$work"
sed -n 's/^ \*     cc vulkan/${CC:-cc} $strict vulkan/p' docs/examples/vulkan.c >"$work/compile"
if pkg-config --exists vulkan; then
    check "the Vulkan example compiles" eval "(cd '$work' && . ./compile)"
    rm -f "$work/shown.ppm"
    VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation timeout 60 "$work/vulkan" "$work/knot.ply" "$work/shown.ppm" \
        >"$work/said" 2>&1
    if grep -q 'no device of Vulkan\|vkCreateInstance' "$work/said"; then
        skip "the Vulkan example's picture" "$(cat "$work/said")"
    else
        check "Vulkan: no message of the validation layer" equal "$(cat "$work/said")" ""
        check "Vulkan: beside the card, the processor's picture" equal "$(right shown | cksum)" "$(right plain | cksum)"
        check "Vulkan: the card is seen" [ "$(cards shown)" -gt 20000 ]
        check "Vulkan: not before the ball" equal "$(pixel shown 190 250)" "$(pixel plain 190 250)"
        check "Vulkan: the card is before the knot" equal "$(pixel shown 235 183)" ' cc 66 33'
    fi
else
    skip vulkan "no libvulkan here"
fi
check "a scene that is not there" equal "$("$work/engine" "$work/none.ply" 2>&1)" \
    "engine: $work/none.ply: No such file or directory"
finish
