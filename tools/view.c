/* The camera and rendering options that render, view and bench share, and the renderer they set up. */
#include <stdlib.h>
#include <string.h>

#include "../port/posix/clock.h"
#include "command.h"
#ifdef FXS_WITH_KERNELS
#include "../kernels/kernels.h"
#endif

const char view_options_help[] =
    "Camera (without one, the scene is framed whole):\n"
    "  --cameras FILE      cameras.json, transforms.json or a COLMAP model (folder, images.bin or images.txt)\n"
    "  --view N|NAME|all   a view of that file: its number from 0, its image name, or all (default 0)\n"
    "  --eye X,Y,Z         camera centre\n"
    "  --look X,Y,Z        point looked at (default: the middle of the scene)\n"
    "  --up X,Y,Z          up in the picture (default 0,-1,0: y points down; 0,0,1 for scenes with z up)\n"
    "  --fov DEG           vertical field of view, 1 to 170 (default 50)\n"
    "  --near DEPTH        near plane: only what lies beyond is drawn, scene units, 2^-20 to 2^28 (default: 0.2 for\n"
    "                      views of a file in render, bench and info; else 1/100 of the scene's radius, at most 0.2)\n"
    "  --size WxH          pixels (default: the view's own size, else 1280x720)\n"
    "  --stereo DISTANCE   two pictures side by side, of eyes so far apart (scene units, above 0) about the camera;\n"
    "                      order and colours are found once for both\n"
    "  --stereo-exact      each eye as its camera alone would be rendered\n"
    "Rendering:\n"
    "  --bg RRGGBB         background (default 000000)\n"
    "  --cutoff NAME       mahalanobis (default) or square\n"
    "  --sh-degree D       highest SH degree used, 0 to 3 (default 3)\n"
    "  --threads N         threads, 1 to 64 (default: one a processor); the picture does not depend on it\n"
    "  --max-memory BYTES  working memory of a frame, also as 64K, 3M, 2G: rendered in bands where it does not hold\n"
    "                      every Gaussian; the picture does not depend on it. With --backend cuda: device memory,\n"
    "                      scene included\n"
    "  --cpu LIST          instruction sets that may be used: all (default), c for none, or names out of\n"
    "                      sse41,avx2,avx512,neon\n"
    "  --backend NAME      what renders: cpu; gles (OpenGL ES 3.0 by EGL) or osmesa in place of blend and resolve; cuda:\n"
    "                      the same bytes. gles-quads: inexact, blended by the device. auto (default): cpu. See\n"
    "                      fixsplat info --backends\n"
    "  --device LIST       GPUs of --backend cuda: numbers from 0 on with commas, or all (default 0); render --view all\n"
    "                      shares the views out among them, other commands take the first\n"
    "  --lod LEVEL         level of detail of a streamed .sog, 0 the finest (default 0)\n"
    "  --profile P         how a scene that is not an .fxs file is packed: default, compact or small\n"
    IMPORT_HELP
    "  --help              this text\n";

void view_options_default(view_options *options)
{
    memset(options, 0, sizeof *options);
    fxs_options_init(&options->render);
    options->up[1] = -1;
    options->fov = 50;
    options->cpu = "all";
    options->backend = "auto";
    options->threads = fxs_processors();
    options->device_count = 1;
}

static int take_number(const char *name, const char *value, uint64_t low, uint64_t high, uint64_t *out)
{
    if (parse_count(value, low, high, out))
        return 0;
    return fail(EXIT_USAGE, "--%s %s: expected a whole number from %llu to %llu", name, value, (unsigned long long)low,
                (unsigned long long)high);
}

static int take_vector(const char *name, const char *value, double out[3], int *has)
{
    *has = parse_vector(value, 3, out);
    return *has ? 0 : fail(EXIT_USAGE, "--%s %s: expected three numbers X,Y,Z", name, value);
}

static int take_devices(view_options *options, const char *value)
{
    const char *at = value;
    options->device_count = 0;
    while (strcmp(value, "all")) {
        char *end;
        const long number = strtol(at, &end, 10);
        if (*at < '0' || *at > '9' || number > 255 || options->device_count == DEVICES_MOST || (*end && *end != ','))
            return fail(EXIT_USAGE, "--device %s: expected all, or up to %d numbers from 0 to 255 with commas", value,
                        DEVICES_MOST);
        options->devices[options->device_count++] = (int)number;
        if (!*end)
            break;
        at = end + 1;
    }
    return 0;
}

static int take_cutoff(fxs_options *options, const char *value)
{
    if (!strcmp(value, "mahalanobis"))
        options->cutoff = FXS_CUTOFF_MAHALANOBIS;
    else if (!strcmp(value, "square"))
        options->cutoff = FXS_CUTOFF_SQUARE;
    else
        return fail(EXIT_USAGE, "--cutoff %s: expected mahalanobis or square", value);
    return 0;
}

static int take_fov(double *fov, const char *value)
{
    char *end;
    *fov = strtod(value, &end);
    return end != value && !*end && *fov >= 1 && *fov <= 170
               ? 0 : fail(EXIT_USAGE, "--fov %s: expected 1 to 170 degrees", value);
}

static int take_near(double *near, const char *value)
{
    return parse_vector(value, 1, near) && *near >= 0x1p-20 && *near <= 0x1p28
               ? 0 : fail(EXIT_USAGE, "--near %s: expected a depth from 2^-20 to 2^28", value);
}

static int take_stereo(double *distance, const char *value)
{
    return parse_vector(value, 1, distance) && *distance > 0
               ? 0 : fail(EXIT_USAGE, "--stereo %s: expected a distance above 0", value);
}

int view_option(view_options *options, int which, const char *value)
{
    uint64_t number = 0;
    int status = 0;
    switch (which) {
    case OPT_CAMERAS: options->cameras = value; break;
    case OPT_VIEW: options->view = value; break;
    case OPT_EYE: return take_vector("eye", value, options->eye, &options->has_eye);
    case OPT_LOOK: return take_vector("look", value, options->look, &options->has_look);
    case OPT_UP: return take_vector("up", value, options->up, &options->has_up);
    case OPT_FOV: return take_fov(&options->fov, value);
    case OPT_NEAR: return take_near(&options->near, value);
    case OPT_SIZE:
        return parse_size(value, &options->width, &options->height)
                   ? 0 : fail(EXIT_USAGE, "--size %s: expected WxH, each 1 to %d", value, FXS_MAX_SIZE);
    case OPT_STEREO: return take_stereo(&options->stereo, value);
    case OPT_STEREO_EXACT: options->stereo_exact = 1; break;
    case OPT_BG:
        return parse_colour(value, options->render.background)
                   ? 0 : fail(EXIT_USAGE, "--bg %s: expected six hex digits RRGGBB", value);
    case OPT_CUTOFF: return take_cutoff(&options->render, value);
    case OPT_SH_DEGREE:
        status = take_number("sh-degree", value, 0, 3, &number);
        options->render.sh_degree = (int)number;
        return status;
    case OPT_CPU: options->cpu = value; break;
    case OPT_BACKEND: options->backend = value; break;
    case OPT_DEVICE: return take_devices(options, value);
    case OPT_LOD: return take_lod(&options->load, value);
    case OPT_AXES:
    case OPT_MAX_GAUSSIANS:
    case OPT_IMPORT_MEMORY: return take_import_option(&options->load, which, value);
    case OPT_PROFILE: return take_profile(&options->load, value);
    case OPT_MAX_MEMORY: return take_max_memory(&options->max_memory, value);
    case OPT_THREADS:
        status = take_number("threads", value, 1, 64, &number);
        options->threads = options->load.threads = (uint32_t)number;
        return status;
    default: return EXIT_USAGE;
    }
    return 0;
}

int view_options_check(const view_options *options)
{
    if (options->view && !options->cameras)
        return fail(EXIT_USAGE, "--view needs --cameras");
    if (options->cameras && (options->has_eye || options->has_look))
        return fail(EXIT_USAGE, "--cameras and --eye or --look: give one camera");
    if (options->stereo_exact && options->stereo <= 0)
        return fail(EXIT_USAGE, "--stereo-exact needs --stereo");
    if (options->has_look && !options->has_eye)
        return fail(EXIT_USAGE, "--look needs --eye");
    return 0;
}

long find_view(const view_options *options, const fxs_file_view *views, long count)
{
    const char *wanted = options->view ? options->view : "0";
    uint64_t number;
    for (long i = 0; i < count; i++)
        if (!strcmp(views[i].name, wanted))
            return i;
    if (parse_count(wanted, 0, (uint64_t)count - 1, &number))
        return (long)number;
    return fail(-1, "%s: no view '%s' (there are %ld, from 0 on)", options->cameras, wanted, count);
}

static long views_of_file(const view_options *options, fxs_file_view **views)
{
    fxs_message message;
    long count = fxs_camera_file_read(options->cameras, views, &message);
    if (count < 0)
        return fail(-1, "%s", message.text);
    if (!options->view || strcmp(options->view, "all")) {
        long index = find_view(options, *views, count);
        if (index < 0) {
            free(*views);
            *views = 0;
            return -1;
        }
        (*views)[0] = (*views)[index];
        count = 1;
    }
    for (long i = 0; i < count; i++) {
        fxs_camera camera;
        if (options->width)
            fxs_view_resize(&(*views)[i], options->width, options->height);
        (*views)[i].near = options->near;
        if (fxs_camera_from_view(&camera, &(*views)[i], &message)) {
            free(*views);
            *views = 0;
            return fail(-1, "%s: %s", options->cameras, message.text);
        }
    }
    return count;
}

long choose_views(const view_options *options, const fxs_pack_report *report, fxs_file_view **views)
{
    fxs_message message;
    int width = options->width ? options->width : 1280, height = options->height ? options->height : 720, result;
    if (options->cameras)
        return views_of_file(options, views);
    *views = malloc(sizeof **views);
    if (!*views)
        return fail(-1, "out of memory");
    if (options->has_eye) {
        double middle[3];
        for (int i = 0; i < 3; i++)
            middle[i] = (report->inner_low[i] + report->inner_high[i]) / 2;
        result = fxs_view_look_at(*views, options->eye, options->has_look ? options->look : middle, options->up,
                                  options->fov, width, height, &message);
    } else {
        result = fxs_view_frame_box(*views, report->inner_low, report->inner_high, options->up, options->fov, width,
                                    height, &message);
    }
    (*views)->near = options->near > 0 ? options->near : fxs_near_of_box(report->inner_low, report->inner_high);
    if (!result)
        return 1;
    free(*views);
    *views = 0;
    return fail(-1, "%s", message.text);
}

#ifdef FXS_WITH_KERNELS
/* The flag of a name in a list, up to its comma; 0 for "c", ~0 for "all"; -1 for anything else. */
static long cpu_flag(const char *name, size_t length)
{
    if (length == 1 && *name == 'c')
        return 0;
    if (length == 3 && !strncmp(name, "all", 3))
        return 0xffff;
    for (unsigned flag = 1; fxs_cpu_name(flag); flag *= 2)
        if (strlen(fxs_cpu_name(flag)) == length && !strncmp(name, fxs_cpu_name(flag), length))
            return (long)flag;
    return -1;
}

static int choose_cpu(fxs_context *context, const char *list)
{
    unsigned allowed = 0;
    for (const char *name = list;;) {
        size_t length = strcspn(name, ",");
        long flag = cpu_flag(name, length);
        if (flag < 0)
            return fail(EXIT_USAGE, "--cpu %s: expected all, c, or names out of sse41, avx2, avx512, neon", list);
        if (flag != 0xffff && ((unsigned)flag & ~fxs_cpu_detect()))
            return fail(EXIT_USAGE, "--cpu %s: this processor has no %.*s", list, (int)length, name);
        allowed |= (unsigned)flag;
        if (!name[length])
            break;
        name += length + 1;
    }
    fxs_kernels_choose(&context->kernels, allowed);
    return 0;
}
#else
static int choose_cpu(fxs_context *context, const char *list)
{
    (void)context;
    if (!strcmp(list, "all") || !strcmp(list, "c"))
        return 0;
    return fail(EXIT_USAGE, "--cpu %s: this build has the plain C versions only; expected all or c", list);
}
#endif

int renderer_init(renderer *r, const view_options *options)
{
    memset(r, 0, sizeof *r);
    fxs_message message;
    const int cuda = !strcmp(options->backend, "cuda");
    if (!cuda && !backend_known(options->backend))
        return fail(EXIT_USAGE, "--backend %s: expected cpu, auto, cuda, gles, gles-quads or osmesa", options->backend);
    if (cuda && options->stereo > 0 && !options->stereo_exact)
        return fail(EXIT_USAGE, "--backend cuda: --stereo needs --stereo-exact");
    r->max_memory = options->max_memory;
    r->stereo = options->stereo;
    r->stereo_exact = options->stereo_exact;
    r->format = options->format;
    fxs_config config = {.threads = options->threads, .clock = fxs_clock};
    if (!cuda && backend_open(&r->backend, options->backend, &config, &message))
        return fail(EXIT_FAILED, "--backend %s: %s", options->backend, message.text);
    if (options->threads > 1) {
        r->pool = fxs_pool_create(options->threads);
        if (!r->pool)
            return fail(EXIT_FAILED, "cannot start %u threads", options->threads);
        config.run = fxs_pool_run;
        config.pool = r->pool;
    }
    fxs_init(&r->context, &config);
    int status = choose_cpu(&r->context, options->cpu);
    if (r->backend)
        r->context.kernels.name[FXS_BLEND] = r->context.kernels.name[FXS_RESOLVE] = options->backend;
    int devices[DEVICES_MOST];
    cuda_devices(options, devices);
    return status || !cuda ? status : cuda_open(r, devices[0]);
}

void renderer_free(renderer *r)
{
    backend_close(r->backend);
    cuda_close(r);
    fxs_pool_destroy(r->pool);
    free(r->allocation);
    free(r->pixels);
}

static int make_room(renderer *r, const fxs_object *object, int width, int height)
{
    size_t bytes = r->stereo > 0 ? fxs_stereo_bytes(&r->context, object, 1, width, height)
                                 : fxs_frame_bytes(&r->context, object, 1, width, height, 0);
    bytes = !r->cuda && r->max_memory && r->max_memory < bytes ? r->max_memory : bytes;
    r->width = r->stereo > 0 ? 2 * width : width;
    r->height = height;
    const size_t pixel_bytes = (size_t)r->width * (size_t)height * 4;
    if (bytes > r->memory_bytes) {
        free(r->allocation);
        r->allocation = malloc(bytes + 63);
        r->memory = (void *)(((uintptr_t)r->allocation + 63) / 64 * 64);
        r->memory_bytes = r->allocation ? bytes : 0;
    }
    if (pixel_bytes > r->pixel_bytes) {
        free(r->pixels);
        r->pixels = malloc(pixel_bytes);
        r->pixel_bytes = r->pixels ? pixel_bytes : 0;
    }
    return r->allocation && r->pixels
               ? 0 : fail(EXIT_FAILED, "out of memory: a frame of %dx%d needs %zu bytes", width, height, bytes);
}

/* The view from `offset` units to the right of its centre. */
static int camera_beside(fxs_camera *camera, const fxs_file_view *view, double offset)
{
    fxs_message message;
    fxs_file_view beside = *view;
    for (int i = 0; i < 3; i++)
        beside.position[i] += offset * view->rotation[i];
    return fxs_camera_from_view(camera, &beside, &message) ? fail(EXIT_FAILED, "%s", message.text) : 0;
}

static int draw(renderer *r, const loaded_scene *loaded, const fxs_file_view *view, const fxs_options *options,
                fxs_stats *stats)
{
    fxs_camera cameras[2];
    fxs_object object;
    fxs_object_init(&object, &loaded->scene);
    if (camera_beside(&cameras[0], view, -r->stereo / 2) || camera_beside(&cameras[1], view, r->stereo / 2) ||
        make_room(r, &object, view->width, view->height))
        return EXIT_FAILED;
    ptrdiff_t stride = (ptrdiff_t)r->width * 4;
    fxs_targets eyes[2];
    fxs_targets_init(&eyes[0]);
    eyes[0].format = r->format;
    eyes[1] = eyes[0];
    eyes[0].colour = (fxs_image){r->pixels, stride};
    eyes[1].colour = (fxs_image){r->pixels + stride / 2, stride};
    if (r->cuda)
        return cuda_render(r, loaded, &cameras[0], options, eyes[0].colour.pixels, stride, stats) ||
               (r->stereo > 0 && cuda_render(r, loaded, &cameras[1], options, eyes[1].colour.pixels, stride, stats)) ? EXIT_FAILED : 0;
    int error = r->stereo > 0 ? fxs_render_stereo(&r->context, &object, 1, cameras, options, eyes, r->stereo_exact,
                                                  r->memory, r->memory_bytes, stats)
                              : fxs_render(&r->context, &object, 1, cameras, options, eyes, r->memory,
                                           r->memory_bytes, stats);
    if (error == FXS_ERR_MEMORY && stats->memory.least > r->memory_bytes)
        return fail(EXIT_FAILED, "view %s: a frame of %dx%d does not fit in --max-memory %zu: it needs at least %zu "
                    "bytes", view->name, view->width, view->height, r->max_memory, stats->memory.least);
    return error ? fail(EXIT_FAILED, "view %s: %s", view->name, fxs_strerror(error)) : 0;
}

int renderer_render(renderer *r, const loaded_scene *loaded, const fxs_file_view *view, const fxs_options *options,
                    fxs_stats *stats)
{
    const int status = draw(r, loaded, view, options, stats);
    return status ? status : check_scene(loaded);
}
