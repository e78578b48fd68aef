# Sourced after check.sh by the tests of the web port (docs/web.md).
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
scenes=${FXS_SCENES:-../shared/scenes}
modules=${NODE_MODULES:-$B/page/node_modules}
package=$B/web/package
[ "${B#/}" = "$B" ] && package=$PWD/$package

# needs NAME PROGRAM... [-- MODULE...]: skips the script if a program or npm module is missing.
needs() {
    name=$1 missing= kind=program
    shift
    for one in clang wasm-ld wasm-opt node "$@"; do
        case $kind$one in
        program--) kind=module ;;
        program*) have "$one" || missing="$missing $one" ;;
        *) [ -d "$modules/$one" ] || missing="$missing $one (make setup test)" ;;
        esac
    done
    if [ -z "$missing" ] && ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E - >/dev/null 2>&1; then
        missing=' wasi-libc'
    fi
    [ -z "$missing" ] && return
    skip "$name" "not here:$missing"
    finish
    exit
}

# builds GOAL...: makes the npm package and other make goals. A lock lets only one script build at a time.
builds() {
    said=$(flock "$B/web.lock" make -s B="$B" web "$@" 2>&1 | grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

at_most() {
    limit=$1 bytes=0 names=
    shift
    for file; do
        bytes=$((bytes + $(gzip -9c "$file" | wc -c)))
        names="$names $(basename "$file")"
    done
    echo " $names: $bytes bytes gzipped, at most $limit" >>"$work/sizes"
    [ "$bytes" -le "$limit" ] || { echo "$bytes bytes gzipped, more than $limit"; return 1; }
}

asks() {
    file=$1
    shift
    node "tests/web/$file" "$package" "$work" "$modules" "$@" >"$work/asked" 2>&1 ||
        echo "FAIL $file: a check above, or it ended early" >>"$work/asked"
    counts
}

counts() {
    cat "$work/asked"
    passed=$((passed + $(grep -c '^ok ' "$work/asked"))) failed=$((failed + $(grep -c '^FAIL ' "$work/asked")))
}
