/* Writes meshes: .glb (glTF 2.0), .ply, and .obj. */
#include "volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/exponential.h"
#include "src/base/glb.h"
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/base/output_internal.h"
#include "src/base/sine.h"
#include "src/base/try_internal.h"

enum { JSON_MOST = 2048 };

typedef struct writer {
    const fxs_mesh *mesh;
    const char *path;
    double axes[3][3], scale;       /* position in the file = scale * axes * position in the scene */
    int64_t (*normals)[3];
    uint16_t linear[256];           /* light of a colour's code, Q16 */
    double low[3], high[3];
    fxs_output output;
} writer;

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

static void put_u32(writer *w, uint32_t value, fxs_message *message)
{
    const uint8_t bytes[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16), (uint8_t)(value >> 24)};
    fxs_output_write(&w->output, bytes, sizeof bytes, message);
}

static void put_floats(writer *w, const float values[3], fxs_message *message)
{
    for (int i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put_u32(w, bits, message);
    }
}

static void turn(const writer *w, const double from[3], double scale, float to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = (float)(scale * (w->axes[i][0] * from[0] + w->axes[i][1] * from[1] + w->axes[i][2] * from[2]));
}

static void position_of(const writer *w, uint32_t vertex, float to[3])
{
    double place[3];
    for (int i = 0; i < 3; i++)
        place[i] = w->mesh->origin[i] + w->mesh->step * (w->mesh->places[3 * (size_t)vertex + (size_t)i] / 65536.0);
    turn(w, place, w->scale, to);
}

static void normal_at(const writer *w, uint32_t vertex, float to[3])
{
    const int64_t *n = w->normals[vertex];
    const double at[3] = {(double)n[0], (double)n[1], (double)n[2]};
    const double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    turn(w, at, length > 0 ? 1 / length : 0, to);
    if (!(length > 0))
        to[1] = 1;                  /* glTF asks for a length of 1 */
}

/* Sums the normals of the triangles at each vertex, weighted by area. Sides are below 2^28, so that products of 2^56
   leave room for 64 triangles at a vertex. */
static int sum_normals(writer *w, fxs_message *message)
{
    const fxs_mesh *m = w->mesh;
    w->normals = fxs_allocate_zeroed(NULL, (size_t)m->vertex_count + 1, sizeof *w->normals);
    if (!w->normals)
        return fxs_fail_memory(message, w->path, 24 * (uint64_t)m->vertex_count);
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *corners = m->triangles + 3 * t;
        const int32_t *a = m->places + 3 * (size_t)corners[0], *b = m->places + 3 * (size_t)corners[1];
        const int32_t *c = m->places + 3 * (size_t)corners[2];
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const int64_t n = (int64_t)(b[j] - a[j]) * (c[k] - a[k]) - (int64_t)(b[k] - a[k]) * (c[j] - a[j]);
            for (int corner = 0; corner < 3; corner++)
                w->normals[corners[corner]][i] += n;
        }
    }
    return 0;
}

/* ---- Axes -------------------------------------------------------------------------------------------------------- */

/* Turns the up direction to y. z stays as near to itself as it can; for z up, -y becomes z. */
static int turn_up(writer *w, const double up[3], fxs_message *message)
{
    const double length = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    double (*axes)[3] = w->axes, along = 0, square = 0;
    if (!(length > 0 && length < INFINITY)) {
        axes[0][0] = axes[1][1] = -1;
        axes[2][2] = 1;
        return length == 0 ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "an up direction that is not finite");
    }
    for (int i = 0; i < 3; i++)
        axes[1][i] = up[i] / length;
    const int is_z = fabs(axes[1][2]) > 0.9;
    axes[2][is_z ? 1 : 2] = is_z ? -1 : 1;
    for (int i = 0; i < 3; i++)
        along += axes[2][i] * axes[1][i];
    for (int i = 0; i < 3; i++) {
        axes[2][i] -= along * axes[1][i];
        square += axes[2][i] * axes[2][i];
    }
    for (int i = 0; i < 3; i++)
        axes[2][i] /= sqrt(square);
    for (int i = 0; i < 3; i++)
        axes[0][i] = axes[1][(i + 1) % 3] * axes[2][(i + 2) % 3] - axes[1][(i + 2) % 3] * axes[2][(i + 1) % 3];
    return 0;
}

static void keep_axes(writer *w)
{
    for (int i = 0; i < 3; i++)
        w->axes[i][i] = 1;
}

/* ---- .glb -------------------------------------------------------------------------------------------------------- */

/* Light of sRGB codes, as glTF has colours (IEC 61966-2-1). */
static void make_linear(writer *w)
{
    for (int i = 0; i < 256; i++) {
        const double code = i / 255.0;
        const double light = code <= 0.04045 ? code / 12.92 : fxs_exp(2.4 * fxs_log((code + 0.055) / 1.055));
        w->linear[i] = (uint16_t)fxs_floor(65535 * light + 0.5);
    }
}

static void find_bounds(writer *w)
{
    for (uint32_t i = 0; i < w->mesh->vertex_count; i++) {
        float at[3];
        position_of(w, i, at);
        for (int k = 0; k < 3; k++) {
            w->low[k] = !i || (double)at[k] < w->low[k] ? (double)at[k] : w->low[k];
            w->high[k] = !i || (double)at[k] > w->high[k] ? (double)at[k] : w->high[k];
        }
    }
}

/* The colours are those of pictures, with their light: a viewer shows them without lights of its own. */
static void make_json(FILE *json, const writer *w)
{
    const uint32_t n = w->mesh->vertex_count, triangles = w->mesh->triangle_count;
    const uint64_t sizes[4] = {12 * (uint64_t)n, 12 * (uint64_t)n, 8 * (uint64_t)n, 12 * (uint64_t)triangles};
    uint64_t offset = 0;
    fputs("{\"asset\":{\"version\":\"2.0\",\"generator\":\"fixsplat " FXS_VERSION "\"},\"scene\":0,\"scenes\":"
          "[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"extensionsUsed\":[\"KHR_materials_unlit\"],\"materials\":"
          "[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":1},\"extensions\":"
          "{\"KHR_materials_unlit\":{}}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
          "\"COLOR_0\":2},\"indices\":3,\"material\":0}]}],\"accessors\":[", json);
    fprintf(json, "{\"bufferView\":0,\"componentType\":5126,\"count\":%" PRIu32 ",\"type\":\"VEC3\"", n);
    fputs(",\"min\":", json);
    fxs_print_list(json, 9, ",", w->low, 3);
    fputs(",\"max\":", json);
    fxs_print_list(json, 9, ",", w->high, 3);
    fprintf(json, "},{\"bufferView\":1,\"componentType\":5126,\"count\":%" PRIu32 ",\"type\":\"VEC3\"},{\"bufferView\":"
            "2,\"componentType\":5123,\"normalized\":true,\"count\":%" PRIu32 ",\"type\":\"VEC4\"},{\"bufferView\":3,"
            "\"componentType\":5125,\"count\":%" PRIu64 ",\"type\":\"SCALAR\"}],\"bufferViews\":[", n, n,
            3 * (uint64_t)triangles);
    for (int i = 0; i < 4; i++) {
        fprintf(json, "%s{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 ",\"target\":%d}",
                i ? "," : "", offset, sizes[i], i < 3 ? 34962 : 34963);
        offset += sizes[i];
    }
    fprintf(json, "],\"buffers\":[{\"byteLength\":%" PRIu64 "}]}", offset);
    fxs_glb_pad(json);
}

static void put_glb(writer *w, const fxs_printed *json, fxs_message *message)
{
    const fxs_mesh *m = w->mesh;
    float three[3];
    fxs_glb_begin(w->output.file, json->text, json->size, 32 * m->vertex_count + 12 * m->triangle_count);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        position_of(w, i, three);
        put_floats(w, three, message);
    }
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        normal_at(w, i, three);
        put_floats(w, three, message);
    }
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const uint8_t *c = m->colours + 4 * (size_t)i;
        put_u32(w, w->linear[c[0]] | (uint32_t)w->linear[c[1]] << 16, message);
        put_u32(w, w->linear[c[2]] | 0xffff0000u, message);
    }
    for (size_t i = 0; i < 3 * (size_t)m->triangle_count; i++)
        put_u32(w, m->triangles[i], message);
}

static int write_glb(writer *w, fxs_message *message)
{
    fxs_printed json;
    if (32 * (uint64_t)w->mesh->vertex_count + 12 * (uint64_t)w->mesh->triangle_count > UINT32_MAX - JSON_MOST)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a .glb has 4 GiB at most: fewer triangles are needed",
                           w->path);
    make_linear(w);
    find_bounds(w);
    if (fxs_print_begin(&json))
        return fxs_fail_memory(message, w->path, JSON_MOST);
    make_json(json.file, w);
    if (fxs_print_end(&json))
        return fxs_fail_memory(message, w->path, JSON_MOST);
    const int error = fxs_output_open(&w->output, w->path, 0, message);
    if (!error)
        put_glb(w, &json, message);
    free(json.text);
    return error;
}

/* ---- .ply and .obj ----------------------------------------------------------------------------------------------- */

static int write_ply(writer *w, fxs_message *message)
{
    const fxs_mesh *m = w->mesh;
    keep_axes(w);
    FXS_TRY(fxs_output_open(&w->output, w->path, 0, message));
    fprintf(w->output.file, "ply\nformat binary_little_endian 1.0\ncomment fixsplat " FXS_VERSION "\nelement vertex %"
            PRIu32 "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
            "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face %" PRIu32
            "\nproperty list uchar int vertex_indices\nend_header\n", m->vertex_count, m->triangle_count);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        float three[3];
        position_of(w, i, three);
        put_floats(w, three, message);
        normal_at(w, i, three);
        put_floats(w, three, message);
        fxs_output_write(&w->output, m->colours + 4 * (size_t)i, 3, message);
    }
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        fxs_output_write(&w->output, "\3", 1, message);
        for (uint32_t k = 0; k < 3; k++)
            put_u32(w, m->triangles[3 * (size_t)i + k], message);
    }
    return 0;
}

static void print_three(FILE *file, const char *name, int digits, const float values[3])
{
    fputs(name, file);
    for (int i = 0; i < 3; i++) {
        fputc(' ', file);
        fxs_print_number(file, digits, (double)values[i]);
    }
}

int fxs_mesh_route_write(const char *path, const fxs_mesh_route *route, fxs_message *message)
{
    fxs_output output;
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    fputs("# fixsplat " FXS_VERSION "\n", output.file);
    for (uint32_t i = 0; i < route->count; i++) {
        fputc('v', output.file);
        for (int k = 0; k < 3; k++) {
            fputc(' ', output.file);
            fxs_print_number(output.file, 9, route->points[i][k]);
        }
        fputc('\n', output.file);
    }
    fputc('l', output.file);
    for (uint32_t i = 0; i < route->count; i++)
        fprintf(output.file, " %" PRIu32, i + 1);
    fputc('\n', output.file);
    return fxs_output_close(&output, message);
}

static int write_obj(writer *w, fxs_message *message)
{
    const fxs_mesh *m = w->mesh;
    FILE *file;
    keep_axes(w);
    FXS_TRY(fxs_output_open(&w->output, w->path, 0, message));
    file = w->output.file;
    fputs("# fixsplat " FXS_VERSION "\n", file);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const uint8_t *c = m->colours + 4 * (size_t)i;
        const float colour[3] = {(float)c[0] / 255, (float)c[1] / 255, (float)c[2] / 255};
        float three[3];
        position_of(w, i, three);
        print_three(file, "v", 9, three);
        print_three(file, "", 4, colour);
        normal_at(w, i, three);
        print_three(file, "\nvn", 4, three);
        fputc('\n', file);
    }
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *t = m->triangles + 3 * (size_t)i;
        fprintf(file, "f %" PRIu32 "//%" PRIu32 " %" PRIu32 "//%" PRIu32 " %" PRIu32 "//%" PRIu32 "\n", t[0] + 1,
                t[0] + 1, t[1] + 1, t[1] + 1, t[2] + 1, t[2] + 1);
    }
    return 0;
}

static const struct {
    const char *ending;
    int (*write)(writer *w, fxs_message *message);
} formats[] = {{".glb", write_glb}, {".ply", write_ply}, {".obj", write_obj}};

int fxs_mesh_write(const char *path, const fxs_mesh *mesh, const fxs_mesh_write_options *options, fxs_message *message)
{
    size_t format = 0, count = sizeof formats / sizeof *formats;
    while (format < count && !fxs_ends_in(path, formats[format].ending))
        format++;
    if (format == count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: expected a name ending in .glb, .ply or .obj", path);
    if (mesh->half_q16)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a mesh with contracted places: call fxs_mesh_expand", path);
    writer *w = fxs_allocate_zeroed(NULL, 1, sizeof *w);
    if (!w)
        return fxs_fail_memory(message, path, sizeof *w);
    w->mesh = mesh;
    w->path = path;
    w->scale = options->scale > 0 ? options->scale : 1;
    int error = format ? 0 : turn_up(w, options->up, message);
    error = error ? error : sum_normals(w, message);
    error = error ? error : formats[format].write(w, message);
    error = error ? error : fxs_output_close(&w->output, message);
    fxs_release(NULL, w->normals);
    fxs_release(NULL, w);
    return error;
}
