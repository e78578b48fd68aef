// A workgroup processes a tile of 16x16 pixels; 16 threads a block of 4x4 pixels, a thread one pixel. A batch of splats
// is in the memory of the workgroup: SPLATS, a multiple of 32.
shared vec4 shapes[SPLATS];        // ux, uy, vy, offset
shared vec4 colours[SPLATS];       // limit, red, green, blue
shared vec2 centres[SPLATS];
shared uint words[16][SPLATS / 32];    // for each block, a bit set of the splats that may touch it

uint thread() { return gl_LocalInvocationIndex; }
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

void keep_splat(uint place, uint gaussian)
{
    centres[place] = vec2(splat_number(gaussian, 0u), splat_number(gaussian, 1u));
    shapes[place] = vec4(splat_number(gaussian, 2u), splat_number(gaussian, 3u), splat_number(gaussian, 4u),
                         splat_number(gaussian, 5u));
    colours[place] = vec4(splat_number(gaussian, 6u), splat_number(gaussian, 7u), splat_number(gaussian, 8u),
                          splat_number(gaussian, 9u));
}

// A splat's coordinates u and v at the first pixel of a block.
vec2 corner_of(uint place, int b, ivec2 tile)
{
    const float x = (float(b % 4 * 4) + (float(tile.x) + 0.5)) - centres[place].x;
    const float y = (float(b / 4 * 4) + (float(tile.y) + 0.5)) - centres[place].y;
    return vec2(x * shapes[place].x + y * shapes[place].y, y * shapes[place].z);
}

// The level of a splat at a pixel of a block, where alpha is 2^-level; u and v there.
float level_at(uint place, vec2 corner, int p, out float u, out float v)
{
    const vec4 s = shapes[place];
    const float along = float(p % 4), down = float(p / 4);
    u = (along * s.x + down * s.y) + corner.x;
    v = down * s.z + corner.y;
    return (u * u + v * v) + s.w;
}

void clear_words()
{
    for (uint i = thread(); i < 16u * SPLATS / 32u; i += 256u)
        words[i / (SPLATS / 32u)][i % (SPLATS / 32u)] = 0u;
}

void put_bits(uint place, uint blocks)
{
    for (uint rest = blocks; rest != 0u; rest &= rest - 1u)
        atomicOr(words[findLSB(rest)][place / 32u], 1u << place % 32u);
}
