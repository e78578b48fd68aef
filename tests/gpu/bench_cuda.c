/* Times CUDA frames of 1920x1080. Prints medians in milliseconds for the stages of single frames and for batches of
 * frames. Arguments:
 *   FILE.fxs                an overview of the scene
 *   FILE.fxs:CAMERAS:N,N    views N of a camera file
 *   FILE.fxs@N              N copies of the scene on a square
 *   FILE.fxs%N              a level of detail with at most N Gaussians */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/packed.h>
#include "peek.h"

enum { EYE_WIDTH = 2064, EYE_HEIGHT = 2208 };
enum { WARM_UP = 5, REPEATS = 31, BATCH = 16, SLOTS = 4, OBJECTS = 400, TRACE = 16 };   /* TRACE: bytes per pixel for
                                                                                           pictures of depths and ids */

static fxs_message failure;
static unsigned char *pixels[BATCH], *pinned[BATCH], *traces[BATCH];
static fxs_object objects[OBJECTS];
static uint32_t object_count, budget;

typedef struct kind {
    enum fxs_cutoff cutoff;
    int ids, means;                /* ids 1: also draws median depths and ids; means 1: also draws mean depths */
    int eyes;                      /* number of eyes: 2 for a stereo pair, 0 for a single picture */
} kind;

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

static fxs_options options_of(const kind *k)
{
    fxs_options options;
    fxs_options_init(&options);
    options.cutoff = k->cutoff;
    options.budget = budget;
    return options;
}

static fxs_cuda_frame frame_of(const fxs_camera *camera, const kind *k, unsigned char *const into[], uint32_t i)
{
    fxs_cuda_frame frame = {*camera, objects, object_count, {.colour = {into[i], (ptrdiff_t)camera->width * 4}}};
    for (int a = 0; a < 3 && k->eyes; a++)     /* the eyes are 0.0625 scene units apart */
        frame.camera.position_q32[a] += (int64_t)camera->rotation_q30[a] * (i ? 1 : -1) >> 3;
    const size_t plane = (size_t)camera->width * (size_t)camera->height * 4;
    if (k->ids) {
        frame.targets.id = (fxs_image){traces[i], (ptrdiff_t)camera->width * 8};
        frame.targets.median_depth = (fxs_image){traces[i] + 2 * plane, (ptrdiff_t)camera->width * 4};
    }
    if (k->means)
        frame.targets.mean_depth = (fxs_image){traces[i] + 3 * plane, (ptrdiff_t)camera->width * 4};
    return frame;
}

static float time_frames(fxs_cuda *cuda, const fxs_camera *camera, const kind *k, unsigned char *const into[],
                         uint32_t count)
{
    const fxs_options options = options_of(k);
    fxs_cuda_frame frames[BATCH];
    float times[REPEATS];
    for (uint32_t i = 0; i < count; i++)
        frames[i] = frame_of(camera, k, into, i);
    for (int i = -WARM_UP; i < REPEATS; i++) {
        float t = peek_time(cuda, frames, count, &options, &failure);
        if (t < 0)
            return -1;
        times[i < 0 ? 0 : i] = t;
    }
    return median(times, REPEATS) / (float)(k->eyes ? 1 : count);
}

static fxs_cuda_stats time_stages(fxs_cuda *cuda, const fxs_camera *camera, const kind *k)
{
    const fxs_options options = options_of(k);
    float times[FXS_CUDA_STAGES][REPEATS];
    fxs_cuda_stats stats;
    const fxs_cuda_frame frames[2] = {frame_of(camera, k, pixels, 0), frame_of(camera, k, pixels, 1)};
    memset(&stats, 0, sizeof stats);
    fxs_cuda_time(cuda, 1);
    for (int i = 0; i < REPEATS; i++) {
        if (fxs_cuda_render(cuda, frames, k->eyes ? 2 : 1, &options, 0, &failure) ||
            fxs_cuda_finish(cuda, &stats, &failure))
            break;
        for (int s = 0; s < FXS_CUDA_STAGES; s++)
            times[s][i] = stats.milliseconds[s];
    }
    fxs_cuda_time(cuda, 0);
    for (int s = 0; s < FXS_CUDA_STAGES; s++)
        stats.milliseconds[s] = median(times[s], REPEATS);
    return stats;
}

static void row(fxs_cuda *single, fxs_cuda *batch, const char *name, const fxs_camera *camera, const kind *k)
{
    const float frame = time_frames(single, camera, k, pixels, k->eyes ? 2 : 1);
    const fxs_cuda_stats s = time_stages(single, camera, k);
    const float of_batch = batch ? time_frames(batch, camera, k, pixels, BATCH) : -1;
    const float to_host = batch ? time_frames(batch, camera, k, pinned, BATCH) : -1;
    if (frame < 0) {
        printf("| %s | %s |\n", name, failure.text);
        return;
    }
    printf("| %s, %s%dx%d%s%s%s | %" PRIu32 " | %" PRIu64, name, k->eyes ? "two eyes, " : "", camera->width,
           camera->height, k->cutoff == FXS_CUTOFF_SQUARE ? ", square" : "", k->ids ? ", median depth, id" : "",
           k->means ? ", mean depth" : "", s.visible, s.entries);
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

static void rows_of_eyes(fxs_cuda *single, fxs_cuda *batch, const char *name, fxs_view view)
{
    static const kind colour = {FXS_CUTOFF_MAHALANOBIS, 0, 0, 0}, eyes = {FXS_CUTOFF_MAHALANOBIS, 0, 0, 1};
    fxs_message message;
    fxs_camera camera;
    fxs_view_resize(&view, EYE_WIDTH, EYE_HEIGHT);
    fxs_camera_from_view(&camera, &view, &message);
    row(single, 0, name, &camera, &colour);
    row(batch, 0, name, &camera, &eyes);
}

static void rows_of_view(fxs_cuda *single, fxs_cuda *batch, const char *name, fxs_view view, int more)
{
    static const kind colour = {FXS_CUTOFF_MAHALANOBIS, 0, 0, 0}, square = {FXS_CUTOFF_SQUARE, 0, 0, 0};
    static const kind ids = {FXS_CUTOFF_MAHALANOBIS, 1, 0, 0}, means = {FXS_CUTOFF_MAHALANOBIS, 1, 1, 0};
    fxs_message message;
    fxs_camera camera;
    fxs_view_resize(&view, 1920, 1080);
    fxs_camera_from_view(&camera, &view, &message);
    row(single, batch, name, &camera, &colour);
    if (!more)
        return;
    row(single, 0, name, &camera, &square);
    row(single, 0, name, &camera, &ids);
    row(single, 0, name, &camera, &means);
    fxs_view_resize(&view, 640, 360);
    fxs_camera_from_view(&camera, &view, &message);
    row(single, batch, name, &camera, &colour);
    rows_of_eyes(single, batch, name, view);
}

/* Returns a view of the scene's bounding box, widened along x and z for `aside` objects side by side. */
static fxs_view overview(const fxs_packed_header *header, uint32_t aside)
{
    const double up[3] = {0, -1, 0};
    double low[3], high[3];
    fxs_view view;
    fxs_message message;
    for (int k = 0; k < 3; k++) {
        low[k] = (double)header->inner_low_q32[k] / 4294967296.0;
        high[k] = (double)header->inner_high_q32[k] / 4294967296.0;
        high[k] += k == 1 ? 0 : (high[k] - low[k]) * (aside - 1);
    }
    fxs_view_frame_box(&view, low, high, up, &(fxs_picture){50, 1920, 1080}, &message);
    return view;
}

static uint32_t place(const fxs_scene *scene, const fxs_packed_header *header, uint32_t count)
{
    uint32_t side = 1;
    while (side * side < count)
        side++;
    for (uint32_t i = 0; i < count; i++) {
        const int64_t column = i % side, line = i / side;
        fxs_object_init(&objects[i], scene);
        objects[i].id = i;
        objects[i].translation_q32[0] = column * (header->inner_high_q32[0] - header->inner_low_q32[0]);
        objects[i].translation_q32[2] = line * (header->inner_high_q32[2] - header->inner_low_q32[2]);
    }
    object_count = count;
    return side;
}

static void rows_of_scene(char *argument)
{
    char *path = strtok(argument, ":"), *cameras = strtok(NULL, ":"), *times = strchr(path, '@'), label[200];
    char *limit = strchr(path, '%');
    fxs_mapping file;
    fxs_scene scene;
    fxs_message message;
    fxs_view *views = 0;
    fxs_cuda *single = 0, *batch = 0;
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    if (times)
        *times++ = 0;
    if (limit)
        *limit++ = 0;
    budget = limit ? (uint32_t)strtoul(limit, 0, 10) : 0;
    const int count = times ? atoi(times) : 1;
    if (count < 1 || count > OBJECTS || fxs_map_open(&file, path, &message)) {
        puts(count < 1 || count > OBJECTS ? "FILE@N: expected 1 to 400" : message.text);
        return;
    }
    snprintf(label, sizeof label, "%s%s%s", times ? times : limit ? limit : "",
             times ? " objects of " : limit ? " of " : "", name);
    if (fxs_scene_open(&scene, file.data, file.bytes) || fxs_cuda_create(&single, 0, 0, 1, &failure) ||
        fxs_cuda_upload(single, &scene, &failure) || fxs_cuda_create(&batch, 0, 0, SLOTS, &failure) ||
        fxs_cuda_upload(batch, &scene, &failure)) {
        printf("%s: %s\n", path, failure.text);
    } else {
        const uint32_t side = place(&scene, file.data, (uint32_t)count);
        if (!cameras)
            rows_of_view(single, batch, label, overview(file.data, side), 1);
        else if (fxs_camera_file_read(cameras, &views, &message) < 0)
            puts(message.text);
    }
    for (char *n = views ? strtok(NULL, ",") : 0, *first = n; n; n = strtok(NULL, ",")) {
        snprintf(label, sizeof label, "%s view %s", name, n);
        rows_of_view(single, batch, label, views[atoi(n)], n == first);
    }
    free(views);
    fxs_cuda_destroy(single);
    fxs_cuda_destroy(batch);
    fxs_map_close(&file);
}

int main(int argc, char **argv)
{
    const size_t area = EYE_WIDTH * EYE_HEIGHT;
    for (int i = 0; i < BATCH; i++)
        if (!(pixels[i] = peek_device_memory(area * 4)) || !(pinned[i] = peek_pinned_memory(area * 4)) ||
            !(traces[i] = peek_device_memory(area * TRACE)))
            return puts("no CUDA device, or no memory"), 1;
    printf("| scene | visible | entries | project | bin | sort | blend | frame | of %d, each | to the host | MB |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|\n", BATCH);
    for (int i = 1; i < argc; i++)
        rows_of_scene(argv[i]);
    return 0;
}
