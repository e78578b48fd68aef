/* Decides whether a camera sees a chunk of 256 Gaussians, and orders the nodes of a level-of-detail tree by a key. The
 * node with the largest key is replaced by its children first. The key is log2 of the gain of that replacement:
 *
 *     key = gain + 2 log2(f / d) + 4 min(0, log2(sigma f / d) - log2(1/2))
 *
 * The node stores gain and sigma; d is the camera's distance to the node's box, f the focal length in pixels. The last
 * term stands for blur: errors of Gaussians below the size of a pixel are hardly visible. */
#include "sight.h"

#include <fixsplat/internal/fixed.h>
#include "memory.h"

#define BLUR 4                     /* the error of Gaussians smaller than a pixel falls with the power BLUR of their
                                      size */
#define BLURRED_Q8 (-256)
#define UNLIMITED_Q8 (1 << 24)
#define DILATION_Q8 (-701)         /* log2 of 0.15 pixels^2, half the dilation of a splat, Q8 */

/* Returns log2 of the distance d from the camera to a chunk's box, as sqrt(d^2 + (diagonal / 8)^2). The diagonal of the
   box keeps the distance above 0. */
static int32_t log2_distance_q8(const fxs_stage_view *view, const fxs_chunk *chunk)
{
    uint64_t parts[6], most = 1, square = 0;
    if (view->orthographic)
        return view->plane_exponent * 256;
    for (int i = 0; i < 3; i++) {
        const int64_t reach = (int64_t)chunk->step_q32[i] * 65535 << chunk->step_shift;
        const int64_t below = chunk->origin_q32[i] - view->position_q32[i], above = -below - reach;
        parts[i] = (uint64_t)(below > 0 ? below : above > 0 ? above : 0);
        parts[3 + i] = (uint64_t)reach / 8;
        most |= parts[i] | parts[3 + i];
    }
    const int bits = 64 - fxs_clz64(most), shift = bits > 30 ? bits - 30 : 0;
    for (int i = 0; i < 6; i++)
        square += (parts[i] >> shift) * (parts[i] >> shift);
    return (fxs_log2_q16(square | 1) >> 9) + (shift - 32) * 256;
}

static int32_t log2_pixels_q8(const fxs_stage_view *view, const fxs_chunk *chunk)
{
    const int64_t focal_q12 = view->fx_q12 > view->fy_q12 ? view->fx_q12 : view->fy_q12;
    return (fxs_log2_q16((uint64_t)focal_q12) >> 8) - 12 * 256 - log2_distance_q8(view, chunk);
}

/* Returns 2^x in Q16. x is clamped to -16..20. */
static uint64_t exp2_q16(int32_t x_q8)
{
    const int32_t x = fxs_clamp(x_q8, -16 * 256, 20 * 256), below_q15 = ((256 - (x & 255)) & 255) << 7;
    const int32_t whole = (x >> 8) + (below_q15 ? 1 : 0);
    const uint64_t mantissa_q16 = (uint64_t)fxs_exp2_q15(below_q15) << 1;
    return whole < 0 ? mantissa_q16 >> -whole : mantissa_q16 << whole;
}

/* Returns log2 of the growth that a distant node of the level-of-detail tree needs, (area + 0.15 swell) / (area +
   0.15). swell is the opacity sum of the leaves below the node, divided by the node's own. The dilation of splats by
   0.3 pixels^2 makes many small Gaussians cover more than a node's few coarse ones. Half the dilation is used, because
   small Gaussians hide each other. Antialiased scenes already compensate for the dilation. */
static int32_t swell_of(const fxs_stage_view *view, const fxs_node *node, int32_t pixels_q8)
{
    const int32_t dilation_q8 = DILATION_Q8 - 2 * pixels_q8 - node->area_q8;
    const uint64_t swollen = ((uint64_t)1 << 16) + exp2_q16(dilation_q8 + node->swell_q8);
    const int32_t swell_q16 = fxs_log2_q16(swollen) - fxs_log2_q16(((uint64_t)1 << 16) + exp2_q16(dilation_q8));
    return view->antialiased ? 0 : fxs_clamp(swell_q16 >> 8, 0, FXS_SWELL_SEEN_Q8);
}

static fxs_sight sight_of_node(const fxs_stage_view *view, const fxs_chunk *header, const fxs_node *node,
                               uint32_t detail_q8)
{
    const int32_t pixels_q8 = log2_pixels_q8(view, header), size_q8 = node->size_q8 + pixels_q8;
    return (fxs_sight){node->gain_q8 + 2 * pixels_q8 + BLUR * fxs_min(0, size_q8 - BLURRED_Q8),
                       detail_q8 ? size_q8 - ((fxs_log2_q16(detail_q8) >> 8) - 8 * 256) : UNLIMITED_Q8,
                       swell_of(view, node, pixels_q8)};
}

FXS_STAGE fxs_drawn fxs_drawn_of(uint32_t chunk, uint32_t share_q8, int32_t swell_q8)
{
    const uint32_t depth_q8 = (uint32_t)(exp2_q16(swell_q8 / 2) >> 8);
    return (fxs_drawn){chunk, (uint16_t)((share_q8 * depth_q8 + 255) >> 8), (uint16_t)(swell_q8 / FXS_SWELL_OF_SIGMA),
                       {{0, 0, 0}, 0, 0}};
}

FXS_STAGE int fxs_see(fxs_sight *out, const fxs_stage_view *views, uint32_t eyes, const fxs_scene *scene,
                      uint32_t chunk, uint32_t detail_q8)
{
    const int is_node = chunk >= scene->chunk_count;
    fxs_chunk_view cv;
    fxs_chunk header;
    fxs_node node;
    int seen = 0, error = fxs_chunk_read(&header, scene, chunk);
    if (!error && is_node)
        error = fxs_node_read(&node, scene, chunk - scene->chunk_count);
    *out = (fxs_sight){0, 0, 0};
    for (uint32_t eye = 0; eye < eyes && !error; eye++)
        if (fxs_chunk_view_of(&cv, &views[eye], &header)) {
            const fxs_sight sight = is_node ? sight_of_node(&views[eye], &header, &node, detail_q8) : *out;
            *out = !seen || sight.key_q8 > out->key_q8 ? sight : *out;
            seen = 1;
        }
    return error ? error : seen;
}
