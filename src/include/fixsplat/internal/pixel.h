/* Computes the contribution of one Gaussian to one pixel. The file is compiled as C99, CUDA C and GLSL ES 3.00: one
 * integer type of 32 bits, no division, no pointers, intermediates below 2^31. FXS_FN precedes each function:
 * `static inline` by default, empty in GLSL.
 *
 * A splat has whitened coordinates (u, v): distance^2 = u^2 + v^2, with v constant on a row of pixels. offset = -2
 * ln(opacity) and level = distance^2 + offset = -2 ln(alpha). The limit min(9 + offset, 2 ln 255) of the level
 * combines the Mahalanobis cut-off and the 1/255 cut-off. */
#ifndef FXS_PIXEL_H
#define FXS_PIXEL_H

#ifndef FXS_FN
#define FXS_FN static inline
#endif

#define FXS_CUT_Q11 18432          /* square of the largest Mahalanobis distance: 9 */
#define FXS_FAINT_Q11 22697        /* -2 ln(alpha) at the smallest alpha that is drawn, 1/255: 2 ln 255 */
#define FXS_LEVEL_MAX_Q11 32767
#define FXS_ALPHA_MAX_Q15 32440    /* largest alpha of a Gaussian at a pixel: 0.99 */
#define FXS_CLEAR_Q15 32767        /* transmittance of a pixel that no Gaussian has touched */
#define FXS_CLOSED_Q15 33          /* transmittance 0.001, below which a pixel accepts no more Gaussians */

/* Multiplies two numbers in Q15, rounded to nearest, as the instructions pmulhrsw, vqrdmulh and i16x8.q15mulr_sat
   compute it. |a|, |b| <= 32768, not both -32768. */
FXS_FN int fxs_mul_q15(int a, int b)
{
    return (a * b + 16384) >> 15;
}

FXS_FN int fxs_min(int a, int b)
{
    return a < b ? a : b;
}

/* Converts a coordinate u or v of a splat to Q13 and clamps it to +-4; nothing is drawn beyond 3.34. */
FXS_FN int fxs_coordinate_q13(int coordinate_q24)
{
    int c = coordinate_q24 >> 11;
    return c < -32767 ? -32767 : fxs_min(c, 32767);
}

/* The part of a splat's level that is constant on a row of pixels: v^2 + offset, with offset_q11 in 0..22697. */
FXS_FN int fxs_row_level_q11(int v_q13, int offset_q11)
{
    return fxs_min(fxs_mul_q15(v_q13, v_q13) + offset_q11, FXS_LEVEL_MAX_Q11);
}

/* The level of a splat at a pixel, u^2 + v^2 + offset, which is -2 ln(alpha). */
FXS_FN int fxs_level_q11(int u_q13, int row_level_q11)
{
    return fxs_min(fxs_mul_q15(u_q13, u_q13) + row_level_q11, FXS_LEVEL_MAX_Q11);
}

/* Returns the largest level, -2 ln(alpha), that still contributes to a pixel. `cut` is 9, or 16 without the Mahalanobis
   cut-off. */
FXS_FN int fxs_limit_q11(int offset_q11, int cut_q11)
{
    return fxs_min(offset_q11 + cut_q11, FXS_FAINT_Q11);
}

/* Returns a b + c for numbers in Q15, rounded to nearest. The sum before rounding must fit in 32 bits. */
FXS_FN int fxs_mul_add_q15(int a, int b, int c)
{
    return (a * b + (c * 32768 + 16384)) >> 15;
}

/* Computes alpha from the level -2 ln(alpha): min(0.99, exp(-level / 2)) = min(0.99, exp(-x)^8), x = level / 16: Q11
   read as Q15. level_q11 is 0 to 22697. exp(-x) is a fitted cubic: error at most 3.6e-4, rms 4.5e-5. */
FXS_FN int fxs_alpha_q15(int level_q11)
{
    int p = fxs_mul_add_q15(-4236, level_q11, 16016);
    p = fxs_mul_add_q15(p, level_q11, -32730);
    p = fxs_mul_add_q15(p, level_q11, 32767);
    p = fxs_mul_q15(p, p);
    p = fxs_mul_q15(p, p);
    p = fxs_mul_q15(p, p);
    return fxs_min(p, FXS_ALPHA_MAX_Q15);
}

/* One blend step of a pixel with transmittance T and colour sum C: weight = alpha T; T' = T - weight; C' = C + weight
   colour. T stays in 0..32767. The weights add up to exactly the loss of T. A pixel with T < FXS_CLOSED_Q15 accepts no
   more Gaussians. */
FXS_FN int fxs_weight_q15(int alpha_q15, int transmittance_q15)
{
    return fxs_mul_q15(alpha_q15, transmittance_q15);
}

/* Adds a weighted colour to a pixel's sum. colour_q13 is 0 to 32767 (colour 0 to 4). The sum saturates at 32767. */
FXS_FN int fxs_accumulate_q13(int sum_q13, int weight_q15, int colour_q13)
{
    return fxs_min(sum_q13 + fxs_mul_q15(weight_q15, colour_q13), 32767);
}

/* Converts a pixel's blended colour c, including transmittance times background, to 8 bits: min(255, round(255 c)). */
FXS_FN int fxs_resolve_8bit(int sum_q13, int transmittance_q15, int background_q13)
{
    return fxs_min((fxs_accumulate_q13(sum_q13, transmittance_q15, background_q13) * 255 + 4096) >> 13, 255);
}

/* Converts a pixel's coverage, 1 - transmittance, to 8 bits. */
FXS_FN int fxs_coverage_8bit(int transmittance_q15)
{
    return ((FXS_CLEAR_Q15 - transmittance_q15) * 255 + 16384) >> 15;
}

#endif
