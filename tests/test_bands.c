/* Renders in less memory than a whole frame needs. The picture is then rendered in bands of tile rows, and in depth
   slices of a tile row. The pictures must have equal bytes with any memory down to the minimum. With one byte less the
   frame is refused and nothing is written. */
#include <fixsplat/system.h>
#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

enum { GUARD = 0xa5, GUARD_BYTES = 256, MOST_PIXELS = 100 * 300 };

static struct {
    fxs_scene scene;
    fxs_object object;
    fxs_camera camera;
    fxs_options options;
    enum fxs_format format;
    fxs_stats stats;
    uint64_t evaluated, blended;
    size_t bytes;
    unsigned char expected[MOST_PIXELS * 4], pixels[MOST_PIXELS * 4];
} drawn;

static uint64_t banded, sliced;   /* numbers of frames that were rendered in several bands and in depth slices */

static int untouched(const unsigned char *bytes, size_t count)
{
    while (count > 0 && *bytes == GUARD)
        bytes++, count--;
    return count == 0;
}

static int render(const fxs_context *context, size_t bytes, fxs_stats *stats)
{
    unsigned char *memory = check_aligned(bytes + GUARD_BYTES);
    const fxs_targets targets = one_target(drawn.format, drawn.pixels,
                                           (ptrdiff_t)(drawn.bytes / (size_t)drawn.camera.height));
    memset(memory, GUARD, bytes + GUARD_BYTES);
    memset(drawn.pixels, GUARD, drawn.bytes);
    int error = render_frame(context, &drawn.object, 1, &drawn.camera, &drawn.options, &targets, memory, bytes, stats);
    CHECK(untouched(memory + bytes, GUARD_BYTES));
    free(memory);
    return error;
}

static void check_pairs(size_t least, size_t rows)
{
    for (size_t short_of = 0; short_of < 2; short_of++) {
        const size_t bytes = (rows > least ? rows : least) - short_of;
        uint64_t evaluated, blended;
        void *memory = check_aligned(bytes);
        const int error = count_pairs(&drawn.object, 1, &drawn.camera, &drawn.options, memory, bytes, &evaluated,
                                      &blended);
        CHECK(short_of ? error == FXS_ERR_MEMORY
                       : !error && evaluated == drawn.evaluated && blended == drawn.blended);
        free(memory);
    }
}

static void check_same(const fxs_context *context, size_t bytes)
{
    fxs_stats stats;
    CHECK(render(context, bytes, &stats) == 0);
    CHECK(!memcmp(drawn.pixels, drawn.expected, drawn.bytes));
    CHECK(stats.visible == drawn.stats.visible && stats.entries == drawn.stats.entries);
    CHECK(stats.bands >= 1 && stats.runs >= stats.bands && stats.memory.total <= bytes);
    CHECK(stats.memory.least <= bytes && (stats.slices > 0) == (stats.memory.rows > bytes));
    banded += stats.bands > 1;
    sliced += stats.slices > 0;
}

static void check_refused(const fxs_context *context, size_t bytes, size_t least)
{
    fxs_stats stats;
    CHECK(render(context, bytes, &stats) == FXS_ERR_MEMORY && stats.memory.least == least);
    CHECK(untouched(drawn.pixels, drawn.bytes));
}

static size_t frame_bytes(const fxs_context *context, fxs_frame_memory *memory)
{
    return fxs_frame_bytes(context, &drawn.object, 1, drawn.camera.width, drawn.camera.height, memory);
}

static size_t rows_of(const fxs_context *context, const fxs_frame_memory *memory)
{
    fxs_stats stats;
    CHECK(!render(context, memory->least, &stats));
    CHECK(stats.memory.rows <= memory->total);
    return stats.memory.rows;
}

static void check_limits(const fxs_context *context)
{
    fxs_frame_memory memory;
    const size_t total = frame_bytes(context, &memory);
    const size_t least = memory.least, rows = rows_of(context, &memory);
    check_refused(context, 0, least);
    check_refused(context, least - 1, least);
    check_same(context, least);
    for (int shift = 0; shift < 7; shift++)
        check_same(context, least + ((total - least) >> shift));
    check_same(context, total - 1);
    check_same(context, 2 * total);
    if (rows > least) {
        check_same(context, rows);
        check_same(context, rows - 1);
    }
    if (!context->config.workers.run)
        check_pairs(least, rows);
}

static void draw(void)
{
    fxs_context context;
    size_t pixel_bytes = (size_t)fxs_pixel_bytes(drawn.format);
    drawn.bytes = (size_t)drawn.camera.width * (size_t)drawn.camera.height * pixel_bytes;
    fxs_context_init(&context, 0);
    const fxs_targets targets = one_target(drawn.format, drawn.expected,
                                           (ptrdiff_t)drawn.camera.width * (ptrdiff_t)pixel_bytes);
    size_t bytes = frame_bytes(&context, 0);
    void *memory = check_aligned(bytes);
    CHECK(!render_frame(&context, &drawn.object, 1, &drawn.camera, &drawn.options, &targets, memory, bytes,
                        &drawn.stats));
    CHECK(!count_pairs(&drawn.object, 1, &drawn.camera, &drawn.options, memory, bytes, &drawn.evaluated,
                       &drawn.blended));
    CHECK(drawn.stats.bands == 1 && drawn.stats.memory.least == 0 && drawn.stats.memory.total == bytes);
    free(memory);
}

static void draw_random(int height)
{
    static const enum fxs_format formats[] = {FXS_FORMAT_RGBA8, FXS_FORMAT_RGBA8_COVERAGE, FXS_FORMAT_RGB565,
                                              FXS_FORMAT_BGRA8, FXS_FORMAT_RGB565_SWAPPED};
    random_camera(&drawn.camera);
    if (height) {
        drawn.camera.height = height;
        drawn.camera.cy_q12 = height * 2048;
    }
    fxs_options_init(&drawn.options);
    drawn.options.cutoff = (enum fxs_cutoff)between(0, 1);
    drawn.format = formats[between(0, 4)];
    draw();
}

/* Renders a random view in little memory: with 1, 2 and 4 threads, in plain C and with the fastest kernels. */
static void check_case(uint64_t seed, int32_t most, int height)
{
    state = seed * 0x1234567u;
    const packed_scene packed = random_scene((enum fxs_profile)(seed % 3), most);
    CHECK(!fxs_scene_open(&drawn.scene, packed.data, packed.bytes));
    drawn.object = one_object(&drawn.scene);
    draw_random(height);
    for (uint32_t threads = 1; threads <= 4; threads *= 2) {
        fxs_pool *pool = fxs_pool_create(threads);
        fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                             .workers.count = threads};
        fxs_context context;
        fxs_context_init(&context, &config);
        check_limits(&context);
#ifdef FXS_WITH_KERNELS
        context.config.kernels = kernels_for(fxs_cpu_detect());
        check_limits(&context);
#endif
        fxs_pool_destroy(pool);
    }
    free(packed.data);
}

static void test_same_bytes(void)
{
    for (uint64_t i = 0; i < 60 && !check_faults; i++)
        check_case(i, 3000, 0);
    printf("  %d frames in bands, %d in slices\n", (int)banded, (int)sliced);
    CHECK(banded > 100 && sliced > 50);
}

static void test_same_bytes_of_tall_pictures(void)
{
    banded = sliced = 0;
    for (int height = 1; height <= 300 && !check_faults; height += 23)
        check_case((uint64_t)height + 1000, 6000, height);
    printf("  %d frames in bands, %d in slices\n", (int)banded, (int)sliced);
    CHECK(banded > 100 && sliced > 50);
}

static void test_same_bytes_of_larger_scenes(void)
{
    banded = sliced = 0;
    for (uint64_t i = 0; i < 3 && !check_faults; i++)
        check_case(i + 2000, 100000, 200);
    printf("  %d frames in bands, %d in slices\n", (int)banded, (int)sliced);
    CHECK(banded > 10 && sliced > 10);
}

enum { ROWS = 6 };

/* Makes a scene for a picture one tile wide and ROWS tiles high. Chunk c (up to 256 Gaussians) has counts[c][r]
   Gaussians in tile row r. Their depth is 2^log2 scene units; log2 is 0 or 16. */
static packed_scene place_in_rows(uint32_t chunks, const int counts[][ROWS], int log2)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, chunks * FXS_CHUNK, 0);
    for (uint32_t c = 0; c < chunks; c++) {
        uint16_t *codes = (uint16_t *)(void *)(packed_scene_rows(&s, c) + FXS_ROW_POSITION);
        uint32_t *colours = (uint32_t *)(void *)(packed_scene_rows(&s, c) + FXS_ROW_COLOUR), at = 0;
        fill_chunk(&s, c);
        memset(colours, 0, 4 * FXS_CHUNK);
        s.chunks[c].scale_q16 = -(12 << 16);
        s.chunks[c].step_shift = (uint16_t)(log2 / 4 * 3);
        s.chunks[c].scale_step_q24 = 0;
        for (int i = 0; i < 3; i++) {
            s.chunks[c].origin_q32[i] = i < 2 ? 0 : (int64_t)1 << (32 + log2);
            s.chunks[c].step_q32[i] = i < 2 ? 1u << (26 + log2 / 4) : 0;
        }
        for (int row = 0; row < ROWS; row++)
            for (int k = 0; k < counts[c][row]; k++, at++) {
                codes[at] = (uint16_t)between(2, 13);
                codes[FXS_CHUNK + at] = (uint16_t)(16 * row + 8);
                colours[at] = ((uint32_t)next() & 0xffffff) | 60u << 24;
            }
        memset(packed_scene_rows(&s, c) + FXS_ROW_ROTATION, 0, 4 * FXS_CHUNK);
    }
    CHECK(!fxs_scene_open(&drawn.scene, s.data, s.bytes));
    drawn.object = one_object(&drawn.scene);
    drawn.object.scale_q32 <<= log2;
    drawn.camera = (fxs_camera){.width = 16, .height = 16 * ROWS, .fx_q12 = 64 << 12, .fy_q12 = 64 << 12,
                                .rotation_q30 = {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30}};
    fxs_options_init(&drawn.options);
    drawn.format = FXS_FORMAT_RGBA8;
    draw();
    return s;
}

static void test_blocks_of_any_number_of_splats(void)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    state = 1;
    for (int before = 0; before <= 16; before++)
        for (int kept = 1; kept <= 3; kept++) {
            const packed_scene s = place_in_rows(2, (const int[][ROWS]){{before}, {kept, FXS_CHUNK - kept}}, 0);
            check_limits(&context);
            free(s.data);
        }
}

static void test_rows_are_of_one_tile_row(void)
{
    size_t rows[2];
    fxs_context context;
    fxs_context_init(&context, 0);
    for (int others = 0; others < 2; others++) {
        int counts[8][ROWS];
        for (int c = 0; c < 8; c++)
            for (int row = 0; row < ROWS; row++)
                counts[c][row] = row == 2 ? 40 : 36 * others;
        const packed_scene s = place_in_rows(8, (const int (*)[ROWS])counts, 0);
        fxs_frame_memory memory;
        CHECK(frame_bytes(&context, &memory) > 0);
        CHECK(drawn.stats.visible == (others ? 8 * (40 + 36 * (ROWS - 1)) : 8 * 40));
        rows[others] = rows_of(&context, &memory);
        check_limits(&context);
        free(s.data);
    }
    CHECK(rows[0] == rows[1]);
}

static void test_slices_beyond_every_depth(void)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    const uint64_t before = sliced;
    const packed_scene s = place_in_rows(4, (const int[4][ROWS]){{250}, {250}, {250}, {250}}, 16);
    CHECK(drawn.stats.visible == 4 * 250);
    check_limits(&context);
    CHECK(sliced > before);
    free(s.data);
}

int main(void)
{
    RUN(test_same_bytes);
    RUN(test_same_bytes_of_tall_pictures);
    RUN(test_same_bytes_of_larger_scenes);
    RUN(test_blocks_of_any_number_of_splats);
    RUN(test_rows_are_of_one_tile_row);
    RUN(test_slices_beyond_every_depth);
    return check_report();
}
