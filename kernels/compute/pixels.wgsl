// What blend and trace have in common: a workgroup takes 8x8 pixels, a quarter of a tile. It takes 64 splats of the list
// at a time: each thread tests one against the rows of the quarter, then takes those that can touch any, for its own
// pixel.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read> entries: array<vec2<u32>>;
@group(1) @binding(2) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> picture: array<u32>;

const SIDE: u32 = 8u;
const SOME: u32 = 64u;

// Of each splat of a round: u and the level at the first pixel of each row; ux, limit, colours.
var<workgroup> rows: array<vec2<i32>, 512>;
var<workgroup> others: array<vec4<i32>, 64>;
// Four words for this round, four for the next: two for the upper four rows, two for the lower ones, as where 32 threads
// go together, each half takes its own splats.
var<workgroup> touching: array<atomic<u32>, 8>;
var<workgroup> open_round: u32;                    // the last one before which a pixel was open
var<workgroup> open_pixels: array<atomic<u32>, 2>; // a byte a row

struct Pixel {
    transmittance: i32,
    sum: vec3<i32>,
}

// A splat on its way to a round.
struct Fetched {
    entry: vec2<u32>,              // with CUT_OFF: there is none
    a: vec4<u32>,
    b: vec4<u32>,
}

fn fetch_entry(q: Quarter, i: u32) -> vec2<u32>
{
    if (i < q.count) {
        return entries[q.list + i];
    }
    return vec2<u32>(NOTHING, NOTHING);
}

fn fetch_splat(entry: vec2<u32>) -> Fetched
{
    var f: Fetched;
    f.entry = entry;
    if ((entry.x & CUT_OFF) == 0u) {
        f.a = splats[2u * entry.x];
        f.b = splats[2u * entry.x + 1u];
    }
    return f;
}

// Puts a splat at a quarter. Returns whether it can touch an open pixel of the upper rows, and of the lower ones: u
// grows along a row, so the least |u| is at the first open pixel or the last, or 0 between them.
fn place_splat(i: u32, f: Fetched, q: Quarter) -> vec2<bool>
{
    let offset_q11 = i32(f.b.y & 0xffffu);
    let limit = fxs_limit_q11(offset_q11, frame.cut_q11);
    let ux = f.a.z;
    var u = f.a.x + q.x * ux + q.y * f.a.w;
    var v = f.a.y + q.y * f.b.x;
    var touches = false;
    var upper = false;
    var open = atomicLoad(&open_pixels[0]);
    for (var row = 0u; row < SIDE; row += 1u) {
        if (row == SIDE / 2u) {
            open = atomicLoad(&open_pixels[1]);
            upper = touches;
            touches = false;
        }
        let of_row = open & 255u;
        if (of_row != 0u) {
            let left = bitcast<i32>(u + countTrailingZeros(of_row) * ux);
            let right = bitcast<i32>(u + (31u - countLeadingZeros(of_row)) * ux);
            let level = fxs_row_level_q11(fxs_coordinate_q13(bitcast<i32>(v)), offset_q11);
            let least = max(max(left, -right), 0);
            rows[SIDE * i + row] = vec2<i32>(bitcast<i32>(u), level);
            touches = touches || fxs_level_q11(fxs_coordinate_q13(least), level) <= limit;
        }
        open >>= 8u;
        u += f.a.w;
        v += f.b.x;
    }
    others[i] = vec4<i32>(bitcast<i32>(ux), limit, bitcast<i32>((f.b.y >> 16u) | (f.b.z << 16u)),
                          bitcast<i32>(f.b.z >> 16u));
    return vec2<bool>(upper, touches);
}

// Blends a splat of the round. Returns its weight. Rows without open pixels are not there.
fn blend_splat(p: ptr<function, Pixel>, i: u32, column: u32, row: u32) -> i32
{
    let at_row = rows[SIDE * i + row];
    let other = others[i];
    let u = at_row.x + i32(column) * other.x;
    let level = fxs_level_q11(fxs_coordinate_q13(u), at_row.y);
    if (level > other.y || (*p).transmittance < FXS_CLOSED_Q15) {
        return 0;
    }
    let weight = fxs_weight_q15(fxs_alpha_q15(level), (*p).transmittance);
    (*p).transmittance -= weight;
    // Sums only grow: cut to 32767 once, by resolve.
    (*p).sum += vec3<i32>(fxs_mul_q15(weight, other.z & 0xffff), fxs_mul_q15(weight, other.z >> 16u),
                          fxs_mul_q15(weight, other.w));
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
        picture[frame.colour + 2u * at] = rgb.x | (rgb.y << 16u);
        picture[frame.colour + 2u * at + 1u] = rgb.z | (alpha << 16u);
        return;
    }
    var background_q13 = frame.background_q13.xyz;
    if (frame.backdrop != NOTHING) {
        background_q13 = background_of(picture[frame.backdrop + at]);
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
    picture[frame.colour + at] = word;
}

// A quarter of a tile, the same for all threads of a workgroup.
struct Quarter {
    tile: u32,                     // NOTHING: there is none
    x: u32,
    y: u32,
    list: u32,
    count: u32,
}

// Where the list of a tile is, sorted: in the other half of the entries after an odd number of merges.
fn list_of(tile: u32, count: u32) -> u32
{
    let merges = (max(32u - countLeadingZeros(max(count, 1u) - 1u), 10u) - 7u) / 4u;
    return counts[frame.next + tile] - count + select(0u, frame.spare, merges % 2u == 1u);
}

fn quarter_of(group: vec3<u32>) -> Quarter
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let across = u32(frame.tiles.x);
    let tile = tile_at(number / 4u);
    if (tile == NOTHING || !fits()) {
        return Quarter(NOTHING, 0u, 0u, 0u, 0u);
    }
    let count = counts[TILES + tile];
    return Quarter(tile, tile % across * 16u + number % 2u * SIDE, tile / across * 16u + number / 2u % 2u * SIDE,
                   list_of(tile, count), count);
}

// The pixel of a thread.
struct Place {
    column: u32,                   // in the quarter
    row: u32,
    at: u32,                       // in a plane of the picture
    inside: bool,
}

fn place_of(q: Quarter, thread: u32) -> Place
{
    let column = thread % SIDE;
    let row = thread / SIDE;
    return Place(column, row, (q.y + row) * u32(frame.size.x) + q.x + column,
                 q.x + column < u32(frame.size.x) && q.y + row < u32(frame.size.y));
}

fn clear_rounds(thread: u32, inside: bool)
{
    if (thread < 2u) {
        atomicStore(&open_pixels[thread], 0u);
    }
    if (thread < 8u) {
        atomicStore(&touching[thread], 0u);
    }
    if (thread == 0u) {
        open_round = 0u;
    }
    workgroupBarrier();
    if (inside) {
        atomicOr(&open_pixels[thread / 32u], 1u << (thread % 32u));
    }
    workgroupBarrier();
}

fn close_pixel(thread: u32)
{
    atomicAnd(&open_pixels[thread / 32u], ~(1u << (thread % 32u)));
}

// Puts a splat to the quarter, and marks it where it touches an open pixel; `words`: of this round.
fn place_fetched(q: Quarter, thread: u32, f: Fetched, words: u32)
{
    if ((f.entry.x & CUT_OFF) == 0u) {
        let touches = place_splat(thread, f, q);
        if (touches.x) {
            atomicOr(&touching[words + thread / 32u], 1u << (thread % 32u));
        }
        if (touches.y) {
            atomicOr(&touching[words + 2u + thread / 32u], 1u << (thread % 32u));
        }
    }
}

fn put_pixel(p: ptr<function, Pixel>, at: u32)
{
    if (frame.colour != NOTHING) {
        put_colour(p, at);
    }
    if (frame.coverage != NOTHING) {
        picture[frame.coverage + at] = u32(fxs_coverage_8bit((*p).transmittance));
    }
}
