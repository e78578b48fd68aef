/* Access to a chunk of a packed scene, for the stages project and shade. */
#ifndef FXS_CHUNK_H
#define FXS_CHUNK_H

#include <fixsplat/packed.h>
#include <fixsplat/stage.h>

/* Constants of project. */
#define FXS_DILATION_Q30 322122547u              /* 0.3 pixels^2 */
#define FXS_DILATION_LEAST_Q30 64u               /* 2^-24: limits needles to an aspect of 4096, see docs/numbers.md */
#define FXS_EXPONENT_MAX 16                      /* sigma up to 65536 pixels; larger Gaussians are veils */
#define FXS_DEPTH_BIAS 32                        /* floor(log2 z), -32 to 30, plus this fits in 6 bits */

/* A chunk as a camera sees it. Camera coordinates = (base + m code) * 2^-16, in units of 2^(shift - 32); each is below
   2^30. */
typedef struct fxs_chunk_view {
    uint32_t chunk;
    int32_t scale_q16;             /* header's scale plus view->grow_q16 */
    uint32_t scale_step_q24, opacity_law;
    int64_t base_q16[3];
    int32_t m_q16[3][3];           /* each below 2^29 */
    int shift;
    int32_t plane_zeros;           /* orthographic: the plane is at 2^(32 - plane_zeros) units; -22 to 38 */
    int32_t plane_side;            /* 64 times the plane's depth, cut to 2^31 - 1; from this |x| or |y| on a point
                                      is off axis */
    int32_t near;                  /* depth of the near plane, 0 to 2^31 - 1; only points beyond are drawn */
} fxs_chunk_view;

/* Tells the compiler that bytes of a packed scene are aligned to 64. */
static inline const unsigned char *fxs_aligned(const unsigned char *bytes)
{
#if defined(__CUDA_ARCH__)
    bytes = (const unsigned char *)__builtin_assume_aligned(bytes, 64);   /* without it nvcc loads single bytes */
#endif
    return bytes;
}

/* A chunk's header in the packed scene; aligned to 64. */
static inline const unsigned char *fxs_header(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(chunk < scene->chunk_count
                           ? scene->chunks + (size_t)chunk * sizeof(fxs_chunk)
                           : scene->node_chunks + (size_t)(chunk - scene->chunk_count) * sizeof(fxs_chunk));
}

/* A chunk's rows; aligned to 64. */
static inline const unsigned char *fxs_rows(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(scene->places ? scene->rows + (size_t)scene->places[chunk] * scene->chunk_bytes
                       : chunk < scene->chunk_count
                           ? scene->rows + (size_t)chunk * scene->chunk_bytes
                           : scene->node_rows + (size_t)(chunk - scene->chunk_count) * scene->chunk_bytes);
}

/* -2 ln(opacity of a code) under each law (packed.h), Q11. Code 0 is never drawn. */
extern const uint16_t fxs_offset_of_code_q11[FXS_OPACITY_LAWS][256];

#define FXS_OPAQUE_Q30 1063004406u               /* 0.99, cap of an opacity before a share of it is taken */

/* Offset of an opacity after a share is taken: 1 - (1 - opacity)^share. share_q8 is 1 to 4096 in units of 1/256 of the
   optical depth; 256 returns the offset unchanged. At most FXS_FAINT_Q11 + 1. */
FXS_STAGE uint32_t fxs_share_of_q11(uint32_t offset_q11, uint32_t share_q8);

/* Copies a chunk's header and checks the ranges that project and shade rely on, because the scene's bytes may have
   changed since fxs_scene_open. Returns 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_read(fxs_chunk *header, const fxs_scene *scene, uint32_t chunk);

/* Copies and checks node i of a scene's tree. Returns 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_node_read(fxs_node *node, const fxs_scene *scene, uint32_t i);

/* Fills in *cv, except cv->chunk, from a header that is already read. Returns 1 if the chunk may be visible. Returns 0
   if it is culled: behind the near plane, or outside the picture by more than its largest Gaussian reaches. */
FXS_STAGE int fxs_chunk_view_of(fxs_chunk_view *cv, const fxs_view *view, const fxs_chunk *header);

/* Reads a chunk's header, then fxs_chunk_view_of; sets cv->chunk too. May also return FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_view_init(fxs_chunk_view *cv, const fxs_view *view, const fxs_scene *scene, uint32_t chunk);

/* Like fxs_shade_c, but takes the chunk's header, already read, and the chunk's rows. */
void fxs_shade_list(const fxs_view *view, const fxs_scene *scene, const fxs_chunk *header, const unsigned char *rows,
                    const uint32_t *indices, uint32_t count, fxs_splat *splats);

#endif
