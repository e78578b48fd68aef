/* Camera files with their lenses. */
#ifndef FXS_LENS_FILE_H
#define FXS_LENS_FILE_H

#include "lens.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As fxs_camera_file_read, and also returns the lens of each view in an array that the caller frees. width above 0:
   views get this size by fxs_view_resize, or, if the file states no size, width and height are taken as the size of the
   photographs. */
long fxs_lens_file_read(const char *path, int width, int height, fxs_file_view **views, fxs_lens **lenses,
                        fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
