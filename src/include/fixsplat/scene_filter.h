/* Lets only some Gaussians of a scene file through, whoever reads it. */
#ifndef FXS_SCENE_FILTER_H
#define FXS_SCENE_FILTER_H

#include <stdint.h>

#include "fixsplat.h"
#include "pack.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_FLOATER_NEIGHBOURS 8

typedef struct fxs_scene_filter {
    double low[3], high[3];   /* centres kept, scene units; -INFINITY to INFINITY: all */
    double middle[3], radius; /* and of these those within a sphere; INFINITY: all */
    double opacity;           /* the least kept, 0 to 1 */
    int sh_degree;            /* the highest kept, 0 to 3 */
    int drawable;             /* 1: what fxs_pack leaves out is left out too */
    int floaters;             /* 1: of the rest, what floats is left out: see below */
} fxs_scene_filter;

typedef struct fxs_scene_filter_report {
    uint64_t read, kept;
    uint64_t outside, faint;   /* left out by position, by opacity */
    uint64_t floaters;         /* left out because nearly nothing is near them */
    fxs_pack_dropped dropped;  /* left out where `drawable` is 1 */
} fxs_scene_filter_report;

/* Lets everything through. */
void fxs_scene_filter_default(fxs_scene_filter *filter);

/* Puts the filter before an open file. From then on fxs_scene_file_read gives what is left, and info->count and
   info->sh_degree are set to that. To count it, the file is read once; it is at its beginning when this returns.
   `progress` is called with `argument`, and may be null.

   A Gaussian floats where fewer than FXS_FLOATER_NEIGHBOURS others have their centres in the cube of 27 cells around
   it. The cells are those of a grid through the origin; their width is the least power of two that is 4 of the
   Gaussian's largest sigma or more, and no less than that of the median Gaussian. So a large Gaussian of a background
   is asked for neighbours farther away than a small one, and fine detail is asked for no more than the rest. To find
   them, the file is read once more, and 16 bytes a Gaussian are held, 48 while they are found.

   Returns 0, or an error and a message; the file is to be closed then. Errors: those of
   fxs_scene_file_read, FXS_ERR_FILE where nothing is left, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (the degree),
   FXS_ERR_MEMORY. */
int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *filter, fxs_scene_file_info *info,
                          fxs_scene_filter_report *report, fxs_progress_fn *progress, void *argument,
                          fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
