/* Entries of a zip archive, by libzip. */
#ifndef FXS_ZIP_INTERNAL_H
#define FXS_ZIP_INTERNAL_H

#include "text_internal.h"

struct zip;

/* Returns NULL and a message where the file is not a zip, or this was built without libzip. */
struct zip *fxs_zip_open(const char *path, fxs_message *message);

/* Loads the entry of that name, of at most `most` bytes; the caller frees text->data. text->path becomes `path`, the
   archive's. Returns 0, or -1 and a message. */
int fxs_zip_load(struct zip *zip, const char *path, const char *name, size_t most, fxs_text *text,
                 fxs_message *message);

/* NULL is allowed. */
void fxs_zip_close(struct zip *zip);

#endif
