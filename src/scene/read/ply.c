/* Reads .ply with the vertex properties of Inria's 3D Gaussian splatting code. */
#include <stdio.h>

#include "ply_motion.h"
#include "src/base/foreign.h"
#include "src/gaussian/attributes.h"
#include "src/gaussian/origin_internal.h"
#include "src/scene/formats_internal.h"

enum { SCALE_2 = 5, DC = 11, FIRST_REST = 14, SH_FLOATS = 45, FILTER = FIRST_REST + SH_FLOATS,
       TIMES, FIELDS = TIMES + FXS_PLY_TIMES, NO_FIELD = -1, BATCH = 512 };

static const char *const field_names[FIRST_REST] = {
    "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity",
    "f_dc_0", "f_dc_1", "f_dc_2"
};

/* Names of .ply properties that change the picture in other programs but are ignored here. A name ending in _ stands
   for all names that begin so. */
static const char *const unused_names[] = {
    "t", "time", "beta", "gamma", "shape", "f_", "rot_", "rotation_", "scale_", "scaling_", "opacity_", "filter_",
    "motion_", "omega_", "trbf_", "velocity_", "delta_", "lifespan", "t_", "time_", "beta_", "sb_", "sh_", "shs_",
    "features_", "anchor_", "offset_"
};

typedef struct column {
    uint16_t offset;
    uint8_t type, field;
} column;

typedef struct run {
    uint16_t offset;
    uint8_t count, field, stride;
} run;

typedef struct ply_reader {
    fxs_ply_header header;
    const fxs_ply_element *vertex;
    int sh_degree, stored_sh_degree;
    int is_flat;                         /* 1: the file has 2D Gaussians, without scale_2 */
    int is_filtered;                     /* 1: the file has filter_3D of Mip-Splatting */
    fxs_ply_motion motion;
    double full;   /* stored number that means full brightness; 0: colours are stored as SH (f_dc) */
    float fields[FIELDS];
    int columns, all_float;
    int runs;
    uint64_t vertex_offset;
    uint64_t vertices_read;
    int8_t field_table[FXS_PLY_MAX_PROPERTIES];
    column column_table[FIELDS];
    run run_table[FIELDS];
    fxs_byte_reader bytes;
    fxs_motion motions[BATCH];
} ply_reader;

static int skip_list(ply_reader *reader, const fxs_ply_property *list)
{
    double length, value;
    FXS_TRY(fxs_ply_read_number(&reader->bytes, reader->header.encoding, list->count_type, &length));
    if (!(length >= 0 && length <= UINT32_MAX))
        return fxs_bytes_fail(&reader->bytes, "a list has no valid length");
    if (reader->header.encoding != FXS_PLY_ASCII)
        return fxs_bytes_skip(&reader->bytes, (uint64_t)length * fxs_ply_types[list->type].size);
    for (uint32_t i = (uint32_t)length; i > 0; i--)
        FXS_TRY(fxs_ply_read_number(&reader->bytes, FXS_PLY_ASCII, list->type, &value));
    return 0;
}

static int read_row(ply_reader *reader, const fxs_ply_element *rows, float *fields)
{
    const double *origin = reader->bytes.source->import->origin;
    fxs_ply_begin_row(&reader->bytes, reader->header.encoding);
    for (int i = rows->first; i < rows->end; i++) {
        const fxs_ply_property *p = &reader->header.property_table[i];
        double value;
        FXS_TRY(p->is_list ? skip_list(reader, p) : fxs_ply_read_number(&reader->bytes, reader->header.encoding,
                                                                        p->type,
                                                                    &value));
        const int field = reader->field_table[i];
        if (field != NO_FIELD)
            fields[field] = (float)(field < 3 ? value - origin[field] : value);
    }
    return fxs_ply_end_row(&reader->bytes, reader->header.encoding);
}

static int read_fixed_row(ply_reader *reader, const fxs_ply_element *rows, float *fields)
{
    const uint8_t *row = fxs_bytes_take(&reader->bytes, rows->row_size);
    if (!row)
        return FXS_ERR_FILE;
    const column *columns = reader->column_table, *end = columns + reader->columns;
    for (const run *r = reader->run_table; r < reader->run_table + reader->runs; r++) {
        const uint8_t *from = row + r->offset;
        const size_t stride = r->stride;
        float *to = fields + r->field;
        uint32_t left = r->count;
        for (; left >= 5; left -= 5, from += 20, to += 5 * stride) {
            to[0] = fxs_load_float(from);
            to[stride] = fxs_load_float(from + 4);
            to[2 * stride] = fxs_load_float(from + 8);
            to[3 * stride] = fxs_load_float(from + 12);
            to[4 * stride] = fxs_load_float(from + 16);
        }
        for (; left > 0; left--, from += 4, to += stride)
            *to = fxs_load_float(from);
    }
    const double *origin = reader->bytes.source->import->origin;
    for (const column *c = columns; c < end && !reader->all_float; c++) {
        const double value = fxs_ply_load_number(row + c->offset, c->type, reader->header.encoding);
        fields[c->field] = (float)(c->field < 3 ? value - origin[c->field] : value);
    }
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

/* Finds properties of type ushort. They are read as 16-bit floats, because some programs store floats in this type.
   Colours are an exception. */
static void find_halves(ply_reader *reader)
{
    for (int i = reader->vertex->first; i < reader->vertex->end; i++) {
        const int field = reader->field_table[i], is_colour = reader->full > 0 && field >= DC && field < FIRST_REST;
        if (field != NO_FIELD && !is_colour && reader->header.property_table[i].type == FXS_PLY_USHORT)
            reader->header.property_table[i].type = FXS_PLY_HALF;
    }
}

static int map_colour(ply_reader *reader)
{
    int colour[3];
    reader->full = fxs_ply_find_colour(&reader->header, reader->vertex, colour);
    for (int c = 0; c < 3 && reader->full > 0; c++)
        reader->field_table[colour[c]] = (int8_t)(DC + c);
    return reader->full > 0;
}

static int is_unused(const ply_reader *reader, int index)
{
    const char *name = reader->header.property_table[index].name;
    int is = 0;
    for (size_t k = 0; k < sizeof unused_names / sizeof *unused_names && !is; k++) {
        const size_t length = strlen(unused_names[k]);
        is = unused_names[k][length - 1] == '_' ? !strncmp(name, unused_names[k], length)
                                                : !strcmp(name, unused_names[k]);
    }
    return is && reader->field_table[index] == NO_FIELD && strncmp(name, "f_rest_", 7) != 0;
}

static int stem_of(const char *name)
{
    int length = (int)strlen(name);
    while (length > 1 && name[length - 1] >= '0' && name[length - 1] <= '9')
        length--;
    return length;
}

static void list_unused(const ply_reader *reader, char text[FXS_UNUSED_TEXT])
{
    const fxs_ply_property *table = reader->header.property_table;
    size_t size = 0;
    for (int i = reader->vertex->first; i < reader->vertex->end; i++) {
        const int stem = stem_of(table[i].name);
        int is_first = is_unused(reader, i), alike = 0;
        for (int k = reader->vertex->first; k < reader->vertex->end && is_first; k++)
            if (k != i && stem_of(table[k].name) == stem && !memcmp(table[k].name, table[i].name, (size_t)stem) &&
                is_unused(reader, k)) {
                is_first = k > i;
                alike = 1;
            }
        if (!is_first)
            continue;
        const int length = snprintf(text + size, FXS_UNUSED_TEXT - size, "%s%.*s%s", size ? ", " : "",
                                    alike ? stem : FXS_PLY_MAX_NAME, table[i].name, alike ? "*" : "");
        if (size + (size_t)length + 6 > FXS_UNUSED_TEXT) {
            strcpy(text + size, ", ...");
            return;
        }
        size += (size_t)length;
    }
}

static int fail_field(const ply_reader *reader, const char *missing, fxs_message *message)
{
    enum { FIRST_OF_GAUSSIANS = 3 };
    const char *path = reader->bytes.source->path;
    const fxs_ply_element *faces = fxs_ply_find_element(&reader->header, "face");
    int known = 0;
    for (int i = 0; i < FIRST_REST; i++)
        known += (i < FIRST_OF_GAUSSIANS) == (fxs_ply_find(&reader->header, reader->vertex, field_names[i]) >= 0);
    if (known == FIRST_REST)
        return fxs_fail(message, "%s: %s", path, faces && faces->count ? FXS_MESH : FXS_POINT_CLOUD);
    return fxs_fail(message, "%s: element vertex has no property %s", path, missing);
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
        if (index < 0 && i == DC && map_colour(reader))
            break;
        if (index < 0)
            return fail_field(reader, field_names[i], message);
        reader->field_table[index] = (int8_t)i;
    }
    int degree = fxs_ply_find_rest(header, reader->vertex, rest, path, message);
    if (degree < 0)
        return degree;
    reader->sh_degree = degree < 3 ? degree : 3;
    reader->stored_sh_degree = degree;
    for (int i = 0; i < 3 * reader->sh_degree * (reader->sh_degree + 2); i++)
        reader->field_table[rest[i]] = (int8_t)(FIRST_REST + i);
    const int filter = fxs_ply_find(header, reader->vertex, "filter_3D");
    reader->is_filtered = filter >= 0;
    if (reader->is_filtered)
        reader->field_table[filter] = FILTER;
    FXS_TRY(fxs_ply_find_motion(&reader->motion, header, reader->vertex, path, message));
    for (int i = 0; i < FXS_PLY_TIMES && reader->motion.moves; i++)
        if (reader->motion.columns[i] >= 0)
            reader->field_table[reader->motion.columns[i]] = (int8_t)(TIMES + i);
    if (reader->motion.is_colour && reader->full == 0)
        reader->full = 1;
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

static void list_runs(ply_reader *reader)
{
    run *last = reader->run_table;
    for (const column *c = reader->column_table; c < reader->column_table + reader->columns; c++) {
        const int stride = last->count ? c->field - last->field - (last->count - 1) * last->stride : 0;
        if (last->count && c->offset == last->offset + 4 * last->count && stride > 0 &&
            (last->count == 1 || stride == last->stride)) {
            last->stride = (uint8_t)stride;
            last->count++;
            continue;
        }
        last = &reader->run_table[reader->runs++];
        *last = (run){c->offset, 1, c->field, 0};
    }
}

static int ply_rewind(void *handle, fxs_message *message)
{
    ply_reader *reader = handle;
    if (fxs_bytes_seek(&reader->bytes, reader->vertex_offset) != 0)
        return fxs_fail(message, "%s: %s", reader->bytes.source->path, reader->bytes.fault);
    reader->vertices_read = 0;
    return 0;
}

static int is_fine(const ply_reader *reader)
{
    for (const column *c = reader->column_table; c < reader->column_table + reader->columns; c++)
        if (c->field < 3 && fxs_ply_types[c->type].size >= 4 && c->type != FXS_PLY_FLOAT)
            return 1;
    return reader->header.encoding == FXS_PLY_ASCII;
}

/* Chooses the origin of the Gaussians from a sample. info->coarse becomes the largest distance between neighbouring
   floats that exceeds the size of the Gaussian there. */
static int choose_origin(ply_reader *reader, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_ply_element *vertex = reader->vertex;
    fxs_import *import = reader->bytes.source->import;
    double places[FXS_ORIGIN_SAMPLE][3], sizes[FXS_ORIGIN_SAMPLE];
    int n = 0, failed = 0;
    for (; n < FXS_ORIGIN_SAMPLE && (uint64_t)n < vertex->count && !failed; n += !failed) {
        const fxs_gaussian *g = (const fxs_gaussian *)(const void *)reader->fields;
        const uint64_t s = FXS_ORIGIN_SAMPLE, k = (uint64_t)n;
        const uint64_t row = vertex->count / s * k + vertex->count % s * k / s;
        failed = is_fixed(reader, vertex)
                     ? fxs_bytes_seek(&reader->bytes, reader->vertex_offset + row * vertex->row_size) ||
                           read_fixed_row(reader, vertex, reader->fields)
                     : read_row(reader, vertex, reader->fields);
        for (int i = 0; i < 3; i++)
            places[n][i] = (double)g->position[i];
        sizes[n] = fxs_exp((double)fmaxf(g->scale[0], g->scale[1]));
    }
    import->moves = 1;
    fxs_origin_of(import->origin, places, n);
    while (n-- > 0) {
        const double spacing = fxs_spacing_at(places[n], import->origin);
        if (spacing > sizes[n] && spacing > info->coarse)
            info->coarse = spacing;
    }
    return ply_rewind(reader, message);
}

static int open_reader(ply_reader *reader, fxs_scene_file_info *info, fxs_message *message)
{
    FXS_TRY(fxs_ply_read_header(&reader->header, &reader->bytes, message));
    reader->vertex = fxs_ply_find_element(&reader->header, "vertex");
    FXS_TRY(map_fields(reader, message));
    FXS_TRY(fxs_ply_check_size(&reader->header, &reader->bytes, message));
    list_columns(reader);
    if (reader->all_float)
        list_runs(reader);
    for (const fxs_ply_element *e = reader->header.element_table; e < reader->vertex; e++)
        FXS_TRY(skip_element(reader, e, message));
    reader->vertex_offset = fxs_bytes_tell(&reader->bytes);
    info->count = reader->vertex->count;
    info->sh_degree = reader->sh_degree;
    info->stored_sh_degree = reader->stored_sh_degree;
    info->antialiased = reader->header.antialiased;
    if (reader->motion.moves)
        info->time = reader->motion.time;
    list_unused(reader, info->unused);
    return is_fine(reader) ? choose_origin(reader, info, message) : 0;
}

static int ply_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    ply_reader *reader = handle;
    reader->bytes.source = source;
    return open_reader(reader, info, message);
}

/* Applies the 3D smoothing filter of Mip-Splatting (Yu et al. 2024) to a Gaussian. Variances grow by the filter's
   square. Opacity shrinks as the volume grows. */
static void apply_filter(fxs_gaussian *g, double filter, int scales)
{
    double shrunk = 0;
    for (int k = 0; k < scales && filter != 0; k++) {
        const double grown = fxs_log(fxs_exp(2.0 * g->scale[k]) + filter * filter) / 2;
        shrunk += g->scale[k] - grown;
        g->scale[k] = (float)grown;
    }
    if (filter != 0)
        g->opacity = fxs_logit_of_opacity(fxs_opacity_of_logit(g->opacity) * fxs_exp(shrunk));
}

/* Returns 1 if a row has more numbers than a Gaussian. */
static int is_spread(const ply_reader *reader)
{
    return reader->is_filtered || reader->motion.moves;
}

static void complete(const ply_reader *reader, fxs_gaussian *g)
{
    if (is_spread(reader))
        memcpy(g, reader->fields, sizeof *g);
    if (reader->is_filtered)
        apply_filter(g, reader->fields[FILTER], reader->is_flat ? 2 : 3);
    for (int c = 0; c < 3 && reader->full > 0; c++)
        g->dc[c] = fxs_dc_of_colour(g->dc[c] / reader->full);
    if (reader->is_flat)
        g->scale[2] = FXS_FLAT_SCALE;
}

static long ply_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    ply_reader *reader = handle;
    const fxs_ply_element *vertex = reader->vertex;
    int (*read)(ply_reader *, const fxs_ply_element *, float *) = is_fixed(reader, vertex) ? read_fixed_row : read_row;
    uint64_t left = vertex->count - reader->vertices_read;
    long count = (long)(capacity < left ? capacity : left);
    count = reader->motion.moves && count > BATCH ? BATCH : count;
    if (reader->columns < FIRST_REST + SH_FLOATS)
        memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++) {
        if (read(reader, vertex, is_spread(reader) ? reader->fields : (float *)&gaussians[i]) != 0)
            return fail_row(reader, vertex, reader->vertices_read, message);
        complete(reader, &gaussians[i]);
        if (reader->motion.moves)
            fxs_ply_motion_of(&reader->motion, reader->fields + TIMES, &reader->motions[i]);
        reader->vertices_read++;
    }
    return count;
}

static const fxs_motion *ply_motions(const void *handle)
{
    const ply_reader *reader = handle;
    return reader->motion.moves ? reader->motions : NULL;
}

static int is_ply(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, "ply", 3);
}

const fxs_reader fxs_read_ply = {is_ply, sizeof(ply_reader), ply_open, ply_read, ply_rewind, NULL, ply_motions};
