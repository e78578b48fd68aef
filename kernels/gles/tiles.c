/* The exact picture: lists and records are uploaded for as many tiles as the textures hold, drawn, and so on. A list
   that no draw can hold is drawn in parts, with the tile's state kept in a texture in between. */
#include "../../src/memory.h"
#include "device.h"

#define UNLISTED UINT32_MAX

/* A part of the picture that a render target can hold, in pixels and tiles. */
typedef struct window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} window;

/* One upload, in the mapped buffer: lists of the window's tiles, entries, records. */
typedef struct batch {
    fxs_gles *gles;
    const fxs_tile_run *run;
    const window *window;
    uint32_t *lists, *entries, *records;
    uint32_t entry_count, record_count, entry_capacity, record_capacity;
    int32_t first, end;            /* tiles, by number in the window */
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

/* Rows of a texture that hold `count` things, each `texels` long. */
static int32_t rows_for(const fxs_gles *g, uint64_t count, uint64_t texels)
{
    uint64_t rows = ((count * texels) >> g->shift) + 1, most = UINT64_C(1) << g->shift;
    return (int32_t)(rows < most ? rows : most);
}

/* Textures large enough for a run, where that can be. */
static void make_room(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    uint64_t entries = 0;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++)
        entries += run->counts[tile];
    int32_t entry_rows = rows_for(g, entries, 1);
    int32_t record_rows = rows_for(g, entries < run->slots ? entries : run->slots, 2);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->columns > g->columns || w->rows > g->rows) {
        g->columns = w->columns > g->columns ? w->columns : g->columns;
        g->rows = w->rows > g->rows ? w->rows : g->rows;
        make_texture(g, FXS_GLES_LISTS, GL_RG32UI, GL_RG_INTEGER, g->columns, g->rows);
    }
    if (entry_rows > g->entry_rows)
        make_texture(g, FXS_GLES_ENTRIES, GL_R32UI, GL_RED_INTEGER, 1 << g->shift, g->entry_rows = entry_rows);
    if (record_rows > g->record_rows)
        make_texture(g, FXS_GLES_RECORDS, GL_RGBA32UI, GL_RGBA_INTEGER, 1 << g->shift, g->record_rows = record_rows);
}

/* A buffer of its own for each batch: the driver gives the old one's memory back when the device has read it. */
static int begin_batch(batch *b, int32_t first)
{
    const fxs_gles *g = b->gles;
    size_t lists = (size_t)b->window->columns * (size_t)b->window->rows;
    b->entry_capacity = (uint32_t)g->entry_rows << g->shift;
    b->record_capacity = (uint32_t)g->record_rows << (g->shift - 1);
    size_t bytes = lists * 8 + (size_t)b->entry_capacity * 4 + (size_t)b->record_capacity * 32;
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, g->upload);
    g->gl.BufferData(GL_PIXEL_UNPACK_BUFFER, (GLsizeiptr)bytes, 0, GL_STREAM_DRAW);
    b->lists = g->gl.MapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, (GLsizeiptr)bytes,
                                    GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    if (!b->lists)
        return FXS_ERR_DEVICE;
    b->entries = b->lists + 2 * lists;
    b->records = b->entries + b->entry_capacity;
    b->entry_count = b->record_count = 0;
    b->first = b->end = first;
    memset(b->run->scratch, 0xff, b->run->slots * sizeof *b->run->scratch);
    return 0;
}

static void upload(const fxs_gles *g, int unit, int32_t y, int32_t width, int32_t height, GLenum layout, size_t offset)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    if (height)
        g->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, width, height, layout, GL_UNSIGNED_INT, (const void *)offset);
}

static int32_t rows_used(const fxs_gles *g, uint32_t texels)
{
    return (int32_t)((texels + (1u << g->shift) - 1) >> g->shift);
}

static int end_batch(batch *b)
{
    fxs_gles *g = b->gles;
    const int32_t columns = b->window->columns, row = b->first / columns, rows = (b->end - 1) / columns - row + 1;
    size_t entries = (size_t)(b->entries - b->lists) * 4, records = (size_t)(b->records - b->lists) * 4;
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    upload(g, FXS_GLES_LISTS, row, columns, rows, GL_RG_INTEGER, (size_t)(row * columns) * 8);
    upload(g, FXS_GLES_ENTRIES, 0, 1 << g->shift, rows_used(g, b->entry_count), GL_RED_INTEGER, entries);
    upload(g, FXS_GLES_RECORDS, 0, 1 << g->shift, rows_used(g, 2 * b->record_count), GL_RGBA_INTEGER, records);
    return 0;
}

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* A splat as the shader reads it: first what rejects it. */
static void put_record(uint32_t *record, const fxs_splat *s)
{
    const uint32_t words[8] = {
        s->u0_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, s->first_row | (uint32_t)s->last_row << 16,
        s->v0_q24, (uint32_t)s->vy_q24, s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
        (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16};
    memcpy(record, words, sizeof words);
}

/* Splats that the ellipse of does not touch the tile are left out: no pixel takes them. */
static void put_entries(batch *b, const uint32_t *entries, uint32_t count)
{
    uint32_t *numbers = b->run->scratch;
    for (uint32_t i = 0; i < count; i++) {
        if (entries[i] & FXS_ENTRY_FAR)
            continue;
        uint32_t slot = entries[i];
        if (numbers[slot] == UNLISTED) {
            numbers[slot] = b->record_count++;
            put_record(b->records + 8 * (size_t)numbers[slot], &b->run->splats[slot]);
        }
        b->entries[b->entry_count++] = numbers[slot];
    }
}

static void put_list(batch *b, int32_t tile, const uint32_t *entries, uint32_t count)
{
    b->lists[2 * tile] = b->entry_count;
    put_entries(b, entries, count);
    b->lists[2 * tile + 1] = b->entry_count;
}

/* Tiles from `first` to before `end` are not drawn. */
static void leave_out(batch *b, int32_t first, int32_t end)
{
    for (int32_t tile = first; tile < end; tile++) {
        b->lists[2 * tile] = 1;
        b->lists[2 * tile + 1] = 0;
    }
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

/* Entries that a tile's list may have to be drawn at once. */
static uint32_t longest(const batch *b)
{
    return least(least((uint32_t)b->gles->entry_rows << b->gles->shift,
                       (uint32_t)b->gles->record_rows << (b->gles->shift - 1)), FXS_GLES_LOOP);
}

/* Records run out only where there are more slots than they. */
static int fits(const batch *b, uint32_t count)
{
    return count <= longest(b) && count <= b->entry_capacity - b->entry_count &&
           (b->record_capacity >= b->run->slots || count <= b->record_capacity - b->record_count);
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
    const uint32_t t = tile_of(b, tile), count = run->counts[t], most = longest(b);
    const uint32_t *entries = run->entries + run->ends[t] - count;
    int error = 0, carried = 0;
    for (uint32_t done = 0, part; done < count && !error; done += part, carried = 1) {
        part = least(count - done, most);
        error = begin_batch(b, tile);
        if (error)
            return error;
        b->end = tile + 1;
        leave_out(b, row, row + b->window->columns);
        put_list(b, tile, entries + done, part);
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

/* As many tiles as fit, from tile b->end on. */
static int draw_batch(batch *b)
{
    const int32_t columns = b->window->columns, tiles = columns * b->window->rows;
    int error = begin_batch(b, b->end);
    if (error)
        return error;
    leave_out(b, b->first / columns * columns, b->first);
    for (; b->end < tiles; b->end++) {
        uint32_t tile = tile_of(b, b->end);
        if (!in_run(b, tile))
            leave_out(b, b->end, b->end + 1);
        else if (!fits(b, b->run->counts[tile]))
            break;
        else
            put_list(b, b->end, b->run->entries + b->run->ends[tile] - b->run->counts[tile], b->run->counts[tile]);
    }
    leave_out(b, b->end, (b->end + columns - 1) / columns * columns);
    error = end_batch(b);
    surface s = surface_of(b);
    draw(b, &s, 0);
    return error;
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const window *w)
{
    batch b = {g, run, w, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    int error = 0;
    make_room(g, run, w);
    while (b.end < w->columns * w->rows && !error) {
        uint32_t tile = tile_of(&b, b.end);
        error = in_run(&b, tile) && run->counts[tile] > longest(&b) ? draw_parts(&b) : draw_batch(&b);
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
