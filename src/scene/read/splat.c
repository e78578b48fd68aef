/* Reads .splat of antimatter15/splat: records of 32 bytes, without a header. */
#include "src/base/byte_reader.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

enum { RECORD_SIZE = 32, SCALE = 12, COLOUR = 24, ROTATION = 28, RECORDS_CHECKED = 64 };

/* Limits of plausible Gaussians, which tell a .splat from other data. Zeros and most text exceed these limits. */
static const float largest_position = 134217728.0f, smallest_scale = 2.06e-9f, largest_scale = 4.85e8f;

typedef struct splat_reader {
    uint64_t count, read;
    fxs_byte_reader bytes;
} splat_reader;

static int has_scale(const uint8_t *record)
{
    for (int i = 0; i < 3; i++)
        if (fabsf(fxs_load_float(record + SCALE + 4 * i)) >= smallest_scale)
            return 1;
    return 0;
}

static int is_plausible(const uint8_t *record)
{
    for (int i = 0; i < 3; i++) {
        float position = fxs_load_float(record + 4 * i), scale = fxs_load_float(record + SCALE + 4 * i);
        if (!(fabsf(position) <= largest_position && fabsf(scale) <= largest_scale))
            return 0;
    }
    return 1;
}

/* Recognises a .splat by plausible first Gaussians, because the format has no magic number. */
static int is_splat(const fxs_head *head, fxs_message *message)
{
    const fxs_scene_source *source = head->source;
    uint8_t records[RECORDS_CHECKED * RECORD_SIZE];
    int any_scale = 0;
    (void)message;
    fxs_message ignored;
    uint64_t count = source->input.size / RECORD_SIZE;
    count = count < RECORDS_CHECKED ? count : RECORDS_CHECKED;
    if (source->input.size % RECORD_SIZE != 0
        || fxs_scene_source_read(source, 0, records, (size_t)count * RECORD_SIZE, &ignored) != 0)
        return 0;
    for (size_t i = 0; i < count; i++) {
        if (!is_plausible(records + i * RECORD_SIZE))
            return 0;
        any_scale |= has_scale(records + i * RECORD_SIZE);
    }
    return any_scale;
}

static int splat_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    splat_reader *reader = handle;
    (void)message;
    reader->bytes.source = source;
    reader->count = info->count = source->input.size / RECORD_SIZE;
    info->sh_degree = info->antialiased = 0;
    info->colour.step = 1 / 255.0;
    return 0;
}

static void decode(const uint8_t *record, fxs_gaussian *gaussian)
{
    for (int i = 0; i < 3; i++) {
        gaussian->position[i] = fxs_load_float(record + 4 * i);
        gaussian->scale[i] = fxs_log_scale((double)fxs_load_float(record + SCALE + 4 * i));
        gaussian->dc[i] = fxs_dc_of_colour(record[COLOUR + i] / 255.0);
    }
    gaussian->opacity = fxs_logit_of_code(record[COLOUR + 3]);
    for (int i = 0; i < 4; i++)
        gaussian->rotation[i] = (float)(record[ROTATION + i] - 128) / 128;
}

static long splat_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    splat_reader *reader = handle;
    uint64_t left = reader->count - reader->read;
    long count = (long)(capacity < left ? capacity : left);
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++, reader->read++) {
        const uint8_t *record = fxs_bytes_take(&reader->bytes, RECORD_SIZE);
        if (!record)
            return fxs_bytes_fail_row(&reader->bytes, "Gaussian", reader->read, reader->count, message);
        decode(record, &gaussians[i]);
    }
    return count;
}

static int splat_rewind(void *handle, fxs_message *message)
{
    splat_reader *reader = handle;
    (void)message;
    reader->read = 0;
    return fxs_bytes_seek(&reader->bytes, 0);
}

const fxs_reader fxs_read_splat = {
    is_splat, sizeof(splat_reader), splat_open, splat_read, splat_rewind, NULL, NULL
};
