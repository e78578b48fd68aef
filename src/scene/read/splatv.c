/* Reads .splatv of splaTV (antimatter15/splaTV at 8b313fe): a magic number, the length of a JSON text, the text, then
 * the data of its chunks. A chunk of type "splat" has a record of 64 bytes for each Gaussian. Times are 0 to 1. */
#include "src/base/byte_reader.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

#define MAGIC 0x674bu

enum { HEAD = 8 };

static int is_splatv(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->size >= HEAD + 2 && fxs_load_u32((const uint8_t *)head->bytes) == MAGIC &&
           (head->bytes[HEAD] == '[' || head->bytes[HEAD] == ' ');
}

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>

#include "src/base/text_internal.h"

enum { RECORD = 64, BATCH = 4096, ROTATION = 12, SCALE = 20, COLOUR = 28, MOTION = 32, TURN = 52, TIME = 60 };

#define LEAST 0.02      /* splaTV skips a Gaussian below this share of its opacity */

typedef struct splatv_reader {
    uint64_t at, count, read;
    fxs_byte_reader bytes;
    fxs_motion motions[BATCH];
} splatv_reader;

/* Finds the chunk of Gaussians; chunks of other types before it are skipped. */
static int find_chunk(splatv_reader *r, const fxs_scene_source *source, const cJSON *list, uint64_t at,
                      fxs_message *message)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, list) {
        const char *type = fxs_json_string(item, "type");
        size_t size;
        if (!type || !fxs_json_whole(cJSON_GetObjectItemCaseSensitive(item, "size"), SIZE_MAX / 4, &size) ||
            size > source->input.size - at)
            return fxs_fail(message, "%s: a chunk has no valid \"type\" and \"size\", or the file ends early",
                            source->path);
        if (!strcmp(type, "splat")) {
            if (size % RECORD)
                return fxs_fail(message, "%s: %zu bytes of Gaussians, no multiple of %d", source->path, size, RECORD);
            r->at = at;
            r->count = size / RECORD;
            return 0;
        }
        at += size;
    }
    return fxs_fail(message, "%s: no chunk of type \"splat\"", source->path);
}

static int splatv_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    splatv_reader *r = handle;
    uint8_t head[HEAD];
    fxs_text json;
    cJSON *root = NULL;
    r->bytes.source = source;
    FXS_TRY(fxs_scene_source_read(source, 0, head, HEAD, message));
    const uint64_t length = fxs_load_u32(head + 4);
    if (length > source->input.size - HEAD)
        return fxs_fail(message, "%s: the file ends early", source->path);
    FXS_TRY(fxs_scene_source_load(source, HEAD, length, &json, message));
    int error = fxs_json_parse(&json, source, &root, message);
    fxs_text_let_go(source, &json);
    error = error ? error : find_chunk(r, source, root, HEAD + length, message);
    cJSON_Delete(root);
    info->count = r->count;
    info->sh_degree = info->antialiased = 0;
    info->colour.step = 1 / 255.0;
    info->time = (fxs_time){.duration = 1, .loops = 1, .degree = 3, .turns = 1, .fades = 1, .least = LEAST};
    return error ? error : fxs_bytes_seek(&r->bytes, r->at);
}

static float half_at(const uint8_t *record, int at)
{
    return fxs_half(fxs_load_u16(record + at));
}

static void decode(const uint8_t *record, fxs_gaussian *g, fxs_motion *m)
{
    static const uint8_t empty[RECORD];
    for (int i = 0; i < 3; i++) {
        g->position[i] = fxs_load_float(record + 4 * i);
        g->scale[i] = fxs_log_scale((double)half_at(record, SCALE + 2 * i));
        g->dc[i] = fxs_dc_of_colour(record[COLOUR + i] / 255.0);
    }
    g->opacity = record[COLOUR + 3] ? fxs_logit_of_code(record[COLOUR + 3]) : -INFINITY;
    for (int i = 0; i < 9; i++)
        m->drift[i / 3][i % 3] = half_at(record, MOTION + 2 * i);
    for (int i = 0; i < 4; i++) {
        g->rotation[i] = half_at(record, ROTATION + 2 * i);
        m->turn[i] = half_at(record, TURN + 2 * i);
    }
    if (!memcmp(record, empty, RECORD))     /* the texture's last row has room for more Gaussians */
        g->rotation[0] = 1;
    m->centre = half_at(record, TIME);
    m->fade = half_at(record, TIME + 2);
    m->fade = m->fade > 0 || !memcmp(record, empty, RECORD) ? fmaxf(m->fade, 1e-6f) : NAN;
    m->from = -INFINITY;
    m->to = INFINITY;
}

static long splatv_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    splatv_reader *r = handle;
    const uint64_t left = r->count - r->read;
    long count = (long)(capacity < left ? capacity : left);
    count = count < BATCH ? count : BATCH;
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++, r->read++) {
        const uint8_t *record = fxs_bytes_take(&r->bytes, RECORD);
        if (!record)
            return fxs_bytes_fail_row(&r->bytes, "Gaussian", r->read, r->count, message);
        decode(record, &gaussians[i], &r->motions[i]);
    }
    return count;
}

static int splatv_rewind(void *handle, fxs_message *message)
{
    splatv_reader *r = handle;
    (void)message;
    r->read = 0;
    return fxs_bytes_seek(&r->bytes, r->at);
}

static const fxs_motion *splatv_motions(const void *handle)
{
    return ((const splatv_reader *)handle)->motions;
}

const fxs_reader fxs_read_splatv = {
    is_splatv, sizeof(splatv_reader), splatv_open, splatv_read, splatv_rewind, NULL, splatv_motions
};

#else

static int splatv_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle, (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read .splatv: built without cJSON", source->path);
}

const fxs_reader fxs_read_splatv = {is_splatv, 0, splatv_open, NULL, NULL, NULL, NULL};

#endif
