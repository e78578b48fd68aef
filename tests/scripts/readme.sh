#!/bin/sh
# The C program of README.md compiles and draws a picture.
B=${B:-build}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed -n '/^```c$/,/^```$/p' README.md | sed '/^```/d' >"$work/program.c"
optional=
for library in cjson:cjson/cJSON.h webp:webp/decode.h zip:zip.h z:zlib.h zstd:zstd.h; do
    ${CC:-cc} -E - </dev/null -include "${library#*:}" >/dev/null 2>&1 && optional="$optional -l${library%%:*}"
done
if ${CC:-cc} -std=c99 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror -I. "$work/program.c" "$B/libfixsplat.a" -lm -lpthread $optional \
    -o "$work/program" && "$B/fixsplat" make-scene cubes -o "$work/cubes.ply" &&
    "$work/program" "$work/cubes.ply" "$work/cubes.ppm" && [ "$(wc -c <"$work/cubes.ppm")" = 691215 ]; then
    echo "ok README program"
    echo "1 passed, 0 failed, 0 skipped"
else
    echo "FAIL README program"
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi
