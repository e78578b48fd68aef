/* Decimates a mesh by collapsing edges (Garland and Heckbert 1997, "Surface Simplification Using Quadric Error
   Metrics"). Doubles with + - * / and sqrt in a fixed order: the same mesh on every machine. */
#include "volume.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/sine.h"
#include "src/base/try_internal.h"

#define NONE UINT32_MAX
#define BORDER_WEIGHT 4.0        /* of planes through open borders, relative to the square of the border's length */
#define LENGTH_WEIGHT 1e-4       /* cost of an edge's squared length, which decides where the surface is flat */
#define PULL 1e-4
#define LEAST_COSINE 0.2         /* least cosine between a triangle's normals before and after a collapse */

enum { QUADRIC = 10, MOST_AROUND = 48 };

/* Quadric: the upper triangle of the symmetric 4x4 matrix of (n, d)(n, d)^T: xx xy xz xd yy yz yd zz zd dd. */
typedef struct vertex {
    double at[3], q[QUADRIC], cost;
    uint32_t best;               /* neighbour that costs least to collapse with; NONE: none */
    uint32_t first;              /* first corner in the list of corners at the vertex */
    uint32_t heap;               /* place in the heap */
    uint32_t mark;
    int is_border;
} vertex;

typedef struct collapsing {
    fxs_mesh *mesh;
    vertex *vertices;
    uint32_t *next;              /* next corner at the same vertex */
    uint32_t *heap;              /* vertices, cheapest first */
    uint32_t heap_count, mark, left;
} collapsing;

uint64_t fxs_mesh_decimate_bytes(uint32_t vertices, uint32_t triangles)
{
    return vertices * (uint64_t)(sizeof(vertex) + 4) + 12 * (uint64_t)triangles;
}

/* ---- Vectors ----------------------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Computes the normal of a triangle, with the length of twice its area. */
static void normal_of(const double a[3], const double b[3], const double c[3], double n[3])
{
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
    }
    for (int i = 0; i < 3; i++)
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static void add_plane(double q[QUADRIC], const double n[3], double d, double weight)
{
    const double p[4] = {n[0], n[1], n[2], d};
    int k = 0;
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            q[k++] += weight * p[i] * p[j];
}

static double error_at(const double q[QUADRIC], const double p[3])
{
    const double error = p[0] * (q[0] * p[0] + 2 * (q[1] * p[1] + q[2] * p[2] + q[3])) +
                         p[1] * (q[4] * p[1] + 2 * (q[5] * p[2] + q[6])) + p[2] * (q[7] * p[2] + 2 * q[8]) + q[9];
    return error > 0 ? error : 0;
}

/* Moves a point to the least sum of its error and PULL * trace * (distance from its old place)^2. So it stays where it
   is in directions that the planes do not fix. */
static void settle_point(const double q[QUADRIC], double p[3])
{
    const double pull = PULL * (q[0] + q[4] + q[7]), a = q[0] + pull, d = q[4] + pull, f = q[7] + pull;
    const double xx = d * f - q[5] * q[5], xy = q[2] * q[5] - q[1] * f, xz = q[1] * q[5] - q[2] * d;
    const double yy = a * f - q[2] * q[2], yz = q[1] * q[2] - a * q[5], zz = a * d - q[1] * q[1];
    const double determinant = a * xx + q[1] * xy + q[2] * xz;
    const double x = pull * p[0] - q[3], y = pull * p[1] - q[6], z = pull * p[2] - q[8];
    if (!(determinant > 0))
        return;
    p[0] = (xx * x + xy * y + xz * z) / determinant;
    p[1] = (xy * x + yy * y + yz * z) / determinant;
    p[2] = (xz * x + yz * y + zz * z) / determinant;
}

/* ---- Triangles --------------------------------------------------------------------------------------------------- */

/* A triangle is dead if its first corner is NONE. */
static int is_dead(const collapsing *c, uint32_t corner)
{
    return c->mesh->triangles[corner - corner % 3] == NONE;
}

/* Returns the first living corner from `corner` on in a vertex's list; NONE: none is left. */
static uint32_t living(const collapsing *c, uint32_t corner)
{
    while (corner != NONE && is_dead(c, corner))
        corner = c->next[corner];
    return corner;
}

#define EACH_CORNER(corner, c, v) \
    (uint32_t corner = living(c, (c)->vertices[v].first); corner != NONE; corner = living(c, (c)->next[corner]))

/* Returns the vertex `turn` corners behind a corner in its triangle. */
static uint32_t corner_after(const collapsing *c, uint32_t corner, uint32_t turn)
{
    return c->mesh->triangles[corner - corner % 3 + (corner + turn) % 3];
}

static int has_vertex(const collapsing *c, uint32_t corner, uint32_t v)
{
    return corner_after(c, corner, 1) == v || corner_after(c, corner, 2) == v;
}

static void add_border(collapsing *c, uint32_t corner, const double normal[3])
{
    const uint32_t a = c->mesh->triangles[corner], b = corner_after(c, corner, 1);
    vertex *va = &c->vertices[a], *vb = &c->vertices[b];
    double side[3], across[3];
    uint32_t shared = 0;
    for EACH_CORNER(other, c, a)
        shared += (uint32_t)has_vertex(c, other, b);
    if (shared != 1)
        return;
    va->is_border = vb->is_border = 1;
    for (int i = 0; i < 3; i++)
        side[i] = vb->at[i] - va->at[i];
    for (int i = 0; i < 3; i++)
        across[i] = side[(i + 1) % 3] * normal[(i + 2) % 3] - side[(i + 2) % 3] * normal[(i + 1) % 3];
    const double length = sqrt(dot(across, across));
    for (int i = 0; i < 3; i++)
        across[i] /= length > 0 ? length : 1;
    const double d = -dot(across, va->at), weight = BORDER_WEIGHT * dot(side, side);
    add_plane(va->q, across, d, weight);
    add_plane(vb->q, across, d, weight);
}

static void add_triangle(collapsing *c, uint32_t triangle)
{
    const uint32_t *t = c->mesh->triangles + 3 * (size_t)triangle;
    vertex *v[3] = {&c->vertices[t[0]], &c->vertices[t[1]], &c->vertices[t[2]]};
    double n[3];
    normal_of(v[0]->at, v[1]->at, v[2]->at, n);
    const double length = sqrt(dot(n, n));
    for (int i = 0; i < 3 && length > 0; i++)
        n[i] /= length;
    for (uint32_t k = 0; k < 3; k++) {
        add_plane(v[k]->q, n, -dot(n, v[k]->at), length / 2);
        add_border(c, 3 * triangle + k, n);
    }
}

/* ---- Costs ------------------------------------------------------------------------------------------------------- */

/* Chooses the place of the vertex that replaces u and v, and returns its cost. */
static double cost_of(const collapsing *c, uint32_t u, uint32_t v, double place[3])
{
    const vertex *a = &c->vertices[u < v ? u : v], *b = &c->vertices[u < v ? v : u];
    double q[QUADRIC], length = 0;
    for (int i = 0; i < QUADRIC; i++)
        q[i] = a->q[i] + b->q[i];
    for (int i = 0; i < 3; i++) {
        length += (a->at[i] - b->at[i]) * (a->at[i] - b->at[i]);
        place[i] = (a->at[i] + b->at[i]) / 2;
    }
    settle_point(q, place);
    return error_at(q, place) + LENGTH_WEIGHT * length;
}

/* ---- Heap -------------------------------------------------------------------------------------------------------- */

static int is_before(const collapsing *c, uint32_t u, uint32_t v)
{
    const double a = c->vertices[u].cost, b = c->vertices[v].cost;
    return a < b || (a == b && u < v);
}

static void put(collapsing *c, uint32_t place, uint32_t v)
{
    c->heap[place] = v;
    c->vertices[v].heap = place;
}

/* Moves a vertex to its place in the heap after its cost has changed. */
static void settle(collapsing *c, uint32_t v)
{
    uint32_t at = c->vertices[v].heap;
    for (; at && is_before(c, v, c->heap[(at - 1) / 2]); at = (at - 1) / 2)
        put(c, at, c->heap[(at - 1) / 2]);
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child + 1 < c->heap_count && is_before(c, c->heap[child + 1], c->heap[child]))
            child++;
        if (child >= c->heap_count || !is_before(c, c->heap[child], v))
            break;
        put(c, at, c->heap[child]);
        at = child;
    }
    put(c, at, v);
}

static void take_out(collapsing *c, uint32_t v)
{
    const uint32_t place = c->vertices[v].heap, last = c->heap[--c->heap_count];
    if (last == v)
        return;
    put(c, place, last);
    settle(c, last);
}

/* ---- Collapse ---------------------------------------------------------------------------------------------------- */

/* Marks the neighbours of a vertex with a new mark, or counts those with the current mark and takes it away. */
static uint32_t mark_neighbours(collapsing *c, uint32_t v)
{
    c->mark++;
    uint32_t count = 0;
    for EACH_CORNER(corner, c, v) {
        for (uint32_t k = 1; k < 3; k++)
            c->vertices[corner_after(c, corner, k)].mark = c->mark;
        count++;
    }
    return count;
}

static uint32_t count_marked(collapsing *c, uint32_t v)
{
    uint32_t count = 0;
    for EACH_CORNER(corner, c, v)
        for (uint32_t k = 1; k < 3; k++) {
            vertex *n = &c->vertices[corner_after(c, corner, k)];
            count += n->mark == c->mark;
            n->mark = n->mark == c->mark ? 0 : n->mark;
        }
    return count;
}

/* True if a triangle at u that v is not in would fold over, or lose its area, with u at the place. */
static int folds(const collapsing *c, uint32_t u, uint32_t v, const double place[3])
{
    for EACH_CORNER(corner, c, u) {
        const double *a = c->vertices[corner_after(c, corner, 1)].at, *b = c->vertices[corner_after(c, corner, 2)].at;
        double before[3], after[3];
        if (has_vertex(c, corner, v))
            continue;
        normal_of(c->vertices[u].at, a, b, before);
        normal_of(place, a, b, after);
        if (!(dot(before, after) > LEAST_COSINE * sqrt(dot(before, before) * dot(after, after))))
            return 1;
    }
    return 0;
}

/* True if u and v may be replaced by one vertex: the surface keeps its shape as a manifold (Dey et al. 1999), and no
   triangle folds over. */
static int may_collapse(collapsing *c, uint32_t u, uint32_t v, const double place[3])
{
    uint32_t shared = 0, around = 0;
    const uint32_t around_u = mark_neighbours(c, u);
    for EACH_CORNER(corner, c, v) {
        shared += (uint32_t)has_vertex(c, corner, u);
        around++;
    }
    const int both_border = c->vertices[u].is_border && c->vertices[v].is_border;
    if (!shared || shared > 2 || (shared == 2 && both_border) || around + around_u > MOST_AROUND ||
        (shared == 2 && around + around_u < 7))
        return 0;
    return count_marked(c, v) == shared && !folds(c, u, v, place) && !folds(c, v, u, place);
}

/* Finds the neighbour of a vertex that costs least, if is_checked only among those that may collapse. */
static void choose(collapsing *c, uint32_t v, int is_checked)
{
    vertex *from = &c->vertices[v];
    double place[3];
    from->cost = INFINITY;
    from->best = NONE;
    for EACH_CORNER(corner, c, v)
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t to = corner_after(c, corner, k);
            const double cost = cost_of(c, v, to, place);
            const int is_less = cost < from->cost || (cost == from->cost && to < from->best);
            if (is_less && (!is_checked || may_collapse(c, v, to, place))) {
                from->cost = cost;
                from->best = to;
            }
        }
}

/* Mixes the colours of u and v for the place between them, into v. */
static void mix_colours(const collapsing *c, uint32_t u, uint32_t v, const double place[3])
{
    const vertex *a = &c->vertices[u], *b = &c->vertices[v];
    uint8_t *from = c->mesh->colours + 4 * (size_t)u, *to = c->mesh->colours + 4 * (size_t)v;
    double along = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        along += (place[i] - a->at[i]) * (b->at[i] - a->at[i]);
        length += (b->at[i] - a->at[i]) * (b->at[i] - a->at[i]);
    }
    const double part = !(length > 0) ? 0.5 : along < 0 ? 0 : along > length ? 1 : along / length;
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)fxs_floor(from[i] + part * (to[i] - from[i]) + 0.5);
}

/* Joins the corners of u and v in v's list, without those of dead triangles. */
static void join_corners(collapsing *c, uint32_t u, uint32_t v)
{
    const uint32_t lists[2] = {c->vertices[u].first, c->vertices[v].first};
    uint32_t joined = NONE, next;
    for (int i = 0; i < 2; i++)
        for (uint32_t corner = lists[i]; corner != NONE; corner = next) {
            next = c->next[corner];
            if (is_dead(c, corner))
                continue;
            c->mesh->triangles[corner] = v;
            c->next[corner] = joined;
            joined = corner;
        }
    c->vertices[u].first = NONE;
    c->vertices[v].first = joined;
}

static void renew(collapsing *c, uint32_t u, uint32_t v)
{
    double place[3];
    choose(c, v, 0);
    settle(c, v);
    for EACH_CORNER(corner, c, v)
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t to = corner_after(c, corner, k);
            vertex *n = &c->vertices[to];
            const double cost = cost_of(c, to, v, place);
            if (n->best == u || n->best == v || n->best == NONE) {
                choose(c, to, 0);
            } else if (cost < n->cost) {
                n->cost = cost;
                n->best = v;
            }
            settle(c, to);
        }
}

static void collapse(collapsing *c, uint32_t u, uint32_t v, const double place[3])
{
    vertex *a = &c->vertices[u], *b = &c->vertices[v];
    mix_colours(c, u, v, place);
    for EACH_CORNER(corner, c, u)
        if (has_vertex(c, corner, v)) {
            c->mesh->triangles[corner - corner % 3] = NONE;
            c->left--;
        }
    memcpy(b->at, place, sizeof b->at);
    for (int i = 0; i < QUADRIC; i++)
        b->q[i] += a->q[i];
    b->is_border |= a->is_border;
    join_corners(c, u, v);
    take_out(c, u);
    renew(c, u, v);
}

static void collapse_all(collapsing *c, uint32_t triangles)
{
    while (c->left > triangles && c->heap_count) {
        const uint32_t u = c->heap[0], v = c->vertices[u].best;
        double place[3];
        if (v == NONE)
            break;
        cost_of(c, u, v, place);
        if (may_collapse(c, u, v, place)) {
            collapse(c, u, v, place);
        } else {
            choose(c, u, 1);
            settle(c, u);
        }
    }
}

/* ---- Mesh -------------------------------------------------------------------------------------------------------- */

static void begin(collapsing *c)
{
    fxs_mesh *m = c->mesh;
    for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++)
        c->vertices[i / 3].at[i % 3] = m->places[i] / 65536.0;
    for (uint32_t i = 0; i < m->vertex_count; i++)
        c->vertices[i].first = NONE;
    for (uint32_t i = 0; i < 3 * m->triangle_count; i++) {
        c->next[i] = c->vertices[m->triangles[i]].first;
        c->vertices[m->triangles[i]].first = i;
    }
    for (uint32_t i = 0; i < m->triangle_count; i++)
        add_triangle(c, i);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        choose(c, i, 0);
        c->heap_count++;
        put(c, i, i);
        settle(c, i);
    }
}

static void end(const collapsing *c)
{
    fxs_mesh *m = c->mesh;
    uint32_t kept = 0;
    for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++)
        m->places[i] = (int32_t)fxs_floor(65536 * c->vertices[i / 3].at[i % 3] + 0.5);
    for (uint32_t i = 0; i < m->triangle_count; i++)
        if (m->triangles[3 * (size_t)i] != NONE)
            memmove(m->triangles + 3 * (size_t)kept++, m->triangles + 3 * (size_t)i, 3 * sizeof *m->triangles);
    m->triangle_count = kept;
}

int fxs_mesh_decimate(fxs_mesh *mesh, uint32_t triangles, fxs_message *message)
{
    const uint32_t vertices = mesh->vertex_count;
    const uint64_t bytes = fxs_mesh_decimate_bytes(vertices, mesh->triangle_count);
    collapsing c = {.mesh = mesh, .left = mesh->triangle_count};
    if (mesh->triangle_count <= triangles)
        return 0;
    if (mesh->triangle_count > UINT32_MAX / 3)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "more than %u triangles cannot be decimated", UINT32_MAX / 3);
    FXS_TRY(fxs_surface_check(bytes + 16 * (uint64_t)vertices + 12 * (uint64_t)mesh->triangle_count, mesh->max_memory,
                              message));
    c.vertices = fxs_allocate_zeroed(NULL, vertices, sizeof *c.vertices);
    c.next = fxs_allocate(NULL, 3 * (size_t)mesh->triangle_count, sizeof *c.next);
    c.heap = fxs_allocate(NULL, vertices, sizeof *c.heap);
    const int is_made = c.vertices && c.next && c.heap;
    if (is_made) {
        begin(&c);
        collapse_all(&c, triangles);
        end(&c);
    }
    fxs_release(NULL, c.vertices);
    fxs_release(NULL, c.next);
    fxs_release(NULL, c.heap);
    return is_made ? fxs_mesh_compact(mesh, message) : fxs_fail_memory(message, NULL, bytes);
}
