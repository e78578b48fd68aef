#!/bin/sh
# Tests scenes that move in the commands: --time, --times and --fps, conversion of moments, info and comparison.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/splatv.sh"

hash_of() { "$fixsplat" render "$@" --hash 2>&1; }
frames_of() { grep -ao FRAME "$1" | wc -l | tr -d ' '; }
differ() { [ "$1" != "$2" ] || { echo "both are $1"; return 1; }; }

splatv moving.splatv 1024
run convert moving.splatv moving.fxs
check "a .splatv to an .fxs" equal "$status" 0
"$fixsplat" make-scene knot --count 300 -o still.ply || exit 1
small='--size 64x48 --eye 0,0,-4 --look 0,0,0'
moving="moving.fxs $small"
# alike FLOOR "SCENE OPTION..." "SCENE OPTION...": the pictures of two scenes have a PSNR of at least FLOOR.
alike() {
    "$fixsplat" render $2 $small -o alike-1.png && "$fixsplat" render $3 $small -o alike-2.png || return
    at_least "$("$fixsplat" compare alike-1.png alike-2.png | awk '/PSNR/ { print $2 }')" "$1"
}

# ---- Films -----------------------------------------------------------------------------------------------------------

for t in 0 0.25 0.5 0.75; do hash_of $moving --time $t; done >moments
check "--time: moments differ" equal "$(sort -u moments | wc -l | tr -d ' ')" 4
check "--times: the pictures of --time" equal "$(hash_of $moving --times all --fps 4)" "$(cat moments)"
check "--times A..B: until before B" equal "$(hash_of $moving --times 0.25..0.75 --fps 4)" "$(sed -n 2,3p moments)"
check "--times: a scene that loops starts again" equal "$(hash_of $moving --times 1..2 --fps 4)" "$(cat moments)"
check "--times before 0, of a scene that loops" equal "$(hash_of $moving --times=-0.5..0 --fps 4)" "$(sed -n 3,4p moments)"
check "--times of a .splatv" equal "$(hash_of moving.splatv $small --times all --fps 4)" "$(cat moments)"
mkdir out
succeeds "--times: numbered pictures" render $moving --times 0..0.5 --fps 8 -o out/%02d.png
check "--times: numbered pictures: their number" equal "$(ls out | tr '\n' ' ')" "00.png 01.png 02.png 03.png "
succeeds "--times: a film" render $moving --times all -o film.y4m
check "--times: 30 frames a second of a scene without a rate" equal "$(head -n 1 film.y4m | cut -d ' ' -f 4)" F30:1
check "--times: the frames of a film" equal "$(frames_of film.y4m)" 30
succeeds "--times: a rate that is a fraction" render $moving --times 0..0.5 --fps 24000/1001 -o film.y4m
check "--times: a rate that is a fraction: the frames" equal "$(frames_of film.y4m)" 12

orbit=$(hash_of $moving --orbit 2 --times all --fps 4)
check "--orbit and --times: two frames of each view" equal "$(echo "$orbit" | sed -n 1,2p)" "$(sed -n 1,2p moments)"
check "--orbit and --times: the other side" differ "$(echo "$orbit" | sed -n 3,4p)" "$(sed -n 3,4p moments)"
cat >cameras.json <<'END'
[{"id": 0, "img_name": "a", "width": 64, "height": 48, "position": [0, 0, -4],
  "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 50, "fy": 50},
 {"id": 1, "img_name": "b", "width": 64, "height": 48, "position": [0.5, 0, -4],
  "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 50, "fy": 50}]
END
views='moving.fxs --cameras cameras.json'
check "--view and --times: the views share the frames" equal "$(hash_of $views --view all --times all --fps 4)" \
    "$(for t in 0 0.25; do hash_of $views --time $t; done; for t in 0.5 0.75; do hash_of $views --view 1 --time $t; done)"
check "--view and --times: fewer frames than views" equal "$(hash_of $views --view 0,1,0,1 --times 0..0.5 --fps 4)" \
    "$(for t in 0 0.25; do hash_of $views --time $t; done)"
blurred=$(hash_of $moving --times 0.25..0.5 --fps 4 --shutter 360 --samples 8)
check "--shutter of --times: blurred by the motion" differ "$blurred" "$(sed -n 2p moments)"
check "--threads: the same film" equal "$(hash_of $moving --times all --fps 4 --threads 1 --max-memory 200K)" "$(cat moments)"

expected='expected A\.\.B, seconds, B after A'
for times in nan..1 0..inf 1..0 1..1 1.. ..1 1 x 0..1e7; do
    fails "--times $times" 2 "^fixsplat: --times .*$expected" render $moving --times $times -o film.y4m
done
fails "--times: 10 million frames" 1 'times: 10000000 frames: at most 100000' render $moving --times 0..10000 --fps 1000 -o film.y4m
fails "--times of a still scene" 1 'still.ply: does not move: no --times' render still.ply $small --times all -o film.y4m
fails "--time of a still scene" 1 'still.ply: does not move: no --time$' render still.ply $small --time 1 -o a.png
fails "--times of one picture" 2 'a.png: for 30 views, expected a name with one %d' render $moving --times all -o a.png
fails "--times with --time" 2 'time does not go with --times' render $moving --times all --time 1 -o film.y4m
fails "--times with --write-cameras" 2 'its frames share cameras' render $moving --times all --write-cameras c.json

# ---- Bench -----------------------------------------------------------------------------------------------------------

run bench $moving --times all --fps 8 --json
cp logs/out times.json
check "bench --times: mean and the slowest moment" sh -c \
    'grep -q "\"frames\": 8,.*\"times_to\": 1, \"frame_ms_mean\": [0-9.]*, \"slowest_at\": 0.*\"frame_ms\"" times.json'
run bench $moving --times all --fps 8 --compare times.json
check "bench --times --compare" sh -c 'grep -q "8 frames over its times" logs/out && grep -q "^  mean .*; the slowest is at" logs/out'
fails "bench --compare: other times" 1 'cannot be compared: times_from: 0 there, 0.5 here' \
    bench $moving --times 0.5..1.5 --fps 8 --compare times.json
fails "bench --fps without --times" 2 'fps needs --times' bench $moving --fps 8

# ---- Convert ---------------------------------------------------------------------------------------------------------

run convert moving.splatv again.fxs
check "convert: no note about the quality" equal "$status $(cat logs/err)" "0 "
succeeds "convert --time" convert moving.splatv moment.ply --time 0.5
run render moment.ply $small -o moment.png
run render $moving --time 0.5 -o packed.png
check "convert --time: as the scene then" at_least "$("$fixsplat" compare moment.png packed.png | awk '/PSNR/ { print $2 }')" 45
succeeds "convert --time of an .fxs" convert moving.fxs moment.spz --time 0.5
run convert moving.splatv part.ply --time 0.5 --crop 0,-9,-9,9,9,9
check "convert --time with a filter" grep -q '^fixsplat: moving.splatv: kept [1-9][0-9]* of ' logs/err
succeeds "convert --time, placed" convert moving.splatv still.ply both.ply --time 0.5 --place 0:1,0,0
succeeds "convert --time to an .fxs with levels" convert moving.splatv moment.fxs --time 0.5 --levels
check "convert --time to an .fxs: it is still" sh -c "! '$fixsplat' info moment.fxs | grep -q ^moves"
succeeds "convert --levels" convert moving.splatv levels.fxs --levels
at_quarter="levels.fxs $small --time 0.25 --hash"
levels=$("$fixsplat" render $at_quarter --budget 500)
check "levels, read in parts" equal "$("$fixsplat" render $at_quarter --budget 500 --pool 1M)" "$levels"
check "levels: fewer Gaussians, another picture" [ "$levels" != "$("$fixsplat" render $at_quarter)" ]
fails "levels of a moving scene are not refined" 1 \
    "moving.splatv: a scene that moves is not refined: give --time SECONDS" \
    convert moving.splatv refined.fxs --levels --refine
mkdir frames
succeeds "convert --times" convert moving.fxs frames/%04d.splat --times all --fps 4
check "convert --times: its files" equal "$(ls frames | tr '\n' ' ')" "0000.splat 0001.splat 0002.splat 0003.splat "
run convert moving.fxs one.splat --time 0.75
check "convert --times: the bytes of --time" cmp one.splat frames/0003.splat
for ending in ply spz sog splat glb csv compressed.ply; do
    fails "convert to .$ending without a time" 1 \
        "moving.fxs: a scene that moves is not kept by a \\.[a-z]*: give --time SECONDS, or --times A\\.\\.B for numbered" \
        convert moving.fxs whole.$ending
done
run convert moving.fxs whole.splat4d
if [ "$status" = 1 ] && grep -q "built without zstd" logs/err; then
    skip "convert to .splat4d" "built without zstd"
else
    check "convert to .splat4d" equal "$status $(cat logs/err)" "0 "
    run info whole.splat4d
    check "convert to .splat4d: it moves" grep -q '^moves         1 seconds, again and again, 30 frames a second$' logs/out
    check "convert to .splat4d: as the scene then" at_least "$(psnr_of whole.splat4d moving.splatv --compare-time 0.5)" 42
    cp whole.splat4d before.splat4d
    run convert moving.fxs whole.splat4d
    check "convert to .splat4d: the same bytes again" cmp whole.splat4d before.splat4d
    "$fixsplat" convert still.ply plain.ply --sh-degree 0
    succeeds "convert to .splat4d, a still scene" convert plain.ply still.splat4d
    succeeds "convert --time to .splat4d" convert moving.fxs moment.splat4d --time 0.5
    succeeds "convert to .splat4d, placed and in a range of times" convert moving.fxs part.splat4d --times 0.25..0.75 \
        --scale 2 --prune 0.1
    run info part.splat4d
    check "convert to .splat4d, placed and in a range of times: it moves" grep -q '^moves         0.5 seconds' logs/out
    succeeds "convert of this .splat4d back" convert part.splat4d part.fxs --scale 0.5
    check "convert to .splat4d, placed and in a range of times: its picture" \
        alike 40 "part.fxs --time 0.3" "moving.fxs --time 0.55"
fi

# ---- Edits -----------------------------------------------------------------------------------------------------------

succeeds "convert: placing" convert moving.splatv placed.fxs --rotate 0,0,90 --scale 0.8 --translate 0.2,0.1,0.3
for t in 0 0.3 0.6; do
    check "convert: placing: as an object at $t" alike 50 "placed.fxs --time $t" \
        "moving.fxs --place 0:0.2,0.1,0.3,0.70710678,0,0,0.70710678,0.8 --time $t"
done
run convert moving.splatv upright.fxs --auto-up
check "convert --auto-up" grep -q '^fixsplat: moving.splatv: up is ' logs/err
run convert moving.splatv opaque.fxs --prune 0.95
check "convert --prune: nothing is opaque" grep -q 'none of the 1024 Gaussians is left' logs/err
run convert moving.splatv part.fxs --crop 0,-9,-9,9,9,9 --sh-degree 0
check "convert --crop" says "moving.splatv: kept 624 of 1024 Gaussians (400 outside, 0 too faint, 0 floating)"
check "convert --crop: the scene moves" sh -c "'$fixsplat' info part.fxs | grep -q '^moves         1 seconds, again and again$'"
run convert moving.splatv never.fxs --sphere 9,9,9,1
check "convert --sphere: nothing is left" grep -q 'none of the 1024 Gaussians is left' logs/err

succeeds "convert --times to an .fxs" convert moving.splatv range.fxs --times 0.25..0.75
check "convert --times to an .fxs: its duration" sh -c "'$fixsplat' info range.fxs | grep -q '^moves         0.5 seconds'"
for t in 0 0.2 0.4; do
    check "convert --times to an .fxs: at $t" alike 55 "range.fxs --time $t" "moving.fxs --time $(awk "BEGIN { print $t + 0.25 }")"
done
succeeds "convert --times to an .fxs, beyond the duration" convert moving.splatv twice.fxs --times=-0.5..1.25
for t in 0 0.6 1.6; do
    check "convert --times to an .fxs, beyond the duration: at $t" alike 55 "twice.fxs --time $t" \
        "moving.fxs --time $(awk "BEGIN { print $t + 0.5 }")"
done
succeeds "convert --times all to an .fxs" convert moving.splatv again.fxs --times all
check "convert --times all to an .fxs: the whole scene" cmp again.fxs moving.fxs

succeeds "convert: merging" convert moving.fxs still.ply twice.fxs merged.fxs --place still.ply:0.3,0,0.5 --place 2:0,1.5,0
run info merged.fxs
check "convert: merging: the longest duration" grep -q '^moves         1.75 seconds, again and again$' logs/out
for t in 0 0.7 1.4; do
    check "convert: merging: as objects at $t" alike 50 "merged.fxs --time $t" \
        "moving.fxs still.ply twice.fxs --place still.ply:0.3,0,0.5 --place 2:0,1.5,0 --time $t"
done
cat >world.json <<'END'
{"objects": [{"file": "moving.fxs", "crops": [{"low": [-9, -9, -9], "high": [0, 9, 9], "keep": "inside"}]},
             {"file": "still.ply", "tint": [1, 0.5, 0.5]}]}
END
succeeds "convert --scene" convert --scene world.json world.fxs
check "convert --scene: it moves" sh -c "'$fixsplat' info world.fxs | grep -q '^moves         1 seconds'"
succeeds "convert --levels of a placed range of times" convert moving.fxs levels.fxs --levels --times 0.25..0.75 --scale 0.5
check "convert --levels of a placed range of times: its levels" sh -c "'$fixsplat' info levels.fxs | grep -q '^level  '"
fails "convert --drop-floaters of a scene that moves" 1 'moves is not searched for floaters: give --time' \
    convert moving.fxs wrong.fxs --drop-floaters
fails "convert --thing of a scene that moves" 1 'moves is not searched for a thing: give --time' \
    convert moving.fxs wrong.fxs --thing --up 0,-1,0
fails "convert --decimate of a scene that moves" 1 'moves is not decimated: give --time' \
    convert moving.fxs wrong.fxs --decimate 50%
echo '{"format": "fixsplat edits", "version": 1, "scene": {"gaussians": 1, "checksum": "00000000"}, "edits": []}' >edits.json
run convert moving.fxs wrong.fxs --edits edits.json
check "convert --edits of a scene that moves" sh -c '
    [ "$0" = 1 ] && grep -Eq "moves is not edited by hand: give --time|built without cJSON" logs/err' "$status"
fails "convert --times: nearly nothing" 1 'times 0 to 0.0001: expected 1/1024 to 16384 seconds' \
    convert moving.fxs wrong.fxs --times 0..0.0001
fails "convert --times: too often" 1 'times 0 to 10000: a scene of 1 seconds is repeated at most 4096 times' \
    convert moving.fxs wrong.fxs --times 0..10000
fails "convert --times to an .fxs, of a still scene" 1 'still.ply: does not move: no --times' \
    convert still.ply wrong.fxs --times 0..1
fails "convert --fps without numbered files" 2 'fps is for numbered files: wrong.fxs has no %d' \
    convert moving.fxs wrong.fxs --times 0..0.5 --fps 3
check "convert: nothing is left of what was refused" sh -c '! ls | grep -q "wrong\|never.fxs\|opaque.fxs"'
fails "convert: a block of a scene that moves" 1 'moves is not written in blocks: give --time' \
    convert moving.fxs b.fxs --block 1/2
fails "convert --time of a still scene" 1 'still.ply: does not move: no --time' convert still.ply a.spz --time 1
fails "convert --times of a still scene" 1 'still.ply: does not move: no --times' convert still.ply %d.spz --times all
fails "convert --times to one name" 2 'a.ply: for --times, expected a name with one %d' convert moving.fxs a.ply --times all
fails "convert --fps alone" 2 'fps needs --times' convert moving.fxs a.ply --fps 3
fails "convert --times that replace an input" 2 'frames/0001.splat: is read and cannot be written too' \
    convert moving.fxs frames/0001.splat frames/%04d.splat --times all --fps 4

mkdir numbered back
"$fixsplat" make-scene cubes --count 400 -o cubes.ply
for i in 0 1 2 3 4 5 6; do "$fixsplat" convert cubes.ply numbered/f$i.ply --translate 0.1,0,$i; done
succeeds "numbered files: a film of them" render numbered $small --rate 23.976 --times all -o film.y4m
check "numbered files: a film of them: its frames" equal "$(frames_of film.y4m)" 7
check "numbered files: a film of them: its rate" grep -aq F24000:1001 film.y4m
run convert numbered numbered.fxs --rate 23.976
check "numbered files: as close to the floats as usual" equal "$status $(cat logs/err)" "0 "
check "info --compare of numbered files" at_least "$(psnr_of numbered.fxs numbered --rate 23.976)" 52
fails "--rate of another scene" 1 'numbered.fxs: --rate is for numbered files' render numbered.fxs $small --rate 3 -o a.png
succeeds "numbered files: each frame" convert numbered back/%d.ply --rate 23.976 --times all
check "numbered files: each frame: that file" sh -c 'for i in 0 1 2 3 4 5 6; do
    [ "$("$0" render back/$i.ply $1 --hash)" = "$("$0" render numbered/f$i.ply $1 --hash)" ] || exit 1
done' "$fixsplat" "$small"

# ---- Info ------------------------------------------------------------------------------------------------------------

run info moving.fxs
check "info: the duration" grep -q '^moves         1 seconds, again and again$' logs/out
check "info: live Gaussians" grep -Eq '^live          [0-9]+ Gaussians at the least, [0-9]+ on average, 1024 at most$' logs/out
check "info: bytes a second" grep -Eq '^stream        [0-9]+ bytes from the start on, then [0-9]+ a second, at most [0-9]+' logs/out
run info moving.fxs --json
check "info --json: the motion" grep -Eq '"motion": \{"duration": 1, "rate": null, "loops": true, "live": \{"least": [0-9]+, "mean": [0-9.]+, "most": [0-9]+\}, "start_bytes": [0-9]+, "bytes_per_second": [0-9]+, "most_bytes_in_a_second": [0-9]+\}, ' logs/out
run info still.ply --json
check "info --json of a still scene: no motion" sh -c '! grep -q motion logs/out'
check "info --compare: at half of the duration" at_least "$(psnr_of moving.fxs moving.splatv)" 52
check "info --compare --compare-time" at_least "$(psnr_of moving.fxs moving.splatv --compare-time 0.2)" 52
check "info --compare: a moment" at_least "$(psnr_of moment.fxs moving.splatv --compare-time 0.5)" 52
fails "info --compare: a still scene with one that moves" 1 'moves is not compared with a still one: give --compare-time' \
    info moment.fxs --compare moving.splatv

# ---- Publish ---------------------------------------------------------------------------------------------------------

mkdir -p page/viewer
echo page >page/viewer/index.html
echo module >page/fixsplat.js
publish() { FIXSPLAT_WEB=$work/page "$fixsplat" publish "$@" --size 64x36 --quiet; }
check "publish" publish moving.splatv site
check "publish: the scene moves" sh -c "'$fixsplat' info site/moving.fxs | grep -q '^moves         1 seconds'"
"$fixsplat" render site/moving.fxs --size 64x36 --quality 85 --time 0 -o poster.jpg --quiet
check "publish: the picture is of the first moment" cmp site/moving.jpg poster.jpg
check "publish --levels of an .fxs that moves" publish moving.fxs again --levels
check "publish --levels of an .fxs that moves: its size" equal "$(wc -c <again/moving.fxs)" "$(wc -c <moving.fxs)"

# ---- docs/examples ---------------------------------------------------------------------------------------------------

folder=$(cd "$root" && cd "$(dirname "$fixsplat")" && pwd)
library=$(ls "$folder"/libfixsplat.so.*.*.* 2>/dev/null | head -n 1)
if [ "$library" ]; then
    mkdir example
    ln -s "$library" "example/libfixsplat.so.$(echo "${library##*.so.}" | cut -d . -f 1)"
    check "docs/examples/moving.c compiles" ${CC:-cc} -std=c99 -Wall -Wextra -Werror -I"$root/src/include" \
        "$root/docs/examples/moving.c" -o example/moving "$library" -Wl,-rpath,"$work/example"
    check "docs/examples/moving.c runs" example/moving moving.fxs example
    check "docs/examples/moving.c: a frame for each 30th of a second" equal "$(ls example/*.png | wc -l | tr -d ' ')" 30
    "$fixsplat" render moving.fxs --size 640x360 --time 0.5 -o example/half.png
    check "docs/examples/moving.c: the command's picture" equal "$("$fixsplat" compare example/0015.png example/half.png \
        --json | grep -o '"psnr": null')" '"psnr": null'
else
    skip docs/examples/moving.c "no shared library is built with this compiler"
fi

finish
