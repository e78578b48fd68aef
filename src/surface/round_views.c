/* Views that together see every side of a box, from around it or from within. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/surface.h>
#include "src/base/sine.h"

#define GOLDEN_TURN 0.38196601125010515      /* 2 - golden ratio, as part of a turn */

static int check_box(const double low[3], const double high[3], int size, fxs_message *message)
{
    double longest = 0;
    for (int i = 0; i < 3; i++) {
        if (!(high[i] >= low[i]) || !(fabs(low[i]) <= 0x1p28) || !(fabs(high[i]) <= 0x1p28))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a box without a size, or beyond 2^28 units");
        longest = high[i] - low[i] > longest ? high[i] - low[i] : longest;
    }
    if (!(longest > 0) || size < 1 || size > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a box without a size, or a picture of %d pixels", size);
    return 0;
}

/* Finds the nearest depth of the box's corners, and the largest tangent of their directions from the axis. */
static void measure_corners(const fxs_view *view, const double low[3], const double high[3], double *nearest,
                            double *widest)
{
    *nearest = INFINITY;
    *widest = 0;
    for (int corner = 0; corner < 8; corner++) {
        double at[3] = {0};
        for (int k = 0; k < 9; k++)
            at[k / 3] += view->rotation[k] * ((corner >> k % 3 & 1 ? high : low)[k % 3] - view->position[k % 3]);
        *nearest = at[2] < *nearest ? at[2] : *nearest;
        for (int k = 0; k < 2; k++)
            *widest = fabs(at[k]) / at[2] > *widest ? fabs(at[k]) / at[2] : *widest;
    }
}

static int look_from(fxs_view *view, const double direction[3], const double low[3], const double high[3], int size,
                     fxs_message *message)
{
    double middle[3], eye[3], square = 0, nearest, widest;
    for (int i = 0; i < 3; i++) {
        middle[i] = (low[i] + high[i]) / 2;
        square += (high[i] - low[i]) * (high[i] - low[i]) / 4;
    }
    for (int i = 0; i < 3; i++)
        eye[i] = middle[i] + 3 * sqrt(square) * direction[i];
    const double up[3] = {0, fabs(direction[1]) < 0.9, !(fabs(direction[1]) < 0.9)};
    const int error = fxs_view_look_at(view, eye, middle, up, &(fxs_picture){40, size, size}, message);
    if (error)
        return error;
    measure_corners(view, low, high, &nearest, &widest);
    view->fx = view->fy = 0.49 * size / widest;
    view->near = 0.99 * nearest > 0x1p-20 ? 0.99 * nearest : 0x1p-20;
    return 0;
}

int fxs_views_around(fxs_view *views, uint32_t count, const double low[3], const double high[3], int size,
                     fxs_message *message)
{
    int error = check_box(low, high, size, message);
    for (uint32_t i = 0; i < count && !error; i++) {
        const double z = 1 - (2.0 * i + 1) / count, wide = sqrt(1 - z * z), turn = i * GOLDEN_TURN;
        const double direction[3] = {wide * fxs_sine(turn + 0.25), z, wide * fxs_sine(turn)};
        error = look_from(&views[i], direction, low, high, size, message);
    }
    return error;
}

/* The places as parts of the box: its middle, the middles of its eighths, and places near the middles of its sides. */
static void place_within(uint32_t number, double part[3])
{
    for (uint32_t i = 0; i < 3; i++) {
        part[i] = 0.5;
        if (number >= 1 && number < 9)
            part[i] = (number - 1) >> i & 1 ? 0.75 : 0.25;
        if (number >= 9 && (number - 9) / 2 == i)
            part[i] = number % 2 ? 0.15 : 0.85;
    }
}

int fxs_views_within(fxs_view *views, const double low[3], const double high[3], int size, fxs_message *message)
{
    int error = check_box(low, high, size, message);
    for (uint32_t i = 0; i < FXS_VIEWS_WITHIN && !error; i++) {
        const uint32_t axis = i % 6 / 2;
        double eye[3], target[3], part[3], longest = 0;
        const double up[3] = {0, axis != 1, axis == 1};
        place_within(i / 6, part);
        for (uint32_t k = 0; k < 3; k++) {
            longest = high[k] - low[k] > longest ? high[k] - low[k] : longest;
            eye[k] = low[k] + part[k] * (high[k] - low[k]);
        }
        for (uint32_t k = 0; k < 3; k++)
            target[k] = eye[k] + (k == axis ? i % 2 ? -longest : longest : 0);
        error = fxs_view_look_at(&views[i], eye, target, up, &(fxs_picture){90, size, size}, message);
        if (!error) {
            const double near = longest / 200;
            views[i].near = near > 0x1p-20 ? near : 0x1p-20;
        }
    }
    return error;
}
