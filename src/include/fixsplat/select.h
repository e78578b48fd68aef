/* Finds the Gaussians of objects in a scene, from marked pixels of some of its pictures.
 *
 * For each Gaussian and object, the weights (alpha times transmittance) in the object's pixels are added up, in exact
 * integers; without more, a Gaussian belongs to the object that has most of its weight (FlashSplat, arXiv 2409.08270).
 * Gaussians that no picture shows, or hardly, take after their neighbours: a smallest cut of a graph (max-flow, integer
 * capacities) separates the object, where neighbours are far apart or differ in colour. So an object has the same
 * Gaussians on every machine and for any number of threads. */
#ifndef FXS_SELECT_H
#define FXS_SELECT_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_SELECT_OBJECTS 200u        /* largest number of objects */
#define FXS_SELECT_PERHAPS 254         /* mark of a pixel that is something else, but not for sure */
#define FXS_SELECT_UNKNOWN 255         /* mark of a pixel that is not known */
#define FXS_SELECT_BORDER 255          /* the object of a Gaussian on an object's border, with a trim */
#define FXS_SELECT_VIEWS 4096u         /* largest number of pictures */

/* A picture with marked pixels. */
typedef struct fxs_select_view {
    fxs_camera camera;
    const uint8_t *marks;              /* width * height bytes, rows from the top: 1 to the number of objects: the
                                          pixel shows this object; 0: it shows something else; FXS_SELECT_PERHAPS,
                                          FXS_SELECT_UNKNOWN */
} fxs_select_view;

typedef struct fxs_select_options {
    uint32_t size;
    uint32_t objects;                  /* number of objects, 1 (default) to FXS_SELECT_OBJECTS */
    double bias;                       /* -1 to 1, default 0: this share of a Gaussian's weight is moved from the object
                                          to the rest. Positive: fewer Gaussians at the object's border */
    double trim;                       /* 0 to 1, default 0: Gaussians that a bias higher by this share puts outside of
                                          their object, or a bias lower by it inside of one, are FXS_SELECT_BORDER. A
                                          picture of the object or of the rest without them has no fringe */
    int exact;                         /* 1: by weights alone, without neighbours */
    size_t max_memory;                 /* most bytes of working memory; default 2^31 */
    fxs_workers workers;
    const fxs_allocator *allocator;    /* null: malloc */
} fxs_select_options;
FXS_INIT(fxs_select_options)

/* Finds the objects in a packed scene. objects[i] receives the object of slot i, from 1, 0 for none, or
   FXS_SELECT_BORDER. The array has 256 bytes for each chunk of the scene. Levels of detail are left out. Returns 0, or
   an error and a message: FXS_ERR_ARGUMENT (a mark above the number of objects, no view, an object without a pixel),
   FXS_ERR_OBJECT (an object whose marks show no Gaussian more than others do), FXS_ERR_UNSUPPORTED (a scene that moves
   or is in parts), FXS_ERR_SCENE, FXS_ERR_CAMERA, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_select(const fxs_context *context, const fxs_scene *scene, const fxs_select_view *views,
                                uint32_t view_count, const fxs_select_options *options, uint8_t *objects,
                                fxs_message *message);

/* A click at a pixel, or a box around an object: the pixels from (x, y) to (right, bottom), both included. For a click,
   both are the same pixel. object 0: what is there is something else. */
typedef struct fxs_select_hint {
    int32_t x, y, right, bottom;
    uint32_t object;
} fxs_select_hint;

/* Marks pixels of a picture from clicks and boxes, for fxs_select. Renders the scene. A click marks the region of like
   colour and depth around it; a box, what stands out from its edge. Clicks count more than boxes. Regions of several
   clicks meet at edges of the picture, so a click on something else takes back what another click took too much. What
   is not marked is FXS_SELECT_PERHAPS. `marks` has width * height bytes. Errors as fxs_select; FXS_ERR_ARGUMENT also
   for a hint outside of the picture or on its background. */
FXS_EXPERIMENTAL int fxs_select_mark(const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                                     const fxs_select_hint *hints, uint32_t hint_count, uint8_t *marks,
                                     fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
