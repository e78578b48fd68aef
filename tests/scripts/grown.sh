#!/bin/sh
# Tests that programs built with older, shorter structs run with this library. The script copies the headers, and
# removes the last field of each struct whose first field is its size. The program tests/outside/grown.c must print the
# same with both versions of the headers.
. tests/scripts/lib/check.sh
B=${B:-build} CC=${CC:-cc}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
library=$(ls "$B"/libfixsplat.so.* 2>/dev/null | head -n 1)
[ "$library" ] || { skip "structs that grew" "no shared library here"; finish; exit; }
ln -s "$PWD/$library" "$work/libfixsplat.so.1" && ln -s libfixsplat.so.1 "$work/libfixsplat.so"

mkdir -p "$work/headers/fixsplat/internal"
for header in src/include/fixsplat/*.h src/include/fixsplat/internal/*.h; do
    sed -e ':more' -e '/\/\*/{' -e '/\*\//!{N;b more' -e '}' -e 's|/\*.*\*/||' -e '}' "$header" | awk '
        /^typedef struct fxs_[a-z_]* \{/ { n = 0; inside = 1 }
        inside { line[++n] = $0
            if (/^\}/) {
                sized = line[2] ~ /^ *uint32_t size; *$/ && !/fxs_request;/
                for (last = n - 1; sized && line[last] !~ /;/; last--) ;
                if (line[last] ~ /unused;/) for (n = last--; line[last] !~ /;/; last--) ;
                line[n] = $0
                for (i = 1; i <= n; i++) if (!sized || i != last) print line[i]
                if (sized) print $2 >"/dev/stderr"
                inside = 0
            }
            next }
        { print }' >"$work/headers/${header#src/include/}" 2>>"$work/sized"
done
check "structs that begin with their size: at least 14" test "$(wc -l <"$work/sized")" -ge 14

# build NAME INCLUDES: compiles grown.c with the headers in the folder INCLUDES.
build() {
    check "grown.c with $1 headers" "$CC" -std=c99 -I"$2" tests/outside/grown.c -o "$work/$1" -L"$work" \
        -lfixsplat
}
build whole src/include
build shorter "$work/headers"
whole=$(LD_LIBRARY_PATH=$work "$work/whole" 2>&1)
check "the program runs" test "${#whole}" = 16
check "the program with shorter structs: the same pictures and scene" equal \
    "$(LD_LIBRARY_PATH=$work "$work/shorter" 2>&1)" "$whole"

# Padding at the end would become a field that older programs never set.
for header in $(grep -l '^FXS_API' src/include/fixsplat/*.h); do echo "#include <fixsplat/${header##*/}>"; done >"$work/all.c"
"$CC" -std=c99 -Isrc/include -Wpadded -fsyntax-only "$work/all.c" 2>&1 |
    sed -n 's/^\([^:]*\):\([0-9]*\):.*padding struct size.*/\1 \2/p' |
    while read -r file line; do sed -n "${line}s/^} //p" "$file"; done | sort >"$work/padded"
check "no struct that begins with its size ends in padding" equal "$(sort "$work/sized" | comm -12 - "$work/padded")" ""
finish
