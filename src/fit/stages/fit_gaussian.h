/* Projects LANES Gaussians to the picture, and converts loss gradients by the projections to gradients by the
 * Gaussians' parameters. Derivatives: Kerbl et al. 2023, appendix A; Jacobian: Zwicker et al. 2002. */
#ifndef FXS_FIT_GAUSSIAN_H
#define FXS_FIT_GAUSSIAN_H

#include "fit_lanes.h"
#include "fit_stage.h"

/* Numbers of a Gaussian's projection that its gradients need again. The covariance in the picture is T T^t + 0.3 I,
   with T = V S, V = M R and M = J W. J is the Jacobian, W maps world to camera, R is the Gaussian's rotation, and S its
   scales. Row i of M is f / z (W_i - slope_i W_2), with focal length f and depth z. */
typedef struct shape {
    real offset[3];                /* vector from the eye to the Gaussian's centre; for an orthographic camera the view
                                      direction */
    real in_camera[3], inverse_z;
    real slope[2], cut_slope[2];   /* x / z and y / z of the centre in the camera; cut_slope: the same, clamped for the
                                      Jacobian */
    real m[2][3], rotation[3][3], length, unit[4];   /* length: 1 / length of the Gaussian's quaternion; unit:
                                                        normalised quaternion */
    real scale[3], v[2][3], t[2][3];
    real ux, uy, vy, a, b, c;
    real share;                    /* determinant of the covariance in the picture, relative to the determinant without
                                      dilation; 1 if not antialiased */
} shape;

static inline real dot3(const real a[3], const real b[3])
{
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static inline void rotation_of(const real q[4], real r[3][3])
{
    const real x2 = q[1] + q[1], y2 = q[2] + q[2], z2 = q[3] + q[3];
    const real xx = x2 * q[1], yy = y2 * q[2], zz = z2 * q[3], xy = x2 * q[2], xz = x2 * q[3], yz = y2 * q[3];
    const real wx = x2 * q[0], wy = y2 * q[0], wz = z2 * q[0];
    r[0][0] = 1.0f - (yy + zz), r[0][1] = xy - wz, r[0][2] = xz + wy;
    r[1][0] = xy + wz, r[1][1] = 1.0f - (xx + zz), r[1][2] = yz - wx;
    r[2][0] = xz - wy, r[2][1] = yz + wx, r[2][2] = 1.0f - (xx + yy);
}

/* Returns e^-logit for a logit of opacity, clamped to -80..80. */
static inline real exp_of_minus(real logit)
{
    return exp_e(-least(most(logit, all(-80)), all(80)));
}

/* Sets s->unit, s->length and s->rotation from a Gaussian's quaternion. */
static inline void find_rotation(shape *s, const float *at, size_t stride)
{
    real q[4];
    for (int i = 0; i < 4; i++)
        q[i] = load(at + (FXS_FIT_ROTATION + i) * (ptrdiff_t)stride);
    s->length = 1.0f / root((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    for (int i = 0; i < 4; i++)
        s->unit[i] = q[i] * s->length;
    rotation_of(s->unit, s->rotation);
}

static inline void find_shape(shape *s, const fxs_fit_camera *camera, const float *at, size_t stride)
{
    real w[3][3];
    for (int i = 0; i < 9; i++)
        w[i / 3][i % 3] = all(camera->rotation[i]);
    for (int i = 0; i < 3; i++)
        s->offset[i] = load(at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride) - camera->eye[i];
    for (int i = 0; i < 3; i++)
        s->in_camera[i] = dot3(w[i], s->offset);
    s->inverse_z = camera->is_parallel ? all(1) : 1.0f / s->in_camera[2];
    for (int i = 0; i < 3 && camera->is_parallel; i++)
        s->offset[i] = w[2][i];
    for (int i = 0; i < 2; i++) {
        s->slope[i] = s->in_camera[i] * s->inverse_z;
        s->cut_slope[i] = least(most(s->slope[i], all(-camera->slope_most[i])), all(camera->slope_most[i]));
        for (int k = 0; k < 3; k++)
            s->m[i][k] = (camera->focal[i] * s->inverse_z) * (w[i][k] - s->cut_slope[i] * w[2][k]);
    }
    find_rotation(s, at, stride);
    for (int j = 0; j < 3; j++) {
        s->scale[j] = exp_e(load(at + (FXS_FIT_SCALE + j) * (ptrdiff_t)stride));
        for (int i = 0; i < 2; i++) {
            s->v[i][j] = (s->m[i][0] * s->rotation[0][j] + s->m[i][1] * s->rotation[1][j]) +
                         s->m[i][2] * s->rotation[2][j];
            s->t[i][j] = s->v[i][j] * s->scale[j];
        }
    }
    /* The determinant of the covariance T T^t + 0.3 I, without cancellation: |T_0 x T_1|^2 + 0.3 (A + C) + 0.09. T_0
       and T_1 are the rows of T, and A and C their squared lengths. */
    const real a = dot3(s->t[0], s->t[0]), b = dot3(s->t[0], s->t[1]), c = dot3(s->t[1], s->t[1]);
    const real cross[3] = {s->t[0][1] * s->t[1][2] - s->t[0][2] * s->t[1][1],
                           s->t[0][2] * s->t[1][0] - s->t[0][0] * s->t[1][2],
                           s->t[0][0] * s->t[1][1] - s->t[0][1] * s->t[1][0]};
    const real sharp = dot3(cross, cross);
    const real det = (sharp + FXS_FIT_DILATION * (a + c)) + FXS_FIT_DILATION * FXS_FIT_DILATION;
    s->a = a + FXS_FIT_DILATION;
    s->b = b;
    s->c = c + FXS_FIT_DILATION;
    s->vy = 1.0f / root(s->c);
    s->ux = root(s->c / det);
    s->uy = -(b / s->c) * s->ux;
    s->share = camera->is_antialiased ? det / sharp : all(1);
}

#define SH_COUNT(degree) (((degree) + 1) * ((degree) + 1) - 1)

/* Computes the real spherical harmonics of degrees 1 to 3, with the signs of Inria's files. */
static inline void basis_of(const real d[3], int degree, real b[15])
{
    const real x = d[0], y = d[1], z = d[2], xx = x * x, yy = y * y, zz = z * z;
    b[0] = -0.488602512f * y;
    b[1] = 0.488602512f * z;
    b[2] = -0.488602512f * x;
    if (degree < 2)
        return;
    b[3] = 1.092548431f * (x * y);
    b[4] = -1.092548431f * (y * z);
    b[5] = 0.315391565f * ((2.0f * zz - xx) - yy);
    b[6] = -1.092548431f * (x * z);
    b[7] = 0.546274215f * (xx - yy);
    if (degree < 3)
        return;
    b[8] = -0.590043590f * y * (3.0f * xx - yy);
    b[9] = 2.890611443f * (x * y) * z;
    b[10] = -0.457045799f * y * ((4.0f * zz - xx) - yy);
    b[11] = 0.373176333f * z * ((2.0f * zz - 3.0f * xx) - 3.0f * yy);
    b[12] = -0.457045799f * x * ((4.0f * zz - xx) - yy);
    b[13] = 1.445305721f * z * (xx - yy);
    b[14] = -0.590043590f * x * (xx - 3.0f * yy);
}

/* Computes the derivatives by x, y and z of a weighted sum of spherical harmonics. */
static inline void add_basis_gradient(const real d[3], int degree, const real w[15], real out[3])
{
    const real x = d[0], y = d[1], z = d[2], xx = x * x, yy = y * y, zz = z * z;
    out[0] = -0.488602512f * w[2];
    out[1] = -0.488602512f * w[0];
    out[2] = 0.488602512f * w[1];
    if (degree < 2)
        return;
    out[0] += ((1.092548431f * y * w[3] - 0.630783131f * x * w[5]) - 1.092548431f * z * w[6]) +
              1.092548431f * x * w[7];
    out[1] += ((1.092548431f * x * w[3] - 1.092548431f * z * w[4]) - 0.630783131f * y * w[5]) -
              1.092548431f * y * w[7];
    out[2] += (1.261566261f * z * w[5] - 1.092548431f * y * w[4]) - 1.092548431f * x * w[6];
    if (degree < 3)
        return;
    out[0] += ((((((-3.540261540f * (x * y) * w[8] + 2.890611443f * (y * z) * w[9]) + 0.914091598f * (x * y) * w[10]) -
                  2.239057998f * (x * z) * w[11]) -
                 0.457045799f * ((4.0f * zz - 3.0f * xx) - yy) * w[12]) +
                2.890611443f * (x * z) * w[13]) -
               1.770130770f * (xx - yy) * w[14]);
    out[1] += ((((((-1.770130770f * (xx - yy) * w[8] + 2.890611443f * (x * z) * w[9]) -
                   0.457045799f * ((4.0f * zz - xx) - 3.0f * yy) * w[10]) -
                  2.239057998f * (y * z) * w[11]) +
                 0.914091598f * (x * y) * w[12]) -
                2.890611443f * (y * z) * w[13]) +
               3.540261540f * (x * y) * w[14]);
    out[2] += ((((2.890611443f * (x * y) * w[9] - 3.656366390f * (y * z) * w[10]) +
                 1.119528999f * ((2.0f * zz - xx) - yy) * w[11]) -
                3.656366390f * (x * z) * w[12]) +
               1.445305721f * (xx - yy) * w[13]);
}

typedef struct look {
    real inverse_length, direction[3], basis[15], colour[3];   /* colour: the Gaussian's colour from this direction,
                                                                  before clamping at 0 */
} look;

static inline void find_look(look *l, const real offset[3], int degree, const float *at, size_t stride)
{
    l->inverse_length = 1.0f / root(dot3(offset, offset));
    for (int i = 0; i < 3; i++)
        l->direction[i] = offset[i] * l->inverse_length;
    for (int c = 0; c < 3; c++)
        l->colour[c] = load(at + (FXS_FIT_COLOUR + c) * (ptrdiff_t)stride) * 0.282094792f + 0.5f;
    if (degree < 1)
        return;
    basis_of(l->direction, degree, l->basis);
    for (int k = 0; k < SH_COUNT(degree); k++)
        for (int c = 0; c < 3; c++)
            l->colour[c] += l->basis[k] * load(at + (FXS_FIT_SH + 3 * k + c) * (ptrdiff_t)stride);
}

/* Computes two loss gradients from the gradient by a Gaussian's colour. g: by the colour before clamping at 0. along:
   by the position, because it changes the view direction of the spherical harmonics. */
static inline void colour_gradient(const look *l, int degree, const float *at, size_t stride,
                                   const real sums[FXS_FIT_SUMS], real g[3], real along[3])
{
    real w[15], by_direction[3];
    for (int c = 0; c < 3; c++) {
        g[c] = keep(below(all(0), l->colour[c]), sums[FXS_FIT_RED + c]);
        along[c] = all(0);
    }
    if (degree < 1)
        return;
    for (int k = 0; k < SH_COUNT(degree); k++) {
        const float *sh = at + (FXS_FIT_SH + 3 * k) * (ptrdiff_t)stride;
        w[k] = (load(sh) * g[0] + load(sh + stride) * g[1]) + load(sh + 2 * stride) * g[2];
    }
    add_basis_gradient(l->direction, degree, w, by_direction);
    const real radial = dot3(l->direction, by_direction);
    for (int i = 0; i < 3; i++)
        along[i] = (by_direction[i] - l->direction[i] * radial) * l->inverse_length;
}

/* Computes the loss gradient by the matrix T, where T T^t is a Gaussian's covariance in the picture. dL/dT = 2 G T with
   G = -U^t (sum of h (u, v) (u, v)^t / 2) U. U^t U is the inverse of the covariance, and h = -alpha dL/dalpha. A
   splat's u and v are scaled by FXS_FIT_UNIT. */
static inline void covariance_gradient(const shape *s, const real sums[FXS_FIT_SUMS], real by_t[2][3])
{
    const real ux = s->ux * (1.0f / FXS_FIT_UNIT), uy = s->uy * (1.0f / FXS_FIT_UNIT),
               vy = s->vy * (1.0f / FXS_FIT_UNIT);
    const real p0 = ux * sums[FXS_FIT_SUM_UU];
    const real p10 = uy * sums[FXS_FIT_SUM_UU] + vy * sums[FXS_FIT_SUM_UV];
    const real p11 = uy * sums[FXS_FIT_SUM_UV] + vy * sums[FXS_FIT_SUM_VV];
    const real g00 = p0 * ux, g01 = p10 * ux, g11 = p10 * uy + p11 * vy;
    for (int j = 0; j < 3; j++) {
        by_t[0][j] = -(g00 * s->t[0][j] + g01 * s->t[1][j]);
        by_t[1][j] = -(g01 * s->t[0][j] + g11 * s->t[1][j]);
    }
}

/* Adds the loss gradient by the antialiasing factor of the opacity, sqrt(sharp / det). T T^t + e is the covariance in
   the picture, with the dilation e. T has the rows T_0, T_1 with the squared lengths A, C. Here n = T_0 x T_1, sharp =
   |n|^2, and det = sharp + e (A + C) + e^2. With h = -alpha dL/dalpha and opacity o, dL/dln(o) = -sum of h, and
     d ln sqrt(sharp / det) / dT = ((T T^t)^-1 - (T T^t + e)^-1) T
     = e / det ((A + C + e) / sharp (T_1 x n, n x T_0) - T).
   For visible splats sharp / det is above 2^-16, so nothing overflows. */
static inline void add_share_gradient(const shape *s, const real sums[FXS_FIT_SUMS], real by_t[2][3])
{
    const real p[3] = {s->t[0][0], s->t[0][1], s->t[0][2]}, q[3] = {s->t[1][0], s->t[1][1], s->t[1][2]};
    const real n[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    const real wide = (dot3(p, p) + dot3(q, q)) + FXS_FIT_DILATION, sharp = dot3(n, n);
    const real by_log = -sums[FXS_FIT_SUM] * (FXS_FIT_DILATION / (sharp + FXS_FIT_DILATION * wide));
    const real by_sharp = wide / sharp;
    for (int j = 0; j < 3; j++) {
        const int k = (j + 1) % 3, l = (j + 2) % 3;
        by_t[0][j] += by_log * (by_sharp * (q[k] * n[l] - q[l] * n[k]) - p[j]);
        by_t[1][j] += by_log * (by_sharp * (n[k] * p[l] - n[l] * p[k]) - q[j]);
    }
}

static inline void rotation_gradient(const shape *s, const real r[3][3], real out[4])
{
    const real q[4] = {s->unit[0], s->unit[1], s->unit[2], s->unit[3]};
    real g[4];
    g[0] = 2.0f * ((q[1] * (r[2][1] - r[1][2]) + q[2] * (r[0][2] - r[2][0])) + q[3] * (r[1][0] - r[0][1]));
    g[1] = 2.0f * (((q[2] * (r[0][1] + r[1][0]) + q[3] * (r[0][2] + r[2][0])) + q[0] * (r[2][1] - r[1][2])) -
                   2.0f * q[1] * (r[1][1] + r[2][2]));
    g[2] = 2.0f * (((q[1] * (r[0][1] + r[1][0]) + q[3] * (r[1][2] + r[2][1])) + q[0] * (r[0][2] - r[2][0])) -
                   2.0f * q[2] * (r[0][0] + r[2][2]));
    g[3] = 2.0f * (((q[1] * (r[0][2] + r[2][0]) + q[2] * (r[1][2] + r[2][1])) + q[0] * (r[1][0] - r[0][1])) -
                   2.0f * q[3] * (r[0][0] + r[1][1]));
    const real along = (g[0] * q[0] + g[1] * q[1]) + (g[2] * q[2] + g[3] * q[3]);
    for (int i = 0; i < 4; i++)
        out[i] = (g[i] - q[i] * along) * s->length;
}

static inline void shape_gradient(const shape *s, const fxs_fit_camera *camera, const real by_t[2][3],
                                  const real by_centre[2], real gradient[FXS_FIT_SH], real by_position[3])
{
    real by_m[2][3], by_rotation[3][3], by_quaternion[4], by_camera[3], by_inverse_z = all(0);
    for (int j = 0; j < 3; j++)
        gradient[FXS_FIT_SCALE + j] = by_t[0][j] * s->t[0][j] + by_t[1][j] * s->t[1][j];
    for (int i = 0; i < 2; i++) {
        real by_v[3];
        for (int j = 0; j < 3; j++)
            by_v[j] = by_t[i][j] * s->scale[j];
        for (int k = 0; k < 3; k++)
            by_m[i][k] = dot3(by_v, s->rotation[k]);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                by_rotation[k][j] = i ? by_rotation[k][j] + s->m[i][k] * by_v[j] : s->m[i][k] * by_v[j];
    }
    rotation_gradient(s, (const real(*)[3])by_rotation, by_quaternion);
    for (int i = 0; i < 4; i++)
        gradient[FXS_FIT_ROTATION + i] = by_quaternion[i];
    for (int i = 0; i < 2; i++) {
        const real focal = all(camera->focal[i]);
        const real row[3] = {all(camera->rotation[6]), all(camera->rotation[7]), all(camera->rotation[8])};
        const mask is_free = both(at_most(all(-camera->slope_most[i]), s->slope[i]),
                                  at_most(s->slope[i], all(camera->slope_most[i])));
        const real by_cut = -(focal * s->inverse_z) * dot3(by_m[i], row);
        const real by_slope = focal * by_centre[i] + keep(is_free, by_cut);
        by_inverse_z += dot3(by_m[i], s->m[i]) * s->in_camera[2] + by_slope * s->in_camera[i];
        by_camera[i] = by_slope * s->inverse_z;
    }
    by_camera[2] = -(by_inverse_z * (s->inverse_z * s->inverse_z));
    for (int k = 0; k < 3; k++)
        by_position[k] = (camera->rotation[k] * by_camera[0] + camera->rotation[3 + k] * by_camera[1]) +
                         camera->rotation[6 + k] * by_camera[2];
}

/* Computes the loss gradients by a Gaussian's parameters except the SH coefficients. Their gradient is the SH basis
   l->basis times g, the gradient by the colour. by_centre: dL/dcentre in pixels. by_position: dL/dposition at constant
   colour. */
static inline void find_gradient_but_sh(const fxs_fit_camera *camera, int degree, const float *at, size_t stride,
                                        const real sums[FXS_FIT_SUMS], look *l, real g[3],
                                        real gradient[FXS_FIT_SH], real by_centre[2], real by_position[3])
{
    shape s;
    real by_t[2][3], along[3];
    find_shape(&s, camera, at, stride);
    /* Loss gradient by the splat's centre: -sum of h U^t (u, v), with h = -alpha dL/dalpha, normalised coordinates u
       and v, and U^t U the inverse covariance. */
    by_centre[0] = -(s.ux * sums[FXS_FIT_SUM_U]) * (1.0f / FXS_FIT_UNIT);
    by_centre[1] = -(s.uy * sums[FXS_FIT_SUM_U] + s.vy * sums[FXS_FIT_SUM_V]) * (1.0f / FXS_FIT_UNIT);
    covariance_gradient(&s, sums, by_t);
    if (camera->is_antialiased)
        add_share_gradient(&s, sums, by_t);
    shape_gradient(&s, camera, (const real(*)[3])by_t, by_centre, gradient, by_position);
    find_look(l, s.offset, degree, at, stride);
    colour_gradient(l, degree, at, stride, sums, g, along);
    for (int i = 0; i < 3; i++) {
        gradient[FXS_FIT_POSITION + i] = by_position[i] + along[i];
        gradient[FXS_FIT_COLOUR + i] = 0.282094792f * g[i];
    }
    /* Loss gradient by the logit of the opacity o: -(sum of h / o) o (1 - o), with h = -alpha dL/dalpha. */
    const real opacity = 1.0f / (1.0f + exp_of_minus(load(at + FXS_FIT_OPACITY * (ptrdiff_t)stride)));
    gradient[FXS_FIT_OPACITY] = -sums[FXS_FIT_SUM] * (1.0f - opacity);
}

static inline void find_gradient(const fxs_fit_camera *camera, int degree, const float *at, size_t stride,
                                 const real sums[FXS_FIT_SUMS], real gradient[FXS_FIT_PARAMETERS], real by_centre[2])
{
    look l;
    real g[3], by_position[3];
    find_gradient_but_sh(camera, degree, at, stride, sums, &l, g, gradient, by_centre, by_position);
    for (int k = 0; k < 15; k++)
        for (int c = 0; c < 3; c++)
            gradient[FXS_FIT_SH + 3 * k + c] = k < SH_COUNT(degree) ? l.basis[k] * g[c] : all(0);
}

/* Computes one Gaussian's share of the loss gradient by the camera's pose. out[0..2]: dL/dposition. out[3..5]:
   dL/dtheta for a rotation of the Gaussian by theta about the eye. This rotation changes position - eye, and the
   quaternion q by dq = (0, theta) q / 2. */
static inline void find_pose_gradient(const fxs_fit_camera *camera, int degree, const float *at, size_t stride,
                                      const real sums[FXS_FIT_SUMS], real out[FXS_FIT_POSE])
{
    look l;
    real colour[3], gradient[FXS_FIT_SH], by_centre[2], by_position[3], offset[3], q[4];
    find_gradient_but_sh(camera, degree, at, stride, sums, &l, colour, gradient, by_centre, by_position);
    for (int i = 0; i < 3; i++)
        offset[i] = load(at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride) - camera->eye[i];
    for (int i = 0; i < 4; i++)
        q[i] = load(at + (FXS_FIT_ROTATION + i) * (ptrdiff_t)stride);
    const real g[4] = {gradient[FXS_FIT_ROTATION], gradient[FXS_FIT_ROTATION + 1], gradient[FXS_FIT_ROTATION + 2],
                       gradient[FXS_FIT_ROTATION + 3]};
    const real turned[3] = {(g[1] * q[0] - g[0] * q[1]) + (g[3] * q[2] - g[2] * q[3]),
                            (g[2] * q[0] - g[0] * q[2]) + (g[1] * q[3] - g[3] * q[1]),
                            (g[3] * q[0] - g[0] * q[3]) + (g[2] * q[1] - g[1] * q[2])};
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = gradient[FXS_FIT_POSITION + i];
        out[3 + i] = (offset[j] * by_position[k] - offset[k] * by_position[j]) + 0.5f * turned[i];
    }
}

#endif
