#!/bin/sh
# Tests `fixsplat convert`: placing, filtering and merging scenes, and every written format.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/json.sh"
case ${NODE_MODULES:-${B:-build}/page/node_modules} in
/*) modules=${NODE_MODULES:-$B/page/node_modules} ;;
*) modules=$root/${NODE_MODULES:-${B:-build}/page/node_modules} ;;
esac
endings='ply compressed.ply splat spz rad sog glb csv fxs'
read_back='ply compressed.ply spz rad sog glb'

# ---- Test scenes -----------------------------------------------------------------------------------------------------

names='x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3'

# ply FILE COMMENT LINE...: writes a .ply file with a Gaussian per LINE: x y z, three f_dc (colour), logit of the
# opacity, three ln(sigma), quaternion.
ply() {
    file=$1 comment=$2
    shift 2
    { printf 'ply\nformat ascii 1.0\ncomment %s\nelement vertex %s\n' "$comment" $#
      printf 'property float %s\n' $names
      printf '%s\n' end_header "$@"; } >"$file"
}

"$fixsplat" make-scene knot --count 3000 -o knot.ply || exit 1
ply row.ply 'one Gaussian' '1 2 3 0 0 0 0 -1 -2 -3 1 0 0 0'
ply rows.ply 'along x' '0 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' '1 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' \
    '2 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' '3 0 0 1 0 0 1 -1 -1 -1 1 0 0 0' '4 0 0 1 0 0 1 -1 -1 -1 1 0 0 0'

placed() {
    wanted=$1
    shift
    "$fixsplat" convert row.ply row.csv "$@" || return 1
    equal "$(awk -F, 'NR == 2 { printf "%.4f %.4f %.4f", $1 + 0, $2 + 0, $3 + 0 }' row.csv | sed 's/-0\.0000/0.0000/g')" \
        "$wanted"
}

# ---- Placing ---------------------------------------------------------------------------------------------------------

check "--translate" placed "11.0000 22.0000 33.0000" --translate 10,20,30
check "--scale" placed "2.0000 4.0000 6.0000" --scale 2
check "--scale: ln(sigma)" equal "$(awk -F, 'NR == 2 { printf "%.4f", $8 }' row.csv)" -0.3069
check "--rotate about z" placed "-2.0000 1.0000 3.0000" --rotate 0,0,90
check "--rotate about x, then y" placed "2.0000 -3.0000 -1.0000" --rotate 90,90,0
check "--rotate: a whole turn" placed "1.0000 2.0000 3.0000" --rotate 0,360,-720
check "--up: z becomes up" placed "1.0000 -3.0000 2.0000" --up 0,0,1
check "--up: y, which was down" placed "1.0000 -2.0000 -3.0000" --up 0,7,0
check "--up: what is up already" placed "1.0000 2.0000 3.0000" --up 0,-1e-9,0
check "up, rotate, scale, translate, in this order" placed "16.0000 22.0000 34.0000" \
    --translate 10,20,30 --scale 2 --rotate 0,0,90 --up 0,0,1
for bad in 'translate 1,2' 'translate x' 'rotate 1,2,nan' 'rotate 90' 'scale 0' 'scale -1' 'scale 1e9' 'scale x' \
    'translate 1e9,0,0' 'up 0,0,0' 'up 1,2' 'sphere 0,0,0' 'sphere 0,0,0,-1' 'decimate 0' 'decimate 0%' \
    'decimate 101%' 'decimate -5' 'decimate x' 'decimate %' 'decimate 5%%'; do
    fails "--$bad" 2 "--${bad%% *}" convert row.ply x.ply --$bad
    check "--$bad: nothing is written" [ ! -e x.ply ]
done

"$fixsplat" convert knot.ply turned.ply --rotate 0,90,0 --scale 0.5 --translate 1,0,0
view='--size 160x120 --eye 3,-2,-6 --look 1,0,0'
"$fixsplat" render knot.ply --place knot.ply:1,0,0,0.70710678118654752,0,0.70710678118654752,0,0.5 $view -o placed.png
"$fixsplat" render turned.ply $view -o turned.png
"$fixsplat" convert knot.ply flat.ply --sh-degree 0
"$fixsplat" convert flat.ply flat-turned.ply --rotate 0,90,0 --scale 0.5 --translate 1,0,0
"$fixsplat" render flat-turned.ply $view -o flat.png
psnr() { "$fixsplat" compare "$1" "$2" | sed -n 's/.*PSNR \([0-9.]*\).*/\1/p'; }
check "SH turn with the scene" at_least "$(psnr turned.png placed.png)" 50
check "SH matter in this view" sh -c "! awk 'BEGIN { exit !($(psnr flat.png placed.png) >= 45) }'"

# ---- Several files ---------------------------------------------------------------------------------------------------

ply smooth.ply 'antialiased 1' '0 0 0 1 0 0 1 -1 -1 -1 1 0 0 0'
succeeds "degrees 0 and 3" convert rows.ply knot.ply both.ply
check "degrees 0 and 3: the higher" gaussians both.ply 3005 3
"$fixsplat" convert both.ply both.csv
check "degrees 0 and 3: the lower has 0 there" equal \
    "$(awk -F, 'NR > 1 && NR < 7 { for (k = 7; k < 52; k++) if ($k != 0) n++ } END { print n + 0 }' both.csv)" 0
for ending in ply sog fxs; do
    fails "one of two is anti-aliased, to .$ending" 1 "one is anti-aliased and one is not" \
        convert rows.ply smooth.ply x.$ending
done
succeeds "two that are anti-aliased" convert smooth.ply smooth.ply two.ply --place 0:1,0,0 --place 0:2,0,0
check "two that are anti-aliased: still" grep -aq 'comment antialiased 1' two.ply
check "and the third line has the count, where Inria's viewer reads it" sh -c 'sed -n 3p two.ply | grep -aq "^element vertex "'
succeeds "several, placed as one" convert rows.ply row.ply moved.csv --translate 0,0,5
check "several, placed as one: all of them" equal "$(awk -F, 'NR > 1 { print $3 }' moved.csv | tr '\n' ' ')" "5 5 5 5 5 8 "

# ---- The up direction ------------------------------------------------------------------------------------------------

"$fixsplat" convert knot.ply beside.ply --translate 20,0,0
"$fixsplat" convert beside.ply stands.ply --up 1,0,0
for points in 0,0,0,0,1,0,0,0,1 0,0,5,0,0,1,0,7,0; do
    "$fixsplat" convert beside.ply level.ply --level $points
    check "--level $points: as --up 1,0,0" cmp level.ply stands.ply
done
"$fixsplat" convert beside.ply stands.ply --up -1,0,0
"$fixsplat" convert beside.ply level.ply --level 40,0,0,40,1,0,40,0,1
check "--level: up is where the Gaussians are" cmp level.ply stands.ply
ply pair.ply 'as many on both sides' '0 1 0 1 0 0 1 -1 -1 -1 1 0 0 0' '0 -1 0 1 0 0 1 -1 -1 -1 1 0 0 0'
"$fixsplat" convert pair.ply same.ply
for points in 0,0,0,1,0,0,0,0,1 0,0,0,0,0,1,1,0,0; do
    "$fixsplat" convert pair.ply level.ply --level $points
    check "--level $points: as many on both sides stay as they are" cmp level.ply same.ply
done
for bad in 0,0,0,1,1,1 0,0,0,1,1,1,2,2,2 0,0,0,0,0,0,1,0,0 0,0,0,1e200,0,0,0,1e200,0 x; do
    fails "--level $bad" 2 "--level $bad: expected three points" convert knot.ply x.ply --level $bad
done
fails "--level and --up" 2 "give one" convert knot.ply x.ply --level 0,0,0,1,0,0,0,0,1 --up 0,0,1

# ---- Start view ------------------------------------------------------------------------------------------------------

hash_of() { "$fixsplat" render "$@" --size 64x48 --hash; }
succeeds "--start-view" convert knot.ply start.fxs --start-view 1,-2,-6,0,0,0,40
check "--start-view: where nothing else is asked for" equal "$(hash_of start.fxs)" \
    "$(hash_of knot.ply --eye 1,-2,-6 --look 0,0,0 --fov 40)"
"$fixsplat" convert knot.ply plain.fxs
for options in '--fov 50' '--up 0,-1,0' '--eye 3,0,-5' '--place start.fxs:1,0,0'; do
    check "--start-view: not with $options" equal "$(hash_of start.fxs $options)" \
        "$(hash_of plain.fxs $(echo "$options" | sed s/start/plain/))"
done
mkdir side
echo "1 PINHOLE 64 48 60 60 32 24" >side/cameras.txt
printf "1 0.7071067811865476 0 0 0.7071067811865476 0 0 13 1 a.png\n\n" >side/images.txt
"$fixsplat" convert knot.ply side.fxs --start-view side:0
check "--start-view: of a scene that lies on its side, turned about what is up there" equal \
    "$(hash_of side.fxs --orbit 3 --near 0.2)" "$(hash_of side.fxs --orbit 3 --near 0.2 --cameras side --up -1,0,0)"
start_of() { "$fixsplat" info "$1" | grep -e '^up ' -e '^start view '; }
succeeds "--up is kept" convert knot.ply leant.fxs --up 0.2,-0.5,0.1 --rotate 0,0,30 --start-view 3,-2,-5,0,0,0,40
check "--up is kept: turned" equal "$(start_of leant.fxs)" "up            0.5000 -0.8660 0.0000
start view    from 3 -2 -5, 40.0 degrees"
"$fixsplat" convert knot.ply level.ply --up 0.2,-0.5,0.1 --rotate 0,0,30
"$fixsplat" convert level.ply level.fxs
alike() {
    for n in 1 2; do
        what=$([ $n = 1 ] && echo leant.fxs $2 || echo level.fxs $3)
        "$fixsplat" render $what --size 96x64 -o $n-%d.png --quiet || return
    done
    for i in 1-*.png; do check "$1" "$fixsplat" compare $i 2-${i#1-} --min-psnr 45; done
    rm ?-?.png
}
seen='--eye 3,-2,-5 --look 0,0,0 --fov 40 --up 0.5,-0.8660254,0'
alike "--start-view is level by it, and --orbit turns about it" '--orbit 3' "--orbit 3 $seen"
alike "it is up where none is given" '--eye 4,1,2 --orbit 2' '--eye 4,1,2 --up 0.5,-0.8660254,0 --orbit 2'
"$fixsplat" convert leant.fxs again.fxs
check "an .fxs keeps both" equal "$(start_of again.fxs)" "$(start_of leant.fxs)"
"$fixsplat" convert leant.fxs turned.fxs --rotate 20,-50,70 --scale 2 --translate 1,2,3
"$fixsplat" render leant.fxs --size 160x120 -o leant.png --quiet
"$fixsplat" render turned.fxs --size 160x120 -o turned.png --quiet
check "turned with the scene" "$fixsplat" compare turned.png leant.png --min-psnr 45
"$fixsplat" convert leant.fxs cropped.fxs --crop -9,-9,-9,0,9,9
check "a crop keeps the up direction and has a view of its own" equal "$(start_of cropped.fxs | head -n 1)
$(start_of cropped.fxs | grep -c '^start')" "$(start_of leant.fxs | head -n 1)
1"
check "the one that is chosen for what is left" equal \
    "$("$fixsplat" render cropped.fxs --size 64x36 --hash)" "$("$fixsplat" render cropped.fxs --auto-up --size 64x36 --hash)"
check "not the old one" test "$(start_of cropped.fxs)" != "$(start_of leant.fxs)"
"$fixsplat" convert leant.fxs kept.fxs --crop -99,-99,-99,99,99,99
check "a crop of nothing keeps both" equal "$(start_of kept.fxs)" "$(start_of leant.fxs)"
"$fixsplat" convert level.fxs leant.fxs start.fxs both.fxs
check "of several the first that has them gives them" equal "$(start_of both.fxs)" "$(start_of leant.fxs)"
"$fixsplat" convert start.fxs both.fxs --up 0,-2,0
check "--up of what is upright" equal "$(start_of both.fxs)" "up            0.0000 -1.0000 0.0000
$(start_of start.fxs)"
for i in 1 2; do "$fixsplat" convert leant.fxs part$i.fxs --rotate 0,0,9 --block $i/2; done
"$fixsplat" convert part1.fxs part2.fxs parts.fxs
"$fixsplat" convert leant.fxs whole.fxs --rotate 0,0,9
check "--block: as at once" cmp parts.fxs whole.fxs
"$fixsplat" info leant.fxs --json >logs/out
check "info --json" grep -q \
    '"up": \[0.5[0-9]*, -0.866[0-9]*, [-0-9.e]*\], "start_view": {"eye": \[3, -2, -5\], "fov": 40}' logs/out
for bad in 1,2 1,2,3,1,2,3 1,2,3,4,5,6,0.5 none.json; do
    rm -f x.fxs
    fails "--start-view $bad" 2 "start-view.*" convert knot.ply x.fxs --start-view $bad
    check "--start-view $bad: nothing is written" test ! -e x.fxs
done
"$fixsplat" make-scene site --count 5000 -o site.ply && "$fixsplat" convert site.ply lying.ply --rotate -90,0,0
"$fixsplat" convert lying.ply stood.fxs --auto-up 2>logs/err
check "--auto-up: turns what is up to -y" equal "$(start_of stood.fxs)" "up            0.0000 -1.0000 0.0000"
check "--auto-up: says it" grep -q '^fixsplat: lying.ply: up is [-0-9.]*,[-0-9.]*,-\?[01]\.[0-9]*$' logs/err
check "info prints the up direction that it finds" grep -q '^up .*, found in the scene$' <<EOF
$("$fixsplat" info site.ply)
EOF
fails "--auto-up and --up" 2 "give one" convert lying.ply x.ply --auto-up --up 0,0,1
succeeds "--levels" convert knot.ply levels.fxs --levels
succeeds "--levels: every checksum" info levels.fxs
succeeds "--levels: read again" convert levels.fxs leaves.fxs
succeeds "--levels: without" convert plain.fxs again.fxs
check "--levels: the leaves are those of the file without" cmp leaves.fxs again.fxs
fails "--levels of a .ply" 2 "--levels is for .fxs" convert knot.ply x.ply --levels
run convert knot.ply board.fxs --for board --decimate 1000
check "--for board: says what it chose" grep -q '^fixsplat: --for board: --profile small --sh-degree 1$' logs/err
"$fixsplat" convert knot.ply hand.fxs --profile small --sh-degree 1 --decimate 1000 2>logs/err
check "--for board: as by hand" cmp board.fxs hand.fxs
run convert knot.ply web.fxs --for web --profile compact
check "--for web: an option that is given" grep -q -- '--for web: --profile compact --sh-degree 3 --levels$' logs/err
"$fixsplat" make-scene knot --count 12000 -o many.ply
fails "--for board: too large" 1 "--for board allows 450000" convert many.ply large.fxs --for board --profile default \
    --sh-degree 3 --quiet
check "--for board: too large: no file" [ ! -e large.fxs ]
fails "--for of a .ply" 2 "--for is for .fxs" convert knot.ply x.ply --for phone
fails "--for and --block" 2 "--for is for a whole scene" convert knot.ply x.fxs --for web --block 1/2
fails "--refine without --levels" 2 "--refine is for --levels" convert knot.ply x.fxs --refine
fails "--cameras without --refine" 2 "--cameras is for --refine" convert knot.ply x.fxs --levels --cameras knot.ply
for bad in =-1 =100001 =many =; do
    fails "--refine$bad" 2 "--refine.*: expected" convert knot.ply x.fxs --levels --refine$bad
done
fails "--refine by what has no cameras" 1 "--cameras: .*row.ply" convert knot.ply x.fxs --levels --refine=1 --cameras row.ply
succeeds "--refine" convert knot.ply refined.fxs --levels --refine=1
check "--refine: as large as without" equal "$(wc -c <refined.fxs)" "$(wc -c <levels.fxs)"
check "--refine: other bytes" test "$(cksum <refined.fxs)" != "$(cksum <levels.fxs)"
fails "--start-view of a .ply" 2 "--start-view is for .fxs" convert knot.ply x.ply --start-view 1,2,3,4,5,6

# ---- Filtering -------------------------------------------------------------------------------------------------------

kept() {
    file=$1 wanted=$2
    shift 2
    "$fixsplat" convert "$file" kept.csv "$@" 2>logs/err || return 1
    equal "$(awk -F, 'NR > 1 { print $1 }' kept.csv | tr '\n' ' ')" "$wanted "
}
check "--sphere, its surface too" kept rows.ply "1 2 3" --sphere 2,0,0,1
check "--sphere: said" grep -q 'kept 3 of 5 Gaussians (2 outside, 0 too faint, 0 floating)' logs/err
check "--sphere and --crop: both" kept rows.ply "1 2" --sphere 2,0,0,1 --crop 0,0,0,2,0,0
check "--sphere: after the scene was placed" kept rows.ply "11 12 13" --sphere 12,0,0,1 --translate 10,0,0
check "--sphere, again: either" kept rows.ply "0 3 4" --sphere 0,0,0,0.5 --sphere 4,0,0,1
check "--crop, again: either" kept rows.ply "0 2 3" --crop -1,0,0,0,0,0 --crop 2,0,0,3,0,0
check "--cylinder, its ends and its side too" kept rows.ply "1 2 3" --cylinder 1,1,0,3,1,0,1
check "--cylinder across" kept rows.ply "1 2 3" --cylinder 2,-1,0,2,5,0,1
check "--cylinder that ends before" kept rows.ply "4" --cylinder 2,-5,0,2,-1,0,9 --cylinder 4,0,0,9,0,0,0
check "--cylinder, --sphere and --crop: all" kept rows.ply "2" --cylinder 0,0,0,2,0,0,0 --sphere 2,0,0,1 \
    --crop 2,0,0,4,0,0
fails "--cylinder without a length" 2 "--cylinder 1,2,3,1,2,3,1: expected" convert rows.ply x.ply \
    --cylinder 1,2,3,1,2,3,1
fails "--cylinder of a negative radius" 2 "expected seven" convert rows.ply x.ply --cylinder 1,2,3,1,2,4,-1
fails "--sphere, too often" 2 "more than 256" convert rows.ply x.ply $(seq -f '--sphere %g,0,0,1' 257)
check "--sphere of radius 0" kept rows.ply "4" --sphere 4,0,0,0

"$fixsplat" convert knot.ply rows.ply stray.ply --place rows.ply:60,0,0
run convert stray.ply clean.ply --drop-floaters
check "--drop-floaters: the five that have four neighbours" says \
    "stray.ply: kept 3000 of 3005 Gaussians (0 outside, 0 too faint, 5 floating)"
"$fixsplat" convert stray.ply again.ply --drop-floaters=1 2>logs/err
check "--drop-floaters: the same again" cmp clean.ply again.ply
check "--drop-floaters: the others stay as they are" cmp clean.ply knot.ply

# A ball on a ground that is tilted: up is 0,-0.96,0.28.
awk 'BEGIN {
    for (i = 0; i < 3000; i++) {
        z = (2 * i + 1) / 3000 - 1
        r = sqrt(1 - z * z)
        put(r * cos(i * 2.4), z, r * sin(i * 2.4), "-3.2 -3.2 -3.2")
        put(i % 55 / 5 - 5, 1, int(i / 55) / 5 - 5, "-2 -5 -2")
    }
}
function put(x, y, z, scales) {
    print x, 0.96 * y + 0.28 * z, 0.96 * z - 0.28 * y, "0 0 0 3", scales, "0.98994949 -0.14142136 0 0"
}' >ball.txt
{ printf 'ply\nformat ascii 1.0\nelement vertex 6000\n'; printf 'property float %s\n' $names; echo end_header
  cat ball.txt; } >ball.ply
run convert ball.ply ball.fxs --thing
check "--thing: level" grep -q 'ball.ply: up is -*0.00[0-9]*,-0.9[56][0-9]*,0.2[78][0-9]*$' logs/err
check "--thing: says what it took" grep -q 'ball.ply: the thing has 2[89][0-9][0-9] of 6000 Gaussians, in the box ' logs/err
check "--thing: a start view, from outside" [ "$("$fixsplat" info ball.fxs | grep -c '^start')" = 1 ]
run convert ball.ply x.ply --thing --up 0,-1,0
check "--thing --up: not turned" [ "$(grep -c 'up is' logs/err)" = 0 ]
fails "--thing: none" 1 "rows.ply: no thing stands out" convert rows.ply none.ply --thing
check "--thing: none: no file" [ ! -e none.ply ]
fails "--thing and --block" 2 "--thing is for a whole scene" convert ball.ply x.fxs --thing --block 1/2
ply haze.ply 'as wide as it is far off' '60 0 0 1 0 0 1 3 3 3 1 0 0 0'
for strength in 1 2; do
    "$fixsplat" convert knot.ply haze.ply x.ply --drop-floaters=$strength 2>logs/err
    check "--drop-floaters=$strength: haze" equal "$(grep -c ' 1 floating' logs/err)" $((strength - 1))
done
check "--drop-floaters of a scene of many sizes: as many" equal \
    "$("$fixsplat" convert stray.ply x.csv --drop-floaters --scale 100 2>&1 | sed 's/.*kept/kept/')" \
    "kept 3000 of 3005 Gaussians (0 outside, 0 too faint, 5 floating)"

for count in 1 2 257 2999; do
    succeeds "--decimate $count" convert knot.ply few.ply --decimate $count
    check "--decimate $count: as many" gaussians few.ply $count 3
done
succeeds "--decimate 50%" convert knot.ply half.ply --decimate 50%
check "--decimate 50%: half" gaussians half.ply 1500 3
"$fixsplat" convert knot.ply again.ply --decimate 1500
check "--decimate: the same again" cmp half.ply again.ply
run convert knot.ply again.ply --decimate 3001
check "--decimate: more than there are: said" says "knot.ply: has 3000 Gaussians: --decimate merges none"
check "--decimate: more than there are: all stay" cmp knot.ply again.ply
succeeds "--decimate to .fxs" convert knot.ply half.fxs --decimate 50%
check "--decimate to .fxs: half" gaussians half.fxs 1500 3
check "--decimate: two become their mean" kept rows.ply "0.5 2 3 4" --decimate 4
ply pair.ply 'two, side by side' '0 0 0 1 0 0 -1 -1 -1 -1 1 0 0 0' '1 0 0 3 0 0 -1 -1 -1 -1 1 0 0 0'
"$fixsplat" convert pair.ply one.csv --decimate 1
# Two Gaussians with variance e^-2, 1 unit apart, merge to a Gaussian with variance e^-2 + 1/4 along x.
check "--decimate: mean, colour, covariance, opacity" equal "$(awk -F, 'NR == 2 {
        most = $8 > $9 ? $8 > $10 ? $8 : $10 : $9 > $10 ? $9 : $10
        printf "%.3f %.3f %.3f %.3f", $1, $4, exp(2 * most), 1 / (1 + exp(-$7)) }' one.csv)" "0.500 2.000 0.385 0.319"

for option in '--crop 90,0,0,91,1,1' '--sphere 90,0,0,1' '--prune 1 --sphere 90,0,0,1'; do
    for ending in $endings; do
        echo precious >left.$ending
        fails "$option to .$ending: nothing left" 1 "none of the 3000 Gaussians is left" \
            convert knot.ply left.$ending $option
        check "$option to .$ending: nothing is written" equal "$(cat left.$ending)" precious
    done
done
fails "--drop-floaters: nothing left" 1 "rows.ply: none of the 5 Gaussians is left" convert rows.ply x.ply --drop-floaters

# ---- Edits by hand ---------------------------------------------------------------------------------------------------

# edits ACT CHECKSUM: writes edits of knot.ply: a lasso of a camera before the knot, front only, and less a sphere.
edits() {
    echo "{\"format\": \"fixsplat edits\", \"version\": 1, \"scene\": {\"gaussians\": 3000, \"checksum\": \"$2\"},
        \"edits\": [{\"act\": \"$1\", \"select\": [{\"shape\": \"lasso\", \"front\": true, \"camera\": {\"width\": 320,
        \"height\": 180, \"fx\": 190, \"fy\": 190, \"cx\": 160, \"cy\": 90, \"rotation\": [1, 0, 0, 0, 1, 0, 0, 0, 1],
        \"position\": [0, 0, -9], \"near\": 0.2}, \"points\": [40, 10, 200, 20, 170, 150, 90, 170]},
        {\"shape\": \"sphere\", \"subtract\": true, \"numbers\": [-2, 0, 0, 1]}]}]}" >edits.json
}
edits delete 00000000
fails "--edits: of another scene" 1 'edits are for another scene, or for another packing of it: of 3000 Gaussians with the checksum 00000000' \
    convert knot.ply edited.csv --edits edits.json
checksum=$(sed 's/.*not of 3000 with //' logs/err)
edits delete "$checksum"
"$fixsplat" convert knot.ply knot.csv
"$fixsplat" convert knot.ply plain.fxs --quiet
run convert knot.ply edited.csv --edits edits.json
check "--edits: what is deleted is said" says "knot.ply: the edits delete 386 of 3000 Gaussians"
check "--edits: the others keep their floats" equal "$(grep -Fxf edited.csv knot.csv | cksum)" "$(cksum <edited.csv)"
"$fixsplat" convert plain.fxs packed.csv --edits edits.json --quiet
check "--edits of the .fxs: the same Gaussians" equal "$(wc -l <packed.csv)" "$(wc -l <edited.csv)"
"$fixsplat" convert knot.ply both.csv --edits edits.json --translate 1,0,0 --crop 1,-9,-9,9,9,9 --quiet
"$fixsplat" convert knot.ply edited.ply --edits edits.json --quiet
"$fixsplat" convert edited.ply after.csv --translate 1,0,0 --crop 1,-9,-9,9,9,9 --quiet
check "--edits, then placed and cropped" cmp both.csv after.csv
edits keep "$checksum"
run convert knot.ply edited.fxs --edits edits.json
check "--edits: keep" says "knot.ply: the edits delete 2614 of 3000 Gaussians"
check "--edits: into an .fxs" grep -q '"packed": 386,' <<END
$("$fixsplat" info edited.fxs --json)
END
echo '{"format": "fixsplat edits"' >bad.json
fails "--edits: a file that breaks off" 1 'bad.json' convert knot.ply new.ply --edits bad.json
discs=$(awk 'BEGIN { for (i = 0; i < 4100; i++) printf "%s0, 0, 1024", i ? ", " : "" }')
sed 's/"shape": "lasso"/"shape": "brush"/; s/"points": \[[^]]*\]/"points": ['"$discs"']/' edits.json >wide.json
fails "--edits: shapes of too many pixels" 1 'the shapes have more pixels than' convert knot.ply new.ply --edits wide.json
fails "--edits: a missing file" 1 'none.json' convert knot.ply new.ply --edits none.json
fails "--edits of two scenes" 2 '--edits is for one scene' convert knot.ply row.ply new.ply --edits edits.json
cp edits.json edits.ply
fails "--edits: OUT is the file of edits" 2 'edits.ply' convert knot.ply edits.ply --edits edits.ply
check "--edits: nothing is written" [ ! -e new.ply ]

# ---- Statistics ------------------------------------------------------------------------------------------------------

succeeds "info --stats" info rows.ply --stats
check "info --stats: x" equal "$(awk '$1 == "x" { print $2, $3, $4, $5 }' logs/out)" "0 2 2 4"
check "info --stats: a histogram" grep -Eq '^x .* \|@ +@ +@ +@ +@\|$' logs/out
check "info --stats: all attributes" equal "$(awk '/\|$/ { print $1 }' logs/out | tr '\n' ' ')" \
    "x y z scale_0 scale_1 scale_2 opacity red green blue "
succeeds "info --stats of SH" info knot.ply --stats
check "info --stats of SH: a line a degree" equal "$(grep -c '^sh_[123] ' logs/out)" 3
succeeds "info --stats --json" info knot.ply --stats --json
check "info --stats --json: keys" keys logs/out stats
check "info --stats --json: counts of all" equal "$(sed 's/.*"name": "x",[^[]*\[\([0-9, ]*\)\].*/\1/' logs/out |
    tr ',' '\n' | awk '{ n += $1 } END { print n }')" 3000
"$fixsplat" convert knot.ply knot.fxs
succeeds "info --stats of an .fxs file" info knot.fxs --stats
check "info --stats of an .fxs file: all attributes" equal "$(awk '/\|$/ { print $1 }' logs/out | head -n 10 | tr '\n' ' ')" \
    "x y z scale_0 scale_1 scale_2 opacity red green blue "

# ---- Formats ---------------------------------------------------------------------------------------------------------

floor_of() {
    case $1 in ply) echo 99 ;; glb) echo 75 ;; spz) echo 40 ;; rad) echo 50 ;; compressed.ply) echo 42 ;; sog) echo 36 ;; esac
}
for ending in $read_back; do
    rm -f knot2.$ending
    "$fixsplat" convert knot.ply knot2.$ending 2>logs/err
    check "to .$ending: no more said than what .spz clamps" equal \
        "$(grep -cv "knot2.spz: clamped SH beyond +-1, of 10 Gaussians" logs/err)" 0
    check "to .$ending: all of it" gaussians knot2.$ending 3000 3
    check "to .$ending: PSNR" looks_as knot2.$ending knot.ply "$(floor_of $ending)"
    "$fixsplat" convert knot.ply again.$ending 2>logs/err
    check "to .$ending: the same again" cmp knot2.$ending again.$ending
    for degree in 0 1 2; do
        "$fixsplat" convert knot.ply low.$ending --sh-degree $degree 2>logs/err
        check "to .$ending: SH degree $degree" gaussians low.$ending 3000 $degree
    done
    "$fixsplat" convert row.ply single.$ending
    check "to .$ending: a single Gaussian" gaussians single.$ending 1 0
done
"$fixsplat" convert knot.ply fine.spz --spz-fine 2>logs/err
check "to .spz --spz-fine: PSNR" looks_as fine.spz knot.ply 44
succeeds "to .csv" convert knot.ply knot.csv
check "to .csv: a line each, and one of names" equal "$(awk -F, '{ print NF }' knot.csv | sort | uniq -c | awk '{ print $1, $2 }')" \
    "3001 59"
{ printf 'ply\nformat ascii 1.0\nelement vertex 3000\n' && head -n 1 knot.csv | tr ',' '\n' | sed 's/^/property float /' &&
    echo end_header && sed 1d knot.csv | tr ',' ' '; } >text.ply
"$fixsplat" convert text.ply text-floats.ply
check "to .csv: each float as it was" cmp text-floats.ply knot.ply
for ending in ply compressed.ply sog spz; do
    succeeds "anti-aliased, to .$ending" convert smooth.ply smooth2.$ending
    check "anti-aliased, to .$ending: still" sh -c "'$fixsplat' info smooth2.$ending | grep -q ', anti-aliased'"
done
for ending in glb csv; do
    run convert smooth.ply smooth2.$ending
    check "anti-aliased, to .$ending: said" says "smooth2.$ending: a .$ending cannot hold that the scene is anti-aliased"
done
for name in x x.gltf x.ksplat x.html x.ply.gz meta.json .sog .compressed.sog/x; do
    fails "to $name" 2 "$name: expected a name ending in" convert knot.ply $name
done

for ending in $endings; do
    case $ending in csv | fxs) continue ;; esac
    "$fixsplat" convert knot.ply in.$ending 2>logs/err
    "$fixsplat" convert in.$ending rows.ply wanted.$ending --scale 2 --place rows.ply:60,0,0 2>logs/err
    ln -sf in.$ending link.$ending
    "$fixsplat" convert in.$ending rows.ply link.$ending --scale 2 --place rows.ply:60,0,0 --force 2>logs/err
    check "--force, .$ending: as under another name" cmp in.$ending wanted.$ending
    check "--force, .$ending: a link stays" [ -L link.$ending ]
done
cp knot.ply in.fxs
fails "an .fxs by name: a .ply" 2 "in.fxs: is read and cannot be written too$" convert in.fxs in.fxs
fails "--force, .fxs" 2 "^fixsplat: --force: an .fxs never replaces a file of IN" convert in.fxs in.fxs --force
for ending in $endings; do
    [ $ending = fxs ] || { cp knot.ply same.$ending && ln -sf same.$ending link.$ending; }
    [ $ending = fxs ] || for out in same.$ending link.$ending ./same.$ending; do
        fails "$out is IN and OUT" 2 "$out: is read and cannot be written too; --force replaces it" \
            convert rows.ply same.$ending $out
    done
    [ $ending = fxs ] || check "same.$ending is as it was" cmp same.$ending knot.ply
    if [ -c /dev/full ]; then
        ln -sf /dev/full full.$ending
        fails "a full disk, .$ending" 1 "full.$ending: cannot be written: No space" convert knot.ply full.$ending
    fi
    (
        ulimit -f 8
        trap '' XFSZ
        echo precious >over.$ending
        "$fixsplat" convert knot.ply over.$ending 2>logs/err
    )
    check "a disk that becomes full, .$ending: OUT is as it was" equal "$(cat over.$ending)" precious
    check "a disk that becomes full, .$ending: said" grep -q "^fixsplat: over.$ending: cannot be written: " logs/err
done
check "nothing is left behind" equal "$(ls -a | grep -c '^.fixsplat-')" 0

# ---- 3D Tiles --------------------------------------------------------------------------------------------------------

mkdir tiles
for i in 0 1; do "$fixsplat" convert knot.ply tiles/$i.glb --crop $((5 * i - 5)),-9,-9,$((5 * i)),9,9 2>logs/err; done
tile() { printf '{"boundingVolume": {"sphere": [0, 0, 0, 9]}, "geometricError": 0, "content": {"uri": "%s.glb"}}' $1; }
printf '{"asset": {"version": "1.1"}, "geometricError": 9, "root": {"boundingVolume": {"sphere": [0, 0, 0, 9]},
    "geometricError": 1, "refine": "ADD", "children": [%s, %s]}}' "$(tile 0)" "$(tile 1)" >tiles/tileset.json
succeeds "of a tileset with two .glb" convert tiles/tileset.json tiles.ply
check "of a tileset with two .glb: all of it" gaussians tiles.ply 3000 3
succeeds "of a folder with a tileset" convert tiles tiles2.ply
check "of a folder with a tileset: the same" cmp tiles.ply tiles2.ply
"$fixsplat" convert tiles.ply tiles.csv
"$fixsplat" convert knot.ply knot.csv
# A tileset has other axes than a .ply file, so only distances from the origin are compared.
radii() { awk -F, 'NR > 1 { printf "%.3f\n", sqrt($1 * $1 + $2 * $2 + $3 * $3) }' $1 | sort -n; }
cp tiles/0.glb 0.glb
for force in '' --force; do
    fails "a content of the tileset as OUT $force" 2 "tiles/../tiles/0.glb: is read and cannot be written too$" \
        convert tiles/tileset.json tiles/../tiles/0.glb $force
done
check "a content of the tileset as OUT: stays" cmp tiles/0.glb 0.glb
radii tiles.csv >tiles.radii
radii knot.csv >knot.radii
check "of a tileset with two .glb: where they were" cmp tiles.radii knot.radii

# ---- .lcc --------------------------------------------------------------------------------------------------------

mkdir lcc sky
make_lcc() { "$(dirname "$fixsplat")/tests/test_lcc" --write "$@" >logs/out 2>&1; }
make_lcc lcc knot.ply && lcc=lcc/scene.lcc || lcc=
if [ "$lcc" ]; then
    succeeds "of an .lcc" convert $lcc lcc.ply
    check "of an .lcc: all of it" gaussians lcc.ply 3000 3
    check "of an .lcc: as it was" looks_as lcc.ply knot.ply 50
    succeeds "of an .lcc, level 1" convert $lcc lcc1.ply --lod 1
    check "of an .lcc, level 1: fewer" gaussians lcc1.ply 538 3
    fails "of an .lcc, level 2" 1 "no level 2: levels of detail in this scene: 2" convert $lcc x.ply --lod 2
else
    skip ".lcc" "built without cJSON"
fi

# ---- Written levels of detail ----------------------------------------------------------------------------------------

mkdir streamed
succeeds "to lod-meta.json" convert knot.ply streamed/lod-meta.json
check "to lod-meta.json: all of it" gaussians streamed 3000 3
check "to lod-meta.json: PSNR" looks_as streamed/lod-meta.json knot.ply 36
check "to lod-meta.json, level 2: a quarter" sh -c "'$fixsplat' info streamed --lod 2 | grep -q '^Gaussians *768,'"
succeeds "a sky of one level" convert knot.ply sky.sog
for levels in 2 2,0; do
    succeeds "level 2 and a sky: --lod $levels" convert streamed sky.sog both.ply --force --lod $levels
    check "level 2 and a sky: --lod $levels: all of both" gaussians both.ply 3768 3
done
fails "level 2 and level 1 of a sky" 1 "sky.sog: no level 1: levels of detail in this scene: 1" \
    convert streamed sky.sog x.ply --lod 2,1
fails "--lod for three files of two" 1 "lod 2,0,0: 3 levels for 2 files" convert streamed sky.sog x.ply --lod 2,0,0
fails "--lod that is none" 2 "lod 2,x: expected whole numbers from 0 to 1000" convert streamed sky.sog x.ply --lod 2,x
succeeds "endings in capitals" convert knot.ply CAPITALS.SOG
check "endings in capitals: a .sog" cmp CAPITALS.SOG sky.sog
fails "to lod-meta.json in a folder that is not there" 1 "no/such/lod-meta.json: cannot be written: No such file" \
    convert knot.ply no/such/lod-meta.json
succeeds "to .rad: a coarse level" convert knot2.rad coarse.ply --lod 2
check "to .rad, level 2: less than a third" sh -c "[ \$('$fixsplat' info coarse.ply | sed -n 's/^Gaussians *\([0-9]*\).*/\1/p') -lt 1000 ]"
fails "to .rad: no level 99" 1 "no level 99: levels of detail in this scene: " convert knot2.rad x.ply --lod 99

# ---- Formats read by other programs ----------------------------------------------------------------------------------

# The program splat-transform makes palettes from random starts. A fixed seed makes its output repeatable.
transform() { node --random-seed=1 "$modules/@playcanvas/splat-transform/bin/cli.mjs" -q -w "$@" >logs/out 2>&1; }
if have node && [ -d "$modules/@playcanvas/splat-transform" ]; then
    for ending in compressed.ply sog spz; do
        check "splat-transform reads .$ending" transform knot2.$ending theirs.ply
        check "splat-transform reads .$ending: as we do" looks_as knot2.$ending theirs.ply 60
    done
    check "splat-transform writes .spz" transform knot.ply theirs.spz
    check "splat-transform writes .spz: as large as we do" awk "BEGIN {
        ratio = $(wc -c <theirs.spz) / $(wc -c <knot2.spz); exit !(ratio > 0.95 && ratio < 1.05) }"
    check "splat-transform writes .glb" transform knot.ply theirs.glb
    check "splat-transform writes .glb: as we do" looks_as knot2.glb theirs.glb 75
    # The program splat-transform writes coordinates with negated x and y.
    check "splat-transform places" transform knot.ply -r 20,30,40 -s 2 -t 1,2,3 theirs.ply
    "$fixsplat" convert knot.ply ours.ply --rotate -20,-30,40 --scale 2 --translate -1,-2,3
    check "splat-transform places: as we do" looks_as ours.ply theirs.ply 60
    if [ "$lcc" ]; then   # the program splat-transform writes environments only to lod-meta.json
        "$fixsplat" make-scene knot --count 300 -o small.ply
        "$fixsplat" convert small.ply sky.ply --scale 3 --translate 1,-4,9
        make_lcc sky small.ply sky.ply
        check "splat-transform reads .lcc with an environment" transform -g cpu -i 40 sky/scene.lcc sky/lod-meta.json
        check "splat-transform reads .lcc with an environment: as many" gaussians sky/lod-meta.json 600 3
        check "splat-transform reads .lcc with an environment: as we do" looks_as sky/scene.lcc sky/lod-meta.json 46
    fi
    for level in ${lcc:+0 1}; do
        check "splat-transform reads .lcc, level $level" transform -O $level $lcc theirs.ply
        check "splat-transform reads .lcc, level $level: as we do" looks_as $lcc theirs.ply 60 --lod $level
    done
else
    skip "splat-transform" "no node or no @playcanvas/splat-transform here (make setup test)"
fi
transform_3() { node "$modules/splat-transform-3/bin/cli.mjs" -q -w -g cpu "$@" >logs/out 2>&1; }
if have node && [ -d "$modules/splat-transform-3" ]; then
    for level in 0 2 4; do
        check "splat-transform 3 reads lod-meta.json, level $level" transform_3 -L $level streamed/lod-meta.json theirs.ply
        check "splat-transform 3 reads lod-meta.json, level $level: as we do" looks_as streamed theirs.ply 60 --lod $level
    done
else
    skip "splat-transform 3" "no node or no splat-transform-3 here (make setup test)"
fi
spark() { node "$root/tests/web/spark.mjs" "$modules" "$@" >logs/out 2>&1; }
if have node && [ -d "$modules/@sparkjsdev/spark" ]; then
    check "Spark reads .rad" spark decode knot2.rad theirs.ply
    check "Spark reads .rad: all of it" gaussians theirs.ply 3000 3
    check "Spark reads .rad: as we do" looks_as knot2.rad theirs.ply 37
    check "Spark draws nodes of a .rad, each leaf by one" spark cut knot2.rad 1000 0,0,-12 theirs.ply
    check "Spark draws nodes of a .rad, as many as it may" sh -c "grep -Eq '^(9[5-9].|1000) of' logs/out"
    check "Spark draws nodes of a .rad: they look as the whole" looks_as theirs.ply knot.ply 27
else
    skip "Spark" "no node or no @sparkjsdev/spark here (make setup test)"
fi
if have node && [ -d "$modules/gltf-validator" ]; then
    check "the glTF validator" node "$root/tests/web/validate_gltf.mjs" "$modules" knot2.glb
else
    skip "the glTF validator" "no node or no gltf-validator here (make setup test)"
fi

# ---- A real tile as a tileset of two halves --------------------------------------------------------------------------

boatyard=$scenes/boatyard-tile3/boatyard-tile3.glb
if [ -f "$boatyard" ] && [ "$lcc" ]; then
    mkdir -p boatyard/left
    "$fixsplat" convert "$boatyard" boatyard/whole.glb --decimate 5%
    "$fixsplat" convert "$boatyard" half.ply --crop -1e4,-1e4,-1e4,-49,1e4,1e4 2>logs/err
    "$fixsplat" convert half.ply boatyard/left/half.glb --translate 10,20,30
    "$fixsplat" convert "$boatyard" boatyard/right.glb --crop -49,-1e4,-1e4,1e4,1e4,1e4 2>logs/err
    # Coordinates x, y, z in the tileset are -x, -z, -y of the .ply file.
    box='"boundingVolume": {"sphere": [0, 0, 0, 999]}, "geometricError": 1'
    printf '{"asset": {"version": "1.1"}, "geometricError": 9, "root": {%s, "refine": "REPLACE", "content": {"uri":
        "whole.glb"}, "children": [{%s, "content": {"uri": "left/tileset.json"}}, {%s, "content": {"uri":
        "right.glb"}}]}}' "$box" "$box" "$box" >boatyard/tileset.json
    printf '{"asset": {"version": "1.0"}, "geometricError": 9, "root": {%s, "transform": [1, 0, 0, 0, 0, 1, 0, 0,
        0, 0, 1, 0, 10, 30, 20, 1], "content": {"uri": "half.glb"}}}' "$box" >boatyard/left/tileset.json
    succeeds "boatyard as a tileset of two" convert boatyard/tileset.json boatyard.fxs
    check "boatyard as a tileset of two: all of the finest" gaussians boatyard.fxs 83145 3
    check "boatyard as a tileset of two: as it was" looks_as boatyard.fxs "$boatyard" 60
    fails "boatyard as a tileset of two: no --lod" 1 "no level 1: levels of detail in this scene: 1" \
        convert boatyard/tileset.json x.fxs --lod 1
    printf x >boatyard/right.glb
    fails "boatyard, a tile that is damaged" 1 "boatyard/right.glb: " convert boatyard/tileset.json x.fxs
    check "boatyard, a tile that is damaged: nothing is written" [ ! -e x.fxs ]
else
    skip "boatyard" "not here, or built without cJSON"
fi

# ---- A real scene ----------------------------------------------------------------------------------------------------

if [ -f "$scenes/snowmiku/snowmiku.ply" ]; then
    folder=$scenes/snowmiku
    "$fixsplat" convert "$folder/snowmiku.ply" plain.ply
    on_views() { looks_as "$1" plain.ply "$2" --cameras "$folder/cameras.json"; }
    for pair in compressed.ply:46 sog:41 glb:80; do
        "$fixsplat" convert plain.ply snow.${pair%:*}
        check "snowmiku as .${pair%:*}: PSNR" on_views snow.${pair%:*} ${pair#*:}
        rm -f snow.${pair%:*}
    done
    "$fixsplat" convert plain.ply half.ply --decimate 50%
    check "snowmiku, half of it: PSNR" on_views half.ply 37
    "$fixsplat" convert plain.ply clean.ply --drop-floaters 2>logs/err
    check "snowmiku without floaters: PSNR" on_views clean.ply 50
else
    skip "snowmiku" "no real scenes at FXS_SCENES"
fi

if [ -f "$scenes/luma-seal/luma-seal.splat" ]; then
    "$fixsplat" convert "$scenes/luma-seal/luma-seal.splat" seal.sog
    check "luma-seal as .sog: PSNR" looks_as seal.sog "$scenes/luma-seal/luma-seal.splat" 53
else
    skip "luma-seal" "no real scenes at FXS_SCENES"
fi
finish
