/* Tests checkpoints of a fit. A resumed fit must end with the result of an uninterrupted fit. Damaged files must be
   refused. */
#include <math.h>

#include "src/fit/coarse.h"
#include "src/base/random.h"
#include <fixsplat/system.h>
#include <fixsplat/internal/fit_more.h>
#include "folder.h"

enum { PHOTOS = 3, WIDTH = 40, HEIGHT = 24, POINTS = 90, SAVED_AT = 611, LATE = 671, STEPS = 705 };

static fxs_message message;
static uint8_t pixels[PHOTOS][3 * WIDTH * HEIGHT];
static fxs_fit_photo photos[PHOTOS];
static fxs_fit_point points[POINTS];
static fxs_fit_options options;

static float uniform(uint64_t index)
{
    return fxs_random_uniform(fxs_random(17, 4, index));
}

/* Makes photographs of coloured spots, so coarse that the fit splits and clones Gaussians. */
static void make_input(void)
{
    fxs_fit_options_init(&options);
    options.steps = STEPS;
    options.seed = 5;
    for (int i = 0; i < PHOTOS; i++) {
        fxs_view *v = &photos[i].view;
        const double c = i == 1 ? 1 : 0.8, s = i == 0 ? -0.6 : i == 1 ? 0 : 0.6;
        const double rotation[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
        memset(v, 0, sizeof *v);
        snprintf(v->name, sizeof v->name, "%d.png", i);
        v->width = WIDTH;
        v->height = HEIGHT;
        v->fx = v->fy = 36;
        v->cx = WIDTH / 2.0;
        v->cy = HEIGHT / 2.0;
        memcpy(v->rotation, rotation, sizeof rotation);
        v->position[0] = -4 * s;
        v->position[2] = -4 * c;
        photos[i].pixels = pixels[i];
        for (int p = 0; p < 3 * WIDTH * HEIGHT; p++)
            pixels[i][p] = (uint8_t)(((p / 3 % WIDTH / 5 + p / 3 / WIDTH / 4 * 3 + i) * 53 + p % 3 * 90) % 256);
    }
    for (uint64_t i = 0; i < POINTS; i++)
        for (uint64_t k = 0; k < 3; k++) {
            points[i].position[k] = 2 * uniform(6 * i + k) - 1;
            points[i].colour[k] = (uint8_t)(255 * uniform(6 * i + 3 + k));
        }
}

static fxs_fit *begin(void)
{
    fxs_fit *fit;
    if (!CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == 0)) {
        printf("  %s\n", message.text);
        exit(1);
    }
    return fit;
}

static void go_on(fxs_fit *fit, uint32_t steps)
{
    fxs_fit_report report;
    while (fxs_fit_steps(fit) < steps)
        if (!CHECK(fxs_fit_step(fit, &report, &message) == 0))
            exit(1);
}

static int resume(fxs_fit **fit, const char *name)
{
    return fxs_fit_resume(fit, in_folder(name), photos, PHOTOS, &options, &message);
}

static void save(fxs_fit *fit, const char *name)
{
    if (!CHECK(fxs_fit_save(fit, in_folder(name), &message) == 0))
        printf("  %s\n", message.text);
}

static uint8_t *bytes_of(const char *name, size_t *size)
{
    FILE *file = fopen(in_folder(name), "rb");
    uint8_t *bytes = malloc(1 << 24);
    *size = file && bytes ? fread(bytes, 1, 1 << 24, file) : 0;
    if (file)
        fclose(file);
    CHECK(*size > 0);
    return bytes;
}

static int same_files(const char *a, const char *b)
{
    size_t sizes[2];
    uint8_t *bytes[2] = {bytes_of(a, &sizes[0]), bytes_of(b, &sizes[1])};
    const int same = sizes[0] == sizes[1] && !memcmp(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

static void goes_on_in_the_middle_of_a_round(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.batch = 4;
    whole = begin();
    go_on(whole, 10);
    save(whole, "whole-batches");
    fxs_fit_destroy(whole);
    whole = begin();
    go_on(whole, 5);
    save(whole, "half-batches");
    fxs_fit_destroy(whole);
    options = mine;
    if (CHECK(resume(&second, "half-batches") == 0)) {
        CHECK(fxs_fit_options_of(second)->batch == 4);
        go_on(second, 10);
        save(second, "resumed-batches");
        CHECK(same_files("whole-batches", "resumed-batches"));
        fxs_fit_destroy(second);
    }
    options.device_count = 3;
    CHECK(resume(&second, "half-batches") == FXS_ERR_ARGUMENT && strstr(message.text, "shared out"));
    options = mine;
}

static void goes_on_with_exposure(enum fxs_fit_exposure exposure, const char *half)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.exposure = exposure;
    options.batch = 2;
    whole = begin();
    go_on(whole, 20);
    save(whole, half);
    go_on(whole, 40);
    save(whole, "whole-exposures");
    CHECK(whole->gains.of[1].at[0] != 0 && whole->gains.of[1].at[2] != 0);
    CHECK((whole->gains.of[1].at[9] != 0) == (exposure == FXS_FIT_EXPOSURE_AFFINE));
    fxs_fit_destroy(whole);
    options = mine;
    if (CHECK(resume(&second, half) == 0)) {
        CHECK(fxs_fit_options_of(second)->exposure == exposure);
        go_on(second, 40);
        save(second, "resumed-exposures");
        CHECK(same_files("whole-exposures", "resumed-exposures"));
        fxs_fit_destroy(second);
    }
}

static void goes_on_with_exposures(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *second;
    goes_on_with_exposure(FXS_FIT_EXPOSURE_GAIN, "half-exposures");
    goes_on_with_exposure(FXS_FIT_EXPOSURE_AFFINE, "half-affine");
    options.exposure = (enum fxs_fit_exposure)3;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    options.block = options.blocks = 1;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options = mine;
}

/* Checks the initial exposures of a fit. A photograph starts at log2(exposure) / 2.2 minus the mean of this value
   over all photographs. */
static void begins_with_known_exposures(void)
{
    static const uint32_t bits[PHOTOS] = {0xbec887c8, 0x3d80c9a0, 0x3ea85568};
    const fxs_fit_options mine = options;
    for (int kind = 0; kind < 4; kind++) {
        for (int i = 0; i < PHOTOS; i++)
            photos[i].exposure = kind == 3 ? 0.125 : i == 1 && kind == 1 ? 0 : 0.01 * (1 + i);
        options.exposure = kind == 2 ? FXS_FIT_EXPOSURE_NONE : FXS_FIT_EXPOSURE_GAIN;
        fxs_fit *fit = begin();
        for (int i = 0; i < PHOTOS; i++) {
            const fxs_fit_gain *gain = &fit->gains.of[i];
            const double expected = kind ? 0 : (log2(1 + i) - log2(6) / 3) / 2.2;
            uint32_t got;
            memcpy(&got, &gain->at[0], sizeof got);
            CHECK(fabs((double)gain->at[0] - expected) < 1e-6 && gain->at[1] == 0 && gain->at[2] == 0);
            if (!CHECK(kind ? gain->at[0] == 0 : got == bits[i]))
                printf("  0x%08x\n", (unsigned)got);
            CHECK(gain->square == 0 && gain->mean[0] == 0 && gain->of_one[0] == 0);
        }
        fxs_fit_destroy(fit);
    }
    for (int kind = 0; kind < 3; kind++) {
        static const double odd[3] = {1e300, -1, 1e-300};
        photos[1].exposure = kind == 1 ? NAN : odd[kind];
        options.exposure = FXS_FIT_EXPOSURE_GAIN;
        fxs_fit *fit = begin();
        CHECK(fit->gains.of[0].at[0] == 0 && fit->gains.of[1].at[0] == 0);
        fxs_fit_destroy(fit);
    }
    /* colour map of a photograph: diagonal factors exposure^(1 / 2.2), divided by their mean over all photographs */
    for (int i = 0; i < PHOTOS; i++)
        photos[i].exposure = 0.01 * (1 + i);
    options.exposure = FXS_FIT_EXPOSURE_AFFINE;
    fxs_fit *fit = begin();
    for (int i = 0; i < PHOTOS; i++) {
        const double mean = (1 + pow(2, 1 / 2.2) + pow(3, 1 / 2.2)) / 3;
        for (int k = 0; k < FXS_FIT_GAIN; k++) {
            const double expected = k < 9 && k % 4 == 0 ? pow(1 + i, 1 / 2.2) / mean : 0;
            CHECK(fabs((double)fit->gains.of[i].at[k] - expected) < 1e-6);
        }
    }
    fxs_fit_destroy(fit);
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    for (int i = 0; i < PHOTOS; i++)
        photos[i].exposure = i == 1 ? 1e-20 : 1e20;
    fit = begin();
    for (int i = 0; i < PHOTOS; i++)
        CHECK(fabsf(fit->gains.of[i].at[0]) <= 2 * FXS_FIT_GAIN_MOST);
    save(fit, "extreme-exposures");
    fxs_fit_destroy(fit);
    for (int i = 0; i < PHOTOS; i++)
        photos[i].exposure = 0;
    if (CHECK(resume(&fit, "extreme-exposures") == 0)) {
        CHECK(fit->gains.of[0].at[0] > 5 && fit->gains.of[1].at[0] < -10);
        fxs_fit_destroy(fit);
    }
    options = mine;
}

/* With many photographs, changes of exposures have no part in the mean and in the viewing directions' components. The
   cameras here turn about y, so that the component y does not vary. */
static void keeps_the_linear_part(void)
{
    enum { MANY = 40 };
    static fxs_fit_photo many[MANY];
    const fxs_fit_options mine = options;
    for (int i = 0; i < MANY; i++) {
        const double s = 0.95 * sin(i), c = sqrt(1 - s * s), rotation[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
        many[i] = photos[i % PHOTOS];
        memcpy(many[i].view.rotation, rotation, sizeof rotation);
    }
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    fxs_fit *fit;
    if (CHECK(fxs_fit_create(&fit, many, MANY, points, POINTS, &options, &message) == 0)) {
        double lengths = 0;
        go_on(fit, 40);
        for (int j = 0; j < FXS_FIT_BASIS; j++) {
            double products[FXS_FIT_BASIS] = {0}, part = 0;
            for (int i = 0; i < MANY; i++) {
                const fxs_fit_gain *of = &fit->gains.of[i];
                for (int k = 0; k < FXS_FIT_BASIS; k++)
                    products[k] += (double)of->basis[j] * (double)of->basis[k];
                part += (double)of->basis[j] * (double)of->at[0];
                lengths += fabs((double)of->at[0]);
            }
            for (int k = 0; k < FXS_FIT_BASIS; k++)
                CHECK(fabs(products[k] - (j == k && j != 2)) < 1e-6);
            CHECK(fabs(part) < 1e-5);
        }
        CHECK(lengths > 0.01);
        fxs_fit_destroy(fit);
    }
    options = mine;
}

static void goes_on_with_masks(void)
{
    static uint8_t masks[PHOTOS][WIDTH * HEIGHT], all[WIDTH * HEIGHT];
    fxs_fit *whole, *second;
    memset(all, 1, sizeof all);
    whole = begin();
    save(whole, "no-masks");
    fxs_fit_destroy(whole);
    for (int i = 0; i < PHOTOS; i++) {
        for (int p = 0; p < WIDTH * HEIGHT; p++)
            masks[i][p] = p % WIDTH / 9 % 3 != i;
        photos[i].mask = i == 1 ? NULL : masks[i];
    }
    CHECK(resume(&second, "no-masks") == FXS_ERR_FILE && strstr(message.text, "other photographs"));
    whole = begin();
    go_on(whole, 10);
    save(whole, "half-masks");
    go_on(whole, 20);
    save(whole, "whole-masks");
    fxs_fit_destroy(whole);
    if (CHECK(resume(&second, "half-masks") == 0)) {
        go_on(second, 20);
        save(second, "resumed-masks");
        CHECK(same_files("whole-masks", "resumed-masks"));
        fxs_fit_destroy(second);
    }
    masks[2][77] ^= 1;
    CHECK(resume(&second, "half-masks") == FXS_ERR_FILE && strstr(message.text, "other photographs"));
    masks[2][77] ^= 1;
    for (int i = 0; i < PHOTOS; i++)
        photos[i].mask = all;
    CHECK(resume(&second, "half-masks") == FXS_ERR_FILE && strstr(message.text, "other photographs"));
    if (CHECK(resume(&second, "no-masks") == 0))
        fxs_fit_destroy(second);
    for (int i = 0; i < PHOTOS; i++)
        photos[i].mask = NULL;
}

/* Fits a block (a part of a large scene) that starts from a coarse fit of the whole scene. The block keeps the
   exposures, camera poses and antialiasing of the coarse fit. */
static void a_block_keeps(const char *name, uint32_t steps)
{
    const fxs_fit_options mine = options;
    fxs_fit_photo some[2] = {photos[2], photos[0]};
    uint32_t gaussians[POINTS];
    const uint32_t numbers[2] = {2, 0};
    fxs_fit *whole, *fit;
    fxs_fit_coarse *coarse;
    for (uint32_t i = 0; i < POINTS; i++)
        gaussians[i] = i;
    if (!CHECK(resume(&whole, name) == 0) || !CHECK(fxs_fit_coarse_read(&coarse, in_folder(name), &message) == 0))
        return;
    const fxs_fit_block block = {.number = 1, .blocks = 2, .photos = {.fit = some, .fit_count = 2}, .coarse = coarse,
                                 .gaussians = gaussians, .gaussian_count = POINTS};
    options.block = 1, options.blocks = 2;
    if (CHECK(fxs_fit_create_block(&fit, coarse, &block, &options, &message) == 0)) {
        const fxs_fit_options *o = fxs_fit_options_of(fit), *of_whole = fxs_fit_options_of(whole);
        CHECK(o->exposure == of_whole->exposure && o->refine_poses == of_whole->refine_poses &&
              o->antialiased == of_whole->antialiased && o->surfaces == of_whole->surfaces);
        CHECK(o->sky == of_whole->sky && !memcmp(&fit->far, &whole->far, sizeof fit->far));
        go_on(fit, steps);
        for (int i = 0; i < 2; i++) {
            CHECK(!memcmp(&fit->gains.of[i], &whole->gains.of[numbers[i]], sizeof *fit->gains.of));
            CHECK(!memcmp(&fit->poses.of[i], &whole->poses.of[numbers[i]], sizeof *fit->poses.of));
        }
        CHECK(!o->exposure || memcmp(&fit->gains.of[0], &fit->gains.of[1], sizeof *fit->gains.of));
        CHECK(!o->refine_poses || memcmp(&fit->poses.of[0], &fit->poses.of[1], sizeof *fit->poses.of));
        save(fit, "block");
        fxs_fit_destroy(fit);
        if (CHECK(fxs_fit_resume(&fit, in_folder("block"), some, 2, &options, &message) == 0))
            fxs_fit_destroy(fit);
    }
    options = mine;
    fxs_fit_coarse_free(coarse);
    fxs_fit_destroy(whole);
}

static void goes_on_with_poses(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.refine_poses = 1;
    whole = begin();
    go_on(whole, 480);
    CHECK(whole->poses.of[1].depth > 3 && whole->poses.of[1].depth < 5);
    save(whole, "early-poses");
    go_on(whole, 520);
    save(whole, "half-poses");
    go_on(whole, 540);
    save(whole, "whole-poses");
    for (int k = 0; k < FXS_FIT_POSE; k++)
        CHECK(whole->poses.of[2].at[k] != 0);
    fxs_fit_destroy(whole);
    options = mine;
    for (int i = 0; i < 2; i++)
        if (CHECK(resume(&second, i ? "half-poses" : "early-poses") == 0)) {
            CHECK(fxs_fit_options_of(second)->refine_poses == 1 && !fxs_fit_options_of(second)->exposure);
            go_on(second, 540);
            save(second, "resumed-poses");
            CHECK(same_files("whole-poses", "resumed-poses"));
            fxs_fit_destroy(second);
        }
    options.refine_poses = 1;
    options.exposure = FXS_FIT_EXPOSURE_GAIN;
    whole = begin();
    go_on(whole, 5);
    save(whole, "both");
    fxs_fit_destroy(whole);
    options = mine;
    if (CHECK(resume(&second, "both") == 0)) {
        CHECK(fxs_fit_options_of(second)->refine_poses == 1 && fxs_fit_options_of(second)->exposure == 1);
        fxs_fit_destroy(second);
    }
    options.refine_poses = 2;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options.refine_poses = 1;
    options.block = options.blocks = 1;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options = mine;
}

static void goes_on_antialiased(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.antialiased = 1;
    whole = begin();
    go_on(whole, 15);
    save(whole, "half-antialiased");
    go_on(whole, STEPS);
    save(whole, "whole-antialiased");
    CHECK(whole->model.cameras && whole->model.cameras->count == PHOTOS);
    fxs_fit_destroy(whole);
    options = mine;
    if (CHECK(resume(&second, "half-antialiased") == 0)) {
        CHECK(fxs_fit_options_of(second)->antialiased == 1 && !fxs_fit_options_of(second)->exposure);
        go_on(second, STEPS);
        save(second, "resumed-antialiased");
        CHECK(same_files("whole-antialiased", "resumed-antialiased"));
        fxs_fit_destroy(second);
    }
    whole = begin();
    CHECK(!whole->model.cameras);
    go_on(whole, STEPS);
    save(whole, "aliased");
    CHECK(!same_files("whole-antialiased", "aliased"));
    fxs_fit_destroy(whole);
    options.antialiased = 2;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options = mine;
}

static void goes_on_with_surfaces(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.surfaces = 1;
    whole = begin();
    go_on(whole, 15);
    save(whole, "half-surfaces");
    go_on(whole, STEPS);
    save(whole, "whole-surfaces");
    fxs_fit_destroy(whole);
    options = mine;
    if (CHECK(resume(&second, "half-surfaces") == 0)) {
        CHECK(fxs_fit_options_of(second)->surfaces == 1 && !fxs_fit_options_of(second)->antialiased);
        go_on(second, STEPS);
        save(second, "resumed-surfaces");
        CHECK(same_files("whole-surfaces", "resumed-surfaces"));
        fxs_fit_destroy(second);
    }
    whole = begin();
    go_on(whole, STEPS);
    save(whole, "no-surfaces");
    CHECK(!same_files("whole-surfaces", "no-surfaces"));
    fxs_fit_destroy(whole);
    options.surfaces = 2;
    CHECK(fxs_fit_create(&second, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT);
    options = mine;
}

static void goes_on_with_a_sky(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *whole, *second;
    options.recipe = FXS_FIT_MCMC;
    options.sky = 300;
    options.steps = 60;
    whole = begin();
    CHECK(fxs_fit_sky_count(whole) > 10);
    go_on(whole, 20);
    save(whole, "half-sky");
    go_on(whole, 40);
    save(whole, "whole-sky");
    options.sky = 0;
    if (CHECK(resume(&second, "half-sky") == 0)) {
        CHECK(fxs_fit_options_of(second)->sky == 300 && !fxs_fit_sky_count(second));
        CHECK(second->far.inverse > 0 && !memcmp(&second->far, &whole->far, sizeof whole->far));
        go_on(second, 40);
        save(second, "resumed-sky");
        CHECK(same_files("whole-sky", "resumed-sky"));
        fxs_fit_destroy(second);
    }
    fxs_fit_destroy(whole);
    options = mine;
    options.recipe = FXS_FIT_MCMC;
    options.steps = 60;
    a_block_keeps("half-sky", 22);
    options = mine;
}

static void a_block_keeps_exposures_and_poses(void)
{
    a_block_keeps("half-antialiased", 26);
    a_block_keeps("half-surfaces", 26);
    a_block_keeps("half-exposures", 26);
    a_block_keeps("half-affine", 26);
    a_block_keeps("half-poses", 526);
}

static void goes_on_as_if_never_stopped(void)
{
    fxs_fit *whole = begin(), *first = begin(), *second;
    go_on(whole, STEPS);
    save(whole, "whole");
    go_on(first, SAVED_AT);
    save(first, "half");
    fxs_fit_destroy(first);
    if (CHECK(resume(&second, "half") == 0)) {
        CHECK(fxs_fit_steps(second) == SAVED_AT);
        save(second, "again");
        CHECK(same_files("half", "again"));
        go_on(second, STEPS);
        save(second, "resumed");
        CHECK(same_files("whole", "resumed"));
        fxs_packed_scene packed[2];
        if (CHECK(!fxs_fit_pack(whole, &packed[0], 0, &message) && !fxs_fit_pack(second, &packed[1], 0, &message))) {
            CHECK(packed[0].bytes == packed[1].bytes && !memcmp(packed[0].data, packed[1].data, packed[0].bytes));
            fxs_packed_scene_free(&packed[0]);
            fxs_packed_scene_free(&packed[1]);
        }
        fxs_fit_destroy(second);
    }
    fxs_gaussian_source gaussians;
    fxs_fit_gaussians(whole, &gaussians, &message);
    CHECK(gaussians.count != POINTS);
    fxs_fit_destroy(whole);
}

/* Resumes a fit in the last tenth of its steps, in which the scales of Gaussians are quantised as in the packed
   file. */
static void goes_on_in_the_last_tenth(void)
{
    const fxs_fit_options mine = options;
    options.profile = FXS_PROFILE_SMALL;
    fxs_fit *whole = begin(), *again;
    go_on(whole, LATE);
    save(whole, "late");
    go_on(whole, STEPS);
    save(whole, "end");
    fxs_fit_destroy(whole);
    if (CHECK(resume(&again, "late") == 0)) {
        go_on(again, STEPS);
        save(again, "resumed");
        CHECK(same_files("end", "resumed"));
        fxs_fit_destroy(again);
    }
    options.steps = 2 * STEPS;
    if (CHECK(resume(&again, "late") == 0)) {
        go_on(again, LATE + 2);
        fxs_fit_destroy(again);
    }
    options = mine;
}

static void the_file_does_not_depend_on_threads(void)
{
    fxs_pool *pool = fxs_pool_create(3);
    const fxs_fit_options one = options;
    options.workers.run = fxs_pool_run;
    options.workers.pool = pool;
    options.workers.count = 3;
    fxs_fit *fit;
    if (CHECK(resume(&fit, "half") == 0)) {
        go_on(fit, STEPS);
        save(fit, "threads");
        CHECK(same_files("whole", "threads"));
        fxs_fit_destroy(fit);
    }
    options = one;
    fxs_pool_destroy(pool);
}

static void its_options_are_those_of_the_file(void)
{
    const fxs_fit_options mine = options;
    fxs_fit *fit;
    options.seed = 99;
    options.sh_degree = 1;
    options.max_gaussians = 7;
    options.background[1] = 4;
    options.steps = 0;
    if (CHECK(resume(&fit, "half") == 0)) {
        const fxs_fit_options *o = fxs_fit_options_of(fit);
        CHECK(o->seed == 5 && o->sh_degree == 3 && o->max_gaussians == mine.max_gaussians && !o->background[1]);
        CHECK(o->steps == STEPS);
        fxs_fit_destroy(fit);
    }
    options.steps = 9000;
    if (CHECK(resume(&fit, "half") == 0)) {
        CHECK(fxs_fit_options_of(fit)->steps == 9000);
        fxs_fit_destroy(fit);
    }
    options = mine;
}

static void names_of_photographs_do_not_matter(void)
{
    fxs_fit *fit;
    strcpy(photos[1].view.name, "other.jpg");
    if (CHECK(resume(&fit, "half") == 0))
        fxs_fit_destroy(fit);
}

static int refused(const char *name, int error, const char *why)
{
    fxs_fit *fit = (fxs_fit *)&fit;
    message.text[0] = 0;
    const int got = resume(&fit, name);
    if (got == error && !fit && strstr(message.text, why) && !strchr(message.text, '\n'))
        return 1;
    printf("  %d: %s\n", got, message.text);
    if (!got)
        fxs_fit_destroy(fit);
    return 0;
}

static void other_photographs_are_refused(void)
{
    const char why[] = "other photographs";
    const fxs_fit_photo first = photos[0];
    fxs_fit *fit;
    pixels[2][3 * WIDTH * HEIGHT - 1] ^= 1;
    CHECK(refused("half", FXS_ERR_FILE, why));
    pixels[2][3 * WIDTH * HEIGHT - 1] ^= 1;
    photos[0].view.cx += 0.01;
    CHECK(refused("half", FXS_ERR_FILE, why));
    photos[0] = photos[1];
    photos[1] = first;
    CHECK(refused("half", FXS_ERR_FILE, why));
    photos[1] = photos[0];
    photos[0] = first;
    CHECK(fxs_fit_resume(&fit, in_folder("half"), photos, PHOTOS - 1, &options, &message) == FXS_ERR_FILE && !fit);
    CHECK(strstr(message.text, why) != NULL);
}

static void put_u32(uint8_t *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> 8 * i);
}

static uint32_t get_u32(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void seal(uint8_t *bytes, size_t size)
{
    uint64_t sum = 0;
    for (size_t i = 0; i + 8 < size; i += 4)
        sum = fxs_random_mix(sum ^ get_u32(bytes + i));
    put_u32(bytes + size - 8, (uint32_t)sum);
    put_u32(bytes + size - 4, (uint32_t)(sum >> 32));
}

enum { HEAD = 2, RECIPE = HEAD, DEGREE = HEAD + 2, MOST, BATCH = HEAD + 6, PROFILE = HEAD + 11, PRINT,
      CAMERAS = PRINT + 2,
       STEP = CAMERAS + 2 + 2 * PHOTOS, EXTENT, COUNT, FIRST = COUNT + 2 };

/* Writes a copy of a checkpoint with a changed 32-bit word and a correct checksum. A negative index counts from the
   end of the file. */
static void change(const char *name, int word, uint32_t value)
{
    size_t size;
    uint8_t *bytes = bytes_of(name, &size);
    put_u32(bytes + 4 * word + (word < 0 ? size : 0), value);
    seal(bytes, size);
    put_file("changed", bytes, size);
    free(bytes);
}

static int refused_with(int word, uint32_t value, const char *why)
{
    change("half", word, value);
    return refused("changed", FXS_ERR_FILE, why);
}

static void the_places_of_words_are_known(void)
{
    size_t size;
    uint8_t *bytes = bytes_of("half", &size), *sealed = malloc(size);
    CHECK(get_u32(bytes + 4 * DEGREE) == 3 && get_u32(bytes + 4 * STEP) == SAVED_AT);
    CHECK(size == 4 * (FIRST + (size_t)get_u32(bytes + 4 * COUNT) * (3 * 59 + 2) + 4));
    memcpy(sealed, bytes, size);
    memset(sealed + size - 8, 0, 8);
    seal(sealed, size);
    CHECK(!memcmp(bytes, sealed, size));
    free(sealed);
    free(bytes);
}

static void faulty_numbers_are_refused(void)
{
    const uint32_t infinity = 0x7f800000, nan = 0x7fc00001;
    const char finite[] = "damaged: a number that is not finite";
    size_t size;
    uint8_t *bytes = bytes_of("half", &size);
    const int count = (int)get_u32(bytes + 4 * COUNT);
    free(bytes);
    CHECK(refused_with(FIRST, nan, finite));
    CHECK(refused_with(FIRST + 2000, infinity, finite));
    CHECK(refused_with(FIRST + 12000, infinity | 1u << 31, finite));
    CHECK(refused_with(EXTENT, nan, finite));
    CHECK(refused_with(RECIPE, 3, "damaged: a number out"));
    CHECK(refused_with(MOST, 0, "damaged: a number out"));
    CHECK(refused_with(DEGREE, 4, "damaged: a number out"));
    CHECK(refused_with(BATCH, 0, "damaged: a number out") && refused_with(BATCH, 9, "damaged: a number out"));
    CHECK(refused_with(PROFILE, 77, "damaged: a number out"));
    const uint32_t large = 0x42a20000;           /* 81.0 as the bits of a float, a value that is out of range */
    CHECK(refused_with(FIRST, 0x7e967699, "damaged: a number out"));
    CHECK(refused_with(FIRST + FXS_FIT_SCALE * count, large, "damaged: a number out"));
    CHECK(refused_with(FIRST + FXS_FIT_OPACITY * count, large | 1u << 31, "damaged: a number out"));
    CHECK(refused_with(CAMERAS, 0x7fffffff, "damaged: it ends early"));
    CHECK(refused_with(COUNT, 0x7fffffff, "damaged: it ends early"));
    CHECK(refused_with(COUNT + 1, 0xffffffff, "damaged: it ends early"));
    CHECK(refused_with(COUNT, 1, "damaged: "));
    CHECK(refused_with(PRINT, 1, "other photographs"));
    CHECK(refused_with(0, 1, "not a saved fit"));
}

static void faulty_exposures_are_refused(void)
{
    enum { WORDS = sizeof(fxs_fit_gain) / 4, END = -3, AT = END - WORDS * PHOTOS };
    const uint32_t beyond = 0x41880000, nan = 0x7fc00001, faulty[] = {0x7f7fffff, 0xff7fffff, 0x80000001, 0};
    fxs_fit *fit;
    change("half-exposures", AT + WORDS, beyond);
    CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
    change("half-exposures", AT + WORDS + 2, beyond | 1u << 31);
    CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
    change("half-exposures", END - 1, nan);
    CHECK(refused("changed", FXS_ERR_FILE, "not finite"));
    /* claims the version number of checkpoints with exposures for a checkpoint without exposures */
    change("half", 1, 63);
    CHECK(refused("changed", FXS_ERR_FILE, "damaged: "));
    change("half", 1, 4);
    CHECK(refused("changed", FXS_ERR_VERSION, "another version"));
    change("half", 1, 68);
    CHECK(refused("changed", FXS_ERR_FILE, "other photographs"));
    change("half", 1, 158);
    CHECK(refused("changed", FXS_ERR_VERSION, "another version"));
    change("half-exposures", AT + 2 * WORDS - FXS_FIT_BASIS, 0x3f800001);
    CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
    change("half-affine", AT + WORDS + 11, beyond);
    CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
    /* writes faulty Adam moments; a mean may be any number, a mean square must be >= 0 */
    for (int i = 0; i < 6 * 4; i++) {
        const uint32_t value = faulty[i % 4];
        const int word = i < 3 * 4 ? FXS_FIT_GAIN + i / 4 : WORDS - FXS_FIT_BASIS + i / 4 - 6;
        change("half-exposures", AT + word, value);
        if (i >= 3 * 4 && (value >> 31 || (i >= 4 * 4 && value))) {
            CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
            continue;
        }
        if (!CHECK(resume(&fit, "changed") == 0))
            continue;
        go_on(fit, 26);
        for (int k = 0; k < 3; k++)
            CHECK(fabsf(fit->gains.of[0].at[k]) <= 2 * FXS_FIT_GAIN_MOST);
        fxs_fit_destroy(fit);
    }
}

static void faulty_poses_are_refused(void)
{
    enum { WORDS = sizeof(fxs_fit_pose) / 4, END = -3, AT = END - WORDS * PHOTOS };
    static const struct {
        int word;
        /* beyond: float word just out of range, which is refused; most: last word in range, which is accepted */
        uint32_t beyond, most;
    } numbers[] = {{0, 0xbf000001, 0xbf000000}, {2, 0x3f000001, 0x3f000000}, {3, 0x5368d4a6, 0x5368d4a5},
                   {5, 0xd368d4a6, 0xd368d4a5}, {12, 0x80000001, 0x7f7fffff}, {13, 0x80000001, 0x7f7fffff},
                   {14, 0x3f800001, 0x3f800000}, {15, 0xbf800000, 0}, {16, 0xbf800000, 0},
                   {16, 0x5368d4a6, 0x5368d4a5}};
    fxs_fit *fit;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        change("half-poses", AT + numbers[i].word, numbers[i].beyond);
        CHECK(refused("changed", FXS_ERR_FILE, "a number out of its range"));
        change("half-poses", AT + numbers[i].word, numbers[i].most);
        if (!CHECK(resume(&fit, "changed") == 0))
            continue;
        go_on(fit, 526);
        for (int k = 0; k < FXS_FIT_POSE; k++)
            CHECK(fabsf(fit->poses.of[0].at[k]) <= (k < 3 ? FXS_FIT_TURN_MOST : FXS_FIT_FARTHEST_PLACE));
        fxs_fit_destroy(fit);
    }
    change("half-poses", AT + 6, 0x7fc00001);
    CHECK(refused("changed", FXS_ERR_FILE, "not finite"));
    /* claims the version number of checkpoints with camera poses for a checkpoint without poses */
    change("half", 1, 65);
    CHECK(refused("changed", FXS_ERR_FILE, "damaged: "));
}

static void faulty_skies_are_refused(void)
{
    enum { SKY = PRINT, FAR = EXTENT + 2 };
    static const struct {
        int word;
        uint32_t value;
        const char *why;
    } numbers[] = {{SKY, 0, "out of its range"}, {SKY, FXS_FIT_SKY_MOST + 1, "out of its range"},
                   {FAR, 0x5368d4a6, "out of its range"}, {FAR + 2, 0xd368d4a6, "out of its range"},
                   {FAR + 1, 0x7fc00001, "not finite"}, {FAR + 3, 0xbf800000, "out of its range"},
                   {FAR + 3, 0x60ad78ed, "out of its range"}};
    fxs_fit *fit;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        change("half-sky", numbers[i].word, numbers[i].value);
        CHECK(refused("changed", FXS_ERR_FILE, numbers[i].why));
    }
    change("half-sky", FAR + 3, 0x60ad78ec);    /* 1e20 as the bits of a float */
    if (CHECK(resume(&fit, "changed") == 0)) {
        go_on(fit, 24);
        fxs_fit_destroy(fit);
    }
    change("half", 1, 74);   /* claims the version number of checkpoints with a sky for a checkpoint without sky */
    CHECK(refused("changed", FXS_ERR_FILE, "damaged: "));
}

static void a_changed_byte_is_seen(void)
{
    size_t size;
    uint8_t *bytes = bytes_of("half", &size);
    for (size_t i = 0; i < size; i += i < 4 * FIRST || i + 80 > size ? 1 : 173) {
        bytes[i] ^= 0xc1;              /* 0xc1 turns no byte of the version number into another valid version */
        put_file("changed", bytes, size);
        const int is_version = i >= 4 && i < 8;
        if (!CHECK(refused("changed", is_version ? FXS_ERR_VERSION : FXS_ERR_FILE, is_version ? "another" : "")))
            printf("  byte %zu\n", i);
        bytes[i] ^= 0xc1;
    }
    free(bytes);
}

static void more_is_refused(void)
{
    size_t size;
    uint8_t *bytes = bytes_of("half", &size);
    bytes[size] = 0;
    put_file("changed", bytes, size + 1);
    CHECK(refused("changed", FXS_ERR_FILE, "there is more behind its end"));
    free(bytes);
}

static int is_finite(const fxs_fit *fit)
{
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        for (size_t i = 0; i < fit->model.count; i++)
            if (!isfinite(fit->model.parameters[k * fit->model.stride + i]))
                return 0;
    return 1;
}

static void any_finite_numbers_are_lived_with(void)
{
    size_t size;
    uint8_t *bytes = bytes_of("half", &size), *changed = malloc(size);
    const size_t moments = FIRST + FXS_FIT_PARAMETERS * (size_t)get_u32(bytes + 4 * COUNT);
    for (uint64_t turn = 0; turn < 40; turn++) {
        memcpy(changed, bytes, size);
        for (uint64_t i = 0; i < 600; i++) {
            const uint64_t random = fxs_random(1, turn, i);
            const size_t word = FIRST + (size_t)(random % ((size - 16) / 4 - FIRST));
            const uint32_t value = (uint32_t)(random >> 32) & (turn % 2 && word >= moments ? 0xff7fffff : 0xc17fffff);
            put_u32(changed + 4 * word, turn % 4 == 3 && i % 8 == 0 ? 0 : value);
        }
        seal(changed, size);
        put_file("changed", changed, size);
        fxs_fit *fit;
        fxs_fit_report report;
        options.cpu = turn % 4 < 2 ? ~0u : 0;
        const int error = resume(&fit, "changed");
        options.cpu = ~0u;
        if (error) {
            CHECK(strstr(message.text, "not finite") != NULL);
            continue;
        }
        for (int step = 0; step < 3; step++)
            CHECK(fxs_fit_step(fit, &report, &message) == 0);
        CHECK(is_finite(fit));
        fxs_packed_scene packed;
        fxs_scene scene;
        if (!fxs_fit_pack(fit, &packed, 0, &message)) {
            CHECK(fxs_scene_open(&scene, packed.data, packed.bytes) == 0);
            fxs_packed_scene_free(&packed);
        }
        fxs_fit_destroy(fit);
    }
    free(changed);
    free(bytes);
}

static void what_is_no_file_is_refused(void)
{
    CHECK(refused("nowhere", FXS_ERR_FILE, "No such file"));
    CHECK(refused(".", FXS_ERR_FILE, "not a regular file"));
    put_file("empty", "", 0);
    CHECK(refused("empty", FXS_ERR_FILE, "not a saved fit"));
}

static void what_is_not_finite_is_not_saved(void)
{
    fxs_fit *fit;
    size_t before, after;
    uint8_t *bytes = bytes_of("half", &before);
    put_file("kept", bytes, before);
    if (CHECK(resume(&fit, "kept") == 0)) {
        fit->model.squares[0] = INFINITY;
        CHECK(fxs_fit_save(fit, in_folder("kept"), &message) == FXS_ERR_FILE);
        fxs_fit_destroy(fit);
    }
    free(bytes);
    free(bytes_of("kept", &after));
    CHECK(before == after && same_files("half", "kept"));
}

static void a_full_disk_is_told(void)
{
    fxs_fit *fit;
    if (access("/dev/full", W_OK))
        SKIP("no /dev/full");
    if (!CHECK(resume(&fit, "half") == 0))
        return;
    CHECK(fxs_fit_save(fit, "/dev/full", &message) == FXS_ERR_FILE && strstr(message.text, "No space"));
    CHECK(fxs_fit_save(fit, in_folder("no/folder"), &message) == FXS_ERR_FILE);
    fxs_fit_destroy(fit);
}

static void options_are_checked(void)
{
    static const struct {
        size_t offset;
        int value;
        const char *why;
    } faults[] = {{offsetof(fxs_fit_options, recipe), 3, "recipe"}, {offsetof(fxs_fit_options, steps), 0, "steps"},
                  {offsetof(fxs_fit_options, sh_degree), -1, "SH degree"},
                  {offsetof(fxs_fit_options, cutoff), 2, "cut-off"}, {offsetof(fxs_fit_options, profile), 3, "profile"},
                  {offsetof(fxs_fit_options, workers.count), 65, "threads"}};
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        fxs_fit_options wrong = options;
        fxs_fit *fit;
        memcpy((char *)&wrong + faults[i].offset, &faults[i].value, sizeof faults[i].value);
        CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &wrong, &message) == FXS_ERR_ARGUMENT && !fit);
        if (!CHECK(strstr(message.text, faults[i].why) != NULL))
            printf("  %s\n", message.text);
    }
}

static void input_is_checked(void)
{
    fxs_fit *fit;
    CHECK(fxs_fit_create(&fit, photos, 0, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT && !fit);
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, 0, &options, &message) == FXS_ERR_ARGUMENT && !fit);
    points[4].position[1] = NAN;
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT && !fit);
    points[4].position[1] = 0;
    photos[2].view.fx = INFINITY;
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT && !fit);
    photos[2].view.fx = 36;
    photos[2].view.projection = FXS_ORTHOGRAPHIC;
    CHECK(fxs_fit_create(&fit, photos, PHOTOS, points, POINTS, &options, &message) == FXS_ERR_ARGUMENT && !fit);
}

static void tests(void)
{
    make_input();
    RUN(goes_on_as_if_never_stopped);
    RUN(goes_on_in_the_last_tenth);
    RUN(goes_on_in_the_middle_of_a_round);
    RUN(goes_on_with_exposures);
    RUN(begins_with_known_exposures);
    RUN(keeps_the_linear_part);
    RUN(goes_on_with_masks);
    RUN(goes_on_with_poses);
    RUN(goes_on_antialiased);
    RUN(goes_on_with_surfaces);
    RUN(a_block_keeps_exposures_and_poses);
    RUN(goes_on_with_a_sky);
    RUN(the_file_does_not_depend_on_threads);
    RUN(its_options_are_those_of_the_file);
    RUN(names_of_photographs_do_not_matter);
    RUN(other_photographs_are_refused);
    RUN(the_places_of_words_are_known);
    RUN(faulty_numbers_are_refused);
    RUN(faulty_exposures_are_refused);
    RUN(faulty_poses_are_refused);
    RUN(faulty_skies_are_refused);
    RUN(a_changed_byte_is_seen);
    RUN(more_is_refused);
    RUN(any_finite_numbers_are_lived_with);
    RUN(what_is_no_file_is_refused);
    RUN(what_is_not_finite_is_not_saved);
    RUN(a_full_disk_is_told);
    RUN(options_are_checked);
    RUN(input_is_checked);
}

int main(void)
{
    return in_a_folder(tests);
}
