/* Reads tileset.json: 3D Tiles 1.0 and 1.1 (OGC 18-053r2, 22-025r4) with explicit tiles. Contents are .glb and .gltf
   files or other tilesets. Draws the finest contents. From tiles refined by ADD, all contents are drawn. From tiles
   refined by REPLACE, contents are drawn if no descendant has contents. Ignores bounding volumes and geometric errors.

   A tileset is z up and its contents are y up. The Gaussians get the axes that a content read alone would have. A
   tileset on the globe is moved to the frame of its first tile there. Otherwise, floats resolve only half a metre at
   the Earth's radius. */
#include <fixsplat/internal/allocator.h>

#include <string.h>

#include "src/scene/formats_internal.h"

#ifdef FXS_WITH_CJSON

#include <cjson/cJSON.h>
#include <math.h>
#include <strings.h>

#include "gltf_internal.h"

enum {
    MAX_CONTENTS = 16384,
    MAX_NESTING = 16,
    MOST_OPEN = 32
};

static const double GLOBE = 1e6;   /* distance in metres from the origin beyond which a tile lies on the globe */

typedef struct matrix {
    double m[3][4];
} matrix;

typedef struct content {
    char *name;
    matrix up, tile;
    int nesting, is_tileset;
    size_t parent;   /* which tileset names this content: 1 + its index among the contents; 0: the first tileset */
    uint64_t device, inode;
    uint64_t count;
    fxs_scene_source source;
    void *reader;
} content;

typedef struct tileset {
    const fxs_scene_source *source;
    fxs_message *message;
    content *contents;
    size_t count, capacity;
    uint64_t repeated;
    int is_on_globe;
    matrix globe;
    matrix frame;
    size_t open;
    size_t at;
    int is_entered;
} tileset;

typedef struct index_file {
    const char *path;
    size_t folder;
    const char *name;
    int nesting;
    size_t itself;             /* 1 + index of this tileset among the contents; 0: the first tileset */
    matrix up;
} index_file;

static int fail(const tileset *t, const char *path, const char *fault)
{
    return fxs_fail(t->message, "%s: %s", path, fault);
}

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static matrix multiply(const matrix *a, const matrix *b)
{
    matrix out;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j] +
                          (j == 3 ? a->m[i][3] : 0);
    return out;
}

static int invert(matrix *out, const matrix *of)
{
    const double (*m)[4] = (const double (*)[4])of->m;
    double determinant = 0;
    int is_finite = 1;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out->m[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int j = 0; j < 3; j++)
        determinant += m[0][j] * out->m[j][0];
    for (int i = 0; i < 3; i++) {
        double *row = out->m[i];
        for (int j = 0; j < 3; j++)
            row[j] /= determinant;
        row[3] = -(row[0] * m[0][3] + row[1] * m[1][3] + row[2] * m[2][3]);
        is_finite &= isfinite(row[0]) && isfinite(row[1]) && isfinite(row[2]) && isfinite(row[3]);
    }
    return is_finite ? 0 : -1;
}

static int grow(tileset *t)
{
    if (t->count == MAX_CONTENTS)
        return fxs_fail(t->message, "%s: more than %d contents of tiles", t->source->path, MAX_CONTENTS);
    if (t->count == t->capacity) {
        const size_t capacity = 2 * t->capacity + 16;
        content *larger = fxs_enlarge(t->source->options.allocator, t->contents, t->count, capacity, sizeof *larger);
        if (!larger)
            return fxs_fail_memory(t->message, t->source->path, capacity * sizeof *larger);
        t->contents = larger;
        t->capacity = capacity;
    }
    return 0;
}

static int add_content(tileset *t, const index_file *from, const cJSON *item, const matrix *tile)
{
    const char *uri = fxs_json_string(item, "uri");
    uri = uri ? uri : fxs_json_string(item, "url");   /* "uri" was called "url" before 3D Tiles 1.0 */
    if (!uri)
        return fail(t, from->path, "the content of a tile has no \"uri\"");
    FXS_TRY(grow(t));
    content *c = memset(&t->contents[t->count++], 0, sizeof *c);
    char *name = c->name = fxs_allocate(t->source->options.allocator, from->folder + strlen(uri) + 1, 1);
    if (!name)
        return fxs_fail_memory(t->message, from->path, from->folder + strlen(uri) + 1);
    if (from->folder > 0)
        memcpy(name, from->name, from->folder);
    strcpy(name + from->folder, uri);
    fxs_decode_percent(name + from->folder);
    FXS_TRY(fxs_check_name(t->source, name + from->folder, t->message));
    c->nesting = from->nesting + 1;
    c->parent = from->itself;
    c->tile = *tile;
    c->up = from->up;
    return 1;
}

static int add_contents(tileset *t, const index_file *from, const cJSON *tile, const matrix *rows)
{
    const cJSON *extensions = member(tile, "extensions"), *more = member(extensions, "3DTILES_multiple_contents");
    const cJSON *lists[] = {member(tile, "contents"), member(more, "contents"), member(more, "content")}, *item;
    const cJSON *one = member(tile, "content");
    int found = one ? add_content(t, from, one, rows) : 0;
    for (int i = 0; i < 3 && found >= 0; i++) {
        if (lists[i] && !cJSON_IsArray(lists[i]))
            return fail(t, from->path, "the \"contents\" of a tile are not an array");
        cJSON_ArrayForEach(item, lists[i])
            if ((found = add_content(t, from, item, rows)) < 0)
                break;
    }
    return found;
}

static int read_transform(const tileset *t, const index_file *from, const cJSON *tile, matrix *out)
{
    double m[16];
    *out = identity;
    if (!member(tile, "transform"))
        return 0;
    if (!fxs_json_numbers(member(tile, "transform"), m, 16) || m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return fail(t, from->path, "the \"transform\" of a tile is not 16 numbers with a last row of 0 0 0 1");
    for (int i = 0; i < 12; i++)
        out->m[i / 4][i % 4] = m[4 * (i % 4) + i / 4];
    return 0;
}

static int read_refine(const tileset *t, const index_file *from, const cJSON *tile, int above)
{
    const char *refine = fxs_json_string(tile, "refine");
    if (!member(tile, "refine"))
        return above;
    if (refine && (strcasecmp(refine, "ADD") == 0 || strcasecmp(refine, "REPLACE") == 0))
        return strcasecmp(refine, "REPLACE") == 0;
    return fail(t, from->path, "the \"refine\" of a tile is neither ADD nor REPLACE");
}

/* Adds the contents to draw from a tile and its children. Returns 1 if any were added, else 0; or an error and a
   message. */
static int add_tile(tileset *t, const index_file *from, const cJSON *tile, const matrix *above, int replaces)
{
    const cJSON *children = member(tile, "children"), *child;
    matrix own;
    int found = 0;
    if (!cJSON_IsObject(tile) || (children && !cJSON_IsArray(children)))
        return fail(t, from->path, "a tile that is not an object, or \"children\" that are not an array");
    if (member(tile, "implicitTiling") || member(member(tile, "extensions"), "3DTILES_implicit_tiling"))
        return fail(t, from->path, "implicit tiling is not read");
    replaces = read_refine(t, from, tile, replaces);
    FXS_TRY(replaces);
    FXS_TRY(read_transform(t, from, tile, &own));
    const matrix rows = multiply(above, &own);
    if (!t->is_on_globe && hypot(hypot(rows.m[0][3], rows.m[1][3]), rows.m[2][3]) > GLOBE) {
        t->is_on_globe = 1;
        t->globe = rows;
    }
    cJSON_ArrayForEach(child, children) {
        const int below = add_tile(t, from, child, &rows, replaces);
        FXS_TRY(below);
        found |= below;
    }
    if (found && replaces)
        return found;
    const int here = add_contents(t, from, tile, &rows);
    return here < 0 ? here : found | here;
}

/* Contents are y up, unless the tileset states another axis. */
static int read_asset(const tileset *t, index_file *from, const cJSON *root)
{
    static const matrix from_y = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    const cJSON *asset = member(root, "asset");
    const char *version = fxs_json_string(asset, "version"), *up = fxs_json_string(asset, "gltfUpAxis");
    if (!version || (strncmp(version, "1.", 2) != 0 && strncmp(version, "0.", 2) != 0))
        return fail(t, from->path, "not 3D Tiles 1: no such version in \"asset\"");
    if (member(asset, "gltfUpAxis") && (!up || (strcasecmp(up, "Y") != 0 && strcasecmp(up, "Z") != 0)))
        return fail(t, from->path, "a \"gltfUpAxis\" that is neither Y nor Z");
    from->up = up && strcasecmp(up, "Z") == 0 ? identity : from_y;
    return 0;
}

static int list_tiles(tileset *t, index_file *from, const fxs_scene_source *source, const matrix *above)
{
    fxs_text json;
    FXS_TRY(fxs_scene_source_load(source, 0, source->input.size, &json, t->message));
    cJSON *root;
    int result = fxs_json_parse(&json, source, &root, t->message);
    fxs_text_let_go(source, &json);
    if (result == 0)
        result = read_asset(t, from, root);
    if (result == 0)
        result = add_tile(t, from, member(root, "root"), above, 1);
    cJSON_Delete(root);
    return result < 0 ? result : 0;
}

/* Returns 1 if two contents are the same file, possibly through links. */
static int is_same(const content *a, const content *b)
{
    return a->inode ? a->inode == b->inode && a->device == b->device : fxs_compare_names(a->name, b->name) == 0;
}

/* Refuses a tileset that contains itself. Limits the total size of contents that several tiles name, because a small
   tileset could otherwise demand much work. */
static int check_identity(tileset *t, size_t index, const fxs_scene_source *source)
{
    content *c = &t->contents[index];
    int is_own = source->inode && source->inode == t->source->inode && source->device == t->source->device;
    c->device = source->device;
    c->inode = source->inode;
    for (size_t above = c->parent; above && !is_own; above = t->contents[above - 1].parent)
        is_own = is_same(c, &t->contents[above - 1]);
    if (is_own)
        return fail(t, source->path, "a tileset that is its own content");
    for (size_t i = 0; i < index; i++)
        if (is_same(c, &t->contents[i])) {
            t->repeated += source->input.size;
            break;
        }
    return t->repeated <= FXS_TEXT_MAX
               ? 0 : fxs_fail(t->message, "%s: contents that several tiles have come to more than %zu MiB",
                              t->source->path, FXS_TEXT_MAX >> 20);
}

static int list_content(tileset *t, size_t index, const fxs_scene_source *source)
{
    static const char *const others[] = {"b3dm", "i3dm", "pnts", "cmpt"};
    content *c = &t->contents[index];
    char magic[4] = "";
    if (source->input.size >= 4)
        FXS_TRY(fxs_scene_source_read(source, 0, magic, 4, t->message));
    for (int i = 0; i < 4; i++)
        if (memcmp(magic, others[i], 4) == 0)
            return fxs_fail(t->message, "%s: the content of a tile is %s, not glTF", source->path, others[i]);
    const fxs_format_row *format;
    FXS_TRY(fxs_format_by_content(source, &format, t->message));
    if (format->reader == &fxs_read_gltf)
        return 0;
    if (format->reader != &fxs_read_tileset)
        return fxs_fail(t->message, "%s: the content of a tile is %s, not glTF", source->path, format->about.name);
    if (c->nesting > MAX_NESTING)
        return fail(t, source->path, "tilesets nested too deep");
    const char *slash = strrchr(c->name, '/');
    index_file from = {source->path, slash ? (size_t)(slash + 1 - c->name) : 0, c->name, c->nesting, index + 1,
                       identity};
    const matrix above = c->tile;
    c->is_tileset = 1;
    return list_tiles(t, &from, source, &above);
}

static int list_all(tileset *t)
{
    index_file from = {t->source->path, 0, NULL, 0, 0, identity};
    int result = list_tiles(t, &from, t->source, &identity);
    for (size_t i = 0; i < t->count && result == 0; i++) {
        fxs_scene_source source;
        result = fxs_scene_source_open_beside(&source, t->source, t->contents[i].name, t->message);
        if (result == 0) {
            strcpy(t->contents[i].name, source.path + strlen(source.path) - strlen(t->contents[i].name));
            result = check_identity(t, i, &source);
        }
        if (result == 0)
            result = list_content(t, i, &source);
        fxs_scene_source_close(&source);
    }
    return result;
}

static void close_content(tileset *t, content *c)
{
    if (c->reader) {
        fxs_read_gltf.close(c->reader);
        t->open--;
    }
    fxs_let_go(t->source, c->reader, fxs_read_gltf.size);
    c->reader = NULL;
    fxs_scene_source_close(&c->source);
}

static int drop_another(void *handle)
{
    tileset *t = handle;
    for (size_t i = t->count; i-- > 0;)
        if (t->contents[i].reader && fxs_gltf_drop(t->contents[i].reader))
            return 1;
    for (size_t i = t->count; i-- > 0;)
        if (t->contents[i].reader && i != t->at) {
            close_content(t, &t->contents[i]);
            return 1;
        }
    return 0;
}

static int open_reader(tileset *t, content *c, fxs_scene_file_info *info)
{
    const matrix tile = multiply(&t->frame, &c->tile);
    matrix frame = multiply(&tile, &c->up);
    FXS_TRY(fxs_scene_source_open_beside(&c->source, t->source, c->name, t->message));
    c->reader = fxs_hold(t->source, fxs_read_gltf.size, t->message);
    if (!c->reader)
        return FXS_ERR_MEMORY;
    memset(c->reader, 0, fxs_read_gltf.size);
    t->open++;
    return fxs_gltf_open(c->reader, &c->source, frame.m, info, t->message);
}

static int open_content(tileset *t, fxs_scene_file_info *info)
{
    content *c = &t->contents[t->at];
    const int result = open_reader(t, c, info);
    if (result)
        close_content(t, c);
    return result;
}

static void leave_content(tileset *t)
{
    if (t->open > MOST_OPEN)
        close_content(t, &t->contents[t->at]);
    t->is_entered = 0;
    do
        t->at++;
    while (t->at < t->count && t->contents[t->at].count == 0);
}

static int enter_content(tileset *t)
{
    content *c = &t->contents[t->at];
    fxs_scene_file_info info = {.count = c->count};
    if (!c->reader)
        FXS_TRY(open_content(t, &info));
    if (info.count != c->count)
        return fail(t, c->source.path, "changed while it was open");
    FXS_TRY(fxs_read_gltf.rewind(c->reader, t->message));
    t->is_entered = 1;
    return 0;
}

static int tileset_rewind(void *handle, fxs_message *message)
{
    tileset *t = handle;
    (void)message;
    t->at = (size_t)-1;
    leave_content(t);
    return 0;
}

static int describe_content(tileset *t, fxs_scene_file_info *info)
{
    fxs_scene_file_info own;
    FXS_TRY(fxs_scene_source_progress(t->source, (double)t->at / (double)t->count, t->message));
    FXS_TRY(open_content(t, &own));
    t->contents[t->at].count = own.count;
    info->count += own.count;
    info->sh_degree = own.sh_degree > info->sh_degree ? own.sh_degree : info->sh_degree;
    if (own.stored_sh_degree > info->stored_sh_degree)
        info->stored_sh_degree = own.stored_sh_degree;
    info->antialiased |= own.antialiased;
    info->linear_light |= own.linear_light;
    info->log_scales |= own.log_scales;
    info->coarse = fmax(info->coarse, own.coarse);
    info->clamped_opacity |= own.clamped_opacity;
    if (own.count == 0 || t->open > MOST_OPEN)
        close_content(t, &t->contents[t->at]);
    if (info->count > INT32_MAX)
        return fxs_fail(t->message, "%s: more than %d Gaussians", t->source->path, INT32_MAX);
    return fxs_limit_gaussians(t->source, info->count, t->message);
}

static int describe(tileset *t, fxs_scene_file_info *info)
{
    /* rotation from axes with z up to axes with y down */
    static const matrix to_ply = {{{-1, 0, 0, 0}, {0, 0, -1, 0}, {0, -1, 0, 0}}};
    matrix back = identity;
    if (t->is_on_globe && invert(&back, &t->globe))
        return fail(t, t->source->path, "the transform of a tile has no inverse");
    t->frame = multiply(&to_ply, &back);
    info->count = 0;
    info->sh_degree = info->stored_sh_degree = info->antialiased = 0;
    for (t->at = 0; t->at < t->count; t->at++)
        if (!t->contents[t->at].is_tileset)
            FXS_TRY(describe_content(t, info));
    if (info->count == 0)
        return fail(t, t->source->path, "no Gaussians in the contents of its tiles");
    return tileset_rewind(t, t->message);
}

static int tileset_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    tileset *t = handle;
    t->source = source;
    t->message = message;
    source->import->drop = drop_another;
    source->import->reader = t;
    FXS_TRY(list_all(t));
    return describe(t, info);
}

static long tileset_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    tileset *t = handle;
    size_t done = 0;
    t->message = message;
    while (done < capacity && t->at < t->count) {
        if (!t->is_entered)
            FXS_TRY(enter_content(t));
        const long count = fxs_read_gltf.read(t->contents[t->at].reader, gaussians + done, capacity - done, message);
        if (count < 0)
            return count;
        done += (size_t)count;
        if (count == 0)
            leave_content(t);
    }
    return (long)done;
}

static void tileset_close(void *handle)
{
    tileset *t = handle;
    for (size_t i = 0; i < t->count; i++) {
        close_content(t, &t->contents[i]);
        fxs_release(t->source->options.allocator, t->contents[i].name);
    }
    fxs_release(t->source->options.allocator, t->contents);
}

#define READER_SIZE sizeof(tileset)

#else

static int tileset_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle;
    (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read 3D Tiles: built without cJSON", source->path);
}

#define READER_SIZE 0
#define tileset_read NULL
#define tileset_rewind NULL
#define tileset_close NULL

#endif

/* Recognises a tileset by the member geometricError, which a glTF file lacks. */
static int is_tileset(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->name && (strstr(head->bytes, "\"geometricError\"") || !strncmp(head->name, "root\"", 5));
}

const fxs_reader fxs_read_tileset = {
    is_tileset, READER_SIZE, tileset_open, tileset_read, tileset_rewind, tileset_close, NULL
};
