/* The reference renderer in doubles: EWA projection with the clamp and dilation of Kerbl et al. 2023. Splats
   (projected Gaussians) are sorted by depth and blended front to back, without tile lists. */
#include "reference.h"

#include <math.h>
#include <stdlib.h>

#define NEAR_DEFAULT 0.2
#define DILATION 0.3
#define ALPHA_MAX 0.99
#define TRANSMITTANCE_MIN 1e-4
#define TILE 16

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Clamps a value; NaN becomes `low`. */
static double clamp(double value, double low, double high)
{
    return value >= high ? high : value > low ? value : low;
}

static int finite_floats(const float *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

static int gaussian_is_valid(const fxs_gaussian *g)
{
    const float *q = g->rotation;
    return finite_floats(g->position, 3) && g->scale[0] < INFINITY && g->scale[1] < INFINITY
        && g->scale[2] < INFINITY && finite_floats(q, 4)
        && finite_floats(&g->opacity, 1) && finite_floats(g->dc, 3) && finite_floats(g->sh, 45)
        && (q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0);
}

/* Computes the rotation matrix of the quaternion w, x, y, z of any length. */
static void rotation_matrix(const float *rotation, double m[3][3])
{
    double q[4], length = 0;
    for (int i = 0; i < 4; i++)
        length += (double)rotation[i] * rotation[i];
    for (int i = 0; i < 4; i++)
        q[i] = rotation[i] / sqrt(length);

    double w = q[0], x = q[1], y = q[2], z = q[3];
    m[0][0] = 1 - 2 * (y * y + z * z), m[0][1] = 2 * (x * y - w * z), m[0][2] = 2 * (x * z + w * y);
    m[1][0] = 2 * (x * y + w * z), m[1][1] = 1 - 2 * (x * x + z * z), m[1][2] = 2 * (y * z - w * x);
    m[2][0] = 2 * (x * z - w * y), m[2][1] = 2 * (y * z + w * x), m[2][2] = 1 - 2 * (x * x + y * y);
}

/* Computes a row of the projection matrix of an orthographic camera: focal * axis. */
static void parallel_row(double focal, const double *axis, double row[3])
{
    for (int i = 0; i < 3; i++)
        row[i] = focal * axis[i];
}

/* Computes a row of J W: the Jacobian J of the perspective projection times the rotation W to the camera. J is the
   derivative of focal * x / z + centre, so the row is focal / z * (axis - slope * forward). The slope x/z is clamped to
   the image widened by 15 % of its size on each side. The linear approximation diverges beyond. */
static void jacobian_row(double focal, double centre, int size, double slope, double z, const double *axis,
                         const double *forward, double row[3])
{
    double margin = 0.3 * size / (2 * focal);
    double clamped = clamp(slope, -centre / focal - margin, (size - centre) / focal + margin);
    for (int i = 0; i < 3; i++)
        row[i] = focal / z * (axis[i] - clamped * forward[i]);
}

static void turn(const double m[9], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = dot(m + 3 * i, v);
}

static void turn_back(const double m[9], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[i] * v[0] + m[3 + i] * v[1] + m[6 + i] * v[2];
}

/* Computes the 2D covariance Sigma' = M M^T with M = J W O R S. The rows of J W are given. O is the rotation and
   scale of the object. R and S are the rotation and the scales of the Gaussian. */
static void project_covariance(const fxs_gaussian *g, const struct reference_object *object, double jw[2][3],
                               struct reference_splat *out)
{
    double rotation[3][3], m[2][3];
    rotation_matrix(g->rotation, rotation);
    for (int i = 0; i < 2; i++) {
        double row[3];
        turn_back(object->rotation, jw[i], row);
        for (int j = 0; j < 3; j++) {
            double column[3] = { rotation[0][j], rotation[1][j], rotation[2][j] };
            m[i][j] = dot(row, column) * exp(g->scale[j]) * object->scale;
        }
    }
    out->a = dot(m[0], m[0]);
    out->b = dot(m[0], m[1]);
    out->c = dot(m[1], m[1]);
}

static double determinant(const struct reference_splat *s)
{
    return s->a * s->c - s->b * s->b;
}

/* Evaluates the real spherical harmonics of degrees 1 to 3 in the unit direction d, with Condon-Shortley signs. */
static void sh_basis(const double *d, double basis[15])
{
    double x = d[0], y = d[1], z = d[2], xx = x * x, yy = y * y, zz = z * z;
    basis[0] = -0.4886025119029199 * y;
    basis[1] = 0.4886025119029199 * z;
    basis[2] = -0.4886025119029199 * x;
    basis[3] = 1.0925484305920792 * x * y;
    basis[4] = -1.0925484305920792 * y * z;
    basis[5] = 0.31539156525252005 * (2 * zz - xx - yy);
    basis[6] = -1.0925484305920792 * x * z;
    basis[7] = 0.5462742152960396 * (xx - yy);
    basis[8] = -0.5900435899266435 * y * (3 * xx - yy);
    basis[9] = 2.890611442640554 * x * y * z;
    basis[10] = -0.4570457994644658 * y * (4 * zz - xx - yy);
    basis[11] = 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy);
    basis[12] = -0.4570457994644658 * x * (4 * zz - xx - yy);
    basis[13] = 1.445305721320277 * z * (xx - yy);
    basis[14] = -0.5900435899266435 * x * (xx - 3 * yy);
}

/* Computes the colour of a Gaussian: max(0, 0.5 + SH) * tint. The SH are evaluated in the direction from the camera,
   rotated to the object's coordinates. */
static void shade(const fxs_gaussian *g, const struct reference_object *object, const double *from_camera, int degree,
                  double colour[3])
{
    double basis[15], direction[3], length = sqrt(dot(from_camera, from_camera));
    int terms = degree > 3 ? 15 : degree > 0 ? (degree + 1) * (degree + 1) - 1 : 0;
    turn_back(object->rotation, from_camera, direction);
    for (int i = 0; i < 3; i++)
        direction[i] /= length;
    sh_basis(direction, basis);
    for (int channel = 0; channel < 3; channel++) {
        double sum = 0.5 + 0.28209479177387814 * g->dc[channel];
        for (int k = 0; k < terms; k++)
            sum += basis[k] * g->sh[3 * k + channel];
        colour[channel] = sum > 0 ? sum * object->tint[channel] : 0;
    }
}

/* Radius of a splat in pixels: ceil(3 sqrt(lambda_max)), with the eigenvalue lambda_max computed as in Kerbl et al. */
static int square_radius(const struct reference_splat *s)
{
    double mid = (s->a + s->c) / 2, det = determinant(s);
    double lambda = mid + sqrt(fmax(0.1, mid * mid - det));
    return (int)fmin(ceil(3 * sqrt(lambda)), 1 << 30);
}

/* Returns the largest squared Mahalanobis distance d2 at which a splat is drawn. alpha >= 1/255 means d2 <= 2 ln(255
   opacity). */
static double distance_limit(const struct reference_splat *s, enum reference_cutoff cutoff)
{
    double limit = 2 * log(255 * s->opacity);
    return cutoff == REFERENCE_MAHALANOBIS && limit > 9 ? 9 : limit;
}

struct span { int first, end; };

static int clamp_index(double value, int size)
{
    return (int)clamp(value, 0, size);
}

/* Returns the pixels along one axis that a splat can cover. limit: largest squared Mahalanobis distance. A negative
   limit makes the radius NaN and gives an empty span. */
static struct span pixel_span(double centre, double variance, int radius, int size, double limit,
                              enum reference_cutoff cutoff)
{
    double index = centre - 0.5, reach = sqrt(limit * variance);
    struct span span = { clamp_index(floor(index - reach), size), clamp_index(ceil(index + reach) + 1, size) };
    if (cutoff == REFERENCE_SQUARE) {
        int first = clamp_index(TILE * floor((index - radius) / TILE), size);
        int end = clamp_index(TILE * floor((index + radius + TILE - 1) / TILE), size);
        span.first = first > span.first ? first : span.first;
        span.end = end < span.end ? end : span.end;
    }
    return span;
}

static void pixel_box(const struct reference_splat *s, int width, int height, enum reference_cutoff cutoff,
                      struct span *columns, struct span *rows)
{
    double limit = distance_limit(s, cutoff);
    *columns = pixel_span(s->x, s->a, s->radius, width, limit, cutoff);
    *rows = pixel_span(s->y, s->c, s->radius, height, limit, cutoff);
}

/* Projects the centre of a Gaussian and computes the Jacobian. Returns 0 unless the centre is beyond the near plane. */
static int project_centre(const double offset[3], const fxs_view *view, double jw[2][3],
                          struct reference_splat *out)
{
    const double *right = view->rotation, *down = right + 3, *forward = right + 6;
    double z = dot(forward, offset), x = dot(right, offset), y = dot(down, offset);
    if (!(z > (view->near > 0 ? view->near : NEAR_DEFAULT)))
        return 0;
    out->depth = z;
    if (view->projection == FXS_ORTHOGRAPHIC) {
        out->x = view->fx * x + view->cx;
        out->y = view->fy * y + view->cy;
        parallel_row(view->fx, right, jw[0]);
        parallel_row(view->fy, down, jw[1]);
        return 1;
    }
    out->x = view->fx * (x / z) + view->cx;
    out->y = view->fy * (y / z) + view->cy;
    jacobian_row(view->fx, view->cx, view->width, x / z, z, right, forward, jw[0]);
    jacobian_row(view->fy, view->cy, view->height, y / z, z, down, forward, jw[1]);
    return 1;
}

int reference_project_object(const fxs_gaussian *gaussian, const struct reference_object *object,
                             const fxs_view *view, const struct reference_options *options,
                             struct reference_splat *out)
{
    double offset[3], jw[2][3], position[3] = { gaussian->position[0], gaussian->position[1], gaussian->position[2] };
    turn(object->rotation, position, offset);
    for (int i = 0; i < 3; i++)
        offset[i] = object->translation[i] + object->scale * offset[i] - view->position[i];
    if (!gaussian_is_valid(gaussian) || !project_centre(offset, view, jw, out))
        return 0;
    project_covariance(gaussian, object, jw, out);
    double sharp_determinant = determinant(out);
    out->a += DILATION;
    out->c += DILATION;
    if (!isfinite(out->a) || !isfinite(out->c) || !(determinant(out) > 0))
        return 0;

    out->opacity = object->opacity / (1 + exp(-gaussian->opacity));
    if (options->antialiased)
        out->opacity *= sqrt(fmax(0, sharp_determinant / determinant(out)));
    out->radius = square_radius(out);
    shade(gaussian, object, view->projection == FXS_ORTHOGRAPHIC ? view->rotation + 6 : offset, options->sh_degree,
          out->colour);

    struct span columns, rows;
    pixel_box(out, view->width, view->height, options->cutoff, &columns, &rows);
    return columns.first < columns.end && rows.first < rows.end;
}

int reference_project(const fxs_gaussian *gaussian, const fxs_view *view, const struct reference_options *options,
                      struct reference_splat *out)
{
    static const struct reference_object as_it_lies = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, { 0, 0, 0 }, 1, 1, { 1, 1, 1 } };
    return reference_project_object(gaussian, &as_it_lies, view, options, out);
}

static void add_colour(double *pixel, double weight, const double *colour)
{
    for (int channel = 0; channel < 3; channel++)
        pixel[channel] += weight * colour[channel];
}

struct canvas {
    int width, height;
    const struct reference_options *options;
    const struct reference_splat *splats;
    double *transmittance, *rgb;
    struct reference_trace *trace;
};

static void trace_pixel(const struct canvas *canvas, const struct reference_splat *s, size_t i, double before,
                        double after)
{
    struct reference_trace *t = canvas->trace;
    const size_t number = (size_t)(s - canvas->splats);
    const double weight = before - after, most = t->most[i];
    t->mean[i] += weight * s->depth;
    t->weight[i] += weight;
    if (before >= 0.5 && after < 0.5)
        t->median[i] = number;
    t->median_margin[i] = fmin(t->median_margin[i], fabs(after - 0.5));
    const double second = fmax(most * (1 - t->largest_margin[i]), fmin(weight, most));
    if (weight > most) {
        t->largest[i] = number;
        t->most[i] = weight;
    }
    t->largest_margin[i] = 1 - second / t->most[i];
}

/* Blends a splat at a pixel, front to back. A pixel that becomes opaque blends its background at once and sets its
   transmittance to 0. */
static void blend_pixel(const struct canvas *canvas, const struct reference_splat *s, double alpha, size_t i)
{
    double before = canvas->transmittance[i], after = before * (1 - alpha);
    if (canvas->trace && canvas->trace->occluder && s->depth > canvas->trace->occluder[i])
        return;
    if (after < TRANSMITTANCE_MIN) {
        add_colour(&canvas->rgb[3 * i], before, canvas->options->background);
        canvas->transmittance[i] = 0;
    } else {
        add_colour(&canvas->rgb[3 * i], before * alpha, s->colour);
        canvas->transmittance[i] = after;
        if (canvas->trace)
            trace_pixel(canvas, s, i, before, after);
    }
}

static void blend_splat(const struct canvas *canvas, const struct reference_splat *s)
{
    double det = determinant(s), limit = distance_limit(s, canvas->options->cutoff);
    double xx = s->c / det, xy = -2 * s->b / det, yy = s->a / det;
    struct span columns, rows;
    pixel_box(s, canvas->width, canvas->height, canvas->options->cutoff, &columns, &rows);
    for (int row = rows.first; row < rows.end; row++) {
        double dy = row + 0.5 - s->y;
        for (int column = columns.first; column < columns.end; column++) {
            double dx = column + 0.5 - s->x;
            double d2 = (xx * dx + xy * dy) * dx + yy * dy * dy;
            size_t i = (size_t)row * (size_t)canvas->width + (size_t)column;
            if (d2 <= limit && canvas->transmittance[i] > 0)
                blend_pixel(canvas, s, fmin(ALPHA_MAX, s->opacity * exp(-d2 / 2)), i);
        }
    }
}

/* Compares two splats for qsort. Splats of equal depth are sorted by address, which is the order of their indices. */
static int compare_depth(const void *left, const void *right)
{
    const struct reference_splat *l = *(const struct reference_splat *const *)left;
    const struct reference_splat *r = *(const struct reference_splat *const *)right;
    if (l->depth < r->depth || l->depth > r->depth)
        return l->depth < r->depth ? -1 : 1;
    return (l > r) - (l < r);
}

int reference_trace_init(struct reference_trace *trace, int width, int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    *trace = (struct reference_trace){ 0, calloc(pixels, sizeof(double)), calloc(pixels, sizeof(double)),
                                       calloc(pixels, sizeof(size_t)), calloc(pixels, sizeof(double)),
                                       calloc(pixels, sizeof(size_t)), calloc(pixels, sizeof(double)),
                                       calloc(pixels, sizeof(double)) };
    return trace->mean && trace->weight && trace->median && trace->median_margin && trace->largest &&
           trace->most && trace->largest_margin ? 0 : -1;
}

void reference_trace_free(struct reference_trace *trace)
{
    free(trace->mean);
    free(trace->weight);
    free(trace->median);
    free(trace->median_margin);
    free(trace->largest);
    free(trace->most);
    free(trace->largest_margin);
}

/* Clears the depth targets of a picture. Until trace_end divides, `mean` holds the sum of weight * depth. */
static void trace_start(struct reference_trace *t, size_t pixels)
{
    for (size_t i = 0; i < pixels; i++) {
        t->mean[i] = t->weight[i] = t->most[i] = 0;
        t->median[i] = t->largest[i] = REFERENCE_NONE;
        t->median_margin[i] = 0.5;
        t->largest_margin[i] = 1;
    }
}

static void trace_end(struct reference_trace *t, size_t pixels)
{
    for (size_t i = 0; i < pixels; i++)
        t->mean[i] = t->weight[i] > 0 ? t->mean[i] / t->weight[i] : INFINITY;
}

int reference_trace_splats(const struct reference_splat *splats, size_t count, int width, int height,
                           const struct reference_options *options, struct reference_trace *trace, double *rgb)
{
    size_t pixels = (size_t)width * (size_t)height;
    const struct reference_splat **order = calloc(count + 1, sizeof *order);
    struct canvas canvas = { width, height, options, splats, calloc(pixels + 1, sizeof(double)), rgb, trace };
    int status = canvas.transmittance && order ? 0 : -1;
    if (status == 0) {
        for (size_t i = 0; i < count; i++)
            order[i] = &splats[i];
        qsort(order, count, sizeof *order, compare_depth);
        for (size_t i = 0; i < pixels; i++) {
            canvas.transmittance[i] = 1;
            rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = 0;
        }
        if (trace)
            trace_start(trace, pixels);
        for (size_t i = 0; i < count; i++)
            blend_splat(&canvas, order[i]);
        for (size_t i = 0; i < pixels; i++)
            add_colour(&rgb[3 * i], canvas.transmittance[i], options->background);
        if (trace)
            trace_end(trace, pixels);
    }
    free(order);
    free(canvas.transmittance);
    return status;
}

int reference_render_splats(const struct reference_splat *splats, size_t count, int width, int height,
                            const struct reference_options *options, double *rgb)
{
    return reference_trace_splats(splats, count, width, height, options, 0, rgb);
}

int reference_render(const fxs_gaussian *gaussians, size_t count, const fxs_view *view,
                     const struct reference_options *options, double *rgb)
{
    struct reference_splat *splats = calloc(count + 1, sizeof *splats);
    if (!splats)
        return -1;
    size_t visible = 0;
    for (size_t i = 0; i < count; i++)
        visible += (size_t)reference_project(&gaussians[i], view, options, &splats[visible]);
    int status = reference_render_splats(splats, visible, view->width, view->height, options, rgb);
    free(splats);
    return status;
}

void reference_to_rgba8(const double *rgb, int width, int height, uint8_t *rgba)
{
    size_t pixels = (size_t)width * (size_t)height;
    for (size_t i = 0; i < pixels; i++) {
        for (size_t channel = 0; channel < 3; channel++)
            rgba[4 * i + channel] = (uint8_t)(255 * clamp(rgb[3 * i + channel], 0, 1) + 0.5);
        rgba[4 * i + 3] = 255;
    }
}
