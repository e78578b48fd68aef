/* Which file of a folder has the cameras. */
#ifndef FXS_CAMERA_FIND_H
#define FXS_CAMERA_FIND_H

#include <fixsplat/camera_file.h>

enum { FXS_CAMERA_PATH = 4096 };   /* characters, with the zero at the end */

/* Finds the camera file of a folder, the first of: COLMAP's in sparse/0, sparse or the folder itself, transforms.json,
   transforms_train.json, cameras.json, cameras.xml, cameras.csv, bundle.out. Returns 0 and its path, or an error and a
   message. */
int fxs_camera_file_find(const char *folder, char path[FXS_CAMERA_PATH], fxs_message *message);

#endif
