#!/bin/sh
# No option of render is ignored in silence: each option of the table changes an output in each place, or is refused
# with one line.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

"$fixsplat" make-scene knot --count 400 -o knot.ply >logs/out
"$fixsplat" make-scene knot --count 3000 -o 3000.ply >logs/out
"$fixsplat" convert knot.ply plain.fxs --quiet
"$fixsplat" convert knot.ply start.fxs --start-view 1,-2,-7,0.1,0.2,0,40 --quiet
"$fixsplat" convert 3000.ply levels.fxs --levels --quiet
camera='"width":64,"height":36,"rotation":[[1,0,0],[0,1,0],[0,0,1]],"fx":50,"fy":50'
echo "[{\"id\":0,\"img_name\":\"a\",\"position\":[0,-2,-9],$camera},{\"id\":1,\"img_name\":\"b\",\"position\":[1,-2,-9],
    $camera},{\"id\":2,\"img_name\":\"c\",\"position\":[2,-2,-9],$camera}]" >cameras.json
scenes='knot.ply plain.fxs start.fxs levels.fxs cameras.json'

# A place is a name and the arguments of render.
places='plain knot.ply -o out.png
start start.fxs -o out.png
cameras knot.ply --cameras cameras.json -o out.png
several knot.ply --cameras cameras.json --view all -o out%02d.png
frames knot.ply --cameras cameras.json --view all --frames 3 -o out.y4m
eye knot.ply --eye 0,-2,-9 -o out.png
orbit knot.ply --orbit 3 -o out.y4m
jpg knot.ply -o out.jpg
panorama knot.ply --panorama -o out.png
ortho knot.ply --ortho 4 -o out.png
tangents knot.ply --tangents -1,1,1,-1 -o out.png
stereo knot.ply --stereo 0.1 -o out.png
depth knot.ply --depth out.pfm
ids knot.ply --ids out.png
pick knot.ply --pick 32,18
levels levels.fxs -o out.png
two knot.ply plain.fxs -o out.png'

options='cameras cameras.json
view 1
eye 1,-2,-9
look 0,1,0
up 0.3,-1,0
auto-up
fov 30
tangents -1,1.2,1,-1
ortho 3
near 14
size 60x30
stereo 0.2
bg 303030
cutoff square
sh-degree 0
device 1
profile small
budget 1000
detail 4
place 0:0,0,0,0.5,0.5,0.5,0.5
scene world.json
lod 1
axes rdf
format ppm
quality 50
fps 12
orbit 4
frames 4
alpha
depth d.png
depth-kind mean
depth-range 20
ids i.png
pick 30,18
panorama
lens
scissor 0,0,32,18
hash
stats
json
diff diff.png
expect 0123456789abcdef'

# These change no output by design: how the work is done, limits, and words.
by_design='output threads max-memory cpu backend max-gaussians import-memory pool help version quiet'
# These change an output of other scenes: one that is not upright, cameras with lens distortion, a disc at the pixel's
# edge, and scenes with levels in several files.
of_other_scenes='auto-up:plain auto-up:jpg auto-up:tangents auto-up:ortho auto-up:stereo auto-up:depth auto-up:ids auto-up:pick
auto-up:levels auto-up:two auto-up:eye auto-up:orbit auto-up:panorama lens:cameras lens:several cutoff:pick lod:two'

named() { echo "$options" | cut -d ' ' -f 1; }
all_are_here() {
    for option in $("$fixsplat" help table | awk -F '\t' '$1 == "render" { print $2 }'); do
        case " $by_design $(named | tr '\n' ' ') " in *" $option "*) ;; *) echo "$option"; return 1 ;; esac
    done
}
check "every option of render is tried" all_are_here

# draw ARGUMENT...: renders in the folder drawn, and sets $status and $sum, the checksum of all that was written.
draw() {
    rm -rf drawn && mkdir drawn && (cd drawn && for scene in $scenes; do ln -s "../$scene" .; done &&
        "$fixsplat" render "$@" >out.txt 2>../logs/err)
    status=$?
    (cd drawn && rm -f $scenes)
    sum="$status $(cd drawn && ls && cat ./* | cksum)"
}

tried=0 refused=0
: >logs/silent
while read -r place arguments; do
    size=64x36
    [ "$place" != panorama ] || size=64x32
    draw $arguments --size $size
    [ "$status" = 0 ] || fail "$place" "$(cat logs/err)"
    before=$sum
    while read -r option value; do
        case " $arguments " in *" --$option "*) continue ;; esac
        tried=$((tried + 1))
        draw $arguments --size $size --$option $value
        if [ "$status" != 0 ] && [ "$(cat drawn/* | wc -c)" = 0 ]; then
            refused=$((refused + 1))
            [ "$(grep -c '^fixsplat: ' logs/err)" = 1 ] || echo "no line: $place --$option" >>logs/silent
        elif [ "$sum" = "$before" ]; then
            case " $(echo $of_other_scenes) " in *" $option:$place "*) ;; *) echo "$place: --$option" >>logs/silent ;; esac
        fi
    done <<END
$options
END
done <<END
$places
END
check "$tried pairs of an option and a place: $refused are refused, none is ignored" equal "$(cat logs/silent)" ''
finish
