/* Random packed scenes, cameras and options, drawn small; the hashes of all frames folded into one constant that
 * every compiler, optimisation level and processor must give. `test_random N` prints the hash of case N alone. Needs
 * src/ only. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../src/fixsplat.h"
#include "../src/packed.h"
#include "check.h"

#define CASES 300
#define EXPECTED 0x2df0384c9cc4811au

static uint64_t state;

/* splitmix64 (Steele, Lea, Flood 2014) */
static uint64_t next(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(next() % (uint64_t)((int64_t)high - low + 1));
}

static void fill_chunk(unsigned char *bytes, uint32_t chunk_bytes)
{
    fxs_chunk *chunk = (fxs_chunk *)(void *)bytes;
    memset(bytes, 0, sizeof *chunk);
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = (int64_t)between(-3145728, 3145728) * 4096;
        chunk->step_q32[i] = (uint32_t)next() >> between(8, 20);
        chunk->colour_q16[i] = between(-20000, 60000);
        chunk->colour_step_q20[i] = (uint32_t)between(0, 8000);
        chunk->sh_step_q19[i] = (uint32_t)between(0, 2000);
    }
    chunk->scale_q16 = between(-393216, 65536);
    chunk->scale_step_q24 = (uint32_t)between(0, 200);
    for (uint32_t at = sizeof *chunk; at < chunk_bytes; at += 4) {
        uint32_t word = (uint32_t)next();
        memcpy(bytes + at, &word, 4);
    }
}

static void *random_scene(size_t *bytes)
{
    int degree = between(0, 3);
    uint32_t count = (uint32_t)between(1, 3000);
    *bytes = fxs_scene_bytes(count, degree);
    unsigned char *data = check_aligned(*bytes);
    fxs_packed_header header = {FXS_PACKED_MAGIC, FXS_PACKED_VERSION, count, (count + FXS_CHUNK - 1) / FXS_CHUNK,
                                FXS_CHUNK_BYTES(degree), (uint32_t)degree, (uint32_t)between(0, 1),
                                {0}, {0}, {0}, {0}, {0}};
    if (!data)
        abort();
    memcpy(data, &header, sizeof header);
    for (uint32_t c = 0; c < header.chunk_count; c++)
        fill_chunk(data + sizeof header + (size_t)c * header.chunk_bytes, header.chunk_bytes);
    return data;
}

/* A rotation about one axis by a Pythagorean angle, so that it is exact enough in integers. */
static void random_camera(fxs_camera *camera)
{
    static const int32_t triples[][3] = {{1, 0, 1}, {3, 4, 5}, {5, 12, 13}, {8, 15, 17}, {-7, 24, 25}, {-20, 21, 29}};
    const int32_t *t = triples[between(0, 5)];
    int32_t c = (int32_t)(t[0] * (INT64_C(1) << 30) / t[2]), s = (int32_t)(t[1] * (INT64_C(1) << 30) / t[2]);
    int axis = between(0, 2), a = (axis + 1) % 3, b = (axis + 2) % 3;
    memset(camera, 0, sizeof *camera);
    camera->rotation_q30[axis * 4] = 1 << 30;
    camera->rotation_q30[a * 3 + a] = camera->rotation_q30[b * 3 + b] = c;
    camera->rotation_q30[a * 3 + b] = -s;
    camera->rotation_q30[b * 3 + a] = s;
    camera->width = between(1, 100);
    camera->height = between(1, 80);
    camera->fx_q12 = between(20 << 12, 200 << 12);
    camera->fy_q12 = camera->fx_q12 + between(0, 10 << 12);
    camera->cx_q12 = camera->width * 2048 + between(-40000, 40000);
    camera->cy_q12 = camera->height * 2048;
    for (int i = 0; i < 3; i++)
        camera->position_q32[i] = (int64_t)between(-4194304, 4194304) * 4096;
}

static uint64_t hash_case(int which)
{
    state = (uint64_t)which * 0x1234567u;
    size_t scene_bytes;
    void *data = random_scene(&scene_bytes);
    fxs_scene scene;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    random_camera(&camera);
    fxs_init(&context, 0);
    fxs_options_default(&options);
    options.cutoff = between(0, 3) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    options.format = (enum fxs_format)between(0, 1);
    options.background[0] = (uint8_t)between(0, 255);
    if (!CHECK(fxs_scene_open(&scene, data, scene_bytes) == 0))
        exit(1);
    size_t bytes = fxs_frame_bytes(&context, &scene, camera.width, camera.height, 0);
    size_t pixels = (size_t)camera.width * (size_t)camera.height * 4;
    void *memory = check_aligned(bytes);
    uint8_t *rgba = malloc(pixels);
    if (!CHECK(memory && rgba && !fxs_render(&context, &scene, &camera, &options, memory, bytes, rgba,
                                             (ptrdiff_t)camera.width * 4, 0)))
        exit(1);
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < pixels; i++)
        hash = (hash ^ rgba[i]) * 0x100000001b3u;
    free(rgba);
    free(memory);
    free(data);
    return hash;
}

static void test_one_constant(void)
{
    uint64_t sum = 0;
    for (int i = 0; i < CASES; i++)
        sum = sum * 3 + hash_case(i);
    printf("  %d random frames: %016" PRIx64 "\n", CASES, sum);
    CHECK(sum == EXPECTED);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        printf("%016" PRIx64 "\n", hash_case(atoi(argv[1])));
        return 0;
    }
    RUN(test_one_constant);
    return check_report();
}
