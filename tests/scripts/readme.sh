#!/bin/sh
# Compiles and runs the C programs of README.md and docs/fit.md with the installed library.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
have pkg-config || { skip "README program" "no pkg-config here"; finish; exit; }
program_of() { sed -n '/^```c$/,/^```$/p' "$1" | sed '/^```/d' >"$work/program.c"; }
program_of README.md
sed -n 's/^    cc program/${CC:-cc} $strict program/p' README.md >"$work/compile"
strict='-std=c99 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror'

check "README: make install" make -s B="$B" PREFIX="$work/prefix" install
PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig LD_LIBRARY_PATH=$work/prefix/lib
export PKG_CONFIG_PATH LD_LIBRARY_PATH
check "README: the program compiles" eval "(cd '$work' && . ./compile)"
"$B/fixsplat" make-scene cubes -o "$work/cubes.ply" || exit 1
check "README: the program runs" "$work/program" "$work/cubes.ply" "$work/cubes.ppm"
check "README: a picture" equal "$(wc -c <"$work/cubes.ppm")" 691215

# Imitates COLMAP without a screen or GPU: it aborts unless Qt is offscreen, and unless steps other than the mapper are
# told to use no GPU.
mkdir -p "$work/bin" "$work/phone/garden/images"
cat >"$work/bin/colmap" <<'END'
#!/bin/sh
case "$QT_QPA_PLATFORM $* " in
offscreen\ mapper\ * | offscreen\ *.use_gpu\ 0\ *) echo "$1" ;;
*) echo "$*: aborted" ;;
esac
END
chmod +x "$work/bin/colmap"
sed -n '/^To run COLMAP by hand/,/^`pictures`/s/^    //p' docs/fit.md | grep -v '^fixsplat ' >"$work/commands"
check "docs/fit.md: COLMAP without a display" equal \
    "$(cd "$work/phone" && unset QT_QPA_PLATFORM && PATH=$work/bin:$PATH sh -e ../commands | tr '\n' ' ')" \
    "feature_extractor exhaustive_matcher mapper "

program_of docs/fit.md
check "docs/fit.md: the program compiles" eval "(cd '$work' && . ./compile)"
fixsplat=$PWD/$B/fixsplat
case $B in /*) fixsplat=$B/fixsplat ;; esac
. tests/scripts/lib/photos.sh
(cd "$work" && make_photographs 3)
check "docs/fit.md: the program runs" "$work/program" "$work/set" "$work/set.fxs"
"$B/fixsplat" fit "$work/set" -o "$work/command.fxs" --steps 200 --hold-out 0 --quiet >"$work/log"
check "docs/fit.md: the file of the command" cmp "$work/set.fxs" "$work/command.fxs"
finish
