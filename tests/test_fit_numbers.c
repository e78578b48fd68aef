/* Compares the elementary functions of the fit with the C library over their whole range, and the optimiser with
   Adam in doubles. */
#include "src/base/exponential.h"
#include "src/fit/stages/exposure.h"
#include "fit_scene.h"

static float number(int exponent, int is_negative)
{
    const float x = (float)ldexp(1 + (double)(fit_random() >> 41) * 0x1p-23, exponent);
    return is_negative ? -x : x;
}

static void check_relative(const char *name, float x, float found, double wanted, double most)
{
    if (!CHECK(fabs((double)found - wanted) <= most * fabs(wanted)))
        printf("  %s(%.9g): %.9g, not %.9g\n", name, (double)x, (double)found, wanted);
}

/* Tests the exponential. Its tolerance grows with the argument. */
static void test_exponentials(void)
{
    fit_state = 1;
    for (int i = 0; i < 300 * 160; i++) {
        const float x = number(i % 160 - 153, i & 256);
        if (x > -127.5f && x <= 126)
            check_relative("exp_2_minus", x, exp_2_minus(x), exp2(-(double)x), 3e-7);
        if (x >= -87 && x <= 88)
            check_relative("exp_e", x, exp_e(x), exp((double)x), 3e-7 + 9e-8 * fabs((double)x));
    }
    for (int n = -126; n <= 127; n++)
        CHECK(exp_2_minus((float)-n) == ldexpf(1, n));
    for (float x = -87; x <= 88; x += 0.0137f)
        check_relative("exp_e", x, exp_e(x), exp((double)x), 3e-7 + 9e-8 * fabs((double)x));
}

static void test_logarithm(void)
{
    fit_state = 2;
    for (int i = 0; i < 200 * 254; i++) {
        const float x = number(i % 254 - 126, 0);
        check_relative("ln", x, ln(x), log((double)x), 2.3e-7);
    }
    /* The logarithm must have a small relative error also near x = 1, where its value is near 0. */
    for (int i = 0; i < 5000; i++) {
        const float x = 1 + number(-2 - i % 22, i & 1024);
        check_relative("ln", x, ln(x), log((double)x), 2.3e-7);
    }
    CHECK(ln(1.0f) == 0);
}

static void test_doubles(void)
{
    fit_state = 6;
    for (int i = 0; i < 100000; i++) {
        const double x = fit_uniform(-745, 709.7), y = ldexp(fit_uniform(0.5, 1), (int)(fit_random() % 2000) - 1000);
        const long double e = expl((long double)x), l = logl((long double)y);
        CHECK(fabsl((long double)fxs_exp(x) - e) <= 4e-16L * e + 0x1p-1074L);
        CHECK(fabsl((long double)fxs_log(y) - l) <= 4e-16L * fabsl(l));
    }
    for (int n = -1074; n < 1024; n++)
        CHECK(fabs(fxs_log(ldexp(1, n)) - n * 0.69314718055994531) <= 3e-16 * fabs(n * 0.69314718055994531));
    CHECK(fxs_exp(0) == 1 && fxs_log(1) == 0 && fxs_exp(-800) == 0 && isinf(fxs_exp(800)) && isinf(fxs_exp(INFINITY)));
    CHECK(isnan(fxs_exp(NAN)) && isnan(fxs_log(NAN)) && isnan(fxs_log(-1)) && fxs_log(0) == -INFINITY);
}

enum { WIDTH = 32, HEIGHT = 24, COUNT = 20, STEPS = 300, PHOTOGRAPHS = 3 };

typedef struct adam {
    double mean, square, parameter, way;
} adam;

static void reference_step(adam *a, double gradient, double rate, int step)
{
    const double g = gradient / (3 * WIDTH * HEIGHT);
    a->mean = 0.9 * a->mean + 0.1 * g;
    a->square = 0.999 * a->square + 0.001 * g * g;
    const double by = rate * (a->mean / (1 - pow(0.9, step))) / (sqrt(a->square / (1 - pow(0.999, step))) + 1e-15);
    a->parameter -= by;
    a->way += fabs(by);
}

static void make_model(fxs_fit_model *m, const fxs_fit_camera *camera)
{
    if (fxs_fit_model_room(m, COUNT))
        abort();
    for (size_t i = 0; i < COUNT; i++) {
        float *at = m->parameters + i;
        for (size_t k = 0; k < 3; k++) {
            const float aside = (float)fit_uniform(-1, 1);
            at[(FXS_FIT_POSITION + k) * m->stride] = camera->eye[k] + 3 * camera->rotation[6 + k] + aside;
            at[(FXS_FIT_SCALE + k) * m->stride] = (float)fit_uniform(-2.5, -1);
            at[(FXS_FIT_ROTATION + k) * m->stride] = (float)fit_uniform(-1, 1);
            at[(FXS_FIT_COLOUR + k) * m->stride] = (float)fit_uniform(0, 1);
        }
        at[FXS_FIT_OPACITY * m->stride] = (float)fit_uniform(-2, 2);
    }
}

static void test_steps_are_adams(void)
{
    static uint8_t pixels[PHOTOGRAPHS][3 * WIDTH * HEIGHT];
    static adam reference[FXS_FIT_PARAMETERS * COUNT];
    fxs_fit_photograph photographs[PHOTOGRAPHS];
    fxs_fit_model m;
    fxs_fit_report report;
    fxs_fit_stepper *stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), NULL, NULL, 1, NULL);
    fit_state = 4;
    for (int i = 0; i < PHOTOGRAPHS; i++) {
        for (int k = 0; k < 3 * WIDTH * HEIGHT; k++)
            pixels[i][k] = (uint8_t)fit_random();
        photographs[i] = (fxs_fit_photograph){pixels[i], WIDTH, HEIGHT, 1, fit_camera(WIDTH, HEIGHT, 25), 0, NULL};
        photographs[i].camera.eye[i] += 1;
    }
    make_model(&m, &photographs[0].camera);
    for (size_t i = 0; i < FXS_FIT_PARAMETERS * COUNT; i++)
        reference[i] = (adam){0, 0, (double)m.parameters[i / COUNT * m.stride + i % COUNT], 0};
    for (int step = 1; step <= STEPS; step++) {
        static float before[FXS_FIT_PARAMETERS * COUNT];
        fxs_fit_step_options options = {.sh_degree = step / 80, .number = (uint32_t)step};
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            options.rate[k] = 1e-4f * (float)(1 + k % 7);
        for (size_t i = 0; i < FXS_FIT_PARAMETERS * COUNT; i++)
            before[i] = m.means[i / COUNT * m.stride + i % COUNT];
        CHECK(fxs_fit_stepper_step(stepper, &m, &photographs[step % PHOTOGRAPHS], 1, &options, &report) == 0);
        for (size_t i = 0; i < FXS_FIT_PARAMETERS * COUNT; i++) {
            const double mean = (double)m.means[i / COUNT * m.stride + i % COUNT];
            reference_step(&reference[i], (mean - 0.9 * (double)before[i]) / 0.1, (double)options.rate[i / COUNT],
                           step);
        }
    }
    double way = 0;
    for (size_t i = 0; i < FXS_FIT_PARAMETERS * COUNT; i++) {
        const adam *a = &reference[i];
        const double found = (double)m.parameters[i / COUNT * m.stride + i % COUNT];
        if (!CHECK(fabs(found - a->parameter) < 1e-5 * a->way + 1e-7 * STEPS * fabs(found) + 1e-9))
            printf("  Gaussian %zu, parameter %zu: %.9g, not %.9g, on a way of %g\n", i % COUNT, i / COUNT, found,
                   a->parameter, a->way);
        way += a->way;
    }
    CHECK(way > 0.1 * 1e-4 * STEPS * FXS_FIT_PARAMETERS * COUNT);
    fxs_fit_model_free(&m);
    fxs_fit_stepper_free(stepper);
}

static void test_tiny_gradients(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int versions_count = fit_versions(versions), block = FXS_FIT_GROUP;
    const fxs_fit_camera camera = fit_camera(WIDTH, HEIGHT, 25), *looking = &camera;
    for (int v = 0; v < versions_count; v++) {
        static float parameters[FXS_FIT_PARAMETERS][FXS_FIT_GROUP], means[FXS_FIT_PARAMETERS][FXS_FIT_GROUP];
        static float squares[FXS_FIT_PARAMETERS][FXS_FIT_GROUP], sums[FXS_FIT_SUMS][FXS_FIT_PART];
        float by_centre[FXS_FIT_GROUP] = {0};
        adam reference[FXS_FIT_GROUP] = {{0, 0, 0, 0}};
        memset(parameters, 0, sizeof parameters);
        memset(means, 0, sizeof means);
        memset(squares, 0, sizeof squares);
        for (int i = 0; i < block; i++) {
            parameters[FXS_FIT_ROTATION][i] = 1;
            for (int k = 0; k < 3; k++)
                parameters[FXS_FIT_POSITION + k][i] = camera.eye[k] + 3 * camera.rotation[6 + k];
        }
        fit_state = 5;
        for (int step = 1; step <= 150; step++) {
            fxs_fit_adam numbers = {.correction = (float)(1 / (1 - pow(0.999, step))),
                                    .epsilon = 3e-15f * WIDTH * HEIGHT};
            numbers.rate[FXS_FIT_COLOUR] = (float)(0.0025 / (1 - pow(0.9, step)));
            for (int i = 0; i < block; i++) {
                sums[FXS_FIT_RED][i] = step < 100 ? (float)ldexp(fit_uniform(-1, 1), -10 * i) : 0;
                reference_step(&reference[i], 0.28209479177387814 * (double)sums[FXS_FIT_RED][i], 0.0025, step);
            }
            versions[v]->update(&looking, 1, 0, &numbers, parameters[0], parameters[0], means[0], squares[0],
                                FXS_FIT_GROUP, 0, FXS_FIT_GROUP, sums[0], 0, by_centre);
        }
        for (int i = 0; i < block; i++) {
            const double found = (double)parameters[FXS_FIT_COLOUR][i];
            if (!CHECK(fabs(found - reference[i].parameter) < 1e-4 * reference[i].way + 1e-7))
                printf("  %s, 2^%d: %g, not %g\n", versions[v]->name, -10 * i, found, reference[i].parameter);
        }
        CHECK(reference[2].way > 0.01 && parameters[FXS_FIT_COLOUR + 1][0] == 0);
    }
}

static void test_factors(void)
{
    static const float neutral[FXS_FIT_GAIN] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    float factors[FXS_FIT_GAIN];
    gain_factors(&(fxs_fit_gain){.at = {0}}, 0, factors);
    CHECK(!memcmp(factors, neutral, sizeof neutral));
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        CHECK(gain_neutral(1, k) == neutral[k] && gain_neutral(0, k) == 0);
    fit_state = 6;
    for (int i = 0; i < 1000; i++) {
        const double e = (float)fit_uniform(-16, 16), r = (float)fit_uniform(-16, 16), b = (float)fit_uniform(-16, 16);
        const double wanted[3] = {exp2(e + r), exp2(e - r - b), exp2(e + b)};
        gain_factors(&(fxs_fit_gain){.at = {(float)e, (float)r, (float)b}}, 0, factors);
        for (int c = 0; c < 3; c++)
            CHECK(fabs((double)factors[4 * c] - wanted[c]) < 4e-6 * wanted[c]);
    }
}

static void take_step(fxs_fit_gain *gain, int is_affine, const float sums[FXS_FIT_GAIN], float rate, float decay)
{
    float moved[FXS_FIT_GAIN][FXS_FIT_BASIS] = {{0}};
    gain_step(gain, is_affine, sums, rate, decay, moved);
}

static void test_gain_steps(void)
{
    static const float bad[] = {NAN, INFINITY, 3e18f};
    double at[3] = {0};
    fxs_fit_gain gain = {.basis = {0.5f, -0.25f}};
    fit_state = 7;
    for (int step = 1; step <= STEPS; step++) {
        float sums[FXS_FIT_GAIN] = {0}, moved[FXS_FIT_GAIN][FXS_FIT_BASIS] = {{0}};
        double to[3], all = 0;
        const fxs_fit_gain before = gain;
        for (int c = 0; c < 3; c++) {
            sums[c] = (float)fit_uniform(0, step % 9 ? 1 : 0.0001);
            sums[3 + c] = (float)fit_uniform(0, step % 7 ? 1 : 0.0001);
            to[c] = log2(((double)sums[3 + c] + 0.0003) / ((double)sums[c] + 0.0003));
            all += to[c] / 3;
        }
        at[0] += 0.1 * all;
        at[1] += 0.1 * (to[0] - all);
        at[2] += 0.1 * (to[2] - all);
        gain_step(&gain, 0, sums, 0.1f, 0, moved);
        for (int k = 0; k < 3; k++) {
            CHECK(fabs((double)gain.at[k] - at[k]) < 2e-6);
            CHECK(moved[k][0] == 0.5f * (gain.at[k] - before.at[k]) && moved[k][1] == -0.5f * moved[k][0]);
        }
        gain_project(&gain, 0, moved);
        for (int k = 0; k < 3; k++) {
            CHECK(fabs((double)gain.at[k] - (at[k] - 0.3125 * ((double)moved[k][0] / 0.5))) < 1e-4);
            at[k] = (double)gain.at[k];
        }
    }
    const fxs_fit_gain before = gain;
    for (int i = 0; i < 18; i++) {
        float sums[FXS_FIT_GAIN] = {0};
        sums[i % 6] = bad[i / 6];
        take_step(&gain, 0, sums, 0.5f, 0);
        CHECK(!memcmp(&gain, &before, sizeof gain));
    }
    gain = (fxs_fit_gain){.at = {20, -20, 1}};
    take_step(&gain, 0, (const float[FXS_FIT_GAIN]){0}, 0.1f, 0);
    CHECK(gain.at[0] == FXS_FIT_GAIN_MOST && gain.at[1] == -FXS_FIT_GAIN_MOST && gain.at[2] == 1);
}

/* Summands of an exposure: white pixels do not count. */
static void test_gain_summands(void)
{
    CHECK(gain_summand(1, 0.5f, 0.25f) == 0.5f && gain_summand(4, 0.5f, 0.25f) == 0.25f);
    CHECK(gain_summand(2, 0.5f, 1) == 0 && gain_summand(3, 0.5f, 1) == 0);
    CHECK(gain_summand(0, 1, 0.5f) == 0 && gain_summand(5, 1, 0.5f) == 0);
}

static void test_affine_steps(void)
{
    static const float bad[] = {NAN, INFINITY, 1e20f};
    double at[FXS_FIT_GAIN] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, mean[FXS_FIT_GAIN] = {0}, square = 0, way = 0;
    fxs_fit_gain gain = {.at = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    fit_state = 9;
    for (int step = 1; step <= STEPS; step++) {
        float sums[FXS_FIT_GAIN];
        double by[FXS_FIT_GAIN], next[FXS_FIT_GAIN];
        square *= 0.999;
        for (int k = 0; k < FXS_FIT_GAIN; k++) {
            sums[k] = (float)ldexp(fit_uniform(-1, 1), step % 9 - 12);
            const double unit = k > 8 ? 0.03125 : k % 4 ? 0.25 : 1, gradient = unit * (double)sums[k];
            square += 0.001 * gradient * gradient;
            mean[k] = 0.9 * mean[k] + 0.1 * gradient;
        }
        for (int k = 0; k < FXS_FIT_GAIN; k++) {
            const double unit = k > 8 ? 0.03125 : k % 4 ? 0.25 : 1;
            by[k] = -0.01 * unit * mean[k] / (1 - pow(0.9, step)) / sqrt(square / (1 - pow(0.999, step)));
            way += fabs(by[k]);
        }
        for (int k = 0; k < FXS_FIT_GAIN; k++) {
            const double *row = at + k / 3 * 3, off = k == 0 || k == 4 || k == 8;
            next[k] = at[k] + (row[0] * by[k % 3] + row[1] * by[3 + k % 3] + row[2] * by[6 + k % 3]) +
                      (k < 9 ? 0 : by[k]) - 0.02 * (at[k] - off);
        }
        memcpy(at, next, sizeof at);
        take_step(&gain, 1, sums, 0.01f, 0.02f);
        for (int k = 0; k < FXS_FIT_GAIN; k++)
            CHECK(fabs((double)gain.at[k] - at[k]) < 1e-5 * way);
    }
    CHECK(way > 1);
    const fxs_fit_gain before = gain;
    for (int i = 0; i < 3 * FXS_FIT_GAIN; i++) {
        float sums[FXS_FIT_GAIN] = {0};
        sums[i % FXS_FIT_GAIN] = bad[i / FXS_FIT_GAIN];
        take_step(&gain, 1, sums, 0.01f, 0.02f);
        CHECK(!memcmp(&gain, &before, sizeof gain));
    }
    gain = (fxs_fit_gain){.at = {1, 0, 0, 0, 20, 0, 0, 0, 1, -20, 0, 1}};
    take_step(&gain, 1, (const float[FXS_FIT_GAIN]){0}, 0.1f, 0.05f);
    CHECK(gain.at[4] == FXS_FIT_GAIN_MOST && gain.at[9] == -FXS_FIT_GAIN_MOST && gain.at[11] == 0.95f &&
          gain.at[0] == 1 && gain.at[1] == 0);
}

/* After a step, the mean exposure over all photographs must stay neutral (no change of colours) within rounding. */
static void check_means(int is_affine)
{
    enum { GAINS = GAIN_PARTS + 7 };
    static uint8_t pixels[PHOTOGRAPHS][3 * WIDTH * HEIGHT];
    static fxs_fit_gain of[GAINS];
    fxs_fit_gains gains = {of, GAINS, is_affine};
    fxs_fit_photograph photographs[PHOTOGRAPHS];
    fxs_fit_model m;
    fxs_fit_report report;
    fxs_fit_stepper *stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), NULL, NULL, 1, NULL);
    fit_state = 8;
    memset(of, 0, sizeof of);
    for (int i = 0; i < GAINS * FXS_FIT_GAIN; i++)
        of[i / FXS_FIT_GAIN].at[i % FXS_FIT_GAIN] = gain_neutral(is_affine, i % FXS_FIT_GAIN);
    for (int i = 0; i < GAINS; i++)
        of[i].basis[0] = (float)(1 / sqrt(GAINS));
    for (int i = 0; i < PHOTOGRAPHS; i++) {
        for (int k = 0; k < 3 * WIDTH * HEIGHT; k++)
            pixels[i][k] = (uint8_t)fit_uniform(0, k % 3 ? 256 : 100 + 50 * i);
        photographs[i] = (fxs_fit_photograph){pixels[i], WIDTH, HEIGHT, 1, fit_camera(WIDTH, HEIGHT, 25),
                                              i ? GAINS - (uint32_t)i : 0, NULL};
    }
    make_model(&m, &photographs[0].camera);
    m.gains = &gains;
    for (int step = 1; step <= 60; step++) {
        const fxs_fit_step_options options = {.number = (uint32_t)step, .gain_rate = 0.05f,
                                              .gain_decay = 0.05f};
        static fxs_fit_gain before[GAINS];
        memcpy(before, of, sizeof of);
        CHECK(!fxs_fit_stepper_step(stepper, &m, &photographs[step % 2], 2, &options, &report));
        for (int k = 0; k < (is_affine ? FXS_FIT_GAIN : 3); k++) {
            const int is_diagonal = is_affine && (k == 0 || k == 4 || k == 8);
            double sum = is_diagonal ? -GAINS : 0, way = 0;
            for (int i = 0; i < GAINS; i++)
                sum += (double)of[i].at[k];
            for (int i = 0; i < GAINS; i++)
                way += fabs((double)of[i].at[k]);
            CHECK(fabs(sum) < 4e-7 * way + 1e-9);    /* roundings of the changes add up */
            for (int i = 2; i < GAINS - PHOTOGRAPHS; i++)
                CHECK(fabsf((of[i].at[k] - before[i].at[k]) - (of[1].at[k] - before[1].at[k])) < 1e-7f);
        }
        CHECK(of[0].of_one[0] > 0 || step < 2 || !is_affine);
    }
    CHECK(fabsf(of[0].at[is_affine ? 0 : 1] - of[GAINS - 2].at[is_affine ? 0 : 1]) > 0.01f);
    fxs_fit_model_free(&m);
    fxs_fit_stepper_free(stepper);
}

static void test_means_stay_neutral(void)
{
    check_means(0);
    check_means(1);
}

int main(void)
{
    RUN(test_exponentials);
    RUN(test_logarithm);
    RUN(test_doubles);
    RUN(test_steps_are_adams);
    RUN(test_tiny_gradients);
    RUN(test_factors);
    RUN(test_gain_steps);
    RUN(test_gain_summands);
    RUN(test_affine_steps);
    RUN(test_means_stay_neutral);
    return check_report();
}
