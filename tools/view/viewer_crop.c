/* The crop box of the window and its six handles. A dragged handle moves along its axis to the point nearest to the
   pointer's ray. */
#include <fixsplat/internal/placements.h>

#include <math.h>
#include <string.h>

#include "viewer.h"

/* Rounds the coordinate of a crop box side, so that few digits print it exactly. */
static double crop_side(double x)
{
    return fabs(x) < 4096 ? (double)(float)x : floor(x * 1024 + 0.5) / 1024;
}

void crop_begin(viewer *v)
{
    for (int i = 0; i < 3; i++) {
        v->crop.low[i] = crop_side(v->world.inner_low[i]);
        v->crop.high[i] = crop_side(v->world.inner_high[i]);
    }
    v->crop.on = v->dragged = 0;
    v->face = CROP_NONE;
}

static int axis_along(const double row[3], double scale)
{
    for (int k = 0; k < 3; k++)
        if (fabs(row[k]) > scale * (1 - 1e-12))
            return k;
    return -1;
}

/* True if all objects' axes are parallel to the world's. Only then can a box in the world crop the objects. */
static int can_crop(const world *w)
{
    for (uint32_t i = 0; i < w->count; i++) {
        const fxs_placement *p = &w->placed.objects[i];
        double rows[3][4];
        int keeping = 0;
        fxs_placement_matrix(p, rows);
        for (int k = 0; k < 3; k++)
            if (axis_along(rows[k], p->scale) < 0)
                return 0;
        for (uint32_t c = 0; c < p->crop_count; c++)
            keeping |= !p->crops[c].outside;
        if (!keeping && p->crop_count == FXS_MAX_CROPS)
            return 0;
    }
    return 1;
}

void crop_toggle(viewer *v)
{
    v->dragged = 0;
    v->face = CROP_NONE;
    if (!v->crop.on && eyes_of(v) > 1)
        snprintf(v->note, sizeof v->note, "no crop box for two eyes");
    else if (!v->crop.on && !can_crop(&v->world))
        snprintf(v->note, sizeof v->note, "no crop box: an object is turned, or has 8 crops already");
    else {
        v->crop.on = !v->crop.on;
        v->changed = 1;
    }
    v->exposed = 1;
}

/* Converts a crop box from world units to the units of an object. A point o of the object is in the world at w_i = s
   r_k o_k + t_i, with scale s, rotation r and translation t. */
static fxs_world_crop box_in(const fxs_placement *p, const crop_box *crop)
{
    fxs_world_crop box = {.outside = 0};
    double rows[3][4];
    fxs_placement_matrix(p, rows);
    for (int i = 0; i < 3; i++) {
        const int k = axis_along(rows[i], p->scale);
        const double a = (crop->low[i] - rows[i][3]) / rows[i][k];
        const double b = (crop->high[i] - rows[i][3]) / rows[i][k];
        box.low[k] = fmin(a, b);
        box.high[k] = fmax(a, b);
    }
    return box;
}

static int intersect(fxs_world_crop *crop, const fxs_world_crop *box)
{
    int common = 1;
    for (int i = 0; i < 3; i++) {
        crop->low[i] = fmax(crop->low[i], box->low[i]);
        crop->high[i] = fmin(crop->high[i], box->high[i]);
        common &= crop->low[i] <= crop->high[i];
    }
    return common;
}

static void crop_placement(fxs_placement *p, const crop_box *crop)
{
    const fxs_world_crop box = box_in(p, crop);
    const uint32_t count = p->crop_count;
    int keeping = 0, kept = 0;
    p->crop_count = 0;
    for (uint32_t c = 0; c < count; c++) {
        const int left = p->crops[c].outside || intersect(&p->crops[c], &box);
        keeping |= !p->crops[c].outside;
        kept |= !p->crops[c].outside && left;
        if (left)
            p->crops[p->crop_count++] = p->crops[c];
    }
    if (!keeping)
        p->crops[p->crop_count++] = box;
    else if (!kept)
        p->visible = 0;
}

/* Crops all objects by the box. Each call starts from the objects' original placements, so repeated crops do not
   accumulate. */
void crop_world(world *w, const crop_box *crop)
{
    fxs_message message;
    for (uint32_t i = 0; i < w->count; i++) {
        fxs_placement p = w->placed.objects[i];
        if (crop->on)
            crop_placement(&p, crop);
        fxs_object_place(&w->objects[i], w->scenes[p.file].opened->scene, &p, w->crops + i * FXS_MAX_CROPS, &message);
    }
}

void crop_handle(const crop_box *crop, int face, double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = (crop->low[i] + crop->high[i]) / 2;
    point[face / 2] = face % 2 ? crop->high[face / 2] : crop->low[face / 2];
}

int crop_face_at(const viewer *v, double x, double y)
{
    double point[3], pixel[2], nearest = 12 * fxs_window_scale(v->window);
    int found = CROP_NONE;
    for (int face = 0; face < CROP_FACES && v->seen.width; face++) {
        crop_handle(&v->crop, face, point);
        if (!viewer_project(v, point, pixel) || hypot(pixel[0] - x, pixel[1] - y) >= nearest)
            continue;
        nearest = hypot(pixel[0] - x, pixel[1] - y);
        found = face;
    }
    return found;
}

/* Computes the ray through a window position in the last frame: origin `from`, direction `along`. */
static void find_ray(const viewer *v, double x, double y, double from[3], double along[3])
{
    const fxs_view *view = &v->seen;
    int width, height;
    fxs_window_size(v->window, &width, &height);
    const double pixels = (double)view->height / height;
    const double right = (x * pixels - view->cx) / view->fx, down = (y * pixels - view->cy) / view->fy;
    const int parallel = view->projection == FXS_ORTHOGRAPHIC;
    for (int i = 0; i < 3; i++) {
        const double *r = view->rotation, across = right * r[i] + down * r[3 + i];
        from[i] = view->position[i] + (parallel ? across : 0);
        along[i] = (parallel ? 0 : across) + r[6 + i];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Finds where a handle of the crop box moves on its axis: the point at t on axis e through handle h that is nearest to
   the pointer's ray o + s d. t = (b (d w) / d^2 - e w) / (1 - b^2 / d^2), with b = e d and w = h - o. Returns 0 if axis
   and ray are nearly parallel. */
static int nearest_on_axis(const double h[3], int axis, const double o[3], const double d[3], double *t)
{
    const double w[3] = {h[0] - o[0], h[1] - o[1], h[2] - o[2]}, b = d[axis], square = dot(d, d);
    const double divisor = 1 - b * b / square;
    *t = divisor > 1e-3 ? (b * dot(d, w) / square - w[axis]) / divisor : 0;
    return divisor > 1e-3;
}

void crop_drag(viewer *v, double x, double y)
{
    const int axis = v->face / 2, is_high = v->face % 2;
    const double room = 0.01 * v->radius, thin = 1e-3 * v->radius;
    double point[3], pixel[2], from[3], along[3], step;
    crop_handle(&v->crop, v->face, point);
    find_ray(v, x, y, from, along);
    if (!nearest_on_axis(point, axis, from, along, &step))
        return;
    double *side = is_high ? &v->crop.high[axis] : &v->crop.low[axis];
    const double least = is_high ? v->crop.low[axis] + thin
                                 : fmin(v->world.low[axis], v->world.inner_low[axis]) - room;
    const double most = is_high ? fmax(v->world.high[axis], v->world.inner_high[axis]) + room
                                : v->crop.high[axis] - thin;
    point[axis] = fmin(fmax(*side + step, least), most);
    if (!viewer_project(v, point, pixel))
        return;
    *side = crop_side(point[axis]);
    v->changed = v->moving = 1;
}
