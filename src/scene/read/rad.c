/* Reads .rad of Spark: a JSON header, then chunks of up to 65,536 Gaussians. A chunk has a JSON header and a compressed
   column of numbers for each attribute. The Gaussians may be nodes of a level-of-detail tree. Layout:
   rust/spark-lib/src/rad.rs of sparkjsdev/spark; rotations: splat_encode.rs. */
#include "src/scene/formats_internal.h"
#include "rad_internal.h"

#include <string.h>

static int is_rad(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, "RAD0", 4) || !memcmp(head->bytes, "RADC", 4);
}

#define BIT(encoding) (1u << FXS_RAD_##encoding)
#define SH_ENCODINGS (BIT(F32) | BIT(F16) | BIT(R8) | BIT(R8_DELTA) | BIT(S8) | BIT(S8_DELTA))

const fxs_rad_property fxs_rad_properties[FXS_RAD_PROPERTIES] = {
    {"center", 3, BIT(F32) | BIT(F16) | BIT(F32_LEBYTES) | BIT(F16_LEBYTES)},
    {"alpha", 1, BIT(F32) | BIT(F16) | BIT(R8)},
    {"rgb", 3, BIT(F32) | BIT(F16) | BIT(R8) | BIT(R8_DELTA)},
    {"scales", 3, BIT(F32) | BIT(LN_0R8) | BIT(LN_F16)},
    {"orientation", 3, BIT(F32) | BIT(F16) | BIT(OCT88R8)},
    {"sh1", 9, SH_ENCODINGS}, {"sh2", 15, SH_ENCODINGS}, {"sh3", 21, SH_ENCODINGS},
    {"child_count", 1, BIT(U16)}, {"child_start", 1, BIT(U32)},
    {"sh_label", 1, BIT(U16) | BIT(U32)},
    {"sh1_code", 9, SH_ENCODINGS}, {"sh2_code", 15, SH_ENCODINGS}, {"sh3_code", 21, SH_ENCODINGS}
};

const fxs_rad_encoding fxs_rad_encodings[FXS_RAD_ENCODINGS] = {
    {"f32", 4}, {"f16", 2}, {"f32_lebytes", 4}, {"f16_lebytes", 2}, {"r8", 1}, {"r8_delta", 1}, {"s8", 1},
    {"s8_delta", 1}, {"ln_0r8", 1}, {"ln_f16", 2}, {"oct88r8", 1}, {"u16", 2}, {"u32", 4}
};

#ifdef FXS_WITH_CJSON

#include <math.h>

#include <cjson/cJSON.h>

#include "src/base/byte_reader.h"
#include "src/base/inflate_internal.h"
#include "src/base/sine.h"
#include "src/gaussian/attributes.h"

enum {
    CHUNK_HEAD = 8,
    PAYLOAD_SIZE = 8,
    TALLEST = 254                  /* largest height of a tree node; greater heights are clamped */
};

#define ALWAYS_THERE 5
#define RANGED (BIT(R8) | BIT(R8_DELTA) | BIT(LN_0R8))
#define SIGNED (BIT(S8) | BIT(S8_DELTA))

/* A column holds one attribute of all Gaussians of a chunk: all x, then all y, then all z. Rotations coded as oct88r8
   are stored together instead. */
typedef struct column {
    int is_there, is_compressed, encoding;
    uint64_t offset, stored;
    double low, high;
    size_t rows;
    uint8_t *bytes;
} column;

typedef struct chunk {
    const char *name;
    uint64_t offset, size;
} chunk;

typedef struct rad_reader {
    const fxs_scene_source *source;
    cJSON *root;
    fxs_scene_source beside;
    size_t count, chunk_size, chunk_count;
    size_t codes;
    int sh_degree, is_tree;
    chunk *chunks;
    uint8_t *drawn;   /* one bit for each node of the level-of-detail tree: 1 if the node is drawn; null: no tree */
    size_t at;
    size_t loaded;
    uint64_t payload;
    column columns[FXS_RAD_PROPERTIES];
} rad_reader;

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static uint64_t up_to_8(uint64_t size)
{
    return (size + 7) & ~(uint64_t)7;
}

static size_t rows_of(const rad_reader *r, size_t i)
{
    const size_t left = r->count - i * r->chunk_size;
    return left < r->chunk_size ? left : r->chunk_size;
}

static int load_json(const fxs_scene_source *source, uint64_t offset, uint64_t end, const char *magic, cJSON **root,
                     uint64_t *after, fxs_message *message)
{
    uint8_t head[CHUNK_HEAD];
    fxs_text json;
    *root = NULL;
    if (end - offset < CHUNK_HEAD)
        return fxs_fail(message, "%s: the file ends early", source->path);
    FXS_TRY(fxs_scene_source_read(source, offset, head, CHUNK_HEAD, message));
    const uint64_t length = fxs_load_u32(head + 4);
    if (memcmp(head, magic, 4))
        return fxs_fail(message, "%s: no %s where a chunk should begin", source->path, magic);
    if (up_to_8(length) > end - offset - CHUNK_HEAD)
        return fxs_fail(message, "%s: the file ends early", source->path);
    FXS_TRY(fxs_scene_source_load(source, offset + CHUNK_HEAD, length, &json, message));
    const int result = fxs_json_parse(&json, source, root, message);
    fxs_text_let_go(source, &json);
    *after = offset + CHUNK_HEAD + up_to_8(length);
    return result;
}

static const char *read_meta(rad_reader *r, const cJSON *root)
{
    const char *type = fxs_json_string(root, "type");
    const cJSON *degree = member(root, "maxSh"), *chunk_size = member(root, "chunkSize"),
                *codes = member(root, "shCodeCount");
    size_t version = 0, sh = 0;
    if (!fxs_json_whole(member(root, "version"), INT32_MAX, &version) || version != 1)
        return "a version that is not known: not 1";
    if (!type || strcmp(type, "gsplat"))
        return "a type that is not known: not gsplat";
    if (!fxs_json_whole(member(root, "count"), INT32_MAX, &r->count))
        return "no valid \"count\"";
    r->chunk_size = r->count;
    if (chunk_size && (!fxs_json_whole(chunk_size, INT32_MAX, &r->chunk_size) || !r->chunk_size))
        return "no valid \"chunkSize\"";
    if (degree && !fxs_json_whole(degree, 3, &sh))
        return "no valid \"maxSh\"";
    if (codes && !fxs_json_whole(codes, INT32_MAX, &r->codes))
        return "no valid \"shCodeCount\"";
    r->sh_degree = (int)sh;
    r->is_tree = cJSON_IsTrue(member(root, "lodTree"));
    r->chunk_count = r->count ? (r->count + r->chunk_size - 1) / r->chunk_size : 0;
    if (!cJSON_IsArray(member(root, "chunks")) || (size_t)cJSON_GetArraySize(member(root, "chunks")) != r->chunk_count)
        return "\"chunks\" that are not as many as \"count\" and \"chunkSize\" say";
    return NULL;
}

static int list_chunks(rad_reader *r, uint64_t begin, fxs_message *message)
{
    const cJSON *item;
    size_t i = 0;
    r->chunks = fxs_hold(r->source, r->chunk_count * sizeof *r->chunks, message);
    if (!r->chunks)
        return FXS_ERR_MEMORY;
    cJSON_ArrayForEach(item, member(r->root, "chunks")) {
        size_t offset, size;
        const char *name = fxs_json_string(item, "filename");
        if (!fxs_json_whole(member(item, "offset"), SIZE_MAX / 4, &offset) ||
            !fxs_json_whole(member(item, "bytes"), SIZE_MAX / 4, &size))
            return fxs_fail(message, "%s: a chunk with no valid \"offset\" and \"bytes\"", r->source->path);
        if (name)
            FXS_TRY(fxs_check_name(r->source, name, message));
        r->chunks[i++] = (chunk){name, offset + (name ? 0 : begin), size};
    }
    return 0;
}

static int load_header(rad_reader *r, fxs_message *message)
{
    const fxs_scene_source *source = r->source;
    uint64_t begin;
    char magic[4];
    FXS_TRY(fxs_scene_source_read(source, 0, magic, sizeof magic, message));
    if (!memcmp(magic, "RADC", 4))
        return fxs_fail(message, "%s: one chunk of a .rad: open the .rad that it belongs to", source->path);
    FXS_TRY(load_json(source, 0, source->input.size, "RAD0", &r->root, &begin, message));
    const char *fault = read_meta(r, r->root);
    if (fault)
        return fxs_fail(message, "%s: %s", source->path, fault);
    FXS_TRY(fxs_limit_gaussians(source, r->is_tree ? r->count / 2 : r->count, message));
    return list_chunks(r, begin, message);
}

static size_t column_bytes(const rad_reader *r, int property)
{
    const column *c = &r->columns[property];
    return c->rows * (size_t)fxs_rad_properties[property].numbers * (size_t)fxs_rad_encodings[c->encoding].width;
}

static void drop_column(rad_reader *r, int property)
{
    fxs_let_go(r->source, r->columns[property].bytes, column_bytes(r, property));
    r->columns[property].bytes = NULL;
}

static void drop_columns(rad_reader *r)
{
    for (int i = 0; i < FXS_RAD_SH1_CODE; i++) {
        drop_column(r, i);
        r->columns[i].is_there = 0;
    }
    fxs_scene_source_close(&r->beside);
    r->loaded = r->chunk_count;
}

static int property_of(const char *name)
{
    int i = 0;
    while (i < FXS_RAD_PROPERTIES && (!name || strcmp(name, fxs_rad_properties[i].name)))
        i++;
    return i;
}

static int encoding_of(const char *name)
{
    int i = 0;
    while (i < FXS_RAD_ENCODINGS && (!name || strcmp(name, fxs_rad_encodings[i].name)))
        i++;
    return i;
}

static const char *read_column(column *c, const cJSON *item, int property, uint64_t payload)
{
    const cJSON *low = member(item, "min"), *high = member(item, "max"), *compression = member(item, "compression");
    const char *way = cJSON_GetStringValue(compression);
    size_t offset, stored;
    c->encoding = encoding_of(fxs_json_string(item, "encoding"));
    if (c->encoding == FXS_RAD_ENCODINGS || !(fxs_rad_properties[property].encodings >> c->encoding & 1)) {
        c->encoding = 0;
        return "an encoding that is not known";
    }
    if (compression && !cJSON_IsNull(compression) && (!way || strcmp(way, "gz")))
        return "a compression that is not known: not gz";
    if (!fxs_json_whole(member(item, "offset"), SIZE_MAX / 4, &offset) ||
        !fxs_json_whole(member(item, "bytes"), SIZE_MAX / 4, &stored) || offset > payload || stored > payload - offset)
        return "no valid \"offset\" and \"bytes\"";
    if (((RANGED | SIGNED) >> c->encoding & 1 && !cJSON_IsNumber(high)) ||
        (RANGED >> c->encoding & 1 && !cJSON_IsNumber(low)))
        return "no \"min\" and \"max\"";
    c->is_compressed = way != NULL;
    c->offset = offset;
    c->stored = stored;
    c->low = cJSON_IsNumber(low) ? low->valuedouble : 0;
    c->high = cJSON_IsNumber(high) ? high->valuedouble : 0;
    return NULL;
}

static const char *list_columns(rad_reader *r, const cJSON *root, size_t i, uint64_t payload)
{
    const cJSON *item;
    size_t base, rows;
    if (!fxs_json_whole(member(root, "base"), INT32_MAX, &base) || base != i * r->chunk_size ||
        !fxs_json_whole(member(root, "count"), INT32_MAX, &rows) || rows != rows_of(r, i))
        return "a \"base\" and \"count\" that are not those of its place";
    cJSON_ArrayForEach(item, member(root, "properties")) {
        const int property = property_of(fxs_json_string(item, "property"));
        column *c = &r->columns[property];
        if (property == FXS_RAD_PROPERTIES || (property >= FXS_RAD_SH1_CODE && (i > 0 || c->bytes)))
            continue;
        if (c->is_there && property < FXS_RAD_SH1_CODE)
            return "a property that it has twice";
        c->rows = property >= FXS_RAD_SH1_CODE && r->codes ? r->codes : rows;
        c->is_there = 1;
        const char *fault = read_column(c, item, property, payload);
        if (fault)
            return fault;
    }
    for (int property = 0; property < ALWAYS_THERE; property++)
        if (!r->columns[property].is_there)
            return "without center, alpha, rgb, scales or orientation";
    return r->is_tree && (!r->columns[FXS_RAD_CHILD_COUNT].is_there || !r->columns[FXS_RAD_CHILD_START].is_there)
               ? "without child_count or child_start" : NULL;
}

static const fxs_scene_source *file_of(const rad_reader *r, size_t i)
{
    return r->chunks[i].name ? &r->beside : r->source;
}

static int read_chunk(rad_reader *r, size_t i, const fxs_scene_source *source, uint64_t end, fxs_message *message)
{
    uint8_t size[PAYLOAD_SIZE] = {0};
    cJSON *root;
    int result = load_json(source, r->chunks[i].offset, end, "RADC", &root, &r->payload, message);
    const char *fault = NULL;
    if (result == 0)
        result = fxs_scene_source_read(source, r->payload, size, PAYLOAD_SIZE, message);
    const uint64_t payload = fxs_load_u32(size) | (uint64_t)fxs_load_u32(size + 4) << 32;
    r->payload += PAYLOAD_SIZE;
    if (result == 0)
        fault = r->payload > end || payload > end - r->payload ? "it ends early" : list_columns(r, root, i, payload);
    if (fault)
        result = fxs_fail(message, "%s: chunk %zu of %zu: %s", source->path, i + 1, r->chunk_count, fault);
    cJSON_Delete(root);
    return result;
}

static int open_chunk(rad_reader *r, size_t i, fxs_message *message)
{
    const chunk *c = &r->chunks[i];
    drop_columns(r);
    if (c->name)
        FXS_TRY(fxs_scene_source_open_beside(&r->beside, r->source, c->name, message));
    const fxs_scene_source *source = file_of(r, i);
    if (c->offset > source->input.size || c->size > source->input.size - c->offset)
        return fxs_fail(message, "%s: the file ends within chunk %zu of %zu", source->path, i + 1, r->chunk_count);
    FXS_TRY(read_chunk(r, i, source, c->offset + c->size, message));
    r->loaded = i;
    return 0;
}

static void sum_up(const column *c, int numbers)
{
    for (int d = 0; d < numbers; d++) {
        uint8_t *code = c->bytes + (size_t)d * c->rows;
        for (size_t i = 1; i < c->rows; i++)
            code[i] = (uint8_t)(code[i] + code[i - 1]);
    }
}

static int inflate_column(rad_reader *r, int property, fxs_message *message)
{
    const fxs_scene_source *source = file_of(r, r->loaded);
    const column *c = &r->columns[property];
    const size_t wanted = column_bytes(r, property);
    fxs_text packed;
    FXS_TRY(fxs_scene_source_load(source, r->payload + c->offset, c->stored, &packed, message));
    const int result = fxs_inflate(source, packed.data, packed.size, c->bytes, wanted, message);
    fxs_text_let_go(source, &packed);
    return result;
}

static int load_column(rad_reader *r, int property, fxs_message *message)
{
    column *c = &r->columns[property];
    const fxs_scene_source *source = file_of(r, r->loaded);
    const size_t wanted = column_bytes(r, property);
    if (!c->is_there || c->bytes)
        return 0;
    if (c->is_compressed ? wanted / FXS_MAX_EXPANSION > c->stored : wanted != c->stored)
        return fxs_fail(message, "%s: %s: %llu bytes cannot be the %zu of %zu Gaussians", source->path,
                        fxs_rad_properties[property].name, (unsigned long long)c->stored, wanted, c->rows);
    c->bytes = fxs_hold(r->source, wanted, message);
    if (!c->bytes)
        return FXS_ERR_MEMORY;
    const int result = c->is_compressed
                           ? inflate_column(r, property, message)
                           : fxs_scene_source_read(source, r->payload + c->offset, c->bytes, wanted, message);
    if (result)
        drop_column(r, property);
    else if (c->encoding == FXS_RAD_R8_DELTA || c->encoding == FXS_RAD_S8_DELTA)
        sum_up(c, fxs_rad_properties[property].numbers);
    return result;
}

static uint32_t apart(const uint8_t *bytes, size_t stride, int width)
{
    uint32_t bits = 0;
    for (int i = 0; i < width; i++)
        bits |= (uint32_t)bytes[(size_t)i * stride] << 8 * i;
    return bits;
}

static double value(const column *c, int numbers, int d, size_t row)
{
    const size_t i = (size_t)d * c->rows + row, stride = (size_t)numbers * c->rows;
    const uint8_t *at = c->bytes + i * (size_t)fxs_rad_encodings[c->encoding].width;
    uint32_t bits;
    float single;
    switch (c->encoding) {
    case FXS_RAD_F32:
        return (double)fxs_load_float(at);
    case FXS_RAD_F16:
    case FXS_RAD_LN_F16:
        return (double)fxs_half(fxs_load_u16(at));
    case FXS_RAD_F32_LEBYTES:
        bits = apart(c->bytes + i, stride, 4);
        memcpy(&single, &bits, sizeof single);
        return (double)single;
    case FXS_RAD_F16_LEBYTES:
        return (double)fxs_half(apart(c->bytes + i, stride, 2));
    case FXS_RAD_S8:
    case FXS_RAD_S8_DELTA:
        return (int8_t)*at / 127.0 * c->high;
    case FXS_RAD_LN_0R8:
        return *at ? c->low + (*at - 1) * (c->high - c->low) / 254 : -INFINITY;
    case FXS_RAD_U16:
        return fxs_load_u16(at);
    case FXS_RAD_U32:
        return fxs_load_u32(at);
    default:
        return c->low + *at / 255.0 * (c->high - c->low);
    }
}

static double value_of(const rad_reader *r, int property, int d, size_t row)
{
    return value(&r->columns[property], fxs_rad_properties[property].numbers, d, row);
}

/* Decodes a rotation from an axis, stored by the octahedral map, and an angle from 0 to pi. */
static void decode_octahedron(const uint8_t code[3], float rotation[4])
{
    double x = code[0] / 255.0 * 2 - 1, y = code[1] / 255.0 * 2 - 1;
    const double z = 1 - fabs(x) - fabs(y), fold = z < 0 ? -z : 0, turns = code[2] / 1020.0;
    x += x >= 0 ? -fold : fold;
    y += y >= 0 ? -fold : fold;
    const double sine = fxs_sine(turns) / sqrt(x * x + y * y + z * z);
    rotation[0] = (float)fxs_sine(turns + 0.25);
    rotation[1] = (float)(x * sine);
    rotation[2] = (float)(y * sine);
    rotation[3] = (float)(z * sine);
}

static void decode_rotation(const rad_reader *r, size_t row, float rotation[4])
{
    const column *c = &r->columns[FXS_RAD_ORIENTATION];
    double rest = 1;
    if (c->encoding == FXS_RAD_OCT88R8) {
        decode_octahedron(c->bytes + 3 * row, rotation);
        return;
    }
    for (int i = 0; i < 3; i++) {
        const double part = value_of(r, FXS_RAD_ORIENTATION, i, row);
        rotation[1 + i] = (float)part;
        rest -= part * part;
    }
    rotation[0] = rest > 0 ? (float)sqrt(rest) : 0;
}

static int decode_sh(const rad_reader *r, size_t row, float sh[45], fxs_message *message)
{
    const int has_labels = r->columns[FXS_RAD_SH_LABEL].bytes != NULL;
    const int first = has_labels ? FXS_RAD_SH1_CODE : FXS_RAD_SH1;
    if (has_labels)
        row = (size_t)value_of(r, FXS_RAD_SH_LABEL, 0, row);
    for (int degree = 0; degree < r->sh_degree; degree++) {
        const column *c = &r->columns[first + degree];
        if (c->bytes && row >= c->rows)
            return fxs_fail(message, "%s: SH number %zu of a palette of %zu", r->source->path, row, c->rows);
        for (int k = 0; k < fxs_rad_properties[first + degree].numbers && c->bytes; k++)
            sh[3 * degree * (degree + 2) + k] = (float)value_of(r, first + degree, k, row);
    }
    return 0;
}

/* Decodes the opacity of a Gaussian. Returns ln A, where A is the opacity of a tree node above 1, else 1. Codes above 1
   mean D = min(4 code - 3, 5) and A = e^((D^2 - 1) / e). At z sigmas from the centre, Spark then draws the opacity 1 -
   (1 - e^(-z^2/2))^A. Gaussians of this renderer are at most opaque, so the node is enlarged by A^(1/3) instead. */
static double decode_opacity(const rad_reader *r, size_t row, float *opacity)
{
    const double code = value_of(r, FXS_RAD_ALPHA, 0, row), d = fmin(4 * code - 3, 5);
    *opacity = fxs_logit_of_opacity(code);
    return r->is_tree && code > 1 ? (d * d - 1) / FXS_RAD_E : 0;
}

static int decode(const rad_reader *r, size_t row, fxs_gaussian *g, fxs_message *message)
{
    memset(g, 0, sizeof *g);
    const double growth = decode_opacity(r, row, &g->opacity) / 3;
    const int is_linear = r->columns[FXS_RAD_SCALES].encoding == FXS_RAD_F32;
    for (int i = 0; i < 3; i++) {
        const double scale = value_of(r, FXS_RAD_SCALES, i, row);
        const double own = is_linear ? (double)fxs_log_scale(scale) : scale < FXS_FLAT_SCALE ? FXS_FLAT_SCALE : scale;
        g->position[i] = (float)value_of(r, FXS_RAD_CENTER, i, row);
        g->dc[i] = fxs_dc_of_colour(value_of(r, FXS_RAD_RGB, i, row));
        g->scale[i] = (float)(own + growth);
    }
    decode_rotation(r, row, g->rotation);
    return decode_sh(r, row, g->sh, message);
}

/* Returns 1 if a tree node is low enough for a level of detail. A node is drawn at level k if its height is at most k
   and its parent's height is greater. The height is the number of steps to the lowest leaf. */
static int is_low(const uint8_t *heights, size_t i, int level)
{
    return heights[i] <= level;
}

static void draw(rad_reader *r, size_t i)
{
    r->drawn[i / 8] = (uint8_t)(r->drawn[i / 8] | 1 << i % 8);
}

static int visit(rad_reader *r, uint8_t *heights, size_t base, size_t row, size_t *children, fxs_message *message)
{
    const size_t own = base + row, count = (size_t)value_of(r, FXS_RAD_CHILD_COUNT, 0, row);
    const size_t first = (size_t)value_of(r, FXS_RAD_CHILD_START, 0, row);
    int height = -1;
    *children += count;
    if (count && (first <= own || first > r->count || count > r->count - first || *children >= r->count))
        return fxs_fail(message, "%s: node %zu of %zu: children that are no later nodes of their own", r->source->path,
                        own + 1, r->count);
    for (size_t i = first; i < first + count; i++)
        height = heights[i] > height ? heights[i] : height;
    heights[own] = (uint8_t)(height < TALLEST ? height + 1 : TALLEST);
    if (!is_low(heights, own, r->source->options.level))
        for (size_t i = first; i < first + count; i++)
            if (is_low(heights, i, r->source->options.level))
                draw(r, i);
    return 0;
}

static int visit_all(rad_reader *r, uint8_t *heights, fxs_message *message)
{
    size_t children = 0;
    for (size_t i = r->chunk_count; i-- > 0;) {
        FXS_TRY(fxs_scene_source_progress(r->source, 1 - (double)i / (double)r->chunk_count, message));
        FXS_TRY(open_chunk(r, i, message));
        FXS_TRY(load_column(r, FXS_RAD_CHILD_COUNT, message));
        FXS_TRY(load_column(r, FXS_RAD_CHILD_START, message));
        for (size_t row = rows_of(r, i); row-- > 0;)
            FXS_TRY(visit(r, heights, i * r->chunk_size, row, &children, message));
    }
    if (is_low(heights, 0, r->source->options.level))
        draw(r, 0);
    return 0;
}

static int find_drawn(rad_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    uint8_t *heights = fxs_hold(r->source, r->count, message);
    if (!heights)
        return FXS_ERR_MEMORY;
    r->drawn = fxs_hold(r->source, r->count / 8 + 1, message);
    if (r->drawn)
        memset(r->drawn, 0, r->count / 8 + 1);
    const int result = r->drawn ? visit_all(r, heights, message) : FXS_ERR_MEMORY;
    info->levels = heights[0] + 1;
    fxs_let_go(r->source, heights, r->count);
    info->count = 0;
    for (size_t i = 0; i < r->count && result == 0; i++)
        info->count += r->drawn[i / 8] >> i % 8 & 1;
    return result;
}

static int rad_rewind(void *handle, fxs_message *message)
{
    (void)message;
    ((rad_reader *)handle)->at = 0;
    return 0;
}

static void note_grids(const rad_reader *r, size_t i, fxs_scene_file_info *info)
{
    const column *rgb = &r->columns[FXS_RAD_RGB];
    const double step = RANGED >> rgb->encoding & 1 ? (rgb->high - rgb->low) / 255 : 0;
    if (i == 0)
        info->colour = (fxs_grid){rgb->low, step};
    else if (info->colour.low != rgb->low || info->colour.step != step)
        info->colour.step = 0;
}

static int check_chunks(rad_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    for (size_t i = 0; i < r->chunk_count; i++) {
        FXS_TRY(open_chunk(r, i, message));
        note_grids(r, i, info);
    }
    return 0;
}

static int rad_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    rad_reader *r = handle;
    r->source = source;
    FXS_TRY(load_header(r, message));
    r->loaded = r->chunk_count;
    info->count = r->count;
    info->sh_degree = r->sh_degree;
    info->antialiased = 0;
    FXS_TRY(check_chunks(r, info, message));
    if (r->is_tree && r->count)
        FXS_TRY(find_drawn(r, info, message));
    return fxs_limit_gaussians(source, info->count, message);
}

static int enter_chunk(rad_reader *r, size_t i, fxs_message *message)
{
    const int last = FXS_RAD_SH1 + r->sh_degree;
    if (r->loaded == i && r->columns[0].bytes)
        return 0;
    FXS_TRY(fxs_scene_source_progress(r->source, (double)i / (double)r->chunk_count, message));
    FXS_TRY(open_chunk(r, i, message));
    for (int property = 1; property < last; property++)
        FXS_TRY(load_column(r, property, message));
    if (r->sh_degree)
        FXS_TRY(load_column(r, FXS_RAD_SH_LABEL, message));
    for (int degree = 0; degree < r->sh_degree && i == 0; degree++)
        FXS_TRY(load_column(r, FXS_RAD_SH1_CODE + degree, message));
    return load_column(r, 0, message);
}

static long rad_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    rad_reader *r = handle;
    size_t count = 0;
    for (; count < capacity && r->at < r->count; r->at++) {
        const size_t i = r->at / r->chunk_size, row = r->at % r->chunk_size;
        if (row == 0)
            FXS_TRY(enter_chunk(r, i, message));
        if (r->drawn && !(r->drawn[r->at / 8] >> r->at % 8 & 1))
            continue;
        FXS_TRY(decode(r, row, &gaussians[count++], message));
    }
    return (long)count;
}

static void rad_close(void *handle)
{
    rad_reader *r = handle;
    drop_columns(r);
    for (int i = FXS_RAD_SH1_CODE; i < FXS_RAD_PROPERTIES; i++)
        drop_column(r, i);
    fxs_let_go(r->source, r->chunks, r->chunk_count * sizeof *r->chunks);
    fxs_let_go(r->source, r->drawn, r->count / 8 + 1);
    cJSON_Delete(r->root);
}

const fxs_reader fxs_read_rad = {is_rad, sizeof(rad_reader), rad_open, rad_read, rad_rewind, rad_close, NULL};

#else

static int rad_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle, (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read .rad: built without cJSON", source->path);
}

const fxs_reader fxs_read_rad = {is_rad, 0, rad_open, NULL, NULL, NULL, NULL};

#endif
