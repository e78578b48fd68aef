/* The list of photographs with their cameras, and the paths of images, masks and points. Pixels are read later. */
#ifndef FXS_FIT_PHOTO_LIST_H
#define FXS_FIT_PHOTO_LIST_H

#include <fixsplat/fit.h>
#include "src/camera/camera_internal.h"

enum { FXS_PHOTO_PATH = FXS_CAMERA_PATH };

typedef struct fxs_photo_list {
    char cameras[FXS_PHOTO_PATH];  /* camera file */
    char test[FXS_PHOTO_PATH];     /* camera file of held-out photographs, or empty */
    char images[FXS_PHOTO_PATH];   /* folder that image names are relative to */
    char masks[FXS_PHOTO_PATH];    /* folder of masks, or empty */
    char points[FXS_PHOTO_PATH];   /* file of points, or empty: in the camera file's format, or a .ply */
    fxs_view_list fit, held_out;   /* sorted by name */
    fxs_view_list rest;            /* excluded by the camera file */
} fxs_photo_list;

/* Finds the files and reads the cameras. `held_out`: n holds out every n-th photograph by name, unless the files say
   which to hold out; 0: none. Returns 0, or an error and a message. fxs_photo_list_free frees the list, which must not
   move in memory. */
int fxs_photo_list_find(fxs_photo_list *list, const char *path, uint32_t hold_out, fxs_message *message);
void fxs_photo_list_free(fxs_photo_list *list);

/* Keeps only the views with kept[i] != 0. */
void fxs_photo_list_keep(fxs_view_list *views, const uint8_t *kept);

/* Reports, for each folder of photographs to fit, the images without a camera. */
void fxs_photo_list_others(const fxs_photo_list *list, fxs_left_out_fn *say, void *argument);

/* Finds the path of a view's image; also tries missing file endings, and for absolute paths of another machine the
   folder of images. Returns 0, or an error and a message. */
int fxs_photo_list_image(const fxs_photo_list *list, const fxs_listed_view *view, char path[FXS_PHOTO_PATH],
                         fxs_message *message);

/* The path of a file that is named in the camera file. Returns 0, or an error and a message. */
int fxs_photo_list_path(const fxs_photo_list *list, const char *name, char path[FXS_PHOTO_PATH], fxs_message *message);

#endif
