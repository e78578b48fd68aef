/* Draws a scene on an ST7789 panel of 240x240 pixels, in strips of 16 rows. A board provides the scene, aligned to 64
 * bytes in flash, and three functions.
 *
 * `fixsplat info SCENE --board st7789-240x240` prints the memory that MEMORY must have at least. */
#include <fixsplat/board.h>

#include "port/board/panel.h"
#include "port/board/turntable.h"

enum { SIDE = 240, ROWS = 16, MEMORY = 196608 };

extern const unsigned char scene[];                 /* an .fxs, by convert --for board */
extern const size_t scene_bytes;
void send_command(void *argument, uint8_t command); /* with D/C low */
void send_data(void *argument, const uint8_t *bytes, size_t count);
void wait(void *argument, uint32_t milliseconds);

static uint16_t rows[ROWS * SIDE];
static uint64_t memory[MEMORY / 8];
static fxs_turntable table;
static fxs_context context;
static fxs_request request;

static fxs_panel panel = {.type = &fxs_panel_types[FXS_PANEL_ST7789_SQUARE],
                          .bus = {send_command, send_data, wait, 0}};
static fxs_strip strip = {.pixels = rows, .stride = SIDE * 2, .rows = ROWS, .format = FXS_FORMAT_RGB565_SWAPPED,
                          .rows_done = fxs_panel_rows, .argument = &panel};

int main(void)
{
    const fxs_config config = {.size = sizeof config, .draw = fxs_strip_draw, .draw_argument = &strip,
                               .draw_blended = 1};
    if (fxs_context_init(&context, &config) || fxs_panel_init(&panel, SIDE, SIDE) ||
        fxs_turntable_open(&table, scene, scene_bytes, SIDE, SIDE))
        return 1;
    for (uint32_t step = 0;; step++) {              /* FXS_TURNTABLE_STEPS, 64, are a turn */
        fxs_turntable_turn(&table, step % FXS_TURNTABLE_STEPS);
        fxs_request_init(&request, &table.object, 1);
        request.cameras[0] = table.camera;
        request.targets[0].format = FXS_FORMAT_RGB565_SWAPPED;
        if (fxs_render(&context, &request, memory, sizeof memory, 0))
            return 1;
    }
}
