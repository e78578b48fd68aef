/* Finds the ground of a scene from its flat Gaussians, because their thinnest axes gather around the up direction. It
   refines each of the axes -y and z to the mean normal within a cone, then compares the two results. */
#include "ground.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>

enum { LAYERS = 64, GROWTH_POINTS = 8192 };
#define ALIGNED 0.94                 /* cosine of 20 degrees: normals this close to the axis belong to the ground; 6 %
                                        of random directions do */
#define GROWN 2
#define TURNED 0.86                  /* cosine of 30 degrees, the largest tilt of the ground */

typedef struct weighed {
    const fxs_sample_point *points;
    uint32_t count;
    double *weights, middle[3];
    double reach, spread;
} weighed;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double quantile(double *values, uint32_t count, uint32_t parts)
{
    fxs_sort_values(values, count);
    return values[count / parts];
}

static void find_away(const weighed *s, uint32_t i, double away[3])
{
    for (int k = 0; k < 3; k++)
        away[k] = s->points[i].place[k] - s->middle[k];
}

/* Computes the weight of each Gaussian for finding the ground: opacity * size^2 / (reach^2 + distance^2)^2. */
static void weigh(weighed *s)
{
    double *w = s->weights, away[3];
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < s->count; i++)
            w[i] = s->points[i].place[axis];
        s->middle[axis] = quantile(w, s->count, 2);
    }
    for (uint32_t i = 0; i < s->count; i++) {
        find_away(s, i, away);
        w[i] = sqrt(dot(away, away));
    }
    s->reach = quantile(w, s->count, 2);
    s->spread = w[s->count - 1 - s->count / 50] / s->reach;
    for (uint32_t i = 0; i < s->count; i++) {
        find_away(s, i, away);
        const double size = fmin(s->points[i].size, s->reach / 10), square = s->reach * s->reach + dot(away, away);
        w[i] = square > 0 ? s->points[i].opacity * size * size / square / square : 0;
    }
}

static double weight_across(const weighed *s, uint32_t i, const double axis[3])
{
    return fabs(dot(s->points[i].normal, axis)) > ALIGNED ? s->weights[i] * s->points[i].flatness : 0;
}

/* Returns the share, by weight, of flat Gaussians with normals along the axis. */
static double share_of(const weighed *s, const double axis[3])
{
    double all = 0, across = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        all += s->weights[i] * s->points[i].flatness;
        across += weight_across(s, i, axis);
    }
    return all > 0 ? across / all : 0;
}

static void refine(const weighed *s, double axis[3])
{
    static const double cones[] = {0.8, 0.8, 0.9, 0.9, 0.95, 0.95, 0.95};
    for (size_t k = 0; k < sizeof cones / sizeof *cones; k++) {
        double sum[3] = {0, 0, 0};
        for (uint32_t i = 0; i < s->count; i++) {
            const fxs_sample_point *p = &s->points[i];
            const double along = dot(p->normal, axis), weight = s->weights[i] * p->flatness;
            for (int j = 0; j < 3 && fabs(along) > cones[k]; j++)
                sum[j] += (along > 0 ? weight : -weight) * p->normal[j];
        }
        const double length = sqrt(dot(sum, sum));
        for (int j = 0; j < 3 && length > 0; j++)
            axis[j] = sum[j] / length;
    }
}

/* Finds the two neighbouring layers of the scene with most weight of flat Gaussians. Returns the shares of weight above
   and below these layers. */
static void weigh_sides(const weighed *s, const double axis[3], double thickness, double *above, double *below)
{
    double across[LAYERS] = {0}, all[LAYERS] = {0}, total = 0, away[3];
    int at = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        find_away(s, i, away);
        const int layer = (int)fmax(0, fmin(dot(away, axis) / thickness + LAYERS / 2, LAYERS - 1));
        total += s->weights[i];
        all[layer] += s->weights[i];
        across[layer] += weight_across(s, i, axis);
    }
    for (int k = 1; k + 1 < LAYERS; k++)
        if (across[k] + across[k + 1] > across[at] + across[at + 1])
            at = k;
    *above = *below = 0;
    for (int k = 0; k < LAYERS && total > 0; k++) {
        *below += k < at - 1 ? all[k] / total : 0;
        *above += k > at + 2 ? all[k] / total : 0;
    }
}

/* Measures on which side of the ground most of the scene lies. The scene is cut into layers of thickness reach / 16.
   The result is damped for few Gaussians, and if the share of flat Gaussians is near the 6 % of random directions. */
static double sides_of(const weighed *s, const double axis[3], double share)
{
    double above = 0, below = 0, thickness = s->reach / 16;
    for (int finer = 0; finer < 3 && above + below < 0.1; finer++, thickness /= 4)
        weigh_sides(s, axis, thickness, &above, &below);
    const double sided = (above - below) / (above + below + 0.2) * fmax(0, fmin((share - 0.06) / 0.1, 1)) *
                         (s->count / (s->count + 2000.0));
    return sided > 0 ? fmax(sided - 0.2, 0) : fmin(sided + 0.2, 0);
}

/* Compares sizes along an axis: median size of the Gaussians in the last eighth, relative to the first eighth. */
static double growth_of(const weighed *s, const double axis[3], double *values)
{
    const uint32_t step = s->count / GROWTH_POINTS + 1;
    double ends[2], size[2];
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->count; i += step)
        values[n++] = dot(s->points[i].place, axis);
    ends[0] = quantile(values, n, 8);
    ends[1] = values[n - 1 - n / 8];
    for (int end = 0; end < 2; end++) {
        n = 0;
        for (uint32_t i = 0; i < s->count; i += step) {
            const double along = dot(s->points[i].place, axis);
            if (end ? along >= ends[1] : along <= ends[0])
                values[n++] = s->points[i].size;
        }
        size[end] = quantile(values, n, 2);
    }
    return size[1] / size[0];
}

/* Picks the axis, y or z, that most flat Gaussians have as normal. Most files have y down, so z needs twice the share
   of y, and four times if the scene is tall along y. The refined axis must be clearly better, so that an upright scene
   stays upright. A wall captured from the front also faces z. Such a scene has its subjects on the -z side, or
   Gaussians that grow along z. */
static void choose_axis(const weighed *s, const fxs_core *core, int standing, double *values, fxs_ground *ground)
{
    static const double axes[2][3] = {{0, -1, 0}, {0, 0, 1}};
    double found[2][3], share[2], most[2];
    for (int i = 0; i < 2; i++) {
        double refined[3];
        memcpy(found[i], axes[i], sizeof refined);
        memcpy(refined, axes[i], sizeof refined);
        most[i] = share[i] = share_of(s, axes[i]);
        refine(s, refined);
        if (dot(refined, axes[i]) > TURNED)
            most[i] = fmax(share[i], share_of(s, refined));
        if (most[i] > 0.2 && most[i] > 1.5 * share[i]) {
            memcpy(found[i], refined, sizeof refined);
            share[i] = most[i];
        }
    }
    const double sided = sides_of(s, found[1], share[1]), grown = growth_of(s, found[1], values);
    const double sided_y = sides_of(s, found[0], share[0]);
    const int across = most[1] > (fxs_core_height(core, 1) > 1.4 ? 4 : 2) * most[0] && most[1] > 0.2 &&
                       (sided > 0 || (sided == 0 && grown < GROWN));
    const int z = standing ? standing == 2 : across;
    memcpy(ground->axis, found[z], sizeof ground->axis);
    ground->sided = z ? sided : sided_y;
}

int fxs_ground_find(fxs_ground *ground, const fxs_sample *sample, const fxs_core *core, int standing,
                    fxs_message *message)
{
    weighed s = {.points = sample->points, .count = sample->point_count};
    s.weights = fxs_allocate(NULL, 2 * (size_t)s.count, sizeof *s.weights);
    if (!s.weights)
        return fxs_fail_memory(message, NULL, 2 * s.count * sizeof *s.weights);
    weigh(&s);
    ground->spread = s.spread;
    choose_axis(&s, core, standing, s.weights + s.count, ground);
    fxs_release(NULL, s.weights);
    return 0;
}
