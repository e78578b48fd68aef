/* Creates and changes views (cameras in double precision). The rows of a view's rotation are its axes right, down and
   forward in world coordinates. */
#include <fixsplat/camera.h>

#include <math.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/view_more.h>
#include "src/base/try_internal.h"
#include "camera_internal.h"

#define DEGREES 57.29577951308232
#define LEVEL_SHARE 1e-3
#define NEAR_LEAST 0x1p-20
#define NEAR_MOST 0x1p28

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static int normalise(double v[3])
{
    double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return length > 1e-12 && isfinite(length);
}

int fxs_view_look_at(fxs_view *view, const double eye[3], const double target[3], const double up[3],
                     const fxs_picture *picture, fxs_message *message)
{
    const double fov = picture->fov;
    const int width = picture->width, height = picture->height;
    double *right = view->rotation, *down = view->rotation + 3, *forward = view->rotation + 6;
    if (!(fov >= 1 && fov <= 170))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a field of view of %g degrees: expected 1 to 170", fov);
    strcpy(view->name, "look-at");
    view->width = width;
    view->height = height;
    view->fx = view->fy = height / 2.0 / tan(fov / 2 / DEGREES);
    view->cx = width / 2.0;
    view->cy = height / 2.0;
    view->near = 0;
    view->projection = FXS_PERSPECTIVE;
    for (int i = 0; i < 3; i++) {
        view->position[i] = eye[i];
        forward[i] = target[i] - eye[i];
    }
    int forward_ok = normalise(forward);
    cross(right, forward, up);
    if (!forward_ok || !normalise(right))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "the camera looks nowhere: eye and target are one point, or up "
                           "is along the view");
    cross(down, forward, right);
    return 0;
}

int fxs_view_level(fxs_view *view, const double up[3])
{
    double right[3];
    const double *forward = view->rotation + 6;
    cross(right, forward, up);
    if (!normalise(right))
        return 0;
    memcpy(view->rotation, right, sizeof right);
    cross(view->rotation + 3, forward, right);
    return 1;
}

/* Mean up direction of several cameras. The vector u minimises mean (right . u)^2 + LEVEL_SHARE |u - mean up|^2. With R
   the mean of right right^T, it solves (R + LEVEL_SHARE) u = LEVEL_SHARE mean up. */
int fxs_views_up(const fxs_view *views, size_t count, size_t stride, double up[3])
{
    const char *at = (const char *)views;
    double mean[3] = {0, 0, 0}, a[3][3] = {{LEVEL_SHARE, 0, 0}, {0, LEVEL_SHARE, 0}, {0, 0, LEVEL_SHARE}},
        inverse[3][3];
    for (size_t i = 0; i < count; i++, at += stride) {
        const double *rotation = ((const fxs_view *)(const void *)at)->rotation;
        for (int k = 0; k < 9; k++)
            a[k / 3][k % 3] += rotation[k / 3] * rotation[k % 3] / (double)count;
        for (int k = 0; k < 3; k++)
            mean[k] -= rotation[3 + k] / (double)count;
    }
    for (int k = 0; k < 3; k++)
        cross(inverse[k], a[(k + 1) % 3], a[(k + 2) % 3]);
    for (int k = 0; k < 3; k++)
        up[k] = dot(inverse[k], mean);
    return dot(mean, mean) > 0.01 && normalise(up);
}

void fxs_view_up(const fxs_view *view, double up[3])
{
    const double *right = view->rotation, *down = view->rotation + 3;
    double most = 0.1;
    int axis = -1;
    for (int k = 0; k < 3; k++)
        if (fabs(right[k]) < 1e-3 && fabs(down[k]) > most) {
            axis = k;
            most = fabs(down[k]);
        }
    for (int k = 0; k < 3; k++)
        up[k] = axis < 0 ? -down[k] : k != axis ? 0 : down[k] > 0 ? -1 : 1;
}

static double radius_of(const double low[3], const double high[3])
{
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += (high[i] - low[i]) * (high[i] - low[i]) / 4;
    return sqrt(square);
}

double fxs_near_of_box(const double low[3], const double high[3])
{
    const double near = radius_of(low, high) / 100;
    return near > 0 ? fmax(fmin(near, 0.2), NEAR_LEAST) : 0.2;
}

/* Returns the smallest camera distance that keeps all corners of a box within 95 % of the picture and beyond the near
   plane. */
static double distance_for(const fxs_view *view, const double half[3], double near)
{
    const double tangent[2] = {0.95 * view->width / 2 / view->fx, 0.95 * view->height / 2 / view->fy};
    double distance = 0;
    for (int corner = 0; corner < 8; corner++) {
        const double sides[3] = {corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1],
                                 corner & 4 ? half[2] : -half[2]};
        const double x = fabs(dot(view->rotation, sides)), y = fabs(dot(view->rotation + 3, sides));
        const double depth = fmax(fmax(x / tangent[0], y / tangent[1]), near);
        const double needed = depth - dot(view->rotation + 6, sides);
        if (needed > distance)               /* compares by hand, because fmax crashes gcc 12 for AArch64 */
            distance = needed;
    }
    return distance;
}

int fxs_view_frame_from(fxs_view *view, const double low[3], const double high[3], const double from[3],
                        const double up[3], const fxs_picture *picture, fxs_message *message)
{
    static const double origin[3] = {0, 0, 0};
    double half[3];
    for (int i = 0; i < 3; i++) {
        half[i] = (high[i] - low[i]) / 2;
        if (!isfinite(low[i]) || !isfinite(half[i]))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a box from %g to %g is not finite", low[i], high[i]);
    }
    FXS_TRY(fxs_view_look_at(view, from, origin, up, picture, message));
    view->near = fxs_near_of_box(low, high);
    const double distance = distance_for(view, half, 2.5 * view->near);
    for (int i = 0; i < 3; i++)
        view->position[i] = low[i] + half[i] - distance * view->rotation[6 + i];
    return 0;
}

int fxs_level_back(double back[3], double axis[3], const double up[3], fxs_message *message)
{
    memcpy(axis, up, 3 * sizeof *axis);
    if (!normalise(axis))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "up is not a direction");
    memcpy(back, (double[3]){0, 0, -1}, 3 * sizeof *back);
    if (fabs(dot(axis, back)) > 0.9)
        memcpy(back, (double[3]){0, -1, 0}, 3 * sizeof *back);
    const double along = dot(axis, back);
    for (int i = 0; i < 3; i++)
        back[i] -= along * axis[i];
    normalise(back);
    return 0;
}

int fxs_view_frame_box(fxs_view *view, const double low[3], const double high[3], const double up[3],
                       const fxs_picture *picture, fxs_message *message)
{
    double from[3], axis[3], back[3];
    FXS_TRY(fxs_level_back(back, axis, up, message));
    for (int i = 0; i < 3; i++)
        from[i] = 0.95 * back[i] + 0.31 * axis[i];
    return fxs_view_frame_from(view, low, high, from, up, picture, message);
}

/* Returns the ratio of focal lengths that keeps a field of view. In a picture of another shape, it keeps the product
   of the tangents across and down; shapes that differ by less than a pixel count as equal. */
static double resize_scale(const fxs_view *view, int width, int height)
{
    const double across = (double)width / view->width, down = (double)height / view->height;
    const double differ = fabs((double)width * view->height - (double)height * view->width);
    return differ < fmax(view->width, view->height) ? across : sqrt(across * down);
}

void fxs_view_resize(fxs_view *view, int width, int height)
{
    const double scale = resize_scale(view, width, height);
    view->fx *= scale;
    view->fy *= scale;
    /* A principal point in the middle of the picture stays exactly in the middle. */
    view->cx = width / 2.0 + scale * (view->cx - view->width / 2.0);
    view->cy = height / 2.0 + scale * (view->cy - view->height / 2.0);
    view->width = width;
    view->height = height;
}

int fxs_view_set_tangents(fxs_view *view, const double tangents[4], fxs_message *message)
{
    const double left = tangents[0], right = tangents[1], up = tangents[2], down = tangents[3];
    if (!(left >= -64 && left < right && right <= 64 && down >= -64 && down < up && up <= 64))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "tangents %g, %g, %g, %g: expected left < right and down < up, "
                           "within +-64", left, right, up, down);
    view->projection = FXS_PERSPECTIVE;
    view->fx = view->width / (right - left);
    view->fy = view->height / (up - down);
    view->cx = -left * view->fx;
    view->cy = up * view->fy;
    return 0;
}

/* Rotates a vector about an axis of length 1, by Rodrigues' formula. */
static void turn(double out[3], const double v[3], const double axis[3], double angle)
{
    double across[3], c = cos(angle), s = sin(angle), along = dot(axis, v) * (1 - c);
    cross(across, axis, v);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] * c + across[i] * s + axis[i] * along;
}

void fxs_view_orbit(fxs_view *view, const double middle[3], const double axis[3], double angle)
{
    double unit[3] = {axis[0], axis[1], axis[2]}, offset[3], turned[3];
    if (!normalise(unit))
        return;
    for (int i = 0; i < 3; i++)
        offset[i] = view->position[i] - middle[i];
    turn(turned, offset, unit, angle);
    for (int i = 0; i < 3; i++)
        view->position[i] = middle[i] + turned[i];
    for (int row = 0; row < 9; row += 3) {
        turn(turned, view->rotation + row, unit, angle);
        memcpy(view->rotation + row, turned, sizeof turned);
    }
}

static int rotation_valid(const double r[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!(fabs(dot(r + 3 * i, r + 3 * j) - (i == j)) <= 1e-3))
                return 0;
    double determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                         r[2] * (r[3] * r[7] - r[4] * r[6]);
    return determinant > 0;
}

/* Finds the rotation nearest to a matrix, by Newton's iteration for the polar decomposition: R <- R (3 I - R^T R) /
   2. */
static void orthonormalise(double r[9])
{
    for (int step = 0; step < 3; step++) {
        double old[9], factor[9];
        memcpy(old, r, sizeof old);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                factor[3 * i + j] = 1.5 * (i == j) -
                                    0.5 * (old[i] * old[j] + old[3 + i] * old[3 + j] + old[6 + i] * old[6 + j]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                r[3 * i + j] = old[3 * i] * factor[j] + old[3 * i + 1] * factor[3 + j] + old[3 * i + 2] * factor[6 + j];
    }
}

int fxs_to_rotation(double r[9])
{
    const int valid = rotation_valid(r);
    if (valid)
        orthonormalise(r);
    return valid;
}

/* Converts a rotation matrix r to a quaternion q = (w, v). The matrix 4 q q^T has 1 + trace, 1 + r00 - r11 - r22, ...
   on its diagonal, and sums and differences of r elsewhere. Each row is parallel to q. The row with the largest
   diagonal is the most accurate. */
void fxs_quaternion_of(const double r[9], double q[4])
{
    const double trace = r[0] + r[4] + r[8];
    int largest = 0;
    const double diagonal[4] = {1 + trace, 1 + 2 * r[0] - trace, 1 + 2 * r[4] - trace, 1 + 2 * r[8] - trace};
    const double rows[4][4] = {{diagonal[0], r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                               {r[7] - r[5], diagonal[1], r[1] + r[3], r[2] + r[6]},
                               {r[2] - r[6], r[1] + r[3], diagonal[2], r[5] + r[7]},
                               {r[3] - r[1], r[2] + r[6], r[5] + r[7], diagonal[3]}};
    for (int i = 1; i < 4; i++)
        largest = diagonal[i] > diagonal[largest] ? i : largest;
    const double *row = rows[largest];
    const double length = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] + row[3] * row[3]);
    for (int i = 0; i < 4; i++)
        q[i] = row[i] / length;
}

static int to_fixed(int64_t *out, double x, int q, double limit)
{
    *out = (int64_t)(fabs(x) < limit ? floor(ldexp(x, q) + 0.5) : 0);
    return fabs(x) < limit;
}

int fxs_camera_from_view(fxs_camera *camera, const fxs_view *view, fxs_message *message)
{
    const double pixels[4] = {view->fx, view->fy, view->cx, view->cy};
    int64_t fixed[4], r;
    fxs_camera_init(camera, view->width, view->height);
    camera->projection = view->projection;
    for (int i = 0; i < 4; i++)
        if (!to_fixed(&fixed[i], pixels[i], 12, 524287) || (i < 2 && fixed[i] < 1))
            return fxs_fail_as(FXS_ERR_CAMERA, message, "view %s: a %s of %g pixels is out of range", view->name,
                               i < 2 ? "focal length" : "principal point", pixels[i]);
    camera->fx_q12 = (int32_t)fixed[0];
    camera->fy_q12 = (int32_t)fixed[1];
    camera->cx_q12 = (int32_t)fixed[2];
    camera->cy_q12 = (int32_t)fixed[3];
    for (int i = 0; i < 9; i++) {
        if (!to_fixed(&r, view->rotation[i], 30, 1.001))
            return fxs_fail_as(FXS_ERR_CAMERA, message, "view %s: its rotation is not a rotation", view->name);
        camera->rotation_q30[i] = (int32_t)r;
    }
    for (int i = 0; i < 3; i++)
        if (!to_fixed(&camera->position_q32[i], view->position[i], 32, 134217728.0))
            return fxs_fail_as(FXS_ERR_CAMERA, message, "view %s: a position of %g is beyond 2^27 units", view->name,
                               view->position[i]);
    if (view->near != 0 && !(view->near >= NEAR_LEAST && view->near <= NEAR_MOST))
        return fxs_fail_as(FXS_ERR_CAMERA, message, "view %s: a near plane at %g: expected 2^-20 to 2^28 units",
                           view->name, view->near);
    camera->near_q32 = (int64_t)floor(ldexp(view->near, 32) + 0.5);
    return 0;
}

static int is_near(double x, double wanted)
{
    return fabs(x - wanted) <= 1e-6 * fmax(1, fabs(wanted));
}

/* Reads the camera's pose from an OpenGL view matrix. Its upper rows are [R | t] for an eye with y up and z backwards.
   The camera's axes are the rows x, -y and -z of R. Its centre is -R^T t. */
static int take_view_matrix(fxs_view *view, const double m[16], fxs_message *message)
{
    double *axes = view->rotation;
    for (int i = 0; i < 16; i++)
        if (!isfinite(m[i]))
            return fxs_fail_as(FXS_ERR_CAMERA, message, "the view matrix has a number that is not finite");
    if (!is_near(m[3], 0) || !is_near(m[7], 0) || !is_near(m[11], 0) || !is_near(m[15], 1))
        return fxs_fail_as(FXS_ERR_CAMERA, message,
                           "the last row of the view matrix is not 0, 0, 0, 1: is it by rows?");
    for (int i = 0; i < 3; i++) {
        axes[i] = m[4 * i];
        axes[3 + i] = -m[4 * i + 1];
        axes[6 + i] = -m[4 * i + 2];
        view->position[i] = 0;
        for (int k = 0; k < 3; k++)
            view->position[i] -= m[4 * i + k] * m[12 + k];
    }
    return fxs_to_rotation(axes) ? 0 : fxs_fail_as(FXS_ERR_CAMERA, message,
                                                   "the view matrix scales, shears or mirrors");
}

/* Finds the near plane of an OpenGL projection, where -near c + d = -w. In perspective w = near, so near = d / (c - 1).
   Orthographic, w = 1: near = (d + 1) / c. The far plane, where -far c + d = w, must lie beyond the near plane or at
   infinity. */
static int take_near(fxs_view *view, double c, double d, fxs_message *message)
{
    const int flat = view->projection == FXS_ORTHOGRAPHIC;
    const double near = flat ? (d + 1) / c : d / (c - 1), far = flat ? (d - 1) / c : d / (c + 1);
    view->near = near;
    return isfinite(near) && near > 0 && (far > near || (!flat && is_near(c, -1)))
               ? 0 : fxs_fail_as(FXS_ERR_CAMERA, message,
                                 "the projection has no near plane before a far one, with depths "
                                 "of -1 to 1");
}

/* Reads focal lengths and principal point from an OpenGL projection. Pixels from clip coordinates: x = width (x_clip /
   w + 1) / 2, y = height (1 - y_clip / w) / 2. */
static int take_projection(fxs_view *view, const double m[16], fxs_message *message)
{
    static const int zeros[] = {1, 2, 3, 4, 6, 7};
    const int flat = is_near(m[11], 0) && is_near(m[15], 1);
    int good = flat || (is_near(m[11], -1) && is_near(m[15], 0));
    for (int i = 0; i < 16; i++)
        good &= isfinite(m[i]);
    for (size_t i = 0; i < sizeof zeros / sizeof *zeros; i++)
        good &= is_near(m[zeros[i]], 0);
    for (int i = 0; i < 2; i++)
        good &= is_near(m[flat ? 8 + i : 12 + i], 0) && m[5 * i] > 0;
    if (!good)
        return fxs_fail_as(FXS_ERR_CAMERA, message, "the projection is neither perspective nor orthographic: expected "
                           "those of glFrustum or glOrtho, by columns");
    view->projection = flat ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE;
    view->fx = m[0] * view->width / 2;
    view->fy = m[5] * view->height / 2;
    view->cx = view->width * (flat ? 1 + m[12] : 1 - m[8]) / 2;
    view->cy = view->height * (flat ? 1 - m[13] : 1 + m[9]) / 2;
    return take_near(view, m[10], m[14], message);
}

int fxs_camera_from_matrices(fxs_camera *camera, const double view_matrix[16], const double projection[16], int width,
                             int height, fxs_message *message)
{
    fxs_view view = {.name = "of matrices", .width = width, .height = height};
    if (width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_SIZE, message, "a picture of %d x %d pixels: expected 1 to %d", width, height,
                           FXS_MAX_SIZE);
    FXS_TRY(take_view_matrix(&view, view_matrix, message));
    FXS_TRY(take_projection(&view, projection, message));
    return fxs_camera_from_view(camera, &view, message);
}
