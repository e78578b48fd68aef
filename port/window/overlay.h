/* Draws panels over a picture: text, lines, frame times. Also shows depths and ids of Gaussians as colours. */
#ifndef FXS_OVERLAY_H
#define FXS_OVERLAY_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

/* An RGBA picture in memory, not premultiplied: top row first, no padding between rows. The caller owns the bytes. */
typedef struct fxs_canvas {
    uint8_t *rgba;
    int width, height;
} fxs_canvas;

typedef struct fxs_panel {
    fxs_canvas picture;
    int x, y;
} fxs_panel;

/* Colours of the window and its panels, as 0xRRGGBBAA. */
typedef struct fxs_theme {
    uint32_t window;
    uint32_t panel, words, faint, mark;
} fxs_theme;

extern const fxs_theme fxs_dark, fxs_light;

typedef struct fxs_words fxs_words;

void fxs_draw_rectangle(const fxs_canvas *picture, int x, int y, int width, int height, uint32_t colour);

void fxs_draw_line(const fxs_canvas *picture, const double from[2], const double to[2], double wide, uint32_t colour);

/* Draws one line of text with its top left corner at (x, y). */
void fxs_draw_words(fxs_words *words, const fxs_canvas *picture, int x, int y, const char *text, uint32_t colour);

/* Makes a panel of one colour with round corners. Returns 0, or -1 if memory ran out. */
int fxs_panel_make(fxs_panel *panel, int x, int y, int width, int height, int radius, uint32_t colour);
void fxs_panel_free(fxs_panel *panel);

/* Paints depths on a logarithmic scale, from red for the nearest 2 % to blue for the farthest. */
void fxs_paint_depths(const fxs_canvas *picture, const uint32_t *depths);

void fxs_paint_ids(const fxs_canvas *picture, const fxs_id *ids);

/* number of bars in the graph of frame times; its width and height in points of the screen */
enum { FXS_GRAPH_FRAMES = 120, FXS_GRAPH_WIDTH = 400, FXS_GRAPH_HEIGHT = 128 };

/* Milliseconds of each stage of the last frames, newest first. All zeros: no frames. */
typedef struct fxs_frame_times {
    double stage[FXS_GRAPH_FRAMES][FXS_STAGES];
    double frame;
} fxs_frame_times;

void fxs_frame_times_add(fxs_frame_times *times, const fxs_stats *stats);

/* Draws a graph with a bar for each frame, and the times of the newest frame. scale: pixels per point of the screen. */
void fxs_draw_frame_times(const fxs_canvas *picture, const fxs_frame_times *times, int scale, const fxs_theme *theme,
                          fxs_words *words);

#endif
