/* blend, for any vector of int16 lanes. The including file defines the vector and what depends on its width:
 *
 *   V, STEPS        a vector of 16-bit lanes; how many of them a tile is, in the order of its pixels
 *   coordinates     where the lanes' u is kept from step to step: coordinates_at sets it up, coordinates_next returns
 *                   u of a step (Q13, saturated) and goes on to the next
 *   row_levels      v^2 + offset of the 16 rows: row_levels_of, and row_level for the lanes of a step
 *   V_...           the operations below
 *
 * Levels are unsigned here. Where the C code cuts a coordinate to -32767, with the square 32766, a vector has -32768,
 * with the square 32768; and a level saturates at 65535, not 32767. All of these are above every limit, so such a pixel
 * takes nothing either way. An entry has to touch a row of the tile. */

#define AHEAD 14                   /* entries: a splat is fetched that much before it is blended */

typedef struct placed {
    int32_t u_q24, v_q24;
    int first_step, last_step, limit_q11;
} placed;

static inline placed place(const fxs_view *view, const fxs_splat *splat, uint32_t entry, int32_t x, int32_t y)
{
    uint32_t u = splat->u0_q24 + (uint32_t)x * (uint32_t)splat->ux_q24 + (uint32_t)y * (uint32_t)splat->uy_q24;
    uint32_t v = splat->v0_q24 + (uint32_t)y * (uint32_t)splat->vy_q24;
    int first = splat->first_row - y, last = splat->last_row - y;
    first = first < 0 ? 0 : first;
    last = last > FXS_TILE - 1 ? FXS_TILE - 1 : last;
    placed p = {(int32_t)u, (int32_t)v, first * STEPS / FXS_TILE, ((last + 1) * STEPS - 1) / FXS_TILE,
                fxs_limit_q11(splat->offset_q11, view->cut_q11)};
    if (__builtin_expect((entry & FXS_ENTRY_FAR) != 0, 0))
        p.u_q24 = p.v_q24 = FXS_FAR_Q24;
    return p;
}

/* exp(-level / 2), cut at 0.99: fxs_alpha_q15 */
static inline V alpha_of(V level)
{
    V p = V_ADD(V_MUL(V_SET1(-4236), level), V_SET1(16016));
    p = V_ADD(V_MUL(p, level), V_SET1(-32730));
    p = V_ADD(V_MUL(p, level), V_SET1(32767));
    p = V_MUL(p, p);
    p = V_MUL(p, p);
    p = V_MUL(p, p);
    return V_MIN(p, V_SET1(FXS_ALPHA_MAX_Q15));
}

void BLEND_FUNCTION(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
               uint32_t count, fxs_tile *tile)
{
    V transmittance[STEPS], sum[3][STEPS];
    unsigned open = ~0u >> (32 - STEPS);               /* steps with a pixel that takes more */
    for (int s = 0; s < STEPS; s++) {
        transmittance[s] = V_SET1(FXS_CLEAR_Q15);
        sum[0][s] = sum[1][s] = sum[2][s] = V_SET1(0);
    }
    for (uint32_t i = 0; i < count && open; i++) {
        if (i + AHEAD < count)
            __builtin_prefetch(&splats[entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        const fxs_splat *splat = &splats[entries[i] & ~FXS_ENTRY_FAR];
        placed p = place(view, splat, entries[i], x, y);
        const V limit = V_SET1((int16_t)p.limit_q11);
        const V red = V_SET1(splat->colour_q13[0]), green = V_SET1(splat->colour_q13[1]);
        const V blue = V_SET1(splat->colour_q13[2]);
        const row_levels levels = row_levels_of(p.v_q24, splat->vy_q24, splat->offset_q11);
        coordinates u = coordinates_at(p.u_q24, splat->ux_q24, splat->uy_q24, p.first_step);
        for (int s = p.first_step; s <= p.last_step; s++) {
            V u_q13 = coordinates_next(&u, s);
            V level = V_ADD_UNSIGNED(V_MUL(u_q13, u_q13), row_level(&levels, s));
            V t = transmittance[s];
            if (V_NONE_OPEN(t)) {
                open &= ~(1u << s);
                continue;
            }
            V weight = V_MUL(V_COUNTED(alpha_of(level), level, limit, t), t);
            transmittance[s] = V_SUB(t, weight);
            sum[0][s] = V_ADD_SIGNED(sum[0][s], V_MUL(weight, red));
            sum[1][s] = V_ADD_SIGNED(sum[1][s], V_MUL(weight, green));
            sum[2][s] = V_ADD_SIGNED(sum[2][s], V_MUL(weight, blue));
        }
    }
    for (int s = 0; s < STEPS; s++) {
        V_STORE_IN_ORDER(tile->transmittance_q15 + s * FXS_TILE_PIXELS / STEPS, transmittance[s]);
        for (int c = 0; c < 3; c++)
            V_STORE_IN_ORDER(tile->sum_q13[c] + s * FXS_TILE_PIXELS / STEPS, sum[c][s]);
    }
}
