/* Camera files, with what they say of lenses. */
#ifndef FXS_LENS_FILE_H
#define FXS_LENS_FILE_H

#include "lens.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As fxs_camera_file_read, with the lens of each view in an array beside, which the caller frees as well. Where `width`
   is not 0, the views get that size: by fxs_view_resize, or where the file states no size as that of the photograph. */
long fxs_lens_file_read(const char *path, int width, int height, fxs_file_view **views, fxs_lens **lenses,
                        fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
