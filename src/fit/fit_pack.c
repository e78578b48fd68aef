/* Returns and packs the fitted Gaussians, and runs the last phase of a fit, which quantises them (profile.h). */
#include <fixsplat/internal/message.h>
#include "src/base/run.h"
#include "src/base/try_internal.h"
#include "fit_internal.h"

static fxs_pack_options pack_options(const fxs_fit *f)
{
    fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = f->options.profile,
                                .workers.run = f->options.workers.run, .workers.pool = f->options.workers.pool,
                                .workers.count = f->options.workers.count};
    options.workers.run = options.workers.run ? options.workers.run : fxs_run_here;
    return options;
}

static uint32_t profile_steps(const fxs_fit *f)
{
    return f->options.steps / 10;
}

static int code_again(fxs_fit *f, const fxs_pack_options *options, fxs_message *message)
{
    const int has_palette = f->profile.palette != NULL;
    int error = has_palette ? f->engine->fetch(f->self, message) : f->engine->fetch_masters(f->self, message);
    if (!error)
        error = fxs_fit_profile_code(&f->profile, &f->model, options, message);
    return error || !has_palette ? error : f->engine->give(f->self, message);
}

static int begin(fxs_fit *f, const fxs_pack_options *options, fxs_message *message)
{
    int error = f->engine->fetch(f->self, message);
    if (!error)
        error = fxs_fit_profile_begin(&f->profile, &f->model, f->options.sh_degree, options, message);
    return error ? error : f->engine->give(f->self, message);
}

static int end(fxs_fit *f, fxs_message *message)
{
    const int error = f->engine->fetch(f->self, message);
    if (error)
        return error;
    fxs_fit_profile_end(&f->profile, &f->model);
    return f->engine->give(f->self, message);
}

/* Starts, updates or ends the quantisation of the Gaussians in the last steps of a fit. Updates its ranges and palette
   16 times, at even intervals. */
int fxs_fit_pass_profile(fxs_fit *f, fxs_message *message)
{
    const uint32_t steps = profile_steps(f), first = f->options.steps - steps, every = (steps + 15) / 16;
    const uint32_t step = f->step - f->repeated;
    const fxs_pack_options options = pack_options(f);
    const int is_within = step >= first && step < f->options.steps, has_begun = f->profile.chunks != NULL;
    const int begins = is_within && !has_begun && f->model.count && !f->is_moving, ends = has_begun && step < first;
    const int codes = is_within && has_begun && (step - first) % every == 0;
    if (ends)
        return end(f, message);
    if (!begins && !codes)
        return 0;
    const int error = begins ? begin(f, &options, message) : code_again(f, &options, message);
    return error ? error : f->engine->quantise(f->self, message);
}

int fxs_fit_keep(fxs_fit *f, const fxs_fit_origin *origins, size_t count, fxs_message *message)
{
    const int is_coded = f->profile.chunks != NULL;
    const fxs_pack_options options = pack_options(f);
    FXS_TRY(is_coded ? end(f, message) : f->engine->fetch(f->self, message));
    if (fxs_fit_model_rebuild(&f->model, origins, count, options.workers.run, options.workers.pool))
        return fxs_fail_memory(message, "a fit", count * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    FXS_TRY(f->engine->give(f->self, message));
    if (!is_coded)
        return 0;
    FXS_TRY(begin(f, &options, message));
    return f->engine->quantise(f->self, message);
}

int fxs_fit_pack(fxs_fit *f, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message)
{
    const fxs_pack_options options = pack_options(f);
    fxs_gaussian_source gaussians;
    fxs_pack_report unwanted;
    const int error = fxs_fit_gaussians(f, &gaussians, message);
    return error ? error : fxs_fit_profile_pack(&f->profile, &f->model, &gaussians, scene,
                                                report ? report : &unwanted, &options, message);
}
