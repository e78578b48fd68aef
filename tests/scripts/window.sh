#!/bin/sh
# Drives the window of `fixsplat view` on a virtual screen, by keys and the pointer. Its screenshots must equal pictures
# of `fixsplat render`.
. tests/scripts/lib/check.sh
. tests/scripts/lib/screen.sh
. tests/scripts/lib/room.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
XDG_STATE_HOME=$work/state
export XDG_STATE_HOME
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
hint="; without a display, view --web shows scenes in a browser"
check "no display: status 1" [ $status = 1 ]
check "no display: one line" equal "$no_display" "fixsplat: no window: x11 not available$hint"
nothing=$(env -u DISPLAY -u WAYLAND_DISPLAY -u XDG_RUNTIME_DIR -u SDL_VIDEODRIVER timeout 10 \
    "$B/fixsplat" view "$work/knot.ply" 2>&1)
status=$?
check "no display: SDL's own choice of driver, status 1" [ $status = 1 ]
check "no display: one line that says so" equal "$nothing" "fixsplat: no window: x11 not available$hint"
nobody=$(env -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER DISPLAY=:77 timeout 10 "$B/fixsplat" view "$work/knot.ply" 2>&1)
status=$?
check "a display that is not there: status 1" [ $status = 1 ]
check "a display that is not there: one line" [ "$(printf '%s\n' "$nobody" | grep -c "^fixsplat: no window: .*$hint")" = 1 ]
have Xvfb && have xdotool || { skip window "no Xvfb and xdotool here"; finish; exit; }

# ---- The virtual screen ----------------------------------------------------------------------------------------------

start_screen
SDL_VIDEODRIVER=x11
export SDL_VIDEODRIVER

ended() { ! kill -0 $viewer; }

others=
open() {
    "$@" view "$work/knot.ply" $others --screenshot "$work/shot.png" --cameras "$work/cameras.json" \
        >"$work/out" 2>"$work/errors" &
    viewer=$!
    shots=0
    until_ 300 xdotool search --onlyvisible --class fixsplat || { fail "a window" "$(cat "$work/errors")"; return 1; }
    window=$(xdotool search --onlyvisible --class fixsplat)
    xdotool windowfocus --sync "$window"
    until_ 300 titled 'knot.ply - ' || { fail "the scene" "$(cat "$work/errors")"; return 1; }
}

titled() { xdotool getwindowname "$window" | grep -q "$1"; }

close() {
    "$@"
    until_ 200 ended || kill -KILL $viewer
    wait $viewer
    status=$?
    viewer=
}

shot() {
    shots=$((shots + 1))
    xdotool key p
    until_ 300 lines "$work/out" $shots && mv "$work/shot.png" "$work/$1.png"
}

same() {
    name=$1
    shift
    "$B/fixsplat" render "$work/knot.ply" "$@" -o "$work/rendered.png"
    check "$name" cmp "$work/$name.png" "$work/rendered.png"
}

same_again() {
    command=$(tail -n 1 "$work/out")
    eval "\"\$B/fixsplat\" ${command#fixsplat }"
    check "$1, by its command" cmp "$work/$1.png" "$work/shot.png"
}

differ() { ! cmp -s "$work/$1.png" "$work/$2.png"; }

# ---- Keys and pointer ------------------------------------------------------------------------------------------------

cameras="--cameras $work/cameras.json"
if open "$B/fixsplat"; then
    check "the view's name in the title" until_ 50 titled 'knot.ply - at-8 (1 of 3) - mahalanobis'
    shot first
    same first $cameras
    same_again first
    xdotool key g h f t n
    check "the next view's name" until_ 50 titled 'at-10 (2 of 3)'
    shot next
    same next $cameras --view 1
    xdotool key x 0 0
    shot square
    same square $cameras --view 1 --cutoff square --sh-degree 1
    check "the cut-off shows" differ next square
    xdotool key x 0 0 shift+n keydown w
    sleep 0.3
    xdotool keyup w
    shot flown
    same_again flown
    check "flight shows" differ first flown
    drag '100 90' '130 110' '160 130'
    shot turned
    same_again turned
    check "the drag shows" differ flown turned
    xdotool click 4
    shot near
    same_again near
    check "the wheel shows" differ turned near
    xdotool windowsize --sync "$window" 411 303 key r
    shot large
    same_again large
    check "the size of the window" equal "$(od -An -tx1 -j16 -N8 "$work/large.png" | tr -d ' ')" 0000019b0000012f
    check "the command has the height that is seen" grep -q -- '--fov 36.8' "$work/out"
    xdotool mousemove --window "$window" 205 150 click --repeat 2 --delay 60 1
    shot focused
    same_again focused
    check "the double click shows" differ large focused
    xdotool key m mousemove --window "$window" 200 140 click 1
    check "one end" until_ 50 titled 'click the other end'
    xdotool mousemove --window "$window" 215 160 click 1
    check "a distance" until_ 50 titled ' [0-9.]* units$'
    xdotool key m z
    xdotool key p                                  # a screenshot of depths prints no command that repeats it
    check "a picture of depths" until_ 50 titled 'written: '
    mv "$work/shot.png" "$work/depths.png"
    check "depths show" differ focused depths
    check "$shots screenshots, $shots commands" [ "$(wc -l <"$work/out")" = $shots ]
    close xdotool key Escape
    check "escape: status 0" [ $status = 0 ]
    check "not a word on stderr" equal "$(grep -v 'no words in the window' "$work/errors")" ""
fi
"$B/fixsplat" make-scene cubes --count 300 -o "$work/cube's.ply"      # a file name that a shell must quote
others="$work/cube's.ply --place 1:3,0,-2,1,1,0,0,0.5 --place 1:-3,0,0 --ortho 12"
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

# ---- The crop box ----------------------------------------------------------------------------------------------------

crops() {
    xdotool key Return
    check "cropped, $1" until_ 100 titled "written: $work/knot-cropped-00$1.ply"
    command=$(tail -n 1 "$work/out")
}

if open "$B/fixsplat"; then
    xdotool key n n
    until_ 50 titled 'at-12 (3 of 3)'
    shot whole
    xdotool key c
    drag '285 120' '225 120'
    sleep 0.5
    crops 1
    right=$(printf '%s\n' "$command" | sed 's/.*--crop //; s/ .*//' | cut -d , -f 4)
    check "the side went with the pointer: $right" awk "BEGIN { exit !($right > 2.3 && $right < 2.9) }"
    eval "\"\$B/fixsplat\" $(printf '%s\n' "${command#fixsplat }" | sed 's/knot-cropped-001/again/')" 2>"$work/notes"
    check "as the printed command writes it" cmp "$work/knot-cropped-001.ply" "$work/again.ply"
    kept=$(sed -n 's/.*kept \([0-9]*\) of 2000 .*/\1/p' "$work/notes")
    check "a part of the scene: $kept" [ "$kept" -gt 500 ] && check "not all of it" [ "$kept" -lt 1900 ]
    xdotool key p
    check "a picture of that part" until_ 50 titled 'written: .*shot.png'
    mv "$work/shot.png" "$work/cropped.png"
    check "it shows" differ whole cropped
    crops 2
    check "the same again, beside it" cmp "$work/knot-cropped-001.ply" "$work/knot-cropped-002.ply"
    close xdotool key Escape Escape
    check "escape leaves the box, then the window: status 0" [ $status = 0 ]
    check "cropped: not a word on stderr" equal "$(grep -v 'no words in the window' "$work/errors")" ""
fi
if open "$B/fixsplat"; then
    close kill $viewer
    check "a signal: status 0" [ $status = 0 ]
fi

# ---- Edits by hand ---------------------------------------------------------------------------------------------------

other_title() { titled ' - [1-9][0-9]* selected of' && [ "$(xdotool getwindowname "$window")" != "$1" ]; }

# An edited scene has no command that renders it again, so the title tells when the picture is written.
shoot() {
    xdotool key p
    until_ 100 titled 'written: .*shot.png' && mv "$work/shot.png" "$work/$1.png"
}

if open "$B/fixsplat"; then
    shoot unedited
    xdotool key l
    until_ 50 titled 'lasso: drag'
    drag '100 40' '160 50' '220 40' '250 100' '220 160' '140 140'
    check "a lasso selects" until_ 100 titled ' - [1-9][0-9]* selected of 2000'
    xdotool key j l
    until_ 50 titled 'brush: drag'
    xdotool keydown shift
    drag '60 100' '80 110'
    xdotool keyup shift
    until_ 100 titled ' selected of 2000'
    xdotool key Delete
    check "delete" until_ 100 titled ' - 0 selected of 1[0-9]*'
    shoot edited
    check "it shows" differ unedited edited
    xdotool key u
    check "undo" until_ 100 titled ' - 0 selected of 2000, some edits undone'
    shoot undone
    check "undone: the picture before" cmp "$work/unedited.png" "$work/undone.png"
    xdotool key shift+u
    check "redo" until_ 100 titled ' - 0 selected of 1[0-9]*'
    shoot redone
    check "redone: the same picture" cmp "$work/edited.png" "$work/redone.png"
    xdotool key l
    until_ 50 titled 'object: click it'
    xdotool mousemove --window "$window" 5 5 click 1
    check "no object at a click" until_ 100 titled ' - 5,5: nothing is there'
    xdotool mousemove --window "$window" 110 100 click 1
    check "a click selects the object there" until_ 100 titled ' - [1-9][0-9]* selected of 1[0-9]*'
    one=$(xdotool getwindowname "$window")
    drag '190 100' '230 130' '280 180'
    check "a box adds to it" until_ 100 other_title "$one"
    xdotool key Return
    check "written" until_ 100 titled "written: $work/knot-edited-001.fxs"
    close xdotool key Escape Escape
    check "escape leaves the tool, then the window: status 0" [ $status = 0 ]
    check "edits: not a word on stderr" equal "$(grep -v 'no words in the window' "$work/errors")" ""
    "$B/fixsplat" convert "$work/knot.ply" "$work/knot.fxs" --quiet
    "$B/fixsplat" convert "$work/knot.fxs" "$work/again.ply" --edits "$work/knot-edits-001.json" --quiet
    "$B/fixsplat" convert "$work/knot-edited-001.fxs" "$work/edited.ply" --quiet
    check "convert --edits gives the same Gaussians" cmp "$work/edited.ply" "$work/again.ply"
    "$B/fixsplat" render "$work/knot-edited-001.fxs" --cameras "$work/cameras.json" -o "$work/rendered.png"
    check "the written scene: the same picture" cmp "$work/edited.png" "$work/rendered.png"
fi

# ---- Walking ---------------------------------------------------------------------------------------------------------

# Walks ahead from z = $1 in the made rooms, and prints the x of the eye where it stops.
walk() {
    z=$1
    shift
    : >"$work/out"
    XDG_STATE_HOME=$work/walked "$B/fixsplat" view "$work/room.ply" --eye=-2,-1.3,"$z" --look=9,-1.3,"$z" --eye-height 1.4 --size 320x200 \
        --screenshot "$work/shot.png" "$@" >"$work/out" 2>"$work/errors" &
    viewer=$!
    until_ 300 xdotool search --onlyvisible --class fixsplat || return
    window=$(xdotool search --onlyvisible --class fixsplat)
    xdotool windowfocus --sync "$window"
    until_ 300 titled 'room.ply - '
    xdotool key 3
    sleep 2
    xdotool keydown shift keydown w
    sleep 3
    xdotool keyup w keyup shift
    sleep 1
    xdotool key p
    until_ 300 lines "$work/out" 1
    sed 's/.*--eye \([^,]*\),.*/\1/' "$work/out"
    xdotool key Escape Escape
    until_ 200 ended || kill -KILL $viewer
}
between() { awk "BEGIN { exit !($1 > $2 && $1 < $3) }"; }

room "$work/room.ply"
"$B/fixsplat" collide "$work/room.ply" -o "$work/room.voxel.json" --seed=-1.5,-1,0 --quiet
x=$(walk 0)
check "a walk goes through the door: $x" between "$x" 2.4 2.9
x=$(walk 1.2 --walls "$work/room.voxel.json")
check "a walk stops at the wall: $x" between "$x" -0.5 -0.1
check "walking: not a word on stderr" equal "$(grep -v 'no words in the window' "$work/errors")" ""

# ---- Frames of Vulkan in a swapchain ---------------------------------------------------------------------------------

# the first three of a pixel's four bytes are colours
screen() { od -An -v -tx1 -w4 "$work/frame/Xvfb_screen0" | cut -c 2-9 >"$work/$1.screen"; }
shows() { screen now && cmp "$work/now.screen" "$work/$1.screen"; }

# Compares whole screens. The hint about the key h disappears by itself.
differs_now() { ! shows "$1"; }
differ_screens() { ! cmp -s "$work/$1.screen" "$work/$2.screen"; }
shown_by() {
    others="--cameras $work/cameras.json --size 320x200 --backend $1"
    open env VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation "$B/fixsplat" || return
}

if no_vulkan=$("$B/fixsplat" render "$work/knot.ply" --size 64x48 --backend vulkan -o "$work/vulkan.png" 2>&1); then
    screen nothing
    shown_by cpu
    sleep 7
    screen first
    check "the screen's picture" differ_screens nothing first
    xdotool windowsize --sync "$window" 391 243
    sleep 1
    screen wide
    close xdotool key Escape
    shown_by vulkan
    if grep -q 'copied to the window' "$work/errors"; then
        skip "Vulkan in the window" "$(cat "$work/errors")"
        close xdotool key Escape
    else
        check "Vulkan: the processor's picture is on the screen" until_ 60 shows first
        xdotool key h
        check "Vulkan: the keys are drawn over it" until_ 60 differs_now first
        xdotool key h
        check "Vulkan: the picture is kept" until_ 60 shows first
        xdotool windowsize --sync "$window" 391 243
        check "Vulkan: the processor's picture in another size" until_ 60 shows wide
        xdotool windowminimize "$window" windowmap --sync "$window" windowsize --sync "$window" 320 200
        check "Vulkan: hidden, shown and in the first size" until_ 60 shows first
        shot vulkan
        same vulkan --cameras "$work/cameras.json" --size 320x200
        xdotool key z
        check "depths" until_ 60 differs_now first
        xdotool key z b
        check "the next back end draws" until_ 100 titled ', cpu, \|, gles'
        check "its picture is the same" until_ 60 shows first
        close xdotool key Escape
        check "Vulkan: status 0" [ $status = 0 ]
        check "Vulkan: no message of the validation layer" equal \
            "$(grep -v 'no words in the window\|--backend [a-z-]*:' "$work/errors")" ""
    fi
    others=
else
    skip "Vulkan in the window" "$no_vulkan"
fi

# ---- Missing and unreadable scenes -----------------------------------------------------------------------------------

"$B/fixsplat" view >"$work/out" 2>"$work/errors" &
viewer=$!
check "a window without a scene" until_ 300 xdotool search --onlyvisible --class fixsplat
window=$(xdotool search --onlyvisible --class fixsplat)
check "its title" equal "$(xdotool getwindowname "$window")" fixsplat
xdotool windowfocus --sync "$window"
close xdotool key p n h Escape
check "without a scene: escape, status 0" [ $status = 0 ]
check "without a scene: not a word" equal "$(cat "$work/out" "$work/errors" | grep -v 'no words in the window')" ""
reopen() {
    "$B/fixsplat" view >"$work/out" 2>"$work/errors" &
    viewer=$!
    until_ 300 xdotool search --onlyvisible --class fixsplat || { fail "a window" "$(cat "$work/errors")"; return 1; }
    window=$(xdotool search --onlyvisible --class fixsplat)
    xdotool windowfocus --sync "$window"
    eval "$(xdotool getwindowgeometry --shell "$window")"
    "$@"
    check "a recent scene by $1 $2" until_ 100 titled 'knot.ply - '
    close xdotool key Escape
}

click_first() { xdotool mousemove --window "$window" $((WIDTH / 2)) $((HEIGHT / 2 + 6)) click 1; }

check "recent scenes" equal "$(cat "$work/state/fixsplat/recent")" "$work/knot.ply"
head -c 200 "$work/knot.ply" >"$work/cut.ply"
echo "$work/cut.ply" >>"$work/state/fixsplat/recent"
after_damaged() {
    xdotool key 2
    check "a damaged scene: the window says why" until_ 100 titled '^fixsplat - cut.ply: the header'
    xdotool key 1
}
reopen after_damaged
grep -q 'no words' "$work/errors" || reopen click_first
missing=$(timeout 20 "$B/fixsplat" view "$work/none.ply" 2>&1)
status=$?
check "a scene that is not there: status 1" [ $status = 1 ]
check "a scene that is not there: one line" equal "$missing" "fixsplat: $work/none.ply: No such file or directory"

command=$(cd "$B" && pwd)/fixsplat
mkdir "$work/here" && echo mine >"$work/here/fixsplat-001.png"
cd "$work/here" && "$command" view "$work/knot.ply" >"$work/out" 2>"$work/errors" &
viewer=$!
if until_ 300 xdotool search --onlyvisible --class fixsplat; then
    window=$(xdotool search --onlyvisible --class fixsplat)
    xdotool windowfocus --sync "$window"
    until_ 300 titled 'knot.ply - '
    xdotool key p
    check "the next number" until_ 50 titled 'written: fixsplat-002.png'
    check "what is there stays" equal "$(cat "$work/here/fixsplat-001.png")" mine
    xdotool key k keydown w
    sleep 0.3
    xdotool keyup w key k
    check "a film" until_ 100 titled 'written: fixsplat-001.y4m'
    check "of the window's size" grep -aq '^YUV4MPEG2 W800 H' "$work/here/fixsplat-001.y4m"
    close xdotool key Escape
fi

# Tests with the viewer and the X server on one processor. A window that is closed while drawing must end with status 0.
if have taskset; then
    processor=$(taskset -pc $$ | sed 's/.*: //; s/[,-].*//')
    taskset -pc "$processor" $server >/dev/null
    "$B/fixsplat" make-scene knot --count 20000 -o "$work/large.ply"
    statuses=
    for delay in 4 5 6 7; do
        taskset -c "$processor" "$command" view "$work/large.ply" --size 400x300 >"$work/out" 2>"$work/errors" &
        viewer=$!
        until_ 300 xdotool search --onlyvisible --class fixsplat
        window=$(xdotool search --onlyvisible --class fixsplat)
        xdotool windowfocus --sync "$window"
        close taskset -c "$processor" xdotool key --delay $delay n n n n n n n n Escape
        statuses="$statuses$status"
    done
    check "closed while pictures are drawn: status 0, each time" equal "$statuses" 0000
else
    skip "closed while pictures are drawn" "no taskset here"
fi

if ! have valgrind || [ "$FXS_EMULATED" ]; then
    skip Valgrind "not here, or not of an emulator"
elif open valgrind -q --trace-children=yes --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
    "$B/fixsplat"; then
    xdotool key g h n x v z z m t      # key b is not pressed, because Mesa would leak some hundred bytes
    shot checked
    xdotool key c
    sleep 1
    xdotool key Escape l
    drag '100 40' '160 50' '220 40' '250 100' '220 160' '140 140'
    xdotool key Delete
    sleep 1
    xdotool key u
    sleep 1
    close xdotool key Escape Escape
    check "Valgrind" [ $status = 0 ]
    grep '^==' "$work/errors"
fi
finish
