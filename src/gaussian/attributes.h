/* Converts attributes between file formats and fxs_gaussian. */
#ifndef FXS_ATTRIBUTES_H
#define FXS_ATTRIBUTES_H

#include <math.h>

#include "src/base/exponential.h"

/* The SH basis of degree 0: 1 / (2 sqrt(pi)). */
#define FXS_SH_0 0.28209479177387814

/* ln(sigma) of the missing third axis of a 2D Gaussian. */
#define FXS_FLAT_SCALE (-20)

/* A logit that rounds to opacity 1 in every code. */
#define FXS_OPAQUE 20

/* ln(sigma), at least FXS_FLAT_SCALE, also for 0. Negative scales count by magnitude, because the covariance is the
   same. */
static inline float fxs_log_scale(double scale)
{
    const double size = fabs(scale);
    return size > 2.061153622438558e-9 ? (float)fxs_log(size) : size >= 0 ? FXS_FLAT_SCALE : NAN;
}

/* 1 / (1 + exp(-logit)) */
static inline double fxs_opacity_of_logit(double logit)
{
    return 1 / (1 + fxs_exp(-logit));
}

/* ln(opacity / (1 - opacity)); +-FXS_OPAQUE outside 0..1; NaN for NaN. */
static inline float fxs_logit_of_opacity(double opacity)
{
    return opacity <= 0 ? -FXS_OPAQUE : opacity >= 1 ? FXS_OPAQUE : (float)fxs_log(opacity / (1 - opacity));
}

/* fxs_logit_of_opacity(code / 255). */
static inline float fxs_logit_of_code(int code)
{
    return code <= 0 ? -FXS_OPAQUE : code >= 255 ? FXS_OPAQUE : (float)fxs_log(code / (255.0 - code));
}

/* The SH coefficient of degree 0 for a colour, 0 to 1. */
static inline float fxs_dc_of_colour(double colour)
{
    return (float)((colour - 0.5) / FXS_SH_0);
}

/* The colour for an SH coefficient of degree 0. */
static inline double fxs_colour_of_dc(double dc)
{
    return 0.5 + FXS_SH_0 * dc;
}

/* The rotation matrix of a quaternion of any length except 0. */
static inline void fxs_rotation_matrix(double rows[3][3], double w, double x, double y, double z)
{
    const double s = 2 / (w * w + x * x + y * y + z * z);
    rows[0][0] = 1 - s * (y * y + z * z), rows[0][1] = s * (x * y - w * z), rows[0][2] = s * (x * z + w * y);
    rows[1][0] = s * (x * y + w * z), rows[1][1] = 1 - s * (x * x + z * z), rows[1][2] = s * (y * z - w * x);
    rows[2][0] = s * (x * z - w * y), rows[2][1] = s * (y * z + w * x), rows[2][2] = 1 - s * (x * x + y * y);
}

#endif
