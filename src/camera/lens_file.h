/* Reads camera files together with their lens distortion. */
#ifndef FXS_LENS_FILE_H
#define FXS_LENS_FILE_H

#include "lens.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the views (cameras) of a file and their lenses; the caller frees both arrays. With `width` above 0, views are
   resized to this size. A file without sizes takes this size for its photographs. */
long fxs_lens_file_read(const char *path, int width, int height, fxs_view **views, fxs_lens **lenses,
                        fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
