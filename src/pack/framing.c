/* Finds the box of the visible part of a scene from a sample of Gaussians, weighted by opacity and size. On each axis,
 * the box spans the weight quantiles EDGE to 1 - EDGE, and the core spans CORE to 1 - CORE. If the box is not much
 * larger than the core, the scene is a single object. Then the box gets a margin. Otherwise the box covers at least the
 * middle 90 % of the centres. */
#include "framing.h"

#include <math.h>

#include "order.h"
#include "src/gaussian/attributes.h"

#define EDGE 0.002                   /* share of the Gaussians' weight outside the scene's box at each end of an axis */
#define CORE 0.05
/* A scene is a single object if its box has at most SPREAD times the radius of its core (middle of the weight). */
#define SPREAD 1.5
#define FAR_OUT 8            /* outlying Gaussians are farther from the middle than FAR_OUT times the median distance */

fxs_seen fxs_seen_of(const fxs_gaussian *g)
{
    const double a = (double)g->scale[0], b = (double)g->scale[1], c = (double)g->scale[2];
    const double largest = fmax(fmax(a, b), c), second = fmax(fmin(a, b), fmin(fmax(a, b), c));
    const double opacity = fxs_opacity_of_logit(g->opacity);
    return (fxs_seen){{g->position[0], g->position[1], g->position[2]}, (float)fxs_exp((largest + second) / 2),
                      opacity * 255 < 0.5 ? 0 : (float)opacity};
}

static void sort_places(fxs_seen_place *places, fxs_seen_place *spare, uint32_t count)
{
    for (int shift = 0; shift < 32; shift += 8) {
        fxs_seen_place *from = shift % 16 ? spare : places, *to = shift % 16 ? places : spare;
        uint32_t ends[256 + 1] = {0};
        for (uint32_t i = 0; i < count; i++)
            ends[(fxs_ordered_bits(from[i].x) >> shift & 255) + 1]++;
        for (uint32_t digit = 0; digit < 256; digit++)
            ends[digit + 1] += ends[digit];
        for (uint32_t i = 0; i < count; i++)
            to[ends[fxs_ordered_bits(from[i].x) >> shift & 255]++] = from[i];
    }
}

static fxs_seen_place place(float x, uint32_t index)
{
    return (fxs_seen_place){x + 0.0f, index};     /* adding 0 turns -0 into 0 */
}

static void sort_axis(fxs_seen_place *places, fxs_seen_place *spare, const fxs_seen *seen, uint32_t count, int axis)
{
    for (uint32_t i = 0; i < count; i++)
        places[i] = place(seen[i].position[axis], i);
    sort_places(places, spare, count);
}

/* Returns the coordinate x at which the running sum of the Gaussians' weights reaches `share` of their total. */
static double quantile(const fxs_seen_place *places, const fxs_seen *seen, uint32_t count, double share)
{
    double total = 0, sum = 0;
    uint32_t i = 0;
    for (uint32_t k = 0; k < count; k++)
        total += (double)seen[places[k].index].weight;
    for (; i + 1 < count; i++)
        if ((sum += (double)seen[places[i].index].weight) >= share * total)
            break;
    return (double)places[i].x;
}

/* Finds the box that excludes a share `edge` of the Gaussians' weight at each end of each axis. Returns half the box's
   diagonal. */
static double box_of(const fxs_seen_place *places, const fxs_seen *seen, uint32_t count, double edge, double low[3],
                     double high[3])
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = quantile(places + (size_t)axis * count, seen, count, edge);
        high[axis] = quantile(places + (size_t)axis * count, seen, count, 1 - edge);
        square += (high[axis] - low[axis]) * (high[axis] - low[axis]) / 4;
    }
    return sqrt(square);
}

static double middle_distance(fxs_seen_place *places, fxs_seen_place *spare, const fxs_seen *seen, uint32_t count,
                              const double middle[3])
{
    for (uint32_t i = 0; i < count; i++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double away = (double)seen[i].position[axis] - middle[axis];
            square += away * away;
        }
        places[i] = place((float)sqrt(square), i);
    }
    sort_places(places, spare, count);
    return quantile(places, seen, count, 0.5);
}

/* Multiplies the weights of Gaussians by their size, because flat parts of an object have few, large Gaussians. The cap
   keeps a large floater from outweighing a thousand small Gaussians. */
static void weigh(fxs_seen *seen, const fxs_seen_place *distances, uint32_t count, double distance)
{
    for (uint32_t i = 0; i < count; i++) {
        fxs_seen *s = &seen[distances[i].index];
        s->weight *= (double)distances[i].x > FAR_OUT * distance ? 0 : fminf(s->size, (float)distance / 2);
    }
}

/* Lowers the weights of distant Gaussians: divides by (1 + r^2)^2, where r = distance from the middle / median
   distance. */
static void weigh_surroundings(fxs_seen *seen, const fxs_seen_place *distances, uint32_t count, double distance)
{
    for (uint32_t i = 0; i < count; i++) {
        const double ratio = (double)distances[i].x / distance, square = 1 + ratio * ratio;
        seen[distances[i].index].weight /= (float)(square * square);
    }
}

static double size_quantile(fxs_seen_place *places, fxs_seen_place *spare, const fxs_seen *seen, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        places[i] = place(seen[i].size, i);
    sort_places(places, spare, count);
    return quantile(places, seen, count, 0.5);
}

void fxs_seen_bounds(fxs_seen *seen, uint32_t count, fxs_seen_place *places, double low[3], double high[3])
{
    fxs_seen_place *distances = places + 3 * (size_t)count, *spare = distances + count;
    double total = 0, middle[3], seen_low[3], seen_high[3];
    for (uint32_t i = 0; i < count; i++)
        total += (double)seen[i].weight;
    if (!(total > 0))
        return;
    for (int axis = 0; axis < 3; axis++) {
        sort_axis(places + (size_t)axis * count, spare, seen, count, axis);
        middle[axis] = quantile(places + (size_t)axis * count, seen, count, 0.5);
    }
    const double distance = middle_distance(distances, spare, seen, count, middle);
    int outline = 1;
    if (distance > 0) {
        weigh(seen, distances, count, distance);
        const double core = box_of(places, seen, count, CORE, seen_low, seen_high);
        outline = box_of(places, seen, count, EDGE, seen_low, seen_high) <= SPREAD * core;
        if (!outline)
            weigh_surroundings(seen, distances, count, distance);
    }
    box_of(places, seen, count, EDGE, seen_low, seen_high);
    const double margin = outline ? 2 * size_quantile(distances, spare, seen, count) : 0;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = outline ? seen_low[axis] - margin : fmin(low[axis], seen_low[axis]);
        high[axis] = outline ? seen_high[axis] + margin : fmax(high[axis], seen_high[axis]);
    }
}
