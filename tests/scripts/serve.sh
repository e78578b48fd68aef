#!/bin/sh
# Tests the web server of `fixsplat view --web`: served and refused files, byte ranges, TLS, errors and shutdown.
. tests/scripts/lib/check.sh
. tests/scripts/lib/served.sh
. tests/scripts/lib/command.sh
server=
trap 'kill $server 2>/dev/null; rm -rf "$work"' EXIT

"$fixsplat" make-scene knot --count 2000 -o 'a knot+50%.ply' || exit 1
cp 'a knot+50%.ply' knot.ply
"$fixsplat" convert knot.ply knot.fxs --quiet && "$fixsplat" convert knot.ply knot.spz --quiet || exit 1
run view --web none.ply
case $(cat logs/err) in
*'built without'*) skip serve "$(cat logs/err)"; finish; exit ;;
esac
have curl || { skip serve "no curl here"; finish; exit; }

mkdir -p page/viewer page/.hidden
echo '<!doctype html>' >page/viewer/index.html
echo secret | tee page/.hidden/x page/.x beside.txt >page/viewer/.x
for file in a.js a.wasm a.css a.json; do echo "$file" >page/$file; done
seq 2000 >page/long.js
ln -s ../beside.txt page/out.txt
FIXSPLAT_WEB=$work/page
export FIXSPLAT_WEB

through=
serve() {
    rm -f logs/served
    $through "$fixsplat" view --web --port 0 "$@" >logs/served 2>logs/errors &
    server=$!
    until [ -s logs/served ] || ! kill -0 $server 2>/dev/null; do sleep 0.1; done
    at=$(sed -n 's|^\(https*://[^/]*\)/.*|\1|p;q' logs/served)
    [ "$at" ] || { fail "serves $*" "$(cat logs/errors)"; finish; exit 1; }
}

ends() {
    kill -"$1" $server
    wait $server
    status=$?
    server=
}

get() { curl -sk --path-as-is "$@"; }
code() { get -o logs/body -w '%{http_code}' "$@"; }
header() {
    name=$1
    shift
    get -o logs/body -D - "$@" | tr -d '\r' | sed -n "s/^$name: //Ip"
}
gets() { get -o logs/body "$1" && cmp logs/body "$2"; }

said=$("$fixsplat-web" 2>&1)
check "fixsplat-web without a scene: status 2, one line" equal "$? $said" \
    "2 fixsplat: view --web takes a scene file, or several; see: fixsplat view --help"
serve 'a knot+50%.ply' knot.ply knot.spz --bg 102030
for i in 0 1 2; do check "scene $i is there" ready $i; done

# ---- Files -----------------------------------------------------------------------------------------------------------

check "the address" equal "$(cat logs/served)" "$at/"
check "/ leads to the list" equal "$(header Location "$at/")" /list.html
check "/1 to the first" equal "$(header Location "$at/1")" \
    "/viewer/served.html?scene=/scenes/0/a%20knot%2B50%25.ply.fxs&background=%23102030"
check "/2 to the second" equal "$(header Location "$at/2")" "/viewer/served.html?scene=/scenes/1/knot.ply.fxs&background=%23102030"
get -o list.html "$at/list.html"
check "the list" equal "$(sed -n 's/^<a href="\([^"]*\)".*>\(.*\)<\/a>$/\1 \2/p' list.html | tr '\n' ,)" \
    "/1 a knot+50%.ply,/2 knot.ply,/3 knot.spz,"
check "the page" gets "$at/viewer/?scene=x" page/viewer/index.html
check "a scene of floats: packed, its name escaped" gets "$at/scenes/0/a%20knot%2B50%25.ply.fxs" knot.fxs
check "the other scene" gets "$at/scenes/1/knot.ply.fxs" knot.fxs
check "a scene that is small: as it lies" gets "$at/scenes/2/knot.spz" knot.spz
get -o picture.jpg "$at/scenes/1.jpg"
"$fixsplat" render knot.fxs --size 640x360 --bg 102030 --quality 85 -o wanted.jpg --quiet
check "its picture" cmp picture.jpg wanted.jpg
check "all of them" equal "$(get "$at/scenes.json" | grep -c '"state": "ready", "version": 1, "done": 0.000, "picture": true')" 3
for type in /viewer/:text/html /a.js:text/javascript /a.wasm:application/wasm /a.css:text/css /a.json:application/json \
    /scenes/1/knot.ply.fxs:application/octet-stream; do
    check "type of ${type%%:*}" equal "$(header Content-Type "$at${type%%:*}" | sed 's/;.*//')" "${type#*:}"
done
for path in /a.js /scenes/1/knot.ply.fxs /none; do
    for pair in Opener-Policy:same-origin Embedder-Policy:require-corp Resource-Policy:same-origin; do
        check "$path: Cross-Origin-$pair" equal "$(header "Cross-Origin-${pair%:*}" "$at$path")" "${pair#*:}"
    done
done
check "no-cache" equal "$(header Cache-Control "$at/scenes/1/knot.ply.fxs")" no-cache

# ---- Refused paths ---------------------------------------------------------------------------------------------------

for path in /none /viewer /scenes/ /scenes/2/knot.ply /scenes/0/knot.ply.fxs /scenes/1/knot.ply /scenes/1/knot.ply.fxs/ /scenes/3.json /4 /.x /viewer/.x \
    /.hidden/x /../beside.txt /viewer/../../beside.txt /%2e%2e/beside.txt /viewer/%2e%2e/%2e%2e/beside.txt '/..%2fbeside.txt' \
    /out.txt /viewer/..%00/x /a.js%00 /a.js%00.png //beside.txt "/$work/beside.txt" '/..\beside.txt' /scenes/1/../1/knot.ply \
    "/$(head -c 5000 /dev/zero | tr '\0' a)"; do
    check "404: $(echo "$path" | cut -c 1-40)" equal "$(code "$at$path")" 404
    check "no secret there" sh -c '! grep -q secret logs/body'
done
for method in POST PUT DELETE OPTIONS; do
    check "$method: 405" equal "$(code -X $method -d 123 "$at/a.js")" 405
done
for host in evil.example evil.example:80 localhost.evil.example 1.2.evil localhostx; do
    check "not as $host" equal "$(code -H "Host: $host" "$at/a.js")" 421
done
for host in localhost LOCALHOST:80 127.0.0.1 '[::1]:80'; do
    check "as $host" equal "$(code -H "Host: $host" "$at/a.js")" 200
done
check "405: what is allowed" equal "$(header Allow -X POST -d 123 "$at/")" 'GET, HEAD'

# ---- Changing files --------------------------------------------------------------------------------------------------

check "the address of the next: the same, until there is one" gets "$at/scenes/1/next/knot.ply.fxs" knot.fxs
still() { gets "$at/scenes/1/knot.ply.fxs" knot.fxs; }
facts() { get "$at/scenes/1.json" | sed -n 's/.*"version": \([0-9]*\), .*"address": "\([^"]*\)", "words": "\(.*\)"}/\1 \2 \3/p'; }
mv knot.ply away.ply
check "a scene that went away: said" ready 1 gone
check "and what was there is sent" still
mkfifo knot.ply
sleep 0.4
check "a FIFO in its place: the same" equal "$(code -m 5 "$at/scenes/1/knot.ply.fxs") $(cksum <logs/body) $(facts)" \
    "200 $(cksum <knot.fxs) 1 /scenes/1/knot.ply.fxs the file is not there any more"
rm knot.ply
ln -s beside.txt knot.ply
sleep 1.3
check "a link in its place: the same" equal "$(code "$at/scenes/1/knot.ply.fxs") $(cksum <logs/body) $(facts)" \
    "200 $(cksum <knot.fxs) 1 /scenes/1/knot.ply.fxs the file is not there any more"
rm knot.ply
head -c 3000 away.ply >knot.ply
check "half of it: not shown" ready 1 failed 1
check "why, without its folder" equal "$(facts | cut -d ' ' -f 1-5)" "1 /scenes/1/knot.ply.fxs the header asks"
check "and what was there is sent" still
mv away.ply knot.ply
check "the same again" ready 1 ready 2
check "at an address of its own" gets "$at$(facts | cut -d ' ' -f 2)" knot.fxs
"$fixsplat" make-scene cubes --count 1000 -o cubes.ply && "$fixsplat" convert cubes.ply cubes.fxs --quiet
{ head -c 20000 cubes.ply && sleep 0.3 && tail -c +20001 cubes.ply; } >knot.ply
check "another, in the same file, when all of it is there" ready 1 ready 3
check "that one" gets "$at$(facts | cut -d ' ' -f 2)" cubes.fxs
check "a page of the last one reads on" gets "$at/scenes/1/next/knot.ply.fxs" knot.fxs
cp 'a knot+50%.ply' knot.ply
check "the first one" ready 1 ready 4
check "said, to the one who started it" equal "$(sed 's|/[^ ]*/|/|' logs/errors)" \
    "fixsplat: /knot.ply: the header asks for at least 497529 bytes, the file has 3000"
: >logs/errors

# ---- Compression -----------------------------------------------------------------------------------------------------

gzipped() { code -H 'Accept-Encoding: br, gzip' "$@"; }
if ldd "$fixsplat-web" 2>/dev/null | grep -q libz; then
    for time in first second; do
        check "gzip, the $time time: smaller" equal "$(gzipped -w ' %{http_code} %{size_download}' "$at/long.js" |
            awk '{ print $1, $2 < 6000 }')" "200 1"
        check "gzip, the $time time: the same file" sh -c 'gzip -d <logs/body | cmp - page/long.js'
    done
    check "gzip: said" equal "$(header Content-Encoding -H 'Accept-Encoding: gzip' "$at/long.js")" gzip
    check "gzip: the type" equal "$(header Content-Type -H 'Accept-Encoding: gzip' "$at/long.js")" \
        "text/javascript; charset=utf-8"
    packed_tag=$(header ETag -H 'Accept-Encoding: gzip' "$at/long.js")
    check "gzip: an ETag of its own" [ "$packed_tag" != "$(header ETag "$at/long.js")" ]
    check "gzip: 304" equal "$(gzipped -H "If-None-Match: $packed_tag" "$at/long.js")" 304
    check "gzip: once for all HTTP caches" equal "$(header Vary "$at/long.js")" Accept-Encoding
    seq 3000 >page/long.js
    check "gzip: a file that changed" sh -c '[ "$1" = 200 ] && gzip -d <logs/body | cmp - page/long.js' - \
        "$(gzipped "$at/long.js")"
    for not in 'gzip;q=0' identity; do
        check "not gzip: $not" equal "$(code -H "Accept-Encoding: $not" "$at/long.js") $(cksum <logs/body)" \
            "200 $(cksum <page/long.js)"
    done
    check "a range: not of gzip" equal "$(gzipped -r 0-9 "$at/long.js") $(wc -c <logs/body)" "206 10"
    check "a scene: not by gzip" equal "$(gzipped "$at/scenes/0/a%20knot%2B50%25.ply.fxs") $(cksum <logs/body)" "200 $(cksum <knot.fxs)"
else
    skip gzip "no zlib here"
fi

# ---- Many waiting clients --------------------------------------------------------------------------------------------

check "beside 1100 requests that never end" $helper hang "${at##*:}" 1100 \
    curl -s -m 5 -o logs/body "$at/a.js" "$at/scenes/0/a%20knot%2B50%25.ply.fxs"

# ---- HEAD, ranges, ETag ----------------------------------------------------------------------------------------------

size=$(wc -c <knot.fxs)
scene=$at/scenes/0/a%20knot%2B50%25.ply.fxs
check "HEAD: the length" equal "$(get -I "$scene" | tr -d '\r' | sed -n 's/^Content-Length: //p')" "$size"
check "HEAD: no body" equal "$(get --head -m 5 -o logs/body -w '%{size_download}' "$scene")" 0
part() { check "range $1" equal "$(code -r "$1" "$scene") $(cksum <logs/body)" "206 $(eval "$2" | cksum)"; }
part 0-99 'head -c 100 knot.fxs'
part 100-299 'head -c 300 knot.fxs | tail -c 200'
part 1000- 'tail -c +1001 knot.fxs'
part -77 'tail -c 77 knot.fxs'
part "5-$((size * 2))" 'tail -c +6 knot.fxs'
part "-$((size * 2))" 'cat knot.fxs'
check "Content-Range" equal "$(header Content-Range -r 0-99 "$scene")" "bytes 0-99/$size"
for range in "$size-" 99999999999999- -0; do
    check "range $range: 416" equal "$(code -r "$range" "$scene")" 416
done
check "416 says how long it is" equal "$(header Content-Range -r "$size-" "$scene")" "bytes */$size"
for range in 9-3 0-1,5-6 x 99999999999999999999999-; do
    check "range $range: all of it" equal "$(code -H "Range: bytes=$range" "$scene")" 200
done
tag=$(header ETag "$scene")
check "ETag: not sent again" equal "$(code -H "If-None-Match: $tag" -w ' %{size_download}' "$scene")" " 0"
check "ETag: 304" equal "$(code -H "If-None-Match: $tag" "$scene")" 304
check "another ETag: sent" equal "$(code -H 'If-None-Match: "x"' "$scene")" 200
check "If-Range: a part of the same" equal "$(code -r 0-9 -H "If-Range: $tag" "$scene")" 206
check "If-Range: all of another" equal "$(code -r 0-9 -H 'If-Range: "x"' "$scene")" 200
check "one connection for several" equal "$(get -v "$at/a.js" "$at/a.css" 2>&1 | grep -c 'Re-using')" 1

# ---- Shutdown --------------------------------------------------------------------------------------------------------

fails "a port in use" 1 "port ${at##*:}: Address already in use" view --web knot.ply --port "${at##*:}"
ends TERM
check "a signal ends it: status 0" equal $status 0
check "not a word on stderr" equal "$(cat logs/errors)" ""
env --default-signal=INT timeout --preserve-status -s INT 1 \
    "$fixsplat" view --web --port 0 knot.ply >logs/out 2>logs/err
check "Ctrl-C: status 0" equal "$? $(wc -l <logs/out) $(wc -c <logs/err)" "0 1 0"

# ---- Scenes and views ------------------------------------------------------------------------------------------------

{
    printf '['
    for x in 0 1 2; do
        [ $x = 0 ] || printf ','
        [ $x = 2 ] && parallel=true || parallel=false
        printf '{"img_name": "at \\"%s\\"", "width": 640, "height": 360, "position": [%s, 0.1, -9], "fx": 50, "fy": 51,
            "cx": 300, "orthographic": %s, "rotation": [[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]]}' $x $x $parallel
    done
    printf ']'
} >three.json
serve knot.ply --cameras three.json --view 1 --profile compact
check "views in the address" equal "$(header Location "$at/")" \
    "/viewer/served.html?scene=/scenes/0/knot.ply.fxs&cameras=/cameras.json"
ready 0
gets_packed() {
    "$fixsplat" convert knot.ply compact.fxs --profile compact >/dev/null 2>&1 &&
        gets "$at/scenes/0/knot.ply.fxs" compact.fxs
}
check "packed, as convert does" gets_packed
get -o views.json "$at/cameras.json"
for pair in 0:1 1:2 2:0; do
    check "view ${pair%:*} is the file's ${pair#*:}" equal \
        "$("$fixsplat" render knot.ply --cameras views.json --view ${pair%:*} --hash)" \
        "$("$fixsplat" render knot.ply --cameras three.json --view ${pair#*:} --hash)"
done
check "their names" equal "$(grep -o 'at ..[0-9]' views.json | tr '\n' ' ')" 'at \"1 at \"2 at \"0 '
ends TERM

tile=$scenes/boatyard-tile3/boatyard-tile3.glb
if [ -e "$tile" ]; then
    cp "$tile" tile.glb
    cat >tileset.json <<-'END'
	{"asset": {"version": "1.1"}, "geometricError": 1, "root": {"boundingVolume": {"sphere": [0, 0, 0, 1000]},
	 "geometricError": 0, "refine": "ADD", "content": {"uri": "tile.glb"}}}
	END
    "$fixsplat" convert tileset.json tileset.fxs >/dev/null
    serve tileset.json
    ready 0
    check "several files: packed" gets "$at/scenes/0/tileset.json.fxs" tileset.fxs
    check "and not those" equal "$(code "$at/scenes/0/tile.glb")" 404
    ends TERM
    mkdir folder
    mv tile.glb folder
    mv tileset.json folder/INDEX
    serve folder/INDEX
    ready 0
    check "several files, whatever their index is called" gets "$at/scenes/0/INDEX.fxs" tileset.fxs
    ends TERM
    mv folder/INDEX folder/tileset.json
    serve folder/
    ready 0
    check "a folder that is a scene" gets "$at/scenes/0/folder.fxs" tileset.fxs
    ends TERM
else
    skip "several files" "no $tile"
fi

large=5000000000
if truncate -s $((large - 4)) page/large.bin 2>/dev/null && printf last >>page/large.bin; then
    serve knot.ply
    scene=$at/large.bin
    check "5 GB: the length" equal "$(get -I "$scene" | tr -d '\r' | sed -n 's/^Content-Length: //p')" $large
    check "5 GB: its last bytes" equal "$(code -r -4 "$scene") $(cat logs/body)" "206 last"
    check "5 GB: past 4 GB" equal "$(code -r "$((large - 8))-" "$scene") $(tr '\0' . <logs/body)" "206 ....last"
    get "$scene" 2>logs/slow | sleep 4 &
    get -o /dev/null "$scene" &
    slow=$!
    sleep 1
    check "5 GB: another file beside two downloads" equal "$(code -m 5 "$at/a.js")" 200
    check "5 GB: not in memory" [ "$(sed -n 's/^VmHWM:[ \t]*\([0-9]*\) kB/\1/p' /proc/$server/status)" -lt 50000 ]
    begun=$(date +%s)
    ends TERM
    check "ends at once beside a download that waits" equal "$status $(($(date +%s) - begun < 3))" "0 1"
    kill $slow 2>/dev/null
    wait
    rm page/large.bin
else
    skip "5 GB" "no such files here"
fi

# ---- Other machines, TLS ---------------------------------------------------------------------------------------------

serve knot.ply --bind 0.0.0.0
check "all addresses: this machine's own" grep -q '^http://127\.0\.0\.1:[0-9]*/$' logs/served
if [ "$(wc -l <logs/served)" -gt 1 ]; then
    far=$(sed -n 2p logs/served)
    check "all addresses: a short one, which leads there" equal "$(header Location "$far")" \
        "/viewer/served.html?scene=/scenes/0/knot.ply.fxs"
    check "all addresses: what http lacks" grep -q 'http: --cert and --key' logs/served
else
    skip "all addresses" "no network here"
fi
for host in evil.example 1.2.evil localhost.evil.example "$(uname -n).evil.example"; do
    check "all addresses: not as $host" equal "$(code -H "Host: $host" "$at/a.js")" 421
done
for host in localhost 192.0.2.7:8080 "$(uname -n)" "$(uname -n).LOCAL:80"; do
    check "all addresses: as $host" equal "$(code -H "Host: $host" "$at/a.js")" 200
done
ends TERM
serve knot.ply --bind 0.0.0.0 --host scenes.example
check "--host: by that name" equal "$(code -H "Host: Scenes.example:80" "$at/a.js")" 200
check "--host: not by another" equal "$(code -H "Host: evil.example" "$at/a.js")" 421
ends TERM
ln -s knot.ply link.ply
serve link.ply
ready 0
check "a link that is given: its file" gets "$at/scenes/0/link.ply.fxs" knot.fxs
ends TERM
if [ -e /proc/net/if_inet6 ] && grep -q ' lo$' /proc/net/if_inet6; then
    serve knot.ply --bind ::1
    check "IPv6" equal "${at%:*} $(code "$at/a.js")" 'http://[::1] 200'
    ends TERM
else
    skip "IPv6" "not here"
fi
if have openssl; then
    openssl req -x509 -newkey rsa:2048 -nodes -days 365 -subj /CN=fixsplat -keyout key.pem -out cert.pem 2>logs/openssl
    openssl genrsa -out other.pem 2048 2>>logs/openssl
    serve knot.ply --cert cert.pem --key key.pem
    check "TLS: the address" equal "${at%%:*}" https
    ready 0
    check "TLS: a scene" gets "$at/scenes/0/knot.ply.fxs" knot.fxs
    check "TLS: a range" equal "$(code -r 0-9 "$at/scenes/0/knot.ply.fxs") $(wc -c <logs/body)" "206 10"
    check "TLS: not without" equal "$(code -m 5 "http${at#https}/a.js")" 000
    ends TERM
    check "TLS: status 0" equal "$status $(cat logs/errors)" "0 "
    fails "a key of another certificate" 1 "not a certificate and its key" view --web knot.ply --cert cert.pem \
        --key other.pem
    fails "no certificate" 1 "not a certificate and its key" view --web knot.ply --cert knot.ply --key key.pem
    fails "no key" 1 "none.pem: No such file" view --web knot.ply --cert cert.pem --key none.pem
else
    skip TLS "no openssl here"
fi

# ---- Folders ---------------------------------------------------------------------------------------------------------

mkdir many more nothing
cp knot.ply knot.fxs many
cp knot.ply more
echo >many/text.txt
head -c 3000 knot.ply >many/bad.ply
serve many more
check "a folder: its list" equal "$(get "$at/list.html" | sed -n 's/^<a href="\([^"]*\)".*>\(.*\)<\/a>$/\1 \2/p' | tr '\n' ,)" \
    "/1 bad.ply,/2 knot.fxs,/3 many/knot.ply,/4 more/knot.ply,"
check "nothing is done before somebody looks" equal "$(sleep 0.5; cat logs/errors)" ""
get "$at/scenes.json" >logs/body
check "a damaged one: the others are there" ready 3
check "a damaged one: says so" ready 0 failed 0
check "a scene of two folders" gets "$at/scenes/3/knot.ply.fxs" knot.fxs
check "an .fxs as it lies" sh -c 'curl -s "$1/scenes/1/knot.fxs" | cmp - knot.fxs' - "$at"
check "not another file" equal "$(code "$at/scenes/1/text.txt")" 404
ends TERM
serve many/knot.ply --levels
ready 0
"$fixsplat" convert knot.ply levels.fxs --levels --quiet
check "--levels" gets "$at/scenes/0/knot.ply.fxs" levels.fxs
ends TERM

# ---- Terminals and QR codes ------------------------------------------------------------------------------------------

if ldd "$fixsplat-web" | grep -q qrencode && have zbarimg; then
    serve knot.ply --qr
    sleep 0.2
    # The QR code is printed in half-block characters on black, so its light modules are white.
    sed -n 's/^.\[40;97m\(.*\).\[0m$/\1/p' logs/served | sed 's/\xe2\x96\x88/a/g; s/\xe2\x96\x80/b/g; s/\xe2\x96\x84/c/g' | awk '
        { up = down = ""
          for (i = 1; i <= length($0); i++) {
              c = substr($0, i, 1)
              for (k = 0; k < 4; k++) { up = up (c ~ /[ab]/ ? " 0" : " 1"); down = down (c ~ /[ac]/ ? " 0" : " 1") }
          }
          rows[2 * NR - 1] = up; rows[2 * NR] = down; wide = 4 * length($0) }
        END { print "P1"; print wide, 8 * NR; for (r = 1; r <= 2 * NR; r++) for (k = 0; k < 4; k++) print rows[r] }' >code.pbm
    check "--qr: the address" equal "$(zbarimg -q --raw code.pbm 2>logs/zbar)" "$at/"
    ends TERM
else
    skip "--qr" "no libqrencode, or no zbarimg here"
fi
if have script; then
    mkdir bin
    printf '#!/bin/sh\necho "$*" >"$OPENED"\n' >bin/xdg-open
    chmod +x bin/xdg-open
    opened() {
        name=$1
        shift
        env PATH="$work/bin:$PATH" OPENED="$work/opened.$name" DISPLAY="${display-:99}" WAYLAND_DISPLAY= timeout -s INT 3 script -qec \
            "'$fixsplat' view --web --port 0 knot.ply $*" /dev/null >"terminal.$name" 2>&1 </dev/null &
    }
    opened plain
    opened not --no-open
    FIXSPLAT_NO_OPEN=1 opened variable
    opened code --bind 0.0.0.0
    wait
    check "a browser is opened" equal "$(cat opened.plain)" "$(tr -d '\r' <terminal.plain | grep -o '^http://127[^ ]*/$')"
    check "not by --no-open, or FIXSPLAT_NO_OPEN" [ ! -e opened.not -a ! -e opened.variable ]
    check "no code for this machine alone" equal "$(grep -c '40;97m' terminal.plain)" 0
    if ldd "$fixsplat-web" | grep -q qrencode && [ "$(grep -c ^http terminal.code)" -gt 1 ]; then
        check "a code for others" grep -q '40;97m' terminal.code
    fi
else
    skip "a browser is opened" "no script here"
fi

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "no scene file" 1 "none.ply: No such file" view --web none.ply
fails "no scene" 1 "beside.txt: not a scene file" view --web beside.txt
fails "one of two" 1 "none.ply: No such file" view --web knot.ply none.ply
fails "a folder without scenes" 1 "nothing: no scene in this folder" view --web nothing
head -c 1600 knot.ply >zeros.ply
truncate -s "$(wc -c <knot.ply)" zeros.ply
run view --web --port 0 zeros.ply
check "nothing to draw: seen when it is packed" equal "$status $(wc -l <logs/err) $(grep -c 'zeros.ply: ' logs/err)" "1 1 1"
fails "no cameras" 1 "none.json" view --web knot.ply --cameras none.json
fails "no view of that name" 1 "no view 'x'" view --web knot.ply --cameras three.json --view x
fails "an address in words" 1 "expected an address in digits" view --web knot.ply --bind somewhere
fails "an address of another machine" 1 "192.0.2.99, port 8080: Cannot assign" view --web knot.ply --bind 192.0.2.99
for bad in 'eye 1,2,3' 'place 0:1,2,3' 'scene x.json' 'screenshot x.png' 'size 10x10'; do
    fails "--web --${bad%% *}" 2 "--${bad%% *} is for the window" view --web knot.ply --$bad
done
for bad in 'port 80' 'bind 0.0.0.0' 'host x' 'cert x' 'key x' no-open qr levels; do
    fails "--${bad%% *} without --web" 2 "--${bad%% *} needs --web" view knot.ply --$bad
done
for bad in 'port 65536' 'port -1' 'port x'; do fails "--$bad" 2 "--$bad: expected" view --web knot.ply --$bad; done
fails "--cert without --key" 2 "give both" view --web knot.ply --cert x
FIXSPLAT_WEB=$work/none
fails "no page" 1 "FIXSPLAT_WEB=$work/none: the page is not there" view --web knot.ply
FIXSPLAT_WEB=$work/page

if ! have valgrind || [ "$FXS_EMULATED" ]; then
    skip Valgrind "not here, or not of an emulator"
else
    through='valgrind -q --trace-children=yes --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite'
    serve knot.ply compact.fxs --cameras three.json --profile small
    ready 0
    ready 1
    for path in / /a.js /none /cameras.json /scenes.json /scenes/0.jpg /scenes/0/knot.ply.fxs /viewer/../../beside.txt; do
        get "$at$path"
    done >logs/body
    get -r 5-10 "$at/a.js" >logs/body
    gzipped "$at/long.js" >logs/code
    seq 2000 >page/long.js
    gzipped "$at/long.js" >logs/code
    $helper hang "${at##*:}" 100 true
    get -X POST -d 123 "$at/a.js" >logs/body
    ends TERM
    check Valgrind equal "$status $(cat logs/errors)" "0 "
fi
finish
