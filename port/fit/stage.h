/* The stages of a step, and the data between them.
 *
 *   project   parameters -> splats in the picture
 *   bin       splats -> for each tile of 16x16 pixels, those that touch it, near to far
 *   blend     a tile's list -> its pixels
 *   loss      pixels, photograph -> the gradient of the pixels
 *   back      a tile's list, the gradient of its pixels -> sums for each splat of the list
 *   update    those sums -> gradients of the parameters -> parameters, by Adam
 *
 * Numbers are IEEE single precision; sums have the order that is said here, whatever the threads and lanes. */
#ifndef FXS_FIT_STAGE_H
#define FXS_FIT_STAGE_H

#include <stddef.h>
#include <stdint.h>

#define FXS_FIT_TILE 16
#define FXS_FIT_PIXELS 256
#define FXS_FIT_BLOCK 16           /* Gaussians of a job come in multiples of it */

#define FXS_FIT_CHUNK 256          /* Gaussians that are packed by the same steps: FXS_CHUNK */

/* Planes of parameters, one after the other, `stride` numbers each. */
enum {
    FXS_FIT_POSITION = 0,          /* 3: scene units */
    FXS_FIT_SCALE = 3,             /* 3: ln of the standard deviation */
    FXS_FIT_ROTATION = 6,          /* 4: quaternion w, x, y, z, of any length but 0 */
    FXS_FIT_OPACITY = 10,          /* logit */
    FXS_FIT_COLOUR = 11,           /* 3: SH degree 0 */
    FXS_FIT_SH = 14,               /* 45: coefficient by coefficient, of each red, green, blue */
    FXS_FIT_PARAMETERS = 59
};

typedef struct fxs_fit_camera {
    float rotation[9];             /* world to camera, rows */
    float eye[3];
    float focal[2], middle[2];     /* pixels */
    float slope_most[2];           /* the Jacobian takes slopes up to here, either way */
    float near;
    int32_t width, height, tiles_x, tiles_y;
} fxs_fit_camera;

/* A Gaussian in the picture. For a pixel's centre (X, Y), x = X - centre[0], y = Y - centre[1]:
   u = ux x + uy y, v = vy y, level = u^2 + v^2 + offset, alpha = min(0.99, exp(-level / 2)), where level <= limit. */
typedef struct fxs_fit_splat {
    float centre[2], ux, uy, vy, offset, limit, colour[3];
    float depth;                   /* 0: not in the picture */
    float half[2];                 /* of the ellipse, pixels, along x and y */
    uint32_t tiles, slot;          /* that it touches; of the first one's sums: the others follow, row by row */
} fxs_fit_splat;

/* A splat in a tile's list: its number, and where its sums over this tile go. */
typedef struct fxs_fit_entry {
    uint32_t splat, slot;
} fxs_fit_entry;

/* Sums over pixels of a tile, h = -alpha dL/dalpha: each first over the rows of a column, top to bottom, then over the
   16 columns: c and c + 8, of those c and c + 4, c + 2, c + 1. */
enum { FXS_FIT_SUM, FXS_FIT_SUM_X, FXS_FIT_SUM_Y, FXS_FIT_SUM_XX, FXS_FIT_SUM_XY, FXS_FIT_SUM_YY, FXS_FIT_RED, FXS_FIT_GREEN,
       FXS_FIT_BLUE, FXS_FIT_SUMS };

/* A tile's pixels, rows of 16: colours without background and transmittance. */
typedef struct fxs_fit_tile {
    float colour[3][FXS_FIT_PIXELS], transmittance[FXS_FIT_PIXELS];
} fxs_fit_tile;

/* Of each pixel: dL/dcolour, and its product with the whole colour, background included. */
typedef struct fxs_fit_tile_gradient {
    float colour[3][FXS_FIT_PIXELS], whole[FXS_FIT_PIXELS];
} fxs_fit_tile_gradient;

/* Planes of pixels: rows of `stride` numbers, with FXS_FIT_MARGIN of them (and rows) beyond each edge. */
#define FXS_FIT_MARGIN 16
typedef struct fxs_fit_plane {
    float *first;                  /* of pixel (0, 0) */
    ptrdiff_t stride;
} fxs_fit_plane;

/* What loss needs between its passes, of a channel: sums over the windows' rows, then the derivatives of SSIM, and
   their sums. */
enum { FXS_FIT_ROWS = 5, FXS_FIT_DERIVATIVES = 3 };
typedef struct fxs_fit_loss {
    fxs_fit_plane picture, gradient, values, rows[FXS_FIT_ROWS], derivatives[FXS_FIT_DERIVATIVES];
    const uint8_t *photograph;     /* bytes, `step` apart, `pitch` from row to row */
    ptrdiff_t step, pitch;
    int32_t width, height;
} fxs_fit_loss;

/* Adam's state beside a parameter, and the numbers of a step. */
typedef struct fxs_fit_adam {
    float rate[FXS_FIT_PARAMETERS];        /* over the correction of the first moment */
    float correction;              /* 1 / (1 - 0.999^step) */
    float epsilon;                 /* in units of the gradient */
} fxs_fit_adam;

/* How the Gaussians of a chunk (FXS_FIT_CHUNK of them) are quantised: what fxs_chunk says, in the units of the parameters.
   An inverse is of the step of the profile's own codes; 0 where the step is. */
typedef struct fxs_fit_chunk {
    float low[3], step[3], inverse[3];              /* positions */
    float scale, scale_step, scale_inverse;         /* log2(sigma) */
    float colour[3], colour_step[3], colour_inverse[3];
    float sh_step[3], sh_inverse[3];
    float opacity_range, opacity_inverse;           /* 0: law 0 */
} fxs_fit_chunk;

typedef struct fxs_fit_grid {
    int position_bits, scale_bits[3], rotation_bits, colour_bits[3];
    int sh_degree;                 /* up to which SH are quantised by sh_step; 0 where a palette has them */
    const fxs_fit_chunk *chunks;
} fxs_fit_grid;

/* The versions of an instruction set. */
typedef struct fxs_fit_stages {
    const char *name;
    /* Splats of Gaussians first..first + count; both multiples of FXS_FIT_BLOCK. */
    void (*project)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride, size_t first,
                    size_t count, fxs_fit_splat *splats);
    /* A list's splats to pixels of the tile at (left, top). Returns how many entries were needed. */
    uint32_t (*blend)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                      int32_t top, fxs_fit_tile *tile);
    /* The sums of the first `count` entries, each to its slot. */
    void (*back)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left, int32_t top,
                 const fxs_fit_tile_gradient *gradient, float (*sums)[FXS_FIT_SUMS]);
    /* A row each: sums along it of a, b, a^2, b^2, ab; SSIM and its derivatives; sums along it of those; the gradient.
       `scratch`: 4 rows of width + 3 margins. */
    void (*loss_rows)(const fxs_fit_loss *loss, int32_t row, float *scratch);
    void (*loss_derivatives)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_back_rows)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_gradient)(const fxs_fit_loss *loss, int32_t row, float *scratch);
    /* Gradients of Gaussians first..first + count from `sums` (a Gaussian's, planes of `stride`), and a step of Adam by
       them of the masters, which are the parameters where nothing is quantised. by_centre: adds up the length of
       dL/dcentre, in halves of the picture's sides. */
    void (*update)(const fxs_fit_camera *camera, int degree, const fxs_fit_adam *adam, const float *parameters,
                   float *masters, float *means, float *squares, size_t stride, size_t first, size_t count,
                   const float *sums, float *by_centre);
    /* The parameters of Gaussians first..first + count become what packing makes of the masters. */
    void (*quantise)(const fxs_fit_grid *grid, const float *masters, float *parameters, size_t stride, size_t first,
                     size_t count);
} fxs_fit_stages;

/* The best version for the instruction sets in `cpu` (enum fxs_cpu) that this processor has. */
const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu);

#define FXS_FIT_ALPHA_MOST 0.99f
#define FXS_FIT_CLOSED 0.001f      /* a pixel with less transmittance takes no more */
#define FXS_FIT_CUT 9.0f           /* the Mahalanobis distance 3, squared */
#define FXS_FIT_FAINT 11.0825270f  /* 2 ln 255 */
#define FXS_FIT_DILATION 0.3f      /* pixels^2 */

#endif
