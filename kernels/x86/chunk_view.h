/* Where a chunk lies for a camera: the part of src/project.c that is done once a chunk. */
#ifndef FXS_CHUNK_VIEW_H
#define FXS_CHUNK_VIEW_H

#include "../../src/fixed.h"
#include "../../src/stage.h"

#define NEAR_Q32 858993459                       /* 0.2 */
#define DILATION_Q30 322122547                   /* 0.3 pixels^2 */
#define CENTRE_LIMIT_Q14 (1 << 30)               /* 65536 pixels */
#define EXPONENT_MAX 18                          /* sigma up to 2^18 pixels */

/* Camera coordinates = (base + m code) * 2^-16, in units of 2^(shift - 32). */
typedef struct chunk_view {
    const fxs_chunk *chunk;
    int64_t base_q16[3];
    int64_t m_q16[3][3];           /* below 2^30 */
    int shift;
    int32_t near;
} chunk_view;

static void chunk_view_init(chunk_view *cv, const fxs_view *view, const fxs_chunk *chunk)
{
    int64_t offset[3];
    uint64_t most = 0;
    for (int i = 0; i < 3; i++) {
        offset[i] = chunk->origin_q32[i] - view->position_q32[i];
        uint64_t reach = (uint64_t)(offset[i] < 0 ? -offset[i] : offset[i]) +
                         ((uint64_t)chunk->step_q32[i] * 65535 << chunk->step_shift);
        most |= reach;
    }
    int bits = most ? 64 - fxs_clz64(most) : 0;
    cv->chunk = chunk;
    cv->shift = bits > 29 ? bits - 29 : 0;       /* so |offset| + reach < 2^29 an axis */
    cv->near = (int32_t)((int64_t)NEAR_Q32 >> cv->shift);
    for (int i = 0; i < 3; i++) {
        int64_t base_q30 = 0;
        for (int j = 0; j < 3; j++) {
            int64_t r_q30 = view->rotation_q30[3 * i + j];
            base_q30 += r_q30 * (offset[j] >> cv->shift);
            cv->m_q16[i][j] = (r_q30 * chunk->step_q32[j] >> 14) * ((int64_t)1 << chunk->step_shift) >> cv->shift;
        }
        cv->base_q16[i] = base_q30 >> 14;
    }
}

/* The farthest corner of the chunk's box is in front of the near plane. */
static int chunk_in_front(const chunk_view *cv)
{
    int64_t z_q16 = cv->base_q16[2];
    for (int j = 0; j < 3; j++)
        z_q16 += cv->m_q16[2][j] > 0 ? cv->m_q16[2][j] * 65535 : 0;
    return z_q16 >> 16 > cv->near;
}

/* -2 ln(code / 255), Q11. */
static const uint16_t offset_of_code_q11[256] = {
#include "../../src/opacity.inc"
};

#endif
