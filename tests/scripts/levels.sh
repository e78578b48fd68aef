#!/bin/sh
# Tests levels of detail: trees in `fixsplat info`, the options --budget and --detail, and paged scenes (partly in
# memory) from files and servers.
cd "$(dirname "$0")/../.." || exit 1
. tests/scripts/lib/check.sh
fixsplat=$PWD/${B:-build}/fixsplat lib=$PWD/tests/scripts/lib
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
export FIXSPLAT_QUIET=1

"$fixsplat" make-scene knot --count 30000 -o knot.ply
"$fixsplat" convert knot.ply knot.fxs --levels
"$fixsplat" convert knot.ply flat.fxs
small='--size 160x100'

refused() {
    name=$1 wanted=$2 pattern=$3
    shift 3
    "$fixsplat" "$@" >out 2>why
    status=$?
    if [ $status = "$wanted" ] && [ "$(wc -l <why)" = 1 ] && grep -q "$pattern" why; then
        ok "$name"
    else
        fail "$name" "status $status: $(cat why)"
    fi
}
hash_of() { "$fixsplat" render $small "$@" --hash; }

# ---- info ------------------------------------------------------------------------------------------------------------

"$fixsplat" info knot.fxs >text && "$fixsplat" info knot.fxs --json >json
check "info: levels from one node down to all leaves" awk '
    /^level/ { on = 1; next }
    /^frame/ { on = 0 }
    on && !rows++ && $3 > 4 { wrong = 1 }
    on { if (last && $2 >= last) wrong = 1; last = $2; nodes += $3; gaussians = $4; leaves = $3; bytes += $5
         if (last > 1 && !($6 > 0 && $7 > 0)) wrong = 1 }
    END { exit wrong || !(rows > 4 && last == 1 && gaussians == 30000 && nodes == 2 * leaves - 1 && bytes > 2 * 63 * 30000) }' text
if have python3; then
    check "info --json: the same" python3 - <<'END'
import json
info = json.load(open("json"))
rows = [line.split() for line in open("text")]
table = [row for row in rows if len(row) == 7 and row[0].isdigit()]
tree = info["tree"]
assert [[str(l["level"]), str(l["leaves"]), str(l["nodes"]), str(l["gaussians"]), str(l["bytes"])] for l in tree] == \
    [row[:5] for row in table], (tree, table)
assert all(l["error"] > 0 and l["size"] > 0 for l in tree[:-1]) and tree[-1]["size"] is None
assert sum(l["nodes"] for l in tree[:-1]) == tree[-1]["nodes"] - 1
END
else
    skip "info --json" "no python3"
fi
"$fixsplat" info flat.fxs >text
check "info: a scene without levels has no table" equal "$(grep -c ^level text)" 0

psnr_of() { "$fixsplat" info knot.fxs --compare knot.ply --views 2 $small "$@" | awk '/^mean/ { print $2 }'; }
coarse=$(psnr_of --budget 4000) fine=$(psnr_of --budget 16000) whole=$(psnr_of) pixels=$(psnr_of --detail 8)
check "info --compare: the larger the budget, the nearer" awk "BEGIN { exit !($coarse + 1 < $fine && $fine + 1 < $whole) }"
check "info --compare --detail" awk "BEGIN { exit !($pixels + 1 < $whole) }"
refused "info --budget without --compare" 2 'budget needs --compare' info knot.fxs --budget 9
refused "info --compare --budget of a scene without levels" 1 'flat.fxs: has no levels of detail' \
    info flat.fxs --compare knot.ply --budget 9000

# ---- Commands that render --------------------------------------------------------------------------------------------

check "render --budget: all is as without" equal "$(hash_of knot.fxs --budget 30000)" "$(hash_of knot.fxs)"
drawn=$("$fixsplat" render knot.fxs --budget 9000 --stats -o drawn.ppm | sed 's/.*"drawn": \([0-9]*\),.*/\1/')
check "render --budget --stats: what is drawn is nearly the budget" awk "BEGIN { exit !($drawn > 8000 && $drawn <= 9000) }"
check "render --budget: fewer are another picture" test "$(hash_of knot.fxs --budget 9000)" != "$(hash_of knot.fxs)"
check "render --detail: another picture" test "$(hash_of knot.fxs --detail 4)" != "$(hash_of knot.fxs)"
refused "render --detail 0" 2 'detail 0: expected' render knot.fxs --detail 0 --hash
"$fixsplat" bench knot.fxs $small --budget 9000 --detail 2.5 --json >bench.json
check "bench: says the budget and the detail" grep -q '"budget": 9000.*"detail": 2.5' bench.json
"$fixsplat" bench knot.fxs $small --budget 4000 --compare bench.json >text 2>&1
check "bench --compare: another budget is marked" grep -q 'budget is 9000 there and 4000 here' text
for command in render view bench info; do
    check "$command --help all has --budget and --detail" equal \
        "$("$fixsplat" $command --help all | grep -c -e '^  --budget N' -e '^  --detail PIXELS')" 2
done

# ---- Paging ----------------------------------------------------------------------------------------------------------

size=$(wc -c <knot.fxs)
for options in "" "--budget 9000" "--detail 4" "--budget 9000 --stereo 0.1" \
    "--budget 9000 --panorama --size 200x100" "--eye 0,-1,-4 --look 0,0,0 --budget 12000"; do
    check "render --pool $options: the same bytes" equal "$(hash_of knot.fxs --pool "$size" $options)" \
        "$(hash_of knot.fxs $options)"
done
check "render --pool: less than the file, several views" equal \
    "$(hash_of knot.fxs --pool $((size / 2)) --budget 9000 --orbit 7)" "$(hash_of knot.fxs --budget 9000 --orbit 7)"
for backend in gles-compute vulkan; do
    "$fixsplat" info --backends | grep -q "^$backend  *here" || continue
    check "render --pool on a device: less than the file, two eyes, $backend" equal \
        "$(hash_of knot.fxs --pool $((size / 2)) --budget 9000 --orbit 3 --stereo 0.1 --backend $backend)" \
        "$(hash_of knot.fxs --budget 9000 --orbit 3 --stereo 0.1)"
    refused "render --pool on a device: too little device memory, $backend" 1 'max-memory 262144: it needs at least 520192' \
        render knot.fxs --pool $((size / 2)) --budget 9000 --backend $backend --max-memory 256K --hash
done
refused "render --pool: too little for any" 1 'knot.fxs: a pool of 9999 bytes is too little' \
    render knot.fxs --pool 9999 --hash
refused "render --pool: too little for the picture" 1 'the pool has no room for .* larger --pool' \
    render knot.fxs --pool 600K --hash
refused "render --pool: no levels" 1 'flat.fxs: has no levels of detail' render flat.fxs --pool 9M --hash
refused "render --pool: no .fxs" 1 'knot.ply: not an .fxs file' render knot.ply --pool 9M --hash
if have script; then
    env -u FIXSPLAT_QUIET script -qc "'$fixsplat' render knot.fxs --pool 9M --budget 12000 $small --hash" /dev/null \
        </dev/null >tty
    check "render --pool: a terminal shows that it reads" grep -q 'reading .*%' tty
else
    skip "render --pool: a terminal shows that it reads" "no script here"
fi
head -c $((size - 1)) knot.fxs >short.fxs
refused "render --pool: cut short" 1 'short.fxs: damaged or cut short' render short.fxs --pool 9M --hash
{ head -c 300000 knot.fxs; printf damaged; tail -c +300008 knot.fxs; } >damaged.fxs
refused "render --pool: damaged" 1 'damaged.fxs: chunk .* is damaged' render damaged.fxs --pool 9M --hash

"$fixsplat" make-scene landscape --count 600000 -o large.ply
"$fixsplat" convert large.ply large.fxs --levels
camera='--eye 4.6,-1.9,-12.7 --look 0,-2.2,0'
check "render --budget of a large scene: the bytes of another pool" equal \
    "$(hash_of large.fxs --budget 60000 --orbit 3)" "$(hash_of large.fxs --budget 60000 --orbit 3 --pool 200M)"
"$fixsplat" bench large.fxs $small --budget 60000 --json >bench.json
for backend in gles-compute vulkan; do
    ! "$fixsplat" info --backends | grep -q "^$backend  *here" ||
        check "render --budget of a large scene, in part on a device, $backend" equal \
            "$(hash_of large.fxs $camera --budget 60000 --backend $backend)" \
            "$(hash_of large.fxs $camera --budget 60000)"
done
check "bench --budget of a large scene" grep -q '"budget": 60000' bench.json
root=$(($(wc -c <large.fxs) - ($(od -An -tu4 -j12 -N4 large.fxs) - 1) * 16128))
{ head -c $root large.fxs; printf damaged; tail -c +$((root + 8)) large.fxs; } >damaged.fxs
refused "render --budget of a large scene: it is read in part" 1 'damaged.fxs: chunk .* is damaged' \
    render damaged.fxs $camera --budget 256 --hash
rm large.ply large.fxs damaged.fxs

# ---- From a server ---------------------------------------------------------------------------------------------------

refused "another command and a URL" 1 'is read in part, by render and view' bench http://127.0.0.1:1/knot.fxs
"$fixsplat" render http://127.0.0.1:1/knot.fxs --hash 2>why
if grep -q libcurl why; then
    skip "scenes of a server" "$(cat why)"
    finish
    exit
fi
have python3 || { skip "scenes of a server" "no python3"; finish; exit; }
refused "nobody answers" 1 "http://127.0.0.1:1/knot.fxs: Couldn't connect" render http://127.0.0.1:1/knot.fxs --hash

mkfifo hold
python3 "$lib/range_server.py" knot.fxs <hold >requests &
exec 3>hold
for _ in $(seq 100); do
    [ -s requests ] && break
    sleep 0.2
done
at=http://127.0.0.1:$(head -n 1 requests)
view="--eye 0,-1,-4 --look 0,0,0 --budget 12000"
for way in right moved dated; do
    check "$way: the same bytes" equal "$(hash_of $at/$way/knot.fxs $view)" "$(hash_of knot.fxs $view)"
done
check "requests are conditional on the ETag" grep -q '^right bytes=.* "a"$' requests
check "or on the date" grep -q '^dated bytes=.* Mon, 01 Nov' requests
check "not a request for each chunk" test "$(grep -c ^right requests)" -lt 60
check "less than all is fetched, with a small budget" awk -v size="$size" '
    /^right/ { split(substr($2, 7), range, "-"); sum += range[2] - range[1] + 1 } END { exit !(sum > 0 && sum < 3 * size) }' requests
served() { refused "$1" 1 "^fixsplat: .*$at/$1/knot.fxs: $2" render $at/$1/knot.fxs $view --hash; }
start=$(date +%s)
"$fixsplat" render $at/slow/knot.fxs $view --hash >/dev/null 2>slow.err &
slow=$!
served missing 'the server answers 404'
served turning 'the server answers 302'
served garbled ''
served silent ''
served headers 'the server sends more than 65536 bytes of headers'
served whole 'the server sends whole files alone'
served other 'the server does not say that it sends bytes 0 to 191'
served unsaid 'the server does not say that it sends bytes'
served longer 'the server sends more than it was asked for'
served tiny 'not an .fxs file: it has fewer'
served change 'changed while it was read'
served change-date 'changed while it was read'
served change-unsaid 'changed while it was read'
served damaged 'chunk .* is damaged'
served early 'the server ended early'
check "without a start view the scene is framed whole, which is said" equal \
    "$(env -u FIXSPLAT_QUIET "$fixsplat" render $at/right/knot.fxs $small -o x.png 2>&1 | grep -c 'has no start view')" 1

# Builds a libcurl that prints its options, to test redirects from https.
cat >curl.c <<'END'
#include <curl/curl.h>
#include <stdarg.h>
#include <stdio.h>
#undef curl_easy_setopt
#undef curl_easy_getinfo
CURLcode curl_global_init(long flags) { (void)flags; return CURLE_OK; }
CURL *curl_easy_init(void) { return stderr; }
CURLcode curl_easy_setopt(CURL *handle, CURLoption option, ...)
{
    va_list list;
    va_start(list, option);
    if (option == CURLOPT_REDIR_PROTOCOLS_STR)
        fprintf(handle, "to %s\n", va_arg(list, const char *));
    va_end(list);
    return CURLE_OK;
}
CURLcode curl_easy_perform(CURL *handle) { (void)handle; return CURLE_COULDNT_CONNECT; }
CURLcode curl_easy_getinfo(CURL *handle, CURLINFO info, ...) { (void)handle, (void)info; return CURLE_OK; }
void curl_easy_cleanup(CURL *handle) { (void)handle; }
struct curl_slist *curl_slist_append(struct curl_slist *list, const char *text) { (void)text; return list; }
void curl_slist_free_all(struct curl_slist *list) { (void)list; }
const char *curl_easy_strerror(CURLcode code) { (void)code; return "played"; }
END
mkdir played && if ${CC:-cc} -shared -fPIC -o played/libcurl.so.4 curl.c 2>curl.err; then
    for address in http://a/b.fxs https://a/b.fxs HTTPS://a/b.fxs; do
        check "$address: where it may be redirected to" equal "$(LD_LIBRARY_PATH=$PWD/played "$fixsplat" render $address \
            --hash 2>&1 | sed -n 's/^to //p')" "$(case $address in http:*) echo http,https ;; *) echo https ;; esac)"
    done
else
    skip "where an address may be redirected to" "$(head -n 1 curl.err)"
fi
wait $slow
check "a server of two bytes a second: after some 30 seconds" equal "$? $(cat slow.err)" \
    "1 fixsplat: $at/slow/knot.fxs: the server is too slow: below 1000 bytes a second for 30 seconds"
check "a server of two bytes a second: not for ever" [ $(($(date +%s) - start)) -lt 120 ]
exec 3>&-
wait

finish
