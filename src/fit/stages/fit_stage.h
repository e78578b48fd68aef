/* The stages of a fitting step, and the data between them. A splat is a Gaussian projected to the picture.
 *
 *   project: makes splats from the parameters of Gaussians.
 *   bin: makes a list of splats for each tile of 16x16 pixels, from near to far.
 *   blend: makes the pixels of a tile from its list.
 *   loss: makes the loss gradient by the pixels from the pixels and the photograph.
 *   backward: makes sums for each splat of a list from the gradient by the pixels.
 *   update: makes the gradient by the parameters from the sums, and changes the parameters by a step of Adam.
 *
 * Numbers are IEEE single precision. Sums have a fixed order, for any number of threads and lanes. */
#ifndef FXS_FIT_STAGE_H
#define FXS_FIT_STAGE_H

#include <stddef.h>
#include <stdint.h>

#define FXS_FIT_TILE 16
#define FXS_FIT_PIXELS 256
#define FXS_FIT_BLOCKS 16          /* number of blocks of 4x4 pixels in a tile */
#define FXS_FIT_AT(x, y) (((y) / 4 * 4 + (x) / 4) * 16 + (y) % 4 * 4 + (x) % 4)
#define FXS_FIT_GROUP 16
#define FXS_FIT_PART 256           /* largest number of Gaussians in a call of `update` */

#define FXS_FIT_BATCH 8            /* largest number of photographs in a step */
#define FXS_FIT_CHUNK 256          /* number of successive Gaussians with common quantisation ranges (a chunk) */

/* Numbers of the planes of parameters. A plane is an array with one float for each Gaussian. */
enum {
    FXS_FIT_POSITION = 0,          /* 3 planes: position in scene units */
    FXS_FIT_SCALE = 3,             /* 3 planes: ln of the standard deviation */
    FXS_FIT_ROTATION = 6,          /* 4 planes: quaternion w, x, y, z, not normalised */
    FXS_FIT_OPACITY = 10,          /* 1 plane: logit of the opacity */
    FXS_FIT_COLOUR = 11,           /* 3 planes: spherical harmonics of degree 0 */
    FXS_FIT_SH = 14,               /* 45 planes: red, green, blue of each coefficient of spherical harmonics above
                                      degree 0 */
    FXS_FIT_PARAMETERS = 59
};

typedef struct fxs_fit_camera {
    float rotation[9];             /* 3x3 matrix from world to camera, row by row */
    float eye[3];
    float focal[2], middle[2];     /* focal length and principal point in pixels */
    float slope_most[2];           /* |x / z| and |y / z| are clamped to these limits in the Jacobian of the
                                      projection */
    float near;
    int32_t width, height, tiles_x, tiles_y;
    int32_t is_square;             /* 1: splats end at a square around 3 sigma, as in Kerbl et al. 2023 */
    int32_t is_parallel;           /* 1: orthographic camera, for drawing only */
    int32_t is_antialiased;        /* 1: opacities are reduced to compensate for the dilation (Yu et al. 2024) */
} fxs_fit_camera;

/* A splat: a Gaussian projected to the picture. For a pixel's centre (X, Y), x = X - centre[0] and y = Y - centre[1]: u
   = ux x + uy y, v = vy y, level = (u^2 + v^2) + offset, alpha = min(0.99, 2^-level) if level <= limit, else 0. In a
   block of 4x4 pixels, u is the sum of u at the first pixel and (ux i + uy j), with i and j in 0..3; v likewise. */
typedef struct fxs_fit_splat {
    float centre[2], ux, uy, vy, offset, limit, colour[3];
    float depth;                   /* depth in the camera; 0: not in the picture */
    /* The slightly enlarged ellipse of the splat, which selects its tiles. radius2: squared radius in u and v; half_y:
       half the height; tip: y of the rightmost point. If radius2 < 0, a square with half side half_y selects the tiles
       instead. */
    float radius2, half_y, tip;
    float tiles;
    uint32_t slot;                 /* index of the splat's gradient sums over its first tile */
} fxs_fit_splat;

/* An entry of a tile's list of splats. slot: index of the splat's gradient sums over this tile. blocks: bit set of the
   4x4-pixel blocks that the splat changes. */
typedef struct fxs_fit_entry {
    uint32_t splat, slot, blocks;
} fxs_fit_entry;

/* Gradient sums of a splat over the pixels of a tile, of terms with h = -alpha dL/dalpha. Order of addition in a block
   of 16 pixels: pixels p and p + 8, then p + 4, p + 2 and p + 1; then blocks, then tiles row by row. */
enum { FXS_FIT_SUM, FXS_FIT_SUM_U, FXS_FIT_SUM_V, FXS_FIT_SUM_UU, FXS_FIT_SUM_UV, FXS_FIT_SUM_VV, FXS_FIT_RED,
       FXS_FIT_GREEN, FXS_FIT_BLUE, FXS_FIT_SUMS };

/* The rendered pixels of a tile, one 4x4 block after another (FXS_FIT_AT), without the background. */
typedef struct fxs_fit_tile {
    float colour[3][FXS_FIT_PIXELS], transmittance[FXS_FIT_PIXELS];
} fxs_fit_tile;

/* Gradients of a tile. `colour` holds dL/dcolour of each pixel, and `whole` its dot product with the pixel's colour
   including the background. */
typedef struct fxs_fit_tile_gradient {
    float colour[3][FXS_FIT_PIXELS], whole[FXS_FIT_PIXELS];
} fxs_fit_tile_gradient;

/* A plane of pixels, with one float each: rows `stride` floats apart, with a margin of FXS_FIT_MARGIN pixels beyond
   each edge. */
#define FXS_FIT_MARGIN 16
typedef struct fxs_fit_plane {
    float *first;
    ptrdiff_t stride;
} fxs_fit_plane;

/* Inputs and results of the loss between picture and photograph, for one colour channel. */
enum { FXS_FIT_ROWS = 5, FXS_FIT_DERIVATIVES = 3 };
typedef struct fxs_fit_loss {
    fxs_fit_plane picture, rows[FXS_FIT_ROWS], derivatives[FXS_FIT_DERIVATIVES], gradient;
    float *absolute, *dissimilar;  /* for each row of pixels, the sums of |picture - photograph| and of 1 - SSIM */
    const uint8_t *photograph;     /* bytes of the photograph: neighbours in a row are `step` bytes apart, rows `pitch`
                                      bytes */
    ptrdiff_t step, pitch;
    int32_t width, height;
    const uint8_t *mask;           /* mask of the photograph: null, or a byte per pixel; 0: pixel is ignored */
    int has_exposure;              /* 1: exposures are fitted, so white in the photograph counts as saturated */
} fxs_fit_loss;

/* A sphere around the scene. Beyond `radius` from `middle`, sizes are measured in proportion to the distance. */
typedef struct fxs_fit_far {
    float middle[3], inverse;      /* inverse: 1 / radius of the sphere around the scene; 0: sizes are in scene units
                                      everywhere */
} fxs_fit_far;

typedef struct fxs_fit_adam {
    float rate[FXS_FIT_PARAMETERS];        /* learning rates, with the bias correction of Adam's first moment */
    float correction;              /* bias correction of Adam's second moment, 1 / (1 - 0.999^step) */
    float epsilon;                 /* Adam's epsilon, in units of the gradient */
    float by_opacity, by_scale;    /* weights of the loss terms that penalise opacity and scale */
    float by_flat;                 /* weight of the loss term that penalises the smallest scale; 0: no surfaces */
    int is_depth;                  /* 0: the sums by surfaces are normals, 1: they are gradients by positions */
    fxs_fit_far far;
} fxs_fit_adam;

/* The fitted exposure of a photograph (exposure.h). at: log2 gains of all colours, of red and of blue; or an affine map
   of colours. mean, square: Adam's moments, for an affine map. of_one: Adam's moments of a constant gradient of 1.
   basis: the photograph's row of an orthonormal basis of the functions that exposures keep out of. */
enum { FXS_FIT_GAIN = 12, FXS_FIT_BASIS = 4 };
typedef struct fxs_fit_gain {
    float at[FXS_FIT_GAIN], mean[FXS_FIT_GAIN], square, of_one[2], basis[FXS_FIT_BASIS];
} fxs_fit_gain;

typedef struct fxs_fit_gains {
    fxs_fit_gain *of;
    uint32_t count;
    int is_affine;
} fxs_fit_gains;

/* A fitted correction of a camera's pose (pose.h). at: rotation, then translation. mean, square: Adam's moments.
   of_one: Adam's moments of a constant gradient of 1. depth: typical depth of the picture. */
enum { FXS_FIT_POSE = 6 };
typedef struct fxs_fit_pose {
    float at[FXS_FIT_POSE], mean[FXS_FIT_POSE], square[2], of_one[2], depth;
} fxs_fit_pose;

typedef struct fxs_fit_poses {
    fxs_fit_pose *of;
    uint32_t count;
} fxs_fit_poses;

/* The photographs' cameras at full size, without pose corrections. They set a lower limit on the scales of Gaussians
   (smooth.h). */
typedef struct fxs_fit_cameras {
    fxs_fit_camera *of;
    uint32_t count;
} fxs_fit_cameras;

/* Quantisation of a chunk (256 Gaussians), in units of the parameters. The fields *_inverse are 1 / step, or 0 if the
   step is 0. */
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
    int sh_degree;                 /* highest degree of spherical harmonics that is quantised evenly; 0 with a
                                      palette */
    const fxs_fit_chunk *chunks;
} fxs_fit_grid;

/* Random displacements of Gaussians: Sigma xi sigmoid(-100 (opacity - 0.005)) amount. Sigma is the covariance, and xi
   is normal noise seeded by `key`. Beyond the radius of `far`, Sigma and the displacement are measured in proportion to
   the distance. */
typedef struct fxs_fit_noise {
    float amount;
    uint32_t key[2];
    fxs_fit_far far;
} fxs_fit_noise;

typedef struct fxs_fit_stages {
    const char *name;
    /* Projects the Gaussians first..first + count to splats. `first` and `count` are multiples of FXS_FIT_GROUP. */
    void (*project)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride, size_t first,
                    size_t count, fxs_fit_splat *splats);
    /* For each of the splats first..first + count, writes the numbers of the tiles that it touches to `tiles`, from
       index splat->slot on. */
    void (*cover)(const fxs_fit_camera *camera, const fxs_fit_splat *splats, size_t first, size_t count,
                  uint32_t *tiles);
    /* Blends a tile's list of splats into the tile at (left, top). Returns the number of list entries up to the last
       one that changed a pixel. light: initial transmittance, 1 in a fit. */
    uint32_t (*blend)(const fxs_fit_splat *splats, fxs_fit_entry *entries, uint32_t count, int32_t left, int32_t top,
                      float light, fxs_fit_tile *tile);
    /* Computes the gradient sums of the first `count` splats of a tile's list. Writes each to `sums` at the index
       `slot` of the list entry. */
    void (*backward)(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                     int32_t top, const fxs_fit_tile_gradient *gradient, float (*sums)[FXS_FIT_SUMS]);
    /* The four passes of the loss for one row of pixels, with picture a and photograph b. They compute: sums along the
       row of a, b, a^2, b^2, ab; SSIM and its derivatives; sums of the derivatives along the row; the loss gradient by
       the pixels. */
    void (*loss_rows)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_derivatives)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_backward_rows)(const fxs_fit_loss *loss, int32_t row);
    void (*loss_gradient)(const fxs_fit_loss *loss, int32_t row);
    /* Computes the gradients of at most FXS_FIT_PART Gaussians, and makes a step of Adam on their exact parameters
       before quantisation, `masters`. sums: FXS_FIT_SUMS planes for each camera. |dL/dcentre| is added to by_centre. A
       gradient that is not finite or beyond FXS_FIT_FARTHEST_GRADIENT counts as 0. Scales and opacities are clamped to
       FXS_FIT_FARTHEST. by_surface: null, or 3 planes of sums (fit_surface.h) for each camera, from Gaussian 0 on. */
    void (*update)(const fxs_fit_camera *const *cameras, uint32_t batch, int degree, const fxs_fit_adam *adam,
                   const float *parameters, float *masters, float *means, float *squares, size_t stride, size_t first,
                   size_t count, const float *sums, const float *by_surface, float *by_centre);
    /* Displaces Gaussians randomly. A move beyond FXS_FIT_FARTHEST_PLACE is skipped. */
    void (*noise)(const fxs_fit_noise *noise, float *parameters, size_t stride, size_t first, size_t count);
    /* Raises the scales of Gaussians to their lower limit (smooth.h), for photographs reduced by `divisor`. */
    void (*smooth)(const fxs_fit_cameras *cameras, int divisor, float *parameters, size_t stride, size_t first,
                   size_t count);
    /* Quantises exact parameters of Gaussians, `masters`, and writes the results to `parameters`. */
    void (*quantise)(const fxs_fit_grid *grid, const float *masters, float *parameters, size_t stride, size_t first,
                     size_t count);
    /* Sums the loss gradient by a camera's pose over at most FXS_FIT_PART Gaussians. out: dL/dposition, then dL/dtheta
       of a rotation about the eye. Order of addition: Gaussians p and p + 128, then p and p + 64, and so on. */
    void (*pose)(const fxs_fit_camera *camera, int degree, const float *parameters, size_t stride, size_t first,
                 size_t count, const float *sums, float out[FXS_FIT_POSE]);
    /* Replaces the colours of the visible splats first..first + count by planes of their Gaussians (fit_surface.h). */
    void (*planes)(const fxs_fit_camera *camera, const float *parameters, size_t stride, size_t first, size_t count,
                   fxs_fit_splat *splats);
    /* Computes a row of the gradient by the planes of splats from a picture's depths. planes: the numbers of a
       depth_map (fit_surface.h). is_depth 0: by normals, times -1; 1: by positions. weight: of a pixel in the loss. */
    void (*depths)(const fxs_fit_camera *camera, const fxs_fit_plane planes[4], int32_t row, int is_depth,
                   float weight, const fxs_fit_plane out[3]);
} fxs_fit_stages;

/* Returns the fastest implementation of the fit's stages, among the instruction sets in `cpu` that the processor
   supports. */
const fxs_fit_stages *fxs_fit_stages_choose(unsigned cpu);
extern const fxs_fit_stages fxs_fit_stages_c;

#define FXS_FIT_ALPHA_MOST 0.99f
#define FXS_FIT_CLOSED 0.001f      /* a pixel with a lower transmittance is opaque and takes no more splats */
/* A splat's alpha at a pixel is 2^-level. Apart from the opacity, its level is the squared Mahalanobis distance divided
   by 2 ln 2. */
#define FXS_FIT_UNIT 0.849321800f  /* value of a splat's coordinate u or v at a distance of one sigma: sqrt(1 / (2 ln
                                      2)) */
#define FXS_FIT_CUT 6.49212768f    /* level of an opaque splat at Mahalanobis distance 3, where splats end */
#define FXS_FIT_FAINT 7.99435344f  /* level of a splat at the pixels with an alpha of 1 / 255 */
#define FXS_FIT_WIDER 1.01f        /* factor of squared radii of splats' ellipses, when their tiles are selected */
#define FXS_FIT_DILATION 0.3f      /* dilation of splats: added to the variances in the picture, pixels^2 */
#define FXS_FIT_FARTHEST 40.0f     /* limit of a Gaussian's |ln scale| and |logit of opacity| */
#define FXS_FIT_FARTHEST_PLACE 1e12f   /* limit of each |coordinate| of a Gaussian */
#define FXS_FIT_FARTHEST_GRADIENT 1e18f
#define FXS_FIT_INVERSE_MOST 1e20f
#define FXS_FIT_TURN_MOST 0.5f     /* limit of each |component| of a pose's rotation, radians */
#define FXS_FIT_GAIN_MOST 8.0f     /* limit of each |number| of an exposure */

#endif
