/* fixsplat info: prints a scene's contents and the memory that rendering needs, or the size of a mesh. Options add
   quality, statistics, and distances. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/board.h>
#include "port/board/panel.h"
#include "port/board/turntable.h"
#include "src/pack/weight.h"
#include <fixsplat/scene.h>
#include <fixsplat/surface.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/stage.h>
#include "file_guard.h"
#include "live_chunks.h"
#include "mesh_info.h"
#include "tree_levels.h"
#include "quality.h"
#include "start_option.h"
#include "stats.h"

#define NUDGE_BELOW 65.0    /* PSNR in dB; better views are not compared with a randomly moved original */

typedef struct info_options {
    frame_options frame;
    const char *original;
    enum fxs_cutoff original_cutoff;
    int views;                              /* number of views to compare; 0: default */
    int board_width, board_height;          /* size of the board's display in pixels; 0: no board */
    const fxs_panel_type *panel;            /* the board's display; null: any panel of this size */
    int json, stats, backends;
    mesh_info_options mesh;                 /* of a mesh in place of a scene */
} info_options;

/* Memory needs of a scene on a microcontroller board with a display. */
typedef struct board {
    const fxs_panel_type *panel;
    int width, height;
    size_t strip;
    fxs_frame_memory memory;
    size_t rows, rows_most;    /* least and most bytes, over all views, to draw each row of tiles in one pass */
} board;

typedef struct findings {
    world world;
    int width, height;
    fxs_frame_memory memory;
    size_t limit;
    int lod;
    int compared;
    quality quality;
    int has_stats;
    scene_stats stats;
    board board;
    scene_levels *levels;
    live_chunks *live;
} findings;

static int is_one(const world *w)
{
    return w->count == 1 && fxs_placement_is_plain(w->placed.objects) && !w->placed.objects->crop_count;
}

static void print_error_json(const char *name, const fxs_pack_error *e)
{
    printf("\"%s\": {\"position\": %.3g, \"scale\": %.3g, \"rotation_degrees\": %.3g, \"opacity\": %.3g, \"dc\": %.3g, "
           "\"sh\": %.3g}, ", name, e->position, e->scale, e->rotation, e->opacity, e->dc, e->sh);
}

static int is_direction(const double up[3])
{
    return up[0] != 0 || up[1] != 0 || up[2] != 0;
}

static double fov_of(const fxs_start *s)
{
    return atan(s->tangent) * (360 / 3.14159265358979324);
}

/* Finds the up direction of a scene whose file states neither that nor a start view. */
static int look_for_up(const loaded_scene *s, double up[3])
{
    fxs_message unwanted;
    const fxs_start *start = &s->opened->info->start;
    return !is_direction(start->up) && !(start->tangent > 0) && !s->opened->pager && !find_up(s->opened, up, &unwanted);
}

static void print_start_json(const loaded_scene *scene)
{
    const fxs_start *s = &scene->opened->info->start;
    double found[3];
    if (look_for_up(scene, found)) {
        printf("\"up_found\": ");
        print_vector_json(found);
        printf(", ");
    }
    printf("\"up\": ");
    if (is_direction(s->up))
        print_vector_json(s->up);
    else
        printf("null");
    printf(", \"start_view\": ");
    if (s->tangent > 0) {
        printf("{\"eye\": ");
        print_vector_json(s->position);
        printf(", \"fov\": %.6g}, ", fov_of(s));
    } else {
        printf("null, ");
    }
}

static void print_scene_json(const loaded_scene *s, const scene_levels *levels, const live_chunks *live)
{
    const fxs_scene_file_info *info = s->opened->info;
    const fxs_pack_report *r = s->opened->report;
    printf("\"format\": \"%s\", \"gaussians\": %" PRIu64 ", \"packed\": %" PRIu64 ", \"sh_degree\": %d, "
           "\"levels\": %d, \"antialiased\": %s, ", info->format, r->read, r->packed, info->sh_degree,
           info->levels, info->antialiased ? "true" : "false");
    if (!is_packed(s))
        printf("\"left_out\": {\"not_finite\": %" PRIu64 ", \"zero_quaternion\": %" PRIu64 ", \"transparent\": %" PRIu64
               ", \"share\": %.3g}, \"brought_in\": %" PRIu64 ", ", r->dropped.not_finite, r->dropped.rotation,
               r->dropped.transparent, fxs_dropped_share(&r->dropped), r->brought_in);
    printf("\"bounds\": ");
    print_box_json(r->low, r->high);
    printf(", \"seen\": ");
    print_box_json(r->inner_low, r->inner_high);
    printf(", ");
    print_start_json(s);
    printf("\"profile\": \"%s\", ", profile_names[s->opened->scene->profile]);
    printf("\"packed_bytes\": %zu, \"bytes_per_gaussian\": %.3f, ", s->opened->bytes,
           (double)s->opened->bytes / (double)r->packed);
    if (!is_packed(s)) {
        print_error_json("largest_error", &r->largest);
        print_error_json("rms_error", &r->rms);
    }
    if (levels->count) {
        printf("\"tree\": ");
        levels_print_json(levels);
        printf(", ");
    }
    live_print_json(live);
    if (s->sound.data)
        printf("\"sound\": {\"type\": \"%s\", \"bytes\": %zu, \"volume\": %.6g}, ", s->sound.type, s->sound.bytes,
               s->sound.volume);
}

static void print_object_json(const world *w, uint32_t i)
{
    const fxs_placement *p = &w->placed.objects[i];
    double low[3], high[3];
    printf("%s{\"file\": ", i ? ", " : "");
    print_json_string(w->placed.files[p->file]);
    printf(", \"id\": %" PRIu32 ", \"visible\": %s, \"scale\": %.9g, \"bounds\": ", p->id,
           p->visible ? "true" : "false", p->scale);
    if (world_box(w, i, low, high)) {
        print_box_json(low, high);
        printf("}");
    } else {
        printf("null}");
    }
}

enum { STACK = 4096, CODE = 65536 };        /* bytes that firmware needs besides, as in docs/boards.md */

static const struct {
    const char *name;
    size_t flash, ram;                      /* bytes; flash that the processor reads directly */
} chips[] = {
    {"STM32F407", 1 << 20, 128 << 10}, {"STM32H743", 2 << 20, 512 << 10}, {"ESP32-S3, 8M", 8 << 20, 512 << 10},
    {"Pico 2", 4 << 20, 520 << 10},
};

enum { CHIPS = sizeof chips / sizeof *chips };

static const char *fit_of(const board *b, size_t scene_bytes, int chip)
{
    const size_t ram = chips[chip].ram, other = b->strip + STACK;
    return scene_bytes + CODE > chips[chip].flash ? "too large for its flash"
         : other + b->memory.least > ram          ? "too large for its RAM"
         : other + b->rows_most > ram             ? "fits, drawn in slices" : "fits, rows of tiles at once";
}

/* Returns the next panel from `p` on that the board may have, or null after the last. */
static const fxs_panel_type *panel_of(const board *b, const fxs_panel_type *p)
{
    for (; p < fxs_panel_types + FXS_PANELS; p++) {
        const int fits = (b->width <= p->width && b->height <= p->height) ||
                         (p->bits == 16 && b->width <= p->height && b->height <= p->width);
        if (b->panel ? b->panel == p : fits)
            return p;
    }
    return 0;
}

/* Bytes of RAM for a strip, and for panels of 1 bit its errors and pages. */
static size_t ram_of(const board *b, const fxs_panel_type *p)
{
    return b->strip + (p->bits == 1 ? (size_t)b->width * 4 : 0);
}

static double milliseconds_of(const board *b, const fxs_panel_type *p)
{
    return fxs_panel_frame_bits(p, b->width, b->height, 16) * (double)p->cycle / 1e6;
}

static void print_panels_json(const board *b, size_t scene_bytes)
{
    const char *comma = "";
    printf("\"panels\": [");
    for (const fxs_panel_type *p = panel_of(b, fxs_panel_types); p; p = panel_of(b, p + 1), comma = ", ")
        printf("%s{\"name\": \"%s\", \"ram\": %zu, \"bits\": %" PRIu32 ", \"milliseconds\": %.6g}", comma, p->name,
               ram_of(b, p), fxs_panel_frame_bits(p, b->width, b->height, 16), milliseconds_of(b, p));
    printf("], \"chips\": {");
    for (int i = 0; i < CHIPS; i++)
        printf("%s\"%s\": \"%s\"", i ? ", " : "", chips[i].name, fit_of(b, scene_bytes, i));
    printf("}");
}

static void print_panels_text(const board *b, size_t scene_bytes)
{
    for (const fxs_panel_type *p = panel_of(b, fxs_panel_types); p; p = panel_of(b, p + 1))
        printf("panel         %s: %zu bytes of RAM for strips; a frame is %" PRIu32 " bits, %.1f ms at %.1f MHz\n",
               p->name, ram_of(b, p), fxs_panel_frame_bits(p, b->width, b->height, 16), milliseconds_of(b, p),
               1e3 / p->cycle);
    for (int i = 0; i < CHIPS; i++)
        printf("%-13s %s\n", chips[i].name, fit_of(b, scene_bytes, i));
}

static void print_board_json(const board *b, size_t scene_bytes)
{
    printf("\"board\": {\"width\": %d, \"height\": %d, \"strip\": %zu, \"bytes\": %zu, \"least\": %zu, "
           "\"rows_least\": %zu, \"rows_most\": %zu, \"flash\": %zu, ", b->width, b->height, b->strip,
           b->memory.total, b->memory.least, b->rows, b->rows_most, scene_bytes);
    print_panels_json(b, scene_bytes);
    printf("}, ");
}

/* Computes how many projected Gaussians of a row of tiles fit into `limit` bytes. Each takes 88 bytes beyond the least
   memory. */
static size_t row_of_limit(const fxs_frame_memory *m, size_t limit)
{
    return (limit - m->least) / 88 / 16 * 16;
}

static void print_limit_json(const fxs_frame_memory *m, size_t limit)
{
    const int is_enough = limit >= m->least;
    printf("\"max_memory\": {\"bytes\": %zu, \"enough\": %s, \"slower_beyond\": ", limit, is_enough ? "true" : "false");
    if (is_enough && limit < m->total)
        printf("%zu}, ", row_of_limit(m, limit));
    else
        printf("null}, ");
}

/* Prints one scene in its original place as a JSON object, and several scenes as lists of scenes and of objects. */
static void print_json(const findings *f)
{
    const world *w = &f->world;
    const fxs_frame_memory *m = &f->memory;
    printf("{");
    if (is_one(w))
        print_scene_json(&w->scenes[0], &f->levels[0], &f->live[0]);
    for (uint32_t i = 0; i < w->placed.file_count && !is_one(w); i++) {
        printf(i ? ", {" : "\"scenes\": [{");
        print_scene_json(&w->scenes[i], &f->levels[i], &f->live[i]);
        printf("\"file\": ");
        print_json_string(w->placed.files[i]);
        printf("}");
    }
    for (uint32_t i = 0; i < w->count && !is_one(w); i++) {
        printf(i ? "" : "], \"objects\": [");
        print_object_json(w, i);
    }
    printf(is_one(w) ? "" : "], ");
    if (f->compared) {
        printf("\"compare\": ");
        quality_print_json(&f->quality);
        printf(", ");
    }
    if (f->has_stats) {
        printf("\"stats\": ");
        stats_print_json(&f->stats);
        printf(", ");
    }
    if (f->board.width)
        print_board_json(&f->board, w->scenes[0].opened->bytes);
    if (f->limit)
        print_limit_json(m, f->limit);
    printf("\"lod\": %d, \"frame\": {\"width\": %d, \"height\": %d, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, "
           "\"entries\": %zu, \"bytes\": %zu, \"least\": %zu}}\n", f->lod, f->width, f->height, m->splats, m->keys,
           m->tiles, m->entries, m->total, m->least);
}

static void print_error_text(const char *name, const fxs_pack_error *e)
{
    printf("%-13s position %.3g, ln(sigma) %.3g, rotation %.3g degrees, opacity %.3g, dc %.3g, sh %.3g\n", name,
           e->position, e->scale, e->rotation, e->opacity, e->dc, e->sh);
}

static void print_limit(const fxs_frame_memory *m, size_t limit)
{
    if (limit < m->least)
        printf("--max-memory  %zu bytes: too little for any view\n", limit);
    else if (limit >= m->total)
        printf("--max-memory  %zu bytes: enough for any view\n", limit);
    else
        printf("--max-memory  %zu bytes: enough for any view; slower where a row of tiles (16 pixels) has more than "
               "%zu Gaussians\n", limit, row_of_limit(m, limit));
}

static void print_start_text(const loaded_scene *scene)
{
    const fxs_start *s = &scene->opened->info->start;
    double found[3];
    const int is_found = look_for_up(scene, found);
    const double *up = is_found ? found : s->up;
    if (is_direction(up))
        printf("up            %.4f %.4f %.4f%s\n", up[0], up[1], up[2], is_found ? ", found in the scene" : "");
    if (s->tangent > 0) {
        printf("start view    from");
        print_place(s->position);
        printf(", %.1f degrees\n", fov_of(s));
    }
}

static void print_scene_text(const loaded_scene *s, const scene_levels *levels, const live_chunks *live)
{
    const fxs_pack_report *r = s->opened->report;
    printf("format        %s%s\n", s->opened->info->format, s->opened->info->antialiased ? ", anti-aliased" : "");
    printf("Gaussians     %" PRIu64 ", %" PRIu64 " of them drawable\n", r->read, r->packed);
    printf("SH degree     %d\n", s->opened->info->sh_degree);
    printf("profile       %s\n", profile_names[s->opened->scene->profile]);
    printf("bounds       ");
    print_box(r->low, r->high);
    printf("seen         ");
    print_box(r->inner_low, r->inner_high);
    print_start_text(s);
    printf("packed        %zu bytes, %.2f a Gaussian\n", s->opened->bytes,
           (double)s->opened->bytes / (double)r->packed);
    if (!is_packed(s)) {
        print_error_text("largest error", &r->largest);
        print_error_text("rms error", &r->rms);
    }
    live_print_text(live);
    if (s->sound.data)
        printf("sound         %s, %zu bytes; fixsplat publish keeps it\n", s->sound.type, s->sound.bytes);
    if (levels->count)
        levels_print_text(levels);
}

static void print_object_text(const world *w, uint32_t i)
{
    const fxs_placement *p = &w->placed.objects[i];
    double l[3], h[3];
    printf("object %-6" PRIu32 " %s, id %" PRIu32 "%s", i, w->placed.files[p->file], p->id,
           p->visible ? "" : ", not visible");
    if (world_box(w, i, l, h)) {
        putchar(':');
        print_box(l, h);
    } else {
        printf(": cropped away\n");
    }
}

static void print_board_text(const board *b, size_t scene_bytes)
{
    printf("board         %dx%d, one thread: %zu bytes of flash for the scene, %zu of RAM for a strip of 16 "
           "rows;\n              working memory: %zu at the least; from %zu to %zu on, by how it is turned, rows of "
           "tiles at once;\n              %zu for the whole frame at once\n", b->width, b->height, scene_bytes,
           b->strip, b->memory.least, b->rows, b->rows_most, b->memory.total);
    print_panels_text(b, scene_bytes);
}

static void print_text(const findings *f)
{
    const world *w = &f->world;
    const fxs_frame_memory *m = &f->memory;
    for (uint32_t i = 0; i < w->placed.file_count; i++) {
        if (!is_one(w))
            printf("file          %s\n", w->placed.files[i]);
        print_scene_text(&w->scenes[i], &f->levels[i], &f->live[i]);
        if (!is_one(w))
            puts("");
    }
    for (uint32_t i = 0; i < w->count && !is_one(w); i++)
        print_object_text(w, i);
    printf("frame         %dx%d needs %zu bytes: splats %zu, keys %zu, tiles %zu, entries %zu; in bands %zu or more\n",
           f->width, f->height, m->total, m->splats, m->keys, m->tiles, m->entries, m->least);
    if (f->board.width)
        print_board_text(&f->board, w->scenes[0].opened->bytes);
    if (f->limit)
        print_limit(m, f->limit);
    if (f->has_stats) {
        puts("");
        stats_print_text(&f->stats);
    }
    if (f->compared) {
        puts("");
        quality_print_text(&f->quality);
    }
}

static void print_backends(void)
{
    const fxs_backend *b;
    for (int i = 0; (b = fxs_backend_at(i)) != 0; i++) {
        char name[256];
        fxs_message why;
        int device = 0;
        for (; !b->device(device, name, sizeof name, &why); device++) {
            printf("%-13s here: %s", b->name, name);
            if (b->can & FXS_CAN_DEVICES)
                printf(", --device %d", device);
            printf(" (%s)\n", b->does);
        }
        if (!device)
            printf("%-13s not here: %s (%s)\n", b->name, why.text, b->does);
    }
}

static void print_can_json(unsigned can)
{
    static const char *const names[] = {"trace", "compose", "devices", "part"};
    for (unsigned i = 0; i < sizeof names / sizeof *names; i++)
        printf("%s\"%s\": %s", i ? ", " : "\"can\": {", names[i], can >> i & 1 ? "true" : "false");
    printf("}");
}

static void print_backend_json(const fxs_backend *b)
{
    char name[256];
    fxs_message why;
    int device = 0;
    printf("{\"name\": ");
    print_json_string(b->name);
    printf(", \"does\": ");
    print_json_string(b->does);
    printf(", \"devices\": [");
    for (; !b->device(device, name, sizeof name, &why); device++) {
        printf(device ? ", " : "");
        print_json_string(name);
    }
    printf("], \"here\": %s, \"why_not\": ", device ? "true" : "false");
    if (device)
        printf("null");
    else
        print_json_string(why.text);
    printf(", ");
    print_can_json(b->can);
    printf("}");
}

static void print_backends_json(void)
{
    const fxs_backend *b;
    for (int i = 0; (b = fxs_backend_at(i)) != 0; i++) {
        printf(i ? ",\n " : "[");
        print_backend_json(b);
    }
    puts("]");
}

static int take_board(const option_row *row, void *field, const char *value)
{
    info_options *o = field;
    o->panel = 0;
    for (int i = 0; i < FXS_PANELS; i++)
        if (!strcmp(value, fxs_panel_types[i].name)) {
            o->panel = &fxs_panel_types[i];
            o->board_width = o->panel->width;
            o->board_height = o->panel->height;
            return 0;
        }
    return parse_size(value, &o->board_width, &o->board_height) ? 0 : wrong_value(row, value);
}

static int take_distance(const option_row *row, void *field, const char *value)
{
    mesh_info_options *o = field;
    o->has_distance = parse_vector(value, 6, o->ends);
    return o->has_distance ? 0 : wrong_value(row, value);
}

#define OPTIONS info_options
#define PANELS "ili9341, st7789, st7789-240x240, st7735, gc9a01 or ssd1306"    /* all of fxs_panel_types */

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"compare", "ORIGINAL", TEXT(original), .basic = 1, .help =
     "draw SCENE and ORIGINAL, the scene that it was made from, and print PSNR and SSIM of each view, the worst, and "
     "the means (of PSNR without equal views). Scenes are drawn from floats; an .fxs, and SCENE with --profile, as "
     "packed. A line nudged reports views that change by a quarter of their loss or more when each Gaussian of "
     "ORIGINAL moves by 1e-6 of its distance, because coincident ones change order; no coding loses much less"},
    {"cameras", "FILE", TEXT(frame.cameras), .basic = 1, .help =
     "camera file to --compare from, with evenly spaced views (default: around the scene, in turn framed as by render, "
     "close, so that it exceeds the picture, and far)"},
    {"views", "N", INT(views, 1, 1000), .basic = 1, .help = "number of views to --compare, 1 to 1000 (default 8)"},
    {"compare-time", "SECONDS", TIME(frame.render.time_q32), .help =
     "moment at which scenes that move are compared (default: half of the duration of SCENE)"},
    {"cutoff", "NAME", CHOICE(frame.render.cutoff, cutoff_names), .help =
     "cut-off of the compared pictures: mahalanobis (default) or square"},
    {"compare-cutoff", "NAME", CHOICE(original_cutoff, cutoff_names), .help =
     "cut-off of ORIGINAL alone, to compare a scene with itself (default: as --cutoff)"},
    {"size", "WxH", take_frame_size, FIELD(frame_options, frame), .expected = SIZE_EXPECTED, .basic = 1, .help =
     "picture size, each 1 to 16384 pixels (default 1280x720; views of a camera file: their own size)"},
    {"board", "WxH", take_board, 0, .expected =
     "WxH, or " PANELS, .basic = 1, .help =
     "print the needs of a board with a display of this size, or with the panel " PANELS " (1 bit), that shows the "
     "scene on a turntable: flash, a strip of RGB565, and working memory for one thread at each of 16 turns: the "
     "minimum, and the size that avoids slicing rows of tiles; the time to send a frame to each panel, at the clock of "
     "its data sheet; and whether the scene fits into common chips"},
    {"stats", 0, FLAG(stats), .basic = 1, .help =
     "print minimum, median, mean, maximum and a histogram of each attribute, before packing. Position is in scene "
     "units, scale_0 to scale_2 are ln(sigma), opacity is 0 to 1, colour is SH degree 0, sh_1 to sh_3 are the root "
     "mean square of a degree's coefficients"},
    {"max-memory", "BYTES", BYTES(frame.max_memory), .basic = 1, .help =
     "print the effect of this --max-memory on render and bench, bytes, also as 64K, 3M, 2G"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .basic = 1, .help =
     "how a scene that is not an .fxs is packed: default, compact or small"},
    {"json", 0, FLAG(json), .basic = 1, .help =
     "print a JSON object. With --compare: a list of views with psnr, ssim and nudged_psnr, the means psnr and ssim, "
     "and worst_psnr, worst_ssim and worst_view. A PSNR is null for equal pictures"},
    {"distance", "X,Y,Z,X,Y,Z", take_distance, FIELD(mesh_info_options, mesh), .expected = "two points X,Y,Z,X,Y,Z",
     .help =
     "of a mesh: also print the straight distance between two points, and the distance along the surface. Each point "
     "is moved to the nearest point of the mesh"},
    {"output", "OUT.obj", OUTPUT(mesh.output), .letter = 'o', .help =
     "with --distance: write the way along the surface as a line"},
    {"backends", 0, FLAG(backends), .basic = 1, .help =
     "print which back ends run on this machine, and why others cannot. With --json: an array of objects with name, "
     "does, devices, here, why_not (null if here) and can: trace (depths, ids), compose (meshes, coverage), devices "
     "(several), part (scenes partly in memory)"},
    {0}
};

static const option_rule rules[] = {
    {"output", 0, "distance", 0},
    {"cameras views compare-time cutoff compare-cutoff budget detail", 0, "compare", 0},
    {0}
};

static int read_options(info_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->frame.load.sound = SOUND_KEPT;
    if (take_options(&command_info, o, argc, argv))
        return EXIT_USAGE;
    const char *other = o->backends ? given_beside("backends json quiet") : 0;
    if (other || (o->backends && optind < argc))
        return fail(EXIT_USAGE, "--backends is about this machine: leave out %s%s", other ? "--" : "",
                    other ? other : argv[optind]);
    if (o->backends) {
        (o->json ? print_backends_json : print_backends)();
        exit(EXIT_OK);
    }
    if (take_scenes(&o->frame.world, "info", argc - optind, argv + optind))
        return EXIT_USAGE;
    return check_rules(rules);
}

/* True if the command line names one file, and that is a mesh. */
static int is_mesh(const info_options *o)
{
    const world_options *w = &o->frame.world;
    return w->scene_count == 1 && !w->file && !w->place_count && fxs_mesh_is_file(w->scenes[0]);
}

static int print_mesh(info_options *o)
{
    const char *path = o->frame.world.scenes[0], *other = given_beside("distance output json quiet import-memory");
    if (other)
        return fail(EXIT_USAGE, "%s is a mesh: leave out --%s", path, other);
    files_read(path);
    files_write(o->mesh.output);
    o->mesh.json = o->json;
    o->mesh.max_memory = o->frame.load.import_memory;
    const int status = files_check();
    return status ? status : print_mesh_info(path, &o->mesh);
}

static int compare(findings *f, const info_options *o)
{
    fxs_world original;
    load_options load = o->frame.load;
    const load_options plain = {.rate = load.rate, .max_gaussians = load.max_gaussians,
                                .import_memory = load.import_memory};
    const float_files files = {&f->world.placed, f->world.placed.files[0], &load};
    const int is_as_packed = is_packed(&f->world.scenes[0]) || is_given("profile");
    if (f->world.count > 1)
        return fail(EXIT_USAGE, "--compare takes one scene");
    int status = place_scenes(&original, &(world_options){.scenes = (char **)&o->original, .scene_count = 1});
    if (status)
        return status;
    load.again = 1;
    status = quality_measure(&f->quality, &f->world, is_as_packed ? 0 : &files,
                             &(float_files){&original, o->original, &plain},
                             is_given("compare-cutoff") ? o->original_cutoff : o->frame.render.cutoff, &o->frame,
                             &(quality_options){o->views ? o->views : 8, NUDGE_BELOW, .has_ssim = 1});
    f->compared = !status;
    fxs_world_free(&original);
    return status;
}

/* Aborts a frame as soon as its memory is planned, before pixels are drawn. */
static int enough(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    (void)argument, (void)strip, (void)first, (void)rows;
    return FXS_ERR_UNSUPPORTED;
}

/* Plans the memory of 16 frames, with the camera turning around the scene. */
static int measure_turns(board *b, fxs_turntable *t, unsigned char *rows, void *memory)
{
    fxs_context context;
    fxs_request request;
    fxs_strip strip = {rows, 2 * b->width, 16, FXS_FORMAT_RGB565, enough, 0, {0}};
    fxs_context_init(&context, &(fxs_config){.size = sizeof(fxs_config), .draw = fxs_strip_draw,
                                             .draw_argument = &strip, .draw_blended = 1});
    fxs_request_init(&request, &t->object, 1);
    for (uint32_t turn = 0; turn < 16; turn++) {
        fxs_stats stats;
        fxs_turntable_turn(t, turn * FXS_TURNTABLE_STEPS / 16);
        request.cameras[0] = t->camera;
        const int error = fxs_render(&context, &request, memory, b->memory.least, &stats);
        if (error != FXS_ERR_UNSUPPORTED)
            return fail(EXIT_FAILED, "%s", fxs_strerror(error));
        const size_t from = stats.memory.rows > b->memory.least ? stats.memory.rows : b->memory.least;
        b->rows = from < b->rows ? from : b->rows;
        b->rows_most = from > b->rows_most ? from : b->rows_most;
    }
    return 0;
}

static int measure_board(findings *f, const fxs_panel_type *panel, int width, int height)
{
    fxs_context context;
    fxs_turntable t;
    board *b = &f->board;
    const loaded_scene *s = &f->world.scenes[0];
    if (!is_one(&f->world))
        return fail(EXIT_USAGE, "--board takes one scene");
    const int error = fxs_turntable_open(&t, s->opened->data, s->opened->bytes, width, height);
    if (error)
        return fail(EXIT_FAILED, "%s: %s", s->path, fxs_strerror(error));
    fxs_context_init(&context, 0);
    *b = (board){.panel = panel, .width = width, .height = height, .strip = (size_t)width * 16 * 2, .rows = SIZE_MAX};
    fxs_frame_bytes(&context, &t.object, 1, width, height, &b->memory);
    void *memory = malloc(b->memory.least + 63), *rows = malloc(b->strip);
    const int status = memory && rows ? measure_turns(b, &t, rows, (void *)(((uintptr_t)memory + 63) / 64 * 64))
                                      : fail(EXIT_FAILED, "%s", fxs_strerror(FXS_ERR_MEMORY));
    free(memory);
    free(rows);
    return status;
}

static int find_levels(findings *f)
{
    int status = 0;
    f->levels = calloc(f->world.placed.file_count, sizeof *f->levels);
    f->live = calloc(f->world.placed.file_count, sizeof *f->live);
    if (!f->levels || !f->live)
        return fail(EXIT_FAILED, "out of memory");
    for (uint32_t i = 0; i < f->world.placed.file_count && !status; i++)
        status = levels_measure(&f->levels[i], f->world.scenes[i].opened->scene) ||
                 live_measure(&f->live[i], f->world.scenes[i].opened->scene) ? EXIT_FAILED : 0;
    return status;
}

static int check_files(const world *w)
{
    fxs_message message;
    for (uint32_t i = 0; i < w->placed.file_count; i++) {
        const loaded_scene *s = &w->scenes[i];
        if (is_packed(s) && fxs_file_check(s->path, s->opened->data, s->opened->bytes, 1, &message))
            return fail_for(&message);
    }
    return 0;
}

static int find_stats(findings *f, const info_options *o)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    load_options load = o->frame.load;
    const fxs_world *placed = &f->world.placed;
    load.again = 1;
    if (open_merged(placed, placed->files[0], &load, &file, &info))
        return EXIT_FAILED;
    f->has_stats = !stats_measure(&f->stats, file, &info, &message);
    fxs_scene_file_close(file);
    return f->has_stats ? 0 : fail_for(&message);
}

static int find(findings *f, const info_options *o)
{
    fxs_context context;
    if (check_files(&f->world) || find_levels(f) || (o->stats && find_stats(f, o)))
        return EXIT_FAILED;
    f->width = o->frame.width ? o->frame.width : 1280;
    f->height = o->frame.height ? o->frame.height : 720;
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                               .workers.count = fxs_processors()};  /* used to compute memory sizes only, not to draw */
    f->limit = o->frame.max_memory;
    f->lod = o->frame.load.lod;
    fxs_context_init(&context, &config);
    fxs_frame_bytes(&context, f->world.objects, f->world.count, f->width, f->height, &f->memory);
    const int status = o->board_width ? measure_board(f, o->panel, o->board_width, o->board_height) : 0;
    return status || !o->original ? status : compare(f, o);
}

static int run(int argc, char **argv)
{
    static info_options o;
    findings f = {.compared = 0};
    int status = read_options(&o, argc, argv);
    if (!status && is_mesh(&o))
        return print_mesh(&o);
    if (!status && o.mesh.has_distance)
        return fail(EXIT_USAGE, "--distance is for a mesh: make one with fixsplat mesh");
    if (!status && !(status = world_open(&f.world, &o.frame.world, &o.frame.load))) {
        status = find(&f, &o);
        if (!status)
            (o.json ? print_json : print_text)(&f);
        if (f.compared)
            quality_free(&f.quality);
        free(f.levels);
        free(f.live);
        world_close(&f.world);
    }
    return status;
}

const command command_info = {
    "info", "prints contents and memory needs of a scene, or the size of a mesh", run,
    "Usage: fixsplat info SCENE... [OPTION...]\n"
    "  or:  fixsplat info MESH [--distance X,Y,Z,X,Y,Z [-o OUT.obj]] [--json]\n"
    "  or:  fixsplat info --backends [--json]\n\n"
    "Prints the number of Gaussians, SH degree and bounds of a scene, its packed size in bytes per Gaussian, the\n"
    "largest change of each attribute by packing (for an .fxs, every checksum is verified instead), and the memory of\n"
    "a frame: enough for any view, and the minimum. Several or placed scenes: also the objects and their boxes in the\n"
    "world.\n\n"
    "A scene that moves: its duration, the Gaussians of the chunks (256 Gaussians) that are drawn at a time, and the\n"
    "bytes of those that begin to be drawn in a second.\n\n"
    "An .fxs with levels of detail: a line per level. A level holds the nodes with at most this many leaves, and more\n"
    "than the next line's. Then follow their Gaussians and bytes, the squared error (colours^2 units^2) that their\n"
    "children remove, and the geometric mean size of the detail that they lack, in scene units.\n\n"
    "A mesh (.glb, .gltf, .ply or .obj with triangles): triangles, vertices, connected parts, bounds, area, and the\n"
    "volume if the mesh is closed, in the units of the file.\n",
    0,
    "  $ fixsplat info scene.ply\n"
    "  $ fixsplat info scene.ply --size 1920x1080 --json\n"
    "  $ fixsplat info room.fxs chair.spz --place chair.spz:1,0,2\n"
    "  $ fixsplat info scene.ply --stats\n"
    "  $ fixsplat info toy.fxs --board 320x240\n"
    "  $ fixsplat info toy.fxs --board ssd1306\n"
    "  $ fixsplat info scene.spz --compare scene.ply --cameras cameras.json --views 4\n"
    "  $ fixsplat info scene.ply --compare scene.ply --cutoff square --compare-cutoff mahalanobis\n"
    "  $ fixsplat info scene.fxs --compare scene.ply --budget 200000\n"
    "  $ fixsplat info toy.glb\n"
    "  $ fixsplat info toy.glb --distance 0,1,0,0.4,0,0.3 -o way.obj\n"
    "  $ fixsplat info dance.fxs --compare dance.splatv --compare-time 0.8\n",
    {{own_rows, 0}, {level_rows, offsetof(info_options, frame)}, {world_rows, offsetof(info_options, frame.world)},
     {load_rows, offsetof(info_options, frame.load)}, COMMON_TABLE}
};
