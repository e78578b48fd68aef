/* Camera files: Inria cameras.json, COLMAP sparse models (.bin and .txt), nerfstudio or Blender transforms.json. */
#ifndef FXS_CAMERA_FILE_H
#define FXS_CAMERA_FILE_H

#include <stddef.h>

#include "../files/message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One view. Camera axes: x right, y down, z forward; pixel centres at +0.5. */
typedef struct fxs_file_view {
    char name[128];          /* image name, cut to fit */
    int width, height;       /* pixels, 1 to 16384 */
    double fx, fy, cx, cy;   /* pixels */
    double rotation[9];      /* world to camera, rows: the camera's x, y and z axes in the scene */
    double position[3];      /* the camera's centre in the scene */
    double near;             /* depth of the near plane, scene units; 0: the renderer's default, 0.2 */
} fxs_file_view;

/* Reads every view of a camera file, told by content: a cameras.json (an array), a transforms.json (an object with
   "frames"), or a COLMAP model, named by its folder or by its images.bin or images.txt. COLMAP views come in order of
   their image name. Returns the number of views, at least 1, with *views allocated by malloc and owned by the caller;
   or -1 and a message, naming the view where one is at fault (focal length not above 0, rotation not orthonormal
   within 1e-3, not finite, size out of range, distorting camera model). */
long fxs_camera_file_read(const char *path, fxs_file_view **views, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
