/* Builds the binary tree of levels of detail over the chunks of a packed scene. */
#ifndef FXS_TREE_H
#define FXS_TREE_H

#include <fixsplat/pack.h>
#include <fixsplat/internal/packed.h>
#include "coarsen.h"
#include "palette.h"

/* Writes a tree's nodes, chunks and rows behind the tree's header, which exists already. `scene` is open on `data`,
   the whole packed scene. `palette`: the palette that coded the scene, or null. The result depends only on the leaves
   and the palette. options->run must not be null. options->progress gets 0 to 1. Takes 6 MB of memory, 2 MB more per
   thread, and 120 bytes more per chunk. Returns 0, or an error and a message: out of memory, stopped, or fixsplat
   compiled so that floats are computed with more than single precision. */
int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message);

/* ---- Steps, for parts of a scene that are built separately ----

   A part has a run of the leaves, and builds the nodes with all leaves in the run. The nodes' shape follows from the
   boxes of all leaves, their contents from the leaves of the run. The nodes above are merged from the parts' topmost
   nodes and leaves. */

typedef struct fxs_tree fxs_tree;

/* The range of centres that a chunk's codes can express: low xyz, high xyz. The header is in this processor's byte
   order. */
void fxs_chunk_box(const fxs_chunk *chunk, float box[6]);

/* The boxes of chunks from their headers, little-endian as in a packed scene. */
void fxs_chunk_boxes(const unsigned char *chunks, uint32_t count, float (*boxes)[6]);

/* Plans the shape of the tree over `leaves` chunks, at least 2, from their boxes. Copies the options. Returns 0, or
   FXS_ERR_MEMORY and a message. In either case free *tree with fxs_tree_free, which accepts null. */
int fxs_tree_plan(fxs_tree **tree, float (*boxes)[6], uint32_t leaves, const fxs_pack_options *options,
                  fxs_message *message);
void fxs_tree_free(fxs_tree *tree);

/* Counts the nodes with all leaves in first..end - 1, and how many of these are topmost: nodes with a parent that has
   other leaves too. */
void fxs_tree_count_within(const fxs_tree *tree, uint32_t first, uint32_t end, uint32_t *nodes, uint32_t *tops);

/* Properties of a node besides its chunk. Little-endian where they are written to a file. */
typedef struct fxs_node_sums {
    double error, size;                /* as in fxs_merge_error */
    double opacity, own, area;         /* sums of opacities: of the leaves below, of the node's Gaussians, of the
                                          latter times area */
} fxs_node_sums;

static inline void fxs_node_sums_turn(fxs_node_sums *sums)
{
    fxs_little_endian(sums, 0, sizeof *sums / sizeof(double), sizeof(double));
}

/* Layout of a topmost node, little-endian: u32 place among the nodes of its run, u32 number of its Gaussians. From
   FXS_TREE_TOP_HEAD on: its Gaussians as fxs_coarse (only floats), merged but not yet coded. */
enum { FXS_TREE_TOP_HEAD = 64, FXS_TREE_TOP_BYTES = FXS_TREE_TOP_HEAD + FXS_CHUNK * sizeof(fxs_coarse) };

/* A run of leaves, and the memory for its nodes, in the order of their numbers. */
typedef struct fxs_tree_run {
    const fxs_scene *scene;            /* gives the coding: profile, degree, bytes of a chunk, packed palette */
    const fxs_palette *palette;        /* the palette that coded the leaves, or null */
    uint32_t first, end;               /* leaves */
    const unsigned char *chunks, *rows;        /* of the leaves */
    unsigned char *node_chunks, *node_rows;
    unsigned char *sums, *tops;        /* fxs_node_sums of all nodes, and the topmost nodes; null: not written */
} fxs_tree_run;

/* Builds the nodes of a run. Arguments and errors as for fxs_tree_build. */
int fxs_tree_build_run(fxs_tree *tree, const fxs_tree_run *run, const fxs_pack_options *options, fxs_message *message);

/* Reads the sums of the nodes in first..end - 1, which part number `part` built. The sums are not trusted: they may be
   any numbers. */
void fxs_tree_take_part(fxs_tree *tree, uint32_t part, uint32_t first, uint32_t end, const unsigned char *sums);

/* Callbacks that read parts. Each returns 0, or an error and a message. */
typedef struct fxs_tree_source {
    /* A leaf's header and rows, as in a packed scene; valid until the next call. */
    int (*leaf)(void *argument, uint32_t leaf, const unsigned char **header, const unsigned char **rows,
                fxs_message *message);
    /* The header and Gaussians of a topmost node: at most FXS_CHUNK, positions within +-2^28 units. `at`: its place
       in its part. */
    int (*top)(void *argument, uint32_t part, uint32_t at, fxs_chunk *header, fxs_coarse *gaussians, uint32_t *count,
               fxs_message *message);
    void *argument;
} fxs_tree_source;

/* fxs_tree_count_above counts the nodes that no part has; fxs_tree_build_above builds them. `run` has no leaves. */
uint32_t fxs_tree_count_above(const fxs_tree *tree);
int fxs_tree_build_above(fxs_tree *tree, const fxs_tree_run *run, const fxs_tree_source *source,
                         const fxs_pack_options *options, fxs_message *message);

/* Returns the part that has the node of this number, or FXS_TREE_ABOVE. *at: the node's place in that part, or among
   the nodes above the parts. */
#define FXS_TREE_ABOVE UINT32_MAX
uint32_t fxs_tree_find(const fxs_tree *tree, uint32_t number, uint32_t *at);

/* Writes the node records of a packed scene, after all nodes are built. Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_tree_write(const fxs_tree *tree, unsigned char *nodes, fxs_message *message);

/* ---- Editing ---- */

/* Changes an existing tree: the Gaussians of its nodes, and the gain of opening each. Not thread-safe. */
typedef struct fxs_tree_editor fxs_tree_editor;

/* Begins an edit. `scene` is open on `data`, has a tree with validated nodes and headers, and outlives the editor.
   Returns 0, or an error and a message. fxs_tree_edit_end frees *editor, which is null after an error. */
int fxs_tree_edit(fxs_tree_editor **editor, const fxs_scene *scene, void *data, fxs_message *message);
void fxs_tree_edit_end(fxs_tree_editor *editor);       /* accepts null */

/* Rewrites the chunk of a node from `count` Gaussians, at most FXS_CHUNK. Centres are clamped to the boxes of the
   children's chunks, so edit children before their parents. */
void fxs_tree_edit_node(fxs_tree_editor *editor, uint32_t node, const fxs_gaussian *gaussians, uint32_t count);

/* Rewrites the chunk of a node by merging the coded chunks of its children. */
void fxs_tree_edit_merge(fxs_tree_editor *editor, uint32_t node);

/* Writes the gains of all nodes. `errors`: the squared error that opening each node removes, colours^2 units^2; may
   be negative. Returns 0, or an error and a message. */
int fxs_tree_edit_gains(fxs_tree_editor *editor, const double *errors, fxs_message *message);

#endif
