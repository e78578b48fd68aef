/* A fit in which one allocation, or each from there on, gets no memory: an error, nothing kept, and a right fit
 * after. */
#include "../port/fit/fit_internal.h"
#include "fit_scene.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTING 1
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

static int calls, held, fails_at, fails_ever;

static int fails(void)
{
    calls++;
    const int fail = fails_at && (calls == fails_at || (fails_ever && calls > fails_at));
    held += !fail;
    return fail;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    return fails() ? NULL : __libc_calloc(n, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    if (fails())
        return 12;
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : 12;
}

void free(void *memory)
{
    held -= memory != NULL;
    __libc_free(memory);
}

enum { SIDE = 20, POINTS = 40, STEPS = 20 };

/* What the recipes do to a model now and then. */
static int change_model(fxs_fit_model *m)
{
    const fxs_fit_densify densify = {0, 0.3f, 100, 0.005f, 3 * POINTS, 1, 600};
    const fxs_fit_relocate relocate = {0.005f, 4 * POINTS, 1, 700};
    int error = fxs_fit_model_densify(m, &densify);
    error = error ? error : fxs_fit_model_relocate(m, &relocate);
    return error ? error : fxs_fit_model_order(m);
}

/* A fit to its end, by way of the packed profile. Returns the first error. */
static int fit_some(enum fxs_fit_recipe recipe)
{
    static uint8_t pixels[3 * SIDE * SIDE];
    fxs_fit_photo photo = {.view = {.width = SIDE, .height = SIDE, .fx = 20, .fy = 20, .cx = 10, .cy = 10,
                                    .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}, .pixels = pixels};
    fxs_fit_point points[POINTS] = {{{0, 0, 0}, {0, 0, 0}}};
    fxs_fit_options options;
    fxs_message message;
    fxs_fit *f;
    fit_state = 1;
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++)
            points[i].position[k] = (float)fit_uniform(-1, 1) + (k == 2 ? 4.0f : 0.0f);
    fxs_fit_options_init(&options);
    options.recipe = recipe;
    options.steps = STEPS;
    options.profile = (enum fxs_profile)recipe;
    int error = fxs_fit_create(&f, &photo, 1, points, POINTS, &options, &message);
    for (int i = 0; i < STEPS && !error; i++) {
        fxs_fit_report report;
        error = fxs_fit_step(f, &report);
        if (!error && i == 2)
            error = change_model(&f->model);
    }
    fxs_packed_scene scene;
    if (!error && !(error = fxs_fit_pack(f, &scene, NULL, &message)))
        fxs_packed_scene_free(&scene);
    fxs_fit_free(f);
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

int main(void)
{
    RUN(test_no_memory);
    return check_report();
}
