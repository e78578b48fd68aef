/* Which photographs there are, where their pixels and the points lie: found, and not yet read. */
#ifndef FXS_FIT_PHOTO_LIST_H
#define FXS_FIT_PHOTO_LIST_H

#include "src/camera/camera_internal.h"

enum { FXS_PHOTO_PATH = FXS_CAMERA_PATH };

typedef struct fxs_photo_list {
    char cameras[FXS_PHOTO_PATH];  /* the file of the cameras */
    char test[FXS_PHOTO_PATH];     /* that of those held out by the files themselves, or empty */
    char images[FXS_PHOTO_PATH];   /* the folder that names of images are of */
    char points[FXS_PHOTO_PATH];   /* the file of the points, or empty */
    int is_colmap;                 /* its points are COLMAP's then, else a .ply */
    fxs_view_list fit, held_out;   /* by name */
} fxs_photo_list;

/* `held_out`: 0, or every n-th photograph by name, unless the files say which. Returns 0 and a list for
   fxs_photo_list_free, or an error and a message. `list` is not to be moved. */
int fxs_photo_list_find(fxs_photo_list *list, const char *path, uint32_t hold_out, fxs_message *message);
void fxs_photo_list_free(fxs_photo_list *list);

/* The path of a view's image, which is looked for with the endings that the file's name may lack. Returns 0, or an
   error and a message. */
int fxs_photo_list_image(const fxs_photo_list *list, const fxs_listed_view *view, char path[FXS_PHOTO_PATH],
                         fxs_message *message);

#endif
