/* Chooses the origin of a scene, which is subtracted from all positions. On each axis the origin is the median of a
 * sample of positions, rounded to a multiple of 10 units. It is 0 where floats are precise enough. */
#include "origin_internal.h"
#include <fixsplat/fixsplat.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FAR 4096.0   /* from this coordinate on, a scene gets an origin: floats from 4096 on are at least 2^-11 apart */
#define GRID 10.0                   /* origins are multiples of 10 units, so that they are short as text */

int fxs_is_far(const double place[3])
{
    return fabs(place[0]) >= FAR || fabs(place[1]) >= FAR || fabs(place[2]) >= FAR;
}

void fxs_origin_near(double origin[3], const double place[3])
{
    for (int i = 0; i < 3; i++)
        origin[i] = fabs(place[i]) >= FAR && fabs(place[i]) <= FXS_ORIGIN_FARTHEST - GRID
                        ? GRID * floor(place[i] / GRID + 0.5) : 0;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void fxs_origin_of(double origin[3], double (*places)[3], int count)
{
    double middle[3] = {0}, axis[FXS_ORIGIN_SAMPLE];
    for (int k = 0; k < 3; k++) {
        int n = 0;
        for (int i = 0; i < count; i++)
            if (isfinite(places[i][k]))
                axis[n++] = places[i][k];
        qsort(axis, (size_t)n, sizeof *axis, compare);
        middle[k] = n ? axis[n / 2] : 0;
    }
    fxs_origin_near(origin, middle);
}

double fxs_spacing_at(const double place[3], const double origin[3])
{
    int exponent;
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, fabs(place[i] - origin[i]));
    frexp(most, &exponent);
    return most >= 0x1p16 ? ldexp(1, exponent - 24) : 0;
}
