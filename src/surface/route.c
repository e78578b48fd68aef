/* Shortest ways along a mesh. A search by A* over points on the edges finds the triangles of the way. They are unfolded
   to a plane, where the way is straightened. Lengths are integers in the search, and then doubles with + - * / and sqrt
   in a fixed order: the same way on every machine. */
#include "mesh_edges.h"
#include "volume.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/sine.h"
#include "src/base/try_internal.h"

#define NONE UINT32_MAX

enum { PER_EDGE_LEAST = 3, PER_EDGE_MOST = 32, STEPS_LOG2 = 26, LENGTH_BITS = 3 };
enum { ROOM_MOST = 1 << 18 };             /* triangles by which a way may become longer while it is straightened */
#define WORK_MOST ((uint64_t)1 << 28)     /* triangles that straightening may look at */
#define LEAST_GAIN 1e-12                  /* of the length, by which a way must become shorter */

/* A point on the mesh, in places. */
typedef struct spot {
    uint32_t triangle;
    double at[3];
} spot;

typedef struct search {
    const fxs_mesh *mesh;
    fxs_mesh_edges edges;
    spot from, to;
    uint32_t per_edge, nodes;    /* points on each edge; node e * per_edge + i is point i of edge e */
    uint64_t *key;               /* of each node: length of the way to it and on in a straight line, places, Q3 */
    uint32_t *before, *through;  /* the node before, NONE: the start; the triangle between them */
    uint32_t *heap, *place;      /* nodes, least key first; place of each node in the heap, NONE: not in it */
    uint32_t heap_count;
} search;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static void place_of(const fxs_mesh *mesh, uint32_t vertex, double at[3])
{
    for (size_t i = 0; i < 3; i++)
        at[i] = mesh->places[3 * (size_t)vertex + i];
}

/* ---- Nearest points ---------------------------------------------------------------------------------------------- */

static double clamp(double x)
{
    return x > 0 ? x < 1 ? x : 1 : 0;
}

/* Moves `best` to the point of the side a..b nearest to p, if it is nearer. */
static void try_side(const double p[3], const double a[3], const double b[3], double best[3], double *least)
{
    double side[3], from[3], at[3];
    subtract(b, a, side);
    subtract(p, a, from);
    const double part = clamp(dot(from, side) / dot(side, side));
    for (int i = 0; i < 3; i++)
        at[i] = a[i] + part * side[i];
    subtract(p, at, from);
    const double square = dot(from, from);
    if (square < *least) {
        *least = square;
        memcpy(best, at, sizeof at);
    }
}

/* Finds the point of a triangle nearest to p: where p is above it, else on a side. Returns the square of the
   distance. */
static double nearest_in(double corners[3][3], const double p[3], double best[3])
{
    double u[3], v[3], from[3], n[3], least = INFINITY;
    subtract(corners[1], corners[0], u);
    subtract(corners[2], corners[0], v);
    subtract(p, corners[0], from);
    for (int i = 0; i < 3; i++)
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), fu = dot(from, u), fv = dot(from, v);
    const double a = fu * vv - fv * uv, b = fv * uu - fu * uv, all = uu * vv - uv * uv, height = dot(from, n);
    if (all > 0 && a >= 0 && b >= 0 && a + b <= all) {
        for (int i = 0; i < 3; i++)
            best[i] = p[i] - height / dot(n, n) * n[i];
        return height * height / dot(n, n);
    }
    for (int i = 0; i < 3; i++)
        try_side(p, corners[i], corners[(i + 1) % 3], best, &least);
    return least;
}

static int find_spot(const fxs_mesh *mesh, const double point[3], spot *found, fxs_message *message)
{
    const double unit = mesh->step / 65536;
    double p[3], at[3], least = INFINITY;
    for (int i = 0; i < 3; i++) {
        p[i] = (point[i] - mesh->origin[i]) / unit;
        if (!(fabs(p[i]) < 0x1p60))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a point that is not finite, or too far from the mesh");
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double corners[3][3];
        for (size_t i = 0; i < 3; i++)
            place_of(mesh, mesh->triangles[3 * (size_t)t + i], corners[i]);
        const double square = nearest_in(corners, p, at);
        if (square < least) {
            least = square;
            found->triangle = t;
            memcpy(found->at, at, sizeof at);
        }
    }
    return 0;
}

/* ---- Search ------------------------------------------------------------------------------------------------------ */

/* Returns floor(sqrt(x)). */
static uint64_t root_of(uint64_t x)
{
    uint64_t root = (uint64_t)sqrt((double)x);
    while (root > UINT32_MAX || root * root > x)
        root--;
    while (root < UINT32_MAX && (root + 1) * (root + 1) <= x)
        root++;
    return root;
}

/* Length in Q3. Places differ by less than 2^28, so the square is below 3 * 2^62. */
static uint64_t length_between(const int32_t a[3], const int32_t b[3])
{
    uint64_t square = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t step = (int64_t)b[i] - a[i];
        square += (uint64_t)(step * step);
    }
    return root_of(square << 2 * LENGTH_BITS);
}

static void round_spot(const spot *s, int32_t at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = (int32_t)fxs_floor(s->at[i] + 0.5);
}

static void place_of_node(const search *s, uint32_t node, int32_t at[3])
{
    const uint32_t side = s->edges.sides[s->edges.first[node / s->per_edge]];
    const uint32_t a = fxs_side_begin(s->mesh, side), b = fxs_side_end(s->mesh, side);
    for (size_t i = 0; i < 3; i++) {
        const int64_t from = s->mesh->places[3 * (size_t)a + i], to = s->mesh->places[3 * (size_t)b + i];
        at[i] = (int32_t)(from + (to - from) * (int64_t)(2 * (node % s->per_edge) + 1) / (2 * s->per_edge));
    }
}

/* Orders nodes by key, and equal keys by number. */
static int is_before(const search *s, uint32_t a, uint32_t b)
{
    return s->key[a] < s->key[b] || (s->key[a] == s->key[b] && a < b);
}

static void put_in_heap(search *s, uint32_t place, uint32_t node)
{
    s->heap[place] = node;
    s->place[node] = place;
}

static void rise(search *s, uint32_t node)
{
    uint32_t place = s->place[node];
    for (; place && is_before(s, node, s->heap[(place - 1) / 2]); place = (place - 1) / 2)
        put_in_heap(s, place, s->heap[(place - 1) / 2]);
    put_in_heap(s, place, node);
}

static uint32_t take_first(search *s)
{
    const uint32_t first = s->heap[0], last = s->heap[--s->heap_count];
    uint32_t place = 0;
    s->place[first] = NONE;
    for (uint32_t child; (child = 2 * place + 1) < s->heap_count; place = child) {
        child += child + 1 < s->heap_count && is_before(s, s->heap[child + 1], s->heap[child]);
        if (!is_before(s, s->heap[child], last))
            break;
        put_in_heap(s, place, s->heap[child]);
    }
    if (s->heap_count)
        put_in_heap(s, place, last);
    return first;
}

/* Offers a way of the length `length` to the place `at`, and on through a triangle to the nodes of its sides. The
   edge `except` is left out. */
static void offer(search *s, uint32_t triangle, uint32_t except, uint32_t before, const int32_t at[3], uint64_t length)
{
    int32_t to[3], target[3];
    round_spot(&s->to, target);
    for (uint32_t side = 3 * triangle; side < 3 * triangle + 3; side++) {
        const uint32_t first = s->edges.of[side] * s->per_edge;
        for (uint32_t node = first; node < first + s->per_edge && s->edges.of[side] != except; node++) {
            place_of_node(s, node, to);
            const uint64_t key = length + length_between(at, to) + length_between(to, target);
            if (key >= s->key[node])
                continue;
            s->key[node] = key;
            s->before[node] = before;
            s->through[node] = triangle;
            if (s->place[node] == NONE)
                s->place[node] = s->heap_count++;
            rise(s, node);
        }
    }
}

/* Returns the last node of the shortest way, or NONE. The key of a node in the target's triangle is the length of a way
   to the target. */
static uint32_t find_last(search *s)
{
    int32_t at[3], target[3];
    round_spot(&s->from, at);
    round_spot(&s->to, target);
    offer(s, s->from.triangle, NONE, NONE, at, 0);
    while (s->heap_count) {
        const uint32_t node = take_first(s), edge = node / s->per_edge;
        place_of_node(s, node, at);
        for (uint32_t i = s->edges.first[edge]; i < s->edges.first[edge + 1]; i++)
            if (s->edges.sides[i] / 3 == s->to.triangle)
                return node;
        const uint64_t length = s->key[node] - length_between(at, target);
        for (uint32_t i = s->edges.first[edge]; i < s->edges.first[edge + 1]; i++)
            offer(s, s->edges.sides[i] / 3, edge, node, at, length);
    }
    return NONE;
}

/* Chooses the points per edge: a triangle joins each of its points to those on two sides of it. */
static uint32_t choose_per_edge(const fxs_mesh *mesh)
{
    uint32_t n = PER_EDGE_MOST;
    while (n > PER_EDGE_LEAST && mesh->triangle_count * (uint64_t)(9 * n * n) >> STEPS_LOG2)
        n--;
    return n;
}

static int make_search(search *s, const fxs_mesh *mesh, fxs_message *message)
{
    uint64_t per_node = sizeof *s->key + 4 * sizeof *s->before;
    s->per_edge = choose_per_edge(mesh);
    FXS_TRY(fxs_mesh_edges_find(&s->edges, mesh, message));
    const uint64_t nodes = (uint64_t)s->edges.count * s->per_edge, bytes = nodes * per_node;
    FXS_TRY(fxs_surface_check(bytes, mesh->max_memory, message));
    if (nodes >= NONE)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "too many triangles for a way along them");
    s->nodes = (uint32_t)nodes;
    s->key = fxs_allocate(NULL, s->nodes, sizeof *s->key);
    s->before = fxs_allocate(NULL, s->nodes, 4 * sizeof *s->before);
    if (!s->key || !s->before)
        return fxs_fail_memory(message, NULL, bytes);
    s->through = s->before + s->nodes;
    s->heap = s->through + s->nodes;
    s->place = s->heap + s->nodes;
    memset(s->key, 255, s->nodes * sizeof *s->key);
    memset(s->place, 255, s->nodes * sizeof *s->place);
    return 0;
}

/* ---- Strips ------------------------------------------------------------------------------------------------------ */

/* A side between two triangles of a strip, unfolded to a plane. */
typedef struct portal {
    uint32_t vertex[2];          /* left and right, seen along the way */
    double at[2][2];
} portal;

/* A bend of a way at a vertex of the strip. */
typedef struct bend {
    uint32_t portal, side;       /* its vertex is vertex[side] of this portal */
} bend;

/* A strip of triangles, each next to the one before, and the straight way in it. */
typedef struct strip {
    const fxs_mesh *mesh;
    const fxs_mesh_edges *edges;
    const spot *from, *to;
    uint32_t *triangles, count, room;
    portal *portals;             /* count - 1 */
    bend *bends;
    uint32_t bend_count;
    double begin[2], end[2], length;
} strip;

static int make_strip(strip *s, uint32_t room, fxs_message *message)
{
    s->room = room;
    s->triangles = fxs_allocate(NULL, room, sizeof *s->triangles);
    s->portals = fxs_allocate(NULL, room, sizeof *s->portals);
    s->bends = fxs_allocate(NULL, room, sizeof *s->bends);
    return s->triangles && s->portals && s->bends ? 0 : fxs_fail_memory(message, NULL, 0);
}

static void free_strip(strip *s)
{
    fxs_release(NULL, s->triangles);
    fxs_release(NULL, s->portals);
    fxs_release(NULL, s->bends);
}

/* Adds a triangle. Going back to the triangle before the last one takes the last one away. */
static void add_triangle(strip *s, uint32_t triangle)
{
    if (s->count && s->triangles[s->count - 1] == triangle)
        return;
    if (s->count > 1 && s->triangles[s->count - 2] == triangle)
        s->count--;
    else
        s->triangles[s->count++] = triangle;
}

/* Returns the side of a triangle on the edge to another one. */
static uint32_t side_to(const strip *s, uint32_t triangle, uint32_t other)
{
    for (uint32_t side = 3 * triangle; side < 3 * triangle + 3; side++)
        for (uint32_t i = 3 * other; i < 3 * other + 3; i++)
            if (s->edges->of[side] == s->edges->of[i])
                return side;
    return NONE;
}

/* Unfolds a point in the plane of a triangle. Its corners 0 and 1 are unfolded to a and b. Corner 2, and so its inside,
   is to the left of a..b if `turn` is 1, and to the right if it is -1. */
static void unfold(double corners[3][3], const double a[2], const double b[2], double turn, const double point[3],
                   double out[2])
{
    double side[3], rise[3], from[3];
    subtract(corners[1], corners[0], side);
    subtract(corners[2], corners[0], rise);
    subtract(point, corners[0], from);
    const double square = dot(side, side), part = dot(rise, side) / square;
    for (int i = 0; i < 3; i++)
        rise[i] -= part * side[i];
    const double height = sqrt(dot(rise, rise)), length = sqrt(square);
    const double along = dot(from, side) / square, up = height > 0 ? turn * dot(from, rise) / height / length : 0;
    out[0] = a[0] + along * (b[0] - a[0]) - up * (b[1] - a[1]);
    out[1] = a[1] + along * (b[1] - a[1]) + up * (b[0] - a[0]);
}

static void corners_of(const strip *s, uint32_t triangle, uint32_t first, uint32_t second, double corners[3][3])
{
    const uint32_t *t = s->mesh->triangles + 3 * (size_t)triangle;
    place_of(s->mesh, first, corners[0]);
    place_of(s->mesh, second, corners[1]);
    for (int i = 0; i < 3; i++)
        if (t[i] != first && t[i] != second)
            place_of(s->mesh, t[i], corners[2]);
}

/* Unfolds the first triangle: its first portal is on the x axis, and the triangle below it. */
static void unfold_first(strip *s)
{
    const uint32_t side = side_to(s, s->triangles[0], s->triangles[1]);
    portal *p = &s->portals[0];
    double corners[3][3], way[3];
    p->vertex[0] = fxs_side_end(s->mesh, side);
    p->vertex[1] = fxs_side_begin(s->mesh, side);
    corners_of(s, s->triangles[0], p->vertex[0], p->vertex[1], corners);
    subtract(corners[1], corners[0], way);
    memset(p->at, 0, sizeof p->at);
    p->at[1][0] = sqrt(dot(way, way));
    unfold(corners, p->at[0], p->at[1], -1, s->from->at, s->begin);
}

/* Unfolds all portals, and both ends. */
static void unfold_strip(strip *s)
{
    double corners[3][3];
    unfold_first(s);
    for (uint32_t i = 1; i < s->count; i++) {
        const portal *p = &s->portals[i - 1];
        const uint32_t triangle = s->triangles[i];
        corners_of(s, triangle, p->vertex[0], p->vertex[1], corners);
        if (i + 1 == s->count) {
            unfold(corners, p->at[0], p->at[1], 1, s->to->at, s->end);
            break;
        }
        const uint32_t side = side_to(s, triangle, s->triangles[i + 1]);
        const uint32_t ends[2] = {fxs_side_begin(s->mesh, side), fxs_side_end(s->mesh, side)};
        portal *next = &s->portals[i];
        *next = *p;
        const int kept = ends[0] == p->vertex[0] || ends[1] == p->vertex[0] ? 0 : 1;
        next->vertex[!kept] = ends[ends[0] == p->vertex[kept]];
        unfold(corners, p->at[0], p->at[1], 1, corners[2], next->at[!kept]);
    }
}

static double area_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance_between(const double a[2], const double b[2])
{
    return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
}

static int is_same_point(const double a[2], const double b[2])
{
    return a[0] == b[0] && a[1] == b[1];
}

static const double *place_of_bend(const strip *s, uint32_t i)
{
    return s->portals[s->bends[i].portal].at[s->bends[i].side];
}

/* The funnel from its tip through the portals so far: between two of their ends. */
typedef struct funnel {
    const double *tip, *ends[2];
    uint32_t portals[2];
} funnel;

/* Narrows a side of the funnel to the end of portal i. Returns 1 if that crosses the other side, at whose end the way
   then bends. The left side of the way has the positive areas. */
static int narrow(funnel *f, int side, const double *end, uint32_t i)
{
    const double sign = side ? 1 : -1;
    if (sign * area_of(f->tip, f->ends[side], end) < 0)
        return 0;
    if (!is_same_point(f->tip, f->ends[side]) && sign * area_of(f->tip, f->ends[!side], end) > 0)
        return 1;
    f->ends[side] = end;
    f->portals[side] = i;
    return 0;
}

/* Straightens the way in the unfolded strip by a funnel (Lee and Preparata 1984): finds its bends and its length. */
static void straighten(strip *s)
{
    funnel f = {s->begin, {s->begin, s->begin}, {0, 0}};
    s->bend_count = 0;
    s->length = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (int side = 0; side < 2; side++) {
            const double *end = i + 1 < s->count ? s->portals[i].at[side] : s->end;
            if (!narrow(&f, side, end, i) || s->bend_count == s->room)
                continue;
            s->bends[s->bend_count++] = (bend){f.portals[!side], (uint32_t)!side};
            s->length += distance_between(f.tip, f.ends[!side]);
            i = f.portals[!side];
            f = (funnel){f.ends[!side], {f.ends[!side], f.ends[!side]}, {i, i}};
            break;
        }
    s->length += distance_between(f.tip, s->end);
}

static void settle(strip *s)
{
    if (s->count > 1)
        unfold_strip(s);
    if (s->count > 1) {
        straighten(s);
        return;
    }
    double way[3];
    subtract(s->to->at, s->from->at, way);
    s->bend_count = 0;
    s->length = sqrt(dot(way, way));
}

/* ---- Bends ------------------------------------------------------------------------------------------------------- */

/* A sum of angles: whole half turns, and a direction in the upper half plane. */
typedef struct turned {
    int halves;
    double x, y;
} turned;

/* Adds an angle of 0 to half a turn, with the cosine and sine x and y times any length. */
static void add_angle(turned *sum, double x, double y)
{
    const double length = sqrt(x * x + y * y);
    if (!(length > 0))
        return;
    const double c = x / length, s = y / length, turned_x = sum->x * c - sum->y * s, turned_y = sum->x * s + sum->y * c;
    const int is_over = turned_y < 0 || (turned_y == 0 && turned_x < 0);
    sum->halves += is_over;
    sum->x = is_over ? -turned_x : turned_x;
    sum->y = is_over ? -turned_y : turned_y;
}

/* Adds the angle of a triangle at one of its corners. */
static void add_corner(turned *sum, const fxs_mesh *mesh, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *t = mesh->triangles + 3 * (size_t)triangle;
    const int i = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    double tip[3], u[3], v[3], n[3];
    place_of(mesh, vertex, tip);
    place_of(mesh, t[(i + 1) % 3], u);
    place_of(mesh, t[(i + 2) % 3], v);
    subtract(u, tip, u);
    subtract(v, tip, v);
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    add_angle(sum, dot(u, v), sqrt(dot(n, n)));
}

/* Goes from a triangle over a side of it to the next triangle at a vertex. *side becomes the next one's other side at
   the vertex. Returns NONE at an edge that has not two triangles. */
static uint32_t next_around(const strip *s, uint32_t vertex, uint32_t *side)
{
    const uint32_t edge = s->edges->of[*side], first = s->edges->first[edge];
    if (s->edges->first[edge + 1] - first != 2)
        return NONE;
    const uint32_t across = s->edges->sides[first] == *side ? s->edges->sides[first + 1] : s->edges->sides[first];
    const uint32_t next = fxs_side_next(across), last = fxs_side_next(next);
    *side = fxs_side_begin(s->mesh, next) == vertex || fxs_side_end(s->mesh, next) == vertex ? next : last;
    return across / 3;
}

/* The part of a strip around a vertex: triangles `first` to `last`. */
typedef struct fan {
    uint32_t vertex, first, last;
} fan;

static fan fan_of(const strip *s, uint32_t number)
{
    const bend *b = &s->bends[number];
    fan f = {s->portals[b->portal].vertex[b->side], b->portal, b->portal + 1};
    while (f.first && s->portals[f.first - 1].vertex[b->side] == f.vertex)
        f.first--;
    while (f.last + 1 < s->count && s->portals[f.last].vertex[b->side] == f.vertex)
        f.last++;
    return f;
}

/* Returns the other side at the fan's vertex of its first triangle, which the strip does not cross. */
static uint32_t side_out(const strip *s, const fan *f)
{
    const uint32_t triangle = s->triangles[f->first], crossed = side_to(s, triangle, s->triangles[f->first + 1]);
    for (uint32_t side = 3 * triangle; side < 3 * triangle + 3; side++)
        if (side != crossed && (fxs_side_begin(s->mesh, side) == f->vertex || fxs_side_end(s->mesh, side) == f->vertex))
            return side;
    return NONE;
}

/* True if the angle on the other side of a bend is less than half a turn, so that a way there is shorter. That angle is
   all of the angle at the vertex, and the angle between the two parts of the way in the plane, less a whole turn. */
static int is_shorter_around(const strip *s, uint32_t number, const fan *f, uint64_t *work)
{
    const double *tip = place_of_bend(s, number);
    const double *in = number ? place_of_bend(s, number - 1) : s->begin;
    const double *out = number + 1 < s->bend_count ? place_of_bend(s, number + 1) : s->end;
    const uint32_t start = s->triangles[f->first];
    uint32_t side = side_out(s, f), triangle = start, steps = 0;
    turned sum = {0, 1, 0};
    do {
        add_corner(&sum, s->mesh, triangle, f->vertex);
        triangle = next_around(s, f->vertex, &side);
    } while (triangle != NONE && triangle != start && steps++ < s->mesh->triangle_count);
    *work += steps;
    const double u[2] = {in[0] - tip[0], in[1] - tip[1]}, v[2] = {out[0] - tip[0], out[1] - tip[1]};
    add_angle(&sum, u[0] * v[0] + u[1] * v[1], fabs(u[0] * v[1] - u[1] * v[0]));
    return triangle == start && sum.halves < 3;
}

/* Makes the strip that passes a fan's vertex on its other side. Returns 0 if it meets an open edge. */
static int go_around(const strip *s, const fan *f, strip *to)
{
    uint32_t side = side_out(s, f), triangle = s->triangles[f->first];
    to->count = 0;
    for (uint32_t i = 0; i < f->first; i++)
        add_triangle(to, s->triangles[i]);
    while (triangle != NONE && to->count < to->room) {
        add_triangle(to, triangle);
        if (triangle == s->triangles[f->last])
            break;
        triangle = next_around(s, f->vertex, &side);
    }
    if (triangle == NONE || to->count + s->count - f->last > to->room)
        return 0;
    for (uint32_t i = f->last + 1; i < s->count; i++)
        add_triangle(to, s->triangles[i]);
    settle(to);
    return 1;
}

/* Leads the way around the other side of its bends, as long as it becomes shorter. */
static void shorten(strip *s, strip *other)
{
    uint64_t work = 0;
    for (uint32_t i = 0; i < s->bend_count && work < WORK_MOST; i++) {
        const fan f = fan_of(s, i);
        work += f.last - f.first + 1;
        if (!is_shorter_around(s, i, &f, &work) || !go_around(s, &f, other))
            continue;
        work += s->count;
        if (other->length < s->length * (1 - LEAST_GAIN)) {
            const strip kept = *s;
            *s = *other;
            *other = kept;
            i = i > 1 ? i - 2 : NONE;    /* the bends before may have changed */
        }
    }
}

/* ---- Routes ------------------------------------------------------------------------------------------------------ */

static void add_point(fxs_mesh_route *route, const fxs_mesh *mesh, const double at[3])
{
    for (int i = 0; i < 3; i++)
        route->points[route->count][i] = mesh->origin[i] + mesh->step / 65536 * at[i];
    route->count++;
}

/* Adds the point where the way from p to q crosses a portal, unless it is one of the portal's ends. */
static void add_crossing(fxs_mesh_route *route, const strip *s, const portal *crossed, const double p[2],
                         const double q[2])
{
    const double left = area_of(p, q, crossed->at[0]), right = area_of(p, q, crossed->at[1]);
    const double part = left - right > 0 ? clamp(left / (left - right)) : 0;
    double a[3], b[3];
    for (int side = 0; side < 2; side++)
        if (is_same_point(crossed->at[side], p) || is_same_point(crossed->at[side], q))
            return;
    place_of(s->mesh, crossed->vertex[0], a);
    place_of(s->mesh, crossed->vertex[1], b);
    for (int i = 0; i < 3; i++)
        a[i] += part * (b[i] - a[i]);
    add_point(route, s->mesh, a);
}

static int make_points(fxs_mesh_route *route, const strip *s, fxs_message *message)
{
    const double *p = s->begin;
    uint32_t next = 0;
    double at[3];
    route->points = fxs_allocate(NULL, (size_t)s->count + s->bend_count + 1, sizeof *route->points);
    if (!route->points)
        return fxs_fail_memory(message, NULL, 0);
    add_point(route, s->mesh, s->from->at);
    for (uint32_t i = 0; i <= s->bend_count; i++) {
        const int is_last = i == s->bend_count;
        const double *q = is_last ? s->end : place_of_bend(s, i);
        const uint32_t end = is_last ? s->count - 1 : s->bends[i].portal;
        for (; next < end; next++)
            add_crossing(route, s, &s->portals[next], p, q);
        if (!is_last) {
            place_of(s->mesh, s->portals[end].vertex[s->bends[i].side], at);
            add_point(route, s->mesh, at);
            next = end + 1;
        }
        p = q;
    }
    add_point(route, s->mesh, s->to->at);
    return 0;
}

/* Makes the strip of the way to a node: from the last triangle back to the first, then turned around. */
static void take_way(const search *s, uint32_t last, strip *to)
{
    uint32_t count = 0;
    add_triangle(to, s->to.triangle);
    for (uint32_t node = last; node != NONE; node = s->before[node])
        add_triangle(to, s->through[node]);
    for (count = 0; count < to->count / 2; count++) {
        const uint32_t other = to->triangles[to->count - 1 - count];
        to->triangles[to->count - 1 - count] = to->triangles[count];
        to->triangles[count] = other;
    }
    settle(to);
}

static int find_route(fxs_mesh_route *route, search *s, strip strips[2], fxs_message *message)
{
    const fxs_mesh *mesh = s->mesh;
    uint32_t last = NONE, steps = 0;
    if (s->from.triangle != s->to.triangle) {
        FXS_TRY(make_search(s, mesh, message));
        last = find_last(s);
        if (last == NONE)
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "the points lie on parts of the mesh that are not joined");
    }
    for (uint32_t node = last; node != NONE; node = s->before[node])
        steps++;
    const uint64_t twice = 2 * ((uint64_t)steps + mesh->triangle_count), room = twice < ROOM_MOST ? twice : ROOM_MOST;
    for (int i = 0; i < 2; i++) {
        strips[i] = (strip){.mesh = mesh, .edges = &s->edges, .from = &s->from, .to = &s->to};
        FXS_TRY(make_strip(&strips[i], (uint32_t)room + 2 * steps + 4, message));
    }
    take_way(s, last, &strips[0]);
    shorten(&strips[0], &strips[1]);
    route->along = strips[0].length * (mesh->step / 65536);
    return make_points(route, &strips[0], message);
}

int fxs_mesh_find_route(fxs_mesh_route *route, const fxs_mesh *mesh, const double from[3], const double to[3],
                        fxs_message *message)
{
    search s = {.mesh = mesh};
    strip strips[2] = {{.mesh = mesh}, {.mesh = mesh}};
    double way[3];
    int32_t low[3], high[3];
    memset(route, 0, sizeof *route);
    FXS_TRY(fxs_mesh_find_box(mesh, low, high, message));
    FXS_TRY(find_spot(mesh, from, &s.from, message));
    FXS_TRY(find_spot(mesh, to, &s.to, message));
    for (int i = 0; i < 3; i++) {
        route->from[i] = mesh->origin[i] + mesh->step / 65536 * s.from.at[i];
        route->to[i] = mesh->origin[i] + mesh->step / 65536 * s.to.at[i];
    }
    subtract(route->to, route->from, way);
    route->straight = sqrt(dot(way, way));
    const int error = find_route(route, &s, strips, message);
    for (int i = 0; i < 2; i++)
        free_strip(&strips[i]);
    fxs_mesh_edges_free(&s.edges);
    fxs_release(NULL, s.key);
    fxs_release(NULL, s.before);
    return error;
}

void fxs_mesh_route_free(fxs_mesh_route *route)
{
    fxs_release(NULL, route->points);
    memset(route, 0, sizeof *route);
}
