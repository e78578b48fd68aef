/* A scene file packed as the viewer packs it, with the slot of each Gaussian of the file. */
#ifndef SLOTTED_SCENE_H
#define SLOTTED_SCENE_H

#include <fixsplat/pack.h>
#include <fixsplat/system.h>
#include "load_scene.h"

typedef struct slotted_scene {
    fxs_packed_scene packed;                /* the bytes of an .fxs, else packed in profile default: the same bytes on
                                               every machine */
    uint32_t *slots;                        /* slot of each Gaussian of the file; FXS_NOTHING: it was left out */
    uint64_t count;                         /* Gaussians of the file */
    fxs_pool *pool;
    uint32_t threads;
} slotted_scene;

/* Opens a scene file without filters. A scene that moves is refused with "a scene that moves " and `still`. After a
   failure, too, the caller calls slotted_close. */
int slotted_open(slotted_scene *s, const char *path, const load_options *load, const char *still);
void slotted_close(slotted_scene *s);

#endif
