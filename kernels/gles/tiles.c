/* The exact picture: the lists of as many tiles as the texture of records holds are uploaded and drawn, and so on. A
   list that no draw can hold is drawn in parts, with the tile's state kept in a texture in between. Each tile is drawn
   as four blocks of 8x8 pixels, each with the splats of the tile's list that may touch it. A splat's record is there
   once for each block: a fetch less than by its number. */
#include "../../src/fixed.h"
#include "../../src/memory.h"
#include "device.h"

#define RECORD 32                  /* bytes */
#define BLOCK 8                    /* pixels */
#define AHEAD 16                   /* entries */

/* A part of the picture that a render target can hold, in pixels and tiles. */
typedef struct window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} window;

/* One upload, in the mapped buffer: lists of the window's blocks, then records. How many a row of tiles has is not
   known before they are put, so each has room for the most, and begins a row of the texture. */
typedef struct batch {
    fxs_gles *gles;
    const fxs_tile_run *run;
    const window *window;
    uint32_t *lists, *records;
    uint32_t count, capacity;      /* records: room taken, and in all */
    int32_t first, end;            /* tiles, by number in the window */
    uint32_t starts[FXS_MAX_SIZE / FXS_TILE];   /* first record of each row of tiles, from that of `first` on */
    uint32_t ends[FXS_MAX_SIZE / FXS_TILE];     /* the one after the last */
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

/* Textures large enough for a run, where that can be. */
static void make_room(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    uint64_t records = 0;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++)
        records += run->counts[tile];
    const uint64_t wanted = (8 * records >> g->shift) + 1 + (uint64_t)w->rows, most = UINT64_C(1) << g->shift;
    const int32_t rows = (int32_t)(wanted < most ? wanted : most);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->columns > g->columns || w->rows > g->rows) {
        g->columns = w->columns > g->columns ? w->columns : g->columns;
        g->rows = w->rows > g->rows ? w->rows : g->rows;
        make_texture(g, FXS_GLES_LISTS, GL_RG32UI, GL_RG_INTEGER, 2 * g->columns, 2 * g->rows);
    }
    if (rows > g->record_rows)
        make_texture(g, FXS_GLES_RECORDS, GL_RGBA32UI, GL_RGBA_INTEGER, 1 << g->shift, g->record_rows = rows);
}

/* Buffers take turns, so that none is waited for. (Making their storage anew for each batch takes 20 ms for 50 MB.) */
static int begin_batch(batch *b, int32_t first)
{
    fxs_gles *g = b->gles;
    size_t lists = 4 * (size_t)b->window->columns * (size_t)b->window->rows;
    b->capacity = (uint32_t)g->record_rows << (g->shift - 1);
    GLsizeiptr bytes = (GLsizeiptr)(lists * 8 + (size_t)b->capacity * RECORD);
    b->lists = fxs_gles_map(g, GL_PIXEL_UNPACK_BUFFER, (int)(g->turn++ % FXS_GLES_UPLOADS), bytes);
    if (!b->lists)
        return FXS_ERR_DEVICE;
    b->records = b->lists + 2 * lists;
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
    const uint32_t across = 1u << (g->shift - 1);
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    upload(g, FXS_GLES_LISTS, 2 * row, 2 * columns, 2 * rows, GL_RG_INTEGER, (size_t)(row * columns) * 32);
    for (int32_t i = 0; i < rows; i++)
        upload(g, FXS_GLES_RECORDS, (int32_t)(b->starts[i] / across), 1 << g->shift,
               (int32_t)((b->ends[i] - b->starts[i] + across - 1) / across), GL_RGBA_INTEGER,
               (size_t)(b->records - b->lists) * 4 + (size_t)b->starts[i] * RECORD);
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

/* How near to 0 a coordinate comes over a block, that is at_first at its first pixel. */
static int nearest_q13(uint32_t at_first, int32_t step_x, int32_t step_y)
{
    const uint32_t steps = BLOCK - 1;
    const int low = fxs_coordinate_q13(
        (int32_t)(at_first + steps * (uint32_t)fxs_min(step_x, 0) + steps * (uint32_t)fxs_min(step_y, 0)));
    const int high = fxs_coordinate_q13((int32_t)(at_first + steps * (uint32_t)(step_x - fxs_min(step_x, 0)) +
                                                  steps * (uint32_t)(step_y - fxs_min(step_y, 0))));
    return -fxs_min(fxs_min(-low, high), 0);
}

/* May a splat count at a pixel of the block at (x, y)? Of u and v, level takes the nearest to 0, if not at one pixel. */
static int touches(const fxs_splat *s, uint32_t x, uint32_t y, int cut_q11)
{
    if (s->first_row > y + BLOCK - 1 || s->last_row < y)
        return 0;
    const int v = nearest_q13(s->v0_q24 + y * (uint32_t)s->vy_q24, 0, s->vy_q24);
    const int u = nearest_q13(s->u0_q24 + x * (uint32_t)s->ux_q24 + y * (uint32_t)s->uy_q24, s->ux_q24, s->uy_q24);
    return fxs_level_q11(u, fxs_row_level_q11(v, s->offset_q11)) <= fxs_limit_q11(s->offset_q11, cut_q11);
}

/* Puts the records of a block from `at` on. Returns the one after the last. */
static uint32_t put_block(const batch *b, uint32_t x, uint32_t y, uint32_t at, const uint32_t *entries, uint32_t count)
{
    const fxs_splat *splats = b->run->splats;
    const int cut_q11 = b->run->view->cut_q11;
    for (uint32_t i = 0; i < count; i++) {
        if (i + AHEAD < count)
            FXS_PREFETCH(&splats[entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        if (!(entries[i] & FXS_ENTRY_FAR) && touches(&splats[entries[i]], x, y, cut_q11))
            put_record(b->records + RECORD / 4 * (size_t)at++, &splats[entries[i]]);
    }
    return at;
}

/* Says where a block's list is; where it ends before it starts, the block is not drawn. */
static void put_list(const batch *b, int32_t tile, uint32_t block, uint32_t first, uint32_t end)
{
    const uint32_t columns = (uint32_t)b->window->columns, t = (uint32_t)tile;
    uint32_t *list = b->lists + 4 * ((2 * (t / columns) + block / 2) * columns + t % columns) + 2 * (block % 2);
    list[0] = first;
    list[1] = end;
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

static void put_nothing(const batch *b, int32_t tile)
{
    for (uint32_t block = 0; block < 4; block++)
        put_list(b, tile, block, 1, 0);
}

/* Puts the lists of a tile, and their records from `at` on. Returns the one after the last. */
static uint32_t put_tile(const batch *b, int32_t tile, uint32_t at, const uint32_t *entries, uint32_t count)
{
    const uint32_t t = tile_of(b, tile), across = (uint32_t)b->run->view->tiles_x;
    for (uint32_t block = 0; block < 4; block++) {
        const uint32_t x = t % across * FXS_TILE + block % 2 * BLOCK, y = t / across * FXS_TILE + block / 2 * BLOCK;
        const uint32_t end = put_block(b, x, y, at, entries, count);
        put_list(b, tile, block, at, end);
        at = end;
    }
    return at;
}

/* Fills a row of tiles, the job-th of the batch. */
static void put_row(void *argument, uint32_t job)
{
    batch *b = argument;
    const fxs_tile_run *run = b->run;
    const int32_t columns = b->window->columns, start = (b->first / columns + (int32_t)job) * columns;
    uint32_t at = b->starts[job];
    for (int32_t tile = start; tile < start + columns; tile++) {
        const uint32_t t = tile_of(b, tile);
        if (tile < b->first || tile >= b->end || !in_run(b, t))
            put_nothing(b, tile);
        else
            at = put_tile(b, tile, at, run->entries + run->ends[t] - run->counts[t], run->counts[t]);
    }
    b->ends[job] = at;
}

/* Entries that a tile's list may have to be drawn at once. */
static uint32_t longest(const fxs_gles *g)
{
    return least(((uint32_t)g->record_rows << (g->shift - 1)) / 4, FXS_GLES_LOOP);
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

static void draw(const batch *b, const surface *s, int carried)
{
    const fxs_gles *g = b->gles;
    const fxs_gl *gl = &g->gl;
    const fxs_gles_program *p = &g->programs[s->program];
    const fxs_options *o = b->run->options;
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->framebuffer);
    gl->Viewport(s->x, s->y, s->width, s->height);
    gl->Scissor(s->x, s->y + s->first_line, s->width, s->lines);
    gl->UseProgram(p->name);
    /* gl_FragCoord counts from the framebuffer's corner. */
    gl->Uniform4i(p->place, s->pixel_x - s->x, s->pixel_y - s->row_step * s->y, s->row_step, carried);
    gl->Uniform4i(p->source, b->window->first_column, b->window->first_row, g->shift, b->run->view->cut_q11);
    gl->Uniform4i(p->background, fxs_background_q13(o, 0), fxs_background_q13(o, 1), fxs_background_q13(o, 2),
                  o->format == FXS_FORMAT_RGBA8_COVERAGE);
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
            put_nothing(b, other);
        b->starts[0] = 0;
        b->ends[0] = put_tile(b, tile, 0, entries + done, part);
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
    const uint32_t across = 1u << (b->gles->shift - 1);
    b->starts[0] = 0;
    for (; b->end < tiles; b->end++) {
        const uint32_t tile = tile_of(b, b->end), count = in_run(b, tile) ? b->run->counts[tile] : 0;
        if (b->end % columns == 0)
            b->starts[b->end / columns - row] = b->count = (b->count + across - 1) / across * across;
        if (count > least(longest(b->gles), (b->capacity - b->count) / 4))
            break;
        b->count += 4 * count;
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

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    batch b = {g, run, w, 0, 0, 0, 0, 0, 0, {0}, {0}};
    int error = 0;
    make_room(g, run, w);
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
    int error = g->target ? 0 : fxs_gles_make_target(g, FXS_GLES_TARGET, GL_RGBA8UI, fxs_min(v->width, most),
                                                     fxs_min(v->height, most));
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
