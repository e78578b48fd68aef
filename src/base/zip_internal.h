/* Reads and writes zip archives with libzip. */
#ifndef FXS_ZIP_INTERNAL_H
#define FXS_ZIP_INTERNAL_H

#include "source_internal.h"
#include "output_internal.h"

typedef struct fxs_zip fxs_zip;

/* Opens a zip archive; `source` must stay open for as long. Returns 0, or an error and a message. The error is
   FXS_ERR_UNSUPPORTED in a build without libzip. */
int fxs_zip_open(const fxs_scene_source *source, fxs_zip **zip, fxs_message *message);

/* Finds the folder in the archive with the file `name`. Later names are relative to that folder, or to the top level if
   it contains `name`. Returns 0, or an error and a message. */
int fxs_zip_enter(fxs_zip *zip, const char *name, fxs_message *message);

/* Loads a zip entry. Free the text with fxs_text_let_go. Returns 0, or an error and a message. */
int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message);

void fxs_zip_close(fxs_zip *zip);

typedef struct fxs_zip_entry {
    const char *name;
    void *data;
    size_t size;
} fxs_zip_entry;

/* Writes a zip archive, uncompressed and with all entries dated 1980, so that its bytes depend only on the entries. */
int fxs_zip_write(fxs_output *output, const fxs_zip_entry *entries, uint32_t count, fxs_message *message);

#endif
