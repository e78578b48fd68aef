#!/bin/sh
# Runs each command with one failing memory allocation, or with all later allocations failing too. The command must
# succeed, or print one line, exit with status 1 and leave no files. Tests 40 allocations of each command, 80 with
# FXS_PROCESSORS=all, all with EVERY=1.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"

[ "$FXS_PROCESSORS" = all ] && spread=40 || spread=20
faults=$work/logs/faults.so
if ! ${CC:-cc} -O1 -shared -fPIC -o $faults "$root/tests/scripts/lib/faults.c" -ldl 2>logs/err ||
    ! FAULT_LOG=logs/calls LD_PRELOAD=$faults "$fixsplat" --version >logs/out 2>logs/err || ! [ -s logs/calls ]; then
    skip "out of memory" "nothing can be preloaded here: $(head -n 1 logs/err)"
    finish
    exit
fi
"$fixsplat" make-scene knot --count 300 -o knot.ply || exit 1
"$fixsplat" convert knot.ply packed.fxs || exit 1
"$fixsplat" render knot.ply --size 64x48 -o a.png || exit 1
"$fixsplat" render knot.ply --size 64x48 --bg 010101 -o b.png || exit 1

# wrong COMMAND: prints what a command did wrong when memory ran out; prints nothing if all was right. A finished fit
# must be kept even if packing or measuring fails.
wrong() {
    case $status in
    0) [ ! -e logs/right ] || cmp "$written" logs/right ;;
    1) [ "$1" != fit ] || sed -i -e "2{ /^fixsplat: saved after 4 steps of 4; to go on: /d; /^fixsplat: $written.fit: /d }" logs/err
        [ "$(wc -l <logs/err)" = 1 ] && grep '^fixsplat: ' logs/err >logs/line || cat logs/err
        if [ "$1" != fit ]; then ls "$written"; elif [ -e "$written" ]; then cmp "$written" logs/right; fi 2>/dev/null ;;
    *) echo "status $status: $(cat logs/err)" ;;
    esac
    grep -E 'damaged|bad JSON|ot a zip' logs/err
    ls .fixsplat-* 2>/dev/null
}

survives() {
    written=$1
    shift
    rm -f logs/right logs/calls logs/faults
    FAULT_LOG=logs/calls LD_PRELOAD=$faults "$fixsplat" "$@" >logs/out 2>logs/err
    [ ! -e "$written" ] || mv "$written" logs/right
    count=$(sed -n 's/ allocations//p' logs/calls)
    count=${count:-0}
    step=${EVERY:-$((count / spread + 1))}
    for ever in '' 1; do
        n=${ever:-2}
        while [ $n -le $count ]; do
            FAULT_AT=$n FAULT_EVER=$ever LD_PRELOAD=$faults "$fixsplat" "$@" >logs/out 2>logs/err
            status=$?
            why=$(wrong "$1" 2>&1)
            [ -z "$why" ] || echo "allocation $n${ever:+ and on}: $why" >>logs/faults
            rm -f -- "$written" "$written.fit" .fixsplat-*
            n=$((n + step))
        done
    done
    if [ $count -gt 2 ] && [ ! -s logs/faults ]; then
        ok "$* ($count allocations)"
    else
        fail "$*" "$count allocations, $(cat logs/faults)"
    fi
}

survives o.ply make-scene knot --count 300 -o o.ply
survives o.png render knot.ply --size 64x48 --threads 2 -o o.png
for ending in y4m rgba; do survives o.$ending render knot.ply --size 64x48 --threads 2 --orbit 3 -o o.$ending; done
for ending in jpg webp; do survives o.$ending render knot.ply --size 64x48 -o o.$ending; done
survives - render knot.ply --size 64x48 --expect b.png
make_photographs 3
"$fixsplat" fit set --quiet --steps 4 --save-every 2 -o half.fxs >logs/out || exit 1
survives o.fxs fit set --quiet --steps 4 --threads 2 -o o.fxs
survives o.ply fit set --quiet --steps 4 --resume half.fxs.fit -o o.ply
survives o.ppm render packed.fxs --size 64x48 --stereo 0.1 -o o.ppm
survives o.ppm render packed.fxs packed.fxs --place 1:1,0,0 --size 64x48 -o o.ppm
survives o.png render knot.ply --size 64x32 --panorama -o o.png
for aux in depth ids; do survives o.png render knot.ply --size 64x48 --$aux o.png; done
survives o.fxs convert knot.ply o.fxs
survives o.fxs convert knot.ply o.fxs --profile small
survives o.spz convert knot.ply o.spz
survives o.spz convert knot.ply o.spz --spz-version 3
survives o.splat convert knot.ply o.splat --sh-degree 0
survives o.compressed.ply convert knot.ply o.compressed.ply
survives o.rad convert knot.ply o.rad
survives o.sog convert knot.ply o.sog
survives o.glb convert knot.ply o.glb --drop-floaters
for ending in spz sog glb rad; do "$fixsplat" convert knot.ply read.$ending --quiet || exit 1; done
for ending in spz sog glb rad; do survives - info read.$ending; done
printf '[{"id": 0, "img_name": "a", "width": 64, "height": 48, "position": [0, 0, -6], "fx": 60, "fy": 60, %s}]' \
    '"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]' >cameras.json
printf '<document><chunk><sensors><sensor id="0"><resolution width="64" height="48"/><calibration><f>60</f>%s%s' \
    '</calibration></sensor></sensors><cameras><camera label="a" sensor_id="0"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1' \
    '</transform></camera></cameras></chunk></document>' >cameras.xml
for cameras in json xml; do survives - render packed.fxs --cameras cameras.$cameras --view 0 --hash; done
survives o.csv convert knot.ply o.csv --decimate 50%
survives - info knot.ply --stats
survives - info knot.ply
survives - info packed.fxs --compare knot.ply --size 64x48 --views 2
survives o.png compare a.png b.png --diff o.png
"$fixsplat" render knot.ply --size 64x48 -o a.jpg || exit 1
survives o.png compare a.jpg b.png --diff o.png
survives - bench knot.ply --size 64x48 --threads 2

serves() {
    rm -f logs/served
    FAULT_AT=$1 FAULT_EVER=$2 LD_PRELOAD=$faults "$fixsplat-web" --web --port 0 knot.ply >logs/served 2>logs/err &
    server=$!
    until [ -s logs/served ] || ! kill -0 $server 2>/dev/null; do sleep 0.05; done
    at=$(sed -n 's|^\(http://[^/]*\)/.*|\1|p;q' logs/served)
    [ -z "$at" ] || curl -s -m 2 -H 'Accept-Encoding: gzip' "$at/long.js" "$at/none" "$at/scenes/0.json" "$at/scenes/0/knot.ply.fxs" \
        >logs/got
    kill $server 2>/dev/null
    wait $server
    status=$?
    [ $status = 0 ] || { [ $status = 1 ] && [ "$(wc -l <logs/err)" = 1 ]; }
}
mkdir -p page/viewer
echo page >page/viewer/index.html
seq 2000 | tee page/long.js page/viewer/single.js >page/LICENSE
FIXSPLAT_WEB=$work/page
export FIXSPLAT_WEB
survives o.html publish --single knot.ply o.html --size 64x48
if [ -x "$fixsplat-web" ] && have curl; then
    for n in $(seq 3 9 160); do
        check "view --web, allocation $n" serves $n ''
        check "view --web, allocation $n and on" serves $n 1
    done
else
    skip "view --web" "no server or no curl here"
fi

"$fixsplat" render knot.ply --size 2000x2000 -o large.png || exit 1
if (ulimit -v 16000 && "$fixsplat" --version) >logs/out 2>&1; then
    (
        ulimit -v 16000
        fails "compare, in 16 MB" 1 "large.png: out of memory$" compare large.png large.png
        echo "passed=$passed failed=$failed" >logs/counts
    )
    . logs/counts
else
    skip "compare, in 16 MB" "the command does not begin in 16 MB"
fi
finish
