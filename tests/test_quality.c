/* Tests image quality. 8-bit frames are compared with a double-precision renderer (reference.c) of the unquantised
   file. Mean and worst PSNR of four views must reach minimum values. FXS_PROCESSORS=all renders more pixels and
   prints rows of the table in docs/measured.md. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif
#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/system.h>
#include <fixsplat/world.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/view_more.h>
#include "src/gaussian/transform_internal.h"
#include "src/core/frame.h"
#include "tools/command/metrics.h"
#include "tools/command/procedural.h"
#include "scene_writer.h"
#include "check.h"
#include "one_scene.h"
#include "reference.h"
#include "tile_lists.h"
#include "fastest.h"

#define PIXEL_FLOOR 57.0
/* LARGE: smallest number of Gaussians with a limit of the file size */
enum { PROFILES = 3, SPZ = 3, FORMS = 4, LARGE = 10000 };
typedef struct grade {
    double psnr, ssim;
} grade;
/* Kinds of scenes. MATT: like most captures. GLOSSY: metal and varnish, with large SH. FEW: a small scene, so
   that the SH palette has few entries. */
enum { MATT, GLOSSY, FEW, KINDS };
static const struct {
    const char *name;
    struct {
        grade mean, worst;              /* minimum PSNR in dB and minimum SSIM: mean of the views, worst view */
    } least[KINDS];
    double bytes;                       /* largest number of bytes in the file for each Gaussian at SH degree 3 */
} floors[FORMS] = {
    {"default", {{{56, 0.998}, {52, 0.996}}, {{54, 0.998}, {50, 0.996}}, {{56, 0.998}, {52, 0.996}}}, 64.1},
    {"compact", {{{53, 0.99}, {48, 0}}, {{50, 0.99}, {46, 0}}, {{53, 0.99}, {48, 0}}}, 40},
    {"small", {{{43, 0.97}, {38, 0}}, {{40, 0.97}, {36, 0}}, {{40.8, 0.97}, {38, 0}}}, 20},
    {".spz 4", {{{0, 0}, {0, 0}}}, 64},
};

enum { MOST_PIXELS = 960 * 640, VIEWS = 4 };
static int width = 480, height = 320;       /* width and height of the rendered pictures in pixels */

typedef struct subject {
    fxs_scene_file_info info;
    fxs_packed_scene packed[FORMS];
    double bytes[FORMS], seconds[FORMS];   /* bytes: size of the packed scene; seconds: CPU time of packing */
    fxs_pack_report report;
    fxs_gaussian *gaussians;
    size_t count;
    fxs_view views[VIEWS];
    struct reference_options reference;
    double *linear[VIEWS];
    int rendered[VIEWS];
} subject;

static fxs_pool *pool;
static uint8_t expected[MOST_PIXELS * 4], actual[MOST_PIXELS * 4];

typedef struct splat_list {
    fxs_splat *splats;
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *depths;
    uint32_t count;
} splat_list;

/* Converts a splat (projected Gaussian) from doubles to the renderer's fixed point. Returns 0 if the splat
   touches no pixel. */
static int to_fixed(fxs_splat *s, fxs_bounds *b, const struct reference_splat *r)
{
    double offset = -2 * log(r->opacity), cx = r->x - 0.5, cy = r->y - 0.5;
    double limit = fmin(9, FXS_FAINT_Q11 / 2048.0 - offset);
    if (limit <= 0 || fabs(cx) > 60000 || fabs(cy) > 60000)
        return 0;
    double radius = sqrt(limit), ux = 1 / sqrt(r->a - r->b * r->b / r->c), vy = 1 / sqrt(r->c);
    double half_height = radius / vy * 1.01 + 0.2, half_width = radius * sqrt(r->a) * 1.01 + 0.2;
    double first = fmax(0, ceil(cy - half_height)), last = fmin(height - 1, floor(cy + half_height));
    if (first > last || cx + half_width < 0 || cx - half_width > width - 1)
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

static splat_list project_in_doubles(const subject *s, const fxs_view *view, const struct reference_options *o)
{
    splat_list list = {calloc(s->count, sizeof *list.splats), calloc(s->count, sizeof *list.bounds),
                       calloc(s->count, sizeof *list.boxes), calloc(s->count, sizeof *list.depths), 0};
    for (size_t i = 0; i < s->count; i++) {
        struct reference_splat r;
        if (!reference_project(&s->gaussians[i], view, o, &r) || r.opacity * 255 < 1 ||
            !to_fixed(&list.splats[list.count], &list.bounds[list.count], &r))
            continue;
        list.depths[list.count++] = (uint32_t)fmin(4e9, ldexp(r.depth, 20));
    }
    return list;
}

static void pixel_stage(const subject *s, const fxs_view *file_view, const struct reference_options *o)
{
    splat_list list = project_in_doubles(s, file_view, o);
    fxs_stage_view view = {.width = width, .height = height, .tiles_x = width / FXS_TILE, .tiles_y = height / FXS_TILE,
                     .cut_q11 = FXS_CUT_Q11};
    fxs_bin_c(&view, list.splats, list.bounds, list.count, list.boxes);
    tile_lists lists = tile_lists_new(&view, list.splats, list.bounds, list.boxes, list.depths, list.count);
    fxs_options options;
    fxs_options_init(&options);
    for (int t = 0; t < view.tiles_x * view.tiles_y; t++) {
        fxs_tile tile;
        int x = t % view.tiles_x * FXS_TILE, y = t / view.tiles_x * FXS_TILE;
        fxs_blend_c(&view, x, y, list.splats, lists.entries + lists.ends[t] - lists.counts[t], lists.counts[t], &tile);
        fxs_resolve_c(&options, FXS_FORMAT_RGBA8, &tile, FXS_TILE, FXS_TILE, actual + (y * width + x) * 4, width * 4);
    }
    tile_lists_free(&lists);
    free(list.splats);
    free(list.bounds);
    free(list.boxes);
    free(list.depths);
}

static double processor_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

static void load_spz(subject *s)
{
    char path[] = "/tmp/fixsplat-quality-XXXXXX";
    fxs_message m;
    fxs_scene_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    struct stat status;
    int fd = mkstemp(path);
    if (fd < 0 || close(fd))
        return;
    if (!open_spz(path, 4, s->info.count, s->info.sh_degree, s->info.antialiased, &writer, &m)) {
        fxs_scene_writer_put(writer, s->gaussians, s->count, &m);
        if (!close_writer(writer, &m) && !fxs_scene_file_open(path, NULL, &file, &info, &m)) {
            const double start = processor_seconds();
            CHECK(!fxs_pack(file, &info, &s->packed[SPZ], &report, NULL, &m) && !stat(path, &status));
            s->seconds[SPZ] = processor_seconds() - start;
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
        fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = (enum fxs_profile)i,
                                    .workers.run = fxs_pool_run, .workers.pool = pool,
                                    .workers.count = fxs_processors()};
        const double start = processor_seconds();
        result = fxs_pack(file, &s->info, &s->packed[i], &s->report, &options, &m);
        s->seconds[i] = processor_seconds() - start;
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

static int views_of_file(subject *s, const char *path)
{
    fxs_message m;
    fxs_view *views;
    long count = fxs_camera_file_read(path, &views, &m);
    for (int i = 0; i < VIEWS && count > 0; i++) {
        s->views[i] = views[i * count / VIEWS];
        snprintf(s->views[i].name, sizeof s->views[i].name, "view %ld", i * count / VIEWS);
        fxs_view_resize(&s->views[i], width, height);
    }
    if (count > 0)
        free(views);
    return count > 0 ? 0 : -1;
}

static const char *const view_names[VIEWS] = {"close", "middle", "far", "side"};

typedef struct aspect {
    double up[3];
    double front;                          /* direction from the scene to its front, in degrees about the up axis */
    double close;   /* distance of the first view; 1: the scene's bounding sphere fills the picture */
    double tilt;   /* angle of the rotation of the scene and its cameras, in degrees about tilt_axis */
    int kind;
} aspect;

static const double tilt_axis[3] = {0.48, -0.36, 0.8};

/* Makes four views around a scene. Distance 1 is where the scene's bounding sphere fills the picture. */
static int views_around(subject *s, const aspect *a)
{
    const double distance[VIEWS] = {a->close, 0.6, 1.2, 0.5}, turn[VIEWS] = {0, -23, 11, 63}, degree = acos(-1) / 180;
    fxs_message m;
    fxs_view front;
    double middle[3], radius = 0, filled;
    if (fxs_view_frame_box(&front, s->report.inner_low, s->report.inner_high, a->up, &(fxs_picture){50, width, height},
                           &m))
        return -1;
    for (int i = 0; i < 3; i++) {
        middle[i] = (s->report.inner_low[i] + s->report.inner_high[i]) / 2;
        radius = hypot(radius, (s->report.inner_high[i] - s->report.inner_low[i]) / 2);
    }
    filled = radius / sin(25 * degree);
    for (int v = 0; v < VIEWS; v++) {
        s->views[v] = front;
        strcpy(s->views[v].name, view_names[v]);
        for (int i = 0; i < 3; i++)
            s->views[v].position[i] = middle[i] - distance[v] * filled * front.rotation[6 + i];
        fxs_view_orbit(&s->views[v], middle, a->up, (a->front + turn[v]) * degree);
    }
    return 0;
}

typedef struct stand {
    double eye[3], target[3];
} stand;

static int views_from(subject *s, const stand stands[VIEWS], const aspect *a)
{
    fxs_message m;
    for (int v = 0; v < VIEWS; v++) {
        if (fxs_view_look_at(&s->views[v], stands[v].eye, stands[v].target, a->up, &(fxs_picture){50, width, height},
                             &m))
            return -1;
        strcpy(s->views[v].name, view_names[v]);
    }
    return 0;
}

/* ---- Floors ------------------------------------------------------------------------------------------------------ */

static int render_packed(const fxs_packed_scene *packed, const fxs_view *view)
{
    fxs_message m;
    fxs_scene scene;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                               .workers.count = fxs_processors()};
    fxs_context_init(&context, &config);
#ifdef FXS_WITH_KERNELS
    context.config.kernels = kernels_for(fxs_cpu_detect());   /* fast kernels, which give the same bytes as plain C */
#endif
    fxs_options_init(&options);
    if (fxs_scene_open(&scene, packed->data, packed->bytes) || fxs_camera_from_view(&camera, view, &m))
        return -1;
    size_t bytes = one_frame_bytes(&context, &scene, width, height, 0);
    void *memory = check_aligned(bytes);
    int error = one_render(&context, &scene, &camera, &options, FXS_FORMAT_RGBA8, memory, bytes, actual, width * 4, 0);
    free(memory);
    return error;
}

static void render_reference(void *argument, uint32_t v)
{
    subject *s = argument;
    s->linear[v] = malloc((size_t)(width * height) * 3 * sizeof **s->linear);
    s->rendered[v] = s->linear[v] &&
        !reference_render(s->gaussians, s->count, &s->views[v], &s->reference, s->linear[v]);
}

static double share_drawn(void)
{
    double drawn = 0;
    for (int i = 0; i < width * height; i++)
        drawn += expected[4 * i] > 0 || expected[4 * i + 1] > 0 || expected[4 * i + 2] > 0;
    return drawn / (width * height);
}

typedef struct summary {
    grade mean, worst;
    int worst_view;          /* index of the view with the worst PSNR */
} summary;

static void add_view(summary *sum, int v)
{
    struct fxs_metrics m;
    if (!CHECK(!fxs_metrics_compare(actual, expected, width, height, &m)))
        return;
    if (v == 0 || m.psnr < sum->worst.psnr) {
        sum->worst.psnr = m.psnr;
        sum->worst_view = v;
    }
    sum->worst.ssim = v == 0 || m.ssim < sum->worst.ssim ? m.ssim : sum->worst.ssim;
    sum->mean.psnr += m.psnr / VIEWS;
    sum->mean.ssim += m.ssim / VIEWS;
}

static int reaches(const grade *got, const grade *floor)
{
    return got->psnr >= floor->psnr && got->ssim >= floor->ssim;
}

static void print_row(const char *name, const char *form, const summary *sum, const subject *s, double bytes,
                      double seconds)
{
    printf("| %s | %s | ", name, form);
    printf(bytes > 0 ? "%.2f | " : "| ", bytes);
    printf("%.2f (%.2f, %s) | %.5f (%.5f) | ", sum->mean.psnr, sum->worst.psnr, s->views[sum->worst_view].name,
           sum->mean.ssim, sum->worst.ssim);
    printf(bytes > 0 ? "%.2f |\n" : "|\n", seconds);
}

static void check_floors(const char *name, subject *s, int kind)
{
    summary forms[FORMS] = {{{0, 0}, {0, 0}, 0}}, pixel = {{0, 0}, {0, 0}, 0};
    for (int v = 0; v < VIEWS; v++) {
        reference_to_rgba8(s->linear[v], width, height, expected);
        if (!CHECK(share_drawn() > 0.02))
            printf("  nothing is seen from view %d\n", v);
        for (int i = 0; i < FORMS && s->packed[i].data; i++)
            if (CHECK(!render_packed(&s->packed[i], &s->views[v])))
                add_view(&forms[i], v);
        pixel_stage(s, &s->views[v], &s->reference);
        add_view(&pixel, v);
    }
    for (int i = 0; i < FORMS && s->packed[i].data; i++) {
        double bytes = s->bytes[i] / (double)s->report.packed;
        print_row(name, floors[i].name, &forms[i], s, bytes, s->seconds[i]);
        CHECK(reaches(&forms[i].mean, &floors[i].least[kind].mean));
        CHECK(reaches(&forms[i].worst, &floors[i].least[kind].worst));
        CHECK(s->report.packed < LARGE || bytes <= floors[i].bytes);
    }
    print_row(name, "pixel stage alone", &pixel, s, 0, 0);
    CHECK(pixel.mean.psnr >= PIXEL_FLOOR);
}

static void check_scene(const char *name, const char *path, const char *cameras, const stand *stands,
                        const aspect *a)
{
    subject s;
    if (CHECK(!load(&s, path)) &&
        CHECK(!(cameras ? views_of_file(&s, cameras) : stands ? views_from(&s, stands, a) : views_around(&s, a)))) {
        int rendered = 1;
        for (int v = 0; v < VIEWS; v++)
            fxs_view_orbit(&s.views[v], (double[3]){0}, tilt_axis, a->tilt * acos(-1) / 180);
        s.reference = (struct reference_options){.cutoff = REFERENCE_MAHALANOBIS, .sh_degree = 3,
                                                 .antialiased = s.info.antialiased};
        fxs_pool_run(pool, render_reference, &s, VIEWS);
        for (int v = 0; v < VIEWS; v++)
            rendered = rendered && s.rendered[v];
        if (CHECK(rendered))
            check_floors(name, &s, a->kind);
    }
    for (int v = 0; v < VIEWS; v++)
        free(s.linear[v]);
    free(s.gaussians);
    for (int i = 0; i < FORMS; i++)
        fxs_packed_scene_free(&s.packed[i]);
}

static const struct {
    const char *name, *file;
    int cameras;                        /* 1: the views come from cameras.json in the scene's folder */
    aspect aspect;
} shared[] = {
    {"snowmiku", "snowmiku.ply", 1, {{0, -1, 0}, 0, 0, 0, MATT}},
    {"train-1000", "train-1000.ply", 1, {{0, -1, 0}, 0, 0, 0, MATT}},
    {"guitar", "guitar.ply", 0, {{0, -1, 0}, 90, 0.22, 0, MATT}},
    {"luma-seal", "luma-seal.ply", 0, {{0, -1, 0}, 0, 0.28, 0, MATT}},
    {"boatyard-tile3", "boatyard-tile3.ply", 0, {{0, 0, 1}, 0, 0.28, 0, MATT}},
    {"kitchen-marble", "kitchen-marble.ply", 0, {{0, -1, 0}, 180, 0.28, 0, MATT}},
    {"statue-st-peter", "st-peter.ply", 0, {{0, -1, 0}, 180, 0.28, 0, MATT}},
    {"donut", "donut.ply", 0, {{0, 0, 1}, 0, 0.35, 0, MATT}},
    {"fruit-drops", "fruit_drops_minimal.ply", 0, {{0, -1, 0}, 180, 0.35, 0, FEW}},
    {"skull", "skull.sog", 0, {{0, -1, 0}, 180, 0.45, 0, GLOSSY}},
};

static size_t which;

static void quality_of_shared_scene(void)
{
    char scene[512], cameras[512];
    const char *folder = getenv("FXS_SCENES"), *name = shared[which].name;
    folder = folder ? folder : "../shared/scenes";
    snprintf(scene, sizeof scene, "%s/%s/%s", folder, name, shared[which].file);
    snprintf(cameras, sizeof cameras, "%s/%s/cameras.json", folder, name);
    if (access(scene, R_OK))
        SKIP("the scene is not here");
    check_scene(name, scene, shared[which].cameras ? cameras : 0, 0, &shared[which].aspect);
}

static const struct {
    uint64_t count;                     /* number of Gaussians of a procedural scene; 0: the scene's default */
    double tilt;
    const char *size;
} variants[] = {{0, 0, ""}, {8192, 0, " 8192"}, {8192, 37.3, " 8192"}, {50000, 71.9, " 50000"},
                {200000, 203.1, " 200000"}};
enum { VARIANTS = sizeof variants / sizeof *variants };

/* The procedural scenes to render. Scenes with ground and sky are viewed from places within (has_stands). Others
   are viewed from around. */
static const struct {
    const char *name;
    size_t variants;
    int kind, has_stands;
    stand stands[VIEWS];
} made[] = {
    {"knot", 1, GLOSSY, 0, {{{0}, {0}}}},
    {"meadow", VARIANTS, MATT, 1,
     {{{0.5, -0.9, -1.5}, {0, -1.3, 0}}, {{1.5, -1.1, -5}, {0, -1.1, 0}},
      {{4, -3, -14}, {0, -1, 0}}, {{5, -0.8, 1.5}, {0, -3.4, 0}}}},
    {"fence", VARIANTS, MATT, 1,
     {{{0.3, -0.8, -1.2}, {0, -0.5, 0}}, {{1.2, -1.1, -3}, {0, -0.4, 0}},
      {{3, -2.2, -6}, {0, -0.3, 0}}, {{4.2, -0.9, -1.2}, {0, -0.4, -0.3}}}},
    {"mirrors", 1, GLOSSY, 1,
     {{{0.4, -0.7, -2.4}, {0, -0.1, 0}}, {{-1.5, -1.8, -5}, {0, 0.2, 0}},
      {{1.5, -3.2, -9}, {0, 0.2, 0}}, {{5, -1.5, 1}, {0, 0.2, 0}}}},
    {"discs", 1, GLOSSY, 1,
     {{{0.5, -0.4, -3.6}, {0, 0.1, 0}}, {{0.9, -2.6, -12.8}, {0, 0.4, 0}},
      {{6, -6, -28}, {0, 0, 0}}, {{11, -1.5, 4}, {0, 0.4, 0}}}},
    {"haze", 1, MATT, 1,
     {{{0.6, -1.6, -2.2}, {0, -2.2, 0}}, {{1.5, 0, -6.5}, {0, -1.2, 0}},
      {{2, -1.5, -14}, {0, -0.8, 0}}, {{8, -0.5, 2}, {0, -1, 0}}}},
    {"site", 1, MATT, 1,
     {{{10, -22, -60}, {30, 0, -25}}, {{60, -70, -120}, {40, 0, -20}},
      {{0, -220, -290}, {0, 0, -10}}, {{230, -60, 40}, {60, 0, 0}}}},
};

static int init_tilt(fxs_transform *turn, double tilt)
{
    const double half = tilt * acos(-1) / 360;
    double rows[3][4];
    fxs_placement placement;
    fxs_placement_init(&placement, 0, 0);
    placement.rotation[0] = cos(half);
    for (int i = 0; i < 3; i++)
        placement.rotation[i + 1] = sin(half) * tilt_axis[i];
    fxs_placement_matrix(&placement, rows);
    return fxs_transform_init(turn, rows);
}

static int write_made(const char *path, const fxs_procedural_scene *scene, uint64_t count, double tilt)
{
    fxs_message m;
    fxs_transform turn;
    fxs_scene_writer *writer;
    if (init_tilt(&turn, tilt) || open_writer("ply", path, count, scene->sh_degree, 0, &writer, &m))
        return -1;
    for (uint64_t i = 0; i < count; i++) {
        fxs_gaussian g;
        scene->gaussian(i, count, 1, &g);
        if (tilt != 0)
            fxs_transform_apply(&turn, &g, scene->sh_degree);
        fxs_scene_writer_put(writer, &g, 1, &m);
    }
    return close_writer(writer, &m);
}

static size_t variant;

static void quality_of_made_scene(void)
{
    char path[] = "/tmp/fixsplat-quality-XXXXXX", name[80];
    const fxs_procedural_scene *scene = fxs_procedural_find(made[which].name);
    int fd = mkstemp(path);
    if (!CHECK(fd >= 0 && scene))
        return;
    const uint64_t count = variants[variant].count ? variants[variant].count : scene->count;
    const aspect upright = {{0, -1, 0}, 0, 0.28, variants[variant].tilt, count <= 50000 ? FEW : made[which].kind};
    snprintf(name, sizeof name, "%s%s%s", scene->name, variants[variant].size, upright.tilt != 0 ? ", tilted" : "");
    close(fd);
    if (CHECK(!write_made(path, scene, count, upright.tilt)))
        check_scene(name, path, 0, made[which].has_stands ? made[which].stands : 0, &upright);
    unlink(path);
}

static int is_asked_for(const char *name, int argc, char **argv)
{
    int asked = argc < 2;
    for (int i = 1; i < argc; i++)
        asked = asked || strcmp(argv[i], name) == 0;
    return asked;
}

int main(int argc, char **argv)
{
    pool = fxs_pool_create(fxs_processors());
    if (!pool)
        return 1;
    if (getenv("FXS_PROCESSORS") && !strcmp(getenv("FXS_PROCESSORS"), "all"))
        width = 960, height = 640;
    puts("| scene | form | bytes a Gaussian | PSNR, dB | SSIM | import, s |\n|---|---|---|---|---|---|");
    for (which = 0; which < sizeof made / sizeof *made; which++)
        for (variant = 0; variant < made[which].variants && is_asked_for(made[which].name, argc, argv); variant++)
            RUN(quality_of_made_scene);
    for (which = 0; which < sizeof shared / sizeof *shared; which++)
        if (is_asked_for(shared[which].name, argc, argv))
            RUN(quality_of_shared_scene);
    fxs_pool_destroy(pool);
    return check_report();
}
