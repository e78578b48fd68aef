#!/bin/sh
# Checks that a picture has the same hash with any number of threads, memory limit and instruction set. qemu-x86_64
# imitates older processors. ThreadSanitizer and Valgrind also run.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$B/fixsplat" make-scene knot --count 20000 -o "$work/scene.ply" || exit 1
set -- render "$work/scene.ply" --eye 0.9,-2.6,-12.8 --look 0,0.42,0 --fov 36 --size 333x187 --hash
expected=$("$B/fixsplat" "$@" --cpu c --threads 1)

same() {
    name=$1
    shift
    hash=$("$@" 2>"$work/errors") || { fail "$name" "$(tail -n 3 "$work/errors")"; return; }
    if [ "$hash" = "$expected" ]; then ok "$name"; else fail "$name" "$hash, expected $expected"; fi
}

for threads in 1 2 3 5 8 16; do
    same "$threads threads" "$B/fixsplat" "$@" --threads $threads
    same "$threads threads in bands" "$B/fixsplat" "$@" --threads $threads --max-memory 1500K
done
for cpu in c sse41 avx2 avx512 neon sse41,avx2 avx2,avx512; do
    if "$B/fixsplat" "$@" --cpu $cpu >/dev/null 2>&1; then
        same "cpu $cpu" "$B/fixsplat" "$@" --cpu $cpu --threads 2
    else
        skip "cpu $cpu" "not on this processor"
    fi
done

# objects OPTION...: prints hashes of a picture of several objects with depths and ids, and of a panorama.
objects() { set -- "$work/scene.ply" --place 0:0,0,0 --place 0:3,1,-2,1,2,3,4,1.5 --place 0:0,0,1 \
    --eye 0.9,-2.6,-12.8 --look 0,0.42,0 --size 201x103 "$@"
    "$B/fixsplat" render "$@" --fov 36 --hash --depth "$work/depth.pfm" --ids "$work/ids.raw" --pick 100,50 &&
        cksum <"$work/depth.pfm" && cksum <"$work/ids.raw" &&
        "$B/fixsplat" render "$@" --size 200x100 --panorama --hash; }
picture=$expected expected=$(objects --cpu c --threads 1)
for how in '--threads 2' '--threads 7' '--threads 3 --max-memory 4800K' '--cpu sse41' '--cpu avx2' '--cpu avx512' \
    '--cpu neon'; do
    if [ "${how#--cpu}" = "$how" ] || objects $how >/dev/null 2>&1; then
        same "objects, $how" objects $how
    fi
done
expected=$picture

if have qemu-x86_64 && [ "$(uname -m)" = x86_64 ]; then
    models='core2duo:c Penryn:sse41 Haswell:avx2'
    [ "$FXS_PROCESSORS" = all ] && models="$models qemu64:c Nehalem:sse41"
    for model in $models; do
        chosen=$(qemu-x86_64 -cpu ${model%:*} "$B/fixsplat" --kernels 2>/dev/null | sed -n 's/^blend *//p')
        if [ "$chosen" = ${model#*:} ]; then
            ok "${model%:*} blends with ${model#*:}"
        else
            fail "${model%:*} blends with ${model#*:}" "with '$chosen'"
        fi
        same "${model%:*}" qemu-x86_64 -cpu ${model%:*} "$B/fixsplat" "$@" --threads 2
    done
else
    skip "older processors" "no qemu-x86_64 here"
fi

if echo 'int main(void) { return 0; }' | clang -fsanitize=thread -x c - -o "$work/links" 2>/dev/null &&
    "$work/links"; then
    # -O0 compiles twice as fast, and ThreadSanitizer sees every access.
    if make -s B="$work/tsan" CC=clang NVCC=none CFLAGS='-O0 -fsanitize=thread' "$work/tsan/fixsplat" \
        "$work/tsan/tests/test_threads" "$work/tsan/tests/test_stop" >"$work/log" 2>&1; then
        check "ThreadSanitizer, several callers of one context" env TSAN_OPTIONS=halt_on_error=1 \
            "$work/tsan/tests/test_threads"
        check "ThreadSanitizer, frames that are stopped" env TSAN_OPTIONS=halt_on_error=1 \
            "$work/tsan/tests/test_stop" --threads
        for threads in 2 7; do
            same "ThreadSanitizer, $threads threads" env TSAN_OPTIONS=halt_on_error=1 "$work/tsan/fixsplat" "$@" \
                --threads $threads
            same "ThreadSanitizer, $threads threads in bands" env TSAN_OPTIONS=halt_on_error=1 \
                "$work/tsan/fixsplat" "$@" --threads $threads --max-memory 1500K
        done
    else
        fail ThreadSanitizer "$(tail -n 3 "$work/log")"
    fi
else
    skip ThreadSanitizer "no clang with it here"
fi

if have valgrind; then
    same Valgrind valgrind -q --error-exitcode=9 --leak-check=full "$B/fixsplat" "$@" --threads 2
else
    skip Valgrind "not here"
fi
finish
