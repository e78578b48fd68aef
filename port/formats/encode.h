/* Gaussians -> the codes of a chunk (src/packed.h). */
#ifndef FXS_ENCODE_H
#define FXS_ENCODE_H

#include "../../src/packed.h"
#include "pack.h"
#include "scene_file.h"

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

/* Writes a chunk's header. */
void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *ranges);

/* Writes the codes of Gaussian `at` of a chunk whose header is written, and notes the largest errors. */
void fxs_encode(const fxs_chunk *chunk, unsigned char *rows, uint32_t at, const fxs_gaussian *gaussian, int sh_degree,
                fxs_pack_error *largest);

#endif
