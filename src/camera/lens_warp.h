/* Renders through a lens by resampling a perspective picture. Uses + - * / and sqrt of doubles, and integers for
   colours, so the bytes are the same on every machine. */
#ifndef FXS_LENS_WARP_H
#define FXS_LENS_WARP_H

#include "lens.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FXS_WARP_STEPS = 1024 };

typedef struct fxs_lens_warp {
    fxs_lens lens;
    fxs_view photograph;
    fxs_view cover;
    double step;                   /* spacing of the table's entries, in focal lengths */
    double reach[FXS_WARP_STEPS + 1];    /* table of radii: entry i is the radius in the photograph of a point at i *
                                            step from the axis */
    int steps;                     /* number of table entries, which reach up to 75 degrees from the axis */
} fxs_lens_warp;

/* Prepares rendering through a lens. The perspective picture has at least the photograph's resolution everywhere, up to
   4 times its width and height and FXS_MAX_SIZE. */
void fxs_lens_warp_make(fxs_lens_warp *warp, const fxs_lens *lens, const fxs_view *photograph);

/* Finds the point of the pinhole picture for a point of the photograph: inverts fxs_lens_bend. Returns 0 if the lens
   sees nothing there, or more than 75 degrees off the axis. */
int fxs_lens_warp_straighten(const fxs_lens_warp *warp, const double bent[2], double place[2]);

/* Writes rows first to end - 1 of the photograph as RGBA without padding, interpolated bilinearly from the perspective
   picture. Pixels where the lens sees nothing become `outside`. */
void fxs_lens_warp_rows(const fxs_lens_warp *warp, const uint8_t *cover, const uint8_t outside[4], uint8_t *rgba,
                        int first, int end);

#ifdef __cplusplus
}
#endif

#endif
