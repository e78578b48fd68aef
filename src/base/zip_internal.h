/* Reads and writes zip archives with libzip. */
#ifndef FXS_ZIP_INTERNAL_H
#define FXS_ZIP_INTERNAL_H

#include "source_internal.h"
#include "output_internal.h"

typedef struct fxs_zip fxs_zip;

/* Opens an archive; `source` must outlive it. Free it with fxs_zip_close. Returns 0, or an error, a message and a
   null *zip: FXS_ERR_FILE if the source is not a zip, FXS_ERR_UNSUPPORTED if fixsplat was built without libzip. */
int fxs_zip_open(const fxs_scene_source *source, fxs_zip **zip, fxs_message *message);

/* If the archive has no entry `name` at its top but has one in a folder, later names are relative to that folder; of
   several folders, the one with the shortest path. Returns 0, or an error and a message. */
int fxs_zip_enter(fxs_zip *zip, const char *name, fxs_message *message);

/* Loads an entry, stored or deflated; free it with fxs_text_let_go. text->path is the archive's path. Returns 0, or
   an error and a message. */
int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message);

/* Accepts NULL. */
void fxs_zip_close(fxs_zip *zip);

typedef struct fxs_zip_entry {
    const char *name;
    void *data;
    size_t size;
} fxs_zip_entry;

/* Writes an archive of uncompressed entries, dated 1980, so that its bytes depend only on the entries. Builds it in
   memory first. Returns 0; errors stay in the output. */
int fxs_zip_write(fxs_output *output, const fxs_zip_entry *entries, uint32_t count, fxs_message *message);

#endif
