#!/bin/sh
# Tests `fixsplat fit --watch`: photographs that arrive, also cut, twice, of another size or without a place; signals,
# --resume, and a folder that vanishes. A script imitates COLMAP. FXS_PROCESSORS=all adds the real COLMAP.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"
fit=
trap 'kill $fit 2>/dev/null; rm -rf "$work"' EXIT

make_photographs 14
mkdir bin
export PLAY=$PWD

# Writes a script that imitates COLMAP. Its mapper places all photographs of the folder images but those that the file
# `unplaced` names. A model that it continues becomes twice as large, moves, and gets more points.
cat >bin/colmap <<'PLAYED'
#!/bin/sh
echo "$*" >>"$PLAY/calls"
[ "$2" != -h ] || exit 0
option() { while [ "$1" ]; do case $1 in "$name") echo "$2"; return ;; esac; shift; done; }
case $1 in
feature_extractor) name=--image_list_path; tr '\n' ' ' <"$(option "$@")" >>"$PLAY/lists"; echo >>"$PLAY/lists" ;;
matches_importer) name=--match_list_path; cat "$(option "$@")" >>"$PLAY/pairs" ;;
mapper)
    [ "$1" != "$(cat "$PLAY/waits")" ] || { : >"$PLAY/waiting"; sleep 3; }
    [ "$1" != "$(cat "$PLAY/broken")" ] || exit 3
    name=--output_path out=$(option "$@")
    name=--input_path in=$(option "$@")
    name=--image_path images=$(option "$@")
    [ "$in" ] || { [ ! -s "$PLAY/apart" ] || exit 1; mkdir "$out/0" && out=$out/0; }
    perl "$PLAY/model.pl" "$PLAY/set/sparse/0" "$out" "$images" "$PLAY/unplaced" "$in" ;;
model_analyzer) printf 'Points: 200\nMean reprojection error: 0.511px\n' ;;
esac
PLAYED
chmod +x bin/colmap
: >waits
: >unplaced
: >broken

cat >model.pl <<'PLAYED'
my ($from, $to, $images, $unplaced, $more) = @ARGV;
my ($s, @d) = $more ? (2, 5, -3, 1) : (1, 0, 0, 0);
sub lines { open(my $f, "<", $_[0]) or die; return grep { /\S/ } <$f>; }
sub out { open(my $f, ">:raw", "$to/$_[0]") or die; print $f $_[1]; }
my ($id, $model, @p) = split ' ', (lines("$from/cameras.txt"))[0];
out("cameras.bin", pack("Q<l<l<Q<Q<d<*", 1, $id, 1, splice(@p, 0, 2), @p));
my %no = map { chomp; $_, 1 } lines($unplaced);
my @names = grep { /^\d+-(\d\d\.png)$/ && !$no{$1} } map { s|.*/||r } sort glob("$images/*.png");
my %pose = map { my @v = split ' '; $v[9], [@v[1 .. 7]] } lines("$from/images.txt");
my $bytes = pack("Q<", scalar @names);
foreach (@names) {
    my ($number, $name) = /^(\d+)-(.*)/;
    my ($w, $x, $y, $z, @t) = @{$pose{$name}};
    my @r = ([1 - 2 * ($y * $y + $z * $z), 2 * ($x * $y - $w * $z), 2 * ($x * $z + $w * $y)],
             [2 * ($x * $y + $w * $z), 1 - 2 * ($x * $x + $z * $z), 2 * ($y * $z - $w * $x)],
             [2 * ($x * $z - $w * $y), 2 * ($y * $z + $w * $x), 1 - 2 * ($x * $x + $y * $y)]);
    for my $k (0 .. 2) { $t[$k] = $s * $t[$k] - ($r[$k][0] * $d[0] + $r[$k][1] * $d[1] + $r[$k][2] * $d[2]); }
    $bytes .= pack("l<d<7l<Z*Q<", $number + 1, $w, $x, $y, $z, @t, 1, $_, 0);
}
out("images.bin", $bytes);
my @points = map { [split ' '] } lines("$from/points3D.txt");
@points = @points[0 .. 199] unless $more;
$bytes = pack("Q<", scalar @points);
$bytes .= pack("Q<d<3C3d<Q<", $$_[0] + 1, $s * $$_[1] + $d[0],
    $s * $$_[2] + $d[1], $s * $$_[3] + $d[2], @$_[4 .. 7], 0) foreach @points;
out("points3D.bin", $bytes);
PLAYED
PATH="$work/bin:$PATH"

# begins ARGUMENT...: starts a fit that watches the folder `in`.
begins() {
    "$fixsplat" fit in --watch=4 --steps 300 --threads 1 -o out.fxs "$@" >logs/printed 2>logs/errors &
    fit=$!
}
ends() { wait $fit; status=$?; fit=; }
clears() { rm -rf in out.fxs* calls lists pairs logs/printed logs/errors; mkdir in; }
arrive() { for name; do cp "set/images/$name.png" in; done; }
# awaits WORDS: until the fit prints a line that matches.
awaits() {
    tries=0
    until grep -Eq -- "$1" logs/errors 2>/dev/null || ! kill -0 $fit 2>/dev/null || [ $((tries += 1)) = 300 ]; do
        sleep 0.1
    done
    check "$1" grep -Eq -- "$1" logs/errors
}

# ---- Photographs arrive ----------------------------------------------------------------------------------------------

clears
begins --hold-out 4
awaits '^fixsplat: in: 0 of the first 8 photographs have arrived$'
arrive 00 01 02 03 04 05 06
awaits '^fixsplat: in: 7 of the first 8 photographs have arrived$'
arrive 07
awaits '^fixsplat: in: 8 new photographs; places of 8 of 8, in '
check "two of the first eight are held out" grep -q '^fixsplat: 6 photographs to fit, 2 held out, up to 64x48; 200 points$' logs/errors
echo 09.png >unplaced
cp in/03.png in/again.png
arrive 08 09
awaits '^fixsplat: 09.png: no place yet: tried again when more have arrived$'
awaits '^fixsplat: in/again.png: left out: the same photograph as 03.png$'
head -c 300 set/images/10.png >in/10.png
head -c 300 set/images/11.png >in/11.png
sleep 2.5
arrive 10
: >unplaced
awaits '^fixsplat: in: 1 new photograph; places of 11 of 11, in '
check "a photograph that was written slowly is taken whole" cmp out.fxs.cameras/images/00010-10.png set/images/10.png
arrive 12 13
touch -d '2001-01-01' in/02.png
awaits '^fixsplat: in/02.png: has changed: the fit keeps the photograph as it was$'
awaits '^fixsplat: in: 2 new photographs; places of 13 of 13, in '
ends
check "the watch ends, and the fit is complete" equal "$status $(grep -c '^out.fxs: ' logs/printed) $(
    grep -c '^fixsplat: in: no photograph arrived for 4 s: 13 have arrived; the rest of the steps follows$' logs/errors)" "0 1 1"
check "each fourth that arrived is held out" grep -q '^Photographs fitted: 9. Of the 4 held out:$' logs/printed
check "repeated steps come on top" [ "$(sed -n 's/^out.fxs: .*; \([0-9]*\) steps, .*/\1/p' logs/printed)" -gt 300 ]
check "the fit was saved as it went" [ -s out.fxs.fit ]
check "a scene" "$fixsplat" info out.fxs
check "new photographs have the lens of the first" equal "$(grep -c '^feature_extractor .*single_camera 1$' calls) $(
    grep -c '^feature_extractor .*existing_camera_id 1$' calls)" "1 3"
check "features are looked for once" equal "$(tr ' ' '\n' <lists | grep . | sort | uniq -d)" ""
check "the last is matched with the 12 before it and every eighth" equal "$(grep -c ' 00012-13.png$' pairs)" 12
check "old cameras are held" grep -q '^mapper .*--Mapper.fix_existing_images 1 --Mapper.ba_refine_focal_length 0' calls
"$fixsplat" fit set --measure out.fxs --hold-out 2 >logs/out 2>logs/err
check "the cameras stay where they are though the mapper moves them" at_least "$(awk '/^mean/ { print $2; exit }' logs/out)" 18
"$fixsplat" fit out.fxs.cameras -o again.fxs --steps 20 >logs/out 2>logs/err
check "its cameras are a folder of COLMAP" grep -q '^fixsplat: 11 photographs to fit, 2 held out' logs/err

# ---- Photographs that are left out, or of another size ---------------------------------------------------------------

clears
"$fixsplat" render knot.ply --cameras set/sparse/0 --view 8 --size 80x60 -o larger.png
arrive 00 01 02 03 04 05 06 07
begins
awaits '8 of 8'
cp larger.png in/08.png
head -c 300 set/images/09.png >in/09.png
echo text >in/notes.txt
mkdir in/folder.png
awaits '^fixsplat: in: photographs of 2 sizes and lenses, each of which is a camera$'
awaits '^fixsplat: in: 1 new photograph; places of '
check "another size is another lens" equal "$(grep -c '^feature_extractor .*single_camera 1$' calls)" 2
check "which COLMAP may refine" equal "$(grep -c 'focal_length 1 --Mapper.ba_refine_extra_params 1$' calls)" 1
for name in 10 11 12 13; do arrive $name; sleep 3.5; done
awaits '^fixsplat: in/09.png: .*: left out$'
ends
check "a photograph that stays cut is left out" equal "$status $(ls out.fxs.cameras/images | grep -c 09.png)" "0 0"
check "nothing is left of it" equal "$(ls out.fxs.cameras | grep arriving)" ""

# ---- Too few, and photographs that do not overlap --------------------------------------------------------------------

clears
arrive 00 01
fails "too few" 1 'in: no photograph arrived for 3 s, and 2 are too few to find their cameras' fit in --watch=3 -o out.fxs --quiet
clears
echo apart >apart
arrive 00 01 02 03 04 05 06 07
begins
awaits '^fixsplat: in: 8 photographs: no two from different places overlap enough yet$'
: >apart
arrive 08
awaits '^fixsplat: in: 1 new photograph; places of 9 of 9, in '
head -c 300 set/images/09.png >in/09.png
ends
check "a photograph that is cut when the watch ends" grep -q '^fixsplat: in/09.png: left out: not complete in time$' logs/errors
check "the next photograph makes it possible" equal $status 0

# ---- Signals, --resume and a folder that vanishes ----------------------------------------------------------------------

clears
arrive 00 01 02 03 04 05 06 07
begins
awaits '8 of 8'
arrive 08
awaits '9 of 9'
sleep 1.5
kill -TERM $fit
ends 2>logs/shell
check "a signal saves the fit" equal "$status $(grep -c 'stopped after .* steps of .*; to go on: fixsplat fit .*--watch=4.* --resume out.fxs.fit$' logs/errors)" "143 1"
rm calls
arrive 09
begins --resume out.fxs.fit
awaits '10 of 10'
ends
check "--resume goes on, with one more" equal "$status $(grep -c '^Photographs fitted: 8. Of the 2 held out:' logs/printed)" "0 1"
check "--resume does not begin anew" equal "$(grep -c 'exhaustive_matcher\|single_camera ' calls)" 0
run fit in --watch=4 --steps 300 -o out.fxs --resume out.fxs.fit
check "--resume of a fit that was over" equal "$status $(grep -c 'new photograph' logs/err)" "0 0"

clears
arrive 00 01 02 03 04 05 06 07
begins
awaits '8 of 8'
sleep 1
echo mapper >waits
rm -f waiting
arrive 08
tries=0
until [ -e waiting ] || [ $((tries += 1)) = 100 ]; do sleep 0.1; done
kill -TERM $fit
ends 2>logs/shell
: >waits
check "a signal while COLMAP is at work" equal "$status $(grep -c 'stopped after ' logs/errors)" "143 1"

clears
arrive 00 01 02 03 04 05 06 07
begins
awaits '8 of 8'
sleep 1
echo mapper >broken
arrive 08
ends
: >broken
check "COLMAP fails: the fit is saved" equal "$status $(grep -c 'colmap: failed while placing photographs' logs/errors) $(
    grep -c '^fixsplat: saved after .* to go on: ' logs/errors)" "1 1 1"
arrive 09
begins --resume out.fxs.fit
awaits '10 of 10'
ends
check "and goes on" [ $status = 0 ]

clears
arrive 00 01 02 03 04 05 06 07
begins
awaits '8 of 8'
rm -r in
ends
check "a folder that vanishes ends the fit" equal "$status $(grep -c '^fixsplat: in: the folder is gone$' logs/errors)" "1 1"
check "with a scene and a saved fit" sh -c "'$fixsplat' info out.fxs && [ -s out.fxs.fit ]"
check "and the command that goes on" grep -q 'to go on: fixsplat fit .*--watch=4.* --resume out.fxs.fit$' logs/errors

# ---- The preview -----------------------------------------------------------------------------------------------------

"$fixsplat" view --web none.ply >logs/out 2>logs/err
case $(have curl || echo 'built without')$(cat logs/err) in
*'built without'*) skip preview "no curl or no server here" ;;
*)
    mkdir -p page/viewer
    echo '<!doctype html>' | tee page/viewer/index.html >page/viewer/fit.html
    export FIXSPLAT_WEB="$work/page"
    clears
    arrive 00 01 02 03 04 05 06 07
    begins --hold-out 4 --preview --port 0
    awaits '8 of 8'
    at=$(sed -n 's|^fixsplat: preview: \(.*\)/$|\1|p' logs/errors)
    held() { curl -s "$at/cameras.json" | grep -c img_name; }
    until [ "$(held)" = 2 ] || [ $((tries += 1)) = 600 ]; do sleep 0.1; done
    check "the preview shows two held-out photographs" equal "$(held)" 2
    arrive 08
    awaits '9 of 9'
    sleep 0.5
    check "and the third after it has arrived" equal "$(held)" 3
    ends
    check "a fit with the preview" equal $status 0 ;;
esac

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "a folder with cameras" 2 'set: has cameras: --watch takes a folder of photographs without' fit set -o x.fxs --watch
fails "no folder" 2 'none: --watch takes a folder, into which photographs arrive' fit none -o x.fxs --watch
fails "--watch=0" 2 'watch=0: expected 1 to 86400 seconds' fit in -o x.fxs --watch=0
for option in sky "block 1/2" moving cameras-only "frames 9" "masks m" measure\ x.fxs; do
    fails "--$option" 2 'does not go with|leave out|needs|cannot' fit in -o x.fxs --watch --$option
done
fails "--of outdoors" 2 'of outdoors does not go with --watch' fit in -o x.fxs --watch --of outdoors

# ---- The real COLMAP -------------------------------------------------------------------------------------------------

PATH=${PATH#"$work/bin:"}
photos=$(cd "$root/${FXS_PHOTOS:-../shared/photos}" 2>/dev/null && pwd)
if [ "$FXS_PROCESSORS" != all ]; then
    skip "the real COLMAP" "only in make test-all"
elif ! have ffmpeg || ! have colmap || [ ! -d "$photos/snowmiku" ]; then
    skip "the real COLMAP" "not here: ffmpeg, colmap or the shared photographs"
else
    mkdir small
    for name in $(ls "$photos/snowmiku/images" | head -n 11); do
        ffmpeg -v error -i "$photos/snowmiku/images/$name" -vf scale=400:300:flags=area -q:v 1 "small/$name"
    done
    clears
    "$fixsplat" fit in --watch=20 --steps 600 --resolution 400 -o out.fxs >logs/printed 2>logs/errors &
    fit=$!
    for name in small/*; do
        cp "$name" in
        [ "$name" \< "$(ls small/* | sed -n 8p)" ] || sleep 4
    done
    ends
    check "photographs of snowmiku that arrive one by one" grep -q 'places of 11 of 11' logs/errors
    check "a fit of them" equal "$status $(grep -c '^Photographs fitted: 9. Of the 2 held out:' logs/printed)" "0 1"
fi
finish
