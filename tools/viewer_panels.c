/* What lies over the picture in the window. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../port/window/words.h"
#include "view.h"
#include "viewer.h"

enum { PANELS_MOST = 12, KEYS_MOST = 64 };

typedef struct panels {
    fxs_panel list[PANELS_MOST];
    int count;
    int width, height, scale;               /* of the window, pixels; pixels a point */
    const fxs_theme *theme;
    fxs_words *words;
} panels;

/* Returns the panel, or null where there is no room. */
static fxs_panel *add(panels *p, int x, int y, int width, int height, int radius, uint32_t colour)
{
    if (p->count == PANELS_MOST || fxs_panel_make(&p->list[p->count], x, y, width, height, radius, colour))
        return 0;
    return &p->list[p->count++];
}

enum place { TOP_RIGHT, MIDDLE, BOTTOM_LEFT };

/* A line of words on a panel; nothing without words. */
static void add_words(panels *p, enum place place, const char *text)
{
    const int pad = 10 * p->scale, edge = 12 * p->scale;
    fxs_words_resize(p->words, 14 * p->scale);
    const int width = fxs_words_width(p->words, text) + 2 * pad, height = fxs_words_line(p->words) + pad;
    if (width == 2 * pad)
        return;
    const int x = place == TOP_RIGHT ? p->width - width - edge : place == MIDDLE ? (p->width - width) / 2 : edge;
    const int y = place == TOP_RIGHT ? edge : place == MIDDLE ? (p->height - height) / 2 : p->height - height - edge;
    const fxs_panel *panel = add(p, x, y, width, height, 8 * p->scale, p->theme->panel);
    if (panel)
        fxs_draw_words(p->words, &panel->picture, pad, pad / 2, text, p->theme->words);
}

/* ---- Help -------------------------------------------------------------------------------------------------------- */

/* A key and what it does, from a line of viewer_keys. */
typedef struct key_line {
    char key[32], does[64];
} key_line;

static int read_keys(key_line lines[KEYS_MOST])
{
    int count = 0;
    for (const char *line = viewer_keys; *line && count < KEYS_MOST; count++) {
        const char *end = strchr(line, '\n'), *gap = strstr(line, "  ");
        const char *does = gap + strspn(gap, " ");
        snprintf(lines[count].key, sizeof lines->key, "%.*s", (int)(gap - line), line);
        snprintf(lines[count].does, sizeof lines->does, "%.*s", (int)(end - does), does);
        line = end + 1;
    }
    return count;
}

/* How the lines lie on a panel, in words of one size. */
typedef struct key_table {
    int size, line, pad, rows, columns, key_width, column_width, width, height;
} key_table;

/* In as few columns as the height of the window allows. */
static key_table lay_out(const panels *p, const key_line *lines, int count, int size)
{
    key_table t = {.size = size, .pad = size};
    fxs_words_resize(p->words, size);
    t.line = fxs_words_line(p->words) + size / 6;
    for (int i = 0; i < count; i++) {
        const int key = fxs_words_width(p->words, lines[i].key), does = fxs_words_width(p->words, lines[i].does);
        t.key_width = key > t.key_width ? key : t.key_width;
        t.column_width = does > t.column_width ? does : t.column_width;
    }
    t.key_width += size;
    t.column_width += t.key_width + 2 * size;
    const int most = (p->height - 4 * t.pad) / (t.line > 0 ? t.line : 1);
    t.rows = most < 1 ? 1 : most < count ? most : count;
    t.columns = (count + t.rows - 1) / t.rows;
    t.rows = (count + t.columns - 1) / t.columns;
    t.width = t.columns * t.column_width;
    t.height = t.rows * t.line + 2 * t.pad;
    return t;
}

/* The keys, smaller until they fit. */
static void add_help(panels *p)
{
    key_line lines[KEYS_MOST];
    const int count = read_keys(lines);
    key_table t = lay_out(p, lines, count, 14 * p->scale);
    while (t.size > 7 && (t.width > p->width || t.height > p->height))
        t = lay_out(p, lines, count, t.size - 1);
    const int left = t.width < p->width ? (p->width - t.width) / 2 : 0;
    const int top = t.height < p->height ? (p->height - t.height) / 2 : 0;
    const fxs_panel *panel = p->words ? add(p, left, top, t.width, t.height, 8 * p->scale, p->theme->panel) : 0;
    for (int i = 0; i < count && panel; i++) {
        const int x = i / t.rows * t.column_width + t.pad, y = i % t.rows * t.line + t.pad;
        fxs_draw_words(p->words, &panel->picture, x, y, lines[i].key, p->theme->mark);
        fxs_draw_words(p->words, &panel->picture, x + t.key_width, y, lines[i].does, p->theme->words);
    }
}

/* ---- Others ------------------------------------------------------------------------------------------------------ */

static void add_bar(panels *p, double done)
{
    const int width = p->width / 3, height = 6 * p->scale, y = p->height / 2 + 28 * p->scale;
    const fxs_panel *panel = add(p, (p->width - width) / 2, y, width, height, 0, p->theme->panel);
    if (panel)
        fxs_draw_rectangle(&panel->picture, 0, 0, (int)(width * fmin(done, 1)), height, p->theme->mark);
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

/* Until there is a picture of it. */
static void add_loading(panels *p, const viewer *v)
{
    const world_options *o = &v->loading.options.world;
    const char *path = !v->loading.on ? v->path : v->loading.path ? v->loading.path : o->file ? o->file : o->scenes[0];
    char text[256];
    snprintf(text, sizeof text, "Opening %.200s", file_name(path));
    add_words(p, MIDDLE, text);
    add_bar(p, v->loading.on ? fxs_worker_progress(v->loader) : 1);
}

/* Where the view that is shown has a point, in the window. Returns 0 for what is behind the camera. */
static int project(const viewer *v, const panels *p, const double point[3], double pixel[2])
{
    const fxs_file_view *view = &v->seen;
    double seen[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            seen[i] += view->rotation[3 * i + k] * (point[k] - view->position[k]);
    const double depth = view->projection == FXS_ORTHOGRAPHIC ? 1 : seen[2];
    const double pixels = (double)p->height / view->height;
    pixel[0] = (view->cx + view->fx * seen[0] / depth) * pixels;
    pixel[1] = (view->cy + view->fy * seen[1] / depth) * pixels;
    return seen[2] > 0 && fabs(pixel[0]) < 1e5 && fabs(pixel[1]) < 1e5;
}

/* What is measured: a dot at each end, and the line between. The panel has the part of both in the window. */
static void add_measure(panels *p, const viewer *v)
{
    const int wide = 3 * p->scale, dot = 9 * p->scale;
    double ends[2][2], low[2], high[2];
    for (int i = 0; i < v->ends; i++)
        if (!project(v, p, v->end[i], ends[i]))
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

static void add_graph(panels *p, const viewer *v)
{
    const fxs_panel *panel = add(p, 12 * p->scale, 12 * p->scale, FXS_GRAPH_WIDTH * p->scale,
                                 FXS_GRAPH_HEIGHT * p->scale, 8 * p->scale, p->theme->panel);
    if (panel)
        fxs_draw_frame_times(&panel->picture, &v->times, p->scale, p->theme, p->words);
}

static void add_rate(panels *p, const viewer *v)
{
    char text[64];
    snprintf(text, sizeof text, "%.0f frames/s", v->times.frame > 0 ? 1000 / v->times.frame : 0);
    add_words(p, TOP_RIGHT, text);
}

static void add_all(panels *p, const viewer *v)
{
    if (v->measuring && v->ends && v->seen.width)
        add_measure(p, v);
    if (v->graph)
        add_graph(p, v);
    if (v->rate)
        add_rate(p, v);
    if (v->loading.on || (v->path && !v->seen.width))
        add_loading(p, v);
    else if (v->film == FILM_WRITTEN) {
        add_words(p, MIDDLE, "Writing the film; k drops it");
        add_bar(p, fxs_worker_progress(v->drawer));
    } else if (!v->path && !v->help)
        add_words(p, MIDDLE, "Drop a scene here");
    if (v->help)
        add_help(p);
    if (*v->note)
        add_words(p, BOTTOM_LEFT, v->note);
    else if (v->film == FILM_TAKEN)
        add_words(p, BOTTOM_LEFT, "filming; k writes the film");
    else if (v->hint && !v->help)
        add_words(p, BOTTOM_LEFT, "h: keys");
}

/* ---- The window -------------------------------------------------------------------------------------------------- */

static void show_title(viewer *v)
{
    char title[1024];
    if (!v->path)
        snprintf(title, sizeof title, "fixsplat%s%s", *v->note ? " - " : "", v->note);
    else
        snprintf(title, sizeof title, "%.200s - %s (%ld of %ld) - %s, SH %d, %s, 1/%d - %.1f ms%s%s",
                 file_name(v->path), v->view.name, v->index + 1, v->view_count,
                 cutoff_name(v->options.render.cutoff), v->options.render.sh_degree, v->options.backend,
                 v->coarse ? v->divisor : 1, v->times.frame, *v->note ? " - " : "", v->note);
    fxs_window_title(v->window, title);
}

int viewer_show(viewer *v)
{
    const fxs_picture frame = {v->picture.pixels, v->picture.width, v->picture.height};
    fxs_message message;
    panels p = {.theme = v->light ? &fxs_light : &fxs_dark, .words = v->words};
    fxs_window_size(v->window, &p.width, &p.height);
    p.scale = (int)lround(fxs_window_scale(v->window));
    add_all(&p, v);
    const int failed = fxs_window_show(v->window, v->seen.width ? &frame : 0, p.theme->window, p.list, p.count,
                                       &message);
    for (int i = 0; i < p.count; i++)
        fxs_panel_free(&p.list[i]);
    show_title(v);
    return failed ? fail(EXIT_FAILED, "%s", message.text) : 0;
}
