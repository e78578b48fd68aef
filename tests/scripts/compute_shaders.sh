#!/bin/sh
# Checks that the GLSL shaders in kernels/compute/generated match their WGSL sources, that the SPIR-V in
# kernels/vulkan/generated, in kernels/fit/vulkan/generated and of the window's panels matches its GLSL, and that the
# WGSL compiles in Chromium.
. tests/scripts/lib/check.sh
B=${B:-build}
modules=${NODE_MODULES:-$B/page/node_modules}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

same_text() {
    for file in "$work"/*.comp kernels/compute/generated/*.comp; do
        cmp -s "$work/${file##*/}" "kernels/compute/generated/${file##*/}" ||
            { echo "${file##*/} is old: node tools/scripts/compute_shaders.mjs $B/page kernels/compute/generated"; return 1; }
    done
}

# same_spirv MADE STORED COMMAND
same_spirv() {
    for file in "$1"/*.spv "$2"/*.spv; do
        cmp -s "$1/${file##*/}" "$2/${file##*/}" || { echo "${file##*/} is old: $3 $2"; return 1; }
        spirv-val --target-env vulkan1.1 "$file" || return 1
    done
}

same_panels() {
    sh tools/scripts/vulkan_shaders.sh -w | cmp -s - port/window/panel_shaders.h ||
        { echo "it is old: sh tools/scripts/vulkan_shaders.sh -w >port/window/panel_shaders.h"; return 1; }
}

if have glslangValidator && have spirv-opt; then
    check "the SPIR-V is made" sh tools/scripts/vulkan_shaders.sh "$work"
    check "kernels/vulkan/generated has it" same_spirv "$work" kernels/vulkan/generated \
        "sh tools/scripts/vulkan_shaders.sh"
    check "panel_shaders.h has that of the panels" same_panels
else
    skip "SPIR-V" "not here: glslangValidator or spirv-opt (make setup test)"
fi
if have node && have glslangValidator && have spirv-opt; then
    mkdir "$work/fit"
    check "the SPIR-V of a fit is made" node tools/scripts/fit_shaders.mjs "$work/fit"
    check "kernels/fit/vulkan/generated has it" same_spirv "$work/fit" kernels/fit/vulkan/generated \
        "node tools/scripts/fit_shaders.mjs"
else
    skip "SPIR-V of a fit" "not here: node, glslangValidator or spirv-opt (make setup test)"
fi
if ! have node || [ ! -d "$modules/naga-wasm" ]; then
    skip "compute shaders" "not here: node or naga-wasm (make setup test)"
    finish
    exit
fi
check "the shaders are made" node tools/scripts/compute_shaders.mjs "${modules%/node_modules}" "$work"
check "kernels/compute/generated has them" same_text
if have chromium && [ -d "$modules/puppeteer-core" ]; then
    check "WebGPU compiles their WGSL" node tests/web/wgsl.mjs "$work" "$modules"
else
    skip "WebGPU compiles their WGSL" "not here: chromium or puppeteer-core (make setup test)"
fi
finish
