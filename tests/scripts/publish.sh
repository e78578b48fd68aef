#!/bin/sh
# Tests `fixsplat publish`: written files, errors, single-file pages, and the pages in Chromium.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

"$fixsplat" make-scene knot --count 2000 -o knot.ply && "$fixsplat" make-scene cubes --count 1000 -o 'a & b.ply' &&
    "$fixsplat" convert knot.ply small.fxs --profile small --quiet && mkdir -p page/viewer || exit 1
echo page >page/viewer/index.html
echo module >page/fixsplat.js
export FIXSPLAT_WEB="$work/page"

# ---- The sound of a moving scene -------------------------------------------------------------------------------------

tsog() { python3 "$root/tests/scripts/lib/tsog.py" "$@"; }
"$fixsplat" convert knot.ply knot.sog --quiet && tsog tone.wav 2 && : >empty.mp3 && cp tone.wav tone.txt || exit 1
tsog knot.sog heard.tsog 2 '{"file": "a/tone.wav", "volume": 0.5}' a/tone.wav=tone.wav
tsog knot.sog missing.tsog 2 '{"file": "tone.wav"}'
tsog knot.sog silent.tsog 2
# page_of ARGUMENT...: publishes, and prints the attributes of the sound, the files that are not of the page, and notes.
page_of() {
    rm -rf sounding
    "$fixsplat" publish "$@" --size 64x36 2>logs/err >logs/out
    echo "$(sed -n 's/.*poster="[a-z.]*" \(.*\)poster-frame.*/\1/p' sounding/index.html) $(ls sounding | tr '\n' ' ')$(cat logs/err)"
}
check "the sound in the file" equal "$(page_of heard.tsog sounding)" \
    'sound="heard.wav" volume="0.5"  fixsplat heard.fxs heard.jpg heard.wav index.html '
check "it is that sound" cmp sounding/heard.wav tone.wav
check "--sound" equal "$(page_of silent.tsog sounding --sound tone.wav)" \
    'sound="silent.wav" volume="1"  fixsplat index.html silent.fxs silent.jpg silent.wav '
check "no sound" equal "$(page_of silent.tsog sounding)" ' fixsplat index.html silent.fxs silent.jpg '
check "a sound that is missing" equal "$(page_of missing.tsog sounding)" ' fixsplat index.html missing.fxs missing.jpg fixsplat: missing.tsog: the sound tone.wav is missing or damaged'
fails "--sound of a still scene" 1 "knot.ply is still, and only moving scenes have sound" publish knot.ply sounding2 --sound tone.wav
fails "--sound of several" 2 "--sound is for one scene, not 2" publish knot.ply heard.tsog sounding2 --sound tone.wav
fails "--sound of another type" 2 "expected the name of an .mp3" publish heard.tsog sounding2 --sound tone.txt
fails "an empty --sound" 1 "empty.mp3: cannot be mapped into memory" publish heard.tsog sounding2 --sound empty.mp3
check "info tells of it" equal "$("$fixsplat" info heard.tsog | sed -n '/^sound/p') $("$fixsplat" info silent.tsog | grep -c '^sound')" \
    "sound         audio/wav, $(wc -c <tone.wav) bytes; fixsplat publish keeps it 0"
check "info --json" grep -q "\"sound\": {\"type\": \"audio/wav\", \"bytes\": $(wc -c <tone.wav), \"volume\": 0.5}" <<EOF
$("$fixsplat" info heard.tsog --json)
EOF
lost() { "$fixsplat" convert "$@" 2>&1 >logs/out; }
check "convert tells that it is lost" equal "$(lost heard.tsog heard.fxs) $(lost silent.tsog silent.fxs)" \
    "fixsplat: the sound of heard.tsog is not kept "
check "a moment has no sound" equal "$(lost heard.tsog heard.ply --time 1)" ""

# ---- One scene -------------------------------------------------------------------------------------------------------

check "a scene" "$fixsplat" publish knot.ply site --size 64x36 --quiet
check "its files" equal "$(cd site && find . -type f | sort | tr '\n' ' ')" \
    "./fixsplat/fixsplat.js ./fixsplat/viewer/index.html ./index.html ./knot.fxs ./knot.jpg "
seen() { "$fixsplat" render "$1" --size 64x36 --eye 3,-2,-5 --look 0,0,0 --hash; }
check "it is packed small" equal "$(seen site/knot.fxs) $(wc -c <site/knot.fxs)" "$(seen small.fxs) $(wc -c <small.fxs)"
check "with its first view" equal "$("$fixsplat" info site/knot.fxs | grep -c '^start') $("$fixsplat" info small.fxs |
    grep -c '^start')" "1 0"
"$fixsplat" render site/knot.fxs --size 64x36 --quality 85 -o poster.jpg --quiet
check "the picture is its own" cmp site/knot.jpg poster.jpg
check "the page shows it" grep -q '<fixsplat-viewer src="knot.fxs" label="knot" poster="knot.jpg" poster-frame="1\.0000 [0-9.]*" background="#000000">' site/index.html
check "an .fxs as it is" "$fixsplat" publish small.fxs site --size 64x36 --quiet
check "it has a start view" grep -q '^start view' <<EOF
$("$fixsplat" info site/small.fxs)
EOF
check "it is that scene" equal "$(seen site/small.fxs) $(wc -c <site/small.fxs)" "$(seen small.fxs) $(wc -c <small.fxs)"
check "and as it is when it has a start view" "$fixsplat" publish site/small.fxs again --size 64x36 --quiet
check "it is that file" cmp site/small.fxs again/small.fxs
"$fixsplat" convert knot.ply 'as it is.fxs' --up 0.2,-0.5,0.1 --start-view 3,-2,-5,0,0,0
"$fixsplat" publish 'as it is.fxs' a/b/site --size 64x36 >logs/out 2>logs/err
check "what shows it" grep -q ': python3 -m http.server -d a/b/site$' logs/out
check "a large .fxs as it is, in folders that were not there" cmp a/b/site/as-it-is.fxs 'as it is.fxs'
check "what would be gained" grep -Eqx "fixsplat: as it is.fxs: taken as it is, 0\.1 MB in profile default; [23]\.[0-9] times \
smaller, with less detail, by: fixsplat publish --size 64x36 'as it is.fxs' a/b/site --profile small" logs/err
eval "$(sed 's/.*by: fixsplat/succeeds "by that command"/' logs/err)"
"$fixsplat" convert 'as it is.fxs' small-anew.fxs --profile small --quiet
check "--profile packs an .fxs anew" cmp a/b/site/as-it-is.fxs small-anew.fxs
check "with its start" equal "$("$fixsplat" info a/b/site/as-it-is.fxs | grep -e '^up' -e '^start')" \
    "$("$fixsplat" info 'as it is.fxs' | grep -e '^up' -e '^start')"
check "--up and --start-view" "$fixsplat" publish 'as it is.fxs' stood --size 64x36 --up 0,0,1 \
    --start-view 0,-4,1,0,0,0,60 --quiet
check "--up and --start-view: of an .fxs" equal "$("$fixsplat" info stood/as-it-is.fxs | grep -e '^up' -e '^start')" \
    "up            0.0000 0.0000 1.0000
start view    from 0 -4 1, 60.0 degrees"
upright() { "$fixsplat" render "$1" --size 64x36 --eye 3,-2,-5 --look 0,0,0 --up 0,-1,0 --hash; }
check "--up and --start-view: the rest is as it was" equal "$(upright stood/as-it-is.fxs)" "$(upright 'as it is.fxs')"
check "--up alone" "$fixsplat" publish knot.ply stood --size 64x36 --up 0,0,1 --quiet
check "--up alone: a view is chosen" equal "$("$fixsplat" info stood/knot.fxs | sed -n '/^up/p; s/^start view .*/start/p')" \
    "up            0.0000 0.0000 1.0000
start"
check "--start-view of several scenes" equal "$("$fixsplat" publish knot.ply small.fxs several --start-view 1,2,3,0,0,0 2>&1;
    echo $?)" "fixsplat: publish: --start-view is for one scene, not 2
2"
"$fixsplat" publish 'as it is.fxs' a --levels --size 64x36 --quiet 2>logs/err
check "a folder of something else" equal "$? $(grep -c 'not empty' logs/err)" "1 1"
"$fixsplat" publish 'as it is.fxs' a/b/site --levels --size 64x36 --quiet >logs/out
"$fixsplat" convert 'as it is.fxs' levels-anew.fxs --levels
check "--levels too, in its own profile" cmp a/b/site/as-it-is.fxs levels-anew.fxs
check "what was there stays" [ -f site/knot.fxs ]
run publish knot.ply "it's a site" --size 64x36
check "what shows a folder of another name" grep -Fq ": python3 -m http.server -d 'it'\\''s a site'" logs/out
check "--profile" "$fixsplat" publish knot.ply whole --size 64x36 --profile default --quiet
"$fixsplat" convert knot.ply default.fxs
check "--profile: that one" equal "$(seen whole/knot.fxs) $(wc -c <whole/knot.fxs)" "$(seen default.fxs) $(wc -c <default.fxs)"
check "--title" "$fixsplat" publish knot.ply site --size 64x36 --title '<Knot> & "more"' --quiet
check "--title: as HTML has it" grep -q '<title>&#60;Knot&#62; &#38; &#34;more&#34;</title>' site/index.html
check "--title: in the corner of the page" grep -q ' label="&#60;Knot&#62; &#38; &#34;more&#34;" ' site/index.html

printf '{"fixsplat":1,"annotations":[{"position":[0,0,0],"title":"Middle"}],"background":"#102030"}\n' >tour.json
check "--settings" "$fixsplat" publish knot.ply told --size 64x36 --settings tour.json --quiet
check "--settings: beside the scene" cmp told/settings.json tour.json
check "--settings: the page reads them" grep -q '<fixsplat-viewer src="knot.fxs" label="knot" poster="knot.jpg" poster-frame="[0-9. ]*" settings="settings.json">' \
    told/index.html

check "--walk" "$fixsplat" publish knot.ply walked --size 64x36 --walk --quiet
check "--walk: the page reads the voxels" grep -q 'background="#000000" walls="knot.voxel.json">' walked/index.html
check "--walk: as collide makes them" "$fixsplat" collide walked/knot.fxs -o knot.voxel.json --quiet
check "--walk: the same bytes" sh -c 'cmp knot.voxel.json walked/knot.voxel.json && cmp knot.voxel.bin walked/knot.voxel.bin'
fails "--walk in a single file" 2 "--walk does not go with --single" publish --single knot.ply walk.html --walk
"$fixsplat" make-scene knot --count 400 -o dot.ply --quiet
fails "--walk of a scene without room" 1 "publish without --walk, or give a --start-view in a free place" \
    publish dot.ply walled --size 64x36 --walk --start-view 0,0,0,0,0,1 --quiet
check "--walk of a scene without room: nothing is left" [ ! -e walled ]

# ---- Several scenes --------------------------------------------------------------------------------------------------

mkdir scenes more && cp knot.ply 'a & b.ply' scenes && cp knot.ply more && cp knot.ply more/index.ply && echo >scenes/text.txt
"$fixsplat" publish scenes more list --size 64x36 >logs/out
check "folders of scenes" grep -q '^list: 4 scenes, 0.[0-9] MB with the page; ' logs/out
check "a page and a picture of each" equal "$(ls list | tr '\n' ' ')" "a---b.fxs a---b.html a---b.jpg fixsplat index-2.fxs \
index-2.html index-2.jpg index.html knot-2.fxs knot-2.html knot-2.jpg knot.fxs knot.html knot.jpg "
check "the list names each" equal "$(grep -o '<a href="[^"]*"' list/index.html | tr '\n' ' ')" \
    '<a href="a---b.html" <a href="knot.html" <a href="index-2.html" <a href="knot-2.html" '
check "by its own name" grep -q '>a &#38; b</a>' list/index.html
"$fixsplat" publish scenes list --size 64x36 --title All --quiet >logs/out
check "--title of several: of the list" grep -q '<title>All</title>' list/index.html
check "and each has its own name" grep -q '<title>a &#38; b</title>' list/a---b.html

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "no folder" 2 "publish takes scenes and a folder to write" publish knot.ply
fails "a scene for a folder" 2 "knot.ply is a scene: the last name is that of a folder" publish small.fxs knot.ply
fails "a folder of something else" 1 "scenes: not empty, and not a folder that publish made" publish knot.ply scenes
fails "no settings" 1 "none.json" publish knot.ply site --settings none.json
fails "settings of several" 2 "--settings is for one scene, not 2" publish knot.ply small.fxs new4 --settings tour.json
check "nothing is made then" [ ! -e new4 ]
fails "no scene" 1 "nothing.ply" publish nothing.ply new --quiet
head -c 200 knot.ply >short.ply
mkdir nothing
fails "a damaged scene" 1 "short.ply" publish short.ply new2 --quiet
check "nothing is left of it" [ ! -e new2 ]
mkdir -p kept && (cd site && find . | sort) >logs/site && cp site/knot.fxs kept
fails "a damaged scene behind another, in a folder of before" 1 "short.ply" publish 'as it is.fxs' short.ply site --quiet
check "what was there stays, and no more" sh -c '(cd site && find . | sort) | cmp - logs/site && cmp site/knot.fxs kept/knot.fxs'
fails "a damaged scene, in a folder of something else that is empty" 1 "short.ply" publish short.ply nothing/new --quiet
check "the folder stays" equal "$(ls -a nothing | tr '\n' ' ')" ". .. "
fails "a folder without scenes" 1 "nothing: no scene in this folder" publish nothing new3
mkdir -p 'of photos/images' && cp poster.jpg 'of photos/images'
fails "a folder of photographs" 1 \
    "of photos: a folder of photographs: fit a scene to them first: fixsplat fit 'of photos' -o scene.fxs" publish 'of photos' new3
fails "a file for a folder" 1 "knot.ply: not a folder" publish small.fxs knot.ply/site
FIXSPLAT_WEB=$work/nowhere fails "no page" 1 "FIXSPLAT_WEB=.*: the page is not there" publish knot.ply new3
check "nothing is made then" [ ! -e new3 ]
unset FIXSPLAT_WEB

# ---- Killed runs -----------------------------------------------------------------------------------------------------

export FIXSPLAT_WEB="$work/page"
faults=$work/logs/faults.so
if ${CC:-cc} -O1 -shared -fPIC -o $faults "$root/tests/scripts/lib/faults.c" -ldl 2>logs/err &&
    FAULT_LOG=logs/calls LD_PRELOAD=$faults "$fixsplat" --version >logs/out 2>&1 && [ -s logs/calls ]; then
    succeeds "not killed" publish knot.ply killed --size 64x36 --settings tour.json --quiet
    (cd killed && find . | sort) >logs/wanted
    for n in $(seq 6); do
        rm -r killed
        { FAULT_KILL=$n LD_PRELOAD=$faults "$fixsplat" publish knot.ply killed --size 64x36 --settings tour.json --quiet
            echo $? >logs/status; } 2>logs/shell
        check "killed at file $n" equal "$(cat logs/status)" 137
        echo mine >killed/mine
        fails "killed at file $n: a damaged scene" 1 "short.ply" publish short.ply killed --quiet
        check "killed at file $n: what is not of publish stays" equal "$(cat killed/mine)" mine
        rm killed/mine
        succeeds "killed at file $n: the same command goes on" publish knot.ply killed --size 64x36 --settings tour.json --quiet
        (cd killed && find . | sort) >logs/got
        check "killed at file $n: the folder is whole" cmp logs/got logs/wanted
    done
    rm -r killed && mkdir killed && echo mine >killed/mine
    fails "a folder of something else, without a mark" 1 "killed: not empty" publish knot.ply killed --quiet
else
    skip "killed" "nothing can be preloaded here: $(head -n 1 logs/err)"
fi
unset FIXSPLAT_WEB

# ---- Single-file pages -----------------------------------------------------------------------------------------------

echo licence >page/LICENSE
echo script >page/viewer/single.js
fails_single() { FIXSPLAT_WEB=$work/page fails "$@"; }
check "--single: into a new file" env FIXSPLAT_WEB="$work/page" "$fixsplat" publish --single knot.ply one.html --size 64x36 --quiet
check "--single: its name in the corner" grep -q '<fixsplat-viewer label="knot" ' one.html
sed -n 's/.*data-name="knot.fxs">\([A-Za-z0-9+\/=]*\).*/\1/p' one.html | base64 -d | gzip -d >unpacked.fxs
check "--single: the scene, packed small" cmp unpacked.fxs site/knot.fxs
fails_single "--single: several scenes" 2 "takes one scene, not 2" publish --single knot.ply small.fxs two.html
fails_single "--single: a folder" 2 "name ends in .html, not site" publish --single knot.ply site
fails_single "--single: a scene for a file" 2 "knot.ply is a scene: the last name is that of a file" publish --single small.fxs knot.ply
fails_single "--single: a damaged scene" 1 "short.ply" publish --single short.ply new.html
rm page/LICENSE
fails_single "--single: a page of an earlier version" 1 "page/LICENSE" publish --single knot.ply new.html
check "--single: nothing is written then" [ ! -e new.html ]

# ---- In a browser ----------------------------------------------------------------------------------------------------

cd "$root" || exit 1
kept=$work
. tests/scripts/lib/web.sh
trap 'rm -rf "$work" "$kept"' EXIT
needs "pages in Chromium" chromium -- puppeteer-core
check "builds" builds
"$fixsplat" publish "$kept/scenes" "$work/site" --size 640x360 --quiet >/dev/null
node tests/web/publish.mjs "$work/site" "$modules" "${PICTURES:-$work}" a---b knot >"$work/asked" 2>&1 ||
    echo "FAIL publish.mjs: a check above, or it ended early" >>"$work/asked"
"$fixsplat" publish "$kept/knot.ply" "$work/told" --size 640x360 --settings "$kept/tour.json" --quiet >/dev/null
node tests/web/publish.mjs "$work/told" "$modules" "${PICTURES:-$work}" knot >>"$work/asked" 2>&1 ||
    echo "FAIL publish.mjs: of settings" >>"$work/asked"
counts
"$fixsplat" publish --single "$kept/knot.ply" "$work/one.html" --title 'A knot' --quiet >/dev/null
node tests/web/single.mjs "$work/one.html" "$modules" "${PICTURES:-$work}" "$fixsplat" "$kept/small.fxs" >"$work/asked" 2>&1 ||
    echo "FAIL single.mjs: a check above, or it ended early" >>"$work/asked"
counts
check "size of what one file has beside scene and picture" [ "$(sed 's/base64,[^"]*"//; s/data-name=.*//' "$work/one.html" | wc -c)" -lt 743300 ]
mkdir "$work/served" && cp "$kept/knot.ply" "$work/served" && head -c 3000 "$kept/knot.ply" >"$work/served/bad.ply"
node tests/web/served.mjs "$fixsplat" "$work/served" "$modules" "${PICTURES:-$work}" >"$work/asked" 2>&1 ||
    echo "FAIL served.mjs: a check above, or it ended early" >>"$work/asked"
counts
finish
