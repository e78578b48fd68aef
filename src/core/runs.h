/* Passes tiles and their lists of splats to a back end. */
#ifndef FXS_RUNS_H
#define FXS_RUNS_H

#include "frame.h"

/* Sorts the lists of splats of macro tiles (2x2 tiles) first_macro to last_macro, and passes their tiles to the back
   end. Returns 0 or the back end's error. */
int fxs_runs_draw(fxs_frame *f);

/* fxs_runs_unlisted returns true if the back end needs no lists of splats. fxs_runs_draw_unlisted draws the band (some
   rows of tiles) without lists. */
int fxs_runs_unlisted(const fxs_frame *f);
int fxs_runs_draw_unlisted(fxs_frame *f);

/* fxs_runs_by_rows returns true if the back end needs one tile row per call. fxs_runs_draw_rows draws the band (some
   rows of tiles) in this way. */
int fxs_runs_by_rows(const fxs_frame *f);
int fxs_runs_draw_rows(fxs_frame *f);

/* Passes tiles first_tile to last_tile, which are already blended, to the back end. */
int fxs_runs_draw_blended(fxs_frame *f);

#endif
