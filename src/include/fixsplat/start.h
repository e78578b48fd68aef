/* What a packed scene says of how to begin: which way is up in it, and a view. Both are in its header (packed.h), and
 * either may be missing. The renderer does not read them.
 *
 * The functions keep no state, so several threads may call them at the same time.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_START_H
#define FXS_START_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All fields 0: nothing is known. */
typedef struct fxs_start {
    double up[3];         /* the direction that is up in the scene, of length 1; all 0: not known */
    double tangent;       /* of half the vertical field of view of the start view, up to 12; 0: there is none */
    double position[3];   /* the centre of its camera, scene units, within +-2^28 */
    double rotation[4];   /* its rotation, world to camera (x right, y down, z forward): unit quaternion w, x, y, z */
} fxs_start;

/* Reads it from the header of a packed scene at `data`, 192 bytes. What is not valid there is as if it was missing. */
FXS_API void fxs_start_of(fxs_start *start, const void *data);

/* Keeps it in the header of a packed scene at `data`; fxs_file_write or fxs_file_seal come after it. `up` may have any
   length, and is rounded to a direction within 0.01 degrees of it. What is out of range is not kept. */
FXS_API void fxs_start_to(void *data, const fxs_start *start);

#ifdef __cplusplus
}
#endif

#endif
