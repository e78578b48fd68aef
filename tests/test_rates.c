/* Renders pictures with maps of rates. Each block of pixels must show the pixel of the same picture without rates that
   the definition names, in every target, with every kernel, in any memory. */
#include <fixsplat/rates.h>
#include <fixsplat/system.h>
#include "random_scene.h"
#include "random_world.h"
#include "src/core/targets.h"

enum { MACROS = 4, MEMORIES = 5, IMAGES = 5 };

static struct {
    fxs_scene scene;
    fxs_object object;
    fxs_camera camera;
    fxs_options options;
    uint8_t rates[MACROS][MACROS];
    uint32_t occluder[128 * 128], backdrop[128 * 128], shown[128 * 128];
    picture plain, rated;
    uint64_t banded, sliced, coarse;
} drawn;

/* Rate of the blocks at a pixel, from the definition in words. */
static int rate_at(int x, int y)
{
    int rate = drawn.rates[y / 32][x / 32];
    while ((x / 32 * 32 + 32 > drawn.camera.width && drawn.camera.width % rate) ||
           (y / 32 * 32 + 32 > drawn.camera.height && drawn.camera.height % rate))
        rate /= 2;
    return rate;
}

static size_t shown_by(int x, int y)
{
    const int rate = rate_at(x, y);
    return (size_t)(y / rate * rate + rate / 2) * (size_t)drawn.camera.width + (size_t)(x / rate * rate + rate / 2);
}

/* Compares the rated picture to the picture without rates. Of a picture over a backdrop, only the pixel of each block
   counts whose backdrop is the background of the plain picture. */
static int is_right(int over, const unsigned char *chosen)
{
    fxs_targets *a = &drawn.plain.targets, *b = &drawn.rated.targets;
    const fxs_image *const plain[] = {&a->colour, &a->coverage, &a->mean_depth, &a->median_depth, &a->id};
    const fxs_image *const rated[] = {&b->colour, &b->coverage, &b->mean_depth, &b->median_depth, &b->id};
    const size_t bytes[] = {(size_t)fxs_pixel_bytes(a->format), 1, 4, 4, 8};
    size_t wrong = 0, at = 0;
    for (int y = 0; y < drawn.camera.height; y++)
        for (int x = 0; x < drawn.camera.width; x++, at++)
            for (int k = 0; k < IMAGES; k++)
                if (plain[k]->pixels && (k || !over || chosen[at]))
                    wrong += memcmp((unsigned char *)rated[k]->pixels + at * bytes[k],
                                    (unsigned char *)plain[k]->pixels + shown_by(x, y) * bytes[k], bytes[k]) != 0;
    return CHECK(!wrong);
}

static void choose_pixels(unsigned char *chosen)
{
    size_t at = 0;
    memset(chosen, 0, (size_t)drawn.camera.width * (size_t)drawn.camera.height);
    for (int y = 0; y < drawn.camera.height; y++)
        for (int x = 0; x < drawn.camera.width; x++, at++) {
            const int rate = rate_at(x, y), row = y / rate * rate, column = x / rate * rate;
            if (at != (size_t)row * (size_t)drawn.camera.width + (size_t)column)
                continue;
            const size_t one = (size_t)(row + between(0, rate - 1)) * (size_t)drawn.camera.width +
                               (size_t)(column + between(0, rate - 1));
            chosen[one] = 1;
            drawn.shown[shown_by(x, y)] = drawn.backdrop[one];
            drawn.coarse += rate > 1;
        }
}

static void fill_targets(void)
{
    const size_t pixels = (size_t)drawn.camera.width * (size_t)drawn.camera.height;
    const unsigned without = (unsigned)next();
    const int occluded = between(0, 2) == 0, width = drawn.camera.width;
    const int over = between(0, 2) == 0 && !fxs_is_premultiplied(drawn.plain.targets.format);
    for (size_t i = 0; i < pixels; i++) {
        drawn.occluder[i] = between(0, 9) ? (uint32_t)between(0, 1 << 20) : FXS_NOTHING;
        drawn.backdrop[i] = (uint32_t)next();
    }
    picture *const both[] = {&drawn.plain, &drawn.rated};
    for (int i = 0; i < 2; i++) {
        fxs_targets *t = &both[i]->targets;
        leave_out(t, without);
        if (occluded)
            t->occluder = (fxs_image){drawn.occluder, 4 * width};
        if (over)
            t->backdrop = (fxs_image){i ? drawn.backdrop : drawn.shown, 4 * width};
    }
    for (int i = 0; i < MACROS * MACROS; i++)
        drawn.rates[i / MACROS][i % MACROS] = (uint8_t)(1 << between(0, 2));
    drawn.rated.targets.rates = (fxs_image){drawn.rates, MACROS};
}

static int render(const fxs_context *context, const fxs_targets *targets, size_t bytes, fxs_stats *stats)
{
    void *memory = check_aligned(bytes);
    const int error = render_frame(context, &drawn.object, 1, &drawn.camera, &drawn.options, targets, memory, bytes,
                                   stats);
    free(memory);
    return error;
}

/* Renders with the memory of a whole frame, and with less down to the least. */
static void check_memories(const fxs_context *context, const unsigned char *chosen)
{
    fxs_frame_memory sizes;
    fxs_stats stats;
    const size_t total = one_frame_bytes(context, &drawn.scene, drawn.camera.width, drawn.camera.height, &sizes);
    for (int i = 0; i < MEMORIES && !check_faults; i++) {
        const size_t bytes = i ? sizes.least + ((total - sizes.least) * (size_t)(i - 1) / MEMORIES) : total;
        picture_clear(&drawn.rated);
        const int error = render(context, &drawn.rated.targets, bytes, &stats);
        if (error == FXS_ERR_MEMORY && i && fxs_targets_traced(&drawn.rated.targets))
            continue;
        CHECK(!error);
        drawn.banded += stats.bands > 1;
        drawn.sliced += stats.slices > 0;
        is_right(drawn.plain.targets.backdrop.pixels != 0, chosen);
    }
}

static void check_frame(int32_t most, int wild)
{
    fxs_kernels versions[WORLD_VERSIONS];
    fxs_context context;
    const packed_scene packed = random_scene((enum fxs_profile)between(0, 2), most);
    if (wild)
        fill_wild(&packed);
    CHECK(!fxs_scene_open(&drawn.scene, packed.data, packed.bytes));
    drawn.object = one_object(&drawn.scene);
    random_view(&drawn.camera, &drawn.options);
    drawn.options.cutoff = FXS_CUTOFF_MAHALANOBIS;
    if (between(0, 1)) {                           /* sizes whose edges cut no block, or blocks of 4 only */
        drawn.camera.width = (drawn.camera.width + 1) & ~1;
        drawn.camera.height = (drawn.camera.height + 3) & ~3;
    }
    const enum fxs_format format = (enum fxs_format)between(0, FXS_FORMAT_RGB565_SWAPPED);
    drawn.plain = picture_new(drawn.camera.width, drawn.camera.height, format);
    drawn.rated = picture_new(drawn.camera.width, drawn.camera.height, format);
    unsigned char *chosen = malloc((size_t)drawn.camera.width * (size_t)drawn.camera.height);
    fill_targets();
    choose_pixels(chosen);
    fxs_context_init(&context, 0);
    const size_t bytes = one_frame_bytes(&context, &drawn.scene, drawn.camera.width, drawn.camera.height, 0);
    CHECK(!render(&context, &drawn.plain.targets, bytes, 0));
    const int count = world_versions(versions);
    for (int i = 0; i < count; i++) {
        fxs_pool *pool = fxs_pool_create((uint32_t)(1 + i % 2));
        const fxs_config config = {.size = sizeof config, .workers.run = fxs_pool_run, .workers.pool = pool,
                                   .workers.count = (uint32_t)(1 + i % 2), .kernels = &versions[i]};
        fxs_context_init(&context, &config);
        check_memories(&context, chosen);
        fxs_pool_destroy(pool);
    }
    free(chosen);
    picture_free(&drawn.plain);
    picture_free(&drawn.rated);
    free(packed.data);
}

static void random_frames(void)
{
    state = 20263;
    for (int i = 0; i < 400 && !check_faults; i++)
        check_frame(i % 8 ? 1500 : 12000, i % 4 == 1);
    printf("  %d blocks, %d frames in bands, %d in slices\n", (int)drawn.coarse, (int)drawn.banded, (int)drawn.sliced);
    CHECK(drawn.coarse > 10000 && drawn.banded > 100 && drawn.sliced > 40);
}

static fxs_targets small_targets(void)
{
    static uint8_t colour[64 * 40 * 4];
    fxs_targets t = one_target(FXS_FORMAT_RGBA8, colour, 64 * 4);
    memset(drawn.rates, 1, sizeof drawn.rates);
    memset(colour, WORLD_GUARD, sizeof colour);
    t.rates = (fxs_image){drawn.rates, 2};
    return t;
}

static int draw_there(void *argument, const struct fxs_tile_run *run)
{
    (void)argument, (void)run;
    return 0;
}

/* Renders one Gaussian in 64x40 pixels, with 2x2 macro tiles, and checks that an error leaves the picture untouched. */
static int result_of(const fxs_targets *targets, const fxs_config *config)
{
    fxs_context context;
    fxs_context_init(&context, config);
    const int error = render(&context, targets, 1 << 20, 0);
    CHECK(!error || *(uint8_t *)targets->colour.pixels == WORLD_GUARD);
    return error;
}

static void wrong_maps(void)
{
    state = 1;
    const packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 1);
    CHECK(!fxs_scene_open(&drawn.scene, packed.data, packed.bytes));
    drawn.object = one_object(&drawn.scene);
    fxs_camera_init(&drawn.camera, 64, 40);
    fxs_options_init(&drawn.options);
    fxs_targets t = small_targets();
    CHECK(!result_of(&t, 0));
    for (int rate = 0; rate < 256; rate++) {
        t = small_targets();
        ((uint8_t *)t.rates.pixels)[3] = (uint8_t)rate;
        CHECK(result_of(&t, 0) == (rate == 1 || rate == 2 || rate == 4 ? 0 : FXS_ERR_TARGET));
    }
    t = small_targets();
    t.rates.stride = 1;
    CHECK(result_of(&t, 0) == FXS_ERR_TARGET);
    t = small_targets();
    t.rates.pixels = t.colour.pixels;
    CHECK(result_of(&t, 0) == FXS_ERR_TARGET);
    t = small_targets();
    drawn.options.cutoff = FXS_CUTOFF_SQUARE;
    CHECK(result_of(&t, 0) == FXS_ERR_TARGET);
    drawn.options.cutoff = FXS_CUTOFF_MAHALANOBIS;
    const fxs_config config = {.size = sizeof config, .draw = draw_there};
    CHECK(result_of(&t, &config) == FXS_ERR_UNSUPPORTED);
    free(packed.data);
}

static void maps_around_a_pixel(void)
{
    static uint8_t rates[MACROS][MACROS + 1];
    state = 2;
    for (int i = 0; i < 300; i++) {
        const int width = between(1, 32 * MACROS), height = between(1, 32 * MACROS), x = between(-60, 160);
        const int y = between(-60, 160), near = between(0, 90), far = between(0, 180);
        fxs_image map = {rates, MACROS + 1};
        memset(rates, 0, sizeof rates);
        fxs_rates_around(&map, width, height, x, y, (uint32_t)near, (uint32_t)far);
        for (int row = 0; row < MACROS; row++)
            for (int column = 0; column <= MACROS; column++) {
                int least = INT32_MAX;
                for (int k = 0; k < 1024; k++) {
                    const int dx = 32 * column + k % 32 - x, dy = 32 * row + k / 32 - y;
                    least = dx * dx + dy * dy < least ? dx * dx + dy * dy : least;
                }
                const int inside = 32 * column < width && 32 * row < height;
                CHECK(rates[row][column] == (!inside ? 0 : least <= near * near ? 1 : least <= far * far ? 2 : 4));
            }
    }
    uint8_t one = 0;
    fxs_rates_around(&(fxs_image){&one, 1}, 1, 1, INT32_MIN, INT32_MAX, 0, UINT32_MAX);
    CHECK(one == 2);
}

int main(void)
{
    RUN(random_frames);
    RUN(wrong_maps);
    RUN(maps_around_a_pixel);
    return check_report();
}
