/* Tests meshes: scenes of small discs on surfaces that are known, rendered, fused and compared with the surfaces. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/renderer.h>
#include <fixsplat/surface.h>
#include "check.h"
#include "scene_writer.h"
#include "src/surface/volume.h"

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

typedef struct rectangle {
    double middle[3], u[3], v[3];           /* half of its sides */
} rectangle;

enum { RECTANGLES_MOST = 24 };

typedef struct surface {
    const char *name;
    double sphere, ring;                    /* radius of a sphere, or of a torus about y with a tube of 0.35 */
    rectangle rectangles[RECTANGLES_MOST];
    int count;
    int is_within;
    double chamfer[2], f[2];                /* bounds at the resolutions 64 and 128 */
} surface;

#define PI 3.14159265358979324
#define TUBE 0.35
#define SPACING 0.05

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double distance_to(const rectangle *r, const double p[3])
{
    double from[3], a = 0, b = 0, u = 0, v = 0, rest[3];
    for (int i = 0; i < 3; i++) {
        from[i] = p[i] - r->middle[i];
        a += from[i] * r->u[i];
        b += from[i] * r->v[i];
        u += r->u[i] * r->u[i];
        v += r->v[i] * r->v[i];
    }
    a = fmax(-1, fmin(a / u, 1));
    b = fmax(-1, fmin(b / v, 1));
    for (int i = 0; i < 3; i++)
        rest[i] = from[i] - a * r->u[i] - b * r->v[i];
    return length_of(rest);
}

static double distance_from(const surface *s, const double p[3])
{
    double least = INFINITY;
    if (s->sphere > 0)
        return fabs(length_of(p) - s->sphere);
    if (s->ring > 0)
        return fabs(hypot(hypot(p[0], p[2]) - s->ring, p[1]) - TUBE);
    for (int i = 0; i < s->count; i++)
        least = fmin(least, distance_to(&s->rectangles[i], p));
    return least;
}

/* Adds the sides of a box, with the sides of `open` (bits: -x, +x, -y, +y, -z, +z) left out. */
static void add_box(surface *s, const double low[3], const double high[3], int open)
{
    for (int side = 0; side < 6; side++) {
        const int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        rectangle *r = &s->rectangles[s->count];
        if (open >> side & 1)
            continue;
        memset(r, 0, sizeof *r);
        for (int i = 0; i < 3; i++)
            r->middle[i] = i == a ? (side % 2 ? high : low)[i] : (low[i] + high[i]) / 2;
        r->u[b] = (high[b] - low[b]) / 2;
        r->v[c] = (high[c] - low[c]) / 2;
        s->count++;
    }
}

/* A box with a square hole along z: four bars, without the sides where they meet, and the ends of two reach over. */
static void add_frame(surface *s)
{
    add_box(s, (double[]){-1, -1, -0.6}, (double[]){-0.4, 1, 0.6}, 2);
    add_box(s, (double[]){0.4, -1, -0.6}, (double[]){1, 1, 0.6}, 1);
    add_box(s, (double[]){-0.4, -1, -0.6}, (double[]){0.4, -0.4, 0.6}, 3);
    add_box(s, (double[]){-0.4, 0.4, -0.6}, (double[]){0.4, 1, 0.6}, 3);
    rectangle *r = &s->rectangles[s->count];
    memset(r, 0, 2 * sizeof *r);
    for (int i = 0; i < 2; i++) {
        r[i].middle[0] = i ? 0.4 : -0.4;
        r[i].u[1] = 0.4;
        r[i].v[2] = 0.6;
    }
    s->count += 2;
}

static void put_disc(fxs_scene_writer *w, const double at[3], const double normal[3], double red, double spacing)
{
    fxs_message m;
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    const double half[4] = {1 + normal[2], -normal[1], normal[0], 0}, n = hypot(length_of(half), half[3]);
    for (int i = 0; i < 4; i++)
        g.rotation[i] = n > 1e-6 ? (float)(half[i] / n) : i == 1;
    for (int i = 0; i < 3; i++) {
        g.position[i] = (float)at[i];
        g.scale[i] = (float)log(i < 2 ? 0.6 * spacing : 0.05 * spacing);
        g.dc[i] = (float)(((i ? 0.25 : red) - 0.5) / 0.28209);
    }
    g.opacity = 5;
    CHECK(!fxs_scene_writer_put(w, &g, 1, &m));
}

static int grid_of(const double side[3])
{
    return (int)ceil(2 * length_of(side) / SPACING);
}

static void place_on(const rectangle *r, double a, double b, double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = r->middle[i] + a * r->u[i] + b * r->v[i];
}

/* Point i of n on a sphere or torus, and the normal there. */
static void point_on(const surface *s, int i, int n, double at[3], double normal[3])
{
    const double turn = 2 * PI * 0.6180339887498949 * i, part = (2 * i + 1.0) / n;
    if (s->sphere > 0) {
        const double z = 1 - part, wide = sqrt(1 - z * z);
        memcpy(normal, (double[]){wide * cos(turn), wide * sin(turn), z}, 3 * sizeof *normal);
    } else {
        const double around = PI * part;      /* densest inside, where the tube is narrow */
        memcpy(normal, (double[]){cos(around) * cos(turn), sin(turn), sin(around) * cos(turn)}, 3 * sizeof *normal);
        at[0] = s->ring * cos(around);
        at[2] = s->ring * sin(around);
    }
    for (int k = 0; k < 3; k++)
        at[k] = s->sphere > 0 ? s->sphere * normal[k] : (k == 1 ? 0 : at[k]) + TUBE * normal[k];
}

static int discs_of(const surface *s)
{
    int count = s->sphere > 0 ? 6000 : s->ring > 0 ? 8000 : 0;
    for (int i = 0; i < s->count; i++)
        count += grid_of(s->rectangles[i].u) * grid_of(s->rectangles[i].v);
    return count;
}

static void write_discs(const surface *s, fxs_scene_writer *w)
{
    const int round = s->count ? 0 : discs_of(s);
    double at[3], normal[3];
    for (int i = 0; i < round; i++) {
        point_on(s, i, round, at, normal);
        put_disc(w, at, normal, at[0] > 0 ? 0.9 : 0.1, SPACING);
    }
    for (int i = 0; i < s->count; i++) {
        const rectangle *r = &s->rectangles[i];
        const int across = grid_of(r->u), along = grid_of(r->v);
        for (int k = 0; k < 3; k++)
            normal[k] = r->u[k] == 0 && r->v[k] == 0;
        for (int k = 0; k < across * along; k++) {
            place_on(r, (2 * (k % across) + 1.0) / across - 1, (2 * (k / across) + 1.0) / along - 1, at);
            put_disc(w, at, normal, at[0] > 0 ? 0.9 : 0.1, SPACING);
        }
    }
}

static fxs_opened *open_discs(const surface *s)
{
    char path[] = "/tmp/fixsplat-mesh-XXXXXX";
    fxs_scene_writer *writer;
    fxs_opened *opened = 0;
    fxs_message m;
    const int descriptor = mkstemp(path);
    if (!CHECK(descriptor >= 0))
        return 0;
    close(descriptor);
    if (CHECK(!open_writer("ply", path, (uint64_t)discs_of(s), 0, 0, &writer, &m))) {
        write_discs(s, writer);
        CHECK(!close_writer(writer, &m));
        CHECK(!fxs_open(path, 0, &opened, &m));
    }
    unlink(path);
    return opened;
}

/* ---- Meshes ------------------------------------------------------------------------------------------------------ */

enum { VIEWS = 48, VIEWS_MOST = FXS_VIEWS_WITHIN };

typedef struct drawn {
    fxs_view view;
    uint32_t *depths;
    uint8_t *colours;
    fxs_id *ids;
} drawn;

static void backwards(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    while (jobs--)
        job(argument, jobs);
}

static const double cube[2][3] = {{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}};
static const double wide[2][3] = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}};

static int draw(const fxs_opened *opened, const fxs_object *object, drawn *d)
{
    const size_t pixels = (size_t)d->view.width * (size_t)d->view.height;
    fxs_renderer *renderer;
    fxs_shapes *shapes;
    fxs_request request;
    fxs_message m;
    d->depths = malloc(4 * pixels);
    d->colours = malloc(4 * pixels);
    d->ids = malloc(8 * pixels);
    fxs_request_init(&request, object, 1);
    request.targets[0].format = FXS_FORMAT_RGBA8_COVERAGE;
    request.targets[0].colour = (fxs_image){d->colours, 4 * d->view.width};
    request.targets[0].median_depth = (fxs_image){d->depths, 4 * d->view.width};
    request.targets[0].id = (fxs_image){d->ids, 8 * d->view.width};
    request.targets[0].depth_bits = 24;
    if (!CHECK(!fxs_renderer_create("cpu", 0, &renderer, &m)) || !CHECK(!fxs_shapes_make(&shapes, object, 1, &m)))
        return -1;
    CHECK(!fxs_camera_from_view(&request.cameras[0], &d->view, &m));
    CHECK(!fxs_renderer_render(renderer, &request, 0, &m));
    const fxs_workers none = {0};
    fxs_shapes_refine(shapes, &d->view, d->ids, d->depths, 24, &none);
    fxs_shapes_free(shapes);
    fxs_renderer_forget(renderer, opened->scene);
    fxs_renderer_destroy(renderer);
    return 0;
}

static uint32_t draw_all(const surface *s, drawn *views, const double (*box)[3], int size)
{
    fxs_view of_box[VIEWS_MOST];
    fxs_object object;
    fxs_message m;
    fxs_opened *opened = open_discs(s);
    const uint32_t count = s->is_within ? FXS_VIEWS_WITHIN : VIEWS;
    if (!opened)
        return 0;
    CHECK(!(s->is_within ? fxs_views_within(of_box, box[0], box[1], size, &m)
                         : fxs_views_around(of_box, count, box[0], box[1], size, &m)));
    fxs_object_init(&object, opened->scene);
    for (uint32_t i = 0; i < count; i++) {
        views[i].view = of_box[i];
        draw(opened, &object, &views[i]);
    }
    fxs_close(opened);
    return count;
}

static void free_drawn(drawn *views, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        free(views[i].depths);
        free(views[i].colours);
        free(views[i].ids);
    }
}

static fxs_volume_options options_for(const double (*box)[3], uint32_t resolution)
{
    fxs_volume_options o;
    fxs_volume_options_init(&o);
    o.resolution = resolution;
    memcpy(o.low, box[0], sizeof o.low);
    memcpy(o.high, box[1], sizeof o.high);
    return o;
}

static int pass(fxs_volume *v, const drawn *views, uint32_t count, int is_reversed,
                int (*take)(fxs_volume *, const fxs_depth_picture *, fxs_message *), fxs_message *m)
{
    int error = 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        const drawn *d = &views[is_reversed ? count - 1 - i : i];
        const fxs_depth_picture picture = {&d->view, d->depths, d->colours, 24};
        error = take(v, &picture, m);
    }
    return error;
}

static fxs_mesh *mesh_of(const drawn *views, uint32_t count, const fxs_volume_options *o, int is_reversed)
{
    fxs_volume *v;
    fxs_mesh *mesh = 0;
    fxs_message m;
    if (!CHECK(!fxs_volume_make(&v, o, &m)))
        return 0;
    CHECK(!pass(v, views, count, is_reversed, fxs_volume_mark, &m));
    CHECK(!fxs_volume_reserve(v, 0, &m));
    CHECK(!pass(v, views, count, is_reversed, fxs_volume_add, &m));
    CHECK(!fxs_volume_mesh(v, &mesh, &m));
    fxs_volume_free(v);
    return mesh;
}

static void place_of(const fxs_mesh *m, uint32_t vertex, double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = m->origin[i] + m->step * m->places[3 * vertex + (uint32_t)i] / 65536;
}

static int compare_edges(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Counts sides of triangles that no other triangle has the other way round: of the border, or turned over. *branching
   gets the number of sides that two triangles have the same way round, and of second borders at a vertex. */
static size_t count_open(const fxs_mesh *m, size_t *branching)
{
    const size_t count = 3 * (size_t)m->triangle_count;
    uint64_t *there = malloc((count + 1) * sizeof *there), *back = malloc((count + 1) * sizeof *back);
    uint64_t last = UINT64_MAX;
    size_t open = 0;
    *branching = 0;
    for (size_t i = 0; i < count; i++) {
        const uint64_t a = m->triangles[i], b = m->triangles[i - i % 3 + (i + 1) % 3];
        there[i] = a << 32 | b;
        back[i] = b << 32 | a;
    }
    qsort(there, count, sizeof *there, compare_edges);
    qsort(back, count, sizeof *back, compare_edges);
    for (size_t i = 0, k = 0; i < count || k < count;) {
        const int order = i == count ? 1 : k == count ? -1 : compare_edges(&there[i], &back[k]);
        open += order != 0;
        *branching += i && order <= 0 && there[i] == there[i - 1];
        if (order < 0) {
            *branching += there[i] >> 32 == last;
            last = there[i] >> 32;
        }
        i += order <= 0;
        k += order >= 0;
    }
    free(there);
    free(back);
    return open / 2;
}

/* Counts the sides on the border of a mesh, which must be a manifold. */
static size_t open_edges(const fxs_mesh *m)
{
    size_t branching;
    const size_t open = count_open(m, &branching);
    CHECK(branching == 0);
    return open;
}

static double volume_of(const fxs_mesh *m)
{
    double sum = 0;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        double p[3][3];
        for (uint32_t k = 0; k < 3; k++)
            place_of(m, m->triangles[3 * i + k], p[k]);
        for (int k = 0; k < 3; k++)
            sum += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] - p[1][(k + 2) % 3] * p[2][(k + 1) % 3]) / 6;
    }
    return sum;
}

/* ---- Truth ------------------------------------------------------------------------------------------------------- */

/* Returns the distance from a point to the nearest vertex. */
static double distance_to_mesh(const fxs_mesh *m, const double p[3])
{
    double least = INFINITY;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        double at[3], square = 0;
        place_of(m, i, at);
        for (int k = 0; k < 3; k++)
            square += (at[k] - p[k]) * (at[k] - p[k]);
        least = fmin(least, square);
    }
    return sqrt(least);
}

/* A point of the surface, evenly spread: number i of n. */
static void sample(const surface *s, int i, int n, double at[3])
{
    double normal[3], area = 0, before = 0;
    const double part = (i + 0.5) / n, other = fmod(0.6180339887498949 * i, 1);
    if (!s->count) {
        point_on(s, i, n, at, normal);
        return;
    }
    for (int k = 0; k < s->count; k++)
        area += length_of(s->rectangles[k].u) * length_of(s->rectangles[k].v);
    for (int k = 0; k < s->count; k++) {
        const double own = length_of(s->rectangles[k].u) * length_of(s->rectangles[k].v) / area;
        if (part <= before + own || k == s->count - 1) {
            place_on(&s->rectangles[k], 2 * (part - before) / own - 1, 2 * other - 1, at);
            return;
        }
        before += own;
    }
}

/* Compares a mesh with the truth: the mean of the distances both ways (chamfer), and F at a hundredth of the size 2. */
static void compare(const surface *s, const fxs_mesh *m, double *chamfer, double *f)
{
    enum { SAMPLES = 400 };
    double there = 0, back = 0, precise = 0, recalled = 0, at[3];
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        place_of(m, i, at);
        const double d = distance_from(s, at);
        there += d / m->vertex_count;
        precise += (d < 0.02) / (double)m->vertex_count;
    }
    for (int i = 0; i < SAMPLES; i++) {
        sample(s, i, SAMPLES, at);
        const double d = distance_to_mesh(m, at);
        back += fmax(0, d - m->step / 2) / SAMPLES;     /* vertices are up to about half a voxel away */
        recalled += (d < 0.02 + m->step / 2) / (double)SAMPLES;
    }
    *chamfer = (there + back) / 2;
    *f = 2 * precise * recalled / (precise + recalled);
}

static void test_truth(surface *s)
{
    static drawn views[VIEWS_MOST];
    const double (*box)[3] = s->ring > 0 ? wide : cube;
    const uint32_t count = draw_all(s, views, box, 192);
    for (int i = 0; i < 2 && count; i++) {
        double chamfer, f;
        fxs_volume_options o = options_for(box, 64u << i);
        o.is_cave = s->is_within;
        fxs_mesh *mesh = mesh_of(views, count, &o, 0);
        if (!mesh)
            break;
        compare(s, mesh, &chamfer, &f);
        printf("  %s, %u voxels: %u triangles, chamfer %.5f, F %.4f, open edges %zu\n", s->name, o.resolution,
               mesh->triangle_count, chamfer, f, open_edges(mesh));
        CHECK(chamfer <= s->chamfer[i]);
        CHECK(f >= s->f[i]);
        fxs_mesh_free(mesh);
        o.closed = 1;
        mesh = mesh_of(views, count, &o, 0);
        CHECK(mesh && open_edges(mesh) == 0);
        fxs_mesh_free(mesh);
    }
    free_drawn(views, count);
}

static void test_surfaces(void)
{
    static surface sphere = {.name = "sphere", .sphere = 1, .chamfer = {0.0019, 0.0011}, .f = {0.999, 0.999}};
    static surface ring = {.name = "torus", .ring = 1, .chamfer = {0.0032, 0.0018}, .f = {0.999, 0.999}};
    static surface plate = {.name = "plate", .chamfer = {0.0025, 0.0009}, .f = {0.999, 0.999}};
    static surface frame = {.name = "box with a hole", .chamfer = {0.0022, 0.0012}, .f = {0.998, 0.998}};
    static surface room = {.name = "room from within", .is_within = 1, .chamfer = {0.0022, 0.002}, .f = {0.985, 0.98}};
    add_box(&plate, (double[]){-1, -1, -0.06}, (double[]){1, 1, 0.06}, 0);
    add_frame(&frame);
    add_box(&room, (double[]){-1, -0.7, -1}, (double[]){1, 0.7, 1}, 0);
    add_box(&room, (double[]){0.2, 0.2, 0.3}, (double[]){0.6, 0.7, 0.7}, 8);
    surface *const all[] = {&sphere, &ring, &plate, &frame, &room};
    for (int i = 0; i < 5; i++)
        RUN_AS(all[i]->name, test_truth(all[i]));
}

/* ---- One sphere -------------------------------------------------------------------------------------------------- */

static drawn ball[VIEWS_MOST];
static uint32_t ball_count;

static int same_mesh(const fxs_mesh *a, const fxs_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           !memcmp(a->places, b->places, 12 * (size_t)a->vertex_count) &&
           !memcmp(a->colours, b->colours, 4 * (size_t)a->vertex_count) &&
           !memcmp(a->triangles, b->triangles, 12 * (size_t)a->triangle_count);
}

static void test_order(void)
{
    fxs_volume_options o = options_for(cube, 96);
    fxs_mesh *one = mesh_of(ball, ball_count, &o, 0);
    o.workers.run = backwards;
    fxs_mesh *other = mesh_of(ball, ball_count, &o, 1);
    CHECK(one && other && same_mesh(one, other));
    CHECK(one->triangle_count > 10000);
    fxs_mesh_free(one);
    fxs_mesh_free(other);
}

static void test_colours(void)
{
    const fxs_volume_options o = options_for(cube, 64);
    fxs_mesh *m = mesh_of(ball, ball_count, &o, 0);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        double at[3];
        place_of(m, i, at);
        const uint8_t *c = m->colours + 4 * i;
        CHECK(c[3] == 255);
        if (fabs(at[0]) > 0.15)
            wrong += abs(c[0] - (at[0] > 0 ? 230 : 25)) > 6 || abs(c[1] - 64) > 4;
    }
    CHECK(wrong == 0);
    fxs_mesh_free(m);
}

static void test_decimate(void)
{
    fxs_volume_options o = options_for(cube, 96);
    o.closed = 1;
    fxs_mesh *m = mesh_of(ball, ball_count, &o, 0);
    fxs_message why;
    const double before = volume_of(m);
    const surface sphere = {.sphere = 1};
    double worst = 0, at[3];
    CHECK(open_edges(m) == 0);
    CHECK(fabs(before / (4 * PI / 3) - 1) < 0.01);
    CHECK(!fxs_mesh_decimate(m, 1000, &why));
    CHECK(m->triangle_count <= 1000 && m->triangle_count >= 998);
    CHECK(m->vertex_count == m->triangle_count / 2 + 2);
    CHECK(open_edges(m) == 0);
    CHECK(fabs(volume_of(m) / before - 1) < 0.01);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        place_of(m, i, at);
        worst = fmax(worst, distance_from(&sphere, at));
    }
    printf("  1000 triangles: farthest vertex %.5f from the sphere\n", worst);
    CHECK(worst < 0.015);
    fxs_mesh_free(m);
}

static void test_parts(void)
{
    const fxs_volume_options o = options_for(cube, 64);
    fxs_mesh *m = mesh_of(ball, ball_count, &o, 0);
    fxs_message why;
    uint32_t parts = 0;
    const uint32_t all = m->triangle_count;
    CHECK(!fxs_mesh_drop_parts(m, all / 2, &parts, &why));
    CHECK(parts == 1 && m->triangle_count > all / 2);
    CHECK(!fxs_mesh_drop_parts(m, m->triangle_count + 1, &parts, &why));
    CHECK(parts == 0 && m->triangle_count == 0 && m->vertex_count == 0);
    fxs_mesh_free(m);
}

/* ---- Random depths ----------------------------------------------------------------------------------------------- */

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* Random depths have every case of marching cubes, bricks at the sides of the box, and cells that no view sees. A
   closed mesh has no open edge. */
static void test_random(void)
{
    enum { SIZE = 48, COUNT = 12 };
    static drawn views[COUNT];
    fxs_view of_box[COUNT];
    fxs_message m;
    uint32_t state = 7;
    for (int run = 0; run < 4; run++) {
        CHECK(!fxs_views_around(of_box, COUNT, cube[0], cube[1], SIZE, &m));
        for (int i = 0; i < COUNT; i++) {
            views[i].view = of_box[i];
            views[i].depths = malloc(4 * SIZE * SIZE);
            views[i].colours = calloc(SIZE * SIZE, 4);
            for (int k = 0; k < SIZE * SIZE; k++)
                views[i].depths[k] = next_random(&state) % 8 ? (3u << 24) + next_random(&state) * 4 : FXS_NOTHING;
        }
        fxs_volume_options o = options_for(cube, 48);
        o.closed = 1;
        o.is_cave = run & 1;
        o.least_views = run / 2 ? 5 : 1;
        fxs_mesh *mesh = mesh_of(views, COUNT, &o, 0);
        CHECK(mesh && mesh->triangle_count > 1000 && open_edges(mesh) == 0);
        CHECK(!fxs_mesh_decimate(mesh, 5000, &m) && open_edges(mesh) == 0);
        fxs_mesh_free(mesh);
        o.closed = 0;
        o.least_views = 1;
        mesh = mesh_of(views, COUNT, &o, 0);
        CHECK(mesh && open_edges(mesh) > 30);
        CHECK(!fxs_mesh_decimate(mesh, 200, &m) && open_edges(mesh) > 10);
        fxs_mesh_free(mesh);
        free_drawn(views, COUNT);
        memset(views, 0, sizeof views);
    }
}

/* ---- Unbounded --------------------------------------------------------------------------------------------------- */

/* A ground of radius 10 at y = 0.9, a dome above it, and a ball in the box of the views. Far discs are larger. */
enum { GROUND = 6000, DOME = 1500, BALL = 900 };
static const double far = 10, ground = 0.9, ball_at[3] = {0.45, 0.55, 0.1}, ball_radius = 0.25;

static void far_point(int i, double at[3], double normal[3], double *spacing)
{
    const double turn = 2 * PI * 0.6180339887498949 * i;
    const int part = i < GROUND ? 0 : i < GROUND + DOME ? 1 : 2, n = part == 1 ? 2 * DOME : BALL;
    const double z = 1 - (2 * (i - (part == 1 ? GROUND : GROUND + DOME)) + 1.0) / n, side = sqrt(fmax(0, 1 - z * z));
    const double r = 0.05 * pow(far / 0.05, (i + 0.5) / GROUND);
    const double round[3] = {side * cos(turn), -z, side * sin(turn)}, down[3] = {0, 1, 0};
    *spacing = part == 0 ? fmax(0.09 * r, 0.02) : part == 1 ? 0.07 * far : 0.03;
    memcpy(normal, part ? round : down, sizeof round);
    at[0] = r * cos(turn);
    at[1] = ground;
    at[2] = r * sin(turn);
    for (int k = 0; k < 3 && part; k++)
        at[k] = part == 1 ? far * round[k] + ground * down[k] : ball_at[k] + ball_radius * round[k];
}

static double distance_from_far(const double p[3])
{
    const double r = hypot(p[0], p[2]), up = p[1] - ground;
    const double of_ball = hypot(hypot(p[0] - ball_at[0], p[1] - ball_at[1]), p[2] - ball_at[2]) - ball_radius;
    return fmin(fmin(fabs(of_ball), fabs(hypot(r, up) - far)), hypot(fmax(0, r - far), up));
}

/* Returns the least |t - 1| of the places t p where the ray to p meets the mesh; 1: it meets none. */
static double miss_along(const fxs_mesh *m, const double p[3])
{
    double least = 1;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        double v[3][3], sides[3], volume = 0;
        for (uint32_t k = 0; k < 3; k++)
            place_of(m, m->triangles[3 * i + k], v[k]);
        for (int k = 0; k < 3; k++) {
            const double *a = v[(k + 1) % 3], *b = v[(k + 2) % 3];
            sides[k] = p[0] * (a[1] * b[2] - a[2] * b[1]) + p[1] * (a[2] * b[0] - a[0] * b[2]) +
                       p[2] * (a[0] * b[1] - a[1] * b[0]);
            volume += v[0][k] * (v[1][(k + 1) % 3] * v[2][(k + 2) % 3] - v[1][(k + 2) % 3] * v[2][(k + 1) % 3]);
        }
        if ((sides[0] >= 0) == (sides[1] >= 0) && (sides[1] >= 0) == (sides[2] >= 0))
            least = fmin(least, fabs(volume / (sides[0] + sides[1] + sides[2]) - 1));
    }
    return least;
}

static fxs_opened *open_far(void)
{
    char path[] = "/tmp/fixsplat-mesh-XXXXXX";
    fxs_scene_writer *writer;
    fxs_opened *opened = 0;
    fxs_message m;
    double at[3], normal[3], spacing;
    const int descriptor = mkstemp(path);
    if (!CHECK(descriptor >= 0))
        return 0;
    close(descriptor);
    if (CHECK(!open_writer("ply", path, GROUND + DOME + BALL, 0, 0, &writer, &m))) {
        for (int i = 0; i < GROUND + DOME + BALL; i++) {
            far_point(i, at, normal, &spacing);
            put_disc(writer, at, normal, 0.5, spacing);
        }
        CHECK(!close_writer(writer, &m));
        CHECK(!fxs_open(path, 0, &opened, &m));
    }
    unlink(path);
    return opened;
}

/* Compares the mesh with the truth, relative to the distance from the middle of the box. */
static void compare_far(const fxs_mesh *m)
{
    enum { SAMPLES = 200 };
    double there = 0, back = 0, at[3], normal[3], spacing, reach = 0;
    int count = 0, lost = 0;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        place_of(m, i, at);
        there += distance_from_far(at) / length_of(at) / m->vertex_count;
        reach = fmax(reach, length_of(at));
    }
    for (int i = 0; i < SAMPLES; i++) {
        far_point((int)((i + 0.5) * (GROUND + DOME + BALL) / SAMPLES), at, normal, &spacing);
        const double along = at[0] * normal[0] + at[1] * normal[1] + at[2] * normal[2];
        if (i * (GROUND + DOME + BALL) >= SAMPLES * (GROUND + DOME) && along > 0)
            continue;                       /* no view shows all of the ball's far side */
        const double miss = miss_along(m, at);
        back += miss * fabs(along) / length_of(at);
        lost += miss == 1;
        count++;
    }
    printf("  unbounded: %u triangles up to %.1f, relative errors %.5f and %.5f, lost %d of %d\n", m->triangle_count,
           reach, there, back / count, lost, count);
    CHECK(reach > far - 0.2 && reach < far + 0.5);
    CHECK(there < 0.005 && back < 0.005 * count && lost == 0);
}

/* Contracted places expand to places that are contracted to them again, in the order of their distance. */
static void test_contract(void)
{
    uint32_t state = 3;
    for (int64_t half = 8 << 16; half <= 1024 << 16; half *= 2)
        for (int i = 0; i < 2000; i++) {
            int64_t from[3], at[3], norm = 0, worst = 0;
            for (int k = 0; k < 3; k++) {
                from[k] = at[k] = (int64_t)((next_random(&state) / 8388608.0 - 1) * (double)half * 1.95);
                norm = llabs(at[k]) > norm ? llabs(at[k]) : norm;
            }
            const int64_t distance = fxs_expand(at, half);
            const double h = (double)half, true_distance = norm < half ? h : h * h / (2 * h - (double)norm);
            CHECK(fabs((double)distance - true_distance) <= 0.5);
            fxs_contract(at, half);
            for (int k = 0; k < 3; k++)
                worst = llabs(at[k] - from[k]) > worst ? llabs(at[k] - from[k]) : worst;
            CHECK(worst <= (norm > half));
        }
}

static void test_unbounded(void)
{
    static drawn views[VIEWS_MOST];
    fxs_view of_box[VIEWS_MOST];
    fxs_object object;
    fxs_message m;
    fxs_opened *opened = open_far();
    fxs_volume_options o = options_for((const double[2][3]){{-1, -1, -1}, {1, 1, 1}}, 96);
    if (!opened)
        return;
    fxs_object_init(&object, opened->scene);
    CHECK(!fxs_views_within(of_box, o.low, o.high, 256, &m));
    for (uint32_t i = 0; i < FXS_VIEWS_WITHIN; i++) {
        views[i].view = of_box[i];
        draw(opened, &object, &views[i]);
    }
    o.is_unbounded = o.is_cave = 1;
    fxs_mesh *mesh = mesh_of(views, FXS_VIEWS_WITHIN, &o, 0);
    if (CHECK(mesh)) {
        fxs_mesh_write_options write;
        fxs_mesh_write_options_init(&write);
        CHECK(fxs_mesh_write("nowhere.ply", mesh, &write, &m) == FXS_ERR_ARGUMENT);
        fxs_mesh_expand(mesh);
        compare_far(mesh);
    }
    fxs_mesh_free(mesh);
    free_drawn(views, FXS_VIEWS_WITHIN);
    fxs_close(opened);
}

/* ---- Bad arguments ----------------------------------------------------------------------------------------------- */

static int make(fxs_volume_options o, fxs_message *m)
{
    fxs_volume *v;
    const int error = fxs_volume_make(&v, &o, m);
    CHECK(!error == (v != 0));
    fxs_volume_free(v);
    return error;
}

static void test_arguments(void)
{
    fxs_volume_options o = options_for(cube, 64);
    fxs_view views[2];
    fxs_message m;
    CHECK(make(o, &m) == 0);
    o.resolution = 15;
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    o.resolution = FXS_VOLUME_RESOLUTION + 1;
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    o = options_for(cube, 64);
    o.truncation = 0.5;
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    o = options_for(cube, 64);
    o.high[1] = -2;
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    o.high[1] = NAN;
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    memcpy(o.high, o.low, sizeof o.high);
    CHECK(make(o, &m) == FXS_ERR_ARGUMENT);
    CHECK(fxs_views_around(views, 2, cube[1], cube[0], 64, &m) == FXS_ERR_ARGUMENT);
    CHECK(fxs_views_around(views, 2, cube[0], cube[1], 0, &m) == FXS_ERR_ARGUMENT);
}

/* A limit that is too low is refused with a size that is enough. */
static void test_memory(void)
{
    fxs_volume_options o = options_for(cube, 64);
    fxs_volume_size size;
    fxs_volume *v;
    fxs_message m;
    for (int i = 0; i < 2; i++) {
        o.max_memory = i ? m.bytes_needed : 100000;
        if (!CHECK(!fxs_volume_make(&v, &o, &m)))
            return;
        CHECK(!pass(v, ball, ball_count, 0, fxs_volume_mark, &m));
        CHECK(fxs_volume_reserve(v, &size, &m) == (i ? 0 : FXS_ERR_MEMORY));
        CHECK(size.bytes == (i ? o.max_memory : m.bytes_needed) && size.bricks > 100);
        fxs_volume_free(v);
    }
    o.max_memory = 1000;
    CHECK(make(o, &m) == FXS_ERR_MEMORY && m.bytes_needed > 1000);
}

int main(void)
{
    static const surface sphere = {.sphere = 1};
    test_surfaces();
    ball_count = draw_all(&sphere, ball, cube, 160);
    RUN(test_order);
    RUN(test_colours);
    RUN(test_decimate);
    RUN(test_parts);
    RUN(test_memory);
    free_drawn(ball, ball_count);
    RUN(test_random);
    RUN(test_contract);
    RUN(test_unbounded);
    RUN(test_arguments);
    return check_report();
}
