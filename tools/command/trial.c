#include "trial.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/renderer.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#include "src/base/os_calls.h"
#include "procedural.h"

/* A back end draws the small frame first. If it takes SLOWER times as long as the processor, the large one is left out:
   a driver in software takes 100 times as long for the small one, and seconds for the large one. */
enum { SIZES = 2, FRAMES = 5, SLOWER = 32, LONGEST_US = 999999999 };

static const struct {
    int width, height;
    uint64_t gaussians;
} sizes[SIZES] = {{320, 180, 5000}, {960, 540, 50000}};

static const char *const states[] = {"absent", "begun", "failed", "differs", "slow", "exact"};

typedef struct made_scene {
    const fxs_procedural_scene *scene;
    uint64_t count;
} made_scene;

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const made_scene *s = argument;
    for (size_t i = 0; i < capacity; i++)
        s->scene->gaussian(first + i, s->count, 1, &out[i]);
    return (long)capacity;
}

/* A request of the trial, with two pictures: that of the processor, and that of the back end in its trial. */
typedef struct frame {
    int width, height;
    size_t bytes;
    uint64_t processor_ns;         /* the processor's median time; 0: not drawn yet */
    fxs_opened *opened;
    fxs_object object;
    fxs_request request;
    uint8_t *expected, *drawn;
} frame;

static int frame_make(frame *f, int size, fxs_message *why)
{
    static const double eye[3] = {0.9, -2.6, -12.8}, look[3] = {0, 0.42, 0}, up[3] = {0, -1, 0};
    const fxs_picture picture = {.fov = 36, .width = sizes[size].width, .height = sizes[size].height};
    made_scene knot = {fxs_procedural_find("knot"), sizes[size].gaussians};
    const fxs_gaussian_source source = {knot.count, knot.scene->sh_degree, 0, read_gaussians, &knot, {0}};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_view view;
    f->width = picture.width;
    f->height = picture.height;
    f->bytes = (size_t)f->width * (size_t)f->height * 4;
    int error = fxs_scene_file_open_gaussians("trial", &source, NULL, &file, &info, why);
    error = error ? error : fxs_open_gaussians("trial", file, &info, NULL, &f->opened, why);
    error = error ? error : fxs_view_look_at(&view, eye, look, up, &picture, why);
    f->expected = malloc(f->bytes);
    f->drawn = malloc(f->bytes);
    if (error || !f->expected || !f->drawn)
        return error ? error : fxs_fail_memory(why, NULL, f->bytes);
    fxs_object_init(&f->object, f->opened->scene);
    fxs_request_init(&f->request, &f->object, 1);
    return fxs_camera_from_view(&f->request.cameras[0], &view, why);
}

static void frame_free(frame *f)
{
    fxs_close(f->opened);
    free(f->expected);
    free(f->drawn);
}

static int compare_times(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Draws a frame to warm up, then FRAMES frames, fewer if one takes longer than `longest`. Stores their median time. */
static int draw(const fxs_backend *b, void *self, frame *f, uint8_t *pixels, uint64_t longest, uint64_t *median,
                fxs_message *why)
{
    uint64_t times[FRAMES] = {0};
    int drawn = 0, error = 0;
    f->request.targets[0].colour = (fxs_image){pixels, f->width * 4};
    for (int i = -1; i < FRAMES && !error; i++) {
        memset(pixels, 0, f->bytes);
        const uint64_t start = fxs_clock(NULL);
        error = b->render(self, &f->request, NULL, why);
        times[drawn] = fxs_clock(NULL) - start;
        drawn += i >= 0;
        if (i >= 0 && times[i] > longest)
            break;
    }
    qsort(times, (size_t)(drawn ? drawn : 1), sizeof *times, compare_times);
    *median = times[drawn / 2];
    b->forget(self, f->opened->scene);
    return error;
}

/* Draws a frame by a back end that is not the processor, and compares. */
static enum trial_state try_frame(trial_result *r, void *self, frame *f, uint64_t *median, fxs_message *why)
{
    const uint64_t longest = SLOWER * f->processor_ns;
    return draw(r->backend, self, f, f->drawn, longest, median, why) ? TRIAL_FAILED
         : memcmp(f->expected, f->drawn, f->bytes)                   ? TRIAL_DIFFERS
         : *median > longest                                         ? TRIAL_SLOW : TRIAL_EXACT;
}

static void say(trial_result *r, const char *text)
{
    snprintf(r->text, sizeof r->text, "%.*s", TRIAL_TEXT - 1, text);
    for (char *c = r->text; *c; c++)
        *c = (unsigned char)*c < ' ' ? ' ' : *c;
}

static uint32_t microseconds(uint64_t nanoseconds)
{
    return nanoseconds / 1000 < LONGEST_US ? (uint32_t)(nanoseconds / 1000) : LONGEST_US;
}

static void try(trial_result *r, frame *frames, int is_first)
{
    const fxs_backend_options options = {.size = sizeof options};
    const uint64_t start = fxs_clock(NULL);
    uint64_t median = 0;
    fxs_message why;
    void *self;
    r->state = r->backend->open(&self, &options, &why) ? TRIAL_FAILED : TRIAL_EXACT;
    r->open_us = microseconds(fxs_clock(NULL) - start);
    for (int k = 0; k < SIZES && r->state == TRIAL_EXACT; k++) {
        frame *f = &frames[k];
        if (!is_first)
            r->state = try_frame(r, self, f, &median, &why);
        else if (draw(r->backend, self, f, f->expected, UINT64_MAX, &median, &why))
            r->state = TRIAL_FAILED;
        if (is_first)
            f->processor_ns = median;
    }
    r->frame_us = microseconds(median);
    if (self)
        r->backend->close(self);
    if (r->state == TRIAL_FAILED)
        say(r, why.text);
}

void trial_run(trial *t, const fxs_backend *const *backends, int count, void (*keep)(void *argument, const trial *t),
               void *argument)
{
    frame frames[SIZES] = {{0}};
    fxs_message why;
    int error = 0;
    memset(t, 0, sizeof *t);
    t->count = count < TRIAL_MOST ? count : TRIAL_MOST;
    for (int k = 0; k < SIZES && !error; k++)
        error = frame_make(&frames[k], k, &why);
    for (int i = 0; i < t->count; i++)
        t->results[i] = (trial_result){.backend = backends[i], .state = TRIAL_ABSENT, .text = "not tried"};
    for (int i = 0; i < t->count && !error; i++) {
        trial_result *r = &t->results[i];
        char name[TRIAL_TEXT];
        r->state = TRIAL_BEGUN;
        say(r, "its trial did not end");
        if (keep && i)
            keep(argument, t);
        r->state = r->backend->device(0, name, sizeof name, &why) ? TRIAL_ABSENT : TRIAL_BEGUN;
        say(r, r->state == TRIAL_ABSENT ? why.text : name);
        if (r->state == TRIAL_BEGUN)
            try(r, frames, i == 0);
        error = t->results[0].state != TRIAL_EXACT;
    }
    for (int k = 0; k < SIZES; k++)
        frame_free(&frames[k]);
    if (keep && !error)
        keep(argument, t);
}

const trial_result *trial_fastest(const trial *t, unsigned can)
{
    const trial_result *fastest = &t->results[0];
    for (int i = 1; i < t->count; i++) {
        const trial_result *r = &t->results[i];
        if (r->state == TRIAL_EXACT && (r->backend->can & can) == can && r->frame_us < fastest->frame_us)
            fastest = r;
    }
    return fastest;
}

int trial_write(const trial *t, const char *path, const char *key, fxs_message *why)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed))
        return fxs_fail_memory(why, path, 0);
    fprintf(printed.file, "%s\n", key);
    for (int i = 0; i < t->count; i++) {
        const trial_result *r = &t->results[i];
        fprintf(printed.file, "%s %s %" PRIu32 " %" PRIu32 " %s\n", r->backend->name, states[r->state], r->open_us,
                r->frame_us, r->text);
    }
    if (fxs_print_end(&printed))
        return fxs_fail_memory(why, path, 0);
    const fxs_encoded text = {.bytes = (uint8_t *)printed.text, .size = printed.size};
    const int error = fxs_encoded_write(path, &text, why);
    free(printed.text);
    return error;
}

static int read_result(trial_result *r, const fxs_backend *backend, const char *line)
{
    char name[32], state[32];
    int begin = 0;
    memset(r, 0, sizeof *r);
    r->backend = backend;
    if (sscanf(line, "%31s %31s %9" SCNu32 " %9" SCNu32 " %n", name, state, &r->open_us, &r->frame_us, &begin) != 4 ||
        !begin || strcmp(name, backend->name))
        return -1;
    while (r->state < TRIAL_EXACT && strcmp(state, states[r->state]))
        r->state++;
    say(r, line + begin);
    return strcmp(state, states[r->state]) ? -1 : 0;
}

int trial_read(trial *t, const fxs_backend *const *backends, int count, const char *path, const char *key)
{
    char line[TRIAL_KEY + 2];
    FILE *file = fxs_file_kind(path) == FXS_FILE_REGULAR ? fxs_stream_open(path, "r") : NULL;
    int lines = -1, error = file ? 0 : -1;
    t->count = count < TRIAL_MOST ? count : TRIAL_MOST;
    while (!error && lines < t->count && fgets(line, sizeof line, file)) {
        const size_t length = strcspn(line, "\n");
        error = line[length] ? 0 : -1;
        line[length] = 0;
        if (!error)
            error = lines < 0 ? strcmp(line, key) : read_result(&t->results[lines], backends[lines], line);
        lines++;
    }
    if (file)
        fclose(file);
    return error || lines < t->count || t->results[0].state != TRIAL_EXACT ? -1 : 0;
}
