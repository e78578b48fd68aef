#!/bin/sh
# Builds docs/examples/glfw.cpp against the installed library, and drives the window on a virtual screen by the pointer.
# Around the mesh, the screen must equal a picture of `fixsplat render`. On the mesh, the processor's depths decide
# between mesh and Gaussians. A click must pick the processor's Gaussian.
. tests/scripts/lib/check.sh
. tests/scripts/lib/screen.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
server= engine=
trap 'kill $engine $server 2>/dev/null; rm -rf "$work"' EXIT
PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig:$PKG_CONFIG_PATH LD_LIBRARY_PATH=$work/prefix/lib
export PKG_CONFIG_PATH LD_LIBRARY_PATH
for program in pkg-config glslangValidator Xvfb xdotool python3 "${CXX:-c++}"; do
    have "$program" || { skip engine "no $program here"; finish; exit; }
done
pkg-config --exists glfw3 vulkan || { skip engine "no GLFW or Vulkan here"; finish; exit; }

check "make install" make -s B="$B" PREFIX="$work/prefix" install
cp docs/examples/glfw* "$work"
strict='-Wall -Wextra -Werror'
sed -n 's/^ \*     for kind/for kind/p; s/^ \*     c++/${CXX:-c++} $strict/p' docs/examples/glfw.cpp >"$work/compile"
check "the engine compiles" eval "(cd '$work' && . ./compile)"
"$B/fixsplat" make-scene knot --count 20000 -o "$work/knot.ply"

check "no scene: one line" equal "$("$work/glfw" 2>&1)" "glfw: usage: glfw SCENE"
check "a scene that is not there" equal "$("$work/glfw" "$work/none.ply" 2>&1)" \
    "glfw: $work/none.ply: No such file or directory"
check "no display: one line" equal "$(env -u DISPLAY -u WAYLAND_DISPLAY "$work/glfw" "$work/knot.fxs" 2>&1 | wc -l)" 1

# ---- The processor's pictures ----------------------------------------------------------------------------------------

cat >"$work/mesh.py" <<'END'
# mesh.py SCENE.fxs YAW: prints the camera of the engine, for the command.
# mesh.py SCENE.fxs SCREEN PLAIN DEPTHS: compares the screen's upper left corner with the picture without the mesh.
import math, struct, sys
box = [q / 2 ** 32 for q in struct.unpack_from("<6q", open(sys.argv[1], "rb").read(), 80)]
middle, away = [(box[i] + box[i + 3]) / 2 for i in range(3)], 1.5 * (box[3] - box[0])
radius = away / 8
if len(sys.argv) == 3:
    yaw, pitch = float(sys.argv[2]), 0.3
    eye = [middle[0] - away * math.sin(yaw) * math.cos(pitch), middle[1] - away * math.sin(pitch),
           middle[2] - away * math.cos(yaw) * math.cos(pitch)]
    sys.exit(print("--fov 50 --up 0,-1,0 --eye %.17g,%.17g,%.17g --look %.17g,%.17g,%.17g" % (*eye, *middle)))
screen, plain, depths = (open(name, "rb").read() for name in sys.argv[2:])
head = struct.unpack(">25I", screen[:100])                      # the file format XWD, with pixels as B, G, R, 0
pixels, row = screen[head[0] + 12 * head[19]:], head[12]
_, size, _, plain = plain.split(b"\n", 3)
width, height = map(int, size.split())
depths = struct.unpack("<%df" % (width * height), depths[-4 * width * height:])
focal = height / 2 / math.tan(math.radians(25))
around = mesh = front = odd = wrong = 0
for y in range(height):
    for x in range(width):
        b, g, r = pixels[y * row + 4 * x:y * row + 4 * x + 3]
        u, v = (x + 0.5 - width / 2) / focal, (y + 0.5 - height / 2) / focal
        square = u * u + v * v + 1
        root = away * away - square * (away * away - radius * radius)
        if root < -0.1 * radius * radius:
            around += 1
            odd += bytes((r, g, b)) != plain[3 * (y * width + x):3 * (y * width + x) + 3]
        elif root > 0.1 * radius * radius:
            z, depth = (away - math.sqrt(root)) / square, depths[(height - 1 - y) * width + x]
            orange = abs(g - 0.6 * r) < 2 and abs(b - 0.2 * r) < 2 and 50 < r < 250
            behind, before = depth > z + 0.2 * radius, depth < z - 0.2 * radius
            mesh, front, wrong = mesh + behind, front + before, wrong + (behind and not orange or before and orange)
print(around > width * height / 2 and mesh > 2000 and front > 100 and not odd and wrong < (mesh + front) / 50,
      "around the mesh %d pixels, %d differ; the mesh %d, Gaussians before it %d, wrong %d" % (around, odd, mesh, front, wrong))
END
"$B/fixsplat" convert "$work/knot.ply" "$work/knot.fxs" --quiet
camera=$(python3 "$work/mesh.py" "$work/knot.fxs" 0)
render() { "$B/fixsplat" render "$work/knot.fxs" $camera "$@"; }

shows() {
    said=$(python3 "$work/mesh.py" "$work/knot.fxs" "$work/frame/Xvfb_screen0" "$work/plain.ppm" "$work/depths.pfm")
    echo "$said"
    [ "${said%% *}" = True ]
}

seen() {
    render --size "$2" -o "$work/plain.ppm" --depth "$work/depths.pfm"
    until_ 20 shows
    check "$1" shows
}

clicks=0
pick() {
    xdotool mousemove $2 $3 click 1
    clicks=$((clicks + 1))
    until_ 100 lines "$work/out" $clicks
    check "$1" equal "$(tail -n 1 "$work/out" | cut -d ' ' -f -4)" "$4"
    xdotool mousemove 790 590
}

picked() { render --size "$1" --pick "$2,$3" | sed -n 's/.*, \(Gaussian [0-9]*\), .*/object 0, \1/p'; }
ended() { ! kill -0 $engine; }

# ---- The engine ------------------------------------------------------------------------------------------------------

start_screen
xdotool mousemove 790 590
VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation "$work/glfw" "$work/knot.fxs" >"$work/out" 2>"$work/errors" &
engine=$!
until_ 300 xdotool search --onlyvisible --name '^A mesh' || ended
if grep -q 'no device of Vulkan\|createInstance\|Vulkan' "$work/errors"; then
    skip "the engine's picture" "$(head -n 1 "$work/errors")"
    finish
    exit
fi
window=$(xdotool search --onlyvisible --name '^A mesh')
seen "the mesh in the scene" 640x360
pick "the mesh is picked" 330 190 "the ball"
pick "nothing is picked" 20 20 nothing
pick "a Gaussian beside the mesh" 241 237 "$(picked 640x360 241 237)"
pick "a Gaussian before the mesh" 310 235 "$(picked 640x360 310 235)"
check "it is a Gaussian" grep -q '^object 0, Gaussian [0-9]* at -*[0-9.]*, ' "$work/out"
xdotool windowsize --sync "$window" 411 303
seen "the window in another size" 411x303
pick "a Gaussian in another size" 140 200 "$(picked 411x303 140 200)"
for size in 700 100 640; do xdotool windowsize --sync "$window" $size $((size * 9 / 16)); done
xdotool mousemove 300 20 mousedown 1 mousemove 350 20 mousemove 400 20 mouseup 1 mousemove 790 590
clicks=$((clicks + 1))
camera=$(python3 "$work/mesh.py" "$work/knot.fxs" 1)
seen "turned by a drag" 640x360
pick "a Gaussian in the turned view" 300 260 "$(picked 640x360 300 260)"
check "the engine runs" kill -0 $engine
xdotool windowfocus --sync "$window" keydown Escape
until_ 100 ended || kill $engine
wait $engine
check "Escape ends it: status 0" [ $? = 0 ]
engine=
check "no message of the validation layer" equal "$(cat "$work/errors")" ""
finish
