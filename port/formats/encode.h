/* Gaussians -> the codes of a chunk (src/packed.h). The only place where attributes are quantised. */
#ifndef FXS_ENCODE_H
#define FXS_ENCODE_H

#include "../../src/packed.h"
#include "palette.h"
#include "scene_file.h"

/* ln(sigma) within +-20; NaN becomes -20. */
float fxs_held_scale(float scale);

/* Raises axes that are thinner than e^-9 of the largest to that, and cuts all to +-20. */
void fxs_hold_scales(fxs_gaussian *gaussian);

/* Brings a centre beyond +-limit on an axis to there, towards the origin, and the axes in proportion, so that it looks
   the same from the origin. Returns 1 where it was beyond. */
int fxs_bring_in(fxs_gaussian *gaussian, double limit);

typedef struct fxs_range {
    float low, high;
} fxs_range;

/* Of the attributes of a chunk's Gaussians, before its header can be written. */
typedef struct fxs_chunk_ranges {
    fxs_range position[3], scale, colour[3];
    float sh[3];                     /* largest coefficient of each degree */
} fxs_chunk_ranges;

void fxs_ranges_clear(fxs_chunk_ranges *ranges);
void fxs_ranges_take(fxs_chunk_ranges *ranges, const fxs_gaussian *gaussian, int sh_degree);

/* Writes a chunk's header. Where the file's numbers are in few bits and a chunk's range allows it, codes are those of
   the file. */
void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *ranges, const fxs_scene_file_info *info);

enum { FXS_LOSS_POSITION, FXS_LOSS_SCALE, FXS_LOSS_ROTATION, FXS_LOSS_OPACITY, FXS_LOSS_DC, FXS_LOSS_SH, FXS_LOSSES };

/* Differences between what was read and what the codes say: of each number, but of a rotation its angle. */
typedef struct fxs_loss {
    double largest[FXS_LOSSES], squares[FXS_LOSSES];
} fxs_loss;

/* How a scene is coded. */
typedef struct fxs_encoder {
    enum fxs_profile profile;
    int sh_degree;
    const fxs_palette *palette;      /* null without one */
} fxs_encoder;

/* The coefficients of a Gaussian in the order of a palette. */
void fxs_sh_vector_of(fxs_sh_vector vector, const fxs_gaussian *gaussian, int sh_degree);

enum { FXS_RECORD_BYTES = 63 };      /* of the codes of one Gaussian, at most */

/* Writes the codes of a Gaussian one after the other, in the order of the rows of its chunk, and notes what is lost. */
void fxs_encode(const fxs_encoder *encoder, const fxs_chunk *chunk, const fxs_gaussian *gaussian,
                unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss);

/* Turns the records of a chunk, one after the other, into its rows. */
void fxs_encode_rows(const fxs_encoder *encoder, const unsigned char *records, unsigned char *rows);

#endif
