/* Renders a turning scene from flash in strips of rows. Prints time, memory and the hash of each picture; the hash is
 * the same on every machine. With display=1 on the command line, strips also go to a simulated display panel, whose bus
 * is a file (recorder.c). panel= is its number in fxs_panel_types, rotation= its quarter turns. */
#include "firmware.h"
#include "console.h"
#include "recorder.h"
#include <fixsplat/board.h>
#include "port/board/turntable.h"

#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

#define WIDTH_MOST 480
#define ROWS_MOST 32
#define MONO_WIDTH 128             /* width of the widest panel of 1 bit */

typedef struct shown {
    uint64_t hash;
    fxs_panel panel;               /* display panel; width 0: no panel */
} shown;

/* Opens the panel of the command line. Its rotation is by default that of a picture as wide as this. */
static int panel_open(fxs_panel *panel, const char *line, int32_t width, int32_t height)
{
    static int16_t errors[MONO_WIDTH];
    static uint8_t pages[MONO_WIDTH * ROWS_MOST / 8];
    const uint32_t number = console_option(line, "panel", FXS_PANEL_ILI9341);
    if (number >= FXS_PANELS)
        return FXS_ERR_DEVICE;
    panel->type = &fxs_panel_types[number];
    panel->rotation = (int)console_option(line, "rotation", width > panel->type->width);
    panel->errors = errors;
    panel->pages = pages;
    const int error = recorder_open(&panel->bus);
    return error ? error : fxs_panel_init(panel, width, height);
}

static int add_rows(void *argument, fxs_strip *strip, int32_t first, int32_t rows)
{
    shown *s = argument;
    const unsigned char *pixels = strip->pixels;
    for (ptrdiff_t i = 0; i < rows * strip->stride; i++)
        s->hash = (s->hash ^ pixels[i]) * 0x100000001b3u;
    return s->panel.width ? fxs_panel_rows(&s->panel, strip, first, rows) : 0;
}

static void say(const char *words, uint64_t number)
{
    console_text(words);
    console_number(number);
}

static int failed(int error, const fxs_stats *stats)
{
    console_text("error: ");
    console_text(fxs_strerror(error));
    if (error == FXS_ERR_MEMORY)
        say("; this takes ", stats->memory.least);
    console_text("\n");
    return 1;
}

static void say_frame(uint32_t step, uint64_t hash, const fxs_stats *stats)
{
    say("step ", step);
    console_text(" hash ");
    console_hex(hash);
    say(" drawn ", stats->drawn);
    say(" visible ", stats->visible);
    say(" bands ", stats->bands);
    say(" slices ", stats->slices);
    say(" memory ", stats->memory.total);
    say(" ns ", stats->frame_nanoseconds);
    for (int i = 0; i < FXS_STAGES; i++) {
        console_text(" ");
        console_text(fxs_stage_name((enum fxs_stage)i));
        say(" ", stats->nanoseconds[i]);
    }
    console_text("\n");
}

int main(void)
{
    static unsigned char pixels[WIDTH_MOST * ROWS_MOST * 2];
    static char line[128];
    static fxs_turntable table;
    static fxs_context context;
    static fxs_request request;
    static fxs_stats stats;
    static shown show;
    static fxs_strip strip = {pixels, 0, 0, FXS_FORMAT_RGB565, add_rows, &show, {0}};
    fxs_config config = {.size = sizeof(fxs_config), .clock = board_clock, .draw = fxs_strip_draw,
                         .draw_argument = &strip, .draw_blended = 1};
    board_stack_mark();
    console_command(line, sizeof line);
    fxs_request_init(&request, &table.object, 1);
    request.options = (fxs_options){.size = sizeof(fxs_options), .sh_degree = (int)console_option(line, "degree", 3),
                                    .background = {0x11, 0x13, 0x1b},
                                    .budget = console_option(line, "budget", 0)};
    const uint32_t width = console_option(line, "width", 320), height = console_option(line, "height", 240);
    const uint32_t rows = console_option(line, "rows", 16), frames = console_option(line, "frames", 4);
    const uint32_t room = (uint32_t)(board_memory_end - board_memory), memory = console_option(line, "memory", room);
    strip.rows = (int32_t)(rows < ROWS_MOST ? rows : ROWS_MOST);
    strip.stride = (int32_t)(width < WIDTH_MOST ? width : WIDTH_MOST) * 2;
#ifdef FXS_WITH_KERNELS
    static fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    config.kernels = &fastest;
#endif
    fxs_context_init(&context, &config);
    int error = fxs_turntable_open(&table, board_scene, (size_t)(board_scene_end - board_scene), (int32_t)width,
                                   (int32_t)height);
    if (!error && console_option(line, "display", 0)) {
        strip.format = FXS_FORMAT_RGB565_SWAPPED;
        error = panel_open(&show.panel, line, (int32_t)width, (int32_t)height);
    }
    for (uint32_t i = 0; i < frames && !error; i++) {
        const uint32_t step = i * FXS_TURNTABLE_STEPS / frames;
        show.hash = 0xcbf29ce484222325u;
        fxs_turntable_turn(&table, step);
        request.cameras[0] = table.camera;
        error = fxs_render(&context, &request, board_memory, memory < room ? memory : room, &stats);
        if (!error)
            say_frame(step, show.hash, &stats);
    }
    if (error)
        return failed(error, &stats);
    say("stack ", board_stack_used());
    say(" of ", board_stack_bytes());
    console_text("\n");
    return 0;
}
