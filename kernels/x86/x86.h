/* The x86 versions of the stages; each has the prototype and the meaning of its row in src/stage.h. */
#ifndef FXS_X86_H
#define FXS_X86_H

#include "../../src/chunk.h"

#define FXS_X86_PROJECT(isa) int32_t fxs_project_##isa(const fxs_view *view, const fxs_scene *scene, \
    uint32_t chunk, fxs_splat *splats, fxs_bounds *bounds, uint32_t *indices, uint32_t *depths)
#define FXS_X86_SHADE(isa) int fxs_shade_##isa(const fxs_view *view, const fxs_scene *scene, \
    uint32_t chunk, const uint32_t *indices, uint32_t count, fxs_splat *splats)
#define FXS_X86_BIN(isa) void fxs_bin_##isa(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, \
    uint32_t count, fxs_box *boxes)
#define FXS_X86_BLEND(isa) void fxs_blend_##isa(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, \
    const uint32_t *entries, uint32_t count, fxs_tile *tile)
#define FXS_X86_RESOLVE(isa) void fxs_resolve_##isa(const fxs_options *options, enum fxs_format format, \
    const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels, ptrdiff_t stride)

FXS_X86_PROJECT(avx2);
FXS_X86_PROJECT(avx512);
FXS_X86_SHADE(avx2);
FXS_X86_SHADE(avx512);
FXS_X86_BIN(avx2);
FXS_X86_BIN(avx512);
FXS_X86_BLEND(sse41);
FXS_X86_BLEND(avx2);
FXS_X86_BLEND(avx512);
FXS_X86_RESOLVE(sse41);
FXS_X86_RESOLVE(avx2);
FXS_X86_RESOLVE(avx512);

#endif
