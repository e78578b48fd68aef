/* Measures meshes: edges, box, area and volume. */
#include "mesh_edges.h"
#include "volume.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"

/* ---- Edges ------------------------------------------------------------------------------------------------------- */

/* Sorts sides by one of their vertices, the lower or the higher one, keeping the order of equal ones. `counts` has room
   for a number per vertex. */
static void sort_sides(const fxs_mesh *mesh, int is_higher, const uint32_t *from, uint32_t *to, uint32_t *counts)
{
    const size_t sides = 3 * (size_t)mesh->triangle_count;
    uint32_t sum = 0;
    memset(counts, 0, mesh->vertex_count * sizeof *counts);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < sides; i++) {
            const uint32_t side = from ? from[i] : (uint32_t)i;
            const uint32_t a = fxs_side_begin(mesh, side), b = fxs_side_end(mesh, side);
            const uint32_t key = (a > b) == is_higher ? a : b;
            if (pass)
                to[counts[key]++] = side;
            else
                counts[key]++;
        }
        for (uint32_t i = 0; i < mesh->vertex_count && !pass; i++) {
            const uint32_t count = counts[i];
            counts[i] = sum;
            sum += count;
        }
    }
}

static int is_same_edge(const fxs_mesh *mesh, uint32_t one, uint32_t other)
{
    const uint32_t a = fxs_side_begin(mesh, one), b = fxs_side_end(mesh, one);
    const uint32_t c = fxs_side_begin(mesh, other), d = fxs_side_end(mesh, other);
    return (a == c && b == d) || (a == d && b == c);
}

static uint8_t is_balanced(const fxs_mesh_edges *edges, const fxs_mesh *mesh, uint32_t edge)
{
    int64_t balance = 0;
    for (uint32_t i = edges->first[edge]; i < edges->first[edge + 1]; i++)
        balance += fxs_side_begin(mesh, edges->sides[i]) < fxs_side_end(mesh, edges->sides[i]) ? 1 : -1;
    return !balance;
}

int fxs_mesh_edges_find(fxs_mesh_edges *edges, const fxs_mesh *mesh, fxs_message *message)
{
    const size_t sides = 3 * (size_t)mesh->triangle_count;
    const size_t room = sides > mesh->vertex_count ? sides : mesh->vertex_count;
    *edges = (fxs_mesh_edges){.of = fxs_allocate(NULL, sides + 1, sizeof *edges->of),
                              .sides = fxs_allocate(NULL, sides + 1, sizeof *edges->sides),
                              .first = fxs_allocate(NULL, room + 1, sizeof *edges->first),
                              .joined = fxs_allocate(NULL, sides + 1, sizeof *edges->joined)};
    if (!edges->of || !edges->sides || !edges->first || !edges->joined)
        return fxs_fail_memory(message, NULL, 13 * (uint64_t)room);
    sort_sides(mesh, 1, NULL, edges->of, edges->first);
    sort_sides(mesh, 0, edges->of, edges->sides, edges->first);
    for (size_t i = 0; i < sides; i++) {
        if (!i || !is_same_edge(mesh, edges->sides[i], edges->sides[i - 1]))
            edges->first[edges->count++] = (uint32_t)i;
        edges->of[edges->sides[i]] = edges->count - 1;
    }
    edges->first[edges->count] = (uint32_t)sides;
    for (uint32_t e = 0; e < edges->count; e++)
        edges->joined[e] = is_balanced(edges, mesh, e);
    return 0;
}

void fxs_mesh_edges_free(fxs_mesh_edges *edges)
{
    fxs_release(NULL, edges->of);
    fxs_release(NULL, edges->sides);
    fxs_release(NULL, edges->first);
    fxs_release(NULL, edges->joined);
    *edges = (fxs_mesh_edges){.count = 0};
}

static void count_edges(fxs_mesh_measures *m, const fxs_mesh_edges *edges)
{
    for (uint32_t e = 0; e < edges->count; e++) {
        const int is_open = edges->first[e + 1] - edges->first[e] == 1;
        m->open_edges += (uint64_t)is_open;
        m->turned_edges += !is_open && !edges->joined[e];
    }
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

enum { DIGIT = 28 };                     /* bits */

/* A whole number of three digits. The last two are 0 to 2^28 - 1; the first holds the sign. 2^31 numbers of 2^58 in the
   middle digit fit. */
typedef struct sum {
    int64_t digits[3];
} sum;

/* Returns floor(x / 2^28), and keeps the rest. */
static int64_t carry_of(int64_t *x)
{
    const int64_t rest = *x & ((1 << DIGIT) - 1), carry = (*x - rest) / (1 << DIGIT);
    *x = rest;
    return carry;
}

static void add(sum *s, int64_t middle, int64_t low)
{
    s->digits[0] += low;
    s->digits[1] += middle + carry_of(&s->digits[0]);
    s->digits[2] += carry_of(&s->digits[1]);
}

static double value_of(const sum *s)
{
    const double digit = 1 << DIGIT;
    return ((double)s->digits[2] * digit + (double)s->digits[1]) * digit + (double)s->digits[0];
}

typedef struct sums {
    int32_t low[3], high[3];
    sum area, volume;                    /* twice the area, and six times the volume */
} sums;

int fxs_mesh_find_box(const fxs_mesh *mesh, int32_t low[3], int32_t high[3], fxs_message *message)
{
    if (!mesh->triangle_count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a mesh without triangles");
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            const int32_t at = mesh->places[3 * (size_t)mesh->triangles[i] + (size_t)k];
            low[k] = !i || at < low[k] ? at : low[k];
            high[k] = !i || at > high[k] ? at : high[k];
        }
    for (int k = 0; k < 3; k++)
        if ((int64_t)high[k] - low[k] >= (int64_t)1 << DIGIT)
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "places of a mesh differ by 2^28 or more");
    return 0;
}

/* Places count from the low corner of the box, so they are 0 to 2^28 - 1. Then a normal is below 2^57. */
static void add_triangle(sums *s, const fxs_mesh *mesh, const uint32_t corners[3])
{
    int64_t at[3][3], n[3], middle = 0, low = 0;
    double square = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            at[i][k] = (int64_t)mesh->places[3 * (size_t)corners[i] + (size_t)k] - s->low[k];
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = (at[1][a] - at[0][a]) * (at[2][b] - at[0][b]) - (at[1][b] - at[0][b]) * (at[2][a] - at[0][a]);
        square += (double)n[k] * (double)n[k];
        const int64_t upper = carry_of(&n[k]);
        middle += at[0][k] * upper;
        low += at[0][k] * n[k];
    }
    add(&s->area, 0, (int64_t)(sqrt(square) + 0.5));
    add(&s->volume, middle, low);
}

/* ---- Measures ---------------------------------------------------------------------------------------------------- */

int fxs_mesh_measure(fxs_mesh_measures *measures, const fxs_mesh *mesh, fxs_message *message)
{
    const double unit = mesh->step / 65536;
    fxs_mesh_edges edges;
    sums s = {.low = {0}};
    memset(measures, 0, sizeof *measures);
    FXS_TRY(fxs_mesh_find_box(mesh, s.low, s.high, message));
    for (int k = 0; k < 3; k++) {
        measures->low[k] = mesh->origin[k] + unit * s.low[k];
        measures->high[k] = mesh->origin[k] + unit * s.high[k];
    }
    int error = fxs_mesh_edges_find(&edges, mesh, message);
    error = error ? error : fxs_mesh_count_parts(mesh, &measures->parts, message);
    if (!error)
        count_edges(measures, &edges);
    fxs_mesh_edges_free(&edges);
    for (uint32_t i = 0; i < mesh->triangle_count && !error; i++)
        add_triangle(&s, mesh, mesh->triangles + 3 * (size_t)i);
    measures->area = value_of(&s.area) / 2 * unit * unit;
    if (!measures->open_edges && !measures->turned_edges)
        measures->volume = value_of(&s.volume) / 6 * unit * unit * unit;
    return error;
}
