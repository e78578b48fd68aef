/* Writes voxels as X.voxel.json and X.voxel.bin, the sparse octree of splat-transform 3 (version 1.1).
 *
 * A leaf of the octree is a block of 4^3 voxels; a node of the level above has up to 8 blocks, child 4 z + 2 y + x.
 * Nodes are 32-bit words, level by level from the root, the children of a node side by side:
 *
 *   0xff000000                         all voxels below are solid
 *   mask << 24 | number                a node with the children of the mask; `number` is the first child's word
 *   number                             a block; two words of `leaves` from 2 number on have bit 16 z + 4 y + x */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/packed.h>
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/base/output_internal.h"
#include "src/base/try_internal.h"
#include "voxels.h"

enum { EMPTY, SOLID, MIXED, LEVELS_MOST = 24, NUMBER_MOST = FXS_NODE_NUMBER };

/* Nodes of a level of the octree, from the blocks (level 0) on. */
typedef struct level {
    int32_t n[3];
    unsigned char *states;
} level;

typedef struct words {
    uint32_t *at;
    size_t count, room;
} words;

typedef struct octree {
    const fxs_voxels *voxels;
    level levels[LEVELS_MOST];
    int depth;                     /* number of the level with the root */
    uint32_t inner;                /* nodes with children */
    words nodes, leaves;
    words open, next;              /* places of the nodes of a level whose children are written next: x, y, z, word */
    fxs_message *message;
} octree;

static int add(octree *t, words *w, uint32_t word)
{
    if (w->count == w->room) {
        const size_t room = w->room ? 2 * w->room : 1024;
        uint32_t *larger = fxs_enlarge(NULL, w->at, w->count, room, sizeof *w->at);
        if (!larger)
            return fxs_fail_memory(t->message, NULL, 0);
        w->at = larger;
        w->room = room;
    }
    w->at[w->count++] = word;
    return 0;
}

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* Blocks outside of the grid are solid. */
static uint64_t block_bits(const fxs_voxels *v, int32_t x, int32_t y, int32_t z)
{
    const int32_t block[3] = {x, y, z};
    int32_t at[3];
    uint64_t bits = 0;
    for (int i = 0; i < 3; i++) {
        at[i] = v->info.low[i] - v->origin[i] + 4 * block[i];
        if (at[i] < 0 || at[i] >= v->solid.n[i] * FXS_CELL)
            return UINT64_MAX;
    }
    for (int row = 0; row < 16; row++) {
        const uint32_t word = fxs_bits_row(&v->solid, at[0] >> 5, at[1] + row % 4, at[2] + row / 4);
        bits |= (uint64_t)(word >> (at[0] & 31) & 15) << 4 * row;
    }
    return bits;
}

static unsigned char state_at(const level *l, int32_t x, int32_t y, int32_t z)
{
    return x >= l->n[0] || y >= l->n[1] || z >= l->n[2] ? EMPTY
           : l->states[(size_t)x + (size_t)l->n[0] * ((size_t)y + (size_t)l->n[1] * (size_t)z)];
}

/* Returns the mask of a node's children that are not empty; *solid receives the mask of solid ones. */
static uint32_t children_of(const level *below, int32_t x, int32_t y, int32_t z, uint32_t *solid)
{
    uint32_t mask = 0;
    *solid = 0;
    for (int i = 0; i < 8; i++) {
        const unsigned char state = state_at(below, 2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2));
        mask |= (uint32_t)(state != EMPTY) << i;
        *solid |= (uint32_t)(state == SOLID) << i;
    }
    return mask;
}

static unsigned char state_of(const octree *t, int number, int32_t x, int32_t y, int32_t z)
{
    uint32_t solid;
    if (number == 0) {
        const uint64_t bits = block_bits(t->voxels, x, y, z);
        return !bits ? EMPTY : ~bits ? MIXED : SOLID;
    }
    const uint32_t mask = children_of(&t->levels[number - 1], x, y, z, &solid);
    return !mask ? EMPTY : solid == 255 ? SOLID : MIXED;
}

static int make_level(octree *t, int number)
{
    level *l = &t->levels[number];
    const fxs_voxels_info *info = &t->voxels->info;
    size_t i = 0;
    for (int axis = 0; axis < 3; axis++)
        l->n[axis] = number ? (t->levels[number - 1].n[axis] + 1) / 2 : (info->high[axis] - info->low[axis]) / 4;
    l->states = fxs_allocate(NULL, (size_t)l->n[0] * (size_t)l->n[1], (size_t)l->n[2]);
    if (!l->states)
        return fxs_fail_memory(t->message, NULL, 0);
    for (int32_t z = 0; z < l->n[2]; z++)
        for (int32_t y = 0; y < l->n[1]; y++)
            for (int32_t x = 0; x < l->n[0]; x++)
                l->states[i++] = state_of(t, number, x, y, z);
    return 0;
}

static int make_levels(octree *t)
{
    const level *top = t->levels;
    FXS_TRY(make_level(t, 0));
    for (t->depth = 0; t->depth < 1 || top->n[0] > 1 || top->n[1] > 1 || top->n[2] > 1; top = &t->levels[t->depth]) {
        t->depth++;
        FXS_TRY(make_level(t, t->depth));
    }
    return 0;
}

/* ---- Nodes ------------------------------------------------------------------------------------------------------- */

static int add_leaf(octree *t, int32_t x, int32_t y, int32_t z)
{
    const uint64_t bits = block_bits(t->voxels, x, y, z);
    FXS_TRY(add(t, &t->nodes, (uint32_t)(t->leaves.count / 2)));
    FXS_TRY(add(t, &t->leaves, (uint32_t)bits));
    return add(t, &t->leaves, (uint32_t)(bits >> 32));
}

/* Adds a node of a level, and opens it if it has children. */
static int add_node(octree *t, int number, const int32_t at[3])
{
    const unsigned char state = state_at(&t->levels[number], at[0], at[1], at[2]);
    if (t->nodes.count > NUMBER_MOST || t->leaves.count / 2 > NUMBER_MOST)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, t->message, "more than 2^24 nodes, which a .voxel.json cannot hold: "
                           "make voxels larger");
    if (state == EMPTY)
        return 0;
    if (state == SOLID)
        return add(t, &t->nodes, FXS_SOLID_NODE);
    if (number == 0)
        return add_leaf(t, at[0], at[1], at[2]);
    for (int i = 0; i < 3; i++)
        FXS_TRY(add(t, &t->next, (uint32_t)at[i]));
    FXS_TRY(add(t, &t->next, (uint32_t)t->nodes.count));
    t->inner++;
    return add(t, &t->nodes, 0);
}

/* Adds the children of a node of the level above `number`. */
static int add_children(octree *t, int number, const uint32_t *open)
{
    uint32_t solid;
    const int32_t at[3] = {(int32_t)open[0], (int32_t)open[1], (int32_t)open[2]};
    const uint32_t mask = children_of(&t->levels[number], at[0], at[1], at[2], &solid);
    t->nodes.at[open[3]] = mask << 24 | (uint32_t)t->nodes.count;
    for (int i = 0; i < 8; i++) {
        const int32_t child[3] = {2 * at[0] + (i & 1), 2 * at[1] + (i >> 1 & 1), 2 * at[2] + (i >> 2)};
        FXS_TRY(add_node(t, number, child));
    }
    return 0;
}

static int make_nodes(octree *t)
{
    FXS_TRY(add_node(t, t->depth, (int32_t[3]){0, 0, 0}));
    for (int number = t->depth - 1; number >= 0; number--) {
        const words open = t->next;
        t->next = t->open;
        t->next.count = 0;
        t->open = open;
        for (size_t i = 0; i < open.count; i += 4)
            FXS_TRY(add_children(t, number, open.at + i));
    }
    return 0;
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static void print_box(FILE *file, const char *name, double box[2][3])
{
    fprintf(file, "  \"%s\": {\"min\": ", name);
    fxs_print_list(file, 15, ", ", box[0], 3);
    fputs(", \"max\": ", file);
    fxs_print_list(file, 15, ", ", box[1], 3);
    fputs("},\n", file);
}

static void print_octree(FILE *file, const octree *t)
{
    const fxs_voxels *v = t->voxels;
    double grid[2][3], scene[2][3];
    for (int i = 0; i < 3; i++) {
        grid[0][i] = v->info.low[i] * v->info.voxel;
        grid[1][i] = v->info.high[i] * v->info.voxel;
    }
    memcpy(scene, v->bounds, sizeof scene);
    fputs("{\n  \"version\": \"1.1\",\n  \"asset\": {\"generator\": \"fixsplat " FXS_VERSION "\"},\n", file);
    print_box(file, "gridBounds", grid);
    print_box(file, "sceneBounds", scene);
    fputs("  \"voxelResolution\": ", file);
    fxs_print_number(file, 15, v->info.voxel);
    fprintf(file, ",\n  \"leafSize\": 4,\n  \"treeDepth\": %d,\n  \"numInteriorNodes\": %lu,\n"
            "  \"numMixedLeaves\": %lu,\n  \"nodeCount\": %lu,\n  \"leafDataCount\": %lu\n}\n", t->depth,
            (unsigned long)t->inner, (unsigned long)(t->leaves.count / 2), (unsigned long)t->nodes.count,
            (unsigned long)t->leaves.count);
}

static int write_words(fxs_output *output, words *w, fxs_message *message)
{
    for (size_t i = 0; i < w->count; i++)
        w->at[i] = fxs_little_32(w->at[i]);
    return fxs_output_write(output, w->at, w->count * sizeof *w->at, message);
}

static int write_bin(octree *t, const char *path)
{
    fxs_output output;
    fxs_message closing;
    FXS_TRY(fxs_output_open(&output, path, 0, t->message));
    int error = write_words(&output, &t->nodes, t->message);
    error = error ? error : write_words(&output, &t->leaves, t->message);
    const int closed = fxs_output_close(&output, error ? &closing : t->message);
    return error ? error : closed;
}

static int write_json(const octree *t, const char *path)
{
    fxs_printed printed;
    fxs_output output;
    fxs_message closing;
    if (fxs_print_begin(&printed))
        return fxs_fail_memory(t->message, path, 0);
    print_octree(printed.file, t);
    if (fxs_print_end(&printed))
        return fxs_fail_memory(t->message, path, 0);
    int error = fxs_output_open(&output, path, 0, t->message);
    if (!error) {
        error = fxs_output_write(&output, printed.text, printed.size, t->message);
        const int closed = fxs_output_close(&output, error ? &closing : t->message);
        error = error ? error : closed;
    }
    free(printed.text);
    return error;
}

static int write_files(octree *t, const char *path)
{
    const size_t length = strlen(path) - strlen("json");
    char *bin = fxs_allocate(NULL, length + sizeof "bin", 1);
    if (!bin)
        return fxs_fail_memory(t->message, path, 0);
    memcpy(bin, path, length);
    memcpy(bin + length, "bin", sizeof "bin");
    int error = write_json(t, path);
    error = error ? error : write_bin(t, bin);
    fxs_release(NULL, bin);
    return error;
}

int fxs_voxels_write_octree(const fxs_voxels *voxels, const char *path, fxs_message *message)
{
    octree t = {.voxels = voxels, .message = message};
    int error = make_levels(&t);
    error = error ? error : make_nodes(&t);
    error = error ? error : write_files(&t, path);
    for (int i = 0; i <= t.depth; i++)
        fxs_release(NULL, t.levels[i].states);
    fxs_release(NULL, t.nodes.at);
    fxs_release(NULL, t.leaves.at);
    fxs_release(NULL, t.open.at);
    fxs_release(NULL, t.next.at);
    return error;
}

/* ---------------------------------------------------------------------------------------------------------------- */

static int has_ending(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    return length > size && !strcmp(path + length - size, ending);
}

int fxs_voxels_ending(const char *path)
{
    return has_ending(path, ".voxel.json") || has_ending(path, ".glb");
}

int fxs_voxels_write(const fxs_voxels *voxels, const char *path, fxs_message *message)
{
    if (voxels->tree.words)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: voxels that were read cannot be written", path);
    if (has_ending(path, ".voxel.json"))
        return fxs_voxels_write_octree(voxels, path, message);
    return has_ending(path, ".glb") ? fxs_voxels_write_glb(voxels, path, message)
           : fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: expected a name ending in .voxel.json or .glb", path);
}
