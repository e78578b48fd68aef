/* What is drawn over a picture: panels with words, lines, the times of the last frames. */
#ifndef FXS_OVERLAY_H
#define FXS_OVERLAY_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

/* RGBA, alpha not multiplied in; rows from the top, without padding. The bytes belong to the caller. */
typedef struct fxs_picture {
    uint8_t *rgba;
    int width, height;           /* pixels */
} fxs_picture;

/* A picture and where its top left corner is in the window. */
typedef struct fxs_panel {
    fxs_picture picture;
    int x, y;
} fxs_panel;

/* Colours, 0xRRGGBBAA. A panel lets a little of what is below through: words on it can be read over any picture. */
typedef struct fxs_theme {
    uint32_t window;             /* without a picture */
    uint32_t panel, words, faint, mark;
} fxs_theme;

extern const fxs_theme fxs_dark, fxs_light;

typedef struct fxs_words fxs_words;

/* Overwrites a rectangle, as much as lies in the picture. */
void fxs_draw_rectangle(const fxs_picture *picture, int x, int y, int width, int height, uint32_t colour);

/* Overwrites a line so many pixels wide, as much as lies in the picture. */
void fxs_draw_line(const fxs_picture *picture, const double from[2], const double to[2], double wide, uint32_t colour);

/* One line of words (words.h), the top left corner at (x, y). */
void fxs_draw_words(fxs_words *words, const fxs_picture *picture, int x, int y, const char *text, uint32_t colour);

/* Makes a panel of one colour with round corners, to be freed by fxs_panel_free. Returns 0, or -1 where there is no
   memory, with nothing to free. */
int fxs_panel_make(fxs_panel *panel, int x, int y, int width, int height, int radius, uint32_t colour);
void fxs_panel_free(fxs_panel *panel);

/* A picture of depths, as fxs_targets has them: from red, the nearest fiftieth of what is seen, to blue, the
   farthest, by the logarithm. */
void fxs_paint_depths(const fxs_picture *picture, const uint32_t *depths);

/* A picture of ids: a colour for each Gaussian. */
void fxs_paint_ids(const fxs_picture *picture, const fxs_id *ids);

enum { FXS_GRAPH_FRAMES = 120, FXS_GRAPH_WIDTH = 400, FXS_GRAPH_HEIGHT = 128 };   /* the last two in points */

/* Milliseconds of the last frames, the newest first. All 0 is none. */
typedef struct fxs_frame_times {
    double stage[FXS_GRAPH_FRAMES][FXS_STAGES];
    double frame;                /* the newest as a whole */
} fxs_frame_times;

void fxs_frame_times_add(fxs_frame_times *times, const fxs_stats *stats);

/* A bar for each frame, of its stages in their colours; beside it the newest one's time, and that of each stage. A
   point is `scale` pixels. */
void fxs_draw_frame_times(const fxs_picture *picture, const fxs_frame_times *times, int scale, const fxs_theme *theme,
                          fxs_words *words);

#endif
