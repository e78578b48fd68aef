/* Checks placements of scenes in a world (a list of placed scenes), and converts placements to objects, matrices and
   boxes. */
#include <fixsplat/world.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/placements.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/gaussian/attributes.h"

#define FARTHEST 0x1p28
#define SCALE_LEAST 0x1p-16
#define SCALE_MOST 0x1p16
#define CROP_MOST 0x1p30

void fxs_placement_init(fxs_placement *p, uint32_t file, uint32_t id)
{
    memset(p, 0, sizeof *p);
    p->file = file;
    p->rotation[0] = p->scale = p->opacity = p->tint[0] = p->tint[1] = p->tint[2] = 1;
    p->visible = 1;
    p->id = id;
}

int fxs_placement_is_plain(const fxs_placement *p)
{
    const double *q = p->rotation, *t = p->translation;
    return q[1] == 0 && q[2] == 0 && q[3] == 0 && t[0] == 0 && t[1] == 0 && t[2] == 0 && p->scale == 1 &&
           p->opacity == 1 && p->tint[0] == 1 && p->tint[1] == 1 && p->tint[2] == 1;
}

/* Rotates a placed scene so that its up vector u becomes v = (0, -1, 0). The quaternion of the shortest rotation is (1
   + u v, u x v). For u = (0, 1, 0), half a turn about x is used. */
void fxs_placement_turn_up(fxs_placement *p, const double up[3])
{
    const double most = fmax(fmax(fabs(up[0]), fabs(up[1])), fabs(up[2]));
    const double x = up[0] / most, y = up[1] / most, z = up[2] / most, length = sqrt(x * x + y * y + z * z);
    const double turn[4] = {1 - y / length, z / length, 0, -x / length};
    const double opposite[4] = {0, 1, 0, 0};
    memcpy(p->rotation, turn[0] > 1e-12 ? turn : opposite, sizeof p->rotation);
}

/* Rotates a placed scene further about an axis: the quaternion q becomes r q, with the rotation r. */
void fxs_placement_turn(fxs_placement *p, int axis, double degrees)
{
    const double half = fmod(degrees, 360) * (3.14159265358979324 / 360), c = cos(half), s = sin(half);
    const int j = (axis + 1) % 3 + 1, k = (axis + 2) % 3 + 1;
    double *q = p->rotation;
    const double old[4] = {q[0], q[1], q[2], q[3]};
    q[0] = c * old[0] - s * old[axis + 1];
    q[axis + 1] = c * old[axis + 1] + s * old[0];
    q[j] = c * old[j] - s * old[k];
    q[k] = c * old[k] + s * old[j];
}

static int no_memory(fxs_message *message)
{
    fxs_fail(message, "out of memory");
    return FXS_ERR_MEMORY;
}

int fxs_world_add_file(fxs_world *world, const char *path, uint32_t *file, fxs_message *message)
{
    for (*file = 0; *file < world->file_count; ++*file)
        if (!strcmp(world->files[*file], path))
            return 0;
    char **files = realloc(world->files, (world->file_count + 1) * sizeof *files);
    if (!files)
        return no_memory(message);
    world->files = files;
    const size_t length = strlen(path) + 1;
    files[*file] = malloc(length);
    if (!files[*file])
        return no_memory(message);
    memcpy(files[*file], path, length);
    world->file_count++;
    return 0;
}

int fxs_world_add(fxs_world *world, const fxs_placement *placement, fxs_message *message)
{
    if (world->count == FXS_MAX_OBJECTS) {
        fxs_fail(message, "more than %u objects", FXS_MAX_OBJECTS);
        return FXS_ERR_OBJECT;
    }
    if (world->count == world->room) {
        const uint32_t room = world->room ? 2 * world->room : 8;
        fxs_placement *objects = realloc(world->objects, room * sizeof *objects);
        if (!objects)
            return no_memory(message);
        world->objects = objects;
        world->room = room;
    }
    world->objects[world->count++] = *placement;
    return 0;
}

void fxs_world_free(fxs_world *world)
{
    for (uint32_t i = 0; i < world->file_count; i++)
        free(world->files[i]);
    free(world->files);
    free(world->objects);
    memset(world, 0, sizeof *world);
}

static int out_of_range(fxs_message *message, const char *what, const char *expected)
{
    fxs_fail(message, "%s: expected %s", what, expected);
    return FXS_ERR_OBJECT;
}

static int is_between(double x, double low, double high)
{
    return x >= low && x <= high;
}

static int is_quaternion(const double q[4])
{
    double most = 0;
    for (int i = 0; i < 4; i++) {
        if (!isfinite(q[i]))
            return 0;
        if (fabs(q[i]) > most)
            most = fabs(q[i]);
    }
    return is_between(most, 1e-100, 1e100);
}

static int check(const fxs_placement *p, fxs_message *message)
{
    for (int i = 0; i < 3; i++) {
        if (!(fabs(p->translation[i]) < FARTHEST))
            return out_of_range(message, "translation", "within 2^28 units");
        if (!is_between(p->tint[i], 0, 4))
            return out_of_range(message, "tint", "0 to 4");
    }
    if (!is_quaternion(p->rotation))
        return out_of_range(message, "rotation", "a quaternion w, x, y, z that is not 0");
    if (!is_between(p->scale, SCALE_LEAST, SCALE_MOST))
        return out_of_range(message, "scale", "above 0: 2^-16 to 2^16");
    if (!is_between(p->opacity, 0, 1))
        return out_of_range(message, "opacity", "0 to 1");
    if (p->id == FXS_NOTHING)
        return out_of_range(message, "id", "0 to 4294967294");
    if (p->crop_count > FXS_MAX_CROPS)
        return out_of_range(message, "crops", "at most 8");
    for (uint32_t c = 0; c < p->crop_count; c++)
        for (int i = 0; i < 3; i++)
            if (!(p->crops[c].low[i] <= p->crops[c].high[i]))
                return out_of_range(message, "crops", "low at most high");
    return 0;
}

static int64_t to_fixed(double x, int q)
{
    return (int64_t)floor(ldexp(x, q) + 0.5);
}

static void rotation_of(double r[3][3], const double quaternion[4])
{
    double most = 0, q[4];
    for (int i = 0; i < 4; i++)
        if (fabs(quaternion[i]) > most)
            most = fabs(quaternion[i]);
    for (int i = 0; i < 4; i++)
        q[i] = quaternion[i] / most;
    fxs_rotation_matrix(r, q[0], q[1], q[2], q[3]);
}

static int64_t crop_side(double x)
{
    return to_fixed(x < -CROP_MOST ? -CROP_MOST : x > CROP_MOST ? CROP_MOST : x, 32);
}

int fxs_object_place(fxs_object *object, const fxs_scene *scene, const fxs_placement *p, fxs_crop *crops,
                     fxs_message *message)
{
    double r[3][3];
    const int error = check(p, message);
    if (error)
        return error;
    fxs_object_init(object, scene);
    rotation_of(r, p->rotation);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            object->rotation_q30[3 * i + j] = (int32_t)to_fixed(r[i][j], 30);
        object->translation_q32[i] = to_fixed(p->translation[i], 32);
        object->tint_q13[i] = (uint32_t)to_fixed(p->tint[i], 13);
    }
    object->scale_q32 = to_fixed(p->scale, 32);
    object->opacity_q16 = (uint32_t)to_fixed(p->opacity, 16);
    object->visible = p->visible;
    object->id = p->id;
    object->crop_count = p->crop_count;
    object->crops = p->crop_count ? crops : 0;
    for (uint32_t c = 0; c < p->crop_count; c++) {
        for (int i = 0; i < 3; i++) {
            crops[c].low_q32[i] = crop_side(p->crops[c].low[i]);
            crops[c].high_q32[i] = crop_side(p->crops[c].high[i]);
        }
        crops[c].outside = p->crops[c].outside;
    }
    return 0;
}

void fxs_placement_matrix(const fxs_placement *p, double rows[3][4])
{
    double r[3][3];
    rotation_of(r, p->rotation);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            rows[i][j] = p->scale * r[i][j];
        rows[i][3] = p->translation[i];
    }
}

/* Intersects a box with the bounding box of all crops that keep what is inside them. Returns 0 if nothing is left. */
static int crop_box(const fxs_placement *p, double low[3], double high[3])
{
    double kept_low[3] = {INFINITY, INFINITY, INFINITY}, kept_high[3] = {-INFINITY, -INFINITY, -INFINITY};
    int keeping = 0;
    for (uint32_t c = 0; c < p->crop_count; c++) {
        keeping |= !p->crops[c].outside;
        for (int i = 0; i < 3 && !p->crops[c].outside; i++) {
            kept_low[i] = p->crops[c].low[i] < kept_low[i] ? p->crops[c].low[i] : kept_low[i];
            kept_high[i] = p->crops[c].high[i] > kept_high[i] ? p->crops[c].high[i] : kept_high[i];
        }
    }
    for (int i = 0; i < 3 && keeping; i++) {
        low[i] = kept_low[i] > low[i] ? kept_low[i] : low[i];
        high[i] = kept_high[i] < high[i] ? kept_high[i] : high[i];
        if (low[i] > high[i])
            return 0;
    }
    return 1;
}

int fxs_placement_box(const fxs_placement *p, const double low[3], const double high[3], double world_low[3],
                      double world_high[3])
{
    double rows[3][4], l[3], h[3];
    memcpy(l, low, sizeof l);
    memcpy(h, high, sizeof h);
    if (!crop_box(p, l, h))
        return 0;
    fxs_placement_matrix(p, rows);
    for (int i = 0; i < 3; i++)
        for (int corner = 0; corner < 8; corner++) {
            const double x = rows[i][0] * (corner & 1 ? h[0] : l[0]) + rows[i][1] * (corner & 2 ? h[1] : l[1]) +
                             rows[i][2] * (corner & 4 ? h[2] : l[2]) + rows[i][3];
            world_low[i] = !corner || x < world_low[i] ? x : world_low[i];
            world_high[i] = !corner || x > world_high[i] ? x : world_high[i];
        }
    return 1;
}
