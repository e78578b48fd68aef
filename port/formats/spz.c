/* .spz, versions 1 to 4, as in README and src/cc of nianticlabs/spz. */
#include "spz_internal.h"

#include <stdlib.h>
#include <string.h>

#include "byte_reader.h"
#include "scene_codes.h"

#ifdef FXS_WITH_ZLIB
#define ZLIB_CONST
#include <zlib.h>
#endif
#ifdef FXS_WITH_ZSTD
#include <zstd.h>
#endif

#define COORDINATE_SYSTEM 0xadbe0003u        /* the type of an extension */

enum {
    HEADER_SIZE = 16, HEADER_SIZE_4 = 32,    /* versions 1 to 3, and 4 */
    MAX_FRACTIONAL_BITS = 24,
    MAX_EXTENSIONS = 1 << 16,                /* bytes, where they are compressed */
    MAX_EXPANSION = 1032                     /* of deflate */
};

enum { ANTIALIASED = 1, HAS_EXTENSIONS = 2, LEVELS_OF_DETAIL = 0x80 };   /* flags */

enum { RUB = 4, RDF = 6, LAST_XYZ = 8 };     /* coordinate systems: 1 + R + 2 U + 4 F of right, up, front */

const uint8_t fxs_spz_odd_in[15] = {2, 4, 1, 3, 6, 0, 5, 0, 2, 7, 2, 4, 1, 4, 1};

struct fxs_spz {
    uint32_t version, count;
    int sh_degree, fractional_bits, flags;
    int keep_axes;
    float flip[3], flip_rotation[3], flip_sh[15];   /* +-1, from the file's axes to those wanted */
    uint8_t stride[FXS_SPZ_ARRAYS];                         /* bytes a Gaussian */
    uint8_t *payload, *array[FXS_SPZ_ARRAYS];
    uint32_t next;                                  /* Gaussian to read */
};

typedef struct input {
    const char *name;
    const uint8_t *data;
    size_t size;
    fxs_message *message;
} input;

static int fail(const input *in, const char *fault)
{
    return fxs_fail(in->message, "%s: %s", in->name, fault);
}

/* ---- Header ---------------------------------------------------------------------------------------------------- */

static uint64_t array_bytes(const fxs_spz *spz, int array)
{
    return (uint64_t)spz->count * spz->stride[array];
}

static uint64_t payload_bytes(const fxs_spz *spz)
{
    uint64_t bytes = 0;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        bytes += array_bytes(spz, i);
    return bytes;
}

void fxs_spz_strides(uint8_t stride[FXS_SPZ_ARRAYS], uint32_t version, int sh_degree)
{
    const uint8_t strides[FXS_SPZ_ARRAYS] = {version == 1 ? 6 : 9, 1, 3, 3, version < 3 ? 3 : 4,
                                             (uint8_t)(3 * sh_degree * (sh_degree + 2))};
    memcpy(stride, strides, sizeof strides);
}

static int parse_header(fxs_spz *spz, const input *in, const uint8_t *header)
{
    if (fxs_load_u32(header) != FXS_SPZ_MAGIC)
        return fail(in, "not an .spz file: no NGSP at its beginning");
    spz->version = fxs_load_u32(header + 4);
    spz->count = fxs_load_u32(header + 8);
    spz->sh_degree = header[12];
    spz->fractional_bits = header[13];
    spz->flags = header[14];
    if (spz->version < 1 || spz->version > 4)
        return fxs_fail(in->message, "%s: .spz version %u, not 1 to 4", in->name, spz->version);
    if (spz->sh_degree > 4)
        return fxs_fail(in->message, "%s: SH degree %d, not 0 to 4", in->name, spz->sh_degree);
    if (spz->fractional_bits > MAX_FRACTIONAL_BITS)
        return fxs_fail(in->message, "%s: positions with %d fractional bits, not 0 to %d", in->name,
                        spz->fractional_bits, MAX_FRACTIONAL_BITS);
    if (spz->flags & LEVELS_OF_DETAIL)
        return fail(in, "a tree of levels of detail (Spark) is not read");
    if (spz->count > FXS_SPZ_MAX_COUNT || (uint64_t)spz->count * 9 > (uint64_t)in->size * 1024)
        return fxs_fail(in->message, "%s: the header tells of %u Gaussians, more than %zu bytes hold", in->name,
                        spz->count, in->size);
    fxs_spz_strides(spz->stride, spz->version, spz->sh_degree);
    return 0;
}

/* Values above 8 have y and z exchanged, but which is which differs between versions of the reference library. */
static int set_axes(fxs_spz *spz, const input *in, uint32_t system)
{
    system = spz->keep_axes ? RDF : system ? system : RUB;
    if (system > LAST_XYZ)
        return fxs_fail(in->message, "%s: coordinate system %u, not 0 to %d", in->name, system, LAST_XYZ);
    uint32_t flips = (system - 1) ^ (RDF - 1);
    for (int i = 0; i < 3; i++)
        spz->flip[i] = flips >> i & 1 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        spz->flip_rotation[i] = spz->flip[(i + 1) % 3] * spz->flip[(i + 2) % 3];
    for (int k = 0; k < 15; k++) {
        spz->flip_sh[k] = 1;
        for (int i = 0; i < 3; i++)
            if (fxs_spz_odd_in[k] >> i & 1)
                spz->flip_sh[k] *= spz->flip[i];
    }
    return 0;
}

/* Records of type, length, payload. */
static int parse_extensions(fxs_spz *spz, const input *in, const uint8_t *bytes, uint64_t size)
{
    uint32_t system = RUB;
    while (size > 0) {
        uint32_t length = size < 8 ? 0 : fxs_load_u32(bytes + 4);
        if (size < 8 || length > size - 8)
            return fail(in, "an extension ends early");
        if (fxs_load_u32(bytes) == COORDINATE_SYSTEM) {
            if (length != 4)
                return fail(in, "the extension with the coordinate system has not 4 bytes");
            system = fxs_load_u32(bytes + 8);
        }
        bytes += 8 + (size_t)length;
        size -= 8 + (uint64_t)length;
    }
    return set_axes(spz, in, system);
}

static int allocate(fxs_spz *spz, const input *in, size_t extra)
{
    uint64_t bytes = payload_bytes(spz) + extra;
    spz->payload = bytes <= SIZE_MAX ? malloc((size_t)bytes) : NULL;
    if (!spz->payload)
        return fxs_fail(in->message, "%s: out of memory for %u Gaussians", in->name, spz->count);
    uint8_t *at = spz->payload;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        spz->array[i] = at;
        at += array_bytes(spz, i);
    }
    return 0;
}

/* ---- Versions 1 to 3: one stream, gzip or plain ---------------------------------------------------------------- */

static int check_payload(const fxs_spz *spz, const input *in, uint64_t size)
{
    uint64_t wanted = payload_bytes(spz);
    if (size < wanted || (size > wanted && !(spz->flags & HAS_EXTENSIONS)))
        return fxs_fail(in->message, "%s: the header asks for %llu bytes of attributes, there are %llu", in->name,
                        (unsigned long long)wanted, (unsigned long long)size);
    return 0;
}

static int load_plain(fxs_spz *spz, const input *in)
{
    const uint8_t *payload = in->data + HEADER_SIZE;
    size_t size = in->size - HEADER_SIZE, wanted = (size_t)payload_bytes(spz);
    if (check_payload(spz, in, size) || parse_extensions(spz, in, payload + wanted, size - wanted) ||
        allocate(spz, in, 1))
        return -1;
    memcpy(spz->payload, payload, wanted);
    return 0;
}

#ifdef FXS_WITH_ZLIB

/* Inflates up to `size` bytes, in pieces that zlib can count. Returns zlib's last status. */
static int inflate_some(z_stream *stream, const input *in, uint8_t *out, size_t size, size_t *got)
{
    const size_t piece = 1u << 30;
    int status = Z_OK;
    *got = 0;
    while (*got < size && status == Z_OK) {
        size_t left = in->size - (size_t)(stream->next_in - in->data), room = size - *got;
        stream->avail_in = (uInt)(left < piece ? left : piece);
        stream->avail_out = (uInt)(room = room < piece ? room : piece);
        stream->next_out = out + *got;
        status = inflate(stream, Z_NO_FLUSH);
        *got += room - stream->avail_out;
    }
    return status;
}

static int fail_inflate(const input *in, int status)
{
    return fail(in, status == Z_BUF_ERROR || status == Z_STREAM_END ? "the gzip stream ends early"
                    : status == Z_MEM_ERROR ? "out of memory" : "the gzip stream is damaged");
}

static int inflate_all(fxs_spz *spz, const input *in, z_stream *stream)
{
    uint8_t header[HEADER_SIZE];
    size_t got;
    int status = inflate_some(stream, in, header, sizeof header, &got);
    if (got < sizeof header)
        return fail_inflate(in, status);
    if (parse_header(spz, in, header))
        return -1;
    if (spz->version == 4)
        return fail(in, "version 4 within gzip");
    uint64_t wanted = payload_bytes(spz);
    size_t extra = (spz->flags & HAS_EXTENSIONS ? MAX_EXTENSIONS : 0) + 1;   /* one more than there may be */
    if (wanted / MAX_EXPANSION > in->size)
        return fxs_fail(in->message, "%s: the header asks for %llu bytes of attributes, more than %zu can inflate to",
                        in->name, (unsigned long long)wanted, in->size);
    if (allocate(spz, in, extra))
        return -1;
    status = inflate_some(stream, in, spz->payload, (size_t)wanted + extra, &got);
    if (got == wanted + extra)
        return fail(in, "the gzip stream has more bytes than the header asks for");
    if (status != Z_STREAM_END)
        return fail_inflate(in, status);
    return check_payload(spz, in, got) ? -1 : parse_extensions(spz, in, spz->payload + wanted, got - wanted);
}

static int load_gzip(fxs_spz *spz, const input *in)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    stream.next_in = in->data;
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK)
        return fail(in, "out of memory");
    int result = inflate_all(spz, in, &stream);
    inflateEnd(&stream);
    return result;
}

#else

static int load_gzip(fxs_spz *spz, const input *in)
{
    (void)spz;
    return fail(in, "cannot read gzip: built without zlib");
}

#endif

/* ---- Version 4: a zstd stream for each array ------------------------------------------------------------------- */

#ifdef FXS_WITH_ZSTD

static uint64_t load_u64(const uint8_t *bytes)
{
    return fxs_load_u32(bytes) | (uint64_t)fxs_load_u32(bytes + 4) << 32;
}

/* The entries: compressed and uncompressed size of each array that is not empty. */
static int check_contents(const fxs_spz *spz, const input *in, uint32_t contents)
{
    int streams = 0;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        streams += array_bytes(spz, i) > 0;
    if (in->data[15] != streams)
        return fxs_fail(in->message, "%s: %d streams, not %d", in->name, in->data[15], streams);
    if (contents < HEADER_SIZE_4 || contents > in->size || in->size - contents < (size_t)streams * 16)
        return fail(in, "the table of contents is not within the file");
    const uint8_t *entry = in->data + contents;
    uint64_t left = in->size - contents - (size_t)streams * 16;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        if (array_bytes(spz, i) == 0)
            continue;
        if (load_u64(entry + 8) != array_bytes(spz, i))
            return fxs_fail(in->message, "%s: the header asks for %llu bytes in a stream of %llu", in->name,
                            (unsigned long long)array_bytes(spz, i), (unsigned long long)load_u64(entry + 8));
        if (load_u64(entry) > left)
            return fail(in, "the file ends early");
        left -= load_u64(entry);
        entry += 16;
    }
    return left ? fail(in, "there are bytes behind the last stream") : 0;
}

static int load_zstd(fxs_spz *spz, const input *in)
{
    uint32_t contents = in->size < HEADER_SIZE_4 ? 0 : fxs_load_u32(in->data + 16);
    if (check_contents(spz, in, contents))
        return -1;
    uint32_t extensions = spz->flags & HAS_EXTENSIONS ? contents - HEADER_SIZE_4 : 0;
    if (parse_extensions(spz, in, in->data + HEADER_SIZE_4, extensions) || allocate(spz, in, 1))
        return -1;
    const uint8_t *entry = in->data + contents, *stream = entry + 16 * (size_t)in->data[15];
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        size_t size = (size_t)array_bytes(spz, i), compressed = size ? (size_t)load_u64(entry) : 0;
        if (size == 0)
            continue;
        if (ZSTD_decompress(spz->array[i], size, stream, compressed) != size)
            return fail(in, "a zstd stream is damaged, or of another size than the header asks for");
        stream += compressed;
        entry += 16;
    }
    return 0;
}

#else

static int load_zstd(fxs_spz *spz, const input *in)
{
    (void)spz;
    return fail(in, "cannot read .spz version 4: built without zstd");
}

#endif

/* ---- Opening --------------------------------------------------------------------------------------------------- */

static int load(fxs_spz *spz, const input *in)
{
    if (in->size >= 2 && in->data[0] == 0x1f && in->data[1] == 0x8b)
        return load_gzip(spz, in);
    if (in->size < HEADER_SIZE)
        return fail(in, "the file ends early");
    if (parse_header(spz, in, in->data))
        return -1;
    return spz->version == 4 ? load_zstd(spz, in) : load_plain(spz, in);
}

int fxs_spz_open(const char *name, const uint8_t *data, size_t size, int keep_axes, fxs_spz **spz,
                 fxs_scene_file_info *info, fxs_message *message)
{
    const input in = {name, data, size, message};
    *spz = calloc(1, sizeof **spz);
    if (!*spz)
        return fail(&in, "out of memory");
    (*spz)->keep_axes = keep_axes;
    if (load(*spz, &in)) {
        fxs_spz_close(*spz);
        *spz = NULL;
        return -1;
    }
    info->count = (*spz)->count;
    info->sh_degree = (*spz)->sh_degree < 3 ? (*spz)->sh_degree : 3;
    info->antialiased = (*spz)->flags & ANTIALIASED;
    return 0;
}

void fxs_spz_close(fxs_spz *spz)
{
    if (spz)
        free(spz->payload);
    free(spz);
}

/* ---- Gaussians ------------------------------------------------------------------------------------------------- */

static float half(uint32_t bits)
{
    int exponent = bits >> 10 & 31, sign = bits >> 15 ? -1 : 1;
    float mantissa = (float)(bits & 1023);
    if (exponent == 31)
        return mantissa != 0 ? NAN : (float)sign * INFINITY;
    return (float)sign * (exponent ? ldexpf(1024 + mantissa, exponent - 25) : ldexpf(mantissa, -24));
}

static float position(const fxs_spz *spz, const uint8_t *bytes)
{
    if (spz->version == 1)
        return half(fxs_load_u16(bytes));
    int32_t value = bytes[0] | bytes[1] << 8 | bytes[2] << 16;
    return ldexpf((float)(value - (value >> 23 << 24)), -spz->fractional_bits);
}

/* x, y, z in 8 bits. In double: the rest of 1 may be small. */
static void decode_first_three(double q[4], const uint8_t *bytes)
{
    double rest = 1;
    for (int i = 0; i < 3; i++) {
        q[i] = bytes[i] / 127.5 - 1;
        rest -= q[i] * q[i];
    }
    q[3] = sqrt(fmax(rest, 0));
}

/* Bits 31 and 30: which of x, y, z, w is the largest. The others, sign and 9 bits each: the last is the lowest. */
static void decode_smallest_three(double q[4], uint32_t word)
{
    uint32_t largest = word >> 30;
    double rest = 1;
    for (uint32_t i = 4; i-- > 0;) {
        if (i == largest)
            continue;
        double value = (word & 511) * (0.7071067811865476 / 511);
        q[i] = word >> 9 & 1 ? -value : value;
        rest -= value * value;
        word >>= 10;
    }
    q[largest] = sqrt(fmax(rest, 0));
}

static void decode(const fxs_spz *spz, size_t index, fxs_gaussian *g)
{
    const uint8_t *at[FXS_SPZ_ARRAYS];
    double q[4];
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        at[i] = spz->array[i] + index * spz->stride[i];
    memset(g, 0, sizeof *g);
    if (spz->version < 3)
        decode_first_three(q, at[FXS_SPZ_ROTATION]);
    else
        decode_smallest_three(q, fxs_load_u32(at[FXS_SPZ_ROTATION]));
    g->rotation[0] = (float)q[3];
    for (int i = 0; i < 3; i++) {
        g->position[i] = spz->flip[i] * position(spz, at[FXS_SPZ_POSITION] + i * spz->stride[FXS_SPZ_POSITION] / 3);
        g->rotation[i + 1] = spz->flip_rotation[i] * (float)q[i];
        g->scale[i] = (float)at[FXS_SPZ_SCALE][i] / 16 - 10;
        g->dc[i] = ((float)at[FXS_SPZ_COLOUR][i] / 255 - 0.5f) / 0.15f;
    }
    g->opacity = fxs_logit_of_code(at[FXS_SPZ_ALPHA][0]);
    for (int i = 0; i < spz->stride[FXS_SPZ_SH] && i < 45; i++)
        g->sh[i] = spz->flip_sh[i / 3] * (float)(at[FXS_SPZ_SH][i] - 128) / 128;
}

size_t fxs_spz_read(fxs_spz *spz, fxs_gaussian *gaussians, size_t capacity)
{
    size_t left = spz->count - spz->next, count = capacity < left ? capacity : left;
    for (size_t i = 0; i < count; i++)
        decode(spz, spz->next++, &gaussians[i]);
    return count;
}

void fxs_spz_rewind(fxs_spz *spz)
{
    spz->next = 0;
}

/* ---- A file of its own ----------------------------------------------------------------------------------------- */

static int spz_open(const fxs_scene_source *source, void **reader, fxs_scene_file_info *info, fxs_message *message)
{
    fxs_spz *spz = NULL;
    uint8_t *data = source->size < SIZE_MAX ? malloc((size_t)source->size + 1) : NULL;
    if (!data)
        return fxs_fail(message, "%s: out of memory", source->path);
    int result = fxs_scene_source_read(source, 0, data, (size_t)source->size, message);
    if (!result)
        result = fxs_spz_open(source->path, data, (size_t)source->size, 0, &spz, info, message);
    free(data);
    *reader = spz;
    return result;
}

static long spz_read(void *reader, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    (void)message;
    return (long)fxs_spz_read(reader, gaussians, capacity);
}

static int spz_rewind(void *reader, fxs_message *message)
{
    (void)message;
    fxs_spz_rewind(reader);
    return 0;
}

static void spz_close(void *reader)
{
    fxs_spz_close(reader);
}

const fxs_scene_format fxs_scene_spz = {"spz", spz_open, spz_read, spz_rewind, spz_close};
