#!/bin/sh
# vulkan_shaders.sh FOLDER: makes FOLDER/ENTRY.spv, the compute shaders in SPIR-V for Vulkan 1.1, from
# kernels/compute/generated/*.comp and kernels/vulkan/convert.comp, with glslangValidator and spirv-opt. The repository
# stores these files in kernels/vulkan/generated.
# vulkan_shaders.sh -c FILE...: prints SPIR-V files as C arrays for kernels/vulkan/vk_device.c. A 32-bit word is one to
# five bytes with 7 bits each, lowest bits first. Bit 7 is set in all of them but the last. This halves their size.
# vulkan_shaders.sh -w: prints port/window/panel_shaders.h, from port/window/panel.vert and panel.frag.
if [ "$1" = -c ]; then
    shift
    for file; do
        echo "static const uint8_t $(basename "$file" | tr . _)[] = {"
        od -An -v -tu1 "$file" | awk '{
            for (i = 1; i < NF; i += 4) {
                word = $i + 256 * ($(i + 1) + 256 * ($(i + 2) + 256 * $(i + 3)))
                for (; word > 127; word = int(word / 128))
                    printf "%d,", word % 128 + 128
                printf "%d,", word
            }
            print ""
        }'
        echo '};'
    done
    exit
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
if [ "$1" = -w ]; then
    echo '/* The shaders of panels in SPIR-V, by tools/scripts/vulkan_shaders.sh -w. */'
    for stage in vert frag; do
        glslangValidator -V --target-env vulkan1.1 -g0 -o "$work/first" "port/window/panel.$stage" >"$work/said" ||
            { cat "$work/said" >&2; exit 1; }
        spirv-opt -O --strip-debug "$work/first" -o "$work/panel.$stage" || exit 1
        echo "static const uint32_t panel_$stage[] = {"
        od -An -v -tx1 -w64 "$work/panel.$stage" | sed 's/ \(..\) \(..\) \(..\) \(..\)/0x\4\3\2\1, /g' |
            fold -s -w 108 | sed 's/ *$//; s/^0x/    &/'
        echo '};'
    done
    exit
fi
folder=${1:?folder}
{ echo '#version 310 es'; cat kernels/gl/depth.frag kernels/vulkan/convert.comp; } >"$work/convert.comp"
for file in kernels/compute/generated/*.comp; do
    # the uniform buffers are bindings 0 and 1 of the descriptor set, the storage buffers 2 to 5
    { echo '#version 310 es'; sed 1d "$file" | tr '\n' ' '; } |
        sed 's/layout(std140, *binding/layout(std140,set=0,binding/g
            s/layout(std430, *binding=3/layout(std430,set=0,binding=5/g
            s/layout(std430, *binding=2/layout(std430,set=0,binding=4/g
            s/layout(std430, *binding=1/layout(std430,set=0,binding=3/g
            s/layout(std430, *binding=0/layout(std430,set=0,binding=2/g' >"$work/${file##*/}"
done
for file in "$work"/*.comp; do
    name=$(basename "$file" .comp)
    glslangValidator -V --target-env vulkan1.1 -g0 -o "$work/$name.spv" "$file" >"$work/said" ||
        { cat "$work/said" >&2; exit 1; }
    spirv-opt -O --strip-debug --compact-ids "$work/$name.spv" -o "$folder/$name.spv" || exit 1
done
