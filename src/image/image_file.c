/* Decodes .png, .jpg, .webp, HEIF and .ppm, chosen by the first bytes. A picture is read completely or refused.
 * Limits on pixels per byte of the file and on scans keep small files from taking much memory or time. */
#include <fixsplat/image.h>

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/files_internal.h"
#include "src/base/foreign.h"
#include "src/base/opened.h"
#include "src/base/try_internal.h"
#include "photograph_internal.h"

#ifdef FXS_WITH_PNG
#include <png.h>
#endif
#ifdef FXS_WITH_JPEG
#include <jpeglib.h>
#include <jerror.h>
#endif
#ifdef FXS_WITH_WEBP
#include <webp/decode.h>
#endif
#include <setjmp.h>

#define MAX_SIZE 16384
#define MAX_READ_PIXELS (1 << 26)
#define FREE_PIXELS (1 << 20)
#define MAX_BYTE_PIXELS 512       /* largest number of pixels per byte of a compressed file */
#define MAX_WEBP_BYTES (1 << 28)
#define MAX_JPEG_SCANS 100        /* largest number of JPEG scans: even a scan of a few bytes takes time for the whole
                                     picture */

static const char no_png[] = "a .png; this program was built without libpng, which .png needs";
static const char no_jpeg[] = "a .jpg; this program was built without libjpeg-turbo, which .jpg needs";
static const char no_webp[] = "a .webp; this program was built without libwebp, which .webp needs";
static const char no_picture[] = "not a .png, .jpg, .webp, .heic or .ppm (P6)";
static const char cut_short[] = "cut short";
static const char too_large[] = "without pixels, or more than 16384 on a side or 2^26 in all";

static int readable_size(int width, int height)
{
    return width >= 1 && height >= 1 && width <= MAX_SIZE && height <= MAX_SIZE &&
           (int64_t)width * height <= MAX_READ_PIXELS;
}

const char *fxs_image_refusal(int width, int height, uint64_t bytes)
{
    if (!readable_size(width, height))
        return too_large;
    const uint64_t pixels = (uint64_t)width * (uint64_t)height;
    return pixels > FREE_PIXELS && pixels / MAX_BYTE_PIXELS > bytes
               ? "more than 2^20 pixels, and more than 512 a byte of the file; as a .ppm, which is not compressed, it "
                 "can be read"
               : NULL;
}

#if defined(FXS_WITH_PNG) || defined(FXS_WITH_JPEG)
typedef struct decoding {
    const char *fault;
    jmp_buf refused;
} decoding;

static void refuse(decoding *picture, const char *fault)
{
    picture->fault = fault;
    longjmp(picture->refused, 1);
}

static void make_room(decoding *picture, uint8_t **rgba, int width, int height, uint64_t bytes)
{
    const char *fault = fxs_image_refusal(width, height, bytes);
    if (fault)
        refuse(picture, fault);
    *rgba = malloc(4 * (size_t)width * (size_t)height);
    if (!*rgba)
        refuse(picture, fxs_no_memory);
}
#endif

#ifdef FXS_WITH_PNG
/* Refuses a damaged .png. libpng also calls this for warnings, after which it would skip damaged parts. */
static void refuse_png(png_structp png, const char *fault)
{
    static __thread char words[200];
    snprintf(words, sizeof words, "%s", fault);
    refuse(png_get_error_ptr(png), words);
}

static void *allocate(png_structp png, size_t size)
{
    void *made = malloc(size);
    if (!made)
        refuse(png_get_error_ptr(png), fxs_no_memory);
    return made;
}

static void read_bytes(png_structp png, uint8_t *bytes, size_t size)
{
    if (fread(bytes, 1, size, png_get_io_ptr(png)) != size)
        refuse(png_get_error_ptr(png), cut_short);
}

typedef struct png_reading {
    decoding picture;
    png_structp png;
    png_infop info;
} png_reading;

/* Decodes a .png, ignoring gamma and colour profiles. A pixel with an index beyond the palette becomes black. */
static void decode_png(png_reading *reading, FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    decoding *picture = &reading->picture;
    if (setjmp(picture->refused))
        return;
    png_structp png = reading->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, picture, refuse_png, refuse_png,
                                                              picture, allocate, NULL);
    png_infop info = reading->info = png_create_info_struct(png);
    png_set_read_fn(png, file, read_bytes);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_chunk_malloc_max(png, 0);
    png_read_info(png, info);
    *width = (int)png_get_image_width(png, info);
    *height = (int)png_get_image_height(png, info);
    make_room(picture, rgba, *width, *height, bytes);
    png_set_expand(png);
    png_set_strip_16(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
    for (int passes = png_set_interlace_handling(png); passes > 0; passes--)
        for (int y = 0; y < *height; y++)
            png_read_row(png, *rgba + 4 * (size_t)*width * (size_t)y, NULL);
    png_read_end(png, NULL);
}

static const char *read_png(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    png_reading reading = {.png = NULL};
    decode_png(&reading, file, bytes, rgba, width, height);
    png_destroy_read_struct(&reading.png, &reading.info, NULL);
    return reading.picture.fault;
}
#else
static const char *read_png(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    (void)file, (void)bytes, (void)rgba, (void)width, (void)height;
    return no_png;
}
#endif

#ifdef FXS_WITH_JPEG
typedef struct jpeg_reading {
    decoding picture;
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
} jpeg_reading;

static void refuse_by_code(j_common_ptr jpeg)
{
    static __thread char words[JMSG_LENGTH_MAX];
    const int code = jpeg->err->msg_code;
    jpeg->err->format_message(jpeg, words);
    refuse(jpeg->client_data, code == JERR_OUT_OF_MEMORY ? fxs_no_memory : code == JWRN_JPEG_EOF ? cut_short : words);
}

/* Turns libjpeg's warnings into errors. Extra bytes between segments, which some cameras write, are harmless. */
static void refuse_damage(j_common_ptr jpeg, int level)
{
    if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA)
        refuse_by_code(jpeg);
}

static void limit_scans(j_common_ptr jpeg)
{
    if (((j_decompress_ptr)jpeg)->input_scan_number > MAX_JPEG_SCANS)
        refuse(jpeg->client_data, "more scans than a picture needs");
}

/* Converts CMYK pixels to RGB without a colour profile: colour = (1 - ink) (1 - black). Adobe stores 1 - ink. */
static void to_rgba(uint8_t *pixels, size_t count, int is_inverted)
{
    const int flip = is_inverted ? 0 : 255;
    for (uint8_t *c = pixels; c < pixels + 4 * count; c += 4) {
        for (int i = 0; i < 3; i++)
            c[i] = (uint8_t)(((c[i] ^ flip) * (c[3] ^ flip) + 127) / 255);
        c[3] = 255;
    }
}

/* Decodes a .jpg with an integer inverse DCT and smooth chroma, which are identical on every processor. */
static void decode_jpeg(jpeg_reading *reading, FILE *file, uint64_t bytes, uint8_t **rgba, fxs_exif_bytes *exif)
{
    j_decompress_ptr jpeg = &reading->jpeg;
    decoding *picture = &reading->picture;
    if (setjmp(picture->refused))
        return;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &reading->progress;
    jpeg_stdio_src(jpeg, file);
    if (exif)
        jpeg_save_markers(jpeg, JPEG_APP0 + 1, 0xffff);
    jpeg_read_header(jpeg, TRUE);
    for (jpeg_saved_marker_ptr app1 = jpeg->marker_list; exif && app1; app1 = app1->next)
        if (app1->data_length > 6 && !memcmp(app1->data, "Exif\0", 6))
            fxs_exif_keep(exif, app1->data, app1->data_length);
    make_room(picture, rgba, (int)jpeg->image_width, (int)jpeg->image_height, bytes);
    const int is_cmyk = jpeg->jpeg_color_space == JCS_CMYK || jpeg->jpeg_color_space == JCS_YCCK;
    jpeg->out_color_space = is_cmyk ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg->dct_method = JDCT_ISLOW;
    jpeg->do_fancy_upsampling = TRUE;
    jpeg->do_block_smoothing = FALSE;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height)
        jpeg_read_scanlines(jpeg, &(JSAMPROW){*rgba + 4 * (size_t)jpeg->image_width * jpeg->output_scanline}, 1);
    if (is_cmyk)
        to_rgba(*rgba, (size_t)jpeg->image_width * jpeg->image_height, jpeg->saw_Adobe_marker);
    jpeg_finish_decompress(jpeg);
}

static const char *read_jpeg(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
    jpeg_reading reading = {.progress.progress_monitor = limit_scans};
    reading.jpeg.err = jpeg_std_error(&reading.errors);
    reading.jpeg.client_data = &reading.picture;
    reading.errors.error_exit = refuse_by_code;
    reading.errors.emit_message = refuse_damage;
    decode_jpeg(&reading, file, bytes, rgba, exif);
    *width = (int)reading.jpeg.image_width;
    *height = (int)reading.jpeg.image_height;
    jpeg_destroy_decompress(&reading.jpeg);
    return reading.picture.fault;
}
#else
static const char *read_jpeg(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
    (void)file, (void)bytes, (void)rgba, (void)width, (void)height, (void)exif;
    return no_jpeg;
}
#endif

static const char *read_webp(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
#ifdef FXS_WITH_WEBP
    if (bytes > MAX_WEBP_BYTES)
        return "more than 2^28 bytes";
    uint8_t *all = malloc((size_t)bytes + 1);
    if (!all)
        return fxs_no_memory;
    WebPBitstreamFeatures features;
    const char *fault = fread(all, 1, (size_t)bytes, file) != bytes ? cut_short
                        : WebPGetFeatures(all, (size_t)bytes, &features) != VP8_STATUS_OK ? "a damaged .webp"
                        : features.has_animation ? "a .webp of several pictures"
                        : fxs_image_refusal(features.width, features.height, bytes);
    if (!fault) {
        const size_t room = 4 * (size_t)features.width * (size_t)features.height;
        *width = features.width;
        *height = features.height;
        *rgba = malloc(room);
        errno = 0;
        if (!*rgba)
            fault = fxs_no_memory;
        else if (!WebPDecodeRGBAInto(all, (size_t)bytes, *rgba, room, 4 * features.width))
            fault = errno == ENOMEM ? fxs_no_memory : "a .webp that is damaged or cut short";
    }
    free(all);
    return fault;
#else
    (void)file, (void)bytes, (void)rgba, (void)width, (void)height;
    return no_webp;
#endif
}

static const char *read_heif(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
#ifdef FXS_WITH_HEIF
    return fxs_heif_read(file, bytes, rgba, width, height, exif);
#else
    (void)file, (void)bytes, (void)rgba, (void)width, (void)height, (void)exif;
    return fxs_no_heif;
#endif
}

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

static const char *read_ppm(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height)
{
    if (getc(file) != 'P' || getc(file) != '6')
        return no_picture;
    *width = header_number(file);
    *height = header_number(file);
    if (header_number(file) != 255)
        return "not a .ppm of 255 levels";
    if (!readable_size(*width, *height))
        return too_large;
    size_t pixels = (size_t)*width * (size_t)*height;
    if (3 * (uint64_t)pixels > bytes)
        return cut_short;
    *rgba = malloc(4 * pixels);
    if (!*rgba)
        return fxs_no_memory;
    uint8_t *rgb = *rgba + pixels;   /* RGB pixels are read into the end of the block, then spread to RGBA */
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
    const int unsupported = fault == no_png || fault == no_jpeg || fault == no_webp || fault == fxs_no_heif;
    const int error = fault == fxs_no_memory ? FXS_ERR_MEMORY : unsupported ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
    return fxs_fail_as(error, message, "%s: %s", path, fault);
}

static int fail_kind(const char *path, FILE *file, fxs_message *message)
{
    char head[512];
    rewind(file);
    const char *kind = fxs_foreign(head, fread(head, 1, sizeof head, file));
    return fxs_fail(message, "%s: %s%s%s", path, no_picture, kind ? ", but " : "", kind ? kind : "");
}

static const char *read_any(FILE *file, uint64_t bytes, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif)
{
    char head[12] = "";
    const size_t known = fread(head, 1, sizeof head, file);
    rewind(file);
    if (known == sizeof head && !memcmp(head, "RIFF", 4) && !memcmp(head + 8, "WEBP", 4))
        return read_webp(file, bytes, rgba, width, height);
    if (known == sizeof head && !memcmp(head + 4, "ftyp", 4))
        return read_heif(file, bytes, rgba, width, height, exif);
    return *head == 'P'      ? read_ppm(file, bytes, rgba, width, height)
           : *head == '\xff' ? read_jpeg(file, bytes, rgba, width, height, exif)
           : *head == '\x89' ? read_png(file, bytes, rgba, width, height)
                             : no_picture;
}

int fxs_photograph_read_bytes(const char *path, uint8_t **rgba, int *width, int *height, fxs_exif_bytes *exif,
                              fxs_message *message)
{
    FILE *file;
    fxs_file_facts facts;
    int result = 0;
    *rgba = NULL;
    FXS_TRY(fxs_file_open(path, &file, &facts, message));
    fxs_note_opened(facts.device, facts.inode);
    const char *fault = read_any(file, facts.size, rgba, width, height, exif);
    if (fault == no_picture && !ferror(file))
        result = fail_kind(path, file, message);
    else if (fault)
        result = ferror(file) ? fxs_fail_errno(message, path, errno) : fail_read(path, fault, message);
    if (fault) {
        free(*rgba);
        *rgba = NULL;
    }
    fclose(file);
    return result;
}

int fxs_image_file_read(const char *path, uint8_t **rgba, int *width, int *height, fxs_message *message)
{
    return fxs_photograph_read_bytes(path, rgba, width, height, NULL, message);
}
