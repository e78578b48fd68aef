/* Moving scenes: packed motion against formulas in doubles, times, memory, threads and kernels. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "check.h"
#include "uniform.h"

enum { COUNT = 6000, WIDTH = 200, HEIGHT = 150, PIXELS = WIDTH * HEIGHT };

/* A cloud of Gaussians that move, made from random numbers. */
typedef struct cloud {
    uint32_t count;
    fxs_time time;
    fxs_gaussian *gaussians;
    fxs_motion *motions;
} cloud;

static void make_one(const cloud *c, fxs_gaussian *g, fxs_motion *m)
{
    const double duration = c->time.duration;
    memset(g, 0, sizeof *g);
    memset(m, 0, sizeof *m);
    for (int i = 0; i < 3; i++) {
        g->position[i] = (float)uniform(-2, 2);
        g->scale[i] = (float)uniform(-4.5, -2.5);
        g->dc[i] = (float)uniform(-1.5, 1.5);
        for (int k = 0; k < c->time.degree; k++)
            m->drift[k][i] = (float)(uniform(-1, 1) / pow(duration, k + 1));
    }
    for (int i = 0; i < 45; i++)
        g->sh[i] = (float)uniform(-0.2, 0.2);
    for (int i = 0; i < 4; i++) {
        g->rotation[i] = (float)uniform(-1, 1);
        m->turn[i] = c->time.turns ? (float)(uniform(-0.7, 0.7) / duration) : 0;
    }
    g->opacity = (float)uniform(-1, 4);
    m->centre = (float)uniform(-0.1 * duration, 1.1 * duration);
    m->fade = c->time.fades ? (float)(duration * exp(uniform(-3, 1))) : INFINITY;
    m->from = -INFINITY;
    m->to = INFINITY;
}

static cloud make_cloud(uint32_t count, fxs_time time)
{
    cloud c = {count, time, calloc(count, sizeof *c.gaussians), calloc(count, sizeof *c.motions)};
    for (uint32_t i = 0; i < count; i++)
        make_one(&c, &c.gaussians[i], &c.motions[i]);
    return c;
}

static void free_cloud(cloud *c)
{
    free(c->gaussians);
    free(c->motions);
}

static long give(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    memcpy(out, ((const cloud *)argument)->gaussians + first, capacity * sizeof *out);
    return (long)capacity;
}

static int give_motions(void *argument, uint64_t first, fxs_motion *out, size_t count)
{
    memcpy(out, ((const cloud *)argument)->motions + first, count * sizeof *out);
    return 0;
}

static int open_cloud(cloud *c, int sh_degree, fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_gaussian_source gaussians = {c->count, sh_degree, 0, give, c, {0}};
    fxs_motion_source motions;
    fxs_motion_source_init(&motions);
    motions.time = c->time;
    motions.read = give_motions;
    motions.argument = c;
    return fxs_scene_file_open_moving("cloud", &gaussians, &motions, 0, file, info, message);
}

/* Packs a cloud; with seconds >= 0 as it is then, else with its motion. With `threads`, it gets levels of detail. */
static int pack_levels(cloud *c, int sh_degree, enum fxs_profile profile, double seconds, uint32_t threads,
                       fxs_packed_scene *packed)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    fxs_pack_options options;
    fxs_message message;
    fxs_pool *pool = threads > 1 ? fxs_pool_create(threads) : 0;
    fxs_pack_options_init(&options);
    options.profile = profile;
    options.tree = threads > 0;
    if (pool)
        options.workers = (fxs_workers){fxs_pool_run, pool, threads};
    int error = open_cloud(c, sh_degree, &file, &info, &message);
    if (!error && seconds >= 0)
        error = fxs_scene_file_at(file, seconds, &info, &message);
    if (!error)
        error = fxs_pack(file, &info, packed, &report, &options, &message);
    if (error)
        printf("  %s\n", message.text);
    fxs_scene_file_close(file);
    if (pool)
        fxs_pool_destroy(pool);
    return error;
}

static int pack_cloud(cloud *c, int sh_degree, enum fxs_profile profile, double seconds, fxs_packed_scene *packed)
{
    return pack_levels(c, sh_degree, profile, seconds, 0, packed);
}

typedef struct drawing {
    fxs_request request;
    fxs_object object;
    fxs_scene scene;
    uint8_t pixels[4 * PIXELS];
    uint32_t budget;
    fxs_stats stats;
} drawing;

static void look(fxs_camera *camera, double turn)
{
    fxs_camera_init(camera, WIDTH, HEIGHT);
    const double c = cos(turn), s = sin(turn), r[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
    for (int i = 0; i < 9; i++)
        camera->rotation_q30[i] = (int32_t)lrint(ldexp(r[i], 30));
    camera->position_q32[0] = (int64_t)llrint(ldexp(-6 * s, 32));
    camera->position_q32[2] = (int64_t)llrint(ldexp(-6 * c, 32));
}

static int draw(drawing *d, const void *data, size_t bytes, double seconds, double turn, const fxs_kernels *kernels,
                size_t memory_bytes, uint32_t threads)
{
    fxs_config config;
    fxs_context context;
    fxs_config_init(&config);
    fxs_pool *pool = threads > 1 ? fxs_pool_create(threads) : 0;
    config.kernels = kernels;
    if (pool)
        config.workers = (fxs_workers){fxs_pool_run, pool, threads};
    int error = fxs_scene_open(&d->scene, data, bytes);
    error = error ? error : fxs_context_init(&context, &config);
    fxs_object_init(&d->object, &d->scene);
    fxs_request_init(&d->request, &d->object, 1);
    look(&d->request.cameras[0], turn);
    d->request.options.time_q32 = (int64_t)llrint(ldexp(seconds, 32));
    d->request.options.budget = d->budget;
    d->request.targets[0].colour = (fxs_image){d->pixels, 4 * WIDTH};
    const size_t whole = error ? 0 : fxs_request_bytes(&context, &d->request, 0);
    const size_t room = memory_bytes && memory_bytes < whole ? memory_bytes : whole;
    void *memory = check_aligned(room);
    error = error ? error : fxs_render(&context, &d->request, memory, room, &d->stats);
    free(memory);
    if (pool)
        fxs_pool_destroy(pool);
    return error;
}

static double psnr(const uint8_t *a, const uint8_t *b)
{
    double sum = 0;
    for (int i = 0; i < 4 * PIXELS; i++)
        sum += (double)(a[i] - b[i]) * (a[i] - b[i]) * 4 / 3;
    return sum > 0 ? 10 * log10(255.0 * 255 * 4 * PIXELS / sum) : 99;
}

static const fxs_time every = {.duration = 3, .rate = 0, .loops = 1, .degree = 3, .turns = 1, .fades = 1, .least = 0};

/* The picture of a moving scene equals nearly the picture of its Gaussians moved in doubles. */
static void pictures_follow_the_formulas(void)
{
    static drawing a, b;
    static const double floors[] = {58, 44, 44};       /* compact: random SH are no palette */
    for (int profile = 0; profile < 3; profile++)
        for (int kind = 0; kind < 4; kind++) {
            fxs_time time = every;
            time.turns = kind >= 2;
            time.fades = kind & 1;
            time.degree = kind == 0 ? 1 : 3;
            cloud c = make_cloud(COUNT, time);
            fxs_packed_scene moving, still;
            double sum = 0, least = 99;
            if (CHECK(!pack_cloud(&c, profile == 1 ? 3 : 1, (enum fxs_profile)profile, -1, &moving)))
                for (int i = 0; i <= 6; i++) {
                    const double t = 0.499 * i;
                    if (!CHECK(!pack_cloud(&c, profile == 1 ? 3 : 1, FXS_PROFILE_DEFAULT, t, &still)))
                        break;
                    CHECK(!draw(&a, moving.data, moving.bytes, t + 3 * i, 0.3 * i, &fxs_kernels_c, 0, 1));
                    CHECK(!draw(&b, still.data, still.bytes, 0, 0.3 * i, &fxs_kernels_c, 0, 1));
                    const double db = psnr(a.pixels, b.pixels);
                    sum += db;
                    least = db < least ? db : least;
                    fxs_packed_scene_free(&still);
                }
            printf("  profile %d kind %d: mean %.2f least %.2f dB, %.1f bytes a Gaussian\n", profile, kind, sum / 7,
                   least, (double)moving.bytes / COUNT);
            CHECK(sum / 7 >= floors[profile]);
            fxs_packed_scene_free(&moving);
            free_cloud(&c);
        }
}

static void memory_threads_and_kernels_give_the_same_bytes(void)
{
    static drawing whole, other;
    cloud c = make_cloud(COUNT, every);
    fxs_packed_scene moving;
    fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    if (!CHECK(!pack_cloud(&c, 2, FXS_PROFILE_DEFAULT, -1, &moving)))
        return;
    for (int i = 0; i < 10; i++) {
        const double t = uniform(-1, 7), turn = uniform(-3, 3);
        CHECK(!draw(&whole, moving.data, moving.bytes, t, turn, &fxs_kernels_c, 0, 1));
        static const size_t rooms[] = {0, 400000, 160000, 90000};
        for (int k = 0; k < 8; k++) {
            const int error = draw(&other, moving.data, moving.bytes, t, turn, k & 1 ? &fastest : &fxs_kernels_c,
                                   rooms[k / 2], 1 + (uint32_t)k % 3);
            if (error == FXS_ERR_MEMORY && k > 4)
                continue;
            CHECK(!error && !memcmp(whole.pixels, other.pixels, sizeof whole.pixels));
        }
    }
    fxs_packed_scene_free(&moving);
    free_cloud(&c);
}

/* ---- Levels of detail -------------------------------------------------------------------------------------------- */

static void node_times_hold_those_below(const fxs_packed_scene *packed)
{
    fxs_scene scene;
    CHECK(!fxs_scene_open(&scene, packed->data, packed->bytes) && scene.nodes && scene.motion);
    const fxs_chunk_motion *motions = (const void *)(scene.motion + sizeof(fxs_motion_header));
    for (uint32_t i = 0; i < scene.chunk_count - 1; i++) {
        fxs_node node;
        fxs_chunk_motion own = motions[scene.chunk_count + i];
        memcpy(&node, scene.nodes + i * sizeof node, sizeof node);
        fxs_node_turn(&node);
        fxs_chunk_motion_turn(&own);
        for (int side = 0; side < 2; side++) {
            fxs_chunk_motion below = motions[node.children[side]];
            fxs_chunk_motion_turn(&below);
            CHECK(own.from_q16 <= below.from_q16 && own.to_q16 >= below.to_q16);
        }
    }
}

/* Without a budget, the picture is that of the scene without levels. With one, it is like it. The bytes of scene and
   pictures do not depend on threads, memory and kernels. */
static void levels_of(cloud *c, enum fxs_profile profile, double floor)
{
    static drawing whole, some, other;
    fxs_packed_scene plain, alone, levels;
    fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    if (!CHECK(!pack_cloud(c, 1, profile, -1, &plain)) || !CHECK(!pack_levels(c, 1, profile, -1, 1, &alone)) ||
        !CHECK(!pack_levels(c, 1, profile, -1, 3, &levels)))
        return;
    CHECK(alone.bytes == levels.bytes && !memcmp(alone.data, levels.data, levels.bytes));
    node_times_hold_those_below(&levels);
    double sum = 0;
    for (int i = 0; i < 6; i++) {
        const double t = 0.499 * i, turn = 0.5 * i;
        some.budget = other.budget = 0;
        CHECK(!draw(&whole, plain.data, plain.bytes, t, turn, &fxs_kernels_c, 0, 1));
        CHECK(!draw(&some, levels.data, levels.bytes, t, turn, &fxs_kernels_c, 0, 1));
        CHECK(!memcmp(whole.pixels, some.pixels, sizeof whole.pixels));
        some.budget = other.budget = COUNT / 2;
        CHECK(!draw(&some, levels.data, levels.bytes, t, turn, &fxs_kernels_c, 0, 1));
        CHECK(some.stats.drawn <= some.budget && memcmp(whole.pixels, some.pixels, sizeof whole.pixels));
        CHECK(!draw(&other, levels.data, levels.bytes, t, turn, &fastest, 160000, 3));
        CHECK(!memcmp(other.pixels, some.pixels, sizeof some.pixels));
        sum += psnr(whole.pixels, some.pixels) / 6;
    }
    printf("  profile %d: %.2f dB with half of the Gaussians\n", (int)profile, sum);
    CHECK(sum >= floor);
    fxs_packed_scene_free(&plain);
    fxs_packed_scene_free(&alone);
    fxs_packed_scene_free(&levels);
}

static void moving_scenes_have_levels(void)
{
    for (int profile = 0; profile < 3; profile++)
        for (int fades = 0; fades < 2; fades++) {
            fxs_time time = every;
            time.fades = fades;
            cloud c = make_cloud(COUNT, time);
            levels_of(&c, (enum fxs_profile)profile, 23);
            free_cloud(&c);
        }
}

/* ---- Bad input --------------------------------------------------------------------------------------------------- */

static unsigned char *motion_of(const fxs_packed_scene *packed, fxs_motion_header *header)
{
    fxs_scene scene;
    CHECK(!fxs_scene_open(&scene, packed->data, packed->bytes) && scene.motion);
    memcpy(header, scene.motion, sizeof *header);
    fxs_motion_header_turn(header);
    return (unsigned char *)packed->data + (scene.motion - (unsigned char *)packed->data);
}

static void put_header(unsigned char *to, fxs_motion_header header)
{
    fxs_motion_header_turn(&header);
    memcpy(to, &header, sizeof header);
}

static int draws(const fxs_packed_scene *packed)
{
    static drawing d;
    return draw(&d, packed->data, packed->bytes, 0.7, 0.2, &fxs_kernels_c, 0, 1);
}

static void wrong_motion_is_refused(void)
{
    cloud c = make_cloud(COUNT, every);
    fxs_packed_scene packed;
    fxs_motion_header h, wrong;
    fxs_chunk_motion chunk;
    if (!CHECK(!pack_cloud(&c, 0, FXS_PROFILE_DEFAULT, -1, &packed)))
        return;
    unsigned char *at = motion_of(&packed, &h);
    CHECK(!draws(&packed) && h.degree == 3 && h.flags == (FXS_MOTION_LOOPS | FXS_MOTION_TURNS | FXS_MOTION_FADES));
    for (int field = 0; field < 6; field++) {
        wrong = h;
        switch (field) {
        case 0: wrong.magic++; break;
        case 1: wrong.duration_q16 = 0; break;
        case 2: wrong.degree = 2; break;
        case 3: wrong.flags &= ~FXS_MOTION_TURNS; break;
        case 4: wrong.most_chunks = 0; break;
        case 5: wrong.most_chunks = 1; break;        /* opens, but a frame finds more chunks than it has room for */
        }
        put_header(at, wrong);
        CHECK(draws(&packed) == FXS_ERR_SCENE);
    }
    put_header(at, h);
    memcpy(&chunk, at + sizeof h, sizeof chunk);
    chunk.unit = 31;
    memcpy(at + sizeof h, &chunk, sizeof chunk);
    CHECK(draws(&packed) == FXS_ERR_SCENE);
    fxs_packed_scene_free(&packed);
    free_cloud(&c);
}

/* Any bytes of motion give a picture or FXS_ERR_SCENE. Sanitizers watch. */
/* `threads` as for pack_levels. */
static void random_motion_of(cloud *c, uint32_t threads)
{
    static drawing d;
    fxs_packed_scene packed;
    fxs_motion_header h;
    if (!CHECK(!pack_levels(c, 1, FXS_PROFILE_SMALL, -1, threads, &packed)))
        return;
    unsigned char *at = motion_of(&packed, &h);
    const size_t left = (size_t)((unsigned char *)packed.data + packed.bytes - at);
    for (int i = 0; i < 200; i++) {
        for (int k = 0; k < 50; k++)
            at[(size_t)uniform(k < 40 ? 64 : 0, k < 10 ? 128 : (double)left)] ^= (unsigned char)uniform(1, 256);
        d.budget = i % 3 ? (uint32_t)uniform(1, COUNT / 4) : 0;
        const int error = draw(&d, packed.data, packed.bytes, 0.7, 0.2, &fxs_kernels_c, 0, 1);
        CHECK(error == 0 || error == FXS_ERR_SCENE);
        put_header(at, h);
    }
    fxs_packed_scene_free(&packed);
}

static void random_motion_is_safe(void)
{
    cloud c = make_cloud(COUNT / 4, every);
    random_motion_of(&c, 0);
    random_motion_of(&c, 1);
    free_cloud(&c);
}

/* Motions that cannot be drawn are dropped and counted. */
static void wrong_gaussians_are_dropped(void)
{
    cloud c = make_cloud(300, every);
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_message message;
    c.motions[0].centre = NAN;
    c.motions[1].fade = 0;
    c.motions[2].fade = -1;
    c.motions[3].drift[2][1] = INFINITY;
    c.motions[4].turn[3] = NAN;
    c.motions[5].from = c.motions[5].to = 1;
    c.motions[6].fade = NAN;
    c.motions[7].drift[0][0] = 1e17f;            /* usable, but leaves every box */
    CHECK(!open_cloud(&c, 0, &file, &info, &message));
    CHECK(!fxs_pack(file, &info, &packed, &report, 0, &message));
    CHECK(report.dropped.not_finite == 7 && report.packed == 293 && !draws(&packed));
    CHECK(report.limited == 1);
    fxs_packed_scene_free(&packed);
    fxs_scene_file_close(file);
    c.time.duration = NAN;
    CHECK(open_cloud(&c, 0, &file, &info, &message) == FXS_ERR_ARGUMENT && !file);
    c.time.duration = 1e6;
    CHECK(open_cloud(&c, 0, &file, &info, &message) == FXS_ERR_ARGUMENT && !file);
    free_cloud(&c);
}

/* A frame does not depend on the frames before it: times in any order, and times that loop. */
static void frames_do_not_depend_on_the_order(void)
{
    enum { TIMES = 24 };
    static drawing d;
    static uint8_t first[TIMES][4 * PIXELS];
    cloud c = make_cloud(COUNT, every);
    fxs_packed_scene packed;
    if (!CHECK(!pack_cloud(&c, 0, FXS_PROFILE_DEFAULT, -1, &packed)))
        return;
    for (int i = 0; i < TIMES; i++) {
        CHECK(!draw(&d, packed.data, packed.bytes, 0.125 * i, 0.1 * i, &fxs_kernels_c, 0, 1));
        memcpy(first[i], d.pixels, sizeof first[i]);
    }
    for (int k = 0; k < TIMES; k++) {
        const int i = (k * 7 + 5) % TIMES;
        CHECK(!draw(&d, packed.data, packed.bytes, 0.125 * i - 3 * (k % 4), 0.1 * i, &fxs_kernels_c, 0, 1));
        CHECK(!memcmp(d.pixels, first[i], sizeof first[i]));
    }
    fxs_packed_scene_free(&packed);
    free_cloud(&c);
}

int main(void)
{
    RUN(pictures_follow_the_formulas);
    RUN(memory_threads_and_kernels_give_the_same_bytes);
    RUN(frames_do_not_depend_on_the_order);
    RUN(moving_scenes_have_levels);
    RUN(wrong_motion_is_refused);
    RUN(random_motion_is_safe);
    RUN(wrong_gaussians_are_dropped);
    return check_report();
}
