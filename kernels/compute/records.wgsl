// Data that one stage passes to the next. The host fills in Frame and Object (records.h has the same structs). A
// frame's memory is one array of words; Frame has the offsets in it.

const CHUNK: u32 = 256u;           // Gaussians
const THREADS: u32 = 128u;         // per workgroup of project and fill: half a chunk
const ROW_OF_GROUPS: u32 = 32768u; // workgroups along x; more are split into rows
const RECORD: u32 = 64u;           // words of a chunk's record
const LARGE: u32 = 8u;             // words of a large splat's record, which covers this many tile rows:
const LARGE_ROWS: i32 = 8;
const SPAN: u32 = 8u;              // words of a span: see spans_at
const PAGE: u32 = 4096u;           // entries; rows of tiles start at multiples of it
const MERGES: u32 = 19u;           // rounds of merging two runs; enough for 2^28 entries, the longest list
const BLOCK: u32 = 512u;           // entries that a workgroup sorts
const CLASSES: u32 = 16u;          // classes of tiles, by the magnitude of their list's length; class 0: empty lists
const CUT_OFF: u32 = 0x80000000u;  // as FXS_ENTRY_CUT_OFF
const NOTHING: u32 = 0xffffffffu;

const BOX_COLUMNS: i32 = 6;
const BOX_ROWS: i32 = 7;

// Indices in the array of counts: first what the frame needed of each kind, then the lengths per tile.
const VISIBLE_CHUNKS: u32 = 0u;
const LARGES: u32 = 1u;
const PAGES: u32 = 2u;
const DAMAGED: u32 = 3u;
const VISIBLE: u32 = 4u;
const ENTRIES: u32 = 5u;           // two words
const SHORT_BLOCKS: u32 = 7u;      // blocks to sort of lists with one block
const LONG_BLOCKS: u32 = 8u;       // blocks to sort of longer lists
const LONGEST: u32 = 9u;           // length of the longest list
const CLASS_COUNTS: u32 = 16u;
const TILES: u32 = 64u;            // lengths of the tiles' lists

struct Frame {
    size: vec2<i32>,
    tiles: vec2<i32>,
    places: u32,                   // number of chunks that may be drawn, here called places
    spans: u32,
    chunk_room: u32,               // capacity, in chunks, for splats
    large_room: u32,
    page_room: u32,
    drawn: u32,                    // offset of the array with chunk and share of each place; 0: all chunks are drawn
    seen: u32,                     // in the counts: a bit per place, set if visible
    ranks: u32,                    // number of visible places before each word of `seen`
    visible: u32,                  // visible places
    records: u32,                  // record of each place; written only if visible
    depths: u32,                   // depth keys by slot
    boxes: u32,                    // two words per slot; reused by later stages after the lists are filled
    larges: u32,
    spans_at: u32,                 // per span: first place, end; the same counted in visible places; id and first chunk
                                   // of the object
    next: u32,                     // in the counts: place of each tile's next entry
    classes: u32,                  // tiles by class
    blocks: u32,                   // per block of a list: tile and block number; blocks of short lists first, of long
                                   // lists last
    block_room: u32,
    spare: u32,                    // scratch space for sorting, as large as all lists
    tile_bits: u32,                // log2 of a tile's side in pixels: 4, or 3 (see plan.c)
    cleared: u32,                  // words of the counts to clear at the start
    cutoff: i32,                   // 1: square
    cut_q11: i32,
    format: u32,
    background_q13: vec4<i32>,
    depth_bits: i32,
    colour: u32,                   // offsets of the picture's planes, one word per pixel; NOTHING: no such plane
    coverage: u32,
    mean_depth: u32,               // mean_depth, median_depth and id: as in fxs_targets
    median_depth: u32,
    id: u32,                       // two words per pixel
    occluder: u32,
    backdrop: u32,
}

// An object as the camera sees it, and a span: a range of its chunks with all rows in one buffer.
struct Object {
    position_q32: array<vec4<u32>, 3>,
    eye_q32: array<vec4<u32>, 3>,
    rotation_q30: array<vec4<i32>, 3>,
    row_q15: array<vec4<i32>, 2>,
    forward_q15: array<vec4<i32>, 2>,
    tint_q13: vec4<i32>,
    near_q32: vec2<u32>,
    dilation_q30: vec2<u32>,       // (x^2 + y^2) 2^30 / 14400 for the size of the picture's tiles; for veils
    f_q12: vec2<i32>,
    c_q12: vec2<i32>,
    slope_low_q23: vec2<i32>,
    slope_high_q23: vec2<i32>,
    edge_low_q23: vec2<i32>,
    edge_high_q23: vec2<i32>,
    focal_q32: u32,
    focal_exponent: i32,
    veil_exponent: i32,
    jacobian_exponent: i32,
    offset_q11: i32,
    degree: i32,                   // SH degree to evaluate
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
    first_chunk: u32,              // the object's first chunk, counted over all objects
    first_place: u32,              // of the span
    end_place: u32,
    span: u32,
    part_chunk: u32,               // first chunk with rows in the span's buffer
    rows_at: u32,                  // offset of these rows in words
    crops: array<vec4<u32>, 32>,   // four per box: low, high, outside
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

// Lower half of a word for even i, upper half for odd i.
fn half_of(word: u32, i: u32) -> u32
{
    return (word >> (16u * (i % 2u))) & 0xffffu;
}

struct Span {
    first: i32,
    last: i32,
}
