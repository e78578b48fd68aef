/* Reads camera files: Inria's cameras.json, COLMAP's sparse models (.bin and .txt), transforms.json of nerfstudio,
 * instant-ngp and Blender, .xml of Agisoft Metashape, .csv of RealityCapture and RealityScan, .out of Bundler; and
 * writes the first. Stable from version 1.0 on. */
#ifndef FXS_CAMERA_FILE_H
#define FXS_CAMERA_FILE_H

#include "fixsplat.h"

/* windows.h makes nothing of this word, which is a member below. */
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
    double fx, fy, cx, cy;   /* pixels; in an orthographic camera, fx and fy are pixels a scene unit */
    double rotation[9];      /* world to camera; its rows are the camera's x, y and z axes in the scene */
    double position[3];      /* the camera's centre, scene units */
    double near;             /* depth of the near plane, scene units; 0: the renderer's default, 0.2 */
    enum fxs_projection projection;   /* orthographic where a cameras.json says "orthographic": true */
    int bends;               /* 1: the file says that the lens bends (radial, tangential, fisheye); the other fields are
                                those of a pinhole in its place */
} fxs_file_view;

/* Reads every camera of a file. A file named images or cameras with the ending .bin or .txt is a COLMAP model; the
   content of any other file tells a cameras.json (an array) from a transforms.json (an object with "frames"), and both
   from the others; a .csv and an .xml are told by their name too. From a folder, the first of these is read: a COLMAP
   model in sparse/0, in sparse or in the folder itself, transforms.json, transforms_train.json, cameras.json,
   cameras.xml, cameras.csv, bundle.out. Cameras of COLMAP are sorted by image name.

   Of a Metashape file, cameras without a transform or with enabled="false" are left out; its positions are those of the
   component's, or else the chunk's, coordinate system. Where its translation is of more than 2^16 units, a place on the
   Earth, the first such translation, rounded to whole units, is subtracted from all positions. A .csv of RealityCapture
   ("internal/external camera parameters") has x to the east, y to the north and z up; its distortion is read by Brown's
   model. Bundler's names of photographs are in list.txt or NAME.list.txt beside it; cameras with a focal length of 0
   are left out. The latter two, as Blender's files, state no size of a picture: their views have 800 x 800 pixels.

   Returns the number of cameras, at least 1, with *views allocated by malloc, which the caller frees; or an error and a
   message, which names the faulty camera. Errors: FXS_ERR_FILE where a file is missing, damaged, or has a camera that
   cannot be used (a focal length that is not above 0, a rotation that is not orthonormal within 1e-3, a number that is
   not finite, a size out of range, an unknown camera model); FXS_ERR_UNSUPPORTED for .json where fixsplat was built
   without cJSON and for .xml without expat; FXS_ERR_MEMORY. Several threads may read files at the same time. */
FXS_API long fxs_camera_file_read(const char *path, fxs_file_view **views, fxs_message *message);

/* Writes these views as a cameras.json, with cx, cy and "orthographic", which Inria's code does not know, as output.h
   says; with `count` 0 an empty array, which is not read. Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message.
   */
FXS_API int fxs_camera_file_write(const char *path, const fxs_file_view *views, size_t count, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
