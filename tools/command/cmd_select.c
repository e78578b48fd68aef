/* fixsplat select: finds objects in a scene by masks, clicks and boxes, and writes them as scenes of their own. */
#include <fixsplat/select.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/packed.h>
#include "src/fit/photos/photo_masks.h"
#include "cmd_convert.h"
#include "drawing.h"
#include "file_guard.h"
#include "slotted_scene.h"
#include "views.h"

enum { HINTS_MOST = 1024, NAME_MOST = 4096, DIM = 4 };

#define TRIM_DEFAULT 0.5

/* A click or a box, and the view that it is in, as text. */
typedef struct placed_hint {
    char view[128];                         /* number or name of the view; empty: that of --view */
    fxs_select_hint at;
} placed_hint;

typedef struct select_options {
    frame_options frame;
    const char *output, *rest, *picture, *masks;
    int ids;
    placed_hint hints[HINTS_MOST];
    uint32_t hint_count;
    int labels, exact;
    double bias, trim;
    size_t max_memory;
} select_options;

/* ---- Options ----------------------------------------------------------------------------------------------------- */

/* Takes [VIEW:]X,Y[,X,Y][,OBJECT]: `count` coordinates, and the object if `is_object`; else the object is 0. */
static int take_hint(const option_row *row, void *field, const char *value, int count, int is_object)
{
    select_options *o = field;
    const char *colon = strrchr(value, ':'), *rest = colon ? colon + 1 : value;
    int n[5] = {0};
    placed_hint h = {.view = ""};
    if (o->hint_count == HINTS_MOST)
        return fail(EXIT_USAGE, "--%s %s: more than %d clicks and boxes", row->name, value, HINTS_MOST);
    if (colon && (size_t)(colon - value) >= sizeof h.view)
        return wrong_value(row, value);
    if (colon)
        memcpy(h.view, value, (size_t)(colon - value));
    int is_right = parse_counts(rest, count, 0, FXS_MAX_SIZE - 1, n);
    h.at.object = (uint32_t)is_object;
    if (!is_right && is_object && parse_counts(rest, count + 1, 0, FXS_MAX_SIZE - 1, n)) {
        is_right = n[count] >= 1 && n[count] <= (int)FXS_SELECT_OBJECTS;
        h.at.object = (uint32_t)n[count];
    }
    h.at.x = n[0];
    h.at.y = n[1];
    h.at.right = n[count - 2];
    h.at.bottom = n[count - 1];
    if (!is_right || h.at.right < h.at.x || h.at.bottom < h.at.y)
        return wrong_value(row, value);
    o->hints[o->hint_count++] = h;
    return 0;
}

static int take_click(const option_row *row, void *field, const char *value)
{
    return take_hint(row, field, value, 2, 1);
}

static int take_not(const option_row *row, void *field, const char *value)
{
    return take_hint(row, field, value, 2, 0);
}

static int take_around(const option_row *row, void *field, const char *value)
{
    return take_hint(row, field, value, 4, 1);
}

#define OPTIONS select_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .basic = 1, .help =
     "scene with the object, in the format of its ending. For several objects, the name has one %d: thing-%d.ply"},
    {"rest", "FILE", OUTPUT(rest), .basic = 1, .help = "scene with all other Gaussians"},
    {"ids", 0, FLAG(ids), .help =
     "print a line for each Gaussian of SCENE, in its order: the number of its object, 0 for none, 255 for a border"},
    {"picture", "FILE", OUTPUT(picture), .basic = 1, .help =
     "picture of the first marked view, all but the objects darkened: to see what is selected"},
    {.help = "What the objects are, in views of --cameras, or in the first view of the scene:"},
    {"masks", "FOLDER", TEXT(masks), .basic = 1, .help =
     "masks of views of --cameras, as large as the views: white is the object. The mask of view NAME is NAME.png, or "
     "without the ending of NAME. Three views from different sides are usually enough"},
    {"labels", 0, FLAG(labels), .help =
     "the grey of a mask is the number of an object, 1 to 200; 0: no object; 255: unknown"},
    {"click", "VIEW:X,Y,OBJECT", take_click, 0, .expected = "X,Y or X,Y,OBJECT, an object 1 to 200", .basic = 1, .help =
     "a pixel of the object: the region of like colour and depth there. May be repeated. X,Y alone is in --view, and "
     "of object 1, also for the next two options"},
    {"not", "VIEW:X,Y", take_not, 0, .expected = "X,Y", .basic = 1, .help =
     "a pixel of something else, to take back what --click took too much"},
    {"around", "VIEW:X,Y,X,Y,OBJECT", take_around, 0, .expected =
     "X,Y,X,Y or X,Y,X,Y,OBJECT, the upper left corner first", .basic = 1, .help =
     "a box around the object: what its edge does not run into"},
    {"bias", "B", REAL(bias, -1, 1, "a number from -1 to 1"), .help =
     "share of a Gaussian's weight that is moved from the object to the rest, -1 to 1 (default 0). Above 0, fewer "
     "Gaussians of the border; below, more"},
    {"trim", "SHARE", REAL(trim, 0, 1, "a share from 0 to 1"), .basic = 1, .help =
     "leave the border out of OUT and of REST, so that no fringe remains: Gaussians that --bias higher by this share "
     "puts outside, or lower by it inside, 0 to 1 (default 0.5; 0: each Gaussian is in OUT or in REST)"},
    {"alone", 0, FLAG(exact), .help =
     "decide for each Gaussian by itself: Gaussians that the marked views do not show are in no object (default: they "
     "take after their neighbours)"},
    {"max-memory", "BYTES", BYTES(max_memory), .help =
     "refuse work that needs more memory, also as 512M, 2G (default 2G)"},
    {"threads", "N", take_threads, FIELD(frame_options, frame), 1, 64, .help =
     "number of threads, 1 to 64 (default: one per processor); the objects do not depend on it"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how an .fxs of OUT and REST is packed: default, compact or small"},
    {.help = "Views:"},
    {"cameras", "FILE", TEXT(frame.cameras), .basic = 1, .help = "camera file, as for render"},
    {"view", "N|NAME", TEXT(frame.view), .help = "view of the clicks and boxes that name none (default 0)"},
    {"eye", "X,Y,Z", POINT(frame.eye), .help = "without --cameras: position of the camera"},
    {"look", "X,Y,Z", POINT(frame.look), .help = "point that the camera looks at"},
    {"up", "X,Y,Z", POINT(frame.up), .help = "up direction (default: of the file, else found)"},
    {"fov", "DEGREES", REAL(frame.fov, 1, 170, "degrees from 1 to 170"), .help =
     "vertical field of view, 1 to 170 (default 50)"},
    {"size", "WxH", take_frame_size, FIELD(frame_options, frame), .expected = SIZE_EXPECTED, .help =
     "size of the picture without --cameras (default 1280x720)"},
    {0}
};

static const option_rule rules[] = {
    {"masks", 0, "cameras", "a mask belongs to a view of --cameras"},
    {"labels", 0, "masks", 0},
    {"view", 0, "cameras", 0},
    {"view", "masks", "click not around", 0},
    {"eye look up fov size", "cameras", 0, "the views are those of the file"},
    {"look fov", 0, "eye", 0},
    {0}
};

static int read_options(select_options *o, int argc, char **argv)
{
    int is_packed = 0;
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->trim = TRIM_DEFAULT;
    if (take_options(&command_select, o, argc, argv) || check_rules(rules))
        return EXIT_USAGE;
    if (argc - optind > 1)
        return fail(EXIT_USAGE, "select takes one scene; see: fixsplat select --help");
    if (take_scenes(&o->frame.world, "select", argc - optind, argv + optind))
        return EXIT_USAGE;
    if (!o->output && !o->rest && !o->ids && !o->picture)
        return fail(EXIT_USAGE, "select: what for? Give -o OUT, --rest, --ids or --picture");
    if (!o->masks && !o->hint_count)
        return fail(EXIT_USAGE, "select: what? Give --masks FOLDER, --click X,Y or --around X,Y,X,Y");
    for (int i = 0; i < 2; i++) {
        const char *name = i ? o->rest : o->output;
        if (name && !fxs_scene_format_of(name, 1))
            return fail(EXIT_USAGE, "%s: expected a scene's name, as out.ply or out.fxs", name);
        is_packed |= name && ends_with(name, ".fxs");
    }
    return is_given("profile") && !is_packed ? fail(EXIT_USAGE, "--profile is for .fxs") : 0;
}

/* ---- Marked views ------------------------------------------------------------------------------------------------ */

typedef struct selection {
    const select_options *o;
    slotted_scene scene;
    world world;
    fxs_context context;
    fxs_kernels kernels;
    fxs_view *views;                        /* of the camera file, or the one view */
    long view_count;
    fxs_select_view *marked;                /* views with marks, which are allocated */
    long *numbers;                          /* their places in `views` */
    uint32_t marked_count, objects;
    uint8_t *object_of;                     /* object of each slot */
} selection;

static const char *path_of(const selection *s)
{
    return s->o->frame.world.scenes[0];
}

/* Returns the marks of a view, all FXS_SELECT_PERHAPS if they are new; null: a failure. */
static uint8_t *marks_of(selection *s, long number)
{
    fxs_message why;
    const size_t pixels = (size_t)s->views[number].width * (size_t)s->views[number].height;
    for (uint32_t i = 0; i < s->marked_count; i++)
        if (s->numbers[i] == number)
            return (uint8_t *)(uintptr_t)s->marked[i].marks;
    if (s->marked_count == FXS_SELECT_VIEWS)
        return fail(EXIT_FAILED, "more than %u marked views", FXS_SELECT_VIEWS), NULL;
    fxs_select_view *view = &s->marked[s->marked_count];
    if (fxs_camera_from_view(&view->camera, &s->views[number], &why))
        return fail_for(&why), NULL;
    uint8_t *marks = malloc(pixels);
    if (!marks)
        return fail(EXIT_FAILED, "out of memory: marks of %zu pixels", pixels), NULL;
    memset(marks, FXS_SELECT_PERHAPS, pixels);
    view->marks = marks;
    s->numbers[s->marked_count++] = number;
    return marks;
}

static int take_labels(selection *s, const char *path, const uint8_t *rgba, size_t pixels, uint8_t *marks)
{
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t grey = rgba[4 * i];
        if (grey > FXS_SELECT_OBJECTS && grey < FXS_SELECT_UNKNOWN)
            return fail(EXIT_FAILED, "%s: a label of %u: expected 0 to %u, or 255", path, grey, FXS_SELECT_OBJECTS);
        marks[i] = grey;
        s->objects = grey <= FXS_SELECT_OBJECTS && grey > s->objects ? grey : s->objects;
    }
    return 0;
}

static int read_mask(selection *s, const char *path, long number)
{
    const fxs_view *view = &s->views[number];
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    uint8_t *rgba, *marks = marks_of(s, number);
    int width, height, status = 0;
    fxs_message why;
    if (!marks)
        return EXIT_FAILED;
    if (fxs_image_file_read(path, &rgba, &width, &height, &why))
        return fail_for(&why);
    if (width != view->width || height != view->height)
        status = fail(EXIT_FAILED, "%s: %d x %d pixels, but its view has %d x %d", path, width, height, view->width,
                      view->height);
    else if (s->o->labels)
        status = take_labels(s, path, rgba, pixels, marks);
    for (size_t i = 0; i < pixels && !status && !s->o->labels; i++)
        marks[i] = fxs_photo_mask_grey(rgba + 4 * i) >= FXS_PHOTO_MASK_WHITE;
    free(rgba);
    return status;
}

static int read_masks(selection *s)
{
    char path[FXS_PHOTO_PATH];
    int status = 0;
    for (long i = 0; i < s->view_count && !status; i++)
        if (fxs_photo_mask_in(s->o->masks, s->views[i].name, path)) {
            files_read(path);
            status = read_mask(s, path, i);
        }
    if (!status && !s->marked_count)
        return fail(EXIT_FAILED, "%s: no mask of a view of %s; that of %s is %s.png", s->o->masks,
                    s->o->frame.cameras, s->views[0].name, s->views[0].name);
    return status;
}

/* Finds the view of a click or a box. Returns -1 after a failure. */
static long view_of(const selection *s, const placed_hint *h)
{
    frame_options f = s->o->frame;
    if (!f.cameras && *h->view)
        return fail(-1, "%s: a view of --cameras, which is not given", h->view);
    f.view = *h->view ? h->view : f.view;
    return f.cameras ? find_view(&f, s->views, s->view_count) : 0;
}

/* Marks all clicks and boxes of the view of hint `first`. */
static int mark_hints(selection *s, uint32_t first, const long *views)
{
    static fxs_select_hint hints[HINTS_MOST];
    uint32_t count = 0;
    fxs_scene scene;
    fxs_camera camera;
    fxs_message why;
    uint8_t *marks = marks_of(s, views[first]);
    if (!marks)
        return EXIT_FAILED;
    for (uint32_t i = first; i < s->o->hint_count; i++)
        if (views[i] == views[first])
            hints[count++] = s->o->hints[i].at;
    int error = fxs_camera_from_view(&camera, &s->views[views[first]], &why);
    if (!error)
        error = fxs_scene_open(&scene, s->scene.packed.data, s->scene.packed.bytes)
                    ? fxs_fail_as(FXS_ERR_SCENE, &why, "%s", fxs_strerror(FXS_ERR_SCENE))
                    : fxs_select_mark(&s->context, &scene, &camera, hints, count, marks, &why);
    return error ? fail_for(&why) : 0;
}

static int take_hints(selection *s)
{
    static long views[HINTS_MOST];
    const select_options *o = s->o;
    int status = 0;
    for (uint32_t i = 0; i < o->hint_count; i++) {
        views[i] = view_of(s, &o->hints[i]);
        if (views[i] < 0)
            return EXIT_FAILED;
        s->objects = o->hints[i].at.object > s->objects ? o->hints[i].at.object : s->objects;
    }
    for (uint32_t i = 0; i < o->hint_count && !status; i++) {
        int is_first = 1;
        for (uint32_t k = 0; k < i; k++)
            is_first &= views[k] != views[i];
        if (is_first)
            status = mark_hints(s, i, views);
    }
    return status;
}

static int mark_views(selection *s)
{
    frame_options f = s->o->frame;
    f.view = f.cameras ? "all" : 0;
    s->view_count = choose_views(&f, &s->world, &s->views, 0);
    if (s->view_count < 1)
        return EXIT_FAILED;
    s->marked = calloc((size_t)s->view_count, sizeof *s->marked);
    s->numbers = calloc((size_t)s->view_count, sizeof *s->numbers);
    if (!s->marked || !s->numbers)
        return fail(EXIT_FAILED, "out of memory: %ld views", s->view_count);
    s->objects = s->o->masks && !s->o->labels;
    int status = s->o->masks ? read_masks(s) : 0;
    status = status ? status : take_hints(s);
    if (!status && !s->objects)
        return fail(EXIT_FAILED, "no object is marked: only what is something else");
    return status;
}

/* ---- Results ----------------------------------------------------------------------------------------------------- */

static uint32_t object_of(const selection *s, uint64_t gaussian)
{
    const uint32_t slot = s->scene.slots[gaussian];
    return slot == FXS_NOTHING ? 0 : s->object_of[slot];
}

static int find_objects(selection *s)
{
    fxs_select_options options;
    fxs_message why;
    fxs_scene scene;
    if (fxs_scene_open(&scene, s->scene.packed.data, s->scene.packed.bytes))
        return fail(EXIT_FAILED, "%s: %s", path_of(s), fxs_strerror(FXS_ERR_SCENE));
    fxs_select_options_init(&options);
    options.objects = s->objects;
    options.bias = s->o->bias;
    options.trim = s->o->trim;
    options.exact = s->o->exact;
    options.max_memory = s->o->max_memory;
    options.workers = s->context.config.workers;
    s->object_of = malloc((size_t)scene.chunk_count * FXS_CHUNK + 1);
    if (!s->object_of)
        return fail(EXIT_FAILED, "out of memory: %s", path_of(s));
    if (fxs_select(&s->context, &scene, s->marked, s->marked_count, &options, s->object_of, &why))
        return fail(EXIT_FAILED, "%s: %s", path_of(s), why.text);
    for (uint32_t object = 1; object <= s->objects; object++) {
        uint64_t count = 0;
        for (uint64_t i = 0; i < s->scene.count; i++)
            count += object_of(s, i) == object;
        note("%s: object %" PRIu32 ": %" PRIu64 " of %" PRIu64 " Gaussians", path_of(s), object, count, s->scene.count);
    }
    return 0;
}

static int write_fxs(const selection *s, const char *out, const load_options *load)
{
    world w;
    fxs_message why;
    if (world_open_merged(&w, &s->world.placed, path_of(s), load))
        return EXIT_FAILED;
    const fxs_opened *opened = w.scenes[0].opened;
    int error = 0;
    if (strcmp(out, s->o->rest ? s->o->rest : "") != 0)
        error = fxs_start_choose((void *)(uintptr_t)opened->data, opened->bytes, &why);
    error = error ? error : fxs_file_write(out, opened->data, opened->bytes, &why);
    world_close(&w);
    return error ? fail_for(&why) : 0;
}

/* Writes the Gaussians of one object, or for 0 those of none, as a scene. */
static int write_scene(const selection *s, const char *out, uint32_t object, uint8_t *left_out)
{
    fxs_scene_filter filter;
    load_options load = s->o->frame.load;
    uint64_t count = 0;
    for (uint64_t i = 0; i < s->scene.count; i++) {
        left_out[i] = object_of(s, i) != object;
        count += !left_out[i];
    }
    if (!count)
        return fail(EXIT_FAILED, "%s: it would have no Gaussian", out);
    fxs_scene_filter_init(&filter);
    filter.deleted = left_out;
    filter.deleted_count = s->scene.count;
    load.filter = &filter;
    load.again = 1;
    return ends_with(out, ".fxs") ? write_fxs(s, out, &load)
                                  : convert_merged(out, 0, 0, &s->world.placed, path_of(s), &load);
}

static int write_scenes(const selection *s)
{
    char name[NAME_MOST];
    int status = 0;
    uint8_t *left_out = malloc((size_t)s->scene.count + 1);
    if (!left_out)
        return fail(EXIT_FAILED, "out of memory: %s", path_of(s));
    for (uint32_t object = 1; object <= s->objects && s->o->output && !status; object++) {
        name_numbered(name, sizeof name, s->o->output, object);
        status = write_scene(s, name, object, left_out);
    }
    if (!status && s->o->rest)
        status = write_scene(s, s->o->rest, 0, left_out);
    free(left_out);
    return status;
}

/* Prints the object of each Gaussian of the file. */
static void print_ids(const selection *s)
{
    for (uint64_t i = 0; i < s->scene.count; i++)
        printf("%u\n", (unsigned)object_of(s, i));
}

/* Darkens a picture's pixels where the Gaussian with the largest weight is in no object. */
static void darken(const selection *s, const picture *p)
{
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint32_t slot = p->ids[i].gaussian;
        for (size_t k = 0; k < 3 && (slot == FXS_NOTHING || !s->object_of[slot] ||
                               s->object_of[slot] == FXS_SELECT_BORDER); k++)
            p->pixels[4 * i + k] /= DIM;
    }
}

static int write_picture(const selection *s)
{
    const select_options *o = s->o;
    renderer r;
    picture p = {0};
    fxs_message why;
    int status = renderer_open(&r, &o->frame);
    r.draws = DRAW_IDS;
    if (!status)
        status = renderer_render(&r, &s->world, &s->views[s->numbers[0]], &o->frame.render, &p, 0);
    if (!status) {
        darken(s, &p);
        if (fxs_image_file_write(o->picture, p.pixels, p.width, p.height, &why))
            status = fail_for(&why);
    }
    renderer_forget(&r, &s->world);
    renderer_close(&r);
    picture_free(&p);
    return status;
}

/* Registers the files, so that no output replaces an input. */
static int check_files(const selection *s)
{
    const select_options *o = s->o;
    char name[NAME_MOST];
    files_read(path_of(s));
    files_read(o->frame.cameras);
    for (uint32_t object = 1; object <= s->objects && o->output; object++) {
        name_numbered(name, sizeof name, o->output, object);
        files_write(name);
    }
    files_write(o->rest);
    files_write(o->picture);
    if (s->objects > 1 && o->output && !is_pattern(o->output))
        return fail(EXIT_USAGE, "%s: %u objects need a name with one %%d, as thing-%%d.ply", o->output,
                    (unsigned)s->objects);
    return files_check();
}

static int select_objects(selection *s)
{
    const select_options *o = s->o;
    const fxs_config config = {.size = sizeof config, .workers = {fxs_pool_run, s->scene.pool, s->scene.threads},
                               .kernels = &s->kernels};
    fxs_kernels_choose(&s->kernels, ~0u);
    fxs_context_init(&s->context, &config);
    int status = mark_views(s);
    status = status ? status : check_files(s);
    status = status ? status : find_objects(s);
    if (!status && o->picture)
        status = write_picture(s);
    status = status ? status : write_scenes(s);
    if (!status && o->ids)
        print_ids(s);
    return status;
}

static int run(int argc, char **argv)
{
    static select_options o;
    static selection s;
    int status = read_options(&o, argc, argv);
    if (status)
        return status;
    s.o = &o;
    status = slotted_open(&s.scene, path_of(&s), &o.frame.load, "is not selected from: convert it with --time SECONDS");
    if (!status)
        status = world_open_packed(&s.world, path_of(&s), &s.scene.packed);
    if (!status) {
        status = select_objects(&s);
        world_close(&s.world);
    }
    for (uint32_t i = 0; i < s.marked_count; i++)
        free((void *)(uintptr_t)s.marked[i].marks);
    free(s.marked);
    free(s.numbers);
    free(s.views);
    free(s.object_of);
    slotted_close(&s.scene);
    return status;
}

const command command_select = {
    "select", "scene -> objects, each a scene of its own", run,
    "Usage: fixsplat select SCENE -o OUT [--rest REST] [OPTION...]\n\n"
    "Finds the Gaussians of an object, by masks of some views, by clicks, or by a box around the object in a view.\n"
    "Writes the object as a scene of its own, and the rest as another. The same Gaussians on every machine.\n",
    0,
    "  $ fixsplat select room.ply --click 640,380 --picture look.png\n"
    "  $ fixsplat select room.ply --click 640,380 --not 700,500 -o chair.ply --rest room-without.ply\n"
    "  $ fixsplat select room.fxs --around 500,200,780,560 -o chair.fxs\n"
    "  $ fixsplat select room.ply --cameras cameras.json --click 3:640,380 --click 17:512,300 -o chair.ply\n"
    "  $ fixsplat select room.ply --cameras cameras.json --masks masks -o chair.ply\n"
    "  $ fixsplat select room.ply --cameras sparse/0 --masks labels --labels -o thing-%d.ply --rest room-only.ply\n",
    {{own_rows, 0}, {load_rows, offsetof(select_options, frame.load)}, COMMON_TABLE}
};
