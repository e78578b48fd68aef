/* Functions that the writers of scene formats share. Some writers hold all Gaussians in memory until the last is
   known. */
#ifndef FXS_SCENE_WRITE_INTERNAL_H
#define FXS_SCENE_WRITE_INTERNAL_H

#include "src/base/output_internal.h"
#include "src/scene/formats_internal.h"

/* fixed-point 1: SH coefficients of Gaussians in memory are multiples of 1/4096, within +-8 */
#define FXS_HELD_SH_ONE 4096

typedef struct fxs_held_gaussian {
    float position[3], scale[3], dc[3];
    float rotation[4];             /* unit length */
    float opacity;                 /* opacity from 0 to 1, not a logit */
} fxs_held_gaussian;

typedef struct fxs_held {
    fxs_output output;
    fxs_held_gaussian *gaussians;
    int16_t *sh;                   /* SH coefficients in the order of fxs_gaussian */
    uint32_t *order;               /* indices of the Gaussians in memory, in spatial order; or null */
    uint32_t count, next;
    uint32_t coefficients;
} fxs_held;

/* Convert an fxs_gaussian to a Gaussian held in memory and back. */
void fxs_held_set(fxs_held_gaussian *held, int16_t *sh, const fxs_gaussian *gaussian, uint32_t coefficients);
void fxs_held_get(const fxs_held_gaussian *held, const int16_t *sh, fxs_gaussian *gaussian, uint32_t coefficients);

/* Opens an output file and allocates room for its Gaussians. Returns 0, or an error and a message, with nothing to
   close. */
int fxs_held_open(fxs_held *held, const char *path, const fxs_scene_write_options *options, fxs_message *message);

int fxs_held_put(fxs_held *held, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Sorts the Gaussians in memory into groups of 256 neighbours. Returns 1, or 0 and the error in held->output. */
int fxs_held_order(fxs_held *held);

int fxs_held_close(fxs_held *held, fxs_message *message);

/* Write little-endian numbers and return the end of the buffer. */
uint8_t *fxs_put_u32(uint8_t *to, uint32_t value);
uint8_t *fxs_put_floats(uint8_t *to, const float *values, size_t n);

/* Rounds a number to a 16-bit float (binary16), at most 65504 in magnitude, and returns its bits. NaN becomes 0. */
uint32_t fxs_code_half(double x);

/* Rounds a number to the nearest integer from 0 to `most`. NaN becomes 0. */
uint32_t fxs_code_within(double x, uint32_t most);

/* Codes a quaternion w, x, y, z by its three smallest components. Codes 0 to `most` stand for -1/sqrt(2) to 1/sqrt(2).
   The sign of the quaternion is chosen so that the largest component is positive. Returns the index of the largest
   component. */
uint32_t fxs_code_rotation(const float rotation[4], uint32_t most, uint32_t codes[3]);

#endif
