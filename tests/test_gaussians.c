/* Tests the packing of Gaussians from a callback, which may give too few, too many, NaN, or other values in a later
   pass. */
#include <math.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/packed.h>
#include "scene_writer.h"
#include "folder.h"

enum { COUNT = 9000 };   /* number of Gaussians; the packer needs more than two calls of the source to read them */

static fxs_gaussian made[COUNT];

static struct {
    uint64_t calls, next, passes;       /* next: first index that the next call of the source should ask for */
    /* at: index of the first faulty Gaussian; from_pass: first pass in which it is faulty */
    uint64_t at, from_pass;
    long step;                          /* largest number of Gaussians that a call returns; 0: the requested number */
    long result;                        /* error code that the faulty call returns; 0: the call succeeds */
    void (*spoil)(fxs_gaussian *g);     /* makes a Gaussian faulty; null: no change */
} source;

static fxs_message message;
static fxs_scene_file *file;
static fxs_scene_file_info info;
static fxs_packed_scene packed;
static fxs_pack_report report;

static long give(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    static const fxs_gaussian zero;
    long count = source.step && (size_t)source.step < capacity ? source.step : (long)capacity;
    source.passes += first == 0;
    CHECK(argument == made && capacity > 0 && (first == 0 || first == source.next) && first + capacity <= COUNT);
    for (size_t i = 0; i < capacity; i++)
        CHECK(memcmp(&out[i], &zero, sizeof zero) == 0);
    source.calls++;
    memcpy(out, made + first, (size_t)count * sizeof *out);
    if (first >= source.at && source.passes >= source.from_pass) {
        if (source.result)
            return source.result > 0 ? (long)capacity + source.result : source.result;
        for (long i = 0; source.spoil && i < count; i++)
            source.spoil(&out[i]);
        if (!source.spoil)
            return 0;
    }
    source.next = first + (uint64_t)count;
    return count;
}

static void forget(void)
{
    memset(&source, 0, sizeof source);
    source.at = UINT64_MAX;
}

static void make_gaussians(void)
{
    uint32_t state = 1;
    for (int i = 0; i < COUNT; i++) {
        float *values = (float *)(void *)&made[i];
        for (size_t k = 0; k < sizeof made[i] / sizeof *values; k++)
            values[k] = (float)((state = state * 1664525 + 1013904223) >> 8) / (1 << 23) - 1;
        for (int k = 0; k < 3; k++)
            made[i].scale[k] -= 4;
    }
    made[17].position[1] = NAN;
}

static int open_degree(int degree, const fxs_scene_file_options *options)
{
    const fxs_gaussian_source from = {COUNT, degree, 1, give, made, {0}};
    return fxs_scene_file_open_gaussians("made", &from, options, &file, &info, &message);
}

static int pack_opened(enum fxs_profile profile, int filtered)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = profile};
    fxs_scene_filter filter;
    fxs_scene_filter_report left;
    int result = 0;
    fxs_scene_filter_init(&filter);
    filter.opacity = 0.5;
    filter.high[0] = 0.9;
    filter.sh_degree = 1;
    if (filtered)
        result = fxs_scene_file_filter(file, &filter, &info, &left, NULL, &message);
    if (result == 0)
        result = fxs_pack(file, &info, &packed, &report, &options, &message);
    fxs_scene_file_close(file);
    return result;
}

static int pack_made(void)
{
    CHECK(open_degree(3, NULL) == 0);
    return pack_opened(FXS_PROFILE_DEFAULT, 0);
}

static int open_ply(int degree)
{
    fxs_scene_writer *writer;
    return open_writer("ply", in_folder("made.ply"), COUNT, degree, 1, &writer, &message) ||
           fxs_scene_writer_put(writer, made, COUNT, &message) || close_writer(writer, &message) ||
           fxs_scene_file_open(in_folder("made.ply"), NULL, &file, &info, &message);
}

static void same_bytes_as_ply(void)
{
    for (int i = 0; i < 12; i++) {
        const int degree = i < 8 ? i % 4 : 3, filtered = i < 8 ? i / 4 : i % 2;
        const enum fxs_profile profile = i < 8 ? FXS_PROFILE_DEFAULT : i < 10 ? FXS_PROFILE_COMPACT : FXS_PROFILE_SMALL;
        CHECK(open_ply(degree) == 0 && pack_opened(profile, filtered) == 0);
        const fxs_packed_scene wanted = packed;
        forget();
        source.step = i % 3 ? 1000 * (i % 3) - 999 : 0;
        CHECK(open_degree(degree, NULL) == 0 && info.count == COUNT && info.sh_degree == degree && info.levels == 1 &&
              info.stored_sh_degree == degree && info.antialiased && strcmp(info.format, "gaussians") == 0);
        CHECK(pack_opened(profile, filtered) == 0 && source.passes == 3 + (uint64_t)filtered);
        CHECK(packed.bytes == wanted.bytes && memcmp(packed.data, wanted.data, packed.bytes) == 0);
        CHECK(filtered || report.dropped.not_finite == 1);
        fxs_packed_scene_free(&packed);
        packed = wanted;
        fxs_packed_scene_free(&packed);
    }
}

static void same_codes_far_out(void)
{
    static const double origin[3] = {500000, -4500000, 0.5};
    for (int profile = 0; profile < 3; profile++) {
        fxs_gaussian_source from = {COUNT, 3, 1, give, made, {0}};
        const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = (enum fxs_profile)profile,
                                          .tree = 1};
        fxs_packed_scene scenes[2];
        fxs_scene opened[2];
        for (int far = 0; far < 2; far++) {
            forget();
            memcpy(from.origin, far ? origin : (const double[3]){0}, sizeof origin);
            CHECK(!fxs_scene_file_open_gaussians("made", &from, NULL, &file, &info, &message));
            CHECK(!fxs_pack(file, &info, &scenes[far], &report, &options, &message));
            CHECK(!fxs_scene_open(&opened[far], scenes[far].data, scenes[far].bytes));
            fxs_scene_file_close(file);
        }
        CHECK(report.low[1] < -4500000 && report.low[1] > -4500002 && report.high[2] > 0.5 &&
              report.inner_low[0] > 499990);
        for (uint32_t i = 0; i < 2 * opened[0].chunk_count - 1; i++) {
            fxs_chunk chunks[2];
            const uint32_t leaves = opened[0].chunk_count;
            for (int far = 0; far < 2; far++) {
                const unsigned char *header = i < leaves ? opened[far].chunks + i * sizeof(fxs_chunk)
                                                         : opened[far].node_chunks + (i - leaves) * sizeof(fxs_chunk);
                memcpy(&chunks[far], header, sizeof(fxs_chunk));
                fxs_chunk_turn(&chunks[far]);
            }
            for (int k = 0; k < 3; k++)
                chunks[1].origin_q32[k] -= (int64_t)ldexp(origin[k], 32);
            CHECK(!memcmp(&chunks[0], &chunks[1], sizeof *chunks));
        }
        CHECK(scenes[0].bytes == scenes[1].bytes &&
              !memcmp(opened[0].rows, opened[1].rows, opened[0].chunk_count * (size_t)opened[0].chunk_bytes));
        fxs_packed_scene_free(&scenes[0]);
        fxs_packed_scene_free(&scenes[1]);
    }
}

static void fails(int error, const char *words)
{
    memset(&message, 1, sizeof message);
    if (!CHECK(pack_made() == error && strstr(message.text, words) && message.bytes_needed == 0 && !packed.data))
        printf("  said: %s\n", message.text);
}

static void wrong_numbers(void)
{
    static const struct { long result; int error; const char *words; } wrong[] = {
        {0, FXS_ERR_FILE, "made: the function that reads gave 0 of 904 Gaussians from 8096 on"},
        {1, FXS_ERR_FILE, "gave 905 of 904 Gaussians"}, {2000000000, FXS_ERR_FILE, "made: "},
        {FXS_ERR_DEVICE, FXS_ERR_DEVICE, "made: "}, {FXS_ERR_MEMORY, FXS_ERR_MEMORY, "made: "},
        {FXS_ERR_FILE - 1, FXS_ERR_FILE, "made: "}, {-2000000000, FXS_ERR_FILE, "made: "}
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        for (uint64_t pass = 1; pass <= 3; pass++) {
            forget();
            source.step = i < 2 ? 4048 : 0;
            source.at = 8096;
            source.from_pass = pass;
            source.result = wrong[i].result;
            fails(wrong[i].error, wrong[i].words);
            CHECK(source.passes == pass);
        }
}

static void spoil_position(fxs_gaussian *g) { g->position[0] += 3; }
static void spoil_position_nan(fxs_gaussian *g) { g->position[2] = NAN; }
static void spoil_all(fxs_gaussian *g) { memset(g, 0xff, sizeof *g); }
static void spoil_sh(fxs_gaussian *g) { g->sh[44] = -g->sh[44]; }
static void spoil_scale(fxs_gaussian *g) { g->scale[0] = INFINITY; }

static void changed_between_passes(void)
{
    void (*const spoil[])(fxs_gaussian *) = {spoil_position, spoil_position_nan, spoil_all, spoil_sh, spoil_scale};
    for (int i = 0; i < 5; i++)
        for (uint64_t pass = 2; pass <= 3; pass++) {
            fxs_scene scene;
            forget();
            source.at = 5000;
            source.from_pass = pass;
            source.spoil = spoil[i];
            if (i < 3)
                fails(FXS_ERR_FILE, "the file changed while it was read");
            else if (pack_made() == 0)
                CHECK(fxs_scene_open(&scene, packed.data, packed.bytes) == 0);
            else
                CHECK(strstr(message.text, "changed"));
            fxs_packed_scene_free(&packed);
        }
}

static void nothing_finite(void)
{
    forget();
    source.at = 0;
    source.spoil = spoil_position_nan;
    fails(FXS_ERR_FILE, "none of the 9000 Gaussians can be drawn");
}

static void wrong_arguments(void)
{
    fxs_gaussian_source from = {COUNT, 3, 0, NULL, made, {0}};
    CHECK(fxs_scene_file_open_gaussians("made", &from, NULL, &file, &info, &message) == FXS_ERR_ARGUMENT && !file);
    CHECK(open_degree(4, NULL) == FXS_ERR_ARGUMENT && open_degree(-1, NULL) == FXS_ERR_ARGUMENT && !file);
    CHECK(open_degree(3, &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                   .level = 1}) == FXS_ERR_ARGUMENT && !file);
    CHECK(open_degree(3, &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                   .max_gaussians = COUNT - 1}) == FXS_ERR_FILE && !file);
    from = (fxs_gaussian_source){COUNT, 3, 0, give, made, {0, 1e8, 0}};
    CHECK(fxs_scene_file_open_gaussians("made", &from, NULL, &file, &info, &message) == FXS_ERR_ARGUMENT && !file);
    from = (fxs_gaussian_source){(uint64_t)FXS_MAX_COUNT + 1, 3, 0, give, made, {0}};
    CHECK(fxs_scene_file_open_gaussians("made", &from, NULL, &file, &info, &message) == FXS_ERR_FILE && !file);
    from.count = 0;
    CHECK(fxs_scene_file_open_gaussians("made", &from, NULL, &file, &info, &message) == 0);
    CHECK(fxs_scene_file_read(file, made, 1, &message) == 0 && pack_opened(FXS_PROFILE_DEFAULT, 0) == FXS_ERR_FILE);
    forget();
    CHECK(open_degree(3, NULL) == 0 && pack_opened((enum fxs_profile)3, 0) == FXS_ERR_ARGUMENT && source.calls == 0);
}

static struct { long left, live; } memory;

static void *allocate(void *argument, size_t bytes)
{
    (void)argument;
    if (memory.left-- <= 0)
        return NULL;
    memory.live++;
    return malloc(bytes);
}

static void release(void *argument, void *block)
{
    (void)argument;
    memory.live--;
    free(block);
}

static void every_allocation_fails(void)
{
    const fxs_allocator counted = {allocate, release, NULL};
    const fxs_scene_file_options opening = {.size = sizeof(fxs_scene_file_options), .allocator = &counted};
    const fxs_pack_options packing = {.size = sizeof(fxs_pack_options), .allocator = &counted,
                                      .profile = FXS_PROFILE_COMPACT};
    int result = FXS_ERR_MEMORY;
    for (long n = 0; result && n < 100; n++) {
        forget();
        memory.left = n;
        result = open_degree(2, &opening);
        if (result == 0)
            result = fxs_pack(file, &info, &packed, &report, &packing, &message);
        CHECK(!result || (result == FXS_ERR_MEMORY && strstr(message.text, "out of memory") && !packed.data));
        fxs_scene_file_close(file);
        fxs_packed_scene_free(&packed);
        CHECK(memory.live == 0);
    }
    CHECK(result == 0);
}

static void run_tests(void)
{
    make_gaussians();
    RUN(same_bytes_as_ply);
    RUN(same_codes_far_out);
    RUN(wrong_numbers);
    RUN(changed_between_passes);
    RUN(nothing_finite);
    RUN(wrong_arguments);
    RUN(every_allocation_fails);
}

int main(void)
{
    return in_a_folder(run_tests);
}
