/* The origin of a stream: positions of scenes far out keep their precision as floats relative to it. */
#ifndef FXS_ORIGIN_INTERNAL_H
#define FXS_ORIGIN_INTERNAL_H

enum { FXS_ORIGIN_SAMPLE = 33 };    /* places by which an origin is chosen, at most */

/* Of an origin, on each axis: with the positions that fxs_pack takes relative to it, places stay within 2^28 units. */
#define FXS_ORIGIN_FARTHEST 0x1p26

static inline int fxs_has_origin(const double origin[3])
{
    return origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
}

/* 1 where floats are too coarse for a place. */
int fxs_is_far(const double place[3]);

/* Sets the origin for positions around a place: on each axis the nearest multiple of 10, or 0 where that is near enough
   for floats, or too far out to be packed. */
void fxs_origin_near(double origin[3], const double place[3]);

/* The same for the median of some places, at most FXS_ORIGIN_SAMPLE. Coordinates that are not finite do not count. */
void fxs_origin_of(double origin[3], double (*places)[3], int count);

/* 0, or the spacing of floats at a place that is far from the origin. */
double fxs_spacing_at(const double place[3], const double origin[3]);

#endif
