/* Drives display panels by a table of their controllers.
 *
 * Commands, memory sizes and clocks are from the data sheets: ILI9341 (ILITEK, V1.11), ST7789V (Sitronix, V1.6),
 * ST7735S (Sitronix, V1.4), GC9A01A (GalaxyCore, V1.0), SSD1306 (Solomon Systech, rev 1.1). Settings of voltages and
 * gamma, and of registers that the GC9A01A's data sheet leaves out, are those that makers of panels publish. */
#include "panel.h"

enum {
    RESET = 0x01, SLEEP_OUT = 0x11, INVERSION_OFF = 0x20, DISPLAY_ON = 0x29, COLUMNS = 0x2a, ROWS = 0x2b,
    MEMORY_WRITE = 0x2c, MEMORY_ACCESS = 0x36
};
enum { MIRROR_Y = 0x80, MIRROR_X = 0x40, TRANSPOSE = 0x20, BGR = 0x08 };
enum { MONO_COLUMNS = 0x21, MONO_PAGES = 0x22, MONO_MIRROR_X = 0xa0, MONO_MIRROR_Y = 0xc0, MONO_ON = 0xaf };
#define WAKE_MILLISECONDS 120      /* time to wait after the commands RESET and SLEEP_OUT */

/* Pixel format (3Ah) of all: 16 bits. */
static const uint8_t ili9341[] = {
    0xc0, 1, 0x23, 0xc1, 1, 0x10, 0xc5, 2, 0x3e, 0x28, 0xc7, 1, 0x86, /* power and VCOM */
    0xb1, 2, 0x00, 0x18,                                            /* 79 frames a second */
    0x3a, 1, 0x55, 0
};
static const uint8_t st7789[] = {0x3a, 1, 0x55, 0};
static const uint8_t st7735[] = {
    0xb1, 3, 0x01, 0x2c, 0x2d,                                      /* frame rate */
    0xb4, 1, 0x07,                                                  /* line inversion off */
    0xc0, 3, 0xa2, 0x02, 0x84, 0xc1, 1, 0xc5, 0xc2, 2, 0x0a, 0x00, 0xc5, 1, 0x0e, /* power and VCOM */
    /* gamma */
    0xe0, 16, 0x02, 0x1c, 0x07, 0x12, 0x37, 0x32, 0x29, 0x2d, 0x29, 0x25, 0x2b, 0x39, 0x00, 0x01, 0x03, 0x10,
    0xe1, 16, 0x03, 0x1d, 0x07, 0x06, 0x2e, 0x2c, 0x29, 0x2d, 0x2e, 0x2e, 0x37, 0x3f, 0x00, 0x00, 0x02, 0x10,
    0x3a, 1, 0x05, 0
};
static const uint8_t gc9a01[] = {
    0xfe, 0, 0xef, 0, 0xeb, 1, 0x14,                                /* opens the registers below */
    0x84, 1, 0x40, 0x85, 1, 0xff, 0x86, 1, 0xff, 0x87, 1, 0xff, 0x88, 1, 0x0a, 0x89, 1, 0x21, 0x8a, 1, 0x00,
    0x8b, 1, 0x80, 0x8c, 1, 0x01, 0x8d, 1, 0x01, 0x8e, 1, 0xff, 0x8f, 1, 0xff, 0xb6, 2, 0x00, 0x00,
    0x90, 4, 0x08, 0x08, 0x08, 0x08, 0xbd, 1, 0x06, 0xbc, 1, 0x00, 0xff, 3, 0x60, 0x01, 0x04,
    0xc3, 1, 0x13, 0xc4, 1, 0x13, 0xc9, 1, 0x22, 0xbe, 1, 0x11, 0xe1, 2, 0x10, 0x0e, 0xdf, 3, 0x21, 0x0c, 0x02,
    0xf0, 6, 0x45, 0x09, 0x08, 0x08, 0x26, 0x2a, 0xf1, 6, 0x43, 0x70, 0x72, 0x36, 0x37, 0x6f, /* gamma */
    0xf2, 6, 0x45, 0x09, 0x08, 0x08, 0x26, 0x2a, 0xf3, 6, 0x43, 0x70, 0x72, 0x36, 0x37, 0x6f,
    0xed, 2, 0x1b, 0x0b, 0xae, 1, 0x77, 0xcd, 1, 0x63, 0x70, 9, 0x07, 0x07, 0x04, 0x0e, 0x0f, 0x09, 0x07, 0x08, 0x03,
    0xe8, 1, 0x34,                                                  /* frame rate */
    0x62, 12, 0x18, 0x0d, 0x71, 0xed, 0x70, 0x70, 0x18, 0x0f, 0x71, 0xef, 0x70, 0x70, /* timing of the panel's gates */
    0x63, 12, 0x18, 0x11, 0x71, 0xf1, 0x70, 0x70, 0x18, 0x13, 0x71, 0xf3, 0x70, 0x70,
    0x64, 7, 0x28, 0x29, 0xf1, 0x01, 0xf1, 0x00, 0x07,
    0x66, 10, 0x3c, 0x00, 0xcd, 0x67, 0x45, 0x45, 0x10, 0x00, 0x00, 0x00,
    0x67, 10, 0x00, 0x3c, 0x00, 0x00, 0x00, 0x01, 0x54, 0x10, 0x32, 0x98,
    0x74, 7, 0x10, 0x85, 0x80, 0x00, 0x00, 0x4e, 0x00, 0x98, 2, 0x3e, 0x07,
    0x3a, 1, 0x55, 0
};
static const uint8_t ssd1306[] = {
    0xae, 0, 0xd5, 1, 0x80, 0xa8, 1, 63, 0xd3, 1, 0, 0x40, 0,       /* off, clock, 64 rows from row 0 */
    0x8d, 1, 0x14, 0xda, 1, 0x12, 0x81, 1, 0x7f, 0xd9, 1, 0xf1, 0xdb, 1, 0x20, /* charge pump, pins, contrast */
    0x20, 1, 0, 0xa4, 0, 0xa6, 0, 0                                 /* rows of pages one after the other; as stored */
};

const fxs_panel_type fxs_panel_types[FXS_PANELS] = {
    [FXS_PANEL_ILI9341] = {"ili9341", 240, 320, 240, 320, 0, 0, MIRROR_X | BGR, 0, 16, 100, ili9341},
    [FXS_PANEL_ST7789] = {"st7789", 240, 320, 240, 320, 0, 0, 0, 1, 16, 66, st7789},
    [FXS_PANEL_ST7789_SQUARE] = {"st7789-240x240", 240, 240, 240, 320, 0, 0, 0, 1, 16, 66, st7789},
    [FXS_PANEL_ST7735] = {"st7735", 128, 160, 132, 162, 2, 1, MIRROR_X | MIRROR_Y | BGR, 0, 16, 66, st7735},
    [FXS_PANEL_GC9A01] = {"gc9a01", 240, 240, 240, 240, 0, 0, MIRROR_X | BGR, 1, 16, 10, gc9a01},
    [FXS_PANEL_SSD1306] = {"ssd1306", 128, 64, 128, 64, 0, 0, MIRROR_X | MIRROR_Y, 0, 1, 100, ssd1306},
};

static const uint8_t turns[4] = {0, MIRROR_X | TRANSPOSE, MIRROR_X | MIRROR_Y, MIRROR_Y | TRANSPOSE};

/* Sends a command. Controllers of 1 bit take all but pixels as commands. */
static void send(const fxs_panel *panel, uint8_t command, const uint8_t *data, size_t count)
{
    panel->bus.command(panel->bus.argument, command);
    if (panel->type->bits == 16 && count)
        panel->bus.data(panel->bus.argument, data, count);
    for (size_t i = 0; i < count && panel->type->bits == 1; i++)
        panel->bus.command(panel->bus.argument, data[i]);
}

static void wake(const fxs_panel *panel, uint8_t command)
{
    send(panel, command, 0, 0);
    panel->bus.wait(panel->bus.argument, WAKE_MILLISECONDS);
}

static uint8_t access_of(const fxs_panel *panel)
{
    return panel->type->access ^ turns[panel->rotation & 3];
}

static void turn_on(const fxs_panel *panel)
{
    const uint8_t access = access_of(panel);
    if (panel->type->bits == 1) {
        send(panel, MONO_MIRROR_X | (access & MIRROR_X ? 1 : 0), 0, 0);
        send(panel, MONO_MIRROR_Y | (access & MIRROR_Y ? 8 : 0), 0, 0);
        send(panel, MONO_ON, 0, 0);
    } else {
        send(panel, MEMORY_ACCESS, &access, 1);
        send(panel, INVERSION_OFF + panel->type->inverted, 0, 0);
        wake(panel, SLEEP_OUT);
        send(panel, DISPLAY_ON, 0, 0);
    }
}

int fxs_panel_init(fxs_panel *panel, int32_t width, int32_t height)
{
    const fxs_panel_type *type = panel->type;
    const int turned = panel->rotation & 1;
    if (width < 1 || height < 1 || width > (turned ? type->height : type->width) ||
        height > (turned ? type->width : type->height) || (turned && type->bits == 1))
        return FXS_ERR_SIZE;
    panel->width = width;
    panel->height = height;
    if (type->bits == 16)
        wake(panel, RESET);
    for (const uint8_t *s = type->settings; *s; s += 2 + s[1])
        send(panel, s[0], s + 2, s[1]);
    turn_on(panel);
    return 0;
}

/* Sends the rows or columns to write, counted on the panel from the picture's upper left corner. `is_row`: of the
   controller's memory. */
static void send_range(const fxs_panel *panel, uint8_t command, int is_row, int32_t first, int32_t last)
{
    const fxs_panel_type *t = panel->type;
    const int mirrored = access_of(panel) & (is_row ? MIRROR_Y : MIRROR_X);
    const int32_t before = is_row ? t->top : t->left;
    const int32_t behind = is_row ? t->memory_height - t->top - t->height : t->memory_width - t->left - t->width;
    const int32_t offset = mirrored ? behind : before, from = first + offset, to = last + offset;
    const uint8_t range[4] = {(uint8_t)(from >> 8), (uint8_t)from, (uint8_t)(to >> 8), (uint8_t)to};
    send(panel, command, range, sizeof range);
}

static int send_pages(fxs_panel *panel, fxs_strip *strip, int32_t first, int32_t rows)
{
    const uint8_t columns[2] = {0, (uint8_t)(panel->width - 1)};
    const uint8_t pages[2] = {(uint8_t)(first / 8), (uint8_t)((first + rows - 1) / 8)};
    if (!panel->errors || !panel->pages)
        return FXS_ERR_TARGET;
    fxs_strip_bits(strip, panel->width, first, rows, panel->errors, panel->pages);
    send(panel, MONO_COLUMNS, columns, 2);
    send(panel, MONO_PAGES, pages, 2);
    panel->bus.data(panel->bus.argument, panel->pages, (size_t)panel->width * (size_t)((rows + 7) / 8));
    if (panel->other) {
        void *sent = panel->pages;
        panel->pages = panel->other;
        panel->other = sent;
    }
    return 0;
}

int fxs_panel_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    fxs_panel *panel = argument;
    const uint8_t *pixels = strip->pixels;
    const size_t row = (size_t)panel->width * 2;
    const int whole = strip->stride == (ptrdiff_t)row, turned = panel->rotation & 1;
    if (strip->format != FXS_FORMAT_RGB565_SWAPPED || strip->stride < (ptrdiff_t)row || first + rows > panel->height)
        return FXS_ERR_TARGET;
    if (panel->type->bits == 1)
        return send_pages(panel, strip, first, rows);
    send_range(panel, COLUMNS, turned, 0, panel->width - 1);
    send_range(panel, ROWS, !turned, first, first + rows - 1);
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

uint32_t fxs_panel_frame_bits(const fxs_panel_type *type, int32_t width, int32_t height, int32_t rows)
{
    const int32_t strips = (height + rows - 1) / rows, mono = type->bits == 1;
    const int32_t pixels = mono ? width * ((height + 7) / 8) : width * height * 2;
    return 8 * (uint32_t)(strips * (mono ? 6 : 11) + pixels);
}
