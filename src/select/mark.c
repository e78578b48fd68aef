/* Marks pixels of a picture from clicks and boxes. A region grows from pixel to pixel while depth and colour change
   little: from a click into the object, from the edge of a box over what surrounds the object in it. */
#include <fixsplat/select.h>

#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/core/sized.h"

enum {
    DEPTH_BITS = 16,
    STEEP = 12,                        /* largest change of depth from pixel to pixel, in pixels' widths at that depth */
    STEP = 14,                         /* largest change of a colour channel from pixel to pixel, of 255 */
    LUMA = 100, CHROMA = 45,           /* largest difference in brightness and in colour from the click's pixel */
    BORDER = 2                         /* pixels on each side of a region's border that are unknown */
};

typedef struct marking {
    const fxs_camera *camera;
    int32_t width, height;
    uint8_t *pixels;                   /* RGBA8 */
    uint32_t *depths;
    uint8_t *region;                   /* 1: reached by the region that grows */
    uint32_t *queue;
    void *frame;
} marking;

static void marking_free(marking *p)
{
    void *const blocks[] = {p->pixels, p->depths, p->region, p->queue, p->frame};
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
    p->region = fxs_allocate(NULL, pixels, 1);
    p->queue = fxs_allocate(NULL, pixels, sizeof *p->queue);
    r.targets[0].format = FXS_FORMAT_RGBA8;
    r.targets[0].colour = (fxs_image){p->pixels, 4 * (ptrdiff_t)p->width};
    r.targets[0].median_depth = (fxs_image){p->depths, 4 * (ptrdiff_t)p->width};
    r.targets[0].depth_bits = DEPTH_BITS;
    const size_t bytes = fxs_request_bytes(context, &r, NULL);
    if (!bytes)
        return fxs_fail_as(FXS_ERR_CAMERA, m, "the picture: %s", fxs_strerror(FXS_ERR_CAMERA));
    p->frame = fxs_allocate(NULL, bytes + 63, 1);
    if (!p->pixels || !p->depths || !p->region || !p->queue || !p->frame)
        return fxs_fail_memory(m, NULL, 13 * (uint64_t)pixels + bytes);
    const int error = fxs_render(context, &r, (void *)(((uintptr_t)p->frame + 63) / 64 * 64), bytes, NULL);
    return error ? fxs_fail_as(error, m, "the picture: %s", fxs_strerror(error)) : 0;
}

static int32_t distance(int32_t a, int32_t b)
{
    return a < b ? b - a : a - b;
}

/* True if two adjacent pixels look like one surface. */
static int is_alike(const marking *p, uint32_t a, uint32_t b)
{
    const uint32_t depth = p->depths[a], other = p->depths[b];
    if (depth == FXS_NOTHING || other == FXS_NOTHING)
        return depth == other;
    const uint64_t gap = depth < other ? other - depth : depth - other;
    const uint64_t focal_q12 = p->camera->fx_q12 > 0 ? (uint64_t)p->camera->fx_q12 : 1;
    if (gap * focal_q12 > ((uint64_t)depth * STEEP << 12))
        return 0;
    for (size_t k = 0; k < 3; k++)
        if (distance(p->pixels[4 * (size_t)a + k], p->pixels[4 * (size_t)b + k]) > STEP)
            return 0;
    return 1;
}

/* True if a pixel has about the colour of the pixel where the region began. */
static int is_like_first(const marking *p, uint32_t pixel, const int32_t first[3])
{
    const uint8_t *c = p->pixels + 4 * (size_t)pixel;
    const int32_t luma = (c[0] + 2 * c[1] + c[2]) / 4, first_luma = (first[0] + 2 * first[1] + first[2]) / 4;
    if (distance(luma, first_luma) > LUMA)
        return 0;
    for (int k = 0; k < 3; k++)
        if (distance(c[k] - luma, first[k] - first_luma) > CHROMA)
            return 0;
    return 1;
}

/* Grows the region from the pixels in the queue, within a box. `first`: the colour of a click; null: any. */
static void grow(marking *p, uint32_t end, const fxs_select_hint *box, const int32_t *first)
{
    for (uint32_t at = 0; at < end; at++) {
        const uint32_t pixel = p->queue[at];
        const int32_t x = (int32_t)(pixel % (uint32_t)p->width), y = (int32_t)(pixel / (uint32_t)p->width);
        for (int way = 0; way < 4; way++) {
            const int32_t to_x = x + (way == 0) - (way == 1), to_y = y + (way == 2) - (way == 3);
            if (to_x < box->x || to_y < box->y || to_x > box->right || to_y > box->bottom)
                continue;
            const uint32_t other = (uint32_t)to_y * (uint32_t)p->width + (uint32_t)to_x;
            if (p->region[other] || !is_alike(p, pixel, other) || (first && !is_like_first(p, other, first)))
                continue;
            p->region[other] = 1;
            p->queue[end++] = other;
        }
    }
}

static void click(marking *p, const fxs_select_hint *hint)
{
    const fxs_select_hint all = {0, 0, p->width - 1, p->height - 1, 0};
    const uint32_t pixel = (uint32_t)hint->y * (uint32_t)p->width + (uint32_t)hint->x;
    const uint8_t *c = p->pixels + 4 * (size_t)pixel;
    const int32_t first[3] = {c[0], c[1], c[2]};
    p->region[pixel] = 1;
    p->queue[0] = pixel;
    grow(p, 1, &all, first);
}

/* Grows the region from the edge of a box, then takes the rest of the box instead. */
static void fill_box(marking *p, const fxs_select_hint *box)
{
    uint32_t end = 0;
    for (int32_t y = box->y; y <= box->bottom; y++)
        for (int32_t x = box->x; x <= box->right; x++)
            if (x == box->x || x == box->right || y == box->y || y == box->bottom) {
                const uint32_t pixel = (uint32_t)y * (uint32_t)p->width + (uint32_t)x;
                p->region[pixel] = 1;
                p->queue[end++] = pixel;
            }
    grow(p, end, box, NULL);
    for (int32_t y = box->y; y <= box->bottom; y++)
        for (int32_t x = box->x; x <= box->right; x++) {
            const size_t pixel = (size_t)y * (size_t)p->width + (size_t)x;
            p->region[pixel] = !p->region[pixel] && p->depths[pixel] != FXS_NOTHING;
        }
}

/* True if a pixel less than BORDER away is on the other side of the region's border. */
static int is_border(const marking *p, int32_t x, int32_t y)
{
    const uint8_t own = p->region[(size_t)y * (size_t)p->width + (size_t)x];
    for (int32_t v = y - BORDER + 1; v < y + BORDER; v++)
        for (int32_t u = x - BORDER + 1; u < x + BORDER; u++)
            if (u >= 0 && v >= 0 && u < p->width && v < p->height &&
                p->region[(size_t)v * (size_t)p->width + (size_t)u] != own)
                return 1;
    return 0;
}

static void mark_region(const marking *p, uint32_t object, uint8_t *marks)
{
    for (int32_t y = 0; y < p->height; y++)
        for (int32_t x = 0; x < p->width; x++) {
            const size_t pixel = (size_t)y * (size_t)p->width + (size_t)x;
            if (is_border(p, x, y))
                marks[pixel] = FXS_SELECT_UNKNOWN;
            else if (p->region[pixel])
                marks[pixel] = (uint8_t)object;
        }
}

static int check_hint(const marking *p, const fxs_select_hint *h, fxs_message *m)
{
    if (h->x < 0 || h->y < 0 || h->right >= p->width || h->bottom >= p->height || h->right < h->x || h->bottom < h->y)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: a click or a box outside of the picture of %d x %d pixels",
                           (int)h->x, (int)h->y, (int)p->width, (int)p->height);
    return h->object <= FXS_SELECT_OBJECTS ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, m, "object %u of at most %u",
                                                             (unsigned)h->object, FXS_SELECT_OBJECTS);
}

static int take_hint(marking *p, const fxs_select_hint *h, uint8_t *marks, fxs_message *m)
{
    const int is_click = h->x == h->right && h->y == h->bottom;
    size_t count = 0;
    memset(p->region, 0, (size_t)p->width * (size_t)p->height);
    if (is_click && p->depths[(size_t)h->y * (size_t)p->width + (size_t)h->x] == FXS_NOTHING)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: nothing is there, or only haze", (int)h->x, (int)h->y);
    if (is_click)
        click(p, h);
    else
        fill_box(p, h);
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++)
        count += p->region[i];
    if (!count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "%d,%d: nothing in the box stands out from its edge", (int)h->x,
                           (int)h->y);
    mark_region(p, h->object, marks);
    return 0;
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
    for (uint32_t i = 0; i < hint_count && !error; i++) {
        error = check_hint(&p, &hints[i], m);
        error = error ? error : take_hint(&p, &hints[i], marks, m);
    }
    marking_free(&p);
    return error;
}
