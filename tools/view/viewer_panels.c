/* Draws text, panels and marks over the rendered frame in the window. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "port/window/words.h"
#include "tools/command/cmd_view.h"
#include "viewer.h"

enum { PANELS_MOST = 14, KEYS_MOST = 64, SMALLEST = 7 };    /* SMALLEST: least font size in pixels */

typedef struct panels {
    fxs_panel list[PANELS_MOST];
    int count;
    int width, height, scale;               /* size of the window in pixels; pixels per point (unit of sizes) */
    const fxs_theme *theme;
    fxs_words *words;
} panels;

static fxs_panel *add(panels *p, int x, int y, int width, int height, int radius, uint32_t colour)
{
    if (p->count == PANELS_MOST || fxs_panel_make(&p->list[p->count], x, y, width, height, radius, colour))
        return 0;
    return &p->list[p->count++];
}

enum place { TOP_RIGHT, MIDDLE, BOTTOM_LEFT, BOTTOM, BOTTOM_RIGHT };

/* Adds a panel with a line of text, in the largest font size that fits. */
static void add_words(panels *p, enum place place, const char *text)
{
    const int pad = 10 * p->scale, edge = 12 * p->scale, room = p->width - 2 * (pad + edge);
    int size = 14 * p->scale;
    for (fxs_words_resize(p->words, size); size > SMALLEST && fxs_words_width(p->words, text) > room;)
        fxs_words_resize(p->words, --size);
    const int width = fxs_words_width(p->words, text) + 2 * pad, height = fxs_words_line(p->words) + pad;
    if (width == 2 * pad)
        return;
    const int is_right = place == TOP_RIGHT || place == BOTTOM_RIGHT;
    const int x = is_right ? p->width - width - edge : place == BOTTOM_LEFT ? edge : (p->width - width) / 2;
    const int y = place == TOP_RIGHT ? edge : place == MIDDLE ? (p->height - height) / 2 : p->height - height - edge;
    const fxs_panel *panel = add(p, x, y, width, height, 8 * p->scale, p->theme->panel);
    if (panel)
        fxs_draw_words(p->words, &panel->picture, pad, pad / 2, text, p->theme->words);
}

typedef struct key_line {
    char key[32], does[96];
} key_line;

typedef struct key_table {
    int size, line, pad, rows, columns, key_width, column_width, width, height, left, top;
} key_table;

static key_table lay_out(const panels *p, const key_line *lines, int count, int size)
{
    key_table t = {.size = size, .pad = size};
    fxs_words_resize(p->words, size);
    t.line = fxs_words_line(p->words) + (size - 6) / 4;
    for (int i = 0; i < count; i++) {
        const int key = fxs_words_width(p->words, lines[i].key), does = fxs_words_width(p->words, lines[i].does);
        t.key_width = key > t.key_width ? key : t.key_width;
        t.column_width = does > t.column_width ? does : t.column_width;
    }
    t.key_width += size;
    t.column_width += t.key_width + 2 * size;
    const int most = (p->height - 2 * t.pad) / (t.line > 0 ? t.line : 1);
    t.rows = most < 1 ? 1 : most < count ? most : count;
    t.columns = (count + t.rows - 1) / t.rows;
    t.rows = (count + t.columns - 1) / t.columns;
    t.width = t.columns * t.column_width;
    t.height = t.rows * t.line + 2 * t.pad;
    t.left = t.width < p->width ? (p->width - t.width) / 2 : 0;
    t.top = t.height < p->height ? (p->height - t.height) / 2 : 0;
    return t;
}

static key_table lay_out_to_fit(const panels *p, const key_line *lines, int count)
{
    key_table t = lay_out(p, lines, count, 14 * p->scale);
    while (t.size > SMALLEST && (t.width > p->width || t.height > p->height))
        t = lay_out(p, lines, count, t.size - 1);
    return t;
}

static void add_list(panels *p, const key_line *lines, int count, int marked)
{
    const key_table t = lay_out_to_fit(p, lines, count);
    const fxs_panel *panel = p->words ? add(p, t.left, t.top, t.width, t.height, 8 * p->scale, p->theme->panel) : 0;
    for (int i = 0; i < count && panel; i++) {
        const int x = i / t.rows * t.column_width + t.pad, y = i % t.rows * t.line + t.pad;
        fxs_draw_words(p->words, &panel->picture, x, y, lines[i].key, p->theme->mark);
        fxs_draw_words(p->words, &panel->picture, x + t.key_width, y, lines[i].does,
                       i == marked ? p->theme->mark : p->theme->words);
    }
}

static void add_help(panels *p)
{
    key_line lines[KEYS_MOST];
    int count = 0;
    for (const char *line = viewer_keys; *line && count < KEYS_MOST; count++) {
        const char *end = strchr(line, '\n'), *gap = strstr(line, "  ");
        const char *does = gap + strspn(gap, " ");
        snprintf(lines[count].key, sizeof lines->key, "%.*s", (int)(gap - line), line);
        snprintf(lines[count].does, sizeof lines->does, "%.*s", (int)(end - does), does);
        line = end + 1;
    }
    add_list(p, lines, count, -1);
}

const char *viewer_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

/* Lists recent scenes: a heading, then a line with key, name and folder for each scene. */
static int list_recent(const viewer *v, key_line lines[FXS_RECENT_MOST + 1])
{
    enum { FOLDER = 40 };
    lines[0] = (key_line){"", "Drop a scene here, or open one again:"};
    for (int i = 0; i < v->recent.count; i++) {
        const char *path = v->recent.paths[i], *name = viewer_file_name(path);
        const int folder = (int)(name - path), cut = folder > FOLDER;
        snprintf(lines[i + 1].key, sizeof lines->key, "%d", (i + 1) % 10);
        snprintf(lines[i + 1].does, sizeof lines->does, "%.40s   %s%.*s", name, cut ? "..." : "",
                 cut ? FOLDER : folder, cut ? name - FOLDER : path);
    }
    return v->recent.count + 1;
}

static panels panels_of(const viewer *v)
{
    panels p = {.theme = v->light ? &fxs_light : &fxs_dark, .words = v->words};
    fxs_window_size(v->window, &p.width, &p.height);
    p.scale = (int)lround(fxs_window_scale(v->window));
    return p;
}

int viewer_recent_at(const viewer *v, double x, double y)
{
    key_line lines[FXS_RECENT_MOST + 1];
    const panels p = panels_of(v);
    const int count = list_recent(v, lines);
    const key_table t = lay_out_to_fit(&p, lines, count);
    const double row = floor((y - t.top - t.pad) / (t.line > 0 ? t.line : 1));
    const double column = floor((x - t.left) / t.column_width);
    if (!v->words || row < 0 || row >= t.rows || column < 0 || column >= t.columns)
        return -1;
    const int i = (int)(column * t.rows + row) - 1;
    return i < v->recent.count ? i : -1;
}

static void add_recent(panels *p, const viewer *v)
{
    key_line lines[FXS_RECENT_MOST + 1];
    if (v->recent.count)
        add_list(p, lines, list_recent(v, lines), v->recent_marked + 1);
    else
        add_words(p, MIDDLE, "Drop a scene here");
}

static void add_bar(panels *p, double done)
{
    const int width = p->width / 3, height = 6 * p->scale, y = p->height / 2 + 28 * p->scale;
    const fxs_panel *panel = add(p, (p->width - width) / 2, y, width, height, 0, p->theme->panel);
    if (panel)
        fxs_draw_rectangle(&panel->picture, 0, 0, (int)(width * fmin(done, 1)), height, p->theme->mark);
}

static void add_loading(panels *p, const viewer *v)
{
    const world_options *o = &v->loading.options.world;
    const char *path = !v->loading.on ? v->path : v->loading.path ? v->loading.path : o->file ? o->file : o->scenes[0];
    char text[256];
    snprintf(text, sizeof text, "Opening %.200s", viewer_file_name(path));
    add_words(p, MIDDLE, text);
    add_bar(p, v->loading.on ? fxs_worker_progress(v->loader) : 1);
}

static void see(const fxs_view *view, const double point[3], double seen[3])
{
    for (int i = 0; i < 3; i++) {
        seen[i] = 0;
        for (int k = 0; k < 3; k++)
            seen[i] += view->rotation[3 * i + k] * (point[k] - view->position[k]);
    }
}

static void pixel_of(const fxs_view *view, const double seen[3], double pixels, double pixel[2])
{
    const double depth = view->projection == FXS_ORTHOGRAPHIC ? 1 : seen[2];
    pixel[0] = (view->cx + view->fx * seen[0] / depth) * pixels;
    pixel[1] = (view->cy + view->fy * seen[1] / depth) * pixels;
}

static double pixels_of(const viewer *v)
{
    int width, height;
    fxs_window_size(v->window, &width, &height);
    return (double)height / v->seen.height;
}

int viewer_project(const viewer *v, const double point[3], double pixel[2])
{
    double seen[3];
    see(&v->seen, point, seen);
    if (seen[2] <= 0)
        return 0;
    pixel_of(&v->seen, seen, pixels_of(v), pixel);
    return fabs(pixel[0]) < 1e5 && fabs(pixel[1]) < 1e5;
}

/* Draws the measured distance: a line with a dot at each end. */
static void add_measure(panels *p, const viewer *v)
{
    const int wide = 3 * p->scale, dot = 9 * p->scale;
    double ends[2][2], low[2], high[2];
    for (int i = 0; i < v->ends; i++)
        if (!viewer_project(v, v->end[i], ends[i]))
            return;
    for (int k = 0; k < 2; k++) {
        const double a = ends[0][k], b = ends[v->ends - 1][k], room = k ? p->height : p->width;
        low[k] = fmax(fmin(a, b) - dot, 0);
        high[k] = fmin(fmax(a, b) + dot, room);
        if (low[k] >= high[k])
            return;
    }
    const fxs_panel *panel = add(p, (int)low[0], (int)low[1], (int)(high[0] - low[0]), (int)(high[1] - low[1]), 0, 0);
    if (!panel)
        return;
    for (int i = 0; i < v->ends; i++) {
        ends[i][0] -= panel->x;
        ends[i][1] -= panel->y;
    }
    if (v->ends == 2) {
        fxs_draw_line(&panel->picture, ends[0], ends[1], wide + 2 * p->scale, 0x000000a0);
        fxs_draw_line(&panel->picture, ends[0], ends[1], wide, 0xffffffff);
    }
    for (int i = 0; i < v->ends; i++)
        fxs_draw_line(&panel->picture, ends[i], ends[i], dot, 0xffb020ff);
}

/* Clips a line in camera coordinates to the near plane and the four sides of the view. A point p is inside a plane if n
   p + d >= 0. Returns 0 if nothing is left. */
static int clip(const fxs_view *view, double near, double from[3], double to[3])
{
    const int parallel = view->projection == FXS_ORTHOGRAPHIC;
    const double left = view->cx, right = view->width - view->cx, top = view->cy, bottom = view->height - view->cy;
    const double planes[5][4] = {{0, 0, 1, -near}, {view->fx, 0, parallel ? 0 : left, parallel ? left : 0},
                                 {-view->fx, 0, parallel ? 0 : right, parallel ? right : 0},
                                 {0, view->fy, parallel ? 0 : top, parallel ? top : 0},
                                 {0, -view->fy, parallel ? 0 : bottom, parallel ? bottom : 0}};
    double first = 0, last = 1;
    for (int i = 0; i < 5; i++) {
        const double *n = planes[i], a = n[0] * from[0] + n[1] * from[1] + n[2] * from[2] + n[3];
        const double b = n[0] * to[0] + n[1] * to[1] + n[2] * to[2] + n[3];
        if (a < 0 && b < 0)
            return 0;
        if (a < 0)
            first = fmax(first, a / (a - b));
        else if (b < 0)
            last = fmin(last, a / (a - b));
    }
    for (int i = 0; i < 3; i++) {
        const double start = from[i], way = to[i] - from[i];
        from[i] = start + first * way;
        to[i] = start + last * way;
    }
    return first < last;
}

/* Draws an edge of the crop box from a corner along an axis. Bit i of `corner` selects the high side of axis i. */
static void draw_edge(const fxs_canvas *out, const viewer *v, int corner, int axis, double wide, uint32_t colour)
{
    double ends[2][3], seen[2][3], pixel[2][2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3; i++)
            ends[k][i] = (corner | k << axis) & 1 << i ? v->crop.high[i] : v->crop.low[i];
        see(&v->seen, ends[k], seen[k]);
    }
    if (!clip(&v->seen, 1e-3 * v->radius, seen[0], seen[1]))
        return;
    for (int k = 0; k < 2; k++)
        pixel_of(&v->seen, seen[k], pixels_of(v), pixel[k]);
    fxs_draw_line(out, pixel[0], pixel[1], wide, colour);
}

/* Adds the crop box with a handle on each face: red for x, green for y, blue for z. */
static void add_crop(panels *p, const viewer *v)
{
    static const uint32_t colours[3] = {0xe5484dff, 0x46a758ff, 0x3b82f6ff};
    const fxs_panel *panel = add(p, 0, 0, p->width, p->height, 0, 0);
    double point[3], pixel[2];
    for (int i = 0; i < 48 && panel; i++) {
        const int axis = i / 8 % 3, corner = i % 8, is_line = i >= 24;
        if (!(corner & 1 << axis))
            draw_edge(&panel->picture, v, corner, axis, (is_line ? 1 : 3) * p->scale,
                      is_line ? 0xffffffff : 0x00000080);
    }
    for (int face = 0; face < CROP_FACES && panel; face++) {
        const int size = (face == v->face ? 18 : 12) * p->scale;
        crop_handle(&v->crop, face, point);
        if (!viewer_project(v, point, pixel))
            continue;
        fxs_draw_line(&panel->picture, pixel, pixel, size + 4 * p->scale, 0xffffffff);
        fxs_draw_line(&panel->picture, pixel, pixel, size, colours[face / 2]);
    }
}

/* Draws the box around an object. */
static void draw_box(const panels *p, const editing *e, const fxs_panel *panel)
{
    const double *a = e->stroke[0], *b = e->stroke[e->stroke_count - 1];
    const double corners[4][2] = {{a[0], a[1]}, {b[0], a[1]}, {b[0], b[1]}, {a[0], b[1]}};
    for (int i = 0; i < 4; i++)
        fxs_draw_line(&panel->picture, corners[i], corners[(i + 1) % 4], 2 * p->scale, 0xff7d3dff);
}

/* Draws the stroke of a tool. */
static void add_stroke(panels *p, const viewer *v)
{
    const editing *e = &v->edit;
    const int is_lasso = e->tool == EDIT_LASSO;
    const fxs_panel *panel = add(p, 0, 0, p->width, p->height, 0, 0);
    if (panel && e->tool == EDIT_OBJECT) {
        draw_box(p, e, panel);
        return;
    }
    for (int i = 0; i < e->stroke_count && panel; i++)
        fxs_draw_line(&panel->picture, e->stroke[i], e->stroke[is_lasso ? (i + 1) % e->stroke_count : i ? i - 1 : 0],
                      is_lasso ? 2 * p->scale : 2 * edit_brush(v), is_lasso ? 0xff7d3dff : 0xff7d3d80);
}

static void add_graph(panels *p, const viewer *v)
{
    const fxs_panel *panel = add(p, 12 * p->scale, 12 * p->scale, FXS_GRAPH_WIDTH * p->scale,
                                 FXS_GRAPH_HEIGHT * p->scale, 8 * p->scale, p->theme->panel);
    if (panel)
        fxs_draw_frame_times(&panel->picture, &v->times, p->scale, p->theme, p->words);
}

static void add_rate(panels *p, const viewer *v)
{
    char text[160];
    int used = snprintf(text, sizeof text, "%.0f frames/s", v->times.frame > 0 ? 1000 / v->times.frame : 0);
    if (v->path && has_levels(&v->world))
        used += snprintf(text + used, sizeof text - (size_t)used, ", %.3g of %.3g million Gaussians",
                         v->gaussians * 1e-6, v->world.gaussians * 1e-6);
    if (v->rate_wanted > 0)
        used += snprintf(text + used, sizeof text - (size_t)used, ", %s", fxs_pace_why(v->pace.reason));
    if (v->missing)
        snprintf(text + used, sizeof text - (size_t)used, ", %" PRIu32 " chunks are missing", v->missing);
    add_words(p, TOP_RIGHT, text);
}

static void add_slider(panels *p, const viewer *v)
{
    const double most = viewer_budget_most(v), budget = v->options.render.budget ? v->options.render.budget : most;
    const int width = p->width / 3, height = 6 * p->scale, y = p->height - 56 * p->scale;
    const double part = most > BUDGET_LEAST ? log(budget / BUDGET_LEAST) / log(most / BUDGET_LEAST) : 1;
    char text[80];
    snprintf(text, sizeof text, "%s: %.3g million Gaussians", v->options.render.budget ? "budget" : "no budget",
             budget * 1e-6);
    add_words(p, BOTTOM, text);
    const fxs_panel *panel = add(p, (p->width - width) / 2, y, width, height, 0, p->theme->panel);
    if (panel)
        fxs_draw_rectangle(&panel->picture, 0, 0, (int)(width * fmin(fmax(part, 0), 1)), height, p->theme->mark);
}

static void add_time(panels *p, const viewer *v)
{
    char text[80];
    int bar[4];
    play_words(v, text, sizeof text);
    add_words(p, BOTTOM_RIGHT, text);
    play_bar(v, bar);
    const fxs_panel *panel = add(p, bar[0], bar[1], bar[2], bar[3], 0, p->theme->panel);
    if (panel)
        fxs_draw_rectangle(&panel->picture, 0, 0, (int)(bar[2] * v->play.at / v->play.time.duration), bar[3],
                           p->theme->mark);
}

static void add_all(panels *p, const viewer *v)
{
    if (v->measuring && v->ends && v->seen.width)
        add_measure(p, v);
    if (v->crop.on && v->seen.width)
        add_crop(p, v);
    if (v->edit.stroke_count)
        add_stroke(p, v);
    if (v->graph)
        add_graph(p, v);
    if (v->rate)
        add_rate(p, v);
    if (v->loading.on || (v->path && !v->seen.width))
        add_loading(p, v);
    else if (v->film == FILM_WRITTEN || v->crop_written) {
        add_words(p, MIDDLE, v->crop_written ? "Writing the scene; escape drops it" : "Writing the film; k drops it");
        add_bar(p, fxs_worker_progress(v->drawer));
    } else if (walk_is_making(v)) {
        add_words(p, MIDDLE, "Making walls; 1 drops them");
        add_bar(p, v->walk.state == WALK_MAKING ? fxs_worker_progress(v->walk.maker) : 0);
    } else if (!v->path && !v->help)
        add_recent(p, v);
    if (v->slider && v->path)
        add_slider(p, v);
    if (play_moves(v))
        add_time(p, v);
    if (v->help)
        add_help(p);
    if (*v->note)
        add_words(p, BOTTOM_LEFT, v->note);
    else if (v->film == FILM_TAKEN)
        add_words(p, BOTTOM_LEFT, "filming; k writes the film");
    else if (walk_is_on(v) && !v->crop.on && !v->help)
        add_words(p, BOTTOM_LEFT, "walking: w a s d or the arrows; 1 ends it");
    else if (v->crop.on)
        add_words(p, BOTTOM_LEFT, "drag a handle; enter: write what is in the box, c: leave it");
    else if (v->hint && !v->help)
        add_words(p, BOTTOM_LEFT, "h: keys");
}

static void show_title(viewer *v)
{
    char title[1024];
    if (!v->path)
        snprintf(title, sizeof title, "fixsplat%s%s", *v->note ? " - " : "", v->note);
    else
        snprintf(title, sizeof title, "%.200s - %s (%ld of %ld) - %s, SH %d, %s, 1/%d - %.1f ms%s%s",
                 viewer_file_name(v->path), v->view.name, v->index + 1, v->view_count,
                 cutoff_names[v->options.render.cutoff], v->options.render.sh_degree, v->options.backend,
                 v->coarse ? v->divisor : 1, v->times.frame, *v->note ? " - " : "", v->note);
    fxs_window_title(v->window, title);
}

int viewer_show(viewer *v)
{
    const fxs_canvas frame = {v->picture.pixels, v->picture.width, v->picture.height};
    fxs_message message;
    panels p = panels_of(v);
    add_all(&p, v);
    const fxs_canvas *below = v->seen.width && v->picture.pixels ? &frame : 0;
    int failed = v->screen && fxs_screen_show(v->screen, v->on_screen, below, p.theme->window, p.list, p.count,
                                              &message);
    if (failed) {
        fail(0, "--backend vulkan: %s", message.text);
        lose_screen(v);
    }
    if (!v->screen)
        failed = fxs_window_show(v->window, v->on_screen ? 0 : below, p.theme->window, p.list, p.count, &message);
    for (int i = 0; i < p.count; i++)
        fxs_panel_free(&p.list[i]);
    show_title(v);
    return failed ? fail_for(&message) : 0;
}
