/* Debug view of the levels of detail (options.show_levels): colours each splat by the level of its chunk. */
#include "show.h"

#include <fixsplat/internal/fixed.h>

/* Returns the colour that shows a chunk's level in the level-of-detail tree. The level of a node is log2 of its number
   of leaves. Node number n covers about chunk_count / (n + 1) leaves. */
static const int32_t *colour_of_level_q2(const fxs_scene *scene, uint32_t chunk)
{
    static const int32_t colours_q2[7][3] = {{4, 4, 4}, {1, 4, 1}, {1, 4, 4}, {1, 2, 4}, {4, 1, 4}, {4, 1, 1},
                                             {4, 3, 0}};
    if (chunk < scene->chunk_count)
        return colours_q2[0];
    const uint32_t leaves = scene->chunk_count / (chunk - scene->chunk_count + 1);
    return colours_q2[1 + (uint32_t)(31 - fxs_clz32(leaves | 1)) % 6];
}

void fxs_show_level(const fxs_object_view *object, uint32_t chunk, fxs_splat *splats, uint32_t count)
{
    const int32_t *colour_q2 = colour_of_level_q2(&object->scene, chunk);
    for (uint32_t i = 0; i < count; i++) {
        int16_t *c = splats[i].colour_q13;
        const int32_t brightness_q13 = (c[0] + 2 * c[1] + c[2]) >> 2;
        for (int k = 0; k < 3; k++)
            c[k] = (int16_t)(brightness_q13 * colour_q2[k] >> 2);
    }
}
