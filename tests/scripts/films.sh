#!/bin/sh
# Tests films, streams and golden pictures: the output formats of `fixsplat render`, orbits, camera paths and crops.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

differ() { [ "$1" != "$2" ] || { echo "both are $1"; return 1; }; }
hash_of() { "$fixsplat" render "$@" --hash 2>&1; }
lines_of() { wc -l <"$1" | tr -d ' '; }

ply() {
    file=$1
    shift
    {
        printf 'ply\nformat ascii 1.0\nelement vertex %s\n' $#
        printf 'property float %s\n' x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3
        echo end_header
        printf '%s\n' "$@"
    } >"$file"
}

camera() {
    echo "{\"id\": 0, \"img_name\": \"$1\", \"width\": 64, \"height\": 48, \"position\": [$2, 0, -6],"
    echo " \"rotation\": ${4:-[[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, \"fx\": $3, \"fy\": $3}"
}
cameras() { file=$1; shift; printf '[%s]\n' "$(IFS=,; echo "$*")" >"$file"; }

small='--size 64x48'
"$fixsplat" make-scene knot --count 2000 -o knot.ply || exit 1
cameras three.json "$(camera front 0 60)" "$(camera side 1 60)" "$(camera far 2 60)"
three='knot.ply --cameras three.json'

# ---- Streams ---------------------------------------------------------------------------------------------------------

for format in png ppm raw jpg webp rgba y4m; do
    run render knot.ply $small -o file.$format
    if grep -q 'built without' logs/err; then
        skip ".$format" "$(cat logs/err)"
        continue
    fi
    check ".$format" equal "$status $(cat logs/err)" "0 "
    succeeds "-o - --format $format" render knot.ply $small -o - --format $format
    check "-o - --format $format: the bytes of the file" cmp logs/out file.$format
    succeeds "--format $format, whatever the name" render knot.ply $small -o file.tmp --format $format
    check "--format $format, whatever the name: the bytes" cmp file.tmp file.$format
done
succeeds "-o -" render knot.ply $small -o -
check "-o -: a .png" cmp logs/out file.png
check "a .rgba of one view is a .raw" cmp file.rgba file.raw

succeeds "--view all, one by one" render $three --view all -o %d.raw
succeeds "--view all as .rgba" render $three --view all -o all.rgba
cat 0.raw 1.raw 2.raw >frames.rgba
check "--view all as .rgba: one behind the other" cmp all.rgba frames.rgba
succeeds "--view all on standard output" render $three --view all -o -
cp logs/out all.y4m
check "--view all on standard output: a .y4m" equal "$(head -n 1 all.y4m)" \
    "YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED"
check "--view all on standard output: its size" equal "$(($(wc -c <all.y4m)))" \
    $(($(head -n 1 all.y4m | wc -c) + 3 * (6 + 3 * 64 * 48)))
succeeds "--view all as .y4m" render $three --view all -o film.y4m --fps 25 --threads 3
check "--view all as .y4m: --fps" equal "$(head -n 1 film.y4m | cut -d ' ' -f 4)" F25:1
tail -n +2 all.y4m >frames.one && tail -n +2 film.y4m >frames.two
check "--view all as .y4m: the same frames" cmp frames.one frames.two
succeeds "--stereo as .y4m" render $three --view all --stereo 0.1 -o eyes.y4m
check "--stereo as .y4m: both eyes" equal "$(head -n 1 eyes.y4m | cut -d ' ' -f 2,3)" "W128 H48"

# Expected Y, Cb and Cr by BT.709 of pictures that show only the background colour.
away='--eye 0,0,-9 --look 0,0,-20'
for colour in 'ffffff 235 128 128' '000000 16 128 128' 'ff0000 63 102 240' '00ff00 173 42 26' '0000ff 32 240 118'; do
    "$fixsplat" render knot.ply --size 1x1 $away --bg ${colour%% *} -o colour.y4m
    check "a .y4m of ${colour%% *}" equal "$(tail -c 3 colour.y4m | od -An -tu1 | awk '{ print $1, $2, $3 }')" "${colour#* }"
done

mkfifo pipe.y4m
cat pipe.y4m >got &
succeeds "a FIFO" render $three --view all -o pipe.y4m
wait
check "a FIFO: stays" [ -p pipe.y4m ]
check "a FIFO: the bytes" cmp got all.y4m
mkdir there
ln -s there/target.y4m link.y4m
succeeds "a link" render $three --view all -o link.y4m
check "a link: stays" equal "$(readlink link.y4m)" there/target.y4m
check "a link: its target" cmp there/target.y4m all.y4m
cp all.y4m old.y4m
(
    ulimit -f 10
    fails "a film that cannot be written" 1 "old.y4m: cannot be written: File too large" render $three --view all \
        --size 640x480 -o old.y4m
    check "a film that cannot be written: the old one stays" cmp old.y4m all.y4m
    echo "passed=$passed failed=$failed" >logs/counts
)
. logs/counts
check "a film that cannot be written: nothing is left" equal "$(find . -name '.fixsplat-*')" ""

if [ -c /dev/full ]; then
    for views in 0 all; do
        "$fixsplat" render $three --view $views -o - >/dev/full 2>logs/err
        check "--view $views into a full device" equal "$? $(cat logs/err)" \
            "1 fixsplat: standard output: cannot be written: No space left on device"
    done
else
    skip "a full device" "no /dev/full here"
fi
{ "$fixsplat" render $three --view all --size 640x480 -o - 2>logs/err; echo $? >logs/status; } 2>logs/shell | :
check "a closed pipe: ended as by SIGPIPE, without a word" equal "$(cat logs/status logs/err)" 141

fails "-o - --format gif" 2 "--format gif: expected png" render knot.ply -o - --format gif
fails "-o x.tif" 2 "x.tif: expected a name ending in .png" render knot.ply -o x.tif
for printed in hash stats 'pick 1,1' 'depth x.png'; do
    fails "-o - --$printed" 2 "the picture goes to standard output.*--${printed%% *}" render knot.ply -o - --$printed
done
succeeds "-o - --depth x.pfm" render knot.ply $small -o - --depth x.pfm
for option in 'o' 'depth' 'ids' 'diff'; do
    long=--output
    [ $option = o ] || long=--$option
    fails "${long#--} given twice" 2 "$long b: $long a is given before" render knot.ply \
        $([ $option = o ] && echo -o a -o b || echo $long a $long b)
done
fails "-o - twice" 2 "--output -: --output - is given before" render knot.ply -o - -o -
fails "compare --diff given twice" 2 "--diff b.png: --diff a.png is given before" compare file.png file.png \
    --diff a.png --diff b.png
fails "a film of a pattern" 2 "%d.y4m: a film is one file" render $three --view all -o %d.y4m
fails "--quality of .png" 2 "--quality is for .jpg" render knot.ply -o x.png --quality 9
fails "--quality 0" 2 "--quality 0" render knot.ply -o x.jpg --quality 0
fails "--fps of .png" 2 "--fps is for .y4m" render knot.ply -o x.png --fps 25
fails "--fps 0" 2 "--fps 0" render knot.ply -o x.y4m --fps 0
cameras sizes.json "$(camera front 0 60)" "$(camera large 1 60 | sed 's/"width": 64/"width": 80/')"
fails "a film of several sizes" 2 "one size, view front is 64x48, view large 80x48" \
    render knot.ply --cameras sizes.json --view all -o x.y4m
succeeds "a film of several sizes, with --size" render knot.ply --cameras sizes.json --view all $small -o x.y4m

if have ffmpeg && have ffprobe; then
    "$fixsplat" render knot.ply $small --orbit 12 -o - 2>logs/err |
        ffmpeg -v error -y -i - -pix_fmt yuv420p film.mp4 2>>logs/err
    probe='ffprobe -v error -count_frames -of csv=p=0 -show_entries stream'
    check "ffmpeg takes the stream" equal "$($probe=width,height,r_frame_rate,nb_read_frames film.mp4)$(cat logs/err)" \
        64,48,30/1,12
    check "ffmpeg reads the .y4m" equal "$($probe=pix_fmt,color_range film.y4m)" yuv444p,tv
    "$fixsplat" render $three --view all -o - --format png >all.png
    check "ffmpeg reads .png after .png" equal "$($probe=nb_read_frames -f image2pipe -i all.png)" 3
    for format in png webp; do
        [ -s file.$format ] || continue
        ffmpeg -v error -y -i file.$format -f rawvideo -pix_fmt rgba back.raw 2>logs/err
        check "ffmpeg reads the .$format: the same pixels" cmp back.raw file.raw
    done
    ffmpeg -v error -y -i file.y4m -vf scale=in_color_matrix=bt709:flags=accurate_rnd -pix_fmt rgb24 back.ppm 2>logs/err
    succeeds "ffmpeg reads the .y4m as BT.709" compare back.ppm file.ppm --min-psnr 50
else
    skip "ffmpeg" "not here"
fi

# ---- Films by ffmpeg -------------------------------------------------------------------------------------------------

# A program in place of ffmpeg, which reads some bytes of the film.
stand_in() { mkdir -p fake; printf '#!/bin/sh\n%s\n' "$1" >fake/ffmpeg; chmod +x fake/ffmpeg; }
with_path() { ffmpeg_path=$1; shift; PATH=$ffmpeg_path "$fixsplat" render "$@" >logs/out 2>logs/err; status=$?; }
nothing_is_left() { check "$1: nothing is left" equal "$(find . -name '.fixsplat-*' -o -name new.mp4)" ""; }

with_path /nowhere knot.ply $small --orbit 3 -o new.mp4
check "without ffmpeg: one line names the package" equal "$status $(lines_of logs/err) $(grep -c 'apt install ffmpeg.*y4m' logs/err)" "1 1 1"
nothing_is_left "without ffmpeg"
echo old >old.mp4
stand_in 'head -c 20000 >there/read; echo first >&2; echo "No room for the film" >&2; exit 1'
for name in old new; do
    with_path "fake:$PATH" knot.ply $small --orbit 30 -o $name.mp4
    check "ffmpeg that fails in mid-film, $name.mp4: its last line" equal "$status $(cat logs/err)" \
        "1 fixsplat: $name.mp4: ffmpeg: No room for the film"
done
check "ffmpeg that fails in mid-film: the old film stays" equal "$(cat old.mp4)" old
nothing_is_left "ffmpeg that fails in mid-film"
stand_in 'cat >there/read; echo "at the end" >&2; exit 3'
with_path "fake:$PATH" knot.ply $small --orbit 3 --fps 24000/1001 -o new.mp4
check "ffmpeg that fails at the end" equal "$status $(cat logs/err)" "1 fixsplat: new.mp4: ffmpeg: at the end"
nothing_is_left "ffmpeg that fails at the end"
"$fixsplat" render knot.ply $small --orbit 3 --fps 24000/1001 -o three.y4m
check "ffmpeg gets a .y4m" cmp there/read three.y4m
stand_in 'exit 0'
with_path "fake:$PATH" knot.ply --size 640x480 --orbit 3 -o new.mp4
check "ffmpeg that does not read" equal "$status $(cat logs/err)" "1 fixsplat: new.mp4: ffmpeg: it ended early"
nothing_is_left "ffmpeg that does not read"
stand_in 'cat >there/read'
: >there/read
mkfifo pipe.mp4
with_path "fake:$PATH" knot.ply $small --orbit 3 -o pipe.mp4 <>pipe.mp4
check "an .mp4 into a FIFO: refused" grep -q 'pipe.mp4: ffmpeg writes regular files only: give -o - |' logs/err
(PATH=fake:$PATH exec "$fixsplat" render knot.ply --size 640x480 --orbit 9999 -o new.mp4 2>logs/err) &
child=$!
for i in $(seq 100); do [ "$(($(wc -c <there/read)))" -lt 1000000 ] || break; sleep 0.1; done
{ kill -TERM $child; wait $child; } 2>/dev/null
check "a signal in mid-film" equal $? 143
nothing_is_left "a signal in mid-film"
fails "an .mp4 of an odd size" 1 "odd.mp4: an .mp4 needs an even width and height, not 63x48" render knot.ply --size 63x48 \
    -o odd.mp4
fails "an .mp4 with alpha" 2 "--alpha: a film has no alpha" render knot.ply --alpha -o x.mp4
for format in mp4 webm gif; do
    have ffmpeg && have ffprobe || { skip "a .$format" "no ffmpeg"; continue; }
    rate=24000/1001
    [ $format != gif ] || rate=25/1             # a .gif has times in hundredths of seconds
    succeeds "a .$format" render knot.ply $small --orbit 12 --fps $rate -o turn.$format
    grep -q 'Unknown encoder' logs/err && { skip "a .$format" "$(cat logs/err)"; continue; }
    check "a .$format: size, rate and frames" equal \
        "$($probe=width,height,r_frame_rate,nb_read_frames turn.$format)" 64,48,$rate,12
    ffmpeg -v error -y -i turn.$format -frames:v 1 -update 1 -pix_fmt rgb24 first.ppm 2>logs/err
    "$fixsplat" render knot.ply $small --orbit 12 -o turn%02d.png
    succeeds "a .$format: its colours" compare first.ppm turn00.png --min-psnr 27
done

# ---- Views -----------------------------------------------------------------------------------------------------------

view() { hash_of knot.ply --cameras "$1" --view "$2"; }
lists() { "$fixsplat" render knot.ply --cameras "$1" --view "$2" --hash | tr '\n' ' '; }
front=$(view three.json 0) side=$(view three.json 1) far=$(view three.json 2)
check "--view 0..2" equal "$(lists three.json 0..2)" "$front $side $far "
check "--view 2..1" equal "$(lists three.json 2..1)" "$far $side "
check "--view 1,0..2,1" equal "$(lists three.json 1,0..2,1)" "$side $front $side $far $side "
for list in 0..3 0, ,0 0..1..2 .. 1.. 0,,1 99999999999999999999,0; do
    fails "--view $list" 1 "three.json: no views '$list'" render $three --view $list --hash
done
fails "bench --view 0..1" 2 "one view" bench $three --view 0..1

# ---- Paths -----------------------------------------------------------------------------------------------------------

# positions FILE: the positions of the cameras of a cameras.json, one a line.
positions() { sed 's/.*"position": \[\([^]]*\)\].*/\1/' "$1" | awk -F ', *' '{ printf "%.9f %.9f %.9f\n", $1, $2, $3 }'; }
path() { run render knot.ply $small "$@" --write-cameras cams.json; }

succeeds "--path" render knot.ply --path three.json --frames 13 --hash --write-cameras cams.json
check "--path: as many frames" equal "$(lines_of logs/out)" 13
check "--path: begins and ends at the first and last view" equal "$(sed -n '1p;13p' logs/out | tr '\n' ' ')" "$front $far "
check "--path: a line, there in the middle" equal "$(positions cams.json | sed -n '1p;7p;13p' | tr '\n' ' ')" \
    "0.000000000 0.000000000 -6.000000000 1.000000000 0.000000000 -6.000000000 2.000000000 0.000000000 -6.000000000 "
check "--path: gentle ends" awk 'NR > 1 { step[NR] = $1 - last } { last = $1 }
    END { exit !(step[2] < 0.5 * step[7] && step[13] < 0.5 * step[7] && step[6] < 1.01 * step[7]) }' <<END
$(positions cams.json)
END
succeeds "--path --seconds" render knot.ply --path three.json --view 2,0 --seconds 0.5 --fps 24000/1001 -o rate.y4m
check "--path --seconds: frames, size and rate" equal "$(head -n 1 rate.y4m | cut -d ' ' -f 2-4) $(($(wc -c <rate.y4m)))" \
    "W64 H48 F24000:1001 $(($(head -n 1 rate.y4m | wc -c) + 12 * (6 + 3 * 64 * 48)))"
cameras turned.json "$(camera front 0 60)" "$(camera right 0 60 '[[0, 0, 1], [0, 1, 0], [-1, 0, 0]]')"
cameras half.json "$(camera half 0 60 \
    '[[0.70710678118654752, 0, 0.70710678118654752], [0, 1, 0], [-0.70710678118654752, 0, 0.70710678118654752]]')"
"$fixsplat" render knot.ply --path turned.json --frames 3 -o turn%d.raw
check "--path: turned halfway" equal "$($helper hash turn1.raw)" "$(view half.json 0)"
cameras lens.json "$(camera wide 0 30)" "$(camera long 0 120)"
"$fixsplat" render knot.ply --path lens.json --frames 3 --write-cameras cams.json
check "--path: a zoom" grep -Eq '"fx": (59.9999|60,|60.0000)' cams.json
succeeds "--path: views of two sizes" render knot.ply --path sizes.json --frames 5 -o sizes.y4m
check "--path: views of two sizes: all of the first one's" equal \
    "$(head -n 1 sizes.y4m | cut -d ' ' -f 2,3) $(($(wc -c <sizes.y4m)))" \
    "W64 H48 $(($(head -n 1 sizes.y4m | wc -c) + 5 * (6 + 3 * 64 * 48)))"

cat >keys.txt <<'END'
# eye, look, up, fov, time
0 0 -9  0 0 0  0 -1 0  40  0
-6,-2,-6, 0,0,0, 0,-1,0, 40, 0.5   # commas too
-9 0 0  0 0 0  0 -1 0  60  2

END
path --path keys.txt --fps 4
check "a text of keys: its times" equal "$(lines_of cams.json) $(positions cams.json | sed -n '1p;3p' | tr '\n' ' ')" \
    "8 0.000000000 0.000000000 -9.000000000 -6.000000000 -2.000000000 -6.000000000 "
path --path keys.txt --seconds 10 --fps 30
check "a text of keys: the same cameras everywhere" equal "$(cksum <cams.json)" "3894838748 119382"
check "a text of keys: --seconds leaves its times out, and says so" grep -q 'keys.txt: the times of its keys are ignored' logs/err
printf '0 0 -9 0 0 0\n3 0 -9 0 0 0\n' >short.txt
path --path short.txt --frames 3
check "a text of keys: eye and look are enough" equal "$status $(cat logs/err)$(lines_of cams.json)" "0 3"

# The web viewer shows these cameras 0.3 and 1.8 seconds after the start (tests/web/tour.mjs).
cat >theirs.json <<'END'
{"version": 2, "animTracks": [{"name": "theirs", "duration": 2, "frameRate": 30, "loopMode": "repeat",
 "interpolation": "spline", "smoothness": 0.5, "keyframes": {"times": [0, 20, 45], "values": {
 "position": [0, 0, -9, 9, 2, 0, 0, 4, 9], "target": [0, 0, 0, 0, 0, 0, 0, 0, 0], "fov": [60, 50, 70]}}}]}
END
path --path theirs.json --fps 10
check "SuperSplat's track: as the web viewer shows it" equal "$(positions cams.json | sed -n '4p;19p' | tr '\n' ' ')" \
    "-4.177285714 -0.673714286 -5.968285714 0.439714286 -1.433714286 -2.548285714 "
key='"look": [0, 0, 0], "fov": 40'
ours() { echo "{\"fixsplat\": 1, \"tracks\": [{\"name\": \"a\", \"keys\": [$1]}, {\"name\": \"b\", \"keys\": [$2]}]}" >ours.json; }
first="{\"time\": 0, \"eye\": [0, 0, -9], $key}" second="{\"time\": 1, \"eye\": [4, 0, -9], $key}"
ours "$first, $second" "{\"time\": 0, \"eye\": [0, 0, -7], $key}, $second"
for track in 'a 9' '0 9' 'b 7' '1 7'; do
    path --path ours.json --track ${track% *}
    check "--track ${track% *}" equal "$(positions cams.json | sed -n 1p)" "0.000000000 0.000000000 -${track#* }.000000000"
done
fails "--track c" 1 "ours.json: no track 'c': there are 2" render knot.ply --path ours.json --track c --hash
fails "--track of a camera file" 1 "--track is for a settings.json" render knot.ply --path three.json --track 0 --hash
fails "--view of a track" 1 "--view is for camera files" render knot.ply --path ours.json --view 0 --hash

while IFS='|' read -r name faulty words; do
    ours "$first, $faulty" "$first, $second"
    fails "a track with $name" 1 "^fixsplat: ours.json: track 0, key [12]: $words" render knot.ply --path ours.json --hash
done <<END
equal times|$first|its time is not after
keys out of order|$second, {"time": 0.5, "eye": [1, 0, -9], $key}|its time is not after
no time|{"eye": [4, 0, -9], $key}|its time is not 0 to 86400
a time of null|{"time": null, "eye": [4, 0, -9], $key}|its time is not 0
a text as a number|{"time": 1, "eye": [4, "NaN", -9], $key}|its eye, look or up is not three numbers
no field of view|{"time": 1, "eye": [4, 0, -9], "look": [0, 0, 0]}|a number is not
a field of view of 0|{"time": 1, "eye": [4, 0, -9], "look": [0, 0, 0], "fov": 0}|a field of view of 0 degrees
eye and look alike|{"time": 1, "eye": [0, 0, 0], $key}|the camera looks nowhere
a huge number|{"time": 1, "eye": [1e300, 0, 0], $key}|a number is not from
END
while IFS='|' read -r name line words; do
    printf '0 0 -9 0 0 0 0 -1 0 40 1\n%b\n' "$line" >bad.txt
    fails "a text of keys with $name" 1 "^fixsplat: bad.txt: $words" render knot.ply --path bad.txt --hash
done <<END
NaN|1 nan -9 0 0 0 0 -1 0 40 2|line 2: a number is not
a time of NaN|1 0 -9 0 0 0 0 -1 0 40 nan|line 2: its time is not 0
equal times|1 0 -9 0 0 0 0 -1 0 40 1|line 2: its time is not after
keys out of order|1 0 -9 0 0 0 0 -1 0 40 0|line 2: its time is not after
a time less|1 0 -9 0 0 0 0 -1 0 40|line 2: give all keys a time, or none
seven numbers|1 0 -9 0 0 0 40|line 2: expected 6 numbers
twelve numbers|1 0 -9 0 0 0 0 -1 0 40 2 1|line 2: expected 6 numbers
words|somewhere|line 2: expected 6 numbers
one key||1 keys
END
printf '0 0 -9 0 0 0\n0 0 -9 0 0 0\n' >alike.txt
fails "keys that are all alike" 1 "alike.txt: its keys are all alike" render knot.ply --path alike.txt --seconds 1 --hash
ours "$first, $second" "$first, $second"
sed 's/"name": "a"/"step": true, &/' ours.json >steps.json
fails "a track of steps at an even speed" 1 "steps.json: its camera jumps" render knot.ply --path steps.json --seconds 1 --hash
echo '{"fixsplat": 1}' >none.json
fails "settings without a track" 1 "none.json: no track" render knot.ply --path none.json --hash
fails "no times and no --seconds" 1 "three.json: its keys have no times: give --seconds" render knot.ply --path three.json --hash
fails "too many frames" 1 "at most 100000" render knot.ply --path three.json --seconds 80000 --hash
fails "--frames without --path" 2 "--frames needs --path" render $three --frames 3 --hash
fails "--frames 1" 2 "--frames 1" render knot.ply --path three.json --frames 1 --hash
fails "--path and --orbit" 2 "give one" render knot.ply --path three.json --frames 3 --orbit 3 --hash
for rate in 0 1001 24000/ /1001 0/1 1/2 24000/1001/1 23.976 99999999999; do
    fails "--fps $rate" 2 "--fps $rate: expected 1 to 1000" render knot.ply --path three.json --seconds 1 --fps $rate --hash
done
printf '0 0 -9 0 0 0\n0 0 9 0 0 12\n' >through.txt
path --path through.txt --seconds 2
check "a path through the inside: said" grep -q 'through.txt: frames [0-9]* to [0-9]*.*through a wall' logs/err
check "a path through the inside: not refused" equal "$status $(lines_of cams.json)" "0 60"
path --path short.txt --seconds 2
check "a path before it: nothing is said" equal "$status $(cat logs/err)" "0 "
check "--view 1..1: that one" equal "$(lists three.json 1..1)" "$side "

gaussian='1 .5 .2 4 -1 -1.5 -2 1 0 0 0'
ply pair.ply "1 0 0 $gaussian" "-1 0 0 $gaussian"
eye="pair.ply $small --eye 0,0,-6 --look 0,0,0"
"$fixsplat" render $eye --orbit 4 --hash >turn
check "--orbit: the camera is the first" equal "$(sed -n 1p turn)" "$(hash_of $eye)"
check "--orbit: a quarter" equal "$(sed -n 2p turn)" "$(hash_of pair.ply $small --eye 6,0,0 --look 0,0,0)"
check "--orbit: four views" equal "$(lines_of turn)" 4
check "--orbit: a quarter is another view" differ "$(sed -n 1p turn)" "$(sed -n 2p turn)"
"$fixsplat" render $three --view 1 --orbit 6 --hash >six && "$fixsplat" render $three --view 1 --orbit 3 --hash >three
check "--orbit: from a view of a file" equal "$(sed -n 1p six)" "$side"
check "--orbit: every second of twice as many" equal "$(sed -n '1p;3p;5p' six)" "$(cat three)"
fails "--orbit of several views" 1 "--orbit begins at one view" render $three --view all --orbit 3 --hash
fails "--orbit 0" 2 "--orbit 0: expected" render $three --orbit 0 --hash
fails "--orbit 1" 2 "--orbit 1" render $three --orbit 1 --hash
fails "--orbit into one file" 2 "x.png: for 3 views" render $three --orbit 3 -o x.png

keys=$(awk 'BEGIN { for (i = 0; i < 61; i++) printf "%s{\"time\": %d, \"eye\": [0, -2, %d], \"look\": [0, 0, 0], \"up\": [0, -1, 0], \"fov\": 50}", i ? ", " : "", i, -9 - i % 2 }')
echo "{\"fixsplat\": 1, \"tracks\": [{\"name\": \"a\", \"loop\": \"repeat\", \"duration\": 5, \"keys\": [$keys]}]}" >many.json
succeeds "--path: a repeated track of 61 keys, of which the film shows a few" render knot.ply $small --path many.json --fps 2 --hash
check "--path: it begins with its first key" equal "$(sed -n 1p logs/out)" "$(hash_of knot.ply $small --eye 0,-2,-9 --look 0,0,0)"

# ---- Motion blur and depth of field ----------------------------------------------------------------------------------

printf '0 -2 -9 0 0 0 0 -1 0 50 0\n0 -2 -9 0 0 0 0 -1 0 50 1\n' >still.txt
check "--shutter: a camera that stands still" equal \
    "$(hash_of knot.ply $small --path still.txt --fps 3 --shutter 360 --samples 5 | uniq -c | tr -s ' ')" \
    " 3 $(hash_of knot.ply $small --eye 0,-2,-9 --look 0,0,0)"
turn='knot.ply --size 64x48 --orbit 4 --samples 4'
check "--shutter: expected pictures" equal "$(hash_of $turn --shutter 180 | tr '\n' ' ')" "9f15da8ce01fa502 6b9c2669263ec6f2 0e491c9e1b73d8d5 73e241854ea02847 "
check "--shutter: with --cpu c, one thread" equal "$(hash_of $turn --shutter 180)" \
    "$(hash_of $turn --shutter 180 --cpu c --threads 1)"
check "--shutter 360 is not 180" differ "$(hash_of $turn --shutter 360)" "$(hash_of $turn --shutter 180)"
check "--shutter: forth and back, the ends are equal" equal \
    "$(hash_of knot.ply --path three.json --view 0..2 --frames 2 --shutter 90 --samples 6 | sort | tee forth)" \
    "$(hash_of knot.ply --path three.json --view 2..0 --frames 2 --shutter 90 --samples 6 | sort)"
check "--shutter: a film along a path" equal "$(lines_of forth) $(sort -u forth | wc -l)" "2 2"
lens='knot.ply --size 64x48 --samples 16 --aperture 0.6'
check "--aperture: an expected picture" equal "$(hash_of $lens)" c77a895d34f0b3d0
check "--aperture: with --cpu c, one thread" equal "$(hash_of $lens)" "$(hash_of $lens --cpu c --threads 1)"
depth=$("$fixsplat" render knot.ply $small --pick 32,24 | sed 's/.*depth \([0-9.]*\).*/\1/')
check "--focus auto: the depth in the middle" equal "$(hash_of $lens)" "$(hash_of $lens --focus $depth)"
check "--aperture: a lens of almost no size" equal "$(hash_of $lens --aperture 1e-9)" "$(hash_of knot.ply $small)"
check "--aperture and --shutter" differ "$(hash_of $turn --aperture 0.6)" "$(hash_of $turn --aperture 0.6 --shutter 90)"
check "--aperture --alpha" differ "$(hash_of $lens --alpha)" "$(hash_of $lens)"
for backend in gles gles-compute vulkan; do
    run render $lens --backend $backend --hash
    [ $status = 0 ] || { skip "--aperture --backend $backend" "$(cat logs/err)"; continue; }
    check "--aperture --backend $backend" equal "$(cat logs/out)" "$(hash_of $lens)"
done
fails "--shutter of one view" 2 "--shutter needs --orbit, --path or --times: a film" render knot.ply --shutter 180 --hash
fails "--aperture of nothing" 1 "nothing is in the middle: give --focus DEPTH" render $lens $away --hash
fails "--aperture beyond the camera's range" 1 "out of range" render $lens --aperture 1e30 --hash
for bad in 'shutter 361' 'samples 1' 'samples 1025' 'focus 0' 'focus near' 'aperture 0'; do
    fails "--$bad" 2 "--$bad: expected" render $turn --$bad --hash
done

# ---- Expected pictures -----------------------------------------------------------------------------------------------

hash=$(hash_of knot.ply $small)
succeeds "--expect HASH" render knot.ply $small --expect $hash
fails "--expect another hash" 1 "the picture is another: its hash is $hash, not 0123456789abcdef" \
    render knot.ply $small --expect 0123456789abcdef
"$fixsplat" render knot.ply $small -o golden.png
"$fixsplat" render knot.ply $small --bg 0a0000 -o other.png
rm -f diff.png
succeeds "--expect a picture" render knot.ply $small --expect golden.png --diff diff.png
check "--expect a picture: no difference is written" [ ! -e diff.png ]
fails "--expect another picture" 1 "other.png: the picture is another: [1-9][0-9]* pixels differ, PSNR .* dB, SSIM .*, \
largest difference 10$" render knot.ply $small --expect other.png --diff diff.png -o got.png
check "--expect another picture: the picture is written" cmp got.png golden.png
"$fixsplat" compare golden.png other.png --diff wanted.png >logs/out
check "--expect another picture: the difference" cmp diff.png wanted.png
"$fixsplat" render knot.ply $small --alpha -o alpha.png
fails "--expect a picture of other alpha" 1 "alpha.png: the picture is another" render knot.ply $small --expect alpha.png
succeeds "--expect a picture with its alpha" render knot.ply $small --alpha --expect alpha.png
fails "--expect a picture of another size" 1 "golden.png is 64x48, the picture 32x24" render knot.ply --size 32x24 \
    --expect golden.png
fails "--expect no picture" 1 "none.png: No such file" render knot.ply $small --expect none.png
fails "--diff without --expect" 2 "--diff needs --expect" render knot.ply --diff x.png --hash
fails "--diff x.gif" 2 "--diff x.gif: expected" render knot.ply --expect golden.png --diff x.gif
"$fixsplat" render $three --view all -o golden%d.png
succeeds "--expect of several views" render $three --view all --expect golden%d.png
cp golden0.png golden1.png
cp golden0.png golden2.png
run render $three --view all --expect golden%d.png --diff diff%d.png
check "--expect of several views: each that differs is named" equal "$status $(lines_of logs/err) $(ls diff?.png)" \
    "1 2 diff1.png
diff2.png"
fails "--expect a hash of several views" 2 "a hash is of one view, not of 3" render $three --view all --expect $hash
fails "--expect one picture of several views" 2 "golden.png: for 3 views" render $three --view all --expect golden.png

succeeds "compare --min-psnr" compare golden.png other.png --min-psnr 20 --min-ssim 0.1
for least in 'min-psnr 90' 'min-ssim 1'; do
    run compare golden.png other.png --$least
    check "compare --$least" equal "$status $(lines_of logs/out) $(lines_of logs/err)" "1 1 1"
    check "compare --$least: says which" grep -q "is below ${least#* }" logs/err
done
succeeds "compare equal pictures" compare golden.png golden.png --min-psnr 1000 --min-ssim 1
for bad in 'min-psnr 0' 'min-psnr x' 'min-ssim 0' 'min-ssim 1.1'; do
    fails "compare --$bad" 2 "--$bad" compare golden.png other.png --$bad
done

# ---- The script of docs/tests.md -------------------------------------------------------------------------------------

mkdir project
sed -n '/^```sh$/,/^```$/p' "$root/docs/tests.md" | sed '/^```/d' >project/golden.sh
cp knot.ply project/scene.ply
cp three.json project/cameras.json
golden() { (cd project && PATH=$(dirname "$fixsplat"):$PATH && sh golden.sh "$@") 2>&1; }
check "golden.sh: without pictures" equal "$(golden | grep -c 'golden/000[012].png: No such file')" 3
check "golden.sh --update" golden --update
check "golden.sh: makes three" equal "$(ls project/golden | tr '\n' ' ')" "0000.png 0001.png 0002.png "
check "golden.sh" golden
cp project/golden/0000.png project/golden/0002.png
check "golden.sh: a picture that is another" equal "$(golden | grep -c 'golden/0002.png: the picture is another')" 1
check "golden.sh: what a build keeps" equal "$(ls project/out | tr '\n' ' ')" \
    "diff-0002.png got-0000.png got-0001.png got-0002.png "

# ---- Crops -----------------------------------------------------------------------------------------------------------

part() {
    row=$5
    while [ $row -lt $(($5 + $7)) ]; do
        tail -c +$((($row * $2 + $4) * $3 + 1)) "$1" | head -c $(($6 * $3))
        row=$((row + 1))
    done
}
whole='knot.ply --size 200x150'
"$fixsplat" render $whole -o whole.raw --ids whole-ids.raw
for place in '0 0 200 150' '64 32 64 64' '71 39 55 41' '199 149 1 1'; do
    set -- $place
    succeeds "--scissor $place" render $whole --scissor $1,$2,$3,$4 -o part.raw --ids part-ids.raw
    part whole.raw 200 4 $1 $2 $3 $4 >wanted.raw
    part whole-ids.raw 200 8 $1 $2 $3 $4 >wanted-ids.raw
    check "--scissor $place: the pixels" cmp part.raw wanted.raw
    check "--scissor $place: the ids" cmp part-ids.raw wanted-ids.raw
done
for backend in gles gles-fetch gles-compute osmesa vulkan cuda; do
    run render $whole --scissor 71,39,55,41 --backend $backend -o other.raw
    if [ $status = 0 ]; then
        part whole.raw 200 4 71 39 55 41 >wanted.raw
        check "--scissor --backend $backend" cmp other.raw wanted.raw
    else
        skip "--scissor --backend $backend" "$(cat logs/err)"
    fi
done
succeeds "--scissor of a film" render $three --view all --scissor 8,8,16,16 -o part.y4m
check "--scissor of a film: its size" equal "$(head -n 1 part.y4m | cut -d ' ' -f 2,3)" "W16 H16"
fails "--scissor beyond the picture" 1 "--scissor 190,0,11,5: view look-at is 200x150" render $whole \
    --scissor 190,0,11,5 --hash
for bad in 1,2,3 1,2,3,4,5 -1,0,5,5 0,0,0,5 0,0,5,0 1,2,x,4; do
    fails "--scissor $bad" 2 "--scissor $bad: expected X,Y,WIDTH,HEIGHT" render $whole --scissor $bad --hash
done
for other in panorama 'stereo 0.1' 'pick 1,1'; do
    fails "--scissor --$other" 2 "--scissor does not go with" render $whole --scissor 0,0,8,8 --hash --$other \
        $([ "$other" != panorama ] || echo --size 64x32)
done
fails "--scissor --cutoff square" 2 "go with --cutoff square" render $whole --scissor 0,0,8,8 --cutoff square --hash

# ---- Statistics ------------------------------------------------------------------------------------------------------

succeeds "--stats" render knot.ply $small --stats
check "--stats: no pairs" equal "$(grep -c pairs logs/out)" 0
succeeds "--stats=pairs" render knot.ply $small --stats=pairs
check "--stats=pairs: pairs" grep -q '"pairs_evaluated": [1-9][0-9]*, "pairs_blended": [1-9]' logs/out
fails "--stats=all" 2 "--stats=all: expected" render knot.ply --stats=all

# ---- Inputs and outputs ----------------------------------------------------------------------------------------------

run render - $small --hash <knot.ply
check "a scene from standard input" equal "$status $(cat logs/out logs/err)" "0 $hash"
check "a scene through a pipe" equal "$(cat knot.ply | "$fixsplat" render - $small --hash)" "$hash"
"$fixsplat" convert knot.ply knot.fxs
check "an .fxs through a pipe" equal "$(cat knot.fxs | "$fixsplat" render - $small --hash)" "$hash"
"$fixsplat" convert - again.fxs <knot.ply
check "convert from standard input" cmp again.fxs knot.fxs
from() {
    name=$1 words=$2
    "$fixsplat" render - --hash >logs/out 2>logs/err
    status=$?
    check "standard input: $name" equal "$status $(cat logs/out) $(grep -c "^fixsplat: standard input.*$words" logs/err)" "1  1"
}
from "empty" "is empty" </dev/null
from "a folder" "Is a directory" <.
from "closed" "Bad file" <&-
head -c 1000 knot.fxs | { from "an .fxs cut short" "cut short"; echo "passed=$passed failed=$failed" >logs/counts; }
. logs/counts
head -c 1000 knot.ply | { from "a .ply cut short" ""; echo "passed=$passed failed=$failed" >logs/counts; }
. logs/counts

twice='two outputs are one file'
fails "-o and --depth one file" 2 "./x.png: $twice" render knot.ply -o x.png --depth ./x.png
fails "--depth and --ids one file" 2 "x.png: $twice" render knot.ply --depth x.png --ids x.png
ln golden.png hard.png
fails "-o and --diff one file" 2 "hard.png: $twice" render knot.ply $small --expect got.png -o golden.png --diff hard.png
succeeds "a device twice" render knot.ply $small -o /dev/null --format png --ids file.tmp.png
fails "-o the expected picture" 2 "golden.png: is read and cannot be written too" render knot.ply $small --expect golden.png \
    -o golden.png
cp golden0.png again.png && mv again.png golden0.png
fails "-o one of the expected pictures" 2 "golden0.png: is read and cannot be written too" render $three --threads 1 --view 1..2 \
    --expect golden%d.png --diff golden%d.png
cp knot.ply scene.raw
fails "-o the scene" 2 "scene.raw: is read and cannot be written too" render scene.raw -o scene.raw
ln knot.fxs packed.png
fails "-o the packed scene" 2 "packed.png: is read and cannot be written too" render knot.fxs -o packed.png
ln -s knot.ply scene.png
fails "-o a link to the scene" 2 "scene.png: is read and cannot be written too" render knot.ply -o scene.png
check "-o the scene: it stays" cmp scene.raw knot.ply
fails "compare --diff one of the pictures" 2 "golden.png: is read and cannot be written too" compare golden.png other.png \
    --diff golden.png

# ---- Time ------------------------------------------------------------------------------------------------------------

# Speed is measured in processor time, which depends less on other running programs than wall time.
seconds() { (run "$@" && times) | awk 'END { gsub(/[ms]/, " "); print $1 * 60 + $2 + $3 * 60 + $4 }'; }
if [ -d "$scenes/snowmiku" ] && [ -s file.png ]; then
    views="snowmiku.fxs --cameras $scenes/snowmiku/cameras.json --view 0..23 --threads 2"
    "$fixsplat" convert "$scenes/snowmiku/snowmiku.ply" snowmiku.fxs
    ppm=$(seconds render $views -o many%d.ppm) png=$(seconds render $views -o many%d.png)
    said="24 views as .png: $png s of a processor, as .ppm $ppm"
    if awk "BEGIN { exit !($ppm > 0 && $png <= 2 * $ppm) }"; then ok "$said"; else fail "$said" "more than twice"; fi
    check "24 views as .png: the pixels" equal "$("$fixsplat" compare many23.png many23.ppm)" equal
else
    skip "24 views as .png" "no real scenes at FXS_SCENES, or no .png"
fi
# The top and bottom rows of each picture of a turn have almost no coverage.
is_whole_around() {
    "$fixsplat" render "$1" --orbit 8 --size 64x36 --alpha -o turn%d.raw --quiet || return 1
    for picture in turn[0-7].raw; do
        equal "$( (head -c 256 $picture; tail -c 256 $picture) | tr -d '\000-\037' | wc -c)" 0 || return 1
    done
}
if [ -d "$scenes/guitar" ]; then
    check "--orbit shows the whole thing from all sides" is_whole_around "$scenes/guitar/guitar.compressed.ply"
else
    skip "--orbit of a guitar" "no real scenes at FXS_SCENES"
fi
finish
