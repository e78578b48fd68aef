/* Converts attributes between the numbers of file formats and those of fxs_gaussian. */
#ifndef FXS_ATTRIBUTES_H
#define FXS_ATTRIBUTES_H

#include <math.h>

#include "src/base/exponential.h"

/* The SH basis of degree 0: 1 / (2 sqrt(pi)). */
#define FXS_SH_0 0.28209479177387814

/* ln of the standard deviation across a 2D Gaussian, which has none. */
#define FXS_FLAT_SCALE (-20)

/* The logit of an opacity that is 1 in any code. */
#define FXS_OPAQUE 20

/* ln of a standard deviation, at least FXS_FLAT_SCALE, also for 0. A negative one has the covariance of its magnitude.
   */
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

/* ln(opacity / (1 - opacity)), +-FXS_OPAQUE where the opacity is not between 0 and 1; NaN of NaN. */
static inline float fxs_logit_of_opacity(double opacity)
{
    return opacity <= 0 ? -FXS_OPAQUE : opacity >= 1 ? FXS_OPAQUE : (float)fxs_log(opacity / (1 - opacity));
}

/* The same for the opacity code / 255. */
static inline float fxs_logit_of_code(int code)
{
    return code <= 0 ? -FXS_OPAQUE : code >= 255 ? FXS_OPAQUE : (float)fxs_log(code / (255.0 - code));
}

/* The coefficient of SH degree 0 for a colour, 0 to 1. */
static inline float fxs_dc_of_colour(double colour)
{
    return (float)((colour - 0.5) / FXS_SH_0);
}

/* The colour of a coefficient of SH degree 0. */
static inline double fxs_colour_of_dc(double dc)
{
    return 0.5 + FXS_SH_0 * dc;
}

/* The rotation matrix of a quaternion of any length but 0. */
static inline void fxs_rotation_matrix(double rows[3][3], double w, double x, double y, double z)
{
    const double s = 2 / (w * w + x * x + y * y + z * z);
    rows[0][0] = 1 - s * (y * y + z * z), rows[0][1] = s * (x * y - w * z), rows[0][2] = s * (x * z + w * y);
    rows[1][0] = s * (x * y + w * z), rows[1][1] = 1 - s * (x * x + z * z), rows[1][2] = s * (y * z - w * x);
    rows[2][0] = s * (x * z - w * y), rows[2][1] = s * (y * z + w * x), rows[2][2] = 1 - s * (x * x + y * y);
}

#endif
