/* Makes the files of .sog version 2: lossless WebP images and their JSON. Layout: PlayCanvas's specification and
   splat-transform. */
#include "sog_internal.h"
#include "src/base/report.h"

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_ZIP)

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <webp/encode.h>

#include "src/base/exponential.h"
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "codebook_internal.h"

enum { MEANS_LOW, MEANS_HIGH, SCALES, QUATS, SH0, LABELS, CENTROIDS, IMAGES, JSON = IMAGES };

enum {
    PALETTE_ROW = 64,
    SH_RATIO = FXS_HELD_SH_ONE / FXS_SH_PALETTE_ONE,
    EFFORT = 4
};

/* The codebook of scales weights ln(sigma) by sigma^1.25. With equal weights, the few largest Gaussians share an entry.
   With weights by area, the sky takes too many entries. */
#define SCALE_POWER 1.25

const char *const fxs_sog_names[FXS_SOG_FILES] = {
    "means_l.webp", "means_u.webp", "scales.webp", "quats.webp", "sh0.webp", "shN_labels.webp", "shN_centroids.webp",
    "meta.json"
};

typedef struct image {
    uint32_t width, height;
    uint8_t *pixels;
    WebPMemoryWriter file;
} image;

struct fxs_sog {
    const fxs_sog_source *from;
    double low[3], high[3];
    float scales[FXS_BOOK], colours[FXS_BOOK], sh[FXS_BOOK];
    uint32_t entries, *labels;
    fxs_sh_palette_vector *palette;
    image images[IMAGES];
    char *json;
    size_t json_bytes;
    int error;
    const fxs_progress *progress;
};

static int no_memory(fxs_sog *w)
{
    w->error = ENOMEM;
    return 0;
}

static int advance(fxs_sog *w, double done)
{
    if (fxs_report(w->progress, done))
        w->error = ECANCELED;
    return !w->error;
}

/* Codes a coordinate of a position: sign(x) ln(1 + |x|). */
static double coded_position(float x)
{
    return copysign(fxs_log(1 + fabs(x)), x);
}

static void find_bounds(fxs_sog *w)
{
    for (int k = 0; k < 3; k++) {
        w->low[k] = INFINITY;
        w->high[k] = -INFINITY;
        for (uint32_t i = 0; i < w->from->count; i++) {
            const double x = coded_position(w->from->gaussians[i]->position[k]);
            w->low[k] = x < w->low[k] ? x : w->low[k];
            w->high[k] = x > w->high[k] ? x : w->high[k];
        }
    }
}

static int find_books(fxs_sog *w)
{
    const fxs_sog_source *h = w->from;
    const size_t count = 3 * (size_t)h->count;
    float *values = malloc((count + 1) * sizeof *values);
    int failed = !values;
    for (int which = 0; which < 2 && !failed; which++) {
        for (uint32_t i = 0; i < h->count; i++)
            memcpy(values + 3 * (size_t)i, which ? h->gaussians[i]->dc : h->gaussians[i]->scale, 3 * sizeof *values);
        failed = fxs_book_learn(which ? w->colours : w->scales, values, count, which ? 0 : SCALE_POWER);
    }
    free(values);
    return failed ? no_memory(w) : 1;
}

static int palette_progress(void *writer, double done)
{
    return !advance(writer, 0.1 + 0.7 * done);
}

static int find_sh_book(fxs_sog *w)
{
    const uint32_t coefficients = w->from->coefficients;
    const size_t count = (size_t)w->entries * coefficients;
    float *values = malloc(count * sizeof *values), *to = values;
    for (uint32_t e = 0; e < w->entries && values; e++)
        for (uint32_t k = 0; k < coefficients; k++)
            *to++ = (float)w->palette[e][k] / FXS_SH_PALETTE_ONE;
    const int failed = !values || fxs_book_learn(w->sh, values, count, 0);
    free(values);
    return failed ? no_memory(w) : 1;
}

static int find_palette(fxs_sog *w)
{
    const fxs_sog_source *h = w->from;
    if (!h->coefficients || !h->count)
        return 1;
    fxs_sh_palette_vector *vectors = calloc(h->count, sizeof *vectors);
    w->entries = fxs_sh_palette_entries(h->count);
    w->palette = malloc(w->entries * sizeof *w->palette);
    w->labels = malloc(h->count * sizeof *w->labels);
    for (uint32_t i = 0; i < h->count && vectors; i++)
        for (uint32_t k = 0; k < h->coefficients; k++) {
            const int32_t sh = h->sh[i][k];
            vectors[i][k] = (int16_t)((sh + (sh < 0 ? -SH_RATIO / 2 : SH_RATIO / 2)) / SH_RATIO);
        }
    const int made = vectors && w->palette && w->labels &&
                     !fxs_sh_palette_learn(w->palette, w->entries, w->labels, (const fxs_sh_palette_vector *)vectors,
                                           h->count, &(fxs_progress){palette_progress, w});
    free(vectors);
    if (!made)
        return w->error ? 0 : no_memory(w);
    return find_sh_book(w);
}

static int make_image(fxs_sog *w, int which, uint32_t width, uint32_t height)
{
    image *m = &w->images[which];
    m->width = width;
    m->height = height;
    m->pixels = calloc((size_t)width * height, 4);
    for (size_t i = 0; i < (size_t)width * height && m->pixels; i++)
        m->pixels[4 * i + 3] = 255;
    return m->pixels ? 1 : no_memory(w);
}

static int make_images(fxs_sog *w)
{
    uint32_t side = 4;
    while ((uint64_t)side * side < w->from->count)
        side += 4;
    const uint32_t width = side < FXS_SOG_SIDE ? side : FXS_SOG_SIDE / 4 * 4;
    const uint32_t rows = (w->from->count + width - 1) / width, height = (rows + 3) / 4 * 4;
    for (int i = 0; i < CENTROIDS; i++)
        if ((i != LABELS || w->entries) && !make_image(w, i, width, height < FXS_SOG_SIDE ? height : FXS_SOG_SIDE))
            return 0;
    return !w->entries || make_image(w, CENTROIDS, PALETTE_ROW * w->from->coefficients / 3,
                                     (w->entries + PALETTE_ROW - 1) / PALETTE_ROW);
}

static void encode(fxs_sog *w, const fxs_held_gaussian *g, size_t i)
{
    uint8_t *at[CENTROIDS];
    uint32_t rest[3];
    for (int k = 0; k < CENTROIDS; k++)
        at[k] = w->images[k].pixels ? w->images[k].pixels + 4 * i : NULL;
    const uint32_t largest = fxs_code_rotation(g->rotation, 255, rest);
    for (int c = 0; c < 3; c++) {
        const double width = w->high[c] - w->low[c];
        const double t = width > 0 ? (coded_position(g->position[c]) - w->low[c]) / width : 0;
        const uint32_t position = fxs_code_within(65535 * t, 65535);
        at[MEANS_LOW][c] = (uint8_t)position;
        at[MEANS_HIGH][c] = (uint8_t)(position >> 8);
        at[SCALES][c] = fxs_book_find(w->scales, g->scale[c]);
        at[QUATS][c] = (uint8_t)rest[c];
        at[SH0][c] = fxs_book_find(w->colours, g->dc[c]);
    }
    at[QUATS][3] = (uint8_t)(252 + largest);
    at[SH0][3] = (uint8_t)fxs_code_within(255.0 * g->opacity, 255);
    for (int k = 0; k < 2 && at[LABELS]; k++)
        at[LABELS][k] = (uint8_t)(w->labels[i] >> 8 * k);
}

/* Makes the image of the SH palette, with 64 entries in a row. An entry has a pixel for each coefficient, with red,
   green and blue SH in the channels. */
static void encode_palette(fxs_sog *w)
{
    const uint32_t coefficients = w->from->coefficients / 3;
    for (uint32_t e = 0; e < w->entries; e++)
        for (uint32_t k = 0; k < 3 * coefficients; k++) {
            const size_t pixel = (size_t)e * coefficients + k / 3;
            w->images[CENTROIDS].pixels[4 * pixel + k % 3] =
                fxs_book_find(w->sh, (float)w->palette[e][k] / FXS_SH_PALETTE_ONE);
        }
}

/* Compresses an image and frees its pixels. Keeps the colours of pixels with alpha 0. */
static int compress(fxs_sog *w, image *m)
{
    WebPConfig config;
    WebPPicture picture;
    if (!m->pixels)
        return 1;
    if (!WebPConfigInit(&config) || !WebPConfigLosslessPreset(&config, EFFORT) || !WebPPictureInit(&picture))
        return no_memory(w);
    config.exact = 1;
    picture.use_argb = 1;
    picture.width = (int)m->width;
    picture.height = (int)m->height;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &m->file;
    WebPMemoryWriterInit(&m->file);
    const int made = WebPPictureImportRGBA(&picture, m->pixels, (int)(4 * m->width)) && WebPEncode(&config, &picture);
    WebPPictureFree(&picture);
    free(m->pixels);
    m->pixels = NULL;
    return made ? 1 : no_memory(w);
}

static int fill_images(fxs_sog *w)
{
    const fxs_sog_source *h = w->from;
    if (!make_images(w))
        return 0;
    for (uint32_t i = 0; i < h->count; i++)
        encode(w, h->gaussians[i], i);
    encode_palette(w);
    for (int i = 0; i < IMAGES; i++)
        if (!compress(w, &w->images[i]) || !advance(w, 0.7 + 0.3 * (i + 1) / IMAGES))
            return 0;
    return 1;
}

static void print_book(FILE *json, const float book[FXS_BOOK], const char *files)
{
    fputs("\"codebook\":[", json);
    for (int i = 0; i < FXS_BOOK; i++) {
        fputs(i ? "," : "", json);
        fxs_print_number(json, 9, (double)book[i]);
    }
    fprintf(json, "],\"files\":[%s]}", files);
}

static void print_corner(FILE *json, const char *name, const double corner[3])
{
    fprintf(json, "\"%s\":", name);
    fxs_print_list(json, 17, ",", corner, 3);
    fputc(',', json);
}

static int degree_of(const fxs_sog *w)
{
    return w->from->coefficients == 45 ? 3 : w->from->coefficients == 24 ? 2 : w->from->coefficients == 9;
}

static void print_json(FILE *json, const fxs_sog *w)
{
    fprintf(json, "{\"version\":2,\"asset\":{\"generator\":\"fixsplat " FXS_VERSION "\"},\"count\":%lu,"
            "\"antialias\":%s,", (unsigned long)w->from->count, w->from->antialiased ? "true" : "false");
    fputs("\"means\":{", json);
    print_corner(json, "mins", w->low);
    print_corner(json, "maxs", w->high);
    fputs("\"files\":[\"means_l.webp\",\"means_u.webp\"]},\"scales\":{", json);
    print_book(json, w->scales, "\"scales.webp\"");
    fputs(",\"quats\":{\"files\":[\"quats.webp\"]},\"sh0\":{", json);
    print_book(json, w->colours, "\"sh0.webp\"");
    if (w->entries) {
        fprintf(json, ",\"shN\":{\"count\":%lu,\"bands\":%d,", (unsigned long)w->entries, degree_of(w));
        print_book(json, w->sh, "\"shN_centroids.webp\",\"shN_labels.webp\"");
    }
    fputs("}", json);
}

static int make_json(fxs_sog *w)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed))
        return no_memory(w);
    print_json(printed.file, w);
    if (fxs_print_end(&printed))
        return no_memory(w);
    w->json = printed.text;
    w->json_bytes = printed.size;
    return 1;
}

fxs_sog *fxs_sog_make(const fxs_sog_source *from, const fxs_progress *progress, int *error)
{
    fxs_sog *w = calloc(1, sizeof *w);
    if (!w) {
        *error = ENOMEM;
        return NULL;
    }
    w->from = from;
    w->progress = progress;
    if (find_books(w) && find_palette(w)) {
        find_bounds(w);
        if (fill_images(w))
            make_json(w);
    }
    *error = w->error;
    return w;
}

uint32_t fxs_sog_files(const fxs_sog *w, fxs_zip_entry files[FXS_SOG_FILES])
{
    uint32_t count = 0;
    for (int i = 0; i < IMAGES; i++)
        if (w->images[i].file.size)
            files[count++] = (fxs_zip_entry){fxs_sog_names[i], w->images[i].file.mem, w->images[i].file.size};
    files[count++] = (fxs_zip_entry){fxs_sog_names[JSON], w->json, w->json_bytes};
    return count;
}

void fxs_sog_free(fxs_sog *w)
{
    if (!w)
        return;
    for (int i = 0; i < IMAGES; i++) {
        free(w->images[i].pixels);
        WebPMemoryWriterClear(&w->images[i].file);
    }
    free(w->palette);
    free(w->labels);
    free(w->json);
    free(w);
}

#else

typedef int fxs_sog_is_left_out;

#endif
