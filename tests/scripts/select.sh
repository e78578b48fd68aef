#!/bin/sh
# Tests the command select: two balls on a floor, found by masks, labels, clicks and boxes; and refusals.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/splatv.sh"
. "$root/tests/scripts/lib/ply.sh"

# balls FILE WHITE RED: two balls of 400 Gaussians, a white and a red one, if WHITE and RED are 1, above a grey floor.
balls() {
    awk -v white="$2" -v red="$3" '
        function ball(x, colour,    i, turn, y, wide) {
            for (i = 0; i < 400; i++) {
                turn = 2.399963 * i; y = 1 - (2 * i + 1) / 400; wide = sqrt(1 - y * y)
                p = (x + 0.8 * wide * cos(turn)) " " (0.8 * y - 0.85) " " (0.8 * wide * sin(turn))
                print p " " colour " 4 -2.4 -2.4 -2.4 1 0 0 0"
            }
        }
        BEGIN {
            if (white) ball(-1, "2 2 2")
            if (red) ball(1, "0.5 -1.5 -1.5")
            for (i = 0; i < 900; i++)
                print (0.2 * (i % 30) - 3) " 0.05 " (0.2 * int(i / 30) - 3) " -1 -1 -1 4 -2.1 -5 -2.1 1 0 0 0"
        }' | ply "$1"
}
ids() { "$fixsplat" select "$@" --trim 0 --ids --quiet | uniq -c | awk '{ printf "%s%d x %d", s, $1, $2; s = ", " }'; }

balls two.ply 1 1
balls white.ply 1 0
view() {
    size='"width":200,"height":150,"fx":200,"fy":200'
    echo "{\"id\":$1,\"img_name\":\"$1\",$size,\"position\":[$2],\"rotation\":[[$3],[$4],[$5]]}"
}
front=$(view 0 0,-4,-5 1,0,0 0,0.8,0.6 0,-0.6,0.8) back=$(view 1 0,-4,5 -1,0,0 0,0.8,0.6 0,0.6,-0.8)
echo "[$front,$back]" >cameras.json
echo "[$front,$(view 2 0,-4,-5 1,0,0 0,0.8,0.6 0,-0.6,0.8)]" >same.json
mkdir masks
for i in 0 1; do
    run render white.ply --cameras cameras.json --view $i -o masks/$i.png
done

by='--cameras cameras.json'
# ---- Objects ---------------------------------------------------------------------------------------------------------

all='400 x 1, 1300 x 0'
check "masks" equal "$(ids two.ply $by --masks masks)" "$all"
check "a click" equal "$(ids two.ply $by --click 65,58)" "$all"
check "a click in another view" equal "$(ids two.ply $by --click 1:135,58)" "$all"
check "--view" equal "$(ids two.ply $by --click 135,58 --view 1)" "$all"
# A box may take a few Gaussians of the floor behind the ball.
balls_of() { "$fixsplat" select two.ply $by "$@" --trim 0 --ids --quiet | head -n 800 | uniq -c | tr -s ' \n' ' '; }
check "a box" equal "$(balls_of --around 22,15,104,98)" ' 400 1 400 0 '
check "a box: little of the floor" [ "$("$fixsplat" select two.ply $by --around 22,15,104,98 --trim 0 --ids --quiet |
    grep -c 1)" -lt 420 ]
check "two objects" equal "$(ids two.ply $by --click 135,58,2 --click 65,58,1)" \
    '400 x 1, 400 x 2, 900 x 0'
check "two clicks on one object" equal "$(ids two.ply $by --click 135,58 --click 65,58)" \
    '800 x 1, 900 x 0'
check "--not" equal "$(balls_of --around 22,15,178,98 --not 135,58)" ' 400 1 400 0 '
few=$(ids two.ply $by --masks masks --alone)
check "--alone: hidden Gaussians are in no object" [ "$few" != "$all" ]
count() { "$fixsplat" select two.ply $by --masks masks --alone --trim 0 --ids --quiet "$@" | grep -c 1; }
check "--bias: fewer" [ "$(count --bias 0.9)" -lt "$(count)" ]
for threads in 1 3; do
    check "--threads $threads" equal "$(ids two.ply $by --masks masks --alone --threads $threads)" "$few"
done
succeeds "an object and the rest" select two.ply $by --masks masks -o white.ply --rest rest.fxs --quiet
check "the object" gaussians white.ply 400 0
check "the rest" gaussians rest.fxs 1300 0
run select two.ply $by --around 22,15,104,98 -o trimmed.ply --rest less.ply --trim 0.6
left=$(($("$fixsplat" info trimmed.ply --json | tr ', ' '\n\n' | sed -n '/"gaussians":/{n;p;q}') +
    $("$fixsplat" info less.ply --json | tr ', ' '\n\n' | sed -n '/"gaussians":/{n;p;q}')))
check "--trim: what is on the border is in neither" [ "$left" -lt 1700 ]
check "--trim: the object is still there" gaussians trimmed.ply 400 0
run select two.ply $by --click 65,58 -o thing.fxs --picture seen.png
check "a note" says "two.ply: object 1: 400 of 1700 Gaussians"
check "an .fxs: a start view that shows it" "$fixsplat" render thing.fxs -o thing.png --size 64x64 --quiet
check "a picture" [ -s seen.png ]
succeeds "objects by number" select two.ply $by --click 65,58 --click 135,58,2 -o 'thing-%d.ply' --quiet
check "object 2" gaussians thing-2.ply 400 0
run convert two.ply two.fxs
check "an .fxs" equal "$("$fixsplat" select two.fxs $by --masks masks --ids --quiet | grep -c 1)" 400
from='--eye 0,-4,-5 --look 0,-0.5,0 --fov 40 --size 200x150'
check "without cameras" equal "$(ids two.ply $from --click 65,66)" "$all"

# ---- Refusals --------------------------------------------------------------------------------------------------------

fails "no output" 2 "what for" select two.ply --click 1,2
fails "nothing marked" 2 "what\? Give" select two.ply --picture a.png
fails "no scene" 2 "takes a scene" select --click 1,2 --picture a.png
fails "masks without cameras" 2 "masks" select two.ply --masks masks -o a.ply
fails "a view without cameras" 1 "3: a view of --cameras" select two.ply --click 3:1,2 -o a.ply
fails "no such view" 1 "no view '7'" select two.ply $by --click 7:1,2 -o a.ply
fails "a click outside" 1 "250,20: a click or a box outside of the picture of 200 x 150" \
    select two.ply $by --click 250,20 -o a.ply
fails "a click on nothing" 1 "5,5: nothing is there, or only haze" select two.ply $by --click 5,5 -o a.ply
fails "an empty box" 1 "nothing in the box stands out" select two.ply $by --around 1,1,9,9 -o a.ply
fails "a box upside down" 2 "around" select two.ply $by --around 9,9,1,1 -o a.ply
fails "only something else" 1 "no object is marked" select two.ply $by --not 65,58 -o a.ply
fails "object 201" 2 "click" select two.ply $by --click 65,58,201 -o a.ply
fails "object 2 without 1" 1 "object 1: no pixel" select two.ply $by --click 65,58,2 -o 'a-%d.ply'
fails "two objects, one name" 2 "2 objects need a name" \
    select two.ply $by --click 65,58 --click 135,58,2 -o a.ply
fails "no bias" 2 "bias" select two.ply --click 1,2 -o a.ply --bias 2
fails "another ending" 2 "a.png: expected a scene" select two.ply --click 1,2 -o a.png
fails "an output that is the input" 2 "two.ply" select two.ply $by --click 65,58 -o two.ply
fails "--max-memory" 1 "two.ply: out of memory" select two.ply $by --click 65,58 -o a.ply --max-memory 1K
fails "no masks" 1 "none: no mask of a view of cameras.json; that of 0 is 0.png" \
    select two.ply $by --masks none -o a.ply
mkdir small black
run render white.ply --size 64x48 -o small/0.png
fails "a mask of another size" 1 "small/0.png: 64 x 48 pixels, but its view has 200 x 150" \
    select two.ply $by --masks small -o a.ply
run render two.ply $by --view 0 --near 1000 -o black/0.png
fails "a black mask" 1 "object 1: no pixel of a picture is marked" \
    select two.ply $by --masks black -o a.ply
mkdir against
cp masks/0.png against/0.png
cp black/0.png against/2.png
fails "masks that contradict" 1 "object 1: its marks show no Gaussian more than other marks do" \
    select two.ply --cameras same.json --masks against -o a.ply
splatv moving.splatv 300
fails "a scene that moves" 1 "moving.splatv: a scene that moves" select moving.splatv --click 1,2 -o a.ply
awk 'BEGIN { for (i = 0; i < 500; i++) print i % 8, int(i / 8) % 8, int(i / 64), "0 0 0 -5.4 -1 -1 -1 1 0 0 0" }' >lines
{ sed -n '1,/end_header/p' two.ply | sed 's/vertex .*/vertex 500/'; cat lines; } >haze.ply
fails "haze" 1 "nothing is there, or only haze" select haze.ply --click 640,360 -o a.ply
check "nothing is left of what was refused" equal "$(ls a.* a-* 2>/dev/null)" ''
finish
