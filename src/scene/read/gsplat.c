/* Reads a folder written by PngCompression of gsplat. meta.json has the bounds of each attribute. An attribute is
   stored as .png images with a pixel per Gaussian, one image per byte. shN.npz is a palette of SH. Positions are stored
   as sign(x) ln(1 + |x|). */
#include <string.h>

#include "src/scene/formats_internal.h"

/* Recognises a meta.json of gsplat. Files of the SOG format are also called meta.json but have other members. */
static int is_gsplat(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->name && strstr(head->bytes, "\"opacities\"") && strstr(head->bytes, "\"dtype\"") &&
           !strstr(head->bytes, "\"version\"");
}

#if defined(FXS_WITH_PNG) && defined(FXS_WITH_CJSON)

#include <math.h>
#include <stdlib.h>

#include <cjson/cJSON.h>
#include <png.h>

#include "src/base/byte_reader.h"
#include "src/base/exponential.h"
#include "src/base/zip_internal.h"

enum { SLACK = 1 << 16, MAX_PALETTE = 65536 };
enum { LOW, HIGH, SCALES, QUATS, OPACITIES, SH0, IMAGES };

static const struct { const char *attribute, *file; int channels; } images[IMAGES] = {
    {"means", "means_l.png", 3}, {"means", "means_u.png", 3}, {"scales", "scales.png", 3}, {"quats", "quats.png", 4},
    {"opacities", "opacities.png", 1}, {"sh0", "sh0.png", 3}
};

typedef struct gsplat {
    const fxs_scene_source *source;
    size_t count, at;
    double low[IMAGES][4], high[IMAGES][4];
    uint8_t *pixels[IMAGES];       /* decoded images as RGBA; a grey image has its channel three times */
    uint64_t sizes[IMAGES];
    int sh_degree;
    double sh_low, sh_high;
    int sh_most;
    fxs_text arrays[2];
    const uint8_t *palette, *labels;
    size_t entries, entry_step, value_step;
} gsplat;

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static double lerp(double a, double b, double t)
{
    return a * (1 - t) + b * t;
}

static size_t values_of(int degree)
{
    return 3 * (size_t)degree * (size_t)(degree + 2);
}

static int fail(const gsplat *g, const char *fault, fxs_message *message)
{
    return fxs_fail(message, "%s: %s", g->source->path, fault);
}

static const char *read_sh(gsplat *g, const cJSON *shn)
{
    const cJSON *low = member(shn, "mins"), *high = member(shn, "maxs"), *shape = member(shn, "shape");
    size_t coefficients, bits;
    if (!shn || (cJSON_GetArraySize(shape) == 3 && cJSON_GetArrayItem(shape, 1)->valuedouble == 0))
        return NULL;
    if (cJSON_GetArraySize(shape) != 3 || !fxs_json_whole(cJSON_GetArrayItem(shape, 1), 15, &coefficients))
        return "no valid \"shape\" of \"shN\"";
    while (g->sh_degree < 3 && values_of(g->sh_degree) < 3 * coefficients)
        g->sh_degree++;
    if (values_of(g->sh_degree) != 3 * coefficients)
        return "no valid \"shape\" of \"shN\"";
    if (!cJSON_IsNumber(low) || !cJSON_IsNumber(high))
        return "no valid \"mins\" and \"maxs\" of \"shN\"";
    if (!fxs_json_whole(member(shn, "quantization"), 8, &bits) || bits == 0)
        return "no valid \"quantization\" of \"shN\"";
    g->sh_low = low->valuedouble;
    g->sh_high = high->valuedouble;
    g->sh_most = (1 << bits) - 1;
    return NULL;
}

static int read_meta(gsplat *g, const cJSON *root, fxs_message *message)
{
    if (!fxs_json_whole(cJSON_GetArrayItem(member(member(root, "means"), "shape"), 0), INT32_MAX, &g->count))
        return fail(g, "no valid \"shape\" of \"means\"", message);
    for (int i = 0; i < IMAGES; i++) {
        const cJSON *attribute = member(root, images[i].attribute);
        if (!fxs_json_numbers(member(attribute, "mins"), g->low[i], images[i].channels) ||
            !fxs_json_numbers(member(attribute, "maxs"), g->high[i], images[i].channels))
            return fxs_fail(message, "%s: no valid \"mins\" and \"maxs\" of \"%s\"", g->source->path,
                            images[i].attribute);
    }
    const char *fault = read_sh(g, member(root, "shN"));
    return fault ? fail(g, fault, message) : 0;
}

static int load_meta(gsplat *g, fxs_message *message)
{
    fxs_text json;
    cJSON *root;
    FXS_TRY(fxs_scene_source_load(g->source, 0, g->source->input.size, &json, message));
    int result = fxs_json_parse(&json, g->source, &root, message);
    fxs_text_let_go(g->source, &json);
    if (result == 0)
        result = read_meta(g, root, message);
    cJSON_Delete(root);
    return result;
}

static int decode(gsplat *g, int image, const fxs_text *file, fxs_message *message)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    const int is_png = png_image_begin_read_from_memory(&png, file->data, file->size);
    const uint64_t pixels = is_png ? (uint64_t)png.width * png.height : 0;
    int result = !is_png ? fxs_fail(message, "%s: %s", file->path, png.message)
                 : pixels < g->count ? fxs_fail(message, "%s: fewer pixels than Gaussians", file->path)
                 : pixels / 2 > g->count + SLACK ? fxs_fail(message, "%s: far more pixels than Gaussians", file->path)
                                                 : 0;
    png.format = PNG_FORMAT_RGBA;
    if (result == 0 && !(g->pixels[image] = fxs_hold(g->source, 4 * pixels, message)))
        result = FXS_ERR_MEMORY;
    g->sizes[image] = 4 * pixels;
    if (result == 0 && !png_image_finish_read(&png, NULL, g->pixels[image], 0, NULL))
        result = fxs_fail(message, "%s: %s", file->path, png.message);
    png_image_free(&png);
    return result;
}

static int load_image(gsplat *g, int image, fxs_message *message)
{
    fxs_scene_source beside;
    fxs_text file = {.data = NULL};
    int result = fxs_scene_source_open_beside(&beside, g->source, images[image].file, message);
    if (result == 0)
        result = fxs_scene_source_load(&beside, 0, beside.input.size, &file, message);
    if (result == 0)
        result = decode(g, image, &file, message);
    if (file.data)
        fxs_text_let_go(g->source, &file);
    fxs_scene_source_close(&beside);
    return result;
}

/* Finds the numbers in the data of a .npy file (numpy.lib.format). Returns null if type or shape are not as expected.
   columns: expected columns; 0: the array has one dimension. */
static const uint8_t *find_array(const fxs_text *npy, const char *type, size_t size, size_t columns, size_t *rows,
                                 int *is_by_column)
{
    const uint8_t *bytes = (const uint8_t *)npy->data;
    if (npy->size < 12 || memcmp(bytes, "\x93NUMPY", 6))
        return NULL;
    const size_t start = bytes[6] == 1 ? 10 : 12;
    const size_t length = bytes[6] == 1 ? fxs_load_u16(bytes + 8) : fxs_load_u32(bytes + 8);
    if (length > npy->size - start)
        return NULL;
    const char *head = npy->data + start, *end = head + length;
    const char *order = strstr(head, "'fortran_order': "), *shape = strstr(head, "'shape': (");
    const char *kind = strstr(head, type);
    if (!order || !shape || !kind || order >= end || shape >= end || kind >= end)
        return NULL;
    char *rest;
    *is_by_column = !strncmp(order + 17, "True", 4);
    *rows = strtoull(shape + 10, &rest, 10);
    const size_t wide = *rest == ',' ? strtoull(rest + 1, NULL, 10) : 0;
    const size_t row = size * (columns ? columns : 1), left = npy->size - start - length;
    return wide == columns && *rows > 0 && *rows <= left / row ? bytes + start + length : NULL;
}

static int take_arrays(gsplat *g, fxs_message *message)
{
    const size_t values = values_of(g->sh_degree);
    size_t labels;
    int by_column, unused;
    g->palette = find_array(&g->arrays[0], "|u1", 1, values, &g->entries, &by_column);
    g->labels = find_array(&g->arrays[1], "<u2", 2, 0, &labels, &unused);
    if (!g->palette || g->entries > MAX_PALETTE)
        return fxs_fail(message, "%s: no valid \"centroids\" of %zu bytes each", g->arrays[0].path, values);
    if (!g->labels || labels < g->count)
        return fxs_fail(message, "%s: no valid \"labels\" of 16 bits for %zu Gaussians", g->arrays[1].path, g->count);
    g->entry_step = by_column ? 1 : values;
    g->value_step = by_column ? g->entries : 1;
    return 0;
}

static int load_sh(gsplat *g, fxs_message *message)
{
    static const char *const names[2] = {"centroids.npy", "labels.npy"};
    fxs_scene_source npz;
    fxs_zip *zip = NULL;
    if (!g->sh_degree)
        return 0;
    int result = fxs_scene_source_open_beside(&npz, g->source, "shN.npz", message);
    if (result == 0)
        result = fxs_zip_open(&npz, &zip, message);
    for (int i = 0; i < 2 && result == 0; i++)
        result = fxs_zip_load(zip, names[i], &g->arrays[i], message);
    fxs_zip_close(zip);
    if (result == 0)
        result = take_arrays(g, message);
    fxs_scene_source_close(&npz);
    return result;
}

static double value(const gsplat *g, int image, int channel, size_t i)
{
    return lerp(g->low[image][channel], g->high[image][channel], g->pixels[image][4 * i + (size_t)channel] / 255.0);
}

static void read_gaussian(const gsplat *g, size_t i, fxs_gaussian *out)
{
    memset(out, 0, sizeof *out);
    for (int c = 0; c < 3; c++) {
        const size_t at = 4 * i + (size_t)c;
        const int code = g->pixels[HIGH][at] << 8 | g->pixels[LOW][at];
        const double n = lerp(g->low[LOW][c], g->high[LOW][c], code / 65535.0);
        out->position[c] = (float)copysign(fxs_exp(fabs(n)) - 1, n);
        out->scale[c] = (float)value(g, SCALES, c, i);
        out->dc[c] = (float)value(g, SH0, c, i);
    }
    for (int c = 0; c < 4; c++)
        out->rotation[c] = (float)value(g, QUATS, c, i);
    out->opacity = (float)value(g, OPACITIES, 0, i);
    const size_t entry = g->sh_degree ? fxs_load_u16(g->labels + 2 * i) : 0;
    for (size_t k = 0; entry < g->entries && k < values_of(g->sh_degree); k++)
        out->sh[k] = (float)lerp(g->sh_low, g->sh_high,
                                 g->palette[entry * g->entry_step + k * g->value_step] / (double)g->sh_most);
}

static int gsplat_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    gsplat *g = handle;
    g->source = source;
    FXS_TRY(load_meta(g, message));
    for (int i = 0; i < IMAGES; i++)
        FXS_TRY(load_image(g, i, message));
    FXS_TRY(load_sh(g, message));
    info->count = g->count;
    info->sh_degree = g->sh_degree;
    info->antialiased = 0;
    return 0;
}

static long gsplat_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    gsplat *g = handle;
    size_t count = 0;
    (void)message;
    for (; count < capacity && g->at < g->count; count++)
        read_gaussian(g, g->at++, &gaussians[count]);
    return (long)count;
}

static int gsplat_rewind(void *handle, fxs_message *message)
{
    (void)message;
    ((gsplat *)handle)->at = 0;
    return 0;
}

static void gsplat_close(void *handle)
{
    gsplat *g = handle;
    for (int i = 0; i < IMAGES; i++)
        fxs_let_go(g->source, g->pixels[i], g->sizes[i]);
    for (int i = 0; i < 2; i++)
        if (g->arrays[i].data)
            fxs_text_let_go(g->source, &g->arrays[i]);
}

const fxs_reader fxs_read_gsplat = {is_gsplat, sizeof(gsplat), gsplat_open, gsplat_read, gsplat_rewind, gsplat_close,
                                    NULL};

#else

static int gsplat_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle, (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read gsplat's folder: built without libpng or cJSON",
                       source->path);
}

const fxs_reader fxs_read_gsplat = {is_gsplat, 0, gsplat_open, NULL, NULL, NULL, NULL};

#endif
