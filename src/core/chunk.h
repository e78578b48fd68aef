/* Reads chunks of a packed scene. A chunk has 256 Gaussians: a header, and rows with the Gaussians' codes. */
#ifndef FXS_CHUNK_H
#define FXS_CHUNK_H

#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>

#define FXS_DILATION_Q30 322122547u              /* dilation, 0.3 pixels^2, that is added to the variances of each
                                                    projected Gaussian */
#define FXS_DILATION_LEAST_Q30 64u               /* smallest dilation, 2^-24: limits the aspect ratio of thin splats to
                                                    4096 */
#define FXS_EXPONENT_MAX 16                      /* log2 of the largest sigma of a splat in pixels */
#define FXS_DEPTH_BIAS 32                        /* added to floor(log2 z), which is -32 to 30, so that the sum fits in
                                                    6 bits */

/* A chunk (256 Gaussians) in camera space. A Gaussian's camera coordinates are (base + m code) * 2^-16, where `code` is
   its coded position. Their unit is 2^(shift - 32), and they are below 2^30. */
typedef struct fxs_chunk_view {
    uint32_t chunk;
    int32_t scale_q16;
    uint32_t scale_step_q24, opacity_law;
    int64_t base_q16[3];
    int32_t m_q16[3][3];           /* matrix from position codes to camera coordinates; each entry is below 2^29 */
    int shift;
    int32_t plane_zeros;           /* for an orthographic camera: the picture's plane is at depth 2^(32 - plane_zeros);
                                      -22 to 38 */
    int32_t plane_side;            /* 64 times the depth of the picture's plane, saturated at 2^31 - 1 */
    int32_t near;                  /* depth of the near plane, 0 to 2^31 - 1 */
} fxs_chunk_view;

static inline const unsigned char *fxs_aligned(const unsigned char *bytes)
{
#if defined(__CUDA_ARCH__)
    bytes = (const unsigned char *)__builtin_assume_aligned(bytes, 64);
#endif
    return bytes;
}

static inline const unsigned char *fxs_header(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(chunk < scene->chunk_count
                           ? scene->chunks + (size_t)chunk * sizeof(fxs_chunk)
                           : scene->node_chunks + (size_t)(chunk - scene->chunk_count) * sizeof(fxs_chunk));
}

static inline const unsigned char *fxs_rows(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(scene->places ? scene->rows + (size_t)scene->places[chunk] * scene->chunk_bytes
                       : chunk < scene->chunk_count
                           ? scene->rows + (size_t)chunk * scene->chunk_bytes
                           : scene->node_rows + (size_t)(chunk - scene->chunk_count) * scene->chunk_bytes);
}

/* The offset, -2 ln(opacity), of each opacity code in Q11. A Gaussian with code 0 is never drawn. */
extern const uint16_t fxs_offset_of_code_q11[FXS_OPACITY_LAWS][256];

#define FXS_OPAQUE_Q30 1063004406u

/* Changes an opacity to 1 - (1 - opacity)^share. Takes and returns the offset, -2 ln(opacity). share_q8 is 1 to 4096;
   256 keeps the opacity. */
FXS_STAGE uint32_t fxs_share_of_q11(uint32_t offset_q11, uint32_t share_q8);

/* Copies a chunk's header and checks its ranges again, because the scene's bytes may have changed. Returns 0 or
   FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_read(fxs_chunk *header, const fxs_scene *scene, uint32_t chunk);

/* Copies and checks node i of the level-of-detail tree. Returns 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_node_read(fxs_node *node, const fxs_scene *scene, uint32_t i);

/* Transforms a chunk (256 Gaussians) with the given header to camera space: fills in *cv, except cv->chunk. Returns 1
   if the chunk may be visible. Returns 0 if it is culled: behind the near plane, or outside the picture by more than
   its largest Gaussian reaches. */
FXS_STAGE int fxs_chunk_view_of(fxs_chunk_view *cv, const fxs_stage_view *view, const fxs_chunk *header);

FXS_STAGE int fxs_chunk_view_init(fxs_chunk_view *cv, const fxs_stage_view *view, const fxs_scene *scene,
                                  uint32_t chunk);

void fxs_shade_list(const fxs_stage_view *view, const fxs_scene *scene, const fxs_chunk *header,
                    const unsigned char *rows, const uint32_t *indices, uint32_t count, fxs_splat *splats);

#endif
