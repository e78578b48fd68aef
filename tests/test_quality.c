/* Quality floors: 8-bit frames against an independent double-precision renderer (reference.c) of the unquantised
 * file, mean over four views a scene: the packed scene of each profile, and the pixel stage alone (blend and resolve) fed
 * with splats projected in doubles. A scene as .spz is measured beside them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../port/formats/camera.h"
#include "../port/formats/pack.h"
#include "../port/formats/ply_write.h"
#include "../port/formats/spz_write.h"
#include "../src/stage.h"
#include "../tools/metrics.h"
#include "../tools/procedural.h"
#include "check.h"
#include "reference.h"

#define PIXEL_FLOOR 57.0
enum { PROFILES = 3, SPZ = 3, FORMS = 4, LARGE = 10000 };   /* from so many Gaussians on, the bytes are checked */
static const struct {
    const char *name;
    double psnr, ssim, bytes;           /* bytes a Gaussian at SH degree 3, at most */
} floors[FORMS] = {{"default", 54, 0.998, 64}, {"compact", 50, 0.99, 40}, {"small", 40, 0.97, 20}, {".spz 4", 0, 0, 64}};

enum { WIDTH = 1280, HEIGHT = 720, VIEWS = 4, PIXELS = WIDTH * HEIGHT };

typedef struct subject {
    fxs_scene_file_info info;
    fxs_packed_scene packed[FORMS];
    double bytes[FORMS];
    fxs_pack_report report;
    fxs_gaussian *gaussians;
    size_t count;
    fxs_file_view views[VIEWS];
} subject;

static uint8_t expected[PIXELS * 4], actual[PIXELS * 4];
static double linear[PIXELS * 3];

/* ---- The pixel stage, fed from doubles --------------------------------------------------------------------------- */

typedef struct splat_list {
    fxs_splat *splats;
    fxs_bounds *bounds;
    fxs_box *boxes;
    fxs_key *keys, *spare;
    uint32_t count;
} splat_list;

/* Rounds a splat of the reference to the blend stage's record. Returns 0 where it touches no pixel. */
static int to_fixed(fxs_splat *s, fxs_bounds *b, const struct reference_splat *r)
{
    double offset = -2 * log(r->opacity), cx = r->x - 0.5, cy = r->y - 0.5;
    double limit = fmin(9, FXS_FAINT_Q11 / 2048.0 - offset);
    if (limit <= 0 || fabs(cx) > 60000 || fabs(cy) > 60000)
        return 0;
    double radius = sqrt(limit), ux = 1 / sqrt(r->a - r->b * r->b / r->c), vy = 1 / sqrt(r->c);
    double half_height = radius / vy * 1.01 + 0.2, half_width = radius * sqrt(r->a) * 1.01 + 0.2;
    double first = fmax(0, ceil(cy - half_height)), last = fmin(HEIGHT - 1, floor(cy + half_height));
    if (first > last || cx + half_width < 0 || cx - half_width > WIDTH - 1)
        return 0;
    s->offset_q11 = (uint16_t)lrint(offset * 2048);
    s->ux_q24 = (int32_t)lrint(ldexp(ux, 24));
    s->uy_q24 = (int32_t)lrint(ldexp(-ux * r->b / r->c, 24));
    s->vy_q24 = (int32_t)lrint(ldexp(vy, 24));
    s->u0_q24 = (uint32_t)llrint(-cx * s->ux_q24 - cy * s->uy_q24) + 1024;
    s->v0_q24 = (uint32_t)llrint(-cy * s->vy_q24) + 1024;
    for (int c = 0; c < 3; c++)
        s->colour_q13[c] = (int16_t)fmin(32767, floor(r->colour[c] * 8192 + 0.5));
    s->first_row = (uint16_t)first;
    s->last_row = (uint16_t)last;
    *b = (fxs_bounds){(int32_t)lrint(cx * 16384), (int32_t)lrint(cy * 16384), (uint32_t)lrint(256 / ux),
                      (int32_t)lrint(256 * r->b * vy), (uint32_t)lrint(half_width * 256), 0};
    return 1;
}

static splat_list project_in_doubles(const subject *s, const fxs_file_view *view, const struct reference_options *o)
{
    splat_list list = {calloc(s->count, sizeof *list.splats), calloc(s->count, sizeof *list.bounds),
                       calloc(s->count, sizeof *list.boxes), calloc(s->count, sizeof *list.keys),
                       calloc(s->count, sizeof *list.spare), 0};
    for (size_t i = 0; i < s->count; i++) {
        struct reference_splat r;
        if (!reference_project(&s->gaussians[i], view, o, &r) || r.opacity * 255 < 1 ||
            !to_fixed(&list.splats[list.count], &list.bounds[list.count], &r))
            continue;
        list.keys[list.count] = FXS_KEY((uint32_t)fmin(4e9, ldexp(r.depth, 20)), list.count);
        list.count++;
    }
    return list;
}

static void pixel_stage(const subject *s, const fxs_file_view *file_view, const struct reference_options *o)
{
    splat_list list = project_in_doubles(s, file_view, o);
    fxs_view view = {.width = WIDTH, .height = HEIGHT, .tiles_x = WIDTH / FXS_TILE, .tiles_y = HEIGHT / FXS_TILE,
                     .cut_q11 = FXS_CUT_Q11};
    enum { TILES = WIDTH / FXS_TILE * (HEIGHT / FXS_TILE) };
    static uint32_t counts[TILES], ends[TILES], histogram[1][FXS_SORT_BUCKETS];
    const fxs_config one_thread = {.threads = 1};
    fxs_key *sorted = fxs_sort(&one_thread, list.keys, list.spare, list.count, histogram, 1);
    memset(counts, 0, sizeof counts);
    fxs_sorted stretch = {sorted, malloc((list.count + 1) * sizeof(fxs_box)), list.count};
    fxs_bin_c(&view, list.splats, list.bounds, list.count, list.boxes);
    fxs_bin_count(&view, list.splats, list.bounds, list.boxes, &stretch, counts);
    uint32_t total = 0;
    for (int t = 0; t < TILES; t++) {
        ends[t] = total;
        total += counts[t];
    }
    uint32_t *entries = malloc(((size_t)total + 1) * sizeof *entries);
    fxs_bin_fill(&view, list.splats, list.bounds, &stretch, 0, TILES - 1, ends, entries);
    free(stretch.boxes);
    fxs_options options;
    fxs_options_default(&options);
    for (int t = 0; t < TILES; t++) {
        fxs_tile tile;
        int x = t % view.tiles_x * FXS_TILE, y = t / view.tiles_x * FXS_TILE;
        fxs_blend_c(&view, x, y, list.splats, entries + ends[t] - counts[t], counts[t], &tile);
        fxs_resolve_c(&options, &tile, FXS_TILE, FXS_TILE, actual + (y * WIDTH + x) * 4, WIDTH * 4);
    }
    free(entries);
    free(list.splats);
    free(list.bounds);
    free(list.boxes);
    free(list.keys);
    free(list.spare);
}

/* ---- Scenes and views -------------------------------------------------------------------------------------------- */

/* The same scene as .spz 4, as it is drawn once packed, for comparison. Without zstd there is none. */
static void load_spz(subject *s)
{
    char path[] = "/tmp/fixsplat-quality-XXXXXX";
    fxs_message m;
    fxs_spz_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    struct stat status;
    int fd = mkstemp(path);
    if (fd < 0 || close(fd))
        return;
    if (!fxs_spz_writer_open(path, 4, s->info.count, s->info.sh_degree, s->info.antialiased, &writer, &m)) {
        fxs_spz_writer_put(writer, s->gaussians, s->count, &m);
        if (!fxs_spz_writer_close(writer, NULL, NULL, &m) && !fxs_scene_file_open(path, NULL, &file, &info, &m)) {
            CHECK(!fxs_pack(file, &info, &s->packed[SPZ], &report, NULL, &m) && !stat(path, &status));
            s->bytes[SPZ] = (double)status.st_size;
            fxs_scene_file_close(file);
        }
    }
    unlink(path);
}

static int load(subject *s, const char *path)
{
    fxs_message m;
    fxs_scene_file *file;
    memset(s, 0, sizeof *s);
    if (fxs_scene_file_open(path, NULL, &file, &s->info, &m))
        return -1;
    int result = 0;
    for (int i = 0; i < PROFILES && !result; i++) {
        fxs_pack_options options = {.profile = (enum fxs_profile)i};
        result = fxs_pack(file, &s->info, &s->packed[i], &s->report, &options, &m);
        s->bytes[i] = (double)s->packed[i].bytes;
    }
    result = result || fxs_scene_file_rewind(file, &m);
    s->gaussians = malloc(s->info.count * sizeof *s->gaussians);
    for (long n = 1; !result && n > 0; s->count += (size_t)n) {
        n = fxs_scene_file_read(file, s->gaussians + s->count, s->info.count - s->count, &m);
        result = n < 0;
    }
    fxs_scene_file_close(file);
    if (!result)
        load_spz(s);
    return result;
}

/* Every so many-th view of a camera file. */
static int views_of_file(subject *s, const char *path)
{
    fxs_message m;
    fxs_file_view *views;
    long count = fxs_camera_file_read(path, &views, &m);
    for (int i = 0; i < VIEWS && count > 0; i++) {
        s->views[i] = views[i * count / VIEWS];
        fxs_view_resize(&s->views[i], WIDTH, HEIGHT);
    }
    if (count > 0)
        free(views);
    return count > 0 ? 0 : -1;
}

/* From in front, as far as the sphere around the inner bounds takes, 25 degrees to either side, and close up. */
static int views_around(subject *s, const double up[3])
{
    fxs_message m;
    fxs_file_view front;
    double middle[3], radius = 0;
    int result = fxs_view_frame_box(&front, s->report.inner_low, s->report.inner_high, up, 50, WIDTH, HEIGHT, &m);
    for (int i = 0; i < 3; i++) {
        middle[i] = (s->report.inner_low[i] + s->report.inner_high[i]) / 2;
        radius = hypot(radius, (s->report.inner_high[i] - s->report.inner_low[i]) / 2);
    }
    for (int i = 0; i < 3; i++)
        front.position[i] = middle[i] - radius / sin(acos(-1) * 25 / 180) * front.rotation[6 + i];
    for (int v = 0; v < VIEWS && !result; v++) {
        static const double side[VIEWS] = {0, 0.42, -0.42, 0.1}, distance[VIEWS] = {1, 0.91, 0.91, 0.5};
        double eye[3];
        for (int i = 0; i < 3; i++) {
            double back = front.position[i] - middle[i];
            double along = sqrt(pow(front.position[0] - middle[0], 2) + pow(front.position[1] - middle[1], 2) +
                                pow(front.position[2] - middle[2], 2));
            eye[i] = middle[i] + distance[v] * (back + side[v] * along * front.rotation[i]);
        }
        result = fxs_view_look_at(&s->views[v], eye, middle, up, 50, WIDTH, HEIGHT, &m);
    }
    return result;
}

/* ---- Floors ------------------------------------------------------------------------------------------------------ */

static int render_packed(const fxs_packed_scene *packed, const fxs_file_view *view)
{
    fxs_message m;
    fxs_scene scene;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    fxs_init(&context, 0);
    fxs_options_default(&options);
    if (fxs_scene_open(&scene, packed->data, packed->bytes) || fxs_camera_from_view(&camera, view, &m))
        return -1;
    size_t bytes = fxs_frame_bytes(&context, &scene, WIDTH, HEIGHT, 0);
    void *memory = check_aligned(bytes);
    int error = fxs_render(&context, &scene, &camera, &options, memory, bytes, actual, WIDTH * 4, 0);
    free(memory);
    return error;
}

/* Means over the views: of each form, and of the pixel stage alone. */
typedef struct means {
    double psnr[FORMS], ssim[FORMS], pixel_psnr;
} means;

static int measure_view(means *mean, const subject *s, const fxs_file_view *view)
{
    struct reference_options o = {.cutoff = REFERENCE_MAHALANOBIS, .sh_degree = 3, .antialiased = s->info.antialiased};
    struct fxs_metrics m;
    if (!CHECK(!reference_render(s->gaussians, s->count, view, &o, linear)))
        return 0;
    reference_to_rgba8(linear, WIDTH, HEIGHT, expected);
    for (int i = 0; i < FORMS && s->packed[i].data; i++) {
        if (!CHECK(!render_packed(&s->packed[i], view)))
            return 0;
        fxs_metrics_compare(actual, expected, WIDTH, HEIGHT, &m);
        mean->psnr[i] += m.psnr / VIEWS;
        mean->ssim[i] += m.ssim / VIEWS;
    }
    pixel_stage(s, view, &o);
    fxs_metrics_compare(actual, expected, WIDTH, HEIGHT, &m);
    mean->pixel_psnr += m.psnr / VIEWS;
    return 1;
}

static void check_floors(const subject *s)
{
    means mean = {{0}, {0}, 0};
    for (int v = 0; v < VIEWS; v++)
        if (!measure_view(&mean, s, &s->views[v]))
            return;
    for (int i = 0; i < FORMS && s->packed[i].data; i++) {
        double bytes = s->bytes[i] / (double)s->report.packed;
        printf("  %-8s %6.2f bytes a Gaussian, %.2f dB, SSIM %.5f\n", floors[i].name, bytes, mean.psnr[i],
               mean.ssim[i]);
        CHECK(mean.psnr[i] >= floors[i].psnr && mean.ssim[i] >= floors[i].ssim);
        CHECK(s->report.packed < LARGE || bytes <= floors[i].bytes);
    }
    printf("  pixel stage alone %.2f dB\n", mean.pixel_psnr);
    CHECK(mean.pixel_psnr >= PIXEL_FLOOR);
}

static void check_scene(const char *path, const char *cameras, const double up[3])
{
    subject s;
    if (CHECK(!load(&s, path)) && CHECK(!(cameras ? views_of_file(&s, cameras) : views_around(&s, up))))
        check_floors(&s);
    free(s.gaussians);
    for (int i = 0; i < FORMS; i++)
        fxs_packed_scene_free(&s.packed[i]);
}

static const struct {
    const char *scene, *cameras;
    double up[3];
} shared[] = {
    {"snowmiku/snowmiku.ply", "snowmiku/cameras.json", {0, -1, 0}},
    {"train-1000/train-1000.ply", "train-1000/cameras.json", {0, -1, 0}},
    {"guitar/guitar.ply", 0, {0, -1, 0}},
    {"luma-seal/luma-seal.ply", 0, {0, -1, 0}},
    {"boatyard-tile3/boatyard-tile3.ply", 0, {0, 0, 1}},
    {"kitchen-marble/kitchen-marble.ply", 0, {0, -1, 0}},
    {"statue-st-peter/st-peter.ply", 0, {0, -1, 0}},
    {"donut/donut.ply", 0, {0, 0, 1}},
    {"fruit-drops/fruit_drops_minimal.ply", 0, {0, -1, 0}},
};

static size_t which;

static void quality_of_shared_scene(void)
{
    char scene[512], cameras[512];
    const char *folder = getenv("FXS_SCENES");
    folder = folder ? folder : "../shared/scenes";
    snprintf(scene, sizeof scene, "%s/%s", folder, shared[which].scene);
    snprintf(cameras, sizeof cameras, "%s/%s", folder, shared[which].cameras ? shared[which].cameras : "");
    puts(shared[which].scene);
    if (access(scene, R_OK))
        SKIP("the scene is not here");
    check_scene(scene, shared[which].cameras ? cameras : 0, shared[which].up);
}

static void quality_of_procedural_scene(void)
{
    static const double up[3] = {0, -1, 0};
    char path[] = "/tmp/fixsplat-quality-XXXXXX";
    fxs_message m;
    fxs_ply_writer *writer;
    const fxs_procedural_scene *scene = fxs_procedural_find("knot");
    int fd = mkstemp(path);
    if (!CHECK(fd >= 0 && !fxs_ply_writer_open(path, 100000, 3, 0, &writer, &m)))
        return;
    close(fd);
    for (uint64_t i = 0; i < 100000; i++) {
        fxs_gaussian g;
        scene->gaussian(i, 100000, 1, &g);
        fxs_ply_writer_put(writer, &g, 1, &m);
    }
    CHECK(!fxs_ply_writer_close(writer, &m));
    check_scene(path, 0, up);
    unlink(path);
}

static double random_between(uint32_t *state, double low, double high)
{
    *state = *state * 1664525 + 1013904223;
    return low + (high - low) * (*state >> 8) / 16777216;
}

/* A disc without thickness, sigma 1e-9 or 0: of the sky, up to 72 wide and facing the middle, or of the ground. Each
   lies far enough off for its width that it does not reach into views beside it. */
static void make_disc(uint32_t i, uint32_t *state, fxs_gaussian *g)
{
    const int sky = i % 3 > 0;
    const double far = sky ? random_between(state, 100, 360) : random_between(state, 6, 60);
    const double sigma = far * (sky ? 0.2 : random_between(state, 0.02, 0.15));
    double n[3] = {random_between(state, -1, 1), random_between(state, -1, 0.1), random_between(state, -1, 1)};
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    memset(g, 0, sizeof *g);
    for (int k = 0; k < 3; k++) {
        n[k] /= length;
        g->position[k] = (float)(k == 1 && !sky ? 2.5 : far * n[k]);
        g->scale[k] = (float)log(sigma * random_between(state, 0.5, 1));
        g->dc[k] = (float)(sky ? 0.4 + 0.5 * k - n[1] : random_between(state, -1, 0.5));
        g->rotation[k + 1] = (float)(sky ? 0 : random_between(state, -0.02, 0.02));
    }
    g->opacity = (float)random_between(state, -1, 4);
    g->scale[sky ? 2 : 1] = i % 2 ? -INFINITY : logf(1e-9f);
    g->rotation[0] = (float)(sky ? 1 + n[2] : 1);
    g->rotation[1] -= (float)(sky ? n[1] : 0);                 /* z is turned to n */
    g->rotation[2] += (float)(sky ? n[0] : 0);
}

/* A knot under a sky and on a ground of discs. */
static void quality_of_discs(void)
{
    static const double up[3] = {0, -1, 0};
    enum { COUNT = 30000, EVERY = 60 };
    char path[] = "/tmp/fixsplat-quality-XXXXXX";
    fxs_message m;
    fxs_ply_writer *writer;
    const fxs_procedural_scene *scene = fxs_procedural_find("knot");
    uint32_t state = 1;
    int fd = mkstemp(path);
    if (!CHECK(fd >= 0 && !fxs_ply_writer_open(path, COUNT, 0, 0, &writer, &m)))
        return;
    close(fd);
    for (uint32_t i = 0; i < COUNT; i++) {
        fxs_gaussian g;
        if (i % EVERY)
            scene->gaussian(i, COUNT, 1, &g);
        else
            make_disc(i / EVERY, &state, &g);
        fxs_ply_writer_put(writer, &g, 1, &m);
    }
    CHECK(!fxs_ply_writer_close(writer, &m));
    check_scene(path, 0, up);
    unlink(path);
}

int main(void)
{
    RUN(quality_of_discs);
    RUN(quality_of_procedural_scene);
    for (which = 0; which < sizeof shared / sizeof *shared; which++)
        RUN(quality_of_shared_scene);
    return check_report();
}
