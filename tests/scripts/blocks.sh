#!/bin/sh
# Tests `fixsplat fit --block`: two jobs fit blocks (parts of a scene), and `fixsplat convert` merges them.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"

make_photographs 12
model=set/sparse/0
awk 'NF { $1 += 100; $7 = -200; $10 = "b" $10; print; print "" }' $model/images.txt >more && cat more >>$model/images.txt
awk '{ $1 += 1000; $3 += 200; print }' $model/points3D.txt >more && cat more >>$model/points3D.txt
for picture in set/images/*.png; do cp $picture set/images/b${picture##*/}; done
fit="fit set --quiet --steps 300"

succeeds "whole" $fit -o whole.ply
for i in 1 2; do
    succeeds "block $i/2" $fit --block $i/2 -o part-$i.ply --threads 1
    check "block $i/2: half of the photographs" grep -Eq '^Photographs fitted: 1[0-2]. Of the [12] held out:$' logs/out
    succeeds "block $i/2, 2 threads" $fit --block $i/2 -o again.ply --threads 2
    check "block $i/2: the same file whatever the threads" cmp part-$i.ply again.ply
done
succeeds "merged" convert part-1.ply part-2.ply all.ply
count() { LC_ALL=C sed -n 's/^element vertex //p;/^end_header/q' "$1"; }
check "merged: all of both" equal "$(count all.ply)" "$(($(count part-1.ply) + $(count part-2.ply)))"
measure() {
    "$fixsplat" render "$1" --cameras set/sparse/0 --view "$2" -o seen.png >logs/out &&
        "$fixsplat" compare "set/images/$3" seen.png >logs/out
    sed -n 's/.*PSNR[^0-9]*\([0-9]*\)\.\([0-9]\).*/\1\2/p' logs/out | head -n 1
}
for seen in "3 03.png" "15 b03.png"; do
    whole=$(measure whole.ply $seen) merged=$(measure all.ply $seen)
    check "merged: ${seen#* }: at most 1.5 dB below the whole ($merged, $whole)" [ "$merged" -ge "$((whole - 15))" ]
done

succeeds "saved" $fit --block 1/2 -o saved.ply --save-every 100
fails "resumed as another block" 1 "of other photographs" $fit --block 2/2 -o saved.ply --resume saved.ply.fit
fails "resumed as the whole" 1 "of other photographs" $fit -o saved.ply --resume saved.ply.fit
succeeds "resumed" $fit --block 1/2 -o resumed.ply --resume saved.ply.fit
check "resumed: the same file" cmp part-1.ply resumed.ply

for bad in 0/2 3/2 1/0 x 1/5000 1 /2 1/ 1/2/3; do
    fails "--block $bad" 2 "expected I/N" $fit --block $bad -o part.ply
done
fails "into .fxs" 2 "expected a name ending in .ply" $fit --block 1/2 -o part.fxs
fails "more blocks than points" 1 "block 1 of 4096: no point is in it" $fit --block 1/4096 -o part.ply
finish
