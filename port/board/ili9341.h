/* Sends strips of a picture to a 240x320 panel with the ILI9341 ("ILI9341, a-Si TFT LCD Single Chip Driver", ILITEK,
 * V1.11), over SPI with a D/C line or any other bus of bytes.
 *
 *     static fxs_ili9341 panel = {.bus = {send_command, send_data, wait}};
 *     static fxs_strip strip = {.pixels = rows, .stride = 320 * 2, .rows = 16,
 *                               .format = FXS_FORMAT_RGB565_SWAPPED,
 *                               .rows_done = fxs_ili9341_rows, .argument = &panel};
 *     fxs_ili9341_init(&panel, 320, 240); */
#ifndef FXS_ILI9341_H
#define FXS_ILI9341_H

#include <fixsplat/board.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The board's functions that send bytes to the panel. Bytes are sent in the order of the calls, highest bit first. */
typedef struct fxs_ili9341_bus {
    void (*command)(void *argument, uint8_t command);
    /* Sends bytes with the line D/C (data or command) high. Up to 4 bytes must be sent before the return. More bytes
       are pixels of a strip. With a second buffer for strips, DMA may send these after the return. The next call of
       `command` or `data` then waits until all are sent. */
    void (*data)(void *argument, const uint8_t *bytes, size_t count);
    void (*wait)(void *argument, uint32_t milliseconds);
    void *argument;
} fxs_ili9341_bus;

typedef struct fxs_ili9341 {
    fxs_ili9341_bus bus;
    void *other;                   /* second buffer as large as the strip's pixels, used in turn; null: none */
    int32_t width, height;
} fxs_ili9341;

/* Resets the panel's controller, wakes the panel and turns it on, in 240 ms. Pictures start at the upper left corner.
   Pictures up to 240x320 are upright; others, up to 320x240, are sideways. Returns 0 or FXS_ERR_SIZE. */
int fxs_ili9341_init(fxs_ili9341 *panel, int32_t width, int32_t height);

/* Sends a strip to the panel, as the function fxs_strip.rows_done with the panel as argument. Returns 0, or
   FXS_ERR_TARGET for a format other than RGB565_SWAPPED or rows outside the panel. */
int fxs_ili9341_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows);

#ifdef __cplusplus
}
#endif

#endif
