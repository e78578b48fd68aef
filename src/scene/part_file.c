/* Merges part files of a packed scene into an .fxs file. Headers, SH palette and tree nodes are assembled in
   memory. Chunks of 256 Gaussians are copied from part to output, a few together. */
#include "part_file.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/parts.h>

#include "fxs_file_internal.h"
#include "src/base/report.h"
#include "src/base/files_internal.h"
#include "src/base/output_internal.h"
#include "src/base/run.h"
#include "src/base/source_internal.h"
#include "src/base/try_internal.h"
#include "src/pack/part.h"

enum { TOGETHER = 32 };

static uint32_t checksum_of_chunk(const fxs_crc32_table *table, const unsigned char *header, const unsigned char *rows,
                                  size_t bytes)
{
    fxs_chunk blank;
    memcpy(&blank, header, sizeof blank);
    blank.checksum = 0;
    return fxs_crc32(table, fxs_crc32(table, 0, &blank, sizeof blank), rows, bytes);
}

static void seal_chunk(const fxs_crc32_table *table, unsigned char *header, const unsigned char *rows, size_t bytes)
{
    const uint32_t checksum = fxs_little_32(checksum_of_chunk(table, header, rows, bytes));
    memcpy(header + offsetof(fxs_chunk, checksum), &checksum, sizeof checksum);
}

static uint32_t tree_checksum(const fxs_crc32_table *table, const fxs_part_layout *l, const unsigned char *sums,
                              const unsigned char *tops)
{
    const uint32_t before = fxs_crc32(table, 0, sums, (size_t)(l->node_rows - l->sums));
    return fxs_crc32(table, before, tops, (size_t)(l->bytes - l->tops));
}

static uint32_t head_checksum(const fxs_crc32_table *table, const fxs_part_layout *l, const fxs_part_header *head,
                              const unsigned char *behind)
{
    fxs_part_header blank = *head;
    blank.head_checksum = blank.tree_checksum = 0;
    return fxs_crc32(table, fxs_crc32(table, 0, &blank, sizeof blank), behind, (size_t)(l->rows - l->scene));
}

int fxs_part_file_is(const char *path, fxs_message *message)
{
    uint32_t magic = 0;
    FILE *file;
    if (fxs_file_kind(path) != FXS_FILE_REGULAR)
        return 0;
    FXS_TRY(fxs_file_open(path, &file, NULL, message));
    const int is = fread(&magic, 1, sizeof magic, file) == sizeof magic && fxs_little_32(magic) == FXS_PART_MAGIC;
    fclose(file);
    return is;
}

int fxs_part_file_write(const char *path, const fxs_packed_scene *part, fxs_message *message)
{
    unsigned char *bytes = part->data;
    fxs_crc32_table table;
    fxs_part_header head;
    fxs_packed_header scene;
    fxs_part_layout l;
    fxs_output output;
    memcpy(&head, bytes, sizeof head);
    memcpy(&scene, bytes + sizeof head, sizeof scene);
    fxs_part_header_turn(&head);
    fxs_packed_header_turn(&scene);
    if (fxs_part_lay_out(&l, &head, &scene))
        return fxs_fail(message, "%s: no part of a scene", path);
    fxs_crc32_fill(&table);
    for (uint32_t i = 0; i < head.chunk_count; i++)
        seal_chunk(&table, bytes + l.chunks + i * sizeof(fxs_chunk), bytes + l.rows + (size_t)i * scene.chunk_bytes,
                   scene.chunk_bytes);
    for (uint32_t i = 0; i < head.node_count; i++)
        seal_chunk(&table, bytes + l.node_chunks + i * sizeof(fxs_chunk),
                   bytes + l.node_rows + (size_t)i * scene.chunk_bytes, scene.chunk_bytes);
    fxs_part_header_turn(&head);
    const uint32_t before = head_checksum(&table, &l, &head, bytes + l.scene);
    head.tree_checksum = fxs_little_32(tree_checksum(&table, &l, bytes + l.sums, bytes + l.tops));
    head.head_checksum = fxs_little_32(before);
    memcpy(bytes, &head, sizeof head);
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    (void)fxs_output_write(&output, bytes, part->bytes, message);
    return fxs_output_close(&output, message);
}

typedef struct part {
    const char *path;
    fxs_scene_source source;
    int is_open;
    fxs_part_header head;
    fxs_part_layout layout;
    fxs_packed_header scene;
    unsigned char *heads;
} part;

typedef struct merger {
    const fxs_part_merge *how;
    fxs_message *message;
    fxs_crc32_table table;
    part *parts;
    uint32_t count;
    fxs_packed_header header;
    fxs_scene_parts layout;
    unsigned char *head, *tree_bytes;
    void *head_block, *tree_block;
    fxs_scene scene;
    fxs_palette *palette;
    fxs_tree *tree;
    uint32_t above;
    unsigned char *above_chunks, *above_rows;
    unsigned char *buffer;
    uint64_t written;
} merger;

static int read_at(const merger *m, const part *p, uint64_t offset, void *out, uint64_t size)
{
    return fxs_scene_source_read(&p->source, offset, out, (size_t)size, m->message);
}

static int fail_damaged(const merger *m, const part *p, const char *what)
{
    return fxs_fail(m->message, "%s: %s damaged", p->path, what);
}

static int progress(const merger *m, double done)
{
    return fxs_report(&m->how->progress, done)
               ? fxs_fail_as(FXS_ERR_STOPPED, m->message, "merging stopped") : 0;
}

/* Opens a part file (a piece of a packed scene). Allocates memory only after the file's size agrees with the
   headers. */
static int open_part(merger *m, part *p, const char *path)
{
    fxs_packed_header scene;
    p->path = path;
    p->is_open = 1;
    FXS_TRY(fxs_scene_source_open(&p->source, path, m->message));
    if (p->source.input.size < sizeof p->head + sizeof scene)
        return fxs_fail(m->message, "%s: not a part of a scene, or cut short", path);
    FXS_TRY(read_at(m, p, 0, &p->head, sizeof p->head));
    FXS_TRY(read_at(m, p, sizeof p->head, &p->scene, sizeof p->scene));
    scene = p->scene;
    fxs_part_header_turn(&p->head);
    fxs_packed_header_turn(&scene);
    if (p->head.magic != FXS_PART_MAGIC)
        return fxs_fail(m->message, "%s: not a part of a scene, as convert --block writes", path);
    if (p->head.version != FXS_PART_VERSION || p->head.program != FXS_VERSION_NUMBER)
        return fxs_fail_as(FXS_ERR_VERSION, m->message, "%s: a part by another version of fixsplat; make all parts by "
                           "one", path);
    if (fxs_part_lay_out(&p->layout, &p->head, &scene))
        return fail_damaged(m, p, "the header is");
    if (p->layout.bytes != p->source.input.size)
        return fxs_fail(m->message, "%s: damaged or cut short: %llu bytes, expected %llu", path,
                        (unsigned long long)p->source.input.size, (unsigned long long)p->layout.bytes);
    return 0;
}

static int load_heads(merger *m, part *p)
{
    const uint64_t bytes = p->layout.rows - p->layout.scene;
    fxs_part_header head = p->head;
    p->heads = fxs_allocate(NULL, (size_t)bytes, 1);
    if (!p->heads)
        return fxs_fail_memory(m->message, p->path, bytes);
    FXS_TRY(read_at(m, p, p->layout.scene, p->heads, bytes));
    /* The file may have changed between two reads, so the first header, which was checked, replaces the second. */
    memcpy(p->heads, &p->scene, sizeof p->scene);
    fxs_part_header_turn(&head);
    if (head_checksum(&m->table, &p->layout, &head, p->heads) != p->head.head_checksum)
        return fail_damaged(m, p, "its headers are");
    return 0;
}

static int open_parts(merger *m, char *const *paths, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        part p = {0}, *first = NULL;
        int error = open_part(m, &p, paths[i]);
        for (uint32_t k = 0; k < m->count && !first; k++)
            first = m->parts[k].is_open ? &m->parts[k] : NULL;
        if (!error && first && (first->head.count != p.head.count))
            error = fxs_fail(m->message, "%s: one of %u parts, where %s is one of %u", p.path,
                             (unsigned)p.head.count, first->path, (unsigned)first->head.count);
        if (!error && !m->parts) {
            m->parts = fxs_allocate_zeroed(NULL, p.head.count, sizeof *m->parts);
            m->count = m->parts ? p.head.count : 0;
            error = m->parts ? 0 : fxs_fail_memory(m->message, p.path, 0);
        }
        if (!error && m->parts[p.head.number - 1].is_open)
            error = fxs_fail(m->message, "%s: part %u of %u, as %s is", p.path, (unsigned)p.head.number,
                             (unsigned)p.head.count, m->parts[p.head.number - 1].path);
        if (error) {
            fxs_scene_source_close(&p.source);
            return error;
        }
        m->parts[p.head.number - 1] = p;
    }
    for (uint32_t i = 0; i < m->count; i++)
        if (!m->parts[i].is_open)
            return fxs_fail(m->message, "part %u of %u is missing", (unsigned)i + 1, (unsigned)m->count);
    return 0;
}

static int check_alike(const merger *m, const part *p)
{
    const part *first = &m->parts[0];
    const uint64_t palette = first->layout.palette;
    fxs_packed_header h;
    memcpy(&h, p->heads, sizeof h);
    fxs_packed_header_turn(&h);
    if (h.profile != m->header.profile)
        return fxs_fail(m->message, "%s: of another profile than %s", p->path, first->path);
    if (h.version != m->header.version)
        return fxs_fail(m->message, "%s: %s levels of detail, unlike %s", p->path,
                        h.version == FXS_PACKED_VERSION_TREE ? "with" : "without", first->path);
    if (memcmp(p->heads, first->heads, sizeof h) || memcmp(p->head.source, first->head.source, 8) ||
        p->head.boxes != first->head.boxes || p->head.unit_exponent != first->head.unit_exponent ||
        p->head.centred != first->head.centred ||
        p->layout.rows - p->layout.palette != first->layout.rows - palette ||
        memcmp(p->heads + (p->layout.palette - p->layout.scene), first->heads + (palette - first->layout.scene),
               (size_t)(first->layout.rows - palette)))
        return fxs_fail(m->message, "%s: of another scene than %s", p->path, first->path);
    return 0;
}

static unsigned char *allocate_aligned(void **block, uint64_t bytes)
{
    *block = bytes < SIZE_MAX - 63 ? fxs_allocate_zeroed(NULL, (size_t)bytes + 63, 1) : NULL;
    return *block ? (unsigned char *)(((uintptr_t)*block + 63) / 64 * 64) : NULL;
}

static int put_together(merger *m)
{
    const part *first = &m->parts[0];
    uint32_t boxes = 0;
    m->head = allocate_aligned(&m->head_block, m->layout.rows);
    if (!m->head)
        return fxs_fail_memory(m->message, NULL, m->layout.rows);
    memcpy(m->head, first->heads, sizeof m->header);
    memcpy(m->head + m->layout.palette, first->heads + (first->layout.palette - first->layout.scene),
           (size_t)(first->layout.groups - first->layout.palette));
    for (uint32_t i = 0; i < m->count; i++) {
        const part *p = &m->parts[i];
        memcpy(m->head + sizeof m->header + (size_t)p->head.first * sizeof(fxs_chunk),
               p->heads + (p->layout.chunks - p->layout.scene), p->head.chunk_count * sizeof(fxs_chunk));
    }
    for (uint32_t i = 0; i < m->header.chunk_count; i++) {
        fxs_chunk chunk;
        float box[6];
        memcpy(&chunk, m->head + sizeof m->header + (size_t)i * sizeof chunk, sizeof chunk);
        fxs_chunk_turn(&chunk);
        if (!fxs_chunk_valid(&chunk))
            return fxs_fail(m->message, "%s: the header of chunk %u is damaged", first->path, (unsigned)i);
        fxs_chunk_box(&chunk, box);
        boxes = fxs_part_add_box(&m->table, boxes, box);
    }
    return boxes == first->head.boxes
               ? 0 : fxs_fail(m->message, "%s and the others are no parts of one scene", first->path);
}

static int restore_palette(merger *m)
{
    const part *first = &m->parts[0];
    const fxs_part_layout *l = &first->layout;
    const int8_t *from = (const int8_t *)(m->head + m->layout.palette);
    fxs_palette *p = m->palette = fxs_allocate_zeroed(NULL, 1, sizeof *p);
    if (!p)
        return fxs_fail_memory(m->message, NULL, sizeof *p);
    p->profile = (enum fxs_profile)m->header.profile;
    p->sh_degree = (int)m->header.sh_degree;
    p->stages = fxs_palette_stages(p->profile, p->sh_degree);
    p->entries = m->header.palette_entries;
    p->unit_exponent = first->head.unit_exponent;
    p->centred = first->head.centred;
    p->step = p->unit_exponent >= 8 && p->unit_exponent <= 19
                  ? (int32_t)(m->header.palette_step_q19 >> (19 - p->unit_exponent)) : 0;
    for (uint32_t s = 0; s < p->stages; s++)
        for (uint32_t j = 0; j < p->entries; j++)
            for (uint32_t d = 0; d < FXS_PALETTE_STRIDE; d++)
                p->vectors[s][j][d] = (int16_t)(*from++ * (p->step & 15));
    memcpy(p->groups, first->heads + (l->groups - l->scene), (size_t)(l->rows - l->groups));
    fxs_little_endian(p->groups, 0, (size_t)(l->rows - l->groups) / 2, 2);
    return fxs_palette_restore(p, p->entries) && fxs_palette_step_q19(p) == m->header.palette_step_q19
               ? 0 : fail_damaged(m, first, "its palette is");
}

static int read_leaf(void *argument, uint32_t leaf, const unsigned char **header, const unsigned char **rows,
                     fxs_message *message)
{
    merger *m = argument;
    const size_t bytes = m->header.chunk_bytes;
    uint32_t i = 0;
    (void)message;
    while (leaf >= m->parts[i].head.first + m->parts[i].head.chunk_count)
        i++;
    const part *p = &m->parts[i];
    FXS_TRY(read_at(m, p, p->layout.rows + (uint64_t)(leaf - p->head.first) * bytes, m->buffer, bytes));
    *header = m->head + sizeof m->header + (size_t)leaf * sizeof(fxs_chunk);
    *rows = m->buffer;
    return 0;
}

static int read_top(void *argument, uint32_t number, uint32_t at, fxs_chunk *header, fxs_coarse *gaussians,
                    uint32_t *count, fxs_message *message)
{
    const merger *m = argument;
    const part *p = &m->parts[number];
    uint32_t head[2];
    (void)message;
    for (uint32_t i = 0; i < p->head.top_count; i++) {
        const uint64_t offset = p->layout.tops + (uint64_t)i * FXS_TREE_TOP_BYTES;
        FXS_TRY(read_at(m, p, offset, head, sizeof head));
        if (fxs_little_32(head[0]) != at)
            continue;
        *count = fxs_little_32(head[1]);
        if (*count > FXS_CHUNK)
            break;
        FXS_TRY(read_at(m, p, offset + FXS_TREE_TOP_HEAD, gaussians, *count * sizeof *gaussians));
        FXS_TRY(read_at(m, p, p->layout.node_chunks + (uint64_t)at * sizeof *header, header, sizeof *header));
        fxs_little_endian(gaussians, 0, *count * sizeof *gaussians / sizeof(float), sizeof(float));
        fxs_chunk_turn(header);
        int valid = fxs_chunk_valid(header);
        for (uint32_t g = 0; g < *count; g++)
            for (int k = 0; k < 3; k++)
                valid = valid && fabsf(gaussians[g].gaussian.position[k]) <= 0x1p28f;
        return valid ? 0 : fail_damaged(m, p, "its tree is");
    }
    return fail_damaged(m, p, "its tree is");
}

static int take_part_of_tree(merger *m, uint32_t number)
{
    const part *p = &m->parts[number];
    const fxs_part_layout *l = &p->layout;
    const uint64_t front = l->node_rows - l->sums, back = l->bytes - l->tops;
    const uint32_t end = p->head.first + p->head.chunk_count;
    uint32_t nodes, tops;
    fxs_tree_count_within(m->tree, p->head.first, end, &nodes, &tops);
    if (nodes != p->head.node_count || tops != p->head.top_count)
        return fail_damaged(m, p, "the number of its nodes is");
    unsigned char *bytes = fxs_allocate(NULL, (size_t)(front + back) + 1, 1);
    if (!bytes)
        return fxs_fail_memory(m->message, p->path, front + back);
    int error = read_at(m, p, l->sums, bytes, front);
    if (!error)
        error = read_at(m, p, l->tops, bytes + front, back);
    if (!error && tree_checksum(&m->table, l, bytes, bytes + front) != p->head.tree_checksum)
        error = fail_damaged(m, p, "its tree is");
    if (!error)
        fxs_tree_take_part(m->tree, number, p->head.first, end, bytes);
    for (uint32_t i = 0; i < m->header.chunk_count - 1 && !error; i++) {
        uint32_t at;
        if (fxs_tree_find(m->tree, i, &at) == number)
            memcpy(m->tree_bytes + (m->layout.node_chunks - m->layout.tree) + (size_t)i * sizeof(fxs_chunk),
                   bytes + (l->node_chunks - l->sums) + (size_t)at * sizeof(fxs_chunk), sizeof(fxs_chunk));
    }
    fxs_release(NULL, bytes);
    return error;
}

static int build_above(merger *m)
{
    const size_t bytes = m->header.chunk_bytes;
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = fxs_run_here,
                                      .workers.count = 1};
    const fxs_tree_source source = {read_leaf, read_top, m};
    m->above = fxs_tree_count_above(m->tree);
    m->above_chunks = fxs_allocate(NULL, m->above + 1, sizeof(fxs_chunk));
    m->above_rows = fxs_allocate_zeroed(NULL, m->above + 1, bytes);
    if (!m->above_chunks || !m->above_rows)
        return fxs_fail_memory(m->message, NULL, m->above * (sizeof(fxs_chunk) + bytes));
    const fxs_tree_run run = {.scene = &m->scene, .palette = m->palette, .node_chunks = m->above_chunks,
                              .node_rows = m->above_rows};
    FXS_TRY(fxs_tree_build_above(m->tree, &run, &source, &options, m->message));
    for (uint32_t i = 0; i < m->header.chunk_count - 1; i++) {
        uint32_t at;
        if (fxs_tree_find(m->tree, i, &at) != FXS_TREE_ABOVE)
            continue;
        unsigned char *header = m->above_chunks + at * sizeof(fxs_chunk);
        seal_chunk(&m->table, header, m->above_rows + at * bytes, bytes);
        memcpy(m->tree_bytes + (m->layout.node_chunks - m->layout.tree) + (size_t)i * sizeof(fxs_chunk), header,
               sizeof(fxs_chunk));
    }
    return 0;
}

static int plan_tree(merger *m)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = fxs_run_here,
                                      .workers.count = 1};
    float (*boxes)[6] = fxs_allocate(NULL, m->header.chunk_count, sizeof *boxes);
    if (!boxes)
        return fxs_fail_memory(m->message, NULL, m->header.chunk_count * sizeof *boxes);
    fxs_chunk_boxes(m->head + sizeof m->header, m->header.chunk_count, boxes);
    const int error = fxs_tree_plan(&m->tree, boxes, NULL, m->header.chunk_count, &options, m->message);
    fxs_release(NULL, boxes);
    return error;
}

/* Checks the chunk headers of all nodes of the level-of-detail tree before the output file is opened. */
static int check_nodes(const merger *m)
{
    const unsigned char *headers = m->tree_bytes + (m->layout.node_chunks - m->layout.tree);
    for (uint32_t i = 0; i < m->header.chunk_count - 1; i++) {
        uint32_t at;
        fxs_chunk chunk;
        const uint32_t number = fxs_tree_find(m->tree, i, &at);
        memcpy(&chunk, headers + (size_t)i * sizeof chunk, sizeof chunk);
        fxs_chunk_turn(&chunk);
        if (!fxs_chunk_valid(&chunk))
            return fail_damaged(m, &m->parts[number == FXS_TREE_ABOVE ? 0 : number], "its tree is");
    }
    return 0;
}

static int build_tree(merger *m)
{
    const uint64_t bytes = m->layout.node_rows - m->layout.tree;
    fxs_tree_header tree = {.magic = FXS_TREE_MAGIC, .node_count = m->header.chunk_count - 1};
    m->tree_bytes = allocate_aligned(&m->tree_block, bytes);
    if (!m->tree_bytes)
        return fxs_fail_memory(m->message, NULL, bytes);
    fxs_tree_header_turn(&tree);
    memcpy(m->tree_bytes, &tree, sizeof tree);
    FXS_TRY(plan_tree(m));
    for (uint32_t i = 0; i < m->count; i++)
        FXS_TRY(take_part_of_tree(m, i));
    FXS_TRY(build_above(m));
    FXS_TRY(check_nodes(m));
    return fxs_tree_write(m->tree, m->tree_bytes + sizeof tree, m->message);
}

static int copy_rows(merger *m, fxs_output *output, const part *p, uint64_t offset, const unsigned char *headers,
                     uint32_t count)
{
    const size_t bytes = m->header.chunk_bytes;
    const double all = (double)(m->header.chunk_count) * (m->tree ? 2 : 1);
    FXS_TRY(read_at(m, p, offset, m->buffer, count * bytes));
    for (uint32_t i = 0; i < count; i++) {
        fxs_chunk chunk;
        memcpy(&chunk, headers + i * sizeof chunk, sizeof chunk);
        if (fxs_little_32(chunk.checksum) != checksum_of_chunk(&m->table, headers + i * sizeof chunk,
                                                               m->buffer + i * bytes, bytes))
            return fail_damaged(m, p, "a chunk is");
    }
    FXS_TRY(progress(m, fmin(1, (double)m->written / all)));
    m->written += count;
    return fxs_output_write(output, m->buffer, count * bytes, m->message);
}

static int write_leaves(merger *m, fxs_output *output)
{
    for (uint32_t k = 0; k < m->count; k++) {
        const part *p = &m->parts[k];
        for (uint32_t i = 0; i < p->head.chunk_count; i += TOGETHER) {
            const uint32_t left = p->head.chunk_count - i;
            FXS_TRY(copy_rows(m, output, p, p->layout.rows + (uint64_t)i * m->header.chunk_bytes,
                              m->head + sizeof m->header + ((size_t)p->head.first + i) * sizeof(fxs_chunk),
                              left < TOGETHER ? left : TOGETHER));
        }
    }
    return 0;
}

static int write_nodes(merger *m, fxs_output *output)
{
    const size_t bytes = m->header.chunk_bytes;
    const unsigned char *headers = m->tree_bytes + (m->layout.node_chunks - m->layout.tree);
    FXS_TRY(fxs_output_write(output, m->tree_bytes, (size_t)(m->layout.node_rows - m->layout.tree), m->message));
    for (uint32_t i = 0; i < m->header.chunk_count - 1; i++) {
        uint32_t at;
        const uint32_t number = fxs_tree_find(m->tree, i, &at);
        if (number == FXS_TREE_ABOVE)
            FXS_TRY(fxs_output_write(output, m->above_rows + at * bytes, bytes, m->message));
        else
            FXS_TRY(copy_rows(m, output, &m->parts[number],
                              m->parts[number].layout.node_rows + (uint64_t)at * bytes,
                              headers + (size_t)i * sizeof(fxs_chunk), 1));
    }
    return 0;
}

static int write_all(merger *m, fxs_output *output)
{
    FXS_TRY(fxs_output_write(output, m->head, (size_t)m->layout.rows, m->message));
    FXS_TRY(write_leaves(m, output));
    return m->tree ? write_nodes(m, output) : 0;
}

static int merge(merger *m, char *const *paths, uint32_t count, const char *out)
{
    fxs_output output;
    FXS_TRY(open_parts(m, paths, count));
    for (uint32_t i = 0; i < m->count; i++) {
        FXS_TRY(load_heads(m, &m->parts[i]));
        if (i == 0) {
            memcpy(&m->header, m->parts[0].heads, sizeof m->header);
            fxs_packed_header_turn(&m->header);
        }
        FXS_TRY(check_alike(m, &m->parts[i]));
    }
    if (m->how->tree && m->header.version != FXS_PACKED_VERSION_TREE && m->header.chunk_count > 1)
        return fxs_fail(m->message, "%s: the parts were made without levels of detail", m->parts[0].path);
    if (fxs_scene_find_parts(&m->layout, m->parts[0].heads))
        return fail_damaged(m, &m->parts[0], "the header is");
    FXS_TRY(put_together(m));
    m->buffer = fxs_allocate(NULL, TOGETHER, m->header.chunk_bytes);
    if (!m->buffer)
        return fxs_fail_memory(m->message, NULL, TOGETHER * m->header.chunk_bytes);
    if (m->header.palette_entries)
        FXS_TRY(restore_palette(m));
    if (m->how->change)
        FXS_TRY(m->how->change(m->how->argument, m->head, m->message));
    m->scene = (fxs_scene){.profile = (enum fxs_profile)m->header.profile, .sh_degree = (int)m->header.sh_degree,
                           .chunk_bytes = m->header.chunk_bytes, .palette_entries = m->header.palette_entries,
                           .palette = (int8_t *)(m->head + m->layout.palette),
                           .palette_step_q19 = m->header.palette_step_q19};
    if (m->header.version == FXS_PACKED_VERSION_TREE)
        FXS_TRY(build_tree(m));
    fxs_file_seal_heads(&m->table, m->head, (size_t)(m->layout.rows - m->layout.palette),
                        m->tree ? m->tree_bytes : NULL, (size_t)(m->layout.node_chunks - m->layout.tree));
    FXS_TRY(fxs_output_open(&output, out, 0, m->message));
    fxs_message closing;
    const int error = write_all(m, &output);
    if (error && !output.error)
        output.error = EIO;
    const int closed = fxs_output_close(&output, &closing);
    if (!error && closed)
        *m->message = closing;
    return error ? error : closed;
}

int fxs_part_files_merge(char *const *paths, uint32_t count, const char *out, const fxs_part_merge *how,
                         fxs_message *message)
{
    merger m = {.how = how, .message = message};
    fxs_crc32_fill(&m.table);
    const int error = merge(&m, paths, count, out);
    for (uint32_t i = 0; i < m.count; i++) {
        fxs_release(NULL, m.parts[i].heads);
        if (m.parts[i].is_open)
            fxs_scene_source_close(&m.parts[i].source);
    }
    fxs_tree_free(m.tree);
    fxs_release(NULL, m.parts);
    fxs_release(NULL, m.head_block);
    fxs_release(NULL, m.tree_block);
    fxs_release(NULL, m.palette);
    fxs_release(NULL, m.above_chunks);
    fxs_release(NULL, m.above_rows);
    fxs_release(NULL, m.buffer);
    return error;
}
