/* Converts attributes of Gaussians between file formats and fxs_gaussian. */
#ifndef FXS_ATTRIBUTES_H
#define FXS_ATTRIBUTES_H

#include <math.h>

#include "src/base/exponential.h"

/* Value of the SH basis function of degree 0: 1 / (2 sqrt(pi)). */
#define FXS_SH_0 0.28209479177387814

/* ln(sigma) that stands for the missing third axis of a 2D Gaussian. */
#define FXS_FLAT_SCALE (-20)

/* Opacity logit that becomes opacity 1 however opacities are quantised. */
#define FXS_OPAQUE 20

/* Returns ln(|scale|), at least FXS_FLAT_SCALE. The sign of a scale has no effect on the covariance. */
static inline float fxs_log_scale(double scale)
{
    const double size = fabs(scale);
    return size > 2.061153622438558e-9 ? (float)fxs_log(size) : size >= 0 ? FXS_FLAT_SCALE : NAN;
}

static inline double fxs_opacity_of_logit(double logit)
{
    return 1 / (1 + fxs_exp(-logit));
}

/* Returns the logit ln(opacity / (1 - opacity)), or +-FXS_OPAQUE for an opacity outside 0..1. NaN gives NaN. */
static inline float fxs_logit_of_opacity(double opacity)
{
    return opacity <= 0 ? -FXS_OPAQUE : opacity >= 1 ? FXS_OPAQUE : (float)fxs_log(opacity / (1 - opacity));
}

static inline float fxs_logit_of_code(int code)
{
    return code <= 0 ? -FXS_OPAQUE : code >= 255 ? FXS_OPAQUE : (float)fxs_log(code / (255.0 - code));
}

static inline float fxs_dc_of_colour(double colour)
{
    return (float)((colour - 0.5) / FXS_SH_0);
}

static inline double fxs_colour_of_dc(double dc)
{
    return 0.5 + FXS_SH_0 * dc;
}

/* Computes the rotation matrix of a quaternion of any length except 0. */
static inline void fxs_rotation_matrix(double rows[3][3], double w, double x, double y, double z)
{
    const double s = 2 / (w * w + x * x + y * y + z * z);
    rows[0][0] = 1 - s * (y * y + z * z), rows[0][1] = s * (x * y - w * z), rows[0][2] = s * (x * z + w * y);
    rows[1][0] = s * (x * y + w * z), rows[1][1] = 1 - s * (x * x + z * z), rows[1][2] = s * (y * z - w * x);
    rows[2][0] = s * (x * z - w * y), rows[2][1] = s * (y * z + w * x), rows[2][2] = 1 - s * (x * x + y * y);
}

/* Computes the product a b of quaternions w, x, y, z. */
static inline void fxs_quaternion_product(double out[4], const double a[4], const double b[4])
{
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3];
    out[3] = a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1];
}

#endif
