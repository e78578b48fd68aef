# Sourced by tests of windows, after check.sh. Helpers to wait, and a virtual screen of 800x600 pixels.

until_() {
    tries=$1
    shift
    until "$@" >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep 0.1
    done
}

lines() { [ "$(wc -l <"$1")" -ge "$2" ]; }

# Starts Xvfb as the process $server, with its pixels in the file $work/frame/Xvfb_screen0.
start_screen() {
    mkdir "$work/frame"
    Xvfb -displayfd 3 -screen 0 800x600x24 -fbdir "$work/frame" -nolisten tcp -noreset 3>"$work/display" 2>"$work/server" &
    server=$!
    until_ 100 lines "$work/display" 1 || { fail "virtual screen" "$(cat "$work/server")"; finish; exit 1; }
    DISPLAY=:$(cat "$work/display") DBUS_SESSION_BUS_ADDRESS=disabled:
    export DISPLAY DBUS_SESSION_BUS_ADDRESS
}

# Drags with the left button through positions in $window, each "X Y". Relative positions would be scaled by the speed of
# the pointer.
drag() {
    xdotool mousemove --window "$window" $1 mousedown 1
    shift
    for position; do xdotool mousemove --window "$window" $position; done
    xdotool mouseup 1
}
