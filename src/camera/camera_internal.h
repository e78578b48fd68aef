/* The list of views (cameras in double precision) that the readers of camera files fill. Unless stated otherwise,
   functions return 0, or an error and a message. */
#ifndef FXS_CAMERA_INTERNAL_H
#define FXS_CAMERA_INTERNAL_H

#include <stddef.h>

#include <fixsplat/camera.h>
#include "camera_find.h"
#include "lens.h"
#include "src/base/text_internal.h"

enum fxs_view_part {FXS_VIEW_OF_ANY, FXS_VIEW_TO_FIT, FXS_VIEW_TO_TEST, FXS_VIEW_LEFT_OUT};

/* How a camera file without picture sizes states its focal lengths. Its pictures get a size of 800 x 800 pixels. */
enum fxs_view_size {
    FXS_SIZE_STATED,
    FXS_SIZE_OF_WIDTH,             /* Blender: the field of view across the width */
    FXS_SIZE_OF_LONGER,            /* RealityCapture: the focal length relative to the picture's longer side */
    FXS_SIZE_OF_PIXELS             /* Bundler: the focal length in pixels */
};

typedef struct fxs_listed_view {
    fxs_view view;
    fxs_lens lens;
    char *image;
    char *mask;
    enum fxs_view_part part;
    enum fxs_view_size sizeless;
    double time;                   /* moment of the photograph, in the file's unit; NAN: the file states none */
} fxs_listed_view;

typedef struct fxs_view_list {
    const char *path;
    fxs_message *message;
    fxs_listed_view *views;
    size_t count, capacity;
    enum fxs_camera_format {FXS_CAMERAS_OF_COLMAP, FXS_CAMERAS_OF_TRANSFORMS, FXS_CAMERAS_OF_INRIA, FXS_CAMERAS_OF_CSV,
                            FXS_CAMERAS_OF_BUNDLER, FXS_CAMERAS_OF_METASHAPE} format;
    int moved;          /* 1: a geographic offset was subtracted from the cameras' positions */
    int has_parts;      /* 1: the camera file splits photographs into those for fitting and those for testing */
    char *points;       /* path of the .ply point cloud that the camera file names, or NULL */
} fxs_view_list;

int fxs_view_list_read(fxs_view_list *list);
void fxs_view_list_free(fxs_view_list *list);

/* Appends a view (camera) with all fields 0 to the list. If `name` is NULL, the view is named by its index. The
   returned view is valid until the next call. */
int fxs_view_list_add(fxs_view_list *list, const char *name, fxs_listed_view **view);

int fxs_view_list_mask(const fxs_view_list *list, fxs_listed_view *view, const char *mask);

void fxs_listed_view_free(fxs_listed_view *view);

/* Writes an error message about the last view of the list and returns FXS_ERR_FILE. */
int fxs_view_list_fault(const fxs_view_list *list, const char *fault);

/* Completes the last view of the list: sets its size, checks it, and makes its rotation orthonormal. */
int fxs_view_list_finish(fxs_view_list *list, double width, double height);

/* Makes a view that shows a whole box, with the camera in direction `from`. */
int fxs_view_frame_from(fxs_view *view, const double low[3], const double high[3], const double from[3],
                        const double up[3], const fxs_picture *picture, fxs_message *message);

/* Computes the direction from a scene to its camera in the horizontal plane, which is perpendicular to `axis`. Sets
   `axis` to the unit vector of `up`. */
int fxs_level_back(double back[3], double axis[3], const double up[3], fxs_message *message);

/* Replaces a matrix by the nearest rotation. Returns 0 if the matrix is not orthonormal within 1e-3. */
int fxs_to_rotation(double r[9]);

/* Converts a rotation matrix, row by row, to a unit quaternion w, x, y, z. */
void fxs_quaternion_of(const double r[9], double q[4]);

const char *fxs_without_drive(const char *name);

/* Skips "./" at the beginning of a path. */
static inline const char *fxs_without_dots(const char *path)
{
    while (path[0] == '.' && path[1] == '/')
        path += 2;
    return path;
}

/* Sets the picture size of a view. If the camera file states no size, this also computes focal lengths and principal
   point. */
void fxs_view_set_size(const fxs_listed_view *listed, fxs_view *view, int width, int height);

int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json);
int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images);
int fxs_camera_csv_parse(fxs_view_list *list, const fxs_text *csv);
int fxs_camera_bundler_parse(fxs_view_list *list, const fxs_text *model, const fxs_text *photographs);
int fxs_camera_metashape_parse(fxs_view_list *list, const fxs_text *xml);

int fxs_camera_bundler_read(fxs_view_list *list, const fxs_text *model);

#endif
