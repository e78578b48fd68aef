/* Joins triangles of a mesh whose sides touch without sharing both vertices, such as merged rectangles. */
#include "mesh_edges.h"
#include "volume.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"

enum { GROWTH_MOST = 8, PASSES_MOST = 32 };

/* A vertex on a line along an axis. */
typedef struct mark {
    int32_t line[2], along;
    uint32_t vertex;
} mark;

typedef struct joining {
    fxs_mesh *mesh;
    fxs_mesh_edges edges;
    mark *marks[3];              /* the vertices, by line and place along each axis */
    size_t room;                 /* triangles */
    fxs_message *message;
} joining;

static int compare(int64_t a, int64_t b)
{
    return a < b ? -1 : a > b;
}

static int compare_marks(const void *a, const void *b)
{
    const mark *p = a, *q = b;
    const int first = compare(p->line[0], q->line[0]), second = compare(p->line[1], q->line[1]);
    return first ? first : second ? second : compare(p->along, q->along);
}

static mark mark_of(const fxs_mesh *mesh, uint32_t vertex, int axis)
{
    const int32_t *at = mesh->places + 3 * (size_t)vertex;
    return (mark){{at[(axis + 1) % 3], at[(axis + 2) % 3]}, at[axis], vertex};
}

static int mark_vertices(joining *j)
{
    const fxs_mesh *mesh = j->mesh;
    for (int axis = 0; axis < 3; axis++) {
        mark *marks = j->marks[axis] = fxs_allocate(NULL, mesh->vertex_count, sizeof *marks);
        if (!marks)
            return fxs_fail_memory(j->message, NULL, 0);
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
            marks[i] = mark_of(mesh, i, axis);
        qsort(marks, mesh->vertex_count, sizeof *marks, compare_marks);
    }
    return 0;
}

/* Returns the number of the first mark that is not before `wanted`. */
static size_t find_mark(const joining *j, int axis, const mark *wanted)
{
    size_t low = 0, high = j->mesh->vertex_count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (compare_marks(&j->marks[axis][middle], wanted) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Finds the middle vertex on a side that is parallel to an axis. Returns 0 if no vertex is on the side. */
static int find_between(const joining *j, uint32_t side, uint32_t *vertex)
{
    const uint32_t a = fxs_side_begin(j->mesh, side), b = fxs_side_end(j->mesh, side);
    for (int axis = 0; axis < 3; axis++) {
        const mark p = mark_of(j->mesh, a, axis), q = mark_of(j->mesh, b, axis);
        if (p.line[0] != q.line[0] || p.line[1] != q.line[1])
            continue;
        const size_t i = find_mark(j, axis, &p), k = find_mark(j, axis, &q), low = i < k ? i : k;
        *vertex = j->marks[axis][(i + k) / 2].vertex;
        return (i + k) / 2 > low;
    }
    return 0;
}

/* Splits a triangle in two at a vertex on one of its sides. */
static int split(joining *j, uint32_t side, uint32_t vertex)
{
    fxs_mesh *mesh = j->mesh;
    if (mesh->triangle_count == j->room) {
        uint32_t *larger = fxs_enlarge(NULL, mesh->triangles, 3 * j->room, 6 * j->room, sizeof *larger);
        if (!larger)
            return fxs_fail_memory(j->message, NULL, 0);
        mesh->triangles = larger;
        j->room *= 2;
    }
    const uint32_t next = fxs_side_next(side), last = fxs_side_next(next);
    uint32_t *added = mesh->triangles + 3 * (size_t)mesh->triangle_count++;
    added[0] = vertex;
    added[1] = mesh->triangles[next];
    added[2] = mesh->triangles[last];
    mesh->triangles[next] = vertex;
    return 0;
}

/* Splits each triangle once, if a side of it is not joined and has vertices between its ends. Returns the number of
   triangles split, or an error. */
static int split_all(joining *j, size_t most)
{
    const uint32_t count = j->mesh->triangle_count;
    int done = 0;
    for (uint32_t t = 0; t < count; t++)
        for (uint32_t side = 3 * t; side < 3 * t + 3 && j->mesh->triangle_count < most; side++) {
            uint32_t vertex;
            if (j->edges.joined[j->edges.of[side]])
                continue;
            if (!j->marks[2])
                FXS_TRY(mark_vertices(j));
            if (!find_between(j, side, &vertex))
                continue;
            FXS_TRY(split(j, side, vertex));
            done++;
            break;
        }
    return done;
}

static int join(joining *j, size_t most)
{
    for (int pass = 0, done = 1; pass < PASSES_MOST && done; pass++) {
        const int error = fxs_mesh_edges_find(&j->edges, j->mesh, j->message);
        done = error ? error : split_all(j, most);
        fxs_mesh_edges_free(&j->edges);
        if (done < 0)
            return done;
    }
    return 0;
}

int fxs_mesh_join(fxs_mesh *mesh, fxs_message *message)
{
    joining j = {.mesh = mesh, .room = mesh->triangle_count, .message = message};
    const uint64_t most = GROWTH_MOST * (uint64_t)mesh->triangle_count;
    const int error = join(&j, most < UINT32_MAX / 6 ? (size_t)most : UINT32_MAX / 6);
    for (int axis = 0; axis < 3; axis++)
        fxs_release(NULL, j.marks[axis]);
    return error;
}
