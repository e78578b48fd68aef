/* Sends strips of a picture to a display panel, over SPI with a D/C line or any other bus of bytes.
 *
 *     static fxs_panel panel = {.type = &fxs_panel_types[FXS_PANEL_ILI9341], .rotation = 1,
 *                               .bus = {send_command, send_data, wait}};
 *     static fxs_strip strip = {.pixels = rows, .stride = 320 * 2, .rows = 16,
 *                               .format = FXS_FORMAT_RGB565_SWAPPED,
 *                               .rows_done = fxs_panel_rows, .argument = &panel};
 *     fxs_panel_init(&panel, 320, 240); */
#ifndef FXS_PANEL_H
#define FXS_PANEL_H

#include <fixsplat/board.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The board's functions that send bytes to the panel. Bytes are sent in the order of the calls, highest bit first. */
typedef struct fxs_panel_bus {
    void (*command)(void *argument, uint8_t command);
    /* Sends bytes with the line D/C (data or command) high. Up to 16 bytes must be sent before the return. More bytes
       are pixels of a strip. With a second buffer for strips, DMA may send these after the return. The next call of
       `command` or `data` then waits until all are sent. */
    void (*data)(void *argument, const uint8_t *bytes, size_t count);
    void (*wait)(void *argument, uint32_t milliseconds);
    void *argument;
} fxs_panel_bus;

/* A kind of panel. A program may have types of its own. */
typedef struct fxs_panel_type {
    const char *name;
    int16_t width, height;                 /* visible pixels at rotation 0 */
    int16_t memory_width, memory_height;   /* pixels in the controller's memory */
    uint8_t left, top;                     /* first visible column and row of the memory */
    uint8_t access;                        /* command 36h at rotation 0: 80h, 40h: mirrored rows, columns; 08h: BGR */
    uint8_t inverted;                      /* 1: the panel shows right colours in the controller's inversion mode */
    uint8_t bits;                          /* of a pixel: 16, or 1 for a controller like SSD1306 */
    uint8_t cycle;                         /* shortest cycle of the serial clock by the data sheet, in nanoseconds */
    const uint8_t *settings;               /* command, number of data bytes, data bytes, and so on; then command 0 */
} fxs_panel_type;

enum { FXS_PANEL_ILI9341, FXS_PANEL_ST7789, FXS_PANEL_ST7789_SQUARE, FXS_PANEL_ST7735, FXS_PANEL_GC9A01,
       FXS_PANEL_SSD1306, FXS_PANELS };
extern const fxs_panel_type fxs_panel_types[FXS_PANELS];

typedef struct fxs_panel {
    const fxs_panel_type *type;
    int rotation;                  /* of the picture on the panel, clockwise: 0 to 3 quarter turns; 1 bit: 0 or 2 */
    fxs_panel_bus bus;
    void *other;                   /* second buffer as large as the strip's pixels (1 bit: as `pages`), used in turn;
                                      null: none */
    int16_t *errors;               /* 1 bit: room for a number per column */
    uint8_t *pages;                /* 1 bit: room for an eighth of a byte per pixel of a strip */
    int32_t width, height;
} fxs_panel;

/* Resets the panel's controller, wakes the panel and turns it on, in 240 ms. Pictures start at the upper left corner.
   A GC9A01 or SSD1306 needs a pulse on its reset pin before. Returns 0, or FXS_ERR_SIZE for a picture that is larger
   than the panel at this rotation. */
int fxs_panel_init(fxs_panel *panel, int32_t width, int32_t height);

/* Sends a strip to the panel, as the function fxs_strip.rows_done with the panel as argument. Returns 0, or
   FXS_ERR_TARGET for a format other than RGB565_SWAPPED, rows outside the panel, or missing buffers. */
int fxs_panel_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows);

/* Returns the bits, commands included, that fxs_panel_rows sends for a picture in strips of `rows` rows. */
uint32_t fxs_panel_frame_bits(const fxs_panel_type *type, int32_t width, int32_t height, int32_t rows);

#ifdef __cplusplus
}
#endif

#endif
