/* Draws through a lens: a perspective picture that covers what the lens sees is bent to the pixels of its photograph.
   Positions are computed in doubles by + - * / and sqrt alone, and colours in integers, so the bytes are the same on
   every machine. */
#ifndef FXS_LENS_WARP_H
#define FXS_LENS_WARP_H

#include "lens.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FXS_WARP_STEPS = 1024 };

typedef struct fxs_lens_warp {
    fxs_lens lens;
    fxs_file_view photograph;
    fxs_file_view cover;           /* the camera of the perspective picture */
    double step;                   /* reach[i]: where the lens puts what is i * step from the axis, in focal lengths, */
    double reach[FXS_WARP_STEPS + 1];    /* without its tangential terms */
    int steps;                     /* as far as that grows, and 75 degrees from the axis at most */
} fxs_lens_warp;

/* The perspective picture has at least as many pixels for what the lens sees as the photograph, but at most 4 times its
   width and height and FXS_MAX_SIZE. */
void fxs_lens_warp_make(fxs_lens_warp *warp, const fxs_lens *lens, const fxs_file_view *photograph);

/* The inverse of fxs_lens_bend. Returns 0 where the lens sees nothing there, or more than 75 degrees from the axis. */
int fxs_lens_warp_straighten(const fxs_lens_warp *warp, const double bent[2], double place[2]);

/* Writes rows first to end - 1 of a picture of the photograph's size. Pixels are RGBA without gaps; each is
   interpolated between four of the picture of `cover`, at a place rounded to 1/256 pixel. Where the lens sees nothing
   it is `outside`. */
void fxs_lens_warp_rows(const fxs_lens_warp *warp, const uint8_t *cover, const uint8_t outside[4], uint8_t *rgba,
                        int first, int end);

#ifdef __cplusplus
}
#endif

#endif
