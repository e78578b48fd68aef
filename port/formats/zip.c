#include "zip_internal.h"

#ifdef FXS_WITH_ZIP

#include <stdlib.h>

#include <zip.h>

zip_t *fxs_zip_open(const char *path, fxs_message *message)
{
    int code;
    zip_error_t error;
    zip_t *zip = zip_open(path, ZIP_RDONLY, &code);
    if (!zip) {
        zip_error_init_with_code(&error, code);
        fxs_fail(message, "%s: cannot be read as a zip: %s", path, zip_error_strerror(&error));
        zip_error_fini(&error);
    }
    return zip;
}

/* The read past the last byte is what makes libzip compare the checksum. */
static int read_entry(zip_file_t *file, char *data, size_t size)
{
    return zip_fread(file, data, size) == (zip_int64_t)size && zip_fread(file, data + size, 1) == 0;
}

int fxs_zip_load(zip_t *zip, const char *path, const char *name, size_t most, fxs_text *text, fxs_message *message)
{
    zip_stat_t entry;
    if (zip_stat(zip, name, 0, &entry) != 0 || !(entry.valid & ZIP_STAT_SIZE))
        return fxs_fail(message, "%s: no %s in this zip", path, name);
    if (entry.size > most)
        return fxs_fail(message, "%s: %s claims %llu bytes, more than this file can hold", path, name,
                        (unsigned long long)entry.size);
    char *data = malloc((size_t)entry.size + 1);
    zip_file_t *file = data ? zip_fopen_index(zip, entry.index, 0) : NULL;
    int whole = file && read_entry(file, data, (size_t)entry.size) == 1;
    if (file)
        zip_fclose(file);
    if (!whole) {
        fxs_fail(message, "%s: %s: %s", path, name, data ? "damaged, or packed in an unknown way" : "out of memory");
        free(data);
        return -1;
    }
    data[entry.size] = 0;
    *text = (fxs_text){path, data, (size_t)entry.size};
    return 0;
}

void fxs_zip_close(zip_t *zip)
{
    if (zip)
        zip_discard(zip);
}

#else

struct zip *fxs_zip_open(const char *path, fxs_message *message)
{
    fxs_fail(message, "%s: cannot read a zip: built without libzip", path);
    return NULL;
}

int fxs_zip_load(struct zip *zip, const char *path, const char *name, size_t most, fxs_text *text,
                 fxs_message *message)
{
    (void)zip, (void)name, (void)most, (void)text;
    return fxs_fail(message, "%s: built without libzip", path);
}

void fxs_zip_close(struct zip *zip)
{
    (void)zip;
}

#endif
