/* Tests the sky of a fit: where the sky begins, and that distant Gaussians are treated like near Gaussians of the
   same apparent size. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fit.h>
#include <fixsplat/internal/fit_more.h>
#include "src/fit/fit_internal.h"
#include "src/fit/sky.h"
#include "fit_scene.h"

enum { PHOTOS = 8, POINTS = 12000, DIRECTIONS = 5000, WIDTH = 64, HEIGHT = 48 };

static fxs_message message;
static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[POINTS];
static uint8_t pixels[3 * WIDTH * HEIGHT], mask[WIDTH * HEIGHT];
static fxs_fit_sky sky;

static const double middle[3] = {3, -2, 7};

/* Aims camera i along the horizon with a field of view of 90 degrees, from `aside` units right of the middle. */
static void aim(int i, double angle, double aside)
{
    const double c = cos(angle), s = sin(angle), rotation[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
    fxs_view *v = &photos[i].view;
    memset(&photos[i], 0, sizeof photos[i]);
    v->width = WIDTH, v->height = HEIGHT;
    v->fx = v->fy = WIDTH / 2.0;
    v->cx = WIDTH / 2.0, v->cy = HEIGHT / 2.0;
    memcpy(v->rotation, rotation, sizeof rotation);
    for (int k = 0; k < 3; k++)
        v->position[k] = middle[k] + aside * rotation[k];
    photos[i].pixels = pixels;
}

static void paint(void)
{
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        pixels[3 * i + 1] = i < WIDTH * HEIGHT / 2 ? 20 : 100;
        pixels[3 * i + 2] = i < WIDTH * HEIGHT / 2 ? 200 : 0;
    }
}

/* Makes points on the ground: 1 to 9 units away, 6 to 60 degrees below the horizon. The last 1/50 of the points
   are 500 units away. */
static void lay_ground(void)
{
    for (int i = 0; i < POINTS; i++) {
        const double angle = fit_uniform(0, 6.2831853), down = fit_uniform(0.105, 1.047);
        const double away = i < POINTS - POINTS / 50 ? 1 + 8.0 * i / POINTS : 500;
        points[i].position[0] = (float)(middle[0] + away * cos(down) * sin(angle));
        points[i].position[1] = (float)(middle[1] + away * sin(down));
        points[i].position[2] = (float)(middle[2] + away * cos(down) * cos(angle));
    }
}

static void find(size_t photo_count, const fxs_fit_point *from, size_t count, uint32_t directions)
{
    free(sky.points);
    CHECK(!fxs_fit_sky_find(photos, photo_count, from, count, directions, 2, &sky));
}

static void direction(uint32_t i, double d[3])
{
    const double turn = 3.14159265358979324 * (3 - sqrt(5.0)) * i;
    d[1] = 1 - (2 * i + 1.0) / DIRECTIONS;
    d[0] = sqrt(1 - d[1] * d[1]) * cos(turn);
    d[2] = sqrt(1 - d[1] * d[1]) * sin(turn);
}

static int is_seen(const double d[3], int count, double margin)
{
    for (int i = 0; i < count; i++) {
        const double angle = atan2(d[0], d[2]) - i * 0.7853981633974483, depth = hypot(d[0], d[2]) * cos(angle);
        if (depth > 0 && fabs(hypot(d[0], d[2]) * sin(angle)) < (1 - margin) * depth &&
            fabs(d[1]) < (0.75 - margin) * depth)
            return 1;
    }
    return 0;
}

static void above_the_ground(void)
{
    const double radius = 1000 * (1 + 8 * 0.95);
    size_t at = 0, missing = 0, wrong = 0, seen = 0;
    for (int i = 0; i < PHOTOS; i++)
        aim(i, i * 0.7853981633974483, 0);
    find(5, points, POINTS, DIRECTIONS);
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
        double d[3], off = 0;
        direction(i, d);
        seen += (size_t)is_seen(d, 5, 0);
        for (int k = 0; k < 3 && at < sky.count; k++)
            off += fabs(((double)sky.points[at].position[k] - middle[k]) / radius - d[k]);
        const int is_there = at < sky.count && off < 0.02;
        missing += !is_there && d[1] < -0.07 && is_seen(d, 5, 0.01);
        wrong += is_there && (d[1] > -0.03 + 0.105 || !is_seen(d, 5, -0.01));
        if (is_there && d[1] < -0.01)
            wrong += sky.points[at].colour[0] != 0 || sky.points[at].colour[1] != 20 || sky.points[at].colour[2] != 200;
        at += (size_t)is_there;
    }
    CHECK(at == sky.count && sky.count > seen / 3 && sky.count < 2 * seen / 3 && !missing && !wrong);
    CHECK(fabs((double)sky.far.middle[1] - middle[1]) < 1e-6 && sky.far.inverse == 0.5f);
}

static void is_even(void)
{
    double worst = 0, best = INFINITY;
    static const fxs_fit_point behind = {{3, -2, -100}, {0}};
    find(PHOTOS, &behind, 1, 2000);
    CHECK(sky.count > 800);
    for (size_t i = 0; i < sky.count; i++) {
        double nearest = INFINITY;
        for (size_t j = 0; j < sky.count; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++)
                square += pow((double)sky.points[i].position[k] - (double)sky.points[j].position[k], 2);
            nearest = j == i ? nearest : fmin(nearest, sqrt(square));
        }
        worst = fmax(worst, nearest);
        best = fmin(best, nearest);
    }
    CHECK(best > 1.4 * (double)sky.sigma && worst < 2.2 * (double)sky.sigma);
}

static void is_the_same_everywhere(void)
{
    uint64_t hash = 0xcbf29ce484222325u;
    find(5, points, 1000, DIRECTIONS);
    for (size_t i = 0; i < sky.count; i++) {
        uint32_t words[3];
        memcpy(words, sky.points[i].position, sizeof words);
        for (int k = 0; k < 3; k++)
            hash = (hash ^ words[k] ^ (uint64_t)sky.points[i].colour[k] << 32) * 0x100000001b3u;
    }
    if (!CHECK(hash == 0xeaba5abfdf8d1482u))
        printf("  %016llx\n", (unsigned long long)hash);
}

/* Counts the sky points that are found within 1.7 degrees of straight ahead. */
static int ahead(size_t count, const fxs_fit_point *from, size_t point_count)
{
    int n = 0;
    find(count, from, point_count, 4 * DIRECTIONS);
    for (size_t i = 0; i < sky.count; i++) {
        const float *p = sky.points[i].position;
        n += hypot((double)p[0] - middle[0], (double)p[1] - middle[1]) < 0.03 * ((double)p[2] - middle[2]);
    }
    return n;
}

/* A direction is sky if most of the photographs have no point in front of it: here 1 of 3, then 2. */
static void most_photographs_decide(void)
{
    fxs_fit_point before[2] = {{{3, -2, 17}, {0}}, {{8, -2, 17}, {0}}};
    aim(0, 0, -5), aim(1, 0, 0), aim(2, 0, 5);
    CHECK(ahead(3, before, 2) == 0);
    before[1].position[1] = -7;
    CHECK(ahead(3, before, 2) > 2);
    CHECK(ahead(2, before, 2) == 0);    /* one of two photographs is no majority, so the direction is no sky */
}

static void masked(void)
{
    static const fxs_fit_point behind = {{3, -2, -100}, {0}};
    aim(0, 0, 0);
    CHECK(ahead(1, &behind, 1) > 2);
    const size_t all = sky.count / 4;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        mask[i] = i % WIDTH >= WIDTH / 2;
    photos[0].mask = mask;
    find(1, &behind, 1, DIRECTIONS);
    for (size_t i = 0; i < sky.count; i++)
        CHECK((double)sky.points[i].position[0] > middle[0]);
    CHECK(sky.count > all * 2 / 5 && sky.count < all * 3 / 5);
    memset(mask, 0, sizeof mask);
    find(1, &behind, 1, DIRECTIONS);
    CHECK(!sky.count);
}

/* Checks the colours of sky points. A point hides the sky from the third photograph, which must not count. */
static void mean_colour(void)
{
    static uint8_t shades[3][sizeof pixels];
    static const fxs_fit_point before = {{8, -2, 17}, {0}};
    static const uint8_t values[] = {10, 21, 200};
    for (int i = 0; i < 3; i++) {
        aim(i, 0, i < 2 ? 0 : 5);
        memset(shades[i], values[i], sizeof shades[i]);
        photos[i].pixels = shades[i];
    }
    CHECK(ahead(3, &before, 1) > 2);
    for (size_t i = 0; i < sky.count; i++) {
        const float *p = sky.points[i].position;
        if (hypot((double)p[0] - middle[0], (double)p[1] - middle[1]) < 0.03 * ((double)p[2] - middle[2]))
            CHECK(sky.points[i].colour[0] == 16 && sky.points[i].colour[2] == 16);
    }
}

static float *at(const fxs_fit_model *m, int plane, size_t i)
{
    return &m->parameters[(size_t)plane * m->stride + i];
}

/* Makes Gaussians near and far. Gaussian 0 lies within the radius of the scene, 1 at the radius. Gaussian 2 is
   eight times as far and as large as 1. */
static fxs_fit_model at_distances(void)
{
    static const float distances[] = {1, 2, 16, 1}, sizes[] = {0.25f, 0.25f, 2, 2};
    fxs_fit_model m;
    CHECK(!fxs_fit_model_room(&m, 4));
    for (size_t i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            *at(&m, FXS_FIT_POSITION + k, i) = k ? (float)k : 3 + distances[i];
            *at(&m, FXS_FIT_SCALE + k, i) = logf(sizes[i]);
        }
        *at(&m, FXS_FIT_ROTATION, i) = 1;
        *at(&m, FXS_FIT_OPACITY, i) = -4;
    }
    return m;
}

static const fxs_fit_far of_two = {{3, 1, 2}, 0.5f}, nowhere;

static int is_near(float a, float b)
{
    return fabs((double)a - (double)b) <= 1e-5 * fabs((double)b);
}

static void mean_scale(const fxs_fit_stages *stages)
{
    static const float sums[FXS_FIT_SUMS][FXS_FIT_PART];
    const fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .focal = {50, 50}, .width = 40,
                                   .height = 40};
    const fxs_fit_camera *looking = &camera;
    for (int is_far = 0; is_far < 2; is_far++) {
        fxs_fit_adam a = {.correction = 1, .epsilon = 1, .by_opacity = 1, .by_scale = 10};
        fxs_fit_model m = at_distances();
        a.far = is_far ? of_two : nowhere;
        stages->update(&looking, 1, 0, &a, m.parameters, m.parameters, m.means, m.squares, m.stride, 0, m.stride,
                       sums[0], 0, m.by_centre);
        for (size_t i = 0; i < 4; i++)
            for (size_t k = FXS_FIT_SCALE; k < FXS_FIT_SCALE + 3; k++)
                CHECK(is_near(m.means[k * m.stride + i], i < 2 || (is_far && i == 2) ? 0.25f : 2));
        fxs_fit_model_free(&m);
    }
}

/* Checks the random moves of a fit. A Gaussian at eight times the distance and size must move eight times as
   far. */
static void noise(const fxs_fit_stages *stages)
{
    float ways[2][4];
    for (int is_far = 0; is_far < 2; is_far++) {
        const fxs_fit_noise n = {0.01f, {7, 8}, is_far ? of_two : nowhere};
        fxs_fit_model m = at_distances(), old = at_distances();
        stages->noise(&n, m.parameters, m.stride, 0, m.stride);
        for (size_t i = 0; i < 4; i++)
            ways[is_far][i] = *at(&m, FXS_FIT_POSITION + 1, i) - *at(&old, FXS_FIT_POSITION + 1, i);
        fxs_fit_model_free(&m);
        fxs_fit_model_free(&old);
    }
    for (size_t i = 0; i < 4; i++)
        CHECK(ways[0][i] != 0 && fabs((double)(ways[1][i] * (i == 2 ? 8 : 1) / ways[0][i]) - 1) < 1e-4);
}

static void fates(void)
{
    for (int is_far = 0; is_far < 2; is_far++) {
        fxs_fit_densify d = {0.0002f, 0.1f, 0.5f, 0.005f, 100, is_far ? of_two : nowhere};
        fxs_fit_model m = at_distances();
        CHECK(!fxs_fit_model_densify(&m, &d) && m.count == (is_far ? 3u : 2u));
        fxs_fit_model_free(&m);
        m = at_distances();
        d.large = INFINITY;
        d.small = 1;
        for (size_t i = 0; i < 4; i++)
            m.by_centre[i] = m.views[i] = 1;
        CHECK(!fxs_fit_model_densify(&m, &d) && m.count == 8);
        CHECK(is_near(*at(&m, FXS_FIT_SCALE, 2), is_far ? logf(2) : logf(0.25f)));
        fxs_fit_model_free(&m);
    }
}

static void sizes(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    for (int i = 0; i < count; i++) {
        mean_scale(versions[i]);
        noise(versions[i]);
    }
    fates();
}

static void begins_a_fit(void)
{
    fxs_fit_options options;
    fxs_fit *fit;
    fxs_gaussian_source source;
    fxs_gaussian last;
    for (int i = 0; i < PHOTOS; i++)
        aim(i, i * 0.7853981633974483, i % 2);
    fxs_fit_options_init(&options);
    find(PHOTOS, points, POINTS, DIRECTIONS);
    options.sky = DIRECTIONS;
    options.extent = 2;
    if (CHECK(!fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message))) {
        CHECK(fxs_fit_sky_count(fit) == sky.count && sky.count > 1000);
        CHECK(!memcmp(&fit->far, &sky.far, sizeof sky.far));
        CHECK(!fxs_fit_gaussians(fit, &source, &message) && source.count == POINTS + sky.count);
        CHECK(source.read(source.argument, source.count - 1, &last, 1) == 1);
        CHECK(!memcmp(last.position, sky.points[sky.count - 1].position, sizeof last.position));
        CHECK(fabs((double)last.scale[1] - log((double)sky.sigma)) < 1e-5);
        CHECK(source.read(source.argument, POINTS - 1, &last, 1) == 1);
        CHECK(!memcmp(last.position, points[POINTS - 1].position, sizeof last.position) && last.scale[1] < 5);
        fxs_fit_destroy(fit);
    }
    options.max_gaussians = (POINTS + sky.count) / 4;
    if (CHECK(!fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message))) {
        CHECK(labs((long)fxs_fit_sky_count(fit) - (long)sky.count / 4) < 2);
        fxs_fit_destroy(fit);
    }
    options.sky = FXS_FIT_SKY_MOST + 1;
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT && !fit);
    options.sky = 1;
    options.block = options.blocks = 1;
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "coarse"));
}

int main(void)
{
    paint();
    lay_ground();
    RUN(above_the_ground);
    RUN(is_even);
    RUN(is_the_same_everywhere);
    RUN(most_photographs_decide);
    RUN(masked);
    RUN(mean_colour);
    RUN(sizes);
    RUN(begins_a_fit);
    free(sky.points);
    return check_report();
}
