// Replaces the sums of the parts by the sums over the parts before, in one workgroup. Notes the number of slots, and
// whether they fit.
#include "scan.glsl"
layout(local_size_x = 256) in;

void main()
{
    const uint parts = (order.count + 2048u) / 2048u;
    uint total = 0u, all_threads;
    if (status.is_full != 0u)
        return;
    for (uint first = 0u; first < parts; first += 256u) {
        const uint part = first + gl_LocalInvocationIndex;
        const uint before = sum_before(part < parts ? gaussians[order.at_parts + part] : 0u, all_threads);
        if (part < parts)
            gaussians[order.at_parts + part] = added(total, before);
        total = added(total, all_threads);
    }
    if (gl_LocalInvocationIndex != 0u)
        return;
    status.entries += total;
    status.entries_most = max(status.entries_most, total);
    status.slot_groups[0] = min((min(total, order.capacity) + 255u) / 256u, 65535u);
    status.slot_groups[1] = status.slot_groups[2] = 1u;
    if (total > order.capacity)
        status.is_full = 1u;
}
