#!/bin/sh
# bench --compare, and tools/bench.sh on a copy of docs/performance.md, with a landscape of 2,000 Gaussians for a million: a part is replaced as a
# whole, or the document stays as it is.
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
    # Every time of before is 2 ms, so each ratio is half of what is here.
    sed 's/\(_ms\|project\|shade\|sort\|bin\|blend\|resolve\)": [0-9.]*/\1": 2.000/g' before.json >twos.json
    succeeds "--compare" bench knot.ply $small --compare twos.json
    sed '1,/^medians/d' logs/out >ratios
    check "--compare: the stages and the frame" equal "$(awk 'NF == 4 && $2 == "2.000" { print $1 }' ratios | tr '\n' ' ')" \
        "project shade sort bin blend resolve frame "
    check "--compare: ratios" awk 'NF == 4 && ($4 - $3 / 2) ^ 2 > 1e-6 { wrong = 1 } END { exit wrong }' ratios
    check "--compare: nothing is marked" equal "$(grep -c '\*' ratios)" 0
    for change in 'threads": 1/threads": 7' 'backend": "cpu/backend": "gpu' 'cpu": "all/cpu": "avx9' \
        'processor": "[^"]*/processor": "Z80' 'max_memory": 0/max_memory": 5'; do
        sed "s/\"$(echo "$change" | sed 's,/,/",')/" before.json >changed.json
        succeeds "another ${change%%\"*}" bench knot.ply $small --compare changed.json
        check "another ${change%%\"*}: every ratio is marked" equal "$(grep -c ' \*$' logs/out)" 7
        check "another ${change%%\"*}: said" grep -q "^\* not like with like: ${change%%\"*} is " logs/out
    done
    for options in '--size 65x48' '--cutoff square' '--sh-degree 1' '--fov 40' '--path 10' '--stereo 0.1' '--foveate' \
        '--draw ids'; do
        fails "other options: $options" 1 "before.json cannot be compared: its " bench knot.ply $small $options \
            --compare before.json
    done
    fails "another scene" 1 "cannot be compared: its (scenes|camera) is " bench other.ply $small --compare before.json
    cp knot.ply renamed.ply
    fails "a scene of another name" 1 "its scenes is knot.ply, here it is renamed.ply" bench renamed.ply $small \
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
fails "--compare --json" 2 "no --json" bench knot.ply $small --compare before.json --json

# ---- tools/bench.sh --------------------------------------------------------------------------------------------------

mkdir programs
export ORDER= COMMAND="$fixsplat"
cat >programs/fixsplat <<'END'
#!/bin/sh
[ "$1" != make-scene ] || set -- make-scene landscape --count 2000 -o "$6"
[ "$1" != "$ORDER" ] || { echo "fixsplat: told to fail" >&2; exit 1; }
[ "$ORDER" != sleep ] || exec sleep 30
exec "$COMMAND" "$@"
END
chmod +x programs/fixsplat

# measure COMMAND... PART: $status, logs/out, logs/err; the document is $work/document.md.
measure() {
    cp "$root/docs/performance.md" document.md
    (cd "$root" && SCENES=$work/none B=$work/programs DOCUMENT=$work/document.md "$@") >logs/out 2>logs/err
    status=$?
}
unchanged() { cmp document.md "$root/docs/performance.md" && [ ! -e document.md.new ]; }

measure sh tools/bench.sh stereo
check "a part: measured" equal $status 0
sed '/^<!-- stereo: begin/,/^<!-- stereo: end/d' document.md >rest.md
sed '/^<!-- stereo: begin/,/^<!-- stereo: end/d' "$root/docs/performance.md" >rest-before.md
check "a part: nothing else changes" cmp rest.md rest-before.md
sed -n '/^<!-- stereo: begin/,/^<!-- stereo: end/p' document.md >part.md
check "a part: day, commit and machine" grep -Eq \
    '^Measured [0-9]{4}-[0-9]{2}-[0-9]{2}, commit [0-9a-z ]+, on .* \([0-9]+ processors\), ' part.md
check "a part: its rows" equal "$(grep -Ec '^\| landscape .*( \| [0-9.]+){4} \|$' part.md)" 2
check "no copy is left" [ ! -e document.md.new ]

for order in make-scene bench render compare; do
    ORDER=$order
    measure sh tools/bench.sh stereo
    check "$order fails: so does bench.sh" [ $status != 0 ]
    check "$order fails: the document stays" unchanged
done
ORDER=sleep
for signal in INT TERM; do
    measure timeout -s $signal 1 sh tools/bench.sh stereo
    check "SIG$signal: ended by it" equal $status 124
    check "SIG$signal: the document stays" unchanged
done
ORDER=
measure sh tools/bench.sh stereo colours
check "a part that is not: fails" [ $status != 0 ]
check "a part that is not: said" grep -q 'no part colours' logs/err
check "a part that is not: the document stays" unchanged

finish
