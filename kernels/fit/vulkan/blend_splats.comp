// Blends the splats of each tile, from near to far, and notes the blocks of 4x4 pixels that each changes.
#include "splats.glsl"
const uint SPLATS = 256u;
#include "tile.glsl"
layout(local_size_x = 256) in;

shared uint taken[16][SPLATS / 32];    // for each block, a bit set of the splats that change a pixel of it
shared uint needed_here, is_open[2];   // is_open: of this batch and of the next, whether a pixel is

// The bit set of the blocks that a splat's ellipse may touch (find_blocks of src/fit/stages/tile.h).
uint find_blocks(vec2 centre, vec4 s, float limit_of_level, ivec2 tile)
{
    const float across = 3.0 * s.x, slant = 3.0 * s.y, down = 3.0 * s.z;
    const float limit = (limit_of_level - s.w) * FXS_FIT_WIDER;
    const float less = slant < 0.0 ? slant : 0.0, far_side = across + (slant > 0.0 ? slant : 0.0);
    uint blocks = 0u;
    for (int b = 0; b < FXS_FIT_BLOCKS; b++) {
        const vec2 corner = corner_of(centre, s, b, tile);
        const float u = most(most(corner.x + less, -corner.x - far_side), 0.0);
        const float v = most(most(corner.y, -corner.y - down), 0.0);
        blocks |= uint(u * u + v * v <= limit) << b;
    }
    return blocks;
}

void blend_word(uint word, inout vec4 pixel)
{
    uint took = 0u;
    for (uint bits = words[block_of_thread()][word]; bits != 0u && FXS_FIT_CLOSED <= pixel.w; bits &= bits - 1u) {
        const uint bit = uint(findLSB(bits)), place = 32u * word + bit;
        const vec4 colour = colours[place], form = shapes[place];
        float u, v;
        const vec2 corner = corner_of(centres[place], form, int(block_of_thread()), tile_corner());
        const float level = level_at(form, corner, int(lane()), u, v);
        const int takes = takes_of(level, colour.x, pixel.w);
        const float weight = weight_of(takes, level, pixel.w);
        pixel = vec4(pixel.x + weight * colour.y, pixel.y + weight * colour.z, pixel.z + weight * colour.w,
                     pixel.w - weight);
        took |= takes != 0 ? 1u << bit : 0u;
    }
    if (took != 0u)
        atomicOr(taken[block_of_thread()][word], took);
}

// The bit set of the blocks that a splat changes.
uint blocks_of(uint place)
{
    uint blocks = 0u;
    for (uint b = 0u; b < 16u; b++)
        blocks |= (taken[b][place / 32u] >> place % 32u & 1u) << b;
    return blocks;
}

// Keeps the splat of an entry of the list, and notes the blocks that it may touch.
void keep_entry(uint entry, bool is_entry)
{
    uint blocks = 0u;
    for (uint i = thread(); i < 16u * SPLATS / 32u; i += 256u)
        taken[i / (SPLATS / 32u)][i % (SPLATS / 32u)] = 0u;
    if (is_entry) {
        const uint place = thread();
        const bool is_square = keep_splat(place, slots[order.at_list + entry]);
        blocks = is_square ? 0xffffu : find_blocks(centres[place], shapes[place], colours[place].x, tile_corner());
    }
    put_bits(blocks);
}

// Writes the numbers of a depth map, in place of the derivatives of SSIM.
void put_depth(vec4 pixel, ivec2 at)
{
    float numbers[4];
    depth_numbers(order.cameras[view], float(at.x), float(at.y), float[3](pixel.x, pixel.y, pixel.z), pixel.w, numbers);
    for (uint k = 0u; k < 4u; k++)
        pixels[order.at_derivatives + k * picture_size() + pixel_at(at)] = floatBitsToUint(numbers[k]);
}

void put_pixel(vec4 pixel, ivec2 at)
{
    float colour[3];
    for (int c = 0; c < 3; c++)
        colour[c] = pixel[c] + pixel.w * order.background[c];
    for (int c = 0; c < 3; c++) {
        const float own = order.has_exposure != 0 ? exposed(order.photographs[view].factors, colour, c) : colour[c];
        pixels[order.at_picture + uint(c) * picture_size() + pixel_at(at)] = floatBitsToUint(own);
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint start = list_start(), count = list_count();
    vec4 pixel = vec4(0.0, 0.0, 0.0, 1.0);
    if (thread() == 0u)
        needed_here = is_open[0] = is_open[1] = 0u;
    barrier();
    for (uint first = 0u, batch = 0u; first < count; first += SPLATS, batch ^= 1u) {
        const uint entry = first + thread();
        clear_words();
        if (FXS_FIT_CLOSED <= pixel.w)
            is_open[batch] = 1u;
        barrier();
        if (is_open[batch] == 0u)
            break;
        keep_entry(start + entry, entry < count);
        if (thread() == 0u)
            is_open[batch ^ 1u] = 0u;
        barrier();
        for (uint word = 0u; word < SPLATS / 32u; word++)
            blend_word(word, pixel);
        barrier();
        const uint blocks = entry < count ? blocks_of(thread()) : 0u;
        if (entry < count)
            slots[order.at_blocks + start + entry] = blocks;
        if (blocks != 0u)
            atomicMax(needed_here, entry + 1u);
    }
    barrier();
    if (thread() == 0u)
        pixels[order.at_needed + tile_of_group()] = needed_here;
    const ivec2 at = tile_corner() + place_in_tile();
    if (is_inside(at) && is_surface != 0u)
        put_depth(pixel, at);
    else if (is_inside(at))
        put_pixel(pixel, at);
}
