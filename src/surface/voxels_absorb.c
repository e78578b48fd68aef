/* Finds the voxels of a packed scene that absorb light. All numbers are integers, and a voxel's sum has no order, so
 * threads and instruction sets give the same voxels. Positions are in voxels of the grid, Q12.
 *
 * With the whitened offset u = diag(1 / sigma) R^T (p - mu), distance^2 = u^2 is at most 9, and a Gaussian adds
 * alpha = opacity exp(-distance^2 / 2) to a voxel if that is at least 1/255. p is the voxel's point nearest to mu. */
#include "voxels.h"

#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"
#include "src/core/axes.h"
#include "src/core/codes.h"

/* log2 of sigmas in voxels: thinner Gaussians are drawn as thick, and larger ones (sky) are left out. */
enum { THIN = -6, LARGE = 14 };

typedef struct gaussian {
    int64_t mean_q12[3];
    int64_t row_q24[3][3];         /* u = row * offset, at most 2^30 */
    int32_t low[3], high[3];       /* voxels that it may reach, in the grid */
    int32_t offset_q11;
} gaussian;

/* Where a Gaussian's distance^2 is at most 9 on a row of voxels, if it is narrow: within `half` of the offset along x
   slope[0] dy + slope[1] dz. */
typedef struct narrowing {
    int is_narrow;
    int64_t half_q12, slope_q20[2];
} narrowing;

typedef struct absorption {
    const fxs_scene *scene;
    fxs_bits *grid;
    int64_t origin[3];
    int64_t voxel_q32;
    int32_t log2_voxel_q16;
    uint32_t depth_q15;
    uint32_t *ends;                /* end of each cell's list in `list`; while it is filled, the place of the next */
    uint32_t *list;                /* numbers of Gaussians, 256 * chunk + place */
    uint64_t pairs, most;          /* numbers in all lists, and the most that are allowed */
    int error;                     /* a job found a damaged chunk */
} absorption;

/* Returns 2^-l in Q24, for l from -16 to 16. */
static int64_t falling_q24(int32_t l_q16)
{
    const int32_t whole = l_q16 >> 16;
    const int64_t fraction_q24 = (int64_t)fxs_exp2_q15((l_q16 & 65535) >> 1) << 9;
    return whole < 0 ? fraction_q24 << -whole : fraction_q24 >> whole;
}

/* Returns a bound above sqrt(x). */
static int64_t root_above(uint64_t x)
{
    int shift = 0;
    while (x >> 2 * shift >> 32)
        shift++;
    const int64_t root = (int64_t)fxs_sqrt((uint32_t)(x >> 2 * shift));
    return (root + (root >> 16) + 2) << shift;
}

static void read_axes(int32_t axes_q15[3][3], const fxs_gaussian_axes *a)
{
    for (int i = 0; i < 3; i++) {
        const int32_t sign = i < 2 ? -1 : 1;     /* the voxels' axes are (-x, -y, z) */
        axes_q15[0][i] = sign * a->axis_q15[i];
        axes_q15[1][i] = sign * (fxs_mul_q15(a->side_q15[0][i], a->cos_q15) +
                                 fxs_mul_q15(a->side_q15[1][i], a->sin_q15));
        axes_q15[2][i] = sign * (fxs_mul_q15(a->side_q15[1][i], a->cos_q15) -
                                 fxs_mul_q15(a->side_q15[0][i], a->sin_q15));
    }
}

/* Converts a Gaussian's centre to voxels of the grid. */
static void place(gaussian *out, const absorption *a, const fxs_chunk *chunk, const uint16_t codes[3])
{
    for (int i = 0; i < 3; i++) {
        const int64_t at = chunk->origin_q32[i] + (((int64_t)codes[i] * chunk->step_q32[i]) << chunk->step_shift);
        const int64_t turned = i < 2 ? -at : at;
        int64_t whole = turned / a->voxel_q32, rest = turned % a->voxel_q32;
        whole -= rest < 0;
        rest += rest < 0 ? a->voxel_q32 : 0;
        out->mean_q12[i] = (whole - a->origin[i]) * 4096 + (rest << 12) / a->voxel_q32;
    }
}

/* Finds the voxels of the grid that a Gaussian with these axes, in voxels, may reach. Returns 0 if there are none. */
static int bound(gaussian *out, const absorption *a, const int64_t reach_q12[3])
{
    for (int i = 0; i < 3; i++) {
        const int64_t most = (int64_t)a->grid->n[i] * FXS_CELL - 1;
        const int64_t low = (out->mean_q12[i] - reach_q12[i]) >> 12, high = (out->mean_q12[i] + reach_q12[i]) >> 12;
        if (low > most || high < 0)
            return 0;
        out->low[i] = (int32_t)(low < 0 ? 0 : low);
        out->high[i] = (int32_t)(high > most ? most : high);
    }
    return 1;
}

/* Reads a Gaussian. Returns 0 if it reaches no voxel of the grid. */
static int read_gaussian(gaussian *out, const absorption *a, const fxs_chunk *chunk, const unsigned char *rows,
                         uint32_t g)
{
    const fxs_codes codes = fxs_codes_of(a->scene, rows, g);
    int32_t fall_q16[3], axes_q15[3][3];
    uint64_t reach_q24[3] = {0, 0, 0};
    int64_t reach_q12[3];
    fxs_gaussian_axes axes;
    out->offset_q11 = fxs_offset_of_code_q11[chunk->opacity_law][codes.colour >> 24];
    for (int k = 0; k < 3; k++)
        fall_q16[k] = fxs_fall_q16(fxs_scale_code(codes.scale, k), chunk->scale_step_q24);
    if (!(codes.colour >> 24) || out->offset_q11 > FXS_FAINT_Q11 ||
        !fxs_read_axes(&axes, codes.rotation, fxs_axis_bits(a->scene->profile, fall_q16)))
        return 0;
    read_axes(axes_q15, &axes);
    for (int k = 0; k < 3; k++) {
        const int32_t log2_q16 = chunk->scale_q16 - fall_q16[k] - a->log2_voxel_q16;
        const int32_t size_q16 = log2_q16 < THIN * 65536 ? THIN * 65536 : log2_q16;
        if (size_q16 > LARGE * 65536)
            return 0;
        const int64_t inverse_q24 = falling_q24(size_q16), sigma_q24 = falling_q24(-size_q16);
        for (int i = 0; i < 3; i++) {
            const int64_t along_q12 = axes_q15[k][i] * sigma_q24 >> 27;
            out->row_q24[k][i] = axes_q15[k][i] * inverse_q24 >> 15;
            reach_q24[i] += (uint64_t)(along_q12 * along_q12);
        }
    }
    for (int i = 0; i < 3; i++) {
        const int64_t root_q12 = root_above(reach_q24[i]);
        reach_q12[i] = 3 * root_q12 + (root_q12 >> 6) + 256;
    }
    place(out, a, chunk, codes.position);
    return bound(out, a, reach_q12);
}

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* Counts a Gaussian in the lists of the cells that it may reach, or adds it to them. Returns 0 if the lists would have
   more than `most` numbers. */
static int list_gaussian(absorption *a, const gaussian *g, uint32_t number)
{
    const fxs_bits *grid = a->grid;
    uint64_t cells = 1;
    for (int i = 0; i < 3; i++)
        cells *= (uint64_t)((g->high[i] >> 5) - (g->low[i] >> 5) + 1);
    a->pairs += cells;
    if (a->pairs > a->most)
        return 0;
    for (int32_t z = g->low[2] >> 5; z <= g->high[2] >> 5; z++)
        for (int32_t y = g->low[1] >> 5; y <= g->high[1] >> 5; y++)
            for (int32_t x = g->low[0] >> 5; x <= g->high[0] >> 5; x++) {
                uint32_t *end = &a->ends[(size_t)x + (size_t)grid->n[0] * ((size_t)y + (size_t)grid->n[1] * (size_t)z)];
                if (a->list)
                    a->list[*end] = number;
                *end += 1;
            }
    return 1;
}

static int too_large(uint64_t bytes, const char *least, size_t most, fxs_voxel_work *work)
{
    fxs_fail_as(FXS_ERR_MEMORY, work->message, "voxels of this size need %s %.1f MiB, more than %.1f MiB: make them "
                "larger", least, (double)bytes / 1048576, (double)most / 1048576);
    work->message->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

static int list_all(absorption *a, fxs_voxel_work *work)
{
    a->pairs = 0;
    for (uint32_t c = 0; c < a->scene->chunk_count; c++) {
        fxs_chunk chunk;
        gaussian g;
        if (fxs_chunk_read(&chunk, a->scene, c))
            return fxs_fail_as(FXS_ERR_SCENE, work->message, "%s", fxs_strerror(FXS_ERR_SCENE));
        for (uint32_t i = 0; i < FXS_CHUNK; i++)
            if (read_gaussian(&g, a, &chunk, fxs_rows(a->scene, c), i) && !list_gaussian(a, &g, c * FXS_CHUNK + i))
                return too_large(4 * a->pairs, "at least", 4 * (size_t)a->most, work);
    }
    return 0;
}

/* Turns the counts of cells into the beginnings of their lists, and marks cells with a list as mixed. */
static void begin_lists(absorption *a)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < fxs_bits_cells(a->grid); i++) {
        const uint32_t count = a->ends[i];
        a->grid->states[i] = count ? FXS_CELL_MIXED : FXS_CELL_EMPTY;
        a->ends[i] = sum;
        sum += count;
    }
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Marks the cells up to one away on each axis from a marked cell. */
static void widen(unsigned char *marks, const fxs_bits *g)
{
    const size_t step[3] = {1, (size_t)g->n[0], (size_t)g->n[0] * (size_t)g->n[1]};
    for (int axis = 0; axis < 3; axis++) {
        const size_t cells = fxs_bits_cells(g), n = (size_t)g->n[axis];
        for (size_t i = 0; i < cells; i++)
            marks[i] |= (i / step[axis] % n ? marks[i - step[axis]] & 1 : 0) << 1;
        for (size_t i = cells; i-- > 0;)
            marks[i] |= (i / step[axis] % n + 1 < n ? marks[i + step[axis]] & 1 : 0) << 1;
        for (size_t i = 0; i < cells; i++)
            marks[i] = marks[i] != 0;
    }
}

static int is_border(const fxs_bits *g, size_t cell)
{
    const size_t x = (size_t)g->n[0], y = (size_t)g->n[1], z = (size_t)g->n[2];
    const size_t at[3] = {cell % x, cell / x % y, cell / x / y};
    return !at[0] || !at[1] || !at[2] || at[0] == x - 1 || at[1] == y - 1 || at[2] == z - 1;
}

/* Finds a bound of the working memory: three grids, two of them with bits. Cells with bits are near Gaussians and the
   border, at most 3 cells away. */
static int bound_memory(const absorption *a, uint64_t *bytes, fxs_voxel_work *work)
{
    const size_t cells = fxs_bits_cells(a->grid);
    uint64_t mixed = 0;
    unsigned char *marks = fxs_work_allocate(work, cells, 1);
    if (!marks)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < cells; i++)
        marks[i] = a->ends[i] || is_border(a->grid, i);
    for (int i = 0; i < 3; i++)
        widen(marks, a->grid);
    for (size_t i = 0; i < cells; i++)
        mixed += marks[i];
    const uint64_t lists = 4 * a->pairs, grids = 2 * mixed * FXS_CELL_WORDS * sizeof(uint32_t);
    *bytes = 16 * (uint64_t)cells + (lists > grids ? lists : grids);
    fxs_work_release(work, marks, cells, 1);
    return 0;
}

static int check_memory(const absorption *a, size_t most, fxs_voxel_work *work)
{
    uint64_t bytes;
    FXS_TRY(bound_memory(a, &bytes, work));
    return bytes > most ? too_large(bytes, "up to", most, work) : 0;
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

/* Returns the offset from a Gaussian's centre to the nearest coordinate of voxel i, Q12. */
static int64_t nearest_q12(int64_t mean_q12, int32_t i)
{
    const int64_t low = (int64_t)i * 4096 - mean_q12;
    return low > 0 ? low : low + 4096 < 0 ? low + 4096 : 0;
}

/* Returns alpha at u, or 0 where the Gaussian does not reach. */
static uint32_t alpha_at(const int64_t u_q36[3], int32_t offset_q11)
{
    int64_t square_q24 = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t u_q12 = u_q36[k] >> 24;
        if (u_q12 > 3 * 4096 || u_q12 < -3 * 4096)
            return 0;
        square_q24 += u_q12 * u_q12;
    }
    const int32_t square_q11 = (int32_t)(square_q24 >> 13);
    return square_q11 > fxs_limit_q11(offset_q11, FXS_CUT_Q11) - offset_q11 ? 0
           : (uint32_t)fxs_alpha_q15(square_q11 + offset_q11);
}

/* On a row, distance^2 = A (x - x0)^2 + m with A = sum of row[k][0]^2 and x0 = -sum of row[k][0] (row[k][1] dy +
   row[k][2] dz) / A. Gaussians with a 1 / sqrt(A) above 64 voxels are not narrow. The half has a margin of 2 voxels. */
static narrowing narrow(const gaussian *g)
{
    narrowing n = {0, 0, {0, 0}};
    uint64_t a_q48 = 0;
    int64_t cross_q48[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        a_q48 += (uint64_t)(g->row_q24[k][0] * g->row_q24[k][0]);
        for (int i = 0; i < 2; i++)
            cross_q48[i] += g->row_q24[k][0] * g->row_q24[k][i + 1];
    }
    if (a_q48 < (uint64_t)1 << 36)
        return n;
    const int zeros = fxs_clz64(a_q48) & ~1;
    const int64_t root_q12 = (int64_t)(fxs_rsqrt((uint32_t)(a_q48 << zeros >> 32)) >> (26 - zeros / 2));
    n.half_q12 = 3 * root_q12 + (root_q12 >> 4) + 8192;
    n.is_narrow = 1;
    for (int i = 0; i < 2; i++) {
        n.slope_q20[i] = -cross_q48[i] / (int64_t)(a_q48 >> 20);
        n.is_narrow = n.is_narrow && n.slope_q20[i] < (int64_t)1 << 33 && n.slope_q20[i] > -((int64_t)1 << 33);
    }
    return n;
}

/* Adds a Gaussian to the sums of the voxels x of row (y, z) from `low` to `high`. A sum at the limit stays. */
static void add_to_row(uint32_t *sums, const gaussian *g, const narrowing *n, int32_t low, int32_t high, int32_t y,
                       int32_t z, uint32_t limit_q15)
{
    const int64_t dy = nearest_q12(g->mean_q12[1], y), dz = nearest_q12(g->mean_q12[2], z);
    int64_t row_q36[3], u_q36[3];
    if (n->is_narrow) {
        const int64_t x_q12 = g->mean_q12[0] + ((n->slope_q20[0] * dy + n->slope_q20[1] * dz) >> 20);
        const int64_t first = (x_q12 - n->half_q12) >> 12, last = (x_q12 + n->half_q12) >> 12;
        low = first > low ? (int32_t)(first < high ? first : high + 1) : low;
        high = last < high ? (int32_t)(last > low ? last : low - 1) : high;
    }
    for (int k = 0; k < 3; k++)
        row_q36[k] = g->row_q24[k][1] * dy + g->row_q24[k][2] * dz;
    for (int32_t x = low; x <= high; x++) {
        uint32_t *sum = &sums[x & (FXS_CELL - 1)];
        if (*sum >= limit_q15)
            continue;
        const int64_t dx = nearest_q12(g->mean_q12[0], x);
        for (int k = 0; k < 3; k++)
            u_q36[k] = row_q36[k] + g->row_q24[k][0] * dx;
        *sum += alpha_at(u_q36, g->offset_q11);
    }
}

static void add_to_cell(uint32_t *sums, const gaussian *g, const int32_t cell[3], uint32_t limit_q15)
{
    int32_t low[3], high[3];
    const narrowing n = narrow(g);
    for (int i = 0; i < 3; i++) {
        const int32_t first = cell[i] * FXS_CELL, last = first + FXS_CELL - 1;
        low[i] = g->low[i] > first ? g->low[i] : first;
        high[i] = g->high[i] < last ? g->high[i] : last;
    }
    for (int32_t z = low[2]; z <= high[2]; z++)
        for (int32_t y = low[1]; y <= high[1]; y++)
            add_to_row(sums + FXS_CELL * (FXS_CELL * (z & 31) + (y & 31)), g, &n, low[0], high[0], y, z, limit_q15);
}

static void absorb_cell(void *argument, uint32_t cell, uint32_t words[FXS_CELL_WORDS], void *scratch)
{
    absorption *a = argument;
    const uint32_t nx = (uint32_t)a->grid->n[0], ny = (uint32_t)a->grid->n[1];
    const int32_t at[3] = {(int32_t)(cell % nx), (int32_t)(cell / nx % ny), (int32_t)(cell / nx / ny)};
    uint32_t *sums = scratch, read = FXS_NOTHING;
    fxs_chunk chunk;
    gaussian g;
    memset(sums, 0, sizeof *sums * FXS_CELL * FXS_CELL_WORDS);
    for (uint32_t i = cell ? a->ends[cell - 1] : 0; i < a->ends[cell]; i++) {
        const uint32_t number = a->list[i], from = number / FXS_CHUNK;
        if (from != read && fxs_chunk_read(&chunk, a->scene, from)) {
            FXS_SHARED_WRITE(a->error, FXS_ERR_SCENE);
            return;
        }
        read = from;
        if (read_gaussian(&g, a, &chunk, fxs_rows(a->scene, from), number % FXS_CHUNK))
            add_to_cell(sums, &g, at, a->depth_q15);
    }
    for (int i = 0; i < FXS_CELL * FXS_CELL_WORDS; i++)
        words[i / FXS_CELL] |= (uint32_t)(sums[i] >= a->depth_q15) << i % FXS_CELL;
}

static int absorb(absorption *a, size_t most, fxs_voxel_work *work)
{
    FXS_TRY(list_all(a, work));
    FXS_TRY(check_memory(a, most, work));
    begin_lists(a);
    const size_t pairs = (size_t)a->pairs;
    a->list = fxs_work_allocate(work, pairs, sizeof *a->list);
    int error = a->list ? list_all(a, work) : FXS_ERR_MEMORY;
    error = error ? error : fxs_bits_make(a->grid, absorb_cell, a, sizeof(uint32_t) * FXS_CELL * FXS_CELL_WORDS, work);
    fxs_work_release(work, a->list, pairs, sizeof *a->list);
    return error || !a->error ? error : fxs_fail_as(a->error, work->message, "%s", fxs_strerror(a->error));
}

int fxs_bits_absorb(fxs_bits *grid, const fxs_scene *scene, const int32_t origin[3], int64_t voxel_q32,
                    uint32_t depth_q15, size_t max_memory, fxs_voxel_work *work)
{
    absorption a = {.scene = scene, .grid = grid, .origin = {origin[0], origin[1], origin[2]}, .voxel_q32 = voxel_q32,
                    .log2_voxel_q16 = fxs_log2_q16((uint64_t)voxel_q32) - (32 << 16), .depth_q15 = depth_q15,
                    .most = max_memory / 4 < UINT32_MAX ? max_memory / 4 : UINT32_MAX};
    const size_t cells = fxs_bits_cells(grid);
    a.ends = fxs_work_allocate(work, cells, sizeof *a.ends);
    const int error = a.ends ? absorb(&a, max_memory, work) : FXS_ERR_MEMORY;
    fxs_work_release(work, a.ends, cells, sizeof *a.ends);
    return error;
}
