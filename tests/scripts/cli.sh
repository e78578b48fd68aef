#!/bin/sh
# Tests the command fixsplat from outside: exit codes, messages, options and pictures.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/json.sh"

# ---- Helpers ---------------------------------------------------------------------------------------------------------

hash_of() { "$fixsplat" render "$@" --hash 2>&1; }

raw_colours() { od -An -v -tu1 "$1" | awk '{ for (i = 1; i <= NF; i++) if (i % 4) print $i }'; }
ppm_colours() { tail -c "$(($2 * 3))" "$1" | od -An -v -tu1 | awk '{ for (i = 1; i <= NF; i++) print $i }'; }

differ() { [ "$1" != "$2" ] || { echo "both are $1"; return 1; }; }
all_zero() { cmp -n "$(wc -c <"$1")" "$1" /dev/zero; }

# ---- Test scenes and cameras -----------------------------------------------------------------------------------------

ply_header() {
    printf 'ply\nformat ascii 1.0\nelement vertex %s\n' "$1"
    printf 'property float %s\n' x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3
    echo end_header
}

# ply FILE LINE...: writes a .ply file with a Gaussian per LINE: x y z r g b opacity, three ln(sigma), quaternion.
ply() {
    file=$1
    shift
    ply_header $# >"$file"
    printf '%s\n' "$@" >>"$file"
}

inria_camera() {
    echo "{\"id\": 0, \"img_name\": \"$1\", \"width\": $3, \"height\": $4, \"position\": [$2, 0, -6],"
    echo " \"rotation\": ${6:-$identity}, \"fx\": $5, \"fy\": $5}"
}
identity='[[1, 0, 0], [0, 1, 0], [0, 0, 1]]'

cameras() { file=$1; shift; printf '[%s]\n' "$(IFS=,; echo "$*")" >"$file"; }

small=--size\ 64x48
"$fixsplat" make-scene knot --count 2000 -o knot.ply || exit 1
cameras three.json "$(inria_camera front 0 64 48 60)" "$(inria_camera side 1 64 48 60)" "$(inria_camera far 2 64 48 60)"
cameras double.json "$(inria_camera front 0 128 96 120)"
cameras wide.json "$(inria_camera front 0 128 24 60)"

# ---- Help and usage --------------------------------------------------------------------------------------------------

fails "no command" 2 "no command"
fails "unknown command" 2 "'paint'" paint
for command in render bench info; do
    fails "$command: no scene" 2 "$command takes a scene file, or several" $command --lod 0
done
fails "view --web: no scene" 2 "view takes a scene file, or several" view --web
fails "view --cameras: no scene" 2 "view: --cameras needs a scene" view --cameras three.json
fails "no output" 2 "where to" render knot.ply
succeeds "version" --version
succeeds "help" --help

"$fixsplat" help --table >table
cut -f 2 table | sort -u >options
check "each row belongs to a command" equal "$(cat options)" \
    "$(sed -En 's/^    \{"([a-z-]*)", (0|"[^"]*"), (take_|[A-Z0-9_]*\().*/\1/p' "$root"/tools/*/*.c | sort -u)"
for command in render view bench info convert compare make-scene fit demo doctor; do
    succeeds "$command --help" $command --help
    check "$command --help has examples" grep -q '^Examples:' logs/out
    awk -F '\t' -v command=$command '$1 == command { print $2, $4 }' table >options
    check "$command: no option twice" equal "$(cut -d ' ' -f 1 options | sort | uniq -d)" ""
    while read -r option value; do
        case $option$value in
        help'[=all]' | version) ;;
        *[A-Z]*) fails "$command --$option is taken" 2 "(--$option[ =]: expected|: --no-such)" \
                     $command --$option= --no-such-option ;;
        *) fails "$command --$option is taken" 2 ": --no-such" $command --$option --no-such-option ;;
        esac
    done <options
    fails "$command: unknown option" 2 "" $command --no-such-option
    fails "$command: option without its value" 2 "" $command -o
done

for bad in 0x10 10x0 16385x1 1x16385 10 10x 10x10x10 -1x10 99999999999999999999x1; do
    fails "--size $bad" 2 "--size $bad" render knot.ply --size $bad --hash
done
for bad in 'bg 12345' 'bg 12345g' 'cutoff round' 'sh-degree 4' 'sh-degree -1' 'threads 0' 'threads 65' 'cpu none' \
    'backend none' 'eye 1,2' 'eye 1,2,nan' 'look 1,2,3,4' 'up x' 'fov 0' 'fov 171' 'fov nan' 'near 0' 'near -1' \
    'near nan' 'near 9e-7' 'near 3e8' 'near 1,2' 'max-memory 0' \
    'max-memory 1T' 'max-memory 1KB' 'max-memory -1' 'max-memory K' 'max-memory 99999999999G' \
    'max-memory 99999999999999999999999999' 'max-memory' 'stereo 0' 'stereo -1' 'stereo nan' 'stereo 1,2' \
    'device x' 'device 256' 'device 0,' 'device ,1' 'device 0;1' 'device 0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0' \
    'stereo 0.1 --stats' 'tangents 1,2,3' 'tangents x' \
    'tangents -1,1,1,-1 --ortho 3'; do
    fails "--$bad" 2 "--${bad%% *}" render knot.ply $small --hash --$bad
done
for bad in 'crop 0,0,0,1,1' 'crop 0,0,0,1,1,1,1' 'crop 0,0,0,1,1,-1' 'crop nan,0,0,1,1,1' 'crop x' \
    'prune -0.1' 'prune 1.1' 'prune nan' 'prune 0.1,0.2' 'sh-degree 4' 'sh-degree -1' 'spz-version 2' 'spz-version 5' \
    'lod -1' 'profile tiny' 'profile 1' 'drop-floaters=0' 'drop-floaters=6' 'drop-floaters=' 'drop-floaters=x'; do
    fails "convert --$bad" 2 "--${bad%% *}" convert knot.ply x.spz --$bad
done
for bad in 'views 0' 'views 1001' 'size 1x' 'lod x'; do
    fails "info --$bad" 2 "--${bad%% *}" info knot.ply --compare knot.ply --$bad
done
for bad in 'cameras three.json' 'views 2' 'cutoff square' 'compare-cutoff square'; do
    fails "info --$bad without --compare" 2 "needs --compare" info knot.ply --$bad
done
for bad in 'frames 9' 'frames 10001' 'view all'; do
    fails "bench --$bad" 2 "" bench knot.ply $small --cameras three.json --$bad
done
fails "--view without cameras" 2 "--view" render knot.ply --view 0 --hash

# ---- Pictures --------------------------------------------------------------------------------------------------------

for ending in png ppm raw; do
    succeeds "render .$ending" render knot.ply $small -o knot.$ending
done
hash=$(hash_of knot.ply $small)
hash_small=$hash
check "a .raw has the bytes that --hash hashes" equal "$($helper hash knot.raw)" "$hash"
check "a .raw has width * height * 4 bytes" equal "$(($(wc -c <knot.raw)))" $((64 * 48 * 4))
raw_colours knot.raw >raw.txt
ppm_colours knot.ppm $((64 * 48)) >ppm.txt
check ".ppm and .raw have the same colours" cmp raw.txt ppm.txt
check ".png and .ppm are equal" equal "$("$fixsplat" compare knot.png knot.ppm)" equal
check "alpha is 255" equal \
    "$(od -An -v -tu1 knot.raw | awk '{ for (i = 4; i <= NF; i += 4) if ($i != 255) n++ } END { print n + 0 }')" 0
check "the picture shows something" differ "$(sort -u raw.txt | wc -l)" 1

for threads in 1 2 7; do
    check "one hash with --threads $threads" equal "$(hash_of knot.ply $small --threads $threads)" "$hash"
done
for cpu in all c sse41 avx2 avx512 neon sse41,avx2; do
    if got=$(hash_of knot.ply $small --cpu $cpu) || [ $cpu = all ] || [ $cpu = c ]; then
        check "one hash with --cpu $cpu" equal "$got" "$hash"
    else
        skip "one hash with --cpu $cpu" "${got#fixsplat: }"
    fi
done
for memory in 300000 400K 1M 3G; do
    check "one hash with --max-memory $memory" equal \
        "$(hash_of knot.ply $small --threads 2 --max-memory $memory)" "$hash"
done
check "one hash with --max-memory, square" equal \
    "$(hash_of knot.ply $small --cutoff square --threads 2 --max-memory 300000)" \
    "$(hash_of knot.ply $small --cutoff square)"
check "one hash with --backend cpu" equal "$(hash_of knot.ply $small --backend cpu)" "$hash"
if [ -e /dev/nvidia0 ]; then
    check "one hash with --backend cuda" equal "$(hash_of knot.ply $small --backend cuda)" "$hash"
    check "one hash with every device" equal "$(hash_of knot.ply $small --backend cuda --device all)" "$hash"
    run render knot.ply $small --stereo 0.1 --backend cuda --hash
    check "one hash with --stereo --backend cuda" equal "$status $(cat logs/out logs/err)" \
        "0 $(hash_of knot.ply $small --stereo 0.1)"
else
    fails "--backend cuda without a GPU" 1 "--backend cuda: (no NVIDIA .*was found|this build is without nvcc)" \
        render knot.ply $small --hash --backend cuda
    fails "--stereo --backend cuda without a GPU" 1 \
        "--backend cuda: (no NVIDIA .*was found|this build is without nvcc)" render knot.ply $small --stereo 0.1 --hash \
        --backend cuda
fi
for other in '--bg ff0000' '--cutoff square' '--sh-degree 0' '--fov 40' '--up 0,0,1' '--eye 0,-2,-9' \
    '--eye 0,-2,-9 --look 1,0,0' '--alpha' '--near 13'; do
    check "$other changes the picture" differ "$(hash_of knot.ply $small $other)" "$hash"
done

away='--eye 0,0,-100 --look 0,0,-200'
succeeds "everything behind the camera" render knot.ply $small $away -o black.ppm
tail -c $((64 * 48 * 3)) black.ppm >black.rgb
check "everything behind the camera: black" all_zero black.rgb
words='a frame of 64x48 does not fit in --max-memory [0-9]*: it needs at least [0-9]* bytes$'
fails "--max-memory 1: too little" 1 "$words" render knot.ply $small --threads 1 --max-memory 1 --hash
needed() { sed -n 's/.*at least \([0-9]*\) bytes$/\1/p' logs/err; }
least=$(needed)
fails "--max-memory: too little for the depths of this view" 1 "$words" render knot.ply $small --threads 1 \
    --max-memory ${least:-1} --depth none.pfm
check "--max-memory: no file is begun" [ ! -e none.pfm ]
check "--max-memory: what it asks for is enough" equal \
    "$(hash_of knot.ply $small --threads 1 --max-memory ${least:-1})" "$hash"
fails "--max-memory: one byte less is not" 1 "$words" render knot.ply $small --threads 1 \
    --max-memory $((${least:-1} - 1)) --hash

succeeds "--alpha" render knot.ply $small $away --bg ff0000 --alpha -o clear.raw
check "--alpha: nothing is nothing, whatever the background" all_zero clear.raw
"$fixsplat" render knot.ply $small --alpha --bg ff0000 -o coverage.raw
check "--alpha: coverage from 0 to 255" equal "$(od -An -v -tu1 coverage.raw |
    awk '{ for (i = 4; i <= NF; i += 4) { low += $i == 0; high += $i > 250; middle += $i > 9 && $i < 246 } }
         END { print (low > 0) + (high > 0) + (middle > 0) }')" 3
eyes='--eye 0,-2,-9 --look 0,-2,0'
succeeds "--stereo" render knot.ply $small $eyes --stereo 0.5 -o eyes.ppm
check "--stereo: twice as wide" equal "$(sed -n 2p eyes.ppm)" "128 48"
"$fixsplat" render knot.ply $small $eyes --stereo 0.5 -o eyes.raw
"$fixsplat" render knot.ply $small --eye -0.25,-2,-9 --look -0.25,-2,0 -o left.raw
"$fixsplat" render knot.ply $small --eye 0.25,-2,-9 --look 0.25,-2,0 -o right.raw
halves() { od -An -v -tx1 -w256 "$1" | awk "NR % 2 == $2"; }
check "--stereo: the left half" equal "$(halves eyes.raw 1)" "$(od -An -v -tx1 -w256 left.raw)"
check "--stereo: the right half" equal "$(halves eyes.raw 0)" "$(od -An -v -tx1 -w256 right.raw)"
check "--stereo: in bands" equal "$(hash_of knot.ply $small --stereo 0.5 --threads 1 --max-memory 100K)" \
    "$(hash_of knot.ply $small --stereo 0.5)"
fails "--stereo: too little memory" 1 "$words" render knot.ply $small --stereo 0.5 --max-memory 1 --hash
"$fixsplat" render knot.ply $small $eyes --stereo 0.5 --tangents -1.38,1.19,1.0,-1.2 -o eyes.raw
"$fixsplat" render knot.ply $small --eye -0.25,-2,-9 --look -0.25,-2,0 --tangents -1.38,1.19,1.0,-1.2 -o left.raw
"$fixsplat" render knot.ply $small --eye 0.25,-2,-9 --look 0.25,-2,0 --tangents -1.19,1.38,1.0,-1.2 -o right.raw
check "--tangents: the left eye" equal "$(halves eyes.raw 1)" "$(od -An -v -tx1 -w256 left.raw)"
check "--tangents: the right eye" equal "$(halves eyes.raw 0)" "$(od -An -v -tx1 -w256 right.raw)"
fails "--tangents: the wrong way round" 1 "expected left < right and down < up" render knot.ply $small \
    --tangents 1,-1,1,-1 --hash

succeeds "16384x1" render knot.ply --size 16384x1 -o long.png
succeeds "1x16384" render knot.ply --size 1x16384 -o tall.png
succeeds "--eye inside a Gaussian" render knot.ply $small --eye 0,0.9,0 --hash

# ---- Cameras ---------------------------------------------------------------------------------------------------------

view() { hash_of knot.ply --cameras "$@"; }
mkdir shots
cp three.json shots/cameras.json
check "--cameras of a folder" equal "$(view shots --view 1)" "$(view three.json --view 1)"
check "--view 0 is the default" equal "$(view three.json)" "$(view three.json --view 0)"
check "--view by name" equal "$(view three.json --view side)" "$(view three.json --view 1)"
check "views differ" differ "$(view three.json --view 0)" "$(view three.json --view 1)"
succeeds "--cameras" render knot.ply --cameras three.json -o view.ppm
check "the size is the file's" equal "$(sed -n 2p view.ppm)" "64 48"
check "--cameras: the near plane is 0.2" equal "$(view three.json --near 0.2)" "$(view three.json)"
check "--cameras --near" differ "$(view three.json --near 9)" "$(view three.json)"
check "--size scales the focal length" equal "$(view three.json --size 128x96)" "$(view double.json)"
check "--size of another shape keeps the product of the tangents" equal "$(view three.json --size 128x24)" "$(view wide.json)"
mkdir views
succeeds "--view all" render knot.ply --cameras three.json --view all -o views/%04d.raw
check "--view all: the files" equal "$(ls views | tr '\n' ' ')" "0000.raw 0001.raw 0002.raw "
for i in 0 1 2; do
    check "--view all: picture $i" equal "$($helper hash views/000$i.raw)" "$(view three.json --view $i)"
done
views= i=0
while [ $i -lt 70 ]; do
    views="$views$(inria_camera v$i 0.$i 64 48 60)," i=$((i + 1))
done
echo "[${views%,}]" >seventy.json
succeeds "--view all, more than a round" render knot.ply --cameras seventy.json --view all --hash
check "--view all, more than a round: in order" equal "$(sed -n 70p logs/out)" "$(view seventy.json --view 69)"
cameras growing.json "$(inria_camera small 0 16 12 15)" "$(inria_camera large 0 640 480 600)"
"$fixsplat" make-scene knot --count 20 -o few.ply
succeeds "--view all, a small picture and a large one" render few.ply --cameras growing.json --view all --hash
fails "--view all into no folder" 1 "none/0000.raw" render knot.ply --cameras three.json --view all -o none/%04d.raw
succeeds "--view all --hash" render knot.ply --cameras three.json --view all --hash
check "--view all --hash: three lines" equal "$(($(wc -l <logs/out)))" 3
for bad in x.png x%s.png x%d%d.png; do
    fails "--view all -o $bad" 2 "$bad" render knot.ply --cameras three.json --view all -o $bad
done
fails "--view beyond the last" 1 "three.json: no view '3'" render knot.ply --cameras three.json --view 3 --hash
fails "--view of no name" 1 "three.json: no view 'top'" render knot.ply --cameras three.json --view top --hash

sed 's,"side","a\\\\b c.jpg",' three.json >windows.json
check "--view of a name with backslashes, by slashes" equal "$(view windows.json --view 'a/b c.jpg')" \
    "$(view three.json --view side)"

cameras zero-focal.json "$(inria_camera zero 0 64 48 0)"
cameras skewed.json "$(inria_camera skewed 0 64 48 60 '[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]')"
cameras mirrored.json "$(inria_camera mirrored 0 64 48 60 '[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]')"
cameras large.json "$(inria_camera large 0 16385 48 60)"
cameras out.json "$(inria_camera out 1e30 64 48 60)"
echo '[{"id": 0,' >cut.json
echo '[]' >empty.json
fails "camera with a focal length of 0" 1 "zero-focal.json: .*focal" render knot.ply --cameras zero-focal.json --hash
fails "camera with a skewed matrix" 1 "skewed.json: .*rotation" render knot.ply --cameras skewed.json --hash
fails "camera with a mirror" 1 "mirrored.json: .*rotation" render knot.ply --cameras mirrored.json --hash
fails "camera with 16385 pixels" 1 "large.json: .*width" render knot.ply --cameras large.json --hash
fails "camera too far out" 1 "out.json: .*position" render knot.ply --cameras out.json --hash
fails "camera file cut short" 1 "cut.json: .*JSON" render knot.ply --cameras cut.json --hash
fails "camera file without cameras" 1 "empty.json: no views" render knot.ply --cameras empty.json --hash
fails "camera file missing" 1 "none.json: No such file" render knot.ply --cameras none.json --hash
fails "eye == look" 1 "one point" render knot.ply $small --eye 1,2,3 --look 1,2,3 --hash
fails "up along the view" 1 "up" render knot.ply $small --eye 0,0,0 --look 0,1,0 --hash
fails "no up" 1 "up" render knot.ply $small --up 0,0,0 --hash
fails "eye too far out" 1 "position" render knot.ply $small --eye 1e30,0,0 --hash

# ---- Faulty scenes ---------------------------------------------------------------------------------------------------

fails "scene missing" 1 "none.ply: No such file" render none.ply --hash
fails "scene a folder" 1 "views: not a regular file, but a folder without an index" render views --hash
fails "scene a picture" 1 "knot.png: not a scene" render knot.png --hash
{ printf 'version https://git-lfs.github.com/spec/v1\noid sha256:%064d\nsize 123\n' 7; } >pointer.ply
printf '\n <!DOCTYPE html>\n<html><body>Not found</body></html>\n' >page.ply
printf '7z\274\257\047\034 and more' >packed.7z
gzip -c knot.ply >knot.ply.gz
tar cf knot.tar knot.ply 2>logs/err
printf '# of a modeller\n\nmtllib a.mtl\no Cube\nv 1 2 3\nv 1 2 4\nv 2 2 4\nf 1 2 3\n' >cube.obj
printf 'LASF\0\0\0\0 and more of it than 32' >points.las
while read -r file words; do
    fails "scene that is ${words% *}" 1 "^fixsplat: $file: .*$words" render $file --hash
done <<'END'
pointer.ply not a scene file, but a Git LFS pointer
page.ply not a scene file, but an HTML page
packed.7z not a scene file, but a .7z archive
knot.tar not a scene file, but a .tar archive
knot.png not a scene file, but a .png picture
knot.ply.gz compressed by gzip, but no .spz
cube.obj not a scene file, but an .obj, a mesh, not Gaussians
points.las not a scene file, but a .las, a point cloud, not Gaussians: .* fit begins with
END
fails "cameras that are a scene" 1 "knot.ply: expected cameras .*, but this is a .ply" render knot.ply \
    --cameras knot.ply --hash
fails "cameras that are a picture" 1 "knot.png: expected cameras .*, but this is a .png" info knot.ply \
    --compare knot.ply --cameras knot.png
fails "photographs that are a picture" 2 "knot.png: a photograph: fit takes the folder that has all of them" \
    fit knot.png -o fitted.fxs
fails "info: scene missing" 1 "none.ply: No such file" info none.ply
succeeds "bench --draw" bench knot.ply $small --draw median-depth --draw ids
fails "bench --draw what is not" 2 "--draw colour: expected mean-depth, median-depth or ids" bench knot.ply $small --draw colour
fails "bench --draw two depths" 2 "give one kind" bench knot.ply $small --draw mean-depth --draw median-depth
fails "bench: scene missing" 1 "none.ply: No such file" bench none.ply
: >empty.ply
fails "scene empty" 1 "empty.ply: " render empty.ply --hash
for bytes in 3 100 500 5000 $(($(wc -c <knot.ply) - 1)); do
    head -c $bytes knot.ply >cut.ply
    fails "scene cut after $bytes bytes" 1 "cut.ply: " render cut.ply --hash
done

near="$small --eye 1,-2,-6 --look 0,0,0"
good='0 0 0 1 .5 .2 2 -1 -1.5 -2 1 0 0 0' other='1 .5 1 -1 .5 1 1 -2 -1 -1 .7 .7 0 .1'
room=2000000
(ulimit -v $room && "$fixsplat" --version) >/dev/null 2>&1 || room=unlimited
for count in 2000000000 4000000000 99999999999999999999 -1 x; do
    ply_header $count >count.ply
    echo "$good" >>count.ply
    sed 's/ascii/binary_little_endian/' count.ply >binary.ply
    (
        ulimit -v $room
        fails "ascii scene of $count announced, one there" 1 "count.ply: " render count.ply --hash
        fails "binary scene of $count announced, one there" 1 "binary.ply: " render binary.ply --hash
        echo "passed=$passed failed=$failed" >logs/counts
    )
    . logs/counts
done

ply good.ply "$good" "$other"
hash=$(hash_of good.ply $near)
check "two Gaussians are seen" differ "$hash" "$(hash_of good.ply $small $away)"
ply mixed.ply 'nan 0 0 1 .5 .2 2 -1 -1.5 -2 1 0 0 0' "$good" '0 0 0 1 inf .2 2 -1 -1.5 -2 1 0 0 0' \
    '0 0 0 1 .5 .2 nan -1 -1.5 -2 1 0 0 0' '0 0 0 1 .5 .2 2 -1 -1.5 -2 0 0 0 0' "$other" \
    '0 0 0 1 .5 .2 -inf -1 -1.5 -2 1 0 0 0' '0 0 0 1 .5 .2 2 -1 inf -2 1 0 0 0' 'inf 0 0 1 .5 .2 2 -1 -1.5 -2 1 0 0 0'
run render mixed.ply $near -o mixed.raw
check "bad Gaussians are left out and counted" equal "$status $(cat logs/err)" "0 fixsplat: mixed.ply: left out 6 of 9 \
Gaussians (5 not finite, 1 with a zero quaternion), 70.8 % of the scene by opacity and area"
run info mixed.ply --json
check "info --json: what is left out" grep -q \
    '"left_out": {"not_finite": 5, "zero_quaternion": 1, "transparent": 1, "share": 0.708}, "brought_in": 0' logs/out
ply outer.ply "$good" '0 0 .1 1 .5 .2 2 -1 -inf -2 1 0 0 0' '3e9 0 0 1 .5 .2 2 25 25 -9 1 0 0 0'
run render outer.ply $near -o outer.raw
check "thin, large and far Gaussians are drawn" equal "$status $(cat logs/err)" \
    "0 fixsplat: outer.ply: brought in 1 Gaussians from beyond 2^27 units, as they look from the origin"
check "thin, large and far Gaussians are seen" differ "$($helper hash outer.raw)" "$(hash_of good.ply $near)"
check "bad Gaussians are not in the picture" equal "$($helper hash mixed.raw)" "$hash"
{
    ply_header 1 | sed '$d'
    printf 'property float f_rest_%s\n' $(seq 0 71)
    echo end_header
    echo "$good $(seq -s ' ' 72)"
} >degree4.ply
run render degree4.ply $near -o degree4.raw
check "SH of degree 4 are said to be left out" equal "$status $(cat logs/err)" \
    "0 fixsplat: degree4.ply: the SH of degree 4 are left out: degree 3 is the highest that is drawn"
{
    ply_header 1 | sed '/scale_2/d'
    echo '0 0 0 1 .5 .2 2 -1 -1.5 1 .3 .2 0'
} >flat.ply
ply flat3.ply '0 0 0 1 .5 .2 2 -1 -1.5 -20 1 .3 .2 0'
run render flat.ply $near -o flat.raw
check "2D Gaussians are flat" equal "$status $(cat logs/err)$($helper hash flat.raw)" "0 $(hash_of flat3.ply $near)"
check "2D Gaussians are seen" differ "$(hash_of flat.ply $near)" "$(hash_of flat.ply $small $away)"
ply bad.ply '0 0 0 1 .5 .2 2 -1 -1.5 -2 0 0 0 0' 'nan 0 0 1 .5 .2 2 -1 -1.5 -2 1 0 0 0'
fails "render: no good Gaussian" 1 "bad.ply: none of the 2" render bad.ply --hash
fails "info: no good Gaussian" 1 "bad.ply: none of the 2" info bad.ply
fails "bench: no good Gaussian" 1 "bad.ply: none of the 2" bench bad.ply
ply zero.ply
fails "a scene of no Gaussians" 1 "zero.ply: " render zero.ply --hash
ply clear.ply "$good" "$other" '0 0 0 1 .5 .2 -inf -1 -1.5 -2 1 0 0 0'
run render clear.ply $near -o clear.raw
check "an opacity of sigmoid(-inf) is 0" equal "$($helper hash clear.raw)" "$hash"
check "an opacity of sigmoid(-inf) is left out in silence" equal "$(cat logs/err)" ""
ply opaque.ply "$good" '0 0 0 1 .5 .2 inf -1 -1.5 -2 1 0 0 0'
ply full.ply "$good" '0 0 0 1 .5 .2 20 -1 -1.5 -2 1 0 0 0'
run render opaque.ply $near --hash
check "an opacity of sigmoid(inf) is 1" equal "$status $(cat logs/out logs/err)" "0 $(hash_of full.ply $near)"
{
    ply_header 1 | sed '$d'
    printf 'property float %s\n' nx label t motion_0 motion_1
    echo end_header
    echo "$good 0 3 .5 1 2"
} >moving.ply
run render moving.ply $near -o moving.raw
check "properties that are not used are named" equal "$status $(cat logs/err)" \
    "0 fixsplat: moving.ply: not used, though the picture may depend on them: t, motion_*"
ply one.ply "$good"
check "a scene of one Gaussian is framed" differ "$(hash_of one.ply $small)" "$(hash_of one.ply $small $away)"
{ ply_header 900 && yes "$good" | head -n 899 && echo "x $good"; } >x-row.ply
ply flat.ply '0 0 0 1 1 1 4 -19.9 -19.9 -19.9 1 0 0 0' '0 0 0 1 1 1 4 -19.9 2 2 1 0 0 0' \
    '0 0 0 1 1 1 4 19.9 -19.9 -19.9 1 0 0 0'
succeeds "points, flat discs and endless needles" render flat.ply $small --hash
ply far.ply '-1.3e8 0 0 1 1 1 2 19 19 19 1 0 0 0' '1.3e8 0 0 1 1 1 2 19 19 19 1 0 0 0'
succeeds "a scene as large as can be" render far.ply $small --eye 1.2e8,0,0 --look 0,0,0 --hash
for value in 1e6 1e30; do
    {
        ply_header 1 | sed '$d'
        printf 'property float f_rest_%s\n' 0 1 2 3 4 5 6 7 8
        printf '%s\n' end_header "$good $value 0 0 0 0 0 0 0 0"
    } >sh-$value.ply
done
check "SH coefficients too large are held" equal "$(hash_of sh-1e30.ply $near)" "$(hash_of sh-1e6.ply $near)"
ply huge.ply '0 0 0 1 1 1 9 3 3 3 1 0 0 0'
succeeds "the camera inside a Gaussian" render huge.ply $small --eye 0,0,0 --look 0,0,1 -o inside.raw

# ---- Outputs ---------------------------------------------------------------------------------------------------------

echo precious >kept.png
cp kept.png kept.raw
cp kept.png kept.ply
mkdir folder.png
for output in missing/x.png kept.ply/x.png folder.png; do
    fails "-o $output" 1 "$output: cannot be written: " render knot.ply $small -o $output
done
if [ "$(id -u)" = 0 ]; then
    skip "a folder without write permission" "root may write everywhere"
else
    mkdir locked
    chmod 555 locked
    fails "a folder without write permission" 1 "locked/x.png: cannot be" render knot.ply $small -o locked/x.png
fi
for output in x.tif x png .; do
    fails "-o $output" 2 "$output: expected a name ending" render knot.ply $small -o $output
done
fails "make-scene -o missing/x.ply" 1 "missing/x.ply.*: cannot be" make-scene knot --count 10 -o missing/x.ply
fails "no scene, existing output" 1 "none.ply" render none.ply -o kept.png
fails "a bad scene, existing output" 1 "bad.ply" render bad.ply -o kept.png
fails "compare: no picture, existing difference" 1 "none.png" compare none.png knot.png --diff kept.png
(
    trap '' XFSZ
    ulimit -f 1
    fails "no room for the picture" 1 "kept.raw: cannot be written: " render knot.ply $small -o kept.raw
    fails "no room for the scene" 1 "kept.ply: cannot be written: " make-scene knot --count 100 -o kept.ply
    echo "passed=$passed failed=$failed" >logs/counts
)
. logs/counts
for file in kept.png kept.raw kept.ply; do
    check "$file is left whole" equal "$(cat $file)" precious
done
if [ -c /dev/full ]; then
    for arguments in "render knot.ply $small --hash" "render knot.ply $small --stats" "info knot.ply" \
        "bench knot.ply $small" "compare knot.png knot.png"; do
        "$fixsplat" $arguments >/dev/full 2>logs/err
        check "no room on stdout: ${arguments%% *} ${arguments##* }" equal "$? $(($(wc -l <logs/err)))" "1 1"
    done
fi

# ---- Back ends -------------------------------------------------------------------------------------------------------

succeeds "info --backends" info --backends
for backend in gles gles-fetch gles-compute osmesa vulkan; do
    reason=$("$fixsplat" info --backends | sed -n "s/^$backend  *not here: //p")
    if [ "$reason" ]; then
        skip "--backend $backend" "$reason"
    else
        check "one hash with --backend $backend" equal "$(hash_of knot.ply $small --backend $backend)" "$hash_small"
        succeeds "bench --backend $backend" bench knot.ply $small --backend $backend --json
        check "bench --backend $backend: said" grep -q "\"backend\": \"$backend\"" logs/out
    fi
    case $backend$reason in gles-compute | vulkan) ;; *) continue ;; esac
    for more in '' '--tangents -1.38,1.19,1.0,-1.2' --alpha; do
        check "one hash with --stereo $more --backend $backend" equal \
            "$(hash_of knot.ply $small --stereo 0.1 $more --backend $backend)" \
            "$(hash_of knot.ply $small --stereo 0.1 $more)"
    done
    check "one hash with --ortho --backend $backend" equal \
        "$(hash_of knot.ply --size 160x120 --ortho 4 --backend $backend)" \
        "$(hash_of knot.ply --size 160x120 --ortho 4)"
done
export __EGL_VENDOR_LIBRARY_FILENAMES=none VK_ICD_FILENAMES=none MESA_EXTENSION_OVERRIDE=-GL_ARB_ES3_compatibility
fails "--backend gles without a driver" 1 "--backend gles: (no|built)" render knot.ply $small --hash --backend gles
fails "--backend gles-compute without a driver" 1 "--backend gles-compute: (no|built)" render knot.ply $small --hash \
    --backend gles-compute
fails "--backend vulkan without a driver" 1 "--backend vulkan: (no|built)" \
    render knot.ply $small --hash --backend vulkan
fails "--backend osmesa of an old Mesa" 1 "--backend osmesa: (no|built)" render knot.ply $small --hash --backend osmesa
unset __EGL_VENDOR_LIBRARY_FILENAMES VK_ICD_FILENAMES
MESA_EXTENSION_OVERRIDE=-GL_ARB_stencil_texturing            # makes Mesa hide a part of OpenGL ES 3.1
if "$fixsplat" info --backends | grep -q '^gles  *here: llvmpipe'; then
    fails "--backend gles-compute of OpenGL ES 3.0" 1 \
        "--backend gles-compute: OpenGL ES 3.1 is needed, this is OpenGL ES 3.0" render knot.ply $small --hash \
        --backend gles-compute
    export MESA_EXTENSION_OVERRIDE= MESA_SHADER_CACHE_DISABLE=1 MESA_SHADER_DUMP_PATH=shaders MESA_SHADER_READ_PATH=bad
    mkdir shaders bad
    "$fixsplat" render knot.ply $small --hash --backend gles-compute >/dev/null
    for shader in shaders/CS_*; do sed 's/void main() *{/&\nthat;/' "$shader" >"bad/${shader#*/}"; break; done
    fails "--backend gles-compute, a shader that does not compile" 1 \
        "--backend gles-compute: [a-z_0-9]* does not compile: 0:[0-9]+\([0-9]+\): error: .that" render knot.ply $small \
        --hash --backend gles-compute
    unset MESA_SHADER_CACHE_DISABLE MESA_SHADER_DUMP_PATH MESA_SHADER_READ_PATH
fi
export MESA_EXTENSION_OVERRIDE=-GL_EXT_shader_framebuffer_fetch
if "$fixsplat" info --backends | grep -q '^gles  *here'; then
    "$fixsplat" info --backends >logs/out
    check "gles without framebuffer fetch: by lists" \
        grep -q '^gles .*, by lists: no GL_EXT_shader_framebuffer_fetch' logs/out
    check "one hash without framebuffer fetch" equal "$(hash_of knot.ply $small --backend gles)" "$hash_small"
    fails "--backend gles-fetch without it" 1 "--backend gles-fetch: no GL_EXT" render knot.ply $small --hash \
        --backend gles-fetch
fi
unset MESA_EXTENSION_OVERRIDE
if have ldd; then
    check "no GL library is linked" equal "$(ldd "$fixsplat" 2>&1 | grep -E 'lib(EGL|GL|OSMesa)')" ""
else
    skip "no GL library is linked" "no ldd here"
fi

# ---- JSON ------------------------------------------------------------------------------------------------------------

stages='project shade sort bin blend resolve'
succeeds "--stats" render knot.ply $small --stats=pairs
check "--stats: keys" keys logs/out gaussians drawn visible entries bands slices runs pairs_evaluated pairs_blended \
    frame_ms $(printf 'stages_ms.%s ' $stages) $(printf 'bytes.%s ' scene splats keys tiles entries frame)
check "--stats: Gaussians" grep -q '"gaussians": 2000,' logs/out
succeeds "info" info knot.ply
for said in '1K: 1024 bytes: too little' '1M: 1048576 bytes: enough for any view; slower' \
    '1G: 1073741824 bytes: enough for any view$'; do
    succeeds "info --max-memory ${said%%:*}" info knot.ply --max-memory ${said%%:*}
    check "info --max-memory ${said%%:*}: says" grep -q -- "^--max-memory *${said#*: }" logs/out
done
succeeds "info --board" info knot.ply --board 100x50
check "info --board: says" grep -q '^board  *100x50, one thread: [0-9]* bytes of flash for the scene, 3200 of RAM' logs/out
succeeds "info --board --json" info knot.ply --board 100x50 --json
check "info --board: keys" keys logs/out $(printf 'board.%s ' width height strip bytes least rows_least rows_most)
succeeds "info --board 320x240" info knot.ply --board 320x240
check "info --board: the panels of this size" equal "$(sed -n 's/^panel  *\([^:]*\):.*a frame is \(.*\)/\1 \2/p' logs/out)" \
    "$(printf 'ili9341 1230120 bits, 123.0 ms at 10.0 MHz\nst7789 1230120 bits, 81.2 ms at 15.2 MHz')"
check "info --board: chips" grep -qx 'STM32H743     fits, rows of tiles at once' logs/out
succeeds "info --board ssd1306" info knot.ply --board ssd1306
check "info --board ssd1306: 1 bit" grep -qx \
    'panel         ssd1306: 4608 bytes of RAM for strips; a frame is 8384 bits, 0.8 ms at 10.0 MHz' logs/out
succeeds "info --board st7789-240x240 --json" info knot.ply --board st7789-240x240 --json
check "info --board --json: one panel" equal "$(grep -o '"panels": .*MHz\|"panels": [^]]*' logs/out)" \
    '"panels": [{"name": "st7789-240x240", "ram": 7680, "bits": 922920, "milliseconds": 60.9127}'
fails "info --board 0x5" 2 'board 0x5: expected' info knot.ply --board 0x5
fails "info --board of two" 2 'takes one scene' info knot.ply knot.ply --board 100x50
succeeds "info --json" info knot.ply --json --size 100x50
check "info --json: keys" keys logs/out format gaussians packed sh_degree antialiased bounds packed_bytes \
    bytes_per_gaussian largest_error.position frame.width frame.height frame.bytes frame.least
check "info --json: values" grep -q '"gaussians": 2000, "packed": 2000, "sh_degree": 3,' logs/out
succeeds "bench" bench knot.ply $small
succeeds "bench --json" bench knot.ply $small --json --threads 2 --cpu c --cutoff square
check "bench --json: keys" keys logs/out gaussians width height threads cpu cutoff backend frame_ms \
    $(printf 'stages.%s ' $stages)
check "bench --json: values" grep -q '^{"gaussians": 2000, "width": 64, "height": 48, "threads": 2, "cpu": "c", '\
'"cutoff": "square", "backend": "cpu", ' logs/out

"$fixsplat" render knot.ply $small --bg 010101 -o near.png
succeeds "compare" compare knot.png near.png --diff difference.png
check "compare: says how far" grep -Eq '^PSNR [0-9.]+ dB, SSIM [0-9.]+, largest difference 1$' logs/out
succeeds "compare: its difference is a picture" compare difference.png difference.png
succeeds "compare --json" compare knot.png near.png --json
check "compare --json: keys" keys logs/out psnr ssim largest
succeeds "compare --json of equal pictures" compare knot.png knot.png --json
check "compare --json of equal pictures: values" equal "$(cat logs/out)" \
    '{"psnr": null, "ssim": 1.000000, "largest": 0}'
fails "compare: two sizes" 1 "knot.png is 64x48, long.png is 16384x1" compare knot.png long.png
fails "compare: one picture" 2 "two pictures" compare knot.png
fails "compare: no picture" 2 "knot.ply is a scene" compare knot.png knot.ply
fails "compare: --diff of no known ending" 2 "d.gif" compare knot.png knot.png --diff d.gif
head -c 500 knot.png >cut.png
fails "compare: a picture cut short" 1 "cut.png: " compare cut.png knot.png

# ---- convert ---------------------------------------------------------------------------------------------------------

worst_of() {
    "$fixsplat" info "$1" --compare knot.ply --views 6 --size 480x320 |
        awk '/ degrees, / { if (!p || $6 < p) { p = $6; v = $2 " degrees, " $4 } } END { printf "%s is %.1f", v, p }'
}
usual() { [ $1 = small ] && echo "38 is usual; profile compact loses" || echo "48 is usual; profile default loses"; }

succeeds "convert to .ply" convert knot.ply knot2.ply
check "convert to .ply: the same bytes" cmp knot.ply knot2.ply
succeeds "convert to .fxs" convert knot.ply knot.fxs
check "convert to .fxs: the same picture" equal "$(hash_of knot.fxs $small)" "$(hash_of knot.ply $small)"
check "convert to .fxs: PSNR from the floats" at_least "$(psnr_of knot.fxs knot.ply)" 54
"$fixsplat" make-scene knot --count 60000 -o many.ply
"$fixsplat" make-scene landscape --count 20000 -o land.ply
"$fixsplat" make-scene layers -o layers.ply
for profile in default compact small; do
    succeeds "convert to .fxs, $profile: nothing to say of a scene that it holds" \
        convert land.ply land.fxs --profile $profile
done
run convert layers.ply layers.fxs
check "convert to .fxs: default loses much where coincident Gaussians decide" equal \
    "$status $(sed "s/view.* is [0-9.]* /view /" logs/err)" \
    "0 fixsplat: layers.fxs: profile default loses more of this scene than of most: a view dB from the floats, \
where 52 is usual; moving its Gaussians by 1e-6 of the distance changes a view by as much or more"
for profile in compact small; do
    run convert knot.ply $profile.fxs --profile $profile
    check "convert to .fxs, $profile" equal "$status $(wc -l <logs/err)" "0 1"
    check "convert to .fxs, $profile: so few Gaussians lose much" grep -Eq "^fixsplat: $profile.fxs: profile $profile \
loses more of .*: a view $(worst_of $profile.fxs) dB from the floats, where $(usual $profile)" logs/err
    check "convert to .fxs, $profile: less" [ "$(wc -c <$profile.fxs)" -lt "$(wc -c <knot.fxs)" ]
    run convert many.ply many.fxs --profile $profile
    floor=50
    [ $profile = compact ] || floor=38
    check "convert to .fxs, $profile: PSNR" at_least "$(psnr_of many.fxs many.ply)" $floor
    check "info, $profile" [ "$("$fixsplat" info $profile.fxs | sed -n 's/^profile *//p')" = $profile ]
    check "render --profile $profile: the same picture" equal "$(hash_of knot.ply $small --profile $profile)" \
        "$(hash_of $profile.fxs $small)"
    check "$profile: one hash with --cpu c" equal "$(hash_of $profile.fxs $small --cpu c)" \
        "$(hash_of $profile.fxs $small --cpu all)"
done
{
    ply_header 300 | sed '$d'
    printf 'property float f_rest_%s\n' 0 1 2 3 4 5 6 7 8
    echo end_header
    awk 'function by_chance() { return (seed = (seed * 16807 + 11) % 2147483647) / 1073741824 - 1 }
        BEGIN {
            for (seed = 1; i < 300; i++) {
                printf "%g %g 0 1 .5 .2 4 17 17 17 1 0 0 0", i % 2 ? 1.4e8 : -1.4e8, (i % 4 > 1) ? 1.4e8 : -1.4e8
                for (k = 0; k < 9; k++)
                    printf " %g", 2 * by_chance()
                print ""
            }
        }'
} >chance.ply
run convert chance.ply chance.fxs --profile small
check "convert to .fxs, small: says what is lost, all of it once" equal "$status $(sed 's/a view .*/a view/' logs/err)" \
    "0 fixsplat: chance.ply: brought in 300 Gaussians from beyond 2^27 units, as they look from the origin
fixsplat: chance.fxs: profile small loses more of this scene than of most: a view"
check "convert to .fxs, small: all of it, whatever it loses" [ "$("$fixsplat" info chance.fxs | grep -c small)" = 1 ]
run convert knot.ply knot4.spz
check "convert to .spz: says what is clamped" says "knot4.spz: clamped SH beyond +-1, of 6 Gaussians"
check "convert to .spz: version 4" equal "$(head -c 5 knot4.spz | od -An -tx1)" " 4e 47 53 50 04"
run convert knot.ply knot3.spz --spz-version 3
check "convert to .spz 3: says what is clamped" says "knot3.spz: clamped SH beyond +-1, of 6 Gaussians"
check "convert to .spz 3: gzip" equal "$(head -c 2 knot3.spz | od -An -tx1)" " 1f 8b"
check "convert to .spz: 3 and 4 are the same scene" equal "$(hash_of knot3.spz $small)" "$(hash_of knot4.spz $small)"
"$fixsplat" convert knot.ply fine.spz --spz-fine 2>logs/err
check "convert --spz-fine: PSNR" at_least "$(psnr_of fine.spz knot.ply)" 46
check "convert to .spz: PSNR" at_least "$(psnr_of knot4.spz knot.ply)" 37
check "convert to .spz: less" [ "$(wc -c <knot4.spz)" -lt $(($(wc -c <fine.spz) * 3 / 4)) ]
check "convert to .spz: all of it" gaussians knot4.spz 2000 3
run convert knot.ply knot.splat
check "convert to .splat: says what is lost" says "knot.splat: a .splat cannot hold the SH above degree 0"
check "convert to .splat: bytes" equal "$(($(wc -c <knot.splat)))" 64000
succeeds "convert --sh-degree 0" convert knot.ply plain.ply --sh-degree 0
check "convert --sh-degree 0: degree" gaussians plain.ply 2000 0
check "convert --sh-degree 0: the picture" equal "$(hash_of plain.ply $small)" \
    "$(hash_of knot.ply $small --sh-degree 0)"
run convert plain.ply compact.fxs --profile compact
check "convert without SH, compact: says that it has no meaning" says \
    "compact.fxs: profile compact is no smaller than default for a scene without SH; small is"
check "convert without SH, compact: as large as default" equal "$("$fixsplat" convert plain.ply plain.fxs
    wc -c <plain.fxs)" "$(wc -c <compact.fxs)"
succeeds "convert to .splat without SH" convert plain.ply plain.splat
check "convert to .splat: PSNR" at_least "$(psnr_of plain.splat plain.ply)" 46
check "convert to .splat: the SH was left out" cmp plain.splat knot.splat
succeeds "convert .splat to .spz" convert plain.splat plain.spz --spz-version 3
check "convert .splat to .spz: PSNR" at_least "$(psnr_of plain.spz plain.ply)" 44

"$fixsplat" convert plain.ply plain.fxs
head -c 9000 plain.fxs >cut.fxs
{ head -c 20000 plain.fxs && printf '\377\001\377\001' && tail -c +20005 plain.fxs; } >damaged.fxs
{ ply_header 5 && for i in 0 1 2 3 4; do echo "$i 0 0 1 .5 .2 $((i - 3)).5 -1 -1.5 -2 1 0 0 0"; done; } >rows.ply
for out in ply splat spz fxs; do
    run convert rows.ply left.$out --crop 1,-1,-1,3,1,1
    check "convert --crop to .$out" says "rows.ply: kept 3 of 5 Gaussians (2 outside, 0 too faint, 0 floating)"
    check "convert --crop to .$out: what is left" gaussians left.$out 3 0
    run convert rows.ply left.$out --prune 0.5 --crop 0,0,0,3,0,0
    check "convert --prune to .$out" says "rows.ply: kept 1 of 5 Gaussians (1 outside, 3 too faint, 0 floating)"
    check "convert --prune to .$out: what is left" gaussians left.$out 1 0
    echo precious >left.$out
    fails "convert --crop to .$out: nothing left" 1 "rows.ply: none of the 5 Gaussians is left" convert rows.ply \
        left.$out --crop 7,7,7,8,8,8
    fails "convert bad Gaussians to .$out" 1 "bad.ply: none of the 2 Gaussians can be drawn" convert bad.ply left.$out
    fails "convert a scene cut short to .$out" 1 "cut.ply: " convert cut.ply left.$out
    fails "convert a scene with a bad row to .$out" 1 "x-row.ply: " convert x-row.ply left.$out
    fails "convert a scene that is not there to .$out" 1 "none.ply: No such file" convert none.ply left.$out
    fails "convert to missing/x.$out" 1 "missing/x.$out: cannot be written: " convert plain.ply missing/x.$out
    succeeds "convert an .fxs file to .$out" convert plain.fxs back.$out
    check "convert an .fxs file to .$out: all of it" gaussians back.$out 2000 0
    check "convert an .fxs file to .$out: PSNR" looks_as back.$out plain.fxs 44
    fails "convert an .fxs file cut short to .$out" 1 "cut.fxs: the header, or the file's length, is damaged" \
        convert cut.fxs left.$out
    fails "convert an .fxs file with a damaged chunk to .$out" 1 "damaged.fxs: a chunk is damaged" \
        convert damaged.fxs left.$out
    (
        trap '' XFSZ
        ulimit -f 1
        fails "no room for the .$out" 1 "left.$out: cannot be written: " convert plain.ply left.$out
        echo "passed=$passed failed=$failed" >logs/counts
    )
    . logs/counts
    check "convert: left.$out is left whole" equal "$(cat left.$out)" precious
    run convert mixed.ply drawn.$out
    check "convert to .$out: bad Gaussians are left out and counted" says "mixed.ply: left out 6 of 9 \
Gaussians (5 not finite, 1 with a zero quaternion), 70.8 % of the scene by opacity and area"
    check "convert to .$out: the others are there" gaussians drawn.$out 2 0
done
"$fixsplat" convert knot.ply part.ply --crop -9,-9,-9,0,9,9 --prune 0.3 --sh-degree 2 2>logs/err
"$fixsplat" convert knot.ply part.fxs --crop -9,-9,-9,0,9,9 --prune 0.3 --sh-degree 2 2>logs/err
check "convert: filtered and packed, or packed when filtered" equal "$(hash_of part.ply $small --fov 50)" \
    "$(hash_of part.fxs $small --fov 50)"
check "convert: filtered is less" differ "$(hash_of part.ply $small)" "$(hash_of knot.ply $small --sh-degree 2)"
ply farther.ply "$good" '2e4 0 0 1 .5 .2 2 -1 -1.5 -2 1 0 0 0' '1 1 0 9 .5 .2 2 -1 7 -2 1 0 0 0'
run convert farther.ply farther.spz
check "convert to .spz: says what is brought in and clamped" equal "$status $(cat logs/err)" "0 \
fixsplat: farther.spz: brought in 1 Gaussians from beyond 2048 units: an .spz has 24 bits for a position
fixsplat: farther.spz: clamped dc beyond +-3.33, of 1 Gaussians
fixsplat: farther.spz: clamped ln(sigma) outside -10 to 5.94, of 1 Gaussians"
run convert knot4.spz turned.ply --axes rdf
check "convert --axes rdf" differ "$(hash_of turned.ply $small)" "$(hash_of knot4.spz $small)"
check "render --axes rdf" differ "$(hash_of knot4.spz $small --axes rdf)" "$(hash_of knot4.spz $small)"
check "render --axes rub: as it is" equal "$(hash_of knot4.spz $small --axes rub)" "$(hash_of knot4.spz $small)"
fails "--axes of a .ply" 1 "knot.ply: axes .--axes. are for .spz" render knot.ply --axes rub --hash
fails "--axes of another way" 2 "--axes up: expected rub or rdf" info knot4.spz --axes up
fails "convert: an ending that is none" 2 "x.gltf: expected a name ending" convert knot.ply x.gltf
fails "convert: one file" 2 "two files" convert knot.ply
fails "convert --profile to .ply" 2 "--profile is for .fxs" convert knot.ply x.ply --profile small
fails "convert --spz-version to .ply" 2 "x.ply is no .spz" convert knot.ply x.ply --spz-version 3
fails "convert --spz-fine to .ply" 2 "--spz-fine: x.ply is no .spz" convert knot.ply x.ply --spz-fine

# ---- info --compare --------------------------------------------------------------------------------------------------

succeeds "info --compare" info knot4.spz --compare knot.ply --views 3 --size 64x48
check "info --compare: a line for each view" equal "$(grep -c ' degrees, .* 64x48 ' logs/out)" 3
check "info --compare: middle, close and far" equal \
    "$(sed -n 's/.* degrees, \([a-z]*\) .* 64x48 .*/\1/p' logs/out | tr '\n' ' ')" "middle close far "
check "info --compare: the worst is the lowest of each" equal "$(awk '/^worst/ { print $2, $3 }' logs/out)" \
    "$(awk '/ 64x48 / { if (!p || $(NF - 2) < p) p = $(NF - 2); if (!s || $(NF - 1) < s) s = $(NF - 1) }
        END { print p, s }' logs/out)"
check "info --compare: the worst view" equal "$(awk '/^worst/ { print $5 }' logs/out)" \
    "$(awk '/ 64x48 / { if (!p || $(NF - 2) < p) { p = $(NF - 2); v = $1 } } END { print v }' logs/out)"
succeeds "info --compare --json" info knot4.spz --compare knot.ply --size 64x48 --json
check "info --compare --json: keys" keys logs/out compare.psnr compare.ssim compare.views \
    compare.worst_psnr compare.worst_ssim compare.worst_view largest_error.sh
check "info --compare: 8 views" equal "$(grep -o '"largest": ' logs/out | wc -l | tr -d ' ')" 8
succeeds "info --compare --cameras" info knot4.spz --compare knot.ply --cameras three.json --views 2 --json
check "info --compare --cameras: evenly spaced" grep -Eq \
    '("view": [01], "width": 64, "height": 48, [^}]*}.*){2}' logs/out
cameras five.json "$(inria_camera far 9 64 48 60)" "$(inria_camera far 9 64 48 60)" "$(inria_camera near 0 64 48 60)" \
    "$(inria_camera far 9 64 48 60)" "$(inria_camera far 9 64 48 60)"
run info knot4.spz --compare knot.ply --cameras five.json --views 2
check "info --compare --cameras: the worst view by its place in the file" grep -q '^worst .* view 2$' logs/out
run info knot.ply --compare knot.ply --cameras three.json --views 9 --json
check "info --compare: equal" grep -q \
    '"view": 2, .*"largest": 0, "nudged_psnr": null}\], "psnr": null, "ssim": 1.000000, ' logs/out
check "info --compare: the worst of equal views" grep -q \
    '"worst_psnr": null, "worst_ssim": 1.000000, "worst_view": 0}, ' logs/out
"$fixsplat" render knot4.spz --cameras three.json --view 0 -o knot4.png
"$fixsplat" render knot.ply --cameras three.json --view 0 -o knot1.png
run info knot4.spz --compare knot.ply --cameras three.json --views 1 --json
check "info --compare: nearly as compare says of the packed scenes" awk "BEGIN {
    d = $(sed 's/.*"worst_psnr": \([0-9.]*\).*/\1/' logs/out) - \
        $("$fixsplat" compare knot4.png knot1.png --json | sed 's/.*"psnr": \([0-9.]*\).*/\1/')
    exit d * d > 0.25 }"
run info layers.fxs --compare layers.ply --views 2 --size 320x240
check "info --compare: what nudging coincident Gaussians changes" grep -Eq \
    '^nudged +[0-9.]+ +view [01] of the original, each Gaussian moved by 1e-6 of the distance$' logs/out
run info layers.fxs --compare layers.ply --views 2 --size 320x240 --json
check "info --compare --json: the same" equal "$(grep -Eo '"nudged_psnr": [1-4][0-9]\.' logs/out | wc -l | tr -d ' ')" 2
run info knot.fxs --compare knot.ply --views 3 --size 320x240
check "info --compare: Gaussians with places of their own" equal "$(grep -c nudged logs/out)" 0
for profile in default compact small; do
    "$fixsplat" convert knot.ply packed.fxs --profile $profile 2>logs/err
    for scene in packed.fxs "knot.ply --profile $profile"; do
        run info $scene --compare knot.ply --size 320x240
        awk 'of_views || /^view/ { of_views = 1; print }' logs/out >"views of ${scene%% *}"
    done
    check "info --compare --profile $profile: as the .fxs" cmp "views of packed.fxs" "views of knot.ply"
    check "info --compare --profile $profile: a loss, of the floats too" equal "$(grep -c ' equal ' "views of knot.ply")" 0
done
rm -f packed.fxs "views of packed.fxs" "views of knot.ply"
# Compares pictures with two different cut-offs (where Gaussians end). Their PSNR must be nearly equal for the source
# scene and for the packed scene.
"$fixsplat" render knot.ply --cameras three.json --view 0 --cutoff square -o square.png
for cutoffs in 'mahalanobis square' 'square mahalanobis'; do
    run info knot.ply --compare knot.ply --cameras three.json --views 1 --json --cutoff ${cutoffs% *} \
        --compare-cutoff ${cutoffs#* }
    check "info --compare: cut-offs $cutoffs" awk "BEGIN {
        d = $(sed 's/.*"worst_psnr": \([0-9.]*\).*/\1/' logs/out) - \
            $("$fixsplat" compare square.png knot1.png --json | sed 's/.*"psnr": \([0-9.]*\).*/\1/')
        exit d * d > 1 }"
done
run info knot.ply --compare knot.ply --cameras three.json --views 1 --json --cutoff square
check "info --compare --cutoff: of both" grep -q '"worst_psnr": null' logs/out
fails "info --compare: no original" 1 "none.ply: No such file" info knot.ply --compare none.ply
fails "info --compare: no cameras" 1 "none.json: No such file" info knot.ply --compare knot.ply --cameras none.json

# ---- make-scene ------------------------------------------------------------------------------------------------------

for scene in $("$fixsplat" make-scene --help | sed -n 's/^  \([a-z]*\) .*(degree.*/\1/p'); do
    succeeds "make-scene $scene" make-scene $scene --count 300 -o a.ply
    "$fixsplat" make-scene $scene --count 300 -o b.ply
    "$fixsplat" make-scene $scene --count 300 --seed 2 -o c.ply
    check "make-scene $scene: the same again" cmp a.ply b.ply
    succeeds "make-scene $scene: can be rendered" render a.ply $small --hash
    check "make-scene $scene: another seed" differ "$(cksum <a.ply)" "$(cksum <c.ply)"
done
succeeds "make-scene --count 1" make-scene knot --count 1 -o one.ply
succeeds "make-scene --count 1: can be rendered" render one.ply $small --hash
succeeds "make-scene --seed 4294967295" make-scene knot --count 10 --seed 4294967295 -o a.ply
for bad in 'count 0' 'count 100000001' 'count -1' 'count 1e3' 'count' 'seed -1' 'seed 4294967296' 'seed x'; do
    fails "make-scene --$bad" 2 "--${bad%% *}" make-scene knot -o a.ply --$bad
done
succeeds "demo" demo -o "a demo.png"
check "demo: its two commands, and where the picture is" equal "$(cut -c 1-21 logs/out | grep -v '^{' | tr '\n' '|')" \
    '$ fixsplat make-scene|$ fixsplat render '"'a |a demo.png: 200,000 G|"
check "demo: the picture that they make" sh -c 'grep "^\$ fixsplat render" logs/out | tail -n 1 |
    sed "s|^. fixsplat|\"$0\"|; s|-o .*|-o again.png|" | sh && cmp again.png "a demo.png"' "$fixsplat"
fails "demo -o missing/x.png" 1 "missing/x.ply.*: cannot be" demo -o missing/x.png --quiet
fails "demo -o of no ending" 2 "picture: expected a name ending in" demo -o picture
fails "demo of a scene" 2 "demo takes no 'knot'" demo knot
succeeds "doctor" doctor
check "doctor: a line each, and what is not here gives" awk '
    /^fixsplat [0-9]/ || /^(processor|scenes read|and written) / { next }
    not_here { if (!/^ +with it: ./) exit 1; not_here = 0; next }
    /^auto +takes / { next }
    { if (!/^[a-zA-Z-]+ +(here|not here)/) exit 1; not_here = / not here/; n[not_here]++ }
    END { if (not_here || !n[0]) exit 1 }' logs/out
check "doctor: what is not built is not here" sh -c 'for part in CJSON:cJSON ZIP:libzip PNG:libpng EXPAT:expat; do
    built=$(grep -c "^FOUND += ${part%:*}\$" "$0/probe.mk")
    [ "$(grep -c "^${part#*:} *here" logs/out)" = "$built" ] || exit; done' "${fixsplat%/*}"
run doctor
mkdir apt_here && printf '#!/bin/sh\n' >apt_here/apt && chmod +x apt_here/apt
with_it() { PATH=$1 "$fixsplat" doctor | sed -n '/^ffmpeg *not here/{n;s/^ *with it: //p}'; }
check "doctor without programs, but apt" equal "$(with_it "$PWD/apt_here")" "fit takes films, render writes .mp4, .webm and .gif: apt install ffmpeg"
check "doctor without apt" equal "$(with_it)" "fit takes films, render writes .mp4, .webm and .gif: install it, in a folder of PATH"
fails "doctor takes nothing" 2 "doctor takes no 'x'" doctor x

# ---- --backend auto --------------------------------------------------------------------------------------------------

tests_cache=$XDG_CACHE_HOME kept=$PWD/cache/fixsplat/trial
export XDG_CACHE_HOME="$PWD/cache"
many='--orbit 20 --size 1280x720 --hash'
succeeds "auto: a small picture" render one.ply $small --hash
check "auto: no trial for a small picture" [ ! -e cache ]
for options in '--backend cpu' '--threads 1' '--cpu c' '--max-memory 64M'; do
    succeeds "auto: many pictures with $options" render one.ply $many $options
    check "auto: no trial with $options" [ ! -e cache ]
done
cp logs/out by_cpu
succeeds "auto: many pictures" render one.ply $many
check "auto: the same pictures" cmp logs/out by_cpu
check "auto: the trial is kept" grep -q "^cpu exact [0-9]* [0-9]* " "$kept"
check "auto: nothing else is left" equal "$(ls cache/fixsplat)" trial
check "auto: a line for each back end" equal "$(sed 1d "$kept" | cut -d ' ' -f 1 | tr '\n' ' ')" "cpu cuda vulkan gles-compute "
again() { run render one.ply $many && [ $status = 0 ] && [ ! -s logs/err ] && cmp logs/out by_cpu; }
mark() { sed "s/^cpu exact [0-9]* [0-9]*/cpu exact 7 1/" "$kept" >marked && cp marked "$kept"; }
# From here on without drivers, for short trials.
export VK_DRIVER_FILES=/none __EGL_VENDOR_LIBRARY_FILENAMES=/none
check "auto: without drivers" again
mark
check "auto: a kept trial is used" again
check "auto: and stays" cmp marked "$kept"
remade() { again && ! grep -q "^cpu exact 7 1" "$kept" && grep -q "^cpu exact" "$kept"; }
for change in 's/^fixsplat [^,]*/fixsplat 0.0.1/' 's/ threads/0 threads/' 's/, \([^,]*\), \([0-9]*\) threads/, Z80, \2 threads/' \
    's/drivers ./drivers x/' 's/^cuda /cude /' 's/^vulkan [a-z]*/vulkan fine/' 's/^cpu exact/cpu failed/' '$d' 'd' \
    's/^cpu exact [0-9]*/cpu exact -/' 's/^cuda.*//'; do
    mark
    sed -i "$change" "$kept"
    check "auto: a new trial after $change" remade
done
mark
check "auto: a new trial with another driver" env VK_DRIVER_FILES=/other "$fixsplat" render one.ply $many
check "auto: that trial is kept" sh -c '! grep -q "^cpu exact 7 1" "$0"' "$kept"
head -c 100000 /dev/urandom >"$kept"
check "auto: a new trial after random bytes" remade
rm "$kept" && mkdir "$kept"
check "auto: a folder in the file's place" again
rmdir "$kept" && ln -s /dev/full "$kept"
check "auto: a full device in the file's place" again
check "auto: the device is left alone" [ -c /dev/full ]
rm -r cache && printf 'x' >cache
check "auto: a file in the folder's place" again
check "auto: that file is left alone" equal "$(cat cache)" x
run doctor
check "doctor: why the trial is not kept" grep -q '^auto .* takes [a-z-]* .*; its trial is not kept: .*cache/fixsplat' logs/out
rm cache
XDG_CACHE_HOME= HOME= run doctor
check "doctor without a home: exit status 0" equal $status 0
check "doctor without a home" grep -q 'not kept: no folder to keep a trial in$' logs/out
unset VK_DRIVER_FILES __EGL_VENDOR_LIBRARY_FILENAMES
succeeds "doctor makes a trial" doctor
mark
succeeds "doctor shows the kept trial" doctor
check "doctor: its times" grep -q '^cpu  *here: the processor; trial: 0.0 ms a frame, opened in 0 ms$' logs/out
check "doctor: what auto takes" grep -q '^auto  *takes cpu for a window and for many pictures$' logs/out
sed -i 's/^\(vulkan\|gles-compute\) [a-z]* \(.*\)/\1 differs \2/' "$kept"
succeeds "doctor: a wrong picture" doctor
check "doctor: a wrong picture is told" equal "$(grep -c "never taken by auto: its picture differs from the processor's" logs/out)" \
    "$(grep -c differs "$kept")"
sed -i 's/^\(vulkan\|gles-compute\) differs \([0-9]*\) \([0-9]*\) .*/\1 exact \2 \3 Voodoo 2/' "$kept"
cp "$kept" before
succeeds "doctor: other devices" doctor
check "doctor: a new trial for other devices" equal "$(grep -c Voodoo "$kept")" 0
mark
succeeds "doctor --trial" doctor --trial
check "doctor --trial: anew" sh -c '! grep -q "^cpu exact 7 1" "$0"' "$kept"
# A kept trial that prefers a back end which cannot run: the processor draws.
sed -i 's/^cuda absent [0-9]* [0-9]*/cuda exact 0 0/' "$kept"
check "auto: a back end that does not open" again
export XDG_CACHE_HOME="$tests_cache"
fails "make-scene of no such name" 2 "'castle'" make-scene castle -o a.ply
for name in a.spz a.compressed.ply a.fxs; do
    fails "make-scene -o $name" 2 "$name: expected .* \.ply" make-scene knot -o $name
    check "make-scene -o $name: nothing is written" [ ! -e $name ]
done
fails "make-scene -o twice" 2 "--output b.ply: --output a.ply is given before" make-scene knot -o a.ply -o b.ply
fails "make-scene without -o" 2 "-o OUT" make-scene knot

check "no temporary file is left" equal "$(find . -name '*.tmp*')" ""

# ---- Several scenes --------------------------------------------------------------------------------------------------

"$fixsplat" make-scene cubes --count 500 -o cubes.ply
mkdir folder
cp cubes.ply folder/inner.ply
front='--size 64x48 --eye 0,-2,-12 --look 0,0,0'
both=$(hash_of knot.ply cubes.ply $front --place cubes.ply:3,0.5,-1,0.6,0,0.8,0,1.5)
check "two scenes: both are seen" differ "$both" "$(hash_of knot.ply $front)"
check "two scenes: by number" equal "$(hash_of knot.ply cubes.ply $front --place 1:3,0.5,-1,0.6,0,0.8,0,1.5)" "$both"
check "two scenes: by the end of a path" equal \
    "$(hash_of knot.ply folder/inner.ply $front --place inner.ply:3,0.5,-1,0.6,0,0.8,0,1.5)" "$both"
fails "two scenes: one name" 2 "more than one, is called cubes.ply" render ./cubes.ply folder/../cubes.ply \
    --place cubes.ply:1,2,3 --hash
fails "two scenes: a part of a name" 2 "is called bes.ply" render knot.ply cubes.ply --place bes.ply:1,2,3 --hash
check "two scenes: a quaternion of any length" equal \
    "$(hash_of knot.ply cubes.ply $front --place 1:3,0.5,-1,3,0,4,0,1.5)" "$both"
check "two scenes: the place shows" differ "$(hash_of knot.ply cubes.ply $front)" "$both"
check "a scene placed where it is" equal "$(hash_of knot.ply $small --place 0:0,0,0,1,0,0,0,1)" "$hash_small"
check "a scene moved, and the camera with it" equal \
    "$(hash_of knot.ply --size 64x48 --eye 1,-4,-9 --look 1,-2,3 --place knot.ply:1,-2,3)" \
    "$(hash_of knot.ply --size 64x48 --eye 0,-2,-12 --look 0,0,0)"
check "a scene placed twice, or given twice" equal "$(hash_of cubes.ply $front --place 0:3,0,0 --place 0:-3,0,0)" \
    "$(hash_of cubes.ply ./cubes.ply $front --place 0:3,0,0 --place 1:-3,0,0)"
for how in '--cpu c' '--threads 1' '--threads 7' '--max-memory 400K'; do
    check "two scenes: one hash with $how" equal \
        "$(hash_of knot.ply cubes.ply $front --place 1:3,0.5,-1,0.6,0,0.8,0,1.5 $how)" "$both"
done
succeeds "two scenes: framed" render knot.ply cubes.ply --place 1:50,0,0 $small -o two.png
check "two scenes: farther away" differ "$(hash_of knot.ply cubes.ply --place 1:50,0,0 $small)" \
    "$(hash_of knot.ply cubes.ply $small)"
succeeds "two scenes: bench" bench knot.ply cubes.ply $small --json
check "two scenes: bench counts both" grep -q '"gaussians": 2500, ' logs/out
succeeds "two scenes: info" info knot.ply cubes.ply --place 1:50,0,0
check "two scenes: info has their boxes" grep -q '^object 1 *cubes.ply, id 1: 4[0-9]' logs/out
succeeds "two scenes: info --json" info knot.ply cubes.ply --place 1:50,0,0 --json
check "two scenes: info --json: keys" keys logs/out scenes objects frame.bytes
succeeds "two scenes: --stats" render knot.ply cubes.ply $small --stats

json() { echo "{\"objects\": [$2]}" >"$1"; }
if "$fixsplat" render --scene cut.json --hash 2>&1 | grep -q 'built without'; then
    skip "--scene" "no cJSON"
else
    "$fixsplat" convert knot.ply knot.glb 2>logs/err
    LC_ALL=C sed 's/"srgb_rec709_display"/"lin_rec709_display" /' knot.glb >light.glb
    run render light.glb $small -o light.ppm
    check "a .glb of linear light: read, and said" equal "$status $(cat logs/err)" \
        "0 fixsplat: light.glb: its colours of linear light are turned into sRGB, in which Gaussians are blended"
    LC_ALL=C sed 's/"srgb_rec709_display"/"srgb_p3d65_display" /' knot.glb >wide.glb
    fails "a .glb of another colour space" 1 'wide.glb: colorSpace "srgb_p3d65_display" is not read: expected srgb_rec' \
        render wide.glb --hash
    json world.json '{"file": "knot.ply"},
        {"file": "cubes.ply", "translation": [3, 0.5, -1], "rotation": [0.6, 0, 0.8, 0], "scale": 1.5}'
    check "--scene" equal "$(hash_of --scene world.json $front)" "$both"
    mkdir -p folder/below
    cp knot.ply folder/below
    json folder/world.json '{"file": "below/knot.ply"},
        {"file": "inner.ply", "translation": [3, 0.5, -1], "rotation": [6, 0, 8, 0], "scale": 1.5, "id": 7,
        "visible": true, "opacity": 1, "tint": [1, 1, 1], "crops": []}, {"file": "inner.ply", "visible": false}'
    check "--scene: paths beside it" equal "$(hash_of --scene folder/world.json $front)" "$both"
    sed -e 's,\.\./knot,..\\\\knot,' -e 's,"inner,".\\\\inner,' folder/world.json >folder/windows.json
    check "--scene: paths with backslashes" equal "$(hash_of --scene folder/windows.json $front)" "$both"
    check "--scene: from within its folder" equal "$(cd folder && hash_of --scene world.json $front)" "$both"
    for change in '"opacity": 0.5' '"tint": [2, 0.5, 1]' '"visible": false' \
        '"crops": [{"low": [-9, -9, -9], "high": [0, 9, 9], "keep": "inside"}]' \
        '"crops": [{"low": [-9, -9, -9], "high": [0, 9, 9], "keep": "outside"}]'; do
        json changed.json "{\"file\": \"knot.ply\", $change}, {\"file\": \"cubes.ply\"}"
        check "--scene: $change" differ "$(hash_of --scene changed.json $front)" "$(hash_of knot.ply cubes.ply $front)"
    done
    json cropped.json '{"file": "cubes.ply", "rotation": [2, 0, 0, 1],
        "crops": [{"low": [-1, -2, -3], "high": [1.5, 2.5, 3.5], "keep": "inside"}]}'
    succeeds "--scene: info of a cropped object" info --scene cropped.json
    check "--scene: the box of what is left" grep -q ': -2.6 -2 -3 to 2.5 2.7 3.5$' logs/out
    json around.json '{"file": "knot.ply",
        "crops": [{"low": [-1e99, -1e99, -1e99], "high": [1e99, 1e99, 1e99], "keep": "inside"}]}'
    check "--scene: a crop around all" equal "$(hash_of --scene around.json $front)" "$(hash_of knot.ply $front)"
    ply solid.ply '0 0 0 1 1 1 9 3 3 3 1 0 0 0'
    json half.json '{"file": "solid.ply", "opacity": 0.5}'
    "$fixsplat" render --scene half.json --size 1x1 --eye 0,0,-9 --look 0,0,0 --alpha -o half.raw
    check "--scene: half of an opacity" equal "$(od -An -tu1 -j3 half.raw | tr -d ' ')" 128
    while read -r words change; do
        json bad.json "{\"file\": \"knot.ply\"}, {$change}"
        fails "--scene: $change" 1 "^fixsplat: bad.json: object 1: .*$words" render --scene bad.json --hash
    done <<'END'
file "scale": 1
file "file": 3
file "file": ""
known "file": "knot.ply", "colour": 1
translation "file": "knot.ply", "translation": [1, 2]
translation "file": "knot.ply", "translation": [1, 2, 1e9]
translation "file": "knot.ply", "translation": [1, 2, 1e999]
rotation "file": "knot.ply", "rotation": [0, 0, 0, 0]
rotation "file": "knot.ply", "rotation": [1, 0, 0]
rotation "file": "knot.ply", "rotation": "none"
scale "file": "knot.ply", "scale": 0
scale "file": "knot.ply", "scale": -1
scale "file": "knot.ply", "scale": "1"
scale "file": "knot.ply", "scale": 65537
opacity "file": "knot.ply", "opacity": 1.5
opacity "file": "knot.ply", "opacity": [1]
tint "file": "knot.ply", "tint": [1, 2, 5]
tint "file": "knot.ply", "tint": [1, -2, 1]
visible "file": "knot.ply", "visible": 1
id "file": "knot.ply", "id": -1
id "file": "knot.ply", "id": 1.5
id "file": "knot.ply", "id": 4294967295
crops "file": "knot.ply", "crops": {}
crop "file": "knot.ply", "crops": [1]
crop "file": "knot.ply", "crops": [{"low": [0, 0, 0], "high": [1, 1, 1]}]
crop "file": "knot.ply", "crops": [{"low": [0, 0], "high": [1, 1, 1], "keep": "inside"}]
crop "file": "knot.ply", "crops": [{"low": [0, 0, 0], "high": [1, 1, 1], "keep": "both"}]
crop "file": "knot.ply", "crops": [{"low": [0, 0, 0], "high": [1, 1, 1], "keep": "inside", "not": true}]
crops "file": "knot.ply", "crops": [{"low": [0, 0, 2], "high": [1, 1, 1], "keep": "inside"}]
END
    box='{"low": [0, 0, 0], "high": [1, 1, 1], "keep": "outside"}'
    json bad.json "{\"file\": \"knot.ply\", \"crops\": [$box, $box, $box, $box, $box, $box, $box, $box, $box]}"
    fails "--scene: nine crops" 1 "object 0: more than 8 crops" render --scene bad.json --hash
    for text in '[]' '{}' '{"objects": {}}' '{"objects": []}' '{"objects": [], "more": 1}' '{"objects": [1]}' \
        '{"objects": [{"file": "knot.ply"}]' 'x' ''; do
        echo "$text" >bad.json
        fails "--scene: $text" 1 "^fixsplat: bad.json: " render --scene bad.json --hash
    done
    ln -sf ../knot.ply folder/out.ply
    for name in ../knot.ply below/../../knot.ply "$PWD/knot.ply" '..\\\\knot.ply' '\\\\\\\\host\\\\knot.ply' C:/knot.ply \
        https://host/knot.ply %2e%2e/knot.ply; do
        json folder/bad.json "{\"file\": \"$name\"}"
        fails "--scene: $name" 1 '^fixsplat: folder/bad.json: object 0: "file" leaves the folder' \
            render --scene folder/bad.json --hash
    done
    json folder/bad.json '{"file": "out.ply"}'
    fails "--scene: a link that leads out" 1 "^fixsplat: folder/out.ply: leaves the folder of folder/bad.json" \
        render --scene folder/bad.json --hash
    json bad.json '{"file": "none.ply"}'
    fails "--scene: a file that is missing" 1 "none.ply: No such file" render --scene bad.json --hash
    fails "--scene that is missing" 1 "none.json: No such file" render --scene none.json --hash
    fails "--scene and a scene" 2 "--scene lists" render knot.ply --scene world.json --hash
    fails "--scene and --place" 2 "--scene lists" render --scene world.json --place 0:1,2,3 --hash
    succeeds "--scene: info" info --scene world.json --json
    check "--scene: info --json: keys" keys logs/out scenes objects
    succeeds "--scene: bench" bench --scene world.json $small
    json baked.json '{"file": "cubes.ply", "tint": [0.5, 2, 1], "opacity": 0.7, "rotation": [0.6, 0, 0.8, 0],
        "crops": [{"low": [-9, -9, -9], "high": [0, 9, 9], "keep": "outside"}]},
        {"file": "knot.ply", "translation": [2, 0, 0], "rotation": [1, 1, 0, 0], "scale": 0.5, "tint": [1, 0.3, 1.5]},
        {"file": "knot.ply"},
        {"file": "knot.ply", "visible": false}'
    for out in ply fxs; do
        succeeds "convert --scene to .$out" convert --scene baked.json baked.$out
    done
    run convert --scene baked.json baked.spz
    check "convert --scene to .spz" [ $status = 0 ]
    "$fixsplat" render --scene baked.json --size 320x240 --eye 0,-2,-12 --look 0,0,0 -o objects.ppm
    for out in ply fxs; do
        "$fixsplat" render baked.$out --size 320x240 --eye 0,-2,-12 --look 0,0,0 -o baked.ppm
        check "convert --scene to .$out: PSNR against the objects" at_least \
            "$("$fixsplat" compare baked.ppm objects.ppm | sed 's/PSNR \([0-9.]*\).*/\1/')" 54
    done
    json none.json '{"file": "knot.ply", "visible": false}'
    fails "convert: nothing is visible" 1 "none of the objects is visible" convert --scene none.json x.ply
    json none.json '{"file": "knot.ply", "crops": [{"low": [90, 90, 90], "high": [91, 91, 91], "keep": "inside"}]}'
    fails "convert: cropped away" 1 "the crops leave none" convert --scene none.json x.ply
    succeeds "render: cropped away" render --scene none.json $small --hash
    json packed.json '{"file": "knot.fxs"}, {"file": "knot.ply"}'
    cp knot.ply knot.fxs && "$fixsplat" convert knot.ply knot.fxs
    succeeds "convert: of a packed scene and another" convert --scene packed.json x.ply
    check "convert: of a packed scene and another: all of both" gaussians x.ply 4000 3
    check "--scene: packed and not" differ "$(hash_of --scene packed.json $small)" "$hash_small"
    rm -f none.json
fi
succeeds "convert: two scenes" convert knot.ply cubes.ply two.ply --place 1:3,0,0
check "convert: two scenes: all of them" gaussians two.ply 2500 3
cp knot4.spz smoothed.spz
printf '\001' | dd of=smoothed.spz bs=1 seek=14 conv=notrunc 2>logs/err
fails "convert: one of two anti-aliased" 1 "knot.ply: of it and others, one is anti-aliased" \
    convert smoothed.spz knot.ply two.ply
for bad in '0' '0:' '0:1,2' '0:1,2,3,4' '0:1,2,3,1,0,0' '0:1,2,3,1,0,0,0,1,1' '0:1,2,nan' '0:x,y,z' 'none:1,2,3' \
    '2:1,2,3' ':1,2,3' '0:1,2,3,0,0,0,0' '0:1,2,3,1,0,0,0,0' '0:1,2,3,1,0,0,0,-1' '0:1,2,1e9'; do
    fails "--place $bad" 2 "--place $bad: " render knot.ply cubes.ply --place $bad --hash
done

# ---- Depths, ids, picks, other cameras -------------------------------------------------------------------------------

succeeds "--depth .pfm" render knot.ply $small --depth depth.pfm
check "--depth .pfm: header" equal "$(head -n 3 depth.pfm | tr '\n' ' ')" "Pf 64 48 -1.0 "
check "--depth .pfm: its bytes" equal "$(($(wc -c <depth.pfm)))" $((14 + 64 * 48 * 4))
ply far.ply '9 0 5 1 1 1 9 -1 -1 -1 1 0 0 0' '0 0 -60 1 1 1 9 3 3 3 1 0 0 0'
succeeds "--depth .exr" render knot.ply $small --depth depth.exr
exr_rows() { tail -c $((48 * 264)) depth.exr >rows && for y in $(seq 47 -1 0); do tail -c +$((y * 264 + 9)) rows | head -c 256; done; }
exr_rows >upward && tail -c $((64 * 48 * 4)) depth.pfm >floats
check "--depth .exr: the floats of the .pfm" cmp upward floats
check "--depth .exr: its rows" equal "$(tail -c $((2 * 264)) depth.exr | od -An -td4 -N 8 | tr -s ' ')" " 46 256"
check "--depth .exr: the place of the first row" equal \
    "$(tail -c $((48 * 272)) depth.exr | od -An -td8 -N 8 | tr -d ' ')" $(($(wc -c <depth.exr) - 48 * 264))
succeeds "--depth of what lies far along -z" render far.ply --size 1x1 --eye 0,0,10 --look 0,0,0 --depth far.pfm
check "--depth of what lies far along -z: how far" equal \
    "$(tail -c 4 far.pfm | od -An -tf4 | awk '{ printf "%.2f", $1 }')" 70.00
succeeds "--depth .png" render knot.ply $small --depth depth.png
check "--depth .png: the scale is printed" grep -Eq '^depth.png: 65535 is a depth of [0-9.]+$' logs/out
check "--depth .png: 16 bits grey" equal "$(od -An -tu1 -j16 -N10 depth.png | tr -s ' ')" " 0 0 0 64 0 0 0 48 16 0"
succeeds "--depth-range" render knot.ply $small --depth ranged.png --depth-range 30
check "--depth-range: nothing to print" [ ! -s logs/out ]
check "--depth-range: another scale" differ "$(cksum <ranged.png)" "$(cksum <depth.png)"
succeeds "--depth-kind mean" render knot.ply $small --depth mean.pfm --depth-kind mean
check "--depth-kind mean is another" differ "$(cksum <mean.pfm)" "$(cksum <depth.pfm)"
for how in '--cpu c' '--threads 5' '--max-memory 400K'; do
    "$fixsplat" render knot.ply $small --depth other.pfm --ids other.raw $how
    "$fixsplat" render knot.ply $small --ids ids.raw
    check "depths with $how" cmp other.pfm depth.pfm
    check "ids with $how" cmp other.raw ids.raw
done
check "--ids .raw: its bytes" equal "$(($(wc -c <ids.raw)))" $((64 * 48 * 8))
succeeds "--ids .png" render knot.ply $small --ids ids.png --depth depth.png --depth-range 9 -o knot.png --hash
check "--ids: the picture is the same" equal "$(cat logs/out)" "$hash_small"
succeeds "--pick" render knot.ply cubes.ply $front --pick 32,24
check "--pick: a line" grep -Eq \
    '^32,24: object [01], (knot|cubes).ply, Gaussian [0-9]+, id [01], depth [0-9.]+, position ' logs/out
succeeds "--pick --json" render knot.ply $front --pick 32,24 --json
check "--pick --json: keys" keys logs/out x y object file gaussian id depth position
"$fixsplat" render knot.ply $front --ids ids.raw
check "--pick: as --ids" equal "$(sed 's/.*"gaussian": \([0-9]*\),.*/\1/' logs/out)" \
    "$(od -An -tu4 -j$((8 * (24 * 64 + 32) + 4)) -N4 ids.raw | tr -d ' ')"
succeeds "--pick of nothing" render knot.ply $small $away --pick 0,0
check "--pick of nothing: said" equal "$(cat logs/out)" "0,0: nothing"
fails "--pick beyond the picture" 1 "--pick 64,0: the picture is 64x48" render knot.ply $small --pick 64,0
mkdir all
succeeds "--view all: depths and ids" render knot.ply --cameras three.json --view all --depth all/d%d.pfm \
    --ids all/i%d.png --pick 30,20
check "--view all: depths and ids: the files" equal "$(ls all | tr '\n' ' ')" \
    "d0.pfm d1.pfm d2.pfm i0.png i1.png i2.png "
check "--view all: --pick: a line for each" equal "$(($(wc -l <logs/out)))" 3
fails "--view all: one name for depths" 2 "x.pfm: for 3 views" \
    render knot.ply --cameras three.json --view all --depth x.pfm
succeeds "--stereo --depth" render knot.ply $small --stereo 0.1 --depth eyes.pfm --ids eyes.png
check "--stereo --depth: both eyes" equal "$(sed -n 2p eyes.pfm)" "128 48"
succeeds "--ortho" render knot.ply $small --ortho 9 -o ortho.ppm
check "--ortho is no perspective" differ "$(hash_of knot.ply $small --ortho 9)" "$hash_small"
check "--ortho: distance does not matter" equal \
    "$(hash_of cubes.ply $small --eye 0,0,-20 --look 0,0,0 --ortho 9 --sh-degree 0)" \
    "$(hash_of cubes.ply $small --eye 0,0,-40 --look 0,0,0 --ortho 9 --sh-degree 0)"
"$fixsplat" convert knot.ply z.ply --rotate -90,0,0
z="z.ply $small --eye 2,-9,3"
check "--auto-up: z" equal "$(hash_of $z --auto-up)" "$(hash_of $z --up 0,0,1)"
check "--auto-up: not y" differ "$(hash_of $z --auto-up)" "$(hash_of $z)"
check "--auto-up: -y" equal "$(hash_of knot.ply $small --eye 2,-3,-9 --auto-up)" \
    "$(hash_of knot.ply $small --eye 2,-3,-9)"
fails "--auto-up and --up" 2 "give one" render knot.ply --auto-up --up 0,0,1 --hash
check "the first view: one hash with --cpu c" equal "$(hash_of z.ply $small)" \
    "$(hash_of z.ply $small --cpu c --threads 1)"
check "the first view is not that with --up" differ "$(hash_of z.ply $small)" "$(hash_of z.ply $small --up 0,-1,0)"
succeeds "--panorama" render knot.ply --panorama --size 128x64 -o around.ppm
check "--panorama: one hash with --cpu c" equal "$(hash_of knot.ply --panorama --size 128x64)" \
    "$(hash_of knot.ply --panorama --size 128x64 --cpu c --threads 1)"
run render knot.ply --panorama --size 128x64 -o around.jpg
if [ $status = 0 ]; then
    check "--panorama in a .jpg: says so" equal "$(tail -c +21 around.jpg | head -c 33 | od -An -c | tr -d ' \n')" \
        '377341002Nhttp://ns.adobe.com/xap/1.0/\0'
    check "--panorama in a .jpg: its size" equal "$(grep -ao 'GPano:[FC][a-zA-Z]*Pixels="[0-9]*"' around.jpg |
        sed 's/.*="//' | tr -d '\n')" '128"64"128"64"0"0"'
    check "--panorama in a .jpg: still a picture" "$fixsplat" compare around.jpg around.ppm --min-psnr 30
    "$fixsplat" render knot.ply $small -o flat.jpg
    check "a .jpg that is no panorama" equal "$(grep -c GPano flat.jpg)" 0
else
    skip "--panorama in a .jpg" "$(cat logs/err)"
fi
succeeds "--panorama: two pixels" render knot.ply --panorama --size 2x1 --hash
mkdir around
succeeds "--panorama --view all" render knot.ply --cameras three.json --view all --panorama --size 64x32 \
    -o around/%d.png
succeeds "--panorama of a file's view" render knot.ply --cameras three.json --panorama -o around.ppm
check "--panorama of a file's view: 2048x1024" equal "$(sed -n 2p around.ppm)" "2048 1024"
succeeds "--panorama --alpha" render knot.ply --panorama --size 64x32 --alpha -o around.raw
fails "--panorama --size 64x48" 2 "twice as wide" render knot.ply --panorama $small --hash
succeeds "--panorama --stereo" render knot.ply --panorama --stereo 1e-9 --size 256x128 -o eyes.ppm
check "--panorama --stereo: one eye above the other" equal "$(sed -n 2p eyes.ppm)" "256 256"
"$fixsplat" render knot.ply --panorama --size 256x128 -o one.ppm
{ printf 'P6\n256 256\n255\n' && tail -c $((256 * 128 * 3)) one.ppm && tail -c $((256 * 128 * 3)) one.ppm; } >twice.ppm
check "--panorama --stereo: eyes in one place" "$fixsplat" compare eyes.ppm twice.ppm --min-psnr 80
check "--panorama --stereo: an expected picture" equal "$(hash_of knot.ply --panorama --stereo 0.5 --size 128x64)" 1f21b458abdb2c9f
check "--panorama --stereo: with --cpu c, one thread" equal "$(hash_of knot.ply --panorama --stereo 0.5 --size 128x64)" \
    "$(hash_of knot.ply --panorama --stereo 0.5 --size 128x64 --cpu c --threads 1)"
# An eye at 0.5 from the middle sees a thing at a distance of 4 by asin(0.5 / 4) = 7.2 degrees beside its direction.
ball='1 1 1 4 -2 -2 -2 1 0 0 0'
ply ball.ply "0 0 4 $ball" "-4 0 0 $ball"
"$fixsplat" render ball.ply --eye 0,0,0 --look 0,0,1 --panorama --stereo 1 --size 360x180 -o balls.raw
brightest() {
    tail -c +$((($1 * 360 + $2) * 4 + 1)) balls.raw | head -c 360 | od -An -v -tu1 -w4 |
        awk -v first=$2 '$1 > most { most = $1; at = NR - 1 + first } END { print at }'
}
check "--panorama --stereo: things ahead and left, in both eyes" equal \
    "$(brightest 90 150) $(brightest 90 60) $(brightest 270 150) $(brightest 270 60)" "187 97 172 82"
succeeds "--panorama --stereo as a film" render knot.ply --panorama --stereo 0.1 --orbit 2 --size 64x32 -o eyes.y4m
check "--panorama --stereo as a film: its size" equal "$(head -n 1 eyes.y4m | cut -d ' ' -f 2,3)" "W64 H64"
for bad in ortho\ 3 tangents\ -1,1,1,-1; do
    fails "--panorama --$bad" 2 "--panorama" render knot.ply --panorama --hash --$bad
done
for bad in 'depth x.pfm' 'ids x.png' 'pick 1,1' stats; do
    fails "--panorama --$bad" 2 "--panorama" render knot.ply --panorama --$bad
done
for bad in 'depth x.jpg' 'depth x' 'ids x.ppm' 'ids x' 'depth-kind both' 'depth-kind mean' 'depth-range 0' \
    'depth-range -1' 'depth-range x' 'depth-range 3' 'pick 1' 'pick 1,' 'pick ,1' 'pick -1,1' 'pick 1,1,1' 'pick x,y' \
    'pick 99999,1' 'ortho 0' 'ortho -1' 'ortho x' 'json' 'depth x.pfm --backend gles' \
    'ids x.png --backend gles-fetch' 'pick 1,1 --stereo 0.1'; do
    fails "--$bad" 2 "" render knot.ply $small --hash --$bad
done
fails "--depth into no folder" 1 "none/x.pfm: cannot be written" render knot.ply $small --depth none/x.pfm
fails "--ids into no folder" 1 "none/x.raw: cannot be written" render knot.ply $small --ids none/x.raw

# ---- Real scenes -----------------------------------------------------------------------------------------------------

if [ -f "$scenes/snowmiku/snowmiku.ply" ]; then
    folder=$scenes/snowmiku
    succeeds "snowmiku" render "$folder/snowmiku.ply" --cameras "$folder/cameras.json" --view 0 -o snowmiku.png
    cameras="--cameras $folder/cameras.json"
    "$fixsplat" convert "$folder/snowmiku.ply" plain.ply --sh-degree 0
    "$fixsplat" convert plain.ply plain.splat
    check "snowmiku as .splat: PSNR" at_least "$(psnr_of plain.splat plain.ply $cameras)" 51
    for version in 3 4; do
        "$fixsplat" convert "$folder/snowmiku.ply" snowmiku.spz --spz-version $version --spz-fine
        check "snowmiku as .spz $version, fine: PSNR" at_least "$(psnr_of snowmiku.spz "$folder/snowmiku.ply" $cameras)" 51
    done
else
    skip "snowmiku" "no real scenes at FXS_SCENES"
fi
tile=$scenes/boatyard-tile3/boatyard-tile3.glb
run render "$tile" $small --hash
if [ $status = 0 ]; then
    check "a .glb with an .spz says nothing" equal "$(cat logs/err)" ""
else
    skip "a .glb with an .spz" "$(cat logs/err)"
fi
# Writes a glTF file with one Gaussian.
accessor='"componentType":5126,"count":1,"type"'
cat >draft.gltf <<END
{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"mode":0,
"extensions":{"KHR_gaussian_splatting":{"kernel":"ellipse"}},"attributes":{"POSITION":0,
"KHR_gaussian_splatting:ROTATION":1,"KHR_gaussian_splatting:SCALE":2,"KHR_gaussian_splatting:OPACITY":3,
"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0":0}}]}],"buffers":[{"byteLength":44,"uri":
"data:;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACAPwAAgL8AAIC/AACAvwAAwD8="}],
"bufferViews":[{"buffer":0,"byteLength":44}],"accessors":[{"bufferView":0,$accessor:"VEC3"},
{"bufferView":0,"byteOffset":12,$accessor:"VEC4"},{"bufferView":0,"byteOffset":28,$accessor:"VEC3"},
{"bufferView":0,"byteOffset":40,$accessor:"SCALAR"}]}
END
run info draft.gltf
if [ $status = 0 ]; then
    check "a glTF of a draft: its logarithms are said, and opacities above 1" equal "$(cat logs/err)" \
        "fixsplat: draft.gltf: opacities above 1 are drawn as 1
fixsplat: draft.gltf: scales below 0: all are read as logarithms, as splat-transform wrote them until June 2026"
else
    skip "a glTF of a draft" "$(cat logs/err)"
fi

# ---- Memory ----------------------------------------------------------------------------------------------------------

number() { sed -n "s/.*\"bytes\":.*\"$1\": \([0-9]*\).*/\1/p" logs/out; }
if [ "$(df -Pk . | awk 'NR == 2 { print $4 }')" -gt 1048576 ]; then
    "$fixsplat" make-scene landscape --count 1000000 -o million.ply
    peak=$($helper peak "$fixsplat" render million.ply -o million.png)
    run render million.ply --stats
    bound=$(($(number scene) * 13 / 10 + $(number frame) + (16 << 20)))
    said="memory for a million Gaussians: ${peak:=0} KiB of $((bound / 1024))"
    if [ "$peak" -gt 1000 ] && [ $((peak * 1024)) -le $bound ]; then ok "$said"; else fail "$said" "too much"; fi
    "$fixsplat" convert million.ply million.fxs
    # The kernel maps more or fewer pages of the program, up to 600 KiB, so the least of five peaks counts.
    peak=$(for run in 1 2 3 4 5; do
        $helper peak "$fixsplat" render million.fxs --threads 2 --max-memory 25M -o bands.png
    done | sort -n | head -n 1)
    bound=$(($(wc -c <million.fxs) + (25 << 20) + (16 << 20)))
    said="memory for a million Gaussians in 25 MB: ${peak:=0} KiB of $((bound / 1024))"
    if [ "$peak" -gt 1000 ] && [ $((peak * 1024)) -le $bound ]; then ok "$said"; else fail "$said" "too much"; fi
    check "a million Gaussians in 25 MB: the same picture" cmp million.png bands.png
    peak=$($helper peak "$fixsplat" render million.fxs --eye 14,-2.2,-6 --look 15.2,-1.6,-5.2 -o meadow.png)
    run render million.fxs --stats
    bound=$(($(number scene) / 2 + $(number frame) / 4 + (16 << 20)))
    said="memory of a close-up among a million Gaussians: ${peak:=0} KiB of $((bound / 1024))"
    if [ "$peak" -gt 1000 ] && [ $((peak * 1024)) -le $bound ]; then ok "$said"; else fail "$said" "too much"; fi
else
    skip "memory for a million Gaussians" "less than 1 GB free"
fi
# ---- Lens distortion -------------------------------------------------------------------------------------------------

colmap() {
    mkdir -p "$1" && echo "$2" >"$1/cameras.txt" && printf '1 1 0 0 0 0 0 6 7 a.jpg\n\n' >"$1/images.txt"
}
colmap bent "7 OPENCV 64 48 60 60 32 24 0.1 0.01 0.001 0"
colmap straight "7 PINHOLE 64 48 60 60 32 24"
run render knot.ply --cameras straight --view 0 -o straight.ppm
check "a pinhole: not a word" equal "$status $(cat logs/err)" "0 "
colmap shifted "7 PINHOLE 64 48 60 60 20.5 27.25"
"$fixsplat" render knot.ply --cameras shifted -o shifted.ppm
check "the principal point is the camera's" differ "$(cksum <shifted.ppm)" "$(cksum <straight.ppm)"
"$fixsplat" render knot.ply --cameras shifted --size 64x48 -o resized.ppm
check "--size that is the view's own: the same picture" cmp resized.ppm shifted.ppm
colmap larger "7 PINHOLE 128 96 120 120 41 54.5"
check "--size scales the principal point" equal "$(hash_of knot.ply --cameras shifted --size 128x96)" \
    "$(hash_of knot.ply --cameras larger)"
colmap prism "7 THIN_PRISM_FISHEYE 64 48 60 60 32 24 0.1 0 0 0 0 0 0 0"
run render knot.ply --cameras prism --view 0 -o prism.ppm
said="1 of 1 views have a lens that bends: they are drawn as by a pinhole; render --lens draws them as it does"
check "a fisheye: drawn as by a pinhole, and said" equal \
    "$status $(cat logs/err) $(cmp prism.ppm straight.ppm 2>&1)" "0 fixsplat: prism: $said "
run render knot.ply --cameras bent --view 0 -o bent.ppm
check "a lens that bends: said" equal "$status $(cat logs/err)" "0 fixsplat: bent: $said"
check "a lens that bends: drawn as by a pinhole" cmp bent.ppm straight.ppm
finish
