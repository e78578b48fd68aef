/* Finds the cameras for `fixsplat fit` by structure from motion. Prepares frames or photographs in the folder
   OUT.cameras. Runs COLMAP for features and matches, then GLOMAP or COLMAP's mapper. Keeps the largest model (set of
   cameras). An interrupted run is continued.

   All pairs of a small set are matched. In a series (frames of a film) or a large set, each photograph is matched with
   the NEAR next ones, and every EVERY-th one with each other, which closes loops without a vocabulary file. */
#define _XOPEN_SOURCE 700          /* declares strdup */

#include "reconstruct.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/image.h>
#include "src/camera/camera_find.h"
#include "src/camera/colmap_keep.h"
#include "src/fit/photos/photo_points.h"
#include "src/fit/photos/photo_masks.h"
#include "tools/command/command.h"
#include "tools/command/file_guard.h"
#include "film_frames.h"
#include "photo_folder.h"

/* LEAST: fewest photographs that are accepted. FAR_MOST: about the largest number of photographs of which all pairs are
   matched in a large set. PART: pairs per thread and call of COLMAP; progress is shown after each call. */
enum { LEAST = 3, NEAR = 12, EVERY = 8, FAR_MOST = 60, PART = 32 };

/* For each fit_quality: the first octave of SIFT, and the largest set of photographs in which all pairs are matched.
   The octave -1 also looks at twice the size, which takes 60 % of the time for features. */
static const struct {
    const char *first_octave;
    size_t all;
} limits[] = {{"0", 60}, {"-1", 250}, {"-1", 250}};

typedef struct reconstruct_work {
    const reconstruct_options *options;
    task t;
    int is_film, is_watched;       /* is_watched 1: photographs arrive one after the other (--watch) */
    size_t known;                  /* number of photographs, from the first, that earlier calls have matched */
    char source[TASK_PATH];
    char masked[TASK_PATH];        /* folder of the user's masks, or empty; folder `masks` has links to them */
    char folder[TASK_PATH], images[TASK_PATH], masks[TASK_PATH], database[TASK_PATH], list[TASK_PATH];
    char pairs[TASK_PATH];
    char log_name[TASK_PATH];
    photographs photos;
    char threads[16];
    int has_options;               /* 1: COLMAP was asked for the options of the next three fields */
    int names_frames;              /* 1: COLMAP has the option Mapper.fix_existing_frames (3.12 and later) */
    int names_features, names_size;     /* 1: COLMAP has the options FeatureExtraction.use_gpu (3.13 and later), and
                                           FeatureExtraction.max_image_size (4.0 and later) */
    uint64_t looked_at;
    uint32_t points;               /* number of 3D points found, and their mean error in pixels; 0: unknown */
    double error;
} work;

static int no_memory(void)
{
    return fail(EXIT_FAILED, "out of memory");
}

static int write_text(const char *path, fxs_printed *printed)
{
    fxs_message why;
    if (fxs_print_end(printed))
        return no_memory();
    const fxs_encoded file = {.bytes = (void *)printed->text, .size = printed->size};
    const int error = fxs_encoded_write(path, &file, &why);
    free(printed->text);
    return error ? fail_for(&why) : 0;
}

/* Parses numbers from a line of a program's output, one for each % of the pattern. Returns 1 if the line begins like
   the pattern, else 0. */
static int take_numbers(const char *line, const char *pattern, uint32_t *numbers)
{
    for (; *pattern; pattern++) {
        const size_t digits = *pattern == '%' ? strspn(line, "0123456789") : 0;
        if (*pattern == '%' ? !digits || digits > 9 : *line != *pattern)
            return 0;
        if (digits)
            *numbers++ = (uint32_t)strtoul(line, 0, 10);
        line += digits ? digits : 1;
    }
    return 1;
}

static size_t find_photographs(char folder[TASK_PATH], const char *in)
{
    photographs p = {0};
    snprintf(folder, TASK_PATH, "%.*s", TASK_PATH - 1, in);
    photographs_list(&p, folder);
    if (!p.count) {
        join_path(folder, in, "images");
        photographs_list(&p, folder);
    }
    const size_t count = p.count;
    photographs_free(&p);
    return count;
}

int reconstruct_is_photographs(const char *folder)
{
    char in[TASK_PATH];
    return find_photographs(in, folder) > 0;
}

int reconstruct_is_needed(const char *in)
{
    fxs_message why;
    char cameras[FXS_CAMERA_PATH];
    return film_is_named(in) || (is_folder(in) && fxs_camera_file_find(in, cameras, &why));
}

static int take_film(work *w)
{
    return is_folder(w->images) ? 0 : film_frames(&w->t, w->source, w->options->frames, w->images);
}

static int link_photographs(work *w)
{
    photographs p = {0};
    const reconstruct_options *o = w->options;
    const int status = photographs_list(&p, w->source)
                           ? photo_folder_make(&w->t, &p, w->source, w->images, o->threads, o->skip_bad)
                           : no_memory();
    photographs_free(&p);
    return status;
}

static int write_inverse(const char *from, const char *to)
{
    uint8_t *rgba;
    int width, height;
    fxs_message why;
    if (fxs_image_file_read(from, &rgba, &width, &height, &why))
        return fail_for(&why);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
        uint8_t *p = rgba + 4 * i;
        p[0] = p[1] = p[2] = fxs_photo_mask_grey(p) < FXS_PHOTO_MASK_WHITE ? 255 : 0;
        p[3] = 255;
    }
    const int error = fxs_image_file_write(to, rgba, width, height, &why);
    free(rgba);
    return error ? fail_for(&why) : 0;
}

static int take_mask(const work *w, const char *from, const char *name)
{
    char to[TASK_PATH];
    if (snprintf(to, sizeof to, "%s/%s.png", w->masks, name) >= TASK_PATH)
        return fail(EXIT_FAILED, "%s: name too long", name);
    fxs_file_remove(to);
    if (w->options->invert_masks)
        return write_inverse(from, to);
    char *whole = fxs_path_whole(from);
    const int wrong = !whole || fxs_file_link(whole, to);
    free(whole);
    return wrong ? fail(EXIT_FAILED, "%s: %s", to, strerror(errno)) : 0;
}

static int take_masks(const work *w)
{
    size_t taken = 0;
    remove_folder(w->masks);
    int status = *w->masked ? make_folder(w->masks) : 0;
    for (size_t i = 0; i < w->photos.count && !status && *w->masked; i++) {
        char from[FXS_PHOTO_PATH];
        if (!photograph_mask(w->masked, w->photos.names[i], from))
            continue;
        status = take_mask(w, from, w->photos.names[i]);
        taken++;
    }
    return status || taken || !w->options->masks || !*w->masked
               ? status : fail(EXIT_FAILED, "%s: no mask of any photograph of %s", w->masked, w->options->in);
}

enum { EVERY_LENS = -1 };

static int write_list(const work *w, long lens)
{
    fxs_printed list;
    if (fxs_print_begin(&list))
        return no_memory();
    for (size_t i = w->known; i < w->photos.count; i++)
        if (lens == EVERY_LENS || w->photos.lenses[i] == (size_t)lens)
            fprintf(list.file, "%s\n", w->photos.names[i]);
    return write_text(w->list, &list);
}

static int take_photographs(work *w, int are_placed)
{
    int status = w->is_film ? take_film(w) : link_photographs(w);
    if (status)
        return status;
    if (!photographs_list(&w->photos, w->images))
        return no_memory();
    const photograph_look how = {w->masked, w->options->invert_masks, w->options->skip_bad, 0};
    status = are_placed ? 0 : photographs_look(&w->t, &w->photos, w->images, &how);
    if (!status && w->photos.count < LEAST)
        return fail(EXIT_FAILED, "%s: %zu photograph%s: at least %d are needed, and they must overlap", w->options->in,
                    w->photos.count, w->photos.count == 1 ? "" : "s", LEAST);
    status = status ? status : take_masks(w);
    return status ? status : write_list(w, EVERY_LENS);
}

static void look_at_features(task *t, const char *line)
{
    const work *w = t->argument;
    uint32_t done;
    if (take_numbers(line, "Processed file [%/", &done))
        task_show(t, w->looked_at + done, w->photos.count);
}

static int run_colmap(work *w, const char *const *arguments)
{
    const int status = task_run(&w->t, arguments, 0, 0);
    return status ? task_failed(&w->t, "colmap", status) : 0;
}

static void look_at_options(task *t, const char *line)
{
    work *w = t->argument;
    w->names_features |= strstr(line, "--FeatureExtraction.use_gpu") != 0;
    w->names_size |= strstr(line, "--FeatureExtraction.max_image_size") != 0;
    w->names_frames |= strstr(line, "--Mapper.fix_existing_frames") != 0;
}

static int learn_options_of(work *w, const char *command)
{
    const char *const arguments[] = {"colmap", command, "-h", 0};
    task_begin(&w->t, "asking COLMAP for its options", look_at_options);
    const int status = task_run(&w->t, arguments, 0, 0);
    return task_is_cut(status) ? task_failed(&w->t, "colmap", status) : 0;
}

static int learn_options(work *w)
{
    if (w->has_options)
        return 0;
    w->has_options = 1;
    const int status = learn_options_of(w, "feature_extractor");
    return status || !w->is_watched ? status : learn_options_of(w, "mapper");
}

/* Returns 1 if a photograph that is already matched has the lens. */
static int is_known(const work *w, size_t lens)
{
    size_t i = 0;
    while (i < w->known && w->photos.lenses[i] != lens)
        i++;
    return i < w->known;
}

static int find_features_of(work *w, size_t lens)
{
    char camera[24];               /* number of the lens in COLMAP's database, which counts from 1 */
    const int is_added = !w->options->mixed && is_known(w, lens);
    snprintf(camera, sizeof camera, "%zu", is_added ? lens + 1 : 1);
    const char *const arguments[] = {
        "colmap", "feature_extractor", "--database_path", w->database, "--image_path", w->images, "--image_list_path",
        w->list, w->names_features ? "--FeatureExtraction.use_gpu" : "--SiftExtraction.use_gpu", "0",
        w->names_size ? "--FeatureExtraction.max_image_size" : "--SiftExtraction.max_image_size", "1600",
        w->names_features ? "--FeatureExtraction.num_threads" : "--SiftExtraction.num_threads", w->threads,
        "--SiftExtraction.max_num_features", "4096",
        "--SiftExtraction.first_octave", limits[w->options->quality].first_octave,
        w->options->mixed ? "--ImageReader.single_camera_per_image"
        : is_added        ? "--ImageReader.existing_camera_id" : "--ImageReader.single_camera", camera,
        *w->masked ? "--ImageReader.mask_path" : 0, w->masks, 0
    };
    const int status = write_list(w, (long)lens);
    return status ? status : run_colmap(w, arguments);
}

/* Finds features, with a call of COLMAP per lens, because COLMAP assumes one camera per call. */
static int find_features(work *w)
{
    int status = 0;
    task_begin(&w->t, "looking for features of photographs", w->known ? 0 : look_at_features);
    for (size_t lens = 0; lens < w->photos.lens_count && !status; lens++) {
        size_t count = 0;
        for (size_t i = w->known; i < w->photos.count; i++)
            count += w->photos.lenses[i] == lens;
        status = count ? find_features_of(w, lens) : 0;
        w->looked_at += count;
    }
    return status ? status : write_list(w, EVERY_LENS);
}

/* COLMAP 3.8 ends the line of a block when the block is done, with its time; later versions print it at the start. */
static void look_at_matches(task *t, const char *line)
{
    enum { ROW, ROWS, COLUMN, COLUMNS };
    const work *w = t->argument;
    const uint64_t pairs = (uint64_t)w->photos.count * (w->photos.count - 1) / 2;
    const int is_done = strstr(line, " in ") != 0;
    const char *what = strchr(line, ' ');      /* after "Matching", since version 3.12 "Processing" */
    uint32_t n[4];
    if (!what)
        return;
    if (take_numbers(what, " block [%/%, %/%]", n)) {
        if (n[ROW] && n[ROW] <= n[ROWS] && n[COLUMN] && n[COLUMN] <= n[COLUMNS])
            task_show(t, (uint64_t)((double)pairs * ((n[ROW] - 1.0) * n[COLUMNS] + n[COLUMN] - !is_done) /
                                    ((double)n[ROWS] * n[COLUMNS])), pairs);
    } else if (take_numbers(what, " image [%/%]", n))
        task_show(t, n[ROW], n[ROWS]);
}

static int run_matcher(work *w, const char *matcher, const char *option, const char *value)
{
    const char *const arguments[] = {
        "colmap", matcher, "--database_path", w->database,
        w->names_features ? "--FeatureMatching.use_gpu" : "--SiftMatching.use_gpu", "0",
        w->names_features ? "--FeatureMatching.num_threads" : "--SiftMatching.num_threads", w->threads, option, value, 0
    };
    return run_colmap(w, arguments);
}

static size_t is_pair(size_t i, size_t j, size_t count)
{
    const size_t every = count / FAR_MOST > EVERY ? count / FAR_MOST : EVERY;
    return j - i <= NEAR || (i % every == 0 && j % every == 0);
}

static size_t count_pairs(size_t count)
{
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            pairs += is_pair(i, j, count);
    return pairs;
}

static int match_list(work *w, fxs_printed *list)
{
    const int status = write_text(w->pairs, list);
    return status ? status : run_matcher(w, "matches_importer", "--match_list_path", w->pairs);
}

static int match_near(work *w)
{
    const size_t count = w->photos.count, all = count_pairs(count), room = PART * (size_t)w->options->threads;
    size_t done = 0;
    int status = 0;
    fxs_printed list;
    task_begin(&w->t, "matching pairs of photographs", 0);
    task_show(&w->t, 0, all);
    for (size_t i = 0; i < count && !status; i++)
        for (size_t j = i + 1; j < count && !status; j++) {
            if (!is_pair(i, j, count))
                continue;
            if (done % room == 0 && fxs_print_begin(&list))
                return no_memory();
            fprintf(list.file, "%s %s\n", w->photos.names[i], w->photos.names[j]);
            if (++done % room && done < all)
                continue;
            status = match_list(w, &list);
            task_show(&w->t, done, all);
        }
    return status;
}

static const char digits[] = "0123456789";

/* Finds the last number in a name. Returns the length of the text before it. */
static size_t find_number(const char *name, unsigned long *number)
{
    size_t end = strlen(name);
    while (end && !strchr(digits, name[end - 1]))
        end--;
    while (end && strchr(digits, name[end - 1]))
        end--;
    *number = strtoul(name + end, 0, 10);
    return end;
}

/* True if the names differ only in a number with as many digits in each, which grows by an equal step, and no
   photograph has EXIF: frames of a film, not photographs of a camera. */
static int is_series(const photographs *p)
{
    const char *first = p->names[0];
    unsigned long number, before;
    const size_t length = find_number(first, &before), end = length + strspn(first + length, digits);
    find_number(p->names[1], &number);
    const unsigned long step = number - before;
    for (size_t i = 1; i < p->count; i++, before = number)
        if (find_number(p->names[i], &number) != length || strncmp(p->names[i], first, length) ||
            strlen(p->names[i]) != strlen(first) || strcmp(p->names[i] + end, first + end) ||
            !step || number - before != step)
            return 0;
    return !p->has_exif;
}

static int find_matches(work *w)
{
    const size_t count = w->photos.count;
    const int is_film = w->is_film || is_series(&w->photos);
    int has_blank = 0;             /* a blank ends a name in COLMAP's lists of pairs */
    for (size_t i = 0; i < count; i++)
        has_blank |= strpbrk(w->photos.names[i], " \t\v\f\r") != 0;
    if (!w->options->mixed && count > (is_film ? 2 * NEAR : limits[w->options->quality].all) && !has_blank)
        return match_near(w);
    const int all = w->options->mixed || count <= limits[w->options->quality].all;
    task_begin(&w->t, all ? "matching pairs of photographs" : "matching photographs with those near them",
               look_at_matches);
    return all ? run_matcher(w, "exhaustive_matcher", "--ExhaustiveMatching.block_size",
                             w->options->threads > 4 ? "8" : "4")
               : run_matcher(w, "sequential_matcher", "--SequentialMatching.overlap", "12");
}

static void look_at_mapper(task *t, const char *line)
{
    const work *w = t->argument;
    uint32_t number_and_placed[2];
    if (take_numbers(line, "Registering image #% (%)", number_and_placed) ||
        take_numbers(line, "Registering image #% (num_reg_frames=%)", number_and_placed))
        task_show(t, number_and_placed[1], w->photos.count);
}

static void remove_models(const char *models)
{
    char path[TASK_PATH], name[16];
    for (int i = 0; snprintf(name, sizeof name, "%d", i), join_path(path, models, name), is_folder(path); i++)
        remove_folder(path);
    remove_folder(models);
}

static int map_cameras(work *w, const char *models)
{
    const char *const global[] = {"glomap", "mapper", "--database_path", w->database, "--image_path", w->images,
                                  "--output_path", models, 0};
    const char *const stepwise[] = {"colmap", "mapper", "--database_path", w->database, "--image_path", w->images,
                                    "--output_path", models, "--Mapper.num_threads", w->threads,
                                    "--Mapper.min_model_size", "3", 0};
    task_begin(&w->t, "placing photographs", look_at_mapper);
    task_show(&w->t, 0, w->photos.count);
    return task_run(&w->t, global, 0, 0) ? task_run(&w->t, stepwise, 0, 0) : 0;
}

static uint64_t size_of_model(const char *models, const char *name)
{
    char path[TASK_PATH], folder[TASK_PATH];
    unsigned char bytes[8] = {0};
    uint64_t count = 0;
    join_path(folder, models, name);
    join_path(path, folder, "images.bin");
    FILE *file = fxs_stream_open(path, "rb");
    const size_t read = file ? fread(bytes, 1, 8, file) : 0;
    if (file)
        fclose(file);
    for (int i = 7; i >= 0; i--)
        count = count << 8 | bytes[i];
    return read == 8 ? count : 0;
}

/* Reads the files of COLMAP's model to their end. On a full disk, a mapper may truncate them and still exit with 0. */
static int check_model(const work *w, const char *model)
{
    char path[TASK_PATH];
    fxs_view *views = 0;
    fxs_photo_points points = {0};
    fxs_message why;
    join_path(path, model, "points3D.bin");
    const int wrong = fxs_camera_file_read(model, &views, &why) < 0 || fxs_photo_points_colmap(&points, path, &why);
    free(views);
    free(points.points);
    return wrong ? fail(EXIT_FAILED, "%s: the cameras were not written whole, perhaps on a full disk: see %s; the same "
                        "command goes on", why.text, w->log_name) : 0;
}

static int keep_largest(work *w, const char *models)
{
    char sparse[TASK_PATH], from[TASK_PATH], to[TASK_PATH], best[16] = "", name[16];
    uint64_t most = 0;
    for (int i = 0; snprintf(name, sizeof name, "%d", i), size_of_model(models, name); i++)
        if (size_of_model(models, name) > most) {
            most = size_of_model(models, name);
            strcpy(best, name);
        }
    if (!most && w->is_watched)
        return RECONSTRUCT_LATER;
    if (!most)
        return fail(EXIT_FAILED, "%s: no two photographs from different places overlap enough: take more, sharp, "
                    "a step apart, each overlapping most of the one before", w->options->in);
    join_path(sparse, w->folder, "sparse");
    join_path(from, models, best);
    join_path(to, sparse, "0");
    int status = check_model(w, from);
    status = status ? status : make_folder(sparse);
    return status ? status : fxs_file_rename(from, to) ? fail(EXIT_FAILED, "%s: %s", to, strerror(errno)) : 0;
}

static int find_cameras(work *w)
{
    char models[TASK_PATH];
    join_path(models, w->folder, "models");
    int status = learn_options(w);
    status = status ? status : find_features(w);
    status = status ? status : find_matches(w);
    remove_models(models);         /* a stopped mapper may have left its models */
    status = status ? status : make_folder(models);
    if (status)
        return status;
    status = map_cameras(w, models);
    /* COLMAP's mapper also fails, and leaves no model, if no pair of photographs is good enough to start from. */
    status = task_is_cut(status) || (status && size_of_model(models, "0"))
                 ? task_failed(&w->t, "colmap", status) : keep_largest(w, models);
    remove_models(models);
    return status;
}

static void look_at_report(task *t, const char *line)
{
    work *w = t->argument;
    double error;
    take_numbers(line, "Points: %", &w->points);
    if (sscanf(line, "Mean reprojection error: %lf", &error) == 1 && error >= 0 && error < FXS_MAX_SIZE)
        w->error = error;
}

static int has_camera(const char *name, const fxs_view *views, long count)
{
    for (long i = 0; i < count; i++)
        if (!strncmp(name, views[i].name, sizeof views[i].name - 1))
            return 1;
    return 0;
}

/* Returns the number of photographs without a camera. */
static size_t say_missing(const work *w, const fxs_view *views, long count)
{
    char text[400] = "";
    size_t missing = 0, used = 0;
    for (size_t i = 0; i < w->photos.count; i++) {
        if (has_camera(w->photos.names[i], views, count))
            continue;
        if (used < 300)
            used += (size_t)snprintf(text + used, 80, "%s%.70s", missing ? ", " : "", w->photos.names[i]);
        missing++;
    }
    if (missing)
        note("no place was found for %zu: %s%s", missing, text, used < 300 ? "" : ", ...");
    if (4 * missing > w->photos.count)
        note("%s", w->is_film ? "a slower film, without blur, or more --frames, would place more"
                              : "more photographs would place more: sharp, a step apart, each overlapping most of the "
                                "one before");
    return missing;
}

static int report(work *w, reconstruction *found)
{
    char model[TASK_PATH];
    fxs_view *views = 0;
    fxs_message why;
    join_path(model, w->folder, "sparse/0");
    const char *const arguments[] = {"colmap", "model_analyzer", "--path", model, 0};
    const long count = fxs_camera_file_read(model, &views, &why);
    if (count < 0)
        return fail_for(&why);
    task_begin(&w->t, "measuring", look_at_report);
    if (task_run(&w->t, arguments, 0, 0) == 0 && w->points)
        note("%s: cameras of %ld of %zu photographs, %" PRIu32 " points, reprojection error %.2f pixels",
             w->options->in, count, w->photos.count, w->points, w->error);
    else
        note("%s: cameras of %ld of %zu photographs", w->options->in, count, w->photos.count);
    found->placed = (size_t)count;
    found->unplaced = say_missing(w, views, count);
    free(views);
    return 0;
}

static uint64_t mix_text(uint64_t number, const char *text)
{
    for (; *text; text++)
        number = (number ^ (unsigned char)*text) * 1099511628211u;
    return number;
}

static uint64_t number_of(const work *w, const photographs *p)
{
    fxs_file_facts facts;
    uint64_t number = mix_text(14695981039346656037u, w->is_watched ? w->source : "");
    char path[TASK_PATH], text[TASK_PATH + 48];
    for (size_t i = 0; i < p->count + (size_t)w->is_film; i++) {
        const char *name = w->is_film ? "" : p->names[i];
        join_path(path, w->source, name);
        const int there = fxs_file_look(w->is_film ? w->source : path, &facts) != FXS_FILE_NONE;
        snprintf(text, sizeof text, "%s %" PRIu64 " ", name, there ? facts.size : 0);
        number = mix_text(number, text);
    }
    return number;
}

static int find_masks(work *w)
{
    const char *given = w->options->masks;
    if (given)
        snprintf(w->masked, TASK_PATH, "%.*s", TASK_PATH - 1, given);
    else
        join_path(w->masked, w->options->in, "masks");
    if (files_same(w->masked, w->masks))
        return fail(EXIT_USAGE, "%s: the masks are written there: give another folder to --masks", w->masked);
    if (is_folder(w->masked))
        return 0;
    if (given && *given)
        return fail(EXIT_FAILED, "%s: no such folder of masks", given);
    *w->masked = 0;
    return w->options->invert_masks ? fail(EXIT_FAILED, "--invert-masks: %s has no masks", w->options->in) : 0;
}

static int check_folder(const work *w, uint64_t number, uint64_t of, uint32_t frames)
{
    if (of != number)
        return fail(EXIT_FAILED, "%s: the cameras of other photographs: remove it, or give another -o", w->folder);
    if (w->options->frames && w->options->frames != frames)
        return fail(EXIT_FAILED, "%s: made without --frames %u: leave out --frames to continue, remove the folder, or "
                    "give another -o", w->folder, (unsigned)w->options->frames);
    return 0;
}

static int claim_folder(const work *w)
{
    photographs p = {0};
    char path[TASK_PATH];
    uint64_t of = 0;
    uint32_t frames = 0;
    if (!w->is_film && !w->is_watched && !photographs_list(&p, w->source))
        return no_memory();
    const uint64_t number = number_of(w, &p);
    photographs_free(&p);
    join_path(path, w->folder, "of");
    FILE *file = fxs_stream_open(path, "r");
    const int has = file && fscanf(file, "%" SCNx64 " %" SCNu32, &of, &frames) >= 1;
    if (file)
        fclose(file);
    if (has)
        return check_folder(w, number, of, frames);
    fxs_printed text;
    if (fxs_print_begin(&text))
        return no_memory();
    fprintf(text.file, "%016" PRIx64 " %" PRIu32 "\n", number, w->options->frames);
    return write_text(path, &text);
}

static int lock_folder(const work *w)
{
    char path[TASK_PATH];
    join_path(path, w->folder, "lock");
    const int taken = fxs_file_lock(path);
    return taken > 0 ? fail(EXIT_FAILED, "%s: another fit is at work there: wait for its end, or give another -o",
                            w->folder)
           : taken ? fail(EXIT_FAILED, "%s: %s", path, strerror(errno)) : 0;
}

static int open_folder(work *w)
{
    const size_t room = TASK_PATH - 64;
    if (strlen(w->options->out) > room || strlen(w->options->in) > room)
        return fail(EXIT_FAILED, "a name of more than %zu characters", room);
    /* COLMAP rejects a path that begins like an option */
    snprintf(w->folder, TASK_PATH, "%s%s.cameras", *w->options->out == '-' ? "./" : "", w->options->out);
    strcpy(w->source, w->options->in);
    if (!w->is_film && !w->is_watched && !find_photographs(w->source, w->options->in))
        return fail(EXIT_FAILED, "%s: no photographs here, nor in a folder images here", w->options->in);
    join_path(w->images, w->folder, "images");
    join_path(w->masks, w->folder, "masks");
    join_path(w->database, w->folder, "database.db");
    join_path(w->list, w->folder, "photographs.txt");
    join_path(w->pairs, w->folder, "pairs.txt");
    join_path(w->log_name, w->folder, "log.txt");
    int status = find_masks(w);
    status = status ? status : make_folder(w->folder);
    status = status ? status : lock_folder(w);
    status = status ? status : claim_folder(w);
    if (status)
        return status;
    w->t.of = w->options->in;
    w->t.log_name = w->log_name;
    w->t.argument = w;
    w->t.log = fxs_stream_open(w->log_name, "a");
    snprintf(w->threads, sizeof w->threads, "%u", (unsigned)w->options->threads);
    return w->t.log ? 0 : fail(EXIT_FAILED, "%s: %s", w->log_name, strerror(errno));
}

static int begin(work *w, const reconstruct_options *options)
{
    w->options = options;
    w->is_film = film_is_named(options->in);
    fxs_program_set("QT_QPA_PLATFORM", "offscreen");   /* COLMAP loads Qt even if it opens no window */
    return open_folder(w);
}

static void end(work *w)
{
    if (w->t.log)
        fclose(w->t.log);
    photographs_free(&w->photos);
}

int reconstruct(const reconstruct_options *options, reconstruction *found)
{
    static work w;
    memset(&w, 0, sizeof w);
    memset(found, 0, sizeof *found);
    int status = begin(&w, options);
    const int are_placed = !status && reconstruct_has_cameras(&w);
    status = status ? status : take_photographs(&w, are_placed);
    if (!are_placed)
        status = status ? status : find_cameras(&w);
    status = status ? status : report(&w, found);
    found->folder = status ? 0 : strdup(w.folder);
    end(&w);
    return status || found->folder ? status : no_memory();
}

/* ---- Photographs that arrive one after the other ----------------------------------------------------------------- */

/* Pairs of a photograph that has arrived: the NEAR ones before it, every EVERY-th one, and those without a camera. */
static int match_arrived(work *w, const fxs_view *views, long count)
{
    fxs_printed list;
    if (fxs_print_begin(&list))
        return no_memory();
    for (size_t j = w->known; j < w->photos.count; j++)
        for (size_t i = 0; i < j; i++)
            if (j - i <= NEAR || i % EVERY == 0 || w->options->mixed || !has_camera(w->photos.names[i], views, count))
                fprintf(list.file, "%s %s\n", w->photos.names[i], w->photos.names[j]);
    task_begin(&w->t, "matching pairs of photographs", 0);
    return match_list(w, &list);
}

/* Returns 1 if a photograph without a camera has a lens that no photograph with a camera has. Then COLMAP may change
   the lenses, and the old ones are restored. */
static int has_new_lens(const work *w, const fxs_view *views, long count)
{
    for (size_t i = 0; i < w->photos.count; i++) {
        size_t k = 0;
        while (k < w->photos.count &&
               (w->photos.lenses[k] != w->photos.lenses[i] || !has_camera(w->photos.names[k], views, count)))
            k++;
        if (k == w->photos.count)
            return 1;
    }
    return w->options->mixed;
}

static int map_more(work *w, const char *before, const char *after, int refines)
{
    const char *const lenses = refines ? "1" : "0";
    const char *const arguments[] = {
        "colmap", "mapper", "--database_path", w->database, "--image_path", w->images, "--input_path", before,
        "--output_path", after, "--Mapper.num_threads", w->threads, "--Mapper.min_model_size", "3",
        w->names_frames ? "--Mapper.fix_existing_frames" : "--Mapper.fix_existing_images", "1",
        "--Mapper.ba_refine_focal_length", lenses, "--Mapper.ba_refine_extra_params", lenses, 0
    };
    task_begin(&w->t, "placing photographs", 0);
    return run_colmap(w, arguments);
}

/* Replaces the model `before` by `after`, after giving its cameras their poses back. Removes the files of COLMAP 3.12
   and later that repeat the poses. */
static int replace_model(const work *w, const char *before, const char *after)
{
    static const char *const repeats[] = {"rigs.bin", "frames.bin"};
    char path[TASK_PATH];
    fxs_message why;
    const int status = check_model(w, after);
    if (status || fxs_colmap_keep(before, after, &why))
        return status ? status : fail_for(&why);
    for (int i = 0; i < 2; i++) {
        join_path(path, after, repeats[i]);
        fxs_file_remove(path);
    }
    join_path(path, w->folder, "before");
    remove_folder(path);
    if (fxs_file_rename(before, path) || fxs_file_rename(after, before))
        return fail(EXIT_FAILED, "%s: %s", before, strerror(errno));
    remove_folder(path);
    return 0;
}

/* Returns the number of photographs, from the first, that an earlier run has matched: up to the last with a camera. */
static size_t count_matched(const work *w, const fxs_view *views, long count)
{
    size_t matched = w->photos.count;
    while (matched && !has_camera(w->photos.names[matched - 1], views, count))
        matched--;
    return matched;
}

static int place_more(work *w)
{
    char before[TASK_PATH], after[TASK_PATH];
    fxs_view *views = 0;
    fxs_message why;
    join_path(before, w->folder, "sparse/0");
    join_path(after, w->folder, "after");
    const long count = fxs_camera_file_read(before, &views, &why);
    int status = count < 0 ? fail_for(&why) : learn_options(w);
    w->known = w->known || status ? w->known : count_matched(w, views, count);
    status = status ? status : find_features(w);
    status = status ? status : match_arrived(w, views, count);
    const int refines = !status && has_new_lens(w, views, count);
    free(views);
    remove_folder(after);
    status = status ? status : make_folder(after);
    status = status ? status : map_more(w, before, after, refines);
    return status ? status : replace_model(w, before, after);
}

int reconstruct_open(const reconstruct_options *options, reconstruct_work **r)
{
    char kept[TASK_PATH], sparse[TASK_PATH];
    work *w = *r = calloc(1, sizeof *w);
    if (!w)
        return no_memory();
    w->is_watched = 1;
    int status = begin(w, options);
    join_path(kept, w->folder, "before");
    join_path(sparse, w->folder, "sparse/0");
    if (!status && is_folder(kept) && !is_folder(sparse) && fxs_file_rename(kept, sparse))
        status = fail(EXIT_FAILED, "%s: %s", sparse, strerror(errno));
    return status ? status : make_folder(w->images);
}

void reconstruct_close(reconstruct_work *w)
{
    if (w)
        end(w);
    free(w);
}

const char *reconstruct_folder(const reconstruct_work *w)
{
    return w->folder;
}

int reconstruct_has_cameras(const reconstruct_work *w)
{
    char found[TASK_PATH];
    join_path(found, w->folder, "sparse/0");
    return is_folder(found);
}

int reconstruct_place(reconstruct_work *w)
{
    reconstruction found;
    const int are_placed = reconstruct_has_cameras(w);
    const photograph_look how = {.masks = "", .is_quiet = w->known > 0};
    int status = photographs_list_more(&w->photos, w->images) ? 0 : no_memory();
    status = status ? status : photographs_look(&w->t, &w->photos, w->images, &how);
    if (status || w->photos.count < LEAST)
        return status ? status : RECONSTRUCT_LATER;
    if (!are_placed)
        fxs_file_remove(w->database);
    status = are_placed ? place_more(w) : find_cameras(w);
    if (!status && !are_placed)
        status = report(w, &found);
    w->known = status ? w->known : w->photos.count;
    return status;
}
