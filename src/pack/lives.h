/* Packs moving scenes: sorts Gaussians by the time in which they are seen, and codes their motion. */
#ifndef FXS_LIVES_H
#define FXS_LIVES_H

#include "encode.h"
#include "order.h"

/* When a Gaussian is seen: from the first to the second time, seconds. Gaussians of one chunk must have the same
   `start` and `end`, between which they exist. `centre` is the time of the largest opacity; without a fade, a time
   within the life. */
typedef struct fxs_life {
    float from, to, start, end, centre;
} fxs_life;

/* The time of a chunk of 256 Gaussians, in doubles. */
typedef struct fxs_chunk_time {
    double middle, unit;           /* seconds; u is (t - middle) / unit */
    float drift[3];                /* largest coefficients of u of its positions, scene units */
} fxs_chunk_time;

/* Returns 1 if all numbers of a motion are finite, or infinite where that has a meaning, and `fade` is above 0. */
int fxs_motion_usable(const fxs_motion *motion);

/* Returns the time in which a Gaussian is seen. It ends where its opacity code becomes 0. */
fxs_life fxs_life_of(const fxs_motion *motion, double opacity, const fxs_time *time);

/* Widens the bounds by the positions of a Gaussian in the part of its life within the scene's duration. */
void fxs_motion_sweep(fxs_range position[3], const fxs_gaussian *gaussian, const fxs_motion *motion,
                      const fxs_life *life);

/* Sorts entries in the order of fxs_order, and those of each run of chunks by the time of their lives. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_order_in_time(fxs_order_entry *entries, const fxs_life *lives, uint32_t count, const fxs_time *time,
                      float reach, const fxs_pack_options *options);

/* Sets the time of a chunk from its lives' union, and how far their centres are from it. Writes when the chunk is
   alive. */
void fxs_chunk_time_set(fxs_chunk_time *time, fxs_chunk_motion *motion, const fxs_life *all, double centre_low,
                        double centre_high, const fxs_time *scene);

/* Computes the coefficients of u, u^2, u^3 of a Gaussian's position on one axis, scene units; *rest is the position at
   u = 0. */
void fxs_motion_develop(double coefficients[3], double *rest, const fxs_gaussian *gaussian, const fxs_motion *motion,
                        int axis, const fxs_chunk_time *time);

/* Computes the coefficients of u of the quaternion 1 + turn u that rotates a Gaussian from its rotation at u = 0. */
void fxs_motion_turn(double turn[4], const fxs_gaussian *gaussian, const fxs_motion *motion,
                     const fxs_chunk_time *time);

/* Changes a Gaussian to its position and rotation at the middle of its chunk's time. */
void fxs_motion_rest(fxs_gaussian *gaussian, const fxs_motion *motion, const fxs_chunk_time *time);

/* Raises the largest drift of a chunk to a Gaussian's. */
void fxs_motion_take(fxs_chunk_time *time, const fxs_gaussian *gaussian, const fxs_motion *motion);

/* Sets the shift of a chunk's drift codes, after its header is known. */
void fxs_chunk_shift_set(fxs_chunk_motion *motion, const fxs_chunk_time *time, const fxs_chunk *chunk);

/* Writes the codes of a motion to a record. `gaussian` is as the file has it. Returns 1 if a number was limited. */
int fxs_motion_encode(unsigned char *record, const fxs_time *scene, const fxs_chunk_time *time,
                      const fxs_chunk_motion *chunk_motion, const fxs_chunk *chunk, const fxs_gaussian *gaussian,
                      const fxs_motion *motion);

/* Returns the largest number of chunks that are alive at one time. `times` has room for 2 * count. */
uint32_t fxs_motion_most(const fxs_chunk_motion *motions, uint32_t count, int32_t *times);

#endif
