/* Makes random packed scenes with level-of-detail trees of any shape. Computes their cuts: the tree nodes that a
   frame draws. Nodes are refined in the order of their priorities. */
#ifndef RANDOM_TREE_H
#define RANDOM_TREE_H

#include "random_scene.h"
#include "src/core/cut.h"

/* Makes the inner nodes of a random level-of-detail tree. deep: 1 builds a chain of nodes. alike: 1 gives all nodes
   at equal distance the same priority of refinement. */
static inline void random_nodes(fxs_node *nodes, uint32_t leaves, int deep, int alike)
{
    uint32_t *open = (uint32_t *)calloc(leaves, sizeof *open), count = 0;
    if (!open)
        abort();
    for (uint32_t i = 0; i < leaves - 1; i++) {
        const uint32_t at = !count || deep ? (count ? count - 1 : 0) : (uint32_t)between(0, (int32_t)count - 1);
        if (i) {
            nodes[open[at] / 2].children[open[at] % 2] = leaves + i;
            open[at] = open[--count];
        }
        open[count++] = 2 * i;
        open[count++] = 2 * i + 1;
        nodes[i].gain_q8 = (int16_t)(alike ? 300 : between(-1500, 2500));
        nodes[i].size_q8 = (int16_t)(alike ? 600 : between(-1200, 1200));
        nodes[i].area_q8 = (int16_t)between(-4000, 1000);
        nodes[i].swell_q8 = (uint16_t)between(0, FXS_SWELL_MOST_Q8);
    }
    for (uint32_t leaf = 0; leaf < leaves; leaf++) {
        const uint32_t at = (uint32_t)between(0, (int32_t)count - 1);
        nodes[open[at] / 2].children[open[at] % 2] = leaf;
        open[at] = open[--count];
    }
    for (uint32_t i = 0; i < leaves - 1; i++)
        fxs_node_turn(&nodes[i]);
    free(open);
}

/* Makes a random packed scene with a level-of-detail tree and `leaves` finest chunks (256 Gaussians each), at
   least 2. The caller releases its data with free. */
static inline packed_scene random_tree(enum fxs_profile profile, uint32_t leaves, int deep, int alike)
{
    const int degree = between(0, 2);
    packed_scene all = packed_scene_make(profile, degree, leaves * FXS_CHUNK, between(0, 1)), tree;
    const packed_scene nodes = packed_scene_make(profile, degree, (leaves - 1) * FXS_CHUNK, 0);
    const size_t bytes = all.bytes + fxs_tree_bytes(leaves, fxs_chunk_bytes(profile, degree));
    tree = all;
    tree.data = (unsigned char *)check_aligned(bytes);
    if (!tree.data)
        abort();
    memset(tree.data + all.bytes, 0, bytes - all.bytes);
    tree.bytes = bytes;
    for (uint32_t c = 0; c < leaves; c++)
        fill_chunk(&all, c);
    for (uint32_t c = 0; c < leaves - 1; c++) {
        fill_chunk(&nodes, c);
        fxs_chunk_turn(&nodes.chunks[c]);
    }
    if (all.palette)
        fill_words(all.palette, (size_t)(all.rows - (unsigned char *)all.palette));
    all.header->version = FXS_PACKED_VERSION_TREE;
    packed_scene_turn(&all, leaves);
    memcpy(tree.data, all.data, all.bytes);
    fxs_tree_header header = {FXS_TREE_MAGIC, leaves - 1, 0, {0}};
    fxs_tree_header_turn(&header);
    memcpy(tree.data + all.bytes, &header, sizeof header);
    if (fxs_scene_open(&tree.scene, tree.data, tree.bytes))
        abort();
    random_nodes((fxs_node *)(void *)(tree.data + (tree.scene.nodes - tree.data)), leaves, deep, alike);
    memcpy(tree.data + (tree.scene.node_chunks - tree.data), nodes.chunks, (leaves - 1) * sizeof(fxs_chunk));
    memcpy(tree.data + (tree.scene.node_rows - tree.data), nodes.rows, (size_t)(leaves - 1) * tree.scene.chunk_bytes);
    free(all.data);
    free(nodes.data);
    return tree;
}

static inline void random_cut(fxs_camera *camera, fxs_options *options, uint32_t chunks)
{
    random_view(camera, options);
    if (between(0, 3) == 0) {
        camera->whole_width = camera->width + between(0, 60);
        camera->whole_height = camera->height + between(0, 60);
        camera->whole_x = between(0, camera->whole_width - camera->width);
        camera->whole_y = between(0, camera->whole_height - camera->height);
    }
    const uint32_t budgets[] = {0, 1, FXS_CHUNK, (uint32_t)between(1, 40) * FXS_CHUNK, (chunks - 1) * FXS_CHUNK,
                                UINT32_MAX};
    options->budget = between(0, 2) ? (uint32_t)between(1, (int32_t)chunks * FXS_CHUNK) : budgets[between(0, 5)];
    options->detail_q8 = between(0, 2) ? 0 : (uint32_t)between(1, 1 << between(1, 16));
}

/* Computes the cut of a frame (the nodes of the level-of-detail trees that are drawn) on the CPU. Returns the list of
   drawn chunks (256 Gaussians each), released with free. Null: no object needs a cut. */
static inline fxs_drawn *find_cut(const fxs_object *objects, uint32_t count, const fxs_camera *cameras,
                                  uint32_t eyes, const fxs_options *options, uint32_t *drawn)
{
    fxs_object_view *views = (fxs_object_view *)calloc(count + 1, sizeof *views);
    fxs_stage_view world;
    fxs_cut cut = {objects, count, options, cameras, eyes, views, fxs_cut_room(objects, count, options), 0, 0, 0,
                   0};
    uint32_t chunks = 0;
    fxs_drawn *list = 0;
    *drawn = 0;
    if (!views || fxs_view_init(&world, cameras, options))
        abort();
    for (uint32_t i = 0; i < count; i++) {
        if (fxs_object_view_init(&views[i], &world, cameras, &objects[i]))
            abort();
        views[i].first_chunk = chunks;
        chunks += fxs_cut_chunks(objects[i].scene, cut.room != 0);
    }
    cut.memory = check_aligned(fxs_cut_bytes(cut.room, count, eyes));
    if (cut.room) {
        if (!cut.memory || fxs_cut_find(&cut))
            abort();
        *drawn = cut.count;
        list = (fxs_drawn *)calloc(cut.count + 1, sizeof *list);
        memcpy(list, cut.drawn, cut.count * sizeof *list);
    }
    free(cut.memory);
    free(views);
    return list;
}

#endif
