/* Opens and renders damaged or random packed scenes. The result must be an error code or a picture. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "one_scene.h"
#include "packed_scene.h"

static uint64_t seed = 88172645463325252u;   /* state of the random generator xorshift64 (Marsaglia 2003) */

static uint32_t bits(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (uint32_t)(seed >> 16);
}

static void *allocate(size_t bytes)
{
    void *memory = 0;
    if (posix_memalign(&memory, 64, bytes)) {
        printf("out of memory\n");
        exit(1);
    }
    memset(memory, 0, bytes);
    return memory;
}

enum { COUNT = 300, CHUNKS = 2, DEGREE = 1 };

static struct {
    unsigned char *bytes;
    size_t size;
    fxs_packed_header *header;
    fxs_chunk *chunks[CHUNKS];
    unsigned char *rows;
    fxs_scene scene;
} s;

static void make_scene_of(enum fxs_profile profile)
{
    const packed_scene p = packed_scene_make(profile, DEGREE, COUNT, 1);
    s.rows = p.rows;
    s.size = p.bytes;
    s.bytes = p.data;
    s.header = p.header;
    for (int i = 0; i < CHUNKS; i++)
        s.chunks[i] = &p.chunks[i];
}

static void make_scene(void)
{
    make_scene_of(FXS_PROFILE_DEFAULT);
}

static int open_scene(void)
{
    memset(&s.scene, 0, sizeof s.scene);
    return fxs_scene_open(&s.scene, s.bytes, s.size);
}

static void test_open(void)
{
    make_scene();
    CHECK(open_scene() == 0);
    CHECK(s.scene.chunks == s.bytes + 192 && s.scene.rows == s.bytes + 192 + 2 * 128);
    CHECK(!s.scene.palette && s.scene.profile == FXS_PROFILE_DEFAULT && s.scene.count == COUNT &&
          s.scene.chunk_count == CHUNKS);
    CHECK(s.scene.chunk_bytes == 256 * (6 + 4 + 4 + 4 + 9) && s.scene.sh_degree == 1 && s.scene.antialiased == 1);
    s.header->flags = 0;
    CHECK(open_scene() == 0 && s.scene.antialiased == 0);
    CHECK(fxs_scene_open(0, s.bytes, s.size) == FXS_ERR_ARGUMENT);
    CHECK(fxs_scene_open(&s.scene, 0, s.size) == FXS_ERR_ARGUMENT);
    free(s.bytes);
}

static void test_open_misaligned(void)
{
    make_scene();
    unsigned char *room = allocate(s.size + 64);
    for (size_t shift = 1; shift < 64; shift++) {
        memcpy(room + shift, s.bytes, s.size);
        CHECK(fxs_scene_open(&s.scene, room + shift, s.size) == FXS_ERR_ARGUMENT);
    }
    free(room);
    free(s.bytes);
}

#define GIVES(error, field, value) do { \
        unsigned char saved[sizeof (field)]; \
        memcpy(saved, &(field), sizeof (field)); \
        (field) = (value); \
        if (!CHECK(open_scene() == (error))) \
            printf("  %s = %s\n", #field, #value); \
        memcpy(&(field), saved, sizeof (field)); \
    } while (0)

static void test_open_damaged_header(void)
{
    make_scene();
    fxs_packed_header *h = s.header;
    for (int bit = 0; bit < 32; bit++) {
        GIVES(FXS_ERR_SCENE, h->magic, FXS_PACKED_MAGIC ^ 1u << bit);
        GIVES(fxs_version_moves(FXS_PACKED_VERSION ^ 1u << bit) ? FXS_ERR_SCENE : FXS_ERR_VERSION,
              h->version, FXS_PACKED_VERSION ^ 1u << bit);
        GIVES(FXS_ERR_SCENE, h->chunk_count, CHUNKS ^ 1u << bit);
        GIVES(FXS_ERR_SCENE, h->chunk_bytes, fxs_chunk_bytes(FXS_PROFILE_DEFAULT, DEGREE) ^ 1u << bit);
        GIVES(FXS_ERR_SCENE, h->sh_degree, DEGREE ^ 1u << bit);
    }
    GIVES(FXS_ERR_SCENE, h->profile, 1);
    GIVES(FXS_ERR_SCENE, h->profile, 3);
    GIVES(FXS_ERR_SCENE, h->profile, UINT32_MAX);
    GIVES(FXS_ERR_SCENE, h->palette_entries, 1);
    GIVES(FXS_ERR_SCENE, h->palette_step_q19, 32768);
    GIVES(FXS_ERR_SCENE, h->count, 0);
    GIVES(FXS_ERR_SCENE, h->count, 256);
    GIVES(0, h->count, 257);
    GIVES(0, h->count, 512);
    GIVES(FXS_ERR_SCENE, h->count, 513);
    GIVES(FXS_ERR_SCENE, h->count, FXS_MAX_COUNT);
    GIVES(FXS_ERR_SCENE, h->count, UINT32_MAX);      /* the number of chunks (256 Gaussians each) overflows to 0 */
    CHECK(open_scene() == 0);
    free(s.bytes);
}

static void test_open_count_at_the_limits(void)
{
    make_scene();
    s.header->chunk_count = 0;
    GIVES(FXS_ERR_SCENE, s.header->count, UINT32_MAX);
    GIVES(FXS_ERR_SCENE, s.header->count, UINT32_MAX - 254);
    GIVES(0, s.header->count, 0);
    s.header->count = FXS_MAX_COUNT;
    GIVES(FXS_ERR_SCENE, s.header->chunk_count, FXS_MAX_COUNT / FXS_CHUNK);
    free(s.bytes);
}

static void check_chunk_ranges(fxs_chunk *c)
{
    const int64_t far = (int64_t)1 << 60;
    GIVES(0, c->step_shift, 12);
    GIVES(FXS_ERR_SCENE, c->step_shift, 13);
    GIVES(FXS_ERR_SCENE, c->step_shift, UINT16_MAX);
    GIVES(0, c->opacity_law, 3);
    GIVES(FXS_ERR_SCENE, c->opacity_law, 4);
    GIVES(FXS_ERR_SCENE, c->opacity_law, UINT16_MAX);
    GIVES(0, c->scale_q16, 32 << 16);
    GIVES(0, c->scale_q16, -(32 << 16));
    GIVES(FXS_ERR_SCENE, c->scale_q16, (32 << 16) + 1);
    GIVES(FXS_ERR_SCENE, c->scale_q16, -(32 << 16) - 1);
    GIVES(FXS_ERR_SCENE, c->scale_q16, INT32_MIN);
    GIVES(0, c->scale_step_q24, 513);   /* the largest valid step of scale codes is 2^21 2^8 / 1023^2 = 513.001 */
    GIVES(FXS_ERR_SCENE, c->scale_step_q24, 514);
    c->scale_q16 = 32 << 16;
    GIVES(0, c->scale_step_q24, 1026);
    GIVES(FXS_ERR_SCENE, c->scale_step_q24, 1027);
    c->scale_q16 = -(32 << 16);
    GIVES(FXS_ERR_SCENE, c->scale_step_q24, 1);
    c->scale_q16 = 0;
    c->scale_step_q24 = 1;
    GIVES(FXS_ERR_SCENE, c->scale_q16, (32 << 16) + 1);
    c->scale_step_q24 = 0;
    GIVES(FXS_ERR_SCENE, c->scale_step_q24, UINT16_MAX);
    for (int i = 0; i < 3; i++) {
        GIVES(0, c->origin_q32[i], far);
        GIVES(0, c->origin_q32[i], -far);
        GIVES(FXS_ERR_SCENE, c->origin_q32[i], far + 1);
        GIVES(FXS_ERR_SCENE, c->origin_q32[i], -far - 1);
        GIVES(FXS_ERR_SCENE, c->origin_q32[i], INT64_MAX);
        GIVES(FXS_ERR_SCENE, c->origin_q32[i], INT64_MIN);
        GIVES(0, c->colour_q16[i], 64 << 16);
        GIVES(FXS_ERR_SCENE, c->colour_q16[i], (64 << 16) + 1);
        GIVES(FXS_ERR_SCENE, c->colour_q16[i], INT32_MIN);
        GIVES(0, c->colour_step_q20[i], 131328);   /* the largest valid step of colour codes is 64 / 511, in Q20 */
        GIVES(FXS_ERR_SCENE, c->colour_step_q20[i], 131329);
        GIVES(FXS_ERR_SCENE, c->colour_step_q20[i], UINT32_MAX);
        GIVES(0, c->sh_step_q19[i], 32767);
        GIVES(FXS_ERR_SCENE, c->sh_step_q19[i], 32768);
        GIVES(FXS_ERR_SCENE, c->sh_step_q19[i], UINT16_MAX);
        c->step_shift = 12;
        GIVES(0, c->step_q32[i], UINT32_MAX);
        c->origin_q32[i] = (int64_t)1 << 50;
        GIVES(FXS_ERR_SCENE, c->step_q32[i], UINT32_MAX);
        c->origin_q32[i] = c->step_shift = 0;
    }
    CHECK(open_scene() == 0);
}

static void test_open_chunk_out_of_range(void)
{
    make_scene();
    for (int i = 0; i < CHUNKS; i++)
        check_chunk_ranges(s.chunks[i]);
    free(s.bytes);
}

static void test_scene_bytes(void)
{
    const enum fxs_profile d = FXS_PROFILE_DEFAULT, compact = FXS_PROFILE_COMPACT, small = FXS_PROFILE_SMALL;
    CHECK(fxs_scene_bytes(0, 0, d, 0) == 192 && fxs_scene_bytes(1, 0, d, 0) == 192 + 128 + 256 * 18);
    CHECK(fxs_scene_bytes(256, 0, d, 0) == fxs_scene_bytes(1, 0, d, 0));
    CHECK(fxs_scene_bytes(257, 0, d, 0) == 2 * fxs_scene_bytes(1, 0, d, 0) - sizeof(fxs_packed_header));
    CHECK(fxs_scene_bytes(256, 3, d, 0) == 192 + 128 + 256 * 63);
    CHECK(fxs_scene_bytes(256, 0, compact, 0) == 192 + 128 + 256 * 18);
    CHECK(fxs_scene_bytes(256, 1, compact, 4) == 192 + 128 + 576 + 256 * 26);
    CHECK(fxs_scene_bytes(256, 2, compact, 4) == 192 + 128 + 576 + 256 * 31);
    CHECK(fxs_scene_bytes(256, 3, compact, 128) == 192 + 128 + 3 * 128 * 48 + 256 * 39);
    CHECK(fxs_scene_bytes(256, 0, small, 0) == 192 + 128 + 256 * 13);
    CHECK(fxs_scene_bytes(512, 1, small, 1) == 192 + 2 * 128 + 4 * 48 + 2 * 256 * 17);
    CHECK(fxs_scene_bytes(1, -1, d, 0) == 0 && fxs_scene_bytes(1, 4, d, 0) == 0);
    CHECK(fxs_scene_bytes(FXS_MAX_COUNT + 1, 0, d, 0) == 0 && fxs_scene_bytes(UINT32_MAX, 3, d, 0) == 0);
    CHECK(fxs_scene_bytes(1, 3, d, 1) == 0 && fxs_scene_bytes(1, 3, small, 0) == 0);
    CHECK(fxs_scene_bytes(1, 3, small, 129) == 0 && fxs_scene_bytes(1, 0, small, 1) == 0);
    CHECK(fxs_scene_bytes(1, 3, (enum fxs_profile)3, 0) == 0 && fxs_scene_bytes(1, 3, (enum fxs_profile)3, 1) == 0);
    CHECK(sizeof(size_t) < 8 ||
          fxs_scene_bytes(FXS_MAX_COUNT, 3, d, 0) == 192 + (size_t)(1 << 22) * (128 + 256 * 63));
}

static void test_frame_bytes(void)
{
    fxs_context context;
    fxs_frame_memory m;
    make_scene();
    CHECK(open_scene() == 0 && fxs_context_init(&context, 0) == 0);
    size_t total = one_frame_bytes(&context, &s.scene, 100, 70, &m);
    CHECK(total > 0 && total == m.total && total == m.splats + m.keys + m.tiles + m.entries && total % 64 == 0);
    CHECK(m.least > 0 && m.least <= total);
    CHECK(one_frame_bytes(&context, &s.scene, 100, 70, 0) == total);
    CHECK(one_frame_bytes(&context, &s.scene, 1, 1, 0) > 0);
    CHECK(one_frame_bytes(&context, &s.scene, FXS_MAX_SIZE, FXS_MAX_SIZE, 0) > total);
    CHECK(one_frame_bytes(0, &s.scene, 100, 70, 0) == 0 && one_frame_bytes(&context, 0, 100, 70, 0) == 0);
    CHECK(one_frame_bytes(&context, &s.scene, 0, 70, 0) == 0 && one_frame_bytes(&context, &s.scene, 100, 0, 0) == 0);
    CHECK(one_frame_bytes(&context, &s.scene, -1, 70, 0) == 0);
    CHECK(one_frame_bytes(&context, &s.scene, FXS_MAX_SIZE + 1, 70, 0) == 0);
    CHECK(one_frame_bytes(&context, &s.scene, 100, INT32_MAX, 0) == 0);
    free(s.bytes);
}

static int64_t any(int most_bits)
{
    int n = (int)(bits() % (uint32_t)(most_bits + 1));
    uint64_t x = (uint64_t)bits() << 32;
    x |= bits();
    int64_t low = (int64_t)(n ? x >> (64 - n) : 0);
    return bits() & 1 ? low : -low;
}

static uint32_t any_unsigned(int most_bits)
{
    int64_t x = any(most_bits);
    return (uint32_t)(x < 0 ? -x : x);
}

static void random_chunk(fxs_chunk *chunk)
{
    do {
        memset(chunk, 0, sizeof *chunk);
        chunk->step_shift = (uint16_t)(bits() % 13);
        chunk->scale_q16 = (int32_t)any(21);
        chunk->scale_step_q24 = (uint16_t)any_unsigned(10);
        for (int i = 0; i < 3; i++) {
            chunk->origin_q32[i] = any(60);
            chunk->step_q32[i] = any_unsigned(32);
            chunk->colour_q16[i] = (int32_t)any(22);
            chunk->colour_step_q20[i] = any_unsigned(19);
            chunk->sh_step_q19[i] = (uint16_t)any_unsigned(15);
        }
    } while (open_scene() != 0);
}

/* Fills a chunk (256 Gaussians) with extreme codes. A rotation word is a run of ones and a run of zeros. Scale
   codes are 0 or the largest. */
static void extreme_codes(unsigned char *rows)
{
    uint32_t *words = (uint32_t *)(void *)(rows + FXS_ROW_ROTATION);
    for (int i = 0; i < FXS_CHUNK; i++)
        words[i] = (bits() & 1 ? UINT32_MAX : 0) ^ (bits() & 1 ? UINT32_MAX >> (1 + bits() % 31) : 0);
    for (int i = FXS_CHUNK; i < 2 * FXS_CHUNK; i++)
        for (int shift = 0; shift < 30; shift += 10) {
            const uint32_t code = (shift < 20 ? 1023u : 511u) << shift;
            words[i] = bits() & 1 ? words[i] | code : words[i] & ~code;
        }
}

static void random_rotation(int32_t m_q30[9])
{
    double q[4], norm = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = bits() & 1 ? (double)any(20) : 0;
        norm += q[i] * q[i];
    }
    norm = norm > 0 ? norm : (q[0] = 1);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double m[9] = {norm - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), norm - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), norm - 2 * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        m_q30[i] = (int32_t)floor(ldexp(m[i] / norm, 30) + 0.5);
}

static void random_camera(fxs_camera *camera)
{
    memset(camera, 0, sizeof *camera);
    camera->width = (int32_t)(1 + bits() % 40);
    camera->height = (int32_t)(1 + bits() % 40);
    camera->fx_q12 = (int32_t)(1 + any_unsigned(31) % INT32_MAX);
    camera->fy_q12 = (int32_t)(1 + any_unsigned(31) % INT32_MAX);
    camera->cx_q12 = (int32_t)any(31);
    camera->cy_q12 = (int32_t)any(31);
    random_rotation(camera->rotation_q30);
    for (int i = 0; i < 3; i++)
        camera->position_q32[i] = any(60);
}

static void move_close(fxs_camera *camera)
{
    const int64_t limit = (int64_t)1 << 60;
    camera->fx_q12 = camera->fy_q12 = (int32_t)(1 << (14 + bits() % 6));
    camera->cx_q12 = camera->width << 11;
    camera->cy_q12 = camera->height << 11;
    for (int i = 0; i < 3; i++) {
        int64_t step = (int64_t)s.chunks[0]->step_q32[i] << s.chunks[0]->step_shift;
        int64_t p = s.chunks[0]->origin_q32[i] + step * (bits() % 65536) + any(34);
        camera->position_q32[i] = p > limit ? limit : p < -limit ? -limit : p;
    }
}

static int same_rows(const unsigned char *a, const unsigned char *b, int32_t width, int32_t height)
{
    while (height-- > 0)
        if (memcmp(a + height * 160, b + height * 160, (size_t)width * 4))
            return 0;
    return 1;
}

static uint32_t render_random(const fxs_context *context)
{
    fxs_camera camera;
    fxs_stats stats = {0};
    const uint32_t choice = bits();
    fxs_options options = {.size = sizeof(fxs_options), .cutoff = (enum fxs_cutoff)(choice & 1),
                           .sh_degree = (int)(choice >> 30)};
    unsigned char pixels[40 * 40 * 4], in_bands[40 * 40 * 4];
    fxs_frame_memory sizes;
    random_camera(&camera);
    if (bits() % 8)
        move_close(&camera);
    size_t size = one_frame_bytes(context, &s.scene, camera.width, camera.height, &sizes);
    void *memory = allocate(size);
    CHECK(one_render(context, &s.scene, &camera, &options, FXS_FORMAT_RGBA8, memory, size, pixels, 160, &stats) == 0);
    free(memory);
    size = sizes.least + (size - sizes.least) / 4;
    memory = allocate(size);
    int error = one_render(context, &s.scene, &camera, &options, FXS_FORMAT_RGBA8, memory, size, in_bands, 160, 0);
    CHECK(error == FXS_ERR_MEMORY || (!error && same_rows(pixels, in_bands, camera.width, camera.height)));
    free(memory);
    return stats.visible;
}

static void check_random_bytes(enum fxs_profile profile)
{
    uint64_t visible = 0;
    fxs_context context;
    make_scene_of(profile);
    CHECK(fxs_context_init(&context, 0) == 0);
    for (int i = 0; i < 2000; i++) {
        for (size_t at = sizeof *s.header; at < s.size; at += 4)
            memcpy(s.bytes + at, &(uint32_t){bits()}, 4);
        memset(s.chunks[1], 0, sizeof *s.chunks[1]);
        s.header->palette_step_q19 = bits() % 32768;
        random_chunk(s.chunks[0]);
        random_chunk(s.chunks[1]);
        if (i % 4 == 0)
            extreme_codes(s.rows);
        visible += render_random(&context);
    }
    if (!CHECK(visible > 10000))
        printf("  only %d Gaussians were visible\n", (int)visible);
    free(s.bytes);
}

static void test_random_bytes(void)
{
    check_random_bytes(FXS_PROFILE_DEFAULT);
    check_random_bytes(FXS_PROFILE_COMPACT);
    check_random_bytes(FXS_PROFILE_SMALL);
}

int main(void)
{
    RUN(test_open);
    RUN(test_open_misaligned);
    RUN(test_open_damaged_header);
    RUN(test_open_count_at_the_limits);
    RUN(test_open_chunk_out_of_range);
    RUN(test_scene_bytes);
    RUN(test_frame_bytes);
    RUN(test_random_bytes);
    return check_report();
}
