/* Renders a frame in six stages:
 *
 *     project   project.c   Gaussians become splats: 2D Gaussians in the picture
 *     shade     shade.c     colours of the splats, from spherical harmonics
 *     bin       bin.c       lists of splats per macro tile of 2x2 tiles
 *     sort      sort.c      sorts each list by ascending depth
 *     blend     blend.c     blends a tile's splats over its pixels
 *     resolve   resolve.c   converts the pixels to the caller's format
 *
 * The stages are functions in a table, fxs_kernels, so faster versions can replace any of them. prepare.c calls the
 * first three stages, lists.c makes the lists, draw.c calls the last three. With a back end, runs.c passes it the lists
 * and draw.c is not used.
 *
 * If the memory is large enough, it holds all splats at once. Otherwise bands.c divides the frame into bands of tile
 * rows, and slices.c draws tile rows that are too full to fit. */
#include "sized.h"
#include "bands.h"
#include "draw.h"
#include "lists.h"
#include "prepare.h"
#include "runs.h"
#include "slices.h"
#include "stereo.h"
#include "targets.h"

static int render(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes,
                  fxs_stats *stats)
{
    fxs_frame f;
    int error = fxs_targets_missing(context, request);
    error = error ? error : fxs_frame_init(&f, context, request, memory, memory_bytes);
    if (error)
        return error;
    error = request->eyes == 2 ? fxs_stereo_render(&f, request) : fxs_frame_render(&f);
    if (stats)
        *stats = f.stats;
    return error;
}

/* Not inlined, so that a request of this version takes no copy on the stack. */
static __attribute__((noinline)) int render_copy(const fxs_context *context, const fxs_request *given, void *memory,
                                                 size_t memory_bytes, fxs_stats *stats)
{
    fxs_request request;
    const int error = fxs_request_read(&request, given);
    return error ? error : render(context, &request, memory, memory_bytes, stats);
}

int fxs_render(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes,
               fxs_stats *stats)
{
    if (stats)
        memset(stats, 0, sizeof *stats);
    return fxs_request_is_whole(request) ? render(context, request, memory, memory_bytes, stats)
                                         : render_copy(context, request, memory, memory_bytes, stats);
}

int fxs_frame_render(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    int error = fxs_frame_begin(f);
    f->stats.nanoseconds[FXS_PROJECT] += fxs_now(f) - start;
    while (!error && fxs_band_next(f)) {
        if (f->mode == FXS_FRAME_SLICES)
            error = fxs_slices_draw(f);
        else if (!(error = fxs_prepare_band(f)))
            error = fxs_frame_draw(f);
    }
    f->stats.frame_nanoseconds += fxs_now(f) - start;
    return error;
}

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
        error = f->draw_tile ? fxs_draw_macros(f)
                             : fxs_runs_draw(f);
    }
    for (uint32_t tile = fxs_tiles_above(f, f->first_row); tile < fxs_tiles_above(f, f->end_row); tile++)
        f->stats.entries += f->tile_counts[tile];
    return error;
}
