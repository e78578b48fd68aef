#!/bin/sh
# Fits with --backend vulkan: the same files as on the processor, resumed across both, with the validation layer; then
# with calls of Vulkan that fail (failing_layer.c), and on a device whose shaders do not run.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"
. "$root/tests/scripts/lib/failing_calls.sh"

reason=$("$fixsplat" info --backends | sed -n "s/^vulkan  *not here: //p")
if [ "$reason" ]; then
    skip "fits through Vulkan" "$reason"
    finish
    exit
fi
layers=VK_LAYER_FIXSPLAT_failing:VK_LAYER_KHRONOS_validation
make_photographs 9

# same NAME OPTION...: fits on the processor and through Vulkan, with the layers.
same() {
    name=$1
    shift
    "$fixsplat" fit set -o cpu.ply --quiet "$@" >/dev/null || return 1
    VK_INSTANCE_LAYERS=$layers run fit set -o gpu.ply --quiet --backend vulkan "$@"
    check "$name: the file of the processor" cmp cpu.ply gpu.ply
    check "$name: nothing to say" equal "$status $(cat logs/err)" "0 "
}

same "fast" --steps 40 --recipe fast --max-gaussians 1000
same "reference, which grows" --steps 602 --recipe reference --sh 1
same "antialiased, surfaces" --steps 24 --antialiased --surfaces
same "exposures, poses, batches" --steps 24 --batch 2 --exposure affine --refine-poses
export LP_NATIVE_VECTOR_WIDTH=512      # llvmpipe: subgroups of 16 threads, as many as a block of pixels has
same "large subgroups" --steps 24 --antialiased --surfaces
unset LP_NATIVE_VECTOR_WIDTH

"$fixsplat" fit set -o begun.fit --quiet --steps 12 >/dev/null
run fit set -o rest.ply --quiet --resume begun.fit --steps 30 --backend vulkan
"$fixsplat" fit set -o same.ply --quiet --resume begun.fit --steps 30 >/dev/null
check "begun on the processor" cmp rest.ply same.ply
"$fixsplat" fit set -o begun2.fit --quiet --steps 12 --backend vulkan >/dev/null
check "saved through Vulkan" cmp begun.fit begun2.fit

attempt() {
    rm -f o.ply
    VK_INSTANCE_LAYERS=VK_LAYER_FIXSPLAT_failing run fit set -o o.ply --quiet --steps 3 --backend vulkan
}

# wrong: prints what the command did wrong; nothing if all was right.
wrong() {
    case $status in
    0) [ ! -s logs/err ] || cat logs/err ;;
    1) grep -v '^fixsplat: ' logs/err
        [ "$(wc -l <logs/err)" -le 2 ] || cat logs/err         # the second is about a save for later
        [ ! -e o.ply ] || cmp o.ply right.ply ;;
    *) echo "status $status: $(cat logs/err)" ;;
    esac
}

FXS_FAIL_LOG=logs/calls attempt
cp o.ply right.ply
count=$(cat logs/calls)
check "the layer counts calls" [ "${count:-0}" -gt 100 ]
fail_calls 3 "${EVERY:-$((count / 8))}" -2 '-4 and on'

if "$fixsplat" info --backends | grep -q '^vulkan .*llvmpipe'; then
    cp -r set many
    awk 'BEGIN {
        for (i = 0; i < 2000; i++)
            print 1000 + i, i % 70 / 20 - 1.7, i % 71 / 20 - 1.7, i / 600 - 1.7, 120, 120, 120, 0
    }' >>many/sparse/0/points3D.txt
    fails "llvmpipe's loops are too short for many Gaussians" 1 'llvmpipe.* fits at most 1023 Gaussians' \
        fit many -o o.ply --quiet --steps 3 --backend vulkan
else
    skip "more Gaussians than llvmpipe takes" "not here: llvmpipe"
fi

FXS_FAIL_SHADERS=1 attempt
check "a device that computes otherwise is refused" equal "$status $(ls o.ply 2>/dev/null)" "1 "
check "by its name" grep -q '^fixsplat: .*llvmpipe.* does not round as IEEE 754 asks' logs/err
run fit set -o o.ply --steps 3 --backend vulkan --device 99
check "no such device" equal "$status $(grep -c 'there is no device 99' logs/err)" "1 1"
run fit set -o o.ply --steps 3 --backend vulkan --max-memory 64K
check "too little memory" equal "$status $(grep -c 'memory' logs/err)" "1 1"
finish
