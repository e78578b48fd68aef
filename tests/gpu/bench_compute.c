/* Times the compute shaders on a GPU. Prints medians in milliseconds for each shader program and for frames.
 * Arguments:
 *   FILE.fxs                an overview of the scene
 *   FILE.fxs:CAMERAS:N,N    views N of a camera file
 *   WIDTHxHEIGHT            the picture size for later arguments (default 1920x1080)
 * Column `same` tells if the picture equals the processor's. Column `MB` is the device memory in use. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/camera.h>
#include <fixsplat/gl.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/backends.h>
#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/internal/packed.h>
#include "kernels/compute/gl31.h"

#define TIME_ELAPSED 0x88BF        /* constant TIME_ELAPSED_EXT of GL_EXT_disjoint_timer_query */

enum { WARM_UP = 5, REPEATS = 31, SIZE_MOST = 8192 };

static void *egl, *cpu;
static fxs_compute *compute;
static fxs_compute_scene copy;
static fxs_message why;
static unsigned char *pixels[2];
static int width = 1920, height = 1080;

/* ---- A timer query for each program, started by its glUseProgram ------------------------------------------------- */

static PFNGLUSEPROGRAMPROC use_program;
static GLuint queries[FXS_COMPUTE_PROGRAMS];
static int profiled, timed[FXS_COMPUTE_PROGRAMS], running = -1;

static void stop_query(void)
{
    if (running >= 0)
        compute->gl.EndQuery(TIME_ELAPSED);
    running = -1;
}

static void GL_APIENTRY use_and_time(GLuint program)
{
    stop_query();
    use_program(program);
    for (int i = 0; i < FXS_COMPUTE_PROGRAMS && profiled; i++)
        if (compute->programs[i] == program && program) {
            compute->gl.BeginQuery(TIME_ELAPSED, queries[i]);
            timed[i] = 1;
            running = i;
        }
}

static PFNGLCOPYBUFFERSUBDATAPROC copy_buffer;

static void GL_APIENTRY copy_untimed(GLenum from, GLenum to, GLintptr at, GLintptr at_to, GLsizeiptr bytes)
{
    stop_query();
    copy_buffer(from, to, at, at_to, bytes);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values)
{
    qsort(values, REPEATS, sizeof *values, compare_doubles);
    return values[REPEATS / 2];
}

static int frame(const fxs_request *request, void *memory, fxs_stats *stats)
{
    const fxs_compute_scene *copies[1] = {&copy};
    return fxs_compute_render(compute, request, copies, memory, stats, &why);
}

static void row(const char *name, const fxs_scene *scene, const fxs_view *view)
{
    static double times[FXS_COMPUTE_PROGRAMS][REPEATS], whole[REPEATS], clock_times[REPEATS];
    fxs_object object;
    fxs_request request;
    fxs_stats stats;
    fxs_object_init(&object, scene);
    fxs_request_init(&request, &object, 1);
    fxs_camera_from_view(request.cameras, view, &why);
    request.targets->colour = (fxs_image){pixels[1], 4 * width};
    int error = fxs_backend_cpu.render(cpu, &request, 0, &why);
    request.targets->colour.pixels = pixels[0];
    void *memory = malloc(fxs_compute_memory(&request));
    for (int i = -WARM_UP; i < REPEATS && !error; i++) {
        const int at = i < 0 ? 0 : i;
        GLuint nanoseconds = 0;
        profiled = 0;
        compute->timer = 1;
        const uint64_t start = fxs_clock(0);
        error = frame(&request, memory, &stats);
        clock_times[at] = (double)(fxs_clock(0) - start) * 1e-6;
        whole[at] = (double)fxs_compute_info(compute).nanoseconds * 1e-6;
        profiled = 1;
        compute->timer = 0;
        error = error ? error : frame(&request, memory, &stats);
        for (int p = 0; p < FXS_COMPUTE_PROGRAMS; p++)
            if (timed[p]) {
                compute->gl.GetQueryObjectuiv(queries[p], GL_QUERY_RESULT, &nanoseconds);
                times[p][at] = nanoseconds * 1e-6;
            }
    }
    compute->timer = 1;
    free(memory);
    if (error) {
        printf("| %s | %s |\n", name, why.text);
        return;
    }
    printf("| %s | %" PRIu32 " | %" PRIu64, name, stats.visible, stats.entries);
    for (int p = 0; p < FXS_COMPUTE_PROGRAMS; p++)
        printf(" | %.3f", median(times[p]));
    printf(" | %.3f | %.3f | %s | %.1f |\n", median(whole), median(clock_times),
           memcmp(pixels[0], pixels[1], (size_t)(4 * width * height)) ? "NO" : "yes",
           (double)(fxs_compute_taken(compute) - compute->bytes[0][FXS_COMPUTE_DOWNLOAD] + copy.bytes) * 1e-6);
    fflush(stdout);
}

static fxs_view overview(const fxs_packed_header *header)
{
    const double up[3] = {0, -1, 0};
    double low[3], high[3];
    fxs_view view;
    for (int k = 0; k < 3; k++) {
        low[k] = (double)header->inner_low_q32[k] / 4294967296.0;
        high[k] = (double)header->inner_high_q32[k] / 4294967296.0;
    }
    fxs_view_frame_box(&view, low, high, up, &(fxs_picture){50, width, height}, &why);
    return view;
}

static int takes_size(const char *argument)
{
    int w = 0, h = 0, length = 0;
    if (sscanf(argument, "%dx%d%n", &w, &h, &length) < 2 || argument[length] || w < 1 || h < 1 || w > SIZE_MOST ||
        h > SIZE_MOST)
        return 0;
    width = w;
    height = h;
    return 1;
}

static void rows_of_scene(char *argument)
{
    char *path = strtok(argument, ":"), *cameras = strtok(NULL, ":"), label[200];
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    fxs_mapping file;
    fxs_scene scene;
    fxs_view *views = 0, view;
    if (fxs_map_open(&file, path, &why)) {
        puts(why.text);
        return;
    }
    if (fxs_scene_open(&scene, file.data, file.bytes) || fxs_compute_upload(compute, &copy, &scene, &why)) {
        printf("%s: %s\n", path, why.text);
    } else if (!cameras) {
        view = overview(file.data);
        row(name, &scene, &view);
    } else if (fxs_camera_file_read(cameras, &views, &why) < 0) {
        puts(why.text);
    }
    for (char *n = views ? strtok(NULL, ",") : 0; n; n = strtok(NULL, ",")) {
        snprintf(label, sizeof label, "%s view %s", name, n);
        fxs_view_resize(&views[atoi(n)], width, height);
        row(label, &scene, &views[atoi(n)]);
    }
    free(views);
    fxs_compute_drop(compute, &copy);
    fxs_map_close(&file);
}

#define HEAD(entry) " | " #entry

int main(int argc, char **argv)
{
    static const fxs_backend_options options = {.size = sizeof(fxs_backend_options)};
    if (fxs_egl_open(&egl, &why) || fxs_compute_create(&compute, fxs_egl_load, fxs_egl_use, egl, &why) ||
        fxs_backend_cpu.open(&cpu, &options, &why))
        return puts(why.text), 1;
    if (!compute->timer)
        return puts("the device has no timer (EXT_disjoint_timer_query)"), 1;
    use_program = compute->gl.UseProgram;
    copy_buffer = compute->more.CopyBufferSubData;
    compute->gl.UseProgram = use_and_time;
    compute->more.CopyBufferSubData = copy_untimed;
    compute->gl.GenQueries(FXS_COMPUTE_PROGRAMS, queries);
    printf("%s, storage buffers up to %.0f MiB\n", fxs_compute_info(compute).renderer,
           (double)compute->rooms.most / 1048576);
    printf("| scene | visible | entries" FXS_COMPUTE_PROGRAMS_OF(HEAD) " | frame | to the host | same | MB |\n");
    for (int i = 1; i < argc; i++) {
        if (takes_size(argv[i]))
            continue;
        pixels[0] = malloc((size_t)(4 * width * height));
        pixels[1] = malloc((size_t)(4 * width * height));
        rows_of_scene(argv[i]);
        free(pixels[0]);
        free(pixels[1]);
    }
    fxs_compute_destroy(compute);
    fxs_backend_cpu.close(cpu);
    fxs_egl_close(egl);
    return 0;
}
