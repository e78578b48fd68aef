/* Tests how a fit finds the subject that the cameras surround, and how it crops a fit to the subject. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/internal/packed.h>
#include "fit_scene.h"

enum { PHOTOS = 12, POINTS = 600 };

static fxs_message message;

static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[POINTS];
static uint8_t pixels[3 * 64 * 48];

static void aim(int i, const double eye[3], const double target[3])
{
    static const double up[3] = {0, -1, 0};
    fxs_view *view = &photos[i].view;
    CHECK(!fxs_view_look_at(view, eye, target, up, &(fxs_picture){50, 64, 48}, &message));
    view->fx = view->fy = 60;
    photos[i].pixels = pixels;
}

/* Places the cameras in a circle around `middle` and aims them at it. At `middle` they see distance * 24 / 60
   units up and down. */
static void set_up(const double middle[3], const double distances[PHOTOS])
{
    for (int i = 0; i < PHOTOS; i++) {
        const double angle = i * 0.5235987755982988, distance = distances ? distances[i] : 10;
        const double eye[3] = {middle[0] + distance * cos(angle), middle[1], middle[2] + distance * sin(angle)};
        aim(i, eye, middle);
    }
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++) {
            points[i].position[k] = (float)(middle[k] + fit_uniform(-5, 5));
            points[i].colour[k] = 100;
        }
}

static void turn_back(int count)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 9; k++)
            if (k < 3 || k > 5)
                photos[i].view.rotation[k] = -photos[i].view.rotation[k];
}

static fxs_fit *make_fit(uint32_t steps)
{
    fxs_fit_options options;
    fxs_fit_report report;
    fxs_fit *fit;
    fxs_fit_options_init(&options);
    options.steps = steps;
    options.max_gaussians = POINTS;
    if (!CHECK(!fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message)))
        exit(1);
    for (uint32_t i = 0; i < steps && steps > 1; i++)
        CHECK(!fxs_fit_step(fit, &report, &message));
    return fit;
}

static size_t read_all(fxs_fit *fit, fxs_gaussian *to)
{
    fxs_gaussian_source source;
    CHECK(!fxs_fit_gaussians(fit, &source, &message) && source.count <= POINTS);
    CHECK(source.read(source.argument, 0, to, POINTS) == (long)source.count);
    return (size_t)source.count;
}

static double reach_of(const fxs_gaussian *g, const double middle[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += ((double)g->position[k] - middle[k]) * ((double)g->position[k] - middle[k]);
    return sqrt(square) + exp((double)fmaxf(fmaxf(g->scale[0], g->scale[1]), g->scale[2]));
}

/* Crops a fit to the subject. A fit of 20 steps quantises values in its last two steps. */
static void cropped(uint32_t steps)
{
    static const double middle[3] = {2, -3, 5};
    static fxs_gaussian before[POINTS], after[POINTS];
    fxs_fit_subject subject;
    fxs_packed_scene scene;
    fxs_pack_report report;
    size_t inside = 0;
    set_up(middle, NULL);
    turn_back(PHOTOS / 4);
    fxs_fit *fit = make_fit(steps);
    const size_t count = read_all(fit, before);
    CHECK(!fxs_fit_crop_to_subject(fit, &subject, &message));
    for (int k = 0; k < 3; k++)
        CHECK(fabs(subject.middle[k] - middle[k]) < 1e-5);
    CHECK(fabs(subject.radius - 4) < 1e-5);
    for (size_t i = 0; i < count; i++)
        inside += reach_of(&before[i], middle) <= 4;
    const size_t left = read_all(fit, after);
    CHECK(inside > 50 && inside < count - 50 && left == inside && subject.dropped == count - inside);
    for (size_t i = 0; i < left; i++)
        CHECK(reach_of(&after[i], middle) < 4.01);
    CHECK(!fxs_fit_pack(fit, &scene, &report, &message) && report.packed == left);
    fxs_packed_scene_free(&scene);
    CHECK(!fxs_fit_crop_to_subject(fit, &subject, &message) && subject.dropped <= left / 20);
    fxs_fit_destroy(fit);
}

static void cropped_as_it_is(void)
{
    cropped(1);
}

static void cropped_in_codes(void)
{
    cropped(20);
}

static void refuses(const char *words)
{
    static fxs_gaussian before[POINTS], after[POINTS];
    fxs_fit_subject subject;
    fxs_fit *fit = make_fit(1);
    const size_t count = read_all(fit, before);
    CHECK(fxs_fit_crop_to_subject(fit, &subject, &message) == FXS_ERR_ARGUMENT && strstr(message.text, words));
    CHECK(read_all(fit, after) == count && !memcmp(before, after, count * sizeof *before));
    fxs_fit_destroy(fit);
}

static void no_subject(void)
{
    static const double middle[3] = {0, 0, 0}, far[3] = {0, 0, 30};
    set_up(middle, NULL);
    turn_back(PHOTOS / 4 + 1);
    refuses("do not look at one thing: 8 of 12 photographs");
    set_up(middle, NULL);
    turn_back(PHOTOS);                          /* the cameras look outward, as in a room */
    for (int i = 0; i < POINTS; i++)
        points[i].position[2] *= 10;
    refuses("do not look at one thing: 0 of 12 photographs");
    for (int i = 0; i < PHOTOS; i++) {          /* the cameras stand side by side and look at a distant object */
        const double eye[3] = {0.05 * i, 0, 0};
        aim(i, eye, far);
    }
    refuses("do not look at one thing: 0 of 12 photographs");
    set_up(middle, NULL);
    for (int i = 0; i < PHOTOS; i++) {          /* the cameras aim beside the subject by 0.4 of the distance */
        const double *p = photos[i].view.position, eye[3] = {p[0], p[1], p[2]};
        const double target[3] = {-0.4 * eye[2], 0, 0.4 * eye[0]};
        aim(i, eye, target);
    }
    refuses("do not look at one thing: 0 of 12 photographs");
    set_up(middle, NULL);
    for (int i = 0; i < PHOTOS; i++) {          /* the cameras aim above and below in turn, by 0.3 of the distance */
        const double *p = photos[i].view.position, eye[3] = {p[0], p[1], p[2]};
        const double target[3] = {0, i % 2 ? 3 : -3, 0};
        aim(i, eye, target);
    }
    refuses("do not look at one thing: 0 of 12 photographs");
    set_up(middle, NULL);
    for (int i = 0; i < POINTS; i++)            /* all points lie above and below the cameras */
        points[i].position[1] += i % 2 ? 60 : -60;
    refuses("no Gaussian lies where the cameras look");
}

static void radius_of_the_median(void)
{
    static const double middle[3] = {0, 0, 0};
    static const double distances[PHOTOS] = {12, 5, 16, 7, 9, 10, 6, 8, 14, 15, 13, 11};
    fxs_fit_subject subject;
    set_up(middle, distances);
    fxs_fit *fit = make_fit(1);
    CHECK(!fxs_fit_crop_to_subject(fit, &subject, &message) && fabs(subject.radius - 11 * 0.4) < 1e-5);
    fxs_fit_destroy(fit);
}

int main(void)
{
    RUN(cropped_as_it_is);
    RUN(cropped_in_codes);
    RUN(no_subject);
    RUN(radius_of_the_median);
    return check_report();
}
