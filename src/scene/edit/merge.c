/* Merges the scene files of a world (a list of placed scenes) into a single stream of Gaussians. Every Gaussian is
   cropped, moved, rotated with its SH and its motion, scaled and tinted. Far from 0, positions are relative to a common
   origin near the file with most Gaussians. */
#include <fixsplat/world.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/time_range.h>

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"
#include "src/gaussian/origin_internal.h"
#include "src/gaussian/transform_internal.h"
#include "course_internal.h"

#define FARTHEST 0x1p28

typedef struct part {
    fxs_placement placement;
    double rows[3][4];
    fxs_transform turn;
    double log_scale;
    double inner[3];
    int moves;
    double middle[3];
    /* translation of a file's Gaussians: world position = M * file position + shift, with the matrix M in `rows` */
    double shift[3];
    int is_moved, is_turned, is_tinted;
} part;

typedef struct merge_reader {
    const fxs_reader *reader;
    void *data;
    const fxs_allocator *allocator;
    fxs_scene_file **files;
    uint32_t file_count;
    part *parts;
    fxs_import *import;
    uint32_t count, at;
    int sh_degree;
    double origin[3];
    fxs_time time;
    fxs_motion motions[FXS_MOTIONS];
} merge_reader;

static int is_in(const fxs_world_crop *crop, const double place[3])
{
    for (int i = 0; i < 3; i++)
        if (!(place[i] >= crop->low[i] && place[i] <= crop->high[i]))
            return 0;
    return 1;
}

static int is_kept_at(const fxs_placement *p, const double place[3])
{
    int keeping = 0, kept = 0;
    for (uint32_t c = 0; c < p->crop_count; c++) {
        const int inside = is_in(&p->crops[c], place);
        if (p->crops[c].outside && inside)
            return 0;
        keeping |= !p->crops[c].outside;
        kept |= !p->crops[c].outside && inside;
    }
    return kept || !keeping;
}

/* True if the crops keep a place on the way of a Gaussian. motion: null for one of a still file. */
static int is_kept(const merge_reader *r, const part *p, const fxs_gaussian *g, const fxs_motion *motion)
{
    if (!p->placement.crop_count)
        return 1;
    const fxs_course course = fxs_course_of(g, motion, &r->time);
    int kept = 0;
    for (int number = 0; number < course.count && !kept; number++) {
        double place[3];
        fxs_course_place(&course, number, place);
        for (int i = 0; i < 3; i++)
            place[i] += p->inner[i];
        kept = is_kept_at(&p->placement, place);
    }
    return kept;
}

static void turn_camera(double camera[4], const double rotation[4])
{
    const double back[4] = {rotation[0], -rotation[1], -rotation[2], -rotation[3]};
    const double old[4] = {camera[0], camera[1], camera[2], camera[3]};
    fxs_quaternion_product(camera, old, back);
}

static void turn_quaternion(const part *p, float q[4])
{
    const double own[4] = {q[0], q[1], q[2], q[3]};
    double turned[4];
    fxs_quaternion_product(turned, p->placement.rotation, own);
    for (int i = 0; i < 4; i++)
        q[i] = (float)turned[i];
}

static void turn(const part *p, fxs_gaussian *g, fxs_motion *m, int sh_degree)
{
    static const fxs_gaussian upright = {.rotation = {1, 0, 0, 0}};
    fxs_gaussian turned = upright;
    memcpy(turned.sh, g->sh, sizeof g->sh);
    fxs_transform_apply(&p->turn, &turned, sh_degree);
    memcpy(g->sh, turned.sh, sizeof g->sh);
    turn_quaternion(p, g->rotation);
    turn_quaternion(p, m->turn);
}

static void map(const part *p, float v[3], const double shift[3])
{
    const double x = v[0], y = v[1], z = v[2];
    for (int i = 0; i < 3; i++)
        v[i] = (float)(p->rows[i][0] * x + p->rows[i][1] * y + p->rows[i][2] * z + shift[i]);
}

static void move(const part *p, fxs_gaussian *g, fxs_motion *m)
{
    static const double none[3];
    map(p, g->position, p->shift);
    for (int i = 0; i < 3; i++) {
        map(p, m->drift[i], none);
        g->scale[i] = (float)(g->scale[i] + p->log_scale);
    }
}

/* Multiplies a Gaussian's colour by a factor for each channel. The colour is 1/2 + SH_0 dc + higher SH. */
static void tint(const double factor[3], fxs_gaussian *g)
{
    for (int c = 0; c < 3; c++) {
        g->dc[c] = (float)((factor[c] * (0.5 + FXS_SH_0 * g->dc[c]) - 0.5) / FXS_SH_0);
        for (int k = 0; k < 15; k++)
            g->sh[3 * k + c] = (float)(factor[c] * g->sh[3 * k + c]);
    }
}

static void change(const part *p, fxs_gaussian *g, fxs_motion *m, int sh_degree)
{
    if (p->is_turned)
        turn(p, g, m, sh_degree);
    if (p->is_moved)
        move(p, g, m);
    if (p->placement.opacity < 1) {
        const double opacity = p->placement.opacity / (1 + fxs_exp(-(double)g->opacity));
        g->opacity = (float)fxs_log(opacity / (1 - opacity));
    }
    if (p->is_tinted)
        tint(p->placement.tint, g);
}

static long read_file(merge_reader *r, uint32_t file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    return file ? fxs_scene_file_read(r->files[file], gaussians, capacity, message)
                : fxs_stream_read(r->reader, r->data, gaussians, capacity, message);
}

/* Returns how the Gaussians that read_file gave last move; null: they are still. */
static const fxs_motion *motions_of_file(const merge_reader *r, uint32_t file)
{
    return file ? fxs_scene_file_motions(r->files[file]) : r->reader->motions ? r->reader->motions(r->data) : NULL;
}

static int enter(merge_reader *r, fxs_message *message)
{
    const part *p = &r->parts[r->at];
    const uint32_t file = p->placement.file;
    memcpy(file ? r->files[file]->import.origin : r->import->origin, p->inner, sizeof p->inner);
    return file ? fxs_scene_file_rewind(r->files[file], message) : r->reader->rewind(r->data, message);
}

static long merge_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    merge_reader *r = handle;
    const int moves = r->time.duration > 0;
    size_t kept = 0;
    capacity = moves && capacity > FXS_MOTIONS ? FXS_MOTIONS : capacity;
    while (kept < capacity && r->at < r->count) {
        const part *p = &r->parts[r->at];
        fxs_gaussian *next = gaussians + kept;
        const long n = read_file(r, p->placement.file, next, capacity - kept, message);
        const fxs_motion *motions = n > 0 ? motions_of_file(r, p->placement.file) : NULL;
        if (n < 0)
            return n;
        for (long i = 0; i < n; i++)
            if (is_kept(r, p, &next[i], motions ? &motions[i] : NULL)) {
                fxs_motion motion = motions ? motions[i] : fxs_still;
                gaussians[kept] = next[i];
                change(p, &gaussians[kept], &motion, r->sh_degree);
                if (moves)
                    r->motions[kept] = motion;
                kept++;
            }
        if (n == 0 && ++r->at < r->count && enter(r, message))
            return -1;
    }
    return (long)kept;
}

static int merge_rewind(void *handle, fxs_message *message)
{
    merge_reader *r = handle;
    r->at = 0;
    return enter(r, message);
}

static const fxs_motion *merge_motions(const void *handle)
{
    const merge_reader *r = handle;
    return r->time.duration > 0 ? r->motions : NULL;
}

static void merge_close(void *handle)
{
    merge_reader *r = handle;
    for (uint32_t i = 1; i < r->file_count && r->files; i++)
        fxs_scene_file_close(r->files[i]);
    fxs_release(r->allocator, r->files);
    fxs_release(r->allocator, r->parts);
    if (r->reader->close)
        r->reader->close(r->data);
    fxs_release(r->allocator, r->data);
}

static const fxs_reader merged_format = {NULL, sizeof(merge_reader), NULL, merge_read, merge_rewind,
                                               merge_close, merge_motions};

static void close_all(fxs_scene_file **files, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        fxs_scene_file_close(files[i]);
}

static void normalise(double to[4], const double q[4])
{
    int scale;
    double square = 0, most = 0;
    for (int i = 0; i < 4; i++)
        most = fabs(q[i]) > most ? fabs(q[i]) : most;
    frexp(most, &scale);
    for (int i = 0; i < 4; i++)
        square += ldexp(q[i], -scale) * ldexp(q[i], -scale);
    for (int i = 0; i < 4; i++)
        to[i] = ldexp(q[i], -scale) / sqrt(square);
}

static void part_init(part *p, const fxs_placement *placement)
{
    const double *q = placement->rotation, *t = placement->translation, *tints = placement->tint;
    p->placement = *placement;
    fxs_placement_matrix(placement, p->rows);
    fxs_transform_init(&p->turn, p->rows);
    p->log_scale = placement->scale == 1 ? 0 : fxs_log(placement->scale);
    normalise(p->placement.rotation, q);
    p->is_turned = q[1] != 0 || q[2] != 0 || q[3] != 0;
    memcpy(p->shift, t, sizeof p->shift);
    p->is_moved = p->is_turned || placement->scale != 1 || t[0] != 0 || t[1] != 0 || t[2] != 0;
    p->is_tinted = tints[0] != 1 || tints[1] != 1 || tints[2] != 1;
}

void fxs_placement_start(const fxs_placement *placement, fxs_start *start)
{
    const fxs_start old = *start;
    double rows[3][4], q[4];
    int in_range = start->tangent > 0;
    fxs_placement_matrix(placement, rows);
    normalise(q, placement->rotation);
    turn_camera(start->rotation, q);
    for (int i = 0; i < 3; i++) {
        const double *r = rows[i], *p = old.position;
        start->up[i] = (r[0] * old.up[0] + r[1] * old.up[1] + r[2] * old.up[2]) / placement->scale;
        start->position[i] = r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3];
        in_range = in_range && fabs(start->position[i]) < FARTHEST;
    }
    if (!in_range)
        memset(&start->tangent, 0, sizeof *start - offsetof(fxs_start, tangent));
}

static int is_known(const double up[3])
{
    return up[0] != 0 || up[1] != 0 || up[2] != 0;
}

static void add_start(fxs_start *all, const fxs_placement *p, const fxs_scene_file_info *own)
{
    fxs_start start = own->start;
    fxs_placement_start(p, &start);
    if (!is_known(all->up))
        memcpy(all->up, start.up, sizeof all->up);
    if (!(all->tangent > 0))
        memcpy(&all->tangent, &start.tangent, sizeof start - offsetof(fxs_start, tangent));
}

static int is_visible(const fxs_placement *p)
{
    return p->visible && p->opacity > 0;
}

static int list_parts(merge_reader *r, const fxs_world *world, const fxs_scene_file_info *infos,
                      fxs_scene_file_info *info, fxs_message *message)
{
    r->sh_degree = info->sh_degree = 0;
    info->count = 0;
    memcpy(info->start.up, world->up, sizeof world->up);
    for (uint32_t i = 0; i < world->count; i++) {
        const fxs_placement *p = &world->objects[i];
        const fxs_scene_file_info *own = &infos[p->file];
        if (!is_visible(p))
            continue;
        if (own->antialiased != infos[world->objects[0].file].antialiased) {
            fxs_fail(message, "%s: of it and others, one is anti-aliased and one is not: a file says one or the other",
                     world->files[p->file]);
            return FXS_ERR_UNSUPPORTED;
        }
        part_init(&r->parts[r->count++], p);
        info->count += own->count;
        add_start(&info->start, p, own);
        info->sh_degree = own->sh_degree > info->sh_degree ? own->sh_degree : info->sh_degree;
    }
    r->sh_degree = info->sh_degree;
    info->antialiased = infos[world->objects[0].file].antialiased;
    if (r->count)
        return 0;
    fxs_fail(message, "none of the objects is visible");
    return FXS_ERR_OBJECT;
}

static void place_of(const part *p, const double from[3], double place[3])
{
    for (int i = 0; i < 3; i++)
        place[i] = p->rows[i][0] * from[0] + p->rows[i][1] * from[1] + p->rows[i][2] * from[2] + p->rows[i][3];
}

static uint64_t number_of(const fxs_scene_file_info *info, int i)
{
    const uint64_t most = FXS_ORIGIN_SAMPLE, k = (uint64_t)i;
    return info->count / most * k + info->count % most * k / most;
}

/* Finds the centre of a placed file in the world. The centre is the file's origin if the reader can move that origin,
   else the centre of a sample of Gaussians. */
static int find_middle(merge_reader *r, part *p, const fxs_scene_file_info *info, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    double places[FXS_ORIGIN_SAMPLE][3], from[3];
    uint64_t read = 0;
    int found = 0;
    place_of(p, p->inner, p->middle);
    if (p->moves)
        return 0;
    r->at = (uint32_t)(p - r->parts);
    FXS_TRY(enter(r, message));
    for (long n; (n = read_file(r, p->placement.file, batch, BATCH, message)) != 0; read += (uint64_t)n) {
        if (n < 0)
            return (int)n;
        for (; found < FXS_ORIGIN_SAMPLE && number_of(info, found) < read + (uint64_t)n; found++) {
            for (int k = 0; k < 3; k++)
                from[k] = p->inner[k] + (double)batch[number_of(info, found) - read].position[k];
            place_of(p, from, places[found]);
        }
    }
    fxs_origin_of(p->middle, places, found);
    return 0;
}

/* Sets the origin of a placed file to the point that maps to the common origin of the world. The reader then rounds
   positions only once. */
static void set_inner(const merge_reader *r, part *p)
{
    const double square = p->placement.scale * p->placement.scale;
    double inner[3] = {0}, place[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            inner[i] += p->rows[k][i] / square * (r->origin[k] - p->rows[k][3]);
    if (p->moves && fxs_is_far(inner) && fabs(inner[0]) < FARTHEST && fabs(inner[1]) < FARTHEST &&
        fabs(inner[2]) < FARTHEST)
        memcpy(p->inner, inner, sizeof p->inner);
    place_of(p, p->inner, place);
    for (int i = 0; i < 3; i++) {
        p->shift[i] = place[i] - r->origin[i];
        p->is_moved |= p->shift[i] != 0;
    }
}

/* Places the world's common origin near the placed file with most Gaussians, if any file lies far from 0. moves: 1 if
   the reader of file 0 can move the file's origin. */
static int choose_origin(merge_reader *r, const fxs_scene_file_info *infos, int moves, fxs_scene_file_info *info,
                         fxs_message *message)
{
    uint64_t most = 0;
    int is_far = 0;
    for (part *p = r->parts; p < r->parts + r->count; p++) {
        const fxs_scene_file_info *own = &infos[p->placement.file];
        memcpy(p->inner, own->origin, sizeof p->inner);
        p->moves = p->placement.file ? r->files[p->placement.file]->import.moves : moves;
        info->coarse = fmax(info->coarse, own->coarse * p->placement.scale);
        is_far |= fxs_is_far(p->inner) || fxs_is_far(p->placement.translation);
    }
    if (!is_far)
        return 0;
    for (part *p = r->parts; p < r->parts + r->count; p++) {
        const uint64_t count = infos[p->placement.file].count;
        FXS_TRY(find_middle(r, p, &infos[p->placement.file], message));
        if (count > most)
            fxs_origin_near(r->origin, p->middle);
        most = count > most ? count : most;
    }
    for (part *p = r->parts; p < r->parts + r->count; p++) {
        info->coarse = fmax(info->coarse, fxs_spacing_at(p->middle, r->origin));
        set_inner(r, p);
    }
    memcpy(info->origin, r->origin, sizeof info->origin);
    return 0;
}

static int count_kept(fxs_scene_file *file, const merge_reader *r, fxs_scene_file_info *info, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    int cropped = 0;
    for (uint32_t i = 0; i < r->count; i++)
        cropped |= r->parts[i].placement.crop_count != 0;
    if (fxs_scene_file_rewind(file, message))
        return FXS_ERR_FILE;
    if (!cropped)
        return 0;
    info->count = 0;
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0; info->count += (uint64_t)n)
        if (n < 0)
            return FXS_ERR_FILE;
    if (!info->count) {
        fxs_fail(message, "the crops leave none of the Gaussians");
        return FXS_ERR_OBJECT;
    }
    return fxs_scene_file_rewind(file, message) ? FXS_ERR_FILE : 0;
}

void fxs_world_place(fxs_world *world, const fxs_placement *whole)
{
    double rows[3][4];
    fxs_placement_matrix(whole, rows);
    const double up[3] = {world->up[0], world->up[1], world->up[2]};
    for (int k = 0; k < 3; k++)
        world->up[k] = rows[k][0] * up[0] + rows[k][1] * up[1] + rows[k][2] * up[2];
    for (uint32_t i = 0; i < world->count; i++) {
        fxs_placement *p = &world->objects[i];
        const fxs_placement old = *p;
        const double *t = old.translation;
        for (int k = 0; k < 3; k++)
            p->translation[k] = rows[k][0] * t[0] + rows[k][1] * t[1] + rows[k][2] * t[2] + rows[k][3];
        fxs_quaternion_product(p->rotation, whole->rotation, old.rotation);
        p->scale = whole->scale * old.scale;
    }
}

/* The time of all visible objects: the longest duration, the highest rate. It loops if all that move do. */
static fxs_time time_of(const fxs_world *world, const fxs_scene_file_info *infos)
{
    fxs_time all = {.loops = 1, .least = 1};
    for (uint32_t i = 0; i < world->count; i++) {
        const fxs_time *own = &infos[world->objects[i].file].time;
        if (!is_visible(&world->objects[i]) || !(own->duration > 0))
            continue;
        all.duration = fmax(all.duration, own->duration);
        all.rate = fmax(all.rate, own->rate);
        all.loops &= own->loops;
        all.degree = own->degree > all.degree ? own->degree : all.degree;
        all.turns |= own->turns;
        all.fades |= own->fades;
        all.least = own->fades ? fmin(all.least, own->least) : all.least;
    }
    if (!all.fades)
        all.least = 0;
    return all.duration > 0 ? all : (fxs_time){.duration = 0};
}

/* Gives each moving file the duration `time->duration`: what is shorter goes on as when it is played. Changes infos. */
static int share_time(const fxs_world *world, fxs_scene_file **files, fxs_scene_file_info *infos, const fxs_time *time,
                      fxs_message *message)
{
    for (uint32_t i = 0; i < world->file_count; i++)
        if (infos[i].time.duration < time->duration)
            FXS_TRY(fxs_scene_file_between(files[i], 0, time->duration, &infos[i], message));
    return 0;
}

static int merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos, const fxs_time *time,
                 fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_allocator *allocator = fxs_stream_allocator(files[0]);
    merge_reader *r = fxs_allocate_zeroed(allocator, 1, sizeof *r);
    if (!r) {
        close_all(files, world->file_count);
        fxs_fail(message, "out of memory");
        return FXS_ERR_MEMORY;
    }
    r->time = info->time = *time;
    const int moves = files[0]->import.moves;
    r->allocator = allocator;
    r->import = &files[0]->import;
    r->reader = &merged_format;
    r->data = r;
    fxs_stream_swap(files[0], &r->reader, &r->data);
    r->files = fxs_allocate_zeroed(allocator, world->file_count, sizeof(fxs_scene_file *));
    r->parts = fxs_allocate_zeroed(allocator, world->count, sizeof *r->parts);
    int error = FXS_ERR_MEMORY;
    if (r->files) {
        memcpy(r->files, files, world->file_count * sizeof(fxs_scene_file *));
        r->file_count = world->file_count;
    } else {
        close_all(files + 1, world->file_count - 1);
    }
    if (r->files && r->parts)
        error = list_parts(r, world, infos, info, message);
    else
        fxs_fail(message, "out of memory");
    if (!error)
        error = choose_origin(r, infos, moves, info, message);
    if (!error)
        error = count_kept(files[0], r, info, message);
    info->stored_sh_degree = info->sh_degree;
    if (error)
        fxs_scene_file_close(files[0]);
    else
        *merged = files[0];
    return error;
}

int fxs_world_merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos,
                    fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_allocator *allocator = fxs_stream_allocator(files[0]);
    const fxs_time time = time_of(world, infos);
    fxs_scene_file_info *shared = fxs_allocate(allocator, world->file_count, sizeof *shared);
    int error = shared ? 0 : fxs_fail_memory(message, NULL, world->file_count * sizeof *shared);
    *merged = NULL;
    *info = (fxs_scene_file_info){.format = "several", .levels = 1};
    if (shared) {
        memcpy(shared, infos, world->file_count * sizeof *shared);
        error = share_time(world, files, shared, &time, message);
    }
    if (error)
        close_all(files, world->file_count);
    else
        error = merge(world, files, shared, &time, merged, info, message);
    fxs_release(allocator, shared);
    return error;
}
