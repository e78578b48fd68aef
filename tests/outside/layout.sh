#!/bin/sh
# layout.sh: prints the structs, constants and functions of the stable headers, which version 1.x must keep. Allowed
# changes: the total size of a struct whose first field is its size, and the offset of the options in fxs_request.
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
sh tools/scripts/declarations.sh $(grep -l '^FXS_API' src/include/fixsplat/*.h) >"$work/stable" || exit 1
/usr/bin/python3 tests/outside/layout.py "${1:-$(ls "${B:-build}"/libfixsplat.so.*)}" "$work/stable" |
    sed "s/struct fxs_/fxs_/g" | LC_ALL=C sort >"$work/layout" || exit 1
sed -n 's/^\(fxs_[a-z_]*\)\.size 0 uint32_t$/\1/p' "$work/layout" >"$work/sized"
awk 'NR == FNR { sized[$1]; next } !($3 == "bytes" && $1 in sized) && $1 != "fxs_request.options"' "$work/sized" "$work/layout"
