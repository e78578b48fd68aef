// Sums the gradients of each splat of a tile over the pixels that it changes, in the order of src/fit/stages/tile.h.
// Each block of 4x4 pixels takes 8 of its splats at a time: first a thread is a pixel, and passes the splats from near
// to far; then two threads sum a splat over the block's pixels.
#include "splats.glsl"
layout(constant_id = 2) const uint SPLATS = 64u;
layout(constant_id = 3) const uint PAIRS = 192u;   // pairs of a splat and a block that fit; at least 12 splats
#include "tile.glsl"
layout(local_size_x = 256) in;

const uint GROUP = 8u, ROW = 17u;          // ROW: 16 pixels, and one place so that rows begin in different banks
shared vec2 staged[16][GROUP][ROW];        // of a block, a splat and a pixel: h and the blending weight
shared uint lists[16][GROUP], counts[16];  // counts: splats of each block
shared uint blocks_of[SPLATS], pairs[SPLATS], slot_of[SPLATS], eights[SPLATS / 8];
shared float gradient[3][256];
shared float pair_sums[PAIRS][FXS_FIT_SUMS];
shared uint here;

passed_pixel begin_pixel()
{
    const ivec2 at = tile_corner() + place_in_tile();
    const bool has_exposure = order.has_exposure != 0 && is_surface == 0u;
    const float factors[FXS_FIT_GAIN] = order.photographs[view].factors;
    passed_pixel pixel = passed_pixel(1.0, 0.0);
    float found[3] = float[3](0.0, 0.0, 0.0);
    for (int c = 0; c < 3 && is_inside(at); c++) {
        const uint own = uint(c) * picture_size() + pixel_at(at);
        found[c] = uintBitsToFloat(pixels[order.at_gradient + own]);
        pixel.behind += found[c] * (uintBitsToFloat(pixels[order.at_picture + own]) -
                                    (has_exposure ? factors[9 + c] : 0.0));
    }
    for (int c = 0; c < 3; c++)
        gradient[c][thread()] = has_exposure ? gradient_before(factors, found, c) : found[c];
    return pixel;
}

uint bits_between(uint first, uint end)
{
    uint sum = 0u;
    for (uint i = first; i < end; i++)
        sum += uint(bitCount(blocks_of[i]));
    return sum;
}

// Numbers the pairs of each splat, and keeps the splats whose pairs fit. Returns the blocks of this thread's splat.
uint place_pairs()
{
    const uint place = thread(), eight = place / 8u;
    if (place < SPLATS / 8u)
        eights[place] = bits_between(8u * place, 8u * place + 8u);
    barrier();
    if (place >= SPLATS)
        return 0u;
    uint before = bits_between(8u * eight, place);
    for (uint i = 0u; i < eight; i++)
        before += eights[i];
    pairs[place] = before;
    if (before + uint(bitCount(blocks_of[place])) > PAIRS)
        return 0u;
    atomicMax(here, place + 1u);
    return blocks_of[place];
}

// Keeps the splats from entry `first` on whose pairs fit. Returns their number.
uint keep_batch(uint first, uint needed)
{
    const uint place = thread(), entry = list_start() + first + place;
    const bool is_entry = place < SPLATS && first + place < needed;
    barrier();
    clear_words();
    if (place == 0u)
        here = 0u;
    if (place < SPLATS)
        blocks_of[place] = is_entry ? slots[order.at_blocks + entry] : 0u;
    if (is_entry) {
        keep_splat(place, slots[order.at_list + entry]);
        slot_of[place] = slots[order.at_slots + entry];
    }
    barrier();
    put_bits(place_pairs());
    barrier();
    return min(here, needed - first);
}

uint count_of_block()
{
    uint count = 0u;
    for (uint w = 0u; w < SPLATS / 32u; w++)
        count += uint(bitCount(words[block_of_thread()][w]));
    return count;
}

// The largest number of splats of a block, of those whose threads meet.
uint longest_of(uint count)
{
    const uint together = SUBGROUP > 0u ? SUBGROUP / 16u : 16u;
    const uint first = block_of_thread() / together * together;
    uint longest = 0u;
    if (lane() == 0u)
        counts[block_of_thread()] = count;
    meet_block();
    for (uint b = first; b < first + together; b++)
        longest = max(longest, counts[b]);
    return longest;
}

vec2 pass_pixel(uint place, inout passed_pixel pixel)
{
    const vec4 colour = colours[place], form = shapes[place];
    float u, v, weight;
    const vec2 corner = corner_of(centres[place], form, int(block_of_thread()), tile_corner());
    const float level = level_at(form, corner, int(lane()), u, v);
    const float of_colour = (gradient[0][thread()] * colour.y + gradient[1][thread()] * colour.z) +
                            gradient[2][thread()] * colour.w;
    const float h = pass_splat(takes_of(level, colour.x, pixel.transmittance), level, of_colour, pixel, weight);
    return vec2(h, weight);
}

// The splats of a block that are still to pass: the rest of a word, and the words behind it.
struct remaining { uint word, bits; };

uint next_of(inout remaining r)
{
    while (r.bits == 0u)
        r.bits = words[block_of_thread()][++r.word];
    const uint place = 32u * r.word + uint(findLSB(r.bits));
    r.bits &= r.bits - 1u;
    return place;
}

void find_sums(vec4 form, vec2 corner, uint item, int p, out float sums[FXS_FIT_SUMS])
{
    const uint b = block_of_thread(), at = 16u * b + uint(p);
    const vec2 passed = staged[b][item][p];
    float u, v;
    level_at(form, corner, p, u, v);
    sums_of(passed.x, passed.y, u, v, gradient[0][at], gradient[1][at], gradient[2][at], sums);
}

void add_sums(inout float sums[FXS_FIT_SUMS], float more[FXS_FIT_SUMS])
{
    for (int k = 0; k < FXS_FIT_SUMS; k++)
        sums[k] += more[k];
}

// (p + p8) + (p4 + p12), with p4 the sums of pixel p + 4.
void add_four(vec4 form, vec2 corner, uint item, int p, out float sums[FXS_FIT_SUMS])
{
    float more[FXS_FIT_SUMS], other[FXS_FIT_SUMS];
    find_sums(form, corner, item, p, sums);
    find_sums(form, corner, item, p + 8, more);
    add_sums(sums, more);
    find_sums(form, corner, item, p + 4, other);
    find_sums(form, corner, item, p + 12, more);
    add_sums(other, more);
    add_sums(sums, other);
}

void add_group(uint first, uint count)
{
    const uint item = lane() / 2u, b = block_of_thread();
    const int parity = int(lane() % 2u);
    const bool is_item = first + item < count;
    const uint place = is_item ? lists[b][item] : 0u;
    const uint pair = pairs[place] + uint(bitCount(blocks_of[place] & ((1u << b) - 1u)));
    float sums[FXS_FIT_SUMS], more[FXS_FIT_SUMS];
    if (is_item) {
        const vec4 form = shapes[place];
        const vec2 corner = corner_of(centres[place], form, int(b), tile_corner());
        add_four(form, corner, item, parity, sums);
        add_four(form, corner, item, parity + 2, more);
        add_sums(sums, more);
    }
    for (int k = 0; k < FXS_FIT_SUMS && is_item && parity == 1; k++)
        pair_sums[pair][k] = sums[k];
    meet_block();
    for (int k = 0; k < FXS_FIT_SUMS && is_item && parity == 0; k++)
        pair_sums[pair][k] = sums[k] + pair_sums[pair][k];
}

void pass_batch(inout passed_pixel pixel)
{
    const uint b = block_of_thread(), count = count_of_block(), longest = longest_of(count);
    remaining rest = remaining(0u, words[b][0]);
    for (uint first = 0u; first < longest; first += GROUP) {
        for (uint j = 0u; j < GROUP && first + j < count; j++) {
            const uint place = next_of(rest);
            staged[b][j][lane()] = pass_pixel(place, pixel);
            if (lane() == j)
                lists[b][j] = place;
        }
        meet_block();
        add_group(first, count);
        meet_block();
    }
}

// Adds the sums of a splat's blocks, in the order of the blocks.
void put_sums(uint count)
{
    for (uint i = thread(); i < count * FXS_FIT_SUMS; i += 256u) {
        const uint place = i / FXS_FIT_SUMS, k = i % FXS_FIT_SUMS, first = pairs[place];
        const uint end = first + uint(bitCount(blocks_of[place]));
        float sum = 0.0;
        for (uint pair = first; pair < end; pair++)
            sum += pair_sums[pair][k];
        slots[order.at_sums + slot_of[place] * FXS_FIT_SUMS + k] = floatBitsToUint(sum);
    }
}

void main()
{
    if (status.is_full != 0u)
        return;
    const uint needed = pixels[order.at_needed + tile_of_group()];
    passed_pixel pixel = begin_pixel();
    for (uint first = 0u, count; first < needed; first += count) {
        count = keep_batch(first, needed);
        pass_batch(pixel);
        barrier();
        put_sums(count);
    }
    for (uint i = needed * FXS_FIT_SUMS + thread(); i < list_count() * FXS_FIT_SUMS; i += 256u) {
        const uint slot = slots[order.at_slots + list_start() + i / FXS_FIT_SUMS];
        slots[order.at_sums + slot * FXS_FIT_SUMS + i % FXS_FIT_SUMS] = 0u;
    }
}
