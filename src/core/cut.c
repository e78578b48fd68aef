/* Chooses the chunks that a frame draws from the level-of-detail trees of its objects. A chunk has 256 Gaussians; a
 * node's chunk is a coarse version of its children.
 *
 * The search starts at the roots and opens the node with the largest key: replaces it by its children. The key measures
 * the error that this removes. The search ends at the first node that exceeds the budget. Skipping that node for a
 * smaller one would make levels flip when the camera moves.
 *
 * To avoid popping, the nodes opened last fade: they are drawn together with their children. A node that draws a share
 * s changes its opacities to 1 - (1 - opacity)^s. A 64th of the budget is reserved for fading nodes. */
#include "animate.h"
#include "cut.h"
#include "sized.h"

#include <fixsplat/internal/fixed.h>
#include "memory.h"
#include "sight.h"

#define FADING 64u
#define VISITS 4u
#define MORE_VISITS 64u

typedef struct visit {
    uint32_t chunk, object;
    uint32_t parent;               /* index of the parent node in `visits`; FXS_NOTHING for a root */
    fxs_sight sight;
    uint32_t share_q8;             /* share of the optical depth that the chunk and its descendants draw together */
    uint8_t opened;
    uint8_t short_of;              /* 1: a child that must be drawn is not loaded */
    uint8_t needed;
    uint8_t absent;
    uint8_t hidden;                /* 1: the chunk is not loaded, or an ancestor is drawn in its place */
    fxs_moment moment;
} visit;

/* The time of an object, and its chunks if it has no level-of-detail tree. */
typedef struct whole_object {
    const fxs_scene *scene;
    uint32_t chunks;
    int32_t time_q16;
} whole_object;

typedef struct search {
    fxs_cut *cut;
    visit *visits;
    uint32_t *heap;                /* tree nodes that may be opened (replaced by their children), largest key first */
    uint32_t *opened;
    uint32_t visit_count, heap_count, opened_count;
    uint32_t drawn, most_drawn;
    uint32_t visit_room;
    fxs_fading fading;
    fxs_stage_view *views;         /* `eyes` views of each object */
    whole_object of;               /* object whose tree is searched */
    uint32_t of_number;
    int full, error;
} search;

uint64_t fxs_cut_bytes(uint32_t room, uint32_t object_count, uint32_t eyes)
{
    const uint64_t visits = VISITS * (uint64_t)room + MORE_VISITS;
    return (uint64_t)object_count * eyes * sizeof(fxs_stage_view) + visits * (sizeof(visit) + 2 * sizeof(uint32_t)) +
           room * (uint64_t)sizeof(fxs_drawn);
}

uint32_t fxs_cut_room(const fxs_object *objects, uint32_t count, const fxs_options *options)
{
    uint64_t least = 0, most = 0, gaussians = 0;
    int trees = 0, in_part = 0;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_scene *scene = fxs_object_at(objects, i)->scene;
        trees |= scene->nodes != 0;
        in_part |= scene->places || scene->motion;
        least += scene->nodes ? 1 : fxs_most_alive(scene);
        most += scene->nodes && !scene->motion ? fxs_scene_chunks(scene) : fxs_most_alive(scene);
        gaussians += scene->count;
    }
    const int limited = options->budget && options->budget < gaussians;
    if (in_part && (!limited || !trees))
        return (uint32_t)most;
    if (!trees || (!limited && !options->detail_q8))
        return 0;
    if (limited && options->budget / FXS_CHUNK < most)
        most = options->budget / FXS_CHUNK;
    return (uint32_t)(most < least ? least : most);
}

/* Orders tree nodes by descending key, then by ascending object and chunk. */
static int is_before(const search *s, uint32_t a, uint32_t b)
{
    const visit *v = &s->visits[a], *w = &s->visits[b];
    return v->sight.key_q8 != w->sight.key_q8 ? v->sight.key_q8 > w->sight.key_q8
           : v->object != w->object ? v->object < w->object : v->chunk < w->chunk;
}

static void push(search *s, uint32_t number)
{
    uint32_t at = s->heap_count++;
    for (; at > 0 && is_before(s, number, s->heap[(at - 1) / 2]); at = (at - 1) / 2)
        s->heap[at] = s->heap[(at - 1) / 2];
    s->heap[at] = number;
}

static uint32_t pop(search *s)
{
    const uint32_t top = s->heap[0], last = s->heap[--s->heap_count];
    uint32_t at = 0;
    for (uint32_t child = 1; child < s->heap_count; child = 2 * at + 1) {
        child += child + 1 < s->heap_count && is_before(s, s->heap[child + 1], s->heap[child]);
        if (!is_before(s, s->heap[child], last))
            break;
        s->heap[at] = s->heap[child];
        at = child;
    }
    s->heap[at] = last;
    return top;
}

int fxs_cut_views(const fxs_cut *cut, fxs_stage_view *views)
{
    int error = 0;
    for (uint32_t eye = 0; eye < cut->eyes && !error; eye++) {
        fxs_stage_view world;
        error = fxs_view_init(&world, &cut->cameras[eye], cut->options);
        for (uint32_t i = 0; i < cut->object_count && !error; i++) {
            fxs_object_view view;
            fxs_object object;
            error = fxs_object_read(&object, cut->objects, i);
            error = error ? error : fxs_object_view_init(&view, &world, &cut->cameras[eye], &object);
            fxs_view_of_whole(&view.view, &cut->cameras[eye]);
            views[i * cut->eyes + eye] = view.view;
        }
    }
    return error;
}

static uint32_t whole_chunks(const fxs_cut *cut, uint32_t object)
{
    const fxs_scene *scene = fxs_object_at(cut->objects, object)->scene;
    return scene->nodes ? 0 : scene->chunk_count;
}

static int whole_of(whole_object *out, const fxs_cut *cut, uint32_t number)
{
    fxs_object object;
    fxs_motion_header motion;
    int error = fxs_object_read(&object, cut->objects, number);
    if (error)
        return error;
    *out = (whole_object){object.scene, whole_chunks(cut, number), 0};
    if (!object.scene->motion || (error = fxs_motion_read(&motion, object.scene)) != 0)
        return error;
    /* unsigned, so that the sum of two times may wrap */
    out->time_q16 = fxs_time_of(&motion, (int64_t)((uint64_t)cut->options->time_q32 + (uint64_t)object.time_q32));
    return 0;
}

/* Returns 1 if a chunk is drawn or wanted, 0, or FXS_ERR_SCENE. */
static int is_alive(const whole_object *w, uint32_t chunk, fxs_moment *moment)
{
    *moment = (fxs_moment){{0, 0, 0}, 0, 0};
    return w->scene->motion ? fxs_moment_of(moment, w->scene, chunk, w->time_q16) : 1;
}

static void visit_chunk(search *s, uint32_t object, uint32_t chunk, uint32_t parent)
{
    const fxs_cut *cut = s->cut;
    fxs_sight sight;
    fxs_moment moment;
    if (!s->error && object != s->of_number)
        s->error = whole_of(&s->of, cut, s->of_number = object);
    int found = s->error ? s->error : is_alive(&s->of, chunk, &moment);
    if (found > 0)
        found = fxs_see(&sight, s->views + object * cut->eyes, cut->eyes, s->of.scene, chunk, cut->options->detail_q8);
    s->error = found < 0 ? found : 0;
    if (found <= 0)
        return;
    if (s->visit_count == s->visit_room) {
        s->full = 1;
        return;
    }
    if (parent != FXS_NOTHING)
        fxs_see_below(&sight, &s->visits[parent].sight);
    s->visits[s->visit_count++] = (visit){.chunk = chunk, .object = object, .parent = parent, .sight = sight,
                                          .moment = moment};
    if (fxs_is_openable(&sight))
        push(s, s->visit_count - 1);
    s->drawn++;
}

static void open_node(search *s, uint32_t number)
{
    const visit *v = &s->visits[number];
    const fxs_scene *scene = fxs_object_at(s->cut->objects, v->object)->scene;
    const uint32_t object = v->object;
    fxs_node node;
    s->error = fxs_node_read(&node, scene, v->chunk - scene->chunk_count);
    s->opened[s->opened_count++] = number;
    s->drawn -= fxs_drawn_no_more(&v->sight);
    for (int i = 0; i < 2 && !s->error; i++)
        visit_chunk(s, object, node.children[i], number);
}

/* Opens the tree node with the largest key: replaces it by its children. Returns 0 if no node is left or the budget is
   spent. */
static int open_next(search *s)
{
    const uint32_t visits = s->visit_count, opened = s->opened_count;
    if (!s->heap_count)
        return 0;
    const uint32_t number = pop(s);
    s->fading.last_key_q8 = s->visits[number].sight.key_q8;
    open_node(s, number);
    if (!s->full && !s->error && s->drawn <= s->most_drawn)
        return 1;
    s->visit_count = visits;
    s->opened_count = opened;
    s->drawn = s->most_drawn;
    return 0;
}

/* Sets the range of keys in which tree nodes fade into their children. Unused budget shortens the range, so that fading
   ends gradually. */
static void find_fade(search *s, uint32_t room)
{
    const uint32_t left = s->drawn < s->most_drawn ? s->most_drawn - s->drawn : 0, opened = s->opened_count;
    const uint32_t count = left < room ? room - left : 0;
    s->fading.width_q8 = 0;
    if (count && count < opened)
        s->fading.width_q8 = s->visits[s->opened[opened - 1 - count]].sight.key_q8 - s->fading.last_key_q8;
    else if (count)
        s->fading.width_q8 = FXS_FADE_MOST_Q8;
    s->fading.width_q8 = fxs_min(s->fading.width_q8, FXS_FADE_MOST_Q8);
}

static void sink(fxs_drawn *heap, uint32_t at, uint32_t count)
{
    const fxs_drawn entry = heap[at];
    for (uint32_t child; (child = 2 * at + 1) < count; at = child) {
        child += child + 1 < count && heap[child + 1].chunk > heap[child].chunk;
        if (heap[child].chunk <= entry.chunk)
            break;
        heap[at] = heap[child];
    }
    heap[at] = entry;
}

static void sort_by_chunk(fxs_drawn *drawn, uint32_t count)
{
    for (uint32_t i = count / 2; i-- > 0;)
        sink(drawn, i, count);
    while (count-- > 1) {
        const fxs_drawn last = drawn[0];
        drawn[0] = drawn[count];
        drawn[count] = last;
        sink(drawn, 0, count);
    }
}

static int is_there(const fxs_scene *scene, uint32_t chunk)
{
    return !scene->places || scene->places[chunk] != FXS_NOTHING;
}

static void want(search *s, const fxs_scene *scene, uint32_t chunk)
{
    const fxs_options *o = s->cut->options;
    const int there = is_there(scene, chunk);
    s->cut->missing += !there;
    if (o->want.call && scene->places)
        o->want.call(o->want.argument, scene, chunk, there);
}

static visit *parent_of(const search *s, const visit *v)
{
    return v->parent == FXS_NOTHING ? 0 : &s->visits[v->parent];
}

static void find_shares(search *s)
{
    for (uint32_t i = 0; i < s->opened_count; i++)
        s->visits[s->opened[i]].opened = 1;
    for (visit *v = s->visits; v < s->visits + s->visit_count; v++) {
        const visit *parent = parent_of(s, v);
        v->share_q8 = parent ? parent->share_q8 * fxs_faded_q8(&parent->sight, s->fading) >> 8 : 256;
    }
}

/* A tree node that fades is drawn together with its children. Returns the share of the optical depth that the node
   itself draws. */
static uint32_t own_share_q8(const search *s, const visit *v)
{
    return v->opened && !v->short_of ? v->share_q8 * (256 - fxs_faded_q8(&v->sight, s->fading)) >> 8 : v->share_q8;
}

/* Replaces each missing chunk by its nearest loaded ancestor in the tree, from the leaves up. Requests the chunks that
   the frame needs. */
static void find_missing(search *s)
{
    for (uint32_t i = s->visit_count; i-- > 0;) {
        visit *v = &s->visits[i], *parent = parent_of(s, v);
        v->needed = own_share_q8(s, v) > 0;
        v->absent = v->needed && !is_there(fxs_object_at(s->cut->objects, v->object)->scene, v->chunk);
        if (v->absent && parent)
            parent->short_of = 1;
    }
    for (uint32_t i = 0; i < s->visit_count; i++)
        if (s->visits[i].needed)
            want(s, fxs_object_at(s->cut->objects, s->visits[i].object)->scene, s->visits[i].chunk);
}

static void list_drawn(search *s)
{
    fxs_cut *cut = s->cut;
    find_shares(s);
    find_missing(s);
    for (visit *v = s->visits; v < s->visits + s->visit_count; v++) {
        const visit *parent = parent_of(s, v);
        v->hidden = v->absent || (parent && (parent->hidden || parent->short_of));
        if (v->needed && !v->hidden) {
            cut->drawn[cut->count] = fxs_drawn_of(cut->views[v->object].first_chunk + v->chunk,
                                                  own_share_q8(s, v), v->sight.swell_q8);
            cut->drawn[cut->count++].moment = v->moment;
        }
    }
    sort_by_chunk(cut->drawn, cut->count);
}

/* Adds all chunks of the objects without a level-of-detail tree to the drawn chunks, in place from the back of the
   array. If the scene has changed and more chunks are alive than there is room for, returns FXS_ERR_SCENE. */
static int add_whole(fxs_cut *cut)
{
    uint32_t from = cut->count, to = from;
    fxs_moment moment;
    whole_object w = {0, 0, 0};
    for (uint32_t i = 0; i < cut->object_count; i++) {
        int error = whole_of(&w, cut, i);
        for (uint32_t k = 0; k < w.chunks && error >= 0; k++)
            if (is_there(w.scene, k) && (error = is_alive(&w, k, &moment)) > 0)
                to++;
        if (error < 0)
            return error;
    }
    if (to > cut->room)
        return FXS_ERR_SCENE;
    cut->count = to;
    for (uint32_t i = cut->object_count; i-- > 0 && to > from;) {
        const uint32_t first = cut->views[i].first_chunk;
        const int error = whole_of(&w, cut, i);
        while (from && cut->drawn[from - 1].chunk >= first)
            cut->drawn[--to] = cut->drawn[--from];
        for (uint32_t k = w.chunks; k-- > 0 && !error;)
            if (is_there(w.scene, k) && is_alive(&w, k, &moment) > 0) {
                if (to == from)
                    return FXS_ERR_SCENE;
                cut->drawn[--to] = (fxs_drawn){first + k, 256, 0, moment};
            }
    }
    return to == from ? 0 : FXS_ERR_SCENE;
}

static void begin(search *s)
{
    const fxs_cut *cut = s->cut;
    for (uint32_t i = 0; i < cut->object_count && !s->error; i++) {
        const fxs_scene *scene = fxs_object_at(cut->objects, i)->scene;
        fxs_moment moment;
        whole_object w = {0, 0, 0};
        s->error = whole_of(&w, cut, i);
        for (uint32_t k = 0; k < w.chunks && !s->error; k++) {
            const int alive = is_alive(&w, k, &moment);
            if (alive > 0)
                want(s, scene, k);
            s->drawn += alive > 0;
            s->error = alive < 0 ? alive : 0;
        }
        if (scene->nodes && fxs_object_at(cut->objects, i)->visible)
            visit_chunk(s, i, scene->chunk_count, FXS_NOTHING);
    }
}

int fxs_cut_find(fxs_cut *cut)
{
    const uint32_t fading = cut->room / FADING;
    search s = {.cut = cut, .most_drawn = cut->room - fading, .visit_room = VISITS * cut->room + MORE_VISITS,
                .of_number = FXS_NOTHING};
    s.views = (fxs_stage_view *)cut->memory;
    s.visits = (visit *)(void *)(s.views + cut->object_count * cut->eyes);
    s.heap = (uint32_t *)(void *)(s.visits + s.visit_room);
    s.opened = s.heap + s.visit_room;
    cut->drawn = (fxs_drawn *)(void *)(s.opened + s.visit_room);
    cut->count = cut->missing = 0;
    s.error = fxs_cut_views(cut, s.views);
    begin(&s);
    while (!s.error && open_next(&s))
        ;
    if (s.error)
        return s.error;
    find_fade(&s, fading);
    list_drawn(&s);
    return add_whole(cut);
}
