#!/bin/sh
# Tests `fixsplat bench --compare`, and tools/scripts/bench.sh on a copy of docs/measured.md.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

# ---- bench --compare -------------------------------------------------------------------------------------------------

small='--size 64x48 --threads 1'
"$fixsplat" make-scene knot --count 2000 -o knot.ply
"$fixsplat" make-scene knot --count 2000 --seed 2 -o other.ply
"$fixsplat" bench knot.ply $small --json >before.json
if [ "$("$fixsplat" bench knot.ply $small --compare before.json 2>&1 | grep -c 'built without cJSON')" = 1 ]; then
    skip "bench --compare" "built without cJSON"
else
    # All times of the earlier benchmark are changed to 2 ms. So each ratio must be half of the new time in
    # milliseconds.
    sed 's/\(_ms\|project\|shade\|sort\|bin\|blend\|resolve\)": [0-9.]*/\1": 2.000/g' before.json >twos.json
    succeeds "--compare" bench knot.ply $small --compare twos.json
    sed '1,/^medians/d' logs/out >ratios
    check "--compare: the stages and the frame" equal "$(awk 'NF == 4 && $2 == "2.000" { print $1 }' ratios | tr '\n' ' ')" \
        "project shade sort bin blend resolve frame "
    check "--compare: ratios" awk 'NF == 4 && ($4 - $3 / 2) ^ 2 > 1e-6 { wrong = 1 } END { exit wrong }' ratios
    check "--compare: nothing is marked" equal "$(grep -c '\*' ratios)" 0
    for change in 'threads": 1/threads": 7' 'backend": "cpu/backend": "gpu' 'cpu": "all/cpu": "avx9' \
        'processor": "[^"]*/processor": "Z80' 'max_memory": 0/max_memory": 5' 'cutoff": "mahalanobis/cutoff": "square'; do
        sed "s/\"$(echo "$change" | sed 's,/,/",')/" before.json >changed.json
        succeeds "another ${change%%\"*}" bench knot.ply $small --compare changed.json
        check "another ${change%%\"*}: every ratio is marked" equal "$(grep -c ' \*$' logs/out)" 7
        check "another ${change%%\"*}: said" grep -q "^\* not like with like: ${change%%\"*} is " logs/out
    done
    for options in '--size 65x48' '--sh-degree 1' '--fov 40' '--orbit 10' '--stereo 0.1' '--draw ids'; do
        fails "other options: $options" 1 "before.json cannot be compared: [a-z_0-9]*: " bench knot.ply $small $options \
            --compare before.json
    done
    fails "another scene" 1 "cannot be compared: (scenes|camera): " bench other.ply $small --compare before.json
    cp knot.ply renamed.ply
    fails "a scene of another name" 1 "cannot be compared: scenes: knot.ply there" bench renamed.ply $small \
        --compare before.json
    fails "--compare: no file" 1 "none.json: No such file" bench knot.ply $small --compare none.json
    for text in '' '{' '[]' '7' '{} {}'; do
        printf '%s' "$text" >bad.json
        fails "--compare: '$text'" 1 "bad.json: not the JSON object" bench knot.ply $small --compare bad.json
    done
    fails "--compare: a scene" 1 "knot.ply: too long" bench knot.ply $small --compare knot.ply
    for name in gaussians camera processor; do
        sed "s/\"$name\"/\"x\"/" before.json >bad.json
        fails "--compare: no $name" 1 "bad.json: no $name" bench knot.ply $small --compare bad.json
    done
    sed 's/"sort": [0-9.]*/"sort": "x"/' before.json >bad.json
    fails "--compare: no time of a stage" 1 "bad.json: no time of sort" bench knot.ply $small --compare bad.json
fi
fails "--compare --json" 2 "^fixsplat: --json does not go with --compare: it prints a table$" bench knot.ply $small \
    --compare before.json --json

# ---- tools/scripts/bench.sh --------------------------------------------------------------------------------------------------

mkdir programs
export ORDER= COMMAND="$fixsplat"
cat >programs/fixsplat <<'END'
#!/bin/sh
[ "$1" != make-scene ] || set -- make-scene landscape --count 2000 -o "$6"
[ "$1" != bench ] || set -- $(echo "$*" | sed 's/--frames [26]0/--frames 10/')
[ "$1" != "$ORDER" ] || { echo "fixsplat: told to fail" >&2; exit 1; }
[ "$ORDER" != sleep ] || exec sleep 30
exec "$COMMAND" "$@"
END
chmod +x programs/fixsplat

measure() {
    cat "$root/docs/measured.md" >document.md
    (cd "$root" && SCENES=$work/${SCENES_HERE:-none} B=$work/programs DOCUMENT=$work/document.md "$@") >logs/out 2>logs/err
    status=$?
}
unchanged() { cmp document.md "$root/docs/measured.md" && [ ! -e document.md.new ]; }

measure sh tools/scripts/bench.sh stereo
check "a part: measured" equal $status 0
sed '/^<!-- stereo: begin/,/^<!-- stereo: end/d' document.md >rest.md
sed '/^<!-- stereo: begin/,/^<!-- stereo: end/d' "$root/docs/measured.md" >rest-before.md
check "a part: nothing else changes" cmp rest.md rest-before.md
sed -n '/^<!-- stereo: begin/,/^<!-- stereo: end/p' document.md >part.md
check "a part: day, commit and machine" grep -Eq \
    '^Measured [0-9]{4}-[0-9]{2}-[0-9]{2}, commit [0-9a-z ]+, on .* \([0-9]+ processors\), ' part.md
check "a part: its rows" equal "$(grep -Ec '^\| landscape .*( \| [0-9.]+){3} \|$' part.md)" 2
check "no copy is left" [ ! -e document.md.new ]

part_fails() {
    ORDER=$1
    measure sh tools/scripts/bench.sh $2
    check "$1 fails: so does bench.sh" [ $status != 0 ]
    check "$1 fails: the document stays" unchanged
}
for order in make-scene bench; do part_fails $order stereo; done
if "$fixsplat" info --backends | grep -q '^gles  *here'; then
    for order in render compare; do part_fails $order gles; done
else
    skip "render and compare fail" "no gles here"
fi
mkdir -p captured/snowmiku captured/statue-st-peter
cp knot.ply captured/snowmiku/snowmiku.ply
cp other.ply captured/statue-st-peter/st-peter.ply
camera='{"img_name": "a", "width": 80, "height": 60, "fx": 90, "fy": 90, "position": [0, 0, -9],
    "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}'
{ printf '[%s' "$camera"; for i in 1 2 3 4 5 6 7 8; do printf ', %s' "$camera"; done; echo ']'; } >captured/snowmiku/cameras.json
ORDER=
SCENES_HERE=captured measure sh tools/scripts/bench.sh levels
check "levels: measured" equal $status 0
sed -n '/^<!-- levels: begin/,/^<!-- levels: end/p' document.md >part.md
check "levels: the Gaussians that are left" equal "$(awk -F ' *[|] *' '/%/ { print $2, $3, $4 }' part.md | tr '\n' ';')" \
    "$(for name in snowmiku statue; do for n in '100 % 2000' '50 % 1000' '25 % 500' '10 % 200' '5 % 100'; do
        printf '%s %s;' $name "$n"; done; done)"
check "levels: the whole is near its floats, fewer are further from them" awk -F ' *[|] *' '
    /%/ && $3 == "100 %" { if (!($6 > 50)) wrong = 1; last = $6 }
    /%/ && $3 != "100 %" { if (!($6 > 5 && $6 < last)) wrong = 1; last = $6 }
    /%/ { rows++; if (!($5 > 0 && $7 > 0)) wrong = 1 }
    END { exit wrong || rows != 10 }' part.md

if have node; then
    mkdir -p captured/luma-seal kept programs/page/node_modules
    cp knot.ply captured/luma-seal/luma-seal.ply
    "$fixsplat" convert knot.ply kept/luma-seal-refined.fxs --levels
    SCENES_HERE=captured measure env KEPT="$work/kept" CAPTURED=luma-seal ROUNDS=1 sh tools/scripts/bench.sh budgets
    check "budgets: measured" equal $status 0
    sed -n '/^<!-- budgets: begin/,/^<!-- budgets: end/p' document.md >part.md
    check "budgets: less and less" equal "$(awk -F ' *[|] *' '/%/ { print $3 }' part.md | tr '\n' ' ')" \
        "2000 1000 500 250 125 63 "
    check "budgets: all is equal, fewer are further from it, and no more are drawn" awk -F ' *[|] *' '
        /%/ && $3 == 2000 { if ($7 != "equal" || $8 != "equal") wrong = 1; last = 99 }
        /%/ && $3 < 2000 { if (!($7 + 0 > 5 && $7 + 0 <= last) || $7 != $8) wrong = 1; last = $7 + 0 }
        /%/ && $3 < 2000 && $3 >= 256 && $5 > $3 { wrong = 1 }
        /%/ { rows++ }
        END { exit wrong || rows != 6 }' part.md
else
    skip "budgets" "no node here"
fi

ORDER=sleep
for signal in INT TERM; do
    measure env --default-signal=$signal timeout -s $signal 1 sh tools/scripts/bench.sh stereo
    check "SIG$signal: ended by it" equal $status 124
    check "SIG$signal: the document stays" unchanged
done
ORDER=
measure sh tools/scripts/bench.sh levels colours
check "a part that is not: fails" [ $status != 0 ]
check "a part that is not: said" grep -q 'no part colours' logs/err
check "a part that is not: the document stays" unchanged

# ---- tools/scripts/plot.awk --------------------------------------------------------------------------------------------------

draw() { awk -v plot="$1" -f "$root/tools/scripts/plot.awk" "$2"; }
sizes='<!-- sizes: begin -->
Measured today, on a machine; not this.
| scene | form | bytes a Gaussian | PSNR, dB | SSIM | import, s |
|---|---|---|---|---|---|
| a | default | 60 | 50.00 (40.00, close) | 1 | 1 |
| a | small | 20 | 40.00 (30.00, close) | 1 | 1 |
| a & b | compact | 40 | 60.00 (30.00, close) | 1 | 1 |
| a | pixel stage alone | | 70.00 (60.00, close) | 1 | |
<!-- sizes: end -->
| b | small | 30 | 45.00 (30.00, close) | 1 | 1 |'
printf '%s\n' "$sizes" >table.md
draw sizes table.md >plot.svg
check "plot: default at 60 bytes, 50 dB" grep -q '<circle cx="700.0" cy="235.0"' plot.svg
check "plot: small at 20 bytes, 40 dB" grep -q 'd="M70.0 400.0' plot.svg
check "plot: compact at 40 bytes, 60 dB" grep -q 'd="M385.0 70.0' plot.svg
check "plot: no other mark but the legend's" equal "$(grep -c 'class="s[1-4]"' plot.svg)" 7
check "plot: where it was measured" grep -q '>Measured today, on a machine<' plot.svg
levels='<!-- levels: begin -->
Measured today; not this.
| scene | left | Gaussians | bytes | PSNR, dB | frame |
|---|---|---|---|---|---|
| a | 100 % | 100 | 9000 | equal | 20.04 |
| a | 50 % | 50 | 5000 | 50.0 | 10.000 |
| a | 25 % | 25 | 2500 | 40.0 | 5.000 |
| b | 100 % | 10 | 900 | equal | 3 |
| b | 50 % | 5 | 500 | 30.0 | 2 |
<!-- levels: end -->
| b | 5 % | 5 | 500 | 30.0 | 2 |'
printf '%s\n' "$levels" >table.md
draw levels table.md >plot.svg
check "plot: a line from 50 % to 25 %" grep -q '<path d="M700.0 70.0L385.0 235.0" class="path l1"/>' plot.svg
check "plot: 50 % of b" grep -q 'd="M196.0 400.0' plot.svg
check "plot: what is left" equal "$(grep -o '>[0-9]* %<' plot.svg | tr '\n' ' ')" ">50 %< >25 %< >50 %< "
check "plot: the whole" grep -q '>a, all: 20.0 ms<' plot.svg
"${fixsplat%/*}/tests/test_pace" slow throttling bursty >pace.txt
for plot in sizes growth levels budgets times pace; do
    [ $plot = pace ] && table=pace.txt || table=$root/docs/measured.md
    draw $plot "$table" >plot.svg
    check "docs/$plot.svg is of its table: make plot" cmp plot.svg "$root/docs/$plot.svg"
    if have rsvg-convert; then
        check "$plot.svg is drawn" rsvg-convert plot.svg -o plot.png
        check "$plot.svg has its size" equal "$("$fixsplat" compare plot.png plot.png)" equal
    else
        skip "$plot.svg is drawn" "no rsvg-convert here"
    fi
done
for plot in sizes growth levels budgets times pace colours; do
    draw $plot /dev/null >plot.svg 2>logs/err && fail "plot $plot of nothing" "no error" || ok "plot $plot of nothing: fails"
    check "plot $plot of nothing: said" equal "$(grep -c '^plot.awk: no ' logs/err)" 1
done

finish
