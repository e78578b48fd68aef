/* Saves and resumes an unfinished fit, in files of 32-bit little-endian words. The walk functions both read and write,
 * so that the two directions agree. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/files_internal.h"
#include "src/base/options.h"
#include "src/base/output_internal.h"
#include "coarse.h"
#include "src/base/random.h"

#define MAGIC 0x74696678u          /* first word of a file of a saved fit: "xfit" in ASCII */
#define END 0x646e6578u            /* last word of a file of a saved fit: "xend" in ASCII */

/* Version of the files of saved fits. Must increase with every change to a fit's computation, because a resumed fit
   would end differently. */
#define VERSION 62u                /* version number; version_of adds codes of some options to it */

typedef struct archive {
    fxs_output *output;
    FILE *input;
    uint64_t size, fetched;
    uint64_t checksum;
    const char *fault;             /* the first error while reading or writing; afterwards words read as 0 and nothing
                                      is written */
    int error;
    uint32_t repeats;              /* 1: the fit has repeated steps of its recipe */
    size_t at, end;
    uint8_t buffer[1 << 16];
} archive;

static void fail(archive *a, int error, const char *fault)
{
    if (!a->fault) {
        a->fault = fault;
        a->error = error;
    }
}

static void damaged(archive *a, const char *fault)
{
    fail(a, FXS_ERR_FILE, fault);
}

static void flush(archive *a)
{
    fxs_message message;
    if (fxs_output_write(a->output, a->buffer, a->at, &message))
        damaged(a, "");
    a->at = 0;
}

static void fetch(archive *a)
{
    a->at = 0;
    a->end = fread(a->buffer, 1, sizeof a->buffer, a->input) / 4 * 4;
    a->fetched += a->end;
    if (!a->end)
        damaged(a, "it ends early");
}

static void number(archive *a, uint32_t *value)
{
    if (a->at == a->end && !a->fault) {
        if (a->output)
            flush(a);
        else
            fetch(a);
    }
    if (a->fault) {
        *value = a->output ? *value : 0;
        return;
    }
    uint8_t *bytes = a->buffer + a->at;
    a->at += 4;
    if (a->output)
        for (int i = 0; i < 4; i++)
            bytes[i] = (uint8_t)(*value >> 8 * i);
    else
        *value = bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    a->checksum = fxs_random_mix(a->checksum ^ *value);
}

static void long_number(archive *a, uint64_t *value)
{
    uint32_t low = (uint32_t)*value, high = (uint32_t)(*value >> 32);
    number(a, &low);
    number(a, &high);
    *value = low | (uint64_t)high << 32;
}

static void floats(archive *a, float *values, size_t count)
{
    for (size_t i = 0; i < count && !a->fault; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        number(a, &bits);
        if ((bits & 0x7f800000) == 0x7f800000)
            damaged(a, "a number that is not finite");
        memcpy(&values[i], &bits, sizeof bits);
    }
}

static int holds(archive *a, uint64_t count, uint64_t words)
{
    const uint64_t passed = a->fetched - (a->end - a->at);
    if (!a->output && !a->fault && (passed > a->size || count > (a->size - passed) / (4 * words)))
        damaged(a, "it ends early");
    return !a->fault;
}

/* Returns the version number of a saved fit's file. It also encodes newer options, so that an older fixsplat can read a
   fit without them. */
static uint32_t version_of(const fxs_fit_options *o, uint32_t repeats)
{
    return VERSION + o->exposure + 3 * (uint32_t)o->refine_poses + 6 * (uint32_t)o->antialiased +
           12 * (uint32_t)(o->sky > 0) + 24 * (uint32_t)o->surfaces + 48 * repeats;
}

static int take_version(archive *a, fxs_fit_options *o, uint32_t version)
{
    o->exposure = (enum fxs_fit_exposure)((version - VERSION) % 3);
    o->refine_poses = (int)((version - VERSION) / 3 % 2);
    o->antialiased = (int)((version - VERSION) / 6 % 2);
    o->sky = (version - VERSION) / 12 % 2;
    o->surfaces = (int)((version - VERSION) / 24 % 2);
    a->repeats = (version - VERSION) / 48 % 2;
    return version == version_of(o, a->repeats);
}

static uint64_t fingerprint(const fxs_fit *f)
{
    uint64_t sum = f->count ^ (uint64_t)f->options.block << 48 ^ (uint64_t)f->options.blocks << 32 ^ f->options.coarse;
    for (size_t i = 0; i < f->count; i++) {
        const fxs_fit_photograph *p = &f->photographs[i];
        uint32_t words[sizeof p->camera / 4];
        memcpy(words, &p->camera, sizeof words);
        for (size_t k = 0; k < sizeof words / sizeof *words; k++)
            sum = fxs_random_mix(sum ^ words[k]);
        const size_t bytes = 3 * (size_t)p->camera.width * (size_t)p->camera.height;
        uint64_t eight = 0;
        for (size_t k = 0; k < bytes; k++) {
            eight = eight << 8 | p->pixels[k];
            if (k % 8 == 7 || k + 1 == bytes)
                sum = fxs_random_mix(sum ^ eight);
        }
        for (size_t k = 0; p->mask && k < bytes / 3; k++)
            if (!p->mask[k])
                sum = fxs_random_mix(sum ^ k);
    }
    return sum;
}

/* Saves or reads a key of each camera, to recognise it. A resumed fit gets the cameras themselves from the
   photographs. */
static void walk_cameras(archive *a, const fxs_fit *f, fxs_fit_coarse *coarse)
{
    uint64_t count = f->count;
    long_number(a, &count);
    if (!holds(a, count, 2))
        return;
    if (coarse && !(coarse->cameras = malloc(((size_t)count + 1) * sizeof *coarse->cameras))) {
        fail(a, FXS_ERR_MEMORY, "out of memory");
        return;
    }
    for (size_t i = 0; i < count && !a->fault; i++) {
        uint64_t key = i < f->count ? fxs_fit_camera_key(&f->photographs[i].camera) : 0;
        long_number(a, &key);
        if (coarse)
            coarse->cameras[coarse->camera_count++] = (fxs_fit_coarse_camera){key, (uint32_t)i};
    }
}

static uint32_t within(archive *a, uint32_t value, uint32_t low, uint32_t high)
{
    number(a, &value);
    if (value < low || value > high)
        damaged(a, "a number out of its range");
    return a->fault ? low : value;
}

static void walk_options(archive *a, fxs_fit_options *o)
{
    o->recipe = (enum fxs_fit_recipe)within(a, o->recipe, 0, FXS_FIT_FAST);
    o->steps = within(a, o->steps, 1, UINT32_MAX);
    o->sh_degree = (int)within(a, (uint32_t)o->sh_degree, 0, 3);
    o->max_gaussians = within(a, (uint32_t)o->max_gaussians, 1, FXS_MAX_COUNT);
    long_number(a, &o->seed);
    o->batch = within(a, o->batch, 1, FXS_FIT_BATCH);
    for (int c = 0; c < 3; c++)
        o->background[c] = (uint8_t)within(a, o->background[c], 0, 255);
    o->cutoff = (enum fxs_cutoff)within(a, o->cutoff, 0, FXS_CUTOFF_SQUARE);
    o->profile = (enum fxs_profile)within(a, o->profile, 0, FXS_PROFILE_SMALL);
    if (o->sky)
        o->sky = within(a, o->sky, 1, FXS_FIT_SKY_MOST);
}

static void check_parameters(archive *a, const fxs_fit_model *m, const float *parameters)
{
    for (size_t k = 0; k <= FXS_FIT_OPACITY; k++) {
        const float most = k < FXS_FIT_SCALE ? 1e37f : k < FXS_FIT_ROTATION || k == FXS_FIT_OPACITY ? 80 : INFINITY;
        for (size_t i = 0; i < m->count && !a->fault; i++)
            if (!(fabsf(parameters[k * m->stride + i]) <= most))
                damaged(a, "a number out of its range");
    }
}

static void walk_model(archive *a, fxs_fit_model *m)
{
    enum { WORDS = 3 * FXS_FIT_PARAMETERS + 2 };
    uint64_t count = m->count;
    long_number(a, &count);
    if (!holds(a, count, WORDS))
        return;
    if (!a->output && fxs_fit_model_room(m, (size_t)count)) {
        fail(a, FXS_ERR_MEMORY, "out of memory");
        return;
    }
    float *const planes[] = {m->parameters, m->means, m->squares};
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
            floats(a, planes[i] + k * m->stride, m->count);
    floats(a, m->by_centre, m->count);
    floats(a, m->views, m->count);
    check_parameters(a, m, m->parameters);
}

static int masters_block(void *argument, void *block, size_t bytes)
{
    floats(argument, block, bytes / sizeof(float));
    return 0;
}

static int bytes_block(void *argument, void *block, size_t bytes)
{
    uint8_t *of = block;
    for (size_t at = 0; at < bytes; at += 4) {
        uint32_t word = 0;
        for (size_t i = at; i < at + 4 && i < bytes; i++)
            word |= (uint32_t)of[i] << 8 * (i - at);
        number(argument, &word);
        for (size_t i = at; i < at + 4 && i < bytes; i++)
            of[i] = (uint8_t)(word >> 8 * (i - at));
    }
    return 0;
}

static void walk_profile(archive *a, fxs_fit *f)
{
    const uint32_t begun = within(a, f->profile.chunks != NULL, 0, 1);
    if (!begun || !holds(a, f->model.count, FXS_FIT_PARAMETERS))
        return;
    if (!a->output && (!f->model.count || fxs_fit_profile_allocate(&f->profile, &f->model, f->options.profile,
                                                                    f->options.sh_degree))) {
        fail(a, f->model.count ? FXS_ERR_MEMORY : FXS_ERR_FILE, "no Gaussians to be packed");
        return;
    }
    fxs_fit_profile_walk(&f->profile, &f->model, masters_block, bytes_block, a);
    check_parameters(a, &f->model, f->model.masters);
    if (!a->output && !a->fault && fxs_fit_profile_restore(&f->profile, &f->model))
        damaged(a, "a number out of its range");
}

static void walk_gains(archive *a, fxs_fit *f, const fxs_fit_coarse *coarse)
{
    enum { WORDS = sizeof *f->gains.of / sizeof(float) };
    const size_t count = coarse ? coarse->camera_count : f->count;
    if (!f->options.exposure || !holds(a, count, WORDS))
        return;
    if (coarse && !(f->gains.of = calloc(count + 1, sizeof *f->gains.of))) {
        fail(a, FXS_ERR_MEMORY, "out of memory");
        return;
    }
    for (size_t i = 0; i < count && !a->fault; i++) {
        fxs_fit_gain *gain = &f->gains.of[i];
        floats(a, (float *)gain, WORDS);
        int is_wrong = gain->square < 0;
        for (int k = 0; k < FXS_FIT_GAIN; k++)
            is_wrong |= fabsf(gain->at[k]) > 2 * FXS_FIT_GAIN_MOST;
        for (int k = 0; k < 2; k++)
            is_wrong |= gain->of_one[k] < 0 || gain->of_one[k] > 1;
        for (int k = 0; k < FXS_FIT_BASIS; k++)
            is_wrong |= fabsf(gain->basis[k]) > 1;
        if (is_wrong)
            damaged(a, "a number out of its range");
    }
}

static void walk_poses(archive *a, fxs_fit *f, const fxs_fit_coarse *coarse)
{
    enum { WORDS = sizeof *f->poses.of / sizeof(float) };
    const size_t count = coarse ? coarse->camera_count : f->count;
    if (!f->options.refine_poses || !holds(a, count, WORDS))
        return;
    if (coarse && !(f->poses.of = calloc(count + 1, sizeof *f->poses.of))) {
        fail(a, FXS_ERR_MEMORY, "out of memory");
        return;
    }
    for (size_t i = 0; i < count && !a->fault; i++) {
        fxs_fit_pose *pose = &f->poses.of[i];
        floats(a, (float *)pose, WORDS);
        int is_wrong = pose->depth < 0 || pose->depth > FXS_FIT_FARTHEST_PLACE;
        for (int k = 0; k < FXS_FIT_POSE; k++)
            is_wrong |= fabsf(pose->at[k]) > (k < 3 ? FXS_FIT_TURN_MOST : FXS_FIT_FARTHEST_PLACE);
        for (int k = 0; k < 2; k++)
            is_wrong |= pose->square[k] < 0 || pose->of_one[k] < 0 || pose->of_one[k] > 1;
        if (is_wrong)
            damaged(a, "a number out of its range");
    }
}

static void walk_far(archive *a, fxs_fit *f)
{
    fxs_fit_far *far = &f->far;
    if (!f->options.sky)
        return;
    floats(a, (float *)far, sizeof *far / sizeof(float));
    int is_wrong = far->inverse < 0 || far->inverse > FXS_FIT_INVERSE_MOST;
    for (int k = 0; k < 3; k++)
        is_wrong |= fabsf(far->middle[k]) > FXS_FIT_FARTHEST_PLACE;
    if (is_wrong)
        damaged(a, "a number out of its range");
}

/* Saves or reads all data of a fit that a step changes and the next step needs. Add new fields of the struct fxs_fit
   here. */
static void walk(archive *a, fxs_fit *f, const fxs_fit_coarse *coarse)
{
    number(a, &f->step);
    floats(a, &f->extent, 1);
    walk_far(a, f);
    walk_model(a, &f->model);
    walk_profile(a, f);
    walk_gains(a, f, coarse);
    walk_poses(a, f, coarse);
    if (a->repeats) {
        f->repeated = within(a, f->repeated, 1, f->step);
        f->reached = within(a, f->reached, 0, f->step);
        f->most = within(a, f->most, 0, FXS_MAX_COUNT);
    }
}

static void walk_end(archive *a)
{
    uint32_t end = END;
    number(a, &end);
    const uint64_t right = a->checksum;
    uint64_t sum = right;
    long_number(a, &sum);
    if (end != END || sum != right)
        damaged(a, "its checksum is not right");
}

static void write_all(archive *a, fxs_fit *f)
{
    a->repeats = f->repeated > 0;
    uint32_t magic = MAGIC, version = version_of(&f->options, a->repeats);
    uint64_t photographs = fingerprint(f);
    number(a, &magic);
    number(a, &version);
    walk_options(a, &f->options);
    long_number(a, &photographs);
    walk_cameras(a, f, NULL);
    walk(a, f, NULL);
    walk_end(a);
    if (!a->fault)
        flush(a);
}

int fxs_fit_save(fxs_fit *f, const char *path, fxs_message *message)
{
    fxs_output output;
    archive *a = malloc(sizeof *a);
    if (!a)
        return fxs_fail_memory(message, path, sizeof *a);
    int error = f->engine->fetch(f->self, message);
    if (!error)
        error = fxs_output_open(&output, path, 0, message);
    if (!error) {
        memset(a, 0, sizeof *a);
        a->output = &output;
        a->end = sizeof a->buffer;
        write_all(a, f);
        if (a->fault && !output.error)
            output.error = EDOM;
        error = fxs_output_close(&output, message);
    }
    free(a);
    return error;
}

static int open_input(archive *a, const char *path, fxs_message *message)
{
    fxs_file_facts facts;
    memset(a, 0, sizeof *a);
    FXS_TRY(fxs_file_open(path, &a->input, &facts, message));
    a->size = facts.size;
    return 0;
}

static int read_head(archive *a, const char *path, fxs_fit_options *options, fxs_message *message)
{
    uint32_t magic, version;
    number(a, &magic);
    number(a, &version);
    if (magic != MAGIC)
        return fxs_fail(message, "%s: not a saved fit", path);
    if (!a->fault && !take_version(a, options, version))
        return fxs_fail_as(FXS_ERR_VERSION, message, "%s: a fit that another version saved", path);
    walk_options(a, options);
    return a->fault ? fxs_fail(message, "%s: damaged: %s", path, a->fault) : 0;
}

static int read_rest(archive *a, const char *path, fxs_fit *f, fxs_fit_coarse *coarse, fxs_message *message)
{
    uint64_t photographs = 0;
    long_number(a, &photographs);
    if (!a->fault && !coarse && photographs != fingerprint(f))
        return fxs_fail(message, "%s: a fit of other photographs, or of these at another size", path);
    walk_cameras(a, f, coarse);
    walk(a, f, coarse);
    if (coarse)
        coarse->number = a->checksum;
    walk_end(a);
    if (!a->fault && (a->at < a->end || a->fetched != a->size))
        damaged(a, "there is more behind its end");
    if (!a->fault)
        return 0;
    return a->error == FXS_ERR_MEMORY ? fxs_fail_memory(message, path, a->size)
                                      : fxs_fail(message, "%s: damaged: %s", path, a->fault);
}

static int resume(fxs_fit **fit, archive *a, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                  const fxs_fit_options *options, fxs_message *message)
{
    fxs_fit_options all;
    fxs_fit_options_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_fit_options, &all, options, message));
    const uint32_t steps = all.steps;
    FXS_TRY(read_head(a, path, &all, message));
    all.steps = steps ? steps : all.steps;
    FXS_TRY(fxs_fit_begin(fit, photos, photo_count, &all, message));
    FXS_TRY(read_rest(a, path, *fit, NULL, message));
    fxs_fit_set_order(*fit, (uint64_t)(*fit)->step * (*fit)->options.batch);
    return fxs_fit_hand_over(*fit, message);
}

static void close_input(archive *a)
{
    if (a->input)
        fclose(a->input);
    free(a);
}

int fxs_fit_resume(fxs_fit **fit, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                   const fxs_fit_options *options, fxs_message *message)
{
    archive *a = malloc(sizeof *a);
    *fit = NULL;
    if (!a)
        return fxs_fail_memory(message, path, sizeof *a);
    int error = open_input(a, path, message);
    if (!error)
        error = resume(fit, a, path, photos, photo_count, options, message);
    close_input(a);
    if (error) {
        fxs_fit_destroy(*fit);
        *fit = NULL;
    }
    return error;
}

int fxs_fit_checkpoint_read(fxs_fit_coarse *coarse, const char *path, fxs_message *message)
{
    archive *a = malloc(sizeof *a);
    if (!a)
        return fxs_fail_memory(message, path, sizeof *a);
    int error = open_input(a, path, message);
    if (!error)
        error = read_head(a, path, &coarse->fit->options, message);
    if (!error)
        error = read_rest(a, path, coarse->fit, coarse, message);
    close_input(a);
    return error;
}
