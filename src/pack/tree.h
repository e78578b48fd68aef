/* Builds the tree of levels of detail over the chunks of a packed scene. */
#ifndef FXS_TREE_H
#define FXS_TREE_H

#include <fixsplat/pack.h>
#include <fixsplat/packed.h>
#include "coarsen.h"
#include "palette.h"

/* Writes the nodes of a tree, their chunks and rows behind the header of a tree, which is there. `scene` is open on
   `data`, the whole packed scene; what is written follows from its leaves and from `palette` alone, the one that it
   was coded by, or null. options->run is not null; options->progress is given 0 to 1. Needs 2 MB for each thread,
   6 MB and 120 bytes a chunk. Returns 0, or an error and a message: out of memory, stopped, or floats that are not
   computed in single precision. */
int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message);

/* ---- Steps, for parts of a scene that are built apart ----

   A part has a run of the leaves, and builds the nodes whose leaves all lie in it. These follow from the boxes of all
   leaves, and from the leaves of the run. What is above the parts is merged from their topmost nodes and leaves. */

typedef struct fxs_tree fxs_tree;

/* The box of the centres that a chunk's codes reach: low, high. The header is in this processor's byte order. */
void fxs_chunk_box(const fxs_chunk *chunk, float box[6]);

/* The boxes of chunks by their headers as they lie in a packed scene. */
void fxs_chunk_boxes(const unsigned char *chunks, uint32_t count, float (*boxes)[6]);

/* Plans the tree over `leaves` chunks with these boxes, two or more: which nodes there are. Copies the options. Returns
   0, or FXS_ERR_MEMORY and a message; fxs_tree_free frees *tree in either case, null too. */
int fxs_tree_plan(fxs_tree **tree, float (*boxes)[6], uint32_t leaves, const fxs_pack_options *options,
                  fxs_message *message);
void fxs_tree_free(fxs_tree *tree);

/* How many nodes have all their leaves in first..end - 1, and how many of these have a parent that has not. */
void fxs_tree_count_within(const fxs_tree *tree, uint32_t first, uint32_t end, uint32_t *nodes, uint32_t *tops);

/* What is known of a node beside its chunk; little-endian in memory that is written. */
typedef struct fxs_node_sums {
    double error, size;                /* fxs_merge_error */
    double opacity, own, area;         /* sums of opacities: of the leaves below, of its own Gaussians, times area */
} fxs_node_sums;

static inline void fxs_node_sums_turn(fxs_node_sums *sums)
{
    fxs_little_endian(sums, 0, sizeof *sums / sizeof(double), sizeof(double));
}

/* A topmost node, little-endian: u32 its place among the nodes of its run, u32 the number of its Gaussians; from
   FXS_TREE_TOP_HEAD on the Gaussians (fxs_coarse, floats alone), as they were merged. */
enum { FXS_TREE_TOP_HEAD = 64, FXS_TREE_TOP_BYTES = FXS_TREE_TOP_HEAD + FXS_CHUNK * sizeof(fxs_coarse) };

/* A run of leaves, and where its nodes go, in the order of their numbers. */
typedef struct fxs_tree_run {
    const fxs_scene *scene;            /* profile, degree, bytes of a chunk, packed palette: how all chunks are coded */
    const fxs_palette *palette;        /* by which they were, or null */
    uint32_t first, end;               /* leaves */
    const unsigned char *chunks, *rows;        /* of them */
    unsigned char *node_chunks, *node_rows;
    unsigned char *sums, *tops;        /* fxs_node_sums of all, and the topmost ones; null: not wanted */
} fxs_tree_run;

/* Builds the nodes of a run. Arguments and errors as for fxs_tree_build. */
int fxs_tree_build_run(fxs_tree *tree, const fxs_tree_run *run, const fxs_pack_options *options, fxs_message *message);

/* Takes over the sums, which may be any numbers, of the nodes in first..end - 1 that part number `part` built. */
void fxs_tree_take_part(fxs_tree *tree, uint32_t part, uint32_t first, uint32_t end, const unsigned char *sums);

/* What is read of parts; both return 0, or an error and a message. */
typedef struct fxs_tree_source {
    /* A leaf's header and rows, as in a packed scene, which stay until the next call. */
    int (*leaf)(void *argument, uint32_t leaf, const unsigned char **header, const unsigned char **rows,
                fxs_message *message);
    /* The header and the Gaussians of a topmost node, at most FXS_CHUNK, positions within +-2^28 units; `at`: its place
       in its part. */
    int (*top)(void *argument, uint32_t part, uint32_t at, fxs_chunk *header, fxs_coarse *gaussians, uint32_t *count,
               fxs_message *message);
    void *argument;
} fxs_tree_source;

/* How many nodes no part has; and builds these. `run` has no leaves. */
uint32_t fxs_tree_count_above(const fxs_tree *tree);
int fxs_tree_build_above(fxs_tree *tree, const fxs_tree_run *run, const fxs_tree_source *source,
                         const fxs_pack_options *options, fxs_message *message);

/* Which part has the node of this number, or FXS_TREE_ABOVE, and its place among that part's or these nodes. */
#define FXS_TREE_ABOVE UINT32_MAX
uint32_t fxs_tree_find(const fxs_tree *tree, uint32_t number, uint32_t *at);

/* Once all are built: writes the nodes of a packed scene. Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_tree_write(const fxs_tree *tree, unsigned char *nodes, fxs_message *message);

/* ---- Editing ---- */

/* Changes a tree that is built: the Gaussians of nodes, and what opening each is worth. For one thread. */
typedef struct fxs_tree_editor fxs_tree_editor;

/* Begins. `scene` is open on `data`, has a tree whose nodes and headers were checked, and stays. Returns 0, or an error
   and a message; fxs_tree_edit_end frees *editor, which is null after an error. */
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
