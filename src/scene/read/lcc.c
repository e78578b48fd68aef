/* Reads .lcc of XGRIDS: a JSON file with index.bin, data.bin, shcoef.bin and optionally environment.bin. index.bin
   lists the Gaussians of each cell and level. Layout: XGRIDS, "LCC Data Organization Format White Paper"
   (https://github.com/xgrids/LCCWhitepaper; Data Organization Format originated from XGRIDS). Axes and the SH of
   files without "fileType" follow PlayCanvas's splat-transform. */
#include <string.h>

#include "src/scene/formats_internal.h"

#ifdef FXS_WITH_CJSON

#include <math.h>
#include <stdlib.h>

#include <cjson/cJSON.h>

#include "src/base/byte_reader.h"
#include "src/gaussian/attributes.h"
#include "src/gaussian/transform_internal.h"

enum {
    MAX_LEVELS = 1000,
    LEVEL_SIZE = 16,
    ROW = 32, SH_ROW = 64
};

/* Bounds of a coded attribute: the values of the smallest and the largest code of three channels. */
typedef struct bounds {
    double low[3], high[3];
} bounds;

/* A cell of the scene at one level: first byte in data.bin, and number of Gaussians. */
typedef struct cell {
    uint64_t begin, count;
} cell;

typedef struct lcc_reader {
    const fxs_scene_source *source;
    size_t levels;
    int has_sh;
    bounds scale[2], sh[2];
    cell *cells;
    size_t cell_room, cell_count, environment;
    fxs_scene_source data_file, sh_file, environment_file;
    fxs_byte_reader rows, sh_rows;
    fxs_transform transform;
    size_t at;
    uint64_t done;
} lcc_reader;

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const cJSON *find_attribute(const cJSON *root, const char *name)
{
    const cJSON *attribute;
    cJSON_ArrayForEach(attribute, member(root, "attributes")) {
        const char *own = fxs_json_string(attribute, "name");
        if (own && strcmp(own, name) == 0)
            return attribute;
    }
    return NULL;
}

static int read_bounds(const cJSON *root, const char *name, const char *environment_name, bounds out[2])
{
    const cJSON *own = find_attribute(root, name), *environment = find_attribute(root, environment_name);
    const cJSON *const attributes[2] = {own, environment ? environment : own};
    for (int i = 0; i < 2; i++)
        if (!fxs_json_numbers(member(attributes[i], "min"), out[i].low, 3) ||
            !fxs_json_numbers(member(attributes[i], "max"), out[i].high, 3))
            return 0;
    return 1;
}

static const char *read_meta(lcc_reader *r, const cJSON *root)
{
    const cJSON *levels = member(root, "totalLevel");
    const char *type = fxs_json_string(root, "fileType"), *encoding = fxs_json_string(root, "encoding");
    const double count = cJSON_IsNumber(levels) ? levels->valuedouble : 0;
    if (!(count >= 1 && count <= MAX_LEVELS && count == floor(count)))
        return "no valid \"totalLevel\"";
    if (encoding && strcmp(encoding, "COMPRESS") != 0)
        return "an \"encoding\" that is not known: not COMPRESS";
    r->levels = (size_t)count;
    r->has_sh = type && strcmp(type, "Quality") == 0;
    if (!type || (!r->has_sh && strcmp(type, "Portable") != 0))
        r->has_sh = find_attribute(root, "shcoef") != NULL;
    if (!read_bounds(root, "scale", "envscale", r->scale))
        return "no valid \"min\" and \"max\" of \"scale\"";
    if (r->has_sh && !read_bounds(root, "shcoef", "envshcoef", r->sh))
        return "no valid \"min\" and \"max\" of \"shcoef\"";
    return NULL;
}

static int load_meta(lcc_reader *r, fxs_message *message)
{
    const fxs_scene_source *source = r->source;
    fxs_text json;
    cJSON *root;
    FXS_TRY(fxs_scene_source_load(source, 0, source->input.size, &json, message));
    int result = fxs_json_parse(&json, source, &root, message);
    fxs_text_let_go(source, &json);
    const char *fault = root ? read_meta(r, root) : NULL;
    if (fault)
        result = fxs_fail(message, "%s: %s", source->path, fault);
    cJSON_Delete(root);
    return result;
}

static int open_beside(const lcc_reader *r, fxs_scene_source *file, const char *name, const char *other,
                       int may_be_absent, fxs_message *message)
{
    const int is_there = fxs_scene_source_is_beside(r->source, name, message);
    FXS_TRY(is_there);
    const int other_is_there = is_there ? 0 : fxs_scene_source_is_beside(r->source, other, message);
    FXS_TRY(other_is_there);
    if (may_be_absent && !is_there && !other_is_there)
        return 0;
    return fxs_scene_source_open_beside(file, r->source, other_is_there ? other : name, message);
}

static uint64_t load_u64(const uint8_t *bytes)
{
    return fxs_load_u32(bytes) | (uint64_t)fxs_load_u32(bytes + 4) << 32;
}

static int list_cells(lcc_reader *r, const fxs_scene_source *index, size_t count, fxs_message *message)
{
    const size_t level = (size_t)r->source->options.level;
    r->rows.source = index;
    for (size_t i = 0; i < count; i++) {
        fxs_bytes_skip(&r->rows, 4 + LEVEL_SIZE * level);
        const uint8_t *entry = fxs_bytes_take(&r->rows, LEVEL_SIZE);
        if (!entry)
            return fxs_bytes_fail_row(&r->rows, "cell", i, count, message);
        const cell added = {load_u64(entry + 4), fxs_load_u32(entry)};
        if (added.count * ROW > fxs_load_u32(entry + 12))
            return fxs_fail(message, "%s: cell %zu of %zu: more Gaussians than its bytes hold", index->path, i + 1,
                            count);
        if (added.count > 0)
            r->cells[r->cell_count++] = added;
        fxs_bytes_skip(&r->rows, LEVEL_SIZE * (r->levels - 1 - level));
    }
    return 0;
}

static int read_index(lcc_reader *r, const fxs_scene_source *index, fxs_message *message)
{
    const uint64_t size = index->input.size, unit = 4 + LEVEL_SIZE * (uint64_t)r->levels;
    if (size % unit != 0)
        return fxs_fail(message, "%s: %llu bytes are not whole cells of %llu", index->path, (unsigned long long)size,
                        (unsigned long long)unit);
    r->cells = fxs_hold(r->source, (size / unit + 1) * sizeof *r->cells, message);
    if (!r->cells)
        return FXS_ERR_MEMORY;
    r->cell_room = (size_t)(size / unit) + 1;
    return list_cells(r, index, r->cell_room - 1, message);
}

static int load_index(lcc_reader *r, fxs_message *message)
{
    fxs_scene_source index = {.path = NULL};
    int result = open_beside(r, &index, "index.bin", "Index.bin", 0, message);
    if (result == 0)
        result = read_index(r, &index, message);
    fxs_scene_source_close(&index);
    return result;
}

static int compare_cells(const void *a, const void *b)
{
    const cell *x = a, *y = b;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

/* Checks that the byte ranges of cells do not overlap, because a small file could otherwise demand much work. */
static int check_cells(lcc_reader *r, fxs_message *message)
{
    const uint64_t size = r->data_file.input.size;
    if (r->cell_count > 0)
        qsort(r->cells, r->cell_count, sizeof *r->cells, compare_cells);
    for (size_t i = 0; i < r->cell_count; i++) {
        const cell *c = &r->cells[i];
        if (c->begin > size || c->count * ROW > size - c->begin)
            return fxs_fail(message, "%s: the file ends before the last Gaussian of a cell", r->data_file.path);
        if (r->has_sh && 2 * (c->begin + c->count * ROW) > r->sh_file.input.size)
            return fxs_fail(message, "%s: the file ends before the last Gaussian of a cell", r->sh_file.path);
        if (i > 0 && c[-1].begin + c[-1].count * ROW > c->begin)
            return fxs_fail(message, "%s: two cells share a Gaussian", r->data_file.path);
    }
    return 0;
}

static int open_data(lcc_reader *r, fxs_message *message)
{
    FXS_TRY(open_beside(r, &r->data_file, "data.bin", "Data.bin", 0, message));
    if (r->has_sh)
        FXS_TRY(open_beside(r, &r->sh_file, "shcoef.bin", "Shcoef.bin", 0, message));
    r->sh_rows.source = &r->sh_file;
    return check_cells(r, message);
}

static int open_environment(lcc_reader *r, fxs_message *message)
{
    const uint64_t row = r->has_sh ? ROW + SH_ROW : ROW;
    FXS_TRY(open_beside(r, &r->environment_file, "environment.bin", "Environment.bin", 1, message));
    r->environment = r->cell_count;
    const uint64_t size = r->environment_file.input.size;
    if (size % row != 0)
        return fxs_fail(message, "%s: %llu bytes are not whole Gaussians of %llu", r->environment_file.path,
                        (unsigned long long)size, (unsigned long long)row);
    if (size > 0)
        r->cells[r->cell_count++] = (cell){0, size / row};
    return 0;
}

static double lerp(const bounds *b, int i, double t)
{
    return b->low[i] * (1 - t) + b->high[i] * t;
}

/* Decodes a quaternion x, y, z, w from its three smallest components, which lie in +-1/sqrt(2). The top two bits are
   the index of the largest component, which is not stored. */
static void decode_rotation(uint32_t code, float rotation[4])
{
    const uint32_t omitted = code >> 30;
    double sum = 0;
    for (uint32_t i = 0; i < 4; i++) {
        if (i == omitted)
            continue;
        const double value = ((code & 1023) / 1023.0 - 0.5) * 1.4142135623730951;
        rotation[(i + 1) % 4] = (float)value;
        sum += value * value;
        code >>= 10;
    }
    rotation[(omitted + 1) % 4] = (float)sqrt(fmax(0, 1 - sum));
}

/* Decodes SH coefficients. A word of 32 bits has red in 11, green in 10 and blue in 11 bits. */
static void decode_sh(const bounds *b, const uint8_t *row, float sh[45])
{
    for (int k = 0; k < 15; k++) {
        const uint32_t code = fxs_load_u32(row + 4 * k);
        sh[3 * k] = (float)lerp(b, 0, (code & 2047) / 2047.0);
        sh[3 * k + 1] = (float)lerp(b, 1, (code >> 11 & 1023) / 1023.0);
        sh[3 * k + 2] = (float)lerp(b, 2, (code >> 21) / 2047.0);
    }
}

static void decode(const lcc_reader *r, const uint8_t *row, const uint8_t *sh_row, fxs_gaussian *g)
{
    const int is_environment = r->at == r->environment;
    memset(g, 0, sizeof *g);
    for (int i = 0; i < 3; i++) {
        g->position[i] = fxs_load_float(row + 4 * i);
        g->dc[i] = fxs_dc_of_colour(row[12 + i] / 255.0);
        g->scale[i] = fxs_log_scale(lerp(&r->scale[is_environment], i, fxs_load_u16(row + 16 + 2 * i) / 65535.0));
    }
    g->opacity = fxs_logit_of_code(row[15]);
    decode_rotation(fxs_load_u32(row + 22), g->rotation);
    if (sh_row)
        decode_sh(&r->sh[is_environment], sh_row, g->sh);
    fxs_transform_apply(&r->transform, g, sh_row ? 3 : 0);
}

/* Begins to read the next cell. Cells are read in the order of data.bin, so that each byte is read once. */
static int enter_cell(lcc_reader *r)
{
    const cell *c = &r->cells[r->at];
    if (r->at == r->environment) {
        r->rows.source = &r->environment_file;
        return fxs_bytes_seek(&r->rows, 0);
    }
    fxs_bytes_skip(&r->rows, c->begin - fxs_bytes_tell(&r->rows));
    return r->has_sh ? fxs_bytes_skip(&r->sh_rows, 2 * c->begin - fxs_bytes_tell(&r->sh_rows)) : 0;
}

static int read_gaussian(lcc_reader *r, fxs_gaussian *g, fxs_message *message)
{
    const int is_environment = r->at == r->environment;
    if (r->done == 0)
        enter_cell(r);
    const uint8_t *row = fxs_bytes_take(&r->rows, is_environment && r->has_sh ? ROW + SH_ROW : ROW), *sh_row = NULL;
    if (row && r->has_sh)
        sh_row = is_environment ? row + ROW : fxs_bytes_take(&r->sh_rows, SH_ROW);
    if (!row || (r->has_sh && !sh_row))
        return fxs_bytes_fail_row(row ? &r->sh_rows : &r->rows, "Gaussian", r->done, r->cells[r->at].count, message);
    decode(r, row, sh_row, g);
    if (++r->done == r->cells[r->at].count) {
        r->at++;
        r->done = 0;
    }
    return 0;
}

static int lcc_rewind(void *handle, fxs_message *message)
{
    lcc_reader *r = handle;
    (void)message;
    r->at = 0;
    r->done = 0;
    r->rows.source = &r->data_file;
    fxs_bytes_seek(&r->sh_rows, 0);
    return fxs_bytes_seek(&r->rows, 0);
}

static int lcc_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    /* rotation from axes with z up to axes with y down */
    static double rows[3][4] = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}};
    lcc_reader *r = handle;
    const int level = source->options.level;
    r->source = source;
    FXS_TRY(load_meta(r, message));
    info->count = 0;
    info->antialiased = 0;
    info->sh_degree = r->has_sh ? 3 : 0;
    info->levels = (int)r->levels;
    info->colour.step = 1 / 255.0;
    if (level < 0 || level >= info->levels)
        return 0;
    FXS_TRY(load_index(r, message));
    FXS_TRY(open_data(r, message));
    FXS_TRY(open_environment(r, message));
    for (size_t i = 0; i < r->cell_count; i++)
        info->count += r->cells[i].count;
    fxs_transform_init(&r->transform, rows);
    return lcc_rewind(r, message);
}

static long lcc_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    lcc_reader *r = handle;
    size_t count = 0;
    for (; count < capacity && r->at < r->cell_count; count++)
        FXS_TRY(read_gaussian(r, &gaussians[count], message));
    return (long)count;
}

static void lcc_close(void *handle)
{
    lcc_reader *r = handle;
    fxs_let_go(r->source, r->cells, r->cell_room * sizeof *r->cells);
    fxs_scene_source_close(&r->data_file);
    fxs_scene_source_close(&r->sh_file);
    fxs_scene_source_close(&r->environment_file);
}

#define READER_SIZE sizeof(lcc_reader)

#else

static int lcc_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle;
    (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read .lcc: built without cJSON", source->path);
}

#define READER_SIZE 0
#define lcc_read NULL
#define lcc_rewind NULL
#define lcc_close NULL

#endif

static int is_lcc(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->name && strstr(head->bytes, "\"totalLevel\"");
}

const fxs_reader fxs_read_lcc = {is_lcc, READER_SIZE, lcc_open, lcc_read, lcc_rewind, lcc_close, NULL};
