/* The cut through the trees of a frame's objects: which chunks are drawn, coarse ones in place of all that lie below
 * them in the tree. Each tree begins with its root. The node whose children remove the most error for each Gaussian
 * that they add is opened next, until the first one that the budget has no room for. So the cut is a function of the
 * scenes, the camera and the options alone, and with a larger budget every part is drawn as finely or finer.
 *
 * The key of a node says what opening it removes, in log2:
 *
 *     key = gain + 2 log2(f / d) + 4 min(0, log2(sigma f / d) - log2(1/2))
 *
 * gain and sigma are the node's (packed.h), d is the distance of its box, f the focal length in pixels. The first two
 * terms are squared error times pixels. The third is what the pixels blur: the error of a merge has no mass and no
 * mean, so that little of it is left where it is smaller than a pixel.
 *
 * No part of a picture changes at once when a node opens. While its key is less than FADE above that of the last one,
 * the node is drawn with its children: first the children come, then the node goes. Both count towards the budget. */
#include <fixsplat/fixed.h>
#include "memory.h"
#include "parts.h"

#define FADE_Q8 96                 /* keys over which a node fades into its children */
#define BLUR 4                     /* powers of the size below BLURRED that the error falls with, */
#define BLURRED_Q8 (-256)          /* log2 of half a pixel */
#define KEY_BIAS (1 << 20)         /* makes keys positive; they are within +-2^18 */
#define VISITS 4u                  /* for each chunk that may be drawn, and MORE_VISITS */
#define MORE_VISITS 64u
#define UNLIMITED_Q8 (1 << 24)

/* A chunk that the camera sees and the cut has come to. */
typedef struct visit {
    uint32_t chunk, object;        /* the chunk in the object's scene */
    uint32_t parent;               /* its visit; FXS_NOTHING of a root */
    int32_t key_q8;                /* at most the parent's, */
    int32_t room_q8;               /* log2 of its size beyond the detail that is wanted: at most the parent's */
    int32_t offset_q11;            /* of its opacity, as its parent fades into it */
    uint8_t opened;
    uint8_t short_of;              /* something that is to be drawn in its place is not there */
    uint8_t absent;                /* its own rows are needed and not there */
    uint8_t hidden;                /* a chunk above takes its place */
} visit;

typedef struct cut {
    fxs_frame *f;
    visit *visits;
    uint64_t *heap;                /* of the visits that may be opened: key above, visit below; the largest key first */
    uint32_t *opened;              /* visits, in the order of their keys */
    uint32_t visit_count, heap_count, opened_count;
    uint32_t gone;                 /* the first so many of the opened ones have faded */
    uint32_t drawn, most_drawn;    /* chunks */
    uint32_t visit_room;
    int32_t last_key_q8;           /* of the first node that there is no room for */
    int full, error;
} cut;

uint64_t fxs_cut_bytes(uint32_t most_drawn)
{
    const uint64_t visits = VISITS * (uint64_t)most_drawn + MORE_VISITS;
    return visits * (sizeof(visit) + sizeof(uint64_t) + sizeof(uint32_t)) + most_drawn * (uint64_t)sizeof(fxs_drawn);
}

uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options)
{
    uint64_t least = 0, most = 0, gaussians = 0;
    int trees = 0, paged = 0;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_scene *scene = objects[i].scene;
        trees |= scene->nodes != 0;
        paged |= scene->places != 0;
        least += scene->nodes ? 1 : scene->chunk_count;
        most += fxs_scene_chunks(scene);
        gaussians += scene->count;
    }
    const int limited = options->budget && options->budget < gaussians;
    if (paged && (!limited || !trees))
        return (uint32_t)most;
    if (!trees || (!limited && !options->detail_q8))
        return 0;
    if (limited && options->budget / FXS_CHUNK < most)
        most = options->budget / FXS_CHUNK;
    return (uint32_t)(most < least ? least : most);
}

/* ---- Heap -------------------------------------------------------------------------------------------------------- */

static void push(uint64_t *heap, uint32_t *count, uint64_t key)
{
    uint32_t at = (*count)++;
    for (; at > 0 && heap[(at - 1) / 2] < key; at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = key;
}

static uint64_t pop(uint64_t *heap, uint32_t *count)
{
    const uint64_t top = heap[0], last = heap[--*count];
    uint32_t at = 0;
    for (uint32_t child = 1; child < *count; child = 2 * at + 1) {
        child += child + 1 < *count && heap[child + 1] > heap[child];
        if (heap[child] <= last)
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = last;
    return top;
}

/* ---- A node as a camera sees it ---------------------------------------------------------------------------------- */

/* log2 of the distance from the camera to the chunk's box, softened by an eighth of the box, in units. */
static int32_t log2_distance_q8(const fxs_view *view, const fxs_chunk *chunk)
{
    uint64_t parts[6], most = 1, square = 0;
    if (view->orthographic)
        return view->plane_exponent * 256;
    for (int i = 0; i < 3; i++) {
        const int64_t reach = (int64_t)chunk->step_q32[i] * 65535 << chunk->step_shift;
        const int64_t below = chunk->origin_q32[i] - view->position_q32[i], above = -below - reach;
        parts[i] = (uint64_t)(below > 0 ? below : above > 0 ? above : 0);
        parts[3 + i] = (uint64_t)reach / 8;
        most |= parts[i] | parts[3 + i];
    }
    const int bits = 64 - fxs_clz64(most), shift = bits > 30 ? bits - 30 : 0;
    for (int i = 0; i < 6; i++)
        square += (parts[i] >> shift) * (parts[i] >> shift);
    return (fxs_log2_q16(square | 1) >> 9) + (shift - 32) * 256;
}

/* Fills in the key and the size in pixels of a node, both log2. */
static void measure(const fxs_view *view, const fxs_chunk *chunk, const fxs_node *node, int32_t *key_q8,
                    int32_t *size_q8)
{
    const int64_t focal_q12 = view->fx_q12 > view->fy_q12 ? view->fx_q12 : view->fy_q12;
    const int32_t pixels_q8 = (fxs_log2_q16((uint64_t)focal_q12) >> 8) - 12 * 256 - log2_distance_q8(view, chunk);
    *size_q8 = node->size_q8 + pixels_q8;
    *key_q8 = node->gain_q8 + 2 * pixels_q8 + BLUR * fxs_min(0, *size_q8 - BLURRED_Q8);
}

/* Adds a chunk where an eye sees it. */
static void visit_chunk(cut *c, uint32_t object, uint32_t chunk, uint32_t parent)
{
    const fxs_frame *f = c->f;
    const fxs_scene *scene = &f->eye->objects[object].scene;
    visit v = {.chunk = chunk, .object = object, .parent = parent, .key_q8 = INT32_MIN, .room_q8 = INT32_MIN};
    fxs_chunk header;
    fxs_node node;
    int seen = 0;
    c->error = c->error ? c->error : fxs_chunk_read(&header, scene, chunk);
    if (!c->error && chunk >= scene->chunk_count)
        c->error = fxs_node_read(&node, scene, chunk - scene->chunk_count);
    for (const fxs_eye *eye = f->eye; eye < f->eye + f->eye_count && !c->error; eye++) {
        fxs_chunk_view cv;
        fxs_view view = eye->objects[object].view;
        int32_t key_q8, size_q8;
        fxs_view_of_whole(&view, &eye->camera);
        const int found = fxs_chunk_view_init(&cv, &view, scene, chunk);
        c->error = found < 0 ? found : 0;
        if (found <= 0)
            continue;
        seen = 1;
        if (chunk < scene->chunk_count)
            continue;
        measure(&view, &header, &node, &key_q8, &size_q8);
        v.key_q8 = key_q8 > v.key_q8 ? key_q8 : v.key_q8;
        v.room_q8 = size_q8 > v.room_q8 ? size_q8 : v.room_q8;
    }
    if (!seen || c->error)
        return;
    if (c->visit_count == c->visit_room) {
        c->full = 1;
        return;
    }
    v.room_q8 = f->options->detail_q8 ? v.room_q8 - ((fxs_log2_q16(f->options->detail_q8) >> 8) - 8 * 256) : UNLIMITED_Q8;
    if (parent != FXS_NOTHING) {
        v.key_q8 = fxs_min(v.key_q8, c->visits[parent].key_q8);
        v.room_q8 = fxs_min(v.room_q8, c->visits[parent].room_q8);
    }
    if (chunk >= scene->chunk_count && v.room_q8 > 0)
        push(c->heap, &c->heap_count, (uint64_t)(uint32_t)(v.key_q8 + KEY_BIAS) << 32 | c->visit_count);
    c->visits[c->visit_count++] = v;
    c->drawn++;
}

/* ---- The cut ----------------------------------------------------------------------------------------------------- */

static void open_node(cut *c, uint32_t number)
{
    const visit *v = &c->visits[number];
    const fxs_scene *scene = &c->f->eye->objects[v->object].scene;
    const uint32_t object = v->object;
    fxs_node node;
    c->error = fxs_node_read(&node, scene, v->chunk - scene->chunk_count);
    c->opened[c->opened_count++] = number;
    for (int i = 0; i < 2 && !c->error; i++)
        visit_chunk(c, object, node.children[i], number);
}

/* Opens the nodes with the largest key, all of them; or none, where there is no room. Returns whether it did. */
static int open_next(cut *c)
{
    const uint32_t visits = c->visit_count, opened = c->opened_count, key = c->heap_count ? (uint32_t)(c->heap[0] >> 32) : 0;
    c->last_key_q8 = c->heap_count ? (int32_t)key - KEY_BIAS : INT32_MIN / 2;
    if (!c->heap_count)
        return 0;
    while (c->heap_count && c->heap[0] >> 32 == key && !c->full && !c->error)
        open_node(c, (uint32_t)pop(c->heap, &c->heap_count));
    for (; c->gone < opened && c->visits[c->opened[c->gone]].key_q8 >= c->last_key_q8 + FADE_Q8; c->gone++)
        c->drawn -= c->visits[c->opened[c->gone]].room_q8 >= FADE_Q8;
    if (!c->full && !c->error && c->drawn <= c->most_drawn)
        return 1;
    c->visit_count = visits;
    c->opened_count = opened;
    return 0;
}

/* How far a node has faded into its children: 0 to 256. */
static int32_t faded_q8(const cut *c, const visit *v)
{
    const int32_t above_q8 = fxs_min(v->key_q8 - c->last_key_q8, v->room_q8);
    return fxs_clamp(above_q8, 0, FADE_Q8) * 256 / FADE_Q8;
}

static int32_t offset_of(int32_t opacity_q8)
{
    return opacity_q8 <= 0 ? FXS_FAINT_Q11 + 1 : fxs_offset_of_opacity_q11((uint32_t)fxs_min(opacity_q8, 256) << 8);
}

static void draw(cut *c, uint64_t *sorted, uint32_t *count, uint32_t object, uint32_t chunk, int32_t offset_q11)
{
    if (offset_q11 <= FXS_FAINT_Q11)
        push(sorted, count, (uint64_t)(c->f->eye->objects[object].first_chunk + chunk) << 32 | (uint32_t)offset_q11);
}

static int is_there(const fxs_scene *scene, uint32_t chunk)
{
    return !scene->places || scene->places[chunk] != FXS_NOTHING;
}

static void miss(cut *c, const fxs_scene *scene, uint32_t chunk)
{
    const fxs_options *o = c->f->options;
    c->f->stats.missing++;
    if (o->want)
        o->want(o->want_argument, scene, chunk);
}

/* From the leaves up: what is to be drawn and is not there is drawn by the nearest chunk above it that is. Then, what
   is needed most first, what is missing. */
static void find_missing(cut *c)
{
    for (uint32_t i = c->visit_count; i-- > 0;) {
        visit *v = &c->visits[i];
        const int needed = !v->opened || v->short_of || faded_q8(c, v) < 256;
        v->absent = needed && !is_there(c->f->objects[v->object].scene, v->chunk);
        if (v->absent && v->parent != FXS_NOTHING)
            c->visits[v->parent].short_of = 1;
    }
    for (uint32_t i = 0; i < c->visit_count; i++)
        if (c->visits[i].absent)
            miss(c, c->f->objects[c->visits[i].object].scene, c->visits[i].chunk);
}

/* Lists what is drawn in the order of the chunks. */
static void list_drawn(cut *c)
{
    fxs_frame *f = c->f;
    uint32_t count = 0;
    for (uint32_t i = 0; i < c->opened_count; i++)
        c->visits[c->opened[i]].opened = 1;
    find_missing(c);
    for (uint32_t i = 0; i < c->visit_count; i++) {
        visit *v = &c->visits[i];
        const visit *parent = v->parent == FXS_NOTHING ? 0 : &c->visits[v->parent];
        const int shown = v->opened && !v->short_of ? offset_of(512 - 2 * faded_q8(c, v)) : 0;
        v->hidden = v->absent || (parent && (parent->hidden || parent->short_of));
        v->offset_q11 = parent ? fxs_min(parent->offset_q11 + offset_of(2 * faded_q8(c, parent)), FXS_FAINT_Q11 + 1) : 0;
        if (!v->hidden)
            draw(c, c->heap, &count, v->object, v->chunk, v->offset_q11 + shown);
    }
    f->chunk_count = count;
    while (count) {
        const uint64_t last = pop(c->heap, &count);
        f->drawn[count] = (fxs_drawn){(uint32_t)(last >> 32), (int32_t)(uint32_t)last};
    }
}

/* Chunks of an object without a tree. */
static uint32_t whole_chunks(const fxs_frame *f, uint32_t object)
{
    const fxs_scene *scene = f->objects[object].scene;
    return scene->nodes ? 0 : scene->chunk_count;
}

/* What is drawn of objects without a tree: everything that is there. Merged from the back, as the chunks of trees lie
   in front. */
static void add_whole(fxs_frame *f)
{
    uint32_t from = f->chunk_count, to = from;
    for (uint32_t i = 0; i < f->object_count; i++)
        for (uint32_t k = 0; k < whole_chunks(f, i); k++)
            to += is_there(f->objects[i].scene, k) ? 1 : 0;
    f->chunk_count = to;
    for (uint32_t i = f->object_count; i-- > 0 && to > from;) {
        const uint32_t first = f->eye->objects[i].first_chunk;
        while (from && f->drawn[from - 1].chunk >= first)
            f->drawn[--to] = f->drawn[--from];
        for (uint32_t k = whole_chunks(f, i); k-- > 0;)
            if (is_there(f->objects[i].scene, k))
                f->drawn[--to] = (fxs_drawn){first + k, 0};
    }
}

int fxs_cut(fxs_frame *f)
{
    cut c = {.f = f, .most_drawn = f->chunk_count, .visit_room = VISITS * f->chunk_count + MORE_VISITS};
    c.heap = (uint64_t *)(void *)f->cut_memory;
    c.visits = (visit *)(void *)(c.heap + c.visit_room);
    c.opened = (uint32_t *)(void *)(c.visits + c.visit_room);
    f->drawn = (fxs_drawn *)(void *)(c.opened + c.visit_room);
    for (uint32_t i = 0; i < f->object_count && !c.error; i++) {
        const fxs_scene *scene = f->objects[i].scene;
        for (uint32_t k = 0; k < whole_chunks(f, i); k++)
            if (!is_there(scene, k))
                miss(&c, scene, k);
        if (!scene->nodes)
            c.drawn += scene->chunk_count;
        else if (f->objects[i].visible)
            visit_chunk(&c, i, scene->chunk_count, FXS_NOTHING);
    }
    while (!c.error && open_next(&c))
        ;
    if (c.error)
        return c.error;
    list_drawn(&c);
    add_whole(f);
    return 0;
}
