/* Writes Gaussians as text. The first line has the property names of Inria's .ply without normals. Each further line
   has the values of a Gaussian. */
#include <string.h>

#include "scene_write_internal.h"
#include "src/gaussian/origin_internal.h"

#include "src/base/number.h"

typedef struct csv_writer {
    fxs_output output;
    int coefficients;              /* number of SH coefficients per channel above degree 0 */
    double origin[3];
    int digits;
} csv_writer;

static int csv_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    csv_writer *w = writer;
    FXS_TRY(fxs_output_open(&w->output, path, o->count, message));
    w->coefficients = o->sh_degree * (o->sh_degree + 2);
    memcpy(w->origin, o->origin, sizeof w->origin);
    w->digits = fxs_has_origin(o->origin) ? 17 : 9;
    fputs("x,y,z,f_dc_0,f_dc_1,f_dc_2", w->output.file);
    for (int k = 0; k < 3 * w->coefficients; k++)
        fprintf(w->output.file, ",f_rest_%d", k);
    fputs(",opacity,scale_0,scale_1,scale_2,rot_0,rot_1,rot_2,rot_3\n", w->output.file);
    return 0;
}

static void print(FILE *file, const float *values, int count, const char *before)
{
    for (int i = 0; i < count; i++) {
        fputs(i ? "," : before, file);
        fxs_print_number(file, 9, (double)values[i]);
    }
}

static int csv_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    csv_writer *w = writer;
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (const fxs_gaussian *g = gaussians; g < gaussians + n; g++) {
        for (int i = 0; i < 3; i++) {
            fputs(i ? "," : "", w->output.file);
            fxs_print_number(w->output.file, w->digits, w->origin[i] + (double)g->position[i]);
        }
        print(w->output.file, g->dc, 3, ",");
        for (int channel = 0; channel < 3; channel++)
            for (int k = 0; k < w->coefficients; k++)
                print(w->output.file, &g->sh[3 * k + channel], 1, ",");
        print(w->output.file, &g->opacity, 1, ",");
        print(w->output.file, g->scale, 3, ",");
        print(w->output.file, g->rotation, 4, ",");
        FXS_TRY(fxs_output_write(&w->output, "\n", 1, message));
    }
    return 0;
}

static int csv_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    (void)report, (void)progress;
    return fxs_output_close(&((csv_writer *)writer)->output, message);
}

const fxs_writer fxs_write_csv = {sizeof(csv_writer), csv_open, csv_put, csv_close, NULL};
