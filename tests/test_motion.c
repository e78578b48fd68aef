/* Moving scenes: packed motion against formulas in doubles, times, memory, threads, kernels and edits. */
#include <math.h>
#include <string.h>

#include <fixsplat/fit.h>
#include <fixsplat/internal/edits.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>
#include <fixsplat/internal/time_range.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/world.h>
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

static int draw_request(drawing *d, const fxs_context *context, size_t memory_bytes)
{
    d->request.targets[0].colour = (fxs_image){d->pixels, 4 * WIDTH};
    const size_t whole = fxs_request_bytes(context, &d->request, 0);
    const size_t room = memory_bytes && memory_bytes < whole ? memory_bytes : whole;
    void *memory = check_aligned(room);
    const int error = fxs_render(context, &d->request, memory, room, &d->stats);
    free(memory);
    return error;
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
    error = error ? error : draw_request(d, &context, memory_bytes);
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

/* ---- Edits ------------------------------------------------------------------------------------------------------- */

/* Gaussians of a stream, with their motions if it moves. */
typedef struct list {
    fxs_gaussian *gaussians;
    fxs_motion *motions;
    long count;
    fxs_scene_file_info info;
} list;

/* Reads a stream to its end twice, with different numbers of Gaussians at once, and closes it. */
static list read_list(fxs_scene_file *file, const fxs_scene_file_info *info)
{
    enum { FIRST = 1000, AGAIN = 7 };
    fxs_message message;
    fxs_gaussian one[AGAIN];
    const size_t room = (size_t)info->count + FIRST;
    list l = {calloc(room, sizeof *l.gaussians), calloc(room, sizeof *l.motions), 0, *info};
    long n, again = 0;
    while ((n = fxs_scene_file_read(file, l.gaussians + l.count, FIRST, &message)) > 0 &&
           CHECK((uint64_t)(l.count + n) <= info->count)) {
        const fxs_motion *motions = fxs_scene_file_motions(file);
        if (CHECK((motions != NULL) == (info->time.duration > 0)) && motions)
            memcpy(l.motions + l.count, motions, (size_t)n * sizeof *motions);
        l.count += n;
    }
    CHECK(n == 0 && (uint64_t)l.count == info->count && fxs_scene_file_rewind(file, &message) == 0);
    for (; (n = fxs_scene_file_read(file, one, AGAIN, &message)) > 0; again += n) {
        const fxs_motion *motions = fxs_scene_file_motions(file);
        CHECK(!memcmp(one, l.gaussians + again, (size_t)n * sizeof *one));
        CHECK(!motions || !memcmp(motions, l.motions + again, (size_t)n * sizeof *motions));
    }
    CHECK(again == l.count);
    fxs_scene_file_close(file);
    return l;
}

static void free_list(list *l)
{
    free(l->gaussians);
    free(l->motions);
}

static int by_colour(const void *a, const void *b)
{
    const float x = ((const fxs_gaussian *)a)->dc[0], y = ((const fxs_gaussian *)b)->dc[0];
    return x < y ? -1 : x > y;
}

static int is_visible(const fxs_gaussian *g)
{
    return g->opacity > -5.4f;              /* more than 1/255, with room for rounding */
}

/* Reduces a list to how its visible Gaussians are at a time, in the order of their colours. */
static void take_moment(list *l, double seconds)
{
    const fxs_time time = l->info.time;
    long kept = 0;
    for (long i = 0; i < l->count; i++) {
        fxs_gaussian g = l->gaussians[i];
        if ((!(time.duration > 0) || fxs_gaussian_at(&g, &l->motions[i], &time, fxs_time_within(&time, seconds))) &&
            is_visible(&g))
            l->gaussians[kept++] = g;
    }
    l->count = kept;
    qsort(l->gaussians, (size_t)kept, sizeof *l->gaussians, by_colour);
}

static int are_near(const float *a, const float *b, int count, double most)
{
    for (int i = 0; i < count; i++)
        if (!(fabs((double)a[i] - b[i]) <= most))
            return 0;
    return 1;
}

/* True if both lists have the same Gaussians, except for rounding. */
static int are_alike(const list *a, const list *b)
{
    int alike = CHECK(a->count == b->count);
    for (long i = 0; i < a->count && alike; i++) {
        const fxs_gaussian *x = &a->gaussians[i], *y = &b->gaussians[i];
        alike = CHECK(are_near(x->position, y->position, 3, 1e-4) && are_near(x->scale, y->scale, 3, 1e-5) &&
                      are_near(x->rotation, y->rotation, 4, 1e-5) && are_near(&x->opacity, &y->opacity, 1, 2e-3) &&
                      are_near(x->dc, y->dc, 3, 1e-5) && are_near(x->sh, y->sh, 45, 1e-5));
    }
    return alike;
}

static int place_file(fxs_scene_file **file, fxs_scene_file_info *info, const fxs_placement *placement)
{
    char name[] = "cloud", *names[] = {name};
    fxs_placement own = *placement;
    fxs_world world = {.files = names, .objects = &own, .file_count = 1, .count = 1};
    fxs_scene_file *files[] = {*file};
    const fxs_scene_file_info before = *info;
    fxs_message message;
    return fxs_world_merge(&world, files, &before, file, info, &message);
}

static fxs_placement any_placement(void)
{
    fxs_placement p;
    fxs_placement_init(&p, 0, 0);
    p.scale = 1.7;
    p.opacity = 0.8;
    for (int i = 0; i < 4; i++)
        p.rotation[i] = uniform(-1, 1);
    for (int i = 0; i < 3; i++) {
        p.translation[i] = uniform(-2, 2);
        p.tint[i] = uniform(0.5, 1.5);
    }
    return p;
}

/* An edit: places a stream, or leaves SH out, or keeps the opaque Gaussians of one that does not fade. */
enum { PLACED, WITHOUT_SH, OPAQUE_ONLY, EDITS };

static int edit_file(fxs_scene_file **file, fxs_scene_file_info *info, int edit, const fxs_placement *placement)
{
    fxs_scene_filter filter;
    fxs_scene_filter_report report;
    fxs_message message;
    if (edit == PLACED)
        return place_file(file, info, placement);
    fxs_scene_filter_init(&filter);
    filter.sh_degree = edit == WITHOUT_SH ? 1 : 3;
    filter.opacity = edit == OPAQUE_ONLY ? 0.6 : 0;
    filter.drawable = 1;
    return fxs_scene_file_filter(*file, &filter, info, &report, 0, &message);
}

/* A moment of an edited scene equals the edited moment. */
static void edits_commute_with_time(void)
{
    for (int edit = 0; edit < EDITS; edit++) {
        fxs_time time = every;
        time.fades = edit != OPAQUE_ONLY;
        cloud c = make_cloud(COUNT / 4, time);
        const fxs_placement placement = any_placement();
        for (int i = 0; i < 7; i++) {
            const double seconds = 0.4999 * i + 3 * (i % 2);
            fxs_scene_file *file;
            fxs_scene_file_info info;
            fxs_message message;
            CHECK(!open_cloud(&c, 3, &file, &info, &message) && !edit_file(&file, &info, edit, &placement));
            list moving = read_list(file, &info);
            CHECK(!open_cloud(&c, 3, &file, &info, &message) && !fxs_scene_file_at(file, seconds, &info, &message) &&
                  !edit_file(&file, &info, edit, &placement));
            list still = read_list(file, &info);
            CHECK(edit == WITHOUT_SH ? moving.info.sh_degree == 1 : moving.count <= (long)c.count);
            take_moment(&moving, seconds);
            take_moment(&still, 0);
            CHECK(moving.count > 100);
            are_alike(&moving, &still);
            free_list(&moving);
            free_list(&still);
        }
        free_cloud(&c);
    }
}

/* Distance of a place from the outside of a shape; below 0: so far from its inside. */
static double depth_in(const fxs_filter_shape *s, const double p[3])
{
    const double *n = s->numbers;
    double depth = INFINITY, along = 0, square = 0;
    for (int i = 0; i < 3 && s->kind == FXS_FILTER_BOX; i++)
        depth = fmin(depth, fmin(p[i] - n[i], n[3 + i] - p[i]));
    if (s->kind == FXS_FILTER_BOX)
        return depth;
    for (int i = 0; i < 3; i++) {
        along += s->kind == FXS_FILTER_CYLINDER ? (p[i] - n[i]) * (n[3 + i] - n[i]) : 0;
        square += (p[i] - n[i]) * (p[i] - n[i]);
    }
    if (s->kind == FXS_FILTER_SPHERE)
        return n[3] - sqrt(square);
    /* the test's cylinder is 2 units long */
    along /= 2;
    return fmin(fmin(along, 2 - along), n[6] - sqrt(fmax(square - along * along, 0)));
}

/* The largest depth in a shape on the way of a Gaussian in its window, in 5000 steps. */
static double deepest(const cloud *c, uint32_t i, const fxs_filter_shape *shape)
{
    const fxs_gaussian *g = &c->gaussians[i];
    const fxs_motion *m = &c->motions[i];
    const double from = fmax(m->from, 0), to = fmin(m->to, c->time.duration);
    double depth = -INFINITY;
    for (int k = 0; k <= 5000; k++) {
        const double d = from + (to - from) * k / 5000 - m->centre;
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = g->position[a] + d * (m->drift[0][a] + d * (m->drift[1][a] + d * m->drift[2][a]));
        depth = fmax(depth, depth_in(shape, p));
    }
    return depth;
}

/* A crop of a placement keeps the Gaussians of a list, and one of its outside the others and those on the edge. */
static void check_placed_crop(cloud *c, const fxs_filter_shape *box, const list *inside)
{
    for (int outside = 0; outside < 2; outside++) {
        fxs_scene_file *file;
        fxs_scene_file_info info;
        fxs_message message;
        fxs_placement placement;
        long common = 0;
        fxs_placement_init(&placement, 0, 0);
        placement.crop_count = 1;
        placement.crops[0].outside = outside;
        memcpy(placement.crops[0].low, box->numbers, sizeof placement.crops[0].low);
        memcpy(placement.crops[0].high, box->numbers + 3, sizeof placement.crops[0].high);
        CHECK(!open_cloud(c, 1, &file, &info, &message) && !place_file(&file, &info, &placement));
        list placed = read_list(file, &info);
        for (long i = 0; i < placed.count; i++)
            common += common < inside->count && placed.gaussians[i].dc[0] == inside->gaussians[common].dc[0];
        CHECK(outside ? placed.count > (long)c->count - inside->count && placed.count < (long)c->count
                      : placed.count == inside->count && common == inside->count);
        free_list(&placed);
    }
}

/* A crop keeps the Gaussians that come inside while they exist, and no others. */
static void crops_follow_the_ways(void)
{
    static const fxs_filter_shape shapes[] = {{FXS_FILTER_BOX, {-0.5, -0.3, -1, 0.5, 0.4, 1}},
                                              {FXS_FILTER_SPHERE, {0.2, 0, 0.1, 0.7}},
                                              {FXS_FILTER_CYLINDER, {0, -1, 0, 0, 1, 0, 0.5}}};
    fxs_time time = every;
    time.fades = 0;
    cloud c = make_cloud(2000, time);
    for (uint32_t i = 0; i < c.count; i++) {
        c.gaussians[i].dc[0] = (float)i;
        c.motions[i].from = i % 3 ? (float)(0.006 * (i % 400)) - 1 : -INFINITY;
        c.motions[i].to = i % 3 ? c.motions[i].from + 1.5f : INFINITY;
    }
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
        fxs_scene_file *file;
        fxs_scene_file_info info;
        fxs_scene_filter filter;
        fxs_scene_filter_report report;
        fxs_message message;
        int inside = 0, passing = 0, next = 0;
        fxs_scene_filter_init(&filter);
        filter.shapes = &shapes[k];
        filter.shape_count = 1;
        CHECK(!open_cloud(&c, 1, &file, &info, &message));
        CHECK(!fxs_scene_file_filter(file, &filter, &info, &report, 0, &message));
        list kept = read_list(file, &info);
        for (uint32_t i = 0; i < c.count; i++) {
            const double position[3] = {(double)c.gaussians[i].position[0], (double)c.gaussians[i].position[1],
                                        (double)c.gaussians[i].position[2]};
            const double depth = deepest(&c, i, &shapes[k]);
            const double sigma = exp(fmax(fmax(c.gaussians[i].scale[0], c.gaussians[i].scale[1]),
                                          c.gaussians[i].scale[2]));
            const int is_kept = next < kept.count && kept.gaussians[next].dc[0] == (float)i;
            next += is_kept;
            inside += is_kept;
            passing += is_kept && depth_in(&shapes[k], position) < 0;
            CHECK(is_kept ? depth > -1e-3 : depth < sigma);
        }
        printf("  shape %d: kept %d, %d with a centre outside\n", (int)k, inside, passing);
        CHECK(next == kept.count && inside > 50 && inside < 300 && passing > 30);
        if (shapes[k].kind == FXS_FILTER_BOX)
            check_placed_crop(&c, &shapes[k], &kept);
        CHECK(report.outside == (uint64_t)(2000 - inside) && report.kept == (uint64_t)inside);
        free_list(&kept);
    }
    free_cloud(&c);
}

/* Gives a cloud the windows of frames, and some Gaussians that never change. */
static void give_windows(cloud *c)
{
    for (uint32_t i = 0; i < c->count; i++) {
        fxs_motion *m = &c->motions[i];
        const int first = (int)uniform(0, 30), end = first + 1 + (int)uniform(0, 30 - first);
        if (i % 4 == 0)
            *m = (fxs_motion){.fade = INFINITY, .from = -INFINITY, .to = INFINITY};
        else if (i % 4 < 3) {
            m->from = first ? (float)(first / c->time.rate) : -INFINITY;
            m->to = end < 30 ? (float)(end / c->time.rate) : INFINITY;
        }
    }
}

/* True if Gaussians that never change are there once, and windows end within the duration. */
static int has_windows(const list *part, long never_change)
{
    const double duration = part->info.time.duration;
    int within = 1;
    for (long i = 0; i < part->count; i++) {
        const fxs_motion *m = &part->motions[i];
        never_change -= m->from == -INFINITY && m->to == INFINITY && m->drift[0][0] == 0 && m->fade == INFINITY;
        within &= part->info.time.fades || ((m->from == -INFINITY || m->from > 0) &&
                                            (m->to == INFINITY || m->to < duration));
    }
    return within && never_change == 0;
}

/* A range of times shows at each time what the scene shows then. */
static void ranges_show_the_same(void)
{
    static const double ranges[][2] = {{0.7, 1.9}, {0, 6}, {-1, 1}, {2.5, 3.5}, {4, 5}, {-2, -1}, {0.5001, 14.25}};
    for (int kind = 0; kind < 8; kind++)
        for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++) {
            const double from = ranges[k][0], to = ranges[k][1];
            fxs_time time = every;
            fxs_scene_file *file;
            fxs_scene_file_info info;
            fxs_message message;
            time.loops = kind & 1;
            time.fades = kind >> 1 & 1;
            time.rate = kind & 4 ? 10 : 0;
            cloud c = make_cloud(600, time);
            if (time.rate > 0)
                give_windows(&c);
            CHECK(!open_cloud(&c, 1, &file, &info, &message));
            list whole = read_list(file, &info);
            CHECK(!open_cloud(&c, 1, &file, &info, &message));
            if (!CHECK(!fxs_scene_file_between(file, from, to, &info, &message)))
                printf("  %s\n", message.text);
            CHECK(fabs(info.time.duration - (to - from)) < 1e-3 && info.time.loops == time.loops);
            const double begin = to - info.time.duration;    /* may be rounded to a frame */
            list part = read_list(file, &info);
            CHECK(k < 6 || fabs(begin - (time.rate > 0 ? 0.5 : 0.5001)) < 1e-9);
            CHECK(k < 6 || has_windows(&part, time.rate > 0 ? 150 : 0));
            for (int i = 0; i < 12; i++) {
                const double seconds = i < 11 ? (to - from) * (i + 0.013) / 11 : (to - from) * 0.9999;
                list now = {malloc((size_t)whole.count * sizeof *now.gaussians), whole.motions, whole.count,
                            whole.info};
                list then = {malloc((size_t)part.count * sizeof *then.gaussians), part.motions, part.count, part.info};
                memcpy(now.gaussians, whole.gaussians, (size_t)whole.count * sizeof *now.gaussians);
                memcpy(then.gaussians, part.gaussians, (size_t)part.count * sizeof *then.gaussians);
                take_moment(&now, begin + seconds);
                take_moment(&then, seconds);
                if (!are_alike(&now, &then))
                    printf("  kind %d, %g to %g, at %g: %ld and %ld\n", kind, from, to, seconds, now.count,
                           then.count);
                free(now.gaussians);
                free(then.gaussians);
            }
            free_list(&whole);
            free_list(&part);
            free_cloud(&c);
        }
}

/* Packs both clouds as one scene. still: the second cloud is at its first moment. */
static int pack_both(cloud clouds[2], const fxs_placement placements[2], int still, fxs_packed_scene *packed)
{
    char a[] = "a", b[] = "b", *names[] = {a, b};
    fxs_placement own[2] = {placements[0], placements[1]};
    const fxs_world world = {.files = names, .objects = own, .file_count = 2, .count = 2};
    fxs_scene_file *files[2], *merged;
    fxs_scene_file_info infos[2], info;
    fxs_pack_report report;
    fxs_message message;
    for (int i = 0; i < 2; i++)
        CHECK(!open_cloud(&clouds[i], 1, &files[i], &infos[i], &message));
    if (still)
        CHECK(!fxs_scene_file_at(files[1], 0, &infos[1], &message));
    int error = fxs_world_merge(&world, files, infos, &merged, &info, &message);
    if (!error) {
        CHECK(info.time.duration == 3 && info.time.rate == 25 && info.time.loops == (still || clouds[1].time.loops));
        error = fxs_pack(merged, &info, packed, &report, 0, &message);
    }
    if (error)
        printf("  %s\n", message.text);
    fxs_scene_file_close(merged);
    return error;
}

/* A merged scene looks like its parts, drawn as objects, until the longest of them ends. */
static void merged_scenes_are_objects(void)
{
    static drawing one, two;
    const fxs_config config = {.size = sizeof config, .kernels = &fxs_kernels_c};
    fxs_context context;
    CHECK(!fxs_context_init(&context, &config));
    for (int kind = 0; kind < 3; kind++) {
        fxs_time longer = every, shorter = every;
        longer.rate = 25;
        shorter.duration = 0.8;
        shorter.loops = kind == 1;
        cloud clouds[2] = {make_cloud(COUNT / 2, longer), make_cloud(COUNT / 4, shorter)};
        fxs_packed_scene packed[3] = {{0}};
        fxs_placement placements[2] = {any_placement(), any_placement()};
        fxs_scene scenes[2];
        fxs_object objects[2];
        double least = 99;
        placements[0].scale = placements[1].scale = 0.8;
        placements[1].file = 1;
        CHECK(!pack_cloud(&clouds[0], 1, FXS_PROFILE_DEFAULT, -1, &packed[0]));
        CHECK(!pack_cloud(&clouds[1], 1, FXS_PROFILE_DEFAULT, kind == 2 ? 0 : -1, &packed[1]));
        CHECK(!pack_both(clouds, placements, kind == 2, &packed[2]));
        for (int i = 0; i < 2; i++) {
            CHECK(!fxs_scene_open(&scenes[i], packed[i].data, packed[i].bytes));
            CHECK(!fxs_object_place(&objects[i], &scenes[i], &placements[i], 0, 0));
        }
        for (int i = 0; i < 9; i++) {
            const double seconds = 0.34 * i;
            CHECK(!draw(&one, packed[2].data, packed[2].bytes, seconds, 0.4 * i, &fxs_kernels_c, 0, 1));
            fxs_request_init(&two.request, objects, 2);
            look(&two.request.cameras[0], 0.4 * i);
            two.request.options.time_q32 = (int64_t)llrint(ldexp(seconds, 32));
            CHECK(!draw_request(&two, &context, 0));
            const double db = psnr(one.pixels, two.pixels);
            least = db < least ? db : least;
        }
        printf("  kind %d: least %.2f dB\n", kind, least);
        CHECK(least >= 50);
        for (int i = 0; i < 3; i++)
            fxs_packed_scene_free(&packed[i]);
        for (int i = 0; i < 2; i++)
            free_cloud(&clouds[i]);
    }
}

/* Edits without a clear meaning are refused, and so are ranges of times out of range. */
static void wrong_edits_are_refused(void)
{
    static const double ranges[][2] = {{1, 1}, {2, 1}, {NAN, 1}, {0, NAN}, {0, INFINITY}, {0, 16385}, {-INFINITY, 0},
                                       {0, 0.0005}, {1e12, 1e12 + 1}};
    cloud c = make_cloud(300, every);
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_filter filter;
    fxs_scene_filter_report report;
    fxs_message message;
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        CHECK(!open_cloud(&c, 1, &file, &info, &message));
        CHECK(fxs_scene_file_between(file, ranges[i][0], ranges[i][1], &info, &message) == FXS_ERR_ARGUMENT);
        fxs_scene_file_close(file);
    }
    for (int i = 0; i < 3; i++) {
        fxs_scene_filter_init(&filter);
        filter.floaters = i == 0;
        filter.thing = i == 1;
        CHECK(!open_cloud(&c, 1, &file, &info, &message));
        CHECK((i < 2 ? fxs_scene_file_filter(file, &filter, &info, &report, 0, &message)
                     : fxs_scene_file_decimate(file, 10, &info, 0, &message)) == FXS_ERR_UNSUPPORTED);
        fxs_scene_file_close(file);
    }
    c.time.duration = 0.001;
    CHECK(!open_cloud(&c, 1, &file, &info, &message));
    CHECK(fxs_scene_file_between(file, 0, 5, &info, &message) == FXS_ERR_ARGUMENT);
    fxs_scene_file_close(file);
    c.time.duration = 3;
    for (uint32_t i = 0; i < c.count; i++)
        c.motions[i].to = 1;
    CHECK(!open_cloud(&c, 1, &file, &info, &message));
    CHECK(fxs_scene_file_between(file, 2, 2.5, &info, &message) == FXS_ERR_FILE);
    fxs_scene_file_close(file);
    free_cloud(&c);
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
static void moving_scenes_are_neither_edited_nor_refined(void)
{
    cloud c = make_cloud(COUNT / 4, every);
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_editor editor;
    fxs_message message;
    fxs_context context;
    fxs_refine_options options;
    fxs_refine_options_init(&options);
    options.context = &context;
    CHECK(!fxs_context_init(&context, 0));
    if (!CHECK(!pack_levels(&c, 0, FXS_PROFILE_DEFAULT, -1, 1, &packed)))
        return;
    CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
    CHECK(fxs_editor_open(&editor, &scene, &message) == FXS_ERR_UNSUPPORTED);
    fxs_editor_close(&editor);
    CHECK(fxs_refine(packed.data, packed.bytes, &options, &message) == FXS_ERR_UNSUPPORTED);
    fxs_packed_scene_free(&packed);
    free_cloud(&c);
}

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
    RUN(moving_scenes_are_neither_edited_nor_refined);
    RUN(edits_commute_with_time);
    RUN(crops_follow_the_ways);
    RUN(ranges_show_the_same);
    RUN(merged_scenes_are_objects);
    RUN(wrong_edits_are_refused);
    RUN(wrong_motion_is_refused);
    RUN(random_motion_is_safe);
    RUN(wrong_gaussians_are_dropped);
    return check_report();
}
