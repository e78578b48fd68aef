#!/bin/sh
# Scenes with levels of detail on the command line: what info prints of their trees, and the options --budget and
# --detail of the commands that render.
cd "$(dirname "$0")/../.." || exit 1
. tests/scripts/lib/check.sh
fixsplat=$PWD/${B:-build}/fixsplat
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
export FIXSPLAT_QUIET=1

"$fixsplat" make-scene knot --count 30000 -o knot.ply
"$fixsplat" convert knot.ply knot.fxs --levels
"$fixsplat" convert knot.ply flat.fxs
small='--size 160x100'

# refused NAME STATUS PATTERN ARGUMENT...: the command fails with one line like that.
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
hash_of() { "$fixsplat" render "$@" $small --hash; }

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
check "render --budget: fewer are another picture" test "$(hash_of knot.fxs --budget 9000)" != "$(hash_of knot.fxs)"
check "render --detail: another picture" test "$(hash_of knot.fxs --detail 4)" != "$(hash_of knot.fxs)"
refused "render --detail 0" 2 'detail 0: expected' render knot.fxs --detail 0 --hash
"$fixsplat" bench knot.fxs $small --budget 9000 --detail 2.5 --json >bench.json
check "bench: says the budget and the detail" grep -q '"budget": 9000.*"detail": 2.5' bench.json
"$fixsplat" bench knot.fxs $small --budget 4000 --compare bench.json >text 2>&1
check "bench --compare: another budget is marked" grep -q 'budget is 9000 there and 4000 here' text
for command in render view bench info; do
    check "$command --help has --budget and --detail" equal \
        "$("$fixsplat" $command --help | grep -c -e '^  --budget N' -e '^  --detail PIXELS')" 2
done

finish
