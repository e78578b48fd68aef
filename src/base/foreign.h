/* Names the kind of a file that is not of the kind that was expected, for messages. */
#ifndef FXS_FOREIGN_H
#define FXS_FOREIGN_H

#include <stddef.h>

/* Words for scenes that are none of Gaussians, with their use. */
#define FXS_POINT_CLOUD "a point cloud, not Gaussians: a .ply of points is what fit begins with, as points.ply " \
                        "beside the cameras of photographs"
#define FXS_MESH "a mesh, not Gaussians: it is neither drawn nor fitted"

/* Words for the kind of a file by its first bytes, as "a .zip archive"; 512 bytes are enough for every kind. NULL: a
   kind that is not known. */
const char *fxs_foreign(const void *bytes, size_t size);

#endif
