/* Writes Inria's .ply: binary, little-endian, all properties float, normals zero. If the scene lies far from 0, x, y
   and z are double. */
#include <inttypes.h>
#include <string.h>

#include "scene_write_internal.h"
#include "src/gaussian/origin_internal.h"

/* most properties: position, normal, SH of degree 0, SH of degrees 1 to 3, opacity, scale, rotation */
#define MAX_PROPERTIES 62

typedef struct ply_writer {
    fxs_output output;
    size_t coefficients;   /* number of SH coefficients per channel above degree 0 */
    double origin[3];
    int is_far;
} ply_writer;

static void write_header(FILE *file, uint64_t count, const ply_writer *w, int antialiased)
{
    const char *type = w->is_far ? "double" : "float";
    /* Inria's viewer reads the number of Gaussians from the third line, so a comment must come later. */
    fprintf(file, "ply\nformat binary_little_endian 1.0\nelement vertex %" PRIu64 "\n%s", count,
            antialiased ? "comment antialiased 1\n" : "");
    fprintf(file, "property %s x\nproperty %s y\nproperty %s z\n", type, type, type);
    fputs("property float nx\nproperty float ny\nproperty float nz\n"
          "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n", file);
    for (size_t k = 0; k < 3 * w->coefficients; k++)
        fprintf(file, "property float f_rest_%zu\n", k);
    fputs("property float opacity\nproperty float scale_0\nproperty float scale_1\nproperty float scale_2\n"
          "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n", file);
}

static int ply_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    ply_writer *w = writer;
    FXS_TRY(fxs_output_open(&w->output, path, o->count, message));
    w->coefficients = (size_t)((o->sh_degree + 1) * (o->sh_degree + 1) - 1);
    memcpy(w->origin, o->origin, sizeof w->origin);
    w->is_far = fxs_has_origin(o->origin);
    write_header(w->output.file, o->count, w, o->antialiased);
    return 0;
}

static unsigned char *put_doubles(const ply_writer *w, const fxs_gaussian *g, unsigned char *row)
{
    for (int i = 0; i < 3; i++) {
        const double place = w->origin[i] + (double)g->position[i];
        uint64_t bits;
        memcpy(&bits, &place, sizeof bits);
        for (int k = 0; k < 8; k++)
            *row++ = (unsigned char)(bits >> 8 * k);
    }
    return row;
}

static size_t encode(const ply_writer *w, const fxs_gaussian *g, unsigned char *row)
{
    static const float normal[3];
    const size_t coefficients = w->coefficients;
    unsigned char *to = w->is_far ? put_doubles(w, g, row) : fxs_put_floats(row, g->position, 3);
    to = fxs_put_floats(to, normal, 3);
    to = fxs_put_floats(to, g->dc, 3);
    for (size_t channel = 0; channel < 3; channel++)
        for (size_t k = 0; k < coefficients; k++)
            to = fxs_put_floats(to, &g->sh[3 * k + channel], 1);
    to = fxs_put_floats(to, &g->opacity, 1);
    to = fxs_put_floats(to, g->scale, 3);
    to = fxs_put_floats(to, g->rotation, 4);
    return (size_t)(to - row);
}

static int ply_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    ply_writer *w = writer;
    unsigned char row[MAX_PROPERTIES * 4 + 12];
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (size_t i = 0; i < n; i++) {
        size_t bytes = encode(w, &gaussians[i], row);
        FXS_TRY(fxs_output_write(&w->output, row, bytes, message));
    }
    return 0;
}

static int ply_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    (void)report, (void)progress;
    return fxs_output_close(&((ply_writer *)writer)->output, message);
}

const fxs_writer fxs_write_ply = {sizeof(ply_writer), ply_open, ply_put, ply_close, NULL};
