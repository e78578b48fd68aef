/* Reads .spz versions 1 to 4, as specified by the README and src/cc of nianticlabs/spz.
 *
 * The axes are right, up, back, unless an extension says otherwise. splat-transform 3 writes the axes of a .ply
 * without saying so. Header and Gaussians of such a file look like any other, so the caller sets the option `axes`. */
#include <fixsplat/internal/allocator.h>

#include "spz_internal.h"

#include <errno.h>
#include <string.h>

#include "src/base/byte_reader.h"
#include "src/base/fail_list.h"
#include "src/base/inflate_internal.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

#ifdef FXS_WITH_ZSTD
#include <zstd.h>
#endif

#define COORDINATE_SYSTEM 0xadbe0003u

enum {
    HEADER_SIZE = 16, HEADER_SIZE_4 = 32,
    MAX_FRACTIONAL_BITS = 24,
    MAX_EXTENSIONS = 1 << 16
};

#define COLOUR_RANGE 0.15   /* range of colour codes: SH of degree 0 is (code / 255 - 0.5) / COLOUR_RANGE */

enum { ANTIALIASED = 1, HAS_EXTENSIONS = 2, LEVELS_OF_DETAIL = 0x80 };

/* Codes of coordinate systems: 1 + R + 2 U + 4 F. R, U, F are 1 if x is right, y is up, z is front, else 0. */
enum { RUB = 4, RDF = 6, LAST_XYZ = 8 };

const uint8_t fxs_spz_odd_in[15] = {2, 4, 1, 3, 6, 0, 5, 0, 2, 7, 2, 4, 1, 4, 1};

struct fxs_spz {
    const fxs_scene_source *source;
    uint64_t offset, size;
    fxs_message *message;
    uint32_t version, count;
    int sh_degree, fractional_bits, flags;
    enum fxs_axes axes;
    int is_gzip;
    float flip[3], flip_rotation[3], flip_sh[15];
    uint8_t stride[FXS_SPZ_ARRAYS];
    uint8_t *payload, *array[FXS_SPZ_ARRAYS];
    uint64_t payload_size;
    uint32_t contents;
    uint64_t compressed[FXS_SPZ_ARRAYS];
    uint32_t next;
};

static int fail(const fxs_spz *spz, const char *fault)
{
    return fxs_fail(spz->message, "%s: %s", spz->source->path, fault);
}

static int read_at(const fxs_spz *spz, uint64_t offset, void *out, size_t size)
{
    if (offset > spz->size || size > spz->size - offset)
        return fail(spz, "the file ends early");
    return fxs_scene_source_read(spz->source, spz->offset + offset, out, size, spz->message);
}

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

static int parse_header(fxs_spz *spz, const uint8_t *header)
{
    if (fxs_load_u32(header) != FXS_SPZ_MAGIC)
        return fail(spz, spz->is_gzip ? "compressed by gzip, but no .spz: unpack it first"
                                      : "not an .spz file: no NGSP at its beginning");
    spz->version = fxs_load_u32(header + 4);
    spz->count = fxs_load_u32(header + 8);
    spz->sh_degree = header[12];
    spz->fractional_bits = header[13];
    spz->flags = header[14];
    if (spz->version < 1 || spz->version > 4)
        return fxs_fail(spz->message, "%s: .spz version %u, not 1 to 4", spz->source->path, spz->version);
    if (spz->sh_degree > 4)
        return fxs_fail(spz->message, "%s: SH degree %d, not 0 to 4", spz->source->path, spz->sh_degree);
    if (spz->fractional_bits > MAX_FRACTIONAL_BITS)
        return fxs_fail(spz->message, "%s: positions with %d fractional bits, not 0 to %d", spz->source->path,
                        spz->fractional_bits, MAX_FRACTIONAL_BITS);
    if (spz->flags & LEVELS_OF_DETAIL)
        return fail(spz, "a tree of levels of detail (Spark) is not read");
    if (spz->count > FXS_SPZ_MAX_COUNT || (spz->version < 4 && (uint64_t)spz->count * 9 > spz->size * 1024))
        return fxs_fail(spz->message, "%s: the header tells of %u Gaussians, more than %llu bytes hold",
                        spz->source->path, spz->count, (unsigned long long)spz->size);
    fxs_spz_strides(spz->stride, spz->version, spz->sh_degree);
    return 0;
}

/* Sets the coordinate system of the file. Codes above 8 exchange y and z, but versions of the reference library
   disagree on how. */
static int set_axes(fxs_spz *spz, uint32_t system)
{
    const uint32_t asked[] = {[FXS_AXES_OF_FILE] = system ? system : RUB, [FXS_AXES_RUB] = RUB, [FXS_AXES_RDF] = RDF};
    system = asked[spz->axes];
    if (system > LAST_XYZ)
        return fxs_fail(spz->message, "%s: coordinate system %u, not 0 to %d", spz->source->path, system, LAST_XYZ);
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

static int parse_extensions(fxs_spz *spz, const uint8_t *bytes, uint64_t size)
{
    uint32_t system = RUB;
    while (size > 0) {
        uint32_t length = size < 8 ? 0 : fxs_load_u32(bytes + 4);
        if (size < 8 || length > size - 8)
            return fail(spz, "an extension ends early");
        if (fxs_load_u32(bytes) == COORDINATE_SYSTEM) {
            if (length != 4)
                return fail(spz, "the extension with the coordinate system has not 4 bytes");
            system = fxs_load_u32(bytes + 8);
        }
        bytes += 8 + (size_t)length;
        size -= 8 + (uint64_t)length;
    }
    return set_axes(spz, system);
}

static int read_extensions(fxs_spz *spz, uint64_t offset, uint64_t size)
{
    uint8_t *bytes = fxs_hold(spz->source, size, spz->message);
    int result = bytes ? read_at(spz, offset, bytes, (size_t)size) : FXS_ERR_MEMORY;
    if (result == 0)
        result = parse_extensions(spz, bytes, size);
    fxs_let_go(spz->source, bytes, size);
    return result;
}

static int allocate_payload(fxs_spz *spz, size_t extra)
{
    spz->payload_size = payload_bytes(spz) + extra;
    uint8_t *at = spz->payload = fxs_hold(spz->source, spz->payload_size, spz->message);
    for (int i = 0; i < FXS_SPZ_ARRAYS && at; i++) {
        spz->array[i] = at;
        at += array_bytes(spz, i);
    }
    return at ? 0 : FXS_ERR_MEMORY;
}

static int check_payload(const fxs_spz *spz, uint64_t size)
{
    uint64_t wanted = payload_bytes(spz);
    if (size < wanted || (size > wanted && !(spz->flags & HAS_EXTENSIONS)))
        return fxs_fail(spz->message, "%s: the header asks for %llu bytes of attributes, there are %llu",
                        spz->source->path, (unsigned long long)wanted, (unsigned long long)size);
    return 0;
}

static int load_plain(fxs_spz *spz)
{
    uint64_t wanted = payload_bytes(spz), end = HEADER_SIZE + wanted;
    FXS_TRY(read_extensions(spz, end, spz->size - end));
    FXS_TRY(allocate_payload(spz, 0));
    return read_at(spz, HEADER_SIZE, spz->payload, (size_t)wanted);
}

#ifdef FXS_WITH_ZLIB

typedef struct gzip {
    fxs_spz *spz;
    uint64_t next;
    z_stream stream;
    uint8_t bytes[1 << 16];
} gzip;

static int refill(gzip *g)
{
    const fxs_spz *spz = g->spz;
    uint64_t left = spz->size - g->next;
    size_t size = left < sizeof g->bytes ? (size_t)left : sizeof g->bytes;
    FXS_TRY(fxs_scene_source_progress(spz->source, (double)g->next / (double)spz->size, spz->message));
    FXS_TRY(read_at(spz, g->next, g->bytes, size));
    g->next += size;
    g->stream.next_in = g->bytes;
    g->stream.avail_in = (uInt)size;
    return 0;
}

/* Decompresses up to `size` bytes, in pieces, because zlib counts bytes in 32 bits. *status becomes zlib's last
   status. */
static int inflate_some(gzip *g, int *status, uint8_t *out, size_t size, size_t *got)
{
    const size_t piece = 1u << 30;
    *status = Z_OK;
    *got = 0;
    while (*got < size && *status == Z_OK) {
        size_t room = size - *got;
        if (g->stream.avail_in == 0)
            FXS_TRY(refill(g));
        g->stream.avail_out = (uInt)(room = room < piece ? room : piece);
        g->stream.next_out = out + *got;
        *status = inflate(&g->stream, Z_NO_FLUSH);
        *got += room - g->stream.avail_out;
    }
    return 0;
}

static int fail_inflate(const fxs_spz *spz, int status)
{
    if (status == Z_MEM_ERROR)
        return fxs_fail_memory(spz->message, spz->source->path, 0);
    return fail(spz, status == Z_BUF_ERROR || status == Z_STREAM_END ? "the gzip stream ends early"
                     : "the gzip stream is damaged");
}

static int inflate_start(const fxs_spz *spz, gzip *g, uint8_t header[HEADER_SIZE])
{
    size_t got;
    int status;
    FXS_TRY(inflate_some(g, &status, header, HEADER_SIZE, &got));
    return got < HEADER_SIZE || status == Z_MEM_ERROR ? fail_inflate(spz, status) : 0;
}

static int inflate_header(fxs_spz *spz, gzip *g)
{
    uint8_t header[HEADER_SIZE];
    FXS_TRY(inflate_start(spz, g, header));
    FXS_TRY(parse_header(spz, header));
    if (spz->version == 4)
        return fail(spz, "version 4 within gzip");
    uint64_t wanted = payload_bytes(spz);
    if (wanted / FXS_MAX_EXPANSION > spz->size)
        return fxs_fail(spz->message, "%s: the header asks for %llu bytes of attributes, more than %llu can inflate to",
                        spz->source->path, (unsigned long long)wanted, (unsigned long long)spz->size);
    return 0;
}

static int inflate_payload(fxs_spz *spz, gzip *g)
{
    uint8_t header[HEADER_SIZE];
    size_t extra = (spz->flags & HAS_EXTENSIONS ? MAX_EXTENSIONS : 0) + 1, got;
    uint64_t wanted = payload_bytes(spz);
    FXS_TRY(inflate_start(spz, g, header));
    FXS_TRY(allocate_payload(spz, extra));
    int status;
    FXS_TRY(inflate_some(g, &status, spz->payload, (size_t)wanted + extra, &got));
    if (got == wanted + extra)
        return fail(spz, "the gzip stream has more bytes than the header asks for");
    if (status != Z_STREAM_END)
        return fail_inflate(spz, status);
    FXS_TRY(check_payload(spz, got));
    return parse_extensions(spz, spz->payload + wanted, got - wanted);
}

static int with_gzip(fxs_spz *spz, int (*use)(fxs_spz *, gzip *))
{
    gzip *g = fxs_hold(spz->source, sizeof *g, spz->message);
    if (!g)
        return FXS_ERR_MEMORY;
    memset(g, 0, sizeof *g);
    g->spz = spz;
    fxs_zlib_allocator(&g->stream, spz->source->options.allocator);
    int result = inflateInit2(&g->stream, 16 + MAX_WBITS) == Z_OK ? use(spz, g)
                 : fxs_fail_memory(spz->message, spz->source->path, 0);
    inflateEnd(&g->stream);
    fxs_let_go(spz->source, g, sizeof *g);
    return result;
}

static int open_gzip(fxs_spz *spz)
{
    return with_gzip(spz, inflate_header);
}

static int load_gzip(fxs_spz *spz)
{
    return with_gzip(spz, inflate_payload);
}

#else

static int open_gzip(fxs_spz *spz)
{
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, spz->message, "%s: cannot read gzip: built without zlib",
                       spz->source->path);
}

#define load_gzip open_gzip

#endif

#ifdef FXS_WITH_ZSTD

static uint64_t load_u64(const uint8_t *bytes)
{
    return fxs_load_u32(bytes) | (uint64_t)fxs_load_u32(bytes + 4) << 32;
}

static int parse_contents(fxs_spz *spz, const uint8_t *entry, uint64_t left)
{
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        if (array_bytes(spz, i) == 0)
            continue;
        if (load_u64(entry + 8) != array_bytes(spz, i))
            return fxs_fail(spz->message, "%s: the header asks for %llu bytes in a stream of %llu", spz->source->path,
                            (unsigned long long)array_bytes(spz, i), (unsigned long long)load_u64(entry + 8));
        spz->compressed[i] = load_u64(entry);
        if (spz->compressed[i] > left)
            return fail(spz, "the file ends early");
        left -= spz->compressed[i];
        entry += 16;
    }
    return left ? fail(spz, "there are bytes behind the last stream") : 0;
}

static size_t contents_bytes(const fxs_spz *spz)
{
    size_t bytes = 0;
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++)
        bytes += array_bytes(spz, i) > 0 ? 16 : 0;
    return bytes;
}

static int open_zstd(fxs_spz *spz)
{
    uint8_t header[HEADER_SIZE_4], entries[16 * FXS_SPZ_ARRAYS];
    const size_t bytes = contents_bytes(spz);
    FXS_TRY(read_at(spz, 0, header, sizeof header));
    spz->contents = fxs_load_u32(header + 16);
    if (header[15] != bytes / 16)
        return fxs_fail(spz->message, "%s: %d streams, not %zu", spz->source->path, header[15], bytes / 16);
    if (spz->contents < HEADER_SIZE_4 || spz->contents > spz->size || spz->size - spz->contents < bytes)
        return fail(spz, "the table of contents is not within the file");
    FXS_TRY(read_at(spz, spz->contents, entries, bytes));
    return parse_contents(spz, entries, spz->size - spz->contents - bytes);
}

static int load_stream(fxs_spz *spz, int array, uint64_t offset)
{
    const size_t size = (size_t)array_bytes(spz, array), compressed = (size_t)spz->compressed[array];
    uint8_t *stream = fxs_hold(spz->source, compressed, spz->message);
    int result = stream ? read_at(spz, offset, stream, compressed) : FXS_ERR_MEMORY;
    errno = 0;
    if (result == 0 && ZSTD_decompress(spz->array[array], size, stream, compressed) != size)
        result = fxs_fail_library(spz->message, spz->source->path,
                                  "%s: a zstd stream is damaged, or of another size than the header asks for",
                                  spz->source->path);
    fxs_let_go(spz->source, stream, compressed);
    return result;
}

static int load_zstd(fxs_spz *spz)
{
    uint64_t extensions = spz->flags & HAS_EXTENSIONS ? spz->contents - HEADER_SIZE_4 : 0;
    uint64_t offset = spz->contents + contents_bytes(spz);
    FXS_TRY(read_extensions(spz, HEADER_SIZE_4, extensions));
    FXS_TRY(allocate_payload(spz, 0));
    for (int i = 0; i < FXS_SPZ_ARRAYS; i++) {
        FXS_TRY(fxs_scene_source_progress(spz->source, (double)offset / (double)spz->size, spz->message));
        if (array_bytes(spz, i) > 0)
            FXS_TRY(load_stream(spz, i, offset));
        offset += spz->compressed[i];
    }
    return 0;
}

#else

static int open_zstd(fxs_spz *spz)
{
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, spz->message, "%s: cannot read .spz version 4: built without zstd",
                       spz->source->path);
}

#define load_zstd open_zstd

#endif

static int open_header(fxs_spz *spz)
{
    uint8_t header[HEADER_SIZE];
    FXS_TRY(read_at(spz, 0, header, 2));
    spz->is_gzip = header[0] == 0x1f && header[1] == 0x8b;
    if (spz->is_gzip)
        return open_gzip(spz);
    FXS_TRY(read_at(spz, 0, header, sizeof header));
    FXS_TRY(parse_header(spz, header));
    return spz->version == 4 ? open_zstd(spz) : check_payload(spz, spz->size - HEADER_SIZE);
}

static int load(fxs_spz *spz)
{
    int result = spz->is_gzip ? load_gzip(spz) : spz->version == 4 ? load_zstd(spz) : load_plain(spz);
    if (result)
        fxs_spz_drop(spz);
    return result;
}

int fxs_spz_drop(fxs_spz *spz)
{
    int had = spz->payload != NULL;
    fxs_let_go(spz->source, spz->payload, spz->payload_size);
    spz->payload = NULL;
    return had;
}

int fxs_spz_open(const fxs_scene_source *source, uint64_t offset, uint64_t size, enum fxs_axes axes, fxs_spz **spz,
                 fxs_scene_file_info *info, fxs_message *message)
{
    fxs_spz *s = *spz = fxs_allocate_zeroed(source->options.allocator, 1, sizeof *s);
    if (!s)
        return fxs_fail_memory(message, source->path, sizeof *s);
    s->source = source;
    s->offset = offset;
    s->size = size;
    s->message = message;
    s->axes = axes;
    int error = open_header(s);
    if (!error)
        error = fxs_limit_gaussians(source, s->count, message);
    if (error) {
        fxs_spz_close(s);
        *spz = NULL;
        return error;
    }
    info->count = s->count;
    info->sh_degree = s->sh_degree < 3 ? s->sh_degree : 3;
    info->stored_sh_degree = s->sh_degree;
    info->antialiased = s->flags & ANTIALIASED;
    info->colour.step = FXS_SH_0 / COLOUR_RANGE / 255;
    info->colour.low = 0.5 - FXS_SH_0 / COLOUR_RANGE / 2;
    info->sh.step = 1 / 128.0;
    return 0;
}

void fxs_spz_close(fxs_spz *spz)
{
    if (!spz)
        return;
    fxs_spz_drop(spz);
    fxs_release(spz->source->options.allocator, spz);
}

static float position(const fxs_spz *spz, const uint8_t *bytes)
{
    if (spz->version == 1)
        return fxs_half(fxs_load_u16(bytes));
    int32_t value = bytes[0] | bytes[1] << 8 | bytes[2] << 16;
    return ldexpf((float)(value - (value >> 23 << 24)), -spz->fractional_bits);
}

/* Decodes a quaternion from x, y, z of 8 bits each, with w = sqrt(1 - x^2 - y^2 - z^2). Uses doubles, because the
   difference may be small. */
static void decode_first_three(double q[4], const uint8_t *bytes)
{
    double rest = 1;
    for (int i = 0; i < 3; i++) {
        q[i] = bytes[i] / 127.5 - 1;
        rest -= q[i] * q[i];
    }
    q[3] = sqrt(fmax(rest, 0));
}

/* Decodes a quaternion x, y, z, w from its three smallest components. Bits 31 and 30 are the index of the largest
   component, which is not stored. Other components have a sign and 9 bits each. */
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
        g->dc[i] = ((float)at[FXS_SPZ_COLOUR][i] / 255 - 0.5f) / (float)COLOUR_RANGE;
    }
    g->opacity = fxs_logit_of_code(at[FXS_SPZ_ALPHA][0]);
    for (int i = 0; i < spz->stride[FXS_SPZ_SH] && i < 45; i++)
        g->sh[i] = spz->flip_sh[i / 3] * (float)(at[FXS_SPZ_SH][i] - 128) / 128;
}

long fxs_spz_read(fxs_spz *spz, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    size_t left = spz->count - spz->next, count = capacity < left ? capacity : left;
    spz->message = message;
    if (!spz->payload)
        FXS_TRY(load(spz));
    for (size_t i = 0; i < count; i++)
        decode(spz, spz->next++, &gaussians[i]);
    return (long)count;
}

void fxs_spz_rewind(fxs_spz *spz)
{
    spz->next = 0;
}

typedef struct spz_reader {
    fxs_spz *spz;
} spz_reader;

static int spz_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    return fxs_spz_open(source, 0, source->input.size, source->options.axes, &((spz_reader *)handle)->spz, info,
                        message);
}

static long spz_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    return fxs_spz_read(((spz_reader *)handle)->spz, gaussians, capacity, message);
}

static int spz_rewind(void *handle, fxs_message *message)
{
    (void)message;
    fxs_spz_rewind(((spz_reader *)handle)->spz);
    return 0;
}

static void spz_close(void *handle)
{
    fxs_spz_close(((spz_reader *)handle)->spz);
}

static int is_spz(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, "NGSP", 4) || !memcmp(head->bytes, "\x1f\x8b", 2);
}

const fxs_reader fxs_read_spz = {is_spz, sizeof(spz_reader), spz_open, spz_read, spz_rewind, spz_close, NULL};
