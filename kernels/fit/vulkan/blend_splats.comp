// Blends the splats of each tile, from near to far, and notes the blocks of 4x4 pixels that each changes.
#include "splats.glsl"
#define SPLATS 128
#include "tile.glsl"
layout(local_size_x = 256) in;

shared uint taken[SPLATS];
shared uint needed_here, is_open;

// The bit set of the blocks that a splat's ellipse may touch (find_blocks of src/fit/stages/tile.h).
uint find_blocks(uint place, uint gaussian, ivec2 tile)
{
    const vec4 s = shapes[place];
    const float across = 3.0 * s.x, slant = 3.0 * s.y, down = 3.0 * s.z;
    const float limit = (colours[place].x - s.w) * FXS_FIT_WIDER;
    const float less = slant < 0.0 ? slant : 0.0, far_side = across + (slant > 0.0 ? slant : 0.0);
    uint blocks = 0u;
    for (int b = 0; b < FXS_FIT_BLOCKS; b++) {
        const vec2 corner = corner_of(place, b, tile);
        const float u = most(most(corner.x + less, -corner.x - far_side), 0.0);
        const float v = most(most(corner.y, -corner.y - down), 0.0);
        blocks |= uint(u * u + v * v <= limit) << b;
    }
    return splat_number(gaussian, 11u) < 0.0 ? 0xffffu : blocks;
}

void blend_word(uint word, inout vec4 pixel)
{
    const uint own = 1u << block_of_thread();
    for (uint bits = words[block_of_thread()][word]; bits != 0u && FXS_FIT_CLOSED <= pixel.w; bits &= bits - 1u) {
        const uint place = 32u * word + uint(findLSB(bits));
        const vec4 colour = colours[place];
        float u, v;
        const vec2 corner = corner_of(place, int(block_of_thread()), tile_corner());
        const float level = level_at(place, corner, int(lane()), u, v);
        const int takes = takes_of(level, colour.x, pixel.w);
        const float weight = weight_of(takes, level, pixel.w);
        pixel = vec4(pixel.x + weight * colour.y, pixel.y + weight * colour.z, pixel.z + weight * colour.w,
                     pixel.w - weight);
        if (takes != 0 && (taken[place] & own) == 0u)
            atomicOr(taken[place], own);
    }
}

bool any_open(float transmittance)
{
    barrier();
    if (thread() == 0u)
        is_open = 0u;
    barrier();
    if (FXS_FIT_CLOSED <= transmittance)
        is_open = 1u;
    barrier();
    return is_open != 0u;
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
        needed_here = 0u;
    for (uint first = 0u; first < count && any_open(pixel.w); first += SPLATS) {
        const uint entry = first + thread();
        const bool is_entry = thread() < SPLATS && entry < count;
        clear_words();
        if (thread() < SPLATS)
            taken[thread()] = 0u;
        barrier();
        if (is_entry) {
            const uint gaussian = slots[order.at_list + start + entry];
            keep_splat(thread(), gaussian);
            put_bits(thread(), find_blocks(thread(), gaussian, tile_corner()));
        }
        barrier();
        for (uint word = 0u; word < SPLATS / 32u; word++)
            blend_word(word, pixel);
        barrier();
        if (is_entry)
            slots[order.at_blocks + start + entry] = taken[thread()];
        if (is_entry && taken[thread()] != 0u)
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
