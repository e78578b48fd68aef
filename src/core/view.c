/* Computes the parts of the projection that are equal for all Gaussians, once per frame and object. */
#include "view.h"

#include <fixsplat/internal/fixed.h>
#include "memory.h"

#define POSITION_LIMIT_Q32 ((int64_t)1 << 60)
#define NEAR_LEAST_Q32 ((int64_t)1 << 12)
#define NEAR_MOST_Q32 ((int64_t)1 << 60)
#define NEAR_DEFAULT_Q32 858993459              /* default distance of the near plane, 0.2 units */
#define ONE_Q60 ((int64_t)1 << 60)
#define ONE_Q30 ((int64_t)1 << 30)

static int64_t dot_q60(const int32_t a_q30[3], const int32_t b_q30[3])
{
    return (int64_t)a_q30[0] * b_q30[0] + (int64_t)a_q30[1] * b_q30[1] + (int64_t)a_q30[2] * b_q30[2];
}

FXS_STAGE int fxs_is_rotation(const int32_t m_q30[9])
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

static int is_window(const fxs_camera *camera)
{
    return camera->whole_width || camera->whole_height;
}

static int check_window(const fxs_camera *camera)
{
    const int32_t whole[2] = {camera->whole_width, camera->whole_height}, own[2] = {camera->width, camera->height};
    const int32_t first[2] = {camera->whole_x, camera->whole_y};
    for (int i = 0; i < 2; i++)
        if (whole[i] < own[i] || whole[i] > FXS_MAX_SIZE || first[i] < 0 || first[i] > whole[i] - own[i])
            return FXS_ERR_SIZE;
    return 0;
}

static int check_camera(const fxs_camera *camera)
{
    if (camera->width < 1 || camera->height < 1 || camera->width > FXS_MAX_SIZE || camera->height > FXS_MAX_SIZE ||
        (is_window(camera) && check_window(camera)))
        return FXS_ERR_SIZE;
    if (camera->fx_q12 <= 0 || camera->fy_q12 <= 0 || !fxs_is_rotation(camera->rotation_q30) ||
        (camera->projection != FXS_PERSPECTIVE && camera->projection != FXS_ORTHOGRAPHIC))
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

/* Computes the slopes x / z of the picture's left and right (or upper and lower) edges. The edges are moved outwards by
   18 pixels: a tile, and the reach of the dilation, 3.34 sqrt(0.3) < 2. */
static void edge_slopes(int64_t size, int64_t f_q12, int64_t c_q12, int32_t *low_q23, int32_t *high_q23)
{
    *low_q23 = cut_slope(-((c_q12 + (18 << 12)) * (1 << 23)) / f_q12, (int64_t)64 << 23);
    *high_q23 = cut_slope((((size + 18) << 12) - c_q12) * (1 << 23) / f_q12, (int64_t)64 << 23);
}

/* Computes the range of slopes x / z to which the Jacobian's centre is clamped: the field of view plus 30 %. The range
   is -c / f - 0.3 size / (2 f) to (size - c) / f + 0.3 size / (2 f), cut to +-60. The code of Kerbl et al. 2023 does
   this for a central principal point, gsplat for any. */
static void slope_limits(int64_t size, int64_t f_q12, int64_t c_q12, int32_t *low_q23, int32_t *high_q23)
{
    const int64_t most = (int64_t)60 << 23;
    int64_t margin = size * 614;
    int64_t low = -((c_q12 + margin) * (1 << 23)) / f_q12;
    int64_t high = (((size << 12) - c_q12 + margin) * (1 << 23)) / f_q12;
    *low_q23 = cut_slope(low, most);
    *high_q23 = cut_slope(high, most);
}

/* A Gaussian's centre is out of range if its slope exceeds 64 or it is more than 65536 pixels away. Returns log2 of the
   smallest sigma in pixels with which such a Gaussian may reach the picture. The radius is 3.5 (2^exponent + 1)
   pixels. */
static int32_t veil_exponent(const fxs_stage_view *view, const int64_t size[2], const int64_t c_q12[2])
{
    const int64_t f_q12[2] = {view->fx_q12, view->fy_q12};
    int32_t exponent = 7;
    int64_t room_q12 = (int64_t)65536 << 12;
    for (int i = 0; i < 2; i++) {
        const int64_t size_q12 = size[i] << 12;
        const int64_t room[3] = {64 * f_q12[i] - c_q12[i], 64 * f_q12[i] + c_q12[i] - size_q12,
                                 ((int64_t)65536 << 12) - size_q12};
        for (int k = 0; k < 3; k++)
            room_q12 = room[k] < room_q12 ? room[k] : room_q12;
    }
    while ((((int64_t)7 << exponent) + 7) * 2048 < room_q12 || size[0] > 16 << exponent ||
           size[1] > 16 << exponent)
        exponent++;
    return exponent;
}

/* Returns e so that 2^e bounds the norm of the Jacobian, divided by f / z: ceil(log2(sqrt(1 + max(slope)^2))). */
static int32_t jacobian_exponent(const fxs_stage_view *view)
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

static void jacobian_rows(fxs_stage_view *view)
{
    const int64_t focal_q12[2] = {view->fx_q12, view->fy_q12};
    uint32_t focal = (uint32_t)(focal_q12[0] > focal_q12[1] ? focal_q12[0] : focal_q12[1]);
    int zeros = fxs_clz32(focal);
    view->focal_q32 = focal << zeros;
    view->focal_exponent = 20 - zeros;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            int64_t row = view->rotation_q30[3 * i + k] * focal_q12[i] / focal;
            int64_t forward = view->rotation_q30[6 + k] * focal_q12[i] / focal;
            view->row_q15[i][k] = (int32_t)fxs_round_shift(row, 15 + view->jacobian_exponent);
            view->forward_q15[i][k] = (int32_t)fxs_round_shift(forward, 15);
        }
}

static void find_whole(const fxs_camera *camera, int64_t size[2], int64_t c_q12[2])
{
    const int window = is_window(camera);
    size[0] = window ? camera->whole_width : camera->width;
    size[1] = window ? camera->whole_height : camera->height;
    c_q12[0] = camera->cx_q12 + (window ? (int64_t)camera->whole_x << 12 : 0);
    c_q12[1] = camera->cy_q12 + (window ? (int64_t)camera->whole_y << 12 : 0);
}

/* Derives a view's values from its camera. If the camera is a window of a larger picture, only the edges are its own;
   the other values come from the whole picture. */
static void derive(fxs_stage_view *view, const fxs_camera *camera)
{
    const int32_t size[2] = {view->width, view->height};
    const int64_t f_q12[2] = {view->fx_q12, view->fy_q12}, c_q12[2] = {view->cx_q12, view->cy_q12};
    int64_t whole[2], whole_c_q12[2];
    find_whole(camera, whole, whole_c_q12);
    for (int i = 0; i < 2; i++) {
        slope_limits(whole[i], f_q12[i], whole_c_q12[i], &view->slope_low_q23[i], &view->slope_high_q23[i]);
        edge_slopes(size[i], f_q12[i], c_q12[i], &view->edge_low_q23[i], &view->edge_high_q23[i]);
        if (view->orthographic)                  /* for an orthographic camera, the Jacobian does not depend on the
                                                    Gaussian's centre */
            view->slope_low_q23[i] = view->slope_high_q23[i] = 0;
    }
    view->veil_exponent = veil_exponent(view, whole, whole_c_q12);
    view->jacobian_exponent = jacobian_exponent(view);
    jacobian_rows(view);
    for (int i = 0; i < 3; i++)                  /* the eye of an orthographic camera is 2^28 units behind the camera's
                                                    position */
        view->eye_q32[i] = view->position_q32[i] - (view->orthographic ? view->rotation_q30[6 + i] * ONE_Q30 : 0);
}

FXS_STAGE void fxs_view_of_whole(fxs_stage_view *view, const fxs_camera *camera)
{
    const int64_t f_q12[2] = {view->fx_q12, view->fy_q12};
    int64_t whole[2], whole_c_q12[2];
    find_whole(camera, whole, whole_c_q12);
    for (int i = 0; i < 2; i++)
        edge_slopes(whole[i], f_q12[i], whole_c_q12[i], &view->edge_low_q23[i], &view->edge_high_q23[i]);
}

/* Culling assumes that a Gaussian reaches 3.5 sigma. A veil's dilation exceeds that by less than a 400th of the
   picture's longer side, because the largest sigma of a veil is at least a 32nd of this side. The margin is at least a
   256th. */
void fxs_view_of_window(fxs_stage_view *view, const int32_t first[2], const int32_t size[2])
{
    const int64_t margin = (view->tiles_x + view->tiles_y) / 16;
    const int64_t f_q12[2] = {view->fx_q12, view->fy_q12}, c_q12[2] = {view->cx_q12, view->cy_q12};
    for (int i = 0; i < 2; i++)
        edge_slopes(size[i] + 2 * margin, f_q12[i], c_q12[i] + (margin - first[i]) * 4096, &view->edge_low_q23[i],
                    &view->edge_high_q23[i]);
}

/* Returns the focal length wanted for the plane of an orthographic camera. It is the larger of twice the picture's size
   and 1/16 of the largest distance from the principal point to an edge. */
static uint64_t plane_focal_q12(int64_t size, int64_t c_q12)
{
    const int64_t after_q12 = (size << 12) - c_q12, reach_q12 = after_q12 > c_q12 ? after_q12 : c_q12;
    return (uint64_t)(reach_q12 >> 4 > size << 13 ? reach_q12 >> 4 : size << 13);
}

/* Converts fx and fy of an orthographic camera, in pixels per unit, to focal lengths for a plane at depth
   2^plane_exponent. One of the focal lengths is 1/2 to 1 times plane_focal_q12, so slopes are at most 32. */
static void choose_plane(fxs_stage_view *view, const fxs_camera *camera, fxs_scale s)
{
    const uint64_t x_q12 = (uint64_t)camera->fx_q12 * s.mantissa, y_q12 = (uint64_t)camera->fy_q12 * s.mantissa;
    int64_t whole[2], c_q12[2];
    find_whole(camera, whole, c_q12);
    const uint64_t most_x_q12 = plane_focal_q12(whole[0], c_q12[0]), most_y_q12 = plane_focal_q12(whole[1], c_q12[1]);
    int shift = 0;
    while ((x_q12 >> shift >= most_x_q12 && y_q12 >> shift >= most_y_q12) || (x_q12 | y_q12) >> shift > INT32_MAX)
        shift++;
    view->fx_q12 = (int64_t)(x_q12 >> shift) + !(x_q12 >> shift);
    view->fy_q12 = (int64_t)(y_q12 >> shift) + !(y_q12 >> shift);
    view->plane_exponent = 31 - s.exponent - shift;
}

void fxs_camera_init(fxs_camera *camera, int32_t width, int32_t height)
{
    memset(camera, 0, sizeof *camera);
    camera->width = width;
    camera->height = height;
    camera->fx_q12 = camera->fy_q12 = camera->cx_q12 = (int32_t)((uint32_t)width * 2048);
    camera->cy_q12 = (int32_t)((uint32_t)height * 2048);
    camera->rotation_q30[0] = camera->rotation_q30[4] = camera->rotation_q30[8] = 1 << 30;
}

int fxs_view_init(fxs_stage_view *view, const fxs_camera *camera, const fxs_options *options)
{
    int error = check_camera(camera);
    if (error)
        return error;
    memset(view, 0, sizeof *view);
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
    view->orthographic = camera->projection == FXS_ORTHOGRAPHIC;
    if (view->orthographic)
        choose_plane(view, camera, fxs_scale_of(FXS_ONE_Q32));
    view->cutoff = options->cutoff;
    view->cut_q11 = view->cutoff == FXS_CUTOFF_SQUARE ? FXS_LEVEL_MAX_Q11 : FXS_CUT_Q11;
    view->sh_degree = options->sh_degree;
    view->share_q8 = 256;
    derive(view, camera);
    return 0;
}

/* ---- In the space of an object ----------------------------------------------------------------------------------- */

/* Returns x 2^32 / divisor, rounded down and saturated at 2^62. The divisor is 2^16 to 2^48. */
static int64_t divide_q32(uint64_t x, uint64_t divisor)
{
    uint64_t quotient = x / divisor, rest = x % divisor;
    for (int i = 0; i < 32; i++) {
        if (quotient >> 61)
            return (int64_t)1 << 62;
        rest *= 2;
        quotient = quotient * 2 + (rest >= divisor);
        rest -= rest >= divisor ? divisor : 0;
    }
    return (int64_t)quotient;
}

FXS_STAGE int64_t fxs_turned_back(const int32_t m_q30[9], const int64_t v[3], int i)
{
    int64_t high = 0, low = 0;
    for (int k = 0; k < 3; k++) {                /* the product is computed in two halves, because 2^61 times 2^30
                                                    overflows 64 bits */
        high += m_q30[3 * k + i] * (v[k] >> 31);
        low += m_q30[3 * k + i] * (v[k] & INT32_MAX);
    }
    return high * 2 + fxs_round_shift(low, 30);
}

/* Computes the camera's position in an object's space, R^T (P - T) / s, from its position P in the world. R, T and s
   are the object's rotation, translation and scale. Returns 0 if the position is too far out. */
static int position_in_object(int64_t out_q32[3], const int64_t position_q32[3], const fxs_object *object)
{
    int64_t apart_q32[3];
    for (int i = 0; i < 3; i++)
        apart_q32[i] = position_q32[i] - object->translation_q32[i];
    for (int i = 0; i < 3; i++) {
        const int64_t turned = fxs_turned_back(object->rotation_q30, apart_q32, i);
        const int64_t length = divide_q32((uint64_t)(turned < 0 ? -turned : turned), (uint64_t)object->scale_q32);
        if (length > POSITION_LIMIT_Q32)
            return 0;
        out_q32[i] = turned < 0 ? -length : length;
    }
    return 1;
}

static void turn(int32_t out_q30[9], const int32_t w_q30[9], const int32_t r_q30[9])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int64_t sum_q60 = 0;
            for (int j = 0; j < 3; j++)
                sum_q60 += (int64_t)w_q30[3 * i + j] * r_q30[3 * j + k];
            out_q30[3 * i + k] = (int32_t)fxs_round_shift(sum_q60, 30);
        }
}

int fxs_view_of_object(fxs_stage_view *view, const fxs_stage_view *world, const fxs_camera *camera,
                       const fxs_object *object)
{
    *view = *world;
    turn(view->rotation_q30, world->rotation_q30, object->rotation_q30);
    if (!position_in_object(view->position_q32, world->position_q32, object))
        return FXS_ERR_OBJECT;
    view->near_q32 = divide_q32((uint64_t)world->near_q32, (uint64_t)object->scale_q32);
    if (view->orthographic)
        choose_plane(view, camera, fxs_scale_of(object->scale_q32));
    view->sh_degree = world->sh_degree < object->scene->sh_degree ? world->sh_degree : object->scene->sh_degree;
    view->antialiased = object->scene->antialiased;
    derive(view, camera);
    return 0;
}
