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

#ifdef FXS_WITH_JPEG
#include <jpeglib.h>
#include <jerror.h>
#include <setjmp.h>
#endif

#define MAX_SIZE 16384
#define MAX_READ_PIXELS (1 << 26)
#define LEAST_ROOM (1 << 16)      /* for the data of any .png: they may be stored, or in many parts */
#define MAX_JPEG_PIXELS 512       /* of a byte: the first scan has at least a bit for each 8 x 8 of them */
#define MAX_JPEG_SCANS 100        /* each may be a few bytes long, and takes time for all of the picture */

/* Faults of a picture that are not the file's. */
static const char out_of_memory[] = "out of memory";
static const char no_stb[] = "not a .jpg or .ppm; this program was built without stb, which .png needs";
static const char no_jpeg[] = "a .jpg; this program was built without libjpeg-turbo, which .jpg needs";
static const char cut_short[] = "cut short";

#ifdef FXS_WITH_STB
static const char too_much_data[] = "more data than a picture of its size has";

/* The bytes that stb_image may have in one piece for the picture that this thread reads, and why it got none. */
static __thread struct {
    size_t most;
    const char *fault;
} decoding;

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
#define STBI_MAX_DIMENSIONS MAX_SIZE
#define STBI_MALLOC(size) bounded_realloc(NULL, size)
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

/* The readers return NULL or the fault. */

#ifdef FXS_WITH_STB
static const char *read_png(FILE *file, uint8_t **rgba, int *width, int *height)
{
    int channels;
    decoding.most = LEAST_ROOM;
    decoding.fault = NULL;
    if (!stbi_info_from_file(file, width, height, &channels))
        return "not a .png, .jpg or .ppm";
    if (!readable_size(*width, *height))
        return too_large;
    /* A row is its bytes and one more; stb_image doubles a room that does not do, as for interlaced pictures. */
    const size_t pixel_bytes = stbi_is_16_bit_from_file(file) ? 8 : 4;
    decoding.most = 2 * (pixel_bytes * (size_t)*width + 1) * (size_t)*height + LEAST_ROOM;
    *rgba = stbi_load_from_file(file, width, height, &channels, 4);
    if (*rgba)
        return NULL;
    const char *reason = decoding.fault ? decoding.fault : stbi_failure_reason();
    return reason ? reason : "damaged";   /* stb_image does not always say */
}
#else
static const char *read_png(FILE *file, uint8_t **rgba, int *width, int *height)
{
    (void)file, (void)rgba, (void)width, (void)height;
    return no_stb;
}
#endif

#ifdef FXS_WITH_JPEG
/* A .jpg that libjpeg reads: the fault that ended it, and the place to go on from then. */
typedef struct jpeg_reading {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    const char *fault;
    jmp_buf refused;
} jpeg_reading;

static void refuse(void *jpeg, const char *fault)
{
    jpeg_reading *reading = ((j_common_ptr)jpeg)->client_data;
    reading->fault = fault;
    longjmp(reading->refused, 1);
}

static void refuse_by_code(j_common_ptr jpeg)
{
    static __thread char words[JMSG_LENGTH_MAX];
    const int code = jpeg->err->msg_code;
    jpeg->err->format_message(jpeg, words);
    refuse(jpeg, code == JERR_OUT_OF_MEMORY ? out_of_memory : code == JWRN_JPEG_EOF ? cut_short : words);
}

/* libjpeg warns of damaged data and makes up their pixels: here a picture is whole or refused. Bytes between segments,
   which some cameras leave, do no harm. */
static void refuse_damage(j_common_ptr jpeg, int level)
{
    if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA)
        refuse_by_code(jpeg);
}

static void limit_scans(j_common_ptr jpeg)
{
    if (((j_decompress_ptr)jpeg)->input_scan_number > MAX_JPEG_SCANS)
        refuse(jpeg, "more scans than a picture needs");
}

/* By the inverse cosine transform in integers and smooth chroma: libjpeg-turbo has both alike for every processor. */
static void decode_jpeg(jpeg_reading *reading, FILE *file, uint64_t bytes, uint8_t **rgba)
{
    j_decompress_ptr jpeg = &reading->jpeg;
    if (setjmp(reading->refused))
        return;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &reading->progress;
    jpeg_stdio_src(jpeg, file);
    jpeg_read_header(jpeg, TRUE);
    const uint64_t pixels = (uint64_t)jpeg->image_width * jpeg->image_height;
    if (!readable_size((int)jpeg->image_width, (int)jpeg->image_height))
        refuse(jpeg, too_large);
    if (pixels / MAX_JPEG_PIXELS > bytes)
        refuse(jpeg, "fewer bytes than a picture of its size has");
    *rgba = malloc(4 * (size_t)pixels);
    if (!*rgba)
        refuse(jpeg, out_of_memory);
    jpeg->out_color_space = JCS_EXT_RGBA;
    jpeg->dct_method = JDCT_ISLOW;
    jpeg->do_fancy_upsampling = TRUE;
    jpeg->do_block_smoothing = FALSE;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height)
        jpeg_read_scanlines(jpeg, &(JSAMPROW){*rgba + 4 * (size_t)jpeg->image_width * jpeg->output_scanline}, 1);
    jpeg_finish_decompress(jpeg);
}

static const char *read_jpeg(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    jpeg_reading reading = {.progress.progress_monitor = limit_scans};
    reading.jpeg.err = jpeg_std_error(&reading.errors);
    reading.jpeg.client_data = &reading;
    reading.errors.error_exit = refuse_by_code;
    reading.errors.emit_message = refuse_damage;
    decode_jpeg(&reading, file, bytes, rgba);
    *width = (int)reading.jpeg.image_width;
    *height = (int)reading.jpeg.image_height;
    jpeg_destroy_decompress(&reading.jpeg);
    return reading.fault;
}
#else
static const char *read_jpeg(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    (void)file, (void)bytes, (void)rgba, (void)width, (void)height;
    return no_jpeg;
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

static int fail_read(const char *path, const char *fault, fxs_message *message)
{
    const int unsupported = fault == no_stb || fault == no_jpeg;
    const int error = fault == out_of_memory ? FXS_ERR_MEMORY : unsupported ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
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
                        : first == 0xff ? read_jpeg(file, facts.size, rgba, width, height)
                                        : read_png(file, rgba, width, height);
    if (fault) {
        result = ferror(file) ? fxs_fail_errno(message, path, errno) : fail_read(path, fault, message);
        free(*rgba);
        *rgba = NULL;
    }
    fclose(file);
    return result;
}
