/* Packs scene files. Checks the losses, bytes and order of Gaussians of each profile. A chunk is 256 Gaussians
   of a packed scene. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/base/byte_reader.h"
#include "src/pack/weight.h"
#include "src/gaussian/attributes.h"
#include "src/pack/coded.h"
#include "src/pack/encode.h"
#include "src/pack/order.h"
#include "src/pack/pack_stage.h"
#include "src/base/run.h"
#include <fixsplat/fixsplat.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/packed.h>
#include "src/core/chunk.h"
#include "tools/command/procedural.h"
#include "scene_writer.h"
#include "check.h"
#include "decoded.h"

enum { MAX_COUNT = 40000 };

static char path[] = "/tmp/test_pack_XXXXXX";
static fxs_gaussian gaussians[MAX_COUNT];
static fxs_packed_scene packed;
static fxs_pack_report report;
static fxs_message message;

static uint32_t seed;

static float uniform(double low, double high)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(low + (high - low) * seed / 4294967296.0);
}

static void make_gaussians(size_t count)
{
    seed = 1;
    for (size_t i = 0; i < count; i++) {
        fxs_gaussian *g = &gaussians[i];
        memset(g, 0, sizeof *g);
        for (int k = 0; k < 3; k++) {
            g->position[k] = uniform(-8, 8);
            g->scale[k] = uniform(-7, -2);
            g->dc[k] = uniform(-1.5, 1.5);
        }
        for (int k = 0; k < 4; k++)
            g->rotation[k] = uniform(-2, 2);
        g->opacity = uniform(-5, 5);
        for (int k = 0; k < 45; k++)
            g->sh[k] = uniform(-0.3, 0.3);
    }
}

static int write_file(uint64_t count, int sh_degree, int antialiased)
{
    fxs_scene_writer *writer;
    return open_writer("ply", path, count, sh_degree, antialiased, &writer, &message) == 0 &&
           fxs_scene_writer_put(writer, gaussians, (size_t)count, &message) == 0 &&
           close_writer(writer, &message) == 0;
}

static enum fxs_profile profile;
static const fxs_allocator *allocator;
static size_t bytes_said;
static uint32_t held;   /* number of chunks whose SH codes are kept in memory while packing; 0: fxs_pack chooses */

/* Opens a scene file and packs it with a pool of `threads` threads. threads 0: without a pool. */
static int pack_with(const char *name, uint32_t threads, const fxs_progress *progress)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pool *pool = threads ? fxs_pool_create(threads) : 0;
    fxs_pack_options options = {.size = sizeof options, .profile = profile, .allocator = allocator,
                                .workers = {pool ? fxs_pool_run : 0, pool, threads}};
    if (progress)
        options.progress = *progress;
    message.text[0] = 0;
    int result = fxs_scene_file_open(name, NULL, &file, &info, &message);
    if (!result) {
        result = held ? fxs_pack_held(file, &info, NULL, held, &packed, &report, &options, &message)
                      : fxs_pack(file, &info, &packed, &report, &options, &message);
        bytes_said = fxs_pack_bytes(&info, profile);
        fxs_scene_file_close(file);
    }
    fxs_pool_destroy(pool);
    return result;
}

static int pack_file(const fxs_progress *progress)
{
    return pack_with(path, 0, progress);
}

static fxs_scene pack(size_t count, int sh_degree)
{
    fxs_scene scene;
    memset(&scene, 0, sizeof scene);
    CHECK(write_file(count, sh_degree, 0));
    if (!CHECK(pack_file(0) == 0))
        printf("  %s\n", message.text);
    else
        CHECK(fxs_scene_open(&scene, packed.data, packed.bytes) == 0);
    return scene;
}

static uint32_t word_at(const fxs_scene *scene, uint32_t i, uint32_t row)
{
    uint32_t word;
    memcpy(&word, rows_of(scene, i) + row + 4 * (i % FXS_CHUNK), 4);
    return word;
}

static double position_of(const fxs_scene *scene, uint32_t i, uint32_t axis)
{
    const fxs_chunk *chunk = chunk_of(scene, i);
    uint16_t code;
    memcpy(&code, rows_of(scene, i) + FXS_ROW_POSITION + 2 * (axis * FXS_CHUNK + i % FXS_CHUNK), 2);
    return ldexp((double)chunk->origin_q32[axis], -32) + code * position_step(chunk, axis);
}

static const fxs_gaussian *source_at(const double p[3], size_t count)
{
    double nearest = INFINITY;
    const fxs_gaussian *source = 0;
    for (size_t k = 0; k < count; k++) {
        double distance = hypot(hypot(p[0] - gaussians[k].position[0], p[1] - gaussians[k].position[1]),
                                p[2] - gaussians[k].position[2]);
        source = distance < nearest ? &gaussians[k] : source;
        nearest = fmin(nearest, distance);
    }
    return source;
}

static const fxs_gaussian *source_of(const fxs_scene *scene, uint32_t i, size_t count)
{
    const double p[3] = {position_of(scene, i, 0), position_of(scene, i, 1), position_of(scene, i, 2)};
    return source_at(p, count);
}

static double worst_rotation, worst_step;

static void note(double difference, double step)
{
    worst_step = fmax(worst_step, fabs(difference) / step);
}

static void find_order(int order[3], const float scale[3])
{
    for (int i = 0; i < 3; i++)
        order[i] = i;
    for (int pass = 0; pass < 3; pass++)
        for (int i = 0; i < 2; i++)
            if (scale[order[i]] < scale[order[i + 1]]) {
                const int longer = order[i + 1];
                order[i + 1] = order[i];
                order[i] = longer;
            }
}

static void compare_gaussian(const fxs_scene *scene, uint32_t i, const fxs_gaussian *g)
{
    const fxs_chunk *chunk = chunk_of(scene, i);
    const uint32_t scale = word_at(scene, i, FXS_ROW_SCALE), colour = word_at(scene, i, FXS_ROW_COLOUR);
    const int bits = axis_bits_of_word(0, scale, chunk->scale_step_q24);
    int order[3];
    find_order(order, g->scale);
    for (uint32_t k = 0; k < 3; k++) {
        double code = k < 2 ? scale >> 10 * k & 1023 : (scale >> 20 & 511) * 2,
               step = ldexp(chunk->scale_step_q24, -24);
        double dc_step = ldexp(chunk->colour_step_q20[k], -20), base = 0.5 + 0.28209479177387814 * g->dc[k];
        note(position_of(scene, i, k) - g->position[k], position_step(chunk, k));
        note(ldexp(chunk->scale_q16, -16) - code * code * step - g->scale[order[k]] / log(2),
             step * (k < 2 ? 2 * code + 1 : 4 * code + 4));
        note(ldexp(chunk->colour_q16[k], -16) + ((colour >> 8 * k & 255) * 2 + (scale >> (29 + k) & 1)) * dc_step -
                 base,
             dc_step);
    }
    const uint32_t code = colour >> 24, law = chunk->opacity_law;
    const double opacity = 1 / (1 + exp(-g->opacity)), next = opacity_of(code < 255 ? code + 1 : 254, law);
    note(opacity_of(code, law) - opacity, code == 0 ? 2 / 255.0 : fabs(next - opacity_of(code, law)));
    worst_rotation = fmax(worst_rotation, angle_of_word(word_at(scene, i, FXS_ROW_ROTATION), bits, g->rotation, order));
    const int8_t *sh = (const int8_t *)rows_of(scene, i) + FXS_ROW_SH;
    for (int k = 0; k < 3 * FXS_SH_COUNT(scene->sh_degree); k++) {
        double step = ldexp(chunk->sh_step_q19[k < 9 ? 0 : k < 24 ? 1 : 2], -19);
        note(sh[k * FXS_CHUNK + (int)(i % FXS_CHUNK)] * step - g->sh[k], step);
    }
}

/* Packs a scene and checks that packed values agree with the source within half a quantisation step. */
static void check_packed(size_t count, int sh_degree)
{
    fxs_scene scene = pack(count, sh_degree);
    CHECK(report.read == count && report.packed == count && scene.count == count && scene.sh_degree == sh_degree);
    worst_rotation = worst_step = 0;
    for (uint32_t i = 0; i < scene.count; i++)
        compare_gaussian(&scene, i, source_of(&scene, i, count));
    if (!CHECK(worst_step < 0.51) || !CHECK(worst_rotation < 0.36))
        printf("  differences: %.3f steps, %.3f degrees\n", worst_step, worst_rotation);
    CHECK(fabs(report.largest.rotation - worst_rotation) < 1e-3);
    for (uint32_t i = scene.count; i < scene.chunk_count * FXS_CHUNK; i++)
        CHECK(word_at(&scene, i, FXS_ROW_COLOUR) >> 24 == 0);
    fxs_packed_scene_free(&packed);
}

static void test_packed_is_source_within_half_a_step(void)
{
    make_gaussians(1000);
    for (int degree = 0; degree <= 3; degree++)
        check_packed(1000, degree);
}

static void test_counts(void)
{
    static const size_t counts[] = {1, 2, 255, 256, 257, 512, 513};
    make_gaussians(513);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_packed(counts[i], 1);
}

static void test_largest_errors(void)
{
    make_gaussians(2000);
    fxs_scene scene = pack(2000, 3);
    fxs_pack_error most = {0, 0, 0, 0, 0, 0};
    for (uint32_t i = 0; i < scene.chunk_count; i++) {
        const fxs_chunk *chunk = chunk_of(&scene, i * FXS_CHUNK);
        for (int k = 0; k < 3; k++) {
            most.position = fmax(most.position, ldexp(chunk->step_q32[k], (int)chunk->step_shift - 33));
            most.dc = fmax(most.dc, ldexp(chunk->colour_step_q20[k], -21) / 0.28209479177387814);
            most.sh = fmax(most.sh, ldexp(chunk->sh_step_q19[k], -20));
        }
        most.scale = fmax(most.scale, ldexp(chunk->scale_step_q24, -25) * 4088 * log(2));
    }
    for (uint32_t i = 0; i < scene.count; i++) {
        const uint32_t step = chunk_of(&scene, i)->scale_step_q24;
        most.rotation = fmax(most.rotation,
                             0.1 + ldexp(90, 2 * axis_bits_of_word(0, word_at(&scene, i, FXS_ROW_SCALE), step) - 32));
    }
    CHECK(report.largest.position > 0 && report.largest.position < 1.01 * most.position);
    CHECK(report.largest.scale > 0 && report.largest.scale < 1.01 * most.scale);
    CHECK(report.largest.dc > 0 && report.largest.dc < 1.01 * most.dc);
    CHECK(report.largest.sh > 0 && report.largest.sh < 1.01 * most.sh);
    CHECK(report.largest.opacity > 0 && report.largest.opacity < 2.01 / 510);
    CHECK(report.largest.rotation > 0 && report.largest.rotation < most.rotation);
    fxs_packed_scene_free(&packed);
}

static void test_bounds(void)
{
    make_gaussians(1000);
    gaussians[3].position[0] = 500;
    pack(1000, 0);
    CHECK(report.high[0] == 500 && report.low[0] >= -8 && report.low[0] < -7.9);
    CHECK(report.inner_high[0] < 8.5 && report.inner_high[0] > 7.8 && report.inner_low[0] > -8.5);
    fxs_packed_header header;
    memcpy(&header, packed.data, sizeof header);
    for (int i = 0; i < 3; i++) {
        CHECK((double)header.low_q32[i] == floor(ldexp(report.low[i], 32)));
        CHECK((double)header.high_q32[i] == ceil(ldexp(report.high[i], 32)));
        CHECK((double)header.inner_low_q32[i] == floor(ldexp(report.inner_low[i], 32)));
        CHECK((double)header.inner_high_q32[i] == ceil(ldexp(report.inner_high[i], 32)));
    }
    fxs_packed_scene_free(&packed);
}

static void fill_box(uint32_t first, uint32_t count, const double low[3], const double high[3], double size,
                     double opacity)
{
    for (uint32_t i = first; i < first + count; i++) {
        fxs_gaussian *g = &gaussians[i];
        for (int k = 0; k < 3; k++) {
            g->position[k] = uniform(low[k], high[k]);
            g->scale[k] = (float)log(size);
        }
        g->opacity = (float)opacity;
    }
}

static int inner_is(const double low[3], const double high[3], double tolerance)
{
    int same = 1;
    for (int k = 0; k < 3; k++)
        same &= fabs(report.inner_low[k] - low[k]) < tolerance && fabs(report.inner_high[k] - high[k]) < tolerance;
    if (!same)
        printf("  inner bounds %g %g %g to %g %g %g\n", report.inner_low[0], report.inner_low[1], report.inner_low[2],
               report.inner_high[0], report.inner_high[1], report.inner_high[2]);
    return same;
}

/* Tests the scene's inner box. It must hold two objects of 3 % and 1 % of the Gaussians and exclude floaters. */
static void test_inner_bounds_hold_an_object(void)
{
    static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    static const double top[3] = {-0.3, -1.6, -0.3}, chin[3] = {0.3, -1, 0.3};
    static const double floor_low[3] = {-1, 1, -1}, floor_high[3] = {1, 2.5, 1}, whole_low[3] = {-1, -1.6, -1};
    static const double far_low[3] = {-90, -90, -90}, far_high[3] = {90, 90, 90}, hidden[3] = {5, 5, 5};
    for (int reverse = 0; reverse < 2; reverse++) {
        make_gaussians(20000);
        fill_box(0, 18000, low, high, 0.01, 3);
        fill_box(18000, 600, top, chin, 0.01, 3);
        fill_box(18600, 200, floor_low, floor_high, 0.1, 3);
        fill_box(18800, 40, far_low, far_high, 0.5, 0);
        fill_box(18840, 1160, high, hidden, 0.3, -11);
        for (uint32_t i = 0; i < 10000 && reverse; i++) {
            const fxs_gaussian swapped = gaussians[i];
            gaussians[i] = gaussians[19999 - i];
            gaussians[19999 - i] = swapped;
        }
        pack(20000, 0);
        CHECK(inner_is(whole_low, floor_high, 0.12));
        fxs_packed_scene_free(&packed);
    }
}

/* Tests the scene's inner box. Sparse surroundings that reach to 100 times the object's size must not enlarge
   it. */
static void test_inner_bounds_in_surroundings(void)
{
    static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    make_gaussians(20000);
    fill_box(0, 17000, low, high, 0.01, 3);
    for (uint32_t i = 0; i < 3000; i++) {
        const double out = exp2(7.0 * i / 3000), from[3] = {-out, -out, -out}, to[3] = {out, out, out};
        fill_box(17000 + i, 1, from, to, 0.02 * out, 3);
    }
    pack(20000, 0);
    for (int k = 0; k < 3; k++)
        CHECK(report.inner_low[k] < -0.9 && report.inner_low[k] > -4 && report.inner_high[k] > 0.9 &&
              report.inner_high[k] < 4);
    fxs_packed_scene_free(&packed);
}

static void test_inner_bounds_of_little(void)
{
    static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1}, one[3] = {3, 4, 5};
    make_gaussians(1000);
    fill_box(0, 1000, low, high, 0.01, -100);
    pack(1000, 0);
    CHECK(inner_is(low, high, 0.15));
    fxs_packed_scene_free(&packed);
    fill_box(0, 1, one, one, 0.01, 1);
    pack(1, 0);
    CHECK(inner_is(one, one, 0.021));
    fxs_packed_scene_free(&packed);
}

static void test_all_equal(void)
{
    make_gaussians(1);
    for (int i = 1; i < 600; i++)
        gaussians[i] = gaussians[0];
    fxs_scene scene = pack(600, 3);
    worst_step = worst_rotation = 0;
    CHECK(report.packed == 600 && report.largest.position < 1e-9);
    for (uint32_t i = 1; i < scene.count; i++)
        CHECK(word_at(&scene, i, FXS_ROW_ROTATION) == word_at(&scene, 0, FXS_ROW_ROTATION) &&
              word_at(&scene, i, FXS_ROW_COLOUR) == word_at(&scene, 0, FXS_ROW_COLOUR));
    fxs_packed_scene_free(&packed);
}

static void test_extremes(void)
{
    make_gaussians(512);
    for (int i = 0; i < 3; i++) {
        gaussians[0].position[i] = 134000000;
        gaussians[1].position[i] = -134000000;
        gaussians[2].scale[i] = 20;
        gaussians[3].scale[i] = -20;
        gaussians[4].dc[i] = 1e30f;
        gaussians[5].dc[i] = -1e30f;
        gaussians[6].sh[i] = 1e30f;
    }
    for (int i = 0; i < 4; i++)
        gaussians[9].rotation[i] = 1e-30f;
    fxs_scene scene = pack(512, 3);
    CHECK(report.packed == 512 && scene.count == 512);
    fxs_packed_scene_free(&packed);
}

static void test_sh_steps_up_to_the_limit(void)
{
    static const uint32_t steps[] = {1, 4096, 32765, 32766, 32767};
    fxs_scene_file_info info;
    fxs_chunk_ranges ranges;
    fxs_chunk chunk;
    memset(&info, 0, sizeof info);
    fxs_ranges_clear(&ranges);
    make_gaussians(1);
    fxs_ranges_take(&ranges, gaussians, fxs_opacity_of_logit(gaussians->opacity), 0);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++)
        for (int degree = 0; degree < 3; degree++) {
            const float most = (float)ldexp(127 * steps[k], -19);
            ranges.sh[degree] = most;
            fxs_encode_header(&chunk, &ranges, &info);
            CHECK(chunk.sh_step_q19[degree] == steps[k]);
            ranges.sh[degree] = nextafterf(most, 100);
            fxs_encode_header(&chunk, &ranges, &info);
            CHECK(chunk.sh_step_q19[degree] == (steps[k] < 32767 ? steps[k] + 1 : 32767));
            ranges.sh[degree] = 1e6f;
            fxs_encode_header(&chunk, &ranges, &info);
            CHECK(chunk.sh_step_q19[degree] == 32767);
            ranges.sh[degree] = 0;
        }
}

/* Checks that all codes of SH are used. The difference from an SH palette's entry is coded as an odd number from
   -7 to 7. */
static void test_every_residual_code_serves(void)
{
    uint32_t uses[8] = {0}, all = 0;
    make_gaussians(2000);
    profile = FXS_PROFILE_COMPACT;
    fxs_scene scene = pack(2000, 3);
    profile = FXS_PROFILE_DEFAULT;
    for (uint32_t i = 0; i < scene.count; i++) {
        const unsigned char *record = rows_of(&scene, i) + FXS_ROW_SH + 21 * (i % FXS_CHUNK);
        for (uint32_t bit = FXS_RESIDUAL_BIT; bit < FXS_RESIDUAL_BIT + 3 * 45; bit += 3, all++) {
            const uint32_t next = bit / 8 + 1 < 21 ? record[bit / 8 + 1] : 0;
            uses[(record[bit / 8] | next << 8) >> bit % 8 & 7]++;
        }
    }
    CHECK(all == 2000 * 45);
    for (int code = 0; code < 8; code++)
        if (!CHECK(uses[code] > all / 50))
            printf("  %u of code %d\n", uses[code], code);
    fxs_packed_scene_free(&packed);
}

static void test_bytes_skipped(void)
{
    static uint8_t data[FXS_BYTE_READER_BUFFER + 1000];
    static fxs_byte_reader reader;
    fxs_scene_source source;
    memset(&source, 0, sizeof source);
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)(i * 7 + i / 256);
    source.input = fxs_memory_input(data, sizeof data);
    for (size_t to = FXS_BYTE_READER_BUFFER - 2; to <= FXS_BYTE_READER_BUFFER + 2; to++) {
        memset(&reader, 0, sizeof reader);
        reader.source = &source;
        CHECK(fxs_bytes_take(&reader, 1) && fxs_bytes_skip(&reader, to - 1) == 0 && fxs_bytes_tell(&reader) == to);
        const uint8_t *byte = fxs_bytes_take(&reader, 1);
        CHECK(byte && *byte == data[to]);
        CHECK(fxs_bytes_skip(&reader, sizeof data - to - 1) == 0 && !fxs_bytes_take(&reader, 1));
    }
    CHECK(fxs_bytes_seek(&reader, 10) == 0 && fxs_bytes_skip(&reader, sizeof data - 9) == FXS_ERR_FILE);
}

static void test_no_more_than_announced(void)
{
    fxs_scene_file *file = NULL;
    fxs_scene_file_info info;
    make_gaussians(3000);
    pack(1000, 1);
    const fxs_packed_scene alone = packed;
    CHECK(write_file(3000, 1, 0) && fxs_scene_file_open(path, NULL, &file, &info, &message) == 0);
    info.count = 1000;
    if (CHECK(fxs_pack(file, &info, &packed, &report, NULL, &message) == 0)) {
        CHECK(packed.bytes == alone.bytes && !memcmp(packed.data, alone.data, alone.bytes));
        fxs_packed_scene_free(&packed);
    }
    fxs_scene_file_close(file);
    packed = alone;
    fxs_packed_scene_free(&packed);
}

static void test_dropped(void)
{
    make_gaussians(300);
    gaussians[10].position[1] = NAN;
    gaussians[20].scale[2] = INFINITY;
    gaussians[30].rotation[3] = -INFINITY;
    gaussians[40].opacity = NAN;
    gaussians[50].dc[0] = INFINITY;
    gaussians[60].sh[44] = NAN;
    memset(gaussians[70].rotation, 0, sizeof gaussians[70].rotation);
    gaussians[80].opacity = INFINITY;
    gaussians[90].opacity = -INFINITY;
    gaussians[100].position[2] = -INFINITY;
    fxs_scene scene = pack(300, 3);
    CHECK(report.read == 300 && report.packed == 291 && scene.count == 291);
    CHECK(report.dropped.not_finite == 7 && report.dropped.transparent == 1);
    CHECK(report.dropped.rotation == 1 && report.brought_in == 0);
    CHECK(isfinite(report.largest.position) && isfinite(report.largest.sh) && report.high[2] <= 8);
    fxs_packed_scene_free(&packed);
}

/* Checks the reported share of dropped Gaussians. A Gaussian is weighed by opacity times the area of its two
   largest axes. */
static void test_share_of_what_is_dropped(void)
{
    make_gaussians(100);
    for (int i = 0; i < 100; i++) {
        gaussians[i].opacity = 0;
        gaussians[i].scale[0] = gaussians[i].scale[1] = -3;
        gaussians[i].scale[2] = -INFINITY;
    }
    gaussians[10].position[0] = NAN;
    gaussians[10].scale[0] = gaussians[10].scale[2] = -3 + logf(11);
    gaussians[20].opacity = -INFINITY;
    gaussians[30].dc[2] = NAN;
    pack(100, 0);
    CHECK(report.packed == 97 && report.dropped.not_finite == 2 && report.dropped.transparent == 1);
    CHECK(fabs(fxs_dropped_share(&report.dropped) - 122 / 219.0) < 1e-5);
    fxs_packed_scene_free(&packed);
    gaussians[10].scale[0] = INFINITY;
    pack(100, 0);
    CHECK(report.packed == 97 && fabs(fxs_dropped_share(&report.dropped) - 12 / 109.0) < 1e-5);
    fxs_packed_scene_free(&packed);
    gaussians[30] = gaussians[31];
    gaussians[10] = gaussians[31];
    pack(100, 0);
    CHECK(report.packed == 99 && report.dropped.weight <= 0 && fxs_dropped_share(&report.dropped) <= 0);
    fxs_packed_scene_free(&packed);
}

static double packed_scale(const fxs_scene *scene, uint32_t axis)
{
    const fxs_chunk *chunk = chunk_of(scene, 0);
    const uint32_t word = word_at(scene, 0, FXS_ROW_SCALE);
    const uint32_t code = axis < 2 ? word >> 10 * axis & 1023 : (word >> 20 & 511) * 2;
    return (ldexp(chunk->scale_q16, -16) - ldexp((double)code * code * chunk->scale_step_q24, -24)) * log(2);
}

/* Checks how packing clamps scales: a thin axis to the range of the codes, a large axis to the format's maximum. */
static void test_axes_are_held(void)
{
    static const float cases[][2][3] = {
        {{4.28f, 4.28f, -20.7f}, {4.28f, 4.28f, -4.72f}}, {{4, -INFINITY, 2}, {4, -5, 2}},
        {{25, 30, 3e38f}, {20, 20, 20}}, {{21, 3, 12.5f}, {20, 12, 12.5f}}, {{-3, -30, -11}, {-3, -12, -11}},
        {{-15, -INFINITY, -30}, {-15, -20, -20}}, {{-INFINITY, -INFINITY, -INFINITY}, {-20, -20, -20}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_gaussians(1);
        memcpy(gaussians->scale, cases[i][0], sizeof gaussians->scale);
        const fxs_scene scene = pack(1, 0);
        CHECK(report.packed == 1 && report.dropped.not_finite == 0);
        int order[3];
        find_order(order, cases[i][1]);
        for (uint32_t k = 0; k < 3; k++)
            CHECK(fabs(packed_scale(&scene, k) - (double)cases[i][1][order[k]]) < 0.02);
        CHECK(report.largest.scale < 0.02);
        fxs_packed_scene_free(&packed);
    }
}

static void test_needles_in_a_chunk(void)
{
    double rms[2];
    for (int needles = 0; needles < 2; needles++) {
        make_gaussians(256);
        for (int i = 0; i < 256; i++)
            for (int k = 0; k < 3; k++)
                gaussians[i].scale[k] = uniform(-6, -2);
        for (int i = 0; i < 256 && needles; i += 8)
            gaussians[i].scale[i / 8 % 3] = i % 16 ? -INFINITY : -18;
        pack(256, 0);
        rms[needles] = report.rms.scale;
        fxs_packed_scene_free(&packed);
    }
    CHECK(rms[1] < 2.3 * rms[0]);
}

/* A Gaussian beyond the range of packed positions is moved closer and shrunk. Seen from the origin, its size
   stays. */
static void test_far_ones_are_brought_in(void)
{
    static const float axis[3] = {1, -0.5f, 0.25f};
    make_gaussians(2);
    for (int i = 0; i < 3; i++) {
        gaussians[0].position[i] = 1.34e10f * axis[i];
        gaussians[0].scale[i] = 12 - (float)i;
        gaussians[1] = gaussians[0];
    }
    const fxs_scene scene = pack(2, 0);
    CHECK(report.packed == 2 && report.brought_in == 2);
    for (uint32_t k = 0; k < 3; k++) {
        CHECK(fabs(position_of(&scene, 0, k) - 1.34e8 * (double)axis[k]) < 50);
        CHECK(fabs(packed_scale(&scene, k) - (12 - (double)k - log(100))) < 0.01);
    }
    fxs_packed_scene_free(&packed);
    gaussians[0].position[1] = -FLT_MAX;
    gaussians[1].position[1] = 5;
    for (int i = 0; i < 3; i++)
        gaussians[1].rotation[i] = gaussians[1].rotation[3] = FLT_MAX;
    pack(2, 0);
    CHECK(report.packed == 2 && report.brought_in == 2 && fabs(report.low[1] + 1.34e8) < 50);
    fxs_packed_scene_free(&packed);
}

static void test_faults_above_the_degree_do_not_matter(void)
{
    make_gaussians(10);
    gaussians[5].sh[44] = NAN;
    pack(10, 2);
    CHECK(report.packed == 10 && report.dropped.not_finite == 0);
    fxs_packed_scene_free(&packed);
}

static void test_nothing_left(void)
{
    make_gaussians(5);
    for (int i = 0; i < 5; i++)
        gaussians[i].position[0] = NAN;
    CHECK(write_file(5, 0, 0) && pack_file(0) == FXS_ERR_FILE && message.text[0] && !packed.data &&
          !packed.allocation);
    CHECK(report.dropped.not_finite == 5);
}

static void test_empty_file(void)
{
    CHECK(!write_file(0, 0, 0) || (pack_file(0) == FXS_ERR_FILE && message.text[0]));
    FILE *stream = fopen(path, "wb");
    CHECK(stream && fclose(stream) == 0);
    CHECK(pack_file(0) == FXS_ERR_FILE && message.text[0]);
}

static void test_flags(void)
{
    fxs_scene scene;
    make_gaussians(3);
    CHECK(write_file(3, 2, 1) && pack_file(0) == 0 && fxs_scene_open(&scene, packed.data, packed.bytes) == 0);
    CHECK(scene.antialiased == 1 && scene.sh_degree == 2 && (uintptr_t)packed.data % 64 == 0);
    CHECK(packed.bytes == fxs_scene_bytes(3, 2, FXS_PROFILE_DEFAULT, 0));
    fxs_packed_scene_free(&packed);
    CHECK(!packed.data && !packed.allocation && packed.bytes == 0);
    fxs_packed_scene_free(&packed);
}

static void test_same_bytes_twice(void)
{
    make_gaussians(3000);
    pack(3000, 3);
    fxs_packed_scene first = packed;
    pack(3000, 3);
    CHECK(first.bytes == packed.bytes && memcmp(first.data, packed.data, first.bytes) == 0);
    fxs_packed_scene_free(&first);
    fxs_packed_scene_free(&packed);
}

static double largest[6], squares[6];

static void note_loss(int which, double error)
{
    largest[which] = fmax(largest[which], fabs(error));
    squares[which] += error * error;
}

static void compare_decoded(const decoded *d, const fxs_gaussian *g, int sh_degree)
{
    int order[3];
    find_order(order, g->scale);
    for (int k = 0; k < 3; k++) {
        note_loss(0, d->position[k] - (double)g->position[k]);
        note_loss(1, d->scale[k] - (double)g->scale[order[k]]);
        note_loss(4, d->dc[k] - (double)g->dc[k]);
    }
    note_loss(2, angle_of_word(d->rotation, d->axis_bits, g->rotation, order));
    note_loss(3, d->opacity - 1 / (1 + exp(-(double)g->opacity)));
    for (int k = 0; k < 3 * FXS_SH_COUNT(sh_degree); k++)
        note_loss(5, d->sh[k] - (double)g->sh[k]);
}

/* Compares the losses that packing reports with losses of values decoded by docs/format.md. */
static void check_loss(size_t count, int sh_degree)
{
    fxs_scene s = pack(count, sh_degree);
    const fxs_pack_error *most = &report.largest, *rms = &report.rms;
    const double said_most[6] = {most->position, most->scale, most->rotation, most->opacity, most->dc, most->sh};
    const double said_rms[6] = {rms->position, rms->scale, rms->rotation, rms->opacity, rms->dc, rms->sh};
    const double numbers[6] = {3, 3, 1, 1, 3, fmax(1, 3 * FXS_SH_COUNT(sh_degree))};
    CHECK(s.profile == profile && s.sh_degree == sh_degree && packed.bytes == bytes_said);
    memset(largest, 0, sizeof largest);
    memset(squares, 0, sizeof squares);
    for (uint32_t i = 0; i < s.count; i++) {
        const decoded d = decode(&s, i);
        compare_decoded(&d, source_at(d.position, count), sh_degree);
    }
    for (int i = 0; i < 6; i++) {
        double of_all = sqrt(squares[i] / numbers[i] / (double)count);
        const double own = i == 5 && profile != FXS_PROFILE_DEFAULT ? 0.002 : 1e-7;
        if (!CHECK(fabs(largest[i] - said_most[i]) < 1e-3 * largest[i] + own) ||
            !CHECK(fabs(of_all - said_rms[i]) < 1e-2 * of_all + own / 10))
            printf("  profile %d, degree %d, %d: %g %g, said %g %g\n", profile, sh_degree, i, largest[i], of_all,
                   said_most[i], said_rms[i]);
    }
    fxs_packed_scene_free(&packed);
}

static void test_loss_of_each_profile(void)
{
    make_gaussians(1500);
    for (int i = 0; i < 3; i++)
        for (int degree = 0; degree <= 3; degree++) {
            profile = (enum fxs_profile)i;
            check_loss(1500, degree);
        }
    profile = FXS_PROFILE_DEFAULT;
}

static int is_near(double x, double expected)
{
    return fabs(x - expected) <= 2e-6 * fmax(1, fabs(expected));
}

/* Reads a packed scene back as a scene file. A change of any byte of the file must be detected. */
static void check_read_back(size_t count, int sh_degree, enum fxs_profile which)
{
    static fxs_gaussian read[1000];
    fxs_scene s;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message m;
    profile = which;
    make_gaussians(count);
    if (!CHECK(write_file(count, sh_degree, 1)) || !CHECK(pack_file(0) == 0))
        return;
    CHECK(!fxs_file_seal(packed.data, packed.bytes) && !fxs_scene_open(&s, packed.data, packed.bytes));
    if (!CHECK(!fxs_scene_file_open_memory("x.fxs", packed.data, packed.bytes, NULL, &file, &info, &m)))
        return;
    CHECK(info.count == s.count && info.sh_degree == sh_degree && info.antialiased && !strcmp(info.format, "fxs"));
    for (int pass = 0; pass < 2; pass++) {
        CHECK(fxs_scene_file_read(file, read, 1, &m) == 1);
        CHECK(fxs_scene_file_read(file, read + 1, 999, &m) == (long)s.count - 1);
        CHECK(fxs_scene_file_read(file, read, 1, &m) == 0 && !fxs_scene_file_rewind(file, &m));
    }
    CHECK(fxs_scene_file_read(file, read, 1000, &m) == (long)s.count);
    int wrong = 0;
    for (uint32_t i = 0; i < s.count; i++) {
        const decoded d = decode(&s, i);
        const double opacity = 1 / (1 + exp(-(double)read[i].opacity));
        for (int k = 0; k < 3; k++)
            wrong += !is_near(read[i].position[k], d.position[k]) || !is_near(read[i].scale[k], d.scale[k]) ||
                     !is_near(read[i].dc[k], d.dc[k]);
        wrong += !(angle_of_word(d.rotation, d.axis_bits, read[i].rotation, (const int[3]){0, 1, 2}) < 0.02);
        for (int k = 0; k < 45; k++)
            wrong += !is_near(read[i].sh[k], d.sh[k]);
        wrong += !(fabs(opacity - d.opacity) < 1e-6);
    }
    CHECK(wrong == 0);
    fxs_scene_file_close(file);
    for (size_t at = 0; at < packed.bytes; at += at < 400 ? 1 : 97) {
        unsigned char *bytes = packed.data;
        bytes[at] ^= 16;
        int error = fxs_scene_file_open_memory("x.fxs", bytes, packed.bytes, NULL, &file, &info, &m);
        if (!error)
            error = fxs_scene_file_read(file, read, 1000, &m) < 0;
        CHECK(error);
        fxs_scene_file_close(file);
        bytes[at] ^= 16;
    }
    fxs_packed_scene_free(&packed);
}

static void test_read_back(void)
{
    for (int which = FXS_PROFILE_DEFAULT; which <= FXS_PROFILE_SMALL; which++)
        for (int degree = 0; degree <= 3; degree++)
            check_read_back(degree == 2 ? 512 : 600, degree, (enum fxs_profile)which);
    profile = FXS_PROFILE_DEFAULT;
}

static void test_loss_of_huge_sh(void)
{
    make_gaussians(1500);
    gaussians[700].sh[20] = 1000;
    for (int i = 1; i < 3; i++) {
        profile = (enum fxs_profile)i;
        check_loss(1500, 3);
    }
    profile = FXS_PROFILE_DEFAULT;
}

static void test_few_bits_are_kept(void)
{
    static const char *const names[] = {"luma-seal/luma-seal.splat", "kitchen-marble/kitchen-marble.spz"};
    const char *folder = getenv("FXS_SCENES");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[1000];
        snprintf(name, sizeof name, "%s/%s", folder ? folder : "../shared/scenes", names[i]);
        if (access(name, R_OK) || pack_with(name, 0, 0))
            SKIP(access(name, R_OK) ? "no real scenes here" : message.text);
        CHECK(report.largest.dc * 0.28209479177387814 < 2e-4 && report.largest.opacity < 1e-6);
        fxs_packed_scene_free(&packed);
    }
    fxs_scene_writer *writer;
    make_gaussians(2000);
    if (open_spz(path, 4, 2000, 3, 0, &writer, &message))
        SKIP(message.text);
    CHECK(fxs_scene_writer_put(writer, gaussians, 2000, &message) == 0);
    CHECK(close_writer(writer, &message) == 0 && pack_file(0) == 0);
    CHECK(report.largest.sh < 1e-7 && report.largest.dc * 0.28209479177387814 < 2e-4);
    fxs_packed_scene_free(&packed);
}

static void set_opacity(fxs_gaussian *g, double opacity)
{
    g->opacity = (float)log(opacity / (1 - opacity));
}

static uint32_t opacity_code(const fxs_scene *scene, uint32_t i)
{
    return word_at(scene, i, FXS_ROW_COLOUR) >> 24;
}

/* Opacity codes have several ranges. A chunk (256 Gaussians) gets the finest range that covers its largest
   opacity. */
static void test_faint_chunks_get_fine_steps(void)
{
    for (uint32_t law = 1; law < FXS_OPACITY_LAWS; law++) {
        const double least = 1 / 255.0, top = ldexp(1, 2 - 2 * (int)law), range = 0.99 * top - least;
        uint32_t unseen = 0;
        make_gaussians(256);
        for (int i = 0; i < 256; i++)
            set_opacity(&gaussians[i], i < 9 ? 0.0039 : least + range * pow((i - 8) / 247.0, 2));
        const fxs_scene scene = pack(256, 0);
        CHECK(chunk_of(&scene, 0)->opacity_law == law);
        for (uint32_t i = 0; i < 256; i++)
            unseen += opacity_code(&scene, i) == 0;
        CHECK(unseen == 9 && report.rms.opacity < 0.002 * top + 0.001);
        CHECK(report.largest.opacity > 0.0038 && report.largest.opacity < fmax(0.00391, 1.01 * top / 254));
        fxs_packed_scene_free(&packed);
    }
}

/* Packing minimises squared opacity errors, weighed by 1/opacity. In a chunk with half its Gaussians opaque, the
   faint half decides the opacity range. */
static void test_faint_half_decides_on_the_law(void)
{
    make_gaussians(256);
    for (int i = 0; i < 256; i++)
        set_opacity(&gaussians[i], i % 2 ? uniform(0.018, 0.022) : uniform(0.85, 0.95));
    const fxs_scene scene = pack(256, 0);
    CHECK(chunk_of(&scene, 0)->opacity_law == 1);
    fxs_packed_scene_free(&packed);
}

static void test_offsets_of_codes(void)
{
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS; law++)
        for (uint32_t code = 0; code < 256; code++) {
            const double offset = -2 * log(opacity_of(code, law)) * 2048;
            CHECK(code == 0 ? fxs_offset_of_code_q11[law][code] == 65535
                            : fabs(fxs_offset_of_code_q11[law][code] - offset) < 0.5001);
        }
}

/* An SH palette must have the most entries with which the scene keeps its limit of bytes for each Gaussian. */
static void check_entries(uint32_t count, enum fxs_profile which, int degree)
{
    const uint64_t limit = (uint64_t)count * (which == FXS_PROFILE_SMALL ? 20 : 40);
    const uint32_t entries = fxs_palette_entries_for(count, fxs_chunks_of(count), which, degree);
    const uint32_t least = (count < 10000 ? 2 * count / 5 : count / 10) / (48 * fxs_palette_stages(which, degree));
    const uint32_t floored = least < 1 ? 1 : least > 128 ? 128 : least;
    if (!CHECK(entries >= 1 && entries <= 128) ||
        !CHECK(entries == floored || fxs_scene_bytes(count, degree, which, entries) <= limit) ||
        !CHECK(entries >= floored) ||
        !CHECK(entries == 128 || fxs_scene_bytes(count, degree, which, entries + 1) + 128 > limit))
        printf("  %u entries for %u, profile %d, degree %d\n", entries, count, which, degree);
}

static void test_entries_of_a_palette(void)
{
    for (int which = 1; which < 3; which++) {
        CHECK(fxs_palette_entries_for(1000000, 3907, (enum fxs_profile)which, 0) == 0);
        for (int degree = 1; degree <= 3; degree++) {
            CHECK(fxs_palette_entries_for(1, 1, (enum fxs_profile)which, degree) == 1);
            CHECK(fxs_palette_entries_for(1000000, 3907, (enum fxs_profile)which, degree) == 128);
            for (uint32_t count = 1; count < 2000000; count += count / 10 + 1)
                check_entries(count, (enum fxs_profile)which, degree);
        }
    }
    CHECK(fxs_palette_entries_for(1000000, 3907, FXS_PROFILE_DEFAULT, 3) == 0);
}

static double sh_loss(fxs_scene *s, size_t count, int degree, enum fxs_profile which)
{
    profile = which;
    *s = pack(count, degree);
    profile = FXS_PROFILE_DEFAULT;
    return report.rms.sh;
}

static void check_sh_loss(const char *what, size_t count, int degree, enum fxs_profile which, double most)
{
    fxs_scene s;
    const double loss = sh_loss(&s, count, degree, which);
    if (!CHECK(loss < most))
        printf("  %s, profile %d, degree %d, %u entries: %.5f\n", what, which, degree, s.palette_entries, loss);
    fxs_packed_scene_free(&packed);
}

static void test_means_of_chunks(void)
{
    enum { CLUSTERS = 32, COUNT = CLUSTERS * FXS_CHUNK };
    float own[45];
    make_gaussians(COUNT);
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 45; k++) {
            own[k] = i % FXS_CHUNK ? own[k] : uniform(-0.4, 0.4);
            gaussians[i].sh[k] = own[k] + uniform(-0.01, 0.01);
        }
        for (int k = 0; k < 3; k++)
            gaussians[i].position[k] = uniform(-0.1, 0.1) + (float)(4 * (i / FXS_CHUNK >> 2 * k & 3));
    }
    check_sh_loss("means", COUNT, 3, FXS_PROFILE_SMALL, 0.0052);
    check_sh_loss("means", COUNT, 3, FXS_PROFILE_COMPACT, 0.0021);
}

static void test_palettes_are_good(void)
{
    enum { COUNT = 20000 };
    const fxs_procedural_scene *knot = fxs_procedural_find("knot");
    for (uint64_t i = 0; i < COUNT; i++)
        knot->gaussian(i, COUNT, 1, &gaussians[i]);
    check_sh_loss("knot", COUNT, 3, FXS_PROFILE_SMALL, 0.0446);
    check_sh_loss("knot", COUNT, 3, FXS_PROFILE_COMPACT, 0.0130);
    check_sh_loss("knot", COUNT, 2, FXS_PROFILE_COMPACT, 0.0060);
    check_sh_loss("knot", COUNT, 1, FXS_PROFILE_SMALL, 0.0150);
    for (int k = 0; k < 45; k++)
        gaussians[77].sh[k] = 0.3f;
    for (int k = 0; k < 45; k++)
        gaussians[4321].sh[k] = k % 2 ? 3 : -3;
    check_sh_loss("a wild one", COUNT, 3, FXS_PROFILE_SMALL, 0.0456);
}

enum { ALIKE, SIZES, OPACITIES, FLAT, MIXTURES };

static int matters(int mixture, double scale, double opacity)
{
    return mixture == SIZES ? scale > -4 : mixture == OPACITIES ? opacity > 0.5 : 1;
}

/* Returns the squared length of the summed SH errors over a chunk (256 Gaussians) that starts at Gaussian
   `first`. */
static double cancelled(const fxs_scene *s, uint32_t first, size_t count, int mixture)
{
    double sums[9] = {0}, square = 0;
    for (uint32_t i = first; i < first + FXS_CHUNK; i++) {
        const decoded d = decode(s, i);
        const fxs_gaussian *g = source_at(d.position, count);
        for (int k = 0; k < 9 && matters(mixture, d.scale[0], d.opacity); k++)
            sums[k] += d.sh[k] - (double)g->sh[k];
    }
    for (int k = 0; k < 9; k++)
        square += sums[k] * sums[k] / 9;
    return square;
}

/* Packing chooses SH codes so that the errors of neighbouring Gaussians cancel. The sum over a chunk (256
   Gaussians) must be small. */
static void check_cancelling(int mixture, double most)
{
    enum { COUNT = 8 * FXS_CHUNK };
    fxs_scene s;
    double square = 0;
    make_gaussians(COUNT);
    for (int i = 0; i < COUNT; i++) {
        const int odd = i % 2;
        for (int k = 0; k < 3; k++) {
            gaussians[i].position[k] = uniform(-0.001, 0.001);
            gaussians[i].scale[k] = mixture == SIZES && odd ? -6 : mixture == FLAT && odd && k == 1 ? -8 : -2;
        }
        set_opacity(&gaussians[i], mixture == OPACITIES && odd ? 0.03 : 0.9);
    }
    const double loss = sh_loss(&s, COUNT, 1, FXS_PROFILE_SMALL);
    profile = FXS_PROFILE_SMALL;
    for (uint32_t first = 0; first < COUNT; first += FXS_CHUNK)
        square += cancelled(&s, first, COUNT, mixture) / 8;
    profile = FXS_PROFILE_DEFAULT;
    if (!CHECK(sqrt(square) < most * loss))
        printf("  mixture %d: %.2f times one, %.4f\n", mixture, sqrt(square) / loss, loss);
    fxs_packed_scene_free(&packed);
}

static void test_errors_of_sh_cancel(void)
{
    static const double most[MIXTURES] = {2, 1.5, 1.1, 2};
    for (int mixture = 0; mixture < MIXTURES; mixture++)
        check_cancelling(mixture, most[mixture]);
}

/* live: number of allocated memory blocks; failing: index of the allocation that fails */
static int live, allocations, failing;

static fxs_sh_loss code_chunks(unsigned cpu, const fxs_palette *p, const fxs_sh_item *items, uint32_t count,
                               int8_t mean[48], unsigned char *records)
{
    fxs_sh_loss loss = {0, 0};
    for (uint32_t first = 0; first < MAX_COUNT; first += FXS_CHUNK)
        fxs_pack_stages_choose(cpu)->code_chunk(p, items + first, count, mean, records + first * FXS_RECORD_BYTES,
                                                FXS_RECORD_BYTES, &loss);
    return loss;
}

static void check_stages(const fxs_sh_item *items, enum fxs_profile which, int degree, uint32_t entries)
{
    static unsigned char records[2][(MAX_COUNT + FXS_CHUNK) * FXS_RECORD_BYTES];
    static fxs_palette p;
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = fxs_run_here};
    int8_t mean[2][48];
    memset(&p, 0, sizeof p);
    p.profile = which;
    p.sh_degree = degree;
    CHECK(fxs_palette_learn(&p, entries, items, MAX_COUNT, &options, &message) == 0);
    const fxs_sh_loss plain = code_chunks(0, &p, items, FXS_CHUNK - entries, mean[0], records[0]);
    const fxs_sh_loss best = code_chunks(~0u, &p, items, FXS_CHUNK - entries, mean[1], records[1]);
    CHECK(!memcmp(mean[0], mean[1], sizeof mean[0]));
    CHECK(!memcmp(records[0], records[1], sizeof records[0]));
    CHECK(plain.largest == best.largest && plain.squares == best.squares && plain.largest > 0);
    const fxs_palette *learned = &p;
    const fxs_sh_vector *groups = learned->groups[0];
    for (uint32_t count = 1; count <= 16; count++)
        CHECK(fxs_pack_stages_choose(0)->nearest(groups, p.group_squares[0], count, learned->vectors[1][count]) ==
              fxs_pack_stages_choose(~0u)->nearest(groups, p.group_squares[0], count, learned->vectors[1][count]));
}

static void test_stages(void)
{
    static const uint32_t entries[] = {1, 2, 9, 23, 77, 128};
    fxs_sh_item *items = calloc(MAX_COUNT + FXS_CHUNK, sizeof *items);
    printf("  %s\n", fxs_pack_stages_choose(~0u)->name);
    make_gaussians(MAX_COUNT);
    for (int degree = 1; degree <= 3; degree++) {
        for (size_t i = 0; i < MAX_COUNT; i++)
            fxs_sh_item_set(&items[i], &gaussians[i], fxs_opacity_of_logit(gaussians[i].opacity), degree);
        for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
            check_stages(items, i % 2 ? FXS_PROFILE_COMPACT : FXS_PROFILE_SMALL, degree, entries[i]);
    }
    free(items);
}

static void run_stages(unsigned cpu, enum fxs_profile which, int degree, double *numbers, fxs_chunk_ranges *ranges,
                       unsigned char *records, fxs_loss *loss)
{
    const fxs_pack_stages *stages = fxs_pack_stages_choose(cpu);
    const fxs_encoder encoder = {which, degree};
    fxs_chunk chunk;
    for (uint32_t i = 0; i < MAX_COUNT; i++)
        numbers[i] = -(double)gaussians[i].opacity * (i % 100 ? 1 : 200);
    stages->exponentials(numbers, MAX_COUNT - 3);
    for (uint32_t first = 0; first < MAX_COUNT; first += FXS_CHUNK) {
        const uint32_t end = first + FXS_CHUNK < MAX_COUNT ? first + FXS_CHUNK : MAX_COUNT;
        fxs_ranges_clear(ranges);
        for (uint32_t i = first; i < end; i++)
            stages->take_ranges(ranges, &gaussians[i], 1 / (1 + numbers[i]), degree);
        fxs_encode_header(&chunk, ranges++, &(fxs_scene_file_info){.count = 0});
        for (uint32_t i = first; i < end; i++)
            stages->encode(&encoder, &chunk, &gaussians[i], 1 / (1 + numbers[i]), records + i * FXS_RECORD_BYTES, loss);
    }
}

static void test_stages_of_codes(void)
{
    static double numbers[2][MAX_COUNT];
    static fxs_chunk_ranges ranges[2][MAX_COUNT / FXS_CHUNK + 1];
    static unsigned char records[2][MAX_COUNT * FXS_RECORD_BYTES];
    make_gaussians(MAX_COUNT);
    for (uint32_t i = 0; i < MAX_COUNT; i++) {
        gaussians[i].opacity -= (float)(i / FXS_CHUNK % 8);
        if (i / FXS_CHUNK == 3)
            gaussians[i] = gaussians[3 * FXS_CHUNK];
    }
    for (int degree = 0; degree <= 3; degree++)
        for (int which = 0; which <= FXS_PROFILE_SMALL; which++) {
            fxs_loss loss[2] = {{{0}, {0}}};
            memset(records, 0, sizeof records);
            for (int k = 0; k < 2; k++)
                run_stages(k ? ~0u : 0, (enum fxs_profile)which, degree, numbers[k], ranges[k], records[k], &loss[k]);
            CHECK(!memcmp(numbers[0], numbers[1], sizeof numbers[0]));
            CHECK(!memcmp(ranges[0], ranges[1], sizeof ranges[0]));
            CHECK(!memcmp(records[0], records[1], sizeof records[0]));
            CHECK(!memcmp(&loss[0], &loss[1], sizeof *loss));
        }
    for (uint32_t i = 0; i < MAX_COUNT - 3; i++)
        CHECK(numbers[1][i] == fxs_exp(-(double)gaussians[i].opacity * (i % 100 ? 1 : 200)));
}

/* Merges Gaussians into at most `most` Gaussians. into: index of the merged Gaussian for each source Gaussian. */
static uint32_t coarsen(unsigned cpu, uint32_t first, uint32_t count, uint32_t most, fxs_coarse *out, uint16_t *into,
                        fxs_merge_error *sums)
{
    static fxs_coarse set[FXS_MERGE_MOST];
    fxs_merger *merger = malloc(fxs_merger_bytes());
    fxs_merge_error none;
    for (uint32_t i = 0; i < count; i++)
        fxs_coarse_set(&set[i], &gaussians[first + i]);
    *sums = (fxs_merge_error){0, 0};
    fxs_merge_begin(merger, 3);
    fxs_merge_add(merger, set, count);
    fxs_pack_stages_choose(cpu)->coarsen(merger, most, sums);
    const uint32_t left = fxs_merge_end(merger, count, out, &none);
    fxs_merge_into(merger, into);
    free(merger);
    return left;
}

static void test_stages_of_merging(void)
{
    static fxs_coarse out[2][FXS_MERGE_MOST];
    static uint16_t into[2][FXS_MERGE_MOST];
    fxs_merge_error sums[2];
    make_gaussians(8 * FXS_MERGE_MOST);
    for (uint32_t i = 0; i < 100; i++)
        memcpy(gaussians[i].position, gaussians[0].position, sizeof gaussians[0].position);
    for (uint32_t set = 0; set < 8; set++) {
        const uint32_t count = FXS_MERGE_MOST - 67 * set, most = set % 2 ? count / 4 : count / 2;
        memset(out, 0, sizeof out);
        for (int k = 0; k < 2; k++)
            CHECK(coarsen(k ? ~0u : 0, set * FXS_MERGE_MOST, count, most, out[k], into[k], &sums[k]) == most);
        CHECK(!memcmp(out[0], out[1], most * sizeof *out[0]) && !memcmp(into[0], into[1], count * sizeof *into[0]));
        CHECK(!memcmp(&sums[0], &sums[1], sizeof *sums) && sums[0].error > 0);
    }
}

static void *count_allocation(void *argument, size_t bytes)
{
    (void)argument;
    void *block = allocations++ == failing ? NULL : malloc(bytes);
    live += block != NULL;
    return block;
}

static void count_release(void *argument, void *block)
{
    (void)argument;
    live--;
    free(block);
}

static void test_every_allocation_fails(void)
{
    static const fxs_allocator counting = {count_allocation, count_release, 0};
    make_gaussians(1000);
    CHECK(write_file(1000, 1, 0));
    allocator = &counting;
    profile = FXS_PROFILE_COMPACT;
    int result = -1;
    for (failing = 0; result && failing < 100; failing++) {
        allocations = 0;
        result = pack_with(path, 2, 0);
        CHECK(live == (result == 0) && (result == 0 || strstr(message.text, "out of memory")));
    }
    CHECK(result == 0 && failing > 8);
    fxs_packed_scene_free(&packed);
    CHECK(live == 0);
    allocator = NULL;
    profile = FXS_PROFILE_DEFAULT;
}

static const uint32_t thread_counts[] = {0, 1, 2, 4, 7};

enum { THREAD_COUNTS = sizeof thread_counts / sizeof *thread_counts };

static void check_threads(const char *name)
{
    fxs_packed_scene first = {0, 0, 0, 0};
    fxs_pack_report first_report = {0};
    for (int i = 0; i < THREAD_COUNTS; i++) {
        if (!CHECK(pack_with(name, thread_counts[i], 0) == 0)) {
            printf("  %s\n", message.text);
            continue;
        }
        if (!first.data) {
            first = packed;
            first_report = report;
            continue;
        }
        CHECK(first.bytes == packed.bytes && memcmp(first.data, packed.data, first.bytes) == 0);
        CHECK(memcmp(&first_report, &report, sizeof report) == 0);
        fxs_packed_scene_free(&packed);
    }
    fxs_packed_scene_free(&first);
}

static void test_threads_learning_a_palette(void)
{
    make_gaussians(MAX_COUNT);         /* many Gaussians, since smaller scenes have SH palettes of minimum size */
    CHECK(write_file(MAX_COUNT, 2, 0));
    for (int i = 1; i < 3; i++) {
        profile = (enum fxs_profile)i;
        check_threads(path);
        CHECK(report.packed == MAX_COUNT && report.rms.sh > 0);
    }
    profile = FXS_PROFILE_DEFAULT;
}

static void test_threads(void)
{
    make_gaussians(MAX_COUNT);
    for (size_t i = 0; i < MAX_COUNT; i += 1009)
        memset(gaussians[i].rotation, 0, sizeof gaussians[i].rotation);
    for (size_t i = 0; i < MAX_COUNT; i += 977)
        gaussians[i].rotation[i % 4] = NAN;
    CHECK(write_file(MAX_COUNT, 3, 0));
    check_threads(path);
    CHECK(report.dropped.not_finite == 41 && report.dropped.rotation == 39);
}

static void test_threads_on_real_scenes(void)
{
    static const char *const names[] = {"boatyard-tile3/boatyard-tile3.ply", "guitar/guitar.compressed.ply",
                                        "luma-seal/luma-seal.splat", "snowmiku/snowmiku.ply",
#ifdef FXS_WITH_ZLIB
                                        "kitchen-marble/kitchen-marble.spz"
#endif
    };
    const char *folder = getenv("FXS_SCENES");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[1000];
        snprintf(name, sizeof name, "%s/%s", folder ? folder : "../shared/scenes", names[i]);
        if (access(name, R_OK))
            SKIP("no real scenes here");
        check_threads(name);
    }
}

enum { EVEN, EQUAL, LINE, DOUBLING, GRID, KINDS };

static float coordinate(int kind, uint32_t i, int axis)
{
    return kind == EQUAL      ? 3
           : kind == LINE     ? (axis == 0 ? (float)i : 0)
           : kind == DOUBLING ? ldexpf(uniform(-1, 1), (int)(i % 28))
           : kind == GRID     ? floorf(uniform(-6, 6))
           : i % 11 == 5      ? 134000000
           : i % 13 == 5      ? -134000000
                              : uniform(-6, 6);
}

static fxs_order_entry *order(uint32_t count, uint32_t threads, int kind)
{
    static fxs_order_entry entries[MAX_COUNT];
    fxs_pool *pool = fxs_pool_create(threads);
    const fxs_pack_options options = {.size = sizeof options, .workers = {fxs_pool_run, pool, threads}};
    seed = count;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++)
            entries[i].position[k] = coordinate(kind, i, k);
        entries[i].index = 0;
        if (i % 7 == 3)
            entries[i].position[0] = NAN;
    }
    CHECK(pool && fxs_order(entries, count, 0, &options) == 0);
    fxs_pool_destroy(pool);
    return entries;
}

/* Checks the order in which packing stores Gaussians. Dropped Gaussians must come last. */
static void check_order(uint32_t count, uint32_t threads, int kind)
{
    static unsigned char seen[MAX_COUNT];
    static uint32_t indexes[MAX_COUNT];
    const fxs_order_entry *entries = order(count, 1, kind);
    memset(seen, 0, sizeof seen);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t index = indexes[i] = entries[i].index;
        CHECK(index < count && !seen[index]++);
        CHECK(i == 0 || (indexes[i - 1] % 7 == 3) <= (index % 7 == 3));
    }
    entries = order(count, threads, kind);
    for (uint32_t i = 0; i < count; i++)
        CHECK(entries[i].index == indexes[i]);
}

static void test_order(void)
{
    static const uint32_t counts[] = {1, 2, 3, 5, 100, 4099, MAX_COUNT};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (int k = 1; k < THREAD_COUNTS; k++)
            for (int kind = 0; kind < KINDS; kind++)
                check_order(counts[i], thread_counts[k], kind);
}

static void run_in_turn(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

static void test_likes_are_together(void)
{
    enum { COUNT = 1000, OTHERS = 666 };
    static fxs_order_entry entries[COUNT];
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run_in_turn, .workers.count = 1};
    for (int all = 0; all < 3; all++) {
        uint32_t seen[2] = {0, 0};
        seed = 6;
        for (uint32_t i = 0; i < COUNT; i++) {
            for (int k = 0; k < 3; k++)
                entries[i].position[k] = uniform(-1, 1);
            entries[i].index = all == 2 || (all == 1 && i % 3 == 0);
        }
        CHECK(fxs_order(entries, COUNT, 0, &options) == 0);
        for (uint32_t i = 0; i < COUNT; i++) {
            CHECK(entries[i].index < COUNT);
            seen[i >= 3 * FXS_CHUNK] += entries[i].index % 3 != 0;
        }
        CHECK(all != 1 || (seen[0] == OTHERS && seen[1] == 0));
        CHECK(all == 1 || seen[1] > 100);
    }
}

/* Packs 200 strays among 10,184 Gaussians, up to 2^20 units away. They must share 1 of the 40 chunks (256
   Gaussians each). */
static void test_strays_are_apart(void)
{
    enum { STRAYS = 200, COUNT = 39 * FXS_CHUNK + STRAYS };
    static fxs_order_entry entries[COUNT];
    static uint8_t is_stray[COUNT];
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run_in_turn, .workers.count = 1};
    int wide = 0;
    seed = 5;
    for (uint32_t i = 0; i < COUNT; i++) {
        is_stray[i] = i % 50 == 7 && i / 50 < STRAYS;
        for (int k = 0; k < 3; k++)
            entries[i].position[k] = uniform(-1, 1);
        if (is_stray[i])
            entries[i].position[i % 3] = ldexpf(i % 2 ? -1 : 1, 5 + (int)(i / 50 % 16));
    }
    CHECK(fxs_order(entries, COUNT, 0, &options) == 0);
    for (uint32_t first = 0; first < COUNT; first += FXS_CHUNK) {
        int strays = 0;
        for (uint32_t i = first; i < COUNT && i < first + FXS_CHUNK; i++)
            strays += is_stray[entries[i].index];
        wide += strays > 0;
    }
    CHECK(wide == 1);
}

static void test_no_stray_is_missed(void)
{
    enum { COUNT = 156 * FXS_CHUNK };
    static fxs_order_entry entries[COUNT];
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run_in_turn, .workers.count = 1};
    uint32_t strays = 0, before = 0;
    seed = 6;
    for (uint32_t i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++)
            entries[i].position[k] = uniform(-1, 1) * (i % 10 == 5 && i < 10 * FXS_CHUNK ? 1000 : 1);
    CHECK(fxs_order(entries, COUNT, 0, &options) == 0);
    for (uint32_t at = 0; at < COUNT; at++) {
        const uint32_t i = entries[at].index;
        const int is_stray = i % 10 == 5 && i < 10 * FXS_CHUNK;
        CHECK(!is_stray || strays == 0 || at == before + 1);
        CHECK(!is_stray || strays > 0 || at % FXS_CHUNK == 0);
        before = is_stray ? at : before;
        strays += (uint32_t)is_stray;
    }
    CHECK(strays == FXS_CHUNK);
}

static void test_clusters_are_apart(void)
{
    enum { CLUSTERS = 20, COUNT = 60 * FXS_CHUNK };
    static fxs_order_entry entries[COUNT];
    static uint8_t cluster[COUNT];
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run_in_turn, .workers.count = 1};
    uint32_t n = 0;
    seed = 7;
    for (uint32_t c = 0; c < CLUSTERS; c++)
        for (uint32_t end = n + (1 + 2 * c % 5) * FXS_CHUNK; n < end; n++)
            for (int k = 0; k < 3; k++) {
                entries[n].position[k] = uniform(-1, 1) + 100 * (float)(k == 0 ? c / 4 : k == 1 ? c % 4 : 0);
                cluster[n] = (uint8_t)c;
            }
    CHECK(n % FXS_CHUNK == 0 && fxs_order(entries, n, 0, &options) == 0);
    for (uint32_t i = 1; i < n; i++)
        CHECK(i % FXS_CHUNK == 0 || cluster[entries[i].index] == cluster[entries[i - 1].index]);
}

static void test_chunks_are_small(void)
{
    make_gaussians(MAX_COUNT);
    fxs_scene scene = pack(MAX_COUNT, 0);
    double side = 0;
    for (uint32_t i = 0; i < scene.chunk_count; i++)
        for (int k = 0; k < 3; k++)
            side += ldexp(chunk_of(&scene, i * FXS_CHUNK)->step_q32[k], -32) * 65535 / (3 * scene.chunk_count);
    if (!CHECK(side < 6))
        printf("  %.2f units\n", side);
    fxs_packed_scene_free(&packed);
}

static void make_strays(void)
{
    static const float away[] = {24569, 763, 146, 87, 80};
    static const uint32_t ranks[] = {1, 8, 32, 128, 256};
    for (uint32_t i = 0, k = 0; i < 256; i++) {
        k += i >= ranks[k];
        fxs_gaussian *g = &gaussians[MAX_COUNT - 1 - i];
        const float x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(0.2, 1);
        const float far = away[k] / hypotf(hypotf(x, y), z);
        g->position[0] = x * far;
        g->position[1] = y * far;
        g->position[2] = z * far;
    }
}

static long read_back(fxs_gaussian *to)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    long count = 0, n = 1;
    if (fxs_file_write(path, packed.data, packed.bytes, &message) ||
        fxs_scene_file_open(path, NULL, &file, &info, &message))
        return FXS_ERR_SCENE;
    for (; n > 0 && count < MAX_COUNT; count += n > 0 ? n : 0)
        n = fxs_scene_file_read(file, to + count, (size_t)(MAX_COUNT - count) < 777 ? 1 : 777, &message);
    n = n > 0 ? fxs_scene_file_read(file, to, 1, &message) : n;
    fxs_scene_file_close(file);
    return n < 0 ? n : count != (long)info.count ? FXS_ERR_SCENE : count;
}

static void set_holes(int32_t more)
{
    fxs_packed_header header;
    memcpy(&header, packed.data, sizeof header);
    fxs_packed_header_turn(&header);
    header.holes += (uint32_t)more;
    fxs_packed_header_turn(&header);
    memcpy(packed.data, &header, sizeof header);
}

static void test_strays_have_chunks(void)
{
    static fxs_gaussian back[MAX_COUNT];
    for (profile = FXS_PROFILE_DEFAULT; profile <= FXS_PROFILE_SMALL; profile++) {
        const float share = profile == FXS_PROFILE_SMALL ? 1 / 150.f : 1 / 1500.f;
        make_gaussians(MAX_COUNT);
        make_strays();
        fxs_scene scene = pack(MAX_COUNT, 1);
        const uint32_t more = scene.chunk_count - fxs_chunks_of(MAX_COUNT);
        CHECK(scene.count == MAX_COUNT && more > 0 && more < 8);
        CHECK(packed.bytes <= bytes_said + more * (sizeof(fxs_chunk) + scene.chunk_bytes));
        CHECK(packed.bytes <= MAX_COUNT * (profile == FXS_PROFILE_SMALL ? 20u : 40u));
        if (CHECK(read_back(back) == MAX_COUNT))
            for (uint32_t i = MAX_COUNT - 256; i < MAX_COUNT; i++) {
                const float *p = gaussians[i].position, reach = hypotf(hypotf(p[0], p[1]), p[2]);
                float nearest = INFINITY;
                for (uint32_t k = 0; k < MAX_COUNT; k++) {
                    const float *q = back[k].position;
                    nearest = fminf(nearest, hypotf(hypotf(p[0] - q[0], p[1] - q[1]), p[2] - q[2]));
                }
                if (!CHECK(nearest < share * reach))
                    printf("  profile %d: %g units of %g away\n", profile, nearest, reach);
            }
        set_holes(1);
        CHECK(read_back(back) < 0 && strstr(message.text, "damaged"));
        set_holes(-2);
        CHECK(read_back(back) < 0 && strstr(message.text, "damaged"));
        set_holes(0x40000000);
        CHECK(fxs_scene_open(&scene, packed.data, packed.bytes) == FXS_ERR_SCENE);
        fxs_packed_scene_free(&packed);
    }
    profile = FXS_PROFILE_DEFAULT;
}

struct calls {
    int count, stop_at, ordered;
    double last;
};

static int count_call(void *argument, double done)
{
    struct calls *calls = argument;
    calls->ordered = calls->ordered && done >= calls->last && done <= 1;
    calls->last = done;
    return ++calls->count == calls->stop_at;
}

static void check_progress(uint32_t threads)
{
    struct calls all = {0, -1, 1, 0};
    CHECK(pack_with(path, threads, &(fxs_progress){count_call, &all}) == 0);
    CHECK(all.ordered && all.count >= 3 && all.last > 0.5);
    fxs_packed_scene_free(&packed);
    for (int stop = 1; stop <= all.count; stop++) {
        struct calls calls = {0, stop, 1, 0};
        CHECK(pack_with(path, threads, &(fxs_progress){count_call, &calls}) == FXS_ERR_STOPPED && calls.count == stop);
        CHECK(!packed.data && !packed.allocation && !strcmp(message.text, "import stopped"));
    }
}

static void check_held(uint32_t chunks)
{
    fxs_packed_scene all;
    fxs_pack_report said;
    CHECK(pack_with(path, 2, 0) == 0);
    all = packed;
    said = report;
    held = chunks;
    CHECK(pack_with(path, 2, 0) == 0);
    CHECK(packed.bytes == all.bytes && !memcmp(packed.data, all.data, all.bytes));
    CHECK(report.largest.sh == said.largest.sh && fabs(report.rms.sh - said.rms.sh) < 1e-9 * said.rms.sh);
    CHECK(report.largest.dc == said.largest.dc && fabs(report.rms.dc - said.rms.dc) < 1e-9 * said.rms.dc);
    fxs_packed_scene_free(&all);
    fxs_packed_scene_free(&packed);
    held = 0;
}

static void test_readings_for_codes(void)
{
    make_gaussians(2500);
    CHECK(write_file(2500, 3, 0));
    for (int i = FXS_PROFILE_COMPACT; i <= FXS_PROFILE_SMALL; i++) {
        profile = (enum fxs_profile)i;
        check_held(1);
        check_held(4);
        held = 3;
        check_progress(0);
        held = 0;
    }
    profile = FXS_PROFILE_DEFAULT;
}

static void test_sample(void)
{
    static const uint32_t counts[] = {1, 300, 16384 * 256, 16384 * 256 + 1, 16384 * 300 + 7, 10000019, 1u << 30};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        const uint32_t count = counts[n], step = (count - 1) / 16384 + 1;
        uint32_t next = 0, sampled = 0;
        for (uint32_t chunk = 0; chunk < fxs_chunks_of(count); chunk++) {
            const uint32_t at = fxs_palette_sample_at(count, chunk), first = chunk * FXS_CHUNK;
            const uint32_t inside = (first + step - 1) / step * step;
            sampled += at != FXS_NOT_SAMPLED;
            CHECK(at == FXS_NOT_SAMPLED ? inside >= first + FXS_CHUNK || inside >= count : at == next);
            next += at == FXS_NOT_SAMPLED ? 0 : FXS_CHUNK;
        }
        CHECK(next == fxs_palette_sample(count) && sampled * FXS_CHUNK == next);
        CHECK(next <= 16384 * 256 + FXS_CHUNK);
    }
}

static void test_progress(void)
{
    make_gaussians(MAX_COUNT);
    CHECK(write_file(MAX_COUNT, 0, 0));
    for (int i = 0; i < THREAD_COUNTS; i++)
        check_progress(thread_counts[i]);
    make_gaussians(600);
    CHECK(write_file(600, 1, 0));
    profile = FXS_PROFILE_SMALL;
    check_progress(0);
    profile = FXS_PROFILE_DEFAULT;
}

static void test_reader_fails(void)
{
    static const char *const names[] = {"x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",
                                        "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2"};
    FILE *stream = fopen(path, "wb");
    if (!CHECK(stream))
        return;
    fputs("ply\nformat ascii 1.0\nelement vertex 9000\n", stream);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        fprintf(stream, "property float %s\n", names[i]);
    fputs("end_header\n", stream);
    for (int i = 0; i < 9000; i++)
        fprintf(stream, "%d 2 3 -4 -4 -4 1 0 0 0 2 0 0 %s\n", i, i == 6000 ? "dog" : "0");
    CHECK(fclose(stream) == 0);
    for (int i = 0; i < THREAD_COUNTS; i++) {
        CHECK(pack_with(path, thread_counts[i], 0) == FXS_ERR_FILE && !packed.data && !packed.allocation);
        CHECK(strstr(message.text, path) && strstr(message.text, "6001 of 9000"));
    }
}

static struct {
    unsigned char *bytes;
    long size, reads, changes_at;
} changing;

static int read_changing(void *argument, uint64_t offset, void *out, size_t length)
{
    static const uint32_t wrong[] = {0x7fc00000, 0x7f800000, 0xff800000, 0x7f7fffff, 0x60000000, 0xbf800000};
    (void)argument;
    memcpy(out, changing.bytes + offset, length);
    if (changing.reads++ < changing.changes_at)
        return 0;
    for (size_t i = 0; i + 4 <= length; i += 4)
        /* simulates a file that changes after some reads; new bytes include NaN and infinity */
        if (offset + i > 2000) {
            const uint32_t word = fxs_little_32(wrong[(offset + i) / 4 % 53 % 6]);
            memcpy((unsigned char *)out + i, &word, 4);
        }
    return 0;
}

static void test_a_file_that_changes(void)
{
    int refused = 0;
    make_gaussians(3000);
    CHECK(write_file(3000, 3, 0));
    FILE *file = fopen(path, "rb");
    if (!CHECK(file && !fseek(file, 0, SEEK_END) && (changing.size = ftell(file)) > 0 && !fseek(file, 0, SEEK_SET)))
        return;
    changing.bytes = malloc((size_t)changing.size);
    CHECK(fread(changing.bytes, 1, (size_t)changing.size, file) == (size_t)changing.size && !fclose(file));
    for (changing.changes_at = 1; changing.changes_at < 40; changing.changes_at++)
        for (int which = 0; which < 3; which++) {
            const fxs_scene_input input = {(uint64_t)changing.size, read_changing, 0, 0, 0};
            const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = (enum fxs_profile)which};
            fxs_scene_file *scene_file;
            fxs_scene_file_info info;
            fxs_scene scene;
            changing.reads = 0;
            if (!CHECK(!fxs_scene_file_open_input(path, &input, 0, &scene_file, &info, &message)))
                continue;
            if (fxs_pack(scene_file, &info, &packed, &report, &options, &message))
                refused++;
            else
                CHECK(fxs_scene_open(&scene, packed.data, packed.bytes) == 0);
            fxs_packed_scene_free(&packed);
            fxs_scene_file_close(scene_file);
        }
    CHECK(refused > 0);
    free(changing.bytes);
}

int main(void)
{
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    RUN(test_packed_is_source_within_half_a_step);
    RUN(test_counts);
    RUN(test_largest_errors);
    RUN(test_bounds);
    RUN(test_inner_bounds_hold_an_object);
    RUN(test_inner_bounds_in_surroundings);
    RUN(test_inner_bounds_of_little);
    RUN(test_all_equal);
    RUN(test_extremes);
    RUN(test_sh_steps_up_to_the_limit);
    RUN(test_every_residual_code_serves);
    RUN(test_bytes_skipped);
    RUN(test_no_more_than_announced);
    RUN(test_dropped);
    RUN(test_share_of_what_is_dropped);
    RUN(test_axes_are_held);
    RUN(test_needles_in_a_chunk);
    RUN(test_far_ones_are_brought_in);
    RUN(test_faults_above_the_degree_do_not_matter);
    RUN(test_nothing_left);
    RUN(test_empty_file);
    RUN(test_flags);
    RUN(test_same_bytes_twice);
    RUN(test_loss_of_each_profile);
    RUN(test_read_back);
    RUN(test_loss_of_huge_sh);
    RUN(test_few_bits_are_kept);
    RUN(test_faint_chunks_get_fine_steps);
    RUN(test_faint_half_decides_on_the_law);
    RUN(test_offsets_of_codes);
    RUN(test_entries_of_a_palette);
    RUN(test_means_of_chunks);
    RUN(test_palettes_are_good);
    RUN(test_errors_of_sh_cancel);
    RUN(test_stages);
    RUN(test_stages_of_codes);
    RUN(test_stages_of_merging);
    RUN(test_every_allocation_fails);
    RUN(test_threads_learning_a_palette);
    RUN(test_threads);
    RUN(test_threads_on_real_scenes);
    RUN(test_order);
    RUN(test_likes_are_together);
    RUN(test_strays_are_apart);
    RUN(test_no_stray_is_missed);
    RUN(test_clusters_are_apart);
    RUN(test_chunks_are_small);
    RUN(test_strays_have_chunks);
    RUN(test_progress);
    RUN(test_readings_for_codes);
    RUN(test_sample);
    RUN(test_reader_fails);
    RUN(test_a_file_that_changes);
    unlink(path);
    return check_report();
}
