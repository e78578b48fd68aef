// What the stages hand to each other. Frame and Object are filled in by the host (records.h has the same structs); the
// frame's memory is one array of words, in which Frame says where things lie.

const CHUNK: u32 = 256u;           // Gaussians
const THREADS: u32 = 128u;         // of a workgroup of project and fill: half a chunk
const ROW_OF_GROUPS: u32 = 32768u; // workgroups along x: more are rows of them
const RECORD: u32 = 64u;           // words of a chunk's record
const LARGE: u32 = 8u;             // words of a large splat's record, of so many of its tile rows:
const LARGE_ROWS: i32 = 8;
const SPAN: u32 = 8u;              // words of a span: see spans_at
const PAGE: u32 = 4096u;           // entries: rows of tiles begin at multiples of it
const MERGES: u32 = 19u;           // of two runs: a list has at most 2^28 entries
const BLOCK: u32 = 512u;           // entries that a workgroup sorts
const CLASSES: u32 = 16u;          // of tiles, by the magnitude of their lists; the first: of empty ones
const CUT_OFF: u32 = 0x80000000u;  // as FXS_ENTRY_CUT_OFF
const NOTHING: u32 = 0xffffffffu;

const BOX_COLUMNS: i32 = 6;
const BOX_ROWS: i32 = 7;

// In the counts: what a frame needed, then the tiles' numbers.
const VISIBLE_CHUNKS: u32 = 0u;
const LARGES: u32 = 1u;
const PAGES: u32 = 2u;
const DAMAGED: u32 = 3u;
const VISIBLE: u32 = 4u;
const ENTRIES: u32 = 5u;           // two words
const SHORT_BLOCKS: u32 = 7u;      // that are sorted: a list each
const LONG_BLOCKS: u32 = 8u;       // and of longer lists
const LONGEST: u32 = 9u;           // list
const CLASS_COUNTS: u32 = 16u;
const TILES: u32 = 64u;            // the lengths of the tiles' lists

struct Frame {
    size: vec2<i32>,
    tiles: vec2<i32>,
    places: u32,                   // chunks that may be drawn
    spans: u32,
    chunk_room: u32,               // chunks there is room for splats of
    large_room: u32,
    page_room: u32,
    drawn: u32,                    // where in memory there are: chunk and share of each place; 0: all are drawn
    seen: u32,                     // in the counts: bits of the places that can be seen
    ranks: u32,                    // how many are seen before each word of these
    visible: u32,                  // the places that are seen
    records: u32,                  // of places
    depths: u32,                   // by slot
    boxes: u32,                    // two words a slot, until the lists are filled: what is needed later lies over them
    larges: u32,
    spans_at: u32,                 // of each span its first place, its end, these as they are among the visible, the
                                   // object's id and its first chunk
    next: u32,                     // in the counts: where the tiles' next entries go,
    classes: u32,                  // the tiles by class,
    blocks: u32,                   // and of each block of a list the tile and which one it is: short lists' first,
                                   // those of long lists last
    block_room: u32,
    spare: u32,                    // in the memory: where as many entries are again, to sort lists
    tile_bits: u32,                // a list is of 2^tile_bits pixels across and down: 16, or 8 (see plan.c)
    cleared: u32,                  // words of the counts that are 0 at first
    cutoff: i32,                   // 1: square
    cut_q11: i32,
    format: u32,
    background_q13: vec4<i32>,
    depth_bits: i32,
    colour: u32,                   // in the memory: where the picture's planes begin, of a word a pixel; NOTHING: there
                                   // is none
    coverage: u32,
    mean_depth: u32,               // and the two below: as in fxs_targets
    median_depth: u32,
    id: u32,                       // two words
    occluder: u32,
    backdrop: u32,
}

// An object as the camera sees it, and a stretch of its chunks whose rows lie in one buffer.
struct Object {
    position_q32: array<vec4<u32>, 3>,
    eye_q32: array<vec4<u32>, 3>,
    rotation_q30: array<vec4<i32>, 3>,
    row_q15: array<vec4<i32>, 2>,
    forward_q15: array<vec4<i32>, 2>,
    tint_q13: vec4<i32>,
    near_q32: vec2<u32>,
    dilation_q30: vec2<u32>,       // (x^2 + y^2) 2^30 / 14400 of the picture's tiles, for veils
    f_q12: vec2<i32>,
    c_q12: vec2<i32>,
    slope_low_q23: vec2<i32>,
    slope_high_q23: vec2<i32>,
    edge_low_q23: vec2<i32>,
    edge_high_q23: vec2<i32>,
    hidden_low_q23: vec2<i32>,
    hidden_high_q23: vec2<i32>,
    hidden: vec2<i32>,
    hidden_end: vec2<i32>,
    focal_q32: u32,
    focal_exponent: i32,
    veil_exponent: i32,
    jacobian_exponent: i32,
    offset_q11: i32,
    degree: i32,                   // that is evaluated
    antialiased: i32,
    orthographic: i32,
    plane_exponent: i32,
    profile: u32,
    scene_degree: i32,
    chunk_words: u32,
    palette_entries: u32,
    palette_step_q19: i32,
    scale_mantissa: u32,
    scale_exponent: i32,
    plain: i32,
    crop_count: u32,
    keep_count: u32,
    first_chunk: u32,              // of the object, among those of all
    first_place: u32,              // of the span
    end_place: u32,
    span: u32,
    part_chunk: u32,               // the chunk whose rows lie first in the span's buffer,
    rows_at: u32,                  // and where, in words
    crops: array<vec4<u32>, 32>,   // four each: low, high, outside
}

// A projected Gaussian, as fxs_splat, and its bounds.
struct Splat {
    u0_q24: u32,
    v0_q24: u32,
    ux_q24: i32,
    uy_q24: i32,
    vy_q24: i32,
    offset_q11: i32,
    rows: vec2<i32>,
}

struct Bounds {
    c_q14: vec2<i32>,
    breadth_q8: u32,
    shear_q8: i32,
    half_width_q8: i32,
    square_radius: u32,
}

const EVERYWHERE_Q8: i32 = 0x40000000;

// A word's lower half, where i is even, or its upper one.
fn half_of(word: u32, i: u32) -> u32
{
    return (word >> (16u * (i % 2u))) & 0xffffu;
}

// First to last.
struct Span {
    first: i32,
    last: i32,
}
