/* Declares the versions of the rendering stages for each instruction set. FXS_BLEND(avx2) expands to the function head
 * of fxs_blend_avx2, to be followed by a body or a semicolon. Each version gives the same results as the C version,
 * declared in src/include/fixsplat/internal/stage.h. */
#ifndef FXS_STAGES_H
#define FXS_STAGES_H

#include "src/core/chunk.h"

#define FXS_JOIN(stage, isa) fxs_##stage##_##isa
#define FXS_STAGE_OF(stage, isa) FXS_JOIN(stage, isa)

#define FXS_ANIMATE(isa) void FXS_STAGE_OF(animate, isa)(const fxs_scene *scene, const fxs_motion_rows *motion, \
    const fxs_moment *moment, uint32_t scale_step_q24, const unsigned char *rows, unsigned char *out)
#define FXS_PROJECT(isa) int32_t FXS_STAGE_OF(project, isa)(const fxs_stage_view *view, const fxs_scene *scene, \
    uint32_t chunk, fxs_splat *splats, fxs_bounds *bounds, uint32_t *indices, uint32_t *depths)
#define FXS_SHADE(isa) int FXS_STAGE_OF(shade, isa)(const fxs_stage_view *view, const fxs_scene *scene, \
    uint32_t chunk, const uint32_t *indices, uint32_t count, fxs_splat *splats)
#define FXS_BIN(isa) void FXS_STAGE_OF(bin, isa)(const fxs_stage_view *view, const fxs_splat *splats, \
    const fxs_bounds *bounds, uint32_t count, fxs_box *boxes)
#define FXS_SPANS(isa) void FXS_STAGE_OF(spans, isa)(const fxs_stage_view *view, const fxs_splat *splat, \
    const fxs_bounds *bounds, int32_t row, int32_t rows, fxs_span *spans)
#define FXS_NOTE(isa) uint32_t FXS_STAGE_OF(note, isa)(const fxs_stage_view *view, const fxs_box *boxes, \
    uint32_t first, uint32_t count, uint32_t *macros, uint32_t *listed)
#define FXS_LIST(isa) uint32_t FXS_STAGE_OF(list, isa)(const fxs_key *keys, uint32_t count, uint32_t tile, \
    uint32_t *entries)
#define FXS_SORT(isa) void FXS_STAGE_OF(sort, isa)(fxs_key *keys, fxs_key *spare, uint32_t count)
#define FXS_BLEND(isa) void FXS_STAGE_OF(blend, isa)(const fxs_stage_view *view, int32_t x, int32_t y, \
    const fxs_splat *splats, const uint32_t *entries, uint32_t count, fxs_tile *tile)
#define FXS_TRACE(isa) void FXS_STAGE_OF(trace, isa)(const fxs_stage_view *view, int32_t x, int32_t y, \
    const fxs_splat *splats, const uint32_t *entries, const int16_t *depths_q15, uint32_t first, uint32_t end, \
    fxs_tile *tile, fxs_trace *trace)
#define FXS_RESOLVE(isa) void FXS_STAGE_OF(resolve, isa)(const fxs_options *options, enum fxs_format format, \
    const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels, ptrdiff_t stride)

/* Lists of the functions of the rendering stages: X(macro of the function head, macro of the stage, name in
   fxs_kernels, instruction set). */
#define FXS_VECTOR_STAGES(X, isa) \
    X(FXS_ANIMATE, FXS_PROJECT, animate, isa) X(FXS_PROJECT, FXS_PROJECT, project, isa) \
    X(FXS_SHADE, FXS_SHADE, shade, isa) \
    X(FXS_BIN, FXS_BIN, bin, isa) X(FXS_SPANS, FXS_BIN, spans, isa) X(FXS_NOTE, FXS_BIN, note, isa) \
    X(FXS_LIST, FXS_BIN, list, isa) X(FXS_BLEND, FXS_BLEND, blend, isa) X(FXS_TRACE, FXS_BLEND, trace, isa)
#define FXS_SORT_STAGE(X, isa) X(FXS_SORT, FXS_SORT, sort, isa)
#define FXS_BLEND_STAGE(X, isa) X(FXS_BLEND, FXS_BLEND, blend, isa)
#define FXS_RESOLVE_STAGE(X, isa) X(FXS_RESOLVE, FXS_RESOLVE, resolve, isa)

#endif
