/* Transforms the bounding box of a chunk of 256 Gaussians to camera space, and culls chunks. */
#include "chunk.h"

#include <fixsplat/internal/fixed.h>
#include "memory.h"

const uint16_t fxs_offset_of_code_q11[FXS_OPACITY_LAWS][256] = {
#include "opacity.inc"
};

FXS_STAGE int fxs_chunk_read(fxs_chunk *header, const fxs_scene *scene, uint32_t chunk)
{
    memcpy(header, fxs_header(scene, chunk), sizeof *header);
    fxs_chunk_turn(header);
    return fxs_chunk_valid(header) ? 0 : FXS_ERR_SCENE;
}

FXS_STAGE int fxs_node_read(fxs_node *node, const fxs_scene *scene, uint32_t i)
{
    memcpy(node, scene->nodes + (size_t)i * sizeof *node, sizeof *node);
    fxs_node_turn(node);
    return fxs_node_valid(node, scene->chunk_count, i) ? 0 : FXS_ERR_SCENE;
}

/* Returns 2^-l_q16 in Q30, for l >= 0. */
static uint32_t falling_q30(uint32_t l_q16)
{
    const uint32_t whole = l_q16 >> 16;
    return whole > 30 ? 0 : ((uint32_t)fxs_exp2_q15((int32_t)((l_q16 & 65535) >> 1)) << 15) >> whole;
}

/* Returns -log2(x_q30) in Q16, for 0 < x <= 1. */
static uint32_t octaves_below_q16(uint32_t x_q30)
{
    const int32_t below_q16 = (30 << 16) - fxs_log2_q16(x_q30);
    return below_q16 > 0 ? (uint32_t)below_q16 : 0;
}

/* The offset of a Gaussian is -2 ln(opacity), so opacity = e^(-offset / 2) = 2^(-offset / (2 ln 2)). */
FXS_STAGE uint32_t fxs_share_of_q11(uint32_t offset_q11, uint32_t share_q8)
{
    if (share_q8 == 256)
        return offset_q11;
    if (offset_q11 > FXS_FAINT_Q11)
        return FXS_FAINT_Q11 + 1;
    const uint32_t opacity_q30 = falling_q30((offset_q11 * 94548 + 2048) >> 12);       /* the factor 1 / ln 2 is 94548
                                                                                          in Q16 */
    const uint32_t clear_q30 = (1u << 30) - (opacity_q30 < FXS_OPAQUE_Q30 ? opacity_q30 : FXS_OPAQUE_Q30);
    const uint32_t share_q30 = (1u << 30) - falling_q30(octaves_below_q16(clear_q30) * share_q8 >> 8);
    const uint32_t offset = share_q30 ? (uint32_t)(((uint64_t)octaves_below_q16(share_q30) * 90852 + (1 << 20)) >> 21)
                                      : FXS_FAINT_Q11 + 1;                              /* the factor 2 ln 2 is 90852 in
                                                                                           Q16 */
    return offset > FXS_FAINT_Q11 ? FXS_FAINT_Q11 + 1 : offset;
}

static uint64_t magnitude(int64_t x)
{
    return (uint64_t)(x < 0 ? -x : x);
}

static void locate(fxs_chunk_view *cv, const fxs_stage_view *view, const fxs_chunk *chunk)
{
    int64_t offset[3];
    uint64_t most = 0;
    for (int i = 0; i < 3; i++) {
        offset[i] = chunk->origin_q32[i] - view->position_q32[i];
        most |= magnitude(offset[i]) + ((uint64_t)chunk->step_q32[i] * 65535 << chunk->step_shift);
    }
    int bits = most ? 64 - fxs_clz64(most) : 0;
    cv->scale_q16 = chunk->scale_q16 + view->grow_q16;
    cv->scale_step_q24 = chunk->scale_step_q24;
    cv->opacity_law = chunk->opacity_law;
    cv->shift = bits > 29 ? bits - 29 : 0;       /* the chunk's box then reaches less than 2^29 units from the camera on
                                                    each axis */
    cv->plane_zeros = fxs_clamp(cv->shift - view->plane_exponent, -22, 38);
    cv->plane_side = cv->plane_zeros > 7 ? 1 << (38 - cv->plane_zeros) : INT32_MAX;
    const int64_t near = view->near_q32 >> cv->shift;
    cv->near = (int32_t)(near < INT32_MAX ? near : INT32_MAX);
    for (int i = 0; i < 3; i++) {
        int64_t base_q30 = 0;
        for (int j = 0; j < 3; j++) {
            int64_t r_q30 = view->rotation_q30[3 * i + j];
            base_q30 += r_q30 * (offset[j] >> cv->shift);
            cv->m_q16[i][j] = (int32_t)((r_q30 * chunk->step_q32[j] >> 14) * ((int64_t)1 << chunk->step_shift)
                                        >> cv->shift);
        }
        cv->base_q16[i] = base_q30 >> 14;
    }
}

/* Returns an upper bound of how far a chunk's Gaussians reach sideways in camera space. In the picture, half the width
   of a Gaussian is at most 3.34 sqrt((f / z sigma |J|)^2 + 0.3). J is the Jacobian of the projection, with |J| <=
   2^jacobian_exponent. Without the dilation 0.3, and times z / f, half the width is 3.34 sigma |J|. */
static int64_t reach_across(const fxs_chunk_view *cv, const fxs_stage_view *view)
{
    int32_t log2_q16 = cv->scale_q16 + (32 - cv->shift + view->jacobian_exponent) * 65536;
    int32_t whole = -(-log2_q16 >> 16);          /* ceiling */
    if (whole > 40)
        return INT64_MAX / 4;
    return whole < 0 ? 4 : ((int64_t)fxs_exp2_q15((-log2_q16 & 65535) >> 1) << whole >> 15) * 7 / 2 + 4;
}

/* Returns the maximum of sign * (coordinate i) - slope * depth in a chunk's box in camera space. The depth is z; with
   an orthographic camera it is 2^(32 - plane_zeros). */
static int64_t farthest(const fxs_chunk_view *cv, const fxs_stage_view *view, int i, int sign, int64_t slope_q23)
{
    const int shift = 32 - 23 - cv->plane_zeros;
    int64_t across = slope_q23 * (cv->base_q16[2] >> 16) >> 23, slope_of_z_q23 = slope_q23;
    if (view->orthographic) {
        across = shift < 0 ? slope_q23 >> -shift : slope_q23 * ((int64_t)1 << shift);
        slope_of_z_q23 = 0;
    }
    int64_t sum = sign * (cv->base_q16[i] >> 16) - across + 2;
    for (int j = 0; j < 3; j++) {
        int64_t m_q16 = sign * (int64_t)cv->m_q16[i][j] - (slope_of_z_q23 * cv->m_q16[2][j] >> 23);
        sum += m_q16 > 0 ? (m_q16 * 65535 >> 16) + 1 : 0;
    }
    return sum;
}

FXS_STAGE int fxs_chunk_view_of(fxs_chunk_view *cv, const fxs_stage_view *view, const fxs_chunk *header)
{
    locate(cv, view, header);
    int64_t z_q16 = cv->base_q16[2];
    for (int j = 0; j < 3; j++)
        z_q16 += cv->m_q16[2][j] > 0 ? (int64_t)cv->m_q16[2][j] * 65535 : 0;
    if (z_q16 >> 16 <= cv->near)
        return 0;
    if (view->cutoff == FXS_CUTOFF_SQUARE)       /* the square cut-off (an option) lets Gaussians reach further than the
                                                    test below assumes */
        return 1;
    int64_t reach = reach_across(cv, view);
    for (int i = 0; i < 2; i++)                  /* a Gaussian is left of the picture if x + reach < edge_low z, with
                                                    edge_low the left edge's slope x / z */
        if (farthest(cv, view, i, 1, view->edge_low_q23[i]) + reach < 0 ||
            farthest(cv, view, i, -1, -(int64_t)view->edge_high_q23[i]) + reach < 0)
            return 0;
    return 1;
}

FXS_STAGE int fxs_chunk_view_init(fxs_chunk_view *cv, const fxs_stage_view *view, const fxs_scene *scene,
                                  uint32_t chunk)
{
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    cv->chunk = chunk;
    return error ? error : fxs_chunk_view_of(cv, view, &header);
}
