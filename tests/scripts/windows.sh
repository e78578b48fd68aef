#!/bin/sh
# Runs the programs of `make windows` under wine. Pictures, files and fits must equal the results on Linux. Only with
# FXS_PROCESSORS=all.
. tests/scripts/lib/check.sh
wine=$(command -v wine64 || ls /usr/lib/wine/wine64 2>/dev/null)
compiler=${WINDOWS_CC:-x86_64-w64-mingw32-gcc}
if [ "$FXS_PROCESSORS" != all ]; then
    skip windows "only with FXS_PROCESSORS=all (make test-all)"
elif [ -z "$wine" ]; then
    skip windows "no wine64 here (make setup test-all)"
elif ! have "${compiler##* }"; then
    skip windows "no $compiler here (make setup windows)"
fi
[ $skipped = 0 ] || { finish; exit; }

built=${B:-build}/windows
env -u MAKEFLAGS make -s windows B="${B:-build}" WINDOWS_GOALS='all test-programs' >/dev/null ||
    { fail windows "make windows fails"; finish; exit 1; }
case $built in /*) ;; *) built=$PWD/$built ;; esac
. tests/scripts/lib/command.sh

export WINEPREFIX="$work/wine" WINEDEBUG=-all FIXSPLAT_QUIET=1
end_wine() { "$(dirname "$(readlink -f "$wine")")/wineserver" -k 2>/dev/null || wineserver -k 2>/dev/null; }
trap 'end_wine; rm -rf "$work"' EXIT
mkdir 'only this' && cp "$built/fixsplat.exe" 'only this/' || exit 1
program="$work/only this/fixsplat.exe"
w() { "$wine" "$program" "$@"; }
fixsplat_linux=$fixsplat

cat >logs/windows <<END
#!/bin/sh
exec "$wine" "$program" "\$@"
END
chmod +x logs/windows
refused() { kept=$wanted fixsplat=$work/logs/windows; fails "$@"; wanted=$kept fixsplat=$fixsplat_linux; }

w --version >logs/out 2>/dev/null
check "runs, and says which version it is" equal "$(w --version)" "$("$fixsplat" --version)"
check "ends no line but by a line feed" equal "$(w help formats | tr -d '\r' | cksum)" "$(w help formats | cksum)"
check "/?: help" equal "$(w /?) $(w render /?)" "$("$fixsplat" --help) $("$fixsplat" render --help)"
check "the same formats" equal "$(w help formats)" "$("$fixsplat" help formats)"

# ---- Pictures --------------------------------------------------------------------------------------------------------

"$fixsplat" make-scene knot --count 3000 -o knot.ply
w make-scene knot --count 3000 -o made.ply
check "make-scene: the same file" cmp made.ply knot.ply
wanted=$("$fixsplat" render knot.ply --hash)
for set in c sse41 avx2 avx512; do
    check "render --cpu $set: the same picture" equal "$(w render knot.ply --hash --cpu $set --threads 2)" "$wanted"
done
for ending in png jpg webp ppm; do
    "$fixsplat" render knot.ply -o linux.$ending && w render knot.ply -o windows.$ending
    check "render .$ending: the same file" cmp windows.$ending linux.$ending
done
check "render -o -: into a pipe" equal "$(w render knot.ply -o - --size 32x32 | cksum)" \
    "$("$fixsplat" render knot.ply -o - --size 32x32 | cksum)"
check "render: standard input" equal "$(w render - --hash <knot.ply)" "$wanted"
check "compare" equal "$(w compare windows.png linux.jpg)" "$("$fixsplat" compare windows.png linux.jpg)"
for scene in donut/donut.ply snowmiku/snowmiku.ply guitar/guitar.compressed.ply luma-seal/luma-seal.splat; do
    if [ -e "$scenes/$scene" ]; then
        check "render $scene: the same picture" equal "$(w render "$scenes/$scene" --hash)" \
            "$("$fixsplat" render "$scenes/$scene" --hash)"
    else
        skip "render $scene" "not here"
    fi
done

# ---- Files -----------------------------------------------------------------------------------------------------------

for ending in fxs compressed.ply ply spz rad glb sog splat csv; do
    "$fixsplat" convert knot.ply linux.$ending && w convert knot.ply windows.$ending
    check "convert .$ending: the same file" cmp windows.$ending linux.$ending
    [ $ending = csv ] || check "info .$ending" equal "$(w info linux.$ending --json)" \
        "$("$fixsplat" info linux.$ending --json)"
done
"$fixsplat" convert knot.ply linux.levels.fxs --levels && w convert knot.ply windows.levels.fxs --levels
check "convert --levels: the same file" cmp windows.levels.fxs linux.levels.fxs
check "render --budget: of a file that is read in part" equal \
    "$(w render windows.levels.fxs --budget 1000 --pool 256K --hash)" \
    "$("$fixsplat" render linux.levels.fxs --budget 1000 --pool 256K --hash)"
mkdir linux windows && "$fixsplat" convert knot.ply linux/lod-meta.json && w convert knot.ply windows/lod-meta.json
check "convert lod-meta.json: the same folder" diff -r windows linux

{
    echo '#include <windows.h>'
    (cd "$root/src/include" && find fixsplat -name '*.h') | sed 's|.*|#include <&>|'
    sed -n -e 's/^\(fxs_[a-z0-9_]*\) \([0-9]*\) bytes$/_Static_assert(sizeof(\1) == \2, "\1");/p' \
        -e 's/^\(fxs_[a-z0-9_]*\)\.\([a-zA-Z0-9_]*\) \([0-9]*\) .*/_Static_assert(offsetof(\1, \2) == \3, "\1.\2");/p' \
        "$root/tests/outside/layout-1.0"
} >layout.c
check "all structs are as on Linux" $compiler -std=c11 -Wall -Werror -I"$root/src/include" -c layout.c -o layout.o

sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '/^```/d' >program.c
mkdir dll && cp "$built"/libfixsplat-*.dll dll &&
    $compiler -std=c99 -I"$root/src/include" program.c -o dll/program.exe "$built/libfixsplat.dll.a" &&
    "$wine" dll/program.exe linux.fxs dll/windows.png
libraries=$(sed -n 's/^LIBS_[A-Z]* := //p' "${fixsplat%/*}/probe.mk" | tr '\n' ' ')
${CC:-cc} -std=c99 -I"$root/src/include" program.c -o program "${fixsplat%/*}/libfixsplat.a" $libraries -lm -lpthread &&
    ./program linux.fxs dll/linux.png
check "the .dll: the same picture" cmp dll/windows.png dll/linux.png

mkdir -p page/viewer && echo page >page/viewer/index.html && echo module >page/fixsplat.js
export FIXSPLAT_WEB=page
"$fixsplat" publish knot.ply site --size 64x36 && w publish knot.ply site-windows --size 64x36 >logs/out
check "publish: what shows it" grep -q ': py -m http.server -d site-windows$' logs/out
w publish knot.ply "it's a site" --size 64x36 >logs/out
check "publish: what shows it, quoted as cmd does" grep -Fq ": py -m http.server -d \"it's a site\"" logs/out
check "publish: the same folder" diff -r site-windows site
w publish knot.ply titled --size 64x36 --title 'a\b' >logs/out
check "publish --title: with its \\" grep -Fq '<title>a\b</title>' titled/index.html
head -c 200 knot.ply >short.ply
refused "publish: a damaged scene" 1 'short.ply: ' publish knot.ply short.ply half-made --size 64x36
check "publish: nothing is left of it" [ ! -e half-made ]
"$fixsplat" make-scene knot --count 30000 -o large.ply && "$fixsplat" convert large.ply large.fxs
env -u FIXSPLAT_QUIET "$wine" "$program" publish large.fxs again --size 64x36 --title 'a "b\' >logs/out 2>logs/err
check "publish: a command to go on with, whose words cmd reads as they were" \
    grep -Fq -- ' --title "a \"b\\" large.fxs again --profile small' logs/err

# ---- Fits ------------------------------------------------------------------------------------------------------------

. "$root/tests/scripts/lib/photos.sh"
make_photographs 12
"$fixsplat" fit set --steps 200 -o linux-fit.fxs >/dev/null && w fit set --steps 200 -o windows-fit.fxs >logs/out
check "fit: the same file" cmp windows-fit.fxs linux-fit.fxs
w fit set --steps 200 -o windows-c.fxs --cpu c --threads 3 >logs/out
check "fit --cpu c, 3 threads: the same file" cmp windows-c.fxs linux-fit.fxs
w fit set --steps 100 -o half.fit >logs/out && w fit set --steps 200 --resume half.fit -o half.fxs >logs/out
"$fixsplat" fit set --steps 100 -o linux.fit >logs/out &&
    "$fixsplat" fit set --steps 200 --resume linux.fit -o linux-half.fxs >logs/out
check "fit --resume: the same file" cmp half.fxs linux-half.fxs
for f in set/sparse/0/*.txt; do
    sed 's/$/\r/' $f >logs/crlf && cp logs/crlf $f
done
w fit set --steps 200 -o crlf.fxs >logs/out
check "fit: cameras whose lines end as in Windows" cmp crlf.fxs linux-fit.fxs
cp -r set/images plain
refused "fit of photographs without cameras" 1 'needs colmap, which is not installed' fit plain -o plain.fxs
check "they are there for COLMAP" diff -r plain plain.fxs.cameras/images
if have script; then
    {
        until [ "$(cat stop.log 2>/dev/null | wc -l)" -gt 1 ]; do sleep 0.2; done
        printf '\003'
        until [ -e stop.fxs.fit ]; do sleep 0.2; done
    } | timeout 300 script -qec "'$wine' '$program' fit set --steps 20000 --log stop.log -o stop.fxs" /dev/null \
        >logs/out 2>&1
    check "fit: Ctrl-C saves it" [ -e stop.fxs.fit ]
else
    skip "fit: Ctrl-C" "no script here"
fi

# ---- Double clicks ---------------------------------------------------------------------------------------------------

classes='HKCU\Software\Classes'
value() { "$wine" reg query "$classes\\$1" ${2-/ve} 2>/dev/null | tr -d '\r' | sed -n '/(value not set)/d; s/.*REG_SZ *//p'; }
refused "associate without the viewer" 1 'fixsplat-view.exe, which shows scenes, is missing' associate
cp "$built/fixsplat.exe" 'only this/fixsplat-view.exe'
"$wine" reg add "$classes\\.ply" /ve /d other.class /f >logs/out 2>&1
check "associate" w associate
check "associate: .fxs has a class of its own" equal "$(value .fxs)" fixsplat.scene
check "associate: .ply keeps its class, and is in the list of programs" equal \
    "$(value .ply) $("$wine" reg query "$classes\\.ply\\OpenWithProgids" 2>/dev/null | grep -c fixsplat.scene)" "other.class 1"
check "associate: the viewer opens the class" equal "$(value 'fixsplat.scene\shell\open\command')" \
    "\"Z:$(printf %s "${program%/*}/fixsplat-view.exe" | tr / '\\')\" \"%1\""
check "associate --remove" w associate --remove
check "associate --remove: nothing of it is left" equal "$(value .fxs) $(value .ply) $(value fixsplat.scene)" " other.class "
rm 'only this/fixsplat-view.exe'
if have script; then
    clicked() {
        { sleep "$1"; printf '\r'; } | timeout 100 script -qec "'$wine' '$program' $2; echo status \$?" /dev/null |
            tr -d '\r\033' | sed 's/\[?25[lh]//g; s/\[K//g; s/\[1C/ /g' >logs/out
    }
    clicked 3 ''
    check "a double click: says what to do, and waits" equal \
        "$(grep -c "drop its file onto fixsplat.exe" logs/out) $(grep -o 'status .*' logs/out)" "1 status 2"
    clicked 3 knot.ply
    check "a scene dropped on fixsplat.exe: viewed, and a failure waits" equal \
        "$(grep -c '^fixsplat: knot.ply: cannot be shown' logs/out) $(grep -c '^Press Enter' logs/out)" "1 1"
else
    skip "double clicks" "no script here"
fi

# ---- The server ------------------------------------------------------------------------------------------------------

mkdir -p 'ä ö/😀' && cp knot.ply 'ä ö/😀/k not.ply' || exit 1
server=
serves() {
    rm -f logs/served
    "$@" >logs/served 2>logs/errors &
    server=$!
    until [ -s logs/served ] || grep -q '^fixsplat: preview: ' logs/errors || ! kill -0 $server 2>/dev/null; do
        sleep 0.1
    done
    at=$(cat logs/served logs/errors | tr -d '\r' | sed -n 's|^\(fixsplat: preview: \)*\(http://[^/]*\)/$|\2|p' |
        head -n 1)
    [ "$at" ] || fail "serves" "$(cat logs/errors)"
}
stop() { kill $server; wait $server; } 2>/dev/null
get() { curl -s --path-as-is -m 20 "$@"; }
code() { get -o logs/body -w '%{http_code}' "$@"; }
. "$root/tests/scripts/lib/served.sh"
gone() {
    tries=0
    while get -o logs/body "$at/"; do [ $((tries += 1)) -lt 50 ] || return 1; sleep 0.1; done
}
answers() {
    while read -r path options; do
        get $options -D logs/head -o logs/body "$at$path"
        echo "$path $options"
        tr -d '\r' <logs/head | grep -Evi '^(Date|ETag):'
        case $options in
        -I) ;;
        *) { gzip -dc <logs/body 2>/dev/null || cat logs/body; } | cksum ;;
        esac
    done <requests
}

if [ ! -e "$built/fixsplat-web.exe" ]; then
    skip "the server" "built without libmicrohttpd (make setup windows)"
elif ! have curl; then
    skip "the server" "no curl here"
else
    cp "$built/fixsplat-web.exe" 'only this/'
    said=$("$wine" 'only this/fixsplat-web.exe' 2>&1)
    check "fixsplat-web without a scene: status 2, one line" equal "$? $(printf %s "$said" | tr -d '\r')" \
        "2 fixsplat: view --web takes a scene file, or several; see: fixsplat view --help"
    echo '<!doctype html>' >page/viewer/fit.html
    seq 2000 >page/long.js
    echo secret | tee beside.txt page/.x page/con.js page/viewer/aux >page/com1.txt
    cp linux.spz served.spz
    cat >requests <<-'END'
	/
	/1
	/4
	/5
	/list.html
	/viewer/
	/viewer/ -I
	/fixsplat.js
	/long.js -HAccept-Encoding:gzip
	/long.js -HAccept-Encoding:gzip -r 0-9
	/long.js -r 100-199
	/long.js -r 8000-
	/long.js -r -77
	/long.js -r 99999-
	/long.js -X POST -d 123
	/long.js -HHost:evil.example
	/long.js -HHost:localhost
	/none.js
	/viewer
	/scenes.json
	/scenes/0/knot.ply.fxs
	/scenes/0/knot.ply.fxs -I
	/scenes/0/next/knot.ply.fxs
	/scenes/0.jpg
	/scenes/1/served.spz
	/scenes/1/served.spz -r 1000-1999
	/scenes/2/linux.levels.fxs -r 0-4095
	/scenes/2/linux.levels.fxs -r 4096-100000
	/scenes/2/linux.levels.fxs -r -4096
	/scenes/2/linux.levels.fxs
	/scenes/3/k%20not.ply.fxs
	/scenes/3/k%20not.ply.fxs -r 5-5000
	/scenes/3/k%20not.ply
	END
    set -- view --web --port 0 knot.ply served.spz linux.levels.fxs 'ä ö/😀/k not.ply'
    serves "$fixsplat" "$@"
    for i in 0 1 2 3; do ready $i ready 1; done
    answers >linux.answers
    stop
    serves "$wine" "$program" "$@"
    for i in 0 1 2 3; do check "view --web: scene $i is there" ready $i ready 1; done
    answers >windows.answers
    check "view --web: the same answers to $(wc -l <requests) requests" diff linux.answers windows.answers
    tag=$(get -I "$at/long.js" | tr -d '\r' | sed -n 's/^ETag: //p')
    check "view --web: 304" equal "$(code -H "If-None-Match: $tag" "$at/long.js")" 304
    for path in /con.js /CON.js /con /viewer/aux /com1.txt /nul /lpt1.js '/long.js.' '/long.js%20' '/long.js::$DATA' \
        '/long.js:x' '/LONG~1.JS' /.x /../beside.txt '/..\beside.txt' '/..%5cbeside.txt' '/viewer\..\..\beside.txt' \
        '/viewer%5c..%5c..%5cbeside.txt' /%2e%2e/beside.txt '/%5c%5c.%5cnul' "/$work/beside.txt" "/Z:$work/beside.txt" \
        "/viewer/Z%3a$work/beside.txt" '/C:/windows/win.ini' '/C%3a%5cwindows%5cwin.ini'; do
        check "view --web: not $(printf %s "$path" | tr '\\' '|')" equal \
            "$(code "$at$path") $(grep -c secret logs/body)" "404 0"
    done
    check "view --web: beside 300 requests that never end" $helper hang "${at##*:}" 300 \
        sh -c 'sleep 2; exec curl -s -m 5 -o logs/body "$1"' - "$at/long.js"
    check "convert: a scene that is served" w convert knot.ply served.spz --spz-fine
    check "view --web: it is shown anew" ready 1 ready 2
    check "view --web: that one" equal "$(code "$at/scenes/1/next/served.spz") $(cksum <logs/body)" \
        "200 $(cksum <served.spz)"
    refused "view --web: a port in use" 1 "port ${at##*:}: Address already in use; port 0 is any" \
        view --web knot.ply --port "${at##*:}"
    refused "view --web: no TLS" 1 'this libmicrohttpd was built without TLS' \
        view --web knot.ply --cert knot.ply --key knot.ply
    kill -9 $server
    wait $server 2>/dev/null
    check "view --web: ended at once, it is no longer there" gone
    serves "$fixsplat" view --web --port 0 --bind 0.0.0.0 knot.ply
    addresses() { grep ^http logs/served | sed 's/:[0-9]*\/$//' | sort; }
    addresses >linux.addresses
    stop
    serves "$wine" "$program" view --web --port 0 --bind 0.0.0.0 knot.ply
    check "view --web --bind 0.0.0.0: the same addresses" equal "$(addresses)" "$(cat linux.addresses)"
    stop
    gone
    serves "$fixsplat" view --web --port 0 --qr knot.ply
    stop
    cp logs/served linux.code
    gone
    serves "$wine" "$program" view --web --port "${at##*:}" --qr knot.ply
    stop
    if [ "$(cat linux.code logs/served | wc -l)" -gt 30 ]; then
        check "view --web --qr: the same code" cmp linux.code logs/served
    else
        skip "view --web --qr" "built without libqrencode"
    fi
    gone

    serves env -u FIXSPLAT_QUIET "$wine" "$program" fit set --steps 200 --preview --port 0 -o preview.fxs
    get -o fit.json "$at/fit.json"
    check "fit --preview: answers while it fits" grep -q '"scene": "preview.fxs", "state": "' fit.json
    wait $server
    check "fit --preview: the same file" cmp preview.fxs linux-fit.fxs
    if have script; then
        at_console() {
            rm -f logs/status logs/printed
            mkfifo keys
            timeout 300 env -u FIXSPLAT_QUIET script -qec \
                "'$wine' '$program' $* >logs/printed 2>&1; echo \$? >logs/status" /dev/null <keys >logs/out 2>&1 &
            exec 3>keys
            rm keys
            until at=$(cat logs/printed 2>/dev/null | grep -o 'http://[0-9.]*:[0-9]*'); [ "$at" ]; do sleep 0.2; done
        }
        by_ctrl_c() {
            printf '\003' >&3
            tries=0
            until [ -s logs/status ] || [ $((tries += 1)) = 150 ]; do sleep 0.2; done
            exec 3>&-
        }
        at_console view --web --port 0 knot.ply
        ready 0 ready 1
        check "view --web at a console: a file for what was packed" [ "$(ls "$WINEPREFIX"/drive_c/users/*/Temp)" ]
        by_ctrl_c
        check "view --web: Ctrl-C: status 0" equal "$(cat logs/status)" 0
        check "view --web: Ctrl-C: nobody answers" gone
        check "view --web: Ctrl-C: no file stays" equal "$(ls "$WINEPREFIX"/drive_c/users/*/Temp)" ""
        at_console fit set --steps 1000000 --preview --port 0 -o long.fxs --log '"a log"'
        tries=0
        until get "$at/fit.json" | grep -q '"version": [2-9]' || [ $((tries += 1)) = 300 ]; do sleep 0.2; done
        get -o now.fxs "$at/scene.fxs"
        check "fit --preview: a scene" "$fixsplat" info now.fxs
        check "fit --preview: the page" equal "$(code -w '%{http_code} %{redirect_url}' "$at/")" \
            "302 $at/viewer/fit.html"
        by_ctrl_c
        check "fit --preview: Ctrl-C saves it" equal "$(ls long.fxs*; grep -c 'stopped after' logs/printed)" \
            "$(printf 'long.fxs.fit\n1')"
        check "fit --preview: what goes on" grep -q \
            '; to go on: fixsplat fit --steps 1000000 .* --log "a log" .*set --resume long.fxs.fit' logs/printed
        check "fit --preview: Ctrl-C: nobody answers" gone
        mkdir bin
        printf '#!/bin/sh\necho "$*" >"$OPENED"\n' >bin/xdg-open
        chmod +x bin/xdg-open
        env PATH="$work/bin:$PATH" OPENED="$work/opened" timeout 30 script -qec \
            "'$wine' '$program' view --web --port 0 knot.ply" /dev/null >logs/out 2>&1 </dev/null &
        tries=0
        until [ -s opened ] || [ $((tries += 1)) = 100 ]; do sleep 0.2; done
        check "view --web at a console: a browser is opened" equal \
            "$(code "$(cat opened)viewer/") $(cksum <logs/body)" "200 $(cksum <page/viewer/index.html)"
        kill $!
        wait $! 2>/dev/null
    else
        skip "the server: Ctrl-C" "no script here"
    fi
fi

# ---- File names ------------------------------------------------------------------------------------------------------

check "a name with spaces, umlauts and an emoji" equal "$(w render 'ä ö/😀/k not.ply' --hash)" "$wanted"
check "and with backslashes" equal "$(w render 'ä ö\😀\k not.ply' --hash)" "$wanted"
check "with a drive" equal "$(w render "Z:$(pwd | tr / '\\')\\knot.ply" --hash)" "$wanted"
w convert knot.ply 'ä ö\😀\ü.fxs'
check "written there" cmp 'ä ö/😀/ü.fxs' linux.fxs
ten=$(printf 'd%.0s' 1 2 3 4 5 6 7 8 9 0) long=
for i in 1 2 3; do long=$long$ten$ten$ten$ten$ten$ten$ten$ten$ten/; done
mkdir -p "$long"
w convert knot.ply "${long}x.fxs"
check "a path of more than 260 characters" cmp "${long}x.fxs" linux.fxs
check "read there" equal "$(w render "${long}x.fxs" --hash)" "$("$fixsplat" render linux.fxs --hash)"
refused "a device's name" 1 '^fixsplat: con.fxs: cannot be written: it is the name of a device in Windows$' \
    convert knot.ply con.fxs
refused "a device's name, in a folder" 1 'the name of a device' convert knot.ply 'linux\LPT1.fxs'
refused "a device's name, of a fit, at once" 1 \
    '^fixsplat: con.fxs: cannot be written: it is the name of a device in Windows$' fit set --steps 20000 -o con.fxs
refused "a device's name, read" 1 '^fixsplat: aux.ply: is the name of a device in Windows$' info aux.ply
refused "a folder that ends in a dot" 1 'x\./y.fxs: cannot be written: it ends in a dot or a space' \
    convert knot.ply 'x.\y.fxs'
refused "a colon" 1 'a colon' convert knot.ply 'linux/a:b.fxs'
refused "a quote" 1 'it has a quote, which is no part of names in Windows: leave out the \\ before a quote$' \
    convert knot.ply 'linux/a".fxs'
refused "a wildcard that no file matches" 1 '^fixsplat: \*.none: has one of ' info '*.none'
refused "a wildcard in an output" 1 'y\?b.fxs: cannot be written: it has one of ' convert knot.ply 'y?b.fxs'
check "none of them is there" equal "$(ls | grep -i -e con -e '^x')" ""

whole='\\?\Z:'$(pwd | tr / '\\')
check "a whole path with the prefix" equal "$(w render "$whole\\knot.ply" --hash)" "$wanted"
w convert knot.ply "$whole\\whole.fxs"
check "written there too" cmp whole.fxs linux.fxs

# ---- Command lines of cmd --------------------------------------------------------------------------------------------

$compiler -O1 -o line.exe "$root/tests/windows/line.c" && mkdir 'a folder' many || exit 1
for name in b.ply A.ply C.PLY 'x[1].ply'; do cp knot.ply "many/$name"; done
cp linux.fxs many/ && cp knot.ply 'a folder/'
mkdir -p plain-page/viewer && cp page/fixsplat.js plain-page && cp page/viewer/index.html plain-page/viewer
typed() {
    printf '"Z:%s" %s\n' "$(printf %s "$program" | tr / '\\')" "$1" >logs/line
    FIXSPLAT_WEB=plain-page "$wine" line.exe logs/line 2>logs/err
}
listed() { "$fixsplat" info "$@" --json; }
check "*: the files, sorted" equal "$(typed 'info many\*.ply --json')" \
    "$(listed many/A.ply many/b.ply many/C.PLY 'many/x[1].ply')"
check "?: one character" equal "$(typed 'info many\?.ply --json')" "$(listed many/A.ply many/b.ply many/C.PLY)"
check "[ and ] stand for themselves" equal "$(typed 'info many\x[1].ply --json')" "$(listed 'many/x[1].ply')"
check "* in a whole path with the prefix" equal "$(typed "info $whole\\many\\*.fxs --json")" "$(listed many/linux.fxs)"
cp knot.ply ./-dash.ply
check "a file's name that begins with - is no option" equal "$(typed 'info *dash.ply --json')" "$(listed ./-dash.ply)"
rm ./-dash.ply
typed 'info "many\*.ply"'
check "* in quotes is no wildcard" grep -q '^fixsplat: many/\*.ply: has one of ' logs/err
typed 'publish --title "what?" many\A.ply asked --size 64x36' >logs/out
check "? in the quotes of a text" grep -q '<title>what?</title>' asked/index.html
typed 'publish --size 64x36 --title "a \"b\"" knot.ply said' >logs/out
check "\\ before a quote: a part of a text" grep -q '<title>a &#34;b&#34;</title>' said/index.html
typed 'publish knot.ply "as cmd completes\" --size 64x36 --title "as cmd"' >logs/out
check "but where a quote is left open: the end of a folder's name" grep -q '<title>as cmd</title>' \
    'as cmd completes/index.html'
check "and behind that a name" equal "$(typed 'info "a folder\"knot.ply --json')" "$(listed 'a folder/knot.ply')"

# ---- The window ------------------------------------------------------------------------------------------------------

until_() {
    tries=300
    until "$@" >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep 0.1
    done
}
titled() { window=$(xdotool search --onlyvisible --name "$1") && [ "$window" ]; }
lines() { [ "$(wc -l <"$1")" -ge "$2" ]; }

open() {
    title=$1
    shift
    { w view "$@" >logs/out 2>logs/err; echo $? >logs/status; } &
    shots=0
    until_ titled "$title" || { fail "a window" "$(cat logs/err)"; return 1; }
    xdotool windowfocus --sync "$window"
}

shot() {
    shots=$((shots + 1))
    xdotool key p
    until_ lines logs/out $shots
    mv shot.png "$1.png"
    command=$(tail -n 1 logs/out)
    "$fixsplat" ${command#fixsplat }
    check "the window: $1" cmp "$1.png" shot.png
}

close() {
    rm -f logs/status
    xdotool key Escape
    until_ test -s logs/status || { fail "the window ends" ""; end_wine; }
    wait $!
    check "the window ends: status 0, and words on stderr" equal "$(cat logs/status) $(tr -d '\r' <logs/err)" "0 $1"
}

if [ ! -e "$built/fixsplat-view.exe" ]; then
    skip "the window" "this program was built without SDL2"
elif ! have Xvfb || ! have xdotool; then
    skip "the window" "no Xvfb and xdotool here"
else
    refused "view without its other program" 1 \
        '^fixsplat: knot.ply: cannot be shown: .*/only this/fixsplat-view.exe: No such file or directory$' view knot.ply
    cp "$built/fixsplat-view.exe" 'only this/'
    check "the window's program has an icon" sh -c '${2%gcc}objdump -h "$1" | grep -q .rsrc' - \
        "$built/fixsplat-view.exe" "${compiler##* }"
    Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp -noreset 3>logs/display 2>logs/server &
    server=$!
    trap 'end_wine; kill $server 2>/dev/null; rm -rf "$work"' EXIT
    until_ lines logs/display 1 || fail "virtual screen" "$(cat logs/server)"
    DISPLAY=:$(cat logs/display)
    export DISPLAY
    unset SDL_VIDEODRIVER
    end_wine
    fonts=$WINEPREFIX/drive_c/windows/Fonts
    rm -f "$fonts"/segoeui.ttf "$fonts"/tahoma.ttf "$fonts"/arial.ttf "$fonts"/verdana.ttf
    if open 'knot.ply - ' knot.ply --size 320x200 --screenshot shot.png; then
        shot whole
        xdotool key x 1
        shot square
        check "the keys show" sh -c '! cmp -s whole.png square.png'
        xdotool mousemove --window "$window" 100 90 mousedown 1 mousemove --window "$window" 130 110 mouseup 1
        shot turned
        xdotool click 4
        shot near
        check "the pointer shows" sh -c '! cmp -s square.png turned.png && ! cmp -s turned.png near.png'
        close "fixsplat: no words in the window: no font Segoe UI, Tahoma, Arial or Verdana in C:/windows/Fonts"
    fi
    font=/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
    [ ! -e $font ] || cp $font "$fonts/arial.ttf"
    words=$([ -e $font ] || cat logs/err)
    if open 'k not.ply - ' 'ä ö\😀\k not.ply' --size 320x200 --screenshot 'ä ö\shot.png'; then
        xdotool key p
        check "the window: names with umlauts" until_ lines logs/out 1
        "$fixsplat" render 'ä ö/😀/k not.ply' --size 320x200 -o logs/linux.png
        check "the same picture" cmp 'ä ö/shot.png' logs/linux.png
        close "$words"
    fi
    check "recent scenes are in %APPDATA%" equal \
        "$(cat "$WINEPREFIX"/drive_c/users/*/AppData/Roaming/fixsplat/recent | sed "s|Z:$(pwd -P)/||")" \
        "ä ö/😀/k not.ply
knot.ply"
    if open '^fixsplat$'; then
        xdotool key 2
        check "a recent scene" until_ titled '^knot.ply - '
        close "$words"
    fi
    if have script; then
        {
            until_ titled '^knot.ply - '
            printf '\003'
            sleep 5
        } | timeout 60 script -qec "'$wine' '$program' view knot.ply" /dev/null >logs/out 2>&1
        check "the window: Ctrl-C at the console ends it, status 0" equal $? 0
    else
        skip "the window: Ctrl-C" "no script here"
    fi
    # A scene file dropped on the program starts it with a console that closes at once. So the window must show the
    # error.
    (cd 'only this' && exec "$wine" start /wait fixsplat-view.exe "$whole\\short.ply") >logs/out 2>&1 &
    says_why() { titled '^fixsplat - short.ply: '; }
    check "a damaged scene that is dropped on the program: the window says why" until_ says_why
    ends() { ! says_why || { timeout 5 xdotool windowfocus --sync "$window" key Escape; false; }; }
    check "and Escape closes it" until_ ends
    end_wine
    wait $!
    unset DISPLAY
    end_wine
    kill $server
    wait $server
fi

# ---- Errors ----------------------------------------------------------------------------------------------------------

refused "no such file" 1 '^fixsplat: nothing.ply: No such file or directory$' render nothing.ply --hash
refused "a folder" 1 'not-there/x.fxs: cannot be written: No such file' convert knot.ply not-there/x.fxs
refused "the input" 2 'is read and cannot be written too' convert knot.ply KNOT.ply
mkdir taken.fxs
refused "a folder in its place" 1 'taken.fxs: cannot be written: Is a directory' convert knot.ply taken.fxs
head -c 100000 linux.fxs >cut.fxs
refused "a file that is cut short" 1 'cut.fxs: ' render cut.fxs --hash
$compiler -O1 -o hold.exe "$root/tests/windows/hold.c" && mkfifo ends || exit 1
cp linux.spz held.fxs
"$wine" hold.exe held.fxs <ends >logs/held &
exec 3>ends
until grep -q held logs/held; do sleep 0.1; done
refused "a file that another program has open" 1 'held.fxs: cannot be written: another program has it open' \
    convert knot.ply held.fxs
check "it is as it was" cmp held.fxs linux.spz
{ exec 3>&-; w convert knot.ply held.fxs; } &
until ls -A | grep -q 'fixsplat-.*tmp' || ! kill -0 $!; do sleep 0.1; done
sleep 0.3
exec 3>&-
wait $!
check "it is replaced when the other program closes it" equal $? 0
wait
check "replaced" cmp held.fxs linux.fxs
w make-scene knot --count 30000 -o both.ply &
w make-scene knot --count 30000 -o both.ply
wait $!
check "two writers of one file: both end well" equal $? 0
"$fixsplat" make-scene knot --count 30000 -o one.ply
check "two writers of one file: it is whole" cmp both.ply one.ply
mkdir full
if mount -t tmpfs -o size=200k none full 2>/dev/null; then
    refused "a full disk" 1 'full/x.ply: cannot be written: No space left on device' \
        make-scene knot --count 30000 -o full/x.ply
    refused "a full disk, once more" 1 'full/x.ppm: cannot be written: No space left on device' \
        render knot.ply -o full/x.ppm
    check "nothing is left of them" equal "$(ls -A full)" ""
    umount full
else
    skip "a full disk" "no file system can be mounted here"
fi
mkdir closed && chmod a-w closed
if [ "$(id -u)" = 0 ]; then
    skip "a folder that is read-only" "root may write there"
else
    refused "a folder that is read-only" 1 'closed/x.fxs: cannot be written: ' convert knot.ply closed/x.fxs
fi
"$wine" "$program" make-scene knot --count 3000000 -o killed.ply &
until ls -A | grep -q 'fixsplat-.*tmp'; do sleep 0.1; done
kill -9 $!
wait $! 2>/dev/null
sleep 1
check "ended at once: nothing is left" equal "$(ls -A | grep -e killed -e 'fixsplat-.*tmp')" ""

# ---- The test programs -----------------------------------------------------------------------------------------------

cd "$root" || exit 1
count=0
for test in "$built"/tests/test_*.exe; do
    name=$(basename "$test" .exe)
    said=$(FXS_SCENES=${scenes:-none} timeout 1200 "$wine" "$test" 2>&1)
    status=$? last=$(printf '%s\n' "$said" | tail -n 1)
    case $last in
    *' passed, 0 failed, '*) count=$((count + ${last%% *})) ;;
    *) status=1 ;;
    esac
    if [ $status = 0 ]; then
        ok "$name: $last"
    else
        fail "$name" "$(printf '%s\n' "$said" | grep -v '^ok' | head -n 5)"
    fi
done
echo "   $count tests of the test programs passed under wine"
finish
