/* Turns frames into moving Gaussians, in groups of frames.
 *
 * In an ordered group, Gaussian number g is the same thing in all frames. Its track is a polynomial of degree 3 for the
 * position and a line for the quaternion. If the errors of a track are too large, its window of frames is divided after
 * the largest power of two below its length, down to single frames. A Gaussian that does not change is one track for as
 * long as it stays.
 *
 * In an unordered group, a Gaussian belongs to its frame. A Gaussian with equal numbers in the next frame continues the
 * track.
 *
 * A Gaussian with an opacity of 0 is absent from that frame: some formats give every frame the same number of
 * Gaussians, including those that do not exist yet. */
#include "sequence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include "src/gaussian/attributes.h"

enum { GROUP = 32,          /* frames of a group, a power of two; a group also has the first frame of the next one */
       POSITION = 0, SCALE = 3, ROTATION = 6, OPACITY = 10, DC = 11, SH = 14,   /* places in a row of floats */
       SAMPLE = 1024, NOT_OPEN = -1 };

/* Largest errors of a track. */
static const double position_error = 0.2,      /* of the mean sigma */
                    scale_error = 0.03,        /* of a sigma */
                    opacity_error = 0.012, colour_error = 0.01, sh_error = 0.02,
                    least_angle = 0.005, most_angle = 0.03;   /* radians */

typedef struct frame {
    float *rows;
    uint32_t count, room;
} frame;

/* A Gaussian of the result: its row holds from frame `first` until before frame `end`. */
typedef struct track {
    float drift[9], turn[4];       /* by the frame */
    float centre;                  /* frames */
    uint32_t first, end;
} track;

struct fxs_sequence {
    const fxs_allocator *allocator;
    uint32_t frames, added;        /* number of all frames, and of those that are complete */
    double rate;
    int sh_degree, moves, turns;
    uint32_t width;                /* floats of a row */
    frame group[GROUP + 1];
    uint32_t held, first;          /* number of complete frames in `group`, and the number of its first */
    float *rows;
    track *tracks;
    uint64_t count, room;
    int64_t *open;                 /* for each Gaussian of the last frame, its track if it may go on, or NOT_OPEN */
    uint32_t open_count;
    int was_ordered;               /* 1: the last group kept its order */
};

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

fxs_sequence *fxs_sequence_create(uint32_t frames, double rate, int sh_degree, const fxs_allocator *allocator)
{
    fxs_sequence *s = fxs_allocate_zeroed(allocator, 1, sizeof *s);
    if (s) {
        s->allocator = allocator;
        s->frames = frames;
        s->rate = rate;
        s->sh_degree = sh_degree;
        s->width = SH + 3u * (uint32_t)(sh_degree * (sh_degree + 2));
    }
    return s;
}

void fxs_sequence_free(fxs_sequence *s)
{
    if (!s)
        return;
    for (int i = 0; i <= GROUP; i++)
        fxs_release(s->allocator, s->group[i].rows);
    fxs_release(s->allocator, s->rows);
    fxs_release(s->allocator, s->tracks);
    fxs_release(s->allocator, s->open);
    fxs_release(s->allocator, s);
}

static void *grown(const fxs_sequence *s, void *old, uint64_t used, uint64_t room, size_t size)
{
    void *block = room <= SIZE_MAX / size ? fxs_allocate(s->allocator, (size_t)room, size) : 0;
    if (block && used)
        memcpy(block, old, (size_t)used * size);
    if (block)
        fxs_release(s->allocator, old);
    return block;
}

uint64_t fxs_sequence_bytes(const fxs_sequence *s)
{
    uint64_t bytes = s->room * (s->width * sizeof(float) + sizeof(track)) + s->open_count * sizeof *s->open;
    for (int i = 0; i <= GROUP; i++)
        bytes += (uint64_t)s->group[i].room * s->width * sizeof(float);
    return bytes;
}

int fxs_sequence_put(fxs_sequence *s, const fxs_gaussian *g)
{
    frame *f = &s->group[s->held];
    if (f->count == f->room) {
        const uint32_t room = f->room ? 2 * f->room : 1024;
        float *rows = room > f->room ? grown(s, f->rows, f->count, room, s->width * sizeof *rows) : 0;
        if (!rows)
            return FXS_ERR_MEMORY;
        f->rows = rows;
        f->room = room;
    }
    float *row = f->rows + (size_t)f->count++ * s->width;
    memcpy(row + POSITION, g->position, sizeof g->position);
    memcpy(row + SCALE, g->scale, sizeof g->scale);
    memcpy(row + ROTATION, g->rotation, sizeof g->rotation);
    row[OPACITY] = g->opacity;
    memcpy(row + DC, g->dc, sizeof g->dc);
    memcpy(row + SH, g->sh, (s->width - SH) * sizeof *row);
    return 0;
}

/* Adds a track with a row. Returns its number, or NOT_OPEN if memory runs out. */
static int64_t add_track(fxs_sequence *s, const float *row, const track *t)
{
    if (s->count == s->room) {
        const uint64_t room = s->room ? s->room + s->room / 2 : 4096;
        float *rows = grown(s, s->rows, s->count, room, s->width * sizeof *rows);
        s->rows = rows ? rows : s->rows;
        track *tracks = rows ? grown(s, s->tracks, s->count, room, sizeof *tracks) : 0;
        s->tracks = tracks ? tracks : s->tracks;
        if (!tracks)
            return NOT_OPEN;
        s->room = room;
    }
    memcpy(s->rows + s->count * s->width, row, s->width * sizeof *row);
    s->tracks[s->count] = *t;
    return (int64_t)s->count++;
}

/* ---- Errors ------------------------------------------------------------------------------------------------------ */

static double mean_sigma(const float *row)
{
    return fxs_exp(((double)row[SCALE] + row[SCALE + 1] + row[SCALE + 2]) / 3);
}

/* An angle turns the longest axis by less than a share of the next one. */
static double angle_allowed(const float *row)
{
    const float *s = row + SCALE;
    const float most = fmaxf(s[0], fmaxf(s[1], s[2])), least = fminf(s[0], fminf(s[1], s[2]));
    const double ratio = fxs_exp((double)(s[0] + s[1] + s[2] - most - least - most));
    return fmin(fmax(most_angle * 5 * ratio, least_angle), most - least < 0.05f ? 4 : most_angle * 5);
}

static int is_near(const float *a, const float *b, int count, double most)
{
    for (int i = 0; i < count; i++)
        if (!(fabs((double)a[i] - b[i]) <= most))
            return 0;
    return 1;
}

/* What a track keeps constant. */
static int has_constants(const fxs_sequence *s, const float *row, const float *kept)
{
    return is_near(row + SCALE, kept + SCALE, 3, scale_error) &&
           is_near(row + DC, kept + DC, 3, colour_error / FXS_SH_0) &&
           is_near(row + SH, kept + SH, (int)(s->width - SH), sh_error) &&
           fabs(fxs_opacity_of_logit(row[OPACITY]) - fxs_opacity_of_logit(kept[OPACITY])) <= opacity_error;
}

/* |sin| of half the angle between two rotations, which need not have length 1, is below that of the angle allowed. */
static int is_turned_alike(const double a[4], const float *b, double angle)
{
    double dot = 0, aa = 0, bb = 0;
    for (int i = 0; i < 4; i++) {
        dot += a[i] * b[i];
        aa += a[i] * a[i];
        bb += (double)b[i] * b[i];
    }
    return aa * bb - dot * dot <= aa * bb * angle * angle / 4;
}

static int is_still(const fxs_sequence *s, const float *row, const float *kept)
{
    const double rotation[4] = {(double)row[ROTATION], (double)row[ROTATION + 1], (double)row[ROTATION + 2],
                                (double)row[ROTATION + 3]};
    return is_near(row + POSITION, kept + POSITION, 3, position_error * mean_sigma(kept)) &&
           has_constants(s, row, kept) && is_turned_alike(rotation, kept + ROTATION, angle_allowed(kept));
}

/* ---- Tracks in order --------------------------------------------------------------------------------------------- */

/* A fit by least squares over `count` frames at x = -1 to 1, evenly. The sums of odd powers are 0, so a0 and a2 are
   independent of a1 and a3. */
typedef struct powers {
    uint32_t count;
    double s2, s4, s6;
} powers;

static double place_of(uint32_t f, uint32_t count)
{
    return count > 1 ? 2.0 * f / (count - 1) - 1 : 0;
}

static powers powers_of(uint32_t count)
{
    powers p = {count, 0, 0, 0};
    for (uint32_t f = 0; f < count; f++) {
        const double x = place_of(f, count), xx = x * x;
        p.s2 += xx;
        p.s4 += xx * xx;
        p.s6 += xx * xx * xx;
    }
    return p;
}

/* Fits a0 + a1 x + a2 x^2 + a3 x^3 to one number of the rows of a track; rows[f] is its row in frame f. */
static void fit_cubic(double a[4], const powers *p, const float *const *rows, int number)
{
    double y0 = 0, y1 = 0, y2 = 0, y3 = 0;
    for (uint32_t f = 0; f < p->count; f++) {
        const double x = place_of(f, p->count), y = rows[f][number];
        y0 += y;
        y1 += x * y;
        y2 += x * x * y;
        y3 += x * x * x * y;
    }
    const double n = p->count, even = n * p->s4 - p->s2 * p->s2, odd = p->s2 * p->s6 - p->s4 * p->s4;
    a[0] = p->count > 2 ? (y0 * p->s4 - y2 * p->s2) / even : y0 / n;
    a[1] = p->count > 3 ? (y1 * p->s6 - y3 * p->s4) / odd : p->count > 1 ? y1 / p->s2 : 0;
    a[2] = p->count > 2 ? (n * y2 - p->s2 * y0) / even : 0;
    a[3] = p->count > 3 ? (p->s2 * y3 - p->s4 * y1) / odd : 0;
}

/* Fits a line to the quaternions of a track, each of length 1 and with the sign of the one before. */
static void fit_line(double a[4], double b[4], const powers *p, const float *const *rows)
{
    double last[4] = {0, 0, 0, 0};
    memset(a, 0, 4 * sizeof *a);
    memset(b, 0, 4 * sizeof *b);
    for (uint32_t f = 0; f < p->count; f++) {
        const float *q = rows[f] + ROTATION;
        const double dot = q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3];
        const double length = sqrt((double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] +
                                   (double)q[3] * q[3]);
        const double factor = length > 0 ? (dot < 0 ? -1 : 1) / length : 0;
        for (int i = 0; i < 4; i++) {
            last[i] = q[i] * factor;
            a[i] += last[i] / p->count;
            b[i] += p->count > 1 ? place_of(f, p->count) * last[i] / p->s2 : 0;
        }
    }
}

typedef struct fitted {
    double position[3][4], rotation[4], turn[4];
    float row[SH + 45];
} fitted;

/* The means of what a track keeps constant. */
static void take_means(const fxs_sequence *s, float *row, const float *const *rows, uint32_t count)
{
    memcpy(row, rows[0], s->width * sizeof *row);
    for (uint32_t i = SCALE; i < s->width; i++) {
        double sum = 0;
        for (uint32_t f = 0; f < count; f++)
            sum += rows[f][i];
        row[i] = i >= ROTATION && i < OPACITY ? row[i] : (float)(sum / count);
    }
}

/* Fits a track to the rows of `count` frames. Returns 1 if all errors are small. */
static int fit_track(const fxs_sequence *s, fitted *out, const float *const *rows, uint32_t count)
{
    const powers p = powers_of(count);
    take_means(s, out->row, rows, count);
    for (uint32_t f = 0; f < count; f++)
        if (!has_constants(s, rows[f], out->row))
            return 0;
    const double far = position_error * mean_sigma(out->row), angle = angle_allowed(out->row);
    for (int i = 0; i < 3; i++)
        fit_cubic(out->position[i], &p, rows, POSITION + i);
    fit_line(out->rotation, out->turn, &p, rows);
    for (uint32_t f = 0; f < count; f++) {
        const double x = place_of(f, count);
        double rotation[4];
        for (int i = 0; i < 3; i++) {
            const double *a = out->position[i];
            if (!(fabs(a[0] + x * (a[1] + x * (a[2] + x * a[3])) - rows[f][POSITION + i]) <= far))
                return 0;
        }
        for (int i = 0; i < 4; i++)
            rotation[i] = out->rotation[i] + x * out->turn[i];
        if (!is_turned_alike(rotation, rows[f] + ROTATION, angle))
            return 0;
    }
    return 1;
}

/* Adds a fitted track of the frames first to end - 1; the fit covers `count` frames from the first on. */
static int add_fitted(fxs_sequence *s, fitted *fit, uint32_t first, uint32_t end, uint32_t count)
{
    const double half = count > 1 ? (count - 1) / 2.0 : 1;     /* frames from x = 0 to x = 1 */
    track t = {{0}, {0}, (float)(first + (count - 1) / 2.0), first, end};
    for (int i = 0; i < 3; i++) {
        fit->row[POSITION + i] = (float)fit->position[i][0];
        for (int k = 0; k < 3; k++)
            t.drift[3 * k + i] = (float)(fit->position[i][k + 1] / pow(half, k + 1));
    }
    for (int i = 0; i < 4; i++) {
        fit->row[ROTATION + i] = (float)fit->rotation[i];
        t.turn[i] = (float)(fit->turn[i] / half);
        s->turns |= t.turn[i] != 0;
    }
    s->moves = 1;
    return add_track(s, fit->row, &t) < 0 ? FXS_ERR_MEMORY : 0;
}

/* Adds the tracks of one Gaussian in the frames first to end - 1 of the group. The frame behind them counts too, so
   that the next track begins where this one ends. */
static int cover(fxs_sequence *s, const float *const *rows, uint32_t first, uint32_t end, uint32_t known)
{
    const uint32_t count = (end < known ? end + 1 : end) - first;
    fitted fit;
    if (fit_track(s, &fit, rows + first, count) || end - first == 1) {
        if (end - first == 1) {
            fit_track(s, &fit, rows + first, 1);
            return add_fitted(s, &fit, s->first + first, s->first + end, 1);
        }
        return add_fitted(s, &fit, s->first + first, s->first + end, count);
    }
    uint32_t half = 1;
    while (2 * half < end - first)
        half *= 2;
    const uint32_t middle = first + half;
    const int error = cover(s, rows, first, middle, known);
    return error ? error : cover(s, rows, middle, end, known);
}

static int is_seen(const float *row)
{
    return row[OPACITY] > -FXS_OPAQUE;
}

static const float *row_of(const fxs_sequence *s, uint32_t f, uint32_t g)
{
    return s->group[f].rows + (size_t)g * s->width;
}

/* Adds the tracks of Gaussian g in the frames first to end - 1 of the group, where it is seen, as in all frames to
   known - 1: one that does not move, if its open track holds on or a new one does. */
static int add_seen(fxs_sequence *s, uint32_t g, const float *const *rows, uint32_t first, uint32_t end, uint32_t known)
{
    int64_t *open = &s->open[g];
    int still = 1;
    const float *kept = *open != NOT_OPEN ? s->rows + (uint64_t)*open * s->width : rows[first];
    for (uint32_t f = first; f < known && still; f++)
        still = is_still(s, rows[f], kept);
    if (still && *open != NOT_OPEN) {
        s->tracks[*open].end = s->first + end;
        return 0;
    }
    *open = NOT_OPEN;
    for (uint32_t f = first; f < known && !still; f++)
        if (!is_still(s, rows[f], rows[first]))
            return cover(s, rows, first, end, known);
    *open = add_track(s, rows[first], &(track){{0}, {0}, (float)(s->first + first), s->first + first, s->first + end});
    return *open == NOT_OPEN ? FXS_ERR_MEMORY : 0;
}

/* Adds the tracks of Gaussian g of a group of `frames` frames, of which `known` are known. */
static int add_ordered(fxs_sequence *s, uint32_t g, uint32_t frames, uint32_t known)
{
    const float *rows[GROUP + 1] = {0};
    int error = 0;
    for (uint32_t f = 0; f < known; f++)
        rows[f] = row_of(s, f, g);
    for (uint32_t f = 0, end; f < frames && !error; f = end + 1) {
        for (end = f; end < known && is_seen(rows[end]);)
            end++;
        if (end > f)
            error = add_seen(s, g, rows, f, end < frames ? end : frames, end);
        if (end < known)
            s->open[g] = NOT_OPEN;
    }
    return error;
}

/* ---- Frames in any order ----------------------------------------------------------------------------------------- */

typedef struct hashed {
    uint64_t hash;
    uint32_t index;
} hashed;

static int by_hash(const void *a, const void *b)
{
    const hashed *x = a, *y = b;
    return x->hash != y->hash ? (x->hash < y->hash ? -1 : 1) : x->index < y->index ? -1 : x->index > y->index;
}

static uint64_t hash_of(const fxs_sequence *s, const float *row)
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (uint32_t i = 0; i < s->width; i++) {
        uint32_t bits;
        memcpy(&bits, &row[i], sizeof bits);
        hash = (hash ^ bits) * 0xd6e8feb86659fd93u;
        hash ^= hash >> 32;
    }
    return hash;
}

static hashed *hash_frame(const fxs_sequence *s, const float *rows, uint32_t count)
{
    hashed *list = fxs_allocate(s->allocator, count ? count : 1, sizeof *list);
    for (uint32_t i = 0; i < count && list; i++)
        list[i] = (hashed){hash_of(s, rows + (size_t)i * s->width), i};
    if (list)
        qsort(list, count, sizeof *list, by_hash);
    return list;
}

/* A track from frame `first` on goes on for at most as many frames as the largest power of two that divides `first`, so
   that few windows of time are different and their chunks are full. One from frame 0 on may last for ever. */
static int may_go_on(const track *t, uint32_t number)
{
    return t->end == number && (t->first == 0 || number < t->first + (t->first & -t->first));
}

/* Continues the open tracks with the same numbers in frame f of the group, and begins tracks for its other
   Gaussians. */
static int add_unordered(fxs_sequence *s, uint32_t f)
{
    const frame *now = &s->group[f];
    const uint32_t number = s->first + f, old_count = s->open_count;
    float *old_rows = fxs_allocate_zeroed(s->allocator, old_count ? old_count : 1, s->width * sizeof *old_rows);
    int64_t *open = fxs_allocate(s->allocator, now->count ? now->count : 1, sizeof *open);
    for (uint32_t i = 0; i < old_count && old_rows; i++)
        if (s->open[i] != NOT_OPEN)
            memcpy(old_rows + (size_t)i * s->width, s->rows + (uint64_t)s->open[i] * s->width,
                   s->width * sizeof *old_rows);
    hashed *before = old_rows ? hash_frame(s, old_rows, old_count) : 0, *list = hash_frame(s, now->rows, now->count);
    int error = old_rows && open && before && list ? 0 : FXS_ERR_MEMORY;
    for (uint32_t i = 0, k = 0; i < now->count && !error; i++) {
        const float *row = row_of(s, f, list[i].index);
        while (k < old_count && before[k].hash < list[i].hash)
            k++;
        int64_t *to = &open[list[i].index];
        *to = NOT_OPEN;
        if (!is_seen(row))
            continue;
        const int64_t same = k < old_count ? s->open[before[k].index] : NOT_OPEN;
        if (same != NOT_OPEN && before[k].hash == list[i].hash && may_go_on(&s->tracks[same], number) &&
            !memcmp(row, s->rows + (uint64_t)same * s->width, s->width * sizeof *row)) {
            s->tracks[same].end = number + 1;
            *to = same;
            k++;
            continue;
        }
        *to = add_track(s, row, &(track){{0}, {0}, (float)number, number, number + 1});
        error = *to == NOT_OPEN ? FXS_ERR_MEMORY : 0;
    }
    fxs_release(s->allocator, old_rows);
    fxs_release(s->allocator, before);
    fxs_release(s->allocator, list);
    fxs_release(s->allocator, s->open);
    s->open = open;
    s->open_count = open ? now->count : 0;
    return error;
}

/* ---- Groups ------------------------------------------------------------------------------------------------------ */

/* Returns 1 if most Gaussians of a sample that are seen in two frames are near the same place in both, with about the
   same colour. */
static int keeps_order(const fxs_sequence *s, uint32_t f)
{
    const frame *a = &s->group[f], *b = &s->group[f + 1];
    const uint32_t step = a->count / SAMPLE + 1;
    uint32_t seen = 0, near = 0;
    for (uint32_t g = 0; g < a->count && a->count == b->count; g += step) {
        const float *x = row_of(s, f, g), *y = row_of(s, f + 1, g);
        const int both = is_seen(x) && is_seen(y);
        seen += (uint32_t)both;
        near += both && is_near(x, y, 3, 8 * mean_sigma(x)) && is_near(x + DC, y + DC, 3, 0.25 / FXS_SH_0);
    }
    return a->count == b->count && 4 * near >= 3 * seen;
}

static int open_none(fxs_sequence *s, uint32_t count)
{
    int64_t *open = fxs_allocate(s->allocator, count ? count : 1, sizeof *open);
    if (!open)
        return FXS_ERR_MEMORY;
    fxs_release(s->allocator, s->open);
    s->open = open;
    s->open_count = count;
    for (uint32_t i = 0; i < count; i++)
        open[i] = NOT_OPEN;
    return 0;
}

/* Makes the tracks of a group of `frames` frames; `known` includes the first frame of the next group, if there is one.
 */
static int make_tracks(fxs_sequence *s, uint32_t frames, uint32_t known)
{
    const int went_on = s->was_ordered && s->open_count == s->group[0].count;
    int ordered = known > 1 || went_on, error = 0;
    for (uint32_t f = 0; f + 1 < known && ordered; f++)
        ordered = keeps_order(s, f);
    s->was_ordered = ordered;
    if (!ordered) {
        for (uint32_t f = 0; f < frames && !error; f++)
            error = add_unordered(s, f);
        return error;
    }
    if (!went_on)
        error = open_none(s, s->group[0].count);
    for (uint32_t g = 0; g < s->group[0].count && !error; g++)
        error = add_ordered(s, g, frames, known);
    return error;
}

/* Keeps the first frame of the next group, if the group holds it. */
static void shift_group(fxs_sequence *s, uint32_t frames)
{
    const frame first = s->group[0];
    s->group[0] = s->group[frames];
    s->group[frames] = first;
    s->held -= frames;
    s->first += frames;
    for (uint32_t i = s->held; i <= GROUP; i++)
        s->group[i].count = 0;
}

int fxs_sequence_next(fxs_sequence *s)
{
    s->held++;
    s->added++;
    if (s->held <= GROUP)
        return 0;
    const int error = make_tracks(s, GROUP, GROUP + 1);
    shift_group(s, GROUP);
    return error;
}

int fxs_sequence_finish(fxs_sequence *s, fxs_time *time)
{
    const int error = s->held ? make_tracks(s, s->held, s->held) : 0;
    *time = (fxs_time){.duration = s->frames / s->rate, .rate = s->rate, .loops = 1, .degree = s->moves ? 3 : 0,
                       .turns = s->turns};
    for (int i = 0; i <= GROUP; i++) {
        fxs_release(s->allocator, s->group[i].rows);
        s->group[i] = (frame){0, 0, 0};
    }
    return error;
}

uint64_t fxs_sequence_count(const fxs_sequence *s)
{
    return s->count;
}

void fxs_sequence_get(const fxs_sequence *s, uint64_t first, size_t count, fxs_gaussian *gaussians, fxs_motion *motions)
{
    for (size_t i = 0; i < count; i++) {
        const float *row = s->rows + (first + i) * s->width;
        const track *t = &s->tracks[first + i];
        fxs_gaussian *g = &gaussians[i];
        fxs_motion *m = &motions[i];
        memset(g, 0, sizeof *g);
        memcpy(g->position, row + POSITION, sizeof g->position);
        memcpy(g->scale, row + SCALE, sizeof g->scale);
        memcpy(g->rotation, row + ROTATION, sizeof g->rotation);
        g->opacity = row[OPACITY];
        memcpy(g->dc, row + DC, sizeof g->dc);
        memcpy(g->sh, row + SH, (s->width - SH) * sizeof *row);
        for (int k = 0; k < 9; k++)
            m->drift[k / 3][k % 3] = (float)(t->drift[k] * pow(s->rate, k / 3 + 1));
        for (int k = 0; k < 4; k++)
            m->turn[k] = (float)(t->turn[k] * s->rate);
        m->centre = (float)(t->centre / s->rate);
        m->fade = INFINITY;
        m->from = t->first ? (float)(t->first / s->rate) : -INFINITY;
        m->to = t->end < s->frames ? (float)(t->end / s->rate) : INFINITY;
    }
}
