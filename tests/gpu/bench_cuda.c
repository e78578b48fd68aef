/* Times frames of 1920x1080 on the GPU by CUDA events and prints one table: single ones by stages and whole, then of a
 * batch, into device memory and into pinned host memory. Each argument: FILE.fxs, for an overview of the scene, or
 * FILE.fxs:CAMERAS:N,N,... for views of a camera file. Medians, milliseconds; one row of every scene is for the square
 * cut-off, one for a smaller picture. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../port/camera/camera.h"
#include "../../port/posix/map.h"
#include "../../src/packed.h"
#include "peek.h"

enum { WARM_UP = 5, REPEATS = 31, BATCH = 16, SLOTS = 4 };

static fxs_cuda_failure failure;
static unsigned char *pixels[BATCH], *pinned[BATCH];

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float median(float *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_floats);
    return values[count / 2];
}

static float time_frames(fxs_cuda *cuda, const fxs_camera *camera, const fxs_options *options,
                         unsigned char *const into[], uint32_t count)
{
    fxs_cuda_frame frames[BATCH];
    float times[REPEATS];
    for (uint32_t i = 0; i < count; i++)
        frames[i] = (fxs_cuda_frame){*camera, into[i], (ptrdiff_t)camera->width * 4};
    for (int i = -WARM_UP; i < REPEATS; i++) {
        float t = peek_time(cuda, frames, count, options, &failure);
        if (t < 0)
            return -1;
        times[i < 0 ? 0 : i] = t;
    }
    return median(times, REPEATS) / (float)count;
}

/* Medians of the stages, with events between them. */
static fxs_cuda_stats time_stages(fxs_cuda *cuda, const fxs_camera *camera, const fxs_options *options)
{
    float times[FXS_CUDA_STAGES][REPEATS];
    fxs_cuda_stats stats;
    const fxs_cuda_frame frame = {*camera, pixels[0], (ptrdiff_t)camera->width * 4};
    memset(&stats, 0, sizeof stats);
    fxs_cuda_time(cuda, 1);
    for (int i = 0; i < REPEATS; i++) {
        if (fxs_cuda_render(cuda, &frame, 1, options, 0, &failure) || fxs_cuda_finish(cuda, &stats, &failure))
            break;
        for (int s = 0; s < FXS_CUDA_STAGES; s++)
            times[s][i] = stats.milliseconds[s];
    }
    fxs_cuda_time(cuda, 0);
    for (int s = 0; s < FXS_CUDA_STAGES; s++)
        stats.milliseconds[s] = median(times[s], REPEATS);
    return stats;
}

static void row(fxs_cuda *single, fxs_cuda *batch, const char *name, const fxs_camera *camera,
                const fxs_options *options)
{
    const float frame = time_frames(single, camera, options, pixels, 1);
    const fxs_cuda_stats s = time_stages(single, camera, options);
    const float of_batch = batch ? time_frames(batch, camera, options, pixels, BATCH) : -1;
    const float to_host = batch ? time_frames(batch, camera, options, pinned, BATCH) : -1;
    if (frame < 0) {
        printf("| %s | %s |\n", name, failure.text);
        return;
    }
    printf("| %s, %dx%d%s | %" PRIu32 " | %" PRIu64, name, camera->width, camera->height,
           options->cutoff == FXS_CUTOFF_SQUARE ? ", square" : "", s.visible, s.entries);
    for (int i = 0; i < FXS_CUDA_STAGES; i++)
        printf(" | %.3f", (double)s.milliseconds[i]);
    printf(" | %.3f | ", (double)frame);
    if (batch)
        printf("%.3f | %.3f", (double)of_batch, (double)to_host);
    else
        printf(" | ");
    printf(" | %.1f |\n", (double)s.memory.total * 1e-6);
    fflush(stdout);
}

static void rows_of_view(fxs_cuda *single, fxs_cuda *batch, const char *name, fxs_file_view view, int more)
{
    fxs_message message;
    fxs_camera camera;
    fxs_options options;
    fxs_options_init(&options);
    fxs_view_resize(&view, 1920, 1080);
    fxs_camera_from_view(&camera, &view, &message);
    row(single, batch, name, &camera, &options);
    if (!more)
        return;
    options.cutoff = FXS_CUTOFF_SQUARE;
    row(single, 0, name, &camera, &options);
    options.cutoff = FXS_CUTOFF_MAHALANOBIS;
    fxs_view_resize(&view, 640, 360);
    fxs_camera_from_view(&camera, &view, &message);
    row(single, batch, name, &camera, &options);
}

static fxs_file_view overview(const fxs_packed_header *header)
{
    const double up[3] = {0, -1, 0};
    double low[3], high[3];
    fxs_file_view view;
    fxs_message message;
    for (int k = 0; k < 3; k++) {
        low[k] = (double)header->inner_low_q32[k] / 4294967296.0;
        high[k] = (double)header->inner_high_q32[k] / 4294967296.0;
    }
    fxs_view_frame_box(&view, low, high, up, 50, 1920, 1080, &message);
    return view;
}

static void rows_of_scene(char *argument)
{
    char *path = strtok(argument, ":"), *cameras = strtok(NULL, ":"), label[200];
    fxs_mapping file;
    fxs_scene scene;
    fxs_message message;
    fxs_file_view *views = 0;
    fxs_cuda *single = 0, *batch = 0;
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    if (fxs_map(&file, path, &message)) {
        puts(message.text);
        return;
    }
    if (fxs_scene_open(&scene, file.data, file.bytes) || fxs_cuda_create(&single, 0, 0, 1, &failure) ||
        fxs_cuda_upload(single, &scene, &failure) || fxs_cuda_create(&batch, 0, 0, SLOTS, &failure) ||
        fxs_cuda_upload(batch, &scene, &failure))
        printf("%s: %s\n", path, failure.text);
    else if (!cameras)
        rows_of_view(single, batch, name, overview(file.data), 1);
    else if (fxs_camera_file_read(cameras, &views, &message) < 0)
        puts(message.text);
    for (char *n = views ? strtok(NULL, ",") : 0, *first = n; n; n = strtok(NULL, ",")) {
        snprintf(label, sizeof label, "%s view %s", name, n);
        rows_of_view(single, batch, label, views[atoi(n)], n == first);
    }
    free(views);
    fxs_cuda_destroy(single);
    fxs_cuda_destroy(batch);
    fxs_unmap(&file);
}

int main(int argc, char **argv)
{
    for (int i = 0; i < BATCH; i++)
        if (!(pixels[i] = peek_device_memory(1920 * 1080 * 4)) || !(pinned[i] = peek_pinned_memory(1920 * 1080 * 4)))
            return puts("no CUDA device, or no memory"), 1;
    printf("| scene | visible | entries | project | bin | blend | frame | of %d, each | to the host | MB |\n"
           "|---|---|---|---|---|---|---|---|---|---|\n", BATCH);
    for (int i = 1; i < argc; i++)
        rows_of_scene(argv[i]);
    return 0;
}
