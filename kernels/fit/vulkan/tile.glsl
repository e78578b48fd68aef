// A workgroup processes a tile of 16x16 pixels; 16 threads a block of 4x4 pixels, a thread one pixel. A batch of splats
// is in the memory of the workgroup: SPLATS, a multiple of 32.
shared vec4 shapes[SPLATS];        // ux, uy, vy, offset
shared vec4 colours[SPLATS];       // limit, red, green, blue
shared vec2 centres[SPLATS];
shared uint words[16][SPLATS / 32];    // for each block, a bit set of the splats that may touch it

// Splats, four words each, as the buffer `gaussians`, which the shaders of tiles only read.
layout(std430, set = 0, binding = 4) restrict readonly buffer splats_buffer { uvec4 fours[]; };

// Threads of a subgroup, if subgroups hold whole blocks: 16, 32 or 64; else 0. Ballots need words of 32 splats.
layout(constant_id = 1) const uint SUBGROUP = 0u;
const bool HAS_BALLOTS = SUBGROUP >= 32u;

uint thread()
{
    return SUBGROUP > 0u ? gl_SubgroupID * SUBGROUP + gl_SubgroupInvocationID : gl_LocalInvocationIndex;
}

uint block_of_thread() { return thread() / 16u; }
uint lane() { return thread() % 16u; }
uint tile_of_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint list_start() { return pixels[order.at_starts + tile_of_group()]; }
uint list_count() { return pixels[order.at_starts + tile_of_group() + 1u] - list_start(); }
ivec2 tile_corner() { return ivec2(gl_WorkGroupID.xy) * FXS_FIT_TILE; }
uint picture_size() { return uint(order.cameras[view].width * order.cameras[view].height); }

ivec2 place_in_tile()
{
    const int b = int(block_of_thread()), p = int(lane());
    return ivec2(b % 4 * 4 + p % 4, b / 4 * 4 + p / 4);
}

bool is_inside(ivec2 at) { return at.x < order.cameras[view].width && at.y < order.cameras[view].height; }
uint pixel_at(ivec2 at) { return uint(at.y * order.cameras[view].width + at.x); }

// Waits for the threads of a block; all threads of a workgroup must call it.
void meet_block()
{
    if (SUBGROUP > 0u) {
        subgroupMemoryBarrierShared();
        subgroupBarrier();
    } else {
        barrier();
    }
}

// Keeps a splat in place `place`. Returns true if a square selects its tiles, instead of its ellipse.
bool keep_splat(uint place, uint gaussian)
{
    const uint at = splat_at(gaussian) / 4u;
    const vec4 a = uintBitsToFloat(fours[at]), b = uintBitsToFloat(fours[at + 1u]), c = uintBitsToFloat(fours[at + 2u]);
    centres[place] = a.xy;
    shapes[place] = vec4(a.zw, b.xy);
    colours[place] = vec4(b.zw, c.xy);
    return c.w < 0.0;
}

// A splat's coordinates u and v at the first pixel of a block.
vec2 corner_of(vec2 centre, vec4 form, int b, ivec2 tile)
{
    const float x = (float(b % 4 * 4) + (float(tile.x) + 0.5)) - centre.x;
    const float y = (float(b / 4 * 4) + (float(tile.y) + 0.5)) - centre.y;
    return vec2(x * form.x + y * form.y, y * form.z);
}

// The level of a splat at a pixel of a block, where alpha is 2^-level; u and v there.
float level_at(vec4 form, vec2 corner, int p, out float u, out float v)
{
    const float along = float(p % 4), down = float(p / 4);
    u = (along * form.x + down * form.y) + corner.x;
    v = down * form.z + corner.y;
    return (u * u + v * v) + form.w;
}

void clear_words()
{
    for (uint i = thread(); !HAS_BALLOTS && i < 16u * SPLATS / 32u; i += 256u)
        words[i / (SPLATS / 32u)][i % (SPLATS / 32u)] = 0u;
}

// Turns the bit set of blocks of this thread's splat into a bit in the word of each block. All threads must call it.
void put_bits(uint blocks)
{
    const uint own_word = thread() / 32u, own_lane = thread() % 32u;
    if (!HAS_BALLOTS) {
        for (uint rest = blocks; rest != 0u; rest &= rest - 1u)
            atomicOr(words[findLSB(rest)][own_word], 1u << own_lane);
        return;
    }
    uint own = 0u;
    for (uint b = 0u; b < 16u; b++) {
        const uvec4 all = subgroupBallot((blocks >> b & 1u) != 0u);
        own = own_lane == b ? (gl_SubgroupInvocationID < 32u ? all.x : all.y) : own;
    }
    if (own_lane < 16u && own_word < SPLATS / 32u)
        words[own_lane][own_word] = own;
}
