/* Drives a display panel with the controller ILI9341. */
#include "ili9341.h"

enum {
    RESET = 0x01, SLEEP_OUT = 0x11, DISPLAY_ON = 0x29, COLUMNS = 0x2a, PAGES = 0x2b, MEMORY_WRITE = 0x2c,
    MEMORY_ACCESS = 0x36, PIXEL_FORMAT = 0x3a, FRAME_RATE = 0xb1, POWER_1 = 0xc0, POWER_2 = 0xc1, VCOM_1 = 0xc5,
    VCOM_2 = 0xc7
};
enum { MIRROR_X = 0x40, TRANSPOSE = 0x20, BGR = 0x08 };
enum { SHORT_SIDE = 240, LONG_SIDE = 320 };
#define WAKE_MILLISECONDS 120      /* time to wait after the commands RESET and SLEEP_OUT */

static void send(const fxs_ili9341 *panel, uint8_t command, const uint8_t *data, size_t count)
{
    panel->bus.command(panel->bus.argument, command);
    if (count)
        panel->bus.data(panel->bus.argument, data, count);
}

static void wake(const fxs_ili9341 *panel, uint8_t command)
{
    send(panel, command, 0, 0);
    panel->bus.wait(panel->bus.argument, WAKE_MILLISECONDS);
}

int fxs_ili9341_init(fxs_ili9341 *panel, int32_t width, int32_t height)
{
    static const struct {
        uint8_t command, count, data[2];
    } settings[] = {
        {POWER_1, 1, {0x23}},
        {POWER_2, 1, {0x10}},
        {VCOM_1, 2, {0x3e, 0x28}},
        {VCOM_2, 1, {0x86}},
        {FRAME_RATE, 2, {0x00, 0x18}},     /* frame rate: 79 frames a second */
        {PIXEL_FORMAT, 1, {0x55}},         /* pixel format: 16 bits per pixel */
    };
    const int upright = width <= SHORT_SIDE && height <= LONG_SIDE;
    const uint8_t access = (uint8_t)(BGR | (upright ? MIRROR_X : TRANSPOSE));
    if (width < 1 || height < 1 || (!upright && (width > LONG_SIDE || height > SHORT_SIDE)))
        return FXS_ERR_SIZE;
    panel->width = width;
    panel->height = height;
    wake(panel, RESET);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        send(panel, settings[i].command, settings[i].data, settings[i].count);
    send(panel, MEMORY_ACCESS, &access, 1);
    wake(panel, SLEEP_OUT);
    send(panel, DISPLAY_ON, 0, 0);
    return 0;
}

static void send_range(const fxs_ili9341 *panel, uint8_t command, int32_t first, int32_t last)
{
    const uint8_t range[4] = {(uint8_t)(first >> 8), (uint8_t)first, (uint8_t)(last >> 8), (uint8_t)last};
    send(panel, command, range, sizeof range);
}

int fxs_ili9341_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    fxs_ili9341 *panel = argument;
    const uint8_t *pixels = strip->pixels;
    const size_t row = (size_t)panel->width * 2;
    const int whole = strip->stride == (ptrdiff_t)row;
    if (strip->format != FXS_FORMAT_RGB565_SWAPPED || strip->stride < (ptrdiff_t)row || first + rows > panel->height)
        return FXS_ERR_TARGET;
    send_range(panel, COLUMNS, 0, panel->width - 1);
    send_range(panel, PAGES, first, first + rows - 1);
    send(panel, MEMORY_WRITE, pixels, whole ? row * (size_t)rows : row);
    for (int32_t i = 1; i < rows && !whole; i++)
        panel->bus.data(panel->bus.argument, pixels + i * strip->stride, row);
    if (panel->other) {
        void *sent = strip->pixels;
        strip->pixels = panel->other;
        panel->other = sent;
    }
    return 0;
}
