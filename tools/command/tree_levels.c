/* Sorts the nodes of a scene's level-of-detail tree into levels, by the number of leaves below each node. Sums up sizes
   and errors of each level. */
#include "tree_levels.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "src/core/codes.h"
#include "command.h"

static uint32_t gaussians_in(const fxs_scene *scene, uint32_t chunk)
{
    uint32_t count = 0;
    for (uint32_t g = 0; g < FXS_CHUNK; g++)
        count += !fxs_slot_is_empty(scene, fxs_rows(scene, chunk), g);
    return count;
}

/* Returns the level of a tree node, the smallest k with 2^k >= leaves. It is clamped, because a damaged tree may count
   leaves repeatedly. */
static int level_of(uint64_t leaves)
{
    int level = 0;
    while (level < LEVELS_MOST - 1 && (uint64_t)1 << level < leaves)
        level++;
    return level;
}

static uint64_t add_up(uint64_t a, uint64_t b)
{
    return a < UINT64_MAX - b ? a + b : UINT64_MAX;
}

/* Counts the leaves below each tree node. Nodes are visited in descending order of their numbers, since children have
   higher numbers. */
static int count_leaves(const fxs_scene *scene, uint64_t *leaves)
{
    for (uint32_t i = scene->chunk_count - 1; i-- > 0;) {
        fxs_node node;
        const int error = fxs_node_read(&node, scene, i);
        if (error)
            return error;
        leaves[i] = 0;
        for (int k = 0; k < 2; k++) {
            const uint32_t child = node.children[k];
            leaves[i] = add_up(leaves[i], child < scene->chunk_count ? 1 : leaves[child - scene->chunk_count]);
        }
    }
    return 0;
}

static void add_node(scene_levels *l, const fxs_scene *scene, uint32_t i, uint64_t leaves)
{
    const int level = level_of(leaves);
    scene_level *s = &l->levels[level];
    fxs_node node;
    if (fxs_node_read(&node, scene, i))
        return;
    s->chunks++;
    s->gaussians += gaussians_in(scene, scene->chunk_count + i);
    s->error += exp2(node.gain_q8 / 256.0);
    s->size += node.size_q8 / 256.0;                       /* sum of base-2 logarithms, until the mean is computed */
    l->count = level + 1 > l->count ? level + 1 : l->count;
}

int levels_measure(scene_levels *l, const fxs_scene *scene)
{
    *l = (scene_levels){.chunk_bytes = scene->chunk_bytes + (uint32_t)sizeof(fxs_chunk),
                        .node_bytes = sizeof(fxs_node)};
    if (!scene->nodes)
        return 0;
    uint64_t *leaves = malloc((size_t)(scene->chunk_count - 1) * sizeof *leaves);
    if (!leaves)
        return fail(EXIT_FAILED, "out of memory");
    const int error = count_leaves(scene, leaves);
    for (uint32_t i = 0; i < scene->chunk_count && !error; i++)
        l->levels[0].gaussians += gaussians_in(scene, i);
    l->levels[0].chunks = scene->chunk_count;
    for (uint32_t i = 0; i + 1 < scene->chunk_count && !error; i++)
        add_node(l, scene, i, leaves[i]);
    for (int k = 1; k < l->count; k++)
        l->levels[k].size = l->levels[k].chunks ? exp2(l->levels[k].size / l->levels[k].chunks) : 0;
    free(leaves);
    return error ? fail(EXIT_FAILED, "%s", fxs_strerror(error)) : 0;
}

static uint64_t bytes_of(const scene_levels *l, int level)
{
    return (uint64_t)l->levels[level].chunks * (l->chunk_bytes + (level ? l->node_bytes : 0));
}

void levels_print_text(const scene_levels *l)
{
    puts("level      leaves     nodes   Gaussians         bytes        error         size");
    for (int i = l->count; i-- > 0;) {
        const scene_level *s = &l->levels[i];
        if (!s->chunks)
            continue;
        printf("%5d %11.0f %9" PRIu32 " %11" PRIu64 " %13" PRIu64, i, ldexp(1, i), s->chunks, s->gaussians,
               bytes_of(l, i));
        if (i)
            printf(" %12.4g %12.4g\n", s->error, s->size);
        else
            puts("            -            -");
    }
}

void levels_print_json(const scene_levels *l)
{
    const char *comma = "";
    printf("[");
    for (int i = l->count; i-- > 0;) {
        const scene_level *s = &l->levels[i];
        if (!s->chunks)
            continue;
        printf("%s{\"level\": %d, \"leaves\": %.0f, \"nodes\": %" PRIu32 ", \"gaussians\": %" PRIu64 ", \"bytes\": %"
               PRIu64, comma, i, ldexp(1, i), s->chunks, s->gaussians, bytes_of(l, i));
        printf(i ? ", \"error\": %.6g, \"size\": %.6g}" : ", \"error\": 0, \"size\": null}", s->error, s->size);
        comma = ", ";
    }
    printf("]");
}
