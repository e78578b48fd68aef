/* Quantises Gaussians to the codes of a chunk (packed.h). Packing quantises attributes only here. */
#ifndef FXS_ENCODE_H
#define FXS_ENCODE_H

#include <math.h>

#include <fixsplat/packed.h>
#include "palette.h"
#include <fixsplat/gaussian.h>
#include "src/gaussian/attributes.h"

#define FXS_LOG2_E 1.4426950408889634

/* floor(x) in low..high; NaN is low. */
int fxs_floor_within(double x, int low, int high);

/* The colour of SH degree 0, within +-60. */
static inline double fxs_base_colour(const fxs_gaussian *g, int channel)
{
    const double colour = fxs_colour_of_dc(g->dc[channel]);
    return colour < -60 ? -60 : colour > 60 ? 60 : colour;
}

/* ln(sigma) within +-20; NaN becomes -20. */
float fxs_held_scale(float scale);

/* Makes every axis at least e^-9 of the largest, and clamps ln(sigma) to +-20. */
void fxs_hold_scales(fxs_gaussian *gaussian);

/* Moves a centre beyond +-limit on an axis towards the origin to that limit, and shrinks the axes in proportion, so
   that it looks the same from the origin. Returns 1 where the centre was beyond. */
int fxs_bring_in(fxs_gaussian *gaussian, double limit);

typedef struct fxs_range {
    float low, high;
} fxs_range;

/* The ranges of the attributes of a chunk's Gaussians, from which its header is made. */
typedef struct fxs_chunk_ranges {
    fxs_range position[3], scale, colour[3];
    float sh[3];                     /* largest coefficient of each degree */
    float opacity_harm[FXS_OPACITY_LAWS];   /* harm that rounding by each law would do to the picture */
} fxs_chunk_ranges;

void fxs_ranges_clear(fxs_chunk_ranges *ranges);
void fxs_ranges_take(fxs_chunk_ranges *ranges, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* round(x / step) in +-127, halves upwards, or 0 for a step of 0. x and step are floats of 24 bits, so no quotient but
   an exact half lies within 2^-26 of a half; and the quotient by way of 1 / step, which is wrong by 2^-45 at most, is
   on the right side of it once 2^-30 is added. */
static inline int32_t fxs_coefficient_code(double x, double step, double inverse)
{
    const double most = 127 * step, above = x > -most ? x : -most, held = above < most ? above : most;
    return (int32_t)(held * inverse + (128.5 + 0x1p-30)) - 128;
}

/* The same of `count` coefficients. */
void fxs_code_coefficients(const float *x, int count, double step, int32_t *codes);

/* The largest magnitude of `count` coefficients, 0 or at least 8; NaN counts as 0. */
static inline float fxs_largest_coefficient(const float *sh, int count)
{
    enum { SEVERAL = 8 };            /* so that comparisons do not wait for each other */
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

/* Writes what a header says of positions. */
void fxs_encode_places(fxs_chunk *chunk, const fxs_range position[3]);

/* Writes a chunk's header. Where the file's numbers have few bits and the chunk's range allows it, the codes have the
   steps of the file. */
void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *ranges, const fxs_scene_file_info *info);

enum { FXS_LOSS_POSITION, FXS_LOSS_SCALE, FXS_LOSS_ROTATION, FXS_LOSS_OPACITY, FXS_LOSS_DC, FXS_LOSS_SH, FXS_LOSSES };

/* Differences between the numbers that were read and those of the codes: log2 of a scale, a colour of SH degree 0, the
   angle of a rotation. */
typedef struct fxs_loss {
    double largest[FXS_LOSSES], squares[FXS_LOSSES];
} fxs_loss;

/* How a scene is coded. */
typedef struct fxs_encoder {
    enum fxs_profile profile;
    int sh_degree;
} fxs_encoder;

enum { FXS_RECORD_BYTES = 63 };      /* the most bytes of the codes of a Gaussian */

/* The codes of a Gaussian, as they are in the rows. */
typedef struct fxs_row_codes {
    uint32_t position[3], scale[3];
    uint32_t rotation;                   /* the word; in small its upper 23 bits */
    uint32_t colour[3], opacity;
} fxs_row_codes;

/* Writes these codes one after the other, in the order of the rows of a chunk. Returns the place of the SH codes. */
unsigned char *fxs_put_codes(const fxs_encoder *encoder, const fxs_row_codes *codes, unsigned char *record);

/* Writes the codes of a Gaussian one after the other, in the order of the rows of its chunk, and notes the losses. In a
   profile with a palette, fxs_palette_code_chunk writes the SH codes. */
void fxs_encode(const fxs_encoder *encoder, const fxs_chunk *chunk, const fxs_gaussian *gaussian, double opacity,
                unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss);

/* The gain of a code: (8 + bits 2..0) 2^(bits 7..3) 2^-32. */
double fxs_gain(int code);

/* Turns the records of a chunk, one after the other, into its rows. */
void fxs_encode_rows(const fxs_encoder *encoder, const unsigned char *records, unsigned char *rows);

#endif
