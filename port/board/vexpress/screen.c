/* Shows a turning scene on the screen of the Versatile Express board. Strips are copied to a hidden picture, which
 * replaces the visible one when complete. */
#include <string.h>

#include <fixsplat/board.h>
#include "port/board/turntable.h"
#include "port/board/cortexm/firmware.h"
#include "port/board/cortexm/console.h"

#define WIDTH 640
#define HEIGHT 480

/* Colour LCD controller PL111 (ARM DDI 0293, 3.2): 16 bits per pixel, red in the highest bits. */
#define LCD ((volatile uint32_t *)0x10020000)
enum { TIMING0, TIMING1, TIMING2, TIMING3, UPPER_BASE, LOWER_BASE, CONTROL };
#define CONTROL_ON (1 | 6 << 1 | 1 << 5 | 1 << 8 | 1 << 11)

static uint16_t screens[2][HEIGHT][WIDTH] __attribute__((aligned(8)));

void board_fault(void);
void board_fault(void)
{
    console_text("error: a fault of the processor\n");
    console_exit(3);
}

static int copy_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    memcpy((uint16_t *)argument + first * WIDTH, strip->pixels, (size_t)rows * WIDTH * sizeof(uint16_t));
    return 0;
}

static void show(const void *screen)
{
    LCD[TIMING0] = (WIDTH / 16 - 1) << 2;
    LCD[TIMING1] = HEIGHT - 1;
    LCD[UPPER_BASE] = (uint32_t)(uintptr_t)screen;
    LCD[CONTROL] = CONTROL_ON;
}

int main(void)
{
    static uint16_t pixels[16][WIDTH];
    static char line[128];
    static fxs_turntable table;
    static fxs_context context;
    static fxs_strip strip = {pixels, sizeof *pixels, 16, FXS_FORMAT_RGB565, copy_rows, 0, {0}};
    static const fxs_config config = {.size = sizeof(fxs_config), .draw = fxs_strip_draw, .draw_argument = &strip,
                                      .draw_blended = 1};
    static fxs_request request;
    console_command(line, sizeof line);
    const uint32_t frames = console_option(line, "frames", 0);     /* number of frames to draw; 0: without end */
    fxs_context_init(&context, &config);
    fxs_request_init(&request, &table.object, 1);
    request.options = (fxs_options){.size = sizeof(fxs_options), .sh_degree = 3, .background = {0x11, 0x13, 0x1b}};
    int error = fxs_turntable_open(&table, board_scene, (size_t)(board_scene_end - board_scene), WIDTH, HEIGHT);
    for (uint32_t i = 0; !error && (i < frames || !frames); i++) {
        strip.argument = screens[i & 1];
        fxs_turntable_turn(&table, i);
        request.cameras[0] = table.camera;
        error = fxs_render(&context, &request, board_memory, (size_t)(board_memory_end - board_memory), 0);
        show(screens[i & 1]);
    }
    console_text(error ? "error: " : "shown\n");
    if (error) {
        console_text(fxs_strerror(error));
        console_text("\n");
        return 1;
    }
    for (;;)
        __asm__ volatile("wfi");
}
