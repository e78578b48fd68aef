/* Writes .rad of Spark: the nodes of a level-of-detail tree in chunks of 65,536. A chunk has a JSON header and a
   deflated column for each attribute. Layout: rust/spark-lib/src/rad.rs of sparkjsdev/spark. Encodings are the
   finest that Spark keeps. */
#include "scene_write_internal.h"
#include "src/base/report.h"

#ifdef FXS_WITH_ZLIB

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ZLIB_CONST
#include <zlib.h>

#include "src/base/exponential.h"
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/gaussian/attributes.h"
#include "rad_tree_internal.h"
#include "src/scene/read/rad_internal.h"

enum {
    CHUNK = 65536,
    SAMPLES = 65536,
    PRECISION = 9
};

static const struct { int property, encoding; } columns[] = {
    {FXS_RAD_CENTER, FXS_RAD_F32_LEBYTES}, {FXS_RAD_ALPHA, FXS_RAD_F16}, {FXS_RAD_RGB, FXS_RAD_F16},
    {FXS_RAD_SCALES, FXS_RAD_LN_F16}, {FXS_RAD_ORIENTATION, FXS_RAD_F32}, {FXS_RAD_CHILD_COUNT, FXS_RAD_U16},
    {FXS_RAD_CHILD_START, FXS_RAD_U32}, {FXS_RAD_SH1, FXS_RAD_S8}, {FXS_RAD_SH2, FXS_RAD_S8}, {FXS_RAD_SH3, FXS_RAD_S8}
};

enum { COLUMNS = sizeof columns / sizeof *columns };

typedef struct bytes {
    uint8_t *data;
    size_t size, room;
} bytes;

typedef struct rad_writer {
    fxs_held held;
    int sh_degree;
    fxs_rad_tree tree;
    /* ranges of Spark's 8-bit codes for colour, ln(sigma), and SH of each degree (from -sh to sh) */
    float rgb[2], scale[2], sh[3];
    bytes file;
    size_t *ends;
    const fxs_progress *progress;
} rad_writer;

static int rad_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    rad_writer *w = writer;
    w->sh_degree = o->sh_degree;
    return fxs_held_open(&w->held, path, o, message);
}

static int rad_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_held_put(&((rad_writer *)writer)->held, gaussians, n, message);
}

static int no_memory(rad_writer *w)
{
    w->held.output.error = ENOMEM;
    return 0;
}

static int advance(rad_writer *w, double done)
{
    if (fxs_report(w->progress, done))
        w->held.output.error = ECANCELED;
    return !w->held.output.error;
}

static uint8_t *grow(rad_writer *w, bytes *b, size_t size)
{
    if (size > b->room - b->size) {
        const size_t room = 2 * b->room + size;
        uint8_t *data = realloc(b->data, room);
        if (!data) {
            no_memory(w);
            return NULL;
        }
        b->data = data;
        b->room = room;
    }
    return b->data + b->size;
}

static int add(rad_writer *w, bytes *b, const void *data, size_t size)
{
    uint8_t *to = grow(w, b, size);
    if (to) {
        memcpy(to, data, size);
        b->size += size;
    }
    return to != NULL;
}

static int pad(rad_writer *w, bytes *b)
{
    static const uint8_t zeros[8];
    return add(w, b, zeros, (8 - b->size % 8) % 8);
}

/* Codes an opacity. Opacities of tree nodes may be above 1; their codes are from 1 to 2. */
static double code_of_opacity(double opacity)
{
    return opacity > 1 ? fmin(1 + (fxs_rad_dilation(opacity) - 1) / 4, 2) : opacity;
}

static double value_of(const rad_writer *w, int property, uint32_t place, int d)
{
    const uint32_t i = w->tree.order[place];
    const fxs_held_gaussian *g = &w->held.gaussians[i];
    switch (property) {
    case FXS_RAD_CENTER:
        return (double)g->position[d];
    case FXS_RAD_ALPHA:
        return code_of_opacity((double)g->opacity);
    case FXS_RAD_RGB:
        return fxs_colour_of_dc((double)g->dc[d]);
    case FXS_RAD_SCALES:
        return (double)g->scale[d];
    case FXS_RAD_ORIENTATION:
        return (double)(g->rotation[0] < 0 ? -g->rotation[1 + d] : g->rotation[1 + d]);
    case FXS_RAD_CHILD_COUNT:
        return w->tree.child_counts[place];
    case FXS_RAD_CHILD_START:
        return w->tree.child_starts[place];
    default: {
        const int degree = property - FXS_RAD_SH1;
        return (double)w->held.sh[(size_t)i * w->held.coefficients + (size_t)(3 * degree * (degree + 2) + d)] /
               FXS_HELD_SH_ONE;
    }
    }
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static int find_range(rad_writer *w, int property, double share, float range[2])
{
    const uint32_t all = w->tree.count, step = all / SAMPLES + 1;
    const size_t numbers = (size_t)fxs_rad_properties[property].numbers;
    float *values = malloc((all / step + 1) * numbers * sizeof *values);
    size_t count = 0;
    if (!values)
        return no_memory(w);
    for (uint32_t i = 0; i < all; i += step)
        for (size_t d = 0; d < numbers; d++)
            values[count++] = (float)value_of(w, property, i, (int)d);
    qsort(values, count, sizeof *values, compare_floats);
    range[0] = count ? values[(size_t)(share * (double)(count - 1))] : 0;
    range[1] = count ? values[count - 1 - (size_t)(share * (double)(count - 1))] : 0;
    free(values);
    return 1;
}

/* Chooses the ranges of the 8-bit codes of a .rad file. A range is enlarged only if 1 % of the values (5 % for SH) lie
   outside Spark's usual range. */
static int find_ranges(rad_writer *w)
{
    float range[2];
    if (!find_range(w, FXS_RAD_RGB, 0.01, w->rgb) || !find_range(w, FXS_RAD_SCALES, 0.01, w->scale))
        return 0;
    w->rgb[0] = fminf(w->rgb[0], 0);
    w->rgb[1] = fmaxf(w->rgb[1], 1);
    w->scale[0] = fminf(w->scale[0], -12);
    w->scale[1] = fmaxf(w->scale[1], 9);
    for (int degree = 0; degree < 3; degree++) {
        w->sh[degree] = 1;
        if (degree < w->sh_degree && !find_range(w, FXS_RAD_SH1 + degree, 0.05, range))
            return 0;
        if (degree < w->sh_degree)
            w->sh[degree] = fmaxf(fmaxf(-range[0], range[1]), 1);
    }
    return 1;
}

static uint8_t *put_little(uint8_t *to, uint32_t value, int width)
{
    for (int i = 0; i < width; i++)
        *to++ = (uint8_t)(value >> 8 * i);
    return to;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint32_t code_of(const rad_writer *w, int property, int encoding, double value)
{
    switch (encoding) {
    case FXS_RAD_F16:
    case FXS_RAD_LN_F16:
        return fxs_code_half(value);
    case FXS_RAD_S8: {
        const double most = (double)w->sh[property - FXS_RAD_SH1];
        return fxs_code_within(fmin(fmax(value / most, -1), 1) * 127 + 127, 254) + 256 - 127;
    }
    case FXS_RAD_U16:
    case FXS_RAD_U32:
        return (uint32_t)value;
    default:
        return bits_of((float)value);
    }
}

/* Stores a column (one attribute of a chunk of Gaussians): all x, then all y, then all z. The encoding f32_lebytes
   stores the lowest bytes of all numbers first. */
static uint8_t *fill_column(const rad_writer *w, int column, uint32_t first, uint32_t count, uint8_t *to)
{
    const int property = columns[column].property, encoding = columns[column].encoding;
    const int numbers = fxs_rad_properties[property].numbers, width = fxs_rad_encodings[encoding].width;
    const int planes = encoding == FXS_RAD_F32_LEBYTES ? width : 1;
    for (int plane = 0; plane < planes; plane++)
        for (int d = 0; d < numbers; d++)
            for (uint32_t i = first; i < first + count; i++)
                to = put_little(to, code_of(w, property, encoding, value_of(w, property, i, d)) >> 8 * plane,
                                width / planes);
    return to;
}

static int deflate_into(rad_writer *w, bytes *out, const uint8_t *data, size_t size)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return no_memory(w);
    const size_t room = deflateBound(&stream, (uLong)size);
    stream.next_in = data;
    stream.avail_in = (uInt)size;
    stream.next_out = grow(w, out, room);
    stream.avail_out = (uInt)room;
    const int made = stream.next_out && deflate(&stream, Z_FINISH) == Z_STREAM_END;
    if (made)
        out->size += room - stream.avail_out;
    deflateEnd(&stream);
    return made;
}

static void print_float(FILE *json, const char *before, float value)
{
    fputs(before, json);
    fxs_print_number(json, PRECISION, (double)value);
}

static void print_common(FILE *json, const rad_writer *w)
{
    static const char *const names[3] = {",\"sh1Max\":", ",\"sh2Max\":", ",\"sh3Max\":"};
    fprintf(json, ",\"maxSh\":%d,\"lodTree\":true,\"splatEncoding\":{", w->sh_degree);
    print_float(json, "\"rgbMin\":", w->rgb[0]);
    print_float(json, ",\"rgbMax\":", w->rgb[1]);
    print_float(json, ",\"lnScaleMin\":", w->scale[0]);
    print_float(json, ",\"lnScaleMax\":", w->scale[1]);
    for (int degree = 0; degree < 3; degree++)
        print_float(json, names[degree], w->sh[degree]);
    fputs(",\"lodOpacity\":true}", json);
}

static void print_column(FILE *json, const rad_writer *w, int column, size_t offset, size_t size)
{
    const int property = columns[column].property, encoding = columns[column].encoding;
    fprintf(json, "%s{\"offset\":%zu,\"bytes\":%zu,\"property\":\"%s\",\"encoding\":\"%s\",\"compression\":\"gz\"",
            column ? "," : "", offset, size, fxs_rad_properties[property].name, fxs_rad_encodings[encoding].name);
    if (encoding == FXS_RAD_S8) {
        print_float(json, ",\"min\":", -w->sh[property - FXS_RAD_SH1]);
        print_float(json, ",\"max\":", w->sh[property - FXS_RAD_SH1]);
    }
    fputs("}", json);
}

static int add_text(rad_writer *w, bytes *b, const char *magic, fxs_printed *printed)
{
    uint8_t length[4];
    if (fxs_print_end(printed))
        return no_memory(w);
    fxs_put_u32(length, (uint32_t)printed->size);
    return add(w, b, magic, 4) && add(w, b, length, 4) && add(w, b, printed->text, printed->size) && pad(w, b);
}

static int column_count(const rad_writer *w)
{
    return COLUMNS - 3 + w->sh_degree;
}

static int make_payload(rad_writer *w, uint32_t first, uint32_t count, bytes *payload, size_t sizes[COLUMNS])
{
    uint8_t *raw = malloc((size_t)count * 4 * 21);
    int made = raw != NULL;
    for (int c = 0; c < column_count(w) && made; c++) {
        const size_t before = payload->size;
        const uint8_t *end = fill_column(w, c, first, count, raw);
        made = deflate_into(w, payload, raw, (size_t)(end - raw));
        sizes[c] = payload->size - before;
        made = made && pad(w, payload);
    }
    free(raw);
    return made ? 1 : no_memory(w);
}

static int write_chunk(rad_writer *w, uint32_t first, uint32_t count, const bytes *payload, const size_t sizes[COLUMNS])
{
    fxs_printed printed;
    size_t offset = 0;
    uint8_t length[8] = {0};
    if (fxs_print_begin(&printed))
        return no_memory(w);
    FILE *json = printed.file;
    fprintf(json, "{\"version\":1,\"base\":%lu,\"count\":%lu,\"payloadBytes\":%zu", (unsigned long)first,
            (unsigned long)count, payload->size);
    print_common(json, w);
    fputs(",\"properties\":[", json);
    for (int c = 0; c < column_count(w); offset += (sizes[c++] + 7) / 8 * 8)
        print_column(json, w, c, offset, sizes[c]);
    fputs("]}", json);
    fxs_put_u32(length, (uint32_t)payload->size);
    const int made = add_text(w, &w->file, "RADC", &printed) && add(w, &w->file, length, 8) &&
                     add(w, &w->file, payload->data, payload->size);
    free(printed.text);
    return made;
}

static int make_chunks(rad_writer *w)
{
    const uint32_t all = w->tree.count;
    w->ends = malloc((all / CHUNK + 1) * sizeof *w->ends);
    if (!w->ends)
        return no_memory(w);
    for (uint32_t first = 0; first < all; first += CHUNK) {
        const uint32_t count = all - first < CHUNK ? all - first : CHUNK;
        size_t sizes[COLUMNS];
        bytes payload = {NULL, 0, 0};
        const int made = make_payload(w, first, count, &payload, sizes) &&
                         write_chunk(w, first, count, &payload, sizes);
        free(payload.data);
        w->ends[first / CHUNK] = w->file.size;
        if (!made || !advance(w, 0.5 + 0.5 * (first + count) / all))
            return 0;
    }
    return 1;
}

static int make_header(rad_writer *w, bytes *head)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed))
        return no_memory(w);
    FILE *json = printed.file;
    fprintf(json, "{\"version\":1,\"type\":\"gsplat\",\"count\":%lu,\"chunkSize\":%d,\"allChunkBytes\":%zu",
            (unsigned long)w->tree.count, CHUNK, w->file.size);
    print_common(json, w);
    fputs(",\"comment\":\"fixsplat " FXS_VERSION "\",\"chunks\":[", json);
    for (uint32_t i = 0; i < (w->tree.count + CHUNK - 1) / CHUNK; i++) {
        const size_t begin = i ? w->ends[i - 1] : 0;
        fprintf(json, "%s{\"offset\":%zu,\"bytes\":%zu}", i ? "," : "", begin, w->ends[i] - begin);
    }
    fputs("]}", json);
    const int made = add_text(w, head, "RAD0", &printed);
    free(printed.text);
    return made;
}

static int tree_progress(void *writer, double done)
{
    return advance(writer, 0.1 + 0.4 * done);
}

static int make_tree(rad_writer *w)
{
    return !w->held.count || fxs_rad_tree_make(&w->tree, &w->held, tree_progress, w) || w->held.output.error
               ? !w->held.output.error : no_memory(w);
}

static int rad_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                     fxs_message *message)
{
    rad_writer *w = writer;
    bytes head = {NULL, 0, 0};
    (void)report;
    w->progress = progress;
    if (fxs_held_order(&w->held) && advance(w, 0.1) && make_tree(w) && find_ranges(w) && make_chunks(w) &&
        make_header(w, &head) &&
        !fxs_output_write(&w->held.output, head.data, head.size, message))
        fxs_output_write(&w->held.output, w->file.data, w->file.size, message);
    free(head.data);
    free(w->file.data);
    free(w->ends);
    fxs_rad_tree_free(&w->tree);
    return fxs_held_close(&w->held, message);
}

const fxs_writer fxs_write_rad = {sizeof(rad_writer), rad_open, rad_put, rad_close, NULL};

#else

static int rad_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    (void)writer, (void)o;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot write .rad: built without zlib", path);
}

const fxs_writer fxs_write_rad = {0, rad_open, NULL, NULL, NULL};

#endif
