/* Writes the result of a fit. Measures a scene against its photographs by PSNR, SSIM, and PSNR after an affine map
   of colours. */
#include "fit_result.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include "src/base/os_calls.h"
#include "tools/command/file_guard.h"

int result_check(const char *out)
{
    if (!ends_with(out, ".fxs") && !ends_with(out, ".ply") && !ends_with(out, ".fit"))
        return fail(EXIT_USAGE, "%s: expected a name ending in .fxs, .ply or .fit", out);
    return result_check_place(out);
}

int result_check_place(const char *out)
{
    const enum fxs_file_kind kind = fxs_file_kind(out);
    const char *fault = fxs_path_fault(out);
    if (fault)
        return fail(EXIT_FAILED, "%s: cannot be written: it %s", out, fault);
    if (kind == FXS_FILE_FOLDER)
        return fail(EXIT_FAILED, "%s: cannot be written: %s", out, strerror(EISDIR));
    if (kind == FXS_FILE_OTHER)
        return fxs_file_may_be_written(out) ? fail(EXIT_FAILED, "%s: cannot be written: %s", out, strerror(errno)) : 0;
    const char *slash = strrchr(out, '/');
    char *folder = slash ? strdup(out) : strdup(".");
    if (!folder)
        return fail(EXIT_FAILED, "out of memory");
    if (slash)
        folder[slash - out + 1] = 0;
    const int error = fxs_file_may_be_written(folder) ? errno : 0;
    free(folder);
    return error ? fail(EXIT_FAILED, "%s: cannot be written: %s", out, strerror(error)) : 0;
}

static int copy(fxs_scene_writer *writer, fxs_scene_file *file, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;)
        if (n < 0 || fxs_scene_writer_put(writer, batch, (size_t)n, message))
            return -1;
    return 0;
}

/* Converts the bounds of a block (part of the scene) to a filter. A block excludes its upper bounds, but a filter
   includes them. */
static void keep_block(fxs_scene_filter *filter, const fxs_fit_block *block)
{
    for (int k = 0; k < 3; k++) {
        filter->low[k] = block->low[k];
        filter->high[k] = isinf(block->high[k]) ? block->high[k] : nextafter(block->high[k], -(double)INFINITY);
    }
}

/* Keeps only Gaussians that can be drawn, so that all written numbers are finite. */
static int keep_drawable(fxs_scene_file *file, const fxs_fit_block *block, fxs_scene_file_info *info,
                         fxs_message *message)
{
    fxs_scene_filter filter;
    fxs_scene_filter_report report;
    fxs_scene_filter_init(&filter);
    filter.drawable = 1;
    if (block && block->number)
        keep_block(&filter, block);
    return info->count ? fxs_scene_file_filter(file, &filter, info, &report, 0, message) : 0;
}

static int write_floats(const fxs_gaussian_source *gaussians, const fxs_fit_block *block, const char *out,
                        fxs_message *message)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_writer *writer;
    fxs_message closing;
    if (fxs_scene_file_open_gaussians(out, gaussians, 0, &file, &info, message))
        return -1;
    int result = keep_drawable(file, block, &info, message);
    const fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = info.count,
                                             .sh_degree = info.sh_degree,
                                             .antialiased = info.antialiased, .format = "ply"};
    if (!result)
        result = fxs_scene_writer_open(out, &options, &writer, message);
    if (!result) {
        result = copy(writer, file, message);
        if (fxs_scene_writer_close(writer, 0, 0, result ? &closing : message))
            result = -1;
    }
    fxs_scene_file_close(file);
    return result;
}

int result_write_outside(const fxs_fit_block *block, const char *out)
{
    fxs_gaussian_source gaussians;
    fxs_message message;
    fxs_fit_block_gaussians(block, &gaussians);
    return write_floats(&gaussians, block, out, &message) ? fail_for(&message) : 0;
}

static int write_fit(const fit_result *r, fxs_fit *fit, const fxs_fit_block *block, const char *out,
                     fxs_message *message)
{
    fxs_gaussian_source gaussians;
    if (ends_with(out, ".fxs"))
        return fxs_file_write(out, r->packed.data, r->packed.bytes, message);
    if (ends_with(out, ".fit"))
        return fxs_fit_save(fit, out, message);
    return fxs_fit_gaussians(fit, &gaussians, message) || write_floats(&gaussians, block, out, message);
}

int result_write(fit_result *r, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block, const char *out)
{
    fxs_message message;
    memset(r, 0, sizeof *r);
    int result = fxs_fit_pack(fit, &r->packed, &r->report, &message);
    r->bytes = r->packed.bytes;
    if (!result) {
        /* A failure is no fault: only the up direction is of use, and fxs_start_choose finds a missing one. */
        (void)fxs_fit_start_view(photos->fit, photos->fit_count, r->packed.data, &message);
        result = fxs_start_choose(r->packed.data, r->packed.bytes, &message);
    }
    if (!result)
        result = write_fit(r, fit, block, out, &message);
    return result ? fail_for(&message) : 0;
}

int result_write_cameras(const char *path, const fxs_photos *photos)
{
    const size_t count = photos->fit_count + photos->held_out_count;
    fxs_message message;
    fxs_view *views = malloc(count * sizeof *views);
    if (!views)
        return fail(EXIT_FAILED, "out of memory");
    for (size_t i = 0; i < count; i++)
        views[i] = i < photos->fit_count ? photos->fit[i].view : photos->held_out[i - photos->fit_count].view;
    const int status = fxs_camera_file_write(path, views, count, &message) ? fail_for(&message) : 0;
    free(views);
    return status;
}

int result_pose(fxs_fit *fit, const fxs_photos *photos, fxs_fit_photo **fitted)
{
    fxs_message message;
    *fitted = malloc(photos->fit_count * sizeof **fitted);
    if (!*fitted)
        return fail(EXIT_FAILED, "out of memory");
    memcpy(*fitted, photos->fit, photos->fit_count * sizeof **fitted);
    return fxs_fit_pose_photos(fit, *fitted, &message) ? fail_for(&message) : 0;
}

typedef struct gauge {
    renderer renderer;
    const world *world;
    fxs_options options;
    picture drawn;
    const char *compare;
} gauge;

static uint8_t *to_rgba(const fxs_fit_photo *photo)
{
    const size_t pixels = (size_t)photo->view.width * (size_t)photo->view.height;
    uint8_t *rgba = malloc(4 * pixels);
    for (size_t i = 0; i < pixels && rgba; i++) {
        memcpy(rgba + 4 * i, photo->pixels + 3 * i, 3);
        rgba[4 * i + 3] = 255;
    }
    return rgba;
}

static const fxs_fit_photo *measured_of(const fxs_photos *photos, size_t *count)
{
    *count = photos->held_out_count ? photos->held_out_count : photos->fit_count;
    return photos->held_out_count ? photos->held_out : photos->fit;
}

static void name_picture(char name[4096], const char *folder, long index, const fxs_view *view)
{
    const char *slash = strrchr(view->name, '/'), *base = slash ? slash + 1 : view->name;
    snprintf(name, 4096, "%s/%04ld_%.*s.png", folder, index, (int)strcspn(base, "."), base);
}

void result_tell_pictures(const fxs_photos *photos, const char *compare)
{
    size_t count;
    const fxs_fit_photo *measured = measured_of(photos, &count);
    for (size_t i = 0; i < count; i++) {
        char name[4096];
        name_picture(name, compare, (long)i, &measured[i].view);
        files_write(name);
    }
}

/* Writes a photograph and its rendered picture side by side. Pixels that the mask ignores are darkened. */
static int write_pair(const gauge *g, long index, const fxs_fit_photo *photo, uint8_t *photograph)
{
    const fxs_view *view = &photo->view;
    const size_t width = (size_t)view->width, row = 4 * width;
    uint8_t *both = malloc(2 * row * (size_t)view->height);
    char name[4096];
    fxs_message message;
    if (!both)
        return fail(EXIT_FAILED, "out of memory");
    for (size_t i = 0; photo->mask && i < width * (size_t)view->height; i++)
        for (size_t c = 0; c < 3 && !photo->mask[i]; c++)
            photograph[4 * i + c] /= 4;
    for (size_t y = 0; y < (size_t)view->height; y++) {
        memcpy(both + 2 * row * y, photograph + row * y, row);
        memcpy(both + 2 * row * y + row, g->drawn.pixels + row * y, row);
    }
    name_picture(name, g->compare, index, view);
    const int result = fxs_image_file_write(name, both, 2 * view->width, view->height, &message);
    free(both);
    return result ? fail_for(&message) : 0;
}

static int measure_photo(gauge *g, const fxs_fit_photo *photo, long index, quality_view *out)
{
    const fxs_view *view = &photo->view;
    int status = renderer_render(&g->renderer, g->world, view, &g->options, &g->drawn, 0);
    uint8_t *rgba = status ? 0 : to_rgba(photo);
    if (!status && (!rgba || fxs_metrics_compare_masked(rgba, g->drawn.pixels, photo->mask, view->width, view->height,
                                                        &out->metrics)))
        status = fail(EXIT_FAILED, "out of memory");
    if (!status)
        out->affine_psnr = fxs_metrics_affine_psnr(g->drawn.pixels, rgba, photo->mask, view->width, view->height);
    if (!status && g->compare)
        status = write_pair(g, index, photo, rgba);
    memcpy(out->name, view->name, sizeof out->name);
    out->index = index;
    out->width = view->width;
    out->height = view->height;
    free(rgba);
    return status;
}

static int measure_all(gauge *g, const fxs_photos *photos, quality *q)
{
    char label[] = "measuring";
    size_t count;
    const fxs_fit_photo *measured = measured_of(photos, &count);
    q->count = (long)count;
    q->has_affine = 1;
    q->views = calloc(count, sizeof *q->views);
    int status = q->views ? 0 : fail(EXIT_FAILED, "out of memory");
    for (long i = 0; i < q->count && !status; i++) {
        progress_bar(label, (double)i / (double)q->count);
        status = measure_photo(g, &measured[i], i, &q->views[i]);
    }
    progress_end();
    if (!status)
        quality_sum_up(q);
    return status;
}

int result_measure(quality *q, world *scene, const fxs_photos *photos, const frame_options *frame, const char *compare)
{
    gauge g = {.world = scene, .options = frame->render, .compare = compare};
    int status = renderer_open(&g.renderer, frame);
    if (!status)
        status = measure_all(&g, photos, q);
    renderer_close(&g.renderer);
    picture_free(&g.drawn);
    return status;
}

int result_measure_fitted(double psnr[2], world *scene, const fxs_photos *photos, const frame_options *frame)
{
    const size_t count = photos->held_out_count < photos->fit_count ? photos->held_out_count : photos->fit_count;
    fxs_fit_photo *chosen = malloc((count + 1) * sizeof *chosen);
    const fxs_photos some = {.held_out = chosen, .held_out_count = count};
    quality q = {0};
    for (size_t i = 0; i < count && chosen; i++)
        chosen[i] = photos->fit[i * photos->fit_count / count];
    const int status = !chosen ? fail(EXIT_FAILED, "out of memory")
                       : count ? result_measure(&q, scene, &some, frame, 0)
                               : 0;
    psnr[0] = q.psnr;
    psnr[1] = q.affine_psnr;
    quality_free(&q);
    free(chosen);
    return status;
}

void result_free(fit_result *r)
{
    fxs_packed_scene_free(&r->packed);
    quality_free(&r->quality);
}
