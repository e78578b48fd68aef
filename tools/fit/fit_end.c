/* Ends `fixsplat fit`: crops, writes and measures the scene, and prints tables, JSON or a verdict. */
#include "fit_verdict.h"

#include <inttypes.h>
#include <stdlib.h>

#include "src/base/os_calls.h"
#include "fit_result.h"

static void print_text(const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, const fit_result *r)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    printf("%s: %" PRIu64 " Gaussians, %zu bytes in the profile %s; %" PRIu32 " steps, recipe %s, seed %" PRIu64 "\n",
           c->out, r->report.packed, r->bytes, profile_names[o->profile], fxs_fit_steps(fit), fit_recipes[o->recipe],
           o->seed);
    if (photos->held_out_count)
        printf("Photographs fitted: %zu. Of the %zu held out:\n", photos->fit_count, photos->held_out_count);
    else
        printf("Photographs fitted: %zu. None was held out; of those fitted:\n", photos->fit_count);
    quality_print_text(&r->quality);
}

static void print_json_stages(const fit_progress *p)
{
    static const char *const names[FIT_STAGES] = {"project", "bin", "blend", "loss", "back", "update"};
    printf("{");
    for (int i = 0; i < FIT_STAGES; i++)
        printf("%s\"%s\": %.3f", i ? ", " : "", names[i],
               p->reports ? (double)p->stages[i] * 1e-6 / p->reports : 0);
    printf("}");
}

/* `verdict` may be null. */
static void print_json(const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, const fit_result *r,
                       const fit_progress *p, const fit_verdict *verdict)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    printf("{\"scene\": ");
    print_json_string(c->out);
    printf(", \"gaussians\": %" PRIu64 ", \"bytes\": %zu, \"profile\": \"%s\", \"recipe\": \"%s\", \"steps\": %" PRIu32
           ", \"seed\": %" PRIu64 ", \"seconds\": %.3f, \"fitted\": %zu, \"held_out\": %zu, \"skipped\": %zu, "
           "\"measured\": \"%s\", \"photographs\": ", r->report.packed, r->bytes, profile_names[o->profile],
           fit_recipes[o->recipe], fxs_fit_steps(fit), o->seed, fit_progress_seconds(p), photos->fit_count,
           photos->held_out_count, photos->skipped, photos->held_out_count ? "held out" : "fitted");
    quality_print_json(&r->quality);
    if (verdict)
        fit_verdict_print_json(verdict);
    printf(", \"stages_ms\": ");
    print_json_stages(p);
    puts("}");
}

static int print(const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, world *scene,
                 const fit_result *result, const fit_progress *p)
{
    fit_verdict verdict;
    const int is_judged = !c->blocks && (c->json || !is_quiet());
    const int status = is_judged ? fit_verdict_find(&verdict, c, fit, photos, scene, &result->quality) : 0;
    if (c->json)
        print_json(c, fit, photos, result, p, is_judged && !status ? &verdict : 0);
    else
        print_text(c, fit, photos, result);
    if (is_judged && !status && !c->json)
        fit_verdict_print_text(&verdict);
    return status;
}

void fit_print_measured(const fit_command *c, const fxs_photos *photos, const world *scene, const quality *q)
{
    const char *kind = photos->held_out_count ? "held out" : "fitted";
    if (c->json) {
        printf("{\"scene\": ");
        print_json_string(c->measure);
        printf(", \"gaussians\": %" PRIu32 ", \"measured\": \"%s\", \"photographs\": ", scene->gaussians, kind);
        quality_print_json(q);
        puts("}");
        return;
    }
    printf("%s: %" PRIu32 " Gaussians. Of the %ld photographs %s:\n", c->measure, scene->gaussians, q->count, kind);
    quality_print_text(q);
}

/* Crops the fitted scene to its subject. `whole` gets the uncropped scene, packed for measuring. */
static int crop(const fit_command *c, fxs_fit *fit, fxs_packed_scene *whole)
{
    fxs_fit_subject s;
    fxs_message why;
    int error = fxs_fit_pack(fit, whole, 0, &why);
    if (error) {
        fit_save_for_later(c, fit, "saved");
        return fail_for(&why);
    }
    error = fxs_fit_crop_to_subject(fit, &s, &why);
    if (error && error != FXS_ERR_ARGUMENT) {
        fxs_packed_scene_free(whole);
        return fail_for(&why);
    }
    if (error)
        note("%s: not cropped: %s", c->out, why.text);
    else
        note("%s: cropped to %.4g units around %.4g,%.4g,%.4g: %zu Gaussians left out", c->out, s.radius, s.middle[0],
             s.middle[1], s.middle[2], s.dropped);
    return 0;
}

static int write_scene(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
                       fxs_packed_scene *whole, fit_result *result)
{
    const int status = result_write(result, fit, photos, block, c->out);
    if (status) {
        fit_save_for_later(c, fit, "saved");
        return status;
    }
    if (!fxs_is_terminal(stderr))
        note("measuring %s", c->out);
    if (c->watcher)
        c->watcher->written(&result->packed, c->crops ? whole : &result->packed);
    return 0;
}

int fit_end(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
            const fit_progress *p)
{
    fxs_photos posed = *photos;
    fit_result result;
    world scene = {0};
    fxs_packed_scene whole = {0};
    posed.fit = 0;
    int status = c->crops ? crop(c, fit, &whole) : 0;
    if (status)
        return status;
    status = write_scene(c, fit, photos, block, &whole, &result);
    if (!status)
        status = world_open_packed(&scene, c->out, c->crops ? &whole : &result.packed);
    if (!status)
        status = result_pose(fit, photos, &posed.fit);
    if (!status && c->cameras)
        status = result_write_cameras(c->cameras, &posed);
    if (!status)
        status = result_measure(&result.quality, &scene, &posed, &c->frame, c->compare);
    if (p->counted > p->first)
        fit_log_write(c->log, p, status ? 0 : &result.quality);
    if (!status && c->watcher)
        c->watcher->measured(fxs_fit_steps(fit), &result.quality);
    if (!status)
        status = print(c, fit, &posed, &scene, &result, p);
    world_close(&scene);
    result_free(&result);
    fxs_packed_scene_free(&whole);
    free(posed.fit);
    return status;
}

int fit_write_outside(const fit_command *c, const fxs_fit_block *block)
{
    const int status = result_write_outside(block, c->out);
    if (!status && c->json) {
        printf("{\"scene\": ");
        print_json_string(c->out);
        printf(", \"gaussians\": %zu}\n", block->gaussian_count);
    } else if (!status)
        printf("%s: %zu Gaussians of %s outside of all blocks\n", c->out, block->gaussian_count, c->coarse);
    return status;
}
