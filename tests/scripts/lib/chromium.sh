# Sourced by the scripts that ask the npm package in headless Chromium (tests/web), after check.sh.
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
scenes=${FXS_SCENES:-../shared/scenes}
package=$B/web/package
modules=${NODE_MODULES:-$B/page/node_modules}

# needs NAME MODULE...: ends here, skipped, where a program or a module of npm is missing.
needs() {
    name=$1 missing=
    shift
    for program in clang wasm-ld wasm-opt node chromium; do have $program || missing="$missing $program"; done
    for module; do [ -d "$modules/$module" ] || missing="$missing $module (make setup test)"; done
    [ "$missing" ] || return 0
    skip "$name" "not here:$missing"
    finish
    exit
}

builds() {
    said=$(env -u MAKEFLAGS make -s B="$B" NVCC=none web 2>&1 | grep -v '^built without')
    [ -z "$said" ] || { echo "$said"; return 1; }
}

# asks FILE ARGUMENT...: the checks of tests/web/FILE.
asks() {
    file=$1
    shift
    node "tests/web/$file" "$package" "$work" "$modules" "$@" >"$work/asked" 2>&1 ||
        echo "FAIL $file: a check above, or it ended early" >>"$work/asked"
    cat "$work/asked"
    passed=$((passed + $(grep -c '^ok ' "$work/asked"))) failed=$((failed + $(grep -c '^FAIL ' "$work/asked")))
}
