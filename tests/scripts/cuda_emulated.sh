#!/bin/sh
# The CUDA back end without a GPU: its kernels compiled as C++ and run thread by thread, compared with the processor.
. tests/scripts/lib/check.sh
program=${B:-build}/tests/gpu/emulated_cuda
if [ -x "$program" ]; then
    log=$(mktemp) || exit 1
    trap 'rm -f "$log"' EXIT
    "$program" --quick >"$log" 2>&1 || fail "$program" "status $?"
    grep -v '^  skipped\|^skip test_files\|passed, ' "$log"
    passed=$(grep -c '^ok ' "$log") failed=$((failed + $(grep -c '^FAIL ' "$log")))
    # Except test_levels, which needs a GPU, and test_files, which needs files.
    check "all tests ran" equal "$((passed + failed))" "$(($(grep -c '^ *RUN(test_' tests/gpu/test_cuda.c) - 2))"
else
    skip "emulated" "no ${CXX:-c++} here"
fi
finish
