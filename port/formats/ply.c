/* .ply: the container as in G. Turk, "The PLY Polygon File Format" (1994), the vertex properties as Inria's
   3D Gaussian splatting code writes them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "scene_format.h"

enum {
    MAX_LINE = 4096,
    MAX_WORDS = 6,             /* of a header line that are looked at */
    MAX_HEADER = 1 << 20,
    MAX_ELEMENTS = 64,
    MAX_PROPERTIES = 1024,
    MAX_COUNT = 2147483647,
    MAX_NUMBER = 511,          /* characters; the longest double printed with %f has 316 */
    BUFFER_SIZE = 1 << 17
};

enum encoding { NO_FORMAT, ASCII, LITTLE_ENDIAN_BINARY, BIG_ENDIAN_BINARY };

enum type { CHAR, UCHAR, SHORT, USHORT, INT, UINT, FLOAT, DOUBLE, TYPES };

static const struct { const char *name, *alias; uint8_t size; } types[TYPES] = {
    {"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2}, {"ushort", "uint16", 2},
    {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8}
};

/* A field is an index into the floats of fxs_gaussian; until the end of the header, FIRST_REST + i is f_rest_i. */
enum { SCALE_0 = 3, SCALE_2 = 5, FIRST_REST = 14, MAX_REST = 72, SH_COEFFICIENTS = 15, NO_FIELD = -1 };

static const char *const field_names[FIRST_REST] = {
    "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity",
    "f_dc_0", "f_dc_1", "f_dc_2"
};

typedef struct property {
    uint8_t type;
    uint8_t is_list, count_type;
    int8_t field;
} property;

typedef struct element {
    char name[32];         /* cut to fit, for messages */
    uint64_t count;
    int first, end;        /* properties */
    int has_lists;
    uint32_t row_size;     /* bytes of a binary row, with empty lists */
} element;

typedef struct column {
    uint16_t offset;       /* bytes from the start of the row */
    uint8_t type, field;
} column;

typedef struct ply_reader {
    const fxs_scene_source *source;
    enum encoding encoding;
    int line;                            /* header lines read */
    int elements, properties;
    int vertex;                          /* index of the element, -1: none */
    int rest;                            /* f_rest_* properties */
    int antialiased, is_compressed;
    uint8_t has_field[FIRST_REST + MAX_REST];
    int columns, all_float;
    uint64_t vertex_offset;              /* of the first vertex, bytes into the file */
    uint64_t vertices_read;
    const char *fault;                   /* what stopped the read of a row */
    uint64_t buffer_offset;              /* of the buffer's end, bytes into the file */
    size_t begin, end;                   /* unread bytes of the buffer */
    element element_table[MAX_ELEMENTS];
    property property_table[MAX_PROPERTIES];
    column column_table[FIRST_REST + 3 * SH_COEFFICIENTS];
    uint8_t buffer[BUFFER_SIZE];
} ply_reader;

static int is(const char *word, const char *name)
{
    return strcmp(word, name) == 0;
}

/* Buffered bytes */

static int set_fault(ply_reader *reader, const char *fault)
{
    reader->fault = fault;
    return -1;
}

static int set_end_fault(ply_reader *reader)
{
    return set_fault(reader, ferror(reader->source->stream) ? "read error" : "the file ends early");
}

/* Returns `size` bytes, at most BUFFER_SIZE, or NULL where the file has no more. */
static const uint8_t *take(ply_reader *reader, size_t size)
{
    if (reader->end - reader->begin < size) {
        reader->end -= reader->begin;
        memmove(reader->buffer, reader->buffer + reader->begin, reader->end);
        reader->begin = 0;
        size_t got = fread(reader->buffer + reader->end, 1, BUFFER_SIZE - reader->end, reader->source->stream);
        reader->end += got;
        reader->buffer_offset += got;
        if (reader->end < size)
            return NULL;
    }
    reader->begin += size;
    return reader->buffer + reader->begin - size;
}

static int next_byte(ply_reader *reader)
{
    const uint8_t *byte = take(reader, 1);
    return byte ? *byte : EOF;
}

static uint64_t tell(const ply_reader *reader)
{
    return reader->buffer_offset - (reader->end - reader->begin);
}

static int seek(ply_reader *reader, uint64_t offset)
{
    if (offset > reader->source->size)
        return set_fault(reader, "the file ends early");
    if (fseeko(reader->source->stream, (off_t)offset, SEEK_SET) != 0)
        return set_fault(reader, "seek error");
    reader->buffer_offset = offset;
    reader->begin = reader->end = 0;
    return 0;
}

static int skip(ply_reader *reader, uint64_t size)
{
    if (size > reader->end - reader->begin)
        return seek(reader, tell(reader) + size);
    reader->begin += (size_t)size;
    return 0;
}

/* Numbers */

static float load_float(const uint8_t *bytes)
{
    uint32_t bits = bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double load_number(const uint8_t *bytes, int type, enum encoding encoding)
{
    int size = types[type].size;
    uint64_t bits = 0;
    for (int i = 0; i < size; i++)
        bits = bits << 8 | bytes[encoding == BIG_ENDIAN_BINARY ? i : size - 1 - i];
    uint32_t float_bits = (uint32_t)bits;
    float single;
    double real;
    switch (type) {
    case CHAR:   return (int8_t)bits;
    case SHORT:  return (int16_t)bits;
    case INT:    return (int32_t)bits;
    case FLOAT:  memcpy(&single, &float_bits, sizeof single); return (double)single;
    case DOUBLE: memcpy(&real, &bits, sizeof real); return real;
    default:     return (double)bits;
    }
}

/* value * 10^exponent, rounded once for |exponent| <= 22, where the power is exact. */
static double scale_by_10(double value, int exponent)
{
    while (exponent != 0) {
        int steps = exponent < 0 ? -exponent : exponent;
        double power = 1;
        if (steps > 22)
            steps = 22;
        for (int i = 0; i < steps; i++)
            power *= 10;
        value = exponent < 0 ? value / power : value * power;
        exponent += exponent < 0 ? steps : -steps;
    }
    return value;
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
            return set_fault(reader, "a value is too long");
        text[length++] = (char)byte;
    }
    if (byte == '\n')
        reader->begin--;
    text[length] = '\0';
    if (length == 0)
        return byte == EOF ? set_end_fault(reader) : set_fault(reader, "too few values");
    return parse_number(text, value) == text + length ? 0 : set_fault(reader, "a value is not a number");
}

static int read_number(ply_reader *reader, int type, double *value)
{
    if (reader->encoding == ASCII)
        return read_ascii_number(reader, value);
    const uint8_t *bytes = take(reader, types[type].size);
    if (!bytes)
        return set_end_fault(reader);
    *value = load_number(bytes, type, reader->encoding);
    return 0;
}

static int skip_list(ply_reader *reader, const property *list)
{
    double length, value;
    if (read_number(reader, list->count_type, &length) != 0)
        return -1;
    if (!(length >= 0 && length <= UINT32_MAX))
        return set_fault(reader, "a list has no valid length");
    if (reader->encoding != ASCII)
        return skip(reader, (uint64_t)length * types[list->type].size);
    for (uint32_t i = (uint32_t)length; i > 0; i--)
        if (read_ascii_number(reader, &value) != 0)
            return -1;
    return 0;
}

static void skip_ascii_space(ply_reader *reader)
{
    int byte;
    do
        byte = next_byte(reader);
    while (is_blank(byte) || byte == '\n');
    if (byte != EOF)
        reader->begin--;
}

static int end_ascii_row(ply_reader *reader)
{
    int byte;
    do
        byte = next_byte(reader);
    while (is_blank(byte));
    return byte == EOF || byte == '\n' ? 0 : set_fault(reader, "too many values");
}

/* Any encoding, any properties; the fields of a Gaussian go to `fields`. */
static int read_row(ply_reader *reader, const element *rows, float *fields)
{
    if (reader->encoding == ASCII)
        skip_ascii_space(reader);
    for (int i = rows->first; i < rows->end; i++) {
        const property *p = &reader->property_table[i];
        double value;
        if ((p->is_list ? skip_list(reader, p) : read_number(reader, p->type, &value)) != 0)
            return -1;
        if (p->field != NO_FIELD)
            fields[p->field] = (float)value;
    }
    return reader->encoding == ASCII ? end_ascii_row(reader) : 0;
}

/* A binary row without lists. */
static int read_fixed_row(ply_reader *reader, const element *rows, float *fields)
{
    const uint8_t *row = take(reader, rows->row_size);
    if (!row)
        return set_end_fault(reader);
    const column *columns = reader->column_table, *end = columns + reader->columns;
    if (reader->all_float)
        for (const column *c = columns; c < end; c++)
            fields[c->field] = load_float(row + c->offset);
    else
        for (const column *c = columns; c < end; c++)
            fields[c->field] = (float)load_number(row + c->offset, c->type, reader->encoding);
    return 0;
}

static int is_fixed(const ply_reader *reader, const element *rows)
{
    return reader->encoding != ASCII && !rows->has_lists;
}

static int fail_row(const ply_reader *reader, const element *rows, uint64_t row, fxs_message *message)
{
    return fxs_fail(message, "%s: %s %llu of %llu: %s", reader->source->path, rows->name,
                    (unsigned long long)row + 1, (unsigned long long)rows->count, reader->fault);
}

static int skip_element(ply_reader *reader, const element *rows, fxs_message *message)
{
    if (is_fixed(reader, rows))
        return skip(reader, rows->count * rows->row_size) == 0 ? 0 : fail_row(reader, rows, 0, message);
    if (rows->first == rows->end)
        return 0;
    for (uint64_t row = 0; row < rows->count; row++)
        if (read_row(reader, rows, NULL) != 0)
            return fail_row(reader, rows, row, message);
    return 0;
}

/* Header */

static int fail_line(const ply_reader *reader, const char *fault, const char *word, fxs_message *message)
{
    return fxs_fail(message, "%s: header line %d: %s \"%.40s\"", reader->source->path, reader->line, fault, word);
}

static int read_line(ply_reader *reader, char line[MAX_LINE + 1], fxs_message *message)
{
    const char *path = reader->source->path;
    int length = 0, byte;
    reader->line++;
    while ((byte = next_byte(reader)) != '\n') {
        if (byte == EOF)
            return fxs_fail(message, "%s: the header has no end_header", path);
        if (byte < ' ' && !is_blank(byte))
            return fxs_fail(message, "%s: header line %d is not text", path, reader->line);
        if (length == MAX_LINE)
            return fxs_fail(message, "%s: header line %d has more than %d characters", path, reader->line, MAX_LINE);
        line[length++] = (char)byte;
    }
    line[length] = '\0';
    if (tell(reader) > MAX_HEADER)
        return fxs_fail(message, "%s: the header has more than %d bytes", path, MAX_HEADER);
    return 0;
}

static int parse_format(ply_reader *reader, const char *name, const char *version, fxs_message *message)
{
    static const char *const names[] = {"", "ascii", "binary_little_endian", "binary_big_endian"};
    if (!is(version, "1.0"))
        return fail_line(reader, "unknown version", version, message);
    for (int i = ASCII; i <= BIG_ENDIAN_BINARY; i++)
        if (is(name, names[i])) {
            reader->encoding = (enum encoding)i;
            return 0;
        }
    return fail_line(reader, "unknown format", name, message);
}

static int parse_element(ply_reader *reader, const char *name, const char *count, fxs_message *message)
{
    char *end;
    unsigned long long value = strtoull(count, &end, 10);
    if (!is_digit(*count) || *end != '\0' || value > MAX_COUNT)
        return fail_line(reader, "not a count from 0 to 2147483647:", count, message);
    if (reader->elements == MAX_ELEMENTS)
        return fail_line(reader, "more than 64 elements, at", name, message);
    if (is(name, "vertex")) {
        if (reader->vertex >= 0)
            return fail_line(reader, "a second element", name, message);
        reader->vertex = reader->elements;
    }
    element *added = &reader->element_table[reader->elements++];
    added->count = value;
    added->first = added->end = reader->properties;
    snprintf(added->name, sizeof added->name, "%.31s", name);
    return 0;
}

static int parse_type(const ply_reader *reader, const char *name, uint8_t *type, fxs_message *message)
{
    for (uint8_t i = 0; i < TYPES; i++)
        if (is(name, types[i].name) || is(name, types[i].alias)) {
            *type = i;
            return 0;
        }
    return fail_line(reader, "unknown type", name, message);
}

static int field_of(const char *name)
{
    char *end;
    for (int i = 0; i < FIRST_REST; i++)
        if (is(name, field_names[i]))
            return i;
    if (strncmp(name, "f_rest_", 7) != 0 || !is_digit(name[7]))
        return NO_FIELD;
    unsigned long i = strtoul(name + 7, &end, 10);
    return *end == '\0' && i < MAX_REST ? FIRST_REST + (int)i : NO_FIELD;
}

static int add_field(ply_reader *reader, property *added, const char *name, fxs_message *message)
{
    int field = field_of(name);
    reader->rest += strncmp(name, "f_rest_", 7) == 0;
    reader->is_compressed |= is(name, "packed_position");
    if (field == NO_FIELD)
        return 0;
    if (reader->has_field[field])
        return fail_line(reader, "a second property", name, message);
    reader->has_field[field] = 1;
    added->field = (int8_t)field;
    return 0;
}

/* `words` has 3 words or, for a list, 5. */
static int parse_property(ply_reader *reader, char **words, int is_list, fxs_message *message)
{
    const char *name = words[is_list ? 4 : 2];
    if (reader->elements == 0)
        return fail_line(reader, "a property before the first element:", name, message);
    if (reader->properties == MAX_PROPERTIES)
        return fail_line(reader, "more than 1024 properties, at", name, message);
    element *owner = &reader->element_table[reader->elements - 1];
    property *added = &reader->property_table[reader->properties++];
    added->is_list = (uint8_t)is_list;
    added->field = NO_FIELD;
    if (parse_type(reader, words[is_list ? 3 : 1], &added->type, message) != 0
        || (is_list && parse_type(reader, words[2], &added->count_type, message) != 0))
        return -1;
    if (is_list && added->count_type >= FLOAT)
        return fail_line(reader, "a list length that is not of an integer type:", name, message);
    owner->end = reader->properties;
    owner->has_lists |= is_list;
    owner->row_size += types[is_list ? added->count_type : added->type].size;
    return is_list || reader->elements - 1 != reader->vertex ? 0 : add_field(reader, added, name, message);
}

static int split(char *line, char *words[MAX_WORDS])
{
    char *rest;
    int count = 0;
    for (char *word = strtok_r(line, " \t\r", &rest); word && count < MAX_WORDS; word = strtok_r(NULL, " \t\r", &rest))
        words[count++] = word;
    return count;
}

/* Returns 1 for the header's last line. */
static int parse_line(ply_reader *reader, char *line, fxs_message *message)
{
    char *words[MAX_WORDS];
    int count = split(line, words);
    if (count == 0 || is(words[0], "obj_info"))
        return 0;
    if (is(words[0], "comment")) {
        if (count == 3 && ((is(words[1], "SplatRenderMode:") && is(words[2], "mip"))
                           || (is(words[1], "antialiased") && is(words[2], "1"))))
            reader->antialiased = 1;
        return 0;
    }
    if (count == 3 && is(words[0], "format"))
        return parse_format(reader, words[1], words[2], message);
    if (count == 3 && is(words[0], "element"))
        return parse_element(reader, words[1], words[2], message);
    if (is(words[0], "property") && (count == 3 || (count == 5 && is(words[1], "list"))))
        return parse_property(reader, words, count == 5, message);
    if (count == 1 && is(words[0], "end_header"))
        return 1;
    return fail_line(reader, "cannot read this", words[0], message);
}

static int read_header(ply_reader *reader, fxs_message *message)
{
    char line[MAX_LINE + 1], *words[MAX_WORDS];
    int status = read_line(reader, line, message);
    if (status == 0 && (split(line, words) != 1 || !is(words[0], "ply")))
        return fail_line(reader, "not \"ply\" alone:", line, message);
    while (status == 0)
        if ((status = read_line(reader, line, message)) == 0)
            status = parse_line(reader, line, message);
    if (status < 0)
        return -1;
    if (reader->encoding == NO_FORMAT)
        return fxs_fail(message, "%s: the header has no format line", reader->source->path);
    if (reader->vertex < 0)
        return fxs_fail(message, "%s: the header has no element vertex", reader->source->path);
    return 0;
}

/* Returns the SH degree that the f_rest_* properties give, or -1 and a message. */
static int check_fields(const ply_reader *reader, fxs_message *message)
{
    const char *path = reader->source->path;
    const uint8_t *has = reader->has_field;
    int degree = 0;
    if (reader->is_compressed)
        return fxs_fail(message, "%s: compressed .ply is not read yet", path);
    if (has[SCALE_0] && has[SCALE_0 + 1] && !has[SCALE_2])
        return fxs_fail(message, "%s: no property scale_2: a file of 2D surfels, not of 3D Gaussians", path);
    for (int i = 0; i < FIRST_REST; i++)
        if (!has[i])
            return fxs_fail(message, "%s: element vertex has no property %s", path, field_names[i]);
    while (degree <= 4 && 3 * (degree * (degree + 2)) != reader->rest)
        degree++;
    if (degree > 4)
        return fxs_fail(message, "%s: %d f_rest_* properties, not 0, 9, 24, 45 or 72", path, reader->rest);
    for (int i = 0; i < reader->rest; i++)
        if (!has[FIRST_REST + i])
            return fxs_fail(message, "%s: element vertex has no property f_rest_%d", path, i);
    return degree;
}

/* f_rest_* is channel-major in the file: i = coefficients * channel + k. */
static void resolve_fields(ply_reader *reader)
{
    const element *vertex = &reader->element_table[reader->vertex];
    int coefficients = reader->rest / 3;
    unsigned offset = 0;
    reader->all_float = reader->encoding == LITTLE_ENDIAN_BINARY;
    for (int i = vertex->first; i < vertex->end; i++) {
        property *p = &reader->property_table[i];
        if (p->field >= FIRST_REST) {
            int k = (p->field - FIRST_REST) % coefficients, channel = (p->field - FIRST_REST) / coefficients;
            p->field = (int8_t)(k < SH_COEFFICIENTS ? FIRST_REST + 3 * k + channel : NO_FIELD);
        }
        if (p->field != NO_FIELD) {
            column wanted = {(uint16_t)offset, p->type, (uint8_t)p->field};
            reader->column_table[reader->columns++] = wanted;
            reader->all_float &= p->type == FLOAT;
        }
        offset += types[p->type].size;
    }
}

/* An ASCII value takes at least a digit and a separator, but for the file's last. */
static int check_size(const ply_reader *reader, fxs_message *message)
{
    uint64_t needed = tell(reader), size = reader->source->size, values = 0;
    for (int i = 0; i < reader->elements; i++) {
        const element *e = &reader->element_table[i];
        values += e->count * (uint64_t)(e->end - e->first);
        if (reader->encoding != ASCII)
            needed += e->count * e->row_size;
    }
    if (reader->encoding == ASCII && values > 0)
        needed += 2 * values - 1;
    if (size < needed)
        return fxs_fail(message, "%s: the header asks for at least %llu bytes, the file has %llu",
                        reader->source->path, (unsigned long long)needed, (unsigned long long)size);
    return 0;
}

static int open_reader(ply_reader *reader, fxs_scene_file_info *info, fxs_message *message)
{
    int degree;
    if (read_header(reader, message) != 0 || (degree = check_fields(reader, message)) < 0
        || check_size(reader, message) != 0)
        return -1;
    resolve_fields(reader);
    for (int i = 0; i < reader->vertex; i++)
        if (skip_element(reader, &reader->element_table[i], message) != 0)
            return -1;
    reader->vertex_offset = tell(reader);
    info->count = reader->element_table[reader->vertex].count;
    info->sh_degree = degree < 3 ? degree : 3;
    info->antialiased = reader->antialiased;
    return 0;
}

static int ply_open(const fxs_scene_source *source, void **handle, fxs_scene_file_info *info, fxs_message *message)
{
    ply_reader *reader = calloc(1, sizeof *reader);
    if (!reader)
        return fxs_fail(message, "%s: out of memory", source->path);
    reader->source = source;
    reader->vertex = -1;
    *handle = reader;
    return open_reader(reader, info, message);
}

static long ply_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    ply_reader *reader = handle;
    const element *vertex = &reader->element_table[reader->vertex];
    int (*read)(ply_reader *, const element *, float *) = is_fixed(reader, vertex) ? read_fixed_row : read_row;
    uint64_t left = vertex->count - reader->vertices_read;
    long count = (long)(capacity < left ? capacity : left);
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++) {
        if (read(reader, vertex, (float *)&gaussians[i]) != 0)
            return fail_row(reader, vertex, reader->vertices_read, message);
        reader->vertices_read++;
    }
    return count;
}

static int ply_rewind(void *handle, fxs_message *message)
{
    ply_reader *reader = handle;
    if (seek(reader, reader->vertex_offset) != 0)
        return fxs_fail(message, "%s: %s", reader->source->path, reader->fault);
    reader->vertices_read = 0;
    return 0;
}

const fxs_scene_format fxs_scene_ply = {"ply", ply_open, ply_read, ply_rewind, free};
