#!/bin/sh
# Checks which public functions are stable (FXS_API) or experimental (FXS_EXPERIMENTAL). The functions of a public
# header must all be of one kind. A stable header must include only stable headers, and use no type of an experimental
# one. The headers in fixsplat/internal are experimental.
cd "$(dirname "$0")/../../src/include/fixsplat" || exit 1
faults=
code() { awk -f ../../../tests/gates/strip_comments.awk "$@" | sed 's/^[^:]*:[0-9]*://'; }

experimental=$(grep -l '^FXS_EXPERIMENTAL' ./*.h | sed 's|^\./||')
stable=$(grep -l '^FXS_API' ./*.h | sed 's|^\./||')
for header in $experimental; do
    case " $(echo $stable) " in *" $header "*) faults="$faults $header has functions of both kinds;" ;; esac
done
for header in internal/*.h; do
    ! grep -q '^FXS_API' "$header" || faults="$faults $header has a stable function;"
done

# Lists the types that experimental headers define. A stable header may use such a type only as an opaque struct, by
# pointer.
types=$(code $experimental internal/*.h | grep -oE '^\} fxs_[a-z0-9_]+;|^typedef [^;]*fxs_[a-z0-9_]+;' |
    grep -oE 'fxs_[a-z0-9_]+;$' | tr -d ';' | sort -u | tr '\n' '|')
for header in $stable; do
    for included in $(sed -n 's/^#include [<"]\(fixsplat\/\)\{0,1\}\([a-z_\/]*\.h\)[>"]$/\2/p' "$header"); do
        case " $(echo $experimental) " in
        *" $included "*) faults="$faults $header includes $included;" ;;
        esac
        case $included in internal/*) faults="$faults $header includes $included;" ;; esac
    done
    used=$(code "$header" | sed 's/struct fxs_[a-z0-9_]*//g' | grep -owE "(${types%|})" | sort -u | tr '\n' ' ')
    [ -z "$used" ] || faults="$faults $header uses $used;"
done
[ "$types" ] || faults="$faults no types found;"
[ -z "$faults" ] && echo "ok   stable" || { echo "FAIL stable:$faults"; exit 1; }
