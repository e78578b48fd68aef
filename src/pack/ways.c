/* Ways of Gaussians that are merged. Times are u = (t - middle) / reach, where e^-u^2 stands for a span of time: its
 * integral is the length of the span, so reach = length / sqrt(pi). The opacity in the span, fade times e^-u^2, is
 *
 *     e^-((u - C) / W)^2 e^-u^2 = share e^-((u - c) / w)^2
 *     1 / w^2 = 1 + 1 / W^2,  c = C / (1 + W^2),  share = e^-(C^2 / (1 + W^2))
 *
 * so that times are merged as positions are. */
#include "ways.h"

#include <math.h>
#include <string.h>

#include "src/base/exponential.h"
#include "src/gaussian/attributes.h"

#define REACH 0.5641895835477563       /* 1 / sqrt(pi) */
#define BRIEF 0.2f      /* below this width a polynomial is not extended to the whole span: the Gaussian stays still */
#define LASTING 0.98f                  /* from this width on, the opacity does not fade within the span */
#define TICK 0x1p-16

static double reach_of(fxs_lifespan span)
{
    return REACH * fmax(span.to - span.from, TICK);
}

static double middle_of(fxs_lifespan span)
{
    return (span.from + span.to) / 2;
}

static double fade_of(const fxs_way *way, double *centre)
{
    const double square = (double)way->width * (double)way->width / (1 - (double)way->width * (double)way->width);
    *centre = (double)way->centre * (1 + square);
    return sqrt(square);
}

double fxs_way_share(const fxs_way *way)
{
    double centre;
    if (way->width >= LASTING)
        return 1;
    const double fade = fade_of(way, &centre);
    return fxs_exp(-centre * centre / (1 + fade * fade)) * (double)way->width;
}

void fxs_way_of(fxs_way *way, fxs_gaussian *g, const fxs_motion *m, fxs_lifespan own, fxs_lifespan set)
{
    const double from = reach_of(own), to = reach_of(set);
    double centre = 0, width = 1, share = 1;
    memset(way, 0, sizeof *way);
    if (m->fade < INFINITY) {
        const double c = (m->centre - middle_of(own)) / from, w = m->fade / from, more = 1 + w * w;
        centre = c / more;
        width = w / sqrt(more);
        share = fxs_exp(-c * c / more);
    }
    way->mean = (float)(share * width * from / to);
    way->width = (float)(width * from / to);
    way->centre = (float)((middle_of(own) + centre * from - middle_of(set)) / to);
    const int stays = way->width < BRIEF;
    const fxs_chunk_time time = {stays ? middle_of(own) + centre * from : middle_of(set), to, {0, 0, 0}};
    double coefficients[3], rest, turn[4];
    for (int i = 0; i < 3 && !stays; i++) {
        fxs_motion_develop(coefficients, &rest, g, m, i, &time);
        for (int k = 0; k < 3; k++)
            way->drift[k][i] = (float)coefficients[k];
    }
    fxs_motion_turn(turn, g, m, &time);
    for (int i = 0; i < 4 && !stays; i++)
        way->turn[i] = (float)turn[i];
    fxs_motion_rest(g, m, &time);
}

void fxs_way_motion(fxs_motion *m, fxs_gaussian *g, const fxs_way *way, fxs_lifespan set)
{
    const double reach = reach_of(set), middle = middle_of(set);
    const double q[4] = {g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]};
    const double t[4] = {way->turn[0], way->turn[1], way->turn[2], way->turn[3]};
    double centre = 0, coefficients[3], rest, turn[4];
    fxs_motion about = {.centre = (float)middle, .fade = INFINITY, .from = -INFINITY, .to = INFINITY};
    fxs_quaternion_product(turn, t, q);
    double unit = reach;
    for (int k = 0; k < 3; k++, unit *= reach)
        for (int i = 0; i < 3; i++)
            about.drift[k][i] = (float)((double)way->drift[k][i] / unit);
    for (int i = 0; i < 4; i++)
        about.turn[i] = (float)(turn[i] / reach);
    *m = about;
    if (way->width >= LASTING)
        return;
    m->fade = (float)(fade_of(way, &centre) * reach);
    m->centre = (float)(middle + centre * reach);
    const fxs_chunk_time time = {m->centre, 1, {0, 0, 0}};
    for (int i = 0; i < 3; i++) {
        fxs_motion_develop(coefficients, &rest, g, &about, i, &time);
        for (int k = 0; k < 3; k++)
            m->drift[k][i] = (float)coefficients[k];
    }
    fxs_motion_rest(g, &about, &time);
}
