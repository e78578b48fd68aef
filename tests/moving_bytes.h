/* Reads moving scenes that a test builds in memory, and moves their Gaussians by the formulas of scene.h, in
   doubles. */
#ifndef MOVING_BYTES_H
#define MOVING_BYTES_H

#include "scene_bytes.h"

/* A Gaussian at a moment: opacity 0 where it does not exist. */
typedef struct moment_gaussian {
    double position[3], rotation[4], opacity;
} moment_gaussian;

static inline moment_gaussian at_moment(const fxs_gaussian *g, const fxs_motion *m, double t)
{
    const double d = t - (double)m->centre, ratio = d / (double)m->fade;
    moment_gaussian out;
    for (int i = 0; i < 3; i++)
        out.position[i] = (double)g->position[i] + d * (double)m->drift[0][i] + d * d * (double)m->drift[1][i] +
                          d * d * d * (double)m->drift[2][i];
    for (int i = 0; i < 4; i++)
        out.rotation[i] = (double)g->rotation[i] + d * (double)m->turn[i];
    out.opacity = t >= (double)m->from && t < (double)m->to ? opacity_of(g) * exp(-ratio * ratio) : 0;
    return out;
}

/* Reads the file in memory twice, in calls of one Gaussian and in calls of as many as the reader gives. Returns the
   number of Gaussians, or the error code of the reader. */
static inline long read_moving(fxs_gaussian *gaussians, fxs_motion *motions, long capacity)
{
    fxs_scene_file *file;
    fxs_gaussian one;
    long count, total = 0, again = 0;
    const int error = fxs_scene_file_open_memory(path, bytes, file_size, &open_options, &file, &info, &message);
    if (error)
        return error;
    while ((count = fxs_scene_file_read(file, gaussians + total, (size_t)(capacity - total), &message)) > 0) {
        const fxs_motion *given = fxs_scene_file_motions(file);
        if (CHECK(given != NULL))
            memcpy(motions + total, given, (size_t)count * sizeof *given);
        total += count;
    }
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    while (count >= 0 && again < total && fxs_scene_file_read(file, &one, 1, &message) == 1) {
        CHECK(!memcmp(&one, &gaussians[again], sizeof one) &&
              !memcmp(fxs_scene_file_motions(file), &motions[again], sizeof *motions));
        again++;
    }
    fxs_scene_file_close(file);
    CHECK(count < 0 || (again == total && total == (long)info.count));
    return count < 0 ? count : total;
}

#endif
