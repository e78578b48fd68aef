/* Tests the first view of a scene without cameras. The view must be upright for any rotation of the scene and must
   see Gaussians. */
#include <math.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/renderer.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include "check.h"
#include "procedural_scene.h"
#include "src/camera/first_view.h"
#include "fastest.h"

enum { COUNT = 30000, WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };

static const char *const names[] = {"knot", "mirrors", "discs", "haze", "site", "landscape", "meadow"};
enum { NAMES = sizeof names / sizeof *names };

/* Rotation matrices to apply to a scene with y down: no rotation, z up, upside down, leaning by 20 degrees. */
static const double turns[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                  {1, 0, 0, 0, 0, 1, 0, -1, 0},
                                  {1, 0, 0, 0, -1, 0, 0, 0, -1},
                                  {0.9396926, -0.3420201, 0, 0.3420201, 0.9396926, 0, 0, 0, 1}};
enum { TURNS = sizeof turns / sizeof *turns, LEANING = 3 };

typedef struct turned {
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_scene scene;
    fxs_object object;
    double low[3], high[3], up[3];
} turned;

static fxs_message why;

static int make(turned *t, const char *name)
{
    return procedural_scene_make(name, COUNT, 0, &t->packed, &t->report, &why) ||
           fxs_scene_open(&t->scene, t->packed.data, t->packed.bytes);
}

static void turn(turned *t, const double r[9])
{
    fxs_object_init(&t->object, &t->scene);
    for (int i = 0; i < 3; i++) {
        t->up[i] = -r[3 * i + 1];
        t->low[i] = t->high[i] = 0;
        for (int k = 0; k < 3; k++) {
            const double a = r[3 * i + k] * t->report.inner_low[k], b = r[3 * i + k] * t->report.inner_high[k];
            t->object.rotation_q30[3 * i + k] = (int32_t)floor(ldexp(r[3 * i + k], 30) + 0.5);
            t->low[i] += fmin(a, b);
            t->high[i] += fmax(a, b);
        }
    }
}

static double along(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Renders a view. Sets *covered to the share of the picture that is covered. Sets *largest to the largest share that
   one Gaussian covers. */
static void look(const turned *t, const fxs_view *view, double *covered, double *largest)
{
    static unsigned char coverage[PIXELS];
    static fxs_id ids[PIXELS];
    static uint32_t pixels[COUNT];
    fxs_renderer *renderer = NULL;
    fxs_request request;
    *covered = *largest = 0;
    memset(pixels, 0, sizeof pixels);
    fxs_request_init(&request, &t->object, 1);
    request.targets[0].coverage = (fxs_image){coverage, WIDTH};
    request.targets[0].id = (fxs_image){ids, sizeof *ids * WIDTH};
    if (!CHECK(!fxs_renderer_create("cpu", NULL, &renderer, &why)))
        return;
    if (CHECK(!fxs_camera_from_view(&request.cameras[0], view, &why)) &&
        CHECK(!fxs_renderer_render(renderer, &request, NULL, &why)))
        for (int i = 0; i < PIXELS; i++) {
            *covered += coverage[i] / 255.0 / PIXELS;
            if (ids[i].gaussian < COUNT)
                *largest = fmax(*largest, (double)++pixels[ids[i].gaussian] / PIXELS);
        }
    fxs_renderer_destroy(renderer);
}

static int first_view_upright(const fxs_object *objects, uint32_t count, const double low[3], const double high[3],
                              const double known[3], double fov, int width, fxs_view *view)
{
    double up[3] = {known[0], known[1], known[2]};
    double box[2][3] = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    return fxs_first_view(objects, count, box, up, &(fxs_picture){fov, width, HEIGHT}, view, &why);
}

static int first_view(const fxs_object *objects, uint32_t count, const double low[3], const double high[3], double fov,
                      int width, fxs_view *view, double up[3])
{
    double box[2][3] = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    memset(up, 0, 3 * sizeof *up);
    return fxs_first_view(objects, count, box, up, &(fxs_picture){fov, width, HEIGHT}, view, &why);
}

static void check_view(const turned *t, const char *name, int turning)
{
    fxs_view view;
    double up[3], covered, largest;
    if (!CHECK(!first_view(&t->object, 1, t->low, t->high, 50, WIDTH, &view, up)))
        return;
    look(t, &view, &covered, &largest);
    const double upright = acos(fmin(along(up, t->up), 1)) * 57.29577951308232;
    int good = CHECK(upright < 10);
    good = CHECK(-along(view.rotation + 3, t->up) > 0.7) && good;
    good = CHECK(covered > 0.15) && good;
    good = CHECK(largest < 0.1) && good;
    if (!good)
        printf("  %s, turn %d: %.1f degrees from up, %.2f covered, %.2f by one Gaussian\n", name, turning, upright,
               covered, largest);
}

/* Checks the first view of each procedural scene in several rotations. A leaning scene is not levelled if haze or
   mountains hide the ground. */
static void upright_with_something_to_see(void)
{
    for (int i = 0; i < NAMES; i++) {
        turned t;
        if (!CHECK(!make(&t, names[i])))
            continue;
        for (int k = 0; k < (i < 3 ? TURNS : LEANING); k++) {
            turn(&t, turns[k]);
            check_view(&t, names[i], k);
        }
        fxs_packed_scene_free(&t.packed);
    }
}

static void the_same_everywhere(void)
{
    fxs_first_choice wanted = {{0, 0, 1}, {-0.82, 0, 0.57}, 1, {0, 0, 0}, {0, 0, 0}}, first[4];
    turned t;
    fxs_pool *pool = fxs_pool_create(3);
    if (!CHECK(pool != NULL) || !CHECK(!make(&t, "site")))
        return;
    turn(&t, turns[1]);
    memcpy(wanted.low, t.low, sizeof t.low);
    memcpy(wanted.high, t.high, sizeof t.high);
    for (int i = 0; i < 4; i++) {
        const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                                   .workers.count = 3};
        fxs_context context;
        fxs_context_init(&context, i & 1 ? &config : NULL);
        if (i & 2)
            context.config.kernels = kernels_for(fxs_cpu_detect());
        CHECK(!fxs_first_view_choose(&first[i], &context, &t.object, 1, t.low, t.high, NULL, &why));
        CHECK(!memcmp(&first[i], &wanted, sizeof wanted));
    }
    if (memcmp(first, &wanted, sizeof wanted))
        printf("  {{%.17g, %.17g, %.17g}, {%.17g, %.17g, %.17g}, %.17g}\n", first->up[0], first->up[1], first->up[2],
               first->from[0], first->from[1], first->from[2], first->part);
    fxs_pool_destroy(pool);
    fxs_packed_scene_free(&t.packed);
}

static fxs_gaussian laid[COUNT];
static size_t laid_count;
static uint64_t state;

static double uniform(double low, double high)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static void find_direction(double d[3])
{
    const double angle = uniform(0, 6.283185307179586), height = uniform(-1, 1), out = sqrt(1 - height * height);
    d[1] = height;
    d[0] = out * cos(angle);
    d[2] = out * sin(angle);
}

static void put(const double p[3], const double normal[3], double size)
{
    const double length = sqrt(along(normal, normal)), n[3] = {normal[0] / length, normal[1] / length,
                                                               normal[2] / length};
    const int black = ((int)floor(4 * p[0]) + (int)floor(4 * p[1]) + (int)floor(4 * p[2])) & 1;
    fxs_gaussian *g = &laid[laid_count++];
    memset(g, 0, sizeof *g);
    for (int k = 0; k < 3; k++) {
        g->position[k] = (float)p[k];
        g->scale[k] = (float)(log(size * uniform(0.7, 1.4)) - 2 * (k == 2));
        g->dc[k] = (float)(black ? uniform(-1, 0) : uniform(0, 1));
    }
    g->rotation[0] = (float)(1 + fabs(n[2]));
    g->rotation[1] = (float)(n[2] < 0 ? n[1] : -n[1]);
    g->rotation[2] = (float)(n[2] < 0 ? -n[0] : n[0]);
    g->opacity = 2;
}

static void lay_panel(const double o[3], const double u[3], const double v[3], int count)
{
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double size = 0.8 * sqrt(sqrt(along(n, n)) / count);
    for (int i = 0; i < count; i++) {
        const double a = uniform(0, 1), b = uniform(0, 1);
        const double p[3] = {o[0] + a * u[0] + b * v[0], o[1] + a * u[1] + b * v[1], o[2] + a * u[2] + b * v[2]};
        put(p, n, size);
    }
}

static void lay_ball(const double middle[3], const double radii[3], int count)
{
    const double size = 2.8 * sqrt((radii[0] * radii[1] + radii[1] * radii[2] + radii[2] * radii[0]) / 3 / count);
    for (int i = 0; i < count; i++) {
        double d[3], p[3], n[3];
        find_direction(d);
        for (int k = 0; k < 3; k++) {
            p[k] = middle[k] + radii[k] * d[k];
            n[k] = d[k] / radii[k];
        }
        put(p, n, size);
    }
}

static void lay_box(const double low[3], const double high[3], int count)
{
    const double x[3] = {high[0] - low[0], 0, 0}, y[3] = {0, high[1] - low[1], 0}, z[3] = {0, 0, high[2] - low[2]};
    const double right[3] = {high[0], low[1], low[2]}, back[3] = {low[0], low[1], high[2]};
    lay_panel(low, x, z, count / 5);
    lay_panel(low, x, y, count / 5);
    lay_panel(back, x, y, count / 5);
    lay_panel(low, z, y, count / 5);
    lay_panel(right, z, y, count / 5);
}

static void lay_ground(double reach, int count)
{
    static const double normal[3] = {0, 1, 0};
    for (int i = 0; i < count; i++) {
        const double r = 0.5 * exp(uniform(0, log(2 * reach))), angle = uniform(0, 6.283185307179586);
        const double p[3] = {r * cos(angle), 0, r * sin(angle)};
        put(p, normal, 0.07 * r);
    }
}

static void lay_ring(double radius, int trees, int count)
{
    for (int i = 0; i < trees; i++) {
        const double angle = 6.283185307179586 * i / trees, p[3] = {radius * cos(angle), -3, radius * sin(angle)};
        lay_ball(p, (double[3]){2, 3, 2}, count / trees);
    }
}

static void lay_sky(double nearest, double farthest, int count)
{
    for (int i = 0; i < count; i++) {
        const double r = i % 2 ? farthest : nearest * exp(uniform(0, log(farthest / nearest)));
        double d[3], p[3];
        find_direction(d);
        for (int k = 0; k < 3; k++)
            p[k] = r * (k == 1 ? -fabs(d[k]) : d[k]);
        put(p, d, 0.06 * r);
    }
}

static void lay_room(void)
{
    static const double low[3] = {-2.5, -2.6, -2}, high[3] = {2.5, 0, 2}, x[3] = {5, 0, 0}, z[3] = {0, 0, 4};
    lay_box(low, high, 12000);
    lay_panel((double[3]){-2.5, 0, -2}, x, z, 4000);
    lay_box((double[3]){-0.8, -0.75, -0.5}, (double[3]){0.8, -0.6, 0.5}, 4000);
    lay_box((double[3]){-2.4, -0.8, -1}, (double[3]){-1.6, 0, 1}, 4000);
    lay_ball((double[3]){1.8, -0.9, 1}, (double[3]){0.25, 0.9, 0.25}, 2000);
}

static void lay_mess(void)
{
    lay_room();
    for (int i = 0; i < 3000; i++) {
        double d[3], p[3];
        find_direction(d);
        for (int k = 0; k < 3; k++)
            p[k] = uniform(3.6, 7) * d[k] - 1.3 * (k == 1);
        put(p, d, 0.15);
    }
}

static void lay_outdoors(double sky)
{
    lay_ground(60, 8000);
    lay_box((double[3]){-0.6, -1, -0.6}, (double[3]){0.6, 0, 0.6}, 3000);
    lay_ball((double[3]){0, -2, 0}, (double[3]){0.5, 1, 0.5}, 4000);
    lay_ring(12, 10, 5000);
    lay_sky(80, sky, 4000);
}

static void lay_sky_near(void)
{
    lay_outdoors(35000);
}

static void lay_sky_far(void)
{
    lay_outdoors(255000);
}

static void lay_figure(void)
{
    for (int side = -1; side <= 1; side += 2) {
        lay_ball((double[3]){0.18 * side, -1.05, 0}, (double[3]){0.15, 1.05, 0.15}, 3000);
        lay_ball((double[3]){0.3 * side, -2.8, 0}, (double[3]){0.07, 0.7, 0.07}, 1500);
    }
    lay_ball((double[3]){0, -2.9, 0}, (double[3]){0.3, 0.9, 0.2}, 6000);
    lay_ball((double[3]){0, -4.1, 0}, (double[3]){0.25, 0.3, 0.25}, 2500);
}

static void lay_surroundings(void)
{
    lay_ground(40, 6000);
    lay_ring(14, 24, 18000);
    lay_sky(35, 400, 4000);
}

static void lay_wall(void)
{
    lay_panel((double[3]){-4, -2.5, 6}, (double[3]){8, 0, 0}, (double[3]){0, 4, 0}, 12000);
    lay_panel((double[3]){-4, 1.5, 3}, (double[3]){8, 0, 0}, (double[3]){0, 0, 3}, 3000);
    for (int i = -1; i < 2; i++)
        lay_ball((double[3]){2 * i, 0.2, 4.5}, (double[3]){0.5, 0.5, 0.5}, 2000);
}

static void lay_shelf(void)
{
    lay_panel((double[3]){-0.95, -1.5, -0.3}, (double[3]){1.9, 0, 0}, (double[3]){0, 3, 0}, 6000);
    for (int i = 0; i < 2; i++)
        lay_panel((double[3]){-0.95, 1.5 - i, -0.3}, (double[3]){1.9, 0, 0}, (double[3]){0, 0, 0.6}, 1200);
}

static void lay_sheet(void)
{
    lay_panel((double[3]){-2, -1, 0}, (double[3]){4, 0, 0}, (double[3]){0, 2, 0}, 9000);
    for (int i = -3; i < 4; i++)
        lay_ball((double[3]){i / 2.0, 0, -0.06}, (double[3]){0.2, 0.3, 0.05}, 500);
}

static const struct kind {
    const char *name;
    void (*lay)(void);
    double low[3], high[3];
    int within, turns;               /* turns: number of rotation matrices to try with the scene */
    double target[3];
} kinds[] = {
    {"room", lay_room, {-2.4, -2.5, -1.9}, {2.4, -0.3, 1.9}, 1, 2, {0, 0, 0}},
    {"room with a mess behind its walls", lay_mess, {-2.4, -2.5, -1.9}, {2.4, -0.3, 1.9}, 1, 2, {0, 0, 0}},
    {"sky at 35000", lay_sky_near, {-20, -15, -20}, {20, -0.3, 20}, 1, 2, {0, -1.5, 0}},
    {"sky at 255000", lay_sky_far, {-20, -15, -20}, {20, -0.3, 20}, 1, 2, {0, -1.5, 0}},
    {"figure", lay_figure, {-1, -5, -1}, {1, 0.5, 1}, 0, 1, {0, -2.2, 0}},
    {"surroundings", lay_surroundings, {-12, -10, -12}, {12, -0.3, 12}, 1, 2, {0, 0, 0}},
    {"wall", lay_wall, {-6, -5, -12}, {6, 3, 4}, 1, 1, {0, 0, 6}},
    {"shelf", lay_shelf, {-1, -2, -1}, {1, 2, 1}, 0, 1, {0, 0, 0}},
    {"sheet", lay_sheet, {-3, -3, -2.8}, {3, 3, 2.8}, 0, 1, {0, 0, 0}},
};

static long read_laid(void *unused, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)unused;
    memcpy(out, laid + first, capacity * sizeof *out);
    return (long)capacity;
}

static int make_kind(turned *t, const struct kind *kind)
{
    fxs_gaussian_source source = {0, 0, 0, read_laid, NULL, {0}};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    laid_count = 0;
    state = 1;
    kind->lay();
    source.count = laid_count;
    if (fxs_scene_file_open_gaussians(kind->name, &source, NULL, &file, &info, &why))
        return -1;
    const int error = fxs_pack(file, &info, &t->packed, &t->report, NULL, &why);
    fxs_scene_file_close(file);
    return error || fxs_scene_open(&t->scene, t->packed.data, t->packed.bytes);
}

static void check_kind(const turned *t, const struct kind *kind, const double r[9])
{
    fxs_view view;
    double up[3], eye[3], ahead[3], to[3];
    int within = 1;
    if (!CHECK(!first_view(&t->object, 1, t->low, t->high, 50, WIDTH, &view, up)))
        return;
    for (int i = 0; i < 3; i++) {
        eye[i] = ahead[i] = 0;
        for (int k = 0; k < 3; k++) {
            eye[i] += r[3 * k + i] * view.position[k];
            ahead[i] += r[3 * k + i] * view.rotation[6 + k];
        }
        within &= eye[i] > kind->low[i] && eye[i] < kind->high[i];
        to[i] = kind->target[i] - eye[i];
    }
    int good = CHECK(along(up, t->up) > 0.98);
    good = CHECK(within == kind->within) && good;
    good = CHECK(kind->target[1] == 0 || along(to, ahead) > 0.85 * sqrt(along(to, to))) && good;
    if (!good)
        printf("  %s, up %g %g %g: from %g %g %g to %g %g %g\n", kind->name, up[0], up[1], up[2], eye[0], eye[1],
               eye[2], ahead[0], ahead[1], ahead[2]);
}

static void from_where_cameras_were(void)
{
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        turned t;
        if (!CHECK(!make_kind(&t, &kinds[i])))
            continue;
        for (int k = 0; k < kinds[i].turns; k++) {
            turn(&t, turns[k]);
            check_kind(&t, &kinds[i], turns[k]);
        }
        fxs_packed_scene_free(&t.packed);
    }
}

static void upright_as_told(void)
{
    static const double ups[][3] = {{3, -4, 0}, {0.1, 0.2, -0.7}, {0, 0, 0}};
    turned t;
    fxs_view view, found;
    double up[3];
    if (!CHECK(!make(&t, "site")))
        return;
    turn(&t, turns[1]);
    CHECK(!first_view(&t.object, 1, t.low, t.high, 50, WIDTH, &found, up));
    for (int i = 0; i < 3; i++) {
        const double *u = ups[i], *r = view.rotation;
        CHECK(!first_view_upright(&t.object, 1, t.low, t.high, u, 50, WIDTH, &view));
        CHECK(fabs(r[0] * u[0] + r[1] * u[1] + r[2] * u[2]) < 1e-12);
        CHECK(i == 2 || r[3] * u[0] + r[4] * u[1] + r[5] * u[2] < -0.3);
        CHECK(!memcmp(view.rotation, found.rotation, sizeof view.rotation) == (i == 2));
    }
    fxs_packed_scene_free(&t.packed);
}

static void nothing_to_see(void)
{
    static const int64_t far[3] = {(int64_t)90 << 32, 0, 0};
    const fxs_crop crop = {{far[0], far[0], far[0]}, {far[0], far[0], far[0]}, 0};
    const double point[3] = {1, 2, 3};
    fxs_view view;
    double up[3];
    turned t;
    if (!CHECK(!make(&t, "knot")))
        return;
    for (int i = 0; i < 4; i++) {
        turn(&t, turns[0]);
        t.object.visible = i != 1;
        t.object.crops = &crop;
        t.object.crop_count = i == 2;
        memcpy(t.object.translation_q32, far, i == 3 ? sizeof far : 0);
        CHECK(!first_view(&t.object, i > 0, t.low, t.high, 50, WIDTH, &view, up));
        CHECK(up[1] == -1 || i == 3);
    }
    CHECK(!first_view(&t.object, 1, point, point, 50, WIDTH, &view, up));
    CHECK(first_view(&t.object, 1, t.low, t.high, 50, 0, &view, up) == FXS_ERR_SIZE);
    CHECK(first_view(&t.object, 1, t.low, t.high, 171, WIDTH, &view, up) == FXS_ERR_ARGUMENT);
    CHECK(first_view(NULL, 1, t.low, t.high, 50, WIDTH, &view, up) == FXS_ERR_ARGUMENT);
    fxs_packed_scene_free(&t.packed);
}

int main(void)
{
    RUN(upright_with_something_to_see);
    RUN(from_where_cameras_were);
    RUN(the_same_everywhere);
    RUN(upright_as_told);
    RUN(nothing_to_see);
    return check_report();
}
