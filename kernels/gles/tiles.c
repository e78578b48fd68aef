/* Draws the picture with a list of splats per tile. As many tiles' lists as fit in the textures are uploaded and drawn,
 * then the next ones. A list that is too long for one draw is drawn in parts, and a texture keeps the tile's state in
 * between. A splat has one record per list, which saves an indirection per fetch and a pass over the lists. A first
 * draw finds the blocks of 4x4 pixels that each splat may touch, so that a pixel skips the other splats. Tiles are
 * drawn in order of their lists' length, longest first: in picture order an H200 takes up to 3.5 times as long. */
#include <fixsplat/internal/fixed.h>
#include "src/core/memory.h"
#include "src/core/trace.h"
#include "device.h"

#define RECORD 32
#define LIST 16
#define ORDER 3
#define CHUNK 8
#define ID 8
#define CHUNK_RECORDS 32u
/* A chunk (up to 32 splats) has one word: its count - 1 from this bit on, its first record below this bit. */
#define CHUNK_SHIFT 24
#define AHEAD 16

typedef struct amount {
    uint32_t records, chunks;
} amount;

typedef struct batch {
    fxs_gles *gles;
    const fxs_tile_run *run;
    const fxs_gles_window *window;
    uint32_t *lists, *chunks, *records, *ids;
    amount used, room;
    int32_t first, end;
    int32_t ordered;
    amount starts[FXS_MAX_SIZE / FXS_TILE];
} batch;

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void make_texture(const fxs_gles *g, int unit, GLint format, GLenum layout, int32_t width, int32_t height)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.TexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, layout, GL_UNSIGNED_INT, 0);
}

typedef struct list {
    const uint32_t *entries;
    uint32_t count;
} list;

static list list_of(const fxs_tile_run *run, uint32_t tile)
{
    const uint32_t count = run->counts[tile];
    return (list){run->entries + run->ends[tile] - count, count};
}

static uint32_t chunks_of(uint32_t records)
{
    return (records + CHUNK_RECORDS - 1) / CHUNK_RECORDS;
}

static int32_t rows_of(const fxs_gles *g, uint64_t texels)
{
    const uint64_t wanted = (texels + (1u << g->shift) - 1) >> g->shift, most = UINT64_C(1) << g->shift;
    return (int32_t)(wanted < most ? wanted : most);
}

int fxs_gles_make_masks(fxs_gles *g, uint64_t chunks)
{
    const fxs_gl *gl = &g->gl;
    const int32_t rows = rows_of(g, 4 * chunks);
    if (rows <= g->mask_rows)
        return 0;
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    make_texture(g, FXS_GLES_CHUNKS, GL_RG32UI, GL_RG_INTEGER, 1 << g->shift, (rows + 3) / 4);
    make_texture(g, FXS_GLES_MASKS, GL_RGBA32UI, GL_RGBA_INTEGER, 1 << g->shift, rows);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_MASKED]);
    gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, g->textures[FXS_GLES_MASKS], 0);
    if (gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return fxs_gl_failure(&g->gl);
    g->mask_rows = rows;
    return 0;
}

static void make_ids(fxs_gles *g)
{
    const int32_t rows = (g->record_rows + 1) / 2;
    if (rows <= g->id_rows)
        return;
    g->id_rows = rows;
    make_texture(g, FXS_GLES_IDS, GL_RG32UI, GL_RG_INTEGER, 1 << g->shift, rows);
}

static int make_room(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    uint64_t records = 0, chunks = 0;
    for (uint32_t tile = run->first_tile; tile <= run->last_tile; tile++) {
        records += list_of(run, tile).count;
        chunks += chunks_of(list_of(run, tile).count);
    }
    fxs_gles_make_records(g, 2 * records);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->columns > g->columns || w->rows > g->rows) {
        g->columns = w->columns > g->columns ? w->columns : g->columns;
        g->rows = w->rows > g->rows ? w->rows : g->rows;
        make_texture(g, FXS_GLES_LISTS, GL_RGBA32UI, GL_RGBA_INTEGER, g->columns, g->rows);
    }
    if (fxs_gles_is_traced(g))
        make_ids(g);
    return fxs_gles_make_masks(g, chunks);
}

static int begin_batch(batch *b, int32_t first)
{
    fxs_gles *g = b->gles;
    const size_t lists = (size_t)b->window->columns * (size_t)b->window->rows * LIST;
    const size_t chunks = ((size_t)(g->mask_rows + 3) / 4 * CHUNK) << g->shift;
    const size_t ids = fxs_gles_is_traced(g) ? ((size_t)g->id_rows << g->shift) * ID : 0;
    b->room = (amount){(uint32_t)g->record_rows << (g->shift - 1), (uint32_t)g->mask_rows << (g->shift - 2)};
    b->lists = fxs_gles_map(
        g, (GLsizeiptr)(lists + chunks + ((size_t)g->record_rows << g->shift) * RECORD / 2 + ids));
    if (!b->lists)
        return fxs_gl_failure(&g->gl);
    b->chunks = b->lists + lists / 4;
    b->records = b->chunks + chunks / 4;
    b->ids = b->records + RECORD / 4 * (size_t)b->room.records;
    b->used = (amount){0, 0};
    b->first = b->end = first;
    return 0;
}

static int end_batch(batch *b)
{
    fxs_gles *g = b->gles;
    const int32_t columns = b->window->columns, row = b->first / columns, rows = (b->end - 1) / columns - row + 1;
    const int32_t width = 1 << g->shift, chunk_rows = rows_of(g, b->used.chunks);
    memset(b->chunks + 2 * (size_t)b->used.chunks, 0, CHUNK * (((size_t)chunk_rows << g->shift) - b->used.chunks));
    if (!g->gl.UnmapBuffer(GL_PIXEL_UNPACK_BUFFER))
        return FXS_ERR_DEVICE;
    fxs_gles_start_timer(g);
    fxs_gles_upload(g, FXS_GLES_LISTS, row, columns, rows, GL_RGBA_INTEGER, (size_t)(row * columns) * LIST);
    fxs_gles_upload(g, FXS_GLES_CHUNKS, 0, width, chunk_rows, GL_RG_INTEGER, (size_t)(b->chunks - b->lists) * 4);
    fxs_gles_upload(g, FXS_GLES_RECORDS, 0, width, rows_of(g, 2 * (uint64_t)b->used.records), GL_RGBA_INTEGER,
                    (size_t)(b->records - b->lists) * 4);
    if (fxs_gles_is_traced(g))
        fxs_gles_upload(g, FXS_GLES_IDS, 0, width, rows_of(g, b->used.records), GL_RG_INTEGER,
                        (size_t)(b->ids - b->lists) * 4);
    return 0;
}

static void put_record(uint32_t *record, const fxs_splat *s, uint32_t depth)
{
    const uint32_t words[RECORD / 4] = {
        s->u0_q24, (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, s->v0_q24,
        (uint32_t)s->vy_q24, s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
        (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16, depth};
    memcpy(record, words, sizeof words);
}

/* Writes the splats of a tile's list to the upload buffer. A list entry marked as cut off becomes an invisible
   splat. */
static void put_records(const batch *b, uint32_t at, list l)
{
    static const fxs_splat nothing = {.offset_q11 = FXS_LEVEL_MAX_Q11};
    const fxs_splat *splats = b->run->splats;
    const int with_depths = fxs_gles_has_occluder(b->gles, b->run) || fxs_gles_is_traced(b->gles);
    for (uint32_t i = 0; i < l.count; i++) {
        const uint32_t entry = l.entries[i], slot = entry & ~FXS_ENTRY_CUT_OFF;
        if (i + AHEAD < l.count)
            FXS_PREFETCH(&splats[l.entries[i + AHEAD] & ~FXS_ENTRY_CUT_OFF]);
        put_record(b->records + RECORD / 4 * (size_t)(at + i), entry & FXS_ENTRY_CUT_OFF ? &nothing : &splats[slot],
                   with_depths ? b->run->depths[slot] : 0);
    }
}

static void put_ids(const batch *b, uint32_t at, list l)
{
    const fxs_tile_run *run = b->run;
    const fxs_object_view *object = run->objects;
    for (uint32_t i = 0; i < l.count; i++) {
        const uint32_t slot = l.entries[i] & ~FXS_ENTRY_CUT_OFF;
        const fxs_id id = fxs_id_of(run->objects, run->object_count, run->indices[slot], &object);
        const uint32_t words[ID / 4] = {id.object, id.gaussian};
        memcpy(b->ids + ID / 4 * (size_t)(at + i), words, sizeof words);
    }
}

static void put_list(const batch *b, int32_t tile, amount at, list l)
{
    const fxs_gles_window *w = b->window;
    const uint32_t words[ORDER] = {at.records, at.records + l.count, at.chunks};
    const uint32_t column = (uint32_t)(w->first_column + tile % w->columns);
    const uint32_t row = (uint32_t)(w->first_row + tile / w->columns);
    memcpy(b->lists + LIST / 4 * (size_t)tile, words, sizeof words);
    for (uint32_t done = 0; done < l.count; done += CHUNK_RECORDS) {
        const uint32_t last = least(l.count - done, CHUNK_RECORDS) - 1;
        const uint32_t chunk[CHUNK / 4] = {(at.records + done) | last << CHUNK_SHIFT, column | row << 16};
        memcpy(b->chunks + CHUNK / 4 * (size_t)(at.chunks + done / CHUNK_RECORDS), chunk, sizeof chunk);
    }
    put_records(b, at.records, l);
    if (fxs_gles_is_traced(b->gles))
        put_ids(b, at.records, l);
}

/* Marks a tile as not drawn now, by a list that ends before its start. */
static void put_none(const batch *b, int32_t tile)
{
    static const uint32_t words[ORDER] = {1};
    memcpy(b->lists + LIST / 4 * (size_t)tile, words, sizeof words);
}

static void add(amount *to, uint32_t records)
{
    to->records += records;
    to->chunks += chunks_of(records);
}

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

static void put_row(void *argument, uint32_t job)
{
    const batch *b = argument;
    const fxs_tile_run *run = b->run;
    const int32_t columns = b->window->columns, start = (b->first / columns + (int32_t)job) * columns;
    amount at = b->starts[job];
    for (int32_t tile = start; tile < start + columns; tile++) {
        const uint32_t t = tile_of(b, tile);
        if (tile < b->first || tile >= b->end || !in_run(b, t)) {
            put_none(b, tile);
            continue;
        }
        const list l = list_of(run, t);
        put_list(b, tile, at, l);
        add(&at, l.count);
    }
}

/* Grades are classes of tiles by the length of their lists. Grade 0 has the longest lists. */
enum { GRADES = FXS_GLES_LOOP / CHUNK_RECORDS + 1 };

static uint32_t grade_of(const batch *b, uint32_t tile)
{
    return GRADES - 1 - chunks_of(list_of(b->run, tile).count);
}

static void put_order(batch *b)
{
    const int32_t first = b->first / b->window->columns * b->window->columns;
    uint32_t *order = b->lists + LIST / 4 * (size_t)first + ORDER, next[GRADES] = {0};
    b->ordered = 0;
    for (int32_t tile = b->first; tile < b->end; tile++)
        if (in_run(b, tile_of(b, tile)))
            next[grade_of(b, tile_of(b, tile))]++;
    for (uint32_t grade = 0; grade < GRADES; grade++) {
        const uint32_t count = next[grade];
        next[grade] = (uint32_t)b->ordered;
        b->ordered += (int32_t)count;
    }
    for (int32_t tile = b->first; tile < b->end; tile++)
        if (in_run(b, tile_of(b, tile)))
            order[LIST / 4 * (size_t)next[grade_of(b, tile_of(b, tile))]++] = (uint32_t)tile;
}

static uint32_t longest(const fxs_gles *g)
{
    return least((uint32_t)g->record_rows << (g->shift - 1), FXS_GLES_LOOP);
}

static fxs_gles_surface surface_of(const batch *b)
{
    const fxs_gles_window *w = b->window;
    const int32_t top = b->first / w->columns * FXS_TILE, rows = (b->end - 1) / w->columns * FXS_TILE + FXS_TILE;
    return fxs_gles_surface_of(b->gles, b->run, w, top, fxs_min(rows, w->height) - top, FXS_GLES_INTEGER,
                               fxs_gles_is_traced(b->gles) ? FXS_GLES_TRACED : FXS_GLES_NORMALISED);
}

static void draw_masks(const batch *b)
{
    const fxs_gles *g = b->gles;
    const fxs_gles_program *p = &g->programs[FXS_GLES_BLOCKS];
    const int32_t width = 1 << g->shift, rows = rows_of(g, 4 * (uint64_t)b->used.chunks);
    g->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_MASKED]);
    g->gl.Viewport(0, 0, width, rows);
    g->gl.Scissor(0, 0, width, rows);
    g->gl.UseProgram(p->name);
    g->gl.Uniform4i(p->source, g->shift, b->run->view->cut_q11, 0, 0);
    g->gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

/* Draws tiles as GL points, or as one triangle if points are too small. The viewport for points has a margin of one
   tile, because GL clips points by their centre. */
static void draw(const batch *b, const fxs_gles_surface *s, int carried)
{
    const fxs_gles *g = b->gles;
    const int32_t columns = b->window->columns, width = s->width + 2 * FXS_TILE, height = s->height + 2 * FXS_TILE;
    const int32_t source[4] = {b->window->first_column, b->window->first_row, g->shift, b->run->view->cut_q11};
    const int is_state = s->program == FXS_GLES_STATE || s->program == FXS_GLES_TRACED_STATE;
    const int points = g->points && !is_state && width <= g->viewport[0] && height <= g->viewport[1];
    if (b->used.chunks)
        draw_masks(b);
    fxs_gles_aim(g, b->run, b->window, s, carried, source);
    g->gl.Uniform4i(g->programs[s->program].size, width, height, points ? columns : 0, 0);
    if (!points) {
        g->gl.DrawArrays(GL_TRIANGLES, 0, 3);
        return;
    }
    g->gl.Viewport(s->x - FXS_TILE, s->y - FXS_TILE, width, height);
    g->gl.DrawArrays(GL_POINTS, b->first / columns * columns, b->ordered);
}

static void take_turn(const fxs_gles *g, int turn)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + FXS_GLES_CARRIED);
    g->gl.BindTexture(GL_TEXTURE_2D, g->textures[turn ? FXS_GLES_CARRIED : FXS_GLES_NEXT]);
    g->gl.ActiveTexture(GL_TEXTURE0 + FXS_GLES_TRACES);
    g->gl.BindTexture(GL_TEXTURE_2D, g->textures[turn ? FXS_GLES_TRACES : FXS_GLES_NEXT_TRACES]);
}

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
            put_none(b, other);
        put_list(b, tile, (amount){0, 0}, (list){l.entries + done, part});
        b->lists[LIST / 4 * (size_t)row + ORDER] = (uint32_t)tile;
        b->ordered = 1;
        add(&b->used, part);
        error = end_batch(b);
        if (error)
            return error;
        fxs_gles_surface s = surface_of(b);
        const int turn = (int)(done / most % 2), traced = fxs_gles_is_traced(g);
        if (done + part < l.count)
            s = (fxs_gles_surface){
                g->framebuffers[(traced ? FXS_GLES_FIRST_TRACED : FXS_GLES_FIRST_STATE) + turn],
                traced ? FXS_GLES_TRACED_STATE : FXS_GLES_STATE, 0, 0, FXS_TILE, FXS_TILE,
                (int32_t)t % run->view->tiles_x * FXS_TILE, (int32_t)t / run->view->tiles_x * FXS_TILE, 1, 0, FXS_TILE};
        take_turn(g, turn);
        draw(b, &s, carried);
    }
    return error;
}

static void take_tiles(batch *b)
{
    const int32_t columns = b->window->columns, tiles = columns * b->window->rows, row = b->first / columns;
    b->starts[0] = b->used;
    for (; b->end < tiles; b->end++) {
        const uint32_t tile = tile_of(b, b->end), count = in_run(b, tile) ? list_of(b->run, tile).count : 0;
        if (count > least(longest(b->gles), b->room.records - b->used.records) ||
            chunks_of(count) > b->room.chunks - b->used.chunks)
            break;
        if (b->end % columns == 0)
            b->starts[b->end / columns - row] = b->used;
        add(&b->used, count);
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
    put_order(b);
    error = end_batch(b);
    if (error)
        return error;
    const fxs_gles_surface s = surface_of(b);
    draw(b, &s, 0);
    return 0;
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    batch b = {.gles = g, .run = run, .window = w};
    int error = make_room(g, run, w);
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
