#!/bin/sh
# Runs the CUDA tests without a GPU: the kernels are compiled as C++ and run thread by thread.
. tests/scripts/lib/check.sh
program=${B:-build}/tests/gpu/emulated_cuda
if [ -x "$program" ]; then
    log=$(mktemp) || exit 1
    trap 'rm -f "$log"' EXIT
    "$program" --quick >"$log" 2>&1 || fail "$program" "status $?"
    grep -v '^  skipped\|^skip test_files\|passed, ' "$log"
    passed=$(grep -c '^ok ' "$log") failed=$((failed + $(grep -c '^FAIL ' "$log")))
    check "all tests ran" equal "$((passed + failed))" "$(($(grep -c '^ *RUN(test_' tests/gpu/test_cuda.c) - 2))"
else
    skip "emulated" "no ${CXX:-c++} here"
fi
finish
