/* Reads the initial points of a fit from COLMAP (binary and text), Bundler or .ply files, or makes random points. */
#include "photo_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/camera/colmap_internal.h"
#include <fixsplat/internal/message.h>
#include "src/scene/read/ply_header.h"
#include "src/base/random.h"

#define MOST_POINTS FXS_GAUSSIANS_CEILING
#define FARTHEST 134217728.0       /* limit of coordinates: 2^27 scene units, as in the renderer */
#define RANDOM_POINTS 100000
#define RANDOM_STEP UINT64_MAX
#define GREY 128

static int add_point(fxs_photo_points *p, const char *path, const double position[3], const double colour[3],
                     fxs_message *message)
{
    if (p->count == MOST_POINTS)
        return fxs_fail(message, "%s: more than %u points", path, MOST_POINTS);
    if (p->count == p->capacity) {
        const size_t capacity = 2 * p->capacity + 1024;
        fxs_fit_point *points = realloc(p->points, capacity * sizeof *points);
        if (!points)
            return fxs_fail_memory(message, path, capacity * sizeof *points);
        p->points = points;
        p->capacity = capacity;
    }
    fxs_fit_point *point = &p->points[p->count++];
    for (int i = 0; i < 3; i++) {
        if (!(fabs(position[i]) < FARTHEST))
            return fxs_fail(message, "%s: point %zu is not finite, or beyond 2^27 units", path, p->count - 1);
        point->position[i] = (float)position[i];
        point->colour[i] = (uint8_t)(colour[i] > 0 ? colour[i] < 255 ? colour[i] : 255 : 0);
    }
    return 0;
}

static int read_binary(fxs_photo_points *p, const fxs_text *text, fxs_message *message)
{
    fxs_colmap_cursor in = fxs_colmap_begin(text);
    for (uint64_t count = fxs_colmap_take(&in, 8); count && !in.short_of; count--) {
        double position[3], colour[3];
        const uint64_t number = fxs_colmap_take(&in, 8);
        fxs_colmap_take_doubles(&in, position, 3);
        for (int i = 0; i < 3; i++)
            colour[i] = (double)fxs_colmap_take(&in, 1);
        fxs_colmap_take(&in, 8);   /* skips the point's reprojection error */
        fxs_colmap_skip(&in, fxs_colmap_take(&in, 8), 8);   /* skips the list of images that see the point */
        p->last = number > p->last ? number : p->last;
        if (!in.short_of && (number > p->after || !p->after))
            FXS_TRY(add_point(p, text->path, position, colour, message));
    }
    return in.short_of ? fxs_fail(message, "%s: cut short", text->path) : 0;
}

static int read_plain(fxs_photo_points *p, const fxs_text *text, fxs_message *message)
{
    char *rest = fxs_text_begin(text), *line;
    while ((line = fxs_colmap_entry(&rest))) {
        double values[7];          /* number, position and colour of a point */
        if (!fxs_colmap_numbers(&line, values, 7))
            return fxs_fail(message, "%s: point %zu: not a number, a position and a colour", text->path, p->count);
        FXS_TRY(add_point(p, text->path, values + 1, values + 4, message));
    }
    return rest == text->data + text->size ? 0 : fxs_fail(message, "%s: zero bytes in this text", text->path);
}

int fxs_photo_points_colmap(fxs_photo_points *p, const char *path, fxs_message *message)
{
    const size_t length = strlen(path);
    fxs_text text;
    FXS_TRY(fxs_text_load(path, &text, message));
    const int error = length > 4 && !strcmp(path + length - 4, ".txt") ? read_plain(p, &text, message)
                                                                       : read_binary(p, &text, message);
    free(text.data);
    return error;
}

enum { LINES_OF_CAMERA = 5 };

/* Reads the points of a Bundler file. A point has three lines: position, colour, and the views that see it. */
static int read_bundler(fxs_photo_points *p, const fxs_text *text, fxs_message *message)
{
    char *rest = fxs_text_begin(text), *line = fxs_colmap_entry(&rest);
    double counts[2];
    if (!line || !fxs_colmap_numbers(&line, counts, 2))
        return fxs_fail(message, "%s: does not begin with the numbers of cameras and of points", text->path);
    for (double i = 0; i < LINES_OF_CAMERA * counts[0] && line; i++)
        line = fxs_colmap_entry(&rest);
    for (double i = 0; i < counts[1]; i++) {
        double values[6];
        for (int k = 0; k < 2; k++)
            if (!(line = fxs_colmap_entry(&rest)) || !fxs_colmap_numbers(&line, values + 3 * k, 3))
                return fxs_fail(message, "%s: point %zu: not a position and a colour", text->path, p->count);
        if (!fxs_colmap_entry(&rest))
            return fxs_fail(message, "%s: point %zu: cut short", text->path, p->count);
        FXS_TRY(add_point(p, text->path, values, values + 3, message));
    }
    return 0;
}

int fxs_photo_points_bundler(fxs_photo_points *p, const char *path, fxs_message *message)
{
    fxs_text text;
    FXS_TRY(fxs_text_load(path, &text, message));
    const int error = read_bundler(p, &text, message);
    free(text.data);
    return error;
}

typedef struct ply {
    fxs_scene_source source;
    fxs_byte_reader bytes;
    fxs_ply_header header;
} ply;

/* Finds the columns of positions and colours in a .ply file. *full: value of full brightness of colours; 0: the file
   has no colours. */
static int find_columns(const ply *p, const fxs_ply_element *vertex, int columns[6], double *full, fxs_message *message)
{
    static const char *const names[3] = {"x", "y", "z"};
    const char *path = p->source.path;
    if (!vertex || vertex != p->header.element_table || vertex->has_lists)
        return fxs_fail(message, "%s: its first element is not \"vertex\", without lists", path);
    for (int i = 0; i < 3; i++) {
        columns[i] = fxs_ply_find(&p->header, vertex, names[i]);
        if (columns[i] < 0)
            return fxs_fail(message, "%s: element vertex has no property %s", path, names[i]);
    }
    *full = fxs_ply_find_colour(&p->header, vertex, columns + 3);
    return 0;
}

static int read_vertex(ply *p, const fxs_ply_element *vertex, const int columns[6], double values[6])
{
    const fxs_ply_encoding encoding = p->header.encoding;
    fxs_ply_begin_row(&p->bytes, encoding);
    for (int i = vertex->first; i < vertex->end; i++) {
        double value;
        FXS_TRY(fxs_ply_read_number(&p->bytes, encoding, p->header.property_table[i].type, &value));
        for (int k = 0; k < 6; k++)
            if (columns[k] == i)
                values[k] = value;
    }
    return fxs_ply_end_row(&p->bytes, encoding);
}

/* Reads the points of a .ply file. With null `points`, only finds the brightest colour. */
static int read_vertices(fxs_photo_points *points, ply *p, const fxs_ply_element *vertex, const int columns[6],
                         double full, double *brightest, fxs_message *message)
{
    const uint64_t start = fxs_bytes_tell(&p->bytes);
    *brightest = 0;
    for (uint64_t i = 0; i < vertex->count; i++) {
        double values[6] = {0, 0, 0, 0, 0, 0}, colour[3] = {GREY, GREY, GREY};
        if (read_vertex(p, vertex, columns, values))
            return fxs_bytes_fail_row(&p->bytes, vertex->name, i, vertex->count, message);
        for (int c = 0; c < 3 && full > 0; c++) {
            *brightest = fmax(*brightest, values[3 + c]);
            colour[c] = floor(255 * values[3 + c] / full + 0.5);
        }
        if (points)
            FXS_TRY(add_point(points, p->source.path, values, colour, message));
    }
    return points ? 0 : fxs_bytes_seek(&p->bytes, start);
}

/* Reads the points of a .ply file. Its float colours are 0 to 1, in some files 0 to 255; the brightest colour
   decides. */
static int read_ply(fxs_photo_points *points, ply *p, fxs_message *message)
{
    int columns[6];
    double full = 0, brightest;
    FXS_TRY(fxs_ply_read_header(&p->header, &p->bytes, message));
    const fxs_ply_element *vertex = fxs_ply_find_element(&p->header, "vertex");
    FXS_TRY(find_columns(p, vertex, columns, &full, message));
    FXS_TRY(fxs_ply_check_size(&p->header, &p->bytes, message));
    if (full == 1) {
        FXS_TRY(read_vertices(NULL, p, vertex, columns, full, &brightest, message));
        full = brightest > 2 ? 255 : 1;
    }
    return read_vertices(points, p, vertex, columns, full, &brightest, message);
}

int fxs_photo_points_ply(fxs_photo_points *points, const char *path, fxs_message *message)
{
    ply *p = calloc(1, sizeof *p);
    if (!p)
        return fxs_fail_memory(message, path, sizeof *p);
    int error = fxs_scene_source_open(&p->source, path, message);
    p->bytes.source = &p->source;
    if (!error)
        error = read_ply(points, p, message);
    fxs_scene_source_close(&p->source);
    free(p);
    return error;
}

int fxs_photo_points_random(fxs_photo_points *p, const double middle[3], double half, uint64_t seed,
                            fxs_message *message)
{
    static const double grey[3] = {GREY, GREY, GREY};
    for (uint64_t i = 0; i < RANDOM_POINTS; i++) {
        double position[3];
        for (uint64_t k = 0; k < 3; k++) {
            const float uniform = fxs_random_uniform(fxs_random(seed, RANDOM_STEP, 3 * i + k));
            position[k] = middle[k] + half * (2 * (double)uniform - 1);
        }
        FXS_TRY(add_point(p, "random points", position, grey, message));
    }
    return 0;
}
