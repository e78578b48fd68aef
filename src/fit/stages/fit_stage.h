/* The stages of a fitting step, and the data between them. A splat is a Gaussian projected to the picture.
 *
 *   project   parameters -> splats
 *   bin       splats -> list of splats for each tile of 16x16 pixels, from near to far
 *   blend     list -> pixels of the tile
 *   loss      pixels, photograph -> gradient by the pixels
 *   backward  list, gradient by the pixels -> sums for each splat of the list
 *   update    sums -> gradient by the parameters -> parameters, by Adam
 *
 * Numbers are IEEE single precision. Sums have a fixed order, for any number of threads and lanes. */
#ifndef FXS_FIT_STAGE_H
#define FXS_FIT_STAGE_H

#include <stddef.h>
#include <stdint.h>

#define FXS_FIT_TILE 16
#define FXS_FIT_PIXELS 256
#define FXS_FIT_BLOCKS 16          /* blocks of 4x4 pixels in a tile */
#define FXS_FIT_AT(x, y) (((y) / 4 * 4 + (x) / 4) * 16 + (y) % 4 * 4 + (x) % 4)
#define FXS_FIT_GROUP 16
#define FXS_FIT_PART 256           /* most Gaussians per call of update */

#define FXS_FIT_BATCH 8            /* most photographs per step */
#define FXS_FIT_CHUNK 256          /* Gaussians with common quantisation ranges */

/* Planes of parameters, with a float per Gaussian each. */
enum {
    FXS_FIT_POSITION = 0,          /* 3 planes: position in scene units */
    FXS_FIT_SCALE = 3,             /* 3 planes: ln of the standard deviation */
    FXS_FIT_ROTATION = 6,          /* 4 planes: quaternion w, x, y, z, not normalised */
    FXS_FIT_OPACITY = 10,          /* logit of the opacity */
    FXS_FIT_COLOUR = 11,           /* 3 planes: SH degree 0 */
    FXS_FIT_SH = 14,               /* 45 planes: red, green, blue of each SH coefficient */
    FXS_FIT_PARAMETERS = 59
};

typedef struct fxs_fit_camera {
    float rotation[9];             /* 3x3 matrix from world to camera, row by row */
    float eye[3];
    float focal[2], middle[2];     /* focal length and principal point, pixels */
    float slope_most[2];           /* limit of |x / z| and |y / z| in the Jacobian */
    float near;
    int32_t width, height, tiles_x, tiles_y;
    int32_t is_square;             /* 1: square cut-off of Kerbl et al. 2023 */
    int32_t is_parallel;           /* 1: orthographic camera, for drawing only */
    int32_t is_antialiased;        /* 1: opacities compensate the dilation (Yu et al. 2024) */
} fxs_fit_camera;

/* A Gaussian in the picture. For a pixel's centre (X, Y), x = X - centre[0] and y = Y - centre[1]:
   u = ux x + uy y, v = vy y, level = (u^2 + v^2) + offset, alpha = min(0.99, 2^-level) if level <= limit, else 0.
   In a block of 4x4 pixels, u is the sum of u at the first pixel and (ux i + uy j), i and j in 0..3; v likewise. */
typedef struct fxs_fit_splat {
    float centre[2], ux, uy, vy, offset, limit, colour[3];
    float depth;                   /* 0: not in the picture */
    /* The slightly enlarged ellipse that selects the splat's tiles. radius2: squared radius in u and v; half_y: half
       the height; tip: y of the rightmost point. radius2 < 0: a square of +-half_y instead. */
    float radius2, half_y, tip;
    float tiles;
    uint32_t slot;                 /* place of the splat's sums over its first tile */
} fxs_fit_splat;

/* An entry of a tile's list. slot: place of the splat's sums over this tile. blocks: bit set of the 4x4 blocks that the
   splat changes. */
typedef struct fxs_fit_entry {
    uint32_t splat, slot, blocks;
} fxs_fit_entry;

/* Sums of a splat over the pixels of a tile, with h = -alpha dL/dalpha. Order of addition in a block of 16 pixels:
   pixels p and p + 8, then p + 4, p + 2 and p + 1; then blocks, then tiles row by row. */
enum { FXS_FIT_SUM, FXS_FIT_SUM_U, FXS_FIT_SUM_V, FXS_FIT_SUM_UU, FXS_FIT_SUM_UV, FXS_FIT_SUM_VV, FXS_FIT_RED,
       FXS_FIT_GREEN, FXS_FIT_BLUE, FXS_FIT_SUMS };

/* Pixels of a tile, block by block (FXS_FIT_AT), without the background. */
typedef struct fxs_fit_tile {
    float colour[3][FXS_FIT_PIXELS], transmittance[FXS_FIT_PIXELS];
} fxs_fit_tile;

/* Per pixel: dL/dcolour, and its dot product with the colour including the background. */
typedef struct fxs_fit_tile_gradient {
    float colour[3][FXS_FIT_PIXELS], whole[FXS_FIT_PIXELS];
} fxs_fit_tile_gradient;

/* A plane of pixels: rows of `stride` floats, with a margin of FXS_FIT_MARGIN floats or rows beyond each edge. */
#define FXS_FIT_MARGIN 16
typedef struct fxs_fit_plane {
    float *first;
    ptrdiff_t stride;
} fxs_fit_plane;

/* Data of the loss for one colour channel. */
enum { FXS_FIT_ROWS = 5, FXS_FIT_DERIVATIVES = 3 };
typedef struct fxs_fit_loss {
    fxs_fit_plane picture, rows[FXS_FIT_ROWS], derivatives[FXS_FIT_DERIVATIVES], gradient;
    float *absolute, *dissimilar;  /* per row: sums of |picture - photograph| and of 1 - SSIM */
    const uint8_t *photograph;     /* bytes of the photograph, `step` apart in a row; rows are `pitch` apart */
    ptrdiff_t step, pitch;
    int32_t width, height;
    const uint8_t *mask;           /* null, or a byte per pixel; 0: pixel is ignored */
    int has_exposure;              /* 1: white in the photograph counts as saturated */
} fxs_fit_loss;

/* Beyond `radius` from `middle`, sizes are measured in proportion to the distance. */
typedef struct fxs_fit_far {
    float middle[3], inverse;      /* inverse: 1 / radius; 0: sizes are in scene units everywhere */
} fxs_fit_far;

typedef struct fxs_fit_adam {
    float rate[FXS_FIT_PARAMETERS];        /* learning rates, with the bias correction of Adam's first moment */
    float correction;              /* bias correction of Adam's second moment, 1 / (1 - 0.999^step) */
    float epsilon;                 /* Adam's epsilon, in units of the gradient */
    float by_opacity, by_scale;    /* regularisers, added to dL/dopacity and dL/dscale */
    fxs_fit_far far;
} fxs_fit_adam;

/* The exposure of a photograph (exposure.h). at: log2 gains of all colours, of red and of blue; or an affine map of
   colours. mean, square: Adam's moments. of_one: Adam's moments of a constant gradient of 1. */
enum { FXS_FIT_GAIN = 12 };
typedef struct fxs_fit_gain {
    float at[FXS_FIT_GAIN], mean[FXS_FIT_GAIN], square, of_one[2];
} fxs_fit_gain;

typedef struct fxs_fit_gains {
    fxs_fit_gain *of;
    uint32_t count;
    int is_affine;
} fxs_fit_gains;

/* A correction of a camera's pose (pose.h). at: rotation, then translation. mean, square: Adam's moments. of_one:
   Adam's moments of a constant gradient of 1. depth: typical depth of the picture. */
enum { FXS_FIT_POSE = 6 };
typedef struct fxs_fit_pose {
    float at[FXS_FIT_POSE], mean[FXS_FIT_POSE], square[2], of_one[2], depth;
} fxs_fit_pose;

typedef struct fxs_fit_poses {
    fxs_fit_pose *of;
    uint32_t count;
} fxs_fit_poses;

/* The photographs' cameras at full size, without pose corrections. They limit scales from below (smooth.h). */
typedef struct fxs_fit_cameras {
    fxs_fit_camera *of;
    uint32_t count;
} fxs_fit_cameras;

/* Quantisation of a chunk of Gaussians, in units of the parameters. *_inverse: 1 / step, or 0 if the step is 0. */
typedef struct fxs_fit_chunk {
    float low[3], step[3], inverse[3];
    float scale, scale_step, scale_inverse;
    float colour[3], colour_step[3], colour_inverse[3];
    float sh_step[3], sh_inverse[3];
    float opacity_range, opacity_inverse;
} fxs_fit_chunk;

typedef struct fxs_fit_grid {
    int position_bits, scale_bits[3], rotation_bits;
    int axis_bits_least, axis_bits_most;
    int colour_bits[3];
    int sh_degree;                 /* highest SH degree that is quantised; 0 with a palette */
    const fxs_fit_chunk *chunks;
} fxs_fit_grid;

/* Noise of positions: Sigma xi sigmoid(-100 (opacity - 0.005)) amount, with xi normal and seeded by `key`. Sigma and
   the displacement are in units of `far`. */
typedef struct fxs_fit_noise {
    float amount;
    uint32_t key[2];
    fxs_fit_far far;
} fxs_fit_noise;

typedef struct fxs_fit_stages {
    const char *name;
    /* Projects Gaussians first..first + count; `first` and `count` are multiples of FXS_FIT_GROUP. */
    void (*project)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride, size_t first,
                    size_t count, fxs_fit_splat *splats);
    /* Writes the tiles of splats first..first + count to their slots. */
    void (*cover)(const fxs_fit_camera *camera, const fxs_fit_splat *splats, size_t first, size_t count,
                  uint32_t *tiles);
    /* Blends a list into the tile at (left, top). Returns the number of entries up to the last one that changed a
       pixel. light: initial transmittance, 1 in a fit. */
    uint32_t (*blend)(const fxs_fit_splat *splats, fxs_fit_entry *entries, uint32_t count, int32_t left, int32_t top,
                      float light, fxs_fit_tile *tile);
    /* Writes the sums of the first `count` entries to their slots. */
    void (*backward)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                     int32_t top, const fxs_fit_tile_gradient *gradient, float (*sums)[FXS_FIT_SUMS]);
    /* Passes of the loss for one row, with picture a and photograph b: row sums of a, b, a^2, b^2, ab; SSIM and its
       derivatives; row sums of the derivatives; gradient. */
    void (*loss_rows)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_derivatives)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_backward_rows)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_gradient)(const fxs_fit_loss *loss, int32_t row);
    /* Computes the gradients of at most FXS_FIT_PART Gaussians, and makes a step of Adam on the masters (parameters
       before quantisation). sums: FXS_FIT_SUMS planes for each camera. by_centre accumulates |dL/dcentre|. A gradient
       that is not finite or beyond FXS_FIT_FARTHEST_GRADIENT counts as 0. Scales and opacities are clamped to
       FXS_FIT_FARTHEST. */
    void (*update)(const fxs_fit_camera *const *cameras, uint32_t batch, int degree, const fxs_fit_adam *adam,
                   const float *parameters, float *masters, float *means, float *squares, size_t stride, size_t first,
                   size_t count, const float *sums, float *by_centre);
    /* Moves Gaussians by noise. Moves beyond FXS_FIT_FARTHEST_PLACE are skipped. */
    void (*noise)(const fxs_fit_noise *noise, float *parameters, size_t stride, size_t first, size_t count);
    /* Raises scales to their lower limit (smooth.h), for photographs reduced by `divisor`. */
    void (*smooth)(const fxs_fit_cameras *cameras, int divisor, float *parameters, size_t stride, size_t first,
                   size_t count);
    /* Sets `parameters` to the quantised `masters`. */
    void (*quantise)(const fxs_fit_grid *grid, const float *masters, float *parameters, size_t stride, size_t first,
                     size_t count);
    /* Sums the gradient by a camera's pose over at most FXS_FIT_PART Gaussians: dL/dposition, then dL/dtheta of a
       rotation about the eye. Order of addition: Gaussians p and p + 128, then p and p + 64, and so on. */
    void (*pose)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride, size_t first,
                 size_t count, const float *sums, float out[FXS_FIT_POSE]);
} fxs_fit_stages;

/* Returns the fastest stages for the instruction sets in `cpu` that the processor supports. */
const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu);
extern const fxs_fit_stages fxs_fit_stages_c;

#define FXS_FIT_ALPHA_MOST 0.99f
#define FXS_FIT_CLOSED 0.001f      /* pixels with less transmittance take no more splats */
/* A level is a squared Mahalanobis distance / (2 ln 2). */
#define FXS_FIT_UNIT 0.849321800f  /* unit of u and v: sqrt(1 / (2 ln 2)) */
#define FXS_FIT_CUT 6.49212768f    /* level of Mahalanobis distance 3 */
#define FXS_FIT_FAINT 7.99435344f  /* level of an alpha of 1 / 255 */
#define FXS_FIT_WIDER 1.01f        /* enlarges squared radii of ellipses when a splat's tiles are selected */
#define FXS_FIT_DILATION 0.3f      /* dilation: added to variances in the picture, pixels^2 */
#define FXS_FIT_FARTHEST 40.0f     /* largest |ln scale| and |logit| */
#define FXS_FIT_FARTHEST_PLACE 1e12f   /* largest |coordinate| */
#define FXS_FIT_FARTHEST_GRADIENT 1e18f
#define FXS_FIT_INVERSE_MOST 1e20f
#define FXS_FIT_TURN_MOST 0.5f     /* largest |component| of a pose's rotation, radians */
#define FXS_FIT_GAIN_MOST 8.0f     /* largest |number| of an exposure */

#endif
