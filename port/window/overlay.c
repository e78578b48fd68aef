/* Draws panels, lines and bars into RGBA pictures, and paints pictures of depths and ids as colours. */
#include "overlay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "words.h"

const fxs_theme fxs_dark = {0x14171dff, 0x0c0e14c8, 0xeef1f6ff, 0xeef1f640, 0x6ea8ffff};
const fxs_theme fxs_light = {0xe9ecf1ff, 0xfafbfde0, 0x12151bff, 0x12151b40, 0x1f5fd0ff};

static const uint32_t stage_colours[FXS_STAGES] = {
    [FXS_PROJECT] = 0x4f8ff0ff, [FXS_SHADE] = 0xf2c14eff, [FXS_SORT] = 0xb07ee8ff,
    [FXS_BIN] = 0x4fc3a1ff, [FXS_BLEND] = 0xf0705aff, [FXS_RESOLVE] = 0xb8c0ccff
};

void fxs_draw_rectangle(const fxs_canvas *picture, int x, int y, int width, int height, uint32_t colour)
{
    const uint8_t rgba[4] = {(uint8_t)(colour >> 24), (uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour};
    for (int row = y < 0 ? 0 : y; row < y + height && row < picture->height; row++)
        for (int column = x < 0 ? 0 : x; column < x + width && column < picture->width; column++)
            memcpy(picture->rgba + 4 * ((size_t)row * (size_t)picture->width + (size_t)column), rgba, 4);
}

void fxs_draw_line(const fxs_canvas *picture, const double from[2], const double to[2], double wide, uint32_t colour)
{
    const double length = fmax(hypot(to[0] - from[0], to[1] - from[1]), 1);
    for (double at = 0; at <= length; at += 0.5) {
        const double x = from[0] + (to[0] - from[0]) * at / length, y = from[1] + (to[1] - from[1]) * at / length;
        fxs_draw_rectangle(picture, (int)floor(x - wide / 2 + 0.5), (int)floor(y - wide / 2 + 0.5), (int)wide,
                           (int)wide, colour);
    }
}

enum { BINS = 2048 };

static int bin_of(uint32_t depth)
{
    return (int)(log2((double)depth + 1) / 32 * BINS * (1 - 1e-9));
}

static int quantile(const uint32_t counts[BINS], uint64_t below)
{
    int bin = 0;
    for (uint64_t sum = 0; bin < BINS - 1 && (sum += counts[bin]) <= below;)
        bin++;
    return bin;
}

void fxs_paint_depths(const fxs_canvas *picture, const uint32_t *depths)
{
    static const uint8_t ramp[][3] = {{178, 24, 43}, {244, 109, 67}, {254, 224, 144}, {171, 217, 233}, {69, 117, 180},
                                      {30, 40, 100}};
    const size_t pixels = (size_t)picture->width * (size_t)picture->height;
    uint32_t counts[BINS] = {0};
    uint64_t seen = 0;
    for (size_t i = 0; i < pixels; i++)
        if (depths[i] != FXS_NOTHING) {
            counts[bin_of(depths[i])]++;
            seen++;
        }
    const int near = quantile(counts, seen / 50), far = quantile(counts, seen - seen / 50);
    for (size_t i = 0; i < pixels; i++) {
        const double at = far > near ? (double)(bin_of(depths[i]) - near) / (far - near) : 0;
        const double place = fmin(fmax(at, 0), 1) * 5;
        const int step = place < 4 ? (int)place : 4;
        uint8_t *rgba = picture->rgba + 4 * i;
        for (int k = 0; k < 3; k++)
            rgba[k] = depths[i] == FXS_NOTHING
                          ? 0 : (uint8_t)lround(ramp[step][k] + (place - step) * (ramp[step + 1][k] - ramp[step][k]));
        rgba[3] = 255;
    }
}

/* Paints a picture of Gaussians' ids. Each id is hashed by an odd number near 2^64 / golden ratio, so that neighbouring
   ids differ in colour. */
void fxs_paint_ids(const fxs_canvas *picture, const fxs_id *ids)
{
    const size_t pixels = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint64_t id = (uint64_t)ids[i].object << 32 | ids[i].gaussian, mixed = (id + 1) * 0x9e3779b97f4a7c15u;
        const int nothing = ids[i].gaussian == FXS_NOTHING;
        uint8_t *rgba = picture->rgba + 4 * i;
        for (int k = 0; k < 3; k++)
            rgba[k] = nothing ? 0 : (uint8_t)(64 + (mixed >> (56 - 8 * k) & 255) * 3 / 4);
        rgba[3] = 255;
    }
}

static double corner_share(int x, int y, int radius)
{
    return fmin(fmax(radius + 0.5 - hypot(radius - x - 0.5, radius - y - 0.5), 0), 1);
}

int fxs_panel_make(fxs_panel *panel, int x, int y, int width, int height, int radius, uint32_t colour)
{
    width = width < 1 ? 1 : width;
    height = height < 1 ? 1 : height;
    *panel = (fxs_panel){{calloc((size_t)width * (size_t)height, 4), width, height}, x, y};
    if (!panel->picture.rgba)
        return -1;
    fxs_draw_rectangle(&panel->picture, 0, 0, width, height, colour);
    for (int row = 0; row < radius && 2 * radius <= width && 2 * radius <= height; row++)
        for (int column = 0; column < radius; column++) {
            const double share = corner_share(column, row, radius);
            const uint32_t cut = (colour & ~0xffu) | (uint32_t)lround((colour & 255) * share);
            for (int side = 0; side < 4; side++)
                fxs_draw_rectangle(&panel->picture, side & 1 ? width - 1 - column : column,
                                   side & 2 ? height - 1 - row : row, 1, 1, cut);
        }
    return 0;
}

void fxs_panel_free(fxs_panel *panel)
{
    free(panel->picture.rgba);
    panel->picture.rgba = 0;
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

/* Returns the height of the graph of frame times in milliseconds: the first of 10, 20, 40, ... that no frame
   exceeds. */
static double graph_top(const fxs_frame_times *times)
{
    double top = 10;
    for (int frame = 0; frame < FXS_GRAPH_FRAMES; frame++)
        while (top < sum(times->stage[frame]) && top < 1e6)
            top *= 2;
    return top;
}

static void draw_bars(const fxs_canvas *picture, int margin, int height, int scale, double top,
                      const fxs_frame_times *times)
{
    for (int frame = 0; frame < FXS_GRAPH_FRAMES; frame++) {
        double below = 0;
        for (int i = 0, from = 0; i < FXS_STAGES; i++) {
            below += times->stage[frame][i];
            int to = (int)lround(below / top * height);
            fxs_draw_rectangle(picture, margin + 2 * scale * (FXS_GRAPH_FRAMES - 1 - frame), margin + height - to,
                               2 * scale, to - from, stage_colours[i]);
            from = to;
        }
    }
}

void fxs_draw_frame_times(const fxs_canvas *picture, const fxs_frame_times *times, int scale, const fxs_theme *theme,
                          fxs_words *words)
{
    const int margin = 8 * scale, height = 112 * scale, wide = 2 * FXS_GRAPH_FRAMES * scale;
    const int legend = wide + 2 * margin, numbers = (FXS_GRAPH_WIDTH - 8) * scale;
    char text[64];
    double top = graph_top(times);
    fxs_draw_rectangle(picture, margin, margin, wide, scale, theme->faint);
    draw_bars(picture, margin, height, scale, top, times);
    fxs_words_resize(words, 11 * scale);
    snprintf(text, sizeof text, "%.0f ms", top);
    fxs_draw_words(words, picture, margin, margin + 3 * scale, text, theme->words);
    for (int i = 0; i < FXS_STAGES; i++) {
        const int y = margin + (24 + 15 * i) * scale;
        fxs_draw_rectangle(picture, legend, y + 3 * scale, 8 * scale, 8 * scale, stage_colours[i]);
        fxs_draw_words(words, picture, legend + 14 * scale, y, fxs_stage_name((enum fxs_stage)i), theme->words);
        snprintf(text, sizeof text, "%.1f", times->stage[0][i]);
        fxs_draw_words(words, picture, numbers - fxs_words_width(words, text), y, text, theme->words);
    }
    fxs_words_resize(words, 14 * scale);
    snprintf(text, sizeof text, "%.1f ms", times->frame);
    fxs_draw_words(words, picture, legend, margin, text, theme->words);
}
