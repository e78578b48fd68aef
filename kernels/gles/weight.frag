// Fixed-point products with factors from 0 to 32767. The macro FACTOR tells the compiler this range.
FXS_FN int fxs_product_q15(int a, int b)
{
    return (FACTOR(a) * FACTOR(b) + 16384) >> 15;
}

// Returns exp(-level / 2) in Q15, like fxs_alpha_q15, but rearranged so that no factor is negative: -((a b + 16383) >>
// 15) = (-a b + 16384) >> 15.
FXS_FN int fxs_exp_q15(int level_q11)
{
    int x = FACTOR(level_q11);
    int p = 16016 - ((4236 * x + 16383) >> 15);
    p = 32730 - fxs_product_q15(p, x);
    p = 32767 - ((FACTOR(p) * x + 16383) >> 15);
    p = fxs_product_q15(p, p);
    p = fxs_product_q15(p, p);
    p = fxs_product_q15(p, p);
    return min(FACTOR(p), FXS_ALPHA_MAX_Q15);
}

// Returns the magnitude of a splat coordinate in Q13, without saturation.
FXS_FN int fxs_distance_q13(int coordinate_q24)
{
    return abs(coordinate_q24 >> 11);
}
