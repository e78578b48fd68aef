#!/bin/sh
# fixsplat convert --block: parts that are packed apart and merged have the bytes of one run, whatever their number and
# profile, and as jobs of GNU parallel, one of them killed; parts that are wrong are refused and nothing is written.
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

# The last loop left seven parts of small with levels.
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
# instead NAME WORDS SCENE OPTION...: part 3 is another one.
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
