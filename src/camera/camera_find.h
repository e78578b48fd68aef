/* Finds the camera file in a folder. */
#ifndef FXS_CAMERA_FIND_H
#define FXS_CAMERA_FIND_H

#include <fixsplat/camera.h>

enum { FXS_CAMERA_PATH = 4096 };   /* characters with the final zero */

/* Finds the camera file of a folder, the first of: sparse/0, sparse or the folder itself with COLMAP files,
   transforms.json, transforms_train.json, cameras.json, cameras.xml, cameras.csv, bundle.out. Returns 0 and its
   path, or an error and a message. */
int fxs_camera_file_find(const char *folder, char path[FXS_CAMERA_PATH], fxs_message *message);

#endif
