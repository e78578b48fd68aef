/* Tests the viewer: camera motion, the overlay, and the window. SDL runs on its driver without a screen and gets
   events from the test. */
#include <fixsplat/camera.h>
#include "port/window/motion.h"
#include "port/window/words.h"
#include "src/base/os_calls.h"
#include "check.h"

#include <libgen.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const double up[3] = {0, -1, 0};

static fxs_view a_view(void)
{
    const double eye[3] = {1, -2, -6}, target[3] = {0.5, 0, 1};
    fxs_view view;
    fxs_message message;
    fxs_view_look_at(&view, eye, target, up, &(fxs_picture){50, 640, 480}, &message);
    return view;
}

/* Projects a point to pixel coordinates. Returns its depth. */
static double see(const fxs_view *view, const double point[3], double pixel[2])
{
    double seen[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            seen[i] += view->rotation[3 * i + j] * (point[j] - view->position[j]);
    pixel[0] = view->cx + view->fx * seen[0] / seen[2];
    pixel[1] = view->cy + view->fy * seen[1] / seen[2];
    return seen[2];
}

static void ahead(const fxs_view *view, double distance, double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = view->position[i] + distance * view->rotation[6 + i];
}

static int near(double a, double b)
{
    return fabs(a - b) < 1e-9;
}

static void test_orbit_keeps_the_pivot(void)
{
    fxs_view view = a_view();
    double pivot[3], front[3], pixel[2];
    ahead(&view, 7, pivot);
    ahead(&view, 5, front);
    fxs_motion_orbit(&view, 7, up, 0.3, 0.2);
    CHECK(near(see(&view, pivot, pixel), 7));
    CHECK(near(pixel[0], view.cx) && near(pixel[1], view.cy));
    see(&view, front, pixel);
    /* the picture of a point in front moves right and down, as the pointer does */
    CHECK(pixel[0] > view.cx + 10 && pixel[1] > view.cy + 10);
}

static void test_orbit_stops_at_the_poles(void)
{
    for (int down = -1; down <= 1; down += 2) {
        fxs_view view = a_view();
        for (int i = 0; i < 100; i++)
            fxs_motion_orbit(&view, 7, up, 0.05, 0.1 * down);
        /* the camera looks up or down almost vertically */
        CHECK(view.rotation[7] * down > 0.999 && fabs(view.rotation[7]) < 1 - 1e-4);
        CHECK(near(view.rotation[1], 0));
    }
}

static void test_poles_let_go(void)
{
    const double eye[3] = {0, -5, 0}, target[3] = {0, 0, 0}, back[3] = {0, 0, 1};
    fxs_view view;
    fxs_message message;
    CHECK(!fxs_view_look_at(&view, eye, target, back, &(fxs_picture){50, 640, 480}, &message));
    fxs_motion_orbit(&view, 5, up, 0, -0.5);
    CHECK(view.rotation[7] < 0.9 && near(view.position[1], -5 * view.rotation[7]));
}

static void test_look_turns_in_place(void)
{
    fxs_view view = a_view();
    const fxs_view before = view;
    double point[3], pixel[2];
    ahead(&view, 7, point);
    fxs_motion_look(&view, up, 10 / view.fx, 5 / view.fy);
    see(&view, point, pixel);
    CHECK(!memcmp(view.position, before.position, sizeof view.position));
    CHECK(fabs(pixel[0] - view.cx + 10) < 1 && fabs(pixel[1] - view.cy + 5) < 1);
}

static void test_pan_follows_the_pointer(void)
{
    fxs_view view = a_view();
    double pivot[3], pixel[2];
    ahead(&view, 7, pivot);
    fxs_motion_pan(&view, 7, 31, -17);
    CHECK(near(see(&view, pivot, pixel), 7));
    CHECK(near(pixel[0], view.cx + 31) && near(pixel[1], view.cy - 17));
}

static void test_zoom_keeps_the_pivot(void)
{
    fxs_view view = a_view();
    double pivot[3], pixel[2], distance = 7;
    ahead(&view, distance, pivot);
    fxs_motion_zoom(&view, &distance, 0.25);
    CHECK(near(distance, 1.75) && near(see(&view, pivot, pixel), 1.75));
    CHECK(near(pixel[0], view.cx) && near(pixel[1], view.cy));
}

static void test_parallel_rays(void)
{
    fxs_view view = a_view(), before;
    double distance = 4;
    view.projection = FXS_ORTHOGRAPHIC;
    view.fx = view.fy = 100;
    before = view;
    fxs_motion_pan(&view, distance, 50, 0);   /* panning by 50 pixels moves the camera by half a unit */
    for (int i = 0; i < 3; i++)
        CHECK(near(view.position[i], before.position[i] - 0.5 * view.rotation[i]));
    before = view;
    fxs_motion_zoom(&view, &distance, 0.5);
    CHECK(near(view.fx, 200) && near(view.fy, 200) && distance == 4);
    CHECK(!memcmp(view.position, before.position, sizeof view.position));
}

static void test_height_stays(void)
{
    fxs_view view = a_view();
    const double top = view.cy / view.fy, bottom = (view.height - view.cy) / view.fy;
    fxs_motion_fit(&view, 1234, 321);
    CHECK(view.width == 1234 && view.height == 321 && near(view.fx, view.fy) && near(view.cx, 617));
    CHECK(near(view.cy / view.fy, top) && near((view.height - view.cy) / view.fy, bottom));
}

static void test_fly_along_the_axes(void)
{
    fxs_view view = a_view();
    double centre[3] = {view.position[0], view.position[1], view.position[2]}, pixel[2];
    fxs_motion_fly(&view, 1, 2, -4);
    CHECK(near(see(&view, centre, pixel), 4));
    CHECK(near(pixel[0], view.cx - view.fx / 4) && near(pixel[1], view.cy - view.fy / 2));
}

static void test_rotations_stay_rotations(void)
{
    fxs_view view = a_view();
    for (int i = 0; i < 100000; i++) {
        fxs_motion_orbit(&view, 3, up, 0.01 * (i % 7), 0.01 * (i % 11 - 5));
        fxs_motion_look(&view, up, -0.01 * (i % 5), 0.01 * (i % 3 - 1));
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double *a = view.rotation + 3 * i, *b = view.rotation + 3 * j;
            CHECK(near(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], i == j));
        }
}

static uint8_t dots[FXS_GRAPH_WIDTH * 200 * 4];

static fxs_canvas blank(int width, int height)
{
    memset(dots, 0, sizeof dots);
    return (fxs_canvas){dots, width, height};
}

static int pixels_of(const fxs_canvas *picture, uint32_t colour)
{
    const uint8_t rgba[4] = {(uint8_t)(colour >> 24), (uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour};
    int found = 0;
    for (int i = 0; i < picture->width * picture->height; i++)
        found += !memcmp(picture->rgba + 4 * i, rgba, 4);
    return found;
}

static void test_rectangles_are_clipped(void)
{
    fxs_canvas picture = blank(20, 10);
    fxs_draw_rectangle(&picture, -3, -4, 5, 6, 0x102030ff);
    CHECK(pixels_of(&picture, 0x102030ff) == 2 * 2);
    fxs_draw_rectangle(&picture, 18, 7, 100, 100, 0x405060ff);
    CHECK(pixels_of(&picture, 0x405060ff) == 2 * 3);
    fxs_draw_rectangle(&picture, 30, 30, 5, 5, 0x708090ff);
    fxs_draw_rectangle(&picture, 5, 5, 0, 5, 0x708090ff);
    CHECK(pixels_of(&picture, 0x708090ff) == 0);
    CHECK(pixels_of(&picture, 0) == 200 - 4 - 6);
    CHECK(dots[200 * 4] == 0);
}

static void test_lines(void)
{
    fxs_canvas picture = blank(40, 40);
    fxs_draw_line(&picture, (double[2]){5, 10}, (double[2]){25, 10}, 2, 0xff0000ff);
    CHECK(pixels_of(&picture, 0xff0000ff) == 22 * 2);
    fxs_draw_line(&picture, (double[2]){-1e3, -1e3}, (double[2]){1e3, 1e3}, 1, 0x00ff00ff);
    CHECK(pixels_of(&picture, 0x00ff00ff) >= 40 && dots[4 * (39 * 40 + 39) + 1] == 255);
}

static void test_panels_have_round_corners(void)
{
    fxs_panel panel;
    if (!CHECK(!fxs_panel_make(&panel, 3, 4, 40, 20, 8, 0x102030c0)))
        return;
    const uint8_t *rgba = panel.picture.rgba;
    CHECK(panel.x == 3 && panel.y == 4 && rgba[3] == 0 && rgba[4 * 39 + 3] == 0 && rgba[4 * (19 * 40) + 3] == 0);
    CHECK(rgba[4 * 20 + 3] == 0xc0 && rgba[4 * (10 * 40) + 3] == 0xc0 && rgba[4 * (10 * 40 + 20)] == 0x10);
    fxs_panel_free(&panel);
}

static int differ(const fxs_canvas *picture, int a, int b)
{
    return memcmp(picture->rgba + 4 * a, picture->rgba + 4 * b, 4) != 0;
}

static void test_depths_have_colours(void)
{
    uint32_t depths[400];
    fxs_canvas picture = blank(20, 20);
    for (uint32_t i = 0; i < 400; i++)
        depths[i] = 65536 + 1000 * i;
    depths[7] = FXS_NOTHING;
    fxs_paint_depths(&picture, depths);
    /* the colours for depths go from red to blue */
    CHECK(dots[0] > dots[2] + 100 && dots[4 * 399] + 50 < dots[4 * 399 + 2]);
    CHECK(differ(&picture, 150, 200) && !differ(&picture, 0, 1) && !dots[4 * 7] && dots[4 * 7 + 3] == 255);
    for (int i = 0; i < 400; i++)
        depths[i] = FXS_NOTHING;
    fxs_paint_depths(&picture, depths);
    CHECK(pixels_of(&picture, 0x000000ff) == 400);
}

static void test_ids_have_colours(void)
{
    fxs_id ids[400];
    fxs_canvas picture = blank(20, 20);
    for (uint32_t i = 0; i < 400; i++)
        ids[i] = (fxs_id){i % 4 == 3, i / 2};
    ids[399] = (fxs_id){FXS_NOTHING, FXS_NOTHING};
    fxs_paint_ids(&picture, ids);
    CHECK(!differ(&picture, 0, 1) && differ(&picture, 0, 4) && differ(&picture, 2, 3));
    CHECK(pixels_of(&picture, 0x000000ff) == 1);
}

static void test_words(void)
{
    fxs_words *words;
    fxs_message message;
    if (fxs_words_open(&words, &message)) {
        CHECK(!words && !fxs_words_width(words, "a") && strstr(message.text, "no words in the window"));
        fxs_draw_words(words, &(fxs_canvas){dots, 4, 4}, 0, 0, "a", 0xffffffff);
        printf("  words are left out: %s\n", message.text);
        check_skipped++;
        return;
    }
    const int narrow = fxs_words_width(words, "iiii"), wide = fxs_words_width(words, "WWWW");
    CHECK(narrow > 0 && wide > 2 * narrow && fxs_words_line(words) > 10);
    for (int light = 0; light < 2; light++) {
        const fxs_theme *theme = light ? &fxs_light : &fxs_dark;
        fxs_canvas picture = blank(200, 40);
        fxs_draw_rectangle(&picture, 0, 0, 200, 40, theme->panel);
        fxs_draw_words(words, &picture, 10, 5, "Hello", theme->words);
        int first = 200, last = 0;
        for (int i = 0; i < 200 * 40; i++)
            if (abs(dots[4 * i] - (int)(theme->panel >> 24)) > 180) {
                first = i % 200 < first ? i % 200 : first;
                last = i % 200 > last ? i % 200 : last;
            }
        CHECK(first >= 10 && first < 14 && last > 30 && last <= 10 + fxs_words_width(words, "Hello"));
        CHECK(dots[3] == (theme->panel & 255));
    }
    fxs_words_resize(words, 40);
    CHECK(fxs_words_width(words, "WWWW") > 2 * wide);
    fxs_draw_words(words, &(fxs_canvas){dots, 200, 40}, 190, 35, "cut at the edge", 0xffffffff);
    fxs_draw_words(words, &(fxs_canvas){dots, 200, 40}, -20, -20, "cut at the edge", 0xffffffff);
    fxs_words_close(words);
}

static int column_of(const fxs_canvas *picture, int x, uint32_t colour)
{
    int found = 0;
    for (int y = 0; y < picture->height; y++) {
        const fxs_canvas pixel = {picture->rgba + 4 * (y * picture->width + x), 1, 1};
        found += pixels_of(&pixel, colour);
    }
    return found;
}

static void test_graph_shows_the_times(void)
{
    static fxs_frame_times times;
    fxs_canvas picture = blank(FXS_GRAPH_WIDTH, FXS_GRAPH_HEIGHT);
    fxs_stats stats = {0};
    stats.nanoseconds[FXS_BLEND] = 8000000;
    stats.nanoseconds[FXS_SORT] = 7000000;
    stats.frame_nanoseconds = 15000000;
    fxs_frame_times_add(&times, &stats);
    fxs_frame_times_add(&times, &(fxs_stats){.nanoseconds = {[FXS_PROJECT] = 5000000}});
    CHECK(near(times.stage[0][FXS_PROJECT], 5) && near(times.stage[1][FXS_BLEND], 8) && near(times.frame, 0));
    fxs_draw_frame_times(&picture, &times, 1, &fxs_dark, 0);
    int right = 8 + 2 * FXS_GRAPH_FRAMES - 1;
    CHECK(column_of(&picture, right, 0x4f8ff0ff) == 28);
    CHECK(column_of(&picture, right - 2, 0xf0705aff) + column_of(&picture, right - 2, 0xb07ee8ff) == 84);
    CHECK(abs(column_of(&picture, right - 2, 0xf0705aff) - 45) <= 1);
    CHECK(column_of(&picture, right - 4, 0xf0705aff) == 0);
}

#ifdef FXS_WITH_SDL
#include <SDL2/SDL.h>

#include <fixsplat/image.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include "tools/command/cmd_view.h"
#include "tools/view/viewer.h"

/* Simulates a screen with several pixels for each unit of window coordinates. */
static int pixels_a_point = 1;

void SDL_GetWindowSizeInPixels(SDL_Window *window, int *width, int *height)
{
    SDL_GetWindowSize(window, width, height);
    *width *= pixels_a_point;
    *height *= pixels_a_point;
}

/* Name of the environment variable for the folder that has the list of recent scenes. */
#ifdef _WIN32
#define KEPT_BELOW "APPDATA"
#else
#define KEPT_BELOW "XDG_STATE_HOME"
#endif

static char folder[40] = "/tmp/fixsplat-window-XXXXXX", state[80];
static char knot[64], cubes[64], junk[64], cameras[64], shot[64], other[64];

static void make_scene(char *path, const char *file, const char *name, char *count)
{
    snprintf(path, sizeof knot, "%s/%s.ply", folder, file);
    char *arguments[] = {"make-scene", (char *)name, "-o", path, "--count", count, 0};
    optind = 1;
    CHECK(command_make_scene.run(6, arguments) == EXIT_OK);
}

static void write_text(char *path, const char *name, const char *text)
{
    snprintf(path, sizeof knot, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (CHECK(file)) {
        fputs(text, file);
        fclose(file);
    }
}

static long give(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_gaussian *all = argument;
    memcpy(out, all + first, capacity * sizeof *out);
    return (long)capacity;
}

static int give_motions(void *argument, uint64_t first, fxs_motion *out, size_t count)
{
    (void)argument;
    for (size_t i = 0; i < count; i++)
        out[i] = (fxs_motion){.drift = {{1, 0, 0}}, .centre = (float)(first + i) / 300, .fade = 0.3f,
                              .from = -INFINITY, .to = INFINITY};
    return 0;
}

/* Writes a scene of 300 Gaussians that move for a second, with 20 frames a second. */
static void make_moving(char *path, int loops)
{
    static fxs_gaussian all[300];
    const fxs_gaussian_source gaussians = {300, 0, 0, give, all, {0}};
    fxs_motion_source motions;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_message message;
    fxs_motion_source_init(&motions);
    motions.read = give_motions;
    motions.time = (fxs_time){.duration = 1, .rate = 20, .loops = loops, .degree = 1, .fades = 1};
    for (int i = 0; i < 300; i++)
        all[i] = (fxs_gaussian){.position = {(float)(i % 20) / 10 - 1, (float)(i / 20) / 7 - 1, 0},
                                .scale = {-2.5f, -2.5f, -2.5f}, .rotation = {1, 0, 0, 0}, .opacity = 3,
                                .dc = {(float)(i % 7) / 4, (float)(i % 5) / 3, 1}};
    snprintf(path, sizeof knot, "%s/moving.fxs", folder);
    int error = fxs_scene_file_open_moving("moving", &gaussians, &motions, 0, &file, &info, &message);
    error = error ? error : fxs_pack(file, &info, &packed, &report, 0, &message);
    fxs_scene_file_close(file);
    error = error ? error : fxs_file_write(path, packed.data, packed.bytes, &message);
    if (!CHECK(!error))
        printf("  %s\n", message.text);
    fxs_packed_scene_free(&packed);
}

static frame_options small_options(void)
{
    frame_options options;
    frame_options_default(&options);
    options.threads = 1;
    options.width = 64;
    options.height = 48;
    return options;
}

/* Returns viewer options that state which way is up. The scene's box is then seen from the front, with its x
   axis to the right. */
static frame_options framed_options(void)
{
    frame_options options = small_options();
    options.up.given = 1;
    return options;
}

static int open_file(viewer *v, const frame_options *options, const char *path, const char *screenshot)
{
    static char *scene;
    frame_options all = *options;
    scene = (char *)path;
    all.world = (world_options){.scenes = &scene, .scene_count = 1};
    return viewer_open(v, &all, screenshot, 0);
}

/* Runs steps of the viewer until all requested work is done. */
static void settle(viewer *v)
{
    do
        viewer_step(v, 10);
    while (viewer_busy(v) && !v->quit);
}

static void rest(viewer *v)
{
    do
        viewer_step(v, -1);
    while ((v->coarse || viewer_busy(v)) && !v->quit);
}

static int start(viewer *v, const frame_options *options)
{
    int status = open_file(v, options, knot, shot);
    if (CHECK(!status))
        settle(v);
    return status;
}

static void push_key(int symbol)
{
    SDL_Event event = {0};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = symbol;
    SDL_PushEvent(&event);
}

static void key(viewer *v, int symbol)
{
    push_key(symbol);
    settle(v);
}

static void drag(viewer *v, Uint32 buttons, int dx, int dy)
{
    SDL_Event event = {0};
    event.type = SDL_MOUSEMOTION;
    event.motion.state = buttons;
    event.motion.xrel = dx;
    event.motion.yrel = dy;
    SDL_PushEvent(&event);
    settle(v);
}

static void move_to(viewer *v, Uint32 buttons, int x, int y)
{
    SDL_Event event = {0};
    event.type = SDL_MOUSEMOTION;
    event.motion.state = buttons;
    event.motion.x = x;
    event.motion.y = y;
    event.motion.xrel = 4;
    SDL_PushEvent(&event);
    settle(v);
}

static void push_button(Uint32 type, Uint8 count, int x, int y)
{
    SDL_Event event = {0};
    event.type = type;
    event.button.button = SDL_BUTTON_LEFT;
    event.button.clicks = count;
    event.button.x = x;
    event.button.y = y;
    SDL_PushEvent(&event);
}

static void click(viewer *v, Uint8 count, int x, int y)
{
    push_button(SDL_MOUSEBUTTONDOWN, count, x, y);
    push_button(SDL_MOUSEBUTTONUP, count, x, y);
    settle(v);
}

static void wheel(viewer *v, float steps)
{
    SDL_Event event = {0};
    event.type = SDL_MOUSEWHEEL;
    event.wheel.preciseY = steps;
    SDL_PushEvent(&event);
    settle(v);
}

static void push_drop(const char *path)
{
    SDL_Event event = {0};
    event.type = SDL_DROPFILE;
    event.drop.file = SDL_strdup(path);
    SDL_PushEvent(&event);
}

static void drop(viewer *v, const char *path)
{
    push_drop(path);
    settle(v);
}

/* True if the viewer's picture equals the renderer's picture of the view. */
static int shows(const viewer *v, fxs_view view, int width, int height)
{
    renderer r;
    picture expected = {.pixels = 0};
    const fxs_options *options = &v->options.render;
    if (view.width != width || view.height != height)
        fxs_motion_fit(&view, width, height);
    int same = !renderer_open(&r, &v->options) && !renderer_render(&r, &v->world, &view, options, &expected, 0) &&
               expected.width == v->picture.width && expected.height == v->picture.height &&
               !memcmp(expected.pixels, v->picture.pixels, (size_t)expected.width * (size_t)height * 4);
    renderer_close(&r);
    picture_free(&expected);
    return same;
}

static void test_keys(void)
{
    viewer v;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    CHECK(shows(&v, v.views[0], 64, 48));
    key(&v, 'x');
    CHECK(v.options.render.cutoff == FXS_CUTOFF_SQUARE && shows(&v, v.views[0], 64, 48));
    key(&v, '0');
    key(&v, '0');
    CHECK(v.options.render.sh_degree == 1 && shows(&v, v.views[0], 64, 48));
    key(&v, 'g');
    key(&v, 'h');
    key(&v, 'f');
    key(&v, 't');
    CHECK(v.graph && v.help && v.rate && v.light && shows(&v, v.views[0], 64, 48));
    key(&v, 'v');
    CHECK(v.divisor == 4);
    for (int i = 0; fxs_backend_at(i) && (i == 0 || strcmp(v.options.backend, "cpu")); i++) {
        key(&v, 'b');
        CHECK(shows(&v, v.views[0], 64, 48));
    }
    CHECK(!strcmp(v.options.backend, "cpu"));
    double speed = v.speed;
    key(&v, '+');
    CHECK(v.speed > speed && strstr(v.note, "units a second"));
    key(&v, 'y');
    CHECK(strstr(v.note, "units a second"));
    CHECK(!v.quit);
    key(&v, SDLK_ESCAPE);
    CHECK(v.quit);
    viewer_close(&v);
}

static void test_motion_is_coarse_then_full(void)
{
    viewer v;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    double distance = v.distance;
    wheel(&v, 2);
    CHECK(v.coarse && shows(&v, v.view, 32, 24) && near(v.distance, 0.81 * distance));
    rest(&v);
    CHECK(!v.coarse && shows(&v, v.view, 64, 48));
    drag(&v, SDL_BUTTON_LMASK, 9, 4);
    CHECK(v.coarse && memcmp(v.view.rotation, v.views[0].rotation, sizeof v.view.rotation));
    drag(&v, 0, 9, 4);
    rest(&v);
    CHECK(!v.coarse && shows(&v, v.view, 64, 48));
    fxs_view turned = v.view;
    drag(&v, SDL_BUTTON_RMASK, 9, 4);
    CHECK(!memcmp(v.view.rotation, turned.rotation, sizeof turned.rotation));
    CHECK(v.view.position[0] != turned.position[0]);
    key(&v, 'r');
    CHECK(!memcmp(&v.view.position, &v.views[0].position, sizeof v.view.position) && shows(&v, v.views[0], 64, 48));
    viewer_close(&v);
}

static void test_zoom_stays_in_range(void)
{
    viewer v;
    fxs_camera camera;
    fxs_message message;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    for (int i = 0; i < 20; i++) {
        wheel(&v, -40);
        CHECK(!fxs_camera_from_view(&camera, &v.view, &message));
    }
    CHECK(v.distance > 1e6);
    for (int i = 0; i < 20; i++)
        wheel(&v, 40);
    CHECK(v.distance < 1e-2 && v.distance > 0);
    viewer_close(&v);
}

static int frames_taken(const viewer *v)
{
    int count = 0;
    while (count < FXS_GRAPH_FRAMES && v->times.stage[count][FXS_BLEND] > 0)
        count++;
    return count;
}

/* Tests that a frame is stopped when the view moves. Plain C kernels render slowly enough to be stopped. */
static void test_frame_is_stopped(void)
{
    viewer v;
    SDL_Event event = {0};
    frame_options options = small_options();
    options.cpu = "c";
    options.width = 1000;
    options.height = 700;
    if (start(&v, &options))
        return;
    CHECK(frames_taken(&v) == 1);
    v.changed = 1;
    viewer_step(&v, 0);
    CHECK(v.request_count == 1 && frames_taken(&v) == 1);
    event.type = SDL_MOUSEMOTION;
    event.motion.state = SDL_BUTTON_LMASK;
    event.motion.xrel = 9;
    SDL_PushEvent(&event);
    settle(&v);
    CHECK(frames_taken(&v) == 2 && v.coarse && v.seen.width == 500);
    rest(&v);
    CHECK(frames_taken(&v) == 3 && !v.coarse && shows(&v, v.view, 1000, 700));
    viewer_close(&v);
}

static int says_why(const viewer *v, const char *path)
{
    const char *name = viewer_file_name(path);
    const size_t length = strlen(name);
    return !strncmp(v->note, name, length) && !strncmp(v->note + length, ": ", 2) && v->note[length + 2];
}

static void test_dropped_files(void)
{
    viewer v;
    char missing[80];
    const frame_options options = small_options();
    snprintf(missing, sizeof missing, "%s/none.ply", folder);
    if (start(&v, &options))
        return;
    uint32_t count = v.world.gaussians;
    drop(&v, junk);
    CHECK(says_why(&v, junk) && !strcmp(v.path, knot) && v.world.gaussians == count);
    drop(&v, missing);
    CHECK(!strcmp(v.note, "none.ply: No such file or directory"));
    CHECK(!strcmp(v.path, knot) && shows(&v, v.views[0], 64, 48));
    drop(&v, cubes);
    CHECK(!strcmp(v.path, cubes) && v.world.gaussians == 300 && shows(&v, v.views[0], 64, 48));
    make_scene(other, "\xc3\xa4 \xf0\x9f\x98\x80", "cubes", "20");
    char given[sizeof other];
    snprintf(given, sizeof given, "%s", other);
#ifdef _WIN32
    for (char *c = given; *c; c++)                               /* on Windows, dropped paths have backslashes */
        *c = *c == '/' ? '\\' : *c;
#endif
    drop(&v, given);
    CHECK(!strcmp(v.path, other) && v.world.gaussians == 20 && !fxs_file_remove(other));
    viewer_close(&v);
}

static void test_views_of_a_file(void)
{
    viewer v;
    frame_options options = small_options();
    options.cameras = cameras;
    options.view = "second";
    options.width = options.height = 0;
    if (start(&v, &options))
        return;
    CHECK(v.view_count == 3 && v.index == 1 && shows(&v, v.views[1], 80, 60));
    CHECK(v.views[1].near == 0 && v.view.near > 0.02 && v.view.near < 0.2);
    CHECK(near(v.up[0], 0) && near(v.up[1], -0.8) && near(v.up[2], 0.6));
    key(&v, 'n');
    key(&v, 'n');
    CHECK(v.index == 0 && shows(&v, v.views[0], 80, 60));
    SDL_SetModState(KMOD_LSHIFT);
    key(&v, 'n');
    SDL_SetModState(KMOD_NONE);
    CHECK(v.index == 2 && !strcmp(v.view.name, "third"));
    drop(&v, cubes);
    CHECK(v.view_count == 1 && !v.options.cameras && near(v.up[1], -1));
    viewer_close(&v);
    options.up = (point_option){1, {0, 0, 1}};
    options.near = 0.5;
    if (start(&v, &options))
        return;
    CHECK(near(v.up[1], 0) && near(v.up[2], 1) && v.view.near == 0.5);
    viewer_close(&v);
}

static void test_objects(void)
{
    viewer v;
    frame_options options = small_options();
    char *scenes[] = {knot, cubes};
    options.world = (world_options){.scenes = scenes, .scene_count = 2, .places = {"1:30,0,0"}, .place_count = 1};
    options.ortho = 8;
    if (!CHECK(!viewer_open(&v, &options, 0, 0)))
        return;
    settle(&v);
    CHECK(v.world.count == 2 && v.world.high[0] > 25 && v.view.projection == FXS_ORTHOGRAPHIC);
    CHECK(shows(&v, v.views[0], 64, 48));
    wheel(&v, 2);
    rest(&v);
    CHECK(v.view.fx > v.views[0].fx && shows(&v, v.view, 64, 48));
    drop(&v, cubes);
    CHECK(v.world.count == 1 && v.options.world.scene_count == 1 && !v.options.world.place_count);
    viewer_close(&v);
}

static void test_resized_window(void)
{
    viewer v;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    SDL_SetWindowSize(SDL_GetWindowFromID(1), 101, 33);
    settle(&v);
    CHECK(shows(&v, v.views[0], 101, 33));
    SDL_SetWindowSize(SDL_GetWindowFromID(1), 1, 1);
    settle(&v);
    wheel(&v, 1);
    CHECK(v.picture.width == 1 && v.picture.height == 1);
    viewer_close(&v);
}

static void test_screenshot(void)
{
    viewer v;
    uint8_t *rgba = 0;
    int width, height;
    fxs_message message;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    drag(&v, SDL_BUTTON_LMASK, 9, 4);
    key(&v, 'p');
    CHECK(strstr(v.note, shot) && !v.coarse);
    if (CHECK(!fxs_image_file_read(shot, &rgba, &width, &height, &message)) && CHECK(width == 64 && height == 48))
        CHECK(shows(&v, v.view, 64, 48) && !memcmp(rgba, v.picture.pixels, 64 * 48 * 4));
    free(rgba);
    v.screenshot = "/none/shot.ppm";
    key(&v, 'p');
    CHECK(strstr(v.note, "/none/shot.ppm: cannot be written"));
    viewer_close(&v);
}

static void test_numbered_screenshots(void)
{
    viewer v;
    char before[4096], text[8] = "";
    const frame_options options = small_options();
    if (!CHECK(getcwd(before, sizeof before)) || start(&v, &options))
        return;
    CHECK(!chdir(folder));
    write_text(other, "fixsplat-002.png", "mine");
    v.screenshot = 0;
    push_key('p');
    key(&v, 'p');
    CHECK(!strcmp(v.note, "written: fixsplat-003.png") && !remove("fixsplat-001.png") && !remove("fixsplat-003.png"));
    FILE *file = fopen("fixsplat-002.png", "r");
    CHECK(file && fgets(text, sizeof text, file) && !strcmp(text, "mine"));
    if (file)
        fclose(file);
    CHECK(!remove(other) && !chdir(before));
    viewer_close(&v);
}

/* Reads the first line of a file. Returns the file's size, or -1 if the file does not exist. */
static long size_of(const char *path, char line[80])
{
    FILE *file = fopen(path, "r");
    if (!file)
        return -1;
    CHECK(fgets(line, 80, file) && !fseek(file, 0, SEEK_END));
    const long size = ftell(file);
    fclose(file);
    return size;
}

static void test_films(void)
{
    viewer v;
    char before[4096], line[80] = "";
    const frame_options options = small_options();
    if (!CHECK(getcwd(before, sizeof before)) || start(&v, &options))
        return;
    CHECK(!chdir(folder));
    key(&v, 'k');
    wheel(&v, 2);
    for (int i = 0; i < 20; i++)
        viewer_step(&v, 10);
    CHECK(v.film == FILM_TAKEN && v.way_count > 3);
    CHECK(memcmp(v.way[0].position, v.way[v.way_count - 1].position, sizeof v.view.position));
    key(&v, 'k');
    const long frame = 6 + 3 * 64 * 48, size = size_of("fixsplat-001.y4m", line);
    CHECK(strstr(v.note, "written: fixsplat-001.y4m") && v.film == FILM_NONE);
    CHECK(strstr(line, "YUV4MPEG2 W64 H48 F30:1 ") && size == (long)strlen(line) + v.way_count * frame);
    CHECK(!remove("fixsplat-001.y4m"));
    key(&v, 'k');
    for (v.way_count = 1; v.way_count < 3000; v.way_count++)
        v.way[v.way_count] = v.view;
    push_key('k');
    viewer_step(&v, 0);
    CHECK(v.film == FILM_WRITTEN);
    key(&v, 'k');
    CHECK(strstr(v.note, "dropped") && size_of("fixsplat-001.y4m", line) == -1);
    CHECK(!chdir(before));
    viewer_close(&v);
}

static int help_fits(viewer *v)
{
    static const int places[5][2] = {{160, 120}, {0, 120}, {319, 120}, {160, 0}, {160, 239}};
    SDL_Window *window = SDL_GetWindowFromID(1);
    int free_edges = 0;
    SDL_SetWindowSize(window, 320, 240);
    settle(v);
    const SDL_Surface *surface = SDL_GetWindowSurface(window);
    for (int i = 0; i < 5; i++) {
        Uint32 pixel;
        memcpy(&pixel, (const Uint8 *)surface->pixels + places[i][1] * surface->pitch + 4 * places[i][0], sizeof pixel);
        free_edges |= (pixel == SDL_MapRGB(surface->format, 0x14, 0x17, 0x1d)) << i;
    }
    return free_edges == (v->words ? 30 : 31);
}

/* Runs steps of the viewer until it has shown a picture of another moment. */
static void play_on(viewer *v)
{
    const int64_t before = v->options.render.time_q32;
    for (int i = 0; i < 2000 && v->options.render.time_q32 == before; i++)
        viewer_step(v, 10);
    for (int i = 0; i < 2000 && v->request_count; i++)
        viewer_step(v, 10);
}

static int stop_playing(viewer *v)
{
    push_key(' ');
    settle(v);
    return !v->play.on;
}

/* Opens a moving scene of a second, and steps until it is shown. Returns 0 after a failure. */
static int open_moving(viewer *v, const frame_options *options)
{
    make_moving(other, 1);
    if (!CHECK(!open_file(v, options, other, shot)))
        return 0;
    while (!v->path)
        viewer_step(v, 10);
    return 1;
}

static void test_playing(void)
{
    viewer v;
    const frame_options options = small_options();
    if (!open_moving(&v, &options))
        return;
    CHECK(v.play.on && v.play.loops && near(v.play.time.duration, 1) && near(v.play.time.rate, 20));
    play_on(&v);
    const double at = v.play.at;
    play_on(&v);
    CHECK(at > 0 && v.play.at != at && v.play.on);
    CHECK(stop_playing(&v) && shows(&v, v.views[0], 64, 48));
    const double paused = v.play.at;
    for (int i = 0; i < 5; i++)
        viewer_step(&v, 20);
    CHECK(v.play.at == paused && !viewer_busy(&v));
    key(&v, '.');
    const double next = v.play.at;
    CHECK(next != paused && near(20 * next, floor(20 * next) + 1.0 / 256) && shows(&v, v.views[0], 64, 48));
    key(&v, '.');
    key(&v, ',');
    CHECK(near(v.play.at, next) && v.options.render.budget == 0);
    key(&v, ']');
    CHECK(v.play.speed == 2);
    key(&v, '[');
    key(&v, '[');
    CHECK(v.play.speed == 0.5);
    key(&v, 'y');
    CHECK(!v.play.loops && !strcmp(v.note, "once"));
    for (int i = 0; i < 30; i++)
        key(&v, '.');
    CHECK(v.play.at == 1 && shows(&v, v.views[0], 64, 48));
    key(&v, 'l');
    CHECK(v.edit.tool == EDIT_OFF && strstr(v.note, "no edits of a scene that moves"));
    push_key(' ');
    viewer_step(&v, 10);
    CHECK(v.play.on && v.play.at < 1);
    v.play.speed = 8;
    for (int i = 0; i < 2000 && v.play.on; i++)
        viewer_step(&v, 10);
    settle(&v);
    CHECK(!v.play.on && v.play.at == 1 && shows(&v, v.views[0], 64, 48));
    viewer_close(&v);
    remove(other);
}

static void test_time_bar(void)
{
    viewer v;
    const frame_options options = small_options();
    if (!open_moving(&v, &options))
        return;
    CHECK(stop_playing(&v));
    const fxs_view view = v.view;
    click(&v, 1, 16, 46);
    CHECK(near(v.play.at, 0.25) && shows(&v, v.views[0], 64, 48));
    push_button(SDL_MOUSEBUTTONDOWN, 1, 16, 46);
    move_to(&v, SDL_BUTTON_LMASK, 48, 20);
    CHECK(v.play.dragged && near(v.play.at, 0.75));
    move_to(&v, SDL_BUTTON_LMASK, 500, 20);
    CHECK(v.play.at > 0.99 && v.play.at < 1);
    push_button(SDL_MOUSEBUTTONUP, 1, 60, 20);
    settle(&v);
    CHECK(!v.play.dragged && !memcmp(&view, &v.view, sizeof view) && shows(&v, v.views[0], 64, 48));
    move_to(&v, SDL_BUTTON_LMASK, 20, 20);
    CHECK(memcmp(&view, &v.view, sizeof view));
    drop(&v, knot);
    CHECK(!play_moves(&v) && !v.play.on);
    key(&v, ' ');
    CHECK(!v.play.on);
    viewer_close(&v);
    remove(other);
}

static void test_empty_window(void)
{
    viewer v;
    const frame_options options = small_options();
    if (!CHECK(!viewer_open(&v, &options, shot, 0)))
        return;
    settle(&v);
    push_key('n'), push_key('p'), push_key('z'), push_key('+'), push_key('m'), push_key('b');
    wheel(&v, 2);
    click(&v, 2, 10, 10);
    drag(&v, SDL_BUTTON_LMASK, 9, 4);
    CHECK(!v.quit && !v.path && !*v.note && !v.seen.width);
    key(&v, 'h');
    CHECK(v.help && help_fits(&v));
    drop(&v, junk);
    CHECK(!v.quit && !v.path && says_why(&v, junk));
    drop(&v, cubes);
    CHECK(v.path && !strcmp(v.path, cubes) && shows(&v, v.views[0], 64, 48));
    viewer_close(&v);
}

/* Files dropped on the viewer while a scene loads: the last one opens next. */
static void test_events_while_loading(void)
{
    viewer v;
    const frame_options options = small_options();
    make_scene(other, "large", "knot", "200000");
    if (start(&v, &options))
        return;
    push_drop(other);
    viewer_step(&v, 0);
    CHECK(v.loading.on && !strcmp(v.path, knot));
    push_key('t'), push_key('0');
    viewer_step(&v, 0);
    CHECK(v.loading.on && v.light && v.options.render.sh_degree == 2);
    push_drop(knot), push_drop(cubes);
    settle(&v);
    CHECK(!strcmp(v.path, cubes) && v.world.gaussians == 300 && v.options.render.sh_degree == 2);
    push_drop(other);
    viewer_step(&v, 0);
    CHECK(v.loading.on);
    viewer_close(&v);
    if (!CHECK(!open_file(&v, &options, other, 0)))
        return;
    push_key(SDLK_ESCAPE);
    viewer_step(&v, 0);
    CHECK(v.quit && !v.status && v.loading.on);
    viewer_close(&v);
    remove(other);
}

static int shows_painted(const viewer *v, int draws)
{
    renderer r;
    picture expected = {.pixels = 0};
    int same = !renderer_open(&r, &v->options);
    r.draws = draws;
    same = same && !renderer_render(&r, &v->world, &v->view, &v->options.render, &expected, 0);
    const fxs_canvas out = {expected.pixels, expected.width, expected.height};
    if (same && draws == DRAW_IDS)
        fxs_paint_ids(&out, expected.ids);
    else if (same)
        fxs_paint_depths(&out, expected.depths);
    same = same && expected.width == v->picture.width &&
           !memcmp(expected.pixels, v->picture.pixels, (size_t)out.width * (size_t)out.height * 4);
    renderer_close(&r);
    picture_free(&expected);
    return same;
}

static void make_levels(char *path)
{
    static char many[] = "20000";
    char source[sizeof knot];
    const fxs_open_options how = {.size = sizeof(fxs_open_options), .tree = 1};
    fxs_opened *opened;
    fxs_message message;
    make_scene(source, "levels", "knot", many);
    snprintf(path, sizeof knot, "%s/levels.fxs", folder);
    if (!CHECK(!fxs_open(source, &how, &opened, &message)))
        return;
    CHECK(!fxs_file_write(path, opened->data, opened->bytes, &message));
    fxs_close(opened);
}

static int is_picture_of(const viewer *v, const picture *p)
{
    return v->picture.width == p->width &&
           !memcmp(v->picture.pixels, p->pixels, (size_t)p->width * (size_t)p->height * 4);
}

static void test_levels(void)
{
    static char path[sizeof knot];
    viewer v;
    const frame_options options = small_options();
    make_levels(path);
    if (start(&v, &options))
        return;
    key(&v, ',');
    CHECK(v.options.render.budget == 0 && strstr(v.note, "no levels of detail"));
    drop(&v, path);
    CHECK(has_levels(&v.world) && viewer_budget_most(&v) == 20000 && v.gaussians >= 20000);
    CHECK(shows(&v, v.view, 64, 48));
    picture whole = {.pixels = 0};
    renderer r;
    CHECK(!renderer_open(&r, &v.options) &&
          !renderer_render(&r, &v.world, &v.view, &v.options.render, &whole, 0) && is_picture_of(&v, &whole));
    key(&v, ',');
    CHECK(v.options.render.budget == 16000 && v.slider && v.gaussians <= 16000 && shows(&v, v.view, 64, 48));
    for (int i = 0; i < 20; i++)
        key(&v, ',');
    CHECK(v.options.render.budget == BUDGET_LEAST && v.gaussians <= BUDGET_LEAST && !is_picture_of(&v, &whole));
    CHECK(shows(&v, v.view, 64, 48));
    for (int i = 0; i < 20; i++)
        key(&v, '.');
    CHECK(v.options.render.budget == 0 && is_picture_of(&v, &whole));
    key(&v, 'o');
    CHECK(v.options.render.show_levels && !is_picture_of(&v, &whole) && shows(&v, v.view, 64, 48));
    for (int i = 0; i < 4 * v.picture.width * v.picture.height; i += 4)
        CHECK(v.picture.pixels[i] == v.picture.pixels[i + 1] && v.picture.pixels[i] == v.picture.pixels[i + 2]);
    key(&v, 'o'), key(&v, 'f');
    CHECK(is_picture_of(&v, &whole));
    renderer_close(&r);
    picture_free(&whole);
    viewer_close(&v);
}

static void test_rate(void)
{
    static char path[sizeof knot];
    viewer v;
    const frame_options options = small_options();
    make_levels(path);
    if (!CHECK(!open_file(&v, &options, path, 0)))
        return;
    settle(&v);
    wheel(&v, 1);
    rest(&v);
    CHECK(v.options.render.budget == 0);
    v.rate_wanted = 50;
    for (int i = 0; i < 2; i++)
        viewer_follow_rate(&v, 40000000, 20000);
    CHECK(v.options.render.budget == 10000 && v.pace.reason == FXS_PACE_LATE);
    /* the frame drew fewer chunks than the budget allows, so its time does not change the budget */
    for (int i = 0; i < 20; i++)
        viewer_follow_rate(&v, 5000000, 5000);
    CHECK(v.options.render.budget == 10000);
    for (int i = 0; i < 20; i++)
        viewer_follow_rate(&v, 5000000, 10000);
    CHECK(v.options.render.budget == 0 && v.pace.reason == FXS_PACE_FASTER);
    for (int i = 0; i < 20; i++)
        viewer_follow_rate(&v, 1000000000, 9000);
    CHECK(v.options.render.budget == BUDGET_LEAST);
    v.rate_wanted = 1000;
    wheel(&v, 1);
    rest(&v);
    CHECK(v.options.render.budget == BUDGET_LEAST && shows(&v, v.view, 64, 48));
    viewer_close(&v);
}

static void test_pool(void)
{
    static char path[sizeof knot];
    viewer v;
    frame_options options = small_options();
    fxs_opened *mapped;
    fxs_message message;
    make_levels(path);
    options.load.pages = 1;
    options.load.pool = 1 << 20;
    if (!CHECK(!open_file(&v, &options, path, 0) && !fxs_open(path, 0, &mapped, &message)))
        return;
    for (int way = 0; way < 3; way++) {
        settle(&v);
        for (int i = 0; i < 500 && (v.missing || v.coarse || viewer_busy(&v)); i++)
            viewer_step(&v, 20);
        CHECK(!v.missing && v.options.render.budget == viewer_budget_most(&v));
        CHECK(v.gaussians > 0 && v.gaussians <= v.options.render.budget);
        CHECK(v.world.scenes[0].opened->pager && shows(&v, v.view, 64, 48));
        v.world.objects[0].scene = mapped->scene;
        CHECK(shows(&v, v.view, 64, 48));
        v.world.objects[0].scene = v.world.scenes[0].opened->scene;
        wheel(&v, way ? -9 : 12);
    }
    viewer_close(&v);
    fxs_close(mapped);
}

static void test_depths_and_ids(void)
{
    viewer v;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    key(&v, 'z');
    CHECK(shows_painted(&v, DRAW_MEDIAN_DEPTH) && !shows(&v, v.views[0], 64, 48));
    key(&v, 'i');
    CHECK(shows_painted(&v, DRAW_IDS) && !shows_painted(&v, DRAW_MEDIAN_DEPTH));
    key(&v, 'i');
    CHECK(shows(&v, v.views[0], 64, 48));
    viewer_close(&v);
}

static int find_seen(viewer *v, int from, int *x, int *y)
{
    fxs_pick_result pick;
    for (int i = from; i < 64 * 48; i++) {
        *x = i % 64, *y = i / 64;
        if (renderer_pick(&v->renderer, &v->world, &v->view, &v->options.render, *x, *y, &pick) == 1)
            return 1;
    }
    return 0;
}

static void test_focus(void)
{
    viewer v;
    fxs_pick_result pick;
    double point[3], pixel[2];
    int x, y;
    const frame_options options = small_options();
    if (start(&v, &options) || !CHECK(find_seen(&v, 64 * 20, &x, &y)))
        return;
    CHECK(renderer_pick(&v.renderer, &v.world, &v.view, &v.options.render, x, y, &pick) == 1);
    for (int i = 0; i < 3; i++)
        point[i] = ldexp((double)pick.position_q32[i], -32);
    click(&v, 1, x, y);
    CHECK(!memcmp(&v.view.position, &v.views[0].position, sizeof v.view.position));
    click(&v, 2, x, y);
    CHECK(fabs(see(&v.view, point, pixel) - v.distance) < 1e-6);
    CHECK(fabs(pixel[0] - v.view.cx) < 1e-3 && fabs(pixel[1] - v.view.cy) < 1e-3 && shows(&v, v.view, 64, 48));
    const fxs_view before = v.view;
    click(&v, 2, 0, 0);
    CHECK(strstr(v.note, "nothing there") && !memcmp(&v.view, &before, sizeof before));
    viewer_close(&v);
}

static void test_measure(void)
{
    viewer v;
    double pixel[2], square = 0;
    int x[2], y[2];
    const frame_options options = small_options();
    if (start(&v, &options) || !CHECK(find_seen(&v, 64 * 20, &x[0], &y[0]) && find_seen(&v, 64 * 30, &x[1], &y[1])))
        return;
    key(&v, 'm');
    click(&v, 1, x[0], y[0]);
    CHECK(v.ends == 1 && strstr(v.note, "other end"));
    click(&v, 1, x[1], y[1]);
    CHECK(v.ends == 2 && strstr(v.note, " units"));
    for (int i = 0; i < 2; i++) {
        CHECK(see(&v.view, v.end[i], pixel) > 0);
        CHECK(fabs(pixel[0] - x[i] - 0.5) < 0.6 && fabs(pixel[1] - y[i] - 0.5) < 0.6);
    }
    for (int i = 0; i < 3; i++)
        square += (v.end[1][i] - v.end[0][i]) * (v.end[1][i] - v.end[0][i]);
    CHECK(square > 0 && fabs(atof(v.note) / sqrt(square) - 1) < 1e-3);
    click(&v, 1, x[1], y[1]);
    CHECK(v.ends == 1);
    key(&v, 'm');
    CHECK(!v.ends && !v.measuring);
    viewer_close(&v);
}

static void drag_handle(viewer *v, int face, int dx, int dy)
{
    double point[3], pixel[2];
    crop_handle(&v->crop, face, point);
    if (!CHECK(viewer_project(v, point, pixel)))
        return;
    const int x = (int)lround(pixel[0]), y = (int)lround(pixel[1]);
    move_to(v, 0, x, y);
    CHECK(v->face == face && !v->dragged);
    push_button(SDL_MOUSEBUTTONDOWN, 1, x, y);
    move_to(v, SDL_BUTTON_LMASK, x + dx, y + dy);
    CHECK(v->dragged);
    push_button(SDL_MOUSEBUTTONUP, 1, x + dx, y + dy);
    move_to(v, 0, x + dx, y + dy);
    CHECK(!v->dragged);
    rest(v);
}

static uint32_t drawn(const viewer *v)
{
    renderer r;
    picture p = {.pixels = 0};
    fxs_stats stats = {0};
    CHECK(!renderer_open(&r, &v->options) && !renderer_render(&r, &v->world, &v->view, &v->options.render, &p, &stats));
    renderer_close(&r);
    picture_free(&p);
    return stats.visible;
}

/* Lets the viewer write the cropped scene. Returns the number of Gaussians in the written file. */
static uint32_t write_cropped(viewer *v, const char *name)
{
    char path[80];
    world w;
    const load_options load = {.again = 1};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    key(v, SDLK_RETURN);
    if (!CHECK(strstr(v->note, "written: ") && strstr(v->note, path)) || !CHECK(!world_open_file(&w, path, &load)))
        return 0;
    const uint32_t count = w.gaussians;
    world_close(&w);
    remove(path);
    return count;
}

static void test_crop(void)
{
    viewer v;
    char first[80];
    const frame_options options = framed_options();
    if (start(&v, &options))
        return;
    key(&v, SDLK_RETURN);
    CHECK(!*v.note && drawn(&v) == 2000);
    key(&v, 'c');
    const crop_box whole = v.crop;
    CHECK(v.crop.on && v.world.objects->crop_count == 1 && shows(&v, v.views[0], 64, 48));
    for (int i = 0; i < 3; i++)
        CHECK(whole.low[i] == (float)v.world.inner_low[i] && whole.high[i] == (float)v.world.inner_high[i]);
    drag_handle(&v, 1, -8, 0);
    CHECK(v.crop.high[0] < whole.high[0] - 0.5 && v.crop.low[0] == whole.low[0]);
    CHECK(!memcmp(v.view.rotation, v.views[0].rotation, sizeof v.view.rotation) && shows(&v, v.views[0], 64, 48));
    drag_handle(&v, 2, 0, 8);
    CHECK(v.crop.low[1] > whole.low[1] + 0.5 && v.crop.high[1] == whole.high[1]);
    const uint32_t left = drawn(&v);
    CHECK(left > 100 && left < 1900);
    snprintf(first, sizeof first, "%s/knot-cropped-001.ply", folder);
    write_text(first, "knot-cropped-001.ply", "mine");
    CHECK(write_cropped(&v, "knot-cropped-002.ply") == left);
    CHECK(!remove(first) && write_cropped(&v, "knot-cropped-001.ply") == left);
    for (int i = 0; fxs_backend_at(i) && (i == 0 || strcmp(v.options.backend, "cpu")); i++) {
        key(&v, 'b');
        CHECK(drawn(&v) == left && shows(&v, v.views[0], 64, 48));
    }
    drag_handle(&v, 1, -1000, 0);
    CHECK(v.crop.high[0] > v.crop.low[0] && v.crop.high[0] < v.crop.low[0] + 0.1);
    key(&v, SDLK_ESCAPE);
    CHECK(!v.quit && !v.crop.on && !v.world.objects->crop_count && drawn(&v) == 2000 && shows(&v, v.views[0], 64, 48));
    key(&v, 'c');
    CHECK(v.crop.on && v.crop.low[1] > whole.low[1] + 0.5);
    drop(&v, cubes);
    CHECK(!v.crop.on && drawn(&v) == 300);
    key(&v, SDLK_ESCAPE);
    CHECK(v.quit);
    viewer_close(&v);
}

static int orange_pixels(const viewer *v)
{
    int count = 0;
    for (int i = 0; i < v->picture.width * v->picture.height; i++)
        count += !memcmp(v->picture.pixels + 4 * i, "\xff\x7d\x3d", 3);
    return count;
}

/* Clicks of one camera are one object with several hints, a click of another camera is another object. */
static void test_object(void)
{
    viewer v;
    frame_options options = framed_options();
    options.width = 256;
    options.height = 192;
    if (start(&v, &options))
        return;
    key(&v, 'l'), key(&v, 'l'), key(&v, 'l');
    CHECK(v.edit.tool == EDIT_OBJECT && strstr(v.note, "object: click it"));
    click(&v, 1, 4, 4);
    CHECK(strstr(v.note, "nothing is there") && !v.edit.list.shape_count);
    click(&v, 1, 104, 88);
    const fxs_edit_shape *shapes = v.edit.list.shapes;
    const uint32_t chosen = v.edit.editor.chosen;
    if (!CHECK(shapes)) {
        viewer_close(&v);
        return;
    }
    CHECK(chosen > 20 && v.edit.list.shape_count == 1 && shapes[0].point_numbers == 5 && orange_pixels(&v) > 10);
    CHECK(shapes[0].points[0] == 104 && shapes[0].points[3] == 88 && shapes[0].points[4] == 1);
    click(&v, 1, 4, 4);
    CHECK(strstr(v.note, "nothing is there") && v.edit.editor.chosen == chosen && v.edit.list.shape_count == 1);
    push_button(SDL_MOUSEBUTTONDOWN, 1, 8, 8);
    move_to(&v, SDL_BUTTON_LMASK, 248, 184);
    push_button(SDL_MOUSEBUTTONUP, 1, 248, 184);
    rest(&v);
    CHECK(v.edit.list.shape_count == 1 && v.edit.list.shapes[0].point_numbers == 10);
    CHECK(v.edit.list.shapes[0].points[7] == 248 && v.edit.editor.chosen > chosen);
    key(&v, SDLK_DELETE);
    CHECK(v.edit.list.count == 1 && drawn(&v) == v.edit.editor.left && v.edit.editor.left < 2000 - chosen);
    key(&v, 'u');
    CHECK(drawn(&v) == 2000);
    click(&v, 1, 104, 88);
    CHECK(v.edit.editor.chosen == chosen && v.edit.list.shape_count == 2);
    wheel(&v, 1);
    rest(&v);
    click(&v, 1, 104, 88);
    CHECK(v.edit.list.shape_count == 3 && v.edit.list.shapes[2].point_numbers == 5);
    key(&v, SDLK_ESCAPE);
    CHECK(!v.edit.editor.chosen && v.edit.list.shape_count == 1);
    viewer_close(&v);
}

static void test_edits(void)
{
    viewer v;
    const frame_options options = framed_options();
    if (start(&v, &options))
        return;
    key(&v, SDLK_DELETE), key(&v, 'u');
    CHECK(strstr(v.note, "no edits yet") && drawn(&v) == 2000);
    key(&v, 'l');
    push_button(SDL_MOUSEBUTTONDOWN, 1, 10, 5);
    move_to(&v, SDL_BUTTON_LMASK, 50, 5);
    move_to(&v, SDL_BUTTON_LMASK, 30, 40);
    CHECK(v.edit.stroke_count == 3 && !memcmp(&v.view.position, v.views[0].position, sizeof v.view.position));
    push_button(SDL_MOUSEBUTTONUP, 1, 30, 40);
    rest(&v);
    const uint32_t chosen = v.edit.editor.chosen;
    CHECK(chosen > 100 && chosen < 1900 && !v.edit.stroke_count && orange_pixels(&v) > 50);
    key(&v, SDLK_DELETE);
    CHECK(drawn(&v) == 2000 - chosen && !orange_pixels(&v) && v.world.gaussians == 2000 - chosen);
    key(&v, SDLK_ESCAPE), key(&v, 'c'), key(&v, SDLK_RETURN);
    CHECK(strstr(v.note, "not written: the scene is edited"));
    drag_handle(&v, 1, -8, 0);
    key(&v, SDLK_DELETE);
    CHECK(v.edit.list.count == 2 && v.edit.list.shapes[1].kind == FXS_EDIT_BOX);
    key(&v, SDLK_ESCAPE), key(&v, 'u'), key(&v, 'u');
    CHECK(drawn(&v) == 2000 && v.edit.editor.last == 2);
    drop(&v, cubes);
    CHECK(drawn(&v) == 300 && !v.edit.copy && !v.edit.list.count);
    key(&v, SDLK_ESCAPE);
    CHECK(v.quit);
    viewer_close(&v);
}

static void test_crop_handles(void)
{
    viewer v;
    double point[3], pixel[2];
    frame_options options = framed_options();
    for (int parallel = 0; parallel < 2; parallel++) {
        options.ortho = parallel ? 12 : 0;
        if (start(&v, &options))
            return;
        drag(&v, SDL_BUTTON_LMASK, 7, 3);
        rest(&v);
        key(&v, 'c');
        for (int face = 0; face < CROP_FACES; face++) {
            crop_handle(&v.crop, face, point);
            CHECK(viewer_project(&v, point, pixel) && crop_face_at(&v, pixel[0], pixel[1]) != CROP_NONE);
        }
        crop_handle(&v.crop, 1, point);
        CHECK(viewer_project(&v, point, pixel));
        const double before = pixel[0];
        drag_handle(&v, 1, -5, 0);
        crop_handle(&v.crop, 1, point);
        CHECK(viewer_project(&v, point, pixel) && fabs(pixel[0] - before + 5) < 1.5);
        viewer_close(&v);
    }
}

static void test_crop_of_objects(void)
{
    static const char text[] =
        "{\"objects\": [{\"file\": \"knot.ply\", \"crops\": [{\"low\": [-9, -9, -9], \"high\": [1, 9, 9], "
        "\"keep\": \"inside\"}, {\"low\": [2, -9, -9], \"high\": [9, 9, 9], \"keep\": \"inside\"}, "
        "{\"low\": [-9, 1, -9], \"high\": [9, 9, 9], \"keep\": \"outside\"}]}, {\"file\": \"cubes.ply\", "
        "\"translation\": [1, -1, 0], \"rotation\": [1, 0, 0, %s], \"scale\": 0.5}]}";
    viewer v;
    char json[1024];
    frame_options options = small_options();
    snprintf(json, sizeof json, text, "1");                      /* an object rotated by 90 degrees */
    write_text(other, "world.json", json);
    options.world.file = other;
    if (!CHECK(!viewer_open(&v, &options, 0, 0)))
        return;
    settle(&v);
    const uint32_t all = drawn(&v);
    key(&v, 'c');
    drag_handle(&v, 1, -8, 0);
    const uint32_t left = drawn(&v);
    CHECK(v.crop.on && left > 100 && left < all && shows(&v, v.views[0], 64, 48));
    CHECK(write_cropped(&v, "world-cropped-001.ply") == left);
    drag_handle(&v, 1, -1000, 0);
    CHECK(drawn(&v) < left);
    viewer_close(&v);
    snprintf(json, sizeof json, text, "0.5");
    write_text(other, "world.json", json);
    if (!CHECK(!viewer_open(&v, &options, 0, 0)))
        return;
    settle(&v);
    key(&v, 'c');
    CHECK(!v.crop.on && strstr(v.note, "turned"));
    viewer_close(&v);
    remove(other);
}

static void test_crop_not_written(void)
{
    viewer v;
    char packed[80];
    const frame_options options = small_options();
    snprintf(packed, sizeof packed, "%s/knot.fxs", folder);
    char *arguments[] = {"convert", knot, packed, 0};
    optind = 1;
    CHECK(command_convert.run(3, arguments) == EXIT_OK);
    if (!CHECK(!open_file(&v, &options, packed, 0)))
        return;
    settle(&v);
    push_key('c');
    key(&v, SDLK_RETURN);
    settle(&v);
    char cropped[100];
    snprintf(cropped, sizeof cropped, "%s/knot-cropped-001.ply", folder);
    CHECK(!v.crop_written && !remove(cropped));
    make_scene(other, "large", "knot", "300000");
    drop(&v, other);
    push_key('c'), push_key(SDLK_RETURN);
    viewer_step(&v, 0);
    CHECK(v.crop_written && !v.quit);
    push_key('t');
    viewer_step(&v, 0);
    CHECK(v.light && v.crop_written);
    key(&v, SDLK_ESCAPE);
    CHECK(!v.quit && v.crop.on && !v.crop_written && strstr(v.note, "not written"));
    CHECK(!remove(other) && !remove(packed));
    snprintf(packed, sizeof packed, "%s/large-cropped-001.ply", folder);
    CHECK(access(packed, F_OK));
    viewer_close(&v);
}

static int open_empty(viewer *v)
{
    const frame_options options = small_options();
    if (!CHECK(!viewer_open(v, &options, 0, 0)))
        return 0;
    settle(v);
    return 1;
}

static void test_recent(void)
{
    viewer v;
    const frame_options options = small_options();
    char list[80], line[80];
    snprintf(list, sizeof list, "%s/state/fixsplat/recent", folder);
    remove(list);
    if (!open_empty(&v))
        return;
    CHECK(!v.recent.count && viewer_recent_at(&v, 32, 24) == -1);
    key(&v, '1');
    drop(&v, knot);
    drop(&v, cubes);
    drop(&v, junk);
    make_scene(other, "gone", "knot", "20");
    drop(&v, other);
    drop(&v, knot);
    viewer_close(&v);
    CHECK(size_of(list, line) == (long)(strlen(knot) + strlen(cubes) + strlen(other) + 3));
    CHECK(!strncmp(line, knot, strlen(knot)));
    remove(other);
    if (!open_empty(&v))
        return;
    CHECK(v.recent.count == 2 && !strcmp(v.recent.paths[0], knot) && !strcmp(v.recent.paths[1], cubes));
    key(&v, '3');
    CHECK(!v.path);
    key(&v, '2');
    CHECK(v.path && !strcmp(v.path, cubes) && shows(&v, v.views[0], 64, 48));
    viewer_close(&v);
    setenv(KEPT_BELOW, "/proc/none", 1);
    if (!start(&v, &options))
        CHECK(v.path && !v.quit && v.loading.unkept == 1);
    viewer_close(&v);
    setenv(KEPT_BELOW, state, 1);
}

static void test_recent_by_click(void)
{
    viewer v;
    if (!open_empty(&v))
        return;
    SDL_SetWindowSize(SDL_GetWindowFromID(1), 640, 480);
    settle(&v);
    int y = 0;
    while (y < 480 && viewer_recent_at(&v, 320, y) != 1)
        y++;
    if (v.words && CHECK(y < 480)) {
        CHECK(viewer_recent_at(&v, 320, y - 1) == 0 && viewer_recent_at(&v, 2, y) == -1);
        move_to(&v, 0, 320, y + 2);
        CHECK(v.recent_marked == 1);
        click(&v, 1, 320, y + 2);
        CHECK(v.path && !strcmp(v.path, knot));
    }
    viewer_close(&v);
}

/* Sets the folder of the list of recent scenes by the environment variable HOME. home: null unsets it. */
static void keep_below(const char *home)
{
#ifdef _WIN32
    setenv("APPDATA", home ? home : "", 1);
#else
    setenv("XDG_STATE_HOME", "relative", 1);
    if (home)
        setenv("HOME", home, 1);
    else
        unsetenv("HOME");
#endif
}

static void test_recent_list(void)
{
    fxs_message message;
    fxs_recent recent;
    char path[112], home[80];
    snprintf(home, sizeof home, "%s/home", folder);
    keep_below(home);
    CHECK(!mkdir(home, 0700));
    for (int i = 0; i < 13; i++) {
        snprintf(path, sizeof path, "%s/%02d.ply", folder, i % 12);
        write_text(other, path + strlen(folder) + 1, "");
        CHECK(!fxs_recent_add(path, &message));
    }
    fxs_recent_read(&recent);
    CHECK(recent.count == FXS_RECENT_MOST && strstr(recent.paths[0], "/00.ply") && strstr(recent.paths[1], "/11.ply") &&
          strstr(recent.paths[9], "/03.ply"));
    fxs_recent_free(&recent);
    keep_below(0);
    CHECK(!fxs_recent_add(knot, &message));
    fxs_recent_read(&recent);
    CHECK(!recent.count);
    for (int i = 0; i < 12; i++) {
        snprintf(path, sizeof path, "%s/%02d.ply", folder, i);
        CHECK(!remove(path));
    }
#ifdef _WIN32
    static const char *const made[] = {"/fixsplat/recent", "/fixsplat", ""};
#else
    static const char *const made[] = {"/.local/state/fixsplat/recent", "/.local/state/fixsplat", "/.local/state",
                                       "/.local", ""};
#endif
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
        snprintf(path, sizeof path, "%s%s", home, made[i]);
        CHECK(!(i ? fxs_folder_remove : fxs_file_remove)(path));
    }
    setenv(KEPT_BELOW, state, 1);
}

static void test_fine_pixels(void)
{
#if SDL_VERSION_ATLEAST(2, 26, 0)
    viewer coarse, fine;
    fxs_pick_result pick;
    double point[3], pixel[2];
    int x, y, width, height;
    const frame_options options = small_options();
    if (start(&coarse, &options))
        return;
    drag(&coarse, SDL_BUTTON_LMASK, 10, 4);
    pixels_a_point = 2;
    if (!start(&fine, &options)) {
        SDL_GetWindowSize(SDL_GetWindowFromID(2), &width, &height);
        CHECK(width == 32 && height == 24 && fxs_window_scale(fine.window) == 2 && shows(&fine, fine.views[0], 64, 48));
        drag(&fine, SDL_BUTTON_LMASK, 5, 2);
        CHECK(!memcmp(fine.view.rotation, coarse.view.rotation, sizeof fine.view.rotation));
        key(&fine, 'r');
        CHECK(find_seen(&fine, 64 * 20, &x, &y) && find_seen(&fine, 64 * y + (x + 1) / 2 * 2, &x, &y));
        CHECK(renderer_pick(&fine.renderer, &fine.world, &fine.view, &fine.options.render, x, y, &pick) == 1);
        for (int i = 0; i < 3; i++)
            point[i] = ldexp((double)pick.position_q32[i], -32);
        click(&fine, 2, x / 2, y / 2);
        CHECK(!(x % 2) && !(y % 2) && fabs(see(&fine.view, point, pixel) - fine.distance) < 1e-6);
    }
    viewer_close(&fine);
    pixels_a_point = 1;
    viewer_close(&coarse);
#else
    check_skipped++;
#endif
}

static void test_speed(void)
{
    viewer v;
    const frame_options options = small_options();
    if (start(&v, &options))
        return;
    key(&v, '+');
    const double far = atof(v.note + strlen("speed here "));
    key(&v, '-');
    wheel(&v, 8);
    key(&v, '+');
    const double nearer = atof(v.note + strlen("speed here "));
    CHECK(nearer > 0 && nearer < 0.8 * far);
    viewer_close(&v);
}

static void test_two_eyes(void)
{
    viewer v;
    uint8_t *rgba = 0;
    int width, height;
    fxs_message m;
    frame_options options = small_options();
    options.stereo = 0.5;
    if (start(&v, &options))
        return;
    fxs_window_size(v.window, &width, &height);
    CHECK(width == 128 && height == 48 && v.picture.width == 128 && shows(&v, v.views[0], 64, 48));
    key(&v, 'p');
    if (CHECK(!fxs_image_file_read(shot, &rgba, &width, &height, &m)) && CHECK(width == 128 && height == 48))
        CHECK(!memcmp(rgba, v.picture.pixels, 128 * 48 * 4));
    free(rgba);
    viewer_close(&v);
}

/* Tests the viewer with an asymmetric field of view, also while the camera moves and the picture is smaller. */
static void test_tangents(void)
{
    const double tangents[4] = {-1.38, 1.19, 1.0, -1.2};
    viewer v;
    fxs_message m;
    frame_options options = small_options();
    options.has_tangents = 1;
    memcpy(options.tangents, tangents, sizeof tangents);
    if (start(&v, &options))
        return;
    CHECK(shows(&v, v.views[0], 64, 48));
    wheel(&v, 2);
    fxs_view coarse = v.view;
    coarse.width = 32;
    coarse.height = 24;
    CHECK(!fxs_view_set_tangents(&coarse, tangents, &m));
    CHECK(v.coarse && shows(&v, coarse, 32, 24));
    rest(&v);
    CHECK(!v.coarse && shows(&v, v.view, 64, 48));
    viewer_close(&v);
}

/* ---- Walking ----------------------------------------------------------------------------------------------------- */

static FILE *room_file;

/* Writes a grid of flat Gaussians at a place on an axis, over ranges of the other two. */
static void add_plane(int axis, double at, double u0, double u1, double v0, double v1, int has_door)
{
    for (double u = u0; u < u1; u += 0.1)
        for (double w = v0; w < v1; w += 0.1) {
            const double p[3] = {axis == 0 ? at : u, axis == 1 ? at : axis == 0 ? u : w, axis == 2 ? at : w};
            if (!(has_door && u > -2.1 && fabs(w) < 0.5))
                fprintf(room_file, "%g %g %g 0 0 1 2.2 %g %g %g 1 0 0 0\n", p[0], p[1], p[2], axis == 0 ? -4.4 : -2.8,
                        axis == 1 ? -4.4 : -2.8, axis == 2 ? -4.4 : -2.8);
        }
}

/* Makes two rooms, the floor at y = 0, with a door in the wall at x = 0. */
static void make_room(char *path)
{
    static const char *const names[] = {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
                                        "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
    snprintf(path, sizeof knot, "%s/room.ply", folder);
    for (int pass = 0, lines = 0; pass < 2; pass++) {
        room_file = fopen(path, "w+");
        fprintf(room_file, "ply\nformat ascii 1.0\nelement vertex %d\n", lines);
        for (size_t i = 0; i < sizeof names / sizeof *names; i++)
            fprintf(room_file, "property float %s\n", names[i]);
        fputs("end_header\n", room_file);
        for (int side = 0; side < 2; side++) {
            add_plane(0, side ? 3 : -3, -2.5, 0, -2, 2, 0);
            add_plane(1, side ? -2.5 : 0, -3, 3, -2, 2, 0);
            add_plane(2, side ? 2 : -2, -3, 3, -2.5, 0, 0);
        }
        add_plane(0, 0, -2.5, 0, -2, 2, 1);
        rewind(room_file);
        for (int c; !pass && (c = getc(room_file)) != EOF;)
            lines += c == '\n';
        lines -= pass ? 0 : 4 + (int)(sizeof names / sizeof *names);
        fclose(room_file);
    }
}

static int eye_is(const viewer *v, double x, double y, double z, double most)
{
    const double *e = v->view.position;
    const int is = fabs(e[0] - x) < most && fabs(e[1] - y) < most && fabs(e[2] - z) < most;
    if (!is)
        printf("  the eye is at %g %g %g, not %g %g %g: %s\n", e[0], e[1], e[2], x, y, z, v->note);
    return is;
}

static frame_options room_options(double x, double z)
{
    frame_options options = small_options();
    options.eye = (point_option){1, {x, -1.2, z}};
    options.look = (point_option){1, {9, -1.2, z}};
    return options;
}

static int start_walk(viewer *v, const frame_options *options, const char *room, const char *walls)
{
    if (!CHECK(!open_file(v, options, room, 0)))
        return 0;
    v->walk.file = walls;
    settle(v);
    key(v, '3');
    return 1;
}

static void test_walk(void)
{
    static char room[64], file[64];
    viewer v;
    fxs_message m;
    frame_options options = room_options(-1.5, 0.1);
    make_room(room);
    if (!start_walk(&v, &options, room, 0))
        return;
    CHECK(walk_is_on(&v) && eye_is(&v, -1.5, -1.25, 0.1, 0.1));    /* the height of the view above the ground */
    CHECK(fabs(v.walk.walker.height - 1.2) < 0.1 && v.view.rotation[6] > 0.999);
    for (int i = 0; i < 40; i++)
        wheel(&v, 1);
    CHECK(eye_is(&v, 2.75, -1.25, 0.1, 0.2));                      /* through the door, to the wall */
    drag(&v, SDL_BUTTON_LMASK, 48, 0);                            /* half a turn */
    CHECK(v.view.rotation[6] < -0.99 && eye_is(&v, 2.75, -1.25, 0.1, 0.2));
    wheel(&v, -3);
    key(&v, 'r');
    CHECK(eye_is(&v, -1.5, -1.2, 0.1, 1e-9) && walk_is_on(&v));    /* the view again; the next step stands there */
    wheel(&v, 1);
    CHECK(walk_is_on(&v) && eye_is(&v, -0.9, -1.25, 0.1, 0.5));
    key(&v, '1');
    CHECK(!walk_is_on(&v));
    const double low = v.view.position[0];
    wheel(&v, 1);
    CHECK(v.view.position[0] > low);
    key(&v, '3');
    CHECK(walk_is_on(&v));
    key(&v, SDLK_ESCAPE);
    CHECK(!walk_is_on(&v) && !v.quit);
    snprintf(file, sizeof file, "%s/room.voxel.json", folder);
    CHECK(!fxs_voxels_write(v.walk.voxels, file, &m));
    push_drop(knot);
    settle(&v);
    CHECK(!v.walk.voxels && !v.walk.file && !strcmp(v.path, knot));
    viewer_close(&v);

    options = room_options(-1.5, 1.2);
    if (!start_walk(&v, &options, room, file))
        return;
    for (int i = 0; i < 40; i++)
        wheel(&v, 1);
    CHECK(walk_is_on(&v) && eye_is(&v, -0.25, -1.25, 1.2, 0.2));   /* the wall beside the door */
    viewer_close(&v);
}

static void test_no_walk(void)
{
    static char room[64];
    viewer v;
    frame_options options = room_options(-1.5, 0);
    make_room(room);
    options.eye.at[1] = 40;
    options.look.at[1] = 41;
    if (!start_walk(&v, &options, room, 0))
        return;
    CHECK(!walk_is_on(&v) && strstr(v.note, "no room to stand here"));
    viewer_close(&v);
    options = room_options(-1.5, 0);
    if (!start_walk(&v, &options, room, "none.voxel.json"))
        return;
    CHECK(!walk_is_on(&v) && strstr(v.note, "none.voxel.json: No such file") && !v.quit);
    viewer_close(&v);
    options.ortho = 3;
    if (!start_walk(&v, &options, room, 0))
        return;
    CHECK(!walk_is_on(&v) && strstr(v.note, "needs perspective"));
    viewer_close(&v);
    options = room_options(-1.5, 0);
    if (!CHECK(!open_file(&v, &options, room, 0)))
        return;
    settle(&v);
    push_key('3'), push_key('1');                                  /* ended while walls are made */
    settle(&v);
    CHECK(!walk_is_on(&v) && !walk_is_making(&v));
    push_key('3');
    viewer_step(&v, 0);
    push_drop(knot);                                               /* another scene meanwhile */
    settle(&v);
    CHECK(!walk_is_on(&v) && !strcmp(v.path, knot));
    push_key('3');
    viewer_step(&v, 0);
    viewer_close(&v);                                              /* closed meanwhile */
}

/* ------------------------------------------------------------------------------------------------------------------ */

static int fails_to_open(const frame_options *options, const char *path)
{
    viewer v;
    if (!CHECK(!open_file(&v, options, path, 0)))
        return 0;
    settle(&v);
    viewer_close(&v);
    return v.quit && v.status == EXIT_FAILED;
}

static void test_failures_to_open(void)
{
    viewer v;
    frame_options options = small_options();
    CHECK(fails_to_open(&options, junk));
    options.cameras = junk;
    CHECK(fails_to_open(&options, knot));
    options.cameras = cameras;
    options.view = "fourth";
    CHECK(fails_to_open(&options, knot));
    options = small_options();
    options.max_memory = 1;
    CHECK(fails_to_open(&options, knot));
    setenv("SDL_VIDEODRIVER", "none", 1);
    options = small_options();
    CHECK(open_file(&v, &options, knot, 0) == EXIT_FAILED);
    setenv("SDL_VIDEODRIVER", "dummy", 1);
}

/* ---- Options of the command ------------------------------------------------------------------------------------- */

static char levels[64];
static int tried_options, refused_options;

/* Options of `fixsplat view` with a value; null: no value. */
static const struct {
    const char *name, *value;
} of_window[] = {
    {"cameras", cameras}, {"view", "1"}, {"eye", "1,-2,-9"}, {"look", "0,1,0"}, {"up", "0.3,-1,0"}, {"auto-up", 0},
    {"fov", "30"}, {"tangents", "-1,1.2,1,-1"}, {"ortho", "3"}, {"near", "7"}, {"size", "60x30"}, {"stereo", "0.2"},
    {"place", "0:0,0,0,0.5,0.5,0.5,0.5"}, {"scene", "none.json"}, {"bg", "303030"}, {"cutoff", "square"},
    {"sh-degree", "0"}, {"device", "1"}, {"profile", "small"}, {"budget", "100"}, {"detail", "9"}, {"lod", "1"},
    {"axes", "rdf"}, {"pool", "1M"}, {"fps", "30"}, {"no-open", 0}, {"qr", 0}, {"levels", 0}, {"port", "1"},
    {"bind", "::1"}, {"host", "here"}, {"cert", "a.pem"}, {"key", "a.pem"}, {"metres-per-unit", "2"},
    {"pass-through", 0}, {"time", "1"}, {"rate", "25"}
};

static uint64_t sum_of(uint64_t sum, const void *data, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        sum = (sum ^ ((const uint8_t *)data)[i]) * 1099511628211u;
    return sum;
}

/* Opens the window of a command line. Returns a sum of its picture and directions; 0: the command line is refused. */
static uint64_t opened(const char *const *place, int count, const char *option, const char *value)
{
    static view_options o;
    char *words[8] = {0};
    viewer v;
    uint64_t sum = 0;
    memcpy(words, place, (size_t)count * sizeof *words);
    words[count] = (char *)(uintptr_t)option;
    words[count + 1] = (char *)(uintptr_t)value;
    optind = 1;
    if (view_options_take(&o, count + !!option + !!value, words) || viewer_open(&v, &o.frame, o.screenshot, o.rate))
        return 0;
    settle(&v);
    if (!v.quit) {
        sum = sum_of(1, v.picture.pixels, 4 * (size_t)v.picture.width * (size_t)v.picture.height);
        sum = sum_of(sum_of(sum, &v.view.near, sizeof v.view.near), v.up, sizeof v.up);
    }
    viewer_close(&v);
    return sum;
}

static int is_row_tried(const option_row *row)
{
    static const char by_design[] = " screenshot walls eye-height web xr threads max-memory cpu backend max-gaussians "
                                    "import-memory ";
    char name[40];
    snprintf(name, sizeof name, " %s ", row->name);
    int found = strstr(by_design, name) != 0;
    for (size_t i = 0; i < sizeof of_window / sizeof *of_window; i++)
        found |= !strcmp(of_window[i].name, row->name);
    return found;
}

/* Each option but those of `kept` changes the window of a place, or is refused. */
static void try_options(int count, const char *const *place, const char *kept)
{
    const uint64_t plain = opened(place, count, 0, 0);
    CHECK(plain);
    for (size_t i = 0; i < sizeof of_window / sizeof *of_window; i++) {
        char option[40], name[40];
        snprintf(option, sizeof option, "--%s", of_window[i].name);
        snprintf(name, sizeof name, " %s ", of_window[i].name);
        if (!strcmp(option, place[2]) || strstr(kept, name))
            continue;
        const uint64_t sum = opened(place, count, option, of_window[i].value);
        tried_options++;
        refused_options += !sum;
        if (!CHECK(sum != plain))
            printf("no effect: %s with %s\n", option, place[count - 1]);
    }
}

static void test_options_change_the_window_or_are_refused(void)
{
    const char *const of_floats[] = {"view", knot, "--size", "64x48"},
               *const of_levels[] = {"view", levels, "--size", "64x48"},
               *const of_cameras[] = {"view", knot, "--cameras", cameras},
               *const of_eye[] = {"view", knot, "--eye", "0,-2,-9"};
    char *arguments[] = {"convert", knot, levels, "--levels", "--quiet", 0};
    snprintf(levels, sizeof levels, "%s/levels.fxs", folder);
    optind = 1;
    CHECK(command_convert.run(5, arguments) == EXIT_OK);
    for (const option_table *t = command_view.tables; t->rows != common_rows; t++)
        for (const option_row *row = t->rows; row->help; row++)
            if (row->name && !CHECK(is_row_tried(row)))
                printf("not tried: %s\n", row->name);
    try_options(4, of_floats, " auto-up ");             /* the scene is upright */
    try_options(4, of_levels, " auto-up fps pool ");    /* they change pictures in motion, and memory */
    try_options(4, of_cameras, "");
    try_options(4, of_eye, " auto-up ");
    printf("%d pairs of an option and a place, %d refused\n", tried_options, refused_options);
}

static void test_a_dropped_file_takes_options_as_far_as_they_apply(void)
{
    static view_options o;
    char *words[] = {"view", levels, "--budget", "100", "--size", "64x48", 0};
    viewer v;
    optind = 1;
    if (!CHECK(!view_options_take(&o, 6, words) && !viewer_open(&v, &o.frame, 0, 0)))
        return;
    settle(&v);
    drop(&v, cubes);
    CHECK(!v.quit && v.world.gaussians == 300);
    viewer_close(&v);
}

static void test_files_are_made(void)
{
    static const char view[] = "{\"id\": 0, \"img_name\": \"%s\", \"width\": 80, \"height\": 60, \"fx\": 70, "
                               "\"fy\": 70, \"position\": [0, 0, %d], "
                               "\"rotation\": [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]]}%c\n";
    char text[1024], *end = text;
    *end++ = '[';
    end += sprintf(end, view, "first", -8, ',');
    end += sprintf(end, view, "second", -9, ',');
    sprintf(end, view, "third", -10, ']');
    write_text(cameras, "cameras.json", text);
    write_text(junk, "junk.ply", "ply\nnot a scene\n");
    make_scene(knot, "knot", "knot", "2000");
    make_scene(cubes, "cubes", "cubes", "300");
    snprintf(shot, sizeof shot, "%s/shot.png", folder);
}
#endif

int main(void)
{
    RUN(test_orbit_keeps_the_pivot);
    RUN(test_orbit_stops_at_the_poles);
    RUN(test_poles_let_go);
    RUN(test_look_turns_in_place);
    RUN(test_pan_follows_the_pointer);
    RUN(test_zoom_keeps_the_pivot);
    RUN(test_parallel_rays);
    RUN(test_height_stays);
    RUN(test_fly_along_the_axes);
    RUN(test_rotations_stay_rotations);
    RUN(test_rectangles_are_clipped);
    RUN(test_lines);
    RUN(test_panels_have_round_corners);
    RUN(test_depths_have_colours);
    RUN(test_ids_have_colours);
    RUN(test_words);
    RUN(test_graph_shows_the_times);
#ifdef FXS_WITH_SDL
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    char *whole = mkdtemp(folder) ? fxs_path_whole(folder) : 0;
    if (!whole)
        return 1;
    snprintf(folder, sizeof folder, "%s", whole);
    free(whole);
    snprintf(state, sizeof state, "%s/state", folder);
#ifdef _WIN32
    mkdir(state, 0700);   /* Windows itself makes this folder for programs; here the test must make it */
#endif
    setenv(KEPT_BELOW, state, 1);
    RUN(test_files_are_made);
    RUN(test_keys);
    RUN(test_motion_is_coarse_then_full);
    RUN(test_zoom_stays_in_range);
    RUN(test_frame_is_stopped);
    RUN(test_dropped_files);
    RUN(test_views_of_a_file);
    RUN(test_objects);
    RUN(test_resized_window);
    RUN(test_screenshot);
    RUN(test_numbered_screenshots);
    RUN(test_films);
    RUN(test_playing);
    RUN(test_time_bar);
    RUN(test_empty_window);
    RUN(test_events_while_loading);
    RUN(test_depths_and_ids);
    RUN(test_focus);
    RUN(test_measure);
    RUN(test_crop);
    RUN(test_edits);
    RUN(test_object);
    RUN(test_crop_handles);
    RUN(test_crop_of_objects);
    RUN(test_crop_not_written);
    RUN(test_recent);
    RUN(test_recent_by_click);
    RUN(test_recent_list);
    RUN(test_fine_pixels);
    RUN(test_speed);
    RUN(test_two_eyes);
    RUN(test_levels);
    RUN(test_rate);
    RUN(test_pool);
    RUN(test_tangents);
    RUN(test_walk);
    RUN(test_no_walk);
    RUN(test_options_change_the_window_or_are_refused);
    RUN(test_a_dropped_file_takes_options_as_far_as_they_apply);
    RUN(test_failures_to_open);
    remove(shot), remove(knot), remove(cubes), remove(junk), remove(cameras);
    snprintf(cubes, sizeof cubes, "%s/state/fixsplat/recent", folder);
    remove(cubes), fxs_folder_remove(dirname(cubes)), fxs_folder_remove(state), fxs_folder_remove(folder);
#else
    printf("  the viewer's tests are left out: built without SDL2\n");
    check_skipped++;
#endif
    return check_report();
}
