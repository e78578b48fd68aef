/* Reads HEIF with libheif and converts colours in integers, so the bytes are the same on every machine. libheif
   limits neither stream sizes nor references between pictures, so both are checked first. */
#ifdef FXS_WITH_HEIF

#include "heif_library.h"
#include "photograph_internal.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_PIXELS = 1 << 26, MAX_BYTES = 1 << 28, MAX_EXIF_BYTES = 1 << 20, SIDE = 16384 };

typedef struct reading {
    const fxs_heif_library *lib;
    struct heif_context *context;
    struct heif_image_handle *handle;
    struct heif_image *image;
    uint8_t *bytes;
    size_t size;
} reading;

/* A plane (channel) of a HEIF picture. Samples with more than 8 bits are 16-bit words in native byte order; their upper
   8 bits are used. */
typedef struct plane {
    const uint8_t *samples;
    int width, height, stride, bits;
} plane;

static int sample(const plane *p, int x, int y)
{
    const uint8_t *row = p->samples + (size_t)y * (size_t)p->stride;
    uint16_t wide;
    if (p->bits <= 8)
        return row[x];
    memcpy(&wide, row + 2 * x, sizeof wide);
    return wide >> (p->bits - 8) & 255;
}

/* Factors in Q16 that convert YCbCr to RGB: R = y Y + red Cr, G = y Y - green[0] Cb - green[1] Cr, B = y Y + blue Cb.
   `black` is subtracted from Y before. Cb and Cr begin at -128. */
typedef struct colours {
    int black, y, red, green[2], blue;
} colours;

static int fixed(double x)
{
    return (int)(x * 65536 + 0.5);
}

/* Computes the colour factors as ITU-T H.273 says: R = Y + 2 (1 - kr) Cr, B = Y + 2 (1 - kb) Cb, Y = kr R + (1 - kr -
   kb) G + kb B. Limited range has 219 levels of Y from 16, and 224 levels of chroma. */
static void set_colours(colours *c, double kr, double kb, int is_full)
{
    const double kg = 1 - kr - kb, chroma = is_full ? 1 : 255.0 / 224;
    c->black = is_full ? 0 : 16;
    c->y = fixed(is_full ? 1 : 255.0 / 219);
    c->red = fixed(chroma * 2 * (1 - kr));
    c->blue = fixed(chroma * 2 * (1 - kb));
    c->green[0] = fixed(chroma * 2 * kb * (1 - kb) / kg);
    c->green[1] = fixed(chroma * 2 * kr * (1 - kr) / kg);
}

/* Takes the colour matrix that the HEIF file states, else the matrix of its video stream. The default is BT.601 in full
   range, as in libheif. */
static const char *find_colours(const reading *r, colours *c)
{
    struct heif_color_profile_nclx *stated = NULL;
    int matrix = 2, is_full = 1;
    if (r->lib->heif_image_handle_get_nclx_color_profile(r->handle, &stated).code != heif_error_Ok)
        r->lib->heif_image_get_nclx_color_profile(r->image, &stated);
    if (stated) {
        matrix = (int)stated->matrix_coefficients;
        is_full = stated->full_range_flag;
        r->lib->heif_nclx_color_profile_free(stated);
    }
    if (matrix == 1)
        set_colours(c, 0.2126, 0.0722, is_full);           /* BT.709 */
    else if (matrix == 2 || matrix == 5 || matrix == 6)
        set_colours(c, 0.299, 0.114, is_full);             /* BT.601 */
    else if (matrix == 9)
        set_colours(c, 0.2627, 0.0593, is_full);           /* BT.2020 */
    else
        return "colours that are not known here";
    return NULL;
}

static uint8_t rounded(int fixed)
{
    const int most = 255 * 65536;
    return (uint8_t)(((fixed < 0 ? 0 : fixed > most ? most : fixed) + 32768) >> 16);
}

static const char *find_plane(const reading *r, enum heif_channel channel, plane *p)
{
    p->samples = r->lib->heif_image_get_plane_readonly(r->image, channel, &p->stride);
    if (!p->samples)
        return NULL;
    p->width = r->lib->heif_image_get_width(r->image, channel);
    p->height = r->lib->heif_image_get_height(r->image, channel);
    p->bits = r->lib->heif_image_get_bits_per_pixel_range(r->image, channel);
    return p->width < 1 || p->height < 1 || p->bits < 8 || p->bits > 16 ||
                   p->stride < p->width * (p->bits > 8 ? 2 : 1)
               ? "pixels of a form that is not known here"
               : NULL;
}

static int halved(int at, int size)
{
    return at / 2 < size ? at / 2 : size - 1;
}

/* Converts YCbCr to RGBA. The chroma of a pixel is taken from the nearest sample. */
static void convert(const plane planes[4], const colours *c, uint8_t *rgba)
{
    const int width = planes[0].width, height = planes[0].height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, rgba += 4) {
            const int level = (sample(&planes[0], x, y) - c->black) * c->y;
            int chroma[2];
            for (int k = 0; k < 2; k++) {
                const plane *p = &planes[1 + k];
                chroma[k] = sample(p, halved(x, p->width), halved(y, p->height)) - 128;
            }
            rgba[0] = rounded(level + c->red * chroma[1]);
            rgba[1] = rounded(level - c->green[0] * chroma[0] - c->green[1] * chroma[1]);
            rgba[2] = rounded(level + c->blue * chroma[0]);
            rgba[3] = planes[3].samples ? (uint8_t)sample(&planes[3], x, y) : 255;
        }
}

/* Asks libheif for YCbCr 4:2:0 pixels, which HEVC specifies bit-exactly. libheif's own colour conversion uses
   floats. */
static const char *take_pixels(const reading *r, uint8_t **rgba, int *width, int *height)
{
    static const enum heif_channel channels[4] = {heif_channel_Y, heif_channel_Cb, heif_channel_Cr, heif_channel_Alpha};
    plane planes[4];
    colours c;
    const char *fault = find_colours(r, &c);
    for (int i = 0; i < 4 && !fault; i++)
        fault = find_plane(r, channels[i], &planes[i]);
    if (!fault && (!planes[0].samples || !planes[1].samples || !planes[2].samples ||
                   r->lib->heif_image_is_premultiplied_alpha(r->image) ||
                   (planes[3].samples && (planes[3].width != planes[0].width || planes[3].height != planes[0].height))))
        fault = "pixels of a form that is not known here";
    if (fault)
        return fault;
    *width = planes[0].width;
    *height = planes[0].height;
    fault = fxs_image_refusal(*width, *height, r->size);
    if (fault)
        return fault;
    *rgba = malloc(4 * (size_t)*width * (size_t)*height);
    if (!*rgba)
        return fxs_no_memory;
    convert(planes, &c, *rgba);
    return NULL;
}

/* Reads bits of a NAL unit, a packet of a HEVC stream (ITU-T H.265, 7.3.1.1). It skips the 3 of bytes 0 0 3. Bits past
   the end are 0. */
typedef struct bits {
    const uint8_t *bytes;
    size_t size, at;
} bits;

static uint32_t take(bits *b, int count)
{
    uint32_t value = 0;
    for (int i = 0; i < count; i++, b->at++) {
        const size_t byte = b->at / 8;
        if (b->at % 8 == 0 && byte > 1 && byte < b->size && b->bytes[byte] == 3 && !b->bytes[byte - 1] &&
            !b->bytes[byte - 2])
            b->at += 8;
        const uint32_t bit = b->at / 8 < b->size ? b->bytes[b->at / 8] >> (7 - b->at % 8) & 1 : 0;
        value = value << 1 | bit;
    }
    return value;
}

/* Reads an Exp-Golomb code, a number of variable length: ue(v) of ITU-T H.265, 9.2. */
static uint32_t take_code(bits *b)
{
    int zeros = 0;
    while (zeros < 31 && b->at < 8 * b->size && !take(b, 1))
        zeros++;
    return (1u << zeros) - 1 + take(b, zeros);
}

static uint64_t stated_pixels(const uint8_t *unit, size_t size)
{
    bits b = {unit, size, 16 + 4};
    uint32_t has[7];
    const int layers = (int)take(&b, 3);
    take(&b, 1);
    for (int i = 0; i < 3; i++)
        take(&b, 32);
    for (int i = 0; i < layers; i++)
        has[i] = take(&b, 2);
    take(&b, layers ? 2 * (8 - layers) : 0);
    for (int i = 0; i < layers; i++) {
        for (int k = 0; k < 11 && has[i] >> 1; k++)
            take(&b, 8);
        take(&b, has[i] & 1 ? 8 : 0);
    }
    take_code(&b);
    if (take_code(&b) == 3)
        take(&b, 1);
    const uint64_t width = take_code(&b);
    return width * take_code(&b);
}

/* Finds a HEVC stream that is too large. The decoder allocates memory by the picture size that the stream states. Every
   sequence parameter set is therefore limited to twice the allowed pixels of a picture, because sizes are whole
   blocks. */
static const char *find_large_stream(const uint8_t *bytes, size_t size)
{
    for (size_t at = 2; at + 2 < size; at++) {
        const size_t length = (size_t)bytes[at - 2] << 8 | bytes[at - 1];
        if (bytes[at] != 0x42 || !bytes[at + 1] || bytes[at + 1] > 7 || length < 8 || length > 4096)
            continue;
        const uint64_t pixels = stated_pixels(bytes + at, length < size - at ? length : size - at);
        if (pixels > 2 * MAX_PIXELS || (pixels > 2 * (1 << 20) && pixels / 1024 > size))
            return "a stream of more pixels than a file of its size may have";
    }
    return NULL;
}

/* Limits on references between the pictures of a HEIF: to tiles (dimg) and to a picture's alpha (auxl). Without them,
   libheif follows cycles until the stack overflows, and decodes a tile once per reference. */
enum { ITEMS = 65536, DEEPEST = 3, MOST_TILES = 1 << 15 };

static uint32_t number_at(const uint8_t *bytes, size_t count)
{
    uint32_t number = 0;
    for (size_t i = 0; i < count; i++)
        number = number << 8 | bytes[i];
    return number;
}

/* Adds up how often each picture of a HEIF is decoded because other pictures refer to it. A child of an iref box has
   size, type, number, count, then numbers of `wide` bytes. Returns 0 if a number is too large or *left is used up. */
static int add_named(const uint8_t *bytes, size_t size, size_t at, size_t wide, const uint32_t *from, uint32_t *to,
                     size_t *left)
{
    for (; at + 10 + wide <= size; --*left) {
        const size_t length = number_at(bytes + at, 4), count = number_at(bytes + at + 8 + wide, 2);
        const int is_part = !memcmp(bytes + at + 4, "dimg", 4), is_alpha = !memcmp(bytes + at + 4, "auxl", 4);
        const uint32_t owner = number_at(bytes + at + 8, wide);
        if (!*left)
            return 0;
        if (length < 10 + wide || length > size - at)
            return !is_part && !is_alpha;
        for (size_t i = 0; (is_part || is_alpha) && i < count && 10 + wide * (i + 2) <= length; i++, --*left) {
            const uint32_t other = number_at(bytes + at + 10 + wide * (i + 1), wide);
            if (owner >= ITEMS || other >= ITEMS || *left < 2)
                return 0;
            uint32_t *const sum = &to[is_part ? other : owner];
            *sum += from[is_part ? owner : other];
            *sum = *sum < 2 * MOST_TILES ? *sum : 2 * MOST_TILES;
        }
        at += length;
    }
    return 1;
}

static int add_all(const uint8_t *bytes, size_t size, const uint32_t *from, uint32_t *to)
{
    size_t left = size / 8 + 2 * MOST_TILES;
    for (size_t at = 4; at + 16 < size; at++)
        if (!memcmp(bytes + at, "iref", 4)) {
            const size_t first = at + (number_at(bytes + at - 4, 4) == 1 ? 12 : 4);
            if (!add_named(bytes, size, first + 4, bytes[first] ? 4 : 2, from, to, &left))
                return 0;
        }
    return 1;
}

static const char *find_circles(const uint8_t *bytes, size_t size)
{
    const char *fault = NULL;
    uint32_t *const counts = calloc(2 * ITEMS, sizeof *counts), *from = counts, *to = counts + ITEMS;
    uint64_t tiles = 0, last = 0;
    if (!counts)
        return fxs_no_memory;
    for (size_t i = 0; i < ITEMS; i++)
        from[i] = 1;
    for (int depth = 0; depth <= DEEPEST && !fault; depth++) {
        memset(to, 0, ITEMS * sizeof *to);
        if (!add_all(bytes, size, from, to))
            fault = "damaged: references of pictures";
        last = 0;
        for (size_t i = 0; i < ITEMS; i++)
            last += to[i];
        tiles += last;
        uint32_t *const swap = from;
        from = to;
        to = swap;
    }
    free(counts);
    return fault ? fault : last || tiles > MOST_TILES ? "a picture of pictures in circles, or of too many" : NULL;
}

static const char *said(struct heif_error error)
{
    static __thread char words[160];
    snprintf(words, sizeof words, "%s", error.message && *error.message ? error.message : "damaged");
    words[strcspn(words, "\r\n")] = 0;
    return error.code == heif_error_Ok ? NULL
           : error.code == heif_error_Memory_allocation_error ? fxs_no_memory
                                                              : words;
}

/* Reads the EXIF block of a HEIF. Its first four bytes are the offset of its TIFF data. */
static void take_exif(const reading *r, fxs_exif_bytes *exif)
{
    heif_item_id id;
    if (r->lib->heif_image_handle_get_list_of_metadata_block_IDs(r->handle, "Exif", &id, 1) != 1)
        return;
    const size_t size = r->lib->heif_image_handle_get_metadata_size(r->handle, id);
    uint8_t *block = size > 4 && size <= MAX_EXIF_BYTES ? malloc(size + 6) : NULL;
    if (block && r->lib->heif_image_handle_get_metadata(r->handle, id, block).code == heif_error_Ok) {
        const size_t from = (size_t)block[0] << 24 | (size_t)block[1] << 16 | (size_t)block[2] << 8 | block[3];
        if (from < size - 4) {
            memmove(block + 6, block + 4 + from, size - 4 - from);
            memcpy(block, "Exif\0", 6);
            fxs_exif_keep(exif, block, size - 4 - from + 6);
            exif->is_upright = 1;
        }
    }
    free(block);
}

static const char *decode(reading *r, FILE *file, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
    const fxs_heif_library *lib = r->lib;
    r->bytes = malloc(r->size + 1);
    r->context = lib->heif_context_alloc();
    if (!r->bytes || !r->context)
        return fxs_no_memory;
    if (fread(r->bytes, 1, r->size, file) != r->size)
        return "cut short";
    lib->heif_context_set_maximum_image_size_limit(r->context, SIDE);
    lib->heif_context_set_max_decoding_threads(r->context, 0);
    const char *fault = find_large_stream(r->bytes, r->size);
    fault = fault ? fault : find_circles(r->bytes, r->size);
    if (fault)
        return fault;
    fault = said(lib->heif_context_read_from_memory_without_copy(r->context, r->bytes, r->size, NULL));
    if (!fault)
        fault = said(lib->heif_context_get_primary_image_handle(r->context, &r->handle));
    if (!fault)
        fault = fxs_image_refusal(lib->heif_image_handle_get_width(r->handle),
                                  lib->heif_image_handle_get_height(r->handle), r->size);
    if (fault)
        return fault;
    struct heif_decoding_options *options = lib->heif_decoding_options_alloc();
    if (!options)
        return fxs_no_memory;
    options->strict_decoding = 1;
    fault = said(lib->heif_decode_image(r->handle, &r->image, heif_colorspace_YCbCr, heif_chroma_420, options));
    lib->heif_decoding_options_free(options);
    if (!fault)
        fault = take_pixels(r, rgba, width, height);
    if (!fault && exif)
        take_exif(r, exif);
    return fault;
}

const char *fxs_heif_read(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
    reading r = {.lib = fxs_heif_library_open()};
    if (!r.lib)
        return fxs_no_heif;
    if (bytes > MAX_BYTES)
        return "more than 2^28 bytes";
    r.size = (size_t)bytes;
    const char *fault = decode(&r, file, rgba, width, height, exif);
    if (r.image)
        r.lib->heif_image_release(r.image);
    if (r.handle)
        r.lib->heif_image_handle_release(r.handle);
    if (r.context)
        r.lib->heif_context_free(r.context);
    free(r.bytes);
    return fault;
}

#else
typedef int fxs_heif_is_not_linked;
#endif
