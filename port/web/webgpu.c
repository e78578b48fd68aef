/* Plans the compute shaders of a frame, which webgpu.js executes with WebGPU. gpu_begin takes the objects and the
   camera. gpu_lay_out makes the uniforms of the shaders and the list of steps (shader calls). When the device has
   finished the frame, gpu_look takes the status that the shaders report. */
#include <stdlib.h>
#include <string.h>

#include "kernels/compute/plan.h"
#include "src/core/chunk.h"
#include "src/core/mirror.h"
#include "web.h"

/* largest part of a scene in one GPU buffer, in bytes; every device can map such a buffer */
#define PART_BYTES (1 << 27)
/* most bytes of a streamed scene that go to the device after a frame */
#define UPLOAD_BYTES (1 << 23)

typedef struct web_plan {
    fxs_plan plan;
    fxs_plan_rooms *rooms;
    fxs_request request;
    void *crops, *memory;
    uint32_t *words;
    fxs_step *steps;
    uint32_t step_count;
} web_plan;

EXPORT(gpu_programs) const char *fxs_web_gpu_programs(void)
{
#define NAME(entry) #entry " "
    return FXS_COMPUTE_PROGRAMS_OF(NAME);
}

/* Returns the buffer capacities of a GPU device, which the caller frees with `release`. `most` is the largest size of a
   storage buffer in bytes. */
EXPORT(gpu_open) fxs_plan_rooms *fxs_web_gpu_open(double most)
{
    fxs_plan_rooms *rooms = fxs_web_allocate(sizeof *rooms);
    if (rooms)
        *rooms = (fxs_plan_rooms){.most = (uint64_t)most / 64 * 64};
    return rooms;
}

EXPORT(gpu_reset) void fxs_web_gpu_reset(fxs_plan_rooms *rooms)
{
    *rooms = (fxs_plan_rooms){.most = rooms->most};
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Returns the scene that frames draw: of a streamed scene, the mirror's scene. */
static const fxs_scene *drawn_of(const fxs_web_scene *s)
{
    return s->mirror ? &s->mirror->scene : &s->scene;
}

/* Returns a drawn scene as it lies on the device, where a streamed scene is a pool. */
static fxs_scene on_device(const fxs_scene *drawn)
{
    return drawn->places ? fxs_mirror_pool((const fxs_mirror *)(const void *)drawn) : *drawn;
}

static uint32_t part_chunks(const fxs_plan_rooms *rooms, const fxs_scene *scene)
{
    return fxs_plan_part_chunks(scene, rooms->most < PART_BYTES ? rooms->most : PART_BYTES, fxs_web_message());
}

/* Finds the number of chunks in a GPU buffer of a scene, and returns the number of buffers. */
static int find_parts(const fxs_plan_rooms *rooms, const fxs_scene *drawn, uint32_t *each)
{
    const fxs_scene scene = on_device(drawn);
    *each = part_chunks(rooms, &scene);
    return *each ? (int)((fxs_scene_chunks(&scene) + (uint64_t)*each - 1) / *each) : FXS_ERR_MEMORY;
}

EXPORT(gpu_parts) int fxs_web_gpu_parts(const fxs_plan_rooms *rooms, const fxs_web_scene *s)
{
    uint32_t each;
    return find_parts(rooms, drawn_of(s), &each);
}

/* Describes a part of a scene, or the scene's chunk headers, for an upload to a GPU buffer. Out: bytes of the part;
   then for each of 3 pieces of the part: address, bytes, offset in the buffer. Of a pool, only the last piece, the
   palette, is in memory. */
EXPORT(gpu_pieces) void fxs_web_gpu_pieces(const fxs_plan_rooms *rooms, const fxs_web_scene *s, int part)
{
    const fxs_scene scene = on_device(drawn_of(s));
    double *out = fxs_web_numbers();
    fxs_piece pieces[3];
    *out++ = (double)fxs_plan_pieces(&scene, part_chunks(rooms, &scene), part, pieces);
    for (int i = 0; i < 3; i++) {
        *out++ = (double)(uintptr_t)pieces[i].from;
        *out++ = (double)pieces[i].bytes;
        *out++ = (double)pieces[i].at;
    }
}

/* Draws a streamed scene from its pool on the device. Each Screen has a pool of its own. */
EXPORT(gpu_use) void fxs_web_gpu_use(fxs_web_scene *s, fxs_mirror *mirror)
{
    s->mirror = mirror;
}

/* Returns an empty pool of at most `bytes` bytes, which the caller frees with `release`. */
EXPORT(gpu_pool) fxs_mirror *fxs_web_gpu_pool(const fxs_web_scene *s, double bytes)
{
    const fxs_scene *scene = &s->scene;
    const uint32_t room = fxs_places_room(scene, (uint64_t)bytes, fxs_mirror_place_bytes(scene));
    if (!room)
        fxs_plan_say(fxs_web_message(), FXS_ERR_MEMORY, "the device's pool has no room for 16 chunks", "");
    fxs_mirror *m = room ? fxs_web_allocate(sizeof *m + (size_t)fxs_mirror_bytes(scene, room)) : NULL;
    if (m) {
        fxs_mirror_init(m, scene, room, m + 1);
        m->pool.turn = 0;          /* the first frame has turn 1 or a later one */
    }
    return m;
}

/* Chooses chunks to upload to the pool. Returns their number. Out: address of their places in the pool. */
EXPORT(gpu_step) uint32_t fxs_web_gpu_step(fxs_mirror *m)
{
    const uint32_t *places, count = fxs_mirror_step(m, UPLOAD_BYTES, &places);
    fxs_web_numbers()[0] = (double)(uintptr_t)places;
    return count;
}

/* Describes the chunk in a place of the pool. Out: addresses of its header and of its rows; number of the GPU buffer
   for the rows; offset in this buffer. */
EXPORT(gpu_place) void fxs_web_gpu_place(const fxs_plan_rooms *rooms, const fxs_mirror *m, uint32_t place)
{
    const fxs_scene pool = fxs_mirror_pool(m);
    const uint32_t each = part_chunks(rooms, &pool), chunk = fxs_mirror_chunk(m, place);
    double *out = fxs_web_numbers();
    out[0] = (double)(uintptr_t)fxs_header(m->from, chunk);
    out[1] = (double)(uintptr_t)fxs_rows(m->from, chunk);
    out[2] = place / each;
    out[3] = (double)fxs_plan_place_at(&pool, each, place);
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

EXPORT(gpu_end) void fxs_web_gpu_end(web_plan *w)
{
    free(w->words);
    free(w->memory);
    free(w->crops);
    free(w);
}

/* Sets the targets (pictures) of an eye. The bits of `asked` name them, from bit 0: colour, mean depth, median depth,
   ids, occluder, backdrop. The pictures lie on the device, so the addresses are placeholders. The rows of all pictures
   of all eyes lie side by side. */
static void take_targets(fxs_request *r, uint32_t eye, int alpha, int depth_bits, uint32_t asked)
{
    fxs_targets *t = &r->targets[eye];
    fxs_image *const images[] = {&t->colour, &t->mean_depth, &t->median_depth, &t->id, &t->occluder, &t->backdrop};
    const ptrdiff_t row = 4 * (ptrdiff_t)r->cameras->width;
    const ptrdiff_t each = row * (__builtin_popcount(asked) + (int)(asked >> 3 & 1));
    uintptr_t at = 0x40 + eye * (uintptr_t)each;
    fxs_targets_init(t);
    t->format = alpha ? FXS_FORMAT_RGBA8_COVERAGE : FXS_FORMAT_RGBA8;
    t->depth_bits = depth_bits;
    for (uint32_t i = 0; i < sizeof images / sizeof *images; i++)
        if (asked >> i & 1) {
            *images[i] = (fxs_image){(void *)at, (ptrdiff_t)r->eyes * each};
            at += (uintptr_t)(images[i] == &t->id ? 2 * row : row);
        }
}

/* Replaces the objects' streamed scenes by their mirrors, which know the pools. */
static void take_mirrors(fxs_request *r)
{
    for (uint32_t i = 0; i < r->count; i++) {
        fxs_object *object = (fxs_object *)(uintptr_t)&r->objects[i];
        const fxs_web_scene *s = (const fxs_web_scene *)(const void *)object->scene;
        fxs_mirror *m = s->mirror;
        if (!m)
            continue;
        if (m->pool.turn != s->turn)
            fxs_mirror_begin(m, s->turn, m->pool.turn, &(fxs_want){fxs_web_want, NULL});
        object->scene = &m->scene;
    }
    r->options.want.call = fxs_mirror_want;
}

static int begin(web_plan *w)
{
    w->memory = fxs_web_allocate(fxs_plan_memory(&w->request));
    int error = w->memory ? fxs_plan_begin(&w->plan, &w->request, w->memory, fxs_web_message()) : FXS_ERR_MEMORY;
    for (uint32_t i = 0; i < w->request.count && !error; i++) {
        const int parts = find_parts(w->rooms, w->request.objects[i].scene, &w->plan.part_chunks[i]);
        w->plan.part_counts[i] = (uint32_t)parts;
        error = parts < 0 ? parts : 0;
    }
    return error;
}

/* Begins a frame on the GPU, which gpu_end frees. Out: numbers of drawn Gaussians and of chunks that the GPU lacks; 1:
   an object moves. */
EXPORT(gpu_begin) web_plan *fxs_web_gpu_begin(fxs_plan_rooms *rooms, int alpha, int depth_bits, uint32_t asked,
                                              uint32_t background, int sh_degree, int square, uint32_t budget,
                                              uint32_t detail_q8)
{
    web_plan *w = fxs_web_allocate(sizeof *w);
    if (!w)
        return NULL;
    memset(w, 0, sizeof *w);
    w->rooms = rooms;
    fxs_web_request(&w->request, background, sh_degree, square, budget, detail_q8);
    for (uint32_t eye = 0; eye < w->request.eyes; eye++)
        take_targets(&w->request, eye, alpha, depth_bits, asked);
    w->crops = fxs_web_take_crops();
    take_mirrors(&w->request);
    if (begin(w)) {
        fxs_web_gpu_end(w);
        return NULL;
    }
    fxs_web_numbers()[0] = (double)w->plan.places * FXS_CHUNK;
    fxs_web_numbers()[1] = w->plan.missing;
    fxs_web_numbers()[2] = fxs_plan_moves(&w->plan);
    return w;
}

static void take_step(void *argument, const fxs_step *step)
{
    web_plan *w = argument;
    w->steps[w->step_count++] = *step;
}

/* Lays out the GPU buffers of the frame. Out: address and bytes of the uniforms; address, bytes and device offset of
   the table of drawn chunks; address and number of the steps (shader calls); device offsets in 32-bit words of colour,
   mean depth, median depth, ids, occluder and backdrop; bytes of each buffer. The last two are of each eye. */
EXPORT(gpu_lay_out) int fxs_web_gpu_lay_out(web_plan *w)
{
    fxs_plan *p = &w->plan;
    double *out = fxs_web_numbers();
    const int error = fxs_plan_lay_out(p, w->rooms, fxs_web_message());
    if (error)
        return error;
    const size_t uniforms = (size_t)p->bytes[FXS_COMPUTE_UNIFORMS], places = fxs_plan_places_bytes(p);
    free(w->words);
    w->words = fxs_web_allocate(uniforms + places + p->request->eyes * (FXS_PLAN_STEPS + 3 * p->frames->spans) *
                                                        sizeof *w->steps);
    if (!w->words)
        return FXS_ERR_MEMORY;
    memset(w->words, 0, uniforms + places);
    fxs_plan_uniforms(p, w->words);
    fxs_plan_places(p, w->words + uniforms / 4);
    w->steps = (fxs_step *)(void *)(w->words + (uniforms + places) / 4);
    w->step_count = 0;
    fxs_plan_steps(p, take_step, w);
    const double facts[] = {(double)(uintptr_t)w->words, (double)uniforms,
                            (double)(uintptr_t)(w->words + uniforms / 4), (double)places, 4.0 * p->frames->spans_at,
                            (double)(uintptr_t)w->steps, w->step_count, p->frames->colour, p->frames->mean_depth,
                            p->frames->median_depth, p->frames->id, p->frames->occluder, p->frames->backdrop};
    memcpy(out, facts, sizeof facts);
    for (size_t i = 0; i < FXS_COMPUTE_BUFFERS; i++)
        out[sizeof facts / sizeof *facts + i] = (double)p->bytes[i];
    return 0;
}

/* Takes the statuses of a finished frame, the numbers. */
EXPORT(gpu_look) int fxs_web_gpu_look(fxs_plan_rooms *rooms, uint32_t eyes)
{
    uint32_t status[FXS_COMPUTE_EYES * FXS_COMPUTE_STATUS];
    for (uint32_t i = 0; i < eyes * FXS_COMPUTE_STATUS; i++)
        status[i] = (uint32_t)fxs_web_numbers()[i];
    return fxs_plan_look(rooms, status, eyes, fxs_web_message());
}

/* Returns the table that lies at the start of the device memory: -2 ln(opacity) of each opacity code, Q11. Out: size of
   the table in bytes. */
EXPORT(gpu_table) const void *fxs_web_gpu_table(void)
{
    fxs_web_numbers()[0] = sizeof fxs_offset_of_code_q11;
    return fxs_offset_of_code_q11;
}
