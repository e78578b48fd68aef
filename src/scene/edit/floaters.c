/* Finds floaters (Gaussians with few neighbours) by counting Gaussians in hashed grids of several cell widths. */
#include "floaters_internal.h"

#include <math.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/gaussian/attributes.h"

enum { LEAST_LEVEL = -32, MOST_LEVEL = 40, LEVELS = MOST_LEVEL - LEAST_LEVEL + 1 };

#define LOG2_E 1.4426950408889634

/* Largest log2 of a grid cell's width, relative to that of the median Gaussian. One row for each strength of the
   floater filter; `wider` is for faint and for opaque Gaussians. */
static const struct {
    int wider[2], ends;
} strengths[FXS_FLOATER_STRENGTHS + 1] = {
    {{0}, 0}, {{LEVELS, LEVELS}, 0}, {{1, LEVELS}, 0}, {{0, LEVELS}, 0}, {{0, 0}, 0}, {{0, 0}, 1}
};

#define OPAQUE 0.9

typedef struct cell {
    uint32_t first, count;
} cell;

typedef struct grid {
    const fxs_floater *items;
    cell *cells;
    uint32_t mask;
    int level;
} grid;

int fxs_floaters_init(fxs_floaters *f, int strength, uint64_t count, const fxs_allocator *allocator,
                      fxs_message *message)
{
    f->strength = strength;
    if (count > FXS_MAX_COUNT)
        return fxs_fail(message, "%llu Gaussians: floaters are found among at most %u", (unsigned long long)count,
                        FXS_MAX_COUNT);
    f->room = (uint32_t)count;
    f->items = fxs_allocate(allocator, f->room, sizeof *f->items);
    return f->items ? 0 : fxs_fail_memory(message, NULL, count * sizeof *f->items);
}

static int level_of(const fxs_gaussian *g)
{
    const double most = fmax(fmax(g->scale[0], g->scale[1]), g->scale[2]);
    return (int)fmin(fmax(ceil(most * LOG2_E + 2), LEAST_LEVEL), MOST_LEVEL);
}

/* Computes the vector along a Gaussian's longest axis with the length of its sigma, which is limited to e^40. */
static void find_end(float end[3], const fxs_gaussian *g)
{
    const float *q = g->rotation, *s = g->scale;
    const int axis = s[0] >= s[1] && s[0] >= s[2] ? 0 : s[1] >= s[2] ? 1 : 2;
    const double sigma = fxs_exp(fmin(s[axis], 40));
    double axes[3][3];
    fxs_rotation_matrix(axes, q[0], q[1], q[2], q[3]);
    for (int i = 0; i < 3; i++)
        end[i] = (float)(sigma * axes[i][axis]);
}

int fxs_floaters_take(fxs_floaters *f, const fxs_gaussian *g)
{
    if (f->found)
        return f->items[f->next++].floats;
    if (f->count < f->room) {
        fxs_floater *item = &f->items[f->count++];
        memcpy(item->position, g->position, sizeof item->position);
        find_end(item->end, g);
        item->level = (int16_t)level_of(g);
        item->opaque = fxs_opacity_of_logit(g->opacity) >= OPAQUE;
        item->floats = 0;
    }
    return 0;
}

static int is_finite(const fxs_floater *item)
{
    return isfinite(item->position[0]) && isfinite(item->position[1]) && isfinite(item->position[2]);
}

static void cell_of(const fxs_floater *item, int part, int level, int64_t at[3])
{
    for (int i = 0; i < 3; i++) {
        const double x = item->position[i] + (part ? part * (double)item->end[i] : 0);
        at[i] = (int64_t)fmin(fmax(floor(ldexp(x, -level)), -0x1p62), 0x1p62);
    }
}

static cell *find(const grid *g, const int64_t at[3])
{
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        hash = (hash ^ (uint64_t)at[i]) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    for (uint32_t place = (uint32_t)hash & g->mask;; place = (place + 1) & g->mask) {
        cell *c = &g->cells[place];
        int64_t other[3];
        if (!c->count)
            return c;
        cell_of(&g->items[c->first], 0, g->level, other);
        if (!memcmp(other, at, sizeof other))
            return c;
    }
}

static void fill(const grid *g, uint32_t count)
{
    memset(g->cells, 0, ((size_t)g->mask + 1) * sizeof *g->cells);
    for (uint32_t i = 0; i < count; i++) {
        int64_t at[3];
        if (!is_finite(&g->items[i]))
            continue;
        cell_of(&g->items[i], 0, g->level, at);
        cell *c = find(g, at);
        c->first = c->count ? c->first : i;
        c->count++;
    }
}

/* Returns 1 if the 27 grid cells around a Gaussian contain more than FXS_FLOATER_NEIGHBOURS Gaussians. */
static int has_neighbours(const grid *g, const fxs_floater *item, int part)
{
    int64_t middle[3];
    uint64_t count = 0;
    cell_of(item, part, g->level, middle);
    for (int k = 0; k < 27 && count <= FXS_FLOATER_NEIGHBOURS; k++) {
        const int64_t at[3] = {middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1};
        count += find(g, at)->count;
    }
    return count > FXS_FLOATER_NEIGHBOURS;
}

static int least_level(const fxs_floaters *f)
{
    uint32_t counts[LEVELS] = {0}, below = 0;
    for (uint32_t i = 0; i < f->count; i++)
        counts[f->items[i].level - LEAST_LEVEL]++;
    int level = 0;
    while (level < LEVELS - 1 && (below += counts[level]) <= f->count / 2)
        level++;
    return level + LEAST_LEVEL;
}

static void find_level(fxs_floaters *f, const grid *g, int least)
{
    const int *wider = strengths[f->strength].wider, ends = strengths[f->strength].ends;
    int filled = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        fxs_floater *item = &f->items[i];
        const int own = item->level > least ? item->level : least, widest = least + wider[item->opaque];
        if ((own < widest ? own : widest) != g->level || !is_finite(item))
            continue;
        if (!filled)
            fill(g, f->count);
        filled = 1;
        item->floats = !has_neighbours(g, item, 0) ||
                       (ends && !(has_neighbours(g, item, 1) && has_neighbours(g, item, -1)));
    }
}

int fxs_floaters_find(fxs_floaters *f, const fxs_allocator *allocator, fxs_message *message)
{
    grid g = {.items = f->items, .mask = 1};
    while (g.mask < 2 * (uint64_t)f->count)
        g.mask = 2 * g.mask + 1;
    g.cells = fxs_allocate(allocator, (size_t)g.mask + 1, sizeof *g.cells);
    if (!g.cells)
        return fxs_fail_memory(message, NULL, ((size_t)g.mask + 1) * sizeof *g.cells);
    const int least = least_level(f);
    for (g.level = least; g.level <= MOST_LEVEL; g.level++)
        find_level(f, &g, least);
    fxs_release(allocator, g.cells);
    f->found = 1;
    f->next = 0;
    return 0;
}

void fxs_floaters_free(fxs_floaters *f, const fxs_allocator *allocator)
{
    fxs_release(allocator, f->items);
}
