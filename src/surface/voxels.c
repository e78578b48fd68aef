/* Sparse grids of bits: passes over the cells, dilation, dust, flooding. */
#include "voxels.h"

#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/fixed.h>
#include <fixsplat/internal/message.h>
#include "src/base/report.h"
#include "src/base/run.h"
#include "src/base/try_internal.h"

void *fxs_work_allocate(fxs_voxel_work *work, size_t count, size_t size)
{
    void *block = fxs_allocate_zeroed(work->allocator, count ? count : 1, size);
    if (!block) {
        fxs_fail_memory(work->message, NULL, 0);
        return NULL;
    }
    work->used += count * size;
    work->peak = work->used > work->peak ? work->used : work->peak;
    return block;
}

void fxs_work_release(fxs_voxel_work *work, void *block, size_t count, size_t size)
{
    if (block)
        work->used -= count * size;
    fxs_release(work->allocator, block);
}

size_t fxs_bits_cells(const fxs_bits *g)
{
    return (size_t)g->n[0] * (size_t)g->n[1] * (size_t)g->n[2];
}

int fxs_bits_open(fxs_bits *g, const int32_t n[3], fxs_voxel_work *work)
{
    *g = (fxs_bits){{n[0], n[1], n[2]}, NULL, NULL, 0, 0};
    g->states = fxs_work_allocate(work, fxs_bits_cells(g), sizeof *g->states);
    return g->states ? 0 : FXS_ERR_MEMORY;
}

void fxs_bits_close(fxs_bits *g, fxs_voxel_work *work)
{
    fxs_work_release(work, g->states, fxs_bits_cells(g), sizeof *g->states);
    fxs_work_release(work, g->bits, (size_t)g->room * FXS_CELL_WORDS, sizeof *g->bits);
    g->states = g->bits = NULL;
}

static int allocate_bits(fxs_bits *g, uint32_t mixed, fxs_voxel_work *work)
{
    g->mixed = g->room = mixed;
    g->bits = fxs_work_allocate(work, (size_t)mixed * FXS_CELL_WORDS, sizeof *g->bits);
    if (!g->bits)
        g->room = 0;
    return g->bits ? 0 : FXS_ERR_MEMORY;
}

static uint32_t *words_of(const fxs_bits *g, uint32_t state)
{
    return g->bits + (size_t)(state - FXS_CELL_MIXED) * FXS_CELL_WORDS;
}

static uint32_t state_of_words(const uint32_t *words)
{
    const uint32_t first = words[0];
    if (first && ~first)
        return FXS_CELL_MIXED;
    for (int i = 1; i < FXS_CELL_WORDS; i++)
        if (words[i] != first)
            return FXS_CELL_MIXED;
    return first ? FXS_CELL_SOLID : FXS_CELL_EMPTY;
}

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

typedef struct pass {
    fxs_bits *grid;
    fxs_cell_fn *make;
    void *argument;
    const uint32_t *cells;         /* the mixed cells */
    unsigned char *scratch;
    size_t scratch_bytes;
    uint32_t first, end, jobs;     /* mixed cells of this run of jobs */
} pass;

static void make_cells(void *argument, uint32_t job)
{
    const pass *p = argument;
    for (uint32_t i = p->first + job; i < p->end; i += p->jobs)
        p->make(p->argument, p->cells[i], words_of(p->grid, FXS_CELL_MIXED + i), p->scratch + job * p->scratch_bytes);
}

static int run_pass(pass *p, fxs_voxel_work *work)
{
    const uint32_t mixed = p->grid->mixed, step = 32 * p->jobs;
    fxs_run_fn *run = work->workers.run ? work->workers.run : fxs_run_here;
    for (p->first = 0; p->first < mixed; p->first = p->end) {
        p->end = mixed - p->first < step ? mixed : p->first + step;
        run(work->workers.pool, make_cells, p, p->jobs);
        if (fxs_report(work->progress, work->done + work->share * p->end / mixed))
            return fxs_fail_as(FXS_ERR_STOPPED, work->message, "%s", fxs_strerror(FXS_ERR_STOPPED));
    }
    return 0;
}

/* Gives cells whose bits are all equal their state, and moves the others' bits together. */
static void settle(fxs_bits *g, const uint32_t *cells)
{
    const uint32_t made = g->mixed;
    g->mixed = 0;
    for (uint32_t i = 0; i < made; i++) {
        const uint32_t *words = words_of(g, FXS_CELL_MIXED + i);
        uint32_t state = state_of_words(words);
        if (state == FXS_CELL_MIXED) {
            state += g->mixed++;
            memmove(words_of(g, state), words, FXS_CELL_WORDS * sizeof *words);
        }
        g->states[cells[i]] = state;
    }
}

int fxs_bits_make(fxs_bits *g, fxs_cell_fn *make, void *argument, size_t scratch, fxs_voxel_work *work)
{
    const uint32_t jobs = work->workers.run && work->workers.count ? work->workers.count : 1;
    pass p = {g, make, argument, NULL, NULL, scratch, 0, 0, jobs};
    uint32_t mixed = 0;
    for (size_t i = 0; i < fxs_bits_cells(g); i++)
        mixed += g->states[i] == FXS_CELL_MIXED;
    uint32_t *cells = fxs_work_allocate(work, mixed, sizeof *cells);
    p.scratch = fxs_work_allocate(work, jobs, scratch);
    int error = cells && p.scratch ? allocate_bits(g, mixed, work) : FXS_ERR_MEMORY;
    for (uint32_t i = 0, cell = 0; i < mixed && !error; cell++)
        if (g->states[cell] == FXS_CELL_MIXED)
            cells[i++] = cell;
    p.cells = cells;
    error = error ? error : run_pass(&p, work);
    if (!error)
        settle(g, cells);
    fxs_work_release(work, p.scratch, jobs, scratch);
    fxs_work_release(work, cells, mixed, sizeof *cells);
    return error;
}

/* ---- Bits -------------------------------------------------------------------------------------------------------- */

static size_t cell_at(const fxs_bits *g, int32_t x, int32_t y, int32_t z)
{
    return (size_t)x + (size_t)g->n[0] * ((size_t)y + (size_t)g->n[1] * (size_t)z);
}

static int is_inside(const fxs_bits *g, int32_t x, int32_t y, int32_t z)
{
    return x >= 0 && y >= 0 && z >= 0 && x < g->n[0] && y < g->n[1] && z < g->n[2];
}

uint32_t fxs_bits_row(const fxs_bits *g, int32_t x, int32_t y, int32_t z)
{
    const uint32_t state = g->states[cell_at(g, x, y >> 5, z >> 5)];
    return state < FXS_CELL_MIXED ? 0 - (uint32_t)(state == FXS_CELL_SOLID)
                                  : words_of(g, state)[32 * (z & 31) + (y & 31)];
}

int fxs_bits_bit(const fxs_bits *g, int32_t x, int32_t y, int32_t z)
{
    return (int)(fxs_bits_row(g, x >> 5, y, z) >> (x & 31) & 1);
}

static uint32_t ones(uint32_t x)
{
    x -= x >> 1 & 0x55555555u;
    x = (x & 0x33333333u) + (x >> 2 & 0x33333333u);
    return ((x + (x >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
}

uint64_t fxs_bits_count(const fxs_bits *g)
{
    uint64_t count = 0;
    for (size_t i = 0; i < fxs_bits_cells(g); i++)
        count += g->states[i] == FXS_CELL_SOLID ? (uint64_t)FXS_CELL * FXS_CELL_WORDS : 0;
    for (size_t i = 0; i < (size_t)g->mixed * FXS_CELL_WORDS; i++)
        count += ones(g->bits[i]);
    return count;
}

void fxs_bits_invert(fxs_bits *g)
{
    for (size_t i = 0; i < fxs_bits_cells(g); i++)
        g->states[i] ^= g->states[i] < FXS_CELL_MIXED;
    for (size_t i = 0; i < (size_t)g->mixed * FXS_CELL_WORDS; i++)
        g->bits[i] = ~g->bits[i];
}

/* ---- Neighbours -------------------------------------------------------------------------------------------------- */

/* The 27 cells around a cell. A cell with null `words` has `fill` as each of its words. */
typedef struct surroundings {
    const uint32_t *words[27];
    uint32_t fill[27];
} surroundings;

static uint32_t state_near(const fxs_bits *g, uint32_t cell, int near, uint32_t outside)
{
    const int32_t x = (int32_t)(cell % (uint32_t)g->n[0]) + near % 3 - 1;
    const int32_t y = (int32_t)(cell / (uint32_t)g->n[0] % (uint32_t)g->n[1]) + near / 3 % 3 - 1;
    const int32_t z = (int32_t)(cell / (uint32_t)g->n[0] / (uint32_t)g->n[1]) + near / 9 - 1;
    return is_inside(g, x, y, z) ? g->states[cell_at(g, x, y, z)] : outside;
}

static void look_around(surroundings *s, const fxs_bits *g, uint32_t cell, uint32_t outside)
{
    for (int near = 0; near < 27; near++) {
        const uint32_t state = state_near(g, cell, near, outside);
        s->words[near] = state < FXS_CELL_MIXED ? NULL : words_of(g, state);
        s->fill[near] = state == FXS_CELL_SOLID ? UINT32_MAX : 0;
    }
}

/* Returns the word of row (y, z), each -32 to 63, in the cells at x - 1, x or x + 1. */
static uint32_t word_near(const surroundings *s, int dx, int32_t y, int32_t z)
{
    const int near = dx + 1 + 3 * ((y >> 5) + 1) + 9 * ((z >> 5) + 1);
    return s->words[near] ? s->words[near][32 * (z & 31) + (y & 31)] : s->fill[near];
}

/* Opens the grid of a pass over `in` that may set bits in empty cells near others, up to a cell away on the axes whose
   bit in `axes` is 1. Solid cells stay solid. */
static int open_from(fxs_bits *out, const fxs_bits *in, int axes, uint32_t outside, fxs_voxel_work *work)
{
    FXS_TRY(fxs_bits_open(out, in->n, work));
    for (uint32_t cell = 0; cell < fxs_bits_cells(in); cell++) {
        uint32_t state = in->states[cell];
        for (int near = 0; near < 27 && state == FXS_CELL_EMPTY; near++) {
            const int away = (near % 3 != 1) | (near / 3 % 3 != 1) << 1 | (near / 9 != 1) << 2;
            state = away & ~axes || !state_near(in, cell, near, outside) ? state : FXS_CELL_MIXED;
        }
        out->states[cell] = state < FXS_CELL_MIXED ? state : FXS_CELL_MIXED;
    }
    return 0;
}

static int replace(fxs_bits *g, fxs_bits *by, int error, fxs_voxel_work *work)
{
    fxs_bits_close(error ? by : g, work);
    if (!error)
        *g = *by;
    return error;
}

/* ---- Dilation ---------------------------------------------------------------------------------------------------- */

typedef struct dilation {
    const fxs_bits *in;
    const fxs_offsets *runs;
    uint32_t count, outside;
    int32_t reach, longest;
} dilation;

/* Sets the bits up to k places above each set bit. */
static uint64_t smear_up(uint64_t x, int32_t k)
{
    for (int32_t done = 0, more; done < k; done += more) {
        more = done + 1 < k - done ? done + 1 : k - done;
        x |= x << more;
    }
    return x;
}

static uint64_t smear_down(uint64_t x, int32_t k)
{
    for (int32_t done = 0, more; done < k; done += more) {
        more = done + 1 < k - done ? done + 1 : k - done;
        x |= x >> more;
    }
    return x;
}

/* Writes the rows around a cell, each dilated by k bits along x. */
static void smear_rows(uint32_t *rows, const surroundings *s, int32_t reach, int32_t k)
{
    for (int32_t z = -reach; z < FXS_CELL + reach; z++)
        for (int32_t y = -reach; y < FXS_CELL + reach; y++) {
            const uint64_t below = word_near(s, -1, y, z), here = word_near(s, 0, y, z), above = word_near(s, 1, y, z);
            *rows++ = (uint32_t)(smear_up(below | here << 32, k) >> 32) | (uint32_t)smear_down(here | above << 32, k);
        }
}

static void add_rows(uint32_t words[FXS_CELL_WORDS], const uint32_t *rows, int32_t reach, const fxs_offsets *run)
{
    const int32_t wide = FXS_CELL + 2 * reach;
    for (int32_t z = 0; z < FXS_CELL; z++) {
        const uint32_t *row = rows + (z + run->dz + reach) * wide + run->dy + reach;
        for (int32_t y = 0; y < FXS_CELL; y++)
            words[32 * z + y] |= row[y];
    }
}

static void dilate_cell(void *argument, uint32_t cell, uint32_t words[FXS_CELL_WORDS], void *scratch)
{
    const dilation *d = argument;
    surroundings s;
    look_around(&s, d->in, cell, d->outside);
    for (int32_t k = 0; k <= d->longest; k++) {
        int is_made = 0;
        for (uint32_t i = 0; i < d->count; i++) {
            if (d->runs[i].run != k)
                continue;
            if (!is_made)
                smear_rows(scratch, &s, d->reach, k);
            is_made = 1;
            add_rows(words, scratch, d->reach, &d->runs[i]);
        }
    }
}

int fxs_bits_dilate(fxs_bits *g, const fxs_offsets *runs, uint32_t count, int32_t reach, uint32_t outside,
                    fxs_voxel_work *work)
{
    const size_t wide = (size_t)(FXS_CELL + 2 * reach);
    dilation d = {g, runs, count, outside, reach, 0};
    fxs_bits out;
    int axes = 0;
    for (uint32_t i = 0; i < count; i++) {
        d.longest = runs[i].run > d.longest ? runs[i].run : d.longest;
        axes |= (runs[i].run != 0) | (runs[i].dy != 0) << 1 | (runs[i].dz != 0) << 2;
    }
    int error = open_from(&out, g, axes, outside, work);
    error = error ? error : fxs_bits_make(&out, dilate_cell, &d, wide * wide * sizeof(uint32_t), work);
    return replace(g, &out, error, work);
}

/* ---- Dust -------------------------------------------------------------------------------------------------------- */

static void sweep_cell(void *argument, uint32_t cell, uint32_t words[FXS_CELL_WORDS], void *scratch)
{
    surroundings s;
    (void)scratch;
    look_around(&s, argument, cell, FXS_CELL_EMPTY);
    for (int32_t z = 0; z < FXS_CELL; z++)
        for (int32_t y = 0; y < FXS_CELL; y++) {
            const uint32_t here = word_near(&s, 0, y, z);
            words[32 * z + y] = here & (here << 1 | word_near(&s, -1, y, z) >> 31 | here >> 1 |
                                        word_near(&s, 1, y, z) << 31 | word_near(&s, 0, y - 1, z) |
                                        word_near(&s, 0, y + 1, z) | word_near(&s, 0, y, z - 1) |
                                        word_near(&s, 0, y, z + 1));
        }
}

int fxs_bits_drop_dust(fxs_bits *g, fxs_voxel_work *work)
{
    fxs_bits out;
    int error = open_from(&out, g, 0, FXS_CELL_EMPTY, work);
    error = error ? error : fxs_bits_make(&out, sweep_cell, g, 1, work);
    return replace(g, &out, error, work);
}

/* ---- Flooding ---------------------------------------------------------------------------------------------------- */

/* A queue of cells that are looked at again, because a cell beside them has more bits. */
typedef struct flood {
    fxs_bits *flooded;
    const fxs_bits *walls;
    uint32_t *queue;               /* ring of `room` cells */
    unsigned char *is_queued;
    size_t room, first, count;
} flood;

static const int faces[6] = {12, 14, 10, 16, 4, 22};    /* neighbours of a cell, as in `surroundings` */

static void queue_around(flood *f, uint32_t cell)
{
    const fxs_bits *g = f->walls;
    const int32_t step[6] = {-1, 1, -g->n[0], g->n[0], -g->n[0] * g->n[1], g->n[0] * g->n[1]};
    for (int face = 0; face < 6; face++) {
        if (state_near(g, cell, faces[face], FXS_CELL_SOLID) == FXS_CELL_SOLID)
            continue;
        const uint32_t next = (uint32_t)((int64_t)cell + step[face]);
        if (f->is_queued[next])
            continue;
        f->is_queued[next] = 1;
        f->queue[(f->first + f->count++) % f->room] = next;
    }
}

/* Spreads set bits along x through free ones. */
static uint32_t spread(uint32_t set, uint32_t free)
{
    uint32_t up = free, down = free;
    for (int step = 1; step < FXS_CELL; step *= 2) {
        set |= (up & set << step) | (down & set >> step);
        up &= up << step;
        down &= down >> step;
    }
    return set;
}

/* Adds to a row the bits of its neighbours at (y - d, z) and (y, z - d), and spreads them. Returns 1 if it gained
   bits. */
static int flood_row(uint32_t *words, const uint32_t *free, int row, int d)
{
    const int y = row % FXS_CELL - d, z = row / FXS_CELL - d;
    uint32_t set = words[row];
    set |= y >= 0 && y < FXS_CELL ? words[row - d] : 0;
    set |= z >= 0 && z < FXS_CELL ? words[row - d * FXS_CELL] : 0;
    set = spread(set & ~free[row], ~free[row]);
    const int gained = set != words[row];
    words[row] = set;
    return gained;
}

static int flood_words(uint32_t *words, const uint32_t *walls)
{
    int gained = 0, again = 1;
    while (again) {
        again = 0;
        for (int row = 0; row < FXS_CELL_WORDS; row++)
            again |= flood_row(words, walls, row, 1);
        for (int row = FXS_CELL_WORDS - 1; row >= 0; row--)
            again |= flood_row(words, walls, row, -1);
        gained |= again;
    }
    return gained;
}

/* Adds the bits beside row (y, z) in the six cells around. */
static uint32_t bits_beside(const surroundings *s, int32_t y, int32_t z)
{
    uint32_t set = word_near(s, -1, y, z) >> 31 | word_near(s, 1, y, z) << 31;
    set |= y == 0 ? word_near(s, 0, -1, z) : y == FXS_CELL - 1 ? word_near(s, 0, FXS_CELL, z) : 0;
    return set | (z == 0 ? word_near(s, 0, y, -1) : z == FXS_CELL - 1 ? word_near(s, 0, y, FXS_CELL) : 0);
}

static void flood_cell(flood *f, uint32_t cell)
{
    const uint32_t wall = f->walls->states[cell], state = f->flooded->states[cell];
    surroundings s;
    uint32_t gained = 0;
    if (state == FXS_CELL_SOLID)
        return;
    look_around(&s, f->flooded, cell, FXS_CELL_EMPTY);
    for (int32_t row = 0; row < FXS_CELL_WORDS; row++) {
        const uint32_t beside = bits_beside(&s, row % FXS_CELL, row / FXS_CELL);
        if (wall == FXS_CELL_EMPTY) {
            gained |= beside;
            continue;
        }
        uint32_t *word = words_of(f->flooded, state) + row;
        const uint32_t more = beside & ~words_of(f->walls, wall)[row] & ~*word;
        *word |= more;
        gained |= more;
    }
    if (!gained)
        return;
    if (wall == FXS_CELL_EMPTY)
        f->flooded->states[cell] = FXS_CELL_SOLID;
    else
        flood_words(words_of(f->flooded, state), words_of(f->walls, wall));
    queue_around(f, cell);
}

static void start(flood *f, const int32_t seed[3])
{
    const uint32_t cell = (uint32_t)cell_at(f->walls, seed[0] >> 5, seed[1] >> 5, seed[2] >> 5);
    const uint32_t wall = f->walls->states[cell];
    if (wall == FXS_CELL_EMPTY) {
        f->flooded->states[cell] = FXS_CELL_SOLID;
    } else {
        uint32_t *words = words_of(f->flooded, f->flooded->states[cell]);
        words[32 * (seed[2] & 31) + (seed[1] & 31)] |= 1u << (seed[0] & 31);
        flood_words(words, words_of(f->walls, wall));
    }
    queue_around(f, cell);
}

/* The flooded grid has bits for each mixed cell of the walls, and is empty or solid in the others. */
int fxs_bits_flood(fxs_bits *flooded, const fxs_bits *walls, const int32_t seed[3], fxs_voxel_work *work)
{
    const size_t room = fxs_bits_cells(walls);
    flood f = {flooded, walls, NULL, NULL, room, 0, 0};
    FXS_TRY(fxs_bits_open(flooded, walls->n, work));
    FXS_TRY(allocate_bits(flooded, walls->mixed, work));
    for (size_t i = 0; i < room; i++)
        flooded->states[i] = walls->states[i] < FXS_CELL_MIXED ? FXS_CELL_EMPTY : walls->states[i];
    f.queue = fxs_work_allocate(work, room, sizeof *f.queue);
    f.is_queued = fxs_work_allocate(work, room, 1);
    const int error = f.queue && f.is_queued ? 0 : FXS_ERR_MEMORY;
    if (!error)
        start(&f, seed);
    while (f.count && !error) {
        const uint32_t cell = f.queue[f.first];
        f.first = (f.first + 1) % room;
        f.count--;
        f.is_queued[cell] = 0;
        flood_cell(&f, cell);
    }
    fxs_work_release(work, f.queue, room, sizeof *f.queue);
    fxs_work_release(work, f.is_queued, room, 1);
    return error;
}
