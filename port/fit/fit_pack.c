/* The Gaussians of a fit as the renderer draws them. */
#include "../files/run.h"
#include "fit_internal.h"

static fxs_pack_options pack_options(const fxs_fit *f)
{
    fxs_pack_options options = {.profile = f->options.profile, .run = f->options.run, .pool = f->options.pool,
                                .threads = f->options.threads};
    options.run = options.run ? options.run : fxs_run_here;
    return options;
}

/* Steps that are left when the packed profile is taken in. */
static uint32_t profile_steps(const fxs_fit *f)
{
    return f->options.steps / 10;
}

/* Steps and palette of the profile are found 16 times. */
int fxs_fit_pass_profile(fxs_fit *f, fxs_message *message)
{
    const uint32_t steps = profile_steps(f), first = f->options.steps - steps, every = (steps + 15) / 16;
    const fxs_pack_options options = pack_options(f);
    const int is_within = f->step >= first && f->step < f->options.steps, has_begun = f->profile.chunks != NULL;
    const int begins = is_within && !has_begun && f->model.count, ends = has_begun && f->step < first;
    const int codes = is_within && has_begun && (f->step - first) % every == 0;
    if (!begins && !ends && !codes)
        return 0;
    int error = f->engine->fetch(f->self, message);
    if (!error && ends)
        fxs_fit_profile_end(&f->profile, &f->model);
    else if (!error && begins)
        error = fxs_fit_profile_begin(&f->profile, &f->model, f->stepper, f->options.sh_degree, &options, message);
    else if (!error)
        error = fxs_fit_profile_code(&f->profile, &f->model, f->stepper, &options, message);
    return error ? error : f->engine->give(f->self, message);
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
