/* Reads and writes the start data (up direction and first view) in the header of a packed scene. */
#ifndef FXS_INTERNAL_START_H
#define FXS_INTERNAL_START_H

#include <fixsplat/scene.h>

/* Largest tangent of half the vertical field of view of a start view: 170 degrees. */
#define FXS_START_TANGENT_MOST 12.0

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the start data (up direction and first view) from the header of a packed scene at `data`, 192 bytes. Invalid
   data count as missing. */
FXS_EXPERIMENTAL void fxs_start_of(fxs_start *start, const void *data);

/* Stores the start data (up direction and first view) in the header of a packed scene at `data`. Call fxs_file_write or
   fxs_file_seal afterwards. `up` may have any length, and is rounded to a direction within 0.01 degrees of it. Values
   out of range are not stored. */
FXS_EXPERIMENTAL void fxs_start_to(void *data, const fxs_start *start);

/* Reads the box of a packed scene's visible part from the scene's header at `data`. */
FXS_EXPERIMENTAL void fxs_inner_box(const void *data, double low[3], double high[3]);

#ifdef __cplusplus
}
#endif

#endif
