# Sourced by scripts that run the command with calls of Vulkan that fail, by the layer failing_layer.c. They define
# `attempt`, which runs the command with the layer, and `wrong`, which prints what it did wrong.
export VK_LAYER_PATH="${fixsplat%/*}/tests/layer:/usr/share/vulkan/explicit_layer.d"

# fail_calls FIRST EVERY RESULT...: for each result, fails call FIRST and each EVERY-th call after it; "RESULT and on"
# fails all later calls too.
fail_calls() {
    from=$1 every=$2
    shift 2
    for result; do
        n=$from failures=0 faults=
        export FXS_FAIL_WITH=${result% and on}
        [ "$FXS_FAIL_WITH" = "$result" ] || export FXS_FAIL_EVER=1
        while [ $n -lt "$count" ]; do
            FXS_FAIL_AT=$n attempt
            failures=$((failures + status))
            why=$(wrong 2>&1)
            faults=$faults${why:+call $n: $why }
            n=$((n + every))
        done
        check "result $result" equal "$faults" ''
        check "result $result is an error" [ $failures -ge $((count / every / 2)) ]
        unset FXS_FAIL_WITH FXS_FAIL_EVER
    done
}
