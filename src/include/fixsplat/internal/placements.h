/* More functions on placements (rotation, scale, position and crops of a scene), for the library's ports and the
   command. */
#ifndef FXS_INTERNAL_PLACEMENTS_H
#define FXS_INTERNAL_PLACEMENTS_H

#include <fixsplat/world.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns 1 if a placement leaves Gaussians unchanged (crops are ignored), else 0. */
FXS_EXPERIMENTAL int fxs_placement_is_plain(const fxs_placement *placement);

/* Rotate a placement. fxs_placement_turn_up sets the rotation to the shortest one that turns the direction `up`, which
   is not 0, to 0, -1, 0. fxs_placement_turn rotates further, by degrees about the world's axis x, y or z (0, 1 or
   2). */
FXS_EXPERIMENTAL void fxs_placement_turn_up(fxs_placement *placement, const double up[3]);
FXS_EXPERIMENTAL void fxs_placement_turn(fxs_placement *placement, int axis, double degrees);

/* Computes the matrix of a placement: three rows of scale * rotation, each followed by a component of the translation.
   fxs_object_place must accept the placement. */
FXS_EXPERIMENTAL void fxs_placement_matrix(const fxs_placement *placement, double rows[3][4]);

/* Transforms the start data of a scene file (up direction, start view) by a placement, like an object of that file. A
   start view is dropped if its camera would be out of range. */
FXS_EXPERIMENTAL void fxs_placement_start(const fxs_placement *placement, fxs_start *start);

/* Crops the box low..high of a scene file by a placement's crop boxes, and finds the bounding box of the rest in the
   world. Returns 1, or 0 if nothing is left. */
FXS_EXPERIMENTAL int fxs_placement_box(const fxs_placement *placement, const double low[3], const double high[3],
                              double world_low[3], double world_high[3]);

#ifdef __cplusplus
}
#endif

#endif
