/* Parts of fxs_photos_read, for callers that read only some photographs of a set. Functions return 0, or an error and a
 * message. */
#ifndef FXS_FIT_PHOTOS_INTERNAL_H
#define FXS_FIT_PHOTOS_INTERNAL_H

#include "photo_list.h"

/* Reads the pixels of all photographs of the list. After an error, fxs_photos_free frees the photographs already
   read. */
int fxs_photos_pixels(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message);

/* Reads the initial points of a fit, or makes random ones. Fails if all points are behind all cameras. */
int fxs_photos_points(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message);

#endif
