/* Converts a scene's up direction and start view between doubles and the fields of the packed scene's header. The up
 * direction is stored as two 15-bit codes by the octahedral map. */
#include <fixsplat/scene.h>

#include <math.h>
#include <string.h>

#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/start.h>

#define FARTHEST 0x1p28
#define UP_ONE 16383
#define UP_BITS 0x7FFFu

static double sign_of(double x)
{
    return x < 0 ? -1 : 1;
}

/* Folds the lower half of the octahedron |x| + |y| + |z| = 1 outwards, a step of the octahedral map. The function is
   its own inverse. */
static void fold(double *x, double *y)
{
    const double old = *x;
    *x = (1 - fabs(*y)) * sign_of(old);
    *y = (1 - fabs(old)) * sign_of(*y);
}

/* Codes an up direction by the octahedral map (Cigolle et al. 2014, A Survey of Efficient Representations for
   Independent Unit Vectors). */
static uint32_t code_of_up(const double up[3])
{
    const double sum = fabs(up[0]) + fabs(up[1]) + fabs(up[2]);
    if (!(sum > 0 && isfinite(sum)))
        return 0;
    double x = up[0] / sum, y = up[1] / sum;
    if (up[2] < 0)
        fold(&x, &y);
    const uint32_t u = (uint32_t)(int32_t)floor(UP_ONE * x + 0.5), v = (uint32_t)(int32_t)floor(UP_ONE * y + 0.5);
    return FXS_PACKED_UP | (u & UP_BITS) << 1 | (v & UP_BITS) << 16;
}

static double part_of_code(uint32_t flags, int bit)
{
    const int32_t code = (int32_t)(flags >> bit & UP_BITS);
    return (double)(code > UP_ONE ? code - (int32_t)UP_BITS - 1 : code) / UP_ONE;
}

static void up_of_code(double up[3], uint32_t flags)
{
    double x = part_of_code(flags, 1), y = part_of_code(flags, 16);
    const double z = 1 - fabs(x) - fabs(y);
    memset(up, 0, 3 * sizeof *up);
    if (!(flags & FXS_PACKED_UP) || x < -1 || y < -1)
        return;
    if (z < 0)
        fold(&x, &y);
    const double length = sqrt(x * x + y * y + z * z);
    up[0] = x / length;
    up[1] = y / length;
    up[2] = z / length;
}

static int is_view(const fxs_start *s)
{
    double square = 0;
    int is_near = s->tangent >= 0x1p-24 && s->tangent <= FXS_START_TANGENT_MOST;
    for (int i = 0; i < 4; i++)
        square += s->rotation[i] * s->rotation[i];
    for (int i = 0; i < 3; i++)
        is_near = is_near && fabs(s->position[i]) <= FARTHEST;
    return is_near && fabs(square - 1) < 1e-3;
}

void fxs_start_of(fxs_start *start, const void *data)
{
    fxs_packed_header h;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    up_of_code(start->up, h.flags);
    start->tangent = h.start_tangent_q24 * 0x1p-24;
    for (int i = 0; i < 3; i++)
        start->position[i] = (double)h.start_q32[i] * 0x1p-32;
    for (int i = 0; i < 4; i++)
        start->rotation[i] = h.start_rotation_q30[i] * 0x1p-30;
    if (!is_view(start))
        memset(&start->tangent, 0, sizeof *start - offsetof(fxs_start, tangent));
}

void fxs_start_to(void *data, const fxs_start *start)
{
    fxs_packed_header h;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    const int has_view = is_view(start);
    h.flags = (h.flags & FXS_PACKED_ANTIALIASED) | code_of_up(start->up);
    h.start_tangent_q24 = has_view ? (uint32_t)floor(start->tangent * 0x1p24 + 0.5) : 0;
    for (int i = 0; i < 3; i++)
        h.start_q32[i] = has_view ? (int64_t)floor(start->position[i] * 0x1p32 + 0.5) : 0;
    for (int i = 0; i < 4; i++)
        h.start_rotation_q30[i] = has_view ? (int32_t)floor(start->rotation[i] * 0x1p30 + 0.5) : 0;
    fxs_packed_header_turn(&h);
    memcpy(data, &h, sizeof h);
}

void fxs_inner_box(const void *data, double low[3], double high[3])
{
    fxs_packed_header h;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    for (int i = 0; i < 3; i++) {
        low[i] = (double)h.inner_low_q32[i] * 0x1p-32;
        high[i] = (double)h.inner_high_q32[i] * 0x1p-32;
    }
}
