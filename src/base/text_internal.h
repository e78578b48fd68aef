/* Loads whole files and parses JSON. Functions with a message return 0, or an error and the message. */
#ifndef FXS_TEXT_INTERNAL_H
#define FXS_TEXT_INTERNAL_H

#include <stddef.h>

#include <fixsplat/internal/message.h>
#include "try_internal.h"

#define FXS_TEXT_MAX ((size_t)1 << 30)
#define FXS_UTF8_MARK "\xef\xbb\xbf"

typedef struct fxs_text {
    const char *path;
    char *data;
    size_t size;        /* size in bytes, without the final zero byte */
} fxs_text;

/* Loads a regular file as a text. The caller frees text->data. */
int fxs_text_load(const char *path, fxs_text *text, fxs_message *message);

/* Returns the start of a text, after the optional UTF-8 byte order mark. */
char *fxs_text_begin(const fxs_text *text);

/* ---- JSON, in builds with FXS_WITH_CJSON ---- */

struct cJSON;

struct fxs_scene_source;

/* Parses JSON within the memory limit of `source`; `source` null: no limit. Free *root with cJSON_Delete. */
int fxs_json_parse(const fxs_text *json, const struct fxs_scene_source *source, struct cJSON **root,
                   fxs_message *message);

/* Reads exactly `count` numbers from a JSON array. Returns 1, or 0 for anything else. */
int fxs_json_numbers(const struct cJSON *array, double *out, int count);

/* Reads a whole number from 0 to `most` from a JSON item. Returns 1, or 0 for anything else. */
int fxs_json_whole(const struct cJSON *item, size_t most, size_t *out);

const char *fxs_json_string(const struct cJSON *object, const char *name);

#endif
