/* Writes .spz versions 3 (gzip) and 4 (zstd). Like the reference writer, keeps 5 of 8 bits for SH of degree 1 and 4
   bits for higher degrees. Positions usually have 12 or a few more fractional bits. With the option `fine`, SH keep all
   bits. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene_write_internal.h"
#include "src/base/report.h"
#include "src/base/exponential.h"
#include "src/pack/encode.h"
#include "src/scene/read/spz_internal.h"

#ifdef FXS_WITH_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif
#ifdef FXS_WITH_ZSTD
#include <zstd.h>
#endif

enum { USUAL_BITS = 12, MOST_BITS = 24, SPARE_BITS = 8, MAX_BITS = MOST_BITS + SPARE_BITS };
enum { ZSTD_LEVEL = 9, PIECE = 1 << 20 };
enum { POSITION_MAX = (1 << 23) - 1 };

typedef struct placement {
    float position[3], scale[3];
} placement;

typedef struct spz_writer {
    fxs_output output;
    int version, sh_degree, antialiased, fine;
    uint32_t count, next;
    /* fitting[b + 1]: number of positions that can be stored with at most b fractional bits */
    uint32_t fitting[MAX_BITS + 2];
    fxs_spz_clamped clamped;
    int fractional_bits;
    uint8_t stride[FXS_SPZ_ARRAYS];
    placement *placements;
    uint8_t *payload, *array[FXS_SPZ_ARRAYS];
    size_t size, done;
    const fxs_progress *progress;
} spz_writer;

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

static int make_room(spz_writer *w, const char *path, fxs_message *message)
{
    const size_t count = w->count;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        w->size += count * w->stride[i];
    w->payload = malloc(w->size + 1);
    w->placements = malloc((count + 1) * sizeof *w->placements);
    if (!w->payload || !w->placements)
        return fxs_fail_memory(message, path, w->size + count * sizeof *w->placements);
    w->array[0] = w->payload;
    for (int i = 1; i < FXS_SPZ_ARRAYS; i++)
        w->array[i] = w->array[i - 1] + count * w->stride[i - 1];
    return 0;
}

static void free_room(spz_writer *w)
{
    free(w->placements);
    free(w->payload);
}

static int spz_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    spz_writer *w = writer;
    w->version = o->spz_version ? o->spz_version : 4;
    if (w->version != 3 && w->version != 4)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: .spz version %d is not written, only 3 and 4", path,
                           w->version);
    if (!is_built_in(w->version))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot write .spz version %d: built without %s", path,
                           w->version, w->version == 3 ? "zlib" : "zstd");
    if (o->count > FXS_SPZ_MAX_COUNT)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: more than %d Gaussians", path, FXS_SPZ_MAX_COUNT);
    w->sh_degree = o->sh_degree;
    w->antialiased = o->antialiased;
    w->fine = o->spz_fine;
    w->count = (uint32_t)o->count;
    fxs_spz_strides(w->stride, (uint32_t)w->version, o->sh_degree);
    int error = make_room(w, path, message);
    if (!error)
        error = fxs_output_open(&w->output, path, o->count, message);
    if (error)
        free_room(w);
    return error;
}

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

/* Codes a quaternion x, y, z, w by all components except the largest. The sign of the quaternion is chosen so that the
   largest component is positive. */
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

static uint8_t code_byte(double x)
{
    return (uint8_t)code(x, 0, 255);
}

/* Returns 1 if a value to be stored in 8 bits lies outside 0 to 255 by more than 1. */
static int is_beyond(double x)
{
    return !(x >= -1 && x <= 256);
}

static double scale_code(const fxs_gaussian *g, int axis)
{
    return (g->scale[axis] + 10.0) * 16;
}

static int bits_for(const float position[3])
{
    const double most = fmax(fmax(fabs(position[0]), fabs(position[1])), fabs(position[2]));
    int bits = MAX_BITS;
    while (bits >= 0 && !(ldexp(most, bits) <= POSITION_MAX))
        bits--;
    return bits;
}

/* Codes all attributes of a Gaussian except position and scale. Negates y and z, which turns the axes right, down,
   front into right, up, back. */
static void encode(spz_writer *w, const fxs_gaussian *g, size_t index)
{
    uint8_t *at[FXS_SPZ_ARRAYS];
    const double q[4] = {g->rotation[1], -g->rotation[2], -g->rotation[3], g->rotation[0]};
    int dc = 0, sh = 0;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        at[i] = w->array[i] + index * w->stride[i];
    memcpy(w->placements[index].position, g->position, sizeof g->position);
    memcpy(w->placements[index].scale, g->scale, sizeof g->scale);
    w->fitting[bits_for(g->position) + 1]++;
    for (int i = 0; i < 3; i++) {
        const double x = (0.15 * g->dc[i] + 0.5) * 255;
        dc |= is_beyond(x);
        at[FXS_SPZ_COLOUR][i] = code_byte(x);
    }
    at[FXS_SPZ_ALPHA][0] = code_byte(255 / (1 + fxs_exp(-(double)g->opacity)));
    put_u32(at[FXS_SPZ_ROTATION], code_rotation(q));
    for (int i = 0; i < w->stride[FXS_SPZ_SH]; i++) {
        /* turning the axes negates SH functions that are odd in only one of y and z */
        int odd = fxs_spz_odd_in[i / 3] & 6;
        double x = 128 * (odd == 2 || odd == 4 ? -g->sh[i] : g->sh[i]) + 128;
        sh |= is_beyond(x);
        const int step = w->fine ? 1 : i < 9 ? 8 : 16;
        at[FXS_SPZ_SH][i] = code_byte(step * floor(x / step + 0.5));
    }
    w->clamped.dc += (uint32_t)dc;
    w->clamped.sh += (uint32_t)sh;
}

static int spz_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    spz_writer *w = writer;
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (size_t i = 0; i < n; i++)
        encode(w, &gaussians[i], w->next++);
    return 0;
}

/* Chooses the number of fractional bits of positions, which have 24 bits with sign. `most` is the largest number that
   fits all positions. Up to 12, fitting 99 % of the positions is enough. A file with the option `fine` uses `most`, up
   to 24. Other files use `most` - 8, but at least 12 if `most` is 12 or more. */
static void choose_bits(spz_writer *w)
{
    uint32_t beyond = 0;
    int bits = 0;
    while (bits <= MAX_BITS && beyond + w->fitting[bits] <= (bits <= USUAL_BITS ? (w->next + 99) / 100 : 0))
        beyond += w->fitting[bits++];
    const int most = bits > 0 ? bits - 1 : 0, spare = w->fine || most < USUAL_BITS ? 0 : SPARE_BITS;
    const int enough = most - spare < USUAL_BITS && spare ? USUAL_BITS : most - spare;
    w->fractional_bits = enough < MOST_BITS ? enough : MOST_BITS;
}

static void place(spz_writer *w, size_t index)
{
    uint8_t *position = w->array[FXS_SPZ_POSITION] + index * w->stride[FXS_SPZ_POSITION];
    uint8_t *scale = w->array[FXS_SPZ_SCALE] + index * w->stride[FXS_SPZ_SCALE];
    int clamped = 0;
    fxs_gaussian g = {.opacity = 0}, held;
    memcpy(g.position, w->placements[index].position, sizeof g.position);
    memcpy(g.scale, w->placements[index].scale, sizeof g.scale);
    w->clamped.position += (uint32_t)fxs_bring_in(&g, w->clamped.reach);
    held = g;
    fxs_hold_scales(&held);            /* clamping an axis that is too thin to be seen is not reported as a loss */
    for (int i = 0; i < 3; i++) {
        const double x = ldexp(i ? -g.position[i] : g.position[i], w->fractional_bits);
        const uint32_t bits = (uint32_t)code(x, -POSITION_MAX, POSITION_MAX);
        for (int k = 0; k < 3; k++)
            position[3 * i + k] = (uint8_t)(bits >> 8 * k);
        scale[i] = code_byte(scale_code(&g, i));
        clamped |= is_beyond(scale_code(&held, i));
    }
    w->clamped.scale += (uint32_t)clamped;
}

static void place_all(spz_writer *w)
{
    choose_bits(w);
    w->clamped.reach = ldexp(POSITION_MAX, -w->fractional_bits);
    for (size_t i = 0; i < w->next; i++)
        place(w, i);
    free(w->placements);
    w->placements = NULL;
}

#if defined(FXS_WITH_ZLIB) || defined(FXS_WITH_ZSTD)
static void make_header(const spz_writer *w, uint8_t header[16])
{
    put_u32(header, FXS_SPZ_MAGIC);
    put_u32(header + 4, (uint32_t)w->version);
    put_u32(header + 8, w->count);
    header[12] = (uint8_t)w->sh_degree;
    header[13] = (uint8_t)w->fractional_bits;
    header[14] = w->antialiased ? 1 : 0;
    header[15] = 0;
}

static int advance(spz_writer *w, size_t bytes)
{
    w->done += bytes;
    if (fxs_report(w->progress, (double)w->done / (double)w->size))
        w->output.error = ECANCELED;
    return w->output.error;
}

static size_t piece_of(size_t left)
{
    return left < PIECE ? left : PIECE;
}
#endif

#ifdef FXS_WITH_ZLIB
static int deflate_bytes(spz_writer *w, z_stream *stream, const uint8_t *bytes, size_t size, int flush,
                         fxs_message *message)
{
    uint8_t out[1 << 14];
    stream->next_in = bytes;
    stream->avail_in = (uInt)size;
    do {
        stream->next_out = out;
        stream->avail_out = sizeof out;
        deflate(stream, flush);
        FXS_TRY(fxs_output_write(&w->output, out, sizeof out - stream->avail_out, message));
    } while (stream->avail_out == 0);
    return 0;
}

static void write_gzip(spz_writer *w, fxs_message *message)
{
    z_stream stream;
    uint8_t header[16];
    memset(&stream, 0, sizeof stream);
    make_header(w, header);
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
        w->output.error = ENOMEM;
        return;
    }
    int stop = deflate_bytes(w, &stream, header, sizeof header, Z_NO_FLUSH, message);
    while (!stop && w->done < w->size) {
        size_t size = piece_of(w->size - w->done);
        stop = deflate_bytes(w, &stream, w->payload + w->done, size, Z_NO_FLUSH, message) || advance(w, size);
    }
    if (!stop)
        deflate_bytes(w, &stream, header, 0, Z_FINISH, message);
    deflateEnd(&stream);
}
#else
#define write_gzip(writer, message) ((void)0)
#endif

#ifdef FXS_WITH_ZSTD
static size_t write_frame(spz_writer *w, ZSTD_CStream *stream, const uint8_t *bytes, size_t size,
                          ZSTD_outBuffer *out)
{
    const size_t before = out->pos;
    ZSTD_CCtx_setParameter(stream, ZSTD_c_compressionLevel, ZSTD_LEVEL);
    ZSTD_CCtx_setPledgedSrcSize(stream, size);
    for (size_t at = 0; at < size && !w->output.error;) {
        ZSTD_inBuffer in = {bytes + at, piece_of(size - at), 0};
        const int last = at + in.size == size;
        size_t left = ZSTD_compressStream2(stream, out, &in, last ? ZSTD_e_end : ZSTD_e_continue);
        if (ZSTD_isError(left) || in.pos < in.size || (last && left))
            w->output.error = ENOMEM;
        else
            advance(w, in.size);
        at += in.size;
    }
    return out->pos - before;
}

static void put_u64(uint8_t *to, uint64_t value)
{
    put_u32(to, (uint32_t)value);
    put_u32(to + 4, (uint32_t)(value >> 32));
}

static void write_arrays(spz_writer *w, ZSTD_CStream *stream, uint8_t *head, size_t head_size, ZSTD_outBuffer *out,
                         fxs_message *message)
{
    uint8_t *entry = head + 32;
    for (int i = 0; i < head[15]; i++, entry += 16) {
        size_t size = (size_t)w->count * w->stride[i];
        put_u64(entry, write_frame(w, stream, w->array[i], size, out));
        put_u64(entry + 8, size);
    }
    if (!w->output.error && !fxs_output_write(&w->output, head, head_size, message))
        fxs_output_write(&w->output, out->dst, out->pos, message);
}

/* Compresses all data before writing, because the table of contents comes first and the output may be a pipe. */
static void write_zstd(spz_writer *w, fxs_message *message)
{
    uint8_t head[32 + 16 * FXS_SPZ_ARRAYS] = {0};
    ZSTD_outBuffer out = {NULL, 0, 0};
    make_header(w, head);
    put_u32(head + 16, 32);
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        head[15] = (uint8_t)(head[15] + (w->count > 0 && w->stride[i] > 0));
        out.size += ZSTD_compressBound((size_t)w->count * w->stride[i]);
    }
    ZSTD_CStream *stream = ZSTD_createCStream();
    out.dst = malloc(out.size);
    if (stream && out.dst)
        write_arrays(w, stream, head, 32 + 16 * (size_t)head[15], &out, message);
    else
        w->output.error = ENOMEM;
    ZSTD_freeCStream(stream);
    free(out.dst);
}
#else
#define write_zstd(writer, message) ((void)0)
#endif

static int spz_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    spz_writer *w = writer;
    place_all(w);
    w->progress = progress;
    int whole = w->next == w->count && !w->output.error;
    if (whole && w->version == 3)
        write_gzip(w, message);
    if (whole && w->version == 4)
        write_zstd(w, message);
    report->clamped = w->clamped;
    int result = fxs_output_close(&w->output, message);
    free_room(w);
    return result;
}

const fxs_writer fxs_write_spz = {sizeof(spz_writer), spz_open, spz_put, spz_close, NULL};
