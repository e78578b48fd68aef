// Pixel functions of the shaders blend, trace and finish. 32 threads draw 8x8 pixels, two per thread; further threads
// only wait. Each round takes 32 splats: each thread tests one splat, then all threads blend the splats that touch a
// pixel. For the longest lists a workgroup draws only 8 pixels, for load balance.

const SIDE: u32 = 8u;
const SOME: u32 = 32u;

// The 32 splats of a round. A splat's alpha is exp(-(u^2 + v^2 + offset) / 2), with u and v linear in the pixel
// position. shapes: u and v at the workgroup's first pixel, du/dx, du/dy. shades: dv/dy; offset and red; green and
// blue; largest drawn exponent.
var<workgroup> shapes: array<vec4<u32>, 32>;
var<workgroup> shades: array<vec4<u32>, 32>;
// Bit i: splat i of the round touches a pixel. Successive rounds use the two words in turn.
var<workgroup> touching: array<atomic<u32>, 2>;
var<workgroup> open_round: u32;
var<workgroup> open_pixels: array<atomic<u32>, 2>; // bits of the pixels that are not yet opaque, 8 per row

var<workgroup> shared_number: u32;

struct Pixel {
    transmittance: i32,
    sum: vec3<i32>,
}

// Returns the thread's place in a round of splats, or a place beyond all lists.
fn lane_of(thread: u32) -> u32
{
    return select(0x40000000u, thread, thread < SOME);
}

struct Fetched {
    entry: u32,                    // index of the splat; with bit CUT_OFF: no splat
    a: vec4<u32>,
    b: vec4<u32>,
}

fn fetch_entry(here: Patch, i: u32) -> u32
{
    if (i < here.count) {
        return entries[here.list + i];
    }
    return NOTHING;
}

fn fetch_splat(entry: u32) -> Fetched
{
    var f: Fetched;
    f.entry = entry;
    if ((entry & CUT_OFF) == 0u) {
        f.a = splats[2u * entry];
        f.b = splats[2u * entry + 1u];
    }
    return f;
}

// Returns a splat relative to the first sample of a patch, in steps of a sample.
fn relative(f: Fetched, here: Patch) -> Fetched
{
    var g = f;
    let first = (max(f.b.w & 0xffffu, here.y) - here.y) >> here.shift;
    let last = (max(f.b.w >> 16u, here.y) - here.y) >> here.shift;
    g.a = vec4<u32>(f.a.x + here.x * f.a.z + here.y * f.a.w, f.a.y + here.y * f.b.x, f.a.zw << vec2<u32>(here.shift));
    g.b.x = f.b.x << here.shift;
    g.b.w = first | (last << 16u);
    return g;
}

// Returns true if a splat can touch an open pixel, one that is not yet opaque. In a row of pixels, the splat coordinate
// |u| is smallest at the first or last open pixel, or zero between them.
fn touch(f: Fetched, here: Patch) -> bool
{
    let offset_q11 = i32(f.b.y & 0xffffu);
    let limit_q11 = fxs_limit_q11(offset_q11, frame.cut_q11);
    let ux = f.a.z;
    let first = max(f.b.w & 0xffffu, here.rows.x);
    let last = min(f.b.w >> 16u, here.rows.y);
    var u = f.a.x + first * f.a.w;
    var v = f.a.y + first * f.b.x;
    var touches = false;
    for (var row = first; row <= last; row += 1u) {
        let open = open_of(row);
        let left = bitcast<i32>(u + firstTrailingBit(open) * ux);
        let right = bitcast<i32>(u + firstLeadingBit(open) * ux);
        let u_q13 = min(max(max(left, -right), 0) >> 11u, 32767);
        let v_q13 = fxs_coordinate_q13(bitcast<i32>(v));
        // tests whether u^2, rounded, plus v^2 plus the splat's offset is within the limit
        let most_q26 = (limit_q11 - fxs_mul_q15(v_q13, v_q13) - offset_q11 + 1) * 32768 - 16384;
        touches |= open != 0u && u_q13 * u_q13 < most_q26;
        u += f.a.w;
        v += f.b.x;
    }
    return touches;
}

fn open_of(row: u32) -> u32
{
    return (atomicLoad(&open_pixels[row / 4u]) >> (8u * (row % 4u))) & 0xffu;
}

struct Taken {
    u: u32,
    ux: u32,
    level_q26: u32,                // v^2 + offset of the splat in the row of pixels, plus 1/2 for rounding
    limit_q11: i32,
    colour: vec3<i32>,
}

fn take(i: u32, row: u32) -> Taken
{
    let shape = shapes[i];
    let shade = shades[i];
    let v = bitcast<i32>(shape.y + row * shade.x);
    let v_q13 = fxs_coordinate_q13(v);
    let level_q11 = fxs_mul_q15(v_q13, v_q13) + i32(shade.y & 0xffffu);
    return Taken(shape.x + row * shape.w, shape.z, (u32(level_q11) << 15u) + 16384u, i32(shade.w),
                 vec3<i32>(vec3<u32>(shade.y >> 16u, shade.z & 0xffffu, shade.z >> 16u)));
}

// Blends a splat into a pixel. Returns the splat's weight.
fn blend_splat(p: ptr<function, Pixel>, t: Taken, column: u32) -> i32
{
    let u_q13 = fxs_coordinate_q13(bitcast<i32>(t.u + column * t.ux));
    let level = i32((u32(u_q13 * u_q13) + t.level_q26) >> 15u);
    let counts = level <= t.limit_q11 && (*p).transmittance >= FXS_CLOSED_Q15;
    let weight = select(0, fxs_weight_q15(fxs_alpha_q15(level), (*p).transmittance), counts);
    (*p).transmittance -= weight;
    // A pixel's sums of colours only grow, so it suffices that put_colour saturates them at the end.
    (*p).sum += vec3<i32>(fxs_mul_q15(weight, t.colour.x), fxs_mul_q15(weight, t.colour.y),
                          fxs_mul_q15(weight, t.colour.z));
    return weight;
}

fn background_of(word: u32) -> vec3<i32>
{
    let rgb = vec3<u32>(word & 255u, (word >> 8u) & 255u, (word >> 16u) & 255u);
    return vec3<i32>((rgb * 8192u + 127u) / 255u);
}

fn put_colour(p: ptr<function, Pixel>, at: u32)
{
    let sum = min((*p).sum, vec3<i32>(32767));
    let transmittance = (*p).transmittance;
    if (frame.format == 3u) {
        let rgb = vec3<u32>(min((sum * 65535 + 4096) >> vec3<u32>(13u), vec3<i32>(65535)));
        let alpha = u32(((FXS_CLEAR_Q15 - transmittance) * 65535 + 16384) >> 15u);
        memory[frame.colour + 2u * at] = rgb.x | (rgb.y << 16u);
        memory[frame.colour + 2u * at + 1u] = rgb.z | (alpha << 16u);
        return;
    }
    var background_q13 = frame.background_q13.xyz;
    if (frame.backdrop != NOTHING) {
        background_q13 = background_of(memory[frame.backdrop + at]);
    }
    let r = u32(fxs_resolve_8bit(sum.x, transmittance, background_q13.x));
    let g = u32(fxs_resolve_8bit(sum.y, transmittance, background_q13.y));
    let b = u32(fxs_resolve_8bit(sum.z, transmittance, background_q13.z));
    var word = r | (g << 8u) | (b << 16u) | 0xff000000u;
    if (frame.format == 1u) {
        word = (word & 0xffffffu) | (u32(fxs_coverage_8bit(transmittance)) << 24u);
    }
    if (frame.format == 2u) {
        word = (((r * 31u + 127u) / 255u) << 11u) | (((g * 63u + 127u) / 255u) << 5u) | ((b * 31u + 127u) / 255u);
    }
    memory[frame.colour + at] = word;
}

struct Patch {
    x: u32,                        // pixel of the first sample
    y: u32,
    shift: u32,                    // log2 of the rate: a sample covers a block of 2^shift x 2^shift pixels
    rows: vec2<u32>,               // first and last row of samples to draw
    list: u32,
    count: u32,
}

fn corner_of(tile: u32, number: u32) -> vec2<u32>
{
    let halves = frame.tile_bits - 3u;
    let across = u32(frame.tiles.x);
    return (vec2<u32>(tile % across, tile / across) << vec2<u32>(frame.tile_bits)) +
           vec2<u32>(number & halves, (number >> 1u) & halves) * SIDE;
}

// Returns thread 0's number to all threads.
fn of_first(thread: u32, number: u32) -> u32
{
    if (thread == 0u) {
        shared_number = number;
    }
    return workgroupUniformLoad(&shared_number);
}

// Returns patch `number` of a tile. A tile with a rate above 1 has one patch.
fn patch_at(thread: u32, tile: u32, number: u32, rows: vec2<u32>, list: u32, count: u32) -> Patch
{
    let corner = corner_of(tile, number);
    var shift = 0u;
    if (frame.rates != NOTHING) {
        let macros = (u32(frame.size.x) + 31u) / 32u;
        shift = of_first(thread, memory[frame.rates + corner.y / 32u * macros + corner.x / 32u]);
    }
    if (shift > 0u && any(corner != corner_of(tile, 0u))) {
        return Patch(u32(frame.size.x), u32(frame.size.y), 0u, rows, 0u, 0u);
    }
    let first = corner + vec2<u32>((1u << shift) >> 1u);
    return Patch(first.x, first.y, shift, rows, list, count);
}

struct Share {
    tile: u32,                     // number of the tile; NOTHING: no pixels to draw
    number: u32,                   // of the patch
    rows: vec2<u32>,               // first and last row of samples to draw
}

fn share_of(group: vec3<u32>) -> Share
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let halves = frame.tile_bits - 3u;
    let longest = counts[CLASS_COUNTS + CLASSES - 1u];
    let by_rows = (SIDE * longest) << (2u * halves);
    let whole = number - min(number, by_rows);
    let patch_number = select(number / SIDE, whole + by_rows / SIDE, number >= by_rows);
    let rows = select(vec2<u32>(number % SIDE), vec2<u32>(0u, SIDE - 1u), number >= by_rows);
    return Share(tile_at(patch_number >> (2u * halves)), patch_number, rows);
}

fn patch_of(share: Share, thread: u32) -> Patch
{
    let count = counts[list_of(share.tile)];
    let list = counts[list_of(share.tile) + 1u] - count;
    return patch_at(thread, share.tile, share.number, share.rows, list, count);
}

struct Place {
    column: u32,
    row: u32,
    at: vec2<u32>,                 // numbers of the pixels of the two samples
    inside: vec2<bool>,
}

const APART: u32 = 4u;

fn place_of(here: Patch, thread: u32) -> Place
{
    let column = thread % APART;
    let row = thread / APART;
    let columns = vec2<u32>(column, column + APART);
    let x = here.x + (columns << vec2<u32>(here.shift));
    let y = here.y + (row << here.shift);
    let side = min(SIDE, 16u >> here.shift);
    return Place(column, row, y * u32(frame.size.x) + x,
                 (x < vec2<u32>(u32(frame.size.x))) & (columns < vec2<u32>(side)) &
                     vec2<bool>(y < u32(frame.size.y) && row < side && row >= here.rows.x && row <= here.rows.y));
}

fn bit_of(place: Place, second: bool) -> u32
{
    return 1u << (place.row % 4u * 8u + place.column + select(0u, APART, second));
}

fn clear_rounds(thread: u32, place: Place)
{
    if (thread < 2u) {
        atomicStore(&open_pixels[thread], 0u);
        atomicStore(&touching[thread], 0u);
    }
    if (thread == 0u) {
        open_round = 0u;
    }
    workgroupBarrier();
    if (any(place.inside)) {
        atomicOr(&open_pixels[place.row / 4u], select(0u, bit_of(place, false), place.inside.x) |
                                               select(0u, bit_of(place, true), place.inside.y));
    }
    workgroupBarrier();
}

fn close_pixel(place: Place, second: bool)
{
    atomicAnd(&open_pixels[place.row / 4u], ~bit_of(place, second));
}

fn put_splat(thread: u32, f: Fetched)
{
    let limit = fxs_limit_q11(i32(f.b.y & 0xffffu), frame.cut_q11);
    shapes[thread] = f.a;
    shades[thread] = vec4<u32>(f.b.xyz, u32(limit));
}

fn place_splat(here: Patch, thread: u32, f: Fetched, round: u32)
{
    if ((f.entry & CUT_OFF) != 0u) {
        return;
    }
    let g = relative(f, here);
    put_splat(thread, g);
    if (touch(g, here)) {
        atomicOr(&touching[round % 2u], 1u << thread);
    }
}

// Returns the number of pixel i of the block of a sample, whose own pixel is `at`.
fn pixel_of(at: u32, shift: u32, i: u32) -> u32
{
    let width = u32(frame.size.x);
    return at - ((1u << shift) >> 1u) * (width + 1u) + (i >> shift) * width + (i & ((1u << shift) - 1u));
}

fn put_pixel(p: ptr<function, Pixel>, at: u32)
{
    if (frame.colour != NOTHING) {
        put_colour(p, at);
    }
    if (frame.coverage != NOTHING) {
        memory[frame.coverage + at] = u32(fxs_coverage_8bit((*p).transmittance));
    }
}
