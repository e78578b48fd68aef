/* Reads meshes: .ply and .obj (here), .glb and .gltf (gltf.c). Faces with more than three corners are split. */
#include "volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/foreign.h"
#include "src/base/os_calls.h"
#include "src/base/sine.h"
#include "src/base/source_internal.h"
#include "src/base/try_internal.h"
#include "src/scene/read/gltf_internal.h"
#include "src/scene/read/ply_header.h"

enum { CORNERS_MOST = 1 << 16, EARS_MOST = 64, WORD = 256, HEAD = 512 };
enum { SIDE_BITS = 27 };         /* places along the longest side of the box, log2 */

typedef struct reading {
    fxs_scene_source source;
    fxs_import import;
    fxs_message *message;
    double (*at)[3];
    uint32_t (*triangles)[3];
    size_t vertices, vertex_room, count, room;
    uint32_t *corners;           /* of the face that is read */
    size_t corner_count, corner_room;
    fxs_byte_reader bytes;
    fxs_ply_header ply;
    uint64_t line;
    int failed;                  /* an error whose message is written */
} reading;

/* ---- Vertices and triangles -------------------------------------------------------------------------------------- */

/* Makes room for another item. The bytes count against the memory limit. */
static int make_room(reading *r, void **items, size_t count, size_t *room, size_t size)
{
    const size_t larger = *room ? 2 * *room : 1024;
    if (count < *room)
        return 0;
    if (larger > UINT32_MAX / 3)
        return fxs_fail(r->message, "%s: more than %" PRIu32 " vertices or triangles", r->source.path, UINT32_MAX / 3);
    void *block = fxs_hold(&r->source, (uint64_t)larger * size, r->message);
    if (!block)
        return FXS_ERR_MEMORY;
    if (count)
        memcpy(block, *items, count * size);
    fxs_let_go(&r->source, *items, (uint64_t)*room * size);
    *items = block;
    *room = larger;
    return 0;
}

static int take_vertex(void *argument, const double at[3], fxs_message *message)
{
    reading *r = argument;
    void *items = r->at;
    const int error = make_room(r, &items, r->vertices, &r->vertex_room, sizeof *r->at);
    (void)message;
    r->at = items;
    if (!error)
        memcpy(r->at[r->vertices++], at, sizeof *r->at);
    return error;
}

static int take_triangle(void *argument, const uint32_t corners[3], fxs_message *message)
{
    reading *r = argument;
    void *items = r->triangles;
    const int error = make_room(r, &items, r->count, &r->room, sizeof *r->triangles);
    (void)message;
    r->triangles = items;
    if (!error)
        memcpy(r->triangles[r->count++], corners, sizeof *r->triangles);
    return error;
}

/* ---- Faces with more than three corners -------------------------------------------------------------------------- */

static int take_corner(reading *r, uint64_t vertex)
{
    void *items = r->corners;
    if (r->corner_count == CORNERS_MOST)
        return fxs_fail(r->message, "%s: a face with more than %d corners", r->source.path, CORNERS_MOST);
    if (vertex >= UINT32_MAX)
        return fxs_fail(r->message, "%s: a face with a vertex that does not exist", r->source.path);
    const int error = make_room(r, &items, r->corner_count, &r->corner_room, sizeof *r->corners);
    r->corners = items;
    if (!error)
        r->corners[r->corner_count++] = (uint32_t)vertex;
    return error;
}

static int take_three(reading *r, size_t a, size_t b, size_t c)
{
    return take_triangle(r, (uint32_t[]){r->corners[a], r->corners[b], r->corners[c]}, r->message);
}

/* Twice the signed area of three points of a face, seen along the two axes in which the face is largest. */
static double turn_of(const reading *r, const int axes[2], uint32_t a, uint32_t b, uint32_t c)
{
    const double *p = r->at[a], *q = r->at[b], *s = r->at[c];
    const int x = axes[0], y = axes[1];
    return (q[x] - p[x]) * (s[y] - p[y]) - (q[y] - p[y]) * (s[x] - p[x]);
}

/* Chooses axes in which the area of the face is positive, and largest. Returns twice this area. */
static double choose_axes(const reading *r, int axes[2])
{
    double area[3] = {0};
    int most = 0;
    for (size_t i = 2; i < r->corner_count; i++)
        for (int k = 0; k < 3; k++)
            area[k] += turn_of(r, (int[]){(k + 1) % 3, (k + 2) % 3}, r->corners[0], r->corners[i - 1], r->corners[i]);
    for (int k = 1; k < 3; k++)
        most = fabs(area[k]) > fabs(area[most]) ? k : most;
    axes[area[most] < 0] = (most + 1) % 3;
    axes[!(area[most] < 0)] = (most + 2) % 3;
    return fabs(area[most]);
}

/* A dent of a millionth of the area is a rounding error. */
static int is_convex(const reading *r, const int axes[2], double area)
{
    const size_t n = r->corner_count;
    for (size_t i = 0; i < n; i++)
        if (turn_of(r, axes, r->corners[i], r->corners[(i + 1) % n], r->corners[(i + 2) % n]) < -1e-6 * area)
            return 0;
    return 1;
}

/* True if the triangle at corner i lies within the face. */
static int is_ear(const reading *r, const int axes[2], const uint32_t *left, size_t n, size_t i)
{
    const uint32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    if (!(turn_of(r, axes, a, b, c) > 0))
        return 0;
    for (size_t k = 0; k < n; k++) {
        const uint32_t p = left[k];
        if (p != a && p != b && p != c && turn_of(r, axes, a, b, p) >= 0 && turn_of(r, axes, b, c, p) >= 0 &&
            turn_of(r, axes, c, a, p) >= 0)
            return 0;
    }
    return 1;
}

/* Cuts off ears until three corners are left (Meisters 1975). */
static int cut_ears(reading *r, const int axes[2])
{
    uint32_t left[EARS_MOST];
    size_t n = r->corner_count, i = 0, tried = 0;
    if (n > EARS_MOST)
        return fxs_fail(r->message, "%s: a face with a dent and more than %d corners: split it to triangles first",
                        r->source.path, EARS_MOST);
    memcpy(left, r->corners, n * sizeof *left);
    while (n > 3) {
        i %= n;
        if (!is_ear(r, axes, left, n, i) && tried++ < n) {
            i++;
            continue;
        }
        tried = 0;
        FXS_TRY(take_triangle(r, (uint32_t[]){left[(i + n - 1) % n], left[i], left[(i + 1) % n]}, r->message));
        memmove(left + i, left + i + 1, (--n - i) * sizeof *left);
    }
    return take_triangle(r, left, r->message);
}

/* Takes the face whose corners were taken. */
static int end_face(reading *r)
{
    const size_t n = r->corner_count;
    int axes[2];
    if (n < 3)
        return fxs_fail(r->message, "%s: a face with fewer than 3 corners", r->source.path);
    if (n == 3)
        return take_three(r, 0, 1, 2);
    for (size_t i = 0; i < n; i++)
        if (r->corners[i] >= r->vertices)
            return fxs_fail(r->message, "%s: a face with a vertex that is not before it", r->source.path);
    if (!is_convex(r, axes, choose_axes(r, axes)))
        return cut_ears(r, axes);
    for (size_t i = 2; i < n; i++)
        FXS_TRY(take_three(r, 0, i - 1, i));
    return 0;
}

/* ---- .ply -------------------------------------------------------------------------------------------------------- */

enum { NOT_USED = 3, CORNERS };

static int use_of(const fxs_ply_element *e, const fxs_ply_property *p)
{
    static const char *const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3 && !strcmp(e->name, "vertex") && !p->is_list; i++)
        if (!strcmp(p->name, axes[i]))
            return i;
    return p->is_list && !strcmp(e->name, "face") &&
           (!strcmp(p->name, "vertex_indices") || !strcmp(p->name, "vertex_index")) ? CORNERS : NOT_USED;
}

static int read_list(reading *r, const fxs_ply_property *p, int use)
{
    double length, value;
    FXS_TRY(fxs_ply_read_number(&r->bytes, r->ply.encoding, p->count_type, &length));
    if (!(length >= 0 && length <= UINT32_MAX))
        return fxs_bytes_fail(&r->bytes, "a list has no valid length");
    if (use != CORNERS && r->ply.encoding != FXS_PLY_ASCII)
        return fxs_bytes_skip(&r->bytes, (uint64_t)length * fxs_ply_types[p->type].size);
    for (double i = 0; i < length; i++) {
        FXS_TRY(fxs_ply_read_number(&r->bytes, r->ply.encoding, p->type, &value));
        if (use == CORNERS && !(value >= 0 && value < UINT32_MAX && value == fxs_floor(value)))
            return fxs_bytes_fail(&r->bytes, "a vertex number is not valid");
        if (use == CORNERS)
            FXS_TRY(r->failed = take_corner(r, (uint64_t)value));
    }
    return 0;
}

/* After an error, `bytes` holds the fault unless r->failed is set. */
static int read_row(reading *r, const fxs_ply_element *e, double at[3])
{
    fxs_ply_begin_row(&r->bytes, r->ply.encoding);
    for (int i = e->first; i < e->end; i++) {
        const fxs_ply_property *p = &r->ply.property_table[i];
        const int use = use_of(e, p);
        double value = 0;
        FXS_TRY(p->is_list ? read_list(r, p, use) : fxs_ply_read_number(&r->bytes, r->ply.encoding, p->type, &value));
        if (use < NOT_USED)
            at[use] = value;
    }
    return fxs_ply_end_row(&r->bytes, r->ply.encoding);
}

static int read_rows(reading *r, const fxs_ply_element *e)
{
    const int is_vertex = !strcmp(e->name, "vertex"), is_face = !strcmp(e->name, "face");
    for (uint64_t i = 0; i < e->count; i++) {
        double at[3] = {0};
        r->corner_count = 0;
        if (read_row(r, e, at))
            return r->failed ? r->failed : fxs_bytes_fail_row(&r->bytes, e->name, i, e->count, r->message);
        if (is_vertex)
            FXS_TRY(take_vertex(r, at, r->message));
        if (is_face)
            FXS_TRY(end_face(r));
    }
    return 0;
}

static int has_faces(const fxs_ply_header *h)
{
    const fxs_ply_element *e = fxs_ply_find_element(h, "face"), *v = fxs_ply_find_element(h, "vertex");
    int found = 0;
    for (int i = e ? e->first : 0; e && i < e->end; i++)
        found |= use_of(e, &h->property_table[i]) == CORNERS;
    return found && e->count && fxs_ply_find(h, v, "x") >= 0 && fxs_ply_find(h, v, "y") >= 0 &&
           fxs_ply_find(h, v, "z") >= 0 && fxs_ply_find(h, v, "scale_0") < 0;
}

static int read_ply(reading *r)
{
    FXS_TRY(fxs_ply_read_header(&r->ply, &r->bytes, r->message));
    FXS_TRY(fxs_ply_check_size(&r->ply, &r->bytes, r->message));
    if (!has_faces(&r->ply))
        return fxs_fail(r->message, "%s: no faces (element face with a list vertex_indices)", r->source.path);
    for (int i = 0; i < r->ply.elements; i++)
        if (r->ply.element_table[i].first < r->ply.element_table[i].end)
            FXS_TRY(read_rows(r, &r->ply.element_table[i]));
    return 0;
}

/* ---- .obj -------------------------------------------------------------------------------------------------------- */

static int fail_line(const reading *r, const char *fault)
{
    return fxs_fail(r->message, "%s: line %" PRIu64 ": %s", r->source.path, r->line, fault);
}

static int next_byte(reading *r)
{
    const uint8_t *byte = fxs_bytes_take(&r->bytes, 1);
    return byte ? *byte : EOF;
}

/* Reads the next word of a line. Returns its length; 0 at the end of the line, which is not taken; or an error. A
   backslash before the line's end continues the line. */
static int next_word(reading *r, char word[WORD])
{
    int length = 0;
    for (;;) {
        int byte = next_byte(r);
        if (byte == '\\') {
            byte = next_byte(r);
            byte = byte == '\r' ? next_byte(r) : byte;
            if (byte != '\n')
                return fail_line(r, "a backslash that does not end the line");
            r->line++;
            byte = ' ';
        }
        const int is_blank = byte == ' ' || byte == '\t' || byte == '\r';
        if (byte == '\n')
            r->bytes.begin--;
        if (byte == '\n' || byte == EOF || (is_blank && length))
            break;
        if (length == WORD - 1)
            return fail_line(r, "a word is too long");
        if (!is_blank)
            word[length++] = (char)byte;
    }
    word[length] = '\0';
    return length;
}

static int skip_line(reading *r)
{
    int byte;
    do
        byte = next_byte(r);
    while (byte != '\n' && byte != EOF);
    r->line++;
    return byte != EOF;
}

static int read_v(reading *r)
{
    char word[WORD];
    double at[3];
    for (int i = 0; i < 3; i++) {
        const int length = next_word(r, word);
        if (length < 0)
            return length;
        if (!fxs_ply_parse_number(word, &at[i]))
            return fail_line(r, "v without three numbers");
    }
    return take_vertex(r, at, r->message);
}

/* A corner begins with the number of its vertex, from 1 on, or counted back from the last vertex, which is -1. */
static int read_f(reading *r)
{
    char word[WORD], *end;
    int length;
    r->corner_count = 0;
    while ((length = next_word(r, word)) > 0) {
        const long long number = strtoll(word, &end, 10);
        const long long vertex = number < 0 ? (long long)r->vertices + number : number - 1;
        if (end == word || (*end && *end != '/') || number == 0 || vertex < 0)
            return fail_line(r, "f with a corner that is not a vertex number");
        FXS_TRY(take_corner(r, (uint64_t)vertex));
    }
    return length < 0 ? length : end_face(r);
}

static int read_obj(reading *r)
{
    do {
        char word[WORD];
        const uint8_t *two = fxs_bytes_take(&r->bytes, 2);
        if (!two)
            break;
        r->bytes.begin -= 2;
        if ((two[0] != 'v' && two[0] != 'f') || (two[1] != ' ' && two[1] != '\t'))
            continue;
        const int is_vertex = two[0] == 'v', length = next_word(r, word);
        FXS_TRY(length < 0 ? length : is_vertex ? read_v(r) : read_f(r));
    } while (skip_line(r));
    return fxs_bytes_tell(&r->bytes) + 2 > r->source.input.size ? 0 : fail_line(r, "read error");
}

/* ---- .glb -------------------------------------------------------------------------------------------------------- */

static int read_gltf(reading *r)
{
    return fxs_gltf_triangles(&r->source, &(fxs_triangle_sink){take_vertex, take_triangle, r}, r->message);
}

/* ---- Places ------------------------------------------------------------------------------------------------------ */

typedef struct placed {
    int32_t at[3];
    uint32_t vertex;
} placed;

static int compare_places(const void *a, const void *b)
{
    const placed *p = a, *q = b;
    for (int i = 0; i < 3; i++)
        if (p->at[i] != q->at[i])
            return p->at[i] < q->at[i] ? -1 : 1;
    return p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

/* Finds the box of the vertices that triangles have. */
static int find_box(reading *r, double low[3], double high[3])
{
    for (size_t i = 0; i < 3 * r->count; i++) {
        const uint32_t vertex = r->triangles[i / 3][i % 3];
        if (vertex >= r->vertices)
            return fxs_fail(r->message, "%s: a face with a vertex that does not exist", r->source.path);
        for (int k = 0; k < 3; k++) {
            const double at = r->at[vertex][k];
            if (!(fabs(at) <= 1e300))
                return fxs_fail(r->message, "%s: vertex %" PRIu32 " is not finite", r->source.path, vertex);
            low[k] = !i || at < low[k] ? at : low[k];
            high[k] = !i || at > high[k] ? at : high[k];
        }
    }
    return 0;
}

/* The places are multiples of a power of two, so that sides such as 1 and 0.25 are exact. */
static int make_places(reading *r, fxs_mesh *mesh, placed *places)
{
    double low[3] = {0}, high[3] = {0}, longest = 0;
    int exponent;
    FXS_TRY(find_box(r, low, high));
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, high[k] - low[k]);
    if (!(longest > 0x1p-900))
        return fxs_fail(r->message, "%s: no triangle with an area", r->source.path);
    const double fraction = frexp(longest, &exponent), unit = ldexp(1, exponent - (fraction == 0.5) - SIDE_BITS);
    mesh->step = unit * 65536;
    memcpy(mesh->origin, low, sizeof low);
    for (size_t i = 0; i < r->vertices; i++) {
        places[i].vertex = (uint32_t)i;
        for (int k = 0; k < 3; k++) {
            const double at = r->at[i][k];
            places[i].at[k] = at >= low[k] && at <= high[k] ? (int32_t)fxs_floor((at - low[k]) / unit + 0.5) : 0;
        }
    }
    return 0;
}

/* Joins vertices at the same place, and leaves out triangles with two corners at the same place. */
static void join_vertices(const reading *r, fxs_mesh *mesh, placed *places)
{
    const size_t n = r->vertices;
    uint32_t *first = mesh->triangles;      /* at first, room for the vertex that stands for each vertex */
    for (size_t i = 0; i < n; i++)
        memcpy(mesh->places + 3 * i, places[i].at, sizeof places[i].at);
    qsort(places, n, sizeof *places, compare_places);
    for (size_t i = 0; i < n; i++)
        first[places[i].vertex] = i && !memcmp(places[i].at, places[i - 1].at, sizeof places[i].at)
                                      ? first[places[i - 1].vertex] : places[i].vertex;
    for (size_t i = 0; i < 3 * r->count; i++)
        r->triangles[i / 3][i % 3] = first[r->triangles[i / 3][i % 3]];
    for (size_t i = 0; i < r->count; i++) {
        const uint32_t *t = r->triangles[i];
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            memcpy(mesh->triangles + 3 * (size_t)mesh->triangle_count++, t, sizeof r->triangles[i]);
    }
}

static int fill_mesh(reading *r, fxs_mesh *mesh)
{
    const size_t n = r->vertices, most = n > 3 * r->count ? n : 3 * r->count;
    placed *places = fxs_hold(&r->source, n * (uint64_t)sizeof *places, r->message);
    if (!places)
        return FXS_ERR_MEMORY;
    mesh->places = fxs_allocate(NULL, n, 3 * sizeof *mesh->places);
    mesh->colours = fxs_allocate_zeroed(NULL, n, 4);
    mesh->triangles = fxs_allocate(NULL, most, sizeof *mesh->triangles);
    int error = mesh->places && mesh->colours && mesh->triangles ? make_places(r, mesh, places)
                : fxs_fail_memory(r->message, r->source.path, 16 * (uint64_t)n + 4 * (uint64_t)most);
    if (!error) {
        mesh->vertex_count = (uint32_t)n;
        join_vertices(r, mesh, places);
        error = mesh->triangle_count ? fxs_mesh_compact(mesh, r->message)
                : fxs_fail(r->message, "%s: no triangle with an area", r->source.path);
    }
    fxs_let_go(&r->source, places, n * (uint64_t)sizeof *places);
    return error;
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

enum kind { NO_MESH, PLY, OBJ, GLTF };

/* Tells by the content if a file has Gaussians: their extensions have such names. */
static int has_gaussians(reading *r, uint64_t offset, uint64_t size)
{
    fxs_text text;
    if (fxs_scene_source_load(&r->source, offset, size, &text, r->message))
        return 1;
    const int found = strstr(text.data, "gaussian_splat") != NULL;
    fxs_text_let_go(&r->source, &text);
    return found;
}

static int ply_has_faces(reading *r)
{
    const int found = !fxs_ply_read_header(&r->ply, &r->bytes, r->message) && has_faces(&r->ply);
    memset(&r->ply, 0, sizeof r->ply);
    r->bytes.offset = r->bytes.begin = r->bytes.end = 0;
    return found;
}

static enum kind kind_of(reading *r)
{
    uint8_t head[HEAD];
    const uint64_t all = r->source.input.size;
    const size_t size = all < HEAD ? (size_t)all : HEAD;
    const char *path = r->source.path;
    if (size < 20 || fxs_scene_source_read(&r->source, 0, head, size, r->message))
        return NO_MESH;
    if (!memcmp(head, "glTF", 4))
        return has_gaussians(r, 20, fxs_load_u32(head + 12)) ? NO_MESH : GLTF;
    if (!memcmp(head, "ply", 3))
        return ply_has_faces(r) ? PLY : NO_MESH;
    if (fxs_is_obj(head, size) || (fxs_ends_in(path, ".obj") && !fxs_foreign(head, size)))
        return OBJ;
    return fxs_ends_in(path, ".gltf") && !has_gaussians(r, 0, all) ? GLTF : NO_MESH;
}

static reading *begin(const char *path, uint64_t max_memory, fxs_message *message)
{
    reading *r = fxs_allocate_zeroed(NULL, 1, sizeof *r);
    if (!r) {
        fxs_fail_memory(message, path, sizeof *r);
        return NULL;
    }
    fxs_scene_file_options_init(&r->source.options);
    r->source.options.max_memory = max_memory;
    r->source.import = &r->import;
    r->message = message;
    r->bytes.source = &r->source;
    r->line = 1;
    return r;
}

static void end(reading *r)
{
    fxs_release(NULL, r->at);
    fxs_release(NULL, r->triangles);
    fxs_release(NULL, r->corners);
    fxs_release(NULL, r->import.files);
    fxs_scene_source_close(&r->source);
    fxs_release(NULL, r);
}

static int open_source(reading *r, const char *path)
{
    FXS_TRY(fxs_scene_source_open(&r->source, path, r->message));
    return fxs_import_count(&r->source, r->message);
}

int fxs_mesh_is_file(const char *path)
{
    fxs_message unwanted;
    reading *r = fxs_file_kind(path) == FXS_FILE_REGULAR ? begin(path, 0, &unwanted) : NULL;
    const int found = r && !open_source(r, path) && kind_of(r) != NO_MESH;
    if (r)
        end(r);
    return found;
}

static int read_mesh(reading *r, fxs_mesh *mesh)
{
    const enum kind kind = kind_of(r);
    int error = kind == PLY ? read_ply(r) : kind == OBJ ? read_obj(r) : kind == GLTF ? read_gltf(r)
                : fxs_fail(r->message, "%s: not a mesh: expected a .glb, .ply or .obj with triangles", r->source.path);
    if (!error && !r->count)
        error = fxs_fail(r->message, "%s: no faces", r->source.path);
    error = error ? error : fill_mesh(r, mesh);
    return error ? error : fxs_mesh_join(mesh, r->message);
}

int fxs_mesh_open(fxs_mesh **mesh, const char *path, uint64_t max_memory, fxs_message *message)
{
    *mesh = NULL;
    reading *r = begin(path, max_memory, message);
    if (!r)
        return FXS_ERR_MEMORY;
    fxs_mesh *made = fxs_allocate_zeroed(NULL, 1, sizeof *made);
    int error = made ? open_source(r, path) : fxs_fail_memory(message, path, sizeof *made);
    error = error ? error : read_mesh(r, made);
    if (!error)
        made->max_memory = max_memory;
    end(r);
    if (error)
        fxs_mesh_free(made);
    else
        *mesh = made;
    return error;
}
