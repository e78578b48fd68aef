/* AArch64 NEON versions of the stages: what src/stage.h says of the table's functions holds for these. */
#ifndef FXS_ARM_H
#define FXS_ARM_H

#include "../../src/chunk.h"

int32_t fxs_project_neon(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                         fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);
int fxs_shade_neon(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices, uint32_t count,
                   fxs_splat *splats);
void fxs_bin_neon(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
                  fxs_box *boxes);
void fxs_blend_neon(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                    uint32_t count, fxs_tile *tile);
void fxs_resolve_neon(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                      int32_t rows, unsigned char *pixels, ptrdiff_t stride);

#endif
