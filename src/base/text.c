#include "text_internal.h"

#include <string.h>

#include "source_internal.h"

int fxs_text_load(const char *path, fxs_text *text, fxs_message *message)
{
    fxs_scene_source source;
    memset(&source, 0, sizeof source);
    int result = fxs_scene_source_open(&source, path, message);
    if (result == 0)
        result = fxs_scene_source_load(&source, 0, source.input.size, text, message);
    text->path = path;
    fxs_scene_source_close(&source);
    return result;
}

char *fxs_text_begin(const fxs_text *text)
{
    return text->data + (strncmp(text->data, FXS_UTF8_MARK, strlen(FXS_UTF8_MARK)) ? 0 : strlen(FXS_UTF8_MARK));
}

#ifdef FXS_WITH_CJSON

#include <errno.h>
#include <math.h>

#include <cjson/cJSON.h>

#include "fail_list.h"

#define MAX_VALUES ((size_t)8 << 20)
#define VALUE_BYTES 144                /* memory of cJSON for a JSON value in bytes, without strings */

static size_t count_separators(const fxs_text *json)
{
    size_t count = 0;
    for (size_t i = 0; i < json->size; i++)
        count += json->data[i] == ',' || json->data[i] == '[' || json->data[i] == '{';
    return count;
}

int fxs_json_parse(const fxs_text *json, const fxs_scene_source *source, cJSON **root, fxs_message *message)
{
    const char *end = json->data;
    const size_t values = count_separators(json);
    *root = NULL;
    if (values > MAX_VALUES)
        return fxs_fail(message, "%s: more than %zu values", json->path, MAX_VALUES);
    if (source)
        FXS_TRY(fxs_limit_memory(source, (uint64_t)values * VALUE_BYTES + json->size, message));
    errno = 0;
    *root = cJSON_ParseWithLengthOpts(json->data, json->size + 1, &end, 1);
    return *root ? 0 : fxs_fail_library(message, json->path, "%s: bad JSON at byte %td", json->path, end - json->data);
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

int fxs_json_whole(const cJSON *item, size_t most, size_t *out)
{
    const double value = cJSON_IsNumber(item) ? item->valuedouble : -1;
    if (!(value >= 0 && value <= (double)most && value == floor(value)))
        return 0;
    *out = (size_t)value;
    return 1;
}

const char *fxs_json_string(const cJSON *object, const char *name)
{
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
}

#endif
