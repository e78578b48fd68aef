#!/bin/sh
# Tests `fixsplat convert --block`. Parts of a scene that are packed separately and merged must have the same bytes as
# the scene packed in one run.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

succeeds "scene" make-scene landscape --count 20000 -o scene.ply
succeeds "another" make-scene knot --count 20000 -o other.ply
for profile in default compact small; do
    for levels in "" --levels; do
        run convert scene.ply one.fxs --quiet --profile $profile $levels
        for n in 1 2 3 7; do
            rm -f part-*.fxs all.fxs
            for i in $(seq $n); do
                run convert scene.ply part-$i.fxs --profile $profile $levels --block $i/$n
            done
            run convert part-*.fxs all.fxs $levels
            check "$profile $levels, $n parts: the bytes of one run" cmp all.fxs one.fxs
        done
    done
done

rm -f all.fxs
refused() {
    fails "$@"
    check "$1: nothing is written" test ! -e all.fxs
}
for bad in 0/2 3/2 1/0 x 1/513 1 /2 1/ 1/2/3; do
    refused "--block $bad" 2 "expected I/N" convert scene.ply all.fxs --block $bad
done
refused "more parts than chunks" 1 "500 blocks of a scene that has [0-9]* chunks" convert scene.ply all.fxs --block 1/500
refused "a part of a .ply" 2 "block is for .fxs" convert scene.ply all.ply --block 1/2
refused "a part is missing" 1 "part 4 of 7 is missing" convert part-[123567].fxs all.fxs
refused "a part twice" 1 "part 2 of 7, as part-2.fxs is" convert part-*.fxs ./part-2.fxs all.fxs
refused "another option" 2 "profile: part-1.fxs is a part" convert part-*.fxs all.fxs --profile small
refused "no part among them" 1 "one.fxs: not a part" convert part-*.fxs one.fxs all.fxs
refused "rendered" 1 "part-1.fxs: one part of a scene" render part-1.fxs -o all.fxs.png
instead() {
    name=$1 words=$2 scene=$3
    shift 3
    run convert "$scene" wrong.fxs --quiet "$@"
    refused "$name" 1 "$words" convert part-[124567].fxs wrong.fxs all.fxs
}
instead "of another profile" "of another profile" scene.ply --levels --block 3/7
instead "without levels" "without levels of detail, unlike" scene.ply --profile small --block 3/7
instead "of other parts" "one of 8 parts" scene.ply --profile small --levels --block 3/8
instead "of another scene" "of another scene than" other.ply --profile small --levels --block 3/7
{ head -c 4 part-3.fxs; printf '\002'; tail -c +6 part-3.fxs; } >wrong.fxs
refused "another version" 1 "another version" convert part-[124567].fxs wrong.fxs all.fxs
size=$(wc -c <part-3.fxs)
for cut in 5 200 1000 $((size / 2)) $((size - 1)); do
    head -c "$cut" part-3.fxs >wrong.fxs
    refused "cut short to $cut bytes" 1 "wrong.fxs: .*cut short" convert part-[124567].fxs wrong.fxs all.fxs
done
for at in 100 300 9000 $((size / 2)) $((size - 2000)) $((size - 9)); do
    { head -c "$at" part-3.fxs; printf 'damaged'; tail -c +$((at + 8)) part-3.fxs; } >wrong.fxs
    refused "damaged at $at" 1 "wrong.fxs: .*damaged|of another" convert part-[124567].fxs wrong.fxs all.fxs
done

forge() {
    python3 - "$1" part-3.fxs wrong.fxs <<'END'
import struct, sys, zlib
where, source, target = sys.argv[1:]
part = bytearray(open(source, "rb").read())
chunks, nodes, tops = struct.unpack_from("<3I", part, 24)
chunk_bytes, degree = struct.unpack_from("<2I", part, 64 + 16)
entries, = struct.unpack_from("<I", part, 64 + 132)
stages = 0 if degree == 0 else 4 if degree == 1 else 6
rows = 256 + 128 * chunks + (stages * entries * 48 + 63) // 64 * 64 + stages * 16 * 96
sums = rows + chunks * chunk_bytes
headers = sums + (40 * nodes + 63) // 64 * 64
node_rows = headers + 128 * nodes
top = node_rows + nodes * chunk_bytes
coarse = ((len(part) - top) // tops - 64) // 256
if where == "node":                    # damages a chunk deep in the tree: step_shift above 12
    size = (len(part) - top) // tops
    topmost = {struct.unpack_from("<I", part, top + i * size)[0] for i in range(tops)}
    node = max(set(range(nodes)) - topmost)
    at = headers + 128 * node
    struct.pack_into("<H", part, at + 74, 13)
    struct.pack_into("<I", part, at + 64, 0)
    checksum = zlib.crc32(part[at:at + 128] + part[node_rows + node * chunk_bytes:node_rows + (node + 1) * chunk_bytes])
    struct.pack_into("<I", part, at + 64, checksum)
elif where == "sums":
    part[sums:sums + 40 * nodes] = struct.pack("<5d", *[float("nan"), float("inf"), -1e308, 0, -1]) * nodes
else:                                  # damages the topmost nodes of the tree: wrong areas or opacities
    value, field = struct.pack("<f", float(where.split()[1])), 8 if where.startswith("area") else 4
    for i in range(256 * tops):
        at = top + i // 256 * (64 + 256 * coarse) + 64 + (i % 256 + 1) * coarse - field
        part[at:at + 4] = value
struct.pack_into("<2I", part, 56, 0, 0)
head, tree = zlib.crc32(part[:rows]), zlib.crc32(part[sums:node_rows] + part[top:])
struct.pack_into("<2I", part, 56, head, tree)
open(target, "wb").write(part)
END
}
if have python3; then
    forge node
    refused "a header of a node" 1 "wrong.fxs: its tree is damaged" convert part-[124567].fxs wrong.fxs all.fxs
    for where in sums "area inf" "area nan" "area -1e30" "opacity nan" "opacity -1e38"; do
        rm -f all.fxs
        forge "$where"
        succeeds "$where: merged" convert part-[124567].fxs wrong.fxs all.fxs --quiet
        succeeds "$where: it can be read" convert all.fxs read.fxs --quiet
        check "$where: not the same tree" sh -c '! cmp -s all.fxs one.fxs'
    done
else
    skip "parts with forged checksums" "no python3 here"
fi

if have parallel; then
    run convert scene.ply one.fxs --quiet --levels
    rm -f part-*.fxs all.fxs
    cat >job.sh <<'JOB'
[ "$1" != 2 ] || [ -e again ] || { : >again; kill -9 $$; }
exec "$2" convert scene.ply part-"$1".fxs --quiet --levels --block "$1"/4
JOB
    parallel --will-cite -j 2 --joblog log --retries 2 sh job.sh {} "$fixsplat" ::: 1 2 3 4 >logs/out 2>&1
    check "GNU parallel: a job was killed" test -e again
    run convert part-*.fxs all.fxs
    check "GNU parallel: done again, the bytes of one run" cmp all.fxs one.fxs
else
    skip "jobs of GNU parallel" "no parallel here"
fi
finish
