#!/bin/sh
# Tests fits of blocks (parts of a scene) that continue a coarse fit, and tools/scripts/cluster.sh with GNU parallel and
# Slurm.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"
. "$root/tests/scripts/lib/slurm.sh"
export FIXSPLAT="$fixsplat"

make_photographs 12
model=set/sparse/0
awk 'NF { $1 += 100; $7 = -200; $10 = "b" $10; print; print "" }' $model/images.txt >more && cat more >>$model/images.txt
awk '{ $1 += 1000; $3 += 200; print }' $model/points3D.txt >more && cat more >>$model/points3D.txt
for picture in set/images/*.png; do cp "$picture" "set/images/b${picture##*/}"; done
fit="fit set --quiet --recipe reference --steps 300"
count() { LC_ALL=C sed -n 's/^element vertex //p;/^end_header/q' "$1"; }
mean_of() { awk '/^mean/ { print $2 }' logs/out; }

# ---- Blocks of a coarse fit ------------------------------------------------------------------------------------------

succeeds "coarse" fit set --quiet --recipe reference --steps 100 --resolution 32 -o coarse.fit
succeeds "whole" $fit -o whole.fxs
whole=$(mean_of)
for i in 0 1 2 3; do
    succeeds "block $i/3" $fit --coarse coarse.fit --block $i/3 -o part-$i.ply --threads 1
    succeeds "block $i/3, 2 threads" $fit --coarse coarse.fit --block $i/3 -o again.ply --threads 2
    check "block $i/3: the same file whatever the threads" cmp part-$i.ply again.ply
done
succeeds "merged" convert part-0.ply part-1.ply part-2.ply part-3.ply all.fxs --levels
check "merged: all of them" gaussians all.fxs $(($(count part-0.ply) + $(count part-1.ply) + $(count part-2.ply) + \
    $(count part-3.ply))) 3
succeeds "measured" fit set --quiet --measure all.fxs
check "merged: at most 1.5 dB below the whole" at_least "$(mean_of)" "$(awk "BEGIN { print $whole - 1.5 }")"

mkdir one && cp -r set/sparse one && mkdir one/images && cp set/images/* one/images
for block in 1 2; do
    "$fixsplat" $fit --coarse coarse.fit --block $block/2 -o half-$block.ply >logs/out
done
for picture in one/images/b*.png; do echo no picture >"$picture"; done
read_alone=0
for block in 1 2; do
    "$fixsplat" fit one --quiet --recipe reference --steps 300 --coarse coarse.fit --block $block/2 -o one.ply \
        >logs/out 2>&1 &&
        cmp -s one.ply half-$block.ply && read_alone=$((read_alone + 1))
    rm -f one.ply
done
check "only the photographs that see the block are read" equal $read_alone 1
for block in 1 2; do "$fixsplat" info half-$block.ply; done | awk '/^bounds/' >bounds
check "every Gaussian lies in its own block" awk 'NR == 1 { split($0, first) }
    NR == 2 { for (k = 2; k <= 4; k++) if (first[k + 4] <= $k) apart = 1 } END { exit !apart }' bounds

succeeds "saved" $fit --coarse coarse.fit --block 1/3 -o saved.ply --save-every 200
succeeds "resumed" $fit --coarse coarse.fit --block 1/3 -o resumed.ply --resume saved.ply.fit
check "resumed: the same file" cmp part-1.ply resumed.ply
succeeds "coarse, with exposures" fit set --quiet --recipe reference --steps 100 --resolution 32 -o exposed.fit --exposure gain
succeeds "its exposures" $fit --coarse exposed.fit --block 1/3 -o exposed.ply --exposure gain
"$fixsplat" $fit --coarse exposed.fit --block 1/3 -o again.ply >logs/out
check "its exposures: as of itself" cmp exposed.ply again.ply
fails "not its exposures" 2 "exposed.fit was begun with another" $fit --coarse exposed.fit --block 1/3 -o x.ply \
    --exposure none
fails "not antialiased" 2 "exposed.fit was begun without" $fit --coarse exposed.fit --block 1/3 -o x.ply --antialiased
succeeds "coarse, antialiased" fit set --quiet --recipe reference --steps 100 --resolution 32 -o smooth.fit \
    --antialiased
succeeds "of it: antialiased" $fit --coarse smooth.fit --block 1/3 -o smooth.ply
succeeds "of it: what is outside" $fit --coarse smooth.fit --block 0/3 -o outside.ply
check "of it: the parts say so" equal "$(grep -al '^comment antialiased 1$' smooth.ply outside.ply | tr '\n' ' ')" \
    "smooth.ply outside.ply "
succeeds "coarse, with a sky" fit set --quiet --recipe reference --steps 100 --resolution 32 -o sky.fit --sky=2000
succeeds "its sky" $fit --coarse sky.fit --block 1/3 -o sky.ply --sky=2000
succeeds "its sky: as of itself" $fit --coarse sky.fit --block 1/3 -o again.ply
check "its sky: the same file" cmp sky.ply again.ply
succeeds "its sky is outside of all blocks" fit set --quiet --coarse sky.fit --block 0/3 -o sky-0.ply
check "its sky: more outside" at_least "$(count sky-0.ply)" $(($(count part-0.ply) + 100))
fails "not its sky" 2 "sky.fit was begun with another" $fit --coarse sky.fit --block 1/3 -o x.ply --sky=100
succeeds "another coarse fit" fit set --quiet --recipe reference --steps 99 --resolution 32 -o other.fit
fails "resumed from another coarse fit" 1 "of other photographs" $fit --coarse other.fit --block 1/3 -o x.ply \
    --resume saved.ply.fit

fails "no coarse fit there" 1 "none.fit: .*No such file" $fit --coarse none.fit --block 1/3 -o x.ply
fails "no saved fit" 1 "whole.fxs: not a saved fit" $fit --coarse whole.fxs --block 1/3 -o x.ply
head -c 9999 coarse.fit >short.fit
fails "a coarse fit cut short" 1 "short.fit: damaged: it ends early" $fit --coarse short.fit --block 1/3 -o x.ply
mkdir shifted && cp -r set/images shifted && mkdir -p shifted/sparse/0 && cp $model/* shifted/sparse/0
awk 'NF { $6 += 1; print; print "" }' $model/images.txt >shifted/sparse/0/images.txt
fails "a coarse fit of another set" 1 "the coarse fit is of other photographs" fit shifted --quiet --recipe reference \
    --steps 300 \
    --coarse coarse.fit --block 1/3 -o x.ply
fails "too few steps" 1 "100 steps are too few" fit set --quiet --recipe reference --steps 100 --coarse coarse.fit --block 1/3 -o x.ply
fails "another recipe" 1 "the coarse fit has another recipe" fit set --quiet --steps 300 --coarse coarse.fit --block 1/3 -o x.ply
fails "block out of range" 2 "expected I/N" $fit --coarse coarse.fit --block 4/3 -o x.ply
fails "block 0 without a coarse fit" 2 "0 is for --coarse" $fit --block 0/3 -o x.ply
fails "coarse without block" 2 "coarse needs --block" $fit --coarse coarse.fit -o x.ply
check "nothing was written" test ! -e x.ply

# ---- Jobs of GNU parallel and Slurm ----------------------------------------------------------------------------------

cluster() {
    to=$1
    shift
    sh "$root/tools/scripts/cluster.sh" set -o "$to" --blocks 3 --coarse-steps 100 --coarse-resolution 32 --steps 300 "$@" \
        -- --threads 1 >logs/out 2>logs/err
}
refused() {
    name=$1 words=$2
    shift 2
    sh "$root/tools/scripts/cluster.sh" "$@" >logs/out 2>logs/err
    if [ $? != 0 ] && [ "$(wc -l <logs/err)" = 1 ] && grep -q -e "$words" logs/err; then ok "$name"; else
        fail "$name" "$(cat logs/err)"
    fi
}
check "cluster.sh --help has examples" sh -c "sh '$root/tools/scripts/cluster.sh' --help | grep -q 'engine slurm'"
refused "no photographs" "which photographs" -o x.fxs --blocks 2
refused "blocks" "expected 1 to 4096" set -o x.fxs --blocks 4097
refused "an ending" "expected a name ending in .fxs" set -o x.ply --blocks 2
refused "steps" "more than the coarse fit's 3000" set -o x.fxs --blocks 2 --steps 3000
refused "an engine" "expected parallel or slurm" set -o x.fxs --blocks 2 --engine lsf
refused "an option" "no such option" set -o x.fxs --blocks 2 --recipe fast

odd='a\tb\c "$(exit)" %a {} '"'"
mkdir "$odd"
cp -r set "$odd/set"
check "names of all kinds: the jobs are written" sh "$root/tools/scripts/cluster.sh" "$odd/set" -o "$odd/x.fxs" --blocks 2 \
    --coarse-steps 20 --coarse-resolution 32 --steps 40 --engine parallel --dry-run -- --threads 1
FIXSPLAT_QUIET=1 "$odd/x.fxs.jobs/coarse.sh" >logs/out 2>logs/err
check "names of all kinds: the coarse fit" equal "$(ls "$odd/x.fxs.jobs/coarse.fit") $(cat logs/err)" "$odd/x.fxs.jobs/coarse.fit "
"$odd/x.fxs.jobs/merge.sh" >logs/out 2>logs/err
check "names of all kinds: what is missing" equal "$(cat logs/err)" \
    "part-0.ply is missing: its job failed, see its log in $PWD/$odd/x.fxs.jobs"
refused "names of all kinds: a message" 'none\\tat: no such file' 'none\tat' -o x.fxs --blocks 2
if have parallel; then
    check "names of all kinds: by GNU parallel" sh "$root/tools/scripts/cluster.sh" "$odd/set" -o "$odd/x.fxs" --blocks 2 \
        --coarse-steps 20 --coarse-resolution 32 --steps 40 -- --threads 1
    check "names of all kinds: the scene" [ -s "$odd/x.fxs" ]
    check "by GNU parallel" cluster one.fxs --jobs 2
    check "by GNU parallel: the bytes of the jobs by hand" cmp one.fxs all.fxs
    rm one.fxs one.fxs.jobs/all.fxs one.fxs.jobs/part-2.ply
    touch -d 2001-01-01 one.fxs.jobs/part-1.ply
    check "a job that was killed is done again" cluster one.fxs
    check "the others are not" test -z "$(find one.fxs.jobs/part-1.ply -newermt 2002-01-01)"
    check "and the bytes are the same" cmp one.fxs all.fxs
    cluster one.fxs --steps 400
    check "results of other options are refused" grep -q 'the jobs there are of other options' logs/err
else
    skip "cluster.sh by GNU parallel" "no parallel here"
fi

lacks=$(slurm_lacks)
if [ -n "$lacks" ]; then
    skip "cluster.sh by Slurm" "$lacks"
    finish
    exit
fi
trap 'slurm_stop; rm -rf "$work"' EXIT
if ! slurm_start "$work/slurm" >logs/slurm; then
    fail "a Slurm of this machine" "$(tail -n 3 logs/slurm)"
    finish
    exit
fi
printf '#!/bin/sh\ncase "$*" in *"--block 2/"*) [ -e %s/go ] || sleep 60 ;; esac\nexec %s "$@"\n' "$work" "$fixsplat" \
    >slow && chmod +x slow
FIXSPLAT="$work/slow" cluster two.fxs --engine slurm --submit-only
array=$(cut -d, -f2 two.fxs.jobs/submitted)
check "by Slurm: block 2 runs" slurm_running "${array}_2"
scancel -s KILL "${array}_2"
slurm_wait "$(cat two.fxs.jobs/submitted)"
check "a job was killed: no result of it" test ! -e two.fxs.jobs/part-2.ply
check "nor of the merge" test ! -e two.fxs.jobs/all.fxs
touch go
if FIXSPLAT="$work/slow" cluster two.fxs --engine slurm --poll 1; then
    ok "the same command goes on"
else
    fail "the same command goes on" "$(cat logs/err two.fxs.jobs/*.log | head -c 2000)"
fi
check "by Slurm: only the killed block was done again" equal \
    "$(slurm_states "$(cut -d, -f2 two.fxs.jobs/submitted)" | cut -d' ' -f1 | sort -u)" 2
check "by Slurm: the bytes of the jobs by hand" cmp two.fxs all.fxs
finish
