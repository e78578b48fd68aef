/* The list of views and the functions that the camera readers share. */
#ifndef FXS_CAMERA_INTERNAL_H
#define FXS_CAMERA_INTERNAL_H

#include <stddef.h>

#include <fixsplat/camera_file.h>
#include "camera_find.h"
#include "lens.h"
#include "src/base/text_internal.h"

/* Which list of a file has a photograph. */
enum fxs_view_part {FXS_VIEW_OF_ANY, FXS_VIEW_TO_FIT, FXS_VIEW_TO_TEST, FXS_VIEW_LEFT_OUT};

/* What a file that states no size of a picture says of it. Its views have the intrinsics of 800 x 800 pixels. */
enum fxs_view_size {
    FXS_SIZE_STATED,
    FXS_SIZE_OF_WIDTH,             /* Blender: an angle, that of the width */
    FXS_SIZE_OF_LONGER,            /* RealityCapture: intrinsics in parts of the longer side, from the middle */
    FXS_SIZE_OF_PIXELS             /* Bundler: a focal length in pixels; the principal point is in the middle */
};

/* A view, with the data that reading its photograph needs. */
typedef struct fxs_listed_view {
    fxs_file_view view;
    fxs_lens lens;
    char *image;        /* name of the photograph in the file, not cut; NULL: none */
    char *mask;         /* name of the photograph's mask in the file; NULL: none */
    enum fxs_view_part part;
    enum fxs_view_size sizeless;
} fxs_listed_view;

/* The views that were read so far. */
typedef struct fxs_view_list {
    const char *path;   /* for messages */
    fxs_message *message;
    fxs_listed_view *views;
    size_t count, capacity;
    enum fxs_camera_format {FXS_CAMERAS_OF_COLMAP, FXS_CAMERAS_OF_TRANSFORMS, FXS_CAMERAS_OF_INRIA, FXS_CAMERAS_OF_CSV,
                            FXS_CAMERAS_OF_BUNDLER, FXS_CAMERAS_OF_METASHAPE} format;
    int moved;          /* 1: positions are not those of the file: its place on the Earth was left out */
    int has_parts;      /* 1: the file says which photographs are to be fitted or to test with: none is OF_ANY */
    char *points;       /* path of the .ply with points in a transforms.json, or NULL */
} fxs_view_list;

/* Reads the file at list->path, as fxs_camera_file_read says. Returns 0, or an error and a message. */
int fxs_view_list_read(fxs_view_list *list);
void fxs_view_list_free(fxs_view_list *list);

/* Appends a view that is all 0 except its name; where `name` is NULL, that is its index. Returns 0 and the view, which
   stays in place until the next is added, or an error and a message. */
int fxs_view_list_add(fxs_view_list *list, const char *name, fxs_listed_view **view);

/* Sets the name of a view's mask; NULL: it has none. Returns 0, or an error and a message. */
int fxs_view_list_mask(const fxs_view_list *list, fxs_listed_view *view, const char *mask);

/* Frees what a view has beside itself. */
void fxs_listed_view_free(fxs_listed_view *view);

/* Writes a message about the last added view and returns FXS_ERR_FILE. */
int fxs_view_list_fault(const fxs_view_list *list, const char *fault);

/* Sets the size of the last added view, checks all of the view, and makes its rotation orthonormal; a scale in its
   matrix is left out. */
int fxs_view_list_finish(fxs_view_list *list, double width, double height);

/* As fxs_view_frame_box, from a direction: the camera lies `from` the middle of the box. */
int fxs_view_frame_from(fxs_file_view *view, const double low[3], const double high[3], const double from[3],
                        const double up[3], double fov, int width, int height, fxs_message *message);

/* The direction in which the camera of fxs_view_frame_box lies, but for its height: at a right angle to `axis`, which
   becomes `up` with length 1. */
int fxs_level_back(double back[3], double axis[3], const double up[3], fxs_message *message);

/* Changes a matrix to the nearest rotation. Returns 0 where it is not orthonormal within 1e-3. */
int fxs_to_rotation(double r[9]);

/* The unit quaternion w, x, y, z of a rotation, in rows. */
void fxs_quaternion_of(const double r[9], double q[4]);

/* The name of a photograph behind its folders, where these are a path of Windows; else the name. */
const char *fxs_without_drive(const char *name);

/* A path without each "./" at its beginning. */
static inline const char *fxs_without_dots(const char *path)
{
    while (path[0] == '.' && path[1] == '/')
        path += 2;
    return path;
}

/* Sets the size of a view, and with it the intrinsics of a file that states none. */
void fxs_view_set_size(const fxs_listed_view *listed, fxs_file_view *view, int width, int height);

/* The readers. Each returns 0, or an error and a message. The texts may be changed. */
int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json);
int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images);
int fxs_camera_csv_parse(fxs_view_list *list, const fxs_text *csv);
int fxs_camera_bundler_parse(fxs_view_list *list, const fxs_text *model, const fxs_text *photographs);
int fxs_camera_metashape_parse(fxs_view_list *list, const fxs_text *xml);

/* Reads a Bundler model and the list of its photographs beside it. */
int fxs_camera_bundler_read(fxs_view_list *list, const fxs_text *model);

#endif
