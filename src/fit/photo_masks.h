/* The masks of photographs: which pixels count in the fit. */
#ifndef FXS_FIT_PHOTO_MASKS_H
#define FXS_FIT_PHOTO_MASKS_H

#include "photo_list.h"

/* The sources of a photograph's mask. */
typedef struct fxs_photo_masking {
    char path[FXS_PHOTO_PATH];     /* mask file, or empty */
    int is_inverse;                /* 1: white is ignored */
    int ignores_transparent;       /* 1: pixels with less than half opacity are ignored */
} fxs_photo_masking;

/* A mask pixel's grey, times 3 * 255: the mean of red, green and blue times opacity. White: at least about half of the
   maximum. */
enum { FXS_PHOTO_MASK_WHITE = 3 * 128 * 255 };

static inline int fxs_photo_mask_grey(const uint8_t rgba[4])
{
    return (rgba[0] + rgba[1] + rgba[2]) * rgba[3];
}

/* Finds a photograph's mask in a folder: a.jpg.png (as COLMAP), or a.png. `name`: the photograph's name in its own
   folder. Returns whether the mask exists. */
int fxs_photo_mask_in(const char *folder, const char *name, char path[FXS_PHOTO_PATH]);

/* True if the set has masks: the options or the list name a folder of masks, or the camera file names masks. */
int fxs_photo_masks_are_there(const fxs_photo_list *list, const fxs_photos_options *options);

/* Checks masks before any photograph is read. Returns FXS_ERR_FILE and a message if the options' folder does not exist
   or has no mask for any photograph of the list. */
int fxs_photo_masks_check(const fxs_photo_list *list, const fxs_photos_options *options, fxs_message *message);

/* Finds the sources of the mask for the photograph at path `image`. Returns 0, or an error and a message. */
int fxs_photo_mask_find(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_listed_view *view,
                        const char *image, fxs_photo_masking *masking, fxs_message *message);

/* Reads which pixels of a photograph count. *counts: one byte per pixel, 0 or 1, to be freed with free(); null: all
   count. `image`: the photograph's path, for messages. With ignores_transparent, counted pixels become opaque. Returns
   0, or an error and a message: FXS_ERR_FILE if the mask cannot be read, has another size, or has no white but is not
   all black. */
int fxs_photo_mask_read(const fxs_photo_masking *masking, const char *image, uint8_t *rgba, int width, int height,
                        uint8_t **counts, fxs_message *message);

#endif
