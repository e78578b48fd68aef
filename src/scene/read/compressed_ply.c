/* Reads PlayCanvas's compressed .ply. Its 32-bit words code Gaussians relative to the bounds of their chunk of 256
   Gaussians. Layout: gsplat-compressed-data.js of PlayCanvas's engine. */
#include <fixsplat/internal/allocator.h>

#include "ply_header.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

enum { CHUNK = 256, WORDS = 4 };

enum { POSITION = 0, SCALE = 6, COLOUR = 12, BOUNDS = 18 };

static const char *const bound_names[BOUNDS] = {
    "min_x", "min_y", "min_z", "max_x", "max_y", "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r", "min_g", "min_b", "max_r", "max_g", "max_b"
};

static const char *const word_names[WORDS] = {"packed_position", "packed_rotation", "packed_scale", "packed_color"};

typedef struct rows {
    const fxs_ply_element *element;
    uint64_t start;
    int columns;
    uint32_t column[FXS_PLY_MAX_REST];
    fxs_byte_reader bytes;
} rows;

typedef struct compressed_reader {
    fxs_ply_header header;
    int sh_degree, stored_sh_degree;
    uint64_t read;
    float bounds[BOUNDS];
    rows chunk, vertex, sh;   /* ranges of rows in the file; sh.element null: the file has only SH of degree 0 */
} compressed_reader;

static int is_compressed_ply(const fxs_head *head, fxs_message *message)
{
    const fxs_scene_source *source = head->source;
    struct { fxs_ply_header header; fxs_byte_reader bytes; } *start;
    fxs_message ignored;
    if (memcmp(head->bytes, "ply", 3))
        return 0;
    start = fxs_allocate_zeroed(source->options.allocator, 1, sizeof *start);
    if (!start)
        return fxs_fail_memory(message, source->path, sizeof *start);
    const fxs_ply_header *header = &start->header;
    start->bytes.source = source;
    int is_compressed = fxs_ply_read_header(&start->header, &start->bytes, &ignored) == 0
                        && fxs_ply_find(header, fxs_ply_find_element(header, "vertex"), word_names[0]) >= 0;
    fxs_release(source->options.allocator, start);
    return is_compressed;
}

static int add_column(const fxs_ply_header *header, rows *r, int index, int type, const char *name,
                      fxs_message *message)
{
    if (index < 0 || header->property_table[index].type != type)
        return fxs_fail(message, "%s: element %s has no property %s of type %s", r->bytes.source->path,
                        r->element->name, name, fxs_ply_types[type].name);
    r->column[r->columns++] = header->property_table[index].offset;
    return 0;
}

static int add_columns(const fxs_ply_header *header, rows *r, const char *const *names, int count, int type,
                       fxs_message *message)
{
    for (int i = 0; i < count; i++)
        FXS_TRY(add_column(header, r, fxs_ply_find(header, r->element, names[i]), type, names[i], message));
    return 0;
}

/* Finds the properties with the bounds of a chunk (256 Gaussians). Older files lack the bounds of the colour, which
   are then 0 and 1. */
static int add_bounds(compressed_reader *reader, fxs_message *message)
{
    int has_colour = fxs_ply_find(&reader->header, reader->chunk.element, bound_names[COLOUR]) >= 0;
    for (int i = COLOUR + 3; i < BOUNDS; i++)
        reader->bounds[i] = 1;
    return add_columns(&reader->header, &reader->chunk, bound_names, has_colour ? BOUNDS : COLOUR, FXS_PLY_FLOAT,
                       message);
}

static int add_sh(compressed_reader *reader, fxs_message *message)
{
    const fxs_ply_header *header = &reader->header;
    rows *sh = &reader->sh;
    int rest[FXS_PLY_MAX_REST];
    if (!sh->element)
        return 0;
    int degree = fxs_ply_find_rest(header, sh->element, rest, sh->bytes.source->path, message);
    if (degree < 0)
        return degree;
    reader->sh_degree = degree < 3 ? degree : 3;
    reader->stored_sh_degree = degree;
    for (int i = 0; i < 3 * reader->sh_degree * (reader->sh_degree + 2); i++)
        FXS_TRY(add_column(header, sh, rest[i], FXS_PLY_UCHAR, header->property_table[rest[i]].name, message));
    return 0;
}

static int check_elements(const compressed_reader *reader, const char *path, fxs_message *message)
{
    const fxs_ply_header *header = &reader->header;
    uint64_t count = reader->vertex.element->count;
    for (int i = 0; i < header->elements; i++)
        if (header->element_table[i].has_lists)
            return fxs_fail(message, "%s: element %s has lists", path, header->element_table[i].name);
    if (!reader->chunk.element)
        return fxs_fail(message, "%s: the header has no element chunk", path);
    if (reader->chunk.element->count != (count + CHUNK - 1) / CHUNK)
        return fxs_fail(message, "%s: %llu chunks for %llu Gaussians, not one for every %d", path,
                        (unsigned long long)reader->chunk.element->count, (unsigned long long)count, CHUNK);
    if (reader->sh.element && reader->sh.element->count != count)
        return fxs_fail(message, "%s: SH coefficients for %llu of %llu Gaussians", path,
                        (unsigned long long)reader->sh.element->count, (unsigned long long)count);
    return 0;
}

static void find_start(const fxs_ply_header *header, uint64_t body, rows *r)
{
    r->start = body;
    for (const fxs_ply_element *e = header->element_table; r->element && e < r->element; e++)
        r->start += e->count * e->row_size;
}

static int compressed_rewind(void *handle, fxs_message *message)
{
    compressed_reader *reader = handle;
    rows *all[] = {&reader->chunk, &reader->vertex, &reader->sh};
    reader->read = 0;
    for (int i = 0; i < 3; i++)
        if (fxs_bytes_seek(&all[i]->bytes, all[i]->start) != 0)
            return fxs_fail(message, "%s: %s", all[i]->bytes.source->path, all[i]->bytes.fault);
    return 0;
}

static int open_reader(compressed_reader *reader, const char *path, fxs_message *message)
{
    fxs_ply_header *header = &reader->header;
    fxs_byte_reader *bytes = &reader->vertex.bytes;
    FXS_TRY(fxs_ply_read_header(header, bytes, message));
    reader->chunk.element = fxs_ply_find_element(header, "chunk");
    reader->vertex.element = fxs_ply_find_element(header, "vertex");
    reader->sh.element = fxs_ply_find_element(header, "sh");
    if (header->encoding != FXS_PLY_LITTLE_ENDIAN)
        return fxs_fail(message, "%s: a compressed .ply that is not binary_little_endian", path);
    FXS_TRY(check_elements(reader, path, message));
    FXS_TRY(add_bounds(reader, message));
    FXS_TRY(add_columns(header, &reader->vertex, word_names, WORDS, FXS_PLY_UINT, message));
    FXS_TRY(add_sh(reader, message));
    FXS_TRY(fxs_ply_check_size(header, bytes, message));
    uint64_t body = fxs_bytes_tell(bytes);
    find_start(header, body, &reader->chunk);
    find_start(header, body, &reader->vertex);
    find_start(header, body, &reader->sh);
    return compressed_rewind(reader, message);
}

static int compressed_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info,
                           fxs_message *message)
{
    compressed_reader *reader = handle;
    reader->chunk.bytes.source = reader->vertex.bytes.source = reader->sh.bytes.source = source;
    FXS_TRY(open_reader(reader, source->path, message));
    info->count = reader->vertex.element->count;
    info->sh_degree = reader->sh_degree;
    info->stored_sh_degree = reader->stored_sh_degree;
    info->antialiased = reader->header.antialiased;
    return 0;
}

static double unpack(uint32_t word, int shift, int bits)
{
    uint32_t mask = (1u << bits) - 1;
    return (word >> shift & mask) / (double)mask;
}

static double between(const float *bounds, int low, double t)
{
    return (double)bounds[low] * (1 - t) + (double)bounds[low + 3] * t;
}

/* Decodes a quaternion w, x, y, z from its three smallest components, which are within +-1/sqrt(2). The largest
   component is not stored and is positive. */
static void decode_rotation(uint32_t word, float rotation[4])
{
    int largest = (int)(word >> 30);
    double rest = 1;
    for (int i = 0, shift = 20; i < 4; i++) {
        if (i == largest)
            continue;
        double component = (unpack(word, shift, 10) - 0.5) * 1.4142135623730951;
        rotation[i] = (float)component;
        rest -= component * component;
        shift -= 10;
    }
    rotation[largest] = (float)sqrt(fmax(0, rest));
}

static void decode_words(const compressed_reader *reader, const uint8_t *row, fxs_gaussian *gaussian)
{
    static const int shifts[3] = {21, 11, 0}, bits[3] = {11, 10, 11};
    uint32_t words[WORDS];
    for (int i = 0; i < WORDS; i++)
        words[i] = fxs_load_u32(row + reader->vertex.column[i]);
    for (int i = 0; i < 3; i++) {
        gaussian->position[i] = (float)between(reader->bounds, POSITION + i, unpack(words[0], shifts[i], bits[i]));
        gaussian->scale[i] = (float)between(reader->bounds, SCALE + i, unpack(words[2], shifts[i], bits[i]));
        gaussian->dc[i] = fxs_dc_of_colour(between(reader->bounds, COLOUR + i, unpack(words[3], 24 - 8 * i, 8)));
    }
    decode_rotation(words[1], gaussian->rotation);
    gaussian->opacity = fxs_logit_of_code(words[3] & 255);
}

/* Decodes an SH coefficient from a code of 8 bits. Codes 0 and 255 mean -4 and 4. Other codes mean the centre of one of
   256 equal parts of the range -4 to 4. */
static float decode_coefficient(int code)
{
    return code == 0 ? -4 : code == 255 ? 4 : (float)(((code + 0.5) / 256 - 0.5) * 8);
}

static const uint8_t *next_row(rows *r, uint64_t index, fxs_message *message)
{
    const uint8_t *row = fxs_bytes_take(&r->bytes, r->element->row_size);
    if (!row)
        fxs_bytes_fail_row(&r->bytes, r->element->name, index, r->element->count, message);
    return row;
}

static int read_gaussian(compressed_reader *reader, fxs_gaussian *gaussian, fxs_message *message)
{
    const uint8_t *row;
    if (reader->read % CHUNK == 0) {
        if (!(row = next_row(&reader->chunk, reader->read / CHUNK, message)))
            return FXS_ERR_FILE;
        for (int i = 0; i < reader->chunk.columns; i++)
            reader->bounds[i] = fxs_load_float(row + reader->chunk.column[i]);
    }
    if (!(row = next_row(&reader->vertex, reader->read, message)))
        return FXS_ERR_FILE;
    decode_words(reader, row, gaussian);
    if (reader->sh_degree > 0) {
        if (!(row = next_row(&reader->sh, reader->read, message)))
            return FXS_ERR_FILE;
        for (int i = 0; i < reader->sh.columns; i++)
            gaussian->sh[i] = decode_coefficient(row[reader->sh.column[i]]);
    }
    reader->read++;
    return 0;
}

static long compressed_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    compressed_reader *reader = handle;
    uint64_t left = reader->vertex.element->count - reader->read;
    long count = (long)(capacity < left ? capacity : left);
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++)
        FXS_TRY(read_gaussian(reader, &gaussians[i], message));
    return count;
}

const fxs_reader fxs_read_compressed_ply = {
    is_compressed_ply, sizeof(compressed_reader), compressed_open, compressed_read, compressed_rewind, NULL, NULL
};
