#!/bin/sh
# Compares frame times of the npm package and of the native command. Needs an idle machine.
. tests/scripts/lib/check.sh
. tests/scripts/lib/web.sh
needs web_speed
grep -q ' sse4_1 ' /proc/cpuinfo || { skip web_speed "no SSE4.1 here to compare with"; finish; exit; }

# WebAssembly's relaxed SIMD needs a flag in Node 20; newer versions of Node refuse this flag.
relax=--experimental-wasm-relaxed-simd
node $relax -e 0 2>/dev/null || relax=
web() { node --no-warnings --expose-gc $RELAX tests/web/package.mjs "$package" "$@"; }

in_turns() {
    scene=$1 camera=$2 width=${3%x*} height=${3#*x} size=$3
    shift 3
    for turn in 1 2 3; do
        for module in $([ $turn = 1 ] && echo core) simd threads; do
            for RELAX in '' $([ $module = core ] || echo $relax); do
                printf '%s%s %s\n' $module "${RELAX:+,relaxed}" "$(web speed $module "$scene" "$camera" $width $height)"
            done
            RELAX=
        done
        for threads in 1 2; do
            printf 'native%s ' $threads
            "$B/fixsplat" bench "$scene" --size "$size" --cpu sse41 --threads $threads "$@" |
                awk '$1 == "frame" { print $2 }'
        done
    done >>"$work/times"
}

table() {
    awk -v size="$1" '
        !($2 > 0) { failed = 1 }
        { if (!($1 in least) || $2 < least[$1]) least[$1] = $2 }
        function is(name, native) { return sprintf("%.1f, %.2f of native", least[name], least[name] / least[native]) }
        END {
            printf "  %s, least milliseconds a frame and their part of sse41'"'"'s:\n", size
            printf "  one thread: without simd128 %s; simd128 %s; relaxed %s\n", is("core", "native1"), \
                is("simd", "native1"), ("simd,relaxed" in least) ? is("simd,relaxed", "native1") : "not here"
            printf "  two: simd128 %s; relaxed %s\n", is("threads", "native2"), \
                ("threads,relaxed" in least) ? is("threads,relaxed", "native2") : "not here"
            exit failed || least["threads"] > 2 * least["native2"]
        }' "$work/times" >"$work/table"
}

speed() {
    for again in 1 2 3; do
        in_turns "$@" && table "$3" && break
    done
    table "$3" || { cat "$work/table"; return 1; }
}

make_scene() {
    "$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply" >/dev/null &&
        "$B/fixsplat" convert "$work/scene.ply" "$work/scene.fxs" >/dev/null
}

check "builds" builds
if [ -d "$scenes" ]; then
    camera=$(node -e 'console.log(JSON.stringify(JSON.parse(require("fs").readFileSync(process.argv[1]))[0]))' \
        "$scenes/snowmiku/cameras.json")
    check "packs snowmiku" "$B/fixsplat" convert "$scenes/snowmiku/snowmiku.ply" "$work/scene.fxs"
    check "speed" speed "$work/scene.fxs" "$camera" 1280x720 --cameras "$scenes/snowmiku/cameras.json" --view 0
else
    skip scenes "no $scenes"
    check "makes a scene" make_scene
    check "speed" speed "$work/scene.fxs" '{}' 1280x720
fi
cat "$work/table"
finish
