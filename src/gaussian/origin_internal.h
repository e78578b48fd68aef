/* Origin of a stream of Gaussians. Far from 0, positions relative to an origin keep their precision as floats. */
#ifndef FXS_ORIGIN_INTERNAL_H
#define FXS_ORIGIN_INTERNAL_H

enum { FXS_ORIGIN_SAMPLE = 33 };    /* most positions from which an origin is chosen */

/* Largest origin on each axis. The sum of an origin and a packed position stays within 2^28 units. */
#define FXS_ORIGIN_FARTHEST 0x1p26

static inline int fxs_has_origin(const double origin[3])
{
    return origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
}

int fxs_is_far(const double place[3]);

/* Sets the origin of a scene with positions around a place: on each axis the nearest multiple of 10. The origin is 0
   where floats are precise enough, or where the place is too far from 0 to pack. */
void fxs_origin_near(double origin[3], const double place[3]);

/* Sets the origin of a scene from the median of at most FXS_ORIGIN_SAMPLE places. Ignores coordinates that are not
   finite. */
void fxs_origin_of(double origin[3], double (*places)[3], int count);

/* Returns the spacing of floats at a place relative to the origin, or 0 if the spacing is fine enough. */
double fxs_spacing_at(const double place[3], const double origin[3]);

#endif
