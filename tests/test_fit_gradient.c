/* Compares the gradients of a fit step with central differences of a forward pass in doubles, for every parameter.
   Also tests the cut-offs and the bounds of scales. */
#include "fit_loss.h"
#include "fit_scene.h"

enum { WIDTH = 37, HEIGHT = 27, PIXELS = WIDTH * HEIGHT, MOST = 64 };
/* the variables of a Gaussian: its parameters and its projected centre */
enum { CENTRE = FXS_FIT_PARAMETERS, VARIABLES = CENTRE + 2 };
enum { DEPTH = 3 };   /* typical depth of the picture in scene units; scales the learning rate of camera shifts */

/* Decisions at the cut-offs of a forward pass, such as which Gaussians reach a pixel. Both passes of a central
   difference share the decisions, because the gradient is defined only between cut-offs. */
enum { OUT, IN, CAPPED };
typedef struct cuts {
    int is_set;                    /* 0: the next forward pass makes the decisions; 1: it keeps them */
    int order[MOST], visible;
    unsigned char taken[PIXELS][MOST], dark[MOST][3], beside[MOST][2];
    unsigned char seen[MOST], outside[MOST], capped[MOST], closed[MOST];
    double nearest;                /* smallest relative distance of a value from its cut-off */
} cuts;

typedef struct scene {
    int count, degree;
    fxs_fit_camera camera;
    double variables[MOST][VARIABLES], background[3];
    enum fxs_fit_exposure exposure;
    /* exposure of the photograph: log exposure, red and blue factors; or an affine colour map */
    double gain[FXS_FIT_GAIN];
    double pose[FXS_FIT_POSE];
    int has_pose;
    double rotation[9], eye[3];    /* rotation and position of the camera after the pose correction */
    uint8_t photograph[PIXELS][3];
    const uint8_t *mask;
    cuts cuts;
} scene;

typedef struct flat {
    double depth, centre[2], q[3], opacity, colour[3];
} flat;

static double picture[3][PIXELS];

static int above(cuts *c, double value, double cut, double scale)
{
    c->nearest = fmin(c->nearest, fabs(value - cut) / scale);
    return value > cut;
}

static void rotation_of_quaternion(const double *q, double r[3][3])
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(r, rows, sizeof rows);
}

/* Computes the projected covariance J W Sigma W^T J^T + 0.3 I with Sigma = R S S R^T. With antialiasing,
   multiplies the opacity by the square root of a quotient: the determinant without 0.3 I by the determinant with
   0.3 I. */
static void flatten_shape(scene *s, int i, const double t[3], flat *f)
{
    const double *v = s->variables[i];
    const fxs_fit_camera *camera = &s->camera;
    double r[3][3], sigma[3][3] = {{0}}, m[2][3], flat_sigma[2][2] = {{0}};
    rotation_of_quaternion(v + FXS_FIT_ROTATION, r);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int k = 0; k < 3; k++)
                sigma[a][b] += r[a][k] * exp(2 * v[FXS_FIT_SCALE + k]) * r[b][k];
    for (int axis = 0; axis < 2; axis++) {
        const double slope = t[axis] / t[2], most = (double)camera->slope_most[axis];
        unsigned char *beside = &s->cuts.beside[i][axis];
        if (!s->cuts.is_set)
            *beside = (unsigned char)(above(&s->cuts, slope, most, 1) ? 2 : !above(&s->cuts, slope, -most, 1));
        const double cut = *beside == 2 ? most : *beside ? -most : slope;
        for (int k = 0; k < 3; k++)
            m[axis][k] = (double)camera->focal[axis] / t[2] * (s->rotation[3 * axis + k] - cut * s->rotation[6 + k]);
    }
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            for (int k = 0; k < 9; k++)
                flat_sigma[a][b] += m[a][k / 3] * sigma[k / 3][k % 3] * m[b][k % 3];
    const double sharp = flat_sigma[0][0] * flat_sigma[1][1] - flat_sigma[0][1] * flat_sigma[0][1];
    flat_sigma[0][0] += 0.3;
    flat_sigma[1][1] += 0.3;
    const double det = flat_sigma[0][0] * flat_sigma[1][1] - flat_sigma[0][1] * flat_sigma[0][1];
    if (camera->is_antialiased)
        f->opacity *= sqrt(sharp / det);
    f->q[0] = flat_sigma[1][1] / det;
    f->q[1] = -flat_sigma[0][1] / det;
    f->q[2] = flat_sigma[0][0] / det;
}

static void flatten_colour(scene *s, int i, const double offset[3], flat *f)
{
    const double *v = s->variables[i];
    const double length = sqrt(offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]);
    const double x = offset[0] / length, y = offset[1] / length, z = offset[2] / length;
    const double xx = x * x, yy = y * y, zz = z * z, pi = 3.14159265358979323846;
    const double basis[15] = {
        -sqrt(3 / (4 * pi)) * y, sqrt(3 / (4 * pi)) * z, -sqrt(3 / (4 * pi)) * x,
        sqrt(15 / (4 * pi)) * x * y, -sqrt(15 / (4 * pi)) * y * z, sqrt(5 / (16 * pi)) * (2 * zz - xx - yy),
        -sqrt(15 / (4 * pi)) * x * z, sqrt(15 / (16 * pi)) * (xx - yy),
        -sqrt(35 / (32 * pi)) * y * (3 * xx - yy), sqrt(105 / (4 * pi)) * x * y * z,
        -sqrt(21 / (32 * pi)) * y * (4 * zz - xx - yy), sqrt(7 / (16 * pi)) * z * (2 * zz - 3 * xx - 3 * yy),
        -sqrt(21 / (32 * pi)) * x * (4 * zz - xx - yy), sqrt(105 / (16 * pi)) * z * (xx - yy),
        -sqrt(35 / (32 * pi)) * x * (xx - 3 * yy)};
    for (int c = 0; c < 3; c++) {
        f->colour[c] = 0.5 + sqrt(1 / (4 * pi)) * v[FXS_FIT_COLOUR + c];
        for (int k = 0; k < (s->degree + 1) * (s->degree + 1) - 1; k++)
            f->colour[c] += basis[k] * v[FXS_FIT_SH + 3 * k + c];
        if (!s->cuts.is_set)
            s->cuts.dark[i][c] = !above(&s->cuts, f->colour[c], 0, 1);
        if (s->cuts.dark[i][c])
            f->colour[c] = 0;
    }
}

static void flatten(scene *s, int i, flat *f)
{
    const double *v = s->variables[i];
    const fxs_fit_camera *camera = &s->camera;
    double offset[3], t[3] = {0};
    for (int k = 0; k < 3; k++)
        offset[k] = v[FXS_FIT_POSITION + k] - s->eye[k];
    for (int k = 0; k < 9; k++)
        t[k / 3] += s->rotation[k] * offset[k % 3];
    f->depth = t[2];
    f->opacity = 1 / (1 + exp(-v[FXS_FIT_OPACITY]));
    for (int axis = 0; axis < 2; axis++)
        f->centre[axis] = (double)camera->focal[axis] * t[axis] / t[2] + (double)camera->middle[axis] +
                          v[CENTRE + axis];
    s->cuts.outside[i] = f->centre[0] < 0 || f->centre[1] < 0 || f->centre[0] > WIDTH || f->centre[1] > HEIGHT;
    flatten_shape(s, i, t, f);
    flatten_colour(s, i, offset, f);
}

static void sort(scene *s, const flat *flats)
{
    s->cuts.visible = 0;
    for (int i = 0; i < s->count; i++) {
        if (!above(&s->cuts, flats[i].depth, (double)s->camera.near, 1))
            continue;
        int at = s->cuts.visible++;
        for (; at && !above(&s->cuts, flats[i].depth, flats[s->cuts.order[at - 1]].depth, 1); at--)
            s->cuts.order[at] = s->cuts.order[at - 1];
        s->cuts.order[at] = i;
    }
}

static int decide(cuts *c, int i, double level, double alpha, double transmittance)
{
    if (above(c, level, 9, 9) || !above(c, alpha, 1 / 255.0, 1 / 255.0))
        return OUT;
    if (!above(c, transmittance, 0.001, 0.001)) {
        c->closed[i] = 1;
        return OUT;
    }
    c->seen[i] = 1;
    const int capped = above(c, alpha, 0.99, 0.01);
    c->capped[i] |= (unsigned char)capped;
    return capped ? CAPPED : IN;
}

/* Applies the pose correction to the camera. Rotates by 2 atan(|a| / 2) about the vector a in the camera's frame, by
   Rodrigues' formula. Moves the camera along its unrotated axes. */
static void pose(scene *s)
{
    const double *a = s->pose, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]), angle = 2 * atan(length / 2);
    const double axis[3] = {a[0] / fmax(length, 1e-30), a[1] / fmax(length, 1e-30), a[2] / fmax(length, 1e-30)};
    const double cross[9] = {0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
    for (int k = 0; k < 9; k++) {
        s->rotation[k] = 0;
        for (int i = 0; i < 3; i++)
            s->rotation[k] += (cos(angle) * (k / 3 == i) + sin(angle) * cross[k / 3 * 3 + i] +
                               (1 - cos(angle)) * axis[k / 3] * axis[i]) * (double)s->camera.rotation[3 * i + k % 3];
    }
    for (int k = 0; k < 3; k++) {
        s->eye[k] = (double)s->camera.eye[k];
        for (int i = 0; i < 3; i++)
            s->eye[k] += (double)s->camera.rotation[3 * i + k] * s->pose[3 + i];
    }
}

static const double affine[FXS_FIT_GAIN] = {1.25, -0.125, 0.0625, 0.1875, 0.75, -0.0625, -0.25, 0.125, 1.125, 0.0625,
                                            -0.03125, 0.125};

static void expose(const scene *s, double colour[3])
{
    const double *g = s->gain, factor[3] = {exp2(g[0] + g[1]), exp2(g[0] - g[1] - g[2]), exp2(g[0] + g[2])};
    double mapped[3];
    for (int c = 0; c < 3 && s->exposure == FXS_FIT_EXPOSURE_GAIN; c++)
        colour[c] *= factor[c];
    if (s->exposure != FXS_FIT_EXPOSURE_AFFINE)
        return;
    for (int c = 0; c < 3; c++)
        mapped[c] = colour[0] * affine[c] + colour[1] * affine[3 + c] + colour[2] * affine[6 + c] + affine[9 + c];
    for (int c = 0; c < 3; c++)
        colour[c] = mapped[c] + mapped[0] * g[c] + mapped[1] * g[3 + c] + mapped[2] * g[6 + c] + g[9 + c];
}

static void draw(scene *s)
{
    flat flats[MOST];
    pose(s);
    for (int i = 0; i < s->count; i++)
        flatten(s, i, &flats[i]);
    if (!s->cuts.is_set)
        sort(s, flats);
    for (int p = 0; p < PIXELS; p++) {
        double transmittance = 1, colour[3] = {0};
        for (int k = 0; k < s->cuts.visible; k++) {
            const int i = s->cuts.order[k];
            const flat *f = &flats[i];
            unsigned char *taken = &s->cuts.taken[p][i];
            if (s->cuts.is_set && *taken == OUT)
                continue;
            const double x = f->centre[0] - (p % WIDTH + 0.5), y = f->centre[1] - (p / WIDTH + 0.5);
            const double level = f->q[0] * x * x + 2 * f->q[1] * x * y + f->q[2] * y * y;
            double alpha = f->opacity * exp(-level / 2);
            if (!s->cuts.is_set)
                *taken = (unsigned char)decide(&s->cuts, i, level, alpha, transmittance);
            alpha = *taken == CAPPED ? 0.99 : *taken == IN ? alpha : 0;
            for (int c = 0; c < 3; c++)
                colour[c] += transmittance * alpha * f->colour[c];
            transmittance *= 1 - alpha;
        }
        for (int c = 0; c < 3; c++)
            colour[c] += transmittance * s->background[c];
        expose(s, colour);
        for (int c = 0; c < 3; c++)
            picture[c][p] = colour[c];
    }
    s->cuts.is_set = 1;
}

static double difference(scene *s, double *variable)
{
    const double kept = *variable, h = 1e-6;
    double loss[2];
    for (int side = 0; side < 2; side++) {
        *variable = kept + (side ? h : -h);
        draw(s);
        loss[side] = 0;
        for (int c = 0; c < 3; c++)
            loss[side] += fit_loss(picture[c], &s->photograph[0][c], s->mask, s->exposure != FXS_FIT_EXPOSURE_NONE,
                                   WIDTH, HEIGHT);
    }
    *variable = kept;
    return (loss[1] - loss[0]) / (2 * h);
}

typedef struct kind {
    int count;
    float focal;
    double aside;                  /* Gaussians lie at slopes x/z and y/z within this range; 1: half the picture */
    double scale[2], opacity[2], colour[2];
    const uint8_t *mask;
    int is_antialiased;
} kind;

static void make_scene(scene *s, const kind *k, int degree, enum fxs_fit_exposure exposure, int has_pose)
{
    static const double gain[3] = {0.375, -0.25, 0.125}, at[] = {0.0625, -0.25, 0.1875, -0.125, 0.0625, 0.25};
    do {
        memset(s, 0, sizeof *s);
        s->exposure = exposure;
        s->mask = k->mask;
        for (int i = 0; i < 3; i++)
            s->gain[i] = exposure == FXS_FIT_EXPOSURE_GAIN ? gain[i] : 0;
        s->has_pose = has_pose;
        for (int i = 0; i < FXS_FIT_POSE; i++)
            s->pose[i] = has_pose ? at[i] : 0;
        s->count = k->count;
        s->degree = degree;
        s->camera = fit_camera(WIDTH, HEIGHT, k->focal);
        s->camera.is_antialiased = k->is_antialiased;
        pose(s);
        s->cuts.nearest = INFINITY;
        for (int c = 0; c < 3; c++)
            s->background[c] = (float)fit_uniform(0, 1);
        for (int i = 0; i < k->count; i++) {
            const fxs_fit_camera *camera = &s->camera;
            const double z = fit_uniform(1.5, 4);
            double t[3] = {0, 0, z}, *v = s->variables[i];
            for (int axis = 0; axis < 2; axis++)
                t[axis] = z * k->aside * fit_uniform(-1, 1) * (axis ? HEIGHT : WIDTH) / 2 / (double)camera->focal[axis];
            for (int a = 0; a < 3; a++) {
                v[a] = s->eye[a];
                for (int b = 0; b < 3; b++)
                    v[a] += s->rotation[3 * b + a] * t[b];
                v[FXS_FIT_SCALE + a] = fit_uniform(k->scale[0], k->scale[1]);
                v[FXS_FIT_COLOUR + a] = fit_uniform(k->colour[0], k->colour[1]);
            }
            for (int a = 0; a < 4; a++)
                v[FXS_FIT_ROTATION + a] = fit_uniform(-1, 1);
            v[FXS_FIT_OPACITY] = fit_uniform(k->opacity[0], k->opacity[1]);
            for (int a = FXS_FIT_SH; a < FXS_FIT_PARAMETERS; a++)
                v[a] = fit_uniform(-0.2, 0.2);
            for (int a = 0; a < FXS_FIT_PARAMETERS; a++)
                v[a] = (float)v[a];
        }
        draw(s);
    } while (s->cuts.nearest < 3e-5);
    for (int p = 0; p < PIXELS; p++)
        for (int c = 0; c < 3; c++) {
            uint8_t *b = &s->photograph[p][c];
            *b = (uint8_t)fit_uniform(0, 256);
            if (fabs(picture[c][p] * 255 - *b) < 0.02)
                *b = (uint8_t)(*b < 255 ? *b + 1 : *b - 1);
        }
}

typedef struct photographs {
    fxs_fit_gain gains[2];
    fxs_fit_pose poses[2];
} photographs;

/* Runs the first step of a fit. Afterwards, Adam's running mean is a tenth of each gradient. */
static void step_once(const scene *s, const fxs_fit_stages *stages, fxs_fit_model *m, photographs *of)
{
    const int is_affine = s->exposure == FXS_FIT_EXPOSURE_AFFINE;
    fxs_fit_gains gains = {of->gains, 2, is_affine};
    fxs_fit_poses poses = {of->poses, 2};
    fxs_fit_stepper *stepper = fxs_fit_stepper_create(stages, NULL, NULL, 1, NULL);
    const fxs_fit_photograph photograph = {s->photograph[0], WIDTH, HEIGHT, 1, s->camera, 1, s->mask};
    fxs_fit_step_options options = {.sh_degree = s->degree, .number = 1, .gain_rate = 0.01f, .pose_rate = 0.01f};
    fxs_fit_report report;
    if (!stepper || fxs_fit_model_room(m, (size_t)s->count))
        abort();
    for (int c = 0; c < 3; c++)
        options.background[c] = (float)s->background[c];
    for (int i = 0; i < s->count; i++)
        for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
            m->parameters[(size_t)k * m->stride + (size_t)i] = (float)s->variables[i][k];
    memset(of, 0, sizeof *of);
    for (int k = 0; k < FXS_FIT_GAIN; k++)
        of->gains[1].at[k] = (float)(is_affine ? affine[k] : s->gain[k]);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        of->poses[1].at[k] = (float)s->pose[k];
    of->poses[1].depth = DEPTH;
    m->gains = s->exposure ? &gains : NULL;
    m->poses = s->has_pose ? &poses : NULL;
    CHECK(fxs_fit_stepper_step(stepper, m, &photograph, 1, &options, &report) == 0);
    m->gains = NULL;
    m->poses = NULL;
    fxs_fit_stepper_free(stepper);
}

static double gradient_of(const fxs_fit_model *m, int i, int k)
{
    return (double)m->means[(size_t)k * m->stride + (size_t)i] / (double)0.1f;
}

static double size_of(const double *d, int k)
{
    static const int ends[] = {FXS_FIT_SCALE, FXS_FIT_ROTATION, FXS_FIT_OPACITY, FXS_FIT_COLOUR, FXS_FIT_PARAMETERS};
    int first = 0, at = 0;
    double size = 0;
    while (ends[at] <= k)
        first = ends[at++];
    for (int i = first; i < ends[at]; i++)
        size = fmax(size, fabs(d[i]));
    return size;
}

typedef struct tally {
    int gaussians, unseen, outside, beside, dark, capped, closed;
    double worst;                  /* largest error of a gradient until now, relative to its tolerance */
} tally;

static void count_cuts(const scene *s, int i, tally *t)
{
    const int seen = s->cuts.seen[i];
    t->gaussians++;
    t->unseen += !seen;
    t->outside += seen && s->cuts.outside[i];
    t->beside += seen && (s->cuts.beside[i][0] || s->cuts.beside[i][1]);
    t->capped += s->cuts.capped[i];
    t->closed += s->cuts.closed[i];
    t->dark += seen && (s->cuts.dark[i][0] || s->cuts.dark[i][1] || s->cuts.dark[i][2]);
}

/* Compares a gradient with its central difference. The tolerance allows for single precision, with an error of 1e-5
   of a pixel's weight. */
static void check_near(double value, double wanted, double size, int i, int k, tally *t)
{
    const double fault = fabs(value - wanted) / (1e-4 * size + 2e-5);
    t->worst = fmax(t->worst, fault);
    if (!CHECK(fault < 1))
        printf("  Gaussian %d, variable %d: %g, by differences %g\n", i, k, value, wanted);
}

static void check_gaussian(scene *s, const fxs_fit_model *m, int i, tally *t)
{
    double d[VARIABLES];
    for (int k = 0; k < VARIABLES; k++)
        d[k] = difference(s, &s->variables[i][k]);
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++) {
        check_near(gradient_of(m, i, k), d[k], size_of(d, k), i, k, t);
        if (!s->cuts.seen[i] || k >= FXS_FIT_SH + 3 * ((s->degree + 1) * (s->degree + 1) - 1))
            CHECK(d[k] == 0 && gradient_of(m, i, k) == 0);
    }
    /* m->by_centre is the length of the loss gradient with respect to the projected centre. Its loss is a mean
       over pixels and channels, so the expected value is scaled. */
    const double length = hypot(d[CENTRE] * WIDTH / 2, d[CENTRE + 1] * HEIGHT / 2) / WIDTH;
    check_near((double)m->by_centre[i] * 3 * PIXELS / WIDTH, length, length, i, CENTRE, t);
}

static void check_gain(scene *s, const fxs_fit_gain of[2], tally *t)
{
    static const fxs_fit_gain none;
    for (int k = 0; k < FXS_FIT_GAIN && s->exposure == FXS_FIT_EXPOSURE_AFFINE; k++) {
        const double unit = k > 8 ? 0.03125 : k % 4 ? 0.25 : 1;
        const double wanted = unit * difference(s, &s->gain[k]);
        check_near((double)of[1].mean[k] / (double)0.1f * 3 * PIXELS, wanted, 1 + fabs(wanted), -1, k, t);
    }
    CHECK(!memcmp(of[0].mean, none.mean, sizeof none.mean) && (s->exposure || !memcmp(&of[1], &none, sizeof none)));
}

/* Checks a step of a camera pose: each number moves against its gradient, by its learning rate. */
static void check_pose(scene *s, const fxs_fit_pose of[2], tally *t)
{
    static const fxs_fit_pose none, still = {.depth = DEPTH};
    CHECK(!memcmp(&of[0], &none, sizeof none) && (s->has_pose || !memcmp(&of[1], &still, sizeof still)));
    for (int k = 0; k < FXS_FIT_POSE && s->has_pose; k++) {
        const double wanted = difference(s, &s->pose[k]), mean = (double)of[1].mean[k];
        double length = 0;
        for (int i = k / 3 * 3; i < k / 3 * 3 + 3; i++)
            length += (double)of[1].mean[i] * (double)of[1].mean[i];
        check_near(mean / (double)0.1f * 3 * PIXELS, wanted, 1 + fabs(wanted), -1, k, t);
        CHECK(fabs((double)of[1].at[k] - s->pose[k] + (k < 3 ? 0.01 : 0.01 * DEPTH) * mean / sqrt(length)) < 1e-6);
    }
}

static void check_versions(const scene *s, const fxs_fit_model *c, const photographs *photographs_of_c)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    const size_t bytes = FXS_FIT_PARAMETERS * c->stride * sizeof(float);
    for (int i = 1; i < count; i++) {
        fxs_fit_model m;
        photographs of;
        step_once(s, versions[i], &m, &of);
        if (!CHECK(!memcmp(&of, photographs_of_c, sizeof of)) ||
            !CHECK(!memcmp(m.means, c->means, bytes) && !memcmp(m.squares, c->squares, bytes)) ||
            !CHECK(!memcmp(m.parameters, c->parameters, bytes)) ||
            !CHECK(!memcmp(m.by_centre, c->by_centre, c->stride * sizeof(float))))
            printf("  %s\n", versions[i]->name);
        fxs_fit_model_free(&m);
    }
}

static tally check_scenes(const kind *k, int scenes)
{
    static scene s;
    tally t = {0};
    fit_state = (uint64_t)k->count;
    for (int n = 0; n < scenes; n++) {
        fxs_fit_model m;
        photographs of;
        make_scene(&s, k, 3 - n % 4, (enum fxs_fit_exposure)((n + 1) % 3), n % 4 != 3);
        step_once(&s, fxs_fit_stages_choose(0), &m, &of);
        check_versions(&s, &m, &of);
        check_gain(&s, of.gains, &t);
        check_pose(&s, of.poses, &t);
        for (int i = n; i < s.count; i += 1 + s.count / 8) {
            count_cuts(&s, i, &t);
            check_gaussian(&s, &m, i, &t);
        }
        fxs_fit_model_free(&m);
    }
    printf("  of %d Gaussians %d unseen, %d outside, %d beside, %d dark, %d capped, %d behind closed pixels; %.2f\n",
           t.gaussians, t.unseen, t.outside, t.beside, t.dark, t.capped, t.closed, t.worst);
    return t;
}

static void test_ordinary(void)
{
    const kind k = {6, 30, 1, {-2.5, -0.8}, {-2, 3}, {0, 1.5}, NULL, 0};
    const tally t = check_scenes(&k, 4);
    CHECK(t.gaussians - t.unseen > 15);
}

static void test_beyond_the_picture(void)
{
    const kind k = {7, 12, 2.2, {-1.5, 0.3}, {-1, 3}, {0, 1.5}, NULL, 0};
    const tally t = check_scenes(&k, 6);
    CHECK(t.outside > 8 && t.beside > 5 && t.unseen > 3);
}

static void test_colours_below_0(void)
{
    const kind k = {8, 30, 1, {-2.5, -0.8}, {-1, 3}, {-2.5, -1}, NULL, 0};
    CHECK(check_scenes(&k, 4).dark > 10);
}

static void test_opaque(void)
{
    const kind k = {16, 30, 1, {-1.5, -0.3}, {4, 9}, {0, 1.5}, NULL, 0};
    const tally t = check_scenes(&k, 5);
    CHECK(t.capped > 8 && t.closed > 8);
}

static void test_ignored_pixels(void)
{
    static uint8_t mask[PIXELS];
    const kind k = {6, 30, 1, {-2.5, -0.8}, {-2, 3}, {0, 1.5}, mask, 0};
    for (int i = 0; i < PIXELS; i++)
        mask[i] = (i % WIDTH / 7 + i / WIDTH / 5) % 3 ? 255 : 0;
    const tally t = check_scenes(&k, 4);
    CHECK(t.gaussians - t.unseen > 15);
}

static void test_antialiased(void)
{
    const kind small = {10, 30, 1, {-4.5, -1.5}, {0, 5}, {0, 1.5}, NULL, 1};
    const kind needles = {9, 30, 1, {-6, -0.3}, {1, 5}, {0, 1.5}, NULL, 1};
    const kind beyond = {7, 12, 2.2, {-2, 0.3}, {-1, 3}, {0, 1.5}, NULL, 1};
    tally t = check_scenes(&small, 5);
    CHECK(t.gaussians - t.unseen > 12);
    t = check_scenes(&needles, 5);
    CHECK(t.gaussians - t.unseen > 12);
    t = check_scenes(&beyond, 5);
    CHECK(t.outside > 5 && t.beside > 3);
}

/* Depths of one plane have its normal at each pixel inside the picture, and move no splats. On a ridge between two
   planes, positions are drawn along the normals. */
static void check_depths(const fxs_fit_stages *stages)
{
    enum { STRIDE = WIDTH + 2 * FXS_FIT_MARGIN + 16, SIZE = STRIDE * (HEIGHT + 2 * FXS_FIT_MARGIN) };
    static float numbers[7][SIZE];
    const fxs_fit_camera camera = fit_camera(WIDTH, HEIGHT, 30);
    fxs_fit_plane planes[7];
    memset(numbers, 0, sizeof numbers);
    for (int k = 0; k < 7; k++)
        planes[k] = (fxs_fit_plane){numbers[k] + FXS_FIT_MARGIN * STRIDE + FXS_FIT_MARGIN, STRIDE};
    for (int ridge = 0; ridge < 2; ridge++) {
        for (int p = 0; p < PIXELS; p++) {
            const double x = p % WIDTH, y = p / WIDTH, bend = ridge ? 0.02 * fabs(x - 18) / camera.focal[0] : 0;
            const double plane[3] = {0.05, -0.08, 0.3};
            const double ray[2] = {(x + 0.5 - camera.middle[0]) / camera.focal[0],
                                   (y + 0.5 - camera.middle[1]) / camera.focal[1]};
            const ptrdiff_t at = p / WIDTH * STRIDE + p % WIDTH;
            planes[0].first[at] = (float)(plane[0] * ray[0] + plane[1] * ray[1] + plane[2] + bend);
            planes[1].first[at] = 1;
            planes[2].first[at] = (float)plane[0];
            planes[3].first[at] = (float)plane[1];
        }
        for (int is_depth = 0; is_depth < 2; is_depth++)
            for (int y = 0; y < HEIGHT; y++) {
                stages->depths(&camera, planes, y, is_depth, 2, planes + 4);
                for (int x = 0; x < WIDTH; x++) {
                    const ptrdiff_t at = y * STRIDE + x;
                    const int is_edge = x < 1 || y < 1 || x == WIDTH - 1 || y == HEIGHT - 1;
                    double in_camera[3] = {0, 0, 0}, length = sqrt(0.05 * 0.05 + 0.08 * 0.08 + 0.3 * 0.3);
                    for (int k = 0; k < 9; k++)
                        in_camera[k / 3] += (double)camera.rotation[k] * (double)planes[4 + k % 3].first[at];
                    if (is_edge)
                        CHECK(in_camera[0] == 0 && in_camera[1] == 0 && in_camera[2] == 0);
                    else if (!ridge && !is_depth)
                        CHECK(fabs(in_camera[0] - 0.1 / length) < 1e-3 && fabs(in_camera[1] + 0.16 / length) < 1e-3 &&
                              fabs(in_camera[2] - 0.6 / length) < 1e-3);
                    else if (!ridge && x > 1 && x < WIDTH - 2 && y > 1 && y < HEIGHT - 2)
                        CHECK(fabs(in_camera[2]) < 1e-2);
                    else if (ridge && is_depth && x == 18 && y > 1 && y < HEIGHT - 2)
                        CHECK(in_camera[2] > 0.01);
                }
            }
    }
}

static void test_depths(void)
{
    for (int i = 0; i < FIT_VERSIONS; i++)
        check_depths(fxs_fit_stages_choose(fit_cpus[i]));
}

static void test_many(void)
{
    const kind k = {48, 30, 1, {-1.5, -0.3}, {-1, 4}, {0, 1.5}, NULL, 0};
    CHECK(check_scenes(&k, 4).closed > 15);
}

/* A single pixel with a few splats (projected Gaussians). Holds the transmittance after them and the gradient of each
   splat. */
enum { SPLATS = 3 };
typedef struct pixel_case {
    const fxs_fit_stages *stages;
    int32_t x, y;
    uint32_t count;
    fxs_fit_splat splats[SPLATS];
    fxs_fit_tile tile;
    float sums[SPLATS][FXS_FIT_SUMS];
} pixel_case;

static void run_pixel(pixel_case *c)
{
    fxs_fit_entry entries[SPLATS];
    fxs_fit_tile_gradient gradient = {0};
    const int at = FXS_FIT_AT(c->x, c->y);
    for (uint32_t i = 0; i < SPLATS; i++)
        entries[i] = (fxs_fit_entry){.splat = i, .slot = i, .blocks = 0xffff};
    const uint32_t needed = c->stages->blend(c->splats, entries, c->count, 0, 0, 1, &c->tile);
    for (int i = 0; i < 3; i++) {
        gradient.colour[i][at] = 1;
        gradient.whole[at] += c->tile.colour[i][at] + 0.5f * c->tile.transmittance[at];
    }
    memset(c->sums, 0, sizeof c->sums);
    c->stages->backward(c->splats, entries, needed, 0, 0, &gradient, c->sums);
}

static float left_of(const pixel_case *c)
{
    return c->tile.transmittance[FXS_FIT_AT(c->x, c->y)];
}

static int is_zero(const float *sums)
{
    for (int i = 0; i < FXS_FIT_SUMS; i++)
        if (sums[i] != 0)
            return 0;
    return 1;
}

/* Bisects a number down to two adjacent floats, `low` without the property that `has` tests and `high` with it. */
static void close_in(pixel_case *c, float *number, float *low, float *high, int (*has)(pixel_case *))
{
    for (;;) {
        const float middle = *low + (*high - *low) / 2;
        if (middle <= *low || middle >= *high)
            break;
        *number = middle;
        *(has(c) ? high : low) = middle;
    }
    *number = *low;
    CHECK(!has(c));
    *number = *high;
    CHECK(has(c));
}

static fxs_fit_splat everywhere(double alpha)
{
    const fxs_fit_splat s = {.centre = {8, 8}, .offset = (float)-log2(alpha), .limit = FXS_FIT_FAINT,
                             .colour = {0.3f, 0.5f, 0.9f}, .depth = 1};
    return s;
}

static int is_taken(pixel_case *c)
{
    run_pixel(c);
    return left_of(c) < 1;
}

static void test_cut_of_level(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    fit_state = 1;
    for (int n = 0; n < 100 * count; n++) {
        pixel_case c = {.stages = versions[n % count], .count = 1, .splats = {everywhere(0.9)}};
        c.x = (int32_t)(fit_random() % 16), c.y = (int32_t)(fit_random() % 16);
        fxs_fit_splat *s = &c.splats[0];
        float low = 0, high = 20;
        for (int i = 0; i < 2; i++)
            s->centre[i] = (float)fit_uniform(3, 13);
        s->ux = (float)fit_uniform(0.02, 0.25), s->uy = (float)fit_uniform(-0.2, 0.2);
        s->vy = (float)fit_uniform(0.02, 0.25);
        const double x = c.x + 0.5 - (double)s->centre[0], y = c.y + 0.5 - (double)s->centre[1];
        const double u = (double)s->ux * x + (double)s->uy * y, v = (double)s->vy * y;
        const double level = u * u + v * v + (double)s->offset;
        close_in(&c, &s->limit, &low, &high, is_taken);
        CHECK(fabs((double)high - level) < 1e-6 * (1 + level));
        CHECK(c.sums[0][FXS_FIT_SUM] != 0 && c.sums[0][FXS_FIT_RED] > 0);
        s->limit = low;
        run_pixel(&c);
        CHECK(is_zero(c.sums[0]) && left_of(&c) == 1);
    }
}

static int is_third_taken(pixel_case *c)
{
    run_pixel(c);
    return c->tile.colour[0][FXS_FIT_AT(c->x, c->y)] > 0;
}

/* Tests the pixel's transmittance just above and just below 0.001, below which no third splat (projected Gaussian) is
   blended. */
static void test_closed_pixel(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    for (int n = 0; n < count; n++) {
        pixel_case c = {versions[n], 3 + 2 * n, 12 - n, SPLATS, {everywhere(1), everywhere(0.9), everywhere(0.5)},
                        .sums = {{0}}};
        float low = (float)-log2(0.905), high = (float)-log2(0.895);
        c.splats[0].colour[0] = c.splats[1].colour[0] = 0;
        close_in(&c, &c.splats[1].offset, &low, &high, is_third_taken);
        CHECK(fabs(exp2(-(double)high) - 0.9) < 1e-5);
        CHECK(c.sums[2][FXS_FIT_SUM] != 0 && c.sums[2][FXS_FIT_RED] > 0);
        c.splats[1].offset = low;
        run_pixel(&c);
        CHECK(is_zero(c.sums[2]) && c.sums[1][FXS_FIT_SUM] != 0 && c.sums[0][FXS_FIT_GREEN] > 0);
        CHECK(left_of(&c) < 0.001f && left_of(&c) > 0.000999f);
    }
}

static int varies(pixel_case *c)
{
    run_pixel(c);
    return c->sums[0][FXS_FIT_SUM] != 0;
}

static void test_alpha_of_99(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    for (int n = 0; n < count; n++) {
        pixel_case c = {versions[n], 5, 6, 1, {everywhere(1)}, .sums = {{0}}};
        float low = (float)-log2(0.9901), high = (float)-log2(0.9899);
        close_in(&c, &c.splats[0].offset, &low, &high, varies);
        CHECK(fabs(exp2(-(double)high) - 0.99) < 1e-6);
        c.splats[0].offset = low;
        run_pixel(&c);
        CHECK(left_of(&c) == 1 - 0.99f && c.sums[0][FXS_FIT_RED] > 0);
    }
}

static fxs_fit_splat project_red(const fxs_fit_stages *stages, double logit, float depth, float red)
{
    static float parameters[FXS_FIT_PARAMETERS][FXS_FIT_GROUP];
    const fxs_fit_camera camera = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .focal = {20, 20}, .middle = {8, 8},
                                   .slope_most = {0.5f, 0.5f}, .near = 0.25f, .width = 16, .height = 16, .tiles_x = 1,
                                   .tiles_y = 1};
    fxs_fit_splat splats[FXS_FIT_GROUP];
    for (int i = 0; i < FXS_FIT_GROUP; i++) {
        parameters[2][i] = depth;
        parameters[FXS_FIT_ROTATION][i] = 1;
        parameters[FXS_FIT_OPACITY][i] = (float)logit;
        parameters[FXS_FIT_COLOUR][i] = i == 5 ? red : 0;
    }
    stages->project(&camera, 0, parameters[0], FXS_FIT_GROUP, 0, FXS_FIT_GROUP, splats);
    return splats[5];
}

static fxs_fit_splat project_one(const fxs_fit_stages *stages, double logit, float depth)
{
    return project_red(stages, logit, depth, 0);
}

/* Splats (projected Gaussians) must end at Mahalanobis distance 3 or at alpha 1/255, whichever is nearer to the
   centre. */
static void test_project_cuts(void)
{
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    for (int n = 0; n < count; n++) {
        for (double logit = -5.5; logit < 16; logit += 0.01) {
            const double opacity = 1 / (1 + exp(-logit)), offset = -log2(opacity), faint = log2(255.0);
            const fxs_fit_splat s = project_one(versions[n], logit, 2);
            if (logit < -log(254.0)) {
                CHECK(s.depth == 0);
                continue;
            }
            CHECK(s.depth == 2 && fabs((double)s.offset - offset) < 1e-6 * (1 + offset));
            CHECK(fabs((double)s.limit - fmin(offset + 4.5 / log(2), faint)) < 2e-6 * faint);
        }
        CHECK(project_one(versions[n], -log(254.0) - 1e-5, 2).depth == 0);
        CHECK(project_one(versions[n], -log(254.0) + 1e-5, 2).depth > 0);
        CHECK(project_one(versions[n], 0, 0.25f).depth == 0 && project_one(versions[n], 0, -2).depth == 0);
        CHECK(project_one(versions[n], 0, nextafterf(0.25f, 1)).depth > 0);
    }
}

static void test_no_colour(void)
{
    static const float bad[] = {NAN, INFINITY, 1e30f};
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    for (int n = 0; n < count; n++) {
        const fxs_fit_splat good = project_red(versions[n], 2, 2, 1), dark = project_red(versions[n], 2, 2, -1e30f);
        CHECK(good.colour[0] > 0.7f && good.colour[1] == 0.5f && dark.colour[0] == 0 && dark.limit == good.limit);
        for (int i = 0; i < 3; i++) {
            pixel_case c = {versions[n], 8, 8, 1, {project_red(versions[n], 2, 2, bad[i])}, .sums = {{0}}};
            const fxs_fit_splat *s = &c.splats[0];
            CHECK(s->depth == good.depth && s->tiles == good.tiles && s->limit < 0 && s->colour[0] == 0);
            run_pixel(&c);
            CHECK(left_of(&c) == 1 && is_zero(c.sums[0]) && c.tile.colour[1][FXS_FIT_AT(8, 8)] == 0);
        }
    }
}

/* Tests the bounds of the scales of Gaussians. The bound comes from the nearest camera that sees the Gaussian. A
   Gaussian in a margin around the picture counts as seen. */
static void test_bounds_of_scales(void)
{
    enum { BESIDE = FXS_FIT_GROUP - 3, FAR_BESIDE, BEHIND };
    fxs_fit_camera of[2] = {fit_camera(40, 24, 30), fit_camera(40, 24, 30)};
    const fxs_fit_cameras cameras = {of, 2};
    const fxs_fit_stages *versions[FIT_VERSIONS];
    const int count = fit_versions(versions);
    const double pixel = sqrt(0.2) / (double)of[0].focal[1];
    for (int k = 0; k < 3; k++)
        of[1].eye[k] += of[1].rotation[6 + k];
    for (int n = 0; n < 2 * count; n++) {
        const int divisor = n % 2 ? 4 : 1;
        float parameters[FXS_FIT_PARAMETERS][FXS_FIT_GROUP] = {{0}};
        for (int i = 0; i < FXS_FIT_GROUP; i++)
            for (int k = 0; k < 3; k++) {
                const float at = i == BESIDE ? 1.1f : i == FAR_BESIDE ? 1.2f : 0.5f;
                const float along = i == BEHIND ? -4 : 4, aside = along * (40 * at - of[0].middle[0]) / of[0].focal[0];
                parameters[k][i] = of[0].eye[k] + along * of[0].rotation[6 + k] + aside * of[0].rotation[k];
                parameters[FXS_FIT_SCALE + k][i] = k ? -9 : 2;
            }
        versions[n / 2]->smooth(&cameras, divisor, parameters[0], FXS_FIT_GROUP, 0, FXS_FIT_GROUP);
        for (int i = 0; i < FXS_FIT_GROUP; i++) {
            const double wanted = i >= FAR_BESIDE ? -9 : log(pixel * divisor * (i == BESIDE ? 4 : 3));
            CHECK(parameters[FXS_FIT_SCALE][i] == 2);
            for (int k = 1; k < 3; k++)
                CHECK(fabs((double)parameters[FXS_FIT_SCALE + k][i] - wanted) < 1e-5);
        }
    }
}

int main(void)
{
    RUN(test_ordinary);
    RUN(test_beyond_the_picture);
    RUN(test_colours_below_0);
    RUN(test_opaque);
    RUN(test_antialiased);
    RUN(test_depths);
    RUN(test_many);
    RUN(test_ignored_pixels);
    RUN(test_cut_of_level);
    RUN(test_closed_pixel);
    RUN(test_alpha_of_99);
    RUN(test_project_cuts);
    RUN(test_no_colour);
    RUN(test_bounds_of_scales);
    return check_report();
}
