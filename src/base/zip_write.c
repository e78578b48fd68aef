#include "zip_internal.h"

#ifdef FXS_WITH_ZIP

#include <errno.h>
#include <zip.h>

enum { DATE_1980 = 1 << 5 | 1 };   /* DOS date of 1 January 1980 */

static int add_entries(zip_t *archive, const fxs_zip_entry *entries, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        zip_source_t *source = zip_source_buffer(archive, entries[i].data, entries[i].size, 0);
        const zip_int64_t index = source ? zip_file_add(archive, entries[i].name, source, ZIP_FL_ENC_UTF_8) : -1;
        if (source && index < 0)
            zip_source_free(source);
        if (index < 0 || zip_set_file_compression(archive, (zip_uint64_t)index, ZIP_CM_STORE, 0) ||
            zip_file_set_dostime(archive, (zip_uint64_t)index, 0, DATE_1980, 0))
            return -1;
    }
    return 0;
}

static int make(zip_source_t *made, const fxs_zip_entry *entries, uint32_t count)
{
    zip_source_keep(made);
    zip_t *archive = zip_open_from_source(made, ZIP_TRUNCATE, NULL);
    if (!archive) {
        zip_source_free(made);
        return -1;
    }
    if (!add_entries(archive, entries, count) && !zip_close(archive))
        return 0;
    zip_discard(archive);
    return -1;
}

static int copy(fxs_output *output, zip_source_t *made, fxs_message *message)
{
    char bytes[1 << 14];
    zip_int64_t size;
    if (zip_source_open(made))
        return -1;
    while ((size = zip_source_read(made, bytes, sizeof bytes)) > 0)
        if (fxs_output_write(output, bytes, (size_t)size, message))
            break;
    zip_source_close(made);
    return size ? -1 : 0;
}

int fxs_zip_write(fxs_output *output, const fxs_zip_entry *entries, uint32_t count, fxs_message *message)
{
    zip_source_t *made = zip_source_buffer_create(NULL, 0, 0, NULL);
    const int failed = !made || make(made, entries, count) || copy(output, made, message);
    if (failed && !output->error)
        output->error = ENOMEM;
    if (made)
        zip_source_free(made);
    return failed ? -1 : 0;
}

#endif
