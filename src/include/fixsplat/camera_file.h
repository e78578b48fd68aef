/* Reads camera files: Inria's cameras.json, COLMAP's sparse models (.bin and .txt), transforms.json of nerfstudio,
 * instant-ngp and Blender, .xml of Agisoft Metashape, .csv of RealityCapture and RealityScan, .out of Bundler. Writes
 * cameras.json. Stable from version 1.0 on. */
#ifndef FXS_CAMERA_FILE_H
#define FXS_CAMERA_FILE_H

#include "fixsplat.h"

/* windows.h defines this word as nothing; below it is a member. */
#ifdef near
#undef near
#undef NEAR
#define NEAR
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* One camera in doubles. Its axes: x right, y down, z forward; pixel centres at +0.5. */
typedef struct fxs_file_view {
    char name[128];          /* image name, cut to fit */
    int width, height;       /* pixels, 1 to FXS_MAX_SIZE */
    double fx, fy, cx, cy;   /* pixels; in an orthographic camera, fx and fy are pixels per scene unit */
    double rotation[9];      /* world to camera; its rows are the camera's x, y and z axes in the scene */
    double position[3];      /* the camera's centre, scene units */
    double near;             /* depth of the near plane, scene units; 0: the renderer's default, 0.2 */
    enum fxs_projection projection;   /* orthographic if a cameras.json says "orthographic": true */
    int bends;               /* 1: the file states lens distortion (radial, tangential, fisheye), which the other fields
                                ignore: they describe a pinhole camera */
} fxs_file_view;

/* Reads every camera of a file. A file named images or cameras with the ending .bin or .txt is a COLMAP model. For
   other files the content distinguishes a cameras.json (an array), a transforms.json (an object with "frames") and the
   other formats; a .csv and an .xml are also recognised by their names. In a folder, the first of these is read: a
   COLMAP model in sparse/0, in sparse or in the folder itself, transforms.json, transforms_train.json, cameras.json,
   cameras.xml, cameras.csv, bundle.out. Cameras of COLMAP are sorted by image name.

   Metashape: cameras without a transform or with enabled="false" are left out. Positions are in the coordinate system
   of the component, or else of the chunk. If the translation of this system exceeds 2^16 units, as in geographic
   coordinates, the first such translation, rounded to whole units, is subtracted from all positions. RealityCapture: a
   .csv ("internal/external camera parameters") has x to the east, y to the north and z up; its distortion is Brown's
   model. Bundler: names of photographs are in list.txt or NAME.list.txt next to the file; cameras with a focal length
   of 0 are left out. Bundler, RealityCapture and Blender state no picture size: their views have 800 x 800 pixels.

   Returns the number of cameras, at least 1, with *views allocated by malloc, which the caller frees; or an error and a
   message that names the faulty camera. Errors: FXS_ERR_FILE if a file is missing, damaged, or has an invalid camera (a
   focal length that is not above 0, a rotation that is not orthonormal within 1e-3, a number that is not finite, a size
   out of range, an unknown camera model); FXS_ERR_UNSUPPORTED for .json if fixsplat was built without cJSON and for
   .xml without expat; FXS_ERR_MEMORY. Several threads may read files at the same time. */
FXS_API long fxs_camera_file_read(const char *path, fxs_file_view **views, fxs_message *message);

/* Writes views as a cameras.json, as output.h says, with the extensions cx, cy and "orthographic", which Inria's code
   does not know. `count` 0 writes an empty array, which fxs_camera_file_read refuses. Returns 0, or FXS_ERR_FILE or
   FXS_ERR_MEMORY and a message. */
FXS_API int fxs_camera_file_write(const char *path, const fxs_file_view *views, size_t count, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
