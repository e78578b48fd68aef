/* Tests the renderer's stages on random packed scenes against a double-precision reference. Whole frames must equal
   a brute-force renderer with the same per-pixel formula. A splat is a projected Gaussian. A chunk is 256 Gaussians
   of a packed scene. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/core/frame.h"
#include "src/core/sort.h"
#include "src/core/sized.h"
#include "in_doubles.h"
#include "one_scene.h"
#include "packed_scene.h"
#include "splat_level.h"
#include "tile_lists.h"

enum { MAX_COUNT = 1024, MAX_SIDE = 2000, GUARD = 0xa5, GUARD_BYTES = 64 };

static uint64_t seed = 88172645463325252u;   /* state of the random generator xorshift64 (Marsaglia 2003) */

static uint32_t bits(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (uint32_t)(seed >> 16);
}

static int below(int n)
{
    return (int)(bits() % (uint32_t)n);
}

static double uniform(double low, double high)
{
    return low + (high - low) * bits() / 4294967296.0;
}

typedef struct recipe {
    double reach;   /* largest distance of Gaussian centres from the origin on each axis, in scene units */
    double sigma_low, sigma_high;   /* range of log2(sigma) of random Gaussians */
    int needle;   /* 1: Gaussians are needles, with one axis at sigma_high and two axes at sigma_low */
    int opacity_low, opacity_high;  /* range of the opacity codes of random Gaussians */
} recipe;

static const recipe ordinary = {1, -9, -3, 0, 1, 255};
static const recipe needles = {1, -10, 0, 1, 30, 255};
static const recipe long_needles = {4, -8, 6, 1, 30, 255};
static const recipe huge = {3, -2, 8, 0, 1, 60};
static const recipe tiny = {1, -20, -10, 0, 100, 255};
static const recipe scattered = {20, -8, 1, 0, 1, 255};
static const recipe *const recipes[] = {&ordinary, &needles, &long_needles, &huge, &tiny, &scattered};
enum { RECIPES = sizeof recipes / sizeof *recipes };


static void random_quaternion(double q[4])
{
    double norm;
    do {
        norm = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = uniform(-1, 1);
            norm += q[i] * q[i];
        }
    } while (norm > 1 || norm < 0.01);
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(norm);
}

static uint32_t rotation_word(uint32_t scale_word, uint32_t scale_step_q24)
{
    const int n = axis_bits_of_word(0, scale_word, scale_step_q24);
    uint32_t word;
    double axis[3][3];
    do
        word = bits();
    while (word_axes(axis, word, n) > 0.9999);
    return word;
}

static uint32_t scale_word(const recipe *r)
{
    uint32_t word = 0;
    for (int i = 0; i < 3; i++) {        /* scale codes: packing stores the longest axis of a Gaussian first */
        double code = r->needle ? (i == 0 ? 0 : 1023) : 1023 * sqrt(uniform(0, 1));
        word |= i < 2 ? (uint32_t)code << 10 * i : (uint32_t)code / 2 << 20;
    }
    return word;
}

static void fill_header(fxs_chunk *chunk, const recipe *r)
{
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = (int64_t)ldexp(-r->reach, 32);
        chunk->step_q32[i] = (uint32_t)ldexp(2 * r->reach / 65535, 32);
        chunk->colour_q16[i] = (int32_t)ldexp(uniform(-0.3, 0.1), 16);
        chunk->colour_step_q20[i] = (uint32_t)ldexp(uniform(0.5, 1.5) / 511, 20);
        chunk->sh_step_q19[i] = (uint16_t)ldexp(uniform(0, 0.5) / 127, 19);
    }
    chunk->scale_q16 = (int32_t)ldexp(r->sigma_high, 16);
    chunk->opacity_law = (uint16_t)(chunk->colour_q16[0] & 3);
    chunk->scale_step_q24 = (uint16_t)ldexp((r->sigma_high - r->sigma_low) / (1023 * 1023), 24);
}

static void fill_rows(unsigned char *rows, const fxs_chunk *header, const recipe *r, uint32_t chunk_bytes,
                      uint32_t used)
{
    uint16_t *position = (uint16_t *)(void *)(rows + FXS_ROW_POSITION);
    uint32_t *rotation = (uint32_t *)(void *)(rows + FXS_ROW_ROTATION);
    uint32_t *scale = (uint32_t *)(void *)(rows + FXS_ROW_SCALE);
    uint32_t *colour = (uint32_t *)(void *)(rows + FXS_ROW_COLOUR);
    for (uint32_t i = 0; i < used; i++) {
        for (uint32_t axis = 0; axis < 3; axis++)
            position[axis * FXS_CHUNK + i] = (uint16_t)bits();
        scale[i] = scale_word(r);
        rotation[i] = rotation_word(scale[i], header->scale_step_q24);
        uint32_t opacity = (uint32_t)(r->opacity_low + below(r->opacity_high - r->opacity_low + 1));
        colour[i] = (bits() & 0xffffff) | opacity << 24;
    }
    for (uint32_t i = FXS_ROW_SH; i < chunk_bytes; i++)
        rows[i] = (unsigned char)(below(255) - 127);
}

static void *allocate(size_t bytes, int fill)
{
    void *memory = check_aligned(bytes);
    if (!memory)
        abort();
    return memset(memory, fill, bytes);
}

static packed_scene make_scene(const recipe *r, uint32_t count, uint32_t degree, int antialiased)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, (int)degree, count, antialiased);
    for (uint32_t i = 0; i < s.header->chunk_count; i++) {
        uint32_t left = count - i * FXS_CHUNK;
        fill_header(&s.chunks[i], r);
        fill_rows(packed_scene_rows(&s, i), &s.chunks[i], r, s.header->chunk_bytes,
                  left < FXS_CHUNK ? left : FXS_CHUNK);
    }
    CHECK(packed_scene_finish(&s) == 0);
    return s;
}

static void random_rotation(double m[9])
{
    double q[4];
    random_quaternion(q);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    memcpy(m, r, sizeof r);
}

static fxs_camera make_camera(int width, int height, double distance)
{
    fxs_camera camera = {.width = width, .height = height};
    double rotation[9], focal = (width > height ? width : height) * uniform(0.5, 2);
    random_rotation(rotation);
    camera.fx_q12 = (int32_t)ldexp(focal, 12);
    camera.fy_q12 = (int32_t)ldexp(focal * uniform(0.7, 1.4), 12);
    camera.cx_q12 = (int32_t)ldexp(width * uniform(0.3, 0.7), 12);
    camera.cy_q12 = (int32_t)ldexp(height * uniform(0.3, 0.7), 12);
    for (int i = 0; i < 9; i++)
        camera.rotation_q30[i] = (int32_t)floor(ldexp(rotation[i], 30) + 0.5);
    for (int i = 0; i < 3; i++)
        camera.position_q32[i] = (int64_t)ldexp(-distance * rotation[6 + i] + uniform(-0.2, 0.2), 32);
    return camera;
}

static struct {
    fxs_stage_view view;
    fxs_splat splats[MAX_COUNT];
    fxs_bounds bounds[MAX_COUNT];
    uint32_t indices[MAX_COUNT], depths[MAX_COUNT], count;
    fxs_key keys[MAX_COUNT];       /* keys of the splats (projected Gaussians) in ascending order of depth */
} all;

static void sort_keys(void)
{
    for (uint32_t i = 0; i < all.count; i++) {
        uint32_t k = i;
        for (; k > 0 && all.keys[k - 1] >> 32 > all.depths[i]; k--)
            all.keys[k] = all.keys[k - 1];
        all.keys[k] = FXS_KEY(all.depths[i], i);
    }
}

static void project_chunks(const fxs_scene *scene)
{
    all.count = 0;
    for (uint32_t c = 0; c < scene->chunk_count; c++) {
        uint32_t at = all.count;
        int32_t n = fxs_project_c(&all.view, scene, c, all.splats + at, all.bounds + at, all.indices + at,
                                  all.depths + at);
        CHECK(n >= 0 && fxs_shade_c(&all.view, scene, c, all.indices + at, (uint32_t)n, all.splats + at) == 0);
        all.count += (uint32_t)n;
    }
    sort_keys();
}

static void project_all(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options)
{
    CHECK(one_view_init(&all.view, scene, camera, options) == 0);
    project_chunks(scene);
}

/* Projects all chunks (256 Gaussians each) up to 255 times their depth beside the camera's axis. */
static void project_all_chunks(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options)
{
    CHECK(one_view_init(&all.view, scene, camera, options) == 0);
    for (int i = 0; i < 2; i++) {
        all.view.edge_low_q23[i] = -255 * (1 << 23);
        all.view.edge_high_q23[i] = 255 * (1 << 23);
    }
    project_chunks(scene);
}

static const fxs_options defaults = {.size = sizeof(fxs_options), .sh_degree = 3};
static const fxs_options squares = {.size = sizeof(fxs_options), .cutoff = FXS_CUTOFF_SQUARE, .sh_degree = 3};

static struct reference_options reference_of(const fxs_options *options, const fxs_scene *scene)
{
    struct reference_options r = {options->cutoff == FXS_CUTOFF_SQUARE ? REFERENCE_SQUARE : REFERENCE_MAHALANOBIS,
                                  options->sh_degree, scene->antialiased, {0, 0, 0}};
    return r;
}

static struct errors {
    /* largest errors of splats (projected Gaussians) against the reference renderer */
    double centre, shape, opacity, radius, colour;
} worst, worst_large;   /* worst: errors of splats up to 128 pixels; worst_large: of larger splats */

/* Returns a Gaussian's size in the picture in pixels: focal length * sigma_max / z. */
static double size_of(const fxs_gaussian *g, const fxs_view *view, double z)
{
    return fmax(view->fx, view->fy) / z * exp(fmax(g->scale[0], fmax(g->scale[1], g->scale[2])));
}

/* Returns sigma_max / sigma_min of a splat (projected Gaussian). */
static double elongation(const struct reference_splat *r)
{
    double mid = (r->a + r->c) / 2, spread = sqrt((r->a - r->c) * (r->a - r->c) / 4 + r->b * r->b);
    return (mid + spread) / sqrt(r->a * r->c - r->b * r->b);
}

/* Returns the error of a splat's shape. The renderer stores rows W with W Sigma W^T = I for the covariance
   Sigma. The largest entry of W Sigma W^T - I is divided by the elongation, since the short axis has the absolute
   error of the long axis. */
static double shape_error(const fxs_splat *s, const struct reference_splat *r)
{
    double ux = ldexp(s->ux_q24, -24), uy = ldexp(s->uy_q24, -24), vy = ldexp(s->vy_q24, -24);
    double uu = ux * ux * r->a + 2 * ux * uy * r->b + uy * uy * r->c;
    double uv = vy * (ux * r->b + uy * r->c), vv = vy * vy * r->c;
    return fmax(fabs(uu - 1), fmax(fabs(uv), fabs(vv - 1))) / elongation(r);
}

static void compare_splat(struct errors *e, uint32_t slot, const struct reference_splat *r)
{
    const fxs_splat *s = &all.splats[slot];
    const fxs_bounds *b = &all.bounds[slot];
    const int veil = b->half_width_q8 == FXS_EVERYWHERE_Q8;
    double dx = ldexp(b->cx_q14, -14) + 0.5 - r->x, dy = ldexp(b->cy_q14, -14) + 0.5 - r->y;
    e->centre = fmax(e->centre, veil ? 0 : hypot(dx, dy));
    e->shape = fmax(e->shape, shape_error(s, r));
    e->opacity = fmax(e->opacity, fabs(exp(-ldexp(s->offset_q11, -12)) - r->opacity));
    if (all.view.cutoff == FXS_CUTOFF_SQUARE && !veil)
        e->radius = fmax(e->radius, (fabs((double)b->square_radius - r->radius) - 1) / r->radius);
    for (int c = 0; c < 3; c++)
        e->colour = fmax(e->colour, fabs(ldexp(s->colour_q13[c], -13) - fmin(r->colour[c], 32767 / 8192.0)));
}

static void compare_visible(const packed_scene *s, const fxs_camera *camera, const fxs_options *options)
{
    fxs_view view = view_of(camera);
    struct reference_options reference = reference_of(options, &s->scene);
    project_all(&s->scene, camera, options);
    for (uint32_t slot = 0; slot < all.count; slot++) {
        struct reference_splat splat;
        fxs_gaussian g = decode(&s->scene, all.indices[slot]);
        reference_project(&g, &view, &reference, &splat);
        compare_splat(size_of(&g, &view, splat.depth) < 128 ? &worst : &worst_large, slot, &splat);
    }
}

static double alpha_of(double opacity, double level)
{
    return level <= 9 && opacity * exp(-level / 2) >= 1 / 255.0 ? opacity * exp(-level / 2) : 0;
}

/* Returns the error of a splat's alpha at a pixel, or 0 near the splat's edge, where the splat may be cut off. */
static double veil_error(const fxs_splat *s, const struct reference_splat *r, int x, int y)
{
    const double dx = x + 0.5 - r->x, dy = y + 0.5 - r->y, det = r->a * r->c - r->b * r->b;
    const double level = (r->c * dx * dx - 2 * r->b * dx * dy + r->a * dy * dy) / det;
    const double edge = fmin(9, 2 * log(255 * r->opacity));
    const uint32_t u_q24 = s->u0_q24 + (uint32_t)x * (uint32_t)s->ux_q24 + (uint32_t)y * (uint32_t)s->uy_q24;
    const uint32_t v_q24 = s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24;
    const double u = ldexp((int32_t)u_q24, -24), v = ldexp((int32_t)v_q24, -24);
    if (fabs(level - edge) < 0.02 * edge + 0.02)
        return 0;
    return fabs(alpha_of(exp(-ldexp(s->offset_q11, -12)), u * u + v * v) - alpha_of(r->opacity, level));
}

/* True if a splat is too narrow for its shape to be compared. Its width is below 1/64 of its length, where
   rounding shows. Or its width is below 1/10 of the picture's diagonal, where the renderer may widen it. */
static int is_narrow(const struct reference_splat *r, const fxs_stage_view *view)
{
    const double mid = (r->a + r->c) / 2, spread = sqrt((r->a - r->c) * (r->a - r->c) / 4 + r->b * r->b);
    const double least = fmax((mid + spread) / 4096, 0.01 * (view->width * view->width + view->height * view->height));
    return (r->a * r->c - r->b * r->b) / (mid + spread) < least;
}

static void test_veils(void)
{
    static const recipe discs = {20, -4, 7, 0, 20, 255}, off_axis = {300, 2, 9, 0, 20, 255};
    double worst_error = 0;
    int count = 0;
    for (int i = 0; i < 120; i++) {
        packed_scene s = make_scene(i % 2 ? &off_axis : &discs, 512, 0, i % 4 == 3);
        fxs_camera camera = make_camera(1 + below(i % 3 ? 1200 : 100), 1 + below(i % 3 ? 900 : 80), uniform(0, 5));
        fxs_view view = view_of(&camera);
        struct reference_options reference = reference_of(&defaults, &s.scene);
        project_all(&s.scene, &camera, &defaults);
        for (uint32_t slot = 0; slot < all.count; slot++) {
            struct reference_splat r;
            fxs_gaussian g = decode(&s.scene, all.indices[slot]);
            reference_project(&g, &view, &reference, &r);
            if (all.bounds[slot].half_width_q8 != FXS_EVERYWHERE_Q8 || is_narrow(&r, &all.view))
                continue;
            count++;
            for (int k = 0; k < 9; k++)
                worst_error = fmax(worst_error, veil_error(&all.splats[slot], &r, (camera.width - 1) * (k % 3) / 2,
                                                           (camera.height - 1) * (k / 3) / 2));
        }
        free(s.data);
    }
    if (!CHECK(count > 400))
        printf("  %d veils\n", count);
    if (!CHECK(worst_error < 0.004))
        printf("  error of %d veils: %.4f\n", count, worst_error);
}

static void clear_errors(void)
{
    memset(&worst, 0, sizeof worst);
    memset(&worst_large, 0, sizeof worst_large);
}

static int within(const struct errors *e, double centre, double shape, double opacity)
{
    if (e->centre < centre && e->shape < shape && e->opacity < opacity && e->radius < 0.001 && e->colour < 0.0002)
        return 1;
    printf("  errors: centre %.4f pixels, shape %.5f, opacity %.5f, radius %.4f, colour %.5f\n", e->centre, e->shape,
           e->opacity, e->radius, e->colour);
    return 0;
}

static void compare_scenes(const recipe *r, int antialiased)
{
    clear_errors();
    for (int i = 0; i < 200; i++) {
        packed_scene s = make_scene(r, 256, 0, antialiased);
        fxs_camera camera = make_camera(60 + 10 * i, 40 + 5 * i, uniform(0.5, 4));
        compare_visible(&s, &camera, i % 2 ? &defaults : &squares);
        free(s.data);
    }
}

static void test_project_against_reference(void)
{
    compare_scenes(&ordinary, 0);
    CHECK(within(&worst, 0.003, 0.003, 0.0002));
    CHECK(within(&worst_large, 0.003, 0.1, 0.0002));
}

static void test_project_needles(void)
{
    compare_scenes(&needles, 0);
    CHECK(within(&worst, 0.003, 0.003, 0.0002));
    CHECK(within(&worst_large, 0.006, 0.1, 0.0002));
}

/* Compares scattered Gaussians. The quantisation step of their positions is 0.005 pixels at the near plane for
   focal length 4000. */
static void test_project_scattered(void)
{
    compare_scenes(&scattered, 0);
    CHECK(within(&worst, 0.05, 0.003, 0.0002));
    CHECK(within(&worst_large, 0.05, 0.1, 0.0002));
}

static void test_project_antialiased(void)
{
    compare_scenes(&ordinary, 1);
    CHECK(within(&worst, 0.003, 0.003, 0.002));
    CHECK(within(&worst_large, 0.003, 0.1, 0.05));
}

/* True if a splat (projected Gaussian) is clearly visible at a pixel: 2 % within its edge, with alpha over 1.1 /
   255. */
static int counts_somewhere(const struct reference_splat *r, const fxs_view *view)
{
    double det = r->a * r->c - r->b * r->b, limit = fmin(9, 2 * log(255 / 1.1 * r->opacity)) * 0.96 - 0.02;
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            double dx = x + 0.5 - r->x, dy = y + 0.5 - r->y;
            if ((r->c * dx * dx - 2 * r->b * dx * dy + r->a * dy * dy) / det <= limit)
                return 1;
        }
    return 0;
}

/* Checks that culled Gaussians are invisible. In pictures of a few pixels, Gaussians far from the camera's axis
   are culled too. */
static void check_culls(const packed_scene *s, const fxs_camera *camera)
{
    fxs_view view = view_of(camera);
    struct reference_options reference = reference_of(&defaults, &s->scene);
    uint32_t slot = 0;
    int lost = 0, kept = 0;
    project_all(&s->scene, camera, &defaults);
    const double off_axis = fmin(view.fx, view.fy) < 12 ? 63 : 1e300;
    const double near = camera->near_q32 ? view.near : 0.2, margin = fmin(1e-4, near / 8);
    for (uint32_t i = 0; i < s->scene.count; i++) {
        struct reference_splat r;
        fxs_gaussian g = decode(&s->scene, i);
        int visible = reference_project(&g, &view, &reference, &r);
        if (slot < all.count && all.indices[slot] == i) {
            slot++;
            kept += !visible && (r.depth < near - margin || r.opacity < 0.95 / 255);
        } else if (visible && r.depth > near + margin && fabs(r.x - view.cx) < off_axis * view.fx &&
                   fabs(r.y - view.cy) < off_axis * view.fy)
            lost += counts_somewhere(&r, &view);
    }
    CHECK(slot == all.count && lost == 0 && kept == 0);
}

static void test_culls(void)
{
    for (int i = 0; i < 240; i++) {
        int width = 1 + below(100), height = 1 + below(70);
        packed_scene s = make_scene(recipes[i % RECIPES], 256, 0, i % 4 == 3);
        fxs_camera camera = make_camera(width, height, uniform(0, 4));
        check_culls(&s, &camera);
        free(s.data);
    }
}

static void random_near(fxs_camera *camera)
{
    camera->near_q32 = (int64_t)ldexp(1, 18 + below(16)) + (int64_t)below(1 << 18);
}

static void test_culls_at_near_planes(void)
{
    for (int i = 0; i < 240; i++) {
        int width = 1 + below(100), height = 1 + below(70);
        packed_scene s = make_scene(recipes[i % RECIPES], 256, 0, i % 4 == 3);
        fxs_camera camera = make_camera(width, height, uniform(0, 2));
        random_near(&camera);
        check_culls(&s, &camera);
        free(s.data);
    }
}

static void test_padding_and_opacity_0_are_never_drawn(void)
{
    packed_scene s = make_scene(&huge, 300, 1, 0);
    fxs_camera camera = make_camera(64, 64, 8);
    uint32_t *colour = (uint32_t *)(void *)(s.rows + FXS_ROW_COLOUR);
    for (int i = 0; i < 100; i++)
        colour[i] &= 0xffffff;
    project_all(&s.scene, &camera, &defaults);
    for (uint32_t i = 0; i < all.count; i++)
        CHECK(all.indices[i] >= 100 && all.indices[i] < 300);
    CHECK(all.count > 100);
    free(s.data);
}

static void test_depth_order(void)
{
    for (int i = 0; i < 60; i++) {
        packed_scene s = make_scene(recipes[i % RECIPES], 1000, 0, 0);
        fxs_camera camera = make_camera(200, 150, uniform(0, i % 2 ? 10 : 1));
        camera.near_q32 = i % 2 ? 0 : 1 << 12;
        const double *forward, reach = recipes[i % RECIPES]->reach + 10;
        fxs_view view = view_of(&camera);
        double previous = 0;
        int wrong = 0;
        forward = view.rotation + 6;
        project_all(&s.scene, &camera, &defaults);
        for (uint32_t k = 0; k < all.count; k++) {
            fxs_gaussian g = decode(&s.scene, all.indices[FXS_KEY_SLOT(all.keys[k])]);
            double z = 0;
            for (int axis = 0; axis < 3; axis++)
                z += forward[axis] * (g.position[axis] - view.position[axis]);
            wrong += z < previous - reach * ldexp(1, -22);
            previous = fmax(z, previous);
        }
        CHECK(wrong == 0);
        free(s.data);
    }
}

static void check_shade(uint32_t scene_degree, int degree)
{
    fxs_options options = defaults;
    options.sh_degree = degree;
    packed_scene s = make_scene(&ordinary, 1000, scene_degree, 0);
    fxs_camera camera = make_camera(100, 70, uniform(0, 3));
    compare_visible(&s, &camera, &options);
    CHECK(all.view.sh_degree == (degree < (int)scene_degree ? degree : (int)scene_degree));
    free(s.data);
}

static void test_shade_against_reference(void)
{
    static const double most[4] = {0.0001, 0.0004, 0.0006, 0.0008};
    for (int degree = 0; degree <= 3; degree++) {
        clear_errors();
        for (int i = 0; i < 40; i++) {
            check_shade((uint32_t)degree, degree + i % (4 - degree));
            check_shade(3, degree);
        }
        if (!CHECK(worst.colour < most[degree]) || !CHECK(worst_large.colour < most[degree]))
            printf("  degree %d: %.5f, %.5f\n", degree, worst.colour, worst_large.colour);
    }
}

/* Runs jobs of the renderer in reverse order. pool: a counter of the calls; may be null. */
static void run_backwards(void *pool, void (*job)(void *, uint32_t), void *argument, uint32_t jobs)
{
    if (pool)
        ++*(int *)pool;
    while (jobs-- > 0)
        job(argument, jobs);
}

static int compare_keys(const void *a, const void *b)
{
    fxs_key x = *(const fxs_key *)a, y = *(const fxs_key *)b;
    return (x > y) - (x < y);
}

/* Sorts random keys in `parts` threads and compares the order. mask: bits of the depth that are random. */
static void check_sort(uint32_t count, uint32_t mask, uint32_t parts)
{
    enum { MOST = 70000 };
    static fxs_key keys[MOST], spare[MOST], unsorted[MOST], expected[MOST];
    static uint32_t histograms[64][FXS_SORT_BUCKETS];
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = run_backwards, .workers.count = parts};
    for (uint32_t i = 0; i < count; i++)
        keys[i] = unsorted[i] = expected[i] = FXS_KEY(bits() & mask, i);
    qsort(expected, count, sizeof *expected, compare_keys);
    fxs_key *sorted = fxs_sort(&config, keys, spare, count, histograms, parts);
    CHECK(sorted == keys || sorted == spare);
    CHECK(memcmp(sorted, expected, count * sizeof *expected) == 0);
    /* tests plain sorting of splats that are slightly out of order, as in a tile's list */
    for (uint32_t i = 0; i < count; i++)
        keys[i] = unsorted[(i ^ 15) < count ? i ^ 15 : i];
    fxs_sort_c(keys, spare, count);
    CHECK(memcmp(keys, expected, count * sizeof *expected) == 0);
}

static void test_sort(void)
{
    static const uint32_t counts[] = {0, 1, 2, 3, 100, 5000, 70000}, parts[] = {1, 2, 7, 64};
    static const uint32_t masks[] = {0, 1, 0x7ff, 0x3ff800, 0xffc00000, 0x80000001, 0x00400400, 0xf, UINT32_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (size_t k = 0; k < sizeof masks / sizeof *masks; k++)
            check_sort(counts[i], masks[k], parts[(i + k) % 4]);
}

/* ---- Stage bin lists every splat -------------------------------------------------------------------------------- */

static int level_at(uint32_t slot, int x, int y)
{
    return splat_level(&all.splats[slot], &all.bounds[slot], x, y);
}

static int limit_of(uint32_t slot)
{
    return fxs_limit_q11(all.splats[slot].offset_q11, all.view.cut_q11);
}

static int in_square(uint32_t slot, int x, int y)
{
    return splat_has_tile(&all.bounds[slot], x, y);
}

enum listed { NOT_LISTED, CUT_OFF, NEAR };

static void list_splat(uint32_t slot, unsigned char *listed)
{
    const fxs_splat *splat = &all.splats[slot];
    const fxs_bounds *bounds = &all.bounds[slot];
    const uint32_t tiles = (uint32_t)(all.view.tiles_x * all.view.tiles_y), depth = 0;
    fxs_box box;
    fxs_bin_c(&all.view, splat, bounds, 1, &box);
    tile_lists lists = tile_lists_new(&all.view, splat, bounds, &box, &depth, 1);
    for (uint32_t tile = 0; tile < tiles; tile++) {
        const uint32_t count = lists.counts[tile], last = lists.ends[tile] - 1;
        CHECK(count <= 1);
        listed[tile] = count == 0 ? NOT_LISTED : lists.entries[last] & FXS_ENTRY_CUT_OFF ? CUT_OFF : NEAR;
    }
    tile_lists_free(&lists);
}

static struct {
    int64_t missed, wrapped, in_cut_off;
} lists;

/* Checks a splat (projected Gaussian) at a pixel. The splat covers the pixel if level = -2 ln(alpha) is within
   the limit. With the square cut-off, the pixel's tile must also be in the splat's square. */
static void check_pixel(uint32_t slot, int x, int y, enum listed listed)
{
    const fxs_splat *s = &all.splats[slot];
    int counts = level_at(slot, x, y) <= limit_of(slot), square = all.view.cutoff == FXS_CUTOFF_SQUARE;
    int on_row = y >= s->first_row && y <= s->last_row;
    if (counts && (!square || in_square(slot, x, y))) {
        lists.missed += listed == NOT_LISTED || !on_row;
        lists.in_cut_off += listed == CUT_OFF;
    }
    if (!counts && listed == NEAR && on_row) {
        int32_t u = (int32_t)(s->u0_q24 + (uint32_t)x * (uint32_t)s->ux_q24 + (uint32_t)y * (uint32_t)s->uy_q24);
        int32_t v = (int32_t)(s->v0_q24 + (uint32_t)y * (uint32_t)s->vy_q24);
        int row_level = fxs_row_level_q11(fxs_coordinate_q13(v), s->offset_q11);
        lists.wrapped += fxs_level_q11(fxs_coordinate_q13(u), row_level) <= limit_of(slot);
    }
}

static void check_lists(const recipe *r, int width, int height, const fxs_options *options, uint32_t count)
{
    static unsigned char listed[4096];
    packed_scene s = make_scene(r, count, 0, 0);
    fxs_camera camera = make_camera(width, height, uniform(0, 2 * r->reach));
    memset(&lists, 0, sizeof lists);
    project_all(&s.scene, &camera, options);
    for (uint32_t slot = 0; slot < all.count; slot++) {
        list_splat(slot, listed);
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                check_pixel(slot, x, y, listed[y / FXS_TILE * all.view.tiles_x + x / FXS_TILE]);
    }
    if (!CHECK(lists.missed == 0) || !CHECK(lists.in_cut_off == 0) || !CHECK(lists.wrapped == 0))
        printf("  sigma_high %g, %dx%d, cut-off %d: %d pixels missed, %d in tiles where it is cut off, %d wrapped\n",
               r->sigma_high, width, height, (int)options->cutoff, (int)lists.missed, (int)lists.in_cut_off,
               (int)lists.wrapped);
    free(s.data);
}

static void test_lists_of_small_pictures(void)
{
    for (int i = 0; i < 20 * RECIPES; i++) {
        int width = 1 + below(100), height = 1 + below(70);
        check_lists(recipes[i % RECIPES], width, height, i / RECIPES % 2 ? &defaults : &squares, 64);
    }
}

static void test_lists_of_narrow_pictures(void)
{
    for (int i = 0; i < 4 * RECIPES; i++) {
        const fxs_options *options = i / RECIPES % 2 ? &defaults : &squares;
        int length = 600 + below(1400), breadth = 1 + below(30);
        check_lists(recipes[i % RECIPES], length, breadth, options, 64);
        check_lists(recipes[i % RECIPES], breadth, length, options, 64);
    }
}

static void test_lists_of_large_pictures(void)
{
    for (int i = 0; i < 2 * RECIPES; i++)
        check_lists(recipes[i % RECIPES], 900, 600, i / RECIPES ? &defaults : &squares, 12);
}

static void test_squares_at_tile_edges(void)
{
    static unsigned char listed[4096];
    packed_scene s = make_scene(&ordinary, 1, 0, 0);
    fxs_camera camera = make_camera(100, 70, 2);
    int missed = 0, beyond = 0;
    CHECK(one_view_init(&all.view, &s.scene, &camera, &squares) == 0);
    memset(all.splats, 0, sizeof *all.splats);
    memset(all.bounds, 0, sizeof *all.bounds);
    for (int i = 0; i < 400; i++) {
        fxs_bounds *b = all.bounds;
        b->square_radius = (uint32_t)(1 + below(40));
        const int sign = below(2) ? 1 : -1, tile = below(6);
        b->cx_q14 = (tile << 18) + sign * ((int)b->square_radius << 14) + below(3) - 1;
        b->cy_q14 = (below(4) << 18) + sign * ((int)b->square_radius << 14) + below(3) - 1;
        list_splat(0, listed);
        for (int y = 0; y < all.view.tiles_y; y++)
            for (int x = 0; x < all.view.tiles_x; x++) {
                const int inside = in_square(0, FXS_TILE * x, FXS_TILE * y);
                missed += inside && listed[y * all.view.tiles_x + x] == NOT_LISTED;
                beyond += !inside && listed[y * all.view.tiles_x + x] != NOT_LISTED;
            }
    }
    CHECK(missed == 0 && beyond == 0);
    free(s.data);
}

static struct {
    int transmittance_q15[MAX_SIDE * 80], sum_q13[3][MAX_SIDE * 80];
    uint64_t blended;
} brute;

static void blend_splat(uint32_t slot)
{
    for (int y = 0, i = 0; y < all.view.height; y++)
        for (int x = 0; x < all.view.width; x++, i++) {
            int level = level_at(slot, x, y), t = brute.transmittance_q15[i];
            if (t < FXS_CLOSED_Q15 || level > limit_of(slot) ||
                (all.view.cutoff == FXS_CUTOFF_SQUARE && !in_square(slot, x, y)))
                continue;
            int weight = fxs_weight_q15(fxs_alpha_q15(level), t);
            brute.transmittance_q15[i] -= weight;
            for (int c = 0; c < 3; c++)
                brute.sum_q13[c][i] = fxs_accumulate_q13(brute.sum_q13[c][i], weight, all.splats[slot].colour_q13[c]);
            brute.blended++;
        }
}

static void store(unsigned char *pixel, int i, const fxs_options *options, enum fxs_format format)
{
    int rgb[3], t = brute.transmittance_q15[i];
    for (int c = 0; c < 3; c++) {
        int background = format == FXS_FORMAT_RGBA8_COVERAGE ? 0 : options->background[c];
        rgb[c] = fxs_resolve_8bit(brute.sum_q13[c][i], t, (background * 8192 + 127) / 255);
    }
    if (format == FXS_FORMAT_RGB565) {
        double r = floor(rgb[0] * 31 / 255.0 + 0.5), g = floor(rgb[1] * 63 / 255.0 + 0.5);
        uint16_t packed = (uint16_t)(r * 2048 + g * 32 + floor(rgb[2] * 31 / 255.0 + 0.5));
        memcpy(pixel, &packed, 2);
        return;
    }
    for (int c = 0; c < 3; c++)
        pixel[c] = (unsigned char)rgb[c];
    pixel[3] = format == FXS_FORMAT_RGBA8 ? 255 : (unsigned char)fxs_coverage_8bit(t);
}

static void render_brute(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                         enum fxs_format format, unsigned char *pixels, ptrdiff_t stride)
{
    const int bytes = format == FXS_FORMAT_RGB565 ? 2 : 4, count = camera->width * camera->height;
    memset(&brute, 0, sizeof brute);
    for (int i = 0; i < count; i++)
        brute.transmittance_q15[i] = FXS_CLEAR_Q15;
    project_all_chunks(scene, camera, options);
    for (uint32_t k = 0; k < all.count; k++)
        blend_splat(FXS_KEY_SLOT(all.keys[k]));
    for (int i = 0; i < count; i++)
        store(pixels + i / camera->width * stride + i % camera->width * bytes, i, options, format);
}

static uint64_t tick(void *ticks)
{
    return ++*(uint64_t *)ticks;
}

static int untouched(const unsigned char *bytes, size_t count)
{
    while (count > 0 && *bytes == GUARD)
        bytes++, count--;
    return count == 0;
}

static int draw_tiles(void *argument, const fxs_tile_run *run)
{
    const fxs_stage_view *view = run->view;
    const fxs_image *colour = &run->targets->colour;
    const enum fxs_format format = run->targets->format;
    const int bytes = format == FXS_FORMAT_RGB565 ? 2 : 4;
    ++*(int *)argument;
    for (uint32_t t = run->first_tile; t <= run->last_tile; t++) {
        int x = (int)t % view->tiles_x * FXS_TILE, y = (int)t / view->tiles_x * FXS_TILE;
        fxs_tile tile;
        fxs_blend_c(view, x, y, run->splats, run->entries + run->ends[t] - run->counts[t], run->counts[t], &tile);
        fxs_resolve_c(run->options, format, &tile, fxs_min(FXS_TILE, view->width - x),
                      fxs_min(FXS_TILE, view->height - y),
                      (unsigned char *)colour->pixels + y * colour->stride + x * bytes, colour->stride);
    }
    return 0;
}

/* A back end that gets sorted keys in place of tile lists. Returns the number of Gaussians that arrived in order
   of depth. */
static int draw_keys(void *argument, const fxs_tile_run *run)
{
    uint32_t *ordered = argument;
    CHECK(!run->entries && !run->ends && !run->counts && run->first_tile == 0 &&
              !run->targets->colour.pixels);
    CHECK(run->last_tile == (uint32_t)(run->view->tiles_x * run->view->tiles_y) - 1);
    for (uint32_t i = 0; i < run->visible; i++)
        *ordered += i == 0 || run->keys[i - 1] < run->keys[i];
    return 0;
}

static int draw_nothing(void *argument, const fxs_tile_run *run)
{
    (void)argument, (void)run;
    return FXS_ERR_DEVICE;
}

/* Renders by three back ends. The first must give the CPU's bytes. The second gets the splats in order of depth.
   The third returns an error, which the frame must return. */
static void check_back_ends(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                            enum fxs_format format, void *memory, size_t size, const unsigned char *expected,
                            size_t bytes, size_t first, ptrdiff_t stride)
{
    int calls = 0;
    uint32_t ordered = 0;
    fxs_context context;
    fxs_stats stats;
    unsigned char *pixels = allocate(bytes, GUARD);
    fxs_context_init(&context, 0);
    context.config.draw = draw_tiles;
    context.config.draw_argument = &calls;
    CHECK(one_render(&context, scene, camera, options, format, memory, size, pixels + first, stride, &stats) == 0);
    CHECK(memcmp(pixels, expected, bytes) == 0 && calls == (int)stats.runs);
    context.config.draw = draw_nothing;
    CHECK(one_render(&context, scene, camera, options, format, memory, size, pixels + first, stride, 0) ==
          FXS_ERR_DEVICE);
    fxs_context_init(&context, &(fxs_config){.size = sizeof(fxs_config), .draw = draw_keys, .draw_argument = &ordered,
                                             .draw_unlisted = 1});
    const fxs_object object = one_object(scene);
    const size_t unlisted = fxs_frame_bytes(&context, &object, 1, camera->width, camera->height, 0);
    void *room = check_aligned(unlisted);
    CHECK(render_frame(&context, &object, 1, camera, options, 0, room, unlisted, &stats) == 0);
    CHECK(ordered == stats.visible && stats.visible == all.count);
    free(room);
    free(pixels);
}

static fxs_stats check_bytes(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                             enum fxs_format format, const unsigned char *expected, size_t bytes, size_t first,
                             ptrdiff_t stride)
{
    int pools = 0;
    uint64_t ticks = 0;
    fxs_config config = {.size = sizeof(fxs_config), .workers.run = run_backwards, .workers.pool = &pools,
                         .workers.count = (uint32_t)(2 + below(7)), .clock = tick,
                         .clock_argument = &ticks};
    fxs_context context;
    fxs_stats stats;
    CHECK(fxs_context_init(&context, below(2) ? &config : 0) == 0);
    size_t size = one_frame_bytes(&context, scene, camera->width, camera->height, 0);
    unsigned char *memory = allocate(size + GUARD_BYTES, GUARD), *pixels = allocate(bytes, GUARD);
    CHECK(one_render(&context, scene, camera, options, format, memory, size, pixels + first, stride, &stats) == 0);
    CHECK(memcmp(pixels, expected, bytes) == 0);
    CHECK(untouched(memory + size, GUARD_BYTES));
    CHECK(stats.gaussians == scene->count && stats.visible == all.count && stats.runs >= 1);
    CHECK(!context.config.workers.run || (pools > 0 && stats.frame_nanoseconds > 0));
    uint64_t evaluated = 0, blended = 0;
    CHECK(one_count_pairs(scene, camera, options, memory, size, &evaluated, &blended) == 0);
    /* statistics of pairs of splats and pixels count whole tiles, even beyond the edge of the picture */
    CHECK(camera->width % FXS_TILE ? blended >= brute.blended : blended == brute.blended);
    CHECK(evaluated >= blended);
    check_back_ends(scene, camera, options, format, memory, size, expected, bytes, first, stride);
    free(memory);
    free(pixels);
    return stats;
}

static fxs_stats check_frame(const fxs_scene *scene, const fxs_camera *camera, enum fxs_cutoff cutoff)
{
    const enum fxs_format format = (enum fxs_format)below(3);
    fxs_options options = {.size = sizeof(fxs_options), .cutoff = cutoff};
    options.sh_degree = below(4);
    for (int c = 0; c < 3; c++)
        options.background[c] = (uint8_t)bits();
    ptrdiff_t row = camera->width * (format == FXS_FORMAT_RGB565 ? 2 : 4), stride = row + below(9);
    size_t bytes = (size_t)stride * (size_t)camera->height + GUARD_BYTES, first = 0;
    if (below(2)) {
        first = (size_t)stride * (size_t)(camera->height - 1);
        stride = -stride;
    }
    unsigned char *expected = allocate(bytes, GUARD);
    render_brute(scene, camera, &options, format, expected + first, stride);
    fxs_stats stats = check_bytes(scene, camera, &options, format, expected, bytes, first, stride);
    free(expected);
    return stats;
}

static void check_size(const recipe *r, int width, int height)
{
    int count = 1 + below(400), degree = below(4);
    packed_scene s = make_scene(r, (uint32_t)count, (uint32_t)degree, below(2));
    fxs_camera camera = make_camera(width, height, uniform(0, 3 * r->reach));
    int faults = check_faults;
    check_frame(&s.scene, &camera, FXS_CUTOFF_MAHALANOBIS);
    check_frame(&s.scene, &camera, FXS_CUTOFF_SQUARE);
    if (check_faults > faults)
        printf("  recipe with sigma_high %g, %u Gaussians, %dx%d\n", r->sigma_high, s.scene.count, width, height);
    free(s.data);
}

static void test_frame_equals_brute_force(void)
{
    static const int sizes[][2] = {{1, 1}, {16, 16}, {17, 33}, {100, 70}, {1, 70}, {100, 1}, {15, 15}, {32, 31}};
    for (int i = 0; i < RECIPES; i++)
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
            check_size(recipes[i], sizes[k][0], sizes[k][1]);
    for (int i = 0; i < 20 * RECIPES; i++) {
        int width = 1 + below(100), height = 1 + below(70);
        check_size(recipes[i % RECIPES], width, height);
    }
}

static void test_narrow_frame_equals_brute_force(void)
{
    for (int i = 0; i < RECIPES; i++) {
        int length = 900 + below(200), breadth = 1 + below(20);
        check_size(recipes[i], length, breadth);
        check_size(recipes[i], breadth, length);
    }
}

static void test_frame_at_near_planes_equals_brute_force(void)
{
    for (int i = 0; i < 8 * RECIPES; i++) {
        packed_scene s = make_scene(recipes[i % RECIPES], 400, (uint32_t)below(4), below(2));
        fxs_camera camera = make_camera(1 + below(100), 1 + below(70), uniform(0, 1));
        random_near(&camera);
        check_frame(&s.scene, &camera, FXS_CUTOFF_MAHALANOBIS);
        check_frame(&s.scene, &camera, FXS_CUTOFF_SQUARE);
        free(s.data);
    }
}

/* Renders Gaussians with more tile lists than the memory holds, so the frame is rendered in several runs of
   tiles. */
static void test_frame_in_runs_equals_brute_force(void)
{
    static const recipe veils = {1, 4, 6, 0, 1, 3};
    packed_scene s = make_scene(&veils, MAX_COUNT, 0, 0);
    fxs_camera camera = make_camera(100, 70, 3);
    for (int cutoff = 0; cutoff < 2; cutoff++) {
        fxs_stats stats = check_frame(&s.scene, &camera, (enum fxs_cutoff)cutoff);
        CHECK(stats.runs > 1 && stats.entries > 4 * 4096);
    }
    free(s.data);
}

static void test_empty_scene_is_background(void)
{
    packed_scene s = make_scene(&ordinary, 0, 0, 0);
    fxs_camera camera = make_camera(40, 30, 2);
    fxs_stats stats = check_frame(&s.scene, &camera, FXS_CUTOFF_MAHALANOBIS);
    CHECK(stats.visible == 0 && stats.entries == 0);
    free(s.data);
}

/* Checks the measured times of the stages. The clock advances by one at each call, so stages with equally many
   calls report equal times. */
static void test_times_are_shared_out(void)
{
    uint64_t ticks = 0;
    const fxs_config config = {.size = sizeof(fxs_config), .clock = tick, .clock_argument = &ticks};
    fxs_context context;
    fxs_stats stats;
    packed_scene s = make_scene(&ordinary, 256, 0, 0);
    for (int tiles = 1; tiles <= 4; tiles++) {
        fxs_camera camera = make_camera(FXS_TILE * tiles, FXS_TILE, 2);
        fxs_context_init(&context, &config);
        size_t size = one_frame_bytes(&context, &s.scene, camera.width, camera.height, 0);
        unsigned char *memory = allocate(size, 0), *pixels = allocate((size_t)(camera.width * camera.height * 4), 0);
        CHECK(one_render(&context, &s.scene, &camera, &defaults, FXS_FORMAT_RGBA8, memory, size, pixels,
                         camera.width * 4, &stats) == 0);
        const uint64_t *t = stats.nanoseconds;
        /* The layout of memory counts as time of the stage project. Listing the tiles counts as time of the
           stage bin. */
        CHECK(t[FXS_SHADE] > 0 && t[FXS_PROJECT] == t[FXS_SHADE] + 1 && t[FXS_BIN] == t[FXS_SHADE] + 2 + t[FXS_BLEND]);
        CHECK(t[FXS_BLEND] > 0 && t[FXS_BLEND] == t[FXS_RESOLVE] && t[FXS_SORT] > 0 && t[FXS_SORT] <= t[FXS_BLEND]);
        free(memory);
        free(pixels);
    }
    free(s.data);
}

/* A Gaussian near an edge of the picture, by the slopes x/z and y/z of its centre, its depth and its sigma. */
typedef struct beside {
    double slope[2], depth, log2_sigma;
} beside;

static double focal_of(const fxs_camera *camera, int axis)
{
    return ldexp(axis ? camera->fy_q12 : camera->fx_q12, -12);
}

static void aim(fxs_camera *camera, int axis, double focal, double slope)
{
    *(axis ? &camera->fy_q12 : &camera->fx_q12) = (int32_t)ldexp(focal, 12);
    *(axis ? &camera->cy_q12 : &camera->cx_q12) = (int32_t)ldexp(-slope * focal, 12);
}

/* Returns the distance in pixels from the centre of a projected sphere to Mahalanobis distance 3. The Jacobian's
   slope is clamped to the field of view plus 30 %. */
static double reach_of(const fxs_stage_view *view, const fxs_camera *camera, const beside *b, int axis)
{
    double low = ldexp(view->slope_low_q23[axis], -23), high = ldexp(view->slope_high_q23[axis], -23);
    double slope = fmin(fmax(b->slope[axis], low), high);
    double sigma = focal_of(camera, axis) * exp2(b->log2_sigma) / b->depth;
    return 3 * sqrt(sigma * sigma * (1 + slope * slope) + 0.3);
}

/* Moves the centre of a Gaussian beyond the first or last pixel of an axis, by `far` times its radius. */
static void step_out(beside *b, const fxs_stage_view *view, const fxs_camera *camera, int axis, int last, double far)
{
    const double focal = focal_of(camera, axis), centre = ldexp(axis ? camera->cy_q12 : camera->cx_q12, -12);
    const double edge = last ? (axis ? camera->height : camera->width) - 0.5 : 0.5;
    for (int i = 0; i < 4; i++) {                /* repeats, because the splat's radius depends on the slope x/z */
        double reach = far * reach_of(view, camera, b, axis);
        b->slope[axis] = (edge + (last ? reach : -reach) - centre) / focal;
    }
}

static void place_sphere(packed_scene *s, const fxs_camera *camera, const beside *b, double box)
{
    const fxs_view view = view_of(camera);
    const double x[3] = {b->slope[0] * b->depth, b->slope[1] * b->depth, b->depth};
    uint16_t *codes = (uint16_t *)(void *)(s->rows + FXS_ROW_POSITION);
    fxs_chunk *chunk = s->chunks;
    chunk->scale_q16 = (int32_t)floor(ldexp(b->log2_sigma, 16));
    chunk->step_shift = box > 60000 ? 12 : 0;
    for (int i = 0; i < 3; i++) {
        double step = floor(ldexp(box / 65535, 32 - (int)chunk->step_shift)), p = view.position[i];
        for (int k = 0; k < 3; k++)
            p += view.rotation[3 * k + i] * x[k];
        codes[i * FXS_CHUNK] = below(2) ? 65535 : 0;
        chunk->step_q32[i] = (uint32_t)step;
        chunk->origin_q32[i] = (int64_t)floor(ldexp(p, 32)) -
                               (int64_t)codes[i * FXS_CHUNK] * ((int64_t)step << chunk->step_shift);
        chunk->colour_q16[i] = 4 << 16;
    }
    *(uint32_t *)(void *)(s->rows + FXS_ROW_ROTATION) = 0;
    *(uint32_t *)(void *)(s->rows + FXS_ROW_COLOUR) = 255u << 24;
    CHECK(fxs_scene_open(&s->scene, s->data, s->bytes) == 0);
}

static struct {
    /* numbers of frames in which the Gaussian covers pixels: all; with its centre 99 % of its radius outside */
    int touching, farthest;
} beside_tally;

static void check_beside(fxs_camera *camera, beside *b, const double box)
{
    fxs_stage_view view;
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
    CHECK(one_view_init(&view, &s.scene, camera, &defaults) == 0);
    for (int side = 0; side < 8; side++) {
        const double far = 0.9 + 0.12 * (1 - pow(uniform(0, 1), 3));
        const int axis = side & 1, corner = side >> 2;
        int faults = check_faults;
        for (int i = 0; i < 2; i++)
            step_out(b, &view, camera, i, i == axis ? side >> 1 & 1 : below(2),
                     i == axis ? far : corner ? uniform(0, 0.7) : uniform(-0.2, 0));
        if (fabs(b->slope[0]) > 63.9 || fabs(b->slope[1]) > 63.9)
            continue;
        place_sphere(&s, camera, b, box);
        fxs_stats stats = check_frame(&s.scene, camera, FXS_CUTOFF_MAHALANOBIS);
        CHECK(stats.visible > 0 || brute.blended == 0);
        beside_tally.touching += brute.blended > 0;
        beside_tally.farthest += brute.blended > 0 && far > 0.99 && far < 1;
        if (check_faults > faults)
            printf("  side %d, %.4f of the reach, x/z %g, y/z %g, z %g, sigma 2^%g, box %g\n", side, far, b->slope[0],
                   b->slope[1], b->depth, b->log2_sigma, box);
    }
    free(s.data);
}

static void test_chunks_beside_the_picture(void)
{
    memset(&beside_tally, 0, sizeof beside_tally);
    for (int i = 0; i < 330; i++) {
        fxs_camera camera = make_camera(1 + below(20), 1 + below(20), 0);
        beside b = {{0, 0}, exp2(uniform(-2, 20)), 0};
        double most = 0;
        for (int axis = 0; axis < 2; axis++) {
            double slope = i % 3 ? uniform(-1, 1) * exp2(uniform(-4, 5)) : 0;
            double focal = exp2(uniform(3, 17)) / fmax(1, fabs(slope));
            aim(&camera, axis, focal, slope);
            most = fmax(most, focal / b.depth);
        }
        /* A quarter of the Gaussians are so small that only the dilation gives them a size. All others have up
           to 4096 pixels. */
        b.log2_sigma = i % 4 ? uniform(-1, 12) - log2(most) : -31;
        if (b.log2_sigma > -31.5 && b.log2_sigma < 31)
            check_beside(&camera, &b, i % 2 ? 0 : b.depth * exp2(uniform(-8, 1)));
    }
    if (!CHECK(beside_tally.touching > 500) || !CHECK(beside_tally.farthest > 50))
        printf("  %d touch the picture, %d at the end of their reach\n", beside_tally.touching, beside_tally.farthest);
}

/* Tests chunk culling at its tightest. The bound on a sphere's radius in pixels is tightest with the slope x/z
   at the limit of the Jacobian's clamp. */
static void test_chunks_at_the_bound_of_their_reach(void)
{
    memset(&beside_tally, 0, sizeof beside_tally);
    for (int i = 0; i < 200; i++) {
        const int exponent = 1 + i % 4, axis = i / 4 % 2;
        const double slope = (i / 8 % 2 ? -1 : 1) * (sqrt(ldexp(1, 2 * exponent) - 1) - 0.01);
        fxs_camera camera = make_camera(16, 16, 0);
        beside b = {{0, 0}, exp2(uniform(-2, 10)), 0};
        aim(&camera, axis, 16384 / fabs(slope), slope);
        aim(&camera, !axis, 16384 / fabs(slope), 0);
        b.log2_sigma = uniform(5, 11) - exponent - log2(focal_of(&camera, axis) / b.depth);
        check_beside(&camera, &b, i % 2 ? 0 : b.depth / 256);
    }
    if (!CHECK(beside_tally.touching > 300) || !CHECK(beside_tally.farthest > 25))
        printf("  %d touch the picture, %d at the end of their reach\n", beside_tally.touching, beside_tally.farthest);
}

static void test_chunks_of_the_coarsest_units(void)
{
    memset(&beside_tally, 0, sizeof beside_tally);
    for (int i = 0; i < 100; i++) {
        fxs_camera camera = make_camera(16, 16, 0);
        const int axis = i & 1;
        beside b = {{0, 0}, exp2(uniform(2, 15)), 0};
        for (int k = 0; k < 9; k++)
            camera.rotation_q30[k] = k % 4 ? 0 : 1 << 30;
        aim(&camera, axis, 524287, 0);
        aim(&camera, !axis, 8000, i & 2 ? 60 : -60);
        b.log2_sigma = (i & 4 ? -28 : -33) + log2(b.depth);
        check_beside(&camera, &b, 0);
    }
    if (!CHECK(beside_tally.touching > 100) || !CHECK(beside_tally.farthest > 10))
        printf("  %d touch the picture, %d at the end of their reach\n", beside_tally.touching, beside_tally.farthest);
}

static void test_chunks_across_the_near_plane(void)
{
    int touching = 0, behind = 0;
    for (int i = 0; i < 300; i++) {
        fxs_camera camera = make_camera(16, 16, 0);
        const double hair = (i % 3 ? 1 : -1) * exp2(uniform(-24, -8));
        const beside b = {{uniform(-0.3, 0.3), uniform(-0.3, 0.3)}, 0.2 + hair, -6};
        packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
        const double box = exp2(uniform(-8, 8)), units = fmax(0x1p-20, ldexp(box, -25));
        place_sphere(&s, &camera, &b, box);
        uint16_t *codes = (uint16_t *)(void *)(s.rows + FXS_ROW_POSITION);
        /* moves the Gaussian to the corner of its chunk's box that is nearest to the camera */
        for (int axis = 0; axis < 3; axis++) {
            const int64_t width = (int64_t)s.chunks->step_q32[axis] * 65535;
            const int forward = camera.rotation_q30[6 + axis] > 0;
            s.chunks->origin_q32[axis] += codes[axis * FXS_CHUNK] ? width : 0;
            codes[axis * FXS_CHUNK] = forward ? 65535 : 0;
            s.chunks->origin_q32[axis] -= forward ? width : 0;
        }
        fxs_stats stats = check_frame(&s.scene, &camera, (enum fxs_cutoff)(i & 1));
        CHECK(hair < 0 ? stats.visible == 0 : stats.visible == 1 || hair < units);
        touching += brute.blended > 0;
        behind += hair < 0 && stats.visible == 0;
        free(s.data);
    }
    CHECK(touching > 150 && behind > 80);
}

/* A Gaussian exactly on the near plane is culled. One fixed-point unit beyond, it is drawn. */
static void test_near_plane_itself(void)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
    fxs_camera camera = {.width = 16, .height = 16, .fx_q12 = 16 << 12, .fy_q12 = 16 << 12, .cx_q12 = 8 << 12,
                         .cy_q12 = 8 << 12};
    const beside b = {{0, 0}, 1, -6};
    for (int i = 0; i < 9; i++)
        camera.rotation_q30[i] = i % 4 ? 0 : 1 << 30;
    place_sphere(&s, &camera, &b, 0);
    s.chunks->step_q32[2] = 2;
    ((uint16_t *)(void *)(s.rows + FXS_ROW_POSITION))[2 * FXS_CHUNK] = 0;
    for (int ahead = -1; ahead <= 1; ahead++) {
        s.chunks->origin_q32[2] = 858993459 + 2 * ahead;
        CHECK(check_frame(&s.scene, &camera, FXS_CUTOFF_MAHALANOBIS).visible == (ahead > 0));
    }
    free(s.data);
}

static void check_slope(int32_t q23, double slope, double most)
{
    CHECK(fabs(ldexp(q23, -23) - fmax(-most, fmin(slope, most))) < ldexp(1, -22));
}

static void test_view_slopes(void)
{
    const packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
    int cut = 0;
    for (int i = 0; i < 1000; i++) {
        fxs_stage_view v;
        fxs_camera camera = make_camera(1 + below(2000), 1 + below(2000), 0);
        camera.fx_q12 = (int32_t)exp2(uniform(12, 24));
        camera.fy_q12 = (int32_t)exp2(uniform(12, 24));
        CHECK(one_view_init(&v, &s.scene, &camera, &defaults) == 0);
        double longest = 0;
        for (int axis = 0; axis < 2; axis++) {
            const double size = axis ? camera.height : camera.width, margin = floor(size * 614) / 4096;
            const double f = focal_of(&camera, axis), c = ldexp(axis ? camera.cy_q12 : camera.cx_q12, -12);
            check_slope(v.slope_low_q23[axis], -(c + margin) / f, 60);
            check_slope(v.slope_high_q23[axis], (size - c + margin) / f, 60);
            check_slope(v.edge_low_q23[axis], -(c + 18) / f, 64);
            check_slope(v.edge_high_q23[axis], (size + 18 - c) / f, 64);
            longest = fmax(longest, ldexp(fmax(-v.slope_low_q23[axis], v.slope_high_q23[axis]), -23));
            cut += v.slope_high_q23[axis] == 60 << 23;
        }
        longest = sqrt(1 + fmax(1, longest) * fmax(1, longest));
        CHECK(ldexp(1, v.jacobian_exponent) >= longest && ldexp(1, v.jacobian_exponent - 1) < longest);
    }
    CHECK(cut > 100 && cut < 1900);
    free(s.data);
}

static struct {
    fxs_context context;
    packed_scene scene;
    fxs_camera camera;
    fxs_options options;
    enum fxs_format format;
    unsigned char *memory, pixels[20 * 10 * 4];
    size_t bytes, least;
} good;

static int render_good(void)
{
    return one_render(&good.context, &good.scene.scene, &good.camera, &good.options, good.format, good.memory,
                      good.bytes, good.pixels, 80, 0);
}

/* Puts a bad value into a request. Rendering must return the error and leave the pixels untouched. Then restores
   the value. */
#define REFUSES(error, place, value) do { \
        memcpy(saved, &(place), sizeof (place)); \
        (place) = (value); \
        if (!CHECK(render_good() == (error)) || !CHECK(untouched(good.pixels, sizeof good.pixels))) \
            printf("  %s = %s\n", #place, #value); \
        memcpy(&(place), saved, sizeof (place)); \
    } while (0)

static void make_good(void)
{
    good.scene = make_scene(&ordinary, 10, 0, 0);
    good.camera = make_camera(20, 10, 2);
    good.options = defaults;
    good.format = FXS_FORMAT_RGBA8;
    fxs_context_init(&good.context, 0);
    fxs_frame_memory memory;
    good.bytes = one_frame_bytes(&good.context, &good.scene.scene, 20, 10, &memory);
    good.least = memory.least;
    good.memory = allocate(good.bytes + 64, 0);
    memset(good.pixels, GUARD, sizeof good.pixels);
}

static void test_render_refuses_cameras(void)
{
    unsigned char saved[64];
    make_good();
    fxs_camera *camera = &good.camera;
    REFUSES(FXS_ERR_SIZE, camera->width, 0);
    REFUSES(FXS_ERR_SIZE, camera->height, -1);
    REFUSES(FXS_ERR_SIZE, camera->width, FXS_MAX_SIZE + 1);
    REFUSES(FXS_ERR_SIZE, camera->height, INT32_MAX);
    REFUSES(FXS_ERR_CAMERA, camera->fx_q12, 0);
    REFUSES(FXS_ERR_CAMERA, camera->fy_q12, INT32_MIN);
    for (int i = 0; i < 9; i++) {
        REFUSES(FXS_ERR_CAMERA, camera->rotation_q30[i], camera->rotation_q30[i] + (1 << 26));
        REFUSES(FXS_ERR_CAMERA, camera->rotation_q30[i], INT32_MIN);
        REFUSES(FXS_ERR_CAMERA, camera->rotation_q30[i], INT32_MAX);
    }
    for (int i = 0; i < 3; i++) {
        REFUSES(FXS_ERR_CAMERA, camera->position_q32[i], ((int64_t)1 << 60) + 1);
        REFUSES(FXS_ERR_CAMERA, camera->position_q32[i], INT64_MIN);
    }
    REFUSES(FXS_ERR_CAMERA, camera->near_q32, -1);
    REFUSES(FXS_ERR_CAMERA, camera->near_q32, 1);
    REFUSES(FXS_ERR_CAMERA, camera->near_q32, (1 << 12) - 1);
    REFUSES(FXS_ERR_CAMERA, camera->near_q32, ((int64_t)1 << 60) + 1);
    REFUSES(FXS_ERR_CAMERA, camera->near_q32, INT64_MIN);
    for (int i = 0; i < 3; i++)
        /* turns the camera's rotation into a reflection, which is refused */
        camera->rotation_q30[i] = -camera->rotation_q30[i];
    CHECK(render_good() == FXS_ERR_CAMERA && untouched(good.pixels, sizeof good.pixels));
    free(good.scene.data);
    free(good.memory);
}

/* Tests the camera's near plane. near_q32 0 means 0.2 units. At the largest near plane the picture is empty. */
static void test_near_range(void)
{
    static const int64_t planes_q32[] = {0, 858993459, 1 << 12, (int64_t)1 << 60};
    unsigned char pictures[4][sizeof good.pixels];
    make_good();
    for (int i = 0; i < 4; i++) {
        good.camera.near_q32 = planes_q32[i];
        CHECK(render_good() == 0);
        memcpy(pictures[i], good.pixels, sizeof good.pixels);
    }
    CHECK(!memcmp(pictures[0], pictures[1], sizeof pictures[0]));
    for (size_t i = 0; i < sizeof good.pixels; i++)
        CHECK(pictures[3][i] == (i % 4 == 3 ? 255 : 0));
    free(good.scene.data);
    free(good.memory);
}

static void test_render_refuses_arguments(void)
{
    unsigned char saved[64];
    make_good();
    REFUSES(FXS_ERR_ARGUMENT, good.options.sh_degree, -1);
    REFUSES(FXS_ERR_ARGUMENT, good.options.sh_degree, 4);
    REFUSES(FXS_ERR_ARGUMENT, good.options.cutoff, (enum fxs_cutoff)2);
    REFUSES(FXS_ERR_TARGET, good.format, (enum fxs_format)(FXS_FORMAT_RGB565_SWAPPED + 1));
    REFUSES(FXS_ERR_TARGET, good.format, (enum fxs_format)-1);
    REFUSES(FXS_ERR_ARGUMENT, good.memory, 0);
    REFUSES(FXS_ERR_MEMORY, good.memory, good.memory + 32);
    REFUSES(FXS_ERR_MEMORY, good.bytes, good.least - 1);
    REFUSES(FXS_ERR_MEMORY, good.bytes, 0);
    const fxs_scene *s = &good.scene.scene;
    const fxs_context *context = &good.context;
    const fxs_camera *camera = &good.camera;
    const fxs_options *options = &good.options;
    void *memory = good.memory, *pixels = good.pixels;
    uint64_t pairs;
    const enum fxs_format rgba = FXS_FORMAT_RGBA8;
    CHECK(one_render(0, s, camera, options, rgba, memory, good.bytes, pixels, 80, 0) == FXS_ERR_ARGUMENT);
    CHECK(one_render(context, 0, camera, options, rgba, memory, good.bytes, pixels, 80, 0) == FXS_ERR_ARGUMENT);
    CHECK(fxs_render(context, 0, memory, good.bytes, 0) == FXS_ERR_ARGUMENT);
    CHECK(fxs_count_pairs(0, memory, good.bytes, &pairs, &pairs) == FXS_ERR_ARGUMENT);
    const fxs_object object = one_object(s);
    const fxs_targets targets = one_target(rgba, pixels, 80);
    for (uint32_t eyes = 0; eyes <= 3; eyes += 3) {
        fxs_request request = request_for(&object, 1, options, 1, camera, &targets);
        request.eyes = eyes;
        CHECK(fxs_render(context, &request, memory, good.bytes, 0) == FXS_ERR_ARGUMENT);
    }
    CHECK(one_render(context, s, camera, options, rgba, memory, good.bytes, 0, 80, 0) == FXS_ERR_TARGET);
    for (ptrdiff_t stride = -79; stride < 80; stride++)
        CHECK(one_render(context, s, camera, options, rgba, memory, good.bytes, pixels, stride, 0) == FXS_ERR_TARGET);
    CHECK(untouched(good.pixels, sizeof good.pixels));
    CHECK(one_count_pairs(s, camera, options, memory, good.bytes, 0, &pairs) == FXS_ERR_ARGUMENT);
    CHECK(one_count_pairs(s, camera, options, memory, good.bytes, &pairs, 0) == FXS_ERR_ARGUMENT);
    CHECK(render_good() == 0 && !untouched(good.pixels, sizeof good.pixels));
    free(good.scene.data);
    free(good.memory);
}

static void test_init(void)
{
    fxs_context context;
    fxs_config config = {.size = sizeof(fxs_config), .workers.count = 65};
    CHECK(fxs_context_init(0, 0) == FXS_ERR_ARGUMENT && fxs_context_init(&context, &config) == FXS_ERR_ARGUMENT);
    config.workers.count = 64;
    CHECK(fxs_context_init(&context, &config) == 0 && context.config.workers.count == 64);
}

static void test_words(void)
{
    for (int error = 0; error >= FXS_ERR_STOPPED; error--)
        for (int other = 0; other > error; other--)
            CHECK(strcmp(fxs_strerror(error), fxs_strerror(other)) != 0);
    CHECK(!strcmp(fxs_strerror(1), fxs_strerror(FXS_ERR_STRUCT - 1)) && fxs_strerror(INT32_MIN));
    CHECK(!strcmp(fxs_stage_name(FXS_PROJECT), "project") && !strcmp(fxs_stage_name(FXS_RESOLVE), "resolve"));
    CHECK(fxs_stage_name(FXS_STAGES) && fxs_stage_name((enum fxs_stage)-1));
}

/* Sizes that no version of the library has. */
static void test_sizes_of_structs(void)
{
    fxs_context context;
    fxs_object objects[2];
    fxs_request right;
    fxs_object_init(&objects[0], 0);
    fxs_object_init(&objects[1], 0);
    fxs_request_init(&right, objects, 2);
    CHECK(fxs_context_init(&context, &(fxs_config){.size = 0}) == FXS_ERR_STRUCT);
    CHECK(fxs_context_init(&context, &(fxs_config){.size = 65536}) == FXS_ERR_STRUCT);
    for (int i = 0; i < 6; i++) {
        fxs_request wrong = right, taken;
        uint32_t *const sizes[] = {&wrong.size, &wrong.targets[0].size, &wrong.targets[1].size, &wrong.options.size};
        *sizes[i % 4] = i < 4 ? 0 : 65535;
        CHECK(fxs_request_read(&taken, &wrong) == (i == 4 ? 0 : FXS_ERR_STRUCT));
    }
    fxs_request wrong = right, taken;
    CHECK(fxs_request_read(&taken, &right) == 0 && taken.options.sh_degree == 3);
    wrong.options.size += 8;
    CHECK(fxs_request_read(&taken, &wrong) == FXS_ERR_STRUCT);
    CHECK(fxs_request_read(&taken, 0) == FXS_ERR_ARGUMENT);
    fxs_object one;
    CHECK(fxs_object_read(&one, objects, 1) == 0);
    objects[1].size -= 8;
    CHECK(fxs_object_read(&one, objects, 1) == FXS_ERR_STRUCT && one.visible == 1);
}

int main(void)
{
    RUN(test_project_against_reference);
    RUN(test_project_needles);
    RUN(test_project_scattered);
    RUN(test_project_antialiased);
    RUN(test_culls);
    RUN(test_culls_at_near_planes);
    RUN(test_padding_and_opacity_0_are_never_drawn);
    RUN(test_depth_order);
    RUN(test_shade_against_reference);
    RUN(test_sort);
    RUN(test_lists_of_small_pictures);
    RUN(test_lists_of_narrow_pictures);
    RUN(test_lists_of_large_pictures);
    RUN(test_frame_equals_brute_force);
    RUN(test_narrow_frame_equals_brute_force);
    RUN(test_frame_at_near_planes_equals_brute_force);
    RUN(test_frame_in_runs_equals_brute_force);
    RUN(test_empty_scene_is_background);
    RUN(test_chunks_beside_the_picture);
    RUN(test_chunks_at_the_bound_of_their_reach);
    RUN(test_chunks_of_the_coarsest_units);
    RUN(test_chunks_across_the_near_plane);
    RUN(test_times_are_shared_out);
    RUN(test_near_plane_itself);
    RUN(test_squares_at_tile_edges);
    RUN(test_view_slopes);
    RUN(test_render_refuses_cameras);
    RUN(test_near_range);
    RUN(test_render_refuses_arguments);
    RUN(test_init);
    RUN(test_words);
    RUN(test_veils);
    RUN(test_sizes_of_structs);
    return check_report();
}
