/* Writes streamed SOG, version 1 (PlayCanvas, "The Streamed SOG Format"): an index lod-meta.json, and folders with the
   files of a .sog. A leaf of the tree is a region of neighbouring Gaussians. All levels of detail have the same
   leaves. */
#include "sog_internal.h"
#include "src/base/report.h"

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_ZIP)

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "held_levels_internal.h"
#include "src/base/exponential.h"
#include "src/base/files_internal.h"
#include "src/base/number.h"
#include "src/gaussian/attributes.h"
#include "src/pack/coarsen.h"

enum {
    LEAF_SETS = 64,
    MOST_LEVELS = 7,               /* most levels; in the last level, each leaf has a single set (256 Gaussians) */
    FILE_GAUSSIANS = 1 << 18,
    PRECISION = 7
};

/* integral of a squared Gaussian over the plane, divided by the Gaussian's area: pi / sqrt(3) */
#define PLANE 1.8137993642342178

typedef struct part {
    uint32_t level, number, first, last;
} part;

typedef struct streamed_writer {
    fxs_held held;
    int antialiased;
    char *path;
    fxs_levels levels;
    uint32_t leaves, part_count, parts_made;
    part *parts;
    float (*bounds)[2][3];
    const fxs_progress *progress;
} streamed_writer;

static int streamed_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    streamed_writer *w = writer;
    const size_t length = strlen(path);
    w->antialiased = o->antialiased;
    w->path = malloc(length + 1);
    if (!w->path)
        return fxs_fail_memory(message, path, length + 1);
    memcpy(w->path, path, length + 1);
    const int error = fxs_held_open(&w->held, path, o, message);
    if (error)
        free(w->path);
    return error;
}

static int streamed_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_held_put(&((streamed_writer *)writer)->held, gaussians, n, message);
}

static int no_memory(streamed_writer *w)
{
    w->held.output.error = ENOMEM;
    return 0;
}

static int advance(void *writer, double done)
{
    streamed_writer *w = writer;
    if (fxs_report(w->progress, done))
        w->held.output.error = ECANCELED;
    return !w->held.output.error;
}

/* Returns the index of the first Gaussian of a leaf in a level of detail. Beyond the last leaf, returns the number of
   Gaussians. */
static uint32_t leaf_begin(const streamed_writer *w, uint32_t level, uint32_t leaf)
{
    const uint64_t set = (uint64_t)leaf * LEAF_SETS >> level;
    const uint32_t sets = w->levels.levels[level].sets;
    return fxs_level_begin(&w->levels, level, set < sets ? (uint32_t)set : sets);
}

static int make_levels(streamed_writer *w)
{
    const uint32_t sets = (w->held.count + FXS_LEVEL_SET - 1) / FXS_LEVEL_SET;
    uint32_t levels = 1;
    while (levels < MOST_LEVELS && sets > 1u << (levels - 1))
        levels++;
    w->leaves = (sets + LEAF_SETS - 1) / LEAF_SETS;
    if (!fxs_levels_make(&w->levels, &w->held, levels, advance, w))
        return w->held.output.error ? 0 : no_memory(w);
    return 1;
}

static void extend(float bounds[2][3], const fxs_held_gaussian *g)
{
    double r[3][3];
    fxs_rotation_matrix(r, (double)g->rotation[0], (double)g->rotation[1], (double)g->rotation[2],
                        (double)g->rotation[3]);
    for (int k = 0; k < 3; k++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++)
            square += r[k][axis] * r[k][axis] * fxs_exp(2 * (double)g->scale[axis]);
        const float reach = (float)sqrt(square);
        bounds[0][k] = fminf(bounds[0][k], g->position[k] - reach);
        bounds[1][k] = fmaxf(bounds[1][k], g->position[k] + reach);
    }
}

static int find_bounds(streamed_writer *w)
{
    w->bounds = malloc((w->leaves + 1) * sizeof *w->bounds);
    if (!w->bounds)
        return no_memory(w);
    for (uint32_t leaf = 0; leaf < w->leaves; leaf++) {
        for (int k = 0; k < 3; k++) {
            w->bounds[leaf][0][k] = INFINITY;
            w->bounds[leaf][1][k] = -INFINITY;
        }
        for (uint32_t level = 0; level < w->levels.count; level++)
            for (uint32_t i = leaf_begin(w, level, leaf); i < leaf_begin(w, level, leaf + 1); i++)
                extend(w->bounds[leaf], fxs_level_gaussian(&w->levels, level, i));
    }
    return 1;
}

static int list_parts(streamed_writer *w)
{
    w->parts = malloc(((size_t)w->leaves * w->levels.count + 1) * sizeof *w->parts);
    if (!w->parts)
        return no_memory(w);
    for (uint32_t level = 0; level < w->levels.count; level++)
        for (uint32_t leaf = 0, number = 0, last; leaf < w->leaves; leaf = last) {
            last = leaf + 1;
            while (last < w->leaves &&
                   leaf_begin(w, level, last + 1) - leaf_begin(w, level, leaf) <= FILE_GAUSSIANS)
                last++;
            w->parts[w->part_count++] = (part){level, number++, leaf, last};
        }
    return 1;
}

static char *path_of(const streamed_writer *w, const part *p, const char *name)
{
    const char *slash = strrchr(w->path, '/');
    const size_t folder = slash ? (size_t)(slash + 1 - w->path) : 0, room = folder + 64;
    char *path = malloc(room);
    if (path) {
        memcpy(path, w->path, folder);
        snprintf(path + folder, room - folder, "%lu_%lu%s%s", (unsigned long)p->level, (unsigned long)p->number,
                 name ? "/" : "", name ? name : "");
    }
    return path;
}

static int write_file(const char *path, const fxs_zip_entry *file, fxs_message *message)
{
    fxs_output output;
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    fxs_output_write(&output, file->data, file->size, message);
    return fxs_output_close(&output, message);
}

static int write_files(streamed_writer *w, const part *p, const fxs_zip_entry *files, uint32_t count,
                       fxs_message *message)
{
    char *folder = path_of(w, p, NULL);
    int result = folder ? fxs_folder_make(folder, message) : fxs_fail_memory(message, w->path, 0);
    free(folder);
    for (uint32_t i = 0; i < count && result == 0; i++) {
        char *path = path_of(w, p, files[i].name);
        result = path ? write_file(path, &files[i], message) : fxs_fail_memory(message, w->path, 0);
        free(path);
    }
    return result;
}

static int progress_of_part(void *writer, double done)
{
    const streamed_writer *w = writer;
    return fxs_report(w->progress, 0.3 + 0.7 * (w->parts_made + done) / w->part_count);
}

static int make_part(streamed_writer *w, const part *p, fxs_message *message)
{
    const uint32_t begin = leaf_begin(w, p->level, p->first), count = leaf_begin(w, p->level, p->last) - begin;
    fxs_sog_source from = {malloc(count * sizeof *from.gaussians), malloc(count * sizeof *from.sh), count,
                           w->held.coefficients, w->antialiased};
    fxs_zip_entry files[FXS_SOG_FILES];
    fxs_sog *sog = NULL;
    int result = 0, error = from.gaussians && from.sh ? 0 : ENOMEM;
    for (uint32_t i = 0; i < count && !error; i++) {
        from.gaussians[i] = fxs_level_gaussian(&w->levels, p->level, begin + i);
        from.sh[i] = fxs_level_sh(&w->levels, p->level, begin + i);
    }
    if (!error)
        sog = fxs_sog_make(&from, &(fxs_progress){progress_of_part, w}, &error);
    w->held.output.error = error;
    if (!error)
        result = write_files(w, p, files, fxs_sog_files(sog, files), message);
    fxs_sog_free(sog);
    free(from.gaussians);
    free(from.sh);
    w->parts_made++;
    return error ? FXS_ERR_FILE : result;
}

static void remove_parts(const streamed_writer *w)
{
    for (uint32_t i = 0; i < w->parts_made; i++)
        for (int k = 0; k <= FXS_SOG_FILES; k++) {
            char *path = path_of(w, &w->parts[i], k < FXS_SOG_FILES ? fxs_sog_names[k] : NULL);
            if (path)
                (k < FXS_SOG_FILES ? fxs_file_remove : fxs_folder_remove)(path);
            free(path);
        }
}

static void print_corner(FILE *json, const char *before, const float corner[3])
{
    const double wide[3] = {(double)corner[0], (double)corner[1], (double)corner[2]};
    fputs(before, json);
    fxs_print_list(json, PRECISION, ",", wide, 3);
}

/* Returns the energy of a leaf's Gaussians, in the units of merging errors. The energy is the sum of squared colours
   times squared opacity, integrated over each Gaussian alone. */
static double energy_of(const streamed_writer *w, uint32_t leaf)
{
    double sum = 0;
    for (uint32_t i = leaf_begin(w, 0, leaf); i < leaf_begin(w, 0, leaf + 1); i++) {
        fxs_gaussian g;
        fxs_coarse c;
        double colours = 1;
        fxs_held_get(fxs_level_gaussian(&w->levels, 0, i), NULL, &g, 0);
        fxs_coarse_set(&c, &g);
        for (int k = 0; k < 3; k++)
            colours += fxs_colour_of_dc((double)g.dc[k]) * fxs_colour_of_dc((double)g.dc[k]);
        sum += PLANE * colours * (double)c.opacity * (double)c.opacity * (double)c.area;
    }
    return sum;
}

static void print_errors(FILE *json, const streamed_writer *w, uint32_t leaf)
{
    const double energy = energy_of(w, leaf);
    fputs(",\"errors\":[0", json);
    for (uint32_t level = 1; level < w->levels.count; level++) {
        const fxs_level *l = &w->levels.levels[level];
        double sum = 0;
        for (uint64_t set = (uint64_t)leaf * LEAF_SETS >> level; set < ((uint64_t)leaf + 1) * LEAF_SETS >> level; set++)
            sum += set < l->sets ? l->errors[set] : 0;
        const double error = sum / energy;
        fputs(",", json);
        fxs_print_number(json, PRECISION, error < 1 ? error : 1);
    }
    fputs("]", json);
}

static uint32_t file_of(const streamed_writer *w, uint32_t level, uint32_t leaf)
{
    uint32_t i = 0;
    while (w->parts[i].level != level || leaf >= w->parts[i].last)
        i++;
    return i;
}

static void print_leaf(FILE *json, const streamed_writer *w, uint32_t leaf)
{
    fputs(",\"lods\":{", json);
    for (uint32_t level = 0; level < w->levels.count; level++) {
        const uint32_t file = file_of(w, level, leaf), begin = leaf_begin(w, level, leaf);
        fprintf(json, "%s\"%lu\":{\"file\":%lu,\"offset\":%lu,\"count\":%lu}", level ? "," : "", (unsigned long)level,
                (unsigned long)file, (unsigned long)(begin - leaf_begin(w, level, w->parts[file].first)),
                (unsigned long)(leaf_begin(w, level, leaf + 1) - begin));
    }
    fputs("}", json);
    print_errors(json, w, leaf);
}

static void print_node(FILE *json, const streamed_writer *w, uint32_t first, uint32_t last)
{
    float bounds[2][3];
    memcpy(bounds, w->bounds[first], sizeof bounds);
    for (uint32_t leaf = first; leaf < last; leaf++)
        for (int k = 0; k < 3; k++) {
            bounds[0][k] = fminf(bounds[0][k], w->bounds[leaf][0][k]);
            bounds[1][k] = fmaxf(bounds[1][k], w->bounds[leaf][1][k]);
        }
    print_corner(json, "{\"bound\":{\"min\":", bounds[0]);
    print_corner(json, ",\"max\":", bounds[1]);
    fputs("}", json);
    if (last - first > 1) {
        const uint32_t middle = first + (last - first + 1) / 2;
        fputs(",\"children\":[", json);
        print_node(json, w, first, middle);
        fputs(",", json);
        print_node(json, w, middle, last);
        fputs("]", json);
    } else {
        print_leaf(json, w, first);
    }
    fputs("}", json);
}

static void print_index(FILE *json, const streamed_writer *w)
{
    unsigned long count = 0;
    for (uint32_t level = 0; level < w->levels.count; level++)
        count += w->levels.levels[level].count;
    fprintf(json, "{\"version\":1,\"asset\":{\"generator\":\"fixsplat " FXS_VERSION "\"},\"count\":%lu,\"counts\":[",
            count);
    for (uint32_t level = 0; level < w->levels.count; level++)
        fprintf(json, "%s%lu", level ? "," : "", (unsigned long)w->levels.levels[level].count);
    fprintf(json, "],\"lodLevels\":%lu,\"lodErrors\":true,\"filenames\":[", (unsigned long)w->levels.count);
    for (uint32_t i = 0; i < w->part_count; i++)
        fprintf(json, "%s\"%lu_%lu/meta.json\"", i ? "," : "", (unsigned long)w->parts[i].level,
                (unsigned long)w->parts[i].number);
    fputs("],\"tree\":", json);
    if (w->leaves)
        print_node(json, w, 0, w->leaves);
    else
        fputs("{}", json);
    fputs("}\n", json);
}

static void write_index(streamed_writer *w, fxs_message *message)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed)) {
        no_memory(w);
        return;
    }
    print_index(printed.file, w);
    if (fxs_print_end(&printed))
        no_memory(w);
    else
        fxs_output_write(&w->held.output, printed.text, printed.size, message);
    free(printed.text);
}

static int make_files(streamed_writer *w, fxs_message *message)
{
    int result = 0;
    if (!fxs_held_order(&w->held) || !make_levels(w) || !find_bounds(w) || !list_parts(w))
        return 0;
    for (uint32_t i = 0; i < w->part_count && result == 0; i++)
        result = make_part(w, &w->parts[i], message);
    if (result == 0)
        write_index(w, message);
    else if (!w->held.output.error)
        w->held.output.error = EIO;
    return result;
}

static int streamed_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                          fxs_message *message)
{
    streamed_writer *w = writer;
    fxs_message own, closing;
    (void)report;
    w->progress = progress;
    const int made = make_files(w, &own), is_said = made && w->held.output.error == EIO;
    fxs_levels_free(&w->levels);
    const int result = fxs_held_close(&w->held, &closing);
    if (result)
        remove_parts(w);
    if (result)
        *message = is_said ? own : closing;
    free(w->path);
    free(w->parts);
    free(w->bounds);
    return result && is_said ? made : result;
}

const fxs_writer fxs_write_streamed_sog = {sizeof(streamed_writer), streamed_open, streamed_put, streamed_close, NULL};

#else

static int streamed_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    (void)writer, (void)o;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot write .sog: built without libwebp or libzip", path);
}

const fxs_writer fxs_write_streamed_sog = {0, streamed_open, NULL, NULL, NULL};

#endif
