/* Changes of a mesh: removes unused vertices and small parts, and colours vertices that no view shows. */
#include "volume.h"

#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"

void fxs_mesh_free(fxs_mesh *mesh)
{
    if (!mesh)
        return;
    fxs_release(NULL, mesh->places);
    fxs_release(NULL, mesh->colours);
    fxs_release(NULL, mesh->triangles);
    fxs_release(NULL, mesh);
}

int fxs_mesh_compact(fxs_mesh *mesh, fxs_message *message)
{
    uint32_t *number = fxs_allocate_zeroed(NULL, (size_t)mesh->vertex_count + 1, sizeof *number), count = 0;
    if (!number)
        return fxs_fail_memory(message, NULL, 0);
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        number[mesh->triangles[i]] = 1;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        if (!number[i])
            continue;
        memmove(mesh->places + 3 * (size_t)count, mesh->places + 3 * (size_t)i, 3 * sizeof *mesh->places);
        memmove(mesh->colours + 4 * (size_t)count, mesh->colours + 4 * (size_t)i, 4);
        number[i] = count++;
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        mesh->triangles[i] = number[mesh->triangles[i]];
    mesh->vertex_count = count;
    fxs_release(NULL, number);
    return 0;
}

/* ---- Fans -------------------------------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *parent, uint32_t vertex)
{
    while (parent[vertex] != vertex)
        vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
}

static void join(uint32_t *parent, uint32_t p, uint32_t q)
{
    const uint32_t a = root_of(parent, p), b = root_of(parent, q);
    parent[a > b ? a : b] = a < b ? a : b;
}

/* True if two corners at the same vertex are of triangles with a common side there. */
static int is_beside(const fxs_mesh *mesh, uint32_t p, uint32_t q)
{
    const uint32_t *t = mesh->triangles;
    const uint32_t a = t[p - p % 3 + (p + 1) % 3], b = t[p - p % 3 + (p + 2) % 3];
    const uint32_t c = t[q - q % 3 + (q + 1) % 3], d = t[q - q % 3 + (q + 2) % 3];
    return a == d || b == c || a == c || b == d;
}

/* Joins the corners of each fan of triangles at a vertex. Returns how many more fans than vertices there are. */
static uint32_t join_fans(const fxs_mesh *mesh, uint32_t *first, uint32_t *next, uint32_t *parent)
{
    const uint32_t corners = 3 * mesh->triangle_count;
    uint32_t fans = 0, used = 0;
    memset(first, 0xff, mesh->vertex_count * sizeof *first);
    for (uint32_t i = 0; i < corners; i++) {
        uint32_t *list = &first[mesh->triangles[i]];
        used += *list == UINT32_MAX;
        parent[i] = i;
        next[i] = *list;
        *list = i;
        for (uint32_t other = next[i]; other != UINT32_MAX; other = next[other])
            if (is_beside(mesh, i, other))
                join(parent, i, other);
    }
    for (uint32_t i = 0; i < corners; i++)
        fans += parent[i] == i;
    return fans - used;
}

/* Returns an array with room for `count` elements in place of another, which is released; null: out of memory. */
static void *grow(void *from, size_t used, size_t count, size_t size)
{
    void *to = fxs_allocate(NULL, count, size);
    if (!to)
        return NULL;
    memcpy(to, from, used * size);
    fxs_release(NULL, from);
    return to;
}

/* Gives all fans but the first at each vertex copies of the vertex. */
static int copy_vertices(fxs_mesh *mesh, uint32_t *first, uint32_t *next, uint32_t *parent, uint32_t more,
                         fxs_message *message)
{
    const size_t count = (size_t)mesh->vertex_count + more;
    int32_t *places = grow(mesh->places, mesh->vertex_count, count, 3 * sizeof *places);
    mesh->places = places ? places : mesh->places;
    uint8_t *colours = places ? grow(mesh->colours, mesh->vertex_count, count, 4) : NULL;
    mesh->colours = colours ? colours : mesh->colours;
    if (!colours)
        return fxs_fail_memory(message, NULL, 16 * (uint64_t)count);
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const uint32_t root = root_of(parent, i), vertex = mesh->triangles[i];
        if (i == root && first[vertex] != UINT32_MAX) {       /* the first fan */
            next[i] = vertex;
            first[vertex] = UINT32_MAX;
        } else if (i == root) {
            next[i] = mesh->vertex_count++;
            memcpy(places + 3 * (size_t)next[i], places + 3 * (size_t)vertex, 3 * sizeof *places);
            memcpy(colours + 4 * (size_t)next[i], colours + 4 * (size_t)vertex, 4);
        }
        mesh->triangles[i] = next[root];
    }
    return 0;
}

int fxs_mesh_split_fans(fxs_mesh *mesh, fxs_message *message)
{
    const size_t corners = 3 * (size_t)mesh->triangle_count;
    if (corners >= UINT32_MAX)
        return 0;
    uint32_t *first = fxs_allocate(NULL, (size_t)mesh->vertex_count + 1, sizeof *first);
    uint32_t *next = fxs_allocate(NULL, corners + 1, sizeof *next);
    uint32_t *parent = fxs_allocate(NULL, corners + 1, sizeof *parent);
    int error = first && next && parent ? 0 : fxs_fail_memory(message, NULL, 8 * (uint64_t)corners);
    const uint32_t more = error ? 0 : join_fans(mesh, first, next, parent);
    if (more)
        error = copy_vertices(mesh, first, next, parent, more, message);
    fxs_release(NULL, first);
    fxs_release(NULL, next);
    fxs_release(NULL, parent);
    return error;
}

/* ---- Parts ------------------------------------------------------------------------------------------------------- */

static void join_parts(const fxs_mesh *mesh, uint32_t *parent)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        parent[i] = i;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        join(parent, mesh->triangles[i], mesh->triangles[i - i % 3]);
}

int fxs_mesh_count_parts(const fxs_mesh *mesh, uint32_t *parts, fxs_message *message)
{
    uint32_t *parent = fxs_allocate(NULL, (size_t)mesh->vertex_count + 1, sizeof *parent);
    uint8_t *counted = fxs_allocate_zeroed(NULL, (size_t)mesh->vertex_count + 1, 1);
    const int is_made = parent && counted;
    *parts = 0;
    if (is_made)
        join_parts(mesh, parent);
    for (uint32_t i = 0; i < mesh->triangle_count && is_made; i++) {
        uint8_t *at = &counted[root_of(parent, mesh->triangles[3 * (size_t)i])];
        *parts += !*at;
        *at = 1;
    }
    fxs_release(NULL, parent);
    fxs_release(NULL, counted);
    return is_made ? 0 : fxs_fail_memory(message, NULL, 0);
}

int fxs_mesh_drop_parts(fxs_mesh *mesh, uint32_t least, uint32_t *parts, fxs_message *message)
{
    uint32_t *parent = fxs_allocate(NULL, (size_t)mesh->vertex_count + 1, sizeof *parent);
    uint32_t *size = fxs_allocate_zeroed(NULL, (size_t)mesh->vertex_count + 1, sizeof *size), kept = 0, left = 0;
    const int is_made = parent && size;
    if (is_made) {
        join_parts(mesh, parent);
        for (uint32_t i = 0; i < mesh->triangle_count; i++)
            size[root_of(parent, mesh->triangles[3 * (size_t)i])]++;
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
            left += size[i] && size[i] >= least;
        for (uint32_t i = 0; i < mesh->triangle_count; i++)
            if (size[root_of(parent, mesh->triangles[3 * (size_t)i])] >= least)
                memmove(mesh->triangles + 3 * (size_t)kept++, mesh->triangles + 3 * (size_t)i,
                        3 * sizeof *mesh->triangles);
        mesh->triangle_count = kept;
    }
    fxs_release(NULL, parent);
    fxs_release(NULL, size);
    if (!is_made)
        return fxs_fail_memory(message, NULL, 0);
    if (parts)
        *parts = left;
    return fxs_mesh_compact(mesh, message);
}

/* ---- Colours ----------------------------------------------------------------------------------------------------- */

/* Adds the colours of coloured corners to the sums of the others of each triangle. Returns 0 if there are none. */
static int sum_neighbours(const fxs_mesh *mesh, uint32_t (*sums)[4])
{
    int found = 0;
    memset(sums, 0, mesh->vertex_count * sizeof *sums);
    for (size_t i = 0; i < 9 * (size_t)mesh->triangle_count; i++) {
        const uint32_t *triangle = mesh->triangles + i / 9 * 3;
        const uint32_t to = triangle[i % 3], from = triangle[i % 9 / 3];
        const uint8_t *colour = mesh->colours + 4 * (size_t)from;
        if (mesh->colours[4 * (size_t)to + 3] || !colour[3])
            continue;
        for (int k = 0; k < 3; k++)
            sums[to][k] += colour[k];
        sums[to][3]++;
        found = 1;
    }
    return found;
}

static int has_uncoloured(const fxs_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        if (!mesh->colours[4 * (size_t)i + 3])
            return 1;
    return 0;
}

int fxs_mesh_spread_colours(fxs_mesh *mesh, fxs_message *message)
{
    if (!has_uncoloured(mesh))
        return 0;
    uint32_t (*sums)[4] = fxs_allocate(NULL, mesh->vertex_count, sizeof *sums);
    if (!sums)
        return fxs_fail_memory(message, NULL, 0);
    while (sum_neighbours(mesh, sums))
        for (uint32_t i = 0; i < mesh->vertex_count; i++) {
            uint8_t *colour = mesh->colours + 4 * (size_t)i;
            const uint32_t count = sums[i][3];
            for (int k = 0; k < 3 && count; k++)
                colour[k] = (uint8_t)((sums[i][k] + count / 2) / count);
            colour[3] = count ? 255 : colour[3];
        }
    fxs_release(NULL, sums);
    return 0;
}
