#include "image_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <strings.h>

#include "../files/output_internal.h"

#define MAX_SIZE 16384
#define MAX_READ_PIXELS (1 << 26)
#define LEAST_ROOM (1 << 16)      /* for the data of any .png: they may be stored, or in many parts */
#define MAX_JPEG_PIXELS 512       /* of a byte: the first scan has at least a bit for each 8 x 8 of them */
#define JPEG_UNIT 32              /* pixels that sizes are rounded up to, at most */
#define MAX_PNG_BYTES (1 << 29)   /* stb_image_write counts in int */

/* stb_image_write's own compression ends the program where memory does. */
#if defined(FXS_WITH_STB) && defined(FXS_WITH_ZLIB)
#define WRITES_PNG
#include <zlib.h>

static unsigned char *compress_rows(unsigned char *rows, int size, int *compressed, int level)
{
    uLongf room = compressBound((uLong)size);
    unsigned char *out = malloc(room);
    (void)level;   /* of stb_image_write's own */
    if (!out || compress(out, &room, rows, (uLong)size) != Z_OK || room > INT_MAX - 64) {
        free(out);
        return NULL;
    }
    *compressed = (int)room;
    return out;
}
#endif

/* Faults of a picture that are not the file's. */
static const char out_of_memory[] = "out of memory";
static const char no_stb[] = "not a .ppm; this program was built without stb, which .png and .jpg need";
static const char cut_short[] = "cut short";

#ifdef FXS_WITH_STB
/* What stb_image may have in one piece for the picture that this thread reads, and why it did not get that. */
static __thread struct {
    size_t most;
    const char *fault;
} decoding;

static void *bounded_realloc(void *old, size_t size)
{
    void *made = size <= decoding.most ? realloc(old, size) : NULL;
    if (!made)
        decoding.fault = size <= decoding.most ? out_of_memory : "more data than a picture of its size has";
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
#define STBI_NO_SIMD              /* .jpg by its one text in integers: the same bytes on every processor */
#define STBI_MAX_DIMENSIONS MAX_SIZE
#define STBI_MALLOC(size) bounded_realloc(NULL, size)
#define STBI_REALLOC(old, size) bounded_realloc(old, size)
#define STBI_FREE(old) free(old)
#include <stb/stb_image.h>
#ifdef WRITES_PNG
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STBIW_ASSERT(condition) ((void)(condition))
#define STBIW_ZLIB_COMPRESS compress_rows
#include <stb/stb_image_write.h>
#endif
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#endif

static const char too_large[] = "without pixels, or more than 16384 on a side or 2^26 in all";

enum { UNKNOWN, PNG, PPM, RAW };

static int format_of(const char *path)
{
    static const char *const endings[] = {[PNG] = ".png", [PPM] = ".ppm", [RAW] = ".raw"};
    const char *dot = strrchr(path, '.');
    for (int format = PNG; dot && format <= RAW; format++)
        if (!strcasecmp(dot, endings[format]))
            return format;
    return UNKNOWN;
}

int fxs_image_file_known(const char *path)
{
    return format_of(path) != UNKNOWN;
}

static int opaque(const uint8_t *rgba, size_t pixels)
{
    for (size_t i = 0; i < pixels; i++)
        if (rgba[4 * i + 3] != 255)
            return 0;
    return 1;
}

#ifdef WRITES_PNG
static void write_bytes(void *file, void *data, int size)
{
    fwrite(data, 1, (size_t)size, file);   /* ferror tells later */
}

static int write_png(FILE *file, int channels, const uint8_t *pixels, int width, int height)
{
    return stbi_write_png_to_func(write_bytes, file, width, height, channels, pixels, channels * width) ? 0
           : FXS_ERR_MEMORY;
}
#else
/* Refused before it comes to this. */
static int write_png(FILE *file, int channels, const uint8_t *pixels, int width, int height)
{
    (void)file, (void)channels, (void)pixels, (void)width, (void)height;
    return FXS_ERR_UNSUPPORTED;
}
#endif

/* Writes the pixels, in which the caller looks for errors of the stream. Returns 0 or FXS_ERR_MEMORY. */
static int write_pixels(FILE *file, int format, const uint8_t *rgba, int width, int height)
{
    size_t pixels = (size_t)width * (size_t)height;
    if (format == RAW) {
        fwrite(rgba, 4, pixels, file);
        return 0;
    }
    if (format == PNG && !opaque(rgba, pixels))
        return write_png(file, 4, rgba, width, height);
    uint8_t *rgb = malloc(3 * pixels);
    if (!rgb)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < pixels; i++)
        memcpy(rgb + 3 * i, rgba + 4 * i, 3);
    int result = 0;
    if (format == PNG)
        result = write_png(file, 3, rgb, width, height);
    else if (fprintf(file, "P6\n%d %d\n255\n", width, height) > 0)
        fwrite(rgb, 3, pixels, file);
    free(rgb);
    return result;
}

int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message)
{
    int format = format_of(path);
    if (format == UNKNOWN)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: unknown ending of an image; known are .png, .ppm and .raw",
                           path);
    if (width < 1 || height < 1 || width > MAX_SIZE || height > MAX_SIZE)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: cannot write an image of %d x %d", path, width, height);
#ifndef WRITES_PNG
    if (format == PNG)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: this program was built without stb and zlib, which .png "
                           "needs; .ppm and .raw can be written", path);
#endif
    if (format == PNG && (int64_t)width * height * 4 > MAX_PNG_BYTES)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: %d x %d is too large for .png here; .ppm and .raw can hold "
                           "it", path, width, height);
    fxs_output output;
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    errno = 0;
    if (write_pixels(output.file, format, rgba, width, height))
        output.error = ENOMEM;
    return fxs_output_close(&output, message);
}

static int readable_size(int width, int height)
{
    return width >= 1 && height >= 1 && width <= MAX_SIZE && height <= MAX_SIZE &&
           (int64_t)width * height <= MAX_READ_PIXELS;
}

#ifdef FXS_WITH_STB
static const char *why_not_decoded(void)
{
    const char *reason = decoding.fault ? decoding.fault : stbi_failure_reason();
    return reason ? reason : "damaged";   /* stb_image does not always say */
}

static const char *read_png(FILE *file, uint8_t **rgba, int *width, int *height)
{
    int channels;
    if (!stbi_info_from_file(file, width, height, &channels))
        return "not a .png, .jpg or .ppm";
    if (!readable_size(*width, *height))
        return too_large;
    /* A row is its bytes and one more; stb_image doubles a room that does not do, as for interlaced pictures. */
    const size_t pixel_bytes = stbi_is_16_bit_from_file(file) ? 8 : 4;
    decoding.most = 2 * (pixel_bytes * (size_t)*width + 1) * (size_t)*height + LEAST_ROOM;
    *rgba = stbi_load_from_file(file, width, height, &channels, 4);
    return *rgba ? NULL : why_not_decoded();
}

/* A file, and whether stb_image read on at its end. */
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

static int at_end(void *argument)
{
    return feof(((jpeg_stream *)argument)->file);
}

/* stb_image takes what is missing at the end as 0, or not, by its version: here a picture is whole or refused. */
static const char *read_jpeg(FILE *file, uint8_t **rgba, int *width, int *height)
{
    static const stbi_io_callbacks calls = {read_stream, skip_stream, at_end};
    jpeg_stream stream = {file, 0};
    struct stat status;
    int channels;
    if (!stbi_info_from_callbacks(&calls, &stream, width, height, &channels))
        return stream.beyond ? cut_short : why_not_decoded();
    if (!readable_size(*width, *height))
        return too_large;
    if (fstat(fileno(file), &status) || (int64_t)*width * *height / MAX_JPEG_PIXELS > status.st_size)
        return "fewer bytes than a picture of its size has";
    rewind(file);
    stream.beyond = 0;
    decoding.most = 4 * ((size_t)*width + JPEG_UNIT) * ((size_t)*height + JPEG_UNIT) + LEAST_ROOM;
    *rgba = stbi_load_from_callbacks(&calls, &stream, width, height, &channels, 4);
    return stream.beyond ? cut_short : *rgba ? NULL : why_not_decoded();
}

static const char *read_by_stb(FILE *file, int first, uint8_t **rgba, int *width, int *height)
{
    decoding.most = LEAST_ROOM;
    decoding.fault = NULL;
    return first == 0xff ? read_jpeg(file, rgba, width, height) : read_png(file, rgba, width, height);
}
#else
static const char *read_by_stb(FILE *file, int first, uint8_t **rgba, int *width, int *height)
{
    (void)file, (void)first, (void)rgba, (void)width, (void)height;
    return no_stb;
}
#endif

/* A number of a .ppm's header, after blanks and comments and with the blank that follows; -1 where there is none. */
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

/* The readers return NULL or the fault. */

/* stb_image 2.27 has a .ppm reader too, but takes a file that is cut short. */
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
    uint8_t *rgb = *rgba + pixels;   /* spread from the end of the room to the front */
    if (fread(rgb, 3, pixels, file) != pixels)
        return cut_short;
    for (size_t i = 0; i < pixels; i++) {
        memmove(*rgba + 4 * i, rgb + 3 * i, 3);
        (*rgba)[4 * i + 3] = 255;
    }
    return NULL;
}

/* Of a FIFO it does not wait for the writer. */
static int open_regular(const char *path, FILE **file, fxs_message *message)
{
    struct stat status;
    int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC), result = 0;
    *file = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
    if (!*file) {
        result = fxs_fail_errno(message, path, errno);
        if (descriptor >= 0)
            close(descriptor);
    } else if (fstat(descriptor, &status) || !S_ISREG(status.st_mode)) {
        result = fxs_fail(message, "%s: %s", path, S_ISDIR(status.st_mode) ? strerror(EISDIR) : "not a regular file");
        fclose(*file);
    }
    return result;
}

static int fail_read(const char *path, const char *fault, fxs_message *message)
{
    const int error = fault == out_of_memory ? FXS_ERR_MEMORY : fault == no_stb ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
    return fxs_fail_as(error, message, "%s: %s", path, fault);
}

int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message)
{
    FILE *file;
    int result = 0;
    *rgba = NULL;
    FXS_TRY(open_regular(path, &file, message));
    const int first = getc(file);
    rewind(file);
    const char *fault = first == 'P' ? read_ppm(file, rgba, width, height)
                                     : read_by_stb(file, first, rgba, width, height);
    if (fault) {
        result = ferror(file) ? fxs_fail_errno(message, path, errno) : fail_read(path, fault, message);
        free(*rgba);
        *rgba = NULL;
    }
    fclose(file);
    return result;
}
