#!/bin/sh
# The C program of README.md compiles as README.md says, where it is installed, and draws a picture.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
have pkg-config || { skip "README program" "no pkg-config here"; finish; exit; }
sed -n '/^```c$/,/^```$/p' README.md | sed '/^```/d' >"$work/program.c"
sed -n 's/^    cc program/${CC:-cc} $strict program/p' README.md >"$work/compile"
strict='-std=c99 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror'

check "README: make install" make -s B="$B" PREFIX="$work/prefix" install
PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig LD_LIBRARY_PATH=$work/prefix/lib
export PKG_CONFIG_PATH LD_LIBRARY_PATH
check "README: the program compiles" eval "(cd '$work' && . ./compile)"
"$B/fixsplat" make-scene cubes -o "$work/cubes.ply" || exit 1
check "README: the program runs" "$work/program" "$work/cubes.ply" "$work/cubes.ppm"
check "README: a picture" equal "$(wc -c <"$work/cubes.ppm")" 691215
finish
