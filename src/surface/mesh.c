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

/* ---- Parts ------------------------------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *parent, uint32_t vertex)
{
    while (parent[vertex] != vertex)
        vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
}

static void join_parts(const fxs_mesh *mesh, uint32_t *parent)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        parent[i] = i;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        const uint32_t a = root_of(parent, mesh->triangles[i]), b = root_of(parent, mesh->triangles[i - i % 3]);
        parent[a > b ? a : b] = a < b ? a : b;
    }
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
