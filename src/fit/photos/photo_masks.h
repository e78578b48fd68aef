/* Masks of photographs, which select the pixels that count in the fit. Functions return 0, or an error and a
 * message. */
#ifndef FXS_FIT_PHOTO_MASKS_H
#define FXS_FIT_PHOTO_MASKS_H

#include "photo_list.h"

typedef struct fxs_photo_masking {
    char path[FXS_PHOTO_PATH];     /* path of the mask image, or empty */
    int is_inverse;                /* 1: white pixels of the mask are ignored in the fit, instead of black ones */
    int ignores_transparent;       /* 1: pixels of the photograph with less than half opacity are ignored in the fit */
} fxs_photo_masking;

/* Smallest grey value of a mask pixel that counts as white. The grey value is (red + green + blue) times opacity, all
   in bytes. */
enum { FXS_PHOTO_MASK_WHITE = 3 * 128 * 255 };

static inline int fxs_photo_mask_grey(const uint8_t rgba[4])
{
    return (rgba[0] + rgba[1] + rgba[2]) * rgba[3];
}

/* Finds a photograph's mask in a folder, for a photograph a.jpg under the names a.jpg.png (as COLMAP) or a.png. Returns
   true if the mask exists. */
int fxs_photo_mask_in(const char *folder, const char *name, char path[FXS_PHOTO_PATH]);

/* Returns true if the options, the list of photographs or the camera file names masks. */
int fxs_photo_masks_are_there(const fxs_photo_list *list, const fxs_photos_options *options);

/* Fails if the options name a folder of masks that does not exist or has no mask for any photograph. */
int fxs_photo_masks_check(const fxs_photo_list *list, const fxs_photos_options *options, fxs_message *message);

int fxs_photo_mask_find(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_listed_view *view,
                        const char *image, fxs_photo_masking *masking, fxs_message *message);

/* Reads a photograph's mask. *counts: a byte per pixel, 1 if it counts, else 0, freed by the caller; null: all pixels
   count. With ignores_transparent, counted pixels of the photograph become opaque. Fails if the mask's size differs
   from the photograph's, or if it has grey and no white pixels. */
int fxs_photo_mask_read(const fxs_photo_masking *masking, const char *image, uint8_t *rgba, int width, int height,
                        uint8_t **counts, fxs_message *message);

#endif
