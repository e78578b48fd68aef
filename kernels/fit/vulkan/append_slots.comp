// Appends each slot to its tile's list, in any order: the sort orders them.
#include "splats.glsl"
layout(local_size_x = 256) in;

void main()
{
    const uint total = gaussians[order.at_bases + order.count];
    if (status.is_full != 0u)
        return;
    for (uint slot = gl_GlobalInvocationID.x; slot < total; slot += gl_NumWorkGroups.x * 256u) {
        const uint place = atomicAdd(pixels[order.at_next + slots[order.at_tiles + slot]], 1u);
        slots[order.at_keys + 2u * place] = gaussians[splat_at(slots[order.at_splat_of + slot]) + SPLAT_DEPTH];
        slots[order.at_keys + 2u * place + 1u] = slot;
    }
}
