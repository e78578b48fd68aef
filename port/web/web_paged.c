/* Streamed scenes with levels of detail, and streamed moving scenes, for paged.js. A chunk has 256 Gaussians. Leaves
   are the finest chunks, nodes the coarser chunks of the tree. A moving scene has leaves only. One block of memory
   holds the tables of the leaves, the tables of the nodes, and the pool of loaded chunks. A chunk without a loaded
   header has a copy of its parent's header, because the parent is visible whenever the chunk is. A frame does not read
   the header of a leaf of a moving scene before the leaf is loaded. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/parts.h>
#include "src/core/chunk.h"
#include "src/scene/fxs_file_internal.h"
#include "web.h"

enum { WANTED = 16384 };

static fxs_crc32_table table;

void fxs_web_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    fxs_web_scene *s = (fxs_web_scene *)(uintptr_t)scene;
    (void)argument;
    if (there)
        s->stamps[scene->places[chunk]] = s->turn;
    else if (s->wanted_count < WANTED)
        s->wanted[s->wanted_count++] = chunk;
}

static uint32_t leaves_of(const void *data)
{
    fxs_packed_header header;
    memcpy(&header, data, sizeof header);
    return header.chunk_count;
}

static int moves(const fxs_scene_parts *p)
{
    return p->rows > p->motion;
}

static uint32_t chunks_of(const fxs_scene_parts *p, uint32_t leaves)
{
    return fxs_chunks_with_nodes(leaves, p->bytes > p->tree);
}

/* Checks the header of an .fxs file. Returns 0 if the scene is still and has no levels of detail. Out: bytes of the
   file, bytes of a chunk (256 Gaussians), number of chunks of all levels. */
EXPORT(paged_header) int fxs_web_paged_header(const char *name, const void *header)
{
    fxs_scene_parts p;
    fxs_crc32_fill(&table);
    int error = fxs_file_check_header(name, &table, header, fxs_web_message());
    if (!error && fxs_scene_find_parts(&p, header))
        error = fxs_fail(fxs_web_message(), "%s: damaged: its header is out of range", name);
    if (error)
        return error;
    const uint32_t leaves = leaves_of(header);
    fxs_web_numbers()[0] = (double)p.bytes;
    fxs_web_numbers()[1] = leaves ? (double)((p.tree - p.rows) / leaves) : 0;
    fxs_web_numbers()[2] = chunks_of(&p, leaves);
    return p.bytes > p.tree || moves(&p);
}

static fxs_web_scene *release(fxs_web_scene *s)
{
    if (s) {
        free((void *)(uintptr_t)s->data);
        free((void *)(uintptr_t)s->scene.places);
        free(s->stamps);
        free(s->wanted);
        free((void *)(uintptr_t)s->coarse.chunks);
        free((void *)(uintptr_t)s->coarse.places);
    }
    free(s);
    return NULL;
}

EXPORT(paged_close) void fxs_web_paged_close(fxs_web_scene *s)
{
    release(s);
}

/* Allocates a streamed scene with a pool for `places` chunks. Returns null if memory ran out or the header is not
   valid. Out: number of leaves (finest chunks); address, file offset and size of the palette with the motion, of the
   tree, of the node headers and of the leaf headers; file offsets of the leaves and of the nodes; addresses of the
   pool, of each chunk's place in the pool, of the stamps of last use, of the list of wanted chunks, and of the motion
   (0: the scene is still). */
EXPORT(paged_open) fxs_web_scene *fxs_web_paged_open(const void *header, uint32_t places)
{
    fxs_scene_parts p;
    fxs_web_scene *s = calloc(1, sizeof *s);
    if (!s || fxs_scene_find_parts(&p, header))
        return release(s);
    const uint32_t leaves = leaves_of(header), chunks = chunks_of(&p, leaves);
    const uint64_t pool = p.rows + (p.node_rows - p.tree), bytes = pool + places * ((p.tree - p.rows) / leaves);
    unsigned char *data = bytes <= SIZE_MAX ? fxs_web_allocate((size_t)bytes) : NULL;
    uint32_t *where = malloc(chunks * sizeof *where);
    s->data = data;
    s->scene.places = where;
    s->stamps = calloc(places, sizeof *s->stamps);
    s->wanted = malloc(WANTED * sizeof *s->wanted);
    if (!data || !where || !s->stamps || !s->wanted)
        return release(s);
    memcpy(data, header, sizeof(fxs_packed_header));
    memset(data + sizeof(fxs_packed_header), 0, (size_t)(p.rows - sizeof(fxs_packed_header)));
    memset(where, 0xff, chunks * sizeof *where);
    s->scene.rows = data + pool;
    const double start = (double)(uintptr_t)data, tree = start + (double)p.rows;
    const double out[] = {
        leaves, start + (double)p.palette, (double)p.palette, (double)(p.rows - p.palette),
        tree, (double)p.tree, (double)(p.node_chunks - p.tree),
        tree + (double)(p.node_chunks - p.tree), (double)p.node_chunks, (double)(p.node_rows - p.node_chunks),
        start + sizeof(fxs_packed_header), sizeof(fxs_packed_header), (double)leaves * sizeof(fxs_chunk),
        (double)p.rows, (double)p.node_rows,
        start + (double)pool, (double)(uintptr_t)where, (double)(uintptr_t)s->stamps, (double)(uintptr_t)s->wanted,
        moves(&p) ? start + (double)p.motion : 0};
    memcpy(fxs_web_numbers(), out, sizeof out);
    return s;
}

/* Checks the loaded tables and the first `there` nodes (coarse chunks) of a streamed scene. Copies the headers of
   parents to all other chunks. Out: the numbers of fxs_web_describe (number of Gaussians, box and other facts). */
EXPORT(paged_spread) int fxs_web_paged_spread(fxs_web_scene *s, const char *name, uint32_t there)
{
    const unsigned char *data = s->data, *pool = s->scene.rows;
    const uint32_t *places = s->scene.places;
    fxs_scene *scene = &s->scene;
    fxs_scene_parts p;
    fxs_message *message = fxs_web_message();
    fxs_scene_find_parts(&p, data);
    int error = fxs_scene_open_parts(scene, data, data + p.rows);
    scene->rows = pool;
    scene->places = places;
    if (error)
        return fxs_fail(message, "%s: damaged: no tree where it should be", name);
    error = fxs_file_check_heads(name, &table, data, scene, (size_t)(p.rows - p.palette), message);
    const uint32_t leaves = scene->chunk_count;
    for (uint32_t i = 0; scene->nodes && i < leaves - 1 && !error; i++) {
        fxs_node node;
        if (fxs_node_read(&node, scene, i))
            error = fxs_fail(message, "%s: damaged: node %u of its tree is out of range", name, i);
        for (int k = 0; k < 2 && !error; k++)
            if (node.children[k] < leaves || node.children[k] - leaves >= there)
                memcpy((void *)(uintptr_t)fxs_header(scene, node.children[k]), fxs_header(scene, leaves + i),
                       sizeof(fxs_chunk));
    }
    fxs_web_describe(s);
    return error;
}

EXPORT(paged_headers) int fxs_web_paged_headers(const fxs_web_scene *s, const char *name, uint32_t first, uint32_t end)
{
    fxs_chunk chunk;
    for (uint32_t i = first; i < end; i++)
        if (fxs_chunk_read(&chunk, &s->scene, i))
            return fxs_fail(fxs_web_message(), "%s: damaged: the header of chunk %u is out of range", name, i);
    return 0;
}

EXPORT(paged_rows) int fxs_web_paged_rows(const fxs_web_scene *s, const char *name, uint32_t first, uint32_t end)
{
    int error = 0;
    for (uint32_t i = first; i < end && !error; i++)
        error = fxs_file_check_chunk(name, &table, &s->scene, i, fxs_rows(&s->scene, i), fxs_web_message());
    return error;
}

/* Returns 1 if a chunk belongs to `coarse`: a loaded leaf of a moving scene, else one of the first `there` nodes of the
   tree. A node whose two children are both among these nodes is left out. */
static int is_coarse(const fxs_scene *scene, uint32_t chunk, uint32_t there)
{
    const uint32_t leaves = scene->chunk_count;
    fxs_node node;
    if (!scene->nodes)
        return scene->places[chunk] != FXS_NOTHING;
    const int error = fxs_node_read(&node, scene, chunk - leaves);
    const int is_open = !error && node.children[0] >= leaves && node.children[0] - leaves < there &&
                        node.children[1] >= leaves && node.children[1] - leaves < there;
    return !error && !is_open;
}

/* Makes `coarse`, a version of a streamed scene of `there` chunks. They are the first nodes of its tree, or the loaded
   leaves of a moving scene, at the middle of their lives. */
EXPORT(paged_coarse) int fxs_web_paged_coarse(fxs_web_scene *s, uint32_t there)
{
    const fxs_scene *scene = &s->scene;
    const uint32_t leaves = scene->chunk_count, first = scene->nodes ? leaves : 0;
    const uint32_t end = scene->nodes ? leaves + there : leaves;
    unsigned char *headers = fxs_web_allocate((size_t)there * sizeof(fxs_chunk));
    uint32_t *places = malloc(there * sizeof *places), count = 0;
    s->coarse = *scene;
    s->coarse.nodes = s->coarse.node_chunks = s->coarse.node_rows = s->coarse.motion = NULL;
    s->coarse.chunks = headers;
    s->coarse.places = places;
    if (!headers || !places)
        return FXS_ERR_MEMORY;
    for (uint32_t i = first; i < end && count < there; i++) {
        if (!is_coarse(scene, i, there))
            continue;
        memcpy(headers + (size_t)count * sizeof(fxs_chunk), fxs_header(scene, i), sizeof(fxs_chunk));
        places[count++] = scene->places[i];
    }
    s->coarse.chunk_count = count;
    s->coarse.count = count * FXS_CHUNK;
    return 0;
}

EXPORT(paged_wanted) uint32_t fxs_web_paged_wanted(const fxs_web_scene *s)
{
    return s->wanted_count;
}

EXPORT(paged_turn) uint32_t fxs_web_paged_turn(const fxs_web_scene *s)
{
    return s->turn;
}
