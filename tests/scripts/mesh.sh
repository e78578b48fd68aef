#!/bin/sh
# Tests `fixsplat mesh`: files, options, the same bytes however the work is done, and errors.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/moving_set.sh"
. "$root/tests/scripts/lib/splatv.sh"

make_moving_scenes
small='--resolution 48 --views 24 --parts 20 --from outside'
sum_of() {
    rm -f "$last.made"
    run mesh "$@" $small -o "$last.made.$last"
    [ $status = 0 ] || cat logs/err
    cksum <"$last.made.$last"
}

# ---- Formats ---------------------------------------------------------------------------------------------------------

for format in glb ply obj; do
    run mesh ball.ply $small -o made.$format
    check "$format: it is written" equal $status 0
    check "$format: what is said" grep -Eq "^fixsplat: made.$format: [0-9]+ triangles, [0-9]+ vertices, 1 part\$" \
        logs/err
done
triangles=$(sed -n 's/.*: \([0-9]*\) triangles.*/\1/p' logs/err)
vertices=$(sed -n 's/.*triangles, \([0-9]*\) vertices.*/\1/p' logs/err)
check "a closed ball: Euler's formula" equal $((vertices - triangles * 3 / 2 + triangles)) 2
check "ply: counts" equal "$(head -c 400 made.ply | grep -a '^element' | tr '\n' ' ')" \
    "element vertex $vertices element face $triangles "
check "ply: size" equal "$(wc -c <made.ply)" \
    $(($(head -c 600 made.ply | grep -a -b -o end_header | cut -d: -f1) + 11 + 27 * vertices + 13 * triangles))
check "obj: counts" equal "$(cut -d' ' -f1 made.obj | sort | uniq -c | tr -s ' \n' ' ')" \
    " 1 # $triangles f $vertices v $vertices vn "
radius() { awk '$1 == "v" { s += sqrt($2^2 + $3^2 + $4^2); n++ } END { printf "%.3f", s / n }' "$1"; }
check "obj: a radius of 1" awk "BEGIN { exit !($(radius made.obj) > 0.98 && $(radius made.obj) < 1.02) }"
"$fixsplat" --quiet mesh ball.ply $small --scale 2.5 -o big.obj
check "--scale: a radius of 2.5" awk "BEGIN { exit !($(radius big.obj) > 2.45 && $(radius big.obj) < 2.55) }"
check "obj: normals point outwards" awk '$1 == "v" { x = $2; y = $3; z = $4 }
    $1 == "vn" { n++; if (x * $2 + y * $3 + z * $4 < 0.7) bad++ } END { exit !(n > 1000 && bad * 100 < n) }' made.obj

glb() { python3 - "$@" <<'END'
import json, struct, sys
data = open(sys.argv[1], 'rb').read()
magic, version, length, size, kind = struct.unpack('<4sIII4s', data[:20])
document = json.loads(data[20:20 + size])
chunk, binary = struct.unpack('<I4s', data[20 + size:28 + size])
assert (magic, version, length, kind, binary) == (b'glTF', 2, len(data), b'JSON', b'BIN\0')
assert chunk == document['buffers'][0]['byteLength'] == len(data) - 28 - size and not size % 4
first = 28 + size
def values(number):
    a = document['accessors'][number]
    letter = {5126: 'f', 5125: 'I', 5123: 'H'}[a['componentType']]
    width = {'SCALAR': 1, 'VEC3': 3, 'VEC4': 4}[a['type']]
    at = first + document['bufferViews'][a['bufferView']]['byteOffset']
    flat = struct.unpack_from('<%d%s' % (a['count'] * width, letter), data, at)
    return [flat[i:i + width] for i in range(0, len(flat), width)]
names = document['meshes'][0]['primitives'][0]['attributes']
places, normals, colours = (values(names[n]) for n in ('POSITION', 'NORMAL', 'COLOR_0'))
corners = [i[0] for i in values(document['meshes'][0]['primitives'][0]['indices'])]
assert len(places) == len(normals) == len(colours) == max(corners) + 1
a = document['accessors'][0]
for k in range(3):
    assert abs(min(p[k] for p in places) - a['min'][k]) < 1e-6 and abs(max(p[k] for p in places) - a['max'][k]) < 1e-6
assert all(abs(sum(x * x for x in n) - 1) < 1e-4 for n in normals) and all(c[3] == 65535 for c in colours)
print(len(places), len(corners) // 3, *('%.1f' % x for x in a['max']))
END
}
if have python3; then
    check "glb: by its own reader" equal "$(glb made.glb)" "$vertices $triangles 1.0 1.0 1.0"
    "$fixsplat" --quiet mesh ground.ply crate.ply --place crate.ply:0,0,2 $small -o up.glb --up 0,0,1
    check "glb: --up becomes y" equal "$(glb up.glb | cut -d' ' -f4)" 3.0
else
    skip "glb" "no python3 here"
fi

# ---- The same bytes --------------------------------------------------------------------------------------------------

last=ply
same=$(sum_of crate.ply --threads 1)
for how in '--threads 3' '--cpu c' '--cpu c --threads 2' '--max-memory 64M'; do
    check "$how: the same mesh" equal "$(sum_of crate.ply $how)" "$same"
done
for backend in vulkan gles-compute; do
    if "$fixsplat" info --backends | grep -Eq "^ *$backend .*(not|no |cannot)"; then
        skip "--backend $backend" "not here"
    else
        run mesh crate.ply $small --backend $backend -o gpu.ply
        if [ $status = 0 ]; then check "--backend $backend: the same mesh" equal "$(cksum <gpu.ply)" "$same"
        else skip "--backend $backend" "$(cat logs/err)"; fi
    fi
done
last=glb
check "glb: --triangles with other threads" equal "$(sum_of crate.ply --triangles 500 --threads 3)" \
    "$(sum_of crate.ply --triangles 500 --threads 1)"

# ---- Options ---------------------------------------------------------------------------------------------------------

run mesh ball.ply $small --triangles 300 -o few.obj
check "--triangles: 300" grep -q ': 300 triangles, 152 vertices, 1 part$' logs/err
closed() {
    awk '$1 == "f" { split($2, a, "/"); split($3, b, "/"); split($4, c, "/")
        e[a[1] " " b[1]]++; e[b[1] " " c[1]]++; e[c[1] " " a[1]]++ }
        END { for (k in e) { split(k, v, " "); n++; if (e[k] != e[v[2] " " v[1]]) open = 1 } exit open || !n }' "$1"
}
run mesh ground.ply crate.ply ball.ply --place crate.ply:0,0,-2 --place ball.ply:0,0,3 --watertight $small -o three.obj
check "--watertight: no open edges" closed three.obj
"$fixsplat" --quiet mesh ball.ply $small --box -2,-2,-2,2,2,0 -o half.obj
check "--box: nothing beyond" awk '$1 == "v" && $4 > 0.05 { bad = 1 } END { exit bad }' half.obj
camera='"width":160,"height":160,"fx":140,"fy":140'
echo "[{\"id\":0,\"img_name\":\"a\",\"position\":[0,0,-4],\"rotation\":[[1,0,0],[0,1,0],[0,0,1]],$camera},
    {\"id\":1,\"img_name\":\"b\",\"position\":[0,0,4],\"rotation\":[[-1,0,0],[0,1,0],[0,0,-1]],$camera}]" >two.json
"$fixsplat" --quiet mesh crate.ply --cameras two.json --resolution 48 --parts 20 -o sides.obj
check "--cameras: two sides are seen" awk '$1 == "v" { a += $4 < -0.9; b += $4 > 0.9 }
    END { exit !(a > 500 && b > 500) }' sides.obj
"$fixsplat" --quiet mesh crate.ply --cameras two.json --view b --resolution 48 --parts 20 -o side.obj
check "--view: one side is seen" awk '$1 == "v" && $4 < 0 { bad = 1 } END { exit bad }' side.obj
open() { ! closed "$1"; }
check "--cameras: one side of a crate is open" open side.obj
behind='--place ground.ply:0,0,-9,1,0,0,0,4'
run mesh crate.ply ground.ply $behind --cameras two.json --unbounded --resolution 48 --parts 20 -o far.obj
check "--unbounded: the crate, and the ground beyond the cameras" awk '$1 == "v" { crate += $4 < -0.9 && $4 > -1.1
    far += $4 < -8.5 } END { exit !(crate > 100 && far > 100) }' far.obj
for how in '--threads 3' '--cpu c --threads 1'; do
    run mesh crate.ply ground.ply $behind --cameras two.json --unbounded --resolution 48 --parts 20 -o again.obj $how
    check "--unbounded: the same bytes, $how" cmp far.obj again.obj
done
run mesh crate.ply ground.ply $behind --cameras two.json --unbounded --watertight --triangles 3000 --resolution 48 -o far.obj
check "--unbounded --watertight: no open edges" closed far.obj
run mesh crate.ply ground.ply --unbounded $small -o far.obj
check "--unbounded without cameras" test -s far.obj
splatv moving.splatv 300
run mesh moving.splatv $small --parts 0 --time 0.2 -o moving.ply
check "--time: a moment of a scene that moves" test -s moving.ply

# ---- Measure ---------------------------------------------------------------------------------------------------------

# A field of the JSON of info, and a check that it is near a truth, by a share.
field() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" logs/out; }
near() { awk -v x="$1" -v truth="$2" -v share="$3" 'BEGIN { exit !(x > truth * (1 - share) && x < truth * (1 + share)) }'; }

for format in glb ply obj; do
    succeeds "info of a mesh, .$format" info made.$format --json
    check "its counts" equal "$(field triangles) $(field vertices) $(field parts)" "$triangles $vertices 1"
    check "its volume" near "$(field volume)" 4.18879 0.03
    check "its area" near "$(field area)" 12.56637 0.03
done
succeeds "info --distance" info made.obj --distance 0,0,-1,0.8,0,0.6 -o way.obj --json
check "along a ball: acos(-0.6)" near "$(field along)" 2.2143 0.02
check "the straight line" near "$(field straight)" 1.7889 0.02
check "the way has this length" near "$(awk '$1 == "v" { if (n++) s += sqrt(($2 - x)^2 + ($3 - y)^2 + ($4 - z)^2)
    x = $2; y = $3; z = $4 } END { print s }' way.obj)" "$(field along)" 0.00001
check "the way is one line" equal "$(grep -c '^l 1 2' way.obj)" 1
succeeds "info of an open mesh" info half.obj
check "no volume" grep -Eq '^volume        none, open: [0-9]+ edges$' logs/out

# A thing cut out of a scene of two, closed, and measured.
"$fixsplat" --quiet convert crate.ply ball.ply two.ply --place ball.ply:0,0,3
"$fixsplat" --quiet convert two.ply thing.fxs --crop -1.5,-1.5,-1.5,1.5,1.5,1.5
"$fixsplat" --quiet mesh thing.fxs --watertight $small -o thing.glb
succeeds "info of a thing that was cut out" info thing.glb --json
check "the crate: closed" equal "$(field closed) $(field parts)" "true 1"
check "the crate: a volume of 8" near "$(field volume)" 8 0.03
check "the crate: an area of 24" near "$(field area)" 24 0.05

# The voxels that are free are the volume of the mesh of `collide`.
run collide crate.ply -o room.glb --voxel 0.1 --seed 0,0,-2.5 --height 0.6
free=$(sed -n 's/.* units, \([0-9]*\) free.*/\1/p' logs/out)
succeeds "info of the mesh of collide" info room.glb --json
check "its volume is that of the free voxels" near "$(field volume)" "$(awk "BEGIN { print -$free * 0.001 }")" -0.000001

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "--distance of a scene" 2 '^fixsplat: --distance is for a mesh: make one with fixsplat mesh$' \
    info ball.ply --distance 0,0,0,1,1,1
fails "--distance, one point" 2 'two points' info made.obj --distance 0,0,0
fails "-o without --distance" 2 'output' info made.obj -o a.obj
fails "another option of a mesh" 2 'made.obj is a mesh: leave out --stats$' info made.obj --stats
fails "parts that are not joined" 1 '^fixsplat: three.obj: the points lie on parts of the mesh that are not joined$' \
    info three.obj --distance 0,0,-3,0,0,4 -o a.obj
fails "--import-memory" 1 'beyond the limit of 1024' info made.obj --import-memory 1K
fails "-o: the mesh" 2 'made.obj' info made.obj --distance 0,0,0,1,0,0 -o made.obj
fails "no output" 2 'where to' mesh ball.ply
fails "another ending" 2 'a.stl: expected a name ending in .glb, .ply or .obj$' mesh ball.ply -o a.stl
fails "a scene that moves" 2 'moving.splatv: a scene that moves: give --time$' mesh moving.splatv -o a.glb
fails "--time of a still scene" 1 'ball.ply: does not move: no --time$' mesh ball.ply --time 1 -o a.glb
fails "--backend without depths" 2 '--backend gles has colours only' mesh ball.ply --backend gles -o a.glb
fails "--up of an .obj" 2 'keeps the axes' mesh ball.ply --up 0,0,1 -o a.obj
fails "--box, turned round" 2 'box' mesh ball.ply --box 1,1,1,0,0,0 -o a.glb
fails "--view without --cameras" 2 'view' mesh ball.ply --view 1 -o a.glb
fails "--from with --cameras" 2 'from' mesh ball.ply --cameras two.json --from inside -o a.glb
words='^fixsplat: --resolution 256: the mesh takes [0-9]+ MB, more than the limit of 4 MB; about [0-9]+ fits$'
fails "too little memory for voxels" 1 "$words" \
    mesh ball.ply --resolution 256 --max-memory 4M -o a.glb
fails "too little memory for the grid" 1 'more than the limit' mesh ball.ply --resolution 2048 --max-memory 1M -o a.glb
awk '/^end_header/ { on = 1; print; next } on { $7 = -4 } { print }' ball.ply >haze.ply
fails "haze" 1 'haze.ply: the views show haze only' mesh haze.ply $small -o a.glb
sed 's/"position":\[0,0,/"position":[0,50,/g' two.json >aside.json
fails "no camera sees anything" 1 'ball.ply: no view shows a Gaussian' mesh ball.ply --cameras aside.json -o a.glb
fails "a box elsewhere" 1 'ball.ply: ' mesh ball.ply --cameras two.json --box 7,7,7,8,8,8 -o a.glb
fails "--parts: all are too small" 1 'no surface has 9999999 triangles' \
    --quiet mesh ball.ply $small --parts 9999999 -o a.glb
check "errors leave no file" [ ! -e a.glb ] && check "and no other" [ ! -e a.obj ]
"$fixsplat" --quiet mesh ball.ply $small -o nowhere/a.glb 2>logs/err
check "a folder that is missing: one line" equal "$(wc -l <logs/err)" 1
finish
