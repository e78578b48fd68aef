/* src/codes.h, LANES Gaussians at a time. Include lanes_avx2.h or lanes_avx512.h first. */
#include "../../src/codes.h"
#include "lanes.h"

/* 12 bits to 16 */
static inline vi spread_12(vi code)
{
    return code << 4 | code >> 8;
}

/* Three codes of 8 bits, in the low bits of each 10, to 10. */
static inline vi spread_8(vi word)
{
    return word << 2 | (word >> 6 & 0x00300c03);
}

static inline void load_positions(vi code[3], const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile == FXS_PROFILE_SMALL) {
        vi a = load(rows + FXS_SMALL_A + 4 * i), b = load(rows + FXS_SMALL_B + 4 * i);
        code[0] = spread_12(a & 4095);
        code[1] = spread_12(a >> 12 & 4095);
        code[2] = spread_12(b & 4095);
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
    return spread_8((c & 255) | (c & 0xff00) << 2 | (c & 0xff0000) << 4);
}

static inline vi load_rotations(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile != FXS_PROFILE_SMALL)
        return load(rows + FXS_ROW_ROTATION + 4 * i);
    vi b = load(rows + FXS_SMALL_B + 4 * i), c = load(rows + FXS_SMALL_C + 4 * i);
    vi d = load_u16((const uint16_t *)(const void *)(rows + FXS_SMALL_D) + i);
    vi first = (vi)((vu)c >> 24);
    return spread_8(d >> 8 | (d & 255) << 10 | first << 20) | (b >> 12) << 30;
}

static inline vi load_colours(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile != FXS_PROFILE_SMALL)
        return load(rows + FXS_ROW_COLOUR + 4 * i);
    vi red_green = (vi)((vu)load(rows + FXS_SMALL_B + 4 * i) >> 16);
    return red_green | (load_i8((const int8_t *)rows + FXS_SMALL_E + i) & 255) << 16;
}
