#!/bin/sh
# Tests the command collide: files of a made room, the same bytes by any way to them, and refusals.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/splatv.sh"
. "$root/tests/scripts/lib/room.sh"

seed='--seed=-1.5,-1,0'
free_of() { sed 's/.*units, \([0-9]*\) free.*/\1/' logs/out; }

# ---- Files -----------------------------------------------------------------------------------------------------------

room room.ply
succeeds "a room" collide room.ply -o room.voxel.json --mesh $seed
check "a room: what is free" equal "$(cat logs/out)" \
    "room.voxel.json: 128 x 60 x 88 voxels of 0.05 units, 424804 free; 93864 of the scene absorb 0.1 or more"
check "a room: its files" equal "$(ls room.*)" "$(printf 'room.collision.glb\nroom.ply\nroom.voxel.bin\nroom.voxel.json')"
check "a room: the mesh is a .glb" equal "$(head -c 4 room.collision.glb)" glTF
sum=$(cat room.voxel.* room.collision.glb | cksum)
check "a room: the bytes on every machine" equal "$sum" "357699808 78087"
for threads in 1 3; do
    succeeds "--threads $threads" collide room.ply -o room.voxel.json --mesh $seed --threads $threads
    check "--threads $threads: the same bytes" equal "$(cat room.voxel.* room.collision.glb | cksum)" "$sum"
done
run convert room.ply room.fxs
succeeds "an .fxs" collide room.fxs -o room.voxel.json $seed
succeeds "a .glb" collide room.fxs -o room.collision.glb $seed
check "an .fxs: the same bytes" equal "$(cat room.voxel.* room.collision.glb | cksum)" "$sum"
succeeds "--quiet" collide room.fxs -o room.voxel.json --quiet
check "--quiet: nothing is printed" [ ! -s logs/out ]
succeeds "the camera of the first view" collide room.ply -o auto.voxel.json
check "the camera of the first view: in the room" cmp auto.voxel.bin room.voxel.bin
run convert room.ply start.fxs --start-view 1.5,-1,0.5,3,-1,0
succeeds "a start view" collide start.fxs -o start.voxel.json
check "a start view: in the other room" cmp start.voxel.bin room.voxel.bin
run collide room.ply -o wide.voxel.json $seed --radius 0.6
check "--radius: too wide for the door" at_least 220000 "$(free_of)"
run collide room.ply -o low.voxel.json $seed --height 2.3
check "--height: too high for the door" at_least 220000 "$(free_of)"
room narrow.ply '' 0.25
run collide narrow.ply -o narrow.voxel.json $seed
check "a door half as wide: shut" [ "$(free_of)" -lt 220000 ]
run collide narrow.ply -o narrow.voxel.json $seed --radius 0.1
check "a door half as wide: open for a thinner walker" at_least "$(free_of)" 420000
run collide narrow.ply -o narrow.voxel.json $seed --opacity 0.8
check "a door half as wide: open with thinner walls" at_least "$(free_of)" 420000
room nan.ply "nan 0 0 0 0 0 2 -2 -2 -2 1 0 0 0"
run collide nan.ply -o nan.voxel.json $seed
check "a NaN in the scene: a note" grep -q "fixsplat: nan.ply: left out 1 of" logs/err
check "a NaN in the scene: left out" cmp nan.voxel.bin room.voxel.bin

# ---- Refusals --------------------------------------------------------------------------------------------------------

fails "no output" 2 "collide needs -o" collide room.ply
fails "no scene" 2 "collide takes a scene" collide -o a.glb
fails "two scenes" 2 "collide takes one scene" collide room.ply room.fxs -o a.glb
fails "another ending" 2 "a.ply: expected a name ending in .voxel.json or .glb" collide room.ply -o a.ply
fails "--mesh of a mesh" 2 "mesh is for a .voxel.json" collide room.ply -o a.glb --mesh
fails "a seed in a wall" 1 "room.ply: the seed 0,-1,1.2 is inside of something solid$" \
    collide room.ply -o a.glb --seed 0,-1,1.2
fails "a seed outside" 1 "room.ply: the seed 0,-50,0 is outside of the box$" collide room.ply -o a.glb --seed 0,-50,0
fails "no free room" 1 "room.ply: the seed -1.5,-1,0 has no room for the capsule$" \
    collide room.ply -o a.glb $seed --height 3
fails "a voxel too small" 1 "room.ply: voxels of this size need up to .* MiB, more than 2048.0 MiB: make them larger$" \
    collide room.ply -o a.glb $seed --voxel 0.001 --radius 0.02 --height 1
fails "--max-memory" 1 "voxels of this size need up to .* more than 1.0 MiB" \
    collide room.ply -o a.glb $seed --max-memory 1M
fails "a voxel far too small" 1 "voxels of 2e-05 units need over .* MiB, more than 2048.0 MiB: make them larger$" \
    collide room.ply -o a.glb $seed --voxel 0.00002 --radius 0.0004 --height 0.01
fails "a radius of many voxels" 1 "at most 31 voxels: here 0.31 units" collide room.ply -o a.glb $seed --voxel 0.01 --radius 0.5
fails "a height below the radius" 1 "twice its radius" collide room.ply -o a.glb $seed --height 0.3
fails "no number" 2 "voxel" collide room.ply -o a.glb --voxel nan
fails "no point" 2 "seed" collide room.ply -o a.glb --seed 1,2,nan
fails "--time of a still scene" 1 "room.ply: does not move: no --time" collide room.ply -o a.glb --time 1
fails "an output that is the input" 2 "room.fxs" collide room.fxs -o room.fxs
fails "a missing folder" 1 "none/a.voxel" collide room.ply -o none/a.voxel.json $seed
awk 'BEGIN { for (i = 0; i < 500; i++) print i % 8, int(i / 8) % 8, int(i / 64), "0 0 0 -5.4 -1 -1 -1 1 0 0 0" }' >lines
{ sed -n '1,/end_header/p' room.ply | sed 's/vertex .*/vertex 500/'; cat lines; } >haze.ply
fails "haze" 1 "haze.ply: nothing is solid: no voxels side by side absorb 0.1 of the light: give --seed" \
    collide haze.ply -o a.glb
check "nothing is left of what was refused" equal "$(ls a.* none 2>/dev/null)" ''

# ---- Scenes that move ------------------------------------------------------------------------------------------------

splatv moving.splatv 300
fails "a scene that moves" 1 "moving.splatv: a scene that moves has no voxels: give --time SECONDS$" \
    collide moving.splatv -o a.glb
succeeds "--time" collide moving.splatv -o moved.voxel.json --time 0.3 --voxel 0.1 --seed=-1.5,0,0.3
run convert moving.splatv still.ply --time 0.3
succeeds "--time: as the moment" collide still.ply -o still.voxel.json --voxel 0.1 --seed=-1.5,0,0.3
check "--time: the voxels of the moment" cmp moved.voxel.bin still.voxel.bin
finish
