#!/bin/sh
# Who may include whom:
#   src      -> src; <stdint.h>, <stddef.h>, and <string.h> in memory.h alone
#   kernels  -> src, kernels; an instruction set kernels/lanes, which includes src alone, and never another; intrinsics
#               headers (not in lanes), and GPU headers in cuda and gles
#               fit_* of an instruction set includes src/fit/fit_stages.h alone; cuda/fit what is in cuda and port/fit
#   port     -> port, the public headers of src and kernels, and gl.h, which lists the functions that gles calls;
#               port/fit the header of cuda/fit
#   tools    -> tools, the public headers of src, kernels and port
# and src and kernels neither allocate nor print.
cd "$(dirname "$0")/../.." || exit 1
public=$(MAKEFLAGS='' make -s headers | grep -E '^(src|kernels)/' | sed 's/\./\\./' | paste -sd '|')
isa='[a-z]*mmintrin\.h|cpuid\.h|arm_(neon|mve|acle)\.h|sys/auxv\.h|wasm_simd128\.h'
internal='port/[a-z]*/([a-z_]*_internal|scene_format)\.h'
faults=

files() {
    find "$@" -type f \( -name '*.[ch]' -o -name '*.inc' -o -name '*.cu' -o -name '*.cuh' \) 2>/dev/null
}

# The path of "../b.h" as included in a/c.c.
resolve() {
    printf '%s/%s\n' "$(dirname "$1")" "$2" | sed -e 's#/\./#/#g' -e ':again' -e 's#[^/]*/\.\./##' -e 'tagain'
}

# quoted FILE TARGET: what FILE may include with quotes.
quoted() {
    case $1 in
    src/*) allowed='src/.*' ;;
    kernels/lanes/*) allowed='src/.*|kernels/lanes/.*' ;;
    kernels/cuda/fit/*) allowed="kernels/cuda/(fit/.*|device\.cuh)|port/fit/.*" ;;
    kernels/*/fit_*) allowed="port/fit/stages\.h|kernels/[^/]*" ;;
    kernels/*/*) allowed="src/.*|$(dirname "$1")/.*|kernels/lanes/.*|kernels/[^/]*" ;;
    kernels/*) allowed='src/.*|kernels/.*' ;;
    src/fit/*) allowed="port/.*|$public|kernels/cuda/fit/fit\.h" ;;
    port/*) allowed="port/.*|$public|kernels/gles/gl\.h" ;;
    tools/*) allowed="tools/.*|port/.*|$public" ;;
    esac
    printf '%s\n' "$2" | grep -Eqx "$allowed" || return 1
    case $1 in tools/*) ! printf '%s\n' "$2" | grep -Eqx "$internal" ;; esac
}

# angled FILE HEADER: the same for <HEADER>.
angled() {
    case $1 in
    src/core/memory.h) allowed='string\.h' ;;
    src/*) allowed='std(int|def)\.h' ;;
    kernels/cuda/* | kernels/gles/*) return 0 ;;
    kernels/lanes/*) allowed='std(int|def)\.h' ;;
    kernels/*) allowed="std(int|def)\.h|$isa" ;;
    port/*) return 0 ;;
    tools/*) ! printf '%s\n' "$2" | grep -Eq '^(cuda|GL|EGL)'; return ;;
    esac
    printf '%s\n' "$2" | grep -Eqx "$allowed"
}

for file in $(files src kernels port tools); do
    for include in $(sed -n 's/^[ \t]*#[ \t]*include[ \t]*\(["<][^">]*\).*/\1/p' "$file"); do
        name=${include#?}
        case $include in
        '"'*) quoted "$file" "$(resolve "$file" "$name")" || faults="$faults $file includes \"$name\";" ;;
        *) angled "$file" "$name" || faults="$faults $file includes <$name>;" ;;
        esac
    done
done

calls='(^|[^A-Za-z0-9_])(malloc|calloc|realloc|free|alloca|[a-z]*printf|puts|fopen|fread|fwrite|exit|abort)[ \t]*\('
calling=$(files src kernels | xargs awk -f tests/gates/strip_comments.awk | grep -E "$calls" | cut -d: -f1,2 |
    tr '\n' ' ')
[ -z "$calling" ] || faults="$faults allocates or prints: $calling"

if [ -n "$faults" ]; then
    echo "FAIL include_rules:$faults"
    exit 1
fi
echo "ok   include_rules"
