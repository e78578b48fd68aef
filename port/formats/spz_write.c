#include "spz_write.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "spz_internal.h"

#ifdef FXS_WITH_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif
#ifdef FXS_WITH_ZSTD
#include <zstd.h>
#endif

enum { FRACTIONAL_BITS = 12, ZSTD_LEVEL = 9 };

struct fxs_spz_writer {
    char *path;
    int version, sh_degree, antialiased;
    uint32_t count, next;
    uint8_t stride[FXS_SPZ_ARRAYS];
    uint8_t *payload, *array[FXS_SPZ_ARRAYS];
    size_t size;   /* of the payload */
};

static int is_built_in(int version)
{
#ifdef FXS_WITH_ZLIB
    if (version == 3)
        return 1;
#endif
#ifdef FXS_WITH_ZSTD
    if (version == 4)
        return 1;
#endif
    return version != 3 && version != 4;
}

static void free_writer(fxs_spz_writer *writer)
{
    free(writer->path);
    free(writer->payload);
    free(writer);
}

int fxs_spz_writer_open(const char *path, int version, uint64_t count, int sh_degree, int antialiased,
                        fxs_spz_writer **writer, fxs_message *message)
{
    *writer = NULL;
    if (version != 3 && version != 4)
        return fxs_fail(message, "%s: .spz version %d is not written, only 3 and 4", path, version);
    if (!is_built_in(version))
        return fxs_fail(message, "%s: cannot write .spz version %d: built without %s", path, version,
                        version == 3 ? "zlib" : "zstd");
    if (sh_degree < 0 || sh_degree > 3)
        return fxs_fail(message, "%s: SH degree %d, not 0 to 3", path, sh_degree);
    if (count > FXS_SPZ_MAX_COUNT)
        return fxs_fail(message, "%s: more than %d Gaussians", path, FXS_SPZ_MAX_COUNT);
    fxs_spz_writer *made = calloc(1, sizeof *made);
    if (!made)
        return fxs_fail(message, "%s: out of memory", path);
    made->version = version;
    made->sh_degree = sh_degree;
    made->antialiased = antialiased;
    made->count = (uint32_t)count;
    fxs_spz_strides(made->stride, (uint32_t)version, sh_degree);
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        made->size += (size_t)count * made->stride[i];
    made->path = strdup(path);
    made->payload = malloc(made->size + 1);
    if (!made->path || !made->payload) {
        free_writer(made);
        return fxs_fail(message, "%s: out of memory", path);
    }
    made->array[0] = made->payload;
    for (int i = 1; i < FXS_SPZ_ARRAYS; i++)
        made->array[i] = made->array[i - 1] + (size_t)count * made->stride[i - 1];
    *writer = made;
    return 0;
}

/* ---- Codes ----------------------------------------------------------------------------------------------------- */

/* The nearest whole number from low to high; low for NaN. */
static int32_t code(double x, int32_t low, int32_t high)
{
    x = floor(x + 0.5);
    return x > low ? x < high ? (int32_t)x : high : low;
}

static void put_u32(uint8_t *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

/* x, y, z, w; the largest is left out and made positive. */
static uint32_t code_rotation(const double q[4])
{
    double norm = 0;
    int largest = 3;
    for (int i = 0; i < 4; i++) {
        norm += q[i] * q[i];
        largest = fabs(q[i]) > fabs(q[largest]) ? i : largest;
    }
    uint32_t word = (uint32_t)largest;
    double scale = 511 * 1.4142135623730951 / sqrt(norm);
    for (int i = 0; i < 4; i++)
        if (i != largest) {
            uint32_t negative = (q[i] < 0) != (q[largest] < 0);
            word = word << 10 | negative << 9 | (uint32_t)code(fabs(q[i]) * scale, 0, 511);
        }
    return word;
}

/* y and z change their signs: from right, down, front to right, up, back. */
static void encode(const fxs_spz_writer *w, const fxs_gaussian *g, size_t index)
{
    uint8_t *at[FXS_SPZ_ARRAYS];
    const double q[4] = {g->rotation[1], -g->rotation[2], -g->rotation[3], g->rotation[0]};
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        at[i] = w->array[i] + index * w->stride[i];
    for (int i = 0; i < 3; i++) {
        double x = ldexp(i ? -g->position[i] : g->position[i], FRACTIONAL_BITS);
        uint32_t bits = (uint32_t)code(x, -(1 << 23), (1 << 23) - 1);
        for (int k = 0; k < 3; k++)
            at[FXS_SPZ_POSITION][3 * i + k] = (uint8_t)(bits >> 8 * k);
        at[FXS_SPZ_COLOUR][i] = (uint8_t)code((0.15 * g->dc[i] + 0.5) * 255, 0, 255);
        at[FXS_SPZ_SCALE][i] = (uint8_t)code((g->scale[i] + 10.0) * 16, 0, 255);
    }
    at[FXS_SPZ_ALPHA][0] = (uint8_t)code(255 / (1 + exp(-(double)g->opacity)), 0, 255);
    put_u32(at[FXS_SPZ_ROTATION], code_rotation(q));
    for (int i = 0; i < w->stride[FXS_SPZ_SH]; i++) {
        int odd = fxs_spz_odd_in[i / 3] & 6;   /* in y, in z: a sign for each */
        double x = odd == 2 || odd == 4 ? -g->sh[i] : g->sh[i];
        at[FXS_SPZ_SH][i] = (uint8_t)code(128 * x + 128, 0, 255);
    }
}

int fxs_spz_writer_put(fxs_spz_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    if (n > writer->count - writer->next)
        return fxs_fail(message, "%s: more Gaussians than announced", writer->path);
    for (size_t i = 0; i < n; i++)
        encode(writer, &gaussians[i], writer->next++);
    return 0;
}

/* ---- The file -------------------------------------------------------------------------------------------------- */

#if defined(FXS_WITH_ZLIB) || defined(FXS_WITH_ZSTD)
static void make_header(const fxs_spz_writer *w, uint8_t header[16])
{
    put_u32(header, FXS_SPZ_MAGIC);
    put_u32(header + 4, (uint32_t)w->version);
    put_u32(header + 8, w->count);
    header[12] = (uint8_t)w->sh_degree;
    header[13] = FRACTIONAL_BITS;
    header[14] = w->antialiased ? 1 : 0;
    header[15] = 0;
}
#endif

/* Both writers return 1 where all was written. */

#ifdef FXS_WITH_ZLIB
static int deflate_bytes(z_stream *stream, const uint8_t *bytes, size_t size, int flush, FILE *file)
{
    uint8_t out[1 << 14];
    int status = Z_OK;
    do {
        uInt piece = size < 1 << 30 ? (uInt)size : 1 << 30;
        stream->next_in = bytes;
        stream->avail_in = piece;
        bytes += piece;
        size -= piece;
        do {
            stream->next_out = out;
            stream->avail_out = sizeof out;
            status = deflate(stream, size ? Z_NO_FLUSH : flush);
            if (fwrite(out, 1, sizeof out - stream->avail_out, file) != sizeof out - stream->avail_out)
                return 0;
        } while (stream->avail_out == 0);
    } while (size > 0);
    return status == (flush == Z_FINISH ? Z_STREAM_END : Z_OK) || status == Z_BUF_ERROR;
}

static int write_gzip(const fxs_spz_writer *w, FILE *file)
{
    z_stream stream;
    uint8_t header[16];
    memset(&stream, 0, sizeof stream);
    make_header(w, header);
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return 0;
    int done = deflate_bytes(&stream, header, sizeof header, Z_NO_FLUSH, file) &&
               deflate_bytes(&stream, w->payload, w->size, Z_FINISH, file);
    deflateEnd(&stream);
    return done;
}
#else
#define write_gzip(writer, file) 0
#endif

#ifdef FXS_WITH_ZSTD
/* Returns the compressed size, or 0. */
static size_t write_frame(const uint8_t *bytes, size_t size, FILE *file)
{
    size_t room = ZSTD_compressBound(size);
    uint8_t *out = malloc(room);
    size_t compressed = out ? ZSTD_compress(out, room, bytes, size, ZSTD_LEVEL) : 0;
    if (!out || ZSTD_isError(compressed) || fwrite(out, 1, compressed, file) != compressed)
        compressed = 0;
    free(out);
    return compressed;
}

static void put_u64(uint8_t *to, uint64_t value)
{
    put_u32(to, (uint32_t)value);
    put_u32(to + 4, (uint32_t)(value >> 32));
}

/* Header and table of contents are written once more when the sizes are known. */
static int write_zstd(const fxs_spz_writer *w, FILE *file)
{
    uint8_t head[32 + 16 * FXS_SPZ_ARRAYS] = {0}, *entry = head + 32;
    make_header(w, head);
    put_u32(head + 16, 32);
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        head[15] = (uint8_t)(head[15] + (w->count > 0 && w->stride[i] > 0));
    const size_t head_size = 32 + 16 * (size_t)head[15];
    if (fwrite(head, 1, head_size, file) != head_size)
        return 0;
    for (int i = 0; i < head[15]; i++, entry += 16) {
        size_t size = (size_t)w->count * w->stride[i], compressed = write_frame(w->array[i], size, file);
        if (compressed == 0)
            return 0;
        put_u64(entry, compressed);
        put_u64(entry + 8, size);
    }
    return fseeko(file, 0, SEEK_SET) == 0 && fwrite(head, 1, head_size, file) == head_size;
}
#else
#define write_zstd(writer, file) 0
#endif

static int complete(const fxs_spz_writer *w, fxs_message *message)
{
    if (w->next != w->count)
        return fxs_fail(message, "%s: %u Gaussians fewer than announced", w->path, w->count - w->next);
    size_t room = strlen(w->path) + 40;
    char *temporary = malloc(room);
    if (!temporary)
        return fxs_fail(message, "%s: out of memory", w->path);
    snprintf(temporary, room, "%s.fixsplat-%ld.tmp", w->path, (long)getpid());
    errno = 0;
    FILE *file = fopen(temporary, "wb");
    int written = file && (w->version == 3 ? write_gzip(w, file) : write_zstd(w, file));
    written = file && fclose(file) == 0 && written && rename(temporary, w->path) == 0;
    int result = written ? 0 : fxs_fail(message, "%s: write failed: %s", w->path, strerror(errno ? errno : ENOMEM));
    if (file && !written)
        remove(temporary);
    free(temporary);
    return result;
}

int fxs_spz_writer_close(fxs_spz_writer *writer, fxs_message *message)
{
    if (!writer)
        return 0;
    int result = complete(writer, message);
    free_writer(writer);
    return result;
}
