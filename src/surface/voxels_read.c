/* Reads voxels from X.voxel.json and X.voxel.bin. voxels_write.c describes the octree. Its words stay as they are, so
 * voxels take the memory of their file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/base/text_internal.h"
#include "src/base/try_internal.h"
#include "voxels.h"

static uint32_t ones(uint32_t mask)
{
    uint32_t count = 0;
    for (; mask; mask &= mask - 1)
        count++;
    return count;
}

int fxs_octree_solid(const fxs_octree *t, const uint32_t at[3])
{
    uint32_t node = 0;
    for (int level = t->depth; level >= 0; level--) {
        const uint32_t word = t->words[node], mask = word >> 24, number = word & FXS_NODE_NUMBER;
        if (word == FXS_SOLID_NODE)
            return 1;
        if (!mask) {
            const uint32_t bit = 16 * (at[2] & 3) + 4 * (at[1] & 3) + (at[0] & 3);
            return t->words[t->nodes + 2 * number + bit / 32] >> bit % 32 & 1;
        }
        const int to = level + 1;
        const uint32_t child = (at[2] >> to & 1) << 2 | (at[1] >> to & 1) << 1 | (at[0] >> to & 1);
        if (!(mask >> child & 1))
            return 0;
        node = number + ones(mask & ((1u << child) - 1));
    }
    return 0;
}

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

enum { DEPTH_MOST = 22 };

static const cJSON *item_of(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static int refuse(const char *path, const char *why, fxs_message *m)
{
    return fxs_fail_as(FXS_ERR_FILE, m, "%s: %s", path, why);
}

/* Takes the box and the size of the octree. */
static int take_facts(fxs_voxels *v, const cJSON *root, const char *path, fxs_message *m)
{
    double low[3], high[3];
    size_t depth, leaf, nodes, leaves;
    const cJSON *box = item_of(root, "gridBounds"), *voxel = item_of(root, "voxelResolution");
    const double size = cJSON_IsNumber(voxel) ? voxel->valuedouble : 0;
    if (!fxs_json_numbers(item_of(box, "min"), low, 3) || !fxs_json_numbers(item_of(box, "max"), high, 3) ||
        !fxs_json_whole(item_of(root, "leafSize"), 4, &leaf) || leaf != 4 || !(size >= 0x1p-16 && size <= 0x1p16) ||
        !fxs_json_whole(item_of(root, "treeDepth"), DEPTH_MOST, &depth) ||
        !fxs_json_whole(item_of(root, "nodeCount"), FXS_NODE_NUMBER + 1u, &nodes) || !nodes ||
        !fxs_json_whole(item_of(root, "leafDataCount"), 2 * (FXS_NODE_NUMBER + 1u), &leaves))
        return refuse(path, "is no .voxel.json, or its numbers are out of range", m);
    v->tree = (fxs_octree){.depth = (int)depth, .nodes = (uint32_t)nodes, .leaf_words = (uint32_t)leaves};
    v->info.voxel = size;
    for (int i = 0; i < 3; i++) {
        const double first = floor(low[i] / size + 0.5), count = floor((high[i] - low[i]) / size + 0.5);
        if (!(fabs(first) <= 0x1p29 && count >= 1 && count <= ldexp(4, (int)depth)))
            return refuse(path, "its box does not fit its octree", m);
        v->origin[i] = v->info.low[i] = (int32_t)first;
        v->info.high[i] = (int32_t)(first + count);
    }
    return 0;
}

/* Checks that all numbers of words are in the file. Children lie behind their node. */
static int check_words(const fxs_octree *t)
{
    for (uint32_t i = 0; i < t->nodes; i++) {
        const uint32_t word = t->words[i], mask = word >> 24, number = word & FXS_NODE_NUMBER;
        if (word != FXS_SOLID_NODE && (mask ? number <= i || number + ones(mask) > t->nodes
                                            : 2 * number + 2 > t->leaf_words))
            return 0;
    }
    return 1;
}

static int read_words(fxs_voxels *v, const char *path, fxs_message *m)
{
    fxs_text text;
    fxs_octree *t = &v->tree;
    FXS_TRY(fxs_text_load(path, &text, m));
    t->words = (uint32_t *)(void *)text.data;
    if (text.size != ((size_t)t->nodes + t->leaf_words) * sizeof *t->words)
        return refuse(path, "has another size than its .voxel.json tells", m);
    for (uint32_t i = 0; i < t->nodes + t->leaf_words; i++)
        t->words[i] = fxs_little_32(t->words[i]);
    return check_words(t) ? 0 : refuse(path, "is damaged", m);
}

static int read_facts(fxs_voxels *v, const char *path, fxs_message *m)
{
    fxs_text text;
    cJSON *root = NULL;
    FXS_TRY(fxs_text_load(path, &text, m));
    int error = fxs_json_parse(&text, NULL, &root, m);
    error = error ? error : take_facts(v, root, path, m);
    cJSON_Delete(root);
    free(text.data);
    return error;
}

static int read_files(fxs_voxels *v, const char *path, fxs_message *m)
{
    const size_t length = strlen(path) - strlen("json");
    FXS_TRY(read_facts(v, path, m));
    char *bin = fxs_allocate(NULL, length + sizeof "bin", 1);
    if (!bin)
        return fxs_fail_memory(m, path, 0);
    memcpy(bin, path, length);
    memcpy(bin + length, "bin", sizeof "bin");
    const int error = read_words(v, bin, m);
    fxs_release(NULL, bin);
    return error;
}

#else

static int read_files(fxs_voxels *v, const char *path, fxs_message *m)
{
    (void)v;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, m, "%s: cannot be read: built without cJSON", path);
}

#endif

int fxs_voxels_read(fxs_voxels **voxels, const char *path, fxs_message *message)
{
    const size_t length = strlen(path), ending = strlen(".voxel.json");
    *voxels = NULL;
    if (length <= ending || strcmp(path + length - ending, ".voxel.json"))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: expected a name ending in .voxel.json", path);
    fxs_voxels *v = fxs_allocate_zeroed(NULL, 1, sizeof *v);
    if (!v)
        return fxs_fail_memory(message, path, sizeof *v);
    const int error = read_files(v, path, message);
    if (error)
        fxs_voxels_free(v);
    else
        *voxels = v;
    return error;
}
