/* Finds the pixels of a 16x16 tile that a splat (a projected Gaussian) can touch. A pixel's level is u^2 + v^2 +
 * offset in the splat's coordinates u and v; larger levels are fainter. Margins cover rounding errors. */
#ifndef FXS_CUDA_TILE_WALK_CUH
#define FXS_CUDA_TILE_WALK_CUH

#include "blend.cuh"

namespace {

struct tile_splats {
    const fxs_splat *splats;
    int cut_q11;
    int32_t x, y;

    __device__ tile_splats(const fxs_stage_view *view, const frame_buffers *f, uint32_t tile)
        : splats(f->splats), cut_q11(view->cut_q11), x((int32_t)(tile % (uint32_t)view->tiles_x) * FXS_TILE),
          y((int32_t)(tile / (uint32_t)view->tiles_x) * FXS_TILE)
    {
    }

    __device__ fxs_splat splat_of(uint64_t key) const
    {
        __builtin_assume(__isGlobal(splats));
        return load_splat(&splats[key & FXS_ENTRY_CUT_OFF ? 0 : (uint32_t)key]);
    }
};

__device__ inline uint32_t whole(float x)
{
    return (uint32_t)__float_as_int(__fadd_rd(fminf(fmaxf(x, 0), 31), 8388608.0f)) % 32;
}

/* Returns the largest |u| with u^2 <= left, plus a margin above the rounding error. u is a pixel's coordinate relative
   to a splat. */
__device__ inline float reach_of(float left)
{
    return approximate_root(fmaxf(left, 0) + 1) * 1.0001f + 0.05f;
}

/* Returns a bit mask of the pixels in a row that a splat can touch. */
__device__ inline uint32_t pixels_of_row(uint32_t u_q24, float inverse, float left)
{
    const float u = coordinate_q6(u_q24), reach = reach_of(left);
    const uint32_t first = whole((-reach - u) * inverse + 0.95f);
    const uint32_t end = whole(fminf((reach - u) * inverse + 1.05f, FXS_TILE));
    return left >= 0 && first < end ? (1u << end) - (1u << first) : 0;
}

struct row_walk {
    uint32_t u_q24, v_q24;
    float inverse, limit;

    __device__ row_walk(const tile_splats *t, const fxs_splat *s, int32_t row)
    {
        const uint32_t y = (uint32_t)(t->y + row);
        u_q24 = s->u0_q24 + (uint32_t)t->x * (uint32_t)s->ux_q24 + y * (uint32_t)s->uy_q24;
        v_q24 = s->v0_q24 + y * (uint32_t)s->vy_q24;
        inverse = __fdividef(262144, (float)max(s->ux_q24, 1));
        limit = __int_as_float(limit_bits(s, t->cut_q11));
    }

    __device__ uint32_t next(const fxs_splat *s)
    {
        const uint32_t pixels = pixels_of_row(u_q24, inverse, limit - row_level(v_q24, s->offset_q11));
        u_q24 += (uint32_t)s->uy_q24;
        v_q24 += (uint32_t)s->vy_q24;
        return pixels;
    }
};

/* Returns a bit mask of the tile's pixel columns that a splat can touch. The splat's coordinate u is linear, so its
   extremes lie in the first or last row. The margin of 5 exceeds the rounding error of a pixel's level, u^2 + v^2 +
   offset. */
__device__ inline uint32_t columns_of(const tile_splats *t, const fxs_splat *s)
{
    const int32_t first_row = max((int32_t)s->first_row - t->y, 0);
    const int32_t last_row = min((int32_t)s->last_row - t->y, FXS_TILE - 1);
    const row_walk at(t, s, first_row);
    const uint32_t rows = (uint32_t)(last_row - first_row);
    const float u[2] = {coordinate_q6(at.u_q24), coordinate_q6(at.u_q24 + rows * (uint32_t)s->uy_q24)};
    const float v[2] = {coordinate_q6(at.v_q24), coordinate_q6(at.v_q24 + rows * (uint32_t)s->vy_q24)};
    const float least_v = fmaxf(fmaxf(fminf(v[0], v[1]), -fmaxf(v[0], v[1])), 0);
    const float left = at.limit - 8388608.0f - (float)(2 * s->offset_q11) - least_v * least_v + 5;
    const float reach = reach_of(left);
    const uint32_t first = whole((-reach - fmaxf(u[0], u[1])) * at.inverse + 0.95f);
    const uint32_t end = whole(fminf((reach - fminf(u[0], u[1])) * at.inverse + 1.05f, FXS_TILE));
    return first_row <= last_row && left >= 0 && first < end ? (1u << end) - (1u << first) : 0;
}

}

#endif
