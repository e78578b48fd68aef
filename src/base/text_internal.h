/* Loads whole files into memory, and parses JSON. */
#ifndef FXS_TEXT_INTERNAL_H
#define FXS_TEXT_INTERNAL_H

#include <stddef.h>

#include <fixsplat/internal/message.h>
#include "try_internal.h"

#define FXS_TEXT_MAX ((size_t)1 << 30)
#define FXS_UTF8_MARK "\xef\xbb\xbf"   /* a text may begin with this mark */

/* The bytes of a file, followed by a zero byte. */
typedef struct fxs_text {
    const char *path;   /* for messages */
    char *data;
    size_t size;        /* without the zero byte */
} fxs_text;

/* Loads a regular file. The caller frees text->data. Returns 0, or an error and a message. */
int fxs_text_load(const char *path, fxs_text *text, fxs_message *message);

/* The text after an optional UTF-8 mark. */
char *fxs_text_begin(const fxs_text *text);

/* ---- With cJSON (FXS_WITH_CJSON) ---- */

struct cJSON;

struct fxs_scene_source;

/* Parses JSON within the memory limit of `source` (NULL: no limit). Returns 0, or an error and a message. Free *root
   with cJSON_Delete; it is null after an error. */
int fxs_json_parse(const fxs_text *json, const struct fxs_scene_source *source, struct cJSON **root,
                   fxs_message *message);

/* Reads an array of exactly `count` numbers. Returns 1, else 0. */
int fxs_json_numbers(const struct cJSON *array, double *out, int count);

/* Reads a whole number, 0 to `most`, that a double represents exactly. Returns 1, else 0, also for a null item. */
int fxs_json_whole(const struct cJSON *item, size_t most, size_t *out);

/* The string of this name, or NULL. */
const char *fxs_json_string(const struct cJSON *object, const char *name);

#endif
