/* The renderer as a WebAssembly module for fixsplat.js. A function that fails returns a negative FXS_ERR_* or null, and
   leaves a message in `words`. The array `numbers` passes further arguments (In) and results (Out). A frame begins with
   `begin`, `place` for each object, and a camera function for each eye. Then follows `render`, `foresee` or `pick`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/pace.h>
#include <fixsplat/scene.h>
#include <fixsplat/world.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "src/camera/first_view.h"
#include "web.h"

__attribute__((import_module("env"), import_name("tan"))) double fxs_web_tan(double x);

static double numbers[NUMBERS];
static fxs_message message;
static fxs_context context;
static fxs_view view;

static fxs_camera cameras[2];
static uint32_t eyes;
static fxs_object *objects;
static fxs_crop (*crops)[FXS_MAX_CROPS];
static uint32_t object_count;
static int64_t time_q32;           /* the moment of the frame, seconds */
static double low[3], high[3];

/* working memory of a frame; after a trap of WebAssembly, kept until the next frame */
static void *working;

static int said(int error)
{
    if (error < 0)
        strcpy(message.text, fxs_strerror(error));
    return error;
}

EXPORT(start) double *fxs_web_start(uint32_t threads)
{
    static fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    const fxs_config config = {.size = sizeof config, .workers.run = fxs_web_run, .workers.count = threads,
                               .kernels = &fastest};
    fxs_context_init(&context, &config);
    return numbers;
}

EXPORT(words) const char *fxs_web_words(void)
{
    return message.text;
}

fxs_message *fxs_web_message(void)
{
    return &message;
}

double *fxs_web_numbers(void)
{
    return numbers;
}

const fxs_context *fxs_web_context(void)
{
    return &context;
}

const fxs_camera *fxs_web_eye(void)
{
    return cameras;
}

/* Allocates memory aligned to 64 bytes. malloc of this module (web_heap.c) returns such blocks. */
EXPORT(allocate) void *fxs_web_allocate(size_t bytes)
{
    void *block = malloc(bytes);
    if (!block)
        said(FXS_ERR_MEMORY);
    return block;
}

EXPORT(release) void fxs_web_release(void *block)
{
    free(block);
}

/* Calls the browser's tan, since the C library's tan needs a large table of pi. Cameras are rounded to 2^-12, so an
   error of an ulp does not matter. */
double tan(double x)
{
    return fxs_web_tan(x);
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

void fxs_web_describe(fxs_web_scene *s)
{
    fxs_inner_box(s->data, s->low, s->high);
    numbers[0] = s->scene.count;
    numbers[1] = s->scene.sh_degree;
    numbers[2] = s->scene.profile;
    memcpy(numbers + 3, s->low, 2 * sizeof s->low);
    numbers[9] = s->scene.nodes != NULL;
    const fxs_motion_info motion = fxs_scene_motion(&s->scene);
    numbers[10] = (double)motion.duration_q32 * 0x1p-32;
    numbers[11] = (double)motion.rate_q32 * 0x1p-32;
    numbers[12] = motion.loops;
}

/* Checks a whole packed scene and opens the scene. Out: the numbers of fxs_web_describe (number of Gaussians, SH
   degree, profile, box, levels of detail, duration, rate, loops). */
EXPORT(open) fxs_web_scene *fxs_web_open(const char *name, const void *data, size_t bytes)
{
    fxs_web_scene *s = NULL;
    if (fxs_file_check(name, data, bytes, 1, &message) || !(s = fxs_web_allocate(sizeof *s)))
        return NULL;
    memset(s, 0, sizeof *s);
    fxs_scene_open(&s->scene, data, bytes);
    s->data = data;
    fxs_web_describe(s);
    return s;
}

/* ---- Objects ----------------------------------------------------------------------------------------------------- */

static int64_t to_q32(double seconds)
{
    return (int64_t)rint(seconds * 0x1p32);
}

/* Begins a frame of `count` objects at a moment. */
EXPORT(begin) int fxs_web_begin(uint32_t count, double seconds)
{
    free(objects);
    free(crops);
    objects = fxs_allocate(NULL, count, sizeof *objects);
    crops = fxs_allocate(NULL, count, sizeof *crops);
    object_count = eyes = 0;
    time_q32 = to_q32(seconds);
    for (int i = 0; i < 3; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
    }
    return objects && crops ? 0 : said(FXS_ERR_MEMORY);
}

static void grow_box(const fxs_web_scene *l, const fxs_placement *p)
{
    double l_low[3], l_high[3];
    if (!p->visible || !fxs_placement_box(p, l->low, l->high, l_low, l_high))
        return;
    for (int i = 0; i < 3; i++) {
        low[i] = fmin(low[i], l_low[i]);
        high[i] = fmax(high[i], l_high[i]);
    }
}

static uint32_t id_of(double x)
{
    return x >= 0 && x < FXS_NOTHING ? (uint32_t)x : FXS_NOTHING;
}

/* Adds an object (a placed scene) to the frame. In: translation, rotation (w, x, y, z), scale, opacity, tint, visible,
   id, number of crop boxes, time in seconds; then low, high, outside of each crop box. */
EXPORT(place) int fxs_web_place(const fxs_web_scene *l)
{
    fxs_placement p = {0, {numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]},
                       numbers[7], numbers[8], {numbers[9], numbers[10], numbers[11]}, numbers[12] != 0,
                       id_of(numbers[13]), (uint32_t)numbers[14], {{{0}, {0}, 0}}};
    for (uint32_t c = 0; c < p.crop_count && c < FXS_MAX_CROPS; c++) {
        const double *in = numbers + 16 + 7 * c;
        memcpy(p.crops[c].low, in, 6 * sizeof *in);
        p.crops[c].outside = in[6] != 0;
    }
    const int error = fxs_object_place(&objects[object_count], &l->scene, &p, crops[object_count], &message);
    if (error)
        return error;
    objects[object_count++].time_q32 = to_q32(numbers[15]);
    grow_box(l, &p);
    return 0;
}

/* ---- Camera ------------------------------------------------------------------------------------------------------ */

static int take_camera(double near)
{
    view.near = near;
    const int error = fxs_camera_from_view(&cameras[eyes], &view, &message);
    eyes += !error;
    return error;
}

/* Adds a camera with a target to the frame. In: eye, look, up, field of view in degrees, depth of the near plane (0:
   derived from the box of the objects). */
EXPORT(look_at) int fxs_web_look_at(int width, int height)
{
    const double near = numbers[10] != 0 ? numbers[10] : fxs_near_of_box(low, high);
    const int error = fxs_view_look_at(&view, numbers, numbers + 3, numbers + 6, &(fxs_picture){numbers[9], width,
                                                                                                height}, &message);
    return error ? error : take_camera(near);
}

/* Adds a camera that shows all objects. In: up, field of view in degrees, depth of the near plane (0: chosen). */
EXPORT(see_all) int fxs_web_see_all(int width, int height)
{
    const int error = fxs_view_frame_box(&view, low, high, numbers, &(fxs_picture){numbers[3], width, height},
                                         &message);
    return error ? error : take_camera(numbers[4] != 0 ? numbers[4] : view.near);
}

/* Finds the up direction of the first visible object whose file states an up direction. Returns 0 if no file does. */
static int find_up(double up[3])
{
    for (uint32_t i = 0; i < object_count; i++) {
        const int32_t *r = objects[i].rotation_q30;
        fxs_start start;
        fxs_start_of(&start, ((const fxs_web_scene *)(const void *)objects[i].scene)->data);
        const double *u = start.up;
        for (int k = 0; k < 3; k++, r += 3)
            up[k] = (r[0] * u[0] + r[1] * u[1] + r[2] * u[2]) * 0x1p-30;
        if (objects[i].visible && (u[0] != 0 || u[1] != 0 || u[2] != 0))
            return 1;
    }
    return 0;
}

/* Chooses the first view of the objects. Out: the 13 numbers of fxs_first_choice (the chosen up, direction, distance
   and box), then 1 if a file states the up direction. */
EXPORT(choose) int fxs_web_choose(void)
{
    double up[3];
    const int is_up = find_up(up);
    fxs_first_choice first;
    fxs_object *seen = fxs_allocate(NULL, object_count, sizeof *seen);
    if (!seen)
        return said(FXS_ERR_MEMORY);
    for (uint32_t i = 0; i < object_count; i++) {
        seen[i] = objects[i];
        if (seen[i].scene->places)
            seen[i].scene = &((const fxs_web_scene *)(const void *)seen[i].scene)->coarse;
    }
    const int error = fxs_first_view_choose(&first, &context, seen, object_count, low, high, is_up ? up : NULL,
                                            &message);
    free(seen);
    if (error)
        return error;
    memcpy(numbers, &first, sizeof first);
    numbers[sizeof first / sizeof *numbers] = is_up;
    return 0;
}

/* Adds the camera of a chosen first view. In: an fxs_first_choice, field of view in degrees, depth of the near plane
   (0: chosen). */
EXPORT(see_first) int fxs_web_see_first(int width, int height)
{
    fxs_first_choice first;
    const double *behind = numbers + sizeof first / sizeof *numbers;
    memcpy(&first, numbers, sizeof first);
    const int error = fxs_first_view_make(&first, behind[0], width, height, &view, &message);
    return error ? error : take_camera(behind[1] != 0 ? behind[1] : view.near);
}

/* Finds the start view that a scene's file states, for a picture of 2 x 2 pixels. Returns 1, or 0 without a start view.
   Out: focal length fy, position, rotation (world to camera, in rows), tangent of fxs_start_reach. */
EXPORT(start_view) int fxs_web_start_view(const fxs_web_scene *l)
{
    if (!fxs_view_of_start(&view, l->data, 16, 9))
        return 0;
    numbers[0] = view.fy * 2 / 9;
    memcpy(numbers + 1, view.position, sizeof view.position);
    memcpy(numbers + 4, view.rotation, sizeof view.rotation);
    numbers[13] = fxs_start_reach(&view, l->data);
    return 1;
}

/* Adds the camera of a scene's start view; the scene must be the only object. `near` is the depth of the near plane; 0:
   chosen. Returns 0 without a start view. */
EXPORT(see_start) int fxs_web_see_start(const fxs_web_scene *l, double near, int width, int height)
{
    if (!fxs_view_of_start(&view, l->data, width, height))
        return 0;
    const int error = take_camera(near != 0 ? near : fxs_near_of_box(low, high));
    return error ? error : 1;
}

/* Writes the middle of the box around all objects to `numbers`. */
EXPORT(middle) void fxs_web_middle(void)
{
    for (int i = 0; i < 3; i++)
        numbers[i] = (low[i] + high[i]) / 2;
}

/* Adds a pinhole camera for a picture of `width` x `height` pixels, resized to `new_width` x `new_height` pixels. In:
   fx, fy, cx, cy, rotation (world to camera, in rows), position, depth of the near plane. */
EXPORT(camera) int fxs_web_camera(int width, int height, int new_width, int new_height, int projection)
{
    strcpy(view.name, "camera");
    view.width = width;
    view.height = height;
    memcpy(&view.fx, numbers, 17 * sizeof *numbers);
    view.projection = (enum fxs_projection)projection;
    if (new_width != width || new_height != height)
        fxs_view_resize(&view, new_width, new_height);
    return take_camera(view.near);
}

/* Crops the picture of the last camera to `height` rows, from the row `first`. */
EXPORT(crop) void fxs_web_crop(int first, int height)
{
    fxs_camera *camera = &cameras[eyes - 1];
    camera->whole_width = camera->width;
    camera->whole_height = camera->height;
    camera->whole_y = first;
    camera->cy_q12 -= first * 4096;
    camera->height = height;
}

/* ---- Frame ------------------------------------------------------------------------------------------------------- */

static void free_working(void)
{
    free(working);
    working = NULL;
}

static void *frame_memory(const fxs_request *request, size_t *bytes, size_t limit)
{
    *bytes = fxs_request_bytes(&context, request, NULL);
    if (limit && limit < *bytes)
        *bytes = limit;
    free_working();
    return working = fxs_web_allocate(*bytes);
}

static void begin_turn(void)
{
    for (uint32_t i = 0; i < object_count; i++)
        if (objects[i].scene->places) {
            fxs_web_scene *s = (fxs_web_scene *)(uintptr_t)objects[i].scene;
            s->turn++;
            s->wanted_count = 0;
        }
}

void fxs_web_request(fxs_request *r, uint32_t background, int sh_degree, int square, uint32_t budget,
                     uint32_t detail_q8)
{
    fxs_request_init(r, objects, object_count);
    r->eyes = eyes;
    memcpy(r->cameras, cameras, sizeof cameras);
    for (int c = 0; c < 3; c++)
        r->options.background[c] = (uint8_t)(background >> (16 - 8 * c));
    r->options.sh_degree = sh_degree;
    r->options.cutoff = square ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
    r->options.budget = budget;
    r->options.detail_q8 = detail_q8;
    r->options.time_q32 = time_q32;
    r->options.want.call = fxs_web_want;
    begin_turn();
}

void *fxs_web_take_crops(void)
{
    void *taken = crops;
    crops = NULL;
    return taken;
}

int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, uint32_t budget,
                        uint32_t detail_q8, size_t limit)
{
    frame->context = &context;
    frame->stats = (fxs_stats){0};
    fxs_web_request(&frame->request, background, sh_degree, square, budget, detail_q8);
    frame->memory = frame_memory(&frame->request, &frame->bytes, limit);
    return frame->memory ? 0 : FXS_ERR_MEMORY;
}

int fxs_web_frame_end(const fxs_web_frame *frame, int error)
{
    free_working();
    numbers[0] = frame->stats.drawn;
    numbers[1] = frame->stats.missing;
    return said(error);
}

static fxs_image image_at(double at, ptrdiff_t bytes)
{
    return (fxs_image){(void *)(uintptr_t)at, bytes * cameras->width};
}

/* Sets the targets (pictures to write) of an eye. In: addresses of colour, coverage, mean and median depth, ids, and of
   the inputs occluder and backdrop; 0: none. */
static void take_targets(fxs_targets *t, const double *at, int format, int depth_bits)
{
    static const uint8_t bytes[] = {4, 4, 2, 8};   /* bytes a pixel in each colour format */
    fxs_targets_init(t);
    t->format = (enum fxs_format)format;
    t->depth_bits = depth_bits;
    t->colour = image_at(at[0], bytes[format]);
    t->coverage = image_at(at[1], 1);
    t->mean_depth = image_at(at[2], 4);
    t->median_depth = image_at(at[3], 4);
    t->id = image_at(at[4], 8);
    t->occluder = image_at(at[5], 4);
    t->backdrop = image_at(at[6], 4);
}

/* Draws the objects. In: the 7 addresses of take_targets (pictures) for each eye. Out: number of drawn Gaussians,
   number of missing chunks. */
EXPORT(render) int fxs_web_render(int format, int depth_bits, uint32_t background, int sh_degree, int square,
                                  uint32_t budget, uint32_t detail_q8, size_t limit)
{
    fxs_web_frame f;
    if (fxs_web_frame_begin(&f, background, sh_degree, square, budget, detail_q8, limit))
        return FXS_ERR_MEMORY;
    for (uint32_t eye = 0; eye < eyes; eye++)
        take_targets(&f.request.targets[eye], numbers + 7 * eye, format, depth_bits);
    return fxs_web_frame_end(&f, fxs_render(&context, &f.request, f.memory, f.bytes, &f.stats));
}

EXPORT(foresee) int fxs_web_foresee(uint32_t budget, uint32_t detail_q8, size_t limit)
{
    fxs_web_frame f;
    if (fxs_web_frame_begin(&f, 0, 3, 0, budget, detail_q8, limit))
        return FXS_ERR_MEMORY;
    return fxs_web_frame_end(&f, fxs_foresee(&context, &f.request, f.memory, f.bytes));
}

/* Finds the Gaussian with the largest contribution to a pixel. Returns 1, or 0 without one. Out: index of the object,
   index of the Gaussian, depth, position. */
EXPORT(pick) int fxs_web_pick(int x, int y, uint32_t budget, uint32_t detail_q8, size_t limit)
{
    fxs_web_frame f;
    fxs_pick_result result = {0};
    if (fxs_web_frame_begin(&f, 0, 3, 0, budget, detail_q8, limit))
        return FXS_ERR_MEMORY;
    const int found = fxs_web_frame_end(&f, fxs_pick(&context, &f.request, x, y, f.memory, f.bytes, &result));
    numbers[0] = result.object;
    numbers[1] = result.gaussian;
    numbers[2] = (double)result.depth_q32 * 0x1p-32;
    for (int i = 0; i < 3; i++)
        numbers[3 + i] = (double)result.position_q32[i] * 0x1p-32;
    return found;
}

/* ---- Clock ------------------------------------------------------------------------------------------------------- */

/* Begins a clock anew, or makes one if `pace` is null, for a picture's size alone. Returns null without memory. */
EXPORT(pace) fxs_pace *fxs_web_pace(fxs_pace *pace, uint32_t frame_nanoseconds, uint32_t least_q16, uint32_t scale_q16)
{
    if (!pace && !(pace = fxs_web_allocate(sizeof *pace)))
        return NULL;
    fxs_pace_init(pace);
    pace->frame_nanoseconds = frame_nanoseconds;
    pace->scale_least_q16 = least_q16;
    pace->scale_q16 = scale_q16;
    return pace;
}

/* Hands in the time of a picture of the chosen size. Out: the scale of the next picture (Q16), the reason. */
EXPORT(pace_step) int fxs_web_pace_step(fxs_pace *pace, double nanoseconds)
{
    const int result = fxs_pace_step(pace, (uint64_t)nanoseconds, 0, pace->number);
    numbers[0] = pace->scale_q16;
    numbers[1] = pace->reason;
    return said(result);
}
