#include "overlay.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Columns of 7 dots from the left, bit 0 on top. */
static const uint8_t font[128][5] = {
    ['+'] = {0x08, 0x08, 0x3e, 0x08, 0x08}, [','] = {0x00, 0x40, 0x30, 0x10, 0x00},
    ['-'] = {0x08, 0x08, 0x08, 0x08, 0x08}, ['.'] = {0x00, 0x60, 0x60, 0x00, 0x00},
    ['/'] = {0x60, 0x10, 0x08, 0x04, 0x03}, ['0'] = {0x3e, 0x51, 0x49, 0x45, 0x3e},
    ['1'] = {0x00, 0x42, 0x7f, 0x40, 0x00}, ['2'] = {0x62, 0x51, 0x49, 0x49, 0x46},
    ['3'] = {0x41, 0x49, 0x49, 0x49, 0x36}, ['4'] = {0x1c, 0x12, 0x11, 0x7f, 0x10},
    ['5'] = {0x27, 0x45, 0x45, 0x45, 0x39}, ['6'] = {0x3c, 0x4a, 0x49, 0x49, 0x30},
    ['7'] = {0x01, 0x61, 0x19, 0x05, 0x03}, ['8'] = {0x36, 0x49, 0x49, 0x49, 0x36},
    ['9'] = {0x06, 0x49, 0x49, 0x29, 0x1e}, ['A'] = {0x7e, 0x09, 0x09, 0x09, 0x7e},
    ['B'] = {0x7f, 0x49, 0x49, 0x49, 0x36}, ['C'] = {0x3e, 0x41, 0x41, 0x41, 0x41},
    ['D'] = {0x7f, 0x41, 0x41, 0x41, 0x3e}, ['E'] = {0x7f, 0x49, 0x49, 0x49, 0x41},
    ['F'] = {0x7f, 0x09, 0x09, 0x09, 0x01}, ['G'] = {0x3e, 0x41, 0x41, 0x49, 0x79},
    ['H'] = {0x7f, 0x08, 0x08, 0x08, 0x7f}, ['I'] = {0x00, 0x41, 0x7f, 0x41, 0x00},
    ['J'] = {0x20, 0x40, 0x41, 0x41, 0x3f}, ['K'] = {0x7f, 0x08, 0x14, 0x22, 0x41},
    ['L'] = {0x7f, 0x40, 0x40, 0x40, 0x40}, ['M'] = {0x7f, 0x02, 0x0c, 0x02, 0x7f},
    ['N'] = {0x7f, 0x06, 0x08, 0x30, 0x7f}, ['O'] = {0x3e, 0x41, 0x41, 0x41, 0x3e},
    ['P'] = {0x7f, 0x09, 0x09, 0x09, 0x06}, ['Q'] = {0x3e, 0x41, 0x51, 0x21, 0x5e},
    ['R'] = {0x7f, 0x09, 0x19, 0x29, 0x46}, ['S'] = {0x46, 0x49, 0x49, 0x49, 0x31},
    ['T'] = {0x01, 0x01, 0x7f, 0x01, 0x01}, ['U'] = {0x3f, 0x40, 0x40, 0x40, 0x3f},
    ['V'] = {0x0f, 0x30, 0x40, 0x30, 0x0f}, ['W'] = {0x7f, 0x20, 0x18, 0x20, 0x7f},
    ['X'] = {0x63, 0x14, 0x08, 0x14, 0x63}, ['Y'] = {0x03, 0x04, 0x78, 0x04, 0x03},
    ['Z'] = {0x61, 0x51, 0x49, 0x45, 0x43},
};

static const uint32_t stage_colours[FXS_STAGES] = {
    [FXS_PROJECT] = 0x4f8ff0ff, [FXS_SHADE] = 0xf2c14eff, [FXS_SORT] = 0xb07ee8ff,
    [FXS_BIN] = 0x4fc3a1ff, [FXS_BLEND] = 0xf0705aff, [FXS_RESOLVE] = 0xb8c0ccff
};

void fxs_draw_rectangle(const fxs_picture *picture, int x, int y, int width, int height, uint32_t colour)
{
    const uint8_t rgba[4] = {(uint8_t)(colour >> 24), (uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour};
    for (int row = y < 0 ? 0 : y; row < y + height && row < picture->height; row++)
        for (int column = x < 0 ? 0 : x; column < x + width && column < picture->width; column++)
            memcpy(picture->rgba + 4 * ((size_t)row * (size_t)picture->width + (size_t)column), rgba, 4);
}

static void draw_letter(const fxs_picture *picture, int x, int y, int dot, char letter, uint32_t colour)
{
    const uint8_t *columns = font[toupper((unsigned char)letter) & 127];
    for (int i = 0; i < 35; i++)
        if (columns[i / 7] >> i % 7 & 1)
            fxs_draw_rectangle(picture, x + i / 7 * dot, y + i % 7 * dot, dot, dot, colour);
}

void fxs_draw_text(const fxs_picture *picture, int x, int y, int dot, const char *text, uint32_t colour)
{
    for (int column = 0; *text; text++, column++) {
        draw_letter(picture, x + column * 6 * dot, y, dot, *text, colour);
        if (*text == '\n') {
            column = -1;
            y += 9 * dot;
        }
    }
}

void fxs_frame_times_add(fxs_frame_times *times, const fxs_stats *stats)
{
    memmove(times->stage[1], times->stage[0], sizeof times->stage - sizeof times->stage[0]);
    for (int i = 0; i < FXS_STAGES; i++)
        times->stage[0][i] = (double)stats->nanoseconds[i] * 1e-6;
    times->frame = (double)stats->frame_nanoseconds * 1e-6;
}

static double sum(const double stage[FXS_STAGES])
{
    double total = 0;
    for (int i = 0; i < FXS_STAGES; i++)
        total += stage[i];
    return total;
}

/* Milliseconds of the graph's height: the first of 10, 20, 40, ... that holds every frame. */
static double graph_top(const fxs_frame_times *times)
{
    double top = 10;
    for (int frame = 0; frame < FXS_GRAPH_FRAMES; frame++)
        while (top < sum(times->stage[frame]) && top < 1e6)
            top *= 2;
    return top;
}

static void draw_bars(const fxs_picture *picture, int x, int y, int height, double top, const fxs_frame_times *times)
{
    for (int frame = 0; frame < FXS_GRAPH_FRAMES; frame++) {
        double below = 0;
        for (int i = 0, from = 0; i < FXS_STAGES; i++) {
            below += times->stage[frame][i];
            int to = (int)lround(below / top * height);
            fxs_draw_rectangle(picture, x + 2 * (FXS_GRAPH_FRAMES - 1 - frame), y + height - to, 2, to - from,
                               stage_colours[i]);
            from = to;
        }
    }
}

void fxs_draw_frame_times(const fxs_picture *picture, int x, int y, const fxs_frame_times *times)
{
    enum { MARGIN = 8, HEIGHT = 112, LEGEND = 2 * FXS_GRAPH_FRAMES + 2 * MARGIN };
    char text[64];
    double top = graph_top(times);
    fxs_draw_rectangle(picture, x, y, FXS_GRAPH_WIDTH, FXS_GRAPH_HEIGHT, FXS_PANEL);
    fxs_draw_rectangle(picture, x + MARGIN, y + MARGIN, 2 * FXS_GRAPH_FRAMES, 1, 0xffffff60);
    draw_bars(picture, x + MARGIN, y + MARGIN, HEIGHT, top, times);
    snprintf(text, sizeof text, "%.0f ms", top);
    fxs_draw_text(picture, x + MARGIN, y + MARGIN + 3, 1, text, 0xffffffc0);
    snprintf(text, sizeof text, "%.1f ms", times->frame);
    fxs_draw_text(picture, x + LEGEND, y + MARGIN, 2, text, 0xffffffff);
    for (int i = 0; i < FXS_STAGES; i++) {
        snprintf(text, sizeof text, "%-8s%6.1f", fxs_stage_name((enum fxs_stage)i), times->stage[0][i]);
        fxs_draw_text(picture, x + LEGEND, y + MARGIN + 24 + 15 * i, 1, text, stage_colours[i]);
    }
}
