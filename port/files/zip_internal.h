/* Entries of a zip archive, by libzip. */
#ifndef FXS_ZIP_INTERNAL_H
#define FXS_ZIP_INTERNAL_H

#include "../scene/source_internal.h"

typedef struct fxs_zip fxs_zip;

/* The source must outlive it. Returns NULL and a message where that is not a zip, or this was built without libzip. */
fxs_zip *fxs_zip_open(const fxs_scene_source *source, fxs_message *message);

/* Loads the entry of that name, stored or deflated, for fxs_text_let_go; text->path is the archive's. Returns 0, or -1
   and a message. */
int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message);

/* NULL is allowed. */
void fxs_zip_close(fxs_zip *zip);

#endif
