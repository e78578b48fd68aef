/* Foveated rendering: sharp around the gaze, coarser away from the gaze. Renders up to three rings at full, half and
 * quarter resolution, each as a window of the picture. Coarser rings are enlarged bilinearly, and finer rings are
 * blended over them in integers. */
#include <fixsplat/foveate.h>

#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>

enum { TILE = 16, ROWS = 16 /* ROWS: picture rows of a job */, OPAQUE = 256 };

/* Least principal point of a camera. A smaller one could fall below INT32_MIN in a window. */
#define FAR_Q12 (INT32_MIN + (FXS_MAX_SIZE << 12))

#define LANES UINT64_C(0x0001000100010001)

typedef struct rectangle {
    int32_t first[2], end[2];
} rectangle;

typedef struct layer {
    const uint8_t *pixels;
    int32_t width, height, rate;
    int32_t x, y, end_x, end_y;    /* position in pixels of the whole picture */
    int32_t slope_q15;             /* OPAQUE / width of the fade */
    int32_t fade[4];               /* width of the fade at the left, top, right and lower edge, in pixels */
    rectangle inside;              /* opaque part, which hides coarser layers */
} layer;

typedef struct composition {
    layer layers[2][FXS_RINGS];    /* layers of each eye, from fine to coarse */
    uint32_t count;
    int32_t height;
    const fxs_targets *targets;
    uint32_t jobs_of_eye;
} composition;

void fxs_foveation_init(fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes)
{
    const int32_t side = cameras->width < cameras->height ? cameras->width : cameras->height;
    const int32_t fifth = side / 5 > 1 ? side / 5 : 1;
    memset(foveation, 0, sizeof *foveation);
    for (uint32_t eye = 0; eye < eyes && eye < 2; eye++) {
        foveation->gaze[eye][0] = cameras[eye].cx_q12 >> 12;
        foveation->gaze[eye][1] = cameras[eye].cy_q12 >> 12;
    }
    foveation->radius[0] = fifth;
    foveation->radius[1] = 2 * fifth;
    foveation->band = fifth / 4;
}

static inline int32_t least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t rounded_up(int32_t x, int32_t step)
{
    return (x + step - 1) / step * step;
}

static int32_t side_at(int32_t side, int32_t rate)
{
    return (side + rate - 1) / rate;
}

static int32_t window_length(int32_t side, int32_t rate, int32_t radius)
{
    return least(rounded_up(2 * radius / rate, TILE), side_at(side, rate));
}

static int32_t window_start(int32_t side, int32_t rate, int32_t length, int32_t gaze)
{
    const int64_t start = (int64_t)gaze / rate - length / 2, most = side_at(side, rate) - length;
    return (int32_t)(start < 0 ? 0 : start < most ? start : most);
}

/* Returns the number of rings, which are regions of one resolution. The last ring covers the whole picture. */
static uint32_t find_rings(fxs_ring rings[FXS_RINGS], const fxs_foveation *f, const fxs_camera *cameras, uint32_t eyes)
{
    const int32_t width = cameras->width, height = cameras->height;
    uint32_t count = 0;
    for (int whole = 0; !whole; count++) {
        fxs_ring *r = &rings[count];
        const int32_t radius = count < 2 ? f->radius[count] : FXS_MAX_SIZE;
        memset(r, 0, sizeof *r);
        r->rate = 1 << count;
        r->width = window_length(width, r->rate, radius);
        r->height = window_length(height, r->rate, radius);
        for (uint32_t eye = 0; eye < eyes; eye++) {
            r->x[eye] = window_start(width, r->rate, r->width, f->gaze[eye][0]) * r->rate;
            r->y[eye] = window_start(height, r->rate, r->height, f->gaze[eye][1]) * r->rate;
        }
        whole = r->width == side_at(width, r->rate) && r->height == side_at(height, r->rate);
    }
    return count;
}

static rectangle inside_of(const fxs_ring *r, int eye, int32_t band, const fxs_camera *camera)
{
    const int32_t start[2] = {r->x[eye], r->y[eye]}, length[2] = {r->width * r->rate, r->height * r->rate};
    const int32_t edge[2] = {camera->width, camera->height};
    rectangle inside;
    for (int i = 0; i < 2; i++) {
        const int32_t end = start[i] + length[i];
        inside.first[i] = start[i] + (start[i] > 0 ? band : 0);
        inside.end[i] = end < edge[i] ? end - band : edge[i];
    }
    return inside;
}

static size_t pixels_of(const fxs_ring *r)
{
    return (size_t)r->width * (size_t)r->height;
}

/* Returns the camera of a ring. Pixel (X, Y) of the ring is centred on the rate x rate pixels of the picture that
   start at rate * (X, Y). */
static fxs_camera camera_of(const fxs_camera *camera, const fxs_ring *r, int eye)
{
    const int32_t rate = r->rate, half = rate / 2, x = r->x[eye] / rate, y = r->y[eye] / rate;
    const int window = camera->whole_width || camera->whole_height;
    fxs_camera c = *camera;
    c.width = r->width;
    c.height = r->height;
    c.fx_q12 = (int32_t)(((int64_t)camera->fx_q12 + half) / rate);
    c.fy_q12 = (int32_t)(((int64_t)camera->fy_q12 + half) / rate);
    c.cx_q12 = (int32_t)(((int64_t)camera->cx_q12 + half) / rate - ((int64_t)x << 12));
    c.cy_q12 = (int32_t)(((int64_t)camera->cy_q12 + half) / rate - ((int64_t)y << 12));
    c.whole_width = side_at(window ? camera->whole_width : camera->width, rate);
    c.whole_height = side_at(window ? camera->whole_height : camera->height, rate);
    c.whole_x = (window ? camera->whole_x / rate : 0) + x;
    c.whole_y = (window ? camera->whole_y / rate : 0) + y;
    c.hidden_x = c.hidden_y = c.hidden_width = c.hidden_height = 0;
    return c;
}

/* Hides the part of a ring that the finer ring covers, except border pixels that bilinear enlargement reads. */
static void hide(fxs_camera *c, const fxs_ring *r, int eye, const rectangle *covered, const fxs_camera *whole)
{
    const int32_t start[2] = {r->x[eye], r->y[eye]}, size[2] = {c->width, c->height};
    const int32_t edge[2] = {whole->width, whole->height};
    int32_t from[2], length[2];
    for (int i = 0; i < 2; i++) {
        const int32_t first = covered->first[i], end = covered->end[i];
        const int32_t till = end < edge[i] ? least((end - start[i]) / r->rate - 1, size[i]) : size[i];
        from[i] = first > 0 ? (first - start[i]) / r->rate + 2 : 0;
        from[i] = from[i] > 0 ? from[i] : 0;
        length[i] = till - from[i];
    }
    if (length[0] <= 0 || length[1] <= 0)
        return;
    c->hidden_x = from[0];
    c->hidden_y = from[1];
    c->hidden_width = length[0];
    c->hidden_height = length[1];
}

/* Returns the ring's share of the budget of Gaussians, in proportion to its pixels; 0: no limit. */
static uint32_t budget_of(const fxs_foveated *all, const fxs_ring *r, const fxs_request *request)
{
    const uint32_t budget = request->options.budget;
    uint64_t pixels = 0, gaussians = 0;
    for (uint32_t i = 0; i < all->count; i++)
        pixels += pixels_of(&all->rings[i]);
    for (uint32_t i = 0; i < request->count; i++)
        gaussians += request->objects[i].scene ? request->objects[i].scene->count : 0;
    const uint64_t part = (uint64_t)budget * pixels_of(r) / pixels;
    return !budget || budget >= gaussians ? 0 : part ? (uint32_t)part : 1;
}

/* finer: the next finer ring; null: none */
static int render_ring(const fxs_backend *backend, void *self, const fxs_request *request, fxs_ring *r,
                       const fxs_ring *finer, int32_t band, uint32_t budget, uint8_t *pixels, fxs_message *why)
{
    fxs_request own = *request;
    own.options.budget = budget;
    own.options.budget_of_window = 1;
    for (uint32_t eye = 0; eye < request->eyes; eye++) {
        own.cameras[eye] = camera_of(&request->cameras[eye], r, (int)eye);
        if (finer) {
            const rectangle covered = inside_of(finer, (int)eye, band, request->cameras);
            hide(&own.cameras[eye], r, (int)eye, &covered, request->cameras);
        }
        fxs_targets_init(&own.targets[eye]);
        own.targets[eye].format = request->targets[eye].format;
        own.targets[eye].colour = (fxs_image){pixels + 4 * eye * pixels_of(r), 4 * (ptrdiff_t)r->width};
    }
    return backend->render(self, &own, &r->stats, why);
}

static void add_stats(fxs_foveated *all, const fxs_ring *r)
{
    fxs_stats *sum = &all->stats;
    sum->gaussians = r->stats.gaussians;
    sum->drawn += r->stats.drawn;
    sum->missing += r->stats.missing;
    sum->visible += r->stats.visible;
    sum->entries += r->stats.entries;
    sum->bands += r->stats.bands;
    sum->runs += r->stats.runs;
    if (r->stats.memory.total > sum->memory.total)
        sum->memory = r->stats.memory;
    for (int i = 0; i < FXS_STAGES; i++)
        sum->nanoseconds[i] += r->stats.nanoseconds[i];
}

/* Loads a pixel into four 16-bit lanes. */
static inline uint64_t load(const uint8_t *pixel)
{
    uint32_t rgba;
    memcpy(&rgba, pixel, 4);
    return (rgba | (uint64_t)rgba << 24) & LANES * 255;
}

static inline void store(uint8_t *pixel, uint64_t lanes)
{
    const uint32_t rgba = (uint32_t)lanes | (uint32_t)(lanes >> 24);
    memcpy(pixel, &rgba, 4);
}

static inline uint64_t over(uint64_t lanes, int shift)
{
    return lanes >> shift & LANES * 255;
}

/* A row interpolated between two rows of a layer. The two weights add up to 2 rate. */
typedef struct blended_row {
    const uint8_t *above, *below;
    uint64_t weight;               /* weight of the row below */
} blended_row;

static inline int32_t clamped(int32_t x, int32_t end)
{
    return x < 0 ? 0 : x < end ? x : end - 1;
}

/* Picture pixel i, counted from the layer's edge, lies n / (2 rate) layer pixels after the centre of the layer's
   first pixel, with n = 2 i + 1 - rate. Returns floor(n / (2 rate)); *rest receives n modulo 2 rate. */
static int32_t place_of(int32_t i, int32_t rate, int32_t *rest)
{
    const int32_t n = 2 * i + 1 - rate, steps = 2 * rate;
    const int32_t place = (n + steps) / steps - 1;         /* n > -steps, so the dividend is positive */
    *rest = n - place * steps;
    return place;
}

static blended_row row_at(const layer *l, int32_t y)
{
    int32_t rest;
    const int32_t place = place_of(y - l->y, l->rate, &rest);
    const ptrdiff_t stride = 4 * (ptrdiff_t)l->width;
    return (blended_row){l->pixels + stride * clamped(place, l->height),
                         l->pixels + stride * clamped(place + 1, l->height), (uint64_t)rest};
}

static inline uint64_t column_at(const layer *l, const blended_row *row, int32_t column)
{
    const ptrdiff_t at = 4 * (ptrdiff_t)clamped(column, l->width);
    return load(row->above + at) * (2 * (uint64_t)l->rate - row->weight) + load(row->below + at) * row->weight;
}

/* Returns the opacity of a layer at a distance inside an edge: OPAQUE (inside + 1/2) / fade. */
static inline int32_t ramp(const layer *l, int32_t inside, int edge)
{
    return inside < l->fade[edge] ? ((2 * inside + 1) * l->slope_q15) >> 16 : OPAQUE;
}

/* Draws part of a layer's row. fading: blends over the picture instead of replacing it. */
static inline void draw_pixels(const layer *l, const blended_row *row, int32_t rate, int fading, int32_t opacity,
                               int32_t first, int32_t end, uint8_t *to)
{
    const int shift = rate == 1 ? 2 : rate == 2 ? 4 : 6;
    const int32_t steps = 2 * rate;
    const uint64_t half = LANES << (shift - 1);
    int32_t rest, column = place_of(first - l->x, rate, &rest);
    uint64_t left, right = column_at(l, row, column);
    for (int32_t x = first; x < end; rest -= steps) {
        left = right;
        right = column_at(l, row, ++column);
        uint64_t sum = left * (uint64_t)(steps - rest) + right * (uint64_t)rest + half;
        const uint64_t growth = 2 * (right - left);
        for (; rest < steps && x < end; rest += 2, x++, sum += growth) {
            uint8_t *at = to + 4 * (ptrdiff_t)x;
            uint64_t pixel = over(sum, shift);
            if (fading) {
                const int32_t shown = least(opacity, least(ramp(l, x - l->x, 0), ramp(l, l->end_x - 1 - x, 2)));
                pixel = over(pixel * (uint64_t)shown + load(at) * (uint64_t)(OPAQUE - shown) + (LANES << 7), 8);
            }
            store(at, pixel);
        }
    }
}

static void draw_span(const layer *l, const blended_row *row, int32_t opacity, int32_t first, int32_t end, uint8_t *to)
{
    const int32_t solid = opacity < OPAQUE ? end : l->x + l->fade[0], solid_end = l->end_x - l->fade[2];
    const int32_t from = solid < first ? first : least(solid, end), till = solid_end < from ? from
                                                                                            : least(solid_end, end);
    draw_pixels(l, row, l->rate, 1, opacity, first, from, to);
    if (l->rate == 1)
        memcpy(to + 4 * (ptrdiff_t)from, row->above + 4 * (ptrdiff_t)(from - l->x), 4 * (size_t)(till - from));
    else if (l->rate == 2)                       /* constant rate, so that the compiler unrolls the loop */
        draw_pixels(l, row, 2, 0, opacity, from, till, to);
    else
        draw_pixels(l, row, 4, 0, opacity, from, till, to);
    draw_pixels(l, row, l->rate, 1, opacity, till, end, to);
}

/* Draws a row of a layer, except the part that the next finer layer hides. finer may be null. */
static void draw_row(const layer *l, const layer *finer, int32_t y, uint8_t *to)
{
    if (y < l->y || y >= l->end_y)
        return;
    const blended_row row = row_at(l, y);
    const int32_t opacity = least(ramp(l, y - l->y, 1), ramp(l, l->end_y - 1 - y, 3));
    int32_t hidden = l->end_x, hidden_end = l->end_x;
    if (finer && y >= finer->inside.first[1] && y < finer->inside.end[1] &&
        finer->inside.first[0] < finer->inside.end[0]) {
        hidden = finer->inside.first[0];
        hidden_end = finer->inside.end[0];
    }
    draw_span(l, &row, opacity, l->x, least(hidden, l->end_x), to);
    if (hidden_end < l->end_x)
        draw_span(l, &row, opacity, hidden_end > l->x ? hidden_end : l->x, l->end_x, to);
}

static void draw_rows(void *argument, uint32_t job)
{
    const composition *c = argument;
    const uint32_t eye = job / c->jobs_of_eye;
    const fxs_image *image = &c->targets[eye].colour;
    const int32_t first = (int32_t)(job % c->jobs_of_eye) * ROWS, end = least(first + ROWS, c->height);
    for (int32_t y = first; y < end; y++) {
        uint8_t *to = (uint8_t *)image->pixels + image->stride * y;
        for (uint32_t i = c->count; i-- > 0;)
            draw_row(&c->layers[eye][i], i ? &c->layers[eye][i - 1] : 0, y, to);
    }
}

static layer layer_of(const fxs_ring *r, int eye, const uint8_t *pixels, int32_t band, const fxs_camera *camera)
{
    const rectangle inside = inside_of(r, eye, band, camera);
    layer l = {pixels, r->width, r->height, r->rate, r->x[eye], r->y[eye], 0, 0, 0, {0, 0, 0, 0}, inside};
    l.slope_q15 = band ? (OPAQUE << 15) / band : 0;
    l.end_x = least(l.x + r->width * r->rate, camera->width);
    l.end_y = least(l.y + r->height * r->rate, camera->height);
    l.fade[0] = inside.first[0] - l.x;
    l.fade[1] = inside.first[1] - l.y;
    l.fade[2] = l.end_x - inside.end[0];
    l.fade[3] = l.end_y - inside.end[1];
    return l;
}

static int in_range(const fxs_foveation *f)
{
    return f->radius[0] >= 1 && f->radius[1] > f->radius[0] && f->radius[1] <= FXS_MAX_SIZE && f->band >= 0 &&
           f->band <= f->radius[0];
}

static int has_size(const fxs_camera *camera)
{
    return camera->width >= 1 && camera->height >= 1 && camera->width <= FXS_MAX_SIZE &&
           camera->height <= FXS_MAX_SIZE;
}

static size_t bytes_of(const fxs_ring *rings, uint32_t count, uint32_t eyes)
{
    size_t pixels = 0;
    for (uint32_t i = 0; i < count; i++)
        pixels += pixels_of(&rings[i]);
    return pixels * 4 * eyes;
}

size_t fxs_foveation_bytes(const fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes)
{
    fxs_ring rings[FXS_RINGS];
    if (!foveation || !cameras || eyes < 1 || eyes > 2 || !in_range(foveation) || !has_size(cameras))
        return 0;
    return bytes_of(rings, find_rings(rings, foveation, cameras, eyes), eyes);
}

static int check_target(const fxs_targets *t, const fxs_camera *camera, fxs_message *why)
{
    if (t->format != FXS_FORMAT_RGBA8 && t->format != FXS_FORMAT_RGBA8_COVERAGE)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "a foveated picture has 8 bits a channel, as RGBA");
    if (!t->colour.pixels || t->coverage.pixels || t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels ||
        t->occluder.pixels || t->backdrop.pixels)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "a foveated picture has colours only: no depth, id or coverage "
                           "target, occluder or backdrop");
    const ptrdiff_t row = 4 * (ptrdiff_t)camera->width;
    if (camera->height > 1 && t->colour.stride < row && t->colour.stride > -row)
        return fxs_fail_as(FXS_ERR_TARGET, why, "%s", fxs_strerror(FXS_ERR_TARGET));
    return 0;
}

static int check(const fxs_request *q, const fxs_foveation *f, fxs_message *why)
{
    if (!f || q->eyes < 1 || q->eyes > 2)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "one or two eyes, and a foveation");
    if (!in_range(f))
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "foveation: radii of %ld and %ld pixels, a band of %ld: expected 1 "
                           "to %d, the second larger, and a band of at most the first", (long)f->radius[0],
                           (long)f->radius[1], (long)f->band, FXS_MAX_SIZE);
    for (uint32_t eye = 0; eye < q->eyes; eye++) {
        const fxs_camera *camera = &q->cameras[eye];
        if (!has_size(camera) || camera->width != q->cameras->width || camera->height != q->cameras->height)
            return fxs_fail_as(FXS_ERR_SIZE, why, "%s", fxs_strerror(FXS_ERR_SIZE));
        if (camera->cx_q12 < FAR_Q12 || camera->cy_q12 < FAR_Q12)
            return fxs_fail_as(FXS_ERR_CAMERA, why, "a principal point so far out that no window has one");
        const int error = check_target(&q->targets[eye], camera, why);
        if (error)
            return error;
    }
    return 0;
}

static void compose(const fxs_request *q, const fxs_foveation *f, const fxs_foveated *all, const uint8_t *pixels,
                    fxs_run_fn *run, void *pool)
{
    composition c = {.count = all->count, .height = q->cameras->height, .targets = q->targets};
    for (uint32_t i = 0; i < all->count; i++)
        for (uint32_t eye = 0; eye < q->eyes; eye++, pixels += 4 * pixels_of(&all->rings[i]))
            c.layers[eye][i] = layer_of(&all->rings[i], (int)eye, pixels, f->band, q->cameras);
    c.jobs_of_eye = (uint32_t)side_at(c.height, ROWS);
    if (run)
        run(pool, draw_rows, &c, c.jobs_of_eye * q->eyes);
    for (uint32_t job = 0; job < c.jobs_of_eye * q->eyes && !run; job++)
        draw_rows(&c, job);
}

int fxs_foveate(const fxs_backend *backend, void *self, const fxs_request *request, const fxs_foveation *foveation,
                void *memory, size_t memory_bytes, fxs_run_fn *run, void *pool, fxs_foveated *out, fxs_message *why)
{
    fxs_foveated own, *all = out ? out : &own;
    uint8_t *pixels = memory;
    const uint64_t start = fxs_clock(0);
    memset(all, 0, sizeof *all);
    int error = check(request, foveation, why);
    if (error)
        return error;
    all->count = find_rings(all->rings, foveation, request->cameras, request->eyes);
    const size_t bytes = bytes_of(all->rings, all->count, request->eyes);
    if (!memory || memory_bytes < bytes)
        return fxs_fail_memory(why, 0, bytes);
    for (uint32_t i = 0; i < all->count; i++) {
        fxs_ring *r = &all->rings[i];
        error = render_ring(backend, self, request, r, i ? r - 1 : 0, foveation->band,
                            budget_of(all, r, request), pixels, why);
        if (error)
            return error;
        add_stats(all, r);
        all->device_nanoseconds += backend->nanoseconds(self);
        pixels += 4 * pixels_of(r) * request->eyes;
    }
    const uint64_t rendered = fxs_clock(0);
    compose(request, foveation, all, memory, run, pool);
    all->compose_nanoseconds = fxs_clock(0) - rendered;
    all->stats.frame_nanoseconds = fxs_clock(0) - start;
    return 0;
}
