#include <fixsplat/splat_write.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/exponential.h"
#include "src/pack/encode.h"
#include "src/base/output_internal.h"

enum { RECORD_SIZE = 32, SCALE = 12, COLOUR = 24, ROTATION = 28 };

/* A reader may refuse more; exp(20) is a little above. */
static const double largest_scale = 4.85e8, largest_position = 134217728;

struct fxs_splat_writer {
    fxs_output output;
};

int fxs_splat_writer_open(const char *path, uint64_t count, fxs_splat_writer **writer, fxs_message *message)
{
    *writer = calloc(1, sizeof **writer);
    if (!*writer)
        return fxs_fail_memory(message, path, sizeof **writer);
    const int error = fxs_output_open(&(*writer)->output, path, count, message);
    if (error) {
        free(*writer);
        *writer = NULL;
    }
    return error;
}

static void put_float(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(bits >> 8 * i);
}

/* The nearest whole number from 0 to 255. */
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
        put_float(record + 4 * i, g->position[i]);
        put_float(record + SCALE + 4 * i, (float)fmin(fxs_exp(g->scale[i]), largest_scale));
        record[COLOUR + i] = code(255 * (0.5 + 0.28209479177387814 * g->dc[i]));
    }
    record[COLOUR + 3] = code(255 / (1 + fxs_exp(-(double)g->opacity)));
    for (int i = 0; i < 4; i++)
        record[ROTATION + i] = code(128 + 128 * g->rotation[i] / sqrt(norm));
}

int fxs_splat_writer_put(fxs_splat_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    unsigned char record[RECORD_SIZE];
    int result = fxs_output_expect(&writer->output, n, message);
    for (size_t i = 0; i < n && !result; i++) {
        encode(&gaussians[i], record);
        result = fxs_output_write(&writer->output, record, sizeof record, message);
    }
    return result;
}

int fxs_splat_writer_close(fxs_splat_writer *writer, fxs_message *message)
{
    int result = writer ? fxs_output_close(&writer->output, message) : 0;
    free(writer);
    return result;
}
