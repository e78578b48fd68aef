/* Statistics and histograms of the attributes of a scene's Gaussians. */
#ifndef STATS_H
#define STATS_H

#include <fixsplat/scene.h>

enum { STATS_BINS = 40, STATS_MOST = 13 };

typedef struct attribute_stats {
    const char *name;
    uint64_t count, not_finite;             /* number of finite values, and number of other values */
    double least, median, mean, most;
    uint64_t bins[STATS_BINS];    /* histogram of the finite values, with bins of equal width from `least` to `most` */
} attribute_stats;

typedef struct scene_stats {
    attribute_stats attributes[STATS_MOST];
    int count;
} scene_stats;

/* Computes statistics of a scene file, which is read to its end. Returns 0, or an error code and a message. */
int stats_measure(scene_stats *s, fxs_scene_file *file, const fxs_scene_file_info *info, fxs_message *message);

void stats_print_text(const scene_stats *s);

void stats_print_json(const scene_stats *s);

#endif
