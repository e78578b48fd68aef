/* Names the kind of a file that is no scene, for error messages. */
#ifndef FXS_FOREIGN_H
#define FXS_FOREIGN_H

#include <stddef.h>

#define FXS_POINT_CLOUD "a point cloud, not Gaussians: a .ply of points is what fit begins with, as points.ply " \
                        "beside the cameras of photographs"
#define FXS_MESH "a mesh, not Gaussians: it is neither drawn nor fitted"

#define FXS_NETWORK "a neural network of PyTorch, which is not run: have its program write a .ply for each frame, as " \
                    "frame0001.ply"

/* Returns 1 for a file of PyTorch: a .zip archive whose first file is data.pkl in a folder. */
int fxs_is_torch(const void *bytes, size_t size);

/* Returns 1 for an .obj mesh, by its first bytes. */
int fxs_is_obj(const void *bytes, size_t size);

/* Names a file's kind by its first 512 bytes, for example "a .zip archive". Returns null for an unknown kind. */
const char *fxs_foreign(const void *bytes, size_t size);

#endif
