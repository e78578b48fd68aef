/* Attributes as the compact formats hold them, to the units of fxs_gaussian. */
#ifndef FXS_SCENE_CODES_H
#define FXS_SCENE_CODES_H

#include <math.h>

#include "src/base/exponential.h"

/* ln of the standard deviation of what has none, across a 2D Gaussian. */
#define FXS_FLAT_SCALE (-20)

/* ln of a standard deviation, from FXS_FLAT_SCALE on, where 0 goes. One below 0 has the covariance of its magnitude. */
static inline float fxs_log_scale(double scale)
{
    const double size = fabs(scale);
    return size > 2.061153622438558e-9 ? (float)fxs_log(size) : size >= 0 ? FXS_FLAT_SCALE : NAN;
}

/* Logit of the opacity code / 255, +-20 at the ends. */
static inline float fxs_logit_of_code(int code)
{
    return code <= 0 ? -20 : code >= 255 ? 20 : (float)fxs_log(code / (255.0 - code));
}

/* SH degree 0 of a colour, 0 to 1. */
static inline float fxs_dc_of_colour(double colour)
{
    return (float)((colour - 0.5) / 0.28209479177387814);
}

#endif
