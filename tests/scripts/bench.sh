#!/bin/sh
# tools/bench.sh on a copy of docs/performance.md, with a landscape of 2,000 Gaussians for a million: a part is replaced as a
# whole, or the document stays as it is.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

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
