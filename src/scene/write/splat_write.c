/* Writes .splat files: a record of 32 bytes for each Gaussian. Clamps scales to 4.85e8 and positions to 2^27. */
#include <math.h>

#include "scene_write_internal.h"
#include "src/gaussian/attributes.h"
#include "src/pack/encode.h"

enum { RECORD_SIZE = 32, SCALE = 12, COLOUR = 24, ROTATION = 28 };

/* Largest scale and position that all readers of .splat accept. The scale is slightly smaller than exp(20). */
static const double largest_scale = 4.85e8, largest_position = 134217728;

typedef struct splat_writer {
    fxs_output output;
} splat_writer;

static int splat_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    return fxs_output_open(&((splat_writer *)writer)->output, path, o->count, message);
}

static unsigned char code(double x)
{
    return (unsigned char)fmin(fmax(floor(x + 0.5), 0), 255);
}

static void encode(const fxs_gaussian *gaussian, unsigned char record[RECORD_SIZE])
{
    double norm = 0;
    fxs_gaussian held = *gaussian;
    const fxs_gaussian *g = &held;
    fxs_bring_in(&held, largest_position);
    for (int i = 0; i < 4; i++)
        norm += (double)g->rotation[i] * g->rotation[i];
    for (int i = 0; i < 3; i++) {
        const float scale = (float)fmin(fxs_exp(g->scale[i]), largest_scale);
        fxs_put_floats(record + 4 * i, &g->position[i], 1);
        fxs_put_floats(record + SCALE + 4 * i, &scale, 1);
        record[COLOUR + i] = code(255 * (0.5 + FXS_SH_0 * g->dc[i]));
    }
    record[COLOUR + 3] = code(255 / (1 + fxs_exp(-(double)g->opacity)));
    for (int i = 0; i < 4; i++)
        record[ROTATION + i] = code(128 + 128 * g->rotation[i] / sqrt(norm));
}

static int splat_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    splat_writer *w = writer;
    unsigned char record[RECORD_SIZE];
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (size_t i = 0; i < n; i++) {
        encode(&gaussians[i], record);
        FXS_TRY(fxs_output_write(&w->output, record, sizeof record, message));
    }
    return 0;
}

static int splat_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                       fxs_message *message)
{
    (void)report, (void)progress;
    return fxs_output_close(&((splat_writer *)writer)->output, message);
}

const fxs_writer fxs_write_splat = {sizeof(splat_writer), splat_open, splat_put, splat_close, NULL};
