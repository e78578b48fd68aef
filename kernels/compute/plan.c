/* Plans a frame of the compute back ends: memory layout, dispatches, and growth of the lists. */
#include "plan.h"
#include "src/core/sized.h"
#include "src/core/memory.h"
#include "src/core/chunk.h"
#include "src/core/stereo.h"
#include "src/core/targets.h"
#include "src/core/tile_rates.h"

enum { TABLE_WORDS = FXS_OPACITY_LAWS * 256 / 2, HEADER_BYTES = 128, SPLAT_BYTES = 32, ENTRY_BYTES = 4,
       FIRST_MERGES = 8 };

/* A range of one object's drawn chunks, with all their Gaussians in one GPU buffer. */
typedef struct span {
    uint32_t object, first_place, end_place, part;
} span;

int fxs_plan_say(fxs_message *why, int error, const char *text, const char *what)
{
    const char *parts[] = {text, what};
    size_t used = 0;
    for (int i = 0; i < 2; i++) {
        size_t length = strlen(parts[i]), room = sizeof why->text - 1 - used;
        length = length < room ? length : room;
        memcpy(why->text + used, parts[i], length);
        used += length;
    }
    why->text[used] = 0;
    for (char *c = why->text; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
    why->bytes_needed = 0;
    return error;
}

uint32_t fxs_plan_finishes(const char *device)
{
    static const char with[] = "llvmpipe";
    return strncmp(device, with, sizeof with - 1) ? 1 : FXS_PLAN_FINISHES;
}

static int said(fxs_message *why, int error)
{
    return error ? fxs_plan_say(why, error, fxs_strerror(error), "") : 0;
}

static int too_large(fxs_message *why, const char *remedy, uint64_t bytes)
{
    fxs_plan_say(why, FXS_ERR_MEMORY, "the frame takes more than a storage buffer of this device can hold", remedy);
    why->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

uint32_t fxs_plan_part_chunks(const fxs_scene *scene, uint64_t most, fxs_message *why)
{
    const uint32_t chunks = fxs_scene_chunks(scene), palette = fxs_palette_bytes(scene);
    const uint64_t room = most > palette ? (most - palette) / (scene->chunk_bytes + !scene->chunk_bytes) : 0;
    if (!room || (uint64_t)chunks * HEADER_BYTES > most) {
        too_large(why, "", (uint64_t)chunks * (HEADER_BYTES + scene->chunk_bytes));
        return 0;
    }
    return room < UINT32_MAX ? (uint32_t)room : UINT32_MAX;
}

static uint64_t two_pieces(const fxs_scene *scene, uint64_t at, uint32_t first, uint32_t end, uint64_t size,
                           const unsigned char *leaves, const unsigned char *nodes, fxs_piece *pieces)
{
    const uint32_t leaf_end = end < scene->chunk_count ? end : scene->chunk_count;
    if (first < leaf_end) {
        pieces[0] = (fxs_piece){leaves + first * size, (leaf_end - first) * size, at};
        at += pieces[0].bytes;
        first = leaf_end;
    }
    if (first < end) {
        pieces[1] = (fxs_piece){nodes + (first - scene->chunk_count) * size, (end - first) * size, at};
        at += pieces[1].bytes;
    }
    return at;
}

uint64_t fxs_plan_pieces(const fxs_scene *scene, uint32_t part_chunks, int64_t part, fxs_piece pieces[3])
{
    const uint32_t chunks = fxs_scene_chunks(scene), palette = fxs_palette_bytes(scene);
    memset(pieces, 0, 3 * sizeof *pieces);
    if (part < 0)
        return two_pieces(scene, 0, 0, chunks, HEADER_BYTES, scene->chunks, scene->node_chunks, pieces);
    const uint32_t first = (uint32_t)part * part_chunks;
    const uint32_t end = chunks - first < part_chunks ? chunks : first + part_chunks;
    pieces[2] = (fxs_piece){scene->palette, palette, 0};
    return two_pieces(scene, palette, first, end, scene->chunk_bytes, scene->rows, scene->node_rows, pieces);
}

uint64_t fxs_plan_place_at(const fxs_scene *scene, uint32_t part_chunks, uint32_t place)
{
    return fxs_palette_bytes(scene) + place % part_chunks * (uint64_t)scene->chunk_bytes;
}

static int count_objects(fxs_plan *p)
{
    const fxs_request *r = p->request;
    uint64_t chunks = 0;
    int error = r->eyes < 1 || r->eyes > FXS_COMPUTE_EYES || (!r->objects && r->count) ? FXS_ERR_ARGUMENT
                : r->count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    p->gaussians = 0;
    for (uint32_t i = 0; i < r->count && !error; i++) {
        fxs_object object;
        error = fxs_object_read(&object, r->objects, i);
        error = error ? error : fxs_object_check(&object);
        chunks += error ? 0 : object.scene->chunk_count;
        p->gaussians += error ? 0 : object.scene->count;
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    p->places = (uint32_t)chunks;
    p->cut_room = error ? 0 : fxs_cut_room(r->objects, r->count, &r->options);
    return error;
}

static uint64_t objects_bytes(uint32_t count)
{
    return (count * (uint64_t)sizeof(fxs_object_view) + 63) / 64 * 64;
}

static uint64_t parts_bytes(uint32_t count)
{
    return (count * (uint64_t)sizeof(uint32_t) + 63) / 64 * 64;
}

/* Returns the bytes of the list of chunks seen in a window. With a cut, the list overwrites what the cut needed. */
static uint64_t seen_bytes(uint32_t places)
{
    return places * (uint64_t)(sizeof(fxs_drawn) + sizeof(uint32_t));
}

size_t fxs_plan_memory(const fxs_request *request)
{
    fxs_plan p = {.request = request};
    if (count_objects(&p))
        return 0;
    const uint64_t bytes = 64 + objects_bytes(request->count * request->eyes) + 2 * parts_bytes(request->count) +
                           (p.cut_room ? fxs_cut_bytes(p.cut_room, request->count, request->eyes)
                                       : seen_bytes(p.places));
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

static int check_targets(const fxs_targets *t, const fxs_camera *camera)
{
    const int error = fxs_targets_check(t, camera->width, camera->height);
    return error ? error
           : t->format > FXS_FORMAT_RGBA16_COVERAGE ? FXS_ERR_UNSUPPORTED
           : t->colour.pixels || t->coverage.pixels || t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels
               ? 0 : FXS_ERR_TARGET;
}

static int place_objects(fxs_plan *p, uint32_t eye)
{
    const fxs_request *r = p->request;
    fxs_object_view *views = p->objects + eye * r->count;
    uint32_t chunks = 0;
    int error = fxs_view_init(&p->views[eye], &r->cameras[eye], &r->options);
    error = error ? error : check_targets(&r->targets[eye], &r->cameras[eye]);
    error = error ? error : fxs_rates_check(&r->targets[eye].rates, &p->views[eye]);
    for (uint32_t i = 0; i < r->count && !error; i++) {
        fxs_object object;
        error = fxs_object_read(&object, r->objects, i);
        error = error ? error : fxs_object_view_init(&views[i], &p->views[eye], &r->cameras[eye], &object);
        views[i].first_chunk = chunks;
        chunks += fxs_cut_chunks(object.scene, p->cut_room != 0);
        views[i].end_chunk = chunks;
    }
    return error;
}

/* Finds the index of each drawn chunk on the device. The places of a scene in parts may change before the frame is
   laid out. */
static void find_indices(fxs_plan *p, uint32_t *indices)
{
    const fxs_object_view *o = p->objects;
    for (uint32_t i = 0; i < p->places; i++) {
        while (p->drawn[i].chunk >= o->end_chunk)
            o++;
        const uint32_t chunk = p->drawn[i].chunk - o->first_chunk;
        indices[i] = o->scene.places ? o->scene.places[chunk] : chunk;
    }
    p->indices = indices;
}

static int choose_chunks(fxs_plan *p, void *memory)
{
    fxs_cut cut = {.objects = p->request->objects, .object_count = p->request->count,
                   .options = &p->request->options, .cameras = p->request->cameras, .eyes = p->request->eyes,
                   .views = p->objects, .room = p->cut_room, .memory = memory};
    const int error = fxs_cut_find(&cut);
    p->drawn = cut.drawn;
    p->places = cut.count;
    p->missing = cut.missing;
    if (!error)
        find_indices(p, memory);   /* overwrites what the cut needed, but not its result */
    return error;
}

static int is_stopped(const fxs_plan *p)
{
    const fxs_stop *stop = &p->request->options.stop;
    return stop->call && stop->call(stop->argument);
}

int fxs_plan_begin(fxs_plan *p, const fxs_request *request, void *memory, fxs_message *why)
{
    const fxs_options *o = &request->options;
    unsigned char *parts = (unsigned char *)memory + objects_bytes(request->count * request->eyes);
    memset(p, 0, sizeof *p);
    p->request = request;
    int error = o->sh_degree < 0 || o->sh_degree > 3 || (unsigned)o->cutoff > FXS_CUTOFF_SQUARE ? FXS_ERR_ARGUMENT : 0;
    error = error ? error : count_objects(p);
    error = error || request->eyes == 1 ? error : fxs_stereo_check(request);
    p->objects = memory;
    p->part_chunks = (uint32_t *)(void *)parts;
    p->part_counts = (uint32_t *)(void *)(parts + parts_bytes(request->count));
    for (uint32_t eye = 0; eye < request->eyes && !error; eye++)
        error = place_objects(p, eye);
    parts += 2 * parts_bytes(request->count);
    if (!error && p->cut_room)
        error = choose_chunks(p, parts);
    p->seen = (fxs_drawn *)(void *)(parts + p->cut_room * sizeof *p->indices);
    p->all = p->drawn;
    p->all_indices = p->indices;
    p->all_places = p->places;
    p->size[0] = p->views->width;
    p->size[1] = p->views->height;
    return said(why, !error && is_stopped(p) ? FXS_ERR_STOPPED : error);
}

static uint32_t chunk_of(const fxs_plan *p, uint32_t place)
{
    return p->drawn ? p->drawn[place].chunk : place;
}

static int is_in_parts(const fxs_plan *p, uint32_t object)
{
    return p->objects[object].scene.places != 0;
}

/* Advances *s to the next span, a range of one object's drawn chunks. *s is zeros at first. Returns 0 after the last
   span. The chunks of a scene in parts lie in the buffers of its pool in any order, so each buffer has a span of all
   the object's drawn chunks. */
static int next_span(const fxs_plan *p, span *s)
{
    uint32_t place = s->end_place;
    if (place && is_in_parts(p, s->object) && s->part + 1 < p->part_counts[s->object]) {
        s->part++;
        return 1;
    }
    if (place >= p->places)
        return 0;
    while (chunk_of(p, place) >= p->objects[s->object].end_chunk)
        s->object++;
    const fxs_object_view *object = &p->objects[s->object];
    const uint32_t part_chunks = is_in_parts(p, s->object) ? UINT32_MAX : p->part_chunks[s->object];
    s->first_place = place;
    s->part = (chunk_of(p, place) - object->first_chunk) / part_chunks;
    const uint64_t part_end = object->first_chunk + (uint64_t)(s->part + 1) * part_chunks;
    const uint32_t end = part_end < object->end_chunk ? (uint32_t)part_end : object->end_chunk;
    if (!p->drawn)
        place = end;
    while (place < p->places && chunk_of(p, place) < end)
        place++;
    s->end_place = place;
    return 1;
}

static void split(uint32_t out[2], uint64_t x)
{
    out[0] = (uint32_t)x;
    out[1] = (uint32_t)(x >> 32);
}

static void fill_view(fxs_compute_object *o, const fxs_stage_view *v)
{
    const uint64_t x = (uint64_t)v->tiles_x * FXS_TILE, y = (uint64_t)v->tiles_y * FXS_TILE;
    split(o->near_q32, (uint64_t)v->near_q32);
    split(o->dilation_q30, ((x * x + y * y) << 30) / 14400);
    for (int i = 0; i < 3; i++) {
        split(o->position_q32[i], (uint64_t)v->position_q32[i]);
        split(o->eye_q32[i], (uint64_t)v->eye_q32[i]);
        memcpy(o->rotation_q30[i], v->rotation_q30 + 3 * i, 3 * sizeof(int32_t));
    }
    for (int i = 0; i < 2; i++) {
        memcpy(o->row_q15[i], v->row_q15[i], sizeof v->row_q15[i]);
        memcpy(o->forward_q15[i], v->forward_q15[i], sizeof v->forward_q15[i]);
        o->f_q12[i] = (int32_t)(i ? v->fy_q12 : v->fx_q12);
        o->c_q12[i] = (int32_t)(i ? v->cy_q12 : v->cx_q12);
        o->slope_low_q23[i] = v->slope_low_q23[i];
        o->slope_high_q23[i] = v->slope_high_q23[i];
        o->edge_low_q23[i] = v->edge_low_q23[i];
        o->edge_high_q23[i] = v->edge_high_q23[i];
    }
    o->focal_q32 = v->focal_q32;
    o->focal_exponent = v->focal_exponent;
    o->veil_exponent = v->veil_exponent;
    o->jacobian_exponent = v->jacobian_exponent;
    o->offset_q11 = v->offset_q11;
    o->degree = v->sh_degree;
    o->antialiased = v->antialiased;
    o->orthographic = v->orthographic;
    o->plane_exponent = v->plane_exponent;
}

static void fill_motion(fxs_compute_object *o, const fxs_motion_rows *motion)
{
    o->motion_at = motion->at / 4;
    o->motion_degree = motion->degree;
    o->motion_cut_q16 = motion->cut_q16;
    o->motion_flags = (motion->turns ? FXS_COMPUTE_TURNS : 0u) | (motion->fades ? FXS_COMPUTE_FADES : 0u);
}

static void fill_object(fxs_compute_object *o, const fxs_plan *p, uint32_t eye, const span *s, uint32_t number)
{
    const fxs_object_view *view = &p->objects[eye * p->request->count + s->object];
    const fxs_scene *scene = &view->scene;
    memset(o, 0, sizeof *o);
    fill_view(o, &view->view);
    o->profile = scene->profile;
    o->scene_degree = scene->sh_degree;
    o->chunk_words = scene->chunk_bytes / 4;
    o->palette_entries = scene->palette ? scene->palette_entries : 0;
    o->palette_step_q19 = (int32_t)scene->palette_step_q19;
    o->scale_mantissa = view->scale.mantissa;
    o->scale_exponent = view->scale.exponent;
    o->plain = view->plain;
    memcpy(o->tint_q13, view->tint_q13, sizeof view->tint_q13);
    o->crop_count = view->crop_count;
    o->keep_count = view->keep_count;
    o->first_chunk = view->first_chunk;
    o->first_place = s->first_place;
    o->end_place = s->end_place;
    o->span = number;
    o->part_chunk = s->part * p->part_chunks[s->object];
    o->part_chunks = p->part_chunks[s->object];
    o->rows_at = fxs_palette_bytes(scene) / 4;
    fill_motion(o, &view->motion);
    for (uint32_t i = 0; i < view->crop_count; i++) {
        const fxs_crop *crop = &view->crops[i];
        for (int k = 0; k < 3; k++) {
            split(o->crops[i] + 2 * k, (uint64_t)crop->low_q32[k]);
            split(o->crops[i] + 6 + 2 * k, (uint64_t)crop->high_q32[k]);
        }
        o->crops[i][12] = crop->outside != 0;
    }
}

int fxs_plan_moves(const fxs_plan *p)
{
    int moving = 0;
    for (uint32_t i = 0; i < p->request->count; i++)
        moving |= p->objects[i].scene.motion != 0;
    return moving;
}

static uint32_t larger(uint64_t a, uint64_t b)
{
    const uint64_t x = a > b ? a : b;
    return x < UINT32_MAX ? (uint32_t)x : UINT32_MAX;
}

static uint64_t slots_of(const fxs_plan *p)
{
    return p->drawn ? (uint64_t)p->places * FXS_CHUNK : p->gaussians;
}

/* Returns the least number of entries for a frame whose lists do not fit: twice the longest possible list of a tile,
   and the bounds of each half of a chunk. */
static uint64_t least_entries(uint64_t slots, uint64_t places)
{
    return 2 * slots + 4 * places + FXS_COMPUTE_PAGE;
}

/* A frame that lacks chunks gets room for all chunks of its budget: a scene that is being read draws more chunks from
   frame to frame. */
static void guess_rooms(const fxs_plan *p, fxs_plan_rooms *r)
{
    const int is_whole = p->drawn == p->all;
    const uint64_t places = p->missing && p->request->options.budget && is_whole ? p->cut_room : p->places;
    const uint64_t slots = p->drawn ? places * FXS_CHUNK : p->gaussians;
    const uint64_t of_squares = p->views->cutoff == FXS_CUTOFF_SQUARE ? slots : 0;
    r->chunks = larger(r->chunks, places + 1);
    r->larges = larger(r->larges, of_squares + slots / 16 + 4096);
    r->pages = larger(r->pages, (least_entries(slots, places) + 65536) / FXS_COMPUTE_PAGE);
    r->merges = r->merges ? r->merges : FIRST_MERGES;
}

static uint32_t words_at(uint64_t *used, uint64_t words)
{
    const uint64_t at = *used;
    *used += (words + 15) / 16 * 16;
    return (uint32_t)at;
}

static uint32_t plane_at(uint64_t *used, const fxs_image *image, uint64_t words)
{
    return image->pixels ? words_at(used, words) : FXS_NOTHING;
}

/* Returns the bytes of an eye's uniforms: of its frame and of each span. */
static uint32_t uniforms_bytes(const fxs_plan *p)
{
    return FXS_COMPUTE_STRIDE * (p->frames->spans + 1);
}

/* Returns log2 of a tile's side. Tiles have 8x8 pixels if Gaussians outnumber pixels and are hence small, else
   16x16. A frame with rates has 16x16, so that a tile with rate 2 is one patch of 8x8 samples. */
static uint32_t tile_bits(const fxs_plan *p, const fxs_plan_rooms *r, uint64_t pixels)
{
    const int boxes_have_room = pixels < (uint64_t)FXS_MAX_SIZE * FXS_MAX_SIZE;  /* see LARGE_BOX */
    int large = !boxes_have_room || p->views->cutoff == FXS_CUTOFF_SQUARE || r->whole_tiles;
    for (uint32_t eye = 0; eye < p->request->eyes; eye++)
        large |= p->request->targets[eye].rates.pixels != 0;
    return slots_of(p) > pixels && !large ? 3 : 4;
}

static void lay_out_stages(fxs_plan *p, const fxs_plan_rooms *r, uint32_t eye, uint64_t pixels, uint64_t *words)
{
    const fxs_targets *t = &p->request->targets[eye];
    fxs_compute_frame *f = &p->frames[eye];
    f->occluder = plane_at(words, &t->occluder, pixels);
    f->backdrop = plane_at(words, &t->backdrop, pixels);
    uint64_t bin = *words, sort = *words;
    f->boxes = words_at(&bin, 2 * (uint64_t)FXS_CHUNK * r->chunks);
    f->squares = words_at(&bin, p->views->cutoff == FXS_CUTOFF_SQUARE ? 2 * (uint64_t)FXS_CHUNK * r->chunks : 0);
    f->larges = words_at(&bin, (uint64_t)FXS_COMPUTE_LARGE * r->larges);
    f->spare = words_at(&sort, (uint64_t)FXS_COMPUTE_PAGE * r->pages);
    uint64_t picture = bin > sort ? bin : sort;
    p->read_at[eye] = picture;
    f->colour = plane_at(&picture, &t->colour, pixels * (t->format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1));
    f->coverage = plane_at(&picture, &t->coverage, pixels);
    f->mean_depth = plane_at(&picture, &t->mean_depth, pixels);
    f->median_depth = plane_at(&picture, &t->median_depth, pixels);
    f->id = plane_at(&picture, &t->id, 2 * pixels);
    p->read_words[eye] = picture - p->read_at[eye];
    *words = picture;
}

static uint64_t macros_of(const fxs_plan *p)
{
    const int32_t side = FXS_RATE_PIXELS;
    return (uint64_t)((p->size[0] + side - 1) / side) * (uint64_t)((p->size[1] + side - 1) / side);
}

static uint32_t at_most(uint32_t room, uint32_t most)
{
    return most && most < room ? most : room;
}

static void lay_out_eye(fxs_plan *p, const fxs_plan_rooms *r, uint32_t eye)
{
    const fxs_targets *t = &p->request->targets[eye];
    const fxs_stage_view *view = &p->views[eye];
    fxs_compute_frame *f = &p->frames[eye];
    const uint64_t pixels = (uint64_t)p->size[0] * (uint64_t)p->size[1];
    uint64_t words = TABLE_WORDS;
    span s = {0, 0, 0, 0};
    for (f->spans = 0; next_span(p, &s); f->spans++)
        ;
    memcpy(f->size, p->size, sizeof f->size);
    memcpy(f->first, p->first, sizeof f->first);
    f->whole[0] = view->width;
    f->whole[1] = view->height;
    f->tile_bits = tile_bits(p, r, pixels);
    for (int k = 0; k < 2; k++)
        f->tiles[k] = (f->size[k] + (1 << f->tile_bits) - 1) >> f->tile_bits;
    const uint64_t tiles = (uint64_t)f->tiles[0] * (uint64_t)f->tiles[1];
    f->places = p->places;
    f->merges = at_most(r->merges, r->most_merges);
    f->large_room = at_most(r->larges, r->most_larges);
    f->page_room = at_most(r->pages, r->most_pages);
    f->scratch = r->pages * FXS_COMPUTE_PAGE;
    f->finishes = r->finishes ? r->finishes : 1;
    f->spans_at = words_at(&words, FXS_COMPUTE_SPAN * ((uint64_t)f->spans + 1));
    f->drawn = p->drawn ? words_at(&words, FXS_COMPUTE_DRAWN * (uint64_t)r->chunks) : 0;
    f->moments = fxs_plan_moves(p) ? words_at(&words, FXS_COMPUTE_MOMENT * (uint64_t)r->chunks) : 0;
    for (uint32_t i = 0; i < p->request->eyes; i++) {      /* the table is the same in the memory of both eyes */
        const uint32_t rates = plane_at(&words, &p->request->targets[i].rates, macros_of(p));
        f->rates = i == eye ? rates : f->rates;
    }
    f->ranks = words_at(&words, r->chunks / 32 + 1);
    f->visible = words_at(&words, r->chunks);
    f->records = words_at(&words, (uint64_t)FXS_COMPUTE_RECORD * r->chunks);
    f->depths = words_at(&words, (uint64_t)FXS_CHUNK * r->chunks);
    lay_out_stages(p, r, eye, pixels, &words);
    f->seen = (uint32_t)(FXS_COMPUTE_TILES + FXS_COMPUTE_LIST * tiles);
    f->cleared = f->classes = f->seen + r->chunks / 32 + 1;
    f->blocks = (uint32_t)(f->classes + FXS_COMPUTE_CLASSES * tiles);
    f->block_room = (uint32_t)(tiles + (uint64_t)r->pages * (FXS_COMPUTE_PAGE / FXS_COMPUTE_BLOCK));
    f->cutoff = (int32_t)view->cutoff;
    f->cut_q11 = view->cut_q11;
    f->format = t->format;
    for (int i = 0; i < 3; i++)
        f->background_q13[i] = fxs_is_premultiplied(t->format)
                                   ? 0 : fxs_background_q13(p->request->options.background[i]);
    f->depth_bits = fxs_depth_bits(t);
    p->bytes[FXS_COMPUTE_UNIFORMS] = p->request->eyes * (uint64_t)uniforms_bytes(p);
    p->bytes[FXS_COMPUTE_MEMORY] = 4 * words > p->bytes[FXS_COMPUTE_MEMORY] ? 4 * words : p->bytes[FXS_COMPUTE_MEMORY];
    p->bytes[FXS_COMPUTE_COUNTS] = 4 * (f->blocks + 2 * (uint64_t)f->block_room);
    p->bytes[FXS_COMPUTE_SPLATS] = (uint64_t)FXS_CHUNK * SPLAT_BYTES * r->chunks;
    p->bytes[FXS_COMPUTE_ENTRIES] = (uint64_t)FXS_COMPUTE_PAGE * ENTRY_BYTES * r->pages;
    p->bytes[FXS_COMPUTE_ARGUMENTS] = 16 * ((uint64_t)f->spans + 2);
    p->bytes[FXS_COMPUTE_LATER] = 16 * (4 + FXS_PLAN_FINISHES + FXS_PLAN_MERGES);
    p->bytes[FXS_COMPUTE_DOWNLOAD] += 4 * (FXS_COMPUTE_STATUS + p->read_words[eye]);
}

static void lay_out(fxs_plan *p, const fxs_plan_rooms *r)
{
    p->bytes[FXS_COMPUTE_MEMORY] = p->bytes[FXS_COMPUTE_DOWNLOAD] = 0;
    for (uint32_t eye = 0; eye < p->request->eyes; eye++)
        lay_out_eye(p, r, eye);
}

static uint64_t largest_buffer(const fxs_plan *p)
{
    uint64_t largest = 0;
    for (int i = 0; i < FXS_COMPUTE_BUFFERS; i++)
        largest = p->bytes[i] > largest ? p->bytes[i] : largest;
    return largest;
}

/* Names the remedy: fewer Gaussians or fewer pixels. */
static int frame_too_large(const fxs_plan *p, const fxs_plan_rooms *r, fxs_message *why)
{
    char text[21], *digit = text + sizeof text - 1;
    uint64_t most = (r->most / (FXS_CHUNK * SPLAT_BYTES) - 1) * FXS_CHUNK;
    fxs_message number, budget;
    *digit = 0;
    do
        *--digit = (char)('0' + most % 10);
    while (most /= 10);
    fxs_plan_say(&number, 0, ": set a budget of at most ", digit);
    fxs_plan_say(&budget, 0, number.text, " Gaussians");
    return too_large(why, p->bytes[FXS_COMPUTE_SPLATS] > r->most ? budget.text : ": draw a smaller picture",
                     largest_buffer(p));
}

/* Lays out a window with the capacities of earlier frames. If these are too large, tries the capacities that the window
   itself needs, then these with large tiles. Returns 0 if none fit. */
static int fits(fxs_plan *p, fxs_plan_rooms *rooms)
{
    fxs_plan_rooms tried = *rooms;
    for (int i = 0; i < 3; i++) {
        guess_rooms(p, &tried);
        lay_out(p, &tried);
        if (largest_buffer(p) <= rooms->most) {
            *rooms = tried;
            return 1;
        }
        tried.chunks = tried.larges = tried.pages = 0;
        tried.whole_tiles |= i == 1;
    }
    return 0;
}

/* Lays out a window, if need be without room for its lists: then the device draws it without lists. */
static int fits_somehow(fxs_plan *p, fxs_plan_rooms *rooms)
{
    fxs_plan_rooms least = *rooms;
    if (fits(p, rooms))
        return 1;
    least.whole_tiles = 1;
    least.chunks = p->places + 1;
    least.larges = 1;
    least.pages = (uint32_t)(least_entries(slots_of(p), p->places) / FXS_COMPUTE_PAGE);
    lay_out(p, &least);
    return largest_buffer(p) <= rooms->most;
}

int fxs_plan_lay_out(fxs_plan *p, fxs_plan_rooms *rooms, fxs_message *why)
{
    return fits_somehow(p, rooms) ? 0 : frame_too_large(p, rooms, why);
}

/* Returns 1 if an eye may see a chunk in the window, 0 if not, or FXS_ERR_SCENE. */
static int sees(const fxs_plan *p, const fxs_object_view *object, const fxs_drawn *drawn)
{
    fxs_stage_view view = object->view;
    fxs_chunk_view cv;
    if (!object->visible)
        return 0;
    fxs_view_of_window(&view, p->first, p->size);
    view.grow_q16 = drawn->grow_q8 << 8;
    return fxs_chunk_view_init(&cv, &view, &object->scene, drawn->chunk - object->first_chunk);
}

/* Sets the plan's window, and the chunks that an eye may see in it. */
static int choose_window(fxs_plan *p, const int32_t first[2], const int32_t size[2])
{
    uint32_t *indices = (uint32_t *)(void *)(p->seen + p->all_places), object = 0;
    memcpy(p->first, first, sizeof p->first);
    memcpy(p->size, size, sizeof p->size);
    p->drawn = p->seen;
    p->indices = indices;
    p->places = 0;
    for (uint32_t i = 0; i < p->all_places; i++) {
        const fxs_drawn drawn = p->all ? p->all[i] : (fxs_drawn){.chunk = i, .share_q8 = 256};
        int seen = 0;
        while (drawn.chunk >= p->objects[object].end_chunk)
            object++;
        for (uint32_t eye = 0; eye < p->request->eyes && !seen; eye++)
            seen = sees(p, &p->objects[eye * p->request->count + object], &drawn);
        if (seen < 0)
            return seen;
        p->seen[p->places] = drawn;
        indices[p->places] = p->all ? p->all_indices[i] : drawn.chunk - p->objects[object].first_chunk;
        p->places += (uint32_t)seen;
    }
    return 0;
}

typedef struct windows {
    fxs_plan *plan;
    fxs_plan_rooms *rooms;
    fxs_window_fn *draw;           /* null: only looks if all windows fit */
    void *argument;
} windows;

static int draw_windows(const windows *w, const int32_t first[2], const int32_t size[2], fxs_message *why)
{
    fxs_plan *p = w->plan;
    const int axis = size[1] > size[0], least = size[axis] <= FXS_RATE_PIXELS;
    const int32_t half = (size[axis] / 2 + FXS_RATE_PIXELS - 1) / FXS_RATE_PIXELS * FXS_RATE_PIXELS;
    int32_t from[2] = {first[0], first[1]}, of[2] = {size[0], size[1]};
    int error = w->draw && (first[0] || first[1]) && is_stopped(p) ? FXS_ERR_STOPPED : choose_window(p, first, size);
    if (error)
        return said(why, error);
    if (least ? fits_somehow(p, w->rooms) : fits(p, w->rooms))
        return w->draw ? w->draw(w->argument, why) : 0;
    if (least)
        return frame_too_large(p, w->rooms, why);
    of[axis] = half;
    error = draw_windows(w, from, of, why);
    from[axis] += half;
    of[axis] = size[axis] - half;
    return error ? error : draw_windows(w, from, of, why);
}

int fxs_plan_draw(fxs_plan *p, fxs_plan_rooms *rooms, fxs_window_fn *draw, void *argument, fxs_message *why)
{
    const int32_t first[2] = {0, 0}, size[2] = {p->size[0], p->size[1]};
    windows w = {p, rooms, 0, argument};
    if (fits(p, rooms))
        return draw(argument, why);
    const int error = draw_windows(&w, first, size, why);
    w.draw = draw;
    return error ? error : draw_windows(&w, first, size, why);
}

void fxs_plan_uniforms(const fxs_plan *p, void *to)
{
    for (uint32_t eye = 0; eye < p->request->eyes; eye++) {
        unsigned char *bytes = (unsigned char *)to + eye * uniforms_bytes(p);
        span s = {0, 0, 0, 0};
        memcpy(bytes, &p->frames[eye], sizeof p->frames[eye]);
        for (uint32_t i = 0; next_span(p, &s); i++) {
            fxs_compute_object object;
            fill_object(&object, p, eye, &s, i);
            memcpy(bytes + FXS_COMPUTE_STRIDE * (i + 1), &object, sizeof object);
        }
    }
}

size_t fxs_plan_places_bytes(const fxs_plan *p)
{
    return 4 * (size_t)(p->frames->ranks - p->frames->spans_at);
}

static void put_rates(const fxs_plan *p, uint32_t eye, uint32_t *shift)
{
    const int32_t width = p->views[eye].width, height = p->views[eye].height, side = FXS_RATE_PIXELS;
    for (int32_t y = 0; y < p->size[1]; y += side)
        for (int32_t x = 0; x < p->size[0]; x += side)
            *shift++ = (uint32_t)fxs_rate_shift(&p->request->targets[eye].rates, width, height, p->first[0] + x,
                                                p->first[1] + y);
}

static void put_moment(const fxs_moment *m, uint32_t words[FXS_COMPUTE_MOMENT])
{
    words[0] = (uint16_t)m->power_q15[0] | (uint32_t)(uint16_t)m->power_q15[1] << 16;
    words[1] = (uint16_t)m->power_q15[2] | (uint32_t)(uint8_t)m->shift << 16;
}

void fxs_plan_places(const fxs_plan *p, uint32_t *to)
{
    const fxs_compute_frame *f = p->frames;
    span s = {0, 0, 0, 0};
    for (uint32_t i = 0; next_span(p, &s); i++) {
        uint32_t *words = to + FXS_COMPUTE_SPAN * i;
        words[0] = s.first_place;
        words[1] = s.end_place;
        words[4] = p->objects[s.object].id;
        words[5] = p->objects[s.object].first_chunk;
    }
    to[FXS_COMPUTE_SPAN * f->spans] = 0;
    to[FXS_COMPUTE_SPAN * f->spans + 1] = f->places;
    for (uint32_t i = 0; i < p->places && p->drawn; i++) {
        uint32_t *words = to + (f->drawn - f->spans_at) + FXS_COMPUTE_DRAWN * (size_t)i;
        words[0] = p->indices[i];
        words[1] = p->drawn[i].share_q8 | (uint32_t)p->drawn[i].grow_q8 << 16;
        words[2] = p->drawn[i].chunk;
    }
    for (uint32_t i = 0; i < p->places && f->moments; i++)
        put_moment(&p->drawn[i].moment, to + (f->moments - f->spans_at) + FXS_COMPUTE_MOMENT * (size_t)i);
    for (uint32_t eye = 0; eye < p->request->eyes; eye++)
        if (p->frames[eye].rates != FXS_NOTHING)
            put_rates(p, eye, to + (p->frames[eye].rates - f->spans_at));
}

static const int32_t buffers_of[FXS_COMPUTE_PROGRAMS][4] = {
#define NONE FXS_PLAN_NONE
#define OF(program, a, b, c, d) [FXS_COMPUTE_##program] = {a, b, c, d},
    OF(clear_counts, NONE, NONE, FXS_COMPUTE_COUNTS, NONE)
    OF(locate_chunks, FXS_PLAN_HEADS, FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, NONE)
    OF(gather_chunks, FXS_COMPUTE_ARGUMENTS, FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, NONE)
    OF(animate_chunk, FXS_PLAN_ROWS, FXS_COMPUTE_MEMORY, NONE, FXS_COMPUTE_SPLATS)
    OF(project_chunk, FXS_PLAN_ROWS, FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, FXS_COMPUTE_SPLATS)
    OF(start_lists, FXS_COMPUTE_ARGUMENTS, NONE, FXS_COMPUTE_COUNTS, NONE)
    OF(fill_lists, FXS_COMPUTE_LATER, FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES)
    OF(fill_large, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES)
#define OF_LISTS(program) OF(program, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_MEMORY, NONE)
    OF_LISTS(sort_blocks) OF_LISTS(merge_runs)
    OF(blend_tiles, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY)
    OF(trace_tiles, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY)
    OF(clear_pixels, FXS_COMPUTE_COUNTS, NONE, NONE, FXS_COMPUTE_MEMORY)
    OF(bound_slots, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY)
    OF(finish_tiles, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY)
    OF(finish_traced, FXS_COMPUTE_COUNTS, FXS_COMPUTE_ENTRIES, FXS_COMPUTE_SPLATS, FXS_COMPUTE_MEMORY)
    OF(name_pixels, NONE, FXS_COMPUTE_MEMORY, NONE, NONE)
};

static fxs_step step_of(uint32_t program)
{
    fxs_step step = {.program = program, .waits = 1, .arguments = FXS_PLAN_NONE};
    memcpy(step.buffers, buffers_of[program], sizeof step.buffers);
    return step;
}

static fxs_step direct(uint32_t program, uint64_t groups)
{
    fxs_step step = step_of(program);
    step.groups[0] = (uint32_t)(groups < FXS_COMPUTE_ROW ? groups : FXS_COMPUTE_ROW);
    step.groups[1] = (uint32_t)((groups + FXS_COMPUTE_ROW - 1) / FXS_COMPUTE_ROW);
    return step;
}

static fxs_step indirect(uint32_t program, int32_t arguments, uint32_t number)
{
    fxs_step step = step_of(program);
    step.arguments = arguments;
    step.arguments_at = 16 * number;
    return step;
}

static uint64_t groups_of(uint64_t threads)
{
    return (threads + FXS_COMPUTE_THREADS - 1) / FXS_COMPUTE_THREADS;
}

typedef struct steps {
    const fxs_plan *plan;
    fxs_step_fn *step;
    void *argument;
} steps;

static void do_step(const steps *to, uint32_t eye, fxs_step one)
{
    one.eye = eye;
    one.frame = eye * uniforms_bytes(to->plan);
    one.uniform += one.uniform ? one.frame : 0;
    to->step(to->argument, &one);
}

/* Does a step for each eye. One barrier serves both eyes. */
static void do_both(const steps *to, fxs_step one)
{
    for (uint32_t eye = 0; eye < to->plan->request->eyes; eye++, one.waits = 0)
        do_step(to, eye, one);
}

static void do_spans(const steps *to, uint32_t program)
{
    const fxs_plan *p = to->plan;
    span s = {0, 0, 0, 0};
    uint32_t waits = 1;
    for (uint32_t i = 0; next_span(p, &s); i++) {
        const int repeats = s.part && is_in_parts(p, s.object);
        if (!p->objects[s.object].visible || (program == FXS_COMPUTE_locate_chunks && repeats) ||
            (program == FXS_COMPUTE_animate_chunk && !p->objects[s.object].scene.motion))
            continue;
        fxs_step one = program == FXS_COMPUTE_locate_chunks
                           ? direct(program, groups_of(s.end_place - s.first_place / 32 * 32))
                           : indirect(program, FXS_COMPUTE_ARGUMENTS, i);
        one.waits = waits;
        one.uniform = FXS_COMPUTE_STRIDE * (i + 1);
        one.object = s.object;
        one.part = s.part;
        do_both(to, one);
        waits = 0;
    }
}

/* Does a step for each eye, by the program of the eye's targets. */
static void do_by_targets(const steps *to, uint32_t blended, uint32_t traced, uint32_t number)
{
    for (uint32_t eye = 0; eye < to->plan->request->eyes; eye++) {
        const int is_traced = fxs_targets_traced(&to->plan->request->targets[eye]);
        fxs_step one = indirect(is_traced ? traced : blended, FXS_COMPUTE_LATER, number);
        one.waits = eye == 0;
        do_step(to, eye, one);
    }
}

static void do_picture(const steps *to)
{
    const fxs_plan *p = to->plan;
    const uint64_t pixels = (uint64_t)p->frames->size[0] * (uint64_t)p->frames->size[1];
    do_by_targets(to, FXS_COMPUTE_blend_tiles, FXS_COMPUTE_trace_tiles, 0);
    fxs_step clear = indirect(FXS_COMPUTE_clear_pixels, FXS_COMPUTE_LATER, 2 + FXS_PLAN_MERGES);
    clear.waits = 0;
    do_both(to, clear);
    do_both(to, indirect(FXS_COMPUTE_bound_slots, FXS_COMPUTE_LATER, 3 + FXS_PLAN_MERGES));
    for (uint32_t i = 0; i < to->plan->frames->finishes; i++)
        do_by_targets(to, FXS_COMPUTE_finish_tiles, FXS_COMPUTE_finish_traced, 4 + FXS_PLAN_MERGES + i);
    for (uint32_t eye = 0; eye < p->request->eyes; eye++)
        if (p->frames[eye].id != FXS_NOTHING)
            do_step(to, eye, direct(FXS_COMPUTE_name_pixels, groups_of(pixels)));
}

void fxs_plan_steps(const fxs_plan *p, fxs_step_fn *step, void *argument)
{
    const steps to = {p, step, argument};
    const fxs_compute_frame *f = p->frames;
    do_both(&to, direct(FXS_COMPUTE_clear_counts, groups_of(f->cleared)));
    do_spans(&to, FXS_COMPUTE_locate_chunks);
    do_both(&to, direct(FXS_COMPUTE_gather_chunks, 1));
    do_spans(&to, FXS_COMPUTE_animate_chunk);
    do_spans(&to, FXS_COMPUTE_project_chunk);
    do_both(&to, direct(FXS_COMPUTE_start_lists, (uint64_t)f->tiles[1]));
    do_both(&to, indirect(FXS_COMPUTE_fill_lists, FXS_COMPUTE_ARGUMENTS, f->spans));
    fxs_step large = indirect(FXS_COMPUTE_fill_large, FXS_COMPUTE_ARGUMENTS, f->spans + 1);
    large.waits = 0;
    do_both(&to, large);
    do_both(&to, indirect(FXS_COMPUTE_sort_blocks, FXS_COMPUTE_LATER, 1));
    for (uint32_t i = 0; i < f->merges; i++)
        do_both(&to, indirect(FXS_COMPUTE_merge_runs, FXS_COMPUTE_LATER, 2 + i));
    do_picture(&to);
}

static uint32_t merges_of(uint32_t longest)
{
    uint32_t merges = 0;
    while ((uint64_t)FXS_COMPUTE_BLOCK << merges < longest)
        merges++;
    return merges;
}

/* Returns the capacity of later frames. A capacity grows when more than 7/8 of it are used. */
static uint32_t room_ahead(uint32_t room, uint32_t used, uint64_t most)
{
    const uint64_t wanted = (uint64_t)used + used / 4;
    return used <= room - room / 8 ? room : larger(room, wanted < most ? wanted : most);
}

int fxs_plan_look(fxs_plan_rooms *r, const uint32_t *status, uint32_t eyes, fxs_message *why)
{
    uint32_t used[FXS_COMPUTE_STATUS] = {0};
    for (uint32_t i = 0; i < eyes * FXS_COMPUTE_STATUS; i++)
        used[i % FXS_COMPUTE_STATUS] = larger(used[i % FXS_COMPUTE_STATUS], status[i]);
    const uint32_t merges = merges_of(used[FXS_COMPUTE_LONGEST]) + 1;
    r->larges = room_ahead(r->larges, used[FXS_COMPUTE_LARGES], r->most / (4 * 4 * FXS_COMPUTE_LARGE));
    r->pages = room_ahead(r->pages, used[FXS_COMPUTE_PAGES], r->most / (2 * FXS_COMPUTE_PAGE * ENTRY_BYTES));
    r->merges = merges < r->merges ? r->merges - 1 : merges < FXS_PLAN_MERGES ? merges : FXS_PLAN_MERGES;
    return used[FXS_COMPUTE_DAMAGED] ? said(why, FXS_ERR_SCENE) : 0;
}

void fxs_plan_put_plane(const fxs_plan *p, const fxs_image *image, void *to)
{
    const size_t row = 4 * (size_t)p->size[0];
    for (int32_t y = 0; y < p->size[1]; y++)
        memcpy((unsigned char *)to + (size_t)y * row, fxs_image_at(image, p->first[0], p->first[1] + y, 4), row);
}

/* Copies one plane of a finished picture, such as colours or depths, to an image with `bytes` bytes per pixel. The
   plane has one or two 32-bit words per pixel. */
static void copy_plane(const fxs_plan *p, const fxs_image *to, int bytes, const uint32_t *picture, uint64_t at)
{
    const size_t width = (size_t)p->size[0];
    if (!to->pixels)
        return;
    for (int32_t y = 0; y < p->size[1]; y++) {
        unsigned char *row = fxs_image_at(to, p->first[0], p->first[1] + y, bytes);
        const unsigned char *from = (const unsigned char *)(picture + at) + (size_t)y * width * (bytes > 4 ? 8 : 4);
        if (bytes >= 4)
            memcpy(row, from, width * (size_t)bytes);
        else
            for (size_t x = 0; x < width; x++)
                memcpy(row + x * (size_t)bytes, from + 4 * x, (size_t)bytes);
    }
}

void fxs_plan_take_pictures(const fxs_plan *p, const uint32_t *picture)
{
    for (uint32_t eye = 0; eye < p->request->eyes; picture += p->read_words[eye++]) {
        const fxs_targets *t = &p->request->targets[eye];
        const fxs_compute_frame *f = &p->frames[eye];
        const uint64_t first = p->read_at[eye];
        copy_plane(p, &t->colour, fxs_pixel_bytes(t->format), picture, f->colour - first);
        copy_plane(p, &t->coverage, 1, picture, f->coverage - first);
        copy_plane(p, &t->mean_depth, 4, picture, f->mean_depth - first);
        copy_plane(p, &t->median_depth, 4, picture, f->median_depth - first);
        copy_plane(p, &t->id, 8, picture, f->id - first);
    }
}

void fxs_plan_stats(const fxs_plan *p, fxs_stats *stats)
{
    stats->gaussians = (uint32_t)p->gaussians;
    stats->drawn = p->all_places * FXS_CHUNK;
    stats->missing = p->missing;
    stats->bands += p->request->eyes;
    stats->runs = stats->bands;
}

void fxs_plan_count(fxs_stats *stats, const uint32_t *status, uint32_t eyes)
{
    for (uint32_t eye = 0; eye < eyes; eye++, status += FXS_COMPUTE_STATUS) {
        stats->visible += status[FXS_COMPUTE_VISIBLE];
        stats->entries += (uint64_t)status[FXS_COMPUTE_ENTRY_COUNT + 1] << 32 | status[FXS_COMPUTE_ENTRY_COUNT];
    }
}
