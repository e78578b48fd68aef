/* Statistics of each attribute of a scene's Gaussians. */
#ifndef STATS_H
#define STATS_H

#include <fixsplat/scene.h>

enum { STATS_BINS = 40, STATS_MOST = 13 };

typedef struct attribute_stats {
    const char *name;
    uint64_t count, not_finite;             /* finite values, which the statistics cover; the others */
    double least, median, mean, most;       /* 0 if count is 0 */
    uint64_t bins[STATS_BINS];              /* histogram with bins of equal width, from least to most */
} attribute_stats;

typedef struct scene_stats {
    attribute_stats attributes[STATS_MOST];
    int count;
} scene_stats;

/* Reads an open file to its end. Returns 0, or an error and a message. */
int stats_measure(scene_stats *s, fxs_scene_file *file, const fxs_scene_file_info *info, fxs_message *message);

void stats_print_text(const scene_stats *s);

/* A JSON list of objects. */
void stats_print_json(const scene_stats *s);

#endif
