#include "text_internal.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int fxs_text_load(const char *path, fxs_text *text, fxs_message *message)
{
    struct stat status;
    if (stat(path, &status))
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))   /* also keeps a pipe from being waited for */
        return fxs_fail(message, "%s: not a regular file", path);
    if ((uint64_t)status.st_size > FXS_TEXT_MAX)
        return fxs_fail(message, "%s: larger than %zu MiB", path, FXS_TEXT_MAX >> 20);
    size_t size = (size_t)status.st_size, got = 0;
    char *data = malloc(size + 1);
    if (!data)
        return fxs_fail(message, "%s: out of memory", path);
    FILE *file = fopen(path, "rb");
    if (file) {
        got = fread(data, 1, size, file);
        fclose(file);
    }
    if (!file || got < size) {
        free(data);
        return fxs_fail(message, "%s: %s", path, file ? "cannot be read whole" : strerror(errno));
    }
    data[size] = 0;
    *text = (fxs_text){path, data, size};
    return 0;
}

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

#define MAX_VALUES ((size_t)8 << 20)   /* cJSON takes about 100 bytes for each */

/* At least the number of values: each follows a comma or the bracket of its array or object. */
static size_t count_separators(const fxs_text *json)
{
    size_t count = 0;
    for (size_t i = 0; i < json->size; i++)
        count += json->data[i] == ',' || json->data[i] == '[' || json->data[i] == '{';
    return count;
}

cJSON *fxs_json_parse(const fxs_text *json, fxs_message *message)
{
    const char *end = json->data;
    if (count_separators(json) > MAX_VALUES) {
        fxs_fail(message, "%s: more than %zu values", json->path, MAX_VALUES);
        return NULL;
    }
    cJSON *root = cJSON_ParseWithLengthOpts(json->data, json->size + 1, &end, 1);
    if (!root)
        fxs_fail(message, "%s: bad JSON at byte %td", json->path, end - json->data);
    return root;
}

int fxs_json_numbers(const cJSON *array, double *out, int count)
{
    const cJSON *item;
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != count)
        return 0;
    cJSON_ArrayForEach(item, array) {
        if (!cJSON_IsNumber(item))
            return 0;
        *out++ = item->valuedouble;
    }
    return 1;
}

const char *fxs_json_string(const cJSON *object, const char *name)
{
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
}

#endif
