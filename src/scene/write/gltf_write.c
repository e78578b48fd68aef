/* Writes a .glb with KHR_gaussian_splatting (Khronos, release candidate). All numbers are floats, and each Gaussian has
   a row. Positions are rotated by half a turn about z, because y is up in glTF. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/glb.h"
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/gaussian/attributes.h"
#include "scene_write_internal.h"
#include "src/gaussian/origin_internal.h"
#include "src/scene/read/spz_internal.h"

/* Byte offsets of the attributes in the row of a Gaussian. glTF allows rows of up to 252 bytes. */
enum { SCALE = 12, ROTATION = 24, OPACITY = 40, SH = 44, MAX_ROW = SH + 16 * 12 };

enum { JSON_MOST = 8000 };

typedef struct glb_writer {
    fxs_output output;
    uint32_t row;
} glb_writer;

static void add_attributes(FILE *json, int sh_degree)
{
    int accessor = 4;
    fprintf(json, "\"POSITION\":0,\"KHR_gaussian_splatting:SCALE\":1,\"KHR_gaussian_splatting:ROTATION\":2,"
            "\"KHR_gaussian_splatting:OPACITY\":3");
    for (int degree = 0; degree <= sh_degree; degree++)
        for (int k = 0; k <= 2 * degree; k++)
            fprintf(json, ",\"KHR_gaussian_splatting:SH_DEGREE_%d_COEF_%d\":%d", degree, k, accessor++);
}

static void print_vector(FILE *json, const char *name, int digits, double x, double y, double z)
{
    const double vector[3] = {x, y, z};
    fprintf(json, ",\"%s\":", name);
    fxs_print_list(json, digits, ",", vector, 3);
}

static void print_corner(FILE *json, const char *name, float x, float y, float z)
{
    print_vector(json, name, 9, (double)x, (double)y, (double)z);
}

static void add_node(FILE *json, const double origin[3])
{
    fprintf(json, "\"nodes\":[{\"mesh\":0");
    if (fxs_has_origin(origin))
        print_vector(json, "translation", 17, 0 - origin[0], 0 - origin[1], origin[2]);
    fprintf(json, "}]");
}

static void add_accessors(FILE *json, const fxs_scene_write_options *o)
{
    static const char *const types[4] = {"VEC3", "VEC3", "VEC4", "SCALAR"};
    static const int offsets[4] = {0, SCALE, ROTATION, OPACITY};
    for (int a = 0; a < 4 + (o->sh_degree + 1) * (o->sh_degree + 1); a++) {
        fprintf(json, "%s{\"bufferView\":0,\"byteOffset\":%d,\"componentType\":5126,\"count\":%" PRIu64 ","
                "\"type\":\"%s\"", a ? "," : "", a < 4 ? offsets[a] : SH + 12 * (a - 4), o->count,
                a < 4 ? types[a] : "VEC3");
        if (!a) {
            print_corner(json, "min", -o->high[0], -o->high[1], o->low[2]);
            print_corner(json, "max", -o->low[0], -o->low[1], o->high[2]);
        }
        fprintf(json, "}");
    }
}

static void make_json(FILE *json, const fxs_scene_write_options *o, uint32_t row)
{
    fprintf(json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"fixsplat " FXS_VERSION "\"},"
            "\"extensionsUsed\":[\"KHR_gaussian_splatting\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],");
    add_node(json, o->origin);
    fprintf(json, ",\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{");
    add_attributes(json, o->sh_degree);
    fprintf(json, "},\"extensions\":{\"KHR_gaussian_splatting\":{\"kernel\":\"ellipse\",\"colorSpace\":"
            "\"srgb_rec709_display\",\"projection\":\"perspective\",\"sortingMethod\":\"cameraDistance\"}}}]}],"
            "\"accessors\":[");
    add_accessors(json, o);
    fprintf(json, "],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%" PRIu64 ",\"byteStride\":%" PRIu32 ","
            "\"target\":34962}],\"buffers\":[{\"byteLength\":%" PRIu64 "}]}", o->count * row, row, o->count * row);
    fxs_glb_pad(json);
}

static char *json_text(const fxs_scene_write_options *o, uint32_t row, size_t *length)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed))
        return NULL;
    make_json(printed.file, o, row);
    if (fxs_print_end(&printed))
        return NULL;
    *length = printed.size;
    return printed.text;
}

/* Opens a .glb and checks that all sizes fit 32 bits. */
static int glb_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    glb_writer *w = writer;
    size_t length = 0;
    w->row = SH + 12 * (uint32_t)((o->sh_degree + 1) * (o->sh_degree + 1));
    if (o->count > (UINT32_MAX - JSON_MOST - FXS_GLB_FRAME) / w->row)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a .glb has 4 GiB at most: %" PRIu64 " Gaussians of SH "
                           "degree %d take more", path, o->count, o->sh_degree);
    char *json = json_text(o, w->row, &length);
    const int error = json ? fxs_output_open(&w->output, path, o->count, message)
                           : fxs_fail_memory(message, path, JSON_MOST);
    if (!error)
        fxs_glb_begin(w->output.file, json, length, (uint32_t)o->count * w->row);
    free(json);
    return error;
}

/* Rotates a quaternion q by half a turn about z: (0, 0, 0, 1) q, normalised. The result is in the order x, y, z, w. */
static void turn_rotation(float to[4], const float q[4])
{
    double norm = 0;
    for (int i = 0; i < 4; i++)
        norm += (double)q[i] * q[i];
    const double scale = 1 / sqrt(norm);
    to[0] = (float)(scale * -q[2]);
    to[1] = (float)(scale * q[1]);
    to[2] = (float)(scale * q[0]);
    to[3] = (float)(scale * -q[3]);
}

static void encode(const glb_writer *w, const fxs_gaussian *g, uint8_t *row)
{
    const float position[3] = {-g->position[0], -g->position[1], g->position[2]};
    const float opacity = (float)(fxs_opacity_of_logit(g->opacity));
    float scale[3], rotation[4], sh[45];
    turn_rotation(rotation, g->rotation);
    for (int i = 0; i < 3; i++)
        scale[i] = (float)fxs_exp(g->scale[i]);
    for (int k = 0; k < 15; k++) {
        /* half a turn about z negates SH functions that are odd in only one of x and y */
        const int odd = fxs_spz_odd_in[k] & 3;
        for (int c = 0; c < 3; c++)
            sh[3 * k + c] = odd == 1 || odd == 2 ? -g->sh[3 * k + c] : g->sh[3 * k + c];
    }
    row = fxs_put_floats(row, position, 3);
    row = fxs_put_floats(row, scale, 3);
    row = fxs_put_floats(row, rotation, 4);
    row = fxs_put_floats(row, &opacity, 1);
    row = fxs_put_floats(row, g->dc, 3);
    fxs_put_floats(row, sh, (w->row - SH) / 4 - 3);
}

static int glb_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    glb_writer *w = writer;
    uint8_t row[MAX_ROW];
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (size_t i = 0; i < n; i++) {
        encode(w, &gaussians[i], row);
        FXS_TRY(fxs_output_write(&w->output, row, w->row, message));
    }
    return 0;
}

static int glb_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    (void)report, (void)progress;
    return fxs_output_close(&((glb_writer *)writer)->output, message);
}

const fxs_writer fxs_write_glb = {sizeof(glb_writer), glb_open, glb_put, glb_close, NULL};
