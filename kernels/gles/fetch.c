/* Draws the picture without per-tile lists of splats. One draw has all splats near to far, each as one or two
 * triangles. The fragment shader reads its pixel's state from the framebuffer, which is cheap on a tile-based GPU, and
 * writes the next state. A second draw over the whole picture resolves the states. */
#include <fixsplat/internal/fixed.h>
#include "src/core/memory.h"
#include "src/core/lister.h"
#include "device.h"

#define TEXELS 3u                  /* number of texels in the record of a triangle */
#define RECORD (TEXELS * 16)
#define PARTS 64u
#define AHEAD 16
#define GUARD 3           /* size of the GL viewport relative to the drawn window; the large viewport avoids clipping */
/* Splats from this radius in pixels on are drawn as a rectangle of two triangles. The rectangle has a quarter fewer
   pixels than one triangle around the splat. */
#define LARGE 12

enum { TRIANGLE = 0, RECTANGLE = 2, VEIL = 4 };  /* shapes of splats; shape + 1: second triangle of the shape */

typedef struct batch {
    const fxs_tile_run *run;
    const fxs_gles_window *window;
    uint32_t first, end;
    uint32_t counts[PARTS];
    uint32_t *records;
} batch;

static uint32_t part_start(const batch *b, uint32_t part)
{
    return b->first + fxs_part(b->end - b->first, PARTS, part);
}

typedef struct drawn {
    uint32_t count, shape;
    fxs_span columns, rows;
} drawn;

static int overlaps(int64_t first_q8, int64_t last_q8, int32_t start, int32_t length)
{
    return first_q8 < (int64_t)(start + length) * 256 && last_q8 > (int64_t)(start - 1) * 256;
}

static int is_veil(const fxs_bounds *b)
{
    return b->half_width_q8 == FXS_EVERYWHERE_Q8;
}

/* Returns the range of tile columns that a splat touches, computed as the tile rows in the transposed picture. */
static fxs_span columns_of(const fxs_stage_view *view, const fxs_splat *s, const fxs_bounds *b)
{
    fxs_stage_view turned = *view;
    fxs_bounds bounds = *b;
    turned.tiles_y = view->tiles_x;
    bounds.cy_q14 = b->cx_q14;
    return fxs_bin_rows(&turned, s, &bounds);
}

static drawn drawn_of(const batch *b, uint32_t slot)
{
    const fxs_stage_view *view = b->run->view;
    const fxs_gles_window *w = b->window;
    const fxs_splat *s = &b->run->splats[slot];
    const fxs_bounds *bounds = &b->run->bounds[slot];
    const int64_t x_q8 = bounds->cx_q14 >> 6, half_q8 = bounds->half_width_q8;
    drawn d = {0, TRIANGLE, {0, view->tiles_x}, {0, view->tiles_y}};
    if (view->cutoff == FXS_CUTOFF_SQUARE) {
        d.columns = columns_of(view, s, bounds);
        d.rows = fxs_bin_rows(view, s, bounds);
        if (d.columns.first > d.columns.last || d.rows.first > d.rows.last)
            return d;
    }
    if (is_veil(bounds))
        d = (drawn){2, VEIL, d.columns, d.rows};
    else if (overlaps(x_q8 - half_q8, x_q8 + half_q8, w->x, w->width) &&
             overlaps((int64_t)s->first_row * 256, (int64_t)s->last_row * 256, w->y, w->height)) {
        const int large = half_q8 >= LARGE * 256 && s->last_row - s->first_row >= 2 * LARGE;
        d.count = large ? 2 : 1;
        d.shape = large ? RECTANGLE : TRIANGLE;
    }
    return d;
}

static void put_record(uint32_t *record, const fxs_splat *s, const fxs_bounds *b, const drawn *d, uint32_t half,
                       uint32_t depth)
{
    const uint32_t words[RECORD / 4] = {
        s->u0_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, s->v0_q24,
        (uint32_t)s->vy_q24, s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
        (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16,
        (uint32_t)d->columns.first | (uint32_t)d->columns.last << 16,
        (uint32_t)b->cx_q14, (uint32_t)b->cy_q14,
        (d->shape + half) | (uint32_t)d->rows.first << 4 | (uint32_t)d->rows.last << 20, depth};
    memcpy(record, words, sizeof words);
}

static void count_part(void *argument, uint32_t part)
{
    batch *b = argument;
    uint32_t count = 0;
    for (uint32_t i = part_start(b, part), end = part_start(b, part + 1); i < end; i++) {
        if (i + AHEAD < end)
            FXS_PREFETCH(&b->run->bounds[FXS_KEY_SLOT(b->run->keys[i + AHEAD])]);
        count += drawn_of(b, FXS_KEY_SLOT(b->run->keys[i])).count;
    }
    b->counts[part] = count;
}

static void fill_part(void *argument, uint32_t part)
{
    const batch *b = argument;
    const fxs_tile_run *run = b->run;
    uint32_t *record = b->records + RECORD / 4 * (size_t)b->counts[part];
    for (uint32_t i = part_start(b, part), end = part_start(b, part + 1); i < end; i++) {
        const uint32_t slot = FXS_KEY_SLOT(run->keys[i]);
        const drawn d = drawn_of(b, slot);
        if (i + AHEAD < end) {
            const uint32_t next = FXS_KEY_SLOT(run->keys[i + AHEAD]);
            FXS_PREFETCH(&run->splats[next]);
            FXS_PREFETCH(&run->bounds[next]);
        }
        for (uint32_t half = 0; half < d.count; half++, record += RECORD / 4)
            put_record(record, &run->splats[slot], &run->bounds[slot], &d, half, run->depths[slot]);
    }
}

/* Chooses b->end, the end of the batch of splats, so that the batch has at most `capacity` records (one per triangle).
   Returns the number of records. */
static uint32_t take_splats(batch *b, uint32_t capacity)
{
    uint32_t parts = 0, count = 0;
    b->end = b->run->visible;
    for (;;) {
        fxs_run(b->run->config, count_part, b, PARTS);
        for (parts = 0, count = 0; parts < PARTS && b->counts[parts] <= capacity - count; parts++)
            count += b->counts[parts];
        if (parts == PARTS)
            break;
        b->end = part_start(b, parts ? parts : 1);
    }
    for (uint32_t part = 0, at = 0; part < PARTS; part++) {
        const uint32_t next = at + b->counts[part];
        b->counts[part] = at;
        at = next;
    }
    return count;
}

static int upload(fxs_gles *g, batch *b, uint32_t count)
{
    const uint32_t width = 1u << g->shift, rows = (count * TEXELS + width - 1) >> g->shift;
    b->records = fxs_gles_map(g, (GLsizeiptr)rows * (GLsizeiptr)width * 16);
    if (!b->records)
        return fxs_gl_failure(&g->gl);
    fxs_run(b->run->config, fill_part, b, PARTS);
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    fxs_gles_upload(g, FXS_GLES_RECORDS, 0, (int32_t)width, (int32_t)rows, GL_RGBA_INTEGER, 0);
    return 0;
}

static int begin_states(fxs_gles *g, const fxs_gles_window *w)
{
    static const GLint clear[4] = {FXS_CLEAR_Q15, 0, 0, 0};
    const fxs_gl *gl = &g->gl;
    gl->ActiveTexture(GL_TEXTURE0 + FXS_GLES_CARRIED);
    gl->BindTexture(GL_TEXTURE_2D, g->textures[FXS_GLES_WHOLE]);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_WHOLE_STATE]);
    if (w->width > g->whole[0] || w->height > g->whole[1]) {
        g->whole[0] = w->width > g->whole[0] ? w->width : g->whole[0];
        g->whole[1] = w->height > g->whole[1] ? w->height : g->whole[1];
        gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16I, g->whole[0], g->whole[1], 0, GL_RGBA_INTEGER, GL_SHORT, 0);
        if (gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            g->whole[0] = g->whole[1] = 0;
            return fxs_gl_failure(&g->gl);
        }
    }
    gl->Scissor(0, 0, w->width, w->height);
    gl->ClearBufferiv(GL_COLOR, 0, clear);
    return 0;
}

static int32_t guard_of(const fxs_gles *g, const fxs_gles_window *w)
{
    return GUARD * w->width <= g->viewport[0] && GUARD * w->height <= g->viewport[1] ? GUARD : 1;
}

static void draw(const fxs_gles *g, const batch *b, uint32_t count)
{
    const fxs_gles_window *w = b->window;
    const fxs_stage_view *view = b->run->view;
    const int limited = view->cutoff == FXS_CUTOFF_SQUARE || fxs_gles_has_occluder(g, b->run);
    const fxs_gles_program *p = &g->programs[limited ? FXS_GLES_LIMITED : FXS_GLES_BLEND];
    const int32_t guard = guard_of(g, w), beside = guard / 2;
    g->gl.Viewport(-beside * w->width, -beside * w->height, guard * w->width, guard * w->height);
    g->gl.UseProgram(p->name);
    g->gl.Uniform4i(p->size, w->width, w->height, view->cut_q11, g->shift);
    g->gl.Uniform4i(p->place, w->x, w->y, guard, 0);
    fxs_gles_set_mesh(g, b->run, w, p);
    g->gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * count));
}

static void resolve(const fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    const int32_t source[4] = {w->x, w->y, 0, 0};
    const fxs_gles_surface s = fxs_gles_surface_of(g, run, w, 0, w->height, FXS_GLES_RESOLVED_INTEGER,
                                                   FXS_GLES_RESOLVED_NORMALISED);
    fxs_gles_aim(g, run, w, &s, 0, source);
    g->gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    batch b = {.run = run, .window = w};
    int error = begin_states(g, w);
    for (; b.first < run->visible && !error; b.first = b.end) {
        const uint32_t count = take_splats(&b, (1u << 2 * g->shift) / TEXELS);
        fxs_gles_make_records(g, (uint64_t)count * TEXELS);
        error = count ? upload(g, &b, count) : 0;
        if (!error && count)
            draw(g, &b, count);
    }
    if (!error)
        resolve(g, run, w);
    return error;
}

int fxs_gles_draw_fetch(void *argument, const fxs_tile_run *run)
{
    fxs_gles *g = argument;
    return g->no_fetch[0] ? FXS_ERR_UNSUPPORTED : fxs_gles_draw_windows(g, run, g->most, draw_window);
}

