/* Tests the driver of the ILI9341 display controller with a model of the controller. The model takes the bytes of
   the bus and refuses sequences that the data sheet forbids. With arguments, the model takes the byte stream of a
   board: test_ili9341 SCENE.fxs WIDTH HEIGHT FRAMES STREAM. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/stage.h>
#include "port/board/ili9341.h"
#include "port/board/turntable.h"
#include "one_scene.h"
#include "check.h"
#include "random_scene.h"

static const fxs_options options = {.size = sizeof(fxs_options), .sh_degree = 3, .background = {0x11, 0x13, 0x1b}};

#define UNTOUCHED 0xbeef
enum { SHORT_SIDE = 240, LONG_SIDE = 320 };
enum { COMMAND, DATA, WAIT };              /* kinds of events that the driver causes on the bus to the display */
enum { MIRROR_Y = 0x80, MIRROR_X = 0x40, TRANSPOSE = 0x20, BGR = 0x08 };

typedef struct model {
    uint16_t memory[LONG_SIDE][SHORT_SIDE];
    const char *fault;                     /* text of the first fault that the model of the display found, or null */
    uint32_t now, reset_at, awake_at;      /* times in milliseconds: now, of the last reset, of the last wake-up */
    int is_reset, is_awake, is_on;
    uint8_t command, data[4], access, format;
    uint32_t count;                        /* number of data bytes since the last command byte */
    int32_t window[2][2], at[2];   /* window: first and last column and row for pixels; at: place of the next pixel */
    uint64_t pixels;
} model;

static const struct command {
    uint8_t code, count;
} commands[] = {{0x01, 0}, {0x11, 0}, {0x29, 0}, {0x2a, 4}, {0x2b, 4}, {0x2c, 0}, {0x36, 1},
                {0x3a, 1}, {0xb1, 2}, {0xc0, 1}, {0xc1, 1}, {0xc5, 2}, {0xc7, 1}};

static void model_init(model *m)
{
    memset(m, 0, sizeof *m);
    for (int i = 0; i < LONG_SIDE * SHORT_SIDE; i++)
        m->memory[i / SHORT_SIDE][i % SHORT_SIDE] = UNTOUCHED;
}

static void refuse(model *m, const char *fault)
{
    m->fault = m->fault ? m->fault : fault;
}

static int32_t side(const model *m, int is_page)
{
    return is_page == !(m->access & TRANSPOSE) ? LONG_SIDE : SHORT_SIDE;
}

static void reset(model *m)
{
    m->is_reset = 1;
    m->is_awake = m->is_on = 0;
    m->reset_at = m->now;
    m->access = 0;
    m->format = 0x66;
    m->window[0][1] = SHORT_SIDE - 1;
    m->window[1][1] = LONG_SIDE - 1;
    m->window[0][0] = m->window[1][0] = 0;
}

static void begin_command(model *m)
{
    if (m->command == 0x01)
        reset(m);
    if (m->command == 0x11) {
        if (m->is_awake || m->now - m->reset_at < 120)
            refuse(m, "sleep out too early, or twice");
        m->is_awake = 1;
        m->awake_at = m->now;
    }
    if (m->command == 0x29 && !m->is_awake)
        refuse(m, "on in its sleep");
    m->is_on |= m->command == 0x29;
    if (m->command == 0x2c) {
        if (m->format != 0x55)
            refuse(m, "pixels of other than 16 bits");
        for (int i = 0; i < 2; i++) {
            m->at[i] = m->window[i][0];
            if (m->window[i][1] >= side(m, i))
                refuse(m, "a window beyond the memory");
        }
    }
}

static void end_command(model *m)
{
    const uint8_t *d = m->data;
    if (m->command == 0x36)
        m->access = d[0];
    if (m->command == 0x3a)
        m->format = d[0];
    if (m->command == 0x2a || m->command == 0x2b) {
        int32_t *range = m->window[m->command - 0x2a];
        range[0] = d[0] << 8 | d[1];
        range[1] = d[2] << 8 | d[3];
        if (range[0] > range[1] || range[1] >= side(m, m->command - 0x2a))
            refuse(m, "a range that is none");
    }
}

static const struct command *command_of(uint8_t code)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (commands[i].code == code)
            return &commands[i];
    return 0;
}

static int is_complete(const model *m)
{
    return m->command == 0x2c ? m->count % 2 == 0 : !m->command || m->count == command_of(m->command)->count;
}

static void take_command(model *m, uint8_t code)
{
    if (!command_of(code))
        refuse(m, "an unknown command");
    if (!m->is_reset && code != 0x01)
        refuse(m, "not reset");
    if (m->is_reset && (m->now - m->reset_at < 5 || (m->is_awake && m->now - m->awake_at < 5)))
        refuse(m, "less than 5 ms after reset or sleep out");
    if (!is_complete(m))
        refuse(m, "a command without all of its data");
    m->command = code;
    m->count = 0;
    if (!m->fault)
        begin_command(m);
}

static void write_pixel(model *m, uint16_t pixel)
{
    const int turned = m->access & TRANSPOSE;
    int32_t column = m->at[turned ? 1 : 0], page = m->at[turned ? 0 : 1];
    if (m->at[1] > m->window[1][1]) {
        refuse(m, "more pixels than the window has");
        return;
    }
    column = m->access & MIRROR_X ? SHORT_SIDE - 1 - column : column;
    page = m->access & MIRROR_Y ? LONG_SIDE - 1 - page : page;
    m->memory[page][column] = pixel;
    m->pixels++;
    if (++m->at[0] > m->window[0][1]) {
        m->at[0] = m->window[0][0];
        m->at[1]++;
    }
}

static void take_data(model *m, uint8_t byte)
{
    if (m->command == 0x2c) {
        m->data[m->count % 2] = byte;
        if (++m->count % 2 == 0)
            write_pixel(m, (uint16_t)(m->data[0] << 8 | m->data[1]));
        return;
    }
    if (!m->command || m->count >= command_of(m->command)->count) {
        refuse(m, "data that no command takes");
        return;
    }
    m->data[m->count++] = byte;
    if (m->count == command_of(m->command)->count)
        end_command(m);
}

static void take(model *m, uint8_t kind, uint8_t byte)
{
    if (kind > WAIT)
        refuse(m, "no event");
    if (m->fault)
        return;
    if (kind == WAIT)
        m->now += byte;
    else if (kind == COMMAND)
        take_command(m, byte);
    else
        take_data(m, byte);
}

/* Returns the pixel that a viewer sees at x, y. Columns of the display's memory run right to left on the glass. */
static uint16_t seen(const model *m, int32_t x, int32_t y, int upright)
{
    return upright ? m->memory[y][SHORT_SIDE - 1 - x] : m->memory[x][y];
}

/* True if the display shows the picture. pixels: RGB565, low byte first. */
static int shows(const model *m, const unsigned char *pixels, int32_t width, int32_t height)
{
    const int upright = width <= SHORT_SIDE && height <= LONG_SIDE;
    int differing = m->fault || !m->is_on || m->access & ~(MIRROR_X | TRANSPOSE) & ~BGR || !(m->access & BGR) ||
                    !is_complete(m);
    for (int32_t y = 0; y < (upright ? LONG_SIDE : SHORT_SIDE); y++)
        for (int32_t x = 0; x < (upright ? SHORT_SIDE : LONG_SIDE); x++) {
            const unsigned char *p = pixels + 2 * ((ptrdiff_t)y * width + x);
            const int want = x < width && y < height ? p[0] | p[1] << 8 : UNTOUCHED;
            differing += seen(m, x, y, upright) != want;
        }
    return !differing;
}

/* A bus to the display, with optional DMA. The DMA reads pixels as late as possible, to find buffers that are
   changed too early. */
typedef struct bus {
    model *model;
    int dma;
    const uint8_t *pending;
    size_t count;
} bus;

static void finish(bus *b)
{
    for (size_t i = 0; i < b->count; i++)
        take(b->model, DATA, b->pending[i]);
    b->count = 0;
}

static void send_command(void *argument, uint8_t command)
{
    finish(argument);
    take(((bus *)argument)->model, COMMAND, command);
}

static void send_data(void *argument, const uint8_t *bytes, size_t count)
{
    bus *b = argument;
    finish(b);
    b->pending = bytes;
    b->count = count;
    if (!b->dma || count <= 4)
        finish(b);
}

static void wait(void *argument, uint32_t milliseconds)
{
    bus *b = argument;
    finish(b);
    for (; milliseconds > 255; milliseconds -= 255)
        take(b->model, WAIT, 255);
    take(b->model, WAIT, (uint8_t)milliseconds);
}

static fxs_ili9341 panel_on(bus *b)
{
    return (fxs_ili9341){.bus = {send_command, send_data, wait, b}};
}

static unsigned char *whole_picture(const fxs_object *object, const fxs_camera *camera)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    unsigned char *pixels = check_aligned((size_t)(camera->width * camera->height * 2));
    const fxs_targets targets = one_target(FXS_FORMAT_RGB565, pixels, camera->width * 2);
    const size_t bytes = fxs_frame_bytes(&context, object, 1, camera->width, camera->height, 0);
    void *memory = check_aligned(bytes);
    CHECK(!render_frame(&context, object, 1, camera, &options, &targets, memory, bytes, 0));
    free(memory);
    return pixels;
}

static void draw_on(fxs_ili9341 *panel, const fxs_object *object, const fxs_camera *camera, int32_t rows, int32_t gap)
{
    const ptrdiff_t stride = camera->width * 2 + gap;
    const size_t room = (size_t)(stride * rows);
    unsigned char *strips = check_aligned(2 * room);
    fxs_context context;
    fxs_strip strip = {.pixels = strips, .stride = stride, .rows = rows, .format = FXS_FORMAT_RGB565_SWAPPED,
                       .rows_done = fxs_ili9341_rows, .argument = panel};
    const fxs_config config = {.size = sizeof(fxs_config), .draw = fxs_strip_draw, .draw_argument = &strip,
                               .draw_blended = 1};
    fxs_frame_memory sizes;
    if (((bus *)panel->bus.argument)->dma)
        panel->other = strips + room;
    fxs_context_init(&context, &config);
    fxs_frame_bytes(&context, object, 1, camera->width, camera->height, &sizes);
    void *memory = check_aligned(sizes.least);
    CHECK(!fxs_ili9341_init(panel, camera->width, camera->height));
    CHECK(!render_frame(&context, object, 1, camera, &options, 0, memory, sizes.least, 0));
    finish(panel->bus.argument);
    free(memory);
    free(strips);
}

static void test_pictures(void)
{
    static const int32_t sizes[][2] = {{240, 320}, {320, 240}, {131, 77}, {241, 240}, {1, 1}, {320, 17}};
    static model m;
    state = 31;
    for (size_t i = 0; i < 2 * sizeof sizes / sizeof *sizes; i++) {
        packed_scene scene = random_scene((enum fxs_profile)(i % 3), 2000);
        bus b = {.model = &m, .dma = i % 2 == 1};
        fxs_ili9341 panel = panel_on(&b);
        fxs_object object;
        fxs_camera camera;
        fxs_object_init(&object, &scene.scene);
        fxs_camera_init(&camera, sizes[i / 2][0], sizes[i / 2][1]);
        model_init(&m);
        draw_on(&panel, &object, &camera, 16 * (1 + (int32_t)i % 3), i % 4 < 2 ? 0 : 6);
        unsigned char *want = whole_picture(&object, &camera);
        if (!CHECK(shows(&m, want, camera.width, camera.height)))
            printf("  %dx%d: %s\n", camera.width, camera.height, m.fault ? m.fault : "other pixels");
        want[0] ^= 1;
        CHECK(!shows(&m, want, camera.width, camera.height));
        free(want);
        free(scene.data);
    }
}

static void test_refused(void)
{
    static const int32_t sizes[][2] = {{0, 10}, {10, 0}, {241, 320}, {320, 241}, {321, 1}, {1, 321}};
    static model m;
    bus b = {.model = &m};
    fxs_ili9341 panel = panel_on(&b);
    model_init(&m);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        CHECK(fxs_ili9341_init(&panel, sizes[i][0], sizes[i][1]) == FXS_ERR_SIZE && !m.is_reset);
    static unsigned char pixels[20 * 16 * 2];
    fxs_strip strip = {.pixels = pixels, .stride = 40, .rows = 16, .format = FXS_FORMAT_RGB565};
    CHECK(!fxs_ili9341_init(&panel, 20, 32));
    CHECK(fxs_ili9341_rows(&panel, &strip, 0, 16) == FXS_ERR_TARGET);
    strip.format = FXS_FORMAT_RGB565_SWAPPED;
    CHECK(fxs_ili9341_rows(&panel, &strip, 17, 16) == FXS_ERR_TARGET && !m.pixels);
    strip.stride = 39;
    CHECK(fxs_ili9341_rows(&panel, &strip, 16, 16) == FXS_ERR_TARGET && !m.pixels);
    strip.stride = 40;
    CHECK(!fxs_ili9341_rows(&panel, &strip, 16, 16) && m.pixels == 20 * 16 && !m.fault);
}

static void test_model_refuses(void)
{
#define AWAKE COMMAND, 0x01, WAIT, 120, COMMAND, 0x3a, DATA, 0x55, COMMAND, 0x11, WAIT, 5
#define ONE_PIXEL COMMAND, 0x2a, DATA, 0, DATA, 7, DATA, 0, DATA, 7, COMMAND, 0x2b, DATA, 0, DATA, 0, DATA, 0, DATA, 0
    static const struct {
        uint8_t count, events[64];
    } streams[] = {
        {2, {COMMAND, 0x29}},
        {2, {DATA, 0}},
        {2, {3, 0}},
        {6, {COMMAND, 0x01, WAIT, 4, COMMAND, 0x3a}},
        {6, {COMMAND, 0x01, WAIT, 119, COMMAND, 0x11}},
        {6, {COMMAND, 0x01, WAIT, 5, COMMAND, 0x29}},
        {6, {COMMAND, 0x01, WAIT, 5, COMMAND, 0x2c}},
        {10, {COMMAND, 0x01, WAIT, 120, COMMAND, 0x11, WAIT, 4, COMMAND, 0x29}},
        {14, {AWAKE, COMMAND, 0x11}},
        {14, {AWAKE, COMMAND, 0x33}},
        {16, {AWAKE, COMMAND, 0x29, DATA, 1}},
        {16, {AWAKE, COMMAND, 0x3a, COMMAND, 0x29}},
        {22, {AWAKE, COMMAND, 0x2a, DATA, 0, DATA, 2, DATA, 0, DATA, 1}},
        {22, {AWAKE, COMMAND, 0x2a, DATA, 0, DATA, 0, DATA, 0, DATA, 240}},
        {22, {AWAKE, COMMAND, 0x2b, DATA, 0, DATA, 0, DATA, 1, DATA, 64}},
        {18, {AWAKE, COMMAND, 0x36, DATA, 0x28, COMMAND, 0x2c}},
        {18, {AWAKE, COMMAND, 0x2c, DATA, 1, COMMAND, 0x29}},
        {42, {AWAKE, ONE_PIXEL, COMMAND, 0x2c, DATA, 1, DATA, 2, DATA, 3, DATA, 4}},
    };
    static model m;
    for (size_t i = 0; i < sizeof streams / sizeof *streams; i++) {
        model_init(&m);
        for (int at = 0; at < streams[i].count; at += 2) {
            CHECK(!m.fault);
            take(&m, streams[i].events[at], streams[i].events[at + 1]);
        }
        if (!CHECK(m.fault))
            printf("  stream %zu\n", i);
    }
}

/* ---- Byte stream of a board -------------------------------------------------------------------------------------- */

static int check_stream(char **arguments)
{
    static model m;
    fxs_mapping scene, stream;
    fxs_message message;
    fxs_turntable t;
    const int32_t width = (int32_t)strtol(arguments[1], 0, 10), height = (int32_t)strtol(arguments[2], 0, 10);
    const uint32_t frames = (uint32_t)strtoul(arguments[3], 0, 10);
    if (fxs_map_open(&scene, arguments[0], &message) || fxs_map_open(&stream, arguments[4], &message) ||
        fxs_turntable_open(&t, scene.data, scene.bytes, width, height))
        return puts("no scene or no stream"), 1;
    model_init(&m);
    const uint8_t *events = stream.data;
    for (size_t at = 0; at + 1 < stream.bytes; at += 2)
        take(&m, events[at], events[at + 1]);
    fxs_turntable_turn(&t, (frames - 1) * FXS_TURNTABLE_STEPS / frames);
    unsigned char *want = whole_picture(&t.object, &t.camera);
    const int same = shows(&m, want, width, height) && m.pixels == (uint64_t)frames * (uint64_t)(width * height);
    printf("%s, %" PRIu64 " pixels\n", m.fault ? m.fault : same ? "the same picture" : "another picture", m.pixels);
    free(want);
    fxs_map_close(&stream);
    fxs_map_close(&scene);
    return !same;
}

int main(int argc, char **argv)
{
    if (argc == 6)
        return check_stream(argv + 1);
    RUN(test_pictures);
    RUN(test_refused);
    RUN(test_model_refuses);
    return check_report();
}
