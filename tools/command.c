#include "command.h"

#include <errno.h>
#include <math.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../port/formats/fxs_file.h"
#include "../port/posix/clock.h"
#include "../port/posix/map.h"
#include "../src/packed.h"

int fail(int status, const char *format, ...)
{
    va_list arguments;
    progress_end();
    fputs("fixsplat: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return status;
}

int wrong_option(char **argv)
{
    return fail(EXIT_USAGE, "%s: unknown option or missing value: %s; see: fixsplat %s --help", argv[0],
                argv[optind - 1], argv[0]);
}

int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    *out = value;
    return text[0] >= '0' && text[0] <= '9' && !*end && !errno && value >= low && value <= high;
}

int parse_size(const char *text, int *width, int *height)
{
    uint64_t w, h;
    char first[16];
    const char *x = strchr(text, 'x');
    size_t length = x ? (size_t)(x - text) : 0;
    if (!length || length >= sizeof first)
        return 0;
    memcpy(first, text, length);
    first[length] = 0;
    if (!parse_count(first, 1, FXS_MAX_SIZE, &w) || !parse_count(x + 1, 1, FXS_MAX_SIZE, &h))
        return 0;
    *width = (int)w;
    *height = (int)h;
    return 1;
}

int parse_vector(const char *text, double out[3])
{
    for (int i = 0; i < 3; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || !isfinite(out[i]) || *end != (i < 2 ? ',' : 0))
            return 0;
        text = end + 1;
    }
    return 1;
}

int parse_colour(const char *text, uint8_t rgb[3])
{
    if (strlen(text) != 6 || strspn(text, "0123456789abcdefABCDEF") != 6)
        return 0;
    unsigned long value = strtoul(text, 0, 16);
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)(value >> (16 - 8 * i));
    return 1;
}

static int bar_shown;

int progress_bar(void *label, double done)
{
    static const char marks[] = "########################################";
    int width = (int)(sizeof marks - 1), filled = (int)(done * width);
    if (!isatty(STDERR_FILENO))
        return 0;
    fprintf(stderr, "\r%-12s [%.*s%*s] %3d %%", (const char *)label, filled, marks, width - filled, "",
            (int)(done * 100));
    bar_shown = 1;
    return 0;
}

void progress_end(void)
{
    if (bar_shown)
        fputs("\r\033[K", stderr);
    bar_shown = 0;
}

static void note_dropped(const char *path, const fxs_pack_report *report)
{
    const fxs_pack_dropped *d = &report->dropped;
    if (report->read == report->packed)
        return;
    fprintf(stderr, "fixsplat: %s: left out %llu of %llu Gaussians (%llu not finite, %llu with a zero quaternion, "
            "%llu with a scale beyond +-20, %llu too far out)\n", path,
            (unsigned long long)(report->read - report->packed), (unsigned long long)report->read,
            (unsigned long long)d->not_finite, (unsigned long long)d->rotation, (unsigned long long)d->scale,
            (unsigned long long)d->position);
}

static int import(loaded_scene *loaded, const char *path, int lod, uint32_t threads)
{
    fxs_message message;
    fxs_scene_file *file;
    char label[] = "reading";
    if (fxs_scene_file_open_lod(path, lod, &file, &loaded->info, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    fxs_pool *pool = fxs_pool_create(threads);
    fxs_pack_options options = {pool ? fxs_pool_run : 0, pool, threads, progress_bar, label};
    int result = fxs_pack(file, &loaded->info, &loaded->packed, &loaded->report, &options, &message);
    fxs_pool_destroy(pool);
    fxs_scene_file_close(file);
    progress_end();
    if (result)
        return fail(EXIT_FAILED, strncmp(message.text, path, strlen(path)) ? "%s: %s" : "%.0s%s", path, message.text);
    result = fxs_scene_open(&loaded->scene, loaded->packed.data, loaded->packed.bytes);
    if (result)
        return fail(EXIT_FAILED, "%s: %s", path, fxs_strerror(result));
    note_dropped(path, &loaded->report);
    return 0;
}

/* The four bytes with which an .fxs file begins. */
static int is_packed(const char *path)
{
    uint32_t magic = 0;
    FILE *file = fopen(path, "rb");
    size_t got = file ? fread(&magic, sizeof magic, 1, file) : 0;
    if (file)
        fclose(file);
    return got == 1 && magic == FXS_PACKED_MAGIC;
}

static int map(loaded_scene *loaded, const char *path)
{
    fxs_message message;
    if (fxs_map(path, &loaded->packed.data, &loaded->packed.bytes, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    loaded->mapped = 1;
    if (fxs_file_check(path, loaded->packed.data, loaded->packed.bytes, 0, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    fxs_scene_open(&loaded->scene, loaded->packed.data, loaded->packed.bytes);
    const fxs_packed_header *header = loaded->packed.data;
    loaded->info = (fxs_scene_file_info){"fxs", header->count, (int)header->sh_degree, loaded->scene.antialiased,
                                        1};
    loaded->report.read = loaded->report.packed = header->count;
    for (int i = 0; i < 3; i++) {
        loaded->report.low[i] = ldexp((double)header->low_q32[i], -32);
        loaded->report.high[i] = ldexp((double)header->high_q32[i], -32);
        loaded->report.inner_low[i] = ldexp((double)header->inner_low_q32[i], -32);
        loaded->report.inner_high[i] = ldexp((double)header->inner_high_q32[i], -32);
    }
    return 0;
}

int take_lod(int *lod, const char *value)
{
    uint64_t number;
    if (!parse_count(value, 0, 1000, &number))
        return fail(EXIT_USAGE, "--lod %s: expected 0 to 1000", value);
    *lod = (int)number;
    return 0;
}

int load_scene(loaded_scene *loaded, const char *path, int lod, uint32_t threads)
{
    uint64_t start = fxs_clock(0);
    memset(loaded, 0, sizeof *loaded);
    int status = is_packed(path) ? map(loaded, path) : import(loaded, path, lod, threads);
    loaded->load_nanoseconds = fxs_clock(0) - start;
    if (status)
        free_scene(loaded);
    return status;
}

void free_scene(loaded_scene *loaded)
{
    if (loaded->mapped)
        fxs_unmap(loaded->packed.data, loaded->packed.bytes);
    else
        fxs_packed_scene_free(&loaded->packed);
}
