/* Opens scene files from disk, a server or standard input. Filters and decimates Gaussians, then packs, maps or
   pages the scene. */
#include "load_scene.h"
#include "src/pack/weight.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/time_range.h>
#include "src/base/os_calls.h"
#include "command_line.h"
#include "file_guard.h"

#define LARGE ((size_t)64 << 20)    /* bytes from which an .fxs file may be paged (kept partly in memory) */

enum { PICTURES_HELD = 4, CHUNKS_MORE = 64 };     /* a memory pool holds the chunks of 4 pictures, and 64 more */

static int is_standard_input(const char *path)
{
    return !strcmp(path, "-");
}

static const char *shown(const char *path)
{
    return is_standard_input(path) ? "standard input" : path;
}

/* Prints a note about dropped Gaussians, with their share of the scene if it is at least 0.3 %. */
static void note_dropped(const char *path, const fxs_pack_dropped *d, uint64_t packed)
{
    const uint64_t dropped = d->not_finite + d->rotation;
    const double share = fxs_dropped_share(d);
    char weight[80] = "";
    if (share >= 0.003)
        snprintf(weight, sizeof weight, ", %.3g %% of the scene by opacity and area", 100 * share);
    if (dropped)
        note("%s: left out %" PRIu64 " of %" PRIu64 " Gaussians (%" PRIu64 " not finite, %" PRIu64
             " with a zero quaternion)%s", path, dropped, dropped + d->transparent + packed, d->not_finite, d->rotation,
             weight);
}

void note_packed(const char *path, const fxs_pack_report *report)
{
    note_dropped(path, &report->dropped, report->packed);
    if (report->brought_in)
        note("%s: brought in %" PRIu64 " Gaussians from beyond 2^27 units, as they look from the origin", path,
             report->brought_in);
    if (report->limited)
        note("%s: limited the motion of %" PRIu64 " Gaussians, which move or turn too fast for its codes", path,
             report->limited);
}

static int fail_scene(const char *path, const fxs_message *message)
{
    const char *name = shown(path);
    return fail(EXIT_FAILED, strncmp(message->text, name, strlen(name)) ? "%s: %s" : "%.0s%s", name, message->text);
}

fxs_progress progress_of(const load_options *o, char *label)
{
    return o->progress.call ? o->progress : (fxs_progress){progress_bar, label};
}

/* Prints which part of the scene its thing is. */
static int note_thing(fxs_scene_file *file, const char *path, const fxs_scene_filter_report *r,
                      const fxs_scene_file_info *info, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    long n;
    while ((n = fxs_scene_file_read(file, batch, BATCH, message)) > 0)
        for (long k = 0; k < n; k++)
            for (int i = 0; i < 3; i++) {
                low[i] = fmin(low[i], info->origin[i] + (double)batch[k].position[i]);
                high[i] = fmax(high[i], info->origin[i] + (double)batch[k].position[i]);
            }
    note("%s: the thing has %" PRIu64 " of %" PRIu64 " Gaussians, in the box %.4g,%.4g,%.4g,%.4g,%.4g,%.4g, up -y",
         path, r->kept, r->read, low[0], low[1], low[2], high[0], high[1], high[2]);
    return n < 0 ? (int)n : fxs_scene_file_rewind(file, message);
}

static int filter(fxs_scene_file *file, const char *path, const load_options *o, fxs_scene_file_info *info,
                  fxs_message *message)
{
    fxs_scene_filter_report r;
    char label[] = "counting";
    const fxs_progress progress = progress_of(o, label);
    int result = fxs_scene_file_filter(file, o->filter, info, &r, &progress, message);
    progress_end();
    if (result || o->again)
        return result;
    if (o->filter->thing)
        result = note_thing(file, path, &r, info, message);
    else if (r.outside || r.faint || r.floaters)
        note("%s: kept %" PRIu64 " of %" PRIu64 " Gaussians (%" PRIu64 " outside, %" PRIu64 " too faint, %" PRIu64
             " floating)", path, r.read - r.outside - r.faint - r.floaters, r.read, r.outside, r.faint, r.floaters);
    note_dropped(path, &r.dropped, r.kept);
    return result;
}

static int decimate(fxs_scene_file *file, const load_options *o, fxs_scene_file_info *info, fxs_message *message)
{
    char label[] = "merging";
    const uint64_t share = (uint64_t)ceil(o->decimate_share * (double)info->count);
    const int error = fxs_scene_file_decimate(file, o->decimate_count ? o->decimate_count : share, info,
                                              &(fxs_progress){progress_bar, label}, message);
    progress_end();
    return error;
}

typedef struct preparation {
    const char *path;
    const load_options *options;
    fxs_sound *sound;                /* where SOUND_KEPT keeps it */
} preparation;

static int apply_filter(const preparation *p, fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message)
{
    const load_options *o = p->options;
    int error = o->filter ? filter(file, p->path, o, info, message) : 0;
    if (!error && o->has_moment == 2)
        error = fxs_scene_file_at(file, o->moment, info, message);
    if (!error && is_given("decimate") && o->decimate_count >= info->count && !o->again)
        note("%s: has %" PRIu64 " Gaussians: --decimate merges none", p->path, info->count);
    return error || !(o->decimate_count || o->decimate_share > 0) ? error : decimate(file, o, info, message);
}

void note_coarse(const char *path, const fxs_scene_file_info *info)
{
    if (info->coarse > 0)
        note("%s: parts are so far from the others that single precision places them in steps of up to %.2g units; "
             "objects of a world (--scene, --place of render) keep their places", path, info->coarse);
}

static void look_at(const char *path, const load_options *o, const fxs_scene_file_info *info)
{
    if (o->again)
        return;
    if (info->stored_sh_degree > info->sh_degree)
        note("%s: the SH of degree %d are left out: degree %d is the highest that is drawn", path,
             info->stored_sh_degree, info->sh_degree);
    if (info->linear_light)
        note("%s: its colours of linear light are turned into sRGB, in which Gaussians are blended", path);
    if (info->clamped_opacity)
        note("%s: opacities above 1 are drawn as 1", path);
    if (info->unused[0])
        note("%s: not used, though the picture may depend on them: %s", path, info->unused);
    if (info->log_scales)
        note("%s: scales below 0: all are read as logarithms, as splat-transform wrote them until June 2026", path);
    note_coarse(path, info);
}

static void look_for_sound(const preparation *p, fxs_scene_file *file, const fxs_scene_file_info *info)
{
    fxs_sound sound;
    fxs_message message;
    const load_options *o = p->options;
    if (!o->sound || o->again || o->has_moment || !(info->time.duration > 0))
        return;
    const int found = fxs_scene_file_sound(file, &sound, &message);
    if (found < 0)
        note("%s", message.text);
    if (found <= 0)
        return;
    if (o->sound == SOUND_LOST) {
        note("the sound of %s is not kept", shown(p->path));
    } else if (p->sound) {
        *p->sound = sound;
        p->sound->data = malloc(sound.bytes);
        if (p->sound->data)
            memcpy(p->sound->data, sound.data, sound.bytes);
        else
            note("%s: without its sound: out of memory", shown(p->path));
    }
    fxs_sound_free(file, &sound);
}

static int prepare(void *argument, fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message)
{
    const preparation *p = argument;
    look_at(p->path, p->options, info);
    look_for_sound(p, file, info);
    return apply_filter(p, file, info, message);
}

/* Returns why a moving scene is refused without a moment, or null. */
static const char *why_still(const load_options *o)
{
    return o->still                                      ? o->still
           : o->decimate_count || o->decimate_share > 0  ? "is not decimated: give --time SECONDS"
           : o->filter && o->filter->floaters            ? "is not searched for floaters: give --time SECONDS"
           : o->filter && o->filter->thing               ? "is not searched for a thing: give --time SECONDS"
                                                         : 0;
}

/* Chooses the times of a moving scene, or refuses the scene. */
static int take_times(const char *path, const load_options *o, fxs_scene_file *file, fxs_scene_file_info *info)
{
    const char *still = why_still(o);
    fxs_message message;
    if (!(info->time.duration > 0))
        return 0;
    if (o->moved)
        *o->moved = 1;
    if (!o->has_moment && still)
        return fail(EXIT_FAILED, "%s: a scene that moves %s", shown(path), still);
    if (o->has_range && fxs_scene_file_between(file, o->from, o->to, info, &message))
        return fail_scene(path, &message);
    return o->has_moment == 1 && fxs_scene_file_at(file, o->moment, info, &message) ? fail_scene(path, &message) : 0;
}

int filter_scene(const char *path, const load_options *o, fxs_scene_file *file, fxs_scene_file_info *info)
{
    fxs_message message;
    if (!apply_filter(&(preparation){path, o, 0}, file, info, &message))
        return 0;
    fxs_scene_file_close(file);
    return fail_scene(path, &message);
}

/* Content of standard input, read once for all scenes named "-". */
static struct {
    uint8_t *bytes;
    size_t size, room;
} standard_input;

enum { PIECE = 1 << 20 };

static int grow_standard_input(void)
{
    const size_t room = 2 * standard_input.room + PIECE;
    void *larger = fxs_aligned_allocate(room);
    if (!larger)
        return fail(EXIT_FAILED, "standard input: out of memory");
    if (standard_input.bytes)
        memcpy(larger, standard_input.bytes, standard_input.size);
    fxs_aligned_free(standard_input.bytes);
    standard_input.bytes = larger;
    standard_input.room = room;
    return 0;
}

static int read_standard_input(void)
{
    if (standard_input.bytes)
        return 0;
    files_read("-");
    if (fxs_is_terminal(stdin))
        return fail(EXIT_FAILED, "standard input is a terminal, not a scene");
    for (size_t got = 1; got;) {
        if (standard_input.room - standard_input.size < PIECE && grow_standard_input())
            return EXIT_FAILED;
        got = fread(standard_input.bytes + standard_input.size, 1, PIECE, stdin);
        if (ferror(stdin))
            return fail(EXIT_FAILED, "standard input: %s", strerror(errno));
        standard_input.size += got;
    }
    return standard_input.size ? 0 : fail(EXIT_FAILED, "standard input is empty");
}

int options_of_file(load_options *own, const load_options *o, uint32_t i, uint32_t count)
{
    uint32_t levels = 1;
    const char *level = o->lods;
    *own = *o;
    own->is_one_of_several = count > 1 && !o->lods;
    for (const char *c = o->lods; c && (c = strchr(c, ',')); levels++)
        if (levels <= i)
            level = ++c;
        else
            c++;
    if (!o->lods)
        return 0;
    if (levels != count)
        return fail(EXIT_USAGE, "--lod %s: %u levels for %u files", o->lods, (unsigned)levels, (unsigned)count);
    own->lod = atoi(level);
    return 0;
}

static int open_file(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                     fxs_scene_file_info *info, fxs_message *message)
{
    return is_standard_input(path)
               ? fxs_scene_file_open_memory(shown(path), standard_input.bytes, standard_input.size, options, file,
                                            info, message)
               : fxs_scene_file_open(path, options, file, info, message);
}

/* Returns the level of detail to read. In a list of several files, a file with a single level ignores --lod. */
static int level_of(const char *path, const load_options *o, const fxs_scene_file_options *options)
{
    fxs_scene_file_options finest = *options;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    finest.level = 0;
    if (!o->lod || !o->is_one_of_several || open_file(path, &finest, &file, &info, &message))
        return o->lod;
    fxs_scene_file_close(file);
    return info.levels > 1 ? o->lod : 0;
}

static fxs_scene_file_options file_options(const char *path, const load_options *o)
{
    fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), 
        .axes = o->axes, .rate = o->rate, .max_gaussians = o->max_gaussians, .max_memory = o->import_memory,
        .progress = o->progress
    };
    options.level = level_of(path, o, &options);
    return options;
}

int open_unfiltered(const char *path, const load_options *o, fxs_scene_file **file, fxs_scene_file_info *info)
{
    fxs_message message;
    if (is_standard_input(path) && read_standard_input())
        return EXIT_FAILED;
    const fxs_scene_file_options options = file_options(path, o);
    if (open_file(path, &options, file, info, &message))
        return fail_for(&message);
    look_at(path, o, info);
    look_for_sound(&(preparation){path, o, 0}, *file, info);
    const int status = take_times(path, o, *file, info);
    if (status)
        fxs_scene_file_close(*file);
    return status;
}

int open_scene(const char *path, const load_options *o, fxs_scene_file **file, fxs_scene_file_info *info)
{
    return open_unfiltered(path, o, file, info) ? EXIT_FAILED : filter_scene(path, o, *file, info);
}

/* Returns the size in bytes of a memory pool for the chunks (256 Gaussians each) of several pictures. 0: the whole file
   is mapped instead. */
static size_t pool_for(const fxs_opened *opened, uint32_t budget)
{
    const fxs_scene *scene = opened->scene;
    const uint64_t chunks = PICTURES_HELD * (uint64_t)fxs_chunks_of(budget) + CHUNKS_MORE;
    const uint64_t pool = chunks * scene->chunk_bytes;
    return budget && scene->nodes && opened->bytes >= LARGE && pool <= opened->bytes / 2 ? (size_t)pool : 0;
}

static int open_in_part(loaded_scene *loaded, const char *path, fxs_open_options *options, size_t pool,
                        fxs_message *message)
{
    const fxs_pager_options paging = {.size = sizeof(fxs_pager_options), .pool_bytes = pool};
    fxs_close(loaded->opened);
    options->pager = &paging;
    const int error = fxs_open(path, options, &loaded->opened, message);
    options->pager = 0;
    return error;
}

static int open_to_render(loaded_scene *loaded, const char *path, const load_options *o, fxs_scene_file *file,
                          const fxs_scene_file_info *info)
{
    char label[] = "packing", reading[] = "reading";
    fxs_message message;
    preparation p = {path, o, &loaded->sound};
    const fxs_scene_file_options reading_options = file_options(path, o);
    fxs_open_options options = {.size = sizeof options, .file = &reading_options, .profile = o->profile,
                                .threads = o->threads, .tree = o->tree};
    const fxs_pager_options paging = {sizeof(fxs_pager_options), o->pool, o->arrived, o->arrived_argument};
    options.progress = progress_of(o, label);
    if (o->pages && (o->pool || fxs_pager_is_url(path)))
        options.pager = &paging;
    if (options.pager)
        progress_bar(reading, 0);
    if (!file) {
        options.prepare = prepare;
        options.prepare_argument = &p;
    }
    int error =
        file ? fxs_open_gaussians(path, file, info, &options, &loaded->opened, &message)
        : is_standard_input(path)
            ? fxs_open_memory(shown(path), standard_input.bytes, standard_input.size, &options, &loaded->opened,
                              &message)
            : fxs_open(path, &options, &loaded->opened, &message);
    const size_t pool = error || file || options.pager || is_standard_input(path) ? 0
                        : pool_for(loaded->opened, o->budget);
    if (pool)
        error = open_in_part(loaded, path, &options, pool, &message);
    progress_end();
    if (error)
        return fail_scene(path, &message);
    if (!o->again)
        note_packed(path, loaded->opened->report);
    return 0;
}

int load_stream(loaded_scene *loaded, const char *path, const load_options *options, fxs_scene_file *file,
                const fxs_scene_file_info *info)
{
    memset(loaded, 0, sizeof *loaded);
    loaded->path = path;
    return open_to_render(loaded, path, options, file, info);
}

int load_scene(loaded_scene *loaded, const char *path, const load_options *options)
{
    const uint64_t start = fxs_clock(0);
    memset(loaded, 0, sizeof *loaded);
    loaded->path = path;
    fxs_map_guard();
    if ((is_standard_input(path) && read_standard_input()) || open_to_render(loaded, path, options, 0, 0))
        return EXIT_FAILED;
    loaded->load_nanoseconds = fxs_clock(0) - start;
    return 0;
}

int is_packed(const loaded_scene *loaded)
{
    return !strcmp(loaded->opened->info->format, "fxs");
}

const char *const profile_names[] = {"default", "compact", "small", 0};

int check_scene(const loaded_scene *loaded)
{
    fxs_message message;
    return fxs_opened_check(loaded->opened, &message) ? fail_for(&message) : 0;
}

void free_scene(loaded_scene *loaded)
{
    fxs_close(loaded->opened);
    fxs_aligned_free(loaded->copy);
    free(loaded->sound.data);
    memset(loaded, 0, sizeof *loaded);
}
