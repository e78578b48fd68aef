/* What the camera readers share. */
#ifndef FXS_CAMERA_INTERNAL_H
#define FXS_CAMERA_INTERNAL_H

#include <stddef.h>

#include <fixsplat/camera_file.h>
#include "lens.h"
#include "src/base/text_internal.h"

enum { FXS_CAMERA_PATH = 4096 };   /* characters, with the zero at the end */

/* A view, and what only those want who read its photograph. */
typedef struct fxs_listed_view {
    fxs_file_view view;
    fxs_lens lens;
    char *image;        /* its name as the file has it, whole; NULL: it has none */
    int sizeless;       /* 1: the file says an angle alone; the view's size and intrinsics are for 800 x 800 */
} fxs_listed_view;

/* The views read so far. */
typedef struct fxs_view_list {
    const char *path;   /* for messages */
    fxs_message *message;
    fxs_listed_view *views;
    size_t count, capacity;
    int is_array;       /* 1: it was a cameras.json */
    char *points;       /* name of the .ply that a transforms.json names for its points, or NULL */
} fxs_view_list;

/* The camera file of a folder: COLMAP's in sparse/0, sparse or itself, transforms.json, transforms_train.json or
   cameras.json, the first that there is. Returns 0 and its path, or an error and a message. */
int fxs_camera_file_find(const char *folder, char path[FXS_CAMERA_PATH], fxs_message *message);

/* Reads the file at list->path, as fxs_camera_file_read says. Returns 0, or an error and a message. */
int fxs_view_list_read(fxs_view_list *list);
void fxs_view_list_free(fxs_view_list *list);

/* Appends a view that is all 0 but for its name: its index, where `name` is NULL. Returns 0 and the view, which stays
   in place until the next is added, or an error and a message. */
int fxs_view_list_add(fxs_view_list *list, const char *name, fxs_listed_view **view);

/* Writes a message about the view that was added last and returns FXS_ERR_FILE. */
int fxs_view_list_fault(const fxs_view_list *list, const char *fault);

/* Gives the view that was added last its size, checks it whole, and brings its rotation to the nearest one. */
int fxs_view_list_finish(fxs_view_list *list, double width, double height);

/* Brings a matrix to the nearest rotation. Returns 0 where it is none within 1e-3. */
int fxs_to_rotation(double r[9]);

/* The readers. Both return 0, or an error and a message. The COLMAP texts may be changed. */
int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json);
int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images);

#endif
