#!/bin/sh
# The viewer in a window of a virtual screen, by its keys and the pointer: what it writes is what `render` renders.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
server= viewer=
trap 'kill $viewer $server 2>/dev/null; rm -rf "$work"' EXIT

"$B/fixsplat" make-scene knot --count 2000 -o "$work/knot.ply" || exit 1
for z in -8 -10 -12; do
    echo "{\"id\": 0, \"img_name\": \"at$z\", \"width\": 320, \"height\": 200, \"position\": [0, -1, $z],
        \"rotation\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"fx\": 300, \"fy\": 300}"
done | paste -sd ' ' | sed -e 's/} *{/}, {/g' -e 's/.*/[&]/' >"$work/cameras.json"

no_display=$(env -u DISPLAY -u WAYLAND_DISPLAY SDL_VIDEODRIVER=x11 "$B/fixsplat" view "$work/knot.ply" 2>&1)
status=$?
case $no_display in
*'built without'*) skip window "$no_display"; finish; exit ;;
esac
check "no display: status 1" [ $status = 1 ]
check "no display: one line" [ "$no_display" = "fixsplat: no window: x11 not available" ]
nothing=$(env -u DISPLAY -u WAYLAND_DISPLAY -u XDG_RUNTIME_DIR -u SDL_VIDEODRIVER timeout 10 \
    "$B/fixsplat" view "$work/knot.ply" 2>&1)
status=$?
if [ -e /dev/dri/card0 ]; then
    skip "no display: SDL's own choice of driver" "it may take the console here"
else
    check "no display: SDL's own choice of driver, status 1" [ $status = 1 ]
    case $nothing in
    'fixsplat: no window: x11,'*' not available') ok "no display: one line that says so" ;;
    *) fail "no display: one line that says so" "$nothing" ;;
    esac
fi
have Xvfb && have xdotool || { skip window "no Xvfb and xdotool here"; finish; exit; }

# ---- A screen and the viewer on it -----------------------------------------------------------------------------------

Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp -noreset 3>"$work/display" 2>"$work/server" &
server=$!

# until_ TENTHS COMMAND...: tries the command for so long.
until_() {
    tries=$1
    shift
    until "$@" >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep 0.1
    done
}

ended() { ! kill -0 $viewer; }
lines() { [ "$(wc -l <"$1")" -ge "$2" ]; }

until_ 100 lines "$work/display" 1 || { fail "virtual screen" "$(cat "$work/server")"; finish; exit 1; }
DISPLAY=:$(cat "$work/display") SDL_VIDEODRIVER=x11 DBUS_SESSION_BUS_ADDRESS=disabled:
export DISPLAY SDL_VIDEODRIVER DBUS_SESSION_BUS_ADDRESS

# open COMMAND...: the viewer with the knot and $others, in the background; its window has the focus.
others=
open() {
    "$@" view "$work/knot.ply" $others --screenshot "$work/shot.png" --cameras "$work/cameras.json" \
        >"$work/out" 2>"$work/errors" &
    viewer=$!
    shots=0
    until_ 300 xdotool search --onlyvisible --class fixsplat || { fail "a window" "$(cat "$work/errors")"; return 1; }
    window=$(xdotool search --onlyvisible --class fixsplat)
    xdotool windowfocus --sync "$window"
}

# close COMMAND...: the viewer ends by this; $status.
close() {
    "$@"
    until_ 200 ended || kill -KILL $viewer
    wait $viewer
    status=$?
    viewer=
}

# shot NAME: a screenshot, as $work/NAME.png. The viewer has printed a line when it is there.
shot() {
    shots=$((shots + 1))
    xdotool key i
    until_ 300 lines "$work/out" $shots && mv "$work/shot.png" "$work/$1.png"
}

# same NAME ARGUMENT...: the screenshot is the picture that `render` makes with these arguments.
same() {
    name=$1
    shift
    "$B/fixsplat" render "$work/knot.ply" "$@" -o "$work/rendered.png"
    check "$name" cmp "$work/$name.png" "$work/rendered.png"
}

# same_again NAME: that which the printed command makes.
same_again() {
    command=$(tail -n 1 "$work/out")
    "$B/fixsplat" ${command#fixsplat }
    check "$1, by its command" cmp "$work/$1.png" "$work/shot.png"
}

differ() { ! cmp -s "$work/$1.png" "$work/$2.png"; }
titled() { xdotool getwindowname "$window" | grep -q "$1"; }

# ---- Keys and pointer ------------------------------------------------------------------------------------------------

cameras="--cameras $work/cameras.json"
if open "$B/fixsplat"; then
    check "the view's name in the title" until_ 50 titled 'knot.ply - at-8 (1 of 3) - mahalanobis'
    shot first
    same first $cameras
    same_again first
    xdotool key g h n
    check "the next view's name" until_ 50 titled 'at-10 (2 of 3)'
    shot next
    same next $cameras --view 1
    xdotool key c 1
    shot square
    same square $cameras --view 1 --cutoff square --sh-degree 1
    check "the cut-off shows" differ next square
    xdotool key c 3 p keydown w
    sleep 0.3
    xdotool keyup w
    shot flown
    same_again flown
    check "flight shows" differ first flown
    xdotool mousemove --window "$window" 100 90 mousedown 1 mousemove_relative 30 20 mousemove_relative 30 20 mouseup 1
    shot turned
    same_again turned
    check "the drag shows" differ flown turned
    xdotool click 4
    shot near
    same_again near
    check "the wheel shows" differ turned near
    xdotool windowsize --sync "$window" 411 303 key r
    shot large
    same large $cameras --size 411x303
    check "$shots screenshots, $shots commands" [ "$(wc -l <"$work/out")" = $shots ]
    close xdotool key Escape
    check "escape: status 0" [ $status = 0 ]
    check "not a word on stderr" equal "$(cat "$work/errors")" ""
fi
"$B/fixsplat" make-scene cubes --count 300 -o "$work/cubes.ply"
others="$work/cubes.ply --place 1:3,0,-2,1,1,0,0,0.5 --place 1:-3,0,0 --ortho 12"
if open "$B/fixsplat"; then
    shot objects
    same objects $others $cameras
    xdotool click 4
    shot nearer
    same_again nearer
    check "parallel rays: the wheel shows" differ objects nearer
    close xdotool key Escape
fi
others=
if open "$B/fixsplat"; then
    close kill $viewer
    check "a signal: status 0" [ $status = 0 ]
fi
if ! have valgrind || [ "$FXS_EMULATED" ]; then
    skip Valgrind "not here, or not of an emulator"
elif open valgrind -q --trace-children=yes --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
    "$B/fixsplat"; then
    xdotool key g h n c v      # not b: Mesa keeps some hundred bytes
    shot checked
    close xdotool key Escape
    check "Valgrind" [ $status = 0 ]
    grep '^==' "$work/errors"
fi
finish
