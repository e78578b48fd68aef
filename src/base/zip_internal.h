/* Reads and writes entries of a zip archive, by libzip. */
#ifndef FXS_ZIP_INTERNAL_H
#define FXS_ZIP_INTERNAL_H

#include "source_internal.h"
#include "output_internal.h"

typedef struct fxs_zip fxs_zip;

/* Returns 0 and an archive that fxs_zip_close frees, or an error and a message: FXS_ERR_FILE where the source, which
   must outlive the archive, is not a zip, FXS_ERR_UNSUPPORTED where fixsplat was built without libzip. *zip is then
   null. */
int fxs_zip_open(const fxs_scene_source *source, fxs_zip **zip, fxs_message *message);

/* Where there is no entry of that name but one in a folder, names for fxs_zip_load are in that folder: of several, in
   the one with the shortest path. Returns 0, or an error and a message. */
int fxs_zip_enter(fxs_zip *zip, const char *name, fxs_message *message);

/* Loads the entry of that name, stored or deflated, for fxs_text_let_go; text->path is the archive's. Returns 0, or an
   error and a message. */
int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message);

/* NULL is allowed. */
void fxs_zip_close(fxs_zip *zip);

typedef struct fxs_zip_entry {
    const char *name;
    void *data;
    size_t size;
} fxs_zip_entry;

/* Writes an archive of these entries, uncompressed and dated 1980, so that its bytes depend only on the entries. It is
   made in memory first. Returns 0 on success; errors stay in the output. */
int fxs_zip_write(fxs_output *output, const fxs_zip_entry *entries, uint32_t count, fxs_message *message);

#endif
