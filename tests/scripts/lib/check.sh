# Sourced by the test scripts. Prints one line for each check, and the totals at the end.
passed=0 failed=0 skipped=0

# A cache folder of the tests, for the trial of --backend auto. ccache keeps its own.
user_cache=${XDG_CACHE_HOME:-$HOME/.cache}
export WEB_SOURCES="${WEB_SOURCES-$user_cache/fixsplat}" WINDOWS_LIBRARIES="${WINDOWS_LIBRARIES-$user_cache/fixsplat/windows}"
[ ! -d "$user_cache/ccache" ] || export CCACHE_DIR="${CCACHE_DIR:-$user_cache/ccache}"
case ${B:-build} in /*) XDG_CACHE_HOME=$B/tests/cache ;; *) XDG_CACHE_HOME=$PWD/${B:-build}/tests/cache ;; esac
export XDG_CACHE_HOME

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
