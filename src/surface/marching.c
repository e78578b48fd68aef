/* Takes the mesh of a volume by marching cubes (Lorensen and Cline 1987). The table of cases is computed: on each face
   of a cell, edges where the sign changes are joined so that corners inside are apart. Neighbours share the rule, so
   their triangles meet. */
#include "volume.h"

#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"

/* A corner of a cell is a number of three bits: x, y, z. An edge has the number 8 * axis + its lower corner. */
enum { CORNERS = 8, EDGES = 24, CASES = 256, CORNERS_OF_CASE = 30, NO_EDGE = 255 };

enum { SIDE = FXS_BRICK + 1, BLOCK = SIDE * SIDE * SIDE, WORDS = 3 * FXS_BRICK_VOXELS / 64 };
enum { CLOSEST_Q16 = 256 };              /* least distance of a vertex from a voxel, so that no triangle is empty */

/* ---- Cases ------------------------------------------------------------------------------------------------------- */

typedef struct table {
    uint8_t count[CASES];                /* corners of triangles of a case; bit c of a case: corner c is inside */
    uint8_t edges[CASES][CORNERS_OF_CASE];
} table;

static uint8_t edge_between(int p, int q)
{
    const int axis = (p ^ q) == 1 ? 0 : (p ^ q) == 2 ? 1 : 2;
    return (uint8_t)(8 * axis + (p & q));
}

/* Joins the edges of a face, with its corners counterclockwise seen from outside. For each run of corners inside, the
   edge behind the run follows the edge before it, so that triangles are counterclockwise. */
static void join_face(const int face[4], int inside, uint8_t next[EDGES])
{
    for (int i = 0; i < 4; i++) {
        int first = i;
        if (!(inside >> face[i] & 1) || inside >> face[(i + 1) % 4] & 1)
            continue;
        while (inside >> face[(first + 3) % 4] & 1)
            first = (first + 3) % 4;
        next[edge_between(face[(first + 3) % 4], face[first])] = edge_between(face[i], face[(i + 1) % 4]);
    }
}

static void make_face(int side, int face[4])
{
    const int a = side / 2, up = side % 2, x = 1 << (a + 1) % 3, y = 1 << (a + 2) % 3, base = up << a;
    const int corners[4] = {base, base | (up ? x : y), base | x | y, base | (up ? y : x)};
    memcpy(face, corners, sizeof corners);
}

/* True if two edges belong to one face. A diagonal between them could be a side of two triangles of the next cell. */
static int share_face(int p, int q)
{
    const int ends[4] = {p % 8, p % 8 | 1 << p / 8, q % 8, q % 8 | 1 << q / 8};
    int all = 7, any = 0;
    for (int i = 0; i < 4; i++) {
        all &= ends[i];
        any |= ends[i];
    }
    return all != 0 || any != 7;
}

/* Returns the edge of a loop from which a fan of triangles has no diagonal on a face. Each loop has one. */
static uint8_t find_apex(const uint8_t next[EDGES], uint8_t first)
{
    for (uint8_t apex = first;; apex = next[apex]) {
        uint8_t to = next[next[apex]];
        while (next[to] != apex && !share_face(apex, to))
            to = next[to];
        if (next[to] == apex)
            return apex;
    }
}

static void make_case(table *t, int inside)
{
    uint8_t next[EDGES];
    memset(next, NO_EDGE, sizeof next);
    for (int side = 0; side < 6; side++) {
        int face[4];
        make_face(side, face);
        join_face(face, inside, next);
    }
    for (uint8_t start = 0; start < EDGES; start++) {
        const uint8_t first = next[start] == NO_EDGE ? start : find_apex(next, start);
        while (next[first] != NO_EDGE) {
            uint8_t *to = t->edges[inside] + t->count[inside], second = next[first], third = next[second];
            if (third == first) {                /* the last two edges of a loop */
                next[second] = next[first] = NO_EDGE;
                break;
            }
            to[0] = first;
            to[1] = second;
            to[2] = third;
            t->count[inside] = (uint8_t)(t->count[inside] + 3);
            next[second] = NO_EDGE;
            next[first] = third;
        }
    }
}

/* ---- Sites ------------------------------------------------------------------------------------------------------- */

/* A cell of the grid with a part of the mesh. Its vertices lie on the edges of the cell's voxels, numbered by axis and
   voxel: bit 512 * axis + voxel of `bits` is an edge from the voxel along the axis that has a vertex. */
typedef struct site {
    uint32_t cell, vertices, triangles;  /* first vertex and triangle; before that, their numbers */
    uint16_t before[WORDS];              /* number of bits in the words before */
    uint64_t bits[WORDS];
} site;

typedef struct value {
    int32_t sum_q15;
    uint32_t weight;                     /* 0: unknown */
} value;

typedef struct marching {
    fxs_volume *volume;
    table table;
    site *sites;
    uint32_t *site_of;                   /* number of the site of a cell, or FXS_NO_BRICK */
    uint32_t count;
    fxs_mesh *mesh;
} marching;

static void first_of_cell(const fxs_volume *v, uint32_t cell, uint32_t first[3])
{
    first[0] = FXS_BRICK * (cell % v->size[0]);
    first[1] = FXS_BRICK * (cell / v->size[0] % v->size[1]);
    first[2] = FXS_BRICK * (cell / v->size[0] / v->size[1]);
}

enum overlap { BEYOND, ACROSS, WITHIN };

/* Returns how a cell lies to the box. */
static enum overlap overlap_of(const fxs_volume *v, uint32_t cell)
{
    uint32_t first[3];
    int low = 1, high = 1;
    first_of_cell(v, cell, first);
    for (int i = 0; i < 3; i++) {
        const uint32_t last = first[i] + FXS_BRICK - 1;
        if (last < v->first[i] || first[i] > v->last[i])
            return BEYOND;
        low &= first[i] >= v->first[i];
        high &= last <= v->last[i];
    }
    return low && high ? WITHIN : ACROSS;
}

static value value_beyond(const fxs_volume *v)
{
    return v->options.closed ? (value){v->options.is_cave ? -1 : 1, 1} : (value){0, 0};
}

/* The value of the voxels in the box of a cell without a brick. */
static value value_of_cell(const fxs_volume *v, uint32_t cell)
{
    if (!v->options.closed || overlap_of(v, cell) == BEYOND)
        return value_beyond(v);
    return (value){v->open[cell] ? 1 : -1, 1};
}

static value value_of_voxel(const fxs_volume *v, const fxs_brick *brick, uint32_t voxel)
{
    if (brick->weight[voxel] < FXS_WHOLE * v->options.least_views)
        return v->options.closed ? (value){-1, 1} : (value){0, 0};
    return (value){brick->sum_q15[voxel], brick->weight[voxel]};
}

/* Returns the cell at a corner of the cube of eight cells that begins with `cell`. */
static uint32_t cell_at(const fxs_volume *v, uint32_t cell, uint32_t corner)
{
    return cell + (corner & 1) + v->size[0] * ((corner >> 1 & 1) + v->size[1] * (corner >> 2));
}

static int is_in_box(const fxs_volume *v, const uint32_t at[3])
{
    for (int i = 0; i < 3; i++)
        if (at[i] < v->first[i] || at[i] > v->last[i])
            return 0;
    return 1;
}

/* Reads the voxels of a cell and the first ones of the cells behind it. */
static void gather(const fxs_volume *v, uint32_t cell, value block[BLOCK])
{
    uint32_t first[3];
    first_of_cell(v, cell, first);
    for (uint32_t i = 0; i < BLOCK; i++) {
        const uint32_t x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const uint32_t corner = x / FXS_BRICK | y / FXS_BRICK << 1 | z / FXS_BRICK << 2;
        const uint32_t at = cell_at(v, cell, corner), brick = v->grid[at];
        const uint32_t voxel = (z % FXS_BRICK * FXS_BRICK + y % FXS_BRICK) * FXS_BRICK + x % FXS_BRICK;
        if (!is_in_box(v, (uint32_t[]){first[0] + x, first[1] + y, first[2] + z}))
            block[i] = value_beyond(v);
        else
            block[i] = brick == FXS_NO_BRICK ? value_of_cell(v, at) : value_of_voxel(v, &v->bricks[brick], voxel);
    }
}

/* Returns the place in a block of a corner of the cell at a voxel. */
static uint32_t block_at(uint32_t voxel, uint32_t corner)
{
    const uint32_t x = voxel % FXS_BRICK + (corner & 1), y = voxel / FXS_BRICK % FXS_BRICK + (corner >> 1 & 1);
    return ((voxel / FXS_BRICK / FXS_BRICK + (corner >> 2)) * SIDE + y) * SIDE + x;
}

/* Returns the case of the cell at a voxel; 0, which has no triangles, if a corner is unknown. */
static uint32_t case_at(const value block[BLOCK], uint32_t voxel)
{
    uint32_t inside = 0;
    for (uint32_t corner = 0; corner < CORNERS; corner++) {
        const value *v = &block[block_at(voxel, corner)];
        if (!v->weight)
            return 0;
        inside |= (uint32_t)(v->sum_q15 < 0) << corner;
    }
    return inside;
}

static uint32_t ones(uint64_t bits)
{
    bits -= bits >> 1 & 0x5555555555555555u;
    bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
    bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return (uint32_t)(bits * 0x0101010101010101u >> 56);
}

/* A cell is a site if it has a brick. In a closed mesh, also if it lies across the side of the box, or if a cell behind
   it has a brick or another value. */
static int is_site(const fxs_volume *v, uint32_t cell)
{
    const uint32_t x = cell % v->size[0], y = cell / v->size[0] % v->size[1], z = cell / v->size[0] / v->size[1];
    if (v->grid[cell] != FXS_NO_BRICK)
        return 1;
    if (!v->options.closed || x == v->size[0] - 1 || y == v->size[1] - 1 || z == v->size[2] - 1)
        return 0;
    if (overlap_of(v, cell) == ACROSS)
        return 1;
    for (uint32_t corner = 1; corner < CORNERS; corner++) {
        const uint32_t at = cell_at(v, cell, corner);
        if (v->grid[at] != FXS_NO_BRICK || value_of_cell(v, at).sum_q15 != value_of_cell(v, cell).sum_q15)
            return 1;
    }
    return 0;
}

static int find_sites(marching *m, fxs_message *message)
{
    const fxs_volume *v = m->volume;
    m->site_of = fxs_allocate(NULL, v->cells, sizeof *m->site_of);
    if (!m->site_of)
        return fxs_fail_memory(message, NULL, 0);
    for (uint32_t i = 0; i < v->cells; i++)
        m->site_of[i] = is_site(v, i) ? m->count++ : FXS_NO_BRICK;
    m->sites = fxs_allocate_zeroed(NULL, (size_t)m->count + 1, sizeof *m->sites);
    if (!m->sites)
        return fxs_fail_memory(message, NULL, 0);
    for (uint32_t i = 0; i < v->cells; i++)
        if (m->site_of[i] != FXS_NO_BRICK)
            m->sites[m->site_of[i]].cell = i;
    return 0;
}

/* ---- Counting ---------------------------------------------------------------------------------------------------- */

static void count_site(void *argument, uint32_t number)
{
    const marching *m = argument;
    site *s = &m->sites[number];
    value block[BLOCK];
    gather(m->volume, s->cell, block);
    for (uint32_t i = 0; i < 3 * FXS_BRICK_VOXELS; i++) {
        const uint32_t voxel = i % FXS_BRICK_VOXELS;
        const value *from = &block[block_at(voxel, 0)], *to = &block[block_at(voxel, 1u << i / FXS_BRICK_VOXELS)];
        const int crosses = from->weight && to->weight && (from->sum_q15 < 0) != (to->sum_q15 < 0);
        s->bits[i / 64] |= (uint64_t)crosses << i % 64;
    }
    for (uint32_t i = 0; i < WORDS; i++) {
        s->before[i] = (uint16_t)s->vertices;
        s->vertices += ones(s->bits[i]);
    }
    for (uint32_t voxel = 0; voxel < FXS_BRICK_VOXELS; voxel++)
        s->triangles += m->table.count[case_at(block, voxel)] / 3u;
}

/* Turns the numbers of the sites into first numbers, and makes room for the mesh. */
static int make_room(marching *m, fxs_message *message)
{
    const fxs_volume *v = m->volume;
    uint64_t vertices = 0, triangles = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        site *s = &m->sites[i];
        const uint32_t own_vertices = s->vertices, own_triangles = s->triangles;
        s->vertices = (uint32_t)vertices;
        s->triangles = (uint32_t)triangles;
        vertices += own_vertices;
        triangles += own_triangles;
    }
    const uint64_t bytes = 9 * (uint64_t)v->cells + v->brick_count * (uint64_t)sizeof *v->bricks +
                           m->count * (uint64_t)sizeof *m->sites + 16 * vertices + 12 * triangles;
    FXS_TRY(fxs_surface_check(bytes, v->options.max_memory, message));
    if (vertices >= UINT32_MAX || triangles >= UINT32_MAX)
        return fxs_fail_as(FXS_ERR_MEMORY, message, "the mesh has more than 2^32 vertices: lower the resolution");
    fxs_mesh *mesh = m->mesh;
    mesh->vertex_count = (uint32_t)vertices;
    mesh->triangle_count = (uint32_t)triangles;
    mesh->places = fxs_allocate(NULL, (size_t)vertices + 1, 3 * sizeof *mesh->places);
    mesh->colours = fxs_allocate(NULL, (size_t)vertices + 1, 4);
    mesh->triangles = fxs_allocate(NULL, (size_t)triangles + 1, 3 * sizeof *mesh->triangles);
    return mesh->places && mesh->colours && mesh->triangles ? 0 : fxs_fail_memory(message, NULL, bytes);
}

/* ---- Making ------------------------------------------------------------------------------------------------------ */

/* Returns the place of the change of sign between two values, at 0 to 1 in Q16: |a| / (|a| + |b|), a and b means. */
static uint32_t crossing_q16(const value *from, const value *to)
{
    const uint64_t a = (uint64_t)(from->sum_q15 < 0 ? -from->sum_q15 : from->sum_q15) * to->weight;      /* < 2^47 */
    const uint64_t b = (uint64_t)(to->sum_q15 < 0 ? -to->sum_q15 : to->sum_q15) * from->weight;
    const uint32_t at = (uint32_t)((65536 * a + (a + b) / 2) / (a + b));
    return at < CLOSEST_Q16 ? CLOSEST_Q16 : at > 65536 - CLOSEST_Q16 ? 65536 - CLOSEST_Q16 : at;
}

/* Finds the mean colour of a voxel. Returns 0 if it has none. */
static int colour_of(const fxs_volume *v, uint32_t cell, uint32_t voxel, uint32_t colour[3])
{
    const uint32_t number = v->grid[cell];
    const uint32_t count = number == FXS_NO_BRICK ? 0 : v->bricks[number].coloured[voxel];
    for (int i = 0; i < 3 && count; i++)
        colour[i] = (v->bricks[number].colour[voxel][i] + count / 2) / count;
    return count != 0;
}

/* Returns the cell of the voxel after `voxel` along an axis, and stores the voxel in that cell. */
static uint32_t step_along(const fxs_volume *v, uint32_t cell, uint32_t axis, uint32_t *voxel)
{
    const uint32_t shift = 3 * axis, at = *voxel >> shift & 7;
    *voxel = at < 7 ? *voxel + (1u << shift) : *voxel - (7u << shift);
    return at < 7 ? cell : cell_at(v, cell, 1u << axis);
}

static void colour_vertex(const fxs_volume *v, uint32_t cell, uint32_t axis, uint32_t voxel, uint32_t at_q16,
                          uint8_t to[4])
{
    uint32_t one[3] = {128, 128, 128}, other[3] = {128, 128, 128}, next = voxel;
    const uint32_t next_cell = step_along(v, cell, axis, &next);
    const int has_one = colour_of(v, cell, voxel, one), has_other = colour_of(v, next_cell, next, other);
    for (int i = 0; i < 3; i++) {
        const uint32_t a = has_one ? one[i] : other[i], b = has_other ? other[i] : one[i];
        to[i] = (uint8_t)((a * (65536 - at_q16) + b * at_q16 + 32768) >> 16);
    }
    to[3] = has_one || has_other ? 255 : 0;
}

static void make_vertices(const marching *m, const site *s, const value block[BLOCK])
{
    const fxs_volume *v = m->volume;
    uint32_t number = s->vertices;
    uint32_t first[3];
    first_of_cell(v, s->cell, first);
    for (uint32_t i = 0; i < 3 * FXS_BRICK_VOXELS; i++) {
        const uint32_t axis = i / FXS_BRICK_VOXELS, voxel = i % FXS_BRICK_VOXELS;
        if (!(s->bits[i / 64] >> i % 64 & 1))
            continue;
        const uint32_t at = crossing_q16(&block[block_at(voxel, 0)], &block[block_at(voxel, 1u << axis)]);
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t place = (first[k] + (voxel >> 3 * k & 7)) << 16;
            m->mesh->places[3 * (size_t)number + k] = (int32_t)(place + (k == axis ? at : 0));
        }
        colour_vertex(v, s->cell, axis, voxel, at, m->mesh->colours + 4 * (size_t)number);
        number++;
    }
}

/* Returns the number of the vertex on an edge of the cell at a voxel. */
static uint32_t vertex_at(const marching *m, const site *s, uint32_t voxel, uint32_t edge)
{
    uint32_t cell = s->cell;
    for (uint32_t axis = 0; axis < 3; axis++)
        if (edge >> axis & 1)
            cell = step_along(m->volume, cell, axis, &voxel);
    const site *of = &m->sites[m->site_of[cell]];
    const uint32_t bit = edge / 8 * FXS_BRICK_VOXELS + voxel;
    return of->vertices + of->before[bit / 64] + ones(of->bits[bit / 64] & (((uint64_t)1 << bit % 64) - 1));
}

static void make_site(void *argument, uint32_t number)
{
    const marching *m = argument;
    const site *s = &m->sites[number];
    value block[BLOCK];
    gather(m->volume, s->cell, block);
    make_vertices(m, s, block);
    uint32_t *to = m->mesh->triangles + 3 * (size_t)s->triangles;
    for (uint32_t voxel = 0; voxel < FXS_BRICK_VOXELS; voxel++) {
        const uint32_t inside = case_at(block, voxel);
        for (uint32_t i = 0; i < m->table.count[inside]; i++)
            *to++ = vertex_at(m, s, voxel, m->table.edges[inside][i]);
    }
}

static void free_bricks(fxs_volume *v)
{
    fxs_release(NULL, v->bricks);
    v->bricks = NULL;
    v->brick_count = 0;
}

int fxs_volume_mesh(fxs_volume *volume, fxs_mesh **mesh, fxs_message *message)
{
    marching *m = fxs_allocate_zeroed(NULL, 1, sizeof *m);
    *mesh = fxs_allocate_zeroed(NULL, 1, sizeof **mesh);
    int error = m && *mesh ? 0 : fxs_fail_memory(message, NULL, 0);
    if (!error && !volume->bricks)
        error = fxs_fail_as(FXS_ERR_ARGUMENT, message, "a volume without bricks");
    if (!error) {
        m->volume = volume;
        m->mesh = *mesh;
        (*mesh)->step = volume->step;
        (*mesh)->half_q16 = volume->half_q16;
        (*mesh)->middle_q16 = volume->middle_q16;
        (*mesh)->max_memory = volume->options.max_memory;
        memcpy((*mesh)->origin, volume->origin, sizeof volume->origin);
        for (int i = 0; i < CASES; i++)
            make_case(&m->table, i);
        error = find_sites(m, message);
    }
    if (!error) {
        fxs_volume_run(volume, count_site, m, m->count);
        error = make_room(m, message);
    }
    if (!error) {
        fxs_volume_run(volume, make_site, m, m->count);
        free_bricks(volume);
    }
    if (m) {
        fxs_release(NULL, m->sites);
        fxs_release(NULL, m->site_of);
    }
    fxs_release(NULL, m);
    error = error ? error : fxs_mesh_compact(*mesh, message);
    error = error ? error : fxs_mesh_split_fans(*mesh, message);
    error = error ? error : fxs_mesh_spread_colours(*mesh, message);
    if (error) {
        fxs_mesh_free(*mesh);
        *mesh = NULL;
    }
    return error;
}
