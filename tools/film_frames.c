#include "film_frames.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "command.h"

enum { SIDE = 256, LEAST = 3 };

typedef struct frames {
    task *t;
    unsigned char grey[SIDE * SIDE];
    size_t filled;
    uint64_t *sharpness;           /* of each frame of the film */
    size_t count, room;
    int no_memory;
} frames;

int film_is_named(const char *path)
{
    static const char *const endings[] = {".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".3gp", ".mts", ".y4m"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
        if (!strcasecmp(dot, endings[i]))
            return 1;
    return 0;
}

/* The sum of the squares of 4 p - left - right - above - below: below 2^16 (4 255)^2 < 2^36. */
static uint64_t sharpness_of(const unsigned char *grey)
{
    uint64_t sum = 0;
    for (int y = 1; y < SIDE - 1; y++)
        for (int x = 1; x < SIDE - 1; x++) {
            const unsigned char *p = grey + SIDE * y + x;
            const int d = 4 * p[0] - p[-1] - p[1] - p[-SIDE] - p[SIDE];
            sum += (uint64_t)(d * d);
        }
    return sum;
}

static void end_frame(frames *f)
{
    if (f->count == f->room) {
        const size_t room = 2 * f->room + 1024;
        uint64_t *larger = realloc(f->sharpness, room * sizeof *larger);
        f->no_memory |= !larger;
        f->sharpness = larger ? larger : f->sharpness;
        f->room = larger ? room : f->room;
    }
    if (f->count < f->room)
        f->sharpness[f->count++] = sharpness_of(f->grey);
    f->filled = 0;
    task_show(f->t, f->count, 0);
}

static void take_frames(void *argument, const char *data, size_t size)
{
    frames *f = argument;
    while (size) {
        const size_t room = sizeof f->grey - f->filled, part = size < room ? size : room;
        memcpy(f->grey + f->filled, data, part);
        f->filled += part;
        data += part;
        size -= part;
        if (f->filled == sizeof f->grey)
            end_frame(f);
    }
}

/* A film that is damaged further on is used up to there. */
static int look_at_film(frames *f, const char *film)
{
    const char *const arguments[] = {"ffmpeg", "-nostdin", "-v", "error", "-i", film, "-an", "-vf",
                                     "scale=256:256,format=gray", "-f", "rawvideo", "pipe:1", 0};
    task_begin(f->t, "looking for sharp frames", 0);
    const int status = task_run(f->t, arguments, take_frames, f);
    if (status < 0 || status >= FXS_PROGRAM_MISSING)
        return task_failed(f->t, "ffmpeg", status);
    if (f->no_memory)
        return fail(EXIT_FAILED, "out of memory");
    if (!f->count)
        return fail(EXIT_FAILED, "%s: ffmpeg finds no picture in it: see %s", film, f->t->log_name);
    if (status)
        note("%s: damaged: its first %zu frames are used", film, f->count);
    return f->count >= LEAST ? 0 : fail(EXIT_FAILED, "%s: a film of %zu frame%s: %d or more are needed, from places apart",
                                        film, f->count, f->count == 1 ? "" : "s", LEAST);
}

/* The filter of ffmpeg that lets them through. Returns null without memory. */
static char *select_frames(const frames *f, size_t wanted)
{
    char *text = malloc(32 * wanted + 16), *to = text;
    if (!text)
        return 0;
    to += sprintf(to, "select='");
    for (size_t i = 0; i < wanted; i++) {
        size_t best = i * f->count / wanted;
        for (size_t k = best; k < (i + 1) * f->count / wanted; k++)
            best = f->sharpness[k] > f->sharpness[best] ? k : best;
        to += sprintf(to, "%seq(n,%zu)", i ? "+" : "", best);
    }
    strcpy(to, "'");
    return text;
}

static int write_frames(task *t, const char *film, const char *filter, const char *folder)
{
    char part[TASK_PATH], pattern[TASK_PATH];
    if (snprintf(part, sizeof part, "%s.part", folder) >= TASK_PATH)
        *part = 0;
    join_path(pattern, part, "frame-%05d.jpg");
    const char *const arguments[] = {"ffmpeg", "-nostdin", "-v", "error", "-y", "-i", film, "-an", "-vf", filter,
                                     "-fps_mode", "passthrough", "-qmin", "1", "-q:v", "1", pattern, 0};
    remove_folder(part);           /* of a command that was stopped */
    if (make_folder(part))
        return EXIT_FAILED;
    task_begin(t, "writing frames", 0);
    const int status = task_run(t, arguments, 0, 0);
    if (status < 0 || status >= FXS_PROGRAM_MISSING)
        return task_failed(t, "ffmpeg", status);
    return fxs_file_rename(part, folder) ? fail(EXIT_FAILED, "%s: %s", folder, strerror(errno)) : 0;
}

int film_frames(task *t, const char *film, size_t wanted, const char *folder)
{
    frames *f = calloc(1, sizeof *f);
    if (!f)
        return fail(EXIT_FAILED, "out of memory");
    f->t = t;
    int status = look_at_film(f, film);
    /* three a second of 30, but not few */
    wanted = wanted ? wanted : f->count / 10 < 60 ? 60 : f->count / 10 > 300 ? 300 : f->count / 10;
    wanted = wanted < f->count ? wanted : f->count;
    char *filter = status ? 0 : select_frames(f, wanted);
    if (!status)
        status = filter ? write_frames(t, film, filter, folder) : fail(EXIT_FAILED, "out of memory");
    if (!status)
        note("%s: %zu of %zu frames, in %s", film, wanted, f->count, folder);
    free(filter);
    free(f->sharpness);
    free(f);
    return status;
}
