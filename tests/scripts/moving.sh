#!/bin/sh
# Tests scenes that move in the commands: --time, --times and --fps, conversion of moments, info and comparison.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

hash_of() { "$fixsplat" render "$@" --hash 2>&1; }
frames_of() { grep -ao FRAME "$1" | wc -l | tr -d ' '; }
differ() { [ "$1" != "$2" ] || { echo "both are $1"; return 1; }; }

# splatv FILE COUNT: a .splatv of Gaussians that cross the picture one after the other, each seen for a part of a second.
splatv() {
    bytes=$(awk -v count="$2" '
        function put(word, size) { for (; size > 0; size--) { printf "\\%03o", word % 256; word = int(word / 256) } }
        function number(x, bits, bias,    sign, e, m) {
            if (x == 0) return 0
            sign = x < 0; x = sign ? -x : x
            e = 0
            while (x >= 2) { x /= 2; e++ }
            while (x < 1) { x *= 2; e-- }
            m = int((x - 1) * 2 ^ bits + 0.5)
            return (sign * 2 * (bias + 1) + e + bias) * 2 ^ bits + m
        }
        function half(x) { put(number(x, 10, 15), 2) }
        function single(x) { put(number(x, 23, 127), 4) }
        BEGIN {
            json = "[{\"type\": \"splat\", \"size\": " 64 * count "}]"
            put(26443, 4); put(length(json), 4)
            printf "%s", json
            for (i = 0; i < count; i++) {
                part = i / count
                single(i % 8 / 4 - 0.875); single(int(i / 8) % 8 / 4 - 0.875); single(part)
                half(1); half(0); half(0); half(0)
                half(0.1); half(0.05); half(0.1); half(0)
                put(55 + 3 * (i % 67), 1); put(100, 1); put(250 - 3 * (i % 67), 1); put(230, 1)
                half(1); half(0); half(0); for (k = 3; k < 10; k++) half(0)
                half(0); half(0); half(0); half(1)
                half(part); half(0.125)
            }
        }')
    printf "$bytes" >"$1"
}

splatv moving.splatv 1024
run convert moving.splatv moving.fxs
check "a .splatv to an .fxs" equal "$status" 0
"$fixsplat" make-scene knot --count 300 -o still.ply || exit 1
small='--size 64x48 --eye 0,0,-4 --look 0,0,0'
moving="moving.fxs $small"

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

finish
