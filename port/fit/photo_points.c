#include "photo_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../camera/colmap_internal.h"
#include "../files/message.h"
#include "random.h"

#define MOST_POINTS FXS_GAUSSIANS_CEILING
#define FARTHEST 134217728.0       /* 2^27 scene units, as the renderer has them */
#define RANDOM_POINTS 100000
#define RANDOM_STEP UINT64_MAX     /* no step of a fit */
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

/* ---- COLMAP ------------------------------------------------------------------------------------------------------ */

static int read_binary(fxs_photo_points *p, const fxs_text *text, fxs_message *message)
{
    fxs_colmap_cursor in = fxs_colmap_begin(text);
    for (uint64_t count = fxs_colmap_take(&in, 8); count && !in.short_of; count--) {
        double position[3], colour[3];
        fxs_colmap_take(&in, 8);   /* its id */
        fxs_colmap_take_doubles(&in, position, 3);
        for (int i = 0; i < 3; i++)
            colour[i] = (double)fxs_colmap_take(&in, 1);
        fxs_colmap_take(&in, 8);   /* its error */
        fxs_colmap_skip(&in, fxs_colmap_take(&in, 8), 8);   /* images and their points */
        if (!in.short_of)
            FXS_TRY(add_point(p, text->path, position, colour, message));
    }
    return in.short_of ? fxs_fail(message, "%s: cut short", text->path) : 0;
}

static int read_plain(fxs_photo_points *p, const fxs_text *text, fxs_message *message)
{
    char *rest = text->data, *line;
    while ((line = fxs_colmap_entry(&rest))) {
        double values[7];          /* id, position, colour */
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

/* ---- Random ------------------------------------------------------------------------------------------------------ */

int fxs_photo_points_random(fxs_photo_points *p, const double middle[3], double half, uint64_t seed,
                            fxs_message *message)
{
    static const double grey[3] = {GREY, GREY, GREY};
    for (uint64_t i = 0; i < RANDOM_POINTS; i++) {
        double position[3];
        for (uint64_t k = 0; k < 3; k++)
            position[k] = middle[k] + half * (2 * (double)fxs_fit_uniform(fxs_fit_random(seed, RANDOM_STEP, 3 * i + k)) - 1);
        FXS_TRY(add_point(p, "random points", position, grey, message));
    }
    return 0;
}
