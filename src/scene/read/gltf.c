/* Reads .glb and .gltf with KHR_gaussian_splatting (Khronos), plain or with .spz data in a bufferView. Negates x and y
   to get the axes of a .ply, with y down. Converts linear colours to sRGB. Supports drafts of the extension: SCALE as
   logarithms (February 2026); _ROTATION, _SCALE and COLOR_0 (Cesium, 2024). Also reads the triangles of meshes, for
   src/surface. */
#include <fixsplat/internal/allocator.h>

#include <math.h>
#include <string.h>

#include "gltf_internal.h"

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>
#include <stdio.h>
#include <strings.h>

#include "src/base/byte_reader.h"
#include "src/base/exponential.h"
#include "src/base/foreign.h"
#include "src/gaussian/attributes.h"
#include "spz_internal.h"
#include "src/base/text_internal.h"
#include "src/gaussian/origin_internal.h"
#include "src/gaussian/transform_internal.h"

enum {
    MAX_DEPTH = 64,
    MAX_BUFFERS = 64,
    MAX_MEMBERS = 1024,          /* most members of a JSON object, because each look-up searches linearly */
    MAX_PARTS = 1024,            /* most primitives; a primitive counts once for each node that places it */
    MAX_COUNT = 2147483647,
    BATCH = 256,
    MAX_STRIDE = 252
};

typedef struct list {
    const cJSON **items;
    int count;
} list;

enum { NODES, MESHES, ACCESSORS, VIEWS, BUFFERS, LISTS };
static const char *const list_names[LISTS] = {"nodes", "meshes", "accessors", "bufferViews", "buffers"};

typedef struct buffer {
    const fxs_scene_source *source;
    fxs_scene_source own;
    uint8_t *memory;
    uint64_t memory_size;
    uint64_t offset, size;
} buffer;

typedef struct range {
    const buffer *buffer;
    uint64_t offset, size;
} range;

typedef struct buffer_view {
    range bytes;
    int64_t stride;              /* number of bytes from one element to the next; 0: the file states none */
    const char *fault;
} buffer_view;

enum { BYTE, UBYTE, SHORT, USHORT, UINT = 5, FLOAT };   /* types of numbers: glTF's componentType minus 5120 */

typedef struct accessor {
    range bytes;                 /* place of the elements in a buffer; buffer null: all elements are 0 */
    range indices, values;
    uint32_t replaced, at;
    uint32_t count, stride, size;
    uint8_t type, is_normalized, components, index_size;
} accessor;

enum { POSITION, ROTATION, SCALE, OPACITY, SH, ATTRIBUTES = SH + 16 };

typedef struct splats {
    range spz;                   /* place of the .spz data; buffer null: the attributes are not compressed */
    fxs_spz *opened;
    int first;
    accessor attributes[ATTRIBUTES];
    int attribute_count;
    uint32_t count;
    int sh_degree, stored_sh_degree, antialiased;
    int scales_known, has_log_scales, is_linear, is_clamped;
    double middle[3];
    accessor indices;            /* of a mesh; count 0: the vertices are in order */
    int mode;
} splats;

enum { TRIANGLES = 4, STRIP, FAN };

typedef struct mesh {
    int is_read, first, end;
} mesh;

typedef struct part {
    int splats;
    double rows[3][4];
} part;

typedef struct gltf {
    const fxs_scene_source *source;
    fxs_message *message;
    double frame[3][4];
    list lists[LISTS];           /* JSON arrays of the file, freed when the file has been opened */
    buffer_view *views;
    mesh *meshes;
    uint8_t *visited;
    uint64_t bin_offset, bin_size;
    buffer buffers[MAX_BUFFERS];
    int is_quantized;            /* 1 if KHR_mesh_quantization allows integer positions */
    splats *splats;
    part *parts;
    int splats_count, parts_count;
    const char *other;
    const fxs_triangle_sink *sink;   /* takes the triangles of meshes; null: Gaussians are read */
    int part;
    uint32_t next;
    fxs_transform transform;
    fxs_spz *spz;
    uint8_t bytes[BATCH * MAX_STRIDE];
} gltf;

static int fail(const gltf *g, const char *fault)
{
    return fxs_fail(g->message, "%s: %s", g->source->path, fault);
}

static void *allocate(const gltf *g, size_t count, size_t size)
{
    void *block = fxs_allocate_zeroed(g->source->options.allocator, count, size);
    if (!block)
        fxs_fail_memory(g->message, g->source->path, (uint64_t)count * size);
    return block;
}

static void release(const gltf *g, void *block)
{
    fxs_release(g->source->options.allocator, block);
}

static int fail_item(const gltf *g, const char *item, int index, const char *fault)
{
    return fxs_fail(g->message, "%s: %s %d: %s", g->source->path, item, index, fault);
}

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* Reads an integer from 0 to 2^53 - 1 from a JSON item. Returns `absent` if `item` is null, and -1 for any other
   item. */
static int64_t whole(const cJSON *item, int64_t absent)
{
    if (!item)
        return absent;
    double value = cJSON_IsNumber(item) ? item->valuedouble : -1;
    return value >= 0 && value < 9007199254740992.0 && value == (double)(int64_t)value ? (int64_t)value : -1;
}

static int index_of(const gltf *g, const cJSON *item, int which)
{
    int64_t index = whole(item, -1);
    return index < g->lists[which].count ? (int)index : -1;
}

static int make_list(gltf *g, const cJSON *root, int which)
{
    const cJSON *array = member(root, list_names[which]), *item;
    list *made = &g->lists[which];
    made->items = allocate(g, (size_t)cJSON_GetArraySize(array), sizeof *made->items);
    if (!made->items)
        return FXS_ERR_MEMORY;
    cJSON_ArrayForEach(item, array) {
        if (cJSON_GetArraySize(item) > MAX_MEMBERS)
            return fail_item(g, list_names[which], made->count, "too many members");
        made->items[made->count++] = item;
    }
    return 0;
}

static void *grow(const gltf *g, void *items, int count, size_t size)
{
    if (count & (count - 1))     /* the array has room for the next power of two of items */
        return items;
    void *larger = fxs_enlarge(g->source->options.allocator, items, (size_t)count, count ? 2 * (size_t)count : 1, size);
    if (!larger)
        fxs_fail_memory(g->message, g->source->path, 2 * (uint64_t)count * size);
    return larger;
}

static int base64_digit(int c)
{
    return c >= 'A' && c <= 'Z' ? c - 'A' : c >= 'a' && c <= 'z' ? c - 'a' + 26 : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+' ? 62 : c == '/' ? 63 : -1;
}

static int64_t decode_base64(const char *text, uint8_t *out)
{
    const uint8_t *start = out;
    uint32_t bits = 0;
    int count = 0;
    for (; *text && *text != '='; text++) {
        int digit = base64_digit(*text);
        if (digit < 0)
            return -1;
        bits = bits << 6 | (uint32_t)digit;
        count += 6;
        if (count >= 8)
            *out++ = (uint8_t)(bits >> (count -= 8));
    }
    return out - start;
}

static int open_data(const gltf *g, buffer *b, int index, const char *uri)
{
    const char *comma = strchr(uri, ',');
    if (!comma || comma - uri < 7 || memcmp(comma - 7, ";base64", 7) != 0)
        return fail_item(g, "buffer", index, "a data: URI that is not base64");
    b->memory_size = strlen(comma) / 4 * 3 + 3;
    b->memory = fxs_hold(g->source, b->memory_size, g->message);
    if (!b->memory)
        return FXS_ERR_MEMORY;
    int64_t size = decode_base64(comma + 1, b->memory);
    if (size < 0)
        return fail_item(g, "buffer", index, "a data: URI that is not base64");
    const fxs_scene_input input = fxs_memory_input(b->memory, (size_t)size);
    b->own.options = g->source->options;
    b->own.import = g->source->import;
    return fxs_scene_source_open_input(&b->own, g->source->path, &input, g->message);
}

static int open_beside(const gltf *g, buffer *b, int index, const char *uri)
{
    char *name = allocate(g, strlen(uri) + 1, 1);
    if (!name)
        return FXS_ERR_MEMORY;
    strcpy(name, uri);
    fxs_decode_percent(name);
    int result = *name && !strchr(name, '/') ? fxs_scene_source_open_beside(&b->own, g->source, name, g->message)
                 : fail_item(g, "buffer", index, "a URI that is not a file name in the same folder");
    release(g, name);
    return result;
}

/* Opens a glTF buffer. A buffer that stands for the uncompressed form of compressed data has no bytes and stays
   empty. */
static int open_buffer(gltf *g, int index)
{
    const cJSON *item = g->lists[BUFFERS].items[index];
    const char *uri = fxs_json_string(item, "uri");
    int64_t size = whole(member(item, "byteLength"), -1);
    buffer *b = &g->buffers[index];
    if (size < 1)
        return fail_item(g, "buffer", index, "no byteLength above 0");
    if (!uri && index > 0)
        return 0;
    if (!uri) {
        b->source = g->source;
        b->offset = g->bin_offset;
        b->size = g->bin_size;
    } else {
        FXS_TRY((strncmp(uri, "data:", 5) == 0 ? open_data : open_beside)(g, b, index, uri));
        b->source = &b->own;
        b->size = b->own.input.size;
    }
    if (b->size < (uint64_t)size)
        return fxs_fail(g->message, "%s: buffer %d has %llu bytes, not %lld", g->source->path, index,
                        (unsigned long long)b->size, (long long)size);
    b->size = (uint64_t)size;
    return 0;
}

static int open_buffers(gltf *g)
{
    if (g->lists[BUFFERS].count > MAX_BUFFERS)
        return fxs_fail(g->message, "%s: more than %d buffers", g->source->path, MAX_BUFFERS);
    for (int i = 0; i < g->lists[BUFFERS].count; i++)
        FXS_TRY(open_buffer(g, i));
    return 0;
}

static int read_bytes(const gltf *g, const range *from, uint64_t offset, void *out, size_t size)
{
    const buffer *b = from->buffer;
    return fxs_scene_source_read(b->source, b->offset + from->offset + offset, out, size, g->message);
}

static buffer_view parse_buffer_view(const gltf *g, const cJSON *item)
{
    const cJSON *extensions = member(item, "extensions");
    int index = index_of(g, member(item, "buffer"), BUFFERS);
    int64_t offset = whole(member(item, "byteOffset"), 0), size = whole(member(item, "byteLength"), -1);
    buffer_view v = {{index < 0 ? NULL : &g->buffers[index], (uint64_t)offset, (uint64_t)size},
              whole(member(item, "byteStride"), 0), NULL};
    if (member(extensions, "EXT_meshopt_compression") || member(extensions, "KHR_meshopt_compression"))
        v.fault = "meshopt compression is not read";
    else if (index < 0 || offset < 0 || size < 0)
        v.fault = "no valid buffer, byteOffset and byteLength";
    else if (v.bytes.size > v.bytes.buffer->size || v.bytes.offset > v.bytes.buffer->size - v.bytes.size)
        v.fault = "not within its buffer";
    return v;
}

static int use_buffer_view(const gltf *g, int index, buffer_view *out)
{
    *out = g->views[index];
    return out->fault ? fail_item(g, "bufferView", index, out->fault) : 0;
}

/* Finds an attribute by its name or by its older draft name, such as _SCALE for KHR_gaussian_splatting:SCALE. */
static const cJSON *find_attribute(const cJSON *attributes, const char *name)
{
    const cJSON *found = member(attributes, name);
    const char *colon = strchr(name, ':');
    char draft[48];
    if (found || !colon)
        return found;
    snprintf(draft, sizeof draft, "_%s", colon + 1);
    return member(attributes, draft);
}

/* Masks of glTF component types. A type sets bit 2 * type if its values are not normalized, else bit 2 * type + 1. */
#define PLAIN(type) (1u << 2 * (type))
#define NORMALIZED(type) (2u << 2 * (type))

#define PLAIN_OR_NORMALIZED(type) (PLAIN(type) | NORMALIZED(type))

/* Types of the numbers of a POSITION. */
static unsigned position_types(const gltf *g)
{
    return PLAIN(FLOAT) | (g->is_quantized ? PLAIN_OR_NORMALIZED(BYTE) | PLAIN_OR_NORMALIZED(UBYTE) |
                                             PLAIN_OR_NORMALIZED(SHORT) | PLAIN_OR_NORMALIZED(USHORT) : 0);
}

static int find_elements(const gltf *g, int index, const cJSON *item, uint32_t count, uint32_t size, range *bytes,
                         uint32_t *stride)
{
    int view_index = index_of(g, member(item, "bufferView"), VIEWS);
    buffer_view v;
    if (view_index < 0)
        return fail_item(g, "accessor", index, "no valid bufferView");
    FXS_TRY(use_buffer_view(g, view_index, &v));
    int64_t offset = whole(member(item, "byteOffset"), 0), step = v.stride ? v.stride : size;
    if (step < size || step > MAX_STRIDE)
        return fail_item(g, "accessor", index, "no valid count or byteStride");
    uint64_t needed = (count - 1) * (uint64_t)step + size;
    if (offset < 0 || needed > v.bytes.size || (uint64_t)offset > v.bytes.size - needed)
        return fail_item(g, "accessor", index, "not within its bufferView");
    *bytes = (range){v.bytes.buffer, v.bytes.offset + (uint64_t)offset, needed};
    *stride = (uint32_t)step;
    return 0;
}

static int read_sparse(const gltf *g, int index, const cJSON *sparse, accessor *a)
{
    static const uint8_t sizes[] = {1, 0, 2, 0, 4};
    const cJSON *indices = member(sparse, "indices");
    const int64_t count = whole(member(sparse, "count"), -1);
    const int64_t type = whole(member(indices, "componentType"), -1) - 5120 - UBYTE;
    uint32_t strides[2];
    if (count < 1 || count > a->count || type < 0 || type > 4 || !sizes[type])
        return fail_item(g, "accessor", index, "no valid count or componentType in sparse");
    a->replaced = (uint32_t)count;
    a->index_size = sizes[type];
    FXS_TRY(find_elements(g, index, indices, a->replaced, a->index_size, &a->indices, &strides[0]));
    FXS_TRY(find_elements(g, index, member(sparse, "values"), a->replaced, a->size, &a->values, &strides[1]));
    return strides[0] == a->index_size && strides[1] == a->size ? 0
           : fail_item(g, "accessor", index, "a byteStride in sparse");
}

static int read_layout(const gltf *g, int index, const cJSON *item, accessor *a)
{
    const int64_t count = whole(member(item, "count"), -1);
    const cJSON *sparse = member(item, "sparse");
    if (count < 1 || count > MAX_COUNT)
        return fail_item(g, "accessor", index, "no valid count or byteStride");
    a->count = (uint32_t)count;
    a->stride = a->size;
    if (member(item, "bufferView"))
        FXS_TRY(find_elements(g, index, item, a->count, a->size, &a->bytes, &a->stride));
    return sparse ? read_sparse(g, index, sparse, a) : 0;
}

static int fail_indices(const gltf *g)
{
    return fail(g, "indices of a sparse accessor that do not ascend, or are beyond its elements");
}

static int replace_elements(gltf *g, accessor *a, uint32_t first, uint32_t end)
{
    uint8_t indices[4 * BATCH], values[BATCH * 16];
    const uint32_t left = a->replaced - a->at, count = left < end - first ? left : end - first;
    int64_t last = (int64_t)first - 1;
    if (!count)
        return 0;
    FXS_TRY(read_bytes(g, &a->indices, (uint64_t)a->at * a->index_size, indices, count * a->index_size));
    FXS_TRY(read_bytes(g, &a->values, (uint64_t)a->at * a->size, values, count * a->size));
    for (uint32_t i = 0; i < count; i++) {
        const uint8_t *at = indices + i * a->index_size;
        const uint32_t index = a->index_size == 1 ? *at : a->index_size == 2 ? fxs_load_u16(at) : fxs_load_u32(at);
        if (index <= last || index >= a->count)
            return fail_indices(g);
        if (index >= end)
            break;
        memcpy(g->bytes + (index - first) * a->stride, values + i * a->size, a->size);
        last = index;
        a->at++;
    }
    return end < a->count || a->at == a->replaced ? 0 : fail_indices(g);
}

/* Reads up to BATCH elements of an accessor into g->bytes. Calls must be in ascending order of elements. Set a->at to 0
   before the first call. */
static int read_elements(gltf *g, accessor *a, uint32_t first, uint32_t count)
{
    const size_t size = (count - 1) * a->stride + a->size;
    if (a->bytes.buffer)
        FXS_TRY(read_bytes(g, &a->bytes, (uint64_t)first * a->stride, g->bytes, size));
    else
        memset(g->bytes, 0, size);
    return replace_elements(g, a, first, first + count);
}

static int read_accessor(gltf *g, const cJSON *number, const char *name, int components, unsigned types, accessor *a)
{
    static const char *const shapes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    static const uint8_t sizes[] = {1, 1, 2, 2, 0, 4, 4};
    int index = index_of(g, number, ACCESSORS);
    if (index < 0)
        return fxs_fail(g->message, "%s: a primitive has no accessor for %s", g->source->path, name);
    const cJSON *item = g->lists[ACCESSORS].items[index];
    const char *shape = fxs_json_string(item, "type");
    int64_t type = whole(member(item, "componentType"), -1) - 5120;
    int is_normalized = cJSON_IsTrue(member(item, "normalized"));
    if (type < 0 || type > FLOAT || !(types >> (2 * type + is_normalized) & 1) || !shape ||
        strcmp(shape, shapes[components]) != 0)
        return fxs_fail(g->message, "%s: accessor %d: not of a type that %s may have", g->source->path, index, name);
    a->type = (uint8_t)type;
    a->is_normalized = (uint8_t)is_normalized;
    a->components = (uint8_t)components;
    a->size = (uint32_t)(sizes[type] * components);
    return read_layout(g, index, item, a);
}

static double component(const accessor *a, const uint8_t *bytes)
{
    switch (a->type) {
    case BYTE:   return a->is_normalized ? fmax((int8_t)bytes[0] / 127.0, -1) : (int8_t)bytes[0];
    case UBYTE:  return bytes[0] / (a->is_normalized ? 255.0 : 1);
    case SHORT:
        return a->is_normalized ? fmax((int16_t)fxs_load_u16(bytes) / 32767.0, -1) : (int16_t)fxs_load_u16(bytes);
    case USHORT: return fxs_load_u16(bytes) / (a->is_normalized ? 65535.0 : 1);
    default:     return fxs_load_float(bytes);
    }
}

static void store_colour(fxs_gaussian *gaussian, const double *rgba)
{
    gaussian->opacity = fxs_logit_of_opacity(rgba[3]);
    for (int i = 0; i < 3; i++)
        gaussian->dc[i] = fxs_dc_of_colour(rgba[i]);
}

static void store(const splats *s, fxs_gaussian *gaussian, int attribute, const double *v)
{
    if (attribute == OPACITY && s->attributes[OPACITY].components == 4)
        store_colour(gaussian, v);
    else if (attribute == OPACITY)
        gaussian->opacity = fxs_logit_of_opacity(v[0]);
    if (attribute == ROTATION)
        for (int i = 0; i < 4; i++)
            gaussian->rotation[i] = (float)v[(i + 3) % 4];   /* rotations in glTF are in the order x, y, z, w */
    if (attribute == ROTATION || attribute == OPACITY)
        return;
    float *out = attribute == POSITION ? gaussian->position : attribute == SCALE ? gaussian->scale
                 : attribute == SH ? gaussian->dc : gaussian->sh + 3 * (attribute - SH - 1);
    for (int i = 0; i < 3; i++)
        out[i] = attribute == SCALE && !s->has_log_scales ? fxs_log_scale(v[i]) : (float)v[i];
}

static int read_attributes(gltf *g, splats *s, fxs_gaussian *gaussians, size_t count)
{
    double values[4];
    memset(gaussians, 0, count * sizeof *gaussians);
    for (int i = 0; i < s->attribute_count; i++) {
        accessor *a = &s->attributes[i];
        uint32_t step = a->size / a->components;
        FXS_TRY(read_elements(g, a, g->next, (uint32_t)count));
        for (size_t k = 0; k < count; k++) {
            for (uint32_t c = 0; c < a->components; c++)
                values[c] = component(a, g->bytes + k * a->stride + c * step);
            store(s, &gaussians[k], i, values);
        }
    }
    return 0;
}

/* Converts linear light c to sRGB (IEC 61966-2-1): 12.92 c up to 0.0031308, else 1.055 c^(1 / 2.4) - 0.055. *slope
   becomes the derivative. */
static double srgb_of(double c, double *slope)
{
    *slope = 12.92;
    if (!(c > 0.0031308))
        return 12.92 * c;
    const double power = fxs_exp(fxs_log(c) / 2.4);
    *slope = 1.055 / 2.4 * power / c;
    return 1.055 * power - 0.055;
}

/* Converts the SH of degree 0 from linear light to sRGB. Higher SH are small changes, so they are multiplied by the
   conversion's derivative. */
static void turn_to_srgb(fxs_gaussian *gaussian, int sh_degree)
{
    for (int c = 0; c < 3; c++) {
        double slope;
        gaussian->dc[c] = fxs_dc_of_colour(srgb_of(fxs_colour_of_dc((double)gaussian->dc[c]), &slope));
        for (int k = 0; k < (sh_degree + 1) * (sh_degree + 1) - 1; k++)
            gaussian->sh[3 * k + c] = (float)(slope * (double)gaussian->sh[3 * k + c]);
    }
}

static int replace_opacities(gltf *g, splats *s, fxs_gaussian *gaussians, size_t count)
{
    accessor *a = &s->attributes[OPACITY];
    if (!a->count || !count)
        return 0;
    FXS_TRY(read_elements(g, a, g->next, (uint32_t)count));
    for (size_t k = 0; k < count; k++) {
        const float opacity = fxs_load_float(g->bytes + k * a->stride);
        if (opacity >= 0 && opacity < INFINITY)
            gaussians[k].opacity = fxs_logit_of_opacity((double)opacity);
    }
    return 0;
}

static int count_outside(gltf *g, accessor *a, float low, float high, uint64_t *outside)
{
    a->at = 0;
    for (uint32_t at = 0; at < a->count; at += BATCH) {
        const uint32_t count = a->count - at < BATCH ? a->count - at : BATCH;
        FXS_TRY(read_elements(g, a, at, count));
        for (uint32_t k = 0; k < count; k++) {
            int is_outside = 0;
            for (uint32_t c = 0; c < a->components; c++) {
                const float value = fxs_load_float(g->bytes + k * a->stride + 4 * c);
                is_outside |= value < low || value > high;
            }
            *outside += (uint64_t)is_outside;
        }
    }
    return 0;
}

static int read_sh(gltf *g, const cJSON *attributes, splats *s)
{
    char name[48];
    for (int degree = 0; degree <= 3; degree++) {
        snprintf(name, sizeof name, "KHR_gaussian_splatting:SH_DEGREE_%d_COEF_0", degree);
        if (degree > 0 && !find_attribute(attributes, name))
            break;
        s->sh_degree = degree;
        for (int k = 0; k <= 2 * degree; k++) {
            snprintf(name, sizeof name, "KHR_gaussian_splatting:SH_DEGREE_%d_COEF_%d", degree, k);
            FXS_TRY(read_accessor(g, find_attribute(attributes, name), name, 3, PLAIN(FLOAT),
                                  &s->attributes[SH + degree * degree + k]));
        }
    }
    s->attribute_count = SH + (s->sh_degree + 1) * (s->sh_degree + 1);
    s->stored_sh_degree = s->sh_degree;
    if (s->sh_degree == 3 && find_attribute(attributes, "KHR_gaussian_splatting:SH_DEGREE_4_COEF_0"))
        s->stored_sh_degree = 4;
    return 0;
}

static int read_colours(gltf *g, const cJSON *attributes, splats *s)
{
    static const char opacity[] = "KHR_gaussian_splatting:OPACITY";
    const unsigned types = PLAIN(FLOAT) | NORMALIZED(UBYTE) | NORMALIZED(USHORT);
    if (member(attributes, "COLOR_0") && !find_attribute(attributes, opacity) &&
        !find_attribute(attributes, "KHR_gaussian_splatting:SH_DEGREE_0_COEF_0")) {
        s->attribute_count = SH;
        return read_accessor(g, member(attributes, "COLOR_0"), "COLOR_0", 4, types, &s->attributes[OPACITY]);
    }
    FXS_TRY(read_accessor(g, find_attribute(attributes, opacity), opacity, 1, types, &s->attributes[OPACITY]));
    return read_sh(g, attributes, s);
}

static int fail_counts(const gltf *g)
{
    return fail(g, "the accessors of a primitive with Gaussians differ in count");
}

static int read_accessors(gltf *g, const cJSON *attributes, splats *s)
{
    static const struct { const char *name; int components; unsigned types; } core[OPACITY] = {
        {"POSITION", 3, 0},
        {"KHR_gaussian_splatting:ROTATION", 4, PLAIN(FLOAT) | NORMALIZED(BYTE) | NORMALIZED(SHORT)},
        {"KHR_gaussian_splatting:SCALE", 3, PLAIN(FLOAT) | PLAIN(UBYTE) | NORMALIZED(UBYTE) | PLAIN(USHORT) |
                                            NORMALIZED(USHORT) | PLAIN(BYTE) | NORMALIZED(BYTE) | PLAIN(SHORT) |
                                            NORMALIZED(SHORT)}
    };
    int has_data = 0;
    for (int i = 0; i < OPACITY; i++)
        FXS_TRY(read_accessor(g, find_attribute(attributes, core[i].name), core[i].name, core[i].components,
                              i == POSITION ? position_types(g) : core[i].types,
                              &s->attributes[i]));
    FXS_TRY(read_colours(g, attributes, s));
    s->count = s->attributes[POSITION].count;
    for (int i = 0; i < s->attribute_count; i++) {
        if (s->attributes[i].count != s->count)
            return fail_counts(g);
        has_data |= s->attributes[i].bytes.buffer || s->attributes[i].replaced == s->count;
    }
    return has_data ? 0 : fail(g, "no accessor of a primitive with Gaussians has data for each of them; it may be "
                               "compressed in a way that is not read");
}

/* Finds the opacities of the extension EXT_splat_opacity, version 1. Version 2 is ignored, because its .spz data
   contain the opacities. */
static int read_opacities(gltf *g, const cJSON *extensions, splats *s)
{
    static const char name[] = "EXT_splat_opacity";
    const cJSON *inner = member(member(extensions, "KHR_gaussian_splatting"), "extensions");
    const cJSON *found = member(inner, name) ? member(inner, name) : member(extensions, name);
    const cJSON *number = member(found, "opacityAccessor");
    s->is_clamped = member(found, "sourceOpacityAccessor") != NULL;
    return number ? read_accessor(g, number, name, 1, PLAIN(FLOAT), &s->attributes[OPACITY]) : 0;
}

static const cJSON *find_spz(const cJSON *extensions)
{
    static const char *const names[] = {
        "KHR_gaussian_splatting_compression_spz_2", "KHR_gaussian_splatting_compression_spz",
        "KHR_spz_gaussian_splats_compression"
    };
    const cJSON *inner = member(member(extensions, "KHR_gaussian_splatting"), "extensions"), *found = NULL;
    for (int i = 0; i < 3 && !found; i++) {
        found = member(inner, names[i]);
        found = found ? found : member(extensions, names[i]);
    }
    return found;
}

static int fail_parts(const gltf *g)
{
    return fxs_fail(g->message, "%s: more than %d primitives%s", g->source->path, MAX_PARTS,
                    g->sink ? "" : " with Gaussians");
}

static int same_range(const range *a, const range *b)
{
    return a->buffer == b->buffer && a->offset == b->offset && a->size == b->size;
}

static int is_same(const splats *a, const splats *b)
{
    const accessor *own = &a->attributes[OPACITY], *other = &b->attributes[OPACITY];
    return a->is_linear == b->is_linear && same_range(&a->spz, &b->spz) && same_range(&own->bytes, &other->bytes) &&
           same_range(&own->values, &other->values) && own->count == other->count;
}

static int check_splatting(const gltf *g, const cJSON *splatting, int *is_linear)
{
    enum { SPACES = 6, LINEAR = 3 };
    static const char *const spaces[SPACES] = {"srgb_rec709_display", "BT.709-sRGB", "BT.709",
                                               "lin_rec709_display", "BT.709-linear", "linear"};
    const char *kernel = fxs_json_string(splatting, "kernel"), *space = fxs_json_string(splatting, "colorSpace");
    const cJSON *position_scale = member(splatting, "quantizedPositionScale");
    size_t known = 0;
    if (kernel && strcmp(kernel, "ellipse") != 0)
        return fxs_fail(g->message, "%s: kernel \"%.40s\" is not read", g->source->path, kernel);
    while (space && known < SPACES && strcasecmp(space, spaces[known]) != 0)
        known++;
    if (known == SPACES)
        return fxs_fail(g->message, "%s: colorSpace \"%.40s\" is not read: expected %s or %s", g->source->path, space,
                        spaces[0], spaces[LINEAR]);
    *is_linear = known >= LINEAR;
    if (position_scale && !(cJSON_IsNumber(position_scale) && position_scale->valuedouble == 1))
        return fail(g, "a quantizedPositionScale (of a draft) is not read");
    return 0;
}

static void find_middle(const gltf *g, const cJSON *attributes, splats *s)
{
    const int index = index_of(g, member(attributes, "POSITION"), ACCESSORS);
    const cJSON *item = index < 0 ? NULL : g->lists[ACCESSORS].items[index];
    double low[3], high[3];
    if (!fxs_json_numbers(member(item, "min"), low, 3) || !fxs_json_numbers(member(item, "max"), high, 3))
        return;
    for (int k = 0; k < 3; k++) {
        const double middle = (low[k] + high[k]) / 2;
        s->middle[k] = fabs(middle) > high[k] - low[k] ? middle : 0;
    }
}

static int add_splats(gltf *g, splats **added)
{
    if (g->splats_count == MAX_PARTS)
        return fail_parts(g);
    splats *larger = grow(g, g->splats, g->splats_count, sizeof *g->splats);
    if (!larger)
        return FXS_ERR_MEMORY;
    g->splats = larger;
    *added = &g->splats[g->splats_count++];
    memset(*added, 0, sizeof **added);
    (*added)->first = g->splats_count - 1;
    return 0;
}

static int read_triangles(gltf *g, const cJSON *primitive)
{
    const int64_t mode = whole(member(primitive, "mode"), TRIANGLES);
    const cJSON *indices = member(primitive, "indices");
    splats *added;
    if (mode < TRIANGLES || mode > FAN) {
        g->other = "points or lines without triangles";
        return 0;
    }
    if (member(member(primitive, "extensions"), "KHR_draco_mesh_compression"))
        return fail(g, "a mesh with Draco compression is not read: export it without compression");
    FXS_TRY(add_splats(g, &added));
    added->mode = (int)mode;
    FXS_TRY(read_accessor(g, member(member(primitive, "attributes"), "POSITION"), "POSITION", 3, position_types(g),
                          &added->attributes[POSITION]));
    added->count = added->attributes[POSITION].count;
    if (indices)
        FXS_TRY(read_accessor(g, indices, "indices", 1, PLAIN(UBYTE) | PLAIN(USHORT) | PLAIN(UINT), &added->indices));
    return added->attributes[POSITION].bytes.buffer && (!indices || added->indices.bytes.buffer) ? 0
           : fail(g, "a mesh whose accessors have no bufferView");
}

static int read_primitive(gltf *g, const cJSON *primitive)
{
    const cJSON *extensions = member(primitive, "extensions"), *spz = find_spz(extensions);
    const cJSON *splatting = member(extensions, "KHR_gaussian_splatting");
    if (g->sink)
        return read_triangles(g, primitive);
    if (!spz && !splatting) {
        const cJSON *mode = member(primitive, "mode");
        g->other = cJSON_IsNumber(mode) && mode->valuedouble == 0 ? FXS_POINT_CLOUD : FXS_MESH;
        return 0;
    }
    int is_linear = 0;
    splats *added;
    FXS_TRY(check_splatting(g, splatting, &is_linear));
    FXS_TRY(add_splats(g, &added));
    added->is_linear = is_linear;
    find_middle(g, member(primitive, "attributes"), added);
    if (!spz)
        return read_accessors(g, member(primitive, "attributes"), added);
    int view_index = index_of(g, member(spz, "bufferView"), VIEWS);
    buffer_view v;
    if (view_index < 0)
        return fail(g, "an .spz without a valid bufferView");
    FXS_TRY(use_buffer_view(g, view_index, &v));
    FXS_TRY(read_opacities(g, extensions, added));
    added->spz = v.bytes;
    for (added->first = 0; !is_same(&g->splats[added->first], added);)
        added->first++;
    return 0;
}

static int read_mesh(gltf *g, int index)
{
    mesh *m = &g->meshes[index];
    const cJSON *primitive;
    if (m->is_read)
        return 0;
    m->is_read = 1;
    m->first = g->splats_count;
    cJSON_ArrayForEach(primitive, member(g->lists[MESHES].items[index], "primitives"))
        FXS_TRY(read_primitive(g, primitive));
    m->end = g->splats_count;
    return 0;
}

static int place_mesh(gltf *g, int index, double rows[3][4])
{
    FXS_TRY(read_mesh(g, index));
    for (int i = g->meshes[index].first; i < g->meshes[index].end; i++) {
        if (g->parts_count == MAX_PARTS)
            return fail_parts(g);
        part *larger = grow(g, g->parts, g->parts_count, sizeof *g->parts);
        if (!larger)
            return FXS_ERR_MEMORY;
        g->parts = larger;
        part *added = &g->parts[g->parts_count++];
        added->splats = g->splats[i].first;
        memcpy(added->rows, rows, sizeof added->rows);
    }
    return 0;
}

static int take_numbers(const cJSON *object, const char *name, double *out, int count)
{
    const cJSON *item = member(object, name);
    return !item || fxs_json_numbers(item, out, count);
}

static int local_matrix(const gltf *g, int index, double m[16])
{
    const cJSON *node = g->lists[NODES].items[index];
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    memset(m, 0, 16 * sizeof *m);
    if (member(node, "matrix")) {
        if (!take_numbers(node, "matrix", m, 16) || m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
            return fail_item(g, "node", index, "not a matrix of 16 numbers with a last row of 0 0 0 1");
        return 0;
    }
    if (!take_numbers(node, "translation", t, 3) || !take_numbers(node, "rotation", q, 4) ||
        !take_numbers(node, "scale", s, 3))
        return fail_item(g, "node", index, "not 3 numbers in translation or scale, or 4 in rotation");
    const double x = q[0], y = q[1], z = q[2], w = q[3], k = 2 / (x * x + y * y + z * z + w * w);
    const double made[16] = {
        s[0] * (1 - k * (y * y + z * z)), s[0] * k * (x * y + w * z), s[0] * k * (x * z - w * y), 0,
        s[1] * k * (x * y - w * z), s[1] * (1 - k * (x * x + z * z)), s[1] * k * (y * z + w * x), 0,
        s[2] * k * (x * z + w * y), s[2] * k * (y * z - w * x), s[2] * (1 - k * (x * x + y * y)), 0,
        t[0], t[1], t[2], 1};
    memcpy(m, made, sizeof made);
    return 0;
}

static int visit(gltf *g, const cJSON *item, double parent[3][4], int depth)
{
    int index = index_of(g, item, NODES);
    double m[16], rows[3][4];
    const cJSON *child;
    if (index < 0)
        return fail(g, "a node that does not exist");
    if (depth > MAX_DEPTH || g->visited[index]++)
        return fail_item(g, "node", index, depth > MAX_DEPTH ? "nested too deep" : "reached twice");
    FXS_TRY(local_matrix(g, index, m));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            rows[i][j] = parent[i][0] * m[4 * j] + parent[i][1] * m[4 * j + 1] + parent[i][2] * m[4 * j + 2] +
                         parent[i][3] * m[4 * j + 3];
    const cJSON *node = g->lists[NODES].items[index], *mesh_item = member(node, "mesh");
    int mesh_index = index_of(g, mesh_item, MESHES);
    if (mesh_item && mesh_index < 0)
        return fail_item(g, "node", index, "a mesh that does not exist");
    if (g->sink && member(member(node, "extensions"), "EXT_mesh_gpu_instancing"))
        return fail_item(g, "node", index, "instances of a mesh (EXT_mesh_gpu_instancing) are not read");
    if (mesh_item)
        FXS_TRY(place_mesh(g, mesh_index, rows));
    cJSON_ArrayForEach(child, member(node, "children"))
        FXS_TRY(visit(g, child, rows, depth + 1));
    return 0;
}

static int open_spz(gltf *g, int index)
{
    splats *s = &g->splats[index];
    const buffer *b = s->spz.buffer;
    fxs_scene_file_info info;
    FXS_TRY(fxs_spz_open(b->source, b->offset + s->spz.offset, s->spz.size, FXS_AXES_RDF, &s->opened, &info,
                         g->message));
    s->count = (uint32_t)info.count;
    s->sh_degree = info.sh_degree;
    s->stored_sh_degree = info.stored_sh_degree;
    s->antialiased = info.antialiased;
    return !s->attributes[OPACITY].count || s->attributes[OPACITY].count == s->count ? 0 : fail_counts(g);
}

int fxs_gltf_drop(void *handle)
{
    gltf *g = handle;
    for (int i = g->splats_count; i-- > 0;)
        if (g->splats[i].opened && g->splats[i].opened != g->spz && fxs_spz_drop(g->splats[i].opened))
            return 1;
    return 0;
}

static int enter(gltf *g, int index)
{
    g->part = g->parts_count;
    g->next = 0;
    g->spz = NULL;
    if (index == g->parts_count)
        return 0;
    part *p = &g->parts[index];
    splats *s = &g->splats[p->splats];
    if (fxs_transform_init(&g->transform, p->rows))
        return fail(g, "a node's transform has no inverse");
    for (int i = 0; i < 3; i++)
        g->transform.shift[i] -= g->source->import->origin[i];
    if (s->spz.buffer) {
        if (!s->opened)
            FXS_TRY(open_spz(g, p->splats));
        g->spz = s->opened;
        fxs_spz_rewind(g->spz);
    }
    for (int i = 0; i < ATTRIBUTES; i++)
        s->attributes[i].at = 0;
    g->part = index;
    return 0;
}

/* Decides if scales are logarithms, as in a draft, or linear, as in the standard. Signed integers are logarithms.
   Floats are logarithms if a quarter of the Gaussians have a negative scale. */
static int find_log_scales(gltf *g)
{
    uint64_t below = 0, count = 0;
    for (int i = 0; i < g->parts_count; i++) {
        splats *s = &g->splats[g->parts[i].splats];
        accessor *a = &s->attributes[SCALE];
        if (s->spz.buffer || a->type != FLOAT || s->scales_known++)
            continue;
        count += a->count;
        FXS_TRY(count_outside(g, a, 0, INFINITY, &below));
    }
    for (int i = 0; i < g->splats_count; i++) {
        splats *s = &g->splats[i];
        const int type = s->attributes[SCALE].type;
        s->has_log_scales = !s->spz.buffer && (type == BYTE || type == SHORT ||
                                               (type == FLOAT && below > 0 && below >= (count + 3) / 4));
    }
    return 0;
}

/* Finds Gaussians with opacities above 1.0001, which are reported as clamped. Smaller excesses are rounding errors. */
static int find_clamped(gltf *g)
{
    uint64_t above;
    for (int i = 0; i < g->splats_count; i++) {
        splats *s = &g->splats[i];
        accessor *a = &s->attributes[OPACITY];
        if (s->first != i || a->components != 1 || a->type != FLOAT)
            continue;
        above = 0;
        FXS_TRY(count_outside(g, a, -INFINITY, 1.0001f, &above));
        s->is_clamped |= above > 0;
    }
    return 0;
}

static void place_of(const gltf *g, const part *p, double place[3])
{
    const double *m = g->splats[p->splats].middle;
    for (int k = 0; k < 3; k++)
        place[k] = p->rows[k][0] * m[0] + p->rows[k][1] * m[1] + p->rows[k][2] * m[2] + p->rows[k][3];
}

static void choose_origin(const gltf *g, fxs_scene_file_info *info)
{
    fxs_import *import = g->source->import;
    double place[3];
    uint32_t most = 0;
    for (int i = 0; i < g->parts_count && !import->moves; i++) {
        const part *p = &g->parts[i];
        const uint32_t count = g->splats[p->splats].count;
        if (count <= most)
            continue;
        most = count;
        place_of(g, p, place);
        fxs_origin_near(import->origin, place);
    }
    import->moves |= most > 0;
    for (int i = 0; i < g->parts_count; i++) {
        place_of(g, &g->parts[i], place);
        info->coarse = fmax(info->coarse, fxs_spacing_at(place, import->origin));
    }
}

static int describe(gltf *g, fxs_scene_file_info *info)
{
    info->count = 0;
    info->sh_degree = info->stored_sh_degree = info->antialiased = 0;
    info->linear_light = info->log_scales = info->clamped_opacity = 0;
    for (int i = 0; i < g->parts_count; i++) {
        FXS_TRY(enter(g, i));
        const splats *s = &g->splats[g->parts[i].splats];
        info->count += s->count;
        info->sh_degree = s->sh_degree > info->sh_degree ? s->sh_degree : info->sh_degree;
        if (s->stored_sh_degree > info->stored_sh_degree)
            info->stored_sh_degree = s->stored_sh_degree;
        info->antialiased |= s->antialiased;
        info->linear_light |= s->is_linear;
    }
    if (info->count > MAX_COUNT)
        return fxs_fail(g->message, "%s: more than %d Gaussians", g->source->path, MAX_COUNT);
    FXS_TRY(fxs_limit_gaussians(g->source, info->count, g->message));
    FXS_TRY(find_log_scales(g));
    FXS_TRY(find_clamped(g));
    for (int i = 0; i < g->parts_count; i++) {
        info->log_scales |= g->splats[g->parts[i].splats].has_log_scales;
        info->clamped_opacity |= g->splats[g->parts[i].splats].is_clamped;
    }
    info->coarse = 0;
    choose_origin(g, info);
    return enter(g, 0);
}

static int find_chunks(gltf *g, uint64_t *offset, uint64_t *size)
{
    uint8_t h[20], chunk[8];
    *offset = 0;
    *size = g->source->input.size;
    if (*size < sizeof h)
        return fail(g, "the file ends early");
    FXS_TRY(fxs_scene_source_read(g->source, 0, h, sizeof h, g->message));
    if (memcmp(h, "glTF", 4) != 0)
        return 0;
    const uint64_t length = fxs_load_u32(h + 8), json = fxs_load_u32(h + 12);
    if (fxs_load_u32(h + 4) != 2)
        return fxs_fail(g->message, "%s: glTF version %u, not 2", g->source->path, fxs_load_u32(h + 4));
    if (length > *size || length < sizeof h || json > length - sizeof h)
        return fail(g, "the file ends early");
    if (memcmp(h + 16, "JSON", 4) != 0)
        return fail(g, "the first chunk is not JSON");
    *offset = sizeof h;
    *size = json;
    g->bin_offset = sizeof h + json + sizeof chunk;
    if (length < g->bin_offset)
        return 0;
    FXS_TRY(fxs_scene_source_read(g->source, sizeof h + json, chunk, sizeof chunk, g->message));
    g->bin_size = memcmp(chunk + 4, "BIN", 4) == 0 ? fxs_load_u32(chunk) : 0;
    return g->bin_size > length - g->bin_offset ? fail(g, "the file ends early") : 0;
}

static int read_root(gltf *g, const cJSON *root)
{
    const char *version = fxs_json_string(member(root, "asset"), "version");
    if (!version || strncmp(version, "2.", 2) != 0)
        return fail(g, "not glTF 2: no such version in \"asset\"");
    for (int i = 0; i < LISTS; i++)
        FXS_TRY(make_list(g, root, i));
    g->meshes = allocate(g, (size_t)g->lists[MESHES].count, sizeof *g->meshes);
    g->visited = allocate(g, (size_t)g->lists[NODES].count, 1);
    g->views = allocate(g, (size_t)g->lists[VIEWS].count, sizeof *g->views);
    if (!g->meshes || !g->visited || !g->views)
        return FXS_ERR_MEMORY;
    const cJSON *used;
    cJSON_ArrayForEach(used, member(root, "extensionsUsed"))
        g->is_quantized |= cJSON_IsString(used) && !strcmp(used->valuestring, "KHR_mesh_quantization");
    FXS_TRY(open_buffers(g));
    for (int i = 0; i < g->lists[VIEWS].count; i++)
        g->views[i] = parse_buffer_view(g, g->lists[VIEWS].items[i]);
    int64_t scene = whole(member(root, "scene"), 0);
    const cJSON *node, *nodes = scene < 0 || scene > MAX_PARTS ? NULL
                                : member(cJSON_GetArrayItem(member(root, "scenes"), (int)scene), "nodes");
    cJSON_ArrayForEach(node, nodes)
        FXS_TRY(visit(g, node, g->frame, 0));
    return 0;
}

static int read_json(gltf *g)
{
    uint64_t offset, size;
    fxs_text text;
    FXS_TRY(find_chunks(g, &offset, &size));
    FXS_TRY(fxs_scene_source_load(g->source, offset, size, &text, g->message));
    cJSON *root;
    int result = fxs_json_parse(&text, g->source, &root, g->message);
    fxs_text_let_go(g->source, &text);
    if (result == 0)
        result = read_root(g, root);
    cJSON_Delete(root);
    return result;
}

static void free_json(gltf *g)
{
    for (int i = 0; i < LISTS; i++)
        release(g, g->lists[i].items);
    release(g, g->views);
    release(g, g->meshes);
    release(g, g->visited);
}

int fxs_gltf_open(void *handle, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message)
{
    gltf *g = handle;
    g->source = source;
    g->message = message;
    memcpy(g->frame, frame, sizeof g->frame);
    int result = read_json(g);
    free_json(g);
    return result ? result : describe(g, info);
}

static int gltf_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    double frame[3][4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}};
    gltf *g = handle;
    source->import->drop = fxs_gltf_drop;
    source->import->reader = g;
    FXS_TRY(fxs_gltf_open(g, source, frame, info, message));
    return g->parts_count ? 0 : fxs_fail(message, "%s: no primitive with KHR_gaussian_splatting in the scene%s%s",
                                         source->path, g->other ? ", which is " : "", g->other ? g->other : "");
}

static long gltf_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    gltf *g = handle;
    size_t done = 0;
    g->message = message;
    while (done < capacity && g->part < g->parts_count) {
        splats *s = &g->splats[g->parts[g->part].splats];
        size_t left = s->count - g->next, count = capacity - done;
        count = count < left ? count : left;
        count = count < BATCH ? count : BATCH;
        if (s->spz.buffer) {
            FXS_TRY((int)fxs_spz_read(g->spz, gaussians + done, count, message));
            FXS_TRY(replace_opacities(g, s, gaussians + done, count));
        } else if (count > 0)
            FXS_TRY(read_attributes(g, s, gaussians + done, count));
        for (size_t i = 0; i < count; i++) {
            if (s->is_linear)
                turn_to_srgb(&gaussians[done + i], s->sh_degree);
            fxs_transform_apply(&g->transform, &gaussians[done + i], s->sh_degree);
        }
        done += count;
        g->next += (uint32_t)count;
        if (g->next == s->count)
            FXS_TRY(enter(g, g->part + 1));
    }
    return (long)done;
}

static int gltf_rewind(void *handle, fxs_message *message)
{
    gltf *g = handle;
    g->message = message;
    return enter(g, 0);
}

static void gltf_close(void *handle)
{
    gltf *g = handle;
    for (int i = 0; i < g->splats_count; i++)
        fxs_spz_close(g->splats[i].opened);   /* .spz data are closed before the buffers that they are read from */
    for (int i = 0; i < MAX_BUFFERS; i++) {
        fxs_scene_source_close(&g->buffers[i].own);
        fxs_let_go(g->source, g->buffers[i].memory, g->buffers[i].memory_size);
    }
    release(g, g->splats);
    release(g, g->parts);
}

/* ---- Triangles --------------------------------------------------------------------------------------------------- */

static int put_vertices(gltf *g, const part *p, splats *s)
{
    accessor *a = &s->attributes[POSITION];
    const uint32_t step = a->size / a->components;
    a->at = 0;
    for (uint32_t first = 0; first < a->count; first += BATCH) {
        const uint32_t count = a->count - first < BATCH ? a->count - first : BATCH;
        FXS_TRY(read_elements(g, a, first, count));
        for (uint32_t k = 0; k < count; k++) {
            double at[3], from[3];
            for (uint32_t c = 0; c < 3; c++)
                from[c] = component(a, g->bytes + k * a->stride + c * step);
            for (int i = 0; i < 3; i++)
                at[i] = p->rows[i][0] * from[0] + p->rows[i][1] * from[1] + p->rows[i][2] * from[2] + p->rows[i][3];
            FXS_TRY(g->sink->vertex(g->sink->argument, at, g->message));
        }
    }
    return 0;
}

static int is_mirrored(const part *p)
{
    double determinant = 0;
    for (int i = 0; i < 3; i++)
        determinant += p->rows[0][i] * (p->rows[1][(i + 1) % 3] * p->rows[2][(i + 2) % 3] -
                                        p->rows[1][(i + 2) % 3] * p->rows[2][(i + 1) % 3]);
    return determinant < 0;
}

/* Takes vertex `vertex` as index i of a primitive. corners: the last two vertices, in a fan the first and the last. */
static int put_corner(const gltf *g, int mode, uint32_t i, uint32_t vertex, int is_turned, uint32_t corners[3])
{
    corners[mode == TRIANGLES ? i % 3 : i < 2 ? i : 2] = vertex;
    if (mode == TRIANGLES ? i % 3 < 2 : i < 2)
        return 0;
    is_turned ^= mode == STRIP && i % 2;
    const uint32_t turned[3] = {corners[is_turned], corners[!is_turned], corners[2]};
    if (mode == STRIP)
        corners[0] = corners[1];
    if (mode != TRIANGLES)
        corners[1] = vertex;
    return g->sink->triangle(g->sink->argument, turned, g->message);
}

/* The vertices of the primitive have numbers from `base` on. */
static int put_triangles(gltf *g, const part *p, splats *s, uint32_t base)
{
    accessor *a = &s->indices;
    const uint32_t all = a->count ? a->count : s->count;
    const int is_turned = is_mirrored(p);
    uint32_t corners[3] = {0};
    a->at = 0;
    for (uint32_t first = 0; first < all; first += BATCH) {
        const uint32_t count = all - first < BATCH ? all - first : BATCH;
        if (a->count)
            FXS_TRY(read_elements(g, a, first, count));
        for (uint32_t k = 0; k < count; k++) {
            const uint8_t *at = g->bytes + k * a->stride;
            const uint32_t vertex = !a->count ? first + k : a->type == UBYTE ? *at
                                    : a->type == USHORT ? fxs_load_u16(at) : fxs_load_u32(at);
            if (vertex >= s->count)
                return fail(g, "an index of a mesh beyond its vertices");
            FXS_TRY(put_corner(g, s->mode, first + k, base + vertex, is_turned, corners));
        }
    }
    return 0;
}

/* Primitives of a node often share their vertices, which are then put once. */
static int shares_vertices(const gltf *g, int i)
{
    const part *p = &g->parts[i], *before = p - 1;
    return i > 0 && !memcmp(p->rows, before->rows, sizeof p->rows) &&
           same_range(&g->splats[p->splats].attributes[POSITION].bytes,
                      &g->splats[before->splats].attributes[POSITION].bytes) &&
           g->splats[p->splats].count == g->splats[before->splats].count;
}

static int put_parts(gltf *g)
{
    uint64_t base = 0, end = 0;
    for (int i = 0; i < g->parts_count; i++) {
        splats *s = &g->splats[g->parts[i].splats];
        if (!shares_vertices(g, i)) {
            base = end;
            end += s->count;
            if (end > MAX_COUNT)
                return fxs_fail(g->message, "%s: more than %d vertices", g->source->path, MAX_COUNT);
            FXS_TRY(put_vertices(g, &g->parts[i], s));
        }
        FXS_TRY(put_triangles(g, &g->parts[i], s, (uint32_t)base));
    }
    return 0;
}

int fxs_gltf_triangles(const fxs_scene_source *source, const fxs_triangle_sink *sink, fxs_message *message)
{
    gltf *g = fxs_allocate_zeroed(source->options.allocator, 1, sizeof *g);
    if (!g)
        return fxs_fail_memory(message, source->path, sizeof *g);
    g->source = source;
    g->message = message;
    g->sink = sink;
    for (int i = 0; i < 3; i++)
        g->frame[i][i] = 1;
    int result = read_json(g);
    free_json(g);
    result = result ? result : put_parts(g);
    if (!result && !g->parts_count)
        result = fxs_fail(message, "%s: no mesh in the scene%s%s", source->path, g->other ? ", which has " : "",
                          g->other ? g->other : "");
    gltf_close(g);
    fxs_release(source->options.allocator, g);
    return result;
}

#define READER_SIZE sizeof(gltf)

#else

int fxs_gltf_triangles(const fxs_scene_source *source, const fxs_triangle_sink *sink, fxs_message *message)
{
    (void)sink;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read glTF: built without cJSON", source->path);
}

static int gltf_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle;
    (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read glTF: built without cJSON", source->path);
}

#define READER_SIZE 0
#define gltf_read NULL
#define gltf_rewind NULL
#define gltf_close NULL

#endif

/* Returns 1 if a JSON object with the first member `name` may be a glTF file. */
static int is_gltf_name(const char *name)
{
    static const char *const names[] = {
        "accessors\"", "animations\"", "asset\"", "buffers\"", "bufferViews\"", "cameras\"", "extensions", "extras\"",
        "images\"", "materials\"", "meshes\"", "nodes\"", "samplers\"", "scene\"", "scenes\"", "skins\"", "textures\""
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strncmp(name, names[i], strlen(names[i])) == 0)
            return !strstr(name, "\"means\"") && !strstr(name, "\"lodLevels\"");
    return 0;
}

static int is_gltf(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, "glTF", 4) || (head->name && is_gltf_name(head->name));
}

const fxs_reader fxs_read_gltf = {is_gltf, READER_SIZE, gltf_open, gltf_read, gltf_rewind, gltf_close, NULL};
