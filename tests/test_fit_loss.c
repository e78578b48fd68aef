/* Compares the loss of the fit in every kernel version with a plain computation in doubles. Compares its gradient
   with central differences in doubles. */
#include "fit_loss.h"
#include "fit_scene.h"

enum { PLANES = 2 + FXS_FIT_ROWS + FXS_FIT_DERIVATIVES, MOST_ROWS = 32 };

typedef struct pictures {
    int width, height;
    double picture[FIT_LOSS_PIXELS];
    uint8_t photograph[3 * FIT_LOSS_PIXELS];
    int is_masked, has_exposure;
    uint8_t mask[FIT_LOSS_PIXELS];
    fxs_fit_loss loss;
    float *memory, absolute[MOST_ROWS], dissimilar[MOST_ROWS];
} pictures;

/* Makes a random picture and photograph that differ at every pixel, since |a - b| has no gradient at 0. */
static void make_pictures(pictures *p, int width, int height, double away)
{
    p->width = width;
    p->height = height;
    p->is_masked = p->has_exposure = 0;
    for (int i = 0; i < width * height; i++) {
        const double b = floor(fit_uniform(0, 256)), a = b + fit_uniform(-away, away);
        p->photograph[3 * i] = (uint8_t)b;
        p->picture[i] = (float)((fabs(a - b) < 0.1 ? b + 0.1 : a) / 255);
    }
}

static const uint8_t *mask_of(const pictures *p)
{
    return p->is_masked ? p->mask : NULL;
}

static int is_ignored(const pictures *p, int pixel)
{
    return p->is_masked && !p->mask[pixel];
}

static void make_mask(pictures *p, int rare)
{
    const double middle[2] = {fit_uniform(0, p->width), fit_uniform(0, p->height)};
    const double radius = fit_uniform(0, p->height);
    p->is_masked = 1;
    for (int i = 0; i < p->width * p->height; i++) {
        const double x = i % p->width - middle[0], y = i / p->width - middle[1];
        p->mask[i] = (uint8_t)(x * x + y * y < radius * radius || fit_random() % (unsigned)rare == 0
                                   ? 0 : 1 + fit_random() % 255);
    }
}

/* Makes a third of the photograph's pixels white. The picture is brighter or darker there. */
static void cut_white(pictures *p)
{
    p->has_exposure = 1;
    for (int i = 0; i < p->width * p->height; i++)
        if (fit_random() % 3 == 0) {
            p->photograph[3 * i] = 255;
            p->picture[i] = (float)(1 + (fit_random() % 2 ? 1 : -1) * fit_uniform(0.01, 0.3));
        }
}

static double seen_of(const pictures *p, int pixel)
{
    return p->has_exposure && p->photograph[3 * pixel] == 255 ? fmin(p->picture[pixel], 1) : p->picture[pixel];
}

static void make_planes(pictures *p)
{
    const ptrdiff_t stride = (p->width + 2 * FXS_FIT_MARGIN + FXS_FIT_TILE + 15) & ~15;
    const size_t plane = (size_t)stride * (size_t)(p->height + 2 * FXS_FIT_MARGIN);
    fxs_fit_plane planes[PLANES];
    p->memory = check_aligned(PLANES * plane * sizeof(float));
    if (!p->memory)
        abort();
    memset(p->memory, 0, PLANES * plane * sizeof(float));
    for (size_t i = 0; i < PLANES; i++)
        planes[i] = (fxs_fit_plane){p->memory + i * plane + FXS_FIT_MARGIN * stride + FXS_FIT_MARGIN, stride};
    p->loss = (fxs_fit_loss){.picture = planes[0], .gradient = planes[1], .absolute = p->absolute,
                             .dissimilar = p->dissimilar, .photograph = p->photograph, .step = 3,
                             .pitch = 3 * p->width, .width = p->width, .height = p->height,
                             .mask = mask_of(p), .has_exposure = p->has_exposure};
    memcpy(p->loss.rows, planes + 2, sizeof p->loss.rows);
    memcpy(p->loss.derivatives, planes + 2 + FXS_FIT_ROWS, sizeof p->loss.derivatives);
    for (int i = 0; i < p->width * p->height; i++)
        planes[0].first[i / p->width * stride + i % p->width] = (float)p->picture[i];
}

static void run_loss(pictures *p, const fxs_fit_stages *stages)
{
    make_planes(p);
    for (int32_t row = 0; row < p->height; row++)
        stages->loss_rows(&p->loss, row);
    for (int32_t row = 0; row < p->height; row++)
        stages->loss_derivatives(&p->loss, row);
    for (int32_t row = 0; row < p->height; row++)
        stages->loss_backward_rows(&p->loss, row);
    for (int32_t row = 0; row < p->height; row++)
        stages->loss_gradient(&p->loss, row);
}

static void free_planes(pictures *p)
{
    free(p->memory);
}

static double at_of(const fxs_fit_plane *plane, const pictures *p, int i)
{
    return (double)plane->first[i / p->width * plane->stride + i % p->width];
}

static double similarity_at(const pictures *p, int pixel)
{
    double window[FIT_WINDOW], mean[2] = {0}, variance[2] = {0}, covariance = 0;
    fit_window(window);
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < FIT_WINDOW * FIT_WINDOW; k++) {
            const int x = pixel % p->width + k % FIT_WINDOW - 5, y = pixel / p->width + k / FIT_WINDOW - 5;
            const int is_in = x >= 0 && y >= 0 && x < p->width && y < p->height &&
                              !is_ignored(p, y * p->width + x);
            const double weight = window[k % FIT_WINDOW] * window[k / FIT_WINDOW];
            const double a = is_in ? seen_of(p, y * p->width + x) : 0;
            const double b = is_in ? p->photograph[3 * (y * p->width + x)] / 255.0 : 0;
            mean[0] += pass ? 0 : weight * a;
            mean[1] += pass ? 0 : weight * b;
            variance[0] += pass ? weight * (a - mean[0]) * (a - mean[0]) : 0;
            variance[1] += pass ? weight * (b - mean[1]) * (b - mean[1]) : 0;
            covariance += pass ? weight * (a - mean[0]) * (b - mean[1]) : 0;
        }
    return (2 * mean[0] * mean[1] + 1e-4) * (2 * covariance + 9e-4) /
           ((mean[0] * mean[0] + mean[1] * mean[1] + 1e-4) * (variance[0] + variance[1] + 9e-4));
}

static void check_pictures(pictures *p, const fxs_fit_stages *stages)
{
    run_loss(p, stages);
    for (int row = 0; row < p->height; row++) {
        double absolute = 0, dissimilar = 0;
        for (int i = row * p->width; i < (row + 1) * p->width; i++) {
            absolute += is_ignored(p, i) ? 0 : fabs(seen_of(p, i) - p->photograph[3 * i] / 255.0);
            dissimilar += is_ignored(p, i) ? 0 : 1 - similarity_at(p, i);
        }
        /* Tolerances of two sums over a row: absolute differences and 1 - SSIM. In single precision the mean squares
           have an error of 1e-7. SSIM divides them by numbers down to its constant c2 = 9e-4. */
        CHECK(fabs((double)p->absolute[row] - absolute) < 1e-6 * p->width);
        CHECK(fabs((double)p->dissimilar[row] - dissimilar) < 3e-4 * p->width);
    }
    for (int i = 0; i < p->width * p->height; i++) {
        const double kept = p->picture[i], h = 1e-6;
        p->picture[i] = kept + h;
        const double above = fit_loss(p->picture, p->photograph, mask_of(p), p->has_exposure, p->width,
                                      p->height);
        p->picture[i] = kept - h;
        const double below = fit_loss(p->picture, p->photograph, mask_of(p), p->has_exposure, p->width,
                                      p->height);
        p->picture[i] = kept;
        const double wanted = (above - below) / (2 * h), found = at_of(&p->loss.gradient, p, i);
        if (!CHECK(fabs(found - wanted) < 1e-4 * (1 + fabs(wanted))) || !CHECK(!is_ignored(p, i) || found == 0))
            printf("  %s, %dx%d, pixel %d: %g, by differences %g\n", stages->name, p->width, p->height, i, found,
                   wanted);
    }
}

static void check_versions(pictures *p)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    static float gradient[FIT_LOSS_PIXELS], sums[2][MOST_ROWS];
    const size_t rows = (size_t)p->height * sizeof(float);
    const int count = fit_versions(versions);
    check_pictures(p, versions[0]);
    for (int i = 0; i < p->width * p->height; i++)
        gradient[i] = (float)at_of(&p->loss.gradient, p, i);
    memcpy(sums[0], p->absolute, rows);
    memcpy(sums[1], p->dissimilar, rows);
    free_planes(p);
    for (int v = 1; v < count; v++) {
        run_loss(p, versions[v]);
        for (int i = 0; i < p->width * p->height; i++)
            if (!CHECK((float)at_of(&p->loss.gradient, p, i) == gradient[i]))
                printf("  %s, %dx%d, pixel %d\n", versions[v]->name, p->width, p->height, i);
        CHECK(!memcmp(sums[0], p->absolute, rows) && !memcmp(sums[1], p->dissimilar, rows));
        free_planes(p);
    }
}

static void test_random_pictures(void)
{
    static const int sizes[][2] = {{1, 1}, {1, 9}, {7, 1}, {5, 5}, {11, 4}, {16, 16}, {17, 12}, {33, 15}};
    static pictures p;
    fit_state = 1;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int far = 0; far < 2; far++) {
            make_pictures(&p, sizes[i][0], sizes[i][1], far ? 100 : 4);
            check_versions(&p);
        }
}

static void test_masks(void)
{
    static const int sizes[][2] = {{1, 1}, {7, 5}, {17, 12}, {33, 15}};
    static pictures p;
    fit_state = 2;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int k = 0; k < 4; k++) {
            make_pictures(&p, sizes[i][0], sizes[i][1], k % 2 ? 100 : 4);
            make_mask(&p, k < 2 ? 3 : 1000);
            check_versions(&p);
        }
}

static void test_cut_white(void)
{
    static const int sizes[][2] = {{1, 1}, {7, 5}, {17, 12}, {33, 15}};
    static pictures p;
    fit_state = 5;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int k = 0; k < 4; k++) {
            make_pictures(&p, sizes[i][0], sizes[i][1], k % 2 ? 100 : 4);
            if (k < 2)
                make_mask(&p, 5);
            cut_white(&p);
            check_versions(&p);
        }
}

typedef struct outcome {
    float gradient[FIT_LOSS_PIXELS], absolute[MOST_ROWS], dissimilar[MOST_ROWS];
} outcome;

static void find_outcome(pictures *p, const fxs_fit_stages *stages, int width, outcome *out)
{
    memset(out, 0, sizeof *out);
    run_loss(p, stages);
    for (int i = 0; i < p->width * p->height; i++)
        if (i % p->width < width)
            out->gradient[i / p->width * width + i % p->width] = (float)at_of(&p->loss.gradient, p, i);
    memcpy(out->absolute, p->absolute, (size_t)p->height * sizeof *p->absolute);
    memcpy(out->dissimilar, p->dissimilar, (size_t)p->height * sizeof *p->dissimilar);
    free_planes(p);
}

static void test_ignored_pixels(void)
{
    enum { WIDE = 61, HIGH = 29 };
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    static pictures p, other;
    static outcome wanted, found;
    fit_state = 3;
    make_pictures(&p, WIDE, HIGH, 40);
    make_mask(&p, 5);
    other = p;
    for (int i = 0; i < WIDE * HIGH; i++)
        if (is_ignored(&p, i)) {
            other.photograph[3 * i] = (uint8_t)fit_random();
            other.picture[i] = (float)fit_uniform(0, 100);
        }
    for (int v = 0; v < count; v++) {
        find_outcome(&p, versions[v], WIDE, &wanted);
        find_outcome(&other, versions[v], WIDE, &found);
        CHECK(!memcmp(&wanted, &found, sizeof wanted));
    }
    other = p;
    other.is_masked = 0;
    memset(p.mask, 1, sizeof p.mask);
    for (int v = 0; v < count; v++) {
        find_outcome(&p, versions[v], WIDE, &wanted);
        find_outcome(&other, versions[v], WIDE, &found);
        CHECK(!memcmp(&wanted, &found, sizeof wanted));
    }
}

static void test_brighter_than_white(void)
{
    enum { WIDE = 61, HIGH = 29 };
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    static pictures p, other;
    static outcome wanted, found;
    fit_state = 6;
    make_pictures(&p, WIDE, HIGH, 40);
    cut_white(&p);
    other = p;
    for (int i = 0; i < WIDE * HIGH; i++)
        if (p.photograph[3 * i] == 255 && p.picture[i] > 1)
            other.picture[i] = (float)fit_uniform(1.001, 100);
    for (int v = 0; v < count; v++) {
        find_outcome(&p, versions[v], WIDE, &wanted);
        find_outcome(&other, versions[v], WIDE, &found);
        CHECK(!memcmp(&wanted, &found, sizeof wanted));
        for (int i = 0; i < WIDE * HIGH; i++)
            if (p.photograph[3 * i] == 255)
                CHECK((wanted.gradient[i] == 0) == (p.picture[i] > 1));
    }
    for (int i = 0; i < WIDE * HIGH; i++)
        if (p.photograph[3 * i] == 255)
            p.photograph[3 * i] = 254;
    other = p;
    other.has_exposure = 0;
    for (int v = 0; v < count; v++) {
        find_outcome(&p, versions[v], WIDE, &wanted);
        find_outcome(&other, versions[v], WIDE, &found);
        CHECK(!memcmp(&wanted, &found, sizeof wanted));
    }
}

static void test_mask_of_an_edge(void)
{
    enum { WIDE = 40, HIGH = 20, LEFT = 23 };
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    static pictures p, narrow;
    static outcome wanted, found;
    fit_state = 4;
    make_pictures(&p, WIDE, HIGH, 40);
    make_pictures(&narrow, LEFT, HIGH, 40);
    p.is_masked = 1;
    for (int i = 0; i < WIDE * HIGH; i++) {
        p.mask[i] = i % WIDE < LEFT;
        if (p.mask[i]) {
            p.photograph[3 * i] = narrow.photograph[3 * (i / WIDE * LEFT + i % WIDE)];
            p.picture[i] = narrow.picture[i / WIDE * LEFT + i % WIDE];
        }
    }
    for (int v = 0; v < count; v++) {
        find_outcome(&p, versions[v], LEFT, &found);
        find_outcome(&narrow, versions[v], LEFT, &wanted);
        CHECK(!memcmp(&wanted, &found, sizeof wanted));
    }
}

static void test_flat_pictures(void)
{
    static pictures p;
    for (int black = 0; black < 2; black++) {
        make_pictures(&p, 14, 13, 0);
        for (int i = 0; i < 14 * 13; i++) {
            p.photograph[3 * i] = black ? 0 : 200;
            p.picture[i] = black ? (float)0.01 : (float)0.75;
        }
        check_versions(&p);
    }
}

static void test_same_picture(void)
{
    static pictures p;
    make_pictures(&p, 19, 14, 0);
    for (int i = 0; i < 19 * 14; i++)
        p.picture[i] = (double)((float)p.photograph[3 * i] / 255.0f);
    run_loss(&p, fxs_fit_stages_choose(0));
    for (int i = 0; i < 19 * 14; i++)
        CHECK(fabs(at_of(&p.loss.gradient, &p, i)) < 1e-4);
    for (int row = 0; row < 14; row++)
        CHECK(p.absolute[row] == 0 && fabs((double)p.dissimilar[row]) < 1e-5 * 19);
    free_planes(&p);
}

int main(void)
{
    RUN(test_random_pictures);
    RUN(test_masks);
    RUN(test_cut_white);
    RUN(test_ignored_pixels);
    RUN(test_brighter_than_white);
    RUN(test_mask_of_an_edge);
    RUN(test_flat_pictures);
    RUN(test_same_picture);
    return check_report();
}
