/* Reads .4dgs, version 1, with the temporal model gaussian-birth (avala-ai/4dgs at 30f5d0f, website/docs/spec):
   records of an opcode, a length and a content. A chunk has a stream of integers for each attribute of its
   Gaussians. */
#include <stdio.h>

#include "src/base/byte_reader.h"
#include "src/base/inflate_internal.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

#if defined(FXS_WITH_ZSTD)
#include <zstd.h>
#endif

#define MAGIC "\x89" "4DGS1\r\n"
#define MODEL "gaussian-birth"
#define SCHEME "uniform-v1"
#define SQRT_2 1.4142135623730951

enum { MAGIC_SIZE = 8, RECORD_HEAD = 9, STREAM_HEAD = 17, CHUNK_HEAD = 24, BATCH = 512 };
enum { HEADER = 1, FOOTER = 2, QUANTISATION = 3, WINDOWS = 4, CHUNK = 5, SH_BAND = 7, AUDIO = 9, AUDIO_SOURCE = 0x11,
       AUDIO_DATA = 0x12, OBJECT_TRACK = 0x25 };
enum { RAW, DELTA, CONSTANT };
enum { DEFLATE, ZSTD };
enum { POSITION, SCALE, OMITTED, ROTATION, COLOUR, OPACITY, VELOCITY, CENTRE, SIGMA, FLAGS, WINDOW, ATTRIBUTES,
       ROW = 21 };

static const struct { int at, count; } columns[ATTRIBUTES] = {
    {0, 3}, {3, 3}, {6, 1}, {7, 3}, {10, 3}, {13, 1}, {14, 3}, {17, 1}, {18, 1}, {19, 1}, {20, 1}
};

/* Steps of a file, in its order. */
enum { STEP_POSITION, STEP_SCALE, STEP_ROTATION, STEP_COLOUR, STEP_OPACITY, STEP_VELOCITY, STEP_TIME, STEP_SIGMA,
       STEPS };

typedef struct fourdgs_reader {
    const fxs_scene_source *source;
    double duration, cutoff, origin[3], steps[STEPS];
    uint64_t declared;            /* number of Gaussians, says the header */
    int sh_degree, seen;          /* bit i of seen: a record of opcode i was read */
    double (*windows)[2];         /* seconds; a Gaussian exists from the first until before the second */
    uint32_t window_count;
    uint64_t first, next;         /* offsets of the first chunk, and of the next record */
    int32_t *numbers;             /* of the chunk: for each attribute, the numbers of all Gaussians */
    uint8_t *sh;                  /* 45 of each Gaussian of the chunk, by degree as in fxs_gaussian */
    size_t count, at;             /* number of Gaussians in the chunk, and the next one */
    fxs_motion motions[BATCH];
} fourdgs_reader;

typedef struct record {
    int opcode;
    uint64_t content, size;
} record;

/* The rest of a content; `broken` is 1 after a read beyond its end. */
typedef struct cursor {
    const uint8_t *bytes;
    uint64_t left;
    int broken;
} cursor;

static int is_fourdgs(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->size >= MAGIC_SIZE && !memcmp(head->bytes, MAGIC, 5);
}

static int fail(const fourdgs_reader *r, const char *fault, fxs_message *message)
{
    return fxs_fail(message, "%s: %s", r->source->path, fault);
}

/* ---- Records ----------------------------------------------------------------------------------------------------- */

static const uint8_t *take(cursor *c, uint64_t size)
{
    static const uint8_t zeros[16];
    if (size > c->left) {
        c->broken = 1;
        c->left = 0;
        return zeros;
    }
    c->bytes += size;
    c->left -= size;
    return c->bytes - size;
}

static uint32_t take_u32(cursor *c)
{
    return fxs_load_u32(take(c, 4));
}

static uint64_t take_u64(cursor *c)
{
    const uint64_t low = take_u32(c);
    return low | (uint64_t)take_u32(c) << 32;
}

static double take_double(cursor *c)
{
    const uint64_t bits = take_u64(c);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Copies a text, cut to the room. */
static void take_text(cursor *c, char *text, size_t room)
{
    const uint32_t length = take_u32(c), kept = length < room - 1 ? length : (uint32_t)room - 1;
    const uint8_t *from = take(c, length);
    snprintf(text, room, "%.*s", c->broken ? 0 : (int)kept, (const char *)from);
}

/* Reads the head of the next record. Returns 1, 0 at the footer or the end, or an error and a message. */
static int next_record(fourdgs_reader *r, record *out, fxs_message *message)
{
    const uint64_t size = r->source->input.size;
    uint8_t head[RECORD_HEAD];
    if (r->next == size)
        return 0;
    if (size - r->next < RECORD_HEAD)
        return fail(r, "the file ends early", message);
    FXS_TRY(fxs_scene_source_read(r->source, r->next, head, RECORD_HEAD, message));
    const uint64_t length = fxs_load_u32(head + 1) | (uint64_t)fxs_load_u32(head + 5) << 32;
    *out = (record){head[0], r->next + RECORD_HEAD, length};
    if (length > size - out->content)
        return fail(r, "a record ends after the file", message);
    r->next = out->opcode == FOOTER ? size : out->content + length;
    return out->opcode != FOOTER;
}

static int load(const fourdgs_reader *r, const record *of, fxs_text *text, cursor *c, fxs_message *message)
{
    FXS_TRY(fxs_scene_source_load(r->source, of->content, of->size, text, message));
    *c = (cursor){(const uint8_t *)text->data, of->size, 0};
    return 0;
}

static int read_header(fourdgs_reader *r, cursor *c, fxs_message *message)
{
    char text[64], model[41];
    take_text(c, text, sizeof text);
    take_text(c, text, sizeof text);
    r->duration = take_double(c);
    r->declared = take_u64(c);
    r->cutoff = take_double(c);
    take_text(c, model, sizeof model);
    take(c, 48);
    r->sh_degree = *take(c, 1);
    if (c->broken)
        return fail(r, "the header ends early", message);
    if (strcmp(model, MODEL))
        return fxs_fail(message, "%s: .4dgs of the temporal model \"%s\", which is not read: " MODEL " is",
                        r->source->path, model);
    if (!(r->duration > 0 && r->duration <= 1e6) || !(r->cutoff > 0 && r->cutoff <= 1) || r->sh_degree > 3)
        return fail(r, "no valid duration, cut-off and SH degree in the header", message);
    return 0;
}

static int read_steps(fourdgs_reader *r, cursor *c, fxs_message *message)
{
    char scheme[41];
    int ok = 1;
    take_text(c, scheme, sizeof scheme);
    for (int i = 0; i < 3; i++) {
        r->origin[i] = take_double(c);
        ok &= fabs(r->origin[i]) <= 1e18;
    }
    for (int i = 0; i < STEPS; i++) {
        r->steps[i] = take_double(c);
        ok &= r->steps[i] > 0 && r->steps[i] <= 1e18;
    }
    if (!c->broken && strcmp(scheme, SCHEME))
        return fxs_fail(message, "%s: .4dgs of the quantisation \"%s\", which is not read: " SCHEME " is",
                        r->source->path, scheme);
    return ok && !c->broken ? 0 : fail(r, "no valid steps in the record of the quantisation", message);
}

static int read_windows(fourdgs_reader *r, cursor *c, fxs_message *message)
{
    const uint32_t count = take_u32(c);
    if (count > c->left / 16)
        return fail(r, "the table of windows ends early", message);
    r->windows = fxs_hold(r->source, 16 * ((uint64_t)count + 1), message);
    if (!r->windows)
        return FXS_ERR_MEMORY;
    r->window_count = count;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            r->windows[i][k] = take_double(c);
    return 0;
}

static int read_front(fourdgs_reader *r, const record *of, fxs_message *message)
{
    fxs_text text;
    cursor c;
    if (r->seen >> of->opcode & 1)
        return fxs_fail(message, "%s: two records of opcode %d", r->source->path, of->opcode);
    r->seen |= 1 << of->opcode;
    FXS_TRY(load(r, of, &text, &c, message));
    const int error = of->opcode == HEADER ? read_header(r, &c, message)
                      : of->opcode == QUANTISATION ? read_steps(r, &c, message) : read_windows(r, &c, message);
    fxs_text_let_go(r->source, &text);
    return error;
}

static int count_chunk(fourdgs_reader *r, const record *of, uint64_t *count, fxs_message *message)
{
    uint8_t head[CHUNK_HEAD];
    if (of->size < CHUNK_HEAD)
        return fail(r, "a chunk ends early", message);
    if (!(r->seen >> HEADER & 1) || !(r->seen >> QUANTISATION & 1))
        return fail(r, "a chunk before the header and the quantisation", message);
    FXS_TRY(fxs_scene_source_read(r->source, of->content, head, CHUNK_HEAD, message));
    r->first = r->first ? r->first : of->content - RECORD_HEAD;
    *count += fxs_load_u32(head + 20);
    return fxs_limit_gaussians(r->source, *count, message);
}

static int read_records(fourdgs_reader *r, uint64_t *count, fxs_message *message)
{
    record of;
    int more;
    r->next = MAGIC_SIZE;
    while ((more = next_record(r, &of, message)) > 0) {
        if (of.opcode == HEADER || of.opcode == QUANTISATION || of.opcode == WINDOWS)
            FXS_TRY(read_front(r, &of, message));
        else if (of.opcode == CHUNK)
            FXS_TRY(count_chunk(r, &of, count, message));
        else if (of.opcode == OBJECT_TRACK)
            return fail(r, "objects that move on tracks, which are not read", message);
    }
    FXS_TRY(more);
    if (!(r->seen >> HEADER & 1))
        return fail(r, "no header", message);
    if (*count != r->declared)
        return fxs_fail(message, "%s: the header tells of %llu Gaussians, the chunks have %llu", r->source->path,
                        (unsigned long long)r->declared, (unsigned long long)*count);
    return 0;
}

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

/* Unpacks to exactly `size` bytes. A zlib stream has two bytes before the deflated ones, and a checksum of four. */
static int unpack(const fourdgs_reader *r, int codec, const uint8_t *packed, uint64_t packed_size, uint8_t *out,
                  size_t size, fxs_message *message)
{
    if (packed_size < 6)
        return fail(r, "a stream ends early", message);
    if (codec == DEFLATE)
        return fxs_inflate(r->source, packed + 2, (size_t)packed_size - 6, out, size, message);
#ifdef FXS_WITH_ZSTD
    if (codec == ZSTD)
        return ZSTD_decompress(out, size, packed, (size_t)packed_size) == size
                   ? 0 : fail(r, "a zstd stream is damaged, or of another size than its header asks for", message);
#endif
    return fxs_fail(message, "%s: streams of the codec %d are not read", r->source->path, codec);
}

static int32_t number_at(const uint8_t *planes, size_t count, int width, size_t i)
{
    uint32_t number = 0;
    for (int k = 0; k < width; k++)
        number |= (uint32_t)planes[(size_t)k * count + i] << 8 * k;
    return (int32_t)(number >> 1 ^ (0 - (number & 1)));
}

/* Reads a stream with `channels` numbers of each Gaussian to `out`, or passes over it if `out` is null. */
static int read_stream(const fourdgs_reader *r, cursor *c, int32_t *out, size_t channels, fxs_message *message)
{
    const uint8_t *head = take(c, STREAM_HEAD);
    if (c->broken)
        return fail(r, "a stream ends early", message);
    const int width = head[1], mode = head[2], codec = head[3];
    const size_t given = head[4], count = mode == CONSTANT ? channels : r->count * channels;
    const uint32_t elements = fxs_load_u32(head + 5);
    const uint64_t packed_size = fxs_load_u32(head + 9) | (uint64_t)fxs_load_u32(head + 13) << 32;
    const uint8_t *packed = take(c, packed_size);
    if (c->broken)
        return fail(r, "a stream ends after its chunk", message);
    if (!out)
        return 0;
    if (given != channels || elements != r->count || mode > CONSTANT || (width != 1 && width != 2 && width != 4))
        return fxs_fail(message, "%s: a stream of %u times %zu numbers of %d bytes, mode %d, in a chunk of %zu "
                        "Gaussians", r->source->path, elements, given, width, mode, r->count);
    uint8_t *planes = fxs_hold(r->source, (uint64_t)count * (uint64_t)width, message);
    if (!planes)
        return FXS_ERR_MEMORY;
    const int error = unpack(r, codec, packed, packed_size, planes, count * (size_t)width, message);
    for (size_t i = 0; i < r->count * channels && !error; i++) {
        const uint32_t number = (uint32_t)number_at(planes, count, width, mode == CONSTANT ? i % channels : i);
        out[i] = (int32_t)(mode == DELTA && i >= channels ? number + (uint32_t)out[i - channels] : number);
    }
    fxs_let_go(r->source, planes, (uint64_t)count * (uint64_t)width);
    return error;
}

static int read_streams(const fourdgs_reader *r, cursor c, fxs_message *message)
{
    unsigned seen = 0;
    while (c.left > 0) {
        const int attribute = *c.bytes;
        int32_t *out = attribute < ATTRIBUTES ? r->numbers + (size_t)columns[attribute].at * r->count : NULL;
        if (out && (seen >> attribute & 1))
            return fxs_fail(message, "%s: a chunk with two streams of attribute %d", r->source->path, attribute);
        seen |= out ? 1u << attribute : 0;
        FXS_TRY(read_stream(r, &c, out, out ? (size_t)columns[attribute].count : 0, message));
    }
    return seen == (1u << ATTRIBUTES) - 1 ? 0 : fail(r, "a chunk lacks a stream of an attribute", message);
}

static int read_packed_streams(const fourdgs_reader *r, const cursor *c, const char *codec, uint64_t size,
                               fxs_message *message)
{
    const int number = !strcmp(codec, "deflate") ? DEFLATE : !strcmp(codec, "zstd") ? ZSTD : -1;
    if (number < 0)
        return fxs_fail(message, "%s: a chunk compressed by \"%s\", which is not read", r->source->path, codec);
    if (size / FXS_MAX_EXPANSION > c->left)
        return fail(r, "a chunk unpacks to far more bytes than it has", message);
    uint8_t *bytes = fxs_hold(r->source, size + 1, message);
    if (!bytes)
        return FXS_ERR_MEMORY;
    int error = unpack(r, number, c->bytes, c->left, bytes, (size_t)size, message);
    if (!error)
        error = read_streams(r, (cursor){bytes, size, 0}, message);
    fxs_let_go(r->source, bytes, size + 1);
    return error;
}

/* ---- Chunks ------------------------------------------------------------------------------------------------------ */

static void drop_chunk(fourdgs_reader *r)
{
    fxs_let_go(r->source, r->numbers, (uint64_t)r->count * ROW * sizeof *r->numbers);
    fxs_let_go(r->source, r->sh, (uint64_t)r->count * 45);
    r->numbers = NULL;
    r->sh = NULL;
    r->count = r->at = 0;
}

static int hold_chunk(fourdgs_reader *r, size_t count, fxs_message *message)
{
    drop_chunk(r);
    r->count = count;
    r->numbers = fxs_hold(r->source, (uint64_t)count * ROW * sizeof *r->numbers, message);
    if (!r->numbers)
        return FXS_ERR_MEMORY;
    r->sh = r->sh_degree ? fxs_hold(r->source, (uint64_t)count * 45, message) : NULL;
    return r->sh || !r->sh_degree ? 0 : FXS_ERR_MEMORY;
}

static int check_windows(const fourdgs_reader *r, fxs_message *message)
{
    const int32_t *window = r->numbers + (size_t)columns[WINDOW].at * r->count;
    for (size_t i = 0; i < r->count; i++)
        if (window[i] < 0 || ((uint32_t)window[i] >= r->window_count && window[i] > 0))
            return fxs_fail(message, "%s: a Gaussian in window %d of %u", r->source->path, (int)window[i],
                            r->window_count);
    return 0;
}

static int read_chunk(fourdgs_reader *r, const record *of, fxs_message *message)
{
    char codec[16];
    fxs_text text;
    cursor c;
    FXS_TRY(load(r, of, &text, &c, message));
    take(&c, 20);
    int error = 0;
    const uint32_t count = take_u32(&c);
    take_text(&c, codec, sizeof codec);
    const uint64_t size = take_u64(&c), left = take_u64(&c);
    if (c.broken || left > c.left || (!*codec && size != left))
        error = fail(r, "a chunk ends early, or has no valid sizes", message);
    c.left = left;
    error = error || !count ? error : hold_chunk(r, count, message);
    if (!error && count)
        error = *codec ? read_packed_streams(r, &c, codec, size, message) : read_streams(r, c, message);
    fxs_text_let_go(r->source, &text);
    return error || !count ? error : check_windows(r, message);
}

/* Reads the SH of a band of the chunk: all coefficients of red, then of green, then of blue. */
static int read_band(fourdgs_reader *r, const record *of, unsigned *bands, fxs_message *message)
{
    fxs_text text;
    cursor c;
    FXS_TRY(load(r, of, &text, &c, message));
    const int band = *take(&c, 1), n = 2 * band + 1, first = band * band - 1;
    int error = band >= 1 && band <= r->sh_degree && !(*bands >> band & 1)
                    ? 0 : fxs_fail(message, "%s: SH band %d of degree %d, or two of it", r->source->path, band,
                                   r->sh_degree);
    const uint64_t bytes = error ? 0 : (uint64_t)r->count * (uint64_t)(3 * n) * sizeof(int32_t);
    int32_t *numbers = error ? NULL : fxs_hold(r->source, bytes, message);
    error = error || numbers ? error : FXS_ERR_MEMORY;
    error = error ? error : read_stream(r, &c, numbers, (size_t)(3 * n), message);
    for (size_t i = 0; i < r->count && !error; i++)
        for (int k = 0; k < 3 * n && !error; k++) {
            const int32_t number = numbers[i * (size_t)(3 * n) + (size_t)k];
            r->sh[45 * i + (size_t)(3 * (first + k % n) + k / n)] = (uint8_t)number;
            error = number >= 0 && number <= 255 ? 0 : fail(r, "an SH coefficient beyond 0 to 255", message);
        }
    *bands |= 1u << (band & 7);
    fxs_let_go(r->source, numbers, bytes);
    fxs_text_let_go(r->source, &text);
    return error;
}

/* Reads the next chunk that has Gaussians, and the bands behind it. Returns 1, 0 at the end, or an error and a
   message. */
static int next_chunk(fourdgs_reader *r, fxs_message *message)
{
    record of;
    unsigned bands = 1;
    int more;
    drop_chunk(r);
    FXS_TRY(fxs_scene_source_progress(r->source, (double)r->next / (double)r->source->input.size, message));
    while (!r->count && (more = next_record(r, &of, message)) != 0) {
        FXS_TRY(more);
        if (of.opcode == CHUNK)
            FXS_TRY(read_chunk(r, &of, message));
    }
    while (r->count && bands != (2u << r->sh_degree) - 1) {
        more = next_record(r, &of, message);
        FXS_TRY(more);
        if (!more || of.opcode == CHUNK)
            return fail(r, "a chunk lacks SH of a band", message);
        if (of.opcode == SH_BAND)
            FXS_TRY(read_band(r, &of, &bands, message));
    }
    return r->count > 0;
}

static int32_t number_of(const fourdgs_reader *r, int attribute, int k)
{
    return r->numbers[(size_t)columns[attribute].at * r->count + r->at * (size_t)columns[attribute].count + (size_t)k];
}

/* Returns the smallest power of two from 2^low to 2^high that is x or more, or 2^high. */
static double power_above(double x, int low, int high)
{
    while (low < high && ldexp(1, low) < x)
        low++;
    return ldexp(1, low);
}

/* Velocities have finer steps the longer a Gaussian is seen; centres, the smaller their sigma is. */
static void decode_motion(const fourdgs_reader *r, fxs_motion *m)
{
    const int window = number_of(r, WINDOW, 0), is_constant = number_of(r, FLAGS, 0) != 0;
    const double *span = r->window_count ? r->windows[window] : (const double[2]){0, 0};
    const double sigma = fxs_exp(number_of(r, SIGMA, 0) * r->steps[STEP_SIGMA]);
    double half = is_constant ? span[1] - span[0] : sqrt(-2 * fxs_log(r->cutoff)) * sigma;
    half = half > 0.02 ? half < 2 ? half : 2 : 0.02;
    const double finer = power_above(half / 0.5, -4, 2), step = r->steps[STEP_TIME];
    const double parts = is_constant ? 1 : power_above(step / (0.05 * sigma), 0, 10);
    memset(m, 0, sizeof *m);
    for (int i = 0; i < 3; i++)
        m->drift[0][i] = (float)(number_of(r, VELOCITY, i) * r->steps[STEP_VELOCITY] / finer);
    m->centre = (float)(number_of(r, CENTRE, 0) * step / parts);
    m->fade = is_constant ? INFINITY : (float)(SQRT_2 * sigma);
    m->from = (float)span[0];
    m->to = (float)span[1];
}

/* The stored order of a quaternion is x, y, z, w. */
static void decode_rotation(const fourdgs_reader *r, fxs_gaussian *g)
{
    const int omitted = number_of(r, OMITTED, 0) & 3;
    double rest = 1;
    for (int i = 0, k = 0; i < 4; i++) {
        if (i == omitted)
            continue;
        const double q = fmin(fmax(number_of(r, ROTATION, k++) * r->steps[STEP_ROTATION], -1), 1);
        g->rotation[(i + 1) % 4] = (float)q;
        rest -= q * q;
    }
    g->rotation[(omitted + 1) % 4] = (float)sqrt(fmax(rest, 0));
}

static void decode(const fourdgs_reader *r, fxs_gaussian *g)
{
    const double green = number_of(r, COLOUR, 0);
    const double colour[3] = {green + number_of(r, COLOUR, 1), green, green + number_of(r, COLOUR, 2)};
    memset(g, 0, sizeof *g);
    for (int i = 0; i < 3; i++) {
        g->position[i] = (float)(r->origin[i] + number_of(r, POSITION, i) * r->steps[STEP_POSITION]);
        g->scale[i] = (float)(number_of(r, SCALE, i) * r->steps[STEP_SCALE]);
        g->dc[i] = fxs_dc_of_colour(fmin(fmax(colour[i] * r->steps[STEP_COLOUR], 0), 1));
    }
    g->opacity = fxs_logit_of_opacity(number_of(r, OPACITY, 0) * r->steps[STEP_OPACITY]);
    decode_rotation(r, g);
    for (int i = 0; i < 3 * r->sh_degree * (r->sh_degree + 2); i++)
        g->sh[i] = (float)(r->sh[45 * r->at + (size_t)i] * (8 / 255.0) - 4);
}

/* ---- Sound ------------------------------------------------------------------------------------------------------- */

#ifdef FXS_TO_PACK
#define SOUND NULL
#else
#define SOUND fourdgs_sound

/* The sounds of a file; all but `count` are of the last one. */
typedef struct sounds {
    int count;
    char name[48];              /* "sound." and the codec */
    double start, gain;
    uint64_t at, size;          /* of the bytes, in the file */
} sounds;

/* Reads a record of a sound. AUDIO has the bytes after its facts, the others have them apart. */
static int read_sound(const fourdgs_reader *r, const record *of, sounds *s, fxs_message *message)
{
    char unused[8], codec[40];
    fxs_text text;
    cursor c;
    FXS_TRY(load(r, of, &text, &c, message));
    if (of->opcode != AUDIO)
        take(&c, 4);
    if (of->opcode != AUDIO_DATA) {
        if (of->opcode == AUDIO_SOURCE)
            take_text(&c, unused, sizeof unused);
        take_text(&c, codec, sizeof codec);
        snprintf(s->name, sizeof s->name, "sound.%s", codec);
        if (of->opcode == AUDIO_SOURCE) {
            take_text(&c, unused, sizeof unused);
            take_u64(&c);
        }
        s->start = take_double(&c);
        s->count++;
    }
    if (of->opcode == AUDIO_SOURCE) {
        take_double(&c);
        s->gain = take_double(&c);
    } else {
        s->size = take_u64(&c);
        s->at = of->content + of->size - c.left;
        c.broken |= s->size > c.left;
    }
    fxs_text_let_go(r->source, &text);
    return c.broken ? fail(r, "the record of a sound ends early", message) : 0;
}

static int find_sounds(fourdgs_reader *r, sounds *s, fxs_message *message)
{
    record of;
    int more;
    r->next = MAGIC_SIZE;
    while ((more = next_record(r, &of, message)) > 0)
        if (of.opcode == AUDIO || of.opcode == AUDIO_SOURCE || of.opcode == AUDIO_DATA)
            FXS_TRY(read_sound(r, &of, s, message));
    return more;
}

static int fourdgs_sound(void *handle, fxs_sound *sound, fxs_text *data, fxs_message *message)
{
    fourdgs_reader *r = handle;
    sounds s = {.gain = 1};
    const uint64_t next = r->next;
    const int error = find_sounds(r, &s, message);
    r->next = next;
    if (error || s.count == 0)
        return error;
    if (s.count > 1 || s.start != 0 || !(s.gain >= 0))
        return fail(r, "several sounds, or one that begins later than the scene, which are not read", message);
    sound->volume = s.gain < 1 ? s.gain : 1;
    if (!fxs_sound_kind(sound, s.name, NULL))
        return fail(r, "a sound of a codec that is not known", message);
    FXS_TRY(fxs_scene_source_load(r->source, s.at, s.size, data, message));
    return 1;
}

#endif

/* ---- Reader ------------------------------------------------------------------------------------------------------ */

static int fourdgs_rewind(void *handle, fxs_message *message)
{
    fourdgs_reader *r = handle;
    (void)message;
    drop_chunk(r);
    r->next = r->first ? r->first : r->source->input.size;
    return 0;
}

static int fourdgs_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    fourdgs_reader *r = handle;
    uint8_t magic[MAGIC_SIZE];
    r->source = source;
    FXS_TRY(fxs_scene_source_read(source, 0, magic, MAGIC_SIZE, message));
    if (memcmp(magic, MAGIC, MAGIC_SIZE))
        return fail(r, ".4dgs of a version that is not known: not 1", message);
    info->count = 0;
    FXS_TRY(read_records(r, &info->count, message));
    info->sh_degree = r->sh_degree;
    info->antialiased = 0;
    info->sh.step = 8 / 255.0;
    info->sh.low = -4;
    source->import->reader = r;
    source->import->sound = SOUND;
    info->time = (fxs_time){.duration = r->duration, .loops = 1, .degree = 1, .fades = 1, .least = r->cutoff};
    return fourdgs_rewind(r, message);
}

static long fourdgs_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    fourdgs_reader *r = handle;
    size_t count = 0;
    capacity = capacity < BATCH ? capacity : BATCH;
    while (count < capacity) {
        const int more = r->at < r->count ? 1 : next_chunk(r, message);
        FXS_TRY(more);
        if (!more)
            break;
        for (; r->at < r->count && count < capacity; r->at++, count++) {
            decode(r, &gaussians[count]);
            decode_motion(r, &r->motions[count]);
        }
    }
    return (long)count;
}

static void fourdgs_close(void *handle)
{
    fourdgs_reader *r = handle;
    drop_chunk(r);
    fxs_let_go(r->source, r->windows, 16 * ((uint64_t)r->window_count + 1));
}

static const fxs_motion *fourdgs_motions(const void *handle)
{
    return ((const fourdgs_reader *)handle)->motions;
}

const fxs_reader fxs_read_fourdgs = {
    is_fourdgs, sizeof(fourdgs_reader), fourdgs_open, fourdgs_read, fourdgs_rewind, fourdgs_close, fourdgs_motions
};
