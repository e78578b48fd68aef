/* Lets only some Gaussians of a scene file through, whoever reads it. */
#ifndef FXS_SCENE_FILTER_H
#define FXS_SCENE_FILTER_H

#include <stdint.h>

#include "../files/message.h"
#include "../import/pack.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_scene_filter {
    double low[3], high[3];   /* centres kept, scene units; -INFINITY to INFINITY: all */
    double opacity;           /* the least kept, 0 to 1 */
    int sh_degree;            /* the highest kept, 0 to 3 */
    int drawable;             /* 1: what fxs_pack leaves out is left out too */
} fxs_scene_filter;

typedef struct fxs_scene_filter_report {
    uint64_t read, kept;
    uint64_t outside, faint;   /* left out by position, by opacity */
    fxs_pack_dropped dropped;  /* left out as not drawable */
} fxs_scene_filter_report;

/* Lets everything through. */
void fxs_scene_filter_default(fxs_scene_filter *filter);

/* Puts the filter before an open file: fxs_scene_file_read then gives what is left, and info->count and info->sh_degree
   are set to that. To count it, the file is read once; it is at its beginning then. `progress` may be null. Returns 0,
   or -1 and a message, also where nothing is left: close the file then. */
int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *filter, fxs_scene_file_info *info,
                          fxs_scene_filter_report *report, fxs_progress_fn *progress, void *argument,
                          fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
