/* Finds the camera file in a folder. */
#ifndef FXS_CAMERA_FIND_H
#define FXS_CAMERA_FIND_H

#include <fixsplat/camera.h>

enum { FXS_CAMERA_PATH = 4096 };

/* Finds a folder's camera file: COLMAP's in sparse/0, sparse or the folder, else transforms.json,
   transforms_train.json, cameras.json, cameras.xml, cameras.csv or bundle.out. Returns 0 and the path, or an error
   and a message. */
int fxs_camera_file_find(const char *folder, char path[FXS_CAMERA_PATH], fxs_message *message);

#endif
