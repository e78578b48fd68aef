/* The CUDA back end (cuda.h): allocates device memory and launches the kernels of a frame. Several frames may be in
 * flight, each in a slot with streams, events and device buffers.
 *
 * The kernels of a frame choose the level of detail, project the Gaussians to splats, list the splats of each tile
 * (start_lists, fill_lists), sort the lists (sort_lists) and blend. A second stream blends long tile lists while the
 * first sorts the others. If the tile lists overflowed, the last kernel (finish_tiles) draws the frame without them,
 * and later frames get larger buffers. */
#include <fixsplat/cuda.h>

#include "blend.cuh"
#include "cut.cuh"
#include "dense.cuh"
#include "lists.cuh"
#include "scenes.cuh"
#include "tail.cuh"

namespace {

const uint32_t SLOTS = 16, CALLS = 2;
const uint64_t ENTRIES_MAX = 0xffffffffu;

struct slot {
    cudaStream_t stream, side;
    cudaStream_t on;
    cudaEvent_t done, listed, dense_done, stages[FXS_CUDA_STAGES + 1];
    block objects;                 /* arrays of a frame: fxs_object_view[], crop boxes, views for the level of detail,
                                      list of drawn chunks (256 Gaussians each), their numbers in the scenes */
    block splats, tiles, larges, entries;
    block cut;
    block pixels;
};

struct slot_sizes {
    uint64_t objects, splats, tiles, larges, entries, cut, pixels;
};

enum { PLANES = 7 };

struct frame {
    fxs_stage_view view;                 /* camera in world space; for one object without scale, crop and tint: in the
                                            object's space */
    fxs_scene scene;               /* the scene with device pointers, if the frame has one object without scale, crop
                                      and tint */
    fxs_targets targets;
    bool hosted[PLANES];           /* true: this output image is rendered on the device, then copied to the caller's
                                      pinned host memory */
    uint32_t object_count, crop_count, chunks, gaussians, tiles;
    uint32_t cut_room;             /* largest number of chunks (256 Gaussians each) that are drawn; 0: no limit */
    uint32_t cut_chunks, whole_chunks, cut_eyes;
    uint32_t missing;              /* number of wanted chunks that are not on the device */
    bool in_parts;                 /* true: a scene is in parts (fxs_scene.places) */
    bool moving;                   /* true: a scene moves, so `drawn` has the moments of its chunks */
    bool cut_here;                 /* true: the host chooses the chunks that are drawn, because a scene is in parts or
                                      moves, or its level-of-detail tree is invalid */
    uint64_t staged;
    bool plain;                    /* true: the frame has one object, not scaled, cropped or tinted, with all Gaussians
                                      drawn */
    bool pooled;
};

/* Host memory of a call of fxs_cuda_render, until the call's frames have ended. */
struct call {
    host_block staged;
    upload chunks;
    frame_needs needs[FXS_CUDA_BATCH];
    uint32_t count;                /* number of frames whose `needs` were not read yet */
    cudaEvent_t done;
};

}

struct fxs_cuda {                  /* the struct lies in pinned host memory, so that kernels can write the arrays
                                      `needs` of `calls` */
    int device, timed, stereo;
    float milliseconds;
    int dense;                     /* 1: the device has enough shared memory for the kernel blend_dense */
    uint32_t processors, slot_count;
    uint32_t groups, traced_groups;
    uint32_t warps, traced_warps;
    budget memory;
    scene_table scenes;
    host_block cut;
    block pixels;
    slot slots[SLOTS];
    cudaEvent_t ready, began;
    bool began_marked;
    bool early;                    /* true: a kernel may start before the previous kernel ends (programmatic dependent
                                      launch) */
    uint64_t capacity, large_capacity;
    uint64_t entries_most, split_most;      /* small capacities of the tile lists that tests set to cause overflows; 0:
                                               none */
    uint32_t larges_most;

    fxs_options options;
    frame frames[FXS_CUDA_BATCH];
    frame_buffers buffers[FXS_CUDA_BATCH];
    call calls[CALLS];
    uint32_t call_number;          /* calls[call_number] is the last call */
    uint32_t turn;                 /* number of calls */
    bool damaged;                  /* true: the header of a chunk (256 Gaussians) was out of range */
    uint32_t frame_count;
    uint32_t frame_number;
    fxs_cuda_frame device_frames[FXS_CUDA_BATCH];
};

namespace {

const call *last_call(const fxs_cuda *cuda)
{
    return &cuda->calls[cuda->call_number];
}

call *last_call(fxs_cuda *cuda)
{
    return &cuda->calls[cuda->call_number];
}

unsigned char *staged_at(const fxs_cuda *cuda, uint64_t at)
{
    return (unsigned char *)last_call(cuda)->staged.data + at;
}

uint64_t larger_of(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Returns the number of frames in flight. It is 1 if a scene is only partly in device memory, as each frame may evict
   Gaussians that the previous frame reads. */
uint32_t slots_of(const fxs_cuda *cuda, uint32_t frames)
{
    const uint32_t slots = cuda->scenes.pools ? 1 : cuda->slot_count;
    return frames < slots ? frames : slots;
}

struct plane {
    fxs_image *image;
    size_t pixel_bytes;
    bool read;
};

void planes_of(fxs_targets *t, plane planes[PLANES])
{
    const plane all[PLANES] = {{&t->colour, (size_t)fxs_pixel_bytes(t->format), false}, {&t->coverage, 1, false},
                               {&t->mean_depth, 4, false}, {&t->median_depth, 4, false}, {&t->id, 8, false},
                               {&t->occluder, 4, true}, {&t->backdrop, 4, true}};
    memcpy(planes, all, sizeof all);
}

uint64_t place_hosted(fxs_targets *targets, const frame *of, void *memory)
{
    unsigned char *at = (unsigned char *)memory;
    plane planes[PLANES];
    planes_of(targets, planes);
    for (int k = 0; k < PLANES; k++)
        if (of->hosted[k]) {
            planes[k].image->stride = (ptrdiff_t)(planes[k].pixel_bytes * (size_t)of->view.width);
            planes[k].image->pixels = cut<unsigned char>(&at, (uint64_t)planes[k].image->stride *
                                                                  (uint64_t)of->view.height);
        }
    return (uint64_t)(at - (unsigned char *)memory);
}

uint64_t cut_views_at(const frame *of)
{
    return of->object_count * sizeof(fxs_object_view) + of->crop_count * sizeof(fxs_crop);
}

uint64_t drawn_at(const frame *of)
{
    return cut_views_at(of) + (of->cut_room ? of->object_count * of->cut_eyes * sizeof(fxs_stage_view) : 0);
}

uint64_t drawn_bytes(const frame *of)
{
    return of->in_parts ? of->chunks * (sizeof(fxs_drawn) + sizeof(uint32_t)) : of->cut_room * sizeof(fxs_drawn);
}

/* Places the arrays of a frame in the memory blocks of a slot, and computes the sizes of these blocks. If the blocks
   are not allocated yet, only *sizes is valid. */
frame_buffers slot_buffers(const slot *s, const frame *of, slot_sizes *sizes)
{
    frame_buffers f;
    unsigned char *splats = (unsigned char *)s->splats.data, *of_tiles = (unsigned char *)s->tiles.data;
    unsigned char *objects = (unsigned char *)s->objects.data;
    const uint64_t gaussians = (uint64_t)of->chunks * FXS_CHUNK;
    f.objects = (const fxs_object_view *)objects;
    f.object_count = of->object_count;
    f.drawn = of->cut_room ? (const fxs_drawn *)(objects + drawn_at(of)) : nullptr;
    f.drawn_count = nullptr;
    f.numbers = of->in_parts ? (const uint32_t *)(f.drawn + of->chunks) : nullptr;
    f.chunk_views = cut<fxs_chunk_view>(&splats, of->chunks);
    f.chunk_objects = cut<uint32_t>(&splats, of->chunks);
    f.covers = cut<uint64_t>(&splats, of->chunks);
    f.splats = cut<fxs_splat>(&splats, gaussians);
    f.split_entries = f.boxes = cut<uint64_t>(&splats, gaussians);
    f.depths = cut<uint32_t>(&splats, gaussians);
    f.split_capacity = (uint64_t)(splats - (unsigned char *)f.boxes) / sizeof *f.split_entries;
    f.status = cut<frame_status>(&of_tiles, 1);
    f.list_step = gaussians < MANY_GAUSSIANS * (uint64_t)of->tiles ? 1 : LISTS_APART;
    f.lists = cut<tile_list>(&of_tiles, f.list_step * (uint64_t)of->tiles);
    f.classes = cut<uint32_t>(&of_tiles, 32 * (uint64_t)of->tiles);
    f.entries = (uint64_t *)s->entries.data;
    f.capacity = s->entries.bytes / sizeof *f.entries;
    f.larges = (large_splat *)s->larges.data;
    f.large_capacity = (uint32_t)(s->larges.bytes / sizeof *f.larges);
    sizes->objects = drawn_at(of) + drawn_bytes(of);
    sizes->splats = (uint64_t)(splats - (unsigned char *)s->splats.data);
    sizes->tiles = (uint64_t)(of_tiles - (unsigned char *)s->tiles.data);
    return f;
}

cut_buffers slot_cut(const slot *s, const frame *of, const fxs_options *options, uint64_t *cleared, uint64_t *bytes)
{
    const uint64_t blocks = of->cut_chunks / LIST_CHUNKS + 1;
    unsigned char *const start = (unsigned char *)s->cut.data, *at = start;
    unsigned char *objects = (unsigned char *)s->objects.data;
    cut_buffers c;
    c.status = cut<cut_status>(&at, 1);
    c.block_counts = cut<uint32_t>(&at, blocks);
    c.marks = cut<uint32_t>(&at, blocks * (LIST_CHUNKS / 32));
    c.keys = cut<key_count>(&at, KEYS);
    *cleared = (uint64_t)(at - start);
    c.shares_q8 = cut<uint16_t>(&at, of->cut_chunks);
    c.sights = cut<node_sight>(&at, of->cut_chunks);
    c.candidates = cut<uint64_t>(&at, of->cut_chunks);
    *bytes = (uint64_t)(at - start);
    c.drawn = (fxs_drawn *)(objects + drawn_at(of));
    c.views = (const fxs_stage_view *)(objects + cut_views_at(of));
    c.eyes = of->cut_eyes;
    c.chunks = of->cut_chunks;
    c.whole_chunks = of->whole_chunks;
    c.room = of->cut_room;
    c.detail_q8 = options->detail_q8;
    return c;
}

int reserve_slot(fxs_cuda *cuda, slot *s, const slot_sizes *sizes, fxs_message *why)
{
    budget *taken = &cuda->memory;
    int error = reserve(taken, &s->objects, larger_of(s->objects.bytes, sizes->objects), why);
    error = error ? error : reserve(taken, &s->splats, larger_of(s->splats.bytes, sizes->splats), why);
    error = error ? error : reserve(taken, &s->tiles, larger_of(s->tiles.bytes, sizes->tiles), why);
    error = error ? error : reserve(taken, &s->larges, larger_of(s->larges.bytes, sizes->larges), why);
    error = error ? error : reserve(taken, &s->cut, larger_of(s->cut.bytes, sizes->cut), why);
    error = error ? error : reserve(taken, &s->pixels, larger_of(s->pixels.bytes, sizes->pixels), why);
    return error ? error : reserve(taken, &s->entries, larger_of(s->entries.bytes, sizes->entries), why);
}

void free_slot(fxs_cuda *cuda, slot *s)
{
    block *const blocks[] = {&s->objects, &s->splats, &s->tiles, &s->larges, &s->entries, &s->cut, &s->pixels};
    for (block *b : blocks)
        reserve(&cuda->memory, b, 0, nullptr);
}

void free_slots(fxs_cuda *cuda)
{
    for (uint32_t i = 0; i < cuda->slot_count; i++)
        free_slot(cuda, &cuda->slots[i]);
    cuda->capacity = cuda->large_capacity = 0;
}

uint64_t missing(const block *b, uint64_t bytes)
{
    return bytes > b->bytes ? bytes - b->bytes : 0;
}

uint64_t drawn_most(const frame *f)
{
    const uint64_t drawn = (uint64_t)f->chunks * FXS_CHUNK;
    return drawn < f->gaussians ? drawn : f->gaussians;
}

/* Returns the number of Gaussians for which the tile lists have room at first. A scene in parts may be much larger than
   its pool, and a moving scene than what is alive at a time. */
uint64_t listed(const frame *f)
{
    return f->in_parts || f->moving ? drawn_most(f) : f->gaussians;
}

uint64_t likely_larges(const frame *f)
{
    return (f->view.cutoff == FXS_CUTOFF_SQUARE ? drawn_most(f) : 0) + listed(f) / 16 + 4096;
}

uint64_t size_slots(fxs_cuda *cuda, uint32_t count, slot_sizes sizes[SLOTS])
{
    const slot none = {};
    uint64_t needed = cuda->memory.bytes + cuda->scenes.bytes_wanted;
    memset(sizes, 0, SLOTS * sizeof *sizes);
    for (uint32_t i = 0; i < count; i++) {
        const frame *f = &cuda->frames[i];
        slot_sizes *s = &sizes[i % slots_of(cuda, SLOTS)], of_frame;
        uint64_t cleared, cut_bytes = 0;
        fxs_targets targets = f->targets;
        slot_buffers(&none, f, &of_frame);
        if (f->cut_room && !f->cut_here)
            slot_cut(&none, f, &cuda->options, &cleared, &cut_bytes);
        s->cut = larger_of(s->cut, cut_bytes);
        s->pixels = larger_of(s->pixels, place_hosted(&targets, f, nullptr));
        s->objects = larger_of(s->objects, of_frame.objects);
        s->splats = larger_of(s->splats, of_frame.splats);
        s->tiles = larger_of(s->tiles, of_frame.tiles);
        cuda->capacity = larger_of(cuda->capacity, 2 * listed(f) + 65536);
        cuda->large_capacity = larger_of(cuda->large_capacity, likely_larges(f));
    }
    for (uint32_t i = 0; i < slots_of(cuda, count); i++) {
        const slot *s = &cuda->slots[i];
        sizes[i].larges = cuda->large_capacity * sizeof(large_splat);
        sizes[i].entries = cuda->capacity * sizeof(uint64_t);
        needed += missing(&s->objects, sizes[i].objects) + missing(&s->splats, sizes[i].splats) +
                  missing(&s->tiles, sizes[i].tiles) + missing(&s->larges, sizes[i].larges) +
                  missing(&s->entries, sizes[i].entries) + missing(&s->cut, sizes[i].cut) +
                  missing(&s->pixels, sizes[i].pixels);
    }
    return needed;
}

uint64_t memory_most(const fxs_cuda *cuda)
{
    const budget *memory = &cuda->memory;
    uint64_t most = memory->most ? memory->most : UINT64_MAX;
    size_t left = 0, all = 0;
    if (cuda->scenes.bytes_wanted && !check(nullptr, cudaMemGetInfo(&left, &all))) {
        const uint64_t there = memory->bytes + left - left / 16;       /* 1/16 of the free device memory stays free for
                                                                          CUDA modules and fragmentation */
        most = most < there ? most : there;
    }
    return most;
}

/* Copies scenes to the device and allocates memory for the frames. If memory is short, keeps only part of a scene on
   the device. */
int make_room(fxs_cuda *cuda, uint32_t count, int error, fxs_message *why)
{
    slot_sizes sizes[SLOTS];
    budget *memory = &cuda->memory;
    scene_table *scenes = &cuda->scenes;
    uint64_t rows_most = UINT64_MAX;
    if (!error) {
        const uint64_t most = memory_most(cuda);
        uint64_t needed = size_slots(cuda, count, sizes);
        if (needed > most) {
            free_slots(cuda);
            error = want_pools_again(scenes, memory, why);
            needed = size_slots(cuda, count, sizes);
        }
        if (needed > most && scenes->bytes_wanted) {
            needed -= scenes->bytes_wanted - scenes->least_wanted;
            rows_most = needed < most ? (most - needed) / 4 * 3 / wanted_scenes(scenes) : 0;
            memory->most = most;
        }
        error = error ? error : too_large(memory, needed, why);
    }
    error = fetch_scenes(scenes, memory, rows_most, error, cuda->slots[0].stream, why);
    if (!error && scenes->pools)
        size_slots(cuda, count, sizes);
    for (uint32_t i = 0; i < slots_of(cuda, count) && !error; i++)
        error = reserve_slot(cuda, &cuda->slots[i], &sizes[i], why);
    return error;
}

int options_valid(const fxs_options *o)
{
    return o->sh_degree >= 0 && o->sh_degree <= 3 && (unsigned)o->cutoff <= FXS_CUTOFF_SQUARE;
}

bool writes_any(fxs_targets targets)
{
    plane planes[PLANES];
    planes_of(&targets, planes);
    for (const plane &p : planes)
        if (p.image->pixels && !p.read)
            return true;
    return false;
}

bool are_aligned(fxs_targets targets)
{
    plane planes[PLANES];
    planes_of(&targets, planes);
    for (const plane &p : planes)
        if (p.image->pixels && ((uintptr_t)p.image->pixels | (uintptr_t)p.image->stride) % p.pixel_bytes)
            return false;
    return true;
}

bool is_in_host_memory(const void *pointer)
{
    cudaPointerAttributes of;
    return !check(nullptr, cudaPointerGetAttributes(&of, pointer)) && of.type == cudaMemoryTypeHost;
}

/* Finds the output images in pinned host memory. These images are rendered on the device and then copied. */
void find_hosted(frame *f)
{
    plane planes[PLANES];
    planes_of(&f->targets, planes);
    for (int k = 0; k < PLANES; k++)
        f->hosted[k] = !planes[k].read && planes[k].image->pixels &&
                       planes[k].image->stride >= (ptrdiff_t)(planes[k].pixel_bytes * (size_t)f->view.width) &&
                       is_in_host_memory(planes[k].image->pixels);
}

int count_objects(frame *f, const fxs_object *objects, uint32_t count, const fxs_options *options)
{
    uint64_t chunks = 0, gaussians = 0;
    int error = !objects && count ? FXS_ERR_ARGUMENT : count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        fxs_object object;
        error = fxs_object_read(&object, objects, i);
        error = error ? error : fxs_object_check(&object);
        if (error)
            return error;
        f->in_parts |= object.scene->places != nullptr;
        f->moving |= object.scene->motion != nullptr;
        chunks += object.scene->chunk_count;
        gaussians += object.scene->count;
        f->crop_count += object.crop_count;
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    f->object_count = count;
    f->cut_here = f->in_parts || f->moving;
    f->cut_room = error ? 0 : fxs_cut_room(objects, count, options);
    f->chunks = f->cut_room ? f->cut_room : (uint32_t)chunks;
    f->gaussians = (uint32_t)gaussians;
    for (uint32_t i = 0; i < count && f->cut_room; i++) {
        const fxs_scene *scene = fxs_object_at(objects, i)->scene;
        f->cut_chunks += fxs_scene_chunks(scene);
        f->whole_chunks += scene->nodes ? 0 : scene->chunk_count;
    }
    return error;
}

int take_frame(frame *f, const fxs_cuda_frame *from, const fxs_options *options, fxs_message *why)
{
    *f = {};
    int error = count_objects(f, from->objects, from->count, options);
    error = error ? error : fxs_view_init(&f->view, &from->camera, options);
    error = error ? error : fxs_targets_check(&from->targets, f->view.width, f->view.height);
    error = error ? error
            : from->targets.format > FXS_FORMAT_RGBA16_COVERAGE || from->targets.rates.pixels ? FXS_ERR_UNSUPPORTED : 0;
    if (!error && !writes_any(from->targets))
        error = FXS_ERR_TARGET;
    f->targets = from->targets;
    f->tiles = (uint32_t)(f->view.tiles_x * f->view.tiles_y);
    return error ? failed(why, error, fxs_strerror(error)) : 0;
}

/* Returns the largest number of chunks that a frame with scenes in parts can draw. */
uint32_t chunks_there(const scene_table *scenes, const fxs_cuda_frame *of, uint32_t most)
{
    uint64_t chunks = 0;
    for (uint32_t i = 0; i < of->count; i++) {
        const fxs_scene *scene = fxs_object_at(of->objects, i)->scene;
        chunks += scene->places ? find_scene(scenes, scene)->mirror->pool.room : fxs_scene_chunks(scene);
    }
    return chunks < most ? (uint32_t)chunks : most;
}

int want_scenes(fxs_cuda *cuda, frame *f, const fxs_cuda_frame *from, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < from->count && !error; i++) {
        const fxs_object *object = fxs_object_at(from->objects, i);
        if (object->visible || object->scene->places)
            error = want_scene(&cuda->scenes, &cuda->memory, object->scene, why);
    }
    if (!error && f->in_parts)
        f->chunks = chunks_there(&cuda->scenes, from, f->chunks);
    return error;
}

int take_frames(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, fxs_message *why)
{
    int error = 0;
    uint64_t staged = 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        frame *f = &cuda->frames[i];
        slot_sizes sizes;
        const slot none = {};
        error = take_frame(f, &frames[i], &cuda->options, why);
        f->cut_eyes = cuda->stereo ? 2 : 1;
        if (!error && !are_aligned(f->targets))
            error = failed(why, FXS_ERR_TARGET, "a target is not aligned to its pixels");
        error = error ? error : want_scenes(cuda, f, &frames[i], why);
        if (!error)
            find_hosted(f);
        slot_buffers(&none, f, &sizes);
        f->staged = staged;
        staged += padded(sizes.objects);
    }
    return error ? error : reserve_host(&last_call(cuda)->staged, staged, why);
}

bool is_plain(const fxs_object_view *object)
{
    const int32_t one_q13 = 1 << 13, *tint_q13 = object->tint_q13;
    return object->visible && object->plain && tint_q13[0] == one_q13 && tint_q13[1] == one_q13 &&
           tint_q13[2] == one_q13;
}

fxs_object_view *staged_objects(const fxs_cuda *cuda, const frame *f)
{
    return (fxs_object_view *)staged_at(cuda, f->staged);
}

int stage_objects(fxs_cuda *cuda, uint32_t i, const fxs_cuda_frame *from, fxs_message *why)
{
    frame *f = &cuda->frames[i];
    const slot *s = &cuda->slots[i % slots_of(cuda, SLOTS)];
    fxs_object_view *views = staged_objects(cuda, f);
    fxs_crop *crops = (fxs_crop *)(views + f->object_count);
    const fxs_crop *crops_there = (const fxs_crop *)((const fxs_object_view *)s->objects.data + f->object_count);
    uint32_t chunks = 0;
    for (uint32_t k = 0; k < f->object_count; k++) {
        fxs_object object;
        int error = fxs_object_read(&object, from->objects, k);
        error = error ? error : fxs_object_view_init(&views[k], &f->view, &from->camera, &object);
        if (error)
            return failed(why, error, fxs_strerror(error));
        if (object.visible) {
            const scene_copy *copy = find_scene(&cuda->scenes, object.scene);
            views[k].scene = copy->there;
            f->cut_here |= copy->wrong_tree;
            f->pooled |= copy->pooled;
        }
        views[k].first_chunk = chunks;
        chunks += fxs_cut_chunks(object.scene, f->cut_room != 0);
        views[k].end_chunk = chunks;
        views[k].crops = crops_there;
        for (uint32_t n = 0; n < object.crop_count; n++)
            *crops++ = object.crops[n];
        crops_there += object.crop_count;
    }
    return 0;
}

/* Copies the objects of a frame, with mirrors in place of the scenes in parts. */
void take_mirrors(const fxs_cuda *cuda, fxs_object *out, const fxs_object *objects, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        fxs_object_read(&out[i], objects, i);
        if (!out[i].scene->places)
            continue;
        fxs_mirror *mirror = find_scene(&cuda->scenes, out[i].scene)->mirror;
        out[i].scene = &mirror->scene;
        fxs_mirror_begin(mirror, cuda->turn, cuda->turn, &cuda->options.want);
    }
}

/* Stages the drawn chunks. A chunk of a scene in parts gets the number of its place in the pool, and its own number is
   stored behind the chunks. */
void stage_drawn(fxs_cuda *cuda, frame *f, const fxs_cut *cut)
{
    const fxs_object_view *o = cut->views;
    f->chunks = cut->count;
    f->missing = cut->missing;
    fxs_drawn *drawn = (fxs_drawn *)staged_at(cuda, f->staged + drawn_at(f));
    uint32_t *numbers = (uint32_t *)(drawn + cut->count);
    memcpy(drawn, cut->drawn, cut->count * sizeof *drawn);
    for (uint32_t i = 0; i < cut->count && f->in_parts; i++) {
        while (drawn[i].chunk >= o->end_chunk)
            o++;
        const uint32_t *places = cut->objects[o - cut->views].scene->places;
        numbers[i] = drawn[i].chunk - o->first_chunk;
        drawn[i].chunk = o->first_chunk + (places ? places[numbers[i]] : numbers[i]);
    }
}

int find_cut(fxs_cuda *cuda, frame *f, fxs_cut *cut, fxs_message *why)
{
    const uint64_t bytes = f->object_count * sizeof(fxs_object);
    fxs_options options = cuda->options;
    int error = reserve_host(&cuda->cut, bytes + fxs_cut_bytes(f->cut_room, f->object_count, f->cut_eyes), why);
    if (error)
        return error;
    fxs_object *objects = (fxs_object *)cuda->cut.data;
    take_mirrors(cuda, objects, cut->objects, f->object_count);
    options.want.call = fxs_mirror_want;
    cut->objects = objects;
    cut->options = &options;
    cut->memory = (unsigned char *)cuda->cut.data + bytes;
    error = fxs_cut_find(cut);
    if (error)
        return failed(why, error, fxs_strerror(error));
    stage_drawn(cuda, f, cut);
    return 0;
}

/* Stages the cut of a frame for its second eye, whose room is the same, unless the scene has changed in between. */
int copy_cut(fxs_cuda *cuda, frame *to, const frame *from, fxs_message *why)
{
    if (to->cut_room != from->cut_room)
        return failed(why, FXS_ERR_SCENE, fxs_strerror(FXS_ERR_SCENE));
    to->chunks = from->chunks;
    memcpy(staged_at(cuda, to->staged + drawn_at(to)), staged_at(cuda, from->staged + drawn_at(from)),
           drawn_bytes(from));
    return 0;
}

/* Stages what the device needs for the cut, or finds the cut here. */
int stage_cut(fxs_cuda *cuda, uint32_t i, const fxs_cuda_frame *frames, fxs_message *why)
{
    frame *f = &cuda->frames[i];
    const fxs_camera cameras[] = {frames[i].camera, frames[cuda->stereo ? i ^ 1 : i].camera};
    fxs_cut cut = {};
    cut.objects = frames[i].objects;
    cut.object_count = f->object_count;
    cut.options = &cuda->options;
    cut.cameras = cameras;
    cut.eyes = f->cut_eyes;
    cut.views = staged_objects(cuda, f);
    cut.room = f->cut_room;
    if (f->cut_here && cuda->stereo && i % 2)
        return copy_cut(cuda, f, f - 1, why);
    if (f->cut_here)
        return find_cut(cuda, f, &cut, why);
    const int error = fxs_cut_views(&cut, (fxs_stage_view *)staged_at(cuda, f->staged + cut_views_at(f)));
    return error ? failed(why, error, fxs_strerror(error)) : 0;
}

int stage_frame(fxs_cuda *cuda, uint32_t i, const fxs_cuda_frame *frames, fxs_message *why)
{
    frame *f = &cuda->frames[i];
    const fxs_object_view *views = staged_objects(cuda, f);
    int error = stage_objects(cuda, i, &frames[i], why);
    error = error || !f->cut_room ? error : stage_cut(cuda, i, frames, why);
    if (error)
        return error;
    f->plain = !f->cut_room && !f->pooled && f->object_count == 1 && is_plain(views);
    if (f->plain) {
        f->view = views->view;
        f->scene = views->scene;
    }
    return 0;
}

target target_of(const fxs_targets *targets, const fxs_options *options)
{
    target t = {*targets, {0, 0, 0}, fxs_depth_bits(targets), 0};
    t.plain = t.images.colour.pixels && !t.images.backdrop.pixels &&
              (t.images.format == FXS_FORMAT_RGBA8 || t.images.format == FXS_FORMAT_RGBA8_COVERAGE);
    for (int c = 0; c < 3 && !fxs_is_premultiplied(t.images.format); c++)
        t.background_q13[c] = fxs_background_q13(options->background[c]);
    return t;
}

void mark(const fxs_cuda *cuda, const slot *s, int stage)
{
    if (cuda->timed)
        cudaEventRecord(s->stages[stage], s->on);
}

void mark_start(fxs_cuda *cuda, const slot *s)
{
    if (cuda->timed && !cuda->began_marked)
        cudaEventRecord(cuda->began, s->on);
    cuda->began_marked = true;
    mark(cuda, s, 0);
}

template <class... Parameters>
void launch(const fxs_cuda *cuda, void (*kernel)(Parameters...), uint32_t blocks, uint32_t threads, size_t shared,
            cudaStream_t stream, const Parameters &...parameters)
{
    cudaLaunchAttribute early = {};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = cuda->early;
    cudaLaunchConfig_t how = {};
    how.gridDim = dim3(blocks);
    how.blockDim = dim3(threads);
    how.dynamicSmemBytes = shared;
    how.stream = stream;
    how.attrs = &early;
    how.numAttrs = 1;
    cudaLaunchKernelEx(&how, kernel, parameters...);
}

void start_cut(const fxs_cuda *cuda, const frame *of, const slot *s, frame_buffers *f)
{
    uint64_t cleared, bytes;
    const cut_buffers c = slot_cut(s, of, &cuda->options, &cleared, &bytes);
    const uint32_t chunks = c.chunks;
    cudaMemsetAsync(c.status, 0, cleared, s->on);
    start(see_chunks, chunks / CUT_THREADS + 1, CUT_THREADS, 0, s->on, *f, c);
    launch(cuda, rank_nodes, chunks / STOP_THREADS + 1, STOP_THREADS, 0, s->on, *f, c);
    launch(cuda, find_stop, chunks / STOP_THREADS + 1, STOP_THREADS, 0, s->on, *f, c);
    launch(cuda, share_chunks, chunks / CUT_THREADS + 1, CUT_THREADS, 0, s->on, *f, c);
    launch(cuda, list_drawn_chunks, chunks / LIST_CHUNKS + 1, CUT_THREADS, 0, s->on, *f, c);
    f->drawn_count = &c.status->drawn;
}

template <bool Many, bool Moving>
void project(const fxs_cuda *cuda, const frame *of, const frame_buffers &f, cudaStream_t stream)
{
    start(locate_chunks<Many>, (of->chunks + 63) / 64, 64, 0, stream, of->view, of->scene, f, of->chunks);
    if (of->pooled)
        start(fetch_chunks, of->chunks, FETCH_THREADS, 0, stream, f);
    launch(cuda, project_chunk<Many, Moving>, of->chunks, FXS_CHUNK, 0, stream, of->view, of->scene, f);
}

template <class Pixel>
void finish(const fxs_cuda *cuda, cudaStream_t stream, uint32_t groups, const frame *of, const frame_buffers &f,
            const target &t)
{
    groups = groups < FINISH_GROUPS ? groups : FINISH_GROUPS;
    launch(cuda, of->moving ? finish_tiles<Pixel, true> : finish_tiles<Pixel, false>, cuda->processors,
           groups * GROUP_THREADS, blend_bytes<Pixel>(groups), stream, of->view, f, t, of->scene, of->plain);
}

template <class Pixel>
void blend_lists(const fxs_cuda *cuda, cudaStream_t stream, uint32_t warps, uint32_t groups, const fxs_stage_view &view,
                 const frame_buffers &f, const target &t)
{
    launch(cuda, blend_sorted<Pixel>, cuda->processors, warps * WARP, sorted_bytes<Pixel>(warps), stream, view, f, t,
           cuda->early);
    if (groups)
        start(blend_tiles<Pixel>, cuda->processors, groups * GROUP_THREADS, blend_bytes<Pixel>(groups), stream, view, f,
              t);
}

void blend_long(const fxs_cuda *cuda, const slot *s, const fxs_stage_view &view, const frame_buffers &f,
                const target &t)
{
    const uint32_t blocks = cuda->processors * DENSE_BLOCKS;
    cudaStreamWaitEvent(s->side, s->listed, 0);
    start(share_lists, cuda->processors * SHARE_BLOCKS, SHARE_THREADS, 0, s->side, view, f, blocks);
    launch(cuda, blend_dense, blocks, DENSE_THREADS, sizeof(dense_shared), s->side, view, f, t);
    cudaEventRecord(s->dense_done, s->side);
}

void blend(const fxs_cuda *cuda, const slot *s, const frame *of, const frame_buffers &f, const target &t)
{
    const fxs_stage_view &view = of->view;
    const bool traced = fxs_targets_traced(&t.images), dense = cuda->dense && !traced;
    if (dense)
        cudaEventRecord(s->listed, s->on);
    start(sort_lists, cuda->processors * SORT_BLOCKS, SORT_THREADS, sizeof(sort_shared), s->on, f,
          (uint32_t)(view.tiles_x * view.tiles_y));
    mark(cuda, s, 3);
    if (dense)
        blend_long(cuda, s, view, f, t);
    if (traced) {
        blend_lists<traced_pixel>(cuda, s->on, cuda->traced_warps, cuda->traced_groups, view, f, t);
        finish<traced_pixel>(cuda, s->on, cuda->traced_groups, of, f, t);
    } else {
        blend_lists<pixel>(cuda, s->on, cuda->warps, dense ? 0 : cuda->groups, view, f, t);
        finish<pixel>(cuda, s->on, cuda->groups, of, f, t);
    }
    if (dense)
        cudaStreamWaitEvent(s->on, s->dense_done, 0);
}

cudaError_t copy_hosted(const slot *s, const frame *of, fxs_targets from)
{
    fxs_targets to = of->targets;
    plane there[PLANES], here[PLANES];
    cudaError_t error = cudaSuccess;
    planes_of(&to, there);
    planes_of(&from, here);
    for (int k = 0; k < PLANES && !error; k++)
        if (of->hosted[k])
            error = cudaMemcpy2DAsync(there[k].image->pixels, (size_t)there[k].image->stride, here[k].image->pixels,
                                      (size_t)here[k].image->stride, (size_t)here[k].image->stride,
                                      (size_t)of->view.height, cudaMemcpyDeviceToHost, s->on);
    return error;
}

slot *slot_of_frame(fxs_cuda *cuda, uint32_t i)
{
    return &cuda->slots[i % slots_of(cuda, SLOTS)];
}

frame_buffers begin_frame(fxs_cuda *cuda, uint32_t i)
{
    const slot *s = slot_of_frame(cuda, i);
    const frame *of = &cuda->frames[i];
    slot_sizes sizes;
    frame_buffers f = slot_buffers(s, of, &sizes);
    f.needs = &last_call(cuda)->needs[i];
    f.number = ++cuda->frame_number;
    if (fxs_targets_traced(&of->targets))                    /* frames with depth or id outputs read the array `depths`
                                                                to the end, so scratch memory must not overlap it */
        f.split_capacity = (uint64_t)((uint64_t *)f.depths - f.boxes);
    if (cuda->entries_most) {
        f.capacity = cuda->entries_most;
        f.split_capacity = cuda->split_most;
    }
    f.large_capacity = cuda->larges_most ? cuda->larges_most : f.large_capacity;
    const uint64_t cleared = (uint64_t)((unsigned char *)list_of(&f, of->tiles) - (unsigned char *)f.status);
    cudaMemsetAsync(f.status, 0, cleared, s->on);
    return f;
}

void copy_objects(fxs_cuda *cuda, uint32_t i)
{
    const slot *s = slot_of_frame(cuda, i);
    const frame *of = &cuda->frames[i];
    const slot none = {};
    slot_sizes sizes;
    slot_buffers(&none, of, &sizes);
    if (sizes.objects && (!of->plain || fxs_targets_traced(&of->targets)))
        cudaMemcpyAsync(s->objects.data, staged_at(cuda, of->staged),
                        of->cut_here ? sizes.objects : drawn_at(of), cudaMemcpyHostToDevice, s->on);
}

void project_frame(const fxs_cuda *cuda, const frame *of, const slot *s, frame_buffers *f)
{
    if (of->cut_room && !of->cut_here)
        start_cut(cuda, of, s, f);
    if (of->chunks && of->plain)
        project<false, false>(cuda, of, *f, s->on);
    else if (of->chunks && of->moving)
        project<true, true>(cuda, of, *f, s->on);
    else if (of->chunks)
        project<true, false>(cuda, of, *f, s->on);
}

int draw_frame(fxs_cuda *cuda, uint32_t i, const frame_buffers &f, fxs_message *why)
{
    const slot *s = slot_of_frame(cuda, i);
    const frame *of = &cuda->frames[i];
    const fxs_stage_view &view = of->view;
    fxs_targets targets = of->targets;
    place_hosted(&targets, of, s->pixels.data);
    mark(cuda, s, 1);
    launch(cuda, start_lists, ((uint32_t)view.tiles_y + START_ROWS - 1) / START_ROWS, START_ROWS * WARP, 0, s->on, f,
           (uint32_t)view.tiles_x, (uint32_t)view.tiles_y);
    if (of->chunks)
        launch(cuda, fill_lists, LARGE_BLOCKS + of->chunks, FXS_CHUNK, 0, s->on, view, f);
    mark(cuda, s, 2);
    blend(cuda, s, of, f, target_of(&targets, &cuda->options));
    mark(cuda, s, 4);
    cuda->buffers[i] = f;
    const cudaError_t error = copy_hosted(s, of, targets), launched = cudaGetLastError();
    return check(why, error ? error : launched, cudaEventRecord(s->done, s->on));
}

int start_frame(fxs_cuda *cuda, uint32_t i, fxs_message *why)
{
    const slot *s = slot_of_frame(cuda, i);
    if (cuda->options.stop.call && cuda->options.stop.call(cuda->options.stop.argument))
        return failed(why, FXS_ERR_STOPPED, fxs_strerror(FXS_ERR_STOPPED));
    /* Starts kernels early only in a single frame, as waiting blocks take resources from other frames' kernels. */
    cuda->early = cuda->frame_count == 1;
    frame_buffers f = begin_frame(cuda, i);
    mark_start(cuda, s);
    copy_objects(cuda, i);
    project_frame(cuda, &cuda->frames[i], s, &f);
    return draw_frame(cuda, i, f, why);
}

/* Enlarges a block to at least `bytes`, with an eighth to spare, if the allowed memory has room for it. cudaFree waits
   for the frames that use the block. */
int enlarge(budget *taken, block *b, uint64_t bytes, fxs_message *why)
{
    const uint64_t before = b->bytes;
    int error = 0;
    for (const uint64_t spare : {bytes / 8, (uint64_t)0}) {
        const uint64_t wanted = bytes + spare;
        if (error || bytes <= b->bytes || (taken->most && taken->bytes - before + wanted > taken->most))
            continue;
        error = reserve(taken, b, wanted, why);
        if (error == FXS_ERR_MEMORY)
            error = reserve(taken, b, before, why);
    }
    return error;
}

/* Reads the needs of a call's frames, and enlarges the tile lists of later frames. If `waits` is false, does nothing
   before the frames have ended. */
int look(fxs_cuda *cuda, call *of, bool waits, fxs_message *why)
{
    if (!of->count)
        return 0;
    if (!waits && cudaEventQuery(of->done) == cudaErrorNotReady) {
        cudaGetLastError();
        return 0;
    }
    int error = check(why, cudaEventSynchronize(of->done));
    for (uint32_t i = 0; i < of->count && !error; i++) {
        slot *s = slot_of_frame(cuda, i);
        const frame_needs *n = &of->needs[i];
        const uint64_t entries = n->entries < ENTRIES_MAX ? n->entries : ENTRIES_MAX, larges = n->larges;
        cuda->damaged |= n->damaged != 0;
        error = enlarge(&cuda->memory, &s->entries, entries * sizeof(uint64_t), why);
        error = error ? error : enlarge(&cuda->memory, &s->larges, larges * sizeof(large_splat), why);
    }
    of->count = 0;
    return error;
}

int wait(fxs_cuda *cuda, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < CALLS && !error; i++)
        error = look(cuda, &cuda->calls[i], true, why);
    return error;
}

int end_frames(fxs_cuda *cuda, int error)
{
    for (uint32_t i = 0; i < slots_of(cuda, cuda->frame_count) && error; i++)
        cudaStreamSynchronize(cuda->slots[i].on);
    cuda->frame_count = 0;
    return error;
}

int slot_init(slot *s, fxs_message *why)
{
    int least, first;
    cudaError_t error = cudaDeviceGetStreamPriorityRange(&least, &first);
    error = error ? error : cudaStreamCreateWithFlags(&s->stream, cudaStreamNonBlocking);
    error = error ? error : cudaStreamCreateWithPriority(&s->side, cudaStreamNonBlocking, first);
    cudaEvent_t *const events[] = {&s->done, &s->listed, &s->dense_done};
    for (int i = 0; i < 3 && !error; i++)
        error = cudaEventCreateWithFlags(events[i], cudaEventDisableTiming);
    for (int i = 0; i <= FXS_CUDA_STAGES && !error; i++)
        error = cudaEventCreate(&s->stages[i]);
    return check(why, error);
}

void slot_close(slot *s)
{
    if (s->stream)
        cudaStreamDestroy(s->stream);
    if (s->side)
        cudaStreamDestroy(s->side);
    const cudaEvent_t events[] = {s->done, s->listed, s->dense_done};
    for (cudaEvent_t event : events)
        if (event)
            cudaEventDestroy(event);
    for (int i = 0; i <= FXS_CUDA_STAGES; i++)
        if (s->stages[i])
            cudaEventDestroy(s->stages[i]);
}

template <class Kernel>
int allow_shared(Kernel *kernel, size_t bytes, size_t shared_most, fxs_message *why)
{
    if (shared_most < bytes)
        return failed(why, FXS_ERR_UNSUPPORTED, "the device has too little shared memory");
    return check(why, cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, (int)bytes));
}

uint32_t parts_of(size_t shared_most, size_t fixed, size_t bytes, uint32_t most)
{
    const size_t parts = shared_most < fixed + bytes ? 1 : (shared_most - fixed) / bytes;
    return parts < most ? (uint32_t)parts : most;
}

template <class Pixel>
int fit_blends(uint32_t *groups, uint32_t *warps, size_t shared_most, fxs_message *why)
{
    *groups = parts_of(shared_most, blend_bytes<Pixel>(0), sizeof(group_shared<Pixel>), groups_most<Pixel>);
    *warps = parts_of(shared_most, sorted_bytes<Pixel>(0), sizeof(warp_shared<Pixel>), WARPS_MOST);
    int error = allow_shared(blend_tiles<Pixel>, blend_bytes<Pixel>(*groups), shared_most, why);
    error = error ? error : allow_shared(finish_tiles<Pixel, false>, blend_bytes<Pixel>(*groups), shared_most, why);
    error = error ? error : allow_shared(finish_tiles<Pixel, true>, blend_bytes<Pixel>(*groups), shared_most, why);
    return error ? error : allow_shared(blend_sorted<Pixel>, sorted_bytes<Pixel>(*warps), shared_most, why);
}

/* A thread block has 227 KiB of shared memory on H100 and H200, 163 KiB on A100, and 99 KiB on other GPUs. The kernel
   blend_dense does not fit into 99 KiB. */
int fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_message *why)
{
    int error = fit_blends<pixel>(&cuda->groups, &cuda->warps, shared_most, why);
    error = error ? error : fit_blends<traced_pixel>(&cuda->traced_groups, &cuda->traced_warps, shared_most, why);
    error = error ? error : allow_shared(sort_lists, sizeof(sort_shared), shared_most, why);
    cuda->dense = sizeof(dense_shared) <= shared_most;
    if (!error && cuda->dense)
        error = check(why, cudaFuncSetAttribute(blend_dense, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                                (int)sizeof(dense_shared)));
    return error;
}

int renderer_init(fxs_cuda *cuda, fxs_message *why)
{
    int processors = 0, shared_most = 0;
    size_t left = 0, all = 0;
    int error = check(why, cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, cuda->device),
                      cudaDeviceGetAttribute(&shared_most, cudaDevAttrMaxSharedMemoryPerBlockOptin, cuda->device));
    error = error ? error : check(why, cudaMemGetInfo(&left, &all));
    error = error ? error : fit_blocks(cuda, (size_t)shared_most, why);
    error = error ? error : check(why, cudaEventCreateWithFlags(&cuda->ready, cudaEventDisableTiming),
                                  cudaEventCreate(&cuda->began));
    for (call &c : cuda->calls)
        error = error ? error : check(why, cudaEventCreateWithFlags(&c.done, cudaEventDisableTiming));
    for (uint32_t i = 0; i < cuda->slot_count && !error; i++)
        error = slot_init(&cuda->slots[i], why);
    cuda->processors = (uint32_t)processors;
    cuda->scenes.pool_most = (cuda->memory.most ? cuda->memory.most : all) / 2;
    return error;
}

fxs_cuda_memory memory_of(const fxs_cuda *cuda)
{
    fxs_cuda_memory m = {0, 0, 0, 0, cuda->pixels.bytes, cuda->memory.bytes};
    for (uint32_t i = 0; i < cuda->scenes.count; i++)
        m.scenes += copies_of(&cuda->scenes)[i].data.bytes;
    for (uint32_t i = 0; i < cuda->slot_count; i++) {
        const slot *s = &cuda->slots[i];
        m.splats += s->objects.bytes + s->splats.bytes + s->larges.bytes + s->cut.bytes;
        m.tiles += s->tiles.bytes;
        m.pixels += s->pixels.bytes;
        m.entries += s->entries.bytes;
    }
    return m;
}

float milliseconds_of(const fxs_cuda *cuda)
{
    float most = 0;
    for (uint32_t i = 0; i < slots_of(cuda, cuda->frame_count) && cuda->timed; i++) {
        float milliseconds = 0;
        cudaEventElapsedTime(&milliseconds, cuda->began, cuda->slots[i].stages[FXS_CUDA_STAGES]);
        most = milliseconds > most ? milliseconds : most;
    }
    return most;
}

void stats_of(const fxs_cuda *cuda, fxs_cuda_stats *stats)
{
    *stats = {};
    stats->memory = memory_of(cuda);
    stats->device_milliseconds = cuda->milliseconds;
    for (uint32_t i = 0; i < cuda->frame_count; i++) {
        stats->gaussians += cuda->frames[i].gaussians;
        stats->missing += cuda->frames[i].missing;
        stats->visible += last_call(cuda)->needs[i].visible;
        stats->entries += last_call(cuda)->needs[i].entries;
    }
    for (uint32_t i = 0; i < slots_of(cuda, cuda->frame_count) && cuda->timed; i++)
        for (int k = 0; k < FXS_CUDA_STAGES; k++) {
            float milliseconds = 0;
            cudaEventElapsedTime(&milliseconds, cuda->slots[i].stages[k], cuda->slots[i].stages[k + 1]);
            stats->milliseconds[k] += milliseconds;
        }
}

uint64_t place_targets(fxs_cuda_frame *frames, uint32_t count, void *memory)
{
    unsigned char *at = (unsigned char *)memory;
    for (uint32_t i = 0; i < count; i++) {
        plane planes[PLANES];
        planes_of(&frames[i].targets, planes);
        for (const plane &p : planes)
            if (p.image->pixels) {
                p.image->stride = (ptrdiff_t)(p.pixel_bytes * (size_t)frames[i].camera.width);
                p.image->pixels = cut<unsigned char>(&at, (size_t)p.image->stride * (size_t)frames[i].camera.height);
            }
    }
    return (uint64_t)(at - (unsigned char *)memory);
}

int copy_image(const fxs_image *to, const fxs_image *from, size_t row, size_t height, fxs_message *why)
{
    unsigned char *out = (unsigned char *)to->pixels, *in = (unsigned char *)from->pixels;
    int error = 0;
    if (to->stride == (ptrdiff_t)row && from->stride == (ptrdiff_t)row)
        return check(why, cudaMemcpy(out, in, row * height, cudaMemcpyDefault));
    if (to->stride >= (ptrdiff_t)row && from->stride >= (ptrdiff_t)row)
        return check(why, cudaMemcpy2D(out, (size_t)to->stride, in, (size_t)from->stride, row, height,
                                       cudaMemcpyDefault));
    for (size_t y = 0; y < height && !error; y++)
        error = check(why, cudaMemcpy(out + (ptrdiff_t)y * to->stride, in + (ptrdiff_t)y * from->stride, row,
                                      cudaMemcpyDefault));
    return error;
}

/* Copies the input images to the device if `read` is true, otherwise the output images to the host. */
int copy_targets(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, bool read, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        fxs_targets here = frames[i].targets;
        plane of_host[PLANES], of_device[PLANES];
        planes_of(&here, of_host);
        planes_of(&cuda->device_frames[i].targets, of_device);
        for (int k = 0; k < PLANES && !error; k++) {
            const fxs_image *to = read ? of_device[k].image : of_host[k].image;
            const fxs_image *from = read ? of_host[k].image : of_device[k].image;
            if (of_host[k].read == read && to->pixels)
                error = copy_image(to, from, of_host[k].pixel_bytes * (size_t)frames[i].camera.width,
                                   (size_t)frames[i].camera.height, why);
        }
    }
    return error;
}

/* Begins a call of fxs_cuda_render: waits until the call before the last has ended, as its host memory is reused. */
int begin_call(fxs_cuda *cuda, fxs_message *why)
{
    const uint32_t next = (cuda->call_number + 1) % CALLS;
    int error = look(cuda, &cuda->calls[next], true, why);
    error = error ? error : look(cuda, last_call(cuda), false, why);
    cuda->call_number = next;
    cuda->frame_count = 0;
    cuda->turn++;
    last_call(cuda)->chunks.used = last_call(cuda)->chunks.count = 0;
    return error;
}

/* Uploads chunks that the frames' scenes in parts lack, in the order of the stream, so that earlier frames are not
   disturbed. */
int put_chunks_wanted(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, cudaStream_t stream,
                      fxs_message *why)
{
    const scene_table *scenes = &cuda->scenes;
    upload *u = &last_call(cuda)->chunks;
    int error = 0;
    u->most = larger_of(scenes->upload_bytes ? scenes->upload_bytes / 64 * 64 : UPLOAD_USUAL, scenes->place_most);
    for (uint32_t i = 0; i < count && !error; i++) {
        if (cuda->frames[i].in_parts)
            error = reserve_host(&u->memory, u->most + u->most / sizeof(fxs_chunk) * sizeof(uint32_t), why);
        for (uint32_t k = 0; k < frames[i].count && cuda->frames[i].in_parts && !error; k++) {
            const fxs_scene *scene = fxs_object_at(frames[i].objects, k)->scene;
            error = scene->places ? put_wanted(find_scene(scenes, scene), u, stream, why) : 0;
        }
    }
    return error;
}

int check_arguments(const fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                    fxs_message *why)
{
    if (!cuda || !frames || !options || count < 1 || count > FXS_CUDA_BATCH || !options_valid(options))
        return failed(why, FXS_ERR_ARGUMENT, "an argument is null or out of range");
    bool paired = !cuda->stereo || count % 2 == 0;
    for (uint32_t i = 0; i < count && cuda->stereo && paired; i += 2)
        paired = frames[i].objects == frames[i + 1].objects && frames[i].count == frames[i + 1].count;
    return paired ? 0 : failed(why, FXS_ERR_ARGUMENT, "a frame lacks its other eye, or the eyes' objects differ");
}

}

int fxs_cuda_name(int device, char *name, size_t size, fxs_message *why)
{
    cudaDeviceProp properties;
    int count = 0, error = check(why, cudaGetDeviceCount(&count));
    if (!error && (device < 0 || device >= count))
        return failed(why, FXS_ERR_DEVICE, "no such CUDA device");
    error = error ? error : check(why, cudaGetDeviceProperties(&properties, device));
    if (!error && size)
        copy_text(name, size, properties.name);
    return error;
}

int fxs_cuda_create(fxs_cuda **out, int device, uint64_t max_memory, uint32_t slots, fxs_message *why)
{
    char name[1];
    void *memory;
    if (out)
        *out = nullptr;
    if (!out || slots < 1 || slots > SLOTS)
        return failed(why, FXS_ERR_ARGUMENT, "slots: expected 1 to 16");
    int error = fxs_cuda_name(device, name, sizeof name, why);
    if (error)
        return error;
    on_device scope(device);
    error = check(why, cudaHostAlloc(&memory, sizeof(fxs_cuda), cudaHostAllocDefault));
    if (error)
        return error;
    fxs_cuda *cuda = (fxs_cuda *)memset(memory, 0, sizeof(fxs_cuda));
    cuda->device = device;
    cuda->memory.most = max_memory;
    cuda->slot_count = slots;
    error = renderer_init(cuda, why);
    if (error)
        fxs_cuda_destroy(cuda);
    else
        *out = cuda;
    return error;
}

void fxs_cuda_destroy(fxs_cuda *cuda)
{
    if (!cuda)
        return;
    on_device scope(cuda->device);
    wait(cuda, nullptr);
    free_slots(cuda);
    for (uint32_t i = 0; i < cuda->slot_count; i++)
        slot_close(&cuda->slots[i]);
    while (cuda->scenes.count)
        drop_scene(&cuda->scenes, &cuda->memory, copies_of(&cuda->scenes)->key);
    reserve(&cuda->memory, &cuda->pixels, 0, nullptr);
    cudaFreeHost(cuda->scenes.memory.data);
    cudaFreeHost(cuda->cut.data);
    for (const call &c : cuda->calls) {
        cudaFreeHost(c.staged.data);
        cudaFreeHost(c.chunks.memory.data);
        if (c.done)
            cudaEventDestroy(c.done);
    }
    for (cudaEvent_t event : {cuda->ready, cuda->began})
        if (event)
            cudaEventDestroy(event);
    cudaFreeHost(cuda);
}

int fxs_cuda_upload(fxs_cuda *cuda, const fxs_scene *scene, fxs_message *why)
{
    if (!cuda || !scene)
        return failed(why, FXS_ERR_ARGUMENT, "an argument is null");
    on_device scope(cuda->device);
    const int error = want_scene(&cuda->scenes, &cuda->memory, scene, why);
    return make_room(cuda, 0, error, why);
}

void fxs_cuda_forget(fxs_cuda *cuda, const fxs_scene *scene)
{
    if (!cuda)
        return;
    on_device scope(cuda->device);
    drop_scene(&cuda->scenes, &cuda->memory, scene);
    if (!cuda->scenes.count)
        free_slots(cuda);
}

void fxs_cuda_time(fxs_cuda *cuda, int on)
{
    cuda->timed = on;
}

void fxs_cuda_stereo(fxs_cuda *cuda, int on)
{
    cuda->stereo = on;
}

void fxs_cuda_stream(fxs_cuda *cuda, uint64_t pool_bytes, uint64_t upload_bytes)
{
    cuda->scenes.pool_bytes = pool_bytes;
    cuda->scenes.upload_bytes = upload_bytes;
}

int fxs_cuda_render(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                    void *stream, fxs_message *why)
{
    int error = check_arguments(cuda, frames, count, options, why);
    if (error)
        return error;
    on_device scope(cuda->device);
    cudaGetLastError();            /* clears a CUDA error that other code has left */
    error = begin_call(cuda, why);
    cuda->options = *options;
    error = error ? error : take_frames(cuda, frames, count, why);
    error = make_room(cuda, count, error, why);
    for (const call &c : cuda->calls)
        error = error ? error : check(why, cudaStreamWaitEvent((cudaStream_t)stream, c.done, 0));
    error = error ? error : put_chunks_wanted(cuda, frames, count, (cudaStream_t)stream, why);
    for (uint32_t i = 0; i < count && !error; i++)
        error = stage_frame(cuda, i, frames, why);
    if (error && last_call(cuda)->chunks.count)
        cudaStreamSynchronize((cudaStream_t)stream);
    if (error)
        return error;
    cuda->frame_count = count;
    const uint32_t used = slots_of(cuda, count);
    if (count > 1 && !error)
        error = check(why, cudaEventRecord(cuda->ready, (cudaStream_t)stream));
    for (uint32_t i = 0; i < used; i++) {
        slot *s = &cuda->slots[i];
        s->on = count > 1 ? s->stream : (cudaStream_t)stream;
        if (count > 1 && !error)
            error = check(why, cudaStreamWaitEvent(s->on, cuda->ready, 0));
    }
    cuda->began_marked = false;
    for (uint32_t i = 0; i < count && !error; i++)
        error = start_frame(cuda, i, why);
    for (uint32_t i = 0; i < used && count > 1 && !error; i++)
        error = check(why, cudaStreamWaitEvent((cudaStream_t)stream, cuda->slots[i].done, 0));
    error = error ? error : check(why, cudaEventRecord(last_call(cuda)->done, (cudaStream_t)stream));
    last_call(cuda)->count = error ? 0 : count;
    return error ? end_frames(cuda, error) : 0;
}

int fxs_cuda_finish(fxs_cuda *cuda, fxs_cuda_stats *stats, fxs_message *why)
{
    if (!cuda || !cuda->frame_count)
        return failed(why, FXS_ERR_ARGUMENT, "no frame is under way");
    on_device scope(cuda->device);
    cudaGetLastError();            /* clears a CUDA error that other code has left */
    int error = wait(cuda, why);
    if (!error && cuda->damaged)
        error = failed(why, FXS_ERR_SCENE, fxs_strerror(FXS_ERR_SCENE));
    cuda->damaged = false;
    cuda->milliseconds = error ? 0 : milliseconds_of(cuda);
    if (!error && stats)
        stats_of(cuda, stats);
    return end_frames(cuda, error);
}

int fxs_cuda_render_host(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                         fxs_cuda_stats *stats, fxs_message *why)
{
    int error = check_arguments(cuda, frames, count, options, why);
    if (error)
        return error;
    on_device scope(cuda->device);
    cudaGetLastError();            /* clears a CUDA error that other code has left */
    for (uint32_t i = 0; i < count && !error; i++) {
        frame checked;
        error = take_frame(&checked, &frames[i], options, why);
        cuda->device_frames[i] = frames[i];
    }
    if (error)
        return error;
    error = reserve(&cuda->memory, &cuda->pixels, place_targets(cuda->device_frames, count, nullptr), why);
    if (error)
        return error;
    for (uint32_t i = 0; i < count; i++)
        cuda->device_frames[i].targets = frames[i].targets;
    place_targets(cuda->device_frames, count, cuda->pixels.data);
    error = copy_targets(cuda, frames, count, true, why);
    /* The frames do not use CUDA's default stream, because it would block other renderers. Their own stream first waits
       for the copies to the device, which the default stream makes. */
    error = error ? error : check(why, cudaEventRecord(cuda->ready, nullptr));
    error = error ? error : check(why, cudaStreamWaitEvent(cuda->slots[0].stream, cuda->ready, 0));
    error = error ? error : fxs_cuda_render(cuda, cuda->device_frames, count, options, cuda->slots[0].stream, why);
    error = error ? error : fxs_cuda_finish(cuda, stats, why);
    return error ? error : copy_targets(cuda, frames, count, false, why);
}
