#!/bin/sh
# probe.sh BUILD: finds the target of the compiler $CC and the optional libraries, and writes BUILD/probe.mk for the
# Makefile. BUILD/with/NAME changes when library NAME appears, disappears or has new headers. Probes again only if
# compiler, flags, packages or search folders changed. Environment variables: CC, CPPFLAGS, CFLAGS, LDFLAGS, NVCC.
build=${1:?build folder}
mkdir -p "$build/with" "$build/tests" || exit 1

libraries=$(sed -n 's/^LIBRARY_\([A-Z]*\) := /\1 /p' make/sources.mk)

# The shell evaluates the compiler flags as in a recipe of make, since they may contain quotes.
compile() { eval "$CC $CPPFLAGS $CFLAGS" '"$@"'; }
link() { eval "$CC $CPPFLAGS $CFLAGS $LDFLAGS" '"$@"'; }
search_folders() {
    compile -v -E -x c /dev/null 2>&1 | sed -n '/^#include </,/^End/s/^ //p'
    link -print-search-dirs | sed -n 's/^libraries: =//p' | tr : '\n'
    printf '%s\n' $CFLAGS $LDFLAGS | sed -n 's/^-L//p'
    printf '%s\n' /usr/local/lib
}
nvcc=$(command -v "$NVCC")

key() {
    printf '%s\n' "$CC" "$CPPFLAGS" "$CFLAGS" "$LDFLAGS" "$CPATH" "$C_INCLUDE_PATH" "$LIBRARY_PATH"
    eval "$CC --version"
    parts=$(echo "$libraries" | sed -n 's|^[A-Z]* \(.*\)/.*|\1|p' | sort -u)
    search_folders | while read -r folder; do
        printf '%s\n' "$folder"
        for part in $parts; do printf '%s\n' "$folder/$part"; done
    done | xargs ls -Lld --full-time "$0" make/sources.mk make/target.txt $nvcc /var/lib/dpkg/status
    ls kernels/*.c kernels/cuda
}
state=$(key 2>/dev/null)
[ -e "$build/probe.mk" ] && printf '%s\n' "$state" | cmp -s - "$build/probe.key" && exit

# found NAME HEADERS YES: notes that library NAME was found, or not found if YES is empty. Writes BUILD/with/NAME, a
# checksum of HEADERS, only if its content changes.
found() {
    [ "$3" ] && echo "FOUND += $1" && set -- "$1" "$(cat $2 </dev/null 2>/dev/null | cksum)"
    echo "$2" | cmp -s - "$build/with/$1" || echo "$2" >"$build/with/$1"
}

source=$build/probe.c
object=$build/probe.out
probe() {
    echo "$libraries" | while read -r name header flags; do
        printf '%s\n' '#include <stdio.h>' "#include <$header>" 'int main(int argc, char **argv) { return argc && argv ? 0 : 1; }' >"$source"
        if link "$source" -O0 -g0 -o "$object" -MD -MF "$object.d" $flags 2>/dev/null; then
            found $name "$(tr -d '\\\n' <"$object.d" | sed 's/^[^:]*://')" yes
            echo "LIBS_$name := $flags"
        else
            found $name
        fi
    done
    found KERNELS '' "$(ls kernels/*.c 2>/dev/null)"
    echo 'int main(void) { return 0; }' >"$source"

    compile -E -P -x c make/target.txt

    printf '%s\n' '#include <float.h>' '#if FLT_EVAL_METHOD != 0' '#error' '#endif' >"$source.h"
    for singles in '' $(sed -n 's/^SINGLES_BY := //p' make/sources.mk); do
        singles=$(echo $singles | tr , ' ')
        compile -std=c99 $singles -E -x c "$source.h" >/dev/null && echo "SINGLES := $singles" && break
    done

    # CUDA's libraries do not link if they are for another processor than that of CC. The library CUB includes C++
    # streams, hence libstdc++.
    cuda=$([ "$nvcc" ] && "$nvcc" --dryrun -x cu /dev/null 2>&1 | sed -n 's/"//g; s/.*LIBRARIES= *//p')
    cuda="$cuda -lcudart_static -lstdc++ -lpthread -ldl -lrt"
    if [ "$nvcc" ] && [ -d kernels/cuda ] && eval "link '$source' -o '$object' $cuda" 2>/dev/null; then
        found CUDA '' yes
        echo "LIBS_CUDA := $cuda"
        echo "NVCC_VERSION := $("$nvcc" --version | tr -d '\n')"
    else
        found CUDA
    fi

    link -shared -fPIC -fvisibility=hidden -Wl,-soname,probe "$source" -o "$object" 2>/dev/null &&
        echo 'SHARED := yes'
    echo "CC_VERSION := $(eval "$CC --version" 2>/dev/null | tr -d '\n' | tr '#$' '  ')"
    echo "AR_OF_CC := $(eval "$CC -print-prog-name=ar" 2>/dev/null)"
}
rm -f "$build/probe.key"
probe 2>/dev/null >"$build/probe.mk"
rm -f "$source" "$source.h" "$object" "$object.d"
printf '%s\n' "$state" >"$build/probe.key"
