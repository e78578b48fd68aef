/* Passes tile lists to a back end. */
#ifndef FXS_RUNS_H
#define FXS_RUNS_H

#include "frame.h"

/* Sorts the lists of macro tiles first_macro to last_macro, and passes their tiles to the back end. Returns 0 or the
   back end's error, like the functions below. */
int fxs_runs_draw(fxs_frame *f);

/* fxs_runs_unlisted: true if the back end needs no lists. The second function draws the band with such a back end. */
int fxs_runs_unlisted(const fxs_frame *f);
int fxs_runs_draw_unlisted(fxs_frame *f);

/* After fxs_lists_count: fxs_runs_by_rows is true if the back end needs the band tile row by tile row. The second
   function draws it in this way. */
int fxs_runs_by_rows(const fxs_frame *f);
int fxs_runs_draw_rows(fxs_frame *f);

/* Passes the blended tiles first_tile to last_tile to the back end, which resolves them. */
int fxs_runs_draw_blended(fxs_frame *f);

#endif
