/* Quantises Gaussians to the codes of a packed scene. A chunk is 256 Gaussians with a common header of ranges and
   steps. A record is the codes of one Gaussian. */
#ifndef FXS_ENCODE_H
#define FXS_ENCODE_H

#include <math.h>

#include <fixsplat/internal/packed.h>
#include "palette.h"
#include <fixsplat/scene.h>
#include "src/gaussian/attributes.h"

#define FXS_LOG2_E 1.4426950408889634

/* Returns floor(x) clamped to low..high, or low for NaN. */
int fxs_floor_within(double x, int low, int high);

/* Returns a Gaussian's colour from SH degree 0, clamped to +-60. */
static inline double fxs_base_colour(const fxs_gaussian *g, int channel)
{
    const double colour = fxs_colour_of_dc(g->dc[channel]);
    return colour < -60 ? -60 : colour > 60 ? 60 : colour;
}

/* Returns a scale, ln(sigma), clamped to +-20, or -20 for NaN. */
float fxs_held_scale(float scale);

/* Raises each axis of a Gaussian to at least e^-9 of its longest axis, and clamps ln(sigma) to +-20. */
void fxs_hold_scales(fxs_gaussian *gaussian);

/* Moves a Gaussian with a centre outside +-limit towards the origin, and shrinks its axes in proportion. Seen from the
   origin, the Gaussian looks the same. Returns 1 if the Gaussian moved. */
int fxs_bring_in(fxs_gaussian *gaussian, double limit);

typedef struct fxs_range {
    float low, high;
} fxs_range;

typedef struct fxs_chunk_ranges {
    fxs_range position[3], scale, colour[3];
    float sh[3];
    float opacity_harm[FXS_OPACITY_LAWS];
} fxs_chunk_ranges;

void fxs_ranges_clear(fxs_chunk_ranges *ranges);
void fxs_ranges_take(fxs_chunk_ranges *ranges, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* Returns the code of an SH coefficient x: round(x / step) clamped to +-127, halves up, or 0 for step 0. `inverse` is 1
   / step. x and step are floats, so x / step is exactly between two codes or at least 2^-26 away from there. Adding
   2^-30 therefore hides the error of x * inverse. */
static inline int32_t fxs_coefficient_code(double x, double step, double inverse)
{
    const double most = 127 * step, above = x > -most ? x : -most, held = above < most ? above : most;
    return (int32_t)(held * inverse + (128.5 + 0x1p-30)) - 128;
}

void fxs_code_coefficients(const float *x, int count, double step, int32_t *codes);

/* Returns the largest magnitude of `count` SH coefficients. `count` is 0 or at least 8. NaN counts as 0. */
static inline float fxs_largest_coefficient(const float *sh, int count)
{
    enum { SEVERAL = 8 };            /* number of independent maxima, so that comparisons overlap in the pipeline */
    float most[SEVERAL] = {0};
    for (int i = 0; i < count; i += SEVERAL) {
        const float *x = count - i < SEVERAL ? sh + count - SEVERAL : sh + i;
        for (int k = 0; k < SEVERAL; k++)
            most[k] = fabsf(x[k]) > most[k] ? fabsf(x[k]) : most[k];
    }
    for (int left = SEVERAL / 2; left > 0; left /= 2)
        for (int k = 0; k < left; k++)
            most[k] = most[left + k] > most[k] ? most[left + k] : most[k];
    return most[0];
}

void fxs_encode_places(fxs_chunk *chunk, const fxs_range position[3]);

/* Writes a chunk's header. If the numbers in the source file lie on a coarse grid, the chunk's codes use the steps of
   that grid where possible. */
void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *ranges, const fxs_scene_file_info *info);

enum { FXS_LOSS_POSITION, FXS_LOSS_SCALE, FXS_LOSS_ROTATION, FXS_LOSS_OPACITY, FXS_LOSS_DC, FXS_LOSS_SH, FXS_LOSSES };

/* Largest errors and sums of squared errors of the decoded attributes. Scales are in log2, rotations in degrees,
   colours of SH degree 0. */
typedef struct fxs_loss {
    double largest[FXS_LOSSES], squares[FXS_LOSSES];
} fxs_loss;

typedef struct fxs_encoder {
    enum fxs_profile profile;
    int sh_degree;
} fxs_encoder;

enum { FXS_RECORD_BYTES = 93 };      /* size in bytes of the largest record, the codes of one Gaussian and its motion */

typedef struct fxs_row_codes {
    uint32_t position[3], scale[3];
    uint32_t rotation;                   /* rotation as one word of codes; file profile small keeps the upper 23 bits */
    uint32_t colour[3], opacity;
} fxs_row_codes;

unsigned char *fxs_put_codes(const fxs_encoder *encoder, const fxs_row_codes *codes, unsigned char *record);

/* Writes the codes of a Gaussian into a record and adds the coding errors to `loss`. If the scene has a palette,
   fxs_palette_code_chunk writes the SH codes instead. */
void fxs_encode(const fxs_encoder *encoder, const fxs_chunk *chunk, const fxs_gaussian *gaussian, double opacity,
                unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss);

/* Returns the quantisation gain of SH residuals for a gain code: (8 + bits 2..0) 2^(bits 7..3) 2^-32. */
double fxs_gain(int code);

/* Transposes the 256 records of a chunk into rows of one attribute each. A record ends with `motion_bytes` bytes of
   motion, in numbers of 2 bytes. */
void fxs_encode_rows(const fxs_encoder *encoder, uint32_t motion_bytes, const unsigned char *records,
                     unsigned char *rows);

#endif
