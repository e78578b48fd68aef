/* Declarations shared by the host and the shaders of the compute back ends. Structs and constants match
 * records.wgsl. */
#ifndef FXS_COMPUTE_RECORDS_H
#define FXS_COMPUTE_RECORDS_H

#include <fixsplat/internal/stage.h>

/* List of the shader programs in the order of a frame: F(name of the entry point). */
#define FXS_COMPUTE_PROGRAMS_OF(F) \
    F(clear_counts) F(locate_chunks) F(gather_chunks) F(animate_chunk) F(project_chunk) F(start_lists) F(fill_lists) \
    F(fill_large) F(sort_blocks) F(merge_runs) F(blend_tiles) F(trace_tiles) \
    F(clear_pixels) F(bound_slots) F(finish_tiles) F(finish_traced) F(name_pixels)
#define FXS_COMPUTE_NUMBER(entry) FXS_COMPUTE_##entry,
enum { FXS_COMPUTE_PROGRAMS_OF(FXS_COMPUTE_NUMBER) FXS_COMPUTE_PROGRAMS };

enum {
    /* buffer of the uniforms of the frame and then of each object, FXS_COMPUTE_STRIDE bytes each */
    FXS_COMPUTE_UNIFORMS,
    FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, FXS_COMPUTE_SPLATS, FXS_COMPUTE_ENTRIES,
    FXS_COMPUTE_ARGUMENTS, FXS_COMPUTE_LATER,
    FXS_COMPUTE_DOWNLOAD,
    FXS_COMPUTE_BUFFERS
};

enum { FXS_COMPUTE_STRIDE = 1024, FXS_COMPUTE_STATUS = 16, FXS_COMPUTE_EYES = 2 };

enum {
    FXS_COMPUTE_THREADS = 128, FXS_COMPUTE_ROW = 32768, FXS_COMPUTE_RECORD = 64, FXS_COMPUTE_LARGE = 8,
    FXS_COMPUTE_PAGE = 4096, FXS_COMPUTE_BLOCK = 512, FXS_COMPUTE_CLASSES = 16, FXS_COMPUTE_TILES = 64,
    FXS_COMPUTE_SPAN = 8, FXS_COMPUTE_LIST = 8, FXS_COMPUTE_DRAWN = 3,
    FXS_COMPUTE_MOMENT = 2, FXS_COMPUTE_TURNS = 1, FXS_COMPUTE_FADES = 2
};
enum { FXS_COMPUTE_VISIBLE_CHUNKS, FXS_COMPUTE_LARGES, FXS_COMPUTE_PAGES, FXS_COMPUTE_DAMAGED, FXS_COMPUTE_VISIBLE,
       FXS_COMPUTE_ENTRY_COUNT, FXS_COMPUTE_LONGEST = 9 };

typedef struct fxs_compute_frame {
    int32_t size[2], tiles[2], first[2], whole[2];
    uint32_t places, spans, merges, large_room, page_room;
    uint32_t drawn, seen, ranks, visible, records, depths, boxes, larges, spans_at, finishes, classes;
    uint32_t blocks, block_room, spare, tile_bits, cleared;
    int32_t cutoff, cut_q11;
    uint32_t format;
    int32_t background_q13[4];
    int32_t depth_bits;
    uint32_t colour, coverage, mean_depth, median_depth, id, occluder, backdrop, scratch, squares, rates, moments;
} fxs_compute_frame;

typedef struct fxs_compute_object {
    uint32_t position_q32[3][4], eye_q32[3][4];
    int32_t rotation_q30[3][4], row_q15[2][4], forward_q15[2][4], tint_q13[4];
    uint32_t near_q32[2], dilation_q30[2];
    int32_t f_q12[2], c_q12[2], slope_low_q23[2], slope_high_q23[2], edge_low_q23[2], edge_high_q23[2];
    uint32_t focal_q32;
    int32_t focal_exponent, veil_exponent, jacobian_exponent, offset_q11, degree, antialiased, orthographic;
    int32_t plane_exponent;
    uint32_t profile;
    int32_t scene_degree;
    uint32_t chunk_words, palette_entries;
    int32_t palette_step_q19;
    uint32_t scale_mantissa;
    int32_t scale_exponent, plain;
    uint32_t crop_count, keep_count, first_chunk, first_place, end_place, span, part_chunk, rows_at, part_chunks;
    uint32_t motion_at, motion_degree, motion_cut_q16, motion_flags;
    uint32_t unused[2];
    uint32_t crops[FXS_MAX_CROPS][16];
} fxs_compute_object;

#endif
