#!/bin/sh
# Tests the npm package in Node and in Chromium: pictures equal to the command's, error messages, memory and download
# sizes. FXS_PROCESSORS=all adds a view of every captured scene.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs web

# WebAssembly's relaxed SIMD needs a flag in Node 20; newer versions of Node refuse this flag.
relax=--experimental-wasm-relaxed-simd
node $relax -e 0 2>/dev/null || relax=
trap 'kill $nodes 2>/dev/null; rm -rf "$work"' EXIT

# start_node NAME PROGRAM [FLAG]: starts tests/web/PROGRAM.mjs for the requests of `ask NAME`.
start_node() {
    mkdir "$work/$1" && mkfifo "$work/$1/ask" "$work/$1/status" || exit 1
    node --no-warnings --expose-gc $3 "tests/web/$2.mjs" "$package" serve "$work/$1" &
    nodes="$nodes $!"
}

# ask NAME WORD ARGUMENT...: runs WORD in a Node process that start_node started, and prints its output.
ask() {
    asked=$work/$1
    shift
    (IFS=$(printf '\037') && printf %s "$*") >"$asked/ask"
    status=$(timeout 300 cat "$asked/status") && cat "$asked/said" && return "$status"
}
web() { ask package$RELAX "$@"; }

# The program test_kernels must pass with the exact products of WebAssembly SIMD, and with the relaxed products that
# fixsplat.js inserts.
kernels_are_exact() {
    for relaxed in '' $([ "$(RELAX=$relax web relaxed)" = true ] && echo yes); do
        RELAXED=$relaxed node --no-warnings $relax tests/web/wasi.mjs "$B/web/test_kernels.wasm" >"$work/log" 2>&1
        grep -q '^simd128' "$work/log" && tail -n 1 "$work/log" | grep -q '^8 passed, 0 failed' && continue
        cat "$work/log"
        return 1
    done
}

products_are_found() {
    for name in simd threads; do
        is=$(wasm-dis --all-features "$package/$name.wasm" 2>/dev/null | grep -c i16x8.q15mulr_sat_s)
        [ "$is" -gt 0 ] && equal "$(web products "$package/$name.wasm")" "$is" || return 1
    done
}

same_picture() {
    camera=$1 options=$2 objects=$3 files=
    shift 3
    while [ "$1" != -- ]; do files="$files $1"; shift; done
    shift
    want=$("$B/fixsplat" render $files "$@" -o "$work/picture.ppm" --hash) || return 1
    for module in core simd threads; do
        [ $module = threads ] && RELAX=$relax
        equal "$(web hash $module "$camera" "$options" "$objects" $files)" "$want" || return 1
        RELAX=
    done
}

renders() {
    "$B/fixsplat" convert "$1" "$work/scene.fxs" >/dev/null &&
        same_picture '{}' '{"width":640,"height":360}' '[]' "$work/scene.fxs" -- --size 640x360
}

threads_work() {
    want=$("$B/fixsplat" render "$knot" --size 320x200 -o "$work/picture.ppm" --hash) &&
        timeout 100 node --no-warnings tests/web/threads.mjs "$package" "$knot" "$other" "$want" >"$work/log" 2>&1 && return
    tail -n 12 "$work/log"
    return 1
}

same_packed() {
    packed=$1 profile=$2
    shift 2
    "$B/fixsplat" convert "$packed" "$work/packed.fxs" --profile "$profile" >/dev/null || return 1
    for module in ${*:-threads}; do
        web pack "$packed" "$profile" $module >"$work/web.fxs" && cmp "$work/packed.fxs" "$work/web.fxs" || return 1
    done
}

make_scene() {
    "$B/fixsplat" make-scene knot --count "$1" -o "$work/$1.ply" >/dev/null &&
        for profile in default compact small; do
            "$B/fixsplat" convert "$work/$1.ply" "$work/$1-$profile.fxs" --profile $profile >/dev/null || return 1
        done
}

same_pair() {
    left=$1 right=$2 options=$3
    shift 3
    "$B/fixsplat" render "$knot" "$@" -o "$work/native.raw" >/dev/null || return 1
    for module in core simd threads; do
        web stereo $module "$knot" "$left" "$right" "$options" "$work/pair.raw" &&
            cmp "$work/native.raw" "$work/pair.raw" || return 1
    done
}

same_targets() {
    set -- --size 160x120 --eye 2,-1,-4 --near 0.5
    for kind in median mean; do
        "$B/fixsplat" render "$knot" "$@" --alpha -o "$work/native.raw" --ids "$work/native-ids.raw" \
            --depth "$work/$kind-native.pfm" --depth-kind $kind >/dev/null || return 1
    done
    for module in core simd threads; do
        web targets $module "$knot" '{"eye":[2,-1,-4],"near":0.5}' '{"width":160,"height":120,"depthBits":27}' "$work" &&
            cmp "$work/native.raw" "$work/colour.raw" && cmp "$work/native-ids.raw" "$work/ids.raw" &&
            cmp "$work/median-native.pfm" "$work/depth.pfm" && cmp "$work/mean-native.pfm" "$work/mean.pfm" || return 1
    done
}

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

canvas_is_the_same() {
    rm -f "$work/served"
    node tests/web/serve.mjs "$package" "$knot" >"$work/served" &
    server=$!
    until [ -s "$work/served" ] || ! kill -0 $server; do sleep 0.1; done
    chromium --headless --no-sandbox --disable-gpu --user-data-dir="$work/chromium" --remote-debugging-port=0 \
        "$(cat "$work/served")/$1" >"$work/log" 2>&1 &
    tries=600
    until [ "$(wc -l <"$work/served")" -gt 1 ] || [ $tries = 0 ]; do sleep 0.1; tries=$((tries - 1)); done
    kill $! $server
    wait $! $server 2>/dev/null
    want=$("$B/fixsplat" render "$knot" --size 320x200 -o "$work/picture.ppm" --hash)
    [ "$(tail -n +2 "$work/served")" = "hash $want, threads $2, refused" ] && return
    tail -n 3 "$work/served" "$work/log"
    return 1
}

reader() { ask import "$@"; }
readers() {
    mkdir "$work/formats" "$work/bombs"
    "$B/tests/test_scene_input" --write "$work/formats" >"$work/formats.txt" || return 1
    while read -r file; do
        if ls "$work/formats/${file%/*}"/*.png >/dev/null 2>&1; then
            skip "packs $file" "gsplat's folder of .png: the modules have no libpng"
            continue
        fi
        check "packs $file" same_packed "$work/formats/$file" default
        if ls "$work/formats/${file%.rad}"-*.radc >/dev/null 2>&1; then
            check "$file by its parts" reader beside "$work/formats/$file"
            continue
        fi
        case $file in
        *.json | *.gltf | *.lcc) check "$file by its parts" reader beside "$work/formats/$file" ;;
        *) check "hurt: $file" reader hurt "$work/formats/$file" ;;
        esac
    done <"$work/formats.txt"
    if "$B/tests/test_bombs" --write "$work/bombs" >"$work/log"; then
        check "bombs" reader bombs "$work/bombs"
    else
        skip "bombs" "built without zlib, libwebp, libzip or cJSON"
    fi
}
both_at_most() {
    bytes=$(cat "$package/import_threads.wasm" "$package/threads.wasm" | gzip -9c | wc -c)
    [ "$bytes" -le "$1" ] || { echo "$bytes bytes gzipped, more than $1"; return 1; }
}

check "builds" builds "$B/web/test_kernels.wasm"
start_node package package
[ -z "$relax" ] || start_node "package$relax" package "$relax"
start_node import import
check "test_kernels in WebAssembly" kernels_are_exact
check "products" products_are_found
for size in core.wasm:70000 simd.wasm:104300 threads.wasm:104600 import.wasm:101700 import_threads.wasm:101900 \
    import_sog.wasm:101700 import_core.wasm:128500 fixsplat.js:40000; do
    check "size of ${size%:*}" at_most "${size#*:}" "$package/${size%:*}"
done
check "makes a scene" make_scene 20000
check "makes a small scene" make_scene 700
knot=$work/20000-default.fxs other=$work/700-small.fxs
for profile in default compact small; do
    check "framed, $profile" same_picture '{}' '{"width":320,"height":200}' '[]' "$work/20000-$profile.fxs" -- \
        --size 320x200
done
"$B/fixsplat" convert "$work/700.ply" "$work/start.fxs" --start-view 1,-2,-7,0.1,0.2,0,40
"$B/fixsplat" convert "$work/700.ply" "$work/leant.fxs" --up 0.2,-0.5,0.1 --rotate 0,0,30
check "chosen by what is up" same_picture '{}' '{"width":320,"height":200}' '[]' "$work/leant.fxs" -- --size 320x200
check "a start view" same_picture '{}' '{"width":320,"height":200}' '[]' "$work/start.fxs" -- --size 320x200
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
"$B/fixsplat" convert "$work/20000.ply" "$work/levels.fxs" --levels --profile small >/dev/null
check "a budget" same_picture '{"eye":[2,-1,-4]}' '{"width":200,"height":150,"budget":6000}' '[]' \
    "$work/levels.fxs" -- --size 200x150 --eye 2,-1,-4 --budget 6000
check "detail of two objects, one with levels" same_picture '{"eye":[1,-2,-9]}' \
    '{"width":200,"height":150,"detail":2.5,"budget":9000}' '[{},{"translation":[1,0.5,-2]}]' \
    "$work/levels.fxs" "$other" -- --size 200x150 --eye 1,-2,-9 --place "$other:1,0.5,-2" --detail 2.5 --budget 9000
check "what budgets draw" web budgets "$work/levels.fxs"
pages() {
    "$B/fixsplat" make-scene knot --count 150000 -o "$work/150000.ply" >/dev/null &&
        "$B/fixsplat" convert "$work/150000.ply" "$work/paged.fxs" --levels --profile small >/dev/null 2>&1
}
check "makes a scene that comes in parts" pages
want=$("$B/fixsplat" render "$work/paged.fxs" --size 200x150 --eye 2,-1,-4 --budget 6000 --hash)
node --no-warnings tests/web/paging.mjs "$package" "$work/paged.fxs" "$want" >"$work/asked" 2>&1 ||
    echo "FAIL paging.mjs: a check above, or it ended early" >>"$work/asked"
counts
# frames NAME: writes the frames of a moving scene of 30 frames, of which each is other Gaussians.
frames() {
    mkdir "$work/$1" || return 1
    for frame in $(seq 101 130); do
        "$B/fixsplat" make-scene knot --count 3000 --seed $frame -o "$work/$1/$frame.ply" >/dev/null || return 1
    done
    "$B/fixsplat" convert "$work/$1" "$work/$1.fxs" --quiet
}
check "makes a moving scene" frames moving
for time in 0 0.5 0.99 -7.3; do
    check "at $time seconds" same_picture '{"eye":[2,-1,-4]}' '{"width":200,"height":150,"time":'$time'}' '[]' \
        "$work/moving.fxs" -- --size 200x150 --eye 2,-1,-4 --time $time
done
"$B/fixsplat" convert "$work/moving.fxs" "$work/moving_levels.fxs" --levels --quiet
check "levels of detail of a moving scene" same_picture '{"eye":[2,-1,-4]}' \
    '{"width":200,"height":150,"time":0.5,"budget":600}' '[]' "$work/moving_levels.fxs" -- \
    --size 200x150 --eye 2,-1,-4 --time 0.5 --budget 600
node --no-warnings tests/web/moving_parts.mjs "$package" "$work/moving.fxs" "$work/moving_levels.fxs" >"$work/asked" 2>&1 ||
    echo "FAIL moving_parts.mjs: a check above, or it ended early" >>"$work/asked"
counts
served_in_parts() {
    "$B/fixsplat" view --web --port 0 "$work/paged.fxs" >"$work/address" 2>&1 &
    server=$!
    until [ -s "$work/address" ] || ! kill -0 $server 2>/dev/null; do sleep 0.1; done
    got=$(web parts "$(head -n 1 "$work/address")scenes/0/paged.fxs" '{"eye":[2,-1,-4]}' \
        '{"width":200,"height":150,"budget":6000}')
    kill $server
    wait $server 2>/dev/null
    equal "$got" "$("$B/fixsplat" render "$work/paged.fxs" --size 200x150 --eye 2,-1,-4 --budget 6000 --hash)"
}
if [ -e "$B/fixsplat-web" ]; then
    check "in parts by view --web" served_in_parts
else
    skip "view --web" "built without libmicrohttpd"
fi
check "coverage, depths, ids, formats" same_targets
eyes='--size 128x96 --eye 0,-2,-9 --look 0,-2,0 --near 0.5'
check "two eyes" same_pair '{"eye":[-0.25,-2,-9],"look":[-0.25,-2,0],"near":0.5}' \
    '{"eye":[0.25,-2,-9],"look":[0.25,-2,0],"near":0.5}' '{"width":128,"height":96}' $eyes --stereo 0.5
seen='"fx":64,"fy":48,"cy":60,"rotation":[[1,0,0],[0,1,0],[0,0,1]],"near":0.5'
check "two eyes of a headset" same_pair "{\"cx\":72,\"position\":[-0.25,-2,-9],$seen}" \
    "{\"cx\":56,\"position\":[0.25,-2,-9],$seen}" '{"width":128,"height":96}' \
    $eyes --stereo 0.5 --tangents -1.125,0.875,1.25,-0.75
check "pick" pick_is_the_same
check "png" web png "$knot"
check "the example of the README" example
check "threads" threads_work
if have chromium; then
    check "in Chromium" canvas_is_the_same page.html 1
    check "in Chromium, without simd128" canvas_is_the_same 'page.html?plain' 1
    check "in Chromium, isolated" canvas_is_the_same 'isolated/page.html?threads=2' 2
    check "in Chromium, without workers" canvas_is_the_same 'blocked/page.html?threads=1' 1
else
    skip chromium "not here"
fi
for source in fxs ply; do
    file=$work/700.ply
    [ $source = fxs ] && file=$work/700-compact.fxs
    check "damaged and cut: .$source" web damage "$file"
done
check "sources" web sources "$work/700-default.fxs"
"$B/fixsplat" make-scene knot --count 3000 -o "$work/3000.ply" >/dev/null
for module in simd threads; do
    check "50 loads and unloads, $module" web memory $module "$work/3000.ply"
done
for profile in default compact small; do
    check "packs a .ply, $profile" same_packed "$work/700.ply" $profile core simd threads
done
check "packs a large .ply" same_packed "$work/150000.ply" default threads
check "a large scene's preview" reader sampled
check "makes a .splat" "$B/fixsplat" convert "$work/700.ply" "$work/700.splat"
check "makes an .spz" "$B/fixsplat" convert "$work/700.ply" "$work/700.spz" --spz-version 3
for kind in splat spz; do
    check "packs a .$kind" same_packed "$work/700.$kind" default
done
check "damaged and cut: .spz" web damage "$work/700.spz"
check "misuse" web misuse "$work/700-default.fxs" "$work/700.ply"
check "no room for a picture" web noRoom "$work/700-default.fxs"
check "previews" reader preview "$work/20000.ply"
mkdir -p "$work/streamed/plain"
check "makes a streamed .sog" "$B/fixsplat" convert "$work/700.ply" "$work/streamed/plain/lod-meta.json"
check "makes a .sog" "$B/fixsplat" convert "$work/20000.ply" "$work/20000.sog"
if [ -e "$B/web/libs" ]; then
    check "a scene chooses no other files" reader names "$work/streamed"
    check "slow servers, and loading that is ended" reader slow "$work/20000.sog"
else
    skip "names in scenes, slow servers" "no sources of libraries: make setup web"
fi
check "bodies without an end" reader endless "$work/700.ply" "$work/700-default.fxs"
check "from https to http" reader redirected "$work/paged.fxs"
check "size of both" both_at_most 206100
if [ -e "$B/web/libs" ]; then
    readers
else
    skip readers "no sources of libraries: make setup web"
    check "an .spz of version 4" "$B/fixsplat" convert "$work/700.ply" "$work/4.spz"
    check "says what is missing" reader without "$work/4.spz"
fi
if [ -d "$scenes" ]; then
    compressed='kitchen-marble/kitchen-marble.spz skull/skull.sog boatyard-tile3/boatyard-tile3.glb'
    [ -e "$B/web/libs" ] || compressed=
    for scene in guitar/guitar.compressed.ply luma-seal/luma-seal.splat $compressed; do
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
    if [ "$FXS_PROCESSORS" = all ]; then
        for scene in "$scenes"/*/*.ply "$scenes"/*/*.sog "$scenes"/*/*.glb "$scenes"/*/*.spz "$scenes"/*/*.splat; do
            check "renders $(basename "$scene")" renders "$scene"
        done
    fi
else
    skip scenes "no $scenes"
fi
cat "$work/sizes"
finish
