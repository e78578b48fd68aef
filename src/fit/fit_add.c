/* Adds photographs and points to a running fit. While more photographs may come, the fit repeats a part of its
 * recipe. */
#include <stdlib.h>

#include <fixsplat/internal/fit_more.h>
#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"
#include "fit_internal.h"
#include "recipe.h"

static int check(const fxs_fit *f, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                 size_t point_count, fxs_message *message)
{
    const char *wrong = f->options.blocks        ? "is of a block"
                        : f->is_moving || f->moving ? "is of a scene that moves"
                        : f->profile.chunks      ? "is in its last tenth"
                        : photo_count < f->count ? "has more photographs than are given"
                                                 : NULL;
    if (wrong)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no photographs can be added: the fit %s", wrong);
    FXS_TRY(fxs_fit_check_photographs(photos, photo_count, message));
    return point_count ? fxs_fit_check_points(photos, photo_count, points, point_count, message) : 0;
}

static void *lengthen(void *array, size_t count, size_t size, int *error)
{
    void *longer = realloc(array, count * size);
    *error = longer ? *error : FXS_ERR_MEMORY;
    return longer ? longer : array;
}

static int add_photographs(fxs_fit *f, const fxs_fit_photo *photos, size_t count)
{
    int error = 0;
    f->photographs = lengthen(f->photographs, count, sizeof *f->photographs, &error);
    f->order = lengthen(f->order, count, sizeof *f->order, &error);
    f->gains.of = lengthen(f->gains.of, count, sizeof *f->gains.of, &error);
    f->poses.of = lengthen(f->poses.of, count, sizeof *f->poses.of, &error);
    f->cameras.of = lengthen(f->cameras.of, count, sizeof *f->cameras.of, &error);
    if (error)
        return error;
    for (size_t i = f->count; i < count; i++)
        fxs_fit_set_photograph(f, i, &photos[i]);
    f->count = count;
    f->gains.count = f->poses.count = f->cameras.count = (uint32_t)count;
    fxs_fit_set_order(f, (uint64_t)f->step * f->options.batch);
    return 0;
}

/* Adds a Gaussian at each point. Of more points than max_gaussians leaves room for, takes evenly spaced ones. */
static int add_gaussians(fxs_fit *f, const fxs_fit_point *points, size_t count)
{
    const size_t room = f->options.max_gaussians > f->model.count ? f->options.max_gaussians - f->model.count : 0;
    const size_t most = count < room ? count : room;
    fxs_fit_point *chosen = malloc((most + 1) * sizeof *chosen);
    for (size_t i = 0; i < most && chosen; i++)
        chosen[i] = points[(size_t)((uint64_t)i * count / most)];
    const int error = !chosen ? FXS_ERR_MEMORY
                      : most  ? fxs_fit_model_add(&f->model, chosen, most, fxs_fit_first_opacity(f->options.recipe),
                                                  fxs_fit_first_scale(f->options.recipe))
                              : 0;
    free(chosen);
    return error;
}

/* Lets the Gaussians of new points grow in number as the Gaussians of the first points have grown. */
static void add_room(fxs_fit *f, size_t points)
{
    const double more = (double)points * fxs_fit_growth(&f->options, f->reached), most = (double)f->most + more;
    f->most = most < FXS_MAX_COUNT ? (uint32_t)most : FXS_MAX_COUNT;
}

int fxs_fit_add_photos(fxs_fit *f, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                       size_t point_count, fxs_message *message)
{
    const size_t first = f->count;
    FXS_TRY(check(f, photos, photo_count, points, point_count, message));
    FXS_TRY(f->engine->fetch(f->self, message));
    if (add_photographs(f, photos, photo_count) || add_gaussians(f, points, point_count))
        return fxs_fail_memory(message, "a fit",
                               (f->model.count + point_count) * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    if (f->repeated)
        add_room(f, point_count);
    const float extent = fxs_fit_extent(photos, photo_count, points, point_count);
    if (!(f->options.extent > 0) && extent > f->extent)
        f->extent = extent;
    fxs_fit_begin_poses(f, first, points, point_count);
    return fxs_fit_hand_over(f, message);
}

int fxs_fit_repeat(fxs_fit *f, uint32_t steps, fxs_message *message)
{
    if (steps > f->step - f->repeated || f->profile.chunks || steps > UINT32_MAX - f->repeated - f->options.steps)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a fit after %u steps cannot repeat %u", (unsigned)f->step,
                           (unsigned)steps);
    if (f->step - f->repeated > f->reached) {
        f->reached = f->step - f->repeated;
        f->most = (uint32_t)f->model.count;
    }
    f->repeated += steps;
    return 0;
}

uint32_t fxs_fit_repeated(const fxs_fit *f)
{
    return f->repeated;
}
