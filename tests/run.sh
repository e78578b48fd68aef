#!/bin/sh
# Runs every test program, gate and script, and adds up their results. Each prints "N passed, N failed, N skipped" last, or, for a gate, "ok",
# "FAIL" or "skip" and a name. B: the build folder.
passed=0 failed=0 skipped=0
log=$B/tests/log
mkdir -p "$B/tests"

count() {
    tail -n 1 "$log" | grep -Eq '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' || {
        echo "FAIL $1: ended early (status $2)"
        failed=$((failed + 1))
        return
    }
    set -- $(tail -n 1 "$log" | tr -dc '0-9 ')
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

for program in "$B"/tests/test_*; do
    case $program in *.o | *.d) continue ;; esac
    echo "== ${program##*/}"
    "$program" >"$log" 2>&1
    status=$?
    cat "$log"
    count "${program##*/}" $status
done
for script in tests/scripts/*.sh; do
    echo "== ${script##*/}"
    sh "$script" >"$log" 2>&1
    status=$?
    cat "$log"
    count "${script##*/}" $status
done
for gate in tests/gates/*.sh; do
    sh "$gate"
    case $? in
    0) passed=$((passed + 1)) ;;
    77) skipped=$((skipped + 1)) ;;
    *) failed=$((failed + 1)) ;;
    esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
