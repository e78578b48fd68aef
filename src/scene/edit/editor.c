/* Selects and deletes Gaussians of a packed scene. A lasso or a brush becomes a mask of pixels; a Gaussian is selected
   if the mask has the pixel of its projected centre. */
#include <fixsplat/internal/edits.h>

#include <math.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/select.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/crc32.h"
#include "src/base/try_internal.h"
#include "src/core/codes.h"

/* Flags of a slot. BEFORE: the Gaussian was selected before the last shape. */
enum { CHOSEN = 1, EMPTY = 2, BEFORE = 4 };
enum { REACH = 32 };

#define NEAR_DEFAULT 0.2

/* What a lasso or a brush selects: pixels, and with `front` the surface in them. What an object has: slots. */
typedef struct picture {
    uint8_t *mask;
    uint32_t *depths;
    uint8_t *objects;
} picture;

static unsigned char *rows_of(const fxs_editor *e, uint32_t chunk)
{
    return (unsigned char *)(uintptr_t)e->scene.rows + (size_t)chunk * e->scene.chunk_bytes;
}

static const unsigned char *header_of(const fxs_editor *e, uint32_t chunk)
{
    return e->scene.chunks + (size_t)chunk * sizeof(fxs_chunk);
}

static fxs_codes codes_of(const fxs_editor *e, uint32_t slot)
{
    return fxs_codes_of(&e->scene, rows_of(e, slot / FXS_CHUNK), slot % FXS_CHUNK);
}

static unsigned char *opacity_at(const fxs_editor *e, uint32_t slot)
{
    const uint32_t at = e->scene.profile == FXS_PROFILE_SMALL ? FXS_SMALL_A : FXS_ROW_COLOUR;
    return rows_of(e, slot / FXS_CHUNK) + at + 4 * (slot % FXS_CHUNK) + 3;
}

static int is_deleted(const fxs_edit_slot *s, uint32_t done)
{
    return s->edit && s->edit <= done;
}

int fxs_editor_deleted(const fxs_editor *e, uint32_t slot)
{
    return is_deleted(&e->slots[slot], e->done);
}

static int is_there(const fxs_editor *e, uint32_t slot)
{
    return !(e->slots[slot].flags & EMPTY) && !fxs_editor_deleted(e, slot);
}

uint32_t fxs_edit_checksum(const fxs_scene *scene)
{
    fxs_crc32_table table;
    uint32_t crc = 0;
    fxs_crc32_fill(&table);
    for (uint32_t i = 0; i < scene->chunk_count; i++)
        crc = fxs_crc32(&table, crc, scene->chunks + i * sizeof(fxs_chunk) + offsetof(fxs_chunk, checksum),
                        sizeof(uint32_t));
    return crc;
}

int fxs_editor_open(fxs_editor *e, const fxs_scene *scene, fxs_message *message)
{
    memset(e, 0, sizeof *e);
    if (scene->motion)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "a scene that moves is not edited by hand");
    e->scene = *scene;
    e->scene.nodes = NULL;
    e->count = scene->chunk_count * FXS_CHUNK;
    e->slots = fxs_allocate_zeroed(NULL, e->count, sizeof *e->slots);
    if (!e->slots)
        return fxs_fail_memory(message, NULL, (uint64_t)e->count * sizeof *e->slots);
    for (uint32_t i = 0; i < e->count; i++) {
        const fxs_codes codes = codes_of(e, i);
        const int is_full = codes.rotation || codes.colour >> 24;
        e->slots[i].opacity = (uint8_t)(codes.colour >> 24);
        e->slots[i].flags = is_full ? 0 : EMPTY;
        e->left += (uint32_t)is_full;
    }
    return 0;
}

void fxs_editor_close(fxs_editor *e)
{
    fxs_release(NULL, e->slots);
    memset(e, 0, sizeof *e);
}

static void place_of(const fxs_editor *e, uint32_t slot, int64_t place_q32[3])
{
    fxs_chunk chunk;
    memcpy(&chunk, header_of(e, slot / FXS_CHUNK), sizeof chunk);
    fxs_chunk_turn(&chunk);
    const fxs_codes codes = codes_of(e, slot);
    for (int i = 0; i < 3; i++)
        place_q32[i] = (int64_t)((uint64_t)chunk.origin_q32[i] +
                                 ((uint64_t)codes.position[i] * chunk.step_q32[i] << chunk.step_shift % 64));
}

/* Projects a place. Returns 1, its pixel and its depth, or 0 outside of the picture. In camera space, (x, y, z) is in
   the pixel floor(fx x / z + cx), floor(fy y / z + cy). */
static int project(const fxs_camera *c, const int64_t place_q32[3], size_t *pixel, double *depth)
{
    const double near = c->near_q32 ? (double)c->near_q32 * 0x1p-32 : NEAR_DEFAULT;
    double v[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            v[i] += (double)c->rotation_q30[3 * i + k] *
                    ((double)(int64_t)((uint64_t)place_q32[k] - (uint64_t)c->position_q32[k]) * 0x1p-62);
    const double unit = c->projection == FXS_ORTHOGRAPHIC ? 1 : v[2];
    if (!(v[2] > near))
        return 0;
    const double x = floor(c->fx_q12 * 0x1p-12 * v[0] / unit + c->cx_q12 * 0x1p-12);
    const double y = floor(c->fy_q12 * 0x1p-12 * v[1] / unit + c->cy_q12 * 0x1p-12);
    if (!(x >= 0 && x < c->width && y >= 0 && y < c->height))
        return 0;
    *pixel = (size_t)y * (size_t)c->width + (size_t)x;
    *depth = v[2];
    return 1;
}

static int is_inside(const fxs_editor *e, uint32_t slot, const fxs_edit_shape *s, const picture *p)
{
    const double *n = s->numbers;
    double square = 0, depth;
    int64_t place_q32[3];
    size_t pixel;
    if (s->kind == FXS_EDIT_OBJECT)
        return p->objects[slot];
    place_of(e, slot, place_q32);
    if (s->kind == FXS_EDIT_LASSO || s->kind == FXS_EDIT_BRUSH)
        return project(&s->camera, place_q32, &pixel, &depth) && p->mask[pixel] &&
               (!p->depths || p->depths[pixel] == FXS_NOTHING ||
                depth * 65536 <= (double)p->depths[pixel] + p->depths[pixel] / REACH);
    for (int i = 0; i < 3; i++) {
        const double x = (double)place_q32[i] * 0x1p-32;
        if (s->kind == FXS_EDIT_BOX && !(x >= n[i] && x <= n[3 + i]))
            return 0;
        square += (x - n[i]) * (x - n[i]);
    }
    return s->kind == FXS_EDIT_BOX || square <= n[3] * n[3];
}

/* Toggles each row of the mask at the first pixel right of an edge. The edge crosses the centre of row y at x = x0 + (y
   + 1/2 - y0) dx / dy, and that pixel is floor(x + 1/2). */
static void toggle_edge(const fxs_camera *c, uint8_t *mask, const int32_t *a, const int32_t *b)
{
    const int32_t *top = a[1] < b[1] ? a : b, *bottom = top == a ? b : a;
    const int64_t dx = bottom[0] - top[0], dy = bottom[1] - top[1];
    for (int32_t y = top[1] > 0 ? top[1] : 0; y < bottom[1] && y < c->height; y++) {
        const int64_t up = 2 * dy * top[0] + (2 * ((int64_t)y - top[1]) + 1) * dx + dy, below = 2 * dy;
        const int64_t x = up / below - (up % below < 0);
        if (x < c->width)
            mask[(size_t)y * (size_t)c->width + (size_t)(x > 0 ? x : 0)] ^= 1;
    }
}

static void draw_lasso(const fxs_edit_shape *s, uint8_t *mask)
{
    const fxs_camera *c = &s->camera;
    const uint32_t count = s->point_numbers / 2;
    for (uint32_t i = 0; i < count; i++)
        toggle_edge(c, mask, s->points + 2 * i, s->points + 2 * ((i + 1) % count));
    for (int32_t y = 0; y < c->height; y++, mask += c->width)
        for (int32_t x = 1; x < c->width; x++)
            mask[x] ^= mask[x - 1];
}

/* A disc of radius r around (a, b) covers the pixels with (x - a)^2 + (y - b)^2 <= r^2. */
static void draw_disc(const fxs_camera *c, uint8_t *mask, const int32_t *disc)
{
    const int32_t r = disc[2];
    int32_t half = 0;
    for (int32_t dy = -r; dy <= r; dy++) {
        const int64_t y = (int64_t)disc[1] + dy;
        while (half < r && (half + 1) * (half + 1) + dy * dy <= r * r)
            half++;
        while (half * half + dy * dy > r * r)
            half--;
        const int64_t first = disc[0] - half > 0 ? disc[0] - half : 0;
        const int64_t end = disc[0] + half < c->width ? disc[0] + half + 1 : c->width;
        if (y >= 0 && y < c->height && first < end)
            memset(mask + (size_t)y * (size_t)c->width + first, 1, (size_t)(end - first));
    }
}

static void draw_mask(const fxs_edit_shape *s, uint8_t *mask)
{
    if (s->kind == FXS_EDIT_LASSO)
        draw_lasso(s, mask);
    else if (s->kind == FXS_EDIT_BRUSH)
        for (uint32_t i = 0; i + 2 < s->point_numbers; i += 3)
            draw_disc(&s->camera, mask, s->points + i);
}

static int find_depths(const fxs_editor *e, const fxs_context *context, const fxs_camera *camera, uint32_t *depths,
                       fxs_message *message)
{
    fxs_object object;
    fxs_request r;
    fxs_object_init(&object, &e->scene);
    fxs_request_init(&r, &object, 1);
    r.cameras[0] = *camera;
    r.targets[0].median_depth = (fxs_image){depths, 4 * (ptrdiff_t)camera->width};
    const size_t bytes = fxs_request_bytes(context, &r, NULL);
    void *block = bytes ? fxs_allocate(NULL, bytes + 63, 1) : NULL;
    if (bytes && !block)
        return fxs_fail_memory(message, NULL, bytes);
    const int error = bytes ? fxs_render(context, &r, (void *)(((uintptr_t)block + 63) / 64 * 64), bytes, NULL)
                            : FXS_ERR_CAMERA;
    fxs_release(NULL, block);
    return error ? fxs_fail_as(error, message, "the picture of a lasso or a brush: %s", fxs_strerror(error)) : 0;
}

/* True if a lasso or a brush is within the limits that keep sums of its coordinates in range. */
static int has_range(const fxs_edit_shape *s)
{
    for (uint32_t i = 0; i < s->point_numbers; i++) {
        const int is_radius = s->kind == FXS_EDIT_BRUSH && i % 3 == 2;
        if (s->points[i] < (is_radius ? 0 : -FXS_EDIT_OUTSIDE) ||
            s->points[i] > (is_radius ? FXS_BRUSH_MOST : FXS_EDIT_OUTSIDE))
            return 0;
    }
    return 1;
}

static int make_picture(const fxs_editor *e, const fxs_context *context, const fxs_edit_shape *s, picture *p,
                        fxs_message *message)
{
    const fxs_camera *c = &s->camera;
    const int is_size = c->width > 0 && c->height > 0 && c->width <= FXS_MAX_SIZE && c->height <= FXS_MAX_SIZE;
    const size_t pixels = is_size ? (size_t)c->width * (size_t)c->height : 0;
    const int has_depths = s->front && s->kind != FXS_EDIT_OBJECT;
    if (!is_size || pixels > FXS_EDIT_PIXELS_MOST)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a lasso or a brush in a picture of %d x %d pixels: at most %u "
                           "in all", (int)c->width, (int)c->height, FXS_EDIT_PIXELS_MOST);
    if (!has_range(s))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a pixel of a lasso or a brush, or a radius, is out of range");
    p->mask = fxs_allocate_zeroed(NULL, pixels, 1);
    p->depths = has_depths ? fxs_allocate(NULL, pixels, sizeof *p->depths) : NULL;
    if (!p->mask || (has_depths && !p->depths))
        return fxs_fail_memory(message, NULL, 5 * pixels);
    draw_mask(s, p->mask);
    return has_depths ? find_depths(e, context, c, p->depths, message) : 0;
}

/* Finds the Gaussians of an object by clicks and boxes. */
static int find_object(const fxs_editor *e, const fxs_context *context, const fxs_edit_shape *s, picture *p,
                       fxs_message *message)
{
    const fxs_select_options options = {.size = sizeof options, .workers = context->config.workers};
    const fxs_select_view view = {s->camera, p->mask};
    const uint32_t count = s->point_numbers / FXS_EDIT_HINT;
    fxs_select_hint *hints = fxs_allocate(NULL, (size_t)count + 1, sizeof *hints);
    int error = 0;
    p->objects = fxs_allocate(NULL, e->count, 1);
    if (!hints || !p->objects)
        error = fxs_fail_memory(message, NULL, e->count + count * (uint64_t)sizeof *hints);
    for (uint32_t i = 0; i < count && !error; i++) {
        const int32_t *n = s->points + FXS_EDIT_HINT * i;
        hints[i] = (fxs_select_hint){n[0], n[1], n[2], n[3], n[4] != 0};
    }
    error = error ? error : fxs_select_mark(context, &e->scene, &s->camera, hints, count, p->mask, message);
    error = error ? error : fxs_select(context, &e->scene, &view, 1, &options, p->objects, message);
    fxs_release(NULL, hints);
    return error;
}

/* Selects by a shape. `again`: in place of the last shape. */
static void choose(fxs_editor *e, const fxs_edit_shape *s, const picture *p, int again)
{
    e->chosen = 0;
    for (uint32_t i = 0; i < e->count; i++) {
        if (!is_there(e, i))
            continue;
        uint8_t *flags = &e->slots[i].flags;
        const int was = *flags & (again ? BEFORE : CHOSEN);
        const int is = is_inside(e, i, s, p) ? !s->subtract : was != 0;
        *flags = (uint8_t)((was ? BEFORE : 0) | (is ? CHOSEN : 0));
        e->chosen += (uint32_t)is;
    }
}

static int select_by(fxs_editor *e, const fxs_context *context, const fxs_edit_shape *s, int again,
                     fxs_message *message)
{
    picture p = {NULL, NULL, NULL};
    int error = s->kind < FXS_EDIT_LASSO ? 0 : make_picture(e, context, s, &p, message);
    if (!error && s->kind == FXS_EDIT_OBJECT)
        error = find_object(e, context, s, &p, message);
    if (!error)
        choose(e, s, &p, again);
    fxs_release(NULL, p.mask);
    fxs_release(NULL, p.depths);
    fxs_release(NULL, p.objects);
    return error;
}

int fxs_editor_select(fxs_editor *e, const fxs_context *context, const fxs_edit_shape *s, fxs_message *message)
{
    return select_by(e, context, s, 0, message);
}

int fxs_editor_replace(fxs_editor *e, const fxs_context *context, const fxs_edit_shape *s, fxs_message *message)
{
    return select_by(e, context, s, 1, message);
}

void fxs_editor_clear(fxs_editor *e)
{
    for (uint32_t i = 0; i < e->count; i++)
        e->slots[i].flags &= EMPTY;
    e->chosen = 0;
}

int fxs_editor_act(fxs_editor *e, int keep, fxs_message *message)
{
    const uint32_t deleted = keep ? e->left - e->chosen : e->chosen;
    if (!deleted || deleted == e->left || e->done == FXS_EDITS_MOST)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, !deleted             ? "nothing is selected"
                                                      : deleted == e->left ? "nothing would be left"
                                                                           : "no more edits");
    for (uint32_t i = 0; i < e->count; i++) {
        fxs_edit_slot *s = &e->slots[i];
        const int is_hit = is_there(e, i) && (s->flags & CHOSEN) != keep;
        s->edit = is_hit ? (uint16_t)(e->done + 1) : s->edit <= e->done ? s->edit : 0;
    }
    e->last = e->done + 1;
    fxs_editor_go(e, e->last);
    return (int)deleted;
}

void fxs_editor_go(fxs_editor *e, uint32_t done)
{
    e->done = done < e->last ? done : e->last;
    e->left = 0;
    for (uint32_t i = 0; i < e->count; i++)
        if (!(e->slots[i].flags & EMPTY)) {
            *opacity_at(e, i) = is_there(e, i) ? e->slots[i].opacity : 0;
            e->left += (uint32_t)is_there(e, i);
        }
    fxs_editor_clear(e);
}

void fxs_editor_mark(const fxs_editor *e, const fxs_camera *c, uint32_t *pixels, uint32_t colour)
{
    const size_t width = (size_t)c->width;
    int64_t place_q32[3];
    size_t at;
    double depth;
    for (uint32_t i = 0; i < e->count; i++) {
        if (!(e->slots[i].flags & CHOSEN))
            continue;
        place_of(e, i, place_q32);
        if (!project(c, place_q32, &at, &depth))
            continue;
        const int right = at % width + 1 < width, below = at / width + 1 < (size_t)c->height;
        pixels[at] = pixels[at + (size_t)right] = colour;
        pixels[at + (below ? width : 0)] = pixels[at + (below ? width : 0) + (size_t)right] = colour;
    }
}

/* ---- The edited scene -------------------------------------------------------------------------------------------- */

static int is_left(const fxs_editor *e, uint32_t chunk)
{
    for (uint32_t i = chunk * FXS_CHUNK; i < (chunk + 1) * FXS_CHUNK; i++)
        if (is_there(e, i))
            return 1;
    return 0;
}

/* Counts the slots up to the last Gaussian, in the chunks that have Gaussians left. */
static uint32_t slots_left(const fxs_editor *e)
{
    uint32_t chunks = 0, count = 0;
    for (uint32_t i = 0; i < e->scene.chunk_count; i++)
        if (is_left(e, i)) {
            for (uint32_t g = 0; g < FXS_CHUNK; g++)
                count = is_there(e, i * FXS_CHUNK + g) ? chunks * FXS_CHUNK + g + 1 : count;
            chunks++;
        }
    return count;
}

size_t fxs_editor_bytes(const fxs_editor *e)
{
    const fxs_scene *s = &e->scene;
    return fxs_scene_bytes(slots_left(e), s->sh_degree, s->profile, s->palette_entries);
}

/* Empties slot g of a chunk: sets all codes except SH to 0. The rows are three of 16 bits and three of 32 bits, in
   profile small three of 32 bits and one of 8 bits. */
static void empty(const fxs_scene *s, unsigned char *rows, uint32_t g)
{
    const int is_small = s->profile == FXS_PROFILE_SMALL;
    for (int i = 0; i < 3 && !is_small; i++, rows += 2 * FXS_CHUNK)
        memset(rows + 2 * g, 0, 2);
    for (int i = 0; i < 3; i++, rows += 4 * FXS_CHUNK)
        memset(rows + 4 * g, 0, 4);
    if (is_small)
        rows[g] = 0;
}

static void write_header(const fxs_editor *e, const void *data, void *out)
{
    fxs_packed_header h;
    int64_t place_q32[3];
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    h.version = FXS_PACKED_VERSION;
    h.count = slots_left(e);
    h.chunk_count = fxs_chunks_of(h.count);
    h.holes = h.count - e->left;
    for (int i = 0; i < 3; i++) {
        h.low_q32[i] = INT64_MAX;
        h.high_q32[i] = INT64_MIN;
    }
    for (uint32_t slot = 0; slot < e->count; slot++)
        if (is_there(e, slot)) {
            place_of(e, slot, place_q32);
            for (int i = 0; i < 3; i++) {
                h.low_q32[i] = place_q32[i] < h.low_q32[i] ? place_q32[i] : h.low_q32[i];
                h.high_q32[i] = place_q32[i] > h.high_q32[i] ? place_q32[i] : h.high_q32[i];
            }
        }
    for (int i = 0; i < 3; i++) {
        const int64_t low = h.inner_low_q32[i] > h.low_q32[i] ? h.inner_low_q32[i] : h.low_q32[i];
        const int64_t high = h.inner_high_q32[i] < h.high_q32[i] ? h.inner_high_q32[i] : h.high_q32[i];
        h.inner_low_q32[i] = low <= high ? low : h.low_q32[i];
        h.inner_high_q32[i] = low <= high ? high : h.high_q32[i];
    }
    fxs_packed_header_turn(&h);
    memcpy(out, &h, sizeof h);
}

void fxs_editor_write(const fxs_editor *e, const void *data, void *out)
{
    const fxs_scene *s = &e->scene;
    const size_t palette_bytes = s->palette ? (size_t)(s->rows - (const unsigned char *)s->palette) : 0;
    const uint32_t chunks = fxs_chunks_of(slots_left(e));
    unsigned char *header = (unsigned char *)out + sizeof(fxs_packed_header);
    unsigned char *palette = header + (size_t)chunks * sizeof(fxs_chunk), *rows = palette + palette_bytes;
    write_header(e, data, out);
    if (palette_bytes)
        memcpy(palette, s->palette, palette_bytes);
    for (uint32_t i = 0; i < s->chunk_count; i++)
        if (is_left(e, i)) {
            memcpy(header, header_of(e, i), sizeof(fxs_chunk));
            memcpy(rows, rows_of(e, i), s->chunk_bytes);
            for (uint32_t g = 0; g < FXS_CHUNK; g++)
                if (!is_there(e, i * FXS_CHUNK + g))
                    empty(s, rows, g);
            header += sizeof(fxs_chunk);
            rows += s->chunk_bytes;
        }
    fxs_file_seal(out, fxs_editor_bytes(e));
}
