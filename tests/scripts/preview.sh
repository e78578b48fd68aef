#!/bin/sh
# Tests `fixsplat fit --preview`: served files, shutdown, errors, and the page in Chromium. PICTURES=FOLDER keeps
# pictures.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/json.sh"
. "$root/tests/scripts/lib/photos.sh"
fit=
trap 'kill $fit 2>/dev/null; rm -rf "$work"' EXIT

run view --web none.ply
case $(cat logs/err) in
*'built without'*) skip preview "$(cat logs/err)"; finish; exit ;;
esac
have curl || { skip preview "no curl here"; finish; exit; }

make_photographs 12
mkdir -p page/viewer
echo '<!doctype html>' | tee page/viewer/index.html >page/viewer/fit.html
FIXSPLAT_WEB=$work/page
export FIXSPLAT_WEB

through=
begins() {
    rm -f logs/errors
    $through "$fixsplat" fit set ${shortest:---preview} --port 0 "$@" >logs/printed 2>logs/errors &
    fit=$!
    until grep -q '^fixsplat: preview: ' logs/errors 2>/dev/null || ! kill -0 $fit 2>/dev/null; do sleep 0.1; done
    at=$(sed -n 's|^fixsplat: preview: \(http://127\.0\.0\.1:[0-9]*\)/$|\1|p' logs/errors)
    [ "$at" ] || { fail "begins $*" "$(cat logs/errors)"; finish; exit 1; }
}
ends() { wait $fit; status=$?; fit=; }
get() { curl -s "$@"; }
code() { get -o logs/body -w '%{http_code}' "$@"; }
number() { sed -n "s/.*\"$1\": \([0-9.]*\).*/\1/p" "$2"; }
points() { sed 's/.*"points": \[\(\[.*\]\)*\].*/\1/; s/\], /]\n/g' "$1" | grep -c '^\['; }

# ---- During the fit --------------------------------------------------------------------------------------------------

begins --steps 1000000 -o long.fxs
tries=0
until get -o fit.json "$at/fit.json" && [ "$(number version fit.json)" -ge 2 ] || [ $((tries += 1)) = 300 ]; do sleep 0.2; done
check "/fit.json: its keys" keys fit.json scene state version background step steps gaussians loss seconds left held_out \
    photographs points
check "/fit.json: what is fitted" equal "$(grep -o '"scene": "long.fxs", "state": "fits"' fit.json | wc -l)" 1
check "/fit.json: a step" [ "$(number step fit.json)" -gt 0 ]
check "/fit.json: seconds that are left" [ "$(number left fit.json | cut -d . -f 1)" -gt 0 ]
check "/fit.json: a point of the two held out" equal "$(grep -o '"held_out": true, "photographs": 2, "points": \[\[0, [0-9]*\.[0-9]*, 0\.[0-9]*\]' \
    fit.json | wc -l)" 1
get -o now.fxs "$at/scene.fxs?2"
get -o later.json "$at/fit.json"        # the scene may be newer than fit.json, but not than this
check "/scene.fxs: a scene" "$fixsplat" info now.fxs
"$fixsplat" render now.fxs --size 64x48 -o start.png
"$fixsplat" render now.fxs --size 64x48 --cameras set/sparse/0 --view 0 -o first.png
psnr=$("$fixsplat" compare start.png first.png | sed -n 's/^PSNR \([0-9.]*\) dB.*/\1/p')
check "/scene.fxs: starts with the first held out" at_least "${psnr:-99}" 50
get -o views.json "$at/cameras.json"
check "/cameras.json: those that are held out" equal "$(grep -o '"img_name": "[^"]*"' views.json | cut -d '"' -f 4 | tr '\n' ' ')" \
    "00.png 08.png "
check "/cameras.json: a file of cameras" "$fixsplat" render now.fxs --size 64x48 --cameras views.json --view 1 -o second.png
before=$(number version later.json)
tries=0
until get -o fit.json "$at/fit.json" && [ "$(number version fit.json)" -gt "$before" ] || [ $((tries += 1)) = 300 ]; do
    sleep 0.2
done
get -o next.fxs "$at/scene.fxs"
check "another version: another scene" [ "$(number version fit.json)" -gt "$before" -a "$(cmp -s now.fxs next.fxs; echo $?)" = 1 ]
check "at most a scene in three seconds, after the first" [ "$(($(number version fit.json) - 1))" -le \
    "$(($(number seconds fit.json | cut -d . -f 1) / 3 + 1))" ]
check "/: leads to the page" equal "$(code -w '%{http_code} %{redirect_url}' "$at/")" "302 $at/viewer/fit.html"
check "/viewer/fit.html" equal "$(code "$at/viewer/fit.html")" 200
check "nothing else" equal "$(code "$at/long.fxs.fit") $(code "$at/set/images/00.png")" "404 404"
check "not by another name" equal "$(code -H 'Host: evil.example' "$at/fit.json")" 421
fails "a port in use" 1 "preview: 127.0.0.1, port ${at##*:}: Address already in use; port 0 is any that is free" \
    fit set -o x.fxs --preview --port "${at##*:}"
kill -TERM $fit
ends 2>logs/shell
check "a signal: saved" equal "$status $(grep -c 'stopped after .*; to go on: fixsplat fit .* --resume long.fxs.fit$' logs/errors)" "143 1"
check "a signal: no scene, and nobody answers" equal "$(ls long.fxs 2>/dev/null) $(code -m 5 "$at/fit.json")" " 000"

# ---- The end of a fit ------------------------------------------------------------------------------------------------

"$fixsplat" fit set --steps 620 -o whole.fxs >logs/out 2>logs/shell
shortest=--pre begins --steps 620 -o seen.fxs --threads 2
ends
check "the same scene as without" cmp whole.fxs seen.fxs
sed 's/whole/seen/g; s/^again, .* set/& --pre --port 0/; s/^again, .* -o seen.fxs/& --threads 2/' logs/out >logs/wanted
check "the same report" cmp logs/printed logs/wanted
begins --steps 400 -o other.fxs --metrics-every 100 --json
while get -o last.json "$at/fit.json"; do
    cp last.json fit.json
    sleep 0.1
done
ends
check "a page that asks: is told of the end" grep -q '"state": "over"' fit.json
check "--metrics-every: these are the points" equal "$(grep -o '\[[1-4]00, ' fit.json | tr -d '\n')" "[100, [200, [300, [400, "
check "--metrics-every: a line each" equal "$(grep -c '^fixsplat: step [123]00: ' logs/errors)" 3
psnr=$(grep -o '"psnr": [0-9.]*, "ssim": [0-9.]*, "affine' logs/printed | tail -n 1 | cut -d ' ' -f 2 | cut -c 1-5)
check "the result: that of the report" grep -q "\"result\": {\"photographs\": 2, \"psnr\": $psnr" fit.json
check "status 0, one JSON object" equal "$status $(wc -l <logs/printed)" "0 1"

ln -s /dev/null null.fxs
(
    trap '' XFSZ
    ulimit -f 8
    exec "$fixsplat" fit set --steps 3000 -o null.fxs --preview --port 0 >logs/printed 2>logs/errors
)
check "no room for a scene: said once, and it goes on" equal "$? $(grep -c \
    'preview: a temporary file: File too large; the fit goes on$' logs/errors)" "0 1"

# ---- Errors ----------------------------------------------------------------------------------------------------------

fails "--port without it" 2 "port needs --preview" fit set -o x.fxs --port 80
fails "--port 65536" 2 "port 65536: expected" fit set -o x.fxs --preview --port 65536
fails "with --measure" 2 "preview does not go with --measure: nothing is fitted" fit set --measure whole.fxs --preview
fails "with --cameras-only" 2 "cameras-only: nothing is fitted: leave out --preview" fit set -o x.fxs --cameras-only --preview
FIXSPLAT_WEB=$work/none fails "no page" 1 "FIXSPLAT_WEB=$work/none: the page is not there" fit set -o x.fxs --preview
fails "no photographs" 1 "none" fit none -o x.fxs --preview --port 0 --quiet
rm page/viewer/fit.html
fails "a page of an earlier version" 1 "page: the page of --preview is not there: no viewer/fit.html" \
    fit set -o x.fxs --preview --port 0

if ! have valgrind || [ "$FXS_EMULATED" ]; then
    skip Valgrind "not here, or not of an emulator"
else
    echo >page/viewer/fit.html
    through='valgrind -q --trace-children=yes --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite'
    begins --steps 12 -o few.fxs
    for path in / /fit.json /scene.fxs /cameras.json /none; do get "$at$path"; done >logs/body
    ends
    check Valgrind equal "$status $(grep -c '^==' logs/errors)" "0 0"
fi

# ---- In a browser ----------------------------------------------------------------------------------------------------

unset FIXSPLAT_WEB
cd "$root" || exit 1
kept=$work
. tests/scripts/lib/web.sh
trap 'rm -rf "$work" "$kept"' EXIT
needs "its page in Chromium" chromium -- puppeteer-core
check "builds" builds
check "size of what the page takes beside the viewer's" at_most 4300 "$package/viewer/fit.html" "$package/viewer/fit.css" "$package/viewer/fit.js"
node tests/web/preview.mjs "$fixsplat" "$kept/set" "$modules" "${PICTURES:-$work}" >"$work/asked" 2>&1 ||
    echo "FAIL preview.mjs: a check above, or it ended early" >>"$work/asked"
counts
cat "$work/sizes"
finish
