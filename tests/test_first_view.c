/* The first view of a scene without cameras: upright however the scene is turned, with something to see in it, and the
 * same by all kernels and any number of threads. */
#include <math.h>
#include <string.h>

#include <fixsplat/kernels.h>
#include <fixsplat/pool.h>
#include <fixsplat/renderer.h>
#include "check.h"
#include "procedural_scene.h"
#include "src/camera/first_view.h"

enum { COUNT = 30000, WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };

static const char *const names[] = {"knot", "mirrors", "discs", "haze", "site", "landscape", "meadow"};
enum { NAMES = sizeof names / sizeof *names };

/* Rotations, by rows: as it is, so that z is up, upside down, and leaning by 20 degrees. */
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

/* The scene turned, with its box, and up in it. */
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

/* The part of the picture that is covered, and that which one Gaussian takes. */
static void look(const turned *t, const fxs_file_view *view, double *covered, double *largest)
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

static void check_view(const turned *t, const char *name, int turning)
{
    fxs_file_view view;
    double up[3], covered, largest;
    if (!CHECK(!fxs_first_view(&t->object, 1, t->low, t->high, 50, WIDTH, HEIGHT, &view, up, &why)))
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

/* A leaning scene is set upright where it has a ground; haze and mountains hide theirs. */
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
    static const fxs_first_choice wanted = {{0, 0, 1}, {-0.82, 0, 0.57}, 1};
    turned t;
    fxs_first_choice first[4];
    fxs_pool *pool = fxs_pool_create(3);
    if (!CHECK(pool != NULL) || !CHECK(!make(&t, "site")))
        return;
    turn(&t, turns[1]);
    for (int i = 0; i < 4; i++) {
        const fxs_config config = {.run = fxs_pool_run, .pool = pool, .threads = 3};
        fxs_context context;
        fxs_init(&context, i & 1 ? &config : NULL);
        if (i & 2)
            fxs_kernels_choose(&context.kernels, fxs_cpu_detect());
        CHECK(!fxs_first_view_choose(&first[i], &context, &t.object, 1, t.low, t.high, NULL, &why));
        CHECK(!memcmp(&first[i], &wanted, sizeof wanted));
    }
    if (memcmp(first, &wanted, sizeof wanted))
        printf("  {{%.17g, %.17g, %.17g}, {%.17g, %.17g, %.17g}, %.17g}\n", first->up[0], first->up[1], first->up[2],
               first->from[0], first->from[1], first->from[2], first->part);
    fxs_pool_destroy(pool);
    fxs_packed_scene_free(&t.packed);
}

/* What is said to be up is, wherever the ground lies; where nothing is said, up is found. */
static void upright_as_told(void)
{
    static const double ups[][3] = {{3, -4, 0}, {0.1, 0.2, -0.7}, {0, 0, 0}};
    turned t;
    fxs_file_view view, found;
    double up[3];
    if (!CHECK(!make(&t, "site")))
        return;
    turn(&t, turns[1]);
    CHECK(!fxs_first_view(&t.object, 1, t.low, t.high, 50, WIDTH, HEIGHT, &found, up, &why));
    for (int i = 0; i < 3; i++) {
        const double *u = ups[i], *r = view.rotation;
        CHECK(!fxs_first_view_upright(&t.object, 1, t.low, t.high, u, 50, WIDTH, HEIGHT, &view, &why));
        CHECK(fabs(r[0] * u[0] + r[1] * u[1] + r[2] * u[2]) < 1e-12);
        CHECK(i == 2 || r[3] * u[0] + r[4] * u[1] + r[5] * u[2] < -0.3);
        CHECK(!memcmp(view.rotation, found.rotation, sizeof view.rotation) == (i == 2));
    }
    fxs_packed_scene_free(&t.packed);
}

/* Objects that are hidden, cropped away or far off the box, and no objects at all. */
static void nothing_to_see(void)
{
    static const int64_t far[3] = {(int64_t)90 << 32, 0, 0};
    const fxs_crop crop = {{far[0], far[0], far[0]}, {far[0], far[0], far[0]}, 0};
    const double point[3] = {1, 2, 3};
    fxs_file_view view;
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
        CHECK(!fxs_first_view(&t.object, i > 0, t.low, t.high, 50, WIDTH, HEIGHT, &view, up, &why));
        CHECK(up[1] == -1 || i == 3);
    }
    CHECK(!fxs_first_view(&t.object, 1, point, point, 50, WIDTH, HEIGHT, &view, up, &why));
    CHECK(fxs_first_view(&t.object, 1, t.low, t.high, 50, 0, HEIGHT, &view, up, &why) == FXS_ERR_SIZE);
    CHECK(fxs_first_view(&t.object, 1, t.low, t.high, 171, WIDTH, HEIGHT, &view, up, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_first_view(NULL, 1, t.low, t.high, 50, WIDTH, HEIGHT, &view, up, &why) == FXS_ERR_ARGUMENT);
    fxs_packed_scene_free(&t.packed);
}

int main(void)
{
    RUN(upright_with_something_to_see);
    RUN(the_same_everywhere);
    RUN(upright_as_told);
    RUN(nothing_to_see);
    return check_report();
}
