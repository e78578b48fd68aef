/* What is drawn over a picture: rectangles, text of 5x7 dots, the times of the last frames. */
#ifndef FXS_OVERLAY_H
#define FXS_OVERLAY_H

#include <stdint.h>

#include "../../src/fixsplat.h"

#define FXS_PANEL 0x0c0e14c0u    /* colours: 0xRRGGBBAA; this one lies behind text */

/* RGBA, alpha not multiplied in; rows from the top, without padding. The bytes belong to the caller. */
typedef struct fxs_picture {
    uint8_t *rgba;
    int width, height;           /* pixels */
} fxs_picture;

/* Overwrites a rectangle, as much as lies in the picture. */
void fxs_draw_rectangle(const fxs_picture *picture, int x, int y, int width, int height, uint32_t colour);

/* Letters (small ones as capitals), digits and + , - . / in cells of 6x9 dots, a dot being `dot` pixels wide; anything
   else is a blank, a newline begins a line. (x, y): the top left corner. */
void fxs_draw_text(const fxs_picture *picture, int x, int y, int dot, const char *text, uint32_t colour);

enum { FXS_GRAPH_FRAMES = 120, FXS_GRAPH_WIDTH = 360, FXS_GRAPH_HEIGHT = 128 };   /* the last two in pixels */

/* Milliseconds of the last frames, the newest first. All 0 is none. */
typedef struct fxs_frame_times {
    double stage[FXS_GRAPH_FRAMES][FXS_STAGES];
    double frame;                /* the newest as a whole */
} fxs_frame_times;

void fxs_frame_times_add(fxs_frame_times *times, const fxs_stats *stats);

/* A bar for each frame, of its stages in their colours; beside it the newest one's time, and that of each stage. */
void fxs_draw_frame_times(const fxs_picture *picture, int x, int y, const fxs_frame_times *times);

#endif
