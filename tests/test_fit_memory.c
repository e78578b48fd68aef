/* Fails memory allocations of a fit. The fit must return an error without a leak. Also tests the total memory of a
   fit. */
#include "src/fit/fit_internal.h"
#include "fit_scene.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTING 1
#include <malloc.h>
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

static int calls, held, fails_at, fails_ever;
static size_t bytes, most_bytes;

static int fails(void)
{
    calls++;
    const int fail = fails_at && (calls == fails_at || (fails_ever && calls > fails_at));
    held += !fail;
    return fail;
}

static void *counted(void *memory)
{
    bytes += malloc_usable_size(memory);
    most_bytes = bytes > most_bytes ? bytes : most_bytes;
    return memory;
}

void *malloc(size_t size)
{
    return fails() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t n, size_t size)
{
    return fails() ? NULL : counted(__libc_calloc(n, size));
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    if (fails())
        return 12;
    *out = counted(__libc_memalign(alignment, size));
    return *out ? 0 : 12;
}

void free(void *memory)
{
    held -= memory != NULL;
    bytes -= malloc_usable_size(memory);
    __libc_free(memory);
}

/* POINTS is small because glibc's qsort allocates memory for arrays from 1,024 bytes on. */
enum { SIDE = 20, POINTS = 30, STEPS = 20, MANY = 4000 };

static int begin(fxs_fit **f, const fxs_fit_options *options, int count)
{
    static uint8_t pixels[3 * SIDE * SIDE];
    static fxs_fit_point points[MANY];
    const fxs_fit_photo photo = {.view = {.width = SIDE, .height = SIDE, .fx = 20, .fy = 20, .cx = 10, .cy = 10,
                                          .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}, .pixels = pixels};
    fxs_message message;
    fit_state = 1;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            points[i].position[k] = (float)fit_uniform(-1, 1) + (k == 2 ? 4.0f : 0.0f);
    return fxs_fit_create(f, &photo, 1, points, (size_t)count, options, &message);
}

static int change_model(fxs_fit_model *m)
{
    const fxs_fit_densify densify = {0, 0.3f, 100, 0.005f, 3 * POINTS, {{0}, 0}};
    const fxs_fit_relocate relocate = {0.005f, 4 * POINTS, 1, 700};
    int error = fxs_fit_model_densify(m, &densify);
    error = error ? error : fxs_fit_model_relocate(m, &relocate);
    return error ? error : fxs_fit_model_order(m);
}

static int fit_some(enum fxs_fit_recipe recipe)
{
    fxs_fit_options options;
    fxs_fit *f;
    fxs_fit_options_init(&options);
    options.recipe = recipe;
    options.steps = STEPS;
    options.profile = (enum fxs_profile)recipe;
    options.sky = recipe == FXS_FIT_MCMC ? 40 : 0;
    int error = begin(&f, &options, POINTS);
    for (int i = 0; i < STEPS && !error; i++) {
        fxs_fit_report report;
        fxs_message message;
        error = fxs_fit_step(f, &report, &message);
        if (!error && i == 2)
            error = change_model(&f->model);
    }
    fxs_packed_scene scene;
    fxs_message message;
    if (!error && !(error = fxs_fit_pack(f, &scene, NULL, &message)))
        fxs_packed_scene_free(&scene);
    fxs_fit_destroy(f);
    return error;
}
#endif

static void test_no_memory(void)
{
#ifdef COUNTING
    for (int recipe = FXS_FIT_REFERENCE; recipe <= FXS_FIT_FAST; recipe++) {
        fails_at = calls = 0;
        CHECK(fit_some((enum fxs_fit_recipe)recipe) == 0);
        const int all_calls = calls, held_before = held;
        CHECK(all_calls > 10);
        for (int i = 0; i < 2 * all_calls; i++) {
            calls = 0;
            fails_ever = i & 1;
            fails_at = 1 + i / 2;
            const int error = fit_some((enum fxs_fit_recipe)recipe);
            fails_at = 0;
            if (!CHECK(error == FXS_ERR_MEMORY && held == held_before))
                printf("  allocation %d of %d: %d, %d held\n", 1 + i / 2, all_calls, error, held - held_before);
        }
        CHECK(fit_some((enum fxs_fit_recipe)recipe) == 0 && held == held_before);
    }
#else
    SKIP("malloc cannot be counted here");
#endif
}

/* The memory of a fit must be at most twice the size of its parameters, gradients and Adam moments. */
static void test_amount(void)
{
#ifdef COUNTING
    enum { ALL = 2900, MOST = MANY + 2000, FULL = 1600 };
    fxs_fit_options options;
    fxs_fit_report report = {0};
    fxs_fit *f;
    size_t when_full = 0;
    fxs_fit_options_init(&options);
    options.recipe = FXS_FIT_MCMC;
    options.steps = ALL;
    options.max_gaussians = MOST;
    options.profile = FXS_PROFILE_SMALL;
    const size_t of_others = bytes;
    most_bytes = bytes;
    CHECK(begin(&f, &options, MANY) == 0);
    for (int i = 1; i <= ALL; i++) {
        CHECK(fxs_fit_step(f, &report, NULL) == 0);
        if (i == FULL) {
            CHECK(report.gaussians == MOST);
            when_full = bytes;
        }
        CHECK(i != FULL + 1000 || bytes <= when_full + when_full / 100);
    }
    const double most = (double)(most_bytes - of_others) / (16.0 * FXS_FIT_PARAMETERS * MOST);
    if (!CHECK(most <= 2))
        printf("  %.2f times parameters, gradients and moments\n", most);
    fxs_fit_destroy(f);
#else
    SKIP("malloc cannot be counted here");
#endif
}

int main(void)
{
    RUN(test_no_memory);
    RUN(test_amount);
    return check_report();
}
