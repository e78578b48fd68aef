/* Panels that are drawn over a picture: words, lines, times of the last frames; and pictures of depths and ids. */
#ifndef FXS_OVERLAY_H
#define FXS_OVERLAY_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

/* RGBA, not premultiplied; rows from the top, without padding. The bytes belong to the caller. */
typedef struct fxs_picture {
    uint8_t *rgba;
    int width, height;           /* pixels */
} fxs_picture;

/* A picture and the place of its top left corner in the window. */
typedef struct fxs_panel {
    fxs_picture picture;
    int x, y;
} fxs_panel;

/* Colours, 0xRRGGBBAA. A panel is nearly opaque, so that its words can be read over any picture. */
typedef struct fxs_theme {
    uint32_t window;             /* the window without a picture */
    uint32_t panel, words, faint, mark;
} fxs_theme;

extern const fxs_theme fxs_dark, fxs_light;

typedef struct fxs_words fxs_words;

/* Fills the part of a rectangle that lies in the picture. */
void fxs_draw_rectangle(const fxs_picture *picture, int x, int y, int width, int height, uint32_t colour);

/* Draws the part of a line, `width` pixels wide, that lies in the picture. */
void fxs_draw_line(const fxs_picture *picture, const double from[2], const double to[2], double wide, uint32_t colour);

/* One line of words (words.h), the top left corner at (x, y). */
void fxs_draw_words(fxs_words *words, const fxs_picture *picture, int x, int y, const char *text, uint32_t colour);

/* Makes a panel of one colour with round corners, which fxs_panel_free frees. Returns 0, or -1 where memory ran out,
   with nothing to free. */
int fxs_panel_make(fxs_panel *panel, int x, int y, int width, int height, int radius, uint32_t colour);
void fxs_panel_free(fxs_panel *panel);

/* Makes a picture of depths of fxs_targets: by their logarithm, from red for the nearest fiftieth of the visible depths
   to blue for the farthest. */
void fxs_paint_depths(const fxs_picture *picture, const uint32_t *depths);

/* Makes a picture of ids with a colour for each Gaussian. */
void fxs_paint_ids(const fxs_picture *picture, const fxs_id *ids);

enum { FXS_GRAPH_FRAMES = 120, FXS_GRAPH_WIDTH = 400, FXS_GRAPH_HEIGHT = 128 };   /* the last two in points */

/* Milliseconds of the last frames, the newest first. All 0: no frames. */
typedef struct fxs_frame_times {
    double stage[FXS_GRAPH_FRAMES][FXS_STAGES];
    double frame;                /* the whole newest frame */
} fxs_frame_times;

void fxs_frame_times_add(fxs_frame_times *times, const fxs_stats *stats);

/* Draws a bar for each frame, with its stages in colours, and beside it the times of the newest frame and of each
   stage. A point is `scale` pixels. */
void fxs_draw_frame_times(const fxs_picture *picture, const fxs_frame_times *times, int scale, const fxs_theme *theme,
                          fxs_words *words);

#endif
