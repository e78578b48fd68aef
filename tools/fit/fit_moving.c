/* Runs `fixsplat fit --moving`: fits the first moment as a still scene, then each next moment from the last one. At the
   end all moments are refined together, and packed as one scene that moves. */
#include "fit_verdict.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "src/fit/moving.h"
#include "src/fit/photos/moments.h"
#include "src/scene/sequence.h"
#include "tools/command/file_guard.h"
#include "tools/command/task.h"
#include "film_frames.h"
#include "fit_result.h"

enum { BATCH = 256, FRAMES_MOST = 8192,
       RECENT = 8,                 /* number of moments that are refined after each moment */
       RECENT_SHARE = 4 };         /* with --refine-steps divided by this */

#define KEPT_BYTES (UINT64_C(2) << 30)  /* photographs of up to this many bytes stay in memory */

#define UNEVEN 0.02                /* largest difference of a moment from even times, in distances of two moments */

typedef struct moment {
    size_t tried, moved;
    quality quality;
} moment;

typedef struct moving_fit {
    fit_command *c;
    fxs_moments *moments;
    size_t count, fitted, held_out;
    double rate;                   /* moments a second */
    fxs_fit *fit;
    fxs_sequence *sequence;
    fxs_packed_scene packed;
    fxs_pack_report report;
    moment *results;
    fxs_photos *photos;            /* photographs of each moment that stay in memory, and of one that does not */
    fxs_photos passing;
    uint64_t kept_bytes;
    double seconds;
    char frames[TASK_PATH];        /* folder with a folder of frames for each film, or empty */
} moving_fit;

static int no_memory(void)
{
    return fail(EXIT_FAILED, "out of memory");
}

typedef struct films {
    const char *from, *to;         /* folder of the films; folder that gets a folder of frames for each */
    task t;
    int status;
} films;

/* Takes all frames of a film of the folder, unless an earlier command has taken them. */
static void take_film(void *argument, const char *name)
{
    films *f = argument;
    char film[TASK_PATH], stem[TASK_PATH], folder[TASK_PATH];
    if (!film_is_named(name) || f->status)
        return;
    snprintf(stem, sizeof stem, "%.*s", (int)(strrchr(name, '.') - name), name);
    join_path(film, f->from, name);
    join_path(folder, f->to, stem);
    f->t.of = film;
    if (!is_folder(folder))
        f->status = film_frames(&f->t, film, FRAMES_MOST, folder);
}

static void look_for_film(void *argument, const char *name)
{
    *(int *)argument |= film_is_named(name);
}

/* Takes the frames of the films beside the cameras, which are named as the cameras, into the folder OUT.moments. */
static int take_films(moving_fit *m)
{
    films f = {.from = m->c->in, .to = m->frames};
    char log[TASK_PATH];
    int has_films = 0;
    if (!is_folder(m->c->in) || strlen(m->c->out) > TASK_PATH - 64)
        return 0;
    fxs_folder_each(m->c->in, look_for_film, &has_films);
    if (!has_films)
        return 0;
    snprintf(m->frames, sizeof m->frames, "%s.moments", m->c->out);
    join_path(log, m->frames, "log.txt");
    f.status = make_folder(m->frames);
    f.t.log_name = log;
    f.t.log = f.status ? 0 : fxs_stream_open(log, "a");
    if (!f.status && !f.t.log)
        return fail(EXIT_FAILED, "%s: cannot be written", log);
    if (!f.status)
        fxs_folder_each(m->c->in, take_film, &f);
    if (f.t.log)
        fclose(f.t.log);
    return f.status;
}

static int open_moments(moving_fit *m)
{
    fxs_message why;
    const fit_command *c = m->c;
    const int status = take_films(m);
    const fxs_moments_options how = {*m->frames ? m->frames : 0, c->fps};
    if (status)
        return status;
    if (fxs_moments_open(&m->moments, c->in, &c->reading, &how, &why))
        return fail_for(&why);
    m->count = fxs_moments_count(m->moments);
    const double first = fxs_moments_time(m->moments, 0), last = fxs_moments_time(m->moments, m->count - 1);
    const double step = (last - first) / (double)(m->count - 1);
    for (size_t i = 0; i < m->count; i++)
        if (fabs(fxs_moments_time(m->moments, i) - first - step * (double)i) > UNEVEN * step)
            return fail(EXIT_FAILED, "%s: moment %zu is at %g, not at %g: the times are not even", c->in, i,
                        fxs_moments_time(m->moments, i), first + step * (double)i);
    m->rate = c->fps > 0 ? c->fps : 1 / step;
    if (!(m->rate <= 1000))
        return fail(EXIT_FAILED, "%s: %g moments a second, which is above 1000: give --fps", c->in, m->rate);
    m->results = calloc(m->count, sizeof *m->results);
    m->photos = calloc(m->count, sizeof *m->photos);
    return m->results && m->photos ? 0 : no_memory();
}

static uint64_t bytes_of(const fxs_fit_photo *photos, size_t count)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += (photos[i].mask ? UINT64_C(4) : UINT64_C(3)) * (uint64_t)photos[i].view.width *
                 (uint64_t)photos[i].view.height;
    return bytes;
}

/* Sets *photos to the photographs of a moment. They stay at least until the next call. */
static int take_photos(moving_fit *m, size_t number, const fxs_photos **photos, fxs_message *why)
{
    *photos = &m->photos[number];
    if (m->photos[number].fit)
        return 0;
    fxs_photos_free(&m->passing);
    const int error = fxs_moments_read(m->moments, number, &m->passing, why);
    progress_end();
    if (error)
        return error;
    const uint64_t bytes = bytes_of(m->passing.fit, m->passing.fit_count) +
                           bytes_of(m->passing.held_out, m->passing.held_out_count);
    if (m->kept_bytes + bytes > KEPT_BYTES) {
        *photos = &m->passing;
        return 0;
    }
    m->kept_bytes += bytes;
    m->photos[number] = m->passing;
    memset(&m->passing, 0, sizeof m->passing);
    return 0;
}

static int read_moment(void *argument, size_t number, const fxs_fit_photo **photos, fxs_message *why)
{
    const fxs_photos *all;
    const int error = take_photos(argument, number, &all, why);
    *photos = error ? 0 : all->fit;
    return error;
}

/* Adds the Gaussians of the fit as the next frame of the scene. */
static int add_frame(moving_fit *m)
{
    fxs_gaussian_source source;
    fxs_message why;
    fxs_gaussian some[BATCH];
    long count = 0;
    if (fxs_fit_gaussians(m->fit, &source, &why))
        return fail_for(&why);
    for (uint64_t i = 0; i < source.count; i += (uint64_t)count) {
        count = source.read(source.argument, i, some, BATCH);
        for (long k = 0; k < count; k++)
            if (fxs_sequence_put(m->sequence, &some[k]))
                return no_memory();
    }
    return fxs_sequence_next(m->sequence) ? no_memory() : 0;
}

static int fit_first(moving_fit *m, const fxs_photos *photos)
{
    fit_command *c = m->c;
    fit_progress progress;
    fxs_message why;
    int status = fit_open(c, photos, 0, &m->fit);
    if (status)
        return status;
    fxs_fit_set_moving(m->fit);
    status = fit_make_steps(c, m->fit, photos, &progress);
    if (!status && fxs_fit_begin_moving(m->fit, &why))
        status = fail_for(&why);
    m->sequence = status ? 0 : fxs_sequence_create((uint32_t)m->count, m->rate, fxs_fit_options_of(m->fit)->sh_degree,
                                                   0);
    return status || m->sequence ? status : no_memory();
}

static int refine(moving_fit *m, size_t first, uint32_t steps, double *absolute)
{
    fxs_message why;
    return steps && fxs_fit_refine_moving(m->fit, first, steps, read_moment, m, absolute, &why) ? fail_for(&why) : 0;
}

static int refine_all(moving_fit *m)
{
    double absolute = 0;
    const int status = refine(m, 0, m->c->refine_steps * (uint32_t)m->count, &absolute);
    if (!status && m->c->refine_steps)
        note("all moments: mean difference %.4f", absolute);
    return status;
}

static int fit_next(moving_fit *m, size_t i)
{
    const fxs_photos *photos;
    fxs_message why;
    fxs_fit_followed followed;
    double unwanted = 0;
    if (take_photos(m, i, &photos, &why) ||
        fxs_fit_follow(m->fit, photos->fit, m->c->moment_steps, &followed, &why))
        return fail_for(&why);
    m->results[i].tried = followed.tried;
    m->results[i].moved = followed.moved;
    note("moment %zu of %zu: mean difference %.4f, %zu Gaussians moved of %zu tried, %zu are new", i + 1, m->count,
         followed.absolute, followed.moved, followed.tried, followed.added);
    return refine(m, i < RECENT ? 0 : i + 1 - RECENT, m->c->refine_steps / RECENT_SHARE, &unwanted);
}

static int fit_all(moving_fit *m)
{
    const fxs_photos *photos;
    fxs_message why;
    if (take_photos(m, 0, &photos, &why))
        return fail_for(&why);
    m->fitted = photos->fit_count;
    m->held_out = photos->held_out_count;
    note("%s: %zu moments", m->c->in, m->count);
    fit_say_photos(m->c, photos, photos->point_count);
    int status = fit_first(m, photos);
    for (size_t i = 1; i < m->count && !status; i++)
        status = fit_next(m, i);
    status = status ? status : refine_all(m);
    for (size_t i = 0; i < m->count && !status; i++) {
        fxs_fit_set_moment(m->fit, i);
        status = add_frame(m);
    }
    return status;
}

/* ---- The scene --------------------------------------------------------------------------------------------------- */

typedef struct reader {
    const fxs_sequence *sequence;
    fxs_motion motions[BATCH];
} reader;

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    reader *r = argument;
    const uint64_t left = fxs_sequence_count(r->sequence) - first;
    const size_t most = capacity < BATCH ? capacity : BATCH, count = left < most ? (size_t)left : most;
    fxs_sequence_get(r->sequence, first, count, out, r->motions);
    return (long)count;
}

static int read_motions(void *argument, uint64_t first, fxs_motion *out, size_t count)
{
    const reader *r = argument;
    (void)first;
    memcpy(out, r->motions, count * sizeof *out);
    return 0;
}

static int pack(moving_fit *m, fxs_message *why)
{
    const fxs_fit_options *o = fxs_fit_options_of(m->fit);
    reader r = {.sequence = m->sequence};
    fxs_motion_source motions = {.size = sizeof motions, .read = read_motions, .argument = &r};
    fxs_gaussian_source source;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const fxs_pack_options how = {.size = sizeof how, .profile = o->profile, .workers = o->workers};
    memset(&source, 0, sizeof source);
    if (fxs_sequence_finish(m->sequence, &motions.time))
        return fxs_fail_memory(why, m->c->out, fxs_sequence_bytes(m->sequence));
    source.count = fxs_sequence_count(m->sequence);
    source.sh_degree = o->sh_degree;
    source.antialiased = o->antialiased;
    source.read = read_gaussians;
    source.argument = &r;
    int error = fxs_scene_file_open_moving(m->c->out, &source, &motions, 0, &file, &info, why);
    if (error)
        return error;
    error = fxs_pack(file, &info, &m->packed, &m->report, &how, why);
    fxs_scene_file_close(file);
    return error;
}

static int write_scene(moving_fit *m)
{
    fxs_message why;
    const fxs_photos *photos;
    int error = pack(m, &why);
    if (!error)
        error = take_photos(m, 0, &photos, &why);
    if (error)
        return fail_for(&why);
    /* A failure is no fault: only the up direction is of use, and fxs_start_choose finds a missing one. */
    (void)fxs_fit_start_view(photos->fit, photos->fit_count, m->packed.data, &why);
    error = fxs_start_choose(m->packed.data, m->packed.bytes, &why);
    error = error ? error : fxs_file_write(m->c->out, m->packed.data, m->packed.bytes, &why);
    return error ? fail_for(&why) : 0;
}

/* ---- How it looks ------------------------------------------------------------------------------------------------ */

static int measure_moment(moving_fit *m, world *scene, size_t i)
{
    char folder[4096];
    const fxs_photos *photos;
    fxs_message why;
    frame_options frame = m->c->frame;
    if (take_photos(m, i, &photos, &why))
        return fail_for(&why);
    frame.render.time_q32 = (int64_t)llrint(ldexp((double)i / m->rate, 32));
    int status = 0;
    if (m->c->compare) {
        snprintf(folder, sizeof folder, "%s/%04zu", m->c->compare, i);
        status = make_folder(folder);
        result_tell_pictures(photos, folder);
        status = status ? status : files_check();
    }
    if (!status)
        status = result_measure(&m->results[i].quality, scene, photos, &frame, m->c->compare ? folder : 0);
    return status;
}

static void sum_up(const moving_fit *m, double *mean, double *ssim, size_t *worst)
{
    *mean = *ssim = 0;
    *worst = 0;
    for (size_t i = 0; i < m->count; i++) {
        *mean += m->results[i].quality.psnr / (double)m->count;
        *ssim += m->results[i].quality.ssim / (double)m->count;
        *worst = m->results[i].quality.psnr < m->results[*worst].quality.psnr ? i : *worst;
    }
}

static void print_text(const moving_fit *m)
{
    char psnr[32];
    double mean, ssim;
    size_t worst;
    sum_up(m, &mean, &ssim, &worst);
    printf("%s: %zu moments, %g a second; %" PRIu64 " Gaussians, %zu bytes in the profile %s\n", m->c->out, m->count,
           m->rate, m->report.packed, m->packed.bytes, profile_names[fxs_fit_options_of(m->fit)->profile]);
    printf("Photographs fitted at each moment: %zu. Of %s:\n", m->fitted,
           m->held_out ? "those held out" : "those fitted, as none is held out");
    printf("    time    PSNR    SSIM    moved\n");
    for (size_t i = 0; i < m->count; i++)
        printf("%8.3f  %6.6s  %6.4f  %7zu\n", (double)i / m->rate,
               fxs_metrics_psnr(psnr, m->results[i].quality.psnr, "equal"), m->results[i].quality.ssim,
               m->results[i].moved);
    printf("    mean  %6.6s  %6.4f\n", fxs_metrics_psnr(psnr, mean, "equal"), ssim);
    printf("   worst  %6.6s  at %.3f\n", fxs_metrics_psnr(psnr, m->results[worst].quality.psnr, "equal"),
           (double)worst / m->rate);
    if (!is_quiet()) {
        const fit_verdict verdict = fit_verdict_of_moving(m->c, mean, m->held_out > 0);
        fit_verdict_print_text(&verdict);
    }
}

static void print_json(const moving_fit *m)
{
    printf("{\"scene\": ");
    print_json_string(m->c->out);
    printf(", \"gaussians\": %" PRIu64 ", \"bytes\": %zu, \"rate\": %.9g, \"fitted\": %zu, \"held_out\": %zu, "
           "\"measured\": \"%s\", \"seconds\": %.3f, \"moments\": [", m->report.packed, m->packed.bytes, m->rate,
           m->fitted, m->held_out, m->held_out ? "held out" : "fitted", m->seconds);
    for (size_t i = 0; i < m->count; i++) {
        printf("%s{\"time\": %.6f, \"moved\": %zu, \"tried\": %zu, \"photographs\": ", i ? ", " : "",
               (double)i / m->rate, m->results[i].moved, m->results[i].tried);
        quality_print_json(&m->results[i].quality);
        printf("}");
    }
    puts("]}");
}

static int measure_all(moving_fit *m)
{
    world scene = {0};
    int status = world_open_packed(&scene, m->c->out, &m->packed);
    for (size_t i = 0; i < m->count && !status; i++)
        status = measure_moment(m, &scene, i);
    world_close(&scene);
    return status;
}

int fit_moving(fit_command *c)
{
    moving_fit m = {.c = c};
    const uint64_t start = fxs_clock(0);
    int status = open_moments(&m);
    status = status ? status : fit_all(&m);
    status = status ? status : write_scene(&m);
    m.seconds = (double)(fxs_clock(0) - start) * 1e-9;
    status = status ? status : measure_all(&m);
    if (!status && c->json)
        print_json(&m);
    else if (!status)
        print_text(&m);
    for (size_t i = 0; i < m.count && m.results; i++)
        quality_free(&m.results[i].quality);
    free(m.results);
    for (size_t i = 0; i < m.count && m.photos; i++)
        fxs_photos_free(&m.photos[i]);
    free(m.photos);
    fxs_photos_free(&m.passing);
    fxs_packed_scene_free(&m.packed);
    fxs_sequence_free(m.sequence);
    fxs_fit_destroy(m.fit);
    fxs_moments_free(m.moments);
    return status;
}
