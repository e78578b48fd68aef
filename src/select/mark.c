/* Marks pixels of a picture from clicks and boxes. A region grows from pixel to pixel while depth and colour change
   little: from a click into the object, or from the edge of a box over what surrounds the object in it. */
#include <fixsplat/select.h>

#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/core/sized.h"

#define NONE UINT32_MAX

enum {
    DEPTH_BITS = 16,
    STEEP = 12,                        /* largest change of depth from pixel to pixel, in widths of a pixel there */
    STEP = 12,                         /* largest change of a colour channel from pixel to pixel, of 255 */
    LUMA = 60, CHROMA = 24,            /* largest difference in brightness and in colour from the click's pixel */
    EDGE_LUMA = 25, EDGE_CHROMA = 10,  /* the same for the pixels of a box's edge */
    BORDER = 1                         /* pixels on each side of a region's border that are unknown */
};

typedef struct marking {
    const fxs_camera *camera;
    int32_t width, height;
    uint8_t *pixels;                   /* RGBA8 */
    uint32_t *depths;
    uint32_t *starts;                  /* the pixel where each pixel's region began; NONE: no region */
    uint32_t *next;                    /* pixels of each step wait in a list */
    uint32_t first[STEP + 1], last[STEP + 1];
    uint8_t *objects;                  /* of each pixel */
    int32_t luma, chroma;              /* limits of the regions that grow now */
    void *frame;
} marking;

static void marking_free(marking *p)
{
    void *const blocks[] = {p->pixels, p->depths, p->starts, p->next, p->objects, p->frame};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_release(NULL, blocks[i]);
}

static int draw(marking *p, const fxs_context *context, const fxs_scene *scene, fxs_message *m)
{
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    fxs_object object;
    fxs_request r;
    fxs_object_init(&object, scene);
    fxs_request_init(&r, &object, 1);
    r.cameras[0] = *p->camera;
    p->pixels = fxs_allocate(NULL, pixels, 4);
    p->depths = fxs_allocate(NULL, pixels, sizeof *p->depths);
    p->starts = fxs_allocate(NULL, pixels, sizeof *p->starts);
    p->next = fxs_allocate(NULL, pixels, sizeof *p->next);
    p->objects = fxs_allocate(NULL, pixels, 1);
    r.targets[0].format = FXS_FORMAT_RGBA8;
    r.targets[0].colour = (fxs_image){p->pixels, 4 * (ptrdiff_t)p->width};
    r.targets[0].median_depth = (fxs_image){p->depths, 4 * (ptrdiff_t)p->width};
    r.targets[0].depth_bits = DEPTH_BITS;
    const size_t bytes = fxs_request_bytes(context, &r, NULL);
    if (!bytes)
        return fxs_fail_as(FXS_ERR_CAMERA, m, "the picture: %s", fxs_strerror(FXS_ERR_CAMERA));
    p->frame = fxs_allocate(NULL, bytes + 63, 1);
    if (!p->pixels || !p->depths || !p->starts || !p->next || !p->objects || !p->frame)
        return fxs_fail_memory(m, NULL, 17 * (uint64_t)pixels + bytes);
    const int error = fxs_render(context, &r, (void *)(((uintptr_t)p->frame + 63) / 64 * 64), bytes, NULL);
    return error ? fxs_fail_as(error, m, "the picture: %s", fxs_strerror(error)) : 0;
}

static int32_t distance(int32_t a, int32_t b)
{
    return a < b ? b - a : a - b;
}

/* Returns how much two adjacent pixels differ, 0 to STEP; above: they look like two surfaces. */
static int32_t step_between(const marking *p, uint32_t a, uint32_t b)
{
    const uint32_t depth = p->depths[a], other = p->depths[b];
    int32_t step = 0;
    if (depth == FXS_NOTHING || other == FXS_NOTHING)
        return depth == other ? 0 : STEP + 1;
    const uint64_t gap = depth < other ? other - depth : depth - other;
    if (gap * (uint32_t)p->camera->fx_q12 > ((uint64_t)depth * STEEP << 12))
        return STEP + 1;
    for (size_t k = 0; k < 3; k++) {
        const int32_t d = distance(p->pixels[4 * (size_t)a + k], p->pixels[4 * (size_t)b + k]);
        step = d > step ? d : step;
    }
    return step;
}

/* True if a pixel has about the colour of the pixel where its region began. The brighter one is compared with its
   brightness reduced to that of the other, as in shade. */
static int is_like(const marking *p, uint32_t pixel, uint32_t start)
{
    const uint8_t *a = p->pixels + 4 * (size_t)pixel, *b = p->pixels + 4 * (size_t)start;
    const int32_t luma = (a[0] + 2 * a[1] + a[2]) / 4 + 1, other = (b[0] + 2 * b[1] + b[2]) / 4 + 1;
    if (distance(luma, other) > p->luma)
        return 0;
    for (int k = 0; k < 3; k++)
        if (distance(a[k] * other, b[k] * luma) > p->chroma * (luma > other ? luma : other))
            return 0;
    return 1;
}

/* Adds a pixel to a region, and to the queue of a step. */
static void take(marking *p, uint32_t pixel, uint32_t start, int32_t step)
{
    p->starts[pixel] = start;
    p->next[pixel] = NONE;
    if (p->first[step] == NONE)
        p->first[step] = pixel;
    else
        p->next[p->last[step]] = pixel;
    p->last[step] = pixel;
}

static void look_around(marking *p, uint32_t pixel, int32_t step, const fxs_select_hint *box)
{
    const int32_t x = (int32_t)(pixel % (uint32_t)p->width), y = (int32_t)(pixel / (uint32_t)p->width);
    for (int way = 0; way < 4; way++) {
        const int32_t to_x = x + (way == 0) - (way == 1), to_y = y + (way == 2) - (way == 3);
        if (to_x < box->x || to_y < box->y || to_x > box->right || to_y > box->bottom)
            continue;
        const uint32_t other = (uint32_t)to_y * (uint32_t)p->width + (uint32_t)to_x;
        if (p->starts[other] != NONE)
            continue;
        const int32_t own = step_between(p, pixel, other);
        if (own <= STEP && is_like(p, other, p->starts[pixel]))
            take(p, other, p->starts[pixel], own > step ? own : step);
    }
}

/* Grows the regions, within a box. The pixel with the smallest largest step on its way is next (watershed: F. Meyer,
   "Un algorithme optimal pour la ligne de partage des eaux", 1991), so regions meet at edges. */
static void grow(marking *p, const fxs_select_hint *box)
{
    for (int32_t step = 0; step <= STEP;) {
        const uint32_t pixel = p->first[step];
        if (pixel == NONE) {
            step++;
            continue;
        }
        p->first[step] = p->next[pixel];
        look_around(p, pixel, step, box);
    }
}

static void begin(marking *p, int32_t luma, int32_t chroma)
{
    p->luma = luma;
    p->chroma = chroma;
    memset(p->starts, 0xff, (size_t)p->width * (size_t)p->height * sizeof *p->starts);
    memset(p->first, 0xff, sizeof p->first);
}

static uint32_t pixel_of(const marking *p, int32_t x, int32_t y)
{
    return (uint32_t)y * (uint32_t)p->width + (uint32_t)x;
}

/* True if a pixel within BORDER has another object. */
static int is_border(const marking *p, int32_t x, int32_t y)
{
    const uint8_t own = p->objects[pixel_of(p, x, y)];
    for (int32_t v = y - BORDER; v <= y + BORDER; v++)
        for (int32_t u = x - BORDER; u <= x + BORDER; u++)
            if (u >= 0 && v >= 0 && u < p->width && v < p->height && p->objects[pixel_of(p, u, v)] != own)
                return 1;
    return 0;
}

/* Marks the pixels of regions with their objects, and pixels on a region's border as unknown. An object that is all
   border is marked too. */
static void mark_regions(const marking *p, uint8_t *marks)
{
    uint8_t is_marked[256] = {0};
    for (int32_t y = 0; y < p->height; y++)
        for (int32_t x = 0; x < p->width; x++) {
            const uint32_t pixel = pixel_of(p, x, y);
            const uint8_t own = p->objects[pixel];
            const int is_on_border = is_border(p, x, y);
            is_marked[own] |= !is_on_border;
            if (is_on_border || own != FXS_SELECT_PERHAPS)
                marks[pixel] = is_on_border ? FXS_SELECT_UNKNOWN : own;
        }
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++)
        if (!is_marked[p->objects[i]])
            marks[i] = p->objects[i];
}

/* Grows regions from the edge of a box: what they do not reach is the object. */
static int take_box(marking *p, const fxs_select_hint *box, uint8_t *marks, fxs_message *m)
{
    size_t count = 0;
    begin(p, EDGE_LUMA, EDGE_CHROMA);
    for (int32_t y = box->y; y <= box->bottom; y++)
        for (int32_t x = box->x; x <= box->right; x++)
            if (x == box->x || x == box->right || y == box->y || y == box->bottom)
                take(p, pixel_of(p, x, y), pixel_of(p, x, y), 0);
    grow(p, box);
    memset(p->objects, FXS_SELECT_PERHAPS, (size_t)p->width * (size_t)p->height);
    for (int32_t y = box->y; y <= box->bottom; y++)
        for (int32_t x = box->x; x <= box->right; x++) {
            const uint32_t pixel = pixel_of(p, x, y);
            if (p->starts[pixel] == NONE && p->depths[pixel] != FXS_NOTHING) {
                p->objects[pixel] = (uint8_t)box->object;
                count++;
            }
        }
    mark_regions(p, marks);
    return count ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: nothing in the box stands out from its edge",
                                   (int)box->x, (int)box->y);
}

static int is_click(const fxs_select_hint *h)
{
    return h->x == h->right && h->y == h->bottom;
}

/* Grows the regions of all clicks at once. Of clicks at one pixel, the last counts. */
static int take_clicks(marking *p, const fxs_select_hint *hints, uint32_t count, uint8_t *marks, fxs_message *m)
{
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    begin(p, LUMA, CHROMA);
    memset(p->objects, FXS_SELECT_PERHAPS, pixels);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t pixel = pixel_of(p, hints[i].x, hints[i].y);
        if (!is_click(&hints[i]))
            continue;
        if (p->depths[pixel] == FXS_NOTHING)
            return fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: nothing is there, or only haze", (int)hints[i].x,
                               (int)hints[i].y);
        if (p->starts[pixel] == NONE)
            take(p, pixel, pixel, 0);
        p->objects[pixel] = (uint8_t)hints[i].object;
    }
    grow(p, &(fxs_select_hint){0, 0, p->width - 1, p->height - 1, 0});
    for (size_t i = 0; i < pixels; i++)
        if (p->starts[i] != NONE)
            p->objects[i] = p->objects[p->starts[i]];
    mark_regions(p, marks);
    return 0;
}

static int check_hint(const marking *p, const fxs_select_hint *h, fxs_message *m)
{
    if (h->x < 0 || h->y < 0 || h->right >= p->width || h->bottom >= p->height || h->right < h->x || h->bottom < h->y)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: a click or a box outside of the picture of %d x %d pixels",
                           (int)h->x, (int)h->y, (int)p->width, (int)p->height);
    return h->object <= FXS_SELECT_OBJECTS ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, m, "object %u of at most %u",
                                                             (unsigned)h->object, FXS_SELECT_OBJECTS);
}

int fxs_select_mark(const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                    const fxs_select_hint *hints, uint32_t hint_count, uint8_t *marks, fxs_message *m)
{
    marking p = {.camera = camera};
    if (!context || !scene || !camera || !hints || !marks || camera->width < 1 || camera->height < 1 ||
        camera->width > FXS_MAX_SIZE || camera->height > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "an argument is null, or the picture is larger than %d", FXS_MAX_SIZE);
    fxs_scene whole = *scene;
    whole.nodes = NULL;
    p.width = camera->width;
    p.height = camera->height;
    int error = draw(&p, context, &whole, m);
    if (!error)
        memset(marks, FXS_SELECT_PERHAPS, (size_t)p.width * (size_t)p.height);
    for (uint32_t i = 0; i < hint_count && !error; i++)
        error = check_hint(&p, &hints[i], m);
    for (uint32_t i = 0; i < hint_count && !error; i++)
        if (!is_click(&hints[i]))
            error = take_box(&p, &hints[i], marks, m);
    error = error ? error : take_clicks(&p, hints, hint_count, marks, m);
    marking_free(&p);
    return error;
}
