/* Writes targets (output pictures) to files: depths (.png, .pfm, .exr) and ids of Gaussians (.png, .raw). */
#include "depth_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "png_internal.h"

static int ends_with(const char *path, const char *ending)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ending);
}

int fxs_depth_file_known(const char *path)
{
    return ends_with(path, ".png") || ends_with(path, ".pfm") || ends_with(path, ".exr");
}

int fxs_id_file_known(const char *path)
{
    return ends_with(path, ".png") || ends_with(path, ".raw");
}

static int fail_file(int error, const char *path, const char *why, fxs_message *message)
{
    fxs_fail(message, "%s: %s", path, why);
    return error;
}

static int write_file(const char *path, const void *bytes, size_t size, fxs_message *message)
{
    const fxs_encoded file = {bytes, size, NULL, 0};
    return fxs_encoded_write(path, &file, message);
}

double fxs_depths_farthest(const fxs_depths *d)
{
    uint32_t farthest = 0;
    const size_t count = (size_t)d->width * (size_t)d->height;
    for (size_t i = 0; i < count; i++)
        if (d->pixels[i] != FXS_NOTHING && d->pixels[i] > farthest)
            farthest = d->pixels[i];
    return ldexp(farthest, -d->depth_bits);
}

/* Converts a depth to a grey value, 1 to 65535, clamped; 0: no depth. */
static unsigned grey(uint32_t depth, uint64_t range)
{
    const uint64_t value = ((uint64_t)depth * 65535 + range / 2) / range;
    return depth == FXS_NOTHING ? 0 : value < 1 ? 1 : value < 65535 ? (unsigned)value : 65535;
}

static int write_png(const char *path, const fxs_depths *d, double range, fxs_message *message)
{
    const size_t count = (size_t)d->width * (size_t)d->height;
    const double whole = floor(ldexp(range, d->depth_bits) + 0.5);
    const uint64_t most = whole < 1 ? 1 : whole < 0x1p62 ? (uint64_t)whole : (uint64_t)1 << 62;
    uint8_t *pixels = malloc(2 * count);
    fxs_encoded png = {NULL, 0, NULL, 0};
    for (size_t i = 0; i < count && pixels; i++) {
        const unsigned value = grey(d->pixels[i], most);
        pixels[2 * i] = (uint8_t)(value >> 8);
        pixels[2 * i + 1] = (uint8_t)value;
    }
    int error = pixels ? fxs_png_encode(FXS_PNG_GREY_16, pixels, d->width, d->height, &png) : FXS_ERR_MEMORY;
    free(pixels);
    if (!error)
        error = fxs_encoded_write(path, &png, message);
    else if (error == FXS_ERR_MEMORY)
        fail_file(error, path, "out of memory", message);
    else
        fail_file(error, path, "this program was built without zlib, which .png needs; .pfm and .exr can be written",
                  message);
    fxs_encoded_free(&png);
    return error;
}

static unsigned char *put_little_32(unsigned char *out, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *out++ = (unsigned char)(value >> 8 * i);
    return out;
}

static unsigned char *put_depths(unsigned char *out, const fxs_depths *d, int y)
{
    for (int x = 0; x < d->width; x++) {
        const uint32_t depth = d->pixels[(size_t)y * (size_t)d->width + (size_t)x];
        const float value = depth == FXS_NOTHING ? INFINITY : (float)ldexp(depth, -d->depth_bits);
        uint32_t code;
        memcpy(&code, &value, sizeof code);
        out = put_little_32(out, code);
    }
    return out;
}

static int write_pfm(const char *path, const fxs_depths *d, fxs_message *message)
{
    unsigned char *bytes = malloc(64 + 4 * (size_t)d->width * (size_t)d->height);
    if (!bytes)
        return fail_file(FXS_ERR_MEMORY, path, "out of memory", message);
    unsigned char *out = bytes + sprintf((char *)bytes, "Pf\n%d %d\n-1.0\n", d->width, d->height);
    for (int y = d->height - 1; y >= 0; y--)
        out = put_depths(out, d, y);
    const int error = write_file(path, bytes, (size_t)(out - bytes), message);
    free(bytes);
    return error;
}

/* Writes the header of an OpenEXR file without compression, with the channel Z in floats. */
static unsigned char *put_exr_header(unsigned char *out, const fxs_depths *d)
{
    static const char first[] = "v/1\1\2\0\0\0channels\0chlist\0\23\0\0\0Z\0\2\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0\0"
                                "compression\0compression\0\1\0\0\0", zeros[] = "box2i\0\20\0\0\0\0\0\0\0\0\0\0";
    static const char last[] = "lineOrder\0lineOrder\0\1\0\0\0\0pixelAspectRatio\0float\0\4\0\0\0\0\0\x80?"
                               "screenWindowCenter\0v2f\0\10\0\0\0\0\0\0\0\0\0\0\0"
                               "screenWindowWidth\0float\0\4\0\0\0\0\0\x80?";
    static const char *const windows[] = {"dataWindow", "displayWindow"};
    out = (unsigned char *)memcpy(out, first, sizeof first) + sizeof first;
    for (int i = 0; i < 2; i++) {
        out += sprintf((char *)out, "%s", windows[i]) + 1;
        memcpy(out, zeros, sizeof zeros);
        out = put_little_32(put_little_32(out + sizeof zeros, (uint32_t)d->width - 1), (uint32_t)d->height - 1);
    }
    return (unsigned char *)memcpy(out, last, sizeof last) + sizeof last;
}

/* After the header come the place of each row in the file, 8 bytes each, and the rows: y, size in bytes, floats. */
static int write_exr(const char *path, const fxs_depths *d, fxs_message *message)
{
    const uint64_t height = (uint64_t)d->height, row = 8 + 4 * (uint64_t)d->width;
    unsigned char *bytes = malloc((size_t)(1024 + height * (8 + row)));
    if (!bytes)
        return fail_file(FXS_ERR_MEMORY, path, "out of memory", message);
    unsigned char *out = put_exr_header(bytes, d);
    const uint64_t start = (uint64_t)(out - bytes) + 8 * height;
    for (uint64_t y = 0; y < height; y++)
        out = put_little_32(put_little_32(out, (uint32_t)(start + y * row)), (uint32_t)((start + y * row) >> 32));
    for (int y = 0; y < d->height; y++)
        out = put_depths(put_little_32(put_little_32(out, (uint32_t)y), 4 * (uint32_t)d->width), d, y);
    const int error = write_file(path, bytes, (size_t)(out - bytes), message);
    free(bytes);
    return error;
}

int fxs_depth_file_write(const char *path, const fxs_depths *depths, double range, fxs_message *message)
{
    if (ends_with(path, ".pfm"))
        return write_pfm(path, depths, message);
    if (ends_with(path, ".exr"))
        return write_exr(path, depths, message);
    if (!ends_with(path, ".png"))
        return fail_file(FXS_ERR_ARGUMENT, path, "unknown ending of a depth picture; known are .png, .pfm and .exr",
                         message);
    if (!(range > 0))
        return fail_file(FXS_ERR_ARGUMENT, path, "the range of depths is not above 0", message);
    return write_png(path, depths, range, message);
}

static uint32_t scramble(uint32_t x)
{
    x = (x ^ x >> 16) * 0x45d9f3bu;
    x = (x ^ x >> 16) * 0x45d9f3bu;
    return x ^ x >> 16;
}

/* Computes a colour of a hue (0 to 1535), with white (0 to 255) mixed in. */
static void colour_of(uint8_t rgb[3], uint32_t hue, uint32_t white, uint32_t value)
{
    for (uint32_t c = 0; c < 3; c++) {
        const uint32_t at = (hue + 512 * c) % 1536;
        const uint32_t full = at < 256 ? at : at < 768 ? 255 : at < 1024 ? 1023 - at : 0;
        rgb[c] = (uint8_t)((full * (255 - white) + 255 * white) * value / (255 * 255));
    }
}

static void paint(uint8_t rgba[4], const fxs_id *id, int by_object)
{
    const uint32_t mixed = scramble(id->gaussian);
    rgba[0] = rgba[1] = rgba[2] = 0;
    rgba[3] = 255;
    if (id->gaussian == FXS_NOTHING)
        return;
    if (by_object)                           /* the golden section spreads the hues of objects with consecutive ids */
        colour_of(rgba, (uint32_t)((uint64_t)(id->object * 0x9e3779b9u) * 1536 >> 32), 40, 120 + mixed % 136);
    else
        colour_of(rgba, mixed % 1536, mixed >> 12 & 127, 128 + (mixed >> 20 & 127));
}

static int write_colours(const char *path, const fxs_id *ids, int width, int height, int by_object,
                         fxs_message *message)
{
    const size_t count = (size_t)width * (size_t)height;
    uint8_t *rgba = malloc(4 * count);
    if (!rgba)
        return fail_file(FXS_ERR_MEMORY, path, "out of memory", message);
    for (size_t i = 0; i < count; i++)
        paint(rgba + 4 * i, &ids[i], by_object);
    const int failed = fxs_image_file_write(path, rgba, width, height, message);
    free(rgba);
    return failed ? FXS_ERR_FILE : 0;
}

static int write_numbers(const char *path, const fxs_id *ids, size_t count, fxs_message *message)
{
    unsigned char *bytes = malloc(8 * count), *out = bytes;
    if (!bytes)
        return fail_file(FXS_ERR_MEMORY, path, "out of memory", message);
    for (size_t i = 0; i < count; i++)
        out = put_little_32(put_little_32(out, ids[i].object), ids[i].gaussian);
    const int error = write_file(path, bytes, 8 * count, message);
    free(bytes);
    return error;
}

int fxs_id_file_write(const char *path, const fxs_id *ids, int width, int height, int by_object, fxs_message *message)
{
    if (ends_with(path, ".raw"))
        return write_numbers(path, ids, (size_t)width * (size_t)height, message);
    if (!ends_with(path, ".png"))
        return fail_file(FXS_ERR_ARGUMENT, path, "unknown ending of an id picture; known are .png and .raw", message);
    return write_colours(path, ids, width, height, by_object, message);
}
