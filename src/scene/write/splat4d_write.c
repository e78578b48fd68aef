/* Writes .splat4d, version 1, of splats4D (adamraudonis/splats4D at bf7c41a: docs/FORMAT.md, and its converter, which
   precedes every stream with two bytes more). The Gaussians of a moving scene change their position, rotation and
   opacity only; so colours and scales are stored once. Where a Gaussian does not exist, its opacity is 0, and nothing
   else of it changes.

   All numbers are rounded to steps. A number changes from frame to frame only if it would be wrong by more than half a
   step. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene_write_internal.h"

#ifdef FXS_WITH_ZSTD

#include <zstd.h>

#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/base/report.h"
#include "src/gaussian/stream_internal.h"
#include "src/pack/encode.h"

enum { POSITION, ROTATION, COLOUR, OPACITY, SCALE, ATTRIBUTES };    /* as numbered in the file */
enum { KEY, DELTA, STILL };
enum { HEAD = 12, STREAM_HEAD = 11, NUMBERS = 8, MASKS = 16, FRAMES_MOST = 1 << 20 };
enum { LEVEL = 12, WINDOW_BITS = 23 };    /* of zstd; browsers unpack windows of up to 8 MiB */

/* Most numbers of a stream, and of bytes of each of its planes, where a group has more than one frame. */
#define STREAM_MOST ((uint64_t)1 << 28)

/* Largest errors: of positions in scene units, of scales as a share and as ln(1 + share). Positions of a small scene
   have a share of its size. */
static const double position_error = 0.002, position_share = 1.0 / 8192, scale_share = 0.02,
                    scale_error = 0.019802627296179713;
enum { OPACITY_ERROR = 2 };        /* of 255; steps of 5 have 0 and 255 */

/* Attributes that change: their place among the NUMBERS of a Gaussian in a frame, and their bit in the mask of a group
   of Gaussians. */
static const struct { int at, count, bit; } columns[ATTRIBUTES] = {
    [POSITION] = {0, 3, 1}, [ROTATION] = {3, 4, 2}, [OPACITY] = {7, 1, 8}
};
static const int changing[] = {POSITION, ROTATION, OPACITY};
enum { CHANGING = sizeof changing / sizeof *changing };

typedef struct held {
    float position[3], scale[3], rotation[4], opacity, dc[3];
    fxs_motion motion;
    uint8_t mask;              /* bits of the attributes that change */
    int32_t still[NUMBERS];    /* numbers of the attributes that do not */
} held;

typedef struct bytes {
    uint8_t *data;
    size_t size, room;
} bytes;

/* Numbers of a stream: byte k of number i is planes[k][i]. */
typedef struct numbers {
    uint8_t *planes[4];
    size_t count, next;
    int width;
} numbers;

typedef struct part {
    size_t offset, size, first, end;
} part;

typedef struct splat4d_writer {
    fxs_output output;
    fxs_time time;
    held *gaussians;
    uint64_t *order;           /* the lower 32 bits: index of a Gaussian */
    uint32_t count, next;
    double rate;
    uint32_t frames, group;    /* number of frames, of all and of a group of them */
    double steps[ATTRIBUTES], errors[ATTRIBUTES], least[3], most[3];
    uint32_t counts[ATTRIBUTES], masks[MASKS];    /* numbers of Gaussians that change an attribute, and with a mask */
    bytes body;
    size_t still_size;         /* the static section is at the beginning of the body */
    part *groups;
    const fxs_progress *progress;
} splat4d_writer;

/* ---- Gaussians --------------------------------------------------------------------------------------------------- */

static int splat4d_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    splat4d_writer *w = writer;
    if (o->count > FXS_MAX_COUNT)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: more than %u Gaussians", path, FXS_MAX_COUNT);
    w->time = o->time;
    w->rate = o->time.rate > 0 ? o->time.rate : 30;
    const double frames = floor(o->time.duration * w->rate + 0.5);
    if (!(frames <= FRAMES_MOST))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a .splat4d of more than %d frames", path, FRAMES_MOST);
    w->frames = frames > 1 ? (uint32_t)frames : 1;
    w->count = (uint32_t)o->count;
    w->gaussians = malloc(w->count * sizeof *w->gaussians + 1);
    const int error = w->gaussians ? fxs_output_open(&w->output, path, o->count, message)
                                   : fxs_fail_memory(message, path, w->count * sizeof *w->gaussians);
    if (error)
        free(w->gaussians);
    return error;
}

static int splat4d_put_moving(void *writer, const fxs_gaussian *gaussians, const fxs_motion *motions, size_t n,
                              fxs_message *message)
{
    splat4d_writer *w = writer;
    FXS_TRY(fxs_output_expect(&w->output, n, message));
    for (size_t i = 0; i < n; i++) {
        held *h = &w->gaussians[w->next++];
        memset(h, 0, sizeof *h);
        memcpy(h->position, gaussians[i].position, sizeof h->position);
        memcpy(h->scale, gaussians[i].scale, sizeof h->scale);
        memcpy(h->rotation, gaussians[i].rotation, sizeof h->rotation);
        memcpy(h->dc, gaussians[i].dc, sizeof h->dc);
        h->opacity = gaussians[i].opacity;
        h->motion = motions ? motions[i] : fxs_still;
    }
    return 0;
}

static int splat4d_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return splat4d_put_moving(writer, gaussians, NULL, n, message);
}

static double within(double x, double low, double high)
{
    return x > low ? x < high ? x : high : low;
}

static double whole_within(double x, double low, double high)
{
    return within(floor(x + 0.5), low, high);
}

static void take_rotation(double *to, const float q[4])
{
    double norm = 0;
    for (int k = 0; k < 4; k++)
        norm += (double)q[k] * q[k];
    norm = sqrt(norm);
    for (int k = 0; k < 4; k++)
        to[k] = norm > 0 ? whole_within(128 * q[k] / norm, -128, 127) : k ? 0 : 127;
}

/* Finds the numbers of a Gaussian in a frame. Returns 0 if it is not seen then, with an opacity of 0. */
static int at_frame(const splat4d_writer *w, const held *h, uint32_t frame, double values[NUMBERS])
{
    /* the times of Gaussians are floats */
    const double seconds = w->time.duration > 0 ? (double)(float)(frame / w->rate) : 0;
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    memcpy(g.position, h->position, sizeof g.position);
    memcpy(g.rotation, h->rotation, sizeof g.rotation);
    g.opacity = h->opacity;
    const int exists = fxs_gaussian_at(&g, &h->motion, &w->time, seconds);
    for (int k = 0; k < 3; k++)
        values[k] = within(g.position[k], -0x1p27, 0x1p27);
    take_rotation(values + columns[ROTATION].at, g.rotation);
    const double opacity = exists ? whole_within(255 * fxs_opacity_of_logit(g.opacity), 0, 255) : 0;
    values[columns[OPACITY].at] = opacity;
    return opacity > 0;
}

static uint32_t frame_within(const splat4d_writer *w, double frame)
{
    return (uint32_t)within(frame, 0, w->frames);
}

/* Finds the frames, *first to *end - 1, outside of which a Gaussian is not seen. */
static void frames_of(const splat4d_writer *w, const held *h, uint32_t *first, uint32_t *end)
{
    const fxs_motion *m = &h->motion;
    const double reach = 2.5 * (double)m->fade;    /* there, an opacity is at most 255 e^-6.25, less than a half */
    const double from = fmax(m->from, m->centre - reach), to = fmin(m->to, m->centre + reach);
    *first = frame_within(w, floor(from * w->rate) - 1);
    *end = frame_within(w, ceil(to * w->rate) + 2);
}

/* The numbers of a Gaussian over all frames in which it is seen. */
typedef struct survey {
    double least[NUMBERS], most[NUMBERS];
    uint32_t seen;             /* number of these frames */
} survey;

static survey survey_of(const splat4d_writer *w, const held *h)
{
    survey s = {{0}, {0}, 0};
    uint32_t first, end;
    double now[NUMBERS];
    frames_of(w, h, &first, &end);
    for (uint32_t f = first; f < end; f++)
        if (at_frame(w, h, f, now)) {
            for (int k = 0; k < NUMBERS; k++) {
                s.least[k] = s.seen ? fmin(s.least[k], now[k]) : now[k];
                s.most[k] = s.seen ? fmax(s.most[k], now[k]) : now[k];
            }
            s.seen++;
        }
    return s;
}

static void choose_steps(splat4d_writer *w)
{
    double size = 0, far = 0;
    int any = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        const survey s = survey_of(w, &w->gaussians[i]);
        for (int k = 0; k < 3 && s.seen; k++) {
            w->least[k] = any ? fmin(w->least[k], s.least[k]) : s.least[k];
            w->most[k] = any ? fmax(w->most[k], s.most[k]) : s.most[k];
        }
        any |= s.seen > 0;
    }
    for (int k = 0; k < 3; k++) {
        size = fmax(size, w->most[k] - w->least[k]);
        far = fmax(far, fmax(fabs(w->most[k]), fabs(w->least[k])));
    }
    const double wanted = size > 0 ? fmin(position_error, size * position_share) : position_error;
    w->errors[POSITION] = fmax(wanted, far * 0x1p-29);     /* numbers of positions have 31 bits */
    w->errors[OPACITY] = OPACITY_ERROR;
    w->errors[SCALE] = scale_error;
    w->steps[POSITION] = 2 * w->errors[POSITION];
    w->steps[SCALE] = 2 * w->errors[SCALE];
    w->steps[ROTATION] = 1;
    w->steps[OPACITY] = 2 * OPACITY_ERROR + 1;
}

/* Finds the still number of each attribute, in the middle of its values, and the attributes for which it is wrong. */
static void find_changes(splat4d_writer *w, held *h)
{
    survey s = survey_of(w, h);
    if (!s.seen) {
        at_frame(w, h, 0, s.least);
        s.least[columns[OPACITY].at] = 0;
        memcpy(s.most, s.least, sizeof s.most);
    } else if (s.seen < w->frames)
        s.least[columns[OPACITY].at] = 0;
    for (int n = 0; n < CHANGING; n++) {
        const int a = changing[n];
        const double step = a == POSITION ? w->errors[a] : 1;
        for (int k = columns[a].at; k < columns[a].at + columns[a].count; k++) {
            const double middle = floor((s.least[k] + s.most[k]) / 2 / step + 0.5);
            h->still[k] = (int32_t)within(middle, -0x1p30, 0x1p30);
            if (s.most[k] - middle * step > w->errors[a] || middle * step - s.least[k] > w->errors[a] ||
                (a == OPACITY && s.least[k] < s.most[k] && s.least[k] <= 0))
                h->mask |= (uint8_t)columns[a].bit;
        }
        w->counts[a] += (h->mask & columns[a].bit) != 0;
    }
    w->masks[h->mask]++;
}

/* ---- Order ------------------------------------------------------------------------------------------------------- */

/* Returns the place of a Gaussian on a Morton curve of 9 bits an axis. */
static uint64_t place_on_curve(const splat4d_writer *w, const held *h)
{
    enum { BITS = 9 };
    uint64_t place = 0;
    for (int k = 0; k < 3; k++) {
        const double size = w->most[k] - w->least[k], x = h->still[k] * w->errors[POSITION] - w->least[k];
        const uint32_t cell = size > 0 ? (uint32_t)within(x / size * (1 << BITS), 0, (1 << BITS) - 1) : 0;
        for (int bit = 0; bit < BITS; bit++)
            place |= (uint64_t)(cell >> bit & 1) << (3 * bit + k);
    }
    return place;
}

static int by_place(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Orders the Gaussians by their masks, as players of the format need it, then in space. */
static void order(splat4d_writer *w)
{
    for (uint32_t i = 0; i < w->count; i++) {
        const held *h = &w->gaussians[i];
        w->order[i] = ((uint64_t)h->mask << 27 | place_on_curve(w, h)) << 32 | i;
    }
    qsort(w->order, w->count, sizeof *w->order, by_place);
}

static const held *ordered(const splat4d_writer *w, uint32_t i)
{
    return &w->gaussians[(uint32_t)w->order[i]];
}

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

static int begin_numbers(numbers *n, uint64_t count)
{
    *n = (numbers){.count = (size_t)count, .width = 1};
    n->planes[0] = calloc(n->count + 1, 1);
    return n->planes[0] ? 0 : ENOMEM;
}

static void end_numbers(numbers *n)
{
    for (int k = 0; k < 4; k++)
        free(n->planes[k]);
}

/* Sets number i, which was 0. Makes room for larger numbers. */
static int set_number(numbers *n, size_t i, uint32_t number)
{
    while (n->width < 4 && number >> 8 * n->width) {
        const int wider = 2 * n->width;
        for (; n->width < wider; n->width++)
            if (!(n->planes[n->width] = calloc(n->count, 1)))
                return ENOMEM;
    }
    for (int k = 0; k < n->width; k++)
        n->planes[k][i] = (uint8_t)(number >> 8 * k);
    return 0;
}

static int add_number(numbers *n, uint32_t number)
{
    return set_number(n, n->next++, number);
}

/* Returns 0, 1, 2, 3, 4, ... for 0, -1, 1, -2, 2, ... */
static uint32_t folded(uint32_t number)
{
    return number << 1 ^ (0 - (number >> 31));
}

static int reserve(bytes *b, size_t more)
{
    if (b->room - b->size >= more)
        return 0;
    const size_t room = b->size + more + b->size / 2;
    uint8_t *data = realloc(b->data, room);
    if (!data)
        return ENOMEM;
    b->data = data;
    b->room = room;
    return 0;
}

static int pack_planes(bytes *to, ZSTD_CCtx *zstd, const numbers *n)
{
    ZSTD_outBuffer out = {to->data, to->room, to->size};
    for (int k = 0; k < n->width; k++) {
        ZSTD_inBuffer in = {n->planes[k], n->count, 0};
        const int last = k == n->width - 1;
        const size_t left = ZSTD_compressStream2(zstd, &out, &in, last ? ZSTD_e_end : ZSTD_e_continue);
        if (ZSTD_isError(left) || in.pos < in.size || (last && left))
            return ENOMEM;
    }
    to->size = out.pos;
    return 0;
}

/* Appends numbers as one zstd frame. */
static int pack(bytes *to, const numbers *n)
{
    const size_t size = n->count * (size_t)n->width;
    ZSTD_CCtx *zstd = ZSTD_createCCtx();
    int error = !zstd || reserve(to, ZSTD_compressBound(size)) ? ENOMEM : 0;
    if (!error) {
        ZSTD_CCtx_setParameter(zstd, ZSTD_c_compressionLevel, LEVEL);
        ZSTD_CCtx_setParameter(zstd, ZSTD_c_windowLog, WINDOW_BITS);
        ZSTD_CCtx_setPledgedSrcSize(zstd, size);
        error = pack_planes(to, zstd, n);
    }
    ZSTD_freeCCtx(zstd);
    return error;
}

/* Appends numbers to the body of the file, and writes the head of the stream to `head` in the body. */
static int put_stream(splat4d_writer *w, int attribute, int kind, const numbers *n, size_t head)
{
    const size_t before = w->body.size;
    const int error = pack(&w->body, n);
    if (error)
        return error;
    uint8_t *to = w->body.data + head;
    *to++ = (uint8_t)attribute;
    *to++ = (uint8_t)kind;
    *to++ = (uint8_t)n->width;
    to = fxs_put_u32(to, (uint32_t)n->count);
    fxs_put_u32(to, (uint32_t)(w->body.size - before));
    return 0;
}

/* ---- Attributes that stay the same ------------------------------------------------------------------------------- */

static int add_mask(const splat4d_writer *w, numbers *n, int attribute)
{
    for (uint32_t i = 0; i < w->count; i++)
        n->planes[0][i / 8] |= (uint8_t)(ordered(w, i)->mask & columns[attribute].bit ? 0 : 128 >> i % 8);
    return 0;
}

static int32_t base_of(const splat4d_writer *w, const held *h, int attribute, int k)
{
    if (attribute == COLOUR)
        return (int32_t)whole_within(255 * fxs_colour_of_dc(h->dc[k]), 0, 255);
    if (attribute == SCALE)
        return (int32_t)floor(within(h->scale[k], FXS_FLAT_SCALE, -FXS_FLAT_SCALE) / w->errors[SCALE] + 0.5);
    return h->still[columns[attribute].at + k] + (attribute == ROTATION ? 128 : 0);
}

/* Positions and scales are differences between Gaussians. */
static int add_base(const splat4d_writer *w, numbers *n, int attribute, int count)
{
    uint32_t before[4] = {0};
    int error = 0;
    for (uint32_t i = 0; i < w->count; i++)
        for (int k = 0; k < count; k++) {
            const uint32_t number = (uint32_t)base_of(w, ordered(w, i), attribute, k);
            error |= add_number(n, attribute == POSITION || attribute == SCALE ? folded(number - before[k]) : number);
            before[k] = number;
        }
    return error;
}

static int put_still(splat4d_writer *w)
{
    static const struct { int attribute, count; } streams[] = {    /* count 0: a mask */
        {POSITION, 0}, {ROTATION, 0}, {COLOUR, 0}, {OPACITY, 0}, {SCALE, 0},
        {POSITION, 3}, {SCALE, 3}, {COLOUR, 3}, {OPACITY, 1}, {ROTATION, 4}
    };
    int error = 0;
    for (size_t s = 0; s < sizeof streams / sizeof *streams && !error; s++) {
        const int a = streams[s].attribute, count = streams[s].count;
        const size_t head = w->body.size;
        numbers n;
        error = begin_numbers(&n, count ? (uint64_t)w->count * (unsigned)count : (w->count + 7) / 8);
        if (!error)
            error = count ? add_base(w, &n, a, count) : add_mask(w, &n, a);
        if (!error)
            error = reserve(&w->body, STREAM_HEAD);
        w->body.size += error ? 0 : STREAM_HEAD;
        if (!error)
            error = put_stream(w, a, STILL, &n, head);
        end_numbers(&n);
    }
    w->still_size = w->body.size;
    return error;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Rounds the numbers of an attribute to steps, if those of the frame before are wrong by more than the error. Returns 1
   if so. */
static int step_on(const splat4d_writer *w, int attribute, int known, int32_t steps[4], const double *values)
{
    const double step = w->steps[attribute], error = w->errors[attribute];
    int holds = known;
    for (int k = 0; k < columns[attribute].count; k++)
        holds &= fabs(values[k] - steps[k] * step) <= error;
    for (int k = 0; k < columns[attribute].count && !holds; k++)
        steps[k] = (int32_t)floor((values[k] + error) / step);
    return !holds;
}

/* Sets the numbers of Gaussian i of those that change an attribute, in a group of frames. The keys are those of the
   first frame in which it is seen; so nothing changes while it is not. */
static int set_frames(const splat4d_writer *w, const part *g, const held *h, int attribute, int kind, numbers *n,
                      size_t i)
{
    const size_t count = (size_t)columns[attribute].count, row = w->counts[attribute] * count;
    double now[NUMBERS];
    int32_t steps[4] = {attribute == ROTATION ? 127 : 0}, before[4];
    uint32_t from, to;
    int error = 0;
    frames_of(w, h, &from, &to);
    int known = attribute == OPACITY && from > g->first;
    for (size_t f = from > g->first ? from : g->first; f < g->end && f < to && !(kind == KEY && known); f++) {
        if (!at_frame(w, h, (uint32_t)f, now) && attribute != OPACITY)
            continue;
        memcpy(before, steps, sizeof before);
        if (step_on(w, attribute, known, steps, now + columns[attribute].at) && known)
            for (size_t k = 0; k < count; k++)
                error |= set_number(n, (f - g->first - 1) * row + i * count + k,
                                    folded((uint32_t)steps[k] - (uint32_t)before[k]));
        known = 1;
    }
    for (size_t k = 0; k < count && kind == KEY; k++)
        error |= set_number(n, i * count + k, folded((uint32_t)steps[k]));
    return error;
}

static int put_frames(splat4d_writer *w, const part *g, int attribute, int kind, size_t head)
{
    const uint64_t rows = kind == KEY ? 1 : g->end - g->first - 1;
    numbers n;
    int error = begin_numbers(&n, rows * w->counts[attribute] * (unsigned)columns[attribute].count);
    for (uint32_t i = 0, place = 0; i < w->count && !error; i++) {
        const held *h = ordered(w, i);
        if (h->mask & columns[attribute].bit)
            error = set_frames(w, g, h, attribute, kind, &n, place++);
    }
    if (!error)
        error = put_stream(w, attribute, kind, &n, head);
    end_numbers(&n);
    return error;
}

static int put_group(splat4d_writer *w, part *g)
{
    const int kinds = g->end - g->first > 1 ? 2 : 1;
    int streams = 0, error;
    g->offset = w->body.size;
    for (int n = 0; n < CHANGING; n++)
        streams += w->counts[changing[n]] ? kinds : 0;
    size_t head = g->offset + 2;
    error = reserve(&w->body, 2 + (size_t)streams * STREAM_HEAD);
    if (error)
        return error;
    w->body.data[g->offset] = (uint8_t)streams;
    w->body.data[g->offset + 1] = 0;
    w->body.size = head + (size_t)streams * STREAM_HEAD;
    for (int kind = KEY; kind < kinds; kind++)
        for (int n = 0; n < CHANGING && !error; n++)
            if (w->counts[changing[n]]) {
                error = put_frames(w, g, changing[n], kind, head);
                head += STREAM_HEAD;
            }
    g->size = w->body.size - g->offset;
    return error;
}

static uint32_t group_count(const splat4d_writer *w)
{
    return (w->frames + w->group - 1) / w->group;
}

static int put_groups(splat4d_writer *w)
{
    const uint64_t most = STREAM_MOST / (4 * ((uint64_t)w->count + 1));
    w->group = (uint32_t)within(floor(w->rate + 0.5), 1, most > 1 ? (double)most : 1);
    w->groups = calloc(group_count(w), sizeof *w->groups);
    int error = w->groups ? 0 : ENOMEM;
    for (uint32_t i = 0; i < group_count(w) && !error; i++) {
        part *g = &w->groups[i];
        g->first = (size_t)i * w->group;
        g->end = g->first + w->group < w->frames ? g->first + w->group : w->frames;
        error = put_group(w, g);
        if (!error && fxs_report(w->progress, (double)g->end / w->frames))
            error = ECANCELED;
    }
    return error;
}

/* ---- File -------------------------------------------------------------------------------------------------------- */

static void print(FILE *file, const char *before, double number)
{
    fputs(before, file);
    fxs_print_number(file, 17, number);
}

static void print_steps(FILE *file, const splat4d_writer *w)
{
    print(file, ",\"bounds\":{\"pos_m\":", w->errors[POSITION]);
    print(file, ",\"scale_rel\":", scale_share);
    fprintf(file, ",\"rgb\":0,\"alpha\":%d,\"rot\":0}", OPACITY_ERROR);
    print(file, ",\"steps\":{\"pos\":", w->steps[POSITION]);
    print(file, ",\"base_pos\":", w->errors[POSITION]);
    print(file, ",\"scale_log\":", w->steps[SCALE]);
    print(file, ",\"base_scale_log\":", w->errors[SCALE]);
    fprintf(file, ",\"rgb\":1,\"alpha\":%d,\"rot\":1}", 2 * OPACITY_ERROR + 1);
}

static void print_masks(FILE *file, const splat4d_writer *w)
{
    const char *comma = "";
    fprintf(file, ",\"dyn\":{\"pos\":%" PRIu32 ",\"rot\":%" PRIu32 ",\"rgb\":0,\"alpha\":%" PRIu32 ",\"scale\":0}",
            w->counts[POSITION], w->counts[ROTATION], w->counts[OPACITY]);
    fputs(",\"groups\":[", file);
    for (int mask = 0; mask < MASKS; mask++)
        if (w->masks[mask]) {
            fprintf(file, "%s{\"mask\":%d,\"count\":%" PRIu32 "}", comma, mask, w->masks[mask]);
            comma = ",";
        }
    fputs("],\"aabb\":[", file);
    for (int k = 0; k < 6; k++)
        print(file, k ? "," : "", k < 3 ? w->least[k] : w->most[k - 3]);
    fputs("]", file);
}

/* The body of the file begins at `at`. Offsets have a fixed width, so that the length of the text does not depend on
   it. */
static void print_header(FILE *file, const splat4d_writer *w, size_t at)
{
    fprintf(file, "{\"n\":%" PRIu32 ",\"t\":%" PRIu32 ",\"gop\":%" PRIu32, w->count, w->frames, w->group);
    print(file, ",\"fps\":", w->rate);
    print_steps(file, w);
    print_masks(file, w);
    fprintf(file, ",\"denoised\":false,\"static_section\":{\"offset\":%20zu,\"len\":%zu},\"gops\":[", at,
            w->still_size);
    for (uint32_t i = 0; i < group_count(w); i++) {
        const part *g = &w->groups[i];
        fprintf(file, "%s{\"offset\":%20zu,\"len\":%zu,\"f0\":%zu,\"f1\":%zu", i ? "," : "", at + g->offset, g->size,
                g->first, g->end - 1);
        print(file, ",\"t0\":", (double)g->first / w->rate);
        print(file, ",\"t1\":", (double)(g->end - 1) / w->rate);
        fputs("}", file);
    }
    fputs("]}", file);
}

static int make_header(const splat4d_writer *w, size_t at, fxs_printed *printed)
{
    if (fxs_print_begin(printed))
        return ENOMEM;
    print_header(printed->file, w, at);
    return fxs_print_end(printed) ? ENOMEM : 0;
}

static int make(splat4d_writer *w, fxs_printed *header)
{
    choose_steps(w);
    for (uint32_t i = 0; i < w->count; i++)
        find_changes(w, &w->gaussians[i]);
    w->order = calloc((size_t)w->count + 1, sizeof *w->order);
    if (!w->order)
        return ENOMEM;
    order(w);
    int error = put_still(w);
    if (!error)
        error = put_groups(w);
    if (!error)
        error = make_header(w, 0, header);
    if (error)
        return error;
    const size_t length = header->size;
    free(header->text);
    header->text = NULL;
    return make_header(w, HEAD + length, header);
}

static void write(splat4d_writer *w, const fxs_printed *header, fxs_message *message)
{
    uint8_t head[HEAD] = "SP4D\1";
    fxs_put_u32(head + 8, (uint32_t)header->size);
    if (!fxs_output_write(&w->output, head, HEAD, message) &&
        !fxs_output_write(&w->output, header->text, header->size, message))
        fxs_output_write(&w->output, w->body.data, w->body.size, message);
}

static int splat4d_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                         fxs_message *message)
{
    splat4d_writer *w = writer;
    fxs_printed header = {NULL, NULL, 0};
    (void)report;
    w->progress = progress;
    if (w->next == w->count && !w->output.error)
        w->output.error = make(w, &header);
    if (w->next == w->count && !w->output.error)
        write(w, &header, message);
    const int result = fxs_output_close(&w->output, message);
    free(header.text);
    free(w->body.data);
    free(w->groups);
    free(w->order);
    free(w->gaussians);
    return result;
}

const fxs_writer fxs_write_splat4d = {
    sizeof(splat4d_writer), splat4d_open, splat4d_put, splat4d_close, splat4d_put_moving
};

#else

static int splat4d_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    (void)writer, (void)o;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot write .splat4d: built without zstd", path);
}

const fxs_writer fxs_write_splat4d = {0, splat4d_open, NULL, NULL, NULL};

#endif
