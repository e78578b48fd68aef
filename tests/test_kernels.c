/* Compares every fast kernel with plain C on random and extreme inputs, with guard bytes around outputs.
   `test_kernels SEED` replays one case. `test_kernels --bench` measures times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__x86_64__) || defined(__i386__)
#include <x86intrin.h>
#define TICK "cycles"
#else
#include <time.h>
#define TICK "ns"   /* unit of measured times: nanoseconds; times are 0 on systems without a clock */
#endif

#include <fixsplat/internal/kernels.h>
#include "src/core/chunk.h"
#include "one_scene.h"
#include "packed_scene.h"

#define ALL_CASES 2000
#ifndef CASES                          /* number of random cases; fewer on emulated boards */
#define CASES ALL_CASES
#endif
#define GUARD 64
#define GUARD_BYTE 0xa5
#define MAX_SPLATS 1024
#define MAX_ENTRIES 3000
#define TILE_COLUMNS 100
#define MAX_STRIDE 200

static const struct {
    const char *name;
    unsigned cpu;
} versions[] = {{"sse41", FXS_CPU_SSE41}, {"avx2", FXS_CPU_AVX2}, {"avx512", FXS_CPU_AVX512}, {"neon", FXS_CPU_NEON},
                {"mve", FXS_CPU_MVE}, {"cortexm", FXS_CPU_CORTEX_M}, {"simd128", FXS_CPU_SIMD128}};

#define VERSIONS (sizeof versions / sizeof *versions)

static fxs_kernels fast;               /* table of the fast kernels under test */
static uint64_t first_seed = 1, last_seed = CASES;

static uint64_t state;

static uint64_t next(void)
{
    uint64_t x = state += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

static uint32_t below(uint32_t n)
{
    return (uint32_t)((next() >> 32) * n >> 32);
}

static int one_in(uint32_t n)
{
    return below(n) == 0;
}

static int64_t between(int64_t low, int64_t high)
{
    return low + (int64_t)(next() % (uint64_t)(high - low + 1));
}

static double uniform(double low, double high)
{
    return low + (high - low) * (double)(next() >> 11) * 0x1p-53;
}

static int64_t any_size(int64_t limit)
{
    int64_t x = (int64_t)(next() >> 1 >> below(63)) % (limit + 1);
    return one_in(2) ? x : -x;
}

static void *allocate(size_t bytes)
{
    void *memory = NULL;
    if (posix_memalign(&memory, 64, bytes))
        abort();
    return memory;
}

/* Two copies of a kernel's output, from plain C [0] and from the fast kernel [1], each between guard bytes. */
typedef struct output {
    unsigned char *memory[2];
    size_t bytes;
} output;

static output outputs[8];
static size_t output_count;

/* Makes both copies of a kernel's output and fills them with equal noise. skew: misalignment in bytes. */
static output *output_new(size_t bytes, size_t skew)
{
    output *o = &outputs[output_count++];
    o->bytes = bytes + skew + 2 * GUARD;
    for (int i = 0; i < 2; i++) {
        o->memory[i] = allocate(o->bytes);
        memset(o->memory[i], GUARD_BYTE, o->bytes);
    }
    for (size_t i = 0; i < bytes; i++)
        o->memory[0][GUARD + skew + i] = o->memory[1][GUARD + skew + i] = (unsigned char)next();
    return o;
}

static void *at(const output *o, int which, size_t skew)
{
    return o->memory[which] + GUARD + skew;
}

static int guards_whole(const output *o, size_t skew)
{
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < GUARD; k++)
            if (o->memory[i][k] != GUARD_BYTE || o->memory[i][o->bytes - 1 - k] != GUARD_BYTE ||
                (k < skew && o->memory[i][GUARD + k] != GUARD_BYTE))
                return 0;
    return 1;
}

static int same(const output *o)
{
    return !memcmp(o->memory[0], o->memory[1], o->bytes);
}

static void outputs_free(void)
{
    while (output_count) {
        output *o = &outputs[--output_count];
        free(o->memory[0]);
        free(o->memory[1]);
    }
}

static packed_scene made;            /* a packed scene of one chunk (256 Gaussians) */
static fxs_scene scene;
static fxs_stage_view view;

static fxs_chunk *chunk_of(void)
{
    return made.chunks;
}

/* Fills codes of a packed scene. kind 0: all codes are 0; 1: all are the largest; 2: both are mixed; others:
   random. */
static void fill_codes(unsigned char *row, size_t bytes, uint32_t kind)
{
    for (size_t i = 0; i < bytes; i += 4) {
        uint32_t bits = (uint32_t)next(), all = kind == 1 || (kind == 2 && bits & 1) ? UINT32_MAX : 0;
        uint32_t word = kind > 2 ? bits : all;
        memcpy(row + i, &word, 4);
    }
}

static void fill_rows(unsigned char *rows, int degree)
{
    for (uint32_t row = 0; row < 3; row++)
        fill_codes(rows + FXS_ROW_POSITION + 2 * FXS_CHUNK * row, 2 * FXS_CHUNK, below(6));
    fill_codes(rows + FXS_ROW_ROTATION, 4 * FXS_CHUNK, below(16));
    fill_codes(rows + FXS_ROW_SCALE, 4 * FXS_CHUNK, below(6));
    fill_codes(rows + FXS_ROW_COLOUR, 4 * FXS_CHUNK, below(6));
    for (uint32_t row = 0; row < 3 * (uint32_t)FXS_SH_COUNT(degree); row++)
        fill_codes(rows + FXS_ROW_SH + FXS_CHUNK * row, FXS_CHUNK, below(6));
    for (uint32_t i = below(64); i < FXS_CHUNK; i += below(64) + 1)
        rows[FXS_ROW_COLOUR + 4 * i + 3] = (unsigned char)(one_in(2));
}

/* Fills the codes of a packed scene in a profile in which all byte values are valid codes. */
static void fill_other(unsigned char *rows, uint32_t bytes)
{
    for (uint32_t row = 0; row < bytes / FXS_CHUNK; row++)
        fill_codes(rows + FXS_CHUNK * row, FXS_CHUNK, below(32));
    fill_codes((unsigned char *)made.palette, made.palette ? (size_t)(made.rows - (unsigned char *)made.palette) : 0,
               below(6));
    if (made.palette)
        made.header->palette_step_q19 = one_in(4) ? 32767 : below(32768);
}

static void wild_header(fxs_chunk *c)
{
    const int64_t far = (int64_t)1 << 60;
    c->step_shift = (uint16_t)below(13);
    c->opacity_law = (uint16_t)below(FXS_OPACITY_LAWS);
    for (size_t i = 0; i < sizeof c->sh_mean; i++)
        c->sh_mean[i] = (int8_t)next();
    c->scale_q16 = (int32_t)(one_in(4) ? 32 << 16 : any_size(32 << 16));
    int64_t reach = (c->scale_q16 + (32 << 16)) * (int64_t)256 / (1023 * 1023);
    c->scale_step_q24 = (uint16_t)(one_in(4) ? reach : (int64_t)between(0, reach));
    for (int i = 0; i < 3; i++) {
        c->step_q32[i] = one_in(8) ? UINT32_MAX : (uint32_t)next() >> below(32);
        int64_t span = (int64_t)c->step_q32[i] * 65535 << c->step_shift;
        c->origin_q32[i] = one_in(8) ? -far : one_in(8) ? far - span : any_size(far - span);
        c->colour_q16[i] = (int32_t)any_size(64 << 16);
        c->colour_step_q20[i] = (uint32_t)between(0, ((64 << 16) - c->colour_q16[i]) * (int64_t)16 / 511);
        c->sh_step_q19[i] = (uint16_t)(one_in(4) ? 32767 : below(32768));
    }
}

static void point_header(fxs_chunk *c)
{
    for (int i = 0; i < 3; i++) {
        c->step_q32[i] = 0;
        c->origin_q32[i] = 0;
    }
}

static void tame_header(fxs_chunk *c)
{
    double size = exp2(uniform(-4, 2));
    c->step_shift = 0;
    c->scale_q16 = (int32_t)(uniform(-5, -4) * 65536);
    c->scale_step_q24 = 60;
    for (int i = 0; i < 3; i++) {
        c->step_q32[i] = (uint32_t)(size * 0x1p32 / 65535);
        c->origin_q32[i] = -(int64_t)(size * 0x1p31);
        c->colour_q16[i] = 0;
        c->colour_step_q20[i] = (1 << 20) / 255;
        c->sh_step_q19[i] = 2048;
    }
}

static void make_scene(void)
{
    const int wild = one_in(2), antialiased = one_in(2), degree = (int)below(4);
    const enum fxs_profile profile = (enum fxs_profile)(one_in(2) ? FXS_PROFILE_DEFAULT : below(3));
    free(made.data);
    made = packed_scene_make(profile, degree, FXS_CHUNK, antialiased);
    if (wild)
        wild_header(chunk_of());
    else
        tame_header(chunk_of());
    if (one_in(16))
        point_header(chunk_of());
    if (profile == FXS_PROFILE_DEFAULT)
        fill_rows(made.rows, degree);
    else
        fill_other(made.rows, made.header->chunk_bytes);
    CHECK(fxs_scene_open(&scene, made.data, made.bytes) == 0);
}

static void random_rotation(fxs_camera *camera)
{
    double q[4], norm = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = uniform(-1, 1);
        norm += q[i] * q[i];
    }
    if (norm < 1e-3 || one_in(8)) {              /* identity rotation */
        memset(q, 0, sizeof q);
        q[0] = norm = 1;
    }
    const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / norm;
    const double m[9] = {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
                         s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),
                         s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        camera->rotation_q30[i] = (int32_t)lrint(m[i] * 0x1p30);
}

static void place_camera(fxs_camera *camera, double distance)
{
    const fxs_chunk *c = chunk_of();
    for (int i = 0; i < 3; i++) {
        double span = (double)c->step_q32[i] * 65535 * (double)(1u << c->step_shift);
        double x = (double)c->origin_q32[i] + uniform(0, 1) * span -
                   distance * 0x1p32 * camera->rotation_q30[6 + i] * 0x1p-30;
        camera->position_q32[i] = (int64_t)fmax(-0x1p60, fmin(0x1p60, x));
    }
}

static int32_t principal_point(int32_t size)
{
    const int32_t limit = 65536 << 12, half_pixel = 1 << 11;
    const int32_t off = half_pixel + (int32_t)between(-1, 1);
    return one_in(4) ? (int32_t)next() : one_in(8) ? off - limit : one_in(8) ? off + limit : size * 2048;
}

static void set_scale(fxs_chunk *c, int32_t scale_q16)
{
    const uint32_t most = (uint32_t)((scale_q16 + (32 << 16)) * (int64_t)256 / (1023 * 1023));
    c->scale_q16 = scale_q16;
    c->scale_step_q24 = c->scale_step_q24 < most ? c->scale_step_q24 : (uint16_t)most;
}

/* Zooms an orthographic camera so that the chunk (256 Gaussians) is 1/16 to 4096 times as wide as the picture. */
static void zoom_to_chunk(fxs_camera *camera)
{
    const fxs_chunk *c = chunk_of();
    const double width = ((double)c->step_q32[0] * 65535 * (double)(1u << c->step_shift) + 1) * 0x1p-32;
    const double focal_q12 = camera->width / width * exp2(uniform(-4, 12)) * 4096;
    camera->fx_q12 = camera->fy_q12 = (int32_t)fmax(1, fmin(INT32_MAX, focal_q12));
}

/* Puts all Gaussian centres at one point on the axis of an orthographic camera with any zoom. */
static void zoom_to_point(fxs_camera *camera)
{
    const int64_t distance = (int64_t)1 << (one_in(4) ? 13 : one_in(2) ? 60 : 13 + below(48));
    point_header(chunk_of());
    if (one_in(2))
        camera->width = camera->height = 1 + (int32_t)below(8);
    fxs_camera_init(camera, camera->width, camera->height);
    camera->fx_q12 = one_in(4) ? 1 : one_in(4) ? INT32_MAX : (int32_t)exp2(uniform(0, 31));
    camera->fy_q12 = camera->fx_q12;
    camera->position_q32[2] = -distance;
    camera->near_q32 = 1 << 12;
}

/* Moves the camera sideways by 64 times the depth of an orthographic camera's projection plane, or not at all.
   Enlarges the Gaussians, so that they may still be seen. */
static void move_off_axis(void)
{
    fxs_chunk_view cv;
    fxs_chunk_view_init(&cv, &view, &scene, 0);
    const int64_t side = between(-1, 1) * cv.plane_side + between(-1, 1);
    view.position_q32[below(2)] += cv.shift < 30 ? side * ((int64_t)1 << cv.shift) : 0;
    const int32_t sigma = view.plane_exponent + 4 + (int32_t)below(4);
    set_scale(chunk_of(), (sigma < 32 ? sigma : 32) * 65536);
}

static void make_view(void)
{
    fxs_options options;
    fxs_camera camera;
    fxs_options_init(&options);
    options.sh_degree = (int)below(4);
    const int32_t width = 1 + (int32_t)below(one_in(4) ? FXS_MAX_SIZE : 2000);
    fxs_camera_init(&camera, width, 1 + (int32_t)below(one_in(4) ? FXS_MAX_SIZE : 1200));
    double focal = one_in(2) ? uniform(0.5, 2) * camera.width : exp2(uniform(-11, 18.9));
    camera.fx_q12 = (int32_t)(focal * 4096) + 1;
    camera.fy_q12 = one_in(4) ? INT32_MAX : one_in(2) ? camera.fx_q12 : 1 + (int32_t)(focal * uniform(0.3, 1) * 4096);
    camera.cx_q12 = principal_point(camera.width);
    camera.cy_q12 = principal_point(camera.height);
    random_rotation(&camera);
    camera.near_q32 = one_in(2) ? 0 : (int64_t)exp2(uniform(12, one_in(8) ? 60 : 36));
    place_camera(&camera, one_in(4) ? 0 : one_in(8) ? -1 : exp2(uniform(-4, one_in(4) ? 28 : 5)));
    const int parallel = one_in(3), kind = (int)below(3);
    if (parallel && kind == 1)
        zoom_to_chunk(&camera);
    if (parallel && kind == 2)
        zoom_to_point(&camera);
    camera.projection = parallel ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE;
    CHECK(one_view_init(&view, &scene, &camera, &options) == 0);
    if (parallel && kind == 2 && one_in(2))
        move_off_axis();
    view.cutoff = one_in(16) ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
}

/* ---- Moving scenes ----------------------------------------------------------------------------------------------- */

/* The rows of a chunk of a moving scene, one after the other, as at the end of a file. */
typedef struct moving_chunk {
    fxs_motion_rows motion;
    unsigned char *rows;
} moving_chunk;

/* Makes the rows of motion behind the rows of the scene's chunk. In most rows of one chunk in four, all codes are 0.
   kind 0: all codes are 0; 1 and 2: extreme; 3: small numbers; others: random. */
static moving_chunk make_motion(uint32_t degree, int turns, int fades)
{
    const uint32_t flags = (turns ? FXS_MOTION_TURNS : 0) | (fades ? FXS_MOTION_FADES : 0);
    const uint32_t still = made.header->chunk_bytes, bytes = fxs_motion_bytes(degree, flags);
    moving_chunk m = {{still, degree, one_in(4) ? (uint32_t)next() : below(16 << 16), turns != 0, fades != 0, {0}},
                      allocate(still + bytes)};
    const int calm = one_in(4);
    memcpy(m.rows, made.rows, still);
    for (uint32_t at = still; at < still + bytes; at += 2 * FXS_CHUNK) {
        const uint32_t kind = calm && !one_in(8) ? 0 : below(8), size = below(16);
        for (uint32_t g = 0; g < FXS_CHUNK; g++) {
            const uint32_t bits = (uint32_t)next();
            const int code = kind == 0 ? 0 : kind == 1 || (kind == 2 && bits & 1) ? INT16_MIN
                             : kind == 2 ? INT16_MAX : (int16_t)bits / (1 << (kind == 3 ? size : 0));
            const uint16_t half = fxs_little_16((uint16_t)code);
            memcpy(m.rows + at + 2 * g, &half, sizeof half);
        }
    }
    return m;
}

/* Gives the Gaussians rotation words whose (X, Y) is about 1 long, and spheres, whose X and Y have the fewest bits. */
static void fill_edge_rotations(void)
{
    const uint32_t bits = FXS_AXIS_BITS_LEAST(FXS_PROFILE_DEFAULT);
    memset(made.rows + FXS_ROW_SCALE, 0, 4 * FXS_CHUNK);
    for (uint32_t g = 0; g < FXS_CHUNK; g++) {
        const double angle = uniform(0, 6.2832), length = uniform(32740, 32770);
        const uint32_t x = (uint32_t)lrint(length * cos(angle)), y = (uint32_t)lrint(length * sin(angle));
        const uint32_t word = fxs_little_32((x << 16 & -(1u << (32 - bits))) | (y << 16) >> bits);
        memcpy(made.rows + FXS_ROW_ROTATION + 4 * g, &word, sizeof word);
    }
}

static fxs_moment random_moment(void)
{
    fxs_moment moment = {{0, 0, 0}, (int8_t)between(-15, 4), 1};
    for (int i = 0; i < 3; i++)
        moment.power_q15[i] = (int16_t)(one_in(8) ? 32767 : one_in(8) ? -32767 : between(-32767, 32767));
    return moment;
}

static void animate_case(void)
{
    make_scene();
    if (one_in(2))                     /* any word, also those that are no rotation */
        fill_codes(made.rows, made.header->chunk_bytes, 3);
    else if (scene.profile != FXS_PROFILE_SMALL && one_in(2))
        fill_edge_rotations();
    const moving_chunk m = make_motion(below(FXS_MOTION_DEGREE + 1), one_in(2), one_in(2));
    const fxs_moment moment = random_moment();
    output *rows = output_new(fxs_chunk_bytes(scene.profile, 0), 0);
    fxs_animate_c(&scene, &m.motion, &moment, chunk_of()->scale_step_q24, m.rows, at(rows, 0, 0));
    fast.animate(&scene, &m.motion, &moment, chunk_of()->scale_step_q24, m.rows, at(rows, 1, 0));
    CHECK(same(rows));
    free(m.rows);
}

/* ---- The stages project and shade ------------------------------------------------------------------------------ */

static uint64_t visible_total;
/* bit i: a Gaussian was visible to an orthographic camera with plane_zeros = i - 22, a measure of its zoom */
static uint64_t zooms;

static void count_visible(uint32_t count, int veils)
{
    fxs_chunk_view cv;
    visible_total += count;
    if (count && !veils && view.orthographic && view.cutoff != FXS_CUTOFF_SQUARE &&
        fxs_chunk_view_init(&cv, &view, &scene, 0) == 1)
        zooms |= (uint64_t)1 << (cv.plane_zeros + 22);
}

static int has_veil(const fxs_bounds *bounds, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (bounds[i].half_width_q8 == FXS_EVERYWHERE_Q8)
            return 1;
    return 0;
}

static int shrink(fxs_chunk *c)
{
    if (c->scale_q16 < -(31 << 16))
        return 0;
    set_scale(c, c->scale_q16 - (1 << 16));
    return 1;
}

static const size_t projected_bytes[] = {sizeof(fxs_splat), sizeof(fxs_bounds), sizeof(uint32_t), sizeof(uint32_t)};

static uint32_t project_both(output *const to[4], size_t skew)
{
    uint32_t count[2];
    for (int i = 0; i < 2; i++) {
        fxs_splat *splats = at(to[0], i, skew);
        count[i] = (uint32_t)(i ? fast.project : fxs_project_c)(
            &view, &scene, 0, splats, at(to[1], i, skew), at(to[2], i, skew), at(to[3], i, skew));
        for (uint32_t k = 0; k < count[i]; k++)
            memset(splats[k].colour_q13, 0, sizeof splats[k].colour_q13);
    }
    CHECK(count[0] == count[1]);
    for (int i = 0; i < 4; i++)
        CHECK(!memcmp(at(to[i], 0, skew), at(to[i], 1, skew), count[0] * projected_bytes[i]) &&
              guards_whole(to[i], skew));
    return count[0];
}

/* Compares projection. A chunk (256 Gaussians) with a Gaussian that covers the whole picture runs in plain C.
   Such Gaussians are avoided by halved sigmas. */
static void project_case(void)
{
    const size_t skew = 4 * below(4);
    output *to[4];
    uint32_t count;
    make_scene();
    make_view();
    const int veils = one_in(view.orthographic ? 2 : 8);
    if (one_in(3))
        view.share_q8 = 1 + below(one_in(2) ? 512 : 4096);
    for (int i = 0; i < 4; i++)
        to[i] = output_new(FXS_CHUNK * projected_bytes[i], skew);
    do
        count = project_both(to, skew);
    while (!veils && has_veil(at(to[1], 0, skew), count) && shrink(chunk_of()));
    count_visible(count, has_veil(at(to[1], 0, skew), count));
}

static void shade_case(void)
{
    const uint32_t first_index = below(1u << 22) * FXS_CHUNK, sparse = one_in(2) ? 1 + below(2) : 1 + below(100);
    uint32_t indices[FXS_CHUNK], count = 0;
    make_scene();
    make_view();
    for (uint32_t i = 0; i < FXS_CHUNK; i++)
        if (one_in(sparse))
            indices[count++] = first_index + i;
    output *splats = output_new(count * sizeof(fxs_splat), 4);
    CHECK(fxs_shade_c(&view, &scene, 0, indices, count, at(splats, 0, 4)) == 0);
    CHECK(fast.shade(&view, &scene, 0, indices, count, at(splats, 1, 4)) == 0);
    CHECK(same(splats));
}

static uint64_t rows_total;

static int rows_of(fxs_box box)
{
    int rows = 0;
    for (int row = 0; row < FXS_BOX_TILES; row++)
        rows += (box.bits >> (row / 2 * 12 + row % 2 * 2) & 0x333) != 0;
    return rows;
}

static int compare_words(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void check_notes(const fxs_box *boxes, uint32_t count)
{
    static uint32_t macros[9 * FXS_CHUNK + FXS_NOTES_MORE], listed[9 * FXS_CHUNK + FXS_NOTES_MORE];
    static uint64_t notes[2][9 * FXS_CHUNK];
    const uint32_t first = below(count), some = below(count - first + 1);
    uint32_t noted[2];
    for (int which = 0; which < 2; which++) {
        noted[which] = (which ? fast.note : fxs_note_c)(&view, boxes, first, some, macros, listed);
        for (uint32_t i = 0; i < noted[which]; i++)
            notes[which][i] = (uint64_t)macros[i] << 32 | listed[i];
        qsort(notes[which], noted[which], sizeof **notes, compare_words);
    }
    CHECK(noted[0] == noted[1] && !memcmp(notes[0], notes[1], noted[0] * sizeof **notes));
}

static void check_spans(const fxs_splat *splat, const fxs_bounds *bounds)
{
    fxs_span spans[2][64 + FXS_SPANS_MORE];
    const int32_t first = splat->first_row / FXS_TILE, rows = splat->last_row / FXS_TILE - first + 1;
    const int32_t skipped = (int32_t)below((uint32_t)rows), some = fxs_min(rows - skipped, 64);
    fxs_spans_c(&view, splat, bounds, first + skipped, some, spans[0]);
    fast.spans(&view, splat, bounds, first + skipped, some, spans[1]);
    CHECK(!memcmp(spans[0], spans[1], (size_t)some * sizeof **spans));
}

static void sort_case(void)
{
    const uint32_t most = 1u << below(14), count = below(most) + below(2);
    const uint32_t range = (uint32_t)((uint64_t)UINT32_MAX >> below(33)), usual = range >> below(32);
    const uint32_t base = (uint32_t)next(), crowded = below(100);
    const uint32_t masks = one_in(2) ? 1 : 16, equal = one_in(2) ? 1 : 100;
    output *keys = output_new(count * sizeof(fxs_key), 8), *spare = output_new(count * sizeof(fxs_key), 8);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t depth = base + ((uint32_t)next() & (below(100) < crowded ? usual : range));
        const fxs_key key = FXS_KEY(depth, FXS_LISTED((i ^ 5) / equal + FXS_MAX_SLOTS - most - 8, below(masks)));
        ((fxs_key *)at(keys, 0, 8))[i] = ((fxs_key *)at(keys, 1, 8))[i] = key;
    }
    fxs_sort_c(at(keys, 0, 8), at(spare, 0, 8), count);
    fast.sort(at(keys, 1, 8), at(spare, 1, 8), count);
    CHECK(guards_whole(keys, 8) && guards_whole(spare, 8));
    CHECK(!memcmp(at(keys, 0, 8), at(keys, 1, 8), count * sizeof(fxs_key)));
}

static void list_case(void)
{
    const uint32_t count = below(200), tile = below(4), usual = below(16);
    fxs_key keys[200];
    output *entries = output_new(count * sizeof(uint32_t), 4);
    for (uint32_t i = 0; i < count; i++)
        keys[i] = FXS_KEY(next(), FXS_LISTED(below(FXS_MAX_SLOTS), one_in(2) ? usual : below(16)));
    const uint32_t listed = fxs_list_c(keys, count, tile, at(entries, 0, 4));
    CHECK(fast.list(keys, count, tile, at(entries, 1, 4)) == listed && guards_whole(entries, 4));
    CHECK(!memcmp(at(entries, 0, 4), at(entries, 1, 4), listed * sizeof(uint32_t)));
}

static void bin_case(void)
{
    fxs_splat splats[FXS_CHUNK];
    fxs_bounds bounds[FXS_CHUNK];
    uint32_t indices[FXS_CHUNK], depths[FXS_CHUNK];
    make_scene();
    make_view();
    if (one_in(3)) {
        view.width = 1 + (int32_t)below(80);
        view.height = 1 + (int32_t)below(80);
        view.tiles_x = (view.width + FXS_TILE - 1) / FXS_TILE;
        view.tiles_y = (view.height + FXS_TILE - 1) / FXS_TILE;
    }
    const uint32_t count = (uint32_t)fxs_project_c(&view, &scene, 0, splats, bounds, indices, depths);
    output *boxes = output_new(count * sizeof(fxs_box), 8);
    const fxs_box *box = at(boxes, 0, 8);
    for (int place = 0; place < 32; place++) {
        fxs_bin_c(&view, splats, bounds, count, at(boxes, 0, 8));
        fast.bin(&view, splats, bounds, count, at(boxes, 1, 8));
        CHECK(same(boxes));
        check_notes(box, count);
        for (uint32_t i = below(8); i < count; i += 8)
            check_spans(&splats[i], &bounds[i]);
        for (uint32_t i = 0; i < count; i++) {
            rows_total += rows_of(box[i]) > 1;
            bounds[i].cx_q14 += (int32_t)between(-(1 << 17), 1 << 17);
        }
    }
}

static uint64_t traced_total;

static int32_t extreme(int32_t low, int32_t high)
{
    return one_in(16) ? low : one_in(16) ? high : (int32_t)between(low, high);
}

/* Makes a random splat (projected Gaussian) of 0.55 to 100 pixels near the tile at (x, y). Over the tile, its
   coordinates are within +-128 sigma. */
static void make_splat(fxs_splat *s, int32_t x, int32_t y, int faint)
{
    const double per_pixel = one_in(16) ? 1.83 : one_in(16) ? 0 : exp2(uniform(-6.6, 0.87));
    const double centre_x = uniform(-12, 28), centre_y = uniform(-12, 28);
    const int32_t ux = (int32_t)(per_pixel * 0x1p24), uy = (int32_t)(uniform(-1, 1) * ux);
    const int32_t vy = one_in(8) ? 0 : (int32_t)(uniform(0.2, 1) * ux);
    const uint32_t u = (uint32_t)(int32_t)(-centre_x * ux - centre_y * uy), v = (uint32_t)(int32_t)(-centre_y * vy);
    s->ux_q24 = ux;
    s->uy_q24 = uy;
    s->vy_q24 = vy;
    s->u0_q24 = u - (uint32_t)x * (uint32_t)ux - (uint32_t)y * (uint32_t)uy;
    s->v0_q24 = v - (uint32_t)y * (uint32_t)vy;
    s->offset_q11 = (uint16_t)extreme(faint ? 9000 : 0, FXS_FAINT_Q11);
    for (int c = 0; c < 3; c++)
        s->colour_q13[c] = (int16_t)extreme(0, 32767);
    const double reach = vy ? 3.4 * 0x1p24 / vy + uniform(0.25, one_in(2) ? 1 : 20) : FXS_MAX_SIZE;
    const double first = fmin(y + centre_y - reach, y + FXS_TILE - 1), last = fmax(y + centre_y + reach, y);
    s->first_row = (uint16_t)fmax(first, 0);
    s->last_row = (uint16_t)fmin(last, TILE_COLUMNS * FXS_TILE - 1);
}

static fxs_splat tile_splats[MAX_SPLATS];
static uint32_t tile_entries[MAX_ENTRIES];

static uint32_t make_list(int32_t x, int32_t y)
{
    const uint32_t count = one_in(16) ? 0 : one_in(4) ? below(MAX_ENTRIES) : below(40);
    const int faint = one_in(2), square = one_in(4);
    memset(&view, 0, sizeof view);
    view.width = view.height = TILE_COLUMNS * FXS_TILE;
    view.tiles_x = view.tiles_y = TILE_COLUMNS;
    view.cutoff = square ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
    view.cut_q11 = square ? FXS_LEVEL_MAX_Q11 : FXS_CUT_Q11;
    for (uint32_t i = 0; i < MAX_SPLATS; i++)
        make_splat(&tile_splats[i], x, y, faint);
    for (uint32_t i = 0; i < count; i++)
        tile_entries[i] = below(MAX_SPLATS) | (square && one_in(4) ? FXS_ENTRY_CUT_OFF : 0);
    return count;
}

static void blend_case(void)
{
    const int32_t x = (int32_t)below(TILE_COLUMNS) * FXS_TILE, y = (int32_t)below(TILE_COLUMNS) * FXS_TILE;
    const uint32_t count = make_list(x, y);
    output *tile = output_new(sizeof(fxs_tile), 0);
    fxs_blend_c(&view, x, y, tile_splats, tile_entries, count, at(tile, 0, 0));
    fast.blend(&view, x, y, tile_splats, tile_entries, count, at(tile, 1, 0));
    CHECK(same(tile));
}

static void begin_tile(fxs_tile *tile, fxs_trace *trace)
{
    const int begun = !one_in(3);
    memset(tile, 0, sizeof *tile);
    trace->which = below(16);
    for (int i = 0; i < FXS_TILE_PIXELS; i++) {
        const int t = !begun || one_in(8) ? FXS_CLEAR_Q15 : one_in(8) ? (int)below(2 * FXS_CLOSED_Q15)
                      : one_in(4) ? FXS_HALF_Q15 + (int)between(-3, 3) : (int)below(FXS_CLEAR_Q15 + 1);
        tile->transmittance_q15[i] = (int16_t)t;
        trace->weight_q15[i] = (int16_t)below((uint32_t)(FXS_CLEAR_Q15 - t) + 1);
        for (int c = 0; c < 3 && begun; c++)
            tile->sum_q13[c][i] = (int16_t)extreme(0, 32767);
    }
}

static void begin_part(fxs_trace *trace, uint32_t count)
{
    const int occluded = one_in(2);
    memset(trace->depth_q15, 0, sizeof trace->depth_q15);
    memset(trace->median, 0xff, sizeof trace->median);
    memset(trace->largest, 0xff, sizeof trace->largest);
    for (int i = 0; i < FXS_TILE_PIXELS; i++)
        trace->end[i] = (int16_t)(!occluded || one_in(4) ? INT16_MAX : one_in(8) ? 0 : (int)below(count + 2));
}

static void trace_case(void)
{
    static int16_t depths_q15[MAX_ENTRIES];
    const int32_t x = (int32_t)below(TILE_COLUMNS) * FXS_TILE, y = (int32_t)below(TILE_COLUMNS) * FXS_TILE;
    const uint32_t all = make_list(x, y);
    output *tile = output_new(sizeof(fxs_tile), 0), *trace = output_new(sizeof(fxs_trace), 0);
    begin_tile(at(tile, 0, 0), at(trace, 0, 0));
    for (uint32_t first = 0, part = 0; part < 3 && first <= all; part++) {
        const uint32_t left = all - first, most = left < 512 ? left : 512, count = one_in(2) ? most : below(most + 1);
        begin_part(at(trace, 0, 0), count);
        memcpy(at(tile, 1, 0), at(tile, 0, 0), sizeof(fxs_tile));
        memcpy(at(trace, 1, 0), at(trace, 0, 0), sizeof(fxs_trace));
        for (uint32_t i = 0; i < count; i++)
            depths_q15[i] = (int16_t)extreme(0, 32767);
        fxs_trace_c(&view, x, y, tile_splats, tile_entries, depths_q15, first, first + count, at(tile, 0, 0),
                    at(trace, 0, 0));
        fast.trace(&view, x, y, tile_splats, tile_entries, depths_q15, first, first + count, at(tile, 1, 0),
                   at(trace, 1, 0));
        CHECK(same(tile) && same(trace));
        traced_total += count;
        first += count;
    }
}

static void make_tile(fxs_tile *tile)
{
    const int32_t reach = one_in(2) ? 32767 : 9000;
    for (int i = 0; i < FXS_TILE_PIXELS; i++) {
        tile->transmittance_q15[i] = (int16_t)extreme(0, 32767);
        for (int c = 0; c < 3; c++)
            tile->sum_q13[c][i] = (int16_t)extreme(0, reach);
    }
}

static void resolve_case(void)
{
    fxs_tile tile;
    fxs_options options;
    fxs_options_init(&options);
    for (int c = 0; c < 3; c++)
        options.background[c] = (uint8_t)extreme(0, 255);
    for (int size = 0; size < FXS_TILE_PIXELS * 4; size++) {
        const int32_t columns = size % FXS_TILE + 1, rows = size / FXS_TILE % FXS_TILE + 1;
        const enum fxs_format format = (enum fxs_format)(size / FXS_TILE_PIXELS);
        const uint32_t wide = format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1;
        const ptrdiff_t pitch = (ptrdiff_t)((4 * FXS_TILE + below(MAX_STRIDE - 4 * FXS_TILE)) * wide);
        const ptrdiff_t stride = one_in(4) ? -pitch : pitch;
        const size_t skew = below(32) * wide, first = stride < 0 ? (size_t)(rows - 1) * (size_t)pitch : 0;
        make_tile(&tile);
        output *pixels = output_new((size_t)rows * (size_t)pitch, skew);
        fxs_resolve_c(&options, format, &tile, columns, rows, (unsigned char *)at(pixels, 0, skew) + first, stride);
        fast.resolve(&options, format, &tile, columns, rows, (unsigned char *)at(pixels, 1, skew) + first, stride);
        CHECK(same(pixels));
        outputs_free();
    }
}

static void resolve_every_number(void)
{
    fxs_tile tile;
    fxs_options options;
    fxs_options_init(&options);
    for (int first = 0; first < 32768; first += FXS_TILE_PIXELS)
        for (int i = 0; i < 8; i++) {
            const enum fxs_format format = (enum fxs_format)(i / 2);
            const ptrdiff_t stride = FXS_TILE * fxs_pixel_bytes(format);
            memset(options.background, i % 2 ? 255 : 0, sizeof options.background);
            for (int k = 0; k < FXS_TILE_PIXELS; k++) {
                tile.transmittance_q15[k] = (int16_t)(32767 - first - k);
                for (int c = 0; c < 3; c++)
                    tile.sum_q13[c][k] = (int16_t)(first + k);
            }
            output *pixels = output_new((size_t)(FXS_TILE * stride), 0);
            fxs_resolve_c(&options, format, &tile, FXS_TILE, FXS_TILE, at(pixels, 0, 0), stride);
            fast.resolve(&options, format, &tile, FXS_TILE, FXS_TILE, at(pixels, 1, 0), stride);
            CHECK(same(pixels));
            outputs_free();
        }
}

static void run_cases(void (*one)(void), uint64_t share)
{
    for (uint64_t seed = first_seed; seed <= last_seed && !check_faults; seed++) {
        if (first_seed != last_seed && seed % share)
            continue;
        state = seed;
        one();
        outputs_free();
        if (check_faults)
            printf("  seed %llu\n", (unsigned long long)seed);
    }
}

static void animate(void)
{
    run_cases(animate_case, 1);
}

static void project(void)
{
    visible_total = zooms = 0;
    run_cases(project_case, 1);
    if (!check_faults && first_seed != last_seed)
        CHECK(visible_total > 10 * (last_seed - first_seed));
    if (!check_faults && first_seed != last_seed && last_seed >= ALL_CASES)
        CHECK(zooms & 1 && zooms >> 60 & 1 && __builtin_popcountll(zooms) > 48);
}

static void shade(void)
{
    run_cases(shade_case, 1);
}

static void bin(void)
{
    rows_total = 0;
    run_cases(bin_case, 1);
    if (!check_faults && first_seed != last_seed)
        CHECK(rows_total > 20 * (last_seed - first_seed));
}

static void sort(void)
{
    run_cases(sort_case, 2);
}

static void list(void)
{
    run_cases(list_case, 2);
}

static void blend(void)
{
    run_cases(blend_case, 2);
}

static void trace(void)
{
    traced_total = 0;
    run_cases(trace_case, 2);
    if (!check_faults && first_seed != last_seed)
        CHECK(traced_total > 50 * (last_seed - first_seed));
}

static void resolve(void)
{
    run_cases(resolve_case, 100);
    resolve_every_number();
}

static void test_version(size_t i)
{
    fast = fxs_kernels_c;
    fxs_kernels_choose(&fast, versions[i].cpu);
    printf("%s, %llu of %d cases\n", versions[i].name, (unsigned long long)last_seed, ALL_CASES);
    if (fast.animate != fxs_animate_c)
        RUN(animate);
    if (fast.project != fxs_project_c)
        RUN(project);
    if (fast.shade != fxs_shade_c)
        RUN(shade);
    if (fast.bin != fxs_bin_c)
        RUN(bin);
    if (fast.sort != fxs_sort_c)
        RUN(sort);
    if (fast.list != fxs_list_c)
        RUN(list);
    if (fast.blend != fxs_blend_c)
        RUN(blend);
    if (fast.trace != fxs_trace_c)
        RUN(trace);
    if (fast.resolve != fxs_resolve_c)
        RUN(resolve);
}

#define BENCH_RUNS 200
#define BENCH_CHUNKS 32

static uint64_t ticks(void)
{
#if defined(__x86_64__) || defined(__i386__)
    return __rdtsc();
#elif !defined(CLOCK_MONOTONIC)
    return 0;
#else
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
#endif
}

typedef struct workload {
    packed_scene packed;
    fxs_scene scene;
    fxs_stage_view view;
    moving_chunk moving;
    unsigned char animated[18 * FXS_CHUNK] __attribute__((aligned(64)));
    uint32_t counts[BENCH_CHUNKS], visible;
    fxs_splat splats[BENCH_CHUNKS][FXS_CHUNK];
    fxs_bounds bounds[BENCH_CHUNKS][FXS_CHUNK];
    uint32_t indices[BENCH_CHUNKS][FXS_CHUNK], sparse[BENCH_CHUNKS][FXS_CHUNK], depths[BENCH_CHUNKS][FXS_CHUNK];
    fxs_splat tile_splats[MAX_SPLATS];
    uint32_t entries[MAX_SPLATS];
    fxs_tile tile;
    uint64_t pixels[FXS_TILE_PIXELS];
} workload;

static workload *bench_load;

/* Makes a scene to measure times. A chunk (256 Gaussians) is 0.4 units wide and 5 units away. The focal length
   is 1000 pixels. Sigmas are 1 to 10 pixels. */
static packed_scene bench_scene(enum fxs_profile profile)
{
    static const double low[3] = {-2.8, -1.6, 4}, high[3] = {2.4, 1.2, 6};
    packed_scene p = packed_scene_make(profile, 3, BENCH_CHUNKS * FXS_CHUNK, 0);
    p.header->palette_step_q19 = p.palette ? 2048 : 0;
    for (unsigned char *at = p.palette ? (unsigned char *)p.palette : p.rows; at < p.data + p.bytes; at++)
        *at = (unsigned char)next();
    for (uint32_t i = 0; i < BENCH_CHUNKS; i++) {
        unsigned char *rows = packed_scene_rows(&p, i);
        fxs_chunk *c = &p.chunks[i];
        tame_header(c);
        c->scale_q16 = (int32_t)(-4.32 * 65536);
        c->scale_step_q24 = 53;
        for (int k = 0; k < 3; k++) {
            c->step_q32[k] = (uint32_t)(0.4 * 0x1p32 / 65535);
            c->origin_q32[k] = (int64_t)(uniform(low[k], high[k]) * 0x1p32);
        }
        for (uint32_t k = 0; k < FXS_CHUNK && profile != FXS_PROFILE_SMALL; k++) {
            uint32_t word = (uint32_t)next() & 0x1fffffff;
            memcpy(rows + FXS_ROW_ROTATION + 4 * k, &word, sizeof word);
        }
    }
    return p;
}

static void bench_init(workload *w, enum fxs_profile profile)
{
    static const fxs_camera camera = {.width = 1280, .height = 720, .fx_q12 = 1000 << 12, .fy_q12 = 1000 << 12,
                                      .cx_q12 = 640 << 12, .cy_q12 = 360 << 12,
                                      .rotation_q30 = {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30}};
    fxs_options options;
    fxs_options_init(&options);
    state = 1;
    w->packed = bench_scene(profile);
    CHECK(fxs_scene_open(&w->scene, w->packed.data, w->packed.bytes) == 0);
    CHECK(one_view_init(&w->view, &w->scene, &camera, &options) == 0);
    made = w->packed;
    w->moving = make_motion(FXS_MOTION_DEGREE, 1, 1);
    memset(w->moving.rows + made.header->chunk_bytes + fxs_motion_bytes(FXS_MOTION_DEGREE, FXS_MOTION_TURNS) +
           2 * FXS_CHUNK, 0xff, 2 * FXS_CHUNK);        /* widths of fades that hide no Gaussian */
    for (uint32_t i = 0; i < MAX_SPLATS; i++) {
        make_splat(&w->tile_splats[i], 0, 0, 1);
        w->entries[i] = i;
    }
}

static void bench_animate(workload *w, const fxs_kernels *k)
{
    static const fxs_moment moment = {{20000, 12207, 7451}, -2, 1};
    for (uint32_t i = 0; i < BENCH_CHUNKS; i++)
        k->animate(&w->scene, &w->moving.motion, &moment, w->packed.chunks[0].scale_step_q24, w->moving.rows,
                   w->animated);
}

static void bench_project(workload *w, const fxs_kernels *k)
{
    w->visible = 0;
    for (uint32_t i = 0; i < BENCH_CHUNKS; i++) {
        w->counts[i] = (uint32_t)k->project(&w->view, &w->scene, i, w->splats[i], w->bounds[i], w->indices[i],
                                            w->depths[i]);
        w->visible += w->counts[i];
    }
}

static void bench_shade(workload *w, const fxs_kernels *k)
{
    for (uint32_t i = 0; i < BENCH_CHUNKS; i++)
        k->shade(&w->view, &w->scene, i, w->indices[i], w->counts[i], w->splats[i]);
}

static void bench_sparse(workload *w, const fxs_kernels *k)
{
    for (uint32_t i = 0; i < BENCH_CHUNKS; i++) {
        for (uint32_t g = 0; g < FXS_CHUNK / 16; g++)
            w->sparse[i][g] = i * FXS_CHUNK + 16 * g + (7 * g & 15);
        k->shade(&w->view, &w->scene, i, w->sparse[i], FXS_CHUNK / 16, w->splats[i]);
    }
}

static void bench_blend(workload *w, const fxs_kernels *k)
{
    k->blend(&w->view, 0, 0, w->tile_splats, w->entries, MAX_SPLATS, &w->tile);
}

static void resolve_as(enum fxs_format format, workload *w, const fxs_kernels *k)
{
    static const fxs_options options = {.size = sizeof(fxs_options)};
    k->resolve(&options, format, &w->tile, FXS_TILE, FXS_TILE, (unsigned char *)w->pixels,
               fxs_pixel_bytes(format) * FXS_TILE);
}

static void bench_resolve(workload *w, const fxs_kernels *k)
{
    resolve_as(FXS_FORMAT_RGBA8, w, k);
}

static void bench_rgb565(workload *w, const fxs_kernels *k)
{
    resolve_as(FXS_FORMAT_RGB565, w, k);
}

static void bench_rgba16(workload *w, const fxs_kernels *k)
{
    resolve_as(FXS_FORMAT_RGBA16_COVERAGE, w, k);
}

static double measure(void (*job)(workload *, const fxs_kernels *), const fxs_kernels *kernels, uint32_t units)
{
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < BENCH_RUNS; i++) {
        uint64_t start = ticks();
        job(bench_load, kernels);
        uint64_t took = ticks() - start;
        least = took < least ? took : least;
    }
    return (double)least / units;
}

static void bench_version(const char *name, const fxs_kernels *k)
{
    workload *w = bench_load;
    printf("%-8s", name);
    printf(" %9.1f", measure(bench_animate, k, BENCH_CHUNKS * FXS_CHUNK));
    printf(" %9.1f", measure(bench_project, k, BENCH_CHUNKS * FXS_CHUNK));
    printf(" %9.1f", measure(bench_shade, k, w->visible));
    printf(" %9.1f", measure(bench_sparse, k, BENCH_CHUNKS * FXS_CHUNK / 16));
    printf(" %9.1f", measure(bench_blend, k, MAX_SPLATS));
    printf(" %9.2f", measure(bench_resolve, k, FXS_TILE_PIXELS));
    printf(" %9.2f", measure(bench_rgb565, k, FXS_TILE_PIXELS));
    printf(" %9.2f\n", measure(bench_rgba16, k, FXS_TILE_PIXELS));
}

static void bench(const char *label, enum fxs_profile profile)
{
    fxs_kernels kernels = fxs_kernels_c;
    bench_load = calloc(1, sizeof *bench_load);
    bench_init(bench_load, profile);
    bench_project(bench_load, &kernels);
    printf("%s: %s a Gaussian (animate, project, shade of all, sparse: of 1 in 16), a tile entry (blend), a pixel\n"
           "(resolve, also as RGB565 and RGBA16); %u of %u Gaussians visible\n", label, TICK,
           (unsigned)bench_load->visible, BENCH_CHUNKS * FXS_CHUNK);
    printf("%-8s %9s %9s %9s %9s %9s %9s %9s %9s\n", "", "animate", "project", "shade", "sparse", "blend",
           "resolve", "565", "16");
    bench_version("c", &kernels);
    for (size_t i = 0; i < VERSIONS; i++)
        if (fxs_cpu_detect() & versions[i].cpu) {
            kernels = fxs_kernels_c;
            fxs_kernels_choose(&kernels, versions[i].cpu);
            bench_version(versions[i].name, &kernels);
        }
    free(bench_load->moving.rows);
    free(bench_load->packed.data);
    free(bench_load);
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--bench")) {
        bench("default", FXS_PROFILE_DEFAULT);
        bench("compact", FXS_PROFILE_COMPACT);
        bench("small", FXS_PROFILE_SMALL);
        return check_faults != 0;
    }
    if (argc > 1)
        first_seed = last_seed = strtoull(argv[1], NULL, 0);
    for (size_t i = 0; i < VERSIONS; i++)
        if (fxs_cpu_detect() & versions[i].cpu)
            test_version(i);
    free(made.data);
    return check_report();
}
