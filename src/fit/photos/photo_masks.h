/* Masks of photographs, which tell the pixels that count in the fit. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_PHOTO_MASKS_H
#define FXS_FIT_PHOTO_MASKS_H

#include "photo_list.h"

typedef struct fxs_photo_masking {
    char path[FXS_PHOTO_PATH];     /* path of the mask file, or empty */
    int is_inverse;                /* 1: white pixels are ignored */
    int ignores_transparent;       /* 1: pixels with less than half opacity are ignored */
} fxs_photo_masking;

/* Smallest grey of a white mask pixel. Grey is red + green + blue, times opacity. */
enum { FXS_PHOTO_MASK_WHITE = 3 * 128 * 255 };

static inline int fxs_photo_mask_grey(const uint8_t rgba[4])
{
    return (rgba[0] + rgba[1] + rgba[2]) * rgba[3];
}

/* Finds a photograph's mask in a folder: a.jpg.png (as COLMAP) or a.png. Returns true if the mask exists. */
int fxs_photo_mask_in(const char *folder, const char *name, char path[FXS_PHOTO_PATH]);

/* True if the options, the list or the camera file name masks. */
int fxs_photo_masks_are_there(const fxs_photo_list *list, const fxs_photos_options *options);

/* Fails if the options' folder does not exist or has no mask of any photograph. */
int fxs_photo_masks_check(const fxs_photo_list *list, const fxs_photos_options *options, fxs_message *message);

int fxs_photo_mask_find(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_listed_view *view,
                        const char *image, fxs_photo_masking *masking, fxs_message *message);

/* Reads a mask. *counts: a byte per pixel, 0 or 1, freed by the caller; null: all pixels count. With
   ignores_transparent, counted pixels become opaque. Fails if the mask differs in size or is grey without any white. */
int fxs_photo_mask_read(const fxs_photo_masking *masking, const char *image, uint8_t *rgba, int width, int height,
                        uint8_t **counts, fxs_message *message);

#endif
