/* The list of photographs, with the paths of their images and of the points, which are read later. */
#ifndef FXS_FIT_PHOTO_LIST_H
#define FXS_FIT_PHOTO_LIST_H

#include <fixsplat/photos.h>
#include "src/camera/camera_internal.h"

enum { FXS_PHOTO_PATH = FXS_CAMERA_PATH };

typedef struct fxs_photo_list {
    char cameras[FXS_PHOTO_PATH];  /* the file of the cameras */
    char test[FXS_PHOTO_PATH];     /* the cameras file of held-out photographs, or empty */
    char images[FXS_PHOTO_PATH];   /* the folder to which image names are relative */
    char masks[FXS_PHOTO_PATH];    /* the folder of masks beside them, or empty */
    char points[FXS_PHOTO_PATH];   /* the file of the points, or empty; in the format of the cameras, or a .ply */
    fxs_view_list fit, held_out;   /* sorted by name */
    fxs_view_list rest;            /* those that the file says are neither */
} fxs_photo_list;

/* `held_out`: 0, or n to hold out every n-th photograph by name, unless the files state which. Returns 0 and a list for
   fxs_photo_list_free, or an error and a message. `list` must not be moved in memory. */
int fxs_photo_list_find(fxs_photo_list *list, const char *path, uint32_t hold_out, fxs_message *message);
void fxs_photo_list_free(fxs_photo_list *list);

/* Keeps of the views of one list those that are not marked 0. */
void fxs_photo_list_keep(fxs_view_list *views, const uint8_t *kept);

/* Says for each folder of the photographs to fit which others lie in it, that have no camera. */
void fxs_photo_list_others(const fxs_photo_list *list, fxs_left_out_fn *say, void *argument);

/* Finds the path of a view's image, also with the endings that its name may lack; a path of another machine in the
   folder of images. Returns 0, or an error and a message. */
int fxs_photo_list_image(const fxs_photo_list *list, const fxs_listed_view *view, char path[FXS_PHOTO_PATH],
                         fxs_message *message);

/* The path of a file that the file of the cameras names. Returns 0, or an error and a message. */
int fxs_photo_list_path(const fxs_photo_list *list, const char *name, char path[FXS_PHOTO_PATH], fxs_message *message);

#endif
