# Sourced by the tests of the web port (docs/web.md), after check.sh.
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
scenes=${FXS_SCENES:-../shared/scenes}
modules=${NODE_MODULES:-$B/page/node_modules}
package=$B/web/package
[ "${B#/}" = "$B" ] && package=$PWD/$package

# needs NAME PROGRAM... [-- MODULE...]: ends the script where one of these, or of what makes the package, is not here.
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

# builds GOAL...: makes the package, and other goals, without a word; one script at a time.
builds() {
    said=$(flock "$B/web.lock" make -s B="$B" web "$@" 2>&1 | grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

# at_most BYTES FILE...: gzipped, each on its own as a server sends them.
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

# asks FILE ARGUMENT...: the checks of tests/web/FILE.
asks() {
    file=$1
    shift
    node "tests/web/$file" "$package" "$work" "$modules" "$@" >"$work/asked" 2>&1 ||
        echo "FAIL $file: a check above, or it ended early" >>"$work/asked"
    counts
}

# counts: what was asked, with its lines of ok and FAIL.
counts() {
    cat "$work/asked"
    passed=$((passed + $(grep -c '^ok ' "$work/asked"))) failed=$((failed + $(grep -c '^FAIL ' "$work/asked")))
}
