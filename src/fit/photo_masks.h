/* The masks of photographs: which pixels count. */
#ifndef FXS_FIT_PHOTO_MASKS_H
#define FXS_FIT_PHOTO_MASKS_H

#include "photo_list.h"

/* What says which pixels of a photograph count. */
typedef struct fxs_photo_masking {
    char path[FXS_PHOTO_PATH];     /* the file of its mask, or empty */
    int is_inverse;                /* 1: what is white is ignored */
    int ignores_transparent;       /* 1: what is less than half opaque is ignored */
} fxs_photo_masking;

/* The grey of a mask's pixel, times 3 * 255: the mean of red, green and blue, and black where it is transparent. White
   is half of the most, or more. */
enum { FXS_PHOTO_MASK_WHITE = 3 * 128 * 255 };

static inline int fxs_photo_mask_grey(const uint8_t rgba[4])
{
    return (rgba[0] + rgba[1] + rgba[2]) * rgba[3];
}

/* Finds the mask of a photograph in a folder of masks, of COLMAP's name or with the photograph's own: a.jpg.png, a.png.
   `name` is that of the photograph in its own folder. Returns whether there is one. */
int fxs_photo_mask_in(const char *folder, const char *name, char path[FXS_PHOTO_PATH]);

/* Whether the set has masks, as the options say: a folder, or names in the file of the cameras. */
int fxs_photo_masks_are_there(const fxs_photo_list *list, const fxs_photos_options *options);

/* Before a photograph is read. Returns FXS_ERR_FILE and a message where the options' folder is none, or has no mask of
   any photograph in the list. */
int fxs_photo_masks_check(const fxs_photo_list *list, const fxs_photos_options *options, fxs_message *message);

/* Sets what the options say for a photograph whose image lies at `image`. Returns 0, or an error and a message. */
int fxs_photo_mask_find(const fxs_photo_list *list, const fxs_photos_options *options, const fxs_listed_view *view,
                        const char *image, fxs_photo_masking *masking, fxs_message *message);

/* Reads which pixels of a photograph count: *counts has a byte for each, 0 or 1, for free(); null: all do. `image` is
   the photograph's path, for messages. With ignores_transparent, the pixels that are not transparent become opaque.
   Returns 0, or an error and a message: FXS_ERR_FILE where the mask cannot be read, is of another size, or has neither
   white nor only black. */
int fxs_photo_mask_read(const fxs_photo_masking *masking, const char *image, uint8_t *rgba, int width, int height,
                        uint8_t **counts, fxs_message *message);

#endif
