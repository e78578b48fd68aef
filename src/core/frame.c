/* A frame, from fxs_render to its pixels, by six stages in this order:
 *
 *   project    Gaussians to splats, 2D Gaussians in the picture            project.c
 *   shade      the splats' colours, from their spherical harmonics         shade.c
 *   bin        which tiles each splat touches, and a list of splats for each macro tile of 2x2 tiles     bin.c
 *   sort       each list by depth, near to far                             sort.c
 *   blend      a tile's splats over its pixels                             blend.c
 *   resolve    pixels to the caller's formats                              resolve.c
 *
 * The stages are functions of a table, fxs_kernels, so that a faster version may take the place of any. prepare.c calls
 * the first three, lists.c makes the lists, and draw.c calls the last three. Where the caller has a back end, runs.c
 * gives it the lists in place of draw.c. A frame is rendered at once, where the memory holds all splats; else bands.c
 * divides it into bands of tile rows, and slices.c does so with a tile row that is too full for the memory. */
#include "memory.h"
#include "parts.h"

/* bin's lists, sort, blend and resolve: for as many macro tiles at a time as their lists fit in the memory. */
int fxs_frame_draw(fxs_frame *f)
{
    int error = 0;
    if (fxs_runs_unlisted(f))
        return fxs_runs_draw_unlisted(f);
    fxs_lists_count(f);
    if (fxs_runs_by_rows(f))
        return fxs_runs_draw_rows(f);
    for (uint32_t end = f->last_macro + 1; f->first_macro < end && !error; f->first_macro = f->last_macro + 1) {
        fxs_lists_fill(f, end);
        error = f->draw_tile ? fxs_draw_macros(f) : fxs_runs_draw(f);
    }
    for (uint32_t tile = fxs_tiles_above(f, f->first_row); tile < fxs_tiles_above(f, f->end_row); tile++)
        f->stats.entries += f->tile_counts[tile];
    return error;
}

/* A band: project, shade and bin make its splats, then they are drawn. */
static int render_band(fxs_frame *f)
{
    const int error = fxs_prepare_band(f);
    return error ? error : fxs_frame_draw(f);
}

int fxs_frame_render(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    int error = fxs_frame_begin(f);
    f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
    while (!error && fxs_band_next(f))
        error = f->mode == FXS_FRAME_SLICES ? fxs_slices_draw(f) : render_band(f);
    f->stats.frame_nanoseconds += fxs_now(f) - start;
    return error;
}

int fxs_render(const fxs_context *context, const fxs_object *objects, uint32_t count, const fxs_camera *camera,
               const fxs_options *options, const fxs_targets *targets, void *memory, size_t memory_bytes,
               fxs_stats *stats)
{
    fxs_frame f;
    if (stats)
        memset(stats, 0, sizeof *stats);
    int error = fxs_targets_missing(context, targets);
    if (!error)
        error = fxs_frame_init(&f, context, objects, count, camera, options, targets, memory, memory_bytes);
    if (error)
        return error;
    error = fxs_frame_render(&f);
    if (stats)
        *stats = f.stats;
    return error;
}
