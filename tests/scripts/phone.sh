#!/bin/sh
# Simulates a phone (AArch64, OpenGL ES 3.0) with qemu-user and Mesa's software driver, and compares pictures.
# docs/porting.md lists the arm64 libraries that Debian needs.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
arm=aarch64-linux-gnu-gcc
made=$work/made

if [ "$FXS_PROCESSORS" != all ]; then
    skip phone "only in make test-all"
elif ! have $arm || ! have qemu-aarch64; then
    skip phone "no $arm or no qemu-aarch64 here"
elif ! echo '#include <SDL.h>
#include <EGL/egl.h>
int main(int argc, char **argv) { (void)argc, (void)argv; return SDL_Init(0) + !eglGetError(); }' |
    $arm -I/usr/include/SDL2 -x c - -lSDL2 -lEGL -o "$work/links" 2>/dev/null; then
    skip phone "no libraries of arm64 here: docs/porting.md says how to get them"
else
    mkdir "$work/by_qemu"
    cat >"$work/by_qemu/fixsplat" <<END
#!/bin/sh
program=$made/fixsplat
if [ "\$1" = view ]; then
    program=$made/fixsplat-view
    shift
fi
exec qemu-aarch64 \$program "\$@"
END
    chmod +x "$work/by_qemu/fixsplat"
    fixsplat=$work/by_qemu/fixsplat
    programs=$(printf "$made/tests/%s " test_gles test_window)
    check "builds for AArch64" sh -c "env -u MAKEFLAGS make -s B=$made CC=$arm NVCC=none all $programs >$work/log 2>&1 ||
        { cat $work/log; exit 1; }"
    "$B/fixsplat" make-scene knot --count 20000 -o "$work/knot.ply"
    hash=$("$B/fixsplat" render "$work/knot.ply" --size 320x240 --hash)
    hash_by() { "$fixsplat" render "$work/knot.ply" --size 320x240 --hash --backend "$1" --cpu "$2"; }
    check "its processor, plain C" equal "$(hash_by cpu c)" "$hash"
    check "its processor, NEON" equal "$(hash_by cpu neon)" "$hash"
    check "GLES by lists or fetch" equal "$(hash_by gles all)" "$hash"
    check "GLES by fetch" equal "$(hash_by gles-fetch all)" "$hash"
    passes() { FXS_SCENES=/none qemu-aarch64 "$made/tests/$1" >"$work/log" 2>&1 || { cat "$work/log"; return 1; }; }
    check "test_gles" passes test_gles
    check "test_window" passes test_window
    check "the window, by its keys" sh -c "FXS_EMULATED=1 B=$work/by_qemu sh tests/scripts/window.sh >$work/log 2>&1 ||
        { cat $work/log; exit 1; }"
fi
finish
