/* The exact picture: the lists of as many tiles as the texture of records holds are uploaded and drawn, and so on. A
   list that no draw can hold is drawn in parts, with the tile's state kept in a texture in between. A splat's record
   is there once for each list that it is in: a fetch less than by its number, and one pass over the lists. */
#include "../../src/fixed.h"
#include "../../src/memory.h"
#include "device.h"

#define RECORD 32                  /* bytes */
#define AHEAD 16                   /* entries */

/* A part of the picture that a render target can hold, in pixels and tiles. */
typedef struct window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} window;

/* One upload, in the mapped buffer: lists of the window's tiles, then records. */
typedef struct batch {
    fxs_gles *gles;
    const fxs_tile_run *run;
    const window *window;
    uint32_t *lists, *records, *depths;         /* depths: null without an occluder */
    uint32_t count, capacity;      /* records */
    int32_t first, end;            /* tiles, by number in the window */
    uint32_t starts[FXS_MAX_SIZE / FXS_TILE];   /* first record of each row of tiles, from that of `first` on */
} batch;

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* ---- Uploads ----------------------------------------------------------------------------------------------------- */

static void make_texture(const fxs_gles *g, int unit, GLint format, GLenum layout, int32_t width, int32_t height)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.TexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, layout, GL_UNSIGNED_INT, 0);
}

static int has_occluder(const fxs_gles *g, const fxs_tile_run *run)
{
    return g->target ? g->target->occluder || g->target->depth_buffer : run->targets->occluder.pixels != 0;
}

/* Textures large enough for a run, where that can be. */
static void make_room(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    uint64_t records = 0;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++)
        records += run->counts[tile];
    const uint64_t wanted = (2 * records >> g->shift) + 1, most = UINT64_C(1) << g->shift;
    const int32_t rows = (int32_t)(wanted < most ? wanted : most);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->columns > g->columns || w->rows > g->rows) {
        g->columns = w->columns > g->columns ? w->columns : g->columns;
        g->rows = w->rows > g->rows ? w->rows : g->rows;
        make_texture(g, FXS_GLES_LISTS, GL_RG32UI, GL_RG_INTEGER, g->columns, g->rows);
    }
    if (rows > g->record_rows)
        make_texture(g, FXS_GLES_RECORDS, GL_RGBA32UI, GL_RGBA_INTEGER, 1 << g->shift, g->record_rows = rows);
    if (has_occluder(g, run) && (g->record_rows + 1) / 2 > g->depth_rows)
        make_texture(g, FXS_GLES_DEPTHS, GL_R32UI, GL_RED_INTEGER, 1 << g->shift,
                     g->depth_rows = (g->record_rows + 1) / 2);
}

/* Buffers take turns, so that none is waited for. (Making their storage anew for each batch takes 20 ms for 50 MB.) */
static int begin_batch(batch *b, int32_t first)
{
    fxs_gles *g = b->gles;
    size_t lists = (size_t)b->window->columns * (size_t)b->window->rows;
    b->capacity = (uint32_t)g->record_rows << (g->shift - 1);
    const int occluded = has_occluder(g, b->run);
    const size_t depths = occluded ? (size_t)((g->record_rows + 1) / 2) << g->shift : 0;    /* whole rows */
    GLsizeiptr bytes = (GLsizeiptr)(lists * 8 + (size_t)b->capacity * RECORD + depths * 4);
    b->lists = fxs_gles_map(g, GL_PIXEL_UNPACK_BUFFER, (int)(g->turn++ % FXS_GLES_UPLOADS), bytes);
    if (!b->lists)
        return fxs_gles_failure(g);
    b->records = b->lists + 2 * lists;
    b->depths = occluded ? b->records + RECORD / 4 * (size_t)b->capacity : 0;
    b->count = 0;
    b->first = b->end = first;
    return 0;
}

static void upload(const fxs_gles *g, int unit, int32_t y, int32_t width, int32_t height, GLenum layout, size_t offset)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    if (height)
        g->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, width, height, layout, GL_UNSIGNED_INT, (const void *)offset);
}

static int end_batch(batch *b)
{
    fxs_gles *g = b->gles;
    const int32_t columns = b->window->columns, row = b->first / columns, rows = (b->end - 1) / columns - row + 1;
    const int32_t record_rows = (int32_t)((2 * b->count + (1u << g->shift) - 1) >> g->shift);
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    upload(g, FXS_GLES_LISTS, row, columns, rows, GL_RG_INTEGER, (size_t)(row * columns) * 8);
    upload(g, FXS_GLES_RECORDS, 0, 1 << g->shift, record_rows, GL_RGBA_INTEGER, (size_t)(b->records - b->lists) * 4);
    if (b->depths)
        upload(g, FXS_GLES_DEPTHS, 0, 1 << g->shift, (record_rows + 1) / 2, GL_RED_INTEGER,
               (size_t)(b->depths - b->lists) * 4);
    return 0;
}

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* A splat as the shader reads it: first what rejects it. */
static void put_record(uint32_t *record, const fxs_splat *s)
{
    const uint32_t words[RECORD / 4] = {
        s->u0_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, s->first_row | (uint32_t)s->last_row << 16,
        s->v0_q24, (uint32_t)s->vy_q24, s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
        (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16};
    memcpy(record, words, sizeof words);
}

/* One whose ellipse does not touch the tile becomes a record with no rows: no pixel takes it. */
static void put_records(const batch *b, uint32_t at, const uint32_t *entries, uint32_t count)
{
    static const fxs_splat nothing = {.first_row = 1};
    const fxs_splat *splats = b->run->splats;
    for (uint32_t i = 0; i < count; i++) {
        if (i + AHEAD < count)
            FXS_PREFETCH(&splats[entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        put_record(b->records + RECORD / 4 * (size_t)(at + i),
                   entries[i] & FXS_ENTRY_FAR ? &nothing : &splats[entries[i]]);
        if (b->depths)
            b->depths[at + i] = b->run->depths[entries[i] & ~FXS_ENTRY_FAR];
    }
}

/* Says where a tile's list is; where it ends before it starts, the tile is not drawn. */
static void put_list(const batch *b, int32_t tile, uint32_t first, uint32_t end)
{
    b->lists[2 * tile] = first;
    b->lists[2 * tile + 1] = end;
}

/* A window's tile in the picture; outside the run where it is not first_tile to last_tile. */
static uint32_t tile_of(const batch *b, int32_t tile)
{
    const window *w = b->window;
    return (uint32_t)((w->first_row + tile / w->columns) * b->run->view->tiles_x + w->first_column +
                      tile % w->columns);
}

static int in_run(const batch *b, uint32_t tile)
{
    return tile >= b->run->first_tile && tile <= b->run->last_tile;
}

/* Fills a row of tiles, the job-th of the batch. */
static void put_row(void *argument, uint32_t job)
{
    const batch *b = argument;
    const fxs_tile_run *run = b->run;
    const int32_t columns = b->window->columns, start = (b->first / columns + (int32_t)job) * columns;
    uint32_t at = b->starts[job];
    for (int32_t tile = start; tile < start + columns; tile++) {
        const uint32_t t = tile_of(b, tile);
        if (tile < b->first || tile >= b->end || !in_run(b, t)) {
            put_list(b, tile, 1, 0);
            continue;
        }
        put_list(b, tile, at, at + run->counts[t]);
        put_records(b, at, run->entries + run->ends[t] - run->counts[t], run->counts[t]);
        at += run->counts[t];
    }
}

/* Entries that a tile's list may have to be drawn at once. */
static uint32_t longest(const fxs_gles *g)
{
    return least((uint32_t)g->record_rows << (g->shift - 1), FXS_GLES_LOOP);
}

/* ---- Draws ------------------------------------------------------------------------------------------------------- */

/* Where the fragments of a draw go. */
typedef struct surface {
    GLuint framebuffer;
    int program;
    int32_t x, y, width, height;   /* its viewport */
    int32_t pixel_x, pixel_y, row_step;         /* pixel of the viewport's fragment (0, 0); rows go by */
    int32_t first_line, lines;     /* of the viewport, that the draw covers */
} surface;

/* Where the caller's pictures are: his textures lie as his framebuffer does, those that were uploaded as the window. */
static void set_mesh(const batch *b, const fxs_gles_program *p)
{
    enum { OCCLUDER = 256, BUFFER = 512, BACKDROP = 1024 };
    const fxs_gles_target *t = b->gles->target;
    const fxs_targets *targets = b->run->targets;
    const fxs_gl *gl = &b->gles->gl;
    if (!t) {
        gl->Uniform4i(p->mesh, -b->window->x, -b->window->y, 1,
                      (targets->depth_bits ? targets->depth_bits : 16) + (targets->occluder.pixels ? OCCLUDER : 0) +
                          (targets->backdrop.pixels ? BACKDROP : 0));
        return;
    }
    gl->Uniform4i(p->mesh, 0, t->top_down ? 0 : b->run->view->height - 1, t->top_down ? 1 : -1,
                  (t->depth_bits ? t->depth_bits : 16) + (t->occluder ? OCCLUDER : 0) +
                      (t->depth_buffer ? BUFFER : 0) + (t->backdrop ? BACKDROP : 0));
    gl->Uniform2f(p->planes, 1 / t->plane_0, 1 / t->plane_1);
}

static void draw(const batch *b, const surface *s, int carried)
{
    const fxs_gles *g = b->gles;
    const fxs_gl *gl = &g->gl;
    const fxs_gles_program *p = &g->programs[s->program];
    const uint8_t *background = b->run->options->background;
    const int clear = fxs_is_premultiplied(fxs_gles_format(b->gles, b->run));
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->framebuffer);
    gl->Viewport(s->x, s->y, s->width, s->height);
    gl->Scissor(s->x, s->y + s->first_line, s->width, s->lines);
    gl->UseProgram(p->name);
    /* gl_FragCoord counts from the framebuffer's corner. */
    gl->Uniform4i(p->place, s->pixel_x - s->x, s->pixel_y - s->row_step * s->y, s->row_step, carried);
    gl->Uniform4i(p->source, b->window->first_column, b->window->first_row, g->shift, b->run->view->cut_q11);
    gl->Uniform4i(p->background, clear ? 0 : fxs_background_q13(background[0]),
                  clear ? 0 : fxs_background_q13(background[1]), clear ? 0 : fxs_background_q13(background[2]), clear);
    set_mesh(b, p);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

/* The rows of tiles of a batch, on the back end's target or the caller's. */
static surface surface_of(const batch *b)
{
    const fxs_gles_target *t = b->gles->target;
    const window *w = b->window;
    const int32_t top = b->first / w->columns * FXS_TILE, rows = (b->end - 1) / w->columns * FXS_TILE + FXS_TILE;
    const int32_t lines = fxs_min(rows, w->height) - top;
    if (!t)
        return (surface){b->gles->framebuffers[FXS_GLES_TARGET], FXS_GLES_INTEGER, 0, 0, w->width, w->height, w->x,
                         w->y, 1, top, lines};
    if (t->top_down)
        return (surface){t->framebuffer, FXS_GLES_NORMALISED, t->x, t->y + w->y, w->width, w->height, 0, w->y, 1,
                         top, lines};
    return (surface){t->framebuffer, FXS_GLES_NORMALISED, t->x, t->y + b->run->view->height - w->y - w->height,
                     w->width, w->height, 0, w->y + w->height - 1, -1, w->height - top - lines, lines};
}

/* Tile b->end, whose list is too long for a draw. */
static int draw_parts(batch *b)
{
    const fxs_tile_run *run = b->run;
    const fxs_gles *g = b->gles;
    const int32_t tile = b->end, row = tile / b->window->columns * b->window->columns;
    const uint32_t t = tile_of(b, tile), count = run->counts[t], most = longest(g);
    const uint32_t *entries = run->entries + run->ends[t] - count;
    int error = 0, carried = 0;
    for (uint32_t done = 0, part; done < count && !error; done += part, carried = 1) {
        part = least(count - done, most);
        error = begin_batch(b, tile);
        if (error)
            return error;
        b->end = tile + 1;
        for (int32_t other = row; other < row + b->window->columns; other++)
            put_list(b, other, 1, 0);
        put_list(b, tile, 0, part);
        put_records(b, 0, entries + done, part);
        b->count = part;
        error = end_batch(b);
        surface s = surface_of(b);
        int turn = (int)(done / most % 2);
        if (done + part < count)
            s = (surface){g->framebuffers[FXS_GLES_FIRST_STATE + turn], FXS_GLES_STATE, 0, 0, FXS_TILE, FXS_TILE,
                          (int32_t)t % run->view->tiles_x * FXS_TILE, (int32_t)t / run->view->tiles_x * FXS_TILE, 1,
                          0, FXS_TILE};
        g->gl.ActiveTexture(GL_TEXTURE0 + FXS_GLES_CARRIED);
        g->gl.BindTexture(GL_TEXTURE_2D, g->textures[turn ? FXS_GLES_CARRIED : FXS_GLES_NEXT]);
        draw(b, &s, carried);
    }
    return error;
}

/* Takes as many tiles as fit, from the first on: the end of the batch. */
static void take_tiles(batch *b)
{
    const int32_t columns = b->window->columns, tiles = columns * b->window->rows, row = b->first / columns;
    b->starts[0] = 0;
    for (; b->end < tiles; b->end++) {
        const uint32_t tile = tile_of(b, b->end), count = in_run(b, tile) ? b->run->counts[tile] : 0;
        if (count > least(longest(b->gles), b->capacity - b->count))
            break;
        if (b->end % columns == 0)
            b->starts[b->end / columns - row] = b->count;
        b->count += count;
    }
}

static int draw_batch(batch *b)
{
    int error = begin_batch(b, b->end);
    if (error)
        return error;
    take_tiles(b);
    fxs_run(b->run->config, put_row, b, (uint32_t)((b->end - 1) / b->window->columns -
                                                   b->first / b->window->columns + 1));
    error = end_batch(b);
    surface s = surface_of(b);
    draw(b, &s, 0);
    return error;
}

/* Uploads a window of a picture of 4 bytes a pixel. */
static void put_image(fxs_gles *g, int unit, int32_t size[2], const fxs_image *image, const window *w)
{
    const int is_depth = unit == FXS_GLES_OCCLUDER;
    const GLenum layout = is_depth ? GL_RED_INTEGER : GL_RGBA, type = is_depth ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE;
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->width > size[0] || w->height > size[1]) {
        size[0] = w->width > size[0] ? w->width : size[0];
        size[1] = w->height > size[1] ? w->height : size[1];
        g->gl.TexImage2D(GL_TEXTURE_2D, 0, is_depth ? GL_R32UI : GL_RGBA8, size[0], size[1], 0, layout, type, 0);
    }
    for (int32_t y = 0; y < w->height; y++)
        g->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, w->width, 1, layout, type,
                            (const unsigned char *)image->pixels + (w->y + y) * image->stride + 4 * (ptrdiff_t)w->x);
}

static void bind_texture(const fxs_gles *g, int unit, GLuint texture)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.BindTexture(GL_TEXTURE_2D, texture ? texture : g->textures[unit]);
}

/* Has the caller's pictures at their units. */
static void put_mesh(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    if (g->target) {
        bind_texture(g, FXS_GLES_OCCLUDER, g->target->occluder);
        bind_texture(g, FXS_GLES_BUFFER, g->target->depth_buffer);
        bind_texture(g, FXS_GLES_BACKDROP, g->target->backdrop);
        return;
    }
    if (run->targets->occluder.pixels)
        put_image(g, FXS_GLES_OCCLUDER, g->occluder, &run->targets->occluder, w);
    if (run->targets->backdrop.pixels)
        put_image(g, FXS_GLES_BACKDROP, g->backdrop, &run->targets->backdrop, w);
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    batch b = {.gles = g, .run = run, .window = w};
    int error = 0;
    make_room(g, run, w);
    put_mesh(g, run, w);
    while (b.end < w->columns * w->rows && !error) {
        uint32_t tile = tile_of(&b, b.end);
        error = in_run(&b, tile) && run->counts[tile] > longest(g) ? draw_parts(&b) : draw_batch(&b);
    }
    fxs_gles_stop_timer(g);
    return error ? error : fxs_gles_check(g);
}

static int32_t tiles_across(int32_t pixels)
{
    return (pixels + FXS_TILE - 1) / FXS_TILE;
}

int fxs_gles_draw(void *argument, const fxs_tile_run *run)
{
    fxs_gles *g = argument;
    const fxs_view *v = run->view;
    const int32_t top = (int32_t)run->first_tile / v->tiles_x * FXS_TILE;
    const int32_t bottom = fxs_min(((int32_t)run->last_tile / v->tiles_x + 1) * FXS_TILE, v->height);
    const int32_t most = g->target ? FXS_MAX_SIZE : g->most;
    int error = fxs_gles_has(g, run);
    error = error ? error : fxs_gles_use(g);
    if (!error && !g->target)
        error = fxs_gles_make_target(g, FXS_GLES_TARGET, GL_RGBA8UI, fxs_min(v->width, most), fxs_min(v->height, most));
    if (error)
        return error;
    g->nanoseconds = run->first_tile ? g->nanoseconds : 0;
    fxs_gles_set(g);
    for (int32_t y = top; y < bottom && !error; y += most)
        for (int32_t x = 0; x < v->width && !error; x += most) {
            window w = {x, y, fxs_min(v->width - x, most), fxs_min(bottom - y, most), x / FXS_TILE, y / FXS_TILE,
                        0, 0};
            w.columns = tiles_across(w.width);
            w.rows = tiles_across(w.height);
            error = draw_window(g, run, &w);
            if (!error && !g->target)
                error = fxs_gles_read(g, run, FXS_GLES_TARGET, x, y, w.width, w.height);
        }
    return error;
}
