/* Reads .splat4d, version 1, of splats4D (adamraudonis/splats4D at bf7c41a: docs/FORMAT.md, and its converter, which
   precedes every stream with two bytes more). A Gaussian is a row of integers. Some of its attributes are still; the
   others have numbers in every frame: those of the first frame of a group, then differences between frames.

   Gaussians that are still in all attributes are read as they are. The frames of the others become tracks. */
#include "src/base/byte_reader.h"
#include "src/base/os_calls.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

#define MAGIC "SP4D"

static int is_splat4d(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, MAGIC, 4) || fxs_ends_in(head->source->path, ".splat4d");
}

#if defined(FXS_WITH_ZSTD) && defined(FXS_WITH_CJSON)

#include <errno.h>

#include <cjson/cJSON.h>
#include <zstd.h>

#include "src/base/fail_list.h"
#include "src/scene/sequence.h"

enum { HEAD = 12, STREAM_HEAD = 11, BATCH = 512, ROW = 14 };
enum { POSITION, ROTATION, COLOUR, OPACITY, SCALE, ATTRIBUTES, ALL_STILL = (1 << ATTRIBUTES) - 1 };
enum { KEY, DELTA, KINDS };

static const struct { int at, count; } columns[ATTRIBUTES] = {{0, 3}, {3, 4}, {7, 3}, {10, 1}, {11, 3}};

/* Most bytes that streams unpack to: a multiple of the file's size, and what small files may have anyway. */
#define UNPACKED_RATIO 2048
#define UNPACKED_ALWAYS ((uint64_t)1 << 26)

/* Frames `first` to `end` - 1 and their place in the file. */
typedef struct group {
    size_t offset, size, first, end;
} group;

typedef struct stream {
    uint8_t *bytes;      /* byte k of number i is at k * count + i */
    size_t count;
    int width;
} stream;

typedef struct splat4d_reader {
    const fxs_scene_source *source;
    size_t count, frames;
    double rate;
    double steps[ATTRIBUTES], still_steps[ATTRIBUTES];
    group *groups;
    size_t group_count;
    uint8_t *still;               /* bit a of entry i: attribute a of Gaussian i is the same in all frames */
    uint32_t *numbers;            /* ROW of each Gaussian, in the frame `frame` */
    uint32_t *moving;             /* indices of the Gaussians with an attribute that is not still */
    size_t moving_count;
    size_t changing[ATTRIBUTES];  /* number of Gaussians whose attribute is not still */
    stream streams[ATTRIBUTES][KINDS];
    const group *group;           /* group of the streams; null: none yet */
    size_t frame;
    uint64_t unpacked;
    fxs_sequence *sequence;       /* tracks of the Gaussians that are not still */
    size_t next;                  /* next Gaussian to read that may be still */
    uint64_t next_track;
    fxs_motion motions[BATCH];
} splat4d_reader;

static int fail(const splat4d_reader *r, const char *fault, fxs_message *message)
{
    return fxs_fail(message, "%s: %s", r->source->path, fault);
}

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* ---- Header ------------------------------------------------------------------------------------------------------ */

static int is_step(const cJSON *steps, const char *name, double *step)
{
    const cJSON *item = member(steps, name);
    *step = cJSON_IsNumber(item) ? item->valuedouble : 0;
    return *step > 0 && *step <= 1e6;
}

static int read_steps(splat4d_reader *r, const cJSON *steps)
{
    int ok = is_step(steps, "pos", &r->steps[POSITION]) && is_step(steps, "base_pos", &r->still_steps[POSITION]) &&
             is_step(steps, "scale_log", &r->steps[SCALE]) &&
             is_step(steps, "base_scale_log", &r->still_steps[SCALE]);
    static const char *const names[] = {[ROTATION] = "rot", [COLOUR] = "rgb", [OPACITY] = "alpha"};
    for (int a = ROTATION; a <= OPACITY; a++) {
        size_t step = 0;
        ok &= fxs_json_whole(member(steps, names[a]), 511, &step) && step > 0;
        r->steps[a] = (double)step;
    }
    return ok;
}

static int is_part(const splat4d_reader *r, const cJSON *item, size_t *offset, size_t *size)
{
    const uint64_t bytes = r->source->input.size;
    const size_t most = bytes < SIZE_MAX ? (size_t)bytes : SIZE_MAX;
    return fxs_json_whole(member(item, "offset"), most, offset) && fxs_json_whole(member(item, "len"), most, size) &&
           *size <= bytes - *offset;
}

static int read_groups(splat4d_reader *r, const cJSON *list, fxs_message *message)
{
    const cJSON *item;
    size_t end = 0, last;
    if (!cJSON_IsArray(list))
        return fail(r, "no valid \"gops\", the groups of frames", message);
    r->group_count = (size_t)cJSON_GetArraySize(list);
    r->groups = fxs_hold(r->source, (r->group_count + 1) * sizeof *r->groups, message);
    if (!r->groups)
        return FXS_ERR_MEMORY;
    group *g = r->groups;
    cJSON_ArrayForEach(item, list) {
        if (!is_part(r, item, &g->offset, &g->size) || !fxs_json_whole(member(item, "f0"), r->frames, &g->first) ||
            !fxs_json_whole(member(item, "f1"), r->frames - 1, &last) || last < g->first)
            return fail(r, "a group of frames without valid \"offset\", \"len\", \"f0\" and \"f1\", or the file ends "
                        "early", message);
        if (g->first != end)
            return fxs_fail(message, "%s: a group begins with frame %zu, not %zu", r->source->path, g->first, end);
        end = g->end = last + 1;
        g++;
    }
    if (end != r->frames)
        return fxs_fail(message, "%s: groups of %zu frames, but the header tells of %zu", r->source->path, end,
                        r->frames);
    return 0;
}

static int read_header(splat4d_reader *r, const cJSON *root, fxs_message *message)
{
    const cJSON *rate = member(root, "fps");
    if (!fxs_json_whole(member(root, "n"), INT32_MAX, &r->count) || r->count == 0 ||
        !fxs_json_whole(member(root, "t"), INT32_MAX, &r->frames) || r->frames == 0)
        return fail(r, "no valid \"n\" and \"t\", the numbers of Gaussians and frames", message);
    FXS_TRY(fxs_limit_gaussians(r->source, r->count, message));
    r->rate = cJSON_IsNumber(rate) ? rate->valuedouble : 0;
    if (!(r->rate >= 1e-3 && r->rate <= 1e6))
        return fail(r, "no valid \"fps\"", message);
    if (!read_steps(r, member(root, "steps")))
        return fail(r, "no valid \"steps\"", message);
    return read_groups(r, member(root, "gops"), message);
}

static int load_header(splat4d_reader *r, size_t *still_offset, size_t *still_size, fxs_message *message)
{
    const uint64_t size = r->source->input.size;
    uint8_t head[HEAD] = {0};
    fxs_text json;
    cJSON *root = NULL;
    FXS_TRY(fxs_scene_source_read(r->source, 0, head, size < HEAD ? (size_t)size : HEAD, message));
    if (memcmp(head, MAGIC, 4))
        return fail(r, "a .splat4d of another kind (of FreeTimeGsVanilla's exporter for Unity, perhaps): those of "
                    "splats4D, which begin with SP4D, are read", message);
    if (fxs_load_u16(head + 4) != 1)
        return fxs_fail(message, "%s: .splat4d version %d, not 1", r->source->path, fxs_load_u16(head + 4));
    const uint32_t length = fxs_load_u32(head + 8);
    if (size < HEAD || length > size - HEAD)
        return fail(r, "the file ends early", message);
    FXS_TRY(fxs_scene_source_load(r->source, HEAD, length, &json, message));
    int error = fxs_json_parse(&json, r->source, &root, message);
    fxs_text_let_go(r->source, &json);
    if (!error)
        error = read_header(r, root, message);
    if (!error && !is_part(r, member(root, "static_section"), still_offset, still_size))
        error = fail(r, "no valid \"static_section\", or the file ends early", message);
    cJSON_Delete(root);
    return error;
}

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

static void drop_stream(const splat4d_reader *r, stream *s)
{
    fxs_let_go(r->source, s->bytes, s->count * (size_t)s->width);
    s->bytes = NULL;
}

static int unpack(splat4d_reader *r, stream *s, uint64_t offset, uint32_t packed, fxs_message *message)
{
    const size_t size = s->count * (size_t)s->width;
    fxs_text text;
    r->unpacked += size;
    if (r->unpacked > UNPACKED_RATIO * r->source->input.size + UNPACKED_ALWAYS)
        return fail(r, "its streams unpack to far more bytes than the file has", message);
    FXS_TRY(fxs_scene_source_load(r->source, offset, packed, &text, message));
    s->bytes = fxs_hold(r->source, size, message);
    int error = s->bytes ? 0 : FXS_ERR_MEMORY;
    errno = 0;
    if (!error && ZSTD_decompress(s->bytes, size, text.data, packed) != size)
        error = fxs_fail_library(message, r->source->path, "%s: a zstd stream is damaged, or of another size than its "
                                 "header asks for", r->source->path);
    fxs_text_let_go(r->source, &text);
    return error;
}

/* Reads a stream of `count` numbers. head: its width, count and packed size. */
static int load_stream(splat4d_reader *r, stream *s, const uint8_t *head, uint64_t count, uint64_t offset, uint64_t end,
                       fxs_message *message)
{
    const uint32_t packed = fxs_load_u32(head + 5);
    s->width = head[0];
    s->count = fxs_load_u32(head + 1);
    if (s->width != 1 && s->width != 2 && s->width != 4)
        return fxs_fail(message, "%s: a stream of numbers of %d bytes, not 1, 2 or 4", r->source->path, s->width);
    if (s->count != count)
        return fxs_fail(message, "%s: a stream of %zu numbers, not %llu", r->source->path, s->count,
                        (unsigned long long)count);
    if (offset > end || packed > end - offset)
        return fail(r, "a stream ends after its section", message);
    return unpack(r, s, offset, packed, message);
}

static uint32_t number_at(const stream *s, size_t i)
{
    uint32_t number = 0;
    for (int k = 0; k < s->width; k++)
        number |= (uint32_t)s->bytes[(size_t)k * s->count + i] << 8 * k;
    return number;
}

/* Returns the signed number of 0, 1, 2, 3, 4, ..., which stand for 0, -1, 1, -2, 2, ... */
static uint32_t signed_of(uint32_t number)
{
    return number >> 1 ^ (0 - (number & 1));
}

/* ---- Attributes that stay the same ------------------------------------------------------------------------------- */

static int load_still(splat4d_reader *r, stream *s, uint64_t count, uint64_t *offset, uint64_t end,
                      fxs_message *message)
{
    uint8_t head[STREAM_HEAD];
    if (end - *offset < STREAM_HEAD)
        return fail(r, "the static section ends early", message);
    FXS_TRY(fxs_scene_source_read(r->source, *offset, head, STREAM_HEAD, message));
    *offset += STREAM_HEAD;
    const int error = load_stream(r, s, head + 2, count, *offset, end, message);
    *offset += error ? 0 : fxs_load_u32(head + 7);
    return error;
}

static void take_mask(splat4d_reader *r, int attribute, const stream *s)
{
    for (size_t i = 0; i < r->count; i++) {
        const int still = (int)(number_at(s, i / 8) >> (7 - i % 8) & 1);
        r->still[i] |= (uint8_t)(still << attribute);
        r->changing[attribute] += !still;
    }
}

/* Positions and scales are differences between Gaussians, rotations are 128 and more above their number. */
static void take_base(splat4d_reader *r, int attribute, const stream *s)
{
    const int n = columns[attribute].count;
    uint32_t sums[4] = {0};
    for (size_t i = 0; i < r->count; i++)
        for (int k = 0; k < n; k++) {
            const uint32_t number = number_at(s, i * (size_t)n + (size_t)k);
            sums[k] += signed_of(number);
            r->numbers[i * ROW + (size_t)(columns[attribute].at + k)] =
                attribute == POSITION || attribute == SCALE ? sums[k] : attribute == ROTATION ? number - 128 : number;
        }
}

static int load_still_section(splat4d_reader *r, uint64_t offset, uint64_t size, fxs_message *message)
{
    static const int masks[ATTRIBUTES] = {POSITION, ROTATION, COLOUR, OPACITY, SCALE};
    static const int bases[ATTRIBUTES] = {POSITION, SCALE, COLOUR, OPACITY, ROTATION};
    const uint64_t end = offset + size;
    for (int i = 0; i < 2 * ATTRIBUTES; i++) {
        stream s = {NULL, 0, 0};
        const int attribute = i < ATTRIBUTES ? masks[i] : bases[i - ATTRIBUTES];
        const uint64_t count = i < ATTRIBUTES ? (r->count + 7) / 8
                                              : (uint64_t)r->count * (uint64_t)columns[attribute].count;
        const int error = load_still(r, &s, count, &offset, end, message);
        if (!error && i < ATTRIBUTES)
            take_mask(r, attribute, &s);
        else if (!error)
            take_base(r, attribute, &s);
        drop_stream(r, &s);
        FXS_TRY(error);
    }
    return offset == end ? 0 : fail(r, "there are bytes behind the last stream of the static section", message);
}

/* Frames visit only the Gaussians in this list, so that their work is in proportion to their streams. */
static int list_moving(splat4d_reader *r, fxs_message *message)
{
    size_t count = 0;
    for (size_t i = 0; i < r->count; i++)
        r->moving_count += r->still[i] != ALL_STILL;
    r->moving = fxs_hold(r->source, (r->moving_count + 1) * sizeof *r->moving, message);
    for (size_t i = 0; i < r->count && r->moving; i++)
        if (r->still[i] != ALL_STILL)
            r->moving[count++] = (uint32_t)i;
    return r->moving ? 0 : FXS_ERR_MEMORY;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static void drop_group(splat4d_reader *r)
{
    for (int i = 0; i < ATTRIBUTES * KINDS; i++)
        drop_stream(r, &r->streams[i / KINDS][i % KINDS]);
    r->group = NULL;
}

static uint64_t numbers_in(const splat4d_reader *r, const group *g, int attribute, int kind)
{
    return (uint64_t)r->changing[attribute] * (uint64_t)columns[attribute].count *
           (kind == KEY ? 1 : g->end - g->first - 1);
}

static int load_streams(splat4d_reader *r, const group *g, const uint8_t *heads, int count, fxs_message *message)
{
    uint64_t offset = (uint64_t)g->offset + 2 + (uint64_t)count * STREAM_HEAD;
    for (int i = 0; i < count; i++) {
        const uint8_t *head = heads + STREAM_HEAD * i;
        if (head[0] >= ATTRIBUTES || head[1] >= KINDS || r->streams[head[0]][head[1]].bytes)
            return fail(r, "a group with a stream of an unknown kind, or two of one kind", message);
        const uint64_t wanted = numbers_in(r, g, head[0], head[1]);
        if (wanted > 0)
            FXS_TRY(load_stream(r, &r->streams[head[0]][head[1]], head + 2, wanted, offset,
                                (uint64_t)g->offset + g->size, message));
        offset += fxs_load_u32(head + 7);
    }
    for (int a = 0; a < ATTRIBUTES; a++)
        for (int kind = 0; kind < KINDS; kind++)
            if (numbers_in(r, g, a, kind) > 0 && !r->streams[a][kind].bytes)
                return fxs_fail(message, "%s: frames %zu to %zu lack a stream", r->source->path, g->first, g->end - 1);
    return 0;
}

static int load_group(splat4d_reader *r, const group *g, fxs_message *message)
{
    fxs_text text;
    uint8_t head[2];
    drop_group(r);
    FXS_TRY(fxs_scene_source_progress(r->source, (double)g->first / (double)r->frames, message));
    if (g->size < sizeof head)
        return fail(r, "a group of frames ends early", message);
    FXS_TRY(fxs_scene_source_read(r->source, g->offset, head, sizeof head, message));
    const int count = fxs_load_u16(head);
    if (g->size - sizeof head < (size_t)count * STREAM_HEAD)
        return fail(r, "a group of frames ends early", message);
    FXS_TRY(fxs_scene_source_load(r->source, (uint64_t)g->offset + sizeof head, (size_t)count * STREAM_HEAD, &text,
                                  message));
    const int error = load_streams(r, g, (const uint8_t *)text.data, count, message);
    fxs_text_let_go(r->source, &text);
    r->group = error ? NULL : g;
    return error;
}

/* Applies the numbers of a frame of the loaded group. */
static void apply(splat4d_reader *r, size_t frame)
{
    const int kind = frame == r->group->first ? KEY : DELTA;
    size_t at[ATTRIBUTES] = {0};
    for (int a = 0; a < ATTRIBUTES && kind == DELTA; a++)
        at[a] = (frame - r->group->first - 1) * r->changing[a] * (size_t)columns[a].count;
    for (size_t m = 0; m < r->moving_count; m++)
        for (int a = 0; a < ATTRIBUTES; a++)
            for (int k = 0; k < columns[a].count && !(r->still[r->moving[m]] >> a & 1); k++) {
                const size_t i = r->moving[m];
                uint32_t *number = &r->numbers[i * ROW + (size_t)(columns[a].at + k)];
                *number = (kind == KEY ? 0 : *number) + signed_of(number_at(&r->streams[a][kind], at[a]++));
            }
    r->frame = frame;
}

/* Makes `numbers` those of a frame. Going on to the next frame takes the least work. */
static int go_to_frame(splat4d_reader *r, size_t frame, fxs_message *message)
{
    const group *g = r->group ? r->group : r->groups;
    while (frame < g->first)
        g--;
    while (frame >= g->end)
        g++;
    if (g != r->group)
        FXS_TRY(load_group(r, g, message));
    else if (frame == r->frame + 1) {
        apply(r, frame);
        return 0;
    }
    for (size_t f = g->first; f <= frame; f++)
        apply(r, f);
    return 0;
}

static int32_t number_of(const splat4d_reader *r, size_t i, int attribute, int k)
{
    return (int32_t)r->numbers[i * ROW + (size_t)(columns[attribute].at + k)];
}

/* Returns a number of an attribute with whole steps. Beyond the range of its type, the nearest is meant. */
static int whole_of(const splat4d_reader *r, size_t i, int attribute, int k, int low, int high)
{
    const double step = r->still[i] >> attribute & 1 ? 1 : r->steps[attribute];
    return (int)fmin(fmax(number_of(r, i, attribute, k) * step, low), high);
}

/* Returns Gaussian i in the frame of `numbers`. */
static fxs_gaussian gaussian_of(const splat4d_reader *r, size_t i)
{
    const double step = (r->still[i] >> POSITION & 1 ? r->still_steps : r->steps)[POSITION];
    const double scale_step = (r->still[i] >> SCALE & 1 ? r->still_steps : r->steps)[SCALE];
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    for (int k = 0; k < 3; k++) {
        g.position[k] = (float)(number_of(r, i, POSITION, k) * step);
        g.scale[k] = (float)(number_of(r, i, SCALE, k) * scale_step);
        g.dc[k] = fxs_dc_of_colour(whole_of(r, i, COLOUR, k, 0, 255) / 255.0);
    }
    g.opacity = fxs_logit_of_code(whole_of(r, i, OPACITY, 0, 0, 255));
    for (int k = 0; k < 4; k++)
        g.rotation[k] = (float)whole_of(r, i, ROTATION, k, -128, 127) / 128;
    return g;
}

/* ---- Reading ----------------------------------------------------------------------------------------------------- */

static int take_frame(splat4d_reader *r, size_t frame, fxs_message *message)
{
    FXS_TRY(go_to_frame(r, frame, message));
    int error = 0;
    for (size_t m = 0; m < r->moving_count && !error; m++) {
        const fxs_gaussian g = gaussian_of(r, r->moving[m]);
        error = fxs_sequence_put(r->sequence, &g);
    }
    if (error || fxs_sequence_next(r->sequence))
        return fxs_fail_memory(message, r->source->path, fxs_sequence_bytes(r->sequence));
    return fxs_limit_memory(r->source, fxs_sequence_bytes(r->sequence), message);
}

static int make_tracks(splat4d_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    r->sequence = fxs_sequence_create((uint32_t)r->frames, r->rate, 0, r->source->options.allocator);
    if (!r->sequence)
        return fxs_fail_memory(message, r->source->path, 0);
    for (size_t f = 0; f < r->frames && r->moving_count; f++)
        FXS_TRY(take_frame(r, f, message));
    if (fxs_sequence_finish(r->sequence, &info->time))
        return fxs_fail_memory(message, r->source->path, fxs_sequence_bytes(r->sequence));
    drop_group(r);
    info->count = r->count - r->moving_count + fxs_sequence_count(r->sequence);
    return 0;
}

static int splat4d_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    splat4d_reader *r = handle;
    size_t offset = 0, size = 0;
    r->source = source;
    FXS_TRY(load_header(r, &offset, &size, message));
    r->still = fxs_hold(source, r->count, message);
    r->numbers = r->still ? fxs_hold(source, (uint64_t)r->count * ROW * sizeof *r->numbers, message) : NULL;
    if (!r->numbers)
        return FXS_ERR_MEMORY;
    memset(r->still, 0, r->count);
    FXS_TRY(load_still_section(r, offset, size, message));
    FXS_TRY(list_moving(r, message));
    info->sh_degree = info->antialiased = 0;
    info->colour.step = 1 / 255.0;
    return make_tracks(r, info, message);
}

static long splat4d_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    splat4d_reader *r = handle;
    size_t count = 0;
    (void)message;
    capacity = capacity < BATCH ? capacity : BATCH;
    for (; r->next < r->count && count < capacity; r->next++)
        if (r->still[r->next] == ALL_STILL) {
            gaussians[count] = gaussian_of(r, r->next);
            r->motions[count++] = (fxs_motion){.fade = INFINITY, .from = -INFINITY, .to = INFINITY};
        }
    const uint64_t left = fxs_sequence_count(r->sequence) - r->next_track;
    const size_t tracks = capacity - count < left ? capacity - count : (size_t)left;
    fxs_sequence_get(r->sequence, r->next_track, tracks, gaussians + count, r->motions + count);
    r->next_track += tracks;
    return (long)(count + tracks);
}

static int splat4d_rewind(void *handle, fxs_message *message)
{
    splat4d_reader *r = handle;
    (void)message;
    r->next = 0;
    r->next_track = 0;
    return 0;
}

static void splat4d_close(void *handle)
{
    splat4d_reader *r = handle;
    drop_group(r);
    fxs_sequence_free(r->sequence);
    fxs_let_go(r->source, r->groups, (r->group_count + 1) * sizeof *r->groups);
    fxs_let_go(r->source, r->still, r->count);
    fxs_let_go(r->source, r->numbers, (uint64_t)r->count * ROW * sizeof *r->numbers);
    fxs_let_go(r->source, r->moving, (r->moving_count + 1) * sizeof *r->moving);
}

static const fxs_motion *splat4d_motions(const void *handle)
{
    return ((const splat4d_reader *)handle)->motions;
}

const fxs_reader fxs_read_splat4d = {
    is_splat4d, sizeof(splat4d_reader), splat4d_open, splat4d_read, splat4d_rewind, splat4d_close, splat4d_motions
};

#else

static int splat4d_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    (void)handle, (void)info;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read .splat4d: built without zstd or cJSON",
                       source->path);
}

const fxs_reader fxs_read_splat4d = {is_splat4d, 0, splat4d_open, NULL, NULL, NULL, NULL};

#endif
