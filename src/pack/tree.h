/* Builds the tree of levels of detail over the chunks of a packed scene. */
#ifndef FXS_TREE_H
#define FXS_TREE_H

#include <fixsplat/pack.h>
#include "palette.h"

/* Writes the nodes of a tree, their chunks and rows behind the header of a tree, which is there. `scene` is open on
   `data`, the whole packed scene; what is written follows from its leaves and from `palette` alone, the one that it
   was coded by, or null. options->run is not null; options->progress is given 0 to 1. Needs 2 MB for each thread,
   6 MB and 120 bytes a chunk. Returns 0, or an error and a message: out of memory, stopped, or floats that are not
   computed in single precision. */
int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message);

/* Changes a tree that is built: the Gaussians of nodes, and what opening each is worth. For one thread. */
typedef struct fxs_tree_editor fxs_tree_editor;

/* Begins. `scene` is open on `data`, has a tree, and stays. Returns 0, or an error and a message; fxs_tree_edit_end
   frees *editor, which is null after an error. */
int fxs_tree_edit(fxs_tree_editor **editor, const fxs_scene *scene, void *data, fxs_message *message);
void fxs_tree_edit_end(fxs_tree_editor *editor);       /* null is allowed */

/* Writes the chunk of a node anew, of `count` Gaussians, at most FXS_CHUNK, which are kept within the boxes of its
   children's chunks. These are to be complete: a node comes after what is below it. */
void fxs_tree_edit_node(fxs_tree_editor *editor, uint32_t node, const fxs_gaussian *gaussians, uint32_t count);

/* Merges the chunk of a node anew from those of its children, as they are coded. */
void fxs_tree_edit_merge(fxs_tree_editor *editor, uint32_t node);

/* Writes the gains of all nodes. `errors`: the squared error that opening each node removes, colours^2 units^2, which
   may be below 0. Returns 0, or an error and a message. */
int fxs_tree_edit_gains(fxs_tree_editor *editor, const double *errors, fxs_message *message);

#endif
