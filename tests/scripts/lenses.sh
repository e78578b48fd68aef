#!/bin/sh
# Tests `fixsplat render --lens`, and camera files of other programs.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

"$fixsplat" make-scene knot --count 2000 -o knot.ply || exit 1

colmap() {
    mkdir -p "$1" && echo "$2" >"$1/cameras.txt"
    printf '1 1 0 0 0 0 0 6 7 a.jpg\n\n2 0.9 0.1 0 0 0 0 7 7 b.jpg\n\n' >"$1/images.txt"
}
colmap straight "7 PINHOLE 64 48 60 60 32 24"
colmap barrel "7 SIMPLE_RADIAL 64 48 60 32 24 -0.3"
colmap fisheye "7 OPENCV_FISHEYE 64 48 18 18 32 24 0 0 0 0"

"$fixsplat" render knot.ply --cameras straight --view all -o straight%d.ppm
"$fixsplat" render knot.ply --cameras straight --view all --lens -o same%d.ppm 2>logs/err
check "--lens of a pinhole: the same picture, not a word" equal "$(cat logs/err)$(cmp straight1.ppm same1.ppm)" ""
"$fixsplat" render knot.ply --cameras barrel --view all --lens -o lens%d.ppm 2>logs/err
check "--lens of a lens: the photograph's size, not a word" equal \
    "$(cat logs/err)$(head -c 12 lens0.ppm | tr '\n' ' ')" "P6 64 48 255"
check "another picture" sh -c "! cmp -s lens0.ppm straight0.ppm"
golden=9f3fbec5428de601
check "the same bytes everywhere" equal "$("$fixsplat" render knot.ply --cameras barrel --view 1 --lens --hash)" $golden
for options in "--threads 1" "--threads 5" "--cpu c" "--max-memory 600K"; do
    check "with $options" equal \
        "$("$fixsplat" render knot.ply --cameras barrel --view 1 --lens --hash $options)" $golden
done
"$fixsplat" render knot.ply --cameras barrel --view 1,0,1 --lens -o list%d.ppm
check "views of a list, each with its lens" sh -c \
    "cmp list0.ppm lens1.ppm && cmp list1.ppm lens0.ppm && cmp list2.ppm lens1.ppm"

"$fixsplat" render knot.ply --cameras fisheye --lens --bg 405060 -o fisheye.ppm
check "beyond 75 degrees is background" equal "$(tail -c +14 fisheye.ppm | head -c 3 | od -An -tx1 | tr -d ' ')" 405060
"$fixsplat" render knot.ply --cameras fisheye --lens --alpha -o fisheye.raw
check "and with --alpha nothing" equal "$(head -c 4 fisheye.raw | od -An -tx1 | tr -d ' ')" 00000000
"$fixsplat" render knot.ply --cameras barrel --lens --size 128x96 -o twice.ppm
check "--size" equal "$(head -c 13 twice.ppm | tr '\n' ' ')" "P6 128 96 255"

fails "--lens without --cameras" 2 "^fixsplat: --lens needs --cameras" render knot.ply --lens -o a.png
for options in "--depth d.png" "--ids i.png" "--pick 1,1" "--stats" "--scissor 0,0,9,9" "--panorama" "--stereo 1" \
    "--ortho 3" "--tangents -1,1,1,-1" "--orbit 3"; do
    fails "--lens with $options" 2 "does not go with --lens" \
        render knot.ply --cameras barrel --lens $options -o a%d.png
done

# ---- Round trip from --lens to a fit ---------------------------------------------------------------------------------

. "$root/tests/scripts/lib/photos.sh"
make_photographs 9
for camera in "SIMPLE_RADIAL 320 240 300 160 120 -0.2" "OPENCV 320 240 300 300 160 120 .1 -.02 .003 .004" \
    "OPENCV_FISHEYE 320 240 160 160 160 120 .02 0 0 0" "FISHEYE 320 240 75 75 160 120" \
    "EUCM 320 240 200 200 160 120 .6 1"; do
    echo "1 $camera" >set/sparse/0/cameras.txt
    "$fixsplat" render knot.ply --cameras set/sparse/0 --view all --lens -o set/images/%02d.png
    "$fixsplat" fit set --measure knot.ply --json >logs/out 2>logs/err
    check "the scene itself fits photographs of ${camera%% *}: 40 dB" \
        at_least "$(sed -n 's/.*"psnr": \([0-9.]*\).*/\1/p' logs/out | sort -n | head -n 1)" 40
done

# ---- Camera files of other programs ----------------------------------------------------------------------------------

mkdir exports
echo '#name,x,y,alt,heading,pitch,roll,f,px,py,k1
a.jpg,0,0,-6,0,180,0,33.75,0,0,-0.3' >exports/a.csv
check "RealityCapture's .csv, with the photograph's size" equal \
    "$("$fixsplat" render knot.ply --cameras exports/a.csv --lens --size 64x48 --hash)" \
    "$("$fixsplat" render knot.ply --cameras barrel --lens --hash)"
printf '# Bundle file v0.3\n1 0\n60 -0.3 0\n1 0 0\n0 -1 0\n0 0 -1\n0 0 -6\n' >exports/a.out
echo a.jpg >exports/list.txt
check "Bundler's .out" equal "$("$fixsplat" render knot.ply --cameras exports/a.out --lens --size 64x48 --hash)" \
    "$("$fixsplat" render knot.ply --cameras barrel --lens --hash)"
echo '<document><chunk><sensors><sensor id="0" type="frame"><resolution width="64" height="48"/><calibration><f>60</f>
<k1>-0.3</k1></calibration></sensor></sensors><cameras><camera label="a.jpg" sensor_id="0"><transform>1 0 0 0 0 1 0 0 0
0 1 -6 0 0 0 1</transform></camera></cameras></chunk></document>' >exports/cameras.xml
run render knot.ply --cameras exports --lens --hash
if grep -q 'built without expat' logs/err; then
    skip "Metashape's .xml" "built without expat"
else
    check "Metashape's .xml, by its folder" equal "$(cat logs/out)" \
        "$("$fixsplat" render knot.ply --cameras barrel --lens --hash)"
fi
fails "a text that is no cameras" 1 ".csv of RealityCapture, .out of Bundler, or a folder with one of them\\), but" \
    render knot.ply --cameras knot.ply -o a.png
finish
