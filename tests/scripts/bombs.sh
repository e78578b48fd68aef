#!/bin/sh
# Checks that small files which claim huge scenes give an error soon and within 256 MB.
. tests/scripts/lib/check.sh
build=$PWD/${B:-build}
case $B in /*) build=$B ;; esac
fixsplat=$build/fixsplat
root=$PWD
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
${CC:-cc} -O1 -o helper "$root/tests/scripts/lib/helper.c" || exit 1
"$build/tests/test_bombs" --write . >log || { skip "bombs" "built without zlib, libwebp, libzip or cJSON"; finish; exit; }
have timeout || { skip "bombs" "no timeout"; finish; exit; }

# refuses NAME WORDS ARGUMENT...: the command must fail with exit status 1 within 20 s and 256 MB, and print one line
# that contains WORDS.
refuses() {
    name=$1 words=$2
    shift 2
    ./helper peak timeout 20 "$fixsplat" "$@" >peak 2>err
    if [ "$(wc -l <err)" = 1 ] && grep -q "^fixsplat: " err && grep -Eq -- "$words" err && [ ! -e out.fxs ] &&
        [ "$(tail -n 1 peak)" -le 262144 ]; then
        ok "$name"
    else
        fail "$name" "$(tail -n 1 peak) KiB, said: $(cat err)"
        rm -f out.fxs
    fi
}

gaussians='Gaussians or more in [0-9]* bytes of files, beyond the limit of [0-9]*; --max-gaussians raises it'
memory='bytes of memory or more, beyond the limit of [0-9]*; --import-memory raises it'
refuses "padding that deflates to nothing" "padded.sog: 268402689 $gaussians" convert padded.sog out.fxs
refuses "large images" "large.sog: 67104768 $gaussians" convert large.sog out.fxs
refuses "millions of values" "json.sog: .* $memory" convert json.sog out.fxs
refuses "one file 65536 times" "two leaves share Gaussian 0" convert lod-meta.json out.fxs
refuses "one file by links" "the same file as" convert links/lod-meta.json out.fxs
refuses "gzip of zeros" "inflating.spz: 4000000 $gaussians" convert inflating.spz out.fxs
refuses "one .spz 1024 times" "instances.glb: 102400000 $gaussians" convert instances.glb out.fxs
refuses "to another format" "instances.glb: 102400000 $gaussians" convert instances.glb out.ply
refuses "render" "inflating.spz: 4000000 $gaussians" render inflating.spz --hash
refuses "bench" "inflating.spz: 4000000 $gaussians" bench inflating.spz
refuses "info" "inflating.spz: 4000000 $gaussians" info inflating.spz
check "tiny numbers" timeout 20 "$fixsplat" convert exponents.ply out.fxs
rm -f out.fxs

# ---- Limits set by options -------------------------------------------------------------------------------------------

"$fixsplat" make-scene knot --count 20000 -o knot.ply || exit 1
"$fixsplat" convert knot.ply knot.spz
"$fixsplat" convert knot.spz plain.fxs
for command in 'convert knot.spz out.fxs' 'convert knot.spz out.splat' 'render knot.spz --hash' 'bench knot.spz' \
    'info knot.spz' 'info knot.ply --compare knot.spz --views 1 --size 16x16'; do
    case $command in *--compare*) file=knot.ply ;; *) file=knot.spz ;; esac
    refuses "$command: --max-gaussians" "$file: 20000 $gaussians" $command --max-gaussians 19999
    case $command in *--compare*) file=knot.spz ;; esac
    refuses "$command: --import-memory" "$file: .* $memory" $command --import-memory 100K
done
check "--max-gaussians as many as there are" "$fixsplat" convert knot.spz out.fxs --max-gaussians 20000 --import-memory 3M
check "within the limits: the same bytes" cmp plain.fxs out.fxs
for bad in 'max-gaussians 0' 'max-gaussians -1' 'max-gaussians x' 'max-gaussians 1M' 'import-memory 0' 'import-memory 1T'; do
    check "--$bad" sh -c '"$0" convert knot.ply out.fxs --'"$bad"' 2>&1 | grep -q "^fixsplat: --'"${bad% *}"' " && [ $("$0" convert knot.ply out.fxs --'"$bad"' 2>/dev/null; echo $?) = 2 ]' "$fixsplat"
done
rm -f out.fxs

# ---- Special files ---------------------------------------------------------------------------------------------------

mkfifo pipe
mkdir folder
for scene in pipe /dev/null /dev/zero; do
    for command in 'render % --hash' 'convert % out.fxs' 'info %' 'bench %' 'info knot.ply --compare %' \
        'render knot.ply --hash --cameras %' 'compare % %'; do
        refuses "$(echo "$command" | sed "s|%|$scene|g")" "$scene: not a regular file" $(echo "$command" | sed "s|%|$scene|g")
    done
done
refuses "a folder" "folder: not a regular file, but a folder without an index" render folder --hash
refuses "a folder of cameras" "folder: neither sparse/0 of COLMAP" render knot.ply --hash --cameras folder
check "/dev/stdin that is a file" sh -c '"$0" render /dev/stdin --size 64x48 --hash <knot.ply >hash' "$fixsplat"
check "/dev/stdin: the same picture" sh -c '"$0" render knot.ply --size 64x48 --hash | cmp - hash' "$fixsplat"
finish
