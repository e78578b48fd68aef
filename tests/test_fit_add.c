/* Tests photographs and points that are added to a running fit, and steps that it repeats meanwhile. */
#include <math.h>

#include <fixsplat/internal/fit_more.h>
#include <fixsplat/system.h>
#include "src/base/random.h"
#include "folder.h"

enum { FIRST = 2, PHOTOS = 4, WIDTH = 40, HEIGHT = 24, POINTS = 90, NEW = 25, STEPS = 160, AT = 70, MOST = 2000 };

static fxs_message message;
static uint8_t pixels[PHOTOS][3 * WIDTH * HEIGHT];
static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[POINTS + NEW];
static fxs_fit_options options;

static float uniform(uint64_t index)
{
    return fxs_random_uniform(fxs_random(23, 4, index));
}

static void make_input(void)
{
    fxs_fit_options_init(&options);
    options.steps = STEPS;
    options.max_gaussians = MOST;
    for (int i = 0; i < PHOTOS; i++) {
        fxs_view *v = &photos[i].view;
        const double turn = 0.4 * (i - 1.5), c = cos(turn), s = sin(turn), rotation[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
        *v = (fxs_view){.width = WIDTH, .height = HEIGHT, .fx = 36, .fy = 36, .cx = WIDTH / 2.0, .cy = HEIGHT / 2.0,
                        .position = {-4 * s, 0, -4 * c}};
        snprintf(v->name, sizeof v->name, "%d.png", i);
        memcpy(v->rotation, rotation, sizeof rotation);
        photos[i].pixels = pixels[i];
        for (int p = 0; p < 3 * WIDTH * HEIGHT; p++)
            pixels[i][p] = (uint8_t)(((p / 3 % WIDTH / 5 + p / 3 / WIDTH / 4 * 3 + i) * 53 + p % 3 * 90) % 256);
    }
    for (uint64_t i = 0; i < POINTS + NEW; i++)
        for (uint64_t k = 0; k < 3; k++) {
            points[i].position[k] = 2 * uniform(6 * i + k) - 1;
            points[i].colour[k] = (uint8_t)(255 * uniform(6 * i + 3 + k));
        }
}

static fxs_fit *begin(void)
{
    fxs_fit *fit;
    if (!CHECK(!fxs_fit_create(&fit, photos, FIRST, points, POINTS, &options, &message))) {
        printf("  %s\n", message.text);
        exit(1);
    }
    return fit;
}

static void go_on(fxs_fit *fit, uint32_t steps)
{
    while (fxs_fit_steps(fit) < steps)
        if (!CHECK(!fxs_fit_step(fit, NULL, &message)))
            exit(1);
}

static int add(fxs_fit *fit, size_t all, const fxs_fit_point *new_points, size_t count)
{
    return fxs_fit_add_photos(fit, photos, all, new_points, count, &message);
}

static size_t read_all(fxs_fit *fit, fxs_gaussian *out)
{
    fxs_gaussian_source all;
    CHECK(!fxs_fit_gaussians(fit, &all, &message));
    return (size_t)all.read(all.argument, 0, out, options.max_gaussians);
}

static void save(fxs_fit *fit, const char *name)
{
    CHECK(!fxs_fit_save(fit, in_folder(name), &message));
}

static int same(const char *one, const char *other)
{
    static uint8_t bytes[2][1 << 20];
    const char *names[2] = {one, other};
    size_t sizes[2];
    for (int i = 0; i < 2; i++) {
        FILE *file = fopen(in_folder(names[i]), "rb");
        sizes[i] = file ? fread(bytes[i], 1, sizeof bytes[i], file) : 0;
        if (file)
            fclose(file);
    }
    return sizes[0] > 1000 && sizes[0] == sizes[1] && !memcmp(bytes[0], bytes[1], sizes[0]);
}

static void points_become_gaussians(void)
{
    static fxs_gaussian before[MOST], after[MOST];
    fxs_fit *fit = begin();
    go_on(fit, AT);
    const size_t count = read_all(fit, before);
    CHECK(!add(fit, FIRST, points + POINTS, NEW));
    CHECK(read_all(fit, after) == count + NEW);
    CHECK(!memcmp(before, after, count * sizeof *before));
    for (size_t i = 0; i < NEW; i++) {
        const fxs_gaussian *g = &after[count + i];
        CHECK(!memcmp(g->position, points[POINTS + i].position, sizeof g->position));
        CHECK(g->scale[0] < 0 && g->scale[0] > -12 && g->scale[0] == g->scale[1] && g->scale[0] == g->scale[2]);
    }
    go_on(fit, STEPS);
    fxs_fit_destroy(fit);
}

static void there_may_be_too_many_points(void)
{
    static fxs_gaussian all[MOST];
    options.max_gaussians = POINTS + 4;
    fxs_fit *fit = begin();
    CHECK(!add(fit, FIRST, points + POINTS, NEW) && read_all(fit, all) == POINTS + 4);
    CHECK(!add(fit, FIRST, points + POINTS, NEW) && read_all(fit, all) == POINTS + 4);
    fxs_fit_destroy(fit);
    options.max_gaussians = MOST;
}

static void fit_in_parts(const char *name, const char *saved)
{
    fxs_fit *fit = begin();
    go_on(fit, AT);
    CHECK(!add(fit, FIRST + 1, points + POINTS, NEW));
    CHECK(!fxs_fit_repeat(fit, 10, &message));
    go_on(fit, AT + 15);
    CHECK(!add(fit, PHOTOS, NULL, 0));
    if (saved)
        save(fit, saved);
    go_on(fit, STEPS + 10);
    CHECK(fxs_fit_repeated(fit) == 10);
    save(fit, name);
    fxs_fit_destroy(fit);
}

static void resumes(const char *saved, const char *name)
{
    fxs_fit *fit;
    fxs_fit_photo mixed[PHOTOS] = {photos[3], photos[1], photos[0], photos[2]};
    size_t count;
    CHECK(!fxs_fit_saved_order(in_folder(saved), mixed, PHOTOS, &count, &message) && count == PHOTOS);
    CHECK(!memcmp(mixed, photos, sizeof mixed));
    if (!CHECK(!fxs_fit_resume(&fit, in_folder(saved), mixed, PHOTOS, &options, &message)))
        return;
    CHECK(fxs_fit_repeated(fit) == 10 && fxs_fit_steps(fit) == AT + 15);
    go_on(fit, STEPS + 10);
    save(fit, name);
    fxs_fit_destroy(fit);
}

static void goes_on_after_a_save(void)
{
    fit_in_parts("whole", "half");
    resumes("half", "resumed");
    CHECK(same("whole", "resumed"));
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    options.refine_poses = 1;
    options.antialiased = 1;
    fit_in_parts("whole", "half");
    resumes("half", "resumed");
    CHECK(same("whole", "resumed"));
    options.exposure = FXS_FIT_EXPOSURE_NONE;
    options.refine_poses = options.antialiased = 0;
}

static void does_not_depend_on_threads(void)
{
    fit_in_parts("whole", NULL);
    options.workers = (fxs_workers){fxs_pool_run, fxs_pool_create(3), 3};
    options.cpu = 0;
    fit_in_parts("threads", NULL);
    fxs_pool_destroy(options.workers.pool);
    options.workers = (fxs_workers){0};
    options.cpu = ~0u;
    CHECK(same("whole", "threads"));
}

static void does_not_depend_on_the_device(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *fit;
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    options.refine_poses = options.antialiased = 1;
    fit_in_parts("whole", NULL);
    options.device_count = 1;
    const int error = fxs_fit_create(&fit, photos, FIRST, points, POINTS, &options, &message);
    fxs_fit_destroy(fit);
    if (!error)
        fit_in_parts("device", NULL);
    options = mine;
    if (error)
        SKIP(message.text);
    CHECK(same("whole", "device"));
}

static void faulty_repeats_are_refused(void)
{
    static uint8_t bytes[1 << 20];
    fxs_fit *fit;
    FILE *file = fopen(in_folder("half"), "rb");
    const size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (file)
        fclose(file);
    bytes[size - 24] = 0;          /* the number of repeated steps, before two others, the end and the checksum */
    put_file("changed", bytes, size);
    CHECK(fxs_fit_resume(&fit, in_folder("changed"), photos, PHOTOS, &options, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "a number out of its range") != NULL);
}

static void part_of_the_photographs_may_be_new(void)
{
    fxs_fit_photo mixed[PHOTOS] = {photos[3], photos[2], photos[1], photos[0]};
    fxs_fit *fit = begin();
    size_t count;
    save(fit, "two");
    CHECK(!fxs_fit_saved_order(in_folder("two"), mixed, PHOTOS, &count, &message) && count == FIRST);
    CHECK(!memcmp(mixed, photos, FIRST * sizeof *mixed));
    CHECK(mixed[2].pixels == photos[3].pixels && mixed[3].pixels == photos[2].pixels);
    CHECK(fxs_fit_saved_order(in_folder("two"), mixed + 1, PHOTOS - 1, &count, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "a fit of 2 photographs, of which 1 are here") != NULL);
    fxs_fit_destroy(fit);
}

static void repeated_steps_come_on_top(void)
{
    fxs_fit *fit = begin();
    CHECK(fxs_fit_repeat(fit, 1, &message) == FXS_ERR_ARGUMENT);
    go_on(fit, 20);
    CHECK(fxs_fit_repeat(fit, 21, &message) == FXS_ERR_ARGUMENT && fxs_fit_repeated(fit) == 0);
    CHECK(!fxs_fit_repeat(fit, 20, &message) && fxs_fit_repeated(fit) == 20);
    go_on(fit, STEPS);
    CHECK(!fxs_fit_repeat(fit, 1, &message));    /* the last tenth of 160 steps begins after 144 + 20 */
    go_on(fit, STEPS - STEPS / 10 + 22);
    CHECK(fxs_fit_repeat(fit, 1, &message) == FXS_ERR_ARGUMENT && strstr(message.text, "cannot repeat 1") != NULL);
    fxs_fit_destroy(fit);
}

/* While a fit waits for photographs, its Gaussians grow in number only with new points. */
static void waiting_does_not_add_gaussians(void)
{
    static fxs_gaussian all[MOST];
    fxs_fit *fit = begin();
    size_t count = 0;
    go_on(fit, STEPS / 2);
    for (int i = 0; i < 30; i++) {
        CHECK(!fxs_fit_repeat(fit, 10, &message));
        count = count ? count : read_all(fit, all);
        go_on(fit, STEPS / 2 + 10 * (uint32_t)i + 10);
    }
    CHECK(count > 2 * POINTS && read_all(fit, all) == count);
    CHECK(!add(fit, PHOTOS, points + POINTS, NEW));
    for (int i = 30; i < 60; i++) {
        CHECK(!fxs_fit_repeat(fit, 10, &message));
        go_on(fit, STEPS / 2 + 10 * (uint32_t)i + 10);
    }
    const size_t later = read_all(fit, all);
    CHECK(fabs((double)(later - count) - NEW * pow(1.05, 37)) < 2);    /* 37 relocations in the first 80 steps */
    go_on(fit, STEPS + 600);
    CHECK(read_all(fit, all) > later);
    fxs_fit_destroy(fit);
}

static void bad_input_is_refused(void)
{
    static fxs_gaussian all[MOST];
    fxs_fit *fit = begin();
    fxs_fit_point far = points[0];
    far.position[1] = INFINITY;
    CHECK(add(fit, FIRST - 1, NULL, 0) == FXS_ERR_ARGUMENT && strstr(message.text, "has more photographs") != NULL);
    CHECK(add(fit, FIRST, &far, 1) == FXS_ERR_ARGUMENT);
    photos[2].view.fx = -1;
    CHECK(add(fit, PHOTOS, NULL, 0) == FXS_ERR_ARGUMENT && strstr(message.text, "photograph 2") != NULL);
    photos[2].view.fx = 36;
    CHECK(read_all(fit, all) == POINTS);
    go_on(fit, STEPS - 3);
    CHECK(add(fit, PHOTOS, NULL, 0) == FXS_ERR_ARGUMENT && strstr(message.text, "last tenth") != NULL);
    go_on(fit, STEPS);
    fxs_fit_destroy(fit);
}

static void tests(void)
{
    make_input();
    RUN(points_become_gaussians);
    RUN(there_may_be_too_many_points);
    RUN(goes_on_after_a_save);
    RUN(does_not_depend_on_threads);
    RUN(does_not_depend_on_the_device);
    RUN(faulty_repeats_are_refused);
    RUN(part_of_the_photographs_may_be_new);
    RUN(repeated_steps_come_on_top);
    RUN(waiting_does_not_add_gaussians);
    RUN(bad_input_is_refused);
}

int main(void)
{
    return in_a_folder(tests);
}
