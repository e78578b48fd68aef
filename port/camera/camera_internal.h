/* What the camera readers share. */
#ifndef FXS_CAMERA_INTERNAL_H
#define FXS_CAMERA_INTERNAL_H

#include <stddef.h>

#include "camera_file.h"
#include "../files/text_internal.h"

/* The views read so far. */
typedef struct fxs_view_list {
    const char *path;   /* for messages */
    fxs_message *message;
    fxs_file_view *views;
    size_t count, capacity;
} fxs_view_list;

/* Appends a zeroed view with a name, its index where NULL. Returns it, or NULL and a message. */
fxs_file_view *fxs_view_add(fxs_view_list *list, const char *name);

/* Writes a message about the view that was added last and returns -1. */
int fxs_view_fault(const fxs_view_list *list, const char *fault);

/* Checks the view that was added last and makes its rotation orthonormal. */
int fxs_view_finish(fxs_view_list *list, double width, double height);

/* Both return 0, or -1 and a message. The COLMAP texts may be changed. */
int fxs_camera_json_parse(fxs_view_list *list, const fxs_text *json);
int fxs_camera_colmap_parse(fxs_view_list *list, int binary, const fxs_text *cameras, const fxs_text *images);

#endif
