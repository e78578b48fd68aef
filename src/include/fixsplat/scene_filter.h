/* Filters a stream of Gaussians: by position, opacity, SH degree, and for floaters.
 *
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

/* numbers: for a box the least x, y, z and the greatest; for a sphere the middle and the radius; for a cylinder the
   middles of its two ends, which differ, and the radius. Scene units; surfaces count as inside. */
typedef struct fxs_filter_shape {
    enum fxs_filter_kind kind;
    double numbers[7];
} fxs_filter_shape;

typedef struct fxs_scene_filter {
    double low[3], high[3];   /* keeps centres in this box, scene units; -INFINITY to INFINITY: all */
    double middle[3], radius; /* and in this sphere; a radius of INFINITY: all */
    double opacity;           /* least opacity to keep, 0 to 1 */
    int sh_degree;            /* highest SH degree to keep, 0 to 3 */
    int drawable;             /* 1: drops the Gaussians that fxs_pack would drop */
    int floaters;             /* strength 1 to 5: drops floaters, which are found among the Gaussians that the other
                                 filters keep, see below; 0: keeps floaters */
    /* For each kind with shapes: keeps centres in at least one shape of that kind. Owned by the caller; must stay valid
       until the file is closed. */
    const fxs_filter_shape *shapes;
    uint32_t shape_count;
} fxs_scene_filter;

typedef struct fxs_scene_filter_report {
    uint64_t read, kept;
    uint64_t outside, faint;   /* dropped by position and by opacity */
    uint64_t floaters;         /* dropped for too few neighbours */
    fxs_pack_dropped dropped;  /* dropped because `drawable` is 1 */
} fxs_scene_filter_report;

/* Sets a filter that keeps every Gaussian. */
FXS_API void fxs_scene_filter_default(fxs_scene_filter *filter);

/* Attaches the filter to an open file. From then on, fxs_scene_file_read returns the kept Gaussians, and info->count
   and info->sh_degree describe them. The file is read once to count them, and is at its beginning when the function
   returns. `progress` is called with `argument`, and may be null.

   A Gaussian is a floater if fewer than FXS_FLOATER_NEIGHBOURS other centres lie in the cube of 27 cells around it. The
   grid of cells goes through the origin. The width of a cell is the least power of two that is at least 4 times the
   Gaussian's largest sigma, but at least the width for the Gaussian of median size. So the neighbours of a large
   background Gaussian may be farther away than the neighbours of a small one, and fine detail needs no closer
   neighbours than the median Gaussian. The strengths:
   - 1: as described.
   - 2: for a Gaussian with an opacity below 0.9, the width is at most twice the width for the median Gaussian.
   - 3: for such a Gaussian, the width is the median Gaussian's.
   - 4: for every Gaussian, the width is the median Gaussian's.
   - 5: as 4; a Gaussian is also a floater if one of the two places one sigma from its centre along its longest axis has
     too few centres around it.
   For floaters, the file is read once more, and the filter holds 28 bytes a Gaussian, 60 during the search.

   Returns 0, or an error and a message; the caller must then close the file. Errors: as fxs_scene_file_read,
   FXS_ERR_FILE if no Gaussian is left, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (degree, strength, shape),
   FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *filter, fxs_scene_file_info *info,
                                  fxs_scene_filter_report *report, fxs_progress_fn *progress, void *argument,
                                  fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
