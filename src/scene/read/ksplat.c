/* Reads .ksplat 0.x. Layout: SplatBuffer.js of mkkellogg/GaussianSplats3D. Each section of the file groups its
   Gaussians into buckets. The section lists the lengths of partly filled buckets, the centres of all buckets, and the
   Gaussians in bucket order. Compression level 0 has Gaussians only. */
#include "src/base/byte_reader.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

enum { HEADER_SIZE = 4096, SECTION_HEADER_SIZE = 1024, LEVELS = 3 };

/* For each compression level: byte offsets of the fields of a stored Gaussian, and bytes of an SH coefficient. */
static const struct layout { uint8_t scale, rotation, colour, sh, coefficient; } layouts[LEVELS] = {
    {12, 24, 40, 44, 4}, {6, 12, 20, 24, 2}, {6, 12, 20, 24, 1}
};

typedef struct section {
    uint32_t count;
    uint32_t bucket_size, buckets, full_buckets, partial_buckets;
    uint32_t centre_size;
    int sh_degree;
    uint32_t row_size;
    /* coding of positions in a bucket at compression levels 1 and 2: position = (code - range) step + bucket centre */
    double range, step;
    uint64_t lengths, centres, rows, end;
} section;

typedef struct ksplat_reader {
    const fxs_scene_source *source;
    int level;
    float sh_low, sh_high;
    uint64_t count, read;
    uint32_t sections, sections_begun;
    section section;
    uint32_t section_read;
    uint32_t buckets_begun, bucket_left;
    float centre[3];
    fxs_byte_reader headers, lengths, centres, rows;
} ksplat_reader;

static section parse_section(const ksplat_reader *reader, const uint8_t *header)
{
    const struct layout *layout = &layouts[reader->level];
    const uint32_t range = fxs_load_u32(header + 24), degree = fxs_load_u16(header + 40);
    section s = {.count = fxs_load_u32(header), .bucket_size = fxs_load_u32(header + 8),
                 .buckets = fxs_load_u32(header + 12), .centre_size = fxs_load_u16(header + 20),
                 .full_buckets = fxs_load_u32(header + 32), .partial_buckets = fxs_load_u32(header + 36),
                 .sh_degree = (int)degree, .range = range ? range : 32767};
    s.step = (double)fxs_load_float(header + 16) / 2 / s.range;
    s.row_size = layout->sh + 3 * degree * (degree + 2) * layout->coefficient;
    s.lengths = reader->section.end;
    s.centres = s.lengths + 4 * (uint64_t)s.partial_buckets;
    s.rows = s.centres + (uint64_t)s.buckets * s.centre_size;
    s.end = s.rows + (uint64_t)fxs_load_u32(header + 4) * s.row_size;
    return s;
}

static const char *check_section(const ksplat_reader *reader, const section *s)
{
    const uint64_t file_size = reader->source->input.size;
    if (s->sh_degree > 3)
        return "an SH degree above 3";
    if (s->lengths > file_size || s->rows + (uint64_t)s->count * s->row_size > file_size)
        return "the file ends before its last Gaussian";
    if ((uint64_t)s->count * s->row_size > s->end - s->rows)
        return "more Gaussians than it has room for";
    if (reader->level == 0 || s->count == 0)
        return NULL;
    if (s->centre_size < 12)
        return "bucket centres of less than 12 bytes";
    if ((uint64_t)s->full_buckets + s->partial_buckets > s->buckets)
        return "more full and partly filled buckets than buckets";
    if (!(s->step > 0 && isfinite(s->step)))
        return "no valid block size";
    return NULL;
}

static int begin_section(ksplat_reader *reader, fxs_message *message)
{
    const uint8_t *header = fxs_bytes_take(&reader->headers, SECTION_HEADER_SIZE);
    if (!header)
        return fxs_bytes_fail_row(&reader->headers, "section", reader->sections_begun, reader->sections, message);
    section *s = &reader->section;
    *s = parse_section(reader, header);
    reader->headers.fault = check_section(reader, s);
    if (reader->headers.fault)
        return fxs_bytes_fail_row(&reader->headers, "section", reader->sections_begun, reader->sections, message);
    reader->sections_begun++;
    reader->section_read = reader->buckets_begun = reader->bucket_left = 0;
    if (s->count > 0) {
        fxs_bytes_seek(&reader->lengths, s->lengths);
        fxs_bytes_seek(&reader->centres, s->centres);
        fxs_bytes_seek(&reader->rows, s->rows);
    }
    return 0;
}

static int ksplat_rewind(void *handle, fxs_message *message)
{
    ksplat_reader *reader = handle;
    reader->read = reader->section_read = reader->sections_begun = reader->section.count = 0;
    reader->section.end = HEADER_SIZE + (uint64_t)reader->sections * SECTION_HEADER_SIZE;
    if (fxs_bytes_seek(&reader->headers, HEADER_SIZE) != 0)
        return fxs_fail(message, "%s: %s", reader->source->path, reader->headers.fault);
    return 0;
}

static int read_header(ksplat_reader *reader, fxs_message *message)
{
    const uint8_t *header = fxs_bytes_take(&reader->headers, HEADER_SIZE);
    const char *path = reader->source->path;
    if (!header)
        return fxs_fail(message, "%s: header: %s", path, reader->headers.fault);
    reader->level = fxs_load_u16(header + 20);
    if (reader->level >= LEVELS)
        return fxs_fail(message, "%s: compression level %d, not 0 to 2", path, reader->level);
    float low = fxs_load_float(header + 36), high = fxs_load_float(header + 40);
    reader->sh_low = low < 0 || low > 0 ? low : -1.5f;
    reader->sh_high = high < 0 || high > 0 ? high : 1.5f;
    reader->sections = fxs_load_u32(header + 4);
    uint64_t needed = HEADER_SIZE + (uint64_t)reader->sections * SECTION_HEADER_SIZE;
    if (needed > reader->source->input.size)
        return fxs_fail(message, "%s: the header asks for at least %llu bytes, the file has %llu", path,
                        (unsigned long long)needed, (unsigned long long)reader->source->input.size);
    return ksplat_rewind(reader, message);
}

static int ksplat_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    ksplat_reader *reader = handle;
    reader->source = source;
    reader->headers.source = reader->lengths.source = reader->centres.source = reader->rows.source = source;
    info->sh_degree = info->antialiased = 0;
    info->colour.step = 1 / 255.0;
    FXS_TRY(read_header(reader, message));
    while (reader->sections_begun < reader->sections) {
        FXS_TRY(begin_section(reader, message));
        reader->count += reader->section.count;
        if (reader->section.count > 0 && reader->section.sh_degree > info->sh_degree)
            info->sh_degree = reader->section.sh_degree;
    }
    info->count = reader->count;
    return ksplat_rewind(reader, message);
}

static float load_real(const ksplat_reader *reader, const uint8_t *values, int i)
{
    return reader->level == 0 ? fxs_load_float(values + 4 * i) : fxs_half(fxs_load_u16(values + 2 * i));
}

static float load_coefficient(const ksplat_reader *reader, const uint8_t *values, int i)
{
    if (reader->level < 2)
        return load_real(reader, values, i);
    float t = values[i] / 255.0f;
    return reader->sh_low * (1 - t) + reader->sh_high * t;
}

static int fail_gaussian(const ksplat_reader *reader, const fxs_byte_reader *bytes, fxs_message *message)
{
    return fxs_bytes_fail_row(bytes, "Gaussian", reader->read, reader->count, message);
}

static int begin_bucket(ksplat_reader *reader, fxs_message *message)
{
    const section *s = &reader->section;
    const uint8_t *bytes;
    if (reader->buckets_begun == s->full_buckets + s->partial_buckets) {
        reader->lengths.fault = "not in any bucket";
        return fail_gaussian(reader, &reader->lengths, message);
    }
    reader->bucket_left = s->bucket_size;
    if (reader->buckets_begun >= s->full_buckets) {
        if (!(bytes = fxs_bytes_take(&reader->lengths, 4)))
            return fail_gaussian(reader, &reader->lengths, message);
        reader->bucket_left = fxs_load_u32(bytes);
    }
    if (!(bytes = fxs_bytes_take(&reader->centres, s->centre_size)))
        return fail_gaussian(reader, &reader->centres, message);
    for (int i = 0; i < 3; i++)
        reader->centre[i] = fxs_load_float(bytes + 4 * i);
    reader->buckets_begun++;
    return 0;
}

static int advance(ksplat_reader *reader, fxs_message *message)
{
    while (reader->section_read == reader->section.count)
        FXS_TRY(begin_section(reader, message));
    while (reader->level > 0 && reader->bucket_left == 0)
        FXS_TRY(begin_bucket(reader, message));
    return 0;
}

/* Decodes the SH coefficients of a Gaussian. For each degree, the file has all of red, then green, then blue. */
static void decode_sh(const ksplat_reader *reader, const uint8_t *values, float sh[45])
{
    for (int degree = 1; degree <= reader->section.sh_degree; degree++) {
        const int first = degree * degree - 1, width = 2 * degree + 1;
        for (int channel = 0; channel < 3; channel++)
            for (int k = 0; k < width; k++)
                sh[3 * (first + k) + channel] = load_coefficient(reader, values, 3 * first + channel * width + k);
    }
}

static void decode(const ksplat_reader *reader, const uint8_t *row, fxs_gaussian *gaussian)
{
    const struct layout *layout = &layouts[reader->level];
    const uint8_t *colour = row + layout->colour;
    for (int i = 0; i < 3; i++) {
        gaussian->position[i] = reader->level == 0 ? fxs_load_float(row + 4 * i)
            : (float)((fxs_load_u16(row + 2 * i) - reader->section.range) * reader->section.step
                      + (double)reader->centre[i]);
        gaussian->scale[i] = fxs_log_scale((double)load_real(reader, row + layout->scale, i));
        gaussian->dc[i] = fxs_dc_of_colour(colour[i] / 255.0);
    }
    for (int i = 0; i < 4; i++)
        gaussian->rotation[i] = load_real(reader, row + layout->rotation, i);
    gaussian->opacity = fxs_logit_of_code(colour[3]);
    decode_sh(reader, row + layout->sh, gaussian->sh);
}

static long ksplat_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    ksplat_reader *reader = handle;
    uint64_t left = reader->count - reader->read;
    long count = (long)(capacity < left ? capacity : left);
    memset(gaussians, 0, (size_t)count * sizeof *gaussians);
    for (long i = 0; i < count; i++) {
        FXS_TRY(advance(reader, message));
        const uint8_t *row = fxs_bytes_take(&reader->rows, reader->section.row_size);
        if (!row)
            return fail_gaussian(reader, &reader->rows, message);
        decode(reader, row, &gaussians[i]);
        reader->read++;
        reader->section_read++;
        reader->bucket_left -= reader->level > 0;
    }
    return count;
}

static int is_ksplat(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->size >= 4 && head->bytes[0] == 0 && head->bytes[1] != 0 && head->bytes[2] == 0 && head->bytes[3] == 0;
}

const fxs_reader fxs_read_ksplat = {
    is_ksplat, sizeof(ksplat_reader), ksplat_open, ksplat_read, ksplat_rewind, NULL, NULL
};
