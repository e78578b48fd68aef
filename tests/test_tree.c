/* Tests the tree of levels of detail: its shape, and its file. A coarse chunk (256 Gaussians) must keep the
   means of the chunks below. */
#include <stdlib.h>
#include <unistd.h>

#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "src/core/chunk.h"
#include "src/gaussian/attributes.h"
#include "src/pack/coarsen.h"
#include "src/core/codes.h"
#include "src/pack/decode.h"
#include "src/pack/encode.h"
#include "scene_bytes.h"

enum { COUNT = 5000, MOST_CHUNKS = 64 };

static fxs_gaussian made[COUNT];
static fxs_scene_file *file;

static long read_made(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)argument;
    memcpy(out, made + first, capacity * sizeof *out);
    return (long)capacity;
}

static void make(void)
{
    uint32_t state = 5;
    for (int i = 0; i < COUNT; i++) {
        float *values = (float *)&made[i];
        for (size_t k = 0; k < sizeof made[i] / sizeof(float); k++)
            values[k] = (float)((state = state * 1664525 + 1013904223) >> 8) / 8388608 - 1;
        made[i].position[i % 3] = 1;
        for (int k = 0; k < 3; k++) {
            made[i].position[k] *= i % 100 ? 4.0f : 400.0f;
            made[i].scale[k] -= 3;
        }
        made[i].rotation[0] += 2;
        for (int k = 0; k < 45; k++)
            made[i].sh[k] *= 0.2f;
    }
}

static int pack(fxs_packed_scene *packed, fxs_scene *scene, uint64_t count, const fxs_pack_options *options)
{
    const fxs_gaussian_source source = {count, 3, 0, read_made, NULL, {0}};
    fxs_pack_report report;
    if (!CHECK(!fxs_scene_file_open_gaussians("made", &source, NULL, &file, &info, &message)))
        return 0;
    const int error = fxs_pack(file, &info, packed, &report, options, &message);
    fxs_scene_file_close(file);
    return CHECK(!error && !fxs_scene_open(scene, packed->data, packed->bytes));
}

/* The tree at each chunk (256 Gaussians): number of leaves below, first leaf, parent. */
static uint32_t leaves[MOST_CHUNKS], first[MOST_CHUNKS], parents[MOST_CHUNKS];

static void check_shape(const fxs_scene *scene)
{
    const uint32_t count = scene->chunk_count;
    if (!CHECK(scene->nodes && 2 * count - 1 <= MOST_CHUNKS))
        return;
    memset(parents, 0, sizeof parents);
    for (uint32_t i = 0; i < count; i++) {
        leaves[i] = 1;
        first[i] = i;
    }
    for (uint32_t i = count - 1; i-- > 0;) {
        fxs_node node;
        fxs_chunk chunk;
        if (!CHECK(!fxs_node_read(&node, scene, i) && !fxs_chunk_read(&chunk, scene, count + i)))
            return;
        const uint32_t a = node.children[0], b = node.children[1];
        parents[a]++;
        parents[b]++;
        leaves[count + i] = leaves[a] + leaves[b];
        first[count + i] = first[a];
        CHECK(first[b] == first[a] + leaves[a]);
    }
    CHECK(leaves[count] == count && first[count] == 0 && parents[count] == 0);
    for (uint32_t i = 0; i < 2 * count - 1; i++)
        CHECK(i == count || parents[i] == 1);
    for (uint32_t i = count; i + 1 < 2 * count - 1; i++)
        CHECK(leaves[i] > leaves[i + 1] || (leaves[i] == leaves[i + 1] && first[i] < first[i + 1]));
}

/* Tree nodes are refined in descending order of their gain. A child must not have a larger gain than its parent. */
static void check_gains(const fxs_scene *scene)
{
    for (uint32_t i = 0; i + 1 < scene->chunk_count; i++) {
        fxs_node node, child;
        CHECK(!fxs_node_read(&node, scene, i));
        for (int side = 0; side < 2; side++)
            if (node.children[side] >= scene->chunk_count &&
                CHECK(!fxs_node_read(&child, scene, node.children[side] - scene->chunk_count)))
                CHECK(child.gain_q8 <= node.gain_q8);
    }
}

/* Sums over a chunk (256 Gaussians). weight: opacity * area, where area = sqrt(x^2 y^2 + x^2 z^2 + y^2 z^2) for
   the sigmas x, y, z. at, dc: weight * position, weight * colour. */
typedef struct sums {
    double weight, area, at[3], dc[3];
    uint32_t count;
} sums;

static sums sums_of(const fxs_scene *scene, uint32_t number)
{
    const unsigned char *rows = fxs_rows(scene, number);
    sums s = {0};
    fxs_chunk chunk;
    CHECK(!fxs_chunk_read(&chunk, scene, number));
    for (uint32_t i = 0; i < FXS_CHUNK; i++) {
        fxs_gaussian g;
        if (fxs_slot_is_empty(scene, rows, i))
            continue;
        fxs_decode(scene, &chunk, rows, i, &g);
        const double x = exp(2.0 * g.scale[0]), y = exp(2.0 * g.scale[1]), z = exp(2.0 * g.scale[2]);
        const double area = sqrt(x * y + x * z + y * z);
        const double weight = area * fmax(fxs_opacity_of_logit(g.opacity) - (double)FXS_FAINTEST, 0);
        s.weight += weight;
        s.area += area;
        for (int k = 0; k < 3; k++) {
            s.at[k] += weight * g.position[k];
            s.dc[k] += weight * g.dc[k];
        }
        s.count++;
    }
    return s;
}

static void check_means(const fxs_scene *scene, double loss)
{
    double worst = 0;
    for (uint32_t i = 0; i + 1 < scene->chunk_count; i++) {
        fxs_node node;
        CHECK(!fxs_node_read(&node, scene, i));
        const sums own = sums_of(scene, scene->chunk_count + i), a = sums_of(scene, node.children[0]),
                   b = sums_of(scene, node.children[1]);
        CHECK(own.count == (a.count + b.count < FXS_CHUNK ? a.count + b.count : FXS_CHUNK));
        const double weight = a.weight + b.weight;
        /* error of the weight if each opacity is off by half a step of its code */
        const double rounded = own.area / 510;
        CHECK(own.weight < 1.01 * weight + rounded && own.weight > 0.7 * weight - rounded);
        for (int k = 0; k < 3; k++) {
            worst = fmax(worst, fabs(own.at[k] / own.weight - (a.at[k] + b.at[k]) / weight) / 400);
            worst = fmax(worst, fabs(own.dc[k] / own.weight - (a.dc[k] + b.dc[k]) / weight));
        }
    }
    printf("  largest change of a mean: %.4f\n", worst);
    CHECK(worst < loss);
}

static void check_tree(enum fxs_profile profile, double loss)
{
    fxs_packed_scene packed;
    fxs_scene scene;
    if (!pack(&packed, &scene, COUNT, &(fxs_pack_options){.size = sizeof(fxs_pack_options), .profile = profile,
                                                          .tree = 1}))
        return;
    check_shape(&scene);
    check_gains(&scene);
    check_means(&scene, loss);
    fxs_packed_scene_free(&packed);
}

static void check_threads(enum fxs_profile profile)
{
    fxs_packed_scene alone, packed, plain;
    fxs_scene scene;
    if (!pack(&alone, &scene, COUNT, &(fxs_pack_options){.size = sizeof(fxs_pack_options), .profile = profile,
                                                         .tree = 1}) ||
        !pack(&plain, &scene, COUNT, &(fxs_pack_options){.size = sizeof(fxs_pack_options), .profile = profile}))
        return;
    CHECK(!scene.nodes && alone.bytes == plain.bytes + fxs_tree_bytes(scene.chunk_count, scene.chunk_bytes));
    CHECK(!memcmp((char *)alone.data + 8, (char *)plain.data + 8, plain.bytes - 8));
    for (uint32_t threads = 2; threads <= 3; threads++) {
        fxs_pool *pool = fxs_pool_create(threads);
        const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = profile, .tree = 1,
                                          .workers.run = fxs_pool_run, .workers.pool = pool,
                                          .workers.count = threads};
        if (pack(&packed, &scene, COUNT, &options)) {
            CHECK(packed.bytes == alone.bytes && !memcmp(packed.data, alone.data, alone.bytes));
            fxs_packed_scene_free(&packed);
        }
        fxs_pool_destroy(pool);
    }
    fxs_packed_scene_free(&alone);
    fxs_packed_scene_free(&plain);
}

static void few(void)
{
    for (uint64_t count = FXS_CHUNK - 1; count <= FXS_CHUNK + 1; count++) {
        fxs_packed_scene packed;
        fxs_scene scene;
        if (!pack(&packed, &scene, count, &(fxs_pack_options){.size = sizeof(fxs_pack_options), .tree = 1}))
            return;
        if (scene.chunk_count > 1)
            check_shape(&scene);
        else
            CHECK(!scene.nodes && packed.bytes == fxs_scene_bytes((uint32_t)count, 3, FXS_PROFILE_DEFAULT, 0));
        fxs_packed_scene_free(&packed);
    }
}

static void extremes(void)
{
    static const float sizes[] = {1e-30f, 1e-10f, 1e-3f, 1, 60, 1e4f, 1e8f, 1e30f};
    for (uint32_t round = 0; round < 12; round++) {
        fxs_packed_scene packed;
        fxs_scene scene;
        uint32_t state = round;
        for (int i = 0; i < COUNT; i++) {
            float *values = (float *)&made[i];
            for (size_t k = 0; k < sizeof made[i] / sizeof(float); k++) {
                state = state * 1664525 + 1013904223;
                values[k] = ((float)(state >> 8) / 8388608 - 1) * sizes[(state >> 5 & 7) % (2 + round % 7)];
            }
        }
        if (!pack(&packed, &scene, COUNT, &(fxs_pack_options){.size = sizeof(fxs_pack_options), .tree = 1,
                                                              .profile = (enum fxs_profile)(round % 3)}))
            continue;
        for (uint32_t i = 0; i < fxs_scene_chunks(&scene); i++) {
            fxs_chunk chunk;
            CHECK(!fxs_chunk_read(&chunk, &scene, i));
        }
        for (uint32_t i = 0; i + 1 < scene.chunk_count; i++) {
            fxs_node node;
            CHECK(!fxs_node_read(&node, &scene, i));
        }
        fxs_packed_scene_free(&packed);
    }
    make();
}

static int live, allocations, failing;

static void *count_allocation(void *argument, size_t size_wanted)
{
    (void)argument;
    void *block = ++allocations > failing ? NULL : malloc(size_wanted);
    live += block != NULL;
    return block;
}

static void count_release(void *argument, void *block)
{
    (void)argument;
    live--;
    free(block);
}

static int try_pack(const fxs_pack_options *options)
{
    const fxs_gaussian_source source = {COUNT, 3, 0, read_made, NULL, {0}};
    fxs_packed_scene packed;
    fxs_pack_report report;
    if (!CHECK(!fxs_scene_file_open_gaussians("made", &source, NULL, &file, &info, &message)))
        return 0;
    const int error = fxs_pack(file, &info, &packed, &report, options, &message);
    fxs_scene_file_close(file);
    CHECK(!error == !!packed.data);
    fxs_packed_scene_free(&packed);
    CHECK(live == 0);
    return error;
}

static void allocations_fail(void)
{
    static const fxs_allocator counting = {count_allocation, count_release, 0};
    int error = FXS_ERR_MEMORY;
    for (failing = 0; error && failing < 100; failing++) {
        allocations = 0;
        error = try_pack(&(fxs_pack_options){.size = sizeof(fxs_pack_options), .tree = 1, .allocator = &counting});
        CHECK(!error || (error == FXS_ERR_MEMORY && strstr(message.text, "out of memory")));
    }
    CHECK(!error && failing > 15);
}

static double stop_from;

static int stop(void *argument, double done)
{
    double *last = argument;
    CHECK(done >= *last && done <= 1);
    *last = done;
    return done >= stop_from;
}

static void stopped(void)
{
    for (stop_from = 0; stop_from < 1.1; stop_from += 0.1) {
        double last = 0;
        const int error = try_pack(&(fxs_pack_options){.size = sizeof(fxs_pack_options), .tree = 1,
                                                       .progress.call = stop, .progress.argument = &last});
        CHECK(error == (stop_from > 1 ? 0 : FXS_ERR_STOPPED) && (error || last == 1));
    }
}

static void in_a_file(void)
{
    static fxs_gaussian got[COUNT], expected[COUNT];
    char target[] = "/tmp/fixsplat-tree-XXXXXX";
    const int descriptor = mkstemp(target);
    fxs_packed_scene packed, plain;
    fxs_scene scene;
    size_t unseen = 0;
    if (!CHECK(descriptor >= 0) || !pack(&packed, &scene, COUNT, &(fxs_pack_options){.size = sizeof(fxs_pack_options),
                                                                                     .tree = 1}) ||
        !pack(&plain, &scene, COUNT, NULL))
        return;
    close(descriptor);
    CHECK(!fxs_file_write(target, packed.data, packed.bytes, &message));
    unsigned char *copy = check_aligned(packed.bytes);
    FILE *in = fopen(target, "rb");
    CHECK(in && fread(copy, 1, packed.bytes, in) == packed.bytes && fgetc(in) == EOF);
    fclose(in);
    CHECK(!fxs_file_check("x.fxs", copy, packed.bytes, 1, &message));
    CHECK(!fxs_file_seal(packed.data, packed.bytes) && !memcmp(packed.data, copy, packed.bytes));
    for (size_t i = plain.bytes; i < packed.bytes; i += i < plain.bytes + 512 ? 1 : 397) {
        copy[i] ^= 16;
        unseen += fxs_file_check("x.fxs", copy, packed.bytes, 1, &message) == 0;
        copy[i] ^= 16;
    }
    CHECK(unseen == 0);
    for (size_t cut = 0; cut < 3; cut++)
        CHECK(fxs_file_check("x.fxs", copy, cut == 2 ? packed.bytes - 1 : plain.bytes + 63 * cut, 0, &message));
    CHECK(!fxs_scene_file_open(target, NULL, &file, &info, &message) && info.count == COUNT);
    CHECK(fxs_scene_file_read(file, got, COUNT, &message) == COUNT);
    fxs_scene_file_close(file);
    fxs_file_seal(plain.data, plain.bytes);
    CHECK(!fxs_scene_file_open_memory("plain", plain.data, plain.bytes, NULL, &file, &info, &message));
    CHECK(fxs_scene_file_read(file, expected, COUNT, &message) == COUNT && !memcmp(got, expected, sizeof got));
    fxs_scene_file_close(file);
    CHECK(fxs_scene_file_open_memory("cut", copy, plain.bytes, NULL, &file, &info, &message) == FXS_ERR_FILE);
    free(copy);
    unlink(target);
    fxs_packed_scene_free(&packed);
    fxs_packed_scene_free(&plain);
}

int main(void)
{
    make();
    RUN_AS("tree_default", check_tree(FXS_PROFILE_DEFAULT, 0.03));
    RUN_AS("tree_compact", check_tree(FXS_PROFILE_COMPACT, 0.03));
    RUN_AS("tree_small", check_tree(FXS_PROFILE_SMALL, 0.03));
    RUN_AS("threads_default", check_threads(FXS_PROFILE_DEFAULT));
    RUN_AS("threads_compact", check_threads(FXS_PROFILE_COMPACT));
    RUN_AS("threads_small", check_threads(FXS_PROFILE_SMALL));
    RUN(few);
    RUN(extremes);
    RUN(allocations_fail);
    RUN(stopped);
    RUN(in_a_file);
    return check_report();
}
