#!/bin/sh
# No option of a command is ignored in silence: each option of the table changes what the command writes or prints in
# each place, or is refused with one line.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/splatv.sh"

"$fixsplat" make-scene knot --count 120 -o knot.ply >logs/out
"$fixsplat" make-scene knot --count 700 -o 700.ply >logs/out
"$fixsplat" convert knot.ply plain.fxs --quiet
"$fixsplat" convert knot.ply start.fxs --start-view 1,-2,-7,0.1,0.2,0,40 --quiet
"$fixsplat" convert 700.ply levels.fxs --levels --quiet
splatv moving.splatv 300
camera='"width":64,"height":36,"rotation":[[1,0,0],[0,1,0],[0,0,1]],"fx":50,"fy":50'
echo "[{\"id\":0,\"img_name\":\"a\",\"position\":[0,-2,-9],$camera},{\"id\":1,\"img_name\":\"b\",\"position\":[1,-2,-9],
    $camera},{\"id\":2,\"img_name\":\"c\",\"position\":[2,-2,-9],$camera}]" >cameras.json
printf '0 -2 -9 0 0 0 0 -1 0 50 0\n2 -2 -9 0 0 0 0 -1 0 50 0.2\n' >keys.txt
key='"look":[0,0,0],"fov":50'
keys="[{\"time\":0,\"eye\":[0,-2,-9],$key},{\"time\":1,\"eye\":[2,-2,-9],$key}]"
echo "{\"fixsplat\":1,\"tracks\":[{\"keys\":$keys},{\"loop\":\"pingpong\",\"keys\":$keys}]}" >track.json

# ---- Every option in every place -------------------------------------------------------------------------------------

# A command has: `places`, lines of a name and arguments; `options`, each an option and a value; `by_design`,
# options that are not tried, as they change no output; `elsewhere`, pairs option:place that change the output of other
# inputs; `more`, arguments of every run; `mask`, an expression of sed that takes times out of what is printed; `notes`,
# an expression of grep for lines on stderr that count as output; `how`, the function that runs the command; `path`, its
# PATH.
inside=$work/made
mkdir "$inside"

plainly() {
    PATH=$path "$fixsplat" "$@" >out.txt 2>../logs/err
    status=$?
}

# produce ARGUMENT...: runs the command in an empty folder. Sets $status, and $sum to a checksum of all that it writes.
produce() {
    has_nothing || rm -rf ./*
    $how "$@"
    sum=$status
    if ! has_nothing; then
        [ ! "$mask" ] || sed -E -i "$mask" out.txt
        sum="$status $(cksum ./* ./*/* 2>/dev/null)"
    fi
    [ ! "$notes" ] || sum="$sum $(grep "$notes" ../logs/err)"
}

# has_nothing: true if the command wrote no file and printed nothing.
has_nothing() {
    set -- ./*
    [ "$*" = ./out.txt ] && [ ! -s out.txt ]
}

is_refused() { [ "$status" != 0 ] && [ "$sum" != "$before" ] && has_nothing; }

says_one_line() {
    line='' lines=0
    while read -r next; do line=$next lines=$((lines + 1)); done <../logs/err
    case ${line%%: *} in fixsplat) [ "$notes" ] || [ "$lines" = 1 ] ;; *) false ;; esac
}

all_are_here() {
    for option in $("$fixsplat" help --table | cut -f 1,2 | sed -n "s/^$command	//p"); do
        case " $by_design help version quiet $(echo "$options" | sed 's/^ *//; s/[ =].*//' | tr '\n' ' ')" in
        *" $option "*) ;;
        *) echo "$option"; return 1 ;;
        esac
    done
}

try_option() {
    tried=$((tried + 1))
    produce $command $arguments $own --$option $value
    name=${option%=*}
    if is_refused; then
        refused=$((refused + 1))
        says_one_line || echo "not one line: $name:$place"
    elif [ "$sum" = "$before" ]; then
        case " $(echo $elsewhere) " in *" $name:$place "* | *" $name:all "*) ;; *) echo "$name:$place" ;; esac
    fi
}

try() {
    command=$1 tried=0 refused=0 commands="$commands $1"
    options=$(echo "$options" | tr -s ';\n' '\n\n')
    check "every option of $command is tried" all_are_here
    cd "$inside" || exit 1
    while read -r place arguments; do
        own=$more
        case $place in panorama | backends | cube | way) own= ;; esac
        produce $command $arguments $own
        case $status:$place in 0:* | 1:until-*) ;; *) fail "$command: $place" "$(cat ../logs/err)" ;; esac
        before=$sum
        while read -r option value; do
            case " $arguments " in *" --${option%=*}"[\ =]*) ;; *) try_option ;; esac
        done <<END
$options
END
    done >../logs/silent <<END
$places
END
    cd "$work" || exit 1
    check "$command: $tried pairs of an option and a place: $refused are refused, none is ignored" equal \
        "$(cat logs/silent)" ''
}

# Options of several commands.
of_scenes='time 0.4; rate 12; budget 100; detail 4; place 0:0,0,0,0.5,0.5,0.5,0.5; scene ../world.json; lod 1; axes rdf'
shared="cameras ../cameras.json; view 1; eye 1,-2,-9; look 0,1,0; up 0.3,-1,0; auto-up; fov 30; tangents -1,1.2,1,-1;
    ortho 3; near 14; size 60x30; stereo 0.2; cutoff square; sh-degree 0; device 1; profile small; $of_scenes"

# ---- render ----------------------------------------------------------------------------------------------------------

# A place is a name and the arguments of render.
places='plain ../knot.ply -o out.png
start ../start.fxs -o out.png
cameras ../knot.ply --cameras ../cameras.json -o out.png
several ../knot.ply --cameras ../cameras.json --view all -o out%02d.png
path ../knot.ply --path ../cameras.json --frames 8 -o out.y4m
keys ../knot.ply --path ../keys.txt -o out.y4m
track ../knot.ply --path ../track.json --fps 8 -o out.y4m
eye ../knot.ply --eye 0,-2,-9 -o out.png
orbit ../knot.ply --orbit 3 -o out.y4m
shutter ../knot.ply --orbit 3 --shutter 90 --samples 3 -o out.y4m
aperture ../knot.ply --aperture 0.2 --samples 3 -o out.png
jpg ../start.fxs -o out.jpg
panorama ../knot.ply --panorama --size 64x32 -o out.png
ortho ../knot.ply --ortho 4 -o out.png
tangents ../knot.ply --tangents -1,1,1,-1 -o out.png
stereo ../start.fxs --stereo 0.1 -o out.png
depth ../start.fxs --depth out.pfm
ids ../start.fxs --ids out.png
pick ../start.fxs --pick 32,18
levels ../levels.fxs -o out.png
moves ../moving.splatv -o out.png
two ../knot.ply ../plain.fxs -o out.png'

options="bg 303030; format ppm; quality 50; fps 12; times 0..0.2; orbit 4; frames 4; path ../cameras.json; seconds 0.2;
    track 1; write-cameras views.json; shutter 180; aperture 0.5; focus 3; samples 4; alpha; depth d.png;
    depth-kind mean; depth-range 20; ids i.png; pick 30,18; panorama; lens; scissor 0,0,32,18; hash; stats; json;
    diff diff.png; gaze 0,0,0,4;
    expect 0123456789abcdef; $shared"

# These change no output by design: how the work is done, limits, and words.
by_design='output threads max-memory cpu backend max-gaussians import-memory pool'
# These change an output of other scenes: one that is not upright, cameras with lens distortion, a disc at the pixel's
# edge, and scenes with levels in several files.
elsewhere='auto-up:plain auto-up:jpg auto-up:tangents auto-up:ortho auto-up:stereo auto-up:depth auto-up:ids
    auto-up:pick auto-up:levels auto-up:moves sh-degree:moves auto-up:two auto-up:eye auto-up:orbit auto-up:panorama lens:cameras lens:several
    auto-up:shutter auto-up:aperture cutoff:pick'
mask= more='--size 64x36' how=plainly path=$PATH notes=
try render

# ---- info ------------------------------------------------------------------------------------------------------------

places='plain ../knot.ply
packed ../plain.fxs
levels ../levels.fxs
two ../knot.ply ../plain.fxs
json ../knot.ply --json
stats ../knot.ply --stats
board ../knot.ply --board 64x48
compare ../knot.ply --compare ../700.ply --views 1
packed-compare ../plain.fxs --compare ../knot.ply --views 1
levels-compare ../levels.fxs --compare ../700.ply --views 2
cube ../cube.obj
way ../cube.obj --distance 0,0,0,1,1,1 -o out.obj
backends --backends'
echo 'v 0 0 0 v 0 0 1 v 0 1 0 v 0 1 1 v 1 0 0 v 1 0 1 v 1 1 0 v 1 1 1 f 1 2 4 3 f 5 7 8 6 f 1 5 6 2 f 3 4 8 7
    f 1 3 7 5 f 2 6 8 4' | sed 's/ *\([vf]\)/\n\1/g' >cube.obj
options="distance 0,0,0,1,0,1; output b.obj; compare ../700.ply; compare-time 0.3; cameras ../cameras.json; views 2;
    cutoff square; compare-cutoff square; size 60x30; board 60x30; stats; max-memory 1M; profile small; json; backends; $of_scenes"
by_design='max-gaussians import-memory' elsewhere= mask='s/trial took.*lists//' more='--size 48x32'
try info

# ---- bench -----------------------------------------------------------------------------------------------------------

places='plain ../tip.ply --json
cameras ../tip.ply --cameras ../cameras.json --json
eye ../tip.ply --eye 0,-2,-9 --json
ortho ../tip.ply --ortho 4 --json
tangents ../tip.ply --tangents -1,1,1,-1 --json
stereo ../tip.ply --stereo 0.1 --json
orbit ../tip.ply --orbit 10 --json
levels ../levels.fxs --json
packed ../plain.fxs --json
two ../knot.ply ../plain.fxs --json
compare ../tip.ply --compare ../before.json'
options="times 0..0.4; fps 12; orbit 11; frames 11; draw ids; gaze 0,0,0,4; json; compare ../before.json; threads 3; cpu c; max-memory 3M; $shared"
"$fixsplat" make-scene landscape --count 300 -o land.ply && "$fixsplat" convert land.ply tip.ply --rotate 90,0,0 --quiet
"$fixsplat" bench tip.ply --size 64x36 --json >before.json
# The place of a scene, its profile and a gaze change times alone.
by_design='backend max-gaussians import-memory' more='--size 64x36'
elsewhere='auto-up:levels auto-up:packed auto-up:two place:cameras profile:all gaze:all'
mask='s/("[a-z_]*_ms[_a-z]*"): [0-9.]+/\1/g; s/("[a-z]+"): [0-9]+\.[0-9]{3}([,}])/\1\2/g; s/ +[0-9]+\.[0-9]{3}//g
    s/ +[0-9.]+%//'
try bench

# ---- compare ---------------------------------------------------------------------------------------------------------

"$fixsplat" render knot.ply --size 64x36 -o a.png && "$fixsplat" render knot.ply --size 64x36 --fov 30 -o b.png
places='other ../a.png ../b.png
equal ../a.png ../a.png
json ../a.png ../b.png --json'
options='diff d.png; min-psnr 90; min-ssim 0.9999; json'
# Equal pictures pass every limit.
by_design= elsewhere='min-psnr:equal min-ssim:equal' mask= more=
try compare

# ---- make-scene ------------------------------------------------------------------------------------------------------

places=$("$fixsplat" make-scene --help | sed -n 's/^  \([a-z]*\) .*(degree.*/\1 \1 -o out.ply/p')
options='count 60; seed 2'
by_design=output elsewhere= mask= more='--count 50'
try make-scene

# ---- collide ---------------------------------------------------------------------------------------------------------

places='plain ../knot.ply -o out.voxel.json
packed ../start.fxs -o out.voxel.json
levels ../levels.fxs -o out.voxel.json
mesh ../knot.ply -o out.glb
moves ../moving.splatv -o out.voxel.json --time 0.3'
options='mesh; voxel 0.4; opacity 0.7; seed 90,0,0; radius 0.5; height 2; time 0.7; profile small; lod 1; axes rdf; rate 12'
by_design='output threads max-memory max-gaussians import-memory' mask= more='--voxel 0.2'
# These change the voxels of a scene with narrow places, and of one with Gaussians of many sizes.
elsewhere='height:moves profile:moves'
how=plainly path=$PATH notes=
try collide

# ---- select ----------------------------------------------------------------------------------------------------------

mkdir marks && "$fixsplat" render knot.ply --cameras cameras.json --view 0 -o marks/a.png
places='plain ../knot.ply --eye 0,-2,-9 --look 0,0,0 -o out.ply --around 300,100,900,700
packed ../start.fxs -o out.fxs --click 640,360
several ../knot.ply -o out.ply --cameras ../cameras.json --around 8,3,56,34
masked ../knot.ply -o out.ply --cameras ../cameras.json --masks ../marks --alone'
options='rest rest.ply; ids; picture look.png; masks ../marks; labels; click 500,300; not 600,400; around 500,300,600,400; bias=-0.7; trim 1
alone; cameras ../cameras.json; view 1; eye 0,-3,-9; look 0.3,0,0; up 1,0,0; fov 30; size 800x600; profile small; lod 1; axes rdf
rate 12'
by_design='output threads max-memory max-gaussians import-memory' mask= more=
# What is clicked at, or white in the masks, is in the box already.
elsewhere='click:plain masks:several around:packed'
how=plainly path=$PATH notes=
try select

# ---- publish ---------------------------------------------------------------------------------------------------------

mkdir -p page/viewer scenes && echo page >page/viewer/index.html && echo >page/viewer/single.js && echo >page/LICENSE &&
    cp 700.ply plain.fxs scenes && "$fixsplat" convert 700.ply packed.fxs --quiet
export FIXSPLAT_WEB="$work/page"
echo '{"fixsplat":1}' >tour.json
echo sound >a.wav
places='floats ../700.ply site
packed ../packed.fxs site
levels ../levels.fxs site
several ../scenes site
tour ../700.ply site --settings ../tour.json
moving ../moving.splatv site
single --single ../700.ply a.html
packed-single --single ../levels.fxs a.html'
options='title T; profile compact; single; walk; levels; size 32x18; settings ../tour.json; sound ../a.wav; up 0,0,-1;
    start-view 1,-2,-9,0,0,0'
# Scenes that have levels keep them.
by_design= elsewhere='levels:levels levels:packed-single' mask= more=
try publish

# ---- convert ---------------------------------------------------------------------------------------------------------

"$fixsplat" make-scene meadow --count 600 -o grass.ply
"$fixsplat" convert grass.ply meadow.ply --rotate 90,0,0 --quiet
"$fixsplat" convert meadow.ply meadow.fxs --quiet && "$fixsplat" convert meadow.ply meadow-levels.fxs --levels --quiet
"$fixsplat" convert 700.ply part-1.fxs --block 1/2 --quiet
"$fixsplat" convert 700.ply part-2.fxs --block 2/2 --quiet
edits() {
    echo "{\"format\": \"fixsplat edits\", \"version\": 1, \"scene\": {\"gaussians\": 600, \"checksum\": \"$1\"},
        \"edits\": [{\"act\": \"delete\", \"select\": [{\"shape\": \"sphere\", \"numbers\": [0, 0, 0, 1]}]}]}" >edits.json
}
edits 00000000
edits "$("$fixsplat" convert meadow.ply x.csv --edits edits.json 2>&1 | sed 's/.* \([0-9a-f]\{8\}\)$/\1/')"
places='ply ../meadow.ply out.ply
fxs ../meadow.ply out.fxs
packed ../meadow.fxs out.ply
repacked ../meadow-levels.fxs out.fxs
spz ../meadow.ply out.spz
spz3 ../meadow.ply out.spz --spz-version 3
sog ../meadow.ply out.sog
glb ../meadow.ply out.glb
splat ../meadow.ply out.splat
two ../meadow.ply ../meadow.fxs out.ply
levels ../meadow.ply out.fxs --levels
refine ../meadow.ply out.fxs --levels --refine=0
block ../meadow.ply out.fxs --block 1/2
decimated ../meadow.ply out.ply --decimate 100
parts ../part-1.fxs ../part-2.fxs out.fxs
moves ../moving.splatv out.fxs'
options='up 0,0,1; auto-up; level 0,0,0,1,0,0,0,1,1; rotate 10,0,0; scale 2; translate 1,0,0; crop -1,-1,-1,1,1,1;
    sphere 0,0,0,3; cylinder 0,-9,0,0,9,0,2; prune 0.9; drop-floaters=4; thing; edits ../edits.json; for board; sh-degree 0;
    decimate 50%; profile small; levels; refine=1; cameras ../cameras.json; block 2/3; start-view 1,-2,-9,0,0,0; spz-version 3; spz-fine; force;
    place 0:0,0,0,0.5,0.5,0.5,0.5; scene ../world.json; lod 1; axes rdf; time 0.4; times 0..0.2; fps 12; rate 12'
# --force allows what is not done here; a .splat and the moving scene have no SH, and that scene is opaque.
by_design='max-gaussians import-memory' elsewhere='force:all sh-degree:splat sh-degree:moves prune:moves' mask= more=--quiet
try convert

# ---- mesh ------------------------------------------------------------------------------------------------------------

places='glb ../knot.ply -o out.glb
ply ../knot.ply -o out.ply
obj ../start.fxs -o out.obj
closed ../knot.ply -o out.ply --watertight
inside ../knot.ply -o out.ply --from inside
both ../knot.ply -o out.ply --from both
few ../knot.ply -o out.ply --triangles 200
cameras ../knot.ply -o out.ply --cameras ../cameras.json
unbounded ../knot.ply -o out.ply --cameras ../cameras.json --unbounded
box ../knot.ply -o out.ply --box -1,-1,-1,1,1,0
two ../knot.ply ../plain.fxs -o out.ply
moves ../moving.splatv -o out.ply --time 0.1'
options="triangles 100; box -1,-1,-1,1,0,1; cameras ../cameras.json; view 1; from inside; views 10; watertight; unbounded; band 2; trim 70;
    parts 999999; scale 2; up 0.1,-1,0; near 9; device 1; profile small; $of_scenes"
# Most of these change no mesh by design; the resolution is given. A mesh has no budget and detail. The moving scene is
# seen from all sides.
by_design='output resolution threads max-memory cpu backend max-gaussians import-memory'
elsewhere='watertight:moves trim:moves' mask= more='--resolution 24 --parts 1 --quiet' notes=
options=$(echo "$options" | sed 's/budget 100; detail 4;//')
try mesh

# ---- fit -------------------------------------------------------------------------------------------------------------

. "$root/tests/scripts/lib/photos.sh"
make_photographs 6
mkdir photos masks && cp set/images/*.png photos
for photo in photos/*; do "$fixsplat" render knot.ply --eye 0,-2,-9 --size 64x48 -o masks/${photo##*/}; done
"$fixsplat" fit set --seed 5 --steps 1 -o saved.fit --quiet >logs/out
places='fxs ../set --steps 3 -o a.fxs
ply ../set --steps 3 -o a.ply
fit ../set --steps 3 -o a.fit
json ../set --steps 3 -o a.fxs --json
masks ../set --steps 3 -o a.fxs --masks ../masks
resumed ../set --steps 4 -o a.fxs --resume ../saved.fit
block ../set --steps 3 -o a.ply --block 1/2
coarse ../set --steps 4 -o a.ply --block 1/2 --coarse ../saved.fit
measure ../set --measure ../plain.fxs
until-colmap ../photos -o a.fxs --cameras-only'
options='output b.fxs; moving; watch=2; moment-steps 5; refine-steps 5; fps 12; quality best; recipe mcmc; exposure affine; refine-poses; antialiased; surfaces; sky=50; steps 5;
    of room; photos mixed; resolution 32; sh-degree 1; batch 2; block 2/3; coarse ../saved.fit; max-gaussians 90; seed 1; cutoff square;
    background 405060; profile small; crop-to-subject; hold-out 3; masks ../masks; invert-masks; alpha ignore;
    frames 9; cameras-only; measure ../start.fxs; compare pictures; write-cameras c.json; save-every 2;
    metrics-every 2; preview; port 0; log log.tsv; resume ../saved.fit; device 1; max-memory 64M; json'
# A block is one of several fits with the same options; these photographs are small and opaque; poses move from step 501
# on.
by_design='threads cpu backend skip-bad'
elsewhere='max-gaussians:coarse invert-masks:block invert-masks:coarse quality:measure alpha:masks masks:until-colmap
    quality:until-colmap photos:until-colmap refine-poses:all'
more= path=/nowhere notes='^fixsplat: '
# Lines that repeat the options do not count.
mask='s/"(seconds|project|bin|blend|loss|back|update)": [0-9.]+//g
    /^(again, and better|the photographs beside it|its scene): /d'
try fit

# ---- view --web ------------------------------------------------------------------------------------------------------

# test_window.c tries the options of view's window.
serve() {
    "$fixsplat" "$@" >out.txt 2>../logs/err &
    server=$!
    until [ -s out.txt ] || ! kill -0 $server 2>/dev/null; do sleep 0.02; done
    at=$(sed -n 's|^\(http://[^/]*\)/$|\1|p;q' out.txt)
    if [ "$at" ]; then
        where=$(curl -s -o first -o second -w '%{redirect_url}' "$at/" "$at/1")
        scene=${where#*scene=}
        curl -s "$at${scene%%&*}" "$at/list.html" "$at/cameras.json" >got
        echo "${where#"$at"}" >>got
        kill $server
    fi
    wait $server
    status=$?
}
places='web --web ../knot.ply
packed --web ../plain.fxs
cameras --web ../knot.ply --cameras ../cameras.json
several --web ../scenes'
options="bg 303030; levels; qr; bind 0.0.0.0; cert a.pem; key a.pem; screenshot a.png; fps 30; max-memory 3M; cpu c;
    backend cpu; pool 1M; xr; metres-per-unit 2; pass-through; walls a.voxel.json;
    eye-height 2; $shared"
# A list packs a scene when a page asks for it.
by_design='web threads max-gaussians import-memory no-open port host' more='--port 0 --no-open' mask='s/:[0-9]+//'
elsewhere='profile:several levels:several lod:several axes:several'
how=serve path=$PATH notes=
run view --web none.ply
case $(cat logs/err) in
*'built without'*) skip "view --web" "$(cat logs/err)" ;;
*) if have curl; then try view; else skip "view --web" "no curl here"; fi ;;
esac

check "every command is tried" equal "$(echo ${commands% view} view associate demo doctor | tr ' ' '\n' | sort)" \
    "$("$fixsplat" help --table | cut -f 1 | sort -u)"
finish
