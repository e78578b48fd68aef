/* Filters a stream of Gaussians: by position, opacity, SH degree, and for floaters.
 * Stable from version 1.0 on. */
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
#define FXS_FLOATER_STRENGTHS 5

enum fxs_filter_kind { FXS_FILTER_BOX, FXS_FILTER_SPHERE, FXS_FILTER_CYLINDER, FXS_FILTER_KINDS };

/* Of a box the least x, y, z and the greatest; of a sphere the middle and the radius; of a cylinder the middles of its
   two ends, which differ, and the radius. Scene units; surfaces are inside. */
typedef struct fxs_filter_shape {
    enum fxs_filter_kind kind;
    double numbers[7];
} fxs_filter_shape;

typedef struct fxs_scene_filter {
    double low[3], high[3];   /* keeps centres in this box, scene units; -INFINITY to INFINITY: all */
    double middle[3], radius; /* and in this sphere; a radius of INFINITY: all */
    double opacity;           /* the least opacity that is kept, 0 to 1 */
    int sh_degree;            /* the highest SH degree that is kept, 0 to 3 */
    int drawable;             /* 1: leaves out the Gaussians that fxs_pack would leave out */
    int floaters;             /* 1 to 5: leaves out floaters among the others, with this strength: see below */
    const fxs_filter_shape *shapes;   /* keeps, of each kind that is there, centres in one of its shapes; they */
    uint32_t shape_count;             /* stay the caller's, until the file is closed */
} fxs_scene_filter;

typedef struct fxs_scene_filter_report {
    uint64_t read, kept;
    uint64_t outside, faint;   /* left out by position and by opacity */
    uint64_t floaters;         /* left out for too few neighbours */
    fxs_pack_dropped dropped;  /* left out because `drawable` is 1 */
} fxs_scene_filter_report;

/* Sets a filter that keeps every Gaussian. */
FXS_API void fxs_scene_filter_default(fxs_scene_filter *filter);

/* Puts the filter before an open file. From then on, fxs_scene_file_read returns the Gaussians that are kept, and
   info->count and info->sh_degree describe them. The file is read once to count them, and is at its beginning when this
   function returns. `progress` is called with `argument`, and may be null.

   A Gaussian is a floater where fewer than FXS_FLOATER_NEIGHBOURS other centres lie in the cube of 27 cells around it.
   The grid of cells goes through the origin. The width of a cell is the least power of two that is at least 4 times the
   Gaussian's largest sigma, but no less than the width for the median Gaussian. So a large background Gaussian may have
   its neighbours farther away than a small one, and fine detail needs no closer neighbours than the rest. That is
   strength 1. The next ones want neighbours nearby for large Gaussians too: with strength 2 the width for a Gaussian
   whose opacity is below 0.9 is no more than twice the width for the median Gaussian, with strength 3 it is the width
   for the median Gaussian, and with strength 4 so it is for all opacities. With strength 5 a Gaussian floats as well
   where one of the two places one sigma from its centre along its longest axis has too few centres around it. To find
   floaters, the file is read once more, and 28 bytes a Gaussian are held, 60 during the search.

   Returns 0, or an error and a message; the caller must then close the file. Errors: those of fxs_scene_file_read,
   FXS_ERR_FILE where no Gaussian is left, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (degree, strength, shape),
   FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *filter, fxs_scene_file_info *info,
                                  fxs_scene_filter_report *report, fxs_progress_fn *progress, void *argument,
                                  fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
