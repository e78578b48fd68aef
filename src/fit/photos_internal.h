/* The parts of fxs_photos_read, for sets of which not every photograph is read. */
#ifndef FXS_FIT_PHOTOS_INTERNAL_H
#define FXS_FIT_PHOTOS_INTERNAL_H

#include "photo_list.h"

/* Reads the photographs of the list. Returns 0, or an error and a message; fxs_photos_free frees what was read. */
int fxs_photos_pixels(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message);

/* Reads the points, or makes random ones. Returns as above, also where all lie behind every camera to fit. */
int fxs_photos_points(const fxs_photo_list *list, const fxs_photos_options *options, fxs_photos *photos,
                      fxs_message *message);

#endif
