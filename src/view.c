/* The camera, once a frame: everything of the projection that does not depend on the Gaussian. */
#include "fixed.h"
#include "memory.h"
#include "stage.h"

#define POSITION_LIMIT_Q32 ((int64_t)1 << 60)   /* 2^28 units */
#define NEAR_LEAST_Q32 ((int64_t)1 << 12)       /* 2^-20 units */
#define NEAR_MOST_Q32 ((int64_t)1 << 60)
#define NEAR_DEFAULT_Q32 858993459              /* 0.2 */
#define ONE_Q60 ((int64_t)1 << 60)

static int64_t dot_q60(const int32_t a_q30[3], const int32_t b_q30[3])
{
    return (int64_t)a_q30[0] * b_q30[0] + (int64_t)a_q30[1] * b_q30[1] + (int64_t)a_q30[2] * b_q30[2];
}

/* Rows of length 1 and at right angles, within 2^-10, and right-handed: row0 x row1 = row2. */
static int is_rotation(const int32_t m_q30[9])
{
    const int64_t tolerance = ONE_Q60 >> 10;
    for (int i = 0; i < 9; i++)
        if (m_q30[i] < -(1 << 30) - (1 << 20) || m_q30[i] > (1 << 30) + (1 << 20))
            return 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            int64_t error = dot_q60(m_q30 + 3 * i, m_q30 + 3 * j) - (i == j ? ONE_Q60 : 0);
            if (error < -tolerance || error > tolerance)
                return 0;
        }
    int64_t handed = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        handed += (((int64_t)m_q30[j] * m_q30[3 + k] - (int64_t)m_q30[k] * m_q30[3 + j]) >> 30) * m_q30[6 + i];
    }
    return handed > 0;
}

static int check_camera(const fxs_camera *camera)
{
    if (camera->width < 1 || camera->height < 1 || camera->width > FXS_MAX_SIZE || camera->height > FXS_MAX_SIZE)
        return FXS_ERR_SIZE;
    if (camera->fx_q12 <= 0 || camera->fy_q12 <= 0 || !is_rotation(camera->rotation_q30))
        return FXS_ERR_CAMERA;
    for (int i = 0; i < 3; i++)
        if (camera->position_q32[i] < -POSITION_LIMIT_Q32 || camera->position_q32[i] > POSITION_LIMIT_Q32)
            return FXS_ERR_CAMERA;
    const int64_t near_q32 = camera->near_q32;
    return !near_q32 || (near_q32 >= NEAR_LEAST_Q32 && near_q32 <= NEAR_MOST_Q32) ? 0 : FXS_ERR_CAMERA;
}

static int32_t cut_slope(int64_t slope_q23, int64_t most)
{
    return (int32_t)(slope_q23 < -most ? -most : slope_q23 > most ? most : slope_q23);
}

/* The picture's edges, a tile and the reach of the dilation (3.34 sqrt(0.3) < 2) out. */
static void edge_slopes(int64_t size, int64_t f_q12, int64_t c_q12, int32_t *low_q23, int32_t *high_q23)
{
    *low_q23 = cut_slope(-((c_q12 + (18 << 12)) * (1 << 23)) / f_q12, (int64_t)64 << 23);
    *high_q23 = cut_slope((((size + 18) << 12) - c_q12) * (1 << 23) / f_q12, (int64_t)64 << 23);
}

/* The field of view plus 30 % (Kerbl et al. 2023, code; for any principal point as in gsplat), as slopes x/z:
   -c / f - 0.3 size / (2 f) and (size - c) / f + 0.3 size / (2 f). Cut to +-60. */
static void slope_limits(int64_t size, int64_t f_q12, int64_t c_q12, int32_t *low_q23, int32_t *high_q23)
{
    const int64_t most = (int64_t)60 << 23;
    int64_t margin = size * 614;                     /* 0.15 size, Q12 */
    int64_t low = -((c_q12 + margin) * (1 << 23)) / f_q12;
    int64_t high = (((size << 12) - c_q12 + margin) * (1 << 23)) / f_q12;
    *low_q23 = cut_slope(low, most);
    *high_q23 = cut_slope(high, most);
}

/* The least exponent with which 3.5 (2^exponent + 1) pixels reach the picture from a centre 64 times as far off the
   axis as away, or 65536 pixels from the first pixel; at least 7, and a 16th of the picture. */
static int32_t veil_exponent(const fxs_camera *camera)
{
    const int64_t f_q12[2] = {camera->fx_q12, camera->fy_q12}, c_q12[2] = {camera->cx_q12, camera->cy_q12};
    const int64_t size_q12[2] = {(int64_t)camera->width << 12, (int64_t)camera->height << 12};
    int32_t exponent = 7;
    int64_t room_q12 = (int64_t)65536 << 12;
    for (int i = 0; i < 2; i++) {
        const int64_t room[3] = {64 * f_q12[i] - c_q12[i], 64 * f_q12[i] + c_q12[i] - size_q12[i],
                                 ((int64_t)65536 << 12) - size_q12[i]};
        for (int k = 0; k < 3; k++)
            room_q12 = room[k] < room_q12 ? room[k] : room_q12;
    }
    while ((((int64_t)7 << exponent) + 7) * 2048 < room_q12 || camera->width > 16 << exponent ||
           camera->height > 16 << exponent)
        exponent++;
    return exponent;
}

/* ceil(log2(sqrt(1 + max(slope)^2))) */
static int32_t jacobian_exponent(const fxs_view *view)
{
    int64_t most = 1 << 23;
    for (int i = 0; i < 2; i++) {
        most = -view->slope_low_q23[i] > most ? -view->slope_low_q23[i] : most;
        most = view->slope_high_q23[i] > most ? view->slope_high_q23[i] : most;
    }
    int32_t exponent = 0;
    uint64_t length_q46 = (uint64_t)(most * most) + ((uint64_t)1 << 46);
    while (length_q46 > (uint64_t)1 << (46 + 2 * exponent))
        exponent++;
    return exponent;
}

static void jacobian_rows(fxs_view *view, const fxs_camera *camera)
{
    int64_t focal_q12[2] = {camera->fx_q12, camera->fy_q12};
    uint32_t focal = (uint32_t)(focal_q12[0] > focal_q12[1] ? focal_q12[0] : focal_q12[1]);
    int zeros = fxs_clz32(focal);
    view->focal_q32 = focal << zeros;
    view->focal_exponent = 20 - zeros;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            int64_t row = camera->rotation_q30[3 * i + k] * focal_q12[i] / focal;
            int64_t forward = camera->rotation_q30[6 + k] * focal_q12[i] / focal;
            view->row_q15[i][k] = (int32_t)fxs_round_shift(row, 15 + view->jacobian_exponent);
            view->forward_q15[i][k] = (int32_t)fxs_round_shift(forward, 15);
        }
}

int fxs_view_init(fxs_view *view, const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options)
{
    int error = check_camera(camera);
    if (error)
        return error;
    view->width = camera->width;
    view->height = camera->height;
    view->tiles_x = (camera->width + FXS_TILE - 1) / FXS_TILE;
    view->tiles_y = (camera->height + FXS_TILE - 1) / FXS_TILE;
    memcpy(view->position_q32, camera->position_q32, sizeof view->position_q32);
    memcpy(view->rotation_q30, camera->rotation_q30, sizeof view->rotation_q30);
    view->near_q32 = camera->near_q32 ? camera->near_q32 : NEAR_DEFAULT_Q32;
    view->fx_q12 = camera->fx_q12;
    view->fy_q12 = camera->fy_q12;
    view->cx_q12 = camera->cx_q12;
    view->cy_q12 = camera->cy_q12;
    slope_limits(camera->width, camera->fx_q12, camera->cx_q12, &view->slope_low_q23[0], &view->slope_high_q23[0]);
    slope_limits(camera->height, camera->fy_q12, camera->cy_q12, &view->slope_low_q23[1], &view->slope_high_q23[1]);
    edge_slopes(camera->width, camera->fx_q12, camera->cx_q12, &view->edge_low_q23[0], &view->edge_high_q23[0]);
    edge_slopes(camera->height, camera->fy_q12, camera->cy_q12, &view->edge_low_q23[1], &view->edge_high_q23[1]);
    view->veil_exponent = veil_exponent(camera);
    view->jacobian_exponent = jacobian_exponent(view);
    jacobian_rows(view, camera);
    view->square = options->cutoff == FXS_CUTOFF_SQUARE;
    view->cut_q11 = view->square ? FXS_LEVEL_MAX_Q11 : FXS_CUT_Q11;
    view->sh_degree = options->sh_degree < scene->sh_degree ? options->sh_degree : scene->sh_degree;
    view->antialiased = scene->antialiased;
    return 0;
}
