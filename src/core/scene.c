/* fxs_scene_open checks a packed scene in the caller's memory and finds its parts; fxs_scene_bytes returns its size.
 * fxs_scene_find_parts and fxs_scene_open_parts do the same for a scene that is only partly in memory. */
#include <fixsplat/internal/parts.h>

#include "animate.h"
#include "memory.h"

typedef struct layout {
    uint64_t palette, motion, rows, bytes;
} layout;

static layout lay_out(uint64_t chunks, uint64_t chunk_bytes, uint64_t palette_bytes)
{
    layout l;
    l.palette = sizeof(fxs_packed_header) + chunks * sizeof(fxs_chunk);
    l.motion = l.rows = l.palette + (palette_bytes + 63) / 64 * 64;
    l.bytes = l.rows + chunks * chunk_bytes;
    return l;
}

static void add_motion(layout *l, uint32_t chunks, uint64_t chunk_bytes, int has_tree)
{
    l->rows = l->motion + fxs_motion_table_bytes(fxs_chunks_with_nodes(chunks, has_tree));
    l->bytes = l->rows + chunks * chunk_bytes;
}

static int layout_of(layout *out, uint32_t count, int sh_degree, enum fxs_profile profile, uint32_t palette_entries)
{
    if (count > FXS_MAX_COUNT || sh_degree < 0 || sh_degree > 3 || (uint32_t)profile > FXS_PROFILE_SMALL)
        return 0;
    uint32_t stages = fxs_palette_stages(profile, sh_degree);
    if (palette_entries > FXS_PALETTE_ENTRIES || !palette_entries != !stages)
        return 0;
    *out = lay_out(fxs_chunks_of(count), fxs_chunk_bytes(profile, sh_degree),
                   (uint64_t)stages * palette_entries * FXS_PALETTE_STRIDE);
    return 1;
}

size_t fxs_scene_bytes(uint32_t count, int sh_degree, enum fxs_profile profile, uint32_t palette_entries)
{
    layout l;
    return layout_of(&l, count, sh_degree, profile, palette_entries) && l.bytes <= SIZE_MAX ? (size_t)l.bytes : 0;
}

size_t fxs_moving_scene_bytes(uint32_t count, int sh_degree, enum fxs_profile profile, uint32_t palette_entries,
                              uint32_t degree, uint32_t flags, int has_tree)
{
    layout l;
    if (!layout_of(&l, count, sh_degree, profile, palette_entries) || degree > FXS_MOTION_DEGREE)
        return 0;
    add_motion(&l, fxs_chunks_of(count),
               (uint64_t)fxs_chunk_bytes(profile, sh_degree) + fxs_motion_bytes(degree, flags), has_tree);
    return l.bytes <= SIZE_MAX ? (size_t)l.bytes : 0;
}

typedef struct tree_layout {
    uint64_t chunks, rows, bytes;
} tree_layout;

static tree_layout lay_out_tree(uint64_t nodes, uint64_t chunk_bytes)
{
    tree_layout l;
    l.chunks = sizeof(fxs_tree_header) + (nodes * sizeof(fxs_node) + 63) / 64 * 64;
    l.rows = l.chunks + nodes * sizeof(fxs_chunk);
    l.bytes = l.rows + nodes * chunk_bytes;
    return l;
}

size_t fxs_tree_bytes(uint32_t chunks, uint32_t chunk_bytes)
{
    if (chunks < 2 || chunks > FXS_MAX_COUNT / FXS_CHUNK)
        return 0;
    const uint64_t bytes = lay_out_tree(chunks - 1, chunk_bytes).bytes;
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

/* The rows of a moving scene are longer by the rows of its motion; open_motion checks their exact size. */
static int chunk_bytes_valid(const fxs_packed_header *h, int moves)
{
    const uint32_t still = fxs_chunk_bytes((enum fxs_profile)h->profile, (int)h->sh_degree);
    const uint32_t most = still + fxs_motion_bytes(FXS_MOTION_DEGREE, FXS_MOTION_TURNS | FXS_MOTION_FADES);
    return h->chunk_bytes == still || (moves && h->chunk_bytes > still && h->chunk_bytes <= most);
}

static int read_header(fxs_packed_header *h, fxs_scene_parts *parts, const void *header)
{
    layout l;
    memcpy(h, header, sizeof *h);
    fxs_packed_header_turn(h);
    if (h->magic != FXS_PACKED_MAGIC)
        return FXS_ERR_SCENE;
    if (h->version < FXS_PACKED_VERSION || h->version > FXS_PACKED_VERSION_MOTION_TREE)
        return FXS_ERR_VERSION;
    const int has_tree = fxs_version_has_tree(h->version), moves = fxs_version_moves(h->version);
    if (h->sh_degree > 3 || h->profile > FXS_PROFILE_SMALL || h->palette_step_q19 > 32767 ||
        !layout_of(&l, h->count, (int)h->sh_degree, (enum fxs_profile)h->profile, h->palette_entries) ||
        h->chunk_count != fxs_chunks_of(h->count) || h->holes > h->count || (has_tree && h->chunk_count < 2) ||
        (moves && !h->chunk_count) || !chunk_bytes_valid(h, moves))
        return FXS_ERR_SCENE;
    if (moves)
        add_motion(&l, h->chunk_count, h->chunk_bytes, has_tree);
    *parts = (fxs_scene_parts){.palette = l.palette, .motion = l.motion, .rows = l.rows, .tree = l.bytes,
                               .node_chunks = l.bytes, .node_rows = l.bytes, .bytes = l.bytes};
    if (has_tree) {
        const tree_layout t = lay_out_tree(h->chunk_count - 1, h->chunk_bytes);
        parts->node_chunks = l.bytes + t.chunks;
        parts->node_rows = l.bytes + t.rows;
        parts->bytes = l.bytes + t.bytes;
    }
    return 0;
}

int fxs_scene_find_parts(fxs_scene_parts *parts, const void *header)
{
    fxs_packed_header h;
    return parts && header ? read_header(&h, parts, header) : FXS_ERR_ARGUMENT;
}

static int open_tree(fxs_scene *scene, const fxs_scene_parts *parts, const unsigned char *start)
{
    fxs_tree_header h;
    memcpy(&h, start, sizeof h);
    fxs_tree_header_turn(&h);
    if (h.magic != FXS_TREE_MAGIC || h.node_count != scene->chunk_count - 1)
        return FXS_ERR_SCENE;
    scene->nodes = start + sizeof h;
    scene->node_chunks = start + (parts->node_chunks - parts->tree);
    return 0;
}

static int open_motion(fxs_scene *scene, const unsigned char *start)
{
    fxs_motion_header h;
    scene->motion = start;
    return fxs_motion_read(&h, scene);
}

/* Opens a packed scene of `bytes` bytes at `head`. If `bytes` is 0, only the headers at `head` and `tree` are in
   memory. The header is read only once, because another program may change it meanwhile. */
static int open_heads(fxs_scene *scene, const unsigned char *head, const unsigned char *tree, size_t bytes)
{
    fxs_packed_header h;
    fxs_scene_parts parts;
    int error = read_header(&h, &parts, head);
    if (!error && bytes && bytes < parts.bytes)
        error = FXS_ERR_SCENE;
    if (error)
        return error;
    memset(scene, 0, sizeof *scene);
    scene->chunks = head + sizeof h;
    scene->palette = h.palette_entries ? (const int8_t *)(head + parts.palette) : 0;
    scene->rows = bytes ? head + parts.rows : 0;
    scene->profile = (enum fxs_profile)h.profile;
    scene->count = h.count - h.holes;
    scene->chunk_count = h.chunk_count;
    scene->chunk_bytes = h.chunk_bytes;
    scene->palette_entries = h.palette_entries;
    scene->palette_step_q19 = h.palette_step_q19;
    scene->sh_degree = (int)h.sh_degree;
    scene->antialiased = (h.flags & FXS_PACKED_ANTIALIASED) != 0;
    if (parts.bytes > parts.tree) {
        tree = bytes ? head + parts.tree : tree;
        error = tree ? open_tree(scene, &parts, tree) : FXS_ERR_ARGUMENT;
        scene->node_rows = bytes ? head + parts.node_rows : 0;
    }
    if (!error && parts.rows > parts.motion)
        error = open_motion(scene, head + parts.motion);
    for (uint32_t i = 0; i < scene->chunk_count && !error; i++) {
        fxs_chunk header;
        error = fxs_chunk_read(&header, scene, i);
    }
    return error;
}

int fxs_scene_open_parts(fxs_scene *scene, const void *head, const void *tree)
{
    return !scene || !head || (uintptr_t)head % 64 || (uintptr_t)tree % 64 ? FXS_ERR_ARGUMENT
                                                                            : open_heads(scene, head, tree, 0);
}

int fxs_scene_open(fxs_scene *scene, const void *data, size_t bytes)
{
    if (!scene || !data || (uintptr_t)data % 64)
        return FXS_ERR_ARGUMENT;
    return bytes < sizeof(fxs_packed_header) ? FXS_ERR_SCENE : open_heads(scene, data, 0, bytes);
}
