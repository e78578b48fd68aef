// Data passed between the stages of a frame, as in records.h. Offsets count words of the array `memory` unless `counts`
// is named. A slot is the index of a splat (a projected Gaussian), a place the index of a drawn chunk of 256 Gaussians.

const CHUNK: u32 = 256u;
const THREADS: u32 = 128u;
const ROW_OF_GROUPS: u32 = 32768u; // largest number of workgroups along x in a dispatch
const RECORD: u32 = 64u;
const LARGE: u32 = 8u;
const LARGE_ROWS: i32 = 8;
const SPAN: u32 = 8u;              // words in the record of a span, a range of drawn chunks
const DRAWN: u32 = 3u;             // words in a record of the table of drawn chunks
const PAGE: u32 = 4096u;           // list entries in a page; the lists of each row of tiles start with a new page
const MERGES: u32 = 19u;
const BLOCK: u32 = 512u;           // list entries that one workgroup sorts
const CLASSES: u32 = 16u;          // number of classes of tiles by list length
const CUT_OFF: u32 = 0x80000000u;
const NOTHING: u32 = 0xffffffffu;
const LARGE_BOX: u32 = 0x3fffffu;  // first tile in the box of a large splat
const MOTION_TURNS: u32 = 1u;
const MOTION_FADES: u32 = 2u;
const FAR_Q3: i32 = -0x100000;

const BOX_COLUMNS: i32 = 6;
const BOX_ROWS: i32 = 7;

const VISIBLE_CHUNKS: u32 = 0u;
const LARGES: u32 = 1u;
const PAGES: u32 = 2u;
const DAMAGED: u32 = 3u;
const VISIBLE: u32 = 4u;
const ENTRIES: u32 = 5u;
const SHORT_BLOCKS: u32 = 7u;
const LONG_BLOCKS: u32 = 8u;
const LONGEST: u32 = 9u;
const CLASS_COUNTS: u32 = 16u;
const TILES: u32 = 64u;
const LIST: u32 = 8u;              // words from one tile's list to the next: atomics in one memory sector are slow


struct Frame {
    size: vec2<i32>,               // of the window of the picture that the frame draws
    tiles: vec2<i32>,
    first: vec2<i32>,              // first pixel of the window in the picture
    whole: vec2<i32>,              // size of the picture
    places: u32,                   // number of drawn chunks
    spans: u32,
    merges: u32,                   // number of merge passes; a frame fits if no list needs more
    large_room: u32,
    page_room: u32,
    // Offset of the table of drawn chunks: index of header and rows in the object's buffers, drawn share, number. 0:
    // every chunk is drawn.
    drawn: u32,
    seen: u32,                     // offset in `counts` of one bit per drawn chunk; 1: visible
    ranks: u32,
    visible: u32,
    records: u32,                  // offset of the records of visible chunks
    depths: u32,                   // offset of the depth keys, one per splat
    boxes: u32,
    larges: u32,
    // Offset of the spans, ranges of drawn chunks. Each has first and end place, first and end visible place, object
    // id, first chunk.
    spans_at: u32,
    finishes: u32,                 // number of steps that draw the tiles of a frame that does not fit
    classes: u32,
    blocks: u32,           // offset in `counts` of the blocks to sort: tile, and number of the block in the tile's list
    block_room: u32,
    spare: u32,
    tile_bits: u32,                // log2 of a tile's side in pixels, 3 or 4
    cleared: u32,
    cutoff: i32,
    cut_q11: i32,
    format: u32,
    background_q13: vec4<i32>,
    depth_bits: i32,
    colour: u32,                // offset of the colours; NOTHING: colours are not wanted; likewise for the planes below
    coverage: u32,
    mean_depth: u32,
    median_depth: u32,
    id: u32,                       // offset of the ids, two words per pixel
    occluder: u32,
    backdrop: u32,
    scratch: u32,                  // length of `entries`, for the tiles of a frame that does not fit
    squares: u32,                  // of square splats: offset of the range of tiles of each slot
    rates: u32,                    // offset of log2 of each macro tile's rate; NOTHING: all rates are 1
    // Offset of the moments of the drawn chunks in a frame with a moving object, two words each: u, u^2; u^3, shift.
    moments: u32,
}

struct Object {
    position_q32: array<vec4<u32>, 3>,
    eye_q32: array<vec4<u32>, 3>,
    rotation_q30: array<vec4<i32>, 3>,
    row_q15: array<vec4<i32>, 2>,
    forward_q15: array<vec4<i32>, 2>,
    tint_q13: vec4<i32>,
    near_q32: vec2<u32>,
    // variance that widens huge splats: (x^2 + y^2) 2^30 / 14400 for a picture of x by y pixels
    dilation_q30: vec2<u32>,
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
    degree: i32,
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
    first_chunk: u32,
    first_place: u32,
    end_place: u32,
    span: u32,
    part_chunk: u32,
    rows_at: u32,
    part_chunks: u32,
    motion_at: u32,                // offset in a chunk's words of the rows of motion; 0: the scene is still
    motion_degree: u32,
    motion_cut_q16: u32,           // a Gaussian whose opacity has fallen by more octaves than this is not drawn
    motion_flags: u32,             // MOTION_TURNS, MOTION_FADES
    // crop boxes, four vectors each: low corner, high corner, `outside` (1: keeps the outside)
    crops: array<vec4<u32>, 32>,
}

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

// Returns where `counts` has the length of a tile's list, followed by the place of its next entry, later of its end.
fn list_of(tile: u32) -> u32
{
    return TILES + LIST * tile;
}

fn half_of(word: u32, i: u32) -> u32
{
    return (word >> (16u * (i % 2u))) & 0xffffu;
}

struct Span {
    first: i32,
    last: i32,
}

// Returns the number of words at the start of `entries` that bound each half of a chunk, if the frame does not fit.
fn bound_words() -> u32
{
    return 4u * frame.places;
}

// Returns a bound of the length of a tile's list, if the frame does not fit. `longest` ignores lists up to BLOCK. Large
// splats may be listed in tiles that they do not touch.
fn list_room(longest: u32, larges: u32, visible: u32) -> u32
{
    return max(min(max(longest, BLOCK) + larges, visible), 1u);
}
