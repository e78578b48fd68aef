/* Cameras: made in double precision, read from camera files, and rounded to the renderer's integers. */
#ifndef FXS_CAMERA_H
#define FXS_CAMERA_H

#include "fixsplat.h"

/* windows.h defines the word `near` as nothing; here it is the name of a struct member. */
#ifdef near
#undef near
#undef NEAR
#define NEAR
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Camera files ------------------------------------------------------------------------------------------------ */

/* Reads camera files: Inria's cameras.json, COLMAP's sparse models (.bin and .txt), transforms.json of nerfstudio,
   instant-ngp and Blender, .xml of Agisoft Metashape, .csv of RealityCapture and RealityScan, .out of Bundler. Writes
   cameras.json. */

/* One camera in double precision. Its axes are x right, y down, z forward. Pixel centres lie at +0.5. */
typedef struct fxs_view {
    char name[128];          /* name of the camera's image in the file, cut to fit */
    int width, height;       /* size of the picture in pixels, 1 to FXS_MAX_SIZE */
    double fx, fy, cx, cy;   /* focal lengths and principal point, pixels; in an orthographic camera, fx and fy are
                                pixels per scene unit */
    double rotation[9];      /* rotation matrix from world to camera; its rows are the camera's x, y and z axes in the
                                scene */
    double position[3];      /* centre of the camera, scene units */
    double near;             /* depth of the near plane, scene units; 0: the renderer's default, 0.2 */
    enum fxs_projection projection;   /* perspective, or orthographic if a cameras.json says "orthographic": true */
    int bends;               /* 1: the camera file states lens distortion (radial, tangential, fisheye). The other
                                fields describe a pinhole camera without it */
} fxs_view;

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
FXS_API long fxs_camera_file_read(const char *path, fxs_view **views, fxs_message *message);

/* Writes views (cameras in doubles) as a cameras.json, in the way that system.h describes. The file has the extensions
   cx, cy and "orthographic", which Inria's code does not know. `count` 0 writes an empty array, which
   fxs_camera_file_read refuses. Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
FXS_API int fxs_camera_file_write(const char *path, const fxs_view *views, size_t count, fxs_message *message);

/* ---- Cameras ----------------------------------------------------------------------------------------------------- */

/* Functions on cameras in double precision: they make them, change them, and round them to the renderer's integers. The
   functions keep no state, so several threads may call them at the same time. */

/* Size and field of view of the picture that a camera is made for. */
typedef struct fxs_picture {
    double fov;              /* vertical field of view, degrees, 1 to 170 */
    int width, height;       /* size of the picture in pixels, 1 to FXS_MAX_SIZE */
} fxs_picture;

/* Makes a camera at `eye` that looks towards `target`, both in scene units. `up` is any vector that points up in the
   picture. The near plane is the renderer's default, 0.2. Returns 0, or FXS_ERR_ARGUMENT and a message if no such
   camera exists. */
FXS_API int fxs_view_look_at(fxs_view *view, const double eye[3], const double target[3], const double up[3],
                             const fxs_picture *picture, fxs_message *message);

/* Makes a camera that shows the whole box from corner `low` to corner `high` as large as possible, from the front and
   slightly above. The inner bounds of fxs_pack_report are such a box. The near plane is a hundredth of half the box's
   diagonal, at most 0.2 units. Errors: as fxs_view_look_at, and FXS_ERR_ARGUMENT for a box that is not finite. */
FXS_API int fxs_view_frame_box(fxs_view *view, const double low[3], const double high[3], const double up[3],
                               const fxs_picture *picture, fxs_message *message);

/* Stores a start view (the first camera for viewers) in the header of a packed scene at `data`: position, rotation and
   vertical field of view. Call fxs_file_write or fxs_file_seal afterwards. Returns 0, or FXS_ERR_CAMERA and a message
   for a view that is orthographic, out of the renderer's range, or wider than 170 degrees. */
FXS_API int fxs_view_to_start(void *data, const fxs_view *view, fxs_message *message);

/* Makes a camera of `width` x `height` pixels from the start view that is stored in an open packed scene at `data`. The
   near plane is the renderer's default, 0.2. In a picture that is higher than wide, the vertical field of view
   grows where the scene's visible part would be cut at the left or right: to at most (height / width)^2 times the
   tangent, and to no more at the sides than a picture of 16:9 shows. Returns 1, or 0 if the scene has no start view or
   the size is out of range. */
FXS_API int fxs_view_of_start(fxs_view *view, const void *data, int width, int height);

/* Changes a camera's picture size. It multiplies fx, fy and the distance of the principal point from the picture's
   centre by new width / old width. If the shape changes by a pixel or more, the factor is sqrt(new area / old area), so
   that the new picture shows about as large a part of the scene. */
FXS_API void fxs_view_resize(fxs_view *view, int width, int height);

/* Sets a camera's field of view by the tangents of its sides, as headsets state them: left, right, up, down, with left
   < right and down < up. Left and down are negative if the picture contains the camera's axis. Pixels may become
   non-square. Returns 0, or FXS_ERR_ARGUMENT and a message if the tangents are out of order or beyond +-64. */
FXS_API int fxs_view_set_tangents(fxs_view *view, const double tangents[4], fxs_message *message);

/* Interpolates a camera on a smooth path through `count` key cameras, 1 or more. The number `at` is the place on the
   path, 0 to count - 1; key i lies at `at` = i. Positions, rotations (as quaternions, the shorter way round), the
   logarithms of focal lengths and near planes, and principal points follow Catmull-Rom splines. Size, name and
   projection come from the last key before `at`. */
FXS_API void fxs_view_between(const fxs_view *keys, long count, double at, fxs_view *view);

/* Rounds a camera in double precision to the renderer's integers. Returns 0, or FXS_ERR_CAMERA and a message if a
   number is out of the renderer's range. */
FXS_API int fxs_camera_from_view(fxs_camera *camera, const fxs_view *view, fxs_message *message);

/* Makes a camera of `width` x `height` pixels from the two matrices of an OpenGL program, each 16 numbers by columns
   (as glUniformMatrix4fv takes them, not transposed), for column vectors: eye = view_matrix * world, clip = projection
   * eye. Eye space has OpenGL's axes: x right, y up, the camera looks along -z. In clip space, y points up and depths
   go from -1 (near) to 1 (far). World space is the scene's, in its units.
   The view matrix must not scale, shear or mirror (its rotation is orthonormal within 1e-3). The projection must come
   from glFrustum or glOrtho, centred or not. Its near plane, above 0, becomes the camera's near plane; its far plane is
   ignored, and may be at infinity in perspective. Mirrored pictures, skew and reversed depths are refused. A projection
   with depths of 0 to 1 cannot be detected: it looks like one with a near plane at half the distance. Errors: as
   fxs_camera_from_view, and FXS_ERR_SIZE if width or height is outside 1..FXS_MAX_SIZE. */
FXS_API int fxs_camera_from_matrices(fxs_camera *camera, const double view_matrix[16], const double projection[16],
                                     int width, int height, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
