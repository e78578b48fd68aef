/* Builds the binary tree of levels of detail over the chunks of a packed scene. A chunk is 256 Gaussians. The
   leaves of the tree are the chunks of the scene. A node is a chunk of Gaussians merged from the node's children. A
   run is a range of consecutive leaves. */
#ifndef FXS_TREE_H
#define FXS_TREE_H

#include <fixsplat/pack.h>
#include <fixsplat/internal/packed.h>
#include "coarsen.h"
#include "palette.h"

/* Builds the level-of-detail tree of a packed scene: writes nodes, chunks and rows behind the tree's existing header.
   `scene` is open on `data`, the whole packed scene. `palette` is the palette that coded the scene, or null.
   options->workers.run must not be null. Takes 6 MB of memory, 2 MB per thread and 120 bytes per chunk. Returns 0, or
   an error and a message. */
int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message);

/* Functions for a level-of-detail tree that is built in separate parts. A part builds the nodes with all leaves in the
   part's run. The nodes above are merged from the parts' topmost nodes and leaves. */

typedef struct fxs_tree fxs_tree;

/* Computes the range of centres that the position codes of a chunk can express: low x, y, z, high x, y, z. */
void fxs_chunk_box(const fxs_chunk *chunk, float box[6]);

void fxs_chunk_boxes(const unsigned char *chunks, uint32_t count, float (*boxes)[6]);

/* Plans the shape of a level-of-detail tree over at least 2 leaves from their bounding boxes. `spans` are the times in
   which the leaves of a moving scene are alive, as shares of its duration; null: the scene is still. Copies the
   options. Returns 0, or FXS_ERR_MEMORY and a message. Free *tree with fxs_tree_free in either case; null is
   accepted. */
int fxs_tree_plan(fxs_tree **tree, float (*boxes)[6], float (*spans)[2], uint32_t leaves,
                  const fxs_pack_options *options, fxs_message *message);
void fxs_tree_free(fxs_tree *tree);

/* Counts the tree nodes with all leaves in first..end - 1, and the topmost of these nodes. The parent of a topmost node
   has other leaves too. */
void fxs_tree_count_within(const fxs_tree *tree, uint32_t first, uint32_t end, uint32_t *nodes, uint32_t *tops);

/* Properties of a tree node besides its chunk; little-endian in files. */
typedef struct fxs_node_sums {
    double error, size;
    /* sums of opacities: of the leaves below the node, of the node's Gaussians, and of opacity times area */
    double opacity, own, area;
} fxs_node_sums;

static inline void fxs_node_sums_turn(fxs_node_sums *sums)
{
    fxs_little_endian(sums, 0, sizeof *sums / sizeof(double), sizeof(double));
}

/* Layout of a run's topmost tree node in a part file, little-endian: u32 index among the nodes of its run, u32 number
   of its Gaussians. The Gaussians follow at FXS_TREE_TOP_HEAD as fxs_coarse, merged but not yet coded. */
enum { FXS_TREE_TOP_HEAD = 64, FXS_TREE_TOP_BYTES = FXS_TREE_TOP_HEAD + FXS_CHUNK * sizeof(fxs_coarse) };

/* A run (range of consecutive leaves) of the tree, and the memory for its nodes in ascending order of node number. */
typedef struct fxs_tree_run {
    const fxs_scene *scene;
    const fxs_palette *palette;
    uint32_t first, end;               /* the run consists of the tree's leaves first..end - 1 */
    const unsigned char *chunks, *rows;
    unsigned char *node_chunks, *node_rows;
    unsigned char *node_motions;       /* fxs_chunk_motion of the nodes; null: the scene is still */
    unsigned char *sums, *tops;    /* fxs_node_sums of all nodes of the run, and its topmost nodes; null: not written */
} fxs_tree_run;

/* Builds the tree nodes with all leaves in a run. The arguments and errors are like those of fxs_tree_build. */
int fxs_tree_build_run(fxs_tree *tree, const fxs_tree_run *run, const fxs_pack_options *options, fxs_message *message);

/* Reads the sums of the tree nodes with all leaves in first..end - 1, built by part number `part`. The sums may be any
   numbers, because files are not trusted. */
void fxs_tree_take_part(fxs_tree *tree, uint32_t part, uint32_t first, uint32_t end, const unsigned char *sums);

/* Callbacks that read part files (parts of a scene, packed separately). Each callback returns 0, or an error and a
   message. */
typedef struct fxs_tree_source {
    /* Reads the header and rows of a tree leaf (a chunk), in the format of a packed scene. The pointers are valid until
       the next call. */
    int (*leaf)(void *argument, uint32_t leaf, const unsigned char **header, const unsigned char **rows,
                fxs_message *message);
    /* Reads the header and the Gaussians of a part's topmost tree node: at most FXS_CHUNK Gaussians, positions within
       +-2^28 units. `at` is the node's index in its part. */
    int (*top)(void *argument, uint32_t part, uint32_t at, fxs_chunk *header, fxs_coarse *gaussians, uint32_t *count,
               fxs_message *message);
    void *argument;
} fxs_tree_source;

/* fxs_tree_count_above counts the tree nodes that have leaves of several parts; fxs_tree_build_above builds these
   nodes. `run` has no leaves. */
uint32_t fxs_tree_count_above(const fxs_tree *tree);
int fxs_tree_build_above(fxs_tree *tree, const fxs_tree_run *run, const fxs_tree_source *source,
                         const fxs_pack_options *options, fxs_message *message);

/* Returns the part of a tree node, or FXS_TREE_ABOVE if the node has leaves of several parts. *at is the node's index
   in its part, or among the nodes above all parts. */
#define FXS_TREE_ABOVE UINT32_MAX
uint32_t fxs_tree_find(const fxs_tree *tree, uint32_t number, uint32_t *at);

/* Writes the records of all tree nodes of a packed scene, after the nodes are built. Returns 0, or FXS_ERR_MEMORY and a
   message. */
int fxs_tree_write(const fxs_tree *tree, unsigned char *nodes, fxs_message *message);

/* Changes the Gaussians of a level-of-detail tree's nodes, and the gains of opening nodes. Opening a node replaces the
   node by its children. Not thread-safe. */
typedef struct fxs_tree_editor fxs_tree_editor;

/* Begins an edit of a level-of-detail tree. `scene` is open on `data`, has a validated tree, and outlives the editor.
   Returns 0, or an error and a message. Free *editor with fxs_tree_edit_end, which accepts null. */
int fxs_tree_edit(fxs_tree_editor **editor, const fxs_scene *scene, void *data, fxs_message *message);
void fxs_tree_edit_end(fxs_tree_editor *editor);

/* Rewrites the chunk of a tree node from `count` Gaussians, at most FXS_CHUNK. Centres are clamped to the boxes of the
   children's chunks, so edit children before their parents. */
void fxs_tree_edit_node(fxs_tree_editor *editor, uint32_t node, const fxs_gaussian *gaussians, uint32_t count);

/* Rewrites the chunk of a tree node by merging the coded chunks of its children. */
void fxs_tree_edit_merge(fxs_tree_editor *editor, uint32_t node);

/* Writes the gains of all tree nodes. `errors` has the squared error that opening each node removes, colours^2 units^2;
   may be negative. Returns 0, or an error and a message. */
int fxs_tree_edit_gains(fxs_tree_editor *editor, const double *errors, fxs_message *message);

#endif
