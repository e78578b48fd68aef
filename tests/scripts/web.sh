#!/bin/sh
# The npm package (docs/web.md), in Node and a page of Chromium: the bytes of the command, with simd128 and without;
# errors in words; memory and download sizes within their limits; test_kernels as a program of WASI.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
scenes=${FXS_SCENES:-../shared/scenes}
made=$work/made package=$work/made/web/package

missing=
for program in clang wasm-ld wasm-opt node; do have $program || missing="$missing $program"; done
if [ -z "$missing" ] && ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E - >/dev/null 2>&1; then
    missing=' wasi-libc'
fi
if [ -n "$missing" ]; then
    skip web "not here:$missing"
    finish
    exit
fi

builds() {
    said=$(env -u MAKEFLAGS make -s B="$made" NVCC=none web "$made/web/test_kernels.wasm" 2>&1 | grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

web() { node --no-warnings --expose-gc tests/web/package.mjs "$package" "$@"; }

kernels_are_exact() {
    node --no-warnings tests/web/wasi.mjs "$made/web/test_kernels.wasm" >"$work/log" 2>&1
    grep -q '^simd128' "$work/log" && tail -n 1 "$work/log" | grep -q '^7 passed, 0 failed' && return
    cat "$work/log"
    return 1
}

# at_most BYTES FILE: gzipped.
at_most() {
    bytes=$(gzip -9c "$2" | wc -c)
    echo "  $(basename "$2"): $bytes bytes gzipped, at most $1" >>"$work/said"
    [ "$bytes" -le "$1" ] || { echo "$2 has $bytes bytes gzipped, more than $1"; return 1; }
}

# same_picture CAMERA OPTIONS OBJECTS FXS... -- OPTION...: by both modules, that of `fixsplat render FXS... OPTION...`.
same_picture() {
    camera=$1 options=$2 objects=$3 files=
    shift 3
    while [ "$1" != -- ]; do files="$files $1"; shift; done
    shift
    want=$("$B/fixsplat" render $files "$@" -o "$work/picture.ppm" --hash) || return 1
    for simd in 0 1; do
        equal "$(web hash $simd "$camera" "$options" "$objects" $files)" "$want" || return 1
    done
}

# same_packed FILE PROFILE: the module packs as `fixsplat convert` does.
same_packed() {
    "$B/fixsplat" convert "$1" "$work/packed.fxs" --profile "$2" >/dev/null && web pack "$1" "$2" >"$work/web.fxs" &&
        cmp "$work/packed.fxs" "$work/web.fxs"
}

make_scene() {
    "$B/fixsplat" make-scene knot --count "$1" -o "$work/$1.ply" >/dev/null &&
        for profile in default compact small; do
            "$B/fixsplat" convert "$work/$1.ply" "$work/$1-$profile.fxs" --profile $profile >/dev/null || return 1
        done
}

# The example of the README renders a picture of the scene.
example() {
    mkdir -p "$work/example/node_modules" && cp "$work/20000-default.fxs" "$work/example/scene.fxs" &&
        ln -s "$package" "$work/example/node_modules/fixsplat" &&
        sed -n '/^```js/,/^```/p' port/web/README.md | sed '1d;/^```/,$d' >"$work/example/a.mjs" &&
        (cd "$work/example" && node a.mjs) && [ "$(head -c 4 "$work/example/scene.png" | tail -c 3)" = PNG ]
}

pick_is_the_same() {
    want=$("$B/fixsplat" render "$knot" --size 200x150 --pick 100,75 --json) || return 1
    got=$(web pick "$knot" '{}' '{"width":200,"height":150}' 100 75) || return 1
    number=${got% *}
    printf '%s' "$want" | grep -Eq "\"gaussian\": ?$number\\b" || { echo "$got, not $want"; return 1; }
}

# A canvas in Chromium has the same pixels; QUERY: ?plain for the module without simd128.
canvas_is_the_same() {
    rm -f "$work/address"
    node tests/web/serve.mjs "$package" "$knot" >"$work/address" &
    until [ -s "$work/address" ] || ! kill -0 $!; do sleep 0.1; done
    timeout 100 chromium --headless --no-sandbox --disable-gpu --virtual-time-budget=20000 --dump-dom \
        "$(cat "$work/address")/page.html$1" >"$work/dom" 2>"$work/log"
    kill $!
    want=$("$B/fixsplat" render "$knot" --size 320x200 -o "$work/picture.ppm" --hash)
    grep -q "<p id=\"said\">hash $want, refused" "$work/dom" || { tail -n 3 "$work/dom" "$work/log"; return 1; }
}

# speed SCENE CAMERA SIZE OPTION...: milliseconds a frame of one thread, printed.
speed() {
    scene=$1 camera=$2 width=${3%x*} height=${3#*x} size=$3
    shift 3
    for turn in 1 2 3; do
        simd=$(web speed 1 "$scene" "$camera" "$width" "$height") &&
            plain=$(web speed 0 "$scene" "$camera" "$width" "$height") &&
            "$B/fixsplat" bench "$scene" --size "$size" --cpu sse41 --threads 1 "$@" >"$work/bench" || return 1
        echo "$simd $plain $(awk '$1 == "frame" { print $2 }' "$work/bench")"
    done >"$work/times"
    awk -v size="$size" 'function least(a, b) { return a && a < b ? a : b }
        { simd = least(simd, $1); plain = least(plain, $2); native = least(native, $3) }
        END { printf "  %s, one thread, least milliseconds a frame: simd128 %s, %.2f of native sse41; ", \
                  size, simd, simd / native
              printf "without %s, %.2f; native %s\n", plain, plain / native, native }' "$work/times" >>"$work/said"
}

check "builds" builds
check "test_kernels in WebAssembly" kernels_are_exact
for size in core.wasm:45000 simd.wasm:65000 import.wasm:250000 fixsplat.js:40000; do
    check "size of ${size%:*}" at_most "${size#*:}" "$package/${size%:*}"
done
check "makes a scene" make_scene 20000
check "makes a small scene" make_scene 700
knot=$work/20000-default.fxs other=$work/700-small.fxs
for profile in default compact small; do
    check "framed, $profile" same_picture '{}' '{"width":320,"height":200}' '[]' "$work/20000-$profile.fxs" -- \
        --size 320x200
done
check "eye, look, field of view" same_picture \
    '{"eye":[2,-1,-4],"look":[0,0.3,0],"fov":65,"up":[0.1,-1,0.2],"near":0.5}' \
    '{"width":131,"height":77,"background":1122867}' '[]' \
    "$knot" -- --size 131x77 --eye 2,-1,-4 --look 0,0.3,0 --fov 65 --up 0.1,-1,0.2 --near 0.5 --bg 112233
check "coverage, SH degree 1, square, in bands" same_picture '{}' \
    '{"width":200,"height":150,"alpha":true,"shDegree":1,"cutoff":"square","maxMemory":400000}' '[]' \
    "$knot" -- --size 200x150 --alpha --sh-degree 1 --cutoff square --max-memory 400000
check "two objects" same_picture '{"eye":[1,-2,-9]}' '{"width":200,"height":150}' \
    '[{},{"translation":[1,0.5,-2],"rotation":[0.5,0.5,-0.5,0.5],"scale":0.75}]' \
    "$knot" "$other" -- --size 200x150 --eye 1,-2,-9 --place "$other:1,0.5,-2,0.5,0.5,-0.5,0.5,0.75"
check "pick" pick_is_the_same
check "png" web png "$knot"
check "the example of the README" example
if have chromium; then
    check "in Chromium" canvas_is_the_same ''
    check "in Chromium, without simd128" canvas_is_the_same '?plain'
else
    skip chromium "not here"
fi
for source in fxs ply; do
    file=$work/700.ply
    [ $source = fxs ] && file=$work/700-compact.fxs
    check "damaged and cut: .$source" web damage "$file"
done
check "sources" web sources "$work/700-default.fxs"
check "50 loads and unloads" web memory "$work/20000.ply"
for profile in default compact small; do
    check "packs a .ply, $profile" same_packed "$work/700.ply" $profile
done
check "makes a .splat" "$B/fixsplat" convert "$work/700.ply" "$work/700.splat"
check "makes an .spz" "$B/fixsplat" convert "$work/700.ply" "$work/700.spz" --spz-version 3
for kind in splat spz; do
    check "packs a .$kind" same_packed "$work/700.$kind" default
done
check "damaged and cut: .spz" web damage "$work/700.spz"
check "makes an .spz of version 4" "$B/fixsplat" convert "$work/700.ply" "$work/4.spz"
check "misuse" web misuse "$work/700-default.fxs" "$work/700.ply" "$work/4.spz"
if [ -d "$scenes" ]; then
    for scene in guitar/guitar.compressed.ply luma-seal/luma-seal.splat kitchen-marble/kitchen-marble.spz; do
        check "packs $scene" same_packed "$scenes/$scene" compact
        check "renders $scene" same_picture '{}' '{"width":640,"height":360}' '[]' "$work/packed.fxs" -- --size 640x360
    done
    camera=$(node -e 'console.log(JSON.stringify(JSON.parse(require("fs").readFileSync(process.argv[1]))[0]))' \
        "$scenes/snowmiku/cameras.json")
    check "packs snowmiku" same_packed "$scenes/snowmiku/snowmiku.ply" default
    check "a view of cameras.json" same_picture "$camera" '{}' '[]' "$work/packed.fxs" -- \
        --cameras "$scenes/snowmiku/cameras.json" --view 0
    check "the same, of another size" same_picture "$camera" '{"width":1280,"height":720}' '[]' "$work/packed.fxs" -- \
        --cameras "$scenes/snowmiku/cameras.json" --view 0 --size 1280x720
    check "speed" speed "$work/packed.fxs" "$camera" 1280x720 --cameras "$scenes/snowmiku/cameras.json" --view 0
else
    skip scenes "no $scenes"
    check "speed" speed "$knot" '{}' 1280x720
fi
cat "$work/said"
finish
