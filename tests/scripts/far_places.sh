#!/bin/sh
# Checks that scenes far from the origin, as in UTM coordinates, keep their positions in all file formats.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

at=500000,4500000,0
back=--translate=-500000,-4500000,0
near_view='--size 200x150 --eye 1,-2,-7 --look 0.5,0.25,0'
far_view='--size 200x150 --eye 500001,4499998,-7 --look 500000.5,4500000.25,0'

rows() {
    awk -v type="$2" -v x="$3" -v y="$4" '
        function random() { seed = (seed * 16807) % 2147483647; return seed / 2147483647 }
        BEGIN {
            seed = 7
            printf "ply\nformat ascii 1.0\nelement vertex 1200\n"
            n = split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", names, " ")
            for (i = 1; i <= n; i++)
                printf "property %s %s\n", i < 4 ? type : "float", names[i]
            print "end_header"
            for (i = 0; i < 1200; i++) {
                for (k = 0; k < 3; k++)
                    p[k] = int(random() * 16384) / 4096 - 2
                printf "%.12f %.12f %.12f", x + p[0], y + p[1], p[2]
                printf " %.6f %.6f %.6f", random() * 3 - 1.5, random() * 3 - 1.5, random() * 3 - 1.5
                printf " 2 %.6f %.6f %.6f", random() - 4, random() - 4, random() - 4
                printf " %.6f %.6f %.6f %.6f\n", random() - 0.5, random() - 0.5, random() - 0.5, random() + 0.1
            }
        }' >"$1"
}

picture() { "$fixsplat" render "$@" -o "$picture" --quiet; }
same() {
    name=$1
    shift
    picture=other.png
    check "$name" picture "$@"
    check "$name: the plain scene's picture" cmp plain.png other.png
}

rows plain.ply float 0 0
rows text.ply double 500000 4500000
rows float.ply float 500000 4500000
cat >far.json <<'END'
[{"img_name": "a", "width": 200, "height": 150, "fx": 180, "fy": 180, "cx": 100, "cy": 75,
  "position": [500001, 4499998, -7], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]
END
sed 's/500001, 4499998/1, -2/' far.json >near.json
picture=plain.png
check "the plain scene" picture plain.ply $near_view
succeeds "the plain scene again" convert plain.ply again.ply
check "the plain scene has floats" grep -aq "property float x" again.ply

# ---- Reading and writing ---------------------------------------------------------------------------------------------

succeeds "text to doubles" convert text.ply far.ply
check "doubles in the file" sh -c 'grep -aq "property double y" far.ply && grep -aq "property float nx" far.ply'
same "doubles" far.ply $far_view
same "text of floats" float.ply $far_view
picture=plain-camera.png
picture plain.ply --cameras near.json
picture=far-camera.png
picture far.ply --cameras far.json
check "a camera file" cmp plain-camera.png far-camera.png
for ending in fxs glb; do
    succeeds ".$ending" convert far.ply far.$ending
    same ".$ending" far.$ending $far_view
done
succeeds ".csv" convert far.ply far.csv
succeeds ".csv of the plain scene" convert plain.ply plain.csv
less() { awk -F, -v x="$2" -v y="$3" 'NR > 1 { printf "%.6f %.6f %.6f\n", $1 - x, $2 - y, $3 }' "$1"; }
check ".csv: 1200 places" equal "$(less far.csv 500000 4500000)" "$(less plain.csv 0 0)"
check ".glb: a node" grep -aq '"translation":\[-500000,-4500000,0\]' far.glb
for ending in splat spz sog compressed.ply rad; do
    run convert far.ply far.$ending
    check ".$ending: a line" says "far.$ending: single precision moves positions so far out by up to 0.25 units; \
nothing is lost with --translate -500000,-4500000,0"
done
prints() {
    words=$1
    shift
    "$fixsplat" "$@" | grep -q "$words"
}
check "info: true coordinates" prints "^bounds  *499998 4499998.002 .* 4500001.993 " info far.fxs
check "info --json" prints '"bounds": \[\[499998, 4499998.002, .*, 4500001.993, ' info far.glb --json
check "info --stats" prints "^y  *4499998[0-9.]* " info far.ply --stats
check "info --compare" looks_as far.fxs far.glb 50
check "--pick" prints '"position": \[50000[0-9.]*, 4[45][0-9]*\.[0-9]*,' render far.fxs --cameras far.json --pick 100,110 \
    --json

# ---- Placing ---------------------------------------------------------------------------------------------------------

"$fixsplat" convert plain.ply plain.fxs
for scene in text.ply far.ply far.glb; do
    succeeds "--translate back: $scene" convert $scene back.fxs $back
    check "--translate back: the plain scene's bytes: $scene" cmp plain.fxs back.fxs
done
succeeds "--translate back: .fxs" convert far.fxs back.fxs $back
succeeds "the plain .fxs again" convert plain.fxs again.fxs
picture=back.png
picture back.fxs $near_view
picture=again.png
picture again.fxs $near_view
check "--translate back: .fxs: the same picture" cmp back.png again.png
same "--place" plain.ply --place plain.ply:$at $far_view
same "--place back" far.ply --place far.ply:-500000,-4500000,0 $near_view
for ending in fxs ply glb; do
    succeeds "--translate out: .$ending" convert plain.ply out.$ending --translate $at
    same "--translate out: .$ending" out.$ending $far_view
done
succeeds "--place in convert" convert plain.ply out.fxs --place plain.ply:$at
same "--place in convert" out.fxs $far_view
succeeds "--scale and --rotate" convert far.ply turned.fxs --rotate 0,0,90 --scale 0.5
succeeds "and back" convert turned.fxs back.ply --rotate 0,0,-90 --scale 2
check "and back: as before" looks_as back.ply far.ply 50
run convert plain.ply far.ply both.fxs
check "one far from the other: a line" grep -qx "fixsplat: plain.ply: parts are so far from the others that single \
precision places them in steps of up to 0.5 units; objects of a world (--scene, --place of render) keep their \
places" logs/err
awk 'NR <= 18 || NR % 6 { print; next } { $1 -= 500000; $2 -= 4500000; print }' text.ply >mixed.ply
run convert mixed.ply mixed.csv
check "of one file: a line" says "mixed.ply: parts are so far from the others that single precision places them in \
steps of up to 0.5 units; objects of a world (--scene, --place of render) keep their places"
succeeds "two far out" convert far.ply plain.ply both.csv --place plain.ply:500010,4500000,0
check "two far out: all places" equal "$(sort -u both.csv | wc -l)" 2401

# Positions must be exact for most Gaussians, although a third of them are a sky, 200000 units away on one side.
awk 'NR > 18 && NR % 3 == 0 { $1 = -200000 - NR; $8 = $9 = $10 = 8 } { print }' plain.ply >sky.ply
nearby() {
    "$fixsplat" convert "$1" nearby.csv --quiet "$2"
    awk -F, 'NR > 1 && $1 > -9 { printf "%.4f %.4f %.4f\n", $1, $2, $3 }' nearby.csv | sort >"$3"
}
nearby sky.ply --translate=0,0,0 sky.places
"$fixsplat" convert sky.ply sky.fxs && "$fixsplat" convert sky.fxs sky-again.ply
check "a sky beside a scene: floats" grep -aq "property float x" sky-again.ply
"$fixsplat" convert sky.ply moved.ply --translate 5000,0,0
nearby moved.ply --translate=-5000,0,0 moved.places
check "a sky beside a scene: places" cmp sky.places moved.places
"$fixsplat" convert float.ply floats.ply
nearby floats.ply $back floats.places
nearby plain.ply --translate=0,0,0 plain.places
check "text of floats: places" cmp plain.places floats.places

# ---- Filtering, levels, parts ----------------------------------------------------------------------------------------

"$fixsplat" convert plain.ply crop.ply --crop -1,-1,-1,1,1,1 --quiet && "$fixsplat" convert crop.ply crop.fxs
"$fixsplat" convert far.ply far-crop.ply --crop 499999,4499999,-1,500001,4500001,1 --quiet
succeeds "--crop" convert far-crop.ply back.fxs $back
check "--crop: the plain scene's bytes" cmp crop.fxs back.fxs
"$fixsplat" convert plain.ply tree.fxs --levels --refine=2
"$fixsplat" convert far.ply far-tree.fxs --levels --refine=2
picture=tree.png
picture tree.fxs $near_view --detail 6
picture=far-tree.png
picture far-tree.fxs $far_view --detail 6
check "levels: the plain scene's picture" cmp tree.png far-tree.png
succeeds "--decimate" convert far.ply few.fxs --decimate 600
check "--decimate: bounds" prints "^bounds  *49999[789]" info few.fxs
fails "--block" 1 "a scene so far out is not packed in blocks; .*--translate -500000,-4500000,0" \
    convert far.ply part.fxs --block 1/2
check "--block: nothing is written" [ ! -e part.fxs ]

# ---- 3D Tiles --------------------------------------------------------------------------------------------------------

mkdir tiles
"$fixsplat" convert plain.ply tiles/tile.glb
cat >tiles/tileset.json <<'END'
{"asset": {"version": "1.1"}, "geometricError": 1, "root": {"refine": "ADD", "geometricError": 0,
 "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, -500000,0,-450000,1], "content": {"uri": "tile.glb"}}}
END
same "a tileset" tiles --size 200x150 --eye 500001,449998,-7 --look 500000.5,450000.25,0
succeeds "a tileset: --translate back" convert tiles back.fxs --translate=-500000,-450000,0
check "a tileset: the plain scene's places" looks_as back.fxs plain.fxs 60
finish
