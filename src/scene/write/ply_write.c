#include <fixsplat/ply_write.h>

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/output_internal.h"

#define MAX_PROPERTIES 62   /* position, normal, degree 0, degrees 1 to 3, opacity, scale, rotation */

struct fxs_ply_writer {
    fxs_output output;
    size_t coefficients;   /* SH coefficients of a channel above degree 0 */
};

static void write_header(FILE *file, uint64_t count, size_t coefficients, int antialiased)
{
    fprintf(file, "ply\nformat binary_little_endian 1.0\n%selement vertex %" PRIu64 "\n",
            antialiased ? "comment antialiased 1\n" : "", count);
    fputs("property float x\nproperty float y\nproperty float z\n"
          "property float nx\nproperty float ny\nproperty float nz\n"
          "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n", file);
    for (size_t k = 0; k < 3 * coefficients; k++)
        fprintf(file, "property float f_rest_%zu\n", k);
    fputs("property float opacity\nproperty float scale_0\nproperty float scale_1\nproperty float scale_2\n"
          "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n", file);
}

int fxs_ply_writer_open(const char *path, uint64_t count, int sh_degree, int antialiased, fxs_ply_writer **writer,
                        fxs_message *message)
{
    *writer = NULL;
    if (sh_degree < 0 || sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: SH degree %d, not 0 to 3", path, sh_degree);
    fxs_ply_writer *made = calloc(1, sizeof *made);
    if (!made)
        return fxs_fail_memory(message, path, sizeof *made);
    const int error = fxs_output_open(&made->output, path, count, message);
    if (error) {
        free(made);
        return error;
    }
    made->coefficients = (size_t)((sh_degree + 1) * (sh_degree + 1) - 1);
    write_header(made->output.file, count, made->coefficients, antialiased);
    *writer = made;
    return 0;
}

static unsigned char *put_floats(unsigned char *to, const float *values, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        uint32_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        for (int shift = 0; shift < 32; shift += 8)
            *to++ = (unsigned char)(bits >> shift);
    }
    return to;
}

static size_t encode(const fxs_gaussian *g, size_t coefficients, unsigned char *row)
{
    static const float normal[3];
    unsigned char *to = put_floats(row, g->position, 3);
    to = put_floats(to, normal, 3);
    to = put_floats(to, g->dc, 3);
    for (size_t channel = 0; channel < 3; channel++)
        for (size_t k = 0; k < coefficients; k++)
            to = put_floats(to, &g->sh[3 * k + channel], 1);
    to = put_floats(to, &g->opacity, 1);
    to = put_floats(to, g->scale, 3);
    to = put_floats(to, g->rotation, 4);
    return (size_t)(to - row);
}

int fxs_ply_writer_put(fxs_ply_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    unsigned char row[MAX_PROPERTIES * 4];
    FXS_TRY(fxs_output_expect(&writer->output, n, message));
    for (size_t i = 0; i < n; i++) {
        size_t bytes = encode(&gaussians[i], writer->coefficients, row);
        FXS_TRY(fxs_output_write(&writer->output, row, bytes, message));
    }
    return 0;
}

int fxs_ply_writer_close(fxs_ply_writer *writer, fxs_message *message)
{
    int result = writer ? fxs_output_close(&writer->output, message) : 0;
    free(writer);
    return result;
}
