/* What is drawn of a moving scene over its time, as printed by `fixsplat info`. */
#ifndef LIVE_CHUNKS_H
#define LIVE_CHUNKS_H

#include <fixsplat/fixsplat.h>

typedef struct live_chunks {
    double duration, rate;         /* seconds, 0: the scene is still; frames a second, 0: the motion is continuous */
    int loops;
    double mean;                   /* Gaussians in chunks that are drawn at a time: mean, fewest and most */
    uint64_t least, most;
    uint64_t at_start;             /* bytes of the chunks that are drawn from time 0 on */
    double per_second;             /* bytes of the chunks that begin to be drawn later, by the duration */
    uint64_t in_a_second;          /* most bytes of such chunks in one second */
} live_chunks;

/* Measures a scene whose headers are in memory. A scene that does not move gets a duration of 0. */
int live_measure(live_chunks *live, const fxs_scene *scene);

/* Print nothing of a still scene. */
void live_print_text(const live_chunks *live);
void live_print_json(const live_chunks *live);

#endif
