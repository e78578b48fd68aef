/* Crops a finished fit to its subject: keeps a sphere around the point that the cameras look at. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/fit_more.h>
#include "src/base/try_internal.h"
#include "fit_internal.h"
#include "src/fit/stages/fit_lanes.h"

/* smallest determinant of the mean of 1 - d d^T over viewing directions d, if these differ enough (by some 6
   degrees) */
#define LEAST_SPREAD 0.01

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Finds the point p that the cameras look at, nearest to all viewing axes. With directions d and eyes e of the axes,
   mean (1 - d d^T) (p - e) = 0. Returns 0 if the axes are nearly parallel. */
static int find_middle(const fxs_fit *f, double middle[3])
{
    double a[3][3] = {{0}}, b[3] = {0, 0, 0}, inverse[3][3], determinant = 0;
    for (size_t i = 0; i < f->count; i++) {
        const float *d = f->photographs[i].camera.rotation + 6, *eye = f->photographs[i].camera.eye;
        for (int k = 0; k < 9; k++) {
            const double part = ((k % 4 == 0) - (double)d[k / 3] * (double)d[k % 3]) / (double)f->count;
            a[k / 3][k % 3] += part;
            b[k / 3] += part * (double)eye[k % 3];
        }
    }
    for (int k = 0; k < 3; k++)
        cross(inverse[k], a[(k + 1) % 3], a[(k + 2) % 3]);
    for (int k = 0; k < 3; k++)
        determinant += a[0][k] * inverse[0][k];
    for (int k = 0; k < 3; k++)
        middle[k] = (inverse[k][0] * b[0] + inverse[k][1] * b[1] + inverse[k][2] * b[2]) / determinant;
    return determinant > LEAST_SPREAD && isfinite(middle[0] + middle[1] + middle[2]);
}

/* Returns the distance from a camera's optical axis to the nearer edge of the picture, at the depth of `place`. Returns
   0 if `place` is not in the middle half of the picture. */
static double reach_at(const fxs_fit_camera *c, const double place[3])
{
    double at[3] = {0, 0, 0};
    for (int k = 0; k < 9; k++)
        at[k / 3] += (double)c->rotation[k] * (place[k % 3] - (double)c->eye[k % 3]);
    const double across = at[2] * c->width / 2 / (double)c->focal[0],
                 down = at[2] * c->height / 2 / (double)c->focal[1];
    return fabs(at[0]) <= across / 2 && fabs(at[1]) <= down / 2 ? fmin(across, down) : 0;
}

int fxs_fit_find_subject(const fxs_fit *f, fxs_fit_subject *subject, fxs_message *message)
{
    memset(subject, 0, sizeof *subject);
    double *reaches = malloc(f->count * sizeof *reaches);
    size_t count = 0;
    if (!reaches)
        return fxs_fail_memory(message, "a fit", f->count * sizeof *reaches);
    const int is_found = find_middle(f, subject->middle);
    for (size_t i = 0; i < f->count && is_found; i++) {
        reaches[count] = reach_at(&f->photographs[i].camera, subject->middle);
        count += reaches[count] > 0;
    }
    if (count) {
        qsort(reaches, count, sizeof *reaches, ascending);
        subject->radius = reaches[count / 2];
    }
    free(reaches);
    return 4 * count >= 3 * f->count && count
               ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "the cameras do not look at one thing: %zu of %zu "
                                 "photographs have the point that is nearest to all in their middle", count, f->count);
}

static int is_inside(const fxs_fit_model *m, size_t i, const fxs_fit_subject *subject)
{
    double square = 0, largest = 0;
    for (size_t k = 0; k < 3; k++) {
        const double d = (double)m->parameters[(FXS_FIT_POSITION + k) * m->stride + i] - subject->middle[k];
        const double sigma = (double)exp_e(m->parameters[(FXS_FIT_SCALE + k) * m->stride + i]);
        square += d * d;
        largest = sigma > largest ? sigma : largest;
    }
    return sqrt(square) + largest <= subject->radius;
}

int fxs_fit_crop_to_subject(fxs_fit *f, fxs_fit_subject *subject, fxs_message *message)
{
    FXS_TRY(fxs_fit_find_subject(f, subject, message));
    FXS_TRY(f->engine->fetch(f->self, message));
    const size_t bytes = (f->model.count + 1) * sizeof(fxs_fit_origin);
    fxs_fit_origin *origins = malloc(bytes);
    if (!origins)
        return fxs_fail_memory(message, "a fit", bytes);
    size_t count = 0;
    for (size_t i = 0; i < f->model.count; i++)
        if (is_inside(&f->model, i, subject))
            origins[count++] = (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT};
    subject->dropped = f->model.count - count;
    const int error = !count ? fxs_fail_as(FXS_ERR_ARGUMENT, message, "no Gaussian lies where the cameras look")
                      : subject->dropped ? fxs_fit_keep(f, origins, count, message)
                                         : 0;
    free(origins);
    return error;
}
