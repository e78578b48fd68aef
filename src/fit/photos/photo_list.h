/* The list of photographs of a set with their cameras, and the paths of images, masks and points. Functions return 0,
 * or an error and a message. */
#ifndef FXS_FIT_PHOTO_LIST_H
#define FXS_FIT_PHOTO_LIST_H

#include <fixsplat/fit.h>
#include "src/camera/camera_internal.h"

enum { FXS_PHOTO_PATH = FXS_CAMERA_PATH };

typedef struct fxs_photo_list {
    char cameras[FXS_PHOTO_PATH];
    char test[FXS_PHOTO_PATH];     /* path of the camera file of held-out photographs, or empty */
    char images[FXS_PHOTO_PATH];
    char masks[FXS_PHOTO_PATH];    /* path of the folder of masks, or empty */
    char points[FXS_PHOTO_PATH];   /* path of the initial points, a .ply or in the cameras' format; empty: no points */
    fxs_view_list fit, held_out;   /* photographs to fit and held-out ones, sorted by name */
    fxs_view_list rest;            /* photographs that the camera file excludes from fitting and testing */
} fxs_photo_list;

/* Finds the files of a set of photographs and reads the cameras. hold_out n holds out every n-th photograph by name,
   unless the files mark photographs for testing; 0: none. fxs_photo_list_free frees the list, which must not move in
   memory. */
int fxs_photo_list_find(fxs_photo_list *list, const char *path, uint32_t hold_out, fxs_message *message);
void fxs_photo_list_free(fxs_photo_list *list);

void fxs_photo_list_keep(fxs_view_list *views, const uint8_t *kept);

/* Reports the images that have no camera, for each folder of photographs. */
void fxs_photo_list_others(const fxs_photo_list *list, fxs_left_out_fn *say, void *argument);

/* Finds the path of a photograph's image file, also with other file name endings. */
int fxs_photo_list_image(const fxs_photo_list *list, const fxs_listed_view *view, char path[FXS_PHOTO_PATH],
                         fxs_message *message);

int fxs_photo_list_path(const fxs_photo_list *list, const char *name, char path[FXS_PHOTO_PATH], fxs_message *message);

#endif
