/* Extracts sharp frames from a film with ffmpeg. A first pass measures the sharpness of every frame by its Laplacian,
   at 256x256 pixels. A second pass writes the sharpest frame of each of equal stretches of the film. */
#include "film_frames.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/image.h>
#include "tools/command/command.h"

enum { SIDE = 256, LEAST = 3 };

#define FRAME "frame-%05d.jpg"

typedef struct frames {
    task *t;
    unsigned char grey[SIDE * SIDE];
    size_t filled;
    uint64_t *sharpness;
    size_t count, room;
    int no_memory;
    int is_damaged;                /* 1: the film file is damaged and ends early */
} frames;

int film_is_named(const char *path)
{
    static const char *const endings[] = {".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".3gp", ".mts",
                                          ".y4m"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
        if (!strcasecmp(dot, endings[i]))
            return 1;
    return 0;
}

/* Measures the sharpness of a grey picture: the sum of squares of the Laplacian 4 p - left - right - above - below. The
   sum is less than 2^16 (4 255)^2 < 2^36. */
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

/* Makes a file name safe for ffmpeg. The prefix "file:" keeps ffmpeg from reading a:b as a protocol and -a as an
   option. In a file name pattern, % is doubled. */
static void name_for_ffmpeg(char name[TASK_PATH], const char *path, int is_pattern)
{
    size_t length = (size_t)sprintf(name, "file:");
    for (; *path && length + 2 < TASK_PATH; path++) {
        name[length++] = *path;
        if (is_pattern && *path == '%')
            name[length++] = '%';
    }
    name[*path ? 0 : length] = 0;
}

static int look_at_film(frames *f, const char *film)
{
    char input[TASK_PATH];
    name_for_ffmpeg(input, film, 0);
    const char *const arguments[] = {"ffmpeg", "-nostdin", "-v", "error", "-i", input, "-an", "-vf",
                                     "scale=256:256,format=gray", "-fps_mode", "passthrough", "-f", "rawvideo",
                                     "pipe:1", 0};
    task_begin(f->t, "looking for sharp frames", 0);
    const int status = task_run(f->t, arguments, take_frames, f);
    if (task_is_cut(status))
        return task_failed(f->t, "ffmpeg", status);
    if (f->no_memory)
        return fail(EXIT_FAILED, "out of memory");
    if (!f->count)
        return fail(EXIT_FAILED, "%s: ffmpeg finds no picture in it: see %s", film, f->t->log_name);
    f->is_damaged = status != 0;
    if (status)
        note("%s: damaged: its first %zu frames are used", film, f->count);
    if (f->count >= LEAST)
        return 0;
    return fail(EXIT_FAILED, "%s: a film of %zu frame%s: at least %d are needed, from different places", film, f->count,
                f->count == 1 ? "" : "s", LEAST);
}

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

static int fail_frames(const task *t, const char *why)
{
    return fail(EXIT_FAILED, "%s: ffmpeg did not write all frames whole, perhaps on a full disk: see %s; the same "
                "command goes on", why, t->log_name);
}

/* Reads each written frame to its end, because on a full disk ffmpeg may truncate frames and still exit with 0. */
static int check_frames(task *t, const char *part, int is_sound, size_t *count)
{
    char path[TASK_PATH], name[32];
    uint8_t *rgba;
    int width, height;
    fxs_message why;
    task_begin(t, "checking frames", 0);
    for (size_t i = 0; i < *count; i++) {
        snprintf(name, sizeof name, FRAME, (int)i + 1);
        join_path(path, part, name);
        if (is_sound && i >= LEAST && !fxs_file_is_named(path))
            *count = i;
        else if (fxs_image_file_read(path, &rgba, &width, &height, &why))
            return fail_frames(t, why.text);
        else
            free(rgba);
        task_show(t, i + 1, *count);
    }
    progress_end();
    return 0;
}

/* On a damaged film, ffmpeg fails after writing the frames before the damage. */
static int write_frames(const frames *f, const char *film, const char *filter, const char *part, size_t *count)
{
    char input[TASK_PATH], pattern[TASK_PATH], folder[TASK_PATH];
    name_for_ffmpeg(input, film, 0);
    name_for_ffmpeg(folder, part, 1);
    join_path(pattern, folder, FRAME);
    const char *const arguments[] = {"ffmpeg", "-nostdin", "-v", "error", "-y", "-i", input, "-an", "-vf", filter,
                                     "-fps_mode", "passthrough", "-qmin", "1", "-q:v", "1", pattern, 0};
    task_begin(f->t, "writing frames", 0);
    const int status = task_run(f->t, arguments, 0, 0);
    if (task_is_cut(status))
        return task_failed(f->t, "ffmpeg", status);
    if (status && !f->is_damaged)
        return fail_frames(f->t, film);
    return check_frames(f->t, part, !status, count);
}

static int make_frames(const frames *f, const char *film, const char *filter, const char *folder, size_t *count)
{
    char part[TASK_PATH];
    if (snprintf(part, sizeof part, "%s.part", folder) >= TASK_PATH)
        *part = 0;
    remove_folder(part);           /* an interrupted command may have left frames in this folder */
    int status = make_folder(part);
    status = status ? status : write_frames(f, film, filter, part, count);
    if (!status && fxs_file_rename(part, folder))
        status = fail(EXIT_FAILED, "%s: %s", folder, strerror(errno));
    if (status)
        remove_folder(part);
    return status;
}

int film_frames(task *t, const char *film, size_t wanted, const char *folder)
{
    frames *f = calloc(1, sizeof *f);
    if (!f)
        return fail(EXIT_FAILED, "out of memory");
    f->t = t;
    int status = look_at_film(f, film);
    /* The default number of frames is a tenth of the film's frames, clamped to 60..300. */
    wanted = wanted ? wanted : f->count / 10 < 60 ? 60 : f->count / 10 > 300 ? 300 : f->count / 10;
    wanted = wanted < f->count ? wanted : f->count;
    char *filter = status ? 0 : select_frames(f, wanted);
    if (!status)
        status = filter ? make_frames(f, film, filter, folder, &wanted) : fail(EXIT_FAILED, "out of memory");
    if (!status)
        note("%s: %zu of %zu frames, in %s", film, wanted, f->count, folder);
    free(filter);
    free(f->sharpness);
    free(f);
    return status;
}
