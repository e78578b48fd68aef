#!/bin/sh
# Tests `fixsplat fit --moving` on rendered photographs of two things that move over a still ground.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/moving_set.sh"

export FIXSPLAT_QUIET=1
make_moving_scenes
make_moving_set set 7 4 100
fit="--moving --steps 500 --max-gaussians 5000 --moment-steps 80 --refine-steps 100 --sh-degree 0 --hold-out 7"

# ---- Fitted scenes ---------------------------------------------------------------------------------------------------

succeeds "fit --moving" fit set -o one.fxs $fit --threads 1
check "says what it made" grep -Eq '^one.fxs: 4 moments, 23 a second; [0-9]+ Gaussians, [0-9]+ bytes in the profile' \
    logs/out
check "a line for each moment, the mean and the worst" equal "$(grep -Ec '^ +[0-9.]+ +[0-9.]+ +0\.[0-9]+ +[0-9]+$' \
    logs/out) $(grep -Ec '^ +(mean|worst)' logs/out)" "4 2"
mean_of() { awk '/^ +mean/ { print $2 }' "$1"; }
check "at least 23.5 dB from where nothing was fitted" at_least "$(mean_of logs/out)" 23.5
cp logs/out said
short="--moving --steps 100 --max-gaussians 2000 --moment-steps 20 --sh-degree 0 --hold-out 7"
succeeds "a short one" fit set -o short.fxs $short --threads 1
cp logs/out said.short
run fit set -o two.fxs $short --threads 5 --cpu c --json
check "5 threads, plain C: the same file" cmp short.fxs two.fxs
check "--json: moments" equal "$(grep -o '"moved": ' logs/out | wc -l | tr -d ' ')" 4
(unset FIXSPLAT_QUIET && "$fixsplat" fit set -o two.fxs $short) >logs/out 2>logs/err
check "the verdict" equal "$(sed '1,/^ *worst /d; s/^[BS][^(]*([0-9.]* dB)/Words (N dB)/' logs/out)" "Words (N dB).
to look at it:                fixsplat view two.fxs
a folder for any web server:  fixsplat publish two.fxs site"
"$fixsplat" render one.fxs --cameras set/transforms.json --view 0 --hash >first
"$fixsplat" render one.fxs --cameras set/transforms.json --view 0 --hash --time 0.13 >last
check "it moves" [ "$(cat first)" != "$(cat last)" ]
last_of() { awk '/^ +0\.130/ { print $2 }' "$1"; }
check "in the last moment still at least 23.5 dB" at_least "$(last_of said)" 23.5
run fit set -o alone.fxs $fit --refine-steps 0
check "refined: at least 1 dB more in the last moment" \
    at_least "$(last_of said)" "$(awk -v a="$(last_of logs/out)" 'BEGIN { print a + 1 }')"
check "refined: the first moment is no worse" at_least "$(awk '/^ +0\.000/ { print $2 }' said)" \
    "$(awk '/^ +0\.000/ { print $2 }' logs/out)"

# ---- A folder for each camera ----------------------------------------------------------------------------------------

# take_folders TO: the pictures of the set in a folder for each camera, and the first ones in images, for the cameras.
take_folders() {
    mkdir -p "$1/images"
    for camera in 00 01 02 03 04 05 06; do
        mkdir -p "$1/c$camera"
        for moment in 0 1 2 3; do cp "set/t00$moment/c$camera.png" "$1/c$camera/frame$moment.png"; done
        cp "set/t000/c$camera.png" "$1/images/c$camera.png"
    done
    cp set/points.ply "$1"
    awk '/t00[1-3]/ { next } /^]}/ { sub(/,$/, "", last) } { if (NR > 1) print last; last = $0 } END { print last }' \
        set/transforms.json | sed 's/, "time": [0-9.]*//; s|t000/||' >"$1/transforms.json"
    cp set/t000/c0*.png "$1"
}
take_folders cameras
succeeds "a folder for each camera" fit cameras -o folders.fxs $short --fps 23
check "a folder for each camera: as by times" equal "$(sed '1d' logs/out)" "$(sed '1d' said.short)"
cp -r cameras fewer
rm fewer/c03/frame2.png
fails "a camera with a picture less" 1 "fewer/c03: 3 photographs, but 4 of the cameras before" fit fewer -o x.fxs $fit
cp -r cameras none
rm -r none/c04
fails "a camera without a folder" 1 "view c04.png: the photograph has no time, and the camera has no folder" \
    fit none -o x.fxs $fit

# ---- Bad input -------------------------------------------------------------------------------------------------------

# edited NAME SED...: the set with another transforms.json.
edited() {
    name=$1
    shift
    sed "$@" set/transforms.json >"set/$name.json"
}
edited timeless '5s/, "time": [0-9.]*//'
fails "a photograph without a time" 1 'its photograph has no time, unlike others' fit set/timeless.json -o x.fxs $fit
edited worded '5s/"time": [0-9.]*/"time": "now"/'
fails "a time that is not a number" 1 'a time that is not a number' fit set/worded.json -o x.fxs $fit
edited missing '12d'
fails "a camera that lacks a moment" 1 'each camera takes one at each moment' fit set/missing.json -o x.fxs $fit
edited turned '12s/\[0, 0, 0, 1\]/[0, 0, 0, 1]/; 12s/3\.[0-9]*\], \[0, 0/9.0], [0, 0/; 12s/\(\[\[[^]]*, \)[-0-9.]*\]/\19.0]/'
fails "a camera that moves" 1 'was taken by another camera than' fit set/turned.json -o x.fxs $fit
edited uneven 's/"time": 0\.130435/"time": 0.3/'
fails "uneven times" 1 'the times are not even' fit set/uneven.json -o x.fxs $fit
edited still 's/"time": [0-9.]*/"time": 0/'
fails "one moment" 1 'all photographs are of one moment' fit set/still.json -o x.fxs $fit
fails "one camera" 1 '0 photographs to fit at each moment, but the first moment is fitted as a still scene' \
    fit set -o x.fxs --moving --hold-out 1
awk '/t00[0-3]\/c0[1-6]/ { next } { sub(/1\.60*\], \[0, 0/, 1 + NR "], [0, 0"); print }' set/transforms.json |
    sed '/t003/s/,$//' >set/single.json
fails "one camera that moves" 1 '1 photograph to fit at each moment, but the first moment is fitted as a still scene' \
    fit set/single.json -o x.fxs --moving --hold-out 0
fails "to a .ply" 2 "--moving: x.ply: expected a name ending in .fxs" fit set -o x.ply --moving
fails "--moment-steps alone" 2 "--moment-steps" fit set -o x.fxs --moment-steps 9
fails "--refine-steps alone" 2 "--refine-steps" fit set -o x.fxs --refine-steps 9
fails "--moving with --exposure" 2 "--exposure does not go with --moving" fit set -o x.fxs --moving --exposure gain
check "leaves nothing beside" [ ! -e x.fxs ]

# ---- Films -----------------------------------------------------------------------------------------------------------

if command -v ffmpeg >/dev/null; then
    cp -r cameras films
    for camera in 00 01 02 03 04 05 06; do
        rm -r "films/c$camera"
        ffmpeg -nostdin -v error -framerate 23 -i "cameras/c$camera/frame%d.png" -c:v libx264 -qp 0 -pix_fmt yuv444p \
            "films/c$camera.mp4" 2>logs/ffmpeg || { ffmpeg_fails=1; break; }
    done
    if [ -z "$ffmpeg_fails" ]; then
        succeeds "a film for each camera" fit films -o films.fxs $fit --fps 23
        check "a film for each camera: at least 21 dB" at_least "$(mean_of logs/out)" 21
        check "the frames are kept" equal "$(ls films.fxs.moments | tr '\n' ' ')" "c00 c01 c02 c03 c04 c05 c06 log.txt "
    else
        skip "films: this ffmpeg has no libx264"
    fi
else
    skip "films: no ffmpeg"
fi
finish
