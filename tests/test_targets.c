/* Tests the rendered depths, ids and coverage, occluders and backgrounds. They must equal a loop over every
   pixel and splat (projected Gaussian) in order of depth. */
#include "src/core/frame.h"
#include "one_scene.h"
#include "random_scene.h"
#include "splat_level.h"
#include "random_world.h"

static fxs_context plain;          /* a context with plain C kernels and a single thread */
static const double up[3] = {0, -1, 0};

static struct {
    uint32_t count, room;
    fxs_splat *splats;
    fxs_bounds *bounds;
    uint32_t *keys, *order;
    fxs_id *ids;
    fxs_stage_view view;
} all;

static void make_room(uint32_t most)
{
    if (most <= all.room)
        return;
    all.room = most;
    all.splats = realloc(all.splats, most * sizeof *all.splats);
    all.bounds = realloc(all.bounds, most * sizeof *all.bounds);
    all.keys = realloc(all.keys, most * sizeof *all.keys);
    all.order = realloc(all.order, most * sizeof *all.order);
    all.ids = realloc(all.ids, most * sizeof *all.ids);
}

static int by_depth(const void *left, const void *right)
{
    const uint32_t l = *(const uint32_t *)left, r = *(const uint32_t *)right;
    return all.keys[l] != all.keys[r] ? (all.keys[l] < all.keys[r] ? -1 : 1) : (l > r) - (l < r);
}

static void collect_object(const fxs_object_view *object)
{
    for (uint32_t chunk = 0; chunk < object->scene.chunk_count; chunk++) {
        uint32_t indices[FXS_CHUNK];
        make_room(all.count + FXS_CHUNK);
        const uint32_t at = all.count;
        const int32_t n = fxs_object_project(object, &fxs_kernels_c, chunk, 256, 0, all.splats + at, all.bounds + at,
                                             indices, all.keys + at);
        CHECK(n >= 0 && !fxs_object_shade(object, &fxs_kernels_c, chunk, indices, (uint32_t)n, all.splats + at));
        for (int32_t i = 0; i < n; i++) {
            all.ids[at + (uint32_t)i] = (fxs_id){object->id, indices[i]};
            all.order[at + (uint32_t)i] = at + (uint32_t)i;
        }
        all.count += (uint32_t)n;
    }
}

static void collect(const fxs_object *objects, uint32_t count, const fxs_camera *camera, const fxs_options *options)
{
    all.count = 0;
    CHECK(!fxs_view_init(&all.view, camera, options));
    for (uint32_t i = 0; i < count; i++) {
        fxs_object_view object;
        CHECK(!fxs_object_view_init(&object, &all.view, camera, &objects[i]));
        collect_object(&object);
    }
    if (all.count)
        qsort(all.order, all.count, sizeof *all.order, by_depth);
}

typedef struct brute {
    int t_q15, sum_q13[3], most_q15, weights;
    uint32_t median, largest;
    double depths, error;   /* sum of weight * depth over the splats at a pixel; tolerance of the renderer's sum */
} brute;

static double depth_of(uint32_t key)
{
    return ldexp((double)(1u << 26 | (key & 0x3ffffff)), (int)(key >> 26) - 32 - 26);
}

static void add_depth(brute *b, uint32_t key, int weight_q15)
{
    const double octave = ldexp(1, (int)(key >> 26) - 32);
    b->depths += weight_q15 * depth_of(key);
    b->error += octave * (0.5 + ldexp(weight_q15, -15));
}

static void blend(brute *b, uint32_t slot, int x, int y)
{
    const fxs_splat *s = &all.splats[slot];
    const int level = splat_level(s, &all.bounds[slot], x, y);
    if (b->t_q15 < FXS_CLOSED_Q15 || level > fxs_limit_q11(s->offset_q11, all.view.cut_q11) ||
        (all.view.cutoff == FXS_CUTOFF_SQUARE && !splat_has_tile(&all.bounds[slot], x, y)))
        return;
    const int weight = fxs_weight_q15(fxs_alpha_q15(level), b->t_q15);
    add_depth(b, all.keys[slot], weight);
    b->median = b->t_q15 >= FXS_HALF_Q15 && b->t_q15 - weight < FXS_HALF_Q15 ? slot : b->median;
    b->largest = weight > b->most_q15 ? slot : b->largest;
    b->most_q15 = weight > b->most_q15 ? weight : b->most_q15;
    b->t_q15 -= weight;
    for (int c = 0; c < 3; c++)
        b->sum_q13[c] = fxs_accumulate_q13(b->sum_q13[c], weight, s->colour_q13[c]);
}

static uint32_t splats_of_row(int y, uint32_t *row)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < all.count; i++) {
        const fxs_splat *s = &all.splats[all.order[i]];
        if (y >= s->first_row && y <= s->last_row)
            row[count++] = all.order[i];
    }
    return count;
}

/* True if a splat may touch pixel column x: its width plus two pixels reaches the column. */
static int may_touch(uint32_t slot, int x)
{
    const fxs_bounds *b = &all.bounds[slot];
    return all.view.cutoff == FXS_CUTOFF_SQUARE || b->half_width_q8 == FXS_EVERYWHERE_Q8 ||
           llabs(((int64_t)x << 8) - (b->cx_q14 >> 6)) <= (int64_t)b->half_width_q8 + 512;
}

static brute brute_pixel(const uint32_t *row, uint32_t count, int x, int y, uint32_t limit_key)
{
    brute b = {.t_q15 = FXS_CLEAR_Q15, .median = FXS_NOTHING, .largest = FXS_NOTHING};
    for (uint32_t i = 0; i < count && b.t_q15 >= FXS_CLOSED_Q15; i++)
        if (all.keys[row[i]] <= limit_key && may_touch(row[i], x))
            blend(&b, row[i], x, y);
    return b;
}

static struct {
    double largest;                /* largest relative error of a mean depth until now */
    /* numbers of pixels with a mean depth, and of pixels with a splat hidden by the occluder */
    long pixels, hidden;
} tally;

static int same_mean(const brute *b, uint32_t mean, int bits)
{
    const int weight_q15 = FXS_CLEAR_Q15 - b->t_q15;
    if (!weight_q15)
        return mean == FXS_NOTHING;
    const double unit = ldexp(1, bits), exact = b->depths / weight_q15 * unit, bound = b->error / weight_q15 * unit + 1;
    if (exact - bound > FXS_NOTHING - 1)
        return mean == FXS_NOTHING - 1;
    if (mean < FXS_NOTHING - 1 && exact > 1000) {
        tally.largest = fmax(tally.largest, fabs(mean / exact - 1));
        tally.pixels++;
    }
    return mean != FXS_NOTHING && (fabs(mean - exact) <= bound || (mean == FXS_NOTHING - 1 && exact + bound >= mean));
}

static int same_colour(const brute *b, const fxs_options *options, const uint8_t *rgba)
{
    int same = rgba[3] == 255;
    for (int c = 0; c < 3; c++)
        same &= rgba[c] == fxs_resolve_8bit(b->sum_q13[c], b->t_q15, (options->background[c] * 8192 + 127) / 255);
    return same;
}

static uint32_t expected_median(const brute *b, int bits)
{
    if (b->t_q15 >= FXS_HALF_Q15)
        return FXS_NOTHING;
    const double depth = floor(ldexp(depth_of(all.keys[b->median]), bits));
    return depth < FXS_NOTHING - 1 ? (uint32_t)depth : FXS_NOTHING - 1;
}

/* Converts a depth to the renderer's sorting key: an exponent, and 26 bits after the leading bit. */
static uint32_t key_of(uint32_t depth, int bits)
{
    int exponent;
    if (depth == 0 || depth == FXS_NOTHING)
        return depth ? UINT32_MAX : 0;
    const double mantissa = frexp(ldexp(depth, -bits), &exponent);
    return (uint32_t)(exponent - 1 + 32) << 26 | ((uint32_t)ldexp(mantissa, 27) & 0x3ffffff);
}

static int same_pixel(const picture *p, const fxs_options *options, int i, const brute *b, int bits)
{
    const fxs_id none = {FXS_NOTHING, FXS_NOTHING}, id = picture_id(p, i);
    const fxs_id *expected = b->largest == FXS_NOTHING ? &none : &all.ids[b->largest];
    const int coverage = ((const uint8_t *)p->targets.coverage.pixels)[i];
    return CHECK(same_colour(b, options, picture_rgba(p) + 4 * i)) && CHECK(same_mean(b, picture_mean(p, i), bits)) &&
           CHECK(picture_median(p, i) == expected_median(b, bits)) &&
           CHECK(id.object == expected->object && id.gaussian == expected->gaussian) &&
           CHECK(coverage == (int)floor((FXS_CLEAR_Q15 - b->t_q15) * 255 / 32768.0 + 0.5));
}

static void check_pixels(const picture *p, const fxs_options *options, int step)
{
    const fxs_targets *t = &p->targets;
    const int bits = t->depth_bits ? t->depth_bits : 16, faults = check_faults;
    uint32_t *row = malloc((all.count + 1) * sizeof *row);
    for (int y = 0; y < p->height; y += step) {
        const uint32_t count = splats_of_row(y, row);
        for (int x = y / step % 2; x < p->width && check_faults < faults + 5; x += step) {
            const int i = y * p->width + x;
            const uint32_t limit = t->occluder.pixels ? ((const uint32_t *)t->occluder.pixels)[i] : FXS_NOTHING;
            const brute b = brute_pixel(row, count, x, y, key_of(limit, bits));
            if (!same_pixel(p, options, i, &b, bits))
                printf("  pixel %d, %d of %dx%d, limit %u, %d bits\n", x, y, p->width, p->height, limit, bits);
            tally.hidden += limit != FXS_NOTHING;
        }
    }
    free(row);
}

typedef struct scenario {
    packed_scene scenes[3];
    fxs_object objects[3];
    uint32_t count;
    fxs_camera camera;
    fxs_options options;
} scenario;

static void make_scenario(scenario *s)
{
    random_view(&s->camera, &s->options);
    s->count = (uint32_t)between(1, 3);
    for (uint32_t i = 0; i < s->count; i++) {
        const double axis[3] = {between(-9, 9), between(-9, 9), 10}, at[3] = {between(-2, 2), between(-2, 2), 0.5};
        s->scenes[i] = random_scene((enum fxs_profile)between(0, 2), 2000);
        s->objects[i] = one_object(&s->scenes[i].scene);
        s->objects[i].id = (uint32_t)next();
        if (between(0, 1))
            object_place(&s->objects[i], axis, between(0, 628) / 100.0, exp2(between(-20, 10) / 10.0), at);
        if (between(0, 2) == 0)
            s->objects[i].opacity_q16 = (uint32_t)between(500, 65536);
    }
}

static void free_scenario(scenario *s)
{
    for (uint32_t i = 0; i < s->count; i++)
        free(s->scenes[i].data);
}

static int draw_in(const fxs_context *context, const scenario *s, size_t bytes, const fxs_targets *targets,
                   fxs_stats *stats)
{
    void *memory = check_aligned(bytes);
    const int error = render_frame(context, s->objects, s->count, &s->camera, &s->options, targets, memory, bytes,
                                   stats);
    free(memory);
    return error;
}

static size_t bytes_of(const fxs_context *context, const scenario *s)
{
    return fxs_frame_bytes(context, s->objects, s->count, s->camera.width, s->camera.height, 0);
}

static int draw(const scenario *s, const fxs_targets *targets)
{
    return draw_in(&plain, s, bytes_of(&plain, s), targets, 0);
}

/* Makes random occluder depths: equal to splats' depths, near them, arbitrary, FXS_NOTHING and 0. */
static uint32_t *random_occluder(const scenario *s, int bits)
{
    const int pixels = s->camera.width * s->camera.height;
    uint32_t *depths = malloc((size_t)pixels * sizeof *depths);
    const int same = between(0, 2) == 0;
    for (int i = 0; i < pixels; i++) {
        const int kind = between(0, 9);
        const double depth = all.count ? depth_of(all.keys[next() % all.count]) : 0;
        const uint32_t of_splat = (uint32_t)fmin(ldexp(depth, bits), 4e9);
        depths[i] = kind < 5 ? of_splat : kind < 7 ? of_splat + (uint32_t)between(-1, 1) : kind < 8 ? (uint32_t)next()
                    : kind < 9 ? FXS_NOTHING : 0;
        if (same && i)
            depths[i] = depths[i - 1];
    }
    return depths;
}

static void test_every_target_pixel_by_pixel(void)
{
    memset(&tally, 0, sizeof tally);
    state = 31;
    for (int i = 0; i < 60 && !check_faults; i++) {
        scenario s;
        make_scenario(&s);
        collect(s.objects, s.count, &s.camera, &s.options);
        picture p = picture_new(s.camera.width, s.camera.height, FXS_FORMAT_RGBA8);
        p.targets.depth_bits = i % 2 ? between(0, 28) : 0;
        const int bits = p.targets.depth_bits ? p.targets.depth_bits : 16;
        uint32_t *occluder = random_occluder(&s, bits);
        if (i % 3)
            p.targets.occluder = (fxs_image){occluder, (ptrdiff_t)s.camera.width * 4};
        CHECK(!draw(&s, &p.targets));
        check_pixels(&p, &s.options, 1);
        free(occluder);
        picture_free(&p);
        free_scenario(&s);
    }
    printf("  mean depths off by at most %.2g at %ld pixels; %ld occluded\n", tally.largest, tally.pixels,
           tally.hidden);
    CHECK(tally.pixels > 15000 && tally.hidden > 15000 && tally.largest < 0.004);
}

enum { WIDTH = 400, HEIGHT = 260, PIXELS = WIDTH * HEIGHT };

/* Shares of a picture's pixels: with a value, with a tie (too close to decide, so skipped), and with a wrong
   value. */
typedef struct shares {
    double with, ties, wrong;
} shares;

static void print_shares(const char *what, shares *s)
{
    const double rest = s->with - s->ties;
    s->wrong = rest > 0 ? s->wrong / rest : 0;
    printf("  %s: same at %.3f %% of %.0f pixels, %.2f %% of all left out as ties\n", what, 100 - 100 * s->wrong,
           rest, 100 * s->ties / fmax(1, s->with));
}

/* Checks the median depth. Pixels where the transmittance is within 1/1024 of 1/2 are ties and not compared. */
static void check_median(const picture *p, const reference_world *r)
{
    shares s = {0, 0, 0};
    for (int i = 0; i < PIXELS; i++) {
        const size_t splat = r->trace.median[i];
        const double depth = splat == REFERENCE_NONE ? 0 : ldexp(r->splats[splat].depth, 16);
        const uint32_t median = picture_median(p, i);
        if (splat == REFERENCE_NONE && median == FXS_NOTHING)
            continue;
        s.with++;
        if (r->trace.median_margin[i] < 1.0 / 1024)
            s.ties++;
        else
            s.wrong += splat == REFERENCE_NONE || median == FXS_NOTHING || fabs(median - depth) > 2 + depth / 100000;
    }
    print_shares("median depth", &s);
    CHECK(s.wrong <= 0.001);
}

/* Checks the id of the largest weight. Pixels whose two largest weights are within 1/1024 of each other are ties
   and not compared. */
static void check_id(const picture *p, const reference_world *r)
{
    shares s = {0, 0, 0};
    for (int i = 0; i < PIXELS; i++) {
        const size_t splat = r->trace.largest[i];
        const fxs_id id = picture_id(p, i);
        if (splat == REFERENCE_NONE && id.object == FXS_NOTHING)
            continue;
        s.with++;
        if (r->trace.most[i] * r->trace.largest_margin[i] < 1.0 / 1024)
            s.ties++;
        else
            s.wrong += splat == REFERENCE_NONE || id.object != r->ids[splat].object ||
                       id.gaussian != r->ids[splat].gaussian;
    }
    print_shares("id", &s);
    CHECK(s.wrong <= 0.001);
}

static int by_size(const void *left, const void *right)
{
    const double l = *(const double *)left, r = *(const double *)right;
    return (l > r) - (l < r);
}

/* Checks the mean depth at pixels where the splats absorb at least 1/64 of the light. */
static void check_mean(const picture *p, const reference_world *r)
{
    static double errors[PIXELS];
    size_t count = 0;
    double sum = 0;
    for (int i = 0; i < PIXELS; i++) {
        if (r->trace.weight[i] < 1.0 / 64)
            continue;
        const double depth = ldexp(r->trace.mean[i], 16);
        errors[count] = picture_mean(p, i) == FXS_NOTHING ? 1 : fabs(picture_mean(p, i) / depth - 1);
        sum += errors[count++];
    }
    if (!CHECK(count > 0))
        return;
    qsort(errors, count, sizeof *errors, by_size);
    const double most = errors[(size_t)((double)count * 0.999)];
    printf("  mean depth: off by %.2g, at 99.9 %% of pixels by at most %.2g, at all by %.2g\n", sum / (double)count,
           most, errors[count - 1]);
    CHECK(sum / (double)count < 1.0 / 2048 && most < 1.0 / 256);
}

static void check_traces(const char *name, const world *w, const fxs_camera *camera, const double *occluder,
                         const fxs_image *image)
{
    double drawn;
    fxs_options options;
    picture p = picture_new(WIDTH, HEIGHT, FXS_FORMAT_RGBA8);
    fxs_options_init(&options);
    options.background[1] = 90;
    if (image)
        p.targets.occluder = *image;
    CHECK(!world_render(&plain, w, camera, &options, &p.targets, 0));
    reference_world r = world_reference(w, camera, &options, occluder);
    const double psnr = world_psnr(&p, &r, &drawn);
    printf("%s: %.1f dB, %.0f %% covered\n", name, psnr, 100 * drawn);
    CHECK(psnr >= 54);
    check_median(&p, &r);
    check_id(&p, &r);
    check_mean(&p, &r);
    reference_world_free(&r);
    picture_free(&p);
}

static fxs_camera look(const double eye[3], const double target[3])
{
    fxs_message m;
    fxs_view view;
    fxs_camera camera;
    CHECK(!fxs_view_look_at(&view, eye, target, up, &(fxs_picture){45, WIDTH, HEIGHT}, &m) &&
          !fxs_camera_from_view(&camera, &view, &m));
    return camera;
}

static void test_procedural_against_reference(void)
{
    static const struct {
        const char *name;
        uint64_t count;
        double eye[3];
    } scenes[] = {{"knot", 40000, {0.9, -3, -11}}, {"fog", 5000, {0, -1, -12}}, {"needles", 8000, {0, -2, -11}},
                  {"landscape", 60000, {4.6, -3.9, -12.7}}, {"cubes", 4096, {7, -5, -10}}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        part p;
        world w = {.count = 0};
        const fxs_camera camera = look(scenes[i].eye, (const double[3]){0, 0, 0});
        if (!part_make(&p, scenes[i].name, scenes[i].count))
            return;
        part_unpack(&p);
        world_add(&w, &p);
        check_traces(scenes[i].name, &w, &camera, 0, 0);
        part_free(&p);
    }
}

static void test_orthographic_objects_against_reference(void)
{
    part knot;
    world w = {.count = 0};
    fxs_camera camera = look((const double[3]){0.9, -3, -11}, (const double[3]){0, 0, 0});
    if (!part_make(&knot, "knot", 30000))
        return;
    part_unpack(&knot);
    object_place(world_add(&w, &knot), up, 0.7, 1.3, (const double[3]){-1, 0, 1});
    object_place(world_add(&w, &knot), (const double[3]){1, 1, 0}, 2, 0.8, (const double[3]){2, 0, 0});
    camera.projection = FXS_ORTHOGRAPHIC;
    camera.fx_q12 = camera.fy_q12 = 36 << 12;
    check_traces("two knots, orthographic", &w, &camera, 0, 0);
    part_free(&knot);
}

static int captured_camera(fxs_camera *camera, const part *p)
{
    fxs_message m;
    fxs_view view;
    return !fxs_view_frame_box(&view, p->report.inner_low, p->report.inner_high, up, &(fxs_picture){50, WIDTH, HEIGHT},
                               &m) &&
           !fxs_camera_from_view(camera, &view, &m);
}

static void test_captured_against_reference(void)
{
    static const char *const files[] = {"snowmiku/snowmiku.ply", "luma-seal/luma-seal.ply"};
    int seen = 0;
    for (int i = 0; i < 2; i++) {
        part p;
        fxs_camera camera;
        world w = {.count = 0};
        if (!part_load(&p, files[i]))
            continue;
        seen++;
        part_unpack(&p);
        world_add(&w, &p);
        if (CHECK(captured_camera(&camera, &p)))
            check_traces(files[i], &w, &camera, 0, 0);
        part_free(&p);
    }
    if (!seen)
        SKIP("the scenes are not here");
}

/* Makes occluder depths of a slanted wall. Every 37th pixel has no wall (FXS_NOTHING). */
static void make_wall(const fxs_camera *camera, double through, uint32_t *depths, double *in_doubles)
{
    const fxs_view view = view_of(camera);
    for (int i = 0; i < PIXELS; i++) {
        const double x = (i % WIDTH + 0.5 - view.cx) / view.fx, y = (i / WIDTH + 0.5 - view.cy) / view.fy;
        depths[i] = i % 37 ? (uint32_t)ldexp(through / (1 + 0.7 * x - 0.4 * y), 16) : FXS_NOTHING;
        in_doubles[i] = i % 37 ? ldexp(depths[i], -16) : INFINITY;
    }
}

static void check_wall(const char *name, const world *w, const fxs_camera *camera, double through)
{
    static uint32_t depths[PIXELS];
    static double in_doubles[PIXELS];
    fxs_options options;
    const fxs_image wall = {depths, WIDTH * 4};
    make_wall(camera, through, depths, in_doubles);
    check_traces(name, w, camera, in_doubles, &wall);
    fxs_options_init(&options);
    picture p = picture_new(WIDTH, HEIGHT, FXS_FORMAT_RGBA8);
    CHECK(!world_render(&plain, w, camera, &options, &p.targets, 0));
    picture behind = picture_new(WIDTH, HEIGHT, FXS_FORMAT_RGBA8);
    behind.targets.occluder = wall;
    CHECK(!world_render(&plain, w, camera, &options, &behind.targets, 0));
    collect(w->objects, w->count, camera, &options);
    long cut = 0;
    for (int i = 0; i < PIXELS; i++)
        cut += picture_mean(&p, i) != picture_mean(&behind, i);
    printf("  %ld pixels are cut\n", cut);
    CHECK(cut > PIXELS / 20);
    check_pixels(&behind, &options, 5);
    picture_free(&p);
    picture_free(&behind);
}

static void test_wall_through_knot(void)
{
    part knot;
    world w = {.count = 0};
    const fxs_camera camera = look((const double[3]){0.9, -3, -11}, (const double[3]){0, 0, 0});
    if (!part_make(&knot, "knot", 20000))
        return;
    part_unpack(&knot);
    world_add(&w, &knot);
    check_wall("wall through the knot", &w, &camera, 11.3);
    part_free(&knot);
}

static void test_wall_through_captured(void)
{
    part p;
    world w = {.count = 0};
    fxs_camera camera;
    if (!part_load(&p, "snowmiku/snowmiku.ply"))
        SKIP("the scene is not here");
    part_unpack(&p);
    world_add(&w, &p);
    if (CHECK(captured_camera(&camera, &p))) {
        const fxs_view view = view_of(&camera);
        double through = 0;
        for (int i = 0; i < 3; i++)
            through += view.rotation[6 + i] * ((p.report.inner_low[i] + p.report.inner_high[i]) / 2 - view.position[i]);
        check_wall("wall through snowmiku", &w, &camera, through);
    }
    part_free(&p);
}

static void fill(uint32_t *depths, int count, uint32_t depth)
{
    for (int i = 0; i < count; i++)
        depths[i] = depth;
}

static void test_empty_and_full_occluders(void)
{
    state = 33;
    for (int i = 0; i < 40; i++) {
        scenario s;
        make_scenario(&s);
        const int width = s.camera.width, height = s.camera.height;
        uint32_t *depths = malloc((size_t)width * (size_t)height * 4);
        picture p = picture_new(width, height, FXS_FORMAT_RGBA8), other = picture_new(width, height, FXS_FORMAT_RGBA8);
        CHECK(!draw(&s, &p.targets));
        other.targets.occluder = (fxs_image){depths, width * 4};
        fill(depths, width * height, FXS_NOTHING);
        CHECK(!draw(&s, &other.targets) && !memcmp(p.block, other.block, p.bytes));
        fill(depths, width * height, 0);
        CHECK(!draw(&s, &other.targets));
        for (int k = 0; k < width * height; k++) {
            const uint8_t *b = s.options.background, expected[4] = {b[0], b[1], b[2], 255};
            CHECK(!memcmp(picture_rgba(&other) + 4 * k, expected, 4));
            CHECK(picture_mean(&other, k) == FXS_NOTHING && picture_median(&other, k) == FXS_NOTHING &&
                  picture_id(&other, k).gaussian == FXS_NOTHING);
        }
        picture_free(&p);
        picture_free(&other);
        free(depths);
        free_scenario(&s);
    }
}

static fxs_image *image_of(fxs_targets *t, int i)
{
    fxs_image *const images[] = {&t->colour, &t->coverage, &t->mean_depth, &t->median_depth, &t->id, &t->occluder,
                                 &t->backdrop};
    return images[i];
}

/* Renders many splats (projected Gaussians) at exactly the occluder's depth, more than a part of a tile's list
   holds. */
static void test_many_at_the_limit(void)
{
    enum { SIZE = 16, BITS = 26 };
    packed_scene flat = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 4096, 0);
    for (uint32_t c = 0; c < flat.header->chunk_count; c++) {
        fxs_chunk *chunk = &flat.chunks[c];
        for (int i = 0; i < 2; i++) {
            chunk->origin_q32[i] = -(INT64_C(1) << 32);
            chunk->step_q32[i] = 2 * 65536;
        }
        chunk->scale_q16 = -3 * 65536;
        fill_words(packed_scene_rows(&flat, c), flat.header->chunk_bytes);
    }
    CHECK(!packed_scene_finish(&flat));
    scenario s = {.count = 1, .objects = {one_object(&flat.scene)}};
    s.objects[0].opacity_q16 = 65536 / 100;
    fxs_camera_init(&s.camera, SIZE, SIZE);
    s.camera.fx_q12 = s.camera.fy_q12 = 2 * SIZE << 12;
    s.camera.position_q32[2] = -(INT64_C(4) << 32);
    fxs_options_init(&s.options);
    collect(s.objects, 1, &s.camera, &s.options);
    CHECK(all.count > 1024 && all.keys[all.order[0]] == all.keys[all.order[all.count - 1]]);
    uint32_t depths[SIZE * SIZE];
    picture p = picture_new(SIZE, SIZE, FXS_FORMAT_RGBA8), q = picture_new(SIZE, SIZE, FXS_FORMAT_RGBA8);
    p.targets.depth_bits = q.targets.depth_bits = BITS;
    CHECK(!draw(&s, &p.targets));
    q.targets.occluder = (fxs_image){depths, SIZE * 4};
    for (uint32_t nearer = 0; nearer < 2; nearer++) {
        for (int i = 0; i < SIZE * SIZE; i++)
            depths[i] = fxs_depth_of_key(all.keys[0], BITS) - nearer;
        CHECK(!draw(&s, &q.targets));
        CHECK(nearer ? picture_mean(&q, 100) == FXS_NOTHING : !memcmp(p.block, q.block, p.bytes));
    }
    picture_free(&p);
    picture_free(&q);
    free(flat.data);
}

static void test_every_subset(void)
{
    state = 34;
    for (int i = 0; i < 12; i++) {
        scenario s;
        make_scenario(&s);
        collect(s.objects, s.count, &s.camera, &s.options);
        uint32_t *occluder = random_occluder(&s, 16);
        const enum fxs_format format = (enum fxs_format)between(0, 3);
        picture p = picture_new(s.camera.width, s.camera.height, format);
        picture q = picture_new(s.camera.width, s.camera.height, format);
        if (i % 2)
            p.targets.occluder = q.targets.occluder = (fxs_image){occluder, (ptrdiff_t)s.camera.width * 4};
        CHECK(!draw(&s, &p.targets));
        for (int subset = 1; subset < 32; subset++) {
            fxs_targets some = q.targets;
            picture_clear(&q);
            for (int k = 0; k < 5; k++) {
                fxs_image *image = image_of(&some, k), *all_of = image_of(&p.targets, k);
                if (subset >> k & 1)
                    continue;
                memcpy(image->pixels, all_of->pixels, (size_t)all_of->stride * (size_t)s.camera.height);
                image->pixels = 0;
                image->stride = 1;
            }
            CHECK(!draw(&s, &some));
            if (!CHECK(!memcmp(p.block, q.block, p.bytes)))
                printf("  case %d, subset %d\n", i, subset);
        }
        picture_free(&p);
        picture_free(&q);
        free(occluder);
        free_scenario(&s);
    }
}

static unsigned char *colour_of(const scenario *s, enum fxs_format format, const fxs_image *backdrop)
{
    const ptrdiff_t stride = (ptrdiff_t)s->camera.width * fxs_pixel_bytes(format);
    unsigned char *pixels = malloc((size_t)stride * (size_t)s->camera.height);
    fxs_targets t = one_target(format, pixels, stride);
    if (backdrop)
        t.backdrop = *backdrop;
    CHECK(!draw(s, &t));
    return pixels;
}

/* True if each 8-bit colour is the rounded colour of the 16-bit picture. */
static int same_wide(const uint16_t *wide, const uint8_t *rgba)
{
    int same = 1;
    for (int c = 0; c < 3; c++) {
        const int sum_q13 = (int)(((int64_t)wide[c] * 8192 + 32767) / 65535);
        same &= wide[c] == 65535 ? rgba[c] == 255 : rgba[c] == (sum_q13 * 255 + 4096) >> 13;
        same &= wide[c] == 65535 || wide[c] == (int)floor(sum_q13 * 65535 / 8192.0 + 0.5);
    }
    const int taken_q15 = (int)(((int64_t)wide[3] * 32768 + 32767) / 65535);
    return same && rgba[3] == (taken_q15 * 255 + 16384) >> 15 &&
           wide[3] == (int)floor(taken_q15 * 65535 / 32768.0 + 0.5);
}

static void test_formats_against_each_other(void)
{
    state = 35;
    for (int i = 0; i < 40; i++) {
        scenario s;
        make_scenario(&s);
        const int pixels = s.camera.width * s.camera.height;
        unsigned char *rgba = colour_of(&s, FXS_FORMAT_RGBA8, 0), *low = colour_of(&s, FXS_FORMAT_RGB565, 0);
        unsigned char *premultiplied = colour_of(&s, FXS_FORMAT_RGBA8_COVERAGE, 0);
        unsigned char *wide = colour_of(&s, FXS_FORMAT_RGBA16_COVERAGE, 0), *coverage = malloc((size_t)pixels);
        fxs_targets t;
        fxs_targets_init(&t);
        t.coverage = (fxs_image){coverage, s.camera.width};
        CHECK(!draw(&s, &t));
        for (int k = 0; k < pixels; k++) {
            const uint8_t *c = rgba + 4 * k;
            const int red = (int)floor(c[0] * 31 / 255.0 + 0.5), green = (int)floor(c[1] * 63 / 255.0 + 0.5);
            const int blue = (int)floor(c[2] * 31 / 255.0 + 0.5), packed = red << 11 | green << 5 | blue;
            CHECK(low[2 * k] == (packed & 255) && low[2 * k + 1] == packed >> 8);
            CHECK(coverage[k] == premultiplied[4 * k + 3]);
            CHECK(same_wide((const uint16_t *)(const void *)(wide + 8 * k), premultiplied + 4 * k));
        }
        unsigned char *bgra = colour_of(&s, FXS_FORMAT_BGRA8, 0);
        unsigned char *swapped = colour_of(&s, FXS_FORMAT_RGB565_SWAPPED, 0);
        for (int k = 0; k < pixels; k++) {
            const uint8_t *c = rgba + 4 * k, *b = bgra + 4 * k;
            CHECK(b[0] == c[2] && b[1] == c[1] && b[2] == c[0] && b[3] == 255);
            CHECK(swapped[2 * k] == low[2 * k + 1] && swapped[2 * k + 1] == low[2 * k]);
        }
        free(bgra);
        free(swapped);
        free(rgba);
        free(low);
        free(premultiplied);
        free(wide);
        free(coverage);
        free_scenario(&s);
    }
}

/* Tests the background image, which gives each pixel its own background. It may be the colour target itself. */
static void test_backdrops(void)
{
    static const enum fxs_format formats[] = {FXS_FORMAT_RGBA8, FXS_FORMAT_RGB565, FXS_FORMAT_BGRA8,
                                              FXS_FORMAT_RGB565_SWAPPED};
    state = 36;
    for (int i = 0; i < 40; i++) {
        scenario s;
        make_scenario(&s);
        const int width = s.camera.width, height = s.camera.height, bytes = fxs_pixel_bytes(formats[i % 4]);
        uint8_t *backdrop = malloc((size_t)(width * height) * 4);
        uint8_t colours[2][3];
        unsigned char *of_colour[2];
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++)
                s.options.background[c] = colours[k][c] = (uint8_t)between(0, 255);
            of_colour[k] = colour_of(&s, formats[i % 4], 0);
        }
        for (int k = 0; k < width * height; k++) {
            memcpy(backdrop + 4 * k, colours[k % 3 == 0], 3);
            backdrop[4 * k + 3] = (uint8_t)next();
        }
        s.options.background[1] = (uint8_t)~s.options.background[1];
        unsigned char *mixed = colour_of(&s, formats[i % 4], &(fxs_image){backdrop, width * 4});
        for (int k = 0; k < width * height; k++)
            CHECK(!memcmp(mixed + bytes * k, of_colour[k % 3 == 0] + bytes * k, (size_t)bytes));
        if (formats[i % 4] == FXS_FORMAT_RGBA8) {
            fxs_targets t = one_target(FXS_FORMAT_RGBA8, backdrop, width * 4);
            t.backdrop = t.colour;
            CHECK(!draw(&s, &t) && !memcmp(backdrop, mixed, (size_t)(width * height) * 4));
        }
        free(mixed);
        free(backdrop);
        free(of_colour[0]);
        free(of_colour[1]);
        free_scenario(&s);
    }
}

typedef struct padded {
    unsigned char *block;
    size_t bytes;
    ptrdiff_t stride, row;
    unsigned char *first;
} padded;

static padded padded_new(int width, int height, int bytes, int alignment)
{
    padded p = {.row = (ptrdiff_t)width * bytes};
    p.stride = p.row + between(0, 5) * (bytes % alignment ? bytes : alignment);
    p.bytes = (size_t)p.stride * (size_t)height + 128;
    p.block = check_aligned(p.bytes);
    memset(p.block, WORLD_GUARD, p.bytes);
    p.first = p.block + 64;
    if (between(0, 1)) {
        p.first += p.stride * (height - 1);
        p.stride = -p.stride;
    }
    return p;
}

static int same_padded(const padded *p, const unsigned char *tight, int height)
{
    unsigned char *expected = malloc(p->bytes);
    memset(expected, WORLD_GUARD, p->bytes);
    for (int y = 0; y < height; y++)
        memcpy(expected + (p->first - p->block) + y * p->stride, tight + y * p->row, (size_t)p->row);
    const int same = !memcmp(expected, p->block, p->bytes);
    free(expected);
    return same;
}

static void test_strides_and_guards(void)
{
    static const int alignments[] = {1, 1, 4, 4, 4, 4, 1};
    state = 37;
    for (int i = 0; i < 60; i++) {
        scenario s;
        make_scenario(&s);
        collect(s.objects, s.count, &s.camera, &s.options);
        const int width = s.camera.width, height = s.camera.height, wide = i % 4 == FXS_FORMAT_RGBA16_COVERAGE;
        const enum fxs_format format = (enum fxs_format)(i % 4);
        const int bytes[] = {fxs_pixel_bytes(format), 1, 4, 4, 8, 4, 4};
        picture p = picture_new(width, height, format);
        uint32_t *inputs[2] = {random_occluder(&s, 16), random_occluder(&s, 16)};
        p.targets.occluder = (fxs_image){inputs[0], width * 4};
        if (!fxs_is_premultiplied(format))
            p.targets.backdrop = (fxs_image){inputs[1], width * 4};
        CHECK(!draw(&s, &p.targets));
        fxs_targets t = p.targets;
        padded rows[7];
        for (int k = 0; k < 7; k++) {
            rows[k] = padded_new(width, height, bytes[k], k == 0 && wide ? 2 : alignments[k]);
            for (int y = 0; y < height && k >= 5; y++)
                memcpy(rows[k].first + y * rows[k].stride, inputs[k - 5] + y * width, (size_t)width * 4);
            if (image_of(&t, k)->pixels)
                *image_of(&t, k) = (fxs_image){rows[k].first, rows[k].stride};
        }
        CHECK(!draw(&s, &t));
        for (int k = 0; k < 7; k++) {
            const unsigned char *tight = k < 5 ? image_of(&p.targets, k)->pixels : (unsigned char *)inputs[k - 5];
            if (!CHECK(same_padded(&rows[k], tight, height)))
                printf("  image %d\n", k);
            free(rows[k].block);
        }
        free(inputs[0]);
        free(inputs[1]);
        picture_free(&p);
        free_scenario(&s);
    }
}

static void test_interlaced_targets(void)
{
    scenario s;
    state = 38;
    make_scenario(&s);
    const int width = s.camera.width, height = s.camera.height;
    unsigned char *both = check_aligned((size_t)(width * height) * 8);
    picture p = picture_new(width, height, FXS_FORMAT_RGBA8);
    CHECK(!draw(&s, &p.targets));
    fxs_targets t;
    fxs_targets_init(&t);
    t.median_depth = (fxs_image){both, width * 8};
    t.colour = (fxs_image){both + 4 * width, width * 8};
    CHECK(!draw(&s, &t));
    for (int y = 0; y < height; y++) {
        CHECK(!memcmp(both + y * width * 8, (unsigned char *)p.targets.median_depth.pixels + y * width * 4,
                      (size_t)width * 4));
        CHECK(!memcmp(both + y * width * 8 + width * 4, picture_rgba(&p) + y * width * 4, (size_t)width * 4));
    }
    /* shifts the second picture, so that it overlaps the first in the previous or the next row */
    for (int side = -4; side <= 4; side += 8) {
        t.colour.pixels = both + 4 * width + side;
        CHECK(draw(&s, &t) == FXS_ERR_TARGET);
    }
    free(both);
    picture_free(&p);
    free_scenario(&s);
}

static int is_on_ray(const fxs_pick_result *r, const fxs_camera *camera, int x, int y)
{
    const fxs_view v = view_of(camera);
    double at[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            at[i] += v.rotation[3 * i + k] * (ldexp((double)r->position_q32[k], -32) - v.position[k]);
    const double depth = ldexp((double)r->depth_q32, -32), scale = v.projection == FXS_ORTHOGRAPHIC ? 1 : 1 / at[2];
    const double column = v.fx * at[0] * scale + v.cx, row = v.fy * at[1] * scale + v.cy;
    return fabs(at[2] - depth) < 1e-4 * depth + 1e-6 && fabs(column - x - 0.5) < 0.01 && fabs(row - y - 0.5) < 0.01;
}

static uint32_t key_of_id(const fxs_id *id)
{
    for (uint32_t i = 0; i < all.count; i++)
        if (all.ids[i].object == id->object && all.ids[i].gaussian == id->gaussian)
            return all.keys[i];
    return 0;
}

static void test_pick(void)
{
    int hits = 0, misses = 0;
    state = 39;
    for (int i = 0; i < 40 && !check_faults; i++) {
        scenario s;
        make_scenario(&s);
        collect(s.objects, s.count, &s.camera, &s.options);
        picture p = picture_new(s.camera.width, s.camera.height, FXS_FORMAT_RGBA8);
        uint32_t *occluder = random_occluder(&s, 16);
        if (i % 2)
            p.targets.occluder = (fxs_image){occluder, (ptrdiff_t)s.camera.width * 4};
        CHECK(!draw(&s, &p.targets));
        fxs_frame_memory memory;
        size_t bytes = fxs_frame_bytes(&plain, s.objects, s.count, s.camera.width, s.camera.height, &memory);
        bytes = i % 3 ? bytes : memory.least + (bytes - memory.least) / 2;
        void *room = check_aligned(bytes);
        for (int k = 0; k < 40; k++) {
            const int x = between(0, s.camera.width - 1), y = between(0, s.camera.height - 1);
            const fxs_id id = picture_id(&p, y * s.camera.width + x);
            fxs_pick_result r;
            const int found = pick_pixel(&plain, s.objects, s.count, &s.camera, &s.options, i % 2 ? &p.targets : 0, x,
                                         y, room, bytes, &r);
            if (found == FXS_ERR_MEMORY && i % 3 == 0)
                break;
            misses += found == 0;
            hits += found == 1;
            if (!found) {
                CHECK(id.object == FXS_NOTHING && id.gaussian == FXS_NOTHING);
                continue;
            }
            CHECK(found == 1 && r.object < s.count && r.id == id.object && r.gaussian == id.gaussian &&
                  s.objects[r.object].id == r.id);
            CHECK(fabs(ldexp((double)r.depth_q32, -32) / depth_of(key_of_id(&id)) - 1) < 1e-6);
            CHECK(is_on_ray(&r, &s.camera, x, y));
        }
        free(room);
        free(occluder);
        picture_free(&p);
        free_scenario(&s);
    }
    CHECK(hits > 300 && misses > 30);
}

static scenario good;
static picture good_picture;

static int untouched(const picture *p)
{
    size_t i = 0;
    while (i < p->bytes && p->block[i] == WORLD_GUARD)
        i++;
    return i == p->bytes;
}

static void refuses(const char *what, const fxs_targets *t)
{
    if (!CHECK(draw(&good, t) == FXS_ERR_TARGET) || !CHECK(untouched(&good_picture)))
        printf("  %s\n", what);
}

static void check_image(const fxs_targets *fit, int i, int bytes, int alignment)
{
    static const char *const names[] = {"colour", "coverage", "mean", "median", "id", "occluder", "backdrop"};
    const ptrdiff_t row = (ptrdiff_t)good.camera.width * bytes;
    const ptrdiff_t bad[] = {0, row - alignment, -row + alignment, 1, -1, row + alignment - 1, row / 2};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        fxs_targets t = *fit;
        image_of(&t, i)->stride = bad[k];
        if (alignment > 1 || bad[k] != row)
            refuses(names[i], &t);
    }
    for (int off = 1; off < alignment; off++) {
        fxs_targets t = *fit;
        image_of(&t, i)->pixels = (unsigned char *)image_of(&t, i)->pixels + off;
        refuses(names[i], &t);
    }
}

/* Target images that share a byte are refused. Only the background image may be the colour target. */
static void check_overlaps(const fxs_targets *fit)
{
    const int last = good.camera.height - 1;
    for (int a = 0; a < 7; a++)
        for (int b = 0; b < 7; b++)
            for (int k = 0; k < 2; k++) {
                fxs_targets t = *fit;
                const fxs_image *image = image_of(&t, b);
                if (a == b || (a > 4 && b > 4) || (k == 0 && a + b == 6 && a * b == 0))
                    continue;
                image_of(&t, a)->pixels = (unsigned char *)image->pixels + k * last * image->stride;
                refuses("overlap", &t);
            }
}

static void check_shared_input(const fxs_targets *fit)
{
    fxs_targets t = *fit;
    t.backdrop = t.occluder;
    CHECK(draw(&good, &t) == 0);
    picture_clear(&good_picture);
}

static void test_bad_targets(void)
{
    static const int bytes[] = {4, 1, 4, 4, 8, 4, 4}, alignments[] = {1, 1, 4, 4, 4, 4, 1};
    state = 40;
    make_scenario(&good);
    good.camera.width = 37;
    good.camera.height = 21;
    good_picture = picture_new(37, 21, FXS_FORMAT_RGBA8);
    static uint32_t depths[37 * 21], backdrop[37 * 21];
    fxs_targets fit = good_picture.targets, none;
    fit.occluder = (fxs_image){depths, 37 * 4};
    fit.backdrop = (fxs_image){backdrop, 37 * 4};
    fxs_targets_init(&none);
    refuses("none", &none);
    refuses("null", 0);
    none.occluder = fit.occluder;
    none.backdrop = fit.backdrop;
    refuses("nothing to write", &none);
    for (int i = 0; i < 7; i++)
        check_image(&fit, i, bytes[i], alignments[i]);
    for (int i = 0; i < 4; i++) {
        static const int bits[] = {-1, 29, INT32_MIN, INT32_MAX};
        fxs_targets t = fit;
        t.depth_bits = bits[i];
        refuses("depth_bits", &t);
    }
    for (int i = 0; i < 4; i++) {
        static const int formats[] = {6, -1, FXS_FORMAT_RGBA8_COVERAGE, FXS_FORMAT_RGBA16_COVERAGE};
        fxs_targets t = fit;
        /* an unknown pixel format, or a format that does not allow background images */
        t.format = (enum fxs_format)formats[i];
        refuses("format", &t);
    }
    check_overlaps(&fit);
    check_shared_input(&fit);
    CHECK(!draw(&good, &fit) && !untouched(&good_picture));
}

static void test_bad_picks(void)
{
    const size_t bytes = bytes_of(&plain, &good);
    void *memory = check_aligned(bytes);
    fxs_pick_result r;
    fxs_targets t;
    fxs_targets_init(&t);
    const int places[][2] = {{-1, 0}, {0, -1}, {37, 0}, {0, 21}, {INT32_MIN, 3}, {3, INT32_MAX}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        CHECK(pick_pixel(&plain, good.objects, good.count, &good.camera, &good.options, 0, places[i][0], places[i][1],
                       memory, bytes, &r) == FXS_ERR_ARGUMENT);
    CHECK(pick_pixel(0, good.objects, good.count, &good.camera, &good.options, 0, 0, 0, memory, bytes, &r) ==
          FXS_ERR_ARGUMENT);
    CHECK(fxs_pick(&plain, 0, 0, 0, memory, bytes, &r) == FXS_ERR_ARGUMENT);
    CHECK(pick_pixel(&plain, good.objects, good.count, &good.camera, &good.options, 0, 0, 0, 0, bytes, &r) ==
          FXS_ERR_ARGUMENT);
    CHECK(pick_pixel(&plain, good.objects, good.count, &good.camera, &good.options, 0, 0, 0, memory, bytes, 0) ==
          FXS_ERR_ARGUMENT);
    CHECK(pick_pixel(&plain, good.objects, good.count, &good.camera, &good.options, 0, 0, 0, memory, 64, &r) ==
          FXS_ERR_MEMORY);
    t.depth_bits = 29;
    CHECK(pick_pixel(&plain, good.objects, good.count, &good.camera, &good.options, &t, 0, 0, memory, bytes, &r) ==
          FXS_ERR_TARGET);
    free(memory);
    free_scenario(&good);
    picture_free(&good_picture);
}

static void free_all(void)
{
    free(all.splats);
    free(all.bounds);
    free(all.keys);
    free(all.order);
    free(all.ids);
}

int main(void)
{
    fxs_context_init(&plain, 0);
    RUN(test_every_target_pixel_by_pixel);
    RUN(test_procedural_against_reference);
    RUN(test_orthographic_objects_against_reference);
    RUN(test_captured_against_reference);
    RUN(test_wall_through_knot);
    RUN(test_wall_through_captured);
    RUN(test_empty_and_full_occluders);
    RUN(test_many_at_the_limit);
    RUN(test_every_subset);
    RUN(test_formats_against_each_other);
    RUN(test_backdrops);
    RUN(test_strides_and_guards);
    RUN(test_interlaced_targets);
    RUN(test_pick);
    RUN(test_bad_targets);
    RUN(test_bad_picks);
    free_all();
    return check_report();
}
