/* Bus of a display panel that records its bytes to a file of the host computer through semihosting. */
#include "recorder.h"

#include "console.h"

enum { COMMAND, DATA, WAIT };

/* Writes bytes to the recorded file. If the host cannot write, ends the program, because bus functions return no
   errors. */
static void put(const uint8_t *events, uint32_t count, const int *file)
{
    if (!console_write(*file, events, count))
        return;
    console_text("error: cannot write panel.stream\n");
    console_exit(1);
}

static void command(void *argument, uint8_t byte)
{
    const uint8_t event[2] = {COMMAND, byte};
    put(event, sizeof event, argument);
}

static void data(void *argument, const uint8_t *bytes, size_t count)
{
    static uint8_t events[512];
    while (count) {
        const size_t part = count < sizeof events / 2 ? count : sizeof events / 2;
        for (size_t i = 0; i < part; i++) {
            events[2 * i] = DATA;
            events[2 * i + 1] = bytes[i];
        }
        put(events, (uint32_t)(2 * part), argument);
        bytes += part;
        count -= part;
    }
}

static void wait(void *argument, uint32_t milliseconds)
{
    for (; milliseconds; milliseconds -= milliseconds < 255 ? milliseconds : 255) {
        const uint8_t event[2] = {WAIT, (uint8_t)(milliseconds < 255 ? milliseconds : 255)};
        put(event, sizeof event, argument);
    }
}

int recorder_open(fxs_panel_bus *bus)
{
    static int file;
    file = console_open("panel.stream");
    *bus = (fxs_panel_bus){command, data, wait, &file};
    return file < 0 ? FXS_ERR_DEVICE : 0;
}
