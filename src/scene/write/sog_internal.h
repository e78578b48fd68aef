/* Makes the files of a .sog, for a zip or for folders. */
#ifndef FXS_SOG_INTERNAL_H
#define FXS_SOG_INTERNAL_H

#include "scene_write_internal.h"
#include "src/base/zip_internal.h"

enum { FXS_SOG_SIDE = 16383, FXS_SOG_FILES = 8 };

extern const char *const fxs_sog_names[FXS_SOG_FILES];

#define FXS_SOG_MOST ((uint32_t)FXS_SOG_SIDE / 4 * 4 * FXS_SOG_SIDE)

/* Gaussians of a .sog file in file order. WebP and the SH palette work better if neighbours follow each other. */
typedef struct fxs_sog_source {
    const fxs_held_gaussian **gaussians;
    const int16_t **sh;
    uint32_t count, coefficients;
    int antialiased;
} fxs_sog_source;

typedef struct fxs_sog fxs_sog;

/* Makes the files of a .sog in memory. Free the result with fxs_sog_free. *error becomes 0, ENOMEM, or ECANCELED. The
   result may be null after an error. */
fxs_sog *fxs_sog_make(const fxs_sog_source *from, const fxs_progress *progress, int *error);
uint32_t fxs_sog_files(const fxs_sog *sog, fxs_zip_entry files[FXS_SOG_FILES]);
void fxs_sog_free(fxs_sog *sog);

#endif
