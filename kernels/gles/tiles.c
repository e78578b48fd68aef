/* The exact picture: the lists of as many tiles as the texture of records holds are uploaded and drawn, and so on. A
   list that no draw can hold is drawn in parts, with the tile's state kept in a texture in between. A splat's record
   is there once for each list that it is in: a fetch less than by its number, and one pass over the lists. */
#include "../../src/fixed.h"
#include "../../src/memory.h"
#include "device.h"

#define RECORD 32                  /* bytes */
#define AHEAD 16                   /* entries */

/* One upload, in the mapped buffer: lists of the window's tiles, then records. */
typedef struct batch {
    fxs_gles *gles;
    const fxs_tile_run *run;
    const fxs_gles_window *window;
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

/* A tile's list, in its order. The only place that knows how src/ lists. */
typedef struct list {
    const uint32_t *entries;
    uint32_t count;
} list;

static list list_of(const fxs_tile_run *run, uint32_t tile)
{
    const uint32_t count = run->counts[tile];
    return (list){run->entries + run->ends[tile] - count, count};
}

/* Textures large enough for a run, where that can be. */
static void make_room(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    uint64_t records = 0;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++)
        records += list_of(run, tile).count;
    fxs_gles_make_records(g, 2 * records);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->columns > g->columns || w->rows > g->rows) {
        g->columns = w->columns > g->columns ? w->columns : g->columns;
        g->rows = w->rows > g->rows ? w->rows : g->rows;
        make_texture(g, FXS_GLES_LISTS, GL_RG32UI, GL_RG_INTEGER, g->columns, g->rows);
    }
    if (fxs_gles_has_occluder(g, run) && (g->record_rows + 1) / 2 > g->depth_rows)
        make_texture(g, FXS_GLES_DEPTHS, GL_R32UI, GL_RED_INTEGER, 1 << g->shift,
                     g->depth_rows = (g->record_rows + 1) / 2);
}

/* Buffers take turns, so that none is waited for. (Making their storage anew for each batch takes 20 ms for 50 MB.) */
static int begin_batch(batch *b, int32_t first)
{
    fxs_gles *g = b->gles;
    size_t lists = (size_t)b->window->columns * (size_t)b->window->rows;
    b->capacity = (uint32_t)g->record_rows << (g->shift - 1);
    const int occluded = fxs_gles_has_occluder(g, b->run);
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

static int end_batch(batch *b)
{
    fxs_gles *g = b->gles;
    const int32_t columns = b->window->columns, row = b->first / columns, rows = (b->end - 1) / columns - row + 1;
    const int32_t record_rows = (int32_t)((2 * b->count + (1u << g->shift) - 1) >> g->shift);
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    fxs_gles_upload(g, FXS_GLES_LISTS, row, columns, rows, GL_RG_INTEGER, (size_t)(row * columns) * 8);
    fxs_gles_upload(g, FXS_GLES_RECORDS, 0, 1 << g->shift, record_rows, GL_RGBA_INTEGER,
                    (size_t)(b->records - b->lists) * 4);
    if (b->depths)
        fxs_gles_upload(g, FXS_GLES_DEPTHS, 0, 1 << g->shift, (record_rows + 1) / 2, GL_RED_INTEGER,
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
static void put_records(const batch *b, uint32_t at, list l)
{
    static const fxs_splat nothing = {.first_row = 1};
    const fxs_splat *splats = b->run->splats;
    for (uint32_t i = 0; i < l.count; i++) {
        if (i + AHEAD < l.count)
            FXS_PREFETCH(&splats[l.entries[i + AHEAD] & ~FXS_ENTRY_FAR]);
        put_record(b->records + RECORD / 4 * (size_t)(at + i),
                   l.entries[i] & FXS_ENTRY_FAR ? &nothing : &splats[l.entries[i]]);
        if (b->depths)
            b->depths[at + i] = b->run->depths[l.entries[i] & ~FXS_ENTRY_FAR];
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
    const fxs_gles_window *w = b->window;
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
        const list l = list_of(run, t);
        put_list(b, tile, at, at + l.count);
        put_records(b, at, l);
        at += l.count;
    }
}

/* Entries that a tile's list may have to be drawn at once. */
static uint32_t longest(const fxs_gles *g)
{
    return least((uint32_t)g->record_rows << (g->shift - 1), FXS_GLES_LOOP);
}

/* ---- Draws ------------------------------------------------------------------------------------------------------- */

/* The rows of tiles of a batch. */
static fxs_gles_surface surface_of(const batch *b)
{
    const fxs_gles_window *w = b->window;
    const int32_t top = b->first / w->columns * FXS_TILE, rows = (b->end - 1) / w->columns * FXS_TILE + FXS_TILE;
    return fxs_gles_surface_of(b->gles, b->run, w, top, fxs_min(rows, w->height) - top, FXS_GLES_INTEGER,
                               FXS_GLES_NORMALISED);
}

static void draw(const batch *b, const fxs_gles_surface *s, int carried)
{
    const int32_t source[4] = {b->window->first_column, b->window->first_row, b->gles->shift, b->run->view->cut_q11};
    fxs_gles_cover(b->gles, b->run, b->window, s, carried, source);
}

/* Tile b->end, whose list is too long for a draw. */
static int draw_parts(batch *b)
{
    const fxs_tile_run *run = b->run;
    const fxs_gles *g = b->gles;
    const int32_t tile = b->end, row = tile / b->window->columns * b->window->columns;
    const uint32_t t = tile_of(b, tile), most = longest(g);
    const list l = list_of(run, t);
    int error = 0, carried = 0;
    for (uint32_t done = 0, part; done < l.count && !error; done += part, carried = 1) {
        part = least(l.count - done, most);
        error = begin_batch(b, tile);
        if (error)
            return error;
        b->end = tile + 1;
        for (int32_t other = row; other < row + b->window->columns; other++)
            put_list(b, other, 1, 0);
        put_list(b, tile, 0, part);
        put_records(b, 0, (list){l.entries + done, part});
        b->count = part;
        error = end_batch(b);
        fxs_gles_surface s = surface_of(b);
        int turn = (int)(done / most % 2);
        if (done + part < l.count)
            s = (fxs_gles_surface){g->framebuffers[FXS_GLES_FIRST_STATE + turn], FXS_GLES_STATE, 0, 0, FXS_TILE,
                                   FXS_TILE, (int32_t)t % run->view->tiles_x * FXS_TILE,
                                   (int32_t)t / run->view->tiles_x * FXS_TILE, 1, 0, FXS_TILE};
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
        const uint32_t tile = tile_of(b, b->end), count = in_run(b, tile) ? list_of(b->run, tile).count : 0;
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
    fxs_gles_surface s = surface_of(b);
    draw(b, &s, 0);
    return error;
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    batch b = {.gles = g, .run = run, .window = w};
    int error = 0;
    make_room(g, run, w);
    while (b.end < w->columns * w->rows && !error) {
        uint32_t tile = tile_of(&b, b.end);
        error = in_run(&b, tile) && list_of(run, tile).count > longest(g) ? draw_parts(&b) : draw_batch(&b);
    }
    return error;
}

int fxs_gles_draw(void *argument, const fxs_tile_run *run)
{
    fxs_gles *g = argument;
    return fxs_gles_draw_windows(g, run, g->target ? FXS_MAX_SIZE : g->most, draw_window);
}
