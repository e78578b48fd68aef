# Sourced after check.sh by scripts that run the command fixsplat. Sets $fixsplat, $scenes, $helper and $work.
fixsplat=$PWD/${B:-build}/fixsplat
case $B in /*) fixsplat=$B/fixsplat ;; esac
scenes=$(cd "${FXS_SCENES:-../shared/scenes}" 2>/dev/null && pwd)
root=$PWD
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
mkdir logs
helper=logs/helper
${CC:-cc} -O1 -o $helper "$root/tests/scripts/lib/helper.c" || exit 1

# run ARGUMENT...: runs the command fixsplat. Sets $status, and writes its output to logs/out and logs/err.
run() {
    "$fixsplat" "$@" >logs/out 2>logs/err
    status=$?
}

succeeds() {
    name=$1
    shift
    run "$@"
    if [ $status = 0 ] && [ ! -s logs/err ]; then ok "$name"; else fail "$name" "status $status: $(cat logs/err)"; fi
}

# fails NAME STATUS WORDS ARGUMENT...: the command must end with exit status STATUS, and print one line on stderr that
# matches the regular expression WORDS.
fails() {
    name=$1 wanted=$2 words=$3
    shift 3
    run "$@"
    if [ $status = "$wanted" ] && [ ! -s logs/out ] && [ "$(wc -l <logs/err)" = 1 ] && grep -q "^fixsplat: " logs/err &&
        grep -Eq -- "$words" logs/err; then
        ok "$name"
    else
        fail "$name" "status $status, stdout of $(wc -c <logs/out) bytes, stderr: $(cat logs/err)"
    fi
}

psnr_of() {
    scene=$1 original=$2
    shift 2
    "$fixsplat" info "$scene" --compare "$original" --views 4 --size 320x240 "$@" | awk '/^mean/ { print $2 }'
}
at_least() { awk "BEGIN { exit !($1 >= $2) }" || { echo "$1 is below $2"; return 1; }; }
looks_as() {
    file=$1 like=$2 floor=$3
    shift 3
    got=$(psnr_of "$file" "$like" "$@")
    [ "$got" = equal ] || at_least "$got" "$floor"
}
says() { equal "$status $(cat logs/err)" "0 fixsplat: $1"; }
gaussians() {
    "$fixsplat" info "$1" --json | grep -q "\"gaussians\": $2, \"packed\": $2, \"sh_degree\": $3," && return
    "$fixsplat" info "$1"
    return 1
}
