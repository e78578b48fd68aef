// Sorts the list of each tile by depth, then by slot: a bitonic sort whose comparisons all go up, so that a list of any
// length can be sorted. Blocks of 2048 keys are sorted in the memory of the workgroup, longer lists in the buffer.
#define QUALIFIER coherent
layout(local_size_x = 256) in;

const uint ROOM = 2048u;
shared uvec2 keys[ROOM];

bool is_before(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// The pair of comparison i: in a flip, k keys are compared with their mirror images; else with those `apart` further.
uvec2 pair_of(uint i, uint apart, bool is_flip)
{
    const uint first = i / apart * 2u * apart, at = i % apart;
    return uvec2(first + at, is_flip ? first + 2u * apart - 1u - at : first + at + apart);
}

uint pairs_of(uint count, uint apart) { return (count + 2u * apart - 1u) / (2u * apart) * apart; }

void compare_here(uint count, uint apart, bool is_flip)
{
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < pairs_of(count, apart); i += 256u) {
        const uvec2 p = pair_of(i, apart, is_flip);
        if (p.y < count && is_before(keys[p.y], keys[p.x])) {
            const uvec2 other = keys[p.x];
            keys[p.x] = keys[p.y];
            keys[p.y] = other;
        }
    }
}

uvec2 key_at(uint at) { return uvec2(slots[order.at_keys + 2u * at], slots[order.at_keys + 2u * at + 1u]); }

void put_key(uint at, uvec2 key)
{
    slots[order.at_keys + 2u * at] = key.x;
    slots[order.at_keys + 2u * at + 1u] = key.y;
}

void compare_far(uint start, uint count, uint apart, bool is_flip)
{
    memoryBarrierBuffer();
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < pairs_of(count, apart); i += 256u) {
        const uvec2 p = pair_of(i, apart, is_flip);
        if (p.y >= count)
            continue;
        const uvec2 a = key_at(start + p.x), b = key_at(start + p.y);
        if (is_before(b, a)) {
            put_key(start + p.x, b);
            put_key(start + p.y, a);
        }
    }
}

// Sorts blocks of keys in the workgroup's memory: all of it, or the last comparisons after those of the whole list.
void sort_blocks(uint start, uint count, bool is_first)
{
    for (uint first = 0u; first < count; first += ROOM) {
        const uint some = min(count - first, ROOM);
        memoryBarrierBuffer();
        barrier();
        for (uint i = gl_LocalInvocationIndex; i < some; i += 256u)
            keys[i] = key_at(start + first + i);
        for (uint apart = 1u; is_first && apart < some; apart *= 2u) {
            compare_here(some, apart, true);
            for (uint less = apart / 2u; less > 0u; less /= 2u)
                compare_here(some, less, false);
        }
        for (uint less = ROOM / 2u; !is_first && less > 0u; less /= 2u)
            compare_here(some, less, false);
        barrier();
        for (uint i = gl_LocalInvocationIndex; i < some; i += 256u)
            put_key(start + first + i, keys[i]);
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint start = pixels[order.at_starts + tile], count = pixels[order.at_starts + tile + 1u] - start;
    sort_blocks(start, count, true);
    for (uint apart = ROOM; apart < count; apart *= 2u) {
        compare_far(start, count, apart, true);
        for (uint less = apart / 2u; less >= ROOM; less /= 2u)
            compare_far(start, count, less, false);
        sort_blocks(start, count, false);
    }
    memoryBarrierBuffer();
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < count; i += 256u) {
        const uint slot = key_at(start + i).y;
        slots[order.at_slots + start + i] = slot;
        slots[order.at_list + start + i] = slots[order.at_splat_of + slot];
    }
}
