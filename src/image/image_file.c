#include <fixsplat/image_file.h>

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/message.h>
#include "src/base/files_internal.h"
#include "src/base/opened.h"
#include "src/base/try_internal.h"

#define MAX_SIZE 16384
#define MAX_READ_PIXELS (1 << 26)
#define LEAST_ROOM (1 << 16)      /* the least limit for the data of a .png, which may be stored or in many parts */
#define MAX_JPEG_PIXELS 512       /* for a byte: the first scan has at least a bit for 8 x 8 pixels */
#define JPEG_UNIT 32              /* sizes are rounded up to a multiple of at most this, pixels */

/* Messages about faults of a picture. */
static const char out_of_memory[] = "out of memory";
static const char no_stb[] = "not a .ppm; this program was built without stb, which .png and .jpg need";
static const char cut_short[] = "cut short";

#ifdef FXS_WITH_STB
static const char no_picture[] = "not a .png, .jpg or .ppm";
static const char too_much_data[] = "more data than a picture of its size has";

/* The largest block that stb_image may allocate for the picture that this thread reads, and why it did not get one. */
static __thread struct {
    size_t most;
    const char *fault;
} decoding;

/* Zeroed memory: stb_image 2.27 accepts a .jpg without some tables or parts, and would read what the memory had. */
static void *bounded_malloc(size_t size)
{
    void *made = size <= decoding.most ? calloc(1, size) : NULL;
    if (!made)
        decoding.fault = size <= decoding.most ? out_of_memory : too_much_data;
    return made;
}

static void *bounded_realloc(void *old, size_t size)
{
    void *made = size <= decoding.most ? realloc(old, size) : NULL;
    if (!made)
        decoding.fault = size <= decoding.most ? out_of_memory : too_much_data;
    return made;
}

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"   /* gcc says it at the end of the file */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_SIMD              /* only its integer code for .jpg: the same bytes on every processor */
#define STBI_MAX_DIMENSIONS MAX_SIZE
#define STBI_MALLOC(size) bounded_malloc(size)
#define STBI_REALLOC(old, size) bounded_realloc(old, size)
#define STBI_FREE(old) free(old)
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#endif

static const char too_large[] = "without pixels, or more than 16384 on a side or 2^26 in all";

static int readable_size(int width, int height)
{
    return width >= 1 && height >= 1 && width <= MAX_SIZE && height <= MAX_SIZE &&
           (int64_t)width * height <= MAX_READ_PIXELS;
}

#ifdef FXS_WITH_STB
static const char *why_not_decoded(void)
{
    const char *reason = decoding.fault ? decoding.fault : stbi_failure_reason();
    return reason ? reason : "damaged";   /* stb_image does not always give a reason */
}

static const char *read_png(FILE *file, uint8_t **rgba, int *width, int *height)
{
    int channels;
    if (!stbi_info_from_file(file, width, height, &channels))
        return no_picture;
    if (!readable_size(*width, *height))
        return too_large;
    /* A row has one byte more than its pixels; stb_image doubles a buffer that is too small, as for interlaced
       pictures. */
    const size_t pixel_bytes = stbi_is_16_bit_from_file(file) ? 8 : 4;
    decoding.most = 2 * (pixel_bytes * (size_t)*width + 1) * (size_t)*height + LEAST_ROOM;
    *rgba = stbi_load_from_file(file, width, height, &channels, 4);
    return *rgba ? NULL : why_not_decoded();
}

/* ---- What stb_image 2.27 does not check of a .jpg ---- */

static int big_endian_16(FILE *file)
{
    const int upper = getc(file), lower = getc(file);
    return upper == EOF || lower == EOF ? EOF : upper << 8 | lower;
}

/* Checks Huffman tables of `size` bytes. A picture of 8 bits needs less than 256 codes. */
static const char *check_tables(FILE *file, int size)
{
    while (size > 0) {
        int codes = 0;
        getc(file);                /* which table */
        for (int i = 0; i < 16; i++) {
            const int count = getc(file);
            if (count == EOF)
                return cut_short;
            codes += count;
        }
        size -= 17 + codes;
        if (codes > 255 || size < 0)
            return "a Huffman table of more codes than there are";
        if (fseek(file, codes, SEEK_CUR))
            return cut_short;
    }
    return NULL;
}

/* Checks the components of a frame: the highest sampling rate must be a multiple of each component's. */
static const char *check_frame(FILE *file, int size)
{
    int sampling[4][2], most[2] = {1, 1}, count;
    if (fseek(file, 5, SEEK_CUR) || (count = getc(file)) == EOF)
        return cut_short;
    if (count > 4 || size != 6 + 3 * count)
        return "a frame of another size than its components have";
    for (int i = 0; i < count; i++) {
        getc(file);
        const int both = getc(file);
        if (getc(file) == EOF)
            return cut_short;
        for (int k = 0; k < 2; k++) {
            sampling[i][k] = k ? both & 15 : both >> 4;
            most[k] = sampling[i][k] > most[k] ? sampling[i][k] : most[k];
        }
    }
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            if (!sampling[i][k] || most[k] % sampling[i][k])
                return "components that do not lie on each other";
    return NULL;
}

/* The second byte of the next marker that begins a segment, or EOF. */
static int next_marker(FILE *file)
{
    int c = 0;
    while (c == 0 || (c >= 0xd0 && c <= 0xd7)) {   /* in coded data: a byte of 255, or a restart marker */
        do
            c = getc(file);
        while (c != 0xff && c != EOF);
        while (c == 0xff)
            c = getc(file);
    }
    return c;
}

static const char *check_jpeg(FILE *file)
{
    const char *fault = NULL;
    int marker;
    if (getc(file) != 0xff || getc(file) != 0xd8)
        return no_picture;
    while (!fault && (marker = next_marker(file)) != 0xd9) {
        const int size = marker == EOF ? EOF : big_endian_16(file) - 2;
        if (size < 0)
            fault = cut_short;
        else if (marker == 0xc4)
            fault = check_tables(file, size);
        else if (marker >= 0xc0 && marker <= 0xc2)
            fault = check_frame(file, size);
        else if (fseek(file, size, SEEK_CUR))
            fault = cut_short;
    }
    rewind(file);
    return fault;
}

/* ---- A .jpg ---- */

/* A file, and 1 once stb_image has read beyond its end. */
typedef struct jpeg_stream {
    FILE *file;
    int beyond;
} jpeg_stream;

static int read_stream(void *argument, char *data, int size)
{
    jpeg_stream *stream = argument;
    const size_t read = fread(data, 1, (size_t)size, stream->file);
    stream->beyond |= !read;
    return (int)read;
}

static void skip_stream(void *argument, int bytes)
{
    jpeg_stream *stream = argument;
    stream->beyond |= fseek(stream->file, bytes, SEEK_CUR) != 0;
}

/* fseek clears the state of feof. */
static int at_end(void *argument)
{
    const jpeg_stream *stream = argument;
    return stream->beyond || feof(stream->file);
}

/* Versions of stb_image differ in whether missing data at the end are 0: here a picture is complete or refused. */
static const char *read_jpeg(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    static const stbi_io_callbacks calls = {read_stream, skip_stream, at_end};
    jpeg_stream stream = {file, 0};
    int channels;
    const char *fault = check_jpeg(file);
    if (fault)
        return fault;
    if (!stbi_info_from_callbacks(&calls, &stream, width, height, &channels))
        return stream.beyond ? cut_short : why_not_decoded();
    if (!readable_size(*width, *height))
        return too_large;
    if ((uint64_t)*width * (uint64_t)*height / MAX_JPEG_PIXELS > bytes)
        return "fewer bytes than a picture of its size has";
    rewind(file);
    stream.beyond = 0;
    decoding.most = 4 * ((size_t)*width + JPEG_UNIT) * ((size_t)*height + JPEG_UNIT) + LEAST_ROOM;
    *rgba = stbi_load_from_callbacks(&calls, &stream, width, height, &channels, 4);
    return stream.beyond ? cut_short : *rgba ? NULL : why_not_decoded();
}

static const char *read_by_stb(FILE *file, uint64_t bytes, int first, uint8_t **rgba, int *width, int *height)
{
    decoding.most = LEAST_ROOM;
    decoding.fault = NULL;
    return first == 0xff ? read_jpeg(file, bytes, rgba, width, height) : read_png(file, rgba, width, height);
}
#else
static const char *read_by_stb(FILE *file, uint64_t bytes, int first, uint8_t **rgba, int *width, int *height)
{
    (void)file, (void)bytes, (void)first, (void)rgba, (void)width, (void)height;
    return no_stb;
}
#endif

/* Reads a number in the header of a .ppm, blanks and comments before it and the blank after it; -1: there is none. */
static int header_number(FILE *file)
{
    int c = getc(file), comment = 0, value = 0;
    while (isspace(c) || c == '#' || (comment && c != EOF)) {
        comment = c == '#' || (comment && c != '\n');
        c = getc(file);
    }
    if (!isdigit(c))
        return -1;
    for (; isdigit(c) && value <= MAX_SIZE; c = getc(file))
        value = 10 * value + (c - '0');
    return isspace(c) ? value : -1;
}

/* The readers return NULL or a text about the fault. */

/* stb_image 2.27 has a .ppm reader too, but accepts a file that is cut short. */
static const char *read_ppm(FILE *file, uint8_t **rgba, int *width, int *height)
{
    if (getc(file) != 'P' || getc(file) != '6')
        return "not a .ppm of type P6";
    *width = header_number(file);
    *height = header_number(file);
    if (header_number(file) != 255)
        return "not a .ppm of 255 levels";
    if (!readable_size(*width, *height))
        return too_large;
    size_t pixels = (size_t)*width * (size_t)*height;
    *rgba = malloc(4 * pixels);
    if (!*rgba)
        return out_of_memory;
    uint8_t *rgb = *rgba + pixels;   /* spread to RGBA from the end to the front */
    if (fread(rgb, 3, pixels, file) != pixels)
        return cut_short;
    for (size_t i = 0; i < pixels; i++) {
        memmove(*rgba + 4 * i, rgb + 3 * i, 3);
        (*rgba)[4 * i + 3] = 255;
    }
    return NULL;
}

static int fail_read(const char *path, const char *fault, fxs_message *message)
{
    const int error = fault == out_of_memory ? FXS_ERR_MEMORY : fault == no_stb ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
    return fxs_fail_as(error, message, "%s: %s", path, fault);
}

int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message)
{
    FILE *file;
    fxs_file_facts facts;
    int result = 0;
    *rgba = NULL;
    FXS_TRY(fxs_file_open(path, &file, &facts, message));
    fxs_opened(facts.device, facts.inode);
    const int first = getc(file);
    rewind(file);
    const char *fault = first == 'P' ? read_ppm(file, rgba, width, height)
                                     : read_by_stb(file, facts.size, first, rgba, width, height);
    if (fault) {
        result = ferror(file) ? fxs_fail_errno(message, path, errno) : fail_read(path, fault, message);
        free(*rgba);
        *rgba = NULL;
    }
    fclose(file);
    return result;
}
