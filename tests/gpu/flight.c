/* Flies over a scene with levels of detail that is read while it is drawn, and prints the times of its frames.
 *
 *     flight BACKEND FILE.fxs [RATE [FRAMES [BUDGET [MEMORY [WIDTHxHEIGHT]]]]]
 *
 * RATE: largest rate of reading in MB a second; 0 (default): as fast as the file. FRAMES: 300. BUDGET: largest number
 * of Gaussians a frame, 1000000. MEMORY: limit of device memory in MB, 300. Frames begin at most 72 times a second. The
 * flight starts with an empty pool. The last frame is drawn again when all its chunks are there, and compared with the
 * processor's picture of the mapped file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <fixsplat/renderer.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/pager_more.h>

enum { FRAMES_MOST = 100000, RATE_OF_FRAMES = 72 };

typedef struct slow_source {
    fxs_pager_source file;
    double bytes_per_nanosecond;   /* 0: no limit */
} slow_source;

static fxs_message why;
static fxs_opened *whole;
static fxs_pager *pager;
static slow_source source;
static const fxs_backend *backend;
static void *self;
static fxs_request request;
static fxs_object object;
static unsigned char *pixels[2];
static int width = 1920, height = 1080;

static void need(int error)
{
    if (error >= 0)
        return;
    fprintf(stderr, "flight: %s\n", why.text);
    exit(1);
}

static void sleep_until(uint64_t time)
{
    const uint64_t now = fxs_clock(0), rest = time > now ? time - now : 0;
    const struct timespec span = {(time_t)(rest / 1000000000), (long)(rest % 1000000000)};
    nanosleep(&span, 0);
}

static int read_slowly(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    slow_source *s = argument;
    const uint64_t started = fxs_clock(0);
    const int error = s->file.read(s->file.argument, offset, out, size, message);
    if (s->bytes_per_nanosecond > 0)
        sleep_until(started + (uint64_t)((double)size / s->bytes_per_nanosecond));
    return error;
}

static void close_source(void *argument)
{
    slow_source *s = argument;
    s->file.close(s->file.argument);
}

/* The camera flies on an ellipse half as wide as the scene, and looks ahead and down. */
static void look(double turn)
{
    const double *low = whole->report->inner_low, *high = whole->report->inner_high;
    const double up[3] = {0, -1, 0}, angle = turn * 2 * 3.14159265358979323846;
    const fxs_picture picture = {60, width, height};
    double eye[3], target[3];
    fxs_view view;
    for (int k = 0; k < 3; k++) {
        const double half = (high[k] - low[k]) / 2, middle = (high[k] + low[k]) / 2;
        const double here = k == 0 ? cos(angle) : sin(angle), ahead = k == 0 ? cos(angle + 1) : sin(angle + 1);
        eye[k] = k == 1 ? low[k] + half / 2 : middle + here * half / 2;
        target[k] = k == 1 ? high[k] - half / 2 : middle + ahead * half / 2;
    }
    need(fxs_view_look_at(&view, eye, target, up, &picture, &why));
    need(fxs_camera_from_view(&request.cameras[0], &view, &why));
}

static int compare_times(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Prints the first frame's time, and the other frames' times. */
static void say(const char *name, double *times, int count)
{
    const double first = *times++;
    count--;
    qsort(times, (size_t)count, sizeof *times, compare_times);
    printf("%-6s first %.3f, then median %.3f, 99 %% %.3f, largest %.3f ms; largest / median %.2f\n", name, first,
           times[count / 2], times[count * 99 / 100], times[count - 1], times[count - 1] / times[count / 2]);
}

static void fly(int frames)
{
    static double frame[FRAMES_MOST], device[FRAMES_MOST], turn[FRAMES_MOST];
    uint64_t missing = 0, drawn = 0, memory = 0, next = fxs_clock(0);
    int incomplete = 0;
    fxs_pager_state state = {0};
    fxs_stats stats;
    for (int i = 0; i < frames; i++) {
        look((double)i / frames);
        sleep_until(next);
        next += 1000000000 / RATE_OF_FRAMES;
        const uint64_t started = fxs_clock(0);
        need(fxs_pager_turn(pager, &state, &why));
        const uint64_t turned = fxs_clock(0);
        need(backend->render(self, &request, &stats, &why));
        frame[i] = (double)(fxs_clock(0) - started) / 1e6;
        turn[i] = (double)(turned - started) / 1e6;
        device[i] = (double)backend->nanoseconds(self) / 1e6;
        missing += stats.missing;
        incomplete += stats.missing != 0;
        drawn += stats.drawn;
        memory = stats.memory.total > memory ? stats.memory.total : memory;
    }
    printf("%s, %d frames of %dx%d: drawn %.0f on average, %d frames coarser in places (%.0f chunks on average)\n",
           backend->name, frames, width, height, (double)drawn / frames, incomplete, (double)missing / frames);
    printf("read %.1f MB; the frame's own memory %.1f MB\n", (double)state.bytes_read / 1e6, (double)memory / 1e6);
    say("frame", frame, frames);
    say("device", device, frames);
    say("turn", turn, frames);
}

static void complete_last(void)
{
    fxs_stats stats = {.missing = 1};
    for (int i = 0; i < 2000 && stats.missing; i++) {
        need(fxs_pager_turn(pager, 0, &why));
        need(backend->render(self, &request, &stats, &why));
        fxs_pager_wait(pager, 100000000);
    }
    fxs_object_init(&object, whole->scene);
    request.targets[0].colour.pixels = pixels[1];
    request.options.want = (fxs_want){0, 0};
    const fxs_backend *cpu = fxs_backend_find("cpu");
    void *processor;
    need(cpu->open(&processor, &(fxs_backend_options){.size = sizeof(fxs_backend_options)}, &why));
    need(cpu->render(processor, &request, 0, &why));
    cpu->close(processor);
    const int same = !stats.missing && !memcmp(pixels[0], pixels[1], (size_t)width * (size_t)height * 4);
    printf("%s: the last frame, complete, %s the processor's picture\n", same ? "ok  " : "FAIL",
           same ? "is" : "is not");
    if (!same)
        exit(1);
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    const double rate = argc > 3 ? atof(argv[3]) : 0;
    const int frames = argc > 4 ? atoi(argv[4]) : 300;
    fxs_backend_options options = {.size = sizeof options};
    fxs_pager_options paging = {.size = sizeof paging};
    options.max_memory = (uint64_t)((argc > 6 ? atof(argv[6]) : 300) * 1e6);
    if (argc > 7 && sscanf(argv[7], "%dx%d", &width, &height) != 2)
        return 2;
    if (frames < 2 || frames > FRAMES_MOST)
        return 2;
    need(fxs_open(argv[2], 0, &whole, &why));
    need(fxs_pager_file(argv[2], &source.file, &why));
    source.bytes_per_nanosecond = rate / 1e3;
    const fxs_pager_source slow = {source.file.size, read_slowly, 0, close_source, &source, source.file.gap};
    need(fxs_pager_open(argv[2], &slow, &paging, &pager, &why));
    backend = fxs_backend_find(argv[1]);
    if (!backend)
        return 2;
    need(backend->open(&self, &options, &why));
    fxs_object_init(&object, fxs_pager_scene(pager));
    fxs_request_init(&request, &object, 1);
    request.options.budget = argc > 5 ? (uint32_t)atol(argv[5]) : 1000000;
    request.options.want = (fxs_want){fxs_pager_want, pager};
    for (int i = 0; i < 2; i++)
        pixels[i] = malloc((size_t)width * (size_t)height * 4);
    if (!pixels[0] || !pixels[1])
        return 1;
    request.targets[0].colour = (fxs_image){pixels[0], 4 * (ptrdiff_t)width};
    fly(frames);
    complete_last();
    backend->forget(self, fxs_pager_scene(pager));
    backend->close(self);
    fxs_pager_close(pager);
    fxs_close(whole);
    free(pixels[0]);
    free(pixels[1]);
    return 0;
}
