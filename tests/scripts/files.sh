#!/bin/sh
# Tests output files of the command fixsplat: special files, signals and full devices.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

write="make-scene knot --count 2000 -o"
"$fixsplat" $write knot.ply || exit 1
convert="convert knot.ply"
for ending in ply splat spz fxs compressed.ply sog rad glb csv; do "$fixsplat" $convert plain.$ending 2>logs/err || exit 1; done
"$fixsplat" render knot.ply --size 64x48 -o plain.png || exit 1

mode() { stat -c %a "$1" 2>/dev/null || stat -f %Lp "$1"; }
left() { find . -name '.fixsplat-*'; }

# ---- Permissions -----------------------------------------------------------------------------------------------------

touch own.ply && chmod 600 own.ply
succeeds "over a file of mode 600" $write own.ply
check "over a file of mode 600: still 600" equal "$(mode own.ply)" 600
check "over a file of mode 600: the bytes" cmp own.ply knot.ply
chmod 666 own.ply
(umask 077 && "$fixsplat" $write own.ply)
check "over a file of mode 666, umask 077: still 666" equal "$(mode own.ply)" 666
(umask 027 && "$fixsplat" $write new.ply)
check "a new file: as umask has it" equal "$(mode new.ply)" 640

# ---- Links, FIFOs and devices ----------------------------------------------------------------------------------------

mkdir there
echo old >there/target.ply
ln -s there link
ln -s there/target.ply one.ply
ln -s one.ply two.ply
ln -s link/new.ply dangling.ply
ln -s nowhere/new.ply lost.ply
ln -s loop.ply loop.ply
succeeds "a link to a link" $write two.ply
check "a link to a link: both stay" equal "$(readlink two.ply) $(readlink one.ply)" "one.ply there/target.ply"
check "a link to a link: the file at its end" cmp there/target.ply knot.ply
succeeds "a link to nothing" $write dangling.ply
check "a link to nothing: stays" equal "$(readlink dangling.ply)" link/new.ply
check "a link to nothing: its target is made" cmp there/new.ply knot.ply
fails "a link into no folder" 1 "lost.ply: cannot be written: No such file" $write lost.ply
fails "a link to itself" 1 "loop.ply: cannot be written: Too many" $write loop.ply

through() {
    ending=$1
    shift
    mkfifo pipe.$ending
    ln pipe.$ending held.$ending
    cat held.$ending >got &
    run "$@" pipe.$ending
    : <>held.$ending
    wait
    check "a FIFO as .$ending: stays" [ -p pipe.$ending ]
    check "a FIFO as .$ending: the bytes" cmp got plain.$ending
}
through ply $convert
through splat $convert
through spz $convert
through fxs $convert
through compressed.ply $convert
through sog $convert
through rad $convert
through glb $convert
through csv $convert
through png render knot.ply --size 64x48 -o
# Tests write through links to devices, because a faulty command would replace a link, not the device.
ln -s /dev/stdout out.ply
check "standard output, to a pipe" equal "$("$fixsplat" $write out.ply | cksum)" "$(cksum <knot.ply)"
{ echo before && "$fixsplat" $write out.ply && echo after; } >mixed
{ echo before && cat knot.ply && echo after; } >wanted
check "standard output, to a file with more in it" cmp mixed wanted
ln -s /dev/null null.png
succeeds "a link to a device" render knot.ply --size 64x48 -o null.png
check "a link to a device: stays" equal "$(readlink null.png)" /dev/null
check "a device: stays" [ -c /dev/null ]

# ---- Inputs ----------------------------------------------------------------------------------------------------------

taken='is read and cannot be written too$'
render='render knot.ply --size 64x48'
succeeds "a scene for its folder" convert knot.ply set.sog
if have unzip && mkdir set && (cd set && unzip -q ../set.sog) 2>logs/err; then
    cp -r set kept
    for part in set/means_l.webp set/../set//quats.webp; do
        fails "a picture of an .sog folder, $part" 2 "$part: $taken" render set --size 64x48 -o $part
    done
    ln -s set/sh0.webp link.webp
    fails "a picture of an .sog folder, by a link" 2 "link.webp: $taken" render set/meta.json --size 64x48 -o link.webp
    check "the .sog folder is as it was" diff -r set kept
else
    skip "an .sog folder" "no unzip here"
fi
camera='"width": 64, "height": 48, "position": [0, 0, -6], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 60, "fy": 60'
echo "[{\"id\": 0, \"img_name\": \"a\", $camera}]" >cameras.json
ln cameras.json cameras.png
fails "the cameras" 2 "./cameras.png: $taken" render knot.ply --cameras cameras.json --ids ./cameras.png
fails "the expected picture, which is not there" 2 "none.png: $taken" $render --expect none.png -o none.png
ln -s later.png first.png
ln -s ./later.png second.png
fails "two links to one that is not there" 2 "(first|second).png: two outputs are one file" $render -o first.png \
    --ids second.png
mkdir views
fails "one name of two views" 2 "views/1[01].png: two outputs are one file" render knot.ply --size 8x6 --orbit 12 \
    -o views/%d.png --ids views/1%d.png
check "one name of two views: nothing is written" equal "$(ls views)" ""
cp knot.ply grown.ply
for output in - /dev/stdout; do
    "$fixsplat" render grown.ply --size 64x48 --format png -o $output 2>logs/err >>grown.ply
    check "-o $output behind the scene" equal "$? $(cat logs/err)" "2 fixsplat: $(echo $output |
        sed 's/^-/standard output/'): is read and cannot be written too"
done
"$fixsplat" render - --size 64x48 -o - <grown.ply 2>logs/err >>grown.ply
check "standard input behind itself" equal "$? $(cat logs/err)" \
    "2 fixsplat: standard output: is read and cannot be written too"
check "the scene is as it was" cmp grown.ply knot.ply

# A packed scene is rendered from the file that was opened, even after another file has taken its place.
"$fixsplat" convert knot.ply mapped.fxs
"$fixsplat" render mapped.fxs --size 64x48 --orbit 3 -o turn.rgba
mkfifo turn
"$fixsplat" render mapped.fxs --size 64x48 --orbit 3 -o turn --format rgba 2>logs/err &
{
    head -c 1 <&3 >got
    "$fixsplat" make-scene cubes --count 300 -o other.ply && "$fixsplat" convert other.ply mapped.fxs
    cat <&3 >>got
} 3<turn
wait $!
check "replaced while it is rendered: no error" equal "$? $(cat logs/err)" "0 "
check "replaced while it is rendered: the bytes" cmp got turn.rgba

# ---- Standard output and standard input ------------------------------------------------------------------------------

"$fixsplat" $write /dev/stdout >stdout.ply
check "/dev/stdout as a file" cmp stdout.ply knot.ply
{ "$fixsplat" $render -o /dev/stdout --format png; } | cat >stdout.png
check "/dev/stdout as a pipe" cmp stdout.png plain.png
"$fixsplat" $render -o closed.png --hash >&- 2>logs/err
check "standard output is closed: said" equal "$? $(cat logs/err)" "1 fixsplat: cannot write to standard output"
check "standard output is closed: the picture" cmp closed.png plain.png
"$fixsplat" render knot.ply --size 8x6 --orbit 600 -o open.rgba --hash >logs/out
"$fixsplat" render knot.ply --size 8x6 --orbit 600 -o closed.rgba --hash >&- 2>logs/err
check "standard output is closed: the film has nothing else" cmp closed.rgba open.rgba
"$fixsplat" $render -o - >&- 2>logs/err
check "standard output is closed: -o -" equal "$? $(cat logs/err)" \
    "1 fixsplat: standard output: cannot be written: Bad file descriptor"
for arguments in "render - --hash" "info -" "convert - x.ply" "convert - x.fxs" "bench -"; do
    "$fixsplat" $arguments <&- >logs/out 2>logs/err
    check "standard input is closed: $arguments" equal "$? $(cat logs/err)" "1 fixsplat: standard input: Bad file descriptor"
    "$fixsplat" $arguments <. >logs/out 2>logs/err
    check "standard input is a folder: $arguments" equal "$? $(cat logs/err)" "1 fixsplat: standard input: Is a directory"
done
for arguments in "info knot.ply" "info --backends" "bench knot.ply --size 64x48" "compare plain.png plain.png" "--help"; do
    { sleep 0.1; "$fixsplat" $arguments 2>logs/err; echo $? >logs/status; } 2>logs/shell | :
    check "a pipe that nobody reads: $arguments" equal "$(cat logs/status logs/err)" 141
done
for arguments in "render knot.ply --size 640x480 -o -" "make-scene knot --count 100000 -o -"; do
    { "$fixsplat" $arguments 2>logs/err; echo $? >logs/status; } 2>logs/shell | head -c 100 >logs/out
    check "a pipe that is closed after 100 bytes: ${arguments%% *}" equal "$(cat logs/status logs/err)" 141
    (trap '' PIPE; "$fixsplat" $arguments 2>logs/err; echo $? >logs/status) | head -c 100 >logs/out
    check "the same where SIGPIPE is ignored: ${arguments%% *}" equal "$(cat logs/status logs/err)" \
        "1
fixsplat: standard output: cannot be written: Broken pipe"
done

# ---- Full devices ----------------------------------------------------------------------------------------------------

if [ -c /dev/full ]; then
    ln -s /dev/full full.ply
    fails "a full device" 1 "full.ply: cannot be written: No space" $write full.ply
    for arguments in --help --version --kernels 'render --help' 'view --help' 'bench --help' 'info --help' \
        'convert --help' 'compare --help' 'make-scene --help' 'info --backends' 'info knot.ply' \
        'render knot.ply --size 64x48 --hash' 'compare plain.png plain.png'; do
        "$fixsplat" $arguments >/dev/full 2>logs/err
        check "$arguments, into a full device" equal "$? $(cat logs/err)" "1 fixsplat: cannot write to standard output"
    done
else
    skip "a full device" "no /dev/full here"
fi

# ---- Signals ---------------------------------------------------------------------------------------------------------

# Output files are large, so the commands still run when the signal arrives.
for signal in 1 2 13 15; do
    ended=$($helper signal $signal "$fixsplat" make-scene landscape --count 20000000 -o ended.ply)
    check "signal $signal: ends the command" equal "$ended" "signal $signal"
    check "signal $signal: nothing is left" equal "$(left; ls ended.ply 2>/dev/null)" ""
    rm -f .fixsplat-*
done
(
    trap '' TERM
    "$fixsplat" make-scene landscape --count 300000 -o ignored.ply &
    child=$!
    while ! ls .fixsplat-* >/dev/null 2>&1 && kill -0 $child 2>/dev/null; do :; done
    kill -TERM $child
    wait $child
    echo $? >logs/status
)
check "a signal that is ignored stays so" equal "$(cat logs/status) $(ls ignored.ply)" "0 ignored.ply"
(
    ulimit -f 100
    fails "beyond the limit of a file's size" 1 "ended.ply: cannot be written: File too large" make-scene landscape \
        --count 20000000 -o ended.ply
    echo "passed=$passed failed=$failed" >logs/counts
)
. logs/counts
check "beyond the limit of a file's size: nothing is left" equal "$(left; ls ended.ply 2>/dev/null)" ""

# ---- Leftovers of killed writers -------------------------------------------------------------------------------------

begin() {
    "$fixsplat" make-scene landscape --count 20000000 -o killed.ply &
    until ls -l /proc/$!/fd 2>/dev/null | grep -q 'fixsplat-.*tmp$' || ! kill -0 $! 2>/dev/null; do sleep 0.01; done
}
ended=$($helper signal 9 "$fixsplat" make-scene landscape --count 20000000 -o killed.ply)
check "killed: its file stays behind" equal "$ended $(left | wc -l)" "signal 9 1"
left_over=$(left)
succeeds "killed: another file" $write other.ply
check "killed: another file removes nothing" equal "$(left)" "$left_over"
begin
first=$!
check "killed: the next writer has its name" equal "$(left)" "$left_over"
succeeds "a writer beside another" $write killed.ply
check "a writer beside another: removes nothing" equal "$(left)" "$left_over"
begin
kill -KILL $first $!
wait $first $! 2>logs/shell
check "two killed: both files stay behind" equal "$(left | wc -l)" 2
chmod 444 "$left_over"
succeeds "two killed: the next" $write killed.ply
check "two killed: the next removes both" equal "$(left)" ""
mkfifo "$left_over"
ln -s knot.ply "${left_over%0.tmp}1.tmp"
succeeds "names that are taken" $write killed.ply
check "names that are taken: stay" equal "$(left | wc -l) $(readlink "${left_over%0.tmp}1.tmp")" "2 knot.ply"
rm -f .fixsplat-*

# ---- Order of disk writes --------------------------------------------------------------------------------------------

faults=$work/logs/faults.so
if ${CC:-cc} -O1 -shared -fPIC -o $faults "$root/tests/scripts/lib/faults.c" -ldl 2>logs/err &&
    FAULT_LOG=logs/calls LD_PRELOAD=$faults "$fixsplat" $write synced.ply 2>logs/err && [ -s logs/calls ]; then
    check "the file, its name, then the folder" equal "$(grep -v allocations logs/calls | tr '\n' ,)" \
        "fsync file,rename,fsync folder,"
else
    skip "what is on the disk when" "nothing can be preloaded here: $(head -n 1 logs/err)"
fi

check "no test has a name in /tmp that can be foreseen" equal \
    "$(grep -rn --include='*.[ch]' '"/tmp/' "$root/tests" | grep -v XXXXXX)" ""
check "no temporary file is left" equal "$(left)" ""
finish
