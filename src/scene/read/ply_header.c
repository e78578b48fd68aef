/* Reads the header of a .ply (G. Turk, "The PLY Polygon File Format", 1994). */
#include "ply_header.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    MAX_LINE = 4096,
    MAX_WORDS = 16,
    MAX_HEADER = 1 << 20,
    MAX_COUNT = 2147483647
};

const fxs_ply_type fxs_ply_types[FXS_PLY_TYPES] = {
    {"char", "int8", 1, 127}, {"uchar", "uint8", 1, 255}, {"short", "int16", 2, 255}, {"ushort", "uint16", 2, 65535},
    {"int", "int32", 4, 255}, {"uint", "uint32", 4, 255}, {"float", "float32", 4, 1}, {"double", "float64", 8, 1},
    {"half", "float16", 2, 1}
};

const char *const fxs_ply_setting_names[FXS_PLY_SETTINGS] = {
    "ftgs_version", "use_velocity", "min_duration", "opacity_floor", "n_frames", "fps", "duration", "start"
};

typedef struct parser {
    fxs_ply_header *header;
    fxs_byte_reader *bytes;
    const char *path;
    fxs_message *message;
    int line;
} parser;

static int is(const char *word, const char *name)
{
    return strcmp(word, name) == 0;
}

static int fail_line(const parser *p, const char *fault, const char *word)
{
    return fxs_fail(p->message, "%s: header line %d: %s \"%.40s\"", p->path, p->line, fault, word);
}

static int read_line(parser *p, char line[MAX_LINE + 1])
{
    const uint8_t *byte;
    int length = 0;
    p->line++;
    while ((byte = fxs_bytes_take(p->bytes, 1)) && *byte != '\n') {
        if (*byte < ' ' && *byte != '\t' && *byte != '\r')
            return fxs_fail(p->message, "%s: header line %d is not text", p->path, p->line);
        if (length == MAX_LINE)
            return fxs_fail(p->message, "%s: header line %d has more than %d characters", p->path, p->line, MAX_LINE);
        line[length++] = (char)*byte;
    }
    if (!byte)
        return fxs_fail(p->message, "%s: the header has no end_header", p->path);
    line[length] = '\0';
    if (fxs_bytes_tell(p->bytes) > MAX_HEADER)
        return fxs_fail(p->message, "%s: the header has more than %d bytes", p->path, MAX_HEADER);
    return 0;
}

static int parse_format(parser *p, const char *name, const char *version)
{
    static const char *const names[] = {"", "ascii", "binary_little_endian", "binary_big_endian"};
    if (!is(version, "1.0"))
        return fail_line(p, "unknown version", version);
    for (int i = FXS_PLY_ASCII; i <= FXS_PLY_BIG_ENDIAN; i++)
        if (is(name, names[i])) {
            p->header->encoding = (fxs_ply_encoding)i;
            return 0;
        }
    return fail_line(p, "unknown format", name);
}

static int parse_element(parser *p, const char *name, const char *count)
{
    fxs_ply_header *header = p->header;
    char *end;
    unsigned long long value = strtoull(count, &end, 10);
    if (*count < '0' || *count > '9' || *end != '\0' || value > MAX_COUNT)
        return fail_line(p, "not a count from 0 to 2147483647:", count);
    if (header->elements == FXS_PLY_MAX_ELEMENTS)
        return fail_line(p, "more than 64 elements, at", name);
    if (fxs_ply_find_element(header, name))
        return fail_line(p, "a second element", name);
    fxs_ply_element *added = &header->element_table[header->elements++];
    added->count = value;
    added->first = added->end = header->properties;
    snprintf(added->name, sizeof added->name, "%.*s", FXS_PLY_MAX_NAME, name);
    return 0;
}

static int parse_type(const parser *p, const char *name, uint8_t *type)
{
    for (uint8_t i = 0; i < FXS_PLY_TYPES; i++)
        if (is(name, fxs_ply_types[i].name) || is(name, fxs_ply_types[i].alias)) {
            *type = i;
            return 0;
        }
    return fail_line(p, "unknown type", name);
}

static int parse_property(parser *p, char **words, int is_list)
{
    fxs_ply_header *header = p->header;
    const char *name = words[is_list ? 4 : 2];
    if (header->elements == 0)
        return fail_line(p, "a property before the first element:", name);
    if (header->properties == FXS_PLY_MAX_PROPERTIES)
        return fail_line(p, "more than 1024 properties, at", name);
    fxs_ply_element *owner = &header->element_table[header->elements - 1];
    fxs_ply_property *added = &header->property_table[header->properties];
    FXS_TRY(parse_type(p, words[is_list ? 3 : 1], &added->type));
    if (is_list)
        FXS_TRY(parse_type(p, words[2], &added->count_type));
    if (is_list && added->count_type >= FXS_PLY_FLOAT)
        return fail_line(p, "a list length that is not of an integer type:", name);
    if (!is_list && fxs_ply_find(header, owner, name) >= 0)
        return fail_line(p, "a second property", name);
    snprintf(added->name, sizeof added->name, "%.*s", FXS_PLY_MAX_NAME, name);
    added->is_list = (uint8_t)is_list;
    added->offset = owner->row_size;
    owner->end = ++header->properties;
    owner->has_lists |= is_list;
    owner->row_size += fxs_ply_types[is_list ? added->count_type : added->type].size;
    return 0;
}

static int split(char *line, char *words[MAX_WORDS])
{
    char *rest;
    int count = 0;
    for (char *word = strtok_r(line, " \t\r", &rest); word && count < MAX_WORDS; word = strtok_r(NULL, " \t\r", &rest))
        words[count++] = word;
    return count;
}

static void take_setting(fxs_ply_header *header, const char *name, size_t length, const char *number, int first,
                         int end)
{
    for (int i = first; i < end; i++)
        if (strlen(fxs_ply_setting_names[i]) == length && !strncmp(name, fxs_ply_setting_names[i], length)) {
            header->given |= 1u << i;
            if (!fxs_ply_parse_number(number, &header->settings[i]))
                header->settings[i] = NAN;
        }
}

/* Reads a comment of FTGS (a name and a number), or the words name=number after "cfg_args:", which SuperSplat 4D
   writes, in older files as "Namespace(name=number, ...)". */
static void parse_comment(fxs_ply_header *header, char **words, int count)
{
    if (count == 3)
        take_setting(header, words[1], strlen(words[1]), words[2], 0, FXS_PLY_DURATION);
    for (int i = 2; i < count && is(words[1], "cfg_args:"); i++) {
        char *name = strncmp(words[i], "Namespace(", 10) ? words[i] : words[i] + 10, *equals = strchr(name, '=');
        words[i][strcspn(words[i], ",)")] = '\0';
        if (equals)
            take_setting(header, name, (size_t)(equals - name), equals + 1, FXS_PLY_FPS, FXS_PLY_SETTINGS);
    }
}

static int parse_line(parser *p, char *line)
{
    char *words[MAX_WORDS];
    int count = split(line, words);
    if (count == 0 || is(words[0], "obj_info"))
        return 0;
    if (is(words[0], "comment")) {
        if (count == 3 && ((is(words[1], "SplatRenderMode:") && is(words[2], "mip"))
                           || (is(words[1], "antialiased") && is(words[2], "1"))))
            p->header->antialiased = 1;
        parse_comment(p->header, words, count);
        return 0;
    }
    if (count == 3 && is(words[0], "format"))
        return parse_format(p, words[1], words[2]);
    if (count == 3 && is(words[0], "element"))
        return parse_element(p, words[1], words[2]);
    if (is(words[0], "property") && (count == 3 || (count == 5 && is(words[1], "list"))))
        return parse_property(p, words, count == 5);
    if (count == 1 && is(words[0], "end_header"))
        return 1;
    return fail_line(p, "cannot read this", words[0]);
}

int fxs_ply_read_header(fxs_ply_header *header, fxs_byte_reader *bytes, fxs_message *message)
{
    parser p = {header, bytes, bytes->source->path, message, 0};
    char line[MAX_LINE + 1], *words[MAX_WORDS];
    int status = read_line(&p, line);
    const size_t mark = status == 0 && !strncmp(line, FXS_UTF8_MARK, strlen(FXS_UTF8_MARK)) ? strlen(FXS_UTF8_MARK) : 0;
    if (status == 0 && (split(line + mark, words) != 1 || !is(words[0], "ply")))
        return fail_line(&p, "not \"ply\" alone:", line);
    while (status == 0)
        if ((status = read_line(&p, line)) == 0)
            status = parse_line(&p, line);
    if (status < 0)
        return status;
    if (header->encoding == FXS_PLY_NONE)
        return fxs_fail(message, "%s: the header has no format line", p.path);
    if (!fxs_ply_find_element(header, "vertex"))
        return fxs_fail(message, "%s: the header has no element vertex", p.path);
    return 0;
}

/* Checks that a .ply file is large enough for its element counts. A value in a text file needs at least a digit and a
   separator. */
int fxs_ply_check_size(const fxs_ply_header *header, const fxs_byte_reader *bytes, fxs_message *message)
{
    uint64_t needed = fxs_bytes_tell(bytes), size = bytes->source->input.size, values = 0;
    for (int i = 0; i < header->elements; i++) {
        const fxs_ply_element *e = &header->element_table[i];
        values += e->count * (uint64_t)(e->end - e->first);
        if (header->encoding != FXS_PLY_ASCII)
            needed += e->count * e->row_size;
    }
    if (header->encoding == FXS_PLY_ASCII && values > 0)
        needed += 2 * values - 1;
    if (size < needed)
        return fxs_fail(message, "%s: the header asks for at least %llu bytes, the file has %llu",
                        bytes->source->path, (unsigned long long)needed, (unsigned long long)size);
    return 0;
}

const fxs_ply_element *fxs_ply_find_element(const fxs_ply_header *header, const char *name)
{
    for (int i = 0; i < header->elements; i++)
        if (is(header->element_table[i].name, name))
            return &header->element_table[i];
    return NULL;
}

int fxs_ply_find(const fxs_ply_header *header, const fxs_ply_element *element, const char *name)
{
    for (int i = element->first; i < element->end; i++)
        if (!header->property_table[i].is_list && is(header->property_table[i].name, name))
            return i;
    return -1;
}

double fxs_ply_find_colour(const fxs_ply_header *header, const fxs_ply_element *element, int colour[3])
{
    static const char *const names[][3] = {
        {"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}, {"r", "g", "b"}
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        for (int c = 0; c < 3; c++)
            colour[c] = fxs_ply_find(header, element, names[i][c]);
        if (colour[0] >= 0 && colour[1] >= 0 && colour[2] >= 0)
            return fxs_ply_types[header->property_table[colour[0]].type].full;
    }
    return 0;
}

int fxs_ply_find_rest(const fxs_ply_header *header, const fxs_ply_element *element, int rest[FXS_PLY_MAX_REST],
                      const char *path, fxs_message *message)
{
    int count = 0, degree = 0;
    for (int i = element->first; i < element->end; i++)
        count += !header->property_table[i].is_list && strncmp(header->property_table[i].name, "f_rest_", 7) == 0;
    while (degree <= 4 && 3 * (degree * (degree + 2)) != count)
        degree++;
    if (degree > 4)
        return fxs_fail(message, "%s: %d f_rest_* properties, not 0, 9, 24, 45 or 72", path, count);
    for (int i = 0; i < count; i++) {
        char name[24];
        snprintf(name, sizeof name, "f_rest_%d", i);
        int index = fxs_ply_find(header, element, name), channel = i / (count / 3), k = i % (count / 3);
        if (index < 0)
            return fxs_fail(message, "%s: element %s has no property %s", path, element->name, name);
        rest[3 * k + channel] = index;
    }
    return degree;
}
