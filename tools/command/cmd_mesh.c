/* fixsplat mesh: makes a triangle mesh of a scene from depths of many views. */
#include <fixsplat/surface.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "auto_backend.h"
#include "drawing.h"
#include "file_guard.h"
#include "views.h"

enum { VIEWS_DEFAULT = 96, RESOLUTION_DEFAULT = 512, PARTS_DEFAULT = 256, MEMORY_DEFAULT_GB = 4 };
enum { SIZE_LEAST = 256, SIZE_MOST = 2048 };
enum { AROUND_BOX = 2 };        /* of an unbounded scene, views from outside show twice the box's size */
enum { FROM_AUTO, FROM_OUTSIDE, FROM_INSIDE, FROM_BOTH };

typedef struct mesh_options {
    frame_options frame;
    const char *output;
    int from;
    uint32_t views, resolution, trim, parts, triangles;
    int has_box, watertight, unbounded;
    double box[6], scale, band;
    size_t memory;
} mesh_options;

static int take_box(const option_row *row, void *field, const char *value)
{
    mesh_options *o = field;
    o->has_box = parse_vector(value, 6, o->box);
    for (int i = 0; i < 3; i++)
        o->has_box &= o->box[i] < o->box[i + 3];
    return o->has_box ? 0 : wrong_value(row, value);
}

#define OPTIONS mesh_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .basic = 1, .help =
     "mesh with colours and normals: .glb (y up), .ply or .obj (both with the scene's axes)"},
    {"resolution", "N", UINT32(resolution, 16, FXS_VOLUME_RESOLUTION), .basic = 1, .help =
     "voxels along the longest side of the box, 16 to 2048 (default 512). Time and memory grow with its square"},
    {"triangles", "N", UINT32(triangles, 4, UINT32_MAX / 3), .basic = 1, .help =
     "reduce the mesh to at most N triangles, where its shape allows it (default: keep all)"},
    {"box", "X,Y,Z,X,Y,Z", take_box, 0, .expected = "two corners X,Y,Z,X,Y,Z, the least first", .basic = 1, .help =
     "least and greatest corner of the part that becomes a mesh (default: the scene without outliers)"},
    {"unbounded", 0, FLAG(unbounded), .basic = 1, .help =
     "also take what lies outside the box, up to 16 times as far, in voxels that grow with the square of the distance. "
     "The box, which becomes a cube, is that of the cameras, if there is no --box"},
    {"cameras", "FILE", TEXT(frame.cameras), .basic = 1, .help =
     "take the depths of the views of a camera file, as for render (default: views of its own)"},
    {"view", "N|NAME|LIST|all", TEXT(frame.view), .help = "views of the camera file (default all)"},
    {"from", "WHERE", CHOICE(from, WORDS("auto", "outside", "inside", "both")), .basic = 1, .help =
     "where its own views are: outside, all around the box; inside, at 15 places within it, for rooms; both; auto "
     "(default) takes inside if the start view of an .fxs is within the box, else outside"},
    {"views", "N", UINT32(views, 4, 4096), .help = "number of its own views from outside, 4 to 4096 (default 96)"},
    {"watertight", 0, FLAG(watertight), .basic = 1, .help =
     "close holes: what no view sees counts as inside"},
    {"band", "VOXELS", REAL(band, 1, 64, "1 to 64 voxels"), .help =
     "distance before a surface in which depths are averaged, and half as much behind it, 1 to 64 voxels (default "
     "resolution / 32, at least 4). A wider band averages noisy depths, a narrower one keeps thin walls"},
    {"trim", "N", UINT32(trim, 1, FXS_VOLUME_VIEWS), .help =
     "leave out surfaces that fewer than N views see (default 1)"},
    {"parts", "N", UINT32(parts, 0, UINT32_MAX), .help =
     "leave out connected parts with fewer than N triangles (default 256)"},
    {"scale", "METRES", REAL(scale, ABOVE_0, INFINITY, "metres per scene unit, above 0"), .basic = 1, .help =
     "metres per scene unit (default 1)"},
    {"up", "X,Y,Z", POINT(frame.up), .help =
     "up direction of the scene, which becomes y in a .glb (default: of the file, else of the cameras, else found)"},
    {"near", "DEPTH", REAL(frame.near, 0x1p-20, 0x1p28, "a depth from 2^-20 to 2^28"), .help =
     "near plane of the views of a camera file, scene units (default 0.2)"},
    {"time", "SECONDS", TIME(frame.render.time_q32), .help = "moment of a scene that moves, which needs it"},
    {"max-memory", "BYTES", BYTES(memory), .help =
     "most memory for voxels and mesh, also as 512M, 2G (default 4G). If it is too little, mesh says so before it adds "
     "depths"},
    {"threads", "N", take_threads, FIELD(frame_options, frame), 1, 64, .help =
     "number of threads, 1 to 64 (default: one per processor); the mesh does not depend on it"},
    {"cpu", "LIST", TEXT(frame.cpu), .help =
     "instruction sets to use: all (default), c for none, or a list out of sse41,avx2,avx512,neon; the mesh does not "
     "depend on it"},
    {"backend", "NAME", TEXT(frame.backend), .help =
     "renderer of the depths: cpu, cuda, gles-compute or vulkan, all with the same mesh; auto (default) takes the "
     "fastest by a trial"},
    {"device", "N", take_devices, FIELD(frame_options, frame), .help =
     "GPU of --backend cuda or vulkan, a number from 0 (default 0)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how a scene that is not an .fxs is packed: default, compact or small"},
    {0}
};

static const option_rule rules[] = {
    {"near", 0, "cameras", 0},
    {"from views", "cameras", 0, "the views are those of the file"},
    {0}
};

static int is_mesh(const char *name)
{
    return ends_with(name, ".glb") || ends_with(name, ".ply") || ends_with(name, ".obj");
}

static int read_options(mesh_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->views = VIEWS_DEFAULT;
    o->resolution = RESOLUTION_DEFAULT;
    o->parts = PARTS_DEFAULT;
    o->memory = (size_t)MEMORY_DEFAULT_GB << 30 ? (size_t)MEMORY_DEFAULT_GB << 30 : SIZE_MAX;
    o->scale = 1;
    if (take_options(&command_mesh, o, argc, argv) || check_rules(rules) ||
        take_scenes(&o->frame.world, "mesh", argc - optind, argv + optind))
        return EXIT_USAGE;
    if (!o->output)
        return fail(EXIT_USAGE, "mesh: where to? Give -o OUT.glb, OUT.ply or OUT.obj");
    if (!is_mesh(o->output))
        return fail(EXIT_USAGE, "%s: expected a name ending in .glb, .ply or .obj", o->output);
    if (is_given("up") && !ends_with(o->output, ".glb"))
        return fail(EXIT_USAGE, "--up is for a .glb: %s keeps the axes of the scene", o->output);
    const fxs_backend *backend = fxs_backend_find(o->frame.backend);
    if (backend && !(backend->can & FXS_CAN_TRACE))
        return fail(EXIT_USAGE, "--backend %s has colours only: no depths for a mesh", backend->name);
    o->frame.view = o->frame.cameras && !o->frame.view ? "all" : o->frame.view;
    return frame_options_check(&o->frame);
}

/* ---- Views and box ----------------------------------------------------------------------------------------------- */

typedef struct mesh_task {
    mesh_options *o;
    world world;
    renderer renderer;
    picture picture;
    fxs_view *views;
    uint32_t view_count;
    int is_inside;
    double low[3], high[3];
    int is_covered, has_depth;      /* 1: a view has covered pixels; pixels with a depth */
    fxs_workers workers;
    fxs_shapes *shapes;
    fxs_volume *volume;
    fxs_mesh *mesh;
    fxs_pool *pool;
} mesh_task;

/* Finds the box of the mesh: that of the options, else the scene's visible part with a margin, and on each side all of
   the scene if little of it is beyond the visible part. */
static void find_box(mesh_task *t)
{
    const world *w = &t->world;
    double longest = 0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, w->inner_high[i] - w->inner_low[i]);
    for (int i = 0; i < 3; i++) {
        const double side = w->inner_high[i] - w->inner_low[i], more = side / 5, margin = longest / 32;
        t->low[i] = fmax(w->low[i], w->inner_low[i] - more) - margin;
        t->high[i] = fmin(w->high[i], w->inner_high[i] + more) + margin;
        if (t->o->has_box) {
            t->low[i] = t->o->box[i];
            t->high[i] = t->o->box[i + 3];
        }
    }
}

static int is_in_box(const mesh_task *t, const double at[3])
{
    for (int i = 0; i < 3; i++)
        if (!(at[i] > t->low[i] && at[i] < t->high[i]))
            return 0;
    return 1;
}

/* Takes the box of the cameras' places, unless they are in one place. */
static void find_box_of_cameras(mesh_task *t)
{
    double low[3], high[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = t->views[0].position[k];
        for (uint32_t i = 1; i < t->view_count; i++) {
            low[k] = fmin(low[k], t->views[i].position[k]);
            high[k] = fmax(high[k], t->views[i].position[k]);
        }
        longest = fmax(longest, high[k] - low[k]);
    }
    if (!(longest > 0))
        return;
    memcpy(t->low, low, sizeof low);
    memcpy(t->high, high, sizeof high);
}

static int views_of_cameras(mesh_task *t)
{
    frame_options *f = &t->o->frame;
    const int is_up = f->up.given || world_up(&t->world, f->up.at);
    const long count = choose_views(f, &t->world, &t->views, 0);
    double up[3] = {0};
    uint32_t inside = 0;
    if (count < 0)
        return EXIT_FAILED;
    t->view_count = (uint32_t)count;
    if (t->o->unbounded && !t->o->has_box)
        find_box_of_cameras(t);
    for (long i = 0; i < count; i++) {
        inside += (uint32_t)is_in_box(t, t->views[i].position);
        for (int k = 0; k < 3; k++)
            up[k] -= t->views[i].rotation[3 + k];
    }
    if (!is_up)
        memcpy(f->up.at, up, sizeof up);
    t->is_inside = 2 * inside > t->view_count;
    return 0;
}

/* True if a scene has a start view within the box, as a room has. */
static int starts_inside(const mesh_task *t)
{
    fxs_view start;
    const fxs_opened *opened = t->world.scenes[0].opened;
    return t->world.placed.file_count == 1 && fxs_view_of_start(&start, opened->data, 64, 64) &&
           is_in_box(t, start.position);
}

/* Finds the up direction, of the file or else by looking at the scene. */
static int find_upright(mesh_task *t)
{
    frame_options f = t->o->frame;
    fxs_view *first = 0;
    if (f.up.given || world_up(&t->world, t->o->frame.up.at) || !ends_with(t->o->output, ".glb"))
        return 0;
    const long count = choose_views(&f, &t->world, &first, 0);
    free(first);
    memcpy(t->o->frame.up.at, f.up.at, sizeof f.up.at);
    return count < 1 ? EXIT_FAILED : 0;
}

static int views_of_box(mesh_task *t)
{
    fxs_message why;
    if (find_upright(t))
        return EXIT_FAILED;
    if (t->o->from == FROM_AUTO)
        t->o->from = starts_inside(t) ? FROM_INSIDE : FROM_OUTSIDE;
    t->is_inside = t->o->from == FROM_INSIDE;
    if (t->is_inside && is_given("views"))
        return fail(EXIT_USAGE, "--views is for views from outside: --from inside has %u", FXS_VIEWS_WITHIN);
    const uint32_t around = t->o->from == FROM_INSIDE ? 0 : t->o->views;
    const uint32_t within = t->o->from == FROM_OUTSIDE ? 0 : FXS_VIEWS_WITHIN;
    int size = (int)(t->o->resolution + t->o->resolution / 4 + 31) / 32 * 32;
    size *= t->o->unbounded ? AROUND_BOX : 1;
    size = size < SIZE_LEAST ? SIZE_LEAST : size > SIZE_MOST ? SIZE_MOST : size;
    t->view_count = around + within;
    t->views = calloc(t->view_count, sizeof *t->views);
    if (!t->views)
        return fail(EXIT_FAILED, "out of memory: %" PRIu32 " views", t->view_count);
    int error = around ? fxs_views_around(t->views, around, t->low, t->high, size, &why) : 0;
    for (uint32_t i = 0; i < around && t->o->unbounded; i++) {
        t->views[i].fx /= AROUND_BOX;
        t->views[i].fy /= AROUND_BOX;
    }
    if (!error && within)
        error = fxs_views_within(t->views + around, t->low, t->high, size, &why);
    return error ? fail_for(&why) : 0;
}

/* ---- Depths ------------------------------------------------------------------------------------------------------ */

static void look_at_pixels(mesh_task *t)
{
    const size_t count = (size_t)t->picture.width * (size_t)t->picture.height;
    for (size_t i = 0; i < count; i++) {
        t->is_covered |= t->picture.pixels[4 * i + 3] > 0;
        t->has_depth |= t->picture.depths[i] != FXS_NOTHING;
    }
}

/* Draws all views and gives their depths to a function of the volume. `divisor` divides the size of the pictures. */
static int draw_all(mesh_task *t, int divisor, const char *doing,
                    int (*take)(fxs_volume *volume, const fxs_depth_picture *picture, fxs_message *message))
{
    char label[16];
    snprintf(label, sizeof label, "%s", doing);
    for (uint32_t i = 0; i < t->view_count; i++) {
        fxs_view view = t->views[i];
        fxs_message why;
        fxs_view_resize(&view, view.width / divisor > 2 ? view.width / divisor : 2,
                        view.height / divisor > 2 ? view.height / divisor : 2);
        if (renderer_render(&t->renderer, &t->world, &view, &t->o->frame.render, &t->picture, 0))
            return EXIT_FAILED;
        fxs_shapes_refine(t->shapes, &view, t->picture.ids, t->picture.depths, t->picture.depth_bits, &t->workers);
        const fxs_depth_picture depths = {&view, t->picture.depths, t->picture.pixels, t->picture.depth_bits};
        if (divisor > 1)
            look_at_pixels(t);
        if (take(t->volume, &depths, &why))
            return fail_for(&why);
        progress_bar(label, (i + 1.0) / t->view_count);
    }
    progress_end();
    return 0;
}

static const char *name_of(const mesh_task *t)
{
    return t->world.placed.files[0];
}

static int fail_empty(const mesh_task *t)
{
    return fail(EXIT_FAILED, "%s: %s", name_of(t),
                !t->is_covered  ? "no view shows a Gaussian: give other --cameras, or --from"
                : !t->has_depth ? "the views show haze only: nothing takes half of the light"
                                : "the surfaces that the views show are outside the box: give another --box");
}

static int make_volume(mesh_task *t)
{
    const mesh_options *o = t->o;
    fxs_volume_options options;
    fxs_message why;
    fxs_volume_options_init(&options);
    options.resolution = o->resolution;
    options.truncation = o->band;
    options.least_views = o->trim;
    options.closed = o->watertight;
    options.is_cave = t->is_inside;
    options.is_unbounded = o->unbounded;
    options.max_memory = o->memory;
    options.workers = t->workers;
    memcpy(options.low, t->low, sizeof t->low);
    memcpy(options.high, t->high, sizeof t->high);
    const int error = fxs_volume_make(&t->volume, &options, &why) ||
                      fxs_shapes_make(&t->shapes, t->world.objects, t->world.count, &why);
    return error ? fail_for(&why) : 0;
}

/* Reserves the voxels, and says how many there are before the depths are added. */
static int reserve(mesh_task *t)
{
    fxs_volume_size size;
    fxs_message why;
    const double most = (double)t->o->memory;
    const int error = fxs_volume_reserve(t->volume, &size, &why);
    if (error == FXS_ERR_MEMORY && why.bytes_needed > t->o->memory)
        return fail(EXIT_FAILED, "--resolution %" PRIu32 ": %s; about %d fits", t->o->resolution, why.text,
                    (int)(t->o->resolution * sqrt(most / (double)why.bytes_needed)));
    if (error)
        return fail_for(&why);
    if (!size.bricks)
        return fail_empty(t);
    note("%s: %" PRIu32 " views from %s, voxels of %.4g units, %" PRIu64 " MB", name_of(t), t->view_count,
         t->o->frame.cameras ? t->o->frame.cameras : t->o->from == FROM_BOTH ? "outside and inside"
         : t->is_inside ? "inside" : "outside", size.voxel, (size.bytes + 999999) / 1000000);
    return 0;
}

/* ---- Mesh -------------------------------------------------------------------------------------------------------- */

static int finish_mesh(mesh_task *t)
{
    const mesh_options *o = t->o;
    fxs_mesh_write_options options;
    fxs_message why;
    uint32_t parts = 0;
    if (fxs_volume_mesh(t->volume, &t->mesh, &why) || fxs_mesh_drop_parts(t->mesh, o->parts, &parts, &why))
        return fail_for(&why);
    if (!t->mesh->triangle_count)
        return fail(EXIT_FAILED, "%s: no surface has %" PRIu32 " triangles: lower --parts, or raise --resolution",
                    name_of(t), o->parts);
    if (o->triangles && fxs_mesh_decimate(t->mesh, o->triangles, &why))
        return fail_for(&why);
    fxs_mesh_expand(t->mesh);
    fxs_mesh_write_options_init(&options);
    options.scale = o->scale;
    memcpy(options.up, o->frame.up.at, sizeof options.up);
    if (fxs_mesh_write(o->output, t->mesh, &options, &why))
        return fail_for(&why);
    note("%s: %" PRIu32 " triangles, %" PRIu32 " vertices, %" PRIu32 " part%s", o->output, t->mesh->triangle_count,
         t->mesh->vertex_count, parts, parts == 1 ? "" : "s");
    return 0;
}

static int check_time(const mesh_task *t)
{
    return world_time(&t->world).duration > 0 && !is_given("time")
               ? fail(EXIT_USAGE, "%s: a scene that moves: give --time", name_of(t)) : 0;
}

static int make_mesh(mesh_task *t)
{
    int status = check_time(t);
    if (status)
        return status;
    find_box(t);
    status = t->o->frame.cameras ? views_of_cameras(t) : views_of_box(t);
    if (status)
        return status;
    settle_backend(&t->o->frame, 2.0 * t->view_count);
    status = renderer_open(&t->renderer, &t->o->frame);
    t->renderer.draws = DRAW_MEDIAN_DEPTH | DRAW_IDS;
    t->renderer.format = FXS_FORMAT_RGBA8_COVERAGE;
    if (status || make_volume(t) || draw_all(t, 2, "looking", fxs_volume_mark) || reserve(t) ||
        draw_all(t, 1, "adding", fxs_volume_add))
        return EXIT_FAILED;
    return finish_mesh(t);
}

static int run(int argc, char **argv)
{
    static mesh_options o;
    static mesh_task t;
    int status = read_options(&o, argc, argv);
    if (status)
        return status;
    t.o = &o;
    status = world_open(&t.world, &o.frame.world, &o.frame.load);
    if (status)
        return status;
    t.pool = fxs_pool_create(o.frame.threads);
    t.workers = (fxs_workers){fxs_pool_run, t.pool, o.frame.threads};
    status = t.pool ? make_mesh(&t) : fail(EXIT_FAILED, "out of memory: threads");
    renderer_forget(&t.renderer, &t.world);
    renderer_close(&t.renderer);
    picture_free(&t.picture);
    free(t.views);
    fxs_shapes_free(t.shapes);
    fxs_volume_free(t.volume);
    fxs_mesh_free(t.mesh);
    fxs_pool_destroy(t.pool);
    world_close(&t.world);
    return status;
}

const command command_mesh = {
    "mesh", "scene -> triangle mesh", run,
    "Usage: fixsplat mesh SCENE... -o OUT [OPTION...]\n\n"
    "Makes a triangle mesh of a scene: .glb, .ply or .obj, with colours and normals, from the depths of many views.\n"
    "The mesh has the same bytes on every machine, with any threads and back end.\n",
    0,
    "  $ fixsplat mesh toy.ply -o toy.glb\n"
    "  $ fixsplat mesh toy.ply --cameras cameras.json --box -1,-1,-1,1,1,1 --resolution 768 -o toy.glb\n"
    "  $ fixsplat mesh room.fxs --from inside --triangles 200000 --scale 0.42 -o room.glb\n"
    "  $ fixsplat mesh toy.ply --watertight --triangles 50000 -o print.obj\n",
    {{own_rows, 0}, {world_rows, offsetof(mesh_options, frame.world)}, {load_rows, offsetof(mesh_options, frame.load)},
     COMMON_TABLE}
};
