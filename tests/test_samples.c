/* Tests the mean of pictures in linear light, and the points of a lens. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "tools/command/samples.h"

static light_codes codes;

static uint8_t mean_of(int first, int first_count, int rest, int samples)
{
    uint32_t sum[1];
    uint8_t code, mean;
    const light_sums sums = {sum, 1};
    for (int i = 0; i < samples; i++) {
        code = (uint8_t)(i < first_count ? first : rest);
        light_add(&(light_sums){sum, 1}, &codes, &code, 0, 1, i);
    }
    light_mean(&sums, &codes, samples, 0, 1, &mean);
    return mean;
}

static void equal_pictures(void)
{
    for (int srgb = 0; srgb < 2; srgb++) {
        light_codes_make(&codes, srgb);
        for (int code = 0; code < 256; code++)
            CHECK(mean_of(code, 0, code, 2) == code && mean_of(code, 0, code, 1023) == code);
    }
    CHECK(mean_of(255, 0, 255, 1024) == 255);
}

/* The expected code is the one whose light is nearest to the mean's light, in doubles. */
static void mean_is_nearest(void)
{
    double light[256];
    light_codes_make(&codes, 1);
    for (int i = 0; i < 256; i++)
        light[i] = i > 10 ? pow((i / 255.0 + 0.055) / 1.055, 2.4) : i / 255.0 / 12.92;
    for (int a = 0; a < 256; a += 5)
        for (int part = 0; part <= 7; part++) {
            const double wanted = (part * light[a] + (7 - part) * light[200]) / 7;
            const int got = mean_of(a, part, 200, 7);
            for (int other = got - 1; other <= got + 1; other += 2)
                CHECK(other < 0 || other > 255 || fabs(light[got] - wanted) < fabs(light[other] - wanted) + 2e-5);
        }
    CHECK(mean_of(255, 1, 0, 2) == 188);
    light_codes_make(&codes, 0);
    CHECK(mean_of(255, 1, 0, 2) == 128 && mean_of(3, 1, 0, 2) == 2 && mean_of(1, 1, 0, 3) == 0);
}

/* Projects the point at x, y, z of the first camera's axes into a view at `position` along these axes. */
static void project(const fxs_view *view, const double position[3], const double point[3], double pixel[2])
{
    pixel[0] = view->cx + view->fx * (point[0] - position[0]) / (point[2] - position[2]);
    pixel[1] = view->cy + view->fy * (point[1] - position[1]) / (point[2] - position[2]);
}

static void lens(void)
{
    enum { SAMPLES = 100 };
    const double near[3] = {0.7, -0.3, 4}, far[3] = {0.7, -0.3, 8}, aperture = 0.5;
    const fxs_view first = {.width = 640, .height = 480, .fx = 500, .fy = 510, .cx = 300, .cy = 250,
                            .rotation = {0, 1, 0, 0, 0, 1, 1, 0, 0}, .position = {5, 6, 7}};
    double middle[2] = {0}, wanted[2], got[2], widest = 0, seen[SAMPLES][2];
    project(&first, (double[3]){0}, near, wanted);
    for (int i = 0; i < SAMPLES; i++) {
        fxs_view view = first;
        lens_move(&view, aperture, 4, i, SAMPLES);
        const double at[3] = {view.position[1] - 6, view.position[2] - 7, view.position[0] - 5};
        project(&view, at, near, got);
        CHECK(fabs(got[0] - wanted[0]) < 1e-9 && fabs(got[1] - wanted[1]) < 1e-9);
        CHECK(sqrt(at[0] * at[0] + at[1] * at[1]) < aperture / 2 && fabs(at[2]) < 1e-12);
        project(&view, at, far, got);
        widest = fmax(widest, fabs(got[0] - first.cx - 500 * 0.7 / 8));
        memcpy(seen[i], at, sizeof seen[i]);
        for (int k = 0; k < i; k++)
            CHECK(hypot(at[0] - seen[k][0], at[1] - seen[k][1]) > 0.5 * aperture / 2 / sqrt(SAMPLES));
        middle[0] += at[0] / SAMPLES;
        middle[1] += at[1] / SAMPLES;
    }
    /* A point twice as far as the focus moves by f * aperture / 2 * (1 / 4 - 1 / 8). */
    CHECK(widest > 0.9 * 500 * 0.25 / 8 && widest < 500 * 0.25 / 8);
    CHECK(hypot(middle[0], middle[1]) < 0.01 * aperture);
}

int main(void)
{
    RUN(equal_pictures);
    RUN(mean_is_nearest);
    RUN(lens);
    return check_report();
}
