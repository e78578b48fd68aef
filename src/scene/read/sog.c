/* Reads .sog versions 1 and 2, as a zip or as files in a folder, and streamed SOG: PlayCanvas, "The SOG Format" and
   "The Streamed SOG Format". Reads the moving scenes of .tsog too, which are version 4: OpsiClear-4DGS, "TSOG Playback
   Profile 1". If PlayCanvas's code differs from these (order of quaternions, logarithms of scales, width
   of a degree 1 palette), the code is followed. Also reads .lcc2 of XGRIDS, a tree of .sog files, like PlayCanvas's
   splat-transform. */
#include <fixsplat/internal/allocator.h>

#include <string.h>

#include "src/base/foreign.h"
#include "src/base/os_calls.h"
#include "src/scene/formats_internal.h"

static int is_sog(const fxs_head *head, fxs_message *message)
{
    return (!memcmp(head->bytes, "PK\3\4", 4) && !fxs_is_torch(head->bytes, head->size)) ||
           (head->name && !fxs_read_gsplat.is(head, message));
}

static int is_tsog(const fxs_head *head, fxs_message *message)
{
    return fxs_ends_in(head->source->path, ".tsog") && is_sog(head, message);
}

static int is_lcc2(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return head->name && (strstr(head->bytes, "\"totalLevels\"") || strstr(head->bytes, "\"lod_level\"") ||
                          strstr(head->bytes, "\"3dgs\""));
}

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_CJSON)

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <cjson/cJSON.h>
#include <webp/decode.h>

#include "src/base/exponential.h"
#include "src/base/fail_list.h"
#include "src/gaussian/attributes.h"
#include "src/gaussian/transform_internal.h"
#include "src/base/zip_internal.h"

enum {
    SLACK = 1 << 16,
    MAX_LEVELS = 1000,
    MAX_FILES = 1 << 16,
    PALETTE_ROW = 64        /* number of SH palette entries in a row of pixels */
};

enum { MEANS_LOW, MEANS_HIGH, SCALES, QUATS, SH0, CENTROIDS, LABELS, TIMES_LOW, TIMES_HIGH, VELOCITIES_LOW,
       VELOCITIES_HIGH, IMAGES };

static const struct { const char *name; int first, count; } properties[] = {
    {"means", MEANS_LOW, 2}, {"scales", SCALES, 1}, {"quats", QUATS, 1}, {"sh0", SH0, 1}, {"shN", CENTROIDS, 2},
    {"timeline", TIMES_LOW, 2}, {"temporal", VELOCITIES_LOW, 2}
};

#define PROFILE "org.opsiclear.tsog-playback"
#define SQRT_2 1.4142135623730951

/* How the Gaussians of a .tsog exist: always, in one frame each, or about a time each. */
typedef enum timeline { NO_TIMELINE, FRAMES, CONTINUOUS } timeline;

typedef float table[256];

typedef struct sog_scene {
    const fxs_scene_source *source;
    fxs_scene_source own;
    size_t count;
    int sh_degree, antialiased;
    size_t palette;
    double mins[3], maxs[3];   /* bounds of the coded positions sign(x) ln(1 + |x|) */
    table scale[3], colour[4], sh;
    fxs_text files[IMAGES];
    int widths[IMAGES], heights[IMAGES];
    uint8_t *pixels[IMAGES];   /* decoded images as RGBA; pixel i belongs to Gaussian i */
    timeline timeline;
    size_t frames;             /* number of frames of the timeline FRAMES */
    double time_mins[2], time_maxs[2];           /* of centres and standard deviations, in durations of the scene */
    double velocity_mins[3], velocity_maxs[3];   /* scene units per duration */
    int velocity_images;
    fxs_time time;
} sog_scene;

/* A range of Gaussians in a file: Gaussians `begin` to `end` - 1. */
typedef struct range {
    size_t file, begin, end;
} range;

/* A file name in a streamed SOG index. `file` is the index of the first entry with the same name. */
typedef struct file_name {
    const char *name;
    size_t file;
    uint64_t device, inode;
} file_name;

#define TO_THE_LAST SIZE_MAX

enum { BATCH = 512 };          /* most Gaussians of a moving scene that are read at once */

typedef struct sog_reader {
    const fxs_scene_source *source;
    cJSON *files;
    cJSON *model;
    int is_turned;
    fxs_transform transform;
    file_name *names;
    size_t file_count;
    range *ranges;
    size_t range_count, range_capacity;
    size_t at, done;
    sog_scene **scenes;
    size_t *held;         /* indices of the files whose scenes are in memory, oldest first */
    size_t held_count;
    sog_scene *scene;
    fxs_motion motions[BATCH];
} sog_reader;

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static double lerp(double a, double b, double t)
{
    return a * (1 - t) + b * t;
}

typedef struct container {
    const fxs_scene_source *source;
    fxs_zip *zip;
    fxs_message *message;
} container;

static int load_beside(const fxs_scene_source *source, const char *name, fxs_text *text, fxs_message *message)
{
    fxs_scene_source beside;
    int status = fxs_scene_source_open_beside(&beside, source, name, message);
    if (status == 0)
        status = fxs_scene_source_load(&beside, 0, beside.input.size, text, message);
    fxs_scene_source_close(&beside);
    return status;
}

static int load_file(const container *c, const char *name, fxs_text *text)
{
    FXS_TRY(fxs_check_name(c->source, name, c->message));
    return c->zip ? fxs_zip_load(c->zip, name, text, c->message)
                  : load_beside(c->source, name, text, c->message);
}

/* Reads a codebook of SOG version 2: 256 values for all components of an attribute. Old writers left the first value
   null. */
static int read_codebook(const cJSON *property, table *tables, int count)
{
    const cJSON *codebook = member(property, "codebook"), *value;
    float *next = tables[0];
    if (!cJSON_IsArray(codebook) || cJSON_GetArraySize(codebook) != 256)
        return 0;
    cJSON_ArrayForEach(value, codebook) {
        if (!cJSON_IsNumber(value) && !(value == codebook->child && cJSON_IsNull(value)))
            return 0;
        *next++ = (float)value->valuedouble;
    }
    if (cJSON_IsNull(codebook->child))
        tables[0][0] = tables[0][1] + (tables[0][1] - tables[0][255]) / 255;
    for (int i = 1; i < count; i++)
        memcpy(tables[i], tables[0], sizeof(table));
    return 1;
}

/* Reads the bounds of an attribute in SOG version 1: the smallest and largest value of each component. An attribute
   with a single component may have numbers instead of arrays. */
static int read_bounds(const cJSON *property, table *tables, int count)
{
    const cJSON *low = member(property, "mins"), *high = member(property, "maxs");
    double mins[4], maxs[4];
    if (count == 1 && cJSON_IsNumber(low) && cJSON_IsNumber(high)) {
        mins[0] = low->valuedouble;
        maxs[0] = high->valuedouble;
    } else if (!fxs_json_numbers(low, mins, count) || !fxs_json_numbers(high, maxs, count)) {
        return 0;
    }
    for (int i = 0; i < count; i++)
        for (int code = 0; code < 256; code++)
            tables[i][code] = (float)lerp(mins[i], maxs[i], code / 255.0);
    return 1;
}

/* Reads a codebook of a .tsog, of 1 to 256 values. A Gaussian with a code beyond has no valid number. */
static int read_short_codebook(const cJSON *property, table *tables, int count)
{
    const cJSON *codebook = member(property, "codebook"), *value;
    const int size = cJSON_IsArray(codebook) ? cJSON_GetArraySize(codebook) : 0;
    int at = 0;
    if (size < 1 || size > 256)
        return 0;
    cJSON_ArrayForEach(value, codebook) {
        if (!cJSON_IsNumber(value))
            return 0;
        tables[0][at++] = (float)value->valuedouble;
    }
    for (; at < 256; at++)
        tables[0][at] = NAN;
    for (int i = 1; i < count; i++)
        memcpy(tables[i], tables[0], sizeof(table));
    return 1;
}

static double version_of(const cJSON *root)
{
    const cJSON *version = member(root, "version");
    return !version ? 1 : cJSON_IsNumber(version) ? version->valuedouble : 0;
}

static int is_moving_version(const cJSON *root)
{
    return version_of(root) == 4;
}

static const char *check_version(const cJSON *root)
{
    const double number = version_of(root);
    const cJSON *profile = member(root, "profile");
    const char *id = fxs_json_string(profile, "id");
    size_t version;
    if (number == 3)
        return "SOG of version 3, which is not read: 1 and 2 are, and 4 (TSOG)";
    if (number == 4 && profile &&
        !(id && !strcmp(id, PROFILE) && fxs_json_whole(member(profile, "version"), 1, &version) && version == 1))
        return "TSOG of a profile that is not known: not " PROFILE " 1";
    if (!member(root, "means"))
        return "not a SOG scene: no \"means\"";
    return !member(root, "version") || number == 2 || number == 4 ? NULL
                                                                  : "SOG of a version that is not known: not 1, 2 or 4";
}

/* Applies the string "model" of a SOG file, which states anti-aliasing or 2D Gaussians. "default" or null changes
   nothing. */
static void take_model(sog_scene *s, const char *model)
{
    s->antialiased |= model && strcmp(model, "antialiased") == 0;
    for (int code = 0; code < 256 && model && strcmp(model, "2dgs") == 0; code++)
        s->scale[2][code] = FXS_FLAT_SCALE;
}

/* Reads a positive number. Returns 1, 0 if there is none, or -1 for anything else. */
static int read_positive(const cJSON *object, const char *name, double most, double *out)
{
    const cJSON *item = member(object, name);
    if (!item)
        return 0;
    if (!(cJSON_IsNumber(item) && item->valuedouble > 1 / most && item->valuedouble < most))
        return -1;
    *out = item->valuedouble;
    return 1;
}

/* Reads how long the scene lasts. What the file does not state is as the profile says: 30 frames a second; 300 frames
   of a continuous timeline, of which the last one is at the end. */
static const char *read_playback(sog_scene *s, const cJSON *root)
{
    const cJSON *playback = member(root, "playback"), *loop = member(playback, "loop");
    double rate = 30, duration = 0;
    const int has_rate = read_positive(playback, "fps", 1e6, &rate);
    const int has_any_rate = has_rate ? has_rate : read_positive(root, "fps", 1e6, &rate);
    const int has_duration = read_positive(playback, "duration", 1e9, &duration);
    if (has_any_rate < 0 || has_duration < 0 || (playback && !cJSON_IsObject(playback)) ||
        (loop && !cJSON_IsBool(loop)))
        return "no valid \"playback\" or \"fps\"";
    const double frames = s->timeline == FRAMES ? (double)s->frames : 299;
    if (s->timeline == FRAMES && has_rate && has_duration && fabs(duration * rate - frames) > 1e-6 * frames)
        return "\"duration\" and \"fps\" of \"playback\" are not those of the frames";
    s->time = (fxs_time){.duration = has_duration ? duration : frames / rate, .rate = has_any_rate ? rate : 0,
                         .loops = !loop || cJSON_IsTrue(loop), .degree = s->velocity_images > 0,
                         .fades = s->timeline == CONTINUOUS};
    if (s->timeline == FRAMES)
        s->time.rate = frames / s->time.duration;
    return NULL;
}

static const char *read_velocities(sog_scene *s, const cJSON *temporal)
{
    const cJSON *means = member(temporal, "means"), *item;
    cJSON_ArrayForEach(item, temporal)
        if (!item->string || strcmp(item->string, "means"))
            return "\"temporal\" has more than \"means\", which is not read";
    if (!means)
        return cJSON_IsObject(temporal) ? NULL : "\"temporal\" is not an object";
    s->velocity_images = cJSON_GetArraySize(member(means, "files")) == 1 ? 1 : 2;
    if (cJSON_GetArraySize(member(means, "mins")) != 1 || cJSON_GetArraySize(member(means, "maxs")) != 1 ||
        !fxs_json_numbers(cJSON_GetArrayItem(member(means, "mins"), 0), s->velocity_mins, 3) ||
        !fxs_json_numbers(cJSON_GetArrayItem(member(means, "maxs"), 0), s->velocity_maxs, 3))
        return "no valid \"mins\" and \"maxs\" of \"temporal\"";
    return NULL;
}

/* A scene without a timeline is still. */
static const char *read_timeline(sog_scene *s, const cJSON *root)
{
    const cJSON *line = member(root, "timeline"), *temporal = member(root, "temporal");
    size_t type = 2, step;
    if (!line)
        return temporal ? "\"temporal\" without a \"timeline\"" : NULL;
    if (!fxs_json_whole(member(line, "type"), 1, &type))
        return "a \"timeline\" of a type that is not read: 0 and 1 are";
    s->timeline = type ? CONTINUOUS : FRAMES;
    if (s->timeline == FRAMES) {
        if (!fxs_json_whole(member(line, "N"), 65536, &s->frames) || s->frames == 0 ||
            !fxs_json_whole(member(line, "delta"), 65536, &step) || step != 65536 / s->frames)
            return "no valid \"N\" and \"delta\" of \"timeline\"";
        return read_playback(s, root);
    }
    if (!fxs_json_numbers(member(line, "mins"), s->time_mins, 2) ||
        !fxs_json_numbers(member(line, "maxs"), s->time_maxs, 2) || !((float)s->time_mins[1] > 0) ||
        !(s->time_maxs[1] >= s->time_mins[1]))
        return "no valid \"mins\" and \"maxs\" of \"timeline\"";
    const char *fault = temporal ? read_velocities(s, temporal) : NULL;
    return fault ? fault : read_playback(s, root);
}

static const char *read_meta(sog_scene *s, const cJSON *root)
{
    const cJSON *version = member(root, "version"), *means = member(root, "means"), *shn = member(root, "shN");
    int (*read)(const cJSON *, table *, int) = is_moving_version(root) ? read_short_codebook
                                               : version ? read_codebook : read_bounds;
    const char *fault = check_version(root);
    size_t degree = 0;
    if (fault)
        return fault;
    s->antialiased = cJSON_IsTrue(member(root, "antialias"));
    if (!fxs_json_whole(version ? member(root, "count") : cJSON_GetArrayItem(member(means, "shape"), 0), INT32_MAX,
                        &s->count))
        return version ? "no valid \"count\"" : "no valid \"shape\" of \"means\"";
    if (!fxs_json_numbers(member(means, "mins"), s->mins, 3) || !fxs_json_numbers(member(means, "maxs"), s->maxs, 3))
        return "no valid \"mins\" and \"maxs\" of \"means\"";
    if (!read(member(root, "scales"), s->scale, 3))
        return "no valid values of \"scales\"";
    take_model(s, fxs_json_string(root, "model"));
    for (int code = 0; code < 256; code++)
        s->colour[3][code] = fxs_logit_of_code(code);
    if (!read(member(root, "sh0"), s->colour, version ? 3 : 4))
        return "no valid values of \"sh0\"";
    if (shn && !read(shn, &s->sh, 1))
        return "no valid values of \"shN\"";
    if (shn && version && !(fxs_json_whole(member(shn, "bands"), 3, &degree) && degree > 0))
        return "no valid \"bands\" of \"shN\"";
    if (shn && version && !fxs_json_whole(member(shn, "count"), 65536, &s->palette))
        return "no valid \"count\" of \"shN\"";
    s->sh_degree = (int)degree;
    return is_moving_version(root) ? read_timeline(s, root) : NULL;
}

static int coefficients(int degree)
{
    return degree * (degree + 2);
}

/* Checks the size of the SH palette's image. In SOG version 1, the image's width gives the SH degree. */
static const char *check_palette(sog_scene *s, int width, size_t pixels)
{
    int degree = s->sh_degree ? s->sh_degree : 1;
    while (!s->sh_degree && degree < 3 && width != PALETTE_ROW * coefficients(degree))
        degree++;
    if (width != PALETTE_ROW * coefficients(degree))
        return "not as wide as a palette of its degree";
    size_t room = pixels / (size_t)coefficients(degree);
    if (room < s->palette)
        return "not as high as a palette of its count";
    if (!s->sh_degree)
        s->palette = room;
    s->sh_degree = degree;
    return NULL;
}

static const char *check_image(sog_scene *s, int image)
{
    const fxs_text *file = &s->files[image];
    WebPBitstreamFeatures features;
    if (WebPGetFeatures((const uint8_t *)file->data, file->size, &features) != VP8_STATUS_OK ||
        features.has_animation || features.format != 2)
        return "not a lossless WebP";
    size_t pixels = (size_t)features.width * (size_t)features.height;
    s->widths[image] = features.width;
    s->heights[image] = features.height;
    if (image == CENTROIDS)
        return check_palette(s, features.width, pixels);
    if (pixels < s->count)
        return "fewer pixels than Gaussians";
    if (pixels / 2 > s->count + SLACK)
        return "far more pixels than Gaussians";
    return NULL;
}

static int load_image(sog_scene *s, const container *c, int image, const char *name)
{
    FXS_TRY(load_file(c, name, &s->files[image]));
    const char *fault = check_image(s, image);
    return fault ? fxs_fail(c->message, "%s: %s: %s", c->source->path, name, fault) : 0;
}

static int load_named_image(sog_scene *s, const container *c, int image, const char *names[IMAGES], const char *name)
{
    for (int i = 0; i < image && name; i++)
        if (names[i] && fxs_compare_names(names[i], name) == 0)
            return fxs_fail(c->message, "%s: %s: the file of two images", c->source->path, name);
    names[image] = name;
    return load_image(s, c, image, name);
}

/* Returns the number of images of a property; 0: the scene lacks it. */
static int images_of(const sog_scene *s, size_t property, const cJSON *root)
{
    switch (properties[property].first) {
    case CENTROIDS:      return member(root, "shN") ? properties[property].count : 0;
    case TIMES_LOW:      return s->timeline != NO_TIMELINE ? properties[property].count : 0;
    case VELOCITIES_LOW: return s->velocity_images;
    default:             return properties[property].count;
    }
}

static int load_images(sog_scene *s, const container *c, const cJSON *root)
{
    const char *loaded[IMAGES] = {NULL};
    for (size_t i = 0; i < sizeof properties / sizeof *properties; i++) {
        const cJSON *property = member(root, properties[i].name);
        if (properties[i].first == VELOCITIES_LOW)
            property = member(property, "means");
        const cJSON *names = member(property, "files");
        const int count = images_of(s, i, root);
        if (cJSON_GetArraySize(names) < count)
            return fxs_fail(c->message, "%s: too few \"files\" of \"%s\"", c->source->path, properties[i].name);
        for (int k = 0; k < count; k++)
            FXS_TRY(load_named_image(s, c, properties[i].first + k, loaded,
                                     cJSON_GetStringValue(cJSON_GetArrayItem(names, k))));
    }
    return 0;
}

static size_t image_bytes(const sog_scene *s, int image)
{
    return 4 * (size_t)s->widths[image] * (size_t)s->heights[image];
}

static int decode_image(sog_scene *s, int image, fxs_message *message)
{
    const fxs_text *file = &s->files[image];
    const size_t bytes = image_bytes(s, image);
    uint8_t *pixels = fxs_hold(s->source, bytes, message);
    if (!pixels)
        return FXS_ERR_MEMORY;
    errno = 0;
    if (!WebPDecodeRGBAInto((const uint8_t *)file->data, file->size, pixels, bytes, 4 * s->widths[image])) {
        const int error = fxs_fail_library(message, s->source->path, "%s: an image cannot be decoded: damaged",
                                           s->source->path);
        fxs_let_go(s->source, pixels, bytes);
        return error;
    }
    s->pixels[image] = pixels;
    return 0;
}

static int decode_images(sog_scene *s, fxs_message *message)
{
    for (int i = 0; i < IMAGES; i++) {
        if (!s->files[i].data)
            continue;
        FXS_TRY(decode_image(s, i, message));
        fxs_text_let_go(s->source, &s->files[i]);
    }
    return 0;
}

static int load_json(const container *c, cJSON **root)
{
    fxs_text meta;
    FXS_TRY(c->zip ? load_file(c, "meta.json", &meta)
                   : fxs_scene_source_load(c->source, 0, c->source->input.size, &meta, c->message));
    const int status = fxs_json_parse(&meta, c->source, root, c->message);
    fxs_text_let_go(c->source, &meta);
    return status;
}

static int load_meta(sog_scene *s, const container *c)
{
    cJSON *root = NULL;
    int status = load_json(c, &root);
    const char *fault = root ? read_meta(s, root) : NULL;
    if (fault)
        status = fxs_fail(c->message, "%s: %s", c->source->path, fault);
    if (status == 0 && c->zip)
        status = fxs_limit_gaussians(c->source, s->count, c->message);
    if (status == 0)
        status = load_images(s, c, root);
    cJSON_Delete(root);
    return status;
}

/* Decodes a rotation w, x, y, z from its three smallest components, which lie in +-1/sqrt(2). Alpha is 252 plus the
   index of the largest component, which is not stored. */
static void decode_rotation(const uint8_t *code, float rotation[4])
{
    double sum = 0;
    int omitted = code[3] - 252;
    for (int i = 0; i < 4; i++)
        rotation[i] = i == 0;
    if (omitted < 0)
        return;
    for (int i = 0; i < 4; i++) {
        if (i == omitted)
            continue;
        double value = (*code++ / 255.0 - 0.5) * 1.4142135623730951;
        rotation[i] = (float)value;
        sum += value * value;
    }
    rotation[omitted] = (float)sqrt(fmax(0, 1 - sum));
}

static void decode_sh(const sog_scene *s, size_t index, float *sh)
{
    const uint8_t *code = s->pixels[LABELS] + 4 * index;
    size_t label = code[0] | (size_t)code[1] << 8, count = (size_t)coefficients(s->sh_degree);
    if (label >= s->palette)   /* a Gaussian with a label beyond the palette has SH 0, as in PlayCanvas */
        return;
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++)
            sh[3 * k + c] = s->sh[s->pixels[CENTROIDS][4 * (label * count + k) + c]];
}

static int code_of(const sog_scene *s, int low, int images, size_t index, int channel)
{
    const int code = s->pixels[low][4 * index + (size_t)channel];
    return images > 1 ? code | s->pixels[low + 1][4 * index + (size_t)channel] << 8 : code;
}

/* The last frame of the timeline FRAMES lasts until the end, and later codes mean it too. */
static void decode_frame(const sog_scene *s, size_t index, fxs_motion *m)
{
    const size_t code = (size_t)code_of(s, TIMES_LOW, 2, index, 0) / (65536 / s->frames);
    const size_t frame = code < s->frames ? code : s->frames - 1;
    m->fade = INFINITY;
    m->from = frame ? (float)((double)frame / s->time.rate) : -INFINITY;
    m->to = frame + 1 < s->frames ? (float)((double)(frame + 1) / s->time.rate) : INFINITY;
}

static void decode_motion(const sog_scene *s, size_t index, fxs_motion *m)
{
    double times[2];
    memset(m, 0, sizeof *m);
    if (s->timeline == FRAMES) {
        decode_frame(s, index, m);
        return;
    }
    for (int c = 0; c < 2; c++)
        times[c] = lerp(s->time_mins[c], s->time_maxs[c], code_of(s, TIMES_LOW, 2, index, c) / 65535.0);
    m->centre = (float)(times[0] * s->time.duration);
    m->fade = (float)(SQRT_2 * times[1] * s->time.duration);
    for (int c = 0; c < 3 && s->velocity_images; c++)
        m->drift[0][c] = (float)(lerp(s->velocity_mins[c], s->velocity_maxs[c],
                                      code_of(s, VELOCITIES_LOW, s->velocity_images, index, c) /
                                          (s->velocity_images > 1 ? 65535.0 : 255.0)) / s->time.duration);
    m->from = -INFINITY;
    m->to = INFINITY;
}

static void decode_gaussian(const sog_scene *s, size_t index, fxs_gaussian *g)
{
    const uint8_t *low = s->pixels[MEANS_LOW] + 4 * index, *high = s->pixels[MEANS_HIGH] + 4 * index;
    const uint8_t *scale = s->pixels[SCALES] + 4 * index, *colour = s->pixels[SH0] + 4 * index;
    memset(g, 0, sizeof *g);
    for (int i = 0; i < 3; i++) {
        double n = lerp(s->mins[i], s->maxs[i], (high[i] << 8 | low[i]) / 65535.0);
        g->position[i] = (float)copysign(fxs_exp(fabs(n)) - 1, n);
        g->scale[i] = s->scale[i][scale[i]];
        g->dc[i] = s->colour[i][colour[i]];
    }
    g->opacity = s->colour[3][colour[3]];
    decode_rotation(s->pixels[QUATS] + 4 * index, g->rotation);
    if (s->sh_degree)
        decode_sh(s, index, g->sh);
}

static int add_range(sog_reader *r, range added, fxs_message *message)
{
    if (r->range_count == r->range_capacity) {
        size_t capacity = 2 * r->range_capacity + 16;
        range *ranges = fxs_enlarge(r->source->options.allocator, r->ranges, r->range_count, capacity, sizeof *ranges);
        if (!ranges)
            return fxs_fail_memory(message, r->source->path, capacity * sizeof *ranges);
        r->ranges = ranges;
        r->range_capacity = capacity;
    }
    r->ranges[r->range_count++] = added;
    return 0;
}

static int level_of(const char *name)
{
    int level = 0;
    for (const char *c = name; *c; c++)
        if (*c < '0' || *c > '9' || (level = 10 * level + (*c - '0')) > MAX_LEVELS)
            return -1;
    return *name ? level : -1;
}

/* Finds the data of a tree node for a level of detail; null: none. A leaf without that level uses its nearest level.
   Returns 0, or -1 if level names are not numbers. */
static int find_level(const cJSON *node, int level, const cJSON **found)
{
    const int is_leaf = !cJSON_GetArraySize(member(node, "children"));
    const cJSON *item;
    int least = is_leaf ? 2 * MAX_LEVELS : 0;
    *found = NULL;
    cJSON_ArrayForEach(item, member(node, "lods")) {
        const int given = item->string ? level_of(item->string) : -1;
        if (given < 0)
            return -1;
        const int distance = given < level ? 2 * (level - given) - 1 : 2 * (given - level);
        if (distance <= least) {
            least = distance;
            *found = item;
        }
    }
    return 0;
}

static int add_leaves(sog_reader *r, const cJSON *node, int level, fxs_message *message)
{
    const cJSON *found, *child;
    if (find_level(node, level, &found) != 0)
        return fxs_fail(message, "%s: a leaf with \"lods\" that are not levels from 0 to %d", r->source->path,
                        MAX_LEVELS);
    if (found) {
        range added;
        size_t count;
        if (!fxs_json_whole(member(found, "file"), r->file_count, &added.file) || added.file == r->file_count ||
            !fxs_json_whole(member(found, "offset"), INT32_MAX, &added.begin) ||
            !fxs_json_whole(member(found, "count"), INT32_MAX, &count))
            return fxs_fail(message, "%s: a leaf with no valid \"file\", \"offset\" and \"count\"", r->source->path);
        added.end = added.begin + count;
        if (count > 0)
            FXS_TRY(add_range(r, added, message));
    }
    cJSON_ArrayForEach(child, member(node, "children"))
        FXS_TRY(add_leaves(r, child, level, message));
    return 0;
}

static int compare_ranges(const void *a, const void *b)
{
    const range *x = a, *y = b;
    if (x->file != y->file)
        return x->file < y->file ? -1 : 1;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

static int compare_names(const void *a, const void *b)
{
    const file_name *x = a, *y = b;
    int order = fxs_compare_names(x->name, y->name);
    return order ? order : (x->file > y->file) - (x->file < y->file);
}

static int list_names(sog_reader *r, fxs_message *message)
{
    const cJSON *item;
    size_t count = (size_t)cJSON_GetArraySize(r->files), i = 0;
    file_name *sorted = fxs_allocate(r->source->options.allocator, count, sizeof *sorted);
    r->names = fxs_allocate(r->source->options.allocator, count, sizeof *r->names);
    if (!sorted || !r->names) {
        fxs_release(r->source->options.allocator, sorted);
        return fxs_fail_memory(message, r->source->path, count * sizeof *sorted);
    }
    cJSON_ArrayForEach(item, r->files) {
        const char *name = cJSON_GetStringValue(item);
        sorted[i] = r->names[i] = (file_name){name ? name : "", i, 0, 0};
        i++;
    }
    if (count > 0)
        qsort(sorted, count, sizeof *sorted, compare_names);
    for (i = 1; i < count; i++)
        if (fxs_compare_names(sorted[i - 1].name, sorted[i].name) == 0)
            r->names[sorted[i].file].file = r->names[sorted[i - 1].file].file;
    fxs_release(r->source->options.allocator, sorted);
    r->file_count = count;
    for (i = 0; i < r->range_count; i++)
        r->ranges[i].file = r->names[r->ranges[i].file].file;
    return 0;
}

/* Adds the environment of a streamed SOG: Gaussians that are drawn at every level of detail. Older PlayCanvas versions
   use environment.sog without naming it in the index. Returns 1 if an environment exists, else 0; or an error and a
   message. */
static int add_environment(sog_reader *r, cJSON *root, fxs_message *message)
{
    static const char name[] = "environment.sog";
    cJSON *named = cJSON_DetachItemFromObjectCaseSensitive(root, "environment");
    if (!cJSON_IsString(named)) {
        cJSON_Delete(named);
        const int is_there = fxs_scene_source_is_beside(r->source, name, message);
        FXS_TRY(is_there);
        named = is_there ? cJSON_CreateString(name) : NULL;
    }
    return named && cJSON_AddItemToArray(r->files, named);
}

static int read_index(sog_reader *r, cJSON *root, fxs_scene_file_info *info, fxs_message *message)
{
    const cJSON *version = member(root, "version");
    const cJSON *environment = member(root, "environment");
    size_t levels;
    if (version && !(cJSON_IsNumber(version) && version->valuedouble == 1))
        return fxs_fail(message, "%s: streamed SOG of a version that is not known: not 1", r->source->path);
    if (!fxs_json_whole(member(root, "lodLevels"), MAX_LEVELS, &levels) || levels == 0)
        return fxs_fail(message, "%s: no valid \"lodLevels\"", r->source->path);
    info->levels = (int)levels;
    r->files = cJSON_DetachItemFromObjectCaseSensitive(root, "filenames");
    if (!cJSON_IsArray(r->files) || cJSON_GetArraySize(r->files) > MAX_FILES)
        return fxs_fail(message, "%s: \"filenames\" is not an array of up to %d", r->source->path, MAX_FILES);
    r->file_count = (size_t)cJSON_GetArraySize(r->files);
    r->model = cJSON_DetachItemFromObjectCaseSensitive(root, "model");
    if (environment && !cJSON_IsString(environment) && !cJSON_IsNull(environment))
        return fxs_fail(message, "%s: an \"environment\" that is not a file name", r->source->path);
    FXS_TRY(add_leaves(r, member(root, "tree"), r->source->options.level, message));
    const int has_environment = add_environment(r, root, message);
    FXS_TRY(has_environment);
    FXS_TRY(list_names(r, message));
    if (r->range_count > 0)
        qsort(r->ranges, r->range_count, sizeof *r->ranges, compare_ranges);
    return has_environment ? add_range(r, (range){r->names[r->file_count - 1].file, 0, TO_THE_LAST}, message) : 0;
}

static size_t file_of_node(const cJSON *node, const char *name)
{
    size_t file = TO_THE_LAST;
    fxs_json_whole(member(member(member(node, "data"), name), "name"), MAX_FILES, &file);
    return file;
}

static int add_nodes(sog_reader *r, const cJSON *node, size_t depth, size_t sky, fxs_message *message)
{
    const cJSON *child, *children = member(node, "child");
    const size_t file = depth ? TO_THE_LAST : file_of_node(node, "3dgs");
    if (file != TO_THE_LAST && file >= r->file_count)
        return fxs_fail(message, "%s: a node of a file that is not in \"splatFiles\"", r->source->path);
    if (file != TO_THE_LAST && file != sky)
        FXS_TRY(add_range(r, (range){file, 0, TO_THE_LAST}, message));
    if (!depth)
        return 0;
    cJSON_ArrayForEach(child, children)
        FXS_TRY(add_nodes(r, child, depth - 1, sky, message));
    return 0;
}

static int add_lcc2_name(sog_reader *r, const char *name, int is_old, fxs_message *message)
{
    name = name ? name : "";
    name += is_old && *name == '/';
    const char *ending = is_old && !fxs_ends_in(name, ".sog") ? ".sog" : "";
    const size_t room = strlen(name) + strlen(ending) + 1;
    char *path = fxs_allocate(r->source->options.allocator, room, 1);
    if (!path)
        return fxs_fail_memory(message, r->source->path, room);
    snprintf(path, room, "%s%s", name, ending);
    cJSON *added = cJSON_CreateString(path);
    fxs_release(r->source->options.allocator, path);
    return added && cJSON_AddItemToArray(r->files, added) ? 0 : fxs_fail_memory(message, r->source->path, room);
}

static int add_lcc2_names(sog_reader *r, const cJSON *names, int is_old, fxs_message *message)
{
    const cJSON *name;
    if (!cJSON_IsArray(names) || cJSON_GetArraySize(names) > MAX_FILES || !(r->files = cJSON_CreateArray()))
        return fxs_fail(message, "%s: \"splatFiles\" is not an array of up to %d", r->source->path, MAX_FILES);
    cJSON_ArrayForEach(name, names)
        FXS_TRY(add_lcc2_name(r, cJSON_GetStringValue(name), is_old, message));
    r->file_count = (size_t)cJSON_GetArraySize(r->files);
    return 0;
}

/* Reads the index of a .lcc2 file, which is a tree. A node's level of detail plus its depth below the root is
   "totalLevels". */
static int read_lcc2(sog_reader *r, const cJSON *root, fxs_scene_file_info *info, fxs_message *message)
{
    /* rotation from axes with z up to axes with y down */
    static double rows[3][4] = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}};
    const cJSON *tree = member(root, "root");
    const int is_old = !member(root, "totalLevels"), level = r->source->options.level;
    const char *type = fxs_json_string(root, "splatType");
    size_t levels;
    if (!fxs_json_whole(member(root, is_old ? "lod_level" : "totalLevels"), MAX_LEVELS, &levels) || levels == 0)
        return fxs_fail(message, "%s: no valid \"totalLevels\"", r->source->path);
    if (type && strcmp(type, ".sog") != 0)
        return fxs_fail(message, "%s: a .lcc2 with files of the kind \"%.20s\", which is not read: .sog is",
                        r->source->path, type);
    info->levels = (int)levels;
    r->is_turned = 1;
    fxs_transform_init(&r->transform, rows);
    FXS_TRY(add_lcc2_names(r, member(tree, is_old ? "files" : "splatFiles"), is_old, message));
    const size_t sky = file_of_node(tree, "env");
    if (level >= 0 && (size_t)level < levels)
        FXS_TRY(add_nodes(r, tree, levels - (size_t)level, sky, message));
    FXS_TRY(list_names(r, message));
    if (r->range_count > 0)
        qsort(r->ranges, r->range_count, sizeof *r->ranges, compare_ranges);
    size_t kept = 0;
    for (size_t i = 0; i < r->range_count; i++)
        if (!kept || r->ranges[kept - 1].file != r->ranges[i].file)
            r->ranges[kept++] = r->ranges[i];
    r->range_count = kept;
    if (sky >= r->file_count)
        return 0;
    FXS_TRY(fxs_check_name(r->source, r->names[sky].name, message));
    const int is_there = fxs_scene_source_is_beside(r->source, r->names[sky].name, message);
    FXS_TRY(is_there);
    return is_there ? add_range(r, (range){r->names[sky].file, 0, TO_THE_LAST}, message) : 0;
}

static void drop_scene(sog_reader *r, size_t at)
{
    sog_scene *s = r->scenes[r->held[at]];
    r->scenes[r->held[at]] = NULL;
    r->held_count--;
    memmove(r->held + at, r->held + at + 1, (r->held_count - at) * sizeof *r->held);
    for (int i = 0; i < IMAGES; i++) {
        fxs_text_let_go(s->source, &s->files[i]);
        fxs_let_go(s->source, s->pixels[i], image_bytes(s, i));
    }
    fxs_scene_source_close(&s->own);
    fxs_let_go(r->source, s, sizeof *s);
}

static int drop_another(void *handle)
{
    sog_reader *r = handle;
    for (size_t at = r->held_count; at-- > 0;)
        if (r->scenes[r->held[at]] != r->scene) {
            drop_scene(r, at);
            return 1;
        }
    return 0;
}

static int open_scene(const sog_reader *r, sog_scene *s, size_t file, fxs_message *message)
{
    s->source = r->files ? &s->own : r->source;
    if (!r->files)
        return 0;
    const char *name = r->names[file].name;
    s->own.options = r->source->options;
    s->own.import = r->source->import;
    return fxs_scene_source_open_beside(&s->own, r->source, name, message);
}

/* Refuses a file that appears under two names. Through links, one file could otherwise stand for many and demand much
   work. */
static int check_identity(const sog_reader *r, const sog_scene *s, size_t file, fxs_message *message)
{
    if (r->names[file].inode == s->own.inode && r->names[file].device == s->own.device)
        return 0;
    for (size_t i = 0; i < r->file_count && s->own.inode; i++)
        if (i != file && r->names[i].inode == s->own.inode && r->names[i].device == s->own.device)
            return fxs_fail(message, "%s: the same file as %s", s->own.path, r->names[i].name);
    r->names[file].device = s->own.device;
    r->names[file].inode = s->own.inode;
    return 0;
}

static int is_bundle(const fxs_scene_source *source, fxs_message *message)
{
    char first;
    FXS_TRY(fxs_scene_source_read(source, 0, &first, 1, message));
    return first == 'P';
}

/* Opens the zip, if the file is one. Close it in either case. */
static int open_container(container *c)
{
    const int bundled = is_bundle(c->source, c->message);
    FXS_TRY(bundled);
    if (bundled)
        FXS_TRY(fxs_zip_open(c->source, &c->zip, c->message));
    return bundled ? fxs_zip_enter(c->zip, "meta.json", c->message) : 0;
}

static int load_scene(const sog_reader *r, sog_scene *s, size_t file, fxs_message *message)
{
    FXS_TRY(open_scene(r, s, file, message));
    if (r->files)
        FXS_TRY(check_identity(r, s, file, message));
    container c = {s->source, NULL, message};
    int status = open_container(&c);
    if (status == 0)
        status = load_meta(s, &c);
    fxs_zip_close(c.zip);
    take_model(s, cJSON_GetStringValue(r->model));
    if (r->files)
        fxs_scene_source_shut(&s->own);
    return status;
}

static int add_scene(sog_reader *r, size_t file, fxs_message *message)
{
    r->scene = NULL;
    sog_scene *s = fxs_hold(r->source, sizeof *s, message);
    if (!s)
        return FXS_ERR_MEMORY;
    memset(s, 0, sizeof *s);
    r->scene = r->scenes[file] = s;
    r->held[r->held_count++] = file;
    const int result = load_scene(r, s, file, message);
    if (result) {
        r->scene = NULL;
        drop_scene(r, r->held_count - 1);
    }
    return result;
}

static int open_range(sog_reader *r, range *of, fxs_message *message)
{
    if (!r->scenes[of->file])
        FXS_TRY(add_scene(r, of->file, message));
    r->scene = r->scenes[of->file];
    if (of->end == TO_THE_LAST)
        of->end = r->scene->count;
    if (of->end > r->scene->count)
        return fxs_fail(message, "%s: %zu Gaussians, but a leaf ends at %zu", r->scene->source->path, r->scene->count,
                        of->end);
    return 0;
}

static int check_ranges(sog_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    info->count = 0;
    info->sh_degree = info->antialiased = 0;
    for (size_t i = 0; i < r->range_count; i++) {
        range *of = &r->ranges[i];
        FXS_TRY(fxs_scene_source_progress(r->source, (double)i / (double)r->range_count, message));
        FXS_TRY(open_range(r, of, message));
        if (i > 0 && of[-1].file == of->file && of[-1].end > of->begin)
            return fxs_fail(message, "%s: two leaves share Gaussian %zu", r->scene->source->path, of->begin);
        if (r->scene->timeline != NO_TIMELINE && r->files)
            return fxs_fail(message, "%s: a moving scene as a part of another", r->scene->source->path);
        info->time = r->scene->time;
        info->count += of->end - of->begin;
        info->antialiased |= r->scene->antialiased;
        info->sh_degree = r->scene->sh_degree > info->sh_degree ? r->scene->sh_degree : info->sh_degree;
        FXS_TRY(fxs_limit_gaussians(r->source, info->count, message));
    }
    return 0;
}

static int load_sound(const container *c, const cJSON *audio, fxs_sound *sound, fxs_text *data)
{
    const cJSON *volume = member(audio, "volume"), *type = member(audio, "mimeType");
    const char *name = fxs_json_string(audio, "file"), *path = c->source->path;
    const int is_volume = cJSON_IsNumber(volume) && volume->valuedouble >= 0 && volume->valuedouble <= 1;
    if (!name || (volume && !is_volume) || (type && !cJSON_IsString(type)))
        return fxs_fail(c->message, "%s: no valid \"audio\"", path);
    if (volume)
        sound->volume = volume->valuedouble;
    if (!fxs_sound_kind(sound, name, cJSON_GetStringValue(type)))
        return fxs_fail(c->message, "%s: the sound %s is of a type that is not known", path, name);
    const int error = load_file(c, name, data);
    return !error ? 1 : error == FXS_ERR_MEMORY ? error
                      : fxs_fail(c->message, "%s: the sound %s is missing or damaged", path, name);
}

static int sog_sound(void *handle, fxs_sound *sound, fxs_text *data, fxs_message *message)
{
    container c = {((const sog_reader *)handle)->source, NULL, message};
    cJSON *root = NULL;
    int status = open_container(&c);
    if (status == 0)
        status = load_json(&c, &root);
    const cJSON *audio = member(root, "audio");
    if (status == 0 && audio && is_moving_version(root))
        status = load_sound(&c, audio, sound, data);
    cJSON_Delete(root);
    fxs_zip_close(c.zip);
    return status;
}

static int read_source(sog_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    fxs_text json;
    const int bundled = is_bundle(r->source, message);
    FXS_TRY(bundled);
    if (bundled)
        return add_range(r, (range){0, 0, TO_THE_LAST}, message);
    FXS_TRY(fxs_scene_source_load(r->source, 0, r->source->input.size, &json, message));
    cJSON *root;
    int status = fxs_json_parse(&json, r->source, &root, message);
    fxs_text_let_go(r->source, &json);
    if (status == 0)
        status = member(root, "tree") ? read_index(r, root, info, message)
                 : member(member(root, "root"), "child") ? read_lcc2(r, root, info, message)
                                      : add_range(r, (range){0, 0, TO_THE_LAST}, message);
    cJSON_Delete(root);
    return status;
}

static int sog_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    sog_reader *r = handle;
    const fxs_allocator *allocator = source->options.allocator;
    r->source = source;
    r->file_count = 1;
    FXS_TRY(read_source(r, info, message));
    r->scenes = fxs_allocate_zeroed(allocator, r->file_count, sizeof *r->scenes);
    r->held = fxs_allocate(allocator, r->file_count, sizeof *r->held);
    if (!r->scenes || !r->held)
        return fxs_fail_memory(message, source->path, r->file_count * sizeof *r->scenes);
    source->import->drop = drop_another;
    source->import->reader = r;
    source->import->sound = sog_sound;
    return check_ranges(r, info, message);
}

static long sog_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    sog_reader *r = handle;
    size_t count = 0;
    if (r->scene && r->scene->timeline != NO_TIMELINE)
        capacity = capacity < BATCH ? capacity : BATCH;
    while (count < capacity && r->at < r->range_count) {
        range *of = &r->ranges[r->at];
        FXS_TRY(open_range(r, of, message));
        FXS_TRY(decode_images(r->scene, message));
        for (; count < capacity && r->done < of->end - of->begin; r->done++, count++) {
            decode_gaussian(r->scene, of->begin + r->done, &gaussians[count]);
            if (r->scene->timeline != NO_TIMELINE)
                decode_motion(r->scene, of->begin + r->done, &r->motions[count]);
            if (r->is_turned)
                fxs_transform_apply(&r->transform, &gaussians[count], r->scene->sh_degree);
        }
        if (r->done == of->end - of->begin) {
            r->at++;
            r->done = 0;
        }
    }
    return (long)count;
}

static int sog_rewind(void *handle, fxs_message *message)
{
    sog_reader *r = handle;
    (void)message;
    r->at = r->done = 0;
    return 0;
}

static void sog_close(void *handle)
{
    sog_reader *r = handle;
    const fxs_allocator *allocator = r->source->options.allocator;
    while (r->held_count > 0)
        drop_scene(r, r->held_count - 1);
    cJSON_Delete(r->files);
    cJSON_Delete(r->model);
    fxs_release(allocator, r->names);
    fxs_release(allocator, r->scenes);
    fxs_release(allocator, r->held);
    fxs_release(allocator, r->ranges);
}

static const fxs_motion *sog_motions(const void *handle)
{
    const sog_reader *r = handle;
    return r->scene && r->scene->timeline != NO_TIMELINE ? r->motions : NULL;
}

const fxs_reader fxs_read_sog = {is_sog, sizeof(sog_reader), sog_open, sog_read, sog_rewind, sog_close, sog_motions};
const fxs_reader fxs_read_tsog = {is_tsog, sizeof(sog_reader), sog_open, sog_read, sog_rewind, sog_close, sog_motions};
const fxs_reader fxs_read_lcc2 = {is_lcc2, sizeof(sog_reader), sog_open, sog_read, sog_rewind, sog_close, NULL};

#else

static int sog_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle, (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read .sog: built without libwebp or cJSON",
                       source->path);
}

const fxs_reader fxs_read_sog = {is_sog, 0, sog_open, NULL, NULL, NULL, NULL};
const fxs_reader fxs_read_tsog = {is_tsog, 0, sog_open, NULL, NULL, NULL, NULL};
const fxs_reader fxs_read_lcc2 = {is_lcc2, 0, sog_open, NULL, NULL, NULL, NULL};

#endif
