/* .ply: the vertex properties as Inria's 3D Gaussian splatting code writes them. */
#include <math.h>
#include <stdio.h>
#include <strings.h>

#include "ply_header.h"
#include "scene_codes.h"
#include "scene_format.h"

enum { MAX_NUMBER = 511 };   /* characters; the longest double printed with %f has 316 */

/* A field is an index into the floats of fxs_gaussian. */
enum { SCALE_2 = 5, FIRST_REST = 14, SH_FLOATS = 45, NO_FIELD = -1 };

static const char *const field_names[FIRST_REST] = {
    "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity",
    "f_dc_0", "f_dc_1", "f_dc_2"
};

typedef struct column {
    uint16_t offset;       /* bytes from the start of the row */
    uint8_t type, field;
} column;

typedef struct ply_reader {
    fxs_ply_header header;
    const fxs_ply_element *vertex;
    int sh_degree, stored_sh_degree;
    int is_flat;                         /* no scale_2: 2D Gaussians */
    int columns, all_float;
    uint64_t vertex_offset;              /* of the first vertex, bytes into the file */
    uint64_t vertices_read;
    int8_t field_table[FXS_PLY_MAX_PROPERTIES];
    column column_table[FIRST_REST + SH_FLOATS];
    fxs_byte_reader bytes;
} ply_reader;

static int next_byte(ply_reader *reader)
{
    const uint8_t *byte = fxs_bytes_take(&reader->bytes, 1);
    return byte ? *byte : EOF;
}

/* Numbers */

static double load_number(const uint8_t *bytes, int type, fxs_ply_encoding encoding)
{
    int size = fxs_ply_types[type].size;
    uint64_t bits = 0;
    for (int i = 0; i < size; i++)
        bits = bits << 8 | bytes[encoding == FXS_PLY_BIG_ENDIAN ? i : size - 1 - i];
    uint32_t float_bits = (uint32_t)bits;
    float single;
    double real;
    switch (type) {
    case FXS_PLY_CHAR:   return (int8_t)bits;
    case FXS_PLY_SHORT:  return (int16_t)bits;
    case FXS_PLY_INT:    return (int32_t)bits;
    case FXS_PLY_FLOAT:  memcpy(&single, &float_bits, sizeof single); return (double)single;
    case FXS_PLY_DOUBLE: memcpy(&real, &bits, sizeof real); return real;
    case FXS_PLY_HALF:   return (double)fxs_half((uint32_t)bits);
    default:             return (double)bits;
    }
}

/* value * 10^exponent, rounded once for |exponent| <= 22, where the power is exact. A value is 0 or 1 to 1e19, so that
   beyond +-400 it is 0 or infinite anyway. */
static double scale_by_10(double value, int exponent)
{
    static const double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14,
                                    1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    int steps = exponent < -400 || exponent > 400 ? 400 : exponent < 0 ? -exponent : exponent;
    for (; steps > 22; steps -= 22)
        value = exponent < 0 ? value / powers[22] : value * powers[22];
    return exponent < 0 ? value / powers[steps] : value * powers[steps];
}

static int is_digit(int c)
{
    return c >= '0' && c <= '9';
}

/* Reads [+-]digits, held below 10000. Returns the end of the text read, or NULL. */
static const char *parse_exponent(const char *text, int *exponent)
{
    int sign = *text == '-' ? -1 : 1, value = 0;
    if (*text == '-' || *text == '+')
        text++;
    if (!is_digit(*text))
        return NULL;
    for (; is_digit(*text); text++)
        if (value < 1000)
            value = 10 * value + (*text - '0');
    *exponent += sign * value;
    return text;
}

/* Not strtod, whose decimal point is the locale's. The result may be one unit of the double's last place off.
   Returns the end of the number, or NULL. */
static const char *parse_number(const char *text, double *value)
{
    double sign = *text == '-' ? -1 : 1;
    uint64_t mantissa = 0;
    int exponent = 0, has_digits = 0, has_point = 0;
    if (*text == '-' || *text == '+')
        text++;
    if (strcasecmp(text, "nan") == 0 || strcasecmp(text, "inf") == 0) {
        *value = sign * (strcasecmp(text, "nan") == 0 ? NAN : INFINITY);
        return text + 3;
    }
    for (; is_digit(*text) || (*text == '.' && !has_point); text++) {
        if (*text == '.') {
            has_point = 1;
            continue;
        }
        has_digits = 1;
        if (mantissa < 1000000000000000000u) {
            mantissa = 10 * mantissa + (uint64_t)(*text - '0');
            exponent -= has_point;
        } else {
            exponent += !has_point;
        }
    }
    if (!has_digits)
        return NULL;
    if (*text == 'e' || *text == 'E')
        text = parse_exponent(text + 1, &exponent);
    *value = sign * scale_by_10((double)mantissa, exponent);
    return text;
}

/* Rows */

static int is_blank(int byte)
{
    return byte == ' ' || byte == '\t' || byte == '\r';
}

/* Leaves the newline unread. A number that the file's end cuts short is read as it stands. */
static int read_ascii_number(ply_reader *reader, double *value)
{
    char text[MAX_NUMBER + 1];
    int length = 0, byte;
    do
        byte = next_byte(reader);
    while (is_blank(byte));
    for (; byte != EOF && byte != '\n' && !is_blank(byte); byte = next_byte(reader)) {
        if (length == MAX_NUMBER)
            return fxs_bytes_fail(&reader->bytes, "a value is too long");
        text[length++] = (char)byte;
    }
    if (byte == '\n')
        reader->bytes.begin--;
    text[length] = '\0';
    if (length == 0)
        return byte == EOF ? FXS_ERR_FILE : fxs_bytes_fail(&reader->bytes, "too few values");
    return parse_number(text, value) == text + length ? 0 : fxs_bytes_fail(&reader->bytes, "a value is not a number");
}

static int read_number(ply_reader *reader, int type, double *value)
{
    if (reader->header.encoding == FXS_PLY_ASCII)
        return read_ascii_number(reader, value);
    const uint8_t *bytes = fxs_bytes_take(&reader->bytes, fxs_ply_types[type].size);
    if (!bytes)
        return FXS_ERR_FILE;
    *value = load_number(bytes, type, reader->header.encoding);
    return 0;
}

static int skip_list(ply_reader *reader, const fxs_ply_property *list)
{
    double length, value;
    FXS_TRY(read_number(reader, list->count_type, &length));
    if (!(length >= 0 && length <= UINT32_MAX))
        return fxs_bytes_fail(&reader->bytes, "a list has no valid length");
    if (reader->header.encoding != FXS_PLY_ASCII)
        return fxs_bytes_skip(&reader->bytes, (uint64_t)length * fxs_ply_types[list->type].size);
    for (uint32_t i = (uint32_t)length; i > 0; i--)
        FXS_TRY(read_ascii_number(reader, &value));
    return 0;
}

static void skip_ascii_space(ply_reader *reader)
{
    int byte;
    do
        byte = next_byte(reader);
    while (is_blank(byte) || byte == '\n');
    if (byte != EOF)
        reader->bytes.begin--;
}

static int end_ascii_row(ply_reader *reader)
{
    int byte;
    do
        byte = next_byte(reader);
    while (is_blank(byte));
    return byte == EOF || byte == '\n' ? 0 : fxs_bytes_fail(&reader->bytes, "too many values");
}

/* Any encoding, any properties; the fields of a Gaussian go to `fields`. */
static int read_row(ply_reader *reader, const fxs_ply_element *rows, float *fields)
{
    if (reader->header.encoding == FXS_PLY_ASCII)
        skip_ascii_space(reader);
    for (int i = rows->first; i < rows->end; i++) {
        const fxs_ply_property *p = &reader->header.property_table[i];
        double value;
        FXS_TRY(p->is_list ? skip_list(reader, p) : read_number(reader, p->type, &value));
        if (reader->field_table[i] != NO_FIELD)
            fields[reader->field_table[i]] = (float)value;
    }
    return reader->header.encoding == FXS_PLY_ASCII ? end_ascii_row(reader) : 0;
}

/* A binary row without lists. */
static int read_fixed_row(ply_reader *reader, const fxs_ply_element *rows, float *fields)
{
    const uint8_t *row = fxs_bytes_take(&reader->bytes, rows->row_size);
    if (!row)
        return FXS_ERR_FILE;
    const column *columns = reader->column_table, *end = columns + reader->columns;
    if (reader->all_float)
        for (const column *c = columns; c < end; c++)
            fields[c->field] = fxs_load_float(row + c->offset);
    else
        for (const column *c = columns; c < end; c++)
            fields[c->field] = (float)load_number(row + c->offset, c->type, reader->header.encoding);
    return 0;
}

static int is_fixed(const ply_reader *reader, const fxs_ply_element *rows)
{
    return reader->header.encoding != FXS_PLY_ASCII && !rows->has_lists;
}

static int fail_row(const ply_reader *reader, const fxs_ply_element *rows, uint64_t row, fxs_message *message)
{
    return fxs_bytes_fail_row(&reader->bytes, rows->name, row, rows->count, message);
}

static int skip_element(ply_reader *reader, const fxs_ply_element *rows, fxs_message *message)
{
    if (is_fixed(reader, rows)) {
        int status = fxs_bytes_skip(&reader->bytes, rows->count * rows->row_size);
        return status == 0 ? 0 : fail_row(reader, rows, 0, message);
    }
    if (rows->first == rows->end)
        return 0;
    for (uint64_t row = 0; row < rows->count; row++)
        if (read_row(reader, rows, NULL) != 0)
            return fail_row(reader, rows, row, message);
    return 0;
}

/* Header */

/* Halves by another name, as some write them: where whole numbers from 0 on cannot be meant, as no field but the
   position is of another type. In a text they are numbers of any kind anyway. */
static void find_halves(ply_reader *reader)
{
    for (int i = reader->vertex->first; i < reader->vertex->end; i++)
        if (reader->field_table[i] > 2 && reader->header.property_table[i].type != FXS_PLY_USHORT)
            return;
    for (int i = reader->vertex->first; i < reader->vertex->end; i++)
        if (reader->field_table[i] != NO_FIELD && reader->header.property_table[i].type == FXS_PLY_USHORT)
            reader->header.property_table[i].type = FXS_PLY_HALF;
}

static int map_fields(ply_reader *reader, fxs_message *message)
{
    const fxs_ply_header *header = &reader->header;
    const char *path = reader->bytes.source->path;
    int rest[FXS_PLY_MAX_REST];
    memset(reader->field_table, NO_FIELD, sizeof reader->field_table);
    for (int i = 0; i < FIRST_REST; i++) {
        int index = fxs_ply_find(header, reader->vertex, field_names[i]);
        if (index < 0 && i == SCALE_2) {
            reader->is_flat = 1;
            continue;
        }
        if (index < 0)
            return fxs_fail(message, "%s: element vertex has no property %s", path, field_names[i]);
        reader->field_table[index] = (int8_t)i;
    }
    int degree = fxs_ply_find_rest(header, reader->vertex, rest, path, message);
    if (degree < 0)
        return degree;
    reader->sh_degree = degree < 3 ? degree : 3;
    reader->stored_sh_degree = degree;
    for (int i = 0; i < 3 * reader->sh_degree * (reader->sh_degree + 2); i++)
        reader->field_table[rest[i]] = (int8_t)(FIRST_REST + i);
    find_halves(reader);
    return 0;
}

static void list_columns(ply_reader *reader)
{
    reader->all_float = reader->header.encoding == FXS_PLY_LITTLE_ENDIAN;
    for (int i = reader->vertex->first; i < reader->vertex->end; i++) {
        const fxs_ply_property *p = &reader->header.property_table[i];
        if (reader->field_table[i] == NO_FIELD)
            continue;
        column added = {(uint16_t)p->offset, p->type, (uint8_t)reader->field_table[i]};
        reader->column_table[reader->columns++] = added;
        reader->all_float &= p->type == FXS_PLY_FLOAT;
    }
}

static int open_reader(ply_reader *reader, fxs_scene_file_info *info, fxs_message *message)
{
    FXS_TRY(fxs_ply_read_header(&reader->header, &reader->bytes, message));
    reader->vertex = fxs_ply_find_element(&reader->header, "vertex");
    FXS_TRY(map_fields(reader, message));
    FXS_TRY(fxs_ply_check_size(&reader->header, &reader->bytes, message));
    list_columns(reader);
    for (const fxs_ply_element *e = reader->header.element_table; e < reader->vertex; e++)
        FXS_TRY(skip_element(reader, e, message));
    reader->vertex_offset = fxs_bytes_tell(&reader->bytes);
    info->count = reader->vertex->count;
    info->sh_degree = reader->sh_degree;
    info->stored_sh_degree = reader->stored_sh_degree;
    info->antialiased = reader->header.antialiased;
    return 0;
}

static int ply_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    ply_reader *reader = handle;
    reader->bytes.source = source;
    return open_reader(reader, info, message);
}

static long ply_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    ply_reader *reader = handle;
    const fxs_ply_element *vertex = reader->vertex;
    int (*read)(ply_reader *, const fxs_ply_element *, float *) = is_fixed(reader, vertex) ? read_fixed_row : read_row;
    uint64_t left = vertex->count - reader->vertices_read;
    long count = (long)(capacity < left ? capacity : left);
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++) {
        if (read(reader, vertex, (float *)&gaussians[i]) != 0)
            return fail_row(reader, vertex, reader->vertices_read, message);
        if (reader->is_flat)
            gaussians[i].scale[2] = FXS_FLAT_SCALE;
        reader->vertices_read++;
    }
    return count;
}

static int ply_rewind(void *handle, fxs_message *message)
{
    ply_reader *reader = handle;
    if (fxs_bytes_seek(&reader->bytes, reader->vertex_offset) != 0)
        return fxs_fail(message, "%s: %s", reader->bytes.source->path, reader->bytes.fault);
    reader->vertices_read = 0;
    return 0;
}

const fxs_scene_format fxs_scene_ply = {"ply", sizeof(ply_reader), ply_open, ply_read, ply_rewind, NULL};
