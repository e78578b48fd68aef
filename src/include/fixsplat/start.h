/* The start data of a packed scene: its up direction and a start view. Both are in the header (packed.h) and optional.
 * The renderer does not read them.
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
    double up[3];         /* up direction in the scene, of length 1; all 0: unknown */
    double tangent;       /* tangent of half the start view's vertical field of view, up to 12; 0: no start view */
    double position[3];   /* centre of the start view's camera, scene units, within +-2^28 */
    double rotation[4];   /* world to camera (x right, y down, z forward): unit quaternion w, x, y, z */
} fxs_start;

/* Reads the start data from the header of a packed scene at `data`, 192 bytes. Invalid data count as missing. */
FXS_API void fxs_start_of(fxs_start *start, const void *data);

/* Stores the start data in the header of a packed scene at `data`; call fxs_file_write or fxs_file_seal afterwards.
   `up` may have any length, and is rounded to a direction within 0.01 degrees of it. Values out of range are not
   stored. */
FXS_API void fxs_start_to(void *data, const fxs_start *start);

#ifdef __cplusplus
}
#endif

#endif
