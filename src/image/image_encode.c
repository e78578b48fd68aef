#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/base/output_internal.h"
#include "png_internal.h"

#ifdef FXS_WITH_STB
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STBIW_ASSERT(condition) ((void)(condition))
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#endif
#ifdef FXS_WITH_WEBP
#include <webp/decode.h>
#include <webp/encode.h>
#endif

enum { MAX_SIZE = 16384 };

enum fxs_image_format fxs_image_format_of(const char *path)
{
    static const struct {
        const char *ending;
        enum fxs_image_format format;
    } known[] = {{".png", FXS_IMAGE_PNG},   {".ppm", FXS_IMAGE_PPM}, {".raw", FXS_IMAGE_RAW},  {".jpg", FXS_IMAGE_JPG},
                 {".jpeg", FXS_IMAGE_JPG}, {".webp", FXS_IMAGE_WEBP}, {".y4m", FXS_IMAGE_Y4M},
                 {".rgba", FXS_IMAGE_RGBA}, {".mp4", FXS_IMAGE_MP4}, {".webm", FXS_IMAGE_WEBM},
                 {".gif", FXS_IMAGE_GIF}};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof known / sizeof *known; i++)
        if (!strcasecmp(dot, known[i].ending))
            return known[i].format;
    return FXS_IMAGE_UNKNOWN;
}

int fxs_image_file_known(const char *path)
{
    const enum fxs_image_format format = fxs_image_format_of(path);
    return format >= FXS_IMAGE_PNG && format <= FXS_IMAGE_WEBP;
}

uint8_t *fxs_encoded_room(fxs_encoded *encoded, size_t bytes)
{
    if (bytes > encoded->room) {
        free(encoded->memory);
        encoded->memory = malloc(bytes);
        encoded->room = encoded->memory ? bytes : 0;
    }
    return encoded->memory;
}

int fxs_image_opaque(const uint8_t *rgba, size_t pixels)
{
    for (size_t i = 0; i < pixels; i++)
        if (rgba[4 * i + 3] != 255)
            return 0;
    return 1;
}

static int encode_ppm(const uint8_t *rgba, int width, int height, fxs_encoded *ppm)
{
    const size_t pixels = (size_t)width * (size_t)height;
    uint8_t *bytes = fxs_encoded_room(ppm, 32 + 3 * pixels), *out = bytes;
    if (!bytes)
        return FXS_ERR_MEMORY;
    out += sprintf((char *)out, "P6\n%d %d\n255\n", width, height);
    for (size_t i = 0; i < pixels; i++, out += 3)
        memcpy(out, rgba + 4 * i, 3);
    ppm->bytes = bytes;
    ppm->size = (size_t)(out - bytes);
    return 0;
}

/* Converts RGB to YCbCr by BT.709 in 8 bits, limited range, with factors in Q16. Y = 16 + 219/255 (0.2126 R + 0.7152 G
   + 0.0722 B), Cb = 128 + 224/255 (B - Y') / 1.8556, Cr = 128 + 224/255 (R - Y') / 1.5748; Y' is the sum in
   brackets. */
static int encode_y4m(const uint8_t *rgba, int width, int height, fxs_encoded *y4m)
{
    static const char head[6] = "FRAME\n";
    const size_t pixels = (size_t)width * (size_t)height, size = sizeof head + 3 * pixels;
    uint8_t *bytes = fxs_encoded_room(y4m, size), *out = bytes + sizeof head;
    if (!bytes)
        return FXS_ERR_MEMORY;
    memcpy(bytes, head, sizeof head);
    for (size_t i = 0; i < pixels; i++) {
        const int32_t r = rgba[4 * i], g = rgba[4 * i + 1], b = rgba[4 * i + 2];
        out[i] = (uint8_t)((11966 * r + 40254 * g + 4064 * b + (16 << 16) + 32768) >> 16);
        out[pixels + i] = (uint8_t)((28785 * b - 6596 * r - 22189 * g + (128 << 16) + 32768) >> 16);
        out[2 * pixels + i] = (uint8_t)((28785 * r - 26146 * g - 2639 * b + (128 << 16) + 32768) >> 16);
    }
    y4m->bytes = bytes;
    y4m->size = size;
    return 0;
}

#ifdef FXS_WITH_STB
typedef struct growing {
    fxs_encoded *encoded;
    int failed;
} growing;

static void append(void *argument, void *data, int size)
{
    growing *g = argument;
    fxs_encoded *e = g->encoded;
    if (e->size + (size_t)size > e->room) {
        const size_t room = 2 * e->room + (size_t)size + 65536;
        void *larger = realloc(e->memory, room);
        g->failed |= !larger;
        e->memory = larger ? larger : e->memory;
        e->room = larger ? room : e->room;
    }
    if (g->failed)
        return;
    memcpy((uint8_t *)e->memory + e->size, data, (size_t)size);
    e->size += (size_t)size;
}

static int encode_jpg(const uint8_t *rgba, int width, int height, int quality, fxs_encoded *jpg)
{
    growing g = {jpg, 0};
    jpg->size = 0;
    const int written = stbi_write_jpg_to_func(append, &g, width, height, 4, rgba, quality ? quality : 95);
    jpg->bytes = jpg->memory;
    return written && !g.failed ? 0 : FXS_ERR_MEMORY;
}
#else
static int encode_jpg(const uint8_t *rgba, int width, int height, int quality, fxs_encoded *jpg)
{
    (void)rgba, (void)width, (void)height, (void)quality, (void)jpg;
    return FXS_ERR_UNSUPPORTED;
}
#endif

#ifdef FXS_WITH_WEBP
/* Checks that a lossless .webp decodes to the original pixels, because libwebp 1.2.4 may truncate it when memory runs
   out. */
static int holds(const WebPMemoryWriter *webp, const uint8_t *rgba, int width, int height)
{
    const size_t bytes = 4 * (size_t)width * (size_t)height;
    void *spare = malloc(2 * bytes + (1 << 22));
    int w = 0, h = 0;
    free(spare);
    uint8_t *read = spare ? WebPDecodeRGBA(webp->mem, webp->size, &w, &h) : NULL;
    const int same = read && w == width && h == height && !memcmp(read, rgba, bytes);
    WebPFree(read);
    return same;
}

static int encode_webp(const uint8_t *rgba, int width, int height, int quality, fxs_encoded *webp)
{
    WebPConfig config;
    WebPPicture picture;
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    if (!WebPConfigInit(&config) || !WebPPictureInit(&picture))
        return FXS_ERR_UNSUPPORTED;
    if (!quality && !WebPConfigLosslessPreset(&config, 0))
        return FXS_ERR_UNSUPPORTED;
    config.quality = quality ? (float)quality : config.quality;
    config.exact = 1;
    picture.use_argb = !quality;
    picture.width = width;
    picture.height = height;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    const int written = WebPPictureImportRGBA(&picture, rgba, 4 * width) && WebPEncode(&config, &picture) &&
                        (quality || holds(&writer, rgba, width, height));
    uint8_t *bytes = written ? fxs_encoded_room(webp, writer.size) : NULL;
    if (bytes) {
        webp->bytes = memcpy(bytes, writer.mem, writer.size);
        webp->size = writer.size;
    }
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
    return bytes ? 0 : FXS_ERR_MEMORY;
}
#else
static int encode_webp(const uint8_t *rgba, int width, int height, int quality, fxs_encoded *webp)
{
    (void)rgba, (void)width, (void)height, (void)quality, (void)webp;
    return FXS_ERR_UNSUPPORTED;
}
#endif

static int encode(enum fxs_image_format format, int quality, const uint8_t *rgba, int width, int height,
                  fxs_encoded *encoded)
{
    const size_t pixels = (size_t)width * (size_t)height;
    switch (format) {
    case FXS_IMAGE_PNG:
        return fxs_png_encode(fxs_image_opaque(rgba, pixels) ? FXS_PNG_RGB : FXS_PNG_RGBA, rgba, width, height,
                              encoded);
    case FXS_IMAGE_PPM: return encode_ppm(rgba, width, height, encoded);
    case FXS_IMAGE_Y4M:
    case FXS_IMAGE_MP4:
    case FXS_IMAGE_WEBM:
    case FXS_IMAGE_GIF: return encode_y4m(rgba, width, height, encoded);
    case FXS_IMAGE_JPG: return encode_jpg(rgba, width, height, quality, encoded);
    case FXS_IMAGE_WEBP: return encode_webp(rgba, width, height, quality, encoded);
    case FXS_IMAGE_RAW:
    case FXS_IMAGE_RGBA:
        encoded->bytes = rgba;
        encoded->size = 4 * pixels;
        return 0;
    default: return FXS_ERR_ARGUMENT;
    }
}

int fxs_image_encode(enum fxs_image_format format, int quality, const uint8_t *rgba, int width, int height,
                     fxs_encoded *encoded, fxs_message *message)
{
    static const char *const libraries[] = {[FXS_IMAGE_PNG] = "zlib, which .png", [FXS_IMAGE_JPG] = "stb, which .jpg",
                                            [FXS_IMAGE_WEBP] = "libwebp, which .webp"};
    const int most = format == FXS_IMAGE_WEBP ? MAX_SIZE - 1 : MAX_SIZE;
    if (width < 1 || height < 1 || width > most || height > most || quality < 0 || quality > 100)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "cannot write an image of %d x %d and quality %d", width, height,
                           quality);
    const int result = encode(format, quality, rgba, width, height, encoded);
    if (result == FXS_ERR_MEMORY)
        return fxs_fail_memory(message, NULL, 0);
    if (result == FXS_ERR_UNSUPPORTED)
        return fxs_fail_as(result, message, "this program was built without %s needs; .ppm and .raw can be written",
                           libraries[format]);
    return result ? fxs_fail_as(result, message, "unknown format of an image") : 0;
}

void fxs_encoded_free(fxs_encoded *encoded)
{
    free(encoded->memory);
    memset(encoded, 0, sizeof *encoded);
}

int fxs_encoded_write(const char *path, const fxs_encoded *encoded, fxs_message *message)
{
    fxs_output output;
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    fxs_output_write(&output, encoded->bytes, encoded->size, message);
    return fxs_output_close(&output, message);
}

int fxs_image_file_write(const char *path, const uint8_t *rgba, int width, int height, fxs_message *message)
{
    fxs_encoded encoded = {NULL, 0, NULL, 0};
    fxs_message why;
    if (!fxs_image_file_known(path))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: unknown ending of an image; known are .png, .ppm, .raw, "
                           ".jpg and .webp", path);
    int result = fxs_image_encode(fxs_image_format_of(path), 0, rgba, width, height, &encoded, &why);
    if (result)
        fxs_fail_as(result, message, "%s: %s", path, why.text);
    else
        result = fxs_encoded_write(path, &encoded, message);
    fxs_encoded_free(&encoded);
    return result;
}
