/* Renders frames of several objects into every target, by the library's renderer and by the reference renderer. */
#ifndef WORLD_H
#define WORLD_H

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/camera.h>
#include "tools/command/metrics.h"
#include "in_doubles.h"
#include "one_scene.h"
#include "procedural_scene.h"

enum { WORLD_OBJECTS = 128, WORLD_GUARD = 0xa5 };

/* A scene in two forms: packed for the renderer, and as unpacked Gaussians for the reference renderer. */
typedef struct part {
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_scene scene;
    fxs_gaussian *gaussians;
    size_t count;
} part;

static inline void part_free(part *p)
{
    fxs_packed_scene_free(&p->packed);
    free(p->gaussians);
    p->gaussians = 0;
}

static inline int part_make(part *p, const char *name, uint64_t count)
{
    fxs_message m = {.text = ""};
    const fxs_procedural_scene *scene = fxs_procedural_find(name);
    memset(p, 0, sizeof *p);
    if (!CHECK(scene && !procedural_scene_make(name, count, 0, &p->packed, &p->report, &m) &&
               !fxs_scene_open(&p->scene, p->packed.data, p->packed.bytes)))
        return 0;
    p->gaussians = malloc(count * sizeof *p->gaussians);
    for (p->count = 0; p->count < count; p->count++)
        scene->gaussian(p->count, count, 1, &p->gaussians[p->count]);
    return 1;
}

static inline int part_load(part *p, const char *name)
{
    char path[512];
    fxs_message m;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const char *folder = getenv("FXS_SCENES");
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/scenes", name);
    memset(p, 0, sizeof *p);
    if (access(path, R_OK) || !CHECK(!fxs_scene_file_open(path, 0, &file, &info, &m)))
        return 0;
    int error = fxs_pack(file, &info, &p->packed, &p->report, 0, &m) || fxs_scene_file_rewind(file, &m);
    p->gaussians = malloc(info.count * sizeof *p->gaussians);
    for (long n = 1; !error && n > 0; p->count += (size_t)n) {
        n = fxs_scene_file_read(file, p->gaussians + p->count, info.count - p->count, &m);
        error = n < 0;
    }
    fxs_scene_file_close(file);
    return CHECK(!error && !fxs_scene_open(&p->scene, p->packed.data, p->packed.bytes));
}

static inline void part_unpack(part *p)
{
    free(p->gaussians);
    p->count = p->scene.count;
    p->gaussians = malloc(p->count * sizeof *p->gaussians);
    for (size_t i = 0; i < p->count; i++)
        p->gaussians[i] = decode(&p->scene, (uint32_t)i);
}

typedef struct world {
    const part *parts[WORLD_OBJECTS];
    fxs_object objects[WORLD_OBJECTS];
    uint32_t count;
} world;

static inline fxs_object *world_add(world *w, const part *p)
{
    fxs_object *object = &w->objects[w->count];
    w->parts[w->count] = p;
    fxs_object_init(object, &p->scene);
    object->id = 1000 + w->count++;
    return object;
}

static inline void object_place(fxs_object *object, const double axis[3], double angle, double scale,
                                const double translation[3])
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]), s = sin(angle / 2) / length;
    const double w = cos(angle / 2), x = axis[0] * s, y = axis[1] * s, z = axis[2] * s;
    const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        object->rotation_q30[i] = (int32_t)lrint(ldexp(m[i], 30));
    for (int i = 0; i < 3; i++)
        object->translation_q32[i] = (int64_t)ldexp(translation[i], 32);
    object->scale_q32 = (int64_t)ldexp(scale, 32);
}

typedef struct picture {
    int width, height;
    size_t bytes;
    unsigned char *block;
    fxs_targets targets;
} picture;

/* Leaves out the images beside the colour whose bits of `without` are set; bit 5: all. */
static inline void leave_out(fxs_targets *t, unsigned without)
{
    fxs_image *const images[] = {&t->coverage, &t->mean_depth, &t->median_depth, &t->id};
    for (int k = 0; k < 4; k++)
        if (without >> k & 1 || without >> 5 & 1)
            images[k]->pixels = 0;
}

static inline void picture_clear(picture *p)
{
    memset(p->block, WORLD_GUARD, p->bytes);
}

static inline picture picture_new(int width, int height, enum fxs_format format)
{
    picture p = {.width = width, .height = height};
    fxs_targets *t = &p.targets;
    fxs_targets_init(t);
    t->format = format;
    fxs_image *const images[] = {&t->colour, &t->coverage, &t->mean_depth, &t->median_depth, &t->id};
    const int pixel_bytes[] = {fxs_pixel_bytes(format), 1, 4, 4, 8};
    size_t starts[5];
    for (int i = 0; i < 5; i++) {
        images[i]->stride = (ptrdiff_t)width * pixel_bytes[i];
        starts[i] = p.bytes;
        p.bytes += ((size_t)images[i]->stride * (size_t)height + 63) / 64 * 64;
    }
    p.block = check_aligned(p.bytes);
    for (int i = 0; i < 5; i++)
        images[i]->pixels = p.block + starts[i];
    picture_clear(&p);
    return p;
}

static inline void picture_free(picture *p)
{
    free(p->block);
}

static inline const uint8_t *picture_rgba(const picture *p)
{
    return p->targets.colour.pixels;
}

static inline uint32_t picture_mean(const picture *p, int i)
{
    return ((const uint32_t *)p->targets.mean_depth.pixels)[i];
}

static inline uint32_t picture_median(const picture *p, int i)
{
    return ((const uint32_t *)p->targets.median_depth.pixels)[i];
}

static inline fxs_id picture_id(const picture *p, int i)
{
    return ((const fxs_id *)p->targets.id.pixels)[i];
}

/* Renders a frame with enough memory for the whole picture at once. Checks that a guard behind the memory is
   unchanged. */
static inline int world_render(const fxs_context *context, const world *w, const fxs_camera *camera,
                               const fxs_options *options, const fxs_targets *targets, fxs_stats *stats)
{
    const size_t bytes = fxs_frame_bytes(context, w->objects, w->count, camera->width, camera->height, 0);
    unsigned char *memory = check_aligned(bytes + 64);
    memset(memory, WORLD_GUARD, bytes + 64);
    const int error = render_frame(context, w->objects, w->count, camera, options, targets, memory, bytes, stats);
    for (int i = 0; i < 64; i++)
        CHECK(memory[bytes + (size_t)i] == WORLD_GUARD);
    free(memory);
    return error;
}

static inline int in_crop(const fxs_crop *crop, const float position[3])
{
    int inside = 1;
    for (int i = 0; i < 3; i++)
        inside &= position[i] >= ldexp((double)crop->low_q32[i], -32) &&
                  position[i] <= ldexp((double)crop->high_q32[i], -32);
    return inside;
}

static inline int is_kept(const fxs_object *object, const float position[3])
{
    int kept = 1, keeps = 0, left_out = !object->visible || !object->opacity_q16;
    for (uint32_t i = 0; i < object->crop_count; i++) {
        const int inside = in_crop(&object->crops[i], position);
        left_out |= object->crops[i].outside && inside;
        kept = object->crops[i].outside ? kept : (keeps++ ? kept : 0) | inside;
    }
    return kept && !left_out;
}

typedef struct reference_world {
    struct reference_splat *splats;
    fxs_id *ids;
    size_t count;
    struct reference_trace trace;
    double *rgb;
} reference_world;

static inline reference_world world_reference(const world *w, const fxs_camera *camera, const fxs_options *options,
                                              const double *occluder)
{
    const fxs_view view = view_of(camera);
    reference_world r = {0};
    size_t most = 1;
    for (uint32_t k = 0; k < w->count; k++)
        most += w->parts[k]->count;
    r.splats = malloc(most * sizeof *r.splats);
    r.ids = malloc(most * sizeof *r.ids);
    r.rgb = malloc((size_t)view.width * (size_t)view.height * 3 * sizeof *r.rgb);
    struct reference_options o = {.sh_degree = options->sh_degree};
    for (int c = 0; c < 3; c++)
        o.background[c] = options->background[c] / 255.0;
    for (uint32_t k = 0; k < w->count; k++) {
        const struct reference_object object = object_in_doubles(&w->objects[k]);
        o.antialiased = w->parts[k]->scene.antialiased;
        for (size_t i = 0; i < w->parts[k]->count; i++)
            if (is_kept(&w->objects[k], w->parts[k]->gaussians[i].position) &&
                reference_project_object(&w->parts[k]->gaussians[i], &object, &view, &o, &r.splats[r.count]))
                r.ids[r.count++] = (fxs_id){w->objects[k].id, (uint32_t)i};
    }
    CHECK(!reference_trace_init(&r.trace, view.width, view.height));
    r.trace.occluder = occluder;
    CHECK(!reference_trace_splats(r.splats, r.count, view.width, view.height, &o, &r.trace, r.rgb));
    return r;
}

static inline void reference_world_free(reference_world *r)
{
    reference_trace_free(&r->trace);
    free(r->splats);
    free(r->ids);
    free(r->rgb);
}

/* Returns the PSNR in dB of an RGBA8 picture against the reference picture. *drawn: share of pixels with a
   transmittance below 1/2. */
static inline double world_psnr(const picture *p, const reference_world *r, double *drawn)
{
    struct fxs_metrics metrics = {0};
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    uint8_t *expected = malloc(4 * pixels);
    reference_to_rgba8(r->rgb, p->width, p->height, expected);
    CHECK(!fxs_metrics_compare(picture_rgba(p), expected, p->width, p->height, &metrics));
    *drawn = 0;
    for (size_t i = 0; i < pixels; i++)
        *drawn += (r->trace.median[i] != REFERENCE_NONE) / (double)pixels;
    free(expected);
    return metrics.psnr;
}

#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/parts.h>

enum { WORLD_VERSIONS = 6 };

/* Fills `versions` with tables of kernels: plain C, then each instruction set of this processor alone. Returns the
   number of tables. */
static inline int world_versions(fxs_kernels versions[WORLD_VERSIONS])
{
    int count = 0;
    versions[count++] = fxs_kernels_c;
    for (unsigned flag = 1; flag <= fxs_cpu_detect(); flag *= 2)
        if (fxs_cpu_detect() & flag)
            fxs_kernels_choose(&versions[count++], flag);
    return count;
}
#else
enum { WORLD_VERSIONS = 1 };

static inline int world_versions(fxs_kernels versions[WORLD_VERSIONS])
{
    versions[0] = fxs_kernels_c;
    return 1;
}
#endif

#endif
