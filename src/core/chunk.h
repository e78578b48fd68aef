/* A chunk of a packed scene, for the stages that read it: project and shade. */
#ifndef FXS_CHUNK_H
#define FXS_CHUNK_H

#include <fixsplat/packed.h>
#include <fixsplat/stage.h>

/* Constants of project. */
#define FXS_DILATION_Q30 322122547u              /* 0.3 pixels^2 */
#define FXS_DILATION_LEAST_Q30 64u               /* 2^-24: no needle is thinner than 1 in 4096, see docs/numbers.md */
#define FXS_EXPONENT_MAX 16                      /* sigma up to 65536 pixels; what is larger is a veil */
#define FXS_DEPTH_BIAS 32                        /* floor(log2 z), -32 to 30, plus this fits in 6 bits */

/* Where a chunk lies for a camera: camera coordinates = (base + m code) * 2^-16, in units of 2^(shift - 32), each
   below 2^30. */
typedef struct fxs_chunk_view {
    uint32_t chunk;
    int32_t scale_q16;             /* of its header, and what sigmas grow by */
    uint32_t scale_step_q24, opacity_law;
    int64_t base_q16[3];
    int32_t m_q16[3][3];           /* below 2^29 */
    int shift;
    int32_t plane_zeros;           /* an orthographic view's plane lies at 2^(32 - plane_zeros) units; -22 to 38 */
    int32_t plane_side;            /* 64 times that, cut to 2^31 - 1: x and y from there on are off the axis */
    int32_t near;                  /* the near plane's depth, 0 to 2^31 - 1; only what is beyond it is drawn */
} fxs_chunk_view;

/* Of a packed scene. */
static inline const unsigned char *fxs_aligned(const unsigned char *bytes)
{
#if defined(__CUDA_ARCH__)
    bytes = (const unsigned char *)__builtin_assume_aligned(bytes, 64);   /* else nvcc reads single bytes */
#endif
    return bytes;
}

/* The header of a chunk, as it lies in the packed scene; aligned to 64. */
static inline const unsigned char *fxs_header(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(chunk < scene->chunk_count
                           ? scene->chunks + (size_t)chunk * sizeof(fxs_chunk)
                           : scene->node_chunks + (size_t)(chunk - scene->chunk_count) * sizeof(fxs_chunk));
}

/* The rows of a chunk, aligned to 64. */
static inline const unsigned char *fxs_rows(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(scene->places ? scene->rows + (size_t)scene->places[chunk] * scene->chunk_bytes
                       : chunk < scene->chunk_count
                           ? scene->rows + (size_t)chunk * scene->chunk_bytes
                           : scene->node_rows + (size_t)(chunk - scene->chunk_count) * scene->chunk_bytes);
}

/* -2 ln(opacity of a code) under each law (packed.h), Q11; code 0 is never drawn. */
extern const uint16_t fxs_offset_of_code_q11[FXS_OPACITY_LAWS][256];

#define FXS_OPAQUE_Q30 1063004406u               /* 0.99, at which an opacity is capped of which a share is drawn */

/* The offset of an opacity of which a share is drawn, 1 to 4096 of 256 of the optical depth: 1 - (1 - opacity)^share;
   at most FXS_FAINT_Q11 + 1. With 256 it is the offset as it was. */
FXS_STAGE uint32_t fxs_share_of_q11(uint32_t offset_q11, uint32_t share_q8);

/* Copies a chunk's header and checks its ranges, on which project and shade rely: the scene's bytes may have changed
   since it was opened. Returns 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_read(fxs_chunk *header, const fxs_scene *scene, uint32_t chunk);

/* Copies node i of a scene's tree and checks it, like a chunk's header. */
FXS_STAGE int fxs_node_read(fxs_node *node, const fxs_scene *scene, uint32_t i);

/* Finds where a chunk lies whose header was read; *cv but for its number. Returns 1, or 0 where nothing of it can be
   seen (behind the near plane, beside the picture by more than its largest Gaussian reaches, or in the hidden part). */
FXS_STAGE int fxs_chunk_view_of(fxs_chunk_view *cv, const fxs_view *view, const fxs_chunk *header);

/* The same for a chunk that is to be read; or FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_view_init(fxs_chunk_view *cv, const fxs_view *view, const fxs_scene *scene, uint32_t chunk);

/* fxs_shade_c with a header that was read and the chunk's rows. */
void fxs_shade_list(const fxs_view *view, const fxs_scene *scene, const fxs_chunk *header, const unsigned char *rows,
                    const uint32_t *indices, uint32_t count, fxs_splat *splats);

#endif
