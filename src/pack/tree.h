/* Builds the tree of levels of detail over the chunks of a packed scene. */
#ifndef FXS_TREE_H
#define FXS_TREE_H

#include <fixsplat/pack.h>
#include "palette.h"

/* Writes the nodes of a tree, their chunks and rows behind the header of a tree, which is there. `scene` is open on
   `data`, the whole packed scene; what is written follows from its leaves and from `palette` alone, the one that it
   was coded by, or null. options->run is not null; options->progress is given 0 to 1. Needs 2 MB for each thread,
   6 MB and 120 bytes a chunk. Returns 0, or an error and a message: out of memory, or stopped. */
int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message);

#endif
