/* Reads the attribute codes of LANES packed Gaussians together. src/core/codes.h is the scalar version. */
#include "src/core/codes.h"
#include "lanes.h"
#include "stages.h"

static inline vi spread_11(vi code)
{
    return code << 5 | code >> 6;
}

static inline vi spread_scale(vi x, vi y, vi z)
{
    return (x << 3 | x >> 4) | (y << 3 | y >> 4) << 10 | (z << 3 | z >> 3) << 20;
}

static inline void load_positions(vi code[3], const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile == FXS_PROFILE_SMALL) {
        vi a = load(rows + FXS_SMALL_A + 4 * i), b = load(rows + FXS_SMALL_B + 4 * i);
        code[0] = spread_11(a & 2047);
        code[1] = spread_11(a >> 11 & 2047);
        code[2] = spread_11(b & 2047);
        return;
    }
    const uint16_t *position = (const uint16_t *)(const void *)(rows + FXS_ROW_POSITION) + i;
    for (int k = 0; k < 3; k++)
        code[k] = load_u16(position + k * FXS_CHUNK);
}

static inline vi load_scales(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile != FXS_PROFILE_SMALL)
        return load(rows + FXS_ROW_SCALE + 4 * i);
    vi c = load(rows + FXS_SMALL_C + 4 * i);
    return spread_scale(c & 127, c >> 7 & 127, c >> 14 & 63);
}

static inline vi load_rotations(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile != FXS_PROFILE_SMALL)
        return load(rows + FXS_ROW_ROTATION + 4 * i);
    vi a = load(rows + FXS_SMALL_A + 4 * i), b = load(rows + FXS_SMALL_B + 4 * i), c = load(rows + FXS_SMALL_C + 4 * i);
    vi d = load_i8((const int8_t *)rows + FXS_SMALL_D + i) & 255;
    return (c & (int32_t)0xfff00000) | d << 12 | (a >> 22 & 3) << 10 | (vi)((vu)b >> 31) << 9;
}

static inline vi load_opacities(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    return (vi)((vu)load(rows + (scene->profile == FXS_PROFILE_SMALL ? FXS_SMALL_A : FXS_ROW_COLOUR) + 4 * i) >> 24);
}

static inline void load_colours(vi code[3], const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile == FXS_PROFILE_SMALL) {
        const vi b = load(rows + FXS_SMALL_B + 4 * i), red = b >> 11 & 127, green = b >> 18 & 127, blue = b >> 25 & 63;
        code[0] = red << 2 | red >> 5;
        code[1] = green << 2 | green >> 5;
        code[2] = blue << 3 | blue >> 3;
        return;
    }
    const vi upper = load(rows + FXS_ROW_COLOUR + 4 * i), low = load(rows + FXS_ROW_SCALE + 4 * i);
    code[0] = (upper << 1 & 510) | (low >> 29 & 1);
    code[1] = (upper >> 7 & 510) | (low >> 30 & 1);
    code[2] = (upper >> 15 & 510) | (low >> 31 & 1);
}
