#!/bin/sh
# fixsplat view --xr in the simulated headset of xr_runtime.c, with the validation layer of Vulkan: both eyes against
# render --stereo, Ctrl-C, calls that fail. test_openxr has the frame loop's other tests.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh

export FXS_XR_FRAMES=30 XR_RUNTIME_JSON="${fixsplat%/*}/tests/xr/runtime.json" VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation
"$fixsplat" make-scene knot --count 300 -o knot.ply >logs/out
run view --xr knot.ply
case $(cat logs/err) in
*'this build is without'* | *'no OpenXR: '*) skip "view --xr" "$(cat logs/err)"; finish; exit ;;
esac
if [ ! -e "$XR_RUNTIME_JSON" ]; then
    skip "view --xr" "the runtime of the tests needs the headers of OpenXR, Vulkan and OpenGL ES"
    finish
    exit
fi

# The simulated eyes lie 2 * 0.0315f apart and have a field of view of +-0.7f.
tangent=0.8422883600848511
wanted=$("$fixsplat" render knot.ply --eye 0,-2,-9 --look 0,-2,0 --size 48x56 --near 0.1 --hash \
    --stereo 0.06300000101327896 --tangents -$tangent,$tangent,$tangent,-$tangent)
for backend in vulkan gles-compute; do
    show() { rm -f log; FXS_XR_LOG=log run view --xr knot.ply --eye 0,-2,-9 --look 0,-2,0 --backend $backend "$@"; }
    show_still() { FXS_XR_STILL=1 show "$@"; }

    show_still
    check "$backend: the user takes the headset off" equal "$status" 0
    check "$backend: both eyes are those of render --stereo" equal "$(head -n 1 log)" "48x56 $wanted"
    check "$backend: 26 frames have layers, of at most 48x56" equal \
        "$(sed 's/x/ /' log | awk '$1 <= 48 && $2 <= 56 { n++ } END { print n, NR }')" "26 26"
    check "$backend: no word of the validation layer, two lines" equal "$(cat logs/out; wc -l <logs/err)" 2
    show_still --metres-per-unit 0.01
    check "$backend: another scale, other eyes" [ "$status" = 0 -a "$(head -n 1 log)" != "48x56 $wanted" ]
    show_still --pass-through
    check "$backend: the room shows" [ "$status" = 0 -a "$(head -n 1 log)" != "48x56 $wanted" ]
    FXS_XR_LACKS=alpha show_still --pass-through
    check "$backend: a headset that does not show the room" grep -q 'does not show the room' logs/err

    rm -f log
    FXS_XR_FRAMES=2000 FXS_XR_HERTZ=72 FXS_XR_LOG=log env --default-signal "$fixsplat" view --xr knot.ply --backend $backend >logs/out 2>logs/err &
    until [ -s log ] || ! kill -0 $! 2>/dev/null; do sleep 0.1; done
    kill -INT $!
    wait $!
    check "$backend: Ctrl-C ends the session" equal "$? $(tail -n 1 logs/err | tr -d '0-9')" \
        "0 fixsplat:  frames were shown"
    check "$backend: Ctrl-C ends the session at once" [ "$(wc -l <log)" -lt 1000 ]

    faults=
    for call in xrGetInstanceProperties xrGetSystem xrCreateSession xrCreateSwapchain:2 xrBeginSession xrWaitFrame:9 \
        xrReleaseSwapchainImage:5 xrEndFrame:9; do
        FXS_XR_FAIL=$call show_still
        grep -v 'Ctrl-C ends' logs/err >lines
        [ "$status" = 1 ] && [ "$(wc -l <lines)" = 1 ] && grep -q "^fixsplat: --xr: OpenXR: ${call%:*}: XR_ERROR" lines ||
            faults="$faults$call: $status $(cat lines) "
    done
    check "$backend: calls that fail: one line, status 1" equal "$faults" ''
    FXS_XR_FAIL=xrLocateViews:4 FXS_XR_RESULT=-17 FXS_XR_EVER=1 show_still
    check "$backend: the headset vanishes in mid-frame" equal "$status $(tail -n 1 logs/err)" \
        "1 fixsplat: --xr: OpenXR: xrLocateViews: the session was lost"
done

# OpenXR's loader leaks a block of xrCreateInstance.
printf '{\n loader\n Memcheck:Leak\n ...\n obj:*/libopenxr_loader.so*\n}\n' >loader.supp
if have valgrind; then
    for call in xrGetSystem xrCreateVulkanInstanceKHR; do
        FXS_XR_FAIL=$call valgrind -q --suppressions=loader.supp --leak-check=full --errors-for-leak-kinds=definite --error-exitcode=9 "$fixsplat" \
            view --xr knot.ply >logs/out 2>logs/err
        check "valgrind: $call fails" equal "$? $(grep -c . logs/err)" "1 1"
    done
else
    skip "valgrind" "it is not here"
fi

FXS_XR_LACKS=egl run view --xr knot.ply --backend gles-compute
check "a runtime without OpenGL ES" equal "$status $(cat logs/err)" \
    "1 fixsplat: --xr: the OpenXR runtime has no XR_MNDX_egl_enable"
check "the program of docs/openxr.md" "${fixsplat%/*}/tests/xr/example" knot.ply
run view --xr
check "no scene" equal "$status" 2
XR_RUNTIME_JSON=/nowhere.json run view --xr knot.ply
check "no runtime" equal "$status $(cat logs/err)" "1 fixsplat: --xr: OpenXR: xrEnumerateInstanceExtensionProperties: \
no OpenXR runtime is running; XR_RUNTIME_JSON names one"
for wrong in '--size 64x64' '--fps 72' --web '--cpu c' '--backend cpu' '--metres-per-unit 0'; do
    run view --xr knot.ply $wrong
    check "wrong: --xr $wrong" [ "$status" = 2 -a "$(wc -l <logs/err)" = 1 ]
done
run view knot.ply --pass-through
check "wrong: --pass-through alone" [ "$status" = 2 -a "$(wc -l <logs/err)" = 1 ]
finish
