#!/bin/sh
# Tests `fixsplat fit` on rendered photographs of a knot, a procedural scene.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/json.sh"
. "$root/tests/scripts/lib/photos.sh"

export FIXSPLAT_QUIET=1
loud() {
    (unset FIXSPLAT_QUIET && exec "$fixsplat" "$@") >logs/out 2>logs/err
    status=$?
}
progress='^[0-9]+/[0-9]+, loss 0\.[0-9]{4}, [0-9]+ Gaussians, [0-9.]+ steps/s, .* left$'
said() { grep -Ev -e "$progress" -e '^fixsplat: (reading photographs:|measuring) ' -e ' photographs to fit, ' logs/err; }

# ---- Photographs -----------------------------------------------------------------------------------------------------

steps=620
make_photographs 12
fit="fit set --steps $steps"

# ---- Fitted scenes ---------------------------------------------------------------------------------------------------

psnr() { sed -n 's/.*"psnr": \([0-9.]*\), "ssim": [0-9.]*, "worst_psnr".*/\1/p' logs/out | tr -d . | cut -c 1-4; }

succeeds "fit" $fit -o whole.fxs --threads 1
check "fit: says what it made" grep -Eq \
    "^whole.fxs: [0-9]+ Gaussians, $(wc -c <whole.fxs | tr -d ' ') bytes in the profile default; $steps steps, recipe fast, seed 0$" \
    logs/out
check "fit: says what was held out" grep -q '^Photographs fitted: 10. Of the 2 held out:$' logs/out
check "fit: a line for each, the mean and the worst" equal "$(grep -Ec '^ *[01] 0[08].png +64x48 ' logs/out) $(
    grep -c '^mean ' logs/out) $(grep -c '^worst ' logs/out)" "2 1 1"
check "fit: PSNR after the best affine map of colours is higher" equal "$(awk '/^( *[01] 0[08].png|mean|worst)/ {
    at = $1 ~ /[0-9]/ ? 4 : 2; if ($(at + 1) >= $at) print "higher" }' logs/out | uniq -c | tr -d ' ')" 4higher
check "fit: leaves nothing beside" equal "$(ls -A | grep -v -e knot.ply -e logs -e set | tr '\n' ' ')" "whole.fxs "
check "fit: begins with a view that is chosen in the scene" equal "$("$fixsplat" render whole.fxs --size 64x36 --hash)" \
    "$("$fixsplat" render whole.fxs --auto-up --size 64x36 --hash)"
succeeds "fit: --json" $fit -o again.fxs --json --threads 2
check "fit: --json: keys" keys logs/out scene gaussians bytes profile recipe steps seed seconds fitted held_out skipped \
    measured photographs.views photographs.psnr photographs.ssim photographs.affine_psnr verdict advice
check "fit: at least 18.5 dB from where nothing was fitted" [ "$(psnr)" -ge 1850 ]
fitted=$(psnr)
"$fixsplat" fit set --steps 1 -o first.fxs --json >logs/out
check "fit: 4 dB better than its beginning" [ "$((fitted - $(psnr)))" -ge 400 ]

check "again, 2 threads: the same file" cmp whole.fxs again.fxs
"$fixsplat" fit set --steps 200 --max-gaussians 3000 -o short.fxs --threads 1 >logs/out
"$fixsplat" fit set --steps 200 --max-gaussians 3000 -o five.fxs --threads 5 --cpu c >logs/out
check "5 threads, plain C: the same file" cmp short.fxs five.fxs
"$fixsplat" $fit -o other.fxs --seed 1 >logs/out
check "another seed: another file" [ "$(cmp -s whole.fxs other.fxs; echo $?)" = 1 ]
succeeds "into .ply" $fit -o floats.ply
"$fixsplat" convert floats.ply packed.fxs
check "into .ply: what is packed, rounded again, is as large" equal "$(wc -c <whole.fxs)" "$(wc -c <packed.fxs)"
"$fixsplat" fit set --steps 9 -o few.fxs >logs/out
"$fixsplat" fit set --steps 9 -o few.ply >logs/out
"$fixsplat" convert few.ply packed.fxs --up 0,-1,0 --crop -99,-99,-99,99,99,99 --quiet
check "into .ply: packed it is the same file" cmp few.fxs packed.fxs
"$fixsplat" info floats.ply >logs/out
check "into .ply: all can be drawn" grep -Eq '^Gaussians +([0-9]+), \1 of them' logs/out

# ---- The verdict -----------------------------------------------------------------------------------------------------

# verdict ARGUMENT...: fits, and prints the lines behind the table of photographs, with N for numbers of dB.
verdict() {
    loud fit "$@"
    sed '1,/^worst /d; s/[0-9][0-9.]* dB/N dB/; s/[0-9][0-9.]* where/N where/' logs/out
}
ends() {
    name=$1 lines=$2
    shift 2
    check "$name" equal "$(verdict "$@")" "$lines"
}
quick() { echo "This was a quick fit of $1 steps: --quality good makes 8000, which show finer detail."; }
look="to look at it:                fixsplat view it.fxs"
again="again, and better:            fixsplat fit set"
publish="a folder for any web server:  fixsplat publish it.fxs site"
subject="the subject alone:            fixsplat convert it.fxs it-cropped.fxs --sphere 0,0,0,5.2"
ends "below 20 dB" "Broken: from new places it does not look like the photographs (N dB; N where it was fitted).
$(quick 1)
$look
$again -o it.fxs --quality good
$publish
$subject" set --steps 1 -o it.fxs
ends "below 25 dB" "Blurred or spotted: from new places all is there, but without detail (N dB; N where it was fitted).
$(quick 620)
$look
$again --seed 0 -oit.fxs --quality good
$publish
$subject" set --steps=620 --seed 0 --reci reference -oit.fxs
check "it is the mean, to a tenth" equal "$(awk '/^mean / { print substr($2, 1, 4) }' logs/out)" \
    "$(sed -n 's/^Blurred.*(\([0-9.]*\) dB.*/\1/p' logs/out)"
ends "below 30 dB, and much better where it was fitted" \
    "A little soft: from new places it looks like a photograph with less detail (N dB; N where it was fitted).
Places between the photographs are much worse, with haze or floating spots: more photographs would help.
$(quick 1500)
$look
$again --hold-out 2 -o it.fxs --quality good
$publish" set --steps 1500 --recipe reference --hold-out 2 -o it.fxs
ends "--hold-out 0" "Nothing was held out, so how it looks from new places is not known (N dB where it was fitted).
$(quick 9)
to look at it:                fixsplat view 'it'\\''s.ply'
$again --hold-out 0 -o 'it'\\''s.ply' --quality good
a folder for any web server:  fixsplat publish 'it'\\''s.ply' site
the subject alone:            fixsplat convert 'it'\\''s.ply' 'it'\\''s-cropped.ply' --sphere 0,0,0,5.2" set --steps 9 --hold-out 0 -o "it's.ply"
ends ".fit: next is its scene" \
    "Broken: from new places it does not look like the photographs (N dB; N where it was fitted).
$(quick 9)
its scene:                    fixsplat fit set --steps 9 --resume it.fit -o it.fxs
$again -o it.fit --quality good" set --steps 9 -o it.fit
eval "$(sed -n 's/^its scene: *fixsplat/"$fixsplat"/p' logs/out)" >logs/out
"$fixsplat" fit set --steps 9 -o again.fxs >logs/out
check ".fit: its scene, by the command that is named" cmp it.fxs again.fxs
ends "a resumed fit: no command with other options" \
    "Broken: from new places it does not look like the photographs (N dB; N where it was fitted).
$(quick 9)
$look
$publish
$subject" set --resume it.fit -o it.fxs
cp -r set blind && mkdir blind/masks
"$fixsplat" render knot.ply --size 64x48 --eye 0,0,-9 --look 0,0,-20 -o blind/masks/00.png
cp blind/masks/00.png blind/masks/08.png
ends "masks that leave nothing to measure" \
    "No pixel of the photographs that were measured counts, so how it looks is not known.
$look
$publish
$subject" blind --steps 9 -o it.fxs
cp -r set -- -set
ends "photographs whose name begins with -" \
    "Broken: from new places it does not look like the photographs (N dB; N where it was fitted).
$(quick 9)
$look
again, and better:            fixsplat fit ./-set -o it.fxs --quality good
$publish
$subject" --steps 9 -o it.fxs -- -set
loud fit set --steps 9 -o it.fxs --json
check "--json: no words" equal "$(wc -l <logs/out | tr -d ' ')" 1
check "--json: the verdict" grep -q '"verdict": "broken", "advice": \["quick"\], ' logs/out
loud fit set --steps 9 -o it.fxs --json --hold-out 0
check "--json: nothing held out" grep -q '"verdict": null, "advice": \["quick"\], ' logs/out
run fit set --steps 9 -o it.fxs
check "--quiet: no words" grep -q "^worst " logs/out
check "--quiet: no words behind it" equal "$(sed '1,/^worst /d' logs/out)" ""

# Forty photographs of the knot, close to each other, and sets with a fault. 00, 08, 16, 24 and 32 are held out.
mkdir many && (cd many && make_photographs 40) || exit 1
mv many/set near
number='{ n = substr($0, length($0) - 5, 2) + 0 }'
cp -r near far
awk "$number"' /png$/ && n > 7 && n < 21 && n != 12 { getline; next } { print }' near/sparse/0/images.txt \
    >far/sparse/0/images.txt
cp -r near other
cp near/images/20.png other/images/16.png
# darken SET NUMBER...: copies the set, with half the brightness in these photographs.
darken() {
    cp -r near $1
    set=$1
    shift
    for i; do
        "$fixsplat" render knot.ply --cameras near/sparse/0 --view $((${i#0})) -o bright.ppm
        perl -0777 -pe 'BEGIN { binmode STDIN; binmode STDOUT } s/^(P6\s+\d+\s+\d+\s+\d+\s)(.*)/$1 . pack("C*", map { $_ \/ 2 } unpack("C*", $2))/se' \
            <bright.ppm >$set/images/$i.ppm
        sed "s/$i.png/$i.ppm/" $set/sparse/0/images.txt >images.txt && mv images.txt $set/sparse/0/images.txt
    done
}
if have perl; then
    darken dark 16
    darken darks 00 08 16 24 32
else
    skip "dark photographs" "no perl here"
fi
ends "at least 30 dB, and all steps" "Sharp: from new places it is hard to tell from a photograph (N dB; N where it was fitted).
$look
$publish
$subject" near --resolution 16 --steps 8000 -o it.fxs
ends "--exposure: colours are matched" \
    "A little soft: from new places it looks like a photograph with less detail (N dB with matched colours; N where it was fitted).
--quality best shows a little more detail, in about 8 times the time.
$look
again, and better:            fixsplat fit near --resolution 16 --max-gaussians 40 --exposure gain -o it.fxs --quality best
$publish
$subject" near --resolution 16 --steps 8000 --max-gaussians 40 --exposure gain -o it.fxs
findings=places     # cameras.sh
while IFS='|' read -r finding sentence arguments; do
    case $arguments in dark*) have perl || continue ;; esac
    verdict $arguments -o it.fxs >verdict
    check "$finding: $sentence" grep -Fqx -e "$sentence" verdict
    "$fixsplat" fit $arguments -o it.fxs --json >logs/out
    check "$finding: --json" grep -Eq "\"advice\": \\[[^]]*\"$finding\"[],]" logs/out
    findings="$findings $finding"
done <<'END'
exposure|The photographs differ in brightness or tint, which leaves haze: --exposure gain evens them out.|darks --steps 620 --resolution 32
worst|16.ppm came out far worse than the others (N dB): it is brighter, darker or of another tint.|dark --steps 620 --resolution 32
worst|12.png came out far worse than the others (N dB): no photograph was fitted near its place.|far --steps 620 --resolution 32
worst|16.png came out far worse than the others (N dB): is it blurred, or does it show something that moved?|other --steps 620 --resolution 32
gaps|Places between the photographs are much worse, with haze or floating spots: more photographs would help.|set --steps 8000 --resolution 16
quick|This was a quick fit of 7999 steps: --quality good makes 8000, which show finer detail.|near --steps 7999 --resolution 16
unsharp|Where it was fitted it is not much better: sharper photographs of things that keep still would help.|near --steps 8000 --resolution 16 --max-gaussians 20 --sh-degree 0
best|--quality best shows a little more detail, in about 8 times the time.|near --steps 8000 --resolution 16 --max-gaussians 40 --sh-degree 0
END
check "each finding was found" equal "$(echo $findings | tr ' ' '\n' | sort -u)" \
    "$(sed -n 's/^    {"\([a-z]*\)", [a-z_]*, say_.*/\1/p' "$root/tools/fit/fit_verdict.c" | sort)"
ends "the best quality: no better one" \
    "A little soft: from new places it looks like a photograph with less detail (N dB; N where it was fitted).
$look
$publish
$subject" near --resolution 16 --steps 30000 --max-gaussians 40 --sh-degree 0 -o it.fxs
verdict other --resolution 32 --steps 620 --threads 2 -o it.fxs >verdict
check "at most six lines" equal "$(wc -l <verdict | tr -d ' ')" 6
next_of() { sed -n "s/^$1: *fixsplat/\"\$fixsplat\"/p" verdict; }
eval "$(next_of 'the photographs beside it')" >logs/out
check "the photographs, by the command that is named" equal "$(ls pictures | tr '\n' ' ')" \
    "0000_00.png 0001_08.png 0002_16.png 0003_24.png 0004_32.png "
check "the photographs, as measured before" grep -q '^ *2 16.png  *32x24 ' logs/out
eval "$(next_of 'again, and better')" >logs/out
check "again, by the command that is named" grep -q '; 8000 steps, recipe fast, seed 0$' logs/out
verdict other --resolution 32 --steps 620 -o it.fxs --compare pictures >verdict
check "with --compare: no command for it" equal "$(grep -c '^16.png came out' verdict) $(
    next_of 'the photographs beside it')" "1 "
rm -rf it.* "it's.ply" near far other dark darks many pictures blind ./-set

# ---- Crop to the subject ---------------------------------------------------------------------------------------------

cp -r set around
awk 'BEGIN { for (i = 0; i < 60; i++) print 400 + i, 9 * cos(i), i % 7 - 3, 9 * sin(i), 90, 90, 90, 0 }' \
    >>around/sparse/0/points3D.txt
count_of() { sed -n 's/^[a-z]*\.[a-z]*: \([0-9]*\) Gaussians, .*/\1/p' logs/out; }
loud fit around --steps 30 -o it.fxs
measured=$(sed -n '/^ *[0-9]* 0/p; /^mean/p' logs/out) all=$(count_of)
eval "$(sed -n 's/^the subject alone: *fixsplat/"$fixsplat"/p' logs/out)"
cut=$("$fixsplat" info it-cropped.fxs | awk '/^Gaussians/ { print $2 + 0 }')
check "the crop that is named at the end leaves out what is beyond" [ $cut -lt $((all - 50)) -a $cut -gt 100 ]
loud fit around --steps 30 -o cropped.fxs --crop-to-subject
check "--crop-to-subject: says what it was cropped to" equal "$(said)" "fixsplat: cropped.fxs: cropped to 5.2 units around $(
    sed -n 's/.* units around \([^:]*\):.*/\1/p' logs/err): $((all - $(count_of))) Gaussians left out"
check "--crop-to-subject: the middle" equal "$(sed -n 's/.* units around \([^:]*\):.*/\1/p' logs/err | tr , '\n' |
    awk '$1 * $1 < 1e-8' | wc -l | tr -d ' ')" 3
check "--crop-to-subject: fewer Gaussians, but not few" [ "$(count_of)" -lt $((all - 50)) -a "$(count_of)" -gt 100 ]
check "--crop-to-subject: measured before that" equal "$(sed -n '/^ *[0-9]* 0/p; /^mean/p' logs/out)" "$measured"
"$fixsplat" convert cropped.fxs cropped.ply
"$fixsplat" convert cropped.ply again.ply --sphere 0,0,0,5.21
check "--crop-to-subject: none beyond" equal "$(wc -c <again.ply)" "$(wc -c <cropped.ply)"
"$fixsplat" fit around --steps 30 -o again.fxs --crop-to-subject --threads 2 --cpu c >logs/out
check "--crop-to-subject: 2 threads, plain C: the same file" cmp cropped.fxs again.fxs
loud fit around --steps 30 -o again.fxs --of thing
check "--of thing: as by hand" cmp cropped.fxs again.fxs
check "--of thing: says what it chose" grep -q '^fixsplat: --of thing: --crop-to-subject$' logs/err
loud fit around --steps 30 -o again.fxs --of room --photos mixed
check "--photos mixed: says what it chose" grep -q '^fixsplat: --photos mixed: --exposure gain, ' logs/err
"$fixsplat" fit around --steps 30 -o it.fxs --antialiased --exposure gain >logs/out
check "--of room --photos mixed: as by hand" cmp it.fxs again.fxs
loud fit around --steps 3 -o it.fxs --photos mixed --exposure none
check "--photos mixed: an option that is given" grep -q '^fixsplat: --photos mixed: --exposure none, ' logs/err
fails "--of and --measure" 2 "--of does not go with --measure" fit around --measure it.fxs --of room
fails "--photos and --block" 2 "--photos does not go with --block" fit around -o x.ply --photos mixed --block 1/2
awk 'NF > 1 { $2 = 1; $3 = $4 = $5 = 0; $6 = NR / 10 } { print }' set/sparse/0/images.txt >around/sparse/0/images.txt
loud fit around --steps 3 -o it.fxs --hold-out 0
loud fit around --steps 3 -o cropped.fxs --hold-out 0 --crop-to-subject
check "--crop-to-subject: cameras side by side" grep -q \
    '^fixsplat: cropped.fxs: not cropped: the cameras do not look at one thing: 0 of 12 photographs' logs/err
check "--crop-to-subject: then the scene stays" cmp it.fxs cropped.fxs
fails "--crop-to-subject of a saved fit" 2 "--crop-to-subject needs a whole fit" fit set -o x.fit --crop-to-subject
rm -rf around cropped.* again.ply it.fxs

# ---- Progress ----------------------------------------------------------------------------------------------------------

loud fit set --steps 30 -o few.fxs
check "into a file: the stages" equal "$(grep -v ' left$' logs/err)" "fixsplat: 10 photographs to fit, 2 held out, up to 64x48; 400 points
fixsplat: measuring few.fxs"
check "into a file: the last step" grep -Eq '^30/30, loss 0\.[0-9]{4}, [0-9]+ Gaussians, [0-9.]+ steps/s, 0 s' logs/err
(unset FIXSPLAT_QUIET && exec "$fixsplat" fit set --steps 1000000 -o long.fxs) >logs/out 2>logs/err &
waited=0
# lines COUNT: waits until the fit has printed COUNT progress lines. They come every ten seconds, and the test pauses
# the fit for most of that time.
lines() {
    until [ "$(grep -Ec "$progress" logs/err)" -ge "$1" ] || [ $waited = 25 ]; do
        sleep 1 && waited=$((waited + 1))
    done
}
lines 1
kill -s STOP $! && sleep 9 && kill -s CONT $!
lines 2
kill $! && wait $! 2>logs/shell
check "into a file: two lines in the first seconds" [ $waited -lt 25 ]
rm -f long.fxs.fit

# ---- Progress on a terminal ------------------------------------------------------------------------------------------

if have script; then
    line="'$fixsplat' fit set --steps 1200 --threads 1 -o few.fxs"
    (unset FIXSPLAT_QUIET && script -qec "$line" /dev/null </dev/null >logs/out)
    check "on a terminal: what it begins with" grep -q \
        'fixsplat: 10 photographs to fit, 2 held out, up to 64x48; 400 points' logs/out
    script -qec "$line --quiet --json" /dev/null </dev/null >logs/said
    check "on a terminal, --quiet: the report alone" equal "$(wc -l <logs/said) $(grep -c '^{"scene": .*}' logs/said)" "1 1"
    check "on a terminal: progress" grep -Eq \
        '[0-9]+/1200, loss 0\.[0-9]{4}, [0-9]+ Gaussians, [0-9.]+ steps/s, [0-9]+ s left' logs/out
else
    skip "on a terminal" "no script(1) here"
fi

# ---- Start view -----------------------------------------------------------------------------------------------------

here=$PWD
while read -r from photos; do
    check "fit $photos in $from" sh -c "cd $from && '$fixsplat' fit $photos --steps 1 -o '$here/few.fxs' >'$here/logs/out'"
done <<'END'
set .
set/sparse/0 .
set/sparse/0 images.txt
set/sparse 0/
set/images ../sparse/0/points3D.txt
set/images ..
END

mkdir -p deep/colmap/sparse second/sparse
cp -r set/sparse/0 deep/colmap/sparse/0
cp -r set/images deep/input
cp -r set/sparse/0 second/sparse/1
cp -r set/images second/images_4
for folder in deep second; do succeeds "cameras of $folder" fit $folder --steps 1 -o few.fxs; done
fails "fit a photograph" 2 "images/05.png: a photograph: fit takes the folder that has all of them" \
    fit set/images/05.png -o few.fxs

# ---- Photographs held out --------------------------------------------------------------------------------------------

succeeds "--hold-out 0" fit set --steps 20 -o few.fxs --hold-out 0
check "--hold-out 0: says so" grep -q '^Photographs fitted: 12. None was held out; of those fitted:$' logs/out
succeeds "--hold-out 5 --compare" fit set --steps 20 -o few.fxs --hold-out 5 --compare pictures --resolution 32
check "--resolution: the size that is measured" grep -q '  32x24 ' logs/out
run compare pictures/0001_05.png set/images/05.png
check "--compare: a picture each" equal "$(ls pictures | tr '\n' ' ')" "0000_00.png 0001_05.png 0002_10.png "
check "--compare: two beside each other" grep -q '0001_05.png is 64x24,' logs/err
for recipe in mcmc fast; do
    succeeds "--recipe $recipe" fit set --steps 20 -o few.fxs --recipe $recipe --sh-degree 1 --max-gaussians 300 \
        --background 102030 --cutoff square --profile small
done

# ---- The log ---------------------------------------------------------------------------------------------------------

echo old >fit.log
loud $fit -o logged.fxs --log fit.log --metrics-every 200
check "--metrics-every: a line each" equal "$(grep -Ec \
    '^fixsplat: step [246]00: [0-9]+\.[0-9]+ dB, after the best affine map [0-9.]+, SSIM 0\.[0-9]{4}; [0-9]+ Gaussians$' logs/err)" 3
check "--log, --metrics-every: the same file" cmp whole.fxs logged.fxs
check "--log: a header, in place of what was there" equal "$(head -n 1 fit.log | tr '\t' ' ')" \
    "step seconds gaussians loss psnr affine_psnr ssim"
check "--log: its steps" equal "$(sed 1d fit.log | cut -f 1 | tr '\n' ' ')" \
    "$(awk 'BEGIN { for (i = 1; i <= 620; i++) if (i % 7 == 0 || i % 200 == 0 || i == 620) printf "%d ", i }')"
check "--log: seven fields, time and Gaussians never less, losses" equal "$(awk -F '\t' 'NR > 1 {
    if (NF != 7 || $2 + 0 < seconds || $3 < gaussians + 0 || $3 < 100 || !($4 > 0 && $4 < 1)) print
    seconds = $2 + 0; gaussians = $3 }' fit.log)" ""
check "--log: the Gaussians of the scene" equal "$(tail -n 1 fit.log | cut -f 3)" \
    "$(sed -n 's/^logged.fxs: \([0-9]*\) Gaussians.*/\1/p' logs/out)"
check "--log: measured where the command says so" equal \
    "$(awk -F '\t' 'NR > 1 && $5 { printf "%d %s %s %.4f %d\n", $1, $5, $6, $7, $3 }' fit.log | head -n 3)" \
    "$(sed -n 's/^fixsplat: step \([0-9]*\): \([0-9.]*\) dB, after the best affine map \([0-9.]*\), SSIM \([0-9.]*\); \([0-9]*\) .*/\1 \2 \3 \4 \5/p' logs/err)"
check "--log: and at the end" equal "$(tail -n 1 fit.log | awk -F '\t' '{ print $5, $6, $7 }')" \
    "$(awk '/^mean / { print $2, $3, $4 }' logs/out)"
few='--max-gaussians 600'
"$fixsplat" fit set $few --steps 300 -o part.fxs --save-every 150 --log fit.log >logs/out
"$fixsplat" $fit $few -o resumed.fxs --resume part.fxs.fit --log fit.log >logs/out
check "--log, --resume: behind what was there" equal "$(cut -f 1 fit.log | tr '\n' ' ')" \
    "$(awk 'BEGIN { printf "step "; for (i = 1; i <= 620; i++) if (i <= 300 ? i % 3 == 0 : 0) printf "%d ", i
        for (i = 151; i <= 620; i++) if (i % 7 == 0 || i == 620) printf "%d ", i }')"
rm -f new.log
"$fixsplat" $fit $few -o resumed.fxs --resume part.fxs.fit --log new.log >logs/out
check "--log, --resume: a new one has a header" equal "$(head -n 1 new.log | cut -f 1)" step
if [ -c /dev/full ]; then
    loud $fit -o logged.fxs --log /dev/full
    check "--log: a full disk: said once, and the fit goes on" equal "$status $(said)" \
        "0 fixsplat: --log /dev/full: cannot be written: No space left on device; the fit goes on without it"
    check "--log: a full disk: the same file" cmp whole.fxs logged.fxs
fi
(
    trap '' XFSZ
    ulimit -f 1
    exec "$fixsplat" $fit -o set.fit --log fit.log >logs/out 2>logs/err
)
check "--log: a disk that is full after some lines" grep -q -- '--log fit.log: .*; the fit goes on without it' logs/err
fails "--log: no such folder" 1 "--log none/fit.log: cannot be written: No such file" fit set -o x.fxs --log none/fit.log
fails "--log is OUT" 2 "x.fxs" fit set -o x.fxs --log x.fxs
fails "--log is a photograph" 2 "set/images/03.png: is read and cannot be written too" fit set -o x.fxs --steps 2 \
    --log set/images/03.png
fails "--log and --measure" 2 "log does not go with --measure: nothing is fitted" fit set --measure whole.fxs --log fit.log
fails "--crop-to-subject and --measure" 2 "crop-to-subject does not go with --measure" fit set --measure whole.fxs --crop-to-subject
fails "--log and --cameras-only" 2 "cameras-only: nothing is fitted: leave out --log" fit set -o x.fxs --cameras-only --log fit.log
fails "--log of block 0" 2 "--block 0: nothing is fitted" fit set -o x.ply --block 0/2 --coarse set.fit --log fit.log
rm -f part.fxs.fit set.fit fit.log new.log

# ---- Measured quality ------------------------------------------------------------------------------------------------

mkdir -p large/sparse/0 large/images
sed 's/64 48 60 60 32 24/1700 1275 1594 1594 850 637/' set/sparse/0/cameras.txt >large/sparse/0/cameras.txt
cp set/sparse/0/points3D.txt large/sparse/0
head -n 4 set/sparse/0/images.txt >large/sparse/0/images.txt
"$fixsplat" render knot.ply --cameras large/sparse/0 --view all -o large/images/%02d.png --threads 2
while read -r quality recipe size most; do
    loud fit large --steps 1 --quality $quality -o few.fxs
    check "--quality $quality: photographs of $size" grep -q "up to $size;" logs/err
    check "--quality $quality: recipe $recipe" grep -q "; 1 steps, recipe $recipe, seed 0$" logs/out
    check "--quality $quality: says what it chose" grep -q "^fixsplat: --quality $quality: 1 steps of the recipe $recipe,\
 photographs of at most ${size%x*} pixels, at most $most Gaussians$" logs/err
    "$fixsplat" fit set --steps 12 --quality $quality -o few.fxs >logs/out
    "$fixsplat" fit set --steps 12 --recipe $recipe -o again.fxs >logs/out
    check "--quality $quality: the scene of recipe $recipe" cmp few.fxs again.fxs
done <<'END'
draft fast 800x600 250000
good fast 1600x1200 250000
best mcmc 1600x1200 1000000
END
loud fit large --steps 1 --quality draft --resolution 300 -o few.fxs
check "--quality draft --resolution: as it says" grep -q "up to 300x225;" logs/err
succeeds "--quality draft: its steps" fit set --quality draft -o few.fxs --save-every 2999 --max-gaussians 500
check "--quality draft: its steps" grep -q "; 3000 steps, recipe fast," logs/out
fails "--resume: another quality" 2 "--quality: few.fxs.fit was begun with another" fit set -o x.fxs \
    --resume few.fxs.fit --quality best
succeeds "--resume: with its quality" fit set -o again.fxs --resume few.fxs.fit --quality draft
check "--resume: with its quality" cmp few.fxs again.fxs
"$fixsplat" fit set --steps 12 --recipe mcmc --max-gaussians 250000 -o again.fxs >logs/out
loud fit set --steps 12 --quality draft --recipe mcmc -o few.fxs
check "--quality draft --recipe: as they say" cmp few.fxs again.fxs
check "--quality draft --recipe: says what it chose" equal "$(said)" "fixsplat: --quality draft: 12 steps of the recipe \
mcmc, photographs of at most 800 pixels, at most 250000 Gaussians"
loud fit set --steps 12 --quality best --recipe reference --max-gaussians 900 --resolution 60 -o few.fxs
check "--quality best and all options: says what it chose" equal "$(said)" "fixsplat: --quality best: 12 steps of the \
recipe reference, photographs of at most 60 pixels, at most 900 Gaussians"
loud fit set --measure few.fxs --quality draft
check "--quality and --measure: says nothing" equal "$status $(said)" "0 "
rm -rf large few.fxs.fit

# ---- Stopped and resumed ---------------------------------------------------------------------------------------------

succeeds "--save-every" $fit -o part.fxs --save-every 300
check "--save-every: the same file" cmp whole.fxs part.fxs
succeeds "--resume" $fit -o resumed.fxs --resume part.fxs.fit --threads 2
check "--resume: the same file" cmp whole.fxs resumed.fxs
succeeds "--batch" fit set --steps 60 -o batch.ply --batch 2 --threads 1
"$fixsplat" fit set --steps 60 -o again.ply --batch 2 --threads 2 --save-every 31 >logs/out
check "--batch, 2 threads: the same file" cmp batch.ply again.ply
"$fixsplat" fit set --steps 60 -o again.ply --resume again.ply.fit >logs/out
check "--batch, resumed: the same file" cmp batch.ply again.ply
"$fixsplat" fit set --steps 60 -o plain.ply >logs/out
for exposure in affine gain; do
    succeeds "--exposure $exposure" fit set --steps 60 -o exposed.ply --exposure $exposure --threads 1 --save-every 31
    check "--exposure $exposure: another file" [ "$(cmp -s plain.ply exposed.ply; echo $?)" = 1 ]
    cp exposed.ply.fit exposed.fit
    "$fixsplat" fit set --steps 60 -o again.ply --resume exposed.fit --threads 2 --cpu c >logs/out
    check "--exposure $exposure, resumed, 2 threads, plain C: the same file" cmp exposed.ply again.ply
    cp exposed.ply plain.ply
done
fails "--resume: affine for gain" 2 "--exposure: exposed.fit was begun with another" fit set --steps 60 -o x.fxs \
    --resume exposed.fit --exposure affine
fails "--resume: another exposure" 2 "--exposure: exposed.fit was begun with another" fit set --steps 60 -o x.fxs \
    --resume exposed.fit --exposure none
fails "--exposure of a block" 2 "--exposure with --block needs --coarse" fit set -o x.ply --exposure gain --block 1/2
loud fit set --steps 60 -o sky.ply --sky=3000 --threads 1 --save-every 31
check "--sky: said" grep -Eq '^fixsplat: set: begins with a sky of [1-9][0-9]+ Gaussians$' logs/err
check "--sky: another file" [ "$(cmp -s plain.ply sky.ply; echo $?)" = 1 ]
cp sky.ply.fit sky.fit
"$fixsplat" fit set --steps 60 -o again.ply --resume sky.fit --threads 2 --cpu c >logs/out
check "--sky, resumed, 2 threads, plain C: the same file" cmp sky.ply again.ply
fails "--resume: another sky" 2 "--sky: sky.fit was begun with another" fit set --steps 60 -o x.fxs --resume sky.fit \
    --sky=2000
fails "--sky of a block" 2 "--sky with --block needs --coarse" fit set -o x.ply --sky=3000 --block 1/2
fails "--sky 0" 2 "--sky=0: expected 1 to 1000000 directions" fit set -o x.fxs --sky=0
fails "--sky: too many" 2 "--sky=1000001: expected" fit set -o x.fxs --sky=1000001
cp -r set bare && head -n 3 set/sparse/0/points3D.txt | grep '^#' >bare/sparse/0/points3D.txt
loud fit bare --steps 9 -o x.fxs --of outdoors
check "--of outdoors without points: no sky" grep -q 'bare has no points to find the sky from: --of outdoors adds none' logs/err
fails "--sky without points" 1 "--sky: bare has no points" fit bare --steps 9 -o x.fxs --sky
succeeds "--refine-poses" fit set --steps 540 -o posed.ply --refine-poses --exposure gain --threads 1 --save-every 520
"$fixsplat" fit set --steps 540 -o plain.ply --exposure gain >logs/out
check "--refine-poses: another file" [ "$(cmp -s plain.ply posed.ply; echo $?)" = 1 ]
cp posed.ply.fit posed.fit
"$fixsplat" fit set --steps 540 -o again.ply --resume posed.fit --threads 2 --cpu c >logs/out
check "--refine-poses, resumed, 2 threads, plain C: the same file" cmp posed.ply again.ply
places() { sed 's/.*"img_name": "\([^"]*\)".*"position": \(\[[^]]*\]\).*/\1 \2/' "$1" | sort; }
"$fixsplat" fit set --steps 540 -o again.ply --exposure gain --refine-poses --write-cameras posed.json >logs/out
check "--write-cameras: the same file" cmp posed.ply again.ply
"$fixsplat" fit set --steps 20 -o few.fxs --write-cameras plain.json >logs/out
places plain.json >plain.txt
places posed.json >posed.txt
check "--write-cameras: all, those that are held out as they were" equal "$(wc -l <plain.txt | tr -d ' ') $(
    join plain.txt posed.txt | awk '$2 $3 $4 == $5 $6 $7 { printf "%s ", $1 }')" "12 00.png 08.png "
check "--write-cameras: for render" "$fixsplat" render few.fxs --cameras posed.json --view 3 -o view.png
fails "--write-cameras: no such folder" 1 "none/x.json: cannot be written: No such file" $fit -o x.fxs \
    --write-cameras none/x.json
fails "--write-cameras: OUT" 2 "x.fxs: " $fit -o x.fxs --write-cameras x.fxs
fails "--resume: poses that stay" 2 "--refine-poses: part.fxs.fit was begun with another" $fit -o x.fxs \
    --resume part.fxs.fit --refine-poses
fails "--refine-poses of a block" 2 "--refine-poses with --block needs --coarse" fit set -o x.ply --refine-poses \
    --block 1/2
succeeds "--antialiased" fit set --steps 60 -o smooth.fxs --antialiased --threads 1 --save-every 31
"$fixsplat" info smooth.fxs >logs/out
check "--antialiased: the scene says so" grep -q '^format  *fxs, anti-aliased$' logs/out
cp smooth.fxs.fit smooth.fit
"$fixsplat" fit set --steps 60 -o again.fxs --resume smooth.fit --threads 2 --cpu c >logs/out
check "--antialiased, resumed, 2 threads, plain C: the same file" cmp smooth.fxs again.fxs
fails "--resume: antialiased" 2 "--antialiased: part.fxs.fit was begun with another" $fit -o x.fxs \
    --resume part.fxs.fit --antialiased
succeeds "--surfaces" fit set --steps 60 -o flat.fxs --surfaces --threads 1 --save-every 31
"$fixsplat" fit set --steps 60 -o again.fxs --threads 1 >logs/out
check "--surfaces: another file" [ "$(cmp -s flat.fxs again.fxs; echo $?)" = 1 ]
cp flat.fxs.fit flat.fit
"$fixsplat" fit set --steps 60 -o again.fxs --resume flat.fit --threads 2 --cpu c >logs/out
check "--surfaces, resumed, 2 threads, plain C: the same file" cmp flat.fxs again.fxs
fails "--resume: surfaces" 2 "--surfaces: part.fxs.fit was begun with another" $fit -o x.fxs --resume part.fxs.fit \
    --surfaces
fails "--surfaces of a block without them" 2 "--surfaces: part.fxs.fit was begun without it" fit set -o x.ply \
    --surfaces --block 1/2 --coarse part.fxs.fit
fails "--surfaces --moving" 2 "--surfaces" fit set -o x.fxs --moving --surfaces
cp part.fxs.fit given.fxs
fails "OUT is the file that it goes on from" 2 "given.fxs: is read and cannot be written too" $fit -o given.fxs --resume given.fxs
fails "--resume: another batch" 2 "--batch: again.ply.fit was begun with another" fit set --steps 60 -o x.fxs \
    --resume again.ply.fit --batch 3
run fit set -o resumed.fxs --resume part.fxs.fit
check "--resume: the steps are the file's" cmp whole.fxs resumed.fxs

stops() {
    rm -f "it's.fxs" "it's.fxs.fit"
    ended=$(unset FIXSPLAT_QUIET && $helper signal "$1" "$fixsplat" $fit -o "it's.fxs" --save-every 20 2>logs/err)
    check "$2: ends as it does" equal "$ended" "signal $1"
    check "$2: no scene yet" [ ! -e "it's.fxs" ]
    check "$2: a line" equal "$(said | wc -l | tr -d ' ')" 1
    on=$(sed -n "s/^fixsplat: stopped after [0-9]* steps of $steps; to go on: fixsplat //p" logs/err)
    eval "\"\$fixsplat\" $on" >logs/out 2>logs/err
    check "$2: to go on as it says: the same file" cmp whole.fxs "it's.fxs"
}
stops 2 "Ctrl-C"
stops 15 "SIGTERM"
stops 1 "SIGHUP"

rm -f "it's.fxs" "it's.fxs.fit"
ended=$($helper signal 15 "$fixsplat" $fit -o "it's.fxs" --save-every 20 --quiet 2>logs/err)
check "SIGTERM, --quiet: saved, not a word" equal "$ended $(ls "it's.fxs.fit") $(cat logs/err)" "signal 15 it's.fxs.fit "
fails "--resume: another seed" 2 "--seed: part.fxs.fit was begun with another" $fit -o x.fxs --resume part.fxs.fit --seed 3
fails "--resume: another recipe" 2 "--recipe: " $fit -o x.fxs --resume part.fxs.fit --recipe mcmc
fails "--resume: another size" 1 "part.fxs.fit: a fit of other photographs" $fit -o x.fxs --resume part.fxs.fit \
    --resolution 32
fails "--resume: other photographs are fitted" 1 "other photographs" $fit -o x.fxs --resume part.fxs.fit --hold-out 4
fails "--resume: no such file" 1 "none.fit: No such file" $fit -o x.fxs --resume none.fit
fails "--resume: another kind of file" 1 "knot.ply: not a saved fit" $fit -o x.fxs --resume knot.ply
head -c 20000 part.fxs.fit >short.fit
fails "--resume: a part of one" 1 "short.fit: damaged: it ends early" $fit -o x.fxs --resume short.fit

# ---- Full disks ------------------------------------------------------------------------------------------------------

if [ -c /dev/full ]; then
    ln -s /dev/full full.fxs
    loud fit set --steps 20 -o full.fxs
    check "a full device: said, and saved" equal "$status $(said)" \
        "1 fixsplat: full.fxs: cannot be written: No space left on device
fixsplat: saved after 20 steps of 20; to go on: fixsplat fit set --steps 20 -o full.fxs --resume full.fxs.fit"
    check "what is saved goes on" "$fixsplat" fit set --resume full.fxs.fit -o rest.fxs
    "$fixsplat" fit set --steps 20 -o few.fxs >/dev/full 2>logs/err
    check "a report into a full device" equal "$? $(cat logs/err)" "1 fixsplat: cannot write to standard output"
    check "what was saved is the same scene" cmp few.fxs rest.fxs
else
    skip "a full device" "no /dev/full here"
fi
"$fixsplat" fit set --steps 20 -o small.fxs >logs/out
echo old >small.fxs.fit
(
    trap '' XFSZ
    ulimit -f 128
    exec "$fixsplat" fit set --steps 20 -o small.fxs --save-every 8 >logs/out 2>logs/err
)
check "no room to save: it goes on, and says so" equal "$? $(grep -c 'small.fxs.fit: cannot be written: File too large' \
    logs/err) $(wc -l <logs/err | tr -d ' ')" "0 2 2"
check "no room to save: the last one stays" equal "$(cat small.fxs.fit)" old
check "nothing is left" equal "$(find . -name '.fixsplat-*')" ""

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "--batch 0" 2 "--batch 0: expected a whole number from 1 to 8" $fit -o x.fxs --batch 0
fails "--batch 9" 2 "--batch 9: expected a whole number from 1 to 8" $fit -o x.fxs --batch 9
fails "--backend gles" 2 "expected cpu, cuda or vulkan" $fit -o x.fxs --backend gles
fails "--batch 3 on two devices" 2 "not a multiple of the 2 devices" $fit -o x.fxs --backend cuda --device 0,1 \
    --batch 3
if "$fixsplat" info --backends | grep -Eq "^cuda.*(no NVIDIA|nvcc)"; then
    fails "--backend cuda without a device" 1 "NVIDIA|nvcc" $fit -o x.fxs --backend cuda
fi

fails "no photographs" 2 "takes one folder" fit -o x.fxs
fails "two folders" 2 "takes one folder" fit set set -o x.fxs
fails "no output" 2 "where to" fit set
fails "two outputs" 2 "--output y.fxs: --output x.fxs is given before" fit set -o x.fxs -o y.fxs
fails "another ending" 2 "x.png: expected a name ending in .fxs, .ply or .fit" fit set -o x.png
fails "no such folder" 1 "none/x.fxs: cannot be written: No such file" fit set -o none/x.fxs
mkdir folder.fxs
fails "a folder" 1 "folder.fxs: cannot be written: Is a directory" fit set -o folder.fxs
mkdir taken
cp -r set taken/set
mv taken/set/images/00.png taken/set/images/0000_00.png
sed 's/ 00.png/ 0000_00.png/' set/sparse/0/images.txt >taken/set/sparse/0/images.txt
cp taken/set/images/0000_00.png taken/0000_00.png
ln taken/set/images/0000_00.png taken/set/images/0000_0000_00.png
fails "--compare: a picture is a photograph" 2 "taken/set/images/0000_0000_00.png: is read and cannot be written too" \
    fit taken/set -o x.fxs --steps 5 --compare taken/set/images
check "--compare: the photograph stays" cmp taken/set/images/0000_00.png taken/0000_00.png
cp set/images/03.png photo.ply
cp -r set other
ln -sf ../../photo.ply other/images/03.png
fails "OUT is a photograph" 2 "photo.ply: is read and cannot be written too" fit other -o photo.ply --steps 5
check "OUT is a photograph: it stays" cmp photo.ply set/images/03.png
mv photo.ply photo.fxs.fit
ln -sf ../../photo.fxs.fit other/images/03.png
fails "OUT.fit is a photograph" 2 "photo.fxs.fit: is read and cannot be written too" fit other -o photo.fxs --steps 5 \
    --save-every 2
check "OUT.fit is a photograph: it stays" cmp photo.fxs.fit set/images/03.png
"$fixsplat" fit set --steps 9 -o same.fxs --save-every 5 >logs/out
ln -s same.fxs.fit linked.fit
succeeds "--resume of OUT.fit, by another name" fit set --steps 9 -o same.fxs --save-every 2 --resume linked.fit
fails "--compare: a file" 1 "knot.ply: not a folder" fit set -o x.fxs --compare knot.ply
fails "--compare: no such folder" 1 "none/pictures: No such file" fit set -o x.fxs --compare none/pictures
fails "an unknown option" 2 "unknown option" fit set -o x.fxs --fast
while read -r option; do
    fails "--$option" 2 "^fixsplat: --" fit set -o x.fxs --$option
done <<'END'
recipe slow
quality high
exposure auto
steps 0
steps -1
steps 3x
resolution 0
resolution 20000
sh-degree 4
max-gaussians 0
seed x
cutoff round
background 12345
profile tiny
hold-out -1
save-every 0
threads 0
threads 65
cpu sse9
END
fails "no such photographs" 1 "none" fit none -o x.fxs
cp -r set missing
rm missing/images/03.png
missing=': No such file or directory \(a photograph of [a-z]*/sparse/0/images.txt; skip_bad, --skip-bad, leaves such out\)'
fails "a photograph is missing" 1 "missing/images/03.png$missing" fit missing -o x.fxs --steps 5
cp -r set held
rm held/images/08.png
fails "a photograph that is held out is missing" 1 "held/images/08.png$missing" fit held -o x.fxs --steps 5
loud fit missing -o x.fxs --steps 5 --skip-bad
check "--skip-bad: goes on, and says so" equal "$status $(said)" \
    "0 fixsplat: left out: missing/images/03.png: No such file or directory
fixsplat: missing: photographs left out: 1, taken: 11"
cp -r set more
cp set/images/03.png more/images/extra.png
loud fit more -o x.fxs --steps 5
check "a photograph without a camera: named" equal "$status $(said)" \
    "0 fixsplat: left out: more/images: 1 photograph has no camera: extra.png"
echo >missing/sparse/0/images.txt
fails "no cameras" 1 "missing" fit missing -o x.fxs --steps 5
cp -r set behind
awk '{ $2 = 1; $4 = 0; if (NF > 1) print; else print "" }' set/sparse/0/images.txt >behind/sparse/0/images.txt
awk '{ $4 = -1000; print }' set/sparse/0/points3D.txt >behind/sparse/0/points3D.txt
fails "points behind every camera" 1 "behind" fit behind -o x.fxs --steps 5
finish
