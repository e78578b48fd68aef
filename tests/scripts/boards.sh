#!/bin/sh
# Tests the firmware for microcontroller boards under qemu. Frames drawn in strips of rows must have the same bytes as
# on the host, and damaged flash memory must give an error message. FXS_PROCESSORS=all adds all boards and a screen.
. tests/scripts/lib/check.sh
. tests/scripts/lib/splatv.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
check "the example of a board compiles" ${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Werror -Isrc/include -I. \
    -c docs/examples/board.c -o "$work/board.o"
if ! have arm-none-eabi-gcc || ! have qemu-system-arm; then
    skip boards "no arm-none-eabi-gcc or no qemu-system-arm here"
    finish
    exit
fi
made=$work/made
boards=mps3-an547 budget=
[ "$FXS_PROCESSORS" = all ] && boards="$boards mps2-an385 mps2-an500"

firmware() {
    scene_of_firmware=$1
    shift
    said=$(env -u MAKEFLAGS make -s B="$made" NVCC=none FIRMWARE_SCENE="$scene_of_firmware" \
        $(printf "$made/firmware/%s.elf " ${*:-$boards}) 2>&1 |
        grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

run() {
    board=$1 elf=$2 words=arg=firmware
    shift 2
    for word in "$@"; do words=$words,arg=$word; done
    (cd "$work" && timeout 100 qemu-system-arm -M "$board" -nographic -monitor none -serial none -icount shift=0 \
        -semihosting-config enable=on,target=native,$words -kernel "$elf") 2>&1
    echo "exit $?"
}

hashes() { grep -o '^step [0-9]* hash [0-9a-f]*'; }

same_hashes() {
    board=$1 width=$2 height=$3 frames=$4
    shift 4
    [ -z "$budget" ] || set -- "$@" budget="$budget"
    want=$("$B/tests/test_strip" "$scene" "$width" "$height" "$frames" $budget)
    run "$board" "$made/firmware/$board.elf" width="$width" height="$height" frames="$frames" "$@" >"$work/log"
    tail -n 1 "$work/log" | grep -qx 'exit 0' && equal "$(hashes <"$work/log")" "$want" &&
        awk -v most=$((budget ? 5120 : 4096)) '/^stack/ { found = $2 <= most } END { exit !found }' "$work/log" && return
    cat "$work/log"
    return 1
}

refuses() {
    run "$1" "$2" $3 >"$work/log"
    equal "$(tail -n 1 "$work/log")" 'exit 1' && equal "$(grep -c . "$work/log")" 2 &&
        grep -q "^error: .*$4" "$work/log" && return
    cat "$work/log"
    return 1
}

one_byte_short() {
    least=$(run "$1" "$made/firmware/$1.elf" width=160 height=120 frames=1 memory=0 | sed -n 's/.*takes //p')
    [ "${least:-0}" -gt 30000 ] && same_hashes "$1" 160 120 1 memory="$least" &&
        refuses "$1" "$made/firmware/$1.elf" "width=160 height=120 memory=$((least - 1))" 'too little memory'
}

make_scene() {
    count=$1
    shift
    "$B/fixsplat" make-scene knot --count "$count" -o "$work/$count.ply" &&
        "$B/fixsplat" convert "$work/$count.ply" "$work/$count.fxs" "$@"
}

kernels_are_exact() {
    said=$(env -u MAKEFLAGS make -s B="$made" NVCC=none "$made/firmware/$1/test_kernels.elf" 2>&1 |
        grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
    run "$1" "$made/firmware/$1/test_kernels.elf" >"$work/log"
    grep -q ' 0 failed' "$work/log" && tail -n 1 "$work/log" | grep -qx 'exit 0' && return
    cat "$work/log"
    return 1
}

drives_a_display() {
    board=$1 width=$2 height=$3
    shift 3
    rm -f "$work/panel.stream"
    run "$board" "$made/firmware/$board.elf" width="$width" height="$height" frames=2 display=1 "$@" >"$work/log"
    tail -n 1 "$work/log" | grep -qx 'exit 0' &&
        "$B/tests/test_panel" "$scene" "$width" "$height" 2 "$work/panel.stream" \
            $(echo "$*" | sed -n 's/.*panel=\([0-9]*\) rotation=\([0-9]*\).*/\1 \2/p') >>"$work/log" && return
    cat "$work/log"
    return 1
}

display_is_seen() {
    head -c -2 "$work/panel.stream" >"$work/short.stream"
    ! "$B/tests/test_panel" "$scene" 131 77 2 "$work/short.stream" &&
        ! "$B/tests/test_panel" "$scene" 131 77 3 "$work/panel.stream"
}

scene=$work/20000.fxs
check "makes a scene" make_scene 20000
check "builds" firmware "$scene"
for board in $boards; do
    check "$board has the bytes of the host" same_hashes "$board" 320 240 4
    check "$board: strips of 32 rows, a picture of odd size" same_hashes "$board" 131 77 2 rows=32
    check "$board: the least memory, and a byte less" one_byte_short "$board"
    check "$board drives a display" drives_a_display "$board" 320 240
    check "$board drives an upright display, strips of 32 rows" drives_a_display "$board" 131 77 rows=32
    check "the model sees a byte less, and another picture" display_is_seen
    check "$board drives an ST7735, turned by 270 degrees" drives_a_display "$board" 160 128 panel=3 rotation=3
    check "$board drives an SSD1306 of 1 bit, upside down" drives_a_display "$board" 128 64 panel=5 rotation=2 rows=32
    check "$board: a panel that it does not know" refuses "$board" "$made/firmware/$board.elf" \
        'panel=6 display=1' device
    check "$board: a display that it does not fit" refuses "$board" "$made/firmware/$board.elf" \
        'width=400 display=1' 'width or height'
    check "$board: strips without rows" refuses "$board" "$made/firmware/$board.elf" 'rows=0' target
    check "$board: strips wider than its room" refuses "$board" "$made/firmware/$board.elf" 'width=481' target
    check "$board: a picture without pixels" refuses "$board" "$made/firmware/$board.elf" 'width=0' 'height'
    check "$board: its versions of the stages are exact" kernels_are_exact "$board"
done

# ---- The screen of the Versatile Express -----------------------------------------------------------------------------

shown() {
    mkfifo "$work/monitor" && : >"$work/said"
    QEMU_AUDIO_DRV=none timeout 100 qemu-system-arm -M vexpress-a9 -display none -serial none -monitor stdio \
        -semihosting-config enable=on,target=native,arg=firmware,arg=frames="$1" \
        -kernel "$made/firmware/vexpress-a9.elf" <"$work/monitor" >"$work/said" 2>&1 &
    exec 3>"$work/monitor"
    until grep -q 'shown\|error' "$work/said" || ! kill -0 $! 2>/dev/null; do sleep 0.1; done
    echo "screendump $work/screen.ppm" >&3
    echo quit >&3
    exec 3>&-
    wait
    [ -s "$work/screen.ppm" ] || { cat "$work/said"; return 1; }
}

screen_is_golden() {
    shown 3 && equal "$("$B/tests/test_strip" "$work/screen.ppm")" \
        "640x480 $("$B/tests/test_strip" "$scene" 640 480 64 | sed -n 's/^step 2 //p')"
}
if [ "$FXS_PROCESSORS" = all ]; then
    check "vexpress-a9 builds" firmware "$scene" vexpress-a9
    check "vexpress-a9 shows the picture of the host" screen_is_golden
fi

# ---- A scene that moves ----------------------------------------------------------------------------------------------

scene=$work/moving.fxs
splatv "$work/moving.splatv" 20000
check "makes a scene that moves" "$B/fixsplat" convert "$work/moving.splatv" "$scene"
check "builds with a scene that moves" firmware "$scene"
for board in $boards; do
    check "$board: 20,000 moving Gaussians have the bytes of the host" same_hashes "$board" 160 120 4
    check "$board: a scene that moves in the least memory, and a byte less" one_byte_short "$board"
done

# ---- A scene with levels of detail ------------------------------------------------------------------------------------

draws_at_most() {
    grep -o '^step .* drawn [0-9]*' "$work/log" | awk -v budget="$budget" '
        { frames++; if ($NF > budget || $NF < 0.9 * budget) wrong = 1 }
        END { exit wrong || !frames }' || { cat "$work/log"; return 1; }
}

scene=$work/40000.fxs
check "makes a scene with levels" make_scene 40000 --levels --profile small
check "builds with a scene with levels" firmware "$scene"
for board in $boards; do
    budget=
    check "$board: all of a scene with levels" same_hashes "$board" 320 240 1 memory=1000000
    for budget in 20000 5000; do
        check "$board: a budget of $budget has the bytes of the host" same_hashes "$board" 320 240 4
        check "$board: a budget of $budget is kept" draws_at_most
        check "$board: a budget of $budget in little memory" same_hashes "$board" 320 240 1 memory=200000
    done
done
budget=

# ---- Damaged contents of flash ---------------------------------------------------------------------------------------

place() {
    arm-none-eabi-readelf -SW "$1" | sed -n 's/.* \.scene *PROGBITS *[0-9a-f]* \([0-9a-f]*\) .*/0x\1/p'
}

poke() { printf "\\$(printf %o "$3")" | dd of="$1" bs=1 seek=$(($(place "$1") + $2)) conv=notrunc 2>/dev/null; }

byte() { od -An -tu1 -j "$2" -N 1 "$1" | tr -d ' '; }

damage_bytes() {
    elf=$work/damaged.elf refused=0
    for at in $(seq 0 "$1" 319); do
        cp "$made/firmware/mps3-an547.elf" "$elf"
        poke "$elf" "$at" $(($(byte "$scene" "$at") ^ 255))
        run mps3-an547 "$elf" width=64 height=48 frames=1 >"$work/log"
        case $(tail -n 1 "$work/log") in
        'exit 0') grep -q '^step 0' "$work/log" || return 1 ;;
        'exit 1') grep -q '^error: ' "$work/log" && refused=$((refused + 1)) || return 1 ;;
        *) echo "byte $at:"; cat "$work/log"; return 1 ;;
        esac
    done
    [ $((refused * $1)) -ge 40 ] || { echo "only $refused of $((320 / $1)) were refused"; return 1; }
}

other_version() {
    cp "$made/firmware/mps3-an547.elf" "$work/version.elf"
    poke "$work/version.elf" 4 99
    refuses mps3-an547 "$work/version.elf" frames=1 version
}

scene=$work/700.fxs
check "makes a smaller scene" make_scene 700
check "builds with another scene" firmware "$scene"
check "three chunks" same_hashes mps3-an547 64 48 1
check "a scene of another version" other_version
check "bytes of the headers damaged" damage_bytes $([ "$FXS_PROCESSORS" = all ] && echo 1 || echo 3)
head -c 10000 "$scene" >"$work/short.fxs"
check "builds with a scene cut short" firmware "$work/short.fxs"
check "a scene cut short" refuses mps3-an547 "$made/firmware/mps3-an547.elf" frames=1 'scene'
finish
