/* Keeps a COLMAP model in its place while photographs are added to it. */
#ifndef FXS_COLMAP_KEEP_H
#define FXS_COLMAP_KEEP_H

#include <fixsplat/fixsplat.h>

/* Gives the images and cameras of the model in the folder `model` the poses and parameters that they have in the folder
   `before`, byte for byte. COLMAP's mapper has made `model` from `before`: it added images and points, held the poses
   of the old images, and then moved and scaled all of them. Other images and the points are moved and scaled back. An
   image that the mapper has dropped returns without its points. Both models are in binary files; images.bin,
   points3D.bin and cameras.bin of `model` are replaced. Returns 0, or an error and a message: FXS_ERR_FILE,
   FXS_ERR_MEMORY. */
int fxs_colmap_keep(const char *before, const char *model, fxs_message *message);

#endif
