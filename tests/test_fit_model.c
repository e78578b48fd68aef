/* Tests the initial Gaussians of a fit, their growth and pruning, and the schedules of the recipes, against plain
   code in doubles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fit.h>
#include <fixsplat/internal/kernels.h>
#include "src/fit/model.h"
#include "src/gaussian/nearest.h"
#include "src/base/random.h"
#include "src/fit/recipe.h"
#include "check.h"

/* number of further memory allocations that succeed; negative: all */
static long memory_left = -1;

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LIMITED 1
void *__libc_malloc(size_t size);
void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size)
{
    return !memory_left ? NULL : (memory_left -= memory_left > 0, __libc_malloc(size));
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    *out = !memory_left ? NULL : (memory_left -= memory_left > 0, __libc_memalign(alignment, size));
    return *out ? 0 : 12;
}
#endif

static uint64_t turn;

static double uniform(double low, double high)
{
    return low + (high - low) * (double)(fxs_random(77, 5, turn++) >> 11) * 0x1p-53;
}

static float *at(const fxs_fit_model *m, int plane, size_t i)
{
    return &m->parameters[(size_t)plane * m->stride + i];
}

static double opacity_of(const fxs_fit_model *m, size_t i)
{
    return 1 / (1 + exp(-(double)*at(m, FXS_FIT_OPACITY, i)));
}

static int is_near(double a, double b, double relative)
{
    return fabs(a - b) <= relative * fmax(fabs(a), fabs(b));
}

static fxs_fit_model random_model(size_t count)
{
    fxs_fit_model m;
    fxs_fit_point *points = calloc(count, sizeof *points);
    CHECK(points && !fxs_fit_model_begin(&m, points, count, 0.1f));
    free(points);
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++) {
            *at(&m, k, i) = (float)uniform(-1, 1);
            m.means[(size_t)k * m.stride + i] = (float)(1000 * (int)i + k);
            m.squares[(size_t)k * m.stride + i] = (float)(1000 * (int)i + k) + 0.5f;
        }
        for (int k = 0; k < 3; k++)
            *at(&m, FXS_FIT_SCALE + k, i) = (float)uniform(-5, -1);
        *at(&m, FXS_FIT_OPACITY, i) = (float)uniform(-7, 7);
        m.views[i] = (float)(i % 5);
        m.by_centre[i] = m.views[i] * (float)uniform(0, 0.0004);
    }
    return m;
}

static fxs_fit_model copy_of(const fxs_fit_model *m)
{
    fxs_fit_model c = *m;
    const size_t bytes = m->stride * sizeof(float);
    float *const from[] = {m->parameters, m->means, m->squares, m->by_centre, m->views};
    float **const to[] = {&c.parameters, &c.means, &c.squares, &c.by_centre, &c.views};
    for (int i = 0; i < 5; i++) {
        const size_t room = bytes * (i < 3 ? FXS_FIT_PARAMETERS : 1);
        *to[i] = check_aligned(room);
        memcpy(*to[i], from[i], room);
    }
    return c;
}

enum { SPREAD, SAME_PLACE, OUTLIER, LINE, SCALES, LAYOUTS };

static void lay_out(fxs_fit_point *points, size_t count, int layout)
{
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const double u = uniform(-1, 1);
            points[i].position[k] = (float)(layout == SAME_PLACE ? 3
                                            : layout == OUTLIER  ? 1e-6 * u
                                            : layout == LINE     ? (k == 1) * u
                                            : layout == SCALES   ? ldexp(u, -(int)(i % 40))
                                                                 : u);
        }
    if (layout == OUTLIER)
        points[count / 2].position[0] = 1e9f;
}

static int nearest_squares(const fxs_fit_point *points, size_t count, float *squares)
{
    const float *const first[3] = {points->position, points->position + 1, points->position + 2};
    return fxs_nearest_squares(first, sizeof *points / sizeof(float), count, squares);
}

static double plain_mean_square(const fxs_fit_point *points, size_t count, size_t of)
{
    double nearest[3] = {INFINITY, INFINITY, INFINITY}, sum = 0;
    int found = 0;
    for (size_t i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double away = (double)points[i].position[k] - (double)points[of].position[k];
            square += away * away;
        }
        for (int k = 0; k < 3 && i != of; k++)
            if (square < nearest[k]) {
                const double swap = nearest[k];
                nearest[k] = square;
                square = swap;
            }
    }
    for (int k = 0; k < 3; k++)
        if (isfinite(nearest[k])) {
            sum += nearest[k];
            found++;
        }
    return found ? sum / found : 1;
}

static void nearest_points(void)
{
    static const size_t counts[] = {1, 2, 3, 4, 8, 9, 17, 100, 3000};
    fxs_fit_point points[3000];
    float squares[3000];
    for (int layout = 0; layout < LAYOUTS; layout++)
        for (int c = 0; c < 9; c++) {
            size_t wrong = 0;
            lay_out(points, counts[c], layout);
            CHECK(!nearest_squares(points, counts[c], squares));
            for (size_t i = 0; i < counts[c]; i += 1 + counts[c] / 200)
                wrong += !is_near((double)squares[i], plain_mean_square(points, counts[c], i), 1e-5);
            CHECK(!wrong);
        }
}

static void nearest_of_many(void)
{
    const size_t count = 300000;
    fxs_fit_point *points = calloc(count, sizeof *points);
    float *squares = calloc(count, sizeof *squares);
    for (int layout = SAME_PLACE; layout <= OUTLIER && points && squares; layout++) {
        lay_out(points, count, layout);
        CHECK(!nearest_squares(points, count, squares));
        CHECK(layout == OUTLIER || squares[7] == 0);
    }
    free(points);
    free(squares);
}

static void beginning(void)
{
    const fxs_fit_point points[5] = {{{0, 0, 0}, {255, 0, 128}}, {{1, 0, 0}, {0, 0, 0}}, {{0, 2, 0}, {9, 9, 9}},
                                     {{0, 0, 3}, {1, 2, 3}}, {{50, 0, 0}, {4, 5, 6}}};
    fxs_fit_model m;
    CHECK(!fxs_fit_model_begin(&m, points, 5, 0.1f));
    CHECK(m.count == 5 && m.stride >= 5 && m.stride % FXS_FIT_GROUP == 0);
    CHECK(is_near((double)*at(&m, FXS_FIT_SCALE + 1, 0), log(sqrt((1 + 4 + 9) / 3.0)), 1e-6));
    CHECK(is_near(opacity_of(&m, 3), 0.1, 1e-6));
    CHECK(*at(&m, FXS_FIT_POSITION, 4) == 50 && *at(&m, FXS_FIT_ROTATION, 2) == 1 &&
          *at(&m, FXS_FIT_ROTATION + 1, 2) == 0);
    CHECK(is_near(0.5 + 0.28209479177387814 * (double)*at(&m, FXS_FIT_COLOUR, 0), 1, 1e-6));
    CHECK(*at(&m, FXS_FIT_SH, 0) == 0 && m.means[0] == 0 && m.views[0] == 0);
    fxs_fit_model_widen(&m, 0.1f);
    CHECK(is_near((double)*at(&m, FXS_FIT_SCALE + 1, 0), log(0.1 * sqrt((1 + 4 + 9) / 3.0)), 1e-6));
    fxs_fit_model_free(&m);
}

static const fxs_fit_densify rule = {0.0002f, 0.1f, 0.3f, 0.005f, 1 << 20, {{0}, 0}};

static double largest(const fxs_fit_model *m, size_t i)
{
    return exp(fmax(fmax((double)*at(m, 3, i), (double)*at(m, 4, i)), (double)*at(m, 5, i)));
}

static double gradient_of(const fxs_fit_model *m, size_t i)
{
    return m->views[i] > 0 ? (double)(m->by_centre[i] / m->views[i]) : 0;
}

/* Returns the expected treatment of a Gaussian in densification: 'g' removes, 'c' clones, 's' splits, ' ' keeps
   the Gaussian. */
static char plain_fate(const fxs_fit_model *m, size_t i, const fxs_fit_densify *d)
{
    const int wanted = gradient_of(m, i) >= (double)d->gradient;
    char fate = wanted ? (largest(m, i) <= (double)d->small ? 'c' : 's') : ' ';
    if (opacity_of(m, i) < (double)d->opacity || largest(m, i) * (fate == 's' ? sqrt(0.5) : 1) > (double)d->large)
        fate = 'g';
    return fate;
}

static size_t differing(const fxs_fit_model *a, size_t i, const fxs_fit_model *b, size_t k, int first, int end)
{
    size_t n = 0;
    for (int p = first; p < end; p++)
        n += *at(a, p, i) != *at(b, p, k);
    return n;
}

static int has_moments(const fxs_fit_model *m, size_t i, double of)
{
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        if ((double)m->means[(size_t)k * m->stride + i] != (of < 0 ? 0 : 1000 * of + k) ||
            (double)m->squares[(size_t)k * m->stride + i] != (of < 0 ? 0 : 1000 * of + k + 0.5))
            return 0;
    return 1;
}

static void rotation_of(const fxs_fit_model *m, size_t i, double r[3][3])
{
    double q[4], n = 0;
    for (int k = 0; k < 4; k++) {
        q[k] = (double)*at(m, FXS_FIT_ROTATION + k, i);
        n += q[k] * q[k];
    }
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            r[a][b] = rows[a][b] / n;
}

/* Checks a child of a split Gaussian. The first child lies on the positive side of each axis, the second on the
   negative side. */
static int is_child(const fxs_fit_model *m, size_t i, const fxs_fit_model *old, size_t of, int which)
{
    int ok = has_moments(m, i, -1) && !differing(m, i, old, of, FXS_FIT_ROTATION, FXS_FIT_OPACITY) &&
             !differing(m, i, old, of, FXS_FIT_COLOUR, FXS_FIT_PARAMETERS);
    double r[3][3], moved[3] = {0};
    rotation_of(old, of, r);
    for (int k = 0; k < 3; k++) {
        const double sigma = exp((double)*at(old, FXS_FIT_SCALE + k, of)), part = sigma / largest(old, of);
        const double kept = 1 - (1 - sqrt(0.5)) * part * part;
        ok &= fabs((double)*at(m, FXS_FIT_SCALE + k, i) - log(sigma * kept)) < 2e-6;
        for (int a = 0; a < 3; a++)
            moved[a] += (which ? -1 : 1) * r[a][k] * sigma * sqrt(1 - kept * kept);
    }
    for (int a = 0; a < 3; a++)
        ok &= fabs((double)*at(m, a, i) - (double)*at(old, a, of) - moved[a]) <
              1e-5 * (largest(old, of) + fabs((double)*at(old, a, of)));
    return ok && is_near(1 - opacity_of(m, i), pow(1 - opacity_of(old, of), sqrt(0.5)), 1e-4);
}

static void check_densified(const fxs_fit_model *m, const fxs_fit_model *old, const char *fates)
{
    size_t n = 0, wrong = 0;
    for (size_t i = 0; i < old->count; i++)
        if (fates[i] == ' ' || fates[i] == 'c') {
            wrong += n >= m->count || differing(m, n, old, i, 0, FXS_FIT_PARAMETERS) || !has_moments(m, n, (double)i);
            n++;
        }
    for (size_t i = 0; i < old->count; i++) {
        if (fates[i] == 'c') {
            wrong += n >= m->count || differing(m, n, old, i, 0, FXS_FIT_PARAMETERS) || !has_moments(m, n, -1);
            n++;
        }
        for (int child = 0; child < 2 && fates[i] == 's'; child++) {
            wrong += n >= m->count || !is_child(m, n, old, i, child);
            n++;
        }
    }
    CHECK(n == m->count);
    CHECK(!wrong);
}

static void densified(void)
{
    for (int turns = 0; turns < 20; turns++) {
        fxs_fit_model m = random_model(500), old = copy_of(&m);
        char fates[500];
        int seen[256] = {0};
        for (size_t i = 0; i < 500; i++)
            seen[(unsigned char)(fates[i] = plain_fate(&old, i, &rule))]++;
        CHECK(seen['g'] && seen[' '] && seen['c'] && seen['s']);
        CHECK(!fxs_fit_model_densify(&m, &rule));
        check_densified(&m, &old, fates);
        CHECK(m.views[1] == 0 && m.by_centre[1] == 0);
        fxs_fit_model_free(&m);
        fxs_fit_model_free(&old);
    }
}

static void densified_up_to_a_number(void)
{
    for (size_t room = 0; room < 60; room += 19) {
        fxs_fit_model m = random_model(400), old = copy_of(&m);
        fxs_fit_densify d = rule;
        char fates[400], wanted[400];
        size_t staying = 0;
        d.large = INFINITY;
        for (size_t i = 0; i < 400; i++) {
            wanted[i] = plain_fate(&old, i, &d);
            staying += wanted[i] != 'g';
            fates[i] = wanted[i] == 'g' ? 'g' : ' ';
        }
        d.most = staying + room;
        for (size_t k = 0; k < room; k++) {
            size_t best = 400;
            for (size_t i = 0; i < 400; i++)
                if ((wanted[i] == 'c' || wanted[i] == 's') && fates[i] == ' ' &&
                    (best == 400 || gradient_of(&old, i) > gradient_of(&old, best)))
                    best = i;
            if (CHECK(best < 400))
                fates[best] = wanted[best];
        }
        CHECK(!fxs_fit_model_densify(&m, &d));
        CHECK(m.count == d.most);
        check_densified(&m, &old, fates);
        fxs_fit_model_free(&m);
        fxs_fit_model_free(&old);
    }
}

static void densified_to_nothing(void)
{
    fxs_fit_model m = random_model(40);
    fxs_fit_densify d = rule;
    d.opacity = 0.9999f;
    CHECK(!fxs_fit_model_densify(&m, &d) && m.count == 40);
    d = rule;
    d.large = INFINITY;
    d.gradient = 1;
    for (size_t i = 0; i < 40; i++)
        *at(&m, FXS_FIT_OPACITY, i) = 0;
    for (int k = 0; k < 4; k++)
        *at(&m, FXS_FIT_ROTATION + k, 3) = 0;
    CHECK(!fxs_fit_model_densify(&m, &d) && m.count == 39);
    fxs_fit_model_free(&m);
}

static void children(void)
{
    fxs_fit_model m = random_model(2);
    fxs_fit_densify d = rule;
    size_t wrong = 0;
    d.large = INFINITY;
    for (size_t i = 0; i < 2; i++) {
        m.views[i] = m.by_centre[i] = 1;
        for (int k = 0; k < 3; k++)
            *at(&m, FXS_FIT_SCALE + k, i) = i && k ? -FXS_FIT_FARTHEST : 1;
        *at(&m, FXS_FIT_OPACITY, i) = i ? 0 : FXS_FIT_FARTHEST;
    }
    CHECK(!fxs_fit_model_densify(&m, &d) && m.count == 4);
    for (size_t i = 0; i < m.count; i++)
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            wrong += isfinite(*at(&m, k, i)) ? 0 : 1;
    CHECK(!wrong && opacity_of(&m, 0) > 0.9999);
    fxs_fit_model_free(&m);
}

static void reset(void)
{
    fxs_fit_model m = random_model(200), old = copy_of(&m);
    size_t wrong = 0;
    fxs_fit_model_reset_opacity(&m, 0.01f);
    for (size_t i = 0; i < 200; i++) {
        const double before = opacity_of(&old, i);
        wrong += !is_near(opacity_of(&m, i), before < 0.01 ? before : 0.01, 1e-5);
        wrong += differing(&m, i, &old, i, 0, FXS_FIT_OPACITY) || differing(&m, i, &old, i, FXS_FIT_COLOUR, 59);
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            wrong += (double)m.means[(size_t)k * m.stride + i] != (k == FXS_FIT_OPACITY ? 0 : 1000.0 * (double)i + k);
        wrong += m.squares[FXS_FIT_OPACITY * m.stride + i] != 0;
    }
    CHECK(!wrong);
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&old);
}

/* Morton code (interleaved bits) of a Gaussian's position, with ten bits for each coordinate, highest bits first. */
static unsigned long plain_code(const fxs_fit_model *m, size_t i, const double middle[3], double spread)
{
    unsigned long code = 0;
    for (int bit = 9; bit >= 0; bit--)
        for (int k = 2; k >= 0; k--) {
            const double x = ((double)*at(m, k, i) - middle[k]) / spread, y = x / (1 + fabs(x));
            code = code << 1 | ((unsigned long)((y + 1) * 511.5) >> bit & 1);
        }
    return code;
}

static void order(void)
{
    enum { COUNT = 2000 };
    fxs_fit_model m = random_model(COUNT), old = copy_of(&m);
    static int found[COUNT];
    double middle[3] = {0}, spread = 0;
    size_t wrong = 0, behind = 0;
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < COUNT; i++)
            middle[k] += (double)*at(&m, k, i) / COUNT;
        for (size_t i = 0; i < COUNT; i++)
            spread += fabs((double)*at(&m, k, i) - middle[k]) / (3 * COUNT);
    }
    CHECK(!fxs_fit_model_order(&m) && m.count == COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        const size_t from = (size_t)(m.means[i] / 1000);
        wrong += from >= COUNT || found[from]++ || differing(&m, i, &old, from, 0, FXS_FIT_PARAMETERS) ||
                 !has_moments(&m, i, (double)from);
        behind += i && plain_code(&m, i, middle, spread) < plain_code(&m, i - 1, middle, spread);
    }
    CHECK(!wrong);
    /* a few codes may be out of order, since single precision may round a position into the next cell */
    CHECK(behind < 5);
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&old);
}

static void resized(void)
{
    const size_t counts[] = {500, 497, 498, 40, 600};
    fxs_fit_gains gains = {NULL, 0, 0};
    fxs_fit_poses poses = {NULL, 0};
    const fxs_fit_cameras cameras = {NULL, 0};
    fxs_fit_model m = random_model(500);
    m.gains = &gains;
    m.poses = &poses;
    m.cameras = &cameras;
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        size_t wrong = 0;
        CHECK(!fxs_fit_model_resize(&m, counts[n]) && m.count == counts[n]);
        CHECK(m.gains == &gains && m.poses == &poses && m.cameras == &cameras);
        CHECK(m.stride == (m.count + FXS_FIT_GROUP - 1) / FXS_FIT_GROUP * FXS_FIT_GROUP);
        for (size_t i = m.count; i < m.stride; i++) {
            for (int k = 0; k < FXS_FIT_PARAMETERS; k++) {
                const int is_low = (k >= FXS_FIT_SCALE && k < FXS_FIT_ROTATION) || k == FXS_FIT_OPACITY;
                const float rest = is_low ? -FXS_FIT_FARTHEST : k == FXS_FIT_ROTATION ? 1.0f : 0.0f;
                wrong += *at(&m, k, i) != rest || m.means[(size_t)k * m.stride + i] != 0 ||
                         m.squares[(size_t)k * m.stride + i] != 0;
            }
            wrong += m.by_centre[i] != 0 || m.views[i] != 0;
        }
        CHECK(!wrong);
    }
    fxs_fit_model_free(&m);
}

static void without_memory(void)
{
#ifdef LIMITED
    for (int what = 0; what < 2; what++) {
        int error = 1;
        for (long room = 0; error && room < 30; room++) {
            fxs_fit_densify d = rule;
            fxs_fit_model m = random_model(500), old = copy_of(&m);
            size_t wrong = 0;
            d.opacity = 0.0001f;
            memory_left = room;
            error = what ? fxs_fit_model_order(&m) : fxs_fit_model_densify(&m, &d);
            memory_left = -1;
            CHECK(room > 6 || error == FXS_ERR_MEMORY || what);
            CHECK(error || room);
            for (size_t i = 0; error && i < 500; i++)
                wrong += differing(&m, i, &old, i, 0, FXS_FIT_PARAMETERS) || !has_moments(&m, i, (double)i) ||
                         m.views[i] != old.views[i] || m.by_centre[i] != old.by_centre[i];
            CHECK(!wrong && (!error || m.count == 500));
            CHECK(error || what || m.count > 512);
            fxs_fit_model_free(&m);
            fxs_fit_model_free(&old);
        }
        CHECK(!error);
    }
#else
    SKIP("malloc is not ours here");
#endif
}

static double choose_of(int n, int k)
{
    return k < 0 || k > n ? 0 : exp(lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1));
}

/* Computes the new opacity and the scale factor when a Gaussian of opacity o is replaced by n Gaussians at its place
   (Kheradmand et al. 2024). */
static void plain_share(double o, int n, double *opacity, double *factor)
{
    double sum = 0;
    *opacity = 1 - pow(1 - o, 1.0 / n);
    for (int i = 1; i <= n; i++)
        for (int k = 0; k < i; k++)
            sum += choose_of(i - 1, k) * pow(-1, k) * pow(*opacity, k + 1) / sqrt(k + 1);
    *factor = o / sum;
}

static size_t not_shared(const fxs_fit_model *m, size_t i, const fxs_fit_model *old, size_t of, int n)
{
    double opacity, factor;
    size_t wrong = 0;
    plain_share(opacity_of(old, of), n < 51 ? n : 51, &opacity, &factor);
    wrong += !is_near(opacity_of(m, i), fmax(opacity, 0.005), 1e-3);
    for (int k = FXS_FIT_SCALE; k < FXS_FIT_SCALE + 3; k++)
        wrong += fabs((double)*at(m, k, i) - (double)*at(old, k, of) - log(factor)) > 1e-3;
    return wrong + differing(m, i, old, of, 0, 3) + differing(m, i, old, of, FXS_FIT_ROTATION, FXS_FIT_OPACITY) +
           differing(m, i, old, of, FXS_FIT_COLOUR, FXS_FIT_PARAMETERS) + !has_moments(m, i, -1);
}

static size_t source_of(const fxs_fit_model *m, size_t i, const fxs_fit_model *old)
{
    for (size_t k = 0; k < old->count; k++)
        if (opacity_of(old, k) > 0.005 && !differing(m, i, old, k, 0, 3))
            return k;
    return SIZE_MAX;
}

static void relocated(void)
{
    const fxs_fit_relocate r = {0.005f, 0, 3, 600};
    fxs_fit_model m = random_model(400), old = copy_of(&m);
    int times[400] = {0};
    size_t wrong = 0, dead = 0, shared = 0;
    CHECK(!fxs_fit_model_relocate(&m, &r) && m.count == 400);
    for (size_t i = 0; i < 400; i++) {
        const size_t source = source_of(&m, i, &old);
        if (CHECK(source < 400))
            times[source]++;
    }
    for (size_t i = 0; i < 400; i++) {
        const size_t source = source_of(&m, i, &old);
        if (opacity_of(&old, i) <= 0.005) {
            dead++;
            wrong += source == i || not_shared(&m, i, &old, source, times[source]);
        } else if (times[i] > 1) {
            shared++;
            wrong += source != i || not_shared(&m, i, &old, i, times[i]);
        } else
            wrong += differing(&m, i, &old, i, 0, FXS_FIT_PARAMETERS) || !has_moments(&m, i, (double)i);
    }
    CHECK(dead > 20 && shared > 10);
    CHECK(!wrong);
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&old);
}

static void relocated_to_one(void)
{
    for (size_t count = 2; count < 90; count += 7) {
        const fxs_fit_relocate r = {0.005f, 0, 3, 600};
        fxs_fit_model m = random_model(count), old;
        for (size_t i = 0; i < count; i++)
            *at(&m, FXS_FIT_OPACITY, i) = i == count / 2 ? 3 : -9;
        old = copy_of(&m);
        size_t wrong = 0;
        CHECK(!fxs_fit_model_relocate(&m, &r) && m.count == count);
        for (size_t i = 0; i < count; i++)
            wrong += not_shared(&m, i, &old, count / 2, (int)count);
        CHECK(!wrong);
        fxs_fit_model_free(&m);
        fxs_fit_model_free(&old);
    }
}

static void relocated_at_the_threshold(void)
{
    fxs_fit_model m = random_model(2);
    *at(&m, FXS_FIT_OPACITY, 0) = 3;
    *at(&m, FXS_FIT_OPACITY, 1) = 0;
    fxs_fit_model old = copy_of(&m);
    CHECK(!fxs_fit_model_relocate(&m, &(fxs_fit_relocate){0.5f, 0, 3, 600}) && m.count == 2);
    CHECK(!not_shared(&m, 0, &old, 0, 2) && !not_shared(&m, 1, &old, 0, 2));
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&old);
}

/* Tests growth: it must add a twentieth of the Gaussians, drawn at random with probability proportional to
   opacity. */
static void grown(void)
{
    enum { COUNT = 4000 };
    fxs_fit_model m = random_model(COUNT);
    double opaque = 0, drawn = 0, sum = 0, mean = 0;
    for (size_t i = 0; i < COUNT; i++) {
        *at(&m, FXS_FIT_OPACITY, i) = (float)log(i % 2 ? 0.9 / 0.1 : 0.3 / 0.7);
        *at(&m, FXS_FIT_POSITION, i) = (float)i;
    }
    CHECK(!fxs_fit_model_relocate(&m, &(fxs_fit_relocate){0.005f, 1 << 20, 3, 600}));
    CHECK(m.count == COUNT + COUNT / 20);
    for (size_t i = COUNT; i < m.count; i++) {
        opaque += (size_t)*at(&m, FXS_FIT_POSITION, i) % 2 ? 1 : 0;
        mean += (double)*at(&m, FXS_FIT_POSITION, i) / (COUNT / 20);
        drawn++;
    }
    sum = opaque / drawn;
    CHECK(fabs(sum - 0.75) < 0.1);
    CHECK(fabs(mean - COUNT / 2) < 400);
    CHECK(!fxs_fit_model_relocate(&m, &(fxs_fit_relocate){0.005f, COUNT + 300, 3, 700}));
    CHECK(m.count == COUNT + 300);
    CHECK(!fxs_fit_model_relocate(&m, &(fxs_fit_relocate){0.005f, COUNT, 3, 800}));
    CHECK(m.count == COUNT + 300);
    for (size_t i = 0; i < m.count; i++)
        *at(&m, FXS_FIT_OPACITY, i) = -30;
    CHECK(!fxs_fit_model_relocate(&m, &(fxs_fit_relocate){0.005f, 1 << 20, 3, 900}));
    CHECK(m.count == COUNT + 300 && *at(&m, FXS_FIT_OPACITY, 7) == -30);
    fxs_fit_model_free(&m);
}

static fxs_fit_plan plan_of(const fxs_fit_options *options, uint32_t step)
{
    fxs_fit_plan plan;
    fxs_fit_plan_step(options, 2.5f, step, 600, &plan);
    return plan;
}

static void reference_recipe(void)
{
    fxs_fit_options o;
    fxs_fit_options_init(&o);
    o.recipe = FXS_FIT_REFERENCE;
    o.steps = 30000;
    size_t wrong = 0;
    for (int white = 0; white < 2; white++) {
        memset(o.background, white ? 255 : 7, 3);
        for (uint32_t step = 1; step <= 30000; step++) {
            const fxs_fit_plan p = plan_of(&o, step);
            const double position = 2.5 * 1.6e-4 * pow(0.01, step / 30000.0);
            wrong += !is_near((double)p.rate[2], position, 1e-6);
            wrong += p.sh_degree != (step >= 3000 ? 3 : (int)step / 1000) || p.divisor != 1;
            wrong += p.densify != (step >= 600 && step <= 14900 && step % 100 == 0);
            wrong += p.reset != ((step <= 12000 && step % 3000 == 0) || (white && step == 500));
            wrong += step > 3000 ? !is_near((double)p.large, 0.25, 1e-6) : p.large < 1e30f;
            wrong += p.relocate || p.noise != 0 || p.by_opacity != 0 || p.by_scale != 0;
        }
    }
    CHECK(!wrong);
    const fxs_fit_plan p = plan_of(&o, 1);
    CHECK(p.rate[FXS_FIT_SCALE] == 0.005f && p.rate[FXS_FIT_ROTATION] == 0.001f && p.rate[FXS_FIT_OPACITY] == 0.025f);
    CHECK(p.rate[FXS_FIT_COLOUR] == 0.0025f && p.rate[FXS_FIT_SH] == 0.000125f && p.rate[58] == 0.000125f);
    CHECK(fxs_fit_first_opacity(FXS_FIT_REFERENCE) == 0.1f && fxs_fit_first_scale(FXS_FIT_REFERENCE) == 1);
    o.steps = 7000;   /* a fit of 7,000 steps uses the learning rates of the first 7,000 of 30,000 steps */
    CHECK(is_near((double)plan_of(&o, 7000).rate[0], 2.5 * 1.6e-4 * pow(0.01, 7.0 / 30), 1e-6));
    o.steps = 60000;
    CHECK(is_near((double)plan_of(&o, 60000).rate[0], 2.5 * 1.6e-6, 1e-6));
    o.sh_degree = 1;
    CHECK(plan_of(&o, 20000).sh_degree == 1);
}

/* The learning rate of affine exposures falls to a tenth during a fit, that of gains stays. Both rise from 0 over 500
   steps after the start and after each opacity reset. */
static void rates_of_exposures(void)
{
    fxs_fit_options o;
    fxs_fit_options_init(&o);
    CHECK(plan_of(&o, 700).gain_part == 0);
    for (int i = 0; i < 2 * (FXS_FIT_FAST + 1); i++) {
        const int recipe = i / 2;
        const double steps = recipe == FXS_FIT_REFERENCE ? 30000 : 8000;
        size_t wrong = 0;
        o.exposure = i % 2 ? FXS_FIT_EXPOSURE_AFFINE : FXS_FIT_EXPOSURE_GAIN;
        o.recipe = (enum fxs_fit_recipe)recipe;
        o.steps = 8000;
        uint32_t last = 0;
        for (uint32_t step = 1; step <= 8000; step++) {
            wrong += !is_near((double)plan_of(&o, step).gain_part,
                              fmin((step - last) / 500.0, 1) * (i % 2 ? pow(10, -(double)step / steps) : 1), 1e-6);
            last = plan_of(&o, step).reset ? step : last;
        }
        CHECK(!wrong && last == (recipe == FXS_FIT_REFERENCE ? 6000 : 0));
    }
}

static void mcmc_recipe(void)
{
    fxs_fit_options o;
    fxs_fit_options_init(&o);
    for (int recipe = FXS_FIT_MCMC; recipe <= FXS_FIT_FAST; recipe++)
        for (uint32_t steps = 2000; steps <= 32000; steps *= 4) {
            const uint32_t interval = steps < 8000 ? 25 : 100, degree = steps < 8000 ? 125 : steps < 32000 ? 500 : 1000;
            size_t wrong = 0;
            o.recipe = (enum fxs_fit_recipe)recipe;
            o.steps = steps;
            for (uint32_t step = 1; step <= steps; step++) {
                const fxs_fit_plan p = plan_of(&o, step);
                const double position = 2.5 * 1.6e-4 * pow(0.01, (double)step / steps);
                wrong += p.sh_degree != (step >= 3 * degree ? 3 : (int)(step / degree));
                wrong += p.divisor != (step <= steps / 10 ? 4 : step <= steps / 10 * 3 ? 2 : 1);
                wrong += p.relocate != (step > 3 * interval && step < steps / 5 * 4 && step % interval == 0);
                wrong += p.order != (p.relocate && step % (5 * interval) == 0);
                wrong += !is_near((double)p.rate[0], position, 1e-6);
                wrong += !is_near((double)p.noise, 5e5 * position, 1e-6);
                wrong += p.densify || p.reset || p.by_opacity != 0.01f || p.by_scale != 0.01f;
            }
            if (!CHECK(!wrong))
                printf("  recipe %d, %u steps\n", recipe, (unsigned)steps);
        }
    const fxs_fit_plan p = plan_of(&o, 1);
    CHECK(p.rate[FXS_FIT_OPACITY] == 0.05f && p.rate[FXS_FIT_COLOUR] == 0.0025f && p.rate[FXS_FIT_SH] == 0.00025f);
    for (o.steps = 1; o.steps < 200; o.steps++)
        for (uint32_t step = 1; step <= o.steps; step++)
            CHECK(plan_of(&o, step).sh_degree <= 3);
    CHECK(fxs_fit_first_opacity(FXS_FIT_MCMC) == 0.5f && fxs_fit_first_scale(FXS_FIT_FAST) == 0.1f);
}

/* The bounds of scales are computed at step 1, at every 100th step, and around the start of the last tenth of a fit. */
static void bounds_of_scales(void)
{
    fxs_fit_options o;
    fxs_fit_options_init(&o);
    CHECK(!plan_of(&o, 100).smooths);
    o.antialiased = 1;
    o.steps = 1250;
    for (uint32_t step = 1; step <= 1250; step++) {
        const int is_one = step == 1 || step % 100 == 0 || step == 1125 || step == 1250;
        CHECK(plan_of(&o, step).smooths == (!is_one ? 0 : step <= 125 ? 4 : step <= 375 ? 2 : 1));
    }
    o.recipe = FXS_FIT_REFERENCE;
    CHECK(plan_of(&o, 1).smooths == 1 && !plan_of(&o, 2).smooths && plan_of(&o, 1250).smooths == 1);
}

static void extents(void)
{
    fxs_fit_photo photos[3];
    const fxs_fit_point points[2] = {{{4, 0, 0}, {0, 0, 0}}, {{6, 0, 0}, {0, 0, 0}}};
    memset(photos, 0, sizeof photos);
    photos[0].view.position[0] = 3;
    photos[1].view.position[1] = 3;
    photos[2].view.position[2] = 3;
    CHECK(is_near((double)fxs_fit_extent(photos, 3, points, 2), 1.1 * sqrt(6), 1e-6));
    CHECK(is_near((double)fxs_fit_extent(photos, 1, points, 2), 1.1 * 2, 1e-6));
    photos[0].view.position[0] = 5;
    CHECK(is_near((double)fxs_fit_extent(photos, 1, points, 2), 1.1, 1e-6));
}

static void adam(void)
{
    const fxs_fit_stages *stages = fxs_fit_stages_choose(~0u);
    const fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .eye = {0, 0, -5}, .focal = {50, 50},
                                   .middle = {20, 20}, .slope_most = {1, 1}, .near = 0.2f, .width = 40, .height = 40,
                                   .tiles_x = 3, .tiles_y = 3};
    const fxs_fit_camera *looking = &camera;
    fxs_fit_model m = random_model(FXS_FIT_GROUP);
    float sums[FXS_FIT_SUMS][FXS_FIT_PART];
    double x = 0, mean = 0, square = 0, worst = 0;
    memset(m.means, 0, FXS_FIT_PARAMETERS * m.stride * sizeof(float));
    memset(m.squares, 0, FXS_FIT_PARAMETERS * m.stride * sizeof(float));
    for (int k = 0; k < 3; k++)
        *at(&m, k, 2) = *at(&m, FXS_FIT_COLOUR + k, 2) = 0;
    for (int step = 1; step <= 60; step++) {
        const double g = uniform(-3, 3), gradient = g * 0.28209479177387814;
        const fxs_fit_adam a = {.rate = {[FXS_FIT_COLOUR] = (float)(0.01 / (1 - pow(0.9, step)))},
                                .correction = (float)(1 / (1 - pow(0.999, step))), .epsilon = 1e-12f};
        memset(sums, 0, sizeof sums);
        sums[FXS_FIT_RED][2] = (float)g;
        stages->update(&looking, 1, 0, &a, m.parameters, m.parameters, m.means, m.squares, m.stride, 0, FXS_FIT_GROUP,
                       sums[0], NULL, m.by_centre);
        mean = 0.9 * mean + 0.1 * gradient;
        square = 0.999 * square + 0.001 * gradient * gradient;
        x -= 0.01 * mean / (1 - pow(0.9, step)) / (sqrt(square / (1 - pow(0.999, step))) + 1e-12);
        worst = fmax(worst, fabs(x - (double)*at(&m, FXS_FIT_COLOUR, 2)));
    }
    CHECK(worst < 1e-5);
    fxs_fit_model_free(&m);
}

static void gradients_beyond(void)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f, -3e20f};
    const fxs_fit_stages *stages = fxs_fit_stages_choose(~0u);
    const fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .eye = {0, 0, -5}, .focal = {50, 50},
                                   .middle = {20, 20}, .slope_most = {1, 1}, .near = 0.2f, .width = 40, .height = 40,
                                   .tiles_x = 3, .tiles_y = 3};
    const fxs_fit_camera *looking = &camera;
    fxs_fit_adam a = {.correction = 1, .epsilon = 1e-12f};
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        a.rate[k] = 1;
    for (int which = 0; which < 5; which++)
        for (int sum = 0; sum < FXS_FIT_SUMS; sum++) {
            fxs_fit_model m = random_model(FXS_FIT_GROUP), old;
            float sums[FXS_FIT_SUMS][FXS_FIT_PART];
            size_t unsound = 0;
            memset(m.means, 0, FXS_FIT_PARAMETERS * m.stride * sizeof(float));
            memset(m.squares, 0, FXS_FIT_PARAMETERS * m.stride * sizeof(float));
            *at(&m, FXS_FIT_SCALE, 5) = 100;
            *at(&m, FXS_FIT_OPACITY, 3) = 0;
            for (int k = 0; k < 3; k++)
                *at(&m, FXS_FIT_COLOUR + k, 3) = 9;
            old = copy_of(&m);
            for (int i = 0; i < FXS_FIT_SUMS * FXS_FIT_PART; i++)
                sums[i / FXS_FIT_PART][i % FXS_FIT_PART] = 1;
            sums[sum][3] = bad[which];
            stages->update(&looking, 1, 3, &a, m.parameters, m.parameters, m.means, m.squares, m.stride, 0,
                           FXS_FIT_GROUP, sums[0], NULL, m.by_centre);
            for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
                for (size_t i = 0; i < FXS_FIT_GROUP; i++)
                    unsound += !isfinite(*at(&m, k, i)) || !isfinite(m.squares[(size_t)k * m.stride + i]);
            CHECK(!unsound && !differing(&m, 3, &old, 3, 0, FXS_FIT_PARAMETERS));
            CHECK(m.by_centre[3] == old.by_centre[3] && differing(&m, 4, &old, 4, 0, FXS_FIT_PARAMETERS) > 20);
            CHECK(*at(&m, FXS_FIT_SCALE, 5) == 40);
            fxs_fit_model_free(&m);
            fxs_fit_model_free(&old);
        }
}

static void regularisers_beyond(void)
{
    static const float sums[FXS_FIT_SUMS][FXS_FIT_PART];
    const fxs_fit_stages *stages = fxs_fit_stages_choose(~0u);
    const fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .focal = {50, 50}, .width = 40,
                                   .height = 40};
    const fxs_fit_camera *looking = &camera;
    fxs_fit_adam a = {.correction = 1, .epsilon = 1e-12f, .by_opacity = 1, .by_scale = 1e8f};
    fxs_fit_model m = random_model(FXS_FIT_GROUP), old;
    memset(m.squares, 0, FXS_FIT_PARAMETERS * m.stride * sizeof(float));
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        a.rate[k] = 1;
    *at(&m, FXS_FIT_SCALE, 5) = 40;
    m.squares[FXS_FIT_OPACITY * m.stride + 7] = -1;
    old = copy_of(&m);
    stages->update(&looking, 1, 0, &a, m.parameters, m.parameters, m.means, m.squares, m.stride, 0, FXS_FIT_GROUP,
                   sums[0], NULL, m.by_centre);
    CHECK(isfinite(m.squares[FXS_FIT_SCALE * m.stride + 5]) && *at(&m, FXS_FIT_SCALE, 5) < 40);
    CHECK(*at(&m, FXS_FIT_OPACITY, 7) == *at(&old, FXS_FIT_OPACITY, 7));
    CHECK(*at(&m, FXS_FIT_OPACITY, 8) != *at(&old, FXS_FIT_OPACITY, 8));
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&old);
}

/* Tests the random moves of Gaussians, with the covariance Sigma^2 (s amount)^2. The factor s is a sigmoid of the
   opacity, near 0 for opaque Gaussians. */
static void noise(void)
{
    enum { COUNT = 8000 };
    const fxs_fit_stages *plain = fxs_fit_stages_choose(0), *best = fxs_fit_stages_choose(~0u);
    const fxs_fit_noise n = {2, {123456789u, 987654321u}, {{0}, 0}};
    const double s[3] = {0.3, 1, 1.5}, o = 0.02, strength = 2 / (1 + exp(100 * (o - 0.005)));
    fxs_fit_model m = random_model(COUNT), other;
    double got[3][3] = {{0}}, mean[3] = {0};
    for (size_t i = 0; i < COUNT; i++) {
        for (int k = 0; k < 4; k++)
            *at(&m, FXS_FIT_ROTATION + k, i) = k < 2 ? 0.5f : 0;
        for (int k = 0; k < 3; k++) {
            *at(&m, k, i) = 0;
            *at(&m, FXS_FIT_SCALE + k, i) = (float)log(s[k]);
        }
        *at(&m, FXS_FIT_OPACITY, i) = (float)log(o / (1 - o));
    }
    other = copy_of(&m);
    plain->noise(&n, m.parameters, m.stride, 0, m.stride);
    best->noise(&n, other.parameters, m.stride, 0, m.stride);
    CHECK(!memcmp(m.parameters, other.parameters, FXS_FIT_PARAMETERS * m.stride * sizeof(float)));
    for (size_t i = 0; i < COUNT; i++)
        for (int a = 0; a < 3; a++) {
            mean[a] += (double)*at(&m, a, i) / strength / COUNT;
            for (int b = 0; b < 3; b++)
                got[a][b] += (double)*at(&m, a, i) * (double)*at(&m, b, i) / (strength * strength) / COUNT;
        }
    const double sigma[3] = {s[0] * s[0], s[2] * s[2], s[1] * s[1]};
    for (int a = 0; a < 3; a++) {
        CHECK(fabs(mean[a]) < 0.05 * sigma[a]);
        for (int b = 0; b < 3; b++)
            CHECK(fabs(got[a][b] / (sigma[a] * sigma[b]) - (a == b)) < 0.06);
    }
    fxs_fit_model_free(&m);
    fxs_fit_model_free(&other);
}

/* Tests the square cut-off of Kerbl et al.: a square around a splat selects its tiles, and alpha >= 1/255 selects the
   pixels. */
static void square(void)
{
    fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .eye = {0, 0, -5}, .focal = {50, 50},
                             .middle = {40, 40}, .slope_most = {1, 1}, .near = 0.2f, .width = 80, .height = 80,
                             .tiles_x = 5, .tiles_y = 5, .is_square = 1};
    fxs_fit_stepper *stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(~0u), NULL, NULL, 1, NULL);
    int beyond = 0, wrong = 0, missing = 0;
    for (int turns = 0; turns < 60 && stepper; turns++) {
        fxs_fit_model m = random_model(1);
        fxs_fit_step_options options = {.number = 1};
        fxs_fit_plane planes[3];
        for (int k = 0; k < 3; k++) {
            *at(&m, k, 0) = (float)(uniform(-3, 3) * (k < 2));
            *at(&m, FXS_FIT_COLOUR + k, 0) = (float)(0.5 / 0.28209479177387814);
            *at(&m, FXS_FIT_ROTATION + k + 1, 0) = 0;
            *at(&m, FXS_FIT_SCALE + k, 0) = k == 2 ? -30 : (float)uniform(-3, 0);
        }
        *at(&m, FXS_FIT_ROTATION, 0) = 1;
        CHECK(!fxs_fit_draw(stepper, &m, &camera, &options, planes));
        const double x = (double)*at(&m, 0, 0), y = (double)*at(&m, 1, 0), o = opacity_of(&m, 0);
        const double sx = exp((double)*at(&m, 3, 0)), sy = exp((double)*at(&m, 4, 0));
        const double j[2][3] = {{10, 0, -2 * x}, {0, 10, -2 * y}}, s[3] = {sx, sy, exp(-30)};
        double c[3] = {0.3, 0, 0.3};
        for (int k = 0; k < 3; k++) {
            c[0] += j[0][k] * j[0][k] * s[k] * s[k];
            c[1] += j[0][k] * j[1][k] * s[k] * s[k];
            c[2] += j[1][k] * j[1][k] * s[k] * s[k];
        }
        const double det = c[0] * c[2] - c[1] * c[1], middle = (c[0] + c[2]) / 2;
        const double at_x = 40 + 10 * x, at_y = 40 + 10 * y;
        const double reach = 3 * sqrt(middle + sqrt(middle * middle - det));
        for (int py = 0; py < 80; py++)
            for (int px = 0; px < 80; px++) {
                const double dx = px + 0.5 - at_x, dy = py + 0.5 - at_y;
                const double d2 = (c[2] * dx * dx - 2 * c[1] * dx * dy + c[0] * dy * dy) / det;
                const double alpha = fmin(0.99, o * exp(-d2 / 2));
                const int left = px / 16 * 16, top = py / 16 * 16;
                const int in = left < at_x + reach && left + 16 > at_x - reach && top < at_y + reach &&
                               top + 16 > at_y - reach;
                const double wanted = in && alpha >= 1.0 / 255 ? alpha : 0;
                const double got = (double)planes[0].first[py * planes[0].stride + px];
                const int is_at_edge = fabs(alpha * 255 - 1) < 1e-3;
                wrong += !is_at_edge && fabs(got - wanted) > 1e-4;
                beyond += got > 0 && d2 > 9.01;
                missing += !in && alpha >= 1.0 / 255;
            }
        fxs_fit_model_free(&m);
    }
    CHECK(!wrong);
    CHECK(beyond > 100);
    printf("  pixels beyond distance 3: %d; beyond the square: %d\n", beyond, missing);
    fxs_fit_stepper_free(stepper);
}

enum { PHOTOS = 4, WIDE = 32 };
static uint8_t pixels[PHOTOS][3 * WIDE * WIDE];
static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[60];
static fxs_fit_options options;

static void set_scene(void)
{
    memset(photos, 0, sizeof photos);
    for (int i = 0; i < PHOTOS; i++) {
        const double c[4] = {1, 0, -1, 0}, s[4] = {0, 1, 0, -1};
        fxs_view *v = &photos[i].view;
        const double rotation[9] = {c[i], 0, -s[i], 0, 1, 0, s[i], 0, c[i]};
        memcpy(v->rotation, rotation, sizeof rotation);
        v->position[0] = -4 * s[i];
        v->position[2] = -4 * c[i];
        v->fx = v->fy = WIDE;
        v->cx = v->cy = WIDE / 2;
        v->width = v->height = WIDE;
        photos[i].pixels = pixels[i];
        for (int k = 0; k < 3 * WIDE * WIDE; k++)
            pixels[i][k] = (uint8_t)(k / 3 % 7 * 20 + 60 * (k % 3));
    }
    for (int i = 0; i < 60; i++)
        for (int k = 0; k < 3; k++) {
            points[i].position[k] = (float)uniform(-1, 1);
            points[i].colour[k] = (uint8_t)(40 * k + i);
        }
    fxs_fit_options_init(&options);
    options.recipe = FXS_FIT_REFERENCE;
    options.max_gaussians = fxs_fit_recipe_gaussians(options.recipe);
}

/* Runs a fit twice and compares the bytes of the two results. Returns the number of Gaussians. */
static size_t fitted(size_t photo_count, size_t point_count, uint32_t steps)
{
    fxs_fit *fit;
    fxs_message message;
    fxs_fit_report report;
    fxs_gaussian_source source;
    fxs_gaussian g;
    size_t unsound = 0;
    if (!CHECK(!fxs_fit_create(&fit, photos, photo_count, points, point_count, &options, &message)))
        return 0;
    for (uint32_t i = 0; i < steps; i++)
        CHECK(!fxs_fit_step(fit, &report, &message));
    fxs_fit_gaussians(fit, &source, &message);
    for (uint64_t i = 0; i < source.count && source.read(source.argument, i, &g, 1) == 1; i++)
        for (size_t k = 0; k < sizeof g / sizeof(float); k++) {
            float x;
            memcpy(&x, (char *)&g + k * sizeof x, sizeof x);
            unsound += isfinite(x) ? 0 : 1;
        }
    CHECK(!unsound && source.count == report.gaussians);
    fxs_fit_destroy(fit);
    return source.count;
}

static void hard_scenes(void)
{
    for (int recipe = FXS_FIT_REFERENCE; recipe <= FXS_FIT_FAST; recipe++) {
        set_scene();
        options.recipe = (enum fxs_fit_recipe)recipe;
        options.steps = 900;
        options.max_gaussians = 200;
        CHECK(fitted(PHOTOS, 60, 720) <= 200);
        CHECK(fitted(1, 60, 720));
        CHECK(fitted(1, 1, 110));
        memset(pixels, 0, sizeof pixels);
        CHECK(fitted(PHOTOS, 60, 720));
        for (int i = 0; i < 60; i++)
            memset(points[i].position, 0, sizeof points[i].position);
        CHECK(fitted(PHOTOS, 60, 110));
        set_scene();
        for (int i = 0; i < 60; i++)
            points[i].position[i % 3] = 9e11f;
        CHECK(fitted(PHOTOS, 60, 110));
        options.max_gaussians = 20;
        CHECK(fitted(PHOTOS, 60, 1) == 20);
    }
}

static uint64_t bytes_of_fit(unsigned cpu)
{
    fxs_fit *fit;
    fxs_message message;
    fxs_fit_report report;
    fxs_gaussian_source source;
    fxs_gaussian g;
    uint64_t sum = 0;
    options.cpu = cpu;
    if (!CHECK(!fxs_fit_create(&fit, photos, PHOTOS, points, 60, &options, &message)))
        return 0;
    for (int i = 0; i < 720; i++)
        CHECK(!fxs_fit_step(fit, &report, &message));
    fxs_fit_gaussians(fit, &source, &message);
    for (uint64_t i = 0; i < source.count && source.read(source.argument, i, &g, 1) == 1; i++)
        for (size_t k = 0; k < sizeof g / sizeof(float); k++) {
            uint32_t bits;
            memcpy(&bits, (char *)&g + k * sizeof bits, sizeof bits);
            sum = fxs_random_mix(sum ^ bits);
        }
    fxs_fit_destroy(fit);
    return sum;
}

static void same_bytes(void)
{
    uint64_t sums[5];
    for (int i = 0; i < 5; i++) {
        turn = 9;
        set_scene();
        options.steps = i == 2 ? 700 : 900;
        options.recipe = (enum fxs_fit_recipe)(i % 3);
        options.cutoff = i == 3 ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
        options.seed = i == 4;
        sums[i] = bytes_of_fit(0);
        CHECK(bytes_of_fit(~0u) == sums[i]);
        for (int k = 0; k < i; k++)
            CHECK(sums[k] != sums[i]);
    }
}

static void reduced(void)
{
    enum { W = 203, H = 195 };
    static uint8_t large[3 * W * H], small[3 * (W / 2) * (H / 2)];
    fxs_fit_report report[2];
    for (int recipe = 0; recipe < 2; recipe++) {
        fxs_fit *fit;
        fxs_message message;
        turn = 1;
        set_scene();
        for (int i = 0; i < 3 * W * H; i++)
            large[i] = (uint8_t)uniform(0, 256);
        for (int i = 0; i < 3 * (W / 2) * (H / 2); i++) {
            const int x = i / 3 % (W / 2), y = i / 3 / (W / 2), c = i % 3;
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += large[3 * ((2 * y + k / 2) * W + 2 * x + k % 2) + c];
            small[i] = (uint8_t)floor(sum / 4 + 0.5);
        }
        fxs_view *v = &photos[0].view;
        v->fx = v->fy = recipe ? 220 : 110;
        v->cx = recipe ? 101 : 50.5;
        v->cy = recipe ? 99 : 49.5;
        v->width = recipe ? W : W / 2;
        v->height = recipe ? H : H / 2;
        photos[0].pixels = recipe ? large : small;
        options.recipe = FXS_FIT_FAST;
        if (CHECK(!fxs_fit_create(&fit, photos, 1, points, 60, &options, &message)))
            CHECK(!fxs_fit_step(fit, &report[recipe], &message));
        fxs_fit_destroy(fit);
    }
    CHECK(report[0].entries > 0 && report[0].entries == report[1].entries);
    CHECK(report[0].absolute == report[1].absolute && report[0].dissimilar == report[1].dissimilar);
}

static void sizes_of_photographs(void)
{
    fxs_fit_options o;
    fxs_fit_options_init(&o);
    o.recipe = FXS_FIT_FAST;
    o.steps = 8000;
    fxs_fit_plan p;
    CHECK(fxs_fit_recipe_steps(FXS_FIT_FAST) == 8000 && fxs_fit_recipe_gaussians(FXS_FIT_FAST) == 250000);
    CHECK(fxs_fit_recipe_gaussians(FXS_FIT_MCMC) == 1000000 && fxs_fit_recipe_gaussians(FXS_FIT_REFERENCE) == 1 << 22);
    fxs_fit_plan_step(&o, 2.5f, 1, 199, &p);
    CHECK(p.divisor == 2);
    fxs_fit_plan_step(&o, 2.5f, 1, 99, &p);
    CHECK(p.divisor == 1);
}

static const char *refused(size_t photo_count, size_t point_count)
{
    static fxs_message message;
    fxs_fit *fit;
    message.text[0] = 0;
    CHECK(fxs_fit_create(&fit, photos, photo_count, points, point_count, &options, &message) && !fit);
    return message.text;
}

static void bad_input(void)
{
    set_scene();
    CHECK(*refused(0, 60) && *refused(PHOTOS, 0));
    points[7].position[1] = NAN;
    CHECK(strstr(refused(PHOTOS, 60), "point 7"));
    points[7].position[1] = 2e12f;
    CHECK(strstr(refused(PHOTOS, 60), "point 7"));
    set_scene();
    photos[2].view.position[0] = INFINITY;
    CHECK(strstr(refused(PHOTOS, 60), "photograph 2"));
    set_scene();
    for (int i = 0; i < 60; i++)
        points[i].position[2] -= 40;
    CHECK(strstr(refused(1, 60), "behind"));
}

int main(void)
{
    RUN(nearest_points);
    RUN(nearest_of_many);
    RUN(beginning);
    RUN(densified);
    RUN(densified_up_to_a_number);
    RUN(densified_to_nothing);
    RUN(children);
    RUN(reset);
    RUN(order);
    RUN(resized);
    RUN(without_memory);
    RUN(relocated);
    RUN(relocated_to_one);
    RUN(relocated_at_the_threshold);
    RUN(grown);
    RUN(reference_recipe);
    RUN(mcmc_recipe);
    RUN(rates_of_exposures);
    RUN(bounds_of_scales);
    RUN(extents);
    RUN(adam);
    RUN(gradients_beyond);
    RUN(regularisers_beyond);
    RUN(noise);
    RUN(square);
    RUN(sizes_of_photographs);
    RUN(reduced);
    RUN(same_bytes);
    RUN(hard_scenes);
    RUN(bad_input);
    return check_report();
}
