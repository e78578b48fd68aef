// What blend and trace have in common: a workgroup takes 16x8 pixels, a half of a tile. It takes 64 splats of the list at
// a time: each thread tests one against the rows of the half, then takes those that can touch the 8x8 pixels that it is
// among, for two pixels of its own.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var<storage, read> counts: array<u32>;
@group(1) @binding(1) var<storage, read> entries: array<vec2<u32>>;
@group(1) @binding(2) var<storage, read> splats: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read_write> picture: array<u32>;

const SIDE: u32 = 8u;
const SOME: u32 = 64u;

// The splats of a round, at the half: u and v at its first pixel, ux, uy; vy, offset and red, green and blue, limit. The
// less memory of a workgroup, the more of them a GPU has at a time, so rows are not kept.
var<workgroup> shapes: array<vec4<u32>, 64>;
var<workgroup> shades: array<vec4<u32>, 64>;
// Four words for this round, four for the next: two for the left 8x8 pixels, two for the right ones, as where 32 threads
// go together, they take their own splats.
var<workgroup> touching: array<atomic<u32>, 8>;
var<workgroup> open_round: u32;                    // the last one before which a pixel was open
var<workgroup> open_pixels: array<atomic<u32>, 4>; // 16 bits a row

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

fn fetch_entry(h: Half, i: u32) -> vec2<u32>
{
    if (i < h.count) {
        return entries[h.list + i];
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

// Whether it can touch an open pixel of a row: u grows along it, so the least |u| is at the first or the last of these,
// or 0 between them.
fn reaches(u: u32, ux: u32, open: u32, level: i32, limit: i32) -> bool
{
    let left = bitcast<i32>(u + countTrailingZeros(open) * ux);
    let right = bitcast<i32>(u + (31u - countLeadingZeros(open)) * ux);
    return open != 0u && fxs_level_q11(fxs_coordinate_q13(max(max(left, -right), 0)), level) <= limit;
}

// Puts a splat at a half. Returns whether it can touch an open pixel of its left 8x8, and of its right ones.
fn place_splat(i: u32, f: Fetched, h: Half) -> vec2<bool>
{
    let offset_q11 = i32(f.b.y & 0xffffu);
    let limit = fxs_limit_q11(offset_q11, frame.cut_q11);
    let ux = f.a.z;
    let at = vec2<u32>(f.a.x + h.x * ux + h.y * f.a.w, f.a.y + h.y * f.b.x);
    let first = max(f.b.w & 0xffffu, h.y) - h.y;
    let last = min(max(f.b.w >> 16u, h.y) - h.y, SIDE - 1u);
    var u = at.x + first * f.a.w;
    var v = at.y + first * f.b.x;
    shapes[i] = vec4<u32>(at, ux, f.a.w);
    shades[i] = vec4<u32>(f.b.xyz, u32(limit));
    var touches = vec2<bool>(false);
    for (var row = first; row <= last; row += 1u) {
        let open = atomicLoad(&open_pixels[row / 2u]) >> (16u * (row % 2u));
        let level = fxs_row_level_q11(fxs_coordinate_q13(bitcast<i32>(v)), offset_q11);
        touches |= vec2<bool>(reaches(u, ux, open & 0xffu, level, limit), reaches(u, ux, open & 0xff00u, level, limit));
        u += f.a.w;
        v += f.b.x;
    }
    return touches;
}

// A splat of the round at a row.
struct Taken {
    u: u32,
    ux: u32,
    level: i32,
    limit: i32,
    colour: vec3<i32>,
}

fn take(i: u32, row: u32) -> Taken
{
    let shape = shapes[i];
    let shade = shades[i];
    let v = bitcast<i32>(shape.y + row * shade.x);
    return Taken(shape.x + row * shape.w, shape.z, fxs_row_level_q11(fxs_coordinate_q13(v), i32(shade.y & 0xffffu)),
                 i32(shade.w), vec3<i32>(vec3<u32>(shade.y >> 16u, shade.z & 0xffffu, shade.z >> 16u)));
}

// Blends it at a column. Returns its weight.
fn blend_splat(p: ptr<function, Pixel>, t: Taken, column: u32) -> i32
{
    let level = fxs_level_q11(fxs_coordinate_q13(bitcast<i32>(t.u + column * t.ux)), t.level);
    let counts = level <= t.limit && (*p).transmittance >= FXS_CLOSED_Q15;
    let weight = select(0, fxs_weight_q15(fxs_alpha_q15(level), (*p).transmittance), counts);
    (*p).transmittance -= weight;
    // Sums only grow: cut to 32767 once, by resolve.
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

// A half of a tile, or a tile of 8x8 pixels, as the left of its 16 columns. The same for all threads of a workgroup.
struct Half {
    tile: u32,                     // NOTHING: there is none
    x: u32,
    y: u32,
    list: u32,
    count: u32,
}

// Where the list of a tile is, sorted: in the other half of the entries after an odd number of merges.
fn list_of(tile: u32, count: u32) -> u32
{
    let merges = (max(32u - countLeadingZeros(max(count, 1u) - 1u), 9u) - 6u) / 4u;
    return counts[frame.next + tile] - count + select(0u, frame.spare, merges % 2u == 1u);
}

fn half_tile_of(group: vec3<u32>) -> Half
{
    let number = group.y * ROW_OF_GROUPS + group.x;
    let across = u32(frame.tiles.x);
    let of_tile = frame.tile_bits - 3u;            // a bit of the number: which half
    let tile = tile_at(number >> of_tile);
    if (tile == NOTHING || !fits()) {
        return Half(NOTHING, 0u, 0u, 0u, 0u);
    }
    let count = counts[TILES + tile];
    return Half(tile, (tile % across) << frame.tile_bits,
                ((tile / across) << frame.tile_bits) + (number & of_tile) * SIDE, list_of(tile, count), count);
}

// The two pixels of a thread, in a row, APART.
struct Place {
    column: u32,                   // in the half
    row: u32,
    at: u32,                       // in a plane of the picture
    inside: vec2<bool>,
}

const APART: u32 = 4u;

fn place_of(h: Half, thread: u32) -> Place
{
    let column = thread / 32u * SIDE + thread % APART;
    let row = thread % 32u / APART;
    let x = h.x + vec2<u32>(column, column + APART);
    return Place(column, row, (h.y + row) * u32(frame.size.x) + h.x + column,
                 x < vec2<u32>(min(u32(frame.size.x), h.x + (1u << frame.tile_bits))) &
                     vec2<bool>(h.y + row < u32(frame.size.y)));
}

fn bit_of(place: Place, second: bool) -> u32
{
    return 1u << (place.row % 2u * 16u + place.column + select(0u, APART, second));
}

fn clear_rounds(thread: u32, place: Place)
{
    if (thread < 4u) {
        atomicStore(&open_pixels[thread], 0u);
    }
    if (thread < 8u) {
        atomicStore(&touching[thread], 0u);
    }
    if (thread == 0u) {
        open_round = 0u;
    }
    workgroupBarrier();
    atomicOr(&open_pixels[place.row / 2u], select(0u, bit_of(place, false), place.inside.x) |
                                           select(0u, bit_of(place, true), place.inside.y));
    workgroupBarrier();
}

fn close_pixel(place: Place, second: bool)
{
    atomicAnd(&open_pixels[place.row / 2u], ~bit_of(place, second));
}

// Puts a splat to the half, and marks it where it touches an open pixel; `words`: of this round.
fn place_fetched(h: Half, thread: u32, f: Fetched, words: u32)
{
    if ((f.entry.x & CUT_OFF) == 0u) {
        let touches = place_splat(thread, f, h);
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
