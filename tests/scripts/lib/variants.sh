# Sourced after check.sh by scripts that build a test program in many ways.
flags='-std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off -g0'
flags="$flags -I$PWD/src/include -I$PWD"
variants=

links() { echo 'int main(void) { return 0; }' | "$@" -x c - -o "$work/links" >/dev/null 2>&1; }

# variant NAME COMMAND [EMULATOR]: adds a test program, which COMMAND builds as $work/NAME. In COMMAND, % stands for
# that path.
variant() {
    echo "$2" | sed "s|%|$work/$1|g" >"$work/$1.build"
    echo "$3 $work/$1" >"$work/$1.run"
    variants="$variants $1"
}

run_variants() {
    printf '%s\n' $variants | xargs -P 2 -I NAME sh -c "
        sh '$work/NAME.build' >'$work/NAME.log' 2>&1 && sh '$work/NAME.run' >'$work/NAME.log' 2>&1
        echo \$? >'$work/NAME.status'"
    first=
    for name in $variants; do
        status=$(cat "$work/$name.status")
        sum=$(sed -n 's/.*random frames: //p' "$work/$name.log" | tr '\n' ' ')
        first=${first:-$sum}
        said="$name (${sum:+sum }${sum:-$(tail -n 1 "$work/$name.log")})"
        if [ "$status" = 0 ] && [ "${sum:-$first}" = "$first" ]; then
            ok "$said"
        else
            cat "$work/$name.log"
            fail "$said" "status $status, the first sum is $first"
        fi
    done
}
