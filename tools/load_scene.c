#include "load_scene.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/clock.h>
#include <fixsplat/pool.h>
#include <fixsplat/fxs_file.h>
#include <fixsplat/scene_decimate.h>
#include <fixsplat/packed.h>
#include "file_guard.h"

static int is_standard_input(const char *path)
{
    return !strcmp(path, "-");
}

/* For messages. */
static const char *shown(const char *path)
{
    return is_standard_input(path) ? "standard input" : path;
}

/* The share of what is seen is told from 3 per mille on. */
static void note_dropped(const char *path, const fxs_pack_dropped *d, uint64_t packed)
{
    const uint64_t dropped = d->not_finite + d->rotation;
    const double share = fxs_dropped_share(d);
    char weight[80] = "";
    if (share >= 0.003)
        snprintf(weight, sizeof weight, ", %.3g %% of the scene by opacity and area", 100 * share);
    if (dropped)
        note("%s: left out %" PRIu64 " of %" PRIu64 " Gaussians (%" PRIu64 " not finite, %" PRIu64
             " with a zero quaternion)%s", path, dropped, dropped + packed, d->not_finite, d->rotation, weight);
}

/* A message about a scene, which may or may not begin with its name. */
static int fail_scene(const char *path, const fxs_message *message)
{
    const char *name = shown(path);
    return fail(EXIT_FAILED, strncmp(message->text, name, strlen(name)) ? "%s: %s" : "%.0s%s", name, message->text);
}

fxs_progress_fn *progress_of(const load_options *o, char *label, void **argument)
{
    *argument = o->progress ? o->progress_argument : label;
    return o->progress ? o->progress : progress_bar;
}

static int filter(fxs_scene_file *file, const char *path, const load_options *o, fxs_scene_file_info *info)
{
    fxs_message message;
    fxs_scene_filter_report r;
    char label[] = "counting";
    void *argument;
    fxs_progress_fn *progress = progress_of(o, label, &argument);
    int result = fxs_scene_file_filter(file, o->filter, info, &r, progress, argument, &message);
    progress_end();
    if (result)
        return fail_scene(path, &message);
    if (o->again)
        return 0;
    if (r.outside || r.faint || r.floaters)
        note("%s: kept %" PRIu64 " of %" PRIu64 " Gaussians (%" PRIu64 " outside, %" PRIu64 " too faint, %" PRIu64
             " floating)", path, r.read - r.outside - r.faint - r.floaters, r.read, r.outside, r.faint, r.floaters);
    note_dropped(path, &r.dropped, r.kept);
    return 0;
}

static int decimate(fxs_scene_file *file, const char *path, const load_options *o, fxs_scene_file_info *info)
{
    fxs_message message;
    char label[] = "merging";
    const uint64_t share = (uint64_t)ceil(o->decimate_share * (double)info->count);
    const int error = fxs_scene_file_decimate(file, o->decimate_count ? o->decimate_count : share, info, progress_bar,
                                              label, &message);
    progress_end();
    return error ? fail_scene(path, &message) : 0;
}

int filter_scene(const char *path, const load_options *o, fxs_scene_file *file, fxs_scene_file_info *info)
{
    int status = o->filter ? filter(file, path, o, info) : 0;
    if (!status && (o->decimate_count || o->decimate_share > 0))
        status = decimate(file, path, o, info);
    if (status)
        fxs_scene_file_close(file);
    return status;
}

/* ---- Standard input ---------------------------------------------------------------------------------------------- */

/* All of it, as the path - stands for; read once, and kept. */
static struct {
    uint8_t *bytes;                         /* aligned to 64 */
    size_t size, room;
} standard_input;

enum { PIECE = 1 << 20 };

static int grow_standard_input(void)
{
    const size_t room = 2 * standard_input.room + PIECE;
    void *larger;
    if (posix_memalign(&larger, 64, room))
        return fail(EXIT_FAILED, "standard input: out of memory");
    if (standard_input.bytes)
        memcpy(larger, standard_input.bytes, standard_input.size);
    free(standard_input.bytes);
    standard_input.bytes = larger;
    standard_input.room = room;
    return 0;
}

static int read_standard_input(void)
{
    if (standard_input.bytes)
        return 0;
    files_read("-");
    if (isatty(STDIN_FILENO))
        return fail(EXIT_FAILED, "standard input is a terminal, not a scene");
    for (ssize_t got = 1; got;) {
        if (standard_input.room - standard_input.size < PIECE && grow_standard_input())
            return EXIT_FAILED;
        got = read(STDIN_FILENO, standard_input.bytes + standard_input.size, PIECE);
        if (got < 0 && errno != EINTR)
            return fail(EXIT_FAILED, "standard input: %s", strerror(errno));
        standard_input.size += got > 0 ? (size_t)got : 0;
    }
    return standard_input.size ? 0 : fail(EXIT_FAILED, "standard input is empty");
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

static int open_file(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                     fxs_scene_file_info *info)
{
    fxs_message message;
    if (is_standard_input(path) && read_standard_input())
        return EXIT_FAILED;
    const int error = is_standard_input(path)
                          ? fxs_scene_file_open_memory("standard input", standard_input.bytes, standard_input.size,
                                                       options, file, info, &message)
                          : fxs_scene_file_open(path, options, file, info, &message);
    return error ? fail(EXIT_FAILED, "%s", message.text) : 0;
}

int open_unfiltered(const char *path, const load_options *o, fxs_scene_file **file, fxs_scene_file_info *info)
{
    const fxs_scene_file_options options = {
        .level = o->lod, .axes = o->axes, .max_gaussians = o->max_gaussians, .max_memory = o->import_memory,
        .progress = o->progress, .progress_argument = o->progress_argument
    };
    if (open_file(path, &options, file, info))
        return EXIT_FAILED;
    if (o->axes && strcmp(info->format, "spz")) {
        fxs_scene_file_close(*file);
        return fail(EXIT_FAILED, "%s: --axes is for .spz", path);
    }
    if (info->stored_sh_degree > info->sh_degree && !o->again)
        note("%s: the SH of degree %d are left out: degree %d is the highest that is drawn", path,
             info->stored_sh_degree, info->sh_degree);
    return 0;
}

int open_scene(const char *path, const load_options *o, fxs_scene_file **file, fxs_scene_file_info *info)
{
    return open_unfiltered(path, o, file, info) ? EXIT_FAILED : filter_scene(path, o, *file, info);
}

int pack_scene(loaded_scene *loaded, const char *path, const load_options *o, fxs_scene_file *file)
{
    fxs_message message;
    char label[] = "packing";
    const uint32_t threads = o->threads ? o->threads : fxs_processors();
    fxs_pool *pool = fxs_pool_create(threads);
    void *argument;
    fxs_progress_fn *progress = progress_of(o, label, &argument);
    const fxs_pack_options options = {o->profile, pool ? fxs_pool_run : 0, pool, threads, progress, argument, 0};
    int result = fxs_pack(file, &loaded->info, &loaded->packed, &loaded->report, &options, &message);
    fxs_pool_destroy(pool);
    fxs_scene_file_close(file);
    progress_end();
    if (result)
        return fail_scene(path, &message);
    result = fxs_scene_open(&loaded->scene, loaded->packed.data, loaded->packed.bytes);
    if (result)
        return fail(EXIT_FAILED, "%s: %s", path, fxs_strerror(result));
    if (o->again)
        return 0;
    note_dropped(path, &loaded->report.dropped, loaded->report.packed);
    if (loaded->report.brought_in)
        note("%s: brought in %" PRIu64 " Gaussians from beyond 2^27 units, as they look from the origin", path,
             loaded->report.brought_in);
    return 0;
}

/* By the four bytes with which an .fxs file begins. Only a regular file is opened: a pipe would wait for its writer. */
int is_packed(const char *path)
{
    uint32_t magic = 0;
    struct stat information;
    if (is_standard_input(path) && standard_input.size >= sizeof magic) {
        memcpy(&magic, standard_input.bytes, sizeof magic);
        return fxs_little_32(magic) == FXS_PACKED_MAGIC;
    }
    FILE *file = stat(path, &information) == 0 && S_ISREG(information.st_mode) ? fopen(path, "rb") : 0;
    size_t got = file ? fread(&magic, sizeof magic, 1, file) : 0;
    if (file)
        fclose(file);
    return got == 1 && fxs_little_32(magic) == FXS_PACKED_MAGIC;
}

static int import(loaded_scene *loaded, const char *path, const load_options *o)
{
    fxs_scene_file *file;
    return open_scene(path, o, &file, &loaded->info) ? EXIT_FAILED : pack_scene(loaded, path, o, file);
}

/* Without an allocation, a packed scene is not freed. */
static int map_bytes(loaded_scene *loaded, const char *path, fxs_message *message)
{
    if (is_standard_input(path)) {
        loaded->packed.data = standard_input.bytes;
        loaded->packed.bytes = standard_input.size;
        return 0;
    }
    fxs_map_guard();
    if (fxs_map(&loaded->mapping, path, message))
        return EXIT_FAILED;
    loaded->packed.data = loaded->mapping.data;
    loaded->packed.bytes = loaded->mapping.bytes;
    return 0;
}

static int map(loaded_scene *loaded, const char *path)
{
    fxs_message message;
    if (map_bytes(loaded, path, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    if (fxs_file_check(shown(path), loaded->packed.data, loaded->packed.bytes, 0, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    fxs_scene_open(&loaded->scene, loaded->packed.data, loaded->packed.bytes);
    fxs_packed_header header;
    memcpy(&header, loaded->packed.data, sizeof header);
    fxs_packed_header_turn(&header);
    loaded->info = (fxs_scene_file_info){"fxs", header.count, (int)header.sh_degree, (int)header.sh_degree,
                                        loaded->scene.antialiased, 1, {0, 0}, {0, 0}};
    loaded->report.read = loaded->report.packed = header.count;
    for (int i = 0; i < 3; i++) {
        loaded->report.low[i] = ldexp((double)header.low_q32[i], -32);
        loaded->report.high[i] = ldexp((double)header.high_q32[i], -32);
        loaded->report.inner_low[i] = ldexp((double)header.inner_low_q32[i], -32);
        loaded->report.inner_high[i] = ldexp((double)header.inner_high_q32[i], -32);
    }
    return 0;
}

int take_import_option(load_options *options, int which, const char *value)
{
    if (which == OPT_AXES) {
        options->axes = !strcmp(value, "rub") ? FXS_AXES_RUB : !strcmp(value, "rdf") ? FXS_AXES_RDF : FXS_AXES_OF_FILE;
        return options->axes ? 0 : fail(EXIT_USAGE, "--axes %s: expected rub or rdf", value);
    }
    if (which == OPT_IMPORT_MEMORY)
        return parse_bytes(value, &options->import_memory)
                   ? 0 : fail(EXIT_USAGE, "--import-memory %s: expected bytes, or a number with K, M or G", value);
    return parse_count(value, 1, UINT64_MAX, &options->max_gaussians)
               ? 0 : fail(EXIT_USAGE, "--max-gaussians %s: expected a whole number from 1 on", value);
}

static const char *const profiles[] = {"default", "compact", "small"};

const char *profile_name(enum fxs_profile profile)
{
    return profiles[profile];
}

int take_profile(load_options *options, const char *value)
{
    for (int i = 0; i < 3; i++)
        if (!strcmp(value, profiles[i])) {
            options->profile = (enum fxs_profile)i;
            return 0;
        }
    return fail(EXIT_USAGE, "--profile %s: expected default, compact or small", value);
}

int load_scene(loaded_scene *loaded, const char *path, const load_options *options)
{
    uint64_t start = fxs_clock(0);
    memset(loaded, 0, sizeof *loaded);
    loaded->path = path;
    if (is_standard_input(path) && read_standard_input())
        return EXIT_FAILED;
    int status = !is_packed(path) ? import(loaded, path, options)
                 : options->axes  ? fail(EXIT_FAILED, "%s: --axes is for .spz", path)
                                  : map(loaded, path);
    loaded->load_nanoseconds = fxs_clock(0) - start;
    if (status)
        free_scene(loaded);
    return status;
}

int check_scene(const loaded_scene *loaded)
{
    fxs_message message;
    if (loaded->mapping.data && fxs_map_check(&loaded->mapping, loaded->path, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    return 0;
}

void free_scene(loaded_scene *loaded)
{
    if (loaded->mapping.data)
        fxs_unmap(&loaded->mapping);
    else
        fxs_packed_scene_free(&loaded->packed);
    memset(loaded, 0, sizeof *loaded);
}
