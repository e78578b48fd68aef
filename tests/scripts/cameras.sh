#!/bin/sh
# Tests `fixsplat fit` from photographs without cameras and from films. Scripts imitate ffmpeg and COLMAP and their
# failures. FXS_PROCESSORS=all adds the real programs.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"

make_photographs 12
mkdir -p bin plain
cp set/images/*.png plain
export PLAY=$PWD
with() { PATH="$work/bin:$PATH" "$@"; }

# Writes a script that imitates COLMAP. Its mapper makes two models (sets of cameras), and only the second has all
# cameras.
cat >bin/colmap <<'PLAYED'
#!/bin/sh
echo "$*" >>"$PLAY/calls"
if [ "$2" = -h ]; then
    [ "$NEW" ] && printf '  --Feature%s arg\n' Extraction.use_gpu Extraction.max_image_size
    exit 0
fi
case "$QT_QPA_PLATFORM $* " in
offscreen\ m[ao][pd]* | offscreen\ *.use_gpu\ 0\ *) ;;
*) kill -6 $$ ;;
esac
[ "$1" != "$KILLED" ] || kill -9 $$
[ "$1" != "$FAILS" ] || { echo "ERROR: played"; exit 1; }
if [ "$1" = "$WAITS" ]; then               # creates the file that `helper signal` waits for, then waits
    sleep 60 &
    echo $$ $! >"$PLAY/waiting"
    : >"$PLAY/.fixsplat-waiting.tmp"
    wait
fi
case $1 in
feature_extractor)
    echo "Processed file [1/12]"
    while [ "$1" != --image_list_path ]; do shift; done
    echo $(cat "$2") >>"$PLAY/lists" ;;
exhaustive_matcher)
    echo "${MATCHING:-Matching block [2/2, 1/2]}" >&${NEW:-1} ;;
matches_importer)
    while [ "$1" != --match_list_path ]; do shift; done
    cat "$2" >>"$PLAY/pairs"
    echo part >>"$PLAY/pairs" ;;
mapper)
    [ -z "$NOTHING" ] || exit 1
    while [ "$1" != --output_path ]; do shift; done
    for model in 0 1; do
        mkdir -p "$2/$model"
        perl "$PLAY/model.pl" "$PLAY/set/sparse/0" "$2/$model" $((model ? 12 : 4))
        for file in $CUT; do
            head -c 50 "$2/$model/$file" >"$PLAY/cut" && cp "$PLAY/cut" "$2/$model/$file"
        done
    done
    [ -z "$ENDS" ] || exit "$ENDS" ;;
model_analyzer) printf 'Points: %s\nMean reprojection error: %s\n' "${POINTS:-400}" "${ERROR:-0.511px}" ;;
*) exit 1 ;;
esac
PLAYED

cat >model.pl <<'PLAYED'
my ($from, $to, $count) = @ARGV;
sub lines { open(my $f, "<", "$from/$_[0]") or die; return grep { /\S/ } <$f>; }
sub out { open(my $f, ">:raw", "$to/$_[0]") or die; print $f $_[1]; }
my ($id, $model, @p) = split ' ', (lines("cameras.txt"))[0];
out("cameras.bin", pack("Q<l<l<Q<Q<d<*", 1, $id, 1, splice(@p, 0, 2), @p));
my @images = lines("images.txt");
my $bytes = pack("Q<", $count);
foreach (@images[0 .. $count - 1]) {
    my @v = split ' ';
    $bytes .= pack("l<d<7l<Z*Q<", @v[0 .. 9], 0);
}
out("images.bin", $bytes);
my @points = lines("points3D.txt");
$bytes = pack("Q<", scalar @points);
$bytes .= pack("Q<d<3C3d<Q<", @$_[0 .. 7], 0) foreach map { [split ' '] } @points;
out("points3D.bin", $bytes);
PLAYED

# Writes a script that imitates ffmpeg. Every seventh of the $FRAMES frames is sharp.
cat >bin/ffmpeg <<'PLAYED'
#!/bin/sh
echo "$*" >>"$PLAY/calls"
case "$*" in
*rawvideo*)
    perl -e 'for (0 .. $ARGV[0] - 1) { print $_ % 7 == 3 ? "\xff\x00" x 32768 : "\x7f" x 65536 }' "$FRAMES"
    [ -z "$DAMAGED" ] || exit 69 ;;
*)
    for last; do :; done
    n=0
    for image in "$PLAY"/set/images/*.png; do
        n=$((n + 1))
        [ "$n" != "$LAST" ] || exit "$ENDS"
        cp "$image" "$(printf "${last#file:}" $n)"
        [ "$n" != "$CUT" ] || head -c 900 "$image" >"$(printf "${last#file:}" $n)"
    done
    [ -z "$DAMAGED$ENDS" ] || exit ${ENDS:-69} ;;
esac
PLAYED
chmod +x bin/*

# ---- Photographs -----------------------------------------------------------------------------------------------------

steps='--steps 9 --hold-out 0'
"$fixsplat" fit set $steps -o set.fxs --quiet >logs/out
check "a folder of photographs" with "$fixsplat" fit plain $steps -o a.fxs
check "it is the scene of COLMAP's folder with these cameras" cmp a.fxs set.fxs
check "each is matched with each" grep -q '^exhaustive_matcher ' calls
check "photographs of one size are of one camera" grep -q 'single_camera 1$' calls
check "the folder beside the scene is one of COLMAP" sh -c "ls a.fxs.cameras/sparse/0/images.bin a.fxs.cameras/images/00.png"
rm calls
with "$fixsplat" fit plain -o several.fxs --cameras-only --photos mixed 2>logs/err
check "--photos mixed: a camera each" grep -q 'single_camera_per_image 1$' calls
rm calls
with "$fixsplat" fit plain $steps -o a.fxs >logs/out 2>logs/err
check "again: the cameras of before" equal "$(cut -d' ' -f1 calls)" model_analyzer
check "what was found is said" grep -q '^fixsplat: plain: cameras of 12 of 12 photographs, 400 points, reprojection error 0.51 pixels$' \
    logs/err
with "$fixsplat" fit plain -o only.fxs --cameras-only 2>logs/err
check "--cameras-only" equal "$? $(sed 's/, some [0-9]* s left//; s/^fixsplat: //; /cameras of/d' logs/err)" "0 \
looking at photographs: 1 of 12
looking for features of photographs: 1 of 12
matching pairs of photographs: 33 of 66
placing photographs: 0 of 12"
check "--cameras-only: no scene" [ ! -e only.fxs ]
mkdir below && ln -s ../plain below/images
check "photographs in a folder images" with "$fixsplat" fit below $steps -o below.fxs --quiet
check "they are the same" cmp below.fxs set.fxs

# fixsplat must give COLMAP masks under the file names that COLMAP expects, white where photographs count.
cp -r plain masked && mkdir masked/masks inverse
for colour in ffffff 000000; do
    "$fixsplat" render knot.ply --size 64x48 --eye 0,0,-9 --look 0,0,-20 --bg $colour -o $colour.png
done
cp ffffff.png masked/masks/02.png && cp 000000.png masked/masks/03.png.png
cp 000000.png inverse/02.png && cp ffffff.png inverse/03.png
with "$fixsplat" fit masked $steps -o masks.fxs >logs/out 2>logs/err
check "masks: COLMAP is given them" grep -q '^feature_extractor .*--ImageReader.mask_path masks.fxs.cameras/masks$' calls
check "masks: by its names" cmp masks.fxs.cameras/masks/02.png.png ffffff.png
check "masks: the fit has them" grep -q '^fixsplat: masks.fxs.cameras: masks of 2 photographs$' logs/err
check "--invert-masks" with "$fixsplat" fit plain $steps -o inverse.fxs --masks inverse --invert-masks --quiet
for pair in 02.png.png:ffffff.png 03.png.png:000000.png; do
    succeeds "--invert-masks: for COLMAP they are the other way round" compare inverse.fxs.cameras/masks/${pair%:*} \
        ${pair#*:} --min-psnr 90
done
check "--invert-masks: the same scene" cmp masks.fxs inverse.fxs
check "new masks, the cameras of before" with "$fixsplat" fit plain $steps -o masks.fxs --masks inverse --quiet
check "new masks, the cameras of before: another scene" [ "$(cmp -s masks.fxs inverse.fxs; echo $?)" = 1 ]
rm calls

cp set/images/03.png plain/other.png
with "$fixsplat" fit plain $steps -o b.fxs >logs/out 2>logs/err
check "a photograph without a place is named, once" equal "$(grep other.png logs/err)" \
    "fixsplat: no place was found for 1: other.png"
cp -r plain half
for i in 20 21 22 23 24 25 26 27; do cp set/images/03.png half/$i.png; done
with "$fixsplat" fit half --steps 9 -o half.fxs >logs/out 2>logs/err
check "many photographs without a place: said at the end" grep -qx \
    'No place was found for 9 of 21 photographs: take more, a step apart, that join them to the others.' logs/out
check "the next fit is one of the photographs, not of the cameras" grep -qx \
    'again, and better:            fixsplat fit half -o half.fxs --quality good' logs/out
with "$fixsplat" fit half --steps 9 -o half.fxs --json >logs/out 2>logs/err
check "many photographs without a place: --json" grep -q '"advice": \["places", ' logs/out
with "$fixsplat" fit plain --steps 9 -o b.fxs --quality good >logs/out 2>logs/err
check "one photograph without a place: not said at the end" equal "$(grep -c '^Broken' logs/out) $(
    grep -c '^No place' logs/out)" "1 0"
check "--quality good: says how cameras are found" grep -q '^fixsplat: --quality good: 9 steps of the recipe fast, .* Gaussians, a thorough search for the cameras$' \
    logs/err
PATH="$work/bin:$PATH"
fails "cameras of other photographs" 1 "^fixsplat: a.fxs.cameras: the cameras of other photographs: remove it" \
    fit plain $steps -o a.fxs --quiet
rm plain/other.png

# ---- Which pairs are matched, and other versions of COLMAP -----------------------------------------------------------

# copies COUNT FORMAT [STEP]: a folder `copies` of photographs with these names
copies() {
    rm -rf copies pairs calls copies.fxs.cameras && mkdir copies
    for i in $(seq 0 $(($1 - 1))); do ln plain/00.png "copies/$(printf "$2" $((i * ${3:-1})))"; done
}
finds() { "$fixsplat" fit copies -o copies.fxs --cameras-only "$@" >logs/out 2>logs/err; }
matchers() { grep -o '^[a-z]*_matcher\|^matches_importer' calls | uniq | tr '\n' ' '; }
copies 30 frame-%03d.png 5
finds --threads 4
seq 0 29 | awk '{ n[NR] = sprintf("frame-%03d.png", 5 * $1) } END {
    for (i = 1; i <= NR; i++) for (j = i + 1; j <= NR; j++)
        if (j - i <= 12 || (i % 8 == 1 && j % 8 == 1)) print n[i], n[j] }' >expected
check "frames of a film: near ones, and every eighth with each other" sh -c "grep -v part pairs | cmp - expected"
check "in parts of 32 pairs for each thread" equal "$(grep -c part pairs) $(wc -l <expected | tr -d ' ')" "3 285"
check "parts: with progress" grep -q '^fixsplat: matching pairs of photographs: 0 of 285$' logs/err
check "first octave" equal "$(grep -o 'first_octave [-0-9]*' calls)" "first_octave -1"
copies 61 %03d.png
mv copies/000.png copies/x.png
finds
check "photographs: all pairs" equal "$(matchers)" "exhaustive_matcher "
rm -r calls copies.fxs.cameras
finds --quality draft
check "61 photographs, draft: near ones" equal "$(matchers)" "matches_importer "
check "draft: said" grep -qx 'fixsplat: --quality draft: a quick search for the cameras' logs/err
check "draft: first octave" equal "$(grep -o 'first_octave [-0-9]*' calls)" "first_octave 0"
mv copies/x.png "copies/x y.png"
rm -r calls copies.fxs.cameras
finds --quality draft
check "a name with a blank: near ones too" equal "$(matchers)" "sequential_matcher "
for names in "%d.png" "%03d b.png"; do
    copies 25 "$names"
    finds
    check "no frames: $names" equal "$(matchers)" "exhaustive_matcher "
done
NEW=2
export NEW
copies 12 %03d.png
MATCHING='I20260808 20:28:58.123456  1234 pairing.cc:211] Processing block [2/2, 1/2]' finds
check "COLMAP 4: options" equal "$(grep -o '[A-Za-z]*\.\(use_gpu\|num_threads\|max_image_size\) ' calls | tr -d '\n')" \
    "FeatureExtraction.use_gpu FeatureExtraction.max_image_size FeatureExtraction.num_threads \
FeatureMatching.use_gpu FeatureMatching.num_threads Mapper.num_threads "
check "COLMAP 4: progress on stderr" grep -q '^fixsplat: matching pairs of photographs: 33 of 66, ' logs/err
check "COLMAP 4: in the log too" grep -q 'pairing.cc:211' copies.fxs.cameras/log.txt
NEW=

# ---- Several sizes, and HEIF -----------------------------------------------------------------------------------------

bytes() {
    for byte in $(sed -n "/ $2/,/}/ { /uint8/ !p }" "$root/tests/$1" | tr -dc '0-9 \n'); do
        printf "\\$(printf %o "$byte")"
    done
}
cp -r plain sizes && bytes jpeg_bytes.h baseline_jpeg >sizes/b.jpg && cp sizes/b.jpg sizes/0.JPG
rm calls lists
check "photographs of several sizes" "$fixsplat" fit sizes $steps -o sizes.fxs
check "each size is a camera" equal "$(cat lists)" "0.JPG b.jpg
$(cd plain && echo *)"
check "the list has all of them" equal "$(grep -c . sizes.fxs.cameras/photographs.txt)" 14

cp -r sizes mixed && bytes heif_bytes.h turned_heif >mixed/IMG_1.HEIC
"$fixsplat" fit mixed -o mixed.fxs --cameras-only >logs/out 2>logs/err
if grep -q 'needs libheif' logs/err; then
    skip "HEIF" "$(cat logs/err)"
else
    check "a .heic is a camera of its own" grep -q '^fixsplat: mixed: photographs of 3 sizes and lenses' logs/err
    check "COLMAP gets it as a .jpg" grep -qx IMG_1.HEIC.jpg lists
    images=mixed.fxs.cameras/images
    check "beside links to the others" [ -f $images/IMG_1.HEIC.jpg -a -L $images/00.png -a -L $images/b.jpg ]
    check "with its focal length" grep -aq 'Maker' $images/IMG_1.HEIC.jpg
    "$fixsplat" compare mixed/IMG_1.HEIC $images/IMG_1.HEIC.jpg --min-psnr 40 >logs/out
    check "and its pixels" [ $? = 0 ]
    made=$(ls -i $images/IMG_1.HEIC.jpg)
    check "again: --cameras-only" "$fixsplat" fit mixed -o mixed.fxs --cameras-only --quiet
    check "it is made once" equal "$(ls -i $images/IMG_1.HEIC.jpg)" "$made"
    cp -r mixed broken && head -c 900 mixed/IMG_1.HEIC >broken/IMG_2.HEIC
    fails "a damaged .heic" 1 "broken/IMG_2.HEIC: .*--skip-bad leaves such photographs out" \
        fit broken -o broken.fxs --cameras-only --quiet
    check "nothing half is left of it" [ ! -e broken.fxs.cameras/images/IMG_2.HEIC.jpg ]
    "$fixsplat" fit broken -o broken.fxs --cameras-only --skip-bad >logs/out 2>logs/err
    check "--skip-bad leaves it out" equal "$(grep -c 'left out: .*IMG_2.HEIC' logs/err) $(
        grep -c HEIC broken.fxs.cameras/photographs.txt)" "1 1"
    mkdir none && : >none/libheif.so.1
    (LD_LIBRARY_PATH=$PWD/none exec "$fixsplat" fit mixed -o none.fxs --cameras-only --quiet) 2>logs/err
    check "without libheif a line" equal "$? $(wc -l <logs/err) $(grep -c 'IMG_1.HEIC: a .heic, which needs libheif' logs/err)" \
        "1 1 1"
fi

# ---- Errors ----------------------------------------------------------------------------------------------------------

export KILLED FAILS NOTHING FRAMES DAMAGED WAITS MATCHING POINTS ERROR LAST CUT ENDS
KILLED=exhaustive_matcher
fails "COLMAP killed" 1 "colmap: ended by signal 9 while matching pairs of photographs; the same command goes on" \
    fit plain $steps -o c.fxs --quiet
KILLED=
for model in 0 1 2; do
    mkdir -p c.fxs.cameras/models/$model && cp c.fxs.cameras/of c.fxs.cameras/models/$model/images.bin
done
check "and gone on" "$fixsplat" fit plain $steps -o c.fxs --quiet
check "it is the same scene, not of a mapper that was stopped" cmp c.fxs set.fxs
FAILS=feature_extractor
fails "COLMAP fails" 1 "colmap: failed while looking for features of photographs: see d.fxs.cameras/log.txt" \
    fit plain $steps -o d.fxs --quiet
check "its words are in the log" grep -q '^ERROR: played$' d.fxs.cameras/log.txt
FAILS=
NOTHING=1
fails "nothing in common" 1 "plain: no two photographs .* overlap" fit plain $steps -o e.fxs --quiet
NOTHING=

for line in "Matching block [0/0, 0/0]" "Matching block [0/2, 0/2]" "Matching block [3/2, 1/2]" "Matching image [0/0]" \
    "Matching block [99999999999999999999/2, 1/99999999999999999999]" "Matching block [-1/2, 1/2]"; do
    MATCHING=$line
    run fit plain -o counts.fxs --cameras-only
    check "$line" equal "$status $(sed -n 's/^fixsplat: matching pairs.*: //p' logs/err)" "0 $(
        [ "$line" != "Matching image [0/0]" ] || echo 0)"
    rm -r counts.fxs.cameras
done
MATCHING="Matching image [7/2]"
run fit plain -o counts.fxs --cameras-only
check "$MATCHING: not above the whole" grep -q ': 2 of 2, some 0 s left$' logs/err
MATCHING=
for said in "-1 0.511px" "99999999999999999999 0.511px" "400 nan" "400 -1px" "400 1e99px"; do
    POINTS=${said% *} ERROR=${said#* }
    run fit plain -o counts.fxs --cameras-only
    check "Points and error: $said" equal "$status $(cat logs/err)" "0 fixsplat: plain: cameras of 12 of 12 photographs$(
        [ "$POINTS" != 400 ] || echo ", 400 points, reprojection error 0.00 pixels")"
done
POINTS= ERROR=

for file in images.bin cameras.bin points3D.bin; do
    CUT=$file
    [ $file != cameras.bin ] || CUT="images.bin points3D.bin"
    fails "a mapper that wrote a part of $CUT" 1 "cut short.*: the cameras were not written whole.*; the same command goes on" \
        fit plain -o full.fxs --cameras-only --quiet
    check "nothing is left of it" [ ! -e full.fxs.cameras/sparse -a ! -e full.fxs.cameras/models ]
done
CUT= ENDS=1
fails "a mapper that wrote a model and failed" 1 "colmap: failed while placing photographs" fit plain -o full.fxs \
    --cameras-only --quiet
ENDS=
check "and gone on" "$fixsplat" fit plain -o full.fxs --cameras-only --quiet

cp -r plain "odd" && mv odd/00.png "odd/ 00.png"
fails "a name that begins with a blank" 1 "odd-.*/images/ 00.png: COLMAP takes no name that begins with a blank" \
    fit odd -o odd-1.fxs --quiet
mv "odd/ 00.png" "odd/0
0.png"
fails "a name with a line break" 1 "odd-.*/images/0.0.png: COLMAP takes no name" fit odd -o odd-2.fxs --quiet
run fit odd -o odd-2.fxs --cameras-only --skip-bad
check "--skip-bad leaves it out" equal "$status $(grep -c 'left out: .*0?0.png' logs/err) $(
    grep -c . odd-2.fxs.cameras/photographs.txt)" "0 1 11"
rm calls
check "OUT begins with -" "$fixsplat" fit plain --cameras-only --quiet --output=-x.fxs
check "it is no option for COLMAP" equal "$(grep -c ' -x' calls)" 0

# ---- Interruptions and second runs -----------------------------------------------------------------------------------

over() {
    for pid; do
        for try in $(seq 50); do
            state=$(sed 's/.*) \(.\).*/\1/' "/proc/$pid/stat" 2>/dev/null)
            case $state in '' | Z) break ;; esac
            sleep 0.1
        done
        case $state in '' | Z) ;; *) echo "$pid still runs"; return 1 ;; esac
    done
}
WAITS=exhaustive_matcher
for signal in 15 2 9 1; do
    rm -f waiting
    ended=$($helper signal $signal "$fixsplat" fit plain -o waits.fxs --cameras-only --quiet 2>logs/err)
    rm -f .fixsplat-waiting.tmp
    check "signal $signal while COLMAP runs" equal "$ended $(cat logs/err)" "signal $signal "
    check "signal $signal: COLMAP ends, and what it started" over $(cat waiting)
done
"$fixsplat" fit plain -o waits.fxs --cameras-only --quiet 2>logs/first &
first=$!
until [ -e .fixsplat-waiting.tmp ]; do sleep 0.1; done
fails "a second fit" 1 "^fixsplat: waits.fxs.cameras: another fit is at work there: wait for its end, or give another -o$" \
    fit plain -o waits.fxs --cameras-only --quiet
state=$(sed 's/.*) \(.\).*/\1/' /proc/$first/stat)
kill -s TSTP $first
stopped() { for pid; do [ "$(sed 's/.*) \(.\).*/\1/' "/proc/$pid/stat")" = T ] || return 1; done; }
for try in $(seq 50); do stopped $first $(cat waiting) && break; sleep 0.1; done
check "Ctrl-Z stops both" stopped $first $(cat waiting)
kill -s CONT $first
for try in $(seq 50); do stopped $first || stopped $(cat waiting) || break; sleep 0.1; done
check "they go on" equal "$(stopped $(cat waiting) && echo stopped)" ""
kill -s KILL $first
wait $first 2>/dev/null
rm -f .fixsplat-waiting.tmp
WAITS=
over $(cat waiting)
check "after a kill: the same command goes on" "$fixsplat" fit plain -o waits.fxs --cameras-only --quiet

# ---- Errors of single photographs ------------------------------------------------------------------------------------

mkdir one && cp plain/00.png one
fails "one photograph" 1 "one: 1 photograph: at least 3" fit one -o f.fxs --quiet
cp -r plain bad && head -c 100 plain/05.png >bad/05.png
fails "a damaged photograph" 1 "05.png: .*--skip-bad leaves such photographs out" fit bad -o g.fxs --quiet
"$fixsplat" fit bad -o h.fxs --skip-bad --cameras-only 2>logs/err
check "--skip-bad" equal "$(grep -c 'left out: .*05.png' logs/err) $(grep -c 05.png h.fxs.cameras/photographs.txt)" "1 0"
cp -r plain unlike && mkdir unlike/masks && cp ffffff.png unlike/masks/02.png
"$fixsplat" render knot.ply --size 9x9 -o unlike/masks/05.png
fails "a mask of another size" 1 "^fixsplat: unlike/masks/05.png: 9 x 9 pixels, its photograph .*/05.png has 64 x 48 .--skip" \
    fit unlike $steps -o unlike.fxs --quiet
fails "no such folder of masks" 1 "^fixsplat: nowhere: no such folder of masks$" fit plain -o unlike.fxs --masks nowhere
fails "--frames without a film" 2 "^fixsplat: --frames: set is not a film" fit set -o i.fxs --frames 10
fails "--cameras-only with cameras" 2 "^fixsplat: --cameras-only: set has cameras" fit set -o i.fxs --cameras-only
mkdir empty
fails "--frames of photographs" 2 "^fixsplat: --frames: plain is not a film" fit plain -o i.fxs --frames 10
fails "an empty folder" 1 "^fixsplat: empty: no photographs here, nor in a folder images here$" fit empty -o i.fxs
check "an empty folder: nothing is made" [ ! -e i.fxs.cameras ]
missing='1 fixsplat: plain: finding the cameras needs colmap, which is not installed'
(PATH=$work/empty exec "$fixsplat" fit plain -o i.fxs --quiet) 2>logs/err
check "COLMAP missing" equal "$? $(cat logs/err)" "$missing: install it, in a folder of PATH"
mkdir apt_here && printf '#!/bin/sh\n' >apt_here/apt && chmod +x apt_here/apt
(PATH=$work/apt_here exec "$fixsplat" fit plain -o i.fxs --quiet) 2>logs/err
check "COLMAP missing, but apt" equal "$? $(cat logs/err)" "$missing: apt install colmap"

# ---- Films -----------------------------------------------------------------------------------------------------------

FRAMES=84
: >film.mp4
rm calls
check "a film" "$fixsplat" fit film.mp4 --frames 12 --cameras-only -o film.fxs --quiet
fails "another number of frames" 1 "^fixsplat: film.fxs.cameras: made without --frames 13" \
    fit film.mp4 --frames 13 --cameras-only -o film.fxs --quiet
check "the same number" "$fixsplat" fit film.mp4 --frames 12 --cameras-only -o film.fxs --quiet
check "without a number" "$fixsplat" fit film.mp4 --cameras-only -o film.fxs --quiet
check "frames are taken once" equal "$(grep -c rawvideo calls)" 1
check "of each stretch the sharpest frame" grep -qF "select='eq(n,3)+eq(n,10)+eq(n,17)+eq(n,24)+" calls
rm -rf film.fxs.cameras calls
check "a film, as many frames as seem right" "$fixsplat" fit film.mp4 -o film.fxs --cameras-only --quiet
check "60 of few" equal "$(grep -o 'eq(n' calls | wc -l | tr -d ' ')" 60

full() {
    rm -rf full.fxs.cameras
    fails "$1" 1 "$2.*: ffmpeg did not write all frames whole, .*: see full.fxs.cameras/log.txt; the same command goes on" \
        fit film.mp4 --frames 12 -o full.fxs --cameras-only --quiet --skip-bad
    check "$1: no frames" equal "$(ls full.fxs.cameras | tr '\n' ' ')" "lock log.txt of "
    LAST= CUT= ENDS=
    check "$1: the same command goes on" "$fixsplat" fit film.mp4 --frames 12 -o full.fxs --cameras-only --quiet
    check "$1: with all frames" equal "$(ls full.fxs.cameras/images | wc -l | tr -d ' ')" 12
}
LAST=8 ENDS=1 full "a full disk, 7 of 12 frames" film.mp4
CUT=5 full "a full disk, a frame cut short, exit status 0" frame-00005.jpg
CUT=12 ENDS=228 full "a full disk, the last frame cut short" film.mp4
DAMAGED=1
LAST=8 ENDS=69 full "a full disk and a damaged film" frame-00008.jpg
DAMAGED=
mkdir "100%d:x"
: >"100%d:x/a%d:b.mp4"
rm calls
check "names with colons and %" "$fixsplat" fit "100%d:x/a%d:b.mp4" --frames 12 --cameras-only -o "100%d:x/o.fxs" --quiet
check "names with colons and %: frames" [ -e "100%d:x/o.fxs.cameras/images/frame-00012.jpg" ]
check "ffmpeg is told that the film is a file" equal "$(grep -c -- '-i file:100%d:x/a%d:b.mp4 ' calls)" 2
check "frames have one number for the look and for the selection" equal "$(grep -c -- '-fps_mode passthrough' calls)" 2

DAMAGED=1
"$fixsplat" fit film.mp4 -o damaged.fxs --cameras-only >logs/out 2>logs/err
check "a damaged film" grep -q '^fixsplat: film.mp4: damaged: its first 84 frames are used$' logs/err
FRAMES=0
fails "no film" 1 "film.mp4: ffmpeg finds no picture in it: see j.fxs.cameras/log.txt" fit film.mp4 -o j.fxs --quiet
DAMAGED=
FRAMES=1
fails "a film of one frame" 1 "film.mp4: a film of 1 frame: at least 3" fit film.mp4 -o k.fxs --quiet

# ---- The real ffmpeg and COLMAP --------------------------------------------------------------------------------------

rm -r bin
if have ffmpeg; then
    "$fixsplat" render knot.ply --size 128x96 --orbit 30 -o - --quiet |
        ffmpeg -v error -y -i - -pix_fmt yuv420p file:a:b%d.mp4
    PATH=$work/empty:$(dirname "$(command -v ffmpeg)")
    mkdir -p "x%05d:y"
    (PATH=$PATH:/nowhere exec "$fixsplat" fit "a:b%d.mp4" --frames 5 --cameras-only -o "x%05d:y/-z.fxs" --quiet) 2>logs/err
    check "frames by ffmpeg itself" equal "$(ls "x%05d:y/-z.fxs.cameras/images" | tr '\n' ' ')" \
        "frame-00001.jpg frame-00002.jpg frame-00003.jpg frame-00004.jpg frame-00005.jpg "
else
    skip "frames by ffmpeg itself" "no ffmpeg here"
fi
if [ "$FXS_PROCESSORS" != all ]; then
    skip "a film of snowmiku" "only with FXS_PROCESSORS=all"
elif ! have ffmpeg || ! have colmap || [ ! -d "$scenes/snowmiku" ]; then
    skip "a film of snowmiku" "not here: ffmpeg, colmap or the shared scenes"
else
    "$fixsplat" render "$scenes/snowmiku/snowmiku.ply" --cameras "$scenes/snowmiku/cameras.json" --view 0..24 \
        --frames 120 --size 800x600 -o - --quiet | ffmpeg -v error -i - -pix_fmt yuv420p snowmiku.mp4
    "$fixsplat" fit snowmiku.mp4 --frames 24 --cameras-only -o snowmiku.fxs 2>logs/err
    check "a film of snowmiku: 24 places within 1.5 pixels" \
        grep -Eq 'cameras of 24 of 24 photographs, [0-9]{4,} points, reprojection error (0|1\.[0-4])' logs/err
fi
photos=$scenes/../photos
if [ "$FXS_PROCESSORS" != all ]; then
    skip "photographs of two sizes" "only with FXS_PROCESSORS=all"
elif ! have ffmpeg || ! have colmap || [ ! -d "$photos/banana" ]; then
    skip "photographs of two sizes" "not here: ffmpeg, colmap or the shared photographs"
else
    mkdir two
    n=0
    for photo in "$photos"/banana/*.JPG; do
        n=$((n + 1))
        ffmpeg -v error -y -i "$photo" -vf scale=$((n % 2 ? 1000 : 800)):-2 -q:v 2 small.jpg
        perl -e 'local $/; open A, "<:raw", $ARGV[0]; $a = <A>; open B, "<:raw", $ARGV[1]; $b = <B>;
            $i = index $a, "\xff\xe1"; $n = 2 + unpack "n", substr $a, $i + 2, 2;     # EXIF data, which ffmpeg omits
            print substr($b, 0, 2), substr($a, $i, $n), substr($b, 2)' "$photo" small.jpg >"two/$(basename "$photo")"
    done
    "$fixsplat" fit two --steps 20 --resolution 200 -o two.fxs >logs/out 2>logs/err
    check "photographs of two sizes: places, and a scene" \
        sh -c "[ -s two.fxs ] && grep -Eq 'cameras of 1[0-6] of 16 photographs, [0-9]{4,} points' logs/err"
fi
finish
