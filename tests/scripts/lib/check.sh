# Sourced by the test scripts. Prints one line for each check, and the totals at the end.
passed=0 failed=0 skipped=0

ok() { echo "ok $1"; passed=$((passed + 1)); }
fail() { echo "FAIL $1: $2"; failed=$((failed + 1)); }
skip() { echo "skip $1: $2"; skipped=$((skipped + 1)); }

# check NAME COMMAND...: the command must succeed. Its output is shown on failure.
check() {
    name=$1
    shift
    if why=$("$@" 2>&1); then ok "$name"; else fail "$name" "${why:-not so: $*}"; fi
}

equal() { [ "$1" = "$2" ] || { echo "$1 is not $2"; return 1; }; }
have() { command -v "$1" >/dev/null 2>&1; }

finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" = 0 ]
}
